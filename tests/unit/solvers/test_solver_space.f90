!> The solver in space: solutions of all four kinds against the laws themselves, orders, warm starts, and criteria against their
!! definitions.
program test_solver_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: g
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_sphere, random_space_scene
  use resultants, only: add_space_resultants
  use sg_assemble, only: assemble, disassemble
  use sg_compact_space, only: space_velocity
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  use sg_laws, only: law_elastic, law_iqs, law_restitution, local_law, local_law_t, status_new
  use sg_mapping_space, only: space_relative_velocity, tangent_of
  use sg_motion, only: predict
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: ball_frictional, ball_frictionless, ball_frictionless_inverse_mx, ball_frictionless_inverse_mz, &
                        ball_inverse_i, ball_inverse_m, ball_spin_x, ball_spin_z, normal_x, normal_z, solid_frictional, &
                        solid_frictionless, solid_inverse_mx, solid_inverse_mz, solid_inverse_xx, solid_inverse_xy, &
                        solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, solid_inverse_zz, solid_spin_x, solid_spin_z, &
                        velocity_x, velocity_z
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_maxm, criterion_names, criterion_quad, &
                            criterion_violation
  use sg_simulation, only: simulation_t
  use sg_symmetric, only: principal_axes
  use sg_vectors, only: cross
  use solver_cases, only: check_nothing, first_problem, h, map_in_space, solver_of
  implicit none
  character(len=18), parameter :: names(5:8) = [character(len=18) :: 'ball frictionless', 'ball frictional', &
                                                'solid frictionless', 'solid frictional']
  type(tests_t) :: t
  integer :: kind

  call test_laws()
  call test_orders()
  call test_crowd()
  call test_column()
  call test_criteria()
  do kind = ball_frictionless, solid_frictional
    call check_nothing(t, kind)
  end do
  call t%finish()

