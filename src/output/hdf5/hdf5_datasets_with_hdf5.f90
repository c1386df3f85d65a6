!> Datasets of HDF5 files: made, grown, cut and written through addresses, whatever the kind of their numbers; what reads them is
!! in a submodule of this one.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_datasets_with_hdf5
  ! gfortran 12 refuses to use again what the parent uses already: the kinds and some constants come from there.
  use hdf5, only: h5d_alloc_time_early_f, h5dclose_f, h5dcreate_f, h5dget_create_plist_f, h5dget_space_f, h5dopen_f, &
                  h5dset_extent_f, h5p_dataset_create_f, h5pget_nfilters_f, h5pset_alloc_time_f, h5pset_chunk_f, &
                  h5pset_deflate_f, h5pset_fletcher32_f, h5s_unlimited_f, h5sclose_f, h5screate_simple_f, &
                  h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, h5sget_simple_extent_npoints_f, &
                  h5t_ieee_f32le, h5t_ieee_f64le, h5t_native_integer, h5t_std_i32le, h5t_std_i64le, h5t_std_u8le
  implicit none

  !> gzip level: beyond it files hardly shrink, and writing takes longer
  integer, parameter :: gzip_level = 4
  !> Rows that share a check sum, at most: as many as ranks read at once (sg_picked_rows)
  integer(hsize_t), parameter :: checked_rows = 16384

