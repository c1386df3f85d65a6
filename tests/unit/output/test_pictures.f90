!> Pictures: what the files hold, going on with them, a step without contacts, and a full disk.
!!
!! The files stay in the folder `pictures`, where tests/pictures/check_vtkhdf.py reads them with VTK and h5py. Called
!! with the name of a folder as argument, the program writes there until it is killed (tests/pictures/check_live.py).
program test_pictures
  use harness, only: tests_t
  use sg_bodies, only: drop_rotation
  use sg_comm, only: comm_t
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_segment
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: error_t, exit_output
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available
  use sg_kinds, only: wp, i1, i4, i8
  use sg_laws, only: status_slide, status_stick
  use sg_pictures, only: pictures_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_text, only: read_lines, text_t
  use written_files, only: options_of
  implicit none
  !> Period of the scene [m], time step [s], and velocity of the grains [m/s]
  real(wp), parameter :: period = 10, h = 0.01_wp, velocity = 2
  type(tests_t) :: t
  type(comm_t) :: alone

  if (command_argument_count() > 0) call write_endlessly()
  if (hdf5_is_available()) then
    call test_run('pictures', is_single=.false., is_compressed=.false.)
    call test_run('pictures_single', is_single=.true., is_compressed=.true.)
    call test_resume()
    call test_disks()
    call test_full_disk()
    call test_foreign_file()
  else
    call test_without_library()
  end if
  call t%finish()

