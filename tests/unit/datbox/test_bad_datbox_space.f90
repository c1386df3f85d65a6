!> Bad DATBOX folders of space: each is a good one with one thing wrong, and must be refused where it is wrong.
program test_bad_datbox_space
  use datbox_tests, only: datbox_tests_t, width
  use same_bits, only: same_bodies
  use sg_datbox, only: read_datbox
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  implicit none
  character(len=*), parameter :: folder = 'datbox_bad_solids'

  ! The good folder, line by line.
  character(len=width), parameter :: bulk(*) = [character(len=width) :: &
    '$gravy', &
    '                   grv1= 0.0000000D+00  grv2= 0.0000000D+00  grv3=-0.9810000D+01', &
    '$behav  lawty', &
    ' PLEXx  RIGID                           Umas= 0.2000000D+04']
  character(len=width), parameter :: tact(*) = [character(len=width) :: &
    '$behav  lawty', &
    ' iqsc0  IQS_CLB                         fric= 0.3000000D+00', &
    '$seety', &
    ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
    ' RBDY3  SPHER  BLEUx  iqsc0  RBDY3  PLANx  WALLx       0.5000000D-03', &
    '$seety', &
    ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
    ' RBDY3  SPHER  BLEUx  iqsc0  RBDY3  POLYR  BLEUx       0.5000000D-03']
  character(len=width), parameter :: bodies(*) = [character(len=width) :: &
    '$bdyty', &
    ' RBDY3      1', &
    '$blmty', &
    ' PLAIN      1  behav  PLEXx  avrd= 0.1259921D+00', &
    '                             I1  = 0.2000000D-02  I2  = 0.3000000D-02  I3  = 0.4000000D-02', &
    '$nodty', &
    ' NO6xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.1000000D+01', &
    '                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00', &
    '$tacty', &
    ' SPHEb      1  color  BLEUx  byrd= 0.1000000D+00', &
    '                             coo1= 0.1000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    ' SPHEb      2  color  BLEUx  byrd= 0.1000000D+00', &
    '                             coo1=-0.1000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    '$$$$$$', &
    '$bdyty', &
    ' RBDY3      2', &
    '$blmty', &
    ' PLAIN      1  behav  PLEXx  avrd= 0.0000000D+00', &
    '$nodty', &
    ' NO6xx      1                coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    '                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00', &
    '$tacty', &
    ' PLANx      1  color  WALLx  axe1= 0.1000000D+01  axe2= 0.2000000D+01  axe3= 0.1000000D+00', &
    '                             localframe', &
    '                             alp1= 0.0000000D+00  alp2= 0.1000000D+01  alp3= 0.0000000D+00', &
    '                             bet1= 0.0000000D+00  bet2= 0.0000000D+00  bet3= 0.1000000D+01', &
    '                             gam1= 0.1000000D+01  gam2= 0.0000000D+00  gam3= 0.0000000D+00', &
    '                             coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    '$$$$$$', &
    '$bdyty', &
    ' RBDY3      3', &
    '$blmty', &
    ' PLAIN      1  behav  PLEXx  avrd= 0.0000000D+00', &
    '$nodty', &
    ' NO6xx      1                coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    '                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00', &
    '$tacty', &
    ' POLYR      1  color  BLEUx  nb_vertex=      5    nb_faces=      6', &
    '                             coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    '                             coo1= 0.1000000D+01  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    '                             coo1= 0.1000000D+01  coo2= 0.1000000D+01  coo3= 0.0000000D+00', &
    '                             coo1= 0.0000000D+00  coo2= 0.1000000D+01  coo3= 0.0000000D+00', &
    '                             coo1= 0.5000000D+00  coo2= 0.5000000D+00  coo3= 0.1000000D+01', &
    '                             ver1=      1         ver2=      3         ver3=      2', &
    '                             ver1=      1         ver2=      4         ver3=      3', &
    '                             ver1=      1         ver2=      2         ver3=      5', &
    '                             ver1=      2         ver2=      3         ver3=      5', &
    '                             ver1=      3         ver2=      4         ver3=      5', &
    '                             ver1=      4         ver2=      1         ver3=      5', &
    '$$$$$$']
  character(len=width), parameter :: drives(*) = [character(len=width) :: &
    '$bdyty', &
    ' RBDY3    2', &
    '$nodty', &
    ' NO6xx      1', &
    '$dofty', &
    ' vlocy      6  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00', &
    '$$$$$$']
  character(len=width), parameter :: state(*) = [character(len=width) :: &
    '$steps       12              time= 0.2400000D-01', &
    '$bdyty', &
    ' RBDY3      1', &
    '$nodty', &
    ' NO6xx      1                X(1)= 0.1000000D-01  X(2)=-0.2000000D-01  X(3)= 0.3000000D+00', &
    '                             X(4)= 0.0000000D+00  X(5)= 0.0000000D+00  X(6)= 0.0000000D+00', &
    '                             V(1)= 0.1000000D+01  V(2)= 0.2000000D+01  V(3)= 0.0000000D+00', &
    '                             V(4)= 0.1000000D+01  V(5)= 0.2000000D+01  V(6)= 0.0000000D+00', &
    '                             a(1)= 0.1000000D+01  a(2)= 0.0000000D+00  a(3)= 0.0000000D+00', &
    '                             b(1)= 0.0000000D+00  b(2)= 0.1000000D+01  b(3)= 0.0000000D+00', &
    '                             g(1)= 0.0000000D+00  g(2)= 0.0000000D+00  g(3)= 0.1000000D+01', &
    '$$$$$$']
  character(len=width), parameter :: contacts(*) = [character(len=width) :: &
    '$steps       12              time= 0.2400000D-01', &
    '$icdan  SPPLx        1', &
    ' cdbdy  numbr  cdtac  numbr  CDVER  behav  anbdy  numbr  antac  numbr  sttus', &
    ' RBDY3      1  SPHER      2         iqsc0  RBDY3      2  PLANx      1  stick', &
    '                             rls/H 0.1000000D+01  rlt/H 0.2000000D+01  rln/H 0.3000000D+01', &
    '                             vls = 0.0000000D+00  vlt = 0.0000000D+00  vln = 0.0000000D+00', &
    '                             gTT =-0.1000000D-03', &
    '                             s(1)= 0.0000000D+00  s(2)=-0.1000000D+01  s(3)= 0.0000000D+00', &
    '                             t(1)= 0.1000000D+01  t(2)= 0.0000000D+00  t(3)= 0.0000000D+00', &
    '                             n(1)= 0.0000000D+00  n(2)= 0.0000000D+00  n(3)= 0.1000000D+01', &
    '                             coo1= 0.3000000D+00  coo2= 0.4000000D+00  coo3= 0.0000000D+00']
  type(datbox_tests_t) :: tests

  call tests%begin(folder, bulk, tact, bodies, drives, state)
  call tests%keep('Vloc_Rloc.INI', contacts)
  call tests%check_good()
  call test_bodies()
  call test_polyhedra()
  call test_patches()
  call test_cluster()
  call test_other_files()
  call test_every_cut()
  call tests%finish()

