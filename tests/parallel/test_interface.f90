!> The interface of each rank compared with tables of the whole scene: sharers, multiplicities and interface contacts, sums over all
!! copies to the last bit, and W_Gamma with H^T M^-1 H built column by column. Run on any number of subdomains; one rank has no
!! interface, and there all contacts are the rows of W.
program test_interface
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_error, only: error_t
  use sg_interface, only: interface_t
  use sg_interface_blocks, only: interface_blocks_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_problem_records, only: contact_of, contact_record_t
  use sg_random, only: random_t
  use sg_records, only: first_inverse, impulse_length
  use sg_simulation, only: decompose, simulation_t
  use sg_subdomain, only: subdomain_t
  use subdomain_tests, only: on_subdomains
  implicit none
  !> Rounding of sums of some ten products, over the largest of them
  real(wp), parameter :: rounding = 1e-13_wp
  !> One of so many rows has an impulse: each costs a sum over ranks
  integer, parameter :: one_of = 3

  !> The problem of a step and tables of the whole scene
  type :: case_t
    character(len=:), allocatable :: name
    type(problem_t) :: problem
    type(subdomain_t) :: coupling
    !> Number and owner of the body of each slot; bodies of the scene, components of a velocity
    integer, allocatable :: id(:), owner(:)
    integer :: n_bodies = 0, width = 0
    !> Has a rank a contact on a body? shape (bodies, 0:ranks-1)
    logical, allocatable :: touches(:, :)
  end type case_t

  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call test_pack(comm, 'frictionless disks')
    call test_pack(comm, 'disks')
    call test_pack(comm, 'pressed disks')
    call test_pack(comm, 'polygons')
    call test_pack(comm, 'spheres')
    call test_pack(comm, 'frictionless spheres')
    if (can_be_made('polyhedra')) call test_pack(comm, 'polyhedra')
  end subroutine run_tests

  !> A pack at rest, split along x and again along y.
  subroutine test_pack(comm, name)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    integer :: n_bodies

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, sim)
    call advance_pack(t, name, sim, 120)
    n_bodies = sim%scene%bodies%n
    if (comm%size == 1) then
      call test_alone(comm, name, sim)
      return
    end if
    sim%comm = comm
    sim%options%partition%boxes = [comm%size, 1, 1]
    call decompose(sim, error)
    call advance_pack(t, name, sim, 2)
    call test_split(comm, name//', split', sim, n_bodies)
    sim%decomposition%options%boxes = [1, comm%size, 1]
    sim%decomposition%options%every = 1
    call test_split(comm, name//', split again', sim, n_bodies)
  end subroutine test_pack

  !> The blocks of all contacts of one rank.
  subroutine test_alone(comm, name, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(case_t) :: one
    type(interface_blocks_t) :: blocks
    integer :: k

    one%name = name
    call next_problem(sim, one%problem)
    one%width = first_inverse(one%problem%kind) - 1
    one%id = [(k, k=1, one%problem%n_bodies)]
    one%n_bodies = size(one%id)
    call blocks%build(one%problem, [(k, k=1, one%problem%n_contacts)])
    call compare_blocks(comm, one, blocks)
  end subroutine test_alone

  !> The interface of the next step.
  subroutine test_split(comm, name, sim, n_bodies)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n_bodies
    type(case_t) :: one
    type(interface_t) :: interface
    type(interface_blocks_t) :: blocks
    integer :: k, shared

    one%name = name
    one%n_bodies = n_bodies
    call next_problem(sim, one%problem)
    one%width = first_inverse(one%problem%kind) - 1
    one%coupling = sim%decomposition%subdomain%by_slot(sim%pairs%slot_of)
    one%id = int(sim%scene%bodies%id(sim%pairs%body_of))
    one%owner = int(sim%scene%bodies%owner(sim%pairs%body_of))
    allocate (one%touches(n_bodies, 0:comm%size - 1), source=.false.)
    do k = 1, one%problem%n_contacts
      one%touches(one%id(one%problem%pair(:, k)), comm%rank) = .true.
    end do
    call share_table(comm, one%touches)
    associate (problem => one%problem)
      call interface%find(problem%pair(:, :problem%n_contacts), problem%body(:, :problem%n_bodies), one%width, one%coupling, comm)
    end associate
    shared = interface%n_shared
    call comm%sum(shared)
    call t%check(shared > 0, name//': bodies are shared')
    call check_sharers(comm, one, interface)
    call check_contacts(comm, one, interface)
    call interface%prepare_sums(one%coupling, comm)
    call check_sums(comm, one, interface)
    call blocks%build(one%problem, interface%contact)
    call blocks%couple(interface)
    call compare_blocks(comm, one, blocks, interface)
  end subroutine test_split

  !> Combine the tables of all ranks.
  subroutine share_table(comm, table)
    type(comm_t), intent(inout) :: comm
    logical, intent(inout) :: table(:, :)
    integer, allocatable :: flags(:)

    flags = merge(1, 0, reshape(table, [size(table)]))
    call comm%sum(flags)
    table = reshape(flags > 0, shape(table))
  end subroutine share_table

  !> Shared bodies are those that several ranks touch, or that all hold and impulses can move; sharers stand in the message lists.
  subroutine check_sharers(comm, one, interface)
    type(comm_t), intent(inout) :: comm
    type(case_t), intent(in) :: one
    type(interface_t), intent(in) :: interface
    logical :: is_listed(size(one%id)), is_wanted(size(one%id)), shares(0:comm%size - 1)
    integer :: i, j, s

    do s = 1, size(one%id)
      associate (ranks => one%touches(one%id(s), :))
        is_wanted(s) = one%owner(s) >= 0 .and. one%touches(one%id(s), comm%rank) .and. count(ranks) > 1
        if (one%owner(s) < 0) is_wanted(s) = any(one%problem%body(one%width + 1:, s) > 0)
      end associate
    end do
    is_listed = .false.
    is_listed(interface%slot) = .true.
    call t%check(all(is_listed .eqv. is_wanted) .and. count(is_wanted) == size(interface%slot), &
                 one%name//': shared bodies, each once')
    do i = 1, size(interface%slot)
      associate (ranks => one%touches(one%id(interface%slot(i)), :))
        call t%equal(interface%multiplicity(i), count(ranks), one%name//': multiplicity')
        if (i > interface%n_shared) cycle
        shares = .false.
        shares(comm%rank) = .true.
        do j = 1, size(one%coupling%neighbour)
          associate (sums => interface%sums)
            if (any(sums%item(sums%first(j):sums%first(j + 1) - 1) == i)) shares(one%coupling%neighbour(j)) = .true.
          end associate
        end do
        call t%check(all(shares .eqv. ranks), one%name//': sharers')
      end associate
    end do
  end subroutine check_sharers

  !> Interface contacts touch a shared body; those between two subdomains touch bodies of two owners.
  subroutine check_contacts(comm, one, interface)
    type(comm_t), intent(inout) :: comm
    type(case_t), intent(in) :: one
    type(interface_t), intent(in) :: interface
    integer :: k, n, between

    n = 0
    between = 0
    do k = 1, one%problem%n_contacts
      associate (slot => one%problem%pair(:, k))
        if (.not. (any(interface%slot == slot(1)) .or. any(interface%slot == slot(2)))) cycle
        n = n + 1
        if (n > size(interface%contact)) cycle
        call t%equal(interface%contact(n), k, one%name//': interface contact')
        call t%check(interface%is_between(n) .eqv. (all(one%owner(slot) >= 0) .and. one%owner(slot(1)) /= one%owner(slot(2))), &
                     one%name//': between grains of two subdomains')
        if (interface%is_between(n)) between = between + 1
      end associate
    end do
    call t%equal(size(interface%contact), n, one%name//': interface contacts')
    call comm%sum(between)
    call t%check(between > 0, one%name//': contacts between subdomains')
  end subroutine check_contacts

  !> Sums over copies of whole numbers are exact, those of real numbers the same on all ranks; balanced values add up to nothing.
  subroutine check_sums(comm, one, interface)
    type(comm_t), intent(inout) :: comm
    type(case_t), intent(in) :: one
    type(interface_t), intent(inout) :: interface
    type(random_t) :: random
    real(wp), allocatable :: values(:, :), sums(:, :), table(:, :)
    real(wp) :: largest
    integer :: i, c

    call random%seed(7 + comm%rank)
    allocate (values(one%width, size(interface%slot)), source=0.0_wp)
    do i = 1, size(interface%slot)
      if (one%touches(one%id(interface%slot(i)), comm%rank)) &
        values(:, i) = [(anint(random%uniform(-1000.0_wp, 1000.0_wp)), c=1, one%width)]
    end do
    sums = values
    call interface%sum(sums, comm)
    table = table_of(comm, one, interface, values)
    call t%check(all(abs(sums - table(:, one%id(interface%slot))) <= 0), one%name//': sums over sharers')
    values = values/3
    largest = 0
    if (size(values) > 0) largest = maxval(abs(values))
    call comm%maximum(largest)
    sums = values
    call interface%balance(values, comm)
    call t%check(maxval([0.0_wp, abs(values - sums)]) > 0 .or. size(values) == 0, one%name//': a mean is taken off')
    ! A replicated body without contacts here has no copy that takes part.
    do i = 1, size(interface%slot)
      if (.not. one%touches(one%id(interface%slot(i)), comm%rank)) values(:, i) = 0
    end do
    table = table_of(comm, one, interface, values)
    call t%check(all(abs(table) <= 16*epsilon(1.0_wp)*largest), one%name//': balanced values')
  end subroutine check_sums

  !> Sums by body over the copies of all ranks.
  function table_of(comm, one, interface, values) result(table)
    type(comm_t), intent(inout) :: comm
    type(case_t), intent(in) :: one
    type(interface_t), intent(in) :: interface
    real(wp), intent(in) :: values(:, :)
    real(wp), allocatable :: table(:, :), list(:)

    allocate (table(one%width, one%n_bodies), source=0.0_wp)
    table(:, one%id(interface%slot)) = values
    list = reshape(table, [size(table)])
    call comm%sum(list)
    table = reshape(list, shape(table))
  end function table_of

  !> Columns of W by unit impulses on some rows one after the other, of one rank after the other.
  subroutine compare_blocks(comm, one, blocks, interface)
    type(comm_t), intent(inout) :: comm
    type(case_t), intent(in) :: one
    type(interface_blocks_t), intent(in) :: blocks
    type(interface_t), intent(inout), optional :: interface
    type(random_t) :: random
    real(wp), allocatable :: r(:, :), v(:, :), wanted(:, :), column(:, :)
    real(wp) :: scale, unit(impulse_length(one%problem%kind))
    integer :: rank, j, c, rows, far

    call t%equal(blocks%d, impulse_length(one%problem%kind), one%name//': components')
    call random%seed(11 + comm%rank)
    rows = size(blocks%contact)
    allocate (r(blocks%d, rows), v(blocks%d, rows), wanted(blocks%d, rows))
    wanted = 0
    far = 0
    scale = maxval([0.0_wp, abs(blocks%block)])
    call comm%maximum(scale)
    r = 0
    do j = 1, rows, one_of
      r(:, j) = [(random%uniform(-1.0_wp, 1.0_wp), c=1, blocks%d)]
    end do
    do rank = 0, comm%size - 1
      rows = size(blocks%contact)
      call comm%broadcast(rows, rank)
      do j = 1, rows, one_of
        do c = 1, blocks%d
          unit = 0
          unit(c) = 1
          if (comm%rank == rank) call unit_column(comm, one, blocks, j, unit, column)
          if (comm%rank /= rank) call unit_column(comm, one, blocks, 0, unit, column)
          if (comm%rank == rank) call check_column(one, blocks, j, c, column, scale)
          if (comm%rank == rank) unit = r(:, j)
          call comm%broadcast(unit, rank)
          wanted = wanted + unit(c)*column
          if (comm%rank /= rank .and. any(abs(column) > 0)) far = far + 1
        end do
      end do
    end do
    if (present(interface)) then
      call comm%sum(far)
      call t%check(far > 0, one%name//': ranks are coupled through shared bodies')
      call blocks%multiply_shared(interface, r, v, comm)
    else
      call blocks%multiply(r, v)
    end if
    call t%check(all(abs(v - wanted) <= rounding*scale*real(size(r) + 1, wp)), one%name//': product with W')
  end subroutine compare_blocks

  !> What a unit impulse on a row of one rank does to the rows of this rank; row 0 where another rank has it.
  subroutine unit_column(comm, one, blocks, row, unit, column)
    type(comm_t), intent(inout) :: comm
    type(case_t), intent(in) :: one
    type(interface_blocks_t), intent(in) :: blocks
    integer, intent(in) :: row
    real(wp), intent(in) :: unit(:)
    real(wp), allocatable, intent(out) :: column(:, :)
    type(problem_t) :: problem
    type(contact_record_t) :: contact
    real(wp) :: table(one%width, one%n_bodies), list(one%width*one%n_bodies)
    integer :: i, s, side

    problem = one%problem
    problem%body(:one%width, :) = 0
    problem%impulse = 0
    if (row > 0) then
      contact = contact_of(problem, blocks%contact(row))
      problem%impulse(:, blocks%contact(row)) = unit
      ! In space records hold vectors in the world's axes.
      if (size(unit) == 3) problem%impulse(:, blocks%contact(row)) = matmul(unit, contact%h(:, :3, 1))
    end if
    call add_impulses(problem)
    table = 0
    do s = 1, problem%n_bodies
      table(:, one%id(s)) = problem%body(:one%width, s)
    end do
    list = reshape(table, [size(table)])
    call comm%sum(list)
    table = reshape(list, shape(table))
    allocate (column(blocks%d, size(blocks%contact)), source=0.0_wp)
    do i = 1, size(blocks%contact)
      contact = contact_of(problem, blocks%contact(i))
      do side = 1, 2
        column(:, i) = column(:, i) + matmul(contact%h(:blocks%d, :one%width, side), &
                                              table(:, one%id(problem%pair(side, blocks%contact(i)))))
      end do
    end do
  end subroutine unit_column

  !> The blocks of one column on the rank that has its contact.
  subroutine check_column(one, blocks, j, c, column, scale)
    type(case_t), intent(in) :: one
    type(interface_blocks_t), intent(in) :: blocks
    integer, intent(in) :: j, c
    real(wp), intent(in) :: column(:, :), scale
    real(wp) :: found(blocks%d)
    integer :: i, e

    do i = 1, size(blocks%contact)
      found = 0
      do e = blocks%first(i), blocks%first(i + 1) - 1
        if (blocks%column(e) == j) found = found + blocks%block(:, c, e)
      end do
      call t%check(all(abs(found - column(:, i)) <= rounding*scale), one%name//': a block of W')
    end do
    call t%equal(blocks%column(blocks%first(j)), j, one%name//': the diagonal block is the first of its row')
  end subroutine check_column
end program test_interface
