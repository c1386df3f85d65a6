!> Whole runs on several ranks beside the same runs on one: every way of gluing, boxes and graph, in the plane and in space.
!!
!! A pack settles once, and all runs go on from there. The residual of the undecomposed problem must reach the tolerance asked for.
!! Dense packs carry their weight in many ways: of them measures must agree as closely as those of one rank that sweeps in other
!! orders. Where forces are unique (frictionless round grains of many sizes) contacts agree one by one.
program test_gluing
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, pack_deck, start_pack
  use sg_choose_solver, only: choose_solver
  use sg_comm, only: comm_t
  use sg_contacts, only: normal_impulse
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_measures, only: measure, measures_t
  use sg_methods, only: coupling_names
  use sg_simulation, only: decompose, simulation_t
  use subdomain_tests, only: on_subdomains
  implicit none
  character(len=8), parameter :: splits(2) = [character(len=8) :: 'boxes', 'graph']
  !> Steps of one rank after which packs carry their weight, and steps of all ranks after that: few, so that chaos has no
  !! time to grow from what solvers leave
  integer, parameter :: settling = 150, together = 3
  character(len=22), parameter :: names(6) = [character(len=22) :: 'kinetic_energy', 'compactness', 'coordination', &
                                             'momentum_x', 'floor_share', 'pressure']

  !> A pack: its name, state at rest, run on one rank, and largest differences of measures between runs on one rank that sweep in
  !! other orders
  type :: pack_t
    character(len=:), allocatable :: name
    !> Are its forces unique?
    logical :: is_unique = .false.
    type(simulation_t), pointer :: settled => null(), whole => null()
    real(wp) :: spread(size(names)) = 0
  end type pack_t

  type(tests_t) :: t
  type(pack_t), allocatable, save :: pack

  call test_all('frictionless disks', is_unique=.true.)
  call test_all('disks', is_unique=.false.)
  call test_all('polygons', is_unique=.false.)
  call test_all('periodic disks', is_unique=.false.)
  call test_all('spheres', is_unique=.false.)
  if (can_be_made('polyhedra')) call test_all('polyhedra', is_unique=.false.)
  call t%finish()

