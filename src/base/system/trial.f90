!> Trials: what the procedure of a library may not survive is done by a child process first, whose memory is a copy of this one's.
!!
!!     trial = begin_trial()
!!     if (is_in(trial)) then
!!       ... the calls that may crash ...
!!       call end_trial()
!!     end if
!!     if (is_survived(trial)) ... the same calls ...
module sg_trial
  use, intrinsic :: iso_c_binding, only: c_funptr, c_int, c_intptr_t
  use sg_c_library, only: c_exit_now, c_signal
  implicit none
  private
  public :: begin_trial, end_trial, is_in, is_survived

  !> SIGILL, SIGABRT, SIGBUS, SIGFPE, SIGSEGV: what a crash ends with
  integer(c_int), parameter :: crashes(5) = [4_c_int, 6_c_int, 7_c_int, 8_c_int, 11_c_int]

  interface
    function c_fork() bind(c, name='fork') result(process)
      import :: c_int
      integer(c_int) :: process
    end function c_fork
    function c_waitpid(process, status, options) bind(c, name='waitpid') result(ended)
      import :: c_int
      integer(c_int), value :: process, options
      integer(c_int), intent(out) :: status
      integer(c_int) :: ended
    end function c_waitpid
  end interface

contains

  !> Begin a trial: from here on there are two processes, and one of them is in the trial.
  integer function begin_trial() result(trial)
    type(c_funptr) :: before
    integer :: i

    trial = int(c_fork())
    if (.not. is_in(trial)) return
    ! A crash of the child is no news: by default, address 0, it ends without a word.
    do i = 1, size(crashes)
      before = c_signal(crashes(i), transfer(0_c_intptr_t, before))
    end do
  end function begin_trial

  !> Is this the process that is in the trial?
  pure logical function is_in(trial)
    integer, intent(in) :: trial !! what `begin_trial` gave

    is_in = trial == 0
  end function is_in

  !> End the process that is in the trial, which has survived.
  subroutine end_trial()
    call c_exit_now(0_c_int)
  end subroutine end_trial

  !> Wait for the end of a trial: was it that of `end_trial`? Where the system allows no child there was no trial, and this is true.
  logical function is_survived(trial)
    integer, intent(in) :: trial !! what `begin_trial` gave
    integer(c_int) :: ended, status

    is_survived = .true.
    if (trial < 0) return
    ended = c_waitpid(int(trial, c_int), status, 0_c_int)
    if (ended == trial) is_survived = status == 0
  end function is_survived
end module sg_trial
