!> Memory that this process may still take: of the machine, of its control group, and by its own limits (`ulimit -v`, `ulimit -d`).
!!
!! Linux grants memory that it does not have and kills processes that use it. So tables that may grow without bound ask here
!! before they grow, and the run ends in good order where there is no room.
module sg_memory
  use, intrinsic :: iso_c_binding, only: c_int, c_long
  use sg_kinds, only: wp, i8
  use sg_text, only: to_text
  implicit none
  private
  public :: memory_t, gigabytes, bytes_per_grain

  !> Memory of a grain with its shape, its share of neighbours and contacts, and of the contact problem, rounded up [bytes]
  integer(i8), parameter :: bytes_per_grain = 2000
  !> What may be taken without a look [bytes]: looks read files of the system, which takes 0.1 ms
  integer(i8), parameter :: small = 8_i8*2_i8**20
  !> What is left to a checkpoint, to messages, and to tables that grow with the bodies alone [bytes], and as a share of the rest
  integer(i8), parameter :: reserve = 32_i8*2_i8**20
  real(wp), parameter :: reserved_share = 0.05_wp
  !> Numbers of the limits for data and for addresses on Linux
  integer(c_int), parameter :: rlimit_data = 2, rlimit_as = 9

  !> What a process may take
  type :: memory_t
    !> Processes and subdomains on this machine that take alike, and share what it has
    integer :: sharers = 1
    !> Subdomains that share this process
    integer :: subdomains = 1
  contains
    procedure :: fits => memory_fits
    procedure :: left => memory_left
  end type memory_t

  !> Limits as the system reports them; negative for none
  type, bind(c) :: limit_t
    integer(c_long) :: now, most
  end type limit_t

  interface
    function c_getrlimit(resource, limit) bind(c, name='getrlimit') result(status)
      import :: c_int, limit_t
      integer(c_int), value :: resource
      type(limit_t), intent(out) :: limit
      integer(c_int) :: status
    end function c_getrlimit
  end interface

