!> A small test harness: checks are counted, failures printed, and the last line is `N passed, N failed`.
module harness
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: tests_t

  !> The checks of one test program
  type :: tests_t
    integer :: passed = 0, failed = 0
  contains
    procedure :: check => tests_check
    procedure :: near => tests_near
    procedure :: equal => tests_equal
    procedure :: finish => tests_finish
  end type tests_t

contains

  !> Check that something holds.
  subroutine tests_check(self, holds, what)
    class(tests_t), intent(inout) :: self
    logical, intent(in) :: holds !! what must be true
    character(len=*), intent(in) :: what !! said when it is not

    if (holds) then
      self%passed = self%passed + 1
    else
      self%failed = self%failed + 1
      write (*, '(a)') 'FAILED: '//what
    end if
  end subroutine tests_check

  !> Check that a number is within a tolerance of its expected value.
  subroutine tests_near(self, got, expected, tolerance, what)
    class(tests_t), intent(inout) :: self
    real(wp), intent(in) :: got !! the number found
    real(wp), intent(in) :: expected !! the number wanted
    real(wp), intent(in) :: tolerance !! largest difference allowed
    character(len=*), intent(in) :: what !! said when it is too far
    character(len=120) :: numbers

    write (numbers, '(a,es23.16,a,es23.16,a,es9.2)') ': got ', got, ', expected ', expected, ' within ', tolerance
    call self%check(ieee_is_finite(got) .and. abs(got - expected) <= tolerance, what//trim(numbers))
  end subroutine tests_near

  !> Check that two whole numbers are the same.
  subroutine tests_equal(self, got, expected, what)
    class(tests_t), intent(inout) :: self
    integer, intent(in) :: got !! the number found
    integer, intent(in) :: expected !! the number wanted
    character(len=*), intent(in) :: what !! said when they differ
    character(len=60) :: numbers

    write (numbers, '(a,i0,a,i0)') ': got ', got, ', expected ', expected
    call self%check(got == expected, what//trim(numbers))
  end subroutine tests_equal

  !> Print the count; end with code 1 when a check failed or none was made. Of several ranks the first one prints the sums.
  subroutine tests_finish(self, comm)
    class(tests_t), intent(in) :: self
    type(comm_t), intent(inout), optional :: comm !! the ranks of a parallel test, which end here
    real(wp) :: counts(2)
    integer :: rank

    counts = real([self%passed, self%failed], wp)
    rank = 0
    if (present(comm)) then
      rank = comm%rank
      call comm%sum(counts)
      call comm%finish()
    end if
    if (rank == 0) write (*, '(i0,a,i0,a)') nint(counts(1)), ' passed, ', nint(counts(2)), ' failed'
    if (nint(counts(2)) > 0 .or. nint(counts(1)) == 0) error stop 1
  end subroutine tests_finish
end module harness
