!> Fields of bodies or of contacts, and the visitor that goes through them.
!!
!! A type that extends `fields_t` (sg_fields) lists its fields once. What one visit does with each field is its task: describe it,
!! change its room, or move values of some items from the field into a table, out of a table into the field, or both. The table
!! holds reals, in which whole numbers stand exactly.
!!
!! Arrays have no `intent` here: tasks that only read also visit what must not change.
module sg_field_visitor
  use sg_kinds, only: wp, i1, i4, i8
  implicit none
  private
  public :: field_t, field_visitor_t

  !> When values of a field are sent to another rank: never, as each step computes them; with an item that changes its owner; also
  !! with a new copy of an item; also in each step, by the interface coupling of the solver. Each rule includes those before it
  integer, parameter, public :: sync_never = 0, sync_on_owner = 1, sync_on_copy = 2, sync_always = 3
  !> Kinds of values
  integer, parameter, public :: kind_real = 1, kind_integer = 2, kind_byte = 3, kind_flag = 4
  !> Bytes of a value of each kind
  integer, parameter, public :: bytes_of_kind(4) = [8, 4, 1, storage_size(.true.)/8]
  !> Tasks of a visit
  integer, parameter, public :: task_describe = 1, task_resize = 2, task_clear = 3, task_keep = 4, task_count = 5, task_move = 6

  !> A field: one array, with values of each item
  type :: field_t
    !> Name of the component of the type
    character(len=20) :: name = ''
    !> When it is sent, one of `sync_*`
    integer :: sync = sync_never
    !> Values per item
    integer :: components = 1
    !> Does the scene need it?
    logical :: is_there = .true.
    !> Is it in restart files?
    logical :: in_files = .false.
    !> First component of a new item; the others are zero
    real(wp) :: first = 0
    !> May a restart file be without it, or hold another number of components? Then its values start as those of new items
    logical :: is_optional = .false.
    !> Set by a visit: place in the list, kind of values, is it an array of one dimension, bytes in use or -1 where unallocated
    integer :: place = 0
    integer :: kind = kind_real
    logical :: is_list = .false.
    integer(i8) :: bytes = -1
  end type field_t

  !> One visit of all fields
  type :: field_visitor_t
    !> What it does, one of `task_*`
    integer :: task = task_describe
    !> Only fields that are sent by this rule or a higher one; only the field of this place, if above 0
    integer :: least = sync_never, only = 0
    !> Only fields of this table, where the items of a type stand in several tables
    integer :: table = 0
    !> Items to make room for
    integer :: n = 0
    !> Are values read from fields, and written into fields? From and to these items
    logical :: is_read = .false., is_written = .false.
    integer(i4), allocatable :: from(:), to(:)
    !> Table of values: of all fields visited, or of one field after the other; shape (values per item, items)
    real(wp), allocatable :: value(:, :)
    !> Rows of the present field in the table
    integer :: first = 1, last = 0
    !> Fields described so far, and fields visited so far
    type(field_t), allocatable :: list(:)
    integer :: visited = 0
  contains
    procedure, private :: visit_reals, visit_real_records, visit_integers, visit_integer_records, visit_bytes, visit_flags
    !> Visit a field
    generic :: visit => visit_reals, visit_real_records, visit_integers, visit_integer_records, visit_bytes, visit_flags
  end type field_visitor_t

