!> Gauss-Seidel sweep over solids with friction, pairs of bodies side by side, for vector registers (doc/theory/nlgs.md).
!!
!! No movable body is twice in a group, so that its pairs may be updated at once; the bodies are fetched once for all points of
!! a pair. Open, sticking and sliding contacts take the same operations: masks of zeros and ones in place of branches, and
!! nothing within that could divide by zero, so that the loops over lanes become vector instructions.
module sg_sweep_solid_lanes
  use, intrinsic :: iso_c_binding, only: c_double
  use sg_kinds, only: wp, i4, i8
  use sg_records, only: body_length, first_inverse, solid_frictional, solid_inverse_mx, solid_inverse_my, solid_inverse_mz, &
                        solid_inverse_xx, solid_inverse_xy, solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, &
                        solid_inverse_zz, solid_spin_x, solid_spin_y, solid_spin_z, velocity_x, velocity_y, velocity_z
  use sg_sweep_solid, only: slide
  use sg_sweep_solid_order, only: lanes, row_arm_ax, row_arm_ay, row_arm_az, row_arm_cx, row_arm_cy, row_arm_cz, row_bias, &
                                  row_friction, row_g1, row_g2, row_impulse_1, row_impulse_2, row_impulse_n, row_inverse_wnn, &
                                  row_length, row_normal_x, row_normal_y, row_normal_z, row_s1, row_s2, row_tangent_x, &
                                  row_tangent_y, row_tangent_z, special_bias_1, special_bias_2, special_compliance_n, &
                                  special_compliance_t, special_length
  implicit none
  private
  public :: sweep_solid_lanes

  !> Relative difference of friction r_n and |r_t| that is let pass
  real(wp), parameter :: enough = 1e-13_wp
  !> Largest slip over impulse that is looked for, over what the contact yields: beyond it friction is no part of the motion, and
  !! the seventh power, which Halley's step takes, has no room where bodies are light
  real(wp), parameter :: largest_alpha = 1e12_wp
  !> Rows that are asked for ahead of their turn
  integer, parameter :: ahead = 2

  interface
    !> Ask for a row (prefetch.cpp).
    pure subroutine prefetch_row(row) bind(c, name='sg_prefetch_row')
      import :: c_double
      real(c_double), intent(in) :: row(*)
    end subroutine prefetch_row
  end interface

