!> Sums that the errors of a solution are made of (sg_residuals), over contacts one after the other, in vector registers:
!! error_records.cpp holds the loop. Contacts are those with friction, whose laws are unilateral and nothing else.
module sg_error_records
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sg_kinds, only: wp
  use sg_natural_map, only: chunk
  use sg_problem, only: problem_t
  use sg_records, only: arm_frictional, ball_frictional, round_frictional, solid_frictional
  implicit none
  private
  public :: have_records, sum_records

  !> Kinds of problems, and their numbers there
  integer, parameter :: kinds(4) = [round_frictional, arm_frictional, ball_frictional, solid_frictional]
  integer(c_int), parameter :: numbers(4) = [0_c_int, 1_c_int, 2_c_int, 4_c_int]

  interface
    !> Measure a run of contacts. Nothing is added where a law is another one.
    pure subroutine measure_records(kind, n, pair, record, impulse, body, with_e1, stride, sums, closing, bound, is_done) &
      bind(c, name='sg_measure_records')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: kind !! one of the numbers above
      integer(c_int), intent(in), value :: n !! contacts
      integer(c_int), intent(in) :: pair(*) !! slots, shape (2, contacts)
      real(c_double), intent(in) :: record(*) !! records, as in sg_records
      real(c_double), intent(in) :: impulse(*) !! impulses [N s]
      real(c_double), intent(in) :: body(*) !! records of bodies
      integer(c_int), intent(in), value :: with_e1 !! 1 where e1 and the bound are wanted too, else 0
      integer(c_int), intent(in), value :: stride !! reals from one sum to the next
      real(c_double), intent(inout) :: sums(*) !! sums to add to, four of each
      real(c_double), intent(inout) :: closing(*) !! what determines the active set (sg_active_set), by fours of contacts
      real(c_double), intent(out) :: bound !! bound of these contacts, where e1 is wanted [m2/s2]
      integer(c_int), intent(out) :: is_done !! 0 where a law is another one, else 1
    end subroutine measure_records
  end interface

contains

  !> Is a problem of a kind that `sum_records` has?
  pure logical function have_records(kind)
    integer, intent(in) :: kind !! kind of problem

    have_records = any(kind == kinds)
  end function have_records

  !> Add the errors of a chunk of contacts to sums of which four places have their own.
  pure subroutine sum_records(problem, first, with_e1, lane, is_done, closing, bounds)
    type(problem_t), intent(in) :: problem !! problem of a kind that there is
    integer, intent(in) :: first !! first contact of the chunk
    logical, intent(in) :: with_e1 !! are e1 and the bound wanted too?
    real(wp), intent(inout), contiguous :: lane(:, :) !! sums to add to, as `sum_errors` has them
    logical, intent(out) :: is_done !! false, and nothing is added, where a law is another one
    real(wp), allocatable, intent(inout), optional :: closing(:) !! what determines the active set (sg_active_set)
    real(wp), allocatable, intent(inout), optional :: bounds(:) !! bounds of chunks [m2/s2]
    real(wp) :: parting(chunk), bound
    integer :: n
    integer(c_int) :: flag

    n = min(chunk, problem%n_contacts - first + 1)
    call measure_records(numbers(findloc(kinds, problem%kind, 1)), int(n, c_int), problem%pair(:, first), &
                         problem%record(:, first), problem%impulse(:, first), problem%body, &
                         merge(1_c_int, 0_c_int, with_e1), size(lane, 1, c_int), lane, parting, bound, flag)
    is_done = flag > 0
    if (.not. is_done) return
    if (present(closing)) closing(first:first + n - 1) = parting(:n)
    if (with_e1 .and. present(bounds)) bounds((first + chunk - 1)/chunk) = bound
  end subroutine sum_records
end module sg_error_records
