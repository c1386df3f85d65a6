!> Contacts that loops over plain arrays find in flows of disks, spheres and polygons: those of the general way, with the same past.
program test_plain_loops
  use harness, only: tests_t
  use sg_contactors, only: add_disk, add_polygon, add_segment
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_detect, only: detect
  use sg_history, only: exchange_kept, history_t, keep_contacts
  use sg_kept_contacts, only: n_kept_in_plane
  use sg_kinds, only: wp, i1, pi
  use sg_neighbour_list, only: neighbours_t
  use sg_polygon_pairs, only: are_plain_polygons
  use sg_random, only: random_t
  use sg_round_pairs, only: are_plain_rounds
  use sg_scene, only: colour_index, scene_t
  use sg_space_contactors, only: add_plane, add_sphere
  implicit none
  integer, parameter :: n_bodies = 250
  ! Coordinates of order ten, some tens of operations, which compilers may fuse in other ways.
  real(wp), parameter :: rounding = 1e-12_wp

  !> What one detection after the other finds
  type :: found_t
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
  end type found_t

  type(tests_t) :: t

  call test_flow('disks', 2, 1.0_wp, 0.0_wp)
  call test_flow('disks in a period', 2, 1.0_wp, 14.0_wp)
  call test_flow('polygons', 2, 0.0_wp, 0.0_wp)
  call test_flow('polygons in a period', 2, 0.0_wp, 14.0_wp)
  call test_flow('disks and polygons', 2, 0.5_wp, 0.0_wp)
  call test_flow('spheres', 3, 1.0_wp, 0.0_wp)
  call test_flow('spheres in a period', 3, 1.0_wp, 6.0_wp)
  call t%finish()

