!> Solvers of contact problems given by matrices, all on the same problems: stacks of boxes with known velocities and resultants
!! (impulses are not unique), random bodies, friction from 0 to 100, one contact, none; and the parts of Newton's method.
program test_matrix_solvers
  use harness, only: tests_t
  use sg_accelerated_nlgs, only: accelerated_nlgs_t
  use sg_block_automatic, only: block_automatic_t
  use sg_block_map, only: natural_map
  use sg_block_nesterov, only: block_nesterov_t
  use sg_block_nlgs, only: block_nlgs_t
  use sg_block_scaling, only: scale_problem
  use sg_condense, only: condense
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_local_coulomb, only: solve_local_2, solve_local_3
  use sg_matrix_errors, only: errors_of, matrix_errors_t, project_on_cone
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_newton_map, only: derivative_of_projection
  use sg_proximal_newton, only: proximal_newton_t
  use sg_random, only: random_t
  use sg_report, only: report_t
  use sg_sparse, only: multiply, sparse_from_triplets
  use sg_text, only: to_text
  implicit none
  character(len=12), parameter :: names(5) = [character(len=12) :: 'nlgs', 'nesterov', 'accelerated', 'proximal', 'auto']
  type(tests_t) :: tests
  type(random_t) :: random
  integer :: k, d

  call random%seed(3)
  do k = 1, size(names)
    do d = 2, 3
      call stacks_carry_their_weight(trim(names(k)), d, 0.5_wp)
      call stacks_carry_their_weight(trim(names(k)), d, 0.0_wp)
      call stacks_carry_their_weight(trim(names(k)), d, 100.0_wp)
      call stacks_slide(trim(names(k)), d, 0.3_wp)
      call stacks_slide(trim(names(k)), d, 0.0_wp)
      call random_bodies_are_solved(trim(names(k)), d)
      call one_contact_is_local(trim(names(k)), d)
      call nothing_to_do(trim(names(k)), d)
    end do
    call limits_are_kept(trim(names(k)))
    call history_is_kept(trim(names(k)))
  end do
  call derivatives_are_right()
  call maps_agree()
  call units_are_left_behind()
  call tests%finish()

