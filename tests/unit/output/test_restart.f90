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
  use sg_field_visitor, only: kind_real
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available
  use sg_kinds, only: wp, i1, i4, i8
  use sg_random, only: random_t
  use sg_restart, only: keep_state, read_restart, restart_t, restore_state, write_restart
  use sg_restart_fields, only: keep_fields, kept_field_t, restore_fields
  use sg_restart_files, only: newest_restart, restarts_of
  use sg_restart_fit, only: holds_spins
  use sg_scene, only: scene_t
  use sg_space_contactors, only: add_sphere
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
    call test_all_fields(2, turns=.true.)
    call test_all_fields(2, turns=.false.)
    call test_all_fields(3, turns=.true.)
    call test_all_fields(3, turns=.false.)
    call test_no_contacts()
    call test_turns()
    call test_misfits()
    call test_other_components(2)
    call test_other_components(3)
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
    state%built = reshape([(wide(random), i=1, 4*n_bodies)], [4, n_bodies])
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
    call read_restart(newest_restart(folder), other, alone, back, diagnostics)
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

  !> Every field that files hold of a kind of scene comes back bit for bit.
  subroutine test_all_fields(dimension, turns)
    integer, intent(in) :: dimension
    logical, intent(in) :: turns
    type(scene_t) :: scene, other
    type(contacts_t) :: contacts, recovered
    type(restart_t) :: state, back
    type(kept_field_t), allocatable :: written(:), read(:)
    type(error_t), allocatable :: error
    type(diagnostics_t) :: diagnostics

    if (dimension == 2) scene = some_scene(n_bodies)
    if (dimension == 3) scene = spatial_scene(n_bodies)
    if (.not. turns) call drop_rotation(scene%bodies, keep_orientation=.false.)
    other = scene
    call some_fields(scene, contacts)
    call keep_state(scene%bodies, contacts, state)
    state%deck_hash = hash
    allocate (state%built(size(scene%bodies%middle, 1) + 1, 0), state%totals(0))
    call write_restart(folder, state, alone, error)
    call read_restart(newest_restart(folder), other, alone, back, diagnostics, components=dimension, internal=2)
    call t%check(diagnostics%count() == 0 .and. .not. allocated(error), 'all fields are written and read')
    if (diagnostics%count() > 0) return
    call restore_state(back, other, recovered)
    call t%equal(recovered%n, n_contacts, 'contacts with all fields')
    call keep_fields(scene%bodies, n_bodies, written)
    call keep_fields(other%bodies, n_bodies, read)
    call compare_fields(read, written)
    call keep_fields(contacts, n_contacts, written)
    call keep_fields(recovered, n_contacts, read)
    call compare_fields(read, written)
  end subroutine test_all_fields

  !> Bodies with one sphere each, under one law.
  function spatial_scene(n) result(scene)
    integer, intent(in) :: n
    type(scene_t) :: scene
    integer :: b

    scene%dimension = 3
    scene%contactors%dimension = 3
    call scene%bodies%allocate(n, 3)
    allocate (scene%laws(1))
    do b = 1, n
      call add_sphere(scene%contactors, b, 1, 0.5_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    end do
  end function spatial_scene

  !> Numbers other than zero in all fields that files hold, each another one, and within what checks allow.
  subroutine some_fields(scene, contacts)
    type(scene_t), intent(inout) :: scene
    type(contacts_t), intent(out) :: contacts
    type(kept_field_t), allocatable :: kept(:)
    integer :: i

    contacts%dimension = scene%dimension
    contacts%n_components = scene%dimension
    contacts%n_internal = 2
    contacts%n = n_contacts
    call reserve_contacts(contacts, n_contacts)
    call keep_fields(scene%bodies, n_bodies, kept)
    call draw_values(kept)
    call restore_fields(kept, scene%bodies)
    call keep_fields(contacts, n_contacts, kept)
    call draw_values(kept)
    call restore_fields(kept, contacts)
    contacts%law = 1
    contacts%status = int([(1 + mod(i, 4), i=1, size(contacts%status))], i1)
    contacts%contactor(:, :n_contacts) = reshape([(int(1 + mod(i, n_bodies), i4), i=1, 2*n_contacts)], [2, n_contacts])
  end subroutine some_fields

  !> Values at random.
  subroutine draw_values(kept)
    type(kept_field_t), intent(inout) :: kept(:)
    type(random_t) :: random
    integer :: i, k, c

    call random%seed(31)
    do i = 1, size(kept)
      do k = 1, size(kept(i)%values, 2)
        kept(i)%values(:, k) = [(wide(random), c=1, size(kept(i)%values, 1))]
        if (kept(i)%field%kind /= kind_real) kept(i)%values(:, k) = real(1 + mod(k, 127), wp)
      end do
      if (kept(i)%field%name /= 'orientation') cycle
      do k = 1, size(kept(i)%values, 2)
        kept(i)%values(:, k) = [random%uniform(0.1_wp, 1.0_wp), -0.3_wp, 0.4_wp, 0.2_wp]
        kept(i)%values(:, k) = kept(i)%values(:, k)/norm2(kept(i)%values(:, k))
      end do
    end do
  end subroutine draw_values

  !> The same fields, bit for bit.
  subroutine compare_fields(got, expected)
    type(kept_field_t), intent(in) :: got(:), expected(:)
    integer :: i

    call t%equal(size(got), size(expected), 'as many fields')
    do i = 1, size(expected)
      call t%check(got(i)%field%name == expected(i)%field%name .and. same(got(i)%values, expected(i)%values) .and. &
                   any(abs(expected(i)%values) > 0), trim(expected(i)%field%name)//' comes back')
    end do
  end subroutine compare_fields

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
    allocate (state%built(3, 0), state%totals(0))
    call write_restart(folder, state, alone, error)
    call t%check(.not. allocated(error), 'a state without contacts is written')
    call read_restart(newest_restart(folder), scene, alone, back, diagnostics, components=1)
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

  !> A scene with friction takes up the state of one without: orientations stay those of the start, spins are zero, and so are the
  !! impulses that the file does not hold.
  subroutine test_other_components(dimension)
    integer, intent(in) :: dimension
    type(scene_t) :: scene, other
    type(contacts_t) :: contacts, recovered
    type(restart_t) :: state, back
    type(error_t), allocatable :: error
    type(diagnostics_t) :: diagnostics

    if (dimension == 2) other = some_scene(n_bodies)
    if (dimension == 3) other = spatial_scene(n_bodies)
    scene = other
    call drop_rotation(scene%bodies, keep_orientation=.false.)
    call some_fields(scene, contacts)
    contacts%n_components = 1
    contacts%n_internal = 0
    call contacts%resize(n_contacts)
    call keep_state(scene%bodies, contacts, state)
    state%deck_hash = hash
    allocate (state%built(dimension + 1, n_bodies), state%totals(0), source=1.0_wp)
    call write_restart(folder, state, alone, error)
    call t%check(.not. holds_spins(newest_restart(folder), dimension), 'no spins in the file')
    call read_restart(newest_restart(folder), other, alone, back, diagnostics, components=dimension)
    call t%equal(diagnostics%count(), 0, 'components of another stage are no error')
    if (diagnostics%count() > 0) return
    call t%check(all(shape(back%built) == [other%bodies%n_configuration() + 1, 0]), 'no list of neighbours')
    call restore_state(back, other, recovered)
    call t%check(same(other%bodies%velocity(:dimension, :), scene%bodies%velocity), 'velocities of the other stage')
    call t%check(.not. any(abs(other%bodies%velocity(dimension + 1:, :)) > 0), 'no spin')
    call t%check(.not. any(abs(recovered%impulse(dimension:, :n_contacts)) > 0), 'no tangential impulse')
    if (dimension == 2) call t%check(same(recovered%impulse(1, :n_contacts), contacts%impulse(1, :n_contacts)), 'normal impulses')
    if (dimension == 3) call t%check(.not. any(abs(recovered%impulse(:, :n_contacts)) > 0), 'no impulse in space')
  end subroutine test_other_components

  !> Files of other scenes and decks.
  subroutine test_misfits()
    type(scene_t) :: scene
    type(restart_t) :: state
    type(diagnostics_t) :: diagnostics

    scene = some_scene(n_bodies)
    call read_restart(newest_restart(folder), scene, alone, state, diagnostics)
    call t%equal(diagnostics%count(), 0, 'another deck is no error')
    call t%check(state%deck_hash == hash, 'the file holds the hash of its deck')
    call expect(some_scene(n_bodies + 1), newest_restart(folder), 'it holds 50 bodies, the scene 51')
    call drop_rotation(scene%bodies, keep_orientation=.false.)
    call expect(scene, newest_restart(folder), 'it holds spins of bodies, and nothing turns in the scene')
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

    call read_restart(name, scene, alone, state, diagnostics)
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
      'damaged: it holds contacts with a value of image out of range', 'its step is -1', &
      '/built has 7 rows of 4 numbers, not 50 of 4', &
      '/contacts/contactor has 120 rows of 1 numbers, not 120 of 2', '/bodies/crossings has 49 rows of 1 numbers, not 50 of 1']
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
      if (i == 1) call spoil(state%bodies, 'angle', 7, nan)
      if (i == 2) state%time = nan
      if (i == 3) state%built(2, 9) = nan
      if (i == 4) call spoil(state%contacts, 'status', 3, 77.0_wp)
      if (i == 5) call spoil(state%contacts, 'image', 3, 1000.0_wp)
      if (i == 6) state%step = -1
      if (i == 7) state%built = state%built(:, :7)
      if (i == 8) state%contacts = shortened(state%contacts, 'contactor', 1, n_contacts)
      if (i == 9) state%bodies = shortened(state%bodies, 'crossings', 1, n_bodies - 1)
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

  !> Change a value of a field.
  subroutine spoil(kept, name, item, value)
    type(kept_field_t), intent(inout) :: kept(:)
    character(len=*), intent(in) :: name
    integer, intent(in) :: item
    real(wp), intent(in) :: value
    integer :: i

    do i = 1, size(kept)
      if (kept(i)%field%name == name) kept(i)%values(1, item) = value
    end do
  end subroutine spoil

  !> Fields of which one has fewer components or items.
  function shortened(kept, name, components, items) result(shorter)
    type(kept_field_t), intent(in) :: kept(:)
    character(len=*), intent(in) :: name
    integer, intent(in) :: components, items
    type(kept_field_t), allocatable :: shorter(:)
    integer :: i

    shorter = kept
    do i = 1, size(kept)
      if (kept(i)%field%name == name) shorter(i)%values = kept(i)%values(:components, :items)
    end do
  end function shortened

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
