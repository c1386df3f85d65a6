!> Pairs of contactors that may touch before they have moved by half the skin: built rarely, used every step.
!!
!! Bodies are numbered along Hilbert's curve (their slots), and pairs follow the lower slot: this is the spatial
!! order of everything after it. The list depends on nothing but the configuration at its making, which is kept: a
!! restarted run makes the same list again.
module sg_neighbours
  use sg_bodies, only: bodies_t
  use sg_cells, only: build_cells, cells_t, level_cell
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_polygon, kind_wall, n_kinds, place_contactors
  use sg_kinds, only: wp, i1, i4, i8
  use sg_lists, only: reserve
  use sg_scene, only: scene_t
  use sg_sees, only: see_between
  use sg_sorting, only: hilbert_key, sort_permutation
  implicit none
  private
  public :: neighbours_t, build_neighbours, neighbours_are_stale, fitting_skin, candidate_first

  !> All pairs that may touch soon
  type :: neighbours_t
    !> Number of pairs
    integer :: n = 0
    !> Times that the list was made
    integer :: builds = 0
    !> Contactors, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: contactor(:, :)
    !> Periods by which the antagonist is moved in x, shape (n)
    integer(i1), allocatable :: image(:)
    !> Line of the scene's see tables, shape (n)
    integer(i4), allocatable :: see(:)
    !> Body of each slot, and slot of each body
    integer(i4), allocatable :: body_of(:), slot_of(:)
    !> Configuration at the making of the list, shape (velocity components, bodies)
    real(wp), allocatable :: built(:, :)
    !> How far shapes may move, two together, before the list is made again [m]
    real(wp) :: skin = 0
  end type neighbours_t

