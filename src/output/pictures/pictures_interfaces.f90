!> Picture of the interfaces: one point per pair of bodies, at the centre of pressure, with the resultant of its contacts. Only runs
!! with `[[interface]]` have it; the numbers are those of interfaces.csv. All ranks hold all pairs; the root rank draws them.
module sg_pictures_interfaces
  use sg_body_interfaces, only: interface_columns, interfaces_t
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4, i8
  use sg_pictures_grid, only: grid_file_t, on_cells, on_field, vtk_empty, vtk_vertex
  use sg_run_options, only: run_options_t
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: interfaces_picture_t, interfaces_picture_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: interfaces_picture_name = 'interfaces.vtkhdf'

  !> The file `interfaces.vtkhdf` and its sidecar
  type :: interfaces_picture_t
    !> The file
    type(grid_file_t) :: grid
    !> Its sidecar `interfaces.xmf`
    type(xdmf_t) :: xdmf
  contains
    procedure :: open => interfaces_open
    procedure :: write => interfaces_write
  end type interfaces_picture_t

contains

  !> Make the file, or go on with it.
  subroutine interfaces_open(self, options, resumed_step, comm)
    class(interfaces_picture_t), intent(inout) :: self
    type(run_options_t), intent(in) :: options !! folder and precision
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run
    type(comm_t), intent(inout) :: comm !! ranks that share the scene

    call self%grid%open(options%folder//'/'//interfaces_picture_name, options, resumed_step, comm)
    if (allocated(self%grid%file%error)) return
    call self%xdmf%open(options%folder//'/interfaces.xmf', interfaces_picture_name, 'Polyvertex', self%grid%n_steps, &
                        comm%rank == 0)
  end subroutine interfaces_open

  !> Add a step.
  subroutine interfaces_write(self, interfaces, dimension, time, step)
    class(interfaces_picture_t), intent(inout) :: self
    type(interfaces_t), intent(in) :: interfaces !! pairs of the step, measured; unmeasured ones are none
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    integer(i4), allocatable :: body(:, :)
    real(wp), allocatable :: value(:, :)
    integer(i8) :: no_ids(0)
    integer :: i, total, n

    call take_rows(interfaces, dimension, self%grid%file%ranks%rank == 0, body, value, total)
    n = size(value, 2)
    call self%grid%put(on_field, 'ninterfaces', [int(total, i4)])
    if (total > 0) then
      call self%grid%part(n, [(int(i, i8), i=0, n - 1)], spread(1_i4, 1, n), spread(vtk_vertex, 1, n))
      call self%grid%place(vectors(value, 1, dimension))
    else
      ! VTK 9.5 and 9.6 misread a step without cells: one cell of type "empty" draws nothing.
      call self%grid%part(0, no_ids, spread(0_i4, 1, n), spread(vtk_empty, 1, n))
      call self%grid%place(vectors(value(:, :0), 1, dimension))
    end if
    call write_arrays(self%grid, body, value, dimension)
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine interfaces_write

  !> Rows that this rank draws: on the root rank all of them, or one of zeros where there are none.
  pure subroutine take_rows(interfaces, dimension, is_root, body, value, total)
    type(interfaces_t), intent(in) :: interfaces
    integer, intent(in) :: dimension
    logical, intent(in) :: is_root
    integer(i4), allocatable, intent(out) :: body(:, :)
    real(wp), allocatable, intent(out) :: value(:, :)
    integer, intent(out) :: total
    integer :: rows

    total = 0
    if (allocated(interfaces%value)) total = size(interfaces%value, 2)
    rows = merge(max(1, total), 0, is_root)
    allocate (body(2, rows), source=0_i4)
    allocate (value(size(interface_columns(dimension)), rows), source=0.0_wp)
    if (total == 0 .or. .not. is_root) return
    body = interfaces%body
    value = interfaces%value
  end subroutine take_rows

  !> All numbers of the pairs: vectors first, then the two forces, the moment, eccentricity, area and number of contacts.
  subroutine write_arrays(grid, body, value, dimension)
    type(grid_file_t), intent(inout) :: grid
    integer(i4), intent(in) :: body(:, :)
    real(wp), intent(in) :: value(:, :)
    integer, intent(in) :: dimension
    integer :: last, n

    last = size(value, 1)
    call grid%put(on_cells, 'first', pack(body(1, :), .true.))
    call grid%put(on_cells, 'second', pack(body(2, :), .true.))
    call grid%put(on_cells, 'middle', vectors(value, dimension + 1, dimension))
    call grid%put(on_cells, 'normal', vectors(value, 2*dimension + 1, dimension))
    call grid%put(on_cells, 'force', vectors(value, 3*dimension + 1, dimension))
    call grid%put(on_cells, 'normal_force', pack(value(4*dimension + 1, :), .true.))
    call grid%put(on_cells, 'tangential_force', pack(value(4*dimension + 2, :), .true.))
    if (dimension == 2) then
      call grid%put(on_cells, 'moment', pack(value(11, :), .true.))
    else
      call grid%put(on_cells, 'moment', vectors(value, 15, 3))
    end if
    call grid%put(on_cells, 'eccentricity', pack(value(last - 2, :), .true.))
    call grid%put(on_cells, 'area', pack(value(last - 1, :), .true.))
    call grid%put(on_cells, 'contacts', [(nint(value(last, n), i4), n=1, size(value, 2))])
  end subroutine write_arrays

  !> Vectors that stand in columns from a place on, with a third component of zero in the plane.
  pure function vectors(value, at, components) result(space)
    real(wp), intent(in) :: value(:, :)
    integer, intent(in) :: at, components
    real(wp), allocatable :: space(:, :)

    allocate (space(3, size(value, 2)), source=0.0_wp)
    space(:components, :) = value(at:at + components - 1, :)
  end function vectors
end module sg_pictures_interfaces
