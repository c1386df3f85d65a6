!> Narrow phase of one pair of contactors in space: the kernel of its two kinds.
module sg_touch_space_pair
  use sg_contactors, only: contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, kind_sphere
  use sg_kinds, only: wp, i4
  use sg_touch_cylinder_cylinder, only: touch_cylinder_cylinder
  use sg_touch_cylinder_hollow, only: touch_cylinder_hollow
  use sg_touch_cylinder_plane, only: touch_cylinder_plane
  use sg_touch_polyhedron_plane, only: touch_polyhedron_plane
  use sg_touch_polyhedron_polyhedron, only: touch_polyhedron_polyhedron
  use sg_touch_space, only: touch_space_t
  use sg_touch_sphere_cylinder, only: touch_sphere_cylinder
  use sg_touch_sphere_hollow_cylinder, only: touch_sphere_hollow_cylinder
  use sg_touch_sphere_plane, only: touch_sphere_plane
  use sg_touch_sphere_polyhedron, only: touch_sphere_polyhedron
  use sg_touch_sphere_sphere, only: touch_sphere_sphere
  implicit none
  private
  public :: touch_space_pair, plane_axes, facing_half

contains

  !> Narrow phase of one pair.
  pure subroutine touch_space_pair(contactors, c, a, offset, alert, period, touch, kept, clearance)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(3) !! shift of the antagonist [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    real(wp), intent(in) :: period(2) !! in x and y, makes a plane endless that spans it; zero where not periodic [m]
    type(touch_space_t), intent(out) :: touch !! points of contact
    integer(i4), intent(inout), optional :: kept(2) !! features of two polyhedra to try first, see `touch_polyhedron_polyhedron`
    real(wp), intent(inout), optional :: clearance !! set for two polyhedra: their distance or less [m]

    select case (contactors%kind(c))
    case (kind_sphere)
      call touch_sphere(contactors, c, a, offset, alert, period, touch)
    case (kind_cylinder)
      call touch_cylinder(contactors, c, a, offset, alert, period, touch)
    case (kind_polyhedron)
      associate (shape => contactors%space%polyhedra(contactors%row(c)), row => contactors%row(a))
        if (contactors%kind(a) == kind_polyhedron) then
          call touch_polyhedron_polyhedron(shape, contactors%space%polyhedra(row), offset, alert, touch, kept, clearance)
        else if (contactors%kind(a) == kind_plane) then
          call touch_polyhedron_plane(shape, contactors%centre(:, a) + offset, plane_axes(contactors, row), &
                                      facing_half(contactors, row, period), alert, touch)
        end if
      end associate
    end select
  end subroutine touch_space_pair

  !> A sphere with anything.
  pure subroutine touch_sphere(contactors, c, a, offset, alert, period, touch)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c, a
    real(wp), intent(in) :: offset(3), alert, period(2)
    type(touch_space_t), intent(out) :: touch
    real(wp) :: own(3), centre(3), radius

    own = contactors%centre(:, c)
    centre = contactors%centre(:, a) + offset
    radius = contactors%space%sphere_radius(contactors%row(c))
    associate (space => contactors%space, row => contactors%row(a))
      select case (contactors%kind(a))
      case (kind_sphere)
        call touch_sphere_sphere(own, radius, centre, space%sphere_radius(row), alert, touch)
      case (kind_plane)
        call touch_sphere_plane(own, radius, centre, plane_axes(contactors, row), facing_core(contactors, row, period), &
                                alert, touch, space%plane_rim(row))
      case (kind_cylinder)
        call touch_sphere_cylinder(own, radius, centre, space%cylinder_world(:, row), space%cylinder_size(1, row), &
                                   space%cylinder_size(2, row), alert, touch)
      case (kind_hollow_cylinder)
        call touch_sphere_hollow_cylinder(own, radius, centre, space%hollow_world(:, row), space%hollow_size(1, row), &
                                          space%hollow_size(2, row), alert, touch)
      case (kind_polyhedron)
        call touch_sphere_polyhedron(own, radius, space%polyhedra(row), offset, alert, touch)
      end select
    end associate
  end subroutine touch_sphere

  !> A cylinder with another or with a plane.
  pure subroutine touch_cylinder(contactors, c, a, offset, alert, period, touch)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c, a
    real(wp), intent(in) :: offset(3), alert, period(2)
    type(touch_space_t), intent(out) :: touch
    real(wp) :: centre(3)

    centre = contactors%centre(:, a) + offset
    associate (space => contactors%space, own => contactors%row(c), row => contactors%row(a))
      if (contactors%kind(a) == kind_cylinder) then
        call touch_cylinder_cylinder(contactors%centre(:, c), space%cylinder_world(:, own), space%cylinder_size(1, own), &
                                     space%cylinder_size(2, own), centre, space%cylinder_world(:, row), &
                                     space%cylinder_size(1, row), space%cylinder_size(2, row), alert, touch)
      else if (contactors%kind(a) == kind_hollow_cylinder) then
        call touch_cylinder_hollow(contactors%centre(:, c), space%cylinder_world(:, own), space%cylinder_size(1, own), &
                                   space%cylinder_size(2, own), centre, space%hollow_world(:, row), space%hollow_size(1, row), &
                                   space%hollow_size(2, row), alert, touch)
      else if (contactors%kind(a) == kind_plane) then
        call touch_cylinder_plane(contactors%centre(:, c), space%cylinder_world(:, own), space%cylinder_size(1, own), &
                                  space%cylinder_size(2, own), centre, plane_axes(contactors, row), &
                                  facing_core(contactors, row, period), alert, touch, space%plane_rim(row))
      end if
    end associate
  end subroutine touch_cylinder

  !> Axes of a plane in the world, as columns.
  pure function plane_axes(contactors, row) result(frame)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: row !! row in the table of planes
    real(wp) :: frame(3, 3)

    frame = reshape(contactors%space%plane_world(:, row), [3, 3])
  end function plane_axes

  !> Half axes of the box whose points within its rim spheres and cylinders meet: flat where there is a rim [m].
  pure function facing_core(contactors, row, period) result(half)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: row !! row in the table of planes
    real(wp), intent(in) :: period(2) !! in x and y, zero where not periodic [m]
    real(wp) :: half(3)

    half = facing_half(contactors, row, period)
    if (contactors%space%plane_rim(row) > 0) half(3) = 0
  end function facing_core

  !> Half axes of a plane as its antagonists meet it [m].
  !!
  !! A level plane that spans a period goes on in its own images: grains at its borders must not feel edges there.
  pure function facing_half(contactors, row, period) result(half)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: row !! row in the table of planes
    real(wp), intent(in) :: period(2) !! in x and y, zero where not periodic [m]
    real(wp) :: half(3)
    real(wp), parameter :: level = 1e-6_wp ! slope below which neighbouring images meet
    integer :: world, own

    half = contactors%space%plane_half(:, row)
    if (.not. any(period > 0)) return
    do world = 1, 2
      if (.not. period(world) > 0) cycle
      do own = 1, 2
        associate (axis => contactors%space%plane_world(3*own - 2:3*own, row))
          if (1 - abs(axis(world)) < level**2 .and. 2*half(own) >= period(world)) half(own) = half(own) + period(world)
        end associate
      end do
    end do
  end function facing_half
end module sg_touch_space_pair
