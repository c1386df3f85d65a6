!> Clocks of the phases of a run: the one place that starts and stops them.
module sg_timed
  use sg_error, only: error_t
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: timed

  abstract interface
    !> A piece of work within one phase
    subroutine work_t(sim, error)
      import :: error_t, simulation_t
      type(simulation_t), intent(inout) :: sim
      type(error_t), allocatable, intent(out) :: error
    end subroutine work_t
  end interface

contains

  !> Do some work and add its time to that of a phase; do nothing where an error is set. The clock of a phase
  !! that is interrupted stops meanwhile.
  subroutine timed(work, sim, phase, error)
    procedure(work_t) :: work !! work of the phase
    type(simulation_t), intent(inout) :: sim !! simulation to work on
    integer, intent(in) :: phase !! one of `phase_*`
    type(error_t), allocatable, intent(inout) :: error !! error of the work; nothing is done where one is set
    integer :: interrupted

    if (allocated(error)) return
    interrupted = sim%phase
    if (interrupted > 0) call sim%totals%phase(interrupted)%stop()
    sim%phase = phase
    call sim%totals%phase(phase)%start()
    call work(sim, error)
    call sim%totals%phase(phase)%stop()
    sim%phase = interrupted
    if (interrupted > 0) call sim%totals%phase(interrupted)%start()
  end subroutine timed
end module sg_timed
