!> Tally of one measure: named sums and largest values of bodies and contacts, and the columns that follow from them.
!!
!! Indicators are visited three times (`sg_measures`): they put their largest values, their sums, and at last their columns.
!! Between the visits values are combined over the ranks, so that columns are those of the whole scene, on all ranks. What one
!! indicator has put others read by its name.
module sg_tally
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: tally_t, ledger_t, column_t, pass_largest, pass_sums, pass_columns, ratio

  !> Visits: largest values and what needs none of other ranks; sums, which may use largest values of all ranks; columns
  integer, parameter :: pass_largest = 1, pass_sums = 2, pass_columns = 3

  !> Values under the name of what put them
  type :: ledger_t
    !> Values of all entries, one after the other
    real(wp), allocatable :: value(:)
    character(len=16), allocatable, private :: name(:)
    !> Place of the last value of each entry
    integer, allocatable, private :: last(:)
  contains
    procedure :: put => ledger_put
    procedure :: get => ledger_get
  end type ledger_t

  !> A column of record.csv, an entry of run.json
  type :: column_t
    !> Name
    character(len=32) :: name = ''
    !> Value at the moment of the measure
    real(wp) :: value = 0
    !> Is it a whole number?
    logical :: is_count = .false.
  end type column_t

  !> All that one measure holds
  type :: tally_t
    !> Present visit
    integer :: pass = pass_largest
    !> Do several ranks hold the scene? Are there cohesive zones? Do laws resist rolling?
    logical :: is_shared = .false., has_bonds = .false., has_rolling = .false.
    !> Kinds of bodies with a column of their own, ascending (sg_body_kinds); unallocated where the scene has one kind
    integer, allocatable :: kinds(:)
    !> Time step [s]
    real(wp) :: h = 0
    !> Sums over bodies and contacts, and largest values
    type(ledger_t) :: sums, largest
    !> Columns in the order of indicators
    type(column_t), allocatable :: column(:)
  contains
    procedure :: set_kinds => tally_set_kinds
    procedure :: add => tally_add
    procedure :: reduce => tally_reduce
  end type tally_t

contains

  !> Put values under a name.
  pure subroutine ledger_put(self, name, values)
    class(ledger_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! one that no other entry has
    real(wp), intent(in) :: values(:) !! values; all ranks give the same number of them

    if (.not. allocated(self%value)) allocate (self%value(0), self%name(0), self%last(0))
    self%value = [self%value, values]
    self%name = [character(len=len(self%name)) :: self%name, name]
    self%last = [self%last, size(self%value)]
  end subroutine ledger_put

  !> Values under a name; zeros where there is no such entry, as where only names of columns are asked for.
  pure function ledger_get(self, name, n) result(values)
    class(ledger_t), intent(in) :: self
    character(len=*), intent(in) :: name !! name of the entry
    integer, intent(in) :: n !! number of its values
    real(wp) :: values(n)
    integer :: i

    values = 0
    if (.not. allocated(self%name)) return
    do i = 1, size(self%name)
      if (self%name(i) == name) values = self%value(self%last(i) - n + 1:self%last(i))
    end do
  end function ledger_get

  !> Give kinds of bodies columns of their own, where there are several.
  pure subroutine tally_set_kinds(self, kinds)
    class(tally_t), intent(inout) :: self
    logical, intent(in) :: kinds(:) !! kinds of bodies of the whole scene, by number
    integer :: i

    if (count(kinds) > 1) self%kinds = pack([(i, i=1, size(kinds))], kinds)
  end subroutine tally_set_kinds

  !> Add a column.
  pure subroutine tally_add(self, name, value, is_count)
    class(tally_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! its name, which stands in files and scripts
    real(wp), intent(in) :: value !! its value
    logical, intent(in), optional :: is_count !! is it a whole number? Not unless given
    type(column_t) :: column

    column%name = name
    column%value = value
    if (present(is_count)) column%is_count = is_count
    if (.not. allocated(self%column)) allocate (self%column(0))
    self%column = [self%column, column]
  end subroutine tally_add

  !> End a visit: combine over all ranks what it has put, by one message, and go on to the next.
  subroutine tally_reduce(self, comm)
    class(tally_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks

    if (comm%size > 1 .and. self%pass == pass_largest) call comm%maximum(self%largest%value)
    if (comm%size > 1 .and. self%pass == pass_sums) call comm%sum(self%sums%value)
    self%pass = self%pass + 1
  end subroutine tally_reduce

  !> A ratio, zero where its denominator is not positive.
  pure real(wp) function ratio(part, whole)
    real(wp), intent(in) :: part !! numerator
    real(wp), intent(in) :: whole !! denominator

    ratio = 0
    if (whole > 0) ratio = part/whole
  end function ratio
end module sg_tally
