!> The dual method beside its explicit form: with masses divided, gluing by the mean velocity is the update of stored F_Gamma.
!!
!! The explicit form keeps F_Gamma for every copy of a shared body. A round finds the velocities of copies from nothing,
!! V = V_free + M_c^-1 (H r_c + F_c), sweeps, and updates X F_Gamma = sum A M_E^-1 (R_E + R_E^d). Here all copies have one
!! mass M_c and one free velocity, so that this is F_c = mean of all H r_c, less one's own. Shared bodies and sums over
!! their copies are found by tables of the whole scene, apart from the lists of the solver. Run on any number of subdomains.
program test_dual
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_contact_sets, only: contact_sets_t, inner_set, shared_set
  use sg_delassus, only: share_mass
  use sg_dual, only: dual_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: arm_frictional, ball_frictional, first_inverse, round_frictional, solid_frictional
  use sg_report, only: report_t
  use sg_run_options, only: criterion_quad
  use sg_simulation, only: decompose, simulation_t
  use subdomain_tests, only: on_subdomains
  implicit none

  !> Bodies that several ranks have contacts on, and the gluing impulses of their copies here
  type :: explicit_t
    !> Slot and number of each body of this rank that is shared, and the ranks that have contacts on it
    integer, allocatable :: slot(:), id(:), parts(:)
    !> F_Gamma of the copies here [N s, N m s], shape (width, shared)
    real(wp), allocatable :: force(:, :)
    !> Velocities without contacts by slot
    real(wp), allocatable :: free(:, :)
    integer :: width = 0, all_bodies = 0
  end type explicit_t

  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call test_pack(comm, 'disks', round_frictional)
    call test_pack(comm, 'pressed disks', round_frictional)
    call test_pack(comm, 'polygons', arm_frictional)
    call test_pack(comm, 'spheres', ball_frictional)
    if (can_be_made('polyhedra')) call test_pack(comm, 'polyhedra', solid_frictional)
  end subroutine run_tests

  !> Compare both forms in a pack split along x, and again when it has been split along y.
  subroutine test_pack(comm, name, kind)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    integer, intent(in) :: kind !! of problem
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    integer :: n_bodies

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, sim)
    call advance_pack(t, name, sim, 150)
    call t%equal(sim%problem%kind, kind, name//': kind of problem')
    if (comm%size == 1) return
    n_bodies = sim%scene%bodies%n
    sim%comm = comm
    sim%options%partition%boxes = [comm%size, 1, 1]
    call decompose(sim, error)
    call advance_pack(t, name, sim, 2)
    call compare_all(comm, name//', split', sim, n_bodies)
    sim%decomposition%options%boxes = [1, comm%size, 1]
    sim%decomposition%options%every = 1
    call compare_all(comm, name//', split again', sim, n_bodies)
    call t%equal(sim%decomposition%subdomain%splits, 2, name//': splits')
  end subroutine test_pack

  !> One, two and five sweeps per gluing, and another number on each rank.
  subroutine compare_all(comm, name, sim, n_bodies)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n_bodies
    type(problem_t) :: problem

    call next_problem(sim, problem)
    call compare(comm, name//', 1 sweep a gluing', sim, problem, [1], 6, n_bodies)
    call compare(comm, name//', 2 sweeps', sim, problem, [2], 4, n_bodies)
    call compare(comm, name//', 5 sweeps', sim, problem, [5], 3, n_bodies)
    call compare(comm, name//', sweeps by rank', sim, problem, [3, 1, 4, 2], 3, n_bodies)
  end subroutine compare_all

  !> Both forms after some gluings: velocities, impulses and F_Gamma agree, and F_Gamma of all copies vanish together.
  subroutine compare(comm, name, sim, problem, sweeps, gluings, n_bodies)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: sweeps(:) !! of each rank between two gluings; one number for all
    integer, intent(in) :: gluings, n_bodies
    ! Rounding of some ten sweeps; where contacts slide or open, a sweep may make it grow.
    real(wp), parameter :: rounding = 1e-10_wp
    type(dual_t) :: dual
    type(problem_t) :: glued, plain
    type(explicit_t) :: explicit
    type(report_t) :: report
    real(wp), allocatable :: force(:, :), sums(:)
    real(wp) :: largest(3)
    integer :: i, round

    allocate (dual%partition%sweeps, source=sweeps)
    if (size(sweeps) > 1) dual%partition%sweeps = sweeps(:comm%size)
    dual%options = sim%options%solver
    dual%options%maximum_sweeps = gluings*dual%partition%most_sweeps()
    dual%options%check_every = dual%options%maximum_sweeps + 1
    dual%options%criterion = criterion_quad ! all contacts are visited
    glued = problem
    call dual%solve(glued, sim%decomposition%subdomain%by_slot(sim%pairs%slot_of), sim%comm, report)
    call t%equal(report%gluings, gluings, name//': gluings')

    plain = problem
    call explicit_form(comm, sim, dual%partition%sweeps_of(comm%rank), gluings, n_bodies, plain, explicit)
    associate (n => problem%n_contacts, w => explicit%width)
      largest = 0
      if (n > 0) largest(1) = maxval(abs(plain%impulse(:, :n)))
      largest(2) = maxval(abs(plain%body(:w, :problem%n_bodies)))
      if (size(explicit%slot) > 0) largest(3) = maxval(abs(explicit%force))
      call comm%maximum(largest)
      call t%check(largest(3) > 1e-3_wp*largest(1), name//': gluing impulses carry')
      call t%check(all(abs(glued%impulse(:, :n) - plain%impulse(:, :n)) <= rounding*largest(1)), name//': impulses')
      call t%check(all(abs(glued%body(:w, explicit%slot) - plain%body(:w, explicit%slot)) <= rounding*largest(2)), &
                   name//': velocities of shared bodies')
      do i = 1, n
        call t%check(all(abs(glued%body(:w, problem%pair(:, i)) - plain%body(:w, problem%pair(:, i))) <= rounding*largest(2)), &
                     name//': velocities of bodies of a contact')
      end do
    end associate
    call glued_forces(dual, problem, explicit, force)
    call t%check(all(abs(force - explicit%force) <= rounding*largest(3)), name//': what gluing adds is F_Gamma')
    allocate (sums(explicit%width*n_bodies), source=0.0_wp)
    do i = 1, size(explicit%slot)
      round = (explicit%id(i) - 1)*explicit%width
      sums(round + 1:round + explicit%width) = force(:, i)
    end do
    call comm%sum(sums)
    call t%check(all(abs(sums) <= rounding*largest(3)), name//': F_Gamma of all copies of a body vanish together')
  end subroutine compare

  !> Rounds of the explicit form: velocities, sweeps, F_Gamma.
  subroutine explicit_form(comm, sim, sweeps, gluings, n_bodies, problem, explicit)
    type(comm_t), intent(inout) :: comm
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: sweeps, gluings, n_bodies
    type(problem_t), intent(inout) :: problem
    type(explicit_t), intent(out) :: explicit
    type(contact_sets_t) :: sets
    type(report_t) :: report
    logical :: is_shared(problem%n_bodies)
    integer :: i, k, round

    explicit%all_bodies = n_bodies
    call find_shared(comm, sim, problem, explicit)
    is_shared = .false.
    is_shared(explicit%slot) = .true.
    do i = 1, size(explicit%slot)
      call share_mass(problem%kind, explicit%parts(i), problem%body(:, explicit%slot(i)))
    end do
    call sets%begin(problem, sim%options%solver)
    call sets%split(problem, [(merge(shared_set, inner_set, any(is_shared(problem%pair(:, k)))), k=1, problem%n_contacts)], 2, &
                    .true., explicit%slot)
    call sets%arrange(problem)
    call update_forces(comm, problem, explicit)
    do round = 1, gluings
      call set_velocities(problem, explicit)
      do i = 1, sweeps
        call sets%sweep(shared_set, problem, sim%options%solver%relaxation, report)
        call sets%sweep(inner_set, problem, sim%options%solver%relaxation, report)
      end do
      call sets%give_impulses(problem)
      call update_forces(comm, problem, explicit)
    end do
    call set_velocities(problem, explicit)
  end subroutine explicit_form

  !> Find the bodies on which several ranks have contacts and which impulses can move; walls are swept with them in any case.
  subroutine find_shared(comm, sim, problem, explicit)
    type(comm_t), intent(inout) :: comm
    type(simulation_t), intent(in) :: sim
    type(problem_t), intent(in) :: problem
    type(explicit_t), intent(inout) :: explicit
    real(wp) :: ranks(explicit%all_bodies)
    logical :: is_touched(problem%n_bodies)
    integer :: k, s

    is_touched = .false.
    do k = 1, problem%n_contacts
      is_touched(problem%pair(:, k)) = .true.
    end do
    explicit%width = first_inverse(problem%kind) - 1
    associate (id => sim%scene%bodies%id(sim%pairs%body_of))
      ranks = 0
      ranks(id) = merge(1.0_wp, 0.0_wp, is_touched)
      call comm%sum(ranks)
      explicit%slot = pack([(s, s=1, problem%n_bodies)], &
                           [(is_touched(s) .and. any(problem%body(explicit%width + 1:, s) > 0) .and. &
                             (nint(ranks(id(s))) > 1 .or. sim%scene%bodies%owner(sim%pairs%body_of(s)) < 0), &
                             s=1, problem%n_bodies)])
      explicit%id = int(id(explicit%slot))
    end associate
    explicit%parts = nint(ranks(explicit%id))
    allocate (explicit%force(explicit%width, size(explicit%slot)), source=0.0_wp)
    explicit%free = problem%body(:explicit%width, :problem%n_bodies)
  end subroutine find_shared

  !> X F_Gamma = sum A M_E^-1 (R_E + R_E^d): the mean over all copies of the impulses of contacts, less those of this copy.
  subroutine update_forces(comm, problem, explicit)
    type(comm_t), intent(inout) :: comm
    type(problem_t), intent(in) :: problem
    type(explicit_t), intent(inout) :: explicit
    real(wp) :: own(explicit%width, size(explicit%slot)), sums(explicit%width*explicit%all_bodies)
    type(problem_t) :: unit
    integer :: i, at

    ! Bodies of unit mass and inertia at rest: what impulses do to them is H r.
    unit = problem
    unit%body = 0
    unit%body(explicit%width + 1:, :) = 1
    if (problem%kind == solid_frictional) unit%body(13:, :) = 0
    call add_impulses(unit)
    own = unit%body(:explicit%width, explicit%slot)
    sums = 0
    do i = 1, size(explicit%slot)
      at = (explicit%id(i) - 1)*explicit%width
      sums(at + 1:at + explicit%width) = own(:, i)
    end do
    call comm%sum(sums)
    do i = 1, size(explicit%slot)
      at = (explicit%id(i) - 1)*explicit%width
      explicit%force(:, i) = sums(at + 1:at + explicit%width)/real(explicit%parts(i), wp) - own(:, i)
    end do
  end subroutine update_forces

  !> Velocities under contacts and F_Gamma, from nothing: V_free + M_c^-1 (H r_c + F_c).
  subroutine set_velocities(problem, explicit)
    type(problem_t), intent(inout) :: problem
    type(explicit_t), intent(in) :: explicit
    integer :: i

    problem%body(:explicit%width, :problem%n_bodies) = explicit%free
    call add_impulses(problem)
    do i = 1, size(explicit%slot)
      associate (body => problem%body(:, explicit%slot(i)))
        body(:explicit%width) = body(:explicit%width) + moved(problem%kind, body, explicit%force(:, i))
      end associate
    end do
  end subroutine set_velocities

  !> What an impulse does to a body.
  pure function moved(kind, body, impulse) result(velocity)
    integer, intent(in) :: kind
    real(wp), intent(in) :: body(:), impulse(:)
    real(wp) :: velocity(size(impulse))

    select case (kind)
    case (ball_frictional)
      velocity = [body(7)*impulse(:3), max(0.0_wp, body(8))*impulse(4:)]
    case (solid_frictional)
      velocity = [body(7:9)*impulse(:3), matmul(reshape(body([10, 13, 14, 13, 11, 15, 14, 15, 12]), [3, 3]), impulse(4:))]
    case default
      velocity = body(4:6)*impulse
    end select
  end function moved

  !> F_Gamma of the dual method, by shared body as the explicit form lists them: its part of the mass times what gluing has
  !! added. Walls take part in sums over all ranks that no rank keeps: theirs is taken from the explicit form.
  subroutine glued_forces(dual, problem, explicit, force)
    type(dual_t), intent(in) :: dual
    type(problem_t), intent(in) :: problem !! with whole masses
    type(explicit_t), intent(in) :: explicit
    real(wp), allocatable, intent(out) :: force(:, :)
    real(wp) :: body(size(problem%body, 1)), velocity(explicit%width, explicit%width)
    integer :: i, j, e, found

    force = explicit%force
    found = 0
    associate (interface => dual%gluing%interface)
      do i = 1, size(interface%slot)
        e = findloc(explicit%slot, interface%slot(i), 1)
        ! Of replicated bodies this rank may hold a copy without contacts.
        call t%check(e > 0 .or. i > interface%n_shared, 'a body is shared')
        if (e == 0) cycle
        found = found + 1
        call t%equal(interface%multiplicity(i), explicit%parts(e), 'ranks that share a body')
        body = problem%body(:, interface%slot(i))
        call share_mass(problem%kind, interface%multiplicity(i), body)
        do j = 1, explicit%width
          velocity(:, j) = moved(problem%kind, body, unit_vector(explicit%width, j))
        end do
        ! A component in which a body is held has no mobility, and no gluing impulse.
        do j = 1, explicit%width
          if (.not. velocity(j, j) > 0) velocity(j, j) = 1
        end do
        force(:, e) = divided(velocity, dual%gluing%jump(:, i))
      end do
    end associate
    call t%equal(found, size(explicit%slot), 'as many bodies are shared')
  end subroutine glued_forces

  !> Unit vector.
  pure function unit_vector(n, i) result(e)
    integer, intent(in) :: n, i
    real(wp) :: e(n)

    e = 0
    e(i) = 1
  end function unit_vector

  !> x of A x = b, A symmetric and positive: by elimination.
  pure function divided(matrix, right) result(x)
    real(wp), intent(in) :: matrix(:, :), right(:)
    real(wp) :: x(size(right)), a(size(right), size(right) + 1)
    integer :: i, j

    a(:, :size(right)) = matrix
    a(:, size(right) + 1) = right
    do i = 1, size(right)
      a(i, :) = a(i, :)/a(i, i)
      do j = 1, size(right)
        if (j /= i) a(j, :) = a(j, :) - a(j, i)*a(i, :)
      end do
    end do
    x = a(:, size(right) + 1)
  end function divided
end program test_dual
