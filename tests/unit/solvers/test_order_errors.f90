!> Errors of contacts side by side: sums, active set and worst contact as `sum_errors` and `find_worst` have them, with contacts
!! that the order does not hold, for disks, polygons and spheres that fall and come to rest.
program test_order_errors
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, next_problem, pack_deck, start_pack
  use sg_compact, only: add_impulses
  use sg_kinds, only: wp
  use sg_order_errors, only: order_errors_t
  use sg_order_values, only: give_impulses
  use sg_problem, only: problem_t
  use sg_random, only: random_t
  use sg_residuals, only: find_worst, n_error_sums, sum_errors
  use sg_run_options, only: solver_options_t
  use sg_simulation, only: simulation_t
  use sg_sweep_order, only: set_order, sweep_order_t
  use sg_sweeps, only: sweep
  implicit none
  character(len=13), parameter :: names(3) = [character(len=13) :: 'pressed disks', 'polygons', 'spheres']
  ! Sums of up to some hundred terms in another order.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t
  type(random_t) :: random
  integer :: i

  call random%seed(3)
  do i = 1, size(names)
    call test_pack(trim(names(i)))
  end do
  call t%finish()

contains

  !> A problem of a pack, with one contact in twenty outside of the order, after no sweep and after two.
  subroutine test_pack(name)
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim
    type(problem_t) :: free, problem
    type(sweep_order_t) :: order
    type(solver_options_t) :: options
    logical, allocatable :: is_ordered(:)
    integer :: k, round

    sim => fresh()
    call start_pack(t, sim%comm, name, pack_deck(name), 1e-2_wp, sim)
    call advance_pack(t, name, sim, 60)
    call next_problem(sim, free)
    is_ordered = [(modulo(k, 20) > 0, k=1, free%n_contacts)]
    problem = free
    call add_impulses(problem)
    call set_order(order, problem, is_ordered, options)
    do round = 1, 3
      call compare(name, problem, order, is_ordered)
      call sweep(problem%kind, order, problem%n_bodies, 1.0_wp, problem%body)
      call give_impulses(order, problem)
    end do
    call test_taken(name, free, options, order, is_ordered)
  end subroutine test_pack

  !> Sums, choice and worst contact next to those of all contacts one by one.
  subroutine compare(name, problem, order, is_ordered)
    character(len=*), intent(in) :: name
    type(problem_t), intent(inout) :: problem
    type(sweep_order_t), intent(in) :: order
    logical, intent(in) :: is_ordered(:)
    type(order_errors_t) :: errors
    real(wp) :: sums(n_error_sums), right(n_error_sums), limit, speed, right_speed
    real(wp), allocatable :: closing(:), bounds(:)
    logical, allocatable :: is_wanted(:)
    integer :: contact, right_contact, k

    allocate (closing(problem%n_contacts), is_wanted(problem%n_contacts))
    call sum_errors(problem, .true., right, closing=closing, bounds=bounds)
    call find_worst(problem, right_contact, right_speed)
    call errors%begin()
    call errors%measure(problem, order, is_ordered, .true., sums)
    call t%check(errors%is_set, name//': measured side by side')
    call t%check(right(2) > 0 .and. right(6) > 10, name//': errors, and contacts that carry')
    do k = 1, n_error_sums
      call t%near(sums(k), right(k), rounding*right(k), name//': a sum of errors')
    end do
    call errors%find_worst(problem, order, contact, speed)
    call t%equal(contact, right_contact, name//': the worst contact')
    call t%near(speed, right_speed, rounding*right_speed, name//': its velocity')
    call errors%find_worst(problem, order, contact, speed)
    call t%equal(contact, right_contact, name//': the worst contact once more')
    ! No velocity lies at either limit.
    limit = 0.7_wp*maxval(closing, closing < huge(1.0_wp))
    call errors%choose(order, is_ordered, limit, is_wanted)
    call t%check(all(is_wanted .eqv. closing <= limit), name//': the active set')
    call errors%choose(order, is_ordered, 0.5_wp*huge(1.0_wp), is_wanted)
    call t%check(all(is_wanted .eqv. closing <= 0.5_wp*huge(1.0_wp)), name//': the active set of all')
  end subroutine compare

  !> The order set again for the problem with other impulses: the groups are those it has.
  subroutine test_taken(name, free, options, order, is_ordered)
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: free
    type(solver_options_t), intent(in) :: options
    type(sweep_order_t), intent(inout) :: order
    logical, intent(in) :: is_ordered(:)
    type(problem_t) :: problem
    integer :: k, i

    problem = free
    do k = 1, problem%n_contacts
      do i = 1, size(problem%impulse, 1)
        problem%impulse(i, k) = problem%impulse(i, k)*random%uniform(0.5_wp, 1.5_wp)
      end do
    end do
    call add_impulses(problem)
    call set_order(order, problem, is_ordered, options)
    call t%check(order%has_last_groups, name//': the same groups')
    call compare(name//', the same groups', problem, order, is_ordered)
    problem%pair(1, 1) = problem%pair(1, 1) + merge(1, -1, problem%pair(1, 1) < problem%pair(2, 1))
    call set_order(order, problem, is_ordered, options)
    call t%check(.not. order%has_last_groups, name//': others where a contact has another body')
  end subroutine test_taken
end program test_order_errors
