!> Checks of the state at the start in space: shapes that do not overlap.
!!
!! Pairs are found by cells as wide as the larger grains; shapes far larger than those are held against all others.
module sg_solid_checks
  use sg_ascending, only: first_at_least
  use sg_contactors, only: kind_point, place_contactors
  use sg_kinds, only: wp, i4, i8
  use sg_scene, only: scene_t
  use sg_sorting, only: sort_permutation
  use sg_start_checks, only: check_hollows, check_pair, find_planar_overlaps, overlaps_t
  implicit none
  private
  public :: find_overlaps

  !> Shapes more than this many times larger than the middle one stand in no cell
  real(wp), parameter :: large = 8

  !> Cells of contactors
  type :: cells_t
    real(wp) :: low(3) = 0, side(3) = 1
    integer :: n(3) = 1
    logical :: is_periodic(3) = .false.
    !> Contactors by cell, and their cells
    integer(i4), allocatable :: order(:)
    integer(i8), allocatable :: key(:)
  end type cells_t

contains

  !> Look for shapes that overlap, in the plane or in space.
  subroutine find_overlaps(scene, found)
    type(scene_t), intent(inout) :: scene !! whole scene, or the part of a rank with copies; its contactors are placed
    type(overlaps_t), intent(inout) :: found !! pairs found

    if (scene%dimension == 2) then
      call find_planar_overlaps(scene, found)
    else
      call find_solid_overlaps(scene, found)
    end if
    if (size(scene%sees) > 0) call check_hollows(scene, found)
  end subroutine find_overlaps

  !> Look for shapes of space that overlap.
  subroutine find_solid_overlaps(scene, found)
    type(scene_t), intent(inout) :: scene
    type(overlaps_t), intent(inout) :: found
    type(cells_t) :: cells
    logical, allocatable :: is_large(:)
    integer :: i, j, n

    n = scene%contactors%n
    if (n < 2 .or. size(scene%sees) == 0) return
    scene%bodies%middle(1:3, :) = scene%bodies%position
    scene%bodies%middle(4:7, :) = scene%bodies%orientation
    call place_contactors(scene%contactors, scene%bodies%middle)
    allocate (is_large(n))
    call find_large(scene, is_large)
    do i = 1, n
      if (.not. is_large(i)) cycle
      do j = 1, n
        if (j == i .or. (is_large(j) .and. j < i)) cycle
        call check_pair(scene, i, j, found)
      end do
    end do
    call build_cells(scene, is_large, cells)
    do i = 1, size(cells%order)
      call check_around(scene, cells, int(cells%order(i)), found)
    end do
  end subroutine find_solid_overlaps

  !> Which contactors are far larger than most?
  subroutine find_large(scene, is_large)
    type(scene_t), intent(in) :: scene
    logical, intent(out) :: is_large(:)
    integer(i4), allocatable :: order(:)
    real(wp), allocatable :: extended(:)
    real(wp) :: middle

    associate (reach => scene%contactors%reach(:scene%contactors%n), kind => scene%contactors%kind(:scene%contactors%n))
      is_large = .false.
      if (all(kind == kind_point)) return
      extended = pack(reach, kind /= kind_point)
      order = sort_permutation(int(extended/maxval(extended)*2.0_wp**40, i8))
      middle = extended(order((size(order) + 1)/2))
      is_large = reach > large*middle .or. .not. scene%bodies%is_grain(scene%contactors%body(:scene%contactors%n))
      where (kind == kind_point) is_large = .false.
      ! Many walls, such as rough floors made of spheres, go into cells too.
      if (count(is_large) > 200) is_large = reach > large*middle
    end associate
  end subroutine find_large

  !> Sort the small contactors into cells as wide as the largest of them.
  subroutine build_cells(scene, is_large, cells)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: is_large(:)
    type(cells_t), intent(out) :: cells
    integer(i4), allocatable :: small(:), order(:)
    integer(i8), allocatable :: key(:)
    real(wp) :: high(3), wide
    integer :: i

    small = pack([(int(i, i4), i=1, size(is_large))], .not. (is_large .or. scene%contactors%kind(:size(is_large)) == kind_point))
    allocate (key(size(small)))
    if (size(small) > 0) then
      associate (contactors => scene%contactors)
        wide = 2*maxval(contactors%reach(small))
        cells%low = minval(contactors%centre(:, small), 2)
        high = maxval(contactors%centre(:, small), 2)
        cells%is_periodic = [scene%period, scene%period_y, 0.0_wp] > 0
        where (cells%is_periodic) cells%low = 0
        where (cells%is_periodic) high = [scene%period, scene%period_y, 0.0_wp]
        cells%n = max(1, int(min(1e6_wp, (high - cells%low)/wide)))
        cells%side = max((high - cells%low)/real(cells%n, wp), wide)
        where (cells%is_periodic) cells%side = (high - cells%low)/real(cells%n, wp)
        do i = 1, size(small)
          key(i) = key_of(cells, cell_of(cells, contactors%centre(:, small(i))))
        end do
      end associate
    end if
    order = sort_permutation(key)
    cells%order = small(order)
    cells%key = key(order)
  end subroutine build_cells

  !> Cell of a point; beyond the last cells the last.
  pure function cell_of(cells, point) result(cell)
    type(cells_t), intent(in) :: cells
    real(wp), intent(in) :: point(3)
    integer :: cell(3)
    real(wp), parameter :: far = 1e9_wp

    cell = floor(max(-far, min(far, (point - cells%low)/cells%side)))
    where (cells%is_periodic)
      cell = modulo(cell, cells%n)
    elsewhere
      cell = max(0, min(cells%n - 1, cell))
    end where
  end function cell_of

  !> Number of a cell.
  pure integer(i8) function key_of(cells, cell) result(key)
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: cell(3)

    key = int(cell(1), i8) + int(cells%n(1), i8)*(int(cell(2), i8) + int(cells%n(2), i8)*int(cell(3), i8))
  end function key_of

  !> Hold a contactor against those of its cell and the ones around, each pair once.
  subroutine check_around(scene, cells, c, found)
    type(scene_t), intent(in) :: scene
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: c
    type(overlaps_t), intent(inout) :: found
    integer(i8) :: key, seen(27)
    integer :: cell(3), at(3), i, j, k, m, n_seen

    cell = cell_of(cells, scene%contactors%centre(:, c))
    n_seen = 0
    do k = -1, 1
      do j = -1, 1
        do i = -1, 1
          at = cell + [i, j, k]
          where (cells%is_periodic) at = modulo(at, cells%n)
          if (any(at < 0 .or. at >= cells%n)) cycle
          key = key_of(cells, at)
          ! Along a short period two neighbours may be one cell.
          if (any(seen(:n_seen) == key)) cycle
          n_seen = n_seen + 1
          seen(n_seen) = key
          do m = first_at_least(cells%key, key), size(cells%key)
            if (cells%key(m) /= key) exit
            if (cells%order(m) > c) call check_pair(scene, c, int(cells%order(m)), found)
          end do
        end do
      end do
    end do
  end subroutine check_around
end module sg_solid_checks
