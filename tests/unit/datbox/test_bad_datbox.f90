!> Bad DATBOX folders: each is a good one with one thing wrong, and must be refused where it is wrong.
program test_bad_datbox
  use datbox_tests, only: any_place, datbox_tests_t, width
  use sg_datbox, only: read_datbox
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_system, only: remove_file
  use sg_text, only: text_t
  implicit none
  character(len=*), parameter :: folder = 'datbox_bad'
  character(len=*), parameter :: tab = achar(9)

  ! The good folder, line by line.
  character(len=width), parameter :: bulk(*) = [character(len=width) :: &
    '$gravy', &
    '                   grv1= 0.0000000D+00  grv2=-0.9810000D+01  grv3= 0.0000000D+00', &
    '$behav  lawty', &
    ' PLEXx  RIGID                           Umas= 0.2000000D+04']
  character(len=width), parameter :: tact(*) = [character(len=width) :: &
    '$behav  lawty', &
    ' iqsc0  IQS_CLB                         fric= 0.3000000D+00', &
    '$behav  lawty', &
    ' rstc0  RST_CLB                         rstn= 0.9000000D+00  rstt= 0.5000000D+00', &
    '                                        fric= 0.2500000D+00', &
    '$seety', &
    ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
    ' RBDY2  DISKx  BLEUx  iqsc0  RBDY2  POLYG  BLEUx       0.9000000D-02']
  character(len=width), parameter :: bodies(*) = [character(len=width) :: &
    '$bdyty', &
    ' RBDY2      1', &
    '$blmty', &
    ' PLAIN      1  behav  PLEXx  avrd= 0.1000000D+00  gyrd= 0.7000000D-01', &
    '$nodty', &
    ' NO3xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.0000000D+00', &
    '$tacty', &
    ' DISKx      1  color  BLEUx  byrd= 0.2000000D+00', &
    '$$$$$$', &
    '$bdyty', &
    ' RBDY2      2', &
    '$blmty', &
    ' PLAIN      1  behav  PLEXx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00', &
    '$nodty', &
    ' NO3xx      1                coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', &
    '$tacty', &
    ' POLYG      1  color  BLEUx  nb_vertex=    4      byrd= 0.0000000D+00', &
    '                             coo1= 0.2000000D+00  coo2= 0.0000000D+00', &
    '                             coo1= 0.6000000D+00  coo2= 0.0000000D+00', &
    '                             coo1= 0.6000000D+00  coo2= 0.5000000D+00', &
    '                             coo1= 0.2000000D+00  coo2= 0.5000000D+00', &
    '$$$$$$']
  character(len=width), parameter :: drives(*) = [character(len=width) :: &
    '$bdyty', &
    ' RBDY2      2', &
    '$nodty', &
    ' NO3xx      1', &
    '$dofty', &
    ' vlocy      1  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00', &
    ' force      2 evolution push.dat', &
    '$$$$$$']
  character(len=width), parameter :: push(*) = [character(len=width) :: '0.0 0.0', '1.0 5.0']
  character(len=width), parameter :: state(*) = [character(len=width) :: &
    '$steps       12              time= 0.2400000D-01', &
    '$bdyty', &
    ' RBDY2      1', &
    '$nodty', &
    ' NO3xx      1                X(1)= 0.1000000D-01  X(2)=-0.2000000D-01  X(3)= 0.3000000D+00', &
    '                             V(1)= 0.1000000D+01  V(2)= 0.2000000D+01  V(3)= 0.0000000D+00', &
    '$$$$$$']
  character(len=width), parameter :: contacts(*) = [character(len=width) :: &
    '$steps       12              time= 0.2400000D-01', &
    '$icdan  DKPLx        1', &
    ' cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus', &
    ' RBDY2      1  DISKx      1  iqsc0  RBDY2      2  POLYG      1  stick', &
    '                             rlt/H 0.1000000D+01  rln/H 0.2000000D+02  rls/H 0.0000000D+00', &
    '                             vlt = 0.0000000D+00  vln = 0.0000000D+00  vls = 0.0000000D+00', &
    '                             gapTT-0.1000000D-03', &
    '                             n(1)= 0.0000000D+00  n(2)= 0.1000000D+01  n(3)= 0.0000000D+00', &
    '                             coo1= 0.3000000D+00  coo2= 0.4000000D+00  coo3= 0.0000000D+00']
  type(datbox_tests_t) :: tests

  call tests%begin(folder, bulk, tact, bodies, drives, state)
  call tests%keep('push.dat', push)
  call tests%keep('Vloc_Rloc.INI', contacts)
  call tests%check_good(spare_laws=1)
  call test_bulk()
  call test_laws_and_sees()
  call test_bodies()
  call test_polygons()
  call test_drives()
  call test_state()
  call test_contacts()
  call test_whole_files()
  call test_every_cut()
  call tests%finish()

