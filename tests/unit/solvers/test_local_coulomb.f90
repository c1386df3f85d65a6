!> The local problem of one contact: residuals on random blocks up to condition 1e10 and friction 100, agreement with a search
!! over all answers, closed forms, and inputs at the edge.
program test_local_coulomb
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use harness, only: tests_t
  use sg_kinds, only: pi, wp
  use sg_local_coulomb, only: solve_local_2, solve_local_3
  use sg_matrix_errors, only: project_on_cone
  use sg_random, only: random_t
  use sg_vectors, only: determinant
  implicit none
  type(tests_t) :: tests
  type(random_t) :: random

  call random%seed(20260)
  call residuals_are_small(2, 100000)
  call residuals_are_small(3, 100000)
  call answers_are_those_of_a_search()
  call closed_forms_hold()
  call units_do_not_matter()
  call edges_are_finite()
  call tests%finish()

contains

  !> A block W of this size: rotated, eigenvalues spread over the condition, with an antisymmetric part.
  subroutine random_block(condition, asymmetry, w)
    real(wp), intent(in) :: condition !! largest eigenvalue over the least; the largest is 1
    real(wp), intent(in) :: asymmetry !! size of the antisymmetric part, over the least eigenvalue
    real(wp), intent(out) :: w(:, :) !! the block
    real(wp) :: q(size(w, 1), size(w, 1)), eigenvalue
    integer :: i, j, d

    d = size(w, 1)
    do i = 1, d
      do j = 1, d
        q(j, i) = random%normal()
      end do
      do j = 1, i - 1
        q(:, i) = q(:, i) - dot_product(q(:, j), q(:, i))*q(:, j)
      end do
      q(:, i) = q(:, i)/norm2(q(:, i))
    end do
    w = 0
    do i = 1, d
      eigenvalue = condition**(-random%uniform())
      if (i == 1) eigenvalue = 1
      if (i == d) eigenvalue = 1/condition
      do j = 1, d
        w(:, j) = w(:, j) + eigenvalue*q(:, i)*q(j, i)
      end do
    end do
    w(1, 2) = w(1, 2) + asymmetry/condition
    w(2, 1) = w(2, 1) - asymmetry/condition
  end subroutine random_block

  !> The natural map with rho = 1 (the largest eigenvalue of W is 1), over what rounding of W r + q leaves of it: an error of
  !! eps (|W| |r| + |q|) in u, of which the tangential part enters the map times 1 + friction.
  function relative_residual(w, q, friction, r) result(residual)
    real(wp), intent(in) :: w(:, :), q(:), friction, r(:)
    real(wp) :: residual, u(size(q))

    u = matmul(w, r) + q
    u(1) = u(1) + friction*norm2(u(2:))
    residual = norm2(r - project_on_cone(r - u, friction))/((1 + friction)*(norm2(r) + norm2(q)))
  end function relative_residual

  !> No random block leaves more than rounding does.
  subroutine residuals_are_small(d, samples)
    integer, intent(in) :: d, samples
    real(wp) :: w(d, d), q(d), r(d), friction, largest, residual
    integer :: i, k, bad, outside, counts(3)

    largest = 0
    bad = 0
    outside = 0
    counts = 0
    do i = 1, samples
      call random_block(10**random%uniform(0.0_wp, 10.0_wp), merge(0.0_wp, random%uniform(0.0_wp, 0.5_wp), modulo(i, 2) == 0), w)
      friction = random%uniform(0.0_wp, 1.5_wp)
      if (modulo(i, 3) == 0) friction = 10**random%uniform(-3.0_wp, 2.0_wp)
      if (modulo(i, 31) == 0) friction = 0
      do k = 1, d
        q(k) = random%normal()*10**random%uniform(-4.0_wp, 0.0_wp)
      end do
      if (modulo(i, 5) /= 0) q(1) = -abs(q(1))
      if (d == 2) call solve_local_2(w, q, friction, r)
      if (d == 3) call solve_local_3(w, q, friction, r)
      if (.not. all(ieee_is_finite(r))) then
        bad = bad + 1
        cycle
      end if
      residual = relative_residual(w, q, friction, r)
      largest = max(largest, residual)
      if (norm2(r(2:)) > friction*r(1)*(1 + 1e-14_wp)) outside = outside + 1
      k = 2
      if (.not. r(1) > 0) k = 1
      if (norm2(r(2:)) >= friction*r(1)*(1 - 1e-14_wp) .and. r(1) > 0) k = 3
      counts(k) = counts(k) + 1
    end do
    call tests%equal(bad, 0, 'impulses that are not finite')
    call tests%equal(outside, 0, 'impulses outside of the cone')
    ! A few tens of roundings of 1.1e-16 are added up in elimination, the map and its parts.
    call tests%near(largest, 0.0_wp, 1e-13_wp, 'largest residual of random blocks')
    call tests%check(all(counts > samples/50), 'open, sticking and sliding contacts all appear')
  end subroutine residuals_are_small

  !> Of all answers that a search over directions of sliding finds, the solver gives one.
  subroutine answers_are_those_of_a_search()
    integer, parameter :: samples = 2000
    real(wp) :: w(3, 3), q(3), r(3), w2(2, 2), r2(2), friction, error
    integer :: i, several

    error = 0
    several = 0
    do i = 1, samples
      call random_block(10**random%uniform(0.0_wp, 3.0_wp), 0.1_wp, w)
      friction = random%uniform(0.0_wp, 2.0_wp)
      q = [-abs(random%normal()), random%normal(), random%normal()]
      call solve_local_3(w, q, friction, r)
      error = max(error, distance_to_answers(w, q, friction, r, several))
    end do
    ! The search ends at angles exact to 1e-13, in impulses of up to 1e3 times q.
    call tests%near(error, 0.0_wp, 1e-9_wp, 'distance to the nearest answer in space')
    call tests%check(several > 0, 'with much friction some contacts have several answers')
    error = 0
    do i = 1, samples
      call random_block(10**random%uniform(0.0_wp, 3.0_wp), 0.1_wp, w2)
      friction = random%uniform(0.0_wp, 2.0_wp)
      q(:2) = [-abs(random%normal()), random%normal()]
      call solve_local_2(w2, q(:2), friction, r2)
      error = max(error, distance_in_plane(w2, q(:2), friction, r2))
    end do
    call tests%near(error, 0.0_wp, 1e-11_wp, 'distance to the nearest answer in the plane')
  end subroutine answers_are_those_of_a_search

  !> Relative distance from r to the nearest answer: sticking, or sliding in a direction found by bisection over the circle.
  function distance_to_answers(w, q, friction, r, several) result(distance)
    real(wp), intent(in) :: w(3, 3), q(3), friction, r(3)
    integer, intent(inout) :: several
    real(wp) :: distance, stick(3), low, high, middle, f_low, f_middle, answer(3), along
    integer, parameter :: parts = 1000
    integer :: i, k, found

    distance = huge(distance)
    found = 0
    stick = -solved(w, q)
    if (norm2(stick(2:)) <= friction*stick(1)) then
      distance = norm2(stick - r)/norm2(stick)
      found = 1
    end if
    do i = 1, parts
      low = 2*pi*real(i - 1, wp)/real(parts, wp)
      high = 2*pi*real(i, wp)/real(parts, wp)
      f_low = across(w, q, friction, low)
      if (f_low*across(w, q, friction, high) > 0) cycle
      do k = 1, 60
        middle = (low + high)/2
        f_middle = across(w, q, friction, middle)
        if (f_low*f_middle > 0) then
          low = middle
          f_low = f_middle
        else
          high = middle
        end if
      end do
      call sliding(w, q, friction, middle, answer, along)
      if (answer(1) <= 0 .or. along > 0) cycle
      found = found + 1
      distance = min(distance, norm2(answer - r)/norm2(answer))
    end do
    if (found > 1) several = several + 1
  end function distance_to_answers

  !> Sliding in a direction with u_N = 0: the impulse, and the velocity along it.
  subroutine sliding(w, q, friction, angle, r, along)
    real(wp), intent(in) :: w(3, 3), q(3), friction, angle
    real(wp), intent(out) :: r(3), along
    real(wp) :: e(3), u(3)

    e = [1.0_wp, friction*cos(angle), friction*sin(angle)]
    r = -q(1)/dot_product(w(1, :), e)*e
    u = matmul(w, r) + q
    along = u(2)*cos(angle) + u(3)*sin(angle)
  end subroutine sliding

  !> Velocity across the direction of sliding, times the normal velocity per normal impulse, so that it has no poles: zero at
  !! an answer.
  function across(w, q, friction, angle) result(velocity)
    real(wp), intent(in) :: w(3, 3), q(3), friction, angle
    real(wp) :: velocity, e(3), u(3)

    e = [1.0_wp, friction*cos(angle), friction*sin(angle)]
    u = matmul(w, e)
    u = q*u(1) - q(1)*u
    velocity = u(3)*cos(angle) - u(2)*sin(angle)
  end function across

  !> In the plane there are three candidates.
  function distance_in_plane(w, q, friction, r) result(distance)
    real(wp), intent(in) :: w(2, 2), q(2), friction, r(2)
    real(wp) :: distance, candidate(2), u(2), side, determinant
    integer :: i

    determinant = w(1, 1)*w(2, 2) - w(1, 2)*w(2, 1)
    candidate = -[w(2, 2)*q(1) - w(1, 2)*q(2), w(1, 1)*q(2) - w(2, 1)*q(1)]/determinant
    distance = huge(distance)
    if (abs(candidate(2)) <= friction*candidate(1)) distance = norm2(candidate - r)/norm2(candidate)
    do i = 1, 2
      side = merge(1.0_wp, -1.0_wp, i == 1)
      candidate = -q(1)/(w(1, 1) + side*friction*w(1, 2))*[1.0_wp, side*friction]
      u = matmul(w, candidate) + q
      if (candidate(1) > 0 .and. side*u(2) <= 0) distance = min(distance, norm2(candidate - r)/norm2(candidate))
    end do
  end function distance_in_plane

  !> W^-1 q by Cramer's rule.
  function solved(w, q) result(x)
    real(wp), intent(in) :: w(3, 3), q(3)
    real(wp) :: x(3), replaced(3, 3)
    integer :: k

    do k = 1, 3
      replaced = w
      replaced(:, k) = q
      x(k) = determinant(replaced)/determinant(w)
    end do
  end function solved

  !> Round contacts, W diagonal: what can be worked out by hand.
  subroutine closed_forms_hold()
    real(wp) :: w(3, 3), r(3), r2(2)

    w = reshape([2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp], [3, 3])
    call solve_local_3(w, [1.0_wp, 3.0_wp, 4.0_wp], 0.5_wp, r)
    call tests%near(norm2(r), 0.0_wp, 0.0_wp, 'a contact that opens')
    call solve_local_3(w, [-4.0_wp, 0.6_wp, -0.8_wp], 0.5_wp, r)
    call tests%near(norm2(r - [2.0_wp, -0.15_wp, 0.2_wp]), 0.0_wp, 1e-15_wp, 'a contact that sticks')
    call solve_local_3(w, [-4.0_wp, 6.0_wp, -8.0_wp], 0.5_wp, r)
    call tests%near(norm2(r - [2.0_wp, -0.6_wp, 0.8_wp]), 0.0_wp, 1e-14_wp, 'a contact that slides')
    call solve_local_3(w, [-4.0_wp, 6.0_wp, -8.0_wp], 0.0_wp, r)
    call tests%near(norm2(r - [2.0_wp, 0.0_wp, 0.0_wp]), 0.0_wp, 1e-15_wp, 'a contact without friction')
    ! Coupled: u_N = 2 r_N + r_T - 2 with r_T = -r_N/2 gives r_N = 4/3; towards +, 2 r_N + r_N/2 = 2 gives 4/5.
    call solve_local_2(reshape([2.0_wp, 1.0_wp, 1.0_wp, 3.0_wp], [2, 2]), [-2.0_wp, 10.0_wp], 0.5_wp, r2)
    call tests%near(norm2(r2 - [4.0_wp/3, -2.0_wp/3]), 0.0_wp, 1e-15_wp, 'sliding in the plane, backwards')
    call solve_local_2(reshape([2.0_wp, 1.0_wp, 1.0_wp, 3.0_wp], [2, 2]), [-2.0_wp, -10.0_wp], 0.5_wp, r2)
    call tests%near(norm2(r2 - [0.8_wp, 0.4_wp]), 0.0_wp, 1e-15_wp, 'sliding in the plane, forwards')
  end subroutine closed_forms_hold

  !> The same contact in other units gives the same impulse in those units.
  subroutine units_do_not_matter()
    real(wp) :: w(3, 3), q(3), r(3), scaled(3), factor(2)
    integer :: i, k

    do i = 1, 100
      call random_block(1e3_wp, 0.1_wp, w)
      q = [-abs(random%normal()), random%normal(), random%normal()]
      call solve_local_3(w, q, 0.4_wp, r)
      do k = 1, 2
        factor = 10.0_wp**merge([40.0_wp, -30.0_wp], [-40.0_wp, 30.0_wp], k == 1)
        call solve_local_3(w*factor(1), q*factor(2), 0.4_wp, scaled)
        if (norm2(scaled*(factor(1)/factor(2)) - r) > 1e-11_wp*norm2(r)) then
          call tests%check(.false., 'an impulse in other units')
          return
        end if
      end do
    end do
    call tests%check(.true., 'impulses in other units')
  end subroutine units_do_not_matter

  !> Blocks that are not positive definite, and numbers at the edge: an answer in the cone, without NaN.
  subroutine edges_are_finite()
    real(wp), parameter :: frictions(6) = [0.0_wp, 1e-300_wp, 1e-8_wp, 1.0_wp, 100.0_wp, 1e8_wp]
    real(wp), parameter :: velocities(5) = [0.0_wp, 1.0_wp, -1.0_wp, 1e-200_wp, -1e-200_wp]
    real(wp) :: w(3, 3, 5), r(3), r2(2), q(3)
    integer :: i, j, k, l, m, bad

    w = 0
    w(:, :, 2) = 1
    w(1, 1, 3) = 1
    w(2, 2, 4) = 1
    do i = 1, 3
      w(i, i, 5) = 1
    end do
    bad = 0
    do m = 1, size(w, 3)
      do l = 1, size(frictions)
        do i = 1, size(velocities)
          do j = 1, size(velocities)
            do k = 1, size(velocities)
              q = velocities([i, j, k])
              call solve_local_3(w(:, :, m), q, frictions(l), r)
              if (.not. all(ieee_is_finite(r)) .or. r(1) < 0 .or. norm2(r(2:)) > frictions(l)*r(1)*(1 + 1e-14_wp)) bad = bad + 1
              call solve_local_2(w(:2, :2, m), q(:2), frictions(l), r2)
              if (.not. all(ieee_is_finite(r2)) .or. r2(1) < 0 .or. abs(r2(2)) > frictions(l)*r2(1)*(1 + 1e-14_wp)) bad = bad + 1
            end do
          end do
        end do
      end do
    end do
    call tests%equal(bad, 0, 'edges without a finite impulse in the cone')
  end subroutine edges_are_finite
end program test_local_coulomb