contains

  module procedure file_declare
  if (allocated(self%error)) return
  call reserve(self, 0_i8)
  if (allocated(self%error)) return
  if (self%ranks%leads_process()) call make_growing(self, path, storage, components, chunk, is_compressed)
  call settle(self)
  end procedure file_declare

  !> Make a growing dataset without rows.
  subroutine make_growing(self, path, storage, components, chunk, is_compressed)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: storage, components, chunk
    logical, intent(in) :: is_compressed
    integer :: status, rank
    integer(hid_t) :: space, list, dataset
    integer(hsize_t) :: shape(2), most(2)

    rank = merge(2, 1, components > 0)
    shape = int(max(1, components), hsize_t)
    shape(rank) = 0
    most = shape
    most(rank) = h5s_unlimited_f
    call h5screate_simple_f(rank, shape, space, status, most)
    shape(rank) = int(chunk, hsize_t)
    call h5pcreate_f(h5p_dataset_create_f, list, status)
    call h5pset_chunk_f(list, rank, shape, status)
    ! HDF5 compresses what ranks write together only where file and memory hold the same type, and 1.10 not safely then: cutting
    ! rows off a compressed chunk leaves one that cannot be read, and other ranks wait for ever.
    if (is_compressed .and. self%ranks%n_processes() == 1) then
      call h5pset_deflate_f(list, gzip_level, status)
    else
      ! Ranks can go on with a file only where chunks get their place as the dataset grows, also when one rank made it.
      call h5pset_alloc_time_f(list, h5d_alloc_time_early_f, status)
    end if
    call check(self, status, 'cannot compress '//path)
    call h5dcreate_f(int(self%id, hid_t), path, file_type(storage), space, dataset, status, list)
    call check(self, status, 'cannot make '//path)
    call h5dclose_f(dataset, status)
    call h5pclose_f(list, status)
    call h5sclose_f(space, status)
  end subroutine make_growing

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

  module procedure file_total
  integer(i8) :: first

  call count_rows(self, rows, .false., first, total)
  end procedure file_total

  !> Rows of lower ranks and of all ranks; rows that all have are those of rank 0.
  subroutine count_rows(self, rows, is_common, first, total)
    class(hdf5_file_t), intent(inout) :: self
    integer, intent(in) :: rows
    logical, intent(in), optional :: is_common
    integer(i8), intent(out) :: first, total

    first = 0
    total = int(rows, i8)
    if (self%ranks%size == 1) return
    if (are_common(is_common)) then
      if (self%ranks%rank > 0) first = total
    else
      call self%ranks%before(int(rows, i8), first, total)
    end if
  end subroutine count_rows

  module procedure file_rows
  integer :: status
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  rows = 0
  if (allocated(self%error)) return
  call open_dataset(self, path, dataset, shape)
  rows = shape(2)
  call h5dclose_f(dataset, status)
  call settle(self)
  end procedure file_rows

  module procedure file_shape
  integer :: status
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  numbers = 0
  if (allocated(self%error)) return
  call open_dataset(self, path, dataset, shape)
  call h5dclose_f(dataset, status)
  call settle(self)
  if (.not. allocated(self%error)) numbers = shape
  end procedure file_shape

  module procedure file_cut
  integer :: status
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  if (allocated(self%error)) return
  call open_dataset(self, path, dataset, shape)
  if (shape(2) > rows .and. self%ranks%leads_process()) call resize(self, path, dataset, shape(1), int(rows, hsize_t))
  call h5dclose_f(dataset, status)
  call settle(self)
  end procedure file_cut

  !> Open a dataset and ask for its shape (components, rows); zero after a failure.
  subroutine open_dataset(self, path, dataset, shape)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(out) :: dataset
    integer(hsize_t), intent(out) :: shape(2)
    integer :: status, rank
    integer(hid_t) :: space
    integer(hsize_t) :: most(2), points

    shape = 0
    call h5dopen_f(int(self%id, hid_t), path, dataset, status)
    call check(self, status, 'cannot find '//path)
    if (status < 0) return
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (rank == 1 .or. rank == 2) then
      call h5sget_simple_extent_dims_f(space, shape(:rank), most(:rank), status)
      if (rank == 1) shape = [1_hsize_t, shape(1)]
    else if (rank == 0) then
      ! One number, or nothing at all.
      call h5sget_simple_extent_npoints_f(space, points, status)
      shape = [1_hsize_t, points]
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
  subroutine append_block(self, path, memory_type, n, address, is_common)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: memory_type
    integer, intent(in) :: n
    type(c_ptr), intent(in) :: address
    logical, intent(in), optional :: is_common
    integer :: status
    integer(hid_t) :: dataset
    integer(hsize_t) :: shape(2)
    integer(i8) :: before, total

    if (allocated(self%error)) return
    if (n == 0 .and. self%ranks%size == 1) return
    call open_dataset(self, path, dataset, shape)
    if (self%ranks%n_processes() > 1) call refuse_compressed(self, path, dataset)
    call settle(self)
    if (allocated(self%error)) return
    call count_rows(self, int(int(n, hsize_t)/shape(1)), is_common, before, total)
    ! Chunks are made whole, and a compressed one may be rewritten: room for twice the rows.
    call reserve(self, 16*shape(1)*total)
    if (total > 0 .and. .not. allocated(self%error)) then
      if (self%ranks%leads_process()) call resize(self, path, dataset, shape(1), shape(2) + total)
      call write_rows(self, path, dataset, memory_type, shape(1), shape(2), before, total, n, address, is_common)
    end if
    call h5dclose_f(dataset, status)
    call check(self, status, 'cannot write '//path)
    call settle(self)
  end subroutine append_block

  !> Ranks cannot add to a dataset that one rank made compressed.
  subroutine refuse_compressed(self, path, dataset)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: dataset
    integer :: status, n
    integer(hid_t) :: list

    if (allocated(self%error)) return
    call h5dget_create_plist_f(dataset, list, status)
    call h5pget_nfilters_f(list, n, status)
    if (n > 0) call note(self, 'cannot go on with this file on several ranks, move it away: '//path//' is compressed')
    call h5pclose_f(list, status)
  end subroutine refuse_compressed

  module procedure append_reals
  call append_block(self, path, h5t_native_double, size(values), address_of_reals(values, size(values)), is_common)
  end procedure append_reals

  module procedure append_real_records
  call append_block(self, path, h5t_native_double, size(values), address_of_reals(values, size(values)), is_common)
  end procedure append_real_records

  module procedure append_integers
  call append_block(self, path, h5t_native_integer, size(values), address_of_integers(values, size(values)), is_common)
  end procedure append_integers

  module procedure append_longs
  call append_block(self, path, long_type(), size(values), address_of_longs(values, size(values)), is_common)
  end procedure append_longs

  !> Make a dataset of fixed size and fill it from an address.
  subroutine put_block(self, path, stored_type, memory_type, shape, address, is_common)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: stored_type, memory_type
    integer, intent(in) :: shape(:)
    type(c_ptr), intent(in) :: address
    logical, intent(in), optional :: is_common
    integer :: status, rank
    integer(hid_t) :: dataset
    integer(hsize_t) :: whole(2)
    integer(i8) :: before, total

    if (allocated(self%error)) return
    rank = size(shape)
    call count_rows(self, shape(rank), is_common, before, total)
    whole = [merge(int(shape(1), hsize_t), 1_hsize_t, rank == 2), int(total, hsize_t)]
    ! The last of several chunks that have check sums is stored whole.
    call reserve(self, 8*whole(1)*merge(whole(2) + checked_rows, whole(2), whole(2) > checked_rows))
    if (allocated(self%error)) return
    if (self%ranks%leads_process()) call make_fixed(self, path, stored_type, rank, whole, dataset)
    call settle(self)
    if (product(whole) > 0 .and. .not. allocated(self%error)) &
      call write_rows(self, path, dataset, memory_type, whole(1), 0_hsize_t, before, total, product(shape), address, is_common)
    if (self%ranks%leads_process()) then
      call h5dclose_f(dataset, status)
      call check(self, status, 'cannot write '//path)
    end if
    call settle(self)
  end subroutine put_block

  !> Make a dataset of fixed size.
  subroutine make_fixed(self, path, stored_type, rank, whole, dataset)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: stored_type
    integer, intent(in) :: rank
    integer(hsize_t), intent(in) :: whole(2)
    integer(hid_t), intent(out) :: dataset
    integer :: status
    integer(hid_t) :: space, list

    call h5screate_simple_f(rank, whole(3 - rank:), space, status)
    call h5pcreate_f(h5p_dataset_create_f, list, status)
    if (self%is_checked .and. product(whole) > 0) call add_check_sums(self, list, rank, whole)
    call h5dcreate_f(int(self%id, hid_t), path, stored_type, space, dataset, status, list)
    call check(self, status, 'cannot make '//path)
    call h5pclose_f(list, status)
    call h5sclose_f(space, status)
  end subroutine make_fixed

  !> Have a dataset stored in chunks, each with a check sum, which is looked at when it is read.
  subroutine add_check_sums(self, list, rank, whole)
    class(hdf5_file_t), intent(inout) :: self
    integer(hid_t), intent(in) :: list
    integer, intent(in) :: rank
    integer(hsize_t), intent(in) :: whole(2)
    integer :: status
    integer(hsize_t) :: chunk(2)

    chunk = [whole(1), min(whole(2), checked_rows)]
    call h5pset_chunk_f(list, rank, chunk(3 - rank:), status)
    if (status >= 0) call h5pset_fletcher32_f(list, status)
    call check(self, status, 'cannot add check sums')
  end subroutine add_check_sums

  module procedure put_reals
  call put_block(self, path, h5t_ieee_f64le, h5t_native_double, shape(values), address_of_reals(values, size(values)), is_common)
  end procedure put_reals

  module procedure put_real_records
  call put_block(self, path, h5t_ieee_f64le, h5t_native_double, shape(values), address_of_reals(values, size(values)), is_common)
  end procedure put_real_records

  module procedure put_integers
  call put_block(self, path, h5t_std_i32le, h5t_native_integer, shape(values), address_of_integers(values, size(values)), &
                 is_common)
  end procedure put_integers

  module procedure put_integer_records
  call put_block(self, path, h5t_std_i32le, h5t_native_integer, shape(values), address_of_integers(values, size(values)), &
                 is_common)
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

  !> Address of long integers; null when there are none.
  type(c_ptr) function address_of_longs(values, n) result(address)
    integer, intent(in) :: n
    integer(i8), intent(in), target :: values(n)

    address = c_null_ptr
    if (n > 0) address = c_loc(values)
  end function address_of_longs
end submodule hdf5_datasets_with_hdf5
