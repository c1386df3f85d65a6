!> Volume that two cylinders with round ends (CYLND) share.
!!
!! Planes parallel to both axes cut both shapes along rounded segments (a segment and all points within a radius of it).
!! What two of these share is taken exactly, from the pieces of the boundary of each that lie inside the other, and
!! integrated across the planes.
module sg_overlap_capsules
  use sg_kinds, only: wp, pi
  use sg_vectors, only: cross
  implicit none
  private
  public :: overlap_cylinder_cylinder

  !> Sine of the angle between two axes below which they are parallel
  real(wp), parameter :: parallel = 1e-8_wp
  !> Most places that part a piece of a boundary: two a circle and one a line, or two a line, and both ends
  integer, parameter :: most_places = 10

  !> A rounded segment: centre, unit vector of the axis, half length of the axis, radius of the caps [m]
  type :: slice_t
    real(wp) :: centre(2) = 0, axis(2) = 0, half = 0, radius = 0
  end type slice_t

contains

  !> Volume shared by two cylinders with round ends [m3], to 1e-4 of itself.
  pure real(wp) function overlap_cylinder_cylinder(centre_c, axis_c, half_height_c, radius_c, centre_a, axis_a, half_height_a, &
                                                   radius_a) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the candidate [m]
    real(wp), intent(in) :: axis_c(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_c !! half length of its axis, caps not counted [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the antagonist [m]
    real(wp), intent(in) :: axis_a(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_a !! half length of its axis, caps not counted [m]
    real(wp), intent(in) :: radius_a !! its radius [m]
    type(slice_t) :: c, a
    real(wp) :: between(3), normal(3), beside(3), height, low, high

    between = centre_a - centre_c
    volume = 0
    if (norm2(between) >= half_height_c + radius_c + half_height_a + radius_a) return
    normal = plane_normal(axis_c, axis_a, between)
    beside = cross(normal, axis_c)
    height = dot_product(normal, between)
    low = max(-radius_c, height - radius_a)
    high = min(radius_c, height + radius_a)
    if (low >= high) return
    c = slice_t(centre=[0.0_wp, 0.0_wp], axis=[1.0_wp, 0.0_wp], half=half_height_c, radius=radius_c)
    a = slice_t(centre=[dot_product(axis_c, between), dot_product(beside, between)], &
                axis=[dot_product(axis_c, axis_a), dot_product(beside, axis_a)], half=half_height_a, radius=radius_a)
    call narrow(c, a, height, low, high)
    if (low < high) volume = integral(c, a, height, low, high)
  end function overlap_cylinder_cylinder

  !> Cut the range of heights down to where slices meet: where their radii together exceed the distance of their axes.
  !!
  !! The sum of the radii is a concave function of the height, so this is an interval on both sides of its maximum.
  pure subroutine narrow(c, a, height, low, high)
    type(slice_t), intent(in) :: c, a
    real(wp), intent(in) :: height
    real(wp), intent(inout) :: low, high
    integer, parameter :: rounds = 60
    real(wp) :: left, right, top, bottom, distance
    integer :: i

    distance = distance_of_axes(c, a)
    left = low
    right = high
    do i = 1, rounds
      if (sum_of_radii(left + (right - left)/3) < sum_of_radii(right - (right - left)/3)) then
        left = left + (right - left)/3
      else
        right = right - (right - left)/3
      end if
    end do
    top = (left + right)/2
    if (sum_of_radii(top) <= distance) then
      high = low
      return
    end if
    bottom = top
    do i = 1, rounds
      if (sum_of_radii((low + bottom)/2) > distance) bottom = (low + bottom)/2
      if (sum_of_radii((low + bottom)/2) <= distance) low = (low + bottom)/2
      if (sum_of_radii((high + top)/2) > distance) top = (high + top)/2
      if (sum_of_radii((high + top)/2) <= distance) high = (high + top)/2
    end do

  contains

    pure real(wp) function sum_of_radii(z)
      real(wp), intent(in) :: z

      sum_of_radii = sqrt(max(0.0_wp, (c%radius - z)*(c%radius + z))) &
                     + sqrt(max(0.0_wp, (a%radius - z + height)*(a%radius + z - height)))
    end function sum_of_radii
  end subroutine narrow

  !> Distance of the axes of two rounded segments [m].
  pure real(wp) function distance_of_axes(a, b) result(distance)
    type(slice_t), intent(in) :: a, b
    real(wp) :: between(2), sine, side
    integer :: i

    between = b%centre - a%centre
    sine = a%axis(1)*b%axis(2) - a%axis(2)*b%axis(1)
    if (abs(between(1)*b%axis(2) - between(2)*b%axis(1)) < a%half*abs(sine) .and. &
        abs(between(1)*a%axis(2) - between(2)*a%axis(1)) < b%half*abs(sine)) then
      distance = 0
      return
    end if
    distance = huge(distance)
    do i = -1, 1, 2
      side = real(i, wp)
      distance = min(distance, distance_to(a%centre + side*a%half*a%axis, b), distance_to(b%centre + side*b%half*b%axis, a))
    end do
  end function distance_of_axes

  !> Unit vector across both axes; where these are parallel, across them in the direction of the offset or in any.
  pure function plane_normal(axis_c, axis_a, between) result(normal)
    real(wp), intent(in) :: axis_c(3), axis_a(3), between(3)
    real(wp) :: normal(3), unit(3)

    normal = cross(axis_c, axis_a)
    if (norm2(normal) <= parallel) then
      normal = between - dot_product(axis_c, between)*axis_c
      if (norm2(normal) <= parallel*norm2(between)) then
        unit = 0
        unit(minloc(abs(axis_c), 1)) = 1
        normal = cross(axis_c, unit)
      end if
    end if
    normal = normal/norm2(normal)
  end function plane_normal

  !> Integral of what the slices share [m3], by the double exponential rule in four parts.
  pure real(wp) function integral(c, a, height, low, high)
    type(slice_t), intent(in) :: c !! candidate cut through its axis
    type(slice_t), intent(in) :: a !! antagonist cut through its axis
    real(wp), intent(in) :: height !! of the antagonist's axis above the candidate's [m]
    real(wp), intent(in) :: low, high
    integer, parameter :: n = 20, parts = 4
    real(wp), parameter :: step = 0.16_wp
    real(wp) :: bend, half, part, from, to, z
    integer :: i, k

    integral = 0
    do k = 1, parts
      from = low + (high - low)*real(k - 1, wp)/parts
      to = low + (high - low)*real(k, wp)/parts
      half = 0.5_wp*(to - from)
      do i = -n, n
        bend = 0.5_wp*pi*sinh(step*real(i, wp))
        part = 2*half/(1 + exp(2*abs(bend)))
        z = merge(from + part, to - part, i < 0)
        integral = integral + half*step*0.5_wp*pi*cosh(step*real(i, wp))/cosh(bend)**2*shared_area(cut(c, z), cut(a, z - height))
      end do
    end do
  end function integral

  !> A shape cut at a height above its axis.
  pure function cut(whole, height) result(slice)
    type(slice_t), intent(in) :: whole
    real(wp), intent(in) :: height
    type(slice_t) :: slice

    slice = whole
    slice%radius = sqrt(max(0.0_wp, (whole%radius - height)*(whole%radius + height)))
  end function cut

  !> Area that two rounded segments share [m2], after Green.
  pure real(wp) function shared_area(a, b) result(area)
    type(slice_t), intent(in) :: a, b

    area = max(0.0_wp, boundary_inside(a, b) + boundary_inside(b, a))
  end function shared_area

  !> Half the integral of x dy - y dx along the boundary of one inside the other [m2].
  pure real(wp) function boundary_inside(own, other) result(area)
    type(slice_t), intent(in) :: own, other
    real(wp) :: up(2), along(2)
    integer :: side

    area = 0
    up = own%radius*[-own%axis(2), own%axis(1)]
    do side = -1, 1, 2
      along = real(side, wp)*own%half*own%axis
      area = area + edge_inside(own%centre + along + real(side, wp)*up, own%centre - along + real(side, wp)*up, other)
      area = area + cap_inside(own%centre + along, own%radius, real(side, wp)*own%axis, other)
    end do
  end function boundary_inside

  !> The same along a straight edge.
  pure real(wp) function edge_inside(from, to, other) result(area)
    real(wp), intent(in) :: from(2), to(2)
    type(slice_t), intent(in) :: other
    real(wp) :: direction(2), length, place(most_places), end(2), across(2), height, slope, half
    integer :: n, side, k

    area = 0
    length = norm2(to - from)
    if (length <= tiny(length)) return
    direction = (to - from)/length
    n = 0
    across = [-other%axis(2), other%axis(1)]
    slope = dot_product(across, direction)
    do side = -1, 1, 2
      end = other%centre + real(side, wp)*other%half*other%axis - from
      height = direction(1)*end(2) - direction(2)*end(1)
      if (abs(height) < other%radius) then
        half = sqrt((other%radius - height)*(other%radius + height))
        call add_place(dot_product(direction, end) - half, length, place, n)
        call add_place(dot_product(direction, end) + half, length, place, n)
      end if
      if (abs(slope) > tiny(slope)**0.5_wp) then
        call add_place((real(side, wp)*other%radius - dot_product(across, from - other%centre))/slope, length, place, n)
      end if
    end do
    call order(length, place, n)
    do k = 1, n - 1
      if (is_inside(from + 0.5_wp*(place(k) + place(k + 1))*direction, other)) then
        area = area + 0.5_wp*(place(k + 1) - place(k))*(from(1)*direction(2) - from(2)*direction(1))
      end if
    end do
  end function edge_inside

  !> The same along a half circle, from -90 to 90 degrees about a direction.
  pure real(wp) function cap_inside(centre, radius, direction, other) result(area)
    real(wp), intent(in) :: centre(2), radius, direction(2)
    type(slice_t), intent(in) :: other
    real(wp) :: place(most_places), end(2), across(2), distance, start, middle, cosine, from, to
    integer :: n, side, k

    area = 0
    if (radius <= tiny(radius)) return
    start = atan2(direction(2), direction(1)) - pi/2
    n = 0
    across = [-other%axis(2), other%axis(1)]
    do side = -1, 1, 2
      end = other%centre + real(side, wp)*other%half*other%axis - centre
      distance = norm2(end)
      if (distance > abs(radius - other%radius) .and. distance < radius + other%radius) then
        cosine = (distance**2 + (radius - other%radius)*(radius + other%radius))/(2*distance*radius)
        call add_angles(atan2(end(2), end(1)) - start, cosine, place, n)
      end if
      cosine = (real(side, wp)*other%radius - dot_product(across, centre - other%centre))/radius
      call add_angles(atan2(across(2), across(1)) - start, cosine, place, n)
    end do
    call order(pi, place, n)
    do k = 1, n - 1
      middle = start + 0.5_wp*(place(k) + place(k + 1))
      if (.not. is_inside(centre + radius*[cos(middle), sin(middle)], other)) cycle
      from = start + place(k)
      to = start + place(k + 1)
      area = area + 0.5_wp*radius*(radius*(to - from) + centre(1)*(sin(to) - sin(from)) - centre(2)*(cos(to) - cos(from)))
    end do
  end function cap_inside

  !> Add two angles about a middle, where they exist and lie on the half circle.
  pure subroutine add_angles(middle, cosine, place, n)
    real(wp), intent(in) :: middle, cosine
    real(wp), intent(inout) :: place(:)
    integer, intent(inout) :: n

    if (abs(cosine) >= 1) return
    call add_place(modulo(middle - acos(cosine), 2*pi), pi, place, n)
    call add_place(modulo(middle + acos(cosine), 2*pi), pi, place, n)
  end subroutine add_angles

  !> Add a place between zero and an end.
  pure subroutine add_place(new, end, place, n)
    real(wp), intent(in) :: new, end
    real(wp), intent(inout) :: place(:)
    integer, intent(inout) :: n

    if (new <= 0 .or. new >= end) return
    n = n + 1
    place(n) = new
  end subroutine add_place

  !> Put places in order between zero and an end, both of them added.
  pure subroutine order(end, place, n)
    real(wp), intent(in) :: end
    real(wp), intent(inout) :: place(:)
    integer, intent(inout) :: n
    real(wp) :: moved
    integer :: i, k

    place(n + 1) = 0
    place(n + 2) = end
    n = n + 2
    do i = 2, n
      moved = place(i)
      do k = i - 1, 1, -1
        if (place(k) <= moved) exit
        place(k + 1) = place(k)
      end do
      place(k + 1) = moved
    end do
  end subroutine order

  !> Is a point inside a rounded segment?
  pure logical function is_inside(point, slice)
    real(wp), intent(in) :: point(2)
    type(slice_t), intent(in) :: slice

    is_inside = distance_to(point, slice) <= slice%radius
  end function is_inside

  !> Distance of a point from the axis of a rounded segment [m].
  pure real(wp) function distance_to(point, slice) result(distance)
    real(wp), intent(in) :: point(2)
    type(slice_t), intent(in) :: slice
    real(wp) :: from(2), along

    from = point - slice%centre
    along = max(-slice%half, min(slice%half, dot_product(slice%axis, from)))
    distance = norm2(from - along*slice%axis)
  end function distance_to
end module sg_overlap_capsules
