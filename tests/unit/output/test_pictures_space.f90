!> Pictures in space: what the files hold, going on with them, and scenes in which nothing turns.
!!
!! The files stay in the folder `pictures_space`, where tests/pictures/check_vtkhdf_space.py reads them with VTK.
program test_pictures_space
  use harness, only: tests_t
  use scenes, only: place_bodies
  use scenes_space, only: begin_space_scene, put_box, put_capsule, put_drum, put_dumbbell, put_plane, put_sphere
  use sg_bodies, only: drop_rotation
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: error_t
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available
  use sg_kinds, only: wp, i1, i4, i8, pi
  use sg_laws, only: status_slide, status_stick
  use sg_pictures, only: pictures_t
  use sg_rotations, only: normalised
  use sg_scene, only: scene_t
  use sg_vectors, only: cross
  use written_files, only: options_of
  implicit none
  !> Periods in x and y [m], time step [s], velocity of the sphere [m/s]
  real(wp), parameter :: period(2) = [10.0_wp, 8.0_wp], h = 0.01_wp, velocity(3) = [2.0_wp, 3.0_wp, -1.0_wp]
  !> Turned by a quarter about z: x becomes y
  real(wp), parameter :: quarter(4) = [sqrt(0.5_wp), 0.0_wp, 0.0_wp, sqrt(0.5_wp)]
  !> Half sides of the box, half height and radius of the capsule, of the drum [m]
  real(wp), parameter :: half(3) = [0.3_wp, 0.5_wp, 0.7_wp], capsule(2) = [0.6_wp, 0.25_wp], drum(2) = [2.0_wp, 3.0_wp]
  !> Positions of 10 m in double precision
  real(wp), parameter :: tight = 1e-13_wp
  type(tests_t) :: t
  type(comm_t) :: alone

  if (hdf5_is_available()) then
    call test_run('pictures_space', -1)
    call test_run('pictures_space_resumed', 3)
    call test_nothing_turns()
  else
    write (*, '(a)') 'built without HDF5: pictures in space are not tested'
    call t%check(.not. hdf5_is_available(), 'there are no files')
  end if
  call t%finish()

