!> The section partition of a deck: defaults, lists, and what is wrong.
program test_partition_keys
  use harness, only: tests_t
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_text, only: text_t
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: head = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
    'name = "stone"'//nl//'density = 2000'//nl//'[[law]]'//nl//'[[sample]]'//nl//'kind = "lattice"'//nl// &
    'box = [0.0, 0.0, 1.0, 1.0]'//nl//'count = 4'//nl//'radius = 0.05'//nl//'[partition]'//nl
  type(tests_t) :: t
  type(run_options_t) :: options

  call read_keys('', '')
  associate (p => options%partition)
    call t%check(p%split == 'boxes' .and. p%gluing == 'dual' .and. all(p%boxes == 0), 'defaults')
    call t%check(all(p%sweeps == [1]) .and. p%interface_sweeps == 1 .and. p%every == 0, 'defaults of numbers')
  end associate
  call read_keys('split = "graph"'//nl//'gluing = "primal"'//nl//'sweeps = [800, 400, 100]'//nl//'interface_sweeps = 7'//nl// &
                 'relaxation = 0.5'//nl//'every = 20'//nl//'imbalance = 1.5', '')
  associate (p => options%partition)
    call t%check(p%split == 'graph' .and. p%gluing == 'primal', 'words')
    call t%check(all(p%sweeps == [800, 400, 100]), 'sweeps one by one')
    call t%check(p%interface_sweeps == 7 .and. p%every == 20, 'whole numbers')
    call t%near(p%relaxation, 0.5_wp, 0.0_wp, 'relaxation')
    call t%near(p%imbalance, 1.5_wp, 0.0_wp, 'imbalance')
    call t%check(index(options%deck_text, 'sweeps = [800, 400, 100]') > 0, 'the effective deck repeats a list')
  end associate
  call read_keys('boxes = [4, 0]', '')
  call t%check(all(options%partition%boxes == [4, 0, 1]), 'boxes; 0 where the program chooses')
  call read_keys('boxes = 3', '')
  call t%check(all(options%partition%boxes == [3, 1, 1]), 'axes left out have one box')
  call read_keys('boxes = [2, 2, 2]', 'boxes has 3 numbers, but there are 2 axes')
  call read_keys('boxes = []', 'must be an integer or a list of them')
  call read_keys('boxes = [2, 1.5]', 'must be an integer or a list of them, not a number in it')
  call read_keys('boxes = [2, -1]', 'must be at least 0')
  call read_keys('sweeps = 0', 'must be at least 1')
  call read_keys('split = "graphs"', 'did you mean "graph"?')
  call read_keys('imbalance = 1.0', 'must be larger than 1')
  call read_keys('relaxation = 1.5', 'must be at most 1')
  call t%finish()

contains

  !> Read a deck with these keys: no mistake, or one that says so.
  subroutine read_keys(keys, mistake)
    character(len=*), intent(in) :: keys, mistake
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    type(text_t) :: none(0)
    integer :: unit

    open (newunit=unit, file='test_partition_keys.toml', access='stream', form='unformatted', status='replace')
    write (unit) head//keys//nl
    close (unit)
    if (allocated(options%partition%sweeps)) deallocate (options%partition%sweeps)
    options%partition%boxes = 0
    call read_deck('test_partition_keys.toml', none, scene, options, diagnostics)
    if (mistake == '') then
      call t%equal(diagnostics%count(), 0, 'no mistake in '//keys)
    else
      call t%equal(diagnostics%count(), 1, 'one mistake in '//keys)
    end if
    if (diagnostics%count() == 0) return
    call t%check(index(diagnostics%errors(1)%message, mistake) > 0 .and. mistake /= '', &
                 'mistake in '//keys//': '//diagnostics%errors(1)%message)
  end subroutine read_keys
end program test_partition_keys
