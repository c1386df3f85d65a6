!> Values that a method carries from step to step, compared with tables of the whole scene: they stay with the copies of bodies and
!! with contacts through new neighbour lists, new splits and checkpoints, also of another number of ranks. Run on any number of
!! subdomains.
!!
!! The methods here are those of runs, and add up what bodies and contacts did: velocities, impulses, steps. Each value is the sum
!! of the same numbers in the same order as in the tables, so all are the same to the last bit.
program test_carried
  use carrying_methods, only: carrying_alone_t, carrying_dual_t
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, pack_deck, start_pack
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_comm, only: comm_t
  use sg_error, only: diagnostics_t, error_t
  use sg_hdf5, only: hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp, i4, i8
  use sg_simulation, only: reserve_carried, simulation_t
  use sg_system, only: make_folder, remove_file
  use sg_text, only: to_text
  use subdomain_tests, only: on_subdomains
  implicit none

  !> What all ranks carry after a step
  type :: ledger_t
    !> Values of the copy of each body on each rank, and has the rank one? shape (width, bodies, 0:ranks-1)
    real(wp), allocatable :: body(:, :, :)
    logical, allocatable :: is_held(:, :)
    !> Owner of each body, -1 of replicated ones
    integer, allocatable :: owner(:)
    !> Contactors, feature and values of each contact, shape (values, contacts)
    real(wp), allocatable :: contact(:, :)
  end type ledger_t

  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call test_pack(comm, 'disks')
    call test_pack(comm, 'pressed disks')
    call test_pack(comm, 'spheres')
  end subroutine run_tests

  !> Steps with new splits, then checkpoints.
  subroutine test_pack(comm, name)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim
    type(ledger_t) :: before, after
    integer :: step, n_bodies, moved

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, sim)
    call advance_pack(t, name, sim, 100)
    n_bodies = sim%scene%bodies%n
    call t%equal(sim%scene%bodies%n_carried + sim%contacts%n_carried, 0, name//': no method asks for room')
    call t%check(.not. (allocated(sim%scene%bodies%carried) .or. allocated(sim%contacts%carried)), name//': and none has any')
    call carry_on(sim, comm)
    sim%options%partition%boxes = [comm%size, 1, 1]
    call split(name, sim)
    call write_ledger(sim, n_bodies, before)
    moved = 0
    do step = 1, 8
      sim%decomposition%options%every = 2
      sim%decomposition%options%boxes = merge([comm%size, 1, 1], [1, comm%size, 1], modulo(step/2, 2) == 0)
      call advance_pack(t, name, sim, 1)
      call write_ledger(sim, n_bodies, after)
      moved = moved + count(after%owner /= before%owner)
      call check_bodies(name, sim, before, after, 1.0_wp)
      call check_contacts(name, sim, before)
      before = after
    end do
    if (comm%size > 1) call t%check(moved > 0, name//': bodies change their owners')
    if (comm%size > 1) call t%check(sim%decomposition%subdomain%splits > 4, name//': new splits')
    call t%check(any(abs(after%body) > 0) .and. maxval(after%contact(size(after%contact, 1), :)) > 7.5_wp, name//': values grow')
    if (hdf5_is_available() .and. (hdf5_is_parallel() .or. comm%size == 1)) call test_checkpoints(comm, name, sim, n_bodies, after)
  end subroutine test_pack

  !> Let the method of a run carry values.
  subroutine carry_on(sim, ranks)
    type(simulation_t), intent(inout) :: sim
    type(comm_t), intent(in) :: ranks !! those of the run from now on
    type(carrying_alone_t), allocatable :: alone
    type(carrying_dual_t), allocatable :: dual

    sim%comm = ranks
    if (allocated(sim%solver)) deallocate (sim%solver)
    if (ranks%size == 1) then
      allocate (alone)
      alone%options = sim%options%solver
      call move_alloc(alone, sim%solver)
    else
      allocate (dual)
      dual%options = sim%options%solver
      dual%partition = sim%options%partition
      call move_alloc(dual, sim%solver)
    end if
    sim%solver%carried_velocities = 1
    sim%solver%carried_impulses = 2
    call reserve_carried(sim)
  end subroutine carry_on

  !> Split over the ranks as `decompose` does, which would choose the solver of the deck again.
  subroutine split(name, sim)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable :: error

    if (sim%comm%size == 1) return
    call sim%decomposition%begin(sim%scene, sim%contacts, sim%step > 0, sim%options%partition, sim%comm, error)
    call t%check(.not. allocated(error), name//': a split')
    if (allocated(sim%pairs%built)) deallocate (sim%pairs%built)
    sim%pairs%rank = sim%comm%rank
    sim%contacts%n = 0
  end subroutine split

  !> Collect what all ranks carry.
  subroutine write_ledger(sim, n_bodies, ledger)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n_bodies
    type(ledger_t), intent(out) :: ledger
    real(wp), allocatable :: list(:)
    integer, allocatable :: flags(:)
    integer(i8) :: first, all
    integer :: b, k, id

    associate (bodies => sim%scene%bodies, contacts => sim%contacts, ranks => sim%comm)
      allocate (ledger%body(bodies%n_carried, n_bodies, 0:ranks%size - 1), source=0.0_wp)
      allocate (ledger%is_held(n_bodies, 0:ranks%size - 1), source=.false.)
      allocate (ledger%owner(n_bodies), source=-1)
      do b = 1, bodies%n
        id = number_of(bodies%id, b)
        ledger%body(:, id, ranks%rank) = bodies%carried(:, b)
        ledger%is_held(id, ranks%rank) = .true.
        if (ranks%size == 1) ledger%owner(id) = 0
        if (ranks%size > 1 .and. b <= bodies%n_own) ledger%owner(id) = bodies%owner(b)
      end do
      call ranks%maximum(ledger%owner)
      list = reshape(ledger%body, [size(ledger%body)])
      call ranks%sum(list)
      ledger%body = reshape(list, shape(ledger%body))
      flags = merge(1, 0, reshape(ledger%is_held, [size(ledger%is_held)]))
      call ranks%sum(flags)
      ledger%is_held = reshape(flags > 0, shape(ledger%is_held))
      call ranks%before(int(contacts%n, i8), first, all)
      allocate (ledger%contact(3 + contacts%n_carried, all), source=0.0_wp)
      do k = 1, contacts%n
        ledger%contact(:, int(first) + k) = [key_of(sim, k), contacts%carried(:, k)]
      end do
      list = reshape(ledger%contact, [size(ledger%contact)])
      call ranks%sum(list)
      ledger%contact = reshape(list, shape(ledger%contact))
    end associate
  end subroutine write_ledger

  !> Contactors and feature of a contact, in the numbers of the whole scene.
  function key_of(sim, k) result(key)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: k
    real(wp) :: key(3)
    integer :: side

    do side = 1, 2
      key(side) = real(number_of(sim%scene%contactors%id, int(sim%contacts%contactor(side, k))), wp)
    end do
    key(3) = real(sim%contacts%feature(k), wp)
  end function key_of

  !> Number in the whole scene.
  pure integer function number_of(id, item) result(number)
    integer(i4), allocatable, intent(in) :: id(:)
    integer, intent(in) :: item

    number = item
    if (allocated(id)) number = id(item)
  end function number_of

  !> A copy goes on with the values of its rank; a new owner with those of the former one, if its rank held none; others start at
  !! zero. After a step the velocity is added.
  subroutine check_bodies(name, sim, before, after, share)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(in) :: sim
    type(ledger_t), intent(in) :: before, after
    real(wp), intent(in) :: share !! 1 where a step was done, else 0
    real(wp) :: wanted(sim%scene%bodies%n_carried)
    integer :: b, id

    associate (bodies => sim%scene%bodies, rank => sim%comm%rank)
      do b = 1, bodies%n
        id = number_of(bodies%id, b)
        wanted = 0
        if (before%is_held(id, rank)) then
          wanted = before%body(:, id, rank)
        else if (after%owner(id) == rank) then
          wanted = before%body(:, id, before%owner(id))
        end if
        if (share > 0) wanted = wanted + sim%problem%body(:size(wanted), sim%pairs%slot_of(b))
        call t%check(all(abs(bodies%carried(:, b) - wanted) <= 0), name//': values of a copy')
      end do
    end associate
  end subroutine check_bodies

  !> A contact of the last step goes on with its values, a new one starts at zero; the impulse and one step are added.
  subroutine check_contacts(name, sim, before)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(in) :: sim
    type(ledger_t), intent(in) :: before
    integer :: k, j

    do k = 1, sim%contacts%n
      do j = 1, size(before%contact, 2)
        if (all(abs(before%contact(:3, j) - key_of(sim, k)) <= 0)) exit
      end do
      associate (now => sim%contacts%carried(:, k), added => [sim%problem%impulse(:, k), 1 + 0*sim%problem%impulse(:, k)])
        if (j > size(before%contact, 2)) then
          call t%check(all(abs(now - added) <= 0), name//': values of a new contact')
        else
          call t%check(all(abs(now - (before%contact(4:, j) + added)) <= 0), name//': values of a contact')
        end if
      end associate
    end do
  end subroutine check_contacts

  !> Checkpoints of all ranks, read by all, by each alone, and without columns; and one that a rank alone has written, read by all.
  subroutine test_checkpoints(comm, name, sim, n_bodies, ledger)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n_bodies
    type(ledger_t), intent(in) :: ledger
    type(simulation_t), pointer :: again, alone, other
    type(ledger_t) :: owned
    type(comm_t) :: single
    type(error_t), allocatable :: error

    other => fresh()
    owned = at_owners(comm, ledger)
    call save(comm, name//'_all', sim)
    call go_on(comm, name, name//'_all', comm, n_bodies, owned, again)
    call go_on(comm, name, name//'_all', single, n_bodies, owned, alone)
    call save(comm, name//'_'//to_text(comm%rank), alone)
    call write_ledger(alone, n_bodies, owned)
    call go_on(comm, name, name//'_0', comm, n_bodies, owned, again)
    ! A method that carries nothing reads the same file, and one that carries values reads a file without any.
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, other)
    call load(name//'_all', other, error)
    call t%check(.not. (allocated(error) .or. allocated(other%scene%bodies%carried)), name//': values that no method asks for')
    call save(comm, name//'_'//to_text(comm%rank), other)
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, other)
    call carry_on(other, single)
    call load(name//'_'//to_text(comm%rank), other, error)
    call t%check(.not. allocated(error) .and. all(abs(other%scene%bodies%carried) <= 0), name//': a file without values')
    call t%check(all(abs(other%contacts%carried) <= 0), name//': a file without values of contacts')
  end subroutine test_checkpoints

  !> Read a checkpoint by some ranks, compare, and go on for a step.
  subroutine go_on(comm, name, folder, ranks, n_bodies, owned, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name, folder
    type(comm_t), intent(in) :: ranks
    integer, intent(in) :: n_bodies
    type(ledger_t), intent(in) :: owned
    type(simulation_t), pointer, intent(out) :: sim
    type(ledger_t) :: before, after
    type(error_t), allocatable :: error
    integer :: last

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, sim)
    call carry_on(sim, ranks)
    call load(folder, sim, error)
    call t%check(.not. allocated(error), name//': a checkpoint is read')
    call split(name, sim)
    before = owned
    call spread_owned(sim, n_bodies, owned, before)
    call advance_pack(t, name, sim, 1)
    call write_ledger(sim, n_bodies, after)
    call check_bodies(name//' from '//folder, sim, before, after, 1.0_wp)
    call check_contacts(name//' from '//folder, sim, before)
    last = size(after%contact, 1)
    call t%check(count(before%contact(last, :) > 1.5_wp) <= count(after%contact(last, :) > 2.5_wp) + size(before%contact, 2)/4, &
                 name//': contacts go on')
  end subroutine go_on

  !> Of a file, each body's values belong to the rank that counts it as its own; to it alone.
  subroutine spread_owned(sim, n_bodies, owned, before)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n_bodies
    type(ledger_t), intent(in) :: owned
    type(ledger_t), intent(inout) :: before
    integer :: b, id, flags(n_bodies)

    if (allocated(before%body)) deallocate (before%body, before%is_held)
    allocate (before%body(size(owned%body, 1), n_bodies, 0:sim%comm%size - 1), source=0.0_wp)
    allocate (before%is_held(n_bodies, 0:sim%comm%size - 1), source=.false.)
    before%owner = 0*owned%owner
    flags = 0
    do b = 1, sim%scene%bodies%n_own
      id = number_of(sim%scene%bodies%id, b)
      before%is_held(id, sim%comm%rank) = .true.
      before%body(:, id, sim%comm%rank) = owned%body(:, id, 0)
      flags(id) = flags(id) + 1
    end do
    call sim%comm%sum(flags)
    call t%check(all(flags == 1), 'each body is counted once')
  end subroutine spread_owned

  !> The values that files hold: of each body those of its owner, of a replicated one those of the rank that counts it.
  function at_owners(comm, ledger) result(owned)
    type(comm_t), intent(inout) :: comm
    type(ledger_t), intent(in) :: ledger
    type(ledger_t) :: owned
    integer :: b, rank

    owned = ledger
    deallocate (owned%body)
    allocate (owned%body(size(ledger%body, 1), size(ledger%owner), 0:0))
    do b = 1, size(ledger%owner)
      rank = ledger%owner(b)
      if (rank < 0) rank = modulo(b, comm%size)
      owned%body(:, b, 0) = ledger%body(:, b, rank)
    end do
  end function at_owners

  !> Write a checkpoint into a folder.
  subroutine save(comm, folder, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: folder
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable :: error

    sim%options%folder = folder
    call t%check(make_folder(folder), 'a folder')
    if (sim%comm%rank == 0) call remove_file(folder//'/restart_a.h5')
    if (sim%comm%rank == 0) call remove_file(folder//'/restart_b.h5')
    if (comm%any(.false.)) return
    call save_checkpoint(sim, error)
    call t%check(.not. allocated(error), 'a checkpoint is written')
    if (allocated(error)) write (*, '(a)') error%report()
    if (comm%any(.false.)) return
  end subroutine save

  !> Read a checkpoint.
  subroutine load(folder, sim, error)
    character(len=*), intent(in) :: folder
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(diagnostics_t) :: warnings

    call load_checkpoint(sim, folder//'/restart_a.h5', warnings, error)
    if (allocated(error)) write (*, '(a)') error%report()
  end subroutine load
end program test_carried
