!> How far shapes may move in a step, which decides how far apart contacts are sought (doc/theory/detection.md, "Alert distance").
module sg_way_of_step
  use sg_contactors, only: contactors_t, kind_point
  use sg_extremes, only: largest_magnitude
  use sg_kinds, only: wp
  use sg_scene, only: largest_gravity, scene_t
  use sg_shape_kinds, only: is_round
  implicit none
  private
  public :: farthest_arm, way_of_step

contains

  !> How much nearer two shapes may come to each other in a step with the free velocities [m]: twice what the fastest point moves,
  !! and in a periodic cell what its motion adds.
  pure real(wp) function way_of_step(scene, h, substeps) result(way)
    type(scene_t), intent(in) :: scene !! scene, its free velocities set for the first substep
    real(wp), intent(in) :: h !! length of a substep [s]
    integer, intent(in) :: substeps !! of the step
    ! Squares of larger speeds have no room.
    real(wp), parameter :: most = 1e100_wp
    real(wp) :: fastest

    way = huge(way)/4
    if (scene%bodies%n == 0) return
    if (largest_magnitude(size(scene%bodies%free_velocity), scene%bodies%free_velocity) > most) return
    fastest = sqrt(fastest_square(scene)) + real(substeps - 1, wp)*h*largest_gravity(scene)
    if (scene%cell%is_on) fastest = fastest + speed_in_cell(scene)
    way = 2*real(substeps, wp)*h*fastest
  end function way_of_step

  !> Half of the speed at which the motion of a periodic cell brings two shapes nearer to each other that touch, at most [m/s].
  pure real(wp) function speed_in_cell(scene) result(speed)
    type(scene_t), intent(in) :: scene

    speed = 0
    if (scene%contactors%n == 0) return
    associate (cell => scene%cell)
      speed = sum(max(abs(cell%rate), abs(cell%before)))*maxval(scene%contactors%reach(:scene%contactors%n))
    end associate
  end function speed_in_cell

  !> Square of the largest speed of a point of all shapes, at most [m2/s2].
  pure real(wp) function fastest_square(scene) result(fastest)
    type(scene_t), intent(in) :: scene
    real(wp) :: square, arm
    integer :: c, n

    fastest = 0
    n = scene%dimension
    associate (contactors => scene%contactors, velocity => scene%bodies%free_velocity)
      do c = 1, contactors%n
        if (contactors%kind(c) == kind_point) cycle
        associate (b => contactors%body(c))
          square = velocity(1, b)**2 + velocity(2, b)**2
          if (n == 3) square = square + velocity(3, b)**2
          if (scene%bodies%n_velocity > n) then
            arm = farthest_arm(contactors, c)
            if (arm > 0) square = (sqrt(square) + sqrt(sum(velocity(n + 1:, b)**2))*arm)**2
          end if
        end associate
        fastest = max(fastest, square)
      end do
    end associate
  end function fastest_square

  !> Distance from the centre of its body to the farthest point of a shape that turning moves, at most [m].
  pure real(wp) function farthest_arm(contactors, c) result(arm)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: c !! the one to look at

    arm = sum(abs(contactors%shift(:, c)))
    if (.not. is_round(contactors%kind(c))) arm = arm + contactors%reach(c)
  end function farthest_arm
end module sg_way_of_step
