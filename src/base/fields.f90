!> Types that list their fields: arrays with values of each item. Room, messages between ranks, restart files and the memory report
!! follow from the list. A type whose items stand in several tables (contactors: one per kind of shape) lists them table by table.
module sg_fields
  use sg_field_visitor, only: bytes_of_kind, field_t, field_visitor_t, task_clear, task_count, task_keep, task_move, &
                              task_resize
  use sg_kinds, only: wp, i4, i8
  use sg_tables, only: tables_t
  implicit none
  private
  public :: fields_t

  !> A type with a list of fields
  type, abstract :: fields_t
  contains
    !> Visit all fields: the list
    procedure(visit_fields), deferred :: visit
    procedure :: described => fields_described
    procedure :: bytes_per_item => fields_bytes_per_item
    procedure :: note => fields_note
    procedure :: resize => fields_resize
    procedure :: clear => fields_clear
    procedure :: keep => fields_keep
    procedure :: width => fields_width
    procedure :: pack => fields_pack
    procedure :: unpack => fields_unpack
  end type fields_t

  abstract interface
    !> Visit all fields.
    subroutine visit_fields(self, visitor)
      import :: fields_t, field_visitor_t
      class(fields_t) :: self !! without intent, as visits that only read take what must not change
      type(field_visitor_t), intent(inout) :: visitor !! what the visit does
    end subroutine visit_fields
  end interface

contains

  !> What each field is, in the order of the list.
  function fields_described(self, table) result(list)
    class(fields_t), intent(in) :: self
    integer, intent(in), optional :: table !! table of the fields, 0 unless given
    type(field_t), allocatable :: list(:)
    type(field_visitor_t) :: visitor

    if (present(table)) visitor%table = table
    allocate (visitor%list(0))
    call self%visit(visitor)
    call move_alloc(visitor%list, list)
  end function fields_described

  !> Memory per item [bytes].
  integer(i8) function fields_bytes_per_item(self) result(bytes)
    class(fields_t), intent(in) :: self
    type(field_t), allocatable :: list(:)

    list = self%described()
    bytes = sum(int(list%components*bytes_of_kind(list%kind), i8), list%is_there)
  end function fields_bytes_per_item

  !> Add all fields to a memory report.
  subroutine fields_note(self, tables, table)
    class(fields_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to
    integer, intent(in), optional :: table !! table of the fields, 0 unless given
    type(field_t), allocatable :: list(:)
    integer :: i

    list = self%described(table)
    do i = 1, size(list)
      call tables%add(list(i)%name, list(i)%bytes)
    end do
  end subroutine fields_note

  !> Make room for exactly `n` items, each with the components that the scene needs. What fits stays, and fields that the scene does
  !! not need are given back.
  subroutine fields_resize(self, n, table)
    class(fields_t), intent(inout) :: self
    integer, intent(in) :: n !! items
    integer, intent(in), optional :: table !! table of the fields, 0 unless given
    type(field_visitor_t) :: visitor

    visitor = field_visitor_t(task=task_resize, n=n)
    if (present(table)) visitor%table = table
    call self%visit(visitor)
  end subroutine fields_resize

  !> Put an item back to what it is when room is made.
  subroutine fields_clear(self, item)
    class(fields_t), intent(inout) :: self
    integer, intent(in) :: item !! the item
    type(field_visitor_t) :: visitor

    visitor = field_visitor_t(task=task_clear, is_written=.true., to=[int(item, i4)])
    call self%visit(visitor)
  end subroutine fields_clear

  !> Move some items to the front, in the order given; the room stays.
  subroutine fields_keep(self, item)
    class(fields_t), intent(inout) :: self
    integer(i4), intent(in) :: item(:) !! items to keep
    type(field_visitor_t) :: visitor
    integer :: i

    visitor = field_visitor_t(task=task_keep, is_read=.true., is_written=.true., from=item, to=[(int(i, i4), i=1, size(item))])
    call self%visit(visitor)
  end subroutine fields_keep

  !> Values per item in the fields that are sent by some rule or a higher one.
  integer function fields_width(self, least, table) result(width)
    class(fields_t), intent(in) :: self
    integer, intent(in) :: least !! lowest rule, one of `sync_*`
    integer, intent(in), optional :: table !! table of the fields, 0 unless given
    type(field_visitor_t) :: visitor

    visitor = field_visitor_t(task=task_count, least=least)
    if (present(table)) visitor%table = table
    call self%visit(visitor)
    width = visitor%last
  end function fields_width

  !> Write values of some items into a table.
  subroutine fields_pack(self, item, values, least, only, table)
    class(fields_t), intent(in) :: self
    integer(i4), intent(in) :: item(:) !! items
    real(wp), allocatable, intent(out) :: values(:, :) !! shape (`width`, items)
    integer, intent(in) :: least !! lowest rule of the fields written, one of `sync_*`
    integer, intent(in), optional :: only !! place of the only field to write
    integer, intent(in), optional :: table !! table of the fields, 0 unless given
    type(field_visitor_t) :: visitor, mover

    visitor = field_visitor_t(task=task_count, least=least)
    if (present(only)) visitor%only = only
    if (present(table)) visitor%table = table
    mover = visitor
    call self%visit(visitor)
    mover%task = task_move
    mover%is_read = .true.
    mover%from = item
    allocate (mover%value(visitor%last, size(item)))
    call self%visit(mover)
    call move_alloc(mover%value, values)
  end subroutine fields_pack

  !> Read what `pack` wrote.
  subroutine fields_unpack(self, item, values, least, only, table)
    class(fields_t), intent(inout) :: self
    integer(i4), intent(in) :: item(:) !! items
    real(wp), intent(in) :: values(:, :) !! shape (`width`, items)
    integer, intent(in) :: least !! lowest rule of the fields read, one of `sync_*`
    integer, intent(in), optional :: only !! place of the only field to read
    integer, intent(in), optional :: table !! table of the fields, 0 unless given
    type(field_visitor_t) :: visitor

    visitor = field_visitor_t(task=task_move, least=least, is_written=.true., to=item, value=values)
    if (present(only)) visitor%only = only
    if (present(table)) visitor%table = table
    call self%visit(visitor)
  end subroutine fields_unpack
end module sg_fields