contains

  !> Note a field, prepare the table, and does the task have to do with values of the field?
  logical function takes(self, field, kind, is_list, now)
    type(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field
    integer, intent(in) :: kind
    logical, intent(in) :: is_list
    integer, intent(in) :: now(2) !! components and items that its array has; -1 items where it is unallocated
    integer :: i

    self%visited = self%visited + 1
    takes = field%sync >= self%least .and. (self%only == 0 .or. self%only == self%visited) .and. &
            (field%is_there .or. self%task == task_resize)
    if (self%task == task_describe) call describe(self, field, kind, is_list, now)
    if (.not. takes) return
    select case (self%task)
    case (task_describe)
      takes = .false.
    case (task_resize)
      takes = .not. (field%is_there .and. all(now == [field%components, self%n]))
      self%from = [(int(i, i4), i=1, min(now(2), self%n))]
      if (allocated(self%to)) deallocate (self%to)
      allocate (self%to, source=self%from)
      self%is_read = size(self%from) > 0
      self%is_written = self%is_read .and. field%is_there
      call open_table(self, min(now(1), field%components))
    case (task_clear, task_keep)
      takes = size(self%to) > 0
      call open_table(self, field%components)
      self%value(:min(1, self%last), :) = field%first
    case default
      self%first = self%last + 1
      self%last = self%last + field%components
      takes = self%task == task_move
      if (takes) takes = size(self%value, 2) > 0
    end select
  end function takes

  !> A table of one field.
  subroutine open_table(self, components)
    type(field_visitor_t), intent(inout) :: self
    integer, intent(in) :: components

    self%last = components
    if (allocated(self%value)) deallocate (self%value)
    allocate (self%value(components, size(self%to)), source=0.0_wp)
  end subroutine open_table

  !> Append a field to the list of those described.
  subroutine describe(self, field, kind, is_list, now)
    type(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field
    integer, intent(in) :: kind, now(2)
    logical, intent(in) :: is_list
    type(field_t), allocatable :: longer(:)

    allocate (longer(self%visited))
    if (self%visited > 1) longer(:self%visited - 1) = self%list
    longer(self%visited) = field
    associate (described => longer(self%visited))
      described%place = self%visited
      described%kind = kind
      described%is_list = is_list
      if (now(2) >= 0) described%bytes = int(bytes_of_kind(kind)*now(1), i8)*int(now(2), i8)
    end associate
    call move_alloc(longer, self%list)
  end subroutine describe

  !> Visit a list of reals.
  subroutine visit_reals(self, field, array)
    class(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field !! what it is
    real(wp), allocatable :: array(:) !! its values
    integer :: now(2)

    now = [1, -1]
    if (allocated(array)) now(2) = size(array)
    if (.not. takes(self, field, kind_real, .true., now)) return
    if (self%is_read) self%value(self%last, :) = array(self%from)
    if (self%task == task_resize) then
      if (allocated(array)) deallocate (array)
      if (field%is_there) allocate (array(self%n), source=field%first)
    end if
    if (self%is_written) array(self%to) = self%value(self%last, :)
  end subroutine visit_reals

  !> Visit records of reals.
  subroutine visit_real_records(self, field, array)
    class(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field !! what it is
    real(wp), allocatable :: array(:, :) !! its values, shape (components, items)
    integer :: now(2)

    now = [1, -1]
    if (allocated(array)) now = shape(array)
    if (.not. takes(self, field, kind_real, .false., now)) return
    if (self%is_read) self%value(self%first:self%last, :) = array(:self%last - self%first + 1, self%from)
    if (self%task == task_resize) then
      if (allocated(array)) deallocate (array)
      if (field%is_there) allocate (array(field%components, self%n), source=0.0_wp)
      if (field%is_there) array(:min(1, field%components), :) = field%first
    end if
    if (self%is_written) array(:self%last - self%first + 1, self%to) = self%value(self%first:self%last, :)
  end subroutine visit_real_records

  !> Visit a list of integers.
  subroutine visit_integers(self, field, array)
    class(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field !! what it is
    integer(i4), allocatable :: array(:) !! its values
    integer :: now(2)

    now = [1, -1]
    if (allocated(array)) now(2) = size(array)
    if (.not. takes(self, field, kind_integer, .true., now)) return
    if (self%is_read) self%value(self%last, :) = real(array(self%from), wp)
    if (self%task == task_resize) then
      if (allocated(array)) deallocate (array)
      if (field%is_there) allocate (array(self%n), source=nint(field%first, i4))
    end if
    if (self%is_written) array(self%to) = nint(self%value(self%last, :), i4)
  end subroutine visit_integers

  !> Visit records of integers.
  subroutine visit_integer_records(self, field, array)
    class(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field !! what it is
    integer(i4), allocatable :: array(:, :) !! its values, shape (components, items)
    integer :: now(2)

    now = [1, -1]
    if (allocated(array)) now = shape(array)
    if (.not. takes(self, field, kind_integer, .false., now)) return
    if (self%is_read) self%value(self%first:self%last, :) = real(array(:self%last - self%first + 1, self%from), wp)
    if (self%task == task_resize) then
      if (allocated(array)) deallocate (array)
      if (field%is_there) allocate (array(field%components, self%n), source=0_i4)
      if (field%is_there) array(:min(1, field%components), :) = nint(field%first, i4)
    end if
    if (self%is_written) array(:self%last - self%first + 1, self%to) = nint(self%value(self%first:self%last, :), i4)
  end subroutine visit_integer_records

  !> Visit a list of bytes.
  subroutine visit_bytes(self, field, array)
    class(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field !! what it is
    integer(i1), allocatable :: array(:) !! its values
    integer :: now(2)

    now = [1, -1]
    if (allocated(array)) now(2) = size(array)
    if (.not. takes(self, field, kind_byte, .true., now)) return
    if (self%is_read) self%value(self%last, :) = real(array(self%from), wp)
    if (self%task == task_resize) then
      if (allocated(array)) deallocate (array)
      if (field%is_there) allocate (array(self%n), source=nint(field%first, i1))
    end if
    if (self%is_written) array(self%to) = nint(self%value(self%last, :), i1)
  end subroutine visit_bytes

  !> Visit a list of flags: 1 is true.
  subroutine visit_flags(self, field, array)
    class(field_visitor_t), intent(inout) :: self
    type(field_t), intent(in) :: field !! what it is
    logical, allocatable :: array(:) !! its values
    integer :: now(2)

    now = [1, -1]
    if (allocated(array)) now(2) = size(array)
    if (.not. takes(self, field, kind_flag, .true., now)) return
    if (self%is_read) self%value(self%last, :) = merge(1.0_wp, 0.0_wp, array(self%from))
    if (self%task == task_resize) then
      if (allocated(array)) deallocate (array)
      if (field%is_there) allocate (array(self%n), source=field%first > 0)
    end if
    if (self%is_written) array(self%to) = self%value(self%last, :) > 0
  end subroutine visit_flags

end module sg_field_visitor
