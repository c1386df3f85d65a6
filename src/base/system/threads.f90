!> Threads by which the work of a process is shared, where it was built with OpenMP. Files with OpenMP's directives are named in
!! cmake/libraries.cmake; without it the directives are comments.
!!
!! A run has one team of threads. A loop that they share is cut into pieces: the first thread takes pieces from the front, others
!! take them from the back, until none is left. So a thread meets the same items in one loop after the other, which its caches hold,
!! and one that has no processor just now takes none, and none waits for it (doc/theory/threads.md). A loop looks like this:
!!
!!     call begin_share(share, n, least)
!!     !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
!!     do t = 1, n_sharing()
!!       do while (takes(share, piece))
!!         call kernel(piece%first, piece%last, ...)
!!       end do
!!     end do
!!
!! Any thread may run several of its tasks, the first thread runs a loop of one piece. What a kernel writes belongs to its items, so
!! that results are the same bit for bit; sums are made over chunks of fixed size.
module sg_threads
  !$ use omp_lib, only: omp_get_num_threads, omp_get_thread_num, omp_in_parallel
  use sg_kinds, only: i8
  implicit none
  private
  public :: begin_share, is_first_thread, is_in_team, n_sharing, piece_t, share_t, takes, threads_are_available

  !> Pieces per thread: enough that threads end together though they take pieces at different rates
  integer, parameter :: pieces_per_thread = 8

  !> Items of a loop that threads share
  type :: share_t
    !> Items, pieces, and pieces that are left: after the first `front`, up to `back`
    integer :: n = 0, pieces = 1
    integer, private :: front = 0, back = 1
  end type share_t

  !> A piece: its number, and its first and last item
  type :: piece_t
    integer :: number = 0, first = 1, last = 0
  end type piece_t

contains

  !> Can this program use more than one thread?
  pure logical function threads_are_available() result(is_available)
    is_available = .false.
    !$ is_available = .true.
  end function threads_are_available

  !> Does a team of several threads share the work?
  logical function is_in_team()
    is_in_team = .false.
    !$ is_in_team = omp_in_parallel()
  end function is_in_team

  !> Is this the thread that takes pieces from the front?
  logical function is_first_thread()
    is_first_thread = .true.
    !$ is_first_thread = omp_get_thread_num() == 0
  end function is_first_thread

  !> Threads that share the work.
  integer function n_sharing()
    n_sharing = 1
    !$ n_sharing = omp_get_num_threads()
  end function n_sharing

  !> Begin a loop that threads share: one piece where there is one thread, or few items.
  subroutine begin_share(share, n, least)
    type(share_t), intent(out) :: share !! the loop
    integer, intent(in) :: n !! items
    integer, intent(in) :: least !! items of a piece, at least: such as take some ten microseconds

    share%n = n
    if (is_in_team()) share%pieces = max(1, min(n/least, pieces_per_thread*n_sharing()))
    share%back = share%pieces
  end subroutine begin_share

  !> Take a piece of a loop, if one is left.
  logical function takes(share, piece)
    type(share_t), intent(inout) :: share !! the loop
    type(piece_t), intent(out) :: piece !! the piece

    !$omp critical (pieces)
    takes = share%front < share%back
    if (takes) then
      if (is_first_thread()) then
        share%front = share%front + 1
        piece%number = share%front
      else
        piece%number = share%back
        share%back = share%back - 1
      end if
    end if
    !$omp end critical (pieces)
    if (.not. takes) return
    piece%first = end_of_piece(piece%number - 1, share) + 1
    piece%last = end_of_piece(piece%number, share)
  end function takes

  !> Last item of a piece; piece 0 ends at 0.
  pure integer function end_of_piece(piece, share)
    integer, intent(in) :: piece
    type(share_t), intent(in) :: share

    end_of_piece = int(int(share%n, i8)*int(piece, i8)/int(share%pieces, i8))
  end function end_of_piece
end module sg_threads
