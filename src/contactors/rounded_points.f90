!> Shapes of a body as points with a radius about each, whose hull is the hull of the body: its extents, and the sieve it passes.
!!
!! A disk or sphere is one point, a rounded segment or capsule two; a polygon or polyhedron has its vertices, of radius zero. The
!! extent of the body along a unit vector u is then max(p.u + r) - min(p.u - r).
module sg_rounded_points
  use sg_contactors, only: contactors_t, kind_cylinder, kind_disk, kind_polygon, kind_polyhedron, kind_segment, kind_sphere
  use sg_kinds, only: wp, pi
  use sg_rotations, only: frame_of, rotation_by
  implicit none
  private
  public :: rounded_points, farthest_point, sieve_opening

contains

  !> Points of some shapes in the frame of their body, and the radius about each.
  pure subroutine rounded_points(contactors, first, last, point, radius)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: first !! first shape
    integer, intent(in) :: last !! last shape; none is hollow or a plane
    real(wp), allocatable, intent(out) :: point(:, :) !! [m], shape (dimension, points)
    real(wp), allocatable, intent(out) :: radius(:) !! [m], shape (points)
    integer :: c

    allocate (point(contactors%dimension, 0), radius(0))
    do c = first, last
      associate (row => contactors%row(c), shift => contactors%shift(:, c))
        select case (contactors%kind(c))
        case (kind_disk)
          call add(spread(shift, 2, 1), contactors%disk_radius(row))
        case (kind_segment)
          associate (half => contactors%segment_size(1, row), angle => contactors%segment_size(3, row))
            call add(ends(shift, half*[cos(angle), sin(angle)]), contactors%segment_size(2, row))
          end associate
        case (kind_polygon)
          associate (from => contactors%polygon_first(row), to => contactors%polygon_first(row + 1) - 1)
            call add(contactors%polygon_vertex(:, from:to) + spread(shift, 2, to - from + 1), 0.0_wp)
          end associate
        case (kind_sphere)
          call add(spread(shift, 2, 1), contactors%space%sphere_radius(row))
        case (kind_cylinder)
          call add(ends(shift, contactors%space%cylinder_size(1, row)*contactors%space%cylinder_axis(:, row)), &
                   contactors%space%cylinder_size(2, row))
        case (kind_polyhedron)
          associate (vertex => contactors%space%polyhedra(row)%vertex)
            call add(vertex + spread(shift, 2, size(vertex, 2)), 0.0_wp)
          end associate
        end select
      end associate
    end do
  contains
    !> Add points of one radius.
    pure subroutine add(more, their_radius)
      real(wp), intent(in) :: more(:, :), their_radius
      real(wp), allocatable :: grown(:, :), grown_radius(:)
      integer :: n

      n = size(radius)
      allocate (grown(size(point, 1), n + size(more, 2)), grown_radius(n + size(more, 2)))
      grown(:, :n) = point
      grown(:, n + 1:) = more
      grown_radius(:n) = radius
      grown_radius(n + 1:) = their_radius
      call move_alloc(grown, point)
      call move_alloc(grown_radius, radius)
    end subroutine add

    !> Both ends of an axis.
    pure function ends(centre, half)
      real(wp), intent(in) :: centre(:), half(:)
      real(wp) :: ends(size(centre), 2)

      ends(:, 1) = centre - half
      ends(:, 2) = centre + half
    end function ends
  end subroutine rounded_points

  !> Radius of the circle or sphere about the origin that holds rounded points [m].
  pure real(wp) function farthest_point(point, radius) result(reach)
    real(wp), intent(in) :: point(:, :) !! [m], shape (dimension, points)
    real(wp), intent(in) :: radius(:) !! [m], shape (points)

    reach = maxval(norm2(point, 1) + radius)
  end function farthest_point

  !> Side of the smallest opening of a sieve that a body passes straight [m]: in space a square one, in the plane a slit.
  !!
  !! In the plane that is the least width of the body. In space it is the least, over all orthonormal pairs u and v, of the larger
  !! of its widths along u and along v: the body moves across both. The search starts from the best of an even grid of
  !! orientations and turns these by smaller and smaller angles, so that the result is an upper bound close to the least one.
  pure real(wp) function sieve_opening(point, radius) result(opening)
    real(wp), intent(in) :: point(:, :) !! [m], shape (dimension, points)
    real(wp), intent(in) :: radius(:) !! [m], shape (points)

    if (size(point, 1) == 2) then
      opening = least_width(point, radius)
    else
      opening = least_square(point, radius)
    end if
  end function sieve_opening

  !> Width of rounded points along a unit vector [m].
  pure real(wp) function width_along(point, radius, along) result(width)
    real(wp), intent(in) :: point(:, :), radius(:), along(:)
    real(wp) :: height(size(radius))

    height = matmul(along, point)
    width = maxval(height + radius) - minval(height - radius)
  end function width_along

  !> Least width in the plane: from the best of a grid of angles, by smaller and smaller turns.
  pure real(wp) function least_width(point, radius) result(least)
    real(wp), intent(in) :: point(:, :), radius(:)
    integer, parameter :: n = 720
    real(wp) :: width(n), angle, turn, other
    integer :: i

    do i = 1, n
      width(i) = at(pi*real(i, wp)/real(n, wp))
    end do
    least = minval(width)
    angle = pi*real(minloc(width, 1), wp)/real(n, wp)
    turn = pi/real(n, wp)
    do while (turn > 1e-12_wp)
      turn = turn/2
      do i = -1, 1, 2
        other = at(angle + real(i, wp)*turn)
        if (other >= least) cycle
        least = other
        angle = angle + real(i, wp)*turn
        exit
      end do
    end do
  contains
    !> Width along the direction of an angle.
    pure real(wp) function at(direction)
      real(wp), intent(in) :: direction

      at = width_along(point, radius, [cos(direction), sin(direction)])
    end function at
  end function least_width

  !> Side of the smallest square that rounded points of space pass straight.
  pure real(wp) function least_square(point, radius) result(least)
    real(wp), intent(in) :: point(:, :), radius(:)
    integer, parameter :: n_axes = 300, n_turns = 12, n_starts = 8
    real(wp), parameter :: golden = pi*(3 - sqrt(5.0_wp))
    real(wp), allocatable :: frame(:, :, :), side(:)
    real(wp) :: height, angle
    integer :: i, k, best

    allocate (frame(3, 3, n_axes*n_turns), side(n_axes*n_turns))
    do i = 1, n_axes
      height = (real(i, wp) - 0.5_wp)/real(n_axes, wp)
      angle = golden*real(i, wp)
      do k = 1, n_turns
        frame(:, :, (i - 1)*n_turns + k) = frame_about([sqrt(1 - height**2)*[cos(angle), sin(angle)], height], &
                                                       pi/2*real(k, wp)/real(n_turns, wp))
      end do
    end do
    do i = 1, size(side)
      side(i) = square_of(point, radius, frame(:, :, i))
    end do
    least = minval(side)
    do i = 1, n_starts
      best = minloc(side, 1)
      call refine(point, radius, frame(:, :, best), side(best))
      least = min(least, side(best))
      side(best) = huge(1.0_wp)
    end do
  end function least_square

  !> A frame whose third axis is given, turned about that by an angle.
  pure function frame_about(axis, angle) result(frame)
    real(wp), intent(in) :: axis(3), angle
    real(wp) :: frame(3, 3), first(3), second(3)
    integer :: k

    k = minloc(abs(axis), 1)
    first = -axis(k)*axis
    first(k) = first(k) + 1
    first = first/norm2(first)
    second = [axis(2)*first(3) - axis(3)*first(2), axis(3)*first(1) - axis(1)*first(3), axis(1)*first(2) - axis(2)*first(1)]
    frame(:, 1) = cos(angle)*first + sin(angle)*second
    frame(:, 2) = cos(angle)*second - sin(angle)*first
    frame(:, 3) = axis
  end function frame_about

  !> The larger of the widths along the first two axes of a frame.
  pure real(wp) function square_of(point, radius, frame) result(side)
    real(wp), intent(in) :: point(:, :), radius(:), frame(3, 3)

    side = max(width_along(point, radius, frame(:, 1)), width_along(point, radius, frame(:, 2)))
  end function square_of

  !> Turn a frame by smaller and smaller angles, each time to where the side of the square is less.
  pure subroutine refine(point, radius, frame, side)
    real(wp), intent(in) :: point(:, :), radius(:)
    real(wp), intent(inout) :: frame(3, 3), side
    real(wp) :: angle, other(3, 3), other_side
    integer :: x, y, z
    logical :: has_moved

    angle = 0.1_wp
    do while (angle > 1e-7_wp)
      has_moved = .false.
      do z = -1, 1
        do y = -1, 1
          do x = -1, 1
            if (all([x, y, z] == 0)) cycle
            other = matmul(frame_of(rotation_by(angle*real([x, y, z], wp))), frame)
            other_side = square_of(point, radius, other)
            if (.not. other_side < side*(1 - 1e-12_wp)) cycle
            has_moved = .true.
            frame = other
            side = other_side
          end do
        end do
      end do
      if (.not. has_moved) angle = angle/2
    end do
  end subroutine refine
end module sg_rounded_points