contains

  !> A solver by name, with a tolerance (a subroutine: gfortran 12 spoils memory when a class changes by assignment).
  subroutine make_solver(name, tolerance, solver)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: tolerance
    class(matrix_solver_t), allocatable, intent(out) :: solver

    select case (name)
    case ('nlgs')
      allocate (block_nlgs_t :: solver)
    case ('nesterov')
      allocate (block_nesterov_t :: solver)
    case ('accelerated')
      allocate (accelerated_nlgs_t :: solver)
    case ('proximal')
      allocate (proximal_newton_t :: solver)
    case default
      allocate (block_automatic_t :: solver)
    end select
    solver%options%tolerance = tolerance
  end subroutine make_solver

  !> A stack of boxes on a floor tilted by an angle, each on the corners of its lower face: d - 1 unknown velocities and rotations.
  subroutine make_stack(d, boxes, friction, tilt, problem)
    integer, intent(in) :: d, boxes
    real(wp), intent(in) :: friction !! at the floor; a hundred times as much between boxes
    real(wp), intent(in) :: tilt !! angle of the floor
    type(matrix_problem_t), intent(out) :: problem
    real(wp), parameter :: half(3) = [1.0_wp, 0.7_wp, 0.2_wp]
    type(error_t), allocatable :: error
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:), mass(:)
    real(wp) :: m, corner(3)
    integer :: dof, corners, i, j, c, k

    dof = 3*(d - 1)
    corners = 2**(d - 1)
    problem%d = d
    problem%n = boxes*corners
    problem%has_global = .true.
    allocate (row(2*d*dof*problem%n), column(2*d*dof*problem%n), value(2*d*dof*problem%n), mass(dof*boxes))
    allocate (problem%friction(problem%n), problem%f(dof*boxes), problem%offset(d*problem%n), problem%r(d, problem%n))
    problem%offset = 0
    problem%r = 0
    problem%f = 0
    k = 0
    do i = 1, boxes
      m = 1 + 0.3_wp*real(i, wp)
      mass(dof*(i - 1) + 1:dof*(i - 1) + d) = m
      if (d == 2) mass(dof*i) = m*(half(1)**2 + half(3)**2)/3
      if (d == 3) mass(dof*i - 2:dof*i) = m*(sum(half**2) - half**2)/3
      problem%f(dof*(i - 1) + 1) = -m*cos(tilt)
      problem%f(dof*(i - 1) + 2) = m*sin(tilt)
      do c = 1, corners
        j = corners*(i - 1) + c
        problem%friction(j) = friction
        if (i > 1) problem%friction(j) = min(100*friction, 100.0_wp)
        corner = [-half(3), merge(half(1), -half(1), modulo(c, 2) == 0), merge(half(2), -half(2), c > 2)]
        call add_corner(d, dof, i, j, 1.0_wp, corner, row, column, value, k)
        corner(1) = half(3)
        if (i > 1) call add_corner(d, dof, i - 1, j, -1.0_wp, corner, row, column, value, k)
      end do
    end do
    call sparse_from_triplets(dof*boxes, dof*boxes, [(int(i, i4), i=1, dof*boxes)], [(int(i, i4), i=1, dof*boxes)], mass, &
                              problem%mass)
    call sparse_from_triplets(dof*boxes, d*problem%n, row(:k), column(:k), value(:k), problem%h)
    call condense(problem, error)
    call tests%check(.not. allocated(error), 'a stack has a local form')
  end subroutine make_stack

  !> What one corner does to one box; axes are (up, along, across), as are those of the contact.
  subroutine add_corner(d, dof, body, contact, side, arm, row, column, value, k)
    integer, intent(in) :: d, dof, body, contact
    real(wp), intent(in) :: side, arm(3)
    integer(i4), intent(inout) :: row(:), column(:)
    real(wp), intent(inout) :: value(:)
    integer, intent(inout) :: k
    real(wp) :: turn(3)
    integer :: e, i, axis

    do e = 1, d
      k = k + 1
      row(k) = int(dof*(body - 1) + e, i4)
      column(k) = int(d*(contact - 1) + e, i4)
      value(k) = side
      turn = 0
      turn(modulo(e, 3) + 1) = arm(modulo(e + 1, 3) + 1)
      turn(modulo(e + 1, 3) + 1) = -arm(modulo(e, 3) + 1)
      do i = 1, dof - d
        axis = merge(3, i, d == 2)
        k = k + 1
        row(k) = int(dof*(body - 1) + d + i, i4)
        column(k) = int(d*(contact - 1) + e, i4)
        value(k) = side*turn(axis)
      end do
    end do
  end subroutine add_corner

  !> Velocities of the bodies, M^-1 (f + H r), for a diagonal M.
  function velocities(problem) result(v)
    type(matrix_problem_t), intent(in) :: problem
    real(wp), allocatable :: v(:)

    allocate (v(size(problem%f)))
    call multiply(problem%h, reshape(problem%r, [size(problem%r)]), v)
    v = (v + problem%f)/problem%mass%value
  end function velocities

  !> On a level floor: at rest, and each layer of corners carries all that lies above.
  subroutine stacks_carry_their_weight(name, d, friction)
    character(len=*), intent(in) :: name
    integer, intent(in) :: d
    real(wp), intent(in) :: friction
    integer, parameter :: boxes = 5
    class(matrix_solver_t), allocatable :: solver
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    character(len=:), allocatable :: what
    integer :: i, corners
    real(wp) :: weight

    what = name//', stack in '//to_text(d)//'D, friction '//to_text(nint(100*friction))//' %: '
    call make_stack(d, boxes, friction, 0.0_wp, problem)
    call make_solver(name, 1e-10_wp, solver)
    call solver%solve(problem, report)
    call tests%check(report%is_converged, what//'solved')
    ! Errors of velocities are those of the map, 1e-10 of q, times the condition of the velocities that are not zero: below 1e3.
    call tests%near(maxval(abs(velocities(problem))), 0.0_wp, 1e-7_wp, what//'at rest')
    corners = problem%n/boxes
    weight = 0
    do i = boxes, 1, -1
      weight = weight + 1 + 0.3_wp*real(i, wp)
      call tests%near(sum(problem%r(1, corners*(i - 1) + 1:corners*i)), weight, 1e-6_wp, what//'weight on a layer')
    end do
  end subroutine stacks_carry_their_weight

  !> On a floor steeper than its friction: all boxes gain sin a - friction cos a, and nothing else.
  subroutine stacks_slide(name, d, friction)
    character(len=*), intent(in) :: name
    integer, intent(in) :: d
    real(wp), intent(in) :: friction
    real(wp), parameter :: tilt = 0.6_wp
    integer, parameter :: boxes = 3
    class(matrix_solver_t), allocatable :: solver
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    character(len=:), allocatable :: what
    real(wp) :: v(3*(d - 1)*boxes), expected(3*(d - 1), boxes)

    what = name//', sliding in '//to_text(d)//'D, friction '//to_text(nint(100*friction))//' %: '
    call make_stack(d, boxes, friction, tilt, problem)
    call make_solver(name, 1e-10_wp, solver)
    call solver%solve(problem, report)
    call tests%check(report%is_converged, what//'solved')
    expected = 0
    expected(2, :) = sin(tilt) - friction*cos(tilt)
    v = velocities(problem)
    call tests%near(maxval(abs(v - reshape(expected, [size(expected)]))), 0.0_wp, 1e-7_wp, what//'velocity')
  end subroutine stacks_slide

  !> Random bodies and contacts, more contacts than freedoms, W unsymmetric by 1e-4.
  subroutine random_bodies_are_solved(name, d)
    character(len=*), intent(in) :: name
    integer, intent(in) :: d
    class(matrix_solver_t), allocatable :: solver
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    type(matrix_errors_t) :: errors
    integer :: seed, solved, same

    solved = 0
    same = 0
    do seed = 1, 10
      call random_problem(d, seed, 4 + 6*seed, problem)
      ! Sweeps alone are slow here, and this is no test of speed.
      call make_solver(name, merge(1e-5_wp, 1e-9_wp, name == 'nlgs'), solver)
      call solver%solve(problem, report)
      errors = errors_of(problem, problem%r)
      if (errors%e1 <= solver%options%tolerance .and. report%is_converged) solved = solved + 1
      if (abs(errors%e1 - report%e1) <= 1e-3_wp*errors%e1) same = same + 1
    end do
    if (any(name == [character(len=12) :: 'nlgs', 'nesterov', 'accelerated'])) then
      ! With much friction sweeps can go round in circles for ever: they do in the plane, on the sixth.
      call tests%check(solved >= 9, name//': random problems solved')
    else
      call tests%equal(solved, 10, name//': random problems solved')
    end if
    call tests%equal(same, 10, name//': errors told are those measured')
  end subroutine random_bodies_are_solved

  !> n contacts between n/d bodies and a fixed one, without offset: bodies at rest are admissible, so that an answer exists.
  subroutine random_problem(d, seed, n, problem)
    integer, intent(in) :: d, seed, n
    type(matrix_problem_t), intent(out) :: problem
    type(error_t), allocatable :: error
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: a, body, side, i, k, dof, bodies, part

    call random%seed(100*d + seed)
    dof = 3*(d - 1)
    bodies = n/d
    problem%d = d
    problem%n = n
    problem%has_global = .true.
    allocate (problem%friction(n), problem%f(dof*bodies), problem%offset(d*n), problem%r(d, n))
    allocate (row(2*d*dof*n), column(2*d*dof*n), value(2*d*dof*n))
    problem%offset = 0
    problem%r = 0
    k = 0
    do a = 1, n
      problem%friction(a) = max(0.0_wp, random%uniform(-0.2_wp, 1.0_wp))
      do side = 1, 1 + modulo(a, 3)
        if (side > 2) cycle
        body = 1 + modulo(a*side, bodies)
        do i = 1, dof
          do part = 1, d
            k = k + 1
            row(k) = int(dof*(body - 1) + i, i4)
            column(k) = int(d*(a - 1) + part, i4)
            value(k) = random%uniform(-1.0_wp, 1.0_wp)
          end do
        end do
      end do
    end do
    do i = 1, size(problem%f)
      problem%f(i) = random%uniform(-1.0_wp, 1.0_wp)
    end do
    call sparse_from_triplets(dof*bodies, dof*bodies, [(int(i, i4), i=1, dof*bodies)], [(int(i, i4), i=1, dof*bodies)], &
                              [(0.5_wp + real(modulo(i, 5), wp), i=1, dof*bodies)], problem%mass)
    call sparse_from_triplets(dof*bodies, d*n, row(:k), column(:k), value(:k), problem%h)
    call condense(problem, error)
    call tests%check(.not. allocated(error), 'a random problem has a local form')
    if (modulo(seed, 2) == 0) return
    problem%is_symmetric = .false.
    do a = 1, n
      associate (block => problem%w%block(:, :, problem%w%diagonal(a)))
        block(1, 2) = block(1, 2)*(1 + 1e-4_wp)
      end associate
    end do
  end subroutine random_problem

  !> One contact is the local problem.
  subroutine one_contact_is_local(name, d)
    character(len=*), intent(in) :: name
    integer, intent(in) :: d
    real(wp), parameter :: w(3, 3) = reshape([2.0_wp, 0.3_wp, -0.1_wp, 0.3_wp, 3.0_wp, 0.2_wp, -0.1_wp, 0.2_wp, 4.0_wp], [3, 3])
    real(wp), parameter :: q(3) = [-1.0_wp, 2.0_wp, -1.5_wp]
    class(matrix_solver_t), allocatable :: solver
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    real(wp) :: expected(d)
    integer :: i

    do i = 1, 3
      call empty_problem(d, 1, problem)
      problem%w%first(2) = 2
      problem%w%column(1) = 1
      problem%w%diagonal(1) = 1
      problem%w%block(:, :, 1) = w(:d, :d)
      problem%friction = merge(0.2_wp, merge(100.0_wp, 0.0_wp, i == 2), i == 1)
      problem%q(:, 1) = q(:d)
      if (d == 2) call solve_local_2(w(:2, :2), q(:2), problem%friction(1), expected)
      if (d == 3) call solve_local_3(w, q, problem%friction(1), expected)
      call make_solver(name, 1e-13_wp, solver)
      call solver%solve(problem, report)
      call tests%check(report%is_converged, name//': one contact')
      call tests%near(norm2(problem%r(:, 1) - expected), 0.0_wp, 1e-12_wp, name//': impulse of one contact')
    end do
  end subroutine one_contact_is_local

  !> A problem of n contacts with room for one block each.
  subroutine empty_problem(d, n, problem)
    integer, intent(in) :: d, n
    type(matrix_problem_t), intent(out) :: problem

    problem%d = d
    problem%n = n
    problem%w%d = d
    problem%w%n = n
    allocate (problem%w%first(n + 1), source=1_i4)
    allocate (problem%w%column(n), problem%w%diagonal(n), source=0_i4)
    allocate (problem%w%block(d, d, n), problem%q(d, n), problem%r(d, n), problem%friction(n), source=0.0_wp)
  end subroutine empty_problem

  !> No contact; contacts that move apart; contacts that do not move, with a guess that is not zero.
  subroutine nothing_to_do(name, d)
    character(len=*), intent(in) :: name
    integer, intent(in) :: d
    class(matrix_solver_t), allocatable :: solver
    type(matrix_problem_t) :: problem
    type(report_t) :: report

    call empty_problem(d, 0, problem)
    call make_solver(name, 1e-8_wp, solver)
    solver%options%warm_start = .true.
    call solver%solve(problem, report)
    call tests%check(report%is_converged .and. size(problem%r) == 0, name//': no contact')
    call make_stack(d, 2, 0.5_wp, 0.0_wp, problem)
    problem%q = abs(problem%q)
    call solver%solve(problem, report)
    call tests%check(report%is_converged .and. report%iterations == 0, name//': contacts that open take no effort')
    call tests%near(norm2(problem%r), 0.0_wp, 0.0_wp, name//': contacts that open')
    problem%q = 0
    problem%r = 1
    call solver%solve(problem, report)
    call tests%check(report%is_converged, name//': contacts at rest')
    call tests%near(norm2(problem%r), 0.0_wp, 0.0_wp, name//': contacts at rest feel nothing')
  end subroutine nothing_to_do

  !> Effort ends where it must, the report says so, and a good guess takes none.
  subroutine limits_are_kept(name)
    character(len=*), intent(in) :: name
    class(matrix_solver_t), allocatable :: solver
    type(matrix_problem_t) :: problem
    type(report_t) :: report

    call make_stack(3, 8, 0.5_wp, 0.3_wp, problem)
    call make_solver(name, 1e-30_wp, solver)
    solver%options%maximum_iterations = 60
    call solver%solve(problem, report)
    call tests%check(.not. report%is_converged, name//': what no rounding allows is not reached')
    call tests%check(report%iterations >= 60 .and. report%iterations <= 120, name//': iterations end')
    solver%options%maximum_iterations = huge(1)
    solver%options%maximum_seconds = 0.05_wp
    call solver%solve(problem, report)
    call tests%check(.not. report%is_converged .and. report%iterations > 0, name//': time ends')
    solver%options%maximum_seconds = 60
    solver%options%tolerance = 1e-8_wp
    call solver%solve(problem, report)
    call tests%check(report%is_converged, name//': a stack on a slope')
    solver%options%warm_start = .true.
    call solver%solve(problem, report)
    call tests%check(report%is_converged .and. report%iterations == 0, name//': the answer as a guess')
  end subroutine limits_are_kept

  !> The history begins with the guess and ends with the answer.
  subroutine history_is_kept(name)
    character(len=*), intent(in) :: name
    class(matrix_solver_t), allocatable :: solver
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    integer :: last

    call make_stack(3, 6, 0.5_wp, 0.3_wp, problem)
    call make_solver(name, 1e-8_wp, solver)
    solver%options%with_trace = .true.
    call solver%solve(problem, report)
    call tests%check(allocated(report%trace), name//': a history')
    if (.not. allocated(report%trace)) return
    last = size(report%trace)
    call tests%equal(last, report%checks, name//': one point a test')
    call tests%equal(report%trace(1)%iteration, 0, name//': the history begins at once')
    call tests%equal(report%trace(last)%iteration, report%iterations, name//': and ends at the end')
    call tests%near(report%trace(last)%e1, report%e1, 1e-12_wp, name//': with the error of the answer')
    call tests%near(report%trace(last)%e8, report%e8, 1e-12_wp, name//': and its other error')
    call tests%check(all(report%trace(2:)%iteration > report%trace(:last - 1)%iteration), name//': iterations rise')
  end subroutine history_is_kept

  !> The derivative of the projection is what differences of the projection give.
  subroutine derivatives_are_right()
    real(wp), parameter :: step = 1e-6_wp
    real(wp) :: x(3), j(3, 3), shift(3), friction, difference(3), error
    integer :: i, k, d, kinds(3)
    logical :: is_open

    error = 0
    kinds = 0
    do i = 1, 1000
      do d = 2, 3
        do k = 1, d
          x(k) = random%normal()
        end do
        friction = random%uniform(0.0_wp, 3.0_wp)
        ! Not at the edges of the cone and of its polar, where there is no derivative.
        if (abs(norm2(x(2:d)) - friction*x(1)) < 1e-3_wp .or. abs(friction*norm2(x(2:d)) + x(1)) < 1e-3_wp) cycle
        if (norm2(x(2:d)) < 1e-2_wp) cycle
        call derivative_of_projection(friction, x(:d), j(:d, :d), is_open)
        if (is_open) kinds(1) = kinds(1) + 1
        if (norm2(x(2:d)) < friction*x(1)) kinds(2) = kinds(2) + 1
        if (norm2(x(2:d)) > friction*x(1) .and. .not. is_open) kinds(3) = kinds(3) + 1
        do k = 1, d
          shift = 0
          shift(k) = step
          difference(:d) = (project_on_cone(x(:d) + shift(:d), friction) - project_on_cone(x(:d) - shift(:d), friction))/(2*step)
          error = max(error, norm2(j(:d, k) - difference(:d)))
        end do
      end do
    end do
    call tests%check(all(kinds > 100), 'derivatives of all kinds')
    ! Differences: step^2 times third derivatives of up to 1e4 near the axis, and rounding of 1e-16/step.
    call tests%near(error, 0.0_wp, 1e-7_wp, 'derivative of the projection')
  end subroutine derivatives_are_right

  !> The map of the solvers is that of the errors.
  subroutine maps_agree()
    type(matrix_problem_t) :: problem
    real(wp), allocatable :: r(:, :), u(:, :), f(:, :)
    type(matrix_errors_t) :: errors
    integer :: d, i, k

    do d = 2, 3
      call random_problem(d, 1, 30, problem)
      allocate (r(d, problem%n), u(d, problem%n), f(d, problem%n))
      do i = 1, problem%n
        do k = 1, d
          r(k, i) = random%normal()
        end do
      end do
      call multiply(problem%w, r, u)
      u = u + problem%q
      call natural_map(problem%friction, 1.0_wp, r, u, f)
      errors = errors_of(problem, r)
      call tests%near(norm2(f)/norm2(problem%q)/errors%e1, 1.0_wp, 1e-13_wp, 'the natural map')
      deallocate (r, u, f)
    end do
  end subroutine maps_agree

  !> The problem without units has an answer where the problem has one, and blocks of size one.
  subroutine units_are_left_behind()
    type(matrix_problem_t) :: problem, scaled
    real(wp), allocatable :: scale(:)
    type(block_automatic_t) :: solver
    type(report_t) :: report
    type(matrix_errors_t) :: errors
    real(wp) :: trace
    integer :: a, k

    call random_problem(3, 2, 40, problem)
    problem%q = 1e-3_wp*problem%q
    problem%w%block = 1e5_wp*problem%w%block
    allocate (scale(problem%n))
    call scale_problem(problem, scaled, scale)
    trace = 0
    do a = 1, problem%n
      do k = 1, 3
        trace = trace + scaled%w%block(k, k, scaled%w%diagonal(a))/3
      end do
    end do
    call tests%near(trace/real(problem%n, wp), 1.0_wp, 1e-13_wp, 'size of W without units')
    call tests%near(sum(scaled%q**2)/real(problem%n, wp), 1.0_wp, 1e-13_wp, 'size of q without units')
    solver%options%tolerance = 1e-10_wp
    call solver%solve(scaled, report)
    do a = 1, problem%n
      problem%r(:, a) = scale(a)*scaled%r(:, a)
    end do
    errors = errors_of(problem, problem%r)
    call tests%near(errors%e8, 0.0_wp, 1e-8_wp, 'an answer brought back to its units')
  end subroutine units_are_left_behind
end program test_matrix_solvers
