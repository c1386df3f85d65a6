!> Nesterov's momentum on sweeps [Nesterov1983], with restart [ODonoghueCandes2015]: before a sweep impulses and velocities go on
!! by one share of their last change (doc/theory/nesterov.md).
!!
!! x is what a sweep leaves, y what it starts from. Impulses and velocities go on together, so that V = V_free + M^-1 H r holds for
!! y as it does for x; that y may leave the cones does no harm, since a local solve does not depend on the contact's own impulse.
!! The passes over iterates are as short as vector registers allow (sg_iterates, doc/performance.md): bodies have two records, which
!! change places, and first sweeps and pauses have no pass at all.
module sg_nesterov
  use sg_comm, only: comm_t, sum_of_sweep
  use sg_iterates, only: exchange_order, hold, iterates_t, step_order, takes_momentum
  use sg_kinds, only: wp
  use sg_nesterov_rule, only: nesterov_rule_t
  use sg_order_values, only: give_impulses, put_impulses
  use sg_problem, only: problem_t
  use sg_sweep_order, only: sweep_order_t
  use sg_sweeps, only: sweep
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: nesterov_t

  !> Sweeps of a solve before the first with momentum: a solve that ends with its first test pays nothing
  integer, parameter :: first_sweeps = 5
  !> Sums of a rank whose pass had no start
  real(wp), parameter :: no_sums(3) = [0.0_wp, 0.0_wp, 1.0_wp]

  !> Momentum of one solve
  type :: nesterov_t
    !> Do sweeps take it?
    logical :: is_on = .false.
    !> Did the last sweep start from y? Then x before it is held
    logical :: has_stepped = .false.
    !> The rule that gives the share
    type(nesterov_rule_t) :: rule
    !> Is the start of the last sweep known?
    logical, private :: has_start = .false.
    !> Do impulses go on with the next sweep?
    logical :: is_due = .false.
    !> Square of a sweep's change x - y, its product with the change of x from sweep to sweep, and number of ranks that lack a start
    !! for them: orders change on some ranks alone, and all must ignore such sums alike. Are they being summed over ranks?
    real(wp), private :: sums(3) = 0
    logical, private :: is_pending = .false.
    !> Iterates of each order, and records of bodies with the velocities of x before the last sweep
    type(iterates_t), allocatable, private :: past(:)
    real(wp), allocatable, private :: body(:, :)
    !> Rates of a periodic cell at x before the last sweep [1/s]
    real(wp), private :: rate(4) = 0
    !> Impulses of the sweep before and present ones, by contact, while orders change
    real(wp), allocatable, private :: carried(:, :), present(:, :)
  contains
    procedure :: begin => nesterov_begin
    procedure :: go_on => nesterov_go_on
    procedure :: sweep => nesterov_sweep
    procedure :: restore => nesterov_restore
    procedure :: finish => nesterov_finish
    procedure :: rest => nesterov_rest
    procedure :: carry => nesterov_carry
    procedure :: keep_moving => nesterov_keep_moving
    procedure :: resume => nesterov_resume
    procedure :: list_tables => nesterov_list_tables
  end type nesterov_t

