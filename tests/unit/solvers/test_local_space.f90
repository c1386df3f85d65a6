!> The local problem of one contact in space, swept once: against a search over all ways to stick, slide and part, and next to
!! singular blocks.
program test_local_space
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use harness, only: tests_t
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  use sg_records, only: body_length, normal_x, normal_z, record_length, solid_bias_x, solid_bias_z, solid_friction, &
                        solid_frictional, solid_law, solid_s1, solid_s2, solid_tangent_x, solid_tangent_z, solid_wn2, solid_wnn
  use sg_sweep_solid, only: sweep_solid_frictional
  use sg_symmetric, only: principal_axes
  use solver_cases, only: map_in_space
  implicit none
  type(tests_t) :: t

  call test_local()
  call test_extreme()
  call t%finish()

contains

  !> Impulse of one contact whose block is W (axes n, t, n x t) and whose velocity without it is q: one sweep.
  function local_answer(w, q, friction) result(r)
    real(wp), intent(in) :: w(3, 3), q(3), friction
    real(wp) :: record(record_length(solid_frictional), 1), impulse(3, 1), body(body_length(solid_frictional), 2)
    real(wp) :: r(3), s(2, 2), angle, c, d, turned(3, 3)

    s = w(2:3, 2:3) - spread(w(2:3, 1), 2, 2)*spread(w(1, 2:3), 1, 2)/w(1, 1)
    angle = 0.5_wp*atan2(2*s(1, 2), s(1, 1) - s(2, 2))
    c = cos(angle)
    d = sin(angle)
    turned = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, c, d, 0.0_wp, -d, c], [3, 3])
    record = 0
    record(normal_x:normal_z, 1) = [1.0_wp, 0.0_wp, 0.0_wp]
    record(solid_tangent_x:solid_tangent_z, 1) = [0.0_wp, c, d]
    record(solid_bias_x:solid_bias_z, 1) = q
    record(solid_wnn:solid_wn2, 1) = matmul(w(1, :), turned)
    record(solid_s1, 1) = max(16*epsilon(1.0_wp)*maxval(w), c**2*s(1, 1) + 2*c*d*s(1, 2) + d**2*s(2, 2))
    record(solid_s2, 1) = max(16*epsilon(1.0_wp)*maxval(w), d**2*s(1, 1) - 2*c*d*s(1, 2) + c**2*s(2, 2))
    record(solid_friction, 1) = friction
    record(solid_law, 1) = 1
    impulse = 0
    body = 0
    call sweep_solid_frictional(1, 2, reshape([1, 2], [2, 1]), record, 1.0_wp, impulse, body)
    r = impulse(:, 1)
  end function local_answer

  !> A positive definite block with a condition number of up to a limit, as contacts of bodies have them or worse.
  subroutine random_block(random, condition, w)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: condition
    real(wp), intent(out) :: w(3, 3)
    real(wp) :: axes(3, 3), values(3), seed(3, 3)
    integer :: i, j

    do j = 1, 3
      do i = 1, 3
        seed(i, j) = random%normal()
      end do
    end do
    call principal_axes(seed + transpose(seed), values, axes)
    values = [1.0_wp, condition**(-random%uniform()), 1/condition]
    w = matmul(axes, spread(values, 2, 3)*transpose(axes))
    w = (w + transpose(w))/2
  end subroutine random_block

  !> Random blocks of any condition: the answer obeys the law, and a search over all ways to stick, slide and part finds it.
  subroutine test_local()
    real(wp), parameter :: frictions(7) = [0.0_wp, 0.05_wp, 0.3_wp, 0.7_wp, 1.0_wp, 5.0_wp, 100.0_wp]
    real(wp), parameter :: conditions(4) = [1.5_wp, 10.0_wp, 1e3_wp, 1e6_wp]
    type(random_t) :: random
    real(wp) :: w(3, 3), q(3), r(3), worst(size(conditions)), length
    integer :: i, j, k, c, unfound, kinds(3)

    call random%seed(11)
    worst = 0
    unfound = 0
    kinds = 0
    do j = 1, size(conditions)
      do i = 1, size(frictions)
        do k = 1, 100
          call random_block(random, conditions(j), w)
          do c = 1, 3
            q(c) = random%normal()
          end do
          r = local_answer(w, q, frictions(i))
          length = max(norm2(r), norm2(q))
          worst(j) = max(worst(j), norm2(map_in_space(r, matmul(w, r) + q, frictions(i), 1.0_wp))/length)
          if (norm2(r) <= 0) then
            kinds(1) = kinds(1) + 1
          else if (norm2(matmul(w, r) + q) < 1e-6_wp*norm2(q)) then
            kinds(2) = kinds(2) + 1
          else
            kinds(3) = kinds(3) + 1
          end if
          if (j <= 2 .and. .not. is_found(w, q, frictions(i), r)) unfound = unfound + 1
        end do
      end do
    end do
    do j = 1, size(conditions)
      ! The Schur complement loses condition times rounding.
      call t%near(worst(j), 0.0_wp, 1e-12_wp + 100*conditions(j)*epsilon(1.0_wp), 'local problem: the answer obeys the law')
    end do
    call t%equal(unfound, 0, 'local problem: a search finds the answer')
    call t%check(all(kinds > 100), 'local problem: open, stick and slide are all met')
  end subroutine test_local

  !> Is an answer among those of a search: nothing where the contact parts, W r = -q within the cone, and all directions of
  !! sliding at whose impulse the velocity points the other way?
  logical function is_found(w, q, friction, r) result(found)
    real(wp), intent(in) :: w(3, 3), q(3), friction, r(3)
    integer, parameter :: n = 4000
    real(wp) :: side, last, low, high, middle, tolerance
    real(wp) :: tried(3)
    integer :: i, round

    tolerance = 1e-7_wp*max(norm2(q), norm2(r))
    found = q(1) >= 0 .and. norm2(r) <= 0
    if (found) return
    found = norm2(matmul(w, r) + q) <= tolerance .and. hypot(r(2), r(3)) <= friction*r(1) + tolerance
    if (found) return
    if (.not. friction > 0) then
      found = abs(r(1) + q(1)/w(1, 1)) <= tolerance .and. hypot(r(2), r(3)) <= tolerance
      return
    end if
    last = turn_at(w, q, friction, 0.0_wp)
    do i = 1, n
      side = turn_at(w, q, friction, 2*pi*real(i, wp)/n)
      if ((side > 0) .neqv. (last > 0)) then
        low = 2*pi*real(i - 1, wp)/n
        high = 2*pi*real(i, wp)/n
        do round = 1, 60
          middle = (low + high)/2
          if ((turn_at(w, q, friction, middle) > 0) .eqv. (last > 0)) then
            low = middle
          else
            high = middle
          end if
        end do
        tried = sliding(w, q, friction, middle)
        if (tried(1) > 0) found = norm2(tried - r) <= tolerance*max(1.0_wp, friction)
        if (found) return
      end if
      last = side
    end do
  end function is_found

  !> Impulse that closes the contact when it slides against a direction.
  function sliding(w, q, friction, angle) result(p)
    real(wp), intent(in) :: w(3, 3), q(3), friction, angle
    real(wp) :: p(3), lead

    p = [1.0_wp, friction*cos(angle), friction*sin(angle)]
    lead = dot_product(w(1, :), p)
    p = -q(1)/sign(max(abs(lead), 1e-30_wp), lead)*p
  end function sliding

  !> Sine-like measure of the angle between velocity and direction: zero where they are parallel.
  real(wp) function turn_at(w, q, friction, angle)
    real(wp), intent(in) :: w(3, 3), q(3), friction, angle
    real(wp) :: u(3)

    u = matmul(w, sliding(w, q, friction, angle)) + q
    turn_at = u(2)*sin(angle) - u(3)*cos(angle)
  end function turn_at

  !> Blocks next to singular, velocities of any size, friction 0 to 100: finite, no pull, within the cone.
  subroutine test_extreme()
    type(random_t) :: random
    real(wp) :: w(3, 3), q(3), r(3), friction
    integer :: k, c, bad

    call random%seed(12)
    bad = 0
    do k = 1, 20000
      call random_block(random, 10**random%uniform(0.0_wp, 18.0_wp), w)
      w = w*10**random%uniform(-12.0_wp, 12.0_wp)
      do c = 1, 3
        q(c) = random%normal()*10**random%uniform(-15.0_wp, 6.0_wp)
      end do
      if (modulo(k, 7) == 0) q(2:3) = 0
      if (modulo(k, 11) == 0) q(1) = 0
      friction = merge(0.0_wp, 100*random%uniform()**4, modulo(k, 5) == 0)
      if (.not. w(1, 1) > 0) cycle
      r = local_answer(w, q, friction)
      if (.not. all(ieee_is_finite(r))) then
        bad = bad + 1
      else if (r(1) < 0 .or. hypot(r(2), r(3)) > friction*r(1)*(1 + 1e-9_wp) + tiny(1.0_wp)) then
        bad = bad + 1
      end if
    end do
    call t%equal(bad, 0, 'local problem: finite and within the cone whatever the block')
  end subroutine test_extreme
end program test_local_space
