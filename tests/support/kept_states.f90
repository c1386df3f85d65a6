!> What restarts and histories must keep: states to the last bit, lists that can be made again, and impulses that tell the
!! contact they belong to.
module kept_states
  use harness, only: tests_t
  use same_bits, only: same
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  use sg_laws, only: status_new, status_slide
  use sg_neighbour_list, only: neighbours_t
  use sg_neighbours, only: build_neighbours
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: check_same_state, check_list_again, mark, mark_all, count_marks

  !> Components of a marked impulse over its mark
  real(wp), parameter :: factors(3) = [1.0_wp, -2.0_wp, 3.0_wp]

contains

  !> Compare bodies, contacts and energies of two simulations, to the last bit.
  subroutine check_same_state(t, a, b, name)
    class(tests_t), intent(inout) :: t !! the checks
    type(simulation_t), intent(in) :: a, b !! simulations
    character(len=*), intent(in) :: name !! of the case

    associate (one => a%scene%bodies, other => b%scene%bodies)
      call t%check(same(one%position, other%position), name//': positions')
      call t%check(same(one%velocity, other%velocity), name//': velocities')
      if (allocated(one%angle)) call t%check(same(one%angle, other%angle), name//': angles')
      if (allocated(one%orientation)) then
        call t%check(same(one%orientation, other%orientation), name//': orientations')
      end if
      if (allocated(one%crossings_y)) then
        call t%check(all(one%crossings == other%crossings) .and. all(one%crossings_y == other%crossings_y), name//': crossings')
      else
        call t%check(all(one%crossings == other%crossings), name//': crossings')
      end if
    end associate
    call t%equal(b%contacts%n, a%contacts%n, name//': number of contacts')
    if (b%contacts%n /= a%contacts%n) return
    associate (k => a%contacts%n)
      call t%check(same(a%contacts%impulse(:, :k), b%contacts%impulse(:, :k)), name//': impulses')
      call t%check(all(a%contacts%status(:k) == b%contacts%status(:k)), name//': statuses')
      call t%check(same(a%contacts%internal(:, :k), b%contacts%internal(:, :k)), name//': internal values')
    end associate
    call t%check(same(a%energy%pack(), b%energy%pack()), name//': energies')
  end subroutine check_same_state

  !> The list can be made again from `built`, pair by pair in the same order, and slots are a numbering of the bodies.
  subroutine check_list_again(t, scene, pairs, name)
    class(tests_t), intent(inout) :: t !! the checks
    type(scene_t), intent(in) :: scene !! scene
    type(neighbours_t), intent(in) :: pairs !! its list
    character(len=*), intent(in) :: name !! of the case
    type(scene_t) :: copy
    type(neighbours_t) :: again
    logical :: is_same
    integer :: b, axis

    copy = scene
    axis = scene%dimension
    ! The bodies have moved since: the list must not depend on where they are now.
    copy%bodies%middle(axis, :) = copy%bodies%middle(axis, :) + 0.01_wp
    call build_neighbours(again, copy, pairs%built, pairs%margin)
    call t%equal(again%n, pairs%n, name//': as many pairs when made again')
    if (again%n /= pairs%n) return
    is_same = all(again%contactor(:, :again%n) == pairs%contactor(:, :pairs%n)) .and. &
              all(again%image(:again%n) == pairs%image(:pairs%n)) .and. all(again%see(:again%n) == pairs%see(:pairs%n))
    if (scene%dimension == 3) is_same = is_same .and. all(again%image_y(:again%n) == pairs%image_y(:pairs%n))
    call t%check(is_same, name//': the same pairs in the same order')
    call t%check(all(pairs%slot_of(pairs%body_of) == [(b, b=1, scene%bodies%n)]), name//': each body has a slot')
  end subroutine check_list_again

  !> A number that tells a contact from all others, the same whatever its place in the list.
  pure real(wp) function mark(contacts, k)
    type(contacts_t), intent(in) :: contacts !! contacts
    integer, intent(in) :: k !! which of them

    mark = real(contacts%contactor(1, k), wp) + 1e3_wp*real(contacts%contactor(2, k), wp) + 1e6_wp*real(contacts%feature(k), wp)
  end function mark

  !> Mark all contacts by their impulses.
  subroutine mark_all(contacts)
    type(contacts_t), intent(inout) :: contacts !! all become sliding ones
    integer :: k

    do k = 1, contacts%n
      contacts%impulse(:, k) = mark(contacts, k)*factors(:contacts%n_components)
      contacts%status(k) = status_slide
      contacts%internal(:, k) = -mark(contacts, k)
    end do
  end subroutine mark_all

  !> Contacts with an impulse that is not theirs, and those that no contact of their pair and feature was before.
  !!
  !! Where the feature is new, the impulse is that of a contact of the same pair whose feature is gone, each handed on once, or zero
  !! where there is none left.
  subroutine count_marks(before, contacts, wrong, new)
    type(contacts_t), intent(in) :: before !! contacts when they were marked
    type(contacts_t), intent(in) :: contacts !! those found since
    integer, intent(out) :: wrong !! contacts with an impulse that is not theirs
    integer, intent(out) :: new !! contacts whose feature was not there
    logical :: is_left(before%n), is_new(contacts%n), is_of_pair(before%n)
    integer :: k, j

    is_left = .true.
    do j = 1, before%n
      do k = 1, contacts%n
        if (.not. abs(mark(contacts, k) - mark(before, j)) > 0) is_left(j) = .false.
      end do
    end do
    wrong = 0
    do k = 1, contacts%n
      is_new(k) = all([(abs(mark(before, j) - mark(contacts, k)) > 0, j=1, before%n)])
      if (is_new(k)) cycle
      if (contacts%status(k) /= status_slide .or. .not. carries(mark(contacts, k))) wrong = wrong + 1
    end do
    do k = 1, contacts%n
      if (.not. is_new(k)) cycle
      is_of_pair = is_left .and. [(all(before%contactor(:, j) == contacts%contactor(:, k)), j=1, before%n)]
      if (contacts%status(k) == status_new) then
        if (.not. carries(0.0_wp)) wrong = wrong + 1
        cycle
      end if
      j = findloc([(is_of_pair(j) .and. carries(mark(before, j)), j=1, before%n)], .true., 1)
      if (j == 0) wrong = wrong + 1
      if (j > 0) is_left(j) = .false.
    end do
    ! Where a past contact of a pair has no successor, no new contact of that pair may lack a past.
    do k = 1, contacts%n
      if (.not. is_new(k) .or. contacts%status(k) /= status_new) cycle
      if (any(is_left .and. [(all(before%contactor(:, j) == contacts%contactor(:, k)), j=1, before%n)])) wrong = wrong + 1
    end do
    new = count(is_new)
  contains
    !> Has the contact the impulse and the internal values of a mark?
    pure logical function carries(value)
      real(wp), intent(in) :: value

      carries = .not. (any(abs(contacts%impulse(:, k) - value*factors(:contacts%n_components)) > 0) .or. &
                       any(abs(contacts%internal(:, k) + value) > 0))
    end function carries
  end subroutine count_marks
end module kept_states
