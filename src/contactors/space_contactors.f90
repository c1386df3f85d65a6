!> Adding shapes in space to the contactors of a scene.
module sg_space_contactors
  use sg_contactors, only: add_contactor, contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, &
                           kind_sphere
  use sg_kinds, only: wp
  use sg_polyhedron, only: polyhedron_t
  implicit none
  private
  public :: add_sphere, add_plane, add_cylinder, add_hollow_cylinder, add_polyhedron

contains

  !> Add a sphere; with a shift from the body's centre it is a shifted sphere (SPHEb).
  subroutine add_sphere(contactors, body, colour, radius, shift)
    type(contactors_t), intent(inout) :: contactors !! list to add to, of dimension 3
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: radius !! [m]
    real(wp), intent(in) :: shift(3) !! centre in the body's frame [m]
    integer :: row

    call add_contactor(contactors, kind_sphere, body, colour, shift, radius, row)
    contactors%space%sphere_radius(row) = radius
  end subroutine add_sphere

  !> Add a plane: a thin box, or a rectangle with a rounded rim, whose face at +half(3) along its third axis is meant to be
  !! touched.
  subroutine add_plane(contactors, body, colour, half, shift, frame, has_rim)
    type(contactors_t), intent(inout) :: contactors !! list to add to, of dimension 3
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: half(3) !! half axes [m]
    real(wp), intent(in) :: shift(3) !! centre in the body's frame [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the body's frame
    logical, intent(in), optional :: has_rim !! is it a rectangle with a rounded rim of radius half(3)? A box unless given
    real(wp) :: rim
    integer :: row

    rim = 0
    if (present(has_rim)) rim = merge(half(3), 0.0_wp, has_rim)
    call add_contactor(contactors, kind_plane, body, colour, shift, max(norm2(half), norm2(half(:2)) + rim), row)
    contactors%space%plane_rim(row) = rim
    contactors%space%plane_half(:, row) = half
    contactors%space%plane_frame(:, row) = reshape(frame, [9])
  end subroutine add_plane

  !> Add a cylinder with round caps (capsule): the points within `radius` of an axis of length 2 `half_height`.
  subroutine add_cylinder(contactors, body, colour, half_height, radius, shift, axis)
    type(contactors_t), intent(inout) :: contactors !! list to add to, of dimension 3
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: half_height !! half length of the axis [m]
    real(wp), intent(in) :: radius !! [m]
    real(wp), intent(in) :: shift(3) !! centre in the body's frame [m]
    real(wp), intent(in) :: axis(3) !! unit vector of the axis in the body's frame
    integer :: row

    call add_contactor(contactors, kind_cylinder, body, colour, shift, half_height + radius, row)
    contactors%space%cylinder_size(:, row) = [half_height, radius]
    contactors%space%cylinder_axis(:, row) = axis
  end subroutine add_cylinder

  !> Add a hollow cylinder: grains touch it from inside; its ends are open.
  subroutine add_hollow_cylinder(contactors, body, colour, half_height, radius, shift, axis)
    type(contactors_t), intent(inout) :: contactors !! list to add to, of dimension 3
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: half_height !! half height [m]
    real(wp), intent(in) :: radius !! inner radius [m]
    real(wp), intent(in) :: shift(3) !! centre in the body's frame [m]
    real(wp), intent(in) :: axis(3) !! unit vector of the axis in the body's frame
    integer :: row

    call add_contactor(contactors, kind_hollow_cylinder, body, colour, shift, norm2([half_height, radius]), row)
    contactors%space%hollow_size(:, row) = [half_height, radius]
    contactors%space%hollow_axis(:, row) = axis
  end subroutine add_hollow_cylinder

  !> Add a convex polyhedron whose vertices are given about the contactor's centre, in the body's frame.
  subroutine add_polyhedron(contactors, body, colour, shape, shift)
    type(contactors_t), intent(inout) :: contactors !! list to add to, of dimension 3
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    type(polyhedron_t), intent(in) :: shape !! the polyhedron
    real(wp), intent(in) :: shift(3) !! contactor's centre in the body's frame [m]
    type(polyhedron_t), allocatable :: grown(:)
    real(wp) :: reach
    integer :: row, i, room

    reach = sqrt(maxval(sum(shape%vertex**2, 1)))
    call add_contactor(contactors, kind_polyhedron, body, colour, shift, reach, row)
    associate (space => contactors%space)
      room = 0
      if (allocated(space%polyhedra)) room = size(space%polyhedra)
      if (room < row) then
        allocate (grown(max(4, 2*room)))
        do i = 1, row - 1
          call move_polyhedron(space%polyhedra(i), grown(i))
        end do
        call move_alloc(grown, space%polyhedra)
      end if
      space%polyhedra(row) = shape
      space%polyhedra(row)%reach = reach
    end associate
  end subroutine add_polyhedron

  !> Move a polyhedron without copying its tables.
  subroutine move_polyhedron(from, to)
    type(polyhedron_t), intent(inout) :: from, to

    to%n_vertices = from%n_vertices
    to%n_faces = from%n_faces
    to%n_edges = from%n_edges
    to%centre = from%centre
    to%reach = from%reach
    call move_alloc(from%vertex, to%vertex)
    call move_alloc(from%face_first, to%face_first)
    call move_alloc(from%face_vertex, to%face_vertex)
    call move_alloc(from%normal, to%normal)
    call move_alloc(from%edge, to%edge)
    call move_alloc(from%world_vertex, to%world_vertex)
    call move_alloc(from%world_normal, to%world_normal)
    call move_alloc(from%face_height, to%face_height)
  end subroutine move_polyhedron
end module sg_space_contactors
