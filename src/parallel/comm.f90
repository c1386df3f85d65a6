!> Communication between ranks: the few operations that the program needs, without naming a library.
!!
!! Messages are reals: whole numbers up to 2^53 travel in them exactly. The bodies live in one of two submodules, chosen
!! by CMake: `comm_with_mpi` and `comm_without_mpi`; with `exchange_with_mpi` they are all that names MPI. All operations
!! but those said otherwise are collective: every rank calls them, in the same order.
module sg_comm
  use sg_error, only: error_t
  use sg_kinds, only: wp, i8
  implicit none
  private
  public :: comm_t, traffic_t

  !> What a rank has sent and how long it has waited since its start
  type :: traffic_t
    !> Messages to single ranks, and their bytes
    integer(i8) :: messages = 0, bytes = 0
    !> Collective operations
    integer(i8) :: collectives = 0
    !> Wall seconds spent in waiting for others
    real(wp) :: wait_seconds = 0
  end type traffic_t

  !> A group of ranks that work on one scene
  type :: comm_t
    !> This rank, from 0, and the number of ranks
    integer :: rank = 0, size = 1
    !> Messages, bytes and waiting so far
    type(traffic_t) :: traffic
    !> Handle of a reduction that is under way, and what it works on
    integer, private :: request = 0
    real(wp), allocatable, private :: sending(:), receiving(:)
  contains
    procedure :: start => comm_start
    procedure :: finish => comm_finish
    procedure :: abort => comm_abort
    procedure, nopass :: library => comm_library
    procedure, nopass :: handle => comm_handle
    procedure, nopass :: no_hints => comm_no_hints
    procedure :: ranks_here => comm_ranks_here
    procedure :: sum => comm_sum
    procedure :: maximum => comm_maximum
    procedure :: minimum => comm_minimum
    procedure :: any => comm_any
    procedure :: agree => comm_agree
    procedure :: begin_sum => comm_begin_sum
    procedure :: finish_sum => comm_finish_sum
    procedure :: gather => comm_gather
    procedure :: before => comm_before
    procedure :: swap => comm_swap
  end type comm_t

  interface
    !> Join the ranks; without a launcher, or alone under one, this is one rank and no library is started.
    module subroutine comm_start(self)
      class(comm_t), intent(inout) :: self
    end subroutine comm_start
    !> Leave the ranks in good order.
    module subroutine comm_finish(self)
      class(comm_t), intent(inout) :: self
    end subroutine comm_finish
    !> End all ranks at once with an exit code; not collective.
    module subroutine comm_abort(self, code)
      class(comm_t), intent(inout) :: self
      integer, intent(in) :: code !! exit code
    end subroutine comm_abort
    !> Name and version of the library, empty without one.
    module function comm_library() result(name)
      character(len=:), allocatable :: name
    end function comm_library
    !> Handle of the group of ranks, for libraries that communicate themselves (parallel HDF5).
    module function comm_handle() result(handle)
      integer :: handle
    end function comm_handle
    !> Handle of no hints, which such libraries also ask for.
    module function comm_no_hints() result(handle)
      integer :: handle
    end function comm_no_hints

    !> Number of ranks on this machine, this one included.
    module integer function comm_ranks_here(self)
      class(comm_t), intent(in) :: self
    end function comm_ranks_here

    !> Replace each value by its sum over the ranks, the same on all.
    module subroutine comm_sum(self, values)
      class(comm_t), intent(inout) :: self
      real(wp), intent(inout) :: values(:) !! summands of this rank, then sums
    end subroutine comm_sum
    !> Replace each value by the largest of the ranks.
    module subroutine comm_maximum(self, values)
      class(comm_t), intent(inout) :: self
      real(wp), intent(inout) :: values(:) !! values of this rank, then the largest
    end subroutine comm_maximum
    !> Replace each value by the smallest of the ranks.
    module subroutine comm_minimum(self, values)
      class(comm_t), intent(inout) :: self
      real(wp), intent(inout) :: values(:) !! values of this rank, then the smallest
    end subroutine comm_minimum
    !> Does any rank say yes?
    module logical function comm_any(self, is_so)
      class(comm_t), intent(inout) :: self
      logical, intent(in) :: is_so !! what this rank says
    end function comm_any
    !> Share an error: afterwards all ranks have one if any had, and the lowest rank that had one is `speaker`.
    module subroutine comm_agree(self, error, speaker)
      class(comm_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error !! of this rank; of the speaker afterwards
      integer, intent(out) :: speaker !! rank that had the error first, -1 where all is well
    end subroutine comm_agree

    !> Begin to sum over the ranks; nothing else may be begun before it is finished, but other operations may go on.
    module subroutine comm_begin_sum(self, values)
      class(comm_t), intent(inout) :: self
      real(wp), intent(in) :: values(:) !! summands of this rank
    end subroutine comm_begin_sum
    !> Finish the sum that was begun.
    module subroutine comm_finish_sum(self, values)
      class(comm_t), intent(inout) :: self
      real(wp), intent(out) :: values(:) !! sums, of the size that was begun
    end subroutine comm_finish_sum

    !> What every rank has to say, side by side: shape (size(own), ranks).
    module subroutine comm_gather(self, own, all)
      class(comm_t), intent(inout) :: self
      real(wp), intent(in) :: own(:) !! of this rank, of one size on all
      real(wp), allocatable, intent(out) :: all(:, :) !! of all ranks, column r + 1 for rank r
    end subroutine comm_gather
    !> Sum over the ranks below this one, and over all.
    module subroutine comm_before(self, own, before, total)
      class(comm_t), intent(inout) :: self
      integer(i8), intent(in) :: own !! of this rank
      integer(i8), intent(out) :: before !! sum over lower ranks
      integer(i8), intent(out) :: total !! sum over all ranks
    end subroutine comm_before
    !> Send to every rank its part of a list, and receive from every rank: parts stand in the order of ranks.
    module subroutine comm_swap(self, send, send_count, receive, receive_count)
      class(comm_t), intent(inout) :: self
      real(wp), intent(in) :: send(:) !! parts one after the other
      integer, intent(in) :: send_count(0:) !! reals for each rank, shape (0:size-1)
      real(wp), allocatable, intent(out) :: receive(:) !! parts one after the other
      integer, allocatable, intent(out) :: receive_count(:) !! reals from each rank, shape (0:size-1)
    end subroutine comm_swap
  end interface
end module sg_comm
