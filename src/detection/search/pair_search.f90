!> The search for pairs of contactors that see each other and are near, in cells (doc/theory/detection.md, "Broad phase").
!!
!! Contactors are looked at along the curve of their bodies, so that most share their cell with the one before: what lies in the
!! cells about it is gathered once, level by level. Of what is gathered most is far, which a square decides.
module sg_pair_search
  use sg_around, only: around_t, find_near, gather, n_places, place_of
  use sg_bodies, only: body_present
  use sg_cells, only: build_cells, cells_t, level_cell
  use sg_contactors, only: contactors_t, n_kinds
  use sg_kinds, only: wp, i4
  use sg_near, only: candidate_first, is_near
  use sg_neighbour_list, only: add_pair, neighbours_t
  use sg_owners, only: contact_owner
  use sg_scene, only: image_shift, periods_of, scene_t
  use sg_sees, only: follows_motion, see_between, see_named, widest_alert
  use sg_shape_kinds, only: is_bounding
  use sg_timers, only: wall_now
  implicit none
  private
  public :: find_pairs

  !> Contactors in the order in which they are looked at
  type :: search_t
    !> Contactors, and class of each (`class_of`)
    integer(i4), allocatable :: contactor(:), class(:)
    !> Line of the see tables between two classes
    integer(i4), allocatable :: table(:, :)
    !> Centres within the period, sheared back by the tilt of a cell [m], and periods to where they are, shape (3, n)
    real(wp), allocatable :: centre(:, :)
    integer(i4), allocatable :: crossed(:, :)
    !> Radii with margins, stretched by a tilt, but out of all bounds for what bounds others, since it reaches beyond the circle or
    !! sphere about it; and how much farther apart than these two may be sought [m]
    real(wp), allocatable :: radius(:)
    real(wp) :: margin = 0
    !> Does a contactor bound others? Of two that do not, do squares of these radii decide, where rounding may add a pair?
    logical, allocatable :: bounds(:)
    logical :: squares_decide = .false.
    !> Periods, whether there are any, and what distances may lose where places are brought back into them [m]
    real(wp) :: period(3) = 0, slack = 0
    logical :: is_periodic = .false.
    !> Cells, and what lies about those looked at last, by place and level
    type(cells_t) :: cells
    type(around_t), allocatable :: around(:, :)
  end type search_t

