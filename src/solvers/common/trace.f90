!> The history of a solve: errors of the whole problem after more and more work. What measuring them takes is kept apart: clocks
!! stand still meanwhile.
module sg_trace
  use sg_kinds, only: wp
  use sg_report, only: report_t, trace_point_t
  use sg_timers, only: cpu_now, timer_t
  implicit none
  private
  public :: trace_t, point_of

  !> Points are this far apart, over the iterations so far, once they are more than one apart
  real(wp), parameter :: spacing = 0.05_wp

  !> A history that is being written
  type :: trace_t
    !> Is there one?
    logical :: is_on = .false.
    !> Time that measuring for it took
    type(timer_t) :: apart
    !> Iterations at which the next point is due, points so far, CPU seconds at the start and at the pause
    integer, private :: next = 0, n = 0
    real(wp), private :: start = 0, paused = 0
    type(trace_point_t), allocatable, private :: points(:)
  contains
    procedure :: begin => trace_begin
    procedure :: seconds => trace_seconds
    procedure :: is_due => trace_is_due
    procedure :: pause => trace_pause
    procedure :: add => trace_add
    procedure :: finish => trace_finish
  end type trace_t

contains

  !> Begin with no point.
  subroutine trace_begin(self, is_on)
    class(trace_t), intent(inout) :: self
    logical, intent(in) :: is_on !! is a history wanted?

    self%is_on = is_on
    self%apart = timer_t()
    self%next = 0
    self%n = 0
    self%start = cpu_now()
  end subroutine trace_begin

  !> CPU seconds since the beginning, without those that measuring for the history took.
  real(wp) function trace_seconds(self) result(seconds)
    class(trace_t), intent(in) :: self

    seconds = cpu_now() - self%start - self%apart%cpu
  end function trace_seconds

  !> Is a point wanted after so many iterations? At each of the first ones, then ever farther apart.
  pure logical function trace_is_due(self, iterations) result(is_due)
    class(trace_t), intent(in) :: self
    integer, intent(in) :: iterations !! done so far

    is_due = .false.
    if (self%is_on) is_due = iterations >= self%next
  end function trace_is_due

  !> Stop the clock: errors are about to be measured for the history alone.
  subroutine trace_pause(self)
    class(trace_t), intent(inout) :: self

    self%paused = self%seconds()
    call self%apart%start()
  end subroutine trace_pause

  !> Add a point, and let the clock go on where it was stopped.
  subroutine trace_add(self, point)
    class(trace_t), intent(inout) :: self
    type(trace_point_t), intent(in) :: point !! errors of the whole problem, measured now; its time is that of the pause

    call append(self, point, self%paused)
    call self%apart%stop()
  end subroutine trace_add

  !> End the history with the errors of the answer, and give it to the report; without one nothing happens.
  subroutine trace_finish(self, iterations, report)
    class(trace_t), intent(inout) :: self
    integer, intent(in) :: iterations !! of the whole solve
    type(report_t), intent(inout) :: report !! errors and effort are set; gets the history
    logical :: is_new

    if (.not. self%is_on) return
    is_new = self%n == 0
    if (.not. is_new) is_new = self%points(self%n)%iteration < iterations
    if (is_new) call append(self, point_of(iterations, report), self%seconds())
    allocate (report%trace(self%n))
    report%trace = self%points(:self%n)
    report%apart = self%apart
  end subroutine trace_finish

  !> A point with the errors, the updates and the messages of a report.
  pure function point_of(iterations, report) result(point)
    integer, intent(in) :: iterations !! done so far
    type(report_t), intent(in) :: report !! its errors are measured
    type(trace_point_t) :: point

    point = trace_point_t(iteration=iterations, contact_updates=report%contact_updates, e1=report%e1, e2=report%e2, e8=report%e8, &
                          messages=report%messages, bytes=report%bytes, collectives=report%collectives)
  end function point_of

  !> Append a point.
  pure subroutine append(self, point, seconds)
    type(trace_t), intent(inout) :: self
    type(trace_point_t), intent(in) :: point
    real(wp), intent(in) :: seconds
    type(trace_point_t), allocatable :: longer(:)

    if (.not. allocated(self%points)) allocate (self%points(64))
    if (self%n == size(self%points)) then
      allocate (longer(2*self%n))
      longer(:self%n) = self%points
      call move_alloc(longer, self%points)
    end if
    self%points(self%n + 1) = point
    self%points(self%n + 1)%cpu_seconds = seconds
    ! Where no time has passed, differences of clocks may fall by their rounding.
    if (self%n > 0) self%points(self%n + 1)%cpu_seconds = max(seconds, self%points(self%n)%cpu_seconds)
    self%n = self%n + 1
    self%next = point%iteration + max(1, int(spacing*real(point%iteration, wp)))
  end subroutine append
end module sg_trace