contains

  !> Begin a solve, without a past.
  pure subroutine nesterov_begin(self, is_on)
    class(nesterov_t), intent(inout) :: self
    logical, intent(in) :: is_on !! do sweeps take momentum?

    self%is_on = is_on
    self%is_due = .false.
    self%has_stepped = .false.
    call self%rule%begin(first_sweeps)
  end subroutine nesterov_begin

  !> Pause, since the error of the tests does not fall: plain sweeps have their turn.
  pure subroutine nesterov_rest(self)
    class(nesterov_t), intent(inout) :: self

    call self%rule%rest()
  end subroutine nesterov_rest

  !> Let impulses and velocities go on before a round: x becomes y. First sweeps, and those of a pause, start from x. Impulses of
  !! solids side by side go on with the sweep, where a round is one.
  subroutine nesterov_go_on(self, orders, problem, is_sweep, comm)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    type(problem_t), intent(inout) :: problem !! its velocities are those of the impulses in the orders
    logical, intent(in) :: is_sweep !! is a round one sweep of one order?
    type(comm_t), intent(inout) :: comm !! the ranks, which take the same share
    real(wp) :: share
    real(wp), allocatable :: body(:, :)
    integer :: s

    call self%finish(comm)
    self%is_due = .false.
    if (self%rule%is_resting()) then
      call self%rule%next(self%sums(:2), .false., share)
      self%has_stepped = .false.
      return
    end if
    if (.not. self%has_stepped) call begin_past(self, orders, problem)
    call self%rule%next(self%sums(:2), .not. self%sums(3) > 0, share)
    self%past%share = share
    self%is_due = is_sweep .and. takes_momentum(orders(1))
    if (.not. self%is_due) then
      do s = 1, size(orders)
        call step_order(orders(s), self%past(s))
      end do
    end if
    self%sums = no_sums
    if (self%has_start) self%sums = [sum(self%past%sums(1)), sum(self%past%sums(2)), 0.0_wp]
    self%has_start = .true.
    self%is_pending = comm%size > 1
    if (self%is_pending) call comm%begin_sum(sum_of_sweep, self%sums)
    call step_bodies(size(problem%body, 1)*problem%n_bodies, share, problem%body, self%body)
    call move_alloc(self%body, body)
    call move_alloc(problem%body, self%body)
    call move_alloc(body, problem%body)
    call step_rates(share, problem%cell%rate, self%rate)
    self%has_stepped = .true.
  end subroutine nesterov_go_on

  !> Sweep once; impulses that are due go on meanwhile.
  subroutine nesterov_sweep(self, order, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: order !! all contacts that are swept
    type(problem_t), intent(inout) :: problem !! velocities change

    call sweep(problem%kind, order, problem%n_bodies, 1.0_wp, problem%body, self%past(1))
    self%is_due = .false.
  end subroutine nesterov_sweep

  !> Finish the sums of the last pass: over the ranks they travel while the sweep goes on.
  subroutine nesterov_finish(self, comm)
    class(nesterov_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks

    if (self%is_pending) call comm%finish_sum(sum_of_sweep, self%sums)
    self%is_pending = .false.
  end subroutine nesterov_finish

  !> Take the present impulses and velocities for those of the sweep before.
  subroutine begin_past(self, orders, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(in) :: orders(:)
    type(problem_t), intent(in) :: problem
    integer :: s

    if (allocated(self%past)) then
      if (size(self%past) /= size(orders)) deallocate (self%past)
    end if
    if (.not. allocated(self%past)) allocate (self%past(size(orders)))
    do s = 1, size(orders)
      call hold(orders(s), self%past(s))
    end do
    ! Allocated before: an assignment would compute with the bounds of what is not there.
    if (allocated(self%body)) deallocate (self%body)
    allocate (self%body(size(problem%body, 1), size(problem%body, 2)))
    self%body(:, :) = problem%body
    self%rate = problem%cell%rate
    self%has_start = .false.
    self%sums = no_sums
  end subroutine begin_past

  !> Velocities of y, from those of x and of the sweep before. All reals of a record are passed alike: others than velocities are
  !! the same in both.
  pure subroutine step_bodies(n, share, body, before)
    integer, intent(in) :: n !! reals of all records
    real(wp), intent(in) :: share !! of the change to go on by
    real(wp), intent(in) :: body(n) !! records of bodies with the velocities of x
    real(wp), intent(inout) :: before(n) !! those of the sweep before, then those of y
    integer :: i

    do i = 1, n
      before(i) = body(i) + share*(body(i) - before(i))
    end do
  end subroutine step_bodies

  !> Rates of a periodic cell of y, from those of x and of the sweep before.
  pure subroutine step_rates(share, rate, before)
    real(wp), intent(in) :: share !! of the change to go on by
    real(wp), intent(inout) :: rate(4) !! those of x, then those of y
    real(wp), intent(inout) :: before(4) !! those of the sweep before, then those of x
    real(wp) :: change(4)

    change = rate - before
    before = rate
    rate = rate + share*change
  end subroutine step_rates

  !> Take the last step back: y becomes x again, where a round has begun that is not wanted.
  subroutine nesterov_restore(self, orders, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    type(problem_t), intent(inout) :: problem !! its velocities become those of x
    integer :: s

    do s = 1, size(orders)
      call exchange_order(orders(s), self%past(s))
    end do
    problem%body(:, :) = self%body
    problem%cell%rate = self%rate
    call self%begin(self%is_on)
  end subroutine nesterov_restore

  !> Write down by contact what the sweep before left, since the orders are about to change.
  subroutine nesterov_carry(self, orders, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    type(problem_t), intent(inout) :: problem !! its impulses are those in the orders, and come back so
    integer :: s

    if (.not. self%has_stepped) return
    do s = 1, size(orders)
      call exchange_order(orders(s), self%past(s))
      call give_impulses(orders(s), problem)
      call exchange_order(orders(s), self%past(s))
    end do
    call keep(problem, self%carried)
    do s = 1, size(orders)
      call give_impulses(orders(s), problem)
    end do
  end subroutine nesterov_carry

  !> Copy the impulses of a problem by contact.
  pure subroutine keep(problem, impulse)
    type(problem_t), intent(in) :: problem
    real(wp), allocatable, intent(inout) :: impulse(:, :)

    associate (n => problem%n_contacts)
      if (allocated(impulse)) then
        if (size(impulse, 2) < n .or. size(impulse, 1) /= size(problem%impulse, 1)) deallocate (impulse)
      end if
      if (.not. allocated(impulse)) allocate (impulse(size(problem%impulse, 1), n + n/8))
      impulse(:, :n) = problem%impulse(:, :n)
    end associate
  end subroutine keep

  !> Keep contacts that carried an impulse one sweep ago, since velocities go on by the change of theirs.
  pure subroutine nesterov_keep_moving(self, is_wanted)
    class(nesterov_t), intent(in) :: self
    logical, intent(inout) :: is_wanted(:) !! contacts to visit, shape (contacts)
    integer :: k

    if (.not. self%has_stepped) return
    do k = 1, size(is_wanted)
      if (.not. is_wanted(k)) is_wanted(k) = any(abs(self%carried(:, k)) > 0)
    end do
  end subroutine nesterov_keep_moving

  !> Give changed orders what the sweep before left. The bodies of contacts that have left the orders with a change, those of
  !! solved clusters, stay where they are.
  subroutine nesterov_resume(self, orders, is_ordered, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    logical, intent(in) :: is_ordered(:) !! are contacts in one of the orders?
    type(problem_t), intent(inout) :: problem !! its impulses are those of the orders
    integer :: s, k, n

    if (.not. self%has_stepped) return
    if (all(orders%serial == self%past%serial)) return
    n = problem%n_contacts
    do k = 1, n
      if (is_ordered(k)) cycle
      if (.not. any(abs(problem%impulse(:, k) - self%carried(:, k)) > 0)) cycle
      self%body(:, problem%pair(:, k)) = problem%body(:, problem%pair(:, k))
    end do
    call keep(problem, self%present)
    do s = 1, size(orders)
      problem%impulse(:, :n) = self%carried(:, :n)
      call put_impulses(orders(s), problem)
      call hold(orders(s), self%past(s))
      problem%impulse(:, :n) = self%present(:, :n)
      call put_impulses(orders(s), problem)
    end do
    self%has_start = .false.
  end subroutine nesterov_resume

  !> List the tables.
  subroutine nesterov_list_tables(self, tables)
    class(nesterov_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to
    integer :: s

    call tables%begin('nesterov', per_contact)
    call tables%note('carried', self%carried)
    call tables%note('present', self%present)
    if (allocated(self%past)) then
      do s = 1, size(self%past)
        call tables%note('before', self%past(s)%before)
        call tables%note('start', self%past(s)%start)
      end do
    end if
    call tables%begin('nesterov', per_body)
    call tables%note('body', self%body)
  end subroutine nesterov_list_tables
end module sg_nesterov
