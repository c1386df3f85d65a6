!> Limit of wall time from the command line: seconds, [days-]hours:minutes:seconds, or the end of the batch job.
module sg_walltime
  use, intrinsic :: iso_c_binding, only: c_int64_t, c_ptr, c_null_ptr
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_numerals, only: read_real
  implicit none
  private
  public :: read_walltime, seconds_of_job

  !> Part of the time of a job that is left for the last step, its files and the launcher, and the most that is left [s]
  real(wp), parameter :: kept_share = 0.1_wp, kept_most = 120.0_wp
  !> Largest number before the first colon: more than any job lasts
  integer, parameter :: largest_part = 999999

  interface
    !> Seconds since 1970
    function c_time(none) bind(c, name='time') result(seconds)
      import :: c_int64_t, c_ptr
      type(c_ptr), value :: none
      integer(c_int64_t) :: seconds
    end function c_time
  end interface

contains

  !> Seconds from a word: a number of them, `H:M:S`, `M:S`, `D-H:M:S`, or `job` for what the batch job leaves.
  subroutine read_walltime(word, seconds, error)
    character(len=*), intent(in) :: word !! value of `--walltime`
    real(wp), intent(out) :: seconds !! [s], at least zero
    type(error_t), allocatable, intent(out) :: error !! set when it is no duration, or there is no job
    logical :: is_valid

    if (word == 'job') then
      call seconds_of_job(variable('SLURM_JOB_END_TIME'), variable('PBS_WALLTIME')//variable('OAR_JOB_WALLTIME_SECONDS'), &
                          real(c_time(c_null_ptr), wp), seconds, is_valid)
      if (.not. is_valid) call fail(error, 'option --walltime=job: this is no batch job whose end is set: none of '// &
                                    'SLURM_JOB_END_TIME, PBS_WALLTIME and OAR_JOB_WALLTIME_SECONDS is')
      return
    end if
    if (scan(word, ':') > 0) then
      call read_clock(word, seconds, is_valid)
    else
      call read_real(word, seconds, is_valid)
    end if
    if (is_valid) is_valid = seconds >= 0 .and. seconds <= huge(1)
    if (.not. is_valid) &
      call fail(error, 'option --walltime needs a number of at least 0 and at most 2147483647, in seconds, or '// &
                '[days-]hours:minutes:seconds, or job, not "'//word//'"')
  end subroutine read_walltime

  !> Seconds that a run may take in a batch job: a tenth of them, at most two minutes, is left.
  subroutine seconds_of_job(end_time, duration, now, seconds, is_valid)
    character(len=*), intent(in) :: end_time !! end of the job [s since 1970], empty when unknown
    character(len=*), intent(in) :: duration !! length of the job, which begins now [s], empty when unknown
    real(wp), intent(in) :: now !! present time [s since 1970]
    real(wp), intent(out) :: seconds !! [s]
    logical, intent(out) :: is_valid !! is one of the two set?

    call read_real(end_time, seconds, is_valid)
    if (is_valid) then
      seconds = seconds - now
    else
      call read_real(duration, seconds, is_valid)
    end if
    ! Zero would be no limit at all.
    if (is_valid) seconds = max(seconds - min(kept_most, kept_share*seconds), 1.0_wp)
  end subroutine seconds_of_job

  !> Seconds from [days-][hours:]minutes:seconds.
  pure subroutine read_clock(word, seconds, is_valid)
    character(len=*), intent(in) :: word
    real(wp), intent(out) :: seconds
    logical, intent(out) :: is_valid
    integer :: first, colon, value, n

    seconds = 0
    n = 0
    first = index(word, '-') + 1
    is_valid = first /= 2
    if (is_valid .and. first > 2) call read_part(word(:first - 2), largest_part, value, is_valid)
    if (is_valid .and. first > 2) seconds = 24.0_wp*real(value, wp)
    do while (is_valid .and. first <= len(word) + 1)
      colon = index(word(first:)//':', ':')
      ! Minutes and seconds after a colon are below 60; what stands first may be any number.
      call read_part(word(first:first + colon - 2), merge(59, largest_part, n > 0), value, is_valid)
      seconds = merge(seconds, 60*seconds, n == 0) + real(value, wp)
      n = n + 1
      first = first + colon
    end do
    is_valid = is_valid .and. (n == 3 .or. (n == 2 .and. index(word, '-') == 0))
  end subroutine read_clock

  !> A whole number without a sign, at most so large.
  pure subroutine read_part(word, most, value, is_valid)
    character(len=*), intent(in) :: word
    integer, intent(in) :: most
    integer, intent(out) :: value
    logical, intent(out) :: is_valid

    value = 0
    is_valid = len(word) > 0 .and. len(word) < 10 .and. verify(word, '0123456789') == 0
    if (is_valid) read (word, *) value
    is_valid = is_valid .and. value <= most
  end subroutine read_part

  !> Value of an environment variable, empty when it is not set.
  function variable(name) result(value)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: value
    character(len=64) :: buffer
    integer :: length, status

    call get_environment_variable(name, buffer, length, status)
    value = ''
    if (status == 0) value = buffer(:length)
  end function variable
end module sg_walltime
