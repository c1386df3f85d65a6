!> Narrow phase of polygons on random pairs: symmetry, brute force, and whatever comes.
!!
!! Lengths are of order 1; `tight` allows some tens of roundings of such lengths.
program test_touch_random
  use harness, only: tests_t
  use polygon_touch, only: touching, touching_wall
  use sg_kinds, only: wp, i4, pi
  use sg_random, only: random_t
  use sg_touch, only: touch_t
  use sg_touch_convex, only: vertex_unit
  use sg_touch_disk_polygon, only: touch_disk_polygon
  implicit none
  real(wp), parameter :: tight = 1e-13_wp, zero(2) = [0.0_wp, 0.0_wp]
  type(tests_t) :: t

  call test_symmetry()
  call test_kept()
  call test_against_brute_force()
  call test_wall_against_axis()
  call test_fuzz()
  call t%finish()

contains

  !> Swapping the bodies turns the normal; moving both moves the point and leaves the gap.
  subroutine test_symmetry()
    type(random_t) :: random
    type(touch_t) :: touch, swapped, there
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: angle, shift(2)
    integer :: i, found

    call random%seed(3)
    found = 0
    do i = 1, 2000
      call random_pair(random, a, c)
      touch = touching(c, a, 0.2_wp)
      swapped = touching(a, c, 0.2_wp)
      angle = random%uniform(0.0_wp, 2*pi)
      shift = [random%uniform(-9.0_wp, 9.0_wp), random%uniform(-9.0_wp, 9.0_wp)]
      there = touching(turned(c, angle, shift), turned(a, angle, shift), 0.2_wp)
      if (touch%n /= swapped%n .or. touch%n /= there%n) then
        call t%check(.false., 'as many points after a swap or a motion')
        cycle
      end if
      if (touch%n == 0) cycle
      found = found + 1
      call t%near(minval(touch%gap(:touch%n)), minval(swapped%gap(:touch%n)), 1e-12_wp, 'same gap after a swap')
      call t%near(norm2(touch%normal(:, 1) + swapped%normal(:, minloc(norm2(swapped%point(:, :touch%n) &
                  - spread(touch%point(:, 1), 2, touch%n), 1), 1))), 0.0_wp, 1e-10_wp, 'opposite normal after a swap')
      call t%near(maxval(abs(touch%gap - there%gap)), 0.0_wp, 1e-12_wp, 'same gaps after a motion')
      call t%near(norm2(there%point(:, :touch%n) - turned(touch%point(:, :touch%n), angle, shift)), 0.0_wp, 1e-11_wp, &
                  'points move along')
      call t%near(norm2(there%normal - turned(touch%normal, angle, zero)), 0.0_wp, 1e-10_wp, 'normals turn along')
      call t%check(all(touch%feature == there%feature), 'keys stay')
    end do
    call t%check(found > 500, 'many pairs are near enough')
  end subroutine test_symmetry

  !> Whatever face is kept of a pair, the right one, a wrong one or none of its faces, with any vertex, the points are the same bit
  !! for bit; the face found is kept; and mirrored pairs have mirrored contacts.
  subroutine test_kept()
    type(random_t) :: random
    type(touch_t) :: touch, other
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: alert
    integer(i4) :: kept, again, found
    integer :: i, different, moved_on, touching_pairs, mirrored

    call random%seed(17)
    different = 0
    moved_on = 0
    mirrored = 0
    touching_pairs = 0
    do i = 1, 20000
      call random_pair(random, a, c)
      alert = 10**random%uniform(-6.0_wp, 0.0_wp)
      if (modulo(i, 4) == 0) a = anint(2*a)/2
      if (modulo(i, 8) == 0) c = anint(2*c)/2
      ! Rounded, some are no convex polygons any more, which readers refuse.
      if (.not. (is_convex(a) .and. is_convex(c))) cycle
      found = 0
      touch = touching(c, a, alert, found)
      again = found
      other = touching(c, a, alert, again)
      if (touch%n > 0 .and. again /= found) moved_on = moved_on + 1
      do kept = int(-size(c, 2) - 2, i4), int(size(a, 2) + 2, i4)
        again = kept + sign(vertex_unit*modulo(int(i, i4) + abs(kept), 10_i4), kept)
        other = touching(c, a, alert, again)
        if (.not. is_same(touch, other)) different = different + 1
      end do
      do kept = -9, 3
        if (.not. is_same(touching_wall(c, a(:, 1), [0.6_wp, 0.8_wp], [1.0_wp, 0.1_wp], alert), &
                          touching_wall(c, a(:, 1), [0.6_wp, 0.8_wp], [1.0_wp, 0.1_wp], alert, kept))) different = different + 1
      end do
      if (touch%n == 0 .or. modulo(i, 4) == 0) cycle
      touching_pairs = touching_pairs + 1
      other = touching(mirror_image(c), mirror_image(a), alert)
      if (touch%n /= other%n) then
        mirrored = mirrored + 1
      else if (abs(minval(touch%gap(:touch%n)) - minval(other%gap(:touch%n))) > 1e-12_wp) then
        mirrored = mirrored + 1
      end if
    end do
    call t%equal(different, 0, 'contacts that depend on the face kept')
    call t%equal(moved_on, 0, 'best faces that are not kept')
    call t%equal(mirrored, 0, 'mirrored pairs with other contacts')
    call t%check(touching_pairs > 5000, 'many pairs touch')
  end subroutine test_kept

  !> Are the points of two answers the same bit for bit?
  pure logical function is_same(a, b)
    type(touch_t), intent(in) :: a, b

    is_same = a%n == b%n
    if (.not. is_same) return
    associate (n => a%n)
      is_same = all(a%feature(:n) == b%feature(:n)) .and. .not. any(abs(a%gap(:n) - b%gap(:n)) > 0) &
                .and. .not. any(abs(a%point(:, :n) - b%point(:, :n)) > 0) &
                .and. .not. any(abs(a%normal(:, :n) - b%normal(:, :n)) > 0)
    end associate
  end function is_same

  !> A polygon seen in a mirror, counter-clockwise again.
  pure function mirror_image(vertices) result(new)
    real(wp), intent(in) :: vertices(:, :)
    real(wp) :: new(2, size(vertices, 2))

    new(1, :) = -vertices(1, size(vertices, 2):1:-1)
    new(2, :) = vertices(2, size(vertices, 2):1:-1)
  end function mirror_image

  !> Gaps of separated polygons against all distances between vertices and edges; depths of overlapping ones against
  !! the shortest translation over 720 directions.
  subroutine test_against_brute_force()
    type(random_t) :: random
    type(touch_t) :: touch
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: distance, depth, gap, surface(2, 1)
    integer :: i, j, apart, deep

    call random%seed(11)
    apart = 0
    deep = 0
    do i = 1, 4000
      call random_pair(random, a, c)
      touch = touching(c, a, 0.5_wp)
      depth = shortest_translation(a, c)
      distance = brute_distance(a, c)
      if (touch%n == 0) then
        call t%check(distance >= 0.5_wp - tight .and. depth < 0, 'no point is missed')
        cycle
      end if
      do j = 1, touch%n
        surface(:, 1) = touch%point(:, j) + touch%gap(j)/2*touch%normal(:, j)
        call t%near(shortest_of(surface, c), 0.0_wp, 1e-12_wp, 'half a gap from the point to the candidate')
        surface(:, 1) = touch%point(:, j) - touch%gap(j)/2*touch%normal(:, j)
        call t%near(shortest_of(surface, a), 0.0_wp, 1e-12_wp, 'half a gap from the point to the antagonist')
      end do
      gap = minval(touch%gap(:touch%n))
      if (gap > 0) then
        apart = apart + 1
        call t%near(gap, distance, 1e-12_wp, 'gap of separated polygons')
      else
        deep = deep + 1
        ! The best of the directions is within a step of pi/720 of the best of all; shapes reach to 4.
        call t%check(depth >= -gap - tight .and. depth <= -gap + 4*pi/720, 'depth is the shortest way apart')
      end if
    end do
    call t%check(apart > 500 .and. deep > 500, 'both cases are met')
  end subroutine test_against_brute_force

  !> A wall's gap to a polygon is the polygon's distance to the axis less the half thickness.
  subroutine test_wall_against_axis()
    type(random_t) :: random
    type(touch_t) :: touch
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: angle, axis(2), ends(2, 2), distance
    integer :: i, found

    call random%seed(5)
    found = 0
    do i = 1, 2000
      call random_pair(random, a, c)
      angle = random%uniform(0.0_wp, 2*pi)
      axis = [cos(angle), sin(angle)]
      ends(:, 1) = -0.8_wp*axis
      ends(:, 2) = 0.8_wp*axis
      if (shortest_translation(ends, c) > 0) cycle
      distance = brute_distance(ends, c)
      touch = touching_wall(c, zero, axis, [0.8_wp, 0.3_wp], 0.2_wp)
      if (abs(distance - 0.5_wp) < tight) cycle
      call t%check((distance < 0.5_wp) .eqv. (touch%n > 0), 'wall and polygon within alert')
      if (touch%n == 0) cycle
      found = found + 1
      call t%near(minval(touch%gap(:touch%n)), distance - 0.3_wp, 1e-12_wp, 'gap of wall and polygon')
    end do
    call t%check(found > 300, 'many walls are near enough')
  end subroutine test_wall_against_axis

  !> Whatever comes: finite numbers, unit normals, gaps below alert.
  subroutine test_fuzz()
    type(random_t) :: random
    type(touch_t) :: touch
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: alert
    integer :: i, bad

    call random%seed(2024)
    bad = 0
    do i = 1, 100000
      call random_pair(random, a, c)
      ! Coordinates cut to a coarse grid now and then, for shared vertices, flat angles and no area.
      if (modulo(i, 3) == 0) a = anint(2*a)/2
      if (modulo(i, 6) == 0) c = anint(2*c)/2
      alert = 10**random%uniform(-6.0_wp, 0.0_wp)
      touch = touching(c, a, alert)
      if (.not. is_sane(touch, alert)) bad = bad + 1
      touch = touching_wall(c, a(:, 1), [0.6_wp, 0.8_wp], [1.0_wp, 0.1_wp], alert)
      if (.not. is_sane(touch, alert)) bad = bad + 1
      call touch_disk_polygon(c(:, 1), 0.3_wp, size(a, 2), a, zero, alert, touch)
      if (.not. is_sane(touch, alert)) bad = bad + 1
    end do
    call t%equal(bad, 0, 'fuzzed pairs that are not sane')
  end subroutine test_fuzz

  !> Is every point finite, with a unit normal and a gap below alert?
  logical function is_sane(touch, alert)
    type(touch_t), intent(in) :: touch
    real(wp), intent(in) :: alert

    is_sane = touch%n >= 0 .and. touch%n <= 2
    if (.not. is_sane) return
    associate (n => touch%n)
      is_sane = all(touch%gap(:n) < alert) .and. all(abs(touch%point(:, :n)) < 100) &
                .and. all(touch%gap(:n) > -10) .and. all(abs(norm2(touch%normal(:, :n), 1) - 1) <= tight)
    end associate
  end function is_sane

  !> Vertices turned about the origin, then moved.
  pure function turned(vertices, angle, shift) result(new)
    real(wp), intent(in) :: vertices(:, :), angle, shift(2)
    real(wp) :: new(2, size(vertices, 2))

    new(1, :) = cos(angle)*vertices(1, :) - sin(angle)*vertices(2, :) + shift(1)
    new(2, :) = sin(angle)*vertices(1, :) + cos(angle)*vertices(2, :) + shift(2)
  end function turned

  !> Two random convex polygons of 3 to 8 vertices on ellipses (some thin), overlapping, near or apart.
  subroutine random_pair(random, a, c)
    type(random_t), intent(inout) :: random
    real(wp), allocatable, intent(out) :: a(:, :), c(:, :)

    call random_polygon(random, zero, a)
    call random_polygon(random, [random%uniform(0.0_wp, 2.5_wp), random%uniform(-0.5_wp, 0.5_wp)], c)
  end subroutine random_pair

  !> Does a polygon turn left at each of its vertices, and once in all?
  pure logical function is_convex(vertices)
    real(wp), intent(in) :: vertices(:, :)
    real(wp) :: way(2), next(2), turns
    integer :: i, n

    n = size(vertices, 2)
    turns = 0
    is_convex = .false.
    do i = 1, n
      way = vertices(:, 1 + modulo(i, n)) - vertices(:, i)
      next = vertices(:, 1 + modulo(i + 1, n)) - vertices(:, 1 + modulo(i, n))
      if (way(1)*next(2) - way(2)*next(1) <= 0) return
      turns = turns + acos((way(1)*next(1) + way(2)*next(2))/(norm2(way)*norm2(next)))
    end do
    is_convex = turns < 3*pi
  end function is_convex

  !> A random convex polygon: vertices on an ellipse at angles that grow by random steps.
  subroutine random_polygon(random, centre, vertices)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: centre(2)
    real(wp), allocatable, intent(out) :: vertices(:, :)
    real(wp) :: angle(8), flatness
    integer :: i, n

    n = 3 + int(5.999_wp*random%uniform())
    angle(1) = 0
    do i = 2, n
      angle(i) = angle(i - 1) + random%uniform(0.2_wp, 1.0_wp)
    end do
    angle(:n) = angle(:n)*2*pi/(angle(n) + random%uniform(0.2_wp, 1.0_wp))
    flatness = 10**random%uniform(-2.0_wp, 0.0_wp)
    allocate (vertices(2, n))
    vertices(1, :) = cos(angle(:n))
    vertices(2, :) = flatness*sin(angle(:n))
    vertices = turned(vertices, random%uniform(0.0_wp, 2*pi), centre)
  end subroutine random_polygon

  !> Least distance between the boundaries of two separated polygons: every vertex against every edge.
  pure real(wp) function brute_distance(a, c)
    real(wp), intent(in) :: a(:, :), c(:, :)

    brute_distance = min(shortest_of(a, c), shortest_of(c, a))
  end function brute_distance

  !> Least distance of some points to the edges of a polygon.
  pure real(wp) function shortest_of(points, polygon) result(shortest)
    real(wp), intent(in) :: points(:, :), polygon(:, :)
    real(wp) :: edge(2), between(2)
    integer :: i, j

    shortest = huge(shortest)
    do i = 1, size(polygon, 2)
      edge = polygon(:, modulo(i, size(polygon, 2)) + 1) - polygon(:, i)
      do j = 1, size(points, 2)
        between = points(:, j) - polygon(:, i)
        between = between - max(0.0_wp, min(1.0_wp, dot_product(between, edge)/dot_product(edge, edge)))*edge
        shortest = min(shortest, norm2(between))
      end do
    end do
  end function shortest_of

  !> Least length by which c must move to leave a, over 720 directions; negative when they are apart.
  pure real(wp) function shortest_translation(a, c) result(depth)
    real(wp), intent(in) :: a(:, :), c(:, :)
    real(wp) :: normal(2)
    integer :: i

    depth = huge(depth)
    do i = 1, 720
      normal = [cos(2*pi*real(i, wp)/720), sin(2*pi*real(i, wp)/720)]
      depth = min(depth, maxval(matmul(normal, a)) - minval(matmul(normal, c)))
    end do
  end function shortest_translation
end program test_touch_random
