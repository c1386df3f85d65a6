!> Volumes that spheres share with spheres, planes (boxes), cylinders and the walls of hollow cylinders.
!!
!! With spheres and planes exact. With cylinders, the discs that sphere and cylinder share across the axis are exact
!! areas, integrated along the axis between all places where they appear, swallow each other or meet an end; over
!! 60,000 random pairs, near tangency or not, parts of the integral add up to the whole within 2e-15 of the ball's volume.
module sg_overlap_spheres
  use sg_kinds, only: wp, pi
  use sg_overlap_ball, only: ball_below_plane, ball_in_faces
  use sg_overlap_disks, only: overlap_disk_disk, overlap_disk_hollow
  use sg_overlap_solid, only: box_solid, solid_t
  implicit none
  private
  public :: overlap_sphere_sphere, overlap_sphere_plane, overlap_sphere_cylinder, overlap_sphere_hollow_cylinder

  !> Places that may part the integral along an axis
  integer, parameter :: most_places = 14

  !> A sphere beside an axis
  type :: beside_t
    !> Radius of the sphere, height of its centre along the axis and distance from the axis [m]
    real(wp) :: radius = 0, along = 0, across = 0
    !> Half height of the cylinder without caps, and its radius [m]
    real(wp) :: half_height = 0, tube = 0
    !> Is the part outside the cylinder wanted? (hollow cylinder, which has no caps)
    logical :: is_hollow = .false.
  end type beside_t

