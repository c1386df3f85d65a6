!> Shapes that overlap at the start: neighbours whose narrow phase finds a negative gap.
module sg_start_overlaps
  use sg_blocks, only: deck_t
  use sg_bodies, only: is_absent
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_named_bodies, only: name_of
  use sg_near, only: candidate_first
  use sg_neighbour_list, only: image_of_pair, neighbours_t
  use sg_neighbours, only: find_neighbours
  use sg_owners, only: contact_owner
  use sg_pair_gap, only: pair_gap
  use sg_passages, only: due_time
  use sg_scene, only: scene_t
  use sg_sees, only: see_between
  use sg_shape_kinds, only: is_hollow
  use sg_text, only: to_text
  implicit none
  private
  public :: overlaps_t, most_pairs, find_overlaps, add_overlap, report_overlaps

  !> Share of the smaller radius by which two bodies may overlap at the start
  real(wp), parameter :: tolerated = 0.1_wp
  !> Overlaps below this share come from the digits that decks write
  real(wp), parameter :: rounding = 1e-4_wp
  !> Grains of rains that are held against walls
  integer, parameter :: most_of_rain = 1000
  !> Pairs that are named
  integer, parameter :: most_pairs = 5
  !> Moment before all entries
  real(wp), parameter :: at_start = -huge(1.0_wp)

  !> Pairs of bodies that overlap
  type :: overlaps_t
    !> How many
    integer :: n = 0
    !> The deepest ones for their size, deepest first: numbers of the bodies in the whole scene, depth [m], and depth over the
    !! smaller radius, 0 where there is no pair
    integer :: pair(2, most_pairs) = 0
    real(wp) :: depth(most_pairs) = 0, share(most_pairs) = 0
    !> Number up to which pairs of bodies are not looked at: those of a DATBOX may overlap
    integer :: passed_over = 0
    !> When the bodies of these pairs enter [s]; hugely early for those that are there at the start
    real(wp) :: moment = at_start
  end type overlaps_t

