!> Networks of links: points of a scene that see tables bring together, linked where they are near at the start.
!!
!! Every rank notes the points of all bodies, whoever keeps these, and so makes the same list of links.
module sg_link_network
  use sg_kinds, only: wp, i4, i8
  use sg_links, only: add_link
  use sg_lists, only: reserve
  use sg_ordering, only: order_of
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t, see_t
  use sg_sees, only: links_points
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: points_t, link_by_distance, line_between, distance_of, place_of_point, nearest_image

  !> All points of a scene where they are at the start
  type :: points_t
    !> Number of points
    integer :: n = 0
    !> Contactor and body of each, by their numbers in the whole scene, and index of its colour, shape (3, n)
    integer(i4), allocatable :: tag(:, :)
    !> Where it is at the start [m], shape (3, n); in the plane the third is zero
    real(wp), allocatable :: place(:, :)
  contains
    procedure :: note => points_note
  end type points_t

contains

  !> Note a point.
  subroutine points_note(self, contactor, body, colour, place)
    class(points_t), intent(inout) :: self
    integer, intent(in) :: contactor !! its number in the whole scene
    integer, intent(in) :: body !! number of its body in the whole scene
    integer, intent(in) :: colour !! index of its colour
    real(wp), intent(in) :: place(3) !! where it is [m]

    self%n = self%n + 1
    call reserve(self%tag, 3, self%n)
    call reserve(self%place, 3, self%n)
    self%tag(:, self%n) = int([contactor, body, colour], i4)
    self%place(:, self%n) = place
  end subroutine points_note

  !> Where a point of a body is in the world [m].
  pure function place_of_point(scene, body, shift) result(place)
    type(scene_t), intent(in) :: scene !! scene at its start, in which everything still may turn
    integer, intent(in) :: body !! body of the scene
    real(wp), intent(in) :: shift(:) !! the point in the body's frame [m]
    real(wp) :: place(3)

    place = 0
    if (scene%dimension == 3) then
      place = scene%bodies%position(:, body) + turned_by(scene%bodies%orientation(:, body), shift)
    else
      associate (angle => scene%bodies%angle(body))
        place(:2) = scene%bodies%position(:, body) + [cos(angle)*shift(1) - sin(angle)*shift(2), &
                                                      sin(angle)*shift(1) + cos(angle)*shift(2)]
      end associate
    end if
  end function place_of_point

  !> Link all points of different bodies that a line of the see tables brings together and that are no farther apart than its
  !! alert distance; in a periodic scene with the nearest image.
  subroutine link_by_distance(scene, points, linked)
    type(scene_t), intent(inout) :: scene !! scene with laws and see tables; gets links
    type(points_t), intent(in) :: points !! its points
    integer, intent(in), optional :: linked !! points at the front of the list that have their links to each other; default: none
    integer(i4), allocatable :: order(:), pair(:, :)
    integer :: axis, i, j, n, n_linked
    real(wp) :: widest

    n_linked = 0
    if (present(linked)) n_linked = linked
    if (points%n < 2 .or. points%n == n_linked .or. .not. any(links_points(scene%sees))) return
    widest = maxval(scene%sees%alert, links_points(scene%sees))
    axis = longest_axis(scene, points)
    order = order_of(points%place(axis, :points%n))
    n = 0
    do i = 1, points%n
      do j = i + 1, points%n
        if (points%place(axis, order(j)) - points%place(axis, order(i)) > widest) exit
        if (maxval(order([i, j])) <= n_linked) cycle
        if (line_between(scene, points, int(order([i, j]))) == 0) cycle
        n = n + 1
        call reserve(pair, 2, n)
        pair(:, n) = [max(order(i), order(j)), min(order(i), order(j))]
      end do
    end do
    if (n > 0) call add_pairs(scene, points, pair(:, :n))
  end subroutine link_by_distance

  !> Of the axes that are not periodic that along which points reach farthest.
  pure integer function longest_axis(scene, points) result(axis)
    type(scene_t), intent(in) :: scene
    type(points_t), intent(in) :: points
    real(wp) :: extent(3)

    extent = maxval(points%place(:, :points%n), 2) - minval(points%place(:, :points%n), 2)
    if (scene%period > 0) extent(1) = -1
    if (scene%period_y > 0) extent(2) = -1
    if (scene%dimension == 2) extent(3) = -2
    axis = maxloc(extent, 1)
  end function longest_axis

  !> Line of the see tables that links two points; 0 where none does.
  pure integer function line_between(scene, points, pair, anywhere) result(line)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    type(points_t), intent(in) :: points !! its points
    integer, intent(in) :: pair(2) !! two of them
    logical, intent(in), optional :: anywhere !! at any distance?
    integer :: colour(2)
    logical :: is_near

    colour = points%tag(3, pair)
    if (points%tag(2, pair(1)) /= points%tag(2, pair(2))) then
      do line = 1, size(scene%sees)
        associate (see => scene%sees(line))
          if (.not. links_points(see)) cycle
          if (.not. (fits(see, colour) .or. fits(see, colour([2, 1])))) cycle
          is_near = present(anywhere)
          if (.not. is_near) is_near = distance_of(scene, points, pair) <= see%alert
          if (is_near) return
        end associate
      end do
    end if
    line = 0
  contains
    pure logical function fits(see, colour)
      type(see_t), intent(in) :: see
      integer, intent(in) :: colour(2)

      fits = any(see%candidate_colour == [0, colour(1)]) .and. any(see%antagonist_colour == [0, colour(2)])
    end function fits
  end function line_between

  !> Distance of two points, the second in its nearest image [m].
  pure real(wp) function distance_of(scene, points, pair) result(distance)
    type(scene_t), intent(in) :: scene !! scene with its periods
    type(points_t), intent(in) :: points !! its points
    integer, intent(in) :: pair(2) !! two of them
    integer :: image(2)
    real(wp) :: between(3)

    between = points%place(:, pair(1)) - points%place(:, pair(2))
    image = nearest_image(scene, between)
    distance = norm2(between - [scene%period, scene%period_y, 0.0_wp]*real([image, 0], wp))
  end function distance_of

  !> Periods in x and y by which a point is to be moved to be nearest to another one.
  pure function nearest_image(scene, between) result(image)
    type(scene_t), intent(in) :: scene !! scene with its periods
    real(wp), intent(in) :: between(3) !! way from it to the other one [m]
    integer :: image(2)

    image = 0
    if (scene%period > 0) image(1) = nint(between(1)/scene%period)
    if (scene%period_y > 0) image(2) = nint(between(2)/scene%period_y)
  end function nearest_image

  !> Add links between pairs of points, by the numbers of their contactors.
  subroutine add_pairs(scene, points, pair)
    type(scene_t), intent(inout) :: scene
    type(points_t), intent(in) :: points
    integer(i4), intent(in) :: pair(:, :)
    integer(i8) :: keys(size(pair, 2))
    integer(i4), allocatable :: order(:)
    integer :: k, ends(2), line

    keys = int(pair(1, :), i8)*int(points%n + 1, i8) + int(pair(2, :), i8)
    order = sort_permutation(keys)
    do k = 1, size(order)
      ends = pair(:, order(k))
      line = line_between(scene, points, ends)
      call add_link(scene%links, int(points%tag(1, ends)), &
                    nearest_image(scene, points%place(:, ends(1)) - points%place(:, ends(2))), scene%sees(line)%law, &
                    distance_of(scene, points, ends), 0.0_wp, 0.0_wp)
    end do
  end subroutine add_pairs
end module sg_link_network