contains

  !> Has something moved so far that the list no longer holds all that may touch?
  pure logical function neighbours_are_stale(pairs, scene) result(stale)
    type(neighbours_t), intent(in) :: pairs !! list to look at
    type(scene_t), intent(in) :: scene !! its bodies' `middle` counts
    real(wp) :: moved, arm
    integer :: c, b

    stale = .not. allocated(pairs%built)
    if (stale) return
    associate (contactors => scene%contactors, middle => scene%bodies%middle)
      do c = 1, contactors%n
        b = contactors%body(c)
        moved = (middle(1, b) - pairs%built(1, b))**2 + (middle(2, b) - pairs%built(2, b))**2
        if (size(middle, 1) == 3) then
          arm = turning_arm(contactors, c)
          if (arm > 0) moved = (sqrt(moved) + abs(middle(3, b) - pairs%built(3, b))*arm)**2
        end if
        if (moved > (pairs%skin/2)**2) then
          stale = .true.
          return
        end if
      end do
    end associate
  end function neighbours_are_stale

  !> How far a contactor's bound moves per radian of its body [m].
  pure real(wp) function turning_arm(contactors, c) result(arm)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c

    arm = abs(contactors%shift(1, c)) + abs(contactors%shift(2, c))
    if (contactors%kind(c) == kind_wall) arm = arm + contactors%reach(c)
  end function turning_arm

  !> Make the list for a configuration. Bodies that left the period are brought back into it.
  subroutine build_neighbours(pairs, scene, configuration, skin)
    type(neighbours_t), intent(inout) :: pairs !! list to make
    type(scene_t), intent(inout) :: scene !! positions may be wrapped, contactors are placed
    real(wp), intent(in) :: configuration(:, :) !! of all bodies, shape (velocity components, bodies)
    real(wp), intent(in) :: skin !! how far shapes may move, two together, before the list is made again [m]
    integer(i4), allocatable :: table(:, :)

    pairs%built = configuration
    if (scene%period > 0) call wrap(scene%bodies, pairs%built, scene%period)
    call place_contactors(scene%contactors, pairs%built)
    call order_bodies(pairs, scene)
    call tabulate_sees(scene, table)
    pairs%skin = skin
    call find_pairs(pairs, scene, table)
    pairs%builds = pairs%builds + 1
  end subroutine build_neighbours

  !> A skin for the present motion [m]: lists that last long cost pairs that never touch, short-lived ones cost searches.
  !!
  !! Bodies move from their position to `middle` in half a step, so the fastest crosses half the skin in about eight steps.
  pure real(wp) function fitting_skin(scene) result(skin)
    type(scene_t), intent(in) :: scene !! scene with its `middle` configuration
    real(wp), parameter :: thinnest = 0.1_wp, thickest = 1 ! in mean radii
    real(wp) :: reach, step

    reach = common_reach(scene)
    associate (bodies => scene%bodies)
      step = 2*sqrt(maxval((bodies%middle(1, :) - bodies%position(1, :))**2 + (bodies%middle(2, :) - bodies%position(2, :))**2))
    end associate
    skin = max(thinnest*reach, min(thickest*reach, 16*step))
  end function fitting_skin

  !> Bring bodies back into the period, counting crossings.
  subroutine wrap(bodies, configuration, period)
    type(bodies_t), intent(inout) :: bodies
    real(wp), intent(inout) :: configuration(:, :)
    real(wp), intent(in) :: period
    integer :: b, crossed

    do b = 1, bodies%n
      crossed = floor(configuration(1, b)/period)
      if (crossed == 0) cycle
      configuration(1, b) = configuration(1, b) - real(crossed, wp)*period
      bodies%middle(1, b) = bodies%middle(1, b) - real(crossed, wp)*period
      bodies%position(1, b) = bodies%position(1, b) - real(crossed, wp)*period
      bodies%crossings(b) = bodies%crossings(b) + crossed
    end do
  end subroutine wrap

  !> Number bodies along Hilbert's curve.
  subroutine order_bodies(pairs, scene)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i8), allocatable :: keys(:)
    real(wp) :: low(2), size_of_box
    integer :: b

    low = minval(pairs%built(1:2, :), 2)
    size_of_box = max(maxval(maxval(pairs%built(1:2, :), 2) - low), tiny(1.0_wp))
    allocate (keys(scene%bodies%n))
    do b = 1, scene%bodies%n
      keys(b) = hilbert_key((pairs%built(1:2, b) - low)/size_of_box)
    end do
    pairs%body_of = sort_permutation(keys)
    if (.not. allocated(pairs%slot_of)) allocate (pairs%slot_of(scene%bodies%n))
    do b = 1, scene%bodies%n
      pairs%slot_of(pairs%body_of(b)) = int(b, i4)
    end do
  end subroutine order_bodies

  !> Mean reach of the shapes that are not walls [m], or of all where there is nothing else.
  pure real(wp) function common_reach(scene) result(reach)
    type(scene_t), intent(in) :: scene

    associate (contactors => scene%contactors)
      associate (kind => contactors%kind(:contactors%n), all_reach => contactors%reach(:contactors%n))
        if (any(kind == kind_disk .or. kind == kind_polygon)) then
          reach = exp(sum(log(all_reach), kind == kind_disk .or. kind == kind_polygon) &
                      /real(count(kind == kind_disk .or. kind == kind_polygon), wp))
        else
          reach = sum(all_reach)/real(max(1, size(all_reach)), wp)
        end if
      end associate
    end associate
  end function common_reach

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
    integer, allocatable :: crossed(:)
    real(wp), allocatable :: centre(:, :), reach(:)
    real(wp) :: margin
    integer :: i, level

    order = contactor_order(pairs, scene%contactors)
    allocate (centre(2, size(order)), reach(size(order)))
    allocate (crossed(size(order)), source=0)
    do i = 1, size(order)
      centre(:, i) = scene%contactors%centre(:, order(i))
      ! A body in the period may carry shapes far outside it (rough walls made of disks).
      if (scene%period > 0) crossed(i) = floor(centre(1, i)/scene%period)
      centre(1, i) = centre(1, i) - scene%period*real(crossed(i), wp)
      reach(i) = scene%contactors%reach(order(i))
    end do
    margin = pairs%skin
    if (size(scene%sees) > 0) margin = margin + maxval(scene%sees%alert)
    call build_cells(cells, centre, reach, margin, scene%period)
    pairs%n = 0
    do i = 1, size(order)
      do level = cells%level(i), cells%n_levels
        call look_around(pairs, scene, table, cells, order, crossed, centre, i, level)
      end do
    end do
  end subroutine find_pairs

  !> Contactors along the curve of their bodies.
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
  end function contactor_order

  !> Pairs of one contactor with those of one level in the 3 by 3 cells about it.
  subroutine look_around(pairs, scene, table, cells, order, crossed, centre, i, level)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: table(:, :), order(:)
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: crossed(:) !! periods between each contactor and its centre
    real(wp), intent(in) :: centre(:, :) !! within the period
    integer, intent(in) :: i, level
    integer(i4) :: home(2), cell(2), bucket
    integer :: column, row, m, j, image

    home = level_cell(cells, level, centre(:, i))
    do row = -1, 1
      do column = -1, 1
        cell = home + [column, row]
        image = 0
        if (cells%columns(level) > 0) then
          image = (cell(1) - modulo(cell(1), cells%columns(level)))/cells%columns(level)
          cell(1) = modulo(cell(1), cells%columns(level))
        end if
        bucket = cells%bucket(level, cell)
        do m = cells%first(bucket), cells%first(bucket + 1) - 1
          j = cells%member(m)
          if (cells%level(j) /= level .or. cells%cell(1, j) /= cell(1) .or. cells%cell(2, j) /= cell(2)) cycle
          if (level == cells%level(i) .and. j <= i) cycle
          call consider(pairs, scene, table, order(i), order(j), image + crossed(i) - crossed(j))
        end do
      end do
    end do
  end subroutine look_around

  !> Keep a pair when the two see each other and are near.
  subroutine consider(pairs, scene, table, i, j, image)
    type(neighbours_t), intent(inout) :: pairs
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: table(:, :), i, j
    integer, intent(in) :: image !! periods by which j is moved
    integer(i4) :: see

    associate (contactors => scene%contactors)
      if (contactors%body(i) == contactors%body(j)) return
      see = table(class_of(contactors, i), class_of(contactors, j))
      if (see == 0) return
      if (.not. is_near(contactors, i, j, image, scene%period, scene%sees(see)%alert + pairs%skin)) return
      pairs%n = pairs%n + 1
      call reserve(pairs%contactor, 2, pairs%n)
      call reserve(pairs%image, pairs%n)
      call reserve(pairs%see, pairs%n)
      pairs%see(pairs%n) = see
      if (candidate_first(contactors, i, j)) then
        pairs%contactor(:, pairs%n) = [i, j]
        pairs%image(pairs%n) = int(image, i1)
      else
        pairs%contactor(:, pairs%n) = [j, i]
        pairs%image(pairs%n) = int(-image, i1)
      end if
    end associate
  end subroutine consider

  !> Is `i` the candidate of the pair? Disks before polygons before walls; of one kind, the later contactor.
  pure logical function candidate_first(contactors, i, j)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: i !! one contactor
    integer, intent(in) :: j !! the other
    integer, parameter :: rank(n_kinds) = [1, 3, 4, 2]

    candidate_first = i > j
    if (contactors%kind(i) /= contactors%kind(j)) candidate_first = rank(contactors%kind(i)) < rank(contactors%kind(j))
  end function candidate_first

  !> Can the gap between two contactors, j moved by some periods, be below a distance? A cheap lower bound decides.
  pure logical function is_near(contactors, i, j, image, period, distance)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: i, j
    integer, intent(in) :: image
    real(wp), intent(in) :: period, distance
    real(wp) :: apart(2)

    apart = contactors%centre(:, i) - contactors%centre(:, j)
    apart(1) = apart(1) - period*real(image, wp)
    if (contactors%kind(j) == kind_wall) then
      is_near = near_wall(contactors, j, apart, contactors%reach(i), period, distance)
    else if (contactors%kind(i) == kind_wall) then
      is_near = near_wall(contactors, i, -apart, contactors%reach(j), period, distance)
    else if (contactors%kind(j) == kind_hollow) then
      is_near = contactors%reach(j) - hypot(apart(1), apart(2)) - contactors%reach(i) < distance
    else if (contactors%kind(i) == kind_hollow) then
      is_near = contactors%reach(i) - hypot(apart(1), apart(2)) - contactors%reach(j) < distance
    else
      is_near = hypot(apart(1), apart(2)) - contactors%reach(i) - contactors%reach(j) < distance
    end if
  end function is_near

  !> The same against a wall: distance to its axis. The images of a wall that spans the period are itself: what sees it
  !! sees the one whose centre is nearest.
  pure logical function near_wall(contactors, wall, apart, reach, period, distance)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: wall
    real(wp), intent(in) :: apart(2), reach, period, distance
    real(wp) :: axis(2), along, across, half_length

    associate (row => contactors%row(wall))
      axis = contactors%wall_axis(:, row)
      half_length = contactors%wall_size(1, row)
      along = max(0.0_wp, abs(dot_product(apart, axis)) - half_length)
      across = apart(1)*axis(2) - apart(2)*axis(1)
      near_wall = hypot(along, across) - contactors%wall_size(2, row) - reach < distance
      if (period > 0 .and. 2*half_length*abs(axis(1)) >= period) near_wall = near_wall .and. is_nearest(apart(1)/period)
    end associate
  end function near_wall

  !> Is no other image nearer? Of two as near, it is the one on the right.
  pure logical function is_nearest(periods)
    real(wp), intent(in) :: periods !! how many periods the image is away

    is_nearest = periods >= -0.5_wp .and. periods < 0.5_wp
  end function is_nearest
end module sg_neighbours
