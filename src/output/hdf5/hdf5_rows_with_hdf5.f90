!> Rows of HDF5 datasets as ranks write them: each rank its own, or the first subdomain of a process those of all of its subdomains.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_rows_with_hdf5
  ! gfortran 12 refuses to use again what the parent uses already: the kinds and some constants come from there.
  use hdf5, only: h5dget_space_f, h5dwrite_f, h5p_dataset_xfer_f, h5s_select_set_f, h5sclose_f, h5screate_simple_f, &
                  h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, h5sselect_none_f, h5t_native_integer
  implicit none

contains

  module procedure write_rows
  integer(i1), allocatable, target :: all(:)
  integer :: bytes

  if (self%ranks%n_here() == 1 .or. are_common(is_common)) then
    if (self%ranks%leads_process()) &
      call write_block(self, path, dataset, memory_type, components, first, before, total, n, address)
  else
    bytes = merge(4, 8, memory_type == h5t_native_integer)
    call collect(self, bytes*n, address, all)
    if (self%ranks%leads_process()) &
      call write_block(self, path, dataset, memory_type, components, first, before, total, size(all)/bytes, c_loc(all))
  end if
  end procedure write_rows

  !> Bring bytes of all subdomains of this process to the first one, in their order; as reals, which travel without a change.
  subroutine collect(self, n, address, all)
    class(hdf5_file_t), intent(inout) :: self
    integer, intent(in) :: n
    type(c_ptr), intent(in) :: address
    integer(i1), allocatable, intent(out) :: all(:)
    integer, parameter :: word = storage_size(0.0_wp)/8
    integer(i1), pointer :: own(:)
    integer(i1) :: padded((n + word - 1)/word*word)
    real(wp), allocatable :: came(:)
    integer, allocatable :: bytes(:), words(:), counts(:)
    type(comm_t) :: here
    integer :: r, first

    here = self%ranks
    here%traffic = traffic_t()
    call here%stay_here()
    padded = 0_i1
    if (n > 0) then
      call c_f_pointer(address, own, [n])
      padded(:n) = own
    end if
    call here%gather(n, bytes)
    words = [size(padded)/word, spread(0, 1, here%size - 1)]
    call here%swap(transfer(padded, [0.0_wp]), words, came, counts)
    call self%ranks%collect(here)
    allocate (all(merge(sum(bytes), 0, here%rank == 0)))
    if (here%rank > 0) return
    do r = 0, here%size - 1
      first = sum(bytes(:r))
      all(first + 1:first + bytes(r + 1)) = transfer(came(sum(counts(:r - 1)) + 1:sum(counts(:r))), 0_i1, bytes(r + 1))
    end do
  end subroutine collect

  !> Write rows of this process.
  subroutine write_block(self, path, dataset, memory_type, components, first, before, total, n, address)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: dataset, memory_type
    integer(hsize_t), intent(in) :: components, first
    integer(i8), intent(in) :: before, total
    integer, intent(in) :: n
    type(c_ptr), intent(in) :: address
    integer :: status, rank
    integer(hid_t) :: space, memory, list
    integer(hsize_t) :: origin(2), count(2)

    ! Of rows that all ranks have only rank 0 has none of lower ranks before it.
    count = [components, merge(int(n, hsize_t)/components, 0_hsize_t, before < total)]
    origin = [0_hsize_t, first + before]
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    ! Of the same rank as the rows: where shapes differ, HDF5 goes from number to number.
    call h5screate_simple_f(rank, max(1_hsize_t, count(3 - rank:)), memory, status)
    if (product(count) > 0) then
      call h5sselect_hyperslab_f(space, h5s_select_set_f, origin(3 - rank:), count(3 - rank:), status)
    else
      call h5sselect_none_f(space, status)
      call h5sselect_none_f(memory, status)
    end if
    call h5pcreate_f(h5p_dataset_xfer_f, list, status)
    if (self%ranks%n_processes() > 1) call share_transfer(self, list)
    call h5dwrite_f(dataset, memory_type, address, status, memory, space, list)
    call check(self, status, 'cannot write '//path)
    call h5pclose_f(list, status)
    call h5sclose_f(memory, status)
    call h5sclose_f(space, status)
  end subroutine write_block
end submodule hdf5_rows_with_hdf5
