!> DATBOX folders in the forms that LMGC90's readers accept: each must be read as LMGC90 reads it, with one warning per kind.
program test_datbox_dialect
  use datbox_tests, only: datbox_tests_t, width
  use sg_datbox, only: read_datbox
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_scene, only: scene_t
  implicit none
  character(len=*), parameter :: folder = 'datbox_dialect'
  real(wp), parameter :: tight = 1e-13_wp
  character(len=*), parameter :: full_ramp = '  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00'

  character(len=width), parameter :: bulk(*) = [character(len=width) :: &
    '$gravy', &
    '                   grv1= 0.0000000D+00  grv2=-0.9810000D+01  grv3= 0.0000000D+00', &
    '$behav  lawty', &
    ' PLEXx  RIGID                           Umas= 0.2000000D+04']
  character(len=width), parameter :: tact(*) = [character(len=width) :: &
    '$behav  lawty', &
    ' iqsc0  IQS_CLB                         fric= 0.3000000D+00', &
    '$behav  lawty', &
    ' wet00  IQS_WET_DS_CLB                  cohn= 0.1000000D+01  coht= 0.2000000D+01', &
    '                                        Wthk= 0.1000000D-02', &
    '                                        dyfr= 0.4000000D+00  stfr= 0.5000000D+00', &
    '$seety', &
    ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
    ' RBDY2  DISKx  BLEUx  iqsc0  RBDY2  xKSID  WALLx       0.9000000D-02']
  character(len=width), parameter :: bodies(*) = [character(len=width) :: &
    '$bdyty', &
    ' RBDY2      1', &
    '$blmty', &
    ' PLAIN      1  behav  PLEXx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00', &
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
    ' NO3xx      1                coo1= 0.1000000D+01  coo2= 0.1000000D+01  coo3= 0.0000000D+00', &
    '$tacty', &
    ' xKSID      1  color  WALLx  byrd= 0.5000000D+01', &
    '$$$$$$']
  character(len=width), parameter :: drives(*) = [character(len=width) :: &
    '$bdyty', &
    ' RBDY2      2', &
    '$nodty', &
    ' NO3xx      1', &
    '$dofty', &
    ' vlocy      1  0.1000000D+01'//full_ramp, &
    ' vlocy      2  0.2000000D+01'//full_ramp, &
    ' vlocy      3  0.3000000D+01'//full_ramp, &
    '$$$$$$']
  character(len=width), parameter :: state(*) = [character(len=width) :: &
    '$steps        0              time= 0.0000000D+00']
  type(datbox_tests_t) :: tests

  call tests%begin(folder, bulk, tact, bodies, drives, state)
  call tests%check_good(spare_laws=1)
  call test_bulk()
  call test_laws()
  call test_lines_in_bodies()
  call test_held_bodies()
  call test_polygon_off_its_node()
  call test_drives()
  call test_states()
  call tests%finish()

