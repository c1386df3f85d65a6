!> How far a run is: on a terminal one bar that is redrawn, elsewhere one line every few seconds.
module sg_progress
  use sg_kinds, only: wp
  use sg_print, only: print_line
  use sg_report, only: report_t
  use sg_text, only: to_text
  use sg_timers, only: wall_now
  implicit none
  private
  public :: progress_t, duration_text, line_interval, add_recent

  !> Wall seconds between two lines, and between two drawings of the bar
  real(wp), parameter :: seconds_between_lines = 5.0_wp, seconds_between_bars = 0.2_wp
  !> Lines get rarer: they wait for this share of the time since the start, but never longer than ten minutes [s]
  real(wp), parameter :: waiting_share = 0.05_wp, longest_wait = 600.0_wp
  !> Steps count as recent for about this share of the time since the start, but at least so long [s]
  real(wp), parameter :: mean_share = 0.1_wp, shortest_mean = 60.0_wp
  !> Letters of the bar, and of the whole line that is redrawn
  integer, parameter :: bar_width = 20, line_width = 110

  !> Progress of one run
  type :: progress_t
    !> Open unit to write on
    integer, private :: unit = 0
    !> First and last step of this run
    integer, private :: first_step = 0, last_step = 0
    !> Is the unit a terminal? Is nothing printed? Does a bar stand on the terminal's line?
    logical, private :: on_terminal = .false., is_quiet = .false., is_drawn = .false.
    !> Wall clock at the start and when progress was last shown [s]
    real(wp), private :: started = 0, shown = 0
    !> Steps done when progress was last shown; seconds of recent steps, and their number
    integer, private :: shown_step = 0
    real(wp), private :: recent(2) = 0
    !> Does the last step end a stage of the run rather than the run?
    logical, private :: is_stage = .false.
    !> Name of the stopping criterion
    character(len=:), allocatable, private :: criterion
  contains
    procedure :: start => progress_start
    procedure :: is_due => progress_is_due
    procedure :: show => progress_show
    procedure :: finish => progress_finish
  end type progress_t

