!> A list of the tables that a run holds, and what each takes: how it is shown that what a scene does not need is not allocated.
module sg_tables
  use sg_kinds, only: wp, i1, i4, i8
  implicit none
  private
  public :: tables_t, per_body, per_contact

  !> What a table has an item for
  integer, parameter :: per_body = 1, per_contact = 2

  !> One table
  type :: table_t
    !> Whose it is, and its name there
    character(len=16) :: owner = ''
    character(len=20) :: name = ''
    !> What it has an item for, `per_body` or `per_contact`
    integer :: per = per_body
    !> Is it there?
    logical :: is_there = .false.
    !> Bytes, room for more items included
    integer(i8) :: bytes = 0
  end type table_t

  !> Tables, owner by owner
  type :: tables_t
    !> Number of tables
    integer :: n = 0
    !> The tables, of which the first `n` count
    type(table_t), allocatable :: list(:)
    character(len=16), private :: owner = ''
    integer, private :: per = per_body
  contains
    procedure :: begin => tables_begin
    procedure :: add => tables_add
    procedure :: bytes_per => tables_bytes_per
    procedure, private :: note_reals, note_records, note_groups, note_integers, note_integer_records, note_integer_groups, &
      note_long, note_bytes, note_flags
    !> Note a table, allocated or not
    generic :: note => note_reals, note_records, note_groups, note_integers, note_integer_records, note_integer_groups, &
      note_long, note_bytes, note_flags
  end type tables_t

contains

  !> Set the owner of the next tables, and what they have an item for.
  subroutine tables_begin(self, owner, per)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: owner !! their owner
    integer, intent(in) :: per !! `per_body` or `per_contact`

    self%owner = owner
    self%per = per
  end subroutine tables_begin

  !> Add a table, by its bytes; a negative number of bytes stands for one that is not there. Tables of one owner and name count as
  !! one: what several objects of a kind hold adds up.
  subroutine tables_add(self, name, bytes)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! its name
    integer(i8), intent(in) :: bytes !! what it takes
    type(table_t), allocatable :: grown(:)
    integer :: i

    if (.not. allocated(self%list)) allocate (self%list(64))
    do i = 1, self%n
      if (self%list(i)%name /= name) cycle
      if (self%list(i)%owner /= self%owner .or. self%list(i)%per /= self%per) cycle
      self%list(i)%is_there = self%list(i)%is_there .or. bytes >= 0
      self%list(i)%bytes = self%list(i)%bytes + max(0_i8, bytes)
      return
    end do
    if (self%n == size(self%list)) then
      allocate (grown(2*self%n))
      grown(:self%n) = self%list
      call move_alloc(grown, self%list)
    end if
    self%n = self%n + 1
    self%list(self%n) = table_t(self%owner, name, self%per, bytes >= 0, max(0_i8, bytes))
  end subroutine tables_add

  !> Bytes of all tables that have an item for each body, or for each contact.
  pure integer(i8) function tables_bytes_per(self, per) result(bytes)
    class(tables_t), intent(in) :: self
    integer, intent(in) :: per !! `per_body` or `per_contact`

    bytes = sum(self%list(:self%n)%bytes, self%list(:self%n)%per == per)
  end function tables_bytes_per

  !> Note list of reals.
  subroutine note_reals(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(in) :: table(:)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_reals

  !> Note records of reals.
  subroutine note_records(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(in) :: table(:, :)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_records

  !> Note records of groups of reals.
  subroutine note_groups(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(in) :: table(:, :, :)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_groups

  !> Note list of integers.
  subroutine note_integers(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i4), allocatable, intent(in) :: table(:)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_integers

  !> Note records of integers.
  subroutine note_integer_records(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i4), allocatable, intent(in) :: table(:, :)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_integer_records

  !> Note records of groups of integers.
  subroutine note_integer_groups(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i4), allocatable, intent(in) :: table(:, :, :)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_integer_groups

  !> Note list of long integers.
  subroutine note_long(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i8), allocatable, intent(in) :: table(:)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_long

  !> Note list of bytes.
  subroutine note_bytes(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i1), allocatable, intent(in) :: table(:)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_bytes

  !> Note list of flags.
  subroutine note_flags(self, name, table)
    class(tables_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    logical, allocatable, intent(in) :: table(:)
    integer(i8) :: bytes

    bytes = -1
    if (allocated(table)) bytes = size(table, kind=i8)*(storage_size(table)/8)
    call self%add(name, bytes)
  end subroutine note_flags
end module sg_tables
