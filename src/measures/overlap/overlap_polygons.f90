!> Areas that convex polygons share with each other and with disks.
module sg_overlap_polygons
  use sg_kinds, only: wp
  use sg_overlap_outline, only: add_edge, close_outline, outline_t
  implicit none
  private
  public :: overlap_polygon_polygon, overlap_disk_polygon, clip

  !> Vertices of a pair of polygons for which there is room of constant size
  integer, parameter :: few = 32

contains

  !> Area shared by two convex polygons [m2]: the candidate cut along every edge of the antagonist, first along the one that faces
  !! it most, which leaves a sliver of few vertices where they overlap little.
  pure real(wp) function overlap_polygon_polygon(n_c, vertices_c, n_a, vertices_a, offset_a) result(area)
    integer, intent(in) :: n_c !! vertices of the candidate
    real(wp), intent(in) :: vertices_c(2, n_c) !! candidate's vertices, counter-clockwise [m]
    integer, intent(in) :: n_a !! vertices of the antagonist
    real(wp), intent(in) :: vertices_a(2, n_a) !! antagonist's vertices, counter-clockwise [m]
    real(wp), intent(in) :: offset_a(2) !! added to the antagonist's vertices (its periodic image) [m]
    real(wp) :: left(2, few), kept(2, 2*few), height(few)
    real(wp), allocatable :: more_left(:, :), more_kept(:, :), more_height(:)

    ! Room of constant size need not be asked of the system for each pair.
    if (n_c + n_a <= few) then
      call cut_along_all(n_c, vertices_c, n_a, vertices_a, offset_a, left, kept, height, area)
    else
      allocate (more_left(2, n_c + n_a), more_kept(2, 2*(n_c + n_a)), more_height(n_c + n_a))
      call cut_along_all(n_c, vertices_c, n_a, vertices_a, offset_a, more_left, more_kept, more_height, area)
    end if
  end function overlap_polygon_polygon

  !> The same with room for the work.
  pure subroutine cut_along_all(n_c, vertices_c, n_a, vertices_a, offset_a, left, kept, height, area)
    integer, intent(in) :: n_c, n_a
    real(wp), intent(in) :: vertices_c(2, n_c), vertices_a(2, n_a), offset_a(2)
    real(wp), intent(inout) :: left(2, n_c + n_a), kept(2, 2*(n_c + n_a)), height(n_c + n_a)
    real(wp), intent(out) :: area
    real(wp) :: edge(2)
    integer :: n, turn, i, next

    !GCC$ novector
    do i = 1, n_c
      left(1, i) = vertices_c(1, i)
      left(2, i) = vertices_c(2, i)
    end do
    n = n_c
    i = facing_edge(n_a, vertices_a, sum(vertices_c, 2)/real(n_c, wp) - offset_a)
    do turn = 1, n_a
      next = merge(1, i + 1, i == n_a)
      edge = vertices_a(:, next) - vertices_a(:, i)
      call clip_at(n, left, [vertices_a(1, i) + offset_a(1), vertices_a(2, i) + offset_a(2)], [edge(2), -edge(1)], kept, height)
      if (n == 0) exit
      i = next
    end do
    area = 0
    do i = 2, n - 1
      area = area + 0.5_wp*((left(1, i) - left(1, 1))*(left(2, i + 1) - left(2, 1)) &
                            - (left(2, i) - left(2, 1))*(left(1, i + 1) - left(1, 1)))
    end do
    area = max(0.0_wp, area)
  end subroutine cut_along_all

  !> The edge of a convex polygon over which a place lies highest.
  pure integer function facing_edge(n, vertices, place) result(facing)
    integer, intent(in) :: n
    real(wp), intent(in) :: vertices(2, n), place(2)
    real(wp) :: x, y, height, square, highest
    integer :: i, next

    facing = 1
    highest = -huge(1.0_wp)
    do i = 1, n
      next = merge(1, i + 1, i == n)
      x = vertices(1, next) - vertices(1, i)
      y = vertices(2, next) - vertices(2, i)
      height = y*(place(1) - vertices(1, i)) - x*(place(2) - vertices(2, i))
      square = height*abs(height)/max(x*x + y*y, tiny(1.0_wp))
      if (.not. square > highest) cycle
      highest = square
      facing = i
    end do
  end function facing_edge

  !> Area shared by a disk and a convex polygon [m2].
  pure real(wp) function overlap_disk_polygon(centre_c, radius_c, n_a, vertices_a, offset_a) result(area)
    real(wp), intent(in) :: centre_c(2) !! centre of the disk, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the disk [m]
    integer, intent(in) :: n_a !! vertices of the polygon
    real(wp), intent(in) :: vertices_a(2, n_a) !! vertices of the polygon, the antagonist, counter-clockwise [m]
    real(wp), intent(in) :: offset_a(2) !! added to the polygon's vertices (its periodic image) [m]
    type(outline_t) :: outline
    real(wp) :: from(2), to(2), edge(2)
    logical :: is_centre_inside
    integer :: i

    is_centre_inside = n_a > 2
    do i = 1, n_a
      from = vertices_a(:, i) + (offset_a - centre_c)
      to = vertices_a(:, merge(1, i + 1, i == n_a)) + (offset_a - centre_c)
      edge = to - from
      if (edge(1)*from(2) - edge(2)*from(1) > 0) is_centre_inside = .false.
      call add_edge(outline, radius_c, from, to)
    end do
    call close_outline(outline, radius_c, is_centre_inside, area)
  end function overlap_disk_polygon

  !> Keep what lies behind a line (Sutherland and Hodgman); a convex polygon gains at most one vertex.
  pure subroutine clip(n, vertices, point, normal)
    integer, intent(inout) :: n !! vertices before and after
    real(wp), intent(inout) :: vertices(:, :) !! room for one vertex more, counter-clockwise [m], shape (2, :)
    real(wp), intent(in) :: point(2) !! a point of the line [m]
    real(wp), intent(in) :: normal(2) !! of the side that is cut off, any length
    real(wp) :: kept(2, 2*n), height(n)

    call clip_at(n, vertices, point, normal, kept, height)
  end subroutine clip

  !> The same with room for the work, which need not be asked of the system for each line.
  pure subroutine clip_at(n, vertices, point, normal, kept, height)
    integer, intent(inout) :: n !! vertices before and after
    real(wp), intent(inout) :: vertices(:, :) !! vertices, as in `clip`
    real(wp), intent(in) :: point(2) !! a point of the line [m]
    real(wp), intent(in) :: normal(2) !! of the side that is cut off, any length
    real(wp), intent(inout), contiguous :: kept(:, :) !! room for the vertices kept, shape (2, 2 n) at least
    real(wp), intent(inout), contiguous :: height(:) !! room for their heights, shape (n) at least
    real(wp) :: highest, share
    integer :: i, next, n_kept, crosses

    highest = 0
    !GCC$ novector
    do i = 1, n
      height(i) = normal(1)*(vertices(1, i) - point(1)) + normal(2)*(vertices(2, i) - point(2))
      highest = max(highest, height(i))
    end do
    ! A line that cuts off nothing leaves all as it is.
    if (.not. highest > 0) return
    n_kept = 0
    ! Without branches, which would go the wrong way half of the time: what is not kept is written over.
    !GCC$ novector
    do i = 1, n
      next = merge(1, i + 1, i == n)
      kept(1, n_kept + 1) = vertices(1, i)
      kept(2, n_kept + 1) = vertices(2, i)
      n_kept = n_kept + merge(1, 0, height(i) <= 0)
      crosses = merge(1, 0, height(i) > 0)*merge(1, 0, height(next) < 0) + merge(1, 0, height(i) < 0)*merge(1, 0, height(next) > 0)
      share = height(i)/merge(height(i) - height(next), 1.0_wp, crosses > 0)
      kept(1, n_kept + 1) = vertices(1, i) + share*(vertices(1, next) - vertices(1, i))
      kept(2, n_kept + 1) = vertices(2, i) + share*(vertices(2, next) - vertices(2, i))
      n_kept = n_kept + crosses
    end do
    ! Rounding may let slivers cross the line more than twice; no area comes of what finds no room.
    n = min(n_kept, size(vertices, 2))
    !GCC$ novector
    do i = 1, n
      vertices(1, i) = kept(1, i)
      vertices(2, i) = kept(2, i)
    end do
  end subroutine clip_at
end module sg_overlap_polygons
