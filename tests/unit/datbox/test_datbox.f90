!> DATBOX folders: a small one that holds every construct, and what is written read back.
program test_datbox
  use harness, only: tests_t
  use sg_contactors, only: kind_disk, kind_hollow, kind_polygon, kind_segment
  use sg_datbox, only: read_datbox
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, pi
  use sg_laws, only: law_elastic, law_gap, law_iqs, law_linear, law_mohr, law_restitution, law_velocity, law_wet, &
                     status_bonded, status_new, status_none, status_slide, status_stick
  use sg_scene, only: law_index, scene_t, see_t
  use sg_system, only: file_exists, make_folder
  use sg_timers, only: cpu_now
  use written_files, only: put_lines
  implicit none
  type(tests_t) :: tests
  character(len=*), parameter :: folder = 'datbox_sample'

  call write_sample()
  call test_bodies()
  call test_laws()
  call test_drives()
  call test_state()
  call test_round_trip(folder, 'the sample')
  call test_native_names()
  call test_what_cannot_be_written()
  call test_many_bodies()
  call tests%finish()

contains

  !> Write the sample folder: disk, cluster, segment, hollow disk, two polygons, and all the rest.
  subroutine write_sample()
    if (.not. make_folder(folder)) error stop 'no folder'
    call put_lines(folder//'/BULK_BEHAV.DAT', [character(len=104) :: '! bulk', &
      '$gravy', &
      '                   grv1= 0.5000000D+00  grv2=-0.9810000D+01  grv3= 0.0000000D+00', '', &
      '$behav  lawty', &
      ' PLEXx  RIGID                           Umas= 0.2000000D+04', &
      '$behav  lawty', &
      ' hotxx  THERMO_RIGID                    Umas= 0.2000000D+04'])
    call write_sample_laws()
    call write_sample_bodies()
    call put_lines(folder//'/DRV_DOF.DAT', [character(len=104) :: '! DOF', &
      '$bdyty', ' RBDY2      3', '$nodty', ' NO3xx      1', '$dofty  numbr', &
      ' vlocy      1  0.1000000D+01  0.2000000D+01  0.3000000D+01  0.4000000D+00  0.2500000D+00  0.5000000D+00', &
      ' force      2 evolution push.dat', &
      ' vlocy      3  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00', &
      '$$$$$$', '', &
      '$bdyty', ' RBDY2      4', '$nodty', ' NO3xx      1'//achar(9), '$dofty', &
      ' vlocy      2 -0.5000000E+00  0.0000000E+00  0.0000000e+00  0.0000000e+00  1.0000000e+00  0.0000000e+00'//achar(9), &
      '$$$$$$'])
    call put_lines(folder//'/push.dat', [character(len=104) :: '  0.008 0.0', '1. 19000.0', ' 2.0D0  -1.9e4'])
    call put_lines(folder//'/DOF.INI', [character(len=104) :: '! DOF', '', &
      '$steps       12              time= 0.2400000D-01', '!---', &
      '$bdyty', ' RBDY2      1', '$nodty', &
      ' NO3xx      1                X(1)= 0.1000000D-01  X(2)=-0.2000000D-01  X(3)= 0.3000000D+00', &
      '                             V(1)= 0.1000000D+01  V(2)= 0.2000000D+01  V(3)=-0.3000000-120', '$$$$$$', &
      '$bdyty', ' RBDY2      5', '$nodty', &
      ' NO3xx      1                X(1)= 0.0000000D+00  X(2)= 0.1000000D+00  X(3)= 0.0000000D+00', &
      '                             V(1)= 0.0000000D+00  V(2)= 0.0000000D+00  V(3)= 0.7000000D+01', '$$$$$$'])
    call write_sample_contacts()
  end subroutine write_sample

  !> Laws of every form, one unknown that nothing uses, see tables.
  subroutine write_sample_laws()
    call put_lines(folder//'/TACT_BEHAV.DAT', [character(len=104) :: &
      '$behav  lawty', ' iqsc0  IQS_CLB                         fric= 0.3000000D+00', &
      '$behav  lawty', ' iqsds  IQS_DS_CLB                      dyfr= 0.3000000D+00  stfr= 0.5000000D+00', &
      '$behav  lawty', ' gapc0  GAP_SGR_CLB                     fric= 0.4000000D+00', &
      '$behav  lawty', ' gapds  GAP_SGR_DS_CLB                  dyfr= 0.1000000D+00  stfr= 0.2000000D+00', &
      '$behav  lawty', ' velc0  VEL_SGR_CLB                     fric= 0.6000000D+00', &
      '$behav  lawty', ' velds  VEL_SGR_DS_CLB                  dyfr= 0.7000000D+00  stfr= 0.8000000D+00', &
      '$behav  lawty', ' rstc0  RST_CLB                         rstn= 0.9000000D+00   rstt 0.5000000D+00', &
      '                                        fric= 0.2500000D+00', &
      '$behav  lawty', ' rstds  RST_DS_CLB                      rstn= 0.8000000D+00  rstt= 0.1000000D+00', &
      '                                        dyfr= 0.3000000D+00  stfr= 0.5000000D+00', &
      '$behav  lawty', ' wet02  IQS_WET_DS_CLB                  cohn= 0.2234379D+01  Wthk= 0.1000000D-02', &
      '                                        dyfr= 0.2500000D+00  stfr= 0.5500000D+00', &
      '$behav  lawty', ' wet03  IQS_WET_DS_CLB                  cohn= 0.3000000D+01  coht= 0.4000000D+01', &
      '                                        Wthk= 0.5000000D-02', &
      '                                        dyfr= 0.2500000D+00  stfr= 0.5500000D+00', &
      '$behav  lawty', ' mohr1  IQS_MOHR_DS_CLB                 cohn= 0.9000000D+01  coht= 0.5000000D+00', &
      '                                        dyfr= 0.2600000D+00  stfr= 0.5600000D+00', &
      '$behav  lawty', ' elasE  ELASTIC_REPELL_CLB              F/gp= 0.1000000D+07', &
      '                                        fric= 0.8391000D+00', &
      '$behav  lawty', ' cpldf  COUPLED_DOF', &
      '$behav  lawty', ' czmxx  MAC_CZM                         dyfr= 0.3000000D+00  stfr= 0.5000000D+00', &
      '                                        cn  = 0.3000000D+00  ct  = 0.5000000D+00', &
      '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
      ' RBDY2  POLYG  BLEUx  gapds  RBDY2  POLYG  BLEUx       0.9000000D-02', &
      '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
      ' RBDY2  DISKx  BLEUx  iqsc0  RBDY2  JONCx  WALLx       0.5000000D-03', &
      '+                                                      0.1000000D+00', &
      '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
      ' RBDY2  DISKx  REDxx  rstc0  RBDY2  DISKx  BLEUx       0.6000000D-03', &
      '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
      ' RBDY2  DISKx  BLEUx  iqsc0  RBDY2  xKSID  WALLx       0.7000000D-03'])
  end subroutine write_sample_laws

  !> Bodies: disk, cluster with its node at the origin, segment, hollow disk, polygon in global coordinates, polygon.
  subroutine write_sample_bodies()
    call put_lines(folder//'/BODIES.DAT', [character(len=104) :: &
      '$bdyty', ' RBDY2      1', '$blmty', &
      ' PLAIN      1  behav  PLEXx  avrd= 0.1000000D+00  gyrd= 0.7000000D-01', '', '$nodty', &
      ' NO3xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.5000000D+00', '$tacty', &
      ' DISKx      1  color  BLEUx  byrd= 0.2000000D+00', '$$$$$$', '', &
      '$bdyty', ' RBDY2      1', '$blmty', &
      ' PLAIN      1  behav  PLEXx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00', '$nodty', &
      ' NO3xx      1                coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', '$tacty', &
      ' DISKb      1  color  REDxx  byrd= 0.1000000D+00', '                             coo1= 0.3000000D+01  coo2= 0.0000000D+00', &
      ' DISKb      2  color  BLEUx  byrd= 0.2000000D+00', '                             coo1= 0.3500000D+01  coo2= 0.0000000D+00', &
      '$$$$$$', &
      '$bdyty', ' RBDY2      1', '$blmty', &
      ' PLAIN      1  behav  PLEXx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00', '$nodty', &
      ' NO3xx      1                coo1= 0.5000000D+01  coo2= 0.0000000D+00  coo3= 0.1570796D+01', '$tacty', &
      ' JONCx      1  color  WALLx   ax1= 0.3000000D+00   ax2= 0.1000000D+00', '$$$$$$', &
      '$bdyty', ' RBDY2      1', '$blmty', &
      ' PLAIN      1  behav  PLEXx  avrd= 0.5000000D+00  gyrd= 0.4000000D+00', '$nodty', &
      ' NO3xx      1                coo1= 0.7000000D+01  coo2= 0.1000000D+01  coo3= 0.0000000D+00', '$tacty', &
      ' xKSID      1  color  WALLx  byrd= 0.2000000D+01', '$$$$$$', &
      '$bdyty', ' RBDY2      1', '$blmty', &
      ' PLAIN      1  behav  PLEXx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00', '$nodty', &
      ' NO3xx      1                coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00', '$tacty', &
      ' POLYG      1  color  BLEUx  nb_vertex=    4      byrd= 0.0000000D+00', &
      '                             coo1= 0.2000000D+00  coo2= 0.0000000D+00', &
      '                             coo1= 0.6000000D+00  coo2= 0.0000000D+00', &
      '                             coo1= 0.6000000D+00  coo2= 0.0500000D+00', &
      '                             coo1= 0.2000000D+00  coo2= 0.0500000D+00', '$$$$$$', &
      '$bdyty', ' RBDY2      1', '$blmty', &
      ' PLAIN      1  behav  PLEXx  avrd= 0.3000000D+00  gyrd= 0.2000000D+00', '$nodty', &
      ' NO3xx      1                coo1= 0.9000000D+01  coo2= 0.0000000D+00  coo3= 0.0000000D+00', '$tacty', &
      ' POLYG      1  color  BLEUx  nb_vertex=      3    byrd= 0.0000000D+00', &
      '                             coo1= 0.0000000D+00  coo2= 0.0000000D+00', &
      '                             coo1= 0.3000000D+00  coo2= 0.0000000D+00', &
      '                             coo1= 0.0000000D+00  coo2= 0.3000000D+00', '$$$$$$'])
  end subroutine write_sample_bodies

  !> One contact of each pair; the second in the form for many bodies.
  subroutine write_sample_contacts()
    character(len=104), parameter :: data(5) = [character(len=104) :: &
      '                             rlt/H 0.1000000D+01  rln/H 0.2000000D+02  rls/H 0.0000000D+00', &
      '                             vlt = 0.0000000D+00  vln = 0.0000000D+00  vls = 0.0000000D+00', &
      '                             gapTT-0.1000000D-03', &
      '                             n(1)= 0.0000000D+00  n(2)= 0.1000000D+01  n(3)= 0.0000000D+00', &
      '                             coo1= 0.3000000D+00  coo2= 0.4000000D+00  coo3= 0.0000000D+00']

    call put_lines(folder//'/Vloc_Rloc.INI', [character(len=104) :: '! Vloc_Rloc', &
      '$steps       12              time= 0.2400000D-01', &
      '$icdan  DKDKx        1', ' cdbdy', &
      ' RBDY2      2  DISKx      2  iqsc1  RBDY2      1  DISKx      1  stick    297', data, '', &
      '$icdan  DKJCx           2', ' cdbdy', &
      ' RBDY2           2  DISKx      1  iqsc0  RBDY2           3  JONCx      1  slifw', data, &
      '$icdan  DKKDx        3', ' cdbdy', &
      ' RBDY2      1  DISKx      1  iqsc0  RBDY2      4  xKSID      1  noctc', data, &
      '$icdan  DKPLx        4', ' cdbdy', &
      ' RBDY2      1  DISKx      1  iqsc0  RBDY2      5  POLYG      1  Mstck', data, &
      '$icdan  PLPLx        5', ' cdbdy', &
      ' RBDY2      6  POLYG      1  CDVER      3  iqsc0  RBDY2      5  POLYG      1  ANSEG      5  nknow     1', data, &
      '$icdan  PLJCx        6', ' cdbdy', &
      ' RBDY2      6  POLYG      1  CDVER      2  iqsc0  RBDY2      3  JONCx      1                stick     1', data])
  end subroutine write_sample_contacts

  !> Read the sample, which has no mistake.
  subroutine read_sample(scene, diagnostics)
    type(scene_t), intent(out) :: scene
    type(diagnostics_t), intent(out) :: diagnostics

    call read_datbox(folder, scene, diagnostics)
    if (diagnostics%count() == 0) return
    call diagnostics%print(6)
    error stop 'the sample cannot be read'
  end subroutine read_sample

  !> Bodies and contactors of the sample against hand calculation.
  subroutine test_bodies()
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    real(wp), parameter :: tight = 1e-13_wp
    real(wp) :: caps

    call read_sample(scene, diagnostics)
    ! Unknown bulk law, unknown contact law, halo: unused or harmless; a polygon off its node; laws that no see table names: one
    ! warning each.
    call tests%equal(size(diagnostics%warnings), 5, 'warnings of the sample')
    call tests%equal(scene%bodies%n, 6, 'bodies')
    call tests%equal(scene%contactors%n, 7, 'contactors')
    call tests%check(all(scene%contactors%kind(:7) == [kind_disk, kind_disk, kind_disk, kind_segment, kind_hollow, &
                                                       kind_polygon, kind_polygon]), 'kinds')
    call tests%check(all(scene%contactors%body(:7) == [1, 2, 2, 3, 4, 5, 6]), 'bodies of contactors')
    call tests%near(scene%gravity(1), 0.5_wp, tight, 'gravity in x')
    call tests%near(scene%gravity(2), -9.81_wp, tight, 'gravity in y')
    associate (b => scene%bodies)
      call tests%near(b%mass(1), 2000*pi*0.01_wp, 1e-10_wp, 'mass from avrd')
      call tests%near(b%inertia(1), 2000*pi*0.01_wp*0.0049_wp, 1e-12_wp, 'inertia from gyrd')
      call tests%near(b%area(1), pi*0.04_wp, tight, 'area from the shape')
      call tests%near(b%position(1, 2), (0.01_wp*3 + 0.04_wp*3.5_wp)/0.05_wp, tight, 'centre of the cluster')
      call tests%near(scene%contactors%shift(1, 2), -0.4_wp, tight, 'first disk about the new centre')
      call tests%near(scene%contactors%shift(1, 3), 0.1_wp, tight, 'second disk about the new centre')
      call tests%near(b%inertia(2), 2000*pi*(0.01_wp*(0.005_wp + 0.16_wp) + 0.04_wp*(0.02_wp + 0.01_wp)), 1e-11_wp, &
                      'inertia of the cluster')
      caps = pi*0.01_wp
      call tests%near(b%mass(3), 2000*(0.12_wp + caps), 1e-10_wp, 'mass of the segment')
      ! Rectangle about its centre, and two half disks about theirs at a + 4b/(3 pi).
      call tests%near(b%inertia(3), 2000*(0.12_wp*0.1_wp/3 + caps*(0.005_wp - (0.4_wp/(3*pi))**2 &
                                          + (0.3_wp + 0.4_wp/(3*pi))**2)), 1e-11_wp, 'inertia of the segment')
      call tests%near(b%area(4), 0.0_wp, tight, 'a hollow disk covers nothing')
      call tests%near(b%position(1, 5), 0.4_wp, tight, 'centre of the polygon in x')
      call tests%near(b%position(2, 5), 0.125_wp, tight, 'centre of the polygon in y, displaced')
      call tests%near(b%mass(5), 40.0_wp, 1e-11_wp, 'mass of the polygon')
      call tests%near(b%inertia(5), 40*(0.16_wp + 0.0025_wp)/12, 1e-11_wp, 'inertia of the polygon')
      call tests%check(all(b%is_grain .eqv. [.true., .true., .false., .false., .true., .true.]), 'driven bodies are no grains')
      call tests%near(b%inverse_mass(3, 1)*b%inertia(1), 1.0_wp, tight, 'inverse inertia')
      call tests%near(b%position(1, 6), 9.1_wp, tight, 'the centre of a polygon off its node')
    end associate
    call tests%near(scene%contactors%shift(1, 7), 0.0_wp, tight, 'polygon about its own centre')
  end subroutine test_bodies

  !> Laws and see tables of the sample.
  subroutine test_laws()
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    integer :: i

    call read_sample(scene, diagnostics)
    call tests%equal(size(scene%laws), 13, 'laws')
    call tests%check(all(scene%laws%kind == [law_iqs, law_iqs, law_gap, law_gap, law_velocity, law_velocity, law_restitution, &
      law_restitution, law_wet, law_wet, law_mohr, law_elastic, law_linear]), 'kinds of law')
    call check_numbers(scene, 'iqsc0', [0.3_wp, 0.3_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    call check_numbers(scene, 'iqsds', [0.5_wp, 0.3_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    call check_numbers(scene, 'gapds', [0.2_wp, 0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    call check_numbers(scene, 'velds', [0.8_wp, 0.7_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    call check_numbers(scene, 'rstc0', [0.25_wp, 0.25_wp, 0.9_wp, 0.5_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    call check_numbers(scene, 'rstds', [0.5_wp, 0.3_wp, 0.8_wp, 0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    call check_numbers(scene, 'wet02', [0.55_wp, 0.25_wp, 0.0_wp, 0.0_wp, 2.234379_wp, 0.0_wp, 0.001_wp, 0.0_wp])
    call check_numbers(scene, 'wet03', [0.55_wp, 0.25_wp, 0.0_wp, 0.0_wp, 3.0_wp, 4.0_wp, 0.005_wp, 0.0_wp])
    call check_numbers(scene, 'mohr1', [0.56_wp, 0.26_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    associate (mohr => scene%laws(law_index(scene, 'mohr1')))
      call tests%near(mohr%normal_strength, 9.0_wp, 1e-14_wp, 'a cohesion that is a stress')
      call tests%near(mohr%tangential_strength, 0.5_wp, 1e-15_wp, 'and that of shear')
    end associate
    call check_numbers(scene, 'elasE', [0.8391_wp, 0.8391_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1e6_wp])
    call tests%equal(size(scene%sees), 4, 'see tables')
    associate (see => scene%sees(3))
      call tests%check(see%candidate_kind == kind_disk .and. see%antagonist_kind == kind_disk, 'kinds of a see table')
      call tests%check(scene%colours(see%candidate_colour)%s == 'REDxx', 'colour of the candidate')
      call tests%check(scene%colours(see%antagonist_colour)%s == 'BLEUx', 'colour of the antagonist')
      call tests%equal(see%law, law_index(scene, 'rstc0'), 'law of a see table')
      call tests%near(see%alert, 0.6e-3_wp, 1e-18_wp, 'alert distance')
    end associate
    call tests%check(all([(scene%sees(i)%law > 0, i=1, 4)]), 'see tables have laws')
  end subroutine test_laws

  !> Compare all numbers of a law: frictions, restitutions, cohesions, thickness, stiffness.
  subroutine check_numbers(scene, name, expected)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: expected(8)

    associate (law => scene%laws(law_index(scene, name)))
      call tests%check(all(abs([law%static_friction, law%dynamic_friction, law%normal_restitution, &
        law%tangential_restitution, law%normal_cohesion, law%tangential_cohesion, law%wet_thickness, law%stiffness] &
                               - expected) <= 1e-15_wp*max(1.0_wp, expected)), 'numbers of the law '//name)
    end associate
  end subroutine check_numbers

  !> Drives of the sample: formula, evolution file.
  subroutine test_drives()
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    real(wp), parameter :: t = 0.7_wp

    call read_sample(scene, diagnostics)
    call tests%equal(size(scene%drives), 4, 'drives')
    call tests%check(all(scene%drives%body == [3, 3, 3, 4]), 'bodies of the drives')
    call tests%check(all(scene%drives%component == [1, 2, 3, 2]), 'components of the drives')
    call tests%check(all(scene%drives%is_velocity .eqv. [.true., .false., .true., .true.]), 'velocities and forces')
    call tests%near(scene%drives(1)%value%at(t), (1 + 2*cos(3*t + 0.4_wp))*(0.25_wp + 0.5_wp*t), 1e-14_wp, 'formula with ramp')
    call tests%near(scene%drives(2)%value%at(0.504_wp), 9500.0_wp, 1e-9_wp, 'evolution file, between two points')
    call tests%near(scene%drives(2)%value%at(3.0_wp), -57000.0_wp, 1e-9_wp, 'evolution file, beyond its end')
    call tests%near(scene%drives(2)%value%at(0.0_wp), -152/0.992_wp, 1e-9_wp, 'evolution file, before its begin')
    call tests%near(scene%drives(4)%value%at(t), -0.5_wp, 1e-15_wp, 'constant')
  end subroutine test_drives

  !> State and contacts of the sample.
  subroutine test_state()
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    integer :: i

    call read_sample(scene, diagnostics)
    call tests%equal(int(scene%start_step), 12, 'step number')
    call tests%near(scene%start_time, 0.024_wp, 1e-17_wp, 'time')
    call tests%near(scene%bodies%position(2, 1), 1.98_wp, 1e-15_wp, 'displaced position')
    call tests%near(scene%bodies%angle(1), 0.8_wp, 1e-15_wp, 'turned angle')
    call tests%near(scene%bodies%velocity(2, 1), 2.0_wp, 1e-15_wp, 'velocity')
    call tests%near(scene%bodies%velocity(3, 5), 7.0_wp, 1e-15_wp, 'spin')
    call tests%near(scene%bodies%velocity(3, 6), 0.0_wp, 0.0_wp, 'a body that is not listed is at rest')
    call tests%equal(size(scene%start_contacts), 6, 'contacts')
    associate (contacts => scene%start_contacts)
      call tests%check(all([(contacts(i)%contactor(1), i=1, 6)] == [3, 2, 1, 1, 7, 7]), 'candidates')
      call tests%check(all([(contacts(i)%contactor(2), i=1, 6)] == [1, 4, 5, 6, 6, 4]), 'antagonists')
      call tests%check(all(contacts%status == [status_stick, status_slide, status_none, status_bonded, status_new, &
                                               status_stick]), 'statuses')
      call tests%near(contacts(1)%force(1), 20.0_wp, 1e-14_wp, 'normal force')
      call tests%near(contacts(6)%force(2), 1.0_wp, 1e-15_wp, 'tangential force')
      call tests%near(contacts(5)%point(2), 0.4_wp, 1e-15_wp, 'point')
    end associate
  end subroutine test_state

  !> A folder read, written and read again gives the same scene.
  subroutine test_round_trip(source, what)
    character(len=*), intent(in) :: source, what
    type(scene_t) :: scene, again
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error

    call read_datbox(source, scene, diagnostics)
    call write_datbox('datbox_written', scene, contacts_at_start(scene), scene%start_time, int(scene%start_step), error)
    call tests%check(.not. allocated(error), 'writing '//what)
    if (allocated(error)) return
    call read_datbox('datbox_written', again, diagnostics)
    call tests%equal(diagnostics%count(), 0, 'reading again '//what)
    if (diagnostics%count() > 0) call diagnostics%print(6)
    if (diagnostics%count() == 0) call compare(scene, again, what)
  end subroutine test_round_trip

  !> Compare two scenes: seven digits or better, as the format holds eight.
  subroutine compare(a, b, what)
    type(scene_t), intent(in) :: a, b
    character(len=*), intent(in) :: what
    integer :: i, n

    call tests%check(a%bodies%n == b%bodies%n .and. a%contactors%n == b%contactors%n .and. size(a%laws) == size(b%laws) &
                     .and. size(a%drives) == size(b%drives) .and. size(a%start_contacts) == size(b%start_contacts), &
                     'counts of '//what)
    n = a%contactors%n
    call tests%check(all(a%contactors%kind(:n) == b%contactors%kind(:n)) .and. &
                     all(a%contactors%body(:n) == b%contactors%body(:n)), 'contactors of '//what)
    call same(reshape(a%contactors%shift(:, :n), [2*n]), reshape(b%contactors%shift(:, :n), [2*n]), 1.0_wp, 'shifts of '//what)
    call same(a%contactors%reach(:n), b%contactors%reach(:n), 1.0_wp, 'reaches of '//what)
    n = a%bodies%n
    ! The displacement holds what the place loses: positions keep more than twelve digits.
    call same(reshape(a%bodies%position, [2*n]), reshape(b%bodies%position, [2*n]), 1e-5_wp, 'positions of '//what)
    call same(a%bodies%angle, b%bodies%angle, 1.0_wp, 'angles of '//what)
    call same(reshape(a%bodies%velocity, [3*n]), reshape(b%bodies%velocity, [3*n]), 1.0_wp, 'velocities of '//what)
    call same(a%bodies%mass, b%bodies%mass, 1.0_wp, 'masses of '//what)
    call same(a%bodies%inertia, b%bodies%inertia, 1.0_wp, 'inertias of '//what)
    call same(a%bodies%area, b%bodies%area, 1.0_wp, 'areas of '//what)
    call tests%check(all(a%bodies%is_grain .eqv. b%bodies%is_grain), 'grains of '//what)
    call same(a%sees%alert, b%sees%alert, 1.0_wp, 'alert distances of '//what)
    call tests%check(size(a%sees) == size(b%sees), 'see tables of '//what)
    call tests%check(all(a%sees%law == b%sees%law) .and. all(a%sees%candidate_kind == b%sees%candidate_kind), &
                     'laws of the see tables of '//what)
    call same(a%laws%static_friction, b%laws%static_friction, 1.0_wp, 'frictions of '//what)
    call same(a%laws%normal_cohesion, b%laws%normal_cohesion, 1.0_wp, 'cohesions of '//what)
    call same(a%laws%stiffness, b%laws%stiffness, 1.0_wp, 'stiffnesses of '//what)
    call same([(a%drives(i)%value%at(0.3_wp), i=1, size(a%drives))], [(b%drives(i)%value%at(0.3_wp), i=1, size(b%drives))], &
              1.0_wp, 'drives of '//what)
    n = size(a%start_contacts)
    call tests%check(all([(all(a%start_contacts(i)%contactor == b%start_contacts(i)%contactor), i=1, n)]), 'pairs of '//what)
    call tests%check(all(a%start_contacts%status == b%start_contacts%status), 'statuses of '//what)
    call same([(a%start_contacts(i)%force(1), i=1, n)], [(b%start_contacts(i)%force(1), i=1, n)], 1.0_wp, 'forces of '//what)
    call same([(a%start_contacts(i)%force(2), i=1, n)], [(b%start_contacts(i)%force(2), i=1, n)], 1.0_wp, 'friction of '//what)
    call same([(a%start_contacts(i)%point(1), i=1, n)], [(b%start_contacts(i)%point(1), i=1, n)], 1.0_wp, 'points of '//what)
    call tests%check(a%start_step == b%start_step .and. abs(a%start_time - b%start_time) <= 1e-7_wp, 'time of '//what)
  end subroutine compare

  !> Check that two lists agree to seven digits, or to a share of that, of their largest member.
  subroutine same(a, b, share, what)
    real(wp), intent(in) :: a(:), b(:), share
    character(len=*), intent(in) :: what

    call tests%equal(size(b), size(a), 'size of '//what)
    if (size(a) /= size(b) .or. size(a) == 0) return
    call tests%near(maxval(abs(a - b)), 0.0_wp, 1e-7_wp*share*max(maxval(abs(a)), tiny(1.0_wp)), what)
  end subroutine same

  !> Names longer than five letters, see tables for any, drives of no given order, bodies that never turn.
  subroutine test_native_names()
    type(scene_t) :: scene, again
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error

    call read_sample(scene, diagnostics)
    scene%colours(1)%s = 'blue grains'
    scene%colours(2)%s = 'blue walls'
    scene%laws(1)%name = 'grain on grain'
    scene%laws(2)%name = 'grain on wall'
    scene%laws(3)%name = 'grai1'
    scene%materials(1)%name = 'granite'
    scene%drives = scene%drives([4, 1, 3, 2])
    scene%sees = [see_t(antagonist_kind=kind_disk, candidate_kind=kind_segment, law=2, alert=0.1_wp), see_t(law=1, alert=0.2_wp)]
    call write_datbox('datbox_written', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call read_datbox('datbox_written', again, diagnostics)
    call tests%equal(diagnostics%count(), 0, 'native names read back')
    if (diagnostics%count() > 0) return
    call tests%check(again%laws(1)%name == 'grain' .and. again%laws(2)%name == 'grai2' .and. &
                     again%laws(3)%name == 'grai1', 'names are cut and unique')
    call tests%check(again%materials(1)%name == 'grani', 'names are cut')
    ! Classes: disks, two colours; segment; hollow disk; polygon: 2 with the wall, then 3 + 2 + 2 + 1 + 1 of the rest.
    call tests%equal(size(again%sees), 11, 'see tables for any are spelt out')
    call tests%equal(count(again%sees%law == 2), 2, 'the first line that fits counts')
    call tests%check(all(again%drives%body == [3, 3, 3, 4]), 'drives are grouped by body')
    call tests%near(again%bodies%position(1, 2), scene%bodies%position(1, 2), 1e-12_wp, 'a place read back')
  end subroutine test_native_names

  !> What the format cannot hold is refused.
  subroutine test_what_cannot_be_written()
    type(scene_t) :: scene, again
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error

    call read_sample(scene, diagnostics)
    scene%contactors%shift(1, 4) = 0.1_wp
    call write_datbox('datbox_refused', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call tests%check(allocated(error), 'a shifted segment is refused')
    call tests%check(.not. file_exists('datbox_refused'), 'and nothing is written')
    call read_sample(scene, diagnostics)
    scene%laws(13)%epsilon = 0.1_wp
    call write_datbox('datbox_refused', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call tests%check(allocated(error), 'the linear law is refused')
    if (allocated(error)) call tests%check(index(error%message, 'epsilon = 0') > 0, 'with the reason: '//error%message)
    call tests%check(.not. file_exists('datbox_refused'), 'and nothing is written')
    scene%laws(13)%epsilon = 0
    call write_datbox('/dev/null/datbox', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call tests%check(allocated(error), 'a folder that cannot be made')
    scene%bodies%position(:, 1) = 0
    scene%contactors%segment_size(3, 1) = 0.25_wp
    call write_datbox('datbox_written', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call read_datbox('datbox_written', again, diagnostics)
    call tests%near(norm2(again%bodies%position(:, 1)), 0.0_wp, 1e-15_wp, 'a body at the very origin comes back there')
    call tests%near(again%bodies%angle(3), 1.570796_wp + 0.25_wp, 1e-13_wp, 'a turned segment turns its body')
  end subroutine test_what_cannot_be_written

  !> Time to read grows with the number of bodies, not with its square.
  subroutine test_many_bodies()
    type(scene_t) :: scene, again
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    real(wp) :: seconds
    integer, parameter :: n = 20000
    integer :: unit, i
    character(len=15) :: id

    call read_sample(scene, diagnostics)
    call write_datbox('datbox_many', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call tests%check(.not. allocated(error), 'the folder of many bodies')
    open (newunit=unit, file='datbox_many/BODIES.DAT', status='replace', action='write')
    do i = 1, n
      write (id, '(a,i7)') ' RBDY2  ', i
      write (unit, '(a)') '$bdyty', id, '$blmty', ' PLAIN      1  behav  PLEXx  avrd= 0.1000000D+00  gyrd= 0.7000000D-01', &
        '$nodty', ' NO3xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.5000000D+00', '$tacty', &
        ' DISKx      1  color  BLEUx  byrd= 0.2000000D+00', '$$$$$$'
    end do
    close (unit)
    call put_lines('datbox_many/Vloc_Rloc.INI', [character(len=6) :: '! none'])
    seconds = cpu_now()
    call read_datbox('datbox_many', again, diagnostics)
    seconds = cpu_now() - seconds
    call tests%equal(again%bodies%n, n, 'many bodies')
    ! Takes some 0.05 s optimised and 0.3 s with all checks; quadratic code would take minutes.
    call tests%check(seconds < 5, 'many bodies are read in seconds')
  end subroutine test_many_bodies
end program test_datbox
