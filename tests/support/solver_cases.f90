!> First steps of scenes as problems, solvers for them, and checks of solvers that all kinds of problems share.
module solver_cases
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, g, put_disk, put_polygon, put_wall
  use sg_assemble, only: assemble
  use sg_detect, only: detect
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_motion, only: predict
  use sg_nlgs, only: nlgs_t
  use sg_order_values, only: give_impulses
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: arm_frictional, first_inverse, round_frictional, round_frictionless
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: simulation_t
  use sg_sweep_order, only: sweep_order_t
  use sg_sweeps, only: sweep, sweep_impulses
  implicit none
  private
  public :: begin_step, reassemble, first_problem, make_column, random_pairs, solver_of, map_in_space, &
            check_nothing, check_side_by_side

  !> Time step of the problems [s]
  real(wp), parameter, public :: h = 0.01_wp
  ! Disks or squares of a column, by kind of problem: stacked squares with friction bend like a beam, and sweeps need the
  ! fourth power of their number.
  integer, parameter, public :: heights(4) = [8, 8, 8, 3]

contains

  !> Find the contacts of the first step of a scene.
  subroutine begin_step(sim)
    type(simulation_t), intent(inout) :: sim !! its scene is set

    call begin_run(sim, h, 1e-3_wp)
    call predict(sim%scene, 0.0_wp, h, 0.5_wp)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
  end subroutine begin_step

  !> Assemble the problem again: free velocities, and the impulses of the contacts.
  subroutine reassemble(sim)
    type(simulation_t), intent(inout) :: sim !! its contacts are found

    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, h, sim%problem)
  end subroutine reassemble

  !> The problem of the first step of a scene.
  subroutine first_problem(sim, problem)
    type(simulation_t), intent(inout) :: sim !! its scene is set
    type(problem_t), intent(out) :: problem !! a copy of its problem

    call begin_step(sim)
    call reassemble(sim)
    problem = sim%problem
  end subroutine first_problem

  !> A column of disks, or of squares, on a floor; the exact impulses, contact by contact.
  subroutine make_column(kind, problem, exact)
    integer, intent(in) :: kind !! of problem, in the plane
    type(problem_t), intent(out) :: problem !! of its first step
    real(wp), allocatable, intent(out) :: exact(:) !! normal impulse of each contact [N s]
    type(simulation_t), pointer :: sim
    real(wp), parameter :: square(2, 4) = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
    integer :: b, k, lower, n_column
    real(wp) :: share

    sim => fresh()
    n_column = heights(kind)
    call begin_scene(sim%scene, n_column + 1, merge(0.4_wp, 0.0_wp, kind == round_frictional .or. kind == arm_frictional), 0.01_wp)
    share = 1
    do b = 1, n_column
      if (kind == round_frictional .or. kind == round_frictionless) then
        call put_disk(sim%scene, b, 0.5_wp, [0.5_wp, real(b, wp) - 0.5_wp])
      else
        call put_polygon(sim%scene, b, square + spread([0.0_wp, real(b - 1, wp)], 2, 4))
        share = 0.5_wp
      end if
    end do
    call put_wall(sim%scene, n_column + 1, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    call first_problem(sim, problem)
    allocate (exact(problem%n_contacts))
    do k = 1, problem%n_contacts
      lower = minval(modulo(sim%contacts%body(:, k), n_column + 1))
      exact(k) = share*real(n_column - lower, wp)*sim%scene%bodies%mass(1)*g*h
    end do
  end subroutine make_column

  !> A solver with a criterion, a tolerance, and tests every sweep.
  type(nlgs_t) function solver_of(criterion, tolerance, maximum_sweeps) result(solver)
    integer, intent(in) :: criterion !! number of the criterion
    real(wp), intent(in) :: tolerance !! of it
    integer, intent(in) :: maximum_sweeps !! sweeps after which it gives up

    solver%options%criterion = criterion
    solver%options%tolerance = tolerance
    solver%options%check_every = 1
    solver%options%maximum_sweeps = maximum_sweeps
  end function solver_of

  !> Natural map of impulse r and velocity u, axes n, t, n x t, written independently: r - P(r - rho (u + friction |u_t| n)).
  pure function map_in_space(r, u, friction, rho) result(f)
    real(wp), intent(in) :: r(3) !! impulse [N s]
    real(wp), intent(in) :: u(3) !! relative velocity [m/s]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: rho !! [kg]
    real(wp) :: f(3), p(3), across, along

    p = r - rho*(u + [friction*hypot(u(2), u(3)), 0.0_wp, 0.0_wp])
    across = hypot(p(2), p(3))
    if (across > friction*p(1) .or. p(1) < 0) then
      along = (p(1) + friction*across)/(1 + friction**2)
      if (along <= 0) then
        p = 0
      else
        p(2:3) = p(2:3)*friction*along/across
        p(1) = along
      end if
    end if
    f = r - p
  end function map_in_space

  !> Pairs of two bodies each, which touch by a run of points, one up to so many.
  subroutine random_pairs(random, n_bodies, most_points, pair)
    type(random_t), intent(inout) :: random !! stream of numbers
    integer, intent(in) :: n_bodies !! bodies to choose from
    integer, intent(in) :: most_points !! of a pair in a row
    integer(i4), intent(inout) :: pair(:, :) !! slots of each contact
    integer :: k, b, points

    points = 0
    do k = 1, size(pair, 2)
      if (points == 0) then
        points = 1 + int(real(most_points, wp)*random%uniform())
        b = 1 + int(real(n_bodies, wp)*random%uniform())
        pair(:, k) = int([b, 1 + modulo(b - 1 + int(real(n_bodies - 1, wp)*random%uniform()), n_bodies)], i4)
        if (pair(1, k) == pair(2, k)) pair(2, k) = int(1 + modulo(b, n_bodies), i4)
      else
        pair(:, k) = pair(:, k - 1)
      end if
      points = points - 1
    end do
  end subroutine random_pairs

  !> No contact, and contacts that nothing can move.
  subroutine check_nothing(t, kind)
    class(tests_t), intent(inout) :: t !! the checks
    integer, intent(in) :: kind !! kind of problem
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: report

    call reserve_problem(problem, kind, 3, 0)
    solver = solver_of(criterion_e8, 1e-6_wp, 10)
    call solver%solve(problem, report)
    call t%check(report%is_converged .and. report%sweeps == 0, 'nothing to solve')
    call reserve_problem(problem, kind, 3, 2)
    problem%pair(:, 1) = [1, 2]
    problem%pair(:, 2) = [2, 3]
    call solver%solve(problem, report)
    call t%check(report%is_converged, 'contacts of bodies that do not move')
    call t%near(maxval(abs(problem%impulse)), 0.0_wp, 0.0_wp, 'and they carry nothing')
  end subroutine check_nothing

  !> One sweep over an order side by side, and over its copies one by one, with all groups of the order: the same up to rounding.
  subroutine check_side_by_side(t, problem, order, is_wanted, relaxation)
    type(tests_t), intent(inout) :: t !! counts the checks
    type(problem_t), intent(inout) :: problem !! problem with its bodies; is swept
    type(sweep_order_t), intent(inout) :: order !! order of the wanted contacts, with copies; is swept
    logical, intent(in) :: is_wanted(:) !! which contacts the order should hold
    real(wp), intent(in) :: relaxation !! share of the change of impulses
    real(wp), allocatable :: impulse(:, :), body(:, :), before(:, :)
    integer :: k, seen(size(is_wanted)), e, g

    seen = 0
    do k = 1, order%n
      seen(order%contact(k)) = seen(order%contact(k)) + 1
    end do
    call t%check(all(seen == merge(1, 0, is_wanted)), 'each wanted contact is dealt once, no other')
    call t%equal(sum(int(order%lanes%group_size(:order%lanes%n_groups))), order%n, 'the groups hold all contacts')
    e = 0
    do g = 1, order%lanes%n_groups
      call check_group(t, problem, order%pair(:, e + 1:e + order%lanes%group_size(g)))
      e = e + order%lanes%group_size(g)
    end do
    impulse = order%impulse(:, :order%n)
    before = impulse
    body = problem%body
    call sweep_impulses(problem%kind, order, problem%n_bodies, relaxation, impulse, body)
    call sweep(problem%kind, order, problem%n_bodies, relaxation, problem%body)
    call give_impulses(order, problem)
    ! Sums in another order: rounding, carried from contact to contact through the sweep.
    call t%near(maxval(abs(problem%body - body)), 0.0_wp, 1e-11_wp*maxval(abs(body)), 'side by side as one by one: bodies')
    call t%near(maxval(abs(problem%impulse(:, order%contact(:order%n)) - impulse)), 0.0_wp, 1e-11_wp*maxval(abs(impulse)), &
                'side by side as one by one: impulses')
    call t%check(maxval(abs(impulse - before)) > 0.1_wp, 'the sweep changed something')
  end subroutine check_side_by_side

  !> No movable body is twice in a group of contacts that are swept side by side.
  subroutine check_group(t, problem, pair)
    type(tests_t), intent(inout) :: t
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in) :: pair(:, :)
    integer :: slots(2*size(pair, 2)), i
    logical :: bad

    slots = reshape(pair, [2*size(pair, 2)])
    bad = size(pair, 2) > lanes
    do i = 1, size(slots)
      bad = bad .or. (count(slots == slots(i)) > 1 .and. any(problem%body(first_inverse(problem%kind):, slots(i)) > 0))
    end do
    call t%check(.not. bad, 'no movable body twice in a group of eight')
  end subroutine check_group
end module solver_cases