contains

  !> Look in the cells for all pairs that see each other and are near.
  subroutine find_pairs(pairs, scene, order)
    type(neighbours_t), intent(inout) :: pairs !! list, its margins given; its pairs are found
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    integer(i4), intent(in), contiguous :: order(:) !! contactors in the order in which pairs follow
    type(search_t) :: search
    integer :: i, level

    call begin_search(search, pairs, scene, order)
    pairs%n = 0
    pairs%is_cut = .false.
    pairs%is_late = .false.
    do i = 1, size(search%contactor)
      do level = search%cells%level(i), search%cells%n_levels
        call look_around(pairs, scene, search, i, level)
      end do
      if (pairs%deadline > 0) pairs%is_late = wall_now() > pairs%deadline
      if (pairs%is_cut .or. pairs%is_late) exit
    end do
  end subroutine find_pairs

  !> Contactors that are there, in order, and in cells.
  subroutine begin_search(search, pairs, scene, order)
    type(search_t), intent(out) :: search
    type(neighbours_t), intent(in) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in), contiguous :: order(:)
    real(wp), allocatable :: reach(:)
    integer :: i

    search%contactor = order
    if (allocated(scene%bodies%presence)) &
      search%contactor = pack(order, scene%bodies%presence(scene%contactors%body(order)) == body_present)
    call tabulate_sees(scene, search%table)
    call place_search(search, pairs, scene, reach)
    search%radius = (1 + 64*epsilon(1.0_wp))*reach
    allocate (search%class(size(search%contactor)))
    search%bounds = is_bounding(scene%contactors%kind(search%contactor))
    do i = 1, size(search%contactor)
      search%class(i) = int(class_of(scene%contactors, int(search%contactor(i))), i4)
      if (search%bounds(i)) search%radius(i) = 1e100_wp
    end do
    search%squares_decide = .not. (pairs%without_alert .or. search%margin > 0 .or. scene%cell%is_on)
    call build_cells(search%cells, search%centre, reach, search%margin, search%period)
    allocate (search%around(n_places, search%cells%n_levels))
  end subroutine begin_search

  !> Centres and radii as cells want them.
  subroutine place_search(search, pairs, scene, reach)
    type(search_t), intent(inout) :: search
    type(neighbours_t), intent(in) :: pairs
    type(scene_t), intent(in) :: scene
    real(wp), allocatable, intent(out) :: reach(:) !! radii with margins, stretched by a tilt [m]
    real(wp) :: slope, farthest
    integer :: i, axis

    search%period = periods_of(scene)
    search%is_periodic = any(search%period > 0)
    ! Cells stand upright: places are sheared back by the tilt, by which distances grow no more than this.
    slope = 0
    if (scene%cell%is_on) slope = scene%cell%middle(4)/scene%cell%middle(2)
    allocate (search%centre(3, size(search%contactor)), source=0.0_wp)
    allocate (reach(size(search%contactor)))
    allocate (search%crossed(3, size(search%contactor)), source=0_i4)
    farthest = 0
    do i = 1, size(search%contactor)
      associate (c => search%contactor(i), centre => search%centre(:, i))
        centre(:scene%dimension) = scene%contactors%centre(:, c)
        ! A body in the period may carry shapes far outside it (rough walls made of disks).
        if (abs(slope) > 0) centre(1) = centre(1) - slope*centre(2)
        do axis = 1, 3
          if (.not. search%period(axis) > 0) cycle
          farthest = max(farthest, abs(centre(axis)))
          search%crossed(axis, i) = int(floor(centre(axis)/search%period(axis)), i4)
          centre(axis) = centre(axis) - search%period(axis)*real(search%crossed(axis, i), wp)
        end do
        reach(i) = scene%contactors%reach(c) + pairs%margin(scene%contactors%body(c))
      end associate
    end do
    search%slack = 16*epsilon(1.0_wp)*(farthest + merge(maxval(search%period), 0.0_wp, farthest > 0))
    if (.not. pairs%without_alert) search%margin = widest_alert(pack(scene%sees, .not. follows_motion(scene%sees)), 0.0_wp)
    if (.not. abs(slope) > 0) return
    ! The largest stretch of a shear by so much.
    associate (stretch => abs(slope)/2 + sqrt(1 + slope**2/4))
      reach = stretch*reach
      search%margin = stretch*search%margin
    end associate
  end subroutine place_search

  !> See lines by class of contactor (kind and colour), so that a pair needs one look.
  subroutine tabulate_sees(scene, table)
    type(scene_t), intent(in) :: scene
    integer(i4), allocatable, intent(out) :: table(:, :)
    integer(i4), allocatable :: example(:)
    integer :: c, i, j

    allocate (table(n_kinds*size(scene%colours), n_kinds*size(scene%colours)), source=0_i4)
    allocate (example(n_kinds*size(scene%colours)), source=0_i4)
    do c = 1, scene%contactors%n
      example(class_of(scene%contactors, c)) = int(c, i4)
    end do
    do j = 1, size(example)
      do i = 1, size(example)
        if (example(i) > 0 .and. example(j) > 0) table(i, j) = int(see_between(scene, example(i), example(j)), i4)
      end do
    end do
  end subroutine tabulate_sees

  !> Class of a contactor: kind and colour in one number.
  pure integer function class_of(contactors, c)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c

    class_of = contactors%kind(c) + n_kinds*(contactors%colour(c) - 1)
  end function class_of

  !> Pairs of one contactor with those of one level in the 3 by 3 (by 3) cells about it.
  subroutine look_around(pairs, scene, search, i, level)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    type(search_t), intent(inout) :: search
    integer, intent(in) :: i, level
    integer(i4) :: home(3)
    integer :: place, after, n

    if (search%cells%level(i) == level) then
      home = search%cells%cell(:, i)
    else
      home = level_cell(search%cells, level, search%centre(:, i))
    end if
    place = place_of(home)
    ! Of two of one level the pair follows the first.
    after = merge(i, 0, search%cells%level(i) == level)
    associate (around => search%around(place, level))
      if (any(home /= around%home)) &
        call gather(search%cells, scene%dimension, level, home, search%centre, search%radius, search%period, around)
      call find_near(around, after, search%centre(:, i), search%radius(i) + search%margin + search%slack, n)
      call consider_near(pairs, scene, search, around, i, n)
    end associate
  end subroutine look_around

  !> Consider one contactor with those that are near it.
  subroutine consider_near(pairs, scene, search, around, i, n)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    type(search_t), intent(in) :: search
    type(around_t), intent(in) :: around
    integer, intent(in) :: i, n
    integer(i4) :: image(3)
    integer :: k, m, axis

    image = 0
    do k = 1, n
      m = around%near(k)
      if (search%is_periodic) then
        do axis = 1, 3
          image(axis) = around%image(axis, m) + search%crossed(axis, i) - search%crossed(axis, around%member(m))
        end do
      end if
      call consider(pairs, scene, search, i, int(around%member(m)), image)
    end do
  end subroutine consider_near

  !> Keep a pair when the two see each other and are near.
  subroutine consider(pairs, scene, search, one, other, image)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    type(search_t), intent(in) :: search
    integer, intent(in) :: one, other !! two contactors by their place in the order
    integer(i4), intent(in) :: image(3) !! periods by which the other is moved, along x, y, z
    integer(i4) :: see, ends(2)
    real(wp) :: margin

    associate (contactors => scene%contactors, i => search%contactor(one), j => search%contactor(other))
      if (contactors%body(i) == contactors%body(j)) return
      see = search%table(search%class(one), search%class(other))
      if (allocated(scene%groups)) see = see_named(scene, see, i, j)
      if (see == 0) return
      if (allocated(scene%bodies%owner)) then
        if (contact_owner(scene%bodies%owner([contactors%body(i), contactors%body(j)])) /= pairs%rank) return
      end if
      if (.not. search%squares_decide .or. search%bounds(one) .or. search%bounds(other)) then
        margin = pairs%margin(contactors%body(i)) + pairs%margin(contactors%body(j))
        if (.not. (pairs%without_alert .or. follows_motion(scene%sees(see)))) margin = margin + scene%sees(see)%alert
        if (.not. is_near(contactors, i, j, image_shift(scene, image), search%period, margin)) return
      end if
      if (candidate_first(contactors, int(i), int(j))) then
        ends = [i, j]
        call add_pair(pairs, scene%dimension, scene%cell%is_on, ends, image, int(see))
      else
        ends = [j, i]
        call add_pair(pairs, scene%dimension, scene%cell%is_on, ends, -image, int(see))
      end if
    end associate
  end subroutine consider
end module sg_pair_search
