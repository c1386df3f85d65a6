!> What a list of neighbours allows to each body, and when that is used up (doc/theory/detection.md, "Broad phase").
module sg_list_margins
  use sg_cell_search, only: has_moved_in_cell, turned_angle
  use sg_contactors, only: kind_point
  use sg_kinds, only: wp
  use sg_near, only: turning_arm
  use sg_neighbour_list, only: neighbours_t
  use sg_scene, only: scene_t
  use sg_sees, only: alert_of, follows_motion
  use sg_shape_kinds, only: is_bounding
  implicit none
  private
  public :: choose_margins, fitting_skin, neighbours_are_stale

contains

  !> Has something moved so far, or is so fast, that the list no longer holds all that may touch?
  pure logical function neighbours_are_stale(pairs, scene) result(stale)
    type(neighbours_t), intent(in) :: pairs !! list to look at
    type(scene_t), intent(in) :: scene !! its bodies' `middle` and free velocities count
    real(wp) :: moved, arm, widest, least
    integer :: c, b

    stale = .not. allocated(pairs%built)
    if (stale) return
    widest = widest_following(scene, pairs%way)
    if (scene%cell%is_on) then
      stale = widest > widest_following(scene, pairs%listed_way)
      if (.not. stale) stale = has_moved_in_cell(scene, pairs%built, pairs%skin)
      return
    end if
    least = least_sought(scene, pairs, widest)
    associate (contactors => scene%contactors, middle => scene%bodies%middle)
      do c = 1, contactors%n
        if (contactors%kind(c) == kind_point) cycle
        b = contactors%body(c)
        moved = (middle(1, b) - pairs%built(1, b))**2 + (middle(2, b) - pairs%built(2, b))**2
        if (contactors%dimension == 3) moved = moved + (middle(3, b) - pairs%built(3, b))**2
        moved = sqrt(moved)
        if (scene%bodies%n_velocity > contactors%dimension) then
          arm = turning_arm(contactors, c)
          if (arm > 0) moved = moved + turned_angle(middle(:, b), pairs%built(:, b))*arm
        end if
        stale = moved > pairs%skin/2 .or. moved + sought(pairs, c, least, widest) > pairs%margin(b)
        if (stale) return
      end do
    end associate
  end function neighbours_are_stale

  !> How far about a shape contacts are sought [m]; of two together no less than the alert distance of their pair, where it follows
  !! the motion.
  pure real(wp) function sought(pairs, c, least, widest)
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: c
    real(wp), intent(in) :: least !! how far about any shape [m]
    real(wp), intent(in) :: widest !! alert distance of all pairs [m]

    sought = least
    ! The other one of a pair may be at rest.
    if (pairs%is_reduced .and. pairs%is_by_pair) sought = min(widest, max(least, own_way(pairs, c)))
  end function sought

  !> How far contacts are sought about shapes that do not move [m].
  pure real(wp) function least_sought(scene, pairs, widest) result(least)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    real(wp), intent(in) :: widest !! alert distance of all pairs [m]

    least = widest/2
    if (pairs%is_reduced .and. widest > 0) least = min(least, maxval(pairs%least, follows_motion(scene%sees))/2)
  end function least_sought

  !> Twice the way of a shape in the step, as contacts are sought by it [m].
  pure real(wp) function own_way(pairs, c) result(way)
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: c

    way = pairs%motion(1, c)**2 + pairs%motion(2, c)**2
    if (size(pairs%motion, 1) == 4) way = way + pairs%motion(3, c)**2
    way = sqrt(way) + pairs%motion(size(pairs%motion, 1), c)
  end function own_way

  !> Widest alert distance of the lines that follow the motion [m], zero where there is none.
  pure real(wp) function widest_following(scene, way) result(widest)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: way !! by which two shapes may come nearer to each other [m]

    widest = max(0.0_wp, maxval(alert_of(scene%sees, way), follows_motion(scene%sees)))
  end function widest_following

  !> Margins of a new list: what is sought, twice for what becomes faster, and some steps of each body's motion. Where no alert
  !! distance follows the motion, all bodies have the same.
  pure subroutine choose_margins(scene, pairs, skin, margin)
    type(scene_t), intent(in) :: scene !! scene with its `middle` configuration and free velocities
    type(neighbours_t), intent(inout) :: pairs !! list that is about to be made; its skin and way are set
    real(wp), intent(in) :: skin !! how far shapes may move at most, two together [m]
    real(wp), allocatable, intent(out) :: margin(:) !! of each body [m]
    real(wp), parameter :: double_steps = 4, least_share = 0.3_wp
    real(wp) :: widest, least, way
    integer :: c

    pairs%skin = skin
    pairs%listed_way = 2*pairs%way
    widest = widest_following(scene, pairs%listed_way)
    allocate (margin(scene%bodies%n), source=(skin + widest)/2)
    if (.not. (pairs%is_reduced .and. pairs%is_by_pair)) return
    margin = 0
    least = least_sought(scene, pairs, widest)
    do c = 1, scene%contactors%n
      associate (b => scene%contactors%body(c))
        way = double_steps*own_way(pairs, c)
        margin(b) = max(margin(b), min(widest, 2*sought(pairs, c, least, widest)) + &
                        min(skin/2, max(least_share*skin/2, way)))
      end associate
    end do
  end subroutine choose_margins

  !> A skin for the present motion [m], 0 where there is nothing: lists that last long cost pairs that never touch, short-lived
  !! ones cost searches.
  !!
  !! Bodies move from their position to `middle` in half a substep, so the fastest crosses half the skin in about eight steps.
  pure real(wp) function fitting_skin(scene, substeps, has_copies) result(skin)
    type(scene_t), intent(in) :: scene !! scene with its `middle` configuration
    integer, intent(in) :: substeps !! from one detection to the next
    logical, intent(in) :: has_copies !! does the skin decide how far grains are copied to other ranks?
    ! In mean radii. Copies reach as far as several skins.
    real(wp), parameter :: thinnest = 0.1_wp, thickest = 1.5_wp, thickest_with_copies = 1
    real(wp) :: reach, step

    skin = 0
    if (scene%contactors%n == 0) return
    reach = common_reach(scene)
    associate (bodies => scene%bodies)
      associate (n => bodies%dimension)
        step = 2*sqrt(maxval(sum((bodies%middle(:n, :) - bodies%position)**2, 1)))
      end associate
    end associate
    skin = max(thinnest*reach, min(merge(thickest_with_copies, thickest, has_copies)*reach, 16*real(substeps, wp)*step))
  end function fitting_skin

  !> Mean reach of the shapes that bound no others [m], or of all where there is nothing else.
  pure real(wp) function common_reach(scene) result(reach)
    type(scene_t), intent(in) :: scene
    logical, allocatable :: is_common(:)

    associate (contactors => scene%contactors)
      associate (kind => contactors%kind(:contactors%n), all_reach => contactors%reach(:contactors%n))
        is_common = .not. is_bounding(kind) .and. kind /= kind_point
        if (any(is_common)) then
          reach = exp(sum(log(all_reach), is_common)/real(count(is_common), wp))
        else
          reach = sum(all_reach)/real(max(1, count(kind /= kind_point)), wp)
        end if
      end associate
    end associate
  end function common_reach
end module sg_list_margins