contains

  !> Two grains, a cluster, a polygon, a floor and a drum; the first grain leaves the period on the right.
  function some_scene() result(scene)
    type(scene_t) :: scene
    real(wp), parameter :: square(2, 4) = reshape([-0.5_wp, -0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp], &
                                                  [2, 4])
    real(wp), parameter :: origin(2) = 0

    call scene%bodies%allocate(6)
    scene%period = period
    scene%bodies%position = reshape([9.9_wp, 1.0_wp, 0.5_wp, 1.0_wp, 3.0_wp, 1.0_wp, 5.0_wp, 1.0_wp, 5.0_wp, 0.0_wp, &
                                     5.0_wp, 4.0_wp], [2, 6])
    scene%bodies%angle(4) = 0.25_wp
    scene%bodies%angle(3) = -0.5_wp
    scene%bodies%mass = 1
    scene%bodies%area = 0.25_wp
    scene%bodies%material = 1
    scene%bodies%is_grain(5:) = .false.
    scene%bodies%velocity(1, :4) = velocity
    call add_disk(scene%contactors, 1, 1, 0.5_wp, origin)
    call add_disk(scene%contactors, 2, 1, 0.5_wp, origin)
    call add_disk(scene%contactors, 3, 2, 0.4_wp, [-0.4_wp, 0.0_wp])
    call add_disk(scene%contactors, 3, 2, 0.3_wp, [0.5_wp, 0.0_wp])
    call add_polygon(scene%contactors, 4, 1, square, origin)
    call add_segment(scene%contactors, 5, 1, 5.0_wp, 0.2_wp, origin, 0.1_wp)
    call add_hollow(scene%contactors, 6, 1, 6.0_wp, origin)
  end function some_scene

  !> Move the grains over a step, as the time integration does.
  subroutine move(scene)
    type(scene_t), intent(inout) :: scene
    integer :: b

    scene%bodies%middle(1:2, :) = scene%bodies%position + h/2*scene%bodies%velocity(1:2, :)
    scene%bodies%position = scene%bodies%position + h*scene%bodies%velocity(1:2, :)
    do b = 1, scene%bodies%n
      if (scene%bodies%position(1, b) < period) cycle
      scene%bodies%position(1, b) = scene%bodies%position(1, b) - period
      scene%bodies%crossings(b) = scene%bodies%crossings(b) + 1_i4
    end do
  end subroutine move

  !> Contacts of a step: none, or one across the period, or that and one with the floor.
  function some_contacts(step, image) result(contacts)
    integer, intent(in) :: step
    integer(i1), intent(in) :: image
    type(contacts_t) :: contacts

    call reserve_contacts(contacts, 2)
    contacts%n = mod(step, 3)
    contacts%contactor(:, :2) = reshape([1_i4, 2_i4, 1_i4, 6_i4], [2, 2])
    contacts%body(:, :2) = reshape([1_i4, 2_i4, 1_i4, 5_i4], [2, 2])
    contacts%law = 1
    contacts%normal(:, 1) = [-1.0_wp, 0.0_wp]
    contacts%normal(:, 2) = [0.0_wp, 1.0_wp]
    contacts%point(:, 1) = [10.2_wp, 1.0_wp]
    contacts%point(:, 2) = [9.9_wp, 0.5_wp]
    contacts%point(1, :) = contacts%point(1, :) - real(1 - int(image), wp)*period
    contacts%image(1) = image
    contacts%gap(:2) = [-1e-3_wp, -2e-3_wp]
    contacts%impulse(:, 1) = h*[3.0_wp, 0.5_wp]
    contacts%impulse(:, 2) = h*[5.0_wp, -1.0_wp]
    contacts%status(:2) = [status_stick, status_slide]
  end function some_contacts

  !> Write pictures of steps `first` to `last`; step 0 is the start.
  subroutine write_steps(pictures, scene, first, last)
    type(pictures_t), intent(inout) :: pictures
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: first, last
    type(error_t), allocatable :: error
    integer :: step
    integer(i1) :: image

    do step = first, last
      ! Contacts are found before the first grain leaves on the right, where the second is its neighbour's image.
      image = merge(1_i1, 0_i1, scene%bodies%crossings(1) == 0)
      if (step > 0) call move(scene)
      call pictures%write(scene, some_contacts(step, image), real(step, wp)*h, step, alone, error)
      call t%check(.not. allocated(error), 'a step is written')
    end do
  end subroutine write_steps

  !> Ten steps, then a look at the files.
  subroutine test_run(folder, is_single, is_compressed)
    character(len=*), intent(in) :: folder
    logical, intent(in) :: is_single, is_compressed
    type(run_options_t) :: options
    type(pictures_t) :: pictures
    type(scene_t) :: scene
    type(error_t), allocatable :: error

    options = options_of(t, folder, h)
    options%output_single = is_single
    options%output_compressed = is_compressed
    scene = some_scene()
    call pictures%open(scene, options, -1, error, alone)
    call t%check(.not. allocated(error), 'the files are made')
    call write_steps(pictures, scene, 0, 10)
    call pictures%close(alone, error)
    call t%check(.not. allocated(error), 'the files are closed')
    ! Single precision keeps 24 bits of a position of 10 m.
    call check_files(folder, merge(1e-6_wp, 1e-14_wp, is_single))
  end subroutine test_run

  !> Write pictures until killed, or until something goes wrong.
  subroutine write_endlessly()
    type(pictures_t) :: pictures
    type(scene_t) :: scene
    type(error_t), allocatable :: error
    character(len=200) :: folder
    integer :: step

    call get_command_argument(1, folder)
    scene = some_scene()
    call pictures%open(scene, options_of(t, trim(folder), h), -1, error, alone)
    step = 0
    do while (.not. allocated(error))
      step = step + 1
      call pictures%write(scene, some_contacts(step, 1_i1), real(step, wp)*h, step, alone, error)
    end do
    write (*, '(a)') error%report()
    call pictures%close(alone, error)
    stop 1
  end subroutine write_endlessly

  !> Look at the files of eleven steps.
  subroutine check_files(folder, tolerance)
    character(len=*), intent(in) :: folder
    real(wp), intent(in) :: tolerance
    type(hdf5_file_t) :: file
    integer(i8) :: n_steps
    integer(i8), allocatable :: offsets(:)
    real(wp), allocatable :: points(:, :), times(:), forces(:), displacement(:, :)

    call file%open(folder//'/bodies.vtkhdf', is_read_only=.true.)
    call file%look('/VTKHDF/Steps', 'NSteps', n_steps)
    call t%equal(int(n_steps), 11, 'steps of the bodies')
    call file%get('/VTKHDF/Steps/Values', times)
    call t%near(times(11), 10*h, 0.0_wp, 'time of the last step')
    call file%get('/VTKHDF/Points', points)
    call t%equal(size(points, 2), 66, 'points of all steps')
    call t%near(points(1, 61), 9.9_wp + 10*h*velocity - period, 10*tolerance, 'the first grain, beyond the period')
    call t%near(points(1, 63), 3.0_wp + 10*h*velocity, 10*tolerance, 'the third grain')
    call file%get('/VTKHDF/PointData/displacement', displacement)
    call t%near(displacement(1, 61), 10*h*velocity, 10*tolerance, 'displacement does not jump')
    call t%check(.not. allocated(file%error), 'the file of the bodies is read')
    call file%close()

    call file%open(folder//'/contacts.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/Steps/CellOffsets', offsets)
    call t%equal(int(offsets(5)), 5, 'cells before step 4: two empty ones and three contacts')
    call file%get('/VTKHDF/CellData/force_normal', forces)
    call t%near(sum(forces), 7*3.0_wp + 3*5.0_wp, 100*tolerance, 'sum of the normal forces of all steps')
    call file%get('/VTKHDF/Points', points)
    call t%near(points(1, 2) - points(1, 1), 0.6_wp, 10*tolerance, 'a line ends at the near image')
    call t%near(points(1, size(points, 2)) - points(1, size(points, 2) - 1), 0.6_wp, 10*tolerance, &
                'and does so when a body has changed sides')
    call t%near(points(2, 6), 0.5_wp, 10*tolerance, 'a line to a wall ends at the point of contact')
    call t%check(.not. allocated(file%error), 'the file of the contacts is read')
    call file%close()
  end subroutine check_files

  !> Are all datasets of contacts that change in length the same in two folders?
  logical function are_same(one, other)
    character(len=*), intent(in) :: one, other
    type(hdf5_file_t) :: a, b
    integer(i4), allocatable :: from_a(:), from_b(:)
    character(len=28), parameter :: lists(8) = [character(len=28) :: 'Types', 'Offsets', 'Connectivity', 'CellData/candidate', &
      'CellData/law', 'Steps/CellOffsets', 'Steps/CellDataOffsets/gap', 'FieldData/ncontacts']
    integer :: i

    call a%open(one//'/contacts.vtkhdf', is_read_only=.true.)
    call b%open(other//'/contacts.vtkhdf', is_read_only=.true.)
    are_same = .true.
    do i = 1, size(lists)
      call a%get('/VTKHDF/'//trim(lists(i)), from_a)
      call b%get('/VTKHDF/'//trim(lists(i)), from_b)
      are_same = are_same .and. size(from_a) == size(from_b)
      if (are_same) are_same = all(from_a == from_b)
    end do
    are_same = are_same .and. .not. (allocated(a%error) .or. allocated(b%error))
    call a%close()
    call b%close()
  end function are_same

  !> A run stopped after step 8 and taken up at step 5 leaves the files of a run of one piece.
  subroutine test_resume()
    type(pictures_t) :: pictures, resumed
    type(scene_t) :: scene, checkpoint
    type(run_options_t) :: options
    type(error_t), allocatable :: error
    type(text_t), allocatable :: straight(:), taken_up(:)
    character(len=12), parameter :: files(3) = [character(len=12) :: 'bodies.xmf', 'shapes.xmf', 'contacts.xmf']
    integer :: i, j

    options = options_of(t, 'pictures_resumed', h)
    scene = some_scene()
    call pictures%open(scene, options, -1, error, alone)
    call write_steps(pictures, scene, 0, 5)
    checkpoint = scene
    call write_steps(pictures, scene, 6, 8)
    call pictures%close(alone, error)
    call resumed%open(checkpoint, options, 5, error, alone)
    call t%check(.not. allocated(error), 'the files are opened again')
    call write_steps(resumed, checkpoint, 6, 10)
    call resumed%close(alone, error)
    call check_files('pictures_resumed', 1e-14_wp)
    call t%check(are_same('pictures', 'pictures_resumed'), 'contacts are those of a run of one piece')
    do j = 1, size(files)
      call read_lines('pictures/'//trim(files(j)), straight, error)
      call read_lines('pictures_resumed/'//trim(files(j)), taken_up, error)
      call t%equal(size(taken_up), size(straight), 'lines of '//files(j))
      if (size(taken_up) /= size(straight)) cycle
      call t%check(all([(taken_up(i)%s == straight(i)%s, i=1, size(straight))]), files(j)//' is that of a run of one piece')
    end do
  end subroutine test_resume

  !> A scene in which nothing turns or rubs.
  subroutine test_disks()
    type(pictures_t) :: pictures
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(error_t), allocatable :: error
    type(hdf5_file_t) :: file
    real(wp), allocatable :: values(:)

    scene = some_scene()
    call drop_rotation(scene%bodies, keep_orientation=.true.)
    contacts%n_components = 1
    call reserve_contacts(contacts, 1)
    contacts%n = 1
    contacts%body(:, 1) = [1_i4, 2_i4]
    contacts%impulse(1, 1) = 7*h
    call pictures%open(scene, options_of(t, 'pictures_disks', h), -1, error, alone)
    call move(scene)
    call pictures%write(scene, contacts, h, 1, alone, error)
    call t%check(.not. allocated(error), 'a scene without rotation is written')
    call pictures%close(alone, error)
    call file%open('pictures_disks/contacts.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/CellData/force_normal', values)
    call t%near(values(1), 7.0_wp, 1e-14_wp, 'force of one component')
    call file%get('/VTKHDF/CellData/force_tangential', values)
    call t%near(values(1), 0.0_wp, 0.0_wp, 'nothing rubs')
    call file%close()
    call file%open('pictures_disks/bodies.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/PointData/angle', values)
    call t%near(values(3), -0.5_wp, 0.0_wp, 'bodies that cannot turn keep their angle')
    call file%get('/VTKHDF/PointData/spin', values)
    call t%near(maxval(abs(values)), 0.0_wp, 0.0_wp, 'nothing spins')
    call file%close()
  end subroutine test_disks

  !> A disk without room, played by the device that is always full, gives one clear error and no crash.
  subroutine test_full_disk()
    type(pictures_t) :: pictures
    type(hdf5_file_t) :: file
    type(error_t), allocatable :: error
    type(scene_t) :: scene
    logical :: exists

    inquire (file='/dev/full', exist=exists)
    if (.not. exists) return
    call file%create('/dev/full')
    call file%group('/a')
    call file%put('/a/numbers', [1.0_wp, 2.0_wp])
    call file%flush()
    call file%close()
    call t%check(allocated(file%error), 'a full disk is noticed')
    if (.not. allocated(file%error)) return
    call t%check(index(file%error%message, 'No space left on device') > 0, 'and said: '//file%error%message)
    call t%equal(file%error%code, exit_output, 'and has its exit code')
    scene = some_scene()
    call pictures%open(scene, options_of(t, 'pictures', h), 10, error, alone)
    call t%check(.not. allocated(error), 'other files can be opened afterwards')
    call pictures%close(alone, error)
  end subroutine test_full_disk

  !> Files that are missing, foreign, or of another scene.
  subroutine test_foreign_file()
    type(pictures_t) :: pictures, others
    type(error_t), allocatable :: error
    type(scene_t) :: scene
    type(run_options_t) :: options
    integer :: unit

    scene = some_scene()
    options = options_of(t, 'pictures_foreign', h)
    open (newunit=unit, file='pictures_foreign/bodies.vtkhdf', status='replace')
    write (unit, '(a)') 'no pictures'
    close (unit)
    call pictures%open(scene, options, 3, error, alone)
    call t%check(allocated(error), 'a foreign file is no file to go on with')
    call pictures%close(alone, error)
    options%folder = 'no/such/folder'
    call others%open(scene, options, -1, error, alone)
    call t%check(allocated(error), 'a folder must exist')
    if (.not. allocated(error)) return
    call t%check(index(error%message, 'No such file or directory') > 0, 'and what is wrong is said: '//error%message)
    call others%write(scene, some_contacts(1, 1_i1), h, 1, alone, error)
    call t%check(allocated(error), 'the failure stays')
    call others%close(alone, error)
  end subroutine test_foreign_file

  !> Without the library there is one clear error.
  subroutine test_without_library()
    type(pictures_t) :: pictures
    type(error_t), allocatable :: error
    type(scene_t) :: scene

    write (*, '(a)') 'built without HDF5: the files themselves are not tested'
    scene = some_scene()
    call pictures%open(scene, options_of(t, 'pictures', h), -1, error, alone)
    call t%check(allocated(error), 'pictures need HDF5')
    if (.not. allocated(error)) return
    call t%check(index(error%message, 'HDF5') > 0, 'and the error says so')
    call pictures%write(scene, some_contacts(1, 1_i1), h, 1, alone, error)
    call t%check(allocated(error), 'the failure stays')
    call pictures%close(alone, error)
  end subroutine test_without_library
end program test_pictures
