!> HDF5 files copied object by object into new ones: the index of the old one, which may be damaged, is read and never changed.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_copies_with_hdf5
  ! gfortran 12 refuses to use again what the parent uses already: the kinds and some constants come from there.
  use hdf5, only: h5_index_name_f, h5_iter_inc_f, h5aclose_f, h5acreate_f, h5aget_name_f, h5aget_num_attrs_f, h5aget_space_f, &
                  h5aget_type_f, h5aopen_by_idx_f, h5aread_f, h5awrite_f, h5ocopy_f, h5sclose_f, &
                  h5sget_simple_extent_npoints_f, h5t_dir_ascend_f, h5tclose_f, h5tget_native_type_f, h5tget_size_f, &
                  size_t
  use sg_error, only: exit_bad_input
  use sg_trial, only: begin_trial, end_trial, is_in, is_survived
  implicit none

  !> Longest name of an attribute that is copied
  integer(size_t), parameter :: longest_attribute = 256

contains

  ! HDF5 1.10 crashes where it copies some damaged objects.
  module procedure file_take
  integer :: trial

  trial = begin_trial()
  if (is_in(trial)) then
    call take_objects(self, source, except)
    call end_trial()
  end if
  if (is_survived(trial)) then
    call take_objects(self, source, except)
  else if (.not. allocated(self%error)) then
    call fail(self%error, 'cannot copy what it holds, is the file damaged? (HDF5 crashes)', file=source%name, code=exit_bad_input)
  end if
  end procedure file_take

  !> Copy the attributes of the root group, and all in it but one object.
  subroutine take_objects(self, source, except)
    class(hdf5_file_t), intent(inout) :: self
    class(hdf5_file_t), intent(inout) :: source
    character(len=*), intent(in) :: except
    type(text_t), allocatable :: names(:)
    integer :: status, i

    call source%names('/', names)
    if (.not. (allocated(self%error) .or. allocated(source%error))) call take_attributes(self, source)
    do i = 1, size(names)
      if (names(i)%s == except .or. allocated(self%error)) cycle
      call h5ocopy_f(int(source%id, hid_t), names(i)%s, int(self%id, hid_t), names(i)%s, status)
      call check_copy(self, source, status, '/'//names(i)%s)
    end do
    if (allocated(source%error) .and. .not. allocated(self%error)) self%error = source%error
  end subroutine take_objects

  !> Copy the attributes of the root group.
  subroutine take_attributes(self, source)
    class(hdf5_file_t), intent(inout) :: self
    class(hdf5_file_t), intent(in) :: source
    integer(hid_t) :: attribute
    integer :: status, closed, n, i

    call h5aget_num_attrs_f(int(source%id, hid_t), n, status)
    call check_copy(self, source, status, 'the attributes of /')
    do i = 0, n - 1
      if (allocated(self%error)) exit
      call h5aopen_by_idx_f(int(source%id, hid_t), '/', h5_index_name_f, h5_iter_inc_f, int(i, hsize_t), attribute, status)
      if (status >= 0) call copy_attribute(attribute, int(self%id, hid_t), status)
      call check_copy(self, source, status, 'an attribute of /')
      call h5aclose_f(attribute, closed)
    end do
  end subroutine take_attributes

  !> Copy one attribute to another object; its items, of any type, are taken as the library holds them in memory.
  subroutine copy_attribute(old, object, status)
    integer(hid_t), intent(in) :: old, object
    integer, intent(out) :: status
    integer(hid_t) :: item_type, memory_type, space, new
    integer(hsize_t) :: items
    integer(size_t) :: bytes
    character(len=longest_attribute) :: name
    character(kind=c_char), allocatable, target :: memory(:)
    type(c_ptr) :: address
    integer :: closed

    call h5aget_type_f(old, item_type, status)
    if (status >= 0) call h5tget_native_type_f(item_type, h5t_dir_ascend_f, memory_type, status)
    if (status >= 0) call h5tget_size_f(memory_type, bytes, status)
    if (status >= 0) call h5aget_space_f(old, space, status)
    if (status >= 0) call h5sget_simple_extent_npoints_f(space, items, status)
    if (status >= 0) call h5aget_name_f(old, longest_attribute, name, status)
    if (status < 0) return
    allocate (memory(max(1_hsize_t, items*bytes)), stat=status)
    status = -status
    if (status < 0) return
    address = c_loc(memory)
    call h5aread_f(old, memory_type, address, status)
    if (status >= 0) call h5acreate_f(object, trim(name), item_type, space, new, status)
    if (status < 0) return
    call h5awrite_f(new, memory_type, address, status)
    call h5aclose_f(new, closed)
    call h5sclose_f(space, closed)
    call h5tclose_f(memory_type, closed)
    call h5tclose_f(item_type, closed)
  end subroutine copy_attribute

  !> Keep the first failure of a copy. It is that of the old file, unless the system refused to write.
  subroutine check_copy(self, source, status, what)
    class(hdf5_file_t), intent(inout) :: self
    class(hdf5_file_t), intent(in) :: source
    integer, intent(in) :: status
    character(len=*), intent(in) :: what
    character(len=:), allocatable :: why
    logical :: is_of_system

    if (status >= 0 .or. allocated(self%error)) return
    why = reason(is_of_system)
    if (is_of_system) then
      call note(self, 'cannot write '//what//': '//why)
    else
      call fail(self%error, 'cannot copy '//what//', is the file damaged? ('//why//')', file=source%name, code=exit_bad_input)
    end if
  end subroutine check_copy
end submodule hdf5_copies_with_hdf5
