!> Small packs of grains between walls, as decks, for tests on several ranks.
module packs
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use sg_advance, only: advance
  use sg_assemble, only: assemble
  use sg_choose_solver, only: choose_solver
  use sg_comm, only: comm_t
  use sg_convex_hull, only: hull_is_available
  use sg_detect, only: detect
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp
  use sg_measures, only: measure, measures_t
  use sg_motion, only: predict
  use sg_plan, only: set_radii
  use sg_problem, only: problem_t
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: decompose, simulation_t, start_simulation
  use sg_text, only: to_text
  use written_files, only: read_deck_text
  implicit none
  private
  public :: pack_names, pack_deck, can_be_made, start_pack, pack_alone, advance_pack, advance_both, next_problem, corner

  !> Kinds of packs
  character(len=20), parameter :: pack_names(8) = [character(len=20) :: 'disks', 'polygons', 'periodic disks', 'clusters', &
                                                   'pressed disks', 'spheres', 'frictionless spheres', 'polyhedra']
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: walls = '[[wall]]'//nl//'from = [-0.1, -0.01]'//nl//'to = [0.7, -0.01]'//nl// &
    'thickness = 0.02'//nl//'[[wall]]'//nl//'from = [-0.01, 0.0]'//nl//'to = [-0.01, 0.6]'//nl//'thickness = 0.02'//nl// &
    '[[wall]]'//nl//'from = [0.61, 0.0]'//nl//'to = [0.61, 0.6]'//nl//'thickness = 0.02'//nl
  character(len=*), parameter :: lid = '[[wall]]'//nl//'from = [0.01, 0.42]'//nl//'to = [0.59, 0.42]'//nl// &
    'thickness = 0.02'//nl//'pressure = 1000.0'//nl//'direction = [0.0, -1.0]'//nl
  character(len=*), parameter :: sample = '[[sample]]'//nl//'kind = "lattice"'//nl//'spacing = 1.0'//nl//'seed = 5'//nl
  character(len=*), parameter :: in_plane = sample//'arrangement = "square"'//nl//'box = [0.0, 0.0, 0.6, 0.4]'//nl// &
    'radius = [0.018, 0.022]'//nl
  character(len=*), parameter :: in_space = sample//'box = [0.0, 0.0, 0.0, 0.3, 0.2, 0.2]'//nl
  character(len=*), parameter :: container = '[[container]]'//nl//'size = [0.3, 0.2, 0.3]'//nl