contains

  !> Volume shared by two spheres [m3]: two caps, whose sum has the depth squared before it and so keeps its digits.
  pure real(wp) function overlap_sphere_sphere(centre_c, radius_c, centre_a, radius_a) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the candidate [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the antagonist [m]
    real(wp), intent(in) :: radius_a !! radius of the antagonist [m]
    real(wp) :: distance, depth

    distance = sqrt((centre_c(1) - centre_a(1))**2 + (centre_c(2) - centre_a(2))**2 + (centre_c(3) - centre_a(3))**2)
    depth = radius_c + radius_a - distance
    if (depth <= 0) then
      volume = 0
    else if (distance <= abs(radius_c - radius_a)) then
      volume = 4*pi*min(radius_c, radius_a)**3/3
    else
      volume = pi*depth**2*(distance**2 + 2*distance*(radius_c + radius_a) - 3*(radius_c - radius_a)**2)/(12*distance)
    end if
  end function overlap_sphere_sphere

  !> Volume shared by a sphere and a plane (PLANx), which is a box [m3].
  pure real(wp) function overlap_sphere_plane(centre_c, radius_c, centre_a, frame, half) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the sphere [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the box, the antagonist [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    type(solid_t) :: box
    real(wp) :: local(3), below(6)
    integer :: i

    volume = 0
    do i = 1, 3
      local(i) = dot_product(frame(:, i), centre_c - centre_a)
      below(2*i - 1) = half(i) + local(i)
      below(2*i) = half(i) - local(i)
    end do
    if (any(below <= -radius_c)) return
    if (count(below < radius_c) == 1) then
      volume = ball_below_plane(radius_c, minval(below))
      return
    end if
    call box_solid(half, box)
    do i = 1, 8
      box%vertex(:, i) = box%vertex(:, i) - local
    end do
    volume = ball_in_faces(radius_c, 6, box%normal, box%face_first, box%face_vertex, box%vertex)
  end function overlap_sphere_plane

  !> Volume shared by a sphere and a cylinder with round ends (CYLND) [m3].
  pure real(wp) function overlap_sphere_cylinder(centre_c, radius_c, centre_a, axis, half_height, radius_a) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the sphere [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the cylinder, the antagonist [m]
    real(wp), intent(in) :: axis(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height !! half length of the axis, caps not counted [m]
    real(wp), intent(in) :: radius_a !! radius of the cylinder [m]
    type(beside_t) :: beside
    real(wp) :: distance, beyond

    beside = place_beside(centre_c - centre_a, radius_c, axis, half_height, radius_a)
    beyond = max(0.0_wp, abs(beside%along) - half_height)
    distance = norm2([beside%across, beyond])
    if (distance >= radius_c + radius_a) then
      volume = 0
    else if (distance + radius_c <= radius_a) then
      volume = 4*pi*radius_c**3/3
    else if (beyond >= radius_c) then
      volume = overlap_sphere_sphere([beside%across, beyond, 0.0_wp], radius_c, [0.0_wp, 0.0_wp, 0.0_wp], radius_a)
    else
      volume = sum_of_slices(beside, -half_height - radius_a, half_height + radius_a)
    end if
  end function overlap_sphere_cylinder

  !> Volume of a sphere outside the hollow cylinder (DNLYC) that should hold it [m3], between the planes of its ends.
  pure real(wp) function overlap_sphere_hollow_cylinder(centre_c, radius_c, centre_a, axis, half_height, radius_a) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the sphere [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the hollow cylinder, the antagonist [m]
    real(wp), intent(in) :: axis(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height !! half its height [m]
    real(wp), intent(in) :: radius_a !! its inner radius [m]
    type(beside_t) :: beside

    beside = place_beside(centre_c - centre_a, radius_c, axis, half_height, radius_a)
    beside%is_hollow = .true.
    volume = 0
    if (beside%across + radius_c <= radius_a) return
    volume = sum_of_slices(beside, -half_height, half_height)
  end function overlap_sphere_hollow_cylinder

  !> Where a sphere is as seen from an axis.
  pure function place_beside(between, radius, axis, half_height, tube) result(beside)
    real(wp), intent(in) :: between(3) !! from the middle of the axis to the sphere's centre [m]
    real(wp), intent(in) :: radius !! of the sphere [m]
    real(wp), intent(in) :: axis(3) !! unit vector of the axis
    real(wp), intent(in) :: half_height !! half height of the cylinder [m]
    real(wp), intent(in) :: tube !! radius of the cylinder [m]
    type(beside_t) :: beside

    beside%radius = radius
    beside%along = dot_product(axis, between)
    beside%across = norm2(between - beside%along*axis)
    beside%half_height = half_height
    beside%tube = tube
  end function place_beside

  !> Integral of the areas of slices across the axis [m3].
  pure real(wp) function sum_of_slices(beside, low, high) result(volume)
    type(beside_t), intent(in) :: beside !! the sphere and its cylinder
    real(wp), intent(in) :: low !! where the cylinder starts along its axis [m]
    real(wp), intent(in) :: high !! where it ends [m]
    real(wp) :: place(most_places), last, next
    integer :: n

    call parting_places(beside, place, n)
    volume = 0
    last = max(low, beside%along - beside%radius)
    do while (last < min(high, beside%along + beside%radius))
      ! The next place, in order
      next = min(min(high, beside%along + beside%radius), minval(place(:n), mask=place(:n) > last))
      volume = volume + integral(beside, last, next)
      last = next
    end do
  end function sum_of_slices

  !> Places along the axis where the slices of sphere and cylinder touch, inside or outside, or the cylinder ends.
  pure subroutine parting_places(beside, place, n)
    type(beside_t), intent(in) :: beside
    real(wp), intent(out) :: place(most_places) !! [m]
    integer, intent(out) :: n !! how many
    real(wp) :: touching, linear, constant, a, b, c, root
    integer :: side

    place = 0
    place(1:2) = [-beside%half_height, beside%half_height]
    n = 2
    do side = -1, 1, 2
      ! Beside the straight part: the radius of the sphere's slice is that of the cylinder and the distance, or their difference.
      ! Slices that all but touch are as bad where they are nearest, at the sphere's centre.
      touching = abs(beside%across + real(side, wp)*beside%tube)
      root = sqrt(max(0.0_wp, (beside%radius - touching)*(beside%radius + touching)))
      place(n + 1:n + 2) = beside%along + [-root, root]
      n = n + 2
      if (beside%is_hollow) cycle
      ! At a cap, z from its centre: w^2 - c^2 = linear z + constant, and w = c + e, c - e or e - c where
      ! (linear z + constant)^2 = 4 e^2 (r^2 - z^2), with constant less e^2.
      associate (shift => beside%along - real(side, wp)*beside%half_height, e => beside%across)
        linear = 2*shift
        constant = beside%radius**2 - shift**2 - beside%tube**2 - e**2
        a = linear**2 + 4*e**2
        b = linear*constant
        c = constant**2 - 4*e**2*beside%tube**2
        if (a <= tiny(a)) cycle
        ! On the axis both roots are one, and rounding may leave less than none.
        root = sqrt(max(0.0_wp, b**2 - a*c))
        place(n + 1:n + 2) = real(side, wp)*beside%half_height + ([-root, root] - b)/a
        n = n + 2
      end associate
    end do
  end subroutine parting_places

  !> Integral of the slices between two places, by the double exponential rule, which does not mind roots at the ends [m3].
  pure real(wp) function integral(beside, low, high)
    type(beside_t), intent(in) :: beside
    real(wp), intent(in) :: low, high
    integer, parameter :: n = 34
    real(wp), parameter :: step = 0.095_wp
    real(wp) :: bend, half, part
    integer :: i

    half = 0.5_wp*(high - low)
    integral = 0
    do i = -n, n
      bend = 0.5_wp*pi*sinh(step*real(i, wp))
      ! From the nearer end, so that places close to it stay distinct.
      part = 2*half/(1 + exp(2*abs(bend)))
      integral = integral + step*0.5_wp*pi*cosh(step*real(i, wp))/cosh(bend)**2*slice(beside, merge(low + part, high - part, i < 0))
    end do
    integral = half*integral
  end function integral

  !> Area that sphere and cylinder share across the axis, or of the sphere outside the hollow cylinder [m2].
  pure real(wp) function slice(beside, z)
    type(beside_t), intent(in) :: beside
    real(wp), intent(in) :: z !! place along the axis [m]
    real(wp), parameter :: zero(2) = 0
    real(wp) :: of_sphere, of_tube, beyond

    associate (shift => z - beside%along)
      of_sphere = sqrt(max(0.0_wp, (beside%radius - shift)*(beside%radius + shift)))
    end associate
    if (beside%is_hollow) then
      slice = overlap_disk_hollow([beside%across, 0.0_wp], of_sphere, zero, beside%tube)
    else
      beyond = max(0.0_wp, abs(z) - beside%half_height)
      of_tube = sqrt(max(0.0_wp, (beside%tube - beyond)*(beside%tube + beyond)))
      slice = overlap_disk_disk([beside%across, 0.0_wp], of_sphere, zero, of_tube)
    end if
  end function slice
end module sg_overlap_spheres
