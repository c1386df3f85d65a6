!> Decks: TOML as entries, settings, defaults, the effective deck, scenes from blocks, the reference.
program test_deck
  use harness, only: tests_t
  use sg_contactors, only: kind_disk, kind_polygon, kind_segment
  use sg_effective, only: fingerprint
  use sg_error, only: diagnostics_t, error_t
  use sg_key_table, only: key_table_t
  use sg_keys, only: all_keys
  use sg_kinds, only: wp, pi
  use sg_laws, only: law_linear, law_restitution, law_wet
  use sg_reference_text, only: reference_text
  use sg_run_options, only: criterion_quad, run_options_t
  use sg_scene, only: scene_t
  use sg_system, only: file_exists
  use sg_text, only: text_t
  use sg_toml, only: document_t, parse_toml, read_content, toml_array, toml_integer, toml_logical, toml_real, toml_string, &
                     toml_table
  use sg_words, only: quoted_string, short_real
  use written_files, only: first, put_lines, read_deck_text, shared_folder
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: head = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
                                        'name = "stone"'//nl//'density = 2000'//nl
  type(tests_t) :: t

  call test_entries()
  call test_words()
  call test_minimal()
  call test_former_word()
  call test_effective()
  call test_settings()
  call test_laws()
  call test_linear_laws()
  call test_cluster()
  call test_mass()
  call test_walls_and_drives()
  call test_interactions()
  call test_datbox()
  call test_reference()
  call t%finish()

