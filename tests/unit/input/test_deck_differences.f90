!> Differences of effective decks by key: values changed, keys and blocks that come and go, blocks within blocks.
program test_deck_differences
  use harness, only: tests_t
  use sg_deck_differences, only: deck_differences, hash_of_deck
  use sg_error, only: diagnostics_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_text, only: joined, text_t
  use written_files, only: read_deck_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: scene_keys = '[scene]'//nl//'gravity = [0.0, -9.81]'//nl
  character(len=*), parameter :: laws = nl//'[[law]]'//nl//'name = "a"'//nl//'friction = 0.1'//nl//nl//'[[law]]'//nl// &
                                        'name = "b"'//nl//'friction = 0.2'//nl
  character(len=*), parameter :: clump = nl//'[[body]]'//nl//'colour = "x"'//nl//nl//'[[body.shape]]'//nl//'radius = 1.0'//nl// &
                                         nl//'[[body.shape]]'//nl//'radius = 2.0'//nl
  type(tests_t) :: t

  call test_values()
  call test_blocks()
  call test_hash()
  call t%finish()

contains

  !> Differences in words.
  function words_of(former, present_deck) result(words)
    character(len=*), intent(in) :: former, present_deck
    character(len=:), allocatable :: words
    type(text_t), allocatable :: list(:)

    call deck_differences(former, present_deck, list)
    words = joined(list, '; ')
  end function words_of

  !> Values, in blocks that stand once and in those that stand several times; the title does not count.
  subroutine test_values()
    character(len=*), parameter :: former = 'title = "one"'//nl//nl//scene_keys//laws
    character(len=:), allocatable :: other

    call t%check(words_of(former, former) == '', 'the same deck')
    call t%check(words_of(former, 'title = "two"'//nl//nl//scene_keys//laws) == '', 'another title')
    other = scene_keys//laws(:len(laws) - 4)//'0.5'//nl
    call t%check(words_of(former, other) == 'law[2].friction = 0.5 (was 0.2)', words_of(former, other))
    call t%check(words_of(other, former) == 'law[2].friction = 0.2 (was 0.5)', 'and back')
  end subroutine test_values

  !> Keys and blocks of one deck only; shapes are counted within their body.
  subroutine test_blocks()
    character(len=*), parameter :: theta = 'theta = 0.5'//nl
    character(len=:), allocatable :: words

    words = words_of(scene_keys, scene_keys//theta)
    call t%check(words == 'scene.theta = 0.5 (was not there)', words)
    words = words_of(scene_keys//theta, scene_keys)
    call t%check(words == 'scene.theta is gone (was 0.5)', words)
    words = words_of(scene_keys//clump//clump, scene_keys//clump//clump(:len(clump) - 4)//'3.0'//nl)
    call t%check(words == 'body[2].shape[2].radius = 3.0 (was 2.0)', words)
    words = words_of(scene_keys//clump, scene_keys//clump//clump)
    call t%check(words == 'body[2].colour = "x" (was not there); body[2].shape[1].radius = 1.0 (was not there); '// &
                 'body[2].shape[2].radius = 2.0 (was not there)', words)
  end subroutine test_blocks

  !> The hash of a text is the one that the deck was given.
  subroutine test_hash()
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    character(len=*), parameter :: deck = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
      'name = "stone"'//nl//'density = 2000'//nl//'[[law]]'//nl//'friction = 0.5'//nl//'[[body]]'//nl//'radius = 0.5'//nl// &
      'shape = "disk"'//nl

    call read_deck_text(deck, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, 'the deck is right')
    call t%check(hash_of_deck(options%deck_text) == options%deck_hash, 'hash of a deck without a title')
    call read_deck_text('title = "[brackets]"'//nl//deck, scene, options, diagnostics)
    call t%check(hash_of_deck(options%deck_text) == options%deck_hash, 'hash of a deck with a title')
  end subroutine test_hash
end program test_deck_differences
