!> Area or volume of a shape within an upright box: of disks, polygons and rounded segments, of spheres, polyhedra and cylinders.
!!
!! The same kernels as those of overlaps, with the box as the other shape. Hollow shapes and planes, which bound others, have none.
module sg_share_in_box
  use sg_contactors, only: contactors_t, kind_cylinder, kind_disk, kind_polygon, kind_polyhedron, kind_segment, kind_sphere
  use sg_kinds, only: wp
  use sg_overlap, only: overlap_disk_polygon, overlap_polygon_polygon, overlap_polygon_segment
  use sg_overlap_cylinders, only: overlap_cylinder_plane
  use sg_overlap_polyhedra, only: measure_polyhedron_plane, overlap_room_t
  use sg_overlap_spheres, only: overlap_sphere_plane
  implicit none
  private
  public :: share_in_box

  !> Axes of an upright box
  real(wp), parameter :: upright(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

  !> Area of a placed shape within a box [m2], in space its volume [m3].
  pure subroutine share_in_box(contactors, c, lower, upper, room, share)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer, intent(in) :: c !! the shape
    real(wp), intent(in) :: lower(:), upper(:) !! corners of the box [m], two or three coordinates
    type(overlap_room_t), intent(inout) :: room !! room for the work
    real(wp), intent(out) :: share !! [m2] or [m3]

    share = 0
    if (any(contactors%centre(:, c) + contactors%reach(c) <= lower)) return
    if (any(contactors%centre(:, c) - contactors%reach(c) >= upper)) return
    if (size(lower) == 2) then
      share = share_in_plane(contactors, c, reshape([lower(1), lower(2), upper(1), lower(2), upper(1), upper(2), &
                                                     lower(1), upper(2)], [2, 4]))
    else
      call share_in_space(contactors, c, (lower + upper)/2, (upper - lower)/2, room, share)
    end if
  end subroutine share_in_box

  !> Area of a shape within a rectangle [m2].
  pure real(wp) function share_in_plane(contactors, c, corners) result(area)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: corners(2, 4)
    real(wp), parameter :: here(2) = 0
    integer :: row, first, last

    row = contactors%row(c)
    area = 0
    select case (contactors%kind(c))
    case (kind_disk)
      area = overlap_disk_polygon(contactors%centre(:, c), contactors%disk_radius(row), 4, corners, here)
    case (kind_polygon)
      first = contactors%polygon_first(row)
      last = contactors%polygon_first(row + 1) - 1
      area = overlap_polygon_polygon(last - first + 1, contactors%polygon_world(:, first:last), 4, corners, here)
    case (kind_segment)
      area = overlap_polygon_segment(4, corners, contactors%centre(:, c), contactors%segment_axis(:, row), &
                                     contactors%segment_size(1, row), contactors%segment_size(2, row))
    end select
  end function share_in_plane

  !> Volume of a shape within a box [m3].
  pure subroutine share_in_space(contactors, c, centre, half, room, volume)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: centre(3), half(3)
    type(overlap_room_t), intent(inout) :: room
    real(wp), intent(out) :: volume
    integer :: row

    row = contactors%row(c)
    volume = 0
    associate (space => contactors%space)
      select case (contactors%kind(c))
      case (kind_sphere)
        volume = overlap_sphere_plane(contactors%centre(:, c), space%sphere_radius(row), centre, upright, half)
      case (kind_cylinder)
        volume = overlap_cylinder_plane(contactors%centre(:, c), space%cylinder_world(:, row), space%cylinder_size(1, row), &
                                        space%cylinder_size(2, row), centre, upright, half)
      case (kind_polyhedron)
        call measure_polyhedron_plane(space%polyhedra(row), centre, upright, half, direction_to(contactors%centre(:, c), centre), &
                                      room, volume)
      end select
    end associate
  end subroutine share_in_space

  !> Upright axis along which a place is farthest from the middle of a box, away from it: there the box ends first.
  pure function direction_to(place, centre) result(direction)
    real(wp), intent(in) :: place(3), centre(3)
    real(wp) :: direction(3)
    integer :: axis

    axis = maxloc(abs(place - centre), 1)
    direction = 0
    direction(axis) = sign(1.0_wp, place(axis) - centre(axis))
  end function direction_to
end module sg_share_in_box
