!> Gauss-Seidel sweep over contacts in space of which some bear moments that resist rolling and twisting, and their local problem
!! (doc/theory/laws.md, "Rolling and twisting").
module sg_sweep_solid_rolling
  use sg_delassus, only: whole_block
  use sg_kinds, only: wp, i4
  use sg_records, only: body_length, bond_shift, least_active, normal_x, normal_z, record_length, solid_arm_ax, solid_arm_az, &
                        solid_arm_cx, solid_arm_cz, solid_bias_x, solid_bias_z, solid_bonded, solid_cohesion, solid_compliance_n, &
                        solid_compliance_t, solid_friction, solid_frictional, solid_gyration, solid_inverse_lambda, &
                        solid_inverse_mx, solid_inverse_mz, solid_inverse_xx, solid_inverse_yz, solid_law, solid_mixed, &
                        solid_rolling, solid_rolling_length, solid_spin_x, solid_spin_z, solid_stiffness_n, solid_stiffness_t, &
                        solid_tangent_x, solid_tangent_z, solid_twisting_length, velocity_x, velocity_z
  use sg_sweep_solid, only: sweep_solid_bonded, sweep_solid_frictional
  use sg_vectors, only: cross
  implicit none
  private
  public :: sweep_solid_rolling, sweep_solid_mixed, spatial_rolling_step

  !> First and last component of each impulse that the normal one bounds: tangential force, rolling moment, twisting moment
  integer, parameter :: first(3) = [2, 4, 6], last(3) = [3, 5, 6]

