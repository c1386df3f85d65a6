!> Overlap volumes of shapes in space against closed forms, random points, sums of parts, and each other;
!! test_overlap_cylinders has more of cylinders.
program test_overlap_volumes
  use harness, only: tests_t
  use random_space, only: check_hits, random_direction, random_frame
  use sg_kinds, only: wp, i4, pi
  use sg_overlap_polyhedra, only: measure_polyhedra, measure_polyhedron_plane, overlap_polyhedron_plane, &
                                  overlap_polyhedron_polyhedron, overlap_room_t, overlap_sphere_polyhedron
  use sg_overlap_solid, only: box_solid, cut, solid_t, solid_volume
  use sg_overlap_spheres, only: overlap_sphere_cylinder, overlap_sphere_hollow_cylinder, overlap_sphere_plane, overlap_sphere_sphere
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_random, only: random_t
  use sg_vectors, only: cross
  implicit none
  !> Some tens of roundings of volumes of order 1
  real(wp), parameter :: tight = 1e-13_wp, zero(3) = 0
  real(wp), parameter :: ex(3) = [1.0_wp, 0.0_wp, 0.0_wp], ez(3) = [0.0_wp, 0.0_wp, 1.0_wp]
  real(wp), parameter :: upright(3, 3) = reshape([1.0_wp, zero, 1.0_wp, zero, 1.0_wp], [3, 3])
  !> Random points a volume
  integer, parameter :: n_points = 20000
  type(tests_t) :: t

  call test_spheres()
  call test_sphere_plane()
  call test_slivers()
  call test_sphere_polyhedron()
  call test_boxes()
  call test_polyhedra()
  call test_directions()
  call test_random_points()
  call t%finish()

