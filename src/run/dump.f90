!> Dumps of contact problems: any step's problem as a pair of FCLIB files that this program and others can solve.
!!
!! A dump begins before the solve, with the guess, and ends after it, with the solution; where the solve gave values that are
!! not finite, the file holds the guess alone.
module sg_dump
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_memory, fail
  use sg_fclib_write, only: write_pieces
  use sg_kinds, only: wp, i4, i8
  use sg_memory, only: memory_t
  use sg_numerals, only: read_integer
  use sg_problem, only: problem_t
  use sg_shared_matrices, only: share_matrices, shared_matrices_t, take_solution
  use sg_subdomain, only: subdomain_t
  use sg_text, only: to_text
  implicit none
  private
  public :: dump_t, begin_dump, finish_dump, read_steps, is_listed

  !> Memory that matrices take while they are made, of a contact with few others on its bodies [bytes]
  integer(i8), parameter :: bytes_per_contact = 2000

  !> A dump under way
  type :: dump_t
    !> Has one begun?
    logical :: is_begun = .false.
    !> Was the problem not solved at all? Then there is no solution to write
    logical :: is_unsolved = .false.
    !> The problem with its guess; of several ranks this one's rows
    type(shared_matrices_t) :: matrices
    !> Error that keeps it from being written
    type(error_t), allocatable :: error
  end type dump_t

contains

  !> Begin a dump of an assembled problem that is not solved yet. Collective.
  subroutine begin_dump(dump, problem, subdomain, slot_of, comm)
    type(dump_t), intent(inout) :: dump !! dump to begin
    type(problem_t), intent(in) :: problem !! this rank's part, with its guess; bodies move as without impulses
    type(subdomain_t), intent(in) :: subdomain !! bodies shared between ranks
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    type(memory_t) :: memory

    dump%is_begun = .true.
    if (comm%any(.not. memory%fits(bytes_per_contact*int(problem%n_contacts, i8)))) then
      call fail(dump%error, 'memory is short: the matrices of the contact problem are not written', code=exit_memory)
      return
    end if
    call share_matrices(problem, subdomain, slot_of, comm, dump%matrices, dump%error)
  end subroutine begin_dump

  !> Write the two files of a dump, `dump-<step>-local.hdf5` and, where there is a global form, `-global.hdf5`. Collective.
  subroutine finish_dump(dump, problem, folder, deck, step, comm, name, error)
    type(dump_t), intent(inout) :: dump !! dump begun before the solve
    type(problem_t), intent(in) :: problem !! the same problem after it
    character(len=*), intent(in) :: folder !! of the results
    character(len=*), intent(in) :: deck !! path of the deck, for the title
    integer, intent(in) :: step !! number of the step
    type(comm_t), intent(inout) :: comm !! the ranks
    character(len=:), allocatable, intent(out) :: name !! of the local file, within the folder
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when it cannot be written
    logical :: is_broken

    dump%is_begun = .false.
    name = 'dump-'//to_text(step)
    if (allocated(dump%error)) then
      call move_alloc(dump%error, error)
      return
    end if
    is_broken = .not. (all(abs(problem%impulse(:, :problem%n_contacts)) <= huge(1.0_wp)) .and. &
                       all(abs(problem%body) <= huge(1.0_wp)))
    if (.not. (comm%any(is_broken) .or. dump%is_unsolved)) call take_solution(problem, dump%matrices)
    call write_pieces(folder//'/'//name, dump%matrices%pieces, 'step '//to_text(step)//' of '//deck, &
                      'written by splitgrain run --dump', comm, error)
    name = name//'-local.hdf5'
  end subroutine finish_dump

  !> Steps from a list of numbers and ranges: `10,20,100-110`.
  subroutine read_steps(list, steps, error)
    character(len=*), intent(in) :: list !! the list as written by the user
    integer, allocatable, intent(out) :: steps(:, :) !! first and last step of each range, shape (2, ranges)
    type(error_t), allocatable, intent(out) :: error !! set when it is no such list
    integer :: i, first, last

    allocate (steps(2, 1 + count([(list(i:i) == ',', i=1, len(list))])), source=0)
    first = 1
    do i = 1, size(steps, 2)
      last = index(list(first:)//',', ',') + first - 2
      steps(:, i) = range_of(list(first:last))
      first = last + 2
    end do
    if (all(steps(1, :) >= 1 .and. steps(2, :) >= steps(1, :))) return
    call fail(error, '--dump takes steps such as 10 or 10,20,100-110, not "'//list//'"')
  end subroutine read_steps

  !> First and last step of `10` or `100-110`; zeros where a number is none.
  function range_of(word) result(range)
    character(len=*), intent(in) :: word
    integer :: range(2), dash

    dash = index(word//'-', '-')
    range(1) = number_of(word(:dash - 1))
    range(2) = range(1)
    if (dash <= len(word)) range(2) = number_of(word(dash + 1:))
  end function range_of

  !> A number of digits alone; 0 where it is none.
  integer function number_of(word) result(number)
    character(len=*), intent(in) :: word
    logical :: is_number

    call read_integer(word, number, is_number)
    if (.not. is_number .or. scan(word, '+-') > 0) number = 0
  end function number_of

  !> Is a step in one of the ranges?
  pure logical function is_listed(steps, step)
    integer, intent(in) :: steps(:, :) !! first and last of each range, shape (2, ranges)
    integer, intent(in) :: step !! number of a step

    is_listed = any(steps(1, :) <= step .and. step <= steps(2, :))
  end function is_listed
end module sg_dump
