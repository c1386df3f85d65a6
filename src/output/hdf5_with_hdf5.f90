!> HDF5 files by the HDF5 library (1.10.7 or later), through its serial driver: MPI need not be started.
submodule(sg_hdf5) hdf5_with_hdf5
  use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_f_pointer, c_funloc, c_funptr, c_int, c_int64_t, c_loc, &
                                         c_null_char, c_null_ptr, c_ptr, c_size_t
  use hdf5, only: h5_integer_kind, h5aclose_f, h5acreate_f, h5aexists_f, h5aget_type_f, h5aopen_f, h5aread_f, h5awrite_f, &
                  h5dclose_f, h5dcreate_f, h5dget_space_f, h5dont_atexit_f, h5dopen_f, h5dread_f, h5dset_extent_f, h5dwrite_f, &
                  h5eset_auto_f, h5f_acc_rdonly_f, h5f_acc_rdwr_f, h5f_acc_trunc_f, h5f_close_strong_f, h5f_libver_earliest_f, &
                  h5f_libver_v110_f, h5f_scope_global_f, h5fclose_f, h5fcreate_f, h5fflush_f, h5fopen_f, h5gclose_f, &
                  h5gcreate_f, h5iis_valid_f, h5kind_to_type, h5lexists_f, h5oclose_f, h5oopen_f, h5open_f, h5p_dataset_create_f, &
                  h5p_file_access_f, h5pclose_f, h5pcreate_f, h5pset_chunk_f, h5pset_deflate_f, h5pset_fclose_degree_f, &
                  h5pset_libver_bounds_f, h5s_scalar_f, h5s_select_set_f, h5s_unlimited_f, h5sclose_f, h5screate_f, &
                  h5screate_simple_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
                  h5sselect_hyperslab_f, h5t_c_s1, h5t_ieee_f32le, h5t_ieee_f64le, h5t_native_double, &
                  h5t_native_integer, h5t_std_i32le, h5t_std_i64le, h5t_std_u8le, h5t_str_nullpad_f, h5tclose_f, &
                  h5tcopy_f, h5tget_size_f, h5tset_size_f, h5tset_strpad_f, hid_t, hsize_t, size_t
  use sg_error, only: exit_output, fail
  implicit none

  !> gzip level: beyond it files hardly shrink, and writing takes longer
  integer, parameter :: gzip_level = 4

  !> What the library's stack of errors tells of one failure
  type, bind(c) :: stacked_error_t
    integer(c_int64_t) :: class, major, minor
    integer(c_int) :: line
    type(c_ptr) :: procedure, file, description
  end type stacked_error_t

  !> Innermost reason of a failure, as found by `keep_reason`
  type, bind(c) :: reason_t
    character(kind=c_char) :: text(400) = c_null_char
  end type reason_t

  ! The Fortran interface of HDF5 1.10 lacks these two.
  interface
    function c_set_locking(list, use_locking, ignore_disabled) bind(c, name='H5Pset_file_locking') result(status)
      import :: c_bool, c_int, c_int64_t
      integer(c_int64_t), value :: list
      logical(c_bool), value :: use_locking, ignore_disabled
      integer(c_int) :: status
    end function c_set_locking
    function c_walk_errors(stack, direction, visitor, data) bind(c, name='H5Ewalk2') result(status)
      import :: c_funptr, c_int, c_int64_t, c_ptr
      integer(c_int64_t), value :: stack
      integer(c_int), value :: direction
      type(c_funptr), value :: visitor
      type(c_ptr), value :: data
      integer(c_int) :: status
    end function c_walk_errors
    pure function c_length(text) bind(c, name='strlen') result(length)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function c_length
  end interface