contains

  !> A polyhedron with the surface of a solid; the volume needs no edges.
  subroutine make_polyhedron(solid, shape)
    type(solid_t), intent(in) :: solid
    type(polyhedron_t), intent(out) :: shape
    real(wp) :: sum_of(3), a(3), b(3)
    integer :: f, i, first, last

    shape%n_vertices = solid%n_vertices
    shape%n_faces = solid%n_faces
    last = solid%face_first(solid%n_faces + 1) - 1
    allocate (shape%vertex(3, solid%n_vertices), shape%normal(3, solid%n_faces))
    allocate (shape%face_first(solid%n_faces + 1), shape%face_vertex(last))
    shape%vertex = solid%vertex(:, :solid%n_vertices)
    shape%face_first = int(solid%face_first(:solid%n_faces + 1), i4)
    shape%face_vertex = int(solid%face_vertex(:last), i4)
    shape%reach = maxval(norm2(shape%vertex, 1))
    do f = 1, solid%n_faces
      first = solid%face_first(f)
      last = solid%face_first(f + 1) - 1
      sum_of = 0
      do i = first + 1, last - 1
        a = shape%vertex(:, shape%face_vertex(i)) - shape%vertex(:, shape%face_vertex(first))
        b = shape%vertex(:, shape%face_vertex(i + 1)) - shape%vertex(:, shape%face_vertex(first))
        sum_of = sum_of + cross(a, b)
      end do
      shape%normal(:, f) = sum_of/norm2(sum_of)
    end do
  end subroutine make_polyhedron

  !> A box, placed.
  subroutine make_box(half, centre, frame, shape)
    real(wp), intent(in) :: half(3), centre(3), frame(3, 3)
    type(polyhedron_t), intent(out) :: shape
    type(solid_t) :: solid

    call box_solid(half, solid)
    call make_polyhedron(solid, shape)
    call place_polyhedron(shape, centre, frame)
  end subroutine make_box

  !> A box with its corners cut off at random, placed at random near a point.
  subroutine make_random(random, centre, shape, volume)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: centre(3)
    type(polyhedron_t), intent(out) :: shape
    real(wp), intent(out) :: volume
    type(solid_t) :: solid
    integer :: i

    call box_solid([1.0_wp, 0.9_wp, 0.8_wp], solid)
    do i = 1, 12
      call cut(solid, random_direction(random), random%uniform(0.6_wp, 1.0_wp))
    end do
    volume = solid_volume(solid)
    call make_polyhedron(solid, shape)
    call place_polyhedron(shape, centre, random_frame(random))
  end subroutine make_random

  subroutine test_spheres()
    real(wp) :: d
    integer :: i

    ! Unit spheres d apart share pi (4 + d) (2 - d)^2 / 12.
    do i = 1, 19
      d = 0.1_wp*real(i, wp)
      call t%near(overlap_sphere_sphere(d*[0.0_wp, 0.6_wp, 0.8_wp], 1.0_wp, zero, 1.0_wp), pi*(4 + d)*(2 - d)**2/12, tight, 'lens')
    end do
    call t%near(overlap_sphere_sphere([0.5_wp, 0.3_wp, 0.1_wp], 0.2_wp, zero, 1.0_wp), 4*pi*0.008_wp/3, tight, 'sphere in a sphere')
    call t%near(overlap_sphere_sphere([0.5_wp, 0.3_wp, 0.1_wp], 2.0_wp, zero, 1.0_wp), 4*pi/3, tight, 'sphere about a sphere')
    call t%near(overlap_sphere_sphere(zero, 1.0_wp, zero, 1.0_wp), 4*pi/3, tight, 'the same sphere')
    call t%near(overlap_sphere_sphere(2*ex, 1.0_wp, zero, 1.0_wp), 0.0_wp, 0.0_wp, 'spheres that touch')
    call t%near(overlap_sphere_sphere(ex, 0.8_wp, zero, 0.6_wp), overlap_sphere_sphere(zero, 0.6_wp, ex, 0.8_wp), 0.0_wp, &
                'spheres exchanged')
    ! Caps of heights 1/8 and 3/8
    call t%near(overlap_sphere_sphere(ex, 1.0_wp, zero, 0.5_wp), &
                pi*(0.125_wp**2*(3 - 0.125_wp) + 0.375_wp**2*(1.5_wp - 0.375_wp))/3, tight, 'unequal spheres')
  end subroutine test_spheres

  subroutine test_sphere_plane()
    real(wp), parameter :: half(3) = [4.0_wp, 3.0_wp, 2.0_wp], ball = 4*pi/3
    real(wp) :: h

    h = 0.3_wp
    call t%near(overlap_sphere_plane([0.0_wp, 0.0_wp, 3 - h], 1.0_wp, zero, upright, half), pi*h**2*(3 - h)/3, tight, 'cap')
    call t%near(overlap_sphere_plane([3.0_wp, 2.0_wp, 1.0_wp], 1.0_wp, zero, upright, half), ball, tight, 'ball within')
    call t%near(overlap_sphere_plane([0.0_wp, 3.0_wp, 0.0_wp], 1.0_wp, zero, upright, half), ball/2, tight, 'centre on a face')
    call t%near(overlap_sphere_plane([0.5_wp, 3.0_wp, -2.0_wp], 1.0_wp, zero, upright, half), ball/4, tight, 'centre on an edge')
    call t%near(overlap_sphere_plane([4.0_wp, 3.0_wp, -2.0_wp], 1.0_wp, zero, upright, half), ball/8, tight, 'centre on a corner')
    call t%near(overlap_sphere_plane([4.6_wp, 3.6_wp, 2.6_wp], 1.0_wp, zero, upright, half), 0.0_wp, 0.0_wp, 'off a corner')
    call t%near(overlap_sphere_plane([4.8_wp, 3.8_wp, 0.0_wp], 1.0_wp, zero, upright, half), 0.0_wp, 0.0_wp, 'off an edge')
    call t%near(overlap_sphere_plane(zero, 6.0_wp, zero, upright, half), 192.0_wp, 200*tight, 'box within')
    call t%near(overlap_sphere_plane([0.1_wp, 0.0_wp, 0.05_wp], 1.0_wp, zero, upright, [4.0_wp, 3.0_wp, 0.25_wp]), &
                ball - pi*(0.8_wp**2*2.2_wp + 0.7_wp**2*2.3_wp)/3, tight, 'ball through a thin plate')
    ! A cube that cuts a cap off on all six sides.
    h = 1 - 0.8_wp
    call t%near(overlap_sphere_plane(zero, 1.0_wp, zero, upright, [0.8_wp, 0.8_wp, 0.8_wp]), ball - 2*pi*h**2*(3 - h), tight, &
                'ball through six faces')
  end subroutine test_sphere_plane

  !> Thin overlaps keep their digits. Powers of two keep the penetration d exact.
  subroutine test_slivers()
    type(polyhedron_t) :: box, other
    real(wp) :: d, cap
    integer :: i

    call make_box([3.0_wp, 2.0_wp, 1.0_wp], zero, upright, box)
    do i = 4, 12
      d = 2.0_wp**(-3*i)
      cap = pi*d**2*(3 - d)/3
      ! Two spheres share pi d^2 r s/(r + s) up to a relative d.
      call t%near(overlap_sphere_sphere((1.5_wp - d)*ex, 1.0_wp, zero, 0.5_wp)/(pi*d**2/3), 1.0_wp, 2*d + tight, 'thin lens')
      ! The depth is a difference of coordinates of order 1: relative error 4e-16/d.
      call t%near(overlap_sphere_plane([2.5_wp, 0.0_wp, 2 - d], 1.0_wp, zero, upright, [3.0_wp, 2.0_wp, 1.0_wp])/cap, 1.0_wp, &
                  tight + 1e-15_wp/d, 'thin cap near an edge of a plane')
      call t%near(overlap_sphere_polyhedron([2.5_wp, 0.0_wp, 2 - d], 1.0_wp, box, zero)/cap, 1.0_wp, tight + 1e-15_wp/d, &
                  'thin cap near an edge of a polyhedron')
      ! Beside a cylinder, the paraboloid of curvatures 2 and 1 cut at depth d: pi d^2/sqrt(2) up to some d.
      call t%near(overlap_sphere_cylinder((2 - d)*ex, 1.0_wp, zero, ez, 2.0_wp, 1.0_wp)/(pi*d**2/sqrt(2.0_wp)), 1.0_wp, &
                  2*d + 1e-12_wp + 1e-15_wp/d, 'thin overlap with a cylinder')
      call make_box([3.0_wp, 1.0_wp, 1.0_wp], [0.0_wp, 1.5_wp, 2 - d], upright, other)
      call t%near(overlap_polyhedron_polyhedron(other, box, zero)/(9*d), 1.0_wp, 1e-15_wp/d, 'thin slab of bricks')
      call t%near(overlap_polyhedron_plane(other, zero, upright, [3.0_wp, 2.0_wp, 1.0_wp])/(9*d), 1.0_wp, 1e-15_wp/d, &
                  'thin slab of a brick on a plane')
    end do
  end subroutine test_slivers

  subroutine test_sphere_polyhedron()
    type(random_t) :: random
    type(polyhedron_t) :: shape, below, above
    type(solid_t) :: solid, part
    real(wp) :: centre(3), frame(3, 3), normal(3), half(3), radius, height, volume, whole
    integer :: k, i

    call random%seed(51)
    do k = 1, 300
      ! A box as a plane and as a polyhedron
      half = [random%uniform(0.2_wp, 1.2_wp), random%uniform(0.2_wp, 1.2_wp), random%uniform(0.05_wp, 1.2_wp)]
      frame = random_frame(random)
      centre = random%uniform(0.0_wp, 2.0_wp)*random_direction(random)
      radius = random%uniform(0.1_wp, 1.5_wp)
      call make_box(half, ex, frame, shape)
      call t%near(overlap_sphere_polyhedron(centre + ex, radius, shape, zero), &
                  overlap_sphere_plane(centre, radius, zero, frame, half), 1e-12_wp, 'box as plane and as polyhedron')
      call t%near(overlap_sphere_polyhedron(centre + ex - 7*ez, radius, shape, -7*ez), &
                  overlap_sphere_plane(centre, radius, zero, frame, half), 1e-12_wp, 'box as an image')
      ! A polyhedron is the sum of its parts on both sides of a plane.
      call box_solid(half, solid)
      do i = 1, 6
        call cut(solid, random_direction(random), random%uniform(0.3_wp, 0.8_wp)*norm2(half))
      end do
      normal = random_direction(random)
      height = random%uniform(-0.1_wp, 0.1_wp)*minval(half)
      call make_polyhedron(solid, shape)
      whole = solid_volume(solid)
      part = solid
      call cut(part, normal, height)
      call make_polyhedron(part, below)
      part = solid
      call cut(part, -normal, -height)
      call make_polyhedron(part, above)
      call place_polyhedron(shape, zero, frame)
      call place_polyhedron(below, zero, frame)
      call place_polyhedron(above, zero, frame)
      volume = overlap_sphere_polyhedron(centre, radius, shape, zero)
      call t%near(overlap_sphere_polyhedron(centre, radius, below, zero) + overlap_sphere_polyhedron(centre, radius, above, zero), &
                  volume, 1e-12_wp, 'sum of two parts')
      call t%check(volume <= min(whole, 4*pi*radius**3/3)*(1 + 1e-12_wp), 'no more than either shape')
      call t%near(overlap_sphere_polyhedron(0.1_wp*centre, 2.5_wp, shape, zero), whole, 1e-12_wp, 'polyhedron in a sphere')
    end do
  end subroutine test_sphere_polyhedron

  subroutine test_boxes()
    type(random_t) :: random
    type(polyhedron_t) :: box, other
    real(wp) :: frame(3, 3), place(3), half(3), volume, shared(3)
    integer :: k, i

    call random%seed(52)
    do k = 1, 300
      frame = random_frame(random)
      place = 10*random_direction(random)
      half = [1.0_wp, 0.8_wp, 0.5_wp]
      call make_box(half, place, frame, box)
      call t%near(overlap_polyhedron_polyhedron(box, box, zero), 3.2_wp, 1e-12_wp, 'a box with itself')
      ! Shifted by whole faces along some axes, so that faces of the two lie in one plane up to rounding
      do i = 1, 3
        shared(i) = random%uniform(-1.0_wp, 1.0_wp)
        if (modulo(k/2**(i - 1), 2) == 0) shared(i) = 0
      end do
      call make_box(half, place + matmul(frame, shared), frame, other)
      volume = product(2*half - abs(shared))
      if (any(2*half <= abs(shared))) volume = 0
      call t%near(overlap_polyhedron_polyhedron(box, other, zero), volume, 1e-12_wp, 'boxes along the same axes')
      call t%near(overlap_polyhedron_plane(box, place + matmul(frame, shared), frame, half), volume, 1e-12_wp, 'box on a plane')
      call t%near(overlap_polyhedron_polyhedron(box, other, 2*half(1)*frame(:, 1) - matmul(frame, shared)), 0.0_wp, 1e-13_wp, &
                  'boxes side by side')
      call t%near(overlap_polyhedron_polyhedron(box, other, 2.1_wp*half(3)*frame(:, 3) - matmul(frame, shared)), 0.0_wp, 0.0_wp, &
                  'boxes apart')
    end do
    ! A cube turned by 45 degrees about z shares with the upright one a prism over a regular octagon.
    call make_box([1.0_wp, 1.0_wp, 1.0_wp], zero, upright, box)
    frame = upright
    frame(:2, 1) = [sqrt(0.5_wp), sqrt(0.5_wp)]
    frame(:2, 2) = [-sqrt(0.5_wp), sqrt(0.5_wp)]
    call make_box([1.0_wp, 1.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, 1.5_wp], frame, other)
    call t%near(overlap_polyhedron_polyhedron(box, other, zero), 0.5_wp*8*(sqrt(2.0_wp) - 1), tight, 'octagonal prism')
  end subroutine test_boxes

  subroutine test_polyhedra()
    type(random_t) :: random
    type(polyhedron_t) :: shape, other
    real(wp) :: volume, other_volume, shared, far(3)
    integer :: k

    call random%seed(53)
    far = [1234.5_wp, -987.6_wp, 321.0_wp]
    do k = 1, 300
      call make_random(random, far, shape, volume)
      call make_random(random, far + random%uniform(0.0_wp, 2.2_wp)*random_direction(random), other, other_volume)
      shared = overlap_polyhedron_polyhedron(shape, other, zero)
      ! Coordinates are rounded to 1e-13.
      call t%near(overlap_polyhedron_polyhedron(other, shape, zero), shared, 1e-11_wp, 'polyhedra exchanged')
      call t%near(overlap_polyhedron_polyhedron(shape, shape, zero), volume, 1e-11_wp, 'a polyhedron with itself')
      call t%check(shared <= min(volume, other_volume) + 1e-11_wp, 'no more than either polyhedron')
      call t%near(overlap_polyhedron_plane(shape, far, random_frame(random), 3*[1.0_wp, 1.0_wp, 1.0_wp]), volume, 1e-11_wp, &
                  'a polyhedron in a box')
      ! Two boxes that share a face hold it together.
      associate (frame => random_frame(random), half => [2.0_wp, 2.0_wp, 1.0_wp])
        call t%near(overlap_polyhedron_plane(shape, far + 0.7_wp*frame(:, 3), frame, half) &
                    + overlap_polyhedron_plane(shape, far - 1.3_wp*frame(:, 3), frame, half), volume, 1e-11_wp, 'in two boxes')
      end associate
    end do
  end subroutine test_polyhedra

  !> Volumes do not depend on the direction along which the first slice is cut, nor on what the room held before.
  subroutine test_directions()
    type(random_t) :: random
    type(polyhedron_t) :: shape, other
    type(overlap_room_t) :: room
    real(wp) :: volume, other_volume, shared, place(3), half(3), frame(3, 3)
    integer :: k, i

    call random%seed(61)
    half = [0.5_wp, 0.8_wp, 1.1_wp]
    do k = 1, 100
      call make_random(random, zero, shape, volume)
      place = random%uniform(0.0_wp, 2.2_wp)*random_direction(random)
      call make_random(random, place, other, other_volume)
      frame = random_frame(random)
      do i = 1, 4
        shared = overlap_polyhedron_polyhedron(shape, other, zero)
        call measure_polyhedra(shape, other, zero, random_direction(random), room, volume)
        call t%near(volume, shared, tight, 'polyhedra, any direction')
        call measure_polyhedra(shape, other, zero, -other%world_normal(:, i), room, volume)
        call t%near(volume, shared, tight, 'polyhedra, against a face of one')
        call measure_polyhedra(shape, other, zero, -shape%world_normal(:, i), room, volume)
        call t%near(volume, shared, tight, 'polyhedra, towards a face of the other')
        shared = overlap_polyhedron_plane(shape, place, frame, half)
        call measure_polyhedron_plane(shape, place, frame, half, random_direction(random), room, volume)
        call t%near(volume, shared, tight, 'polyhedron and plane, any direction')
      end do
    end do
  end subroutine test_directions

  !> Is a point inside a placed polyhedron?
  pure logical function is_inside(shape, point)
    type(polyhedron_t), intent(in) :: shape
    real(wp), intent(in) :: point(3)
    integer :: f

    is_inside = .true.
    do f = 1, shape%n_faces
      is_inside = is_inside .and. dot_product(shape%world_normal(:, f), point - shape%centre) <= shape%face_height(f)
    end do
  end function is_inside

  !> Share of random points in a ball that lie in other shapes too: within five standard deviations.
  subroutine test_random_points()
    type(random_t) :: random
    type(polyhedron_t) :: shape, other
    real(wp) :: centre(3), point(3), axis(3), radius, got(4), volume, cylinder(2)
    integer :: hits(4), k, i

    call random%seed(54)
    do k = 1, 12
      call make_random(random, zero, shape, volume)
      call make_random(random, 0.8_wp*random_direction(random), other, volume)
      centre = 0.8_wp*random_direction(random)
      axis = random_direction(random)
      radius = random%uniform(0.5_wp, 1.5_wp)
      cylinder = [random%uniform(0.1_wp, 1.2_wp), random%uniform(0.2_wp, 0.9_wp)]
      got = [overlap_sphere_polyhedron(centre, radius, shape, zero), overlap_polyhedron_polyhedron(shape, other, zero), &
             overlap_sphere_cylinder(centre, radius, zero, axis, cylinder(1), cylinder(2)), &
             overlap_sphere_hollow_cylinder(centre, radius, zero, axis, cylinder(1), cylinder(2))]
      hits = 0
      do i = 1, n_points
        point = [random%uniform(-2.0_wp, 2.0_wp), random%uniform(-2.0_wp, 2.0_wp), random%uniform(-2.0_wp, 2.0_wp)]
        if (is_inside(shape, point)) then
          if (norm2(point - centre) < radius) hits(1) = hits(1) + 1
          if (is_inside(other, point)) hits(2) = hits(2) + 1
        end if
        point = centre + 0.5_wp*radius*point
        if (norm2(point - centre) > radius) cycle
        associate (along => dot_product(axis, point))
          if (norm2(point - axis*max(-cylinder(1), min(cylinder(1), along))) < cylinder(2)) hits(3) = hits(3) + 1
          if (abs(along) < cylinder(1) .and. norm2(point - along*axis) > cylinder(2)) hits(4) = hits(4) + 1
        end associate
      end do
      call check_hits(t, hits(1), n_points, got(1)/64, 'points in a sphere and a polyhedron')
      call check_hits(t, hits(2), n_points, got(2)/64, 'points in two polyhedra')
      call check_hits(t, hits(3), n_points, got(3)/(2*radius)**3, 'points in a sphere and a cylinder')
      call check_hits(t, hits(4), n_points, got(4)/(2*radius)**3, 'points in a sphere outside a hollow cylinder')
    end do
  end subroutine test_random_points
end program test_overlap_volumes
