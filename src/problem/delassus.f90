!> The block of W at a contact, as its record holds it, from the geometry in the record and the masses of its two bodies.
!!
!! Assembly sets it, and decomposed solvers recompute it where they sweep shared grains with a part of their mass.
module sg_delassus
  use sg_kinds, only: wp
  use sg_laws, only: inverse_of
  use sg_records, only: arm_bonded, arm_compliance_n, arm_compliance_t, arm_frictional, arm_frictionless, &
                        arm_frictionless_inverse_wnn, arm_frictionless_moment_a, arm_frictionless_moment_c, arm_gyration, &
                        arm_inverse_i, arm_inverse_norm, arm_law, arm_mixed, arm_moment_na, arm_moment_nc, arm_moment_ta, &
                        arm_moment_tc, arm_relief_nn, arm_relief_tt, arm_rolling, arm_rolling_length, arm_stiffness_n, &
                        arm_stiffness_t, arm_wmm, arm_wnm, arm_wnn, arm_wnt, arm_wtm, arm_wtt, ball_frictional, &
                        ball_frictionless, ball_frictionless_inverse_mx, ball_frictionless_inverse_mz, &
                        ball_frictionless_inverse_wnn, ball_inverse_i, ball_inverse_m, ball_inverse_wnn, ball_inverse_wtt, &
                        body_length, bond_shift, first_inverse, least_active, least_normal, normal_x, normal_y, normal_z, &
                        plain_kind, record_length, round_frictional, round_frictionless, round_frictionless_inverse_wnn, &
                        round_inverse_i, round_inverse_wnn, round_inverse_wtt, solid_arm_ax, solid_arm_az, solid_arm_cx, &
                        solid_arm_cz, solid_bonded, solid_c11, solid_c33, solid_compliance_n, solid_compliance_t, &
                        solid_frictional, solid_frictionless, solid_frictionless_inverse_wnn, solid_frictionless_moment_ax, &
                        solid_frictionless_moment_az, solid_frictionless_moment_cx, solid_frictionless_moment_cz, solid_gyration, &
                        solid_inverse_lambda, solid_inverse_mx, solid_inverse_mz, solid_inverse_norm, solid_inverse_xx, &
                        solid_inverse_xy, solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, solid_inverse_zz, solid_law, &
                        solid_m11, solid_m21, solid_m22, solid_m31, solid_m32, solid_m33, solid_mixed, solid_relief_22, &
                        solid_relief_nn, solid_rolling, solid_rolling_length, solid_s1, solid_s2, solid_stiffness_n, &
                        solid_stiffness_t, solid_tangent_x, solid_tangent_z, solid_twisting_length, solid_wn1, solid_wn2, &
                        solid_wnn
  use sg_symmetric, only: largest_eigenvalue
  implicit none
  private
  public :: set_block, block_times, share_mass, whole_block

  real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

  !> Take one of `parts` equal parts of a body's mass and inertia.
  pure subroutine share_mass(kind, parts, body)
    integer, intent(in) :: kind !! kind of problem
    integer, intent(in) :: parts !! copies of the body
    real(wp), intent(inout) :: body(:) !! its record; inverse masses grow
    real(wp) :: mark

    mark = body(size(body))
    associate (inverse => body(first_inverse(kind):))
      inverse = inverse*real(parts, wp)
    end associate
    ! Marks of free directions are no inverse inertia.
    if (kind == ball_frictional .and. mark < 0) body(ball_inverse_i) = mark
  end subroutine share_mass

  !> Set the block of a record whose other values are set. Contacts that take no part, by a 0 in place of an inverse or as
  !! kind of local law, stay so; so do those between bodies that nothing moves.
  !!
  !! Where a body is driven in some directions only, round and ball contacts couple normal and tangents; their block is then
  !! replaced by the diagonal one that bounds it (Gershgorin; in space the inverse mass in all directions), which moves no
  !! solution: the sweep works with true relative velocities.
  pure subroutine set_block(kind, candidate, antagonist, record)
    integer, intent(in) :: kind !! kind of problem
    real(wp), intent(in), contiguous :: candidate(:), antagonist(:) !! records of the two bodies
    real(wp), intent(inout), contiguous :: record(:) !! record of the contact
    real(wp) :: mx, my, w, w_t, w_nt, relief(3, 3)

    associate (c => candidate, a => antagonist, n => record(normal_x:normal_y))
      select case (kind)
      case (round_frictionless, round_frictional, arm_frictionless, arm_frictional, arm_bonded, arm_rolling, arm_mixed)
        mx = c(first_inverse(kind)) + a(first_inverse(kind))
        my = c(first_inverse(kind) + 1) + a(first_inverse(kind) + 1)
        w = n(1)**2*mx + n(2)**2*my
      end select
      select case (kind)
      case (round_frictionless)
        record(round_frictionless_inverse_wnn) = inverse_of(w, record(round_frictionless_inverse_wnn) > 0)
      case (round_frictional)
        w_nt = abs(n(1)*n(2)*(mx - my))
        w_t = n(2)**2*mx + n(1)**2*my + c(round_inverse_i) + a(round_inverse_i)
        record(round_inverse_wnn:round_inverse_wtt) = [inverse_of(w + w_nt, record(round_inverse_wnn) > 0), &
                                                       inverse_of(w_t + w_nt, record(round_inverse_wtt) > 0)]
      case (arm_frictionless)
        record(arm_frictionless_inverse_wnn) = &
          inverse_of(w + record(arm_frictionless_moment_c)**2*c(arm_inverse_i) &
                       + record(arm_frictionless_moment_a)**2*a(arm_inverse_i), record(arm_frictionless_inverse_wnn) > 0)
      case (arm_frictional, arm_bonded, arm_rolling, arm_mixed)
        record(arm_wnn) = w + record(arm_moment_nc)**2*c(arm_inverse_i) + record(arm_moment_na)**2*a(arm_inverse_i) &
                          + record(arm_compliance_n)
        record(arm_wnt) = n(1)*n(2)*(mx - my) + record(arm_moment_nc)*record(arm_moment_tc)*c(arm_inverse_i) &
                          + record(arm_moment_na)*record(arm_moment_ta)*a(arm_inverse_i)
        record(arm_wtt) = n(2)**2*mx + n(1)**2*my + record(arm_moment_tc)**2*c(arm_inverse_i) &
                          + record(arm_moment_ta)**2*a(arm_inverse_i) + record(arm_compliance_t)
        if (record(arm_law) > least_normal) record(arm_wnt:arm_wtt) = 0
        if (.not. record(arm_wnn) > tiny(1.0_wp)) record(arm_law) = 0
        if (kind == arm_bonded .or. kind == arm_mixed) call stiffen_plane_block(bond_shift(kind), record)
        if (kind == arm_rolling .or. kind == arm_mixed) &
          call set_plane_moment_block(c, a, record(:record_length(arm_rolling)))
      case (ball_frictionless)
        record(ball_frictionless_inverse_wnn) = &
          inverse_of(dot_product(c(ball_frictionless_inverse_mx:ball_frictionless_inverse_mz) &
                                 + a(ball_frictionless_inverse_mx:ball_frictionless_inverse_mz), record(normal_x:normal_z)**2), &
                     record(ball_frictionless_inverse_wnn) > 0)
      case (ball_frictional)
        w = c(ball_inverse_m) + a(ball_inverse_m)
        record(ball_inverse_wnn:ball_inverse_wtt) = &
          [inverse_of(w, record(ball_inverse_wnn) > 0), &
           inverse_of(w + max(0.0_wp, c(ball_inverse_i)) + max(0.0_wp, a(ball_inverse_i)), record(ball_inverse_wtt) > 0)]
      case (solid_frictionless)
        w = dot_product(c(solid_inverse_mx:solid_inverse_mz) + a(solid_inverse_mx:solid_inverse_mz), record(normal_x:normal_z)**2) &
            + turned(c, record(solid_frictionless_moment_cx:solid_frictionless_moment_cz)) &
            + turned(a, record(solid_frictionless_moment_ax:solid_frictionless_moment_az))
        record(solid_frictionless_inverse_wnn) = inverse_of(w, record(solid_frictionless_inverse_wnn) > 0)
      case (solid_frictional)
        call set_solid_block(c, a, [0.0_wp, 0.0_wp], record, relief)
      case (solid_bonded)
        call set_solid_block(c, a, record(solid_stiffness_n:solid_stiffness_t), record(:record_length(solid_frictional)), relief)
        record(solid_relief_nn:solid_relief_22) = reshape(relief, [9])
      case (solid_rolling)
        call set_solid_block(c, a, [0.0_wp, 0.0_wp], record(:record_length(solid_frictional)), relief)
        call set_moment_block(c, a, record)
      case (solid_mixed)
        associate (bond => record(1 + bond_shift(kind):))
          call set_solid_block(c, a, bond(solid_stiffness_n:solid_stiffness_t), record(:record_length(solid_frictional)), relief)
          bond(solid_relief_nn:solid_relief_22) = reshape(relief, [9])
        end associate
        call set_moment_block(c, a, record(:record_length(solid_rolling)))
      end select
    end associate
  contains
    !> x . I^-1 x
    pure real(wp) function turned(body, x)
      real(wp), intent(in) :: body(:), x(3)

      turned = body(solid_inverse_xx)*x(1)**2 + body(solid_inverse_yy)*x(2)**2 + body(solid_inverse_zz)*x(3)**2 &
               + 2*(body(solid_inverse_xy)*x(1)*x(2) + body(solid_inverse_xz)*x(1)*x(3) + body(solid_inverse_yz)*x(2)*x(3))
    end function turned
  end subroutine set_block

  !> Set the block of a solid contact with friction for the masses of its bodies, on the tangents in which S is diagonal.
  pure subroutine set_solid_block(candidate, antagonist, stiffness, record, relief)
    real(wp), intent(in) :: candidate(body_length(solid_frictional)) !! record of one body
    real(wp), intent(in) :: antagonist(body_length(solid_frictional)) !! record of the other one
    real(wp), intent(in) :: stiffness(2) !! of a bond times the square of the step [kg]
    real(wp), intent(inout) :: record(record_length(solid_frictional)) !! of the contact, except its block; its tangent may turn
    real(wp), intent(out) :: relief(3, 3) !! (I + K W)^-1 along the normal and the tangents of the record
    real(wp) :: frame(3, 3), own(3, 3), other(3, 3), w(3, 3), s(2, 2), turn(3, 3), c, d
    integer :: i, j

    frame(:, 1) = record(normal_x:normal_z)
    frame(:, 2) = record(solid_tangent_x:solid_tangent_z)
    frame(:, 3) = product_of(frame(:, 1), frame(:, 2))
    call set_share(candidate, record(solid_arm_cx:solid_arm_cz), own)
    call set_share(antagonist, record(solid_arm_ax:solid_arm_az), other)
    own = own + other
    ! Sums of products with the last one first: the compiler fuses what comes first, and rounds the others.
    do j = 1, 3
      do i = 1, 3
        other(i, j) = own(i, 3)*frame(3, j) + (own(i, 2)*frame(2, j) + own(i, 1)*frame(1, j))
      end do
    end do
    do j = 1, 3
      do i = 1, 3
        w(i, j) = frame(3, i)*other(3, j) + (frame(2, i)*other(2, j) + frame(1, i)*other(1, j))
      end do
    end do
    w(1, 1) = w(1, 1) + record(solid_compliance_n)
    w(2, 2) = w(2, 2) + record(solid_compliance_t)
    w(3, 3) = w(3, 3) + record(solid_compliance_t)
    relief = identity
    if (maxval(stiffness) > 0) call stiffen(stiffness([1, 2, 2]), w, relief)
    s = 1
    c = 1
    d = 0
    if (.not. w(1, 1) > tiny(1.0_wp)) record(solid_law) = 0
    if (record(solid_law) > least_active .or. maxval(stiffness) > 0) then
      s = w(2:3, 2:3)
      if (record(solid_law) > least_active) then
        do j = 1, 2
          s(:, j) = s(:, j) - w(2:3, 1)*w(1, j + 1)/w(1, 1)
        end do
      end if
      call find_axis(s(1, 1) - s(2, 2), 2*s(1, 2), c, d)
    end if
    if (maxval(stiffness) > 0) then
      turn = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, c, d, 0.0_wp, -d, c], [3, 3])
      relief = matmul(transpose(turn), matmul(relief, turn))
    end if
    ! S is positive for bodies that can move; where rounding or a driven body takes that away, a trace of W_nn keeps it so.
    associate (least => 16*epsilon(1.0_wp)*max(w(1, 1), w(2, 2), w(3, 3), tiny(1.0_wp)))
      record(solid_tangent_x:solid_tangent_z) = c*frame(:, 2) + d*frame(:, 3)
      record(solid_wnn:solid_s2) = [w(1, 1), c*w(1, 2) + d*w(1, 3), c*w(1, 3) - d*w(1, 2), &
                       max(least, c**2*s(1, 1) + 2*c*d*s(1, 2) + d**2*s(2, 2)), &
                       max(least, d**2*s(1, 1) - 2*c*d*s(1, 2) + c**2*s(2, 2))]
    end associate
    if (record(solid_law) > least_active) record(solid_inverse_lambda) = 1/largest_eigenvalue(w)
  end subroutine set_solid_block

  !> Cosine and sine of half the angle of a vector, from -90 to 90 degrees: the first axis of a symmetric 2 x 2 matrix whose terms
  !! on the diagonal differ by x and whose other term is y/2. Without angles, which take three times as long.
  pure subroutine find_axis(x, y, c, s)
    real(wp), intent(in) :: x, y
    real(wp), intent(out) :: c, s
    real(wp) :: length, along

    c = 1
    s = 0
    length = sqrt(x**2 + y**2)
    if (.not. length > 0) return
    ! The larger of both from a sum without cancellation.
    along = abs(x) + length
    c = 1/sqrt(2*length*along)
    s = c*abs(y)
    c = c*along
    if (x < 0) then
      length = c
      c = s
      s = length
    end if
    s = sign(s, y)
  end subroutine find_axis

  !> Turn the block of W of a bonded contact of the plane into that which its unilateral impulse sees.
  pure subroutine stiffen_plane_block(shift, record)
    integer, intent(in) :: shift !! places by which the values of the bond stand farther behind
    real(wp), intent(inout) :: record(:) !! record of the contact, its block that of the bodies
    real(wp) :: w(2, 2), relief(2, 2)

    relief = identity(:2, :2)
    w = reshape(record([arm_wnn, arm_wnt, arm_wnt, arm_wtt]), [2, 2])
    call stiffen(record(arm_stiffness_n + shift:arm_stiffness_t + shift), w, relief)
    record(arm_relief_nn + shift:arm_relief_tt + shift) = reshape(relief, [4])
    record(arm_wnn:arm_wtt) = [w(1, 1), w(1, 2), w(2, 2)]
  end subroutine stiffen_plane_block

  !> Set what a moment adds to the block of W of a contact of the plane, whose other values are set. Lengths of contacts that
  !! resist no rolling, or whose bodies cannot turn, are zero.
  pure subroutine set_plane_moment_block(candidate, antagonist, record)
    real(wp), intent(in) :: candidate(body_length(arm_frictional)), antagonist(body_length(arm_frictional))
    real(wp), intent(inout) :: record(record_length(arm_rolling))
    real(wp) :: length

    associate (ic => candidate(arm_inverse_i), ia => antagonist(arm_inverse_i))
      record(arm_wnm) = record(arm_moment_nc)*ic + record(arm_moment_na)*ia
      record(arm_wtm) = record(arm_moment_tc)*ic + record(arm_moment_ta)*ia
      record(arm_wmm) = ic + ia
    end associate
    if (.not. record(arm_wmm) > tiny(1.0_wp) .or. record(arm_law) < least_active) record(arm_rolling_length) = 0
    length = 0
    if (record(arm_rolling_length) > 0) length = sqrt(max(record(arm_wnn), record(arm_wtt))/record(arm_wmm))
    record(arm_gyration) = length
    record(arm_inverse_norm) = 0
    if (record(arm_law) < least_active) return
    record(arm_inverse_norm) = 1/norm2([record(arm_wnn:arm_wtt), record(arm_wnt), length*record([arm_wnm, arm_wnm, arm_wtm, &
                                       arm_wtm]), length**2*record(arm_wmm)])
  end subroutine set_plane_moment_block

  !> The same in space. A body whose spin is driven about some axes turns about the others.
  pure subroutine set_moment_block(candidate, antagonist, record)
    real(wp), intent(in) :: candidate(body_length(solid_frictional)), antagonist(body_length(solid_frictional))
    real(wp), intent(inout) :: record(record_length(solid_rolling))
    real(wp) :: frame(3, 3), turned(3, 2), w(3, 3), c(3, 3), m(3, 3), length
    integer :: j

    frame(:, 1) = record(solid_tangent_x:solid_tangent_z)
    frame(:, 3) = record(normal_x:normal_z)
    frame(:, 2) = product_of(frame(:, 3), frame(:, 1))
    do j = 1, 3
      turned(:, 1) = turned_by_inverse(candidate, frame(:, j))
      turned(:, 2) = turned_by_inverse(antagonist, frame(:, j))
      m(:, j) = matmul(turned(:, 1) + turned(:, 2), frame)
      c(:, j) = matmul(product_of(turned(:, 1), record(solid_arm_cx:solid_arm_cz)) &
                + product_of(turned(:, 2), record(solid_arm_ax:solid_arm_az)), frame(:, [3, 1, 2]))
    end do
    record(solid_c11:solid_c33) = reshape(c, [9])
    record(solid_m11:solid_m33) = [m(:, 1), m(2:, 2), m(3, 3)]
    if (record(solid_law) < least_active .or. .not. m(1, 1) + m(2, 2) + m(3, 3) > tiny(1.0_wp)) &
      record(solid_rolling_length:solid_twisting_length) = 0
    length = 0
    w = solid_block(record(:record_length(solid_frictional)))
    if (maxval(record(solid_rolling_length:solid_twisting_length)) > 0) &
      length = sqrt((w(1, 1) + w(2, 2) + w(3, 3))/(m(1, 1) + m(2, 2) + m(3, 3)))
    record(solid_gyration) = length
    record(solid_inverse_norm) = 0
    if (record(solid_law) > least_active) record(solid_inverse_norm) = 1/sqrt(sum(w**2) + 2*length**2*sum(c**2) &
                                                                              + length**4*sum(m**2))
  end subroutine set_moment_block

  !> Block of W of a solid contact in the frame of its record (n, t, n x t) [1/kg]: S + w w^T/W_nn on the tangents.
  pure function solid_block(record) result(w)
    real(wp), intent(in) :: record(record_length(solid_frictional)) !! record of the contact
    real(wp) :: w(3, 3), coupling(2)

    coupling = record(solid_wn1:solid_wn2)
    w(1, 1) = record(solid_wnn)
    w(2:, 1) = coupling
    w(1, 2:) = coupling
    w(2:, 2) = coupling*(coupling(1)/max(record(solid_wnn), tiny(1.0_wp)))
    w(2:, 3) = coupling*(coupling(2)/max(record(solid_wnn), tiny(1.0_wp)))
    w(2, 2) = w(2, 2) + record(solid_s1)
    w(3, 3) = w(3, 3) + record(solid_s2)
  end function solid_block

  !> Inverse inertia of a body, in the world's axes, times a vector.
  pure function turned_by_inverse(body, x) result(y)
    real(wp), intent(in) :: body(body_length(solid_frictional)), x(3)
    real(wp) :: y(3)

    y = [body(solid_inverse_xx)*x(1) + body(solid_inverse_xy)*x(2) + body(solid_inverse_xz)*x(3), &
         body(solid_inverse_xy)*x(1) + body(solid_inverse_yy)*x(2) + body(solid_inverse_yz)*x(3), &
         body(solid_inverse_xz)*x(1) + body(solid_inverse_yz)*x(2) + body(solid_inverse_zz)*x(3)]
  end function turned_by_inverse

  !> (W^-1 + K)^-1 and (I + K W)^-1 for a diagonal K, one direction after the other; W may be singular.
  !!
  !! The second one is I - K (W^-1 + K)^-1 as well, of which rounding leaves nothing where bonds are very stiff.
  pure subroutine stiffen(stiffness, w, relief)
    real(wp), intent(in) :: stiffness(:) !! diagonal of K [kg]
    real(wp), intent(inout) :: w(:, :) !! W, symmetric, then the first one [1/kg]
    real(wp), intent(inout) :: relief(:, :) !! identity, then the second one
    real(wp) :: row(size(w, 1)), column(size(w, 1)), softened
    integer :: i, j

    do i = 1, size(stiffness)
      if (.not. stiffness(i) > 0) cycle
      row = w(:, i)
      softened = 1 + stiffness(i)*row(i)
      do j = 1, size(w, 1)
        w(:, j) = w(:, j) - (stiffness(i)/softened*row(j))*row
      end do
      ! The remaining mobility of this direction, without the difference of two large numbers.
      w(:, i) = row/softened
      w(i, :) = row/softened
      column = relief(:, i)/softened
      do j = 1, size(w, 1)
        relief(:, j) = relief(:, j) - stiffness(i)*row(j)*column
      end do
      relief(:, i) = column
    end do
  end subroutine stiffen

  !> What one body adds to the block of W of a contact in the world's axes [1/kg]: L^T I^-1 L, the columns of L being the arm times
  !! unit vectors, and the inverse masses.
  pure subroutine set_share(body, arm, w)
    real(wp), intent(in) :: body(body_length(solid_frictional)), arm(3)
    real(wp), intent(out) :: w(3, 3)
    real(wp) :: inverse(3, 3), turned(3, 3)
    integer :: i

    inverse(1, 1) = body(solid_inverse_xx)
    inverse(2, 1) = body(solid_inverse_xy)
    inverse(3, 1) = body(solid_inverse_xz)
    inverse(1, 2) = body(solid_inverse_xy)
    inverse(2, 2) = body(solid_inverse_yy)
    inverse(3, 2) = body(solid_inverse_yz)
    inverse(1, 3) = body(solid_inverse_xz)
    inverse(2, 3) = body(solid_inverse_yz)
    inverse(3, 3) = body(solid_inverse_zz)
    do i = 1, 3
      turned(i, 1) = inverse(i, 3)*(-arm(2)) + inverse(i, 2)*arm(3)
      turned(i, 2) = inverse(i, 3)*arm(1) + inverse(i, 1)*(-arm(3))
      turned(i, 3) = inverse(i, 2)*(-arm(1)) + inverse(i, 1)*arm(2)
    end do
    do i = 1, 3
      w(1, i) = (-arm(2))*turned(3, i) + arm(3)*turned(2, i)
      w(2, i) = arm(1)*turned(3, i) + (-arm(3))*turned(1, i)
      w(3, i) = (-arm(1))*turned(2, i) + arm(2)*turned(1, i)
    end do
    do i = 1, 3
      w(i, i) = w(i, i) + body(solid_inverse_mx + i - 1)
    end do
  end subroutine set_share

  !> Product of two vectors, in this file so that it is compiled into the block.
  pure function product_of(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c(1) = a(2)*b(3) - a(3)*b(2)
    c(2) = a(3)*b(1) - a(1)*b(3)
    c(3) = a(1)*b(2) - a(2)*b(1)
  end function product_of

  !> Block of W of a contact times an impulse [m/s], components as impulses have them. Moments are over the length of the record,
  !! and spins times it, so that all components have one unit.
  pure function block_times(kind, record, r) result(v)
    integer, intent(in) :: kind !! kind of problem
    real(wp), intent(in) :: record(:) !! record of the contact
    real(wp), intent(in) :: r(6) !! impulse [N s]; components that the kind lacks are zero
    real(wp) :: v(6), n(3), t(3), r_n

    v = 0
    if (kind == solid_rolling .or. kind == solid_mixed) then
      v = moment_block_times(record(:record_length(solid_rolling)), r)
      return
    else if (kind == arm_rolling .or. kind == arm_mixed) then
      v(:2) = record(arm_gyration)*record(arm_wnm:arm_wtm)
      v(:3) = [v(:2)*r(3), dot_product(v(:2), r(:2)) + record(arm_gyration)**2*record(arm_wmm)*r(3)]
      v(:2) = v(:2) + [record(arm_wnn)*r(1) + record(arm_wnt)*r(2), record(arm_wnt)*r(1) + record(arm_wtt)*r(2)]
      return
    end if
    select case (plain_kind(kind))
    case (round_frictionless)
      v(1) = over(r(1), record(round_frictionless_inverse_wnn))
    case (round_frictional)
      v(:2) = [over(r(1), record(round_inverse_wnn)), over(r(2), record(round_inverse_wtt))]
    case (arm_frictionless)
      v(1) = over(r(1), record(arm_frictionless_inverse_wnn))
    case (arm_frictional)
      v(:2) = [record(arm_wnn)*r(1) + record(arm_wnt)*r(2), record(arm_wnt)*r(1) + record(arm_wtt)*r(2)]
    case (ball_frictionless)
      v(1) = over(r(1), record(ball_frictionless_inverse_wnn))
    case (ball_frictional)
      r_n = dot_product(record(normal_x:normal_z), r(:3))
      n = r_n*record(normal_x:normal_z)
      v(:3) = [over(n(1), record(ball_inverse_wnn)) + over(r(1) - n(1), record(ball_inverse_wtt)), &
           over(n(2), record(ball_inverse_wnn)) + over(r(2) - n(2), record(ball_inverse_wtt)), &
           over(n(3), record(ball_inverse_wnn)) + over(r(3) - n(3), record(ball_inverse_wtt))]
    case (solid_frictionless)
      v(1) = over(r(1), record(solid_frictionless_inverse_wnn))
    case (solid_frictional)
      ! In the frame of normal and tangents W is S + w w^T/W_nn.
      n = record(normal_x:normal_z)
      t = product_of(n, record(solid_tangent_x:solid_tangent_z))
      r_n = dot_product(n, r(:3))
      if (record(solid_wnn) > 0) r_n = r_n + (record(solid_wn1)*dot_product(record(solid_tangent_x:solid_tangent_z), r(:3)) &
                                       + record(solid_wn2)*dot_product(t, r(:3)))/record(solid_wnn)
      v(:3) = r_n*(record(solid_wnn)*n + record(solid_wn1)*record(solid_tangent_x:solid_tangent_z) + record(solid_wn2)*t) &
              + record(solid_s1)*dot_product(record(solid_tangent_x:solid_tangent_z), r(:3)) &
              *record(solid_tangent_x:solid_tangent_z) + record(solid_s2)*dot_product(t, r(:3))*t
    end select
  end function block_times

  !> Block of W of a solid contact with a moment, times an impulse and a moment in the world's axes.
  pure function moment_block_times(record, r) result(v)
    real(wp), intent(in) :: record(record_length(solid_rolling)), r(6)
    real(wp) :: v(6), frame(3, 3), w(6, 6), local(6)

    frame(:, 1) = record(normal_x:normal_z)
    frame(:, 2) = record(solid_tangent_x:solid_tangent_z)
    frame(:, 3) = product_of(frame(:, 1), frame(:, 2))
    w = whole_block(record)
    local = matmul(w, [matmul(r(:3), frame), matmul(r(4:), frame(:, [2, 3, 1]))])
    v = [matmul(frame, local(:3)), matmul(frame(:, [2, 3, 1]), local(4:))]
  end function moment_block_times

  !> Whole block of W of a solid contact with a moment [1/kg]: impulses along n, t and n x t, then moments about t, n x t and n over
  !! the length of the record.
  pure function whole_block(record) result(w)
    real(wp), intent(in) :: record(record_length(solid_rolling)) !! record of the contact
    real(wp) :: w(6, 6)

    associate (length => record(solid_gyration))
      w(:3, :3) = solid_block(record(:record_length(solid_frictional)))
      w(:3, 4:) = length*reshape(record(solid_c11:solid_c33), [3, 3])
      w(4:, :3) = transpose(w(:3, 4:))
      w(4:, 4) = record(solid_m11:solid_m31)
      w(4:, 5) = record([solid_m21, solid_m22, solid_m32])
      w(4:, 6) = record([solid_m31, solid_m32, solid_m33])
      w(4:, 4:) = length**2*w(4:, 4:)
    end associate
  end function whole_block

  !> A component over the inverse of a diagonal term of W; zero where the contact takes no part.
  pure real(wp) function over(r, inverse)
    real(wp), intent(in) :: r, inverse

    over = 0
    if (inverse > 0) over = r/inverse
  end function over
end module sg_delassus
