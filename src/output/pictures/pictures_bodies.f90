!> Picture of the bodies: one point a body, at its centre of mass, for glyphs and analysis. Where ranks share a scene, each
!! draws a block of bodies, in the order of their numbers (sg_bodies_rows).
module sg_pictures_bodies
  use sg_bodies, only: angle_of, bodies_t, body_present, spin_of
  use sg_comm, only: comm_t
  use sg_error, only: exit_output, fail
  use sg_kinds, only: wp, i4, i8, pi
  use sg_pictures_grid, only: grid_file_t, grid_root, on_field, on_points, put_presence, vtk_vertex
  use sg_rotations, only: no_rotation, turned_by
  use sg_run_options, only: run_options_t
  use sg_scene, only: place_of_body => unwrapped, scene_t
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: bodies_picture_t

  !> The file `bodies.vtkhdf` and its sidecar
  type :: bodies_picture_t
    !> The file
    type(grid_file_t) :: grid
    !> Its sidecar `bodies.xmf`
    type(xdmf_t) :: xdmf
    !> Where the bodies of this rank's rows were at the first picture, without periods [m], shape (3, bodies)
    real(wp), allocatable :: start(:, :)
  contains
    procedure :: open => bodies_open
    procedure :: write => bodies_write
  end type bodies_picture_t

