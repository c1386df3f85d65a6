!> What shapes look like: points in the frames of their bodies, and cells that never change.
module sg_pictures_mesh
  use sg_kinds, only: wp, i4, i8
  use sg_lists, only: reserve
  implicit none
  private
  public :: mesh_t, add_point, add_cell

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
  contains
    procedure :: offsets
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

  !> Where each cell begins in the list of corners, from 0, and at last their number, shape (n_cells + 1).
  pure function offsets(self)
    class(mesh_t), intent(in) :: self
    integer(i8) :: offsets(self%n_cells + 1)
    integer :: c

    offsets(1) = 0
    do c = 1, self%n_cells
      offsets(c + 1) = offsets(c) + int(self%size_of_cell(c), i8)
    end do
  end function offsets
end module sg_pictures_mesh