contains

  !> Find the pairs of bodies whose shapes overlap, of those that a rank owns. Where bodies that enter with a later stage are
  !! sought, others are left out: they have moved by then.
  subroutine find_overlaps(scene, rank, deck, found)
    type(scene_t), intent(inout) :: scene !! whole scene, or the part of a rank with copies; its contactors are placed
    integer, intent(in) :: rank !! where ranks share the scene: this rank
    type(deck_t), intent(in) :: deck !! deck of the run, or of one of its stages
    type(overlaps_t), intent(inout) :: found !! pairs found
    type(neighbours_t) :: pairs
    integer(i4) :: image(3)
    integer :: p, n

    if (size(scene%sees) == 0) return
    if (deck%stage_number > 1) then
      if (.not. allocated(scene%entries)) return
      found%moment = deck%stage_time
    end if
    found%passed_over = deck%folder_bodies
    n = scene%dimension
    associate (bodies => scene%bodies)
      bodies%middle(:n, :) = bodies%position
      if (n == 2) bodies%middle(3, :) = bodies%angle
      if (n == 3) bodies%middle(4:7, :) = bodies%orientation
      pairs%built = bodies%middle
      allocate (pairs%margin(bodies%n), source=0.0_wp)
    end associate
    pairs%rank = rank
    pairs%without_alert = .true.
    call find_neighbours(pairs, scene)
    do p = 1, pairs%n
      image = int(image_of_pair(pairs, p), i4)
      associate (pair => pairs%contactor(:, p))
        if (.not. is_hollow(scene%contactors%kind(pair(2)))) call weigh_pair(scene, pair, image, found)
      end associate
    end do
    call weigh_hollows(scene, rank, found)
    if (allocated(scene%entries)) call weigh_rains(scene, rank, found)
  end subroutine find_overlaps

  !> Hold grains of rains against walls, in which they would enter: some of them, since all enter in the same window.
  subroutine weigh_rains(scene, rank, found)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank
    type(overlaps_t), intent(inout) :: found
    integer :: c, w, weighed

    weighed = 0
    associate (contactors => scene%contactors, bodies => scene%bodies)
      do c = 1, contactors%n
        if (.not. waits_for_place(scene, int(contactors%body(c)))) cycle
        weighed = weighed + 1
        if (weighed > most_of_rain) exit
        do w = 1, contactors%n
          if (bodies%is_grain(contactors%body(w)) .or. is_absent(bodies, int(contactors%body(w))) .or. &
              is_hollow(contactors%kind(w)) .or. see_between(scene, c, w) == 0) cycle
          call weigh_against_wall(scene, rank, c, w, found)
        end do
      end do
    end associate
  end subroutine weigh_rains

  !> Is a body a grain of a rain?
  pure logical function waits_for_place(scene, body)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body
    integer :: number

    number = body
    if (allocated(scene%bodies%id)) number = scene%bodies%id(body)
    waits_for_place = any(scene%entries%waits .and. scene%entries%first <= number .and. number <= scene%entries%last)
  end function waits_for_place

  !> Note a grain that overlaps a wall, or the nearest image of it.
  subroutine weigh_against_wall(scene, rank, grain, wall, found)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank, grain, wall
    type(overlaps_t), intent(inout) :: found
    real(wp) :: period(2)
    integer(i4) :: image(2), pair(2)

    pair = int([grain, wall], i4)
    if (allocated(scene%bodies%owner)) then
      if (contact_owner(scene%bodies%owner(scene%contactors%body(pair))) /= rank) return
    end if
    period = [scene%period, scene%period_y]
    image = 0
    where (period > 0) image = nint((scene%contactors%centre(:2, grain) - scene%contactors%centre(:2, wall))/period, i4)
    if (.not. candidate_first(scene%contactors, grain, wall)) then
      pair = pair([2, 1])
      image = -image
    end if
    call weigh_pair(scene, pair, image, found)
  end subroutine weigh_against_wall

  !> Hold hollow shapes against all others: a grain outside of one is drawn in as soon as detection finds it, which looks
  !! two cells far.
  subroutine weigh_hollows(scene, rank, found)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank
    type(overlaps_t), intent(inout) :: found
    real(wp) :: apart(scene%dimension), period(2)
    integer(i4) :: image(2), pair(2)
    integer :: hollow, c

    period = [scene%period, scene%period_y]
    associate (contactors => scene%contactors)
      do hollow = 1, contactors%n
        if (.not. is_hollow(contactors%kind(hollow))) cycle
        do c = 1, contactors%n
          pair = int([c, hollow], i4)
          if (see_between(scene, c, hollow) == 0) cycle
          if (allocated(scene%bodies%owner)) then
            if (contact_owner(scene%bodies%owner(contactors%body(pair))) /= rank) cycle
          end if
          apart = contactors%centre(:, c) - contactors%centre(:, hollow)
          image = 0
          where (period > 0) image = nint(apart(:2)/period, i4)
          where (period > 0) apart(:2) = apart(:2) - period*real(image, wp)
          if (all(abs(apart) <= 4*maxval(contactors%reach(pair)))) call weigh_pair(scene, pair, image, found)
        end do
      end do
    end associate
  end subroutine weigh_hollows

  !> Note a pair that overlaps by more than rounding, if at least one of the two is a grain.
  subroutine weigh_pair(scene, pair, image, found)
    type(scene_t), intent(in) :: scene !! the scene, its contactors placed
    integer(i4), intent(in) :: pair(2) !! candidate and antagonist
    integer(i4), intent(in) :: image(:) !! periods by which the antagonist is moved
    type(overlaps_t), intent(inout) :: found !! list to add to
    real(wp) :: radius, depth
    integer :: b(2)

    b = scene%contactors%body(pair)
    if (b(1) == b(2) .or. .not. any(scene%bodies%is_grain(b))) return
    if (found%moment > at_start) then
      if (.not. (enters(scene, b(1), found%moment) .and. enters(scene, b(2), found%moment))) return
    end if
    radius = minval(scene%contactors%reach(pair), scene%bodies%is_grain(b))
    if (allocated(scene%bodies%id)) b = scene%bodies%id(b)
    if (all(b <= found%passed_over)) return
    depth = -pair_gap(scene, pair, image)
    if (depth <= rounding*radius) return
    found%n = found%n + 1
    call add_overlap(found, b, depth, depth/radius)
  end subroutine weigh_pair

  !> Does a body enter at a moment?
  pure logical function enters(scene, body, moment)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body
    real(wp), intent(in) :: moment
    integer :: number

    number = body
    if (allocated(scene%bodies%id)) number = scene%bodies%id(body)
    enters = any(abs(due_time(scene%entries, number) - moment) <= 0)
  end function enters

  !> Put a pair among the deepest ones, if it is one of these.
  pure subroutine add_overlap(found, pair, depth, share)
    type(overlaps_t), intent(inout) :: found !! list to add to
    integer, intent(in) :: pair(2) !! numbers of the bodies in the whole scene
    real(wp), intent(in) :: depth !! of the overlap [m]
    real(wp), intent(in) :: share !! depth over the smaller radius
    integer :: i

    i = count(found%share >= share) + 1
    if (i > most_pairs) return
    found%pair(:, i + 1:) = found%pair(:, i:most_pairs - 1)
    found%depth(i + 1:) = found%depth(i:most_pairs - 1)
    found%share(i + 1:) = found%share(i:most_pairs - 1)
    found%pair(:, i) = pair
    found%depth(i) = depth
    found%share(i) = share
  end subroutine add_overlap

  !> Report pairs of bodies whose shapes overlap: by much a mistake, by little a warning; and how many pairs there are where not
  !! all are listed.
  subroutine report_overlaps(deck, found, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(overlaps_t), intent(in) :: found !! pairs found
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to
    character(len=:), allocatable :: message
    integer :: i

    do i = 1, count(found%share > 0)
      associate (first => minval(found%pair(:, i)), second => maxval(found%pair(:, i)))
        message = name_of(deck, first)//' and '//name_of(deck, second)//' overlap at the start by '// &
                  to_text(found%depth(i), 3)//' m, '//to_text(nint(100*min(found%share(i), 1e7_wp)))//' % of the smaller radius'
        if (found%share(i) > tolerated) then
          call deck%complain(diagnostics, message, deck%block_of_body(second))
        else
          call deck%warn(diagnostics, message, deck%block_of_body(second))
        end if
      end associate
    end do
    if (found%n > most_pairs) call deck%warn(diagnostics, to_text(found%n)//' pairs overlap at the start, which are not all '// &
                                             'listed', deck%block_of('scene'))
  end subroutine report_overlaps
end module sg_start_overlaps
