!> Tests of one solve so far: e8 against sweeps, the error of the impulses estimated from them (doc/theory/errors.md), and the sweep
!! at which the next test pays.
!!
!! e8 is about what one more plain sweep would change. A sweep that goes on by a share b of the last change is worth
!! (1 + b)/(1 - b) plain ones at the most: what a solve adds to its guess is estimated by these.
module sg_check_history
  use sg_ascending, only: first_at_least
  use sg_kinds, only: wp
  use sg_lists, only: reserve
  implicit none
  private
  public :: check_history_t

  !> Sweeps before the first test, and fewest between two tests; least and largest gap between two tests over the sweeps done
  integer, parameter :: first_gap = 14, fewest_between = 7
  real(wp), parameter :: least_gap = 0.125_wp, largest_gap = 1
  !> Fewest plain sweeps that an error is taken to fall in: fewer carry no information, however often they are tested
  real(wp), parameter :: fewest = 100
  !> Where e8 does not fall at all, it is taken to fall in this many times the sweeps done
  real(wp), parameter :: standstill = 100

  !> The tests, in order
  type :: check_history_t
    !> Number of tests, and of each: sweeps done, plain sweeps that they are worth, and e8
    integer :: n = 0
    integer, allocatable, private :: sweeps(:)
    real(wp), allocatable, private :: worth(:), e8(:)
  contains
    procedure :: add => history_add
    procedure :: estimate => history_estimate
    procedure :: has_not_fallen => history_has_not_fallen
    procedure :: next_test => history_next_test
  end type check_history_t

contains

  !> Add a test.
  subroutine history_add(self, sweeps, worth, e8)
    class(check_history_t), intent(inout) :: self
    integer, intent(in) :: sweeps !! done
    real(wp), intent(in) :: worth !! plain sweeps that these are worth
    real(wp), intent(in) :: e8 !! measured

    self%n = self%n + 1
    call reserve(self%sweeps, self%n)
    call reserve(self%worth, self%n)
    call reserve(self%e8, self%n)
    self%sweeps(self%n) = sweeps
    self%worth(self%n) = worth
    self%e8(self%n) = e8
  end subroutine history_add

  !> Error of the impulses, estimated from e8 and the rate at which it falls.
  !!
  !! Where e8 falls by the factor s per plain sweep, all sweeps to come change e8/(1 - s): on tall packings thousands of times more.
  !! The rate is taken over the last half of the sweeps. It is never taken for faster than one over the sweeps done, nor than one
  !! over `fewest`: the fall after a cold start is that of the grains' neighbourhoods, not of the whole. Sweeps with momentum count
  !! as the plain ones that they are worth, as far as this solve has changed the impulses.
  pure real(wp) function history_estimate(self, change) result(estimate)
    class(check_history_t), intent(in) :: self
    real(wp), intent(in) :: change !! what the solve has changed the impulses by, over them
    integer :: base

    base = last_until(self, self%sweeps(self%n)/2)
    associate (n => self%n)
      estimate = self%e8(n)*max(fewest, to_fall(self, base, real(self%sweeps([max(1, base), n]), wp)), &
                                change*to_fall(self, base, self%worth([max(1, base), n])))
    end associate
  end function history_estimate

  !> Sweeps, or plain sweeps that they are worth, in which e8 falls by e, by its fall since an earlier test.
  pure real(wp) function to_fall(self, base, done)
    type(check_history_t), intent(in) :: self
    integer, intent(in) :: base !! the earlier test; 0 where there is none
    real(wp), intent(in) :: done(2) !! sweeps of the earlier and of the last test

    to_fall = done(2)
    if (base == 0 .or. .not. self%e8(self%n) > 0) return
    if (self%e8(base) > self%e8(self%n)) then
      to_fall = max(to_fall, (done(2) - done(1))/log(self%e8(base)/self%e8(self%n)))
    else
      to_fall = standstill*max(fewest, to_fall)
    end if
  end function to_fall

  !> The last test until a number of sweeps; 0 where there is none.
  pure integer function last_until(self, sweeps)
    class(check_history_t), intent(in) :: self
    integer, intent(in) :: sweeps

    last_until = first_at_least(self%sweeps(:self%n), sweeps + 1) - 1
  end function last_until

  !> Is e8 no less than at the last test that lies some sweeps back?
  pure logical function history_has_not_fallen(self, gap) result(has_not)
    class(check_history_t), intent(in) :: self
    integer, intent(in) :: gap !! sweeps
    integer :: base

    has_not = .false.
    if (self%n == 0) return
    base = last_until(self, self%sweeps(self%n) - gap)
    if (base > 0) has_not = .not. self%e8(self%n) < self%e8(base)
  end function history_has_not_fallen

  !> Sweeps at which the excess is expected to fall to 1, by its fall between the last two tests, after the first as the square of
  !! sweeps: at least an eighth of the sweeps done from now, so that tests take a bounded share of the time, and before the sweeps
  !! have doubled.
  pure integer function history_next_test(self, excess, before) result(next)
    class(check_history_t), intent(in) :: self
    real(wp), intent(in) :: excess, before !! criterion over tolerance at the last test, and at the one before
    real(wp) :: gap, done

    next = first_gap
    if (self%n == 0) return
    done = real(self%sweeps(self%n), wp)
    gap = huge(gap)
    if (excess > 1 .and. self%n == 1) then
      gap = done*(sqrt(excess) - 1)
    else if (excess > 1 .and. before > excess) then
      gap = (done - real(self%sweeps(self%n - 1), wp))*log(excess)/log(before/excess)
    end if
    next = self%sweeps(self%n) + ceiling(max(real(fewest_between, wp), least_gap*done, min(largest_gap*done, gap)))
  end function history_next_test
end module sg_check_history
