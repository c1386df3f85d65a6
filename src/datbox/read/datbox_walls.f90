!> Walls of a DATBOX: the bodies of one JONCx, in space of one PLANx, that DRV_DOF.DAT drives (doc/guide/datbox.md, "Walls").
!!
!! All ranks keep these bodies, so that all list the same walls. The folder does not state on which side grains are: walls have
!! two, unless they bound a cell.
module sg_datbox_walls
  use sg_ascending, only: distinct
  use sg_bodies, only: angle_of
  use sg_contactors, only: kind_plane, kind_segment
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: local_body
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t
  use sg_walls, only: wall_t, walls_t
  implicit none
  private
  public :: driven_bodies, list_datbox_walls

contains

  !> Numbers of the bodies that the drives of a scene name, ascending.
  pure function driven_bodies(scene) result(numbers)
    type(scene_t), intent(in) :: scene !! scene of a DATBOX, before the drives of a deck are added
    integer(i4), allocatable :: numbers(:)
    integer :: i

    numbers = [(int(scene%drives(i)%body, i4), i=1, size(scene%drives))]
    if (allocated(scene%bodies%id)) numbers = scene%bodies%id(numbers)
    numbers = distinct(numbers)
  end function driven_bodies

  !> List the walls, ascending by number.
  pure subroutine list_datbox_walls(scene, driven, walls)
    type(scene_t), intent(in) :: scene !! scene with its bodies at their places, or this rank's share of it
    integer(i4), intent(in) :: driven(:) !! of `driven_bodies`
    type(walls_t), intent(inout) :: walls !! the walls
    integer :: shape_of(scene%bodies%n), c, i
    type(wall_t) :: wall

    ! The shape of a body that has but one, -1 where it has several.
    shape_of = 0
    do c = 1, scene%contactors%n
      associate (shape => shape_of(scene%contactors%body(c)))
        shape = merge(c, -1, shape == 0)
      end associate
    end do
    if (.not. allocated(walls%wall)) allocate (walls%wall(0))
    do i = 1, size(driven)
      c = shape_of(local_body(scene%bodies, driven(i)))
      if (c <= 0) cycle
      if (all(scene%contactors%kind(c) /= [kind_segment, kind_plane])) cycle
      wall = wall_of(scene, c)
      wall%number = driven(i)
      if (wall%area > 0) walls%wall = [walls%wall, wall]
    end do
  end subroutine list_datbox_walls

  !> The wall whose shape this is.
  pure type(wall_t) function wall_of(scene, c) result(wall)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: c
    real(wp) :: angle, frame(3, 3)
    integer :: i

    associate (shapes => scene%contactors, bodies => scene%bodies, b => scene%contactors%body(c), row => scene%contactors%row(c))
      wall%position(:scene%dimension) = bodies%position(:, b)
      if (scene%dimension == 2) then
        angle = angle_of(bodies, int(b))
        wall%shift(:2) = [cos(angle)*shapes%shift(1, c) - sin(angle)*shapes%shift(2, c), &
                          sin(angle)*shapes%shift(1, c) + cos(angle)*shapes%shift(2, c)]
        angle = angle + shapes%segment_size(3, row)
        wall%normal(:2) = [-sin(angle), cos(angle)]
        wall%area = 2*shapes%segment_size(1, row)
        wall%thickness = 2*shapes%segment_size(2, row)
      else
        frame = reshape(shapes%space%plane_frame(:, row), [3, 3])
        wall%shift = shapes%shift(:, c)
        if (allocated(bodies%orientation)) then
          wall%shift = turned_by(bodies%orientation(:, b), wall%shift)
          do i = 1, 3
            frame(:, i) = turned_by(bodies%orientation(:, b), frame(:, i))
          end do
        end if
        wall%normal = frame(:, 3)
        wall%area = 4*product(shapes%space%plane_half(:2, row))
        wall%thickness = 2*shapes%space%plane_half(3, row)
      end if
    end associate
  end function wall_of
end module sg_datbox_walls
