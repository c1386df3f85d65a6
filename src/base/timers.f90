!> Stopwatches as objects: CPU and wall seconds of one phase of a run.
module sg_timers
  use, intrinsic :: iso_c_binding, only: c_double
  use sg_kinds, only: wp, i8
  implicit none
  private
  public :: timer_t, wall_now, idle_now, cpu_now

  !> One stopwatch: start and stop it as often as wanted
  type :: timer_t
    !> CPU seconds and wall seconds gathered
    real(wp) :: cpu = 0, wall = 0
    real(wp), private :: cpu_start = 0, wall_start = 0
  contains
    procedure :: start => timer_start
    procedure :: stop => timer_stop
    procedure :: add => timer_add
    procedure :: hand_over => timer_hand_over
  end type timer_t

  interface
    function c_elsewhere() bind(c, name='splitgrain_elsewhere') result(seconds)
      import :: c_double
      real(c_double) :: seconds
    end function c_elsewhere
  end interface

contains

  !> Start or go on.
  subroutine timer_start(self)
    class(timer_t), intent(inout) :: self

    self%cpu_start = cpu_now()
    self%wall_start = wall_now()
  end subroutine timer_start

  !> Stop, adding the time since the start.
  subroutine timer_stop(self)
    class(timer_t), intent(inout) :: self

    self%cpu = self%cpu + cpu_now() - self%cpu_start
    self%wall = self%wall + wall_now() - self%wall_start
  end subroutine timer_stop

  !> Add what another one has gathered.
  pure subroutine timer_add(self, other)
    class(timer_t), intent(inout) :: self
    type(timer_t), intent(in) :: other !! gathered elsewhere

    self%cpu = self%cpu + other%cpu
    self%wall = self%wall + other%wall
  end subroutine timer_add

  !> Give a part of what was gathered to another one.
  pure subroutine timer_hand_over(self, part, other)
    class(timer_t), intent(inout) :: self
    type(timer_t), intent(in) :: part !! gathered within the time of this one
    type(timer_t), intent(inout) :: other !! gets it

    self%cpu = self%cpu - part%cpu
    self%wall = self%wall - part%wall
    call other%add(part)
  end subroutine timer_hand_over

  !> CPU seconds of this process; of a coroutine without those that others have used since it began (sg_coroutines).
  function cpu_now() result(seconds)
    real(wp) :: seconds

    call cpu_time(seconds)
    seconds = seconds - real(c_elsewhere(), wp)
  end function cpu_now

  !> Wall seconds without CPU seconds that other coroutines have used: what passes between two calls is work or waiting.
  real(wp) function idle_now() result(seconds)
    seconds = wall_now() - real(c_elsewhere(), wp)
  end function idle_now

  !> Wall seconds since some fixed moment.
  function wall_now() result(seconds)
    real(wp) :: seconds
    integer(i8) :: ticks, rate

    call system_clock(ticks, rate)
    seconds = real(ticks, wp)/real(rate, wp)
  end function wall_now
end module sg_timers
