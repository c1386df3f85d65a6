!> Gaps of pairs that overlap deeply: by hand, and for every pair of the table against a search over all directions.
!!
!! Two convex shapes overlap by the least translation that parts them: minus the greatest s(n) over unit vectors n, where s(n) is
!! the least n.x of the candidate less the greatest of the antagonist. A hollow shape is left by the farthest point of the other.
program test_pair_gap
  use harness, only: tests_t
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_segment, contactors_t, kind_cylinder, kind_disk, kind_hollow, &
                           kind_hollow_cylinder, kind_names, kind_plane, kind_polygon, kind_polyhedron, kind_segment, kind_sphere, &
                           place_contactors
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4, pi
  use sg_near, only: candidate_first
  use sg_pair_gap, only: pair_gap
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_random, only: random_t
  use sg_rotations, only: frame_of, no_rotation, quaternion_product, rotation_by, turned_by
  use sg_scene, only: scene_t
  use sg_shape_kinds, only: kind_point, n_kinds, shape_kinds
  use sg_shape_pairs, only: can_touch, datbox_pair_name, is_datbox_pair, is_pair
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  use sg_space_generators, only: random_direction, random_rotation
  use sg_tally, only: pass_sums, tally_t
  use sg_volume_error, only: measure_volume_error
  implicit none
  real(wp), parameter :: none(3) = 0, z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
  type(tests_t) :: t

  call test_plane_by_hand()
  call test_space_by_hand()
  call test_crossed_edges()
  call test_every_pair()
  call t%finish()