contains

  !> Put the good folder there with other lines in one file, and read it: no mistake, so many warnings besides the spare law's.
  subroutine read_with(name, lines, what, warnings, scene)
    character(len=*), intent(in) :: name, lines(:), what
    integer, intent(in) :: warnings
    type(scene_t), intent(out) :: scene
    type(diagnostics_t) :: diagnostics
    integer :: i, n

    call tests%write_good()
    call tests%put(name, lines)
    call read_datbox(folder, scene, diagnostics)
    if (diagnostics%count() > 0) call diagnostics%print(6)
    call tests%equal(diagnostics%count(), 0, what)
    n = 0
    if (allocated(diagnostics%warnings)) n = count([(index(diagnostics%warnings(i)%message, 'no see table names') == 0, &
                                                     i=1, size(diagnostics%warnings))])
    call tests%equal(n, warnings, what//': warnings')
  end subroutine read_with

  !> Laws of coupled physics weigh what they weigh; lines that belong to nothing are counted.
  subroutine test_bulk()
    character(len=*), parameter :: file = 'BULK_BEHAV.DAT'
    character(len=width), parameter :: hot(*) = [character(len=width) :: &
      ' PLEXx  THERMO_RIGID                    Umas= 0.3000000D+04', &
      '                                        iso : TCnd= 0.1000000D+03', &
      '                                        Hspe= 0.1000000D+03', &
      '                                        Eeq = 0.1000000D+11  Nueq= 0.3000000D+00']
    type(scene_t) :: scene

    call read_with(file, [bulk(:3), hot], 'a thermal law', 1, scene)
    call tests%near(scene%materials(1)%density, 3000.0_wp, tight, 'density of a thermal law')
    call read_with(file, [character(len=width) :: ' # title', bulk, ' ####', '1! File'], 'lines outside blocks', 1, scene)
    call read_with(file, [bulk(:2), bulk], 'gravity twice', 1, scene)
    call read_with(file, [character(len=width) :: bulk(1), '                   grv1=', bulk(3:)], &
                   'no number for gravity', 1, scene)
    call tests%near(scene%gravity(2), 0.0_wp, tight, 'gravity without a number')
    call read_with(file, [character(len=width) :: bulk(1), '                   grv1=             0  grv2=-0.9810000D+01', &
                          bulk(3:)], 'zero without its point', 0, scene)
    ! A number that is cut is worth a warning where it is another then.
    call read_with(file, [character(len=width) :: bulk(1), '                   grv1=  0.0000000D+00 grv2=-0.9810000D+01', &
                          bulk(3:)], 'a zero that runs out of its columns', 0, scene)
    call read_with(file, [character(len=width) :: bulk(1), '                   grv1=  0.1000000D+01', bulk(3:)], &
                   'a number that runs out of its columns, and one that is not there', 2, scene)
    call tests%near(scene%gravity(1), 0.1_wp, tight, 'a number that is cut')
  end subroutine test_bulk

  !> A law takes as many lines as it has; others are passed over.
  subroutine test_laws()
    character(len=*), parameter :: file = 'TACT_BEHAV.DAT'
    type(scene_t) :: scene

    call read_with(file, [character(len=width) :: tact(:2), ' #####', tact(3:6), ' #####', tact(7:), ' # end'], &
                   'lines between laws', 1, scene)
    call tests%near(scene%laws(2)%wet_thickness, 1e-3_wp, tight, 'a law of three lines before a line of text')
    call tests%near(scene%laws(2)%static_friction, 0.5_wp, tight, 'its last number')
    ! LMGC90 finds no keyword in columns 2 to 6: the law below is not there for it.
    call read_with(file, [character(len=width) :: tact(:2), ' $behav  lawty', tact(4:)], 'a keyword one column off', 1, scene)
    call tests%equal(size(scene%laws), 1, 'laws without a keyword are not there')
    call read_with(file, [character(len=width) :: 'xbehav', tact(2:)], 'any letter before a keyword', 0, scene)
    call read_with(file, [character(len=width) :: tact(:8), tact(9)(:54)], 'no alert distance', 1, scene)
    call tests%near(scene%sees(1)%alert, 0.0_wp, tight, 'an alert distance without a number')
    ! Nothing here can be seen by these: bodies or contactors of such types are refused in BODIES.DAT.
    call read_with(file, [character(len=width) :: tact, tact(7:8), &
                          ' RBDY2  DISKx  BLEUx  iqsc0  MAILx  CLxxx  BLEUx       0.9000000D-02', tact(7:8), &
                          ' RBDY2  CLxxx  BLEUx  iqsc0  RBDY2  ALpxx  BLEUx       0.9000000D-02'], 'see tables of others', 3, scene)
    call tests%equal(size(scene%sees), 1, 'see tables that are left')
  end subroutine test_laws

  !> Comments in column 1, lines before the first section, lines without a type.
  subroutine test_lines_in_bodies()
    character(len=*), parameter :: file = 'BODIES.DAT'
    type(scene_t) :: scene

    call read_with(file, [character(len=width) :: '1! title', bodies(:2), '! one', bodies(3:4), '# two', bodies(5:7), '!', &
                          bodies(8:9), ' ! between', bodies(10:)], 'comments', 1, scene)
    call tests%equal(scene%bodies%n, 2, 'bodies among comments')
    call read_with(file, [character(len=width) :: bodies(:2), ' ! before', bodies(3:)], 'a comment before $blmty', 1, scene)
    call read_with(file, [character(len=width) :: bodies(:4), '                       some text', bodies(5:8), &
                          '                       some text', bodies(9:)], 'lines without a type', 1, scene)
    call read_with(file, [character(len=width) :: bodies(:3), bodies(4)(:30), bodies(5:)], 'no radii of mass', 1, scene)
    call tests%near(scene%bodies%mass(1), 2000*pi*0.04_wp, 1e-11_wp, 'mass from the shape')
    call read_with(file, bodies(:size(bodies) - 1), 'a last body without its end', 1, scene)
    call tests%equal(scene%bodies%n, 2, 'bodies up to the end of the file')
    call tests%put(file, [bodies(:8), bodies(10:)])
    call tests%expect(file, 'has not been ended', 9)
    call tests%put(file, bodies(:16))
    call tests%expect(file, 'has no contactor', 10)
  end subroutine test_lines_in_bodies

  !> A hollow disk without radii needs no mass where all its components are driven, by the last block that names it.
  subroutine test_held_bodies()
    type(scene_t) :: scene

    call read_with('DRV_DOF.DAT', [drives(:5), drives(8:), drives], 'a held body', 1, scene)
    call tests%near(scene%bodies%mass(2), 0.0_wp, tight, 'its mass')
    call tests%write_good()
    call tests%put('DRV_DOF.DAT', [drives(:7), drives(9:)])
    call tests%expect('BODIES.DAT', 'its mass is unknown', 10)
    call tests%put('DRV_DOF.DAT', [drives, drives(:5), drives(8:)])
    call tests%expect('BODIES.DAT', 'its mass is unknown', 10)
  end subroutine test_held_bodies

  !> A polygon off its node: far ones take the centre with them, near ones are moved to the node.
  subroutine test_polygon_off_its_node()
    character(len=*), parameter :: low(2) = [' 0.0000000D+00', ' 0.1900000D+00'], high(2) = [' 0.4000000D+00', ' 0.2100000D+00']
    real(wp), parameter :: node(2) = [1.0_wp, 2.0_wp]
    type(scene_t) :: scene
    character(len=width) :: corners(4)
    real(wp) :: centre(2)
    integer :: i, k

    do i = 1, 2
      ! About (0.2, 0.2), or by half a millimetre off the node.
      corners = [character(len=width) :: corner(low(1), low(1)), corner(high(1), low(1)), corner(high(1), high(1)), &
                 corner(low(1), high(1))]
      if (i == 2) corners = [character(len=width) :: corner('-0.2000000D+00', '-0.2000000D+00'), &
                             corner(' 0.2010000D+00', '-0.2000000D+00'), corner(' 0.2010000D+00', ' 0.2000000D+00'), &
                             corner('-0.2000000D+00', ' 0.2000000D+00')]
      call read_with('BODIES.DAT', [character(len=width) :: bodies(:7), &
                                    ' POLYG      1  color  BLEUx  nb_vertex=      4    byrd= 0.0000000D+00', corners, bodies(9:)], &
                     'a polygon off its node', 2, scene)
      centre = merge(0.2_wp, 0.0_wp, i == 1)
      do k = 1, 2
        call tests%near(scene%bodies%position(k, 1), node(k) + centre(k), 1e-12_wp, 'centre of a polygon off its node')
        call tests%near(scene%contactors%shift(k, 1), 0.0_wp, tight, 'shift of a polygon off its node')
      end do
      call tests%near(scene%bodies%inertia(1), scene%bodies%mass(1)*merge(0.32_wp, 0.401_wp**2 + 0.16_wp, i == 1)/12, 1e-9_wp, &
                      'inertia about the centroid')
    end do
  end subroutine test_polygon_off_its_node

  !> A corner of a polygon.
  pure function corner(x, y) result(line)
    character(len=*), intent(in) :: x, y
    character(len=width) :: line

    line = '                             coo1='//x//'  coo2='//y
  end function corner

  !> The last block of a body counts; a number that is missing is zero.
  subroutine test_drives()
    character(len=*), parameter :: file = 'DRV_DOF.DAT'
    type(scene_t) :: scene

    call read_with(file, [drives, drives(:5), drives([8, 7, 6]), drives(9)], 'two blocks of a body', 1, scene)
    call tests%equal(size(scene%drives), 3, 'drives of the last block')
    call tests%near(scene%drives(1)%value%at(0.0_wp), 3.0_wp, tight, 'first drive of the last block')
    call read_with(file, [character(len=width) :: ' ! title', drives(:5), drives(6)(:88), drives(7:)], &
                   'no rate of the ramp', 2, scene)
    call tests%near(scene%drives(1)%value%at(0.0_wp), 1.0_wp, tight, 'a drive without rate of its ramp')
    call read_with(file, drives(:8), 'a last block without its end', 1, scene)
    call tests%equal(size(scene%drives), 3, 'drives up to the end of the file')
    call read_with(file, [character(len=width) :: drives(:6), '$bdyty', ' RBDY2      1', drives(3:5), drives(7), drives], &
                   'blocks that the next one ends', 2, scene)
    call tests%equal(count(scene%drives%body == 1), 1, 'drives of a block that the next one ends')
    call tests%equal(count(scene%drives%body == 2), 3, 'drives of the block after it')
  end subroutine test_drives

  !> The last state of a body counts.
  subroutine test_states()
    character(len=width), parameter :: moved(*) = [character(len=width) :: '$bdyty', ' RBDY2      1', '$nodty', &
      ' NO3xx      1                X(1)= 0.1000000D+01  X(2)= 0.0000000D+00  X(3)= 0.5000000D+00', &
      '                             V(1)= 0.1000000D+01  V(2)= 0.0000000D+00  V(3)= 0.0000000D+00', '$$$$$$']
    type(scene_t) :: scene

    call read_with('DOF.INI', [character(len=width) :: ' ! title', state, moved(:3), ' ', moved(4:), moved], &
                   'two states of a body', 1, scene)
    call tests%near(scene%bodies%position(1, 1), 2.0_wp, tight, 'place by the last state')
    call tests%near(scene%bodies%angle(1), 0.5_wp, tight, 'angle by the last state')
    call read_with('DOF.INI', [character(len=width) :: state, moved(:5), '$bdyty', ' RBDY2      2', moved(3:5)], &
                   'states without an end', 2, scene)
    call tests%near(scene%bodies%position(1, 1), 2.0_wp, tight, 'place by a state that the next one ends')
    call tests%near(scene%bodies%position(1, 2), 2.0_wp, tight, 'place by a state that the end of the file ends')
  end subroutine test_states
end program test_datbox_dialect
