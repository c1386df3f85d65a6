!> Shares of a deck's scene: each rank reads its own, about as many grains as its part is; together they are the whole scene, bit
!! for bit, with the same defaults, plan, signature and mistakes as one rank finds. Run by any number of ranks.
program test_share
  use harness, only: tests_t
  use same_bits, only: same
  use sg_blocks, only: deck_t
  use sg_comm, only: comm_t
  use sg_convex_hull, only: hull_is_available
  use sg_deck, only: read_deck, read_share
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: contactors_of_bodies
  use sg_pack_bodies, only: pack_body
  use sg_parcels, only: parcel_t
  use sg_plan, only: make_plan, plan_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_shared_start, only: check_shared_start
  use sg_signature, only: signature_of
  use sg_text, only: text_t, to_text
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
  character(len=*), parameter :: driven = '[[drive]]'//nl//'body = 77'//nl//'component = "x"'//nl//'value = 0.1'//nl
  type(tests_t) :: t
  type(comm_t) :: comm

  call comm%start()
  call test_shares('a lattice', common//disk//floor//in_plane//'kind = "lattice"'//nl//'arrangement = "triangular"'//nl// &
                   'jitter = 0.7'//nl//'distribution = "lognormal"'//nl, 1.02_wp)
  call test_shares('a driven grain', common//disk//floor//in_plane//'kind = "lattice"'//nl//driven, 1.02_wp)
  call test_shares('random places', common//floor//in_plane//'kind = "random"'//nl//'fill = 0.3'//nl, 1.02_wp)
  call test_shares('polygons and disks', common//floor//in_plane//'kind = "lattice"'//nl//'shape = "polygon"'//nl//above// &
                   'kind = "lattice"'//nl, 1.02_wp)
  call test_shares('spheres', in_space//'kind = "lattice"'//nl//'arrangement = "hexagonal"'//nl, 1.02_wp)
  if (hull_is_available()) call test_shares('polyhedra', in_space//'kind = "lattice"'//nl//'shape = "polyhedron"'//nl, 1.02_wp)
  ! Fewer grains than ranks.
  call test_shares('two grains', common//floor//'[[sample]]'//nl//'box = [0.0, 0.0, 1.0, 0.1]'//nl//'radius = [0.02, 0.03]'//nl// &
                   'kind = "lattice"'//nl//'count = 2'//nl, 3.0_wp)
  call test_mistakes()
  call t%finish(comm)

contains

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
    own = real(count(share%bodies%home == comm%rank), wp)
    call t%check(own(1) <= unevenness*real(whole%bodies%n, wp)/real(comm%size, wp) + 2, name//': grains of a share')
    call t%check(share%bodies%n <= nint(own(1)) + 8, name//': bodies that all ranks hold')
    call comm%sum(own)
    call t%equal(nint(own(1)) + count(share%bodies%home < 0), whole%bodies%n, name//': bodies of all shares')
    call compare_bodies(name, share, whole)
    call t%check(same([share%sees%alert], [whole%sees%alert]), name//': alert distances')
    call check_shared_start(deck, share, comm, diagnostics)
    call t%equal(diagnostics%count(), 0, name//' has no mistakes')
    call compare_bodies(name//', with copies', share, whole)
    call compare_plans(name, share, whole)
  end subroutine test_shares

  !> Each body of a share is one of the whole scene, with its contactors, bit for bit; its home alone is new.
  subroutine compare_bodies(name, share, whole)
    character(len=*), intent(in) :: name
    type(scene_t), intent(in) :: share, whole
    type(parcel_t) :: one, other
    integer(i4), allocatable :: first(:), list(:), all_first(:), all_list(:)
    integer :: b, n_same

    call contactors_of_bodies(share%contactors, share%bodies%n, first, list)
    call contactors_of_bodies(whole%contactors, whole%bodies%n, all_first, all_list)
    n_same = 0
    do b = 1, share%bodies%n
      one%n = 0
      other%n = 0
      call pack_body(share, b, first, list, 0, one)
      call pack_body(whole, int(share%bodies%id(b)), all_first, all_list, 0, other)
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

    call t%check(.not. any(abs(signature_of(share, comm) - signature_of(whole)) > 0), name//': signature')
    call make_plan(share, one, comm)
    call make_plan(whole, other)
    call t%check((one%is_round .eqv. other%is_round) .and. (one%has_tangent .eqv. other%has_tangent) .and. &
                 (one%has_rotation .eqv. other%has_rotation), name//': what the plan needs')
    call t%check(all(one%uses_law .eqv. other%uses_law) .and. all(one%sees .eqv. other%sees), name//': laws and pairs of the plan')
    call t%check(all([one%bodies, one%grains, one%contactors, one%shapes] == [other%bodies, other%grains, other%contactors, &
                                                                             other%shapes]), name//': counts of the plan')
    call t%near(one%alert, other%alert, 0.0_wp, name//': alert distance of the plan')
  end subroutine compare_plans

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
  end subroutine test_mistakes

  !> The same mistakes and as many warnings; of many pairs that overlap not the same ones need be named.
  subroutine test_mistake(name, text)
    character(len=*), intent(in) :: name, text
    type(scene_t) :: whole, share
    type(run_options_t) :: options
    type(diagnostics_t) :: expected, got
    type(deck_t) :: deck
    type(text_t) :: none(0)
    character(len=:), allocatable :: file
    integer :: i, n_same

    file = 'share_'//to_text(comm%rank)//'.toml'
    call put_text(file, text)
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
