!> The history of a step that ends the run: a user needs the history of the step that broke, which could not be known before.
!!
!! So the guess of every solve is kept where a run is traced. When the step breaks, its contact problem is solved once more, from
!! the same guess and by the same solver, this time with a history.
module sg_broken_trace
  use sg_error, only: error_t, exit_broken, exit_unbalanced
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_run_trace, only: run_trace_t
  use sg_simulation, only: simulation_t
  use sg_totals, only: phase_measure
  implicit none
  private
  public :: is_of_the_step, trace_broken

contains

  !> Does an error tell of a step that broke, not of a file that cannot be written or a deck that is wrong?
  pure logical function is_of_the_step(error)
    type(error_t), intent(in) :: error !! what ended the run

    is_of_the_step = any(error%code == [exit_broken, exit_unbalanced])
  end function is_of_the_step

  !> Write the history of the step that ended the run, where a run is traced. Collective.
  subroutine trace_broken(sim, step, trace, error)
    type(simulation_t), intent(inout) :: sim !! its problem is that of the step
    integer, intent(in) :: step !! number of the step
    type(run_trace_t), intent(inout) :: trace !! gets a row more
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when it cannot be written

    if (.not. trace%is_on) return
    if (.not. (sim%is_traced .or. sim%dump%is_unsolved)) then
      associate (measuring => sim%totals%phase(phase_measure))
        call measuring%start()
        call solve_again(sim)
        call measuring%stop()
      end associate
    end if
    call trace%end_step(step, sim%time(step), sim%all_contacts, sim%report, sim%totals, sim%comm, error)
  end subroutine trace_broken

  !> Solve the problem of the last step once more, with a history. Collective.
  subroutine solve_again(sim)
    type(simulation_t), intent(inout) :: sim !! its report is that of this solve
    type(problem_t) :: problem

    problem = sim%problem
    problem%impulse = sim%guess_impulse
    problem%body = sim%guess_body
    if (sim%decomposition%is_on) then
      sim%glued_solver%with_trace = .true.
      call sim%glued_solver%solve(problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm, sim%report)
    else
      sim%solver%with_trace = .true.
      call sim%solver%solve(problem, sim%report)
    end if
  end subroutine solve_again
end module sg_broken_trace
