!> Shares of several methods in the effort of one solve: which has the next turn (doc/theory/solvers_sweeps.md).
!!
!! Sweeps with momentum have at least half of all effort, so that the answer is never later than twice their time, whatever the
!! others are worth. The other half goes to the method with the least forecast of e1. What is not ahead has a small share; methods
!! that factorise are tried at length only where sweeps stall.
module sg_method_shares
  use sg_kinds, only: wp
  implicit none
  private
  public :: shares_t, method_t, add_mark, choose_turn
  public :: nesterov, accelerated, proximal, interior, n_methods

  !> The methods
  integer, parameter :: nesterov = 1, accelerated = 2, proximal = 3, interior = 4, n_methods = 4

  !> How effort is shared
  type :: shares_t
    !> Sweeps of a turn at least, and effort of a turn over all effort so far
    integer :: sweeps = 40
    real(wp) :: length = 0.1_wp
    !> Least share of sweeps with momentum, with a margin for effort that takes longer than counted; that of each other method that
    !! is not ahead
    real(wp) :: nesterov = 0.55_wp, other = 0.025_wp
    !> Least share of accelerated sweeps where sweeps stall and no method that factorises promises half of the least e1
    real(wp) :: accelerated = 0.15_wp
    !> Sweeps stall where e1 is above `stall` of that at the part `window` of their effort
    real(wp) :: stall = 0.9_wp, window = 0.7_wp
    !> A method is far behind where its e1 is so many times that of the best
    real(wp) :: behind = 2
    !> Factorisations that must fit into that share of effort so far before a trial begins, and those of a trial, by their price
    integer :: ready = 10, trial = 60
    !> By how much a method may multiply its effort in a forecast
    real(wp) :: farthest = 4
  end type shares_t

  !> One method: its impulses without units (sweeps with momentum keep theirs), least e1, effort, that of its next turn at least,
  !! and effort and least e1 after each turn
  type :: method_t
    logical :: is_possible = .true.
    real(wp), allocatable :: r(:, :)
    real(wp) :: e1 = huge(1.0_wp), operations = 0, price = 0
    integer :: n_marks = 0
    real(wp), allocatable :: mark(:, :)
  end type method_t

