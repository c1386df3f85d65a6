!> Lock of a folder of results: a file with host and process of the run that writes there, so that no other run joins it.
!!
!! A run that was killed leaves its lock. On the same host it is recognised by its process, which has ended; on another host
!! its process cannot be examined, and the user decides (`--force`). A lock gets its name when it is whole, so that a kill never
!! leaves one without a process.
module sg_run_lock
  use sg_error, only: error_t, fail
  use sg_list_files, only: list_files
  use sg_processes, only: host_name, is_alive, own_process, start_of
  use sg_system, only: file_exists, link_file, remove_file, rename_file
  use sg_text, only: read_lines, text_t, to_text
  use sg_text_files, only: create_text
  implicit none
  private
  public :: lock_name, release_lock, take_lock

  !> Name of the lock within a folder of results
  character(len=*), parameter :: lock_name = 'run.lock'

  !> The run that a lock names
  type :: holder_t
    character(len=:), allocatable :: host, start
    integer :: process = 0
  end type holder_t

contains

  !> Lock a folder for this process.
  subroutine take_lock(folder, is_forced, error)
    character(len=*), intent(in) :: folder !! folder of results, which exists
    logical, intent(in) :: is_forced !! take the folder over from another host?
    type(error_t), allocatable, intent(out) :: error !! set when another run holds it, or the lock cannot be written
    character(len=:), allocatable :: name
    type(error_t), allocatable :: taken
    integer :: attempt

    name = folder//'/'//lock_name
    do attempt = 1, 2
      call create_lock(name, taken)
      if (.not. allocated(taken)) call remove_left_names(folder//'/')
      if (.not. allocated(taken)) return
      if (.not. file_exists(name)) exit
      call judge_holder(name, is_forced, error)
      if (allocated(error)) return
      call remove_stale(name)
    end do
    call move_alloc(taken, error)
  end subroutine take_lock

  !> Write a lock under a name of this process, and link it to its own name, which must not exist. Where files have one name only,
  !! it is written in place.
  subroutine create_lock(name, error)
    character(len=*), intent(in) :: name
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: aside
    logical :: is_linked

    aside = own_name(name)
    call remove_file(aside)
    call create_text(aside, lock_text(), error)
    is_linked = .false.
    if (.not. allocated(error)) is_linked = link_file(aside, name)
    call remove_file(aside)
    if (.not. is_linked) call create_text(name, lock_text(), error)
  end subroutine create_lock

  !> Name next to a lock that this process alone uses.
  function own_name(name)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: own_name

    own_name = name//'.'//host_name()//'.'//to_text(own_process())
  end function own_name

  !> Unlock a folder that this process has locked.
  subroutine release_lock(folder)
    character(len=*), intent(in) :: folder !! folder of results
    type(holder_t) :: holder

    call read_holder(folder//'/'//lock_name, holder)
    if (is_own(holder)) call remove_file(folder//'/'//lock_name)
  end subroutine release_lock

  !> Content of the lock of this process.
  function lock_text() result(text)
    character(len=:), allocatable :: text

    text = 'host '//host_name()//new_line('a')//'process '//to_text(own_process())//new_line('a')//'started '// &
           start_of(own_process())//new_line('a')
  end function lock_text

  !> Read a lock; what cannot be read names process 0.
  subroutine read_holder(name, holder)
    character(len=*), intent(in) :: name
    type(holder_t), intent(out) :: holder
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    integer :: i, blank, status

    holder%host = ''
    holder%start = '0'
    call read_lines(name, lines, error)
    if (allocated(error)) return
    do i = 1, size(lines)
      associate (line => lines(i)%s)
        blank = index(line//' ', ' ')
        if (line(:blank - 1) == 'host') holder%host = line(blank + 1:)
        if (line(:blank - 1) == 'started') holder%start = line(blank + 1:)
        if (line(:blank - 1) == 'process') read (line(blank + 1:), '(i20)', iostat=status) holder%process
      end associate
    end do
  end subroutine read_holder

  !> Is a lock that of this process?
  logical function is_own(holder)
    type(holder_t), intent(in) :: holder

    is_own = holder%host == host_name() .and. holder%process == own_process()
  end function is_own

  !> Set an error where the holder of a lock may still write.
  subroutine judge_holder(name, is_forced, error)
    character(len=*), intent(in) :: name
    logical, intent(in) :: is_forced
    type(error_t), allocatable, intent(out) :: error
    type(holder_t) :: holder

    call read_holder(name, holder)
    if (holder%process == 0) then
      if (.not. is_forced) call fail(error, 'this lock names no process; if no run writes to the folder, --force takes it over', &
                                     file=name)
    else if (holder%host == host_name()) then
      if (is_alive(holder%process, holder%start)) call fail(error, 'another run writes to this folder, process '// &
        to_text(holder%process)//' of this host; --output names another folder', file=name)
    else if (.not. is_forced) then
      call fail(error, 'another run writes to this folder, process '//to_text(holder%process)//' of host '//holder%host// &
                '; if it has ended, --force takes the folder over', file=name)
    end if
  end subroutine judge_holder

  !> Remove the lock of a run that has ended. Of several processes that come to this at once one alone moves it away; a lock that
  !! came meanwhile is put back.
  subroutine remove_stale(name)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: aside
    type(error_t), allocatable :: error

    aside = own_name(name)
    if (.not. rename_file(name, aside)) return
    call judge_holder(aside, .true., error)
    if (allocated(error)) then
      if (rename_file(aside, name)) return
    end if
    call remove_file(aside)
  end subroutine remove_stale

  !> Remove the names that processes of this host used next to a lock and kept, since they were killed while they took it.
  subroutine remove_left_names(folder)
    character(len=*), intent(in) :: folder !! folder of results, with a slash
    type(text_t), allocatable :: files(:)
    character(len=:), allocatable :: start
    type(holder_t) :: holder
    integer :: i, process, status

    call list_files(folder, lock_name//'.'//host_name()//'.*', files)
    do i = 1, size(files)
      associate (file => files(i)%s)
        read (file(index(file, '.', back=.true.) + 1:), '(i20)', iostat=status) process
        if (status /= 0) cycle
        ! A file without text may be one that its process has just created.
        call read_holder(file, holder)
        start = holder%start
        if (holder%process == 0) start = start_of(process)
        if (.not. is_alive(process, start)) call remove_file(file)
      end associate
    end do
  end subroutine remove_left_names
end module sg_run_lock