contains

  !> Bodies, nodes, moments, round shapes and frames.
  subroutine test_bodies()
    character(len=*), parameter :: file = 'BODIES.DAT', moments = '                             I1  ='

    call tests%refuse(file, 16, ' RBDY2      2', 'cannot stand in one DATBOX', 16, 2)
    call tests%refuse(file, 16, ' MAILx      2', 'MAILx', 16, 2)
    call tests%refuse(file, 5, moments//'-0.2000000D-02  I2  = 0.3000000D-02  I3  = 0.4000000D-02', 'principal moments', 5, 35)
    call tests%refuse(file, 5, moments//' 0.2000000D-02  I2  = 0.3000000D-02  I3  = 0.6000000D-02', 'principal moments', 5, 35)
    call tests%refuse(file, 5, moments//' 0.2000000D-02  I2  = 0.3000000D-02', 'principal moments', 5, 35)
    call tests%refuse(file, 7, ' NO3xx'//bodies(7)(7:), 'NO6xx', 7, 2)
    call tests%refuse(file, 8, '', 'a keyword stands where the rotations of a node', 9, 1)
    call tests%refuse(file, 10, ' SPHEb      1  color  BLEUx  byrd=-0.1000000D+00', 'positive', 10, 35)
    call tests%refuse(file, 11, '                             coo1= 0.10x0000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
                      'not a number', 11, 36)
    call tests%refuse(file, 12, ' DISPx      2  color  BLEUx  coo1= 0.1000000D+00', 'DISPx', 12, 2)
    call tests%refuse(file, 23, bodies(23)(:76)//' 0.0000000D+00', 'positive', 23, 77)
    call tests%refuse(file, 27, '                             gam1= 0.1100000D+01  gam2= 0.0000000D+00  gam3= 0.0000000D+00', &
                      'not orthonormal', 27, 35)
    call tests%refuse(file, 27, '                             gam1=-0.1000000D+01  gam2= 0.0000000D+00  gam3= 0.0000000D+00', &
                      'left-handed', 27, 35)
    call tests%refuse(file, 28, '', 'a keyword stands where the centre of a contactor', 29, 1)
  end subroutine test_bodies

  !> Surfaces that are no polyhedra.
  subroutine test_polyhedra()
    character(len=*), parameter :: file = 'BODIES.DAT', face = '                             ver1='

    call tests%refuse(file, 38, ' POLYR      1  color  BLEUx  nb_vertex=      3    nb_faces=      6', 'cannot be', 38, 40)
    call tests%refuse(file, 38, ' POLYR      1  color  BLEUx  nb_vertex=      5    nb_faces= 600000', 'cannot be', 38, 40)
    call tests%refuse(file, 38, ' POLYR      1  color  BLEUx  nb_vertex=      5    nb_faces=    six', 'whole number', 38, 64)
    call tests%refuse(file, 44, face//'      1         ver2=      3         ver3=      9', 'there is no vertex 9', 44, 77)
    call tests%refuse(file, 44, face//'      1         ver2=      3', 'whole number', 44, 77)
    call tests%refuse(file, 44, face//'      1         ver2=      3         ver3=      4', 'the surface is not', 38, 2)
    call tests%refuse(file, 49, '', 'a keyword stands where a triangle', 50, 1)
    ! The tip in the plane of the base, and a corner of the base within the triangle of the others.
    call tests%refuse(file, 43, '                             coo1= 0.5000000D+00  coo2= 0.5000000D+00  coo3= 0.0000000D+00', &
                      'no volume', 38, 2)
    call tests%refuse(file, 41, '                             coo1= 0.4000000D+00  coo2= 0.4000000D+00  coo3= 0.0000000D+00', &
                      'not convex', 38, 2)
  end subroutine test_polyhedra

  !> A cluster weighs as much as its shapes, whatever its avrd says.
  subroutine test_cluster()
    type(scene_t) :: scene
    character(len=width), allocatable :: lines(:)

    call tests%write_good()
    lines = bodies
    lines(4)(35:) = ' 0.2000000D+00'
    call tests%put('BODIES.DAT', lines)
    call read_good(scene, 'a cluster with another avrd')
    call tests%near(scene%bodies%mass(1), 2000*8*pi/3*0.1_wp**3, 1e-11_wp, 'mass of a cluster')
  end subroutine test_cluster

  !> A pyramid in two patches, or inside out, is the same pyramid; a hat on it is not convex.
  subroutine test_patches()
    character(len=*), parameter :: face = '                             ver1='
    type(scene_t) :: good, scene
    character(len=width), allocatable :: lines(:)

    call tests%write_good()
    call read_good(good, 'the good folder')
    ! Base, then sides; the second patch has its corners and numbers for itself.
    lines = [bodies(:37), pad(' POLYF      1  color  BLEUx  nb_patch =      2'), &
             pad('                             nb_vertex=      4    nb_faces=      2'), bodies(39:42), bodies(44:45), &
             pad('                             nb_vertex=      5    nb_faces=      4'), bodies(39:43), bodies(46:50)]
    call tests%put('BODIES.DAT', lines)
    call read_good(scene, 'a polyhedron in patches')
    call tests%check(same_bodies(scene%bodies, good%bodies), 'a polyhedron in patches weighs the same')
    call tests%equal(scene%contactors%space%polyhedra(1)%n_vertices, 5, 'its vertices')
    lines = bodies
    lines(44:49) = [pad(face//'      1         ver2=      2         ver3=      3'), &
                    pad(face//'      1         ver2=      3         ver3=      4'), &
                    pad(face//'      2         ver2=      1         ver3=      5'), &
                    pad(face//'      3         ver2=      2         ver3=      5'), &
                    pad(face//'      4         ver2=      3         ver3=      5'), &
                    pad(face//'      1         ver2=      4         ver3=      5')]
    call tests%put('BODIES.DAT', lines)
    call read_good(scene, 'a polyhedron inside out')
    call tests%near(scene%bodies%mass(3)/good%bodies%mass(3), 1.0_wp, 1e-12_wp, 'a polyhedron inside out weighs the same')
    call tests%refuse('BODIES.DAT', 41, &
                      '                             coo1= 0.4000000D+00  coo2= 0.4000000D+00  coo3= 0.1000000D+00', &
                      'split it into convex parts', 38, 2)
  end subroutine test_patches

  !> Read the folder as it stands, in which no mistake is expected.
  subroutine read_good(scene, what)
    type(scene_t), intent(out) :: scene
    character(len=*), intent(in) :: what
    type(diagnostics_t) :: diagnostics

    call read_datbox(folder, scene, diagnostics)
    call tests%equal(diagnostics%count(), 0, what)
  end subroutine read_good

  !> A line of the width of all.
  pure function pad(text) result(line)
    character(len=*), intent(in) :: text
    character(len=width) :: line

    line = text
  end function pad

  !> See tables, drives, states and contacts.
  subroutine test_other_files()
    character(len=*), parameter :: frame = '                             b(1)='

    call tests%refuse('DRV_DOF.DAT', 2, ' RBDY3    4', 'no body 4', 2, 9)
    call tests%refuse('DRV_DOF.DAT', 2, ' RBDY2    2', 'RBDY3, rigid', 2, 2)
    call tests%refuse('DRV_DOF.DAT', 6, ' vlocy      7'//drives(6)(14:), 'components 1, 2, 3', 6, 9)
    call tests%refuse('DOF.INI', 5, ' NO3xx'//state(5)(7:), 'NO6xx', 5, 2)
    call tests%refuse('DOF.INI', 10, frame//' 0.1000000D+01  b(2)= 0.0000000D+00  b(3)= 0.0000000D+00', 'not independent', 11, 35)
    call tests%refuse('DOF.INI', 10, frame//' 0.0000000D+00  b(2)= 0.0000000D+00  b(3)= 0.0000000D+00', 'has length 0', 11, 35)
    call tests%refuse('DOF.INI', 11, '', 'where an axis of a frame', 12, 1)
    call tests%refuse('Vloc_Rloc.INI', 2, '$icdan  DKDKx        1', 'DKDKx', 2, 9)
    call tests%refuse('Vloc_Rloc.INI', 4, contacts(4)(:21)//'      3'//contacts(4)(29:), 'no contactor 3', 4, 28)
    call tests%refuse('Vloc_Rloc.INI', 4, ' RBDY3      1  SPHER      2  iqsc0', 'name the two contactors', 4, 2)
    call tests%refuse('Vloc_Rloc.INI', 9, ' '//repeat(' ', 28)//'q'//contacts(9)(31:), 'should stand here', 9, 30)
    call tests%refuse('Vloc_Rloc.INI', 9, ' '//repeat(' ', 28)//'s'//contacts(9)(31:), 'not complete', 11, 30)
    call tests%refuse('Vloc_Rloc.INI', 10, '', 'the file ends where the frame and point', 11, 0)
  end subroutine test_other_files

  !> Cut each file after each of its lines: whatever is told, the reader comes to an end, and takes no body for whole.
  subroutine test_every_cut()
    character(len=14), parameter :: names(5) = [character(len=14) :: 'BODIES.DAT', 'TACT_BEHAV.DAT', 'DRV_DOF.DAT', 'DOF.INI', &
                                                'Vloc_Rloc.INI']
    character(len=width), allocatable :: lines(:)
    integer :: f, i

    do f = 1, size(names)
      call tests%take(trim(names(f)), lines)
      do i = 0, size(lines) - 1
        call tests%write_good()
        call cut(trim(names(f)), i)
      end do
    end do
  end subroutine test_every_cut

  !> Read the folder with one file cut behind a line.
  subroutine cut(name, last)
    character(len=*), intent(in) :: name
    integer, intent(in) :: last
    character(len=width), allocatable :: lines(:)
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics

    call tests%take(name, lines)
    call tests%put(name, lines(:last))
    call read_datbox(folder, scene, diagnostics)
    if (name /= 'BODIES.DAT') return
    call tests%check(diagnostics%count() > 0 .or. any(last == [14, 23, 28, 29, 49]), 'bodies that end early: '//to_text(last))
  end subroutine cut
end program test_bad_datbox_space
