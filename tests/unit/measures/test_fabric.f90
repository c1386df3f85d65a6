!> Fabric, mobilised friction and sliding contacts against closed forms: lattices, and contacts by hand.
program test_fabric
  use harness, only: tests_t
  use measured, only: measures_of
  use scenes, only: begin_scene, place_bodies, put_disk, put_wall
  use scenes_space, only: begin_space_scene, put_sphere
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_kinds, only: wp, i1, i4, pi
  use sg_laws, only: status_slide, status_stick
  use sg_measures, only: measures_t
  use sg_scene, only: scene_t
  implicit none
  ! Means of a few hundred normals.
  real(wp), parameter :: rounding = 1e-13_wp
  type(tests_t) :: t

  call test_plane_lattice(pi/2, 'square', [0.5_wp, 0.0_wp, 0.5_wp])
  call test_plane_lattice(pi/3, 'triangular', [0.5_wp, 0.0_wp, 0.5_wp])
  call test_sheared_lattice()
  call test_cubic_lattice()
  call test_left_out()
  call test_friction()
  call t%finish()

contains

  !> Add a contact that carries an impulse along its normal and, in the plane, its tangent.
  subroutine touch(contacts, pair, normal, impulse, status)
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: pair(2)
    real(wp), intent(in) :: normal(:), impulse(:)
    integer(i1), intent(in) :: status

    contacts%dimension = size(normal)
    contacts%n_components = size(impulse)
    call reserve_contacts(contacts, contacts%n + 1)
    contacts%n = contacts%n + 1
    contacts%body(:, contacts%n) = int(pair, i4)
    contacts%contactor(:, contacts%n) = int(pair, i4)
    contacts%law(contacts%n) = 1
    contacts%normal(:, contacts%n) = normal
    contacts%point(:, contacts%n) = 0
    contacts%gap(contacts%n) = 0
    contacts%impulse(:, contacts%n) = impulse
    contacts%status(contacts%n) = status
    contacts%image(contacts%n) = 0_i1
    if (size(normal) == 3) contacts%image_y(contacts%n) = 0_i1
  end subroutine touch

  !> A periodic lattice of disks whose neighbours lie at multiples of an angle: each touches all of them with the same impulse.
  subroutine test_plane_lattice(angle, what, expected)
    real(wp), intent(in) :: angle, expected(3)
    character(len=*), intent(in) :: what
    integer, parameter :: n = 30
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    integer :: i, k

    call begin_scene(scene, n, 0.0_wp, 0.01_wp)
    do i = 1, n
      call put_disk(scene, i, 0.5_wp, [real(i, wp), 0.0_wp])
    end do
    call place_bodies(scene)
    do i = 1, n
      do k = 0, nint(pi/angle) - 1
        call touch(contacts, [i, 1 + modulo(i + k, n)], [cos(real(k, wp)*angle), sin(real(k, wp)*angle)], &
                   [2.0_wp, 0.0_wp], status_stick)
      end do
    end do
    call expect(measures_of(scene, contacts, 1.0_wp), ['xx', 'xy', 'yy'], expected, what)
  end subroutine test_plane_lattice

  !> Of a triangular lattice that is pressed along one of its axes the contacts across it are open.
  subroutine test_sheared_lattice()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    integer :: i, k

    call begin_scene(scene, 10, 0.0_wp, 0.01_wp)
    do i = 1, 10
      call put_disk(scene, i, 0.5_wp, [real(i, wp), 0.0_wp])
    end do
    call place_bodies(scene)
    do i = 1, 9
      do k = 0, 2
        call touch(contacts, [i, i + 1], [cos(real(k, wp)*pi/3), sin(real(k, wp)*pi/3)], &
                   [real(min(k, 1), wp), 0.0_wp], status_stick)
      end do
    end do
    call expect(measures_of(scene, contacts, 1.0_wp), ['xx', 'xy', 'yy'], [0.25_wp, 0.0_wp, 0.75_wp], 'open contacts')
  end subroutine test_sheared_lattice

  !> Simple cubic: a third along each axis; pressed along z alone, all along z.
  subroutine test_cubic_lattice()
    integer, parameter :: n = 12
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    real(wp) :: normal(3)
    integer :: i, axis, pass

    do pass = 1, 2
      call begin_space_scene(scene, n, 0.0_wp, 0.01_wp)
      do i = 1, n
        call put_sphere(scene, i, 0.5_wp, [real(i, wp), 0.0_wp, 0.0_wp])
      end do
      call place_bodies(scene)
      contacts = contacts_t()
      do i = 1, n
        do axis = 1, 3
          normal = 0
          normal(axis) = 1
          call touch(contacts, [i, 1 + modulo(i + axis, n)], normal, merge(0.0_wp, 1.0_wp, pass == 2 .and. axis < 3)*normal, &
                     status_stick)
        end do
      end do
      if (pass == 1) then
        call expect(measures_of(scene, contacts, 1.0_wp), ['xx', 'xy', 'xz', 'yy', 'yz', 'zz'], &
                    [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp]/3, 'cubic')
      else
        call expect(measures_of(scene, contacts, 1.0_wp), ['xx', 'xy', 'xz', 'yy', 'yz', 'zz'], &
                    [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], 'cubic, pressed along z')
      end if
    end do
  end subroutine test_cubic_lattice

  !> Contacts with walls, and those that pull, have no part in the fabric; neighbours by kind count the former.
  subroutine test_left_out()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures

    call begin_scene(scene, 4, 0.0_wp, 0.01_wp)
    call put_disk(scene, 1, 0.5_wp, [0.0_wp, 0.0_wp])
    call put_disk(scene, 2, 0.5_wp, [1.0_wp, 0.0_wp])
    call put_disk(scene, 3, 0.5_wp, [2.0_wp, 0.0_wp])
    call put_wall(scene, 4, 5.0_wp, 0.1_wp, [0.0_wp, -0.6_wp], 0.0_wp)
    call place_bodies(scene)
    call touch(contacts, [1, 2], [1.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], status_stick)
    call touch(contacts, [1, 4], [0.0_wp, 1.0_wp], [5.0_wp, 0.0_wp], status_stick)
    call touch(contacts, [2, 3], [0.0_wp, 1.0_wp], [-1.0_wp, 0.0_wp], status_stick)
    measures = measures_of(scene, contacts, 1.0_wp)
    call expect(measures, ['xx', 'xy', 'yy'], [1.0_wp, 0.0_wp, 0.0_wp], 'left out')
    call t%near(measures%get('grain_coordination'), 2/3.0_wp, rounding, 'grains that a grain touches')
    call t%near(measures%get('wall_coordination'), 1/3.0_wp, rounding, 'walls that a grain touches')
    call t%near(measures%get('coordination'), 1.0_wp, rounding, 'both')
  end subroutine test_left_out

  !> Sums of tangential over normal impulses, in the plane and in space; contacts of laws without friction do not count.
  subroutine test_friction()
    type(scene_t) :: scene
    type(contacts_t) :: contacts, in_space
    type(measures_t) :: measures
    integer :: i

    call begin_scene(scene, 3, 0.4_wp, 0.01_wp)
    do i = 1, 3
      call put_disk(scene, i, 0.5_wp, [real(i, wp), 0.0_wp])
    end do
    call place_bodies(scene)
    call touch(contacts, [1, 2], [1.0_wp, 0.0_wp], [1.0_wp, -0.4_wp], status_slide)
    call touch(contacts, [2, 3], [0.0_wp, 1.0_wp], [3.0_wp, 0.6_wp], status_stick)
    call touch(contacts, [1, 3], [0.0_wp, 1.0_wp], [-3.0_wp, 0.6_wp], status_slide)
    measures = measures_of(scene, contacts, 1.0_wp)
    call t%near(measures%get('mobilised_friction'), 0.25_wp, rounding, 'mobilised friction')
    call t%near(measures%get('sliding_share'), 0.5_wp, rounding, 'sliding contacts')
    scene%laws(1)%static_friction = 0
    scene%laws(1)%dynamic_friction = 0
    measures = measures_of(scene, contacts, 1.0_wp)
    call t%near(measures%get('sliding_share'), 0.0_wp, 0.0_wp, 'none where nothing rubs')

    call begin_space_scene(scene, 2, 0.5_wp, 0.01_wp)
    do i = 1, 2
      call put_sphere(scene, i, 0.5_wp, [real(i, wp), 0.0_wp, 0.0_wp])
    end do
    call place_bodies(scene)
    call touch(in_space, [1, 2], [0.0_wp, 0.6_wp, 0.8_wp], 10*[0.0_wp, 0.6_wp, 0.8_wp] + [3.0_wp, -3.2_wp, 2.4_wp], status_slide)
    measures = measures_of(scene, in_space, 1.0_wp)
    call t%near(measures%get('mobilised_friction'), 0.5_wp, rounding, 'mobilised friction in space')
    call t%near(measures%get('sliding_share'), 1.0_wp, rounding, 'sliding contacts in space')
  end subroutine test_friction

  !> Compare components of the fabric tensor.
  subroutine expect(measures, names, expected, what)
    type(measures_t), intent(in) :: measures
    character(len=2), intent(in) :: names(:)
    real(wp), intent(in) :: expected(:)
    character(len=*), intent(in) :: what
    integer :: i

    do i = 1, size(names)
      call t%near(measures%get('fabric_'//names(i)), expected(i), rounding, what//': fabric '//names(i))
    end do
  end subroutine expect
end program test_fabric
