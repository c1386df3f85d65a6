!> Active set of sweeps: contacts that carry an impulse, and open ones that close or part slowly (doc/theory/nlgs.md).
module sg_active_set
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_sweep_order, only: slack
  use sg_tables, only: per_contact, tables_t
  implicit none
  private
  public :: active_set_t, limit_of

  !> Open contacts that part faster than this many rms errors of velocity are not visited
  real(wp), parameter :: speed_limit = 30
  !> The first sweeps of a calm problem leave out contacts without a guess that part, before any impulse, faster than so many times
  !! what a step of free fall brings: by one of these a body that is held falls short of one that falls
  real(wp), parameter :: first_share = 1.25_wp

  !> Marks of the contacts of a problem
  type :: active_set_t
    !> Normal velocity of open contacts [m/s]: lowest of all where a contact carries an impulse, highest where it takes no part;
    !! shape (contacts), set where errors are measured
    real(wp), allocatable :: closing(:)
    !> Is a contact to be visited; and is it in the order of the sweep? shape (contacts)
    logical, allocatable :: is_wanted(:), is_ordered(:)
    !> Contacts without a guess; does none of them close faster than what a step of free fall brings?
    integer, private :: open = 0
    logical :: is_calm = .false.
  contains
    procedure :: begin => active_set_begin
    procedure :: reserve => active_set_reserve
    procedure :: want_all => active_set_want_all
    procedure :: look => active_set_look
    procedure :: choose_by_guess => active_set_choose_by_guess
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
      if (size(self%is_wanted) < n) deallocate (self%is_wanted, self%is_ordered)
    end if
    if (.not. allocated(self%is_wanted)) then
      room = n + n/8
      allocate (self%is_wanted(room), self%is_ordered(room))
    end if
    call self%want_all(n)
    if (.not. keeps_order) self%is_ordered(:n) = .false.
  end subroutine active_set_begin

  !> Room for the normal velocities of so many contacts, which errors are measured with one by one.
  pure subroutine active_set_reserve(self, n)
    class(active_set_t), intent(inout) :: self
    integer, intent(in) :: n !! contacts

    if (allocated(self%closing)) then
      if (size(self%closing) < n) deallocate (self%closing)
    end if
    if (.not. allocated(self%closing)) allocate (self%closing(n + n/8))
  end subroutine active_set_reserve

  !> Let all contacts be visited.
  pure subroutine active_set_want_all(self, n)
    class(active_set_t), intent(inout) :: self
    integer, intent(in) :: n !! contacts

    self%is_wanted(:n) = .true.
  end subroutine active_set_want_all

  !> Mark the contacts that a guess gives an impulse, and find out if the problem is calm: if no other one is hit.
  pure subroutine active_set_look(self, problem)
    class(active_set_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem with its guess

    associate (n => problem%n_contacts)
      call mark_carrying(n, size(problem%impulse, 1), problem%impulse, self%is_wanted, self%open)
      self%is_calm = problem%fall_speed > 0 .and. allocated(problem%opening)
      if (self%is_calm) self%is_calm = .not. is_hit(n, problem%opening, problem%fall_speed, self%is_wanted)
    end associate
  end subroutine active_set_look

  !> Choose the contacts of a calm problem before the first sweep: those to which the guess gives an impulse, and those that do not
  !! part fast without one. All are visited where few are open.
  pure subroutine active_set_choose_by_guess(self, problem)
    class(active_set_t), intent(inout) :: self !! has looked at the problem
    type(problem_t), intent(in) :: problem !! problem with its guess

    associate (n => problem%n_contacts)
      if (self%open <= n/slack) then
        call self%want_all(n)
      else
        call add_slow(n, problem%opening, first_share*problem%fall_speed, self%is_wanted)
      end if
    end associate
  end subroutine active_set_choose_by_guess

  !> Does a contact that carries nothing close faster than a speed? Without branches.
  pure logical function is_hit(n, opening, speed, carries)
    integer, intent(in) :: n
    real(wp), intent(in) :: opening(n), speed
    logical, intent(in) :: carries(n)

    is_hit = count(.not. carries .and. opening < -speed .and. opening > -huge(1.0_wp)) > 0
  end function is_hit

  !> Mark contacts that part no faster than a limit, too: without branches.
  pure subroutine add_slow(n, opening, limit, is_wanted)
    integer, intent(in) :: n
    real(wp), intent(in) :: opening(n), limit
    logical, intent(inout) :: is_wanted(n)
    integer :: k

    do k = 1, n
      is_wanted(k) = merge(.true., is_wanted(k), opening(k) <= limit)
    end do
  end subroutine add_slow

  !> Mark contacts with an impulse, and count the others: without branches.
  pure subroutine mark_carrying(n, components, impulse, carries, open)
    integer, intent(in) :: n, components
    real(wp), intent(in) :: impulse(components, *)
    logical, intent(inout) :: carries(n)
    integer, intent(out) :: open
    integer :: k

    select case (components)
    case (1)
      carries = abs(impulse(1, :n)) > 0
    case (2)
      carries = abs(impulse(1, :n)) + abs(impulse(2, :n)) > 0
    case default
      carries = abs(impulse(1, :n)) + abs(impulse(2, :n)) + abs(impulse(3, :n)) > 0
    end select
    ! Moments come behind forces.
    if (components > 3) then
      do k = 1, n
        carries(k) = carries(k) .or. any(abs(impulse(4:, k)) > 0)
      end do
    end if
    open = n - count(carries)
  end subroutine mark_carrying

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
