!> Active set of sweeps: contacts that carry an impulse, and open ones that close or part slowly (doc/theory/nlgs.md).
module sg_active_set
  use sg_kinds, only: wp
  use sg_report, only: report_t
  use sg_tables, only: per_contact, tables_t
  implicit none
  private
  public :: active_set_t, limit_of

  !> Open contacts that part faster than this many rms errors of velocity are not visited
  real(wp), parameter :: speed_limit = 30

  !> Marks of the contacts of a problem
  type :: active_set_t
    !> Normal velocity of open contacts [m/s]: lowest of all where a contact carries an impulse, highest where it takes no part;
    !! shape (contacts), set where errors are measured
    real(wp), allocatable :: closing(:)
    !> Is a contact to be visited; and is it in the order of the sweep? shape (contacts)
    logical, allocatable :: is_wanted(:), is_ordered(:)
  contains
    procedure :: begin => active_set_begin
    procedure :: choose => active_set_choose
    procedure :: list_tables => active_set_list_tables
  end type active_set_t

contains

  !> Begin a solve: all contacts are to be visited, and no order holds them yet, unless that of the last solve goes on.
  pure subroutine active_set_begin(self, n, keeps_order)
    class(active_set_t), intent(inout) :: self
    integer, intent(in) :: n !! contacts
    logical, intent(in) :: keeps_order !! are contacts those of the last solve, in an order that goes on?
    integer :: room

    if (allocated(self%is_wanted)) then
      if (size(self%is_wanted) < n) deallocate (self%closing, self%is_wanted, self%is_ordered)
    end if
    if (.not. allocated(self%is_wanted)) then
      room = n + n/8
      allocate (self%closing(room), self%is_wanted(room), self%is_ordered(room))
    end if
    self%is_wanted(:n) = .true.
    if (.not. keeps_order) self%is_ordered(:n) = .false.
  end subroutine active_set_begin

  !> Choose by the velocities that were found when errors were measured.
  pure subroutine active_set_choose(self, n, report)
    class(active_set_t), intent(inout) :: self
    integer, intent(in) :: n !! contacts
    type(report_t), intent(in) :: report !! errors of the whole problem

    self%is_wanted(:n) = self%closing(:n) <= limit_of(report)
  end subroutine active_set_choose

  !> Normal velocity above which open contacts are not visited [m/s].
  pure real(wp) function limit_of(report)
    type(report_t), intent(in) :: report !! errors of the whole problem

    limit_of = speed_limit*report%violation*report%velocity_scale
  end function limit_of

  !> List the tables.
  subroutine active_set_list_tables(self, tables)
    class(active_set_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('active_set', per_contact)
    call tables%note('closing', self%closing)
    call tables%note('is_wanted', self%is_wanted)
    call tables%note('is_ordered', self%is_ordered)
  end subroutine active_set_list_tables
end module sg_active_set
