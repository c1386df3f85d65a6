!> Pairs of contactors that may touch before they have moved by half the skin: built rarely, used every step.
!!
!! Bodies are numbered along Hilbert's curve (their slots), and pairs follow the lower slot: this is the spatial
!! order of everything after it. The list depends on nothing but the configuration at its making, which is kept: a
!! restarted run makes the same list again. Links of the scene stand behind all others, whatever their length.
module sg_neighbours
  use sg_bodies, only: bodies_t, body_present, is_absent
  use sg_cell_search, only: wrap_in_cell
  use sg_cells, only: build_cells, cells_t, level_cell
  use sg_contactors, only: contactors_t, kind_point, n_kinds, place_contactors
  use sg_kinds, only: wp, i1, i4, i8
  use sg_links, only: link_image
  use sg_lists, only: reserve, room_for
  use sg_memory, only: memory_t
  use sg_near, only: candidate_first, is_near
  use sg_owners, only: contact_owner
  use sg_scene, only: image_shift, periods_of, scene_t
  use sg_sees, only: follows_motion, see_between, see_named, widest_alert
  use sg_sorting, only: hilbert_order, sort_permutation
  use sg_timers, only: wall_now
  implicit none
  private
  public :: neighbours_t, build_neighbours, find_neighbours, image_of_pair, offset_of

  !> All pairs that may touch soon
  type :: neighbours_t
    !> Number of pairs; those behind the first `n_near` are links
    integer :: n = 0, n_near = 0
    !> Link of each pair that is one: of pair `n_near + i` it is `link(i)`
    integer(i4), allocatable :: link(:)
    !> Times that the list was made
    integer :: builds = 0
    !> Contactors, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: contactor(:, :)
    !> Periods by which the antagonist is moved in x, and in space in y, shape (n); in a periodic cell along all axes
    integer(i1), allocatable :: image(:), image_y(:), image_z(:)
    !> Line of the scene's see tables, 0 for links, shape (n)
    integer(i4), allocatable :: see(:)
    !> Body of each slot, and slot of each body
    integer(i4), allocatable :: body_of(:), slot_of(:)
    !> Configuration at the making of the list, as `middle` of the bodies
    real(wp), allocatable :: built(:, :)
    !> What the list allows to each body: how far its shapes may move, and how far they are to be sought, together [m]
    real(wp), allocatable :: margin(:)
    !> How far shapes may move, two together, before the list is made again in any case [m]
    real(wp) :: skin = 0
    !> Skin of the next list, where all ranks of a decomposed scene must have the same; 0 where it is free to choose [m]
    real(wp) :: asked_skin = 0
    !> How much nearer two shapes may come to each other until the next detection, and for which such ways the list holds all that
    !! may be wanted, where alert distances follow the motion [m]
    real(wp) :: way = huge(1.0_wp)/4, listed_way = huge(1.0_wp)/4
    !> Alert distance of each line of the scene's see tables in the last detection [m]. Is that of a pair reduced to `least` of its
    !! line [m] until the solve shows that more is needed (sg_pair_alert), or, where that may be too short for some, by pair to what
    !! its own motion in a time step [s] asks for?
    real(wp), allocatable :: alert(:), least(:)
    logical :: is_reduced = .false., is_by_pair = .false.
    real(wp) :: time_step = 0
    !> Motion of each shape in twice the step with its free velocity (`find_motion` of sg_pair_alert)
    real(wp), allocatable :: motion(:, :)
    !> Does the solution of the step close a contact that a reduced alert distance has left out?
    logical :: is_too_short = .false.
    !> Solves of the step whose reduced distances were too short
    integer :: n_reduced = 0
    !> Substeps from one detection to the next
    integer :: substeps = 1
    !> Do corners of polygons wait in a detection until a pair needs them?
    logical :: corners_wait = .false.
    !> Are only shapes sought that touch, whatever the alert distances are?
    logical :: without_alert = .false.
    !> Rank whose contacts are sought, in a decomposed scene: each contact belongs to one rank
    integer :: rank = 0
    !> Memory that the list may grow in, and wall time at which its making ends; 0 for none [s]
    type(memory_t) :: memory
    real(wp) :: deadline = 0
    !> Did its making end early, by one of the two? The list is empty then; pairs found before
    logical :: is_cut = .false., is_late = .false.
    integer :: n_cut = 0
  end type neighbours_t

