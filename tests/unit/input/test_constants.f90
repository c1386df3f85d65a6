!> Constants of a deck: expressions in braces are numbers, settings lay over them, mistakes have their place.
program test_constants
  use harness, only: tests_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_text, only: text_t
  use written_files, only: first, read_deck_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  !> Six lines that are right, and three more: a disk
  character(len=*), parameter :: head = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
                                        'name = "stone"'//nl//'density = 2000'//nl
  character(len=*), parameter :: disk = '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl
  type(tests_t) :: t

  call good_constants()
  call bad_constants()
  call t%finish()

contains

  !> Constants: numbers and words of braces, settings, and the same effective deck as with numbers; none without the section.
  subroutine good_constants()
    character(len=*), parameter :: section = '[constants]'//nl//'size = 0.25'//nl//'speed = "-8*size"'//nl
    character(len=*), parameter :: body = '[[body]]'//nl//'name = "a"'//nl//'shape = "disk"'//nl
    character(len=*), parameter :: drive = '[[drive]]'//nl//'body = "a"'//nl//'component = "x"'//nl
    character(len=*), parameter :: track = '[[track]]'//nl//'body = '
    type(scene_t) :: scene
    type(run_options_t) :: options, plain
    type(diagnostics_t) :: diagnostics
    type(text_t) :: settings(1)

    call read_deck_text(section//head//body//'radius = "{2*size}"'//nl//'position = ["{size}", "{-size}"]'//nl//drive// &
                        'value = "3 - {speed}*t"'//nl//track//'"{4*size}"'//nl, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'constants: '//first(diagnostics))
    if (diagnostics%count() > 0) return
    call t%near(norm2(scene%bodies%position(:2, 1) - [0.25_wp, -0.25_wp]), 0.0_wp, 0.0_wp, 'expressions in a list')
    call t%near(scene%bodies%mass(1), 2000*pi*0.25_wp, 1e-9_wp, 'an expression as a number')
    call read_deck_text(head//body//'radius = 0.5'//nl//'position = [0.25, -0.25]'//nl//drive//'value = "3 - (-2)*t"'//nl// &
                        track//'1'//nl, scene, plain, diagnostics)
    call t%check(options%deck_hash == plain%deck_hash, 'the effective deck has the numbers')
    settings(1)%s = 'constants.size=0.75/1.5'
    call read_deck_text(section//head//body//'radius = "{2*size}"'//nl, scene, options, diagnostics, settings)
    call t%equal(diagnostics%count(), 0, 'a setting of a constant: '//first(diagnostics))
    call t%near(scene%bodies%mass(1), 2000*pi, 1e-9_wp, 'a setting takes the place of the number')
    settings(1)%s = 'constants.sise=1'
    call read_deck_text(section//head//body//'radius = 0.5'//nl, scene, options, diagnostics, settings)
    call t%check(index(first(diagnostics), 'there is no constant named "sise"; did you mean "size"?') > 0, first(diagnostics))
    call read_deck_text(head//'[[body]]'//nl//'name = "{a}"'//nl//'shape = "disk"'//nl//'radius = 0.5'//nl, scene, options, &
                        diagnostics)
    call t%equal(diagnostics%count(), 0, 'braces mean nothing without constants: '//first(diagnostics))
  end subroutine good_constants

  !> A deck has one mistake with these words, in this line, below which a caret stands at this column.
  subroutine bad(text, fragment, line, column)
    character(len=*), intent(in) :: text, fragment
    integer, intent(in) :: line, column
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    call read_deck_text(text, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 1, 'one mistake: '//fragment)
    if (diagnostics%count() == 0) return
    call t%check(index(diagnostics%errors(1)%message, fragment) > 0, fragment//': '//diagnostics%errors(1)%message)
    call t%equal(diagnostics%errors(1)%line, line, 'line of: '//fragment)
    call t%equal(diagnostics%errors(1)%column, column, 'column of: '//fragment)
  end subroutine bad

  !> Mistakes in constants, and in expressions of them; nothing follows from one that is missing.
  subroutine bad_constants()
    character(len=*), parameter :: section = '[constants]'//nl//'wide = 2'//nl

    call bad(section//head//disk//'position = ["{wid}", "{wide}"]', 'there is no "wid" here; did you mean "wide"?', 12, 15)
    call bad(section//head//disk//'position = ["{2*wide", 0]', 'a "{" lacks its "}"', 12, 14)
    call bad(section//head//disk//'position = ["{1/(wide - 2)}", 0]', '"1/(wide - 2)" has no value', 12, 15)
    call bad(section//'b = "wide + c"'//nl//'c = 1'//nl//head//disk, 'there is no "c" here', 3, 13)
    call bad(section//'b = true'//nl//head//disk, 'must be a number, or an expression of constants above it', 3, 5)
    call bad(section//'t = 1'//nl//head//disk, '"t" is a word of expressions', 3, 1)
    call bad(section//'"a b" = 1'//nl//head//disk, 'must be letters, digits and _', 3, 1)
    call bad('[[constants]]'//nl//'wide = 2'//nl//head//disk, '[constants] needs single brackets', 1, 3)
  end subroutine bad_constants
end program test_constants
