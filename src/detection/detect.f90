!> Detection: from the configuration of a step to its contacts, with the impulses of the last step as a guess.
module sg_detect
  use sg_add_contacts, only: add_contacts
  use sg_contactors, only: kind_polygon, kind_polyhedron
  use sg_contacts, only: contacts_t, drop_contacts, grow_contacts
  use sg_history, only: exchange_kept, fold_images, history_t, keep_contacts, keep_faces, keep_pairs, match_pairs, &
                        unwrap_images
  use sg_internal_values, only: n_internal_of
  use sg_kinds, only: wp, i4
  use sg_laws, only: law_bond, status_broken
  use sg_link_laws, only: holds_across, is_torn, pulls_only
  use sg_list_margins, only: choose_margins, fitting_skin, neighbours_are_stale
  use sg_neighbour_list, only: neighbours_t, offset_of
  use sg_neighbours, only: build_neighbours
  use sg_polygon_pairs, only: are_mostly_kept, are_plain_polygons
  use sg_scene, only: scene_t
  use sg_sees, only: alert_of
  use sg_touch_link, only: touch_link
  use sg_touch_pieces, only: place_pieces, touch_pieces
  use sg_touch_run, only: begin_runs, ends_early, runs_t
  implicit none
  private
  public :: detect, turn_link

