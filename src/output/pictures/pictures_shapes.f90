!> Picture of the shapes, where they are at the end of the step.
!!
!! The cells never change and are stored once; each step adds the points. Where ranks share a scene, each draws a block of
!! points and a block of cells (sg_pictures_pieces), so that the file is that of one rank.
module sg_pictures_shapes
  use sg_block_distribution, only: block_distribution_t
  use sg_bodies, only: angle_of, bodies_t, body_present
  use sg_comm, only: comm_t
  use sg_contactors, only: contactors_t, kind_names, kind_point, n_kinds
  use sg_error, only: exit_output, fail
  use sg_kinds, only: wp, i4, i8
  use sg_pictures_grid, only: grid_file_t, on_cells, on_points, put_presence
  use sg_pictures_mesh, only: mesh_t, xdmf_topology
  use sg_pictures_outlines, only: trace_outlines
  use sg_pictures_pieces, only: pieces_t
  use sg_pictures_surfaces, only: trace_surfaces
  use sg_rotations, only: frame_of, no_rotation
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_words, only: choices_of
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: shapes_picture_t

  !> The file `shapes.vtkhdf` and its sidecar
  type :: shapes_picture_t
    !> The file
    type(grid_file_t) :: grid
    !> Its sidecar `shapes.xmf`
    type(xdmf_t) :: xdmf
    !> What contactors look like in their bodies' frames: all of them, or where ranks share a scene what this rank draws
    type(mesh_t) :: mesh
    !> Where ranks share a scene: what this rank draws, and whose it is
    type(pieces_t) :: pieces
  contains
    procedure :: open => shapes_open
    procedure :: write => shapes_write
  end type shapes_picture_t

contains

  !> Make the file, or go on with it.
  subroutine shapes_open(self, scene, rows, options, resumed_step, comm)
    class(shapes_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    type(block_distribution_t), intent(in) :: rows !! in a scene that ranks share: the blocks of bodies
    type(run_options_t), intent(in) :: options !! folder and precision
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run
    type(comm_t), intent(inout) :: comm !! ranks that share the scene
    logical :: is_mine(scene%contactors%n)
    integer(i8) :: total

    ! Points have nothing to draw: links are drawn as contacts.
    is_mine = scene%contactors%body(:scene%contactors%n) <= scene%bodies%n_own .and. &
              scene%contactors%kind(:scene%contactors%n) /= kind_point
    call trace(scene, is_mine, comm, self%mesh)
    if (comm%size > 1) call self%pieces%plan(scene, is_mine, rows, self%mesh, comm)
    call self%grid%open(options%folder//'/shapes.vtkhdf', options, resumed_step, comm)
    if (allocated(self%grid%file%error)) return
    call self%grid%file%set('/', 'shape_kinds', choices_of(kind_names))
    total = int(self%mesh%n_points, i8)
    call comm%sum(total)
    if (self%grid%n_steps > 0 .and. self%grid%n_points /= total) &
      call fail(self%grid%file%error, 'cannot go on with this file: it shows other shapes', &
                file=self%grid%file%name, code=exit_output)
    call self%xdmf%open(options%folder//'/shapes.xmf', 'shapes.vtkhdf', 'Mixed', self%grid%n_steps, comm%rank == 0)
  end subroutine shapes_open

  !> Trace contactors; how finely depends on their number in the whole scene.
  subroutine trace(scene, is_mine, comm, mesh)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: is_mine(:)
    type(comm_t), intent(inout) :: comm
    type(mesh_t), intent(out) :: mesh
    integer :: n_of_kind(n_kinds)
    integer :: k

    do k = 1, n_kinds
      n_of_kind(k) = count(is_mine .and. scene%contactors%kind(:scene%contactors%n) == k)
    end do
    call comm%sum(n_of_kind)
    if (scene%dimension == 2) then
      call trace_outlines(scene%contactors, n_of_kind, is_mine, mesh)
    else
      call trace_surfaces(scene%contactors, n_of_kind, is_mine, mesh)
    end if
  end subroutine trace

  !> Add a step.
  subroutine shapes_write(self, scene, bodies, time, step)
    class(shapes_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    type(bodies_t), intent(in) :: bodies !! in a scene that ranks share: the block of bodies of this rank
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step

    if (self%grid%file%ranks%size == 1) then
      call write_shapes(self, scene%contactors, scene%bodies)
    else
      call self%pieces%move(bodies, self%grid%file%ranks)
      call write_shapes(self, self%pieces%contactors, self%pieces%bodies)
    end if
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine shapes_write

  !> Store all arrays of a step.
  subroutine write_shapes(self, contactors, bodies)
    type(shapes_picture_t), intent(inout) :: self
    type(contactors_t), intent(in) :: contactors
    type(bodies_t), intent(in) :: bodies
    integer(i4), allocatable :: shape(:), carrier(:)

    shape = self%mesh%shape_of_cell(:self%mesh%n_cells)
    carrier = contactors%body(shape)
    if (self%grid%n_steps == 0) call write_cells(self)
    call self%grid%place(placed(self%mesh, contactors, bodies))
    if (bodies%dimension == 3) &
      call self%grid%put(on_points, 'radius', self%mesh%radius(:self%mesh%n_points), is_static=.true.)
    if (allocated(bodies%id)) then
      call self%grid%put(on_cells, 'body', bodies%id(carrier), is_static=.true.)
    else
      call self%grid%put(on_cells, 'body', carrier, is_static=.true.)
    end if
    call self%grid%put(on_cells, 'material', bodies%material(carrier), is_static=.true.)
    call self%grid%put(on_cells, 'colour', contactors%colour(shape), is_static=.true.)
    call self%grid%put(on_cells, 'kind', contactors%kind(shape), is_static=.true.)
    if (allocated(contactors%id)) shape = contactors%id(shape)
    if (bodies%dimension == 3) call self%grid%put(on_cells, 'shape', shape, is_static=.true.)
    call self%grid%put(on_cells, 'velocity', velocities(bodies, carrier))
    if (allocated(bodies%presence)) call put_presence(self%grid, on_cells, bodies%presence(carrier) == body_present)
  end subroutine write_shapes

  !> Store the cells, for VTK and for XDMF.
  subroutine write_cells(self)
    type(shapes_picture_t), intent(inout) :: self

    associate (mesh => self%mesh)
      call self%grid%part(mesh%n_points, int(mesh%corner(:mesh%n_corners), i8), mesh%size_of_cell(:mesh%n_cells), &
                          mesh%type_of_cell(:mesh%n_cells))
    end associate
    call self%grid%file%group('/XDMF')
    if (self%grid%file%ranks%size == 1) then
      call self%grid%file%put('/XDMF/topology', xdmf_topology(self%mesh))
    else
      call self%grid%file%put('/XDMF/topology', self%pieces%topology)
      deallocate (self%pieces%topology)
    end if
  end subroutine write_cells

  !> Points of all shapes where their bodies are [m], shape (3, points).
  pure function placed(mesh, contactors, bodies) result(points)
    type(mesh_t), intent(in) :: mesh
    type(contactors_t), intent(in) :: contactors
    type(bodies_t), intent(in) :: bodies
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
        associate (body => contactors%body(shape))
          frame = frame_of_body(bodies, body)
          centre(:mesh%dimension) = bodies%position(:, body)
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
