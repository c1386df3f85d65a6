!> Results of `splitgrain solve` for one problem and one solver: a row of a table, a line of JSON, the trace as CSV.
module sg_solve_table
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_positive_inf, ieee_value
  use sg_columns, only: padded, right
  use sg_json, only: json_t
  use sg_kinds, only: wp
  use sg_matrix_errors, only: errors_of, find_worst_contact, matrix_errors_t, most_share
  use sg_matrix_problem, only: matrix_problem_t
  use sg_report, only: report_t
  use sg_text, only: to_text
  use sg_trace_csv, only: point_cells, point_names
  implicit none
  private
  public :: solve_row_t, judge, table_head, table_row, json_row, json_of_error, trace_head, trace_rows

  !> One problem solved by one solver
  type :: solve_row_t
    !> File of the problem, and name of the solver
    character(len=:), allocatable :: file, solver
    !> Number of contacts, components of each, and whether W is symmetric
    integer :: contacts = 0, dimension = 0
    logical :: is_symmetric = .true.
    !> Did the solver start from a guess of the file?
    logical :: has_guess = .false.
    !> Effort: the solver's iterations, or its sweeps where it counts only those; factorisations; CPU seconds
    integer :: iterations = 0, sweeps = 0, factorisations = 0
    real(wp) :: cpu_seconds = 0
    !> Errors of the answer, measured by us; infinite where it is not finite
    type(matrix_errors_t) :: errors
    !> Wanted e1, and whether the answer has it
    real(wp) :: tolerance = 0
    logical :: is_converged = .false.
    !> Contact that leaves the largest share of what acts on it undone, 0 where there is none, and that share
    integer :: worst_contact = 0
    real(wp) :: worst_share = 0
  end type solve_row_t

  !> Beyond this impulses are no answer, and their squares could not be counted
  real(wp), parameter :: largest_impulse = 1e100_wp

contains

  !> Measure an answer, independent of the report of the solver.
  subroutine judge(problem, report, row)
    type(matrix_problem_t), intent(in) :: problem !! problem with the answer
    type(report_t), intent(in) :: report !! the solver's effort
    type(solve_row_t), intent(inout) :: row !! row whose `tolerance` is set; contacts, effort, errors and verdict are set
    logical :: is_finite

    row%contacts = problem%n
    row%dimension = problem%d
    row%is_symmetric = problem%is_symmetric
    row%iterations = merge(report%iterations, report%sweeps, report%iterations > 0)
    row%sweeps = report%sweeps
    row%factorisations = report%factorisations
    is_finite = all(ieee_is_finite(problem%r))
    if (is_finite) is_finite = all(abs(problem%r) < largest_impulse)
    if (is_finite) then
      row%errors = errors_of(problem, problem%r)
      call find_worst_contact(problem, problem%r, row%worst_contact, row%worst_share)
    else
      row%errors%e1 = ieee_value(1.0_wp, ieee_positive_inf)
      row%errors%e2 = row%errors%e1
      row%errors%e8 = row%errors%e1
    end if
    row%is_converged = row%errors%e1 <= row%tolerance .and. row%worst_share <= most_share
  end subroutine judge

  !> Head of the table.
  pure function table_head(width) result(text)
    integer, intent(in) :: width !! characters for the names of files
    character(len=:), allocatable :: text

    text = padded('file', width)//'  contacts  '//padded('solver', 16)// &
           ' iterations  cpu seconds        e1        e2        e8  converged'
  end function table_head

  !> One row of the table.
  pure function table_row(row, width) result(text)
    type(solve_row_t), intent(in) :: row !! problem and solver
    integer, intent(in) :: width !! characters for the names of files
    character(len=:), allocatable :: text
    character(len=80) :: numbers

    write (numbers, '(i11,f13.4,3(1x,a9),2x,a)') row%iterations, row%cpu_seconds, short(row%errors%e1), short(row%errors%e2), &
      short(row%errors%e8), trim(merge('yes', 'no ', row%is_converged))
    text = padded(row%file, width)//right(to_text(row%contacts), 10)//'  '//padded(row%solver, 16)//trim(numbers)
    if (row%errors%e1 <= row%tolerance .and. .not. row%is_converged) &
      text = text//': contact '//to_text(row%worst_contact)//' breaks its law'
  end function table_row

  !> An error with three digits.
  pure function short(error) result(word)
    real(wp), intent(in) :: error
    character(len=9) :: word

    if (ieee_is_finite(error)) then
      write (word, '(es9.2)') error
    else
      word = ' infinite'
    end if
  end function short

  !> A row as one flat JSON object on one line.
  function json_row(row) result(text)
    type(solve_row_t), intent(in) :: row !! problem and solver
    character(len=:), allocatable :: text
    type(json_t) :: json

    call json%add('file', row%file)
    call json%add('contacts', row%contacts)
    call json%add('dimension', row%dimension)
    call json%add('symmetric', row%is_symmetric)
    call json%add('solver', row%solver)
    call json%add('guess', row%has_guess)
    call json%add('iterations', row%iterations)
    call json%add('sweeps', row%sweeps)
    call json%add('factorisations', row%factorisations)
    call json%add('cpu_seconds', row%cpu_seconds)
    call json%add('e1', row%errors%e1)
    call json%add('e2', row%errors%e2)
    call json%add('e8', row%errors%e8)
    call json%add('tolerance', row%tolerance)
    call json%add('worst_contact', row%worst_contact)
    call json%add('worst_share', row%worst_share)
    call json%add('converged', row%is_converged)
    text = json%line()
  end function json_row

  !> A file that could not be read as one flat JSON object on one line.
  function json_of_error(file, message) result(text)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: message !! what is wrong
    character(len=:), allocatable :: text
    type(json_t) :: json

    call json%add('file', file)
    call json%add('error', message)
    call json%add('converged', .false.)
    text = json%line()
  end function json_of_error

  !> Head of the trace.
  pure function trace_head() result(text)
    character(len=:), allocatable :: text

    text = 'solver,file,'//point_names//new_line('a')
  end function trace_head

  !> The trace of one solver on one problem, one line per point.
  pure function trace_rows(row, report) result(text)
    type(solve_row_t), intent(in) :: row !! problem and solver
    type(report_t), intent(in) :: report !! report with a trace
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    if (.not. allocated(report%trace)) return
    do i = 1, size(report%trace)
      text = text//row%solver//','//csv_field(row%file)//','//point_cells(report%trace(i))//new_line('a')
    end do
  end function trace_rows

  !> A text as a field of a CSV file; one that begins like a formula of a spreadsheet gets an apostrophe before it.
  pure function csv_field(text) result(field)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: field
    integer :: i

    field = text
    if (scan(text(:min(1, len(text))), '=+-@'//achar(9)//achar(13)) > 0) field = "'"//text
    if (scan(text, ',"'//new_line('a')) == 0) return
    field = '"'//field(:len(field) - len(text))
    do i = 1, len(text)
      field = field//text(i:i)
      if (text(i:i) == '"') field = field//'"'
    end do
    field = field//'"'
  end function csv_field
end module sg_solve_table
