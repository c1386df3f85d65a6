!> Contacts with moments, one by one and as a problem: local answers obey the law at random blocks, the block of a record is that of
!! its two bodies, and errors vanish exactly where the law is obeyed.
program test_local_rolling
  use harness, only: tests_t
  use sg_compact, only: add_impulses, compact_velocity, relative_spin
  use sg_delassus, only: block_times, set_block
  use sg_kinds, only: wp
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: arm_friction, arm_gyration, arm_inverse_i, arm_inverse_mx, arm_law, arm_moment_nc, arm_moment_ta, &
                        arm_rolling, arm_rolling_length, normal_x, normal_z, solid_arm_ax, solid_arm_az, solid_arm_cx, &
                        solid_arm_cz, solid_friction, solid_gyration, solid_inverse_mx, solid_inverse_mz, solid_inverse_xx, &
                        solid_inverse_yz, solid_law, solid_rolling, solid_rolling_length, solid_tangent_x, solid_tangent_z, &
                        solid_twisting_length
  use sg_report, only: report_t
  use sg_residuals, only: find_worst, measure_errors
  use sg_residuals_rolling, only: project_parts
  use sg_mapping_space, only: tangent_of
  use sg_sweep_arm_rolling, only: rolling_step
  use sg_sweep_solid_rolling, only: spatial_rolling_step
  use sg_text, only: to_text
  use solver_cases, only: solver_of
  use sg_nlgs, only: nlgs_t
  use sg_run_options, only: criterion_e8
  implicit none
  type(tests_t) :: t

  call test_plane_step()
  call test_space_step()
  call test_projection()
  call test_block(arm_rolling)
  call test_block(solid_rolling)
  call test_errors(arm_rolling)
  call test_errors(solid_rolling)
  call t%finish()

