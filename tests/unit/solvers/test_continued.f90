!> Solves that go on from the problem before, as those of later substeps do, in its order of sweeps, and solves of other problems
!! with the same contacts: the solutions of a new solver, while contacts open and close.
program test_continued
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, next_problem, pack_deck, start_pack
  use sg_kinds, only: wp
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t
  use sg_random, only: random_t
  use sg_records, only: bias_place, is_in_space, normal_x, normal_z
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: simulation_t
  use sg_text, only: to_text
  use solver_cases, only: solver_of
  implicit none
  character(len=14), parameter :: names(3) = [character(len=14) :: 'periodic disks', 'pressed disks', 'spheres']
  ! An error of 10^-10 of a contact's natural map is carried through W's condition, some 10^3, to velocities.
  real(wp), parameter :: tolerance = 1e-10_wp, closeness = 1e-6_wp
  integer, parameter :: most_sweeps = 50000
  type(tests_t) :: t
  type(random_t) :: random
  integer :: i

  call random%seed(5)
  do i = 1, size(names)
    call test_pack(trim(names(i)), .true.)
    call test_pack(trim(names(i)), .false.)
  end do
  call t%finish()

contains

  !> Problems of a pack that has come to lie, whose gaps change from one to the next.
  subroutine test_pack(name, goes_on)
    character(len=*), intent(in) :: name
    logical, intent(in) :: goes_on !! are problems marked as going on from the one before?
    type(simulation_t), pointer :: sim
    type(problem_t) :: free, problem
    type(nlgs_t) :: solver
    type(report_t) :: report
    integer :: round

    sim => fresh()
    call start_pack(t, sim%comm, name, pack_deck(name), 1e-4_wp, sim)
    call advance_pack(t, name, sim, 80)
    call next_problem(sim, free)
    solver = solver_of(criterion_e8, tolerance, most_sweeps)
    problem = free
    call solver%solve(problem, report)
    call t%check(report%is_converged .and. report%active_contacts > 10, name//': a pack that carries')
    do round = 1, 6
      free%impulse = problem%impulse
      free%is_continued = goes_on
      ! The first problem of a substep is hardly another one; later ones open and close contacts.
      call change_gaps(free, merge(1e-6_wp, 0.3_wp, round == 1))
      problem = free
      call solver%solve(problem, report)
      call t%check(report%is_converged, name//', round '//to_text(round)//': converged')
      call compare(name//', round '//to_text(round), free, problem)
    end do
  end subroutine test_pack

  !> Change the biases of some contacts, by a share of gravity's velocity over a step at most.
  subroutine change_gaps(problem, share)
    type(problem_t), intent(inout) :: problem
    real(wp), intent(in) :: share
    real(wp) :: change
    integer :: k, place

    place = bias_place(problem%kind)
    do k = 1, problem%n_contacts, 3
      change = share*problem%velocity_scale*random%uniform(-1.0_wp, 1.0_wp)
      if (is_in_space(problem%kind)) then
        problem%record(place:place + 2, k) = problem%record(place:place + 2, k) + change*problem%record(normal_x:normal_z, k)
      else
        problem%record(place, k) = problem%record(place, k) + change
      end if
    end do
  end subroutine change_gaps

  !> The solution next to that of a new solver, from the same guess.
  subroutine compare(name, free, problem)
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: free, problem
    type(problem_t) :: other
    type(nlgs_t) :: solver
    type(report_t) :: report

    other = free
    other%is_continued = .false.
    solver = solver_of(criterion_e8, tolerance, most_sweeps)
    call solver%solve(other, report)
    call t%check(report%is_converged, name//': a new solver converges')
    call t%near(maxval(abs(problem%body - other%body))/problem%velocity_scale, 0.0_wp, closeness, name//': the same velocities')
  end subroutine compare
end program test_continued
