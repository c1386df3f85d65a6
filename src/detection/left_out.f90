!> Contacts that a reduced alert distance has left out of a step, and that its solution may close (doc/theory/detection.md, "Alert
!! distance").
module sg_left_out
  use sg_contactors, only: place_corners
  use sg_contacts, only: contacts_t
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4
  use sg_narrow_phase, only: are_found_apart, path_of_pair, touch_in_plane, touch_in_space
  use sg_neighbour_list, only: neighbours_t, offset_of
  use sg_pair_alert, only: alert_of_pair, closing_way, find_free_motion, find_motion, least_reduced, times
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t
  use sg_shape_kinds, only: is_bounding
  use sg_touch, only: touch_t
  use sg_touch_space, only: touch_space_t
  use sg_vectors, only: cross
  use sg_way_of_step, only: way_of_solution
  implicit none
  private
  public :: has_left_out, widen_thrown

  !> Multiple of the change of its motion up to which pairs of a shape are sought when a step is solved again
  real(wp), parameter :: times_change = 2

contains

  !> May the solution close a contact that was left out, but is within the whole alert distance?
  !!
  !! Contacts are sought up to twice the way of a pair with its free velocities, or farther. So only a pair of which a body has
  !! changed its velocity much needs a look, and one known to be apart by more than its way with the solution none. Of the rest
  !! the narrow phase finds the points within that way. One that the step does not have, and whose gap at the end of the step would
  !! be negative, was left out; any other bears nothing, so the solution is that of all contacts.
  logical function has_left_out(scene, pairs, history, contacts, velocity, slot_of, turns)
    type(scene_t), intent(inout) :: scene !! scene, its contactors placed in its detection or since; corners of more polygons may be
    type(neighbours_t), intent(inout) :: pairs !! list of neighbours with reduced alert distances; its motion may be set
    type(history_t), intent(inout) :: history !! pairs and contacts of the detection; what is tried first may change
    type(contacts_t), intent(in) :: contacts !! contacts of the detection
    real(wp), intent(in), contiguous :: velocity(:, :) !! records of the bodies of the solution, which begin with velocity and spin
    integer(i4), intent(in), contiguous :: slot_of(:) !! slot of each body
    logical, intent(in) :: turns !! do the records have a spin that moves points towards others?
    logical, allocatable :: is_thrown(:)
    real(wp), allocatable :: motion(:, :)
    real(wp) :: way, least
    integer(i4) :: c, a
    integer :: p

    has_left_out = .false.
    way = way_of_solution(scene, velocity, slot_of, turns, pairs%time_step)
    least = least_reduced(scene, pairs)
    if (.not. way > least) return
    if (.not. pairs%is_by_pair) call find_free_motion(scene, pairs)
    call find_motion(scene, velocity, turns, pairs%time_step, motion, slot_of)
    call find_thrown(pairs, motion, (1 - 1/times)/2*least, is_thrown)
    if (.not. any(is_thrown)) return
    do p = 1, pairs%n_near
      c = pairs%contactor(1, p)
      a = pairs%contactor(2, p)
      if (.not. (is_thrown(c) .or. is_thrown(a))) cycle
      way = closing_way(motion, c, a)
      ! As far as this all were looked at.
      if (way <= pairs%least(pairs%see(p))) cycle
      way = min(way, pairs%alert(pairs%see(p)))
      if (way <= alert_of_pair(pairs, p)) cycle
      associate (first => history%first(p), last => history%first(p + 1) - 1, body => scene%contactors%body)
        if (last < first .and. are_clear(scene, pairs, history, p, way)) cycle
        has_left_out = closes_another(scene, pairs, history, p, way, velocity(:, slot_of(body(c))), velocity(:, slot_of(body(a))), &
                                      turns, contacts%feature(first:last))
      end associate
      if (has_left_out) return
    end do
  end function has_left_out

  !> Let pairs of shapes whose motion the solution has changed be sought farther, for the step to be solved again.
  subroutine widen_thrown(scene, pairs, velocity, slot_of, turns)
    type(scene_t), intent(in) :: scene !! scene with its free velocities
    type(neighbours_t), intent(inout) :: pairs !! list of neighbours with reduced alert distances; its motion is set
    real(wp), intent(in), contiguous :: velocity(:, :) !! records of the bodies of the solution, as for `has_left_out`
    integer(i4), intent(in), contiguous :: slot_of(:) !! slot of each body
    logical, intent(in) :: turns !! as for `has_left_out`
    real(wp), allocatable :: motion(:, :)
    real(wp) :: change
    integer :: c, n

    if (.not. pairs%is_by_pair) call find_free_motion(scene, pairs)
    pairs%is_by_pair = .true.
    call find_motion(scene, velocity, turns, pairs%time_step, motion, slot_of)
    n = scene%dimension
    do c = 1, size(motion, 2)
      change = norm2(motion(:n, c) - pairs%motion(:n, c)/times) + max(0.0_wp, motion(n + 1, c) - pairs%motion(n + 1, c)/times)
      pairs%motion(n + 1, c) = pairs%motion(n + 1, c) + times_change*change
    end do
  end subroutine widen_thrown

  !> Has the motion of a shape changed so much that its pairs may come nearer to each other than was looked?
  !!
  !! Of a pair whose way is w with free velocities, at least max(l, 2 w) was looked at: w + l/2 or more, l/4 for each of the two.
  pure subroutine find_thrown(pairs, motion, limit, is_thrown)
    type(neighbours_t), intent(in) :: pairs
    real(wp), intent(in) :: motion(:, :) !! with the solution [m]
    real(wp), intent(in) :: limit !! change that one shape of a pair may have [m]
    logical, allocatable, intent(out) :: is_thrown(:)
    real(wp) :: square
    integer :: c, n

    n = size(motion, 1)
    allocate (is_thrown(size(motion, 2)))
    do c = 1, size(motion, 2)
      ! Component by component: differences of unknown length go through memory that is allocated.
      square = (motion(1, c) - pairs%motion(1, c)/times)**2 + (motion(2, c) - pairs%motion(2, c)/times)**2
      if (n == 4) square = square + (motion(3, c) - pairs%motion(3, c)/times)**2
      is_thrown(c) = sqrt(square) + max(0.0_wp, motion(n, c) - pairs%motion(n, c)/times) > limit
    end do
  end subroutine find_thrown

  !> Are two shapes known to be farther from each other than a distance? By the spheres about them, or since they were found so.
  pure logical function are_clear(scene, pairs, history, p, distance)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: distance
    real(wp) :: offset(3), x, y, z

    are_clear = .false.
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      if (is_bounding(contactors%kind(a))) return
      offset = offset_of(scene, pairs, p)
      ! Component by component: differences of unknown length go through memory that is allocated.
      x = contactors%centre(1, c) - contactors%centre(1, a) - offset(1)
      y = contactors%centre(2, c) - contactors%centre(2, a) - offset(2)
      z = 0
      if (scene%dimension == 3) z = contactors%centre(3, c) - contactors%centre(3, a) - offset(3)
      are_clear = sqrt(x**2 + y**2 + z**2) > contactors%reach(c) + contactors%reach(a) + distance .or. &
                  are_found_apart(scene, history, p, c, a, path_of_pair(contactors, c, a), distance)
    end associate
  end function are_clear

  !> Does a solution close a point of a pair that is not among its contacts?
  logical function closes_another(scene, pairs, history, p, way, velocity_c, velocity_a, turns, known) result(closes)
    type(scene_t), intent(inout) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: way !! gap from which no point can close [m]
    real(wp), intent(in) :: velocity_c(:), velocity_a(:) !! velocities and spins of the solution, of candidate and antagonist
    logical, intent(in) :: turns
    integer(i4), intent(in) :: known(:) !! features of the contacts
    type(touch_t) :: touch
    type(touch_space_t) :: touch_space
    real(wp) :: path
    integer :: i

    closes = .false.
    path = path_of_pair(scene%contactors, pairs%contactor(1, p), pairs%contactor(2, p))
    if (scene%dimension == 2) then
      call place_corners(scene%contactors, pairs%contactor(1, p))
      call place_corners(scene%contactors, pairs%contactor(2, p))
      call touch_in_plane(scene, pairs, history, p, way, path, touch)
      do i = 1, touch%n
        closes = closes .or. closes_at(touch%feature(i), touch%point(:, i), touch%normal(:, i), touch%gap(i))
      end do
    else
      call touch_in_space(scene, pairs, history, p, way, path, touch_space)
      do i = 1, touch_space%n
        closes = closes .or. closes_at(touch_space%feature(i), touch_space%point(:, i), touch_space%normal(:, i), &
                                       touch_space%gap(i))
      end do
    end if
  contains
    logical function closes_at(feature, point, normal, gap) result(closes)
      integer(i4), intent(in) :: feature
      real(wp), intent(in) :: point(:), normal(:), gap
      real(wp) :: offset(3), speed

      closes = .false.
      if (any(known == feature)) return
      offset = offset_of(scene, pairs, p)
      associate (c => scene%contactors%body(pairs%contactor(1, p)), a => scene%contactors%body(pairs%contactor(2, p)), &
                 n => scene%dimension)
        speed = dot_product(normal, velocity_c(:n) - velocity_a(:n))
        if (turns) speed = speed + speed_by_turn(scene%bodies%middle(:, c), velocity_c(n + 1:), point + gap/2*normal, normal) - &
                           speed_by_turn(scene%bodies%middle(:, a), velocity_a(n + 1:), point - gap/2*normal - offset(:n), normal)
      end associate
      closes = gap + pairs%time_step*speed < 0
    end function closes_at
  end function closes_another

  !> Speed of a point of a body along a direction by the body's spin [m/s].
  pure real(wp) function speed_by_turn(middle, spin, point, direction) result(speed)
    real(wp), intent(in) :: middle(:) !! configuration of the body
    real(wp), intent(in) :: spin(:) !! its spin, in space about its principal axes, and perhaps more behind it [rad/s]
    real(wp), intent(in) :: point(:) !! [m]
    real(wp), intent(in) :: direction(:) !! unit vector

    if (size(point) == 2) then
      speed = spin(1)*((point(1) - middle(1))*direction(2) - (point(2) - middle(2))*direction(1))
    else
      speed = dot_product(cross(turned_by(middle(4:7), spin(:3)), point - middle(:3)), direction)
    end if
  end function speed_by_turn
end module sg_left_out