contains

  !> Make the list for a configuration. Bodies that left the period are brought back into it.
  subroutine build_neighbours(pairs, scene, configuration, margin)
    type(neighbours_t), intent(inout) :: pairs !! list to make
    type(scene_t), intent(inout) :: scene !! positions may be wrapped, contactors are placed
    real(wp), intent(in) :: configuration(:, :) !! of all bodies, as their `middle`
    real(wp), intent(in) :: margin(:) !! how far shapes of each body may move, and are to be sought, together [m]

    if (allocated(pairs%built)) then
      if (any(shape(pairs%built) /= shape(configuration))) deallocate (pairs%built)
    end if
    if (.not. allocated(pairs%built)) allocate (pairs%built(size(configuration, 1), size(configuration, 2)))
    pairs%built(:, :) = configuration
    if (scene%cell%is_on) then
      call wrap_in_cell(scene, pairs%built)
    else
      if (scene%period > 0) call wrap(scene%bodies, pairs%built, 1, scene%period, scene%bodies%crossings)
      if (scene%period_y > 0) call wrap(scene%bodies, pairs%built, 2, scene%period_y, scene%bodies%crossings_y)
    end if
    if (allocated(pairs%margin)) deallocate (pairs%margin)
    allocate (pairs%margin, source=margin)
    call find_neighbours(pairs, scene)
    call append_links(pairs, scene)
    if (pairs%is_cut .or. pairs%is_late) call give_back(pairs)
    pairs%builds = pairs%builds + 1
  end subroutine build_neighbours

  !> Find the pairs of shapes that are near each other in the configuration `pairs%built`; bodies may lie outside of the period.
  subroutine find_neighbours(pairs, scene)
    type(neighbours_t), intent(inout) :: pairs !! pairs found; its configuration, margins and rank are given
    type(scene_t), intent(inout) :: scene !! its contactors are placed
    integer(i4), allocatable :: table(:, :)

    call place_contactors(scene%contactors, pairs%built)
    call order_bodies(pairs, scene)
    call tabulate_sees(scene, table)
    call find_pairs(pairs, scene, table)
  end subroutine find_neighbours

  !> Bring bodies back into the period, counting crossings.
  subroutine wrap(bodies, configuration, axis, period, crossings)
    type(bodies_t), intent(inout) :: bodies
    real(wp), intent(inout) :: configuration(:, :)
    integer, intent(in) :: axis
    real(wp), intent(in) :: period
    integer(i4), allocatable, intent(inout) :: crossings(:)
    ! More crossings than can be counted: what flies so fast only stays within the period.
    real(wp), parameter :: most = 2e9_wp
    real(wp) :: crossed
    integer :: b

    do b = 1, bodies%n
      crossed = configuration(axis, b)/period
      crossed = crossed - modulo(crossed, 1.0_wp)
      if (.not. abs(crossed) > 0) cycle
      configuration(axis, b) = configuration(axis, b) - crossed*period
      bodies%middle(axis, b) = bodies%middle(axis, b) - crossed*period
      bodies%position(axis, b) = bodies%position(axis, b) - crossed*period
      crossings(b) = int(max(-most, min(most, real(crossings(b), wp) + crossed)), i4)
    end do
  end subroutine wrap

  !> Number bodies along Hilbert's curve.
  subroutine order_bodies(pairs, scene)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    real(wp) :: low(scene%dimension), side
    integer :: b, n

    n = scene%dimension
    ! A rank may hold no body.
    low = 0
    side = 1
    if (scene%bodies%n > 0) then
      low = minval(pairs%built(:n, :), 2)
      side = max(maxval(maxval(pairs%built(:n, :), 2) - low), tiny(1.0_wp))
    end if
    pairs%body_of = hilbert_order(pairs%built(:n, :), low, side)
    if (.not. allocated(pairs%slot_of)) allocate (pairs%slot_of(scene%bodies%n))
    do b = 1, scene%bodies%n
      pairs%slot_of(pairs%body_of(b)) = int(b, i4)
    end do
  end subroutine order_bodies

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

  !> Look in the cells for all pairs that see each other and are near.
  subroutine find_pairs(pairs, scene, table)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: table(:, :)
    type(cells_t) :: cells
    integer(i4), allocatable :: order(:)
    integer, allocatable :: crossed(:, :)
    real(wp), allocatable :: centre(:, :), reach(:)
    real(wp) :: margin, period(3), slope
    integer :: i, level, axis

    period = periods_of(scene)
    ! Cells stand upright: places are sheared back by the tilt, by which distances grow no more than this.
    slope = 0
    if (scene%cell%is_on) slope = scene%cell%middle(4)/scene%cell%middle(2)
    order = contactor_order(pairs, scene%contactors)
    if (allocated(scene%bodies%presence)) &
      order = pack(order, scene%bodies%presence(scene%contactors%body(order)) == body_present)
    allocate (centre(3, size(order)), source=0.0_wp)
    allocate (reach(size(order)))
    allocate (crossed(3, size(order)), source=0)
    do i = 1, size(order)
      centre(:scene%dimension, i) = scene%contactors%centre(:, order(i))
      ! A body in the period may carry shapes far outside it (rough walls made of disks).
      if (abs(slope) > 0) centre(1, i) = centre(1, i) - slope*centre(2, i)
      do axis = 1, 3
        if (period(axis) > 0) crossed(axis, i) = floor(centre(axis, i)/period(axis))
        centre(axis, i) = centre(axis, i) - period(axis)*real(crossed(axis, i), wp)
      end do
      reach(i) = scene%contactors%reach(order(i)) + pairs%margin(scene%contactors%body(order(i)))
    end do
    margin = 0
    if (.not. pairs%without_alert) margin = widest_alert(pack(scene%sees, .not. follows_motion(scene%sees)), 0.0_wp)
    if (abs(slope) > 0) then
      ! The largest stretch of a shear by so much.
      associate (stretch => abs(slope)/2 + sqrt(1 + slope**2/4))
        reach = stretch*reach
        margin = stretch*margin
      end associate
    end if
    call build_cells(cells, centre, reach, margin, period)
    pairs%n = 0
    pairs%is_cut = .false.
    pairs%is_late = .false.
    do i = 1, size(order)
      do level = cells%level(i), cells%n_levels
        call look_around(pairs, scene, table, cells, order, crossed, centre, i, level)
      end do
      if (pairs%deadline > 0) pairs%is_late = wall_now() > pairs%deadline
      if (pairs%is_cut .or. pairs%is_late) exit
    end do
  end subroutine find_pairs

  !> Add the links whose contacts this rank owns.
  subroutine append_links(pairs, scene)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i4) :: image(3)
    integer :: l

    pairs%n_near = pairs%n
    do l = 1, scene%links%n
      associate (ends => scene%links%contactor(:, l))
        if (any(ends == 0)) cycle
        if (is_absent(scene%bodies, scene%contactors%body(ends(1))) .or. &
            is_absent(scene%bodies, scene%contactors%body(ends(2)))) cycle
        if (allocated(scene%bodies%owner)) then
          if (contact_owner(scene%bodies%owner(scene%contactors%body(ends))) /= pairs%rank) cycle
        end if
        image = 0
        image(:2) = image_of_link(scene, l, scene%contactors%body(ends))
        call add_pair(pairs, scene%dimension, scene%cell%is_on, ends, image, 0)
        if (pairs%is_cut) return
        call reserve(pairs%link, pairs%n - pairs%n_near)
        pairs%link(pairs%n - pairs%n_near) = int(l, i4)
      end associate
    end do
  end subroutine append_links

  !> Periods in x and y by which the antagonist of a link is moved.
  pure function image_of_link(scene, l, body) result(image)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: l
    integer(i4), intent(in) :: body(2) !! candidate and antagonist
    integer(i4) :: image(2), crossings(2, 2)

    crossings(1, :) = scene%bodies%crossings(body)
    crossings(2, :) = 0
    if (scene%dimension == 3) crossings(2, :) = scene%bodies%crossings_y(body)
    image = link_image(scene%links, l, crossings)
  end function image_of_link

  !> Append a pair.
  subroutine add_pair(pairs, dimension, has_cell, contactor, image, see)
    type(neighbours_t), intent(inout) :: pairs
    integer, intent(in) :: dimension
    logical, intent(in) :: has_cell !! are all axes periodic?
    integer(i4), intent(in) :: contactor(2) !! candidate and antagonist
    integer(i4), intent(in) :: image(3) !! periods along x, y, z by which the antagonist is moved
    integer, intent(in) :: see !! line of the see tables, 0 for a link

    call make_room(pairs, dimension, has_cell)
    if (pairs%is_cut) return
    pairs%n = pairs%n + 1
    pairs%contactor(:, pairs%n) = contactor
    pairs%image(pairs%n) = int(image(1), i1)
    if (dimension == 3 .or. has_cell) pairs%image_y(pairs%n) = int(image(2), i1)
    if (dimension == 3 .and. has_cell) pairs%image_z(pairs%n) = int(image(3), i1)
    pairs%see(pairs%n) = int(see, i4)
  end subroutine add_pair

  !> Periods along x, y, z by which the antagonist of a pair is moved.
  pure function image_of_pair(pairs, p) result(image)
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    integer, intent(in) :: p !! pair
    integer :: image(3)

    image = [int(pairs%image(p)), 0, 0]
    if (allocated(pairs%image_y)) image(2) = int(pairs%image_y(p))
    if (allocated(pairs%image_z)) image(3) = int(pairs%image_z(p))
  end function image_of_pair

  !> Shift of the antagonist of a pair [m]. It is asked for at every pair, so one without a cell is found in place.
  pure function offset_of(scene, pairs, p) result(offset)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    integer, intent(in) :: p !! pair
    real(wp) :: offset(3)

    if (scene%cell%is_on) then
      offset = image_shift(scene, image_of_pair(pairs, p))
    else
      offset(1) = scene%period*real(pairs%image(p), wp)
      offset(2:3) = 0
      if (scene%dimension == 3) offset(2) = scene%period_y*real(pairs%image_y(p), wp)
    end if
  end function offset_of

  !> Empty a list that was not made to its end: what follows, and a checkpoint, need the memory.
  subroutine give_back(pairs)
    type(neighbours_t), intent(inout) :: pairs

    pairs%n_cut = pairs%n
    pairs%n = 0
    pairs%n_near = 0
    if (allocated(pairs%contactor)) deallocate (pairs%contactor, pairs%image, pairs%see)
    if (allocated(pairs%image_y)) deallocate (pairs%image_y)
    if (allocated(pairs%image_z)) deallocate (pairs%image_z)
    allocate (pairs%contactor(2, 0), pairs%image(0), pairs%see(0))
  end subroutine give_back

  !> Contactors along the curve of their bodies; points, which touch nothing, are left out.
  pure function contactor_order(pairs, contactors) result(order)
    type(neighbours_t), intent(in) :: pairs
    type(contactors_t), intent(in) :: contactors
    integer(i4), allocatable :: order(:)
    integer(i8), allocatable :: keys(:)
    integer :: c

    allocate (keys(contactors%n))
    do c = 1, contactors%n
      keys(c) = int(pairs%slot_of(contactors%body(c)), i8)
    end do
    order = sort_permutation(keys)
    if (contactors%n_rows(kind_point) > 0) order = pack(order, contactors%kind(order) /= kind_point)
  end function contactor_order

  !> Pairs of one contactor with those of one level in the 3 by 3 (by 3) cells about it.
  subroutine look_around(pairs, scene, table, cells, order, crossed, centre, i, level)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: table(:, :), order(:)
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: crossed(:, :) !! periods between each contactor and its centre, along x, y, z
    real(wp), intent(in) :: centre(:, :) !! within the period
    integer, intent(in) :: i, level
    integer(i4) :: home(3), cell(3), wrapped(-1:1, 3), bucket
    integer :: column, row, layer, m, j, axis, step, images(-1:1, 3), layers

    home = level_cell(cells, level, centre(:, i))
    images = 0
    do axis = 1, 3
      do step = -1, 1
        wrapped(step, axis) = home(axis) + int(step, i4)
        if (cells%columns(axis, level) == 0) cycle
        wrapped(step, axis) = modulo(wrapped(step, axis), cells%columns(axis, level))
        images(step, axis) = (home(axis) + step - wrapped(step, axis))/cells%columns(axis, level)
      end do
    end do
    layers = scene%dimension - 2
    do layer = -layers, layers
      do row = -1, 1
        do column = -1, 1
          cell = [wrapped(column, 1), wrapped(row, 2), wrapped(layer, 3)]
          bucket = cells%bucket(level, cell)
          do m = cells%first(bucket), cells%first(bucket + 1) - 1
            j = cells%member(m)
            if (j <= i .and. level == cells%level(i)) cycle
            if (cells%level(j) /= level .or. any(cells%cell(:, j) /= cell)) cycle
            call consider(pairs, scene, table, order(i), order(j), &
                          [images(column, 1), images(row, 2), images(layer, 3)] + crossed(:, i) - crossed(:, j))
          end do
        end do
      end do
    end do
  end subroutine look_around

  !> Make room for one more pair, unless memory is short.
  subroutine make_room(pairs, dimension, has_cell)
    type(neighbours_t), intent(inout) :: pairs
    integer, intent(in) :: dimension
    logical, intent(in) :: has_cell
    integer :: now

    now = 0
    if (allocated(pairs%see)) now = size(pairs%see)
    if (pairs%n < now .or. pairs%is_cut) return
    ! While a table grows there are both the old one and the new one.
    associate (bytes => 12 + dimension - merge(0, 1, has_cell), more => room_for(pairs%n + 1, now) - now)
      pairs%is_cut = pairs%n == huge(pairs%n) - 1 .or. .not. pairs%memory%fits(int(bytes, i8)*int(more, i8) + 8_i8*int(now, i8))
    end associate
    if (pairs%is_cut) return
    call reserve(pairs%contactor, 2, pairs%n + 1)
    call reserve(pairs%image, pairs%n + 1)
    if (dimension == 3 .or. has_cell) call reserve(pairs%image_y, pairs%n + 1)
    if (dimension == 3 .and. has_cell) call reserve(pairs%image_z, pairs%n + 1)
    call reserve(pairs%see, pairs%n + 1)
  end subroutine make_room

  !> Keep a pair when the two see each other and are near.
  subroutine consider(pairs, scene, table, i, j, image)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: table(:, :), i, j
    integer, intent(in) :: image(3) !! periods by which j is moved, along x, y, z
    integer(i4) :: see
    real(wp) :: period(3), margin
    integer :: side

    associate (contactors => scene%contactors)
      if (contactors%body(i) == contactors%body(j)) return
      see = table(class_of(contactors, i), class_of(contactors, j))
      if (allocated(scene%groups)) see = see_named(scene, see, i, j)
      if (see == 0) return
      if (allocated(scene%bodies%owner)) then
        if (contact_owner(scene%bodies%owner([contactors%body(i), contactors%body(j)])) /= pairs%rank) return
      end if
      period = periods_of(scene)
      margin = pairs%margin(contactors%body(i)) + pairs%margin(contactors%body(j))
      if (.not. (pairs%without_alert .or. follows_motion(scene%sees(see)))) margin = margin + scene%sees(see)%alert
      if (.not. is_near(contactors, i, j, image_shift(scene, image), period, margin)) return
      side = merge(1, -1, candidate_first(contactors, i, j))
      call add_pair(pairs, scene%dimension, scene%cell%is_on, merge([i, j], [j, i], side == 1), int(side*image, i4), int(see))
    end associate
  end subroutine consider
end module sg_neighbours