contains

  !> Check that vectors are near each other in every component.
  subroutine near(got, expected, tolerance, what)
    real(wp), intent(in) :: got(:), expected(:), tolerance
    character(len=*), intent(in) :: what

    call t%near(maxval(abs(got - expected)), 0.0_wp, tolerance, what)
  end subroutine near

  !> A sphere that leaves both periods, a dumbbell, a turned box, a capsule, a floor and a drum.
  function some_scene() result(scene)
    type(scene_t) :: scene

    call begin_space_scene(scene, 6, 0.5_wp, 0.1_wp)
    scene%period = period(1)
    scene%period_y = period(2)
    call put_sphere(scene, 1, 0.5_wp, [9.95_wp, 7.9_wp, 1.0_wp])
    call put_dumbbell(scene, 2, 0.25_wp, 0.2_wp, [0.4_wp, 0.3_wp, 1.0_wp])
    call put_box(scene, 3, half, [3.0_wp, 1.0_wp, 1.0_wp], normalised([1.0_wp, 0.3_wp, -0.2_wp, 0.5_wp]))
    call put_capsule(scene, 4, capsule(1), capsule(2), [5.0_wp, 1.0_wp, 1.0_wp])
    call put_plane(scene, 5, [5.0_wp, 4.0_wp, 0.1_wp], [5.0_wp, 4.0_wp, -0.1_wp])
    call put_drum(scene, 6, drum(1), drum(2), [5.0_wp, 4.0_wp, 2.0_wp])
    scene%bodies%orientation(:, 2) = quarter
    scene%bodies%velocity(1:3, 1) = velocity
    scene%bodies%velocity(4:6, 2) = [4.0_wp, 0.0_wp, 0.0_wp]
    scene%bodies%material = 1
    scene%bodies%is_grain(5:) = .false.
  end function some_scene

  !> Move the bodies over a step without turning them, as the time integration does.
  subroutine move(scene)
    type(scene_t), intent(inout) :: scene
    integer :: b

    scene%bodies%middle(1:3, :) = scene%bodies%position + h/2*scene%bodies%velocity(1:3, :)
    scene%bodies%position = scene%bodies%position + h*scene%bodies%velocity(1:3, :)
    do b = 1, scene%bodies%n
      if (scene%bodies%position(1, b) >= period(1)) then
        scene%bodies%position(1, b) = scene%bodies%position(1, b) - period(1)
        scene%bodies%crossings(b) = scene%bodies%crossings(b) + 1_i4
      end if
      if (scene%bodies%position(2, b) >= period(2)) then
        scene%bodies%position(2, b) = scene%bodies%position(2, b) - period(2)
        scene%bodies%crossings_y(b) = scene%bodies%crossings_y(b) + 1_i4
      end if
    end do
  end subroutine move

  !> Contacts of a step: none at the start; then sphere and dumbbell across both periods, and box and floor.
  !!
  !! They are found before the step moves the sphere: `before` is the scene then.
  function some_contacts(before, step) result(contacts)
    type(scene_t), intent(in) :: before
    integer, intent(in) :: step
    type(contacts_t) :: contacts

    contacts%dimension = 3
    contacts%n_components = 3
    call reserve_contacts(contacts, 2)
    if (step == 0) return
    contacts%n = 2
    contacts%body(:, :2) = reshape([1_i4, 2_i4, 3_i4, 5_i4], [2, 2])
    contacts%law(:2) = 1_i4
    contacts%normal(:, :2) = reshape([0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 2])
    contacts%point(:, 1) = before%bodies%position(:, 1) + [0.0_wp, 0.5_wp, 0.0_wp]
    contacts%point(:, 2) = [3.1_wp, 1.1_wp, 0.0_wp]
    contacts%image(:2) = [merge(1_i1, 0_i1, before%bodies%crossings(1) == 0), 0_i1]
    contacts%image_y(:2) = [merge(1_i1, 0_i1, before%bodies%crossings_y(1) == 0), 0_i1]
    contacts%gap(:2) = [-1e-3_wp, -2e-3_wp]
    contacts%impulse(:, 1) = h*[3.0_wp, -5.0_wp, 4.0_wp]
    contacts%impulse(:, 2) = h*[0.0_wp, 1.0_wp, 7.0_wp]
    contacts%status(:2) = [status_stick, status_slide]
  end function some_contacts

  !> Write steps `first` to `last`; step 0 is the start.
  subroutine write_steps(pictures, scene, first, last)
    type(pictures_t), intent(inout) :: pictures
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: first, last
    type(error_t), allocatable :: error
    type(contacts_t) :: contacts
    integer :: step

    do step = first, last
      contacts = some_contacts(scene, step)
      if (step > 0) call move(scene)
      call pictures%write(scene, contacts, real(step, wp)*h, step, alone, error)
      call t%check(.not. allocated(error), 'a step is written')
    end do
  end subroutine write_steps

  !> Six steps, of one piece or stopped and taken up again, then a look at the files.
  subroutine test_run(folder, stop_at)
    character(len=*), intent(in) :: folder
    integer, intent(in) :: stop_at
    type(pictures_t) :: pictures, resumed
    type(scene_t) :: scene, checkpoint
    type(error_t), allocatable :: error

    scene = some_scene()
    call pictures%open(scene, options_of(t, folder, h), -1, error, alone)
    call t%check(.not. allocated(error), 'the files are made')
    call write_steps(pictures, scene, 0, max(stop_at, 0))
    checkpoint = scene
    call write_steps(pictures, scene, max(stop_at, 0) + 1, 5)
    call pictures%close(alone, error)
    call t%check(.not. allocated(error), 'the files are closed')
    if (stop_at > 0) then
      call resumed%open(checkpoint, options_of(t, folder, h), stop_at, error, alone)
      call t%check(.not. allocated(error), 'the files are opened again')
      call write_steps(resumed, checkpoint, stop_at + 1, 5)
      call resumed%close(alone, error)
    end if
    call check_bodies(folder)
    call check_shapes(folder, scene)
    call check_contacts(folder)
  end subroutine test_run

  !> Six points per step.
  subroutine check_bodies(folder)
    character(len=*), intent(in) :: folder
    type(hdf5_file_t) :: file
    real(wp), allocatable :: points(:, :), spin(:, :), orientation(:, :), displacement(:, :), radius(:), mass(:)

    call file%open(folder//'/bodies.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/Points', points)
    call file%get('/VTKHDF/PointData/spin', spin)
    call file%get('/VTKHDF/PointData/orientation', orientation)
    call file%get('/VTKHDF/PointData/displacement', displacement)
    call file%get('/VTKHDF/PointData/radius', radius)
    call file%get('/VTKHDF/PointData/mass', mass)
    call t%check(.not. allocated(file%error), 'the file of the bodies is read')
    call file%close()
    call t%equal(size(points, 2), 36, 'points of six steps')
    call near(points(:, 31), [9.95_wp, 7.9_wp, 1.0_wp] + 5*h*velocity - [period, 0.0_wp], tight, &
              'the sphere has left both periods')
    call near(displacement(:, 31), 5*h*velocity, tight, 'displacement does not jump')
    ! Spin about its own x axis, which has been turned to the world's y.
    call near(spin(:, 2), [0.0_wp, 4.0_wp, 0.0_wp], tight, 'spin in the axes of the world')
    call near(orientation(:, 2), quarter, tight, 'orientation as a quaternion')
    call t%near(radius(1), 0.5_wp, tight, 'radius of the sphere')
    call t%near(4*pi/3*radius(3)**3, 8*product(half), tight, 'radius of the sphere as large as the box')
    call t%near(mass(3), 1000*8*product(half), 1e-10_wp, 'mass of the box')
  end subroutine check_bodies

  !> A point a sphere, a polygon a face; all where detection sees them, and as large as their bodies.
  subroutine check_shapes(folder, scene)
    character(len=*), intent(in) :: folder
    type(scene_t), intent(inout) :: scene
    type(hdf5_file_t) :: file
    real(wp), allocatable :: points(:, :), radius(:)
    integer(i8), allocatable :: offsets(:), ids(:)
    integer(i4), allocatable :: types(:), shape(:), body(:), topology(:)
    integer :: first, n, i

    call file%open(folder//'/shapes.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/Points', points)
    call file%get('/VTKHDF/Connectivity', ids)
    call file%get('/VTKHDF/Offsets', offsets)
    call file%get('/VTKHDF/Types', types)
    call file%get('/VTKHDF/PointData/radius', radius)
    call file%get('/VTKHDF/CellData/shape', shape)
    call file%get('/VTKHDF/CellData/body', body)
    call file%get('/XDMF/topology', topology)
    call t%check(.not. allocated(file%error), 'the file of the shapes is read')
    call file%close()
    n = size(radius)
    first = size(points, 2) - n
    call t%equal(first, 5*n, 'points of six steps')
    call t%equal(count(types == 1), 3, 'three spheres are points')
    call t%equal(size(types), 3 + 6 + 24*13 + 6 + 96, 'all others are polygons')
    call t%equal(size(topology), size(ids) + 2*size(types), 'XDMF says of each cell what it is and how long')
    call near(radius(:3), [0.5_wp, 0.25_wp, 0.25_wp], 0.0_wp, 'radii of the spheres')
    call t%near(maxval(radius(4:)), 0.0_wp, 0.0_wp, 'corners have none')
    call t%check(all(body == scene%contactors%body(shape)), 'cells know their bodies')
    call place_bodies(scene)
    call near([points(:, first + 1:first + 3)], [scene%contactors%centre(:, :3)], tight, 'spheres are where they touch')
    do i = 1, 8
      call near(points(:, first + 3 + i), scene%contactors%space%polyhedra(1)%world_vertex(:, i), tight, 'corners of the box')
    end do
    associate (last => points(:, first + 1:))
      call t%near(volume_of(4, shape, offsets, ids, last), 8*product(half), 1e-12_wp, &
                  'the faces of the box bound its volume and look outside')
      call t%near(volume_of(6, shape, offsets, ids, last), 8*5.0_wp*4.0_wp*0.1_wp, 1e-11_wp, 'those of the floor too')
      ! Chords of 15 degrees leave out 1.1 % of a circle, and twice that of a sphere.
      call t%near(volume_of(5, shape, offsets, ids, last)/(pi*capsule(2)**2*(2*capsule(1) + 4*capsule(2)/3)), 0.985_wp, &
                  0.005_wp, 'those of the capsule nearly')
      call t%check(all([(abs(norm2(last([1, 3], i) - [5.0_wp, 2.0_wp]) - drum(2)) < 1e-12_wp, i=n - 191, n)]), &
                   'corners of the drum lie on it')
      ! About its centre: a tube without ends that looks inside has - 2/3 of the volume within.
      call t%near(volume_of(7, shape, offsets, ids, last)/(pi*drum(2)**2*2*drum(1)), -2.0_wp/3, 1e-3_wp, 'the drum looks inside')
    end associate
  end subroutine check_shapes

  !> A third of the integral of x.n over the polygons of a shape, about the mean of their corners.
  pure real(wp) function volume_of(number, shape, offsets, ids, points) result(volume)
    integer, intent(in) :: number
    integer(i4), intent(in) :: shape(:)
    integer(i8), intent(in) :: offsets(:), ids(:)
    real(wp), intent(in) :: points(:, :)
    real(wp) :: centre(3), a(3), b(3), c(3)
    integer :: cell, j, k

    centre = 0
    k = 0
    do cell = 1, size(shape)
      if (shape(cell) /= number) cycle
      do j = int(offsets(cell)) + 1, int(offsets(cell + 1))
        centre = centre + points(:, 1 + int(ids(j)))
        k = k + 1
      end do
    end do
    centre = centre/real(k, wp)
    volume = 0
    do cell = 1, size(shape)
      if (shape(cell) /= number) cycle
      a = points(:, 1 + int(ids(offsets(cell) + 1))) - centre
      do j = int(offsets(cell)) + 2, int(offsets(cell + 1)) - 1
        b = points(:, 1 + int(ids(j))) - centre
        c = points(:, 1 + int(ids(j + 1))) - centre
        volume = volume + dot_product(a, cross(b, c))/6
      end do
    end do
  end function volume_of

  !> One empty cell, then two lines a step.
  subroutine check_contacts(folder)
    character(len=*), intent(in) :: folder
    type(hdf5_file_t) :: file
    real(wp), allocatable :: points(:, :), normal(:), tangential(:), force(:, :), point(:, :)
    real(wp) :: last(3)
    integer(i4), allocatable :: types(:)
    integer :: i

    call file%open(folder//'/contacts.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/Points', points)
    call file%get('/VTKHDF/Types', types)
    call file%get('/VTKHDF/CellData/force_normal', normal)
    call file%get('/VTKHDF/CellData/force_tangential', tangential)
    call file%get('/VTKHDF/CellData/force', force)
    call file%get('/VTKHDF/CellData/point', point)
    call t%check(.not. allocated(file%error), 'the file of the contacts is read')
    call file%close()
    call t%equal(size(points, 2), 20, 'ends of two contacts in five steps')
    call t%check(types(1) == 0 .and. all(types(2:) == 3), 'a step without contacts, and lines')
    call near(normal(2:3), [5.0_wp, 7.0_wp], 1e-12_wp, 'normal forces')
    call near(tangential(2:3), [5.0_wp, 1.0_wp], 1e-12_wp, 'tangential forces')
    call near(force(:, 2), [3.0_wp, -5.0_wp, 4.0_wp], 1e-12_wp, 'force that the candidate feels')
    do i = 1, 5
      last = [9.95_wp, 7.9_wp, 1.0_wp] + real(i, wp)*h*velocity
      ! The sphere's own image depends on whether it has left a period; the way to the dumbbell does not.
      call near(points(:, 4*i - 2) - points(:, 4*i - 3), [0.4_wp, 0.3_wp, 1.0_wp] + [period, 0.0_wp] - last, 1e-12_wp, &
                'a line ends at the near image')
      call t%check(norm2(points(:, 4*i - 3) - point(:, 2*i)) < 0.6_wp, 'the point lies beside the candidate')
      call near(points(:, 4*i), [3.1_wp, 1.1_wp, 0.0_wp], 1e-12_wp, 'a line to a wall ends at the point of contact')
    end do
  end subroutine check_contacts

  !> Spheres without friction, which have lost their orientations and spins.
  subroutine test_nothing_turns()
    type(pictures_t) :: pictures
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(error_t), allocatable :: error
    type(hdf5_file_t) :: file
    real(wp), allocatable :: values(:), vectors(:, :)

    scene = some_scene()
    call drop_rotation(scene%bodies, keep_orientation=.true.)
    contacts%dimension = 3
    contacts%n_components = 1
    call reserve_contacts(contacts, 1)
    contacts%n = 1
    contacts%body(:, 1) = [1_i4, 2_i4]
    contacts%normal(:, 1) = [0.0_wp, 0.6_wp, 0.8_wp]
    contacts%impulse(1, 1) = 7*h
    call pictures%open(scene, options_of(t, 'pictures_space_balls', h), -1, error, alone)
    call move(scene)
    call pictures%write(scene, contacts, h, 1, alone, error)
    call t%check(.not. allocated(error), 'a scene without rotation is written')
    call pictures%close(alone, error)
    call file%open('pictures_space_balls/contacts.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/CellData/force', vectors)
    call near(vectors(:, 1), 7*[0.0_wp, 0.6_wp, 0.8_wp], 1e-12_wp, 'force along the normal')
    call file%get('/VTKHDF/CellData/force_tangential', values)
    call t%near(values(1), 0.0_wp, 0.0_wp, 'nothing rubs')
    call file%close()
    call file%open('pictures_space_balls/shapes.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/Points', vectors)
    call near(vectors(:, 2), [0.4_wp, 0.1_wp, 1.0_wp], tight, 'a dumbbell that cannot turn lies along y')
    call file%close()
    call file%open('pictures_space_balls/bodies.vtkhdf', is_read_only=.true.)
    call file%get('/VTKHDF/PointData/spin', vectors)
    call t%near(maxval(abs(vectors)), 0.0_wp, 0.0_wp, 'nothing spins')
    call file%get('/VTKHDF/PointData/orientation', vectors)
    call near(vectors(:, 2), quarter, tight, 'bodies that cannot turn keep their orientation')
    call t%check(.not. allocated(file%error), 'the files are read')
    call file%close()
  end subroutine test_nothing_turns
end program test_pictures_space
