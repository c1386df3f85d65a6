!> Restart files: bit for bit, two in turn, and what is said of files that do not fit.
program test_restart
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use harness, only: tests_t
  use same_bits, only: same
  use sg_bodies, only: drop_rotation
  use sg_contactors, only: add_disk
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: diagnostics_t, error_t
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available
  use sg_kinds, only: wp, i1, i4, i8
  use sg_random, only: random_t
  use sg_restart, only: keep_state, read_restart, restart_t, restore_state, write_restart
  use sg_restart_files, only: newest_restart, restarts_of
  use sg_scene, only: scene_t
  use sg_system, only: file_exists, make_folder, remove_file
  use sg_text, only: text_t
  implicit none
  integer, parameter :: n_bodies = 50, n_contacts = 120
  character(len=*), parameter :: folder = 'restart', hash = 'cafe'
  type(tests_t) :: t
  type(comm_t) :: alone

  call t%check(make_folder(folder), 'the folder is there')
  call remove_file(folder//'/restart_a.h5')
  call remove_file(folder//'/restart_b.h5')
  if (hdf5_is_available()) then
    call test_round_trip()
    call test_no_contacts()
    call test_turns()
    call test_misfits()
    call test_spoilt_files()
    call test_spoilt_values()
    call test_no_room()
  else
    call test_without_library()
  end if
  call t%finish()

contains

  !> Bodies with one disk each, under one law.
  function some_scene(n) result(scene)
    integer, intent(in) :: n
    type(scene_t) :: scene
    integer :: b

    call scene%bodies%allocate(n)
    allocate (scene%laws(1))
    do b = 1, n
      call add_disk(scene%contactors, b, 1, 0.5_wp, [0.0_wp, 0.0_wp])
    end do
  end function some_scene

  !> A state of random numbers, of all sizes that a double has.
  subroutine some_state(scene, contacts, state)
    type(scene_t), intent(inout) :: scene
    type(contacts_t), intent(out) :: contacts
    type(restart_t), intent(out) :: state
    type(random_t) :: random
    integer :: i

    call random%seed(11)
    do i = 1, scene%bodies%n
      scene%bodies%position(:, i) = [wide(random), wide(random)]
      scene%bodies%velocity(1:2, i) = [wide(random), wide(random)]
      scene%bodies%crossings(i) = int(i, i4) - 20_i4
      if (allocated(scene%bodies%angle)) scene%bodies%angle(i) = wide(random)
    end do
    call reserve_contacts(contacts, n_contacts)
    contacts%n = n_contacts
    do i = 1, n_contacts
      contacts%contactor(:, i) = 1_i4 + [mod(i, scene%bodies%n), mod(7*i, scene%bodies%n)]
      contacts%body(:, i) = contacts%contactor(:, i)
      contacts%feature(i) = int(1000*i, i4)
      contacts%image(i) = int(mod(i, 3) - 1, i1)
      contacts%status(i) = int(mod(i, 5), i1)
      contacts%impulse(:, i) = [wide(random), wide(random)]
    end do
    contacts%law = 1
    call keep_state(scene%bodies, contacts, state)
    state%step = 1234
    state%time = 0.1_wp + 0.2_wp
    state%deck_hash = hash
    state%built = reshape([(wide(random), i=1, size(scene%bodies%middle))], shape(scene%bodies%middle))
    state%totals = [(wide(random), i=1, 5)]
  end subroutine some_state

  !> A random number between 1e-300 and 1e300 in size.
  real(wp) function wide(random)
    type(random_t), intent(inout) :: random

    wide = (random%uniform() - 0.5_wp)*10.0_wp**nint(600*(random%uniform() - 0.5_wp))
  end function wide

  !> What is written is read.
  subroutine test_round_trip()
    type(scene_t) :: scene, other
    type(contacts_t) :: contacts, recovered
    type(restart_t) :: state, back
    type(error_t), allocatable :: error
    type(diagnostics_t) :: diagnostics

    scene = some_scene(n_bodies)
    call some_state(scene, contacts, state)
    call write_restart(folder, state, alone, error)
    call t%check(.not. allocated(error), 'a restart file is written')
    call t%check(newest_restart(folder) == folder//'/restart_a.h5', 'it is the newest')
    call t%check(.not. file_exists(folder//'/restart_a.h5.part'), 'nothing unfinished is left')
    other = some_scene(n_bodies)
    call read_restart(newest_restart(folder), other, hash, alone, back, diagnostics)
    call t%equal(diagnostics%count(), 0, 'it is read')
    if (diagnostics%count() > 0) return
    call t%check(.not. allocated(diagnostics%warnings), 'without a warning')
    call t%equal(back%step, 1234, 'step')
    call t%check(same([back%time], [state%time]), 'time')
    call t%check(same(back%totals, state%totals), 'totals')
    call t%check(all(shape(back%built) == shape(state%built)) .and. same(back%built, state%built), 'built')
    call restore_state(back, other, recovered)
    call t%check(same(other%bodies%position, scene%bodies%position), 'position')
    call t%check(same(other%bodies%velocity, scene%bodies%velocity), 'velocity')
    call t%check(same(other%bodies%angle, scene%bodies%angle), 'angle')
    call t%check(all(other%bodies%crossings == scene%bodies%crossings), 'crossings')
    call t%equal(recovered%n, n_contacts, 'contacts')
    call t%check(same(recovered%impulse(:, :n_contacts), contacts%impulse(:, :n_contacts)), 'impulses')
    call t%check(all(recovered%contactor(:, :n_contacts) == contacts%contactor(:, :n_contacts)), 'contactors')
    call t%check(all(recovered%body(:, :n_contacts) == contacts%body(:, :n_contacts)), 'bodies of contacts')
    call t%check(all(recovered%feature(:n_contacts) == contacts%feature(:n_contacts)), 'features')
    call t%check(all(recovered%image(:n_contacts) == contacts%image(:n_contacts)), 'images')
    call t%check(all(recovered%status(:n_contacts) == contacts%status(:n_contacts)), 'statuses')
    call t%check(all(recovered%law(:n_contacts) == 1), 'laws')
  end subroutine test_round_trip

  !> A scene without rotation, friction or contact, and nothing in `built` and `totals`.
  subroutine test_no_contacts()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(restart_t) :: state, back
    type(error_t), allocatable :: error
    type(diagnostics_t) :: diagnostics

    scene = some_scene(3)
    call drop_rotation(scene%bodies, keep_orientation=.false.)
    scene%bodies%position(1, 2) = 4
    contacts%n_components = 1
    call keep_state(scene%bodies, contacts, state)
    state%deck_hash = hash
    state%step = 2000
    allocate (state%built(2, 0), state%totals(0))
    call write_restart(folder, state, alone, error)
    call t%check(.not. allocated(error), 'a state without contacts is written')
    call read_restart(newest_restart(folder), scene, hash, alone, back, diagnostics, components=1)
    call t%equal(diagnostics%count(), 0, 'and read')
    call restore_state(back, scene, contacts)
    call t%equal(contacts%n, 0, 'no contacts')
    call t%equal(contacts%n_components, 1, 'of one component')
    call t%near(scene%bodies%position(1, 2), 4.0_wp, 0.0_wp, 'position')
  end subroutine test_no_contacts

  !> The older file is replaced.
  subroutine test_turns()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(restart_t) :: state
    type(error_t), allocatable :: error
    type(text_t), allocatable :: files(:)
    integer :: i

    scene = some_scene(n_bodies)
    call some_state(scene, contacts, state)
    do i = 1, 4
      state%step = 3000 + i
      call write_restart(folder, state, alone, error)
      call t%check(.not. allocated(error), 'a file is written')
      call t%check(newest_restart(folder) == folder//'/restart_'//merge('a', 'b', mod(i, 2) == 1)//'.h5', 'in turn')
    end do
    state%step = 10
    call write_restart(folder, state, alone, error)
    call t%check(newest_restart(folder) == folder//'/restart_a.h5', 'what is written last counts, also at an earlier step')
    call t%check(newest_restart('no/such/folder') == '', 'a missing folder has no restart file')
    files = restarts_of('no/such/folder')
    call t%equal(size(files), 0, 'nor are there any to choose from')
    files = restarts_of(folder)
    call t%equal(size(files), 2, 'two files to choose from')
    call t%check(files(1)%s == folder//'/restart_a.h5' .and. files(2)%s == folder//'/restart_b.h5', 'the newest first')
  end subroutine test_turns

  !> Files of other scenes and decks.
  subroutine test_misfits()
    type(scene_t) :: scene
    type(restart_t) :: state
    type(diagnostics_t) :: diagnostics

    scene = some_scene(n_bodies)
    call read_restart(newest_restart(folder), scene, 'beef', alone, state, diagnostics)
    call t%equal(diagnostics%count(), 0, 'another deck is no error')
    call t%check(allocated(diagnostics%warnings), 'but a warning')
    call expect(some_scene(n_bodies + 1), newest_restart(folder), 'it holds 50 bodies, the scene 51')
    call drop_rotation(scene%bodies, keep_orientation=.false.)
    call expect(scene, newest_restart(folder), 'only one of them has bodies that turn')
    scene = some_scene(n_bodies)
    scene%contactors%n = n_bodies - 1
    call expect(scene, newest_restart(folder), 'shapes that the scene does not have')
    scene = some_scene(n_bodies)
    deallocate (scene%laws)
    call expect(scene, newest_restart(folder), 'laws that the scene does not have')
  end subroutine test_misfits

  !> One error is expected, which says something.
  subroutine expect(scene, name, words)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: name, words
    type(restart_t) :: state
    type(diagnostics_t) :: diagnostics

    call read_restart(name, scene, hash, alone, state, diagnostics)
    call t%equal(diagnostics%count(), 1, 'one error: '//words)
    if (diagnostics%count() /= 1) return
    call t%check(index(diagnostics%errors(1)%message, words) > 0, words//' is said, not: '//diagnostics%errors(1)%message)
    call t%check(diagnostics%errors(1)%file == name, 'and of which file')
  end subroutine expect

  !> Truncated, foreign and missing files.
  subroutine test_spoilt_files()
    type(scene_t) :: scene
    type(hdf5_file_t) :: file
    character(len=:), allocatable :: bytes, name
    integer :: unit, length, i

    scene = some_scene(n_bodies)
    name = folder//'/spoilt.h5'
    open (newunit=unit, file=newest_restart(folder), access='stream', form='unformatted', status='old', action='read')
    inquire (unit=unit, size=length)
    allocate (character(len=length) :: bytes)
    read (unit) bytes
    close (unit)
    do i = 0, 9
      open (newunit=unit, file=name, access='stream', form='unformatted', status='replace')
      write (unit) bytes(:length*i/10)
      close (unit)
      call expect(scene, name, 'cannot open the file')
    end do
    call file%create(name)
    call file%put('/numbers', [1.0_wp])
    call file%close()
    call expect(scene, name, 'this is no restart file of SplitGrain')
    call expect(scene, folder//'/missing.h5', 'No such file or directory')
  end subroutine test_spoilt_files

  !> Files with right check sums that no run writes: values, sizes, and attributes that are lists.
  subroutine test_spoilt_values()
    character(len=70), parameter :: said(9) = [character(len=70) :: &
      'damaged: it holds numbers that are not finite', 'damaged: it holds numbers that are not finite', &
      'damaged: it holds numbers that are not finite', 'damaged: it holds contacts in a state that there is none', &
      'damaged: it holds contacts across more periods', 'its step is -1', '/built has 7 rows of 3 numbers, not 50 of 3', &
      '/contacts/impulse has 120 rows of 1 numbers, not 120 of 2', '/bodies/crossings has 49 rows of 1 numbers, not 50 of 1']
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(restart_t) :: state
    type(hdf5_file_t) :: file
    type(error_t), allocatable :: error
    real(wp) :: nan
    integer :: i

    nan = ieee_value(nan, ieee_quiet_nan)
    do i = 1, size(said)
      scene = some_scene(n_bodies)
      call some_state(scene, contacts, state)
      if (i == 1) state%angle(7) = nan
      if (i == 2) state%time = nan
      if (i == 3) state%built(2, 9) = nan
      if (i == 4) state%status(3) = 77
      if (i == 5) state%image(3) = 1000
      if (i == 6) state%step = -1
      if (i == 7) state%built = state%built(:, :7)
      if (i == 8) state%impulse = state%impulse(:1, :)
      if (i == 9) state%crossings = state%crossings(2:)
      call write_restart(folder, state, alone, error)
      call t%check(.not. allocated(error), 'it is written')
      call expect(scene, newest_restart(folder), trim(said(i)))
    end do
    call file%create(folder//'/list.h5')
    call file%set('/', 'format', 'SplitGrain restart')
    call file%set('/', 'format_version', [(2_i8, i=1, 100)])
    call file%close()
    call expect(scene, folder//'/list.h5', 'the attribute format_version is not one whole number')
  end subroutine test_spoilt_values

  !> Where nothing can be written there is one clear error, and the old file stays.
  subroutine test_no_room()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(restart_t) :: state
    type(error_t), allocatable :: error
    logical :: is_made

    scene = some_scene(n_bodies)
    call some_state(scene, contacts, state)
    call write_restart('no/such/folder', state, alone, error)
    call t%check(allocated(error), 'a missing folder is noticed')
    ! A folder that bears the name of the file stands in the way, even of a superuser.
    is_made = make_folder('restart_blocked/restart_a.h5.part/x')
    call write_restart('restart_blocked', state, alone, error)
    call t%check(is_made .and. allocated(error), 'a blocked name is noticed')
  end subroutine test_no_room

  !> Without the library there is one clear error.
  subroutine test_without_library()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(restart_t) :: state
    type(error_t), allocatable :: error

    write (*, '(a)') 'built without HDF5: the files themselves are not tested'
    scene = some_scene(n_bodies)
    call some_state(scene, contacts, state)
    call write_restart(folder, state, alone, error)
    call t%check(allocated(error), 'restart files need HDF5')
    if (allocated(error)) call t%check(index(error%message, 'HDF5') > 0, 'and the error says so')
    call t%check(newest_restart(folder) == '', 'there is none')
    call expect(scene, folder//'/restart_a.h5', 'HDF5')
  end subroutine test_without_library
end program test_restart
