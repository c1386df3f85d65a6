!> Points and links of a DATBOX: every law of LMGC90's rods and wires, links by distance and by a network file, in the plane and
!! in space, and what is refused.
program test_datbox_links
  use harness, only: tests_t
  use sg_contactors, only: kind_point
  use sg_datbox, only: read_datbox
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_laws, only: law_bond, law_linear, law_rigid_wire, law_rod, law_wire
  use sg_scene, only: scene_t
  use sg_system, only: file_exists, make_folder, remove_file
  use sg_text, only: to_text
  use written_files, only: put_lines
  implicit none
  integer, parameter :: width = 90
  character(len=width), parameter :: none(0) = [character(len=width) ::]
  character(len=*), parameter :: folder = 'datbox_links'
  type(tests_t) :: t
  integer :: dimension

  if (.not. make_folder(folder)) error stop 'no folder'
  do dimension = 2, 3
    call test_laws(dimension)
    call test_network(dimension)
    call test_mistakes(dimension)
  end do
  call t%finish()

contains

  !> Three bodies on a line, 1 m apart, each with a point of colour REDxx at its centre; the second one has another at 0.2 m
  !! along y.
  subroutine write_folder(dimension, law, more, network)
    integer, intent(in) :: dimension
    character(len=*), intent(in) :: law !! name and numbers, from column 9 on
    character(len=*), intent(in) :: more !! next line of the law, if any
    character(len=*), intent(in) :: network(:) !! lines of the network file, none for no file
    character(len=width), allocatable :: lines(:)
    character(len=5) :: body, point
    integer :: b

    body = 'RBDY'//to_text(dimension)
    point = 'PT'//to_text(dimension)//'Dx'
    lines = none
    do b = 1, 3
      lines = [character(len=width) :: lines, '$bdyty', ' '//body//'      1', '$blmty', &
               ' PLAIN      1  behav  stone  avrd= 1.0000000D+00  gyrd= 5.0000000D-01', '$nodty', &
               merge(' NO3xx      1                coo1= ', ' NO6xx      1                coo1= ', dimension == 2)// &
               to_text(b)//'.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00']
      if (dimension == 3) lines = [character(len=width) :: lines, &
                                   '                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00']
      lines = [character(len=width) :: lines, '$tacty', &
               ' '//point//'      1  color  REDxx  coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00']
      if (b == 2) lines = [character(len=width) :: lines, &
               ' '//point//'      2  color  BLUEx  coo1= 0.0000000D+00  coo2= 2.0000000D-01  coo3= 0.0000000D+00', &
               merge(' DISKx      3  color  GREEN  byrd= 1.0000000D-01', ' SPHER      3  color  GREEN  byrd= 1.0000000D-01', &
                     dimension == 2)]
      lines = [character(len=width) :: lines, '$$$$$$']
    end do
    call put_lines(folder//'/BODIES.DAT', lines)
    call put_lines(folder//'/BULK_BEHAV.DAT', [character(len=width) :: '$gravy', &
      '                   grv1= 0.0000000D+00  grv2= 0.0000000D+00  grv3= 0.0000000D+00', '$behav  lawty', &
      ' stone  RIGID                           Umas= 1.0000000D+03'])
    lines = [character(len=width) :: '$behav  lawty', ' link1  '//law]
    if (more /= '') lines = [character(len=width) :: lines, more]
    lines = [character(len=width) :: lines, '$seety', ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert', &
             ' '//body//'  '//point//'  REDxx  link1  '//body//'  '//point//'  REDxx       1.5000000D+00']
    call put_lines(folder//'/TACT_BEHAV.DAT', lines)
    associate (file => folder//'/PTPT'//to_text(dimension)//'_NETWORK.DAT')
      if (file_exists(file)) call remove_file(file)
      if (size(network) > 0) call put_lines(file, network)
    end associate
  end subroutine write_folder

  !> Read the folder, without mistakes.
  subroutine read_folder(name, scene)
    character(len=*), intent(in) :: name
    type(scene_t), intent(out) :: scene
    type(diagnostics_t) :: diagnostics

    call read_datbox(folder, scene, diagnostics)
    call t%equal(diagnostics%count(), 0, name//' is read')
    if (diagnostics%count() > 0) print '(a)', diagnostics%errors(1)%sentence()
  end subroutine read_folder

  !> Each law with its numbers; the two pairs of red points 1 m apart are linked, those 2 m apart are not.
  subroutine test_laws(dimension)
    integer, intent(in) :: dimension
    character(len=*), parameter :: two = '  F/st= 5.0000000D+03  prst=-1.0000000D-01'
    character(len=*), parameter :: blank = '                                        '
    type(scene_t) :: scene

    call try(dimension, 'ELASTIC_ROD                   '//two, '', law_rod, scene)
    call t%near(scene%laws(1)%prestrain, -0.1_wp, 1e-15_wp, 'strain without force')
    call try(dimension, 'VOIGT_ROD                     '//two, blank//'F/sr= 7.0000000D+01', law_rod, scene)
    call t%near(scene%laws(1)%axial_damping, 70.0_wp, 1e-13_wp, 'damping of a rod')
    call try(dimension, 'ELASTIC_WIRE                  '//two, '', law_wire, scene)
    call try(dimension, 'VOIGT_WIRE                    '//two, blank//'F/sr= 7.0000000D+01', law_wire, scene)
    call t%near(scene%laws(1)%axial_damping, 70.0_wp, 1e-13_wp, 'damping of a wire')
    call try(dimension, 'BRITTLE_ELASTIC_WIRE          '//two, blank//'snmx= 9.0000000D+02', law_wire, scene)
    call t%near(scene%laws(1)%breaking_force, 900.0_wp, 1e-12_wp, 'breaking force')
    call t%near(scene%laws(1)%axial_stiffness, 5000.0_wp, 1e-11_wp, 'stiffness')
    call try(dimension, 'RIGID_WIRE', '', law_rigid_wire, scene)
    call try(dimension, 'COUPLED_DOF', '', law_linear, scene)
  end subroutine test_laws

  !> Read a law, and the links that it makes by distance.
  subroutine try(dimension, law, more, kind, scene)
    integer, intent(in) :: dimension, kind
    character(len=*), intent(in) :: law, more
    type(scene_t), intent(out) :: scene
    character(len=:), allocatable :: name

    name = trim(law(:min(20, len(law))))//', dimension '//to_text(dimension)
    call write_folder(dimension, law, more, none)
    call read_folder(name, scene)
    call t%equal(scene%laws(1)%kind, kind, name//': kind')
    call t%equal(scene%links%n, 2, name//': links')
    if (scene%links%n /= 2) return
    call t%check(all(scene%links%number(:, :2) == reshape([2, 1, 5, 2], [2, 2])), name//': ends')
    call t%near(maxval(abs(scene%links%length(:2) - 1)), 0.0_wp, 1e-15_wp, name//': lengths')
    call t%equal(scene%contactors%n_rows(kind_point), 4, name//': points')
  end subroutine try

  !> Links that a network file lists, with sections and masses or without.
  subroutine test_network(dimension)
    integer, intent(in) :: dimension
    character(len=*), parameter :: bond = 'NARD_ROD                        E   = 2.0000000D+09  nu  = 2.5000000D-01'
    character(len=*), parameter :: strength = '                                        s1  = 1.0000000D+06  s2  = 3.0000000D+05'
    type(scene_t) :: scene
    character(len=width) :: lines(2)

    lines = [character(len=width) :: '1 1 4 2.0', '1 2 4 1.0']
    if (dimension == 3) lines = [character(len=width) :: '1 4 0 0 0 2.0', '2 4 0 0 0 1.0']
    call write_folder(dimension, 'RIGID_WIRE', '', lines)
    call read_folder('network', scene)
    call t%equal(scene%links%n, 2, 'network: links, one of them longer than the alert distance')
    if (scene%links%n == 2) then
      call t%check(all(scene%links%number(:, :2) == reshape([5, 1, 5, 2], [2, 2])), 'network: ends')
      call t%near(maxval(abs(scene%links%length(:2) - [2.0_wp, 1.0_wp])), 0.0_wp, 1e-15_wp, 'network: lengths')
    end if
    lines = [character(len=width) :: '1 1 2 0.01 0.9 0.3 1.0', '1 2 4 0.02 1.0 0.4']
    if (dimension == 3) lines = [character(len=width) :: '1 2 0 0 0 0.01 0.9 0.3', '2 4 0 0 0 0.02 1.0 0.4']
    call write_folder(dimension, bond, strength, lines)
    call read_folder('bonds', scene)
    call t%equal(scene%links%n, 2, 'bonds: links')
    if (scene%links%n < 2) return
    call t%equal(scene%laws(1)%kind, law_bond, 'bonds: law')
    call t%near(maxval(abs([scene%links%area(:2) - [0.01_wp, 0.02_wp], scene%links%length(:2) - [0.9_wp, 1.0_wp], &
                            scene%links%mass(:2) - [0.3_wp, 0.4_wp]])), 0.0_wp, 1e-15_wp, 'bonds: section, length and mass')
  end subroutine test_network

  !> What cannot be, each with its place.
  subroutine test_mistakes(dimension)
    integer, intent(in) :: dimension
    character(len=width) :: line

    call write_folder(dimension, 'IQS_CLB                         fric= 5.0000000D-01', '', none)
    call refuse('between points only rods', 'a law of contact between points')
    line = merge('1 1 9 2.0    ', '1 9 0 0 0 2.0', dimension == 2)
    call write_folder(dimension, 'RIGID_WIRE', '', [line])
    call refuse('two different points of the 4', 'a point that is not there')
    call write_folder(dimension, 'RIGID_WIRE', '', [character(len=width) :: '1 2'])
    call refuse('a link of a network has', 'a line that is too short')
    line = '1 3 0 0 0 2.0'
    call write_folder(dimension, 'RIGID_WIRE', '', [line])
    if (dimension == 3) call refuse('no see table for points', 'colours that nothing brings together')
    call write_folder(dimension, 'NARD_ROD                        E   = 2.0000000D+09  nu  = 2.5000000D-01', &
                      '                                        s1  = 1.0000000D+06  s2  = 3.0000000D+05', none)
    call refuse('needs the section', 'bonds without a section')
  end subroutine test_mistakes

  !> The folder is refused with words that hold these.
  subroutine refuse(words, name)
    character(len=*), intent(in) :: words, name
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics

    call read_datbox(folder, scene, diagnostics)
    call t%equal(diagnostics%count(), 1, name//': one mistake')
    if (diagnostics%count() == 0) return
    call t%check(index(diagnostics%errors(1)%sentence(), words) > 0, name//': '//diagnostics%errors(1)%sentence())
  end subroutine refuse
end program test_datbox_links
