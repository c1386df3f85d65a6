!> Convex polyhedra: vertices, polygonal faces, edges; in the body's frame and placed in the world.
module sg_polyhedron
  use sg_kinds, only: wp, i4
  use sg_path_bound, only: longer_path
  implicit none
  private
  public :: polyhedron_t, place_polyhedron

  !> One convex polyhedron
  type :: polyhedron_t
    !> Numbers of vertices, faces (coplanar triangles are one face) and edges
    integer :: n_vertices = 0, n_faces = 0, n_edges = 0
    !> Vertices about the contactor's centre in the body's frame [m], shape (3, n_vertices)
    real(wp), allocatable :: vertex(:, :)
    !> Vertices of face f, counter-clockwise seen from outside: `face_vertex(face_first(f):face_first(f + 1) - 1)`
    integer(i4), allocatable :: face_first(:), face_vertex(:)
    !> Outward unit normals in the body's frame, shape (3, n_faces)
    real(wp), allocatable :: normal(:, :)
    !> Edges, shape (4, n_edges): its two vertices, the face that runs along it from first to second, and the other face
    integer(i4), allocatable :: edge(:, :)
    !> Height of each face's plane above the contactor's centre [m], shape (n_faces)
    real(wp), allocatable :: face_height(:)
    !> The same vertices and normals in the detection configuration
    real(wp), allocatable :: world_vertex(:, :), world_normal(:, :)
    !> Centre in the detection configuration [m], and radius about it that holds the shape
    real(wp) :: centre(3) = 0, reach = 0
  end type polyhedron_t

contains

  !> Put a polyhedron into the world.
  pure subroutine place_polyhedron(shape, centre, frame, path)
    type(polyhedron_t), intent(inout) :: shape !! polyhedron; its world coordinates are set
    real(wp), intent(in) :: centre(3) !! of the contactor [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the body's frame in the world
    real(wp), intent(inout), optional :: path !! bound of its path length so far, see `longer_path` [m]
    real(wp) :: place(3), moved, square
    integer :: i

    square = 0
    if (.not. allocated(shape%world_vertex)) then
      allocate (shape%world_vertex(3, shape%n_vertices), shape%world_normal(3, shape%n_faces), shape%face_height(shape%n_faces))
      shape%world_vertex = spread(centre, 2, shape%n_vertices)
      do i = 1, shape%n_faces
        shape%face_height(i) = dot_product(shape%normal(:, i), shape%vertex(:, shape%face_vertex(shape%face_first(i))))
      end do
    end if
    shape%centre = centre
    do i = 1, shape%n_vertices
      place = centre + frame(:, 1)*shape%vertex(1, i) + frame(:, 2)*shape%vertex(2, i) + frame(:, 3)*shape%vertex(3, i)
      moved = (place(1) - shape%world_vertex(1, i))**2 + (place(2) - shape%world_vertex(2, i))**2 &
              + (place(3) - shape%world_vertex(3, i))**2
      square = max(square, moved)
      shape%world_vertex(:, i) = place
    end do
    if (present(path)) path = longer_path(path, square)
    do i = 1, shape%n_faces
      shape%world_normal(:, i) = frame(:, 1)*shape%normal(1, i) + frame(:, 2)*shape%normal(2, i) + frame(:, 3)*shape%normal(3, i)
    end do
  end subroutine place_polyhedron
end module sg_polyhedron
