!> Attributes of the objects of HDF5 files: long integers and texts.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_attributes_with_hdf5
  ! gfortran 12 refuses to use again what the parent uses already: the kinds and some constants come from there.
  use hdf5, only: h5aclose_f, h5acreate_f, h5aexists_f, h5aget_space_f, h5aget_type_f, h5aopen_f, h5aread_f, h5awrite_f, &
                  h5oclose_f, h5oopen_f, h5s_scalar_f, h5sclose_f, h5screate_f, h5screate_simple_f, &
                  h5sget_simple_extent_npoints_f, h5t_c_s1, h5t_integer_f, h5t_std_i64le, h5t_str_nullpad_f, h5t_string_f, &
                  h5tclose_f, h5tcopy_f, h5tget_class_f, h5tget_size_f, h5tis_variable_str_f, h5tset_size_f, h5tset_strpad_f, &
                  size_t
  implicit none

contains

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

    call reserve(self, 0_i8)
    if (allocated(self%error)) return
    if (self%ranks%leads_process()) then
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
    end if
    call h5sclose_f(space, status)
    call settle(self)
  end subroutine set_block

  !> Open an attribute that must hold one value, a whole number or a text of fixed length: there is room for no other.
  subroutine open_attribute(self, path, name, class, attribute, stored)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path, name
    integer, intent(in) :: class !! class of its type, as the library numbers them
    integer(hid_t), intent(out) :: attribute, stored
    integer :: status, found
    integer(hid_t) :: object, space
    integer(hsize_t) :: points
    logical :: has_length

    call h5oopen_f(int(self%id, hid_t), path, object, status)
    call check(self, status, 'cannot find '//path)
    call h5aopen_f(object, name, attribute, status)
    call check(self, status, 'cannot find the attribute '//name)
    call h5oclose_f(object, status)
    if (.not. allocated(self%error)) then
      call h5aget_space_f(attribute, space, status)
      call h5sget_simple_extent_npoints_f(space, points, status)
      call h5sclose_f(space, status)
      call h5aget_type_f(attribute, stored, status)
      call h5tget_class_f(stored, found, status)
      has_length = .false.
      if (found == h5t_string_f) call h5tis_variable_str_f(stored, has_length, status)
      if (points /= 1 .or. found /= class .or. has_length) call note(self, 'the attribute '//name//' is not one '// &
        trim(merge('text of fixed length', 'whole number        ', class == h5t_string_f)))
    end if
    call settle(self)
  end subroutine open_attribute

  module procedure look_long
  integer :: status
  integer(hid_t) :: attribute, stored
  integer(i8), target :: number(1)
  type(c_ptr) :: address

  value = 0
  if (allocated(self%error)) return
  call open_attribute(self, path, name, h5t_integer_f, attribute, stored)
  if (allocated(self%error)) return
  address = c_loc(number)
  call h5aread_f(attribute, long_type(), address, status)
  call check(self, status, 'cannot read the attribute '//name)
  if (status >= 0) value = number(1)
  call h5tclose_f(stored, status)
  call h5aclose_f(attribute, status)
  call settle(self)
  end procedure look_long

  module procedure look_text
  integer :: status, i
  integer(hid_t) :: attribute, text_type
  integer(size_t) :: length
  character(kind=c_char), allocatable, target :: letters(:)
  type(c_ptr) :: address

  value = ''
  if (allocated(self%error)) return
  call open_attribute(self, path, name, h5t_string_f, attribute, text_type)
  if (allocated(self%error)) return
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
  call settle(self)
  end procedure look_text
end submodule hdf5_attributes_with_hdf5