contains

  !> One sweep; contacts that resist neither are those of the frictional kind.
  pure subroutine sweep_solid_rolling(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(solid_rolling), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(6, n) !! impulses [N s], and moments over the step [N m s], in the world's axes
    real(wp), intent(inout) :: body(body_length(solid_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: frame(3, 3), axes(3, 3), w(6, 6), u(6), old(6), r(6), p(3), moment(3), length

    do k = 1, n
      if (record(solid_law, k) < least_active) cycle
      length = record(solid_gyration, k)
      if (.not. length > 0) then
        call sweep_solid_frictional(1, n_bodies, pair(:, k), record(:record_length(solid_frictional), k), relaxation, &
                                    impulse(:3, k), body)
        cycle
      end if
      c = pair(1, k)
      a = pair(2, k)
      frame(:, 1) = record(normal_x:normal_z, k)
      frame(:, 2) = record(solid_tangent_x:solid_tangent_z, k)
      frame(:, 3) = cross(frame(:, 1), frame(:, 2))
      axes = frame(:, [2, 3, 1])
      old = [matmul(impulse(:3, k), frame), matmul(impulse(4:, k), axes)/length]
      u(:3) = matmul(body(velocity_x:velocity_z, c) - body(velocity_x:velocity_z, a) &
              + cross(body(solid_spin_x:solid_spin_z, c), record(solid_arm_cx:solid_arm_cz, k)) &
              - cross(body(solid_spin_x:solid_spin_z, a), record(solid_arm_ax:solid_arm_az, k)) &
              + record(solid_bias_x:solid_bias_z, k), frame) &
              + record([solid_compliance_n, solid_compliance_t, solid_compliance_t], k)*old(:3)
      u(4:) = length*matmul(body(solid_spin_x:solid_spin_z, c) - body(solid_spin_x:solid_spin_z, a), axes)
      old(1) = old(1) + record(solid_cohesion, k)
      w = whole_block(record(:, k))
      call spatial_rolling_step(w, [record(solid_friction, k), record(solid_rolling_length:solid_twisting_length, k)/length], &
                                u - matmul(w, old), old, r)
      r = relaxation*(r - old)
      p = matmul(frame, r(:3))
      moment = length*matmul(axes, r(4:))
      impulse(:, k) = impulse(:, k) + [p, moment]
      call push(body(:, c), p, cross(record(solid_arm_cx:solid_arm_cz, k), p) + moment)
      call push(body(:, a), -p, -cross(record(solid_arm_ax:solid_arm_az, k), p) - moment)
    end do
  end subroutine sweep_solid_rolling

  !> One sweep over contacts of which some are held by cohesive zones and others bear moments.
  pure subroutine sweep_solid_mixed(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(solid_mixed), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(6, n) !! impulses [N s], and moments over the step [N m s], in the world's axes
    real(wp), intent(inout) :: body(body_length(solid_frictional), n_bodies) !! records of bodies; their velocities change
    real(wp) :: bonded(record_length(solid_bonded))
    integer :: k, shift

    shift = bond_shift(solid_mixed)
    do k = 1, n
      if (record(solid_law, k) > least_active .and. &
          .not. max(record(solid_stiffness_n + shift, k), record(solid_stiffness_t + shift, k)) > 0) then
        call sweep_solid_rolling(1, n_bodies, pair(:, k), record(:record_length(solid_rolling), k), relaxation, impulse(:, k), body)
      else
        bonded(:solid_inverse_lambda) = record(:solid_inverse_lambda, k)
        bonded(solid_stiffness_n:) = record(solid_stiffness_n + shift:, k)
        call sweep_solid_bonded(1, n_bodies, pair(:, k), bonded, relaxation, impulse(:3, k), body)
      end if
    end do
  end subroutine sweep_solid_mixed

  !> Give a body an impulse and an angular one about its centre.
  pure subroutine push(body, p, angular)
    real(wp), intent(inout) :: body(body_length(solid_frictional))
    real(wp), intent(in) :: p(3), angular(3)

    body(velocity_x:velocity_z) = body(velocity_x:velocity_z) + body(solid_inverse_mx:solid_inverse_mz)*p
    associate (inverse => body(solid_inverse_xx:solid_inverse_yz))
      body(solid_spin_x) = body(solid_spin_x) + inverse(1)*angular(1) + inverse(4)*angular(2) + inverse(5)*angular(3)
      body(solid_spin_x + 1) = body(solid_spin_x + 1) + inverse(4)*angular(1) + inverse(2)*angular(2) + inverse(6)*angular(3)
      body(solid_spin_z) = body(solid_spin_z) + inverse(5)*angular(1) + inverse(6)*angular(2) + inverse(3)*angular(3)
    end associate
  end subroutine push

  !> The local problem: impulse and moments of one contact, all others fixed, for u = W r + q with a symmetric positive definite
  !! block: 0 <= r_n complementary to u_n >= 0, and each part r_i of the others (tangential force, rolling moment, twisting moment)
  !! has |r_i| <= mu_i r_n, and r_i = -mu_i r_n u_i/|u_i| where u_i is not zero.
  !!
  !! Newton's method on the projections of [AlartCurnier1991], from the last visit; where it does not arrive, projections one part
  !! after the other, whose fixed points are the same solutions, come nearer, and it tries once more. Sweeps do the rest.
  pure subroutine spatial_rolling_step(w, bound, q, before, r)
    real(wp), intent(in) :: w(6, 6) !! block of W, moments and spins in units of impulses and velocities [1/kg]
    real(wp), intent(in) :: bound(3) !! Coulomb's coefficient, and largest moments of rolling and twisting over the normal impulse
    real(wp), intent(in) :: q(6) !! velocity without this impulse [m/s]
    real(wp), intent(in) :: before(6) !! impulse of the last visit [N s]
    real(wp), intent(out) :: r(6) !! impulse [N s]
    real(wp) :: nearer(6)
    logical :: is_there

    r = 0
    if (q(1) >= 0) return
    r = before
    if (.not. r(1) > 0) r = [-q(1)/w(1, 1), 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    nearer = r
    call newton(w, bound, q, r, is_there)
    if (is_there) return
    call approach(w, bound, q, nearer)
    r = nearer
    call newton(w, bound, q, r, is_there)
    if (.not. is_there) r = nearer
  end subroutine spatial_rolling_step

  !> Projections one part after the other: each part by a step along its velocity over the trace of its block, then to its bound.
  pure subroutine approach(w, bound, q, r)
    real(wp), intent(in) :: w(6, 6), bound(3), q(6)
    real(wp), intent(inout) :: r(6)
    integer, parameter :: most_rounds = 40
    real(wp), parameter :: enough = 1e-13_wp
    real(wp) :: start(6), tried(6), scale
    integer :: round, part, i

    do round = 1, most_rounds
      start = r
      r(1) = max(0.0_wp, r(1) - (q(1) + dot_product(w(:, 1), r))/w(1, 1))
      do part = 1, 3
        scale = scale_of(w, part)
        do i = first(part), last(part)
          tried(i) = r(i) - (q(i) + dot_product(w(:, i), r))*scale
        end do
        r(first(part):last(part)) = tried(first(part):last(part))
        call cut(bound(part)*r(1), r(first(part):last(part)))
      end do
      if (maxval(abs(r - start)) <= enough*maxval(abs(r))) exit
    end do
  end subroutine approach

  !> Inverse of the trace of the block of a part [kg]: no larger than that of its largest eigenvalue.
  pure real(wp) function scale_of(w, part)
    real(wp), intent(in) :: w(6, 6)
    integer, intent(in) :: part
    integer :: i

    scale_of = 1/max(sum([(w(i, i), i=first(part), last(part))]), tiny(1.0_wp)**0.5_wp)
  end function scale_of

  !> Cut a part to its largest size.
  pure subroutine cut(largest, part)
    real(wp), intent(in) :: largest
    real(wp), intent(inout) :: part(:)
    real(wp) :: length

    length = norm2(part)
    if (length > largest) part = part*(largest/length)
  end subroutine cut

  !> Newton's method for r = P(r - rho u), P cutting each part to its bound at r_n.
  pure subroutine newton(w, bound, q, r, is_there)
    real(wp), intent(in) :: w(6, 6), bound(3), q(6)
    real(wp), intent(inout) :: r(6)
    logical, intent(out) :: is_there !! has it arrived? Else r is not to be used
    integer, parameter :: most_rounds = 15
    real(wp), parameter :: enough = 1e-13_wp
    real(wp) :: u(6), matrix(6, 7), change
    integer :: round, part
    logical :: is_regular

    is_there = .false.
    do round = 1, most_rounds
      u = q + matmul(w, r)
      ! With q_n < 0 the contact closes: its row is u_n = 0.
      matrix(1, :) = [w(1, :), -u(1)]
      do part = 1, 3
        call set_rows(part, w, bound(part), u, r, matrix)
      end do
      call solve(matrix, is_regular)
      if (.not. is_regular) return
      r = r + matrix(:, 7)
      change = maxval(abs(matrix(:, 7)))
      if (.not. change <= huge(change)) return
      if (change <= enough*maxval(abs(r))) exit
    end do
    if (round > most_rounds .or. r(1) < 0) return
    do part = 1, 3
      call cut(bound(part)*r(1), r(first(part):last(part)))
    end do
    is_there = .true.
  end subroutine newton

  !> Rows of a part: u = 0 where it holds, else the linear part of r - bound r_n z/|z|, z = r - rho u.
  pure subroutine set_rows(part, w, bound, u, r, matrix)
    integer, intent(in) :: part
    real(wp), intent(in) :: w(6, 6), bound, u(6), r(6)
    real(wp), intent(inout) :: matrix(6, 7)
    real(wp) :: z(2), away(2), length, rho, largest, across(2, 6)
    integer :: n, i, j

    n = last(part) - first(part) + 1
    rho = scale_of(w, part)
    z = 0
    z(:n) = r(first(part):last(part)) - rho*u(first(part):last(part))
    length = norm2(z)
    largest = bound*max(0.0_wp, r(1))
    if (length <= largest) then
      do i = 1, n
        matrix(first(part) + i - 1, :) = [w(first(part) + i - 1, :), -u(first(part) + i - 1)]
      end do
      return
    end if
    away = z/length
    ! Derivatives of z.
    do i = 1, n
      across(i, :) = -rho*w(first(part) + i - 1, :)
      across(i, first(part) + i - 1) = across(i, first(part) + i - 1) + 1
    end do
    do j = 1, 6
      across(:n, j) = across(:n, j) - away(:n)*dot_product(away(:n), across(:n, j))
    end do
    do i = 1, n
      associate (row => matrix(first(part) + i - 1, :))
        row(:6) = -largest/length*across(i, :)
        row(first(part) + i - 1) = row(first(part) + i - 1) + 1
        row(1) = row(1) - bound*away(i)
        row(7) = largest*away(i) - r(first(part) + i - 1)
      end associate
    end do
  end subroutine set_rows

  !> Solve six equations; the seventh column is the right side, then the solution.
  pure subroutine solve(matrix, is_regular)
    real(wp), intent(inout) :: matrix(6, 7)
    logical, intent(out) :: is_regular !! is there a solution?
    real(wp) :: row(7), largest
    integer :: i, j, pivot

    ! Rows of velocities and of impulses differ in their units.
    is_regular = .false.
    do i = 1, 6
      largest = maxval(abs(matrix(i, :6)))
      if (.not. largest > tiny(1.0_wp)) return
      matrix(i, :) = matrix(i, :)/largest
    end do
    do i = 1, 6
      pivot = i - 1 + maxloc(abs(matrix(i:, i)), 1)
      if (.not. abs(matrix(pivot, i)) > 1e-14_wp) return
      row = matrix(pivot, :)
      matrix(pivot, :) = matrix(i, :)
      matrix(i, :) = row/row(i)
      do j = 1, 6
        if (j /= i) matrix(j, :) = matrix(j, :) - matrix(j, i)*matrix(i, :)
      end do
    end do
    is_regular = .true.
  end subroutine solve
end module sg_sweep_solid_rolling
