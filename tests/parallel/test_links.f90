!> Links on several ranks: a net with a stone in it, masses on wires across the whole scene, and a ring of rods about a period move
!! as on one rank, whichever way they are glued and however often they are repartitioned.
program test_links
  use fresh_simulations, only: fresh, run_t
  use harness, only: tests_t
  use link_scenes, only: begin_links, link, put_mass
  use packs, only: advance_pack
  use sg_comm, only: comm_t
  use sg_contactors, only: add_disk
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_laws, only: law_bond, law_linear, law_rod, law_t, law_wire, status_broken
  use sg_links, only: add_link, locate_links
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: decompose, simulation_t, start_simulation
  use sg_space_contactors, only: add_sphere
  use subdomain_tests, only: on_subdomains
  implicit none
  !> Steps on all ranks, steps per repartition, and number of partitions
  integer, parameter :: steps = 60, every = 25, splits = 3
  character(len=8), parameter :: gluings(3) = [character(len=8) :: 'dual', 'primal', 'momentum']

  type(tests_t) :: t
  !> Runs on one rank, by dimension and kind of net: all numbers of ranks and all ways of gluing are compared with them
  type(run_t), save :: wholes(2:3, 4)
  integer :: d, k

  do d = 2, 3
    do k = 1, 4
      call run_whole(d, k)
    end do
  end do
  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm
    integer :: dimension, kind, g

    if (comm%size == 1) return
    do dimension = 2, 3
      do kind = 1, 4
        do g = 1, size(gluings)
          call test_net(comm, dimension, kind, trim(gluings(g)))
        end do
      end do
    end do
  end subroutine run_tests

  !> Name of a case.
  function name_of(dimension, kind) result(name)
    integer, intent(in) :: dimension, kind
    character(len=:), allocatable :: name

    name = merge('plane', 'space', dimension == 2)//', net '//achar(iachar('0') + kind)
  end function name_of

  !> A net of masses, held at two ends, on one rank.
  subroutine run_whole(dimension, kind)
    integer, intent(in) :: dimension, kind
    type(simulation_t), pointer :: whole
    character(len=:), allocatable :: name

    name = name_of(dimension, kind)
    call begin(dimension, kind, 'dual', whole)
    call advance_pack(t, name, whole, steps)
    call t%check(maxval(norm2(whole%scene%bodies%velocity(:dimension, :), 1)) > 0.1_wp, name//': it moves')
    call t%equal(whole%contacts%n, whole%scene%links%n, name//': every link is a contact')
    if (kind == 4) call t%check(count(whole%contacts%status(:whole%contacts%n) == status_broken) > 0 .and. &
                                count(whole%contacts%status(:whole%contacts%n) /= status_broken) > 50, name//': some bonds break')
    wholes(dimension, kind)%sim => whole
  end subroutine run_whole

  !> The net on several ranks.
  subroutine test_net(comm, dimension, kind, gluing)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension, kind
    character(len=*), intent(in) :: gluing
    type(simulation_t), pointer :: whole, part
    type(error_t), allocatable :: error
    character(len=:), allocatable :: name
    real(wp) :: miss
    integer :: b, i

    name = name_of(dimension, kind)//', '//gluing
    whole => wholes(dimension, kind)%sim
    call begin(dimension, kind, gluing, part)
    part%comm = comm
    part%options%partition%every = every
    call decompose(part, error)
    call t%check(.not. allocated(error), name//' is split')
    call advance_pack(t, name, part, steps)
    call t%check(part%report%e8 <= part%options%solver%tolerance, name//': residual of the whole')
    call t%equal(part%all_contacts, whole%contacts%n, name//': links of all ranks')
    call t%equal(part%decomposition%subdomain%splits, splits, name//': splits')
    miss = 0
    do i = 1, part%scene%bodies%n
      b = part%scene%bodies%id(i)
      miss = max(miss, maxval(abs(part%scene%bodies%velocity(:dimension, i) - whole%scene%bodies%velocity(:dimension, b))))
    end do
    ! Forces of links are unique; e8 of 1e-11 leaves some hundred times that of velocities about 1 m/s, in each of 60 steps.
    call t%near(miss, 0.0_wp, 1e-7_wp, name//': velocities as on one rank')
  end subroutine test_net

  !> Start a run on one rank.
  subroutine begin(dimension, kind, gluing, sim)
    integer, intent(in) :: dimension, kind
    character(len=*), intent(in) :: gluing
    type(simulation_t), pointer, intent(out) :: sim
    type(law_t) :: law

    sim => fresh()
    law = law_t(kind=law_rod, axial_stiffness=2e3_wp, axial_damping=5.0_wp)
    if (kind == 2) law = law_t(kind=law_wire, axial_stiffness=2e3_wp, axial_damping=5.0_wp)
    if (kind == 3) law = law_t(kind=law_linear, epsilon=5.0_wp)
    if (kind == 4) law = law_t(kind=law_bond, young=1e6_wp, poisson=0.2_wp, tangential_strength=1e9_wp, &
                               normal_strength=merge(1e4_wp, 5e3_wp, dimension == 2))
    call begin_links(sim%scene, 60, dimension, law)
    sim%scene%gravity(dimension) = -9.81_wp
    if (kind == 1) sim%scene%period = 6
    call make_net(sim%scene%dimension, kind, sim)
    sim%options%time_step = 2e-3_wp
    sim%options%partition%gluing = gluing
    sim%options%partition%imbalance = 1e3_wp
    sim%options%solver%criterion = criterion_e8
    sim%options%solver%tolerance = 1e-11_wp
    sim%options%solver%maximum_sweeps = 20000
    call start_simulation(sim)
  end subroutine begin

  !> Twelve columns of five masses, linked to their neighbours, the first column to the last one, and the ends to far masses.
  subroutine make_net(dimension, kind, sim)
    integer, intent(in) :: dimension, kind
    type(simulation_t), intent(inout) :: sim
    integer, parameter :: columns = 12, rows = 5
    real(wp) :: place(dimension)
    integer :: column, row, b

    do column = 1, columns
      do row = 1, rows
        b = rows*(column - 1) + row
        place = 0
        place(1) = 0.5_wp*real(column, wp) - 0.4_wp + 0.03_wp*sin(real(7*b, wp))
        place(2) = 0.4_wp*real(row, wp) + 0.02_wp*cos(real(5*b, wp))
        call put_mass(sim%scene, b, merge(0.0_wp, 1 + 0.1_wp*real(row, wp), mod(column, 6) == 0 .and. row == rows), place)
      end do
    end do
    ! Balls that touch nothing: as they move lists are rebuilt, and bodies come back into the period.
    do b = 1, columns*rows
      if (dimension == 2) call add_disk(sim%scene%contactors, b, 1, 0.05_wp, [0.0_wp, 0.0_wp])
      if (dimension == 3) call add_sphere(sim%scene%contactors, b, 1, 0.05_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    end do
    do column = 1, columns
      do row = 1, rows
        b = rows*(column - 1) + row
        if (row < rows) call link(sim%scene, b, b + 1, 0.38_wp, [2e-3_wp, 0.01_wp])
        if (column < columns) call link(sim%scene, b, b + rows, 0.49_wp, [2e-3_wp, 0.01_wp])
        ! Across the whole scene, or across the period.
        if (column > 1 .or. row == 3) cycle
        call add_link(sim%scene%links, [b, b + rows*(columns - 1)], [merge(-1, 0, kind == 1), 0], 1, &
                      merge(0.45_wp, 5.4_wp, kind == 1), 2e-3_wp, 0.01_wp)
      end do
    end do
    call locate_links(sim%scene%links, sim%scene%contactors)
    ! What a law without length asks of velocities has no rest length: let some begin with other ones.
    sim%scene%bodies%velocity(1, 7:11) = 0.5_wp
  end subroutine make_net
end program test_links
