!> A timer of the system that ends the program while there is nothing to save: before the first step of a run.
module sg_alarm
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_long, c_size_t, c_char, c_new_line, c_funptr, c_funloc
  use sg_c_library, only: c_exit_now, c_signal, c_write
  use sg_error, only: exit_stopped
  use sg_kinds, only: wp
  implicit none
  private
  public :: end_after

  integer(c_int), parameter :: sigalrm = 14

  !> A timer: seconds and microseconds between two signals, and until the first
  type, bind(c) :: itimer_t
    integer(c_long) :: interval(2) = 0, first(2) = 0
  end type itimer_t

  interface
    function c_setitimer(which, timer, before) bind(c, name='setitimer') result(status)
      import :: c_int, itimer_t
      integer(c_int), value :: which
      type(itimer_t), intent(in) :: timer
      type(itimer_t), intent(out) :: before
      integer(c_int) :: status
    end function c_setitimer
  end interface

contains

  !> End the program after some time, wherever it is, with the exit code of a stopped run; 0 takes that back.
  subroutine end_after(seconds)
    real(wp), intent(in) :: seconds !! wall time from now [s]
    type(itimer_t) :: timer, before_timer
    type(c_funptr) :: before
    integer(c_int) :: status

    before = c_signal(sigalrm, c_funloc(on_alarm))
    timer%first(1) = int(seconds, c_long)
    timer%first(2) = int(1e6_wp*(seconds - real(timer%first(1), wp)), c_long)
    ! A timer of 0 would never ring.
    if (seconds > 0 .and. all(timer%first == 0)) timer%first(2) = 1
    ! The first 0 names the timer that counts the time of the clock.
    status = c_setitimer(0_c_int, timer, before_timer)
  end subroutine end_after

  ! Nothing but calls that a signal handler may make.
  subroutine on_alarm(number) bind(c)
    integer(c_int), value :: number
    character(kind=c_char, len=*), parameter :: &
      text = 'error: stopped by the walltime before the first step; there is no checkpoint'
    integer(c_intptr_t) :: written

    if (number == sigalrm) written = c_write(2_c_int, text//c_new_line, len(text, c_size_t) + 1_c_size_t)
    call c_exit_now(int(exit_stopped, c_int))
  end subroutine on_alarm
end module sg_alarm
