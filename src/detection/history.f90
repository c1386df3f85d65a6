!> Impulses carried from one detection to the next, found again by pair of contactors and feature.
!!
!! Contacts of one pair stand together, in the order of pairs. As long as the list of neighbours is the same, pair p
!! finds its past at p; when the list is rebuilt, pairs are matched once through the candidate's short list.
module sg_history
  use sg_contacts, only: contacts_t, image_of, reserve_contacts
  use sg_internal_values, only: not_recorded
  use sg_kinds, only: wp, i1, i4, i8
  use sg_lists, only: reserve
  use sg_near, only: candidate_first, has_one_image
  use sg_neighbour_list, only: image_of_pair, neighbours_t
  use sg_scene, only: periods_of, scene_t, start_contact_t
  use sg_sorting, only: group_items, sort_permutation
  implicit none
  private
  public :: history_t, start_history, resume_history, keep_contacts, keep_pairs, unwrap_images, fold_images, match_pairs, &
            revive
  public :: carried_of, exchange_kept, keep_faces, past_pair, recall

  !> Contacts of the last detection, as much as the next one needs
  type :: history_t
    !> Number of pairs, with or without contacts
    integer :: n_pairs = 0
    !> Contactors of each pair, shape (2, n_pairs); set when the list of neighbours is about to change
    integer(i4), allocatable :: contactor(:, :)
    !> Periods by which the antagonist of each pair is moved along x and y, and along z in a periodic cell of space, shape
    !! (2 or 3, n_pairs); set with `contactor`
    integer(i4), allocatable :: image(:, :)
    !> Contacts of pair p are `first(p)` to `first(p + 1) - 1`
    integer(i4), allocatable :: first(:)
    !> The same of the detection before, to which the features, impulses and statuses below belong once a new one is done
    integer :: n_before = 0
    integer(i4), allocatable :: first_before(:)
    !> Feature, impulse, status of each contact; point in the candidate's period, for contacts read from a deck
    integer(i4), allocatable :: feature(:)
    real(wp), allocatable :: impulse(:, :), point(:, :)
    integer(i1), allocatable :: status(:)
    !> Internal values of each contact, shape (n_internal, contacts)
    real(wp), allocatable :: internal(:, :)
    !> Values of each contact that the solver's method carries, shape (n_carried, contacts)
    real(wp), allocatable :: carried(:, :)
    !> Does detection keep something of each contact (sg_kept_contacts)? What it keeps, shape (n_kept, contacts)
    integer(i1), allocatable :: is_kept(:)
    real(wp), allocatable :: kept(:, :)
    !> Past pair of each present one, 0 where there is none; unused while the list of neighbours stays
    integer(i4), allocatable :: past(:)
    !> What the narrow phase tries first of each present pair: in the plane a face (`touch_convex`), in space features of both
    !! (`feature_of`), shape (1 or 2, pairs near each other); no point depends on it
    integer(i4), allocatable :: face(:, :)
    !> Least distance of each pair found apart, plus the paths of its shapes (sg_path_bound) at that time [m]; of pairs found so in
    !! this list of neighbours
    real(wp), allocatable :: clearance(:)
    !> Contacts of the pieces of a list that threads share, before they are put together (sg_touch_pieces)
    type(contacts_t), allocatable :: found(:)
    !> Must pairs be matched, because the list of neighbours is another one?
    logical :: is_matched = .false.
    !> Were the contacts read from a deck or a restart file? Then `contactor` is set and `keep_contacts` is not due
    logical :: is_loaded = .false.
    !> Contacts read from a deck carry no feature: they are found by their points
    logical :: by_point = .false.
    !> Has nothing been detected yet, not even before a restart?
    logical :: is_start = .true.
    !> Has no step had a contact yet, on any rank, not even before a restart?
    logical :: is_untouched = .true.
  end type history_t

