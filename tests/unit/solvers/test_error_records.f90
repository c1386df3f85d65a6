!> Errors of contacts in vector registers from the records of a problem: sums, what determines the active set and bounds as one by
!! one, for disks, polygons, spheres and polyhedra, some contacts with other laws or without a part in the problem.
program test_error_records
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_compact, only: add_impulses
  use sg_kinds, only: wp
  use sg_natural_map, only: chunk
  use sg_problem, only: problem_t
  use sg_records, only: active_place, arm_cohesion, arm_frictional, arm_law, solid_cohesion, solid_frictional, &
                        solid_inverse_lambda, solid_law
  use sg_residuals, only: find_worst, n_error_sums, sum_errors
  use sg_simulation, only: simulation_t
  implicit none
  character(len=13), parameter :: names(4) = [character(len=13) :: 'pressed disks', 'polygons', 'spheres', 'polyhedra']
  ! Sums of up to some hundred terms in another order; relative velocities are differences of a hundred times larger ones.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t
  integer :: i

  do i = 1, size(names)
    if (can_be_made(trim(names(i)))) call test_pack(trim(names(i)))
  end do
  call t%finish()

contains

  !> A problem of a pack under its guess: as it is, with contacts that take no part, and with a law that goes one by one.
  subroutine test_pack(name)
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem
    integer :: k, left

    sim => fresh()
    call start_pack(t, sim%comm, name, pack_deck(name), 1e-2_wp, sim)
    call advance_pack(t, name, sim, 60)
    call next_problem(sim, problem)
    call add_impulses(problem)
    call t%check(problem%n_contacts > merge(50, chunk, name == 'polygons'), name//': contacts')
    do left = 0, 3
      problem%n_contacts = problem%n_contacts - min(left, 1)
      call compare(name, problem)
    end do
    do k = 1, problem%n_contacts, 7
      problem%record(active_place(problem%kind), k) = 0
      if (problem%kind == solid_frictional) problem%record(solid_inverse_lambda, k) = 0
    end do
    call compare(name//', some without a part', problem)
    if (problem%kind == arm_frictional) problem%record([arm_cohesion, arm_law], 3) = [1e-3_wp, 1.0_wp]
    if (problem%kind == solid_frictional) problem%record([solid_cohesion, solid_law], 3) = [1e-3_wp, 1.0_wp]
    if (any(problem%kind == [arm_frictional, solid_frictional])) call compare(name//', one with cohesion', problem)
  end subroutine test_pack

  !> Sums and lists next to those of contacts one by one, which are asked for by their squares.
  subroutine compare(name, problem)
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: problem
    real(wp) :: sums(n_error_sums), right(n_error_sums), speed
    real(wp), allocatable :: squares(:), closing(:), right_closing(:), bounds(:), right_bounds(:)
    integer :: k, contact, round

    allocate (squares(problem%n_contacts), closing(problem%n_contacts), right_closing(problem%n_contacts))
    do round = 1, 2
      sums(1) = 0
      call sum_errors(problem, round == 2, sums, closing=closing, bounds=bounds)
      call sum_errors(problem, round == 2, right, squares, right_closing, right_bounds)
      call t%check(right(2) > 0 .and. right(6) > 10, name//': errors, and contacts that carry')
      do k = 1, n_error_sums
        call t%near(sums(k), right(k), rounding*right(k), name//': a sum of errors')
      end do
      call t%check(all(abs(closing) >= huge(1.0_wp) .eqv. abs(right_closing) >= huge(1.0_wp)), &
                   name//': what carries or takes no part')
      where (abs(right_closing) >= huge(1.0_wp)) closing = closing - right_closing
      where (abs(right_closing) >= huge(1.0_wp)) right_closing = 0
      call t%near(maxval(abs(closing - right_closing)), 0.0_wp, rounding*maxval(abs(problem%body(1:3, :))), &
                  name//': closing speeds')
    end do
    k = (problem%n_contacts + chunk - 1)/chunk
    call t%near(maxval(abs(bounds(:k) - right_bounds(:k))), 0.0_wp, rounding*maxval(right_bounds(:k)), name//': bounds')
    call find_worst(problem, contact, speed, bounds)
    call find_worst(problem, k, sums(1))
    call t%equal(contact, k, name//': the worst contact')
  end subroutine compare
end program test_error_records
