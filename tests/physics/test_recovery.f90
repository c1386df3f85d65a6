!> Overlap that is undone: two grains, grains in and on a floor and tilted boxes against closed forms, in the plane and in space;
!! packs that few sweeps have left deep in each other, on any number of subdomains.
program test_recovery
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, pack_deck, pack_names, start_pack
  use scenes, only: begin_run, begin_scene, drive, put_disk, put_polygon, put_wall, run
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_sphere
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_measures, only: measure, measures_t
  use sg_scene, only: scene_t
  use sg_simulation, only: decompose, simulation_t
  use sg_time_functions, only: time_function_t
  use subdomain_tests, only: on_subdomains
  implicit none
  real(wp), parameter :: h = 1e-3_wp, small = 0.1_wp, large = 0.2_wp
  ! Positions of order one.
  real(wp), parameter :: rounding = 1e-14_wp
  ! Overlap that decks of single grains allow, over the smaller one, and the part of it that a push leaves [m].
  real(wp), parameter :: allowed = 1e-6_wp, left = 0.4_wp*allowed*small
  type(tests_t) :: t
  integer :: dimension

  do dimension = 2, 3
    call test_pair(dimension)
    call test_floor(dimension)
    call test_box(dimension)
    call test_rolling(dimension, 0.3_wp, .false.)
    call test_rolling(dimension, 0.0_wp, .false.)
    call test_rolling(dimension, 0.3_wp, .true.)
  end do
  call on_subdomains(test_packs)
  call t%finish()