contains

  !> Random scenes with driven and partly driven bodies: impulses and velocities, from geometry alone, obey the laws.
  subroutine test_laws()
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: report
    integer :: kind, law, i
    integer, parameter :: laws(3) = [law_iqs, law_restitution, law_elastic]
    character(len=:), allocatable :: name

    do kind = ball_frictionless, solid_frictional
      do i = 1, size(laws)
        law = laws(i)
        ! The elastic law has a compliance, which balls have no room for.
        if (law == law_elastic .and. kind /= solid_frictional) cycle
        name = trim(names(kind))
        sim => fresh()
        call random_space_scene(sim%scene, kind, law, [6.0_wp, 6.0_wp], 6.0_wp, 60)
        call first_problem(sim, problem)
        call t%equal(problem%kind, kind, name//': the kind is as planned')
        call t%check(problem%n_contacts > 40, name//': there are contacts')
        solver = solver_of(criterion_e8, 1e-13_wp, 100000)
        call solver%solve(problem, report)
        call t%check(report%is_converged, name//': converged')
        call disassemble(problem, sim%plan, sim%pairs, sim%options%time_step, 0.0_wp, sim%scene, sim%contacts)
        ! Masses, radii and velocities are of order one.
        call t%near(worst_map(sim), 0.0_wp, 1e-10_wp, name//': impulses and velocities obey the law')
        call test_warm(sim, problem, name)
      end do
    end do
  end subroutine test_laws

  !> Largest natural map over all contacts; velocities of bodies must be those that the impulses make.
  real(wp) function worst_map(sim)
    type(simulation_t), intent(inout) :: sim
    type(local_law_t) :: law
    real(wp), allocatable :: velocity(:, :), solved(:, :)
    real(wp) :: n(3), tangent(3), u(3), r(3), before(3), frame(3, 3)
    integer :: k

    solved = sim%scene%bodies%free_velocity
    call predict(sim%scene, 0.0_wp, h, 0.5_wp)
    allocate (velocity(size(solved, 1), size(solved, 2)), source=0.0_wp)
    call add_space_resultants(sim%scene, sim%contacts, velocity)
    velocity = sim%scene%bodies%free_velocity + velocity*sim%scene%bodies%inverse_mass
    worst_map = maxval(abs(velocity - solved))
    do k = 1, sim%contacts%n
      n = sim%contacts%normal(:, k)
      tangent = tangent_of(n)
      frame = reshape([n, tangent, cross(n, tangent)], [3, 3])
      before = matmul(space_relative_velocity(sim%scene, sim%contacts, k, sim%scene%bodies%velocity), frame)
      ! Nothing was known of any contact before: the friction of a new one.
      law = local_law(sim%scene%laws(1), sim%contacts%gap(k), h, before, status_new)
      if (.not. law%is_active) cycle
      u = matmul(space_relative_velocity(sim%scene, sim%contacts, k, velocity), frame) + law%bias
      r = [sim%contacts%impulse(1, k), 0.0_wp, 0.0_wp]
      if (sim%contacts%n_components == 3) r = matmul(sim%contacts%impulse(:, k), frame)
      u = u + [law%compliance(1), law%compliance(2), law%compliance(2)]*r
      if (sim%contacts%n_components == 1) u(2:3) = 0
      worst_map = max(worst_map, norm2(map_in_space(r, u, law%friction, 0.1_wp)))
    end do
  end function worst_map

  !> Given the solution as a guess, the solver asks once and sweeps no more than once.
  subroutine test_warm(sim, solved, name)
    type(simulation_t), intent(inout) :: sim
    type(problem_t), intent(in) :: solved
    character(len=*), intent(in) :: name
    type(problem_t) :: again
    type(nlgs_t) :: solver
    type(report_t) :: report

    call predict(sim%scene, 0.0_wp, h, 0.5_wp)
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, h, again)
    again%impulse(:, :again%n_contacts) = solved%impulse(:, :again%n_contacts)
    solver = solver_of(criterion_e8, 1e-11_wp, 100)
    call solver%solve(again, report)
    call t%check(report%is_converged .and. report%sweeps <= 1, name//': a solved problem stays solved')
    call t%near(maxval(abs(again%impulse(:, :again%n_contacts) - solved%impulse(:, :again%n_contacts))), 0.0_wp, 1e-10_wp, &
                name//': with the same impulses')
  end subroutine test_warm

  !> Spheres thrown together in a sparse cloud, each on a few others: one solution, whatever the order and the relaxation.
  subroutine test_orders()
    type(simulation_t), pointer :: sim
    type(problem_t) :: start, reference, other
    type(nlgs_t) :: solver
    type(report_t) :: report
    integer :: kind, i
    real(wp) :: worst
    character(len=:), allocatable :: name

    do kind = ball_frictionless, solid_frictional
      name = trim(names(kind))
      sim => fresh()
      call random_space_scene(sim%scene, kind, law_iqs, [0.0_wp, 0.0_wp], 9.0_wp, 120)
      call first_problem(sim, start)
      call t%check(start%n_contacts > 30, name//': there are contacts')
      reference = start
      solver = solver_of(criterion_e8, 1e-14_wp, 20000)
      solver%options%order = 'natural'
      call solver%solve(reference, report)
      call t%check(report%e8 < 1e-12_wp, name//': natural order converged')
      do i = 1, 2
        other = start
        solver = solver_of(criterion_e8, 1e-14_wp, 20000)
        if (i == 2) solver%options%relaxation = 0.8_wp
        call solver%solve(other, report)
        call t%check(report%e8 < 1e-12_wp, name//': groups converged')
        worst = maxval(abs(other%body(velocity_x:velocity_z, :) - reference%body(velocity_x:velocity_z, :)))
        call t%near(worst, 0.0_wp, 1e-9_wp, name//': the same velocities by another order')
      end do
    end do
  end subroutine test_orders

  !> Eighty spheres fly at one as light as they are: more contacts of one body than a block has groups. Those beyond must not be
  !! swept side by side, or the sweep overshoots.
  subroutine test_crowd()
    integer, parameter :: n = 80
    type(problem_t) :: start, natural, groups
    type(nlgs_t) :: solver
    type(report_t) :: report
    type(random_t) :: random
    real(wp) :: normal(3)
    integer :: k, c

    call random%seed(13)
    call reserve_problem(start, ball_frictional, n + 1, n)
    start%free_norm = 1
    start%velocity_scale = 1
    do k = 1, n
      do c = 1, 3
        normal(c) = random%normal()
      end do
      normal = normal/norm2(normal)
      start%pair(:, k) = [k + 1, 1]
      start%record(:, k) = [normal, 0.0_wp, 0.0_wp, 0.0_wp, 0.5_wp, 1/7.0_wp, 0.3_wp]
      start%body(velocity_x:velocity_z, k + 1) = -random%uniform()*normal
    end do
    start%body(ball_inverse_m, :) = 1
    start%body(ball_inverse_i, :) = 2.5_wp
    natural = start
    groups = start
    solver = solver_of(criterion_e8, 1e-13_wp, 2000)
    solver%options%order = 'natural'
    call solver%solve(natural, report)
    call t%check(report%is_converged, 'crowd: natural order converged')
    solver = solver_of(criterion_e8, 1e-13_wp, 2000)
    call solver%solve(groups, report)
    call t%check(report%is_converged, 'crowd: groups converged')
    call t%near(maxval(abs(natural%body(:ball_spin_z, :) - groups%body(:ball_spin_z, :))), 0.0_wp, 1e-10_wp, &
                'crowd: the same velocities')
  end subroutine test_crowd

  !> A column of spheres or of boxes on a floor.
  subroutine make_column(kind, n_column, problem, sim)
    integer, intent(in) :: kind, n_column
    type(problem_t), intent(out) :: problem
    type(simulation_t), pointer, intent(out) :: sim
    integer :: b

    sim => fresh()
    call begin_space_scene(sim%scene, n_column + 1, merge(0.4_wp, 0.0_wp, kind == ball_frictional .or. kind == solid_frictional), &
                           0.01_wp)
    do b = 1, n_column
      if (kind <= ball_frictional) then
        call put_sphere(sim%scene, b, 0.5_wp, [0.5_wp, 0.0_wp, real(b, wp) - 0.5_wp])
      else
        call put_box(sim%scene, b, [0.5_wp, 0.4_wp, 0.5_wp], [0.5_wp, 0.0_wp, real(b, wp) - 0.5_wp])
      end if
    end do
    call put_plane(sim%scene, n_column + 1, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    if (kind == solid_frictional) sim%scene%gravity(1:2) = [0.03_wp, 0.02_wp]
    call first_problem(sim, problem)
  end subroutine make_column

  !> Every kind of problem: the contacts of a column carry what lies above.
  subroutine test_column()
    integer, parameter :: heights(5:8) = [8, 8, 3, 3]
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp), allocatable :: carried(:)
    integer :: kind, k, lower, b

    do kind = ball_frictionless, solid_frictional
      call make_column(kind, heights(kind), problem, sim)
      call t%equal(problem%kind, kind, 'column: the kind is as planned')
      call t%equal(problem%n_contacts, merge(1, 4, kind <= ball_frictional)*heights(kind), 'column: number of contacts')
      solver = solver_of(criterion_e8, 1e-13_wp, 100000)
      call solver%solve(problem, report)
      call t%check(report%is_converged, 'column: converged')
      allocate (carried(heights(kind)), source=0.0_wp)
      do k = 1, problem%n_contacts
        lower = minval(modulo(sim%contacts%body(:, k), heights(kind) + 1))
        if (size(problem%impulse, 1) == 1) then
          carried(lower + 1) = carried(lower + 1) + problem%impulse(1, k)
        else
          carried(lower + 1) = carried(lower + 1) + dot_product(problem%impulse(:, k), problem%record(normal_x:normal_z, k))
        end if
      end do
      ! An error of 10^-13 of a contact's natural map is carried through W's condition, some 10^2.
      do b = 1, heights(kind)
        call t%near(carried(b)/(real(heights(kind) + 1 - b, wp)*sim%scene%bodies%mass(1)*g*h), 1.0_wp, 1e-9_wp, &
                    'column: each joint carries the weight above')
      end do
      deallocate (carried)
    end do
  end subroutine test_column

  !> Each criterion has the value of its definition, and the solver stops at the first sweep that fulfils it.
  subroutine test_criteria()
    real(wp), parameter :: tolerances(7) = [1e-4_wp, 1e-6_wp, 1e-4_wp, 1e-4_wp, 1e-3_wp, 1e-3_wp, 1e-3_wp]
    type(simulation_t), pointer :: sim
    type(problem_t) :: start, before, after
    type(nlgs_t) :: solver
    type(report_t) :: report, earlier
    integer :: criterion, kind
    character(len=:), allocatable :: name

    do kind = ball_frictionless, solid_frictional
      call make_column(kind, merge(8, 3, kind <= ball_frictional), start, sim)
      do criterion = 1, 7
        name = trim(names(kind))//', criterion '//trim(criterion_names(criterion))
        after = start
        solver = solver_of(criterion, tolerances(criterion), 10000)
        call solver%solve(after, report)
        call t%check(report%is_converged .and. report%criterion <= tolerances(criterion), name//': reached')
        call t%check(report%sweeps > 2, name//': takes some sweeps')
        before = start
        solver = solver_of(criterion, tolerances(criterion), report%sweeps - 1)
        call solver%solve(before, earlier)
        call t%check(.not. earlier%is_converged .and. earlier%criterion > tolerances(criterion), name//': not a sweep earlier')
        call t%near(report%criterion, defined(criterion, start, after, sim%contacts), 1e-8_wp*report%criterion, &
                    name//': definition')
      end do
    end do
  end subroutine test_criteria

  !> A criterion by its definition, from the problem and its solution. All contacts of the column press and stick, so what a
  !! contact asks is the impulse that makes its own velocity vanish: W_aa times the change is minus its velocity.
  real(wp) function defined(criterion, start, after, contacts)
    integer, intent(in) :: criterion
    type(problem_t), intent(in) :: start, after
    type(contacts_t), intent(in) :: contacts
    real(wp) :: f1, f8, fv, r2, u2, q2, u(3), r(3), dv(3), wr(3), w(3, 3), values(3), axes(3, 3), friction, sums(5), largest(2), n
    real(wp) :: frame(3, 3)
    integer :: k

    f1 = 0
    f8 = 0
    fv = 0
    r2 = 0
    u2 = 0
    q2 = 0
    sums = 0
    largest = 0
    n = real(after%n_contacts, wp)
    friction = merge(0.4_wp, 0.0_wp, size(after%impulse, 1) == 3)
    do k = 1, after%n_contacts
      frame(:, 1) = contacts%normal(:, k)
      frame(:, 2) = tangent_of(frame(:, 1))
      frame(:, 3) = cross(frame(:, 1), frame(:, 2))
      w = block_in(start, k, frame)
      if (size(after%impulse, 1) == 1) then
        q2 = q2 + sum(space_velocity(start, k)**2)
        u = space_velocity(after, k)
        r = [after%impulse(1, k), 0.0_wp, 0.0_wp]
        values = w(1, 1)
      else
        q2 = q2 + sum(space_velocity(start, k)**2)
        u = matmul(space_velocity(after, k), frame)
        r = matmul(after%impulse(:, k), frame)
        call principal_axes(w, values, axes)
      end if
      f1 = f1 + sum(map_in_space(r, u, friction, 1.0_wp)**2)
      f8 = f8 + sum(map_in_space(r, u, friction, 1/maxval(values))**2)
      fv = fv + sum((map_in_space(r, u, friction, 1/maxval(values))*maxval(values))**2)
      r2 = r2 + sum(r**2)
      u2 = u2 + sum(u**2)
      dv = -u
      wr = matmul(w, r)
      if (size(after%impulse, 1) == 1) wr(2:3) = 0
      sums = sums + [sum(dv**2), sum(wr**2), sum(dv*r), sum(wr*r), sum(dv**2)*sum(r**2)]
      largest = max(largest, [sum(dv**2), sum(dv**2)*sum(r**2)])
    end do
    select case (criterion)
    case (criterion_e1)
      defined = sqrt(f1/q2)
    case (criterion_e2)
      defined = sqrt(f1/max(q2, r2, u2))
    case (criterion_e8)
      defined = sqrt(f8/r2)
    case (criterion_violation)
      defined = sqrt(fv/n)/start%velocity_scale
    case (criterion_quad)
      defined = max(abs(sums(3))/sums(4), sqrt(sums(1)/sums(2)), sqrt(sums(5)*n)/sums(4))
    case (criterion_maxm)
      defined = max(abs(sums(3))/sums(4), sqrt(largest(1)*n/sums(2)), sqrt(largest(2))*n/sums(4))
    case default
      defined = max(abs(sums(3))/sums(4), sqrt(sums(1)/sums(2)), sqrt(sums(5)*n)/sums(4), &
                    sqrt(largest(1)*n/sums(2))/16.666_wp, sqrt(largest(2))*n/sums(4)/16.666_wp)
    end select
  end function defined

  !> Block of W of a contact in a frame, by what unit impulses do; where nothing rubs, its first entry alone.
  function block_in(start, k, frame) result(w)
    type(problem_t), intent(in) :: start
    integer, intent(in) :: k
    real(wp), intent(in) :: frame(3, 3)
    real(wp) :: w(3, 3)
    type(problem_t) :: unit
    integer :: i, c

    w = 0
    do i = 1, size(start%impulse, 1)
      unit = start
      unit%n_contacts = start%n_contacts
      do c = 1, 2
        call push(start, k, frame(:, 1), unit%body(:, unit%pair(c, k)), real(3 - 2*c, wp)*frame(:, i), c)
      end do
      if (size(start%impulse, 1) == 1) then
        w(1:1, 1) = space_first(unit, k) - space_first(start, k)
      else
        w(:, i) = matmul(space_velocity(unit, k) - space_velocity(start, k), frame)
      end if
    end do
  end function block_in

  !> What an impulse p does to one of the two bodies, by the mechanics of its shape: a sphere or a box of this test.
  subroutine push(start, k, normal, body, p, side)
    type(problem_t), intent(in) :: start
    integer, intent(in) :: k
    real(wp), intent(in) :: normal(3)
    real(wp), intent(inout) :: body(:)
    real(wp), intent(in) :: p(3)
    integer, intent(in) :: side
    real(wp) :: arm(3), turn(3), inverse(3, 3)

    select case (start%kind)
    case (ball_frictionless)
      body(velocity_x:velocity_z) = body(velocity_x:velocity_z) + body(ball_frictionless_inverse_mx:ball_frictionless_inverse_mz)*p
    case (ball_frictional)
      ! Solid spheres: R^2/I = 5/2 of 1/m; the arm is minus or plus the normal.
      body(velocity_x:velocity_z) = body(velocity_x:velocity_z) + body(ball_inverse_m)*p
      turn = real(2*side - 3, wp)*cross(normal, p)
      body(ball_spin_x:ball_spin_z) = body(ball_spin_x:ball_spin_z) + 2.5_wp*body(ball_inverse_m)*turn
    case (solid_frictionless)
      body(velocity_x:velocity_z) = body(velocity_x:velocity_z) + body(solid_inverse_mx:solid_inverse_mz)*p
      turn = real(3 - 2*side, wp)*start%record(merge(4, 7, side == 1):merge(6, 9, side == 1), k)
      body(solid_spin_x:solid_spin_z) = body(solid_spin_x:solid_spin_z) + body(solid_inverse_xx:solid_inverse_zz)*turn
    case default
      body(velocity_x:velocity_z) = body(velocity_x:velocity_z) + body(solid_inverse_mx:solid_inverse_mz)*p
      arm = start%record(merge(7, 10, side == 1):merge(9, 12, side == 1), k)
      inverse = reshape(body([solid_inverse_xx, solid_inverse_xy, solid_inverse_xz, solid_inverse_xy, solid_inverse_yy, &
                              solid_inverse_yz, solid_inverse_xz, solid_inverse_yz, solid_inverse_zz]), [3, 3])
      body(solid_spin_x:solid_spin_z) = body(solid_spin_x:solid_spin_z) + matmul(inverse, cross(arm, p))
    end select
  end subroutine push

  !> Normal velocity of a contact.
  function space_first(problem, k) result(u)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    real(wp) :: u(1), all(3)

    all = space_velocity(problem, k)
    u = all(1)
  end function space_first
end program test_solver_space
