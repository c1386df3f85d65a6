!> Contacts that detection adds to those of a step, with what their past carries: points that the narrow phase has found, and points
!! that are kept while their pair hardly moves (sg_kept_contacts).
module sg_add_contacts
  use sg_contacts, only: contacts_t, grow_contacts
  use sg_follow, only: face_of, face_of_antagonist, face_of_candidate, follows
  use sg_hand_over, only: hand_over
  use sg_history, only: carried_of, history_t, past_pair, recall
  use sg_internal_values, only: first_internal, keeps_gap, not_recorded
  use sg_kept_contacts, only: has_moved_in_plane, has_moved_in_space, keep_in_plane, keep_in_space, move_in_plane, move_in_space, &
                              n_kept_in_plane, n_kept_in_space, n_pose_in_plane, n_pose_in_space, pose_in_plane, pose_in_space, &
                              shorter_reach, way_between
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: is_cohesive_zone, law_mohr, status_bonded, status_new
  use sg_neighbour_list, only: neighbours_t, offset_of
  use sg_rotations, only: no_rotation
  use sg_scene, only: scene_t
  use sg_touch_space, only: most_points
  implicit none
  private
  public :: add_contacts, add_kept, is_slow, keep_pair, kept_length, law_of

contains

  !> Add the points of contact of a pair, each with what its past carries.
  subroutine add_contacts(scene, pairs, history, p, law, n, normal, point, gap, feature, contacts)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(in) :: history !! contacts of the last detection
    integer, intent(in) :: p !! pair
    integer(i4), intent(in) :: law !! law of the pair
    integer, intent(in) :: n !! points
    real(wp), intent(in) :: normal(scene%dimension, n) !! their unit normals
    real(wp), intent(in) :: point(scene%dimension, n) !! the points [m]
    real(wp), intent(in) :: gap(n) !! their gaps [m]
    integer(i4), intent(in) :: feature(n) !! keys of the points within the pair
    type(contacts_t), intent(inout) :: contacts !! contacts of the step so far
    integer :: i, past(most_points)

    if (contacts%n + n > size(contacts%gap)) then
      call grow_contacts(contacts, contacts%n + n)
      if (contacts%is_cut) return
    end if
    do i = 1, n
      past(i) = recall(history, p, feature(i), point(:, i))
    end do
    if (any(past(:n) == 0)) call take_over(scene, pairs, history, p, point, past(:n))
    do i = 1, n
      call add_contact(scene, pairs, history, p, past(i), law, normal(:, i), point(:, i), gap(i), feature(i), contacts)
      if (contacts%n_kept > 0) contacts%is_kept(contacts%n) = 0_i1
    end do
  end subroutine add_contacts

  !> Let points whose features have no past take over the remaining history of the pair.
  pure subroutine take_over(scene, pairs, history, p, point, past)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: point(:, :)
    integer, intent(inout) :: past(:)
    real(wp) :: offset(3)
    integer :: before, first, last

    before = past_pair(history, p)
    if (before == 0 .or. history%by_point) return
    first = history%first(before)
    last = history%first(before + 1) - 1
    if (last < first) return
    offset = offset_of(scene, pairs, p)
    call hand_over(scene%contactors, pairs%contactor(1, p), pairs%contactor(2, p), offset(:scene%dimension), &
                   history%feature(first:last), point, first, past)
  end subroutine take_over

  !> Add one point of contact, with the impulse of its past.
  subroutine add_contact(scene, pairs, history, p, past, law, normal, point, gap, feature, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p, past
    integer(i4), intent(in) :: law
    real(wp), intent(in) :: normal(scene%dimension), point(scene%dimension), gap
    integer(i4), intent(in) :: feature
    type(contacts_t), intent(inout) :: contacts
    integer :: k

    k = contacts%n + 1
    contacts%n = k
    contacts%contactor(1, k) = pairs%contactor(1, p)
    contacts%contactor(2, k) = pairs%contactor(2, p)
    contacts%body(1, k) = scene%contactors%body(pairs%contactor(1, p))
    contacts%body(2, k) = scene%contactors%body(pairs%contactor(2, p))
    contacts%image(k) = pairs%image(p)
    if (scene%dimension == 3 .or. scene%cell%is_on) contacts%image_y(k) = pairs%image_y(p)
    if (allocated(contacts%image_z)) contacts%image_z(k) = pairs%image_z(p)
    contacts%law(k) = law
    contacts%feature(k) = feature
    ! Component by component: of a number that is not known the compiler calls a procedure to copy them.
    contacts%normal(1:2, k) = normal(1:2)
    contacts%point(1:2, k) = point(1:2)
    if (scene%dimension == 3) then
      contacts%normal(3, k) = normal(3)
      contacts%point(3, k) = point(3)
    end if
    contacts%gap(k) = gap
    if (past > 0) then
      contacts%impulse(1, k) = history%impulse(1, past)
      if (contacts%n_components > 1) contacts%impulse(2, k) = history%impulse(2, past)
      if (contacts%n_components > 2) contacts%impulse(3, k) = history%impulse(3, past)
      contacts%status(k) = history%status(past)
    else
      contacts%impulse(:, k) = 0
      contacts%status(k) = status_new
    end if
    if (history%is_start) contacts%status(k) = status_at_start(scene, contacts%law(k), contacts%status(k))
    if (contacts%n_internal > 0) call recall_internal(scene, history, past, k, contacts)
    if (contacts%n_carried > 0) contacts%carried(:, k) = carried_of(history, past, contacts%n_carried)
  end subroutine add_contact

  !> Internal values of a contact from its past. A contact whose values no file holds takes those that its law gives to contacts
  !! that are there from the start: in the very first step, or, where a gap is what it keeps, in the first step that has contacts.
  !! Later ones begin at zero.
  subroutine recall_internal(scene, history, past, k, contacts)
    type(scene_t), intent(in) :: scene
    type(history_t), intent(in) :: history
    integer, intent(in) :: past, k
    type(contacts_t), intent(inout) :: contacts
    logical :: is_first

    contacts%internal(:, k) = 0
    if (past > 0) contacts%internal(:, k) = history%internal(:, past)
    is_first = past == 0 .and. merge(history%is_untouched, history%is_start, keeps_gap(scene%laws(contacts%law(k))))
    if (past > 0) is_first = .not. contacts%internal(1, k) > not_recorded
    if (is_first) contacts%internal(:, k) = first_internal(scene%laws(contacts%law(k)), contacts%gap(k), scene%dimension, &
                                                           contacts%n_internal)
  end subroutine recall_internal

  !> What a contact of the very first step is taken to have done before: Mohr-Coulomb contacts and cohesive zones start bonded.
  pure integer(i1) function status_at_start(scene, law, status)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: law
    integer(i1), intent(in) :: status

    status_at_start = status
    if (status /= status_new) return
    if (scene%laws(law)%kind == law_mohr .or. is_cohesive_zone(scene%laws(law))) status_at_start = status_bonded
  end function status_at_start

  !> Do the bodies of two contactors move so little against each other that their contacts may be kept in the next step? Most of
  !! what falls or flows does not, and what is stored of it would be lost.
  pure logical function is_slow(scene, c, a, substeps)
    type(scene_t), intent(in) :: scene !! scene with its `middle` configuration
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    integer, intent(in) :: substeps !! from one detection to the next

    associate (bodies => scene%bodies, body => scene%contactors%body)
      is_slow = way_between(scene%dimension, size(bodies%middle, 1), bodies%position, bodies%middle, body(c), body(a), &
                            substeps) <= kept_length(scene, c, a)
    end associate
  end function is_slow

  !> Add the contacts that a pair had in the last detection, where its shapes are now; if they are kept, as far as is looked
  !! now, and the pair has hardly moved since they were found.
  subroutine add_kept(scene, pairs, history, p, alert, contacts, is_kept)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(in) :: history !! contacts of the last detection
    integer, intent(in) :: p !! pair
    real(wp), intent(in) :: alert !! alert distance of the pair [m]
    type(contacts_t), intent(inout) :: contacts !! contacts of the step so far
    logical, intent(out) :: is_kept !! are these its contacts?
    real(wp) :: offset(3), pose(n_pose_in_space)
    integer :: before, first, last

    is_kept = .false.
    before = past_pair(history, p)
    if (before == 0 .or. .not. allocated(history%kept) .or. history%by_point) return
    first = history%first(before)
    last = history%first(before + 1) - 1
    if (last < first .or. size(history%kept, 1) /= contacts%n_kept) return
    if (history%is_kept(first) == 0_i1) return
    if (alert > history%kept(contacts%n_kept, first)) return
    offset = offset_of(scene, pairs, p)
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      if (scene%dimension == 2) then
        pose(:n_pose_in_plane) = pose_in_plane(contactors, c, a, offset(:2))
        is_kept = .not. has_moved_in_plane(history%kept(:, first), pose, contactors%reach(c), kept_length(scene, c, a))
      else
        pose = pose_in_space(contactors, turn_of(scene, c), turn_of(scene, a), c, a, offset)
        is_kept = .not. has_moved_in_space(history%kept(:, first), pose, contactors%reach(c), kept_length(scene, c, a))
      end if
    end associate
    if (is_kept) call follow_pair(scene, pairs, history, p, alert, first, last, offset, pose, contacts)
  end subroutine add_kept

  !> Add contacts of the last detection that follow the two shapes of their pair.
  subroutine follow_pair(scene, pairs, history, p, alert, first, last, offset, pose, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p, first, last
    real(wp), intent(in) :: alert, offset(3), pose(n_pose_in_space)
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: normal(3), point(3), gap, turn(4), reach, farthest
    integer :: past

    if (contacts%n + last - first + 1 > size(contacts%gap)) then
      call grow_contacts(contacts, contacts%n + last - first + 1)
      if (contacts%is_cut) return
    end if
    associate (a => pairs%contactor(2, p), contactors => scene%contactors)
      reach = shorter_reach(history%kept(contacts%n_kept, first), alert, scene%sees(pairs%see(p))%alert)
      farthest = reach + kept_length(scene, pairs%contactor(1, p), a)
      turn = turn_of(scene, a)
      do past = first, last
        if (history%kept(contacts%n_kept - 1, past) > farthest) cycle
        if (scene%dimension == 2) then
          call move_in_plane(contactors, a, offset(:2), history%kept(:, past), pose(:n_pose_in_plane), normal(:2), point(:2), gap)
        else
          call move_in_space(contactors, a, offset, turn, history%kept(:, past), pose, normal, point, gap)
        end if
        call add_contact(scene, pairs, history, p, past, law_of(scene, pairs, p), normal, point, gap, history%feature(past), &
                         contacts)
        if (scene%dimension == 2) then
          contacts%kept(:n_kept_in_plane, contacts%n) = history%kept(:n_kept_in_plane, past)
        else
          contacts%kept(:n_kept_in_space, contacts%n) = history%kept(:n_kept_in_space, past)
        end if
        contacts%kept(contacts%n_kept, contacts%n) = reach
        contacts%is_kept(contacts%n) = 1_i1
      end do
    end associate
  end subroutine follow_pair

  !> Keep the contacts of a pair that have just been found.
  subroutine keep_pair(scene, pairs, history, p, alert, first, last, contacts)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(in) :: history !! with the face that was found, in the plane
    integer, intent(in) :: p !! pair
    real(wp), intent(in) :: alert !! alert distance of the pair [m]
    integer, intent(in) :: first, last !! the first and the last contact of the pair
    type(contacts_t), intent(inout) :: contacts !! contacts of the step so far
    real(wp) :: offset(3), pose(n_pose_in_space)
    integer(i1) :: face
    integer :: k

    offset = offset_of(scene, pairs, p)
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      if (scene%dimension == 2) pose(:n_pose_in_plane) = pose_in_plane(contactors, c, a, offset(:2))
      if (scene%dimension == 3) pose = pose_in_space(contactors, turn_of(scene, c), turn_of(scene, a), c, a, offset)
      do k = first, last
        associate (normal => contacts%normal(:, k), point => contacts%point(:, k), gap => contacts%gap(k), &
                   kept => contacts%kept(:, k))
          if (scene%dimension == 2) then
            face = merge(face_of_candidate, face_of_antagonist, history%face(1, p) < 0)
            call keep_in_plane(contactors, a, offset(:2), face, pose, normal, point, gap, alert, kept)
          else
            ! Points of one face have one normal.
            if (any(abs(normal - contacts%normal(:, max(first, k - 1))) > 0) .or. k == first) &
              face = face_of(contactors, c, a, normal)
            call keep_in_space(contactors, a, offset, turn_of(scene, a), face, pose, normal, point, gap, alert, kept)
          end if
          contacts%is_kept(k) = 1_i1
        end associate
      end do
    end associate
  end subroutine keep_pair

  !> Motion of two shapes against each other up to which their contacts are kept [m]; zero where the narrow phase measures them.
  pure real(wp) function kept_length(scene, c, a)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist

    kept_length = 0
    if (follows(scene%contactors%kind(c))) &
      kept_length = scene%kept_motion*min(scene%contactors%reach(c), scene%contactors%reach(a))
  end function kept_length

  !> Orientation of the body that carries a contactor of space.
  pure function turn_of(scene, c) result(turn)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    integer(i4), intent(in) :: c !! contactor
    real(wp) :: turn(4)

    turn = no_rotation
    if (size(scene%bodies%middle, 1) == 7) turn = scene%bodies%middle(4:7, scene%contactors%body(c))
  end function turn_of

  !> Law of a pair that is no link.
  pure integer(i4) function law_of(scene, pairs, p)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    integer, intent(in) :: p !! pair

    law_of = int(scene%sees(pairs%see(p))%law, i4)
  end function law_of
end module sg_add_contacts