contains

  !> A run that undoes overlap at every step, without weight.
  subroutine start(sim, recovery)
    type(simulation_t), intent(inout) :: sim !! its scene is set
    real(wp), intent(in) :: recovery

    sim%scene%gravity = 0
    sim%options%recovery = recovery
    sim%options%recovery_every = 1
    call begin_run(sim, h, 1e-12_wp)
  end subroutine start

  !> Two grains of different mass, 2.5 % of the smaller radius deep: three pushes of at most 1 %, shared by their masses; the centre
  !! of mass stays, and nothing moves afterwards.
  subroutine test_pair(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: deep = 0.025_wp*small
    type(simulation_t), pointer :: sim
    real(wp) :: first(2), share(2)

    sim => fresh()
    first = [0.0_wp, small + large - deep]
    if (dimension == 2) then
      call begin_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
      call put_disk(sim%scene, 1, small, [first(1), 0.0_wp])
      call put_disk(sim%scene, 2, large, [first(2), 0.0_wp])
    else
      call begin_space_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
      call put_sphere(sim%scene, 1, small, [first(1), 0.0_wp, 0.0_wp])
      call put_sphere(sim%scene, 2, large, [first(2), 0.0_wp, 0.0_wp])
    end if
    call start(sim, allowed)
    share = sim%scene%bodies%mass([2, 1])/sum(sim%scene%bodies%mass(:2))
    call run(sim, 2)
    call t%equal(sim%totals%recoveries, 2, 'two steps, two pushes')
    associate (x => sim%scene%bodies%position)
      call t%near(x(1, 2) - x(1, 1), small + large - deep + 0.02_wp*small, rounding, 'of 1 % of the smaller radius each')
      call run(sim, 5)
      call t%equal(sim%totals%recoveries, 3, 'and one for the rest')
      call t%near(x(1, 1), first(1) - share(1)*(deep - left), rounding, 'the light one moves the more')
      call t%near(x(1, 2), first(2) + share(2)*(deep - left), rounding, 'the heavy one the less')
      call t%near(maxval(abs(x(2:, :))), 0.0_wp, 0.0_wp, 'along the normal alone')
    end associate
    call t%near(maxval(abs(sim%scene%bodies%velocity)), 0.0_wp, 0.0_wp, 'a push leaves no velocity')
  end subroutine test_pair

  !> A grain that rests half a per cent deep in a floor is lifted by just that, by 0.1 % per push, and the balance has the work.
  subroutine test_floor(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: deep = 0.005_wp*small
    type(simulation_t), pointer :: sim
    type(measures_t) :: measures
    real(wp) :: weight

    sim => fresh()
    if (dimension == 2) then
      call begin_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
      call put_wall(sim%scene, 2, 1.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      call put_disk(sim%scene, 1, small, [0.0_wp, small - deep])
    else
      call begin_space_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
      call put_plane(sim%scene, 2, [1.0_wp, 1.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      call put_sphere(sim%scene, 1, small, [0.0_wp, 0.0_wp, small - deep])
    end if
    call start(sim, allowed)
    sim%scene%gravity(dimension) = -9.81_wp
    weight = 9.81_wp*sim%scene%bodies%mass(1)
    call run(sim, 20)
    call t%equal(sim%totals%recoveries, 5, 'five pushes')
    ! The step before it left a velocity of 1e-12 g h.
    call t%near(sim%scene%bodies%position(dimension, 1), small - left, 1e-13_wp, 'the grain lies on the floor')
    call t%near(sim%energy%recovery_work/(weight*(deep - left)), 1.0_wp, 1e-10_wp, 'work of the push')
    call measure(sim%scene, sim%contacts, h, sim%energy, measures)
    call t%near(measures%get('energy_closure'), 0.0_wp, 1e-10_wp, 'the balance is closed')
  end subroutine test_floor

  !> A box that floats with one edge deeper in a floor than the other, turned by a hundredth: pushes lift and turn it until no
  !! corner is deeper than the deck allows; the floor stays, and nothing moves.
  subroutine test_box(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: tilt = 1e-2_wp, middle = small - 5e-4_wp
    real(wp), parameter :: along(2) = [cos(tilt), sin(tilt)], across(2) = [-sin(tilt), cos(tilt)]
    type(simulation_t), pointer :: sim
    real(wp) :: lowest

    sim => fresh()
    if (dimension == 2) then
      call begin_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
      call put_wall(sim%scene, 2, 1.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      call put_polygon(sim%scene, 1, reshape([-along - across, along - across, along + across, across - along], [2, 4])*small &
                       + spread([0.0_wp, middle], 2, 4))
    else
      call begin_space_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
      call put_plane(sim%scene, 2, [1.0_wp, 1.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      call put_box(sim%scene, 1, [small, small, small], [0.0_wp, 0.0_wp, middle], &
                   [cos(tilt/2), 0.0_wp, sin(tilt/2), 0.0_wp])
    end if
    call start(sim, allowed)
    call run(sim, 40)
    lowest = minval(sim%contacts%gap(:sim%contacts%n))
    call t%check(sim%totals%recoveries > 0 .and. sim%totals%recoveries < 40, 'pushes, and an end of them')
    call t%check(lowest < 0.01_wp*small .and. lowest > -allowed*2*small, 'the lowest corner is as deep as is allowed')
    call t%near(maxval(abs(sim%scene%bodies%velocity)), 0.0_wp, 0.0_wp, 'nothing moves')
    call t%near(sim%scene%bodies%position(dimension, 2), -0.1_wp, 0.0_wp, 'the floor stays')
  end subroutine test_box

  !> Two equal grains that lie on a floor and overlap each other part by half of it each: they roll where they stick, slide where
  !! nothing rubs, and one that sticks and must not turn leaves the whole way to the other one.
  subroutine test_rolling(dimension, friction, is_held)
    integer, intent(in) :: dimension
    real(wp), intent(in) :: friction
    logical, intent(in) :: is_held !! must the second one not turn?
    real(wp), parameter :: deep = 0.005_wp*small, way = deep - left
    ! A sweep without momentum leaves two thirds at most (disks, one held), one with it the root of that, and there are fifty.
    real(wp), parameter :: unsolved = sqrt(2/3.0_wp)**50*way
    type(simulation_t), pointer :: sim
    real(wp) :: share(2), turned(2)
    integer :: component

    sim => fresh()
    call put_two_on_floor(dimension, friction, small - deep/2, sim%scene)
    if (is_held) then
      do component = dimension + 1, sim%scene%bodies%n_velocity
        call drive(sim%scene, 2, component, time_function_t())
      end do
    end if
    call start(sim, allowed)
    sim%scene%gravity(dimension) = -9.81_wp
    call run(sim, 5)
    share = merge([1.0_wp, 0.0_wp], [0.5_wp, 0.5_wp], is_held)
    associate (x => sim%scene%bodies%position)
      call t%near(x(1, 1), -(small - deep/2) - share(1)*way, unsolved, 'the first one goes its share')
      call t%near(x(1, 2), small - deep/2 + share(2)*way, unsolved, 'the second one, too')
      call t%near(maxval(abs(x(dimension, :2) - small)), 0.0_wp, 1e-13_wp, 'both stay on the floor')
    end associate
    call t%near(maxval(abs(sim%scene%bodies%velocity)), 0.0_wp, 1e-12_wp, 'a push leaves no velocity')
    if (.not. friction > 0) then
      call t%check(.not. sim%scene%bodies%has_orientation, 'nothing turns where nothing rubs')
      return
    end if
    turned = rolled(sim%scene)
    call t%near(turned(1), -share(1)*way/small, unsolved/small, 'the first one rolls where it sticks')
    call t%near(turned(2), share(2)*way/small, unsolved/small, 'and so does the second one')
  end subroutine test_rolling

  !> Two small grains that touch a floor, at -x and x.
  subroutine put_two_on_floor(dimension, friction, x, scene)
    integer, intent(in) :: dimension
    real(wp), intent(in) :: friction, x
    type(scene_t), intent(out) :: scene

    if (dimension == 2) then
      call begin_scene(scene, 3, friction, 0.01_wp)
      call put_wall(scene, 3, 1.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      call put_disk(scene, 1, small, [-x, small])
      call put_disk(scene, 2, small, [x, small])
    else
      call begin_space_scene(scene, 3, friction, 0.01_wp)
      call put_plane(scene, 3, [1.0_wp, 1.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      call put_sphere(scene, 1, small, [-x, 0.0_wp, small])
      call put_sphere(scene, 2, small, [x, 0.0_wp, small])
    end if
  end subroutine put_two_on_floor

  !> Angles by which the two have turned, positive where they roll along x [rad].
  function rolled(scene)
    type(scene_t), intent(in) :: scene
    real(wp) :: rolled(2)

    if (scene%dimension == 2) then
      rolled = -scene%bodies%angle(:2)
    else
      rolled = 2*asin(scene%bodies%orientation(3, :2))
    end if
  end function rolled

  !> Packs that ten plain sweeps per step let sink into each other: a push lessens the overlap that it finds, copies of a
  !! body stay alike to the last bit, and the balance of energy is closed.
  subroutine test_packs(comm)
    type(comm_t), intent(inout) :: comm
    integer :: i

    do i = 1, size(pack_names)
      if (can_be_made(trim(pack_names(i)))) call test_pack(comm, trim(pack_names(i)))
    end do
  end subroutine test_packs

  !> One pack.
  subroutine test_pack(comm, name)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim
    type(measures_t) :: before, after
    type(error_t), allocatable :: error
    real(wp) :: share_left
    integer :: pushes

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-4_wp, sim)
    sim%options%recovery = 3e-5_wp
    sim%options%recovery_every = 10
    sim%options%solver%method = 'nlgs'
    sim%options%solver%maximum_sweeps = 10
    sim%comm = comm
    call decompose(sim, error)
    call t%check(.not. allocated(error), name//': is split')
    call advance_pack(t, name, sim, 149)
    pushes = sim%totals%recoveries
    call advance_pack(t, name, sim, 1)
    call t%check(sim%totals%recoveries > 0 .or. comm%size == 1, name//': bodies are pushed')
    if (sim%totals%recoveries == pushes) return
    call look(sim, before)
    ! The step that follows a push detects what it has left.
    call advance_pack(t, name, sim, 1)
    call look(sim, after)
    ! A push takes from each contact that carries all of its overlap beyond what it leaves, but no more than 0.1 % of the radius, or
    ! a tenth of the overlap where that is more: some of these packs have 0.8 %. Measured: a quarter to three fifths of the mean is
    ! left. Where a push finds little more than is allowed, half of what is allowed is left at most. Corners of polyhedra that
    ! tumble at this moment go h^2 w^2 r, as much as the overlap itself, off the straight way on which a gap is foreseen. Clusters
    ! touch each other at several points, and where all of these stick no way may be left: on four subdomains 0.95 of the mean
    ! stays, and as much by a push of a thousand sweeps.
    share_left = 0.9_wp
    if (name == 'clusters') share_left = 1
    if (name /= 'polyhedra') call t%check(after%get('mean_penetration') < share_left*before%get('mean_penetration') .or. &
                                          after%get('max_penetration') <= 0.5_wp*sim%options%recovery*largest_grain(sim%scene), &
                                          name//': overlap is less')
    ! Spins of bodies in space, see doc/theory/scheme.md, leave the balance open by what depends on the step.
    if (sim%scene%dimension == 2) call t%near(after%get('energy_closure'), 0.0_wp, 1e-12_wp, name//': the balance is closed')
    call check_copies(sim, name)
  end subroutine test_pack

  !> Reach of the largest shape of a grain [m].
  real(wp) function largest_grain(scene) result(reach)
    type(scene_t), intent(in) :: scene

    associate (contactors => scene%contactors)
      reach = maxval(contactors%reach(:contactors%n), scene%bodies%is_grain(contactors%body(:contactors%n)))
    end associate
  end function largest_grain

  !> Measure a pack.
  subroutine look(sim, measures)
    type(simulation_t), intent(inout) :: sim
    type(measures_t), intent(out) :: measures

    call measure(sim%scene, sim%contacts, sim%options%time_step, sim%energy, measures, sim%decomposition%subdomain, sim%comm)
  end subroutine look

  !> Copies of a body are alike on all ranks, to the last bit.
  subroutine check_copies(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp), allocatable :: most(:), least(:)
    integer :: i, n

    if (sim%comm%size == 1) return
    associate (bodies => sim%scene%bodies)
      n = maxval(bodies%id(:bodies%n))
      call sim%comm%maximum(n)
      allocate (most(n), source=-huge(1.0_wp))
      allocate (least(n), source=huge(1.0_wp))
      do i = 1, bodies%n
        most(bodies%id(i)) = bodies%position(1, i)
        least(bodies%id(i)) = bodies%position(1, i)
      end do
      call sim%comm%maximum(most)
      call sim%comm%minimum(least)
      call t%check(.not. any(abs(most - least) > 0), name//': copies are alike')
    end associate
  end subroutine check_copies
end program test_recovery
