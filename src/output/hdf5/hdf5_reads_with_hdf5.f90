!> Datasets of HDF5 files read through addresses, whole or some rows of them, once they were looked at: files may be spoilt.
submodule(sg_hdf5:hdf5_datasets_with_hdf5) hdf5_reads_with_hdf5
  ! gfortran 12 refuses to use again what the parents use already: the kinds and some constants come from there.
  use hdf5, only: h5dget_storage_size_f, h5dread_f, h5s_select_set_f, h5sselect_hyperslab_f
  use sg_text, only: to_text
  implicit none

  !> A byte that is stored makes no more entries: gzip shrinks zeros by 1032; and entries that are read without a look at bytes
  integer(hsize_t), parameter :: most_per_byte = 1032, few_entries = 2_hsize_t**20

contains

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
    if (shape(1)*shape(2) > huge(1_i4)) call note(self, path//' has more entries than can be counted')
    call check_storage(self, path, dataset, shape(1)*shape(2))
    call settle(self)
    if (allocated(self%error)) shape = 0
  end subroutine prepare_read

  !> A dataset that is spoilt may have more entries than were ever written: they would be read as zeros, all memory full of them.
  subroutine check_storage(self, path, dataset, entries)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: dataset
    integer(hsize_t), intent(in) :: entries
    integer(hsize_t) :: bytes
    integer :: status

    if (entries <= few_entries) return
    call h5dget_storage_size_f(dataset, bytes, status)
    ! A size of zero counts as a failure there.
    if (status < 0) bytes = 0
    if (entries > most_per_byte*bytes) &
      call note(self, path//' has '//to_text(int(entries, i8))//' entries, but no more than '//to_text(int(bytes, i8))// &
                ' bytes in the file')
  end subroutine check_storage

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
    call settle(self)
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

  module procedure file_get_rows
  integer :: status, rank
  integer(hid_t) :: dataset, space, memory
  integer(hsize_t) :: shape(2), start(2), count(2)
  type(c_ptr) :: address

  shape = 0
  if (.not. allocated(self%error)) then
    call open_dataset(self, path, dataset, shape)
    if (first + int(rows, i8) > shape(2)) call note(self, path//' is not whole')
    call check_storage(self, path, dataset, shape(1)*shape(2))
    call settle(self)
  end if
  count = [shape(1), int(rows, hsize_t)]
  if (allocated(self%error)) count = 0
  allocate (values(count(1), count(2)))
  if (allocated(self%error)) return
  status = 0
  if (size(values) > 0) then
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    start = [0_hsize_t, int(first, hsize_t)]
    call h5sselect_hyperslab_f(space, h5s_select_set_f, start(3 - rank:), count(3 - rank:), status)
    call h5screate_simple_f(rank, count(3 - rank:), memory, status)
    address = c_loc(values)
    call h5dread_f(dataset, h5t_native_double, address, status, memory, space)
    call check(self, status, 'cannot read '//path)
    call h5sclose_f(memory, status)
    call h5sclose_f(space, status)
  end if
  call h5dclose_f(dataset, status)
  call settle(self)
  end procedure file_get_rows

  module procedure get_integers
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  call prepare_read(self, path, .true., dataset, shape)
  allocate (values(shape(2)))
  call read_block(self, path, dataset, h5t_native_integer, size(values), address_of_integers(values, size(values)))
  end procedure get_integers

  module procedure get_longs
  integer(hid_t) :: dataset
  integer(hsize_t) :: shape(2)

  call prepare_read(self, path, .true., dataset, shape)
  allocate (values(shape(2)))
  call read_block(self, path, dataset, long_type(), size(values), address_of_longs(values, size(values)))
  end procedure get_longs
end submodule hdf5_reads_with_hdf5
