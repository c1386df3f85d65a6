!> Last iterates of sweeps with momentum, as an order stores impulses, and the pass over them (doc/theory/nesterov.md).
!!
!! x is what a sweep leaves, y what it starts from. Solids side by side need no pass where a round is one sweep: their impulses lie
!! far apart, and the sweep over them does what the pass would do.
module sg_iterates
  use sg_kinds, only: wp
  use sg_lists, only: copy_reals
  use sg_sweep_order, only: sweep_order_t
  use sg_sweep_solid_order, only: impulses_of_row, lanes, row_length
  implicit none
  private
  public :: iterates_t, hold, exchange_order, step_order, takes_momentum

  !> Reals of impulses that a pass takes at once: those of a row of solids
  integer, parameter :: run = impulses_of_row

  !> The last iterates of one order
  type :: iterates_t
    !> Results of the sweep before; and what the last sweep started from, where passes need it
    real(wp), allocatable :: before(:), start(:)
    !> State of the order that they belong to
    integer :: serial = -1
    !> Share of its last change by which the next sweep starts further
    real(wp) :: share = 0
    !> Sums over the last sweep: of g^2 and g d, g = x - y, d = x - x_before
    real(wp) :: sums(2) = 0
  end type iterates_t

contains

  !> Hold the impulses of an order as those of the sweep before.
  subroutine hold(order, past)
    type(sweep_order_t), intent(in) :: order !! order that holds them
    type(iterates_t), intent(inout) :: past !! iterates to begin with
    integer :: n, row

    n = stored(order)
    past%serial = order%serial
    call fit(n, past%before)
    if (order%lanes%n_groups > 0) then
      call copy_reals(n, order%lanes%impulse, past%before)
    else if (order%solids%n_groups > 0) then
      do row = 1, order%solids%n_rows
        call copy_reals(impulses_of_row, order%solids%row(1, 1, row), past%before((row - 1)*impulses_of_row + 1))
      end do
    else if (n > 0) then
      call copy_reals(n, order%impulse, past%before)
    end if
  end subroutine hold

  !> Room for so many reals.
  pure subroutine fit(n, reals)
    integer, intent(in) :: n
    real(wp), allocatable, intent(inout) :: reals(:)

    if (allocated(reals)) then
      if (size(reals) < n) deallocate (reals)
    end if
    if (.not. allocated(reals)) allocate (reals(n + n/8), source=0.0_wp)
  end subroutine fit

  !> Reals that the impulses of an order take where it keeps them.
  pure integer function stored(order)
    type(sweep_order_t), intent(in) :: order

    if (order%lanes%n_groups > 0) then
      stored = lanes*size(order%lanes%impulse, 2)*order%lanes%n_groups
    else if (order%solids%n_groups > 0) then
      stored = run*order%solids%n_rows
    else
      stored = 0
      if (order%n > 0) stored = size(order%impulse, 1)*order%n
    end if
  end function stored

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
    type(sweep_order_t), intent(inout) :: order !! its impulses
    type(iterates_t), intent(inout) :: past !! those of the sweep before
    integer :: row

    if (order%lanes%n_groups > 0) then
      call exchange(stored(order), order%lanes%impulse, past%before)
    else if (order%solids%n_groups > 0) then
      do row = 1, order%solids%n_rows
        call exchange(impulses_of_row, order%solids%row(1, 1, row), past%before((row - 1)*impulses_of_row + 1))
      end do
    else if (order%n > 0) then
      call exchange(stored(order), order%impulse, past%before)
    end if
  end subroutine exchange_order

  !> Does the sweep over an order take momentum itself? That over solids side by side does.
  pure logical function takes_momentum(order)
    type(sweep_order_t), intent(in) :: order !! order

    takes_momentum = order%solids%n_groups > 0
  end function takes_momentum

  !> Let all impulses of an order go on by `share` of their last change, and sum what the last sweep has done.
  subroutine step_order(order, past)
    type(sweep_order_t), intent(inout) :: order !! its impulses become those of y
    type(iterates_t), intent(inout) :: past !! its iterates
    integer :: n

    past%sums = 0
    n = stored(order)
    call fit(n, past%start)
    if (order%lanes%n_groups > 0) then
      call step(n, run, past%share, order%lanes%impulse, past%before, past%start, past%sums)
    else if (order%solids%n_groups > 0) then
      call step(n, lanes*row_length, past%share, order%solids%row, past%before, past%start, past%sums)
    else if (n > 0) then
      call step(n, run, past%share, order%impulse, past%before, past%start, past%sums)
    end if
  end subroutine step_order

  !> One pass over the iterates: sums of g = x - y and d = x - x_before, then y = x + share d. As many sums as reals of a run, which
  !! vector registers take side by side.
  pure subroutine step(n, stride, share, x, before, start, sums)
    integer, intent(in) :: n !! reals
    integer, intent(in) :: stride !! reals from the begin of a run of them to the next in x
    real(wp), intent(in) :: share !! of the change to go on by
    real(wp), intent(inout) :: x(stride, *) !! result of the last sweep, then the start of the next
    real(wp), intent(inout) :: before(run, *) !! result of the sweep before, then of the last
    real(wp), intent(inout) :: start(run, *) !! start of the last sweep, then of the next
    real(wp), intent(inout) :: sums(2) !! sums of g^2 and g d grow
    real(wp) :: g, d, gg(run), gd(run)
    integer :: i, j

    gg = 0
    gd = 0
    do j = 1, n/run
      do i = 1, run
        g = x(i, j) - start(i, j)
        d = x(i, j) - before(i, j)
        gg(i) = gg(i) + g*g
        gd(i) = gd(i) + g*d
        before(i, j) = x(i, j)
        x(i, j) = x(i, j) + share*d
        start(i, j) = x(i, j)
      end do
    end do
    j = n/run + 1
    do i = 1, modulo(n, run)
      g = x(i, j) - start(i, j)
      d = x(i, j) - before(i, j)
      gg(i) = gg(i) + g*g
      gd(i) = gd(i) + g*d
      before(i, j) = x(i, j)
      x(i, j) = x(i, j) + share*d
      start(i, j) = x(i, j)
    end do
    sums = sums + [sum(gg), sum(gd)]
  end subroutine step
end module sg_iterates
