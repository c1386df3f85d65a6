!> Pictures of a run for ParaView, VTK and h5py: bodies, shapes, contacts and, where the deck asks for them, interfaces, each a
!! VTKHDF file with an XDMF sidecar.
!!
!! The files always have the same steps. They can be read while the run goes on and after it was killed. Where ranks
!! share a scene they write the files together, and bodies and shapes stand in them as one rank would write them.
module sg_pictures
  use sg_block_distribution, only: block_distribution_t
  use sg_bodies, only: bodies_t
  use sg_bodies_rows, only: order_bodies
  use sg_body_interfaces, only: interfaces_t
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_pictures_bodies, only: bodies_picture_t
  use sg_pictures_contacts, only: contacts_picture_t
  use sg_pictures_grid, only: grid_file_t
  use sg_pictures_interfaces, only: interfaces_picture_t
  use sg_pictures_shapes, only: shapes_picture_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: pictures_t

  !> The pictures of one run
  type :: pictures_t
    private
    !> Where the bodies are
    type(bodies_picture_t) :: bodies
    !> What they look like
    type(shapes_picture_t) :: shapes
    !> What they do to each other
    type(contacts_picture_t) :: contacts
    !> Their resultants between pairs of bodies; unallocated in runs without interfaces
    type(interfaces_picture_t), allocatable :: interfaces
  contains
    procedure :: open => pictures_open
    procedure :: write => pictures_write
    procedure :: close => pictures_close
  end type pictures_t

contains

  !> Make the files, or go on with those of a stopped run.
  subroutine pictures_open(self, scene, options, resumed_step, error, comm)
    class(pictures_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show; where ranks share it, the part of this one
    type(run_options_t), intent(in) :: options !! folder, precision, compression, hash of the deck, time step
    integer, intent(in) :: resumed_step !! step of the checkpoint, after which pictures are dropped; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when a file cannot be written
    type(comm_t), intent(inout) :: comm !! ranks that share the scene
    type(bodies_t) :: block
    type(block_distribution_t) :: rows

    if (comm%size > 1) then
      call order_bodies(scene%bodies, comm, rows, block, error)
      if (allocated(error)) return
      call self%bodies%open(scene, block, options, resumed_step, comm)
    else
      call self%bodies%open(scene, scene%bodies, options, resumed_step, comm)
    end if
    call self%shapes%open(scene, rows, options, resumed_step, comm)
    call self%contacts%open(options, resumed_step, comm)
    if (allocated(self%interfaces)) deallocate (self%interfaces)
    if (allocated(options%interfaces)) then
      allocate (self%interfaces)
      call self%interfaces%open(options, resumed_step, comm)
    end if
    call agree_on_error(self, comm, error)
  end subroutine pictures_open

  !> Add the end of a step to all files.
  subroutine pictures_write(self, scene, contacts, time, step, comm, error, owner, interfaces)
    class(pictures_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what to show, at the end of the step; where ranks share it, the part of this one
    type(contacts_t), intent(in) :: contacts !! contacts of the step, with their impulses
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    type(comm_t), intent(inout) :: comm !! ranks that share the scene
    type(error_t), allocatable, intent(out) :: error !! set when a file cannot be written
    integer(i4), intent(in), optional :: owner(:) !! of a scene that is not shared: rank to show for each body, 0 when absent
    type(interfaces_t), intent(in), optional :: interfaces !! pairs of bodies of the step, measured; none when absent
    type(bodies_t) :: block
    type(block_distribution_t) :: rows

    call agree_on_error(self, comm, error)
    if (allocated(error)) return
    if (comm%size > 1) then
      call order_bodies(scene%bodies, comm, rows, block, error)
      if (allocated(error)) return
      call self%bodies%write(scene, block, time, step)
    else
      call self%bodies%write(scene, scene%bodies, time, step, owner)
    end if
    call self%shapes%write(scene, block, time, step)
    call self%contacts%write(scene, contacts, time, step)
    if (allocated(self%interfaces)) then
      if (present(interfaces)) then
        call self%interfaces%write(interfaces, scene%dimension, time, step)
      else
        call self%interfaces%write(interfaces_t(), scene%dimension, time, step)
      end if
    end if
    call agree_on_error(self, comm, error)
  end subroutine pictures_write

  !> Close all files.
  subroutine pictures_close(self, comm, error)
    class(pictures_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! ranks that share the scene
    type(error_t), allocatable, intent(out) :: error !! set when a file could not be written to its end

    call self%bodies%grid%close()
    call self%shapes%grid%close()
    call self%contacts%grid%close()
    if (allocated(self%interfaces)) call self%interfaces%grid%close()
    call agree_on_error(self, comm, error)
  end subroutine pictures_close

  !> The first failure of any file on any rank; the traffic of all files is counted.
  subroutine agree_on_error(self, comm, error)
    type(pictures_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm
    type(error_t), allocatable, intent(out) :: error

    call comm%collect(self%bodies%grid%file%ranks)
    call comm%collect(self%shapes%grid%file%ranks)
    call comm%collect(self%contacts%grid%file%ranks)
    if (allocated(self%interfaces)) call comm%collect(self%interfaces%grid%file%ranks)
    call first_error(self, error)
    call comm%agree(error)
  end subroutine agree_on_error

  !> The first failure of any file.
  subroutine first_error(self, error)
    type(pictures_t), intent(in) :: self
    type(error_t), allocatable, intent(out) :: error

    call take(self%bodies%grid, self%bodies%xdmf, error)
    if (.not. allocated(error)) call take(self%shapes%grid, self%shapes%xdmf, error)
    if (.not. allocated(error)) call take(self%contacts%grid, self%contacts%xdmf, error)
    if (.not. allocated(error) .and. allocated(self%interfaces)) call take(self%interfaces%grid, self%interfaces%xdmf, error)
  end subroutine first_error

  !> The first failure of a file or its sidecar.
  subroutine take(grid, xdmf, error)
    type(grid_file_t), intent(in) :: grid
    type(xdmf_t), intent(in) :: xdmf
    type(error_t), allocatable, intent(out) :: error

    if (allocated(grid%file%error)) then
      error = grid%file%error
    else if (allocated(xdmf%error)) then
      error = xdmf%error
    end if
  end subroutine take
end module sg_pictures
