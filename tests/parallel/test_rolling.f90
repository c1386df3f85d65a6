!> Grains with moments that resist rolling and twisting on several ranks compared with the same run on one: moments go with their
!! contacts when grains are repartitioned, and every coupling that takes them brings the same motion.
program test_rolling
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
  character(len=16), parameter :: names(4) = [character(len=16) :: 'rolling_loss', 'friction_loss', 'kinetic_energy', &
                                              'potential_energy']
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
    call compare(comm, 'momentum, in space', space_deck(), 'momentum')
  end subroutine run_tests

  !> Time, material and a law.
  function common_part() result(deck)
    character(len=:), allocatable :: deck

    deck = '[time]'//nl//'step = 2e-3'//nl//'steps = 100'//nl//'[[material]]'//nl//'name = "stone"'//nl//'density = 2000.0'//nl// &
           '[[law]]'//nl//'friction = 0.3'//nl//'rolling_friction = 0.1'//nl//'rolling_length = 0.002'//nl
  end function common_part

  !> Disks side by side in three rows, the lowest of which is held; gravity rolls the others along.
  function plane_deck() result(deck)
    character(len=:), allocatable :: deck
    integer :: i, j

    deck = '[scene]'//nl//'gravity = [6.0, -8.0]'//nl//common_part()
    do j = 0, 2
      do i = 0, 6
        deck = deck//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.1'//nl//'position = ['// &
               corner(0.21_wp*real(i, wp) + 0.02_wp*real(j, wp), 0.2_wp*real(j, wp))//']'//nl//'spin = '// &
               to_text(merge(0.0_wp, 3.0_wp, j == 0))//nl
        if (j == 0) deck = deck//'fixed = true'//nl
      end do
    end do
  end function plane_deck

  !> Spheres that touch and spin, on a layer that is held.
  function space_deck() result(deck)
    character(len=:), allocatable :: deck
    integer :: i, j, k

    deck = '[scene]'//nl//'dimension = 3'//nl//'gravity = [5.0, 2.0, -8.0]'//nl//common_part()//'twisting_friction = 0.05'//nl
    do k = 0, 2
      do j = 0, 2
        do i = 0, 3
          deck = deck//'[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.1'//nl//'position = ['// &
                 corner(0.2_wp*real(i, wp), 0.205_wp*real(j, wp))//', '//to_text(0.2_wp*real(k, wp))//']'//nl
          if (k == 0) then
            deck = deck//'fixed = true'//nl
          else
            deck = deck//'spin = [1.0, 2.0, 4.0]'//nl
          end if
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
    integer :: i

    whole => fresh()
    part => fresh()
    call start_pack(t, comm, name, deck, 1e-10_wp, whole)
    whole%options%solver%maximum_sweeps = 5000
    call advance_both(t, comm, name, gluing, steps, whole, part, of_whole, of_parts)
    call t%check(of_whole%get('rolling_loss') > 1e-3_wp*of_whole%get('kinetic_energy'), name//': moments take energy')
    if (.not. allocated(of_parts)) return
    do i = 1, size(names)
      ! Velocities to 1e-10 of the fall of a step, over 12 steps with impacts.
      call t%near(of_parts%get(trim(names(i))), of_whole%get(trim(names(i))), 1e-5_wp*abs(of_whole%get(trim(names(i)))), &
                  name//': '//trim(names(i)))
    end do
  end subroutine compare
end program test_rolling
