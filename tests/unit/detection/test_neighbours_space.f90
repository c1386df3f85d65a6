!> Detection in space against brute force over all pairs and images: the same contacts, before and after motions of any size.
program test_neighbours_space
  use harness, only: tests_t
  use kept_states, only: check_list_again
  use polyhedra, only: prism_polyhedron
  use scenes_space, only: turn_at_random
  use sg_bodies, only: drop_rotation
  use sg_contactors, only: kind_plane, kind_polyhedron, kind_sphere, place_contactors
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_error, only: error_t
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4
  use sg_near, only: candidate_first
  use sg_neighbour_list, only: neighbours_t
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_random, only: random_t
  use sg_rotations, only: frame_of, no_rotation, turned_on
  use sg_scene, only: colour_index, scene_t
  use sg_sees, only: see_between
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  use sg_touch_space, only: touch_space_t
  use sg_touch_space_pair, only: touch_space_pair
  implicit none
  integer, parameter :: n_bodies = 300
  real(wp), parameter :: none(2) = 0
  type(tests_t) :: t

  call test_scene('spheres', 0.4_wp, 1.0_wp, none)
  call test_scene('spheres of one size to a thousand', 1e-3_wp, 1.0_wp, none)
  call test_scene('all shapes', 0.3_wp, 0.3_wp, none)
  call test_scene('all shapes of sizes to a thousand', 1e-3_wp, 0.3_wp, none)
  call test_scene('periodic in x', 0.4_wp, 0.3_wp, [10.0_wp, 0.0_wp])
  call test_scene('periodic in y', 0.4_wp, 0.3_wp, [0.0_wp, 10.0_wp])
  call test_scene('periodic in x and y', 0.1_wp, 0.3_wp, [10.0_wp, 9.0_wp])
  call test_scene('periods of a few grains', 0.5_wp, 0.5_wp, [5.5_wp, 6.5_wp])
  call test_colours()
  call test_no_rotation()
  call t%finish()

