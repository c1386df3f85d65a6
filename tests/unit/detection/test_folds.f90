!> The folded tilt of a periodic cell: contacts that keep their impulses where their images get other numbers.
program test_folds
  use harness, only: tests_t
  use scenes, only: begin_scene, place_bodies, put_disk
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_history, only: history_t, resume_history
  use sg_kinds, only: wp
  use sg_laws, only: status_new, status_slide
  use sg_neighbour_list, only: neighbours_t
  use sg_scene, only: scene_t, set_edges
  implicit none
  !> Way of the upper face per step, over the height
  real(wp), parameter :: way = 0.02_wp
  type(tests_t) :: t

  call test_shear(1.0_wp)
  call test_shear(-1.0_wp)
  call t%finish()

contains

  !> A row of two disks in a cell that shears by three of its lengths, with restarts on the way: the strain goes on, and contacts
  !! with the rows above and below go on where the tilt is folded back.
  subroutine test_shear(direction)
    real(wp), intent(in) :: direction
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    integer :: step, n_kept

    call begin_scene(scene, 2, 0.3_wp, 0.05_wp)
    call put_disk(scene, 1, 0.5_wp, [0.4_wp, 0.3_wp])
    ! One length up: brought back into the cell, it counts a crossing.
    call put_disk(scene, 2, 0.5_wp, [1.4_wp, 1.3_wp])
    contacts%has_cell = .true.
    call scene%cell%begin([2.0_wp, 1.0_wp, 0.0_wp])
    allocate (scene%bodies%crossings_y(2), source=0)
    n_kept = 0
    do step = 0, 300
      if (step > 0) call shear(scene, direction*way)
      call set_edges(scene, (scene%cell%now))
      call place_bodies(scene)
      call detect(scene, pairs, history, contacts)
      call check_contacts(contacts, step == 0, n_kept)
      if (modulo(step, 7) > 0) cycle
      history = history_t()
      call resume_history(history, contacts)
      pairs = neighbours_t()
    end do
    call t%equal(int(scene%cell%folds), nint(3*direction), 'folds: as many as lengths sheared')
    call t%check(abs(scene%cell%now(4)) < 1 + way, 'folds: the tilt is at most half a length')
    call t%near(scene%cell%shear(), 6*direction, 1e-12_wp, 'folds: the strain goes on')
    call t%check(n_kept > 700, 'folds: most contacts go on')
  end subroutine test_shear

  !> Shear a cell of height 1, and its bodies with it.
  subroutine shear(scene, strain)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: strain

    scene%cell%now(4) = scene%cell%now(4) + strain
    associate (position => scene%bodies%position)
      position(1, :) = position(1, :) + strain*position(2, :)
    end associate
  end subroutine shear

  !> Contacts have the impulse that they were given, their normal of the step before; new ones have come to the alert distance just
  !! now.
  subroutine check_contacts(contacts, is_first, n_kept)
    type(contacts_t), intent(inout) :: contacts !! of a step; gets impulses
    logical, intent(in) :: is_first
    integer, intent(inout) :: n_kept
    integer :: k

    do k = 1, contacts%n
      if (contacts%status(k) == status_new) then
        if (.not. is_first) call t%check(contacts%gap(k) > 0.05_wp - way, 'folds: no contact loses its past')
      else
        call t%check(norm2(contacts%impulse(:, k) - contacts%normal(:, k)) < 2*way, 'folds: each image keeps its impulse')
        n_kept = n_kept + 1
      end if
      contacts%impulse(:, k) = contacts%normal(:, k)
      contacts%status(k) = status_slide
    end do
  end subroutine check_contacts
end program test_folds
