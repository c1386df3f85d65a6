!> What the shapes of a body share: volume and moments that their sum counts too often.
!!
!! The body is cut by lines along x, evenly spread over the box in which boxes about two shapes overlap. On each line every shape
!! is an interval [a, b], since all are convex. Sums over the intervals less sums over their union, of 1, x and x**2, are exact on
!! the line; bodies whose shapes share nothing get exact zeros.
module sg_shared_moments
  use sg_contactors, only: contactors_t, kind_cylinder, kind_disk, kind_polygon, kind_polyhedron, kind_sphere
  use sg_kinds, only: wp
  implicit none
  private
  public :: shared_moments

  !> Lines in the plane, and along each of two directions in space
  integer, parameter :: lines_in_plane = 4000, lines_in_space = 250

contains

  !> Excess of the sum of some shapes over their union: volume, and first and second moments about the origin of their body.
  pure subroutine shared_moments(contactors, first, last, volume, moment, second)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: first !! first shape
    integer, intent(in) :: last !! last shape; none is hollow, a plane, a segment or a point
    real(wp), intent(out) :: volume !! area [m2] or volume [m3]
    real(wp), intent(out) :: moment(3) !! integral of x [m3 or m4]; the third component is zero in the plane
    real(wp), intent(out) :: second(3, 3) !! integral of x x^T [m4 or m5]
    real(wp) :: low(3), high(3), step(3), place(3), along(0:2)
    integer :: i, k, n(3)

    volume = 0
    moment = 0
    second = 0
    call find_box(contactors, first, last, low, high)
    if (any(high < low)) return
    n = merge(lines_in_plane, lines_in_space, contactors%dimension == 2)
    if (contactors%dimension == 2) n(3) = 1
    step = (high - low)/real(n, wp)
    if (contactors%dimension == 2) step(3) = 1
    place = 0
    do k = 1, n(3)
      if (contactors%dimension == 3) place(3) = low(3) + (real(k, wp) - 0.5_wp)*step(3)
      do i = 1, n(2)
        place(2) = low(2) + (real(i, wp) - 0.5_wp)*step(2)
        call excess_on_line(contactors, first, last, place, along)
        along = along*step(2)*step(3)
        place(1) = 0
        volume = volume + along(0)
        moment = moment + [along(1), along(0)*place(2:)]
        second(1, 1) = second(1, 1) + along(2)
        second(1, 2:) = second(1, 2:) + along(1)*place(2:)
        second(2, 2:) = second(2, 2:) + along(0)*place(2)*place(2:)
        second(3, 3) = second(3, 3) + along(0)*place(3)**2
      end do
    end do
    second(2:, 1) = second(1, 2:)
    second(3, 2) = second(2, 3)
  end subroutine shared_moments

  !> The box about all boxes that two shapes share; empty where no two boxes overlap.
  pure subroutine find_box(contactors, first, last, low, high)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: first, last
    real(wp), intent(out) :: low(3), high(3)
    real(wp) :: bottom(3, first:last), top(3, first:last), least(3), most(3)
    integer :: c, other

    do c = first, last
      call box_of(contactors, c, bottom(:, c), top(:, c))
    end do
    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    do c = first, last
      do other = c + 1, last
        least = max(bottom(:, c), bottom(:, other))
        most = min(top(:, c), top(:, other))
        if (any(least > most)) cycle
        low = min(low, least)
        high = max(high, most)
      end do
    end do
  end subroutine find_box

  !> The box about a shape, in the frame of its body.
  pure subroutine box_of(contactors, c, low, high)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(out) :: low(3), high(3)
    real(wp) :: half(3)
    integer :: d

    d = contactors%dimension
    half = 0
    associate (row => contactors%row(c))
      select case (contactors%kind(c))
      case (kind_cylinder)
        half = contactors%space%cylinder_size(1, row)*abs(contactors%space%cylinder_axis(:, row)) &
               + contactors%space%cylinder_size(2, row)
      case default
        half(:d) = contactors%reach(c)
      end select
      low = -half
      high = half
      select case (contactors%kind(c))
      case (kind_polygon)
        associate (vertex => contactors%polygon_vertex(:, contactors%polygon_first(row):contactors%polygon_first(row + 1) - 1))
          low(:2) = minval(vertex, 2)
          high(:2) = maxval(vertex, 2)
        end associate
      case (kind_polyhedron)
        low = minval(contactors%space%polyhedra(row)%vertex, 2)
        high = maxval(contactors%space%polyhedra(row)%vertex, 2)
      end select
    end associate
    low(:d) = low(:d) + contactors%shift(:, c)
    high(:d) = high(:d) + contactors%shift(:, c)
  end subroutine box_of

  !> Excess on one line: integrals of 1, x and x**2 over the intervals of all shapes, less those over their union.
  pure subroutine excess_on_line(contactors, first, last, place, along)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: first, last
    real(wp), intent(in) :: place(3)
    real(wp), intent(out) :: along(0:2)
    real(wp) :: interval(2, last - first + 1), covered, one(2)
    integer :: c, i, k, n

    n = 0
    do c = first, last
      one = interval_of(contactors, c, place)
      if (one(2) <= one(1)) cycle
      ! By their beginnings.
      i = n
      do while (i >= 1)
        if (interval(1, i) <= one(1)) exit
        interval(:, i + 1) = interval(:, i)
        i = i - 1
      end do
      interval(:, i + 1) = one
      n = n + 1
    end do
    along = 0
    covered = -huge(1.0_wp)
    do i = 1, n
      ! What the intervals before cover of this one counts too often.
      associate (from => interval(1, i), to => min(interval(2, i), covered))
        if (to > from) along = along + [((to**(k + 1) - from**(k + 1))/real(k + 1, wp), k=0, 2)]
      end associate
      covered = max(covered, interval(2, i))
    end do
  end subroutine excess_on_line

  !> Interval of a shape on a line along x; its end is not above its beginning where they do not meet.
  pure function interval_of(contactors, c, place) result(interval)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: place(3)
    real(wp) :: interval(2), from(3), end(3), edge(2)
    integer :: f, v, next

    ! The line as seen from the centre of the shape.
    from = 0
    from(2:contactors%dimension) = place(2:contactors%dimension) - contactors%shift(2:, c)
    interval = [-huge(1.0_wp), huge(1.0_wp)]
    associate (row => contactors%row(c))
      select case (contactors%kind(c))
      case (kind_disk, kind_sphere)
        interval = of_ball(contactors%reach(c), from)
      case (kind_polygon)
        associate (low => contactors%polygon_first(row), high => contactors%polygon_first(row + 1) - 1)
          do v = low, high
            next = merge(low, v + 1, v == high)
            edge = contactors%polygon_vertex(:, next) - contactors%polygon_vertex(:, v)
            call clip(interval, [edge(2), -edge(1), 0.0_wp], [contactors%polygon_vertex(:, v), 0.0_wp], from)
          end do
        end associate
      case (kind_cylinder)
        end = contactors%space%cylinder_size(1, row)*contactors%space%cylinder_axis(:, row)
        interval = of_capsule(contactors%space%cylinder_size(2, row), end, from)
      case (kind_polyhedron)
        associate (solid => contactors%space%polyhedra(row))
          do f = 1, solid%n_faces
            call clip(interval, solid%normal(:, f), solid%vertex(:, solid%face_vertex(solid%face_first(f))), from)
          end do
        end associate
      end select
    end associate
    interval = interval + contactors%shift(1, c)
  end function interval_of

  !> Interval of a ball about the origin.
  pure function of_ball(radius, from) result(interval)
    real(wp), intent(in) :: radius, from(3)
    real(wp) :: interval(2), square

    square = radius**2 - from(2)**2 - from(3)**2
    interval = 0
    if (square > 0) interval = sqrt(square)*[-1.0_wp, 1.0_wp]
  end function of_ball

  !> Interval of a capsule whose axis goes from -end to end: the hull of those of its two balls and of the cylinder between.
  pure function of_capsule(radius, end, from) result(interval)
    real(wp), intent(in) :: radius, end(3), from(3)
    real(wp) :: interval(2), part(2), axis(3), across, along, square, foot

    interval = [huge(1.0_wp), -huge(1.0_wp)]
    part = of_ball(radius, from - end) + end(1)
    if (part(2) > part(1)) interval = [min(interval(1), part(1)), max(interval(2), part(2))]
    part = of_ball(radius, from + end) - end(1)
    if (part(2) > part(1)) interval = [min(interval(1), part(1)), max(interval(2), part(2))]
    axis = end/norm2(end)
    ! Distance of the point (x, y, z) from the axis: across*x**2 - 2*along*foot*x + ... = radius**2.
    across = 1 - axis(1)**2
    along = axis(2)*from(2) + axis(3)*from(3)
    if (across > epsilon(across)) then
      foot = axis(1)*along/across
      square = (radius**2 - from(2)**2 - from(3)**2 + along**2)/across + foot**2
      part = 0
      if (square > 0) part = foot + sqrt(square)*[-1.0_wp, 1.0_wp]
    else
      part = 0
      if (from(2)**2 + from(3)**2 < radius**2) part = [-huge(1.0_wp), huge(1.0_wp)]
    end if
    if (part(2) > part(1)) then
      call clip(part, axis, end, from)
      call clip(part, -axis, -end, from)
      if (part(2) > part(1)) interval = [min(interval(1), part(1)), max(interval(2), part(2))]
    end if
    if (interval(2) < interval(1)) interval = 0
  end function of_capsule

  !> Clip an interval by the half space behind a plane.
  pure subroutine clip(interval, normal, point, from)
    real(wp), intent(inout) :: interval(2)
    real(wp), intent(in) :: normal(3), point(3), from(3)
    real(wp) :: rest

    rest = dot_product(normal, point) - normal(2)*from(2) - normal(3)*from(3)
    if (abs(normal(1)) > epsilon(rest)*norm2(normal)) then
      if (normal(1) > 0) then
        interval(2) = min(interval(2), rest/normal(1))
      else
        interval(1) = max(interval(1), rest/normal(1))
      end if
    else if (rest < 0) then
      interval = 0
    end if
  end subroutine clip
end module sg_shared_moments
