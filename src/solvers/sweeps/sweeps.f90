!> One sweep over contacts in a chosen order, by the kernel of the problem's kind.
module sg_sweeps
  use, intrinsic :: iso_c_binding, only: c_int
  use sg_contact_lanes, only: contact_lanes_t
  use sg_iterates, only: iterates_t, takes_momentum
  use sg_kinds, only: wp, i4
  use sg_records, only: arm_bonded, arm_frictional, arm_frictionless, arm_mixed, arm_rolling, ball_frictional, ball_frictionless, &
                        round_frictional, round_frictionless, solid_bonded, solid_frictional, solid_frictionless, solid_mixed, &
                        solid_rolling
  use sg_sweep_arm, only: sweep_arm_bonded, sweep_arm_frictional, sweep_arm_frictionless
  use sg_sweep_arm_lanes, only: sweep_arm_lanes
  use sg_sweep_ball, only: sweep_ball_frictional, sweep_ball_frictionless
  use sg_sweep_ball_lanes, only: sweep_ball_lanes
  use sg_sweep_arm_rolling, only: sweep_arm_mixed, sweep_arm_rolling
  use sg_sweep_order, only: sweep_order_t
  use sg_sweep_round_lanes, only: plain_length_of_disks, sweep_round_lanes
  use sg_sweep_round, only: sweep_round_frictional, sweep_round_frictionless
  use sg_sweep_solid, only: sweep_solid_bonded, sweep_solid_frictional, sweep_solid_frictionless
  use sg_sweep_solid_lanes, only: sweep_solid_lanes
  use sg_sweep_solid_order, only: solid_lanes_t
  use sg_sweep_solid_rolling, only: sweep_solid_mixed, sweep_solid_rolling
  use sg_threads, only: begin_share, is_in_team, n_sharing, piece_t, share_t, takes
  implicit none
  private
  public :: sweep, sweep_impulses

  !> Least contacts of an order that threads share: a sweep of fewer takes as long as threads need to meet
  integer, parameter :: least_contacts = 3000

