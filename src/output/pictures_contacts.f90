!> Picture of the contacts: one line a contact from body to body, which carries the forces of the step.
!!
!! A line goes from the candidate's centre to the antagonist's, in the periodic image of the candidate; at a wall,
!! whose centre means nothing, it ends at the point of contact instead.
module sg_pictures_contacts
  use sg_bodies, only: bodies_t
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp, i4, i8
  use sg_pictures_grid, only: grid_file_t, on_cells, on_field, vtk_empty, vtk_line
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: contacts_picture_t

  !> The file `contacts.vtkhdf` and its sidecar
  type :: contacts_picture_t
    !> The file
    type(grid_file_t) :: grid
    !> Its sidecar `contacts.xmf`
    type(xdmf_t) :: xdmf
    !> Time step, by which impulses become forces [s]
    real(wp) :: time_step = 1
  contains
    procedure :: open => contacts_open
    procedure :: write => contacts_write
  end type contacts_picture_t

contains

  !> Make the file, or go on with it.
  subroutine contacts_open(self, options, resumed_step)
    class(contacts_picture_t), intent(inout) :: self
    type(run_options_t), intent(in) :: options !! folder, precision and time step
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run

    self%time_step = options%step
    call self%grid%open(options%folder//'/contacts.vtkhdf', options, resumed_step)
    if (allocated(self%grid%file%error)) return
    call self%xdmf%open(options%folder//'/contacts.xmf', 'contacts.vtkhdf', 'Polyline', self%grid%n_steps)
  end subroutine contacts_open

  !> Add a step.
  subroutine contacts_write(self, scene, contacts, time, step)
    class(contacts_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! bodies that touch
    type(contacts_t), intent(in) :: contacts !! contacts of the step just done
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    integer :: i, n
    integer(i8) :: no_ids(0)
    real(wp), allocatable :: points(:, :)

    n = contacts%n
    call self%grid%put(on_field, 'ncontacts', [int(n, i4)])
    allocate (points(3, 2*n), source=0.0_wp)
    if (n > 0) then
      call self%grid%part(2*n, [(int(i, i8), i=0, 2*n - 1)], [(int(2*i, i8), i=0, n)], spread(vtk_line, 1, n))
      do i = 1, n
        points(1:2, 2*i - 1:2*i) = ends(scene%bodies, contacts, i, scene%period)
      end do
      call self%grid%place(points)
      call write_arrays(self, scene, contacts)
    else
      ! VTK 9.5 and 9.6 misread a step without cells: one cell of type "empty" draws nothing.
      call self%grid%part(0, no_ids, [0_i8, 0_i8], [vtk_empty])
      call self%grid%place(points)
      call write_zeros(self)
    end if
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine contacts_write

  !> Numbers of all contacts.
  subroutine write_arrays(self, scene, contacts)
    type(contacts_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp) :: vectors(3, contacts%n), tangential(contacts%n)
    integer :: i, n

    n = contacts%n
    tangential = 0
    if (contacts%n_components > 1) tangential = contacts%impulse(2, :n)/self%time_step
    call self%grid%put(on_cells, 'force_normal', contacts%impulse(1, :n)/self%time_step)
    call self%grid%put(on_cells, 'force_tangential', tangential)
    call self%grid%put(on_cells, 'gap', contacts%gap(:n))
    vectors = 0
    vectors(1:2, :) = contacts%normal(:, :n)
    call self%grid%put(on_cells, 'normal', vectors)
    do i = 1, n
      vectors(1:2, i) = contacts%point(:, i)
      vectors(1, i) = vectors(1, i) + real(jump(scene%bodies, contacts%body(1, i), scene%period), wp)*scene%period
    end do
    call self%grid%put(on_cells, 'point', vectors)
    call self%grid%put(on_cells, 'status', int(contacts%status(:n), i4))
    call self%grid%put(on_cells, 'law', contacts%law(:n))
    call self%grid%put(on_cells, 'candidate', contacts%body(1, :n))
    call self%grid%put(on_cells, 'antagonist', contacts%body(2, :n))
  end subroutine write_arrays

  !> Numbers of the cell that stands for no contact.
  subroutine write_zeros(self)
    type(contacts_picture_t), intent(inout) :: self
    real(wp), parameter :: vector(3, 1) = 0

    call self%grid%put(on_cells, 'force_normal', vector(1, :))
    call self%grid%put(on_cells, 'force_tangential', vector(1, :))
    call self%grid%put(on_cells, 'gap', vector(1, :))
    call self%grid%put(on_cells, 'normal', vector)
    call self%grid%put(on_cells, 'point', vector)
    call self%grid%put(on_cells, 'status', [0_i4])
    call self%grid%put(on_cells, 'law', [0_i4])
    call self%grid%put(on_cells, 'candidate', [0_i4])
    call self%grid%put(on_cells, 'antagonist', [0_i4])
  end subroutine write_zeros

  !> The two ends of a contact's line [m]: at the candidate and at the antagonist.
  pure function ends(bodies, contacts, i, period)
    type(bodies_t), intent(in) :: bodies
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: i
    real(wp), intent(in) :: period
    real(wp) :: ends(2, 2), point(2)
    integer :: candidate, antagonist, here

    candidate = contacts%body(1, i)
    antagonist = contacts%body(2, i)
    here = jump(bodies, candidate, period)
    point = contacts%point(:, i)
    point(1) = point(1) + real(here, wp)*period
    ends(:, 1) = bodies%position(:, candidate)
    ends(:, 2) = bodies%position(:, antagonist)
    ends(1, 2) = ends(1, 2) + real(int(contacts%image(i)) + here - jump(bodies, antagonist, period), wp)*period
    if (.not. bodies%is_grain(antagonist)) then
      ends(:, 2) = point
    else if (.not. bodies%is_grain(candidate)) then
      ends(:, 1) = point
    end if
  end function ends

  !> Periods by which a body's stored position jumped between the detection of contacts and the end of the step.
  pure integer function jump(bodies, body, period)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: body
    real(wp), intent(in) :: period

    jump = 0
    if (period > 0) jump = nint((bodies%position(1, body) - bodies%middle(1, body))/period)
  end function jump
end module sg_pictures_contacts
