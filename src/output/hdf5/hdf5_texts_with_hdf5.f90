!> Groups of HDF5 files listed and removed, and datasets that hold one text.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_texts_with_hdf5
  ! gfortran 12 refuses to use again what the parent uses already: the kinds and some constants come from there.
  use hdf5, only: h5dclose_f, h5dcreate_f, h5dwrite_f, h5gget_obj_info_idx_f, h5gn_members_f, h5ldelete_f, h5s_scalar_f, &
                  h5sclose_f, h5screate_f, h5t_c_s1, h5t_str_nullterm_f, h5tclose_f, h5tcopy_f, h5tset_size_f, &
                  h5tset_strpad_f, size_t
  use sg_text, only: append_word
  implicit none

  !> Longest name that is listed whole
  integer, parameter :: longest_name = 256

contains

  module procedure file_names
  integer :: status, n, i, kind
  character(len=longest_name) :: name

  allocate (names(0))
  if (allocated(self%error)) return
  call h5gn_members_f(int(self%id, hid_t), path, n, status)
  call check(self, status, 'cannot list '//path)
  call settle(self)
  if (allocated(self%error)) return
  do i = 0, n - 1
    call h5gget_obj_info_idx_f(int(self%id, hid_t), path, i, name, kind, status)
    call check(self, status, 'cannot list '//path)
    if (status >= 0) call append_word(names, trim(name))
  end do
  call settle(self)
  end procedure file_names

  module procedure file_remove
  integer :: status

  if (allocated(self%error)) return
  if (self%ranks%leads_process()) then
    call h5ldelete_f(int(self%id, hid_t), path, status)
    call check(self, status, 'cannot remove '//path)
  end if
  call settle(self)
  end procedure file_remove

  module procedure put_text
  integer :: status, i
  integer(hid_t) :: dataset, space, text_type
  character(kind=c_char), target :: letters(len(text) + 1)

  if (allocated(self%error)) return
  call reserve(self, size(letters, kind=i8))
  if (allocated(self%error)) return
  if (self%ranks%leads_process()) then
    letters = c_null_char
    do i = 1, len(text)
      letters(i) = text(i:i)
    end do
    call h5tcopy_f(h5t_c_s1, text_type, status)
    call h5tset_size_f(text_type, size(letters, kind=size_t), status)
    call h5tset_strpad_f(text_type, h5t_str_nullterm_f, status)
    call h5screate_f(h5s_scalar_f, space, status)
    call h5dcreate_f(int(self%id, hid_t), path, text_type, space, dataset, status)
    call check(self, status, 'cannot make '//path)
    ! The text is the same on all ranks.
    if (self%ranks%rank == 0) call h5dwrite_f(dataset, text_type, c_loc(letters), status)
    call check(self, status, 'cannot write '//path)
    call h5dclose_f(dataset, status)
    call h5sclose_f(space, status)
    call h5tclose_f(text_type, status)
  end if
  call settle(self)
  end procedure put_text
end submodule hdf5_texts_with_hdf5
