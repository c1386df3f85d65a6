!> How far shapes may move in a step, which decides how far apart contacts are sought (doc/theory/detection.md, "Alert distance").
module sg_way_of_step
  use sg_contactors, only: kind_point
  use sg_extremes, only: largest_magnitude
  use sg_kinds, only: wp, i4
  use sg_near, only: farthest_arm
  use sg_scene, only: largest_gravity, scene_t
  implicit none
  private
  public :: way_of_solution, way_of_step

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
    fastest = sqrt(fastest_square(scene, scene%bodies%free_velocity, scene%bodies%n_velocity - scene%dimension)) + &
              real(substeps - 1, wp)*h*largest_gravity(scene)
    if (scene%cell%is_on) fastest = fastest + speed_in_cell(scene)
    way = 2*real(substeps, wp)*h*fastest
  end function way_of_step

  !> How much nearer two shapes come to each other in a step by the velocities of its solution, at most [m].
  pure real(wp) function way_of_solution(scene, velocity, slot_of, turns, h) result(way)
    type(scene_t), intent(in) :: scene !! scene without a periodic cell
    real(wp), intent(in) :: velocity(:, :) !! records of the bodies of its problem, which begin with velocity and spin
    integer(i4), intent(in) :: slot_of(:) !! slot of each body
    logical, intent(in) :: turns !! do the records have a spin that moves points towards others?
    real(wp), intent(in) :: h !! length of the step [s]

    way = 2*h*sqrt(fastest_square(scene, velocity, merge(scene%bodies%n_velocity - scene%dimension, 0, turns), slot_of))
  end function way_of_solution

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
  pure real(wp) function fastest_square(scene, velocity, n_spin, slot_of) result(fastest)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: velocity(:, :) !! velocities, and spins behind them
    integer, intent(in) :: n_spin !! components of spins
    integer(i4), intent(in), optional :: slot_of(:) !! column of each body; its own number when absent
    real(wp) :: square, arm
    integer :: c, n, s

    fastest = 0
    n = scene%dimension
    associate (contactors => scene%contactors)
      do c = 1, contactors%n
        if (contactors%kind(c) == kind_point) cycle
        s = contactors%body(c)
        if (present(slot_of)) s = slot_of(s)
        square = velocity(1, s)**2 + velocity(2, s)**2
        if (n == 3) square = square + velocity(3, s)**2
        if (n_spin > 0) then
          arm = farthest_arm(contactors, c)
          if (arm > 0) square = (sqrt(square) + sqrt(sum(velocity(n + 1:n + n_spin, s)**2))*arm)**2
        end if
        fastest = max(fastest, square)
      end do
    end associate
  end function fastest_square
end module sg_way_of_step
