!> What shapes look like: points in the frames of their bodies, and cells that never change.
module sg_pictures_mesh
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_pictures_grid, only: vtk_poly_line, vtk_vertex
  implicit none
  private
  public :: mesh_t, add_point, add_cell, xdmf_topology

  !> Codes of XDMF for cells of any number of points
  integer(i4), parameter :: xdmf_poly_vertex = 1, xdmf_poly_line = 2, xdmf_polygon = 3

  !> Points and cells of all shapes, contactor by contactor
  type :: mesh_t
    !> Dimension of space
    integer :: dimension = 2
    !> Numbers of points, cells, and corners of all cells
    integer :: n_points = 0, n_cells = 0, n_corners = 0
    !> Points in the frames of their bodies [m], shape (dimension, n_points)
    real(wp), allocatable :: point(:, :)
    !> Contactor of each point and of each cell, shapes (n_points), (n_cells)
    integer(i4), allocatable :: shape_of_point(:), shape_of_cell(:)
    !> Radius where the point stands for a sphere about it, else zero [m], shape (n_points)
    real(wp), allocatable :: radius(:)
    !> Points of the cells, from 0, shape (n_corners)
    integer(i4), allocatable :: corner(:)
    !> Number of points of each cell, and its type in VTK's words, shape (n_cells)
    integer(i4), allocatable :: size_of_cell(:), type_of_cell(:)
  end type mesh_t

contains

  !> Add a point of a contactor.
  subroutine add_point(mesh, contactor, point, radius)
    type(mesh_t), intent(inout) :: mesh !! mesh to add to
    integer, intent(in) :: contactor !! whose shape it is of
    real(wp), intent(in) :: point(:) !! in the body's frame [m], shape (dimension)
    real(wp), intent(in), optional :: radius !! of the sphere for which the point stands [m]; 0 when absent
    integer :: n

    n = mesh%n_points + 1
    mesh%n_points = n
    call reserve(mesh%point, mesh%dimension, n)
    call reserve(mesh%shape_of_point, n)
    call reserve(mesh%radius, n)
    mesh%point(:, n) = point
    mesh%shape_of_point(n) = contactor
    mesh%radius(n) = 0
    if (present(radius)) mesh%radius(n) = radius
  end subroutine add_point

  !> Add a cell of a contactor.
  subroutine add_cell(mesh, contactor, type_of_cell, base, corners)
    type(mesh_t), intent(inout) :: mesh !! mesh to add to
    integer, intent(in) :: contactor !! whose shape it is of
    integer(i4), intent(in) :: type_of_cell !! one of `vtk_*`
    integer, intent(in) :: base !! points before those of this shape
    integer, intent(in) :: corners(:) !! points of the cell among those of this shape, from 1
    integer :: n, last

    n = mesh%n_cells + 1
    mesh%n_cells = n
    last = mesh%n_corners + size(corners)
    call reserve(mesh%shape_of_cell, n)
    call reserve(mesh%size_of_cell, n)
    call reserve(mesh%type_of_cell, n)
    call reserve(mesh%corner, last)
    mesh%shape_of_cell(n) = contactor
    mesh%size_of_cell(n) = size(corners)
    mesh%type_of_cell(n) = type_of_cell
    mesh%corner(mesh%n_corners + 1:last) = int(base + corners - 1, i4)
    mesh%n_corners = last
  end subroutine add_cell

  !> The cells as XDMF takes them: of each its code, the number of its points, and its points from 0.
  pure function xdmf_topology(mesh) result(topology)
    type(mesh_t), intent(in) :: mesh !! points and cells
    integer(i4), allocatable :: topology(:)
    integer(i4) :: code
    integer :: c, first, last, n

    allocate (topology(mesh%n_corners + 2*mesh%n_cells))
    last = 0
    do c = 1, mesh%n_cells
      first = last + 1
      last = last + mesh%size_of_cell(c)
      n = first + 2*(c - 1)
      code = xdmf_polygon
      if (mesh%type_of_cell(c) == vtk_poly_line) code = xdmf_poly_line
      if (mesh%type_of_cell(c) == vtk_vertex) code = xdmf_poly_vertex
      topology(n:n + 1) = [code, mesh%size_of_cell(c)]
      topology(n + 2:n + 1 + mesh%size_of_cell(c)) = mesh%corner(first:last)
    end do
  end function xdmf_topology
end module sg_pictures_mesh
