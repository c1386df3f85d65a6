!> Rounds in which the damage of a step settles: bonds that share a load settle instead of taking it from each other in turns, and
!! where damage has not settled the report has the velocity by which the solution breaks the law.
program test_damage_rounds
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: start_pack
  use scenes, only: begin_run, begin_scene, put_disk, put_wall, run
  use scenes_space, only: begin_space_scene, put_plane, put_sphere
  use sg_advance, only: advance
  use sg_choose_solver, only: choose_solver
  use sg_cohesive_zones, only: integrity_after
  use sg_comm, only: comm_t
  use sg_contacts, only: impulse_vector
  use sg_error, only: error_t
  use sg_internal_values, only: bond_integrity, bond_opening, bond_slip
  use sg_kinds, only: wp, pi
  use sg_laws, only: is_cohesive_zone, law_mal
  use sg_run_options, only: criterion_estimate
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t
  use sg_text, only: to_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  real(wp), parameter :: radius = 0.5_wp, h = 1e-3_wp, stiffness = 1e6_wp, weight = 1e-8_wp
  type(tests_t) :: t
  integer :: dimension

  do dimension = 2, 3
    call test_overload(dimension)
  end do
  call test_walls('walls', 6, 6, 8, .true.)
  call test_walls('small walls', 12, 2, 3, .false.)
  call t%finish()

