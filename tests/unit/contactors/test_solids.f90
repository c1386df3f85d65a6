!> Volume, centre and inertia of shapes in space and of bodies made of several.
program test_solids
  use harness, only: tests_t
  use polyhedra, only: identity, none, prism_polyhedron, rounding, same_solid
  use sg_error, only: error_t
  use sg_kinds, only: wp, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: move_polyhedron
  use sg_polyhedron_moments, only: box_solid, capsule_solid, composed_solid, cylinder_solid, moved_solid, polyhedron_solid, &
                                   principal_inertia, solid_t, sphere_solid
  use sg_random, only: random_t
  use sg_rotations, only: frame_of
  implicit none
  type(tests_t) :: t

  call test_round_solids()
  call test_composition()
  call test_principal()
  call test_monte_carlo()
  call t%finish()

contains

  !> Sphere, capsule and cylinder against sums over slices across their axis.
  subroutine test_round_solids()
    real(wp), parameter :: radius = 0.7_wp, half_height = 1.3_wp
    integer, parameter :: n = 20000
    type(solid_t) :: capsule, sphere, cylinder
    real(wp) :: z, square, volume, along, across, width, weight
    integer :: i

    volume = 0
    along = 0
    across = 0
    ! Simpson's rule over the ball's half height, where r^2 = R^2 - z^2 is a polynomial: exact up to rounding in the
    ! volume, and to the fourth power of the width in the rest.
    width = radius/real(n, wp)
    do i = 0, n
      z = width*real(i, wp)
      square = radius**2 - z**2
      weight = 2*width/3*merge(1.0_wp, merge(2.0_wp, 4.0_wp, mod(i, 2) == 0), i == 0 .or. i == n)
      volume = volume + weight*pi*square
      along = along + weight*pi*square**2/2
      across = across + weight*pi*(square**2/4 + square*(half_height + z)**2)
    end do
    cylinder = cylinder_solid(half_height, radius)
    capsule = capsule_solid(half_height, radius)
    call t%near(capsule%volume, cylinder%volume + volume, 1e-11_wp, 'volume of a capsule')
    call t%near(capsule%inertia(3, 3), cylinder%inertia(3, 3) + along, 1e-11_wp, 'inertia of a capsule about its axis')
    call t%near(capsule%inertia(1, 1), cylinder%inertia(1, 1) + across, 1e-11_wp, 'and across it')
    sphere = sphere_solid(radius)
    call same_solid(t, capsule_solid(0.0_wp, radius), sphere, 'a capsule without length is a sphere')
    call t%near(sphere%volume, volume, 1e-11_wp, 'volume of a sphere')
    call t%near(sphere%inertia(2, 2), along, 1e-11_wp, 'inertia of a sphere')
    ! The prism of ever more sides: mr^2/2, m(r^2/4 + h^2/3).
    call t%near(cylinder%inertia(3, 3), cylinder%volume*radius**2/2, rounding, 'inertia of a cylinder about its axis')
    call t%near(cylinder%inertia(1, 1), cylinder%volume*(radius**2/4 + half_height**2/3), rounding, 'and across it')
    call t%near(cylinder%volume, pi*radius**2*2*half_height, rounding, 'volume of a cylinder')
  end subroutine test_round_solids

  !> Boxes put together are the large box; turned and shifted they are the large box turned and shifted.
  subroutine test_composition()
    type(solid_t) :: parts(2), whole, large
    real(wp) :: frame(3, 3)

    parts(1) = moved_solid(box_solid([1.0_wp, 2.0_wp, 3.0_wp]), [-1.0_wp, 0.0_wp, 0.0_wp], identity)
    parts(2) = moved_solid(box_solid([0.5_wp, 2.0_wp, 3.0_wp]), [0.5_wp, 0.0_wp, 0.0_wp], identity)
    whole = composed_solid(parts)
    large = moved_solid(box_solid([1.5_wp, 2.0_wp, 3.0_wp]), [-0.5_wp, 0.0_wp, 0.0_wp], identity)
    call same_solid(t, whole, large, 'two boxes side by side')
    frame = frame_of([0.2_wp, -0.4_wp, 0.5_wp, 0.7_wp])
    parts(1) = moved_solid(parts(1), [5.0_wp, -3.0_wp, 2.0_wp], frame)
    parts(2) = moved_solid(parts(2), [5.0_wp, -3.0_wp, 2.0_wp], frame)
    call same_solid(t, composed_solid(parts), moved_solid(large, [5.0_wp, -3.0_wp, 2.0_wp], frame), 'turned and shifted')
    whole = composed_solid(parts(:0))
    call t%check(abs(whole%volume) <= 0, 'nothing has no volume')
  end subroutine test_composition

  !> Principal axes of turned boxes, of cubes, and of the same box written with seven digits.
  subroutine test_principal()
    type(solid_t) :: solid
    real(wp) :: moments(3), axes(3, 3), turned(3, 3), other(3, 3)

    turned = frame_of([1.0_wp, 0.1_wp, -0.2_wp, 0.15_wp])
    solid = moved_solid(box_solid([1.0_wp, 2.0_wp, 3.0_wp]), [7.0_wp, 8.0_wp, 9.0_wp], turned)
    call principal_inertia(solid, moments, axes)
    call t%check(maxval(abs(axes - turned)) < 10*rounding, 'the axes of a turned box')
    call t%check(maxval(abs(moments - 16*[13.0_wp, 10.0_wp, 5.0_wp])) < 1e3_wp*rounding, 'and its moments')
    solid = moved_solid(box_solid([1.0_wp, 1.0_wp, 1.0_wp]), [1.0_wp, 2.0_wp, 3.0_wp], turned)
    call principal_inertia(solid, moments, axes)
    call t%check(maxval(abs(axes - identity)) < rounding, 'a cube turned keeps the axes given')
    solid = box_solid([1.0_wp, 1.0_wp, 2.0_wp])
    solid%inertia(1, 2) = 1e-12_wp
    solid%inertia(2, 1) = 1e-12_wp
    call principal_inertia(solid, moments, axes)
    call t%check(maxval(abs(axes - identity)) < rounding, 'a square column keeps its axes whatever rounding says')
    solid = box_solid([1.0_wp, 1.1_wp, 2.0_wp])
    call principal_inertia(solid, moments, other)
    solid%inertia(1:2, 3) = 1e-5_wp
    solid%inertia(3, 1:2) = 1e-5_wp
    call principal_inertia(solid, moments, axes)
    call t%check(maxval(abs(axes - other)) < 1e-5_wp, 'a small change turns the axes a little')
  end subroutine test_principal

  !> Volume, centre and inertia by random points within.
  subroutine test_monte_carlo()
    integer, parameter :: n = 400000
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(random_t) :: random
    type(solid_t) :: solid
    real(wp) :: x(3), volume, first(3), inertia(3, 3), tolerance, arm(3)
    integer :: i, k, f

    call random%seed(14)
    call prism_polyhedron(5, 0.9_wp, 0.4_wp, shape, error)
    call none(t, error, 'a prism')
    call move_polyhedron(shape, [0.0_wp, 0.0_wp, 0.0_wp], frame_of([0.9_wp, 0.3_wp, -0.2_wp, 0.4_wp]))
    solid = polyhedron_solid(shape)
    volume = 0
    first = 0
    inertia = 0
    points: do i = 1, n
      x = [(random%uniform(-1.0_wp, 1.0_wp), k=1, 3)]
      do f = 1, shape%n_faces
        arm = x - shape%vertex(:, shape%face_vertex(shape%face_first(f)))
        if (dot_product(arm, shape%normal(:, f)) > 0) cycle points
      end do
      arm = x - solid%centre
      volume = volume + 8/real(n, wp)
      first = first + 8*arm/real(n, wp)
      do k = 1, 3
        inertia(k, k) = inertia(k, k) + 8*sum(arm**2)/real(n, wp)
        inertia(:, k) = inertia(:, k) - 8*arm*arm(k)/real(n, wp)
      end do
    end do points
    ! The standard deviation of these means is below 8*0.5/sqrt(n); four of them are allowed.
    tolerance = 16/sqrt(real(n, wp))
    call t%check(solid%volume > 20*tolerance, 'the volume is larger than the noise')
    call t%near(volume, solid%volume, tolerance, 'volume by random points')
    call t%check(maxval(abs(first)) < tolerance, 'centre by random points')
    call t%check(maxval(abs(inertia - solid%inertia)) < tolerance, 'inertia by random points')
  end subroutine test_monte_carlo
end program test_solids