contains

  !> One pack, glued in every way, split in both.
  subroutine test_all(name, is_unique)
    character(len=*), intent(in) :: name !! of the pack
    logical, intent(in) :: is_unique !! are the forces?

    allocate (pack)
    pack%name = name
    pack%is_unique = is_unique
    pack%settled => fresh()
    call settle(name, pack%settled)
    pack%whole => fresh(pack%settled)
    call advance_pack(t, name, pack%whole, together)
    call t%check(pack%whole%report%e8 <= pack%whole%options%solver%tolerance, name//': residual on one rank')
    call t%check(count(any(abs(pack%whole%contacts%impulse(:, :pack%whole%contacts%n)) > 0, 1)) > 30, name//' carry')
    pack%spread = spread_of_orders(pack)
    call on_subdomains(glue_in_every_way)
    deallocate (pack)
  end subroutine test_all

  !> The pack glued in every way, as one of several subdomains: on three split in both, on two and on four in one each, which is the
  !! other one for the next way of gluing and for the other number.
  subroutine glue_in_every_way(comm)
    type(comm_t), intent(inout) :: comm
    character(len=16), allocatable :: gluings(:)
    integer :: g, s

    if (comm%size == 1) return
    gluings = coupling_names()
    do s = 1, size(splits)
      do g = 1, size(gluings)
        if (comm%size /= 3 .and. modulo(s + g + comm%size/2, 2) == 0) cycle
        call compare(comm, pack, trim(gluings(g)), trim(splits(s)))
      end do
    end do
  end subroutine glue_in_every_way

  !> Largest differences of the measures of a run and those of runs on one rank that sweep in other orders.
  function spread_of_orders(pack) result(spread)
    type(pack_t), intent(in) :: pack
    integer, parameter :: orders = 5
    real(wp) :: spread(size(names)), of_whole(size(names))
    type(simulation_t), pointer :: other
    integer :: seed

    of_whole = measures_of(pack%whole)
    spread = 0
    do seed = 1, orders
      other => fresh(pack%settled)
      other%options%solver%order = 'shuffled'
      other%options%solver%order_seed = seed
      call choose_solver(other%options%solver, other%solver)
      call advance_pack(t, pack%name, other, together)
      spread = max(spread, abs(measures_of(other) - of_whole))
    end do
  end function spread_of_orders

  !> What is compared of a run on one rank.
  function measures_of(sim) result(values)
    type(simulation_t), intent(in) :: sim
    real(wp) :: values(size(names))
    type(measures_t) :: measures
    integer :: i

    call measure(sim%scene, sim%contacts, sim%options%time_step, sim%energy, measures)
    do i = 1, size(names)
      values(i) = measures%get(trim(names(i)))
    end do
  end function measures_of

  !> Split the pack at rest, go on, and compare it with the run on one rank.
  subroutine compare(comm, pack, gluing, split)
    type(comm_t), intent(in) :: comm
    type(pack_t), intent(in) :: pack
    character(len=*), intent(in) :: gluing, split
    type(simulation_t), pointer :: part
    type(measures_t) :: of_whole, of_parts
    character(len=:), allocatable :: name
    ! e8 of 1e-6 leaves impulses some hundred times that from the solution on packs this size, which few steps let grow.
    ! Friction lets forces spread in many ways, and a contact that carries next to nothing may count or not: orders of sweeps
    ! on one rank tell by how much. Five of them are a small sample, so twice their largest difference counts, and a contact
    ! that carries next to nothing may be one or not.
    real(wp), parameter :: tolerance = 1e-3_wp
    real(wp) :: contact
    type(error_t), allocatable :: error
    integer :: i

    name = pack%name//', '//gluing//', '//split
    part => fresh(pack%settled)
    part%options%partition%gluing = gluing
    part%options%partition%split = split
    part%options%partition%every = 2
    part%comm = comm
    call decompose(part, error)
    call t%check(.not. allocated(error), name//' is split')
    call part%energy%leave_to_first(part%comm)
    call advance_pack(t, name, part, together)
    call t%equal(part%decomposition%subdomain%splits, 2, name//': is split again')
    call t%check(part%report%e8 <= part%options%solver%tolerance, name//': residual of the whole')
    associate (whole => pack%whole)
      call measure(whole%scene, whole%contacts, whole%options%time_step, whole%energy, of_whole)
      call measure(part%scene, part%contacts, part%options%time_step, part%energy, of_parts, &
                   part%decomposition%subdomain, part%comm)
      contact = 2/real(count(whole%scene%bodies%is_grain), wp)
      do i = 1, size(names)
        ! A pack at rest has no energy and no momentum to compare.
        call t%near(of_parts%get(trim(names(i))), of_whole%get(trim(names(i))), &
                    2*pack%spread(i) + tolerance*max(abs(of_whole%get(trim(names(i)))), 1e-3_wp) + &
                    merge(contact, 0.0_wp, names(i) == 'coordination'), name//': '//trim(names(i)))
      end do
      ! Exactly, except for bodies that tumble: there as well as on one rank.
      call t%near(of_parts%get('energy_closure'), of_whole%get('energy_closure'), &
                  1e-11_wp + 1e-2_wp*of_whole%get('energy_closure'), name//': energy closes')
      call t%equal(part%all_contacts, whole%contacts%n, name//': contacts')
    end associate
    if (pack%is_unique) call compare_contacts(name, part, pack%whole)
  end subroutine compare

  !> Every contact of this rank has the impulse that it has in the run on one rank.
  subroutine compare_contacts(name, part, whole)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(in) :: part, whole
    real(wp), allocatable :: of_pair(:, :)
    real(wp) :: largest
    integer :: k

    allocate (of_pair(whole%scene%contactors%n, whole%scene%contactors%n), source=-1.0_wp)
    largest = 0
    do k = 1, whole%contacts%n
      of_pair(whole%contacts%contactor(1, k), whole%contacts%contactor(2, k)) = normal_impulse(whole%contacts, k)
      largest = max(largest, normal_impulse(whole%contacts, k))
    end do
    do k = 1, part%contacts%n
      associate (pair => part%scene%contactors%id(part%contacts%contactor(:, k)))
        call t%near(normal_impulse(part%contacts, k), of_pair(pair(1), pair(2)), 1e-3_wp*largest, name//': impulse of a contact')
      end associate
    end do
  end subroutine compare_contacts

  !> Read a deck and let it settle on one rank.
  subroutine settle(name, sim)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(comm_t) :: alone

    call start_pack(t, alone, name, pack_deck(name), 1e-3_wp, sim)
    call advance_pack(t, name, sim, settling)
    ! Sweeps over polygons that lie face on face stand above 1e-6 after 20,000 of them, on one rank too.
    sim%options%solver%tolerance = merge(1e-5_wp, 1e-6_wp, index(name, 'polygons') > 0)
    call choose_solver(sim%options%solver, sim%solver)
  end subroutine settle
end program test_gluing
