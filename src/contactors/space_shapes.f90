!> Tables of the shapes in space, one per kind, and how they follow their bodies.
!!
!! A kind that a scene does not hold has no table.
module sg_space_shapes
  use sg_field_visitor, only: field_t, field_visitor_t, sync_never, sync_on_copy
  use sg_fields, only: fields_t
  use sg_kinds, only: wp, i4
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_rotations, only: frame_of, turned_by
  use sg_shape_kinds, only: kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, kind_sphere
  implicit none
  private
  public :: space_shapes_t, place_in_space

  !> Shapes in space
  type, extends(fields_t) :: space_shapes_t
    !> Spheres: radius [m]
    real(wp), allocatable :: sphere_radius(:)
    !> Planes: half axes of the box [m], shape (3, row); grains are meant to touch the face at +half(3)
    real(wp), allocatable :: plane_half(:, :)
    !> Planes: zero for a box; else what is touched is a rectangle of half axes half(1:2) with this radius all around it, a plate
    !! with a rounded rim (LMGC90's PLANx) [m], shape (row)
    real(wp), allocatable :: plane_rim(:)
    !> Planes: axes of the box as columns in the body's frame, and in the detection configuration, shape (9, row)
    real(wp), allocatable :: plane_frame(:, :), plane_world(:, :)
    !> Cylinders (capsules): half height of the axis, radius [m], shape (2, row)
    real(wp), allocatable :: cylinder_size(:, :)
    !> Cylinders: unit vector of the axis in the body's frame, and in the detection configuration, shape (3, row)
    real(wp), allocatable :: cylinder_axis(:, :), cylinder_world(:, :)
    !> Hollow cylinders: half height, inner radius [m], shape (2, row), and axes as above
    real(wp), allocatable :: hollow_size(:, :), hollow_axis(:, :), hollow_world(:, :)
    !> Convex polyhedra
    type(polyhedron_t), allocatable :: polyhedra(:)
    !> Convex polyhedra: path length so far (sg_path_bound) [m], shape (row)
    real(wp), allocatable :: polyhedron_path(:)
  contains
    procedure :: visit => space_shapes_visit
  end type space_shapes_t

contains

  !> The list of fields, one table per kind. A field of a shape is a line here, and its declaration above.
  subroutine space_shapes_visit(self, visitor)
    class(space_shapes_t) :: self
    type(field_visitor_t), intent(inout) :: visitor !! what the visit does

    select case (visitor%table)
    case (kind_sphere)
      call visitor%visit(field_t('sphere_radius', sync_on_copy), self%sphere_radius)
    case (kind_plane)
      call visitor%visit(field_t('plane_half', sync_on_copy, 3), self%plane_half)
      call visitor%visit(field_t('plane_rim', sync_on_copy), self%plane_rim)
      call visitor%visit(field_t('plane_frame', sync_on_copy, 9), self%plane_frame)
      call visitor%visit(field_t('plane_world', sync_never, 9), self%plane_world)
    case (kind_cylinder)
      call visitor%visit(field_t('cylinder_size', sync_on_copy, 2), self%cylinder_size)
      call visitor%visit(field_t('cylinder_axis', sync_on_copy, 3), self%cylinder_axis)
      call visitor%visit(field_t('cylinder_world', sync_never, 3), self%cylinder_world)
    case (kind_hollow_cylinder)
      call visitor%visit(field_t('hollow_size', sync_on_copy, 2), self%hollow_size)
      call visitor%visit(field_t('hollow_axis', sync_on_copy, 3), self%hollow_axis)
      call visitor%visit(field_t('hollow_world', sync_never, 3), self%hollow_world)
    case (kind_polyhedron)
      call visitor%visit(field_t('polyhedron_path', sync_never), self%polyhedron_path)
    end select
  end subroutine space_shapes_visit

  !> Put contactors where their bodies are.
  pure subroutine place_in_space(first, last, kind, body, row, shift, middle, centre, space)
    integer, intent(in) :: first !! first contactor of the run
    integer, intent(in) :: last !! its last contactor
    integer(i4), intent(in) :: kind(:) !! kind of shape
    integer(i4), intent(in) :: body(:) !! body of each
    integer(i4), intent(in) :: row(:) !! row in the table of its kind
    real(wp), intent(in) :: shift(:, :) !! centre in the body's frame [m], shape (3, contactors)
    real(wp), intent(in), contiguous :: middle(:, :) !! bodies' configuration [m, quaternion], shape (3 or 7, bodies)
    real(wp), intent(inout) :: centre(:, :) !! centre in the world [m], shape (3, contactors)
    type(space_shapes_t), intent(inout) :: space !! shapes; their world coordinates are set
    real(wp) :: q(4), frame(3, 3), local(3, 3)
    integer :: c

    q = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    do c = first, last
      centre(:, c) = middle(1:3, body(c))
      if (size(middle, 1) == 7) q = middle(4:7, body(c))
      if (any(abs(shift(:, c)) > 0)) centre(:, c) = centre(:, c) + turned_by(q, shift(:, c))
      select case (kind(c))
      case (kind_plane)
        frame = frame_of(q)
        local = reshape(space%plane_frame(:, row(c)), [3, 3])
        space%plane_world(:, row(c)) = reshape(matmul(frame, local), [9])
      case (kind_cylinder)
        space%cylinder_world(:, row(c)) = turned_by(q, space%cylinder_axis(:, row(c)))
      case (kind_hollow_cylinder)
        space%hollow_world(:, row(c)) = turned_by(q, space%hollow_axis(:, row(c)))
      case (kind_polyhedron)
        call place_polyhedron(space%polyhedra(row(c)), centre(:, c), frame_of(q), space%polyhedron_path(row(c)))
      end select
    end do
  end subroutine place_in_space
end module sg_space_shapes
