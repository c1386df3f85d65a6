!> Communication between ranks: the few operations that the program needs, without naming a library.
!!
!! The bodies live in one of two submodules, chosen by CMake: `comm_with_mpi` (the only file that names MPI)
!! and `comm_without_mpi`.
module sg_comm
  use sg_kinds, only: wp
  implicit none
  private
  public :: comm_t

  !> A group of ranks that work on one scene
  type :: comm_t
    !> This rank, from 0, and the number of ranks
    integer :: rank = 0, size = 1
  contains
    procedure :: start => comm_start
    procedure :: finish => comm_finish
    procedure :: abort => comm_abort
    procedure, nopass :: library => comm_library
  end type comm_t

  interface
    !> Join the ranks; without a launcher this is one rank and no library is started.
    module subroutine comm_start(self)
      class(comm_t), intent(inout) :: self
    end subroutine comm_start
    !> Leave the ranks in good order.
    module subroutine comm_finish(self)
      class(comm_t), intent(inout) :: self
    end subroutine comm_finish
    !> End all ranks at once with an exit code.
    module subroutine comm_abort(self, code)
      class(comm_t), intent(inout) :: self
      integer, intent(in) :: code !! exit code
    end subroutine comm_abort
    !> Name and version of the library, empty without one.
    module function comm_library() result(name)
      character(len=:), allocatable :: name
    end function comm_library
  end interface
end module sg_comm
