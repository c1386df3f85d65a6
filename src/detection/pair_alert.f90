!> Alert distance of a pair, reduced to what its own motion asks for until the solution shows that more is needed
!! (doc/theory/detection.md, "Alert distance").
module sg_pair_alert
  use sg_kinds, only: wp, i4
  use sg_near, only: farthest_arm
  use sg_neighbour_list, only: neighbours_t
  use sg_scene, only: scene_t
  use sg_sees, only: follows_motion
  implicit none
  private
  public :: alert_between, alert_of_pair, closing_way, find_free_motion, find_motion, least_reduced, reduce_alerts, &
            times

  !> Least reduced alert distance as shares of the least one of a line and of the way of the fastest shapes
  real(wp), parameter :: least_share = 0.1_wp, share_of_fastest = 0.02_wp
  !> Multiple of the way of a pair with its free velocities up to which its contacts are sought
  real(wp), parameter :: times = 2

contains

  !> Let pairs be sought as far as they come nearer to each other in a step, until its solution shows that more is needed.
  subroutine reduce_alerts(scene, h, pairs)
    type(scene_t), intent(in) :: scene !! scene with its free velocities
    real(wp), intent(in) :: h !! length of the step [s]
    type(neighbours_t), intent(inout) :: pairs !! list of neighbours, the way of its step set

    ! Squares of larger speeds have no room.
    pairs%is_reduced = pairs%way < huge(1.0_wp)/8
    if (.not. pairs%is_reduced) return
    pairs%time_step = h
    if (.not. allocated(pairs%least)) allocate (pairs%least(size(scene%sees)))
    pairs%least(:) = merge(max(least_share*scene%sees%least_alert, share_of_fastest*pairs%way), scene%sees%alert, &
                           follows_motion(scene%sees))
    ! No pair has a longer way than the fastest would have.
    pairs%is_by_pair = times*pairs%way > least_reduced(scene, pairs)
    if (pairs%is_by_pair) call find_free_motion(scene, pairs)
  end subroutine reduce_alerts

  !> Least distance of the lines whose alert distance follows the motion [m]; hugely much where there is none.
  pure real(wp) function least_reduced(scene, pairs) result(least)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    type(neighbours_t), intent(in) :: pairs !! list of neighbours with reduced alert distances

    least = minval(pairs%least, follows_motion(scene%sees))
  end function least_reduced

  !> Motion of all shapes with the free velocities of their bodies.
  pure subroutine find_free_motion(scene, pairs)
    type(scene_t), intent(in) :: scene !! scene with its free velocities
    type(neighbours_t), intent(inout) :: pairs !! list of neighbours, its time step set

    call find_motion(scene, scene%bodies%free_velocity, scene%bodies%n_velocity > scene%dimension, times*pairs%time_step, &
                     pairs%motion)
  end subroutine find_free_motion

  !> Gap from which contacts of a pair are not sought [m].
  pure real(wp) function alert_of_pair(pairs, p) result(alert)
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    integer, intent(in) :: p !! pair that is no link

    alert = pairs%alert(pairs%see(p))
    if (.not. pairs%is_reduced) return
    if (pairs%is_by_pair) then
      alert = alert_between(pairs%contactor(1, p), pairs%contactor(2, p), size(pairs%motion, 1), pairs%motion, &
                            pairs%least(pairs%see(p)), alert)
    else
      alert = min(alert, pairs%least(pairs%see(p)))
    end if
  end function alert_of_pair

  !> The same of two shapes: as far as they come nearer to each other, between two bounds. Squares decide where it is the first.
  pure real(wp) function alert_between(c, a, n, motion, least, alert)
    integer(i4), intent(in) :: c, a !! the two
    integer, intent(in) :: n !! values of a motion, one more than dimensions of space
    real(wp), intent(in) :: motion(n, *) !! of all shapes (`find_motion`)
    real(wp), intent(in) :: least, alert !! bounds [m]
    real(wp) :: square, turning

    alert_between = min(alert, least)
    square = square_between(c, a, n, motion)
    turning = motion(n, c) + motion(n, a)
    if (turning > alert_between .or. square > (alert_between - turning)**2) alert_between = min(alert, sqrt(square) + turning)
  end function alert_between

  !> Square of the way of two bodies against each other [m2].
  pure real(wp) function square_between(c, a, n, motion) result(square)
    integer(i4), intent(in) :: c, a
    integer, intent(in) :: n
    real(wp), intent(in) :: motion(n, *)

    square = (motion(1, c) - motion(1, a))**2 + (motion(2, c) - motion(2, a))**2
    if (n == 4) square = square + (motion(3, c) - motion(3, a))**2
  end function square_between

  !> How much nearer two shapes come to each other by their motion [m], at most.
  pure real(wp) function closing_way(motion, c, a) result(way)
    real(wp), intent(in), contiguous :: motion(:, :) !! of all shapes (`find_motion`)
    integer(i4), intent(in) :: c, a !! the two

    associate (n => size(motion, 1))
      way = sqrt(square_between(c, a, n, motion)) + (motion(n, c) + motion(n, a))
    end associate
  end function closing_way

  !> Motion of all shapes with velocities of their bodies [m]: the way of the body, and how far its turn moves a point of the shape
  !! at most, shape (3 or 4, contactors).
  pure subroutine find_motion(scene, velocity, turns, h, motion, column)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed or not
    real(wp), intent(in), contiguous :: velocity(:, :) !! velocities, and spins behind them
    logical, intent(in) :: turns !! are there spins that move points towards others?
    real(wp), intent(in) :: h !! time of the motion [s]
    real(wp), allocatable, intent(inout) :: motion(:, :) !! of each contactor
    integer(i4), intent(in), contiguous, optional :: column(:) !! of each body in `velocity`; its own number when absent
    real(wp) :: arm
    integer :: c, b, n

    n = scene%dimension
    if (allocated(motion)) then
      if (size(motion, 2) /= scene%contactors%n) deallocate (motion)
    end if
    if (.not. allocated(motion)) allocate (motion(n + 1, scene%contactors%n))
    do c = 1, scene%contactors%n
      b = scene%contactors%body(c)
      if (present(column)) b = column(b)
      motion(1, c) = h*velocity(1, b)
      motion(2, c) = h*velocity(2, b)
      if (n == 3) motion(3, c) = h*velocity(3, b)
      motion(n + 1, c) = 0
      if (.not. turns) cycle
      arm = farthest_arm(scene%contactors, c)
      if (.not. arm > 0) cycle
      if (n == 2) motion(3, c) = h*arm*abs(velocity(3, b))
      if (n == 3) motion(4, c) = h*arm*sqrt(velocity(4, b)**2 + velocity(5, b)**2 + velocity(6, b)**2)
    end do
  end subroutine find_motion
end module sg_pair_alert
