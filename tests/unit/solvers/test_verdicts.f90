!> Converged is said only of what is right: random piles with disparate masses, huge friction, cohesion that dwarfs weight, loads of
!! rounding size, by all solvers to all criteria. Each contact is checked against its law by its own records.
program test_verdicts
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_scene, put_disk, put_polygon, put_wall
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_sphere
  use sg_assemble, only: assemble
  use sg_choose_solver, only: choose_solver
  use sg_detect, only: detect
  use sg_kinds, only: wp
  use sg_laws, only: law_wet
  use sg_methods, only: solver_names
  use sg_motion, only: predict
  use sg_problem, only: problem_t
  use sg_problem_records, only: body_of, body_record_t, contact_of, contact_record_t
  use sg_random, only: random_t
  use sg_records, only: first_inverse
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_estimate, criterion_names, criterion_violation, &
                            solver_options_t
  use sg_simulation, only: simulation_t, start_simulation
  use sg_solver, only: solver_t
  use sg_text, only: to_text
  implicit none

  !> Piles drawn, and bodies of each; the last one is the floor
  integer, parameter :: n_piles = 40, n_bodies = 6
  type(tests_t) :: tests
  type(random_t) :: random
  integer :: pile, converged, solved

  converged = 0
  solved = 0
  call random%seed(14)
  do pile = 1, n_piles
    call test_pile(pile)
  end do
  do pile = 1, n_piles
    call test_spinning()
  end do
  ! A test in which nothing converges would find nothing.
  call tests%check(2*converged > solved, 'most solves converge: '//to_text(converged)//' of '//to_text(solved))
  call tests%finish()

contains

  !> One pile by all solvers, each to a criterion after the other.
  subroutine test_pile(number)
    integer, intent(in) :: number
    type(simulation_t), pointer :: sim
    type(problem_t) :: start, problem
    class(solver_t), allocatable :: solver
    type(solver_options_t) :: options
    type(report_t) :: report
    character(len=:), allocatable :: name
    character(len=16), allocatable :: methods(:)
    integer :: m, c

    sim => fresh()
    methods = solver_names()
    call draw_pile(number, sim, start)
    do m = 1, size(methods)
      do c = 1, size(criterion_names)
        options%method = methods(m)
        options%criterion = c
        options%tolerance = merge(1e-2_wp, 1e-6_wp, modulo(number + c + m, 2) == 0)
        options%maximum_sweeps = 300
        options%check_every = 5
        call choose_solver(options, solver)
        problem = start
        call solver%solve(problem, report)
        name = 'pile '//to_text(number)//' by '//trim(methods(m))//' to '//trim(criterion_names(c))
        call check_report(name, options, report)
        solved = solved + 1
        if (report%is_converged) then
          converged = converged + 1
          call check_contacts(name, start, problem)
        else
          call tests%check(report%worst_contact <= problem%n_contacts, name//': a contact of the problem is named')
          call tests%check(report%worst_contact >= 1 .or. report%worst_speed <= 0, name//': a contact that breaks its law is named')
        end if
        deallocate (solver)
      end do
    end do
  end subroutine test_pile

  !> A pile of disks, of disks and squares, of spheres, or of spheres and boxes: masses, friction, cohesion, step, loads drawn.
  subroutine draw_pile(number, sim, problem)
    integer, intent(in) :: number
    type(simulation_t), intent(inout) :: sim
    type(problem_t), intent(out) :: problem
    real(wp), parameter :: frictions(5) = [0.0_wp, 0.3_wp, 1.0_wp, 1e3_wp, 1e6_wp]
    real(wp), parameter :: square(2, 4) = reshape([-0.5_wp, -0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp], [2, 4])
    real(wp) :: friction, h, place(3), factor
    integer :: b
    logical :: has_corners

    friction = frictions(1 + modulo(number, 5))
    has_corners = modulo(number, 4) >= 2
    h = 10**random%uniform(-5.0_wp, -2.0_wp)
    if (modulo(number, 2) == 0) then
      call begin_scene(sim%scene, n_bodies, friction, 0.05_wp)
    else
      call begin_space_scene(sim%scene, n_bodies, friction, 0.05_wp)
    end if
    do b = 1, n_bodies - 1
      place = [random%uniform(-0.1_wp, 0.1_wp), random%uniform(-0.1_wp, 0.1_wp), real(b, wp) - 0.5_wp]
      if (modulo(number, 2) == 0 .and. has_corners .and. modulo(b, 2) == 1) then
        call put_polygon(sim%scene, b, square + spread(place([1, 3]), 2, 4))
      else if (modulo(number, 2) == 0) then
        call put_disk(sim%scene, b, 0.5_wp, place([1, 3]))
      else if (has_corners .and. modulo(b, 2) == 1) then
        call put_box(sim%scene, b, [0.5_wp, 0.5_wp, 0.5_wp], place)
      else
        call put_sphere(sim%scene, b, 0.5_wp, place)
      end if
    end do
    if (modulo(number, 2) == 0) then
      call put_wall(sim%scene, n_bodies, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    else
      call put_plane(sim%scene, n_bodies, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    end if
    if (modulo(number, 3) == 0) then
      sim%scene%laws(1)%kind = law_wet
      sim%scene%laws(1)%wet_thickness = 0.1_wp
      sim%scene%laws(1)%normal_cohesion = 10**random%uniform(0.0_wp, 9.0_wp)
    end if
    do b = 1, n_bodies - 1
      factor = 10**(random%uniform(-1.0_wp, 1.0_wp)*merge(4.0_wp, 0.5_wp, modulo(number, 7) < 4))
      sim%scene%bodies%mass(b) = factor*sim%scene%bodies%mass(b)
      if (allocated(sim%scene%bodies%inertia)) sim%scene%bodies%inertia(b) = factor*sim%scene%bodies%inertia(b)
      if (allocated(sim%scene%bodies%principal)) sim%scene%bodies%principal(:, b) = factor*sim%scene%bodies%principal(:, b)
      sim%scene%bodies%inverse_mass(:, b) = sim%scene%bodies%inverse_mass(:, b)/factor
    end do
    call load_pile(number, sim)
    sim%options%time_step = h
    call start_simulation(sim)
    call predict(sim%scene, 0.0_wp, h, 0.5_wp)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, h, problem)
  end subroutine draw_pile

  !> Weight alone, weight and velocities, or nothing but velocities, down to those of rounding size beside a fast body.
  subroutine load_pile(number, sim)
    integer, intent(in) :: number
    type(simulation_t), intent(inout) :: sim
    real(wp) :: speed
    integer :: b, i

    if (modulo(number, 6) < 2) return
    if (modulo(number, 6) > 3) sim%scene%gravity = 0
    speed = 10**random%uniform(-17.0_wp, 2.0_wp)
    do b = 1, n_bodies - 1
      do i = 1, sim%scene%dimension
        sim%scene%bodies%velocity(i, b) = speed*random%uniform(-1.0_wp, 1.0_wp)
      end do
    end do
    if (modulo(number, 6) == 5) sim%scene%bodies%velocity(1, :n_bodies - 1) = sim%scene%bodies%velocity(1, :n_bodies - 1) + 100
  end subroutine load_pile

  !> Disks that close with velocities of rounding size, while one of them spins in place: without load only rounding is left to
  !! solve, and the velocity of the spin decides what that is.
  subroutine test_spinning()
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem
    class(solver_t), allocatable :: solver
    type(solver_options_t) :: options
    type(report_t) :: report
    real(wp), parameter :: h = 1e-3_wp
    integer :: b, row

    sim => fresh()
    call begin_scene(sim%scene, 2*n_bodies, 0.3_wp, 0.05_wp)
    do b = 1, 2*n_bodies
      row = (b - 1)/4
      call put_disk(sim%scene, b, 0.5_wp, [real(modulo(b - 1, 4), wp) + 0.5_wp*real(modulo(row, 2), wp), &
                                           0.5_wp*sqrt(3.0_wp)*real(row, wp)])
      sim%scene%bodies%velocity(:2, b) = 1e-18_wp*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
    end do
    sim%scene%bodies%velocity(3, n_bodies) = 0.1_wp
    sim%scene%gravity = 0
    sim%options%time_step = h
    call start_simulation(sim)
    call predict(sim%scene, 0.0_wp, h, 0.5_wp)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, h, problem)
    options%criterion = criterion_estimate
    options%tolerance = 1e-2_wp
    options%maximum_sweeps = 100
    call choose_solver(options, solver)
    call solver%solve(problem, report)
    call tests%check(problem%n_contacts > 2*n_bodies .and. report%is_converged, 'a disk that spins among others without load')
  end subroutine test_spinning

  !> The criterion is its own error, and below the tolerance where that is said.
  subroutine check_report(name, options, report)
    character(len=*), intent(in) :: name
    type(solver_options_t), intent(in) :: options
    type(report_t), intent(in) :: report
    real(wp) :: own

    own = report%criterion
    select case (options%criterion)
    case (criterion_e1)
      own = report%e1
    case (criterion_e2)
      own = report%e2
    case (criterion_e8)
      own = report%e8
    case (criterion_violation)
      own = report%violation
    case (criterion_estimate)
      own = report%estimate
    end select
    call tests%check(abs(own - report%criterion) <= 0, name//': the criterion is its own error')
    call tests%check(report%criterion <= options%tolerance .or. .not. report%is_converged, name//': below its tolerance')
  end subroutine check_report

  !> No contact breaks its law by more than half of what a step of free fall brings, or of what contacts close with; the margin is
  !! that of rounding.
  subroutine check_contacts(name, start, problem)
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: start, problem
    type(contact_record_t) :: contact
    real(wp) :: q(3), u(3), r(3), mobility, allowed
    integer :: k

    allowed = start%velocity_scale
    do k = 1, start%n_contacts
      contact = contact_of(start, k)
      q = velocity_of(start, contact, k)
      if (q(1) < 0 .or. contact%cohesion > 0) allowed = max(allowed, norm2(q))
    end do
    do k = 1, problem%n_contacts
      contact = contact_of(problem, k)
      if (.not. contact%is_active) cycle
      mobility = mobility_of(problem, contact, k)
      u = velocity_of(problem, contact, k) + contact%compliance*contact%impulse
      r = mobility*(contact%impulse + [contact%cohesion, 0.0_wp, 0.0_wp])
      call check_law(name//', contact '//to_text(k), u, r, contact%friction, allowed/2*(1 + 1e-9_wp) + 1e-13_wp*norm2(r) &
                     + 1e-14_wp*maxval(abs(problem%body(:2, :))))
    end do
  end subroutine check_contacts

  !> Signorini's and Coulomb's laws, impulses as velocities.
  subroutine check_law(name, u, r, friction, most)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: u(3), r(3), friction, most
    real(wp) :: reserve

    call tests%check(u(1) >= -most, name//': it does not close: '//to_text(u(1), 2)//' m/s')
    call tests%check(r(1) >= -most, name//': it does not pull')
    call tests%check(min(u(1), r(1)) <= most, name//': it opens or carries')
    reserve = friction*max(r(1), 0.0_wp) - norm2(r(2:))
    call tests%check(reserve >= -most, name//': friction is within its cone')
    call tests%check(reserve <= most .or. norm2(u(2:)) <= most, name//': it sticks within the cone')
  end subroutine check_law

  !> Relative velocity of a contact, bias included.
  pure function velocity_of(problem, contact, k) result(u)
    type(problem_t), intent(in) :: problem
    type(contact_record_t), intent(in) :: contact
    integer, intent(in) :: k
    real(wp) :: u(3)
    integer :: width, side

    width = first_inverse(problem%kind) - 1
    u = contact%bias
    do side = 1, 2
      u = u + matmul(contact%h(:, :width, side), problem%body(:width, problem%pair(side, k)))
    end do
    if (.not. contact%has_tangent) u(2:) = 0
  end function velocity_of

  !> Velocity that an impulse along the normal brings to its contact; that of all directions together is at most a few times it.
  pure real(wp) function mobility_of(problem, contact, k) result(mobility)
    type(problem_t), intent(in) :: problem
    type(contact_record_t), intent(in) :: contact
    integer, intent(in) :: k
    type(body_record_t) :: body
    real(wp) :: along(6)
    integer :: side

    mobility = contact%compliance(1)
    do side = 1, 2
      body = body_of(problem, int(problem%pair(side, k)))
      along = contact%h(1, :, side)
      along(4:6) = matmul(along(4:6), body%axes)
      if (body%n < 6) along(:3) = contact%h(1, :3, side)
      mobility = mobility + sum(along(:body%n)**2*body%inverse_mass(:body%n))
    end do
  end function mobility_of
end program test_verdicts
