!> Detection against brute force over all pairs and images: the same contacts, before and after motions of any size.
program test_neighbours
  use harness, only: tests_t
  use kept_states, only: check_list_again
  use sg_bodies, only: drop_rotation
  use sg_cells, only: build_cells, cells_t
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_segment, kind_segment, place_contactors
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_touch_pair, only: touch_pair
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4, pi
  use sg_near, only: candidate_first
  use sg_neighbour_list, only: neighbours_t
  use sg_random, only: random_t
  use sg_scene, only: colour_index, scene_t
  use sg_sees, only: see_between
  use sg_touch, only: touch_t
  implicit none
  integer, parameter :: n_bodies = 300
  type(tests_t) :: t

  call test_scene('disks', smallest=0.5_wp, share_disks=1.0_wp, period=0.0_wp)
  call test_scene('disks of one size to a thousand', smallest=1e-3_wp, share_disks=1.0_wp, period=0.0_wp)
  call test_scene('all shapes', smallest=0.3_wp, share_disks=0.4_wp, period=0.0_wp)
  call test_scene('all shapes of sizes to a thousand', smallest=1e-3_wp, share_disks=0.4_wp, period=0.0_wp)
  call test_scene('periodic disks', smallest=0.5_wp, share_disks=1.0_wp, period=20.0_wp)
  call test_scene('periodic, all shapes', smallest=0.1_wp, share_disks=0.4_wp, period=20.0_wp)
  call test_scene('a period of a few grains', smallest=0.5_wp, share_disks=0.4_wp, period=5.5_wp)
  call test_scene('a period of two columns of cells', smallest=0.5_wp, share_disks=1.0_wp, period=6.5_wp)
  call test_colours()
  call test_two_components()
  call test_nobody()
  call test_all_sizes()
  call t%finish()

