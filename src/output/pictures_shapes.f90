!> Picture of the shapes: the outline of every contactor as a polygon, where it is at the end of the step.
!!
!! The cells never change and are stored once; each step adds the points.
module sg_pictures_shapes
  use sg_bodies, only: angle_of
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_polygon, kind_wall
  use sg_error, only: exit_output, fail
  use sg_kinds, only: wp, i4, i8, pi
  use sg_pictures_grid, only: grid_file_t, on_cells, vtk_poly_line, vtk_polygon
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: shapes_picture_t

  !> Sides of a disk; in scenes of more than `many_disks` half as many, to spare room
  integer, parameter :: disk_sides = 24, many_disks = 20000
  !> Sides of a hollow disk, which is large, and of each rounded end of a segment
  integer, parameter :: hollow_sides = 96, cap_sides = 8
  !> Codes of XDMF for cells of any number of points
  integer(i4), parameter :: xdmf_poly_line = 2, xdmf_polygon = 3

  !> The file `shapes.vtkhdf` and its sidecar
  type :: shapes_picture_t
    !> The file
    type(grid_file_t) :: grid
    !> Its sidecar `shapes.xmf`
    type(xdmf_t) :: xdmf
    !> Outlines of all contactors in their bodies' frames [m], shape (2, points)
    real(wp), allocatable :: outline(:, :)
    !> First point of each contactor's outline, shape (contactors + 1)
    integer, allocatable :: first(:)
  contains
    procedure :: open => shapes_open
    procedure :: write => shapes_write
  end type shapes_picture_t

contains

  !> Make the file, or go on with it.
  subroutine shapes_open(self, scene, options, resumed_step)
    class(shapes_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    type(run_options_t), intent(in) :: options !! folder and precision
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run

    call trace(self, scene%contactors)
    call self%grid%open(options%folder//'/shapes.vtkhdf', options, resumed_step)
    if (allocated(self%grid%file%error)) return
    if (self%grid%n_steps > 0 .and. self%grid%n_points /= size(self%outline, 2, i8)) &
      call fail(self%grid%file%error, 'cannot go on with this file: it shows other shapes', &
                file=self%grid%file%name, code=exit_output)
    call self%xdmf%open(options%folder//'/shapes.xmf', 'shapes.vtkhdf', 'Mixed', self%grid%n_steps)
  end subroutine shapes_open

  !> Trace the outlines of all contactors in their bodies' frames.
  subroutine trace(self, contactors)
    type(shapes_picture_t), intent(inout) :: self
    type(contactors_t), intent(in) :: contactors
    integer :: c, sides

    sides = merge(disk_sides, disk_sides/2, contactors%n_rows(kind_disk) <= many_disks)
    allocate (self%first(contactors%n + 1))
    self%first(1) = 1
    do c = 1, contactors%n
      self%first(c + 1) = self%first(c) + corners(contactors, c, sides)
    end do
    allocate (self%outline(2, self%first(contactors%n + 1) - 1))
    do c = 1, contactors%n
      associate (outline => self%outline(:, self%first(c):self%first(c + 1) - 1))
        outline = outline_of(contactors, c, size(outline, 2))
        outline(1, :) = outline(1, :) + contactors%shift(1, c)
        outline(2, :) = outline(2, :) + contactors%shift(2, c)
      end associate
    end do
  end subroutine trace

  !> Points of a contactor's outline.
  pure integer function corners(contactors, c, sides)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, sides
    integer :: row

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_polygon)
      corners = contactors%polygon_first(row + 1) - contactors%polygon_first(row)
    case (kind_wall)
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
    case (kind_wall)
      outline = segment(contactors%wall_size(:, row))
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

  !> Add a step.
  subroutine shapes_write(self, scene, time, step)
    class(shapes_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    integer :: n

    n = scene%contactors%n
    if (self%grid%n_steps == 0) call write_cells(self, scene%contactors)
    call self%grid%place(placed(self, scene))
    call self%grid%put(on_cells, 'body', scene%contactors%body(:n), is_static=.true.)
    call self%grid%put(on_cells, 'material', scene%bodies%material(scene%contactors%body(:n)), is_static=.true.)
    call self%grid%put(on_cells, 'colour', scene%contactors%colour(:n), is_static=.true.)
    call self%grid%put(on_cells, 'kind', scene%contactors%kind(:n), is_static=.true.)
    call self%grid%put(on_cells, 'velocity', velocities(scene))
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine shapes_write

  !> Store the cells, for VTK and for XDMF: hollow disks as closed lines, all others as polygons.
  subroutine write_cells(self, contactors)
    type(shapes_picture_t), intent(inout) :: self
    type(contactors_t), intent(in) :: contactors
    integer(i4), allocatable :: points(:), connectivity(:), topology(:), types(:)
    integer(i8) :: offsets(contactors%n + 1)
    integer :: c, i, n
    logical :: is_line

    allocate (connectivity(size(self%outline, 2) + contactors%n_rows(kind_hollow)), types(contactors%n))
    allocate (topology(size(connectivity) + 2*contactors%n))
    offsets(1) = 0
    n = 0
    do c = 1, contactors%n
      is_line = contactors%kind(c) == kind_hollow
      points = [(int(i - 1, i4), i=self%first(c), self%first(c + 1) - 1)]
      if (is_line) points = [points, points(1)]
      types(c) = merge(vtk_poly_line, vtk_polygon, is_line)
      connectivity(n + 1:n + size(points)) = points
      topology(n + 2*c - 1:n + 2*c) = [merge(xdmf_poly_line, xdmf_polygon, is_line), int(size(points), i4)]
      topology(n + 2*c + 1:n + 2*c + size(points)) = points
      n = n + size(points)
      offsets(c + 1) = int(n, i8)
    end do
    call self%grid%part(size(self%outline, 2), int(connectivity, i8), offsets, types)
    call self%grid%file%group('/XDMF')
    call self%grid%file%put('/XDMF/topology', topology)
  end subroutine write_cells

  !> Points of all outlines where their bodies are [m], shape (3, points).
  pure function placed(self, scene) result(points)
    type(shapes_picture_t), intent(in) :: self
    type(scene_t), intent(in) :: scene
    real(wp), allocatable :: points(:, :)
    integer :: c, i, b
    real(wp) :: cosine, sine

    allocate (points(3, size(self%outline, 2)), source=0.0_wp)
    do c = 1, scene%contactors%n
      b = scene%contactors%body(c)
      cosine = cos(angle_of(scene%bodies, b))
      sine = sin(angle_of(scene%bodies, b))
      do i = self%first(c), self%first(c + 1) - 1
        points(1, i) = scene%bodies%position(1, b) + cosine*self%outline(1, i) - sine*self%outline(2, i)
        points(2, i) = scene%bodies%position(2, b) + sine*self%outline(1, i) + cosine*self%outline(2, i)
      end do
    end do
  end function placed

  !> Velocities of the bodies that carry the contactors [m/s], shape (3, contactors).
  pure function velocities(scene) result(velocity)
    type(scene_t), intent(in) :: scene
    real(wp), allocatable :: velocity(:, :)
    integer :: c

    allocate (velocity(3, scene%contactors%n), source=0.0_wp)
    do c = 1, scene%contactors%n
      velocity(1:2, c) = scene%bodies%velocity(1:2, scene%contactors%body(c))
    end do
  end function velocities
end module sg_pictures_shapes
