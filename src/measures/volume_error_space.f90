!> The volume by which shapes that touch overlap in space: over the volume of the grains it is the volume error.
module sg_volume_error_space
  use sg_contactors, only: contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, kind_sphere
  use sg_contacts, only: contacts_t, image_of, is_own_image
  use sg_kinds, only: wp
  use sg_overlap_capsules, only: overlap_cylinder_cylinder
  use sg_overlap_cylinders, only: overlap_cylinder_plane
  use sg_overlap_polyhedra, only: measure_polyhedra, measure_polyhedron_plane, overlap_room_t, overlap_sphere_polyhedron
  use sg_overlap_spheres, only: overlap_sphere_cylinder, overlap_sphere_hollow_cylinder, overlap_sphere_plane, overlap_sphere_sphere
  use sg_scene, only: image_shift, scene_t
  use sg_touch_space_pair, only: facing_half, plane_axes
  implicit none
  private
  public :: overlap_volume

contains

  !> Sum of the overlaps of all pairs of shapes with a negative gap [m3], each pair once: its points follow one another.
  !!
  !! Cylinders within hollow cylinders have no formula and count as nothing.
  pure real(wp) function overlap_volume(contactors, contacts, scene, is_counted) result(volume)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(scene_t), intent(in) :: scene !! scene with its periods
    !> Pairs count whose first point with a negative gap does; all unless given
    logical, allocatable, intent(in), optional :: is_counted(:)
    type(overlap_room_t) :: room
    real(wp) :: overlap
    integer :: k, last(5), this(5)
    logical :: are_spheres

    volume = 0
    last = 0
    do k = 1, contacts%n
      if (.not. contacts%gap(k) < 0) cycle
      are_spheres = contactors%kind(contacts%contactor(1, k)) == kind_sphere &
                    .and. contactors%kind(contacts%contactor(2, k)) == kind_sphere .and. is_own_image(contacts, k)
      if (.not. are_spheres) then
        this = [int(contacts%contactor(:, k)), image_of(contacts, k)]
        if (all(this == last)) cycle
        last = this
      end if
      if (present(is_counted)) then
        if (.not. is_counted(k)) cycle
      end if
      if (are_spheres) then
        overlap = spheres_overlap(contactors, contacts%contactor(1, k), contacts%contactor(2, k))
      else
        call measure_pair(contactors, this(1), this(2), image_shift(scene, this(3:)), [scene%period, scene%period_y], &
                          contacts%normal(1:3, k), room, overlap)
      end if
      volume = volume + overlap
    end do
  end function overlap_volume

  !> Overlap of two spheres [m3], both where they are: nearly all contacts of many scenes, each of a pair of its own.
  pure real(wp) function spheres_overlap(contactors, c, a) result(volume)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, a

    associate (centre => contactors%centre, radius => contactors%space%sphere_radius)
      volume = overlap_sphere_sphere([centre(1, c), centre(2, c), centre(3, c)], radius(contactors%row(c)), &
                                     [centre(1, a), centre(2, a), centre(3, a)], radius(contactors%row(a)))
    end associate
  end function spheres_overlap

  !> Overlap of one pair of shapes [m3]: the kernel of its two kinds.
  pure subroutine measure_pair(contactors, c, a, offset, period, normal, room, volume)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, a
    real(wp), intent(in) :: offset(3), period(2), normal(3)
    type(overlap_room_t), intent(inout) :: room
    real(wp), intent(out) :: volume
    real(wp) :: centre(3)
    integer :: own, row

    volume = 0
    own = contactors%row(c)
    row = contactors%row(a)
    centre = contactors%centre(:, a) + offset
    associate (space => contactors%space)
      select case (contactors%kind(c))
      case (kind_sphere)
        volume = sphere_overlap(contactors, c, a, offset, period)
      case (kind_cylinder)
        if (contactors%kind(a) == kind_plane) then
          volume = overlap_cylinder_plane(contactors%centre(:, c), space%cylinder_world(:, own), space%cylinder_size(1, own), &
                                          space%cylinder_size(2, own), centre, plane_axes(contactors, row), &
                                          facing_half(contactors, row, period))
        else if (contactors%kind(a) == kind_cylinder) then
          volume = overlap_cylinder_cylinder(contactors%centre(:, c), space%cylinder_world(:, own), space%cylinder_size(1, own), &
                                             space%cylinder_size(2, own), centre, space%cylinder_world(:, row), &
                                             space%cylinder_size(1, row), space%cylinder_size(2, row))
        end if
      case (kind_polyhedron)
        if (contactors%kind(a) == kind_polyhedron) then
          call measure_polyhedra(space%polyhedra(own), space%polyhedra(row), offset, normal, room, volume)
        else if (contactors%kind(a) == kind_plane) then
          call measure_polyhedron_plane(space%polyhedra(own), centre, plane_axes(contactors, row), &
                                        facing_half(contactors, row, period), normal, room, volume)
        end if
      end select
    end associate
  end subroutine measure_pair

  !> Overlap of a sphere with its antagonist [m3].
  pure real(wp) function sphere_overlap(contactors, c, a, offset, period) result(volume)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, a
    real(wp), intent(in) :: offset(3), period(2)
    real(wp) :: own(3), centre(3), radius
    integer :: row

    volume = 0
    own = contactors%centre(:, c)
    centre = contactors%centre(:, a) + offset
    radius = contactors%space%sphere_radius(contactors%row(c))
    row = contactors%row(a)
    associate (space => contactors%space)
      select case (contactors%kind(a))
      case (kind_sphere)
        volume = overlap_sphere_sphere(own, radius, centre, space%sphere_radius(row))
      case (kind_plane)
        volume = overlap_sphere_plane(own, radius, centre, plane_axes(contactors, row), facing_half(contactors, row, period))
      case (kind_cylinder)
        volume = overlap_sphere_cylinder(own, radius, centre, space%cylinder_world(:, row), space%cylinder_size(1, row), &
                                         space%cylinder_size(2, row))
      case (kind_hollow_cylinder)
        volume = overlap_sphere_hollow_cylinder(own, radius, centre, space%hollow_world(:, row), space%hollow_size(1, row), &
                                                space%hollow_size(2, row))
      case (kind_polyhedron)
        volume = overlap_sphere_polyhedron(own, radius, space%polyhedra(row), offset)
      end select
    end associate
  end function sphere_overlap
end module sg_volume_error_space