contains

  !> Detect in a random scene, then after motions below and above the skin.
  subroutine test_scene(name, smallest, share_disks, period)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: smallest, share_disks, period
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random
    integer :: round

    call random%seed(7)
    call make_scene(scene, random, smallest, share_disks, period)
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%n > 50, name//': there are contacts')
    call compare(scene, contacts, name)
    call check_list_again(t, scene, pairs, name)
    do round = 1, 3
      ! Three motions of 0.15 skin at most stay below half a skin; turns add 0.01 skin at most.
      call move(scene, random, 0.1_wp*pairs%skin)
      call detect(scene, pairs, history, contacts)
      call t%equal(pairs%builds, 1, name//': the list stays while motions are small')
      call compare(scene, contacts, name//', moved a little')
    end do
    do round = 1, 4
      ! Just above half a skin, so that shapes of a pair may have used it up, then far.
      call move(scene, random, merge(0.7_wp*pairs%skin, 3.0_wp, round == 1))
      call detect(scene, pairs, history, contacts)
      call t%equal(pairs%builds, 1 + round, name//': the list is made again after large motions')
      call compare(scene, contacts, name//', moved far')
      if (period > 0) call t%check(all(scene%bodies%middle(1, :) >= 0 .and. scene%bodies%middle(1, :) < period), &
                                name//': all bodies are in the period')
    end do
  end subroutine test_scene

  !> Bodies of random shapes in a box of 20 by 20 within a hollow disk, one far away, and four walls, one of them of disks.
  subroutine make_scene(scene, random, smallest, share_disks, period)
    type(scene_t), intent(out) :: scene
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: smallest, share_disks, period
    integer :: b, colour
    real(wp) :: radius

    call scene%bodies%allocate(n_bodies)
    call colour_index(scene, 'any', colour)
    allocate (scene%laws(1), scene%sees(1), scene%drives(0), scene%pressures(0))
    scene%sees(1)%law = 1
    scene%sees(1)%alert = 0.05_wp
    scene%period = period
    do b = 1, n_bodies
      scene%bodies%middle(:, b) = [random%uniform(0.0_wp, 20.0_wp), random%uniform(0.0_wp, 20.0_wp), random%uniform(0.0_wp, 6.0_wp)]
      radius = smallest**random%uniform()
      if (b <= 4 .or. b == n_bodies) then
        cycle
      else if (random%uniform() < share_disks) then
        call add_disk(scene%contactors, b, colour, radius, [0.0_wp, 0.0_wp])
      else if (random%uniform() < 0.5_wp) then
        call add_disk(scene%contactors, b, colour, radius/2, [radius/2, 0.0_wp])
        call add_disk(scene%contactors, b, colour, radius/3, [-radius/2, radius/4])
      else
        call add_ngon(scene, b, colour, radius, 3 + modulo(b, 5))
      end if
    end do
    scene%bodies%is_grain(:4) = .false.
    call add_segment(scene%contactors, 1, colour, 10.0_wp, 0.1_wp, [0.0_wp, 0.0_wp], 0.0_wp)
    call add_segment(scene%contactors, 2, colour, 1.5_wp, 0.3_wp, [0.2_wp, 0.1_wp], 1.0_wp)
    call add_segment(scene%contactors, 3, colour, 0.1_wp, 0.01_wp, [0.0_wp, 0.0_wp], 2.0_wp)
    ! A rough wall: disks of one body side by side, far beyond the period where there is one.
    do b = -10, 10
      call add_disk(scene%contactors, 4, colour, 0.5_wp, [real(b, wp), 0.0_wp])
    end do
    if (.not. period > 0) call add_hollow(scene%contactors, 4, colour, 15.0_wp, [0.0_wp, 0.0_wp])
    scene%bodies%middle(:, 4) = [10.0_wp, 10.0_wp, 0.0_wp]
    ! One grain flies far above: cells must not grow with it. It does not see the hollow disk that holds all others.
    call add_ngon(scene, n_bodies, colour, 1.0_wp, 3)
    scene%bodies%middle(2, n_bodies) = 1e6_wp
    scene%bodies%position = scene%bodies%middle(1:2, :)
  end subroutine make_scene

  !> Make a body a regular polygon.
  subroutine add_ngon(scene, body, colour, radius, n)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body, colour, n
    real(wp), intent(in) :: radius
    real(wp) :: vertices(2, n)
    integer :: v

    do v = 1, n
      vertices(:, v) = radius*[cos(2*pi*real(v, wp)/real(n, wp)), sin(2*pi*real(v, wp)/real(n, wp))]
    end do
    call add_polygon(scene%contactors, body, colour, vertices, [0.0_wp, 0.0_wp])
  end subroutine add_ngon

  !> Move all bodies by at most a distance in each direction, and turn them by as much as that allows.
  subroutine move(scene, random, distance)
    type(scene_t), intent(inout) :: scene
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: distance
    integer :: b

    do b = 1, n_bodies
      scene%bodies%middle(1:2, b) = scene%bodies%middle(1:2, b) &
                                    + distance*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
      ! The longest arm is that of the wall, 10 m.
      if (scene%bodies%n_velocity == 3) then
        scene%bodies%middle(3, b) = scene%bodies%middle(3, b) + 1e-3_wp*distance*random%uniform(-1.0_wp, 1.0_wp)
      end if
    end do
    scene%bodies%position = scene%bodies%middle(1:2, :)
  end subroutine move

  !> Compare contacts with those of all pairs in all images that can matter.
  subroutine compare(scene, contacts, name)
    type(scene_t), intent(inout) :: scene
    type(contacts_t), intent(in) :: contacts
    character(len=*), intent(in) :: name
    type(touch_t) :: touch
    integer :: i, j, image, most, found, missed, p
    integer(i4) :: c, a

    call place_contactors(scene%contactors, scene%bodies%middle)
    most = 0
    if (scene%period > 0) most = 3
    found = 0
    missed = 0
    do i = 2, scene%contactors%n
      do j = 1, i - 1
        if (scene%contactors%body(i) == scene%contactors%body(j)) cycle
        if (see_between(scene, i, j) == 0) cycle
        c = int(merge(i, j, candidate_first(scene%contactors, i, j)), i4)
        a = int(i + j, i4) - c
        do image = -most, most
          if (is_other_image(scene, c, a, image)) cycle
          call touch_pair(scene%contactors, c, a, [scene%period*real(image, wp), 0.0_wp], scene%sees(1)%alert, touch)
          found = found + touch%n
          do p = 1, touch%n
            if (.not. is_listed(contacts, c, a, image, touch, p)) missed = missed + 1
          end do
        end do
      end do
    end do
    call t%equal(contacts%n, found, name//': as many contacts as over all pairs')
    call t%equal(missed, 0, name//': each of them is listed')
  end subroutine compare

  !> Is the antagonist a wall as long as the period, in an image that is not the nearest along x? It counts once.
  pure logical function is_other_image(scene, c, a, image)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: c, a
    integer, intent(in) :: image

    is_other_image = scene%contactors%kind(a) == kind_segment .and. scene%period > 0
    if (.not. is_other_image) return
    associate (row => scene%contactors%row(a), apart => scene%contactors%centre(1, c) - scene%contactors%centre(1, a))
      is_other_image = 2*scene%contactors%segment_size(1, row)*abs(scene%contactors%segment_axis(1, row)) >= scene%period &
                       .and. image /= nint(apart/scene%period)
    end associate
  end function is_other_image

  !> Is a point of contact among the contacts? Both come from the same kernel and the same numbers: to the last bit.
  pure logical function is_listed(contacts, c, a, image, touch, p)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: c, a
    integer, intent(in) :: image, p
    type(touch_t), intent(in) :: touch
    integer :: k

    is_listed = .true.
    do k = 1, contacts%n
      if (contacts%contactor(1, k) /= c .or. contacts%contactor(2, k) /= a .or. int(contacts%image(k)) /= image) cycle
      if (contacts%feature(k) /= touch%feature(p)) cycle
      if (.not. any(abs([contacts%gap(k) - touch%gap(p), contacts%normal(:, k) - touch%normal(:, p), &
                         contacts%point(:, k) - touch%point(:, p)]) > 0)) return
    end do
    is_listed = .false.
  end function is_listed

  !> Two colours that do not see their own: only pairs across, with the alert distance of their line.
  subroutine test_colours()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random
    integer :: colour, c

    call random%seed(8)
    call make_scene(scene, random, 0.3_wp, 0.4_wp, 0.0_wp)
    call colour_index(scene, 'other', colour)
    do c = 2, scene%contactors%n, 2
      scene%contactors%colour(c) = int(colour, i4)
    end do
    scene%sees(1)%candidate_colour = 1
    scene%sees(1)%antagonist_colour = colour
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%n > 100, 'colours: there are contacts')
    call compare(scene, contacts, 'colours')
    scene%sees(1)%antagonist_colour = 0
    scene%sees(1)%antagonist_kind = kind_segment
    pairs = neighbours_t()
    history = history_t()
    call detect(scene, pairs, history, contacts)
    call compare(scene, contacts, 'a line for walls')
  end subroutine test_colours

  !> Bodies without a third component.
  subroutine test_two_components()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random

    call random%seed(9)
    call make_scene(scene, random, 0.5_wp, 1.0_wp, 20.0_wp)
    call drop_rotation(scene%bodies, keep_orientation=.false.)
    contacts%n_components = 1
    call detect(scene, pairs, history, contacts)
    call compare(scene, contacts, 'two components')
    call move(scene, random, 1.0_wp)
    call detect(scene, pairs, history, contacts)
    call compare(scene, contacts, 'two components, moved')
  end subroutine test_two_components

  !> Where ranks outnumber grains and there is no wall, one of them holds no body: no extent, no contact, no number out of bounds.
  subroutine test_nobody()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts

    call scene%bodies%allocate(0)
    allocate (scene%sees(0), scene%colours(0))
    pairs%asked_skin = 0.1_wp
    call detect(scene, pairs, history, contacts)
    call t%equal(pairs%builds, 1, 'no body: a list is made')
    call t%equal(contacts%n, 0, 'no body: no contact')
    deallocate (pairs%built)
    pairs%asked_skin = 0
    call detect(scene, pairs, history, contacts)
    call t%check(pairs%skin >= 0 .and. pairs%skin <= 1, 'no body: a skin that is a length')
  end subroutine test_nobody

  !> Radii from the smallest number to the largest: their quotient is no number, and pairs are found all the same. Few circles get
  !! no level of their own.
  subroutine test_all_sizes()
    type(cells_t) :: cells
    real(wp), parameter :: sizes(4) = [tiny(1.0_wp), 1e-308_wp, 1.0_wp, 1e307_wp]
    integer, parameter :: many = 20
    real(wp) :: centre(3, 4*many), reach(4*many)

    centre = 0
    reach = reshape(spread(sizes, 1, many), [4*many])
    call build_cells(cells, centre, reach, 0.0_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    call t%equal(cells%n_levels, 3, 'levels of circles of all sizes')
    associate (level => reshape(cells%level, [many, 4]))
      call t%check(all(level(:, 1) == level(:, 2)) .and. all(level(:, 2) < level(:, 3)) .and. all(level(:, 3) < level(:, 4)), &
                   'levels grow with the radius')
    end associate
    call build_cells(cells, centre, reach(::many), 0.0_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    call t%equal(cells%n_levels, 2, 'levels of few circles')
    call t%near(cells%side(1, 2), 2*sizes(4), 0.0_wp, 'cells that hold the largest')
  end subroutine test_all_sizes
end program test_neighbours
