!> Bad decks: each must give a mistake with the right words at the right line, and never more than an error.
program test_bad_decks
  use harness, only: tests_t
  use sg_convex_hull, only: hull_is_available
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i1
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_system, only: remove_file
  use sg_text, only: text_t, to_text
  use written_files, only: put_lines, read_deck_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  !> Seven lines that are right
  character(len=*), parameter :: head = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
                                        'name = "stone"'//nl//'density = 2000'//nl//'[[law]]'//nl
  !> Three more: a disk
  character(len=*), parameter :: disk = '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl
  !> The same nine lines in space, and three more: a sphere
  character(len=*), parameter :: space = '[scene]'//nl//'dimension = 3'//nl//head
  character(len=*), parameter :: ball = '[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.5'//nl
  type(tests_t) :: t

  call bad_texts()
  call bad_long_texts()
  call bad_values()
  call bad_keys()
  call bad_laws()
  call bad_bodies()
  call bad_polygons()
  call bad_walls()
  call bad_samples()
  call bad_drives()
  call bad_files()
  call bad_dimensions()
  call bad_shapes_in_space()
  call bad_polyhedra()
  call bad_meshes()
  call bad_generators()
  call all_at_once()
  call t%finish()

contains

  !> Read a text as a deck: its mistakes must hold `fragment`, at `line` (0 for a mistake without a place).
  subroutine bad(name, text, fragment, line)
    character(len=*), intent(in) :: name, text, fragment
    integer, intent(in) :: line
    type(diagnostics_t) :: diagnostics
    integer :: i

    call read_text(text, diagnostics)
    call t%check(diagnostics%count() > 0, name//': no mistake is told')
    do i = 1, diagnostics%count()
      if (index(diagnostics%errors(i)%message, fragment) == 0) cycle
      call t%equal(diagnostics%errors(i)%line, line, name//': line of "'//diagnostics%errors(i)%message//'"')
      call t%check((diagnostics%errors(i)%column > 0) .eqv. line > 0, name//': column')
      call t%check(len(diagnostics%errors(i)%report()) > 0, name//': report')
      return
    end do
    if (diagnostics%count() > 0) call t%check(.false., name//': not told "'//fragment//'" but "'// &
                                              diagnostics%errors(1)%sentence()//'"')
  end subroutine bad

  !> Read a deck from a text.
  subroutine read_text(text, diagnostics)
    character(len=*), intent(in) :: text
    type(diagnostics_t), intent(out) :: diagnostics
    type(scene_t) :: scene
    type(run_options_t) :: options

    call read_deck_text(text, scene, options, diagnostics)
  end subroutine read_text

  !> Decks that are read piece by piece: mistakes stand on their lines, whatever the piece; texts that cannot be cut are read whole.
  subroutine bad_long_texts()
    integer, parameter :: n = 9000
    character(len=*), parameter :: last = '[[body]]'//nl//'radius = 0.5'//nl
    character(len=*), parameter :: list = 'vertices = ['//nl//'[0, 0], [1, 0], # [[body]]'//nl//'[0, 1]'//nl//']'//nl
    character(len=:), allocatable :: long
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    integer :: i, at

    allocate (character(len=n*80) :: long)
    at = 0
    do i = 1, n
      associate (one => '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.4'//nl//'position = ['//to_text(i)//', 2]'//nl)
        long(at + 1:at + len(one)) = one
        at = at + len(one)
      end associate
    end do
    long = long(:at)
    call read_deck_text(head//long//'[[body]]'//nl//'shape = "polygon"'//nl//list, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'a long deck')
    call t%equal(scene%bodies%n, n + 1, 'bodies of a long deck')
    call t%near(scene%bodies%position(1, n), real(n, wp), 0.0_wp, 'a body of the last piece')
    call bad('shape at the end of a long deck', head//long//last, 'without the key "shape"', 4*n + 9)
    call bad('a key in the midst', head//long//'[[body]]'//nl//'shap = "disk"'//nl//long, 'unknown key', 4*n + 9)
    call bad('two sections', head//long//last//'[time]'//nl//'step = 1'//nl, 'redefine', 4*n + 10)
    call bad('a syntax error', head//long//'= 3'//nl, 'syntax', 4*n + 8)
    call bad('a long string', head//long//'[[body]]'//nl//'name = """'//nl//long//'"""'//nl, 'no shape', 4*n + 8)
  end subroutine bad_long_texts

  subroutine bad_texts()
    character(len=256) :: garbage
    integer :: i

    call bad('keys nested in keys', head//'a'//repeat('.a', 40000)//' = 1'//nl, 'nest deeper', 8)
    call bad('a heading of many keys', head//'["é"'//repeat('.b', 65)//']'//nl, 'nest deeper', 8)
    call bad('lists in lists', head//'a = '//repeat('[', 100000), 'nest deeper', 8)
    call bad('many dots that nest nothing', head//'# '//repeat('.', 99)//nl//'a = "'//repeat('.', 99)//'"'//nl, 'unknown key', 9)

    do i = 1, 256
      garbage(i:i) = achar(modulo(37*i + 200, 256))
    end do
    call bad('empty', '', 'empty', 0)
    call bad('only comments', '# nothing'//nl//'# more'//nl, 'empty', 0)
    call bad('garbage', garbage, 'syntax', 1)
    call bad('zeros', repeat(achar(0), 100), 'syntax', 1)
    call bad('half a string', head//'name = "ab'//nl, 'syntax', 8)
    call bad('half a list', '[scene]'//nl//'gravity = [0, ', 'syntax', 2)
    call bad('two equals', '[time]'//nl//'step = = 1'//nl, 'syntax', 2)
    call bad('a key twice', '[time]'//nl//'step = 1'//nl//'step = 2'//nl, 'syntax', 3)
    call bad('a section twice', '[time]'//nl//'step = 1'//nl//'[time]'//nl//'steps = 2'//nl, 'syntax', 3)
    call bad('deep lists', 'a = '//repeat('[', 1000), 'syntax', 1)
    call bad('not UTF-8', '[scene]'//nl//'datbox = "'//transfer(-1_i1, 'a')//'"'//nl, 'syntax', 2)
    call bad('a number too large for TOML', '[time]'//nl//'steps = 99999999999999999999'//nl, 'syntax', 2)
    call bad('a long line', '[time]'//nl//'step = "'//repeat('x', 100000)//'"'//nl, 'must be a number', 2)
  end subroutine bad_texts

  subroutine bad_values()
    call bad('zero step', '[time]'//nl//'step = 0.0'//nl//'steps = 1'//nl, 'larger than 0 s', 2)
    call bad('negative step', '[time]'//nl//'step = -1'//nl, 'larger than 0 s', 2)
    call bad('step is not a number', '[time]'//nl//'step = nan'//nl, 'finite', 2)
    call bad('infinite step', '[time]'//nl//'  step = inf'//nl, 'finite', 2)
    call bad('step beyond reason', '[time]'//nl//'step = 1e300'//nl, 'in size', 2)
    call bad('step a string', '[time]'//nl//'step = "1e-3"'//nl, 'must be a number, not a string', 2)
    call bad('steps a number', '[time]'//nl//'steps = 10.0'//nl, 'must be an integer, not a number', 2)
    call bad('steps a date', '[time]'//nl//'steps = 1979-05-27'//nl, 'not a date', 2)
    call bad('steps too many', '[time]'//nl//'steps = 5000000000'//nl, 'between -2000000000', 2)
    call bad('steps a table', '[time]'//nl//'steps = {a = 1}'//nl, 'not a table', 2)
    call bad('theta too large', '[time]'//nl//'theta = 1.5'//nl, 'at most 1', 2)
    call bad('a flag as a number', '[solver]'//nl//'warm_start = 1'//nl, 'true or false', 2)
    call bad('unknown criterion', '[solver]'//nl//'criterion = "quat"'//nl, 'did you mean "quad"?', 2)
    call bad('unknown method', '[solver]'//nl//'method = "magic"'//nl, 'must be one of nlgs', 2)
    call bad('no sweeps', '[solver]'//nl//'maximum_sweeps = 0'//nl, 'at least 1', 2)
    call bad('gravity of one number', '[scene]'//nl//'gravity = [1]'//nl, 'a list of 2 numbers', 2)
    call bad('gravity of three numbers', '[scene]'//nl//'gravity = [1, 2, 3]'//nl, 'a list of 2 numbers', 2)
    call bad('gravity of lists', '[scene]'//nl//'gravity = [[1, 2], [3]]'//nl, 'not a list in it', 2)
    call bad('gravity with a word', '[scene]'//nl//'gravity = [1, "b"]'//nl, 'not a string in it', 2)
    call bad('four dimensions', '[scene]'//nl//'dimension = 4'//nl, 'at most 3', 2)
    call bad('one dimension', '[scene]'//nl//'dimension = 1'//nl, 'at least 2', 2)
    call bad('negative period', '[scene]'//nl//'period_x = -1.0'//nl, 'at least 0', 2)
  end subroutine bad_values

  subroutine bad_keys()
    call bad('misspelt key', head//'frction = 0.5'//nl, 'unknown key "frction" in [[law]]; did you mean "friction"?', 8)
    call bad('unknown key', '[time]'//nl//'zzz = 0.5'//nl, 'unknown key "zzz" in [time]', 2)
    call bad('odd key', '[time]'//nl//'"a.b" = 0.5'//nl, 'unknown key', 2)
    call bad('misspelt section', head//'[solvr]'//nl//'x = 1'//nl, 'did you mean "solver"?', 8)
    call bad('table in a section', '[time.more]'//nl//'x = 1'//nl, 'unknown key "more" in [time]', 1)
    call bad('single brackets', '[law]'//nl//'friction = 1'//nl, 'double brackets', 1)
    call bad('double brackets', '[[time]]'//nl//'step = 1'//nl, 'single brackets', 1)
    call bad('blocks as numbers', 'law = [1, 2]'//nl, 'must hold keys', 1)
    call bad('key without a section', 'friction = 1'//nl, 'outside of any section', 1)
    call bad('no time', '[scene]'//nl//'dimension = 2'//nl, '[time] lacks the key "step"', 0)
    call bad('no steps', head//'[time.x]'//nl, 'unknown key "x"', 8)
    call bad('no number of steps', '[time]'//nl//'step = 1'//nl, 'lacks the key "steps"', 1)
  end subroutine bad_keys

  subroutine bad_laws()
    call bad('unknown law', head//'kind = "IQS_CBL"'//nl, 'did you mean "IQS_CLB"?', 8)
    call bad('negative friction', head//'friction = -0.1'//nl, 'at least 0', 8)
    call bad('absurd friction', head//'friction = 1e50'//nl, 'at most 1000000, since rounding of the slip', 8)
    call bad('restitution above one', head//'kind = "RST_CLB"'//nl//'normal_restitution = 1.5'//nl, 'at most 1', 9)
    call bad('restitution of another law', head//'normal_restitution = 0.5'//nl, 'has no meaning for kind = "IQS_CLB"', 8)
    call bad('no stiffness', head//'kind = "ELASTIC_REPELL_CLB"'//nl, 'lacks the key "stiffness"', 7)
    call bad('shear alone', head//'kind = "IQS_MOHR_DS_CLB"'//nl//'tangential_cohesion = 5'//nl, 'needs a normal_cohesion', 9)
    call bad('shear stress alone', head//'kind = "IQS_MOHR_DS_CLB"'//nl//'tangential_bond_stress = 5'//nl, &
             'needs a normal_bond_stress', 9)
    call bad('shear of a wet contact', head//'kind = "IQS_WET_DS_CLB"'//nl//'tangential_cohesion = 5'//nl, &
             'has no meaning for kind = "IQS_WET_DS_CLB"', 9)
    call bad('laws of one name', head//disk//'[[law]]'//nl//'name = "contact"'//nl, 'two laws named "contact"', 12)
    call bad('several laws', head//disk//'[[law]]'//nl//'name = "b"'//nl, 'there are several laws', 7)
    call bad('unknown law name', head//disk//'[[interaction]]'//nl//'law = "contakt"'//nl, 'did you mean "contact"?', 12)
    call bad('unknown colour', head//disk//'[[interaction]]'//nl//'candidate = "grian"'//nl, 'did you mean "grain"?', 12)
    call bad('no density', '[[material]]'//nl//'name = "a"'//nl, 'lacks the key "density"', 1)
    call bad('negative density', '[[material]]'//nl//'density = -1'//nl, 'larger than 0 kg/m3', 2)
    call bad('materials of one name', head//'[[material]]'//nl//'name = "stone"'//nl//'density = 1'//nl//disk, &
             'two materials named "stone"', 9)
  end subroutine bad_laws

  subroutine bad_bodies()
    call bad('no body', head, 'there is no body', 0)
    call bad('no shape', head//'[[body]]'//nl//'name = "a"'//nl, 'no shape', 8)
    call bad('zero radius', head//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0'//nl, 'larger than 0 m', 10)
    call bad('no radius', head//'[[body]]'//nl//'shape = "disk"'//nl, 'lacks the key "radius"', 8)
    call bad('radius without a shape', head//'[[body]]'//nl//'radius = 1'//nl, 'without the key "shape"', 9)
    call bad('unknown shape', head//'[[body]]'//nl//'shape = "disc"'//nl//'radius = 1'//nl, 'did you mean "disk"?', 9)
    call bad('a table for a shape', head//'[[body]]'//nl//'shape = {a = 1}'//nl//'radius = 1'//nl, 'shape', 9)
    call bad('length of a disk', head//disk//'half_length = 1'//nl, 'has no meaning for shape = "disk"', 11)
    call bad('negative mass', head//disk//'mass = -1'//nl, 'larger than 0 kg', 11)
    call bad('unknown material', head//disk//'material = "stnoe"'//nl, 'did you mean "stone"?', 11)
    call bad('which material', head//disk//'[[material]]'//nl//'name = "b"'//nl//'density = 1'//nl, 'several materials', 8)
    call bad('names twice', head//disk//'name = "a"'//nl//disk//'name = "a"'//nl, 'two bodies named "a"', 15)
    call bad('a weightless body', head//'[[body]]'//nl//'shape = "hollow disk"'//nl//'radius = 1'//nl, 'weighs nothing', 8)
    call bad('an empty name', head//disk//'name = ""'//nl, 'must not be empty', 11)
    call bad('disks that overlap', head//disk//disk//'position = [0.9, 0]'//nl, 'body 1 and body 2 overlap', 11)
    call bad('a disk in a floor', head//disk//'position = [0, 0.3]'//nl//'[[wall]]'//nl//'name = "floor"'//nl// &
             'from = [-1, 0]'//nl//'to = [1, 0]'//nl//'thickness = 0.1'//nl, '"floor" overlap', 12)
    call bad('outside of the period', head//disk//'position = [-1, 0]'//nl//'[scene]'//nl//'period_x = 3'//nl, &
             'outside of the period', 8)
    call bad('overlap over a period', head//disk//disk//'position = [2.5, 0]'//nl//'[scene]'//nl//'period_x = 3'//nl, 'overlap', 11)
    call bad('through a hollow disk', head//disk//'position = [1.8, 0]'//nl//'[[body]]'//nl//'shape = "hollow disk"'//nl// &
             'radius = 2'//nl//'fixed = true'//nl, 'overlap', 12)
    call bad('a disk far outside of a hollow one', head//disk//'position = [7, 3]'//nl//'[[body]]'//nl//'shape = "hollow disk"'// &
             nl//'radius = 2'//nl//'fixed = true'//nl, 'body 1 and body 2 overlap at the start by 6.12', 12)
  end subroutine bad_bodies

  subroutine bad_polygons()
    character(len=*), parameter :: polygon = head//'[[body]]'//nl//'shape = "polygon"'//nl//'vertices = '

    call bad('clockwise', polygon//'[[0, 0], [0, 1], [1, 1], [1, 0]]'//nl, 'clockwise', 10)
    call bad('not convex', polygon//'[[0, 0], [2, 0], [0.5, 0.5], [0, 2]]'//nl, 'not convex at vertex 3', 10)
    call bad('a star', polygon//'[[0, 3], [-2, -3], [3, 1], [-3, 1], [2, -3]]'//nl, 'not convex', 10)
    call bad('two vertices', polygon//'[[0, 0], [1, 0]]'//nl, 'three vertices', 10)
    call bad('no vertices', polygon//'[]'//nl, 'a list of [x, y]', 10)
    call bad('three numbers a vertex', polygon//'[[0, 0, 0], [1, 0, 0], [1, 1, 0]]'//nl, 'a list of [x, y]', 10)
    call bad('flat list', polygon//'[0, 0, 1, 0, 1, 1]'//nl, 'not an integer in it', 10)
    call bad('a vertex twice', polygon//'[[0, 0], [1, 0], [1, 0], [0, 1]]'//nl, 'vertices 2 and 3 are the same', 10)
    call bad('no area', polygon//'[[0, 0], [1, 0], [2, 0]]'//nl, 'polygon', 10)
    call bad('a vertex not a number', polygon//'[[0, 0], [1, nan], [0, 1]]'//nl, 'finite', 10)
    call bad('polygons at one place', polygon//'[[0, 0], [1, 0], [1, 1], [0, 1]]'//nl//'[[body]]'//nl//'shape = "polygon"'//nl// &
             'vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]'//nl, 'overlap', 11)
    call bad('polygons that overlap', polygon//'[[0, 0], [1, 0], [1, 1], [0, 1]]'//nl//'[[body]]'//nl//'shape = "polygon"'//nl// &
             'vertices = [[0.8, 0.2], [2, 0.2], [2, 0.9]]'//nl, 'overlap', 11)
  end subroutine bad_polygons

  subroutine bad_walls()
    character(len=*), parameter :: wall = head//disk//'[[wall]]'//nl//'from = [9, 0]'//nl//'thickness = 0.1'//nl

    call bad('no end', wall, 'lacks the key "to"', 11)
    call bad('no length', wall//'to = [9, 0]'//nl, 'the wall has no length', 14)
    call bad('zero thickness', head//'[[wall]]'//nl//'thickness = 0'//nl, 'larger than 0 m', 9)
    call bad('no direction', wall//'to = [9, 5]'//nl//'pressure = 3'//nl, 'needs the key "direction"', 15)
    call bad('oblique', wall//'to = [9, 5]'//nl//'pressure = 3'//nl//'direction = [1, 1]'//nl, 'along x or along y', 16)
    call bad('between unknown walls', wall//'to = [9, 5]'//nl//'pressure = 3'//nl//'direction = [1, 0]'//nl// &
             'between = ["a", 1]'//nl, 'no body named "a"', 17)
    call bad('between one wall', wall//'to = [9, 5]'//nl//'pressure = 3'//nl//'direction = [1, 0]'//nl// &
             'between = [2, 2]'//nl, 'two different bodies', 17)
    call bad('between three walls', wall//'between = [2, 2, 2]'//nl, 'a list of 2 bodies', 14)
  end subroutine bad_walls

  subroutine bad_samples()
    character(len=*), parameter :: sample = head//'[[sample]]'//nl//'radius = 0.1'//nl

    call bad('no box', sample//'count = 5'//nl, 'lacks the key "box"', 8)
    call bad('inverted box', sample//'box = [1, 0, 0, 1]'//nl//'count = 5'//nl, 'the box is empty', 10)
    call bad('box of three', sample//'box = [1, 0, 0]'//nl//'count = 5'//nl, 'a list of 4 numbers', 10)
    call bad('too full', sample//'box = [0, 0, 1, 1]'//nl//'count = 100'//nl, 'too full', 10)
    call bad('too small', sample//'box = [0, 0, 0.1, 0.1]'//nl//'count = 1'//nl, 'too full', 10)
    call bad('too full a lattice', sample//'box = [0, 0, 1, 1]'//nl//'kind = "lattice"'//nl//'count = 17'//nl, 'holds 16 of 17', 12)
    call bad('neither count nor fill', sample//'box = [0, 0, 1, 1]'//nl, 'either "count" or "fill"', 8)
    call bad('count and fill', sample//'box = [0, 0, 1, 1]'//nl//'count = 1'//nl//'fill = 0.1'//nl, 'either "count" or "fill"', 8)
    call bad('too many', sample//'box = [0, 0, 1e9, 1e9]'//nl//'fill = 0.5'//nl, 'more than', 11)
    call bad('count beyond reason', sample//'box = [0, 0, 1, 1]'//nl//'count = 1000000000'//nl, 'at most', 11)
    call bad('zero count', sample//'box = [0, 0, 1, 1]'//nl//'count = 0'//nl, 'at least 1', 11)
    call bad('radii in the wrong order', head//'[[sample]]'//nl//'radius = [0.2, 0.1]'//nl//'box = [0, 0, 1, 1]'//nl// &
             'count = 1'//nl, 'smaller number first', 9)
    call bad('two sides', sample//'box = [0, 0, 1, 1]'//nl//'count = 1'//nl//'shape = "polygon"'//nl//'sides = 2'//nl, &
             'at least 3', 13)
    call bad('sided disks', sample//'box = [0, 0, 1, 1]'//nl//'count = 1'//nl//'sides = 5'//nl, 'no meaning for shape = "disk"', 12)
    call bad('sample over a body', head//disk//'[[sample]]'//nl//'radius = 0.1'//nl//'box = [0, 0, 0.25, 0.25]'//nl// &
             'count = 1'//nl, 'body 1 and body 2 overlap', 11)
  end subroutine bad_samples

  subroutine bad_drives()
    character(len=*), parameter :: drive = head//disk//'name = "ball"'//nl//'[[drive]]'//nl//'component = "x"'//nl

    call bad('no body', drive, 'lacks the key "body"', 12)
    call bad('unknown name', drive//'body = "bal"'//nl, 'did you mean "ball"?', 14)
    call bad('unknown number', drive//'body = 7'//nl, 'there is no body 7: the scene has 1', 14)
    call bad('body zero', drive//'body = 0'//nl, 'there is no body 0', 14)
    call bad('body of a huge number', drive//'body = 99999999999'//nl, 'there is no body 99999999999', 14)
    call bad('unknown component', drive//'body = 1'//nl//'component2 = "z"'//nl, 'unknown key', 15)
    call bad('both frequencies', drive//'body = 1'//nl//'omega = 1'//nl//'frequency = 1'//nl, 'either "frequency"', 15)
    call bad('driven twice', drive//'body = 1'//nl//'[[drive]]'//nl//'component = "x"'//nl//'body = 1'//nl, 'driven twice', 16)
    call bad('missing file', drive//'body = 1'//nl//'file = "no.txt"'//nl, 'cannot read the file "no.txt"', 15)
    call put_lines('words.txt', [character(len=7) :: '0 1', 'one two'])
    call bad('words for numbers', drive//'body = 1'//nl//'file = "words.txt"'//nl, 'a time and a value', 2)
    ! Numbers without a point are numbers: the table is read, and what is wrong stands on the line after it.
    call put_lines('plain.txt', [character(len=7) :: '0 -1e3', '1 2E+3', 'one two'])
    call bad('words after numbers', drive//'body = 1'//nl//'file = "plain.txt"'//nl, 'a time and a value', 3)
    call put_lines('back.txt', ['0 1', '1 2', '1 3'])
    call bad('time stands still', drive//'body = 1'//nl//'file = "back.txt"'//nl, 'times must grow', 3)
    call bad('no direction', head//disk//'[[pressure]]'//nl//'body = 1'//nl//'length = 1'//nl//'direction = [0, 0]'//nl, &
             'has no length', 14)
    call bad('no length', head//disk//'[[pressure]]'//nl//'body = 1'//nl//'direction = [0, 1]'//nl, 'either "length"', 11)
    call bad('between disks', head//disk//disk//'position = [5, 0]'//nl//'[[pressure]]'//nl//'body = 1'//nl// &
             'direction = [0, 1]'//nl//'between = [1, 2]'//nl, 'needs walls', 18)
  end subroutine bad_drives

  subroutine bad_files()
    type(diagnostics_t) :: diagnostics
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(text_t) :: none(0)
    integer :: unit

    call read_deck('no_such_deck.toml', none, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 1, 'a missing deck')
    call read_deck('.', none, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 2, 'a folder for a deck')
    call bad('missing DATBOX', '[scene]'//nl//'datbox = "no_such_folder"'//nl//'[time]'//nl//'step = 1'//nl//'steps = 1'//nl, &
             'no folder "no_such_folder"', 2)
    open (newunit=unit, file='huge.toml', access='stream', form='unformatted', status='replace')
    write (unit, pos=70*1024**2) '#'
    close (unit)
    call read_deck('huge.toml', none, scene, options, diagnostics)
    call t%check(index(diagnostics%errors(3)%message, 'larger than 64 MiB') > 0, 'a huge deck')
    call remove_file('huge.toml')
  end subroutine bad_files

  !> What belongs to the other dimension.
  subroutine bad_dimensions()
    call bad('a disk in space', space//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 1'//nl, 'did you mean "sphere"?', 11)
    call bad('a sphere in the plane', head//'[[body]]'//nl//'shape = "sphere"'//nl//'radius = 1'//nl, 'did you mean "disk"?', 9)
    call bad('a misspelt shape', space//'[[body]]'//nl//'shape = "spere"'//nl//'radius = 1'//nl, 'did you mean "sphere"?', 11)
    call bad('a polygon in space', space//'[[body]]'//nl//'shape = "polygon"'//nl, 'did you mean "polyhedron"?', 11)
    call bad('an angle in space', space//ball//'angle = 1.0'//nl, 'did you mean "rotation"?', 13)
    call bad('a rotation in the plane', head//disk//'rotation = [0, 0, 1]'//nl, 'did you mean "angle"?', 11)
    call bad('a wall of the plane', space//'[[wall]]'//nl//'from = [0, 0]'//nl, 'has no meaning where scene.dimension = 3', 11)
    call bad('half a wall', space//'[[wall]]'//nl//'thickness = 1'//nl, 'lacks the key "centre"', 10)
    call bad('a position of two', space//ball//'position = [0, 1]'//nl, 'must be a list of 3 numbers', 13)
    call bad('a position of three', head//disk//'position = [0, 1, 2]'//nl, 'must be a list of 2 numbers', 11)
    call bad('a position of four', space//ball//'position = [0, 1, 2, 3]'//nl, 'must be a list of 3 numbers', 13)
    call bad('a spin of one', space//ball//'spin = 1.0'//nl, 'must be a list of 3 numbers', 13)
    call bad('a spin of three', head//disk//'spin = [1, 2, 3]'//nl, 'must be a number', 11)
    call bad('moments of one', space//ball//'inertia = 1.0'//nl, 'must be a list of 3 numbers', 13)
    call bad('gravity of the plane', '[scene]'//nl//'dimension = 3'//nl//'gravity = [0, -9.81]'//nl, 'a list of 3 numbers', 3)
    call bad('a period across the plane', '[scene]'//nl//'period_y = 1.0'//nl, 'has no meaning where scene.dimension = 2', 2)
    call bad('a container in the plane', head//'[[container]]'//nl//'size = [1, 1, 1]'//nl, 'needs scene.dimension = 3', 8)
    call bad('a plane sample', space//'[[sample]]'//nl//'radius = 0.1'//nl//'box = [0, 0, 1, 1]'//nl, 'a list of 6 numbers', 12)
    call bad('sided solids', space//'[[sample]]'//nl//'shape = "polyhedron"'//nl//'sides = 5'//nl, 'did you mean "vertices"?', 12)
    call bad('a lattice of the plane', space//'[[sample]]'//nl//'kind = "lattice"'//nl//'arrangement = "square"'//nl, &
             'did you mean "cubic"?', 12)
    call bad('a rotation of the plane', space//ball//'[[drive]]'//nl//'body = 1'//nl//'component = "rotation"'//nl, &
             'did you mean "rotation_', 15)
    call bad('a spin in the plane', head//disk//'[[drive]]'//nl//'body = 1'//nl//'component = "z"'//nl, 'must be one of x', 13)
    call bad('a pressed length', space//ball//'[[pressure]]'//nl//'body = 1'//nl//'length = 1.0'//nl, 'did you mean "area"?', 15)
    call bad('no area', space//ball//'[[pressure]]'//nl//'body = 1'//nl//'direction = [1, 0, 0]'//nl, 'needs the key "area"', 13)
    call bad('plane shapes', space//ball//'[[interaction]]'//nl//'candidate_shape = "disk"'//nl, 'did you mean "sphere"?', 14)
  end subroutine bad_dimensions

  subroutine bad_shapes_in_space()
    call bad('negative radius', space//'[[body]]'//nl//'shape = "sphere"'//nl//'radius = -1'//nl, 'larger than 0 m', 12)
    call bad('negative half axes', space//'[[body]]'//nl//'shape = "box"'//nl//'half_axes = [1, -1, 1]'//nl, 'larger than 0 m', 12)
    call bad('two half axes', space//'[[body]]'//nl//'shape = "plane"'//nl//'half_axes = [1, 1]'//nl, 'a list of 3 numbers', 12)
    call bad('no height', space//'[[body]]'//nl//'shape = "cylinder"'//nl//'radius = 1'//nl, 'lacks the key "half_height"', 10)
    call bad('a length of a cylinder', space//'[[body]]'//nl//'shape = "cylinder"'//nl//'half_length = 1'//nl, &
             'did you mean "half_height"?', 12)
    call bad('negative friction in space', space//'friction = -1.0'//nl, 'at least 0', 10)
    call bad('a weightless hollow cylinder', space//'[[body]]'//nl//'shape = "hollow cylinder"'//nl//'radius = 1'//nl// &
             'half_height = 1'//nl, 'weighs nothing', 10)
    call bad('moments that no body has', space//ball//'inertia = [1, 1, 3]'//nl, 'no body has such moments', 13)
    call bad('a negative moment', space//ball//'inertia = [1, 1, -1]'//nl, 'larger than 0 kg m2', 13)
    call bad('no shape in space', space//'[[body]]'//nl, 'no shape', 10)
    call bad('spheres that overlap', space//ball//ball//'position = [0, 0, 0.8]'//nl, 'body 1 and body 2 overlap', 13)
    call bad('a sphere in a floor', space//ball//'[[wall]]'//nl//'name = "floor"'//nl//'centre = [0, 0, -0.3]'//nl// &
             'size = [9, 9]'//nl//'thickness = 1.0'//nl, '"floor" overlap', 13)
    call bad('boxes that overlap', space//'[[body]]'//nl//'shape = "box"'//nl//'half_axes = [1, 1, 1]'//nl//'[[body]]'//nl// &
             'shape = "box"'//nl//'half_axes = [1, 1, 1]'//nl//'position = [1.5, 1.5, 1.5]'//nl, 'overlap', 13)
    call bad('outside of the period in y', '[scene]'//nl//'period_y = 2.0'//nl//'dimension = 3'//nl//head//ball// &
             'position = [0, 3, 0]'//nl, 'y = 3', 11)
    call bad('wider than the period in y', '[scene]'//nl//'period_y = 0.5'//nl//'dimension = 3'//nl//head//ball, &
             'wider than the period', 11)
    call bad('overlap through the period in y', '[scene]'//nl//'period_y = 3.0'//nl//'dimension = 3'//nl//head//ball//ball// &
             'position = [0, 2.5, 0]'//nl, 'overlap', 14)
    call bad('no normal', space//'[[wall]]'//nl//'centre = [0, 0, 0]'//nl//'normal = [0, 0, 0]'//nl//'size = [1, 1]'//nl// &
             'thickness = 1'//nl, 'the normal has no length', 12)
    call bad('oblique in space', space//'[[wall]]'//nl//'centre = [0, 0, 0]'//nl//'size = [1, 1]'//nl//'thickness = 1'//nl// &
             'pressure = 1'//nl//'direction = [1, 0, 1]'//nl, 'along x, y or z', 15)
  end subroutine bad_shapes_in_space

  subroutine bad_polyhedra()
    character(len=*), parameter :: solid = space//'[[body]]'//nl//'shape = "polyhedron"'//nl
    character(len=*), parameter :: tetrahedron = solid//'vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]'//nl//'faces = '

    call bad('neither vertices nor file', solid, 'either "vertices" or "file"', 10)
    call bad('two numbers a vertex', solid//'vertices = [[0, 0], [1, 0], [0, 1]]'//nl, 'a list of [x, y, z]', 12)
    call bad('uneven vertices', solid//'vertices = [[0, 0], [1, 0, 0, 1], [0, 1, 0], [0, 0, 1]]'//nl, 'a list of [x, y, z]', 12)
    call bad('a vertex not finite', solid//'vertices = [[0, 0, nan], [1, 0, 0], [0, 1, 0], [0, 0, 1]]'//nl, 'finite', 12)
    call bad('too few faces', tetrahedron//'[[1, 3, 2], [1, 2, 4], [2, 3, 4]]'//nl, '4 faces or more', 13)
    call bad('an open surface', solid//'vertices = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 2]]'//nl// &
             'faces = [[1, 2, 5], [2, 3, 5], [3, 4, 5], [4, 1, 5]]'//nl, 'edge', 13)
    call bad('inverted faces', tetrahedron//'[[1, 2, 3], [1, 4, 2], [2, 4, 3], [3, 4, 1]]'//nl, 'inside out', 13)
    call bad('one face inverted', tetrahedron//'[[1, 2, 3], [1, 2, 4], [2, 3, 4], [3, 1, 4]]'//nl, 'edge', 13)
    call bad('a vertex that there is not', tetrahedron//'[[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 5]]'//nl, '5', 13)
    call bad('a vertex 0', tetrahedron//'[[0, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]'//nl, 'at least 1', 13)
    call bad('a vertex that is no integer', tetrahedron//'[[1.5, 3, 2]]'//nl, 'a list of lists of integers', 13)
    call bad('a face of two', tetrahedron//'[[1, 3], [1, 2, 4], [2, 3, 4], [3, 1, 4]]'//nl, 'face 1', 13)
    call bad('no faces', tetrahedron//'[]'//nl, 'a list of lists of integers', 13)
    call bad('no volume', solid//'vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]'//nl// &
             'faces = [[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]'//nl, 'volume', 13)
    call bad('a dented roof', solid//'vertices = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 2], [1, 1, 1]]'//nl// &
             'faces = [[1, 4, 3, 2], [1, 2, 5], [2, 3, 5], [3, 4, 5], [4, 6, 5], [4, 1, 6], [1, 5, 6]]'//nl, 'not convex', 13)
    call bad('a needle', space//'[[body]]'//nl//'shape = "box"'//nl//'half_axes = [1, 1, 1e-14]'//nl, '', 12)
    call bad('a scale without a file', tetrahedron//'[[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]'//nl//'scale = 2.0'//nl, &
             'no meaning without "file"', 14)
    if (.not. hull_is_available()) return
    call bad('flat vertices', solid//'vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]'//nl, 'plane', 12)
    call bad('three vertices', solid//'vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]'//nl, '4', 12)
    call bad('a vertex within', solid//'vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1]]'//nl, &
             'its hull has 4 of the 5 vertices', 12)
    call bad('more vertices than a shape has', solid//'vertices = ['//sphere_points(503)//']'//nl, &
             '503 vertices, more than the 502', 12)
  end subroutine bad_polyhedra

  !> Points of a unit sphere as a list of a deck.
  function sphere_points(n) result(list)
    integer, intent(in) :: n
    character(len=:), allocatable :: list
    character(len=60) :: point
    real(wp) :: z
    integer :: i

    list = ''
    do i = 1, n
      z = (2*real(i, wp) - 1)/real(n, wp) - 1
      write (point, '("[", 2(f15.12, ", "), f15.12, "], ")') sqrt(1 - z**2)*[cos(2.4_wp*real(i, wp)), sin(2.4_wp*real(i, wp))], z
      list = list//trim(point)//' '
    end do
  end function sphere_points

  !> Files of meshes: the mistake stands at the key, with the line of the file.
  subroutine bad_meshes()
    character(len=*), parameter :: solid = space//'[[body]]'//nl//'shape = "polyhedron"'//nl//'file = '

    call bad('no such mesh', solid//'"no_such_mesh.stl"'//nl, 'no_such_mesh.stl', 12)
    call bad('no mesh', solid//'"deck.toml"'//nl, 'ends in .stl or .obj', 12)
    call put_lines('bad.obj', ['v 0 0 0', 'v 1 0 0', 'v 0 1 0', 'v 0 0 x', 'f 1 2 3'])
    call bad('a mesh with a word', solid//'"bad.obj"'//nl, 'line 4 of the file: ', 12)
    call put_lines('bad.obj', ['v 0 0 0', 'v 2 0 0', 'v 2 2 0', 'v 0 2 0', 'v 1 1 2', 'f 1 2 5', 'f 2 3 5', 'f 3 4 5', 'f 4 1 5'])
    call bad('an open mesh', solid//'"bad.obj"'//nl, 'edge', 12)
    call bad('a file and vertices', solid//'"bad.obj"'//nl//'vertices = [[0, 0, 0]]'//nl, 'either "vertices" or "file"', 12)
    call bad('a file and faces', solid//'"bad.obj"'//nl//'faces = [[1, 2, 3]]'//nl, '"faces" is refused next to "file"', 13)
  end subroutine bad_meshes

  subroutine bad_generators()
    character(len=*), parameter :: sample = space//'[[sample]]'//nl//'radius = 0.1'//nl
    character(len=*), parameter :: wall = space//'[[brick_wall]]'//nl//'rows = 2'//nl//'columns = 2'//nl
    character(len=*), parameter :: arch = space//'[[arch]]'//nl//'voussoirs = 5'//nl//'depth = 0.3'//nl//'inner_radius = 1'//nl

    call bad('inverted box in space', sample//'box = [0, 0, 1, 1, 1, 0]'//nl//'count = 5'//nl, 'the box is empty', 12)
    call bad('too full in space', sample//'box = [0, 0, 0, 1, 1, 1]'//nl//'count = 1000'//nl, 'too full', 12)
    call bad('too full for insertion', sample//'box = [0, 0, 0, 1, 1, 1]'//nl//'fill = 0.6'//nl, 'too full', 12)
    call bad('too small in space', sample//'box = [0, 0, 0, 0.1, 1, 1]'//nl//'count = 1'//nl, 'too full', 12)
    call bad('too full a lattice in space', sample//'box = [0, 0, 0, 1, 1, 1]'//nl//'kind = "lattice"'//nl//'count = 65'//nl, &
             'holds 64 of 65', 14)
    call bad('three vertices of a grain', sample//'shape = "polyhedron"'//nl//'vertices = 3'//nl, 'at least 4', 13)
    call bad('vertices of spheres', sample//'vertices = 8'//nl, 'no meaning for shape = "sphere"', 12)
    call bad('elongation below one', sample//'shape = "polyhedron"'//nl//'elongation = 0.5'//nl, 'at least 1', 13)
    call bad('a container without a room', space//'[[container]]'//nl//'size = [1, 0, 1]'//nl, 'larger than 0 m', 11)
    call bad('a container without a size', space//'[[container]]'//nl, 'lacks the key "size"', 10)
    call bad('two containers', space//'[[container]]'//nl//'size = [1, 1, 1]'//nl//'[[container]]'//nl//'size = [1, 1, 1]'//nl, &
             'two bodies named "box.', 12)
    call bad('a container shorter than the period', '[scene]'//nl//'dimension = 3'//nl//'period_y = 2.0'//nl//head// &
             '[[container]]'//nl//'size = [2, 1, 1]'//nl, 'not as long as the period along y', 12)
    call bad('a drive of no side', space//'[[container]]'//nl//'size = [1, 1, 1]'//nl//'[[drive]]'//nl//'body = "box.lit"'//nl// &
             'component = "x"'//nl, 'no body named "box.lit"', 13)
    call bad('no rows', space//'[[brick_wall]]'//nl//'rows = 0'//nl, 'at least 1', 11)
    call bad('no brick', wall, 'lacks the key "brick"', 10)
    call bad('all joint', wall//'brick = [0.2, 0.1, 0.1]'//nl//'joint = 0.1'//nl, 'nothing of half a brick', 14)
    call bad('an arch inside out', arch//'outer_radius = 0.9'//nl, 'larger than the inner one', 14)
    call bad('more than half a circle', arch//'outer_radius = 1.2'//nl//'opening = 4.0'//nl, 'at most 3.14', 15)
  end subroutine bad_generators

  !> All mistakes of a deck are told, but not thousands.
  subroutine all_at_once()
    type(diagnostics_t) :: diagnostics
    character(len=:), allocatable :: text
    character(len=*), parameter :: crlf = achar(13)//nl
    integer :: i

    call read_text('[time]'//crlf//'step = 0'//crlf//'steps = 1'//crlf, diagnostics)
    call t%check(diagnostics%errors(1)%text == 'step = 0', 'lines that end as on Windows are shown without their ends')
    call read_text('[time]'//nl//'step = 0'//nl//'steps = 1.5'//nl//'thta = 1'//nl//'[[law]]'//nl//'kind = 3'//nl, diagnostics)
    call t%equal(diagnostics%count(), 4, 'four mistakes are told at once')
    call t%check(all(diagnostics%errors%line == [2, 3, 4, 6]), 'in the order of the text')
    text = head//'[solver]'//nl
    do i = 1, 1000
      text = text//'wrong'//to_text(i)//' = 1'//nl
    end do
    call read_text(text, diagnostics)
    call t%equal(diagnostics%count(), 101, 'of a thousand mistakes a hundred are told')
  end subroutine all_at_once
end program test_bad_decks
