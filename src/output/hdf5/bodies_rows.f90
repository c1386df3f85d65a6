!> The bodies of a decomposed scene in the order of their numbers: each rank gets the block of rows that it writes to files.
module sg_bodies_rows
  use sg_block_distribution, only: block_distribution_t
  use sg_bodies, only: bodies_t, make_bodies_like
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_failure, fail
  use sg_field_visitor, only: sync_on_owner
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: order_bodies

contains

  !> Bring what files hold of the rank's own bodies into blocks of numbers.
  subroutine order_bodies(bodies, comm, rows, ordered, error)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank, own ones and copies
    type(comm_t), intent(inout) :: comm !! the ranks
    type(block_distribution_t), intent(inout) :: rows !! the plan, rebuilt
    type(bodies_t), intent(out) :: ordered !! bodies of the block
    type(error_t), allocatable, intent(out) :: error !! set when a body has no owner or several
    real(wp), allocatable :: values(:, :), block(:, :)
    integer(i4), allocatable :: number(:)
    integer :: i, n, total

    n = bodies%n_own
    total = n
    call comm%sum(total)
    if (allocated(bodies%id)) then
      number = bodies%id(:n)
    else
      number = [(int(i, i4), i=1, n)]
    end if
    call rows%plan(comm, number, total)
    if (.not. rows%is_complete) then
      call fail(error, 'a body has no owner or several: the scene is not whole', code=exit_failure)
      return
    end if
    call bodies%pack([(int(i, i4), i=1, n)], values, sync_on_owner)
    call rows%order(comm, values, block)
    call make_bodies_like(bodies, rows%n, ordered)
    call ordered%unpack([(int(i, i4), i=1, rows%n)], block, sync_on_owner)
    ordered%id(:) = [(int(rows%first + i, i4), i=1, rows%n)]
    if (allocated(bodies%owner)) call rows%order(comm, bodies%owner(:n), ordered%owner)
  end subroutine order_bodies
end module sg_bodies_rows
