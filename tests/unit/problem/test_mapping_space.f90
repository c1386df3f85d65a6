!> H and H^T adjoint in space, the compact mapping of all four kinds of problem against the geometric one, W against
!! H^T M^-1 H, and the blocks of the records against W.
program test_mapping_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes_space, only: random_space_scene
  use resultants, only: add_space_resultants
  use sg_compact_space, only: add_space_impulses, space_velocity
  use sg_contacts, only: contacts_t, impulse_vector
  use sg_kinds, only: wp
  use sg_laws, only: law_elastic, law_linear, law_restitution, local_law, local_law_t, status_new
  use sg_mapping_space, only: space_arms, space_relative_velocity, tangent_of
  use sg_random, only: random_t
  use sg_records, only: ball_frictional, ball_frictionless, ball_frictionless_inverse_wnn, ball_inverse_i, ball_inverse_wnn, &
                        ball_inverse_wtt, normal_x, normal_z, solid_frictional, solid_frictionless, &
                        solid_frictionless_inverse_wnn, solid_inverse_lambda, solid_law, solid_s1, solid_s2, solid_spin_x, &
                        solid_spin_z, solid_tangent_x, solid_tangent_z, solid_wn2, solid_wnn, velocity_x, velocity_z
  use sg_rotations, only: turned_by
  use sg_simulation, only: simulation_t
  use sg_symmetric, only: principal_axes
  use sg_vectors, only: cross
  use solver_cases, only: begin_step, h, reassemble
  implicit none
  integer, parameter :: n_bodies = 40
  real(wp), parameter :: side = 3.5_wp
  ! Sums of some ten terms of order one to ten, over contacts some hundred in all.
  real(wp), parameter :: rounding = 2e-13_wp
  character(len=18), parameter :: names(5:8) = [character(len=18) :: 'ball frictionless', 'ball frictional', &
                                                'solid frictionless', 'solid frictional']
  type(tests_t) :: t
  integer :: kind

  call test_tangents()
  do kind = ball_frictionless, solid_frictional
    call test_kind(kind, law_restitution, [0.0_wp, 0.0_wp], '')
    call test_kind(kind, law_restitution, [side, side], ', periodic')
  end do
  call test_kind(solid_frictional, law_elastic, [side, 0.0_wp], ', elastic, periodic in x')
  call test_kind(solid_frictional, law_linear, [0.0_wp, side], ', linear, periodic in y')
  call t%finish()

