!> Alert distances that follow the motion of a step: how far shapes may move, and lists that hold all that such motion reaches.
program test_alert
  use harness, only: tests_t
  use sg_contactors, only: add_disk, add_polygon
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_history, only: history_t
  use sg_kinds, only: wp
  use sg_neighbour_list, only: neighbours_t
  use sg_random, only: random_t
  use sg_scene, only: colour_index, scene_t, see_t
  use sg_sees, only: alert_of
  use sg_way_of_step, only: way_of_step
  implicit none
  type(tests_t) :: t

  call test_clamp()
  call test_way()
  call test_lists()
  call t%finish()

contains

  !> Between the least and the longest distance the way decides; a line without a least one has one distance.
  subroutine test_clamp()
    type(see_t) :: follows, fixed

    follows%alert = 0.5_wp
    follows%least_alert = 0.1_wp
    fixed%alert = 0.3_wp
    call t%check(all(abs(alert_of(follows, [0.0_wp, 0.2_wp, 7.0_wp]) - [0.1_wp, 0.2_wp, 0.5_wp]) <= 0), 'it follows in its limits')
    call t%check(all(abs(alert_of(fixed, [0.0_wp, 0.2_wp, 7.0_wp]) - 0.3_wp) <= 0), 'a given one stays')
  end subroutine test_clamp

  !> Ways by hand: twice what the fastest point moves, in all substeps, with what gravity adds from substep to substep.
  subroutine test_way()
    type(scene_t) :: scene
    type(scene_t) :: empty
    real(wp), parameter :: square(2, 4) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, &
                                                     -1.0_wp], [2, 4])

    call scene%bodies%allocate(2)
    call add_disk(scene%contactors, 1, 1, 0.5_wp, [0.0_wp, 0.0_wp])
    call add_polygon(scene%contactors, 2, 1, square, [0.0_wp, 0.0_wp])
    scene%bodies%free_velocity(:, 1) = [3.0_wp, -4.0_wp, 100.0_wp]
    scene%bodies%free_velocity(:, 2) = [1.0_wp, 0.0_wp, -2.0_wp]
    ! A disk may spin about its centre as it likes; a corner of the square moves by 1 + 2 m/s at most.
    call t%near(way_of_step(scene, 0.01_wp, 1), 2*0.01_wp*5, 1e-15_wp, 'a disk')
    scene%bodies%free_velocity(3, 2) = -9.0_wp
    call t%near(way_of_step(scene, 0.01_wp, 1), 2*0.01_wp*10, 1e-15_wp, 'a corner')
    scene%gravity(2) = -10
    call t%near(way_of_step(scene, 0.01_wp, 3), 2*0.03_wp*10.2_wp, 1e-15_wp, 'three substeps')
    scene%bodies%free_velocity(1, 1) = 1e200_wp
    call t%check(way_of_step(scene, 0.01_wp, 1) > 1e300_wp, 'a speed whose square has no room')
    call empty%bodies%allocate(0)
    call t%check(way_of_step(empty, 0.01_wp, 1) > 0, 'no body')
  end subroutine test_way

  !> Whatever the way of a step is, the contacts are those of a list made for it, and a list is made again only where it must be.
  subroutine test_lists()
    real(wp), parameter :: ways(8) = [0.05_wp, 0.02_wp, 0.09_wp, 0.11_wp, 0.3_wp, 0.0_wp, 0.9_wp, 0.2_wp]
    ! The first list holds ways up to 0.1, and as much more as its skin of about 0.044, which nothing uses that does not move; the
    ! one of 0.3 holds ways up to the longest of 0.5.
    integer, parameter :: builds(8) = [1, 1, 1, 1, 2, 2, 2, 2]
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    integer :: i

    call make_scene(scene)
    do i = 1, size(ways)
      pairs%way = ways(i)
      call detect(scene, pairs, history, contacts)
      call t%equal(pairs%builds, builds(i), 'lists made until then')
      call compare(scene, ways(i), contacts)
    end do
  end subroutine test_lists

  !> Compare contacts with those of a list made for the way of the step, and with all pairs.
  subroutine compare(scene, way, contacts)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: way
    type(contacts_t), intent(in) :: contacts
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: others
    integer :: k

    pairs%way = way
    call detect(scene, pairs, history, others)
    call t%equal(contacts%n, others%n, 'contacts of a list made before')
    if (contacts%n /= others%n) return
    ! Another list has another order.
    do k = 1, contacts%n
      call t%check(any(others%contactor(1, :others%n) == contacts%contactor(1, k) .and. &
                       others%contactor(2, :others%n) == contacts%contactor(2, k)), 'of the same shapes')
    end do
    call t%check(all(contacts%gap(:contacts%n) < max(0.01_wp, min(way, 0.5_wp))), 'none farther than the way')
    call t%equal(contacts%n, count_near(scene, max(0.01_wp, min(way, 0.5_wp))), 'as many as among all pairs')
  end subroutine compare

  !> Disks at random that see each other by a distance which follows the motion, and do not move.
  subroutine make_scene(scene)
    type(scene_t), intent(out) :: scene
    integer, parameter :: n_bodies = 200
    type(random_t) :: random
    integer :: b, colour

    call random%seed(3)
    call scene%bodies%allocate(n_bodies)
    scene%bodies%is_grain = .true.
    call colour_index(scene, 'grain', colour)
    allocate (scene%laws(1), scene%drives(0), scene%pressures(0))
    do b = 1, n_bodies
      call add_disk(scene%contactors, b, colour, random%uniform(0.3_wp, 0.6_wp), [0.0_wp, 0.0_wp])
      scene%bodies%middle(:, b) = [random%uniform(0.0_wp, 16.0_wp), random%uniform(0.0_wp, 16.0_wp), 0.0_wp]
    end do
    scene%bodies%position = scene%bodies%middle(1:2, :)
    allocate (scene%sees(1))
    scene%sees(1)%law = 1
    scene%sees(1)%alert = 0.5_wp
    scene%sees(1)%least_alert = 0.01_wp
  end subroutine make_scene

  !> Pairs of disks whose gap is below a distance.
  pure integer function count_near(scene, distance)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: distance
    integer :: i, j

    count_near = 0
    associate (x => scene%bodies%position, reach => scene%contactors%reach)
      do j = 2, scene%bodies%n
        do i = 1, j - 1
          if (norm2(x(:, i) - x(:, j)) - reach(i) - reach(j) < distance) count_near = count_near + 1
        end do
      end do
    end associate
  end function count_near
end program test_alert
