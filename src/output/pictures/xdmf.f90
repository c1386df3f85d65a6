!> XDMF sidecar of a VTKHDF file, for programs too old to read that: text that points into its datasets.
!!
!! The list of steps is kept closed: each step overwrites the closing tags and writes them again behind itself, so
!! that the file is whole at any time and a step costs the same at the end of a run as at its beginning.
module sg_xdmf
  use sg_error, only: error_t
  use sg_hdf5, only: stored_byte, stored_double, stored_integer, stored_long, stored_single
  use sg_kinds, only: wp, i8
  use sg_pictures_grid, only: grid_array_t, grid_file_t, grid_root, group_names, on_field, on_points
  use sg_text, only: joined, read_lines, text_t, to_text
  use sg_text_files, only: overwrite_text, replace_file
  implicit none
  private
  public :: xdmf_t

  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: head = '<?xml version="1.0"?>'//nl//'<Xdmf Version="2.0">'//nl//'<Domain>'//nl// &
                                 '<Grid Name="steps" GridType="Collection" CollectionType="Temporal">'//nl
  character(len=*), parameter :: tail = '</Grid>'//nl//'</Domain>'//nl//'</Xdmf>'//nl
  !> Lines of the head
  integer, parameter :: head_lines = 4
  !> Last line of each step
  character(len=*), parameter :: step_end = '  </Grid>'

  !> One sidecar
  type :: xdmf_t
    !> Path of the sidecar, and name of the file beside it into which it points
    character(len=:), allocatable :: name, target
    !> Kind of cells in XDMF's words: 'Polyvertex', 'Polyline', or 'Mixed' with the dataset /XDMF/topology
    character(len=:), allocatable :: cells
    !> Place of the closing tags: bytes, from 1; 0 where there is no file yet, which is made with its first step
    integer(i8) :: end = 0
    !> Does this rank write it?
    logical :: is_root = .true.
    !> First failure; unallocated while all is well
    type(error_t), allocatable :: error
  contains
    procedure :: open => xdmf_open
    procedure :: add => xdmf_add
  end type xdmf_t