contains

  !> Move bodies from detection to detection, some hardly and most by far more than contacts are kept, and compare both ways. Every
  !! third contact gets a past to be recalled.
  subroutine test_flow(name, dimension, share_round, period)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension
    real(wp), intent(in) :: share_round, period
    type(found_t) :: looped, general
    type(random_t) :: random
    integer :: round

    call random%seed(11)
    call make_scene(looped, random, dimension, share_round, period)
    general = looped
    general%contacts%n_carried = 1
    call reserve_contacts(looped%contacts, 1)
    call reserve_contacts(general%contacts, 1)
    call detect(looped%scene, looped%pairs, looped%history, looped%contacts)
    call detect(general%scene, general%pairs, general%history, general%contacts)
    call t%check(looped%contacts%n > n_bodies/2, name//': there are contacts')
    do round = 1, 6
      call give_past(random, looped%contacts, general%contacts)
      call move(random, looped%scene)
      general%scene%bodies%middle = looped%scene%bodies%middle
      general%scene%bodies%position = looped%scene%bodies%position
      call check_loops(name, looped, general)
      call detect(looped%scene, looped%pairs, looped%history, looped%contacts)
      call detect(general%scene, general%pairs, general%history, general%contacts)
      call compare(name, looped%contacts, general%contacts)
    end do
  end subroutine test_flow

  !> A box full of disks or spheres and polygons, between walls that are not round.
  subroutine make_scene(found, random, dimension, share_round, period)
    type(found_t), intent(inout) :: found
    type(random_t), intent(inout) :: random
    integer, intent(in) :: dimension
    real(wp), intent(in) :: share_round, period
    integer :: b, colour

    associate (scene => found%scene)
      scene%dimension = dimension
      scene%contactors%dimension = dimension
      call scene%bodies%allocate(n_bodies, dimension)
      call colour_index(scene, 'any', colour)
      allocate (scene%laws(1), scene%sees(1), scene%drives(0), scene%pressures(0))
      scene%sees(1)%law = 1
      scene%sees(1)%alert = 0.05_wp
      scene%period = period
      do b = 2, n_bodies
        if (dimension == 3) then
          scene%bodies%middle(1:3, b) = [6*random%uniform(), 6*random%uniform(), 4*random%uniform()]
          call add_sphere(scene%contactors, b, colour, random%uniform(0.3_wp, 0.6_wp), [0.0_wp, 0.0_wp, 0.0_wp])
        else
          scene%bodies%middle(:, b) = [14*random%uniform(), 14*random%uniform(), 6*random%uniform()]
          call add_grain(scene, random, b, colour, random%uniform() < share_round)
        end if
      end do
      if (dimension == 2) then
        scene%kept_motion = 1e-3_wp
        found%contacts%n_kept = n_kept_in_plane
        call add_segment(scene%contactors, 1, colour, 7.0_wp, 0.1_wp, [7.0_wp, 0.0_wp], 0.0_wp)
        scene%bodies%position = scene%bodies%middle(1:2, :)
      else
        found%contacts%dimension = 3
        found%contacts%n_components = 3
        scene%bodies%middle(4:7, :) = scene%bodies%orientation
        call add_plane(scene%contactors, 1, colour, [4.0_wp, 4.0_wp, 0.1_wp], [3.0_wp, 3.0_wp, 0.0_wp], &
                       reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3]))
        scene%bodies%position = scene%bodies%middle(1:3, :)
      end if
      scene%bodies%is_grain(1) = .false.
    end associate
  end subroutine make_scene

  !> A disk, or a polygon of three to seven corners.
  subroutine add_grain(scene, random, b, colour, is_round)
    type(scene_t), intent(inout) :: scene
    type(random_t), intent(inout) :: random
    integer, intent(in) :: b, colour
    logical, intent(in) :: is_round
    real(wp) :: radius, corner(2, 7)
    integer :: v, n

    radius = random%uniform(0.4_wp, 0.8_wp)
    if (is_round) then
      call add_disk(scene%contactors, b, colour, radius, [0.0_wp, 0.0_wp])
      return
    end if
    n = 3 + modulo(b, 5)
    do v = 1, n
      corner(:, v) = radius*[cos(2*pi*real(v, wp)/real(n, wp)), sin(2*pi*real(v, wp)/real(n, wp))]
    end do
    call add_polygon(scene%contactors, b, colour, corner(:, :n), [0.0_wp, 0.0_wp])
  end subroutine add_grain

  !> Give every third contact an impulse, and all a status.
  subroutine give_past(random, one, other)
    type(random_t), intent(inout) :: random
    type(contacts_t), intent(inout) :: one, other
    integer :: k, i

    do k = 1, one%n
      one%status(k) = int(modulo(k, 3), i1)
      do i = 1, one%n_components
        one%impulse(i, k) = merge(random%uniform(), 0.0_wp, modulo(k, 3) == 0)
      end do
    end do
    if (one%n /= other%n) return
    other%status(:one%n) = one%status(:one%n)
    other%impulse(:, :one%n) = one%impulse(:, :one%n)
  end subroutine give_past

  !> Move half of the bodies hardly, the others by up to a tenth of their size; two stay at one place.
  subroutine move(random, scene)
    type(random_t), intent(inout) :: random
    type(scene_t), intent(inout) :: scene
    integer :: b, i

    do b = 2, n_bodies
      do i = 1, scene%dimension
        scene%bodies%middle(i, b) = scene%bodies%position(i, b) + &
                                      merge(1e-5_wp, 0.04_wp, modulo(b, 4) < 2)*random%uniform(-1.0_wp, 1.0_wp)
        scene%bodies%position(i, b) = (scene%bodies%middle(i, b) + scene%bodies%position(i, b))/2
      end do
      if (scene%dimension == 2 .and. modulo(b, 4) >= 2) &
        scene%bodies%middle(3, b) = scene%bodies%middle(3, b) + 0.02_wp*random%uniform()
    end do
    scene%bodies%middle(:scene%dimension, 3) = scene%bodies%middle(:scene%dimension, 2)
    scene%bodies%position(:, 3) = scene%bodies%position(:, 2)
  end subroutine move

  !> The next detection goes through the loops in one scene, and through none in the other, where contacts carry values.
  subroutine check_loops(name, looped, general)
    character(len=*), intent(in) :: name
    type(found_t), intent(in) :: looped, general

    call t%check(goes_through(looped), name//': through a loop')
    call t%check(.not. goes_through(general), name//': the general way')
  end subroutine check_loops

  !> Does the next detection go through a loop? It looks at the history that it begins with.
  logical function goes_through(found)
    type(found_t), intent(in) :: found
    type(found_t) :: next

    next = found
    call keep_contacts(next%history, next%contacts)
    call exchange_kept(next%history, next%contacts)
    associate (scene => next%scene, history => next%history, contacts => next%contacts)
      goes_through = are_plain_rounds(scene, history, contacts) .or. are_plain_polygons(scene, history, contacts)
    end associate
  end function goes_through

  !> The same contacts, places to rounding, with the same past, of which the same are kept.
  subroutine compare(name, one, other)
    character(len=*), intent(in) :: name
    type(contacts_t), intent(in) :: one, other
    real(wp) :: worst

    call t%equal(one%n, other%n, name//': as many by the general way')
    if (one%n /= other%n) return
    associate (n => one%n)
      call t%check(all(one%feature(:n) == other%feature(:n)) .and. all(one%body(:, :n) == other%body(:, :n)) .and. &
                   all(one%law(:n) == other%law(:n)) .and. all(one%contactor(:, :n) == other%contactor(:, :n)) .and. &
                   all(one%status(:n) == other%status(:n)) .and. all(one%image(:n) == other%image(:n)), name//': the same contacts')
      worst = maxval(abs(one%gap(:n) - other%gap(:n))) + maxval(abs(one%point(:, :n) - other%point(:, :n))) + &
              maxval(abs(one%normal(:, :n) - other%normal(:, :n)))
      if (one%n_kept > 0) then
        call t%check(all(one%is_kept(:n) == other%is_kept(:n)), name//': the same are kept')
        worst = worst + max(0.0_wp, maxval(maxval(abs(one%kept(:, :n) - other%kept(:, :n)), 1), one%is_kept(:n) > 0_i1))
      end if
      call t%near(worst, 0.0_wp, rounding, name//': the same places')
      call t%near(maxval(abs(one%impulse(:, :n) - other%impulse(:, :n))), 0.0_wp, 0.0_wp, name//': the same impulses')
      call t%check(any(abs(one%impulse(:, :n)) > 0), name//': impulses are recalled')
      if (one%n_kept > 0 .and. index(name, 'polygons') > 0) &
        call t%check(any(one%is_kept(:n) > 0_i1) .and. any(one%is_kept(:n) == 0_i1), name//': some are kept')
    end associate
  end subroutine compare
end program test_plain_loops
