!> field_1.vtkhdf and so on: coarse-grained fields in time, as VTKHDF image data (doc/guide/fields.md lists the datasets).
!!
!! The root rank writes them. `NSteps` is set last, after all else was flushed, as in the other pictures.
module sg_field_file
  use sg_error, only: error_t, exit_output, fail
  use sg_fields_on_grid, only: grid_field_t
  use sg_hdf5, only: hdf5_file_t, stored_double, stored_integer, stored_long, stored_single
  use sg_kinds, only: wp, i4, i8
  use sg_run_options, only: run_options_t
  use sg_system, only: file_exists
  use sg_text, only: to_text
  use sg_version, only: commit, version
  implicit none
  private
  public :: field_file_t, field_name

  !> Group that holds all that VTK reads; rows stored together in lists of one row per grid
  character(len=*), parameter :: root = '/VTKHDF/'
  integer, parameter :: step_chunk = 64
  !> Arrays of cells, and their components
  character(len=17), parameter :: array_names(7) = [character(len=17) :: 'density', 'solid_fraction', 'velocity', 'stress', &
                                                    'contact_density', 'fabric', 'velocity_gradient']
  integer, parameter :: components(7) = [1, 1, 3, 9, 1, 9, 9]

  !> The file of one field
  type :: field_file_t
    !> The HDF5 file; its `error` holds the first failure
    type(hdf5_file_t), private :: file
    !> Grids so far
    integer(i8), private :: grids = 0
  contains
    procedure :: open => field_file_open
    procedure :: add => field_file_add
    procedure :: close => field_file_close
  end type field_file_t