contains

  !> The tangent of any normal is a unit vector across it, also at the poles.
  subroutine test_tangents()
    type(random_t) :: random
    real(wp) :: n(3), tangent(3), worst
    integer :: i, c

    call random%seed(3)
    worst = 0
    do i = 1, 1000
      do c = 1, 3
        n(c) = random%normal()
      end do
      if (i <= 8) n = [1e-9_wp*real(i, wp), 1e-200_wp, merge(1.0_wp, -1.0_wp, modulo(i, 2) == 0)]
      if (i == 9) n = [0.0_wp, 0.0_wp, -1.0_wp]
      n = n/norm2(n)
      tangent = tangent_of(n)
      worst = max(worst, abs(dot_product(n, tangent)), abs(norm2(tangent) - 1))
    end do
    call t%near(worst, 0.0_wp, 8*epsilon(1.0_wp), 'tangents are unit vectors across normals')
  end subroutine test_tangents

  !> All checks for one kind of problem.
  subroutine test_kind(kind, law, period, variant)
    integer, intent(in) :: kind, law
    real(wp), intent(in) :: period(2)
    character(len=*), intent(in) :: variant
    type(simulation_t), pointer :: sim
    character(len=:), allocatable :: name

    sim => fresh()
    name = trim(names(kind))//variant
    call random_space_scene(sim%scene, kind, law, period, side, n_bodies)
    call begin_step(sim)
    call reassemble(sim)
    call t%equal(sim%problem%kind, kind, name//': the kind is as planned')
    call t%check(sim%contacts%n > 60, name//': there are contacts')
    call t%check(any(int(sim%contacts%image(:sim%contacts%n)) /= 0) .eqv. period(1) > 0, name//': images in x')
    call t%check(any(int(sim%contacts%image_y(:sim%contacts%n)) /= 0) .eqv. period(2) > 0, name//': images in y')
    call test_rigid_motion(sim, name)
    call test_adjoint(sim, name)
    call test_compact(sim, name)
    call test_delassus(sim, name)
  end subroutine test_kind

  !> Arms lead from the centres to the surfaces: they are a gap apart along the normal, through the image of the antagonist.
  !! No contact sees a translation of everything; none sees a common spin but through its gap, where no image is between.
  subroutine test_rigid_motion(sim, name)
    type(simulation_t), intent(in) :: sim
    character(len=*), intent(in) :: name
    real(wp) :: velocity(sim%scene%bodies%n_velocity, n_bodies), worst(2), arms(3, 2), apart(3), spin(3)
    integer :: b, k

    worst = 0
    velocity = 0
    spin = [0.7_wp, -0.4_wp, 0.3_wp]
    do b = 1, n_bodies
      velocity(1:3, b) = [1.0_wp, 2.0_wp, 3.0_wp]
      if (size(velocity, 1) == 6) velocity(1:3, b) = velocity(1:3, b) + cross(spin, sim%scene%bodies%middle(1:3, b))
      if (size(velocity, 1) == 6) velocity(4:6, b) = back(sim%scene%bodies%middle(4:7, b), spin)
    end do
    do k = 1, sim%contacts%n
      associate (c => sim%contacts%body(1, k), a => sim%contacts%body(2, k))
        arms = space_arms(sim%scene, sim%contacts, k)
        apart = sim%scene%bodies%middle(1:3, c) + arms(:, 1) - sim%scene%bodies%middle(1:3, a) - arms(:, 2) &
                - [sim%scene%period*real(sim%contacts%image(k), wp), sim%scene%period_y*real(sim%contacts%image_y(k), wp), 0.0_wp]
        worst(1) = max(worst(1), maxval(abs(apart - sim%contacts%gap(k)*sim%contacts%normal(:, k))))
      end associate
      if (int(sim%contacts%image(k)) /= 0 .or. int(sim%contacts%image_y(k)) /= 0) cycle
      if (size(velocity, 1) == 6) then
        apart = cross(spin, sim%contacts%gap(k)*sim%contacts%normal(:, k))
      else
        apart = 0
      end if
      worst(2) = max(worst(2), maxval(abs(space_relative_velocity(sim%scene, sim%contacts, k, velocity) - apart)))
    end do
    call t%near(worst(1), 0.0_wp, rounding, name//': arms end a gap apart')
    call t%near(worst(2), 0.0_wp, rounding, name//': a motion of everything moves no contact')
  end subroutine test_rigid_motion

  !> A vector of the world about principal axes, by the transpose of what turns unit vectors the other way.
  pure function back(q, v)
    real(wp), intent(in) :: q(4), v(3)
    real(wp) :: back(3), unit(3)
    integer :: i

    do i = 1, 3
      unit = 0
      unit(i) = 1
      back(i) = dot_product(turned_by(q, unit), v)
    end do
  end function back

  !> r . H^T V = V . H r for random impulses and velocities.
  subroutine test_adjoint(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp) :: velocity(sim%scene%bodies%n_velocity, n_bodies), resultant(sim%scene%bodies%n_velocity, n_bodies), power
    type(random_t) :: random
    integer :: b, c, k

    call random%seed(6)
    do b = 1, n_bodies
      do c = 1, size(velocity, 1)
        velocity(c, b) = random%uniform(-1.0_wp, 1.0_wp)
      end do
    end do
    power = 0
    do k = 1, sim%contacts%n
      do c = 1, sim%contacts%n_components
        sim%contacts%impulse(c, k) = random%uniform(-1.0_wp, 1.0_wp)
      end do
      power = power + dot_product(impulse_vector(sim%contacts, k), space_relative_velocity(sim%scene, sim%contacts, k, velocity))
    end do
    resultant = 0
    call add_space_resultants(sim%scene, sim%contacts, resultant)
    call t%near(sum(resultant*velocity), power, 100*rounding, name//': H and its transpose are adjoint')
  end subroutine test_adjoint

  !> Compact relative velocities and the effect of compact impulses are those of geometry; impulses are set.
  subroutine test_compact(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp) :: velocity(sim%scene%bodies%n_velocity, n_bodies), worst, spin(3)
    integer :: b

    call reassemble(sim)
    velocity = sim%scene%bodies%free_velocity
    sim%problem%impulse = 0
    call t%near(misfit(sim, velocity), 0.0_wp, 10*rounding, name//': relative velocities without impulses')
    sim%problem%impulse(:, :sim%contacts%n) = sim%contacts%impulse(:, :sim%contacts%n)
    call add_space_impulses(sim%problem)
    velocity = sim%scene%bodies%free_velocity + effect_of(sim, sim%contacts)
    call t%near(misfit(sim, velocity), 0.0_wp, 1000*rounding, name//': relative velocities with impulses')
    worst = maxval(abs(sim%problem%body(velocity_x:velocity_z, sim%pairs%slot_of) - velocity(1:3, :)))
    call t%near(worst, 0.0_wp, 1000*rounding, name//': velocities of bodies')
    if (sim%problem%kind == ball_frictionless) return
    worst = 0
    do b = 1, n_bodies
      spin = turned_by(sim%scene%bodies%middle(4:7, b), velocity(4:6, b))
      if (sim%problem%kind == ball_frictional) spin = sim%plan%radius(b)*spin
      worst = max(worst, maxval(abs(sim%problem%body(solid_spin_x:solid_spin_z, sim%pairs%slot_of(b)) - spin)))
    end do
    call t%near(worst, 0.0_wp, 1000*rounding, name//': spins of bodies')
  end subroutine test_compact

  !> What impulses do to velocities, by geometry: M^-1 H r.
  function effect_of(sim, contacts) result(change)
    type(simulation_t), intent(in) :: sim
    type(contacts_t), intent(in) :: contacts
    real(wp) :: change(sim%scene%bodies%n_velocity, n_bodies)

    change = 0
    call add_space_resultants(sim%scene, contacts, change)
    change = change*sim%scene%bodies%inverse_mass
  end function effect_of

  !> Largest difference between compact and geometric relative velocities, bias and compliance included.
  real(wp) function misfit(sim, velocity)
    type(simulation_t), intent(in) :: sim
    real(wp), intent(in), contiguous :: velocity(:, :)
    type(local_law_t) :: law
    real(wp) :: u(3), before(3), n(3), tangent(3), r(3), got(3)
    integer :: k

    misfit = 0
    do k = 1, sim%contacts%n
      n = sim%contacts%normal(:, k)
      tangent = tangent_of(n)
      u = space_relative_velocity(sim%scene, sim%contacts, k, sim%scene%bodies%velocity)
      before = [dot_product(n, u), dot_product(tangent, u), dot_product(cross(n, tangent), u)]
      law = local_law(sim%scene%laws(1), sim%contacts%gap(k), h, before, sim%contacts%status(k))
      if (.not. law%is_active) cycle
      u = space_relative_velocity(sim%scene, sim%contacts, k, velocity) &
          + law%bias(1)*n + law%bias(2)*tangent + law%bias(3)*cross(n, tangent)
      got = space_velocity(sim%problem, k)
      if (sim%contacts%n_components == 1) then
        misfit = max(misfit, abs(got(1) - dot_product(n, u) - law%compliance(1)*sim%problem%impulse(1, k)))
      else
        r = sim%problem%impulse(:, k)
        u = u + law%compliance(1)*dot_product(n, r)*n + law%compliance(2)*(r - dot_product(n, r)*n)
        misfit = max(misfit, maxval(abs(got - u)))
      end if
    end do
  end function misfit

  !> W from unit impulses through the compact mapping against H^T M^-1 H from geometry; diagonal blocks of the records.
  subroutine test_delassus(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp) :: worst, worst_block, largest, u(3), got(3), r(3)
    real(wp), allocatable :: dense(:, :), velocity(:, :), q(:, :)
    type(contacts_t) :: unit
    type(local_law_t) :: law
    integer :: j, k, m, i

    m = sim%contacts%n_components
    unit = sim%contacts
    allocate (dense(m*unit%n, m*unit%n), q(3, unit%n), velocity(sim%scene%bodies%n_velocity, n_bodies))
    sim%contacts%impulse = 0
    call reassemble(sim)
    sim%problem%impulse = 0
    do k = 1, unit%n
      q(:, k) = space_velocity(sim%problem, k)
    end do
    law = local_law(sim%scene%laws(1), 0.0_wp, h, [0.0_wp, 0.0_wp, 0.0_wp], status_new)
    worst = 0
    worst_block = 0
    do j = 1, m*unit%n
      i = (j - 1)/m + 1
      unit%impulse = 0
      unit%impulse(j - m*(i - 1), i) = 1
      velocity = effect_of(sim, unit)
      call reassemble(sim)
      sim%problem%impulse = 0
      sim%problem%impulse(j - m*(i - 1), i) = 1
      call add_space_impulses(sim%problem)
      do k = 1, unit%n
        u = space_relative_velocity(sim%scene, unit, k, velocity)
        if (m == 1) u(1) = dot_product(unit%normal(:, k), u)
        dense(m*(k - 1) + 1:m*k, j) = u(:m)
        got = space_velocity(sim%problem, k) - q(:, k)
        if (k == i .and. m == 3) then
          r = unit%impulse(:, k)
          got = got - law%compliance(2)*r &
                - (law%compliance(1) - law%compliance(2))*dot_product(unit%normal(:, k), r)*unit%normal(:, k)
        end if
        worst = max(worst, maxval(abs(got(:m) - u(:m))))
      end do
    end do
    largest = maxval(abs(dense))
    call t%near(worst/largest, 0.0_wp, 2*rounding, name//': W by the compact mapping is that of geometry')
    call t%near(maxval(abs(dense - transpose(dense)))/largest, 0.0_wp, rounding, name//': W is symmetric')
    do k = 1, unit%n
      worst_block = max(worst_block, block_misfit(sim, k, dense(m*(k - 1) + 1:m*k, m*(k - 1) + 1:m*k), law%compliance))
    end do
    call t%near(worst_block/largest, 0.0_wp, rounding, name//': diagonal blocks of the records')
  end subroutine test_delassus

  !> Difference between a record's block and W's. Where a ball is driven in some directions only, its record bounds W.
  real(wp) function block_misfit(sim, k, w, compliance) result(misfit)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: k
    real(wp), intent(in) :: w(:, :), compliance(2)
    real(wp) :: n(3), values(3), axes(3, 3), schur(2, 2), wrong

    misfit = 0
    n = sim%contacts%normal(:, k)
    associate (record => sim%problem%record(:, k), pair => sim%problem%pair(:, k), body => sim%problem%body)
      select case (sim%problem%kind)
      case (ball_frictionless)
        if (record(ball_frictionless_inverse_wnn) > 0) misfit = abs(1/record(ball_frictionless_inverse_wnn) - w(1, 1))
      case (ball_frictional)
        if (.not. record(ball_inverse_wnn) > 0) return
        call principal_axes(w, values, axes)
        if (min(body(ball_inverse_i, pair(1)), body(ball_inverse_i, pair(2))) < 0) then
          misfit = max(0.0_wp, dot_product(n, matmul(w, n)) - 1/record(ball_inverse_wnn), &
                       maxval(values) - 1/min(record(ball_inverse_wnn), record(ball_inverse_wtt)))
        else
          misfit = abs(1/record(ball_inverse_wnn) - dot_product(n, matmul(w, n)))
          axes = w - 1/record(ball_inverse_wtt)*identity() - (1/record(ball_inverse_wnn) - 1/record(ball_inverse_wtt))*outer(n, n)
          misfit = max(misfit, maxval(abs(axes)))
        end if
      case (solid_frictionless)
        if (.not. record(solid_frictionless_inverse_wnn) > 0) return
        misfit = abs(1/record(solid_frictionless_inverse_wnn) - w(1, 1) - compliance(1))
      case (solid_frictional)
        if (record(solid_law) < 0.5_wp) return
        axes(:, 1) = record(normal_x:normal_z)
        axes(:, 2) = record(solid_tangent_x:solid_tangent_z)
        axes(:, 3) = cross(record(normal_x:normal_z), record(solid_tangent_x:solid_tangent_z))
        misfit = maxval(abs(matmul(transpose(axes), axes) - identity()))
        axes = matmul(transpose(axes), matmul(w, axes))
        axes(1, 1) = axes(1, 1) + compliance(1)
        axes(2, 2) = axes(2, 2) + compliance(2)
        axes(3, 3) = axes(3, 3) + compliance(2)
        schur = axes(2:3, 2:3) - spread(axes(2:3, 1), 2, 2)*spread(axes(1, 2:3), 1, 2)/axes(1, 1)
        misfit = max(misfit, maxval(abs(record(solid_wnn:solid_wn2) - axes(:, 1))), &
                     maxval(abs(record(solid_s1:solid_s2) - [schur(1, 1), schur(2, 2)])), abs(schur(1, 2)))
        call principal_axes(w_of(axes), values, axes)
        ! The root of the characteristic polynomial has half the digits where two of them meet: a scale needs no more.
        wrong = abs(1/record(solid_inverse_lambda) - maxval(values))
        if (wrong > 1e-7_wp*maxval(values)) misfit = max(misfit, wrong)
      end select
    end associate
  end function block_misfit

  !> The same matrix, so that it is no alias.
  pure function w_of(matrix)
    real(wp), intent(in) :: matrix(3, 3)
    real(wp) :: w_of(3, 3)

    w_of = matrix
  end function w_of

  !> Unit matrix.
  pure function identity()
    real(wp) :: identity(3, 3)
    integer :: i

    identity = 0
    do i = 1, 3
      identity(i, i) = 1
    end do
  end function identity

  !> Dyad a b^T.
  pure function outer(a, b)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: outer(3, 3)

    outer = spread(a, 2, 3)*spread(b, 1, 3)
  end function outer
end program test_mapping_space
