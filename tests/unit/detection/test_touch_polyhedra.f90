!> Contacts of random convex polyhedra against a dense reference, and what must not change them.
program test_touch_polyhedra
  use harness, only: tests_t
  use random_space, only: random_direction, random_frame
  use sg_kinds, only: wp
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_random, only: random_t
  use sg_touch_polyhedron_polyhedron, only: touch_polyhedron_polyhedron
  use sg_touch_space, only: touch_space_t
  use space_reference, only: height_above, separation_along, signed_distance
  use space_shapes, only: prism_shape, random_shape, scaled_shape
  implicit none
  type(tests_t) :: t
  real(wp), parameter :: zero(3) = 0
  real(wp), parameter :: unit(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
  ! Lengths are compared to some tens of thousands of units in the last place of the sizes: sliver faces lose that much.
  real(wp), parameter :: tight = 1e-11_wp

  call test_against_reference()
  call test_many_edges()
  call test_far_from_origin()
  call test_exchange()
  call test_rigid_motion()
  call test_sweeps()
  call t%finish()

contains

  !> A pair that is apart or overlaps along a random direction, sizes up to 1:1000, alert a fifth of the smaller.
  subroutine random_pair(random, c, a, offset, alert, frame_c, frame_a)
    type(random_t), intent(inout) :: random
    type(polyhedron_t), intent(out) :: c, a
    real(wp), intent(out) :: offset(3), alert
    real(wp), intent(out), optional :: frame_c(3, 3), frame_a(3, 3)
    real(wp) :: way(3), gap, low, frame(3, 3)

    c = random_shape(random)
    a = random_shape(random)
    if (random%uniform() < 0.4_wp) c = scaled_shape(c, spread(10**random%uniform(-3.0_wp, 0.0_wp), 1, 3))
    frame = random_frame(random)
    if (present(frame_c)) frame_c = frame
    call place_polyhedron(c, zero, frame)
    frame = random_frame(random)
    if (present(frame_a)) frame_a = frame
    call place_polyhedron(a, zero, frame)
    alert = 0.2_wp*min(c%reach, a%reach)
    way = random_direction(random)
    low = merge(-8.0_wp, -0.5_wp, random%uniform() < 0.5_wp)
    gap = random%uniform(low, 1.0_wp)*alert
    offset = (separation_along(c, a, zero, way) - gap)*way
  end subroutine random_pair

  !> Gap, normal and points of a pair against the reference; says what is wrong, or nothing.
  function wrong_with(c, a, offset, alert, touch, tolerance) result(what)
    type(polyhedron_t), intent(in) :: c, a
    real(wp), intent(in) :: offset(3), alert, tolerance
    type(touch_space_t), intent(in) :: touch
    character(len=40) :: what
    real(wp) :: distance, half(3)
    integer :: i

    what = ''
    distance = signed_distance(c, a, offset)
    if (touch%n == 0) then
      if (distance < alert - tolerance) what = 'missed'
      return
    end if
    if (distance > alert + tolerance) what = 'beyond alert'
    if (abs(minval(touch%gap(:touch%n)) - distance) > tolerance) what = 'gap'
    if (maxval(touch%gap(:touch%n)) >= alert) what = 'gap beyond alert'
    do i = 1, touch%n
      if (abs(norm2(touch%normal(:, i)) - 1) > 1e-14_wp) what = 'length of normal'
      if (maxval(abs(touch%normal(:, i) - touch%normal(:, 1))) > 0) what = 'several normals'
      half = 0.5_wp*touch%gap(i)*touch%normal(:, i)
      if (abs(height_above(touch%point(:, i) + half, c)) > tolerance) what = 'point off the candidate'
      if (abs(height_above(touch%point(:, i) - half - offset, a)) > tolerance) what = 'point off the antagonist'
      if (any(touch%feature(:i - 1) == touch%feature(i)) .or. touch%feature(i) <= 0) what = 'features'
    end do
    ! Along the normal the shapes are as far apart as they are at all: so it is the normal.
    if (abs(separation_along(c, a, offset, touch%normal(:, 1)) - distance) > tolerance) what = 'normal'
  end function wrong_with

  !> A thousand pairs of all kinds.
  subroutine test_against_reference()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: touch
    real(wp) :: offset(3), alert
    integer :: i, met(0:4), deep
    character(len=40) :: what

    call random%seed(3)
    met = 0
    deep = 0
    do i = 1, 1000
      call random_pair(random, c, a, offset, alert)
      call touch_polyhedron_polyhedron(c, a, offset, alert, touch)
      what = wrong_with(c, a, offset, alert, touch, tight*(c%reach + a%reach))
      call t%check(what == '', 'random pair: '//trim(what))
      met(touch%n) = met(touch%n) + 1
      if (touch%n > 0) deep = deep + merge(1, 0, minval(touch%gap(:touch%n)) < 0)
    end do
    call t%check(all(met(1:4) > 25) .and. deep > 125, 'pairs with one to four points, and overlapping ones')
  end subroutine test_against_reference

  !> Shapes of many edges, deep in each other, so that edges come in several batches.
  subroutine test_many_edges()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: touch
    real(wp) :: offset(3), distance
    integer :: i, touched

    call random%seed(13)
    touched = 0
    do i = 1, 30
      c = scaled_shape(prism_shape(25 + modulo(i, 16)), [1.0_wp, 0.7_wp, 0.4_wp])
      a = scaled_shape(prism_shape(40 - modulo(i, 7)), [0.5_wp, 1.0_wp, 1.0_wp])
      call place_polyhedron(c, zero, random_frame(random))
      call place_polyhedron(a, zero, random_frame(random))
      offset = random%uniform(0.1_wp, 1.8_wp)*random_direction(random)
      distance = signed_distance(c, a, offset)
      call touch_polyhedron_polyhedron(c, a, offset, 0.2_wp, touch)
      call t%check((touch%n > 0) .eqv. (distance < 0.2_wp), 'many edges: touch or not')
      if (touch%n == 0) cycle
      ! Regular shapes have axes as good except for the length that is none, 1e-10 of the smaller shape.
      call t%near(minval(touch%gap(:touch%n)), distance, 2e-10_wp, 'many edges: gap')
      call t%near(separation_along(c, a, offset, touch%normal(:, 1)), distance, 2e-10_wp, 'many edges: normal')
      touched = touched + 1
    end do
    call t%check(touched > 15, 'many of many edges touch')
  end subroutine test_many_edges

  !> A million sizes away coordinates have lost six digits; no more than that is lost.
  subroutine test_far_from_origin()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: touch
    real(wp) :: offset(3), alert, frame_c(3, 3), frame_a(3, 3), shift(3)
    integer :: i
    character(len=40) :: what

    call random%seed(4)
    do i = 1, 200
      call random_pair(random, c, a, offset, alert, frame_c, frame_a)
      shift = 1e6_wp*random_direction(random)
      call place_polyhedron(c, shift, frame_c)
      call place_polyhedron(a, shift, frame_a)
      call touch_polyhedron_polyhedron(c, a, offset, alert, touch)
      ! Rounded vertices no longer lie in their faces' planes, but within 64 units of the last place of 1e6.
      what = wrong_with(c, a, offset, alert, touch, 64*epsilon(1.0_wp)*1e6_wp)
      call t%check(what == '', 'far from the origin: '//trim(what))
    end do
  end subroutine test_far_from_origin

  !> Are two results the same up to rounding, the second moved back by `frame` and `shift` and turned by `sense`?
  logical function is_same(one, two, frame, shift, sense, tolerance)
    type(touch_space_t), intent(in) :: one, two
    real(wp), intent(in) :: frame(3, 3), shift(3), sense, tolerance
    real(wp) :: nearest, way(3), difference
    integer :: i, j

    is_same = one%n == two%n
    do i = 1, one%n
      nearest = huge(nearest)
      do j = 1, two%n
        way = matmul(two%point(:, j) - shift, frame) - one%point(:, i)
        difference = max(norm2(way), abs(one%gap(i) - two%gap(j)))
        nearest = min(nearest, difference)
      end do
      way = matmul(sense*two%normal(:, 1), frame)
      ! The direction between points at a distance d is known to rounding/d, but is none of these below 1e-6.
      is_same = is_same .and. nearest <= tolerance .and. norm2(way - one%normal(:, i)) <= 1e-6_wp
    end do
  end function is_same

  !> The roles of candidate and antagonist may be exchanged.
  subroutine test_exchange()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: there, back
    real(wp) :: offset(3), alert
    integer :: i, found

    call random%seed(5)
    found = 0
    do i = 1, 600
      call random_pair(random, c, a, offset, alert)
      call touch_polyhedron_polyhedron(c, a, offset, alert, there)
      call touch_polyhedron_polyhedron(a, c, -offset, alert, back)
      call t%check(is_same(there, back, unit, -offset, -1.0_wp, tight*(c%reach + a%reach)), 'exchange of the two')
      found = found + min(there%n, 1)
    end do
    call t%check(found > 150, 'many pairs touch')
  end subroutine test_exchange

  !> Both turned and moved together.
  subroutine test_rigid_motion()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: before, after
    real(wp) :: offset(3), alert, frame_c(3, 3), frame_a(3, 3), turn(3, 3), shift(3)
    integer :: i, found

    call random%seed(6)
    found = 0
    do i = 1, 600
      call random_pair(random, c, a, offset, alert, frame_c, frame_a)
      call touch_polyhedron_polyhedron(c, a, offset, alert, before)
      turn = random_frame(random)
      shift = 10*random_direction(random)
      call place_polyhedron(c, shift, matmul(turn, frame_c))
      call place_polyhedron(a, shift + matmul(turn, offset), matmul(turn, frame_a))
      call touch_polyhedron_polyhedron(c, a, zero, alert, after)
      call t%check(is_same(before, after, turn, shift, 1.0_wp, 10*tight*(c%reach + a%reach)), 'common motion of both')
      found = found + min(before%n, 1)
    end do
    call t%check(found > 150, 'many pairs touch')
  end subroutine test_rigid_motion

  !> Along a sweep the gap changes by no more than the shapes move: the signed distance is a distance.
  subroutine test_sweeps()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: touch
    real(wp) :: offset(3), alert, frame_c(3, 3), way(3), turn(3, 3), gap, last, step, angle, axis(3, 3)
    integer :: i, k, steps

    call random%seed(8)
    steps = 0
    do i = 1, 60
      call random_pair(random, c, a, offset, alert, frame_c)
      way = random_direction(random)
      axis = random_frame(random)
      step = alert/50
      last = huge(last)
      do k = 1, 200
        ! One half of the sweeps moves the antagonist, the other turns the candidate about a random axis.
        angle = merge(step*real(k, wp)/c%reach, 0.0_wp, modulo(i, 2) == 0)
        turn(:, 1) = cos(angle)*axis(:, 1) + sin(angle)*axis(:, 2)
        turn(:, 2) = cos(angle)*axis(:, 2) - sin(angle)*axis(:, 1)
        turn(:, 3) = axis(:, 3)
        call place_polyhedron(c, zero, matmul(matmul(turn, transpose(axis)), frame_c))
        if (modulo(i, 2) == 1) offset = offset + step*way
        call touch_polyhedron_polyhedron(c, a, offset, alert, touch)
        gap = alert
        if (touch%n > 0) gap = minval(touch%gap(:touch%n))
        if (k > 1) then
          call t%check(abs(gap - last) <= step + tight*(c%reach + a%reach), 'the gap jumps')
          if (abs(gap - last) > 0) steps = steps + 1
        end if
        last = gap
      end do
    end do
    call t%check(steps > 2000, 'many steps change the gap')
  end subroutine test_sweeps
end program test_touch_polyhedra