contains

  !> Update every contact of an order once. Solids side by side may take momentum.
  subroutine sweep(kind, order, n_bodies, relaxation, body, past)
    integer, intent(in) :: kind !! kind of problem
    type(sweep_order_t), intent(inout) :: order !! contacts to visit; their impulses change
    integer, intent(in) :: n_bodies !! slots
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout), contiguous :: body(:, :) !! body records; their velocities change
    type(iterates_t), intent(inout), optional :: past !! iterates of solids side by side, whose bodies have gone on by its share of
                                                      !! their last change; its sums are set

    if (order%blocks%n > 0) then
      call sweep_colours(kind, order, n_bodies, relaxation, body, past)
    else if (order%lanes%n_groups > 0) then
      call sweep_groups(kind, order%lanes, 1, order%lanes%n_groups, n_bodies, relaxation, body)
    else if (.not. takes_momentum(order)) then
      call sweep_run(kind, order%n, n_bodies, order%pair, order%record, relaxation, order%impulse, body)
    else if (present(past)) then
      call sweep_solids(order%solids, 1, order%solids%n_groups, n_bodies, relaxation, body, past%share, past%before, past%sums)
    else
      call sweep_solids(order%solids, 1, order%solids%n_groups, n_bodies, relaxation, body)
    end if
  end subroutine sweep

  !> The same, colour by colour: threads share the blocks of a colour, which touch no body in common. The result does not depend on
  !! which thread sweeps a block. Where no team of threads is at work yet, there is one for this sweep.
  subroutine sweep_colours(kind, order, n_bodies, relaxation, body, past)
    integer, intent(in) :: kind, n_bodies
    type(sweep_order_t), intent(inout) :: order
    real(wp), intent(in) :: relaxation
    real(wp), intent(inout), contiguous :: body(:, :)
    type(iterates_t), intent(inout), optional :: past
    real(wp) :: sums(2, order%blocks%n)

    if (order%threads == 1 .or. is_in_team()) then
      call share_blocks(kind, order, n_bodies, relaxation, body, sums, past)
    else
      !$omp parallel default(shared) num_threads(order%threads)
      !$omp master
      call share_blocks(kind, order, n_bodies, relaxation, body, sums, past)
      !$omp end master
      !$omp end parallel
    end if
    if (present(past)) past%sums = sum(sums, 2)
  end subroutine sweep_colours

  !> Sweep the blocks, colour by colour.
  subroutine share_blocks(kind, order, n_bodies, relaxation, body, sums, past)
    integer, intent(in) :: kind, n_bodies
    type(sweep_order_t), intent(inout) :: order
    real(wp), intent(in) :: relaxation
    real(wp), intent(inout), contiguous :: body(:, :)
    real(wp), intent(out) :: sums(2, order%blocks%n) !! of each block
    type(iterates_t), intent(inout), optional :: past
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: c, b, t, least

    least = merge(1, huge(1), order%n >= least_contacts)
    do c = 1, order%blocks%n_colours
      associate (last => order%blocks%last_of_colour(c - 1))
        call begin_share(share, order%blocks%last_of_colour(c) - last, least)
        !$omp taskloop default(shared) private(t, b, piece) grainsize(1) if (share%pieces > 1)
        do t = 1, n_sharing()
          do while (takes(share, piece))
            do b = last + piece%first, last + piece%last
              call sweep_block(kind, order, b, n_bodies, relaxation, body, sums(:, b), past)
            end do
          end do
        end do
      end associate
    end do
  end subroutine share_blocks

  !> Sweep one block.
  pure subroutine sweep_block(kind, order, b, n_bodies, relaxation, body, sums, past)
    integer, intent(in) :: kind, b, n_bodies
    type(sweep_order_t), intent(inout) :: order
    real(wp), intent(in) :: relaxation
    real(wp), intent(inout), contiguous :: body(:, :)
    real(wp), intent(out) :: sums(2) !! of this block, where it takes momentum
    type(iterates_t), intent(inout), optional :: past
    integer :: first, last

    sums = 0
    if (order%lanes%n_groups > 0) then
      call sweep_groups(kind, order%lanes, order%blocks%last_group(b - 1) + 1, order%blocks%last_group(b), n_bodies, relaxation, &
                        body)
    else if (.not. takes_momentum(order)) then
      first = order%blocks%last(b - 1) + 1
      last = order%blocks%last(b)
      call sweep_run(kind, last - first + 1, n_bodies, order%pair(:, first:last), order%record(:, first:last), relaxation, &
                     order%impulse(:, first:last), body)
    else
      first = order%blocks%last_solid_group(b - 1) + 1
      last = order%blocks%last_solid_group(b)
      if (present(past)) then
        call sweep_solids(order%solids, first, last, n_bodies, relaxation, body, past%share, past%before, sums)
      else
        call sweep_solids(order%solids, first, last, n_bodies, relaxation, body)
      end if
    end if
  end subroutine sweep_block

  !> Sweep groups of contacts side by side.
  pure subroutine sweep_groups(kind, lanes, first, last, n_bodies, relaxation, body)
    integer, intent(in) :: kind, first, last, n_bodies
    type(contact_lanes_t), intent(inout) :: lanes
    real(wp), intent(in) :: relaxation
    real(wp), intent(inout), contiguous :: body(:, :)

    associate (pair => lanes%pair(:, :, first:last), record => lanes%record(:, :, first:last), &
               impulse => lanes%impulse(:, :, first:last))
      select case (kind)
      case (round_frictional)
        call sweep_round_lanes(int(last - first + 1, c_int), &
                               merge(1_c_int, 0_c_int, size(lanes%record, 2) == plain_length_of_disks), int(n_bodies, c_int), &
                               pair, record, lanes%shared, relaxation, impulse, body)
      case (ball_frictional)
        call sweep_ball_lanes(int(last - first + 1, c_int), pair, record, relaxation, impulse, body)
      case default
        call sweep_arm_lanes(int(last - first + 1, c_int), pair, record, relaxation, impulse, body)
      end select
    end associate
  end subroutine sweep_groups

  !> Sweep groups of solids side by side.
  pure subroutine sweep_solids(solids, first, last, n_bodies, relaxation, body, share, before, sums)
    type(solid_lanes_t), intent(inout) :: solids
    integer, intent(in) :: first, last, n_bodies
    real(wp), intent(in) :: relaxation
    real(wp), intent(inout), contiguous :: body(:, :)
    real(wp), intent(in), optional :: share
    real(wp), intent(inout), optional :: before(*)
    real(wp), intent(out), optional :: sums(2)

    call sweep_solid_lanes(first, last, solids%n_groups, solids%n_rows, n_bodies, solids%last_row, solids%row_size, solids%pair, &
                           solids%special, relaxation, solids%row, body, share, before, sums)
  end subroutine sweep_solids

  !> The same with impulses that stand apart, one by one.
  pure subroutine sweep_impulses(kind, order, n_bodies, relaxation, impulse, body)
    integer, intent(in) :: kind !! kind of problem
    type(sweep_order_t), intent(in) :: order !! contacts to visit
    integer, intent(in) :: n_bodies !! slots
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout), contiguous :: impulse(:, :) !! impulses in the order of the sweep
    real(wp), intent(inout), contiguous :: body(:, :) !! body records; their velocities change

    call sweep_run(kind, order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
  end subroutine sweep_impulses

  !> The same for a run of contacts, by the kernel of the problem's kind.
  pure subroutine sweep_run(kind, n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: kind !! kind of problem
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in), contiguous :: pair(:, :) !! their bodies
    real(wp), intent(in), contiguous :: record(:, :) !! their records
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout), contiguous :: impulse(:, :) !! their impulses
    real(wp), intent(inout), contiguous :: body(:, :) !! body records; their velocities change

    select case (kind)
    case (round_frictionless)
      call sweep_round_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    case (round_frictional)
      call sweep_round_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    case (arm_frictionless)
      call sweep_arm_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    case (arm_frictional)
      call sweep_arm_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    case (ball_frictionless)
      call sweep_ball_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    case (ball_frictional)
      call sweep_ball_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    case (solid_frictionless)
      call sweep_solid_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    case (solid_frictional)
      call sweep_solid_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    case (arm_bonded)
      call sweep_arm_bonded(n, n_bodies, pair, record, relaxation, impulse, body)
    case (solid_bonded)
      call sweep_solid_bonded(n, n_bodies, pair, record, relaxation, impulse, body)
    case (arm_rolling)
      call sweep_arm_rolling(n, n_bodies, pair, record, relaxation, impulse, body)
    case (solid_rolling)
      call sweep_solid_rolling(n, n_bodies, pair, record, relaxation, impulse, body)
    case (arm_mixed)
      call sweep_arm_mixed(n, n_bodies, pair, record, relaxation, impulse, body)
    case (solid_mixed)
      call sweep_solid_mixed(n, n_bodies, pair, record, relaxation, impulse, body)
    end select
  end subroutine sweep_run
end module sg_sweeps
