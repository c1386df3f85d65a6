!> Picture of the bodies: one point a body, at its centre of mass, for glyphs and analysis.
module sg_pictures_bodies
  use sg_bodies, only: angle_of, bodies_t, spin_of
  use sg_error, only: exit_output, fail
  use sg_kinds, only: wp, i4, i8, pi
  use sg_pictures_grid, only: grid_file_t, grid_root, on_field, on_points, vtk_vertex
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
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
    !> Where the bodies were at the first picture, without periods [m], shape (3, bodies)
    real(wp), allocatable :: start(:, :)
  contains
    procedure :: open => bodies_open
    procedure :: write => bodies_write
  end type bodies_picture_t

contains

  !> Make the file, or go on with it.
  subroutine bodies_open(self, scene, options, resumed_step)
    class(bodies_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    type(run_options_t), intent(in) :: options !! folder and precision
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run

    call self%grid%open(options%folder//'/bodies.vtkhdf', options, resumed_step)
    if (allocated(self%grid%file%error)) return
    if (self%grid%n_steps == 0) then
      self%start = unwrapped(scene%bodies, scene%period)
    else
      call self%grid%file%get(grid_root//'PointData/start_position', self%start)
      if (size(self%start, 2) /= scene%bodies%n .and. .not. allocated(self%grid%file%error)) &
        call fail(self%grid%file%error, 'cannot go on with this file: it shows another number of bodies', &
                  file=self%grid%file%name, code=exit_output)
    end if
    call self%xdmf%open(options%folder//'/bodies.xmf', 'bodies.vtkhdf', 'Polyvertex', self%grid%n_steps)
  end subroutine bodies_open

  !> Add a step.
  subroutine bodies_write(self, scene, time, step, home)
    class(bodies_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    integer(i4), intent(in) :: home(:) !! rank that owns each body, shape (bodies)
    integer :: b, n

    n = scene%bodies%n
    if (self%grid%n_steps == 0) &
      call self%grid%part(n, [(int(b, i8), b=0, n - 1)], [(int(b, i8), b=0, n)], spread(vtk_vertex, 1, n))
    call self%grid%place(in_space(scene%bodies%position))
    call write_constants(self%grid, scene%bodies, self%start)
    call self%grid%put(on_points, 'velocity', in_space(scene%bodies%velocity(1:2, :)))
    call self%grid%put(on_points, 'spin', [(spin_of(scene%bodies, b), b=1, n)])
    call self%grid%put(on_points, 'angle', [(angle_of(scene%bodies, b), b=1, n)])
    call self%grid%put(on_points, 'displacement', unwrapped(scene%bodies, scene%period) - self%start)
    call self%grid%put(on_points, 'rank', home)
    call self%grid%put(on_field, 'period', [scene%period])
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine bodies_write

  !> What does not change with time.
  subroutine write_constants(grid, bodies, start)
    type(grid_file_t), intent(inout) :: grid
    type(bodies_t), intent(in) :: bodies
    real(wp), intent(in) :: start(:, :)
    integer :: b

    call grid%put(on_points, 'id', [(int(b, i4), b=1, bodies%n)], is_static=.true.)
    call grid%put(on_points, 'radius', sqrt(bodies%area/pi), is_static=.true.)
    call grid%put(on_points, 'mass', bodies%mass, is_static=.true.)
    call grid%put(on_points, 'material', bodies%material, is_static=.true.)
    call grid%put(on_points, 'is_grain', merge(1_i4, 0_i4, bodies%is_grain), is_static=.true.)
    call grid%put(on_points, 'start_position', start, is_static=.true.)
  end subroutine write_constants

  !> Positions as if there were no period [m], shape (3, bodies).
  pure function unwrapped(bodies, period) result(position)
    type(bodies_t), intent(in) :: bodies
    real(wp), intent(in) :: period
    real(wp), allocatable :: position(:, :)

    position = in_space(bodies%position)
    position(1, :) = position(1, :) + real(bodies%crossings, wp)*period
  end function unwrapped

  !> Plane vectors with a third component of zero.
  pure function in_space(plane) result(space)
    real(wp), intent(in) :: plane(:, :)
    real(wp), allocatable :: space(:, :)

    allocate (space(3, size(plane, 2)), source=0.0_wp)
    space(1:2, :) = plane
  end function in_space
end module sg_pictures_bodies
