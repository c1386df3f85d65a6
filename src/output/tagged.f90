!> Tagged numbers: results of a run as text with names, for regression tests that compare quantity by quantity.
!!
!! A quantity is a line `name kind size`, then `size` numbers, one a line with 17 digits. The kind says which tolerance
!! applies to it: for instance `energy`, `count` or `position`.
module sg_tagged
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp
  use sg_text, only: read_lines, text_t, to_text
  implicit none
  private
  public :: tolerance_t, tagged_text, compare_tagged

  !> How much numbers of one kind may differ: by `absolute` + `relative` times the largest of the quantity
  type :: tolerance_t
    !> Kind of quantity
    character(len=:), allocatable :: kind
    !> Difference allowed, in the unit of the quantity
    real(wp) :: absolute = 0
    !> Difference allowed, as a share of the largest number of the quantity
    real(wp) :: relative = 0
  end type tolerance_t

  !> One quantity of a file
  type :: quantity_t
    character(len=:), allocatable :: name, kind
    real(wp), allocatable :: values(:)
  end type quantity_t

contains

  !> A quantity as lines of text, each with its end.
  pure function tagged_text(name, kind, values) result(text)
    character(len=*), intent(in) :: name !! of the quantity, one word
    character(len=*), intent(in) :: kind !! chooses the tolerance, one word
    real(wp), intent(in) :: values(:) !! the numbers
    character(len=:), allocatable :: text
    integer :: i

    text = name//' '//kind//' '//to_text(size(values))//new_line('a')
    do i = 1, size(values)
      text = text//to_text(values(i))//new_line('a')
    end do
  end function tagged_text

  !> Compare two files: each quantity that is missing or differs is one mistake.
  subroutine compare_tagged(wanted_file, got_file, tolerances, differences)
    character(len=*), intent(in) :: wanted_file !! file that is right
    character(len=*), intent(in) :: got_file !! file to judge
    type(tolerance_t), intent(in) :: tolerances(:) !! one a kind; kinds that are not listed must agree exactly
    type(diagnostics_t), intent(inout) :: differences !! takes what differs
    type(quantity_t), allocatable :: wanted(:), got(:)
    integer :: i, before

    before = differences%count()
    call read_tagged(wanted_file, wanted, differences)
    call read_tagged(got_file, got, differences)
    if (differences%count() > before) return
    do i = 1, size(wanted)
      if (index_of(wanted(i)%name, got) == 0) then
        call differences%add(wanted(i)%name//' is missing', file=got_file)
      else
        call compare(wanted(i), got(index_of(wanted(i)%name, got)), tolerances, got_file, differences)
      end if
    end do
    do i = 1, size(got)
      if (index_of(got(i)%name, wanted) == 0) call differences%add(got(i)%name//' is new', file=got_file)
    end do
  end subroutine compare_tagged

  !> Read all quantities of a file.
  subroutine read_tagged(file, quantities, mistakes)
    character(len=*), intent(in) :: file
    type(quantity_t), allocatable, intent(out) :: quantities(:)
    type(diagnostics_t), intent(inout) :: mistakes
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    type(quantity_t) :: quantity
    character(len=100) :: name, kind
    integer :: i, j, n, status

    allocate (quantities(0))
    call read_lines(file, lines, error)
    if (allocated(error)) then
      call mistakes%add(error%message, file=file)
      return
    end if
    i = 1
    do while (i <= size(lines))
      read (lines(i)%s, *, iostat=status) name, kind, n
      if (status == 0 .and. (n < 0 .or. n > size(lines) - i)) status = 1
      if (status == 0) then
        quantity%name = trim(name)
        quantity%kind = trim(kind)
        quantity%values = spread(0.0_wp, 1, n)
        do j = 1, n
          if (status == 0) read (lines(i + j)%s, *, iostat=status) quantity%values(j)
        end do
      end if
      if (status /= 0) then
        call mistakes%add('this is no quantity: its first line is "name kind size", and its numbers follow', file=file, line=i)
        return
      end if
      quantities = [quantities, quantity]
      i = i + n + 1
    end do
  end subroutine read_tagged

  !> Index of a quantity by name; 0 when there is none.
  pure integer function index_of(name, quantities)
    character(len=*), intent(in) :: name
    type(quantity_t), intent(in) :: quantities(:)

    do index_of = 1, size(quantities)
      if (quantities(index_of)%name == name) return
    end do
    index_of = 0
  end function index_of

  !> Compare two quantities of one name.
  subroutine compare(wanted, got, tolerances, file, differences)
    type(quantity_t), intent(in) :: wanted, got
    type(tolerance_t), intent(in) :: tolerances(:)
    character(len=*), intent(in) :: file
    type(diagnostics_t), intent(inout) :: differences
    real(wp) :: allowed
    integer :: i, worst

    if (size(wanted%values) /= size(got%values)) then
      call differences%add(wanted%name//' has '//to_text(size(got%values))//' numbers instead of '// &
                           to_text(size(wanted%values)), file=file)
      return
    end if
    if (size(wanted%values) == 0) return
    if (.not. all(ieee_is_finite(got%values))) then
      call differences%add(wanted%name//' has numbers that are not finite', file=file)
      return
    end if
    allowed = 0
    do i = 1, size(tolerances)
      if (tolerances(i)%kind == wanted%kind) &
        allowed = tolerances(i)%absolute + tolerances(i)%relative*maxval(abs(wanted%values))
    end do
    worst = maxloc(abs(got%values - wanted%values), 1)
    if (abs(got%values(worst) - wanted%values(worst)) > allowed) &
      call differences%add(wanted%name//': number '//to_text(worst)//' is '//to_text(got%values(worst))//' instead of '// &
                           to_text(wanted%values(worst))//', more than '//to_text(allowed, 3)//' away', file=file)
  end subroutine compare
end module sg_tagged
