!> Share of their last change by which sweeps with momentum go on: Nesterov's sequence [Nesterov1983] with restarts
!! [ODonoghueCandes2015] (doc/theory/nesterov.md).
!!
!! x_k is the result of sweep k, y_k what it started from, g = x_k - y_k, d = x_k - x_(k-1). The next sweep starts from
!! y_(k+1) = x_k + b d.
module sg_nesterov_rule
  use sg_kinds, only: wp
  implicit none
  private
  public :: nesterov_rule_t

  !> Growth of |g|, over the least since the last restart, that restarts: a contact has changed its status, or rounds overshoot.
  !! Where momentum is the sum of many sweeps' changes, it may be a tenth of their number, and at most the last of these
  real(wp), parameter :: least_growth = 1.1_wp, growth_per_change = 0.1_wp, largest_growth = 2
  !> Largest share: max(0.85, 1 - (20/sweeps)^2). One near 1 after few sweeps drives slow modes beyond their goal, which e8 hardly
  !! shows; after some hundred the sequence alone decides
  real(wp), parameter :: most_share = 0.85_wp, sweeps_to_one = 20
  !> Sweeps of the first pause; each one is twice as long as the one before
  integer, parameter :: first_pause = 40, longest_pause = 2**24

  !> Where the sequence stands
  type :: nesterov_rule_t
    private
    !> Sweeps so far, those of the next pause, and those at which the present one ends
    integer :: sweeps = 0, pause = first_pause, end_of_pause = 0
    !> Nesterov's t, and the least square of a sweep's change since the last restart
    real(wp) :: t = 1, least = huge(1.0_wp)
    !> Plain sweeps that those so far are worth beyond their number: (1 + b)/(1 - b) - 1 each
    real(wp), public :: gain = 0
  contains
    procedure :: begin => rule_begin
    procedure :: next => rule_next
    procedure :: rest => rule_rest
    procedure :: is_resting => rule_is_resting
  end type nesterov_rule_t

contains

  !> Begin with some plain sweeps. The sequence goes on meanwhile: they save the passes over iterates alone.
  pure subroutine rule_begin(self, sweeps)
    class(nesterov_rule_t), intent(inout) :: self
    integer, intent(in) :: sweeps !! to begin with
    integer :: k

    self%sweeps = 0
    self%pause = first_pause
    self%end_of_pause = sweeps
    self%least = huge(self%least)
    self%gain = 0
    self%t = 1
    do k = 1, sweeps
      self%t = following(self%t)
    end do
  end subroutine rule_begin

  !> The number after t in Nesterov's sequence.
  pure real(wp) function following(t)
    real(wp), intent(in) :: t

    following = (1 + sqrt(1 + 4*t**2))/2
  end function following

  !> The share by which the sweep after the last one starts further.
  pure subroutine rule_next(self, sums, has_sums, share)
    class(nesterov_rule_t), intent(inout) :: self
    real(wp), intent(in) :: sums(2) !! sum of the squares of g, and of the products of g with d
    logical, intent(in) :: has_sums !! are these sums known? Where they are not, the sequence goes on without a test
    real(wp), intent(out) :: share !! b, at least 0 and below 1
    real(wp) :: last

    self%sweeps = self%sweeps + 1
    share = 0
    if (self%sweeps <= self%end_of_pause) return
    if (has_sums .and. must_restart(self%least, sums)) then
      self%t = 1
      self%least = huge(self%least)
      return
    end if
    if (has_sums) self%least = min(self%least, sums(1))
    last = self%t
    self%t = following(last)
    share = min((last - 1)/self%t, max(most_share, 1 - (sweeps_to_one/real(self%sweeps, wp))**2))
    self%gain = self%gain + 2*share/(1 - share)
  end subroutine rule_next

  !> Has the change of a sweep grown by too much, or does it point back?
  pure logical function must_restart(least, sums)
    real(wp), intent(in) :: least, sums(2)
    real(wp) :: most

    most = least_growth
    if (sums(1) > tiny(sums)) most = max(most, min(largest_growth, growth_per_change*sums(2)/sums(1)))
    must_restart = .not. (sums(1)/most**2 <= least .and. sums(2) >= 0)
  end function must_restart

  !> Pause, since the error does not fall: plain sweeps have their turn. Nothing changes while they have it.
  pure subroutine rule_rest(self)
    class(nesterov_rule_t), intent(inout) :: self

    if (self%sweeps < self%end_of_pause) return
    self%end_of_pause = self%sweeps + self%pause
    self%pause = min(2*self%pause, longest_pause)
    self%t = 1
    self%least = huge(self%least)
  end subroutine rule_rest

  !> Is the next sweep one of a pause?
  pure logical function rule_is_resting(self) result(is_resting)
    class(nesterov_rule_t), intent(in) :: self

    is_resting = self%sweeps < self%end_of_pause
  end function rule_is_resting
end module sg_nesterov_rule
