!> LMGC90's stopping criteria: how much each contact still asks to change, seen at contacts that carry an impulse.
!!
!! They measure increments, not errors: a slow sweep passes them far from the solution (doc/theory/errors.md).
module sg_increments
  use sg_kinds, only: wp
  use sg_problem, only: arm_frictional, arm_frictionless, round_frictional, round_frictionless
  use sg_run_options, only: criterion_maxm, criterion_qm16
  use sg_sweep_order, only: sweep_order_t
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
    real(wp) :: w(3), r(2), change(2), dv(2), wr(2)
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
      w = block_of(kind, order%record(:, k))
      r(:m) = order%impulse(:, k)
      change(:m) = asked(:, k) - r(:m)
      dv = [w(1)*change(1) + w(2)*change(2), w(2)*change(1) + w(3)*change(2)]
      wr = [w(1)*r(1) + w(2)*r(2), w(2)*r(1) + w(3)*r(2)]
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

  !> Block of W of a contact: normal, coupling, tangential [1/kg].
  pure function block_of(kind, record) result(w)
    integer, intent(in) :: kind
    real(wp), intent(in) :: record(:)
    real(wp) :: w(3)

    w = 0
    select case (kind)
    case (round_frictionless)
      if (record(4) > 0) w(1) = 1/record(4)
    case (round_frictional)
      if (record(5) > 0) w(1) = 1/record(5)
      if (record(6) > 0) w(3) = 1/record(6)
    case (arm_frictionless)
      if (record(6) > 0) w(1) = 1/record(6)
    case (arm_frictional)
      w = record(9:11)
    end select
  end function block_of
end module sg_increments
