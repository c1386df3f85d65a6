!> Decks with several subdomains per rank: the same record, pictures and checkpoints, bit for bit, on one process and on as many
!! ranks as this test runs on; also after a restart with other numbers of both.
module subdomain_decks
  use fresh_simulations, only: fresh
  use sg_blocks, only: deck_t
  use sg_comm, only: comm_t
  use sg_deck, only: read_share
  use sg_error, only: diagnostics_t, error_t
  use sg_shared_start, only: check_shared_start
  use sg_simulate, only: simulate
  use sg_simulation, only: simulation_t
  use sg_subdomain_runs, only: subdomain_program_t
  use sg_text, only: text_t
  implicit none
  private
  public :: deck_run_t

  !> The run of a deck
  type, extends(subdomain_program_t) :: deck_run_t
    !> Path of the deck, and settings laid over it
    character(len=:), allocatable :: deck, folder, restart
    type(text_t), allocatable :: settings(:)
    !> Mistake of the deck, or error of the run
    character(len=:), allocatable :: failure
  contains
    procedure :: run => run_deck
  end type deck_run_t

contains

  !> Run the deck as one of several subdomains.
  subroutine run_deck(self, comm)
    class(deck_run_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm
    type(simulation_t), pointer :: sim
    type(deck_t) :: deck
    type(diagnostics_t) :: diagnostics, shared
    type(error_t), allocatable :: error
    integer :: code

    sim => fresh()
    sim%comm = comm
    call read_share(self%deck, self%settings, sim%comm, sim%scene, sim%options, deck, diagnostics)
    if (sim%comm%size > 1 .and. diagnostics%count() == 0) call check_shared_start(deck, sim%scene, sim%comm, shared)
    if (diagnostics%count() + shared%count() > 0) then
      self%failure = 'the deck is refused'
      return
    end if
    sim%options%folder = self%folder
    if (allocated(self%restart)) sim%options%restart_file = self%restart
    sim%options%is_forced = .true.
    sim%options%is_quiet = .true.
    call simulate(sim, self%deck, code, error)
    if (allocated(error)) self%failure = error%message
  end subroutine run_deck
end module subdomain_decks

program test_parts
  use harness, only: tests_t
  use sg_comm, only: comm_t
  use sg_convex_hull, only: hull_is_available
  use sg_error, only: error_t
  use sg_graph_split, only: graph_splits
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: i8, wp
  use sg_subdomain_runs, only: run_subdomains
  use sg_text, only: append_word, read_lines, text_t, to_text
  use subdomain_decks, only: deck_run_t
  implicit none
  type(tests_t) :: t
  type(comm_t) :: comm
  !> Do runs write pictures and checkpoints?
  logical :: has_files = .false.
  character(len=:), allocatable :: split

  call comm%start()
  split = ''
  if (graph_splits()) split = 'partition.split=graph'
  ! The column's first contact carries in step 8; polyhedra still fall.
  call test_deck('collapsing_column', 16, 8, 'partition.gluing=primal partition.every=3', goes_on=.true.)
  if (hull_is_available()) call test_deck('polyhedra_settling', 4, 5, '', goes_on=comm%size <= 2)
  call test_deck('cable_bridge', 4, 5, 'partition.gluing=momentum', goes_on=.false.)
  if (comm%size <= 2) then
    ! Launchers make ranks wait for each other, which takes CPU time on few cores.
    call test_deck('biaxial', 4, 5, split, goes_on=.false.)
    call test_deck('cracking_wall', 5, 5, '', goes_on=.true.)
    call test_deck('spheres_in_a_box', 4, 5, 'partition.gluing=momentum partition.every=3', goes_on=.false.)
  end if
  call test_ranks()
  deallocate (split)
  call t%finish(comm)

contains

  !> Run a deck on one process and on all ranks; where that is asked for with pictures and checkpoints, and on with as many
  !! subdomains as ranks, two at least.
  subroutine test_deck(name, parts, steps, settings, goes_on)
    character(len=*), intent(in) :: name, settings
    integer, intent(in) :: parts, steps
    logical, intent(in) :: goes_on

    has_files = goes_on .and. hdf5_is_available() .and. (hdf5_is_parallel() .or. comm%size == 1)
    call run(name, parts, settings, steps, 'one', .true.)
    call run(name, parts, settings, steps, 'all', .false.)
    call compare(name)
    if (comm%rank == 0 .and. name /= 'polyhedra_settling') call check_carries(name)
    if (.not. has_files) return
    call run(name, max(2, comm%size), settings, steps + 2, 'one', .true., 'one/restart_a.h5')
    call run(name, max(2, comm%size), settings, steps + 2, 'all', .false., 'all/restart_a.h5')
    call compare(name//', restarted')
  end subroutine test_deck

  !> Some contacts carry in the last step of the run on one process: there is something to share.
  subroutine check_carries(name)
    character(len=*), intent(in) :: name
    type(text_t), allocatable :: rows(:), names(:), last(:)
    type(error_t), allocatable :: error
    integer :: k, carrying

    call read_lines('one/record.csv', rows, error)
    if (allocated(error)) return
    names = cells(rows(1)%s)
    last = cells(rows(size(rows))%s)
    carrying = 0
    do k = 1, size(names)
      if (names(k)%s == 'active_contacts') read (last(k)%s, *) carrying
    end do
    call t%check(carrying > 0, name//': contacts carry')
  end subroutine check_carries

  !> One subdomain per rank is one rank each as MPI adds, and one subdomain is the scene that is not split.
  subroutine test_ranks()
    has_files = .false.
    call run('collapsing_column', comm%size, '', 8, 'one', .true.)
    call run('collapsing_column', 0, '', 8, 'all', .false.)
    if (comm%size <= 2) call compare('a rank for each of few subdomains')
    ! Sums of more ranks may be added in another order: errors of rounding, after some steps and sweeps.
    if (comm%size > 2) call compare('a rank for each subdomain', 1e-9_wp)
    if (comm%size > 1) return
    call run('collapsing_column', 7, '', 8, 'one', .true.)
    ! What the solver leaves differs.
    call compare('subdomains and the scene that is not split', 1e-2_wp)
  end subroutine test_ranks

  !> Run a deck for some steps, by the first process alone or by all. The first one without subdomains is the program of one rank.
  subroutine run(name, parts, settings, steps, folder, is_alone, restart)
    character(len=*), intent(in) :: name, settings, folder
    integer, intent(in) :: parts, steps
    logical, intent(in) :: is_alone
    character(len=*), intent(in), optional :: restart
    type(deck_run_t) :: program
    type(comm_t) :: alone
    logical :: waited

    call describe(program, name, settings, steps, folder)
    if (present(restart)) program%restart = restart
    if (is_alone .and. comm%rank == 0) then
      if (parts == 1) call program%run(alone)
      if (parts > 1) call run_subdomains(program, parts, alone)
    else if (.not. is_alone) then
      if (parts == 0) call program%run(comm)
      if (parts > 0) call run_subdomains(program, parts, comm)
    end if
    if (allocated(program%failure)) call t%check(.false., name//' in '//folder//': '//program%failure)
    ! The next run begins when all files of this one are there.
    waited = comm%any(.true.)
  end subroutine run

  !> Deck, settings and folder of a run.
  subroutine describe(program, name, settings, steps, folder)
    type(deck_run_t), intent(inout) :: program
    character(len=*), intent(in) :: name, settings, folder
    integer, intent(in) :: steps
    character(len=1000) :: source
    character(len=:), allocatable :: every
    integer :: first, last

    call get_environment_variable('SPLITGRAIN_SOURCE', source)
    program%deck = trim(source)//'/input_decks/'//name//'.toml'
    program%folder = folder
    every = merge('4', '0', has_files)
    allocate (program%settings(0))
    call append_word(program%settings, 'time.steps='//to_text(steps))
    call append_word(program%settings, 'output.every='//every)
    call append_word(program%settings, 'output.record_every=1')
    call append_word(program%settings, 'restart.every='//every)
    call append_word(program%settings, 'restart.at_end=false')
    first = 1
    do while (first <= len(settings))
      last = first + index(settings(first:)//' ', ' ') - 2
      call append_word(program%settings, settings(first:last))
      first = last + 2
    end do
  end subroutine describe

  !> Compare the files of both runs, clocks apart; where `tolerance` is given some columns of the record alone.
  subroutine compare(what, tolerance)
    character(len=*), intent(in) :: what
    real(wp), intent(in), optional :: tolerance !! relative

    if (comm%rank > 0) return
    call compare_records(what, tolerance)
    if (present(tolerance) .or. .not. has_files) return
    call compare_groups('bodies.vtkhdf', '/VTKHDF/', [character(len=9) :: 'PointData', 'FieldData'], what)
    call compare_groups('shapes.vtkhdf', '/VTKHDF/', [character(len=9) :: 'CellData'], what)
    call compare_groups('contacts.vtkhdf', '/VTKHDF/', [character(len=9) :: 'CellData'], what)
    call compare_groups('restart_a.h5', '/', [character(len=9) :: 'bodies', 'contacts'], what)
  end subroutine compare

  !> Compare the columns of two records.
  subroutine compare_records(what, tolerance)
    character(len=*), intent(in) :: what
    real(wp), intent(in), optional :: tolerance
    character(len=*), parameter :: firm(3) = [character(len=16) :: 'step', 'kinetic_energy', 'potential_energy']
    type(text_t), allocatable :: one(:), all(:), names(:), of_one(:), of_all(:)
    type(error_t), allocatable :: error
    real(wp) :: numbers(2)
    integer :: i, k

    call read_lines('one/record.csv', one, error)
    if (.not. allocated(error)) call read_lines('all/record.csv', all, error)
    call t%check(.not. allocated(error), what//': records are there')
    if (allocated(error)) return
    call t%equal(size(all), size(one), what//': rows of the record')
    if (size(all) /= size(one)) return
    names = cells(one(1)%s)
    do i = 1, size(one)
      of_one = cells(one(i)%s)
      of_all = cells(all(i)%s)
      do k = 1, size(names)
        if (index(names(k)%s, 'cpu_') == 1 .or. index(names(k)%s, 'wall_') == 1) cycle
        if (.not. present(tolerance)) then
          call t%check(of_one(k)%s == of_all(k)%s, what//': '//names(k)%s//' of row '//to_text(i))
        else if (i > 1 .and. any(firm == names(k)%s)) then
          read (of_one(k)%s, *) numbers(1)
          read (of_all(k)%s, *) numbers(2)
          call t%near(numbers(2), numbers(1), tolerance*abs(numbers(1)), what//': '//names(k)%s//' of row '//to_text(i))
        end if
      end do
    end do
  end subroutine compare_records

  !> Cells of a row.
  function cells(row) result(list)
    character(len=*), intent(in) :: row
    type(text_t), allocatable :: list(:)
    integer :: first, last

    allocate (list(0))
    first = 1
    do while (first <= len(row))
      last = first + index(row(first:)//',', ',') - 2
      call append_word(list, row(first:last))
      first = last + 2
    end do
  end function cells

  !> Compare all datasets in some groups of two files.
  subroutine compare_groups(file, root, groups, what)
    character(len=*), intent(in) :: file, root, groups(:), what
    type(hdf5_file_t) :: one, all
    type(text_t), allocatable :: names(:)
    real(wp), allocatable :: from_one(:, :), from_all(:, :)
    logical :: is_same
    integer :: g, i

    call one%open('one/'//file, is_read_only=.true.)
    call all%open('all/'//file, is_read_only=.true.)
    do g = 1, size(groups)
      call one%names(root//trim(groups(g)), names)
      call t%check(size(names) > 0, what//': '//trim(groups(g))//' of '//file)
      do i = 1, size(names)
        call one%get(root//trim(groups(g))//'/'//names(i)%s, from_one)
        call all%get(root//trim(groups(g))//'/'//names(i)%s, from_all)
        is_same = all_same(shape(from_one), shape(from_all))
        if (is_same) is_same = .not. any(transfer(from_one, [0_i8]) /= transfer(from_all, [0_i8]))
        call t%check(is_same, what//': '//names(i)%s//' of '//file)
      end do
    end do
    call t%check(.not. (allocated(one%error) .or. allocated(all%error)), what//': '//file//' is read')
    call one%close()
    call all%close()
  end subroutine compare_groups

  !> Are shapes the same?
  pure logical function all_same(a, b)
    integer, intent(in) :: a(:), b(:)

    all_same = all(a == b)
  end function all_same
end program test_parts
