!> Alert distances reduced to the motion of each pair: the contacts are those that all pairs have within their distances, from lists
!! made before and now, and a solution that closes another one is found out.
program test_pair_alert
  use harness, only: tests_t
  use sg_contactors, only: add_disk, add_polygon, add_segment
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4, pi
  use sg_left_out, only: has_left_out
  use sg_mapping, only: relative_velocity
  use sg_neighbour_list, only: neighbours_t
  use sg_pair_alert, only: alert_of_pair, reduce_alerts
  use sg_random, only: random_t
  use sg_scene, only: colour_index, scene_t
  use sg_way_of_step, only: way_of_step
  implicit none
  integer, parameter :: n_bodies = 300, n_steps = 60
  real(wp), parameter :: h = 0.1_wp, side = 24.0_wp
  type(tests_t) :: t

  call test_motion('disks', share_disks=1.0_wp, period=0.0_wp)
  call test_motion('disks and polygons', share_disks=0.5_wp, period=0.0_wp)
  call test_motion('periodic', share_disks=0.3_wp, period=side)
  call t%finish()

contains

  !> Bodies go through each other; now and then some change their velocity, in the step or by its solution.
  subroutine test_motion(name, share_disks, period)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: share_disks, period
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random
    real(wp) :: solution(3, n_bodies)
    logical :: is_left, is_expected
    integer :: step, b, reduced, whole, lefts

    call random%seed(11)
    call make_scene(scene, random, share_disks, period)
    reduced = 0
    whole = 0
    lefts = 0
    do step = 1, n_steps
      call change(random, 0.002_wp, scene%bodies%free_velocity)
      pairs%way = way_of_step(scene, h, 1)
      call reduce_alerts(scene, h, pairs)
      call detect(scene, pairs, history, contacts)
      solution = scene%bodies%free_velocity
      call change(random, 0.1_wp, solution)
      call compare(scene, pairs, contacts, solution, name, whole, is_expected)
      reduced = reduced + contacts%n
      is_left = has_left_out(scene, pairs, history, contacts, solution, [(int(b, i4), b=1, n_bodies)], .true.)
      call t%check(is_left .eqv. is_expected, name//': what is left out is found')
      if (is_left) lefts = lefts + 1
      scene%bodies%middle = scene%bodies%middle + h*scene%bodies%free_velocity
      scene%bodies%position = scene%bodies%middle(1:2, :) - h/2*scene%bodies%free_velocity(1:2, :)
    end do
    call t%check(pairs%builds > 2 .and. pairs%builds < n_steps/2, name//': lists last for some steps')
    call t%check(reduced > n_steps*20 .and. 5*reduced < 4*whole, name//': few of the contacts remain')
    call t%check(lefts > 3 .and. lefts < n_steps - 3, name//': some solutions close others, some do not')
  end subroutine test_motion

  !> Compare with a detection up to the whole distance from nothing, and look there for what a solution closes.
  subroutine compare(scene, pairs, contacts, solution, name, whole, closes)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: solution(:, :)
    character(len=*), intent(in) :: name
    integer, intent(inout) :: whole
    logical, intent(out) :: closes
    type(scene_t) :: copy
    type(neighbours_t) :: others
    type(history_t) :: history
    type(contacts_t) :: all
    real(wp) :: u(2)
    integer :: p, k, n

    copy = scene
    others%way = pairs%way
    call detect(copy, others, history, all)
    others%least = pairs%least
    others%motion = pairs%motion
    others%is_reduced = .true.
    others%is_by_pair = pairs%is_by_pair
    closes = .false.
    n = 0
    do p = 1, others%n
      do k = history%first(p), history%first(p + 1) - 1
        if (all%gap(k) < alert_of_pair(others, p)) then
          n = n + 1
        else
          u = relative_velocity(all, k, copy%bodies%middle, copy%period, solution)
          closes = closes .or. all%gap(k) + h*u(1) < 0
        end if
      end do
    end do
    call t%equal(contacts%n, n, name//': contacts within the distances of their pairs')
    whole = whole + all%n
  end subroutine compare

  !> Give a share of the bodies new velocities: most are slow, a few fast.
  subroutine change(random, share, velocity)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: share
    real(wp), intent(inout) :: velocity(:, :)
    real(wp) :: speed, angle
    integer :: b

    do b = 2, n_bodies
      if (random%uniform() > share) cycle
      speed = 10**random%uniform(-3.0_wp, 0.0_wp)
      angle = random%uniform(0.0_wp, 2*pi)
      velocity(:, b) = speed*[cos(angle), sin(angle), random%uniform(-1.0_wp, 1.0_wp)]
    end do
  end subroutine change

  !> Disks, some beside the centre of their body, and polygons at random over a fixed segment, with random velocities.
  subroutine make_scene(scene, random, share_disks, period)
    type(scene_t), intent(out) :: scene
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: share_disks, period
    real(wp) :: vertices(2, 5), radius
    integer :: b, v, colour

    call scene%bodies%allocate(n_bodies)
    scene%bodies%is_grain = .true.
    call colour_index(scene, 'grain', colour)
    allocate (scene%laws(1), scene%drives(0), scene%pressures(0), scene%sees(1))
    scene%sees(1)%law = 1
    scene%sees(1)%alert = 0.3_wp
    scene%sees(1)%least_alert = 0.02_wp
    scene%period = period
    call add_segment(scene%contactors, 1, colour, side, 0.1_wp, [0.0_wp, 0.0_wp], 0.0_wp)
    do b = 2, n_bodies
      radius = random%uniform(0.3_wp, 0.6_wp)
      if (random%uniform() < share_disks) then
        call add_disk(scene%contactors, b, colour, radius, merge(0.1_wp, 0.0_wp, modulo(b, 4) == 0)*[1.0_wp, 1.0_wp])
      else
        vertices = radius*reshape([(cos(2*pi*real(v, wp)/5), sin(2*pi*real(v, wp)/5), v=1, 5)], [2, 5])
        call add_polygon(scene%contactors, b, colour, vertices, [0.0_wp, 0.0_wp])
      end if
      scene%bodies%middle(:, b) = [random%uniform(0.0_wp, side), random%uniform(0.0_wp, side), 0.0_wp]
    end do
    scene%bodies%position = scene%bodies%middle(1:2, :)
    scene%bodies%free_velocity = 0
    call change(random, 1.0_wp, scene%bodies%free_velocity)
  end subroutine make_scene
end program test_pair_alert