contains

  !> Make the sidecar; of an old one the first `n_steps` steps stay.
  subroutine xdmf_open(self, name, target, cells, n_steps, is_root)
    class(xdmf_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! path of the sidecar
    character(len=*), intent(in) :: target !! name of the VTKHDF file beside it
    character(len=*), intent(in) :: cells !! 'Polyvertex', 'Polyline' or 'Mixed'
    integer(i8), intent(in) :: n_steps !! steps to keep
    logical, intent(in) :: is_root !! does this rank write it?
    character(len=:), allocatable :: kept

    self%name = name
    self%target = target
    self%cells = cells
    self%is_root = is_root
    if (.not. is_root) return
    if (n_steps == 0) return
    kept = head//first_steps(name, n_steps)
    self%end = len(kept, kind=i8) + 1
    call replace_file(name, kept//tail, self%error)
  end subroutine xdmf_open

  !> Text of the first steps of a sidecar; fewer where it has not as many.
  function first_steps(name, n_steps) result(text)
    character(len=*), intent(in) :: name
    integer(i8), intent(in) :: n_steps
    character(len=:), allocatable :: text
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: unreadable
    integer :: i, last
    integer(i8) :: found

    text = ''
    call read_lines(name, lines, unreadable)
    if (allocated(unreadable)) return
    found = 0
    last = 0
    do i = 1, size(lines)
      if (lines(i)%s /= step_end .or. found == n_steps) cycle
      found = found + 1
      last = i
    end do
    text = joined(lines(head_lines + 1:last), nl)
    if (last > 0) text = text//nl
  end function first_steps

  !> Add the step that the grid has just finished.
  subroutine xdmf_add(self, grid, time)
    class(xdmf_t), intent(inout) :: self
    type(grid_file_t), intent(in) :: grid !! the file pointed into
    real(wp), intent(in) :: time !! [s]
    character(len=:), allocatable :: text
    integer :: a

    if (allocated(self%error) .or. allocated(grid%file%error) .or. .not. self%is_root) return
    text = '  <Grid Name="step" GridType="Uniform">'//nl//'    <Time Value="'//to_text(time)//'"/>'//nl
    if (grid%n_points == 0) then
      text = text//nothing()
    else
      text = text//topology(self, grid)//geometry(self, grid)
    end if
    do a = 1, size(grid%arrays)
      ! XDMF has no quaternions, and its matrices are read in more than one way.
      if (grid%arrays(a)%where == on_field .or. grid%arrays(a)%components > 3) cycle
      text = text//attribute(self, grid, grid%arrays(a))
    end do
    text = text//step_end//nl
    if (self%end == 0) then
      text = head//text
      call replace_file(self%name, text//tail, self%error)
      self%end = 1
    else
      call overwrite_text(self%name, self%end, text//tail, self%error)
    end if
    self%end = self%end + len(text, kind=i8)
  end subroutine xdmf_add

  !> A step without cells: a line of no length, since XDMF has no empty grid.
  function nothing() result(text)
    character(len=:), allocatable :: text

    text = '    <Topology TopologyType="Polyline" NumberOfElements="1" NodesPerElement="2">'//nl// &
           '      <DataItem Dimensions="1 2" NumberType="Int" Format="XML">0 1</DataItem>'//nl//'    </Topology>'//nl// &
           '    <Geometry GeometryType="XYZ">'//nl// &
           '      <DataItem Dimensions="2 3" NumberType="Float" Format="XML">0 0 0 0 0 0</DataItem>'//nl//'    </Geometry>'//nl
  end function nothing

  !> The cells of a step.
  function topology(self, grid) result(text)
    type(xdmf_t), intent(in) :: self
    type(grid_file_t), intent(in) :: grid
    character(len=:), allocatable :: text

    text = '    <Topology TopologyType="'//self%cells//'" NumberOfElements="'//to_text(grid%n_cells)//'"'
    if (self%cells == 'Mixed') then
      ! Before the points of each cell stand its kind and their number.
      text = text//'>'//nl//slab(self, '/XDMF/topology', stored_integer, 1, 0_i8, grid%n_ids + 2*grid%n_cells)
    else
      text = text//' NodesPerElement="'//to_text(grid%n_ids/grid%n_cells)//'">'//nl// &
             slab(self, grid_root//'Connectivity', stored_long, 1, grid%first_id, grid%n_ids)
    end if
    text = text//'    </Topology>'//nl
  end function topology

  !> The points of a step.
  function geometry(self, grid) result(text)
    type(xdmf_t), intent(in) :: self
    type(grid_file_t), intent(in) :: grid
    character(len=:), allocatable :: text

    text = '    <Geometry GeometryType="XYZ">'//nl// &
           slab(self, grid_root//'Points', grid%stored_real, 3, grid%first_point, grid%n_points)//'    </Geometry>'//nl
  end function geometry

  !> One array of a step.
  function attribute(self, grid, array) result(text)
    type(xdmf_t), intent(in) :: self
    type(grid_file_t), intent(in) :: grid
    type(grid_array_t), intent(in) :: array
    character(len=:), allocatable :: text, kind, centre

    kind = 'Scalar'
    if (array%components == 3) kind = 'Vector'
    centre = 'Cell'
    if (array%where == on_points) centre = 'Node'
    text = '    <Attribute Name="'//array%name//'" AttributeType="'//kind//'" Center="'//centre//'">'//nl// &
           slab(self, grid_root//trim(group_names(array%where))//'/'//array%name, array%storage, max(1, array%components), &
                array%first, merge(grid%n_points, grid%n_cells, array%where == on_points))//'    </Attribute>'//nl
  end function attribute

  !> Rows `first` + 1 to `first` + `rows` of a dataset.
  function slab(self, path, storage, components, first, rows) result(text)
    type(xdmf_t), intent(in) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: storage, components
    integer(i8), intent(in) :: first, rows
    character(len=:), allocatable :: text, shape, all, selection

    shape = to_text(rows)
    all = to_text(first + rows)
    if (components > 1) then
      selection = '3 2">'//to_text(first)//' 0 1 1 '//shape//' '//to_text(components)
      shape = shape//' '//to_text(components)
      all = all//' '//to_text(components)
    else
      selection = '3 1">'//to_text(first)//' 1 '//shape
    end if
    text = '      <DataItem ItemType="HyperSlab" Type="HyperSlab" Dimensions="'//shape//'">'//nl// &
           '        <DataItem Format="XML" Dimensions="'//selection//'</DataItem>'//nl// &
           '        <DataItem Format="HDF" Dimensions="'//all//'" '//number_type(storage)//'>'//self%target//':'//path// &
           '</DataItem>'//nl//'      </DataItem>'//nl
  end function slab

  !> How numbers are stored, in XDMF's words.
  function number_type(storage) result(text)
    integer, intent(in) :: storage
    character(len=:), allocatable :: text

    select case (storage)
    case (stored_double)
      text = 'NumberType="Float" Precision="8"'
    case (stored_single)
      text = 'NumberType="Float" Precision="4"'
    case (stored_long)
      text = 'NumberType="Int" Precision="8"'
    case (stored_byte)
      text = 'NumberType="UChar" Precision="1"'
    case default
      text = 'NumberType="Int" Precision="4"'
    end select
  end function number_type
end module sg_xdmf
