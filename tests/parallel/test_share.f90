!> Shares of a deck's scene: each rank reads its own, about as many grains as its part is; together they are the whole scene, bit
!! for bit, with the same defaults, plan, signature and mistakes as one rank finds. Run by any number of ranks.
program test_share
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use same_bits, only: same, same_bodies
  use sg_advance, only: advance
  use sg_blocks, only: deck_t
  use sg_comm, only: comm_t
  use sg_convex_hull, only: hull_is_available
  use sg_datbox_write, only: contacts_at_start, write_datbox
  use sg_deck, only: read_deck, read_share
  use sg_error, only: diagnostics_t, error_t
  use sg_field_visitor, only: sync_on_copy, sync_on_owner
  use sg_kinds, only: wp, i4
  use sg_laws, only: status_stick
  use sg_local_numbers, only: contactors_of_bodies
  use sg_pack_bodies, only: pack_bodies
  use sg_parcels, only: parcel_t
  use sg_plan, only: make_plan, plan_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_shared_start, only: check_shared_start
  use sg_signature, only: signature_of
  use sg_simulation, only: decompose, simulation_t, start_simulation
  use sg_text, only: text_t, to_text
  use sg_toml, only: read_content
  use written_files, only: put_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: common = '[time]'//nl//'step = 1e-3'//nl//'steps = 4'//nl//'[[material]]'//nl// &
    'name = "stone"'//nl//'density = 2600.0'//nl//'[[law]]'//nl//'friction = 0.4'//nl
  character(len=*), parameter :: disk = '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.05'//nl//'position = [0.5, 1.5]'//nl
  character(len=*), parameter :: floor = '[[wall]]'//nl//'name = "floor"'//nl//'from = [-0.1, -0.01]'//nl//'to = [2.1, -0.01]'// &
    nl//'thickness = 0.02'//nl
  character(len=*), parameter :: in_plane = '[[sample]]'//nl//'box = [0.0, 0.0, 2.0, 0.6]'//nl//'radius = [0.01, 0.02]'//nl
  character(len=*), parameter :: above = '[[sample]]'//nl//'box = [0.0, 0.6, 1.0, 0.9]'//nl//'radius = [0.01, 0.02]'//nl
  character(len=*), parameter :: in_space = '[scene]'//nl//'dimension = 3'//nl//'period_x = 0.4'//nl//common// &
    '[[container]]'//nl//'size = [0.4, 0.3, 0.3]'//nl//'[[sample]]'//nl//'box = [0.0, 0.0, 0.0, 0.4, 0.3, 0.2]'//nl// &
    'radius = [0.01, 0.015]'//nl
  character(len=*), parameter :: solid = '[scene]'//nl//'dimension = 3'//nl//common//'[[container]]'//nl// &
    'size = [0.4, 2.0, 2.0]'//nl
  character(len=*), parameter :: polygon = 'shape = "polygon"'//nl//'vertices = [[-0.05, -0.05], [0.05, -0.05], [0.0, 0.04]]'//nl
  character(len=*), parameter :: clusters = '[[body.shape]]'//nl//'kind = "disk"'//nl//'radius = 0.03'//nl// &
    'centre = [-0.02, 0]'//nl//'[[body.shape]]'//nl//'kind = "disk"'//nl//'radius = 0.02'//nl//'centre = [0.02, 0]'//nl
  character(len=*), parameter :: clumps = '[[clump]]'//nl//'name = "pair"'//nl// &
    '[[clump.shape]]'//nl//'kind = "disk"'//nl//'radius = 1'//nl// &
    '[[clump.shape]]'//nl//'kind = "disk"'//nl//'radius = 2'//nl//'centre = [2, 0]'//nl//'[[clump]]'//nl//'name = "single"'//nl// &
    '[[clump.shape]]'//nl//'kind = "polygon"'//nl//'vertices = [[0, 0], [1, 0], [0, 1]]'//nl
  character(len=*), parameter :: held = '[[body]]'//nl//'name = "pin"'//nl//'fixed = true'//nl//'shape = "disk"'//nl// &
    'radius = 0.03'//nl//'position = [1.0, 2.0]'//nl
  character(len=*), parameter :: by_name = '[[body]]'//nl//'name = "puller"'//nl//'shape = "disk"'//nl//'radius = 0.03'//nl// &
    'position = [1.0, 3.0]'//nl//'[[drive]]'//nl//'body = "puller"'//nl//'component = "x"'//nl//'value = 0.1'//nl
  type(tests_t) :: t
  type(comm_t) :: comm

  call comm%start()
  call test_shares('a lattice', common//disk//floor//in_plane//'kind = "lattice"'//nl//'arrangement = "triangular"'//nl// &
                   'jitter = 0.7'//nl//'distribution = "lognormal"'//nl, 1.02_wp)
  call test_shares('a driven grain', common//disk//floor//in_plane//'kind = "lattice"'//nl//driven(77), 1.02_wp)
  call test_shares('random places', common//floor//in_plane//'kind = "random"'//nl//'fill = 0.3'//nl, 1.02_wp)
  call test_shares('grown', common//floor//in_plane//'kind = "grown"'//nl//'fill = 0.7'//nl, 1.02_wp)
  call test_shares('polygons and disks', common//floor//in_plane//'kind = "lattice"'//nl//'shape = "polygon"'//nl//above// &
                   'kind = "lattice"'//nl, 1.02_wp)
  call test_shares('clumps', common//floor//clumps//in_plane//'kind = "lattice"'//nl//'shape = "clump"'//nl// &
                   'clump = ["pair", "single"]'//nl//above//'kind = "lattice"'//nl, 1.02_wp)
  call test_shares('clumps behind disks, one driven', common//floor//clumps//in_plane//'kind = "lattice"'//nl//above// &
                   'shape = "clump"'//nl//'clump = "pair"'//nl//'count = 60'//nl//driven(77), 1.02_wp)
  call test_shares('spheres', in_space//'kind = "lattice"'//nl//'arrangement = "hexagonal"'//nl, 1.02_wp)
  if (hull_is_available()) call test_shares('polyhedra', in_space//'kind = "lattice"'//nl//'shape = "polyhedron"'//nl, 1.02_wp)
  ! Fewer grains than ranks.
  call test_shares('two grains', common//floor//'[[sample]]'//nl//'box = [0.0, 0.0, 1.0, 0.1]'//nl//'radius = [0.02, 0.03]'//nl// &
                   'kind = "lattice"'//nl//'count = 2'//nl, 3.0_wp)
  call test_written()
  call test_datbox('disks', common//bodies_in_plane(40, '')//floor, .true., held//by_name//above//'kind = "lattice"'//nl// &
                   driven(5))
  call test_datbox('clusters and polygons', common//bodies_in_plane(7, clusters)//floor, .false., held//by_name)
  call test_datbox('solids', solid//bodies_in_space(9), .false., '[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.05'//nl// &
                   'position = [0.2, 1.0, 1.0]'//nl//'[[sample]]'//nl//'box = [0.0, 0.0, 1.2, 0.4, 1.0, 1.5]'//nl// &
                   'radius = [0.03, 0.04]'//nl//'kind = "lattice"'//nl)
  call test_mistakes()
  call test_warnings()
  call t%finish(comm)

contains

  !> Disks side by side, each written by itself, every third one made something else.
  function bodies_in_plane(n, other) result(text)
    integer, intent(in) :: n
    character(len=*), intent(in) :: other !! shape of every third body; empty for none
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, n
      text = text//'[[body]]'//nl//'position = ['//to_text(0.1_wp*real(i, wp), 6)//', 0.05]'//nl
      if (mod(i, 3) == 2 .and. other /= '') then
        text = text//other
      else
        text = text//'shape = "disk"'//nl//'radius = 0.05'//nl
      end if
    end do
  end function bodies_in_plane

  !> Spheres, boxes and capsules, each written by itself.
  function bodies_in_space(n) result(text)
    integer, intent(in) :: n
    character(len=:), allocatable :: text
    character(len=*), parameter :: shapes(0:2) = [character(len=60) :: 'shape = "sphere"'//nl//'radius = 0.05', &
                                                  'shape = "box"'//nl//'half_axes = [0.04, 0.05, 0.03]', &
                                                  'shape = "cylinder"'//nl//'half_height = 0.02'//nl//'radius = 0.03']
    integer :: i

    text = ''
    do i = 1, n
      text = text//'[[body]]'//nl//'position = [0.2, '//to_text(0.15_wp*real(i, wp), 6)//', 0.3]'//nl//'velocity = [0, 0, '// &
             to_text(-0.1_wp*real(i, wp), 6)//']'//nl//trim(shapes(mod(i, 3)))//nl
    end do
  end function bodies_in_space

  !> Bodies that a deck writes one by one: all ranks keep those that are driven or held.
  subroutine test_written()
    character(len=*), parameter :: stones = '[[brick_wall]]'//nl//'name = "wall"'//nl//'rows = 5'//nl//'columns = 4'//nl// &
      'brick = [0.2, 0.1, 0.1]'//nl//'position = [1.0, 0.3, 0.0]'//nl//'[[arch]]'//nl//'name = "arch"'//nl// &
      'inner_radius = 1.0'//nl//'outer_radius = 1.2'//nl//'depth = 0.3'//nl//'voussoirs = 9'//nl//'centre = [5.0, 5.0, 0.0]'//nl

    call test_shares('bodies of the plane', common//bodies_in_plane(40, '')//floor, 1.02_wp)
    call test_shares('clusters', common//bodies_in_plane(40, clusters)//floor, 1.02_wp)
    call test_shares('driven bodies', common//held//bodies_in_plane(40, polygon)//floor//by_name//driven(5), 1.02_wp)
    call test_shares('bodies and samples', common//bodies_in_plane(11, clusters)//floor//above//'kind = "lattice"'//nl, 1.02_wp)
    call test_shares('three bodies', common//bodies_in_plane(3, clusters)//floor, 1.5_wp)
    call test_shares('two bodies alone', common//bodies_in_plane(2, ''), 3.0_wp)
    call test_shares('bodies in space', solid//bodies_in_space(12), 1.02_wp)
    call test_shares('masonry', solid//stones, 1.02_wp)
  end subroutine test_written

  !> Shares of a DATBOX, and the first steps from the contacts that it knows: the same, bit for bit, as where all ranks read
  !! all; then with bodies of a deck next to it.
  subroutine test_datbox(name, text, has_contacts, more)
    character(len=*), intent(in) :: name, text
    logical, intent(in) :: has_contacts
    character(len=*), intent(in) :: more !! blocks of these bodies, and of drives
    character(len=:), allocatable :: deck, folder
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    type(text_t) :: none(0)
    integer :: i

    folder = 'share_datbox_'//to_text(comm%rank)
    call put_text(folder//'.toml', text)
    call read_deck(folder//'.toml', none, scene, options, diagnostics)
    call t%equal(diagnostics%count(), 0, name//' can be written as a DATBOX')
    if (diagnostics%count() > 0) return
    if (has_contacts) then
      allocate (scene%start_contacts(scene%bodies%n - 2))
      do i = 1, size(scene%start_contacts)
        scene%start_contacts(i)%contactor = [i, i + 1]
        scene%start_contacts(i)%point(1) = 0.1_wp*real(i, wp) + 0.05_wp
        scene%start_contacts(i)%point(2) = 0.05_wp
        scene%start_contacts(i)%force(1) = real(i, wp)
        scene%start_contacts(i)%status = status_stick
      end do
    end if
    call write_datbox(folder, scene, contacts_at_start(scene), 0.1_wp, 100, error)
    call t%check(.not. allocated(error), name//' is written')
    deck = '[scene]'//nl//'datbox = "'//folder//'"'//nl//merge('dimension = 3', 'dimension = 2', scene%dimension == 3)//nl// &
           '[time]'//nl//'step = 1e-3'//nl//'steps = 4'//nl//'[solver]'//nl//'maximum_sweeps = 3'//nl//'check_every = 3'//nl
    call test_shares('DATBOX, '//name, deck, 1.02_wp)
    call compare_steps('DATBOX, '//name, deck)
    call test_shares('bodies next to a DATBOX, '//name, deck//more//'[[interaction]]'//nl, 1.1_wp)
    call compare_steps('bodies next to a DATBOX, '//name, deck//more//'[[interaction]]'//nl)
    call test_mistake('the same bodies twice next to a DATBOX, '//name, deck//more//more//'[[interaction]]'//nl)
    call test_mistake('DATBOX with a bad body, '//name, deck, spoilt=folder)
  end subroutine test_datbox

  !> Two steps of a scene that is read by shares, and of one that all ranks read whole.
  subroutine compare_steps(name, text)
    character(len=*), intent(in) :: name, text
    type(simulation_t), pointer :: by_shares, by_all
    type(diagnostics_t) :: diagnostics
    type(deck_t) :: deck
    type(text_t) :: none(0)
    character(len=:), allocatable :: file

    by_shares => fresh()
    by_all => fresh()
    if (comm%size == 1) return
    by_shares%comm = comm
    by_all%comm = comm
    file = 'share_'//to_text(comm%rank)//'.toml'
    call put_text(file, text)
    call read_share(file, none, comm, by_shares%scene, by_shares%options, deck, diagnostics)
    call check_shared_start(deck, by_shares%scene, by_shares%comm, diagnostics)
    call read_deck(file, none, by_all%scene, by_all%options, diagnostics)
    call make_steps(by_shares)
    call make_steps(by_all)
    call t%equal(by_shares%contacts%n, by_all%contacts%n, name//': contacts')
    call t%check(same_bodies(by_shares%scene%bodies, by_all%scene%bodies), name//': bodies after two steps')
  end subroutine compare_steps

  !> Make two steps.
  subroutine make_steps(sim)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable :: error
    integer :: i

    call start_simulation(sim)
    call decompose(sim, error)
    do i = 1, 2
      if (.not. allocated(error)) call advance(sim, error)
    end do
    call t%check(.not. allocated(error), 'two steps')
  end subroutine make_steps

  !> The shares of all ranks are the whole scene.
  subroutine test_shares(name, text, unevenness)
    character(len=*), intent(in) :: name, text
    real(wp), intent(in) :: unevenness !! grains of a share at most, over those of an even one
    type(scene_t) :: whole, share
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    type(deck_t) :: deck
    type(text_t) :: none(0)
    character(len=:), allocatable :: file
    real(wp) :: own(1)

    file = 'share_'//to_text(comm%rank)//'.toml'
    call put_text(file, text)
    call read_deck(file, none, whole, options, diagnostics)
    call read_share(file, none, comm, share, options, deck, diagnostics)
    call t%equal(diagnostics%count(), 0, name//' is read')
    if (comm%size == 1) then
      call t%check(.not. allocated(share%bodies%id), name//': one rank has all')
      call t%equal(share%bodies%n, whole%bodies%n, name//': bodies of one rank')
      return
    end if
    own = real(count(share%bodies%owner == comm%rank), wp)
    call t%check(own(1) <= unevenness*real(whole%bodies%n, wp)/real(comm%size, wp) + 2, name//': grains of a share')
    call t%check(share%bodies%n <= nint(own(1)) + 8, name//': bodies that all ranks hold')
    call comm%sum(own)
    call t%equal(nint(own(1)) + count(share%bodies%owner < 0), whole%bodies%n, name//': bodies of all shares')
    call compare_bodies(name, share, whole)
    call t%check(same([share%sees%alert], [whole%sees%alert]), name//': alert distances')
    call check_shared_start(deck, share, comm, diagnostics)
    call t%equal(diagnostics%count(), 0, name//' has no mistakes')
    call compare_bodies(name//', with copies', share, whole)
    call compare_plans(name, share, whole)
  end subroutine test_shares

  !> Each body of a share is one of the whole scene, with its contactors, bit for bit; its owner alone is new.
  subroutine compare_bodies(name, share, whole)
    character(len=*), intent(in) :: name
    type(scene_t), intent(in) :: share, whole
    type(parcel_t) :: one, other
    integer(i4), allocatable :: first(:), list(:), all_first(:), all_list(:)
    integer :: b, n_same, least

    call contactors_of_bodies(share%contactors, share%bodies%n, first, list)
    call contactors_of_bodies(whole%contactors, whole%bodies%n, all_first, all_list)
    n_same = 0
    do b = 1, share%bodies%n
      one%n = 0
      other%n = 0
      least = merge(sync_on_owner, sync_on_copy, b <= share%bodies%n_own)
      call pack_bodies(share, [int(b, i4)], first, list, [0_i4], least, one)
      call pack_bodies(whole, share%bodies%id(b:b), all_first, all_list, [0_i4], least, other)
      if (one%n /= other%n) cycle
      if (same(one%value(:one%n), other%value(:one%n))) n_same = n_same + 1
    end do
    call t%equal(n_same, share%bodies%n, name//': bodies as they are in the whole scene')
  end subroutine compare_bodies

  !> Plans and signatures of the shares are those of the whole scene.
  subroutine compare_plans(name, share, whole)
    character(len=*), intent(in) :: name
    type(scene_t), intent(inout) :: share, whole
    type(plan_t) :: one, other
    type(comm_t) :: alone

    call t%check(.not. any(abs(signature_of(share, comm) - signature_of(whole, alone)) > 0), name//': signature')
    call make_plan(share, one, comm)
    call make_plan(whole, other, comm)
    call t%check((one%is_round .eqv. other%is_round) .and. (one%has_tangent .eqv. other%has_tangent) .and. &
                 (one%has_rotation .eqv. other%has_rotation), name//': what the plan needs')
    call t%check(all(one%uses_law .eqv. other%uses_law) .and. all(one%sees .eqv. other%sees), name//': laws and pairs of the plan')
    call t%check(all([one%bodies, one%grains, one%contactors, one%shapes] == [other%bodies, other%grains, other%contactors, &
                                                                             other%shapes]), name//': counts of the plan')
    call t%near(one%alert, other%alert, 0.0_wp, name//': alert distance of the plan')
  end subroutine compare_plans

  !> A drive of a body called by its number.
  function driven(number) result(text)
    integer, intent(in) :: number
    character(len=:), allocatable :: text

    text = '[[drive]]'//nl//'body = '//to_text(number)//nl//'component = "x"'//nl//'value = 0.1'//nl
  end function driven

  !> All ranks give the warnings that one rank gives.
  subroutine test_warnings()
    character(len=*), parameter :: segments = '[[body]]'//nl//'shape = "segment"'//nl//'half_length = 0.1'//nl// &
      'half_thickness = 0.01'//nl//'position = [0.0, 5.0]'//nl
    character(len=*), parameter :: drum = '[[body]]'//nl//'shape = "hollow disk"'//nl//'radius = 0.1'//nl// &
      'position = [0.0, 8.0]'//nl//'mass = 1.0'//nl//'inertia = 1.0'//nl

    call test_warning('shapes that cannot touch', common//bodies_in_plane(9, polygon)//segments//drum, 2)
    call test_warning('one segment', common//bodies_in_plane(9, '')//segments, 0)
    call test_warning('two segments', common//segments//bodies_in_plane(9, '')//segments, 1)
    call test_warning('a sample in a drum', common//drum//above//'kind = "lattice"'//nl//'shape = "polygon"'//nl, 1)
    call test_warning('a short alert distance', solid//'[[interaction]]'//nl//'alert = 1e-5'//nl//bodies_in_space(9), 2)
  end subroutine test_warnings

  !> The same warnings before the scene is checked together.
  subroutine test_warning(name, text, n)
    character(len=*), intent(in) :: name, text
    integer, intent(in) :: n
    type(scene_t) :: whole, share
    type(run_options_t) :: options
    type(diagnostics_t) :: expected, got
    type(deck_t) :: deck
    type(text_t) :: none(0)
    character(len=:), allocatable :: file
    integer :: i

    file = 'share_'//to_text(comm%rank)//'.toml'
    call put_text(file, text)
    call read_deck(file, none, whole, options, expected)
    call read_share(file, none, comm, share, options, deck, got)
    call t%equal(expected%count() + got%count(), 0, name//' is no mistake')
    call t%equal(warnings_of(expected), n, name//': warnings of one rank')
    call t%equal(warnings_of(got), n, name//': warnings of all ranks')
    if (warnings_of(got) /= n .or. warnings_of(expected) /= n) return
    do i = 1, n
      call t%check(got%warnings(i)%sentence() == expected%warnings(i)%sentence(), name//': the same warning')
    end do
  end subroutine test_warning

  !> How many warnings there are.
  pure integer function warnings_of(found)
    type(diagnostics_t), intent(in) :: found

    warnings_of = 0
    if (allocated(found%warnings)) warnings_of = size(found%warnings)
  end function warnings_of

  !> All ranks find the mistakes that one rank finds.
  subroutine test_mistakes()
    character(len=*), parameter :: ball = '[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.02'//nl
    character(len=*), parameter :: lattice = in_plane//'kind = "lattice"'//nl

    call test_mistake('overlaps of several ranks', common//floor//ball//'position = [1.01, 0.3]'//nl//lattice)
    call test_mistake('many overlaps', common//floor//lattice//lattice)
    call test_mistake('a grain in the floor', common//floor//ball//'position = [0.3, 0.01]'//nl)
    call test_mistake('a wide grain', '[scene]'//nl//'period_x = 0.03'//nl//common//floor//'[[sample]]'//nl// &
                      'box = [0.0, 0.0, 2.0, 0.6]'//nl//'radius = [0.01, 0.02]'//nl//'kind = "lattice"'//nl)
    call test_mistake('a grain outside', '[scene]'//nl//'period_x = 2.0'//nl//common//floor//ball//'position = [2.5, 0.9]'//nl// &
                      lattice)
    call test_mistake('a bad body', common//bodies_in_plane(20, '')//ball//'position = [0.0, 1.0]'//nl//'mass = 0.0'//nl// &
                      '[[body]]'//nl//'position = [0.0, 2.0]'//nl)
    call test_mistake('names', common//'[[body]]'//nl//'name = "a"'//nl//polygon//bodies_in_plane(20, '')//'[[body]]'//nl// &
                      'name = "a"'//nl//'position = [0.0, 3.0]'//nl//polygon)
    call test_mistake('no body of this name', common//bodies_in_plane(20, '')//driven(21))
  end subroutine test_mistakes

  !> The same mistakes and as many warnings; of many pairs that overlap not the same ones need be named.
  subroutine test_mistake(name, text, spoilt)
    character(len=*), intent(in) :: name, text
    character(len=*), intent(in), optional :: spoilt !! folder whose last body but one is to lose its node
    type(scene_t) :: whole, share
    type(run_options_t) :: options
    type(diagnostics_t) :: expected, got
    type(deck_t) :: deck
    type(text_t) :: none(0)
    character(len=:), allocatable :: file
    integer :: i, n_same

    file = 'share_'//to_text(comm%rank)//'.toml'
    call put_text(file, text)
    if (present(spoilt)) call spoil(spoilt//'/BODIES.DAT')
    call read_deck(file, none, whole, options, expected)
    call t%check(expected%count() > 0, name//' is a mistake')
    call read_share(file, none, comm, share, options, deck, got)
    if (got%count() == 0) call check_shared_start(deck, share, comm, got)
    call t%equal(got%count(), expected%count(), name//': mistakes of all ranks')
    if (got%count() /= expected%count() .or. expected%count() >= 5) return
    n_same = 0
    do i = 1, expected%count()
      if (any_same(got, expected%errors(i)%sentence())) n_same = n_same + 1
    end do
    call t%equal(n_same, expected%count(), name//': the same mistakes')
  end subroutine test_mistake

  !> Take the node of the last body out of a file.
  subroutine spoil(file)
    character(len=*), intent(in) :: file
    character(len=:), allocatable :: content
    type(error_t), allocatable :: error
    integer :: at

    call read_content(file, content, error)
    call t%check(.not. allocated(error), 'bodies to spoil')
    at = index(content, '$nodty', back=.true.)
    call put_text(file, content(:at - 1)//'!'//content(at + 1:))
  end subroutine spoil

  !> Is a sentence among some mistakes?
  logical function any_same(found, sentence)
    type(diagnostics_t), intent(in) :: found
    character(len=*), intent(in) :: sentence
    integer :: i

    any_same = .true.
    do i = 1, found%count()
      if (found%errors(i)%sentence() == sentence) return
    end do
    any_same = .false.
  end function any_same
end program test_share
