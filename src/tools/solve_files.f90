!> Contact problems in FCLIB files: solved by some solvers, judged by errors measured independently, and printed as they come.
module sg_solve_files
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_choose_solver, only: choose_matrix_solver
  use sg_error, only: error_t, exit_bad_input, exit_done, exit_not_converged, fail
  use sg_fclib_read, only: read_fclib
  use sg_fclib_write, only: write_solution
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_options_t, matrix_solver_t
  use sg_print, only: print_line
  use sg_report, only: report_t
  use sg_solve_table, only: json_of_error, json_row, judge, solve_row_t, table_head, table_row, trace_head, trace_rows
  use sg_system, only: real_path
  use sg_text, only: text_t, to_text
  use sg_text_files, only: append_text, replace_file
  use sg_timers, only: cpu_now
  implicit none
  private
  public :: solve_request_t, solve_files

  !> What is asked of all files
  type :: solve_request_t
    !> Names of the solvers, and when they stop
    type(text_t), allocatable :: solvers(:)
    type(matrix_options_t) :: options
    !> File of the trace; empty for none
    character(len=:), allocatable :: trace
    !> Start from guesses? Write answers, also over others? Print JSON?
    logical :: with_guess = .false., with_write = .false., is_forced = .false., as_json = .false.
  end type solve_request_t

contains

  !> Solve the problems of all files and print.
  subroutine solve_files(request, files, code, error)
    type(solve_request_t), intent(in) :: request !! what is asked
    type(text_t), intent(in) :: files(:) !! the files
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! set when there is no place for the trace
    integer :: i, solved, width
    logical :: is_solved
    integer :: codes(size(files))

    code = exit_done
    if (len(request%trace) > 0) call open_trace(request%trace, files, error)
    if (allocated(error)) return
    width = maxval([4, (len(files(i)%s), i=1, size(files))])
    if (.not. request%as_json) call print_line(table_head(width))
    solved = 0
    do i = 1, size(files)
      call solve_file(files(i)%s, request, width, is_solved, codes(i))
      if (is_solved) solved = solved + 1
    end do
    if (.not. request%as_json) call print_line(to_text(solved)//' of '//to_text(size(files))// &
      ' problems solved to e1 <= '//to_text(request%options%tolerance, 3))
    code = maxval(codes)
    if (any(codes == exit_bad_input)) code = exit_bad_input
  end subroutine solve_files

  !> Begin a trace, which must not take the place of a problem.
  subroutine open_trace(trace, files, error)
    character(len=*), intent(in) :: trace
    type(text_t), intent(in) :: files(:)
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    do i = 1, size(files)
      if (len(real_path(trace)) > 0 .and. real_path(trace) == real_path(files(i)%s)) &
        call fail(error, 'this file is read, --trace must name another one', file=trace)
    end do
    if (.not. allocated(error)) call replace_file(trace, trace_head(), error)
  end subroutine open_trace

  !> Solve the problem of one file by all solvers asked for; it is solved when one of them does.
  subroutine solve_file(file, request, width, is_solved, code)
    character(len=*), intent(in) :: file
    type(solve_request_t), intent(in) :: request
    integer, intent(in) :: width
    logical, intent(out) :: is_solved
    integer, intent(out) :: code
    type(matrix_problem_t) :: problem, answer
    type(solve_row_t) :: row
    type(error_t), allocatable :: error
    real(wp), allocatable :: best(:, :)
    real(wp) :: best_e1, e1
    logical :: has_guess
    integer :: i

    is_solved = .false.
    call read_fclib(file, request%with_guess, problem, has_guess, error)
    if (allocated(error)) then
      if (request%as_json) call print_line(json_of_error(file, error%message))
      call report(error, code)
      return
    end if
    best_e1 = huge(best_e1)
    best = problem%r
    do i = 1, size(request%solvers)
      answer = problem
      call solve_once(file, request, request%solvers(i)%s, has_guess, answer, row, error)
      is_solved = is_solved .or. row%is_converged
      ! An answer that solves the problem is better than any that does not.
      e1 = row%errors%e1 + merge(0.0_wp, 1.0_wp + request%options%tolerance, row%is_converged)
      if (e1 < best_e1) best = answer%r
      best_e1 = min(best_e1, e1)
      if (request%as_json) then
        call print_line(json_row(row))
      else
        call print_line(table_row(row, width))
      end if
    end do
    code = merge(exit_done, exit_not_converged, is_solved)
    if (request%with_write .and. .not. allocated(error)) call write_solution(file, best, request%is_forced, error)
    if (allocated(error)) call report(error, code)
  end subroutine solve_file

  !> Solve a problem by one solver, measure the answer, and keep the trace.
  subroutine solve_once(file, request, name, has_guess, problem, row, error)
    character(len=*), intent(in) :: file, name
    type(solve_request_t), intent(in) :: request
    logical, intent(in) :: has_guess
    type(matrix_problem_t), intent(inout) :: problem
    type(solve_row_t), intent(out) :: row
    type(error_t), allocatable, intent(inout) :: error
    class(matrix_solver_t), allocatable :: solver
    type(report_t) :: report
    type(error_t), allocatable :: failure
    real(wp) :: start

    row%file = file
    row%solver = name
    row%has_guess = has_guess
    row%tolerance = request%options%tolerance
    start = cpu_now()
    if (problem%n > 0) then
      call choose_matrix_solver(name, request%options, solver, failure)
      solver%options%warm_start = has_guess
      call solver%solve(problem, report)
    end if
    row%cpu_seconds = cpu_now() - start
    call judge(problem, report, row)
    if (len(request%trace) > 0) call append_text(request%trace, trace_rows(row, report), failure)
    if (allocated(failure)) call move_alloc(failure, error)
  end subroutine solve_once

  !> Print the error of a file.
  subroutine report(error, code)
    type(error_t), intent(in) :: error
    integer, intent(out) :: code

    write (error_unit, '(a)') error%report()
    code = error%code
  end subroutine report
end module sg_solve_files