contains

  !> Find the contacts of a step in the configuration `bodies%middle`.
  subroutine detect(scene, pairs, history, contacts)
    type(scene_t), intent(inout) :: scene !! scene; bodies that left the period come back into it
    type(neighbours_t), intent(inout) :: pairs !! pairs that may touch, rebuilt when stale
    type(history_t), intent(inout) :: history !! contacts of the last detection
    type(contacts_t), intent(inout) :: contacts !! contacts of the last step, replaced by those of this one; none where memory or
    !! time ran short, as `pairs` and `contacts` report
    real(wp) :: skin
    real(wp), allocatable :: margin(:)
    integer(i4) :: folds
    logical :: corners_wait

    if (.not. history%is_loaded) then
      call keep_contacts(history, contacts)
      call exchange_kept(history, contacts)
    end if
    history%is_matched = .false.
    if (neighbours_are_stale(pairs, scene)) then
      if (.not. history%is_loaded .and. allocated(pairs%contactor)) call keep_pairs(history, pairs)
      call unwrap_images(history, scene)
      skin = pairs%asked_skin
      if (.not. skin > 0) skin = fitting_skin(scene, pairs%substeps, has_copies=.false.)
      call choose_margins(scene, pairs, skin, margin)
      folds = scene%cell%folds
      call build_neighbours(pairs, scene, scene%bodies%middle, margin)
      call fold_images(history, scene%cell%folds - folds)
      call match_pairs(history, scene, pairs)
    else if (history%is_loaded) then
      call unwrap_images(history, scene)
      call match_pairs(history, scene, pairs)
    end if
    ! Where most pairs are measured, corners of all polygons are placed in one pass.
    corners_wait = pairs%corners_wait .and. are_plain_polygons(scene, history, contacts)
    if (corners_wait) corners_wait = are_mostly_kept(history)
    call place_pieces(scene%contactors, scene%bodies%middle, corners_wait)
    if (.not. allocated(pairs%alert)) allocate (pairs%alert(size(scene%sees)))
    pairs%alert(:) = alert_of(scene%sees, pairs%way)
    if (scene%cell%is_on) contacts%upwards = scene%cell%middle([4, 2])
    call touch_all(scene, pairs, history, corners_wait, contacts)
    history%is_loaded = .false.
    history%is_start = .false.
    history%is_untouched = history%is_untouched .and. contacts%n == 0
  end subroutine detect

  !> Narrow phase over all pairs.
  subroutine touch_all(scene, pairs, history, corners_wait, contacts)
    type(scene_t), intent(inout) :: scene
    type(neighbours_t), intent(inout) :: pairs
    type(history_t), intent(inout) :: history
    logical, intent(in) :: corners_wait !! do corners of polygons wait until a pair needs them?
    type(contacts_t), intent(inout) :: contacts
    integer(i4), allocatable :: first(:)
    type(runs_t) :: runs
    logical :: is_late
    integer :: p

    ! About half of the neighbours touch; more room is made when it is wanted.
    contacts%is_cut = .false.
    call grow_contacts(contacts, max(contacts%n, pairs%n/2, 1))
    if (contacts%is_cut) call grow_contacts(contacts, max(contacts%n, 1))
    contacts%n = 0
    allocate (first(pairs%n + 1))
    if (sum(scene%contactors%n_rows([kind_polygon, kind_polyhedron])) > 0) &
      call keep_faces(history, pairs%n_near, scene%dimension - 1)
    call begin_runs(scene, pairs, history, contacts, corners_wait, runs)
    call touch_pieces(scene, pairs, history, runs, contacts, first)
    is_late = pairs%is_late
    do p = pairs%n_near + 1, pairs%n
      if (ends_early(pairs, contacts, p, is_late)) exit
      first(p) = int(contacts%n, i4) + 1
      call follow_link(scene, pairs, history, p, contacts)
    end do
    pairs%is_late = is_late
    if (contacts%is_cut .or. is_late) then
      call drop_contacts(contacts)
      first = 1
    end if
    first(pairs%n + 1) = int(contacts%n, i4) + 1
    call move_alloc(history%first, history%first_before)
    history%n_before = history%n_pairs
    call move_alloc(first, history%first)
    history%n_pairs = pairs%n
  end subroutine touch_all

  !> The contact of a link, which is there at any distance.
  subroutine follow_link(scene, pairs, history, p, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: offset(3), normal(scene%dimension), point(scene%dimension), length
    integer :: l

    l = pairs%link(p - pairs%n_near)
    offset = offset_of(scene, pairs, p)
    associate (centre => scene%contactors%centre, law => scene%laws(scene%links%law(l)))
      call touch_link(centre(:, pairs%contactor(1, p)), centre(:, pairs%contactor(2, p)) + offset(:scene%dimension), &
                      scene%links%length(l), pulls_only(law), normal, point, length)
    end associate
    call add_contacts(scene, pairs, history, p, scene%links%law(l), 1, normal, point, [length], [int(l, i4)], contacts)
    if (.not. contacts%is_cut) call turn_link(scene, contacts, contacts%n)
  end subroutine follow_link

  !> Turn the guess of a link whose ends have moved with it: that of a link which carries nothing across is the force along it. A
  !! bond that its ends have torn is broken.
  pure subroutine turn_link(scene, contacts, k)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(inout) :: contacts !! contacts, the link measured where its ends are now
    integer, intent(in) :: k !! contact, a link

    associate (normal => contacts%normal(:, k), impulse => contacts%impulse(:, k))
      if (contacts%n_components == 3 .and. .not. holds_across(scene%laws(contacts%law(k)))) &
        impulse = dot_product(impulse, normal)*normal
    end associate
    if (is_broken(scene, contacts, k, int(contacts%feature(k)))) contacts%status(k) = status_broken
  end subroutine turn_link

  !> Is a bond broken by where its ends are?
  pure logical function is_broken(scene, contacts, k, l)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k, l !! contact and link
    real(wp) :: across(4)
    integer :: n

    is_broken = .false.
    if (scene%laws(contacts%law(k))%kind /= law_bond) return
    n = n_internal_of(scene%laws(contacts%law(k)), scene%dimension)
    across(:n) = contacts%internal(:n, k)
    ! In space the displacement counts across the bond as it lies now.
    if (n == 4) across(2:4) = across(2:4) - dot_product(across(2:4), contacts%normal(:, k))*contacts%normal(:, k)
    associate (links => scene%links)
      is_broken = is_torn(scene%laws(contacts%law(k)), contacts%gap(k), links%length(l), [links%area(l), links%mass(l)], across(:n))
    end associate
  end function is_broken
end module sg_detect
