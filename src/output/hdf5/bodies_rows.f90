!> The bodies of a decomposed scene in the order of their numbers: each rank gets the block of rows that it writes to files.
module sg_bodies_rows
  use sg_bodies, only: bodies_t, drop_rotation_as
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_failure, fail
  use sg_kinds, only: wp, i4
  use sg_rows, only: rows_t
  implicit none
  private
  public :: order_bodies

contains

  !> Bring what files hold of the bodies at home into blocks of numbers.
  subroutine order_bodies(bodies, comm, rows, ordered, error)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank, at home and copies
    type(comm_t), intent(inout) :: comm !! the ranks
    type(rows_t), intent(inout) :: rows !! the plan, rebuilt
    type(bodies_t), intent(out) :: ordered !! bodies of the block: state, mass, area, material, number, home
    type(error_t), allocatable, intent(out) :: error !! set when a body has no home or several
    real(wp), allocatable :: values(:, :)
    integer(i4), allocatable :: number(:)
    integer :: i, n, total

    n = bodies%n_home
    total = n
    call comm%sum(total)
    if (allocated(bodies%id)) then
      number = bodies%id(:n)
    else
      number = [(int(i, i4), i=1, n)]
    end if
    call rows%plan(comm, number, total)
    if (.not. rows%is_complete) then
      call fail(error, 'a body has no home or several: the scene is not whole', code=exit_failure)
      return
    end if
    call rows%order(comm, packed(bodies, n), values)
    call ordered%allocate(rows%n, bodies%dimension)
    call drop_rotation_as(bodies, ordered)
    ordered%id = [(int(rows%first + i, i4), i=1, rows%n)]
    call unpack_bodies(values, ordered)
  end subroutine order_bodies

  !> Numbers of the bodies at home, a column a body.
  pure function packed(bodies, n) result(values)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: n
    real(wp), allocatable :: values(:, :)
    integer :: d, m, at

    d = bodies%dimension
    m = bodies%n_velocity
    allocate (values(d + m + 11, n), source=0.0_wp)
    values(:d, :) = bodies%position(:, :n)
    values(d + 1:d + m, :) = bodies%velocity(:, :n)
    at = d + m
    if (allocated(bodies%angle)) values(at + 1, :) = bodies%angle(:n)
    if (allocated(bodies%orientation)) values(at + 1:at + 4, :) = bodies%orientation(:, :n)
    values(at + 5, :) = real(bodies%crossings(:n), wp)
    if (allocated(bodies%crossings_y)) values(at + 6, :) = real(bodies%crossings_y(:n), wp)
    values(at + 7, :) = bodies%mass(:n)
    values(at + 8, :) = bodies%area(:n)
    values(at + 9, :) = real(bodies%material(:n), wp)
    values(at + 10, :) = merge(1.0_wp, 0.0_wp, bodies%is_grain(:n))
    if (allocated(bodies%home)) values(at + 11, :) = real(bodies%home(:n), wp)
  end function packed

  !> The same back.
  pure subroutine unpack_bodies(values, bodies)
    real(wp), intent(in) :: values(:, :)
    type(bodies_t), intent(inout) :: bodies
    integer :: d, at

    d = bodies%dimension
    at = d + bodies%n_velocity
    bodies%position = values(:d, :)
    bodies%velocity = values(d + 1:at, :)
    if (allocated(bodies%angle)) bodies%angle = values(at + 1, :)
    if (allocated(bodies%orientation)) bodies%orientation = values(at + 1:at + 4, :)
    bodies%crossings = nint(values(at + 5, :), i4)
    if (allocated(bodies%crossings_y)) bodies%crossings_y = nint(values(at + 6, :), i4)
    bodies%mass = values(at + 7, :)
    bodies%area = values(at + 8, :)
    bodies%material = nint(values(at + 9, :), i4)
    bodies%is_grain = values(at + 10, :) > 0.5_wp
    bodies%home = nint(values(at + 11, :), i4)
  end subroutine unpack_bodies
end module sg_bodies_rows
