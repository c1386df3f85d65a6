!> Ranks, and the few operations on reals and bytes that need a library of messages.
!!
!! The bodies are in one of two submodules, chosen by CMake: `ranks_with_mpi` and `ranks_without_mpi`; with
!! `exchange_with_mpi` they are all that names MPI. The program calls them through `comm_t` (sg_comm). All operations but
!! those marked otherwise are collective: every rank calls them, in the same order. One rank alone makes no call to the library.
module sg_ranks
  use sg_kinds, only: i1, i4, i8, wp
  implicit none
  private
  public :: ranks_t, traffic_t, by_sum, by_maximum, by_minimum, sum_of_test, sum_of_sweep

  !> Operations of a reduction
  integer, parameter :: by_sum = 1, by_maximum = 2, by_minimum = 3

  !> Sums that may be under way at once: of the errors of a test, and of the momentum of a sweep
  integer, parameter :: sum_of_test = 1, sum_of_sweep = 2

  !> A sum under way: its handle, summands and sums
  type :: pending_sum_t
    integer :: request = 0
    real(wp), allocatable :: sending(:), receiving(:)
  end type pending_sum_t

  !> Messages sent by a rank, and its time of waiting, since its start
  type :: traffic_t
    !> Messages to single ranks, and their bytes
    integer(i8) :: messages = 0, bytes = 0
    !> Collective operations
    integer(i8) :: collectives = 0
    !> Wall seconds spent in waiting for others
    real(wp) :: wait_seconds = 0
  end type traffic_t

  !> A group of ranks that work on one scene
  type :: ranks_t
    !> This rank, from 0, and the number of ranks
    integer :: rank = 0, size = 1
    !> Messages, bytes and waiting so far
    type(traffic_t) :: traffic
    type(pending_sum_t), private :: pending(2)
  contains
    procedure :: start => ranks_start
    procedure :: finish => ranks_finish
    procedure, nopass :: library => ranks_library
    procedure, nopass :: handle => ranks_handle
    procedure, nopass :: no_hints => ranks_no_hints
    procedure :: ranks_here => ranks_here
    procedure :: reduced_integers, reduced_longs, reduced_reals
    !> Values combined over the ranks, each with those in its place
    generic :: reduced => reduced_integers, reduced_longs, reduced_reals
    procedure :: of_root => bytes_of_root
    procedure :: side_by_side => bytes_side_by_side
    procedure :: begin_sum => ranks_begin_sum
    procedure :: finish_sum => ranks_finish_sum
    procedure :: swap => ranks_swap
    procedure :: collect => ranks_collect
  end type ranks_t

  interface
    !> Join the ranks; without a launcher, or alone under one, this is one rank and no library is started.
    module subroutine ranks_start(self)
      class(ranks_t), intent(inout) :: self
    end subroutine ranks_start
    !> Leave the ranks in good order.
    module subroutine ranks_finish(self)
      class(ranks_t), intent(inout) :: self
    end subroutine ranks_finish
    !> Name and version of the library, empty without one.
    module function ranks_library() result(name)
      character(len=:), allocatable :: name
    end function ranks_library
    !> Handle of the group of ranks, for libraries that communicate themselves (parallel HDF5).
    module function ranks_handle() result(handle)
      integer :: handle
    end function ranks_handle
    !> Handle of no hints, which such libraries also take.
    module function ranks_no_hints() result(handle)
      integer :: handle
    end function ranks_no_hints

    !> Number of ranks on this machine, this one included.
    module integer function ranks_here(self)
      class(ranks_t), intent(in) :: self
    end function ranks_here

    !> Integers combined over the ranks.
    module function reduced_integers(self, values, operation) result(reduced)
      class(ranks_t), intent(inout) :: self
      integer(i4), intent(in), contiguous :: values(:) !! values of this rank
      integer, intent(in) :: operation !! one of `by_*`
      integer(i4) :: reduced(size(values))
    end function reduced_integers
    !> Long integers combined over the ranks.
    module function reduced_longs(self, values, operation) result(reduced)
      class(ranks_t), intent(inout) :: self
      integer(i8), intent(in), contiguous :: values(:) !! values of this rank
      integer, intent(in) :: operation !! one of `by_*`
      integer(i8) :: reduced(size(values))
    end function reduced_longs
    !> Reals combined over the ranks.
    module function reduced_reals(self, values, operation) result(reduced)
      class(ranks_t), intent(inout) :: self
      real(wp), intent(in), contiguous :: values(:) !! values of this rank
      integer, intent(in) :: operation !! one of `by_*`
      real(wp) :: reduced(size(values))
    end function reduced_reals

    !> Bytes of the root rank.
    module function bytes_of_root(self, own, root) result(bytes)
      class(ranks_t), intent(inout) :: self
      integer(i1), intent(in), contiguous :: own(:) !! of this rank, as many on all
      integer, intent(in) :: root !! rank whose bytes all get
      integer(i1) :: bytes(size(own))
    end function bytes_of_root
    !> Bytes of all ranks side by side.
    module function bytes_side_by_side(self, own, length) result(bytes)
      class(ranks_t), intent(inout) :: self
      integer(i1), intent(in), contiguous :: own(:) !! of this rank
      integer, intent(in), contiguous :: length(:) !! number of bytes of each rank, shape (ranks)
      integer(i1) :: bytes(sum(length))
    end function bytes_side_by_side

    !> Begin to sum over the ranks, while other operations go on.
    module subroutine ranks_begin_sum(self, which, values)
      class(ranks_t), intent(inout) :: self
      integer, intent(in) :: which !! one of `sum_of_*`; not begun already
      real(wp), intent(in) :: values(:) !! summands of this rank
    end subroutine ranks_begin_sum
    !> Finish a sum that was begun.
    module subroutine ranks_finish_sum(self, which, values)
      class(ranks_t), intent(inout) :: self
      integer, intent(in) :: which !! the same
      real(wp), intent(out) :: values(:) !! sums, of the size that was begun
    end subroutine ranks_finish_sum

    !> Send to every rank its part of a list, and receive from every rank: parts are in the order of ranks.
    module subroutine ranks_swap(self, send, send_count, receive, receive_count)
      class(ranks_t), intent(inout) :: self
      real(wp), intent(in) :: send(:) !! parts one after the other
      integer, intent(in) :: send_count(0:) !! reals for each rank, shape (0:size-1)
      real(wp), allocatable, intent(out) :: receive(:) !! parts one after the other
      integer, allocatable, intent(out) :: receive_count(:) !! reals from each rank, shape (0:size-1)
    end subroutine ranks_swap
  end interface

contains

  !> Add the traffic that a copy of the group has counted; the copy counts from zero again.
  pure subroutine ranks_collect(self, copy)
    class(ranks_t), intent(inout) :: self
    class(ranks_t), intent(inout) :: copy !! the copy

    self%traffic%messages = self%traffic%messages + copy%traffic%messages
    self%traffic%bytes = self%traffic%bytes + copy%traffic%bytes
    self%traffic%collectives = self%traffic%collectives + copy%traffic%collectives
    self%traffic%wait_seconds = self%traffic%wait_seconds + copy%traffic%wait_seconds
    copy%traffic = traffic_t()
  end subroutine ranks_collect
end module sg_ranks
