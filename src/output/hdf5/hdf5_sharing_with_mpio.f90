!> HDF5 files that ranks share: the library's driver for MPI.
!!
!! A disk that fills while HDF5 writes is noticed by some ranks alone, and the others wait for them. So the room is taken
!! beforehand, by rank 0, and a full disk is an error on all ranks before anything is written.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_sharing_with_mpio
  ! gfortran 12 refuses to use again what the parent uses already: the kinds and some constants come from there.
  use hdf5, only: h5fd_mpio_collective_f, h5pset_coll_metadata_write_f, h5pset_dxpl_mpio_f, &
                  h5pset_fapl_mpio_f
  implicit none

  !> Bytes that are reserved at least, and room for what the library keeps of one dataset or attribute (its header, and
  !> the first nodes of its tree of chunks) [byte]
  integer(i8), parameter :: least_room = 2_i8**18, room_for_one = 2_i8**14

  interface
    function c_reserve(path, bytes, is_new, why, length) bind(c, name='splitgrain_reserve') result(status)
      import :: c_char, c_int, c_int64_t
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int64_t), value :: bytes
      integer(c_int), value :: is_new
      character(kind=c_char), intent(inout) :: why(*)
      integer(c_int), value :: length
      integer(c_int) :: status
    end function c_reserve
    subroutine c_release(path) bind(c, name='splitgrain_release')
      import :: c_char
      character(kind=c_char), intent(in) :: path(*)
    end subroutine c_release
  end interface

contains

  module procedure is_shareable
  is_so = .true.
  end procedure is_shareable

  module procedure share_access
  integer :: status

  ! A file that cannot be made or filled is refused before all ranks begin to make it together.
  if (is_new) then
    call take_room(self, least_room, is_new=.true.)
    call settle(self)
    if (allocated(self%error)) return
  end if
  if (.not. self%ranks%leads_process()) return
  call h5pset_fapl_mpio_f(access, self%ranks%handle(), self%ranks%no_hints(), status)
  call check(self, status, 'cannot share files between ranks')
  ! Ranks that write the file's metadata one by one may wait for each other for ever.
  call h5pset_coll_metadata_write_f(access, .true., status)
  call check(self, status, 'cannot share files between ranks')
  end procedure share_access

  module procedure share_transfer
  integer :: status

  call h5pset_dxpl_mpio_f(list, h5fd_mpio_collective_f, status)
  call check(self, status, 'cannot write together')
  end procedure share_transfer

  module procedure reserve_room
  integer(i8) :: now

  if (self%ranks%rank > 0) return
  if (self%most_bytes == 0) then
    inquire (file=self%name, size=now)
    self%most_bytes = max(0_i8, now)
  end if
  self%most_bytes = self%most_bytes + bytes + room_for_one
  if (self%most_bytes <= self%reserved) return
  self%reserved = self%most_bytes + least_room
  call take_room(self, self%reserved, is_new=.false.)
  end procedure reserve_room

  module procedure release_room
  if (self%ranks%rank == 0) call c_release(self%name//c_null_char)
  self%reserved = 0
  self%most_bytes = 0
  end procedure release_room

  !> Have rank 0 take room on the disk for so many bytes in all.
  subroutine take_room(self, bytes, is_new)
    class(hdf5_file_t), intent(inout) :: self
    integer(i8), intent(in) :: bytes
    logical, intent(in) :: is_new
    character(kind=c_char) :: why(200)
    character(len=:), allocatable :: reason
    integer :: i

    if (self%ranks%rank > 0) return
    if (c_reserve(self%name//c_null_char, bytes, merge(1_c_int, 0_c_int, is_new), why, size(why)) == 0) return
    reason = ''
    do i = 1, size(why)
      if (why(i) == c_null_char) exit
      reason = reason//why(i)
    end do
    call note(self, trim(merge('cannot create the file', 'cannot write          ', is_new))//': '//reason)
  end subroutine take_room
end submodule hdf5_sharing_with_mpio
