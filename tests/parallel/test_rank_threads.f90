!> Ranks whose sweeps are shared by threads: the same bits as with one thread a rank, however the parts are glued.
program test_rank_threads
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use same_bits, only: same
  use sg_advance, only: advance
  use sg_comm, only: comm_t
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: decompose, simulation_t, start_simulation
  use sg_threads, only: threads_are_available
  use written_files, only: read_deck_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=8), parameter :: gluings(3) = [character(len=8) :: 'dual', 'primal', 'momentum']
  character(len=*), parameter :: common = '[time]'//nl//'step = 1e-3'//nl//'steps = 40'//nl//'[[material]]'//nl// &
    'name = "stone"'//nl//'density = 2600.0'//nl//'[[law]]'//nl//'friction = 0.4'//nl//'[[sample]]'//nl//'kind = "lattice"'//nl// &
    'spacing = 1.0'//nl//'seed = 5'//nl//'radius = [0.018, 0.02]'//nl
  character(len=*), parameter :: disks = common//'box = [0.0, 0.0, 2.0, 0.6]'//nl//'arrangement = "triangular"'//nl// &
    '[[wall]]'//nl//'from = [-0.1, -0.01]'//nl//'to = [2.1, -0.01]'//nl//'thickness = 0.02'//nl
  character(len=*), parameter :: spheres = '[scene]'//nl//'dimension = 3'//nl//common// &
    'box = [0.0, 0.0, 0.0, 0.5, 0.3, 0.2]'//nl//'[[container]]'//nl//'size = [0.5, 0.3, 0.3]'//nl
  type(tests_t) :: t
  type(comm_t) :: comm
  integer :: g

  call comm%start()
  do g = 1, merge(1, size(gluings), comm%size == 1)
    call test_same('disks', disks, trim(gluings(g)))
    call test_same('spheres', spheres, trim(gluings(g)))
  end do
  call t%finish(comm)

contains

  !> A run by one thread a rank, and by two.
  subroutine test_same(name, deck, gluing)
    character(len=*), intent(in) :: name, deck, gluing
    type(simulation_t), pointer :: one, two

    one => fresh()
    two => fresh()
    call go(name//', '//gluing, deck, gluing, 1, one)
    call go(name//', '//gluing, deck, gluing, merge(2, 1, threads_are_available()), two)
    call t%check(one%all_contacts > 100, name//', '//gluing//': there are contacts')
    call t%equal(two%contacts%n, one%contacts%n, name//', '//gluing//': as many contacts')
    associate (n => one%contacts%n)
      call t%check(same(two%contacts%impulse(:, :n), one%contacts%impulse(:, :n)), name//', '//gluing//': the same impulses')
    end associate
    call t%check(same(two%scene%bodies%velocity, one%scene%bodies%velocity), name//', '//gluing//': the same velocities')
  end subroutine test_same

  !> Some steps of a deck on all ranks.
  subroutine go(name, deck, gluing, threads, sim)
    character(len=*), intent(in) :: name, deck, gluing
    integer, intent(in) :: threads
    type(simulation_t), intent(inout) :: sim
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    integer :: i

    call read_deck_text(deck, sim%scene, sim%options, diagnostics, rank=comm%rank)
    call t%equal(diagnostics%count(), 0, name//' is read')
    if (diagnostics%count() > 0) print '(a)', diagnostics%errors(1)%sentence()
    sim%options%solver%criterion = criterion_e8
    sim%options%solver%tolerance = 1e-3_wp
    sim%options%solver%maximum_sweeps = 100
    sim%options%solver%order = 'coloured'
    sim%options%solver%threads = threads
    sim%options%partition%gluing = gluing
    call start_simulation(sim)
    sim%comm = comm
    if (comm%size > 1) call decompose(sim, error)
    do i = 1, 40
      if (.not. allocated(error)) call advance(sim, error)
    end do
    call t%check(.not. allocated(error), name//' runs')
  end subroutine go
end program test_rank_threads
