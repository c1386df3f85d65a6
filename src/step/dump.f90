!> Dumps of contact problems: any step's problem as a pair of FCLIB files that this program and others can solve.
!!
!! A dump begins before the solve, with the guess, and ends after it, with the solution; where the solve gave values that are
!! not finite, the file holds the guess alone.
module sg_dump
  use sg_error, only: error_t, fail
  use sg_fclib_write, only: write_fclib
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_problem, only: problem_t
  use sg_problem_matrices, only: matrices_map_t, matrices_of, take_impulses
  use sg_text, only: to_text
  implicit none
  private
  public :: dump_t, begin_dump, finish_dump, read_steps, is_listed

  !> A dump under way
  type :: dump_t
    !> Has one begun?
    logical :: is_begun = .false.
    !> The problem, where its rows come from, and the guess
    type(matrix_problem_t) :: matrices
    type(matrices_map_t) :: map
    real(wp), allocatable :: guess(:, :)
    !> What stands in the way of writing it
    type(error_t), allocatable :: error
  end type dump_t

contains

  !> Begin a dump of an assembled problem that is not solved yet.
  subroutine begin_dump(dump, problem)
    type(dump_t), intent(inout) :: dump !! dump to begin
    type(problem_t), intent(in) :: problem !! problem with its guess; bodies move as without impulses

    dump%is_begun = .true.
    if (allocated(dump%guess)) deallocate (dump%guess)
    call matrices_of(problem, .false., dump%matrices, dump%map, dump%error)
    if (allocated(dump%error)) return
    allocate (dump%guess, source=dump%matrices%r)
  end subroutine begin_dump

  !> Write the two files of a dump, `dump-<step>-local.hdf5` and, where there is a global form, `-global.hdf5`.
  subroutine finish_dump(dump, problem, folder, deck, step, name, error)
    type(dump_t), intent(inout) :: dump !! dump begun before the solve
    type(problem_t), intent(in) :: problem !! the same problem after it
    character(len=*), intent(in) :: folder !! of the results
    character(len=*), intent(in) :: deck !! path of the deck, for the title
    integer, intent(in) :: step !! number of the step
    character(len=:), allocatable, intent(out) :: name !! of the local file, within the folder
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    logical :: is_finite

    dump%is_begun = .false.
    name = 'dump-'//to_text(step)
    if (allocated(dump%error)) then
      call move_alloc(dump%error, error)
      return
    end if
    is_finite = all(abs(problem%impulse(:, :problem%n_contacts)) <= huge(1.0_wp)) .and. all(abs(problem%body) <= huge(1.0_wp))
    if (is_finite) call take_impulses(problem, dump%map, dump%matrices)
    call write_fclib(folder//'/'//name, dump%matrices, 'step '//to_text(step)//' of '//deck, &
                     'written by splitgrain run --dump', is_finite, error, dump%guess)
    name = name//'-local.hdf5'
  end subroutine finish_dump

  !> Steps from a list of numbers and ranges: `10,20,100-110`.
  subroutine read_steps(list, steps, error)
    character(len=*), intent(in) :: list !! what the user wrote
    integer, allocatable, intent(out) :: steps(:, :) !! first and last step of each range, shape (2, ranges)
    type(error_t), allocatable, intent(out) :: error !! set when it is no such list
    integer :: i, first, comma, dash, status(2), n

    n = 1 + count([(list(i:i) == ',', i=1, len(list))])
    allocate (steps(2, n), source=0)
    first = 1
    do i = 1, n
      comma = index(list(first:), ',')
      if (comma == 0) comma = len(list) - first + 2
      associate (word => list(first:first + comma - 2))
        dash = index(word, '-')
        if (dash == 0) dash = len(word) + 1
        status = 1
        if (dash > 1 .and. verify(word(:dash - 1), '0123456789') == 0) read (word(:dash - 1), *, iostat=status(1)) steps(1, i)
        steps(2, i) = steps(1, i)
        if (dash > len(word)) then
          status(2) = status(1)
        else if (dash < len(word)) then
          if (verify(word(dash + 1:), '0123456789') == 0) read (word(dash + 1:), *, iostat=status(2)) steps(2, i)
        end if
      end associate
      if (any(status /= 0) .or. steps(1, i) < 1 .or. steps(2, i) < steps(1, i)) then
        call fail(error, '--dump wants steps such as 10 or 10,20,100-110, not "'//list//'"')
        return
      end if
      first = first + comma
    end do
  end subroutine read_steps

  !> Is a step in one of the ranges?
  pure logical function is_listed(steps, step)
    integer, intent(in) :: steps(:, :) !! first and last of each range, shape (2, ranges)
    integer, intent(in) :: step !! number of a step

    is_listed = any(steps(1, :) <= step .and. step <= steps(2, :))
  end function is_listed
end module sg_dump