contains

  !> Note how far a method has come.
  pure subroutine add_mark(method)
    type(method_t), intent(inout) :: method !! the method after a turn
    real(wp), allocatable :: longer(:, :)

    if (.not. allocated(method%mark)) allocate (method%mark(2, 64))
    if (method%n_marks == size(method%mark, 2)) then
      allocate (longer(2, 2*method%n_marks))
      longer(:, :method%n_marks) = method%mark
      call move_alloc(longer, method%mark)
    end if
    method%n_marks = method%n_marks + 1
    method%mark(:, method%n_marks) = [method%operations, method%e1]
  end subroutine add_mark

  !> The turn of a method that ended last within a part of its effort, or the first one; 0 where there is none.
  pure integer function turn_before(method, part) result(k)
    type(method_t), intent(in) :: method
    real(wp), intent(in) :: part

    do k = method%n_marks - 1, 2, -1
      if (method%mark(1, k) <= part*method%operations) exit
    end do
    k = max(k, 0)
  end function turn_before

  !> Least e1 of a method within a part of its effort.
  pure real(wp) function e1_before(method, part) result(e1)
    type(method_t), intent(in) :: method
    real(wp), intent(in) :: part
    integer :: k

    e1 = huge(e1)
    k = turn_before(method, part)
    if (k > 0) e1 = method%mark(2, k)
  end function e1_before

  !> Power of its effort as which e1 of a method has fallen since half of its effort.
  pure real(wp) function power_of(method) result(power)
    type(method_t), intent(in) :: method
    real(wp) :: from
    integer :: k

    power = 0
    k = turn_before(method, 0.5_wp)
    if (k == 0) return
    from = max(method%mark(1, k), method%operations/8)
    if (.not. method%operations > from) return
    power = log(max(method%e1, tiny(power))/max(method%mark(2, k), tiny(power)))/log(method%operations/from)
  end function power_of

  !> Least e1 of a method after some effort more, if it falls on as it has since half of its effort.
  pure real(wp) function forecast(method, more, farthest) result(e1)
    type(method_t), intent(in) :: method !! the method
    real(wp), intent(in) :: more !! effort
    real(wp), intent(in) :: farthest !! by how much effort is multiplied at most

    e1 = method%e1
    if (method%operations > 0) e1 = e1*min(farthest, 1 + more/method%operations)**power_of(method)
  end function forecast

  !> The method that has the next turn, and the effort of that turn.
  pure subroutine choose_turn(shares, methods, total, sweep_operations, next, operations)
    type(shares_t), intent(in) :: shares !! how effort is shared
    type(method_t), intent(in) :: methods(n_methods) !! the methods
    real(wp), intent(in) :: total !! effort so far
    real(wp), intent(in) :: sweep_operations !! that of a sweep
    integer, intent(out) :: next !! the method
    real(wp), intent(out) :: operations !! effort of its turn
    real(wp) :: least(n_methods), promised(n_methods)
    logical :: has_place(n_methods)
    integer :: m

    least = max(real(shares%sweeps, wp)*sweep_operations, methods%price)
    operations = max(real(shares%sweeps, wp)*sweep_operations, shares%length*total)
    ! After its turn a method must leave sweeps with momentum their share.
    has_place = methods%is_possible .and. methods(nesterov)%operations >= shares%nesterov*(total + max(operations, least))
    has_place(nesterov) = .true.
    do m = 1, n_methods
      promised(m) = forecast(methods(m), total, shares%farthest)
    end do
    next = nesterov
    m = method_on_trial(shares, methods, promised, total)
    if (m > 0) then
      if (.not. promised(m) < minval(methods%e1)/2 .and. methods(accelerated)%operations < shares%accelerated*total) m = accelerated
      if (has_place(m)) next = m
      return
    end if
    do m = nesterov + 1, n_methods
      if (.not. has_place(m) .or. methods(m)%operations + least(m) > shares%other*total) cycle
      next = m
      operations = max(least(m), shares%other*total - methods(m)%operations)
      return
    end do
    next = minloc(promised, 1, methods%is_possible)
    if (.not. has_place(next)) next = nesterov
  end subroutine choose_turn

  !> Do sweeps stall, of both kinds unless one is far behind?
  pure logical function do_stall(shares, methods)
    type(shares_t), intent(in) :: shares
    type(method_t), intent(in) :: methods(n_methods)
    real(wp) :: best
    integer :: m

    best = minval(methods(nesterov:accelerated)%e1)
    do_stall = .true.
    do m = nesterov, accelerated
      if (methods(m)%e1 > shares%behind*best) cycle
      do_stall = do_stall .and. methods(m)%e1 > shares%stall*e1_before(methods(m), shares%window)
    end do
  end function do_stall

  !> The method that factorises which is to be tried at length, or to save effort for: where sweeps stall, one that promises
  !! half of the least e1, or else that with the least effort on trial, or else the one with the least forecast; where they do not,
  !! one whose trial has begun. 0: none.
  pure integer function method_on_trial(shares, methods, promised, total) result(next)
    type(shares_t), intent(in) :: shares
    type(method_t), intent(in) :: methods(n_methods)
    real(wp), intent(in) :: promised(n_methods), total
    real(wp) :: trial, rank, least
    integer :: m
    logical :: stall

    stall = do_stall(shares, methods)
    next = 0
    least = huge(least)
    do m = proximal, interior
      associate (method => methods(m))
        trial = real(shares%trial, wp)*method%price
        if (.not. method%is_possible .or. real(shares%ready, wp)*method%price > shares%nesterov*total) cycle
        if (.not. stall .and. (method%operations <= 2*shares%other*total .or. method%operations >= trial)) cycle
        rank = promised(m)
        if (method%operations < trial) rank = method%operations/total - 1
        if (promised(m) < minval(methods%e1)/2) rank = -1
        if (rank >= least) cycle
        least = rank
        next = m
      end associate
    end do
  end function method_on_trial
end module sg_method_shares
