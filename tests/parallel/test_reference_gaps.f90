!> Reference gaps on several ranks: the first step with contacts is that of all ranks, so that a grain of a rank that has no contact
!! then stops at the floor, as on one rank.
program test_reference_gaps
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, start_pack
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_simulation, only: decompose, simulation_t
  use sg_text, only: to_text
  use subdomain_tests, only: on_subdomains
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  integer, parameter :: grains = 8, steps = 200
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call compare(comm)
  end subroutine run_tests

  !> Disks in a row that move towards a floor at 1 m/s, each a centimetre higher than the one before; nothing is in reach at first.
  function falling() result(deck)
    character(len=:), allocatable :: deck
    integer :: i

    deck = '[scene]'//nl//'gravity = [0.0, 0.0]'//nl//'[time]'//nl//'step = 1e-3'//nl//'steps = 200'//nl// &
           '[[material]]'//nl//'name = "stone"'//nl//'density = 2000.0'//nl// &
           '[[law]]'//nl//'kind = "IQS_CLB_g0"'//nl//'friction = 0.5'//nl//'[[interaction]]'//nl//'alert = 0.005'//nl// &
           '[[wall]]'//nl//'from = [-1.0, -0.01]'//nl//'to = [9.0, -0.01]'//nl//'thickness = 0.02'//nl
    do i = 1, grains
      deck = deck//'[[body]]'//nl//'shape = "disk"'//nl//'radius = 0.1'//nl//'position = ['//to_text(real(i, wp))//', '// &
             to_text(0.12_wp + 0.01_wp*real(i, wp))//']'//nl//'velocity = [0.0, -1.0]'//nl
    end do
  end function falling

  !> The first grain stops at the edge of the alert distance, all others at the floor.
  subroutine compare(comm)
    type(comm_t), intent(inout) :: comm
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    integer :: b
    real(wp) :: worst, height

    sim => fresh()
    call start_pack(t, comm, 'falling', falling(), 1e-12_wp, sim)
    if (comm%size > 1) then
      sim%options%partition%every = 20
      sim%comm = comm
      call decompose(sim, error)
      call t%check(.not. allocated(error), 'it is split')
      if (allocated(error)) return
    end if
    call advance_pack(t, 'falling', sim, steps)
    worst = 0
    do b = 1, sim%scene%bodies%n_own
      associate (place => sim%scene%bodies%position(:, b))
        height = merge(0.1045_wp, 0.1_wp, nint(place(1)) == 1)
        if (.not. sim%scene%bodies%is_grain(b)) cycle
        worst = max(worst, abs(place(2) - height))
      end associate
    end do
    ! Positions of order one after some hundred steps.
    call t%near(worst, 0.0_wp, 1e-12_wp, 'where grains stop')
  end subroutine compare
end program test_reference_gaps
