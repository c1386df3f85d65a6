!> The interior point solver: algebra of its cones, both forms of its system, contacts solved by hand, random problems without
!! unique impulses, and real ones.
program test_interior_point
  use harness, only: tests_t
  use sg_condense, only: condense
  use sg_error, only: error_t
  use sg_fclib_read, only: read_fclib
  use sg_hdf5, only: hdf5_is_available
  use sg_interior_point, only: interior_point_t
  use sg_interior_point_cones, only: determinant, find_scaling, longest_step, metric_of, product_of, quotient_of, scaled_by
  use sg_interior_point_system, only: contact_system_t
  use sg_kinds, only: wp, i4
  use sg_matrix_errors, only: errors_of, matrix_errors_t
  use sg_matrix_problem, only: matrix_problem_t
  use sg_random, only: random_t
  use sg_report, only: report_t
  use sg_sparse, only: multiply, sparse_from_triplets
  use sg_system, only: file_exists
  use sg_text, only: to_text
  use written_files, only: shared_folder
  implicit none
  ! Numbers of order one to a hundred, in some ten operations.
  real(wp), parameter :: rounding = 1e-11_wp
  character(len=*), parameter :: files(15) = [character(len=40) :: 'FC3D_Example1', 'Rover1039', 'Rover4613', &
    'OneObject-i1028-138', 'OneObject-i100000-499', 'NESpheres_30_1', 'BoxesStack1-i100000-32', 'Confeti-ex03-Fc3D-SBM', &
    'LMGC_100_PR_PerioBox-i00361-60-03000', 'Box_Stacks-i0122-82-5', 'spheres-in-a-box-98-i10000-256-10', 'Capsules-i100-889', &
    'Capsules-i125-1213', 'Spheres-i099-356-679', 'KaplasTower-i1061-4']
  character(len=*), parameter :: global_files(3) = [character(len=40) :: 'Box_Stacks-i0122-82-5', 'Spheres-i099-356-679', &
                                                    'spheres-in-a-box-98-i10000-256-10']
  type(tests_t) :: t
  integer :: m, seed, blocked

  do m = 1, 3
    call test_cones(m)
  end do
  do seed = 1, 3
    call test_system(2, seed)
    call test_system(3, seed)
  end do
  call test_by_hand()
  do seed = 1, 10
    call test_random(2, seed)
    call test_random(3, seed)
  end do
  blocked = 0
  do seed = 1, 3
    call test_blocked(2, seed, blocked)
    call test_blocked(3, seed, blocked)
  end do
  call t%check(blocked >= 3, 'most of these paths count as blocked')
  call test_nothing()
  call test_files()
  call t%finish()

