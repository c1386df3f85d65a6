!> Nesterov's momentum on sweeps [Nesterov1983], with restart [ODonoghueCandes2015]: before a sweep impulses and velocities go on
!! by one share of their last change (doc/theory/nesterov.md).
!!
!! x is what a sweep leaves, y what it starts from. Impulses and velocities go on together, so that V = V_free + M^-1 H r holds for
!! y as it does for x; that y may leave the cones does no harm, since a local solve does not depend on the contact's own impulse.
module sg_nesterov
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_nesterov_rule, only: nesterov_rule_t
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_sweep_order, only: give_impulses, put_impulses, sweep_order_t
  use sg_sweep_solid_order, only: impulses_of_row
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: nesterov_t

  !> The last iterates of one order, as it stores impulses: results of the sweep before, and what the last sweep started from
  type :: iterates_t
    real(wp), allocatable :: before(:), start(:)
    !> State of the order that they belong to
    integer :: serial = -1
  end type iterates_t

  !> Momentum of one solve
  type :: nesterov_t
    !> Do sweeps take it?
    logical :: is_on = .false.
    !> Has a sweep begun? And the rule that gives the share
    logical, private :: has_begun = .false.
    type(nesterov_rule_t), private :: rule
    !> Is the start of the last sweep held, and were the sums of the last pass made with one?
    logical, private :: has_start = .false., has_sums = .false.
    !> Square of a sweep's change x - y, and its product with the change of x from sweep to sweep
    real(wp), private :: sums(2) = 0
    !> Iterates of each order, and velocities of x before the last sweep, shape (components, bodies)
    type(iterates_t), allocatable, private :: past(:)
    real(wp), allocatable, private :: velocity(:, :)
    !> Impulses of the sweep before, by contact, while orders change
    real(wp), allocatable, private :: carried(:, :)
  contains
    procedure :: begin => nesterov_begin
    procedure :: go_on => nesterov_go_on
    procedure :: restore => nesterov_restore
    procedure :: rest => nesterov_rest
    procedure :: carry => nesterov_carry
    procedure :: is_moving => nesterov_is_moving
    procedure :: resume => nesterov_resume
    procedure :: list_tables => nesterov_list_tables
  end type nesterov_t

