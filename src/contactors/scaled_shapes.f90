!> Copies of the shapes of a body at another size, for many grains of one template.
module sg_scaled_shapes
  use sg_contactors, only: add_disk, add_polygon, add_segment, contactors_t, kind_cylinder, kind_disk, kind_polygon, &
                           kind_polyhedron, kind_segment, kind_sphere
  use sg_kinds, only: wp
  use sg_polyhedron, only: polyhedron_t
  use sg_space_contactors, only: add_cylinder, add_polyhedron, add_sphere
  implicit none
  private
  public :: add_scaled_shapes

contains

  !> Add all shapes of a template to a body, in the frame of the body, each length times a factor.
  subroutine add_scaled_shapes(contactors, body, template, factor)
    type(contactors_t), intent(inout) :: contactors !! list to add to
    integer, intent(in) :: body !! body that carries the shapes
    type(contactors_t), intent(in) :: template !! shapes to copy; none is hollow, a plane or a point
    real(wp), intent(in) :: factor !! length over that in the template
    integer :: c

    do c = 1, template%n
      if (contactors%dimension == 2) then
        call add_plane_shape(contactors, body, template, c, factor)
      else
        call add_space_shape(contactors, body, template, c, factor)
      end if
    end do
  end subroutine add_scaled_shapes

  !> Add one shape in the plane.
  subroutine add_plane_shape(contactors, body, template, c, factor)
    type(contactors_t), intent(inout) :: contactors
    integer, intent(in) :: body, c
    type(contactors_t), intent(in) :: template
    real(wp), intent(in) :: factor
    real(wp) :: shift(2)
    integer :: colour

    shift = factor*template%shift(:, c)
    colour = template%colour(c)
    associate (row => template%row(c))
      select case (template%kind(c))
      case (kind_disk)
        call add_disk(contactors, body, colour, factor*template%disk_radius(row), shift)
      case (kind_segment)
        call add_segment(contactors, body, colour, factor*template%segment_size(1, row), factor*template%segment_size(2, row), &
                         shift, template%segment_size(3, row))
      case (kind_polygon)
        associate (first => template%polygon_first(row), last => template%polygon_first(row + 1) - 1)
          call add_polygon(contactors, body, colour, factor*template%polygon_vertex(:, first:last), shift)
        end associate
      end select
    end associate
  end subroutine add_plane_shape

  !> Add one shape in space.
  subroutine add_space_shape(contactors, body, template, c, factor)
    type(contactors_t), intent(inout) :: contactors
    integer, intent(in) :: body, c
    type(contactors_t), intent(in) :: template
    real(wp), intent(in) :: factor
    type(polyhedron_t) :: shape
    real(wp) :: shift(3)
    integer :: colour

    shift = factor*template%shift(:, c)
    colour = template%colour(c)
    associate (row => template%row(c), space => template%space)
      select case (template%kind(c))
      case (kind_sphere)
        call add_sphere(contactors, body, colour, factor*space%sphere_radius(row), shift)
      case (kind_cylinder)
        call add_cylinder(contactors, body, colour, factor*space%cylinder_size(1, row), factor*space%cylinder_size(2, row), &
                          shift, space%cylinder_axis(:, row))
      case (kind_polyhedron)
        shape = space%polyhedra(row)
        shape%vertex = factor*shape%vertex
        call add_polyhedron(contactors, body, colour, shape, shift)
      end select
    end associate
  end subroutine add_space_shape
end module sg_scaled_shapes