contains

  !> Pairs in the plane.
  subroutine test_plane_by_hand()
    type(scene_t) :: scene
    real(wp), parameter :: square(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
    real(wp) :: middle(3, 5)

    call add_disk(scene%contactors, 1, 1, 0.5_wp, none(:2))
    call add_segment(scene%contactors, 2, 1, 2.0_wp, 0.25_wp, none(:2), 0.0_wp)
    call add_polygon(scene%contactors, 3, 1, square, none(:2))
    call add_polygon(scene%contactors, 4, 1, square, none(:2))
    call add_disk(scene%contactors, 5, 1, 0.5_wp, none(:2))
    middle(:, 1) = [0.0_wp, 0.6_wp, 0.0_wp]
    middle(:, 2) = [0.5_wp, 0.0_wp, 0.0_wp]
    middle(:, 3) = [0.0_wp, 2.05_wp, 0.0_wp]
    middle(:, 4) = [0.0_wp, 2.05_wp + 1 + sqrt(2.0_wp) - 0.125_wp, pi/4]
    middle(:, 5) = [1.3_wp, 3.45_wp, 0.0_wp]
    call place_contactors(scene%contactors, middle)
    call check_depth(scene, 1, 2, none, 0.15_wp, 'disk on a segment')
    call check_depth(scene, 1, 2, [1.9_wp, 0.0_wp, 0.0_wp], 0.75_wp - norm2([0.4_wp, 0.6_wp]), 'beside its end')
    call check_depth(scene, 1, 3, none, 0.05_wp, 'disk under a square')
    call check_depth(scene, 4, 3, none, 0.125_wp, 'corner in an edge')
    call check_depth(scene, 5, 3, none, 0.5_wp - norm2([0.3_wp, 0.4_wp]), 'disk at a corner')
    call check_depth(scene, 1, 1, [0.7_wp, 0.0_wp, 0.0_wp], 0.3_wp, 'two disks')
    call check_depth(scene, 3, 2, none, 0.25_wp - 1.05_wp, 'segment apart from a square')
  end subroutine test_plane_by_hand

  !> Pairs in space.
  subroutine test_space_by_hand()
    type(scene_t) :: scene
    real(wp) :: middle(7, 6)
    type(polyhedron_t) :: cube
    type(error_t), allocatable :: error

    scene%dimension = 3
    scene%contactors%dimension = 3
    call box_polyhedron([1.0_wp, 1.0_wp, 1.0_wp], cube, error)
    call add_sphere(scene%contactors, 1, 1, 0.5_wp, none)
    call add_plane(scene%contactors, 2, 1, [2.0_wp, 2.0_wp, 0.25_wp], none, frame_of(no_rotation))
    call add_polyhedron(scene%contactors, 3, 1, cube, none)
    call add_polyhedron(scene%contactors, 4, 1, cube, none)
    call add_cylinder(scene%contactors, 5, 1, 1.0_wp, 0.5_wp, none, z)
    call add_hollow_cylinder(scene%contactors, 6, 1, 1.0_wp, 3.0_wp, none, z)
    middle(4:, :) = spread(no_rotation, 2, 6)
    middle(:3, 1) = [0.0_wp, 0.0_wp, 0.65_wp]
    middle(:3, 2) = none
    middle(:3, 3) = [0.0_wp, 0.0_wp, 2.05_wp]
    ! An edge upwards, an eighth deep in the cube above.
    middle(:3, 4) = [0.0_wp, 0.0_wp, 3.05_wp + sqrt(2.0_wp) - 0.125_wp]
    middle(4:, 4) = rotation_by([0.0_wp, pi/4, 0.0_wp])
    middle(:3, 5) = [1.5_wp, 0.0_wp, 0.0_wp]
    middle(:3, 6) = none
    call place_contactors(scene%contactors, middle)
    call check_depth(scene, 1, 2, none, 0.1_wp, 'sphere on a plane')
    call check_depth(scene, 1, 2, [2.2_wp, 0.0_wp, 0.0_wp], 0.5_wp - norm2([0.2_wp, 0.4_wp]), 'beside its edge')
    call check_depth(scene, 1, 2, [2.2_wp, 2.1_wp, 0.2_wp], 0.5_wp - norm2([0.2_wp, 0.1_wp, 0.2_wp]), 'at its corner')
    call check_depth(scene, 1, 3, none, 0.5_wp - 0.4_wp, 'sphere under a cube')
    call check_depth(scene, 1, 3, [0.0_wp, 0.0_wp, -1.9_wp], 1.5_wp - 0.5_wp, 'its centre in the cube')
    call check_depth(scene, 4, 3, none, 0.125_wp, 'edge in a face')
    call check_depth(scene, 4, 3, [0.0_wp, 0.0_wp, -0.225_wp], -0.1_wp, 'edge above a face')
    call check_depth(scene, 1, 5, none, 1 - 1.5_wp, 'capsule and sphere side by side')
    call check_depth(scene, 1, 5, [-1.5_wp, 0.0_wp, -1.0_wp], 1 - 0.65_wp, 'sphere above the capsule')
    call check_depth(scene, 5, 2, [0.0_wp, 0.0_wp, -1.0_wp], 0.5_wp + 0.25_wp, 'capsule that stands in a plane')
    call check_depth(scene, 1, 6, [-2.7_wp, 0.0_wp, 0.0_wp], 0.2_wp, 'sphere within a hollow cylinder')
    call check_depth(scene, 1, 6, none, -2.5_wp, 'in its middle')
    call check_depth(scene, 1, 6, [0.0_wp, 0.0_wp, 5.0_wp], -1.0_wp, 'beyond its end')
    call check_depth(scene, 1, 6, [9.0_wp, 0.0_wp, 0.0_wp], 6.5_wp, 'outside of it: detection draws it in')
    call check_depth(scene, 1, 1, [0.0_wp, 0.6_wp, 0.0_wp], 0.4_wp, 'two spheres')
    call check_depth(scene, 5, 5, [0.0_wp, 0.0_wp, 2.5_wp], 0.5_wp, 'two capsules in line')
    call check_depth(scene, 5, 5, [0.6_wp, 0.0_wp, 0.3_wp], 0.4_wp, 'two capsules side by side')
    call check_depth(scene, 5, 5, none, 1.0_wp, 'two capsules at one place')
  end subroutine test_space_by_hand

  !> Two cubes whose edges cross: only the product of the edges parts them. And all of it turned together.
  subroutine test_crossed_edges()
    type(scene_t) :: scene
    type(polyhedron_t) :: cube
    type(error_t), allocatable :: error
    type(random_t) :: random
    real(wp) :: middle(7, 2), turn(4)
    integer :: i

    call random%seed(8)
    scene%dimension = 3
    scene%contactors%dimension = 3
    call box_polyhedron([1.0_wp, 1.0_wp, 1.0_wp], cube, error)
    call add_polyhedron(scene%contactors, 1, 1, cube, none)
    call add_polyhedron(scene%contactors, 2, 1, cube, none)
    do i = 1, 20
      turn = random_rotation(random)
      ! Along x the one has an edge along z, the other one along y, at sqrt(2) from their centres.
      middle(:3, 1) = 0
      middle(:3, 2) = turned_by(turn, [2*sqrt(2.0_wp) - 0.07_wp, 0.0_wp, 0.0_wp])
      middle(4:, 1) = quaternion_product(turn, rotation_by([0.0_wp, 0.0_wp, pi/4]))
      middle(4:, 2) = quaternion_product(turn, rotation_by([0.0_wp, pi/4, 0.0_wp]))
      call place_contactors(scene%contactors, middle)
      call t%near(pair_gap(scene, [2_i4, 1_i4], [0_i4, 0_i4]), -0.07_wp, 1e-13_wp, 'crossed edges')
    end do
  end subroutine test_crossed_edges

  !> Check the depth of a pair whose antagonist is moved; of a pair that does not overlap there is none.
  subroutine check_depth(scene, candidate, antagonist, shift, depth, name)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: candidate, antagonist
    real(wp), intent(in) :: shift(3), depth
    character(len=*), intent(in) :: name
    type(scene_t) :: moved
    real(wp) :: gap

    moved = scene
    moved%contactors%centre(:, candidate) = moved%contactors%centre(:, candidate) - shift(:scene%dimension)
    if (moved%contactors%kind(candidate) == kind_polyhedron) then
      associate (shape => moved%contactors%space%polyhedra(moved%contactors%row(candidate)))
        shape%world_vertex = shape%world_vertex - spread(shift, 2, shape%n_vertices)
        shape%centre = shape%centre - shift
      end associate
    end if
    if (candidate == antagonist) moved = twice(scene, candidate, shift)
    gap = pair_gap(moved, int([candidate, merge(antagonist, moved%contactors%n, candidate /= antagonist)], i4), [0_i4, 0_i4])
    if (depth > 0) then
      ! Rounding of some operations on numbers of size ten.
      call t%near(-gap, depth, 1e-14_wp, name)
    else
      call t%check(gap > 1, name)
    end if
  end subroutine check_depth

  !> A scene with a copy of a round shape behind the others, moved.
  function twice(scene, c, shift) result(both)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: c
    real(wp), intent(in) :: shift(3)
    type(scene_t) :: both

    both = scene
    if (scene%dimension == 2) then
      call add_disk(both%contactors, 1, 1, both%contactors%reach(c), none(:2))
    else if (scene%contactors%kind(c) == kind_sphere) then
      call add_sphere(both%contactors, 1, 1, both%contactors%reach(c), none)
    else
      call add_cylinder(both%contactors, 1, 1, 1.0_wp, 0.5_wp, none, z)
      both%contactors%space%cylinder_world(:, 2) = z
    end if
    both%contactors%centre(:, both%contactors%n) = scene%contactors%centre(:, c) + shift(:scene%dimension)
  end function twice

  !> All pairs of the table that touch, at places where most overlap deeply: each has a kernel that finds the gap, an overlap, and
  !! a name in a DATBOX.
  subroutine test_every_pair()
    type(random_t) :: random
    integer, parameter :: cases = 60
    integer :: i, k, n_deep, n_wrong, n_apart, kinds(2)
    logical :: touches, has_overlap
    character(len=:), allocatable :: name

    call random%seed(15)
    do i = 0, n_kinds**2 - 1
      kinds = 1 + [i/n_kinds, mod(i, n_kinds)]
      if (.not. is_pair(kinds(1), kinds(2))) cycle
      ! Points are the ends of links alone, and the volume error does not count a cylinder in a hollow one.
      touches = kinds(1) /= kind_point
      has_overlap = kinds(2) /= kind_hollow_cylinder .or. kinds(1) /= kind_cylinder
      name = trim(kind_names(kinds(1)))//' and '//trim(kind_names(kinds(2)))
      call t%check(can_touch(kinds(1), kinds(2)) .eqv. touches, name//': they touch')
      call t%check(can_touch(kinds(2), kinds(1)) .eqv. touches, name//': and the other way round')
      call t%check(kinds(1) == kinds(2) .or. .not. is_pair(kinds(2), kinds(1)), name//': one order')
      associate (dimension => shape_kinds(kinds)%dimension)
        call t%equal(dimension(1), dimension(2), name//': of one space')
        call t%check(is_datbox_pair(datbox_pair_name(kinds, max(2, dimension(1))), max(2, dimension(1))), name//': in a DATBOX')
      end associate
      if (.not. touches) cycle
      n_deep = 0
      n_wrong = 0
      n_apart = 0
      do k = 1, cases
        call try_pair(kinds([2, 1]), random, has_overlap, n_deep, n_wrong, n_apart)
      end do
      call t%equal(n_wrong, 0, name//': gaps are those of the best direction')
      call t%equal(n_apart, 0, name//': deep in each other they overlap')
      call t%check(n_deep > cases/6, name//': some overlap deeply')
    end do
  end subroutine test_every_pair

  !> One pair at random: its gap is no less than along any direction, and as large as along the best.
  subroutine try_pair(kinds, random, has_overlap, n_deep, n_wrong, n_apart)
    integer, intent(in) :: kinds(2)
    type(random_t), intent(inout) :: random
    logical, intent(in) :: has_overlap
    integer, intent(inout) :: n_deep, n_wrong, n_apart
    type(scene_t) :: scene
    real(wp), allocatable :: middle(:, :)
    real(wp) :: gap, best, way(3), error
    integer :: pair(2), k

    scene%dimension = 3
    if (any(kinds(1) == [kind_disk, kind_segment, kind_hollow, kind_polygon])) scene%dimension = 2
    scene%contactors%dimension = scene%dimension
    do k = 1, 2
      call add_shape(scene%contactors, kinds(k), k, random)
    end do
    way = random_direction(random)*random%uniform(0.0_wp, 0.8_wp)*sum(scene%contactors%reach(:2))
    ! The ends of a hollow cylinder, which are open, stay far.
    if (any(kinds == kind_hollow_cylinder)) way(3) = 0.1_wp*way(3)
    allocate (middle(merge(3, 7, scene%dimension == 2), 2), source=0.0_wp)
    middle(:scene%dimension, 2) = way(:scene%dimension)
    do k = 1, 2
      if (scene%dimension == 2) then
        middle(3, k) = random%uniform(-pi, pi)
      else if (kinds(k) == kind_hollow_cylinder) then
        middle(4:, k) = no_rotation
      else
        middle(4:, k) = random_rotation(random)
      end if
    end do
    call place_contactors(scene%contactors, middle)
    pair = merge([1, 2], [2, 1], candidate_first(scene%contactors, 1, 2))
    gap = pair_gap(scene, int(pair, i4), [0_i4, 0_i4])
    best = best_separation(scene%contactors, pair, random)
    if (best < -0.2_wp*minval(scene%contactors%reach(:2))) n_deep = n_deep + 1
    if (best < -0.2_wp*minval(scene%contactors%reach(:2)) .and. (overlap_of(scene, pair) > 0 .neqv. has_overlap)) &
      n_apart = n_apart + 1
    if (gap > 0) gap = max(0.0_wp, best)
    error = gap - best
    if (any(kinds == kind_hollow) .or. any(kinds == kind_hollow_cylinder)) error = -error
    ! A round shape whose axis is in the box leaves it by a large face, which may be the longer way.
    if (any(kinds == kind_plane) .and. best < -least_radius(scene%contactors)) error = max(error, 0.0_wp)
    ! Rounding apart, no direction found is better than that of the gap. The search may end in the second best place, which for
    ! boxes deep in each other was up to a tenth worse.
    if (error < -1e-9_wp .or. error > 0.02_wp - 0.2_wp*min(gap, 0.0_wp)) n_wrong = n_wrong + 1
  end subroutine try_pair

  !> Overlap of a pair as the volume error counts it [m2, in space m3].
  real(wp) function overlap_of(scene, pair) result(overlap)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: pair(2)
    type(contacts_t) :: contacts
    type(tally_t) :: tally

    contacts%dimension = scene%dimension
    call reserve_contacts(contacts, 1)
    contacts%n = 1
    contacts%contactor(:, 1) = int(pair, i4)
    contacts%gap(1) = -1
    contacts%image(1) = 0
    if (scene%dimension == 3) contacts%image_y(1) = 0
    tally%pass = pass_sums
    call measure_volume_error(scene, contacts, tally)
    overlap = sum(tally%sums%get('overlap', 1))
  end function overlap_of

  !> Radius of the sphere or capsule among two shapes [m].
  pure real(wp) function least_radius(contactors)
    type(contactors_t), intent(in) :: contactors

    least_radius = huge(1.0_wp)
    if (contactors%n_rows(kind_sphere) > 0) least_radius = contactors%space%sphere_radius(1)
    if (contactors%n_rows(kind_cylinder) > 0) least_radius = contactors%space%cylinder_size(2, 1)
  end function least_radius

  !> Add a shape of a size between 0.1 and 1.
  subroutine add_shape(contactors, kind, body, random)
    type(contactors_t), intent(inout) :: contactors
    integer, intent(in) :: kind, body
    type(random_t), intent(inout) :: random
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: size_of, corner(2, 5)
    integer :: k

    size_of = 10**random%uniform(-1.0_wp, 0.0_wp)
    select case (kind)
    case (kind_disk)
      call add_disk(contactors, body, 1, size_of, none(:2))
    case (kind_segment)
      call add_segment(contactors, body, 1, size_of, 0.2_wp*size_of, none(:2), 0.4_wp)
    case (kind_hollow)
      call add_hollow(contactors, body, 1, 1.0_wp, none(:2))
    case (kind_polygon)
      do k = 1, 5
        associate (angle => 2*pi*(real(k, wp) + random%uniform(0.0_wp, 0.8_wp))/5)
          corner(:, k) = size_of*[cos(angle), sin(angle)]
        end associate
      end do
      call add_polygon(contactors, body, 1, corner, none(:2))
    case (kind_sphere)
      call add_sphere(contactors, body, 1, size_of, none)
    case (kind_plane)
      call add_plane(contactors, body, 1, [1.0_wp, 0.7_wp, 0.1_wp], none, frame_of(no_rotation))
    case (kind_cylinder)
      call add_cylinder(contactors, body, 1, size_of, 0.4_wp*size_of, none, z)
    case (kind_hollow_cylinder)
      call add_hollow_cylinder(contactors, body, 1, 9.0_wp, 1.0_wp, none, z)
    case (kind_polyhedron)
      call box_polyhedron(size_of*[random%uniform(0.3_wp, 1.0_wp), random%uniform(0.3_wp, 1.0_wp), 1.0_wp], shape, error)
      call add_polyhedron(contactors, body, 1, shape, none)
    end select
  end subroutine add_shape

  !> Greatest separation of a pair over directions: many at random, then smaller and smaller turns of the best.
  real(wp) function best_separation(contactors, pair, random) result(best)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: pair(2)
    type(random_t), intent(inout) :: random
    integer, parameter :: directions = 1500, turns = 1500
    real(wp) :: direction(3), trial(3), value
    integer :: k

    best = -huge(best)
    direction = z
    do k = 1, directions + turns
      trial = random_direction(random)
      if (k > directions) trial = direction + 0.3_wp*exp(-12*real(k - directions, wp)/turns)*trial
      if (contactors%dimension == 2 .or. contactors%n_rows(kind_hollow_cylinder) > 0) trial(3) = 0
      trial = trial/norm2(trial)
      value = separation(contactors, pair, trial)
      if (value <= best) cycle
      best = value
      direction = trial
    end do
    if (contactors%n_rows(kind_hollow) + contactors%n_rows(kind_hollow_cylinder) > 0) best = -best
  end function best_separation

  !> Separation of a pair along a direction; of a hollow shape minus the gap of its wall there.
  pure real(wp) function separation(contactors, pair, n)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: pair(2)
    real(wp), intent(in) :: n(3)

    if (contactors%kind(pair(2)) == kind_hollow .or. contactors%kind(pair(2)) == kind_hollow_cylinder) then
      associate (centre => contactors%centre(:, pair(2)))
        separation = farthest(contactors, pair(1), n) - dot_product(centre, n(:size(centre))) - 1
      end associate
    else
      separation = -farthest(contactors, pair(1), -n) - farthest(contactors, pair(2), n)
    end if
  end function separation

  !> Greatest n.x of a convex shape; polygons have five vertices.
  pure real(wp) function farthest(contactors, c, n)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: n(3)
    integer :: first

    farthest = dot_product(contactors%centre(:, c), n(:contactors%dimension))
    first = int(5*contactors%row(c)) - 4
    associate (row => contactors%row(c), space => contactors%space)
      select case (contactors%kind(c))
      case (kind_segment)
        farthest = farthest + contactors%segment_size(1, row)*abs(dot_product(contactors%segment_axis(:, row), n(:2))) &
                   + contactors%segment_size(2, row)
      case (kind_polygon)
        associate (corner => contactors%polygon_world(:, first:first + 4))
          farthest = maxval(n(1)*corner(1, :) + n(2)*corner(2, :))
        end associate
      case (kind_plane)
        farthest = farthest + dot_product(space%plane_half(:, row), abs(matmul(n, reshape(space%plane_world(:, row), [3, 3]))))
      case (kind_cylinder)
        farthest = farthest + space%cylinder_size(1, row)*abs(dot_product(space%cylinder_world(:, row), n)) &
                   + space%cylinder_size(2, row)
      case (kind_polyhedron)
        farthest = maxval(matmul(n, space%polyhedra(row)%world_vertex))
      case default
        farthest = farthest + contactors%reach(c)
      end select
    end associate
  end function farthest
end program test_pair_gap
