!> Impulses and biases between a problem and an order of sweeps that holds its contacts already.
module sg_order_values
  use sg_contact_lanes, only: give_lanes, put_lane_biases, put_lane_impulses
  use sg_problem, only: problem_t
  use sg_records, only: bias_place, force_length
  use sg_sweep_order, only: sweep_order_t
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

    if (order%lanes%n_groups > 0) then
      call give_lanes(order%lanes, order%contact(:order%n), problem)
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

  !> Copy impulses from the problem to the order, which holds its contacts already.
  pure subroutine put_impulses(order, problem)
    type(sweep_order_t), intent(inout) :: order !! its impulses are set
    type(problem_t), intent(in) :: problem !! problem being swept
    integer :: i

    if (order%lanes%n_groups > 0) call put_lane_impulses(problem, order%contact(:order%n), order%lanes)
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
    integer :: first, last, i

    if (order%lanes%n_groups > 0) call put_lane_biases(problem, order%contact(:order%n), order%lanes)
    if (order%solids%n_groups > 0) call put_row_biases(problem, order%contact(:order%n), order%solids)
    if (.not. order%has_copies) return
    first = bias_place(problem%kind)
    last = first + force_length(problem%kind) - 1
    do i = 1, order%n
      order%record(first:last, i) = problem%record(first:last, order%contact(i))
    end do
  end subroutine put_biases
end module sg_order_values
