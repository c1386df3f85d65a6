!> Impulses and biases between a problem and an order of sweeps that holds its contacts already.
module sg_order_values
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_records, only: bias_place, force_length, round_frictional
  use sg_sweep_order, only: sweep_order_t
  use sg_sweep_round_lanes, only: plain_length_of_disks
  use sg_sweep_solid_order, only: give_rows, put_row_biases, put_rows
  implicit none
  private
  public :: give_impulses, put_biases, put_impulses

contains

  !> Copy impulses from the order back to the problem.
  pure subroutine give_impulses(order, problem)
    type(sweep_order_t), intent(inout) :: order !! swept order
    type(problem_t), intent(inout) :: problem !! its impulses are set
    integer :: i

    if (order%n_groups > 0) then
      call give_lanes(order%n_groups, size(problem%impulse, 1), order%group_size, order%contact, order%lane_impulse, &
                      problem%impulse)
    else if (order%solids%n_groups > 0) then
      call give_rows(order%solids, order%contact(:order%n), problem)
    else
      do i = 1, order%n
        problem%impulse(:, order%contact(i)) = order%impulse(:, i)
      end do
      return
    end if
    if (.not. order%has_copies) return
    do i = 1, order%n
      order%impulse(:, i) = problem%impulse(:, order%contact(i))
    end do
  end subroutine give_impulses

  !> Impulses of contacts side by side.
  pure subroutine give_lanes(n_groups, components, group_size, contact, lane_impulse, impulse)
    integer, intent(in) :: n_groups, components
    integer(i4), intent(in) :: group_size(*), contact(*)
    real(wp), intent(in) :: lane_impulse(lanes, components, *)
    real(wp), intent(inout) :: impulse(components, *)
    integer :: g, i, e

    e = 0
    do g = 1, n_groups
      do i = 1, group_size(g)
        e = e + 1
        impulse(1, contact(e)) = lane_impulse(i, 1, g)
        impulse(2, contact(e)) = lane_impulse(i, 2, g)
        if (components > 2) impulse(3, contact(e)) = lane_impulse(i, 3, g)
      end do
    end do
  end subroutine give_lanes

  !> Copy impulses from the problem to the order, which holds its contacts already.
  pure subroutine put_impulses(order, problem)
    type(sweep_order_t), intent(inout) :: order !! its impulses are set
    type(problem_t), intent(in) :: problem !! problem being swept
    integer :: i, g, e

    e = 0
    do g = 1, order%n_groups
      do i = 1, order%group_size(g)
        e = e + 1
        order%lane_impulse(i, :, g) = problem%impulse(:, order%contact(e))
      end do
    end do
    if (order%solids%n_groups > 0) call put_rows(problem, order%contact(:order%n), order%solids)
    if (.not. order%has_copies) return
    do i = 1, order%n
      order%impulse(:, i) = problem%impulse(:, order%contact(i))
    end do
  end subroutine put_impulses

  !> Copy biases from the problem to the order, which holds its contacts already.
  pure subroutine put_biases(order, problem)
    type(sweep_order_t), intent(inout) :: order !! its records change
    type(problem_t), intent(in) :: problem !! problem being swept
    integer :: first, last, i, g, e

    first = bias_place(problem%kind)
    last = first + force_length(problem%kind) - 1
    ! Plain disks have none along tangents.
    if (problem%kind == round_frictional .and. order%n_groups > 0) then
      if (size(order%lane_record, 2) == plain_length_of_disks) last = first
    end if
    e = 0
    do g = 1, order%n_groups
      do i = 1, order%group_size(g)
        e = e + 1
        order%lane_record(i, first:last, g) = problem%record(first:last, order%contact(e))
      end do
    end do
    if (order%solids%n_groups > 0) call put_row_biases(problem, order%contact(:order%n), order%solids)
    if (.not. order%has_copies) return
    do i = 1, order%n
      order%record(first:last, i) = problem%record(first:last, order%contact(i))
    end do
  end subroutine put_biases
end module sg_order_values