contains

  subroutine test_entries()
    type(document_t) :: document
    type(error_t), allocatable :: error
    character(len=*), parameter :: text = '# comment'//nl//'[solver]'//nl//'  tolerance = 1e-3'//nl//'"odd key" = true'//nl// &
      '[[body]]'//nl//'shape = [{radius = 2}, {radius = 3}]'//nl//'position = [0, -1.5]'//nl//'[[body]]'//nl//'name = "b"'//nl
    integer :: i

    call parse_toml(text, document, error)
    call t%check(.not. allocated(error), 'a TOML text is read')
    i = document%find('solver')
    call t%check(document%entries(i)%kind == toml_table .and. document%entries(i)%line == 2, 'a table, its line')
    i = document%find('solver.tolerance')
    call t%check(document%entries(i)%kind == toml_real, 'a number')
    call t%near(document%entries(i)%real, 1e-3_wp, 0.0_wp, 'its value')
    call t%equal(document%entries(i)%key_column, 3, 'column of the key')
    call t%equal(document%entries(i)%column, 15, 'column of the value')
    i = document%find('solver."odd key"')
    call t%check(i > 0, 'a key that is no plain word stands in quotes')
    call t%check(document%entries(i)%kind == toml_logical .and. document%entries(i)%integer == 1, 'a logical')
    call t%check(document%entries(document%find('body'))%kind == toml_array, 'an array of tables')
    i = document%find('body[0].shape[1].radius')
    call t%check(document%entries(i)%kind == toml_integer .and. document%entries(i)%integer == 3, 'tables in a list')
    call t%near(document%entries(document%find('body[0].position[1]'))%real, -1.5_wp, 0.0_wp, 'an element')
    i = document%find('body[1].name')
    call t%check(document%entries(i)%kind == toml_string .and. document%entries(i)%text == 'b', 'a string')
    call t%check(document%entries(document%entries(i)%parent)%path == 'body[1]', 'what holds an entry')
    call t%check(document%find('body[0].shape') < document%find('body[0].position'), 'entries in the order of the text')
    call t%equal(document%find('body[2]'), 0, 'what is not there')
    call parse_toml('a = 1'//nl//'b = = 2'//nl, document, error)
    call t%check(allocated(error), 'a syntax error')
    call t%equal(error%line, 2, 'its line')
    call t%check(error%text == 'b = = 2', 'its text')
  end subroutine test_entries

  subroutine test_words()
    real(wp), parameter :: numbers(9) = [0.1_wp, -9.81_wp, 1e-3_wp, 2600.0_wp, 1.0_wp/3, 1e300_wp, 6.02e-23_wp, &
                                         123456.789_wp, 0.0_wp]
    character(len=:), allocatable :: word
    real(wp) :: back
    integer :: i

    do i = 1, size(numbers)
      word = short_real(numbers(i))
      read (word, *) back
      call t%near(back, numbers(i), 0.0_wp, 'a number reads back from '//word)
    end do
    call t%check(short_real(0.1_wp) == '0.1' .and. short_real(-2600.0_wp) == '-2600.0', 'plain decimals: '//short_real(0.1_wp))
    call t%check(short_real(1.5e-7_wp) == '1.5e-7', 'exponents: '//short_real(1.5e-7_wp))
    call t%check(quoted_string('a"b\'//achar(9)) == '"a\"b\\\u0009"', 'strings are escaped')
    ! Known answers of FNV-1a with 64 bits.
    call t%check(fingerprint('') == 'CBF29CE484222325', 'hash of nothing')
    call t%check(fingerprint('a') == 'AF63DC4C8601EC8C', 'hash of a')
    call t%check(fingerprint('foobar') == '85944171F73967E8', 'hash of foobar')
  end subroutine test_words

  subroutine test_minimal()
    type(scene_t) :: scene
    type(run_options_t) :: options, default
    type(diagnostics_t) :: diagnostics

    call read_deck_text(head//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'a small deck is read: '//first(diagnostics))
    call t%equal(scene%bodies%n, 1, 'one body')
    call t%equal(options%steps, 10, 'steps')
    call t%near(options%solver%tolerance, default%solver%tolerance, 0.0_wp, 'tolerance is the default')
    call t%equal(options%solver%criterion, default%solver%criterion, 'so is the criterion')
    call t%check(options%solver%order == default%solver%order .and. options%solver%method == default%solver%method, 'and words')
    call t%equal(options%record_every, default%record_every, 'and numbers of steps')
    call t%near(scene%gravity(2), -9.81_wp, 0.0_wp, 'gravity')
    call t%check(scene%bodies%is_grain(1), 'a free body is a grain')
    call t%equal(len(options%deck_hash), 16, 'hash')
  end subroutine test_minimal

  !> A word of older decks means what it became, with one note; a word that only begins like it is refused.
  subroutine test_former_word()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    character(len=*), parameter :: body = '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl

    call read_deck_text(head//body//'[partition]'//nl//'gluing = "contacts"'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'a former word is read: '//first(diagnostics))
    call t%check(options%partition%gluing == 'momentum', 'it is the present one')
    call t%check(index(options%deck_text, 'gluing = "momentum"') > 0, 'also in the effective deck')
    call t%equal(size(diagnostics%warnings), 1, 'one note')
    call t%check(index(diagnostics%warnings(1)%message, 'former word') > 0, 'about the word')
    call read_deck_text(head//body//'[partition]'//nl//'gluing = "contact"'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 1, 'a part of a former word is a mistake')
  end subroutine test_former_word

  subroutine test_effective()
    type(scene_t) :: scene
    type(run_options_t) :: options, again, changed
    type(diagnostics_t) :: diagnostics
    character(len=*), parameter :: text = head//'[[law]]'//nl//'kind = "IQS_WET_DS_CLB"'//nl//'wet_thickness = 0.001'//nl// &
      '[[wall]]'//nl//'name = "floor ""1"""'//nl//'from = [0, 0]'//nl//'to = [3, 0]'//nl//'thickness = 0.1'//nl// &
      '[[body]]'//nl//'position = [1, 2]'//nl//'[[body.shape]]'//nl//'kind = "disk"'//nl//'radius = 0.1'//nl// &
      '[[body.shape]]'//nl//'kind = "polygon"'//nl//'vertices = [[0, 0], [0.1, 0], [0, 0.3]]'//nl//'angle = 0.1'//nl// &
      '[[sample]]'//nl//'box = [0, 3, 3, 6]'//nl//'count = 5'//nl//'radius = 0.1'//nl// &
      '[[drive]]'//nl//'body = 1'//nl//'component = "x"'//nl//'kind = "force"'//nl//'value = 0.333333333333333314829616256'//nl

    call read_deck_text(text, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 1, 'a quote in a quote is a mistake: '//first(diagnostics))
    call read_deck_text(without_quotes(text), scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'a deck of all sections is read: '//first(diagnostics))
    call read_deck_text(options%deck_text, scene, again, diagnostics)
    call t%equal(diagnostics%count(), 0, 'its effective deck is read: '//first(diagnostics))
    call t%check(again%deck_text == options%deck_text, 'the effective deck of the effective deck is itself')
    call t%check(again%deck_hash == options%deck_hash, 'same hash')
    call t%check(index(options%deck_text, 'radius = 0.1'//nl) > 0, 'one number stays one number')
    call t%check(index(options%deck_text, 'restitution') == 0, 'keys that do not apply are left out')
    call read_deck_text(without_quotes(text)//'phase = 1'//nl, scene, changed, diagnostics)
    call t%check(changed%deck_hash /= options%deck_hash, 'another deck has another hash')
  end subroutine test_effective

  !> The text with the doubled quotes of its name taken out.
  function without_quotes(text) result(plain)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: plain
    integer :: at

    at = index(text, ' ""1"""')
    plain = text(:at - 1)//'"'//text(at + 7:)
  end function without_quotes

  subroutine test_settings()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    type(text_t) :: settings(7)
    character(len=*), parameter :: text = head//'[[law]]'//nl//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl// &
                                          '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl//'position = [5, 0]'//nl
    integer :: i

    settings(1)%s = 'time.theta=1'
    settings(2)%s = 'solver.criterion = quad'
    settings(3)%s = 'law.friction=0.25'
    settings(4)%s = 'body[2].radius=0.75'
    settings(5)%s = 'scene.gravity=[0.5, -1]'
    settings(6)%s = 'solver.warm_start=false'
    settings(7)%s = 'body.material="stone"'
    call read_deck_text(text, scene, options, diagnostics, settings)
    call t%equal(diagnostics%count(), 0, 'settings are taken: '//first(diagnostics))
    call t%near(options%theta, 1.0_wp, 0.0_wp, 'a number')
    call t%equal(options%solver%criterion, criterion_quad, 'a word without quotes')
    call t%near(scene%laws(1)%dynamic_friction, 0.25_wp, 0.0_wp, 'a key of a list of blocks')
    call t%near(scene%contactors%disk_radius(1), 0.5_wp, 0.0_wp, 'the first block is left alone')
    call t%near(scene%contactors%disk_radius(2), 0.75_wp, 0.0_wp, 'the second is set')
    call t%near(scene%gravity(1), 0.5_wp, 0.0_wp, 'a list')
    call t%check(.not. options%solver%warm_start, 'a logical')
    call t%check(index(options%deck_text, 'theta = 1.0') > 0, 'settings are in the effective deck')
    settings(1)%s = 'time.thta=1'
    settings(2)%s = 'solver.criterion=quat'
    settings(3)%s = 'law[2].friction=0.1'
    settings(4)%s = 'nothing'
    settings(5)%s = 'time.step=0'
    settings(6)%s = 'tme.step=1'
    settings(7)%s = 'body.radius=1 2'
    call read_deck_text(text, scene, options, diagnostics, settings)
    call t%equal(diagnostics%count(), 7, 'seven wrong settings, seven mistakes')
    do i = 1, diagnostics%count()
      call t%check(index(diagnostics%errors(i)%sentence(), '--set: ') == 1, 'told as --set: '//diagnostics%errors(i)%sentence())
    end do
    call t%check(first(diagnostics) == '--set: unknown key "thta" in [time]; did you mean "theta"?', first(diagnostics))
  end subroutine test_settings

  subroutine test_laws()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    call read_deck_text(head//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl// &
                        '[[law]]'//nl//'name = "a"'//nl//'kind = "RST_CLB"'//nl//'normal_restitution = 0.5'//nl// &
                        'friction = 0.3'//nl// &
                        '[[law]]'//nl//'name = "b"'//nl//'kind = "IQS_WET_DS_CLB"'//nl//'normal_cohesion = 2'//nl// &
                        'wet_thickness = 0.1'//nl//'static_friction = 0.4'//nl// &
                        '[[law]]'//nl//'name = "c"'//nl//'kind = "LINEAR"'//nl//'epsilon = 1e-3'//nl// &
                        '[[interaction]]'//nl//'law = "c"'//nl//'alert = 0.25'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'laws are read: '//first(diagnostics))
    call t%equal(scene%laws(1)%kind, law_restitution, 'RST_CLB')
    call t%near(scene%laws(1)%normal_restitution, 0.5_wp, 0.0_wp, 'restitution')
    call t%near(scene%laws(1)%static_friction, 0.3_wp, 0.0_wp, 'one friction for both')
    call t%equal(scene%laws(2)%kind, law_wet, 'IQS_WET_DS_CLB')
    call t%near(scene%laws(2)%static_friction, 0.4_wp, 0.0_wp, 'static friction')
    call t%near(scene%laws(2)%dynamic_friction, 0.0_wp, 0.0_wp, 'dynamic friction')
    call t%equal(scene%laws(3)%kind, law_linear, 'LINEAR')
    call t%equal(scene%sees(1)%law, 3, 'an interaction names its law')
    call t%near(scene%sees(1)%alert, 0.25_wp, 0.0_wp, 'and its alert')
  end subroutine test_laws

  !> A linear law has one epsilon, absolute or relative, above zero.
  subroutine test_linear_laws()
    type(scene_t) :: scene

    call read_linear('relative_epsilon = 0.02'//nl//'directions = "normal"'//nl, '', scene)
    call t%near(scene%laws(1)%relative_epsilon, 0.02_wp, 0.0_wp, 'relative epsilon')
    call t%check(scene%laws(1)%is_along_normal, 'along the normal')
    call read_linear('epsilon = 0.5'//nl, '', scene)
    call t%near(scene%laws(1)%epsilon, 0.5_wp, 0.0_wp, 'epsilon')
    call t%check(.not. scene%laws(1)%is_along_normal, 'in all directions')
    call read_linear('', 'needs the key "epsilon" or "relative_epsilon"', scene)
    call read_linear('epsilon = 1'//nl//'relative_epsilon = 1'//nl, 'is given both in 1/kg and as a multiple', scene)
    call read_linear('epsilon = 0'//nl, 'larger than 0 1/kg', scene)
    call read_linear('relative_epsilon = -1'//nl, 'larger than 0', scene)
  end subroutine test_linear_laws

  !> Read a linear law with these keys; its first mistake must hold a fragment, none where that is empty.
  subroutine read_linear(keys, fragment, scene)
    character(len=*), intent(in) :: keys, fragment
    type(scene_t), intent(out) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    call read_deck_text(head//'[[law]]'//nl//'kind = "LINEAR"'//nl//keys//'[[body]]'//nl//'shape = "disk"'//nl// &
                        'radius = 0.5'//nl, scene, options, diagnostics)
    call t%check((diagnostics%count() > 0) .eqv. len(fragment) > 0, 'linear law: '//first(diagnostics))
    if (diagnostics%count() > 0) call t%check(index(first(diagnostics), fragment) > 0, first(diagnostics))
  end subroutine read_linear

  !> Two disks and a bar: centre, mass and inertia by hand.
  subroutine test_cluster()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    real(wp) :: a_disk, a_square, area, centre, moment
    real(wp), parameter :: quarter = pi/2

    call read_deck_text(head//'[[body]]'//nl//'position = [10, 20]'//nl//'angle = 1.5707963267948966'//nl// &
                        '[[body.shape]]'//nl//'kind = "disk"'//nl//'radius = 0.5'//nl// &
                        '[[body.shape]]'//nl//'kind = "polygon"'//nl//'centre = [3, 0]'//nl//'angle = 0.3'//nl// &
                        'vertices = [[-1, -1], [1, -1], [1, 1], [-1, 1]]'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'a cluster is read: '//first(diagnostics))
    a_disk = pi/4
    a_square = 4
    area = a_disk + a_square
    centre = 3*a_square/area
    moment = a_disk*(0.125_wp + centre**2) + a_square*(2.0_wp/3 + (3 - centre)**2)
    ! Rounding of some tens of operations on numbers of size 20.
    call t%near(scene%bodies%area(1), area, 1e-13_wp, 'area')
    call t%near(scene%bodies%mass(1), 2000*area, 1e-10_wp, 'mass')
    call t%near(scene%bodies%inertia(1), 2000*moment, 1e-8_wp, 'inertia by parallel axes')
    call t%near(scene%bodies%position(1, 1), 10.0_wp, 1e-13_wp, 'the centre of mass becomes the position: x')
    call t%near(scene%bodies%position(2, 1), 20 + centre, 1e-13_wp, 'y, turned by a quarter')
    call t%near(scene%bodies%angle(1), quarter, 1e-15_wp, 'angle')
    call t%near(scene%contactors%shift(1, 1), -centre, 1e-13_wp, 'shift of the disk')
    call t%near(scene%contactors%shift(1, 2), 3 - centre, 1e-13_wp, 'shift of the square')
    call t%near(1/scene%bodies%inverse_mass(3, 1), 2000*moment, 1e-8_wp, 'inverse inertia')
  end subroutine test_cluster

  subroutine test_mass()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    call read_deck_text(head//'[[body]]'//nl//'shape = "polygon"'//nl//'vertices = [[5, 1], [7, 1], [6, 4]]'//nl// &
                        '[[body]]'//nl//'shape = "segment"'//nl//'half_length = 2'//nl//'half_thickness = 0.5'//nl// &
                        'mass = 3'//nl// &
                        '[[body]]'//nl//'shape = "hollow disk"'//nl//'radius = 9'//nl// &
                        'fixed = true'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'single shapes are read: '//first(diagnostics))
    call t%near(scene%bodies%mass(1), 6000.0_wp, 1e-10_wp, 'mass of a triangle')
    call t%near(scene%bodies%position(1, 1), 6.0_wp, 1e-14_wp, 'its centre, x')
    call t%near(scene%bodies%position(2, 1), 2.0_wp, 1e-14_wp, 'its centre, y')
    ! Polar moment of a triangle about its centroid: area (a**2 + b**2 + c**2)/36.
    call t%near(scene%bodies%inertia(1), 2000*3*(4.0_wp + 10 + 10)/36, 1e-9_wp, 'its inertia')
    call t%near(scene%bodies%mass(2), 3.0_wp, 0.0_wp, 'a mass that is given')
    call t%near(scene%bodies%inertia(2), 3*stadium(2.0_wp, 0.5_wp), 1e-13_wp, 'inertia follows a mass that is given')
    call t%near(scene%bodies%mass(3), 0.0_wp, 0.0_wp, 'a hollow disk weighs nothing')
    call t%equal(size(scene%drives), 3, 'a fixed body is driven in all components')
    call t%check(.not. scene%bodies%is_grain(3), 'it is no grain')
    call t%check(all(scene%contactors%kind(1:2) == [kind_polygon, kind_segment]), 'kinds')
  end subroutine test_mass

  !> Polar moment over area of a rounded segment.
  pure real(wp) function stadium(a, b)
    real(wp), intent(in) :: a, b

    stadium = (4*a*b*(a**2 + b**2)/3 + pi*b**2*(b**2/2 + a**2 + 8*a*b/(3*pi)))/(4*a*b + pi*b**2)
  end function stadium

  subroutine test_walls_and_drives()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    integer :: i

    call put_lines('ramp.txt', [character(len=13) :: '# time, force', '0 0', '2 10'])
    call read_deck_text(head//'[[wall]]'//nl//'name = "left"'//nl//'from = [0, 0]'//nl//'to = [0, 4]'//nl//'thickness = 0.2'//nl// &
                        '[[wall]]'//nl//'name = "right"'//nl//'from = [3, 0]'//nl//'to = [3, 4]'//nl//'thickness = 0.4'//nl// &
                        'velocity = [-0.1, 0]'//nl// &
                        '[[wall]]'//nl//'name = "lid"'//nl//'from = [0, 4]'//nl//'to = [3, 4]'//nl//'thickness = 0.2'//nl// &
                        'pressure = 1000'//nl//'direction = [0, -2]'//nl//'between = ["left", "right"]'//nl// &
                        '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.1'//nl//'position = [1.5, 2]'//nl// &
                        '[[drive]]'//nl//'body = "left"'//nl//'component = "x"'//nl//'amplitude = 2'//nl//'frequency = 0.5'//nl// &
                        '[[drive]]'//nl//'body = 1'//nl//'component = "y"'//nl//'kind = "force"'//nl//'file = "ramp.txt"'//nl, &
                        scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'walls and drives are read: '//first(diagnostics))
    call t%near(scene%bodies%angle(2), pi/2, 1e-15_wp, 'a wall lies along its axis')
    call t%near(scene%contactors%segment_size(1, 1), 2.0_wp, 0.0_wp, 'half length')
    call t%near(scene%contactors%segment_size(2, 2), 0.2_wp, 0.0_wp, 'half thickness')
    ! Two blocks; two, three and two components that the walls hold.
    call t%equal(size(scene%drives), 2 + 2 + 3 + 2, 'drives')
    call t%equal(size(scene%pressures), 1, 'pressures')
    call t%check(all(scene%bodies%is_grain .eqv. [.true., .false., .false., .false.]), 'walls are no grains')
    do i = 1, size(scene%drives)
      if (scene%drives(i)%body == 2 .and. scene%drives(i)%component == 1) exit
    end do
    call t%near(scene%drives(i)%value%at(1.0_wp), -2.0_wp, 1e-14_wp, 'a cosine of half a Hertz after a second')
    call t%near(scene%drives(2)%value%at(0.5_wp), 2.5_wp, 1e-14_wp, 'a table is interpolated')
    call t%check(.not. scene%drives(2)%is_velocity, 'a force')
    do i = 1, size(scene%drives)
      if (scene%drives(i)%body == 3 .and. scene%drives(i)%component == 1) exit
    end do
    call t%near(scene%drives(i)%value%at(5.0_wp), -0.1_wp, 0.0_wp, 'a wall keeps its velocity')
    call t%check(.not. any(scene%drives%body == 4 .and. scene%drives%component == 2), 'a pressed wall is free along the push')
    associate (p => scene%pressures(1))
      call t%check(p%body == 4 .and. all(p%between == [2, 3]), 'bodies of a pressure')
      call t%near(p%direction(2), -1.0_wp, 0.0_wp, 'direction is a unit vector')
      call t%near(p%thickness, 0.1_wp + 0.2_wp, 1e-15_wp, 'half thicknesses of both walls')
    end associate
  end subroutine test_walls_and_drives

  subroutine test_interactions()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    character(len=*), parameter :: bodies = '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl//'colour = "red"'//nl// &
      '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.1'//nl//'position = [0, 0.595]'//nl//'velocity = [0, -3]'//nl

    call read_deck_text(head//'[[law]]'//nl//bodies, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'an overlap of a twentieth of the smaller radius is no mistake: '//first(diagnostics))
    call t%check(allocated(diagnostics%warnings), 'but a warning')
    call t%equal(size(scene%sees), 1, 'a law alone holds for all pairs')
    call t%equal(scene%sees(1)%candidate_colour + scene%sees(1)%antagonist_kind, 0, 'of all colours and shapes')
    ! A tenth of 0.1 m is more than the way of 10 steps of 1 ms at 3 m/s and 10 m/s2 in one of them.
    call t%near(scene%sees(1)%alert, 0.01_wp, 1e-15_wp, 'default alert: a tenth of the smallest radius')
    call read_deck_text(head//'[[law]]'//nl//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.1'//nl//'velocity = [0, -30]'//nl// &
                        '[scene]'//nl//'gravity = [0, 0]'//nl, scene, options, diagnostics)
    call t%near(scene%sees(1)%alert, 0.03_wp, 1e-15_wp, 'default alert: the way of a fast grain')
    call read_deck_text(head//'[[law]]'//nl//bodies//'[[interaction]]'//nl//'candidate = "red"'//nl// &
                        'antagonist_shape = "polygon"'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'an interaction is read: '//first(diagnostics))
    call t%check(scene%colours(scene%sees(1)%candidate_colour)%s == 'red', 'its colour')
    call t%equal(scene%sees(1)%antagonist_kind, kind_polygon, 'its shape')
    call t%equal(size(diagnostics%warnings), 2, 'pairs that do not see each other may overlap')
    call t%check(index(diagnostics%warnings(1)%message, 'fits no two shapes') > 0, 'that it fits none is said')
    call t%check(index(diagnostics%warnings(2)%message, 'touches nothing') > 0, 'and that the disks touch nothing')
    call t%equal(scene%contactors%kind(1), kind_disk, 'disks')
  end subroutine test_interactions

  !> A deck of six lines that names a DATBOX.
  subroutine test_datbox()
    type(scene_t) :: scene
    type(run_options_t) :: options, again
    type(diagnostics_t) :: diagnostics
    character(len=:), allocatable :: folder, text

    folder = shared_folder()//'/decks/1024DK_BoxJC/DATBOX'
    if (.not. file_exists(folder//'/BODIES.DAT')) then
      write (*, '(a)') 'skipped: no folder '//folder
      return
    end if
    text = '[scene]'//nl//'datbox = "'//folder//'"'//nl//'[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl
    call read_deck_text(text, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'a DATBOX is read: '//first(diagnostics))
    call t%equal(scene%bodies%n, 1028, 'its bodies')
    call t%near(scene%gravity(2), -9.81_wp, 1e-6_wp, 'its gravity')
    call read_deck_text(options%deck_text, scene, again, diagnostics)
    call t%check(again%deck_hash == options%deck_hash, 'its effective deck reads back')
    call read_deck_text(text//'[[drive]]'//nl//'body = 7'//nl//'component = "x"'//nl//'[[pressure]]'//nl//'body = 8'//nl// &
                        'direction = [1, 1]'//nl//'length = 2'//nl//'value = 5'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'drives beside a DATBOX: '//first(diagnostics))
    call t%check(.not. any(scene%bodies%is_grain(7:8)), 'what is driven or pressed is no grain')
    call read_deck_text(text//'[[law]]'//nl//'name = "'//scene%laws(1)%name//'"'//nl//'friction = 0.1'//nl, scene, options, &
                        diagnostics)
    call t%check(index(first(diagnostics), 'next to scene.datbox') > 0, 'no friction of a law beside a DATBOX')
    call read_deck_text(text//'[[material]]'//nl//'name = "stone"'//nl//'density = 1'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'a material of the deck: '//first(diagnostics))
    call t%check(scene%materials(size(scene%materials))%name == 'stone', 'it stands behind those of the folder')
    call t%check(.not. allocated(scene%names), 'without bodies of the deck no body has a name')
  end subroutine test_datbox

  !> The table has whole sentences and sound defaults; the committed reference is the generated one.
  subroutine test_reference()
    type(key_table_t) :: table
    integer :: i
    character(len=:), allocatable :: committed
    type(error_t), allocatable :: error
    character(len=1000) :: source

    table = all_keys()
    do i = 1, size(table%keys)
      associate (sentence => table%keys(i)%sentence)
        call t%check(sentence(len_trim(sentence):) == '.', 'a sentence ends: '//trim(sentence))
      end associate
    end do
    call get_environment_variable('SPLITGRAIN_SOURCE', source)
    call read_content(trim(source)//'/doc/deck_reference.md', committed, error)
    call t%check(.not. allocated(error), 'doc/deck_reference.md can be read')
    if (allocated(error)) return
    call t%check(committed == reference_text(), 'doc/deck_reference.md is not up to date: write it again with splitgrain reference')
  end subroutine test_reference
end program test_deck
