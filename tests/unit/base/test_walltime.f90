!> Limits of wall time: seconds, clocks with days, the end of a batch job, and the lines that a long log has.
program test_walltime
  use harness, only: tests_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_progress, only: line_interval
  use sg_walltime, only: read_walltime, seconds_of_job
  implicit none
  type(tests_t) :: t

  call test_words()
  call test_refused()
  call test_jobs()
  call test_lines_of_a_log()
  call t%finish()

contains

  !> Seconds and clocks.
  subroutine test_words()
    call is_worth('85000', 85000.0_wp)
    call is_worth('0.5', 0.5_wp)
    call is_worth('2:05', 125.0_wp)
    call is_worth('23:59:30', 86370.0_wp)
    call is_worth('100:00:00', 360000.0_wp)
    call is_worth('2-01:00:10', 176410.0_wp)
  end subroutine test_words

  !> A word must be so many seconds.
  subroutine is_worth(word, expected)
    character(len=*), intent(in) :: word
    real(wp), intent(in) :: expected
    type(error_t), allocatable :: error
    real(wp) :: seconds

    call read_walltime(word, seconds, error)
    call t%check(.not. allocated(error), word//' is taken')
    call t%near(seconds, expected, 1e-9_wp, word)
  end subroutine is_worth

  !> What is no duration is refused.
  subroutine test_refused()
    character(len=12), parameter :: words(10) = [character(len=12) :: '-1', 'soon', '1:60', '1:2:3:4', '1:-2', ':30', '1-2:30', &
                                                 '1-', '1:00:', '-1:30']
    type(error_t), allocatable :: error
    real(wp) :: seconds
    integer :: i

    do i = 1, size(words)
      call read_walltime(trim(words(i)), seconds, error)
      call t%check(allocated(error), trim(words(i))//' is refused')
    end do
  end subroutine test_refused

  !> A tenth of the time of a job is left, at most two minutes.
  subroutine test_jobs()
    real(wp) :: seconds
    logical :: is_valid

    call seconds_of_job('1700003600', '', 1.7e9_wp, seconds, is_valid)
    call t%check(is_valid, 'the end of a job is taken')
    call t%near(seconds, 3480.0_wp, 1e-6_wp, 'two minutes are left')
    call seconds_of_job('', '600', 1.7e9_wp, seconds, is_valid)
    call t%near(seconds, 540.0_wp, 1e-6_wp, 'a tenth is left')
    call seconds_of_job('1699999999', '', 1.7e9_wp, seconds, is_valid)
    call t%near(seconds, 1.0_wp, 1e-9_wp, 'a job that is over is no run without a limit')
    call seconds_of_job('', '', 1.7e9_wp, seconds, is_valid)
    call t%check(.not. is_valid, 'without a job there is no end')
  end subroutine test_jobs

  !> Lines come every five seconds at first; a day has few of them.
  subroutine test_lines_of_a_log()
    real(wp) :: elapsed
    integer :: n

    call t%near(line_interval(60.0_wp), 5.0_wp, 1e-12_wp, 'five seconds at first')
    call t%near(line_interval(1e6_wp), 600.0_wp, 1e-12_wp, 'ten minutes at last')
    elapsed = 0
    n = 0
    do while (elapsed < 86400)
      elapsed = elapsed + line_interval(elapsed)
      n = n + 1
    end do
    call t%check(n > 150 .and. n < 260, 'a day has about two hundred lines')
  end subroutine test_lines_of_a_log
end program test_walltime
