!> One VTKHDF file: a single unstructured grid that changes with time, one part a step.
!!
!! A step goes: `part` (cells, where they change), `place` (points), `put` (arrays), `finish`. A step's rows follow
!! those of the steps before, and /VTKHDF/Steps holds where each begins. `NSteps` is set last, after all else has
!! been flushed, so that a reader that looks on, or comes after a kill, finds whole steps. doc/guide/files.md lists
!! the datasets.
!!
!! Ranks share the file: each gives its own points and cells, which follow those of lower ranks; fields of the step are the
!! same on all. There is one part whatever the number of ranks, as some readers of VTK fail on several.
module sg_pictures_grid
  use sg_comm, only: comm_t
  use sg_error, only: exit_output, fail
  use sg_hdf5, only: hdf5_file_t, stored_byte, stored_double, stored_integer, stored_long, stored_single
  use sg_kinds, only: wp, i4, i8
  use sg_run_options, only: run_options_t
  use sg_settle_file, only: part_of
  use sg_system, only: is_link, remove_file
  use sg_version, only: commit, version
  implicit none
  private
  public :: grid_file_t, grid_array_t, grid_root, on_points, on_cells, on_field, group_names
  public :: vtk_empty, vtk_vertex, vtk_line, vtk_poly_line, vtk_polygon
  public :: put_presence

  !> Group that holds all that VTK reads
  character(len=*), parameter :: grid_root = '/VTKHDF/'
  !> What an array belongs to: the points, the cells, or the step as a whole
  integer, parameter :: on_points = 1, on_cells = 2, on_field = 3
  !> Groups of these arrays
  character(len=9), parameter :: group_names(3) = [character(len=9) :: 'PointData', 'CellData', 'FieldData']
  !> Cell types of VTK
  integer(i4), parameter :: vtk_empty = 0, vtk_vertex = 1, vtk_line = 3, vtk_poly_line = 4, vtk_polygon = 7

  !> Rows stored together in lists of one row a step; least and most in other datasets
  integer, parameter :: step_chunk = 64, least_chunk = 256, most_chunk = 32768

  !> One array of the file
  type :: grid_array_t
    !> Its name
    character(len=:), allocatable :: name
    !> What it belongs to, one of `on_*`
    integer :: where = 0
    !> Numbers of a row; 0 for a plain list
    integer :: components = 0
    !> How numbers are stored, one of `stored_*`
    integer :: storage = stored_double
    !> Row at which the present step begins, and rows so far
    integer(i8) :: first = 0, rows = 0
  end type grid_array_t

  !> A file of this kind
  type :: grid_file_t
    !> The HDF5 file; its `error` holds the first failure
    type(hdf5_file_t) :: file
    !> Complete steps
    integer(i8) :: n_steps = 0
    !> Parts, points, cells and connectivity ids so far
    integer(i8) :: parts = 0, points = 0, cells = 0, ids = 0
    !> First point, first cell and first connectivity id of the present step
    integer(i8) :: first_point = 0, first_cell = 0, first_id = 0
    !> Points, cells and connectivity ids of the present part, of all ranks
    integer(i8) :: n_points = 0, n_cells = 0, n_ids = 0
    !> In a file to go on with: points, cells and fields of the last step that stayed
    integer(i8) :: kept(3) = 0
    !> Path of the file; it has this name when it holds a step
    character(len=:), allocatable :: path
    !> How reals are stored, and are chunks compressed?
    integer :: stored_real = stored_double
    logical :: is_compressed = .false.
    !> All arrays
    type(grid_array_t), allocatable :: arrays(:)
  contains
    procedure :: open => grid_open
    procedure :: part => grid_part
    procedure :: place => grid_place
    procedure, private :: put_reals, put_real_records, put_integers
    !> Store an array of the step; one that `is_static` is stored at the first step and repeated
    generic :: put => put_reals, put_real_records, put_integers
    procedure :: finish => grid_finish
    procedure :: close => grid_close
  end type grid_file_t