contains

  !> Name of the file of a field in the folder of the results.
  pure function field_name(number) result(name)
    integer, intent(in) :: number !! of the field in the deck, from 1
    character(len=:), allocatable :: name

    name = 'field_'//to_text(number)//'.vtkhdf'
  end function field_name

  !> Make the file, or go on with that of a stopped run: its grids up to a step stay, later ones are written over.
  subroutine field_file_open(self, path, field, options, step, error)
    class(field_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path !! path of the file
    type(grid_field_t), intent(in) :: field !! field that it is to hold
    type(run_options_t), intent(in) :: options !! precision, hash of the deck
    integer, intent(in) :: step !! step of the checkpoint; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    integer(i4), allocatable :: steps(:)
    integer(i8) :: grids

    if (step >= 0 .and. file_exists(path)) then
      call self%file%open(path, is_read_only=.false.)
      call self%file%look(root//'Steps', 'NSteps', grids)
      call self%file%get('/step', steps)
      if (.not. allocated(self%file%error) .and. (grids < 0 .or. grids > size(steps, kind=i8))) &
        call fail(self%file%error, 'cannot go on with this file, move it away: /step is not whole', file=path, code=exit_output)
      if (.not. allocated(self%file%error)) then
        self%grids = count(steps(:grids) <= step, kind=i8)
        call self%file%set(root//'Steps', 'NSteps', self%grids)
        call self%file%cut('/step', self%grids)
        call self%file%cut(root//'Steps/Values', self%grids)
      end if
    else
      call self%file%create(path)
      call make_header(self%file, field, options)
    end if
    if (allocated(self%file%error)) error = self%file%error
  end subroutine field_file_open

  !> Groups, attributes and empty datasets of a new file.
  subroutine make_header(file, field, options)
    type(hdf5_file_t), intent(inout) :: file
    type(grid_field_t), intent(in) :: field
    type(run_options_t), intent(in) :: options
    integer(i8) :: extent(6)
    integer :: i, storage

    extent = 0
    extent([2, 4, 6]) = int(field%options%cells, i8)
    call file%group('/VTKHDF')
    call file%set('/VTKHDF', 'Version', [2_i8, 0_i8])
    call file%set('/VTKHDF', 'Type', 'ImageData')
    call file%set('/VTKHDF', 'WholeExtent', extent)
    call file%set('/VTKHDF', 'Origin', field%options%lower)
    call file%set('/VTKHDF', 'Spacing', field%side)
    call file%set('/VTKHDF', 'Direction', [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp])
    call file%set('/', 'program', 'SplitGrain '//version//' ('//commit//')')
    if (allocated(options%deck_hash)) call file%set('/', 'deck_hash', options%deck_hash)
    call file%group(root//'CellData')
    call file%group(root//'Steps')
    call file%set(root//'Steps', 'NSteps', 0_i8)
    call file%declare(root//'Steps/Values', stored_double, 0, step_chunk, .false.)
    call file%declare('/step', stored_integer, 0, step_chunk, .false.)
    storage = merge(stored_single, stored_double, options%output_single)
    do i = 1, size(array_names)
      associate (cells => field%options%cells)
        if (components(i) == 1) then
          call file%declare_grid(root//'CellData/'//trim(array_names(i)), storage, cells)
        else
          call file%declare_grid(root//'CellData/'//trim(array_names(i)), storage, [components(i), cells])
        end if
      end associate
    end do
  end subroutine make_header

  !> Add a grid.
  subroutine field_file_add(self, field, values, step, time, error)
    class(field_file_t), intent(inout) :: self
    type(grid_field_t), intent(in) :: field !! the field
    real(wp), intent(in), contiguous :: values(:, :) !! of `finish`: sums per volume
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! its end [s]
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    integer, parameter :: square(9) = [1, 2, 3, 2, 4, 5, 3, 5, 6]
    real(wp) :: velocity(3, size(values, 2)), fabric(9, size(values, 2))
    integer :: c

    velocity = 0
    fabric = 0
    do c = 1, size(values, 2)
      if (values(1, c) > 0) velocity(:, c) = values(2:4, c)/values(1, c)
      if (values(15, c) > 0) fabric(:, c) = values(15 + square, c)/values(15, c)
    end do
    call put('density', values(1, :))
    call put('solid_fraction', values(5, :))
    call put('velocity', reshape(velocity, [size(velocity)]))
    call put('stress', reshape(values(6:14, :), [9*size(values, 2)]))
    call put('contact_density', values(15, :))
    call put('fabric', reshape(fabric, [size(fabric)]))
    call put('velocity_gradient', reshape(gradient(field, velocity, values(1, :)), [9*size(values, 2)]))
    call self%file%append('/step', [int(step, i4)])
    call self%file%append(root//'Steps/Values', [time])
    call self%file%flush()
    self%grids = self%grids + 1
    call self%file%set(root//'Steps', 'NSteps', self%grids)
    call self%file%flush()
    if (allocated(self%file%error)) error = self%file%error
  contains
    !> Write one array of the grid.
    subroutine put(name, numbers)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: numbers(:)
      real(wp), allocatable :: copy(:)

      copy = numbers
      call self%file%put_grid(root//'CellData/'//name, self%grids, copy)
    end subroutine put
  end subroutine field_file_add

  !> Velocity gradient L_ab = dv_a/dx_b [1/s] by differences of neighbouring cells that hold grains, central where both do; zero
  !! without any. Order of components: b runs first.
  pure function gradient(field, velocity, density) result(slope)
    type(grid_field_t), intent(in) :: field
    real(wp), intent(in) :: velocity(:, :), density(:)
    real(wp) :: slope(9, size(density))
    integer :: place(3), c, axis, side, found(2), step

    slope = 0
    associate (cells => field%options%cells)
      do c = 1, size(density)
        if (.not. density(c) > 0) cycle
        place = [modulo(c - 1, cells(1)), modulo((c - 1)/cells(1), cells(2)), (c - 1)/(cells(1)*cells(2))]
        do axis = 1, 3
          step = product(cells(:axis - 1))
          found = c
          do side = 1, 2
            if (place(axis) == merge(0, cells(axis) - 1, side == 1)) cycle
            if (density(c + merge(-step, step, side == 1)) > 0) found(side) = c + merge(-step, step, side == 1)
          end do
          if (found(1) == found(2)) cycle
          slope([axis, 3 + axis, 6 + axis], c) = (velocity(:, found(2)) - velocity(:, found(1)))/ &
                                                 (field%side(axis)*real((found(2) - found(1))/step, wp))
        end do
      end do
    end associate
  end function gradient

  !> Close the file.
  subroutine field_file_close(self)
    class(field_file_t), intent(inout) :: self

    call self%file%close()
  end subroutine field_file_close
end module sg_field_file
