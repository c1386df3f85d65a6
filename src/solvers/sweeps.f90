!> One sweep over contacts in a chosen order, by the kernel of the problem's kind.
module sg_sweeps
  use sg_kinds, only: wp
  use sg_problem, only: arm_frictional, arm_frictionless, ball_frictional, ball_frictionless, round_frictional, &
                        round_frictionless, solid_frictional, solid_frictionless
  use sg_sweep_arm, only: sweep_arm_frictional, sweep_arm_frictionless
  use sg_sweep_ball, only: sweep_ball_frictional, sweep_ball_frictionless
  use sg_sweep_ball_lanes, only: sweep_ball_lanes
  use sg_sweep_order, only: sweep_order_t
  use sg_sweep_round, only: sweep_round_frictional, sweep_round_frictionless
  use sg_sweep_solid, only: sweep_solid_frictional, sweep_solid_frictionless
  use sg_sweep_solid_lanes, only: sweep_solid_lanes
  implicit none
  private
  public :: sweep, sweep_impulses

contains

  !> Update every contact of an order once.
  pure subroutine sweep(kind, order, n_bodies, relaxation, body)
    integer, intent(in) :: kind !! kind of problem
    type(sweep_order_t), intent(inout) :: order !! contacts to visit; their impulses change
    integer, intent(in) :: n_bodies !! slots
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: body(:, :) !! body records; their velocities change

    if (order%n_groups > 0) then
      call sweep_ball_lanes(order%n_groups, n_bodies, order%lane_pair, order%lane_record, relaxation, order%lane_impulse, body)
    else if (order%solids%n_groups > 0) then
      associate (solids => order%solids)
        call sweep_solid_lanes(solids%n_groups, solids%n_rows, n_bodies, solids%last_row, solids%row_size, solids%pair, &
                               solids%special, relaxation, solids%row, body)
      end associate
    else
      call sweep_impulses(kind, order, n_bodies, relaxation, order%impulse, body)
    end if
  end subroutine sweep

  !> The same with impulses that stand apart, one by one.
  pure subroutine sweep_impulses(kind, order, n_bodies, relaxation, impulse, body)
    integer, intent(in) :: kind !! kind of problem
    type(sweep_order_t), intent(in) :: order !! contacts to visit
    integer, intent(in) :: n_bodies !! slots
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(:, :) !! impulses in the order of the sweep
    real(wp), intent(inout) :: body(:, :) !! body records; their velocities change

    select case (kind)
    case (round_frictionless)
      call sweep_round_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (round_frictional)
      call sweep_round_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (arm_frictionless)
      call sweep_arm_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (arm_frictional)
      call sweep_arm_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (ball_frictionless)
      call sweep_ball_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (ball_frictional)
      call sweep_ball_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (solid_frictionless)
      call sweep_solid_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (solid_frictional)
      call sweep_solid_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    end select
  end subroutine sweep_impulses
end module sg_sweeps
