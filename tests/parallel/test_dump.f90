!> Dumps of problems that ranks share: the files of several ranks hold the problem of one, except for the order of its rows.
!!
!! A run of one rank is brought to a state in which grains rest on each other; the problem of the next step is dumped whole, and
!! dumped again after the run has been split. Rows are matched by numbers of theirs that no two contacts have in common.
module breaking_solver
  use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
  use sg_comm, only: comm_t
  use sg_dual, only: dual_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: velocity_x
  use sg_report, only: report_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: breaking_solver_t

  !> A solver that spoils a velocity on the last rank
  type, extends(dual_t) :: breaking_solver_t
  contains
    procedure :: solve_coupled => breaking_solve
  end type breaking_solver_t

contains

  !> Solve, and give a body of the last rank that others touch an infinite velocity before the errors are measured.
  subroutine breaking_solve(self, problem, coupling, comm, report)
    class(breaking_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem to spoil
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(out) :: report !! effort and errors

    call self%dual_t%solve_coupled(problem, coupling, comm, report)
    if (comm%rank == comm%size - 1) problem%body(velocity_x, problem%pair(1, 1)) = ieee_value(1.0_wp, ieee_positive_inf)
    call self%errors%begin(problem, .true., self%sets, comm)
    call self%errors%finish(report, comm)
  end subroutine breaking_solve
end module breaking_solver

program test_dump_ranks
  use, intrinsic :: ieee_exceptions, only: ieee_get_halting_mode, ieee_invalid, ieee_set_flag, ieee_set_halting_mode
  use breaking_solver, only: breaking_solver_t
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use matrices, only: full
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_advance, only: advance
  use sg_comm, only: comm_t
  use sg_condense, only: sparse_from_blocks
  use sg_dump, only: begin_dump, dump_t, finish_dump
  use sg_error, only: error_t
  use sg_fclib_read, only: read_fclib
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_problem, only: problem_t
  use sg_records, only: arm_cohesion, arm_compliance_n, arm_compliance_t, arm_frictional
  use sg_report, only: report_t
  use sg_simulation, only: decompose, simulation_t
  use sg_sparse, only: multiply
  use sg_system, only: make_folder
  implicit none

  !> Rounding of sums of some ten numbers, over the largest of them
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t
  type(comm_t) :: comm

  call comm%start()
  if (.not. hdf5_is_available() .or. (comm%size > 1 .and. .not. hdf5_is_parallel())) then
    if (comm%rank == 0) write (*, '(a)') 'no HDF5 for as many ranks: dumps are left out'
    call t%check(.true., 'nothing to do')
  else
    if (comm%rank == 0) call t%check(make_folder('one') .and. make_folder('many'), 'folders')
    call test_pack('disks', 0.0_wp, 0.0_wp)
    call test_pack('frictionless disks', 0.0_wp, 0.0_wp)
    call test_pack('pressed disks', 0.0_wp, 0.0_wp)
    call test_pack('periodic disks', 0.0_wp, 0.0_wp)
    call test_pack('polygons', 0.02_wp, 0.0_wp)
    call test_pack('polygons', 0.02_wp, 1e-3_wp)
    call test_pack('spheres', 0.0_wp, 0.0_wp)
    if (can_be_made('polyhedra')) call test_pack('polyhedra', 0.0_wp, 0.0_wp)
    if (comm%size > 1) call test_broken_step()
  end if
  call t%finish(comm)

contains

  !> Dump the problem of a pack by one rank, and by all.
  subroutine test_pack(pack, cohesion, compliance)
    character(len=*), intent(in) :: pack
    real(wp), intent(in) :: cohesion !! given to all contacts [N s]
    real(wp), intent(in) :: compliance !! [1/kg]
    type(simulation_t), pointer :: whole, split
    type(comm_t) :: alone
    character(len=:), allocatable :: name

    whole => fresh()
    split => fresh()
    name = pack
    if (cohesion > 0) name = name//' that stick'
    if (compliance > 0) name = name//' and give way'
    call start_pack(t, comm, name, pack_deck(pack), 1e-3_wp, whole)
    call advance_pack(t, name, whole, 60)
    if (comm%rank == 0) call dump_next(name, 'one', whole, alone, cohesion, compliance)
    call start_split(name, pack, split)
    call dump_next(name, 'many', split, split%comm, cohesion, compliance)
    if (comm%rank == 0) then
      call compare(name, 'dump-61-local.hdf5', .false.)
      if (.not. compliance > 0) call compare(name, 'dump-61-global.hdf5', .true.)
    end if
  end subroutine test_pack

  !> Bring a pack to the same state, and split it.
  subroutine start_split(name, pack, split)
    character(len=*), intent(in) :: name, pack
    type(simulation_t), intent(inout) :: split
    type(error_t), allocatable :: error

    call start_pack(t, comm, name, pack_deck(pack), 1e-3_wp, split)
    call advance_pack(t, name, split, 60)
    split%comm = comm
    split%options%partition%boxes = [comm%size, 1, 1]
    call decompose(split, error)
    call t%check(.not. allocated(error), name//': split')
  end subroutine start_split

  !> A velocity that breaks on one rank makes all of them dump the problem as it was before the solve.
  subroutine test_broken_step()
    character(len=*), parameter :: name = 'broken disks'
    type(simulation_t), pointer :: whole, split
    type(breaking_solver_t) :: breaking
    type(comm_t) :: alone
    type(error_t), allocatable :: error
    character(len=:), allocatable :: file
    logical :: halts

    whole => fresh()
    split => fresh()
    call start_pack(t, comm, name, pack_deck('disks'), 1e-3_wp, whole)
    call advance_pack(t, name, whole, 60)
    if (comm%rank == 0) call dump_next(name, 'one', whole, alone, 0.0_wp, 0.0_wp)
    call start_split(name, 'disks', split)
    ! Builds with checks would stop where an infinity makes a value that is no number.
    call ieee_get_halting_mode(ieee_invalid, halts)
    call ieee_set_halting_mode(ieee_invalid, .false.)
    breaking%options = split%options%solver
    breaking%partition = split%options%partition
    deallocate (split%solver)
    allocate (split%solver, source=breaking)
    call advance(split, error)
    call t%check(allocated(error), name//': the step breaks on all ranks')
    call t%check(split%dump%is_begun, name//': a dump has begun without being asked for')
    call finish_dump(split%dump, split%problem, 'many', 'a test', 61, split%comm, file, error)
    call t%check(.not. allocated(error), name//': dumped')
    call ieee_set_flag(ieee_invalid, .false.)
    call ieee_set_halting_mode(ieee_invalid, halts)
    if (comm%rank == 0) call compare(name, file, .false.)
  end subroutine test_broken_step

  !> Dump the problem of the next step, and solve it.
  subroutine dump_next(name, folder, sim, ranks, cohesion, compliance)
    character(len=*), intent(in) :: name, folder
    type(simulation_t), intent(inout) :: sim
    type(comm_t), intent(inout) :: ranks
    real(wp), intent(in) :: cohesion, compliance
    type(problem_t) :: problem
    type(dump_t) :: dump
    type(report_t) :: report
    type(error_t), allocatable :: error
    character(len=:), allocatable :: file

    call next_problem(sim, problem)
    if (problem%kind == arm_frictional) then
      problem%record(arm_cohesion, :) = cohesion
      problem%record(arm_compliance_n:arm_compliance_t, :) = compliance
    end if
    call begin_dump(dump, problem, sim%decomposition%subdomain, sim%pairs%slot_of, ranks)
    call sim%solver%solve(problem, sim%decomposition%subdomain%by_slot(sim%pairs%slot_of), ranks, report)
    call t%check(report%is_finite, name//': finite velocities')
    call finish_dump(dump, problem, folder, 'a test', 61, ranks, file, error)
    if (allocated(error)) write (*, '(a)') error%report()
    call t%check(.not. allocated(error), name//': dumped')
  end subroutine dump_next

  !> Compare two files row by row.
  subroutine compare(name, file, is_global)
    character(len=*), intent(in) :: name, file
    logical, intent(in) :: is_global
    type(matrix_problem_t) :: one, many
    real(wp), allocatable :: w(:, :), other(:, :), mass(:), masses(:)
    integer, allocatable :: order(:), orders(:), row(:), rows(:)
    integer :: k, i, d

    call read_both(name, file, one, many)
    if (one%n /= many%n .or. one%n < 20) return
    d = one%d
    order = order_of(name, one)
    orders = order_of(name, many)
    row = [((d*(order(k) - 1) + i, i=1, d), k=1, one%n)]
    rows = [((d*(orders(k) - 1) + i, i=1, d), k=1, one%n)]
    w = full(sparse_from_blocks(one%w))
    other = full(sparse_from_blocks(many%w))
    call t%near(maxval(abs(w(row, row) - other(rows, rows))), 0.0_wp, rounding*maxval(abs(w)), name//': W of '//file)
    call t%near(maxval(abs(one%q(:, order) - many%q(:, orders))), 0.0_wp, rounding*maxval(abs(one%q)), name//': q of '//file)
    call t%near(maxval(abs(one%r(:, order) - many%r(:, orders))), 0.0_wp, rounding*maxval(abs(one%r)), name//': guess of '//file)
    call t%check(maxval(abs(one%r)) > 0, name//': there is a guess')
    call t%near(maxval(abs(one%friction(order) - many%friction(orders))), 0.0_wp, 0.0_wp, name//': friction of '//file)
    if (is_global) then
      mass = one%mass%value
      masses = many%mass%value
      call t%equal(size(masses), size(mass), name//': unknown velocities')
      call t%near(maxval(masses), maxval(mass), rounding*maxval(mass), name//': largest mass')
      call t%near(sum(masses), sum(mass), rounding*sum(mass), name//': sum of masses')
      call t%near(norm2(many%offset), norm2(one%offset), rounding*(norm2(one%offset) + maxval(abs(one%q))), name//': offsets')
      call t%near(norm2(many%f), norm2(one%f), rounding*norm2(one%f), name//': loads')
    end if
    call check_solution(name, file, many)
  end subroutine compare

  !> Read the files of one rank and of all.
  subroutine read_both(name, file, one, many)
    character(len=*), intent(in) :: name, file
    type(matrix_problem_t), intent(out) :: one, many
    type(error_t), allocatable :: error
    logical :: has_guess

    call read_fclib('one/'//file, .true., one, has_guess, error)
    call t%check(.not. allocated(error) .and. has_guess, name//': read of one rank, '//file)
    call read_fclib('many/'//file, .true., many, has_guess, error)
    if (allocated(error)) write (*, '(a)') error%report()
    call t%check(.not. allocated(error) .and. has_guess, name//': read of all, '//file)
    call t%equal(many%n, one%n, name//': contacts of '//file)
    call t%check(one%n >= 20, name//': enough contacts')
  end subroutine read_both

  !> Contacts by a sum of numbers of theirs and of their neighbours, of which no two have the same.
  function order_of(name, problem) result(order)
    character(len=*), intent(in) :: name
    type(matrix_problem_t), intent(in) :: problem
    integer :: order(problem%n), k, first, round
    real(wp) :: key(problem%n), before(problem%n), largest, speed, impulse

    largest = maxval(abs(problem%w%block))
    speed = maxval(abs(problem%q))
    impulse = maxval(abs(problem%r))
    do k = 1, problem%n
      associate (block => problem%w%block(:, :, problem%w%diagonal(k)))
        key(k) = (block(1, 1) + 0.39_wp*block(problem%d, problem%d))/largest &
                 + (0.61_wp*problem%q(1, k) + 0.17_wp*problem%q(2, k) + 0.13_wp*problem%q(problem%d, k))/speed &
                 + 0.23_wp*(problem%r(1, k) + abs(problem%r(2, k)))/impulse
      end associate
    end do
    ! Where two are alike, as at a grain between two walls, their neighbours are not.
    do round = 1, 2
      before = key
      do k = 1, problem%n
        associate (first => problem%w%first(k), last => problem%w%first(k + 1) - 1)
          key(k) = key(k) + 0.3_wp*sum(abs(problem%w%block(1, 1, first:last))*before(problem%w%column(first:last)))/largest
        end associate
      end do
    end do
    order = [(k, k=1, problem%n)]
    do k = 1, problem%n
      first = k - 1 + minloc(key(order(k:)), 1)
      order([k, first]) = order([first, k])
    end do
    call t%check(all(key(order(2:)) - key(order(:problem%n - 1)) > 1e-11_wp), &
                 name//': no two contacts have the same numbers')
  end function order_of

  !> Relative velocities of the solution are those of its impulses, and so are those of the guess.
  subroutine check_solution(name, file, problem)
    character(len=*), intent(in) :: name, file
    type(matrix_problem_t), intent(in) :: problem
    character(len=10), parameter :: states(2) = [character(len=10) :: '/guesses/1', '/solution']
    type(hdf5_file_t) :: stored
    real(wp), allocatable :: r(:), u(:), caused(:, :)
    integer :: i

    allocate (caused(problem%d, problem%n))
    call stored%open('many/'//file, .true.)
    call t%check(stored%has('/solution') .neqv. name == 'broken disks', name//': a solution, but of what is broken')
    do i = 1, merge(2, 1, stored%has('/solution'))
      call stored%get(trim(states(i))//'/r', r)
      call stored%get(trim(states(i))//'/u', u)
      call t%check(.not. allocated(stored%error), name//': states of '//file)
      if (allocated(stored%error)) exit
      call multiply(problem%w, reshape(r, [problem%d, problem%n]), caused)
      caused = caused + problem%q
      ! Velocities are kept up by sweeps: some hundred roundings of the largest ones.
      call t%near(maxval(abs(u - reshape(caused, [size(u)]))), 0.0_wp, 100*rounding*maxval(abs(problem%q)), &
                  name//': velocities of '//trim(states(i))//' in '//file)
    end do
    call stored%close()
  end subroutine check_solution
end program test_dump_ranks
