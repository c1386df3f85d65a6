!> HDF5 files by the HDF5 library (1.10.7 or later), through its serial driver: MPI need not be started. Files that
!! ranks share go through its driver for MPI (hdf5_sharing_with_mpio).
!!
!! Files and failures are here; datasets and attributes in submodules of this one.
submodule(sg_hdf5) hdf5_with_hdf5
  use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_f_pointer, c_funloc, c_funptr, c_int, c_int64_t, c_loc, &
                                         c_null_char, c_null_ptr, c_ptr, c_size_t
  use hdf5, only: h5_integer_kind, h5dont_atexit_f, h5eset_auto_f, h5f_acc_rdonly_f, h5f_acc_rdwr_f, h5f_acc_trunc_f, &
                  h5f_close_strong_f, h5f_libver_earliest_f, h5f_libver_v110_f, h5f_scope_global_f, h5fclose_f, h5fcreate_f, &
                  h5fflush_f, h5fopen_f, h5gclose_f, h5gcreate_f, h5iis_valid_f, h5kind_to_type, h5lexists_f, h5open_f, &
                  h5p_file_access_f, h5pclose_f, h5pcreate_f, h5pset_fapl_core_f, h5pset_fclose_degree_f, h5pset_libver_bounds_f, &
                  h5t_native_double, hid_t, hsize_t
  use sg_c_library, only: c_strlen
  use sg_error, only: exit_output, fail
  use sg_settle_file, only: settle_file
  implicit none

  !> By how much files in memory grow [byte]
  integer(c_size_t), parameter :: piece_of_memory = 2_c_size_t**16

  !> What the library's stack of errors holds of one failure
  type, bind(c) :: stacked_error_t
    integer(c_int64_t) :: class, major, minor
    integer(c_int) :: line
    type(c_ptr) :: procedure, file, description
  end type stacked_error_t

  !> Innermost reason of a failure, as found by `keep_reason`
  type, bind(c) :: reason_t
    character(kind=c_char) :: text(400) = c_null_char
  end type reason_t

  interface
    !> Write the rows of this rank into a dataset: `n` numbers at an address, `before` of `total` rows after the first `first`.
    module subroutine write_rows(self, path, dataset, memory_type, components, first, before, total, n, address, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path
      integer(hid_t), intent(in) :: dataset, memory_type
      integer(hsize_t), intent(in) :: components, first
      integer(i8), intent(in) :: before, total
      integer, intent(in) :: n
      type(c_ptr), intent(in) :: address
      logical, intent(in), optional :: is_common
    end subroutine write_rows
  end interface

  ! What only a library made for MPI has; bodies in hdf5_sharing_with_mpio or hdf5_sharing_without_mpio.
  interface
    !> Can ranks share files?
    module function is_shareable() result(is_so)
      logical :: is_so
    end function is_shareable
    !> Make a file ready to be rewritten by all ranks, and let it be opened by all of them.
    module subroutine share_access(self, access, is_new)
      class(hdf5_file_t), intent(inout) :: self
      integer(hid_t), intent(in) :: access
      logical, intent(in) :: is_new
    end subroutine share_access
    !> Let all ranks write together.
    module subroutine share_transfer(self, list)
      class(hdf5_file_t), intent(inout) :: self
      integer(hid_t), intent(in) :: list
    end subroutine share_transfer
    !> Have the disk promise room for so many more bytes.
    module subroutine reserve_room(self, bytes)
      class(hdf5_file_t), intent(inout) :: self
      integer(i8), intent(in) :: bytes
    end subroutine reserve_room
    !> Give back the room of a closed file that it does not fill.
    module subroutine release_room(self)
      class(hdf5_file_t), intent(inout) :: self
    end subroutine release_room
  end interface

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
  end interface

contains

  module procedure hdf5_is_available
  is_available = .true.
  end procedure hdf5_is_available

  module procedure hdf5_is_parallel
  is_parallel = is_shareable()
  end procedure hdf5_is_parallel

  module procedure file_create
  integer :: status
  integer(hid_t) :: access, id

  call start(self, name, access)
  if (present(is_checked)) self%is_checked = is_checked
  ! The format of 1.10 has check sums over its metadata: where and what the datasets are.
  if (self%is_checked) call h5pset_libver_bounds_f(access, h5f_libver_v110_f, h5f_libver_v110_f, status)
  if (self%ranks%n_processes() > 1) call share_access(self, access, .true.)
  if (present(is_in_memory)) then
    if (is_in_memory) call h5pset_fapl_core_f(access, piece_of_memory, .true., status)
  end if
  if (self%ranks%leads_process() .and. .not. allocated(self%error)) then
    call h5fcreate_f(name, h5f_acc_trunc_f, id, status, access_prp=access)
    call check(self, status, 'cannot create the file')
  end if
  call opened(self, id, access)
  if (.not. allocated(self%error)) call reserve(self, 0_i8)
  end procedure file_create

  module procedure file_open
  integer :: status
  integer(hid_t) :: access, id

  call start(self, name, access)
  if (self%ranks%n_processes() > 1) call share_access(self, access, .false.)
  if (self%ranks%leads_process() .and. .not. allocated(self%error)) then
    call h5fopen_f(name, merge(h5f_acc_rdonly_f, h5f_acc_rdwr_f, is_read_only), id, status, access_prp=access)
    call check(self, status, 'cannot open the file')
  end if
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
    self%is_checked = .false.
    self%most_bytes = 0
    self%reserved = 0
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

  !> Keep the handle of a file that could be opened: that of the first subdomain of a process is one for all of them.
  subroutine opened(self, id, access)
    class(hdf5_file_t), intent(inout) :: self
    integer(hid_t), intent(in) :: id, access
    integer :: status
    type(comm_t) :: here

    if (self%ranks%leads_process() .and. .not. allocated(self%error)) self%id = id
    call h5pclose_f(access, status)
    call settle(self)
    if (self%ranks%n_here() == 1 .or. allocated(self%error)) return
    here = self%ranks
    here%traffic = traffic_t()
    call here%stay_here()
    call here%broadcast(self%id, 0)
    call self%ranks%collect(here)
  end subroutine opened

  !> Have the disk promise room for a dataset of so many bytes, and for the library's metadata of it: when the disk is
  !! full for some ranks alone, the others may wait for ever.
  subroutine reserve(self, bytes)
    class(hdf5_file_t), intent(inout) :: self
    integer(i8), intent(in) :: bytes

    if (self%ranks%size == 1) return
    if (self%ranks%n_processes() > 1) call reserve_room(self, bytes)
    call settle(self)
  end subroutine reserve

  !> A failure of one rank is one of all.
  subroutine settle(self)
    class(hdf5_file_t), intent(inout) :: self

    if (self%ranks%size > 1) call self%ranks%agree(self%error)
  end subroutine settle

  module procedure file_flush
  integer :: status

  if (allocated(self%error)) return
  if (self%ranks%leads_process()) then
    call h5fflush_f(int(self%id, hid_t), h5f_scope_global_f, status)
    call check(self, status, 'cannot write')
  end if
  ! The file has been cut to what it holds, and with it what was reserved.
  self%most_bytes = 0
  self%reserved = 0
  call settle(self)
  end procedure file_flush

  module procedure file_rename
  if (allocated(self%error)) return
  if (self%ranks%rank == 0) call settle_file(self%name, name, self%error)
  self%name = name
  call settle(self)
  end procedure file_rename

  module procedure file_close
  integer :: status

  if (self%id < 0) return
  if (self%ranks%leads_process()) then
    call h5fclose_f(int(self%id, hid_t), status)
    call check(self, status, 'cannot write')
  end if
  self%id = -1
  if (self%ranks%n_processes() > 1) call release_room(self)
  call settle(self)
  end procedure file_close

  module procedure file_group
  integer :: status
  integer(hid_t) :: group

  if (allocated(self%error)) return
  call reserve(self, 0_i8)
  if (allocated(self%error)) return
  if (self%ranks%leads_process()) then
    call h5gcreate_f(int(self%id, hid_t), path, group, status)
    call check(self, status, 'cannot make '//path)
    call h5gclose_f(group, status)
  end if
  call settle(self)
  end procedure file_group

  module procedure file_has
  integer :: status

  has = .false.
  if (allocated(self%error)) return
  call h5lexists_f(int(self%id, hid_t), path, has, status)
  has = has .and. status >= 0
  end procedure file_has

  !> Are rows the same on all ranks?
  pure logical function are_common(is_common)
    logical, intent(in), optional :: is_common

    are_common = .false.
    if (present(is_common)) are_common = is_common
  end function are_common

  !> Type of long integers in memory.
  integer(hid_t) function long_type()
    long_type = h5kind_to_type(i8, h5_integer_kind)
  end function long_type

  !> Keep the first failure, with the library's reason.
  subroutine check(self, status, what)
    class(hdf5_file_t), intent(inout) :: self
    integer, intent(in) :: status
    character(len=*), intent(in) :: what

    character(len=:), allocatable :: why

    if (status >= 0) return
    why = reason()
    if (len(why) > 0) why = ': '//why
    call note(self, what//why)
  end subroutine check

  !> Keep a failure, unless there was one before.
  subroutine note(self, message)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: message

    if (.not. allocated(self%error)) call fail(self%error, message, file=self%name, code=exit_output)
  end subroutine note

  !> Innermost reason of the last failure; where the operating system gave one, its words alone.
  function reason(is_of_system)
    logical, intent(out), optional :: is_of_system !! did the operating system give one?
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
    if (present(is_of_system)) is_of_system = i > 0
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
    call c_f_pointer(error%description, text, [c_strlen(error%description)])
    n = min(size(text), size(found%text) - 1)
    found%text(:n) = text(:n)
  end function keep_reason
end submodule hdf5_with_hdf5
