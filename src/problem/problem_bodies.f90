!> Records of the bodies of a contact problem: velocities and inverse masses by slot, and velocities back to the bodies
!! (doc/theory/contact_problem.md).
module sg_problem_bodies
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sg_bodies, only: bodies_t
  use sg_gap_laws, only: has_driven_spin
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_records, only: arm_frictional, arm_frictionless, arm_inverse_i, arm_inverse_mx, arm_spin, ball_frictional, &
                        ball_frictionless, ball_frictionless_inverse_mx, ball_frictionless_inverse_mz, body_length, &
                        first_inverse, is_compact, is_in_space, plain_kind, round_frictional, round_frictionless, &
                        round_frictionless_inverse_mx, round_frictionless_inverse_my, round_inverse_i, round_inverse_mx, &
                        round_inverse_my, round_spin, solid_inverse_mx, solid_inverse_mz, solid_inverse_xx, &
                        solid_inverse_yz, solid_spin_x, solid_spin_z, velocity_x, velocity_y, velocity_z
  use sg_rotations, only: frame_of, turned_back, turned_by
  use sg_threads, only: begin_share, n_sharing, piece_t, share_t, takes
  implicit none
  private
  public :: fastest_of, find_movable, load_bodies, take_velocities

  !> Least bodies of a piece, and those that are loaded at once
  integer, parameter :: least_bodies = 512, chunk = 256

  interface
    !> Records of balls with friction, four at a time (ball_bodies.cpp).
    pure subroutine load_balls(n, body_of, radius, middle, free_velocity, inverse_mass, body) bind(c, name='sg_load_balls')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n !! slots
      integer(c_int), intent(in) :: body_of(*) !! body of each slot
      real(c_double), intent(in) :: radius(*), middle(*), free_velocity(*), inverse_mass(*)
      real(c_double), intent(inout) :: body(*) !! records to fill
    end subroutine load_balls

    !> Their velocities back to the bodies.
    pure subroutine unload_balls(n, body_of, radius, middle, body, free_velocity) bind(c, name='sg_unload_balls')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: body_of(*)
      real(c_double), intent(in) :: radius(*), middle(*), body(*)
      real(c_double), intent(inout) :: free_velocity(*) !! velocities that are set
    end subroutine unload_balls
  end interface

