!> Dumps of contact problems: the list of steps, and what a step that breaks leaves behind to be replayed.
module breaking_solver
  use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: breaking_solver_t

  !> A solver that spoils the velocity of the first slot
  type, extends(nlgs_t) :: breaking_solver_t
  contains
    procedure :: solve_coupled => breaking_solve
  end type breaking_solver_t

contains

  !> Give the first slot an infinite velocity, and report it.
  subroutine breaking_solve(self, problem, coupling, comm, report)
    class(breaking_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem to spoil
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks: none
    type(comm_t), intent(inout) :: comm !! this rank alone
    type(report_t), intent(out) :: report !! a velocity is not finite

    call self%nlgs_t%solve_coupled(problem, coupling, comm, report)
    problem%body(1, 1) = ieee_value(1.0_wp, ieee_positive_inf)
    report%is_finite = .false.
  end subroutine breaking_solve
end module breaking_solver

program test_dump
  use breaking_solver, only: breaking_solver_t
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, g, put_disk, put_wall, run
  use sg_advance, only: advance
  use sg_choose_solver, only: choose_matrix_solver
  use sg_dump, only: finish_dump, is_listed, read_steps
  use sg_error, only: error_t, exit_broken
  use sg_fclib_read, only: read_fclib
  use sg_hdf5, only: hdf5_is_available
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_options_t, matrix_solver_t
  use sg_report, only: report_t
  use sg_simulation, only: simulation_t
  implicit none
  type(tests_t) :: t

  call test_lists()
  call test_bad_lists()
  if (hdf5_is_available()) then
    call test_broken_step()
  else
    write (*, '(a)') 'no HDF5: the dump of a broken step is left out'
  end if
  call t%finish()

contains

  !> Numbers and ranges.
  subroutine test_lists()
    integer, allocatable :: steps(:, :)
    type(error_t), allocatable :: error
    integer :: step

    call read_steps('7,10-12,100', steps, error)
    call t%check(.not. allocated(error), 'a list is read')
    call t%equal(count([(is_listed(steps, step), step=1, 200)]), 5, 'as many steps as it names')
    call t%check(all([is_listed(steps, 7), is_listed(steps, 10), is_listed(steps, 12), is_listed(steps, 100)]), 'and these')
  end subroutine test_lists

  !> What is no list.
  subroutine test_bad_lists()
    character(len=*), parameter :: bad(9) = [character(len=24) :: 'x', '0', '5-3', '1,,2', '-4', '4-', '1-2-3', '1,', &
                                             '99999999999999999999']
    integer, allocatable :: steps(:, :)
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, size(bad)
      call read_steps(trim(bad(i)), steps, error)
      call t%check(allocated(error), 'no list: '//trim(bad(i)))
    end do
  end subroutine test_bad_lists

  !> A solve that gives an infinity ends the step, and what it was given can be solved from the file, by anyone.
  subroutine test_broken_step()
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    type(matrix_problem_t) :: problem
    class(matrix_solver_t), allocatable :: solver
    type(report_t) :: report
    character(len=:), allocatable :: name
    real(wp) :: place(2)
    logical :: has_guess

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.3_wp, 0.1_wp)
    call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp])
    call put_wall(sim%scene, 2, 10.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    call begin_run(sim, 1e-3_wp, 1e-10_wp)
    call run(sim, 3)
    place = sim%scene%bodies%position(:, 1)
    deallocate (sim%solver)
    allocate (breaking_solver_t :: sim%solver)
    call advance(sim, error)
    call t%check(allocated(error), 'the step breaks')
    if (allocated(error)) call t%equal(error%code, exit_broken, 'with its exit code')
    call t%near(maxval(abs(sim%scene%bodies%position(:, 1) - place)), 0.0_wp, 0.0_wp, 'no body has moved')
    call t%check(sim%dump%is_begun, 'a dump has begun without being asked for')
    call finish_dump(sim%dump, sim%problem, '.', 'a test', 4, sim%comm, name, error)
    call t%check(.not. allocated(error), 'it is written')
    call read_fclib('./'//name, .true., problem, has_guess, error)
    call t%check(.not. allocated(error) .and. has_guess, 'it is read back, with the guess of the step')
    call choose_matrix_solver('auto', matrix_options_t(), solver, error)
    call solver%solve(problem, report)
    ! One disk on a floor: the impulse of its weight over a step; e1 of 1e-8 of q = g h leaves as much of it.
    call t%near(problem%r(1, 1), sim%scene%bodies%mass(1)*g*1e-3_wp, 1e-6_wp*sim%scene%bodies%mass(1)*g*1e-3_wp, &
                'solved, it gives what the step should have given')
  end subroutine test_broken_step
end program test_dump
