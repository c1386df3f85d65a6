!> Impulses carried from one detection to the next: by pair and feature, through new lists, from a deck's points, over periods.
program test_history
  use harness, only: tests_t
  use kept_states, only: count_marks, mark, mark_all
  use scenes, only: begin_scene, place_bodies, put_disk, put_polygon, put_wall
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_history, only: history_t, resume_history, revive, start_history
  use sg_kinds, only: wp
  use sg_laws, only: law_iqs_g0, law_mohr, status_bonded, status_new, status_slide, status_stick
  use sg_neighbour_list, only: neighbours_t
  use sg_random, only: random_t
  use sg_scene, only: scene_t, start_contact_t
  implicit none
  integer, parameter :: rows = 8, n_grains = rows**2
  real(wp), parameter :: square(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])/2
  type(tests_t) :: t

  call test_recovery(period=0.0_wp, name='box')
  call test_recovery(period=real(rows, wp), name='periodic')
  call test_resume()
  call test_points()
  call test_bonds()
  call test_images()
  call test_one_side()
  call t%finish()

contains

  !> Squares and disks that nearly touch, on a floor.
  subroutine make_scene(scene, period)
    type(scene_t), intent(out) :: scene
    real(wp), intent(in) :: period
    integer :: b
    real(wp) :: place(2)

    call begin_scene(scene, n_grains + 1, 0.3_wp, 0.3_wp)
    scene%period = period
    do b = 1, n_grains
      place = [real(modulo(b - 1, rows), wp) + 0.5_wp, real((b - 1)/rows, wp) + 0.5_wp]
      if (modulo(b, 3) == 0) then
        call put_disk(scene, b, 0.5_wp, place)
      else
        call put_polygon(scene, b, spread(place, 2, 4) + square)
      end if
    end do
    call put_wall(scene, n_grains + 1, 40.0_wp, 0.1_wp, [4.0_wp, -0.1_wp], 0.0_wp)
    call place_bodies(scene)
  end subroutine make_scene

  !> Bodies move a little and far; contacts that were there keep their impulses, new ones take over the remaining ones of
  !! their pair or start at zero.
  subroutine test_recovery(period, name)
    real(wp), intent(in) :: period
    character(len=*), intent(in) :: name
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts, before
    type(random_t) :: random
    integer :: round, wrong, new, b, kept, builds

    call random%seed(1)
    contacts%n_internal = 2
    call make_scene(scene, period)
    call detect(scene, pairs, history, contacts)
    call count_marks(before, contacts, wrong, new)
    call t%equal(new, contacts%n, name//': at first all contacts are new')
    kept = 0
    do round = 1, 40
      call mark_all(contacts)
      before = contacts
      do b = 1, n_grains
        scene%bodies%position(:, b) = scene%bodies%position(:, b) + 0.01_wp*[random%uniform() + 4.0_wp, random%uniform() - 0.5_wp]
      end do
      call place_bodies(scene)
      call detect(scene, pairs, history, contacts)
      call count_marks(before, contacts, wrong, new)
      call t%equal(wrong, 0, name//': impulses are those of the same pair and feature')
      kept = kept + contacts%n - new
      call t%check(new < contacts%n/4, name//': nearly all contacts go on')
    end do
    call t%check(pairs%builds > 10, name//': the list was made again several times')
    call t%check(kept > 40*100, name//': contacts were kept')
    ! The same places again, one period on: every impulse is found.
    if (.not. period > 0) return
    builds = pairs%builds
    call mark_all(contacts)
    before = contacts
    scene%bodies%position(1, :n_grains) = scene%bodies%position(1, :n_grains) + period
    call place_bodies(scene)
    call detect(scene, pairs, history, contacts)
    call count_marks(before, contacts, wrong, new)
    call t%check(pairs%builds > builds, name//': a period on, the list is made again')
    ! Rounding of positions may choose another face of two that are as good.
    call t%equal(wrong, 0, name//': a period on, no impulse is wrong')
    call t%check(new <= contacts%n/50, name//': a period on, contacts go on')
  end subroutine test_recovery

  !> Contacts given back by `revive` and taken by `resume_history` are found again, with the same list and with a new one.
  subroutine test_resume()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs, fresh
    type(history_t) :: history, resumed
    type(contacts_t) :: contacts, kept, revived
    integer :: wrong, new, i

    contacts%n_internal = 1
    revived%n_internal = 1
    call make_scene(scene, 0.0_wp)
    call detect(scene, pairs, history, contacts)
    call mark_all(contacts)
    kept = contacts
    do i = 1, 2
      contacts = contacts_t(n_internal=1)
      resumed = history_t()
      call resume_history(resumed, kept)
      if (i == 1) call detect(scene, pairs, resumed, contacts)
      if (i == 2) call detect(scene, fresh, resumed, contacts)
      call count_marks(kept, contacts, wrong, new)
      call t%equal(wrong + new, 0, 'resumed: all contacts go on')
      call t%equal(contacts%n, kept%n, 'resumed: as many contacts')
    end do
    ! Nothing touches any more: the contacts of before come back all the same.
    contacts = kept
    scene%bodies%middle(1, :) = scene%bodies%middle(1, :)*2
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%n /= kept%n, 'the step that failed has other contacts')
    call revive(history, pairs, revived)
    call t%equal(revived%n, kept%n, 'revived: as many contacts')
    if (revived%n /= kept%n) return
    call t%check(all(revived%contactor(:, :kept%n) == kept%contactor(:, :kept%n)) .and. &
                 all(revived%feature(:kept%n) == kept%feature(:kept%n)) .and. &
                 .not. any(abs(revived%impulse(:, :kept%n) - kept%impulse(:, :kept%n)) > 0) .and. &
                 .not. any(abs(revived%internal(:, :kept%n) - kept%internal(:, :kept%n)) > 0), 'revived: the same contacts')
  end subroutine test_resume

  !> Contacts of a deck: found by their points, either way round, forces turned into impulses.
  subroutine test_points()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    integer :: k
    real(wp), parameter :: h = 0.5_wp

    call begin_scene(scene, 3, 0.3_wp, 0.1_wp)
    call put_polygon(scene, 1, square)
    call put_polygon(scene, 2, square + spread([0.0_wp, 1.0_wp], 2, 4))
    call put_disk(scene, 3, 0.5_wp, [0.0_wp, 2.0_wp])
    call place_bodies(scene)
    allocate (scene%start_contacts(3))
    scene%start_contacts(1) = start_contact_t([1, 2], [0.4_wp, 0.45_wp, 0.0_wp], [2.0_wp, 1.0_wp, 0.0_wp], status_stick)
    scene%start_contacts(2) = start_contact_t([2, 3], [0.0_wp, 1.5_wp, 0.0_wp], [6.0_wp, 3.0_wp, 0.0_wp], status_slide)
    scene%start_contacts(3) = start_contact_t([2, 1], [-0.4_wp, 0.55_wp, 0.0_wp], [4.0_wp, 2.0_wp, 0.0_wp], status_slide)
    scene%laws(1)%kind = law_iqs_g0
    scene%start_contacts(1)%internal(1) = 0.125_wp
    scene%start_contacts(1)%has_internal = .true.
    scene%start_contacts(3)%internal(1) = 0.25_wp
    contacts%n_internal = 1
    call start_history(history, scene, h, 2, 1)
    call detect(scene, pairs, history, contacts)
    call t%equal(contacts%n, 3, 'start contacts: as many as in the scene')
    do k = 1, contacts%n
      if (contacts%contactor(1, k) == 3) then
        call t%near(contacts%impulse(1, k), 6*h, 1e-15_wp, 'start contacts: the disk')
        call t%check(contacts%status(k) == status_slide, 'start contacts: status of the disk')
      else if (contacts%point(1, k) > 0) then
        call t%near(maxval(abs(contacts%impulse(:, k) - [2*h, h])), 0.0_wp, 1e-15_wp, 'start contacts: right corner')
        call t%near(contacts%internal(1, k), 0.125_wp, 0.0_wp, 'start contacts: the internal value that was read')
        call t%check(contacts%status(k) == status_stick, 'start contacts: status of the right corner')
      else
        call t%near(maxval(abs(contacts%impulse(:, k) - [4*h, 2*h])), 0.0_wp, 1e-15_wp, 'start contacts: left corner')
        call t%near(contacts%internal(1, k), max(0.0_wp, contacts%gap(k)), 0.0_wp, 'start contacts: the value of the law')
      end if
    end do
    ! From then on by feature.
    call mark_all(contacts)
    call detect(scene, pairs, history, contacts)
    call t%near(contacts%impulse(1, 1), mark(contacts, 1), 0.0_wp, 'start contacts: later ones by feature')
  end subroutine test_points

  !> Contacts of the first step start bonded under Mohr-Coulomb; later ones do not.
  subroutine test_bonds()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts

    call begin_scene(scene, 2, 0.3_wp, 0.1_wp)
    scene%laws(1)%kind = law_mohr
    call put_disk(scene, 1, 0.5_wp, [0.0_wp, 0.0_wp])
    call put_disk(scene, 2, 0.5_wp, [0.0_wp, 1.0_wp])
    call place_bodies(scene)
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%status(1) == status_bonded, 'bonds: at the start')
    scene%bodies%position(2, 2) = 3
    call place_bodies(scene)
    call detect(scene, pairs, history, contacts)
    call t%equal(contacts%n, 0, 'bonds: drawn apart')
    scene%bodies%position(2, 2) = 1
    call place_bodies(scene)
    call detect(scene, pairs, history, contacts)
    call t%check(contacts%status(1) == status_new, 'bonds: none where grains meet later')
  end subroutine test_bonds

  !> Two disks in a narrow period touch on both sides: each image keeps its own impulse when one or both cross the border.
  subroutine test_images()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random
    integer :: round, n_apart

    call random%seed(7)
    call begin_scene(scene, 2, 0.3_wp, 0.05_wp)
    scene%period = 2
    call put_disk(scene, 1, 0.5_wp, [0.4_wp, 0.0_wp])
    call put_disk(scene, 2, 0.5_wp, [1.4_wp, 0.0_wp])
    call place_bodies(scene)
    n_apart = 0
    call detect(scene, pairs, history, contacts)
    do round = 1, 40
      call t%equal(contacts%n, 2, 'images: both sides touch')
      contacts%impulse(:, :2) = contacts%normal(:, :2)
      contacts%status(:2) = status_slide
      if (modulo(round, 3) == 0) then
        history = history_t()
        call resume_history(history, contacts)
        pairs = neighbours_t()
      end if
      scene%bodies%position = scene%bodies%position + spread(random%uniform(0.5_wp, 5.0_wp)*[random%uniform(-1.0_wp, 1.0_wp), &
                                                                                            1.0_wp], 2, 2)
      call place_bodies(scene)
      call detect(scene, pairs, history, contacts)
      call t%near(maxval(abs(contacts%impulse(:, :2) - contacts%normal(:, :2))), 0.0_wp, 1e-12_wp, &
                  'images: each side keeps its own impulse')
      if (scene%bodies%crossings(1) /= scene%bodies%crossings(2)) n_apart = n_apart + 1
    end do
    call t%check(n_apart > 5, 'images: one of the two was beyond the border')
  end subroutine test_images

  !> Of two disks that touch on both sides one side alone has a past: across the border too, the other side takes nothing of it.
  subroutine test_one_side()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts, right
    integer :: i, k

    do i = -1, 2
      call begin_scene(scene, 2, 0.3_wp, 0.05_wp)
      scene%period = 2
      call put_disk(scene, 1, 0.5_wp, [0.4_wp, 0.0_wp])
      call put_disk(scene, 2, 0.5_wp, [1.4_wp, 0.0_wp])
      call place_bodies(scene)
      contacts = contacts_t()
      pairs = neighbours_t()
      history = history_t()
      call detect(scene, pairs, history, contacts)
      k = maxloc(contacts%normal(1, :2), 1)
      right = contacts
      right%n = 1
      right%contactor(:, 1) = contacts%contactor(:, k)
      right%image(1) = contacts%image(k)
      right%feature(1) = contacts%feature(k)
      right%impulse(:, 1) = 1
      right%status(1) = status_bonded
      history = history_t()
      pairs = neighbours_t()
      call resume_history(history, right)
      scene%bodies%position(1, :) = scene%bodies%position(1, :) + real(i, wp)
      call place_bodies(scene)
      call detect(scene, pairs, history, contacts)
      call t%equal(contacts%n, 2, 'one side: both touch')
      do k = 1, contacts%n
        call t%check(contacts%status(k) == merge(status_bonded, status_new, contacts%normal(1, k) > 0), &
                     'one side: only the one that has a past is bonded')
      end do
    end do
  end subroutine test_one_side
end program test_history