contains

  !> Is there room for some more bytes, with a reserve for what must still be done afterwards?
  logical function memory_fits(self, bytes) result(fits)
    class(memory_t), intent(in) :: self
    integer(i8), intent(in) :: bytes !! to be taken [bytes]
    integer(i8) :: room

    fits = bytes <= small
    if (fits) return
    call self%left(room)
    fits = bytes <= room - reserve - int(reserved_share*real(room, wp), i8)
  end function memory_fits

  !> Free memory, and the limit that is the nearest. Where the system reports none, there is no limit.
  subroutine memory_left(self, bytes, limit)
    class(memory_t), intent(in) :: self
    integer(i8), intent(out) :: bytes !! [bytes]; the largest number where there is no limit
    character(len=:), allocatable, intent(out), optional :: limit !! the origin of the limit, as a phrase
    integer(i8) :: room(4)
    integer :: nearest

    room(1) = field_of('/proc/meminfo', 'MemAvailable:')*1024
    if (room(1) < 0) room(1) = huge(room)
    room(2) = left_of_groups()
    room(:2) = room(:2)/int(max(1, self%sharers), i8)
    room(3) = left_of_limit(rlimit_as, 'VmSize:')/int(self%subdomains, i8)
    room(4) = left_of_limit(rlimit_data, 'VmData:')/int(self%subdomains, i8)
    nearest = minloc(room, 1)
    bytes = max(0_i8, room(nearest))
    if (.not. present(limit)) return
    select case (nearest)
    case (1)
      limit = 'this machine'
    case (2)
      limit = 'the control group (cgroup) of this process'
    case (3)
      limit = '"ulimit -v"'
    case default
      limit = '"ulimit -d"'
    end select
  end subroutine memory_left

  !> A size as a text, in gigabytes or, when it is small, in megabytes.
  function gigabytes(bytes) result(text)
    real(wp), intent(in) :: bytes !! [bytes]
    character(len=:), allocatable :: text

    if (bytes < 1e9_wp) then
      text = to_text(nint(bytes/1e6_wp))//' MB'
    else if (bytes < 1e14_wp) then
      text = to_text(nint(bytes/1e8_wp)/10)//'.'//to_text(modulo(nint(bytes/1e8_wp), 10))//' GB'
    else
      text = to_text(bytes/1e9_wp, 2)//' GB'
    end if
  end function gigabytes

  !> What a limit of this process leaves [bytes].
  integer(i8) function left_of_limit(resource, used) result(left)
    integer(c_int), intent(in) :: resource
    character(len=*), intent(in) :: used !! what counts against it, as /proc/self/status names it
    type(limit_t) :: limit

    left = huge(left)
    if (c_getrlimit(resource, limit) /= 0) return
    if (limit%now < 0) return
    left = int(limit%now, i8) - max(0_i8, field_of('/proc/self/status', used)*1024)
  end function left_of_limit

  !> What the control groups of this process leave, the nearest limit of all of them [bytes].
  integer(i8) function left_of_groups() result(left)
    character(len=1000) :: line
    integer :: unit, status, cut

    left = huge(left)
    open (newunit=unit, file='/proc/self/cgroup', status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      cut = index(line, ':', back=.true.)
      if (line(:3) == '0::') then
        left = min(left, left_of_tree('/sys/fs/cgroup', trim(line(cut + 1:)), ['memory.max    ', 'memory.current'], '', 10))
      else if (index(line(:cut), ':memory:') > 0) then
        left = min(left, left_of_tree('/sys/fs/cgroup/memory', trim(line(cut + 1:)), &
                                      ['memory.limit_in_bytes', 'memory.usage_in_bytes'], 'total_', 10))
      end if
    end do
    close (unit)
  end function left_of_groups

  !> What a group and those about it leave [bytes]. Pages of files count as used, and are given back when memory is short.
  recursive integer(i8) function left_of_tree(root, path, names, prefix, depth) result(left)
    character(len=*), intent(in) :: root !! folder of all groups
    character(len=*), intent(in) :: path !! of the group below it
    character(len=*), intent(in) :: names(2) !! files of the limit and of what is used
    character(len=*), intent(in) :: prefix !! of names in memory.stat
    integer, intent(in) :: depth !! groups to look at
    integer(i8) :: most, used
    character(len=:), allocatable :: folder

    folder = root//path//'/'
    left = huge(left)
    most = field_of(folder//trim(names(1)), '')
    used = field_of(folder//trim(names(2)), '')
    if (most >= 0 .and. used >= 0) then
      left = most - used + max(0_i8, field_of(folder//'memory.stat', prefix//'inactive_file')) &
             + max(0_i8, field_of(folder//'memory.stat', prefix//'active_file'))
    end if
    if (depth > 0 .and. len(path) > 0) &
      left = min(left, left_of_tree(root, path(:max(0, index(path, '/', back=.true.) - 1)), names, prefix, depth - 1))
  end function left_of_tree

  !> Number that stands after a word at the beginning of a line of a file; -1 where there is none.
  integer(i8) function field_of(file, word) result(value)
    character(len=*), intent(in) :: file !! a file of the system
    character(len=*), intent(in) :: word !! the first word of the line; empty for a file of one number
    character(len=200) :: line
    integer :: unit, status

    value = -1
    open (newunit=unit, file=file, status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (line(:len(word)) /= word) cycle
      if (len(word) > 0 .and. scan(line(len(word) + 1:len(word) + 1), ' '//achar(9)) == 0) cycle
      line = line(len(word) + 1:)
      if (index(line, 'kB') > 0) line(index(line, 'kB'):) = ''
      read (line, *, iostat=status) value
      if (status /= 0) value = -1
      exit
    end do
    close (unit)
  end function field_of
end module sg_memory
