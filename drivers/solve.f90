!> `splitgrain solve`: contact problems in FCLIB files, solved and judged by errors measured independently.
module sg_solve
  use sg_arguments, only: arguments_t
  use sg_choose_solver, only: choose_matrix_solver
  use sg_error, only: error_t, exit_done
  use sg_kinds, only: wp
  use sg_matrix_solver, only: matrix_solver_t
  use sg_methods, only: robust_solver, solver_names
  use sg_solve_files, only: solve_files, solve_request_t
  use sg_text, only: append_word, text_t
  implicit none
  private
  public :: solve_command

contains

  !> Solve all files and print.
  subroutine solve_command(arguments, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the command line
    type(solve_request_t) :: request

    code = exit_done
    call read_request(arguments, request, error)
    if (.not. allocated(error)) call solve_files(request, arguments%words, code, error)
  end subroutine solve_command

  !> Take the request from the command line.
  subroutine read_request(arguments, request, error)
    type(arguments_t), intent(in) :: arguments
    type(solve_request_t), intent(out) :: request
    type(error_t), allocatable, intent(out) :: error
    class(matrix_solver_t), allocatable :: solver
    integer :: i

    request%trace = arguments%get('trace', '')
    associate (options => request%options)
      call arguments%expect('solver tolerance iterations seconds guess trace write force json', 1, huge(1), &
                            'solve FILE... [options]; see splitgrain solve --help', error)
      if (.not. allocated(error)) call arguments%number('tolerance', (options%tolerance), 0.0_wp, options%tolerance, error)
      if (.not. allocated(error)) &
        call arguments%number('seconds', (options%maximum_seconds), 0.0_wp, options%maximum_seconds, error)
      if (.not. allocated(error)) &
        call arguments%whole('iterations', (options%maximum_iterations), 1, options%maximum_iterations, error)
      if (allocated(error)) return
      options%with_trace = len(request%trace) > 0
    end associate
    request%with_guess = arguments%has('guess')
    request%with_write = arguments%has('write')
    request%is_forced = arguments%has('force')
    request%as_json = arguments%has('json')
    call list_solvers(arguments, request%solvers)
    do i = 1, size(request%solvers)
      call choose_matrix_solver(request%solvers(i)%s, request%options, solver, error)
      if (allocated(error)) return
    end do
  end subroutine read_request

  !> Names of the solvers asked for.
  subroutine list_solvers(arguments, solvers)
    type(arguments_t), intent(in) :: arguments
    type(text_t), allocatable, intent(out) :: solvers(:)
    integer :: i

    solvers = arguments%all_of('solver')
    if (size(solvers) == 0) then
      call append_word(solvers, robust_solver)
    else if (arguments%get('solver', '') == 'all') then
      deallocate (solvers)
      associate (names => solver_names())
        do i = 1, size(names)
          call append_word(solvers, trim(names(i)))
        end do
      end associate
    end if
  end subroutine list_solvers
end module sg_solve