contains

  !> Make the file, or go on with it.
  subroutine bodies_open(self, scene, bodies, options, resumed_step, comm)
    class(bodies_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    type(bodies_t), intent(in) :: bodies !! the bodies that this rank draws
    type(run_options_t), intent(in) :: options !! folder and precision
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run
    type(comm_t), intent(inout) :: comm !! ranks that share the scene
    integer(i8) :: before, total

    call self%grid%open(options%folder//'/bodies.vtkhdf', options, resumed_step, comm)
    if (allocated(self%grid%file%error)) return
    if (self%grid%n_steps == 0) then
      if (allocated(options%body_names)) call self%grid%file%put('/names', options%body_names)
      self%start = unwrapped(scene, bodies)
    else
      call comm%before(int(bodies%n, i8), before, total)
      if (self%grid%n_points /= total) then
        call fail(self%grid%file%error, 'cannot go on with this file: it shows another number of bodies', &
                  file=self%grid%file%name, code=exit_output)
      else
        call self%grid%file%get_rows(grid_root//'PointData/start_position', before, bodies%n, self%start)
      end if
    end if
    call self%xdmf%open(options%folder//'/bodies.xmf', 'bodies.vtkhdf', 'Polyvertex', self%grid%n_steps, comm%rank == 0)
  end subroutine bodies_open

  !> Add a step.
  subroutine bodies_write(self, scene, bodies, time, step, owner)
    class(bodies_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    type(bodies_t), intent(in) :: bodies !! the bodies that this rank draws
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    integer(i4), intent(in), optional :: owner(:) !! rank to show for each body, that of the bodies or 0 when absent
    integer(i8) :: before, total
    integer :: b, n

    n = bodies%n
    call self%grid%file%ranks%before(int(n, i8), before, total)
    if (self%grid%n_steps == 0) &
      call self%grid%part(n, [(before + int(b, i8), b=0, n - 1)], spread(1_i4, 1, n), spread(vtk_vertex, 1, n))
    call self%grid%place(in_space(bodies%position))
    call write_constants(self%grid, bodies, self%start)
    call self%grid%put(on_points, 'velocity', in_space(bodies%velocity(1:scene%dimension, :)))
    call write_turning(self%grid, bodies)
    if (allocated(bodies%presence)) call put_presence(self%grid, on_points, bodies%presence == body_present)
    call self%grid%put(on_points, 'displacement', unwrapped(scene, bodies) - self%start)
    if (present(owner)) then
      call self%grid%put(on_points, 'rank', owner)
    else if (allocated(bodies%owner)) then
      call self%grid%put(on_points, 'rank', bodies%owner)
    else
      call self%grid%put(on_points, 'rank', spread(0_i4, 1, n))
    end if
    if (scene%cell%is_on) then
      call self%grid%put(on_field, 'period', [scene%cell%now(1)])
      call self%grid%put(on_field, 'period_y', [scene%cell%now(2)])
      if (scene%dimension == 3) call self%grid%put(on_field, 'period_z', [scene%cell%now(3)])
      call self%grid%put(on_field, 'tilt', [scene%cell%now(4)])
    else
      call self%grid%put(on_field, 'period', [scene%period])
      if (scene%dimension == 3) call self%grid%put(on_field, 'period_y', [scene%period_y])
    end if
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine bodies_write

  !> Angular velocities and orientations; in space spins are turned from the bodies' own axes to the world's.
  subroutine write_turning(grid, bodies)
    type(grid_file_t), intent(inout) :: grid
    type(bodies_t), intent(in) :: bodies
    real(wp), allocatable :: spin(:, :), orientation(:, :)
    integer :: b

    if (bodies%dimension == 2) then
      call grid%put(on_points, 'spin', [(spin_of(bodies, b), b=1, bodies%n)])
      call grid%put(on_points, 'angle', [(angle_of(bodies, b), b=1, bodies%n)])
      return
    end if
    allocate (spin(3, bodies%n), source=0.0_wp)
    orientation = spread(no_rotation, 2, bodies%n)
    if (allocated(bodies%orientation)) then
      orientation = bodies%orientation
      do b = 1, merge(bodies%n, 0, bodies%n_velocity == 6)
        spin(:, b) = turned_by(orientation(:, b), bodies%velocity(4:6, b))
      end do
    end if
    call grid%put(on_points, 'spin', spin)
    call grid%put(on_points, 'orientation', orientation)
  end subroutine write_turning

  !> What does not change with time.
  subroutine write_constants(grid, bodies, start)
    type(grid_file_t), intent(inout) :: grid
    type(bodies_t), intent(in) :: bodies
    real(wp), intent(in) :: start(:, :)
    real(wp), allocatable :: radius(:)
    integer :: b

    if (allocated(bodies%id)) then
      call grid%put(on_points, 'id', bodies%id, is_static=.true.)
    else
      call grid%put(on_points, 'id', [(int(b, i4), b=1, bodies%n)], is_static=.true.)
    end if
    if (bodies%dimension == 2) then
      call grid%put(on_points, 'radius', sqrt(bodies%area/pi), is_static=.true.)
    else
      ! One by one: vector registers round powers otherwise, so that files would depend on what stands beside a body.
      allocate (radius(bodies%n))
      !GCC$ novector
      do b = 1, bodies%n
        radius(b) = (3*bodies%area(b)/(4*pi))**(1.0_wp/3)
      end do
      call grid%put(on_points, 'radius', radius, is_static=.true.)
    end if
    call grid%put(on_points, 'mass', bodies%mass, is_static=.true.)
    call grid%put(on_points, 'material', bodies%material, is_static=.true.)
    call grid%put(on_points, 'is_grain', merge(1_i4, 0_i4, bodies%is_grain), is_static=.not. allocated(bodies%presence))
    call grid%put(on_points, 'start_position', start, is_static=.true.)
  end subroutine write_constants

  !> Positions as if there were no period [m], shape (3, bodies).
  pure function unwrapped(scene, bodies) result(position)
    type(scene_t), intent(in) :: scene
    type(bodies_t), intent(in) :: bodies
    real(wp), allocatable :: position(:, :)
    integer :: b

    allocate (position(3, bodies%n))
    do b = 1, bodies%n
      position(:, b) = place_of_body(scene, bodies, b)
    end do
  end function unwrapped

  !> Vectors of the plane with a third component of zero; those of space as they are.
  pure function in_space(vectors) result(space)
    real(wp), intent(in) :: vectors(:, :)
    real(wp), allocatable :: space(:, :)

    allocate (space(3, size(vectors, 2)), source=0.0_wp)
    space(:size(vectors, 1), :) = vectors
  end function in_space
end module sg_pictures_bodies
