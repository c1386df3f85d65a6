!> Substeps: n of them against n short steps that detect each, where carried contacts are exact; gaps of points that follow turning
!! bodies; packs on any number of subdomains; a substep that breaks.
program test_substeps
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use link_scenes, only: begin_links, link, put_mass
  use packs, only: advance_pack, can_be_made, pack_deck, pack_names, start_pack
  use scenes, only: begin_run, begin_scene, drive, put_disk, put_polygon, put_wall, run
  use scenes_space, only: begin_space_scene, put_box, put_capsule, put_plane, put_sphere
  use sg_advance, only: advance
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_laws, only: law_bond, law_mal, law_restitution, law_rod, law_t
  use sg_measures, only: measure, measures_t
  use sg_rotations, only: normalised, turned_back, turned_by
  use sg_scene, only: scene_t
  use sg_simulation, only: decompose, simulation_t
  use sg_time_functions, only: time_function_t
  use subdomain_tests, only: on_subdomains
  implicit none
  !> Twins: one cuts its steps into substeps, one makes as many steps of that length
  character(len=20), parameter :: twins(15) = [character(len=20) :: 'bouncing disk', 'rolling disk', 'two disks', 'sliding block', &
                                               'shaken disk', 'pressed disk', 'disk on polygon', 'disk on a rod', 'torn bond', &
                                               'bonded disk', 'bouncing sphere', 'rolling sphere', 'sliding box', 'capsule', &
                                               'sphere on a rod']
  !> Length of a substep [s], substeps of a step
  real(wp), parameter :: h = 1e-3_wp
  integer, parameter :: n = 4
  ! Positions and velocities of order one, over forty substeps; bounces amplify a difference by less than ten.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t
  integer :: i

  do i = 1, size(twins)
    call test_twins(trim(twins(i)))
  end do
  do i = 1, 2
    call test_gap(2, face_of=i)
    call test_gap(3, face_of=i)
  end do
  call test_broken()
  call on_subdomains(test_packs)
  call t%finish()

