!> Pairs of contactors that may touch before they have moved by half the skin: built rarely, used every step.
!!
!! Bodies are numbered along Hilbert's curve (their slots), and pairs follow the lower slot: this is the spatial
!! order of everything after it. The list depends on nothing but the configuration at its making, which is kept: a
!! restarted run makes the same list again. Links of the scene stand behind all others, whatever their length.
module sg_neighbours
  use sg_bodies, only: bodies_t, is_absent
  use sg_cell_search, only: wrap_in_cell
  use sg_contactors, only: contactors_t, kind_point, place_contactors
  use sg_kinds, only: wp, i4, i8
  use sg_links, only: link_image
  use sg_lists, only: reserve
  use sg_neighbour_list, only: add_pair, give_back, neighbours_t
  use sg_owners, only: contact_owner
  use sg_pair_search, only: find_pairs
  use sg_scene, only: scene_t
  use sg_sorting, only: hilbert_order, sort_permutation
  implicit none
  private
  public :: build_neighbours, find_neighbours

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

    call place_contactors(scene%contactors, pairs%built, pairs%corners_wait)
    call order_bodies(pairs, scene)
    call find_pairs(pairs, scene, contactor_order(pairs, scene%contactors))
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
end module sg_neighbours
