!> The primal method sweeps each part, and the contacts between parts, as often as asked: the table of the talk, 800 sweeps in
!! the first part, 700 in the second, ... Run on any number of subdomains.
program test_primal
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, pack_deck, start_pack
  use sg_advance, only: advance
  use sg_choose_solver, only: choose_solver
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_run_options, only: criterion_quad
  use sg_simulation, only: decompose, simulation_t
  use sg_text, only: to_text
  use subdomain_tests, only: on_subdomains
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call test_sweeps(comm, 'disks', 3)
    call test_sweeps(comm, 'pressed disks', 1)
    call test_sweeps(comm, 'spheres', 2)
  end subroutine run_tests

  !> Count the updates of one gluing, and of three.
  subroutine test_sweeps(comm, name, interface_sweeps)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    integer, intent(in) :: interface_sweeps
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    character(len=:), allocatable :: table
    integer :: r, gluings

    sim => fresh()
    table = to_text(800)
    do r = 1, comm%size - 1
      table = table//', '//to_text(800 - 100*r)
    end do
    call start_pack(t, comm, name, pack_deck(name)//'[partition]'//nl//'gluing = "primal"'//nl//'sweeps = ['//table//']'//nl// &
                    '[partition.primal]'//nl//'interface_sweeps = '//to_text(interface_sweeps)//nl, 1e-3_wp, sim)
    do r = 0, comm%size - 1
      call t%equal(sim%options%partition%sweeps_of(r), 800 - 100*r, name//': sweeps asked for')
    end do
    call advance_pack(t, name, sim, 60)
    call t%check(sim%contacts%n > 30, name//': contacts')
    if (comm%size == 1) return
    sim%comm = comm
    sim%options%partition%boxes = [comm%size, 1, 1]
    ! Sweeps up to the last: nothing is converged to this, and no contact is left out between two tests.
    sim%options%solver%tolerance = tiny(1.0_wp)
    sim%options%solver%check_every = 10000
    sim%options%solver%criterion = criterion_quad ! all contacts are visited
    call decompose(sim, error)
    call t%check(.not. allocated(error), name//' is split')
    do gluings = 1, 3, 2
      sim%options%solver%maximum_sweeps = gluings*800
      call choose_solver(sim%options%solver, sim%options%partition, comm%size, sim%solver, error)
      call advance(sim, error)
      call check_updates(comm, name, sim, interface_sweeps, gluings)
    end do
  end subroutine test_sweeps

  !> Updates are those of the contacts within the part, as often as this rank was asked, and of the contacts with other parts
  !! that it owns.
  subroutine check_updates(comm, name, sim, interface_sweeps, gluings)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: interface_sweeps, gluings
    real(wp) :: all_outer(1)
    integer :: inner, outer, k

    inner = 0
    outer = 0
    do k = 1, sim%contacts%n
      associate (owner => sim%scene%bodies%owner(sim%contacts%body(:, k)))
        if (all(owner == comm%rank .or. owner < 0)) then
          inner = inner + 1
        else
          outer = outer + 1
        end if
      end associate
    end do
    all_outer = real(outer, wp)
    call comm%sum(all_outer)
    call t%check(all_outer(1) > 3, name//': contacts between parts')
    call t%equal(sim%report%gluings, gluings, name//': gluings')
    call t%equal(int(sim%report%contact_updates), &
                 gluings*((800 - 100*comm%rank)*inner + interface_sweeps*outer), name//': updates')
  end subroutine check_updates
end program test_primal