contains

  !> Begin a solve, without a past.
  pure subroutine nesterov_begin(self, is_on)
    class(nesterov_t), intent(inout) :: self
    logical, intent(in) :: is_on !! do sweeps take momentum?

    self%is_on = is_on
    self%has_begun = .false.
    self%rule = nesterov_rule_t()
    self%has_start = .false.
    self%has_sums = .false.
  end subroutine nesterov_begin

  !> Pause, since the error of the tests does not fall: plain sweeps have their turn.
  pure subroutine nesterov_rest(self)
    class(nesterov_t), intent(inout) :: self

    call self%rule%rest()
  end subroutine nesterov_rest

  !> Let impulses and velocities go on before a sweep: x becomes y.
  subroutine nesterov_go_on(self, orders, problem, comm)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    type(problem_t), intent(inout) :: problem !! its velocities are those of the impulses in the orders
    type(comm_t), intent(inout) :: comm !! the ranks, which take the same share
    real(wp) :: share
    integer :: s, width

    width = first_inverse(problem%kind) - 1
    if (.not. self%has_begun) call begin_past(self, orders, problem%body(:width, :))
    share = 0
    call comm%sum(self%sums)
    if (self%has_begun) call self%rule%next(self%sums, self%has_sums, share)
    self%has_begun = .true.
    self%sums = 0
    do s = 1, size(orders)
      call step_order(orders(s), share, self%past(s), self%sums)
    end do
    self%has_sums = self%has_start
    self%has_start = .true.
    call step_bodies(width, problem%n_bodies, size(problem%body, 1), share, self%velocity, problem%body)
  end subroutine nesterov_go_on

  !> Take the present impulses and velocities for those of the sweep before.
  subroutine begin_past(self, orders, velocity)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(in) :: orders(:)
    real(wp), intent(in) :: velocity(:, :)
    integer :: s

    if (allocated(self%past)) then
      if (size(self%past) /= size(orders)) deallocate (self%past)
    end if
    if (.not. allocated(self%past)) allocate (self%past(size(orders)))
    do s = 1, size(orders)
      call hold(orders(s), self%past(s))
    end do
    self%velocity = velocity
  end subroutine begin_past

  !> Hold the impulses of an order as those of the sweep before.
  subroutine hold(order, past)
    type(sweep_order_t), intent(in) :: order
    type(iterates_t), intent(inout) :: past
    integer :: n, row

    n = stored(order)
    past%serial = order%serial
    if (allocated(past%before)) then
      if (size(past%before) < n) deallocate (past%before, past%start)
    end if
    if (.not. allocated(past%before)) allocate (past%before(n + n/8), past%start(n + n/8), source=0.0_wp)
    if (order%n_groups > 0) then
      call copy(n, order%lane_impulse, past%before)
    else if (order%solids%n_groups > 0) then
      do row = 1, order%solids%n_rows
        call copy(impulses_of_row, order%solids%row(1, 1, row), past%before((row - 1)*impulses_of_row + 1))
      end do
    else if (n > 0) then
      call copy(n, order%impulse, past%before)
    end if
  end subroutine hold

  !> Reals that the impulses of an order take where it keeps them.
  pure integer function stored(order)
    type(sweep_order_t), intent(in) :: order

    if (order%n_groups > 0) then
      stored = size(order%lane_impulse(:, :, 1))*order%n_groups
    else if (order%solids%n_groups > 0) then
      stored = impulses_of_row*order%solids%n_rows
    else
      stored = 0
      if (order%n > 0) stored = size(order%impulse, 1)*order%n
    end if
  end function stored

  !> Copy reals.
  pure subroutine copy(n, from, to)
    integer, intent(in) :: n
    real(wp), intent(in) :: from(n)
    real(wp), intent(inout) :: to(n)

    to = from
  end subroutine copy

  !> Exchange reals.
  pure subroutine exchange(n, one, other)
    integer, intent(in) :: n
    real(wp), intent(inout) :: one(n), other(n)
    real(wp) :: kept
    integer :: i

    do i = 1, n
      kept = one(i)
      one(i) = other(i)
      other(i) = kept
    end do
  end subroutine exchange

  !> Exchange the impulses of an order with those of the sweep before.
  subroutine exchange_order(order, past)
    type(sweep_order_t), intent(inout) :: order
    type(iterates_t), intent(inout) :: past
    integer :: row

    if (order%n_groups > 0) then
      call exchange(stored(order), order%lane_impulse, past%before)
    else if (order%solids%n_groups > 0) then
      do row = 1, order%solids%n_rows
        call exchange(impulses_of_row, order%solids%row(1, 1, row), past%before((row - 1)*impulses_of_row + 1))
      end do
    else if (order%n > 0) then
      call exchange(stored(order), order%impulse, past%before)
    end if
  end subroutine exchange_order

  !> Let the impulses of an order go on.
  subroutine step_order(order, share, past, sums)
    type(sweep_order_t), intent(inout) :: order
    real(wp), intent(in) :: share
    type(iterates_t), intent(inout) :: past
    real(wp), intent(inout) :: sums(2)
    integer :: row, first

    if (order%n_groups > 0) then
      call step(stored(order), share, order%lane_impulse, past%before, past%start, sums)
    else if (order%solids%n_groups > 0) then
      do row = 1, order%solids%n_rows
        first = (row - 1)*impulses_of_row + 1
        call step(impulses_of_row, share, order%solids%row(1, 1, row), past%before(first), past%start(first), sums)
      end do
    else if (order%n > 0) then
      call step(stored(order), share, order%impulse, past%before, past%start, sums)
    end if
  end subroutine step_order

  !> One pass over the iterates: sums of g = x - y and d = x - x_before, then y = x + share d. Four sums each, since one alone
  !! waits for itself.
  pure subroutine step(n, share, x, before, start, sums)
    integer, intent(in) :: n !! reals
    real(wp), intent(in) :: share !! of the change to go on by
    real(wp), intent(inout) :: x(n) !! result of the last sweep, then the start of the next
    real(wp), intent(inout) :: before(n) !! result of the sweep before, then of the last
    real(wp), intent(inout) :: start(n) !! start of the last sweep, then of the next
    real(wp), intent(inout) :: sums(2) !! sums of g^2 and g d grow
    real(wp) :: g(4), d(4), gg(4), gd(4)
    integer :: i, last

    gg = 0
    gd = 0
    last = n - modulo(n, 4)
    do i = 1, last, 4
      g = x(i:i + 3) - start(i:i + 3)
      d = x(i:i + 3) - before(i:i + 3)
      gg = gg + g*g
      gd = gd + g*d
      before(i:i + 3) = x(i:i + 3)
      x(i:i + 3) = x(i:i + 3) + share*d
      start(i:i + 3) = x(i:i + 3)
    end do
    sums = sums + [sum(gg), sum(gd)]
    do i = last + 1, n
      g(1) = x(i) - start(i)
      d(1) = x(i) - before(i)
      sums = sums + [g(1)*g(1), g(1)*d(1)]
      before(i) = x(i)
      x(i) = x(i) + share*d(1)
      start(i) = x(i)
    end do
  end subroutine step

  !> Let the velocities of bodies go on.
  pure subroutine step_bodies(width, n, length, share, before, body)
    integer, intent(in) :: width, n, length !! components of a velocity, bodies, reals of a body's record
    real(wp), intent(in) :: share !! of the change to go on by
    real(wp), intent(inout) :: before(width, n) !! velocities of the sweep before, then of the last
    real(wp), intent(inout) :: body(length, n) !! velocities come first
    real(wp) :: v
    integer :: b, i

    do b = 1, n
      do i = 1, width
        v = body(i, b)
        body(i, b) = v + share*(v - before(i, b))
        before(i, b) = v
      end do
    end do
  end subroutine step_bodies

  !> Take the last step back: y becomes x again, where a round has begun that is not wanted.
  subroutine nesterov_restore(self, orders, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    type(problem_t), intent(inout) :: problem !! its velocities become those of x
    integer :: s

    do s = 1, size(orders)
      call exchange_order(orders(s), self%past(s))
    end do
    problem%body(:size(self%velocity, 1), :) = self%velocity
    call self%begin(self%is_on)
  end subroutine nesterov_restore

  !> Write down by contact what the sweep before left, since the orders are about to change.
  subroutine nesterov_carry(self, orders, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    type(problem_t), intent(inout) :: problem !! its impulses are those in the orders, and come back so
    integer :: s

    if (.not. self%has_begun) return
    do s = 1, size(orders)
      call exchange_order(orders(s), self%past(s))
      call give_impulses(orders(s), problem)
      call exchange_order(orders(s), self%past(s))
    end do
    self%carried = problem%impulse(:, :problem%n_contacts)
    do s = 1, size(orders)
      call give_impulses(orders(s), problem)
    end do
  end subroutine nesterov_carry

  !> Which contacts carried an impulse one sweep ago? They stay in the orders, since velocities go on by the change of theirs.
  pure function nesterov_is_moving(self, n) result(is_moving)
    class(nesterov_t), intent(in) :: self
    integer, intent(in) :: n !! contacts
    logical :: is_moving(n)

    is_moving = .false.
    if (self%has_begun) is_moving = any(abs(self%carried) > 0, 1)
  end function nesterov_is_moving

  !> Give changed orders what the sweep before left. The bodies of contacts that have left the orders with a change, those of
  !! solved clusters, stay where they are.
  subroutine nesterov_resume(self, orders, is_ordered, problem)
    class(nesterov_t), intent(inout) :: self
    type(sweep_order_t), intent(inout) :: orders(:) !! all contacts that are swept
    logical, intent(in) :: is_ordered(:) !! are contacts in one of the orders?
    type(problem_t), intent(inout) :: problem !! its impulses are those of the orders
    real(wp), allocatable :: now(:, :)
    integer :: s, k

    if (.not. self%has_begun) return
    if (all(orders%serial == self%past%serial)) return
    do k = 1, problem%n_contacts
      if (is_ordered(k)) cycle
      if (.not. any(abs(problem%impulse(:, k) - self%carried(:, k)) > 0)) cycle
      associate (width => size(self%velocity, 1))
        self%velocity(:, problem%pair(:, k)) = problem%body(:width, problem%pair(:, k))
      end associate
    end do
    now = problem%impulse(:, :problem%n_contacts)
    do s = 1, size(orders)
      problem%impulse(:, :problem%n_contacts) = self%carried
      call put_impulses(orders(s), problem)
      call hold(orders(s), self%past(s))
      problem%impulse(:, :problem%n_contacts) = now
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
    if (allocated(self%past)) then
      do s = 1, size(self%past)
        call tables%note('before', self%past(s)%before)
        call tables%note('start', self%past(s)%start)
      end do
    end if
    call tables%begin('nesterov', per_body)
    call tables%note('velocity', self%velocity)
  end subroutine nesterov_list_tables
end module sg_nesterov
