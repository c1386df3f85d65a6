!> Clusters that are solved leave the sweeps of the rank within which they lie: fewer updates, as many gluings, the same answer. One
!! of which another rank holds a part stays. Run on any number of subdomains.
!!
!! Every rank has short towers of its own and a storey of a tall one, whose other storeys stand on the other ranks.
program test_solved_clusters
  use harness, only: tests_t
  use sg_choose_solver, only: choose_solver
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4, i8
  use sg_problem, only: problem_t
  use sg_records, only: round_frictionless_inverse_wnn
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8, partition_options_t, solver_options_t
  use sg_solver, only: solver_t
  use sg_subdomain, only: subdomain_t
  use subdomain_tests, only: on_subdomains
  use towers, only: make_towers
  implicit none
  !> Grains of a storey and of short towers, and number of short ones of a rank
  integer, parameter :: storey = 20, short = 3, n_short = 20
  real(wp), parameter :: tolerance = 1e-8_wp
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    if (comm%size > 1) then
      call test_gluing(comm, 'dual')
      call test_gluing(comm, 'primal')
      call test_gluing(comm, 'momentum')
    end if
  end subroutine run_tests

  subroutine test_gluing(comm, name)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(problem_t) :: with, without
    type(report_t) :: report, plain
    real(wp) :: near
    integer :: carried

    call solve(comm, name, .true., with, report)
    call solve(comm, name, .false., without, plain)
    call t%check(report%is_converged .and. plain%is_converged, name//': both converge')
    ! e8 falls by the slowest mode of the tall tower, which so many sweeps take to fall to 1/e.
    near = tolerance*real(storey*comm%size, wp)**2*100
    call t%near(maxval(abs(with%impulse - without%impulse)), 0.0_wp, near, name//': the same impulses')
    carried = storey*(comm%size - comm%rank)
    call t%near(with%impulse(1, 1), real(carried, wp), near, name//': the lowest contact here carries all above')
    call t%near(with%impulse(1, storey + 1), real(short, wp), near, name//': and that of a short tower its own')
    ! What is left out keeps a tenth of its share of the error, so that the others must come as much lower: a batch of sweeps.
    call t%check(report%gluings <= plain%gluings + plain%gluings/100 + 20, name//': as many gluings')
    ! The short towers hold 60 of 80 contacts of each rank; those of the storey are visited in every sweep.
    call t%check(real(report%contact_updates, wp) < 0.6_wp*real(plain%contact_updates, wp), name//': fewer updates')
    call t%check(report%contact_updates >= int(report%gluings*storey, i8), name//': the tower that ranks share stays')
  end subroutine test_gluing

  !> Solve the towers of all ranks.
  subroutine solve(comm, name, leaves_solved, problem, report)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    logical, intent(in) :: leaves_solved
    type(problem_t), intent(out) :: problem
    type(report_t), intent(out) :: report
    class(solver_t), allocatable :: solver
    type(solver_options_t) :: options
    type(partition_options_t) :: partition
    type(subdomain_t) :: subdomain
    type(error_t), allocatable :: error

    ! Sweeps without momentum, which take long enough for clusters to leave.
    options%method = 'nlgs'
    options%check_every = 20
    options%criterion = criterion_e8
    options%tolerance = tolerance
    options%maximum_sweeps = 200000
    options%order = 'natural'
    options%leave_solved = leaves_solved
    partition%gluing = name
    call choose_solver(options, partition, comm%size, solver, error)
    call t%check(.not. allocated(error), name//' can be had')
    call make_storey(comm, problem, subdomain)
    call solver%solve(problem, subdomain, comm, report)
  end subroutine solve

  !> The towers of a rank: its storey stands on the highest grain of the rank below, of which it holds a copy.
  subroutine make_storey(comm, problem, subdomain)
    type(comm_t), intent(inout) :: comm
    type(problem_t), intent(out) :: problem
    type(subdomain_t), intent(out) :: subdomain
    integer :: r

    call make_towers([storey, spread(short, 1, n_short)], problem, 1)
    subdomain%rank = comm%rank
    subdomain%size = comm%size
    subdomain%serial = 1
    subdomain%neighbour = pack([comm%rank - 1, comm%rank + 1], [comm%rank > 0, comm%rank < comm%size - 1])
    subdomain%first = [(r, r=1, size(subdomain%neighbour) + 1)]
    subdomain%body = pack([problem%n_bodies, storey + 1], [comm%rank > 0, comm%rank < comm%size - 1])
    subdomain%owner = pack([comm%rank - 1, comm%rank], [comm%rank > 0, comm%rank < comm%size - 1])
    subdomain%replicated = [integer ::]
    if (comm%rank == 0) return
    problem%pair(2, 1) = int(problem%n_bodies, i4)
    problem%record(round_frictionless_inverse_wnn, 1) = 0.5_wp
    problem%free_norm = sqrt(real(n_short, wp))
  end subroutine make_storey
end program test_solved_clusters