contains

  !> Gravity and densities.
  subroutine test_bulk()
    character(len=*), parameter :: file = 'BULK_BEHAV.DAT', law = ' PLEXx  RIGID                           Umas='

    call tests%refuse(file, 2, '                   grv1= 0.0000000D+00  grv2=-0.98x0000D+01', 'not a number', 2, 46)
    call tests%refuse(file, 2, '$behav', 'a keyword stands where the gravity', 2)
    call tests%refuse(file, 4, law//' 0.0000000D+00', 'density', 4, 46)
    call tests%refuse(file, 4, law//'-0.2000000D+04', 'density', 4, 46)
    call tests%refuse(file, 4, law//tab//'0.2000000D+04', 'a tab', 4, 46)
    call tests%refuse(file, 4, law, 'must be positive', 4, 46)
    call tests%refuse(file, 4, law//'field', 'is a field', 4, 46)
    call tests%refuse(file, 4, law//'          2000', 'decimal point', 4, 56)
    call tests%refuse(file, 4, law//' 0.2000000D+99', 'out of range', 4, 47)
    call tests%refuse(file, 4, law//' 0.20 0000D+04', 'not a number', 4, 47)
    call tests%refuse(file, 4, law//'           NaN', 'not a number', 4, 57)
    call tests%refuse(file, 4, ' hotxx  RIGID                           Umas= 0.2000000D+04', 'no bulk law is called ''PLEXx''', &
                      4, 23, 'BODIES.DAT')
  end subroutine test_bulk

  !> Contact laws and see tables.
  subroutine test_laws_and_sees()
    character(len=*), parameter :: file = 'TACT_BEHAV.DAT'
    ! Laws that are refused, and what to use in their place.
    character(len=*), parameter :: refused(2, 9) = reshape([character(len=32) :: &
      'IQS_BW_CLB', 'which is not done', 'MD_JKRs', 'use IQS_CLB', &
      'MAC_CZM', 'deformable bodies, and', 'EXPO_CZM', 'use IQS_EXPO_CZM', 'MP3_CZM', 'rigid bodies meet by one', &
      'IQS_EXPO_CZM_SPRING', 'springs in series', 'ELASTIC_REPELL_CLB_adapt', 'a folder holds no script', &
      'ELASTIC_REPELL_WET_CLB', 'use ELASTIC_REPELL_CLB without', &
      'VISCO_ELASTIC_REPELL_WET', 'use VISCO_ELASTIC_REPELL_CLB'], [2, 9])
    integer :: i

    do i = 1, size(refused, 2)
      call tests%refuse(file, 2, ' iqsc0  '//refused(1, i)//'fric= 0.3000000D+00', trim(refused(2, i)), 8, 23)
    end do
    call tests%refuse(file, 2, ' iqsc0  IQS_CLB                         fric=-0.3000000D+00', 'must not be negative', 2, 46)
    call tests%refuse(file, 2, ' iqsc0  IQS_CLB                         fric= 0.3000000D+50', 'since rounding of the slip', 2, 46)
    call tests%refuse(file, 2, ' rstc0  IQS_CLB                         fric= 0.3000000D+00', 'listed twice', 4, 2)
    call tests%refuse(file, 4, ' rstc0  RST_CLB                         rstn= 0.9000000D+01  rstt= 0.5000000D+00', 'restitution', &
                      4, 46)
    call tests%refuse(file, 5, '', 'the rest of the law', 6)
    call tests%refuse(file, 8, ' RBDY2  DISKx  BLEUx  iqscX  RBDY2  POLYG  BLEUx       0.9000000D-02', 'no contact law', 8, 23)
    call tests%refuse(file, 8, ' RBDY2  DISKx  BLEUx  iqsc0  RBDY2  POLYG  BLEUx      -0.9000000D-02', 'alert', 8)
    call tests%refuse(file, 8, '', 'the file ends where a see table', 8)
  end subroutine test_laws_and_sees

  !> Bodies and round contactors.
  subroutine test_bodies()
    character(len=*), parameter :: file = 'BODIES.DAT'

    call tests%refuse(file, 11, ' RBDY3      2', 'RBDY3', 11, 2)
    call tests%refuse(file, 2, ' RBDY3      1', 'in one DATBOX', 11, 2)
    call tests%refuse(file, 2, ' MAILx      1', 'MAILx', 2, 2)
    call tests%refuse(file, 3, '$thing', 'has no bulk element', 1)
    call tests%refuse(file, 5, '$thing', 'thing', 5)
    call tests%refuse(file, 5, ' ! a comment', 'must begin in column 1', 5, 2)
    call tests%refuse(file, 8, ' ###', 'must begin in column 1', 8, 2)
    call tests%refuse(file, 4, '', 'has no bulk element', 1)
    call tests%refuse(file, 4, ' PLAIN      1  behav  TDURx  avrd= 0.1000000D+00  gyrd= 0.7000000D-01', 'TDURx', 4, 23)
    call tests%refuse(file, 4, ' T3xxx      1  behav  PLEXx  avrd= 0.1000000D+00  gyrd= 0.7000000D-01', 'PLAIN', 4, 2)
    call tests%refuse(file, 4, ' PLAIN      1  behav  PLEXx  avrd=-0.1000000D+00  gyrd= 0.7000000D-01', 'negative', 4, 35)
    call tests%refuse(file, 6, '', 'has no node', 1)
    call tests%refuse(file, 6, ' NO3xx      1                coo1= 0.1000000D+01  coo2= 0.2000000DD01  coo3= 0.0000000D+00', &
                      'not a number', 6, 57)
    call tests%refuse(file, 8, '', 'has no contactor', 1)
    call tests%refuse(file, 8, ' DISKx      1  color  BLEUx  byrd=-0.2000000D+00', 'positive', 8, 35)
    call tests%refuse(file, 8, ' DISKx      1  color  BLEUx  byrd= 0.0000000D+00', 'positive', 8, 35)
    call tests%refuse(file, 8, ' DISKb      1  color  BLEUx  byrd= 0.2000000D+00', 'the centre of a shifted disk', 9)
    call tests%refuse(file, 8, ' DISPx      1  color  BLEUx  coo1= 0.2000000D+00  coo2= 0.2000000D+00', 'DISPx', 8, 2)
    call tests%refuse(file, 9, '', 'has not been ended', 10)
    call tests%refuse(file, 13, ' PLAIN      1  behav  PLEXx  avrd= 0.1000000-200  gyrd= 0.7000000D-01', 'no mass', 10)
  end subroutine test_bodies

  !> Polygons.
  subroutine test_polygons()
    character(len=*), parameter :: file = 'BODIES.DAT', head = ' POLYG      1  color  BLEUx  nb_vertex='
    character(len=*), parameter :: coo = '                             coo1='
    character(len=width), parameter :: star(5) = [character(len=width) :: &
      coo//' 0.1000000D+01  coo2= 0.0000000D+00', coo//'-0.8090170D+00  coo2= 0.5877853D+00', &
      coo//' 0.3090170D+00  coo2=-0.9510565D+00', coo//' 0.3090170D+00  coo2= 0.9510565D+00', &
      coo//'-0.8090170D+00  coo2=-0.5877853D+00']
    character(len=width), allocatable :: lines(:)

    call tests%refuse(file, 17, head//'    2', 'three', 17)
    call tests%refuse(file, 17, head//'9999999', 'cannot be', 17)
    call tests%refuse(file, 17, head//' four', 'whole number', 17, 41)
    call tests%refuse(file, 17, head//'    5', 'a vertex', 22)
    call tests%refuse(file, 20, coo//' 0.3000000D+00  coo2= 0.1000000D+00', 'not convex', 20, 35)
    call tests%refuse(file, 19, coo//' 0.2000000D+00  coo2= 0.0000000D+00', 'no area there', 19, 35)
    call tests%write_good()
    lines = bodies
    lines(18:21) = bodies([21, 20, 19, 18])
    call tests%put(file, lines)
    call tests%expect(file, 'clockwise', 17)
    ! A five-pointed star turns left alone, but twice around.
    lines = [character(len=width) :: bodies(:16), head//'    5', star, bodies(22:)]
    call tests%put(file, lines)
    call tests%expect(file, 'not convex', any_place)
    lines = bodies
    ! A bow tie turns both ways and has no area.
    lines(18:21) = bodies([18, 20, 19, 21])
    call tests%put(file, lines)
    call tests%expect(file, 'not convex', any_place)
  end subroutine test_polygons

  !> Drives and evolution files.
  subroutine test_drives()
    character(len=*), parameter :: file = 'DRV_DOF.DAT'
    character(len=*), parameter :: rest = '  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01'

    call tests%refuse(file, 2, ' RBDY2      7', 'no body 7', 2)
    call tests%refuse(file, 2, ' RBDY2  xx', 'whole number', 2, 9)
    call tests%refuse(file, 2, ' RBDY3      2', 'RBDY3', 2, 2)
    call tests%refuse(file, 6, ' vlocy      4'//rest//'  0.0000000D+00', 'components 1 (x)', 6)
    call tests%refuse(file, 6, ' push       1'//rest//'  0.0000000D+00', 'either ''vlocy'' or ''force''', 6, 2)
    call tests%refuse(file, 7, ' force      2 evolution nothing.dat', 'cannot read the file', 7, 25)
    call tests%refuse(file, 7, ' force      2 evolution', 'name of the evolution file', 7)
    call tests%refuse(file, 7, ' vlocy      1'//rest//'  0.0000000D+00', 'imposed before', 7)
    call tests%refuse('push.dat', 2, '', 'needs two lines', 7, 25, 'DRV_DOF.DAT')
  end subroutine test_drives

  !> Evolution files that hold no table, states.
  subroutine test_state()
    character(len=*), parameter :: file = 'DOF.INI'

    call tests%refuse('push.dat', 2, 'one two', 'a time and a value', 2)
    call tests%refuse('push.dat', 2, '0.0 3.0', 'times must grow', 2)
    call tests%refuse('push.dat', 2, '1.0 /', 'a time and a value', 2)
    call tests%refuse('push.dat', 2, '1.0 1.0e999', 'a time and a value', 2)
    call tests%refuse('push.dat', 2, '1.0 '//repeat('9', 90), 'a time and a value', 2)
    call tests%refuse('push.dat', 2, '1.0', 'a time and a value', 2)
    call tests%refuse(file, 1, '$steps      ten              time= 0.2400000D-01', 'whole number', 1, 13)
    call tests%refuse(file, 1, '$steps       12              time= soon', 'not a number', 1, 36)
    call tests%refuse(file, 3, ' RBDY2      3', 'no body 3', 3)
    call tests%refuse(file, 5, ' NO6xx      1                X(1)= 0.1000000D-01', 'NO3xx', 5, 2)
    call tests%refuse(file, 5, ' NO3xx      1                X(1)= 0.1000000D-01  X(2)=-0.2000000D-01  X(3)= ************', &
                      'not a number', 5, 78)
    call tests%refuse(file, 6, '', 'a velocity', 7)
  end subroutine test_state

  !> Contacts known at the start.
  subroutine test_contacts()
    character(len=*), parameter :: file = 'Vloc_Rloc.INI'

    call tests%refuse(file, 2, '$icdan  CLJCx        1', 'CLJCx', 2, 9)
    call tests%refuse(file, 4, ' RBDY2      9  DISKx      1  iqsc0  RBDY2      2  POLYG      1  stick', 'no body 9', 4, 13)
    call tests%refuse(file, 4, ' RBDY2  *****  DISKx      1  iqsc0  RBDY2      2  POLYG      1  stick', 'no readable number', 4, 9)
    call tests%refuse(file, 4, ' RBDY2      1  DISKx      2  iqsc0  RBDY2      2  POLYG      1  stick', 'no contactor 2', 4, 27)
    call tests%refuse(file, 4, ' RBDY2      1  DISKx      1', 'name the two contactors', 4)
    call tests%refuse(file, 5, '                             rlt/H 0.1000000D+01  rln/H     Infinity', 'not a number', 5, 61)
    call tests%refuse(file, 9, '', 'the point of a contact', 9)
  end subroutine test_contacts

  !> Missing, empty and garbled files.
  subroutine test_whole_files()
    character(len=*), parameter :: needed(3) = [character(len=14) :: 'BODIES.DAT', 'BULK_BEHAV.DAT', 'TACT_BEHAV.DAT']
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics, taken
    type(run_options_t) :: options
    character(len=width), allocatable :: lines(:)
    integer :: i

    do i = 1, size(needed)
      call tests%write_good()
      call remove_file(folder//'/'//trim(needed(i)))
      call tests%expect(trim(needed(i)), 'missing', 0)
    end do
    call tests%write_good()
    do i = 1, size(needed)
      call tests%write_good()
      call tests%put(trim(needed(i)), [character(len=width) ::])
      call tests%expect(trim(needed(i)), 'empty', 0)
    end do
    call tests%write_good()
    call tests%put('BODIES.DAT', [character(len=width) :: '! only', '# comments', ''])
    call tests%expect('BODIES.DAT', 'no body', any_place)
    call tests%put('BODIES.DAT', [character(len=width) :: (char(200)//char(0)//char(127)//'\0\%$', i=1, 200)])
    call tests%expect('BODIES.DAT', 'no body', any_place)
    call read_datbox('datbox_nowhere', scene, diagnostics)
    call tests%check(index(diagnostics%errors(1)%message, 'no such DATBOX') > 0, 'a missing folder')
    call tests%write_good()
    call read_deck(folder, [text_t ::], scene, options, taken)
    call tests%equal(taken%count(), 1, 'a folder given as a deck')
    if (taken%count() > 0) call tests%check(index(taken%errors(1)%message, 'folder of LMGC90') > 0, 'and what to do with it')
    allocate (lines(300))
    lines = bodies(8)
    lines(:7) = bodies(:7)
    lines(8:) = ' DISKx      1  color  BLEUx  byrd= zero'
    call tests%put('BODIES.DAT', lines)
    call tests%expect('BODIES.DAT', 'not a number', 8, 36)
    call read_datbox(folder, scene, diagnostics)
    call tests%check(diagnostics%count() < 30, 'mistakes without end are cut short')
    call tests%write_good()
    call remove_file(folder//'/DRV_DOF.DAT')
    call remove_file(folder//'/DOF.INI')
    call remove_file(folder//'/Vloc_Rloc.INI')
    ! Two files that are missing, and the spare law.
    call read_good_again('optional files may be missing', 3)
  end subroutine test_whole_files

  !> Read a folder that has no mistake, only warnings.
  subroutine read_good_again(what, warnings)
    character(len=*), intent(in) :: what
    integer, intent(in) :: warnings
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics

    call read_datbox(folder, scene, diagnostics)
    call tests%equal(diagnostics%count(), 0, what)
    call tests%equal(size(diagnostics%warnings), warnings, what//', with warnings')
  end subroutine read_good_again

  !> Cut each file after each line: never a crash, and a mistake unless what is left is whole.
  subroutine test_every_cut()
    character(len=*), parameter :: names(6) = [character(len=14) :: 'BODIES.DAT', 'BULK_BEHAV.DAT', 'TACT_BEHAV.DAT', &
                                               'DRV_DOF.DAT', 'DOF.INI', 'Vloc_Rloc.INI']
    ! Cuts after which a smaller file is left that is read: an unused law or an optional file may go, and the end of a file ends
    ! its last body, if the body has what it needs.
    integer, parameter :: whole(6) = [1, 0, 2, 7, 5, 2]
    character(len=width), allocatable :: lines(:)
    integer :: f, n, accepted

    do f = 1, size(names)
      call tests%take(trim(names(f)), lines)
      accepted = 0
      do n = 0, size(lines) - 1
        call tests%write_good()
        call tests%put(trim(names(f)), lines(:n))
        accepted = accepted + count_accepted()
      end do
      call tests%equal(accepted, whole(f), 'cuts of '//trim(names(f))//' that leave a whole file')
    end do
  end subroutine test_every_cut

  !> 1 when the folder as it stands has no mistake.
  integer function count_accepted()
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics

    call read_datbox(folder, scene, diagnostics)
    count_accepted = merge(1, 0, diagnostics%count() == 0)
  end function count_accepted
end program test_bad_datbox