contains

  !> Begin.
  subroutine progress_start(self, unit, first_step, last_step, criterion, on_terminal, is_quiet, is_stage)
    class(progress_t), intent(inout) :: self
    integer, intent(in) :: unit !! open unit to write on
    integer, intent(in) :: first_step !! number of steps done before this run
    integer, intent(in) :: last_step !! number of the last step
    character(len=*), intent(in) :: criterion !! name of the stopping criterion
    logical, intent(in) :: on_terminal !! is the unit a terminal?
    logical, intent(in) :: is_quiet !! print nothing at all
    logical, intent(in), optional :: is_stage !! is the last step that of a stage? Otherwise that of the run

    self%unit = unit
    self%first_step = first_step
    self%last_step = last_step
    self%criterion = trim(criterion)
    self%on_terminal = on_terminal
    self%is_quiet = is_quiet
    self%is_drawn = .false.
    self%started = wall_now()
    self%shown = self%started
    self%shown_step = first_step
    self%recent = 0
    self%is_stage = .false.
    if (present(is_stage)) self%is_stage = is_stage
  end subroutine progress_start

  !> Is it time to show progress again?
  logical function progress_is_due(self)
    class(progress_t), intent(in) :: self
    real(wp) :: now

    now = wall_now()
    progress_is_due = .not. self%is_quiet .and. &
                      now - self%shown >= merge(seconds_between_bars, line_interval(now - self%started), self%on_terminal)
  end function progress_is_due

  !> Time between two lines of a log so long after the start: a day takes about two hundred and fifty lines.
  pure real(wp) function line_interval(elapsed)
    real(wp), intent(in) :: elapsed !! since the start [s]

    line_interval = max(seconds_between_lines, min(longest_wait, waiting_share*elapsed))
  end function line_interval

  !> Show where the run is after a step.
  subroutine progress_show(self, step, time, contacts, report, kinetic_energy)
    class(progress_t), intent(inout) :: self
    integer, intent(in) :: step !! step done
    real(wp), intent(in) :: time !! time reached [s]
    integer, intent(in) :: contacts !! number of contacts
    type(report_t), intent(in) :: report !! report of the solver
    real(wp), intent(in) :: kinetic_energy !! at this step [J]
    character(len=:), allocatable :: text, left
    character(len=line_width) :: line

    if (self%is_quiet) return
    call keep_recent(self, step)
    left = duration_text(self%recent(1)/max(1.0_wp, self%recent(2))*real(max(0, self%last_step - step), wp))//' left'
    text = to_text(contacts)//' contacts, '//to_text(report%sweeps)//' sweeps, '//self%criterion//' '// &
           to_text(report%criterion, 2)//merge(' ', '!', report%is_converged)
    if (self%on_terminal) then
      text = bar(real(step - self%first_step, wp)/real(max(1, self%last_step - self%first_step), wp))//' step '// &
             to_text(step)//'/'//to_text(self%last_step)//', '//text//' '//left
      line = text
      call print_line(achar(13)//line, self%unit, is_open=.true.)
      self%is_drawn = .true.
    else
      if (self%is_stage) left = left//' of the stage'
      if (.not. report%is_converged .and. report%worst_speed > 0) &
        text = text//' (a contact breaks its law by '//to_text(report%worst_speed, 2)//' m/s)'
      call print_line('step '//to_text(step)//' of '//to_text(self%last_step)//', time '//to_text(time, 4)// &
        ' s, '//text//', kinetic energy '//to_text(kinetic_energy, 3)//' J, '//left, self%unit)
    end if
  end subroutine progress_show

  !> End: the bar's line is closed.
  subroutine progress_finish(self)
    class(progress_t), intent(inout) :: self

    if (self%is_drawn) call print_line('', self%unit)
    self%is_drawn = .false.
  end subroutine progress_finish

  !> Take what is done since progress was last shown into the time and the number of recent steps: steps that grow dearer, as those
  !! of a bed that is poured, make the mean since the start too low. Both sums fade alike, within a tenth of the time since the
  !! start, so that a dear step counts as one step.
  subroutine keep_recent(self, step)
    class(progress_t), intent(inout) :: self
    integer, intent(in) :: step
    real(wp) :: now

    now = wall_now()
    call add_recent([now - self%shown, real(step - self%shown_step, wp)], now - self%started, self%recent)
    self%shown = now
    self%shown_step = step
  end subroutine keep_recent

  !> Add the latest seconds and steps to sums of recent ones, which fade.
  pure subroutine add_recent(latest, elapsed, recent)
    real(wp), intent(in) :: latest(2) !! duration of the latest steps [s], and their number
    real(wp), intent(in) :: elapsed !! time since the start [s]
    real(wp), intent(inout) :: recent(2) !! the same of recent steps

    recent = recent*exp(-latest(1)/max(shortest_mean, mean_share*elapsed)) + latest
  end subroutine add_recent

  !> A bar filled to a share, and the share in percent.
  pure function bar(share) result(text)
    real(wp), intent(in) :: share
    character(len=:), allocatable :: text
    character(len=bar_width) :: full
    character(len=4) :: percent

    full = ''
    full(:min(bar_width, max(0, int(share*bar_width)))) = repeat('=', bar_width)
    write (percent, '(i3,a)') int(100*min(1.0_wp, max(0.0_wp, share))), '%'
    text = '['//full//'] '//percent
  end function bar

  !> A duration as hours:minutes:seconds, or minutes:seconds below an hour.
  pure function duration_text(seconds) result(text)
    real(wp), intent(in) :: seconds !! [s]
    character(len=:), allocatable :: text
    character(len=20) :: buffer
    integer :: whole

    whole = nint(min(max(seconds, 0.0_wp), 1e9_wp))
    if (whole >= 3600) then
      write (buffer, '(i0,":",i2.2,":",i2.2)') whole/3600, modulo(whole, 3600)/60, modulo(whole, 60)
    else
      write (buffer, '(i0,":",i2.2)') whole/60, modulo(whole, 60)
    end if
    text = trim(buffer)
  end function duration_text
end module sg_progress