contains

  !> Free velocities and inverse masses by slot.
  subroutine load_bodies(bodies, kind, body_of, radius, body, moves, fastest, drives_spin)
    type(bodies_t), intent(in) :: bodies !! bodies with their free velocities
    integer, intent(in) :: kind !! kind of problem
    integer(i4), intent(in), contiguous :: body_of(:) !! body of each slot
    real(wp), intent(in), contiguous :: radius(:) !! radius of round bodies [m]
    real(wp), intent(inout), contiguous :: body(:, :) !! records to fill
    logical, allocatable, intent(inout), optional :: moves(:) !! can impulses move each of the bodies?
    real(wp), intent(out), optional :: fastest !! largest component of their velocities [m/s], with `moves`
    logical, intent(out), optional :: drives_spin !! has a round body a driven spin? With `moves`
    real(wp), allocatable :: found(:)
    logical, allocatable :: spins(:)
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: t, a, z

    if (present(moves)) then
      if (allocated(moves)) then
        if (size(moves) /= size(body_of)) deallocate (moves)
      end if
      if (.not. allocated(moves)) allocate (moves(size(body_of)))
    end if
    allocate (found(n_sharing()), source=0.0_wp)
    allocate (spins(n_sharing()), source=.false.)
    call begin_share(share, size(body_of), least_bodies)
    !$omp taskloop default(shared) private(t, a, z, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        ! Marks are set, the fastest body is found, and driven spins are, while records are in the first cache.
        do a = piece%first, piece%last, chunk
          z = min(piece%last, a + chunk - 1)
          if (is_in_space(kind)) then
            call load_space_bodies(bodies, kind, body_of(a:z), radius, body(:, a:z))
          else
            call load_plane_bodies(bodies, kind, body_of(a:z), radius, body(:, a:z))
          end if
          if (.not. present(moves)) cycle
          call find_movable(z - a + 1, body_length(kind), first_inverse(kind), body(:, a:z), moves(a:z))
          found(t) = max(found(t), fastest_of(z - a + 1, kind, body(:, a:z)))
          if (is_compact(kind) .and. .not. spins(t)) spins(t) = has_driven_spin(bodies, bodies%free_velocity, body_of(a:z))
        end do
      end do
    end do
    if (present(fastest)) fastest = maxval(found)
    if (present(drives_spin)) drives_spin = any(spins)
  end subroutine load_bodies

  !> Largest component of the velocities of bodies [m/s].
  pure real(wp) function fastest_of(n, kind, body) result(fastest)
    integer, intent(in) :: n !! bodies
    integer, intent(in) :: kind !! kind of their problem
    real(wp), intent(in) :: body(body_length(kind), n) !! records
    integer :: last, b

    fastest = 0
    last = merge(velocity_z, velocity_y, is_in_space(kind))
    do b = 1, n
      fastest = max(fastest, max(abs(body(velocity_x, b)), abs(body(velocity_y, b)), abs(body(last, b))))
    end do
  end function fastest_of

  !> Mark the bodies that impulses can move.
  pure subroutine find_movable(n, length, inverse, body, moves)
    integer, intent(in) :: n !! bodies
    integer, intent(in) :: length !! of a record
    integer, intent(in) :: inverse !! place of the first inverse mass in it
    real(wp), intent(in) :: body(length, n) !! records
    logical, intent(out) :: moves(n) !! the marks
    integer :: b

    do b = 1, n
      moves(b) = body(inverse, b) > 0
      if (.not. moves(b)) moves(b) = any(body(inverse + 1:, b) > 0)
    end do
  end subroutine find_movable

  !> Those of bodies in the plane.
  pure subroutine load_plane_bodies(bodies, kind, body_of, radius, body)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: kind
    integer(i4), intent(in), contiguous :: body_of(:)
    real(wp), intent(in), contiguous :: radius(:)
    real(wp), intent(inout), contiguous :: body(:, :)
    integer :: s, b

    select case (kind)
    case (round_frictionless)
      do s = 1, size(body_of)
        b = body_of(s)
        body(velocity_x:velocity_y, s) = bodies%free_velocity(1:2, b)
        body(round_frictionless_inverse_mx:round_frictionless_inverse_my, s) = bodies%inverse_mass(1:2, b)
      end do
    case (round_frictional)
      call load_disks(size(body_of), bodies%n, body_of, radius, bodies%free_velocity, bodies%inverse_mass, body)
    case default
      do s = 1, size(body_of)
        b = body_of(s)
        body(velocity_x:velocity_y, s) = bodies%free_velocity(1:2, b)
        body(arm_spin, s) = bodies%free_velocity(3, b)
        body(arm_inverse_mx:arm_inverse_i, s) = bodies%inverse_mass(1:3, b)
      end do
    end select
  end subroutine load_plane_bodies

  !> Those of disks with friction, on plain arrays.
  pure subroutine load_disks(n_slots, n, body_of, radius, free_velocity, inverse_mass, body)
    integer, intent(in) :: n_slots, n
    integer(i4), intent(in) :: body_of(n_slots)
    real(wp), intent(in) :: radius(n), free_velocity(3, n), inverse_mass(3, n)
    real(wp), intent(inout) :: body(body_length(round_frictional), n_slots)
    integer :: s

    do s = 1, n_slots
      associate (b => body_of(s))
        body(velocity_x, s) = free_velocity(1, b)
        body(velocity_y, s) = free_velocity(2, b)
        body(round_spin, s) = radius(b)*free_velocity(3, b)
        body(round_inverse_mx, s) = inverse_mass(1, b)
        body(round_inverse_my, s) = inverse_mass(2, b)
        body(round_inverse_i, s) = radius(b)**2*inverse_mass(3, b)
      end associate
    end do
  end subroutine load_disks

  !> Those of bodies in space.
  pure subroutine load_space_bodies(bodies, kind, body_of, radius, body)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: kind
    integer(i4), intent(in), contiguous :: body_of(:)
    real(wp), intent(in), contiguous :: radius(:)
    real(wp), intent(inout), contiguous :: body(:, :)
    real(wp) :: frame(3, 3), inverse(3, 3)
    integer :: s, b, i

    if (kind == ball_frictional) then
      call load_balls(size(body_of, kind=c_int), body_of, radius, bodies%middle, bodies%free_velocity, bodies%inverse_mass, body)
      return
    end if
    do s = 1, size(body_of)
      b = body_of(s)
      body(velocity_x:velocity_z, s) = bodies%free_velocity(1:3, b)
      if (kind == ball_frictionless) then
        body(ball_frictionless_inverse_mx:ball_frictionless_inverse_mz, s) = bodies%inverse_mass(1:3, b)
        cycle
      end if
      body(solid_inverse_mx:solid_inverse_mz, s) = bodies%inverse_mass(1:3, b)
      body(solid_spin_x:solid_spin_z, s) = turned_by(bodies%middle(4:7, b), bodies%free_velocity(4:6, b))
      frame = frame_of(bodies%middle(4:7, b))
      do i = 1, 3
        inverse(:, i) = matmul(frame, bodies%inverse_mass(4:6, b)*frame(i, :))
      end do
      body(solid_inverse_xx:solid_inverse_yz, s) = [inverse(1, 1), inverse(2, 2), inverse(3, 3), inverse(1, 2), inverse(1, 3), &
                                                    inverse(2, 3)]
      body(solid_inverse_yz + 1:, s) = 0
    end do
  end subroutine load_space_bodies

  !> Velocities of the solution back to the bodies (into `free_velocity`).
  subroutine take_velocities(problem, body_of, radius, bodies)
    type(problem_t), intent(in) :: problem !! solved problem
    integer(i4), intent(in), contiguous :: body_of(:) !! body of each slot
    real(wp), intent(in), contiguous :: radius(:) !! as in `load_bodies`
    type(bodies_t), intent(inout) :: bodies !! bodies that move on

    type(share_t) :: share
    type(piece_t) :: piece
    integer :: t

    call begin_share(share, problem%n_bodies, least_bodies)
    !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        associate (a => piece%first, z => piece%last)
          if (is_in_space(problem%kind)) then
            call unload_space_bodies(problem%kind, body_of(a:z), radius, problem%body(:, a:z), bodies)
          else
            call unload_plane_bodies(problem%kind, body_of(a:z), radius, problem%body(:, a:z), bodies)
          end if
        end associate
      end do
    end do
  end subroutine take_velocities

  !> Those of bodies in the plane.
  pure subroutine unload_plane_bodies(kind, body_of, radius, body, bodies)
    integer, intent(in) :: kind
    integer(i4), intent(in), contiguous :: body_of(:)
    real(wp), intent(in), contiguous :: radius(:), body(:, :)
    type(bodies_t), intent(inout) :: bodies
    integer :: s

    select case (plain_kind(kind))
    case (round_frictional)
      call unload_disks(size(body_of), bodies%n, body_of, radius, bodies%inverse_mass, body, bodies%free_velocity)
    case (arm_frictional, arm_frictionless)
      do s = 1, size(body_of)
        bodies%free_velocity(1:2, body_of(s)) = body(velocity_x:velocity_y, s)
        bodies%free_velocity(3, body_of(s)) = body(arm_spin, s)
      end do
    case default
      do s = 1, size(body_of)
        bodies%free_velocity(1:2, body_of(s)) = body(velocity_x:velocity_y, s)
      end do
    end select
  end subroutine unload_plane_bodies

  !> Those of disks with friction, on plain arrays.
  pure subroutine unload_disks(n_slots, n, body_of, radius, inverse_mass, body, free_velocity)
    integer, intent(in) :: n_slots, n
    integer(i4), intent(in) :: body_of(n_slots)
    real(wp), intent(in) :: radius(n), inverse_mass(3, n), body(body_length(round_frictional), n_slots)
    real(wp), intent(inout) :: free_velocity(3, n)
    integer :: s

    do s = 1, n_slots
      associate (b => body_of(s))
        free_velocity(1, b) = body(velocity_x, s)
        free_velocity(2, b) = body(velocity_y, s)
        if (inverse_mass(3, b) > 0) free_velocity(3, b) = body(round_spin, s)/radius(b)
      end associate
    end do
  end subroutine unload_disks

  !> Those of bodies in space.
  pure subroutine unload_space_bodies(kind, body_of, radius, body, bodies)
    integer, intent(in) :: kind
    integer(i4), intent(in), contiguous :: body_of(:)
    real(wp), intent(in), contiguous :: radius(:), body(:, :)
    type(bodies_t), intent(inout) :: bodies
    integer :: s, b

    if (plain_kind(kind) == ball_frictional) then
      call unload_balls(size(body_of, kind=c_int), body_of, radius, bodies%middle, body, bodies%free_velocity)
      return
    end if
    do s = 1, size(body_of)
      b = body_of(s)
      bodies%free_velocity(1:3, b) = body(velocity_x:velocity_z, s)
      if (plain_kind(kind) == ball_frictionless) cycle
      ! Driven components stay as they were given, to the last digit.
      bodies%free_velocity(4:6, b) = merge(turned_back(bodies%middle(4:7, b), body(solid_spin_x:solid_spin_z, s)), &
                                           bodies%free_velocity(4:6, b), bodies%inverse_mass(4:6, b) > 0)
    end do
  end subroutine unload_space_bodies
end module sg_problem_bodies
