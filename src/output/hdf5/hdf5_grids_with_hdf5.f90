!> Values on grids in HDF5 files that one rank writes: datasets of one axis per axis of the grid, growing by a grid per step; and
!! attributes that are lists of reals.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_grids_with_hdf5
  ! gfortran 12 refuses to use again what the parent uses already: the kinds and some constants come from there.
  use hdf5, only: h5aclose_f, h5acreate_f, h5awrite_f, h5d_alloc_time_early_f, h5dclose_f, h5dcreate_f, h5dget_space_f, h5dopen_f, &
                  h5dset_extent_f, h5dwrite_f, h5oclose_f, h5oopen_f, h5p_dataset_create_f, h5pset_alloc_time_f, h5pset_chunk_f, &
                  h5s_select_set_f, h5s_unlimited_f, h5sclose_f, h5screate_simple_f, h5sget_simple_extent_dims_f, &
                  h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, h5t_ieee_f32le, h5t_ieee_f64le
  implicit none

contains

  module procedure file_declare_grid
  integer :: status, rank
  integer(hid_t) :: space, list, dataset
  integer(hsize_t) :: first(size(extents) + 1), most(size(extents) + 1)

  if (allocated(self%error)) return
  rank = size(extents) + 1
  first = [int(extents, hsize_t), 0_hsize_t]
  most = [int(extents, hsize_t), h5s_unlimited_f]
  call h5screate_simple_f(rank, first, space, status, most)
  call h5pcreate_f(h5p_dataset_create_f, list, status)
  call h5pset_chunk_f(list, rank, max(1_hsize_t, [int(extents, hsize_t), 1_hsize_t]), status)
  call h5pset_alloc_time_f(list, h5d_alloc_time_early_f, status)
  call h5dcreate_f(int(self%id, hid_t), path, merge(h5t_ieee_f64le, h5t_ieee_f32le, storage == stored_double), space, dataset, &
                   status, list)
  call check(self, status, 'cannot make '//path)
  call h5dclose_f(dataset, status)
  call h5pclose_f(list, status)
  call h5sclose_f(space, status)
  end procedure file_declare_grid

  module procedure file_put_grid
  integer :: status, rank
  integer(hid_t) :: space, memory, dataset
  integer(hsize_t), allocatable :: now(:), most(:), start(:), count(:)

  if (allocated(self%error)) return
  call h5dopen_f(int(self%id, hid_t), path, dataset, status)
  call check(self, status, 'cannot find '//path)
  if (allocated(self%error)) return
  call h5dget_space_f(dataset, space, status)
  call h5sget_simple_extent_ndims_f(space, rank, status)
  allocate (now(rank), most(rank), start(rank), count(rank))
  call h5sget_simple_extent_dims_f(space, now, most, status)
  call h5sclose_f(space, status)
  now(rank) = max(now(rank), int(grid, hsize_t) + 1)
  call h5dset_extent_f(dataset, now, status)
  call check(self, status, 'cannot extend '//path)
  call h5dget_space_f(dataset, space, status)
  start = 0
  start(rank) = int(grid, hsize_t)
  count = now
  count(rank) = 1
  call h5sselect_hyperslab_f(space, h5s_select_set_f, start, count, status)
  call h5screate_simple_f(rank, count, memory, status)
  if (product(count) == size(values, kind=hsize_t)) then
    call h5dwrite_f(dataset, h5t_native_double, c_loc(values), status, memory, space)
  else
    status = -1
  end if
  call check(self, status, 'cannot write '//path)
  call h5sclose_f(memory, status)
  call h5sclose_f(space, status)
  call h5dclose_f(dataset, status)
  end procedure file_put_grid

  module procedure set_reals
  integer :: status
  integer(hid_t) :: space, object, attribute
  real(wp), target :: copy(size(value))

  if (allocated(self%error)) return
  copy = value
  call h5screate_simple_f(1, [size(value, kind=hsize_t)], space, status)
  call h5oopen_f(int(self%id, hid_t), path, object, status)
  call check(self, status, 'cannot find '//path)
  call h5acreate_f(object, name, h5t_ieee_f64le, space, attribute, status)
  call check(self, status, 'cannot make the attribute '//name)
  call h5awrite_f(attribute, h5t_native_double, c_loc(copy), status)
  call check(self, status, 'cannot write the attribute '//name)
  call h5aclose_f(attribute, status)
  call h5oclose_f(object, status)
  call h5sclose_f(space, status)
  end procedure set_reals
end submodule hdf5_grids_with_hdf5