contains

  !> Take the contacts known at the start of a scene for the past.
  subroutine start_history(history, scene, time_step, n_components, n_internal)
    type(history_t), intent(inout) :: history !! past to fill
    type(scene_t), intent(in) :: scene !! scene with its contacts at the start
    real(wp), intent(in) :: time_step !! time step, turns forces into impulses [s]
    integer, intent(in) :: n_components !! components of an impulse
    integer, intent(in) :: n_internal !! internal values of a contact
    type(contacts_t) :: contacts
    integer(i4), allocatable :: order(:)
    integer :: k

    if (.not. allocated(scene%start_contacts)) return
    contacts%n = size(scene%start_contacts)
    if (contacts%n == 0) return
    contacts%dimension = scene%dimension
    contacts%n_components = n_components
    contacts%n_internal = n_internal
    call reserve_contacts(contacts, contacts%n)
    order = start_order(scene)
    do k = 1, contacts%n
      associate (known => scene%start_contacts(order(k)))
        contacts%contactor(:, k) = oriented(scene, known%contactor)
        contacts%point(:, k) = known%point(:contacts%dimension)
        contacts%impulse(:, k) = time_step*force_of(known, contacts%contactor(:, k), n_components)
        contacts%status(k) = known%status
        contacts%internal(:, k) = known%internal(:n_internal)
        if (n_internal > 0 .and. .not. known%has_internal) contacts%internal(1, k) = not_recorded
      end associate
    end do
    call load(history, contacts)
    history%by_point = .true.
    history%point = contacts%point(:, :contacts%n)
  end subroutine start_history

  !> Known force of a contact [N], on its candidate.
  pure function force_of(known, contactor, n_components) result(force)
    type(start_contact_t), intent(in) :: known
    integer(i4), intent(in) :: contactor(2)
    integer, intent(in) :: n_components
    real(wp) :: force(n_components)

    select case (n_components)
    case (3)
      force = known%force
      if (contactor(1) /= known%contactor(1)) force = -known%force
    case (2)
      force = known%force(:2)
    case default
      ! Normal and tangential in the plane; in space the whole vector is normal where nothing rubs.
      force = known%force(1)
      if (known%is_vector) force = norm2(known%force)
    end select
  end function force_of

  !> Order that brings the contacts of each pair together.
  function start_order(scene) result(order)
    type(scene_t), intent(in) :: scene
    integer(i4), allocatable :: order(:)
    integer(i8), allocatable :: keys(:)
    integer(i4) :: pair(2)
    integer :: k

    allocate (keys(size(scene%start_contacts)))
    do k = 1, size(keys)
      pair = oriented(scene, scene%start_contacts(k)%contactor)
      keys(k) = int(pair(1), i8)*int(scene%contactors%n + 1, i8) + int(pair(2), i8)
    end do
    order = sort_permutation(keys)
  end function start_order

  !> A pair with its candidate first; turning it round changes neither component of a planar impulse.
  pure function oriented(scene, contactor)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: contactor(2)
    integer(i4) :: oriented(2)

    oriented = int(contactor, i4)
    if (.not. candidate_first(scene%contactors, contactor(1), contactor(2))) oriented = oriented([2, 1])
  end function oriented

  !> Take the contacts of a restart file for the past.
  subroutine resume_history(history, contacts)
    type(history_t), intent(inout) :: history !! past to fill
    type(contacts_t), intent(in) :: contacts !! contacts of the step before the restart

    call load(history, contacts)
    history%is_start = .false.
  end subroutine resume_history

  !> Take contacts that stand pair by pair, finding the pairs from them.
  subroutine load(history, contacts)
    type(history_t), intent(inout) :: history
    type(contacts_t), intent(in) :: contacts
    integer(i4) :: image(3), last(3)
    integer :: k
    logical :: is_new

    history%n_pairs = 0
    ! Pairs and contactors may be others now.
    if (allocated(history%face)) deallocate (history%face, history%clearance)
    call keep_contacts(history, contacts)
    if (allocated(history%kept)) deallocate (history%is_kept, history%kept)
    if (contacts%n_kept > 0) then
      history%is_kept = contacts%is_kept(:contacts%n)
      history%kept = contacts%kept(:, :contacts%n)
    end if
    call reserve(history%first, contacts%n + 1)
    call reserve(history%contactor, 2, contacts%n)
    if (allocated(history%image)) deallocate (history%image)
    call reserve(history%image, merge(3, 2, allocated(contacts%image_z)), contacts%n)
    last = 0
    do k = 1, contacts%n
      image = int(image_of(contacts, k), i4)
      is_new = k == 1
      if (.not. is_new) is_new = any(contacts%contactor(:, k) /= contacts%contactor(:, k - 1)) .or. any(image /= last)
      last = image
      if (.not. is_new) cycle
      history%n_pairs = history%n_pairs + 1
      history%contactor(:, history%n_pairs) = contacts%contactor(:, k)
      history%image(:, history%n_pairs) = image(:size(history%image, 1))
      history%first(history%n_pairs) = int(k, i4)
    end do
    history%first(history%n_pairs + 1) = int(contacts%n, i4) + 1
    history%is_loaded = .true.
  end subroutine load

  !> Note impulses, features and statuses of the last detection; `first` was set by it.
  subroutine keep_contacts(history, contacts)
    type(history_t), intent(inout) :: history !! past to fill
    type(contacts_t), intent(in) :: contacts !! contacts to note
    integer :: n

    n = contacts%n
    history%by_point = .false.
    call reserve(history%feature, n)
    call reserve(history%status, n)
    call reserve(history%impulse, contacts%n_components, n)
    call reserve(history%internal, contacts%n_internal, n)
    if (allocated(history%carried)) deallocate (history%carried)
    if (contacts%n_carried > 0) history%carried = contacts%carried(:, :n)
    if (n == 0) return
    history%feature(:n) = contacts%feature(:n)
    history%status(:n) = contacts%status(:n)
    history%impulse(:, :n) = contacts%impulse(:, :n)
    if (contacts%n_internal > 0) history%internal(:, :n) = contacts%internal(:, :n)
  end subroutine keep_contacts

  !> Take what was kept of the contacts of the last detection, and give them the room of the ones before.
  subroutine exchange_kept(history, contacts)
    type(history_t), intent(inout) :: history !! past to fill
    type(contacts_t), intent(inout) :: contacts !! contacts of the last detection; what is kept of them must be set again
    real(wp), allocatable :: spare(:, :)
    integer(i1), allocatable :: flags(:)

    if (contacts%n_kept == 0 .or. .not. allocated(contacts%kept)) return
    call move_alloc(history%kept, spare)
    call move_alloc(history%is_kept, flags)
    call move_alloc(contacts%kept, history%kept)
    call move_alloc(contacts%is_kept, history%is_kept)
    if (allocated(spare)) then
      if (any(shape(spare) /= shape(history%kept))) deallocate (spare, flags)
    end if
    if (.not. allocated(spare)) then
      allocate (spare(size(history%kept, 1), size(history%kept, 2)), source=0.0_wp)
      allocate (flags(size(history%kept, 2)), source=0_i1)
    end if
    call move_alloc(spare, contacts%kept)
    call move_alloc(flags, contacts%is_kept)
  end subroutine exchange_kept

  !> Note the pairs of the last detection, before their list is rebuilt.
  subroutine keep_pairs(history, pairs)
    type(history_t), intent(inout) :: history !! past to fill
    type(neighbours_t), intent(in) :: pairs !! list to note

    if (allocated(history%contactor)) deallocate (history%contactor)
    if (allocated(history%image)) deallocate (history%image)
    allocate (history%contactor(2, pairs%n))
    history%contactor(:, :) = pairs%contactor(:, :pairs%n)
    allocate (history%image(merge(3, 2, allocated(pairs%image_z)), pairs%n), source=0_i4)
    history%image(1, :) = int(pairs%image(:pairs%n), i4)
    if (allocated(pairs%image_y)) history%image(2, :) = int(pairs%image_y(:pairs%n), i4)
    if (allocated(pairs%image_z)) history%image(3, :) = int(pairs%image_z(:pairs%n), i4)
  end subroutine keep_pairs

  !> Count the images of past pairs from where their bodies would be had none ever come back into the period: a new list may
  !! bring some back, and images change with them.
  subroutine unwrap_images(history, scene)
    type(history_t), intent(inout) :: history !! past; its images change
    type(scene_t), intent(in) :: scene !! scene before the new list
    integer(i4) :: crossed(3)
    integer :: p

    if (history%n_pairs == 0 .or. .not. maxval(periods_of(scene)) > 0) return
    do p = 1, history%n_pairs
      crossed = crossed_between(scene, history%contactor(:, p))
      history%image(:, p) = history%image(:, p) + crossed(:size(history%image, 1))
    end do
  end subroutine unwrap_images

  !> Renumber the images of past pairs where the tilt of a periodic cell was folded back.
  pure subroutine fold_images(history, folds)
    type(history_t), intent(inout) :: history !! past, its images unwrapped
    integer(i4), intent(in) :: folds !! whole lengths along x taken from the tilt

    if (folds == 0 .or. history%n_pairs == 0) return
    associate (image => history%image(:, :history%n_pairs))
      image(1, :) = image(1, :) + folds*image(2, :)
    end associate
  end subroutine fold_images

  !> Periods that the candidate has crossed more than the antagonist: what a pair's image counts from.
  !!
  !! Let x be a place within the period and X = x + crossings L the unwrapped one. An antagonist that is moved by `image` periods is
  !! x_a + image L - x_c = X_a - X_c + (image + crossings_c - crossings_a) L away from its candidate. Wrapping changes none of X, so
  !! it does not change the sum in brackets.
  pure function crossed_between(scene, contactor) result(crossed)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: contactor(2)
    integer(i4) :: crossed(3)

    associate (c => scene%contactors%body(contactor(1)), a => scene%contactors%body(contactor(2)))
      crossed = scene%bodies%crossings(c) - scene%bodies%crossings(a)
      crossed(2:) = 0
      if (allocated(scene%bodies%crossings_y)) crossed(2) = scene%bodies%crossings_y(c) - scene%bodies%crossings_y(a)
      if (allocated(scene%bodies%crossings_z)) crossed(3) = scene%bodies%crossings_z(c) - scene%bodies%crossings_z(a)
    end associate
  end function crossed_between

  !> Find the past of every pair of a new list of neighbours, image by image. Where one image of a wall alone is seen, the
  !! nearest, it may be another one now; contacts of a deck name no image.
  subroutine match_pairs(history, scene, pairs)
    type(history_t), intent(inout) :: history !! past, its images unwrapped; `past` is set
    type(scene_t), intent(in) :: scene !! scene after the new list
    type(neighbours_t), intent(in) :: pairs !! the new list
    integer(i4), allocatable :: first(:), member(:)
    integer(i4) :: image(3)
    logical :: is_single(3)
    integer :: p, m, rows

    call list_by_candidate(history, scene%contactors%n, first, member)
    call reserve(history%past, pairs%n)
    do p = 1, pairs%n
      history%past(p) = 0
      image = int(image_of_pair(pairs, p), i4) + crossed_between(scene, pairs%contactor(:, p))
      do m = first(pairs%contactor(1, p)), first(pairs%contactor(1, p) + 1) - 1
        if (history%contactor(2, member(m)) /= pairs%contactor(2, p)) cycle
        rows = size(history%image, 1)
        if (any(history%image(:, member(m)) /= image(:rows))) then
          is_single = history%by_point
          is_single(:2) = is_single(:2) .or. has_one_image(scene%contactors, pairs%contactor(2, p), [scene%period, scene%period_y])
          if (.not. all(is_single(:rows) .or. history%image(:, member(m)) == image(:rows))) cycle
        end if
        history%past(p) = member(m)
        exit
      end do
    end do
    history%is_matched = .true.
  end subroutine match_pairs

  !> Past pairs with contacts of each candidate: those of c are `member(first(c))` to `member(first(c + 1) - 1)`.
  subroutine list_by_candidate(history, n_contactors, first, member)
    type(history_t), intent(in) :: history
    integer, intent(in) :: n_contactors
    integer(i4), allocatable, intent(out) :: first(:), member(:)
    integer(i4), allocatable :: candidate(:)
    integer :: p

    candidate = [(merge(history%contactor(1, p), 0_i4, history%first(p + 1) > history%first(p)), p=1, history%n_pairs)]
    call group_items(candidate, n_contactors, first, member)
  end subroutine list_by_candidate

  !> Give each pair of a new list of neighbours the faces or edges that were kept of it, none where it is new; clearances are found
  !! again.
  pure subroutine keep_faces(history, n, n_faces)
    type(history_t), intent(inout) :: history !! past; `face` and `clearance` are set
    integer, intent(in) :: n !! present pairs that may have faces
    integer, intent(in) :: n_faces !! numbers that name what is kept of a pair
    integer(i4), allocatable :: face(:, :)
    integer :: p, past

    if (allocated(history%face)) then
      if (size(history%clearance) == n .and. .not. history%is_matched) return
    else
      allocate (history%face(n_faces, 0), history%clearance(0))
    end if
    allocate (face(n_faces, n), source=0_i4)
    do p = 1, n
      past = past_pair(history, p)
      if (past > 0 .and. past <= size(history%clearance)) face(:, p) = history%face(:, past)
    end do
    call move_alloc(face, history%face)
    deallocate (history%clearance)
    allocate (history%clearance(n), source=-huge(1.0_wp))
  end subroutine keep_faces

  !> Pair of the last detection that a present pair is; 0 where it is new.
  pure integer function past_pair(history, pair)
    type(history_t), intent(in) :: history !! past
    integer, intent(in) :: pair !! present neighbour pair

    past_pair = 0
    if (history%n_pairs == 0) return
    past_pair = pair
    if (history%is_matched) past_pair = history%past(pair)
  end function past_pair

  !> Contact of the past that a contact of now goes on from; 0 when it is new.
  pure integer function recall(history, pair, feature, point) result(best)
    type(history_t), intent(in) :: history !! past
    integer, intent(in) :: pair !! present neighbour pair
    integer(i4), intent(in) :: feature !! feature of the contact
    real(wp), intent(in) :: point(:) !! its point [m]
    integer :: k, past
    real(wp) :: nearest, distance

    best = 0
    past = past_pair(history, pair)
    if (past == 0) return
    nearest = huge(1.0_wp)
    do k = history%first(past), history%first(past + 1) - 1
      if (history%by_point) then
        distance = norm2(history%point(:, k) - point)
        if (distance >= nearest) cycle
        nearest = distance
        best = k
      else if (history%feature(k) == feature) then
        best = k
      end if
    end do
  end function recall

  !> Values that the solver's method carries of a contact of the past; zero where there is none, or another method carried others.
  pure function carried_of(history, past, n) result(carried)
    type(history_t), intent(in) :: history !! past
    integer, intent(in) :: past !! contact of the past, 0 for a new one
    integer, intent(in) :: n !! values of a contact
    real(wp) :: carried(n)

    carried = 0
    if (past == 0 .or. .not. allocated(history%carried)) return
    if (size(history%carried, 1) == n) carried = history%carried(:, past)
  end function carried_of

  !> What is kept of a contact of the past; nothing where nothing fits.
  pure subroutine recall_kept(history, past, is_kept, kept)
    type(history_t), intent(in) :: history
    integer, intent(in) :: past
    integer(i1), intent(out) :: is_kept
    real(wp), intent(out) :: kept(:)

    is_kept = 0_i1
    kept = 0
    if (.not. allocated(history%kept)) return
    if (size(history%kept, 1) /= size(kept) .or. size(history%kept, 2) < past) return
    is_kept = history%is_kept(past)
    if (is_kept > 0_i1) kept = history%kept(:, past)
  end subroutine recall_kept

  !> Bring the past back as contacts, when the step after it failed: what a restart needs of them.
  subroutine revive(history, pairs, contacts)
    type(history_t), intent(in) :: history !! past
    type(neighbours_t), intent(in) :: pairs !! present list of neighbours
    type(contacts_t), intent(inout) :: contacts !! contacts to replace
    integer :: p, k

    contacts%n = 0
    if (history%n_before == 0 .or. history%by_point) return
    contacts%n = history%first_before(history%n_before + 1) - 1
    call reserve_contacts(contacts, contacts%n)
    do p = 1, history%n_before
      do k = history%first_before(p), history%first_before(p + 1) - 1
        contacts%contactor(:, k) = pair_of(p)
        contacts%feature(k) = history%feature(k)
        contacts%impulse(:, k) = history%impulse(:, k)
        contacts%status(k) = history%status(k)
        if (contacts%n_internal > 0) contacts%internal(:, k) = history%internal(:, k)
        if (contacts%n_carried > 0) contacts%carried(:, k) = carried_of(history, k, contacts%n_carried)
        if (contacts%n_kept > 0) call recall_kept(history, k, contacts%is_kept(k), contacts%kept(:, k))
        contacts%image(k) = 0
        if (contacts%dimension == 3) contacts%image_y(k) = 0
        contacts%law(k) = 1
      end do
    end do
  contains
    pure function pair_of(p) result(pair)
      integer, intent(in) :: p
      integer(i4) :: pair(2)

      if (history%is_matched) then
        pair = history%contactor(:, p)
      else
        pair = pairs%contactor(:, p)
      end if
    end function pair_of
  end subroutine revive
end module sg_history
