!> Records of contacts whose laws look at gaps alone: one pass per kind of problem, without a call per contact
!! (doc/theory/contact_problem.md).
!!
!! Signorini's condition with Coulomb friction has no cohesion, compliance or bias along tangents. Values are those of
!! `put_contact` bit for bit: products stand in the order in which the compiler fuses them with sums there; blocks of solids are the
!! same to rounding.
!!
!! In a later substep (doc/theory/substeps.md) slots and impulses stay, and blocks where they may: those of disks do not depend on
!! the normal, unless a body is driven along one axis. Of solids the tangents turn with the normal, and the block stays that of the
!! first substep on them: sweeps find the same solution by any block, since they work with true relative velocities.
module sg_assemble_by_gaps
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int8_t
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: law_gap_g0, law_gap_shifted, law_iqs, law_iqs_g0
  use sg_mapping_space, only: tangent_of
  use sg_problem, only: problem_t
  use sg_records, only: arm_frictional, ball_frictional, body_length, normal_x, normal_y, normal_z, record_length, round_bias_n, &
                        round_bias_t, round_friction, round_frictional, round_inverse_i, round_inverse_mx, round_inverse_my, &
                        round_inverse_wnn, round_inverse_wtt, round_spin, solid_arm_ax, solid_arm_ay, solid_arm_az, solid_arm_cx, &
                        solid_arm_cy, solid_arm_cz, solid_bias_x, solid_bias_y, solid_bias_z, solid_friction, solid_frictional, &
                        solid_law, solid_spin_x, solid_spin_y, solid_spin_z, solid_tangent_x, solid_tangent_z, velocity_x, &
                        velocity_y, velocity_z
  use sg_scene, only: scene_t
  use sg_threads, only: begin_share, n_sharing, piece_t, share_t, takes
  implicit none
  private
  public :: assemble_by_gaps

  !> Contacts of a pass: what several loops need of them stays in the first cache
  integer, parameter :: chunk = 128
  !> Least chunks of a piece
  integer, parameter :: least_chunks = 8

  interface
    !> Records of contacts of disks, and their relative velocities, four at a time (gap_records.cpp).
    pure subroutine put_disks(n, pair, normal, bias, friction, body, record, velocity, opening) bind(c, name='sg_put_disk_records')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n !! contacts
      integer(c_int), intent(in) :: pair(*) !! their slots, shape (2, contacts)
      real(c_double), intent(in) :: normal(*), bias(*), friction(*), body(*)
      real(c_double), intent(inout) :: record(*) !! their records
      real(c_double), intent(inout) :: velocity(*) !! relative velocities without impulses, shape (3, contacts) [m/s]
      real(c_double), intent(inout) :: opening(*) !! their normal parts [m/s]
    end subroutine put_disks

    !> The same of contacts with lever arms in the plane.
    pure subroutine put_arms(n, n_middle, pair, body_of, normal, point, gap, image, middle, period, bias, friction, body, record, &
                             velocity, opening) bind(c, name='sg_put_arm_records')
      import :: c_double, c_int, c_int8_t
      integer(c_int), intent(in), value :: n, n_middle !! contacts; numbers that the place of a body has
      integer(c_int), intent(in) :: pair(*), body_of(*) !! slots and bodies
      real(c_double), intent(in) :: normal(*), point(*), gap(*)
      integer(c_int8_t), intent(in) :: image(*)
      real(c_double), intent(in) :: middle(*) !! places of bodies
      real(c_double), intent(in), value :: period
      real(c_double), intent(in) :: bias(*), friction(*), body(*)
      real(c_double), intent(inout) :: record(*), velocity(*), opening(*)
    end subroutine put_arms

    !> The same of balls.
    pure subroutine put_balls(n, pair, normal, bias, friction, body, record, velocity, opening) bind(c, name='sg_put_ball_records')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: pair(*)
      real(c_double), intent(in) :: normal(*), bias(*), friction(*), body(*)
      real(c_double), intent(inout) :: record(*), velocity(*), opening(*)
    end subroutine put_balls

    !> Blocks of contacts of solids, and their relative velocities, four at a time (solid_blocks.cpp).
    pure subroutine set_solid_blocks(n, pair, body, record, velocity, opening) bind(c, name='sg_set_solid_blocks')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n !! contacts
      integer(c_int), intent(in) :: pair(*) !! their slots, shape (2, contacts)
      real(c_double), intent(in) :: body(*) !! records of bodies
      real(c_double), intent(inout) :: record(*) !! records whose geometry, bias and friction are set, without compliance
      real(c_double), intent(inout) :: velocity(*) !! without impulses, in the world's axes, shape (3, contacts) [m/s]
      real(c_double), intent(inout) :: opening(*) !! their normal parts [m/s]
    end subroutine set_solid_blocks
  end interface

