!> Copies on ranks: all pairs that a search of the whole scene finds exist on exactly one rank, all copies of a body are one
!! body to the last bit, and contacts with their impulses survive a new split. Run on any number of subdomains.
program test_halo
  use fresh_simulations, only: fresh, run_t
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, pack_alone, pack_names
  use sg_bodies, only: bodies_t
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_motion, only: predict
  use sg_neighbour_list, only: neighbours_t
  use sg_neighbours, only: build_neighbours
  use sg_owners, only: contact_owner
  use sg_plan, only: set_radii
  use sg_scene, only: scene_t
  use sg_simulation, only: decompose, simulation_t
  use subdomain_tests, only: on_subdomains
  implicit none

  type(tests_t) :: t
  !> Packs that have fallen together on one rank, from which all numbers of ranks go on; none where this build cannot make one
  type(run_t), save :: fallen(size(pack_names))
  integer :: p

  do p = 1, size(pack_names)
    if (can_be_made(trim(pack_names(p)))) call fall(trim(pack_names(p)), fallen(p)%sim)
  end do
  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm
    integer :: i, lists_kept

    if (comm%size == 1) return
    lists_kept = 0
    do i = 1, size(pack_names)
      if (associated(fallen(i)%sim)) call test_pack(comm, trim(pack_names(i)), fallen(i)%sim, lists_kept)
    end do
    call t%check(lists_kept > size(pack_names), 'copies are kept for many lists')
  end subroutine run_tests

  !> A pack falls together on one rank.
  subroutine fall(name, sim)
    character(len=*), intent(in) :: name
    type(simulation_t), pointer, intent(out) :: sim

    sim => pack_alone(t, name, 1e-3_wp)
    call advance_pack(t, name, sim, 60)
    call t%check(sim%contacts%n > 5, name//': contacts')
  end subroutine fall

  !> A pack that has fallen together is split along x, moves on, and is split along y.
  subroutine test_pack(comm, name, fallen, lists_kept)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(in) :: fallen
    integer, intent(inout) :: lists_kept !! lists of neighbours for which copies were kept
    type(simulation_t), pointer :: sim
    type(scene_t) :: whole
    type(error_t), allocatable :: error

    sim => fresh(fallen)
    whole = sim%scene
    sim%comm = comm
    sim%options%partition%boxes = [comm%size, 1, 1]
    sim%options%partition%imbalance = 1e3_wp
    call decompose(sim, error)
    call t%check(.not. allocated(error), name//' is split')
    call advance_pack(t, name, sim, 3)
    call check_pairs(comm, name//', split', sim, whole)
    call check_copies(comm, name//', split', sim, whole%bodies%n)
    call check_kept_copies(comm, name, sim, whole, lists_kept)
    call split_anew(comm, name, sim, whole)
    call advance_pack(t, name, sim, 3)
    call check_pairs(comm, name//', split again', sim, whole)
    call check_copies(comm, name//', split again', sim, whole%bodies%n)
    call t%equal(sim%decomposition%subdomain%splits, 2, name//': splits')
  end subroutine test_pack

  !> Copies outlast lists of neighbours: those made with kept copies, too, hold every pair.
  subroutine check_kept_copies(comm, name, sim, whole, lists_kept)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(scene_t), intent(in) :: whole
    integer, intent(inout) :: lists_kept
    integer, parameter :: steps = 24
    integer :: builds, serial, kept, renewed, i

    kept = 0
    renewed = 0
    do i = 1, steps
      builds = sim%pairs%builds
      serial = sim%decomposition%subdomain%serial
      call advance_pack(t, name, sim, 1)
      if (sim%decomposition%subdomain%serial > serial) renewed = renewed + 1
      if (sim%pairs%builds == builds .or. sim%decomposition%subdomain%serial > serial) cycle
      kept = kept + 1
      call check_pairs(comm, name//', copies kept', sim, whole)
    end do
    call t%check(kept >= renewed, name//': copies are kept for more lists than they are rebuilt for')
    lists_kept = lists_kept + kept
  end subroutine check_kept_copies

  !> Repartition all grains, across: contacts and their impulses are those before.
  subroutine split_anew(comm, name, sim, whole)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(scene_t), intent(in) :: whole
    type(error_t), allocatable :: error
    real(wp), allocatable :: before(:, :, :), after(:, :, :)
    integer :: k
    logical :: is_rebuilt

    call tabulate(comm, sim, whole%contactors%n, before)
    sim%decomposition%options%boxes = [1, comm%size, 1]
    sim%decomposition%options%every = 1
    call predict(sim%scene, sim%time(), sim%options%time_step, sim%options%theta)
    call sim%decomposition%update(sim%scene, sim%pairs, sim%history, sim%contacts, sim%options%time_step, sim%comm, &
                                  is_rebuilt, error)
    call t%check(is_rebuilt .and. .not. allocated(error), name//' is split again')
    sim%decomposition%options%every = 0
    call set_radii(sim%scene, sim%plan)
    call tabulate(comm, sim, whole%contactors%n, after)
    call t%check(sum(before(:, :, 1)) > 5 .and. any(abs(before(:, :, 3:)) > 0), name//': contacts carry')
    call t%check(.not. any(abs(after - before) > 0), name//': contacts, statuses and impulses are kept')
    do k = 1, sim%contacts%n
      call t%equal(contact_owner(sim%scene%bodies%owner(sim%contacts%body(:, k))), comm%rank, name//': owner of a contact')
    end do
    call t%check(sim%decomposition%subdomain%moved > 0.2_wp*real(count(whole%bodies%is_grain), wp), name//': grains have moved')
  end subroutine split_anew

  !> Contacts of all ranks by pairs of contactors: their number, their statuses weighted by features, and their impulses, added
  !! up as they stand and weighted by features. All contacts of a pair are on one rank, so that sums are exact.
  subroutine tabulate(comm, sim, n, table)
    type(comm_t), intent(inout) :: comm
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n !! contactors of the whole scene
    real(wp), allocatable, intent(out) :: table(:, :, :)
    integer :: k, width
    real(wp), allocatable :: list(:)

    width = sim%contacts%n_components
    allocate (table(n, n, 2 + 2*width), source=0.0_wp)
    do k = 1, sim%contacts%n
      associate (pair => sim%scene%contactors%id(sim%contacts%contactor(:, k)), impulse => sim%contacts%impulse(:, k), &
                 weight => 1 + real(sim%contacts%feature(k), wp))
        table(pair(1), pair(2), :) = table(pair(1), pair(2), :) + [1.0_wp, weight*real(sim%contacts%status(k), wp), impulse, &
                                                                   weight*impulse]
      end associate
    end do
    list = reshape(table, [size(table)])
    call comm%sum(list)
    table(:, :, :) = reshape(list, shape(table))
  end subroutine tabulate

  !> The pairs of all ranks together are those that a search of the whole scene finds, in the state in which they were sought.
  subroutine check_pairs(comm, name, sim, whole)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(scene_t), intent(in) :: whole
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    real(wp), allocatable :: built(:), found(:, :), expected(:, :), list(:)
    integer :: b, width

    ! Configurations, and margins below them.
    width = size(sim%pairs%built, 1) + 1
    allocate (built(width*whole%bodies%n), source=0.0_wp)
    do b = 1, sim%scene%bodies%n_own
      built((sim%scene%bodies%id(b) - 1)*width + 1:sim%scene%bodies%id(b)*width) = [sim%pairs%built(:, b), sim%pairs%margin(b)]
    end do
    call comm%sum(built)
    scene = whole
    found = reshape(built, [width, whole%bodies%n])
    call build_neighbours(pairs, scene, found(:width - 1, :), found(width, :))
    call tabulate_pairs(pairs, [(int(b, i4), b=1, whole%contactors%n)], whole%contactors%n, expected)
    call tabulate_pairs(sim%pairs, sim%scene%contactors%id, whole%contactors%n, found)
    list = reshape(found, [size(found)])
    call comm%sum(list)
    found(:, :) = reshape(list, shape(found))
    call t%check(sum(expected) > 30, name//': pairs')
    call t%check(.not. any(abs(found - expected) > 0), name//': every pair is on one rank')
  end subroutine check_pairs

  !> Number of times that each pair is listed, images told apart.
  subroutine tabulate_pairs(pairs, id, n, table)
    type(neighbours_t), intent(in) :: pairs
    integer(i4), intent(in) :: id(:)
    integer, intent(in) :: n !! contactors of the whole scene
    real(wp), allocatable, intent(out) :: table(:, :)
    integer :: i, image

    allocate (table(n, 9*n), source=0.0_wp)
    do i = 1, pairs%n
      image = 4 + int(pairs%image(i))
      if (allocated(pairs%image_y)) image = image + 3*int(pairs%image_y(i))
      associate (pair => id(pairs%contactor(:, i)))
        table(pair(1), 9*(pair(2) - 1) + 1 + image) = table(pair(1), 9*(pair(2) - 1) + 1 + image) + 1
      end associate
    end do
  end subroutine tabulate_pairs

  !> All copies of a body have the same state, bit by bit, and all bodies have one owner each.
  subroutine check_copies(comm, name, sim, n)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n !! bodies of the whole scene
    real(wp), allocatable :: most(:), least(:), owners(:)
    real(wp) :: copies(1)
    integer :: width, b, at

    width = size(state_bits(sim%scene%bodies, 1))
    allocate (most(width*n), source=-huge(1.0_wp))
    allocate (least(width*n), source=huge(1.0_wp))
    allocate (owners(n), source=0.0_wp)
    associate (bodies => sim%scene%bodies)
      do b = 1, bodies%n
        at = (bodies%id(b) - 1)*width
        most(at + 1:at + width) = state_bits(bodies, b)
        least(at + 1:at + width) = most(at + 1:at + width)
        if (b <= bodies%n_own) owners(bodies%id(b)) = 1
      end do
      copies = real(count(bodies%owner(bodies%n_own + 1:) >= 0), wp)
    end associate
    call comm%maximum(most)
    call comm%minimum(least)
    call comm%sum(owners)
    call comm%sum(copies)
    call t%check(copies(1) > 3, name//': there are copies')
    call t%check(all(nint(owners) == 1), name//': every body has one owner')
    call t%check(.not. any(abs(most - least) > 0), name//': copies are one body')
  end subroutine check_copies

  !> The state of a body, bit by bit, in whole numbers.
  pure function state_bits(bodies, b) result(bits)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: b
    real(wp), allocatable :: bits(:), state(:)

    state = [bodies%position(:, b), bodies%velocity(:, b), real(bodies%crossings(b), wp)]
    if (allocated(bodies%angle)) state = [state, bodies%angle(b)]
    if (allocated(bodies%orientation)) state = [state, bodies%orientation(:, b)]
    bits = real(transfer(state, [0_i4]), wp)
  end function state_bits
end program test_halo
