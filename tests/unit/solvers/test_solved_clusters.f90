!> Clusters that are solved before the others: left out of the sweeps, to the same tolerance of all, and never where there is one.
!! A tall tower takes thousands of sweeps, short ones a few.
program test_solved_clusters
  use harness, only: tests_t
  use sg_kinds, only: wp
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t
  use sg_records, only: round_frictionless_inverse_wnn, velocity_y
  use sg_report, only: report_t
  use sg_residuals, only: measure_errors
  use sg_run_options, only: criterion_e1, criterion_e8
  use towers, only: make_towers
  implicit none
  !> Grains of the tall tower and of short ones, and number of short ones
  integer, parameter :: tall = 50, short = 3, n_short = 40
  !> Tolerance of e8, and what it leaves of the impulses: e8 falls by the slowest mode, which (tall/pi)^2 sweeps take to fall to 1/e
  real(wp), parameter :: tolerance = 1e-8_wp, impulses_near = tolerance*tall**2*100
  type(tests_t) :: t

  call test_two_kinds()
  call test_one_cluster()
  call test_joined_late()
  call test_other_criteria()
  call t%finish()

contains

  subroutine test_two_kinds()
    type(problem_t) :: start, with, without
    type(report_t) :: report, plain, measured

    call make_towers([tall, spread(short, 1, n_short)], start, 0)
    call solve(start, .true., criterion_e8, with, report)
    call solve(start, .false., criterion_e8, without, plain)
    call t%check(report%is_converged .and. plain%is_converged, 'both converge')
    call measure_errors(with, measured, with_e1=.true.)
    call t%check(measured%e8 <= tolerance, 'to the tolerance, measured over all contacts')
    associate (n => start%n_contacts)
      call t%near(maxval(abs(with%impulse(:, :n) - without%impulse(:, :n))), 0.0_wp, impulses_near, 'to the same impulses')
    end associate
    call t%near(with%impulse(1, 1), real(tall, wp), impulses_near, 'the lowest contact of the tall tower carries it')
    call t%near(with%impulse(1, tall + 1), real(short, wp), impulses_near, 'and that of a short one does')
    ! The short towers hold 120 of 170 contacts, and are left out after a few hundred of thousands of sweeps.
    call t%check(real(report%contact_updates, wp) < 0.5_wp*real(plain%contact_updates, wp), 'by half of the updates, or less')
  end subroutine test_two_kinds

  subroutine test_one_cluster()
    type(problem_t) :: start, with, without
    type(report_t) :: report, plain

    call make_towers([tall], start, 0)
    call solve(start, .true., criterion_e8, with, report)
    call solve(start, .false., criterion_e8, without, plain)
    call t%check(all(transfer(with%impulse(:, :tall), [0]) == transfer(without%impulse(:, :tall), [0])), &
                 'one cluster: the same bits')
    call t%equal(int(report%contact_updates), int(plain%contact_updates), 'one cluster: the same updates')
  end subroutine test_one_cluster

  !> A grain falls slower than the tall tower did at first: only when the tower is nearly at rest does it land there.
  subroutine test_joined_late()
    type(problem_t) :: start, with
    type(report_t) :: report
    integer :: n

    call make_towers([tall, spread(short, 1, n_short)], start, 0)
    ! The last of the short towers has its lowest grain on the tall tower, not on the floor.
    n = start%n_contacts - short + 1
    start%pair(2, n) = tall + 1
    start%record(round_frictionless_inverse_wnn, n) = 0.5_wp
    start%body(velocity_y, start%pair(1, n:start%n_contacts)) = -0.5_wp
    call solve(start, .true., criterion_e8, with, report)
    call t%check(report%is_converged, 'joined late: converged')
    call t%near(with%impulse(1, 1), tall + 0.5_wp*short, impulses_near, 'joined late: the floor carries both')
    call t%near(with%impulse(1, n), 0.5_wp*short, impulses_near, 'joined late: the tower carries the late one')
  end subroutine test_joined_late

  !> e1 weighs contacts in another way: there all are swept.
  subroutine test_other_criteria()
    type(problem_t) :: start, with, without
    type(report_t) :: report, plain

    call make_towers([tall, spread(short, 1, n_short)], start, 0)
    call solve(start, .true., criterion_e1, with, report)
    call solve(start, .false., criterion_e1, without, plain)
    call t%equal(int(report%contact_updates), int(plain%contact_updates), 'e1: the same updates')
  end subroutine test_other_criteria

  subroutine solve(start, leaves_solved, criterion, problem, report)
    type(problem_t), intent(in) :: start
    logical, intent(in) :: leaves_solved
    integer, intent(in) :: criterion
    type(problem_t), intent(out) :: problem
    type(report_t), intent(out) :: report
    type(nlgs_t) :: solver

    solver%options%criterion = criterion
    solver%options%tolerance = tolerance
    solver%options%maximum_sweeps = 100000
    solver%options%order = 'natural'
    solver%options%leave_solved = leaves_solved
    problem = start
    call solver%solve(problem, report)
  end subroutine solve
end program test_solved_clusters
