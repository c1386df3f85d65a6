!> Tests on several subdomains of one process: no messages between processes, and what subdomains share is made once.
!!
!! Checks take what differs between subdomains from `comm`. Variables of a test program are common to all of them.
module subdomain_tests
  use sg_comm, only: comm_t
  use sg_subdomain_runs, only: run_subdomains, subdomain_program_t
  implicit none
  private
  public :: on_subdomains

  abstract interface
    !> Checks of one of several subdomains.
    subroutine checks(comm)
      import :: comm_t
      type(comm_t), intent(inout) :: comm !! the subdomains, as ranks
    end subroutine checks
  end interface

  !> A program that consists of checks
  type, extends(subdomain_program_t) :: checks_t
    procedure(checks), pointer, nopass :: checks => null()
  contains
    procedure :: run => run_checks
  end type checks_t

contains

  !> Run checks as each of several subdomains of this process: once for each number of subdomains in the arguments of the program,
  !! by default for 1 to 4.
  subroutine on_subdomains(run)
    procedure(checks) :: run !! checks of a subdomain
    integer, allocatable :: numbers(:)
    type(checks_t) :: program
    type(comm_t) :: process
    character(len=8) :: argument
    integer :: i

    numbers = [1, 2, 3, 4]
    if (command_argument_count() > 0) numbers = [(0, i=1, command_argument_count())]
    do i = 1, command_argument_count()
      call get_command_argument(i, argument)
      read (argument, *) numbers(i)
    end do
    program%checks => run
    do i = 1, size(numbers)
      call run_subdomains(program, numbers(i), process)
    end do
  end subroutine on_subdomains

  !> Run the checks.
  subroutine run_checks(self, comm)
    class(checks_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the subdomains, as ranks
    type(comm_t) :: own

    own = comm
    call self%checks(own)
  end subroutine run_checks
end module subdomain_tests
