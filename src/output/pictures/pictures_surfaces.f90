!> What shapes in space look like: polygons with their corners counter-clockwise seen from outside.
!!
!! A sphere is one point with its radius: a glyph draws it rounder than any polygons, and it costs 24 bytes a picture
!! rather than some kilobytes. Only what has no such glyph is made of polygons.
module sg_pictures_surfaces
  use sg_contactors, only: contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, kind_sphere
  use sg_kinds, only: wp, pi
  use sg_pictures_grid, only: vtk_polygon, vtk_vertex
  use sg_pictures_mesh, only: add_cell, add_point, mesh_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: trace_surfaces

  !> Sides of a capsule about its axis and rings of each of its ends; in scenes of more than `many_cylinders` half as many
  integer, parameter :: cylinder_sides = 24, cap_rings = 6, many_cylinders = 1000
  !> Sides of a hollow cylinder, which is large
  integer, parameter :: hollow_sides = 96
  !> Faces of a box whose corners 1 to 4 go round its lower side, 5 to 8 round its upper side
  integer, parameter :: box_face(4, 6) = reshape([1, 4, 3, 2, 5, 6, 7, 8, 1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8], [4, 6])

contains

  !> Trace the surfaces of contactors in their bodies' frames.
  subroutine trace_surfaces(contactors, n_of_kind, is_traced, mesh)
    type(contactors_t), intent(in) :: contactors !! shapes of a scene in space
    integer, intent(in) :: n_of_kind(:) !! shapes of each kind in the whole scene
    logical, intent(in) :: is_traced(:) !! which of them are to be traced
    type(mesh_t), intent(out) :: mesh !! one cell a face; a sphere is one cell
    integer :: c, fineness

    mesh%dimension = 3
    fineness = merge(1, 2, n_of_kind(kind_cylinder) <= many_cylinders)
    do c = 1, contactors%n
      if (.not. is_traced(c)) cycle
      associate (row => contactors%row(c), space => contactors%space)
        select case (contactors%kind(c))
        case (kind_sphere)
          call add_point(mesh, c, contactors%shift(:, c), space%sphere_radius(row))
          call add_cell(mesh, c, vtk_vertex, mesh%n_points - 1, [1])
        case (kind_plane)
          call add_box(mesh, c, contactors%shift(:, c), space%plane_half(:, row), reshape(space%plane_frame(:, row), [3, 3]))
        case (kind_cylinder)
          call add_capsule(mesh, c, contactors%shift(:, c), space%cylinder_size(:, row), space%cylinder_axis(:, row), &
                           cylinder_sides/fineness, cap_rings/fineness)
        case (kind_hollow_cylinder)
          call add_tube(mesh, c, contactors%shift(:, c), space%hollow_size(:, row), space%hollow_axis(:, row))
        case (kind_polyhedron)
          call add_faces(mesh, c, contactors)
        end select
      end associate
    end do
  end subroutine trace_surfaces

  !> A polyhedron, face by face.
  subroutine add_faces(mesh, c, contactors)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: c
    type(contactors_t), intent(in) :: contactors
    integer :: i, base

    base = mesh%n_points
    associate (shape => contactors%space%polyhedra(contactors%row(c)))
      do i = 1, shape%n_vertices
        call add_point(mesh, c, contactors%shift(:, c) + shape%vertex(:, i))
      end do
      do i = 1, shape%n_faces
        call add_cell(mesh, c, vtk_polygon, base, int(shape%face_vertex(shape%face_first(i):shape%face_first(i + 1) - 1)))
      end do
    end associate
  end subroutine add_faces

  !> The box of a plane.
  subroutine add_box(mesh, c, centre, half, frame)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: c
    real(wp), intent(in) :: centre(3), half(3), frame(3, 3)
    integer, parameter :: sign_of(3, 8) = reshape([-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, &
                                                   -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
    integer :: i, base

    base = mesh%n_points
    do i = 1, 8
      call add_point(mesh, c, centre + matmul(frame, real(sign_of(:, i), wp)*half))
    end do
    do i = 1, 6
      call add_cell(mesh, c, vtk_polygon, base, box_face(:, i))
    end do
  end subroutine add_box

  !> A cylinder with round ends: rings about its axis from the lower pole to the upper one.
  subroutine add_capsule(mesh, c, centre, size, axis, sides, rings)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: c, sides, rings
    real(wp), intent(in) :: centre(3), size(2), axis(3)
    real(wp) :: latitude
    integer :: i, j, next, base, top

    base = mesh%n_points
    call add_point(mesh, c, centre - (size(1) + size(2))*axis)
    do i = 1, 2*rings
      ! The equator is there twice, at either end of the cylinder.
      latitude = pi/2*real(merge(i - rings, i - rings - 1, i <= rings), wp)/real(rings, wp)
      call add_ring(mesh, c, centre + (sign(size(1), real(i - rings, wp) - 0.5_wp) + size(2)*sin(latitude))*axis, &
                    size(2)*cos(latitude), axis, sides)
    end do
    call add_point(mesh, c, centre + (size(1) + size(2))*axis)
    top = mesh%n_points - base
    do j = 1, sides
      next = 1 + mod(j, sides)
      call add_cell(mesh, c, vtk_polygon, base, [1, 1 + next, 1 + j])
      do i = 0, 2*rings - 2
        call add_cell(mesh, c, vtk_polygon, base, 1 + i*sides + [j, next, sides + next, sides + j])
      end do
      call add_cell(mesh, c, vtk_polygon, base, [top - sides - 1 + j, top - sides - 1 + next, top])
    end do
  end subroutine add_capsule

  !> A hollow cylinder, open at its ends; its outside is where grains are.
  subroutine add_tube(mesh, c, centre, size, axis)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: c
    real(wp), intent(in) :: centre(3), size(2), axis(3)
    integer :: j, next, base

    base = mesh%n_points
    call add_ring(mesh, c, centre - size(1)*axis, size(2), axis, hollow_sides)
    call add_ring(mesh, c, centre + size(1)*axis, size(2), axis, hollow_sides)
    do j = 1, hollow_sides
      next = 1 + mod(j, hollow_sides)
      call add_cell(mesh, c, vtk_polygon, base, [next, j, hollow_sides + j, hollow_sides + next])
    end do
  end subroutine add_tube

  !> Points of a circle, counter-clockwise about its axis.
  subroutine add_ring(mesh, c, centre, radius, axis, sides)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: c, sides
    real(wp), intent(in) :: centre(3), radius, axis(3)
    real(wp) :: u(3), v(3), angle
    integer :: j

    ! The world's axis that is farthest from this one.
    u = 0
    u(minloc(abs(axis), 1)) = 1
    u = cross(axis, u)
    u = u/norm2(u)
    v = cross(axis, u)
    do j = 1, sides
      angle = 2*pi*real(j - 1, wp)/real(sides, wp)
      call add_point(mesh, c, centre + radius*(cos(angle)*u + sin(angle)*v))
    end do
  end subroutine add_ring
end module sg_pictures_surfaces
