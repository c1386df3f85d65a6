!> Checks of the state at the start: grains within the period, shapes that do not overlap.
module sg_start_checks
  use sg_blocks, only: deck_t
  use sg_contactors, only: is_round, kind_hollow, kind_hollow_cylinder, place_contactors
  use sg_error, only: diagnostics_t
  use sg_homes, only: owner_of
  use sg_kinds, only: wp, i4
  use sg_named_bodies, only: name_of
  use sg_ordering, only: order_of
  use sg_overlaps, only: overlap_depth
  use sg_scene, only: scene_t
  use sg_sees, only: see_between
  use sg_solid_overlaps, only: solid_overlap_depth
  use sg_text, only: to_text
  implicit none
  private
  public :: overlaps_t, most_pairs, check_range, find_planar_overlaps, check_pair, check_hollows, report_overlaps
  public :: first_wide, lies_outside, complain_of_wide, complain_of_outside

  !> Share of the smaller radius by which two bodies may overlap at the start
  real(wp), parameter :: tolerated = 0.1_wp
  !> Overlaps below this share come from the digits that decks write
  real(wp), parameter :: rounding = 1e-4_wp
  !> Pairs that are named
  integer, parameter :: most_pairs = 5

  !> Pairs of bodies that overlap
  type :: overlaps_t
    !> How many
    integer :: n = 0
    !> The first ones: numbers of the bodies in the whole scene, depth [m], and depth over the smaller radius
    integer :: pair(2, most_pairs) = 0
    real(wp) :: depth(most_pairs) = 0, share(most_pairs) = 0
    !> Where ranks share the scene: the rank that looks, which notes the pairs that it owns
    integer :: rank = 0
  end type overlaps_t