contains

  module procedure hdf5_is_available
  is_available = .true.
  end procedure hdf5_is_available

  module procedure file_create
  integer :: status
  integer(hid_t) :: access, id

  call start(self, name, access)
  call h5fcreate_f(name, h5f_acc_trunc_f, id, status, access_prp=access)
  call check(self, status, 'cannot create the file')
  call opened(self, id, access)
  end procedure file_create

  module procedure file_open
  integer :: status
  integer(hid_t) :: access, id

  call start(self, name, access)
  call h5fopen_f(name, merge(h5f_acc_rdonly_f, h5f_acc_rdwr_f, is_read_only), id, status, access_prp=access)
  call check(self, status, 'cannot open the file')
  call opened(self, id, access)
  end procedure file_open

  !> Forget earlier failures, silence the library, and choose how files are opened.
  subroutine start(self, name, access)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(hid_t), intent(out) :: access
    integer :: status
    logical :: is_open

    if (allocated(self%error)) deallocate (self%error)
    self%name = name
    self%id = -1
    ! At exit the library would try once more to flush a file for which the disk had no room, and crash.
    call h5dont_atexit_f(status)
    ! The types of the library's Fortran side exist once it has been opened; each opening would make new ones.
    call h5iis_valid_f(h5t_native_double, is_open, status)
    if (.not. is_open) call h5open_f(status)
    call h5eset_auto_f(0, status)
    call h5pcreate_f(h5p_file_access_f, access, status)
    ! The oldest file format has no mark "open for writing": readers may look on, also after a kill.
    call h5pset_libver_bounds_f(access, h5f_libver_earliest_f, h5f_libver_v110_f, status)
    ! Whatever a failure left open must not keep the file open.
    call h5pset_fclose_degree_f(access, h5f_close_strong_f, status)
    status = c_set_locking(access, .false._c_bool, .true._c_bool)
    call check(self, status, 'cannot start HDF5')
  end subroutine start

  !> Keep the handle of a file that could be opened.
  subroutine opened(self, id, access)
    class(hdf5_file_t), intent(inout) :: self
    integer(hid_t), intent(in) :: id, access
    integer :: status

    if (.not. allocated(self%error)) self%id = id
    call h5pclose_f(access, status)
  end subroutine opened

  module procedure file_flush
  integer :: status

  if (allocated(self%error)) return
  call h5fflush_f(int(self%id, hid_t), h5f_scope_global_f, status)
  call check(self, status, 'cannot write')
  end procedure file_flush

  module procedure file_close
  integer :: status

  if (self%id < 0) return
  call h5fclose_f(int(self%id, hid_t), status)
  self%id = -1
  call check(self, status, 'cannot write')
  end procedure file_close

  module procedure file_group
  integer :: status
  integer(hid_t) :: group

  if (allocated(self%error)) return
  call h5gcreate_f(int(self%id, hid_t), path, group, status)
  call check(self, status, 'cannot make '//path)
  call h5gclose_f(group, status)
  end procedure file_group

  module procedure file_has
  integer :: status

  has = .false.
  if (allocated(self%error)) return
  call h5lexists_f(int(self%id, hid_t), path, has, status)
  has = has .and. status >= 0
  end procedure file_has

  module procedure file_declare
  integer :: status, rank
  integer(hid_t) :: space, list, dataset
  integer(hsize_t) :: shape(2), most(2)

  if (allocated(self%error)) return
  rank = merge(2, 1, components > 0)
  shape = int(max(1, components), hsize_t)
  shape(rank) = 0
  most = shape
  most(rank) = h5s_unlimited_f
  call h5screate_simple_f(rank, shape, space, status, most)
  shape(rank) = int(chunk, hsize_t)
  call h5pcreate_f(h5p_dataset_create_f, list, status)
  call h5pset_chunk_f(list, rank, shape, status)
  if (is_compressed) call h5pset_deflate_f(list, gzip_level, status)
  call check(self, status, 'cannot compress '//path)
  call h5dcreate_f(int(self%id, hid_t), path, file_type(storage), space, dataset, status, list)
  call check(self, status, 'cannot make '//path)
  call h5dclose_f(dataset, status)
  call h5pclose_f(list, status)
  call h5sclose_f(space, status)
  end procedure file_declare

  !> Type of numbers in the file.
  integer(hid_t) function file_type(storage)
    integer, intent(in) :: storage

    select case (storage)
    case (stored_double)
      file_type = h5t_ieee_f64le
    case (stored_single)
      file_type = h5t_ieee_f32le
    case (stored_long)
      file_type = h5t_std_i64le
    case (stored_integer)
      file_type = h5t_std_i32le
    case default
      file_type = h5t_std_u8le
    end select
  end function file_type

  !> Type of long integers in memory.
  integer(hid_t) function long_type()
    long_type = h5kind_to_type(i8, h5_integer_kind)
  end function long_type

  module procedure file_rows
  integer :: status
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  rows = 0
  if (allocated(self%error)) return
  call open_dataset(self, path, dataset, shape)
  rows = shape(2)
  call h5dclose_f(dataset, status)
  end procedure file_rows

  module procedure file_cut
  integer :: status
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  if (allocated(self%error)) return
  call open_dataset(self, path, dataset, shape)
  if (shape(2) > rows) call resize(self, path, dataset, shape(1), int(rows, hsize_t))
  call h5dclose_f(dataset, status)
  end procedure file_cut

  !> Open a dataset and ask for its shape (components, rows); zero after a failure.
  subroutine open_dataset(self, path, dataset, shape)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(out) :: dataset
    integer(hsize_t), intent(out) :: shape(2)
    integer :: status, rank
    integer(hid_t) :: space
    integer(hsize_t) :: most(2)

    shape = 0
    call h5dopen_f(int(self%id, hid_t), path, dataset, status)
    call check(self, status, 'cannot find '//path)
    if (status < 0) return
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (rank == 1 .or. rank == 2) then
      call h5sget_simple_extent_dims_f(space, shape(:rank), most(:rank), status)
      if (rank == 1) shape = [1_hsize_t, shape(1)]
    else
      call note(self, path//' is neither a list nor a table')
    end if
    call h5sclose_f(space, status)
  end subroutine open_dataset

  !> Give a growing dataset another number of rows.
  subroutine resize(self, path, dataset, components, rows)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: dataset
    integer(hsize_t), intent(in) :: components, rows
    integer :: status, rank
    integer(hid_t) :: space

    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    call h5sclose_f(space, status)
    if (rank == 1) then
      call h5dset_extent_f(dataset, [rows], status)
    else
      call h5dset_extent_f(dataset, [components, rows], status)
    end if
    call check(self, status, 'cannot resize '//path)
  end subroutine resize

  !> Add `n` numbers at an address to a growing dataset.
  subroutine append_block(self, path, memory_type, n, address)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: memory_type
    integer, intent(in) :: n
    type(c_ptr), intent(in) :: address
    integer :: status, rank
    integer(hid_t) :: dataset, space, memory
    integer(hsize_t) :: shape(2), first(2), count(2)

    if (allocated(self%error)) return
    call open_dataset(self, path, dataset, shape)
    if (allocated(self%error)) return
    first = [0_hsize_t, shape(2)]
    count = [shape(1), int(n, hsize_t)/shape(1)]
    call resize(self, path, dataset, shape(1), shape(2) + count(2))
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    call h5sselect_hyperslab_f(space, h5s_select_set_f, first(3 - rank:), count(3 - rank:), status)
    call h5screate_simple_f(1, [int(n, hsize_t)], memory, status)
    call h5dwrite_f(dataset, memory_type, address, status, memory, space)
    call check(self, status, 'cannot write '//path)
    call h5sclose_f(memory, status)
    call h5sclose_f(space, status)
    call h5dclose_f(dataset, status)
    call check(self, status, 'cannot write '//path)
  end subroutine append_block

  module procedure append_reals
  if (size(values) > 0) call append_block(self, path, h5t_native_double, size(values), c_loc(values))
  end procedure append_reals

  module procedure append_real_records
  if (size(values) > 0) call append_block(self, path, h5t_native_double, size(values), c_loc(values))
  end procedure append_real_records

  module procedure append_integers
  if (size(values) > 0) call append_block(self, path, h5t_native_integer, size(values), c_loc(values))
  end procedure append_integers

  module procedure append_longs
  if (size(values) > 0) call append_block(self, path, long_type(), size(values), c_loc(values))
  end procedure append_longs

  module procedure append_long_records
  if (size(values) > 0) call append_block(self, path, long_type(), size(values), c_loc(values))
  end procedure append_long_records

  !> Make a dataset of fixed size and fill it from an address.
  subroutine put_block(self, path, stored_type, memory_type, shape, address)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: stored_type, memory_type
    integer, intent(in) :: shape(:)
    type(c_ptr), intent(in) :: address
    integer :: status
    integer(hid_t) :: dataset, space

    if (allocated(self%error)) return
    call h5screate_simple_f(size(shape), int(shape, hsize_t), space, status)
    call h5dcreate_f(int(self%id, hid_t), path, stored_type, space, dataset, status)
    call check(self, status, 'cannot make '//path)
    if (product(shape) > 0) call h5dwrite_f(dataset, memory_type, address, status)
    call check(self, status, 'cannot write '//path)
    call h5dclose_f(dataset, status)
    call check(self, status, 'cannot write '//path)
    call h5sclose_f(space, status)
  end subroutine put_block

  module procedure put_reals
  call put_block(self, path, h5t_ieee_f64le, h5t_native_double, shape(values), address_of_reals(values, size(values)))
  end procedure put_reals

  module procedure put_real_records
  call put_block(self, path, h5t_ieee_f64le, h5t_native_double, shape(values), address_of_reals(values, size(values)))
  end procedure put_real_records

  module procedure put_integers
  call put_block(self, path, h5t_std_i32le, h5t_native_integer, shape(values), address_of_integers(values, size(values)))
  end procedure put_integers

  module procedure put_integer_records
  call put_block(self, path, h5t_std_i32le, h5t_native_integer, shape(values), address_of_integers(values, size(values)))
  end procedure put_integer_records

  !> Address of reals; null when there are none, as an empty array has no address.
  type(c_ptr) function address_of_reals(values, n) result(address)
    integer, intent(in) :: n
    real(wp), intent(in), target :: values(n)

    address = c_null_ptr
    if (n > 0) address = c_loc(values)
  end function address_of_reals

  !> Address of integers; null when there are none.
  type(c_ptr) function address_of_integers(values, n) result(address)
    integer, intent(in) :: n
    integer(i4), intent(in), target :: values(n)

    address = c_null_ptr
    if (n > 0) address = c_loc(values)
  end function address_of_integers

  !> Open a dataset to be read whole; a list must have one component.
  subroutine prepare_read(self, path, is_list, dataset, shape)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    logical, intent(in) :: is_list
    integer(hid_t), intent(out) :: dataset
    integer(hsize_t), intent(out) :: shape(2)

    shape = 0
    dataset = -1
    if (allocated(self%error)) return
    call open_dataset(self, path, dataset, shape)
    if (is_list .and. shape(1) > 1) call note(self, path//' is not a list')
    if (allocated(self%error)) shape = 0
  end subroutine prepare_read

  !> Read a dataset whole to an address, and close it.
  subroutine read_block(self, path, dataset, memory_type, n, address)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: dataset, memory_type
    integer, intent(in) :: n
    type(c_ptr), intent(in) :: address
    integer :: status
    type(c_ptr) :: to ! the library declares it as changing

    if (allocated(self%error)) return
    status = 0
    to = address
    if (n > 0) call h5dread_f(dataset, memory_type, to, status)
    call check(self, status, 'cannot read '//path)
    call h5dclose_f(dataset, status)
  end subroutine read_block

  module procedure get_reals
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  call prepare_read(self, path, .true., dataset, shape)
  allocate (values(shape(2)))
  call read_block(self, path, dataset, h5t_native_double, size(values), address_of_reals(values, size(values)))
  end procedure get_reals

  module procedure get_real_records
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  call prepare_read(self, path, .false., dataset, shape)
  allocate (values(shape(1), shape(2)))
  call read_block(self, path, dataset, h5t_native_double, size(values), address_of_reals(values, size(values)))
  end procedure get_real_records

  module procedure get_integers
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  call prepare_read(self, path, .true., dataset, shape)
  allocate (values(shape(2)))
  call read_block(self, path, dataset, h5t_native_integer, size(values), address_of_integers(values, size(values)))
  end procedure get_integers

  module procedure get_integer_records
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  call prepare_read(self, path, .false., dataset, shape)
  allocate (values(shape(1), shape(2)))
  call read_block(self, path, dataset, h5t_native_integer, size(values), address_of_integers(values, size(values)))
  end procedure get_integer_records

  module procedure get_longs
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)
  type(c_ptr) :: address

  call prepare_read(self, path, .true., dataset, shape)
  allocate (values(shape(2)))
  address = c_null_ptr
  if (size(values) > 0) address = c_loc(values)
  call read_block(self, path, dataset, long_type(), size(values), address)
  end procedure get_longs

  module procedure set_long
  integer :: status
  integer(hid_t) :: space

  if (allocated(self%error)) return
  call h5screate_f(h5s_scalar_f, space, status)
  call set_numbers(self, path, name, space, [value])
  end procedure set_long

  module procedure set_longs
  integer :: status
  integer(hid_t) :: space

  if (allocated(self%error)) return
  call h5screate_simple_f(1, [size(value, kind=hsize_t)], space, status)
  call set_numbers(self, path, name, space, value)
  end procedure set_longs

  !> Set an attribute to long integers.
  subroutine set_numbers(self, path, name, space, values)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path, name
    integer(hid_t), intent(in) :: space
    integer(i8), intent(in), target :: values(:)
    integer(i8), target :: copy(size(values))

    copy = values
    call set_block(self, path, name, h5t_std_i64le, long_type(), space, c_loc(copy))
  end subroutine set_numbers

  module procedure set_text
  integer :: status, i
  integer(hid_t) :: space, text_type
  character(kind=c_char), target :: letters(max(1, len(value)))

  if (allocated(self%error)) return
  letters = c_null_char
  do i = 1, len(value)
    letters(i) = value(i:i)
  end do
  ! The space-padded text of Fortran would keep its blanks in readers.
  call h5tcopy_f(h5t_c_s1, text_type, status)
  call h5tset_size_f(text_type, size(letters, kind=size_t), status)
  call h5tset_strpad_f(text_type, h5t_str_nullpad_f, status)
  call h5screate_f(h5s_scalar_f, space, status)
  call set_block(self, path, name, text_type, text_type, space, c_loc(letters))
  call h5tclose_f(text_type, status)
  end procedure set_text

  !> Write an attribute from an address; it is made when it does not exist.
  subroutine set_block(self, path, name, stored_type, memory_type, space, address)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path, name
    integer(hid_t), intent(in) :: stored_type, memory_type, space
    type(c_ptr), intent(in) :: address
    integer :: status
    integer(hid_t) :: object, attribute
    logical :: exists

    call h5oopen_f(int(self%id, hid_t), path, object, status)
    call check(self, status, 'cannot find '//path)
    call h5aexists_f(object, name, exists, status)
    if (exists) then
      call h5aopen_f(object, name, attribute, status)
    else
      call h5acreate_f(object, name, stored_type, space, attribute, status)
    end if
    call check(self, status, 'cannot make the attribute '//name)
    call h5awrite_f(attribute, memory_type, address, status)
    call check(self, status, 'cannot write the attribute '//name)
    call h5aclose_f(attribute, status)
    call h5oclose_f(object, status)
    call h5sclose_f(space, status)
  end subroutine set_block

  !> Open an attribute.
  subroutine open_attribute(self, path, name, attribute)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path, name
    integer(hid_t), intent(out) :: attribute
    integer :: status
    integer(hid_t) :: object

    call h5oopen_f(int(self%id, hid_t), path, object, status)
    call check(self, status, 'cannot find '//path)
    call h5aopen_f(object, name, attribute, status)
    call check(self, status, 'cannot find the attribute '//name)
    call h5oclose_f(object, status)
  end subroutine open_attribute

  module procedure look_long
  integer :: status
  integer(hid_t) :: attribute
  integer(i8), target :: number(1)
  type(c_ptr) :: address

  value = 0
  if (allocated(self%error)) return
  call open_attribute(self, path, name, attribute)
  if (allocated(self%error)) return
  address = c_loc(number)
  call h5aread_f(attribute, long_type(), address, status)
  call check(self, status, 'cannot read the attribute '//name)
  if (status >= 0) value = number(1)
  call h5aclose_f(attribute, status)
  end procedure look_long

  module procedure look_text
  integer :: status, i
  integer(hid_t) :: attribute, text_type
  integer(size_t) :: length
  character(kind=c_char), allocatable, target :: letters(:)
  type(c_ptr) :: address

  value = ''
  if (allocated(self%error)) return
  call open_attribute(self, path, name, attribute)
  if (allocated(self%error)) return
  call h5aget_type_f(attribute, text_type, status)
  call h5tget_size_f(text_type, length, status)
  allocate (letters(max(1_size_t, length)), source=c_null_char)
  address = c_loc(letters)
  call h5aread_f(attribute, text_type, address, status)
  call check(self, status, 'cannot read the attribute '//name)
  do i = 1, size(letters)
    if (letters(i) /= c_null_char) value = value//letters(i)
  end do
  call h5tclose_f(text_type, status)
  call h5aclose_f(attribute, status)
  end procedure look_text

  !> Keep the first failure, with the library's reason.
  subroutine check(self, status, what)
    class(hdf5_file_t), intent(inout) :: self
    integer, intent(in) :: status
    character(len=*), intent(in) :: what

    if (status < 0) call note(self, what//': '//reason())
  end subroutine check

  !> Keep a failure, unless there was one before.
  subroutine note(self, message)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: message

    if (.not. allocated(self%error)) call fail(self%error, message, file=self%name, code=exit_output)
  end subroutine note

  !> Innermost reason of the last failure; where the operating system gave one, its words alone.
  function reason()
    character(len=:), allocatable :: reason
    character(len=*), parameter :: mark = 'error message = '''
    type(reason_t), target :: found
    integer :: status, i

    status = c_walk_errors(0_c_int64_t, 0_c_int, c_funloc(keep_reason), c_loc(found))
    reason = ''
    do i = 1, size(found%text)
      if (found%text(i) == c_null_char) exit
      reason = reason//found%text(i)
    end do
    i = index(reason, mark)
    if (i == 0) return
    reason = reason(i + len(mark):)
    reason = reason(:index(reason, '''') - 1)
  end function reason

  !> Called for every failure on the stack, innermost first: keeps the text of the first.
  function keep_reason(number, error, data) bind(c) result(status)
    integer(c_int), value :: number
    type(stacked_error_t), intent(in) :: error
    type(c_ptr), value :: data
    integer(c_int) :: status
    type(reason_t), pointer :: found
    character(kind=c_char), pointer :: text(:)
    integer :: n

    status = 0
    if (number > 0) return
    call c_f_pointer(data, found)
    call c_f_pointer(error%description, text, [c_length(error%description)])
    n = min(size(text), size(found%text) - 1)
    found%text(:n) = text(:n)
  end function keep_reason
end submodule hdf5_with_hdf5
