!> Coloured order: blocks of one colour touch no body in common; the same bits for any number of threads; as few sweeps as other
!! orders, nearly; and what is said where threads cannot be had.
program test_threads
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use same_bits, only: same
  use scenes, only: begin_scene, put_disk, put_polygon, put_wall
  use sg_benchmark_scenes, only: make_lattice
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4, i8
  use sg_nlgs, only: nlgs_t
  use sg_order_values, only: give_impulses
  use sg_problem, only: problem_t
  use sg_random, only: random_t
  use sg_records, only: arm_frictional, arm_frictionless, ball_frictional, ball_frictionless, round_frictional, &
                        round_frictionless, solid_frictional
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8, criterion_quad, run_options_t, solver_options_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  use sg_sweep_colouring, only: colour_blocks, sweep_colouring_t
  use sg_sweep_order, only: set_order, sweep_order_t
  use sg_sweeps, only: sweep, sweep_impulses
  use sg_text, only: text_t, to_text
  use sg_threads, only: threads_are_available
  use solver_cases, only: first_problem, solver_of
  use written_files, only: put_text
  implicit none
  character(len=18), parameter :: names(8) = [character(len=18) :: 'round frictionless', 'round frictional', &
                                              'arm frictionless', 'arm frictional', 'ball frictionless', 'ball frictional', &
                                              'solid frictionless', 'solid frictional']
  type(tests_t) :: t
  integer :: kind

  if (.not. threads_are_available()) print '(a)', 'built without OpenMP: coloured order is tested on one thread'
  call test_colours(3000, 40000, 3)
  call test_colours(50000, 40000, 0)
  call test_colours(40, 6000, 0)
  call test_colours(10, 5, 0)
  do kind = round_frictionless, solid_frictional
    call test_kind(kind)
  end do
  call test_keys()
  call t%finish()

