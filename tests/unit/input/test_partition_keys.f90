!> The section partition of a deck: defaults, lists, and what is wrong.
program test_partition_keys
  use harness, only: tests_t
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t, error_t
  use sg_key_table, only: key_table_t, value_integer
  use sg_keys, only: all_keys
  use sg_kinds, only: wp
  use sg_primal, only: primal_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_sparse_factor, only: find_sparse_library
  use sg_text, only: append_word, text_t, to_text
  use sg_words, only: short_real
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: head = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
    'name = "stone"'//nl//'density = 2000'//nl//'[[law]]'//nl//'[[sample]]'//nl//'kind = "lattice"'//nl// &
    'box = [0.0, 0.0, 1.0, 1.0]'//nl//'count = 4'//nl//'radius = 0.05'//nl//'[partition]'//nl
  type(tests_t) :: t
  type(run_options_t) :: options
  character(len=:), allocatable :: warning
  type(error_t) :: warned
  integer :: n_warnings

  call read_keys('', '')
  associate (p => options%partition)
    call t%check(p%split == 'boxes' .and. p%gluing == 'dual' .and. all(p%boxes == 0), 'defaults')
    call t%check(all(p%sweeps == [1]) .and. p%every == 0, 'defaults of numbers')
  end associate
  call read_keys('split = "graph"'//nl//'gluing = "primal"'//nl//'sweeps = [800, 400, 100]'//nl//'every = 20'//nl// &
                 'imbalance = 1.5', '')
  associate (p => options%partition)
    call t%check(p%split == 'graph' .and. p%gluing == 'primal', 'words')
    call t%check(all(p%sweeps == [800, 400, 100]), 'sweeps one by one')
    call t%equal(p%every, 20, 'a whole number')
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
  call read_keys('gluing = "enriched"'//nl//'[partition.enriched]'//nl//'eta = 0.0', 'must be larger than 0')
  call read_keys('gluing = "enriched"'//nl//'[partition.enriched]'//nl//'eta = -1.0', 'must be larger than 0')
  call read_keys('gluing = "enriched"'//nl//'[partition.enriched]'//nl//'preconditioner = "schwarz"', 'dirichlet')
  call test_own_keys()
  call test_own_coupling()
  call test_former_keys()
  deallocate (warning)
  call t%finish()

contains

  !> Options of one gluing, by their keys and by those of older decks: the same deck, with a note. Those of another are ignored,
  !! with a warning; the effective deck holds the present keys.
  subroutine test_own_keys()
    character(len=*), parameter :: here = 'gluing = "primal"'//nl//'[partition.primal]'//nl//'interface_sweeps = 7'
    character(len=*), parameter :: former(2) = [character(len=60) :: 'gluing = "primal"'//nl//'interface_sweeps = 7', &
                                                'interface_sweeps = 7'//nl//'gluing = "primal"']
    character(len=:), allocatable :: effective
    integer :: i

    call read_keys(here, '')
    call t%equal(own_sweeps(), 7, 'interface sweeps')
    call t%equal(n_warnings, 0, 'no note')
    effective = options%deck_text
    call t%check(index(effective, '[partition.primal]'//nl//'interface_sweeps = 7'//nl) > 0, 'the effective deck')
    do i = 1, size(former)
      call read_keys(trim(former(i)), '')
      call t%equal(own_sweeps(), 7, 'interface sweeps of an older deck')
      call t%equal(n_warnings, 1, 'one note')
      call t%check(index(warning, '"partition.primal.interface_sweeps" now') > 0, 'the note: '//warning)
      call t%check(options%deck_text == effective, 'the same effective deck')
    end do
    call read_keys('gluing = "primal"', '', 'partition.interface_sweeps=7')
    call t%check(own_sweeps() == 7 .and. n_warnings == 1 .and. options%deck_text == effective, 'the same by a setting')
    call read_keys('gluing = "dual"'//nl//'[partition.primal]'//nl//'interface_sweeps = 7', '')
    call t%check(index(warning, 'is ignored with gluing = "dual"') > 0, 'a warning: '//warning)
    call read_keys(here//nl//'[partition.momentum]'//nl//'relaxation = 0.5', '')
    call t%check(index(warning, '"relaxation" is ignored with gluing = "primal"') > 0, 'a warning: '//warning)
    call read_keys('interface_sweeps = 7'//nl//'[partition.primal]'//nl//'interface_sweeps = 7', 'is given twice')
    call read_keys('[partition.momentum]'//nl//'relaxation = 1.5', 'must be at most 1')
    call read_keys('relaxation = 1.5', '"relaxation" must be at most 1')
    call read_keys('[partition.primal]'//nl//'interface_sweep = 1', 'did you mean "interface_sweeps"?')
    call read_keys('[partition.dual]'//nl//'sweeps = 1', 'unknown key "dual" in [partition]')
  end subroutine test_own_keys

  !> A solver with a coupling of its own: a warning at any gluing but the one which that coupling goes on from.
  subroutine test_own_coupling()
    character(len=*), parameter :: others(3) = [character(len=8) :: 'primal', 'momentum', 'enriched']
    type(error_t), allocatable :: error
    integer :: i

    call find_sparse_library(error)
    if (allocated(error)) return
    do i = 1, size(others)
      call read_keys('gluing = "'//trim(others(i))//'"', '', 'solver.method="interior"')
      call t%equal(n_warnings, 1, 'one warning')
      call t%check(index(warning, '"gluing" is ignored with solver.method = "interior"') > 0, 'the warning: '//warning)
      call t%check(warned%file == 'test_partition_keys.toml' .and. warned%line == 14 .and. warned%column == 10, 'its place')
      call t%check(warned%text == 'gluing = "'//trim(others(i))//'"', 'its line: '//warned%text)
    end do
    call read_keys('gluing = "dual"', '', 'solver.method="interior"')
    call t%equal(n_warnings, 0, 'no warning at the coupling that interior points go on from')
    call read_keys('gluing = "primal"', '', 'solver.method="nesterov"')
    call t%equal(n_warnings, 0, 'no warning where sweeps are coupled')
  end subroutine test_own_coupling

  !> Each key of older decks that the table has: its values are those of the present key, to the letter of the effective deck.
  subroutine test_former_keys()
    type(key_table_t) :: table
    character(len=:), allocatable :: effective, word
    real(wp) :: low, high
    integer :: k, n

    table = all_keys()
    n = 0
    do k = 1, size(table%keys)
      associate (key => table%keys(k))
        if (key%former_key == '') cycle
        n = n + 1
        low = max(key%lowest, -100.0_wp)
        high = min(key%highest, low + 100)
        word = short_real(low + 0.75_wp*(high - low))
        if (key%kind == value_integer) word = to_text(nint(low + 0.75_wp*(high - low)))
        call read_keys('', '', trim(key%section)//'.'//trim(key%name)//'='//word)
        effective = options%deck_text
        call t%check(index(effective, trim(key%name)//' = '//word//nl) > 0, trim(key%name)//' = '//word)
        call read_keys('', '', trim(key%former_key)//'='//word)
        call t%check(options%deck_text == effective, trim(key%former_key)//' is '//trim(key%section)//'.'//trim(key%name))
      end associate
    end do
    call t%check(n >= 2, 'there are keys of older decks')
  end subroutine test_former_keys

  !> Interface sweeps of the method that the options make.
  integer function own_sweeps() result(sweeps)
    type(primal_t) :: primal

    call primal%visit_options(options%partition%own)
    sweeps = primal%interface_sweeps
  end function own_sweeps

  !> Read a deck with these keys: no mistake, or one that says so.
  subroutine read_keys(keys, mistake, setting)
    character(len=*), intent(in) :: keys, mistake
    character(len=*), intent(in), optional :: setting
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    type(text_t), allocatable :: settings(:)
    integer :: unit

    open (newunit=unit, file='test_partition_keys.toml', access='stream', form='unformatted', status='replace')
    write (unit) head//keys//nl
    close (unit)
    allocate (settings(0))
    if (present(setting)) call append_word(settings, setting)
    call read_deck('test_partition_keys.toml', settings, scene, options, diagnostics)
    n_warnings = 0
    if (allocated(diagnostics%warnings)) n_warnings = size(diagnostics%warnings)
    warning = ''
    if (n_warnings > 0) then
      warned = diagnostics%warnings(n_warnings)
      warning = warned%message
    end if
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
