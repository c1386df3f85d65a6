!> Decks that are right and yet hardly mean what they say: each must give its warning, and its neighbour none.
program test_warnings
  use harness, only: tests_t
  use sg_error, only: diagnostics_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use written_files, only: read_deck_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: head = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
                                        'name = "stone"'//nl//'density = 2000'//nl//'[[law]]'//nl
  ! Bodies that do not touch one another.
  character(len=*), parameter :: square = '[[body]]'//nl//'shape = "polygon"'//nl//'vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]'//nl
  character(len=*), parameter :: drum = '[[body]]'//nl//'shape = "hollow disk"'//nl//'radius = 9'//nl// &
                                        'mass = 1'//nl//'inertia = 1'//nl
  character(len=*), parameter :: floor = '[[wall]]'//nl//'name = "floor"'//nl//'from = [-5, -2]'//nl//'to = [5, -2]'//nl// &
                                         'thickness = 0.1'//nl
  character(len=*), parameter :: lid = '[[wall]]'//nl//'name = "lid"'//nl//'from = [-5, 4]'//nl//'to = [5, 4]'//nl// &
                                       'thickness = 0.1'//nl
  character(len=*), parameter :: segments = '[[interaction]]'//nl//'candidate_shape = "segment"'//nl// &
                                            'antagonist_shape = "segment"'//nl
  character(len=*), parameter :: pressure = '[[pressure]]'//nl//'body = "lid"'//nl//'direction = [0, -1]'//nl//'length = 1'//nl// &
                                            'value = 5'//nl
  character(len=*), parameter :: drive = '[[drive]]'//nl//'body = "lid"'//nl//'component = '
  type(tests_t) :: t

  call test_blind_pairs()
  call test_pressures()
  call test_alert()
  call test_space()
  call t%finish()

contains

  !> Shapes that cannot touch: all pairs mean grains, a block that names the shapes means all that is not fixed.
  subroutine test_blind_pairs()
    character(len=*), parameter :: fixed = 'fixed = true'//nl
    character(len=*), parameter :: said = 'hollow disk and polygon cannot touch'
    character(len=*), parameter :: of_shape = '[[interaction]]'//nl//'candidate_shape = '

    call expect('a polygon in a drum', head//square//drum//fixed, said, 7)
    call expect('a fixed polygon in a fixed drum', head//square//fixed//drum//fixed, '', 0)
    call expect('a polygon on a floor', head//square//floor//lid, '', 0)
    call expect('a free drum alone', head//drum, '', 0)
    call expect('two free drums', head//drum//drum//'position = [30, 0]'//nl, 'hollow disk and hollow disk cannot', 7)
    call expect('walls that a block names', head//floor//lid//segments, '', 0)
    call expect('a pressed wall that a block names', head//floor//lid//segments//pressure, 'segment and segment cannot touch', 18)
    call expect('a pressed wall that no block names', head//floor//lid//pressure, '', 0)
    call expect('a block of other shapes', head//square//drum//fixed//of_shape//'"disk"'//nl, 'fits no two shapes', 17)
    call expect('a block of one of the shapes', head//square//drum//fixed//of_shape//'"polygon"'//nl, said, 17)
  end subroutine test_blind_pairs

  !> A pressure along a component whose velocity is imposed, whichever block comes first.
  subroutine test_pressures()
    character(len=*), parameter :: said = 'along y is imposed: the pressure has no effect'

    call expect('a pressure', head//floor//lid//pressure, '', 0)
    call expect('a pressure after a drive', head//floor//lid//drive//'"y"'//nl//pressure, said, 23)
    call expect('a pressure before a drive', head//floor//lid//pressure//drive//'"y"'//nl, said, 20)
    call expect('a pressure beside a drive', head//floor//lid//pressure//drive//'"x"'//nl, '', 0)
    call expect('a pressure and a force', head//floor//lid//pressure//drive//'"y"'//nl//'kind = "force"'//nl, '', 0)
    call expect('a pressed wall with a drive', head//floor//lid//'pressure = 5'//nl//'direction = [0, -1]'//nl//drive//'"y"'//nl, &
                said, 19)
  end subroutine test_pressures

  !> Alert distances against the way of the fastest body in a step: 1e-2 m.
  subroutine test_alert()
    character(len=*), parameter :: fast = square//'velocity = [6, 8]'//nl//'[[interaction]]'//nl//'alert = '
    character(len=*), parameter :: said = 'the fastest body moves by'

    call expect('a short alert distance', head//fast//'5e-3'//nl, said, 13)
    call expect('a long one', head//fast//'2e-2'//nl, '', 0)
    call expect('a fast drive', head//floor//lid//square//'[[interaction]]'//nl//'alert = 5e-3'//nl//drive//'"x"'//nl// &
                'value = 10.0'//nl, said, 22)
  end subroutine test_alert

  !> Pairs in space that cannot touch, and a pressure along z.
  subroutine test_space()
    character(len=*), parameter :: space = '[scene]'//nl//'dimension = 3'//nl//head
    character(len=*), parameter :: box = '[[body]]'//nl//'shape = "box"'//nl//'half_axes = [1, 1, 1]'//nl
    character(len=*), parameter :: capsule = '[[body]]'//nl//'shape = "cylinder"'//nl//'half_height = 1'//nl//'radius = 1'//nl
    character(len=*), parameter :: ground = '[[wall]]'//nl//'name = "lid"'//nl//'centre = [0, 0, -9]'//nl//'size = [9, 9]'//nl// &
                                            'thickness = 1'//nl

    call expect('a box and a capsule', space//box//capsule, 'cylinder and polyhedron cannot touch', 9)
    call expect('a box on the ground', space//box//ground, '', 0)
    call expect('a pressure along z', space//box//ground//'[[drive]]'//nl//'body = "lid"'//nl//'component = "z"'//nl// &
                '[[pressure]]'//nl//'body = "lid"'//nl//'direction = [0, 0, -1]'//nl//'area = 1'//nl//'value = 5'//nl, &
                'along z is imposed', 23)
  end subroutine test_space

  !> Read a deck: it is right, and its one warning holds `fragment`, at `line`; no warning where `fragment` is empty.
  subroutine expect(name, text, fragment, line)
    character(len=*), intent(in) :: name, text, fragment
    integer, intent(in) :: line
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    call read_deck_text(text, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, name//' is right')
    if (fragment == '') then
      call t%check(.not. allocated(diagnostics%warnings), name//': no warning')
    else
      call t%check(allocated(diagnostics%warnings), name//': a warning')
    end if
    if (.not. allocated(diagnostics%warnings)) return
    call t%equal(size(diagnostics%warnings), 1, name//': one warning')
    call t%check(index(diagnostics%warnings(1)%message, fragment) > 0, name//': '//diagnostics%warnings(1)%message)
    call t%equal(diagnostics%warnings(1)%line, line, name//': line')
  end subroutine expect
end program test_warnings
