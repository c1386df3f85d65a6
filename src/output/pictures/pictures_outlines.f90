!> What shapes in the plane look like: the outline of every contactor as one polygon, hollow disks as closed lines.
module sg_pictures_outlines
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_polygon, kind_segment
  use sg_kinds, only: wp, pi
  use sg_pictures_grid, only: vtk_poly_line, vtk_polygon
  use sg_pictures_mesh, only: add_cell, add_point, mesh_t
  implicit none
  private
  public :: trace_outlines

  !> Sides of a disk; in scenes of more than `many_disks` half as many, to spare room
  integer, parameter :: disk_sides = 24, many_disks = 20000
  !> Sides of a hollow disk, which is large, and of each rounded end of a segment
  integer, parameter :: hollow_sides = 96, cap_sides = 8

contains

  !> Trace the outlines of contactors in their bodies' frames.
  subroutine trace_outlines(contactors, n_of_kind, is_traced, mesh)
    type(contactors_t), intent(in) :: contactors !! shapes of a plane scene
    integer, intent(in) :: n_of_kind(:) !! shapes of each kind in the whole scene
    logical, intent(in) :: is_traced(:) !! which of them are to be traced
    type(mesh_t), intent(out) :: mesh !! one cell a contactor
    integer :: c, sides

    sides = merge(disk_sides, disk_sides/2, n_of_kind(kind_disk) <= many_disks)
    do c = 1, contactors%n
      if (.not. is_traced(c)) cycle
      call add_outline(mesh, c, contactors%shift(:, c), outline_of(contactors, c, corners(contactors, c, sides)), &
                       contactors%kind(c) == kind_hollow)
    end do
  end subroutine trace_outlines

  !> An outline as one cell.
  subroutine add_outline(mesh, c, centre, outline, is_line)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: c
    real(wp), intent(in) :: centre(2), outline(:, :)
    logical, intent(in) :: is_line
    integer :: i, base, n

    base = mesh%n_points
    n = size(outline, 2)
    do i = 1, n
      call add_point(mesh, c, outline(:, i) + centre)
    end do
    if (is_line) then
      call add_cell(mesh, c, vtk_poly_line, base, [(i, i=1, n), 1])
    else
      call add_cell(mesh, c, vtk_polygon, base, [(i, i=1, n)])
    end if
  end subroutine add_outline

  !> Points of a contactor's outline.
  pure integer function corners(contactors, c, sides)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, sides
    integer :: row

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_polygon)
      corners = contactors%polygon_first(row + 1) - contactors%polygon_first(row)
    case (kind_segment)
      corners = 2*(cap_sides + 1)
    case (kind_hollow)
      corners = hollow_sides
    case default
      corners = sides
    end select
  end function corners

  !> A contactor's outline about its centre [m], counter-clockwise, shape (2, n).
  pure function outline_of(contactors, c, n) result(outline)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, n
    real(wp) :: outline(2, n)
    integer :: row, i

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_polygon)
      i = contactors%polygon_first(row)
      outline = contactors%polygon_vertex(:, i:i + n - 1)
    case (kind_segment)
      outline = segment(contactors%segment_size(:, row))
    case (kind_hollow)
      outline = arc(contactors%hollow_radius(row), 0.0_wp, 2*pi/real(n, wp), n)
    case default
      outline = arc(contactors%disk_radius(row), 0.0_wp, 2*pi/real(n, wp), n)
    end select
  end function outline_of

  !> Outline of a rounded segment with half length, half thickness and angle [m, m, rad].
  pure function segment(size)
    real(wp), intent(in) :: size(3)
    real(wp) :: segment(2, 2*(cap_sides + 1)), axis(2)
    integer, parameter :: n = cap_sides + 1
    integer :: i

    axis = size(1)*[cos(size(3)), sin(size(3))]
    segment(:, :n) = arc(size(2), size(3) - pi/2, pi/real(cap_sides, wp), n)
    segment(:, n + 1:) = -segment(:, :n)
    do i = 1, n
      segment(:, i) = segment(:, i) + axis
      segment(:, n + i) = segment(:, n + i) - axis
    end do
  end function segment

  !> Points of a circle about the origin [m], from an angle on in equal steps.
  pure function arc(radius, angle, step, n)
    real(wp), intent(in) :: radius, angle, step
    integer, intent(in) :: n
    real(wp) :: arc(2, n)
    integer :: i

    do i = 1, n
      arc(:, i) = radius*[cos(angle + real(i - 1, wp)*step), sin(angle + real(i - 1, wp)*step)]
    end do
  end function arc
end module sg_pictures_outlines