contains

  !> One sweep, group by group.
  pure subroutine sweep_solid_lanes(first, last, n_groups, n_rows, n_bodies, last_row, row_size, pair, special, relaxation, row, &
                                    body, share, before, sums)
    integer, intent(in) :: first, last !! groups to visit
    integer, intent(in) :: n_groups !! all groups
    integer, intent(in) :: n_rows !! rows of contacts side by side
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: last_row(n_groups) !! last row of each group
    integer(i4), intent(in) :: row_size(n_rows) !! contacts of each row
    integer(i4), intent(in) :: pair(lanes, 2, n_groups) !! slots of candidate and antagonist
    real(wp), intent(in), contiguous :: special(:, :, :) !! shape (lanes, special_length, rows), or no rows
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: row(lanes, row_length, n_rows) !! impulses [N s] and records
    real(wp), intent(inout) :: body(body_length(solid_frictional), n_bodies) !! records of bodies; their velocities change
    real(wp), intent(in), optional :: share !! of their last change by which impulses go on, where sweeps take momentum
    real(wp), intent(inout), optional :: before(lanes, 3, n_rows) !! impulses that the sweep before left; then those of the last
    real(wp), intent(out), optional :: sums(2) !! of g^2 and g d, g = x - y, d = x - x_before
    real(wp) :: one(lanes, solid_inverse_yz), other(lanes, solid_inverse_yz), extra(lanes, 3), start(lanes, 3)
    real(wp) :: gg(lanes, 3), gd(lanes, 3)
    integer :: g, i, begin

    extra = 0
    gg = 0
    gd = 0
    begin = 1
    if (first > 1) begin = last_row(first - 1) + 1
    do g = first, last
      call fetch(n_bodies, pair(:, 1, g), body, one)
      call fetch(n_bodies, pair(:, 2, g), body, other)
      do i = begin, last_row(g)
        call prefetch_row(row(:, :, min(i + ahead, n_rows)))
        if (present(before)) call set_off(share, row(:, row_impulse_n:row_impulse_2, i), before(:, :, i), start)
        if (size(special, 3) > 0) call add_special(special(:, :, i), row(:, row_impulse_n:row_impulse_2, i), extra)
        call update_row(relaxation, extra, row(:, :, i), one, other)
        if (present(before)) call compare(row(:, row_impulse_n:row_impulse_2, i), before(:, :, i), start, gg, gd)
      end do
      call put_back(n_bodies, row_size(begin), pair(:, 1, g), one, body)
      call put_back(n_bodies, row_size(begin), pair(:, 2, g), other, body)
      begin = last_row(g) + 1
    end do
    if (present(sums)) sums = [sum(gg), sum(gd)]
  end subroutine sweep_solid_lanes

  !> Let impulses go on by a share of their last change: x becomes y.
  pure subroutine set_off(share, x, before, start)
    real(wp), intent(in) :: share
    real(wp), intent(inout) :: x(lanes, 3), before(lanes, 3)
    real(wp), intent(out) :: start(lanes, 3)
    integer :: i

    do i = 1, lanes
      start(i, 1) = x(i, 1) + share*(x(i, 1) - before(i, 1))
      start(i, 2) = x(i, 2) + share*(x(i, 2) - before(i, 2))
      start(i, 3) = x(i, 3) + share*(x(i, 3) - before(i, 3))
      before(i, 1) = x(i, 1)
      before(i, 2) = x(i, 2)
      before(i, 3) = x(i, 3)
      x(i, 1) = start(i, 1)
      x(i, 2) = start(i, 2)
      x(i, 3) = start(i, 3)
    end do
  end subroutine set_off

  !> Add what their sweep has done: sums of g^2 and g d, g = x - y, d = x - x_before.
  pure subroutine compare(x, before, start, gg, gd)
    real(wp), intent(in) :: x(lanes, 3), before(lanes, 3), start(lanes, 3)
    real(wp), intent(inout) :: gg(lanes, 3), gd(lanes, 3)
    real(wp) :: g_1, g_2, g_3
    integer :: i

    do i = 1, lanes
      g_1 = x(i, 1) - start(i, 1)
      g_2 = x(i, 2) - start(i, 2)
      g_3 = x(i, 3) - start(i, 3)
      gg(i, 1) = gg(i, 1) + g_1*g_1
      gg(i, 2) = gg(i, 2) + g_2*g_2
      gg(i, 3) = gg(i, 3) + g_3*g_3
      gd(i, 1) = gd(i, 1) + g_1*(x(i, 1) - before(i, 1))
      gd(i, 2) = gd(i, 2) + g_2*(x(i, 2) - before(i, 2))
      gd(i, 3) = gd(i, 3) + g_3*(x(i, 3) - before(i, 3))
    end do
  end subroutine compare

  !> Bodies side by side.
  pure subroutine fetch(n_bodies, slot, body, own)
    integer, intent(in) :: n_bodies
    integer(i4), intent(in) :: slot(lanes)
    real(wp), intent(in) :: body(body_length(solid_frictional), n_bodies)
    real(wp), intent(out) :: own(lanes, solid_inverse_yz)
    integer :: i, j

    do i = 1, lanes
      do j = 1, solid_inverse_yz
        own(i, j) = body(j, slot(i))
      end do
    end do
  end subroutine fetch

  !> Velocities back to the bodies of the lanes in use.
  pure subroutine put_back(n_bodies, n, slot, own, body)
    integer, intent(in) :: n_bodies, n
    integer(i4), intent(in) :: slot(lanes)
    real(wp), intent(in) :: own(lanes, solid_inverse_yz)
    real(wp), intent(inout) :: body(body_length(solid_frictional), n_bodies)
    integer :: i, j

    do i = 1, n
      do j = 1, first_inverse(solid_frictional) - 1
        body(j, slot(i)) = own(i, j)
      end do
    end do
  end subroutine put_back

  !> Velocities that laws out of the ordinary add: bias along the tangents, and compliance.
  pure subroutine add_special(special, impulse, extra)
    real(wp), intent(in) :: special(lanes, special_length), impulse(lanes, 3)
    real(wp), intent(out) :: extra(lanes, 3)

    extra(:, 1) = special(:, special_compliance_n)*impulse(:, 1)
    extra(:, 2) = special(:, special_bias_1) + special(:, special_compliance_t)*impulse(:, 2)
    extra(:, 3) = special(:, special_bias_2) + special(:, special_compliance_t)*impulse(:, 3)
  end subroutine add_special

  !> New impulses of a row, and new velocities of its bodies.
  pure subroutine update_row(relaxation, extra, row, one, other)
    real(wp), intent(in) :: relaxation, extra(lanes, 3)
    real(wp), intent(inout) :: row(lanes, row_length), one(lanes, solid_inverse_yz), other(lanes, solid_inverse_yz)
    real(wp), dimension(lanes) :: h, t_1, t_2, alpha, slides
    real(wp) :: r(lanes, 3)
    logical :: is_sliding

    call open_or_stick(extra, row, one, other, h, t_1, t_2, alpha, r, slides, is_sliding)
    if (is_sliding) call slide_row(row, h, t_1, t_2, slides, alpha, r)
    call push_row(relaxation, r, row, one, other)
  end subroutine update_row

  !> Impulses of contacts that part or stick; what the others need to slide.
  !!
  !! The velocity that a contact would have without its own impulse is never formed: what that impulse does cancels.
  pure subroutine open_or_stick(extra, row, one, other, h, t_1, t_2, alpha, r, slides, is_sliding)
    real(wp), intent(in) :: extra(lanes, 3), row(lanes, row_length), one(lanes, solid_inverse_yz), other(lanes, solid_inverse_yz)
    real(wp), intent(out), dimension(lanes) :: h, t_1, t_2 !! normal impulse [N s] and minus velocity [m/s] without friction
    real(wp), intent(out) :: alpha(lanes) !! guess of slip over impulse [1/kg]
    real(wp), intent(out) :: r(lanes, 3) !! impulses [N s]
    real(wp), intent(out) :: slides(lanes) !! one where the contact slides, else zero
    logical, intent(out) :: is_sliding !! does any?
    real(wp) :: ux, uy, uz, u_n, u_1, u_2, r_n, r_1, r_2, inverse, excess, limit, pushes, linear, against
    integer :: i
    integer(i8) :: sliding

    sliding = 0
    do i = 1, lanes
      ux = one(i, velocity_x) - other(i, velocity_x) + one(i, solid_spin_y)*row(i, row_arm_cz) &
           - one(i, solid_spin_z)*row(i, row_arm_cy) - other(i, solid_spin_y)*row(i, row_arm_az) &
           + other(i, solid_spin_z)*row(i, row_arm_ay)
      uy = one(i, velocity_y) - other(i, velocity_y) + one(i, solid_spin_z)*row(i, row_arm_cx) &
           - one(i, solid_spin_x)*row(i, row_arm_cz) - other(i, solid_spin_z)*row(i, row_arm_ax) &
           + other(i, solid_spin_x)*row(i, row_arm_az)
      uz = one(i, velocity_z) - other(i, velocity_z) + one(i, solid_spin_x)*row(i, row_arm_cy) &
           - one(i, solid_spin_y)*row(i, row_arm_cx) - other(i, solid_spin_x)*row(i, row_arm_ay) &
           + other(i, solid_spin_y)*row(i, row_arm_ax)
      u_n = row(i, row_normal_x)*ux + row(i, row_normal_y)*uy + row(i, row_normal_z)*uz + row(i, row_bias) + extra(i, 1)
      u_1 = row(i, row_tangent_x)*ux + row(i, row_tangent_y)*uy + row(i, row_tangent_z)*uz + extra(i, 2)
      u_2 = (row(i, row_normal_y)*row(i, row_tangent_z) - row(i, row_normal_z)*row(i, row_tangent_y))*ux &
            + (row(i, row_normal_z)*row(i, row_tangent_x) - row(i, row_normal_x)*row(i, row_tangent_z))*uy &
            + (row(i, row_normal_x)*row(i, row_tangent_y) - row(i, row_normal_y)*row(i, row_tangent_x))*uz + extra(i, 3)
      h(i) = row(i, row_impulse_n) + row(i, row_g1)*row(i, row_impulse_1) + row(i, row_g2)*row(i, row_impulse_2) &
             - u_n*row(i, row_inverse_wnn)
      t_1(i) = row(i, row_s1)*row(i, row_impulse_1) + row(i, row_g1)*u_n - u_1
      t_2(i) = row(i, row_s2)*row(i, row_impulse_2) + row(i, row_g2)*u_n - u_2
      inverse = 1/(row(i, row_s1)*row(i, row_s2))
      r_1 = t_1(i)*(row(i, row_s2)*inverse)
      r_2 = t_2(i)*(row(i, row_s1)*inverse)
      r_n = h(i) - row(i, row_g1)*r_1 - row(i, row_g2)*r_2
      limit = row(i, row_friction)*max(0.0_wp, r_n)
      excess = r_1*r_1 + r_2*r_2 - limit*limit
      pushes = merge(1.0_wp, 0.0_wp, h(i) > 0)
      linear = merge(1.0_wp, 0.0_wp, row(i, row_friction) < 0)
      slides(i) = merge(1.0_wp, 0.0_wp, excess > 0)*pushes*(1 - linear)
      sliding = sliding + merge(1_i8, 0_i8, slides(i) > 0)
      pushes = max(pushes, linear)
      r(i, 1) = r_n*pushes
      r(i, 2) = r_1*pushes
      r(i, 3) = r_2*pushes
      against = max(0.0_wp, -(u_1*row(i, row_impulse_1) + u_2*row(i, row_impulse_2)))
      alpha(i) = min(largest_alpha*row(i, row_s1), &
                     row(i, row_s1)*against/max(row(i, row_s1)*(row(i, row_impulse_1)*row(i, row_impulse_1) &
                                                                + row(i, row_impulse_2)*row(i, row_impulse_2)), &
                                                1e-9_wp*against, tiny(1.0_wp)))
    end do
    is_sliding = sliding > 0
  end subroutine open_or_stick

  !> Sliding contacts of a row: two steps of Halley's method leave nothing to do but next to singular blocks.
  pure subroutine slide_row(row, h, t_1, t_2, slides, alpha, r)
    real(wp), intent(in) :: row(lanes, row_length), h(lanes), t_1(lanes), t_2(lanes), slides(lanes)
    real(wp), intent(inout) :: alpha(lanes), r(lanes, 3)
    real(wp) :: wrong(lanes)
    integer :: i, round
    logical :: is_done

    call improve(row, h, t_1, t_2, alpha)
    call improve(row, h, t_1, t_2, alpha)
    do round = 1, 3
      call take(row, h, t_1, t_2, alpha, slides, r, wrong, is_done)
      if (is_done) return
      call improve(row, h, t_1, t_2, alpha)
    end do
    do i = 1, lanes
      if (wrong(i) > 0) call slide(row(i, row_g1), row(i, row_g2), row(i, row_s1), row(i, row_s2), row(i, row_friction), h(i), &
                                   t_1(i), t_2(i), 0.0_wp, 0.0_wp, r(i, 1), r(i, 2), r(i, 3))
    end do
  end subroutine slide_row

  !> A step of Halley's method for friction r_n/|r_t| = 1, nearly a straight line in alpha. With a_i = S_i + alpha, r_n is
  !! normal/(a_1 a_2), |r_t| length/(a_1 a_2): the root and the one division do not wait for each other.
  pure subroutine improve(row, h, t_1, t_2, alpha)
    real(wp), intent(in) :: row(lanes, row_length), h(lanes), t_1(lanes), t_2(lanes)
    real(wp), intent(inout) :: alpha(lanes)
    real(wp), parameter :: longest = 1e6_wp
    real(wp) :: a_1, a_2, normal, change, square, half_change, excess, slope, bend, s_1, s_2, top, bottom
    integer :: i

    do i = 1, lanes
      a_1 = row(i, row_s1) + alpha(i)
      a_2 = row(i, row_s2) + alpha(i)
      s_1 = row(i, row_g1)*t_1(i)
      s_2 = row(i, row_g2)*t_2(i)
      normal = h(i)*(a_1*a_2) - s_1*a_2 - s_2*a_1
      change = h(i)*(a_1 + a_2) - (s_1 + s_2)
      s_1 = t_1(i)*t_1(i)
      s_2 = t_2(i)*t_2(i)
      half_change = s_1*a_2 + s_2*a_1
      square = s_1*a_2*a_2 + s_2*a_1*a_1
      excess = sqrt(square) - row(i, row_friction)*normal
      ! Slope and bend of normal/length, times length^3 and length^5.
      slope = change*square - normal*half_change
      bend = (2*h(i)*square + change*half_change - normal*(s_1 + s_2))*square - 3*slope*half_change
      top = 2*excess*slope*square
      bottom = (2*row(i, row_friction)*slope*slope + excess*bend)*a_1
      ! The quotient first: it is a number where the product with a_1 has no room.
      alpha(i) = min(largest_alpha*row(i, row_s1), &
                     max(0.0_wp, alpha(i) + a_1*(top/max(bottom, abs(top)/longest, tiny(1.0_wp)))))
    end do
  end subroutine improve

  !> Take the impulses of sliding contacts.
  pure subroutine take(row, h, t_1, t_2, alpha, slides, r, wrong, is_done)
    real(wp), intent(in) :: row(lanes, row_length), h(lanes), t_1(lanes), t_2(lanes), alpha(lanes), slides(lanes)
    real(wp), intent(inout) :: r(lanes, 3)
    real(wp), intent(out) :: wrong(lanes) !! one where the contact slides and they do not obey the law, else zero
    logical, intent(out) :: is_done !! are none wrong?
    real(wp) :: a_1, a_2, inverse, r_1, r_2, r_n, length, miss
    integer :: i
    integer(i8) :: missed

    missed = 0
    do i = 1, lanes
      a_1 = row(i, row_s1) + alpha(i)
      a_2 = row(i, row_s2) + alpha(i)
      inverse = 1/(a_1*a_2)
      r_1 = t_1(i)*(a_2*inverse)
      r_2 = t_2(i)*(a_1*inverse)
      r_n = h(i) - row(i, row_g1)*r_1 - row(i, row_g2)*r_2
      length = sqrt(r_1*r_1 + r_2*r_2)
      miss = abs(row(i, row_friction)*r_n - length) - enough*length
      wrong(i) = slides(i)*(1 - merge(1.0_wp, 0.0_wp, miss <= 0))
      missed = missed + merge(1_i8, 0_i8, wrong(i) > 0)
      r(i, 1) = r(i, 1)*(1 - slides(i)) + r_n*slides(i)
      r(i, 2) = r(i, 2)*(1 - slides(i)) + r_1*slides(i)
      r(i, 3) = r(i, 3)*(1 - slides(i)) + r_2*slides(i)
    end do
    is_done = missed == 0
  end subroutine take

  !> Give the changes of impulse to contacts and bodies.
  pure subroutine push_row(relaxation, r, row, one, other)
    real(wp), intent(in) :: relaxation, r(lanes, 3)
    real(wp), intent(inout) :: row(lanes, row_length), one(lanes, solid_inverse_yz), other(lanes, solid_inverse_yz)
    real(wp) :: x, y, z, tx, ty, tz, r_n, r_1, r_2, px, py, pz, ax, ay, az
    integer :: i

    do i = 1, lanes
      r_n = relaxation*(r(i, 1) - row(i, row_impulse_n))
      r_1 = relaxation*(r(i, 2) - row(i, row_impulse_1))
      r_2 = relaxation*(r(i, 3) - row(i, row_impulse_2))
      row(i, row_impulse_n) = row(i, row_impulse_n) + r_n
      row(i, row_impulse_1) = row(i, row_impulse_1) + r_1
      row(i, row_impulse_2) = row(i, row_impulse_2) + r_2
      x = row(i, row_normal_x)
      y = row(i, row_normal_y)
      z = row(i, row_normal_z)
      tx = row(i, row_tangent_x)
      ty = row(i, row_tangent_y)
      tz = row(i, row_tangent_z)
      px = x*r_n + tx*r_1 + (y*tz - z*ty)*r_2
      py = y*r_n + ty*r_1 + (z*tx - x*tz)*r_2
      pz = z*r_n + tz*r_1 + (x*ty - y*tx)*r_2
      one(i, velocity_x) = one(i, velocity_x) + one(i, solid_inverse_mx)*px
      one(i, velocity_y) = one(i, velocity_y) + one(i, solid_inverse_my)*py
      one(i, velocity_z) = one(i, velocity_z) + one(i, solid_inverse_mz)*pz
      other(i, velocity_x) = other(i, velocity_x) - other(i, solid_inverse_mx)*px
      other(i, velocity_y) = other(i, velocity_y) - other(i, solid_inverse_my)*py
      other(i, velocity_z) = other(i, velocity_z) - other(i, solid_inverse_mz)*pz
      ax = row(i, row_arm_cy)*pz - row(i, row_arm_cz)*py
      ay = row(i, row_arm_cz)*px - row(i, row_arm_cx)*pz
      az = row(i, row_arm_cx)*py - row(i, row_arm_cy)*px
      one(i, solid_spin_x) = one(i, solid_spin_x) + one(i, solid_inverse_xx)*ax + one(i, solid_inverse_xy)*ay &
                             + one(i, solid_inverse_xz)*az
      one(i, solid_spin_y) = one(i, solid_spin_y) + one(i, solid_inverse_xy)*ax + one(i, solid_inverse_yy)*ay &
                             + one(i, solid_inverse_yz)*az
      one(i, solid_spin_z) = one(i, solid_spin_z) + one(i, solid_inverse_xz)*ax + one(i, solid_inverse_yz)*ay &
                             + one(i, solid_inverse_zz)*az
      ax = row(i, row_arm_ay)*pz - row(i, row_arm_az)*py
      ay = row(i, row_arm_az)*px - row(i, row_arm_ax)*pz
      az = row(i, row_arm_ax)*py - row(i, row_arm_ay)*px
      other(i, solid_spin_x) = other(i, solid_spin_x) - other(i, solid_inverse_xx)*ax - other(i, solid_inverse_xy)*ay &
                               - other(i, solid_inverse_xz)*az
      other(i, solid_spin_y) = other(i, solid_spin_y) - other(i, solid_inverse_xy)*ax - other(i, solid_inverse_yy)*ay &
                               - other(i, solid_inverse_yz)*az
      other(i, solid_spin_z) = other(i, solid_spin_z) - other(i, solid_inverse_xz)*ax - other(i, solid_inverse_yz)*ay &
                               - other(i, solid_inverse_zz)*az
    end do
  end subroutine push_row
end module sg_sweep_solid_lanes