contains

  !> The scene of twins. Contacts are seen from afar, so that both have all of them at all times.
  subroutine make(name, sim)
    character(len=*), intent(in) :: name
    type(simulation_t), intent(inout) :: sim
    real(wp), parameter :: far = 10, slope = 0.2_wp
    type(time_function_t) :: shaken

    shaken = time_function_t(amplitude=0.3_wp, omega=60.0_wp)
    associate (scene => sim%scene)
      select case (name)
      case ('bouncing sphere', 'rolling sphere', 'sliding box', 'capsule')
        call begin_space_scene(scene, 2, 0.3_wp, far)
        call put_plane(scene, 2, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      case ('disk on a rod')
        call begin_links(scene, 2, 2, law_t(kind=law_rod, axial_stiffness=4e3_wp, axial_damping=3.0_wp, prestrain=0.01_wp))
      case ('sphere on a rod')
        call begin_links(scene, 2, 3, law_t(kind=law_rod, axial_stiffness=4e3_wp, axial_damping=3.0_wp, prestrain=0.01_wp))
      case ('torn bond')
        call begin_links(scene, 2, 2, law_t(kind=law_bond, young=1e6_wp, poisson=0.2_wp, normal_strength=2e4_wp, &
                                            tangential_strength=1e6_wp))
      case default
        call begin_scene(scene, merge(3, 2, name == 'two disks'), 0.3_wp, far)
        if (name /= 'disk on polygon') call put_wall(scene, 2, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      end select
      select case (name)
      case ('bouncing disk', 'shaken disk', 'pressed disk', 'bonded disk')
        call put_disk(scene, 1, 0.2_wp, [0.0_wp, 0.21_wp])
        scene%bodies%velocity(:, 1) = [1.0_wp, -1.0_wp, 3.0_wp]
        scene%laws(1)%kind = law_restitution
        scene%laws(1)%normal_restitution = 0.8_wp
        if (name == 'shaken disk') scene%drives(2)%value = shaken
        if (name == 'pressed disk') call push(scene, time_function_t(constant=-2000.0_wp, amplitude=2000.0_wp, omega=200.0_wp))
        if (name == 'bonded disk') call bond(scene)
      case ('rolling disk')
        call put_disk(scene, 1, 0.2_wp, [0.0_wp, 0.2_wp])
        scene%gravity(:2) = 9.81_wp*[sin(slope), -cos(slope)]
      case ('two disks')
        call put_disk(scene, 1, 0.2_wp, [0.0_wp, 0.2_wp])
        call put_disk(scene, 3, 0.1_wp, [0.1_wp, 0.49_wp])
        scene%bodies%velocity(:, 3) = [0.0_wp, -1.0_wp, 5.0_wp]
      case ('sliding block')
        call put_polygon(scene, 1, reshape([-0.3_wp, 0.0_wp, 0.3_wp, 0.0_wp, 0.3_wp, 0.2_wp, -0.3_wp, 0.2_wp], [2, 4]))
        scene%bodies%velocity(1, 1) = 2
      case ('disk on polygon')
        call put_disk(scene, 1, 0.2_wp, [0.1_wp, 0.46_wp])
        call put_polygon(scene, 2, reshape([-0.3_wp, 0.0_wp, 0.3_wp, 0.0_wp, 0.2_wp, 0.25_wp, -0.3_wp, 0.2_wp], [2, 4]))
        scene%bodies%velocity(:, 1) = [0.5_wp, -1.0_wp, 1.0_wp]
        scene%bodies%velocity(:, 2) = [0.0_wp, 1.0_wp, 4.0_wp]
      case ('disk on a rod', 'torn bond')
        call put_mass(scene, 1, 0.0_wp, [0.0_wp, 0.0_wp])
        call put_mass(scene, 2, 2.0_wp, [0.6_wp, 0.1_wp])
        call link(scene, 1, 2, 0.6_wp, bond=[1e-3_wp, 2.0_wp])
        scene%bodies%velocity(:2, 2) = [0.5_wp, -1.0_wp]
        scene%gravity(2) = -9.81_wp
      case ('sphere on a rod')
        call put_mass(scene, 1, 0.0_wp, [0.0_wp, 0.0_wp, 0.0_wp])
        call put_mass(scene, 2, 2.0_wp, [0.6_wp, 0.1_wp, 0.2_wp])
        call link(scene, 1, 2, 0.6_wp)
        scene%bodies%velocity(:3, 2) = [0.5_wp, -1.0_wp, 0.3_wp]
      case ('bouncing sphere')
        call put_sphere(scene, 1, 0.2_wp, [0.0_wp, 0.0_wp, 0.21_wp])
        scene%bodies%velocity(:, 1) = [1.0_wp, 0.5_wp, -1.0_wp, 3.0_wp, -2.0_wp, 1.0_wp]
        scene%laws(1)%kind = law_restitution
        scene%laws(1)%normal_restitution = 0.8_wp
      case ('rolling sphere')
        call put_sphere(scene, 1, 0.2_wp, [0.0_wp, 0.0_wp, 0.2_wp])
        scene%gravity = 9.81_wp*[sin(slope), 0.0_wp, -cos(slope)]
      case ('sliding box')
        call put_box(scene, 1, [0.3_wp, 0.2_wp, 0.1_wp], [0.0_wp, 0.0_wp, 0.1_wp])
        scene%bodies%velocity(1:2, 1) = [2.0_wp, 1.0_wp]
      case ('capsule')
        call put_capsule(scene, 1, 0.2_wp, 0.1_wp, [0.0_wp, 0.0_wp, 0.11_wp])
        scene%bodies%orientation(:, 1) = [sqrt(0.5_wp), sqrt(0.5_wp), 0.0_wp, 0.0_wp]
        scene%bodies%velocity(:, 1) = [1.0_wp, 0.3_wp, -1.0_wp, 0.0_wp, 1.0_wp, 0.1_wp]
      end select
    end associate
  end subroutine make

  !> Push the first body down by a force that changes with time.
  subroutine push(scene, force)
    type(scene_t), intent(inout) :: scene
    type(time_function_t), intent(in) :: force

    call drive(scene, 1, 2, force)
    scene%drives(size(scene%drives))%is_velocity = .false.
  end subroutine push

  !> Glue the first body to the wall with a cohesive zone that is torn within the run.
  subroutine bond(scene)
    type(scene_t), intent(inout) :: scene

    associate (law => scene%laws(1), bodies => scene%bodies)
      law%kind = law_mal
      law%zone_stiffness = [1e6_wp, 2e6_wp]
      law%normal_strength = 1000
      law%tangential_strength = 900
      law%zone_energy = [10.0_wp, 12.0_wp]
      bodies%position(2, 1) = 0.2_wp
      bodies%velocity(:, 1) = [0.2_wp, 0.5_wp, 0.0_wp]
    end associate
  end subroutine bond

  !> Ten steps of four substeps each do what forty steps do: motion, energies, status and impulses of the contacts.
  subroutine test_twins(name)
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim, other
    integer :: k

    sim => fresh()
    other => fresh()
    call make(name, sim)
    sim%options%substeps = n
    call begin_run(sim, n*h, 1e-13_wp)
    call make(name, other)
    call begin_run(other, h, 1e-13_wp)
    call run(sim, 10)
    call run(other, 10*n)
    call t%equal(sim%step, 10, name//': ten steps')
    call t%near(sim%time(), other%time(), rounding, name//': at the same time')
    call t%near(maxval(abs(sim%scene%bodies%position - other%scene%bodies%position)), 0.0_wp, rounding, name//': the same places')
    call t%near(maxval(abs(sim%scene%bodies%velocity - other%scene%bodies%velocity)), 0.0_wp, 10*rounding, &
                name//': the same velocities')
    if (sim%scene%bodies%n_velocity == 3) &
      call t%near(maxval(abs(sim%scene%bodies%angle - other%scene%bodies%angle)), 0.0_wp, rounding, name//': turned alike')
    if (sim%scene%bodies%n_velocity == 6) &
      call t%near(maxval(abs(sim%scene%bodies%orientation - other%scene%bodies%orientation)), 0.0_wp, rounding, &
                  name//': turned alike')
    call t%equal(sim%contacts%n, other%contacts%n, name//': as many contacts')
    if (sim%contacts%n /= other%contacts%n) return
    do k = 1, sim%contacts%n
      call t%equal(int(sim%contacts%status(k)), int(other%contacts%status(k)), name//': the same status')
    end do
    call t%near(sim%energy%impact_loss + sim%energy%friction_loss, other%energy%impact_loss + other%energy%friction_loss, &
                rounding*1e3_wp, name//': the same losses')
    call t%near(sim%tunnelling%deepest, other%tunnelling%deepest, 1e-3_wp, name//': no passage')
    call check_balance(sim, name)
  end subroutine test_twins

  !> The balance of energy closes over the substeps.
  subroutine check_balance(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    type(measures_t) :: measures

    call measure(sim%scene, sim%contacts, sim%options%substep_length(), sim%energy, measures, sim%decomposition%subdomain, sim%comm)
    ! Spins of bodies in space whose moments differ leave it open by what depends on the step.
    if (sim%scene%dimension == 2 .or. index(name, 'sphere') > 0) &
      call t%near(measures%get('energy_closure'), 0.0_wp, 1e-10_wp, name//': the balance is closed')
  end subroutine check_balance

  !> A tilted square or cube that turns over the face of a level one that turns too: after four substeps the gap is the height of
  !! the corner over the face, as one rigid motion from the first substep to the last has them.
  subroutine test_gap(dimension, face_of)
    integer, intent(in) :: dimension
    integer, intent(in) :: face_of !! body whose face the contact lies on: the first is the candidate, the second the antagonist
    type(simulation_t), pointer :: sim, first
    real(wp) :: half(dimension), corner(dimension), foot(dimension), face(dimension)
    integer :: k, c, side

    sim => fresh()
    first => fresh()
    call make_pair(dimension, face_of, first)
    call begin_run(first, h, 1e-13_wp)
    call make_pair(dimension, face_of, sim)
    sim%options%substeps = n
    call begin_run(sim, n*h, 1e-13_wp)
    call run(first, 1)
    call run(sim, 1)
    call t%check(first%contacts%n > 0, 'squares: there is a contact')
    call t%equal(sim%contacts%n, first%contacts%n, 'squares: as many contacts')
    c = 3 - face_of
    do k = 1, sim%contacts%n
      side = merge(1, -1, first%contacts%body(1, k) == c)
      half = real(side, wp)*first%contacts%gap(k)/2*first%contacts%normal(:, k)
      corner = moved(first%scene, sim%scene, c, first%contacts%point(:, k) + half)
      foot = moved(first%scene, sim%scene, face_of, first%contacts%point(:, k) - half)
      face = real(side, wp)*turned(first%scene, sim%scene, face_of, first%contacts%normal(:, k))
      call t%near(sim%contacts%gap(k), dot_product(face, corner - foot), 4*epsilon(1.0_wp), 'squares: the gap of corner and face')
      call t%near(norm2(sim%contacts%normal(:, k) - real(side, wp)*face), 0.0_wp, 4*epsilon(1.0_wp), 'squares: the normal')
      call t%check(abs(sim%contacts%gap(k) - first%contacts%gap(k)) > 1e-5_wp, 'squares: it is another gap than before')
    end do
  end subroutine test_gap

  !> Two squares or cubes that move apart and turn; the face of one looks at a corner of the other.
  subroutine make_pair(dimension, face_of, sim)
    integer, intent(in) :: dimension, face_of
    type(simulation_t), intent(inout) :: sim
    real(wp), parameter :: half = 0.1_wp, tilt = 0.6_wp, above = 0.3_wp
    real(wp) :: square(2, 4), place(3)
    integer :: b, i

    if (dimension == 2) call begin_scene(sim%scene, 2, 0.3_wp, 10.0_wp)
    if (dimension == 3) call begin_space_scene(sim%scene, 2, 0.3_wp, 10.0_wp)
    do b = 1, 2
      place = merge(0.0_wp, 1.0_wp, b == face_of)*[0.02_wp, 0.01_wp, above]
      if (dimension == 3) then
        call put_box(sim%scene, b, [half, half, half], place)
        if (b /= face_of) sim%scene%bodies%orientation(:, b) = normalised([1.0_wp, 0.3_wp, 0.2_wp, 0.1_wp])
      else
        square = half*reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
        do i = 1, 4
          if (b /= face_of) square(:, i) = [cos(tilt)*square(1, i) - sin(tilt)*square(2, i), &
                                            sin(tilt)*square(1, i) + cos(tilt)*square(2, i)]
        end do
        call put_polygon(sim%scene, b, square + spread(place([1, 3]), 2, 4))
      end if
      associate (velocity => sim%scene%bodies%velocity(:, b))
        velocity = merge(0.1_wp, -0.1_wp, b /= face_of)*[(real(i, wp), i=1, size(velocity))]
      end associate
    end do
    sim%scene%gravity = 0
  end subroutine make_pair

  !> Place that a point of a body has moved to from one configuration to another.
  function moved(from, to, b, point)
    type(scene_t), intent(in) :: from, to
    integer, intent(in) :: b
    real(wp), intent(in) :: point(:)
    real(wp) :: moved(size(point))

    associate (d => size(point))
      moved = to%bodies%middle(:d, b) + turned(from, to, b, point - from%bodies%middle(:d, b))
    end associate
  end function moved

  !> A vector that has turned with a body.
  function turned(from, to, b, v)
    type(scene_t), intent(in) :: from, to
    integer, intent(in) :: b
    real(wp), intent(in) :: v(:)
    real(wp) :: turned(size(v)), angle

    if (size(v) == 3) then
      turned = turned_by(to%bodies%middle(4:7, b), turned_back(from%bodies%middle(4:7, b), v))
    else
      angle = to%bodies%middle(3, b) - from%bodies%middle(3, b)
      turned = [cos(angle)*v(1) - sin(angle)*v(2), sin(angle)*v(1) + cos(angle)*v(2)]
    end if
  end function turned

  !> A force that is not finite in the last substep alone: bodies, works and counts are back at the beginning of the step.
  subroutine test_broken()
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    type(time_function_t) :: force
    real(wp), allocatable :: position(:, :), velocity(:, :), angle(:)
    real(wp) :: loss

    sim => fresh()
    call make('bouncing disk', sim)
    force%times = [0.0_wp, (6*n - 0.5_wp)*h, 6*n*h]
    force%values = [0.0_wp, 0.0_wp, -huge(1.0_wp)]
    call push(sim%scene, force)
    sim%options%substeps = n
    call begin_run(sim, n*h, 1e-13_wp)
    call run(sim, 5)
    position = sim%scene%bodies%position
    velocity = sim%scene%bodies%velocity
    angle = sim%scene%bodies%angle
    loss = sim%energy%impact_loss
    call advance(sim, error)
    call t%check(allocated(error), 'the substep breaks')
    if (allocated(error)) call t%check(index(error%message, 'step 6:') == 1, 'and the step is named: '//error%message)
    call t%equal(sim%step, 5, 'it does not count')
    call t%equal(sim%totals%steps, 5, 'nor in the totals')
    call t%check(.not. any(abs(position - sim%scene%bodies%position) > 0), 'bodies are where it began')
    call t%check(.not. any(abs(velocity - sim%scene%bodies%velocity) > 0), 'at the velocities of then')
    call t%check(.not. any(abs(angle - sim%scene%bodies%angle) > 0), 'and as they were turned')
    call t%near(sim%energy%impact_loss, loss, 0.0_wp, 'losses are those of the steps before')
    call t%equal(sim%substep, 1, 'the next step begins with its first substep')
  end subroutine test_broken

  !> Packs of all kinds of grains: steps of three substeps converge, copies of a body stay alike to the last bit, and the balance of
  !! energy is closed.
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
    type(error_t), allocatable :: error

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-4_wp, sim)
    sim%options%substeps = 3
    sim%pairs%substeps = 3
    sim%comm = comm
    call decompose(sim, error)
    call t%check(.not. allocated(error), name//': is split')
    call advance_pack(t, name, sim, 60)
    call t%equal(sim%totals%converged_steps, 60, name//': all steps converge')
    if (sim%scene%dimension == 2) call check_balance(sim, name)
    call check_copies(sim, name)
  end subroutine test_pack

  !> Copies of a body are alike on all ranks, to the last bit.
  subroutine check_copies(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp), allocatable :: most(:), least(:)
    integer :: i, m

    if (sim%comm%size == 1) return
    associate (bodies => sim%scene%bodies)
      m = maxval(bodies%id(:bodies%n))
      call sim%comm%maximum(m)
      allocate (most(m), source=-huge(1.0_wp))
      allocate (least(m), source=huge(1.0_wp))
      do i = 1, bodies%n
        most(bodies%id(i)) = bodies%position(1, i)
        least(bodies%id(i)) = bodies%position(1, i)
      end do
      call sim%comm%maximum(most)
      call sim%comm%minimum(least)
      call t%check(.not. any(abs(most - least) > 0), name//': copies are alike')
    end associate
  end subroutine check_copies
end program test_substeps
