!> Contacts assembled and judged in one pass against contacts taken one by one, as laws of any kind are: packs of all shapes.
program test_assemble_by_gaps
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_assemble, only: begin_problem, put_contact
  use sg_compact, only: compact_velocity
  use sg_contact_laws, only: law_of_contact
  use sg_contact_status, only: status_of
  use sg_gap_laws, only: have_gap_laws
  use sg_kinds, only: wp, i1
  use sg_laws, only: law_gap, law_gap_shifted, law_iqs, law_restitution, local_law_t, status_none, status_slide, status_stick
  use sg_problem, only: problem_t
  use sg_records, only: is_compact, is_in_space, normal_x, normal_z
  use sg_simulation, only: simulation_t
  use sg_status_by_gaps, only: find_statuses
  implicit none
  character(len=14), parameter :: names(6) = [character(len=14) :: 'polygons', 'periodic disks', 'clusters', 'pressed disks', &
                                              'spheres', 'polyhedra']
  integer, parameter :: kinds(3) = [law_gap, law_iqs, law_gap_shifted]
  ! Sums of some ten products, relative to the largest value in their place of the records.
  real(wp), parameter :: rounding = 1e-13_wp
  type(tests_t) :: t
  integer :: i, j

  do i = 1, size(names)
    if (.not. can_be_made(trim(names(i)))) cycle
    do j = 1, size(kinds)
      call test_pack(trim(names(i)), kinds(j))
    end do
  end do
  call t%finish()

contains

  !> The problem of a step of a pack that has come to lie on its floor.
  subroutine test_pack(name, kind)
    character(len=*), intent(in) :: name
    integer, intent(in) :: kind
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem, slow

    sim => fresh()
    call start_pack(t, sim%comm, name, pack_deck(name), 1e-4_wp, sim)
    sim%scene%laws(1)%kind = kind
    sim%scene%laws(1)%gap_shift = 1e-4_wp
    call advance_pack(t, name, sim, 80)
    call next_problem(sim, problem)
    call t%check(have_gap_laws(sim%scene, sim%plan, problem%drives_spin), name//': laws look at gaps')
    call t%check(problem%n_contacts > 10 .and. any(abs(problem%impulse) > 0), name//': there are contacts, and impulses')
    call assemble_one_by_one(sim, slow)
    call compare(name, problem, slow)
    call compare_statuses(name, sim%problem)
    call check_driven_spin(name, sim)
    sim%scene%laws(1)%kind = law_restitution
    call t%check(.not. have_gap_laws(sim%scene, sim%plan, .false.), name//': restitution looks at velocities')
  end subroutine test_pack

  !> A driven spin of a round body, which its record does not carry, is found where bodies are loaded; others carry it.
  subroutine check_driven_spin(name, sim)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    type(problem_t) :: problem

    associate (bodies => sim%scene%bodies)
      bodies%inverse_mass(bodies%n_velocity, bodies%n) = 0
      bodies%free_velocity(bodies%n_velocity, bodies%n) = 1
    end associate
    call begin_problem(sim%scene, sim%plan, sim%pairs, sim%contacts%n, problem)
    call t%check(problem%drives_spin .eqv. is_compact(sim%plan%kind), name//': a driven spin')
    call t%check(have_gap_laws(sim%scene, sim%plan, problem%drives_spin) .neqv. is_compact(sim%plan%kind), &
                 name//': laws look at more where it enters as a bias')
  end subroutine check_driven_spin

  !> The same problem, contact by contact.
  subroutine assemble_one_by_one(sim, problem)
    type(simulation_t), intent(in) :: sim
    type(problem_t), intent(inout) :: problem
    type(local_law_t) :: law
    real(wp) :: q(3), squares, opening
    integer :: k

    call begin_problem(sim%scene, sim%plan, sim%pairs, sim%contacts%n, problem)
    squares = 0
    problem%most_friction = 0
    do k = 1, sim%contacts%n
      call law_of_contact(sim%scene, sim%contacts, k, sim%options%time_step, law)
      call put_contact(sim%scene, sim%pairs, sim%contacts, k, law, problem)
      q = compact_velocity(problem, k)
      squares = squares + sum(q**2)
      opening = q(1)
      if (is_in_space(problem%kind)) opening = dot_product(problem%record(normal_x:normal_z, k), q)
      if (opening < 0) problem%closing_speed = max(problem%closing_speed, norm2(q))
      problem%most_friction = max(problem%most_friction, law%friction)
      problem%impulse(:, k) = sim%contacts%impulse(:, k)
    end do
    problem%free_norm = sqrt(squares)
  end subroutine assemble_one_by_one

  !> Slots and guesses are the same; records, norms and speeds are, to rounding.
  subroutine compare(name, fast, slow)
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: fast, slow
    real(wp) :: worst
    integer :: i, n

    n = slow%n_contacts
    call t%check(all(fast%pair(:, :n) == slow%pair(:, :n)), name//': slots')
    call t%check(.not. any(abs(fast%impulse(:, :n) - slow%impulse(:, :n)) > 0), name//': guesses')
    worst = 0
    do i = 1, size(slow%record, 1)
      worst = max(worst, maxval(abs(fast%record(i, :n) - slow%record(i, :n)))/max(maxval(abs(slow%record(i, :n))), 1e-30_wp))
    end do
    call t%near(worst, 0.0_wp, rounding, name//': records')
    call t%near(fast%free_norm, slow%free_norm, rounding*slow%free_norm, name//': norm of free velocities')
    call t%near(fast%closing_speed, slow%closing_speed, rounding*slow%free_norm, name//': closing speed')
    call t%near(fast%most_friction, slow%most_friction, 0.0_wp, name//': friction')
  end subroutine compare

  !> Statuses of the last solved step are the same, with a speed of rest among the velocities and one below all of them.
  subroutine compare_statuses(name, solved)
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: solved
    real(wp), parameter :: rests(2) = [1e-3_wp, 1e-12_wp]
    integer(i1), allocatable :: status(:)
    integer :: i, k

    allocate (status(solved%n_contacts), source=0_i1)
    do i = 1, size(rests)
      call find_statuses(solved, rests(i), status)
      call t%check(all([(status(k) == status_of(solved, k, .false., 0.0_wp, rests(i)), k=1, solved%n_contacts)]), &
                   name//': statuses')
      call t%check(all(status == status_none .or. status == status_slide .or. status == status_stick), name//': no other status')
    end do
    call t%check(any(status == status_none) .and. any(status /= status_none), name//': some contacts are pressed, others open')
  end subroutine compare_statuses
end program test_assemble_by_gaps