contains

  !> Detect in a random scene, then after motions below and above the skin.
  subroutine test_scene(name, smallest, share_spheres, period)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: smallest, share_spheres, period(2)
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random
    integer :: round, axis

    call random%seed(7)
    call make_scene(scene, random, smallest, share_spheres, period)
    contacts%dimension = 3
    contacts%n_components = 3
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%n > 50, name//': there are contacts')
    call compare(scene, contacts, name)
    call check_list_again(t, scene, pairs, name)
    do round = 1, 2
      ! Two motions of 0.13 skin at most stay below half a skin, turns included.
      call move(scene, random, 0.065_wp*pairs%skin)
      call detect(scene, pairs, history, contacts)
      call t%equal(pairs%builds, 1, name//': the list stays while motions are small')
      call compare(scene, contacts, name//', moved a little')
    end do
    do round = 1, 2
      ! Just above half a skin, so that shapes of a pair may have used it up, then far.
      call move(scene, random, merge(0.7_wp*pairs%skin, 3.0_wp, round == 1))
      call detect(scene, pairs, history, contacts)
      call t%equal(pairs%builds, 1 + round, name//': the list is made again after large motions')
      call compare(scene, contacts, name//', moved far')
      do axis = 1, 2
        if (.not. period(axis) > 0) cycle
        call t%check(all(scene%bodies%middle(axis, :) >= 0 .and. scene%bodies%middle(axis, :) < period(axis)), &
                     name//': all bodies are in the period')
      end do
    end do
  end subroutine test_scene

  !> Bodies of random shapes in a box of 10 by 10 by 6 within a hollow cylinder, one far away, and three planes; one body is
  !! a rough wall of spheres.
  subroutine make_scene(scene, random, smallest, share_spheres, period)
    type(scene_t), intent(out) :: scene
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: smallest, share_spheres, period(2)
    integer :: b, colour
    real(wp) :: r

    scene%dimension = 3
    scene%contactors%dimension = 3
    call scene%bodies%allocate(n_bodies, 3)
    call colour_index(scene, 'any', colour)
    allocate (scene%laws(1), scene%sees(1), scene%drives(0), scene%pressures(0))
    scene%sees(1)%law = 1
    scene%sees(1)%alert = 0.05_wp
    scene%period = period(1)
    scene%period_y = period(2)
    do b = 1, n_bodies
      scene%bodies%middle(1:3, b) = [10*random%uniform(), 10*random%uniform(), 6*random%uniform()]
      call turn_at_random(scene, b, random)
      r = smallest**random%uniform()
      if (b <= 5 .or. b == n_bodies) cycle
      call add_grain(scene, b, r, merge(0, modulo(b, 5), random%uniform() < share_spheres))
    end do
    scene%bodies%orientation(:, 1) = no_rotation
    call add_plane(scene%contactors, 1, colour, [8.0_wp, 8.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, 0.0_wp], frame_of(no_rotation))
    call add_plane(scene%contactors, 2, colour, [1.5_wp, 1.0_wp, 0.3_wp], [0.2_wp, 0.1_wp, 0.0_wp], &
                   frame_of([0.8_wp, 0.0_wp, 0.6_wp, 0.0_wp]), has_rim=.true.)
    call add_plane(scene%contactors, 3, colour, [0.1_wp, 0.2_wp, 0.01_wp], [0.0_wp, 0.0_wp, 0.0_wp], frame_of(no_rotation))
    ! A rough wall: spheres of one body side by side, far beyond the period where there is one.
    do b = -10, 10
      call add_sphere(scene%contactors, 4, colour, 0.5_wp, [real(b, wp), 0.0_wp, 0.0_wp])
    end do
    if (.not. any(period > 0)) then
      call add_hollow_cylinder(scene%contactors, 5, colour, 5.0_wp, 4.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], [0.6_wp, 0.0_wp, 0.8_wp])
    else
      call add_grain(scene, 5, 1.0_wp, 0)
    end if
    ! One grain flies far above: cells must not grow with it.
    call add_grain(scene, n_bodies, 1.0_wp, 0)
    scene%bodies%middle(3, n_bodies) = 1e6_wp
    scene%bodies%position = scene%bodies%middle(1:3, :)
    scene%bodies%middle(4:7, :) = scene%bodies%orientation
  end subroutine make_scene

  !> Give a body a shape of some radius: sphere, box, capsule, two spheres, or prism.
  subroutine add_grain(scene, b, r, choice)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: b, choice
    real(wp), intent(in) :: r
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error

    select case (choice)
    case (0)
      call add_sphere(scene%contactors, b, 1, r, [0.0_wp, 0.0_wp, 0.0_wp])
    case (1)
      call box_polyhedron(r*[0.5_wp, 0.4_wp, 0.7_wp], shape, error)
      call add_polyhedron(scene%contactors, b, 1, shape, [0.0_wp, 0.0_wp, 0.0_wp])
    case (2)
      call add_cylinder(scene%contactors, b, 1, 0.6_wp*r, 0.4_wp*r, [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.6_wp, 0.8_wp])
    case (3)
      call add_sphere(scene%contactors, b, 1, r/2, [r/2, 0.0_wp, 0.0_wp])
      call add_sphere(scene%contactors, b, 1, r/3, [-r/2, 0.0_wp, r/4])
    case default
      call prism_polyhedron(6, 0.8_wp*r, 0.5_wp*r, shape, error)
      call add_polyhedron(scene%contactors, b, 1, shape, [r/4, 0.0_wp, 0.0_wp])
    end select
    if (allocated(error)) error stop 'a shape that is none'
  end subroutine add_grain

  !> Move all bodies by at most a distance in each direction, and turn them by as much as that allows.
  subroutine move(scene, random, distance)
    type(scene_t), intent(inout) :: scene
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: distance
    real(wp) :: change(3, 2)
    integer :: b, i

    do b = 1, n_bodies
      do i = 1, 3
        change(i, 1) = random%uniform(-1.0_wp, 1.0_wp)
        change(i, 2) = random%uniform(-1.0_wp, 1.0_wp)
      end do
      scene%bodies%middle(1:3, b) = scene%bodies%middle(1:3, b) + distance*change(:, 1)
      ! The longest arms are those of the first plane and of the rough wall, some 11 m.
      ! A plane that spans a period stays level: it is endless only so.
      if (b == 1 .and. max(scene%period, scene%period_y) > 0) cycle
      if (scene%bodies%n_velocity == 6) then
        scene%bodies%middle(4:7, b) = turned_on(scene%bodies%middle(4:7, b), &
                                               merge(1e-3_wp, 2e-2_wp, b <= 5)*distance*change(:, 2))
      end if
    end do
    scene%bodies%position = scene%bodies%middle(1:3, :)
  end subroutine move

  !> Compare contacts with those of all pairs in all images that can matter.
  subroutine compare(scene, contacts, name)
    type(scene_t), intent(inout) :: scene
    type(contacts_t), intent(in) :: contacts
    character(len=*), intent(in) :: name
    type(touch_space_t) :: touch
    real(wp) :: period(2)
    integer :: i, j, x, y, most(2), found, missed, p, endless
    integer(i4) :: c, a

    call place_contactors(scene%contactors, scene%bodies%middle)
    period = [scene%period, scene%period_y]
    most = merge(3, 0, period > 0)
    endless = 0
    if (any(period > 0)) endless = findloc(scene%contactors%kind(:scene%contactors%n), kind_plane, 1)
    found = 0
    missed = 0
    do i = 2, scene%contactors%n
      do j = 1, i - 1
        if (scene%contactors%body(i) == scene%contactors%body(j)) cycle
        if (see_between(scene, i, j) == 0) cycle
        c = int(merge(i, j, candidate_first(scene%contactors, i, j)), i4)
        a = int(i + j, i4) - c
        do x = -most(1), most(1)
          do y = -most(2), most(2)
            if (is_other_image(scene, c, a, [x, y])) cycle
            call touch_space_pair(scene%contactors, c, a, [period*real([x, y], wp), 0.0_wp], scene%sees(1)%alert, period, touch)
            found = found + touch%n
            do p = 1, touch%n
              if (.not. is_listed(contacts, c, a, [x, y], touch, p, endless)) missed = missed + 1
            end do
          end do
        end do
      end do
    end do
    call t%equal(contacts%n, found, name//': as many contacts as over all pairs')
    call t%equal(missed, 0, name//': each of them is listed')
  end subroutine compare

  !> Is the antagonist a plane as long as a period, in an image that is not the nearest along it? It counts once.
  pure logical function is_other_image(scene, c, a, image)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: c, a
    integer, intent(in) :: image(2)
    real(wp) :: period(2), extent, apart
    integer :: axis

    is_other_image = .false.
    if (scene%contactors%kind(a) /= kind_plane) return
    period = [scene%period, scene%period_y]
    do axis = 1, 2
      if (.not. period(axis) > 0) cycle
      associate (row => scene%contactors%row(a))
        extent = 2*sum(scene%contactors%space%plane_half(:, row)*abs(scene%contactors%space%plane_world(axis::3, row)))
      end associate
      apart = scene%contactors%centre(axis, c) - scene%contactors%centre(axis, a)
      if (extent >= period(axis) .and. image(axis) /= nint(apart/period(axis))) is_other_image = .true.
    end do
  end function is_other_image

  !> Is a point of contact among the contacts? Both come from the same kernel and the same numbers: to the last bit. But of an
  !! endless plane the list may hold an image that was the nearest when it was made: the same point to rounding.
  pure logical function is_listed(contacts, c, a, image, touch, p, endless)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: c, a
    integer, intent(in) :: image(2), p, endless
    type(touch_space_t), intent(in) :: touch
    real(wp), parameter :: rounding = 1e-13_wp
    integer :: k

    is_listed = .true.
    do k = 1, contacts%n
      if (contacts%contactor(1, k) /= c .or. contacts%contactor(2, k) /= a) cycle
      if (contacts%contactor(2, k) == endless) then
        if (all(abs([contacts%gap(k) - touch%gap(p), contacts%normal(:, k) - touch%normal(:, p), &
                     contacts%point(:, k) - touch%point(:, p)]) <= rounding)) return
      end if
      if (int(contacts%image(k)) /= image(1) .or. int(contacts%image_y(k)) /= image(2)) cycle
      if (contacts%feature(k) /= touch%feature(p)) cycle
      if (.not. any(abs([contacts%gap(k) - touch%gap(p), contacts%normal(:, k) - touch%normal(:, p), &
                         contacts%point(:, k) - touch%point(:, p)]) > 0)) return
    end do
    is_listed = .false.
  end function is_listed

  !> Two colours that do not see their own: only pairs across; then only polyhedra with spheres.
  subroutine test_colours()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random
    integer :: colour, c

    call random%seed(8)
    call make_scene(scene, random, 0.3_wp, 0.3_wp, none)
    call colour_index(scene, 'other', colour)
    do c = 2, scene%contactors%n, 2
      scene%contactors%colour(c) = int(colour, i4)
    end do
    scene%sees(1)%candidate_colour = 1
    scene%sees(1)%antagonist_colour = colour
    contacts%dimension = 3
    contacts%n_components = 3
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%n > 50, 'colours: there are contacts')
    call compare(scene, contacts, 'colours')
    scene%sees(1)%candidate_colour = 0
    scene%sees(1)%antagonist_colour = 0
    scene%sees(1)%candidate_kind = kind_sphere
    scene%sees(1)%antagonist_kind = kind_polyhedron
    pairs = neighbours_t()
    history = history_t()
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%n > 20, 'a line for spheres and polyhedra: there are contacts')
    call compare(scene, contacts, 'a line for spheres and polyhedra')
  end subroutine test_colours

  !> Bodies without orientation.
  subroutine test_no_rotation()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random

    call random%seed(9)
    call make_scene(scene, random, 0.4_wp, 1.0_wp, [10.0_wp, 9.0_wp])
    call drop_rotation(scene%bodies, keep_orientation=.false.)
    contacts%dimension = 3
    contacts%n_components = 1
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%n > 50, 'no rotation: there are contacts')
    call compare(scene, contacts, 'no rotation')
    call move(scene, random, 1.0_wp)
    call detect(scene, pairs, history, contacts)
    call compare(scene, contacts, 'no rotation, moved')
  end subroutine test_no_rotation
end program test_neighbours_space