contains

  !> Identities of the algebra on cones of one size.
  subroutine test_cones(m)
    integer, intent(in) :: m
    type(random_t) :: random
    real(wp) :: x(m), s(m), w(m), dx(m), beta, step, metric(m, m), inverse(m, m), one(m)
    integer :: i
    character(len=:), allocatable :: what

    what = 'cone of '//to_text(m)//': '
    call random%seed(m)
    do i = 1, 20
      x = inside(m, random)
      s = inside(m, random)
      call find_scaling(x, s, w, beta)
      call t%near(determinant(w), 1.0_wp, rounding, what//'determinant of the scaling point')
      dx = scaled_by(w, beta, x, .false.) - scaled_by(w, beta, s, .true.)
      call t%near(maxval(abs(dx)), 0.0_wp, rounding, what//'W x = W^-1 s')
      metric = metric_of(w, beta, .false.)
      inverse = metric_of(w, beta, .true.)
      call t%near(maxval(abs(matmul(metric, x) - s)), 0.0_wp, rounding, what//'W^2 x = s')
      call t%near(maxval(abs(matmul(inverse, s) - x)), 0.0_wp, rounding, what//'W^-2 s = x')
      dx = vector(m, random)
      call t%near(maxval(abs(product_of(x, quotient_of(x, dx)) - dx)), 0.0_wp, 10*rounding, what//'a quotient times its divisor')
      step = longest_step(x, dx)
      if (step < 1e6_wp) then
        call t%near(determinant(x + step*dx)/(1 + step**2), 0.0_wp, rounding, what//'a step to the boundary')
        call t%check(x(1) + step*dx(1) > -rounding*(1 + step), what//'and not to the other cone')
      end if
      one = x + 0.999_wp*min(step, 1e6_wp)*dx
      call t%check(one(1) > 0 .and. determinant(one) > 0, what//'a shorter step stays inside')
    end do
  end subroutine test_cones

  !> (A W + B) dr = g, by unknowns of the contacts and of the bodies.
  subroutine test_system(d, seed)
    integer, intent(in) :: d, seed
    type(matrix_problem_t) :: problem
    type(contact_system_t) :: system
    type(random_t) :: random
    type(error_t), allocatable :: error
    real(wp), allocatable :: a(:, :, :), b(:, :, :), b_inverse(:, :, :), g(:, :), dr(:, :), u(:, :), left(:, :)
    integer :: k, form

    call random_problem(d, seed, 14, 4, problem)
    call random%seed(seed)
    allocate (a(d, d, problem%n), b(d, d, problem%n), b_inverse(d, d, problem%n), g(d, problem%n))
    allocate (dr, u, left, mold=g)
    do k = 1, problem%n
      b(:, :, k) = metric_of(one_column(d), real(k, wp), .false.)
      b_inverse(:, :, k) = metric_of(one_column(d), real(k, wp), .true.)
      g(:, k) = vector(d, random)
    end do
    ! First without a shift, by Cholesky, and every third contact without friction; then with one.
    do form = 1, 4
      problem%has_global = modulo(form, 2) == 0
      do k = 1, problem%n
        a(:, :, k) = one(d)
        if (form > 2) then
          a(:, :, k) = a(:, :, k) + 0.2_wp*matrix(d, random)
        else if (modulo(k, 3) == 0) then
          a(2:, :, k) = 0
          b(:, :, k) = one(d)
          b_inverse(:, :, k) = one(d)
          g(2:, k) = 0
        end if
      end do
      call system%prepare(problem, problem)
      call t%check(system%is_global .eqv. problem%has_global, 'the form that is smaller is taken')
      call system%factorise(problem, form <= 2, a, merge(b_inverse, b, system%is_global), error)
      call t%check(.not. allocated(error), 'the system has factors')
      call t%check(system%factor%is_definite .eqv. form <= 2, 'by Cholesky where it is symmetric')
      if (allocated(error)) return
      call system%solve(problem, g, dr, u)
      call multiply(problem%w, dr, left)
      call t%near(maxval(abs(left - u)), 0.0_wp, rounding, 'with W dr')
      do k = 1, problem%n
        left(:, k) = matmul(a(:, :, k), u(:, k)) + matmul(b(:, :, k), dr(:, k)) - g(:, k)
      end do
      call t%near(maxval(abs(left)), 0.0_wp, 1e3_wp*rounding, 'the system is solved, form '//to_text(form))
      call system%free()
      system = contact_system_t()
    end do
  end subroutine test_system

  !> One contact of mass 1 that sticks, slides, parts, or has no friction.
  subroutine test_by_hand()
    call one_contact([-1.0_wp, 0.2_wp], 0.5_wp, [1.0_wp, -0.2_wp], 'sticks in the plane')
    call one_contact([-1.0_wp, 2.0_wp], 0.5_wp, [1.0_wp, -0.5_wp], 'slides in the plane')
    call one_contact([-1.0_wp, 3.0_wp, 4.0_wp], 0.5_wp, [1.0_wp, -0.3_wp, -0.4_wp], 'slides in space')
    call one_contact([-1.0_wp, 0.03_wp, 0.04_wp], 0.5_wp, [1.0_wp, -0.03_wp, -0.04_wp], 'sticks in space')
    call one_contact([1.0_wp, 3.0_wp, 4.0_wp], 0.5_wp, [0.0_wp, 0.0_wp, 0.0_wp], 'parts')
    call one_contact([-1.0_wp, 3.0_wp, 4.0_wp], 0.0_wp, [1.0_wp, 0.0_wp, 0.0_wp], 'has no friction')
    call one_contact([-1.0_wp, 3.0_wp, 4.0_wp], 100.0_wp, [1.0_wp, -3.0_wp, -4.0_wp], 'has much friction')
  end subroutine test_by_hand

  !> Solve one contact with W = 1.
  subroutine one_contact(q, friction, expected, what)
    real(wp), intent(in) :: q(:), friction, expected(:)
    character(len=*), intent(in) :: what
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    type(interior_point_t) :: solver

    problem%d = size(q)
    problem%n = 1
    problem%w%d = size(q)
    problem%w%n = 1
    problem%w%first = [1_i4, 2_i4]
    problem%w%column = [1_i4]
    problem%w%diagonal = [1_i4]
    allocate (problem%w%block(size(q), size(q), 1), problem%q(size(q), 1), problem%r(size(q), 1))
    problem%w%block(:, :, 1) = one(size(q))
    problem%q(:, 1) = q
    problem%r = 0
    problem%friction = [friction]
    call solver%solve(problem, report)
    call t%check(report%is_converged, 'a contact that '//what//': solved')
    ! The tolerance 1e-8 is relative to |q|, at most 5.1; the error of r is at most (1 + friction) times that, friction bounded.
    call t%near(maxval(abs(problem%r(:, 1) - expected)), 0.0_wp, 1e-7_wp*(1 + friction), 'a contact that '//what)
  end subroutine one_contact

  !> More impulses than bodies can tell apart, friction between 0 and 1.5; in both forms.
  subroutine test_random(d, seed)
    integer, intent(in) :: d, seed
    type(matrix_problem_t) :: problem
    type(interior_point_t) :: solver
    type(report_t) :: report
    integer :: form

    call random_problem(d, seed, 20 + 3*seed, 4 + seed/2, problem)
    do form = 1, 2
      problem%has_global = form == 2
      call check_solved(problem, 'random problem '//to_text(seed)//' of dimension '//to_text(d)//', form '//to_text(form), &
                        solver, report)
    end do
  end subroutine test_random

  !> A path that counts as blocked where e1 does not fall in one step, without Newton's method and proximal points: sweeps go on
  !! from the convex problem.
  subroutine test_blocked(d, seed, blocked)
    integer, intent(in) :: d, seed
    integer, intent(inout) :: blocked !! paths that were, so that sweeps went on
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    type(interior_point_t) :: solver
    character(len=:), allocatable :: what

    what = 'blocked path '//to_text(seed)//' of dimension '//to_text(d)
    call random_problem(d, seed, 20 + 3*seed, 4 + seed/2, problem)
    solver%convex_part = 1e6_wp
    solver%finish_below = 0
    solver%patience = 0
    solver%turn_sweeps = 0
    solver%proximal_share = 0
    call check_solved(problem, what, solver, report)
    if (report%sweeps > 0) blocked = blocked + 1
  end subroutine test_blocked

  !> Solve, and measure independently.
  subroutine check_solved(problem, what, solver, report)
    type(matrix_problem_t), intent(inout) :: problem
    character(len=*), intent(in) :: what
    type(interior_point_t), intent(inout) :: solver
    type(report_t), intent(out) :: report
    type(matrix_errors_t) :: errors
    character(len=9) :: e1

    solver%options%with_trace = .true.
    call solver%solve(problem, report)
    errors = errors_of(problem, problem%r)
    write (e1, '(es9.2)') errors%e1
    call t%check(errors%e1 <= 1e-8_wp, what//': solved, e1 ='//e1)
    call t%check(report%is_converged .eqv. errors%e1 <= 1e-8_wp, what//': what is said of convergence holds')
    call t%check(report%factorisations <= report%iterations .and. size(report%trace) > 0, what//': effort and history')
  end subroutine check_solved

  !> No contact, and contacts that all part.
  subroutine test_nothing()
    type(matrix_problem_t) :: problem
    type(report_t) :: report
    type(interior_point_t) :: solver

    call random_problem(3, 1, 5, 2, problem)
    problem%q = 0
    problem%q(1, :) = 1
    call solver%solve(problem, report)
    call t%check(report%is_converged .and. maxval(abs(problem%r)) <= 0, 'contacts that part carry nothing')
    problem = matrix_problem_t()
    problem%d = 3
    problem%w%d = 3
    allocate (problem%w%first(1), source=1_i4)
    allocate (problem%w%column(0), problem%w%diagonal(0), problem%w%block(3, 3, 0))
    allocate (problem%q(3, 0), problem%r(3, 0), problem%friction(0))
    call solver%solve(problem, report)
    call t%check(report%is_converged, 'no contact at all')
  end subroutine test_nothing

  !> Real problems, where they are at hand.
  subroutine test_files()
    character(len=:), allocatable :: place
    integer :: i

    place = shared_folder()//'/problems/'
    if (.not. (file_exists(place//trim(files(1))//'.hdf5') .and. hdf5_is_available())) then
      write (*, '(a)') 'skipped: real problems need HDF5 and '//place
      return
    end if
    do i = 1, size(files)
      call test_file(place, trim(files(i)))
    end do
    do i = 1, size(global_files)
      call test_file(place//'global/', trim(global_files(i)))
    end do
  end subroutine test_files

  !> One real problem.
  subroutine test_file(folder, name)
    character(len=*), intent(in) :: folder, name
    type(matrix_problem_t) :: problem
    type(interior_point_t) :: solver
    type(report_t) :: report
    type(error_t), allocatable :: error
    logical :: has_guess

    call read_fclib(folder//name//'.hdf5', .false., problem, has_guess, error)
    call t%check(.not. allocated(error), name//': read')
    if (.not. allocated(error)) call check_solved(problem, name, solver, report)
  end subroutine test_file

  !> Bodies of six degrees of freedom (three in the plane) and contacts between them and a fixed one; v = 0 is admissible.
  subroutine random_problem(d, seed, n, bodies, problem)
    integer, intent(in) :: d, seed, n, bodies
    type(matrix_problem_t), intent(out) :: problem
    type(random_t) :: random
    type(error_t), allocatable :: error
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: a, b, i, k, side, dof

    dof = 3*(d - 1)
    call random%seed(100*d + seed)
    problem%d = d
    problem%n = n
    problem%has_global = .true.
    allocate (problem%friction(n), problem%f(dof*bodies), problem%offset(d*n), problem%r(d, n))
    problem%offset = 0
    problem%r = 0
    call sparse_from_triplets(dof*bodies, dof*bodies, [(int(i, i4), i=1, dof*bodies)], [(int(i, i4), i=1, dof*bodies)], &
                              [(random%uniform(0.5_wp, 2.0_wp), i=1, dof*bodies)], problem%mass)
    problem%f = [(2*random%uniform() - 1, i=1, dof*bodies)]
    allocate (row(2*dof*d*n), column(2*dof*d*n), value(2*dof*d*n))
    k = 0
    do a = 1, n
      problem%friction(a) = max(0.0_wp, random%uniform(-0.3_wp, 1.5_wp))
      do side = 1, 1 + mod(a, 2)
        b = 1 + mod(a*side + seed, bodies)
        call add_block(random, d, dof, a, b, row, column, value, k)
      end do
    end do
    call sparse_from_triplets(dof*bodies, d*n, row(:k), column(:k), value(:k), problem%h)
    call condense(problem, error)
    call t%check(.not. allocated(error), 'a random problem has a local form')
  end subroutine random_problem

  !> What a contact does to a body.
  subroutine add_block(random, d, dof, a, b, row, column, value, k)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: d, dof, a, b
    integer(i4), intent(inout) :: row(:), column(:)
    real(wp), intent(inout) :: value(:)
    integer, intent(inout) :: k
    integer :: i, j

    do i = 1, dof
      do j = 1, d
        k = k + 1
        row(k) = int(dof*(b - 1) + i, i4)
        column(k) = int(d*(a - 1) + j, i4)
        value(k) = 2*random%uniform() - 1
      end do
    end do
  end subroutine add_block

  !> A vector inside the cone.
  function inside(m, random) result(x)
    integer, intent(in) :: m
    type(random_t), intent(inout) :: random
    real(wp) :: x(m)

    x = vector(m, random)
    x(1) = norm2(x(2:)) + random%uniform(0.1_wp, 2.0_wp)
  end function inside

  !> Numbers between -1 and 1.
  function vector(m, random) result(x)
    integer, intent(in) :: m
    type(random_t), intent(inout) :: random
    real(wp) :: x(m)
    integer :: i

    do i = 1, m
      x(i) = 2*random%uniform() - 1
    end do
  end function vector

  !> A square matrix of such numbers.
  function matrix(m, random) result(x)
    integer, intent(in) :: m
    type(random_t), intent(inout) :: random
    real(wp) :: x(m, m)
    integer :: i

    do i = 1, m
      x(:, i) = vector(m, random)
    end do
  end function matrix

  !> The matrix with ones on its diagonal.
  pure function one(m) result(x)
    integer, intent(in) :: m
    real(wp) :: x(m, m)
    integer :: i

    x = 0
    do i = 1, m
      x(i, i) = 1
    end do
  end function one

  !> A point of determinant 1 inside the cone.
  pure function one_column(m) result(x)
    integer, intent(in) :: m
    real(wp) :: x(m)

    x = 0.3_wp
    x(1) = sqrt(1 + sum(x(2:)**2))
  end function one_column
end program test_interior_point