contains

  !> A positive definite block, diagonal 1 in the mean, with some coupling.
  function random_block(random, n, condition) result(w)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: n
    real(wp), intent(in) :: condition
    real(wp) :: w(n, n), seed(n, n)
    integer :: i, j

    do j = 1, n
      do i = 1, n
        seed(i, j) = random%normal()
      end do
      seed(:, j) = seed(:, j)*condition**(-0.5_wp*random%uniform())
    end do
    w = matmul(transpose(seed), seed)
    do i = 1, n
      w(i, i) = w(i, i) + 1/condition
    end do
  end function random_block

  !> By what velocity an answer breaks the law of one part.
  pure real(wp) function broken(r, u, largest)
    real(wp), intent(in) :: r(:), u(:), largest

    broken = max(0.0_wp, norm2(r) - largest)
    if (largest > 0) broken = max(broken, norm2(u*largest + r*norm2(u))*merge(1.0_wp, 0.0_wp, norm2(u) > 1e-9_wp))
    if (norm2(u) > 1e-9_wp) broken = max(broken, largest - norm2(r))
  end function broken

  !> The exact solution of the plane, at blocks of any kind.
  subroutine test_plane_step()
    real(wp), parameter :: bounds(4) = [0.0_wp, 0.1_wp, 0.6_wp, 2.0_wp]
    type(random_t) :: random
    real(wp) :: w(3, 3), q(3), r(3), u(3), worst
    integer :: i, j, k, c, carried

    call random%seed(3)
    worst = 0
    carried = 0
    do i = 1, size(bounds)
      do j = 1, size(bounds)
        do k = 1, 200
          w = random_block(random, 3, 10.0_wp)
          do c = 1, 3
            q(c) = random%normal()
          end do
          call rolling_step(w, [bounds(i), bounds(j)], q, r)
          u = q + matmul(w, r)
          if (r(1) > 0) carried = carried + 1
          worst = max(worst, merge(abs(u(1)), max(0.0_wp, -u(1)), r(1) > 0)/(1 + norm2(q)), &
                      broken(r(2:2), u(2:2), bounds(i)*r(1))/(1 + norm2(r)), broken(r(3:3), u(3:3), bounds(j)*r(1))/(1 + norm2(r)))
        end do
      end do
    end do
    call t%near(worst, 0.0_wp, 1e-9_wp, 'plane: local answers obey the law')
    call t%check(carried > 1000, 'plane: contacts carry')
  end subroutine test_plane_step

  !> The iterated solution in space, at blocks of any kind.
  subroutine test_space_step()
    real(wp), parameter :: bounds(3) = [0.0_wp, 0.1_wp, 0.6_wp]
    type(random_t) :: random
    real(wp) :: w(6, 6), q(6), r(6), u(6), of_one
    integer :: i, j, k, c, carried, inexact

    call random%seed(5)
    carried = 0
    inexact = 0
    do i = 1, size(bounds)
      do j = 1, size(bounds)
        do k = 1, 200
          w = random_block(random, 6, 10.0_wp)
          do c = 1, 6
            q(c) = random%normal()
          end do
          call spatial_rolling_step(w, [bounds(i), bounds(j), bounds(1 + mod(i, 3))], q, 0*q, r)
          u = q + matmul(w, r)
          if (.not. r(1) > 0) cycle
          carried = carried + 1
          of_one = max(abs(u(1)), broken(r(2:3), u(2:3), bounds(i)*r(1)), broken(r(4:5), u(4:5), bounds(j)*r(1)), &
                       broken(r(6:6), u(6:6), bounds(1 + mod(i, 3))*r(1)))/(1 + norm2(r))
          if (of_one > 1e-8_wp) inexact = inexact + 1
        end do
      end do
    end do
    call t%check(carried > 600, 'space: contacts carry')
    call t%equal(inexact, 0, 'space: local answers obey the law')
  end subroutine test_space_step

  !> The projection on the cone: what is left is across the cone, and a search near it finds nothing nearer.
  subroutine test_projection()
    type(random_t) :: random
    real(wp) :: bound(3), point, parts(3, 3), normal, nearest(3, 3), tried(3, 3), height, least, distance
    integer :: round, i, j, n

    call random%seed(9)
    do round = 1, 200
      do i = 1, 3
        bound(i) = merge(0.0_wp, random%uniform(), round == i)
        do j = 1, 3
          parts(j, i) = random%normal()
        end do
      end do
      point = random%normal()
      normal = point
      nearest = parts
      call project_parts(bound, normal, nearest)
      least = (normal - point)**2 + sum((nearest - parts)**2)
      call t%check(normal >= 0 .and. all(norm2(nearest, 1) <= bound*normal*(1 + 1e-14_wp)), 'projection: on the cone')
      ! At any height the nearest point is a cut one.
      distance = huge(distance)
      do n = 0, 2000
        height = 5*real(n, wp)/2000
        do i = 1, 3
          tried(:, i) = parts(:, i)*min(1.0_wp, bound(i)*height/norm2(parts(:, i)))
        end do
        distance = min(distance, (height - point)**2 + sum((tried - parts)**2))
      end do
      call t%check(least <= distance + 1e-12_wp .and. distance <= least + 1e-4_wp, 'projection: the nearest')
    end do
  end subroutine test_projection

  !> A problem of one contact of two bodies with random arms, masses and lengths.
  subroutine make_contact(kind, random, problem)
    integer, intent(in) :: kind
    type(random_t), intent(inout) :: random
    type(problem_t), intent(out) :: problem
    real(wp) :: n(3)
    integer :: b, i

    call reserve_problem(problem, kind, 2, 1)
    problem%pair(:, 1) = [1, 2]
    do b = 1, 2
      do i = 1, size(problem%body, 1)
        problem%body(i, b) = 0
      end do
    end do
    n = [random%normal(), random%normal(), random%normal()]
    associate (record => problem%record(:, 1), body => problem%body)
      record = 0
      if (kind == arm_rolling) then
        record(normal_x:normal_x + 1) = n(:2)/norm2(n(:2))
        do i = arm_moment_nc, arm_moment_ta
          record(i) = random%normal()
        end do
        do b = 1, 2
          body(arm_inverse_mx:arm_inverse_i, b) = [1.0_wp, 1.0_wp, 1.5_wp]*(0.5_wp + real(b, wp))
        end do
        record(arm_law) = 1
        record(arm_friction) = 0.4_wp
        record(arm_rolling_length) = 0.1_wp
      else
        n = n/norm2(n)
        record(normal_x:normal_z) = n
        record(solid_tangent_x:solid_tangent_z) = tangent_of(n)
        record(solid_arm_cx:solid_arm_cz) = [random%normal(), random%normal(), random%normal()]
        record(solid_arm_ax:solid_arm_az) = [random%normal(), random%normal(), random%normal()]
        do b = 1, 2
          body(solid_inverse_mx:solid_inverse_mz, b) = 0.5_wp + real(b, wp)
          body(solid_inverse_xx:solid_inverse_yz, b) = [1.0_wp, 1.5_wp, 2.0_wp, 0.1_wp, -0.2_wp, 0.3_wp]*real(b, wp)
        end do
        record(solid_law) = 1
        record(solid_friction) = 0.4_wp
        record(solid_rolling_length:solid_twisting_length) = [0.1_wp, 0.05_wp]
      end if
    end associate
    call set_block(kind, problem%body(:, 1), problem%body(:, 2), problem%record(:, 1))
  end subroutine make_contact

  !> The block in the record times an impulse is what the impulse does to the bodies, seen at the contact.
  subroutine test_block(kind)
    integer, intent(in) :: kind
    type(random_t) :: random
    type(problem_t) :: problem
    real(wp) :: v(6), seen(6), length, scaled(6)
    integer :: round, i, m

    call random%seed(21)
    m = merge(6, 3, kind == solid_rolling)
    do round = 1, 20
      call make_contact(kind, random, problem)
      length = problem%record(merge(solid_gyration, arm_gyration, kind == solid_rolling), 1)
      do i = 1, m
        problem%impulse(i, 1) = random%normal()
      end do
      scaled = 0
      scaled(:m) = problem%impulse(:, 1)
      if (m == 3) scaled(3) = scaled(3)/length
      if (m == 6) scaled(4:) = scaled(4:)/length
      v = block_times(kind, problem%record(:, 1), scaled)
      call add_impulses(problem)
      seen = 0
      if (m == 3) then
        seen(:3) = compact_velocity(problem, 1) + length*relative_spin(problem, 1)
      else
        seen = [compact_velocity(problem, 1), length*relative_spin(problem, 1)]
      end if
      call t%near(norm2(v - seen), 0.0_wp, 1e-12_wp*norm2(seen), 'block of kind '//to_text(kind))
    end do
  end subroutine test_block

  !> Solved by sweeps, a contact that closes and spins has no error; with its moment changed, its spin or its slip, it has.
  subroutine test_errors(kind)
    integer, intent(in) :: kind
    type(random_t) :: random
    type(problem_t) :: problem, other
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp) :: speed
    integer :: contact, round, i

    call random%seed(33)
    solver = solver_of(criterion_e8, 1e-12_wp, 1000)
    do round = 1, 20
      call make_contact(kind, random, problem)
      do i = 1, merge(6, 3, kind == solid_rolling)
        problem%body(i, 1) = random%normal()
      end do
      associate (n => problem%record(normal_x:merge(normal_z, normal_z - 1, kind == solid_rolling), 1))
        problem%body(:size(n), 1) = problem%body(:size(n), 1) - 5*n
      end associate
      problem%free_norm = 1
      problem%velocity_scale = 1
      call solver%solve(problem, report)
      call t%check(report%is_converged, 'errors: solved')
      call measure_errors(problem, report, .true.)
      call t%near(max(report%e1, report%e2, report%e8, report%violation), 0.0_wp, 1e-10_wp, 'errors: none at the solution')
      contact = 0
      call find_worst(problem, contact, speed)
      call t%near(speed, 0.0_wp, 1e-10_wp, 'errors: no worst contact')
      do i = 1, size(problem%impulse, 1)
        other = problem
        other%impulse = 0
        other%impulse(i, 1) = 1e-3_wp*(1 + abs(problem%impulse(i, 1)))
        call add_impulses(other)
        other%impulse(:, :1) = other%impulse(:, :1) + problem%impulse(:, :1)
        call measure_errors(other, report, .true.)
        call t%check(min(report%e1, report%e8, report%violation) > 1e-8_wp, 'errors: another impulse has one')
      end do
    end do
  end subroutine test_errors
end program test_local_rolling
