!> Lists of neighbours in a periodic cell: when they no longer hold, and bodies brought back into the cell
!! (doc/theory/periodic_cell.md).
module sg_cell_search
  use sg_kinds, only: wp, i4
  use sg_near, only: turning_arm
  use sg_scene, only: scene_t
  use sg_sees, only: widest_alert
  implicit none
  private
  public :: has_moved_in_cell, turned_angle, wrap_in_cell

contains

  !> Has something moved so far that a list of neighbours no longer holds all that may touch? Bodies count with their own motion,
  !! beyond that of the cell; the skin, less what the cell has brought two shapes nearer to each other that the list does not hold.
  pure logical function has_moved_in_cell(scene, built, skin) result(stale)
    type(scene_t), intent(in) :: scene !! scene with its `middle` configuration
    real(wp), intent(in) :: built(:, :) !! configuration at the making of the list, as `middle`
    real(wp), intent(in) :: skin !! of the list [m]
    real(wp) :: moved, arm, left, widest, carried(3), now(3)
    integer :: c, b, n

    n = scene%dimension
    widest = 2*maxval([0.0_wp, scene%contactors%reach(:scene%contactors%n)]) + widest_alert(scene%sees, huge(1.0_wp))
    associate (distortion => scene%cell%distortion())
      left = (1 - distortion)*skin - distortion*widest
    end associate
    stale = .true.
    if (.not. left > 0) return
    carried = 0
    now = 0
    do c = 1, scene%contactors%n
      b = scene%contactors%body(c)
      carried(:n) = built(:n, b)
      now(:n) = scene%bodies%middle(:n, b)
      moved = norm2(now - scene%cell%carried(carried))
      if (scene%bodies%n_velocity > n) then
        arm = turning_arm(scene%contactors, c)
        if (arm > 0) moved = moved + turned_angle(scene%bodies%middle(:, b), built(:, b))*arm
      end if
      if (moved > left/2) return
    end do
    stale = .false.
  end function has_moved_in_cell

  !> Angle between two configurations of a body [rad].
  pure real(wp) function turned_angle(now, then) result(angle)
    real(wp), intent(in) :: now(:) !! one
    real(wp), intent(in) :: then(:) !! the other, as `middle`

    if (size(now) == 3) then
      angle = abs(now(3) - then(3))
    else
      ! Unit quaternions q and -q are one orientation; half the angle between quaternions is a quarter of the rotation's.
      angle = 4*asin(min(1.0_wp, min(norm2(now(4:7) - then(4:7)), norm2(now(4:7) + then(4:7)))/2))
    end if
  end function turned_angle

  !> Fold the tilt of the cell back, and bring bodies back into the cell, counting crossings. Its edges are others in the
  !! configuration of the list than in positions.
  !! The upper face is moved along x by the tilt: faces along y are crossed first.
  subroutine wrap_in_cell(scene, configuration)
    type(scene_t), intent(inout) :: scene !! its bodies are moved by whole periods
    real(wp), intent(inout) :: configuration(:, :) !! of the list, as `middle`
    integer(i4) :: folds
    integer :: b

    associate (bodies => scene%bodies, cell => scene%cell)
      call cell%fold(folds)
      cell%built = cell%middle
      if (folds /= 0) bodies%crossings = bodies%crossings + folds*bodies%crossings_y
      do b = 1, bodies%n
        if (scene%dimension == 3) call cross(3, b, bodies%crossings_z(b))
        call cross(2, b, bodies%crossings_y(b))
        call cross(1, b, bodies%crossings(b))
      end do
    end associate

  contains

    !> Bring a body back along one axis.
    subroutine cross(axis, b, crossings)
      integer, intent(in) :: axis, b
      integer(i4), intent(inout) :: crossings
      real(wp), parameter :: most = 2e9_wp
      real(wp) :: crossed

      associate (bodies => scene%bodies, cell => scene%cell)
        crossed = configuration(axis, b)/cell%middle(axis)
        crossed = crossed - modulo(crossed, 1.0_wp)
        if (.not. abs(crossed) > 0) return
        configuration(axis, b) = configuration(axis, b) - crossed*cell%middle(axis)
        bodies%middle(axis, b) = bodies%middle(axis, b) - crossed*cell%middle(axis)
        bodies%position(axis, b) = bodies%position(axis, b) - crossed*cell%now(axis)
        if (axis == 2) then
          configuration(1, b) = configuration(1, b) - crossed*cell%middle(4)
          bodies%middle(1, b) = bodies%middle(1, b) - crossed*cell%middle(4)
          bodies%position(1, b) = bodies%position(1, b) - crossed*cell%now(4)
        end if
        crossings = int(max(-most, min(most, real(crossings, wp) + crossed)), i4)
      end associate
    end subroutine cross
  end subroutine wrap_in_cell
end module sg_cell_search
