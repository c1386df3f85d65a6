!> The real contact problems of other codes (../shared/problems beside the sources): the default solver with its default settings
!! solves them all to e1 = 1e-8, and what the solvers say of their answers is true.
program test_matrix_solvers_real
  use harness, only: tests_t
  use sg_choose_solver, only: choose_matrix_solver
  use sg_error, only: error_t
  use sg_fclib_read, only: read_fclib
  use sg_hdf5, only: hdf5_is_available
  use sg_kinds, only: wp
  use sg_matrix_errors, only: errors_of, matrix_errors_t
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_options_t, matrix_solver_t
  use sg_methods, only: robust_solver
  use sg_report, only: report_t
  use sg_system, only: file_exists
  use written_files, only: shared_folder
  implicit none
  character(len=*), parameter :: files(15) = [character(len=40) :: 'FC3D_Example1', 'Rover1039', 'Rover4613', &
    'OneObject-i1028-138', 'OneObject-i100000-499', 'NESpheres_30_1', 'BoxesStack1-i100000-32', 'Confeti-ex03-Fc3D-SBM', &
    'LMGC_100_PR_PerioBox-i00361-60-03000', 'Box_Stacks-i0122-82-5', 'spheres-in-a-box-98-i10000-256-10', 'Capsules-i100-889', &
    'Capsules-i125-1213', 'Spheres-i099-356-679', 'KaplasTower-i1061-4']
  type(tests_t) :: tests
  integer :: i

  if (file_exists(shared_folder()//'/problems/'//trim(files(1))//'.hdf5') .and. hdf5_is_available()) then
    do i = 1, size(files)
      call try_all(trim(files(i)))
    end do
  else
    write (*, '(a)') 'skipped: real problems need HDF5 and '//shared_folder()//'/problems'
    call tests%check(.true., 'skipped')
  end if
  call tests%finish()

contains

  !> One problem, by the default, by proximal points, and for ten thousand iterations by sweeps.
  subroutine try_all(name)
    character(len=*), intent(in) :: name
    character(len=*), parameter :: solvers(5) = &
      [character(len=12) :: 'auto', 'proximal', 'accelerated', 'nesterov', 'nlgs']
    type(matrix_problem_t) :: problem
    type(matrix_options_t) :: options
    type(matrix_errors_t) :: errors
    type(report_t) :: report
    type(error_t), allocatable :: error
    class(matrix_solver_t), allocatable :: solver
    logical :: has_guess
    integer :: s

    call read_fclib(shared_folder()//'/problems/'//name//'.hdf5', .false., problem, has_guess, error)
    call tests%check(.not. allocated(error), name//': read')
    if (allocated(error)) return
    do s = 1, size(solvers)
      options%maximum_iterations = merge(100000, 10000, s <= 2)
      call choose_matrix_solver(trim(solvers(s)), options, solver, error)
      call tests%check(.not. allocated(error), name//': there is a solver '//solvers(s))
      if (allocated(error)) cycle
      call solver%solve(problem, report)
      errors = errors_of(problem, problem%r)
      write (*, '(a,a,es9.1,i8,i6,f8.3)') name//'  ', solvers(s), errors%e1, report%sweeps, &
        report%factorisations, report%cpu_seconds
      if (s <= 2) call tests%near(errors%e1, 0.0_wp, 1e-8_wp, name//': solved by '//solvers(s))
      call tests%near(report%e1, errors%e1, 1e-3_wp*errors%e1, name//': error told by '//solvers(s))
      call tests%check(report%is_converged .eqv. errors%e1 <= 1e-8_wp, name//': convergence told by '//solvers(s))
    end do
    call tests%check(robust_solver == solvers(1), 'the default is '//solvers(1))
  end subroutine try_all
end program test_matrix_solvers_real