contains

  !> In a periodic scene every grain lies within the period, and none would touch itself.
  subroutine check_range(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: period(2)
    integer :: axis, c, b

    period = [scene%period, scene%period_y]
    do axis = 1, 2
      if (.not. period(axis) > 0) cycle
      c = first_wide(scene, period(axis))
      if (c > 0) then
        call complain_of_wide(deck, int(scene%contactors%body(c)), scene%contactors%reach(c), period(axis), diagnostics)
        cycle
      end if
      do b = 1, scene%bodies%n
        if (lies_outside(scene, b, axis)) call complain_of_outside(deck, scene, b, axis, scene%bodies%position(axis, b), &
                                                                   diagnostics)
      end do
    end do
  end subroutine check_range

  !> First round contactor of a grain that is wider than a period; 0 when there is none.
  pure integer function first_wide(scene, period) result(contactor)
    type(scene_t), intent(in) :: scene !! scene with its bodies
    real(wp), intent(in) :: period !! [m]

    do contactor = 1, scene%contactors%n
      if (.not. scene%bodies%is_grain(scene%contactors%body(contactor)) .or. &
          .not. is_round(scene%contactors%kind(contactor))) cycle
      if (2*scene%contactors%reach(contactor) > period) return
    end do
    contactor = 0
  end function first_wide

  !> Does a grain lie outside of the period?
  pure logical function lies_outside(scene, body, axis)
    type(scene_t), intent(in) :: scene !! scene with its bodies
    integer, intent(in) :: body !! body of the scene
    integer, intent(in) :: axis !! 1 for x, 2 for y

    real(wp) :: period

    period = merge(scene%period, scene%period_y, axis == 1)
    associate (coordinate => scene%bodies%position(axis, body))
      lies_outside = scene%bodies%is_grain(body) .and. .not. (coordinate >= 0 .and. coordinate < period)
    end associate
  end function lies_outside

  !> Say that a grain is wider than the period.
  subroutine complain_of_wide(deck, number, reach, period, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: number !! number of the body in the whole scene
    real(wp), intent(in) :: reach !! radius of the grain [m]
    real(wp), intent(in) :: period !! [m]
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    call deck%complain(diagnostics, name_of(deck, number)//' is wider than the period: '//to_text(2*reach, 6)//' m against '// &
                       to_text(period, 6)//' m', deck%block_of_body(number))
  end subroutine complain_of_wide

  !> Say that a grain lies outside of the period.
  subroutine complain_of_outside(deck, scene, number, axis, coordinate, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its period
    integer, intent(in) :: number !! number of the body in the whole scene
    integer, intent(in) :: axis !! 1 for x, 2 for y
    real(wp), intent(in) :: coordinate !! of the grain along it [m]
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=*), parameter :: letters = 'xy'

    call deck%complain(diagnostics, name_of(deck, number)//' lies outside of the period: '//letters(axis:axis)//' = '// &
                       to_text(coordinate, 6)//' m is not within 0 to '// &
                       to_text(merge(scene%period, scene%period_y, axis == 1), 6)//' m', deck%block_of_body(number))
  end subroutine complain_of_outside

  !> Look for shapes of the plane that overlap: sweep along the longer side of the scene.
  subroutine find_planar_overlaps(scene, found)
    type(scene_t), intent(inout) :: scene !! whole scene, or the part of a rank with copies; its contactors are placed
    type(overlaps_t), intent(inout) :: found !! pairs found
    integer(i4), allocatable :: order(:)
    real(wp), allocatable :: low(:)
    real(wp) :: shift
    integer :: n, axis, i, j, k, turns

    n = scene%contactors%n
    if (n < 2 .or. size(scene%sees) == 0) return
    scene%bodies%middle(1:2, :) = scene%bodies%position
    scene%bodies%middle(3, :) = scene%bodies%angle
    call place_contactors(scene%contactors, scene%bodies%middle)
    associate (centre => scene%contactors%centre(:, :n), reach => scene%contactors%reach(:n))
      axis = maxloc(maxval(centre, 2) - minval(centre, 2), 1)
      low = centre(axis, :) - reach
      order = order_of(low)
      turns = merge(2, 1, axis == 1 .and. scene%period > 0)
      do i = 1, n
        do k = i + 1, i + turns*n - 1
          if (k > turns*n) exit
          j = modulo(k - 1, n) + 1
          shift = merge(scene%period, 0.0_wp, k > n)
          if (low(order(j)) + shift > centre(axis, order(i)) + reach(order(i))) exit
          if (j /= i) call check_pair(scene, int(order(i)), int(order(j)), found)
        end do
      end do
    end associate
  end subroutine find_planar_overlaps

  !> Note two shapes near each other that overlap; hollow shapes are held against all others by `check_hollows`.
  subroutine check_pair(scene, c1, c2, found)
    type(scene_t), intent(in) :: scene !! the scene, its contactors placed
    integer, intent(in) :: c1 !! one contactor
    integer, intent(in) :: c2 !! the other
    type(overlaps_t), intent(inout) :: found !! list to add to

    if (.not. is_hollow(scene, c1) .and. .not. is_hollow(scene, c2)) call weigh_pair(scene, c1, c2, found)
  end subroutine check_pair

  !> Note grains that are not within the hollow shapes that see them, as far as detection would draw them in: all outside of a
  !! hollow shape is its wall.
  subroutine check_hollows(scene, found)
    type(scene_t), intent(in) :: scene !! the scene, its contactors placed
    type(overlaps_t), intent(inout) :: found !! list to add to
    integer :: hollow, c

    do hollow = 1, scene%contactors%n
      if (.not. is_hollow(scene, hollow)) cycle
      do c = 1, scene%contactors%n
        if (.not. is_hollow(scene, c)) call weigh_pair(scene, hollow, c, found)
      end do
    end do
  end subroutine check_hollows

  !> Is a contactor a hollow disk or a hollow cylinder?
  pure logical function is_hollow(scene, c)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: c

    is_hollow = any(scene%contactors%kind(c) == [kind_hollow, kind_hollow_cylinder])
  end function is_hollow

  !> Note a pair that overlaps, if at least one of the two is a grain and they see each other.
  subroutine weigh_pair(scene, c1, c2, found)
    type(scene_t), intent(in) :: scene !! the scene, its contactors placed
    integer, intent(in) :: c1 !! one contactor
    integer, intent(in) :: c2 !! the other
    type(overlaps_t), intent(inout) :: found !! list to add to
    real(wp) :: distance(3), shift(3), radius, depth
    integer :: b1, b2, k

    associate (contactors => scene%contactors)
      b1 = contactors%body(c1)
      b2 = contactors%body(c2)
      if (b1 == b2 .or. .not. (scene%bodies%is_grain(b1) .or. scene%bodies%is_grain(b2))) return
      if (allocated(scene%bodies%home)) then
        if (owner_of(scene%bodies%home([b1, b2])) /= found%rank) return
      end if
      distance = 0
      do k = 1, scene%dimension
        distance(k) = contactors%centre(k, c2) - contactors%centre(k, c1)
      end do
      shift = 0
      if (scene%period > 0) shift(1) = -scene%period*anint(distance(1)/scene%period)
      if (scene%period_y > 0) shift(2) = -scene%period_y*anint(distance(2)/scene%period_y)
      distance = distance + shift
      if (is_hollow(scene, c1) .or. is_hollow(scene, c2)) then
        ! Two cells of the detection: what lies farther away is not drawn in.
        if (any(abs(distance) > 4*max(contactors%reach(c1), contactors%reach(c2)))) return
      else
        if (any(abs(distance) > contactors%reach(c1) + contactors%reach(c2))) return
        if (scene%dimension == 3 .and. sum(distance**2) > (contactors%reach(c1) + contactors%reach(c2))**2) return
      end if
      if (see_between(scene, c1, c2) == 0) return
      radius = min(merge(contactors%reach(c1), huge(1.0_wp), scene%bodies%is_grain(b1)), &
                   merge(contactors%reach(c2), huge(1.0_wp), scene%bodies%is_grain(b2)))
      if (scene%dimension == 2) then
        depth = overlap_depth(contactors, c1, c2, shift(1))
      else
        depth = solid_overlap_depth(contactors, c1, c2, shift)
      end if
      call note_pair(scene, b1, b2, depth, depth/radius, found)
    end associate
  end subroutine weigh_pair

  !> Note two bodies whose shapes overlap, if by more than rounding.
  pure subroutine note_pair(scene, b1, b2, depth, share, found)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b1, b2
    real(wp), intent(in) :: depth, share
    type(overlaps_t), intent(inout) :: found

    if (share <= rounding) return
    found%n = found%n + 1
    if (found%n > most_pairs) return
    found%pair(:, found%n) = [b1, b2]
    if (allocated(scene%bodies%id)) found%pair(:, found%n) = scene%bodies%id([b1, b2])
    found%depth(found%n) = depth
    found%share(found%n) = share
  end subroutine note_pair

  !> Report pairs of bodies whose shapes overlap: by much a mistake, by little a warning; and how many pairs there are where not
  !! all are listed.
  subroutine report_overlaps(deck, found, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(overlaps_t), intent(in) :: found !! pairs found
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to
    character(len=:), allocatable :: message
    integer :: i

    do i = 1, min(found%n, most_pairs)
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
end module sg_start_checks
