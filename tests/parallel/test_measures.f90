!> Indicators, works and totals of scenes in parts: the same as of the whole, however the scene is split.
program test_measures
  use cut_by_hand, only: cut_scene
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_scene, drive, put_disk, put_polygon, put_wall
  use scenes_space, only: random_space_scene
  use sg_assemble, only: assemble, disassemble
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_drives, only: pressure_t
  use sg_energy, only: energy_t
  use sg_grains, only: count_grains, grains_t
  use sg_kinds, only: wp, i4, i8
  use sg_laws, only: law_restitution
  use sg_measures, only: measure, measures_t
  use sg_motion, only: predict, update
  use sg_owner_sums, only: add_at_owner, copy_from_owner
  use sg_penetration, only: deepest_penetration
  use sg_random, only: random_t
  use sg_records, only: solid_frictional
  use sg_report, only: report_t
  use sg_samples, only: samples_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t, start_simulation
  use sg_subdomain, only: subdomain_t
  use sg_time_functions, only: time_function_t
  use sg_totals, only: phase_solve, reduce_report, totals_t
  use subdomain_tests, only: on_subdomains
  implicit none
  ! Sums of some hundred terms of order one to hundred, in another order.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call test_plane(comm, 0.0_wp, 'a box')
    call test_plane(comm, 1.1_wp, 'a periodic box')
    call test_space(comm)
    call test_totals(comm)
    call test_report(comm)
  end subroutine run_tests

  !> Disks and squares between a floor, a side that pushes and a lid that is pressed and slides; the first quarter flies.
  subroutine test_plane(comm, period, what)
    type(comm_t), intent(inout) :: comm
    real(wp), intent(in) :: period
    character(len=*), intent(in) :: what
    real(wp), parameter :: square(2, 4) = &
                           0.04_wp*reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
    integer, parameter :: n = 48, lid = n + 1
    type(simulation_t), pointer :: sim
    type(random_t) :: random
    real(wp) :: place(2)
    integer :: b

    sim => fresh()
    call random%seed(11 + nint(period))
    call begin_scene(sim%scene, n + 3, 0.4_wp, 0.02_wp)
    sim%scene%period = period
    do b = 1, n
      place = [0.11_wp*real(modulo(b, 8), wp) + random%uniform(0.0_wp, 0.005_wp), 0.06_wp + 0.1_wp*real((b - 1)/8, wp)]
      if (modulo(b, 3) == 0) then
        call put_polygon(sim%scene, b, square + spread(place, 2, 4))
      else
        call put_disk(sim%scene, b, random%uniform(0.045_wp, 0.052_wp), place)
      end if
      sim%scene%bodies%velocity(:, b) = [random%uniform(-0.1_wp, 0.1_wp), random%uniform(-0.1_wp, 0.0_wp), random%uniform()]
    end do
    call put_polygon(sim%scene, lid, reshape([-0.05_wp, 0.62_wp, 0.83_wp, 0.62_wp, 0.83_wp, 0.7_wp, -0.05_wp, 0.7_wp], [2, 4]))
    call drive(sim%scene, lid, 1, time_function_t(constant=0.2_wp))
    call drive(sim%scene, lid, 3, time_function_t())
    sim%scene%pressures = [pressure_t(body=lid, direction=[0.0_wp, -1.0_wp, 0.0_wp], length=0.8_wp, &
                                      value=time_function_t(constant=300.0_wp))]
    call put_wall(sim%scene, n + 2, 2.0_wp, 0.01_wp, [0.4_wp, 0.0_wp], 0.0_wp)
    call put_disk(sim%scene, n + 3, 0.3_wp, [-0.37_wp, 0.3_wp])
    call drive(sim%scene, n + 3, 1, time_function_t(constant=0.1_wp))
    call drive(sim%scene, n + 3, 2, time_function_t())
    call drive(sim%scene, n + 3, 3, time_function_t(constant=-0.5_wp))
    call follow(comm, sim, 2e-3_wp, 40, what)
  end subroutine test_plane

  !> Shapes of all kinds that fly into one another through two periods.
  subroutine test_space(comm)
    type(comm_t), intent(inout) :: comm
    type(simulation_t), pointer :: sim

    sim => fresh()
    call random_space_scene(sim%scene, solid_frictional, law_restitution, [3.4_wp, 3.4_wp], 3.4_wp, 40)
    call follow(comm, sim, 1e-3_wp, 6, 'a scene in space')
  end subroutine test_space

  !> Run a scene whole and in parts; each step splits it again, so that bodies move from rank to rank.
  subroutine follow(comm, sim, h, steps, what)
    type(comm_t), intent(inout) :: comm
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: h
    integer, intent(in) :: steps
    character(len=*), intent(in) :: what
    type(scene_t) :: local
    type(contacts_t) :: contacts
    type(subdomain_t) :: subdomain
    type(energy_t) :: energy
    type(measures_t) :: got, wanted
    type(samples_t) :: samples, all_samples
    real(wp) :: deepest(1), n(1)
    integer :: i

    sim%options%time_step = h
    sim%options%solver%method = 'nlgs'
    sim%options%solver%maximum_sweeps = 50
    call start_simulation(sim)
    do i = 1, steps
      call solve_step(sim)
      call sim%energy%add_step(sim%scene, sim%contacts, h, sim%plan%radius)
      call cut_scene(sim%scene, sim%contacts, split(comm, sim%scene%bodies%n, i), comm%rank, comm%size, local, contacts, subdomain)
      call energy%add_step(local, contacts, h, [real(wp) ::])
      call update(sim%scene%bodies, h, sim%options%theta)
      sim%step = i
      deepest = deepest_penetration(contacts)
      call comm%maximum(deepest)
      call t%near(deepest(1), deepest_penetration(sim%contacts), 0.0_wp, what//': deepest penetration of a step')
      call cut_scene(sim%scene, sim%contacts, split(comm, sim%scene%bodies%n, i), comm%rank, comm%size, local, contacts, subdomain)
      call samples%add(local, contacts, h)
      call all_samples%add(sim%scene, sim%contacts, h)
      call measure(sim%scene, sim%contacts, h, sim%energy, wanted)
      call measure(local, contacts, h, energy, got, subdomain, comm)
      call compare(got, wanted, what)
    end do
    call check_busy(wanted, sim%scene%dimension, what)
    n = real(contacts%n, wp)
    call comm%sum(n)
    call t%equal(nint(n(1)), sim%contacts%n, what//': each contact is on one rank')
    call samples%reduce(comm)
    call t%near(largest_difference(samples%value(:, :steps), all_samples%value(:, :steps)), 0.0_wp, rounding, what//': samples')
    call check_sums(comm, local, subdomain, what)
    call check_energy(comm, energy, sim%energy, what)
    call check_grains(comm, local, sim%scene, what)
  end subroutine follow

  !> A step without its update.
  subroutine solve_step(sim)
    type(simulation_t), intent(inout) :: sim

    call predict(sim%scene, sim%time(), sim%options%time_step, sim%options%theta)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, sim%options%time_step, sim%problem)
    call sim%solver%solve(sim%problem, sim%report)
    call disassemble(sim%problem, sim%plan, sim%pairs, sim%options%time_step, 0.0_wp, sim%scene, sim%contacts)
  end subroutine solve_step

  !> Ranks of the bodies: slabs, in turns, or none for the last rank.
  function split(comm, n, step) result(part)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: n, step
    integer(i4) :: part(n)
    integer :: b

    do b = 1, n
      select case (modulo(step, 3))
      case (0)
        part(b) = int(comm%size*(b - 1)/n, i4)
      case (1)
        part(b) = int(modulo(7*b + step + b**2, comm%size), i4)
      case (2)
        part(b) = int(modulo(b/3, max(1, comm%size - 1)), i4)
      end select
    end do
  end function split

  !> The measures of the parts against those of the whole.
  subroutine compare(got, wanted, what)
    type(measures_t), intent(in) :: got, wanted
    character(len=*), intent(in) :: what
    integer :: m

    do m = 1, size(wanted%column)
      associate (one => wanted%column(m))
        call t%near(got%column(m)%value, one%value, rounding*max(1.0_wp, abs(one%value)), what//': '//trim(one%name))
      end associate
    end do
  end subroutine compare

  !> Is there something to measure?
  subroutine check_busy(wanted, dimension, what)
    type(measures_t), intent(in) :: wanted
    integer, intent(in) :: dimension
    character(len=*), intent(in) :: what

    call t%check(wanted%get('friction_loss') > 0 .and. abs(wanted%get('drive_work')) > 0, what//': drives and friction work')
    call t%check(wanted%get('rattlers') > 0.5_wp, what//': there are rattlers')
    call t%check(wanted%get('coordination_without_rattlers') > 1, what//': and others')
    call t%check(wanted%get('volume_error') > 0 .and. wanted%get('single_contacts') > 0.5_wp, what//': shapes touch')
    if (dimension == 2) call t%check(wanted%get('double_contacts') > 0.5_wp, what//': some by sides')
    call t%check(wanted%get('shear_rate') > 0 .and. wanted%get('inertia_number') > 0, what//': the grains shear')
  end subroutine check_busy

  !> Largest difference over the largest number.
  pure real(wp) function largest_difference(got, wanted) result(difference)
    real(wp), intent(in) :: got(:, :), wanted(:, :)

    difference = maxval(abs(got - wanted))/max(1.0_wp, maxval(abs(wanted)))
  end function largest_difference

  !> Every rank says (rank + 1) (k + number) of each body it holds: the sum over its holders stands on its owner rank, then on all.
  subroutine check_sums(comm, local, subdomain, what)
    type(comm_t), intent(inout) :: comm
    type(scene_t), intent(in) :: local
    type(subdomain_t), intent(in) :: subdomain
    character(len=*), intent(in) :: what
    real(wp) :: values(2, local%bodies%n), holders(subdomain%all_bodies), wanted(2, local%bodies%n)
    integer :: b, k

    if (comm%size == 1) return
    holders = 0
    do b = 1, local%bodies%n
      holders(local%bodies%id(b)) = real(comm%rank + 1, wp)
      values(:, b) = [(real((comm%rank + 1)*(k + local%bodies%id(b)), wp), k=1, 2)]
    end do
    call comm%sum(holders)
    do b = 1, local%bodies%n
      wanted(:, b) = [(holders(local%bodies%id(b))*real(k + local%bodies%id(b), wp), k=1, 2)]
    end do
    call add_at_owner(subdomain, comm, values)
    do b = 1, local%bodies%n_own
      call t%near(maxval(abs(values(:, b) - wanted(:, b))), 0.0_wp, 0.0_wp, what//': sum on the owner rank')
    end do
    do b = 1, local%bodies%n
      if (local%bodies%owner(b) /= -1 .and. local%bodies%owner(b) /= comm%rank) values(:, b) = -1
    end do
    call copy_from_owner(subdomain, comm, values)
    call t%near(largest_difference(values, wanted), 0.0_wp, 0.0_wp, what//': all copies know it')
  end subroutine check_sums

  !> Works of the parts add up to those of the whole; what the first rank is left with adds up to the same.
  subroutine check_energy(comm, part, whole, what)
    type(comm_t), intent(inout) :: comm
    type(energy_t), intent(in) :: part, whole
    character(len=*), intent(in) :: what
    type(energy_t) :: sum

    sum = part
    call sum%reduce(comm)
    call t%near(maxval(abs(sum%pack() - whole%pack())), 0.0_wp, rounding*maxval(abs(whole%pack())), what//': works')
    call t%check(sum%is_started, what//': the balance has begun')
    call sum%leave_to_first(comm)
    call t%check(sum%is_started, what//': on all ranks')
    call sum%reduce(comm)
    call t%near(maxval(abs(sum%pack() - whole%pack())), 0.0_wp, rounding*maxval(abs(whole%pack())), what//': works, restarted')
  end subroutine check_energy

  subroutine check_grains(comm, local, whole, what)
    type(comm_t), intent(inout) :: comm
    type(scene_t), intent(in) :: local, whole
    character(len=*), intent(in) :: what
    type(grains_t) :: got, wanted

    call count_grains(local%bodies, got, comm)
    call count_grains(whole%bodies, wanted)
    call t%equal(got%n, wanted%n, what//': grains')
    call t%near(got%mass, wanted%mass, rounding*wanted%mass, what//': their mass')
    call t%near(got%mean_radius, wanted%mean_radius, rounding, what//': their mean radius')
  end subroutine check_grains

  !> Contacts, updates and CPU seconds add up; of sweeps, errors and wall seconds the largest counts.
  subroutine test_totals(comm)
    type(comm_t), intent(inout) :: comm
    type(totals_t) :: totals
    type(report_t) :: report
    integer :: r, n, step
    real(wp) :: nan

    r = comm%rank
    n = comm%size
    report%e8 = 1e-3_wp
    nan = ieee_value(nan, ieee_quiet_nan)
    if (r == n - 1) report%e1 = nan
    do step = 1, 2
      report%sweeps = 10*(r + 1)
      report%contact_updates = 3000000000_i8*int(r + 1, i8)
      report%active_contacts = r
      report%bytes_per_contact = real(100*(r + 1), wp)
      call totals%add(report, (r + 1)*merge(2, 1, step == 1), 0.1_wp*real(r, wp), n*(n + 1)/2*merge(2, 1, step == 1))
    end do
    totals%penetration_at%step = 100 + r
    totals%penetration_at%bodies = [r, 2*r]
    totals%fast_steps = 1
    totals%tunnellings = 2
    totals%phase(phase_solve)%cpu = 1
    totals%clock%wall = real(r, wp)
    call totals%reduce(comm)
    do step = 1, 2
      call t%equal(totals%steps, 2, 'steps')
      call t%equal(totals%contacts, n*(n + 1)/2, 'contacts of all ranks')
      call t%equal(totals%penetration_at%step, 99 + n, 'step of the rank with the deepest penetration')
      call t%equal(totals%penetration_at%bodies(2), 2*(n - 1), 'and its bodies')
      call t%equal(totals%most_contacts, n*(n + 1), 'most of them')
      call t%equal(totals%active_contacts, n*(n - 1)/2, 'active ones')
      call t%check(totals%contact_updates == 3000000000_i8*int(n*(n + 1), i8), 'updates of all ranks')
      call t%check(totals%sweeps == int(20*n, i8), 'sweeps of the busiest')
      call t%check(ieee_is_nan(totals%worst_e1), 'an error that is not a number on one rank')
      call t%near(totals%worst_e8, 1e-3_wp, 0.0_wp, 'worst error')
      call t%near(totals%worst_penetration, 0.1_wp*real(n - 1, wp), rounding, 'worst penetration')
      call t%near(totals%bytes_per_contact, 100*real(2*n + 1, wp)/3, rounding*1000, 'mean bytes of a contact')
      call t%near(totals%phase(phase_solve)%cpu, real(n, wp), 0.0_wp, 'CPU seconds add up')
      call t%near(totals%clock%wall, real(n - 1, wp), 0.0_wp, 'wall seconds do not')
      call t%equal(totals%fast_steps, 1, 'fast steps')
      call t%equal(totals%tunnellings, 2, 'passings')
      ! Kept in a restart file and read back by all, they are the same.
      call totals%leave_to_first(comm)
      call totals%reduce(comm)
    end do
  end subroutine test_totals

  subroutine test_report(comm)
    type(comm_t), intent(inout) :: comm
    type(report_t) :: report
    integer :: n

    n = comm%size
    report%contact_updates = 3000000000_i8
    report%active_contacts = comm%rank
    report%sweeps = 5 + comm%rank
    call reduce_report(report, comm)
    call t%check(report%contact_updates == 3000000000_i8*int(n, i8), 'updates of a step')
    call t%equal(report%active_contacts, n*(n - 1)/2, 'active contacts of a step')
    call t%equal(report%sweeps, n + 4, 'sweeps of a step')
  end subroutine test_report
end program test_measures
