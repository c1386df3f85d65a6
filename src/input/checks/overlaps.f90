!> How deep two shapes overlap: every shape but the hollow disk is a convex polygon, perhaps of one or two points, made
!! rounder by a radius; along any axis, the gap of two of them is that of their points less both radii.
module sg_overlaps
  use sg_contactors, only: contactors_t, kind_hollow, kind_polygon, kind_wall
  use sg_kinds, only: wp
  implicit none
  private
  public :: overlap_depth

contains

  !> Depth of the overlap of two placed contactors [m]; negative where they are apart.
  pure real(wp) function overlap_depth(contactors, c1, c2, shift) result(depth)
    type(contactors_t), intent(in) :: contactors !! contactors, placed
    integer, intent(in) :: c1 !! one contactor
    integer, intent(in) :: c2 !! the other
    real(wp), intent(in) :: shift !! moves the other in x [m], for periodic images
    real(wp), allocatable :: p(:, :), q(:, :)
    real(wp) :: p_radius, q_radius

    call core_of(contactors, c1, p, p_radius)
    call core_of(contactors, c2, q, q_radius)
    q(1, :) = q(1, :) + shift
    if (contactors%kind(c1) == kind_hollow) then
      depth = farthest(p(:, 1), q) + q_radius - p_radius
    else if (contactors%kind(c2) == kind_hollow) then
      depth = farthest(q(:, 1), p) + p_radius - q_radius
    else
      depth = p_radius + q_radius - max(separation(p, q), separation(q, p), between_points(p, q))
    end if
  end function overlap_depth

  !> Points and radius of a contactor.
  pure subroutine core_of(contactors, c, points, radius)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), allocatable, intent(out) :: points(:, :)
    real(wp), intent(out) :: radius
    real(wp) :: along(2)
    integer :: row

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_wall)
      along = contactors%wall_size(1, row)*contactors%wall_axis(:, row)
      points = reshape([contactors%centre(:, c) - along, contactors%centre(:, c) + along], [2, 2])
      radius = contactors%wall_size(2, row)
    case (kind_polygon)
      points = contactors%polygon_world(:, contactors%polygon_first(row):contactors%polygon_first(row + 1) - 1)
      radius = 0
    case default
      points = reshape(contactors%centre(:, c), [2, 1])
      radius = contactors%reach(c)
    end select
  end subroutine core_of

  !> Distance of the farthest of some points.
  pure real(wp) function farthest(centre, points)
    real(wp), intent(in) :: centre(2), points(:, :)

    farthest = sqrt(maxval((points(1, :) - centre(1))**2 + (points(2, :) - centre(2))**2))
  end function farthest

  !> Largest gap of two sets of points along the outer normals of the edges of the first.
  pure real(wp) function separation(p, q)
    real(wp), intent(in) :: p(:, :), q(:, :)
    real(wp) :: edge(2), normal(2), offset
    integer :: i, n

    separation = -huge(1.0_wp)
    n = size(p, 2)
    if (n < 2) return
    ! Two points are an edge with two sides.
    do i = 1, n
      edge = p(:, modulo(i, n) + 1) - p(:, i)
      normal = [edge(2), -edge(1)]/norm2(edge)
      offset = dot_product(normal, p(:, i))
      separation = max(separation, minval(normal(1)*q(1, :) + normal(2)*q(2, :)) - offset)
    end do
  end function separation

  !> Largest gap of two sets of points along the line between their nearest two.
  pure real(wp) function between_points(p, q) result(gap)
    real(wp), intent(in) :: p(:, :), q(:, :)
    real(wp) :: axis(2), nearest(2), squared
    integer :: i, j

    squared = huge(1.0_wp)
    nearest = 0
    do i = 1, size(p, 2)
      do j = 1, size(q, 2)
        axis = q(:, j) - p(:, i)
        if (sum(axis**2) >= squared) cycle
        squared = sum(axis**2)
        nearest = axis
      end do
    end do
    ! Where corners coincide edges alone tell whether more than corners do.
    gap = merge(-huge(1.0_wp), 0.0_wp, size(p, 2) > 1 .and. size(q, 2) > 1)
    if (.not. squared > 0) return
    nearest = nearest/sqrt(squared)
    gap = minval(nearest(1)*q(1, :) + nearest(2)*q(2, :)) - maxval(nearest(1)*p(1, :) + nearest(2)*p(2, :))
  end function between_points
end module sg_overlaps