contains

  !> Fill a begun problem whose laws all look at the gap alone, or one of the same contacts a substep before; free norm, largest
  !! closing speed and friction are set.
  subroutine assemble_by_gaps(scene, slot_of, contacts, time_step, goes_on, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    integer(i4), intent(in), contiguous :: slot_of(:) !! slots of bodies
    type(contacts_t), intent(in) :: contacts !! contacts with the guess of their impulses
    real(wp), intent(in) :: time_step !! length of the step [s]
    logical, intent(in) :: goes_on !! are slots and impulses those of these contacts already, as the substep before left them?
    type(problem_t), intent(inout) :: problem !! its bodies are set; its contacts are set
    real(wp) :: squares((contacts%n + chunk - 1)/chunk)
    real(wp), allocatable :: closing_speed(:), most_friction(:)
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: t

    allocate (closing_speed(n_sharing()), most_friction(n_sharing()), source=0.0_wp)
    call begin_share(share, size(squares), least_chunks)
    !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        call assemble_chunks(scene, slot_of, contacts, time_step, goes_on, piece, problem, squares, closing_speed(t), &
                             most_friction(t))
      end do
    end do
    ! In the order of the chunks, whichever thread had them.
    problem%free_norm = sqrt(sum(squares))
    problem%closing_speed = maxval(closing_speed)
    problem%most_friction = maxval(most_friction)
  end subroutine assemble_by_gaps

  !> Fill some chunks of it.
  pure subroutine assemble_chunks(scene, slot_of, contacts, time_step, goes_on, piece, problem, squares, closing_speed, &
                                  most_friction)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in), contiguous :: slot_of(:)
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: time_step
    logical, intent(in) :: goes_on
    type(piece_t), intent(in) :: piece !! first and last chunk
    type(problem_t), intent(inout) :: problem
    real(wp), intent(inout) :: squares(:) !! squares of the free relative velocities of each chunk, added
    real(wp), intent(inout) :: closing_speed, most_friction !! largest ones so far
    real(wp) :: bias(chunk), friction(chunk), q(3, chunk), opening(chunk), fastest
    integer :: c, first, last, n

    fastest = closing_speed**2*(1 - 8*epsilon(1.0_wp))
    do c = piece%first, piece%last
      first = (c - 1)*chunk + 1
      last = min(contacts%n, c*chunk)
      n = last - first + 1
      call find_biases(scene, contacts, first, n, time_step, bias, friction)
      if (.not. goes_on) call put_pairs(slot_of, contacts, first, last, problem)
      associate (pair => problem%pair(:, first:last), record => problem%record(:, first:last), &
                 normal => contacts%normal(:, first:last))
        select case (problem%kind)
        case (round_frictional)
          if (goes_on) then
            call renew_disks(n, problem%n_bodies, pair, normal, bias, friction, problem%body, record, q, opening)
          else
            call put_disks(int(n, c_int), pair, normal, bias, friction, problem%body, record, q, opening)
          end if
        case (arm_frictional)
          call put_arms(int(n, c_int), size(scene%bodies%middle, 1, c_int), pair, contacts%body(:, first:last), normal, &
                        contacts%point(:, first:last), contacts%gap(first:last), contacts%image(first:last), &
                        scene%bodies%middle, scene%period, bias, friction, problem%body, record, q, opening)
        case (ball_frictional)
          call put_balls(int(n, c_int), pair, normal, bias, friction, problem%body, record, q, opening)
        case (solid_frictional)
          call assemble_solids(scene, contacts, first, n, bias, friction, goes_on, problem, q, opening)
        end select
      end associate
      problem%opening(first:last) = opening(:n)
      squares(c) = 0
      call add_free_velocities(n, q, opening, friction, squares(c), fastest, closing_speed, most_friction)
    end do
  end subroutine assemble_chunks

  !> Add the squares of free relative velocities of a chunk of contacts, and look for its largest closing speed and friction.
  pure subroutine add_free_velocities(n, q, opening, friction, squares, fastest, closing_speed, most_friction)
    integer, intent(in) :: n
    real(wp), intent(in) :: q(3, n), opening(n), friction(n)
    real(wp), intent(inout) :: squares, fastest, closing_speed, most_friction
    real(wp) :: square(chunk)
    integer :: i

    do i = 1, n
      square(i) = q(1, i)**2 + q(2, i)**2 + q(3, i)**2
    end do
    do i = 1, n
      squares = squares + square(i)
    end do
    if (count(friction > most_friction) > 0) most_friction = maxval(friction)
    if (count(opening < 0 .and. square(:n) >= fastest) == 0) return
    do i = 1, n
      ! The norm has divisions: it is taken where it may be the largest so far.
      if (.not. (opening(i) < 0 .and. square(i) >= fastest)) cycle
      closing_speed = max(closing_speed, norm2(q(:, i)))
      fastest = closing_speed**2*(1 - 8*epsilon(1.0_wp))
    end do
  end subroutine add_free_velocities

  !> Slots and impulses of a chunk of contacts.
  pure subroutine put_pairs(slot_of, contacts, first, last, problem)
    integer(i4), intent(in), contiguous :: slot_of(:)
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: first, last
    type(problem_t), intent(inout) :: problem
    integer :: k

    do k = first, last
      problem%pair(1, k) = slot_of(contacts%body(1, k))
      problem%pair(2, k) = slot_of(contacts%body(2, k))
      problem%impulse(:, k) = contacts%impulse(:, k)
    end do
  end subroutine put_pairs

  !> Normal biases [m/s] and friction of a chunk of contacts.
  pure subroutine find_biases(scene, contacts, first, n, time_step, bias, friction)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: first, n
    real(wp), intent(in) :: time_step
    real(wp), intent(out) :: bias(chunk), friction(chunk)
    real(wp) :: shift, lowest
    integer :: i, l, last

    i = 0
    do while (i < n)
      ! Contacts of one law stand side by side, mostly all of a chunk.
      l = contacts%law(first + i)
      last = i + 1
      do while (last < n)
        if (contacts%law(first + last) /= l) exit
        last = last + 1
      end do
      shift = merge(scene%laws(l)%gap_shift, 0.0_wp, scene%laws(l)%kind == law_gap_shifted)
      lowest = merge(0.0_wp, -huge(1.0_wp), any(scene%laws(l)%kind == [law_iqs, law_iqs_g0]))
      friction(i + 1:last) = scene%laws(l)%dynamic_friction
      bias(i + 1:last) = contacts%gap(first + i:first + last - 1) + shift
      if (any(scene%laws(l)%kind == [law_iqs_g0, law_gap_g0]) .and. contacts%n_internal > 0) &
        bias(i + 1:last) = bias(i + 1:last) - contacts%internal(1, first + i:first + last - 1)
      bias(i + 1:last) = max(lowest, bias(i + 1:last)/time_step)
      i = last
    end do
  end subroutine find_biases

  !> Those of disks in a later substep, whose blocks stay unless a body is driven along one axis.
  pure subroutine renew_disks(n, n_bodies, pair, normal, bias, friction, body, record, q, opening)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: normal(2, n), bias(n), friction(n)
    real(wp), intent(in) :: body(body_length(round_frictional), n_bodies)
    real(wp), intent(inout) :: record(record_length(round_frictional), n)
    real(wp), intent(inout) :: q(3, n), opening(n)
    real(wp) :: x, y, mx, my, w, w_t, w_nt
    integer :: i

    do i = 1, n
      associate (c => pair(1, i), a => pair(2, i))
        x = normal(1, i)
        y = normal(2, i)
        mx = body(round_inverse_mx, c) + body(round_inverse_mx, a)
        my = body(round_inverse_my, c) + body(round_inverse_my, a)
        record(normal_x, i) = x
        record(normal_y, i) = y
        record(round_bias_n, i) = bias(i)
        record(round_bias_t, i) = 0
        record(round_friction, i) = friction(i)
        if (abs(mx - my) > 0) then
          w = x**2*mx + y**2*my
          w_nt = abs(x*y*(mx - my))
          w_t = y**2*mx + x**2*my + body(round_inverse_i, c) + body(round_inverse_i, a)
          record(round_inverse_wnn, i) = inverse(w + w_nt)
          record(round_inverse_wtt, i) = inverse(w_t + w_nt)
        end if
        mx = body(velocity_x, c) - body(velocity_x, a)
        my = body(velocity_y, c) - body(velocity_y, a)
        q(1, i) = x*mx + y*my + bias(i)
        q(2, i) = y*mx - x*my + (body(round_spin, c) + body(round_spin, a))
        q(3, i) = 0
        opening(i) = q(1, i)
      end associate
    end do
  end subroutine renew_disks

  !> Inverse of a diagonal term of W; zero where nothing can move.
  pure real(wp) function inverse(w)
    real(wp), intent(in) :: w

    inverse = merge(1.0_wp, 0.0_wp, w > tiny(1.0_wp))/merge(w, 1.0_wp, w > tiny(1.0_wp))
  end function inverse

  !> Those of polyhedra and all else with lever arms in space.
  pure subroutine assemble_solids(scene, contacts, first, n, bias, friction, goes_on, problem, q, opening)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: first, n
    real(wp), intent(in) :: bias(n), friction(n)
    logical, intent(in) :: goes_on
    type(problem_t), intent(inout) :: problem
    real(wp), intent(inout) :: q(3, n), opening(n)
    real(wp) :: half(3), arm_a(3)
    integer :: i, k

    do i = 1, n
      k = first + i - 1
      associate (record => problem%record(:, k), normal => contacts%normal(:, k), middle => scene%bodies%middle, &
                 b => contacts%body(:, k))
        half = contacts%gap(k)/2*normal
        arm_a = contacts%point(:, k) - half - middle(1:3, b(2))
        arm_a(1) = arm_a(1) - scene%period*real(contacts%image(k), wp)
        arm_a(2) = arm_a(2) - scene%period_y*real(contacts%image_y(k), wp)
        record(normal_x:normal_z) = normal
        record(solid_arm_cx:solid_arm_cz) = contacts%point(:, k) + half - middle(1:3, b(1))
        record(solid_arm_ax:solid_arm_az) = arm_a
        record(solid_bias_x:solid_bias_z) = bias(i)*normal
        if (goes_on) then
          call turn_tangent(normal, record(solid_tangent_x:solid_tangent_z))
        else
          record(solid_tangent_x:solid_tangent_z) = tangent_of(normal)
          record(solid_friction) = friction(i)
          record(solid_friction + 1:solid_law - 1) = 0
          cycle
        end if
        call free_velocity(problem%body(:, problem%pair(1, k)), problem%body(:, problem%pair(2, k)), record, q(:, i))
        opening(i) = normal(1)*q(1, i) + normal(2)*q(2, i) + normal(3)*q(3, i)
      end associate
    end do
    if (.not. goes_on) &
      call set_solid_blocks(int(n, c_int), problem%pair(:, first), problem%body, problem%record(:, first), q, opening)
  end subroutine assemble_solids

  !> Turn a tangent with the normal.
  pure subroutine turn_tangent(normal, tangent)
    real(wp), intent(in) :: normal(3)
    real(wp), intent(inout) :: tangent(3)

    tangent = tangent - dot_product(tangent, normal)*normal
    tangent = tangent/sqrt(dot_product(tangent, tangent))
  end subroutine turn_tangent

  !> Relative velocity of a contact of solids without impulses [m/s].
  pure subroutine free_velocity(c, a, record, q)
    real(wp), intent(in) :: c(body_length(solid_frictional)), a(body_length(solid_frictional))
    real(wp), intent(in) :: record(record_length(solid_frictional))
    real(wp), intent(inout) :: q(3)

    q(1) = c(velocity_x) - a(velocity_x) + (c(solid_spin_y)*record(solid_arm_cz) - c(solid_spin_z)*record(solid_arm_cy)) &
           - (a(solid_spin_y)*record(solid_arm_az) - a(solid_spin_z)*record(solid_arm_ay)) + record(solid_bias_x)
    q(2) = c(velocity_y) - a(velocity_y) + (c(solid_spin_z)*record(solid_arm_cx) - c(solid_spin_x)*record(solid_arm_cz)) &
           - (a(solid_spin_z)*record(solid_arm_ax) - a(solid_spin_x)*record(solid_arm_az)) + record(solid_bias_y)
    q(3) = c(velocity_z) - a(velocity_z) + (c(solid_spin_x)*record(solid_arm_cy) - c(solid_spin_y)*record(solid_arm_cx)) &
           - (a(solid_spin_x)*record(solid_arm_ay) - a(solid_spin_y)*record(solid_arm_ax)) + record(solid_bias_z)
  end subroutine free_velocity
end module sg_assemble_by_gaps
