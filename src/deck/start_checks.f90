!> Checks of the state at the start: grains within the period, shapes that do not overlap.
module sg_start_checks
  use sg_blocks, only: deck_t
  use sg_contactors, only: is_round, place_contactors
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_ordering, only: order_of
  use sg_overlaps, only: overlap_depth
  use sg_scene, only: scene_t
  use sg_sees, only: see_between
  use sg_solid_overlaps, only: solid_overlap_depth
  use sg_text, only: to_text
  implicit none
  private
  public :: check_range, check_overlaps, check_pair, warn_of_more

  !> Share of the smaller radius by which two bodies may overlap at the start
  real(wp), parameter :: tolerated = 0.1_wp
  !> Overlaps below this share come from the digits that decks write
  real(wp), parameter :: rounding = 1e-4_wp
  !> Pairs that are named
  integer, parameter :: most_pairs = 5

contains

  !> In a periodic scene every grain lies within the period, and none would touch itself.
  subroutine check_range(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    if (scene%period > 0) call check_axis(deck, scene, 1, scene%period, diagnostics)
    if (scene%period_y > 0) call check_axis(deck, scene, 2, scene%period_y, diagnostics)
  end subroutine check_range

  !> The same along one axis.
  subroutine check_axis(deck, scene, axis, period, diagnostics)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    real(wp), intent(in) :: period
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=*), parameter :: letters = 'xy'
    integer :: i

    do i = 1, scene%contactors%n
      if (.not. scene%bodies%is_grain(scene%contactors%body(i)) .or. .not. is_round(scene%contactors%kind(i))) cycle
      if (2*scene%contactors%reach(i) <= period) cycle
      call deck%complain(diagnostics, name_of(scene, int(scene%contactors%body(i)))//' is wider than the period: '// &
                         to_text(2*scene%contactors%reach(i), 6)//' m against '//to_text(period, 6)//' m', &
                         deck%block_of_body(int(scene%contactors%body(i))))
      return
    end do
    do i = 1, scene%bodies%n
      if (.not. scene%bodies%is_grain(i)) cycle
      if (scene%bodies%position(axis, i) >= 0 .and. scene%bodies%position(axis, i) < period) cycle
      call deck%complain(diagnostics, name_of(scene, i)//' lies outside of the period: '//letters(axis:axis)//' = '// &
                         to_text(scene%bodies%position(axis, i), 6)//' m is not within 0 to '//to_text(period, 6)//' m', &
                         deck%block_of_body(i))
    end do
  end subroutine check_axis

  !> Look for shapes that overlap: sweep along the longer side of the scene.
  subroutine check_overlaps(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! whole scene; its contactors are placed
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    integer(i4), allocatable :: order(:)
    real(wp), allocatable :: low(:)
    real(wp) :: shift
    integer :: n, axis, i, j, k, turns, n_pairs

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
      n_pairs = 0
      do i = 1, n
        do k = i + 1, i + turns*n - 1
          if (k > turns*n) exit
          j = modulo(k - 1, n) + 1
          shift = merge(scene%period, 0.0_wp, k > n)
          if (low(order(j)) + shift > centre(axis, order(i)) + reach(order(i))) exit
          if (j /= i) call check_pair(deck, scene, int(order(i)), int(order(j)), n_pairs, diagnostics)
        end do
      end do
    end associate
    call warn_of_more(deck, n_pairs, diagnostics)
  end subroutine check_overlaps

  !> Say how many pairs overlap where not all are listed.
  subroutine warn_of_more(deck, n_pairs, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: n_pairs !! pairs found
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to

    if (n_pairs > most_pairs) call deck%warn(diagnostics, to_text(n_pairs)//' pairs overlap at the start, which are not all '// &
                                             'listed', deck%block_of('scene'))
  end subroutine warn_of_more

  !> Report a pair that overlaps, if at least one of the two is a grain and they see each other.
  subroutine check_pair(deck, scene, c1, c2, n_pairs, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! the scene, its contactors placed
    integer, intent(in) :: c1 !! one contactor
    integer, intent(in) :: c2 !! the other
    integer, intent(inout) :: n_pairs !! pairs found
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to
    real(wp) :: distance(3), shift(3), radius, depth
    integer :: b1, b2, k

    associate (contactors => scene%contactors)
      b1 = contactors%body(c1)
      b2 = contactors%body(c2)
      if (b1 == b2 .or. .not. (scene%bodies%is_grain(b1) .or. scene%bodies%is_grain(b2))) return
      distance = 0
      do k = 1, scene%dimension
        distance(k) = contactors%centre(k, c2) - contactors%centre(k, c1)
      end do
      shift = 0
      if (scene%period > 0) shift(1) = -scene%period*anint(distance(1)/scene%period)
      if (scene%period_y > 0) shift(2) = -scene%period_y*anint(distance(2)/scene%period_y)
      distance = distance + shift
      if (any(abs(distance) > contactors%reach(c1) + contactors%reach(c2))) return
      if (scene%dimension == 3 .and. sum(distance**2) > (contactors%reach(c1) + contactors%reach(c2))**2) return
      if (see_between(scene, c1, c2) == 0) return
      radius = min(merge(contactors%reach(c1), huge(1.0_wp), scene%bodies%is_grain(b1)), &
                   merge(contactors%reach(c2), huge(1.0_wp), scene%bodies%is_grain(b2)))
      if (scene%dimension == 2) then
        depth = overlap_depth(contactors, c1, c2, shift(1))
      else
        depth = solid_overlap_depth(contactors, c1, c2, shift)
      end if
      call report_overlap(deck, scene, b1, b2, depth, radius, n_pairs, diagnostics)
    end associate
  end subroutine check_pair

  !> Report two bodies whose shapes overlap: by much a mistake, by little a warning, by rounding nothing.
  subroutine report_overlap(deck, scene, b1, b2, depth, radius, n_pairs, diagnostics)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b1, b2
    real(wp), intent(in) :: depth, radius
    integer, intent(inout) :: n_pairs
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: message
    real(wp) :: share

    share = depth/radius
    if (share <= rounding) return
    n_pairs = n_pairs + 1
    if (n_pairs > most_pairs) return
    message = name_of(scene, min(b1, b2))//' and '//name_of(scene, max(b1, b2))// &
              ' overlap at the start by '//to_text(depth, 3)//' m, '//to_text(nint(100*share))//' % of the smaller radius'
    if (share > tolerated) then
      call deck%complain(diagnostics, message, deck%block_of_body(max(b1, b2)))
    else
      call deck%warn(diagnostics, message, deck%block_of_body(max(b1, b2)))
    end if
  end subroutine report_overlap

  !> A body for messages: its name, or its number.
  function name_of(scene, body) result(name)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body
    character(len=:), allocatable :: name

    name = 'body '//to_text(body)
    if (.not. allocated(scene%names)) return
    if (scene%names(body)%s /= '') name = '"'//scene%names(body)%s//'"'
  end function name_of
end module sg_start_checks