contains

  !> Contacts between bodies near in number, several of a pair in a row, and walls that many touch.
  subroutine test_colours(n_bodies, n, n_walls)
    integer, intent(in) :: n_bodies, n, n_walls
    type(sweep_colouring_t) :: blocks
    type(random_t) :: random
    integer(i4) :: pair(2, n), chosen(n)
    integer(i8) :: colours_of(n_bodies)
    integer :: seen(n_bodies), times(n), c, b, i, k, first
    logical :: is_apart, is_whole

    call random%seed(7)
    do k = 1, n
      first = 1 + int(int(k - 1, i8)*int(n_bodies - 9, i8)/int(n, i8))
      pair(:, k) = int([first, first + int(random%uniform(1.0_wp, 8.99_wp))], i4)
      if (random%uniform() < 0.02_wp .and. n_walls > 0) pair(2, k) = int(n_bodies - modulo(k, n_walls), i4)
      if (k > 1 .and. random%uniform() < 0.3_wp) pair(:, k) = pair(:, k - 1)
      chosen(k) = int(k, i4)
    end do
    colours_of = 0
    call colour_blocks(blocks, pair, colours_of, chosen)
    times = 0
    do i = 1, n
      times(chosen(i)) = times(chosen(i)) + 1
    end do
    call t%check(all(times == 1), 'every contact is in one block')
    call t%check(all(colours_of == 0), 'the room is left empty')
    call t%equal(blocks%last(blocks%n), n, 'blocks hold all')
    call t%equal(blocks%last_of_colour(blocks%n_colours), blocks%n, 'colours hold all')
    is_apart = .true.
    do c = 1, blocks%n_colours
      seen = 0
      do b = blocks%last_of_colour(c - 1) + 1, blocks%last_of_colour(c)
        do i = blocks%last(b - 1) + 1, blocks%last(b)
          is_apart = is_apart .and. all(seen(pair(:, chosen(i))) == 0 .or. seen(pair(:, chosen(i))) == b)
          seen(pair(:, chosen(i))) = b
        end do
      end do
    end do
    call t%check(is_apart, 'blocks of a colour share no body')
    is_whole = .true.
    do b = 1, blocks%n - 1
      associate (i => blocks%last(b))
        ! Of few bodies some parts have no contact of their own.
        if (i > 0 .and. i < n) is_whole = is_whole .and. any(pair(:, chosen(i)) /= pair(:, chosen(i + 1)))
      end associate
    end do
    call t%check(is_whole, 'contacts of a pair stay together')
    ! Blocks are long beside the reach of contacts: they meet the next ones and those of walls, of which there are few.
    if (n_bodies > 1000) call t%check(blocks%n_colours <= 8, 'there are few colours')
  end subroutine test_colours

  !> A problem of some thousand contacts: lattices that flow together, and a heap with polygons.
  subroutine make_problem(kind, problem)
    integer, intent(in) :: kind
    type(problem_t), intent(out) :: problem
    type(simulation_t), pointer :: sim
    real(wp) :: friction

    sim => fresh()
    friction = merge(0.3_wp, 0.0_wp, modulo(kind, 2) == 0)
    select case (kind)
    case (round_frictionless, round_frictional)
      call make_lattice(sim%scene, 'disk', 6000, friction)
    case (arm_frictionless, arm_frictional)
      call make_heap(sim%scene, friction)
    case (ball_frictionless, ball_frictional)
      call make_lattice(sim%scene, 'sphere', 6000, friction)
    case default
      call make_lattice(sim%scene, 'polyhedron', 9000, friction)
    end select
    call first_problem(sim, problem)
    call t%equal(problem%kind, kind, trim(names(kind))//': the kind is as planned')
    call t%check(problem%n_contacts > 3000, trim(names(kind))//': there are contacts: '//to_text(problem%n_contacts))
  end subroutine make_problem

  !> Disks and squares in turns on a wide floor.
  subroutine make_heap(scene, friction)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: friction
    integer, parameter :: columns = 100, rows = 36
    real(wp), parameter :: square(2, 4) = 0.48_wp*reshape([1.0_wp, 0.1_wp, -0.1_wp, 1.0_wp, -1.0_wp, -0.1_wp, 0.1_wp, -1.0_wp], &
                                                         [2, 4])
    type(random_t) :: random
    real(wp) :: place(2)
    integer :: b

    call random%seed(2)
    call begin_scene(scene, columns*rows + 1, friction, 0.05_wp)
    do b = 1, columns*rows
      place = [real(modulo(b - 1, columns), wp) + 0.5_wp*real(modulo((b - 1)/columns, 2), wp), 0.87_wp*real((b - 1)/columns, wp)]
      if (modulo(b, 2) == 0) then
        call put_polygon(scene, b, spread(place, 2, 4) + square)
      else
        call put_disk(scene, b, random%uniform(0.49_wp, 0.51_wp), place)
      end if
      scene%bodies%velocity(1:2, b) = 0.1_wp*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
    end do
    call put_wall(scene, columns*rows + 1, 200.0_wp, 0.1_wp, [50.0_wp, -0.6_wp], 0.0_wp)
  end subroutine make_heap

  !> All numbers of threads give the same; so does a sweep one by one through the order, and other orders, to rounding or the error.
  subroutine test_kind(kind)
    integer, intent(in) :: kind
    type(problem_t) :: start, one, many
    type(report_t) :: report
    integer :: threads, try

    call make_problem(kind, start)
    call test_one_by_one(kind, start)
    call solve(start, 'coloured', 1, 45, one, report)
    call t%check(maxval(abs(one%impulse(:, :one%n_contacts))) > 0, trim(names(kind))//': contacts carry')
    do threads = 2, merge(4, 1, threads_are_available())
      do try = 1, 2
        call solve(start, 'coloured', threads, 45, many, report)
        call t%check(same(one%impulse(:, :one%n_contacts), many%impulse(:, :many%n_contacts)) .and. same(one%body, many%body), &
                     trim(names(kind))//': the same bits by '//to_text(threads)//' threads')
      end do
    end do
    call test_sweeps(kind, start)
  end subroutine test_kind

  !> Two sweeps in coloured order are sweeps one by one through the contacts as ordered.
  subroutine test_one_by_one(kind, start)
    integer, intent(in) :: kind
    type(problem_t), intent(in) :: start
    type(problem_t) :: blocks
    type(solver_options_t) :: options
    type(sweep_order_t) :: order
    real(wp), allocatable :: impulse(:, :), body(:, :)
    logical, allocatable :: is_wanted(:)
    real(wp) :: largest
    integer :: i

    allocate (is_wanted(start%n_contacts), source=.true.)
    options%order = 'coloured'
    options%threads = merge(2, 1, threads_are_available())
    options%criterion = criterion_quad ! looks at records one by one
    call set_order(order, start, is_wanted, options)
    call t%check(order%blocks%n > 4, trim(names(kind))//': there are blocks')
    blocks = start
    allocate (impulse(size(order%impulse, 1), size(order%impulse, 2)), body(size(start%body, 1), size(start%body, 2)))
    impulse(:, :order%n) = order%impulse(:, :order%n)
    body(:, :) = start%body
    do i = 1, 2
      call sweep(kind, order, start%n_bodies, 1.0_wp, blocks%body)
      call sweep_impulses(kind, order, start%n_bodies, 1.0_wp, impulse, body)
    end do
    call give_impulses(order, blocks)
    ! In lanes sums are done in another order.
    call t%near(maxval(abs(blocks%body - body)), 0.0_wp, 1e-12_wp*maxval(abs(body)), trim(names(kind))//': velocities one by one')
    largest = maxval(abs(impulse(:, :order%n)))
    call t%near(maxval(abs(order%impulse(:, :order%n) - impulse(:, :order%n))), 0.0_wp, 1e-11_wp*largest, &
                trim(names(kind))//': impulses one by one')
  end subroutine test_one_by_one

  !> Sweeps to an error: no more than a fifth above those in groups.
  subroutine test_sweeps(kind, start)
    integer, intent(in) :: kind
    type(problem_t), intent(in) :: start
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: groups, coloured, natural

    solver = solver_of(criterion_e8, 1e-3_wp, 20000)
    solver%options%check_every = 5
    problem = start
    call solver%solve(problem, groups)
    solver%options%order = 'natural'
    problem = start
    call solver%solve(problem, natural)
    solver%options%order = 'coloured'
    problem = start
    call solver%solve(problem, coloured)
    call t%check(groups%is_converged .and. coloured%is_converged, trim(names(kind))//': converged')
    print '(a,3(a,i0))', names(kind), ': sweeps in natural order ', natural%sweeps, ', groups ', groups%sweeps, ', coloured ', &
      coloured%sweeps
    call t%check(5*coloured%sweeps <= 6*groups%sweeps + 25, trim(names(kind))//': few sweeps more')
  end subroutine test_sweeps

  !> Some sweeps with a test now and then, after which orders are rebuilt.
  subroutine solve(start, order, threads, sweeps, problem, report)
    type(problem_t), intent(in) :: start
    character(len=*), intent(in) :: order
    integer, intent(in) :: threads, sweeps
    type(problem_t), intent(out) :: problem
    type(report_t), intent(out) :: report
    type(nlgs_t) :: solver

    problem = start
    solver = solver_of(criterion_e8, tiny(1.0_wp), sweeps)
    solver%options%check_every = 5
    solver%options%order = order
    solver%options%threads = threads
    call solver%solve(problem, report)
  end subroutine solve

  !> Threads in a deck.
  subroutine test_keys()
    if (threads_are_available()) then
      call read_keys('threads = 3'//new_line('a')//'order = "coloured"', '')
      call read_keys('threads = 2', '')
    else
      call read_keys('threads = 2', 'this program was built without OpenMP, which more than one thread needs')
    end if
    call read_keys('threads = 1'//new_line('a')//'order = "coloured"', '')
    call read_keys('threads = 0', 'must be at least 1')
  end subroutine test_keys

  !> Read a deck with these keys: no mistake, or one that says so.
  subroutine read_keys(keys, mistake)
    character(len=*), intent(in) :: keys, mistake
    character(len=*), parameter :: nl = new_line('a'), file = 'test_threads.toml'
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    type(text_t) :: none(0)

    call put_text(file, '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl//'name = "stone"'//nl// &
                  'density = 2000'//nl//'[[law]]'//nl//'[[sample]]'//nl//'kind = "lattice"'//nl// &
                  'box = [0.0, 0.0, 1.0, 1.0]'//nl//'count = 4'//nl//'radius = 0.05'//nl//'[solver]'//nl//keys//nl)
    call read_deck(file, none, scene, options, diagnostics)
    call t%equal(diagnostics%count(), merge(0, 1, mistake == ''), 'mistakes in '//keys)
    if (diagnostics%count() == 0) return
    call t%check(index(diagnostics%errors(1)%message, mistake) > 0 .and. mistake /= '', keys//': '//diagnostics%errors(1)%message)
  end subroutine read_keys
end program test_threads