contains

  !> A light grain hangs on a bond and is pulled by a thousandth more than the bond's strength: the opening passes the one at the
  !! peak so slowly that 200 rounds do not see the end of it. The bond is then weaker by what the last solution did than it was
  !! solved for, and that impulse, too large, moves the contact by itself times its block of W with the bond.
  subroutine test_overload(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    real(wp) :: mass, surface, p(3), pull, opening, now, solved, excess, block

    call hang(dimension, sim)
    mass = sim%scene%bodies%mass(1)
    surface = merge(radius, pi*radius**2, dimension == 2)
    sim%scene%gravity(dimension) = (1 + 1e-3_wp)*1000*surface/mass
    call run(sim, 1)
    call t%check(.not. sim%report%is_converged, 'overload: not settled')
    p = impulse_vector(sim%contacts, 1)
    pull = -p(dimension)
    opening = sim%contacts%internal(bond_opening, 1)
    now = sim%contacts%internal(bond_integrity, 1)
    solved = pull/(h*surface*stiffness*opening)
    excess = h*surface*stiffness*opening*(solved - now)
    block = max(1/(mass + h**2*surface*stiffness*now), &
                1/(mass/merge(3.0_wp, 3.5_wp, dimension == 2) + 2*h**2*surface*stiffness*now))
    call t%check(excess > 0, 'overload: the bond got weaker in the last round')
    call t%near(sim%report%worst_speed, excess*block, 1e-6_wp*excess*block, 'overload: velocity by which the law is broken')
    call t%equal(sim%report%worst_contact, 1, 'overload: its contact')
    call t%near(now, integrity_after(sim%scene%laws(1), opening, 0.0_wp, 1.0_wp, h), 1e-14_wp, &
                'overload: integrity of the solution')
  end subroutine test_overload

  !> A grain almost without inertia that touches a wall from above, bonded.
  subroutine hang(dimension, sim)
    integer, intent(in) :: dimension
    type(simulation_t), pointer, intent(out) :: sim

    sim => fresh()
    if (dimension == 2) then
      call begin_scene(sim%scene, 2, 0.3_wp, 0.3_wp)
      call put_disk(sim%scene, 1, radius, [0.0_wp, radius])
      call put_wall(sim%scene, 2, 3.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    else
      call begin_space_scene(sim%scene, 2, 0.3_wp, 0.3_wp)
      call put_sphere(sim%scene, 1, radius, [0.0_wp, 0.0_wp, radius])
      call put_plane(sim%scene, 2, [3.0_wp, 3.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    end if
    associate (bodies => sim%scene%bodies)
      bodies%mass(1) = weight*bodies%mass(1)
      bodies%inverse_mass(:, 1) = bodies%inverse_mass(:, 1)/weight
      if (dimension == 2) bodies%inertia(1) = weight*bodies%inertia(1)
      if (dimension == 3) bodies%principal(:, 1) = weight*bodies%principal(:, 1)
    end associate
    sim%scene%gravity = 0
    associate (law => sim%scene%laws(1))
      law%kind = law_mal
      law%zone_stiffness = [stiffness, 2*stiffness]
      law%normal_strength = 1000
      law%tangential_strength = 1000
      law%zone_energy = 100
    end associate
    call begin_run(sim, h, 1e-12_wp)
    sim%options%solver%maximum_sweeps = 200
    call choose_solver(sim%options%solver, sim%solver)
  end subroutine hang

  !> Walls of bricks over a support that settles, with random bonds: in all steps damage settles, and no bond is stronger than its
  !! law has it.
  subroutine test_walls(name, n, rows, columns, has_dry)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n, rows, columns
    logical, intent(in) :: has_dry !! are supports dry and a load on top? Else all contacts are bonded, those between supports too
    type(random_t) :: random
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    type(comm_t) :: comm
    integer :: i, step, unconverged, damaged
    real(wp) :: excess

    call random%seed(14)
    unconverged = 0
    damaged = 0
    excess = 0
    do i = 1, n
      sim => fresh()
      call start_pack(t, comm, 'wall '//to_text(i), wall_deck(random, rows, columns, has_dry), 2e-2_wp, sim)
      sim%options%solver%criterion = criterion_estimate
      call choose_solver(sim%options%solver, sim%solver)
      do step = 1, 40
        call advance(sim, error)
        if (allocated(error)) exit
        if (.not. sim%report%is_converged) unconverged = unconverged + 1
        excess = max(excess, excess_of(sim))
      end do
      call t%check(.not. allocated(error), 'a wall runs')
      if (any(sim%contacts%internal(bond_integrity, :sim%contacts%n) < 0.9_wp)) damaged = damaged + 1
    end do
    call t%equal(unconverged, 0, name//': steps that have not converged')
    call t%check(damaged >= n - 1, name//': bonds are damaged')
    call t%near(excess, 0.0_wp, 1e-12_wp, name//': no bond is stronger than its law has it')
  end subroutine test_walls

  !> By how much an integrity exceeds what the law has at its opening and slip.
  real(wp) function excess_of(sim) result(excess)
    type(simulation_t), intent(in) :: sim
    integer :: k

    excess = 0
    do k = 1, sim%contacts%n
      associate (law => sim%scene%laws(sim%contacts%law(k)), values => sim%contacts%internal(:, k))
        if (.not. is_cohesive_zone(law)) cycle
        excess = max(excess, values(bond_integrity) - integrity_after(law, values(bond_opening), values(bond_slip), 1.0_wp, h))
      end associate
    end do
  end function excess_of

  !> Rows of bricks in running bond on three supports, the middle one of which goes down; under a load where supports are dry.
  function wall_deck(random, rows, columns, has_dry) result(deck)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: rows, columns
    logical, intent(in) :: has_dry
    character(len=:), allocatable :: deck
    real(wp) :: k, strength, energy, x, y, width, ends
    integer :: row, i

    k = 10**random%uniform(8.5_wp, 9.5_wp)
    strength = 10**random%uniform(3.5_wp, 4.0_wp)
    ! The tangential strength is the larger one: at least half of its square over the stiffness.
    energy = random%uniform(2.0_wp, 8.0_wp)*strength**2/k
    deck = '[time]'//nl//'step = 1e-3'//nl//'steps = 40'//nl//'[[material]]'//nl//'name = "brick"'//nl//'density = 2000.0'//nl// &
           '[[law]]'//nl//'name = "joint"'//nl//'kind = "IQS_MAL_CZM"'//nl//'friction = 0.6'//nl// &
           'normal_stiffness = '//to_text(k)//nl//'tangential_stiffness = '//to_text(k)//nl// &
           'normal_strength = '//to_text(strength)//nl//'tangential_strength = '//to_text(1.5_wp*strength)//nl// &
           'normal_energy = '//to_text(energy)//nl//'tangential_energy = '//to_text(2*energy)//nl// &
           '[[interaction]]'//nl//'candidate = "brick"'//nl//'antagonist = "brick"'//nl//'law = "joint"'//nl//'alert = 5e-3'//nl
    if (has_dry) deck = deck//'[[law]]'//nl//'name = "dry"'//nl//'kind = "IQS_CLB"'//nl//'friction = 0.1'//nl
    width = 0.4_wp*real(columns, wp)
    ends = 0.4_wp*real((columns + 3)/4, wp)
    deck = deck//'[[interaction]]'//nl//'candidate = "any"'//nl//'antagonist = "any"'//nl// &
           'law = "'//trim(merge('dry  ', 'joint', has_dry))//'"'//nl//'alert = 5e-3'//nl// &
           box('support', 'left', 0.0_wp, ends, -0.1_wp, 0.0_wp)//'fixed = true'//nl// &
           box('support', 'right', width - ends, width, -0.1_wp, 0.0_wp)//'fixed = true'//nl// &
           box('support', 'middle', ends, width - ends, -0.1_wp, 0.0_wp)// &
           '[[drive]]'//nl//'body = "middle"'//nl//'component = "x"'//nl//'[[drive]]'//nl//'body = "middle"'//nl// &
           'component = "y"'//nl//'value = '//to_text(-random%uniform(5e-3_wp, 2e-2_wp))//nl// &
           '[[drive]]'//nl//'body = "middle"'//nl//'component = "rotation"'//nl
    if (has_dry) deck = deck//box('load', 'load', width/2 - 0.4_wp, width/2 + 0.4_wp, 0.2_wp*real(rows, wp), &
                                  0.2_wp*real(rows, wp) + 0.3_wp)//'mass = 6000.0'//nl//'inertia = 365.0'//nl
    do row = 0, rows - 1
      y = 0.2_wp*real(row, wp)
      do i = 0, columns - 1 + modulo(row, 2)
        x = 0.4_wp*real(i, wp) - 0.2_wp*real(modulo(row, 2), wp)
        deck = deck//box('brick', '', max(0.0_wp, x), min(width, x + 0.4_wp), y, y + 0.2_wp)
      end do
    end do
  end function wall_deck

  !> A rectangle as a polygon.
  function box(colour, name, left, right, low, high) result(text)
    character(len=*), intent(in) :: colour, name
    real(wp), intent(in) :: left, right, low, high
    character(len=:), allocatable :: text

    text = '[[body]]'//nl//'colour = "'//colour//'"'//nl//'shape = "polygon"'//nl//'vertices = ['//corner(left, low)//', '// &
           corner(right, low)//', '//corner(right, high)//', '//corner(left, high)//']'//nl
    if (name /= '') text = text//'name = "'//name//'"'//nl
  end function box

  !> A point.
  function corner(x, y) result(text)
    real(wp), intent(in) :: x, y
    character(len=:), allocatable :: text

    text = '['//to_text(x)//', '//to_text(y)//']'
  end function corner
end program test_damage_rounds
