!> Solvers of matrices say that they have converged only of answers in which every contact obeys its law: random problems with one
!! velocity far above the others, huge friction, masses and units far apart, loads of rounding size, and zero impulses as a bait.
program test_matrix_verdicts
  use harness, only: tests_t
  use matrices, only: sparse
  use sg_choose_solver, only: choose_matrix_solver
  use sg_condense, only: set_local_form
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_matrix_errors, only: find_worst_contact, most_share
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_options_t, matrix_solver_t
  use sg_methods, only: solver_names
  use sg_random, only: random_t
  use sg_report, only: report_t
  use sg_text, only: to_text
  implicit none

  !> Problems drawn
  integer, parameter :: n_problems = 120
  type(tests_t) :: tests
  type(random_t) :: random
  integer :: i, converged, solved

  converged = 0
  solved = 0
  call random%seed(41)
  do i = 1, n_problems
    call test_problem(i)
  end do
  call zero_is_refused()
  ! A test in which nothing converges would find nothing.
  call tests%check(4*converged > 3*solved, 'most solves converge: '//to_text(converged)//' of '//to_text(solved))
  call tests%finish()

contains

  !> One problem by all solvers.
  subroutine test_problem(number)
    integer, intent(in) :: number
    type(matrix_problem_t) :: start, problem
    class(matrix_solver_t), allocatable :: solver
    type(matrix_options_t) :: options
    type(error_t), allocatable :: error
    type(report_t) :: report
    real(wp), allocatable :: w(:, :)
    character(len=:), allocatable :: name
    character(len=16), allocatable :: methods(:)
    integer :: k

    methods = solver_names()
    call draw_problem(number, start, w)
    options%tolerance = merge(1e-8_wp, 1e-4_wp, modulo(number, 3) > 0)
    options%maximum_iterations = 400
    options%maximum_seconds = 1
    do k = 1, size(methods)
      call choose_matrix_solver(trim(methods(k)), options, solver, error)
      if (allocated(error)) cycle
      problem = start
      call solver%solve(problem, report)
      name = 'problem '//to_text(number)//' by '//trim(methods(k))
      solved = solved + 1
      if (report%is_converged) then
        converged = converged + 1
        call tests%check(report%e1 <= options%tolerance, name//': e1')
        call check_contacts(name, problem, w)
      end if
      deallocate (solver)
    end do
  end subroutine test_problem

  !> A few bodies and contacts between them at random, W = H^T M^-1 H in full.
  subroutine draw_problem(number, problem, w)
    integer, intent(in) :: number
    type(matrix_problem_t), intent(out) :: problem
    real(wp), allocatable, intent(out) :: w(:, :)
    real(wp), parameter :: frictions(5) = [0.5_wp, 0.0_wp, 10.0_wp, 1e3_wp, 1e6_wp]
    real(wp), allocatable :: h(:, :), q(:)
    real(wp) :: mass, spread
    integer :: n, dof, i, j

    problem%d = 2 + modulo(number, 2)
    n = 2 + modulo(number, 5)
    problem%n = n
    dof = 3*n
    allocate (h(problem%d*n, dof), q(problem%d*n))
    do j = 1, dof
      do i = 1, size(q)
        h(i, j) = random%uniform(-1.0_wp, 1.0_wp)
      end do
    end do
    spread = merge(4.0_wp, 0.3_wp, modulo(number, 7) == 3)
    do j = 1, dof
      mass = 10**random%uniform(-spread, spread)
      h(:, j) = h(:, j)/sqrt(mass)
    end do
    w = matmul(h, transpose(h))*10**merge(random%uniform(-8.0_wp, 8.0_wp), 0.0_wp, modulo(number, 4) == 1)
    do i = 1, size(q)
      q(i) = random%uniform(-1.0_wp, 1.0_wp)
    end do
    select case (modulo(number, 6))
    case (1, 2)
      ! One velocity beside which the others are nothing; of a contact that opens it is a bait, and zero all but solves the problem.
      j = 1 + problem%d*int(random%uniform()*real(n, wp)*0.999_wp)
      q(j) = 1e10_wp*merge(1.0_wp, q(j), modulo(number, 6) == 1)
    case (3)
      q = q*1e-17_wp
      q(2) = 1
    case (4)
      q(1::problem%d) = 0
    end select
    problem%friction = frictions(1 + modulo(number/2 + [(i, i=1, n)]*modulo(number, 2), 5))
    call set_local_form(problem, sparse(w), q)
    allocate (problem%r(problem%d, n), source=0.0_wp)
  end subroutine draw_problem

  !> Signorini's and Coulomb's laws of each contact, from the full matrix, relative to what acts on it; the bound of the solvers is
  !! a tenth, in other norms.
  subroutine check_contacts(name, problem, w)
    character(len=*), intent(in) :: name
    type(matrix_problem_t), intent(in) :: problem
    real(wp), intent(in) :: w(:, :)
    real(wp) :: r(size(w, 1)), q(size(w, 1)), u(problem%d), acting(problem%d), most, reserve, mobility
    integer :: a, i

    r = reshape(problem%r, [size(r)])
    q = reshape(problem%q, [size(r)])
    do a = 1, problem%n
      do i = 1, problem%d
        associate (row => problem%d*(a - 1) + i)
          u(i) = q(row) + dot_product(w(row, :), r)
          acting(i) = abs(q(row)) + dot_product(abs(w(row, :)), abs(r))
        end associate
      end do
      associate (n => w(problem%d*(a - 1) + 1, problem%d*(a - 1) + 1), own => problem%r(:, a))
        acting = acting + 1e-13_wp*maxval(abs(q))
        most = 0.11_wp*acting(1)
        call tests%check(u(1) >= -most, name//', contact '//to_text(a)//': it does not close')
        call tests%check(n*own(1) >= -most, name//', contact '//to_text(a)//': it does not pull')
        call tests%check(min(u(1), n*own(1)) <= most, name//', contact '//to_text(a)//': it opens or carries')
        mobility = w(problem%d*(a - 1) + 2, problem%d*(a - 1) + 2)
        reserve = mobility*(problem%friction(a)*max(own(1), 0.0_wp) - norm2(own(2:)))
        most = 0.22_wp*max(acting(1), min(norm2(acting(2:)), mobility*problem%friction(a)*max(own(1), 0.0_wp)))
        call tests%check(reserve >= -most, name//', contact '//to_text(a)//': friction is within its cone')
        call tests%check(reserve <= most .or. norm2(u(2:)) <= 2*most, name//', contact '//to_text(a)//': it sticks within it')
      end associate
    end do
  end subroutine check_contacts

  !> Zero impulses where one contact opens at 1e10 m/s and another closes at 1: e1 is 1e-10, and the contact that closes is named.
  subroutine zero_is_refused()
    type(matrix_problem_t) :: problem
    real(wp) :: share
    integer :: contact

    problem%d = 2
    problem%n = 2
    problem%friction = [0.5_wp, 0.5_wp]
    call set_local_form(problem, sparse(reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
                                                 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [4, 4])), &
                        [1e10_wp, 0.0_wp, -1.0_wp, 0.0_wp])
    allocate (problem%r(2, 2), source=0.0_wp)
    call find_worst_contact(problem, problem%r, contact, share)
    call tests%equal(contact, 2, 'zero impulses: the contact that closes')
    call tests%near(share, 1.0_wp, 2e-3_wp, 'zero impulses: undone up to rounding')
    call tests%check(share > most_share, 'zero impulses: no answer')
  end subroutine zero_is_refused
end program test_matrix_verdicts
