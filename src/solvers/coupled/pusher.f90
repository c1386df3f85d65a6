!> The smallest displacements that open gaps, found by a few sweeps with momentum over the rows of all ranks
!! (doc/theory/recovery.md).
!!
!! Nothing is tested, so that ranks sum nothing: momentum follows the sequence without restarts [Nesterov1983], and what so many
!! sweeps leave is for the next push. Copies of a body have divided masses and take their mean, as by the dual method.
module sg_pusher
  use sg_comm, only: comm_t
  use sg_gluing, only: gluing_t
  use sg_kinds, only: wp, i4
  use sg_nesterov_rule, only: nesterov_rule_t
  use sg_push_problem, only: push_problem_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: pusher_t

  !> Solver of pushes, with its room from one to the next
  type :: pusher_t
    !> The problem of the push
    type(push_problem_t) :: push
    !> Copies of bodies on other ranks
    type(gluing_t), private :: gluing
    !> Impulses and records of bodies of the sweep before
    real(wp), allocatable, private :: impulse(:), body(:, :)
  contains
    procedure :: solve => pusher_solve
    procedure :: list_tables => pusher_list_tables
  end type pusher_t

contains

  !> Find displacements, from none. Collective.
  subroutine pusher_solve(self, sweeps, coupling, comm)
    class(pusher_t), intent(inout) :: self !! its problem is finished
    integer, intent(in) :: sweeps !! over all rows
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), parameter :: no_sums(2) = 0
    type(nesterov_rule_t) :: rule
    real(wp) :: share
    integer :: i

    if (comm%size > 1) call open_copies(self, coupling, comm)
    self%body = self%push%bodies%body
    self%impulse = self%push%impulse(:self%push%n)
    call rule%begin(0)
    do i = 1, sweeps
      if (i > 1) then
        call rule%next(no_sums, .false., share)
        call go_on(self, share)
        if (comm%size > 1) call self%gluing%mark(self%push%bodies)
      end if
      call sweep(self%push)
      if (comm%size == 1) cycle
      call self%gluing%begin(self%push%bodies, comm)
      call self%gluing%finish(self%push%bodies, comm)
    end do
    if (comm%size > 1) call self%gluing%interface%update_idle(self%push%bodies%body, coupling, comm)
  end subroutine pusher_solve

  !> Divide masses among copies. Collective.
  subroutine open_copies(self, coupling, comm)
    type(pusher_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    type(comm_t), intent(inout) :: comm
    integer, allocatable :: copies(:)

    call self%gluing%prepare(self%push%bodies, coupling, .true., .false., comm)
    allocate (copies(self%push%bodies%n_bodies), source=1)
    associate (interface => self%gluing%interface)
      copies(interface%slot) = max(1, interface%multiplicity)
    end associate
    call self%push%divide(copies)
  end subroutine open_copies

  !> Let impulses and displacements go on by a share of their last change.
  pure subroutine go_on(self, share)
    type(pusher_t), intent(inout) :: self
    real(wp), intent(in) :: share

    call step(size(self%body), share, self%push%bodies%body, self%body)
    call step(self%push%n, share, self%push%impulse, self%impulse)
  end subroutine go_on

  !> x and its predecessor become x + share (x - predecessor) and x. Inverse masses, which are in both, stay.
  pure subroutine step(n, share, x, before)
    integer, intent(in) :: n
    real(wp), intent(in) :: share
    real(wp), intent(inout) :: x(n), before(n)
    real(wp) :: now
    integer :: i

    do i = 1, n
      now = x(i)
      x(i) = now + share*(now - before(i))
      before(i) = now
    end do
  end subroutine step

  !> Sweep once over all rows: one loop, compiled for each width.
  pure subroutine sweep(push)
    type(push_problem_t), intent(inout) :: push

    associate (bodies => push%bodies)
      select case (push%width)
      case (2)
        call sweep_rows(2, push%n, bodies%pair, push%row, push%room, push%impulse, size(bodies%body, 1), bodies%body)
      case (3)
        call sweep_rows(3, push%n, bodies%pair, push%row, push%room, push%impulse, size(bodies%body, 1), bodies%body)
      case default
        call sweep_rows(6, push%n, bodies%pair, push%row, push%room, push%impulse, size(bodies%body, 1), bodies%body)
      end select
    end associate
  end subroutine sweep

  !> Sweep once over arrays of rows.
  pure subroutine sweep_rows(w, n, pair, row, room, impulse, length, body)
    integer, intent(in) :: w, n, length
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: row(4*w + 2, n), room(n)
    real(wp), intent(inout) :: impulse(n), body(length, *)
    real(wp) :: gap, change, lower
    integer :: k, i, c, a

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      gap = row(4*w + 1, k)
      do i = 1, w
        gap = gap + row(i, k)*body(i, c) + row(w + i, k)*body(i, a)
      end do
      lower = impulse(k) - gap*row(4*w + 2, k)
      change = max(lower, min(0.0_wp, lower + room(k)*row(4*w + 2, k))) - impulse(k)
      if (.not. abs(change) > 0) cycle
      impulse(k) = impulse(k) + change
      do i = 1, w
        body(i, c) = body(i, c) + row(2*w + i, k)*change
        body(i, a) = body(i, a) + row(3*w + i, k)*change
      end do
    end do
  end subroutine sweep_rows

  !> List the tables of pushes.
  subroutine pusher_list_tables(self, tables)
    class(pusher_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%push%list_tables(tables)
    call tables%begin('push', per_contact)
    call tables%note('before', self%impulse)
    call tables%begin('push', per_body)
    call tables%note('past', self%body)
    call self%gluing%list_tables(tables)
  end subroutine pusher_list_tables
end module sg_pusher