contains

  !> Can this build make a pack? Random polyhedra are hulls of points; a build without them says that it leaves them out.
  logical function can_be_made(name)
    character(len=*), intent(in) :: name !! one of `pack_names`

    can_be_made = name /= 'polyhedra' .or. hull_is_available()
    if (.not. can_be_made) write (*, '(a)') 'no convex hulls in this build: no '//name
  end function can_be_made

  !> The deck of a pack.
  function pack_deck(name) result(deck)
    character(len=*), intent(in) :: name !! one of `pack_names`, or frictionless disks
    character(len=:), allocatable :: deck
    character(len=*), parameter :: bare = '[time]'//nl//'step = 1e-3'//nl//'steps = 1000'//nl//'[[material]]'//nl// &
      'name = "stone"'//nl//'density = 2600.0'//nl//'[[law]]'//nl//'friction = '
    character(len=*), parameter :: common = bare//'0.5'//nl

    select case (name)
    case ('frictionless disks')
      deck = bare//'0.0'//nl//walls//in_plane
    case ('polygons')
      deck = common//walls//in_plane//'shape = "polygon"'//nl//'sides = [4, 7]'//nl
    case ('periodic disks')
      deck = '[scene]'//nl//'period_x = 0.6'//nl//common//'[[wall]]'//nl//'from = [0.0, -0.01]'//nl//'to = [0.6, -0.01]'//nl// &
             'thickness = 0.02'//nl//'velocity = [0.1, 0.0]'//nl//in_plane
    case ('clusters')
      deck = common//walls//dumbbells()
    case ('pressed disks')
      deck = common//walls//lid//in_plane
    case ('spheres')
      deck = '[scene]'//nl//'dimension = 3'//nl//common//container//in_space//'radius = [0.018, 0.02]'//nl
    case ('frictionless spheres')
      deck = '[scene]'//nl//'dimension = 3'//nl//bare//'0.0'//nl//container//in_space//'radius = [0.018, 0.02]'//nl
    case ('polyhedra')
      deck = '[scene]'//nl//'dimension = 3'//nl//common//container//in_space//'shape = "polyhedron"'//nl// &
             'vertices = [8, 12]'//nl//'radius = [0.023, 0.025]'//nl
    case default
      deck = common//walls//in_plane
    end select
    ! One distance for all steps, more than the way of what falls through a pack in a step: parts share open contacts, too.
    deck = deck//'[[interaction]]'//nl//'alert = 5e-3'//nl
  end function pack_deck

  !> Rows of two disks each, lying crosswise.
  function dumbbells() result(bodies)
    character(len=:), allocatable :: bodies
    integer :: row, column

    bodies = ''
    do row = 0, 5
      do column = 0, 7
        bodies = bodies//'[[body]]'//nl//'position = ['//to_text(0.037_wp + 0.067_wp*real(column, wp))//', '// &
                 to_text(0.034_wp + 0.066_wp*real(row, wp))//']'//nl//'angle = '// &
                 to_text(0.8_wp*real(modulo(row + column, 3), wp))//nl// &
                 '[[body.shape]]'//nl//'kind = "disk"'//nl//'radius = 0.018'//nl//'centre = [-0.015, 0.0]'//nl// &
                 '[[body.shape]]'//nl//'kind = "disk"'//nl//'radius = 0.016'//nl//'centre = [0.015, 0.0]'//nl
      end do
    end do
  end function dumbbells

  !> Read a deck and start its run, whole, on this rank; not a step is done.
  subroutine start_pack(t, comm, name, deck, tolerance, sim)
    class(tests_t), intent(inout) :: t !! the checks
    type(comm_t), intent(in) :: comm !! the ranks; each reads a file of its own
    character(len=*), intent(in) :: name !! of the case
    character(len=*), intent(in) :: deck !! text of the deck
    real(wp), intent(in) :: tolerance !! e8 asked of the solver
    type(simulation_t), intent(inout) :: sim !! the run
    type(diagnostics_t) :: diagnostics

    call read_deck_text(deck, sim%scene, sim%options, diagnostics, rank=comm%rank)
    call t%equal(diagnostics%count(), 0, name//' is read')
    if (diagnostics%count() > 0) print '(a)', diagnostics%errors(1)%sentence()
    sim%options%solver%criterion = criterion_e8
    sim%options%solver%tolerance = tolerance
    sim%options%solver%maximum_sweeps = 20000
    ! Pushes end before they are solved as far as a step: a test that wants them asks for them.
    sim%options%recovery = 0
    call start_simulation(sim)
  end subroutine start_pack

  !> A pack on one rank, not a step of which is done.
  function pack_alone(t, name, tolerance) result(sim)
    class(tests_t), intent(inout) :: t !! the checks
    character(len=*), intent(in) :: name !! of the pack
    real(wp), intent(in) :: tolerance !! e8 asked of the solver
    type(simulation_t), pointer :: sim
    type(comm_t) :: alone

    sim => fresh()
    call start_pack(t, alone, name, pack_deck(name), tolerance, sim)
  end function pack_alone

  !> Go on for some steps.
  subroutine advance_pack(t, name, sim, steps)
    class(tests_t), intent(inout) :: t !! the checks
    character(len=*), intent(in) :: name !! of the case
    type(simulation_t), intent(inout) :: sim !! the run
    integer, intent(in) :: steps !! how many
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, steps
      call advance(sim, error)
      call t%check(.not. allocated(error), name//' runs')
      if (allocated(error)) return
    end do
  end subroutine advance_pack

  !> Go on for some steps, whole on every rank, and split over all ranks and repartitioned every four steps; both are measured.
  subroutine advance_both(t, comm, name, gluing, steps, whole, part, of_whole, of_parts)
    class(tests_t), intent(inout) :: t !! the checks
    type(comm_t), intent(in) :: comm !! the ranks
    character(len=*), intent(in) :: name !! of the case
    character(len=*), intent(in) :: gluing !! of the parts
    integer, intent(in) :: steps !! how many
    type(simulation_t), intent(inout) :: whole !! a run that was started
    type(simulation_t), intent(inout) :: part !! the same, split; without subdomains on one rank
    type(measures_t), intent(out) :: of_whole !! indicators of the whole run
    type(measures_t), allocatable, intent(out) :: of_parts !! and of the parts; none on one rank
    type(error_t), allocatable :: error

    call choose_solver(whole%options%solver, whole%solver)
    part = whole
    call advance_pack(t, name, whole, steps)
    call measure(whole%scene, whole%contacts, whole%options%time_step, whole%energy, of_whole)
    call t%check(whole%report%is_converged, name//': the last step has converged')
    call t%near(of_whole%get('energy_closure'), 0.0_wp, 1e-8_wp, name//': the balance closes')
    if (comm%size == 1) return
    part%options%partition%gluing = gluing
    part%options%partition%every = 4
    part%comm = comm
    call decompose(part, error)
    call t%check(.not. allocated(error), name//' is split')
    if (allocated(error)) return
    call advance_pack(t, name, part, steps)
    allocate (of_parts)
    call measure(part%scene, part%contacts, part%options%time_step, part%energy, of_parts, part%decomposition%subdomain, part%comm)
    call t%check(part%report%is_converged, name//': and on ranks')
  end subroutine advance_both

  !> Two coordinates of a list in a deck.
  function corner(x, y) result(text)
    real(wp), intent(in) :: x, y
    character(len=:), allocatable :: text

    text = to_text(x)//', '//to_text(y)
  end function corner

  !> The problem of the next step, with its guess; of several ranks this one's part.
  subroutine next_problem(sim, problem)
    type(simulation_t), intent(inout) :: sim !! the run
    type(problem_t), intent(out) :: problem !! problem that is not solved yet
    type(error_t), allocatable :: error
    logical :: is_rebuilt

    associate (h => sim%options%time_step)
      call predict(sim%scene, sim%time(), h, sim%options%theta)
      call sim%decomposition%update(sim%scene, sim%pairs, sim%history, sim%contacts, h, sim%comm, is_rebuilt, error)
      if (is_rebuilt) then
        call set_radii(sim%scene, sim%plan)
        call predict(sim%scene, sim%time(), h, sim%options%theta)
      end if
      call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
      call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, h, problem)
    end associate
  end subroutine next_problem
end module packs
