!> Contacts that the first sweeps of a calm problem visit by the guess alone: those with an impulse, and those that do not part fast
!! without one; and all where few are open. For all kinds of shapes, with friction and without, and with laws that hold contacts
!! which open.
program test_active_set
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_active_set, only: active_set_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_residuals, only: n_error_sums, sum_errors
  use sg_simulation, only: simulation_t
  implicit none
  character(len=13), parameter :: names(4) = [character(len=13) :: 'pressed disks', 'polygons', 'spheres', 'polyhedra']
  character(len=*), parameter :: rough = 'friction = 0.5', smooth = 'friction = 0.0', &
    wet = rough//new_line('a')//'kind = "IQS_WET_DS_CLB"'//new_line('a')//'normal_cohesion = 0.1'//new_line('a')// &
          'wet_thickness = 1e-3'
  ! The same velocities in other products and sums, of bodies that are 100 times faster.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t
  integer :: i

  do i = 1, size(names)
    if (.not. can_be_made(trim(names(i)))) cycle
    call test_pack(trim(names(i)), '', rough)
    call test_pack(trim(names(i)), ' without friction', smooth)
    call test_pack(trim(names(i)), ' that hold together', wet)
  end do
  call t%finish()

contains

  !> A problem of a pack with some law: what it says of contacts without impulses, and which ones are chosen by that.
  subroutine test_pack(pack, kind, law)
    character(len=*), intent(in) :: pack, kind, law
    character(len=:), allocatable :: name, deck
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem
    integer :: at, k

    sim => fresh()
    name = pack//kind
    deck = pack_deck(pack)
    at = index(deck, rough)
    call start_pack(t, sim%comm, name, deck(:at - 1)//law//deck(at + len(rough):), 1e-2_wp, sim)
    call advance_pack(t, name, sim, 60)
    call next_problem(sim, problem)
    call check_opening(name, law, problem)
    call choose(name, problem)
    ! One contact in twenty is open: all are visited.
    do k = 1, problem%n_contacts
      problem%impulse(1, k) = merge(0.0_wp, 1.0_wp, modulo(k, 20) == 0)
    end do
    call choose(name//', few open', problem)
    do k = 1, problem%n_contacts, 3
      problem%impulse(:, k) = 0
    end do
    call choose(name//', many open', problem)
  end subroutine test_pack

  !> Velocities without impulses, which a test of all contacts finds.
  subroutine check_opening(name, law, problem)
    character(len=*), intent(in) :: name, law
    type(problem_t), intent(in) :: problem
    type(problem_t) :: free
    real(wp) :: sums(n_error_sums)
    real(wp), allocatable :: closing(:)

    free = problem
    free%impulse = 0
    allocate (closing(free%n_contacts))
    call sum_errors(free, .false., sums, closing=closing)
    associate (opening => problem%opening(:free%n_contacts))
      call t%check(free%n_contacts > 50, name//': contacts')
      if (law == wet) then
        call t%check(any(opening <= -huge(1.0_wp)), name//': some are held')
        where (opening <= -huge(1.0_wp)) closing = -huge(1.0_wp)
      end if
      call t%check(all(abs(closing) >= huge(1.0_wp) .eqv. abs(opening) >= huge(1.0_wp)), name//': who takes part')
      call t%near(maxval(abs(closing - opening), abs(closing) < huge(1.0_wp)), 0.0_wp, &
                  rounding*maxval(abs(problem%body(1:3, :))) + rounding*maxval(abs(opening), abs(opening) < huge(1.0_wp)), &
                  name//': velocities without impulses')
    end associate
  end subroutine check_opening

  !> Which problems are calm, and the choice, at several speeds of a step's fall.
  subroutine choose(name, problem)
    character(len=*), intent(in) :: name
    type(problem_t), intent(inout) :: problem
    type(active_set_t) :: active_set
    real(wp) :: fall_speed, hit
    logical :: is_open(problem%n_contacts), is_visited(problem%n_contacts)
    integer :: s, k

    fall_speed = problem%fall_speed
    is_open = [(all(abs(problem%impulse(:, k)) <= 0), k=1, problem%n_contacts)]
    hit = 0
    do k = 1, problem%n_contacts
      if (is_open(k) .and. problem%opening(k) > -huge(1.0_wp)) hit = max(hit, -problem%opening(k))
    end do
    call active_set%begin(problem%n_contacts, .false.)
    do s = -3, 3
      problem%fall_speed = fall_speed*4.0_wp**s
      call active_set%look(problem)
      call t%check(active_set%is_calm .eqv. hit <= problem%fall_speed, name//': calm or not')
      is_visited = .not. is_open .or. problem%opening(:problem%n_contacts) <= 1.25_wp*problem%fall_speed
      if (count(is_open) <= problem%n_contacts/16) is_visited = .true.
      call active_set%choose_by_guess(problem)
      call t%check(all(active_set%is_wanted(:problem%n_contacts) .eqv. is_visited), name//': the choice')
    end do
    problem%fall_speed = 0
    call active_set%look(problem)
    call t%check(.not. active_set%is_calm, name//': without gravity nothing is calm')
    problem%fall_speed = fall_speed
  end subroutine choose
end program test_active_set
