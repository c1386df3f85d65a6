!> Bounds of the velocity by which contacts break their laws: never below it, and above it by little.
program test_law_violation
  use harness, only: tests_t
  use sg_kinds, only: wp
  use sg_law_violation, only: law_violation, plane_bounds, space_bounds
  use sg_natural_map, only: chunk
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: arm_frictional, ball_frictional, round_frictional, solid_frictional
  use sg_residuals, only: find_worst, n_error_sums, sum_errors
  use sg_text, only: to_text
  implicit none
  integer, parameter :: kinds(4) = [round_frictional, arm_frictional, ball_frictional, solid_frictional]
  integer, parameter :: sizes(5) = [1, chunk, chunk + 1, 10*chunk - 1, 20*chunk]
  type(tests_t) :: tests
  type(random_t) :: random
  integer :: round, kind, n

  call random%seed(7)
  do round = 1, 40
    call bounds_are_close(random)
  end do
  do kind = 1, size(kinds)
    do n = 1, size(sizes)
      call worst_is_found(kinds(kind), sizes(n), random)
    end do
  end do
  call tests%finish()

contains

  !> The worst contact of a random problem is the same with the bounds of a test as among all contacts.
  subroutine worst_is_found(kind, n, random)
    integer, intent(in) :: kind, n
    type(random_t), intent(inout) :: random
    type(problem_t) :: problem
    real(wp), allocatable :: bounds(:)
    real(wp) :: sums(n_error_sums), speed(2)
    integer :: contact(2), i, k

    call reserve_problem(problem, kind, 50, n)
    problem%pair(:, 1:n) = reshape([(1 + modulo(7*k, 50), k=1, 2*n)], [2, n])
    do k = 1, n
      do i = 1, size(problem%record, 1)
        problem%record(i, k) = random%uniform()
      end do
      do i = 1, size(problem%impulse, 1)
        problem%impulse(i, k) = random%uniform(-1.0_wp, 1.0_wp)
      end do
    end do
    do k = 1, 50
      do i = 1, size(problem%body, 1)
        problem%body(i, k) = random%uniform()
      end do
    end do
    call sum_errors(problem, .true., sums, bounds=bounds)
    call find_worst(problem, contact(1), speed(1))
    call find_worst(problem, contact(2), speed(2), bounds)
    call tests%check(speed(1) > 0 .or. n == 1, 'laws are broken')
    call tests%equal(contact(2), contact(1), 'worst contact, kind '//to_text(kind)//', '//to_text(n)//' contacts')
    call tests%near(speed(2), speed(1), 0.0_wp, 'its velocity')
  end subroutine worst_is_found

  !> Random contacts of all kinds and sizes: their bounds next to the velocities themselves.
  subroutine bounds_are_close(random)
    type(random_t), intent(inout) :: random
    real(wp) :: normal(chunk, 3), u(chunk, 3), r(chunk, 3), friction(chunk), rho(chunk), linear(chunk)
    real(wp) :: plane(chunk), space(chunk), speed(2), least(2)
    integer :: i

    do i = 1, chunk
      call draw_contact(random, normal(i, :), u(i, :), r(i, :), friction(i), rho(i), linear(i))
    end do
    call plane_bounds(chunk, u(:, 1), u(:, 2), r(:, 1), r(:, 2), friction, rho, linear, plane)
    call space_bounds(chunk, normal, u, r, friction, rho, linear, space)
    do i = 1, chunk
      speed(1) = law_violation(u(i, :2), r(i, :2), friction(i), rho(i), linear(i) > 0)
      speed(2) = law_violation(split(normal(i, :), u(i, :)), split(normal(i, :), r(i, :)), friction(i), rho(i), linear(i) > 0)
      call tests%check(plane(i) >= speed(1)**2 .and. space(i) >= speed(2)**2, 'bounds are no lower than the velocity')
      ! What bounds are raised by, and rounding of the velocity itself: 1e-10 of all velocities at hand.
      least = 0
      if (rho(i) > 0) least = 1e-10_wp*(norm2(u(i, :)) + norm2(r(i, :))/rho(i))
      call tests%check(all(sqrt([plane(i), space(i)]) <= speed*(1 + 1e-6_wp) + least), 'bounds are close')
    end do
  end subroutine bounds_are_close

  !> A contact that slips, sticks, is open or takes no part, some of them to rounding; some laws are linear.
  subroutine draw_contact(random, normal, u, r, friction, rho, linear)
    type(random_t), intent(inout) :: random
    real(wp), intent(out) :: normal(3), u(3), r(3), friction, rho, linear
    real(wp) :: x(9)
    integer :: i

    do i = 1, size(x)
      x(i) = random%uniform()
    end do
    normal = x(:3) - 0.5_wp
    normal = normal/norm2(normal)
    rho = 10**(6*x(4) - 3)
    friction = merge(0.0_wp, 10**(8*x(5) - 4), x(5) < 0.2_wp)
    linear = merge(1.0_wp, 0.0_wp, x(6) < 0.1_wp)
    do i = 1, 3
      u(i) = random%uniform()
      r(i) = random%uniform()
    end do
    u = (u - 0.5_wp)*10**(20*x(7) - 16)
    r = (r - 0.5_wp)*10**(8*x(8) - 4)
    if (x(9) < 0.2_wp) r = 0
    if (x(9) > 0.9_wp) u = 0
    if (x(9) > 0.45_wp .and. x(9) < 0.5_wp) rho = 0
    ! Neither impulse nor velocity across the normal.
    if (x(9) > 0.7_wp .and. x(9) < 0.75_wp) then
      normal = [1.0_wp, 0.0_wp, 0.0_wp]
      u(2:) = 0
      r(2:) = 0
    end if
  end subroutine draw_contact

  !> Normal part of a vector, and what is across the normal.
  pure function split(normal, x) result(parts)
    real(wp), intent(in) :: normal(3), x(3)
    real(wp) :: parts(4)

    parts = [dot_product(normal, x), x - dot_product(normal, x)*normal]
  end function split
end program test_law_violation
