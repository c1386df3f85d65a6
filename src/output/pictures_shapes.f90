!> Picture of the shapes, where they are at the end of the step.
!!
!! The cells never change and are stored once; each step adds the points.
module sg_pictures_shapes
  use sg_bodies, only: angle_of, bodies_t
  use sg_error, only: exit_output, fail
  use sg_kinds, only: wp, i4, i8
  use sg_pictures_grid, only: grid_file_t, on_cells, on_points, vtk_poly_line, vtk_vertex
  use sg_pictures_mesh, only: mesh_t
  use sg_pictures_outlines, only: trace_outlines
  use sg_pictures_surfaces, only: trace_surfaces
  use sg_rotations, only: frame_of, no_rotation
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: shapes_picture_t

  !> Codes of XDMF for cells of any number of points
  integer(i4), parameter :: xdmf_poly_vertex = 1, xdmf_poly_line = 2, xdmf_polygon = 3

  !> The file `shapes.vtkhdf` and its sidecar
  type :: shapes_picture_t
    !> The file
    type(grid_file_t) :: grid
    !> Its sidecar `shapes.xmf`
    type(xdmf_t) :: xdmf
    !> What all contactors look like in their bodies' frames
    type(mesh_t) :: mesh
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

    if (scene%dimension == 2) then
      call trace_outlines(scene%contactors, self%mesh)
    else
      call trace_surfaces(scene%contactors, self%mesh)
    end if
    call self%grid%open(options%folder//'/shapes.vtkhdf', options, resumed_step)
    if (allocated(self%grid%file%error)) return
    if (self%grid%n_steps > 0 .and. self%grid%n_points /= int(self%mesh%n_points, i8)) &
      call fail(self%grid%file%error, 'cannot go on with this file: it shows other shapes', &
                file=self%grid%file%name, code=exit_output)
    call self%xdmf%open(options%folder//'/shapes.xmf', 'shapes.vtkhdf', 'Mixed', self%grid%n_steps)
  end subroutine shapes_open

  !> Add a step.
  subroutine shapes_write(self, scene, time, step)
    class(shapes_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    integer :: n

    n = self%mesh%n_cells
    if (self%grid%n_steps == 0) call write_cells(self)
    call self%grid%place(placed(self%mesh, scene))
    if (scene%dimension == 3) &
      call self%grid%put(on_points, 'radius', self%mesh%radius(:self%mesh%n_points), is_static=.true.)
    associate (shape => self%mesh%shape_of_cell(:n))
      call self%grid%put(on_cells, 'body', scene%contactors%body(shape), is_static=.true.)
      call self%grid%put(on_cells, 'material', scene%bodies%material(scene%contactors%body(shape)), is_static=.true.)
      call self%grid%put(on_cells, 'colour', scene%contactors%colour(shape), is_static=.true.)
      call self%grid%put(on_cells, 'kind', scene%contactors%kind(shape), is_static=.true.)
      if (scene%dimension == 3) call self%grid%put(on_cells, 'shape', shape, is_static=.true.)
      call self%grid%put(on_cells, 'velocity', velocities(scene%bodies, scene%contactors%body(shape)))
    end associate
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine shapes_write

  !> Store the cells, for VTK and for XDMF.
  subroutine write_cells(self)
    type(shapes_picture_t), intent(inout) :: self
    integer(i4) :: topology(self%mesh%n_corners + 2*self%mesh%n_cells), code
    integer :: c, first, last, n

    associate (mesh => self%mesh)
      call self%grid%part(mesh%n_points, int(mesh%corner(:mesh%n_corners), i8), mesh%offsets(), &
                          mesh%type_of_cell(:mesh%n_cells))
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
    end associate
    call self%grid%file%group('/XDMF')
    call self%grid%file%put('/XDMF/topology', topology)
  end subroutine write_cells

  !> Points of all shapes where their bodies are [m], shape (3, points).
  pure function placed(mesh, scene) result(points)
    type(mesh_t), intent(in) :: mesh
    type(scene_t), intent(in) :: scene
    real(wp), allocatable :: points(:, :)
    real(wp) :: frame(3, 3), centre(3)
    integer :: i, shape, now

    allocate (points(3, mesh%n_points), source=0.0_wp)
    frame = 0
    centre = 0
    now = 0
    do i = 1, mesh%n_points
      shape = mesh%shape_of_point(i)
      if (shape /= now) then
        associate (body => scene%contactors%body(shape))
          frame = frame_of_body(scene%bodies, body)
          centre(:mesh%dimension) = scene%bodies%position(:, body)
        end associate
        now = shape
      end if
      associate (u => mesh%point(:, i))
        if (mesh%dimension == 2) then
          points(:2, i) = centre(:2) + frame(:2, 1)*u(1) + frame(:2, 2)*u(2)
        else
          points(:, i) = centre + frame(:, 1)*u(1) + frame(:, 2)*u(2) + frame(:, 3)*u(3)
        end if
      end associate
    end do
  end function placed

  !> The axes of a body in the world, as columns.
  pure function frame_of_body(bodies, body) result(frame)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: body
    real(wp) :: frame(3, 3), cosine, sine

    frame = frame_of(no_rotation)
    if (allocated(bodies%orientation)) then
      frame = frame_of(bodies%orientation(:, body))
    else if (bodies%dimension == 2) then
      cosine = cos(angle_of(bodies, body))
      sine = sin(angle_of(bodies, body))
      frame(:2, 1) = [cosine, sine]
      frame(:2, 2) = [-sine, cosine]
    end if
  end function frame_of_body

  !> Velocities of the bodies that carry the cells [m/s], shape (3, cells).
  pure function velocities(bodies, body) result(velocity)
    type(bodies_t), intent(in) :: bodies
    integer(i4), intent(in) :: body(:)
    real(wp), allocatable :: velocity(:, :)
    integer :: c

    allocate (velocity(3, size(body)), source=0.0_wp)
    do c = 1, size(body)
      velocity(:bodies%dimension, c) = bodies%velocity(:bodies%dimension, body(c))
    end do
  end function velocities
end module sg_pictures_shapes
