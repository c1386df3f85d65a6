!> Broad phase: which circles or spheres come near each other, in linear time for any spread of sizes.
!!
!! Circles are sorted into levels by powers of three of their radius. Each level has its own cubic cells, wide enough
!! that a circle and any circle of the same or a smaller level that come near it lie in neighbouring cells. Cells are
!! found by hashing, so that a far-flown grain costs nothing. Each circle looks in the 3 by 3 (by 3) cells about it of its
!! own level and of every coarser one: a pair of two levels is found from the finer one.
module sg_cells
  use sg_kinds, only: wp, i4, i8
  implicit none
  private
  public :: cells_t, build_cells, level_cell

  !> Circles in hashed cells, level by level
  type :: cells_t
    !> Number of levels that hold circles
    integer :: n_levels = 0
    !> Side of a level's cells in x, y and z [m], shape (3, levels)
    real(wp), allocatable :: side(:, :)
    !> Number of cells of a level in one period in x, y and z; 0 where not periodic, shape (3, levels)
    integer(i4), allocatable :: columns(:, :)
    !> Level of each circle
    integer(i4), allocatable :: level(:)
    !> Cell of each circle in its level, shape (3, circles); the third is 0 in the plane
    integer(i4), allocatable :: cell(:, :)
    !> Number of hash buckets less one (a power of two less one)
    integer(i4) :: mask = 0
    !> Circles of bucket b are `member(first(b))` to `member(first(b + 1) - 1)`, in rising order
    integer(i4), allocatable :: first(:), member(:)
  contains
    procedure :: bucket => cells_bucket
  end type cells_t

contains

  !> Sort circles into cells.
  pure subroutine build_cells(cells, centre, reach, margin, period)
    type(cells_t), intent(out) :: cells !! cells to build
    real(wp), intent(in), contiguous :: centre(:, :) !! centres [m], shape (3, circles); the third is 0 in the plane
    real(wp), intent(in), contiguous :: reach(:) !! radii [m]
    real(wp), intent(in) :: margin !! circles nearer than this are near [m]
    real(wp), intent(in) :: period(3) !! period in x, y and z [m], zero where not periodic
    integer :: i, n

    n = size(reach)
    if (n == 0) return
    call choose_levels(cells, reach, margin, period)
    allocate (cells%cell(3, n))
    do i = 1, n
      cells%cell(:, i) = level_cell(cells, cells%level(i), centre(:, i))
    end do
    call fill_buckets(cells)
  end subroutine build_cells

  !> Levels, and the side of their cells.
  pure subroutine choose_levels(cells, reach, margin, period)
    type(cells_t), intent(inout) :: cells
    real(wp), intent(in) :: reach(:), margin, period(3)
    integer :: i, n, axis
    integer, allocatable :: power(:), new_level(:)
    real(wp), allocatable :: largest(:)
    real(wp) :: smallest
    real(wp), parameter :: most_columns = 1e9_wp

    smallest = max(minval(reach), tiny(1.0_wp))
    allocate (power(size(reach)), cells%level(size(reach)))
    ! Logarithms are subtracted: a quotient of radii may exceed the largest number.
    power = int((log(max(reach, smallest)) - log(smallest))/log(3.0_wp) + 1e-9_wp)
    allocate (new_level(0:maxval(power)), source=0)
    do i = 1, size(reach)
      new_level(power(i)) = new_level(power(i)) + 1
    end do
    call number_levels(new_level, n)
    cells%n_levels = n
    allocate (largest(n), source=0.0_wp)
    do i = 1, size(reach)
      cells%level(i) = int(new_level(power(i)), i4)
      largest(cells%level(i)) = max(largest(cells%level(i)), reach(i))
    end do
    allocate (cells%side(3, n), cells%columns(3, n))
    cells%side = spread(2*largest + margin, 1, 3)
    cells%columns = 0
    do axis = 1, 3
      if (.not. period(axis) > 0) cycle
      cells%columns(axis, :) = max(1, int(min(most_columns, period(axis)/cells%side(axis, :))))
      cells%side(axis, :) = period(axis)/real(cells%columns(axis, :), wp)
    end do
  end subroutine choose_levels

  !> Number the levels of powers that hold circles. One of few circles, walls as a rule, goes on into the next: there to look at a
  !! few more takes less than to look at one more level. The finest level is that of grains, however few.
  pure subroutine number_levels(level, n)
    integer, intent(inout) :: level(0:) !! circles of each power, then its level
    integer, intent(out) :: n !! levels
    integer, parameter :: few = 16
    integer :: i, circles

    n = 0
    circles = 0
    do i = 0, ubound(level, 1)
      if (level(i) == 0) cycle
      if (n < 2 .or. circles > few) then
        n = n + 1
        circles = 0
      end if
      circles = circles + level(i)
      level(i) = n
    end do
  end subroutine number_levels

  !> Cell of a point in a level; columns are counted within the period where there is one.
  pure function level_cell(cells, level, point) result(cell)
    type(cells_t), intent(in) :: cells !! cells
    integer, intent(in) :: level !! level to look in
    real(wp), intent(in) :: point(3) !! [m]
    integer(i4) :: cell(3)
    real(wp), parameter :: far = 1e9_wp

    cell = int(floor(max(-far, min(far, point/cells%side(:, level)))), i4)
    where (cells%columns(:, level) > 0) cell = max(0_i4, min(cells%columns(:, level) - 1_i4, cell))
  end function level_cell

  !> Hash bucket of a cell of a level.
  pure integer(i4) function cells_bucket(self, level, cell) result(bucket)
    class(cells_t), intent(in) :: self
    integer, intent(in) :: level !! level of the cell
    integer(i4), intent(in) :: cell(3) !! column, row and layer
    integer(i8) :: hash

    hash = ieor(int(cell(1), i8)*73856093_i8, ieor(int(cell(2), i8)*19349663_i8, &
                                                   ieor(int(cell(3), i8)*67867979_i8, int(level, i8)*83492791_i8)))
    bucket = int(iand(ieor(hash, shiftr(hash, 15)), int(self%mask, i8)), i4)
  end function cells_bucket

  !> Counting sort of the circles by bucket.
  pure subroutine fill_buckets(cells)
    type(cells_t), intent(inout) :: cells
    integer(i4), allocatable :: bucket(:), next(:)
    integer :: i, n

    n = size(cells%level)
    cells%mask = 15
    do while (cells%mask < 2*n)
      cells%mask = 2*cells%mask + 1
    end do
    allocate (bucket(n), cells%member(n))
    allocate (cells%first(0:cells%mask + 1), source=0_i4)
    do i = 1, n
      bucket(i) = cells%bucket(cells%level(i), cells%cell(:, i))
      cells%first(bucket(i) + 1) = cells%first(bucket(i) + 1) + 1
    end do
    cells%first(0) = 1
    do i = 1, cells%mask + 1
      cells%first(i) = cells%first(i) + cells%first(i - 1)
    end do
    next = cells%first
    do i = 1, n
      cells%member(next(bucket(i) + lbound(next, 1))) = int(i, i4)
      next(bucket(i) + lbound(next, 1)) = next(bucket(i) + lbound(next, 1)) + 1
    end do
  end subroutine fill_buckets
end module sg_cells
