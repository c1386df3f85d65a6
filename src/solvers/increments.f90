!> LMGC90's stopping criteria: how much each contact still asks to change, seen at contacts that carry an impulse.
!!
!! They measure increments, not errors: a slow sweep passes them far from the solution (doc/theory/errors.md).
module sg_increments
  use sg_kinds, only: wp
  use sg_problem, only: arm_frictional, arm_frictionless, ball_frictional, ball_frictionless, round_frictional, &
                        round_frictionless, solid_frictional, solid_frictionless
  use sg_run_options, only: criterion_maxm, criterion_qm16
  use sg_sweep_order, only: sweep_order_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: increment_criterion

contains

  !> Value of a criterion, to be compared with the tolerance.
  pure real(wp) function increment_criterion(kind, order, asked, criterion) result(value)
    integer, intent(in) :: kind !! kind of problem
    type(sweep_order_t), intent(in) :: order !! contacts visited, with their records and impulses
    real(wp), intent(in) :: asked(:, :) !! impulse that each of them asks while the others stay, shape (components, contacts)
    integer, intent(in) :: criterion !! one of quad, maxm, qm16
    real(wp) :: r(3), change(3), dv(3), wr(3)
    real(wp) :: sum_dv2, sum_wr2, sum_dvr, sum_wrr, sum_dvr2, max_dv2, max_dvr2, mean_dvr, quad_dv, quad_dvr, max_dv, max_dvr
    integer :: k, n, m

    sum_dv2 = 0
    sum_wr2 = 0
    sum_dvr = 0
    sum_wrr = 0
    sum_dvr2 = 0
    max_dv2 = 0
    max_dvr2 = 0
    n = 0
    r = 0
    change = 0
    m = size(asked, 1)
    do k = 1, order%n
      if (.not. any(abs(asked(:, k)) + abs(order%impulse(:, k)) > 0)) cycle
      n = n + 1
      r(:m) = order%impulse(:, k)
      change(:m) = asked(:, k) - r(:m)
      dv = block_times(kind, order%record(:, k), change)
      wr = block_times(kind, order%record(:, k), r)
      sum_dv2 = sum_dv2 + dot_product(dv, dv)
      sum_wr2 = sum_wr2 + dot_product(wr, wr)
      sum_dvr = sum_dvr + dot_product(dv, r)
      sum_wrr = sum_wrr + dot_product(wr, r)
      sum_dvr2 = sum_dvr2 + dot_product(dv, dv)*dot_product(r, r)
      max_dv2 = max(max_dv2, dot_product(dv, dv))
      max_dvr2 = max(max_dvr2, dot_product(dv, dv)*dot_product(r, r))
    end do
    value = 0
    if (n == 0 .or. .not. (sum_wr2 > 0 .and. sum_wrr > 0)) return
    mean_dvr = abs(sum_dvr)/sum_wrr
    quad_dv = sqrt(sum_dv2/sum_wr2)
    quad_dvr = sqrt(sum_dvr2*real(n, wp))/sum_wrr
    max_dv = sqrt(max_dv2*real(n, wp)/sum_wr2)
    max_dvr = sqrt(max_dvr2)*real(n, wp)/sum_wrr
    select case (criterion)
    case (criterion_maxm)
      value = max(mean_dvr, max_dv, max_dvr)
    case (criterion_qm16)
      value = max(mean_dvr, quad_dv, quad_dvr, max_dv/16.666_wp, max_dvr/16.666_wp)
    case default
      value = max(mean_dvr, quad_dv, quad_dvr)
    end select
  end function increment_criterion

  !> Block of W of a contact times an impulse [m/s], components as impulses have them.
  pure function block_times(kind, record, r) result(v)
    integer, intent(in) :: kind
    real(wp), intent(in) :: record(:), r(3)
    real(wp) :: v(3), n(3), t(3), r_n

    v = 0
    select case (kind)
    case (round_frictionless)
      v(1) = over(r(1), record(4))
    case (round_frictional)
      v(:2) = [over(r(1), record(5)), over(r(2), record(6))]
    case (arm_frictionless)
      v(1) = over(r(1), record(6))
    case (arm_frictional)
      v(:2) = [record(9)*r(1) + record(10)*r(2), record(10)*r(1) + record(11)*r(2)]
    case (ball_frictionless)
      v(1) = over(r(1), record(5))
    case (ball_frictional)
      r_n = dot_product(record(1:3), r)
      n = r_n*record(1:3)
      v = [over(n(1), record(7)) + over(r(1) - n(1), record(8)), over(n(2), record(7)) + over(r(2) - n(2), record(8)), &
           over(n(3), record(7)) + over(r(3) - n(3), record(8))]
    case (solid_frictionless)
      v(1) = over(r(1), record(11))
    case (solid_frictional)
      ! In the frame of normal and tangents W is S + w w^T/W_nn.
      n = record(1:3)
      t = cross(n, record(4:6))
      r_n = dot_product(n, r)
      if (record(16) > 0) r_n = r_n + (record(17)*dot_product(record(4:6), r) + record(18)*dot_product(t, r))/record(16)
      v = r_n*(record(16)*n + record(17)*record(4:6) + record(18)*t) + record(19)*dot_product(record(4:6), r)*record(4:6) &
          + record(20)*dot_product(t, r)*t
    end select
  end function block_times

  !> A component over the inverse of a diagonal term of W; zero where the contact takes no part.
  pure real(wp) function over(r, inverse)
    real(wp), intent(in) :: r, inverse

    over = 0
    if (inverse > 0) over = r/inverse
  end function over
end module sg_increments