contains

  !> Make the file, or go on with one that a stopped run left: its pictures up to `resumed_step` stay.
  subroutine grid_open(self, path, options, resumed_step, comm)
    class(grid_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path !! path of the file
    type(run_options_t), intent(in) :: options !! precision, compression, hash of the deck
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run
    type(comm_t), intent(inout) :: comm !! ranks that share the file
    logical :: exists

    self%stored_real = merge(stored_single, stored_double, options%output_single)
    self%is_compressed = options%output_compressed
    allocate (self%arrays(0))
    self%path = path
    inquire (file=path, exist=exists)
    call comm%broadcast(exists, 0)
    call self%file%share(comm)
    if (exists .and. resumed_step >= 0) call resume(self, path, resumed_step)
    if (allocated(self%file%error) .or. self%n_steps > 0) return
    call self%file%close()
    if (comm%rank == 0) call remove_file(part_of(path))
    call self%file%create(part_of(path))
    call make_header(self, options)
  end subroutine grid_open

  !> Groups, attributes and empty datasets of a new file.
  subroutine make_header(self, options)
    type(grid_file_t), intent(inout) :: self
    type(run_options_t), intent(in) :: options
    character(len=*), parameter :: steps = grid_root//'Steps'
    integer :: i

    call self%file%group('/VTKHDF')
    call self%file%set('/VTKHDF', 'Version', [2_i8, 0_i8])
    call self%file%set('/VTKHDF', 'Type', 'UnstructuredGrid')
    call self%file%set('/', 'program', 'SplitGrain '//version//' ('//commit//')')
    if (allocated(options%deck_hash)) call self%file%set('/', 'deck_hash', options%deck_hash)
    call self%file%set('/', 'real_bytes', merge(4_i8, 8_i8, options%output_single))
    call self%file%group(steps)
    call self%file%set(steps, 'NSteps', 0_i8)
    do i = 1, size(group_names)
      call self%file%group(grid_root//trim(group_names(i)))
      call self%file%group(steps//'/'//trim(group_names(i))//'Offsets')
    end do
    call self%file%group(steps//'/FieldDataSizes')
    call declare_small(self, 'NumberOfPoints', stored_long, 0)
    call declare_small(self, 'NumberOfCells', stored_long, 0)
    call declare_small(self, 'NumberOfConnectivityIds', stored_long, 0)
    call declare_small(self, 'Steps/Values', stored_double, 0)
    call declare_small(self, 'Steps/PartOffsets', stored_long, 0)
    call declare_small(self, 'Steps/NumberOfParts', stored_long, 0)
    call declare_small(self, 'Steps/PointOffsets', stored_long, 0)
    call declare_small(self, 'Steps/CellOffsets', stored_long, 1)
    call declare_small(self, 'Steps/ConnectivityIdOffsets', stored_long, 1)
  end subroutine make_header

  !> Make a dataset that grows by a row a step.
  subroutine declare_small(self, name, storage, components)
    type(grid_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: storage, components

    call self%file%declare(grid_root//name, storage, components, step_chunk, .false.)
  end subroutine declare_small

  !> Make a dataset for the numbers of points or cells, unless it exists.
  subroutine declare_large(self, name, storage, components, rows)
    type(grid_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: storage, components
    integer(i8), intent(in) :: rows

    if (self%file%has(grid_root//name)) return
    call self%file%declare(grid_root//name, storage, components, max(least_chunk, int(min(rows, int(most_chunk, i8)))), &
                           self%is_compressed)
  end subroutine declare_large

  !> Open an old file and drop what came after a step.
  subroutine resume(self, path, resumed_step)
    type(grid_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: resumed_step
    integer(i8) :: n_steps, real_bytes
    integer(i4), allocatable :: step(:)
    character(len=*), parameter :: steps = grid_root//'Steps'

    call self%file%open(path, is_read_only=.false.)
    if (is_link(path) .and. .not. allocated(self%file%error)) &
      call fail(self%file%error, 'cannot go on with this file: it is a symbolic link', file=path, code=exit_output)
    if (allocated(self%file%error)) &
      self%file%error%message = 'cannot go on with this file, move it away: '//self%file%error%message
    call self%file%look(steps, 'NSteps', n_steps)
    call self%file%look('/', 'real_bytes', real_bytes)
    self%stored_real = merge(stored_single, stored_double, real_bytes == 4)
    if (allocated(self%file%error) .or. n_steps == 0) return
    call self%file%get(grid_root//'FieldData/step', step)
    if (n_steps < 0 .or. n_steps > size(step, kind=i8)) call not_whole(self, 'FieldData/step')
    if (allocated(self%file%error)) return
    self%n_steps = count(step(:n_steps) <= resumed_step, kind=i8)
    if (self%n_steps == 0) return
    call self%file%set(steps, 'NSteps', self%n_steps)
    call cut_back(self)
  end subroutine resume

  !> Cut points, cells and the lists of steps back to the `n_steps` that stay.
  subroutine cut_back(self)
    type(grid_file_t), intent(inout) :: self
    integer(i8) :: n

    n = self%n_steps
    self%parts = entry_of(self, 'Steps/PartOffsets', n) + 1
    self%n_points = entry_of(self, 'NumberOfPoints', self%parts)
    self%n_cells = entry_of(self, 'NumberOfCells', self%parts)
    self%n_ids = entry_of(self, 'NumberOfConnectivityIds', self%parts)
    self%kept = [self%n_points, self%n_cells, 1_i8]
    self%first_cell = entry_of(self, 'Steps/CellOffsets', n)
    self%first_id = entry_of(self, 'Steps/ConnectivityIdOffsets', n)
    self%points = entry_of(self, 'Steps/PointOffsets', n) + self%n_points
    self%cells = self%first_cell + self%n_cells
    self%ids = self%first_id + self%n_ids
    call keep(self, 'NumberOfPoints', self%parts)
    call keep(self, 'NumberOfCells', self%parts)
    call keep(self, 'NumberOfConnectivityIds', self%parts)
    call keep(self, 'Steps/Values', n)
    call keep(self, 'Steps/PartOffsets', n)
    call keep(self, 'Steps/NumberOfParts', n)
    call keep(self, 'Steps/PointOffsets', n)
    call keep(self, 'Steps/CellOffsets', n)
    call keep(self, 'Steps/ConnectivityIdOffsets', n)
    call keep(self, 'Points', self%points)
    call keep(self, 'Types', self%cells)
    call keep(self, 'Offsets', self%cells + self%parts)
    call keep(self, 'Connectivity', self%ids)
  end subroutine cut_back

  !> An entry of a list of long integers, counted from 1; 0 after a failure.
  integer(i8) function entry_of(self, name, n)
    type(grid_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i8), intent(in) :: n
    integer(i8), allocatable :: list(:)

    entry_of = 0
    call self%file%get(grid_root//name, list)
    if (n > size(list, kind=i8)) then
      call not_whole(self, name)
    else
      entry_of = list(n)
    end if
  end function entry_of

  !> Drop the rows of a dataset that belong to later steps.
  subroutine keep(self, name, rows)
    type(grid_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i8), intent(in) :: rows

    if (self%file%rows(grid_root//name) < rows) call not_whole(self, name)
    call self%file%cut(grid_root//name, rows)
  end subroutine keep

  !> Report that a file to go on with lacks rows.
  subroutine not_whole(self, name)
    type(grid_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name

    if (allocated(self%file%error)) return
    call fail(self%file%error, 'cannot go on with this file: '//name//' is not whole', file=self%file%name, code=exit_output)
  end subroutine not_whole

  !> Store the cells of the step and of those that follow.
  subroutine grid_part(self, n_points, connectivity, sizes, types)
    class(grid_file_t), intent(inout) :: self
    integer, intent(in) :: n_points !! number of points of this rank
    integer(i8), intent(in), contiguous :: connectivity(:) !! points of the cells, from 0 over all ranks
    integer(i4), intent(in) :: sizes(:) !! points of each cell
    integer(i4), intent(in), contiguous :: types(:) !! types of the cells, one of `vtk_*`

    self%parts = self%parts + 1
    self%n_points = self%file%total(n_points)
    self%n_cells = self%file%total(size(types))
    self%n_ids = self%file%total(size(connectivity))
    self%first_cell = self%cells
    self%first_id = self%ids
    self%cells = self%cells + self%n_cells
    self%ids = self%ids + self%n_ids
    call declare_large(self, 'Connectivity', stored_long, 0, self%n_ids)
    call declare_large(self, 'Offsets', stored_long, 0, self%n_cells + 1)
    call declare_large(self, 'Types', stored_byte, 0, self%n_cells)
    call self%file%append(grid_root//'NumberOfPoints', [self%n_points], is_common=.true.)
    call self%file%append(grid_root//'NumberOfCells', [self%n_cells], is_common=.true.)
    call self%file%append(grid_root//'NumberOfConnectivityIds', [self%n_ids], is_common=.true.)
    call self%file%append(grid_root//'Connectivity', connectivity)
    call append_offsets(self, sizes)
    call self%file%append(grid_root//'Types', types)
  end subroutine grid_part

  !> Store where each cell begins in the connectivity, from 0, and after the last rank's at last their number.
  subroutine append_offsets(self, sizes)
    type(grid_file_t), intent(inout) :: self
    integer(i4), intent(in) :: sizes(:)
    integer(i8) :: offsets(size(sizes) + 1), total
    integer :: c, n

    call self%file%ranks%before(sum(int(sizes, i8)), offsets(1), total)
    do c = 1, size(sizes)
      offsets(c + 1) = offsets(c) + int(sizes(c), i8)
    end do
    n = size(sizes)
    if (self%file%ranks%rank == self%file%ranks%size - 1) n = n + 1
    call self%file%append(grid_root//'Offsets', offsets(:n))
  end subroutine append_offsets

  !> Store the points of the step.
  subroutine grid_place(self, points)
    class(grid_file_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: points(:, :) !! of this rank [m], shape (3, points)
    integer(i8) :: total

    total = self%file%total(size(points, 2))
    call declare_large(self, 'Points', self%stored_real, 3, total)
    call self%file%append(grid_root//'Points', points)
    self%first_point = self%points
    self%points = self%points + total
  end subroutine grid_place

  !> Store a list of reals.
  subroutine put_reals(self, where, name, values, is_static)
    class(grid_file_t), intent(inout) :: self
    integer, intent(in) :: where !! one of `on_*`
    character(len=*), intent(in) :: name !! of the array
    real(wp), intent(in), contiguous :: values(:) !! one a point, a cell or a step
    logical, intent(in), optional :: is_static !! the same at all steps?
    integer :: a

    call array_of(self, where, name, 0, merge(stored_double, self%stored_real, where == on_field), size(values), a)
    if (.not. is_stored(self, a, size(values), is_static)) &
      call self%file%append(path_of(self%arrays(a)), values, is_common=where == on_field)
  end subroutine put_reals

  !> Store vectors.
  subroutine put_real_records(self, where, name, values, is_static)
    class(grid_file_t), intent(inout) :: self
    integer, intent(in) :: where !! one of `on_*`
    character(len=*), intent(in) :: name !! of the array
    real(wp), intent(in), contiguous :: values(:, :) !! shape (components, points or cells)
    logical, intent(in), optional :: is_static !! the same at all steps?
    integer :: a

    call array_of(self, where, name, size(values, 1), self%stored_real, size(values, 2), a)
    if (.not. is_stored(self, a, size(values, 2), is_static)) &
      call self%file%append(path_of(self%arrays(a)), values, is_common=where == on_field)
  end subroutine put_real_records

  !> Store a list of integers.
  subroutine put_integers(self, where, name, values, is_static, is_byte)
    class(grid_file_t), intent(inout) :: self
    integer, intent(in) :: where !! one of `on_*`
    character(len=*), intent(in) :: name !! of the array
    integer(i4), intent(in), contiguous :: values(:) !! one a point, a cell or a step
    logical, intent(in), optional :: is_static !! the same at all steps?
    logical, intent(in), optional :: is_byte !! from 0 to 255, and stored as a byte?
    integer :: a, storage

    storage = stored_integer
    if (present(is_byte)) storage = merge(stored_byte, stored_integer, is_byte)
    call array_of(self, where, name, 0, storage, size(values), a)
    if (.not. is_stored(self, a, size(values), is_static)) &
      call self%file%append(path_of(self%arrays(a)), values, is_common=where == on_field)
  end subroutine put_integers

  !> Store which points or cells are of bodies that are there; VTK hides the others.
  subroutine put_presence(grid, where, is_present)
    type(grid_file_t), intent(inout) :: grid !! file of the step
    integer, intent(in) :: where !! `on_points` or `on_cells`
    logical, intent(in) :: is_present(:) !! is the body of each one there?
    integer(i4), parameter :: hidden(2) = [2_i4, 32_i4]

    call grid%put(where, 'is_present', merge(1_i4, 0_i4, is_present))
    call grid%put(where, 'vtkGhostType', merge(0_i4, hidden(where), is_present), is_byte=.true.)
  end subroutine put_presence

  !> Path of an array's numbers.
  pure function path_of(array) result(path)
    type(grid_array_t), intent(in) :: array
    character(len=:), allocatable :: path

    path = grid_root//trim(group_names(array%where))//'/'//array%name
  end function path_of

  !> Is an array in the file already for this step? If not, count its new rows.
  logical function is_stored(self, a, rows, is_static)
    type(grid_file_t), intent(inout) :: self
    integer, intent(in) :: a, rows
    logical, intent(in), optional :: is_static

    is_stored = .false.
    if (present(is_static)) is_stored = is_static .and. self%n_steps > 0
    if (is_stored) return
    self%arrays(a)%first = self%arrays(a)%rows
    self%arrays(a)%rows = self%arrays(a)%rows + rows_of_all(self, self%arrays(a)%where, rows)
  end function is_stored

  !> Rows of an array on all ranks: those of the points or cells of the present part.
  pure integer(i8) function rows_of_all(self, where, rows)
    type(grid_file_t), intent(in) :: self
    integer, intent(in) :: where, rows

    rows_of_all = int(rows, i8)
    if (self%file%ranks%size == 1) return
    if (where == on_points) rows_of_all = self%n_points
    if (where == on_cells) rows_of_all = self%n_cells
  end function rows_of_all

  !> Index of an array, which is made at the first step, or found again in a file to go on with.
  subroutine array_of(self, where, name, components, storage, rows, a)
    type(grid_file_t), intent(inout) :: self
    integer, intent(in) :: where, components, storage, rows
    character(len=*), intent(in) :: name
    integer, intent(out) :: a
    type(grid_array_t) :: array

    do a = 1, size(self%arrays)
      if (self%arrays(a)%where == where .and. self%arrays(a)%name == name) return
    end do
    array%name = name
    array%where = where
    array%components = components
    array%storage = storage
    if (self%n_steps == 0) then
      call declare_array(self, array, rows)
    else
      call find_array(self, array)
    end if
    self%arrays = [self%arrays, array]
  end subroutine array_of

  !> Make the datasets of an array.
  subroutine declare_array(self, array, rows)
    type(grid_file_t), intent(inout) :: self
    type(grid_array_t), intent(in) :: array
    integer, intent(in) :: rows
    character(len=:), allocatable :: group

    group = trim(group_names(array%where))
    call declare_small(self, 'Steps/'//group//'Offsets/'//array%name, stored_long, 0)
    if (array%where == on_field) then
      call declare_small(self, group//'/'//array%name, array%storage, array%components)
      call declare_small(self, 'Steps/FieldDataSizes/'//array%name, stored_long, 2)
    else
      call declare_large(self, group//'/'//array%name, array%storage, array%components, rows_of_all(self, array%where, rows))
    end if
  end subroutine declare_array

  !> Find an array in a file to go on with, and drop its rows of later steps.
  subroutine find_array(self, array)
    type(grid_file_t), intent(inout) :: self
    type(grid_array_t), intent(inout) :: array
    character(len=:), allocatable :: group

    group = trim(group_names(array%where))
    if (.not. self%file%has(grid_root//group//'/'//array%name)) call not_whole(self, group//'/'//array%name)
    array%first = entry_of(self, 'Steps/'//group//'Offsets/'//array%name, self%n_steps)
    array%rows = array%first + self%kept(array%where)
    call keep(self, group//'/'//array%name, array%rows)
    call keep(self, 'Steps/'//group//'Offsets/'//array%name, self%n_steps)
    if (array%where == on_field) call keep(self, 'Steps/FieldDataSizes/'//array%name, self%n_steps)
  end subroutine find_array

  !> End the step: store where its rows begin, flush, and only then count it.
  subroutine grid_finish(self, time, step)
    class(grid_file_t), intent(inout) :: self
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    character(len=*), parameter :: steps = grid_root//'Steps/'
    integer :: a

    call self%put(on_field, 'step', [int(step, i4)])
    call self%put(on_field, 'time', [time])
    do a = 1, size(self%arrays)
      associate (array => self%arrays(a))
        call self%file%append(steps//trim(group_names(array%where))//'Offsets/'//array%name, [array%first], is_common=.true.)
        if (array%where == on_field) call self%file%append(steps//'FieldDataSizes/'//array%name, [1_i8, 1_i8], is_common=.true.)
      end associate
    end do
    call self%file%append(steps//'PartOffsets', [self%parts - 1], is_common=.true.)
    call self%file%append(steps//'NumberOfParts', [1_i8], is_common=.true.)
    call self%file%append(steps//'PointOffsets', [self%first_point], is_common=.true.)
    call self%file%append(steps//'CellOffsets', [self%first_cell], is_common=.true.)
    call self%file%append(steps//'ConnectivityIdOffsets', [self%first_id], is_common=.true.)
    call self%file%append(steps//'Values', [time], is_common=.true.)
    call self%file%flush()
    self%n_steps = self%n_steps + 1
    call self%file%set(grid_root//'Steps', 'NSteps', self%n_steps)
    call self%file%flush()
    if (.not. allocated(self%file%error) .and. self%file%name /= self%path) call self%file%rename(self%path)
  end subroutine grid_finish

  !> Close the file.
  subroutine grid_close(self)
    class(grid_file_t), intent(inout) :: self

    call self%file%close()
    if (allocated(self%path) .and. self%file%ranks%rank == 0) call remove_file(part_of(self%path))
    if (allocated(self%arrays)) deallocate (self%arrays)
  end subroutine grid_close
end module sg_pictures_grid
