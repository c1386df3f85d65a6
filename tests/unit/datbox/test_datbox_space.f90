!> DATBOX folders of space: one that holds every construct, checked by hand.
program test_datbox_space
  use harness, only: tests_t
  use scenes, only: place_bodies
  use sg_contactors, only: kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, kind_sphere
  use sg_datbox, only: read_datbox
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_laws, only: status_slide, status_stick
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t
  use sg_system, only: make_folder
  use space_reference, only: vertex_distance
  use written_files, only: put_lines
  implicit none
  character(len=*), parameter :: folder = 'datbox_solids'
  integer, parameter :: width = 104
  real(wp), parameter :: density = 2000, tight = 1e-12_wp
  !> Half sizes of the box of bodies 6 and 7 [m], and the angle by which body 6 is turned in BODIES.DAT [rad]
  real(wp), parameter :: half(3) = [0.3_wp, 0.2_wp, 0.1_wp], tilt = pi/6
  type(tests_t) :: tests

  if (.not. make_folder(folder)) error stop 'no folder'
  call write_sample()
  call test_bodies()
  call test_frames()
  call test_drives_and_sees()
  call test_contacts()
  call tests%finish()

contains

  !> Write all files of the sample.
  subroutine write_sample()
    call put_lines(folder//'/BULK_BEHAV.DAT', [character(len=width) :: '$gravy', &
      '                   grv1= 0.1000000D+00  grv2= 0.2000000D+00  grv3=-0.9810000D+01', &
      '$behav  lawty', ' PLEXx  RIGID                           Umas= 0.2000000D+04'])
    call put_lines(folder//'/TACT_BEHAV.DAT', [character(len=width) :: &
      '$behav  lawty', ' iqsc0  IQS_CLB                         fric= 0.3000000D+00', &
      '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
      ' RBDY3  SPHER  BLEUx  iqsc0  RBDY3  PLANx  WALLx       0.5000000D-03', &
      '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
      ' RBDY3  POLYR  BLEUx  iqsc0  RBDY3  POLYR  BLEUx       0.6000000D-03', &
      '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
      ' RBDY3  SPHER  BLEUx  iqsc0  RBDY3  SPHER  REDxx       0.7000000D-03'])
    call put_lines(folder//'/BODIES.DAT', bodies())
    call put_lines(folder//'/DRV_DOF.DAT', [character(len=width) :: &
      '$bdyty', ' RBDY3    3', '$nodty', ' NO6xx      1', '$dofty', &
      ' vlocy      3  0.1000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00', &
      ' vlocy      6  0.2000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00', &
      ' force      4  0.3000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00', &
      '$$$$$$'])
    call put_lines(folder//'/DOF.INI', state())
    call put_lines(folder//'/Vloc_Rloc.INI', contacts())
  end subroutine write_sample

  !> Sphere, cluster, plane, cylinder, hollow cylinder, turned box in global coordinates, box with moments of its own.
  function bodies() result(lines)
    character(len=width), allocatable :: lines(:)
    real(wp) :: corners(3, 8)
    integer :: k

    corners = box_corners()
    lines = [character(len=width) :: '$$$$$$', head(1, 0.1_wp, [1.0_wp, 2.0_wp, 3.0_wp]), &
             ' SPHER      1  color  BLEUx  byrd= 0.2000000D+00', '$$$$$$']
    lines = [character(len=width) :: lines, head(2, 0.0_wp, [0.0_wp, 0.0_wp, 0.0_wp]), &
             ' SPHEb      1  color  BLEUx  byrd= 0.1000000D+00', three('coo', [3.0_wp, 0.0_wp, 0.0_wp]), &
             ' SPHEb      2  color  REDxx  byrd= 0.2000000D+00', three('coo', [3.5_wp, 0.0_wp, 0.0_wp]), '$$$$$$']
    lines = [character(len=width) :: lines, head(3, 0.0_wp, [5.0_wp, 0.0_wp, 0.0_wp]), &
             ' PLANx      1  color  WALLx  axe1= 0.1000000D+01  axe2= 0.2000000D+01  axe3= 0.1000000D+00', &
             '                             localframe', three('alp', [0.0_wp, 1.0_wp, 0.0_wp]), &
             three('bet', [0.0_wp, 0.0_wp, 1.0_wp]), three('gam', [1.0_wp, 0.0_wp, 0.0_wp]), &
             three('coo', [0.5_wp, 0.0_wp, 0.0_wp]), '$$$$$$']
    lines = [character(len=width) :: lines, head(4, 0.0_wp, [7.0_wp, 0.0_wp, 0.0_wp]), &
             ' CYLND      1  color  BLEUx  High= 0.3000000D+00  byrd= 0.1000000D+00', '$$$$$$', &
             head(5, 0.0_wp, [8.0_wp, 0.0_wp, 0.0_wp]), &
             ' DNLYC      1  color  WALLx  High= 0.5000000D+00  byrd= 0.4000000D+00', '$$$$$$']
    lines = [character(len=width) :: lines, head(6, 0.0_wp, [0.0_wp, 0.0_wp, 0.0_wp]), box_head(), &
             (three('coo', [2.0_wp, 0.0_wp, 0.0_wp] + turned_z(tilt, corners(:, k))), k=1, 8), box_faces(), '$$$$$$']
    lines = [character(len=width) :: lines, head(7, 0.05_wp, [9.0_wp, 0.0_wp, 0.0_wp], [0.001_wp, 0.002_wp, 0.0025_wp]), &
             box_head(), (three('coo', corners(:, k)), k=1, 8), box_faces(), '$$$$$$']
  end function bodies

  !> State of bodies 6 (turned by 0.4 about z since BODIES.DAT; its axes written the other way round) and 7.
  function state() result(lines)
    character(len=width), allocatable :: lines(:)
    real(wp) :: frame(3, 3)

    lines = [character(len=width) :: '$steps       12              time= 0.2400000D-01']
    frame(:, 1) = -[cos(tilt + 0.4_wp), sin(tilt + 0.4_wp), 0.0_wp]
    frame(:, 2) = [sin(tilt + 0.4_wp), -cos(tilt + 0.4_wp), 0.0_wp]
    frame(:, 3) = [0.0_wp, 0.0_wp, 1.0_wp]
    lines = [character(len=width) :: lines, &
             state_of(6, [0.1_wp, 0.0_wp, 0.0_wp], [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, 6.0_wp], frame)]
    frame(:, 1) = [0.0_wp, 1.0_wp, 0.0_wp]
    frame(:, 2) = [-1.0_wp, 0.0_wp, 0.0_wp]
    lines = [character(len=width) :: lines, &
             state_of(7, [0.0_wp, 0.2_wp, 0.0_wp], [0.0_wp, 0.0_wp, 0.0_wp, 7.0_wp, 8.0_wp, 9.0_wp], frame)]
  end function state

  !> Contacts of three pairs, whose components and lines stand in three orders; a contactor numbered through all bodies.
  function contacts() result(lines)
    character(len=width), allocatable :: lines(:)
    real(wp), parameter :: point(3) = [0.3_wp, 0.4_wp, 0.5_wp], s(3) = [0.0_wp, 0.0_wp, 1.0_wp], &
                           t(3) = [0.0_wp, 1.0_wp, 0.0_wp], n(3) = [-1.0_wp, 0.0_wp, 0.0_wp]
    character(len=*), parameter :: title = ' cdbdy  numbr  cdtac  numbr  CDVER  behav  anbdy  numbr  antac  numbr  sttus'

    lines = [character(len=width) :: '$steps       12              time= 0.2400000D-01', &
             '$icdan  SPSPx        1', title, &
             ' RBDY3      1  SPHER      1         iqsc0  RBDY3      2  SPHER      2  stick    297', &
             three('rl ', [1.0_wp, 2.0_wp, 30.0_wp]), three('vl ', point), '                             gTT =-0.1000000D-03', &
             three('s()', s), three('t()', t), three('n()', n), three('coo', point), '', &
             '$icdan  PRPLx        2', title, ' RBDY3      6  POLYR      6      3  iqsc0  RBDY3      3  PLANx      1  slide', &
             three('rl ', [1.0_wp, 2.0_wp, 30.0_wp]), three('vl ', point), '                             gapTT-0.1000000D-03', &
             three('coo', point), three('t()', t), three('n()', n), three('s()', s), &
             '$icdan  PRPRx        3', title, ' RBDY3      6  POLYR      1         iqsc0  RBDY3      7  POLYR      1  slide', &
             three('rl ', [2.0_wp, 30.0_wp, 1.0_wp]), three('vl ', point), '                             gapTT-0.1000000D-03', &
             three('coo', point), three('t()', t), three('n()', n), three('s()', s)]
  end function contacts

  !> Lines of a body down to $tacty.
  function head(body, radius, node, moments) result(lines)
    integer, intent(in) :: body
    real(wp), intent(in) :: radius, node(3)
    real(wp), intent(in), optional :: moments(3)
    character(len=width), allocatable :: lines(:)
    character(len=width) :: line, bulk

    write (line, '(a,i7)') ' RBDY3  ', body
    write (bulk, '(a,d14.7)') ' PLAIN      1  behav  PLEXx  avrd=', radius
    lines = [character(len=width) :: '$bdyty', line, '$blmty', bulk]
    if (present(moments)) lines = [character(len=width) :: lines, three('I  ', moments)]
    line = three('coo', node)
    line(:13) = ' NO6xx      1'
    lines = [character(len=width) :: lines, '$nodty', line, three('coo', [0.0_wp, 0.0_wp, 0.0_wp]), '$tacty']
  end function head

  !> Lines of a state.
  function state_of(body, displacement, velocity, frame) result(lines)
    integer, intent(in) :: body
    real(wp), intent(in) :: displacement(3), velocity(6), frame(3, 3)
    character(len=width), allocatable :: lines(:)
    character(len=width) :: line, node

    write (line, '(a,i7)') ' RBDY3  ', body
    node = three('X()', displacement)
    node(:13) = ' NO6xx      1'
    lines = [character(len=width) :: '$bdyty', line, '$nodty', node, three('X()', [0.0_wp, 0.0_wp, 0.0_wp]), &
             three('V()', velocity(1:3)), three('V()', velocity(4:6)), three('a()', frame(:, 1)), three('b()', frame(:, 2)), &
             three('g()', frame(:, 3)), '$$$$$$']
  end function state_of

  !> Three numbers in their columns, with labels made of three letters: coo1=, X(1)=, I1  =, rl1 =.
  function three(letters, values) result(line)
    character(len=3), intent(in) :: letters
    real(wp), intent(in) :: values(3)
    character(len=width) :: line
    character(len=5) :: label(3)
    integer :: k

    do k = 1, 3
      select case (letters(2:3))
      case ('()')
        write (label(k), '(a,i1,a)') letters(1:1)//'(', k, ')='
      case ('  ')
        write (label(k), '(a,i1,a)') letters(1:1), k, '  ='
      case ('l ')
        write (label(k), '(a,i1,a)') letters(1:2), k, ' ='
      case default
        write (label(k), '(a,i1,a)') letters, k, '='
      end select
    end do
    write (line, '(27x,3(2x,a5,d14.7))') (label(k), values(k), k=1, 3)
  end function three

  !> Corners of the box about its centre.
  pure function box_corners() result(corners)
    real(wp) :: corners(3, 8)
    integer :: k

    do k = 1, 8
      corners(:, k) = half*real([merge(1, -1, btest(k - 1, 0)), merge(1, -1, btest(k - 1, 1)), merge(1, -1, btest(k - 1, 2))], wp)
    end do
  end function box_corners

  !> Head of a box as LMGC90's own decks write it.
  pure function box_head() result(line)
    character(len=width) :: line

    line = ' POLYR      1  color  BLEUx  nb_vertex=      8    nb_faces=     12'
  end function box_head

  !> Its triangles; two of them run clockwise, as they do in a deck of LMGC90's.
  function box_faces() result(lines)
    character(len=width) :: lines(12)
    integer, parameter :: corners(3, 12) = reshape([1, 3, 2, 2, 3, 4, 5, 6, 7, 6, 8, 7, 1, 2, 6, 1, 6, 5, 3, 4, 8, 3, 8, 7, &
                                                    1, 5, 3, 3, 5, 7, 2, 6, 4, 4, 6, 8], [3, 12])
    integer :: k

    do k = 1, 12
      write (lines(k), '(29x,a,i7,9x,a,i7,9x,a,i7,7x)') 'ver1=', corners(1, k), 'ver2=', corners(2, k), 'ver3=', corners(3, k)
    end do
  end function box_faces

  !> A vector turned about z.
  pure function turned_z(angle, v)
    real(wp), intent(in) :: angle, v(3)
    real(wp) :: turned_z(3)

    turned_z = [cos(angle)*v(1) - sin(angle)*v(2), sin(angle)*v(1) + cos(angle)*v(2), v(3)]
  end function turned_z

  !> Read the sample, which has no mistake.
  subroutine read_sample(scene)
    type(scene_t), intent(out) :: scene
    type(diagnostics_t) :: diagnostics

    call read_datbox(folder, scene, diagnostics)
    if (diagnostics%count() == 0) return
    call diagnostics%print(6)
    error stop 'the sample cannot be read'
  end subroutine read_sample

  !> Masses, centres and moments by hand.
  subroutine test_bodies()
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    real(wp) :: small, large, volume

    call read_datbox(folder, scene, diagnostics)
    call tests%equal(diagnostics%count(), 0, 'the sample is read')
    ! Clockwise triangles, a contactor numbered through all bodies, cylinders that no see table fits.
    call tests%equal(size(diagnostics%warnings), 3, 'warnings of the sample')
    call tests%check(scene%dimension == 3 .and. scene%bodies%dimension == 3 .and. scene%contactors%dimension == 3, 'in space')
    call tests%near(scene%gravity(3), -9.81_wp, tight, 'gravity in z')
    call tests%check(all(scene%contactors%kind(:8) == [kind_sphere, kind_sphere, kind_sphere, kind_plane, kind_cylinder, &
      kind_hollow_cylinder, kind_polyhedron, kind_polyhedron]), 'kinds')
    associate (b => scene%bodies)
      call tests%near(b%mass(1), density*4*pi/3*1e-3_wp, 1e-11_wp, 'mass from avrd')
      call tests%near(b%principal(2, 1), density*0.4_wp*0.04_wp*4*pi/3*8e-3_wp, 1e-11_wp, 'moments from the shape, as LMGC90')
      call tests%check(maxval(b%principal(:, 1)) <= minval(b%principal(:, 1)), 'a sphere has equal moments, to the last digit')
      call tests%near(b%area(1), 4*pi/3*8e-3_wp, 1e-14_wp, 'volume from the shape')
      small = 4*pi/3*1e-3_wp
      large = 4*pi/3*8e-3_wp
      call tests%near(b%position(1, 2), (3*small + 3.5_wp*large)/(small + large), 1e-13_wp, 'centre of the cluster')
      call tests%near(b%mass(2), density*(small + large), 1e-11_wp, 'mass of the cluster')
      call tests%near(b%principal(1, 2), density*0.4_wp*(small*0.01_wp + large*0.04_wp), 1e-11_wp, 'moment about its axis')
      call tests%near(b%principal(3, 2), density*(0.4_wp*(small*0.01_wp + large*0.04_wp) + small*large/(small + large)*0.25_wp), &
                      1e-11_wp, 'moment across its axis')
      call tests%near(b%position(1, 3), 5.5_wp, tight, 'a shift moves the centre')
      ! The plane's own axes are those of the body: moments of a box of half axes 1, 2, 0.1.
      call tests%near(b%principal(1, 3), density*1.6_wp/3*4.01_wp, 1e-9_wp, 'first moment of the plane')
      call tests%near(b%principal(3, 3), density*1.6_wp/3*5, 1e-9_wp, 'third moment of the plane')
      volume = pi*0.01_wp*0.6_wp
      call tests%near(b%mass(4), density*volume, 1e-11_wp, 'a cylinder weighs nothing in its round caps, as in LMGC90')
      call tests%near(b%area(4), volume + 4*pi/3*1e-3_wp, 1e-14_wp, 'but they are there')
      call tests%near(b%mass(5), density*pi*0.16_wp, 1e-10_wp, 'a hollow cylinder weighs as if filled, as in LMGC90')
      call tests%near(b%area(5), 0.0_wp, tight, 'but covers nothing')
      call tests%near(b%mass(6), density*0.048_wp, 1e-3_wp, 'mass of the box, whose corners have seven digits')
      call tests%near(b%principal(1, 6), density*0.016_wp*0.05_wp, 1e-4_wp, 'its least moment comes first')
      call tests%near(b%principal(3, 6), density*0.016_wp*0.13_wp, 1e-4_wp, 'its largest comes last')
      call tests%near(b%principal(3, 7), density*0.0025_wp, 1e-12_wp, 'given moments')
      call tests%near(b%mass(7), density*4*pi/3*1.25e-4_wp, 1e-12_wp, 'and given mass')
      call tests%check(all(b%is_grain .eqv. [.true., .true., .false., .true., .true., .true., .true.]), 'grains')
    end associate
  end subroutine test_bodies

  !> Orientations: of the file's plane, of the box that has turned, of the box with given moments.
  subroutine test_frames()
    type(scene_t) :: scene
    real(wp) :: corners(3, 8), spin(3)
    integer :: k

    call read_sample(scene)
    call place_bodies(scene)
    call tests%near(scene%contactors%space%plane_world(7, 1), 1.0_wp, tight, 'the plane looks along x')
    corners = box_corners()
    ! Seven digits of corners 2 m from the origin: half a micrometre.
    do k = 1, 8
      call tests%check(vertex_distance(scene%contactors%space%polyhedra(1), [2.1_wp, 0.0_wp, 0.0_wp] &
                               + turned_z(tilt + 0.4_wp, corners(:, k))) < 1.5e-6_wp, 'a corner of the turned box')
      call tests%check(vertex_distance(scene%contactors%space%polyhedra(2), [9.0_wp, 0.2_wp, 0.0_wp] &
                               + turned_z(pi/2, corners(:, k))) < 1e-7_wp, 'a corner of the box along its axes')
    end do
    spin = turned_by(scene%bodies%orientation(:, 6), scene%bodies%velocity(4:6, 6))
    call tests%check(norm2(spin - [0.0_wp, 0.0_wp, 6.0_wp] + turned_z(tilt + 0.4_wp, [4.0_wp, 5.0_wp, 0.0_wp])) < 1e-6_wp, &
                     'the spin is about the axes of DOF.INI')
    call tests%near(scene%bodies%velocity(5, 7), 8.0_wp, tight, 'spin of the second box')
    call tests%near(scene%start_time, 0.024_wp, tight, 'time')
  end subroutine test_frames

  !> Drives by component, see tables by kind.
  subroutine test_drives_and_sees()
    type(scene_t) :: scene

    call read_sample(scene)
    call tests%equal(size(scene%drives), 3, 'drives')
    call tests%check(all(scene%drives%component == [3, 6, 4]) .and. all(scene%drives%body == 3), 'their components')
    call tests%equal(size(scene%sees), 3, 'see tables')
    call tests%check(scene%sees(1)%antagonist_kind == kind_plane .and. scene%sees(2)%candidate_kind == kind_polyhedron, &
                     'their kinds')
  end subroutine test_drives_and_sees

  !> Forces of contacts as vectors of the world.
  subroutine test_contacts()
    type(scene_t) :: scene
    integer :: k

    call read_sample(scene)
    call tests%equal(size(scene%start_contacts), 3, 'contacts')
    do k = 1, 3
      associate (contact => scene%start_contacts(k))
        call tests%check(contact%is_vector .and. norm2(contact%force - [-30.0_wp, 2.0_wp, 1.0_wp]) < tight, 'force of a contact')
        call tests%check(norm2(contact%point - [0.3_wp, 0.4_wp, 0.5_wp]) < tight, 'point of a contact')
      end associate
    end do
    call tests%check(all(scene%start_contacts(1)%contactor == [1, 3]), 'contactors of spheres')
    call tests%check(all(scene%start_contacts(2)%contactor == [7, 4]), 'the only contactor of a body, whatever its number')
    call tests%check(scene%start_contacts(1)%status == status_stick .and. scene%start_contacts(2)%status == status_slide, &
                     'statuses')
  end subroutine test_contacts
end program test_datbox_space
