!> Grains held together by cohesive zones, which crack, on several ranks compared with the same run on one: the damage of every
!! bond goes with its contact when grains are repartitioned, and the rounds of a step are those of all ranks.
program test_bonds
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_both, corner, start_pack
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_measures, only: measures_t
  use sg_simulation, only: simulation_t
  use sg_text, only: to_text
  use subdomain_tests, only: on_subdomains
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=8), parameter :: gluings(3) = [character(len=8) :: 'dual', 'primal', 'momentum']
  character(len=14), parameter :: names(5) = [character(len=14) :: 'bonds', 'damaged_bonds', 'bond_energy', 'bond_loss', &
                                              'kinetic_energy']
  integer, parameter :: steps = 12
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm
    integer :: g

    do g = 1, size(gluings)
      call compare(comm, trim(gluings(g))//', in the plane', plane_deck(), trim(gluings(g)))
    end do
    call compare(comm, 'dual, in space', space_deck(), 'dual')
  end subroutine run_tests

  !> Time, material and a weak bond.
  function common_part() result(deck)
    character(len=:), allocatable :: deck

    deck = '[time]'//nl//'step = 1e-3'//nl//'steps = 100'//nl//'[[material]]'//nl//'name = "stone"'//nl//'density = 2000.0'//nl// &
           '[[law]]'//nl//'kind = "IQS_MAL_CZM"'//nl//'friction = 0.5'//nl//'normal_stiffness = 1e8'//nl// &
           'tangential_stiffness = 1e8'//nl//'normal_strength = 2e4'//nl//'tangential_strength = 2e4'//nl// &
           'normal_energy = 3.0'//nl//'tangential_energy = 3.0'//nl//'[[interaction]]'//nl//'alert = 0.02'//nl
  end function common_part

  !> Disks side by side in three rows, the lowest of which is held; gravity pushes them along and down.
  function plane_deck() result(deck)
    character(len=:), allocatable :: deck
    integer :: i, j

    deck = '[scene]'//nl//'gravity = [12.0, -5.0]'//nl//common_part()
    do j = 0, 2
      do i = 0, 6
        deck = deck//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.1'//nl//'position = ['// &
               corner(0.2_wp*real(i, wp), 0.2_wp*real(j, wp))//']'//nl
        if (j == 0) deck = deck//'fixed = true'//nl
      end do
    end do
  end function plane_deck

  !> Spheres that touch, on a layer that is held.
  function space_deck() result(deck)
    character(len=:), allocatable :: deck
    integer :: i, j, k

    deck = '[scene]'//nl//'dimension = 3'//nl//'gravity = [12.0, 3.0, -5.0]'//nl//common_part()
    do k = 0, 2
      do j = 0, 2
        do i = 0, 3
          deck = deck//'[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.1'//nl//'position = ['// &
                 corner(0.2_wp*real(i, wp), 0.2_wp*real(j, wp))//', '//to_text(0.2_wp*real(k, wp))//']'//nl
          if (k == 0) deck = deck//'fixed = true'//nl
        end do
      end do
    end do
  end function space_deck

  !> Run a deck on all ranks, repartitioned every four steps, and on one.
  subroutine compare(comm, name, deck, gluing)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name, deck, gluing
    type(simulation_t), pointer :: whole, part
    type(measures_t) :: of_whole
    type(measures_t), allocatable :: of_parts
    real(wp) :: worst
    integer :: i, b

    whole => fresh()
    part => fresh()
    call start_pack(t, comm, name, deck, 1e-9_wp, whole)
    whole%options%solver%maximum_sweeps = 3000
    call advance_both(t, comm, name, gluing, steps, whole, part, of_whole, of_parts)
    call t%check(of_whole%get('damaged_bonds') > 0 .and. of_whole%get('bonds') > 0, name//': some bonds are damaged, some hold')
    if (.not. allocated(of_parts)) return
    do i = 1, size(names)
      ! Impulses to 1e-9, and damage to 1e-8 in each of 12 steps.
      call t%near(of_parts%get(trim(names(i))), of_whole%get(trim(names(i))), 1e-4_wp*abs(of_whole%get(trim(names(i)))), &
                  name//': '//trim(names(i)))
    end do
    worst = 0
    do b = 1, part%scene%bodies%n_own
      associate (own => part%scene%bodies%position(:, b), there => whole%scene%bodies%position(:, part%scene%bodies%id(b)))
        worst = max(worst, maxval(abs(own - there)))
      end associate
    end do
    ! Ways of a millimetre.
    call t%near(worst, 0.0_wp, 1e-8_wp, name//': places')
    call t%near(of_parts%get('energy_closure'), 0.0_wp, 1e-8_wp, name//': the balance closes on ranks')
  end subroutine compare
end program test_bonds
