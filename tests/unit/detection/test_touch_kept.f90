!> What detection keeps of a pair from step to step: axes proven without a search, and pairs that are still apart. Contacts are
!! those of a search from nothing, bit for bit.
program test_touch_kept
  use harness, only: tests_t
  use polygon_touch, only: touching
  use random_space, only: random_direction, random_frame
  use sg_kept_axis, only: feature_of, prove_axis
  use sg_kinds, only: wp, i4, pi
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_random, only: random_t
  use sg_rotations, only: frame_of, rotation_by
  use sg_separation, only: axis_t, rounding_of
  use sg_touch, only: touch_t
  use sg_touch_polyhedron_polyhedron, only: touch_polyhedron_polyhedron
  use sg_touch_space, only: touch_space_t
  use sg_path_bound, only: is_clear, longer_path
  use space_reference, only: separation_along
  use space_shapes, only: box_shape, prism_shape, random_shape, scaled_shape
  implicit none
  real(wp), parameter :: zero(3) = 0
  type(tests_t) :: t

  call test_any_feature()
  call test_tumbling_polyhedra()
  call test_tumbling_polygons()
  call test_path()
  call t%finish()

contains

  !> Are the points of two searches the same, bit for bit?
  logical function is_same(one, other)
    type(touch_space_t), intent(in) :: one, other

    is_same = one%n == other%n
    if (.not. is_same) return
    associate (n => one%n)
      is_same = all(abs(one%normal(:, :n) - other%normal(:, :n)) <= 0) .and. all(abs(one%point(:, :n) - other%point(:, :n)) <= 0) &
                .and. all(abs(one%gap(:n) - other%gap(:n)) <= 0) .and. all(one%feature(:n) == other%feature(:n))
    end associate
  end function is_same

  !> A shape: three in eight are regular, so that faces and edges are parallel and vertices at one height; one is thin.
  function some_shape(random, i) result(shape)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: i
    type(polyhedron_t) :: shape

    select case (modulo(i, 8))
    case (0)
      shape = box_shape([1.0_wp, 0.7_wp, 0.5_wp])
    case (2)
      shape = box_shape([1.0_wp, 0.8_wp, 0.03_wp])
    case (4)
      shape = prism_shape(6)
    case default
      shape = random_shape(random)
    end select
    if (random%uniform() < 0.2_wp) shape = scaled_shape(shape, spread(10**random%uniform(-2.0_wp, 0.0_wp), 1, 3))
  end function some_shape

  !> Every pair of features of random pairs: a search without them finds the same. Right ones are proven where shapes are shallow in
  !! each other.
  subroutine test_any_feature()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: touch, other
    type(axis_t) :: axis
    real(wp) :: offset(3), way(3), frame(3, 3), alert, gap
    integer(i4) :: kept(2), best(2)
    integer :: i, j, k, different, proven, named
    logical :: is_proven

    call random%seed(41)
    different = 0
    proven = 0
    named = 0
    do i = 1, 600
      c = some_shape(random, i)
      a = some_shape(random, i/2)
      frame = random_frame(random)
      call place_polyhedron(a, zero, frame)
      way = random_direction(random)
      ! One in four lies flat on the other or nearly so, tilted by an angle that rounding hides or does not.
      if (modulo(i, 4) == 0) way = frame(:, 1 + modulo(i/4, 3))
      if (modulo(i, 4) /= 0) frame = random_frame(random)
      frame = matmul(frame_of(rotation_by(10**random%uniform(-12.0_wp, -7.0_wp)*random_direction(random))), frame)
      call place_polyhedron(c, zero, frame)
      alert = 0.05_wp*min(c%reach, a%reach)
      gap = alert*random%uniform(merge(-8.0_wp, -1.0_wp, modulo(i, 3) == 0), 1.0_wp)
      offset = (separation_along(c, a, zero, way) - gap)*way
      call touch_polyhedron_polyhedron(c, a, offset, alert, touch)
      best = 0
      call touch_polyhedron_polyhedron(c, a, offset, alert, other, best)
      if (.not. is_same(touch, other)) different = different + 1
      do j = -c%n_faces - 1, c%n_edges + 1
        do k = -a%n_faces - 1, a%n_edges + 1
          if (j /= 0 .and. k /= 0 .and. min(j, k) < 0 .and. modulo(j + k, 7) /= 0) cycle
          kept = int([j, k], i4)
          call touch_polyhedron_polyhedron(c, a, offset, alert, other, kept)
          if (.not. is_same(touch, other)) different = different + 1
          if (touch%n > 0 .and. any(kept /= best)) different = different + 1
        end do
      end do
      if (touch%n == 0 .or. all(best == 0)) cycle
      named = named + 1
      call prove_axis(c, a, offset, rounding_of(c, a, offset), best, axis, is_proven)
      if (is_proven) proven = proven + 1
      call t%check(all(feature_of(axis) == best) .or. .not. is_proven, 'what is proven is what was kept')
    end do
    call t%equal(different, 0, 'contacts that depend on what is kept')
    ! Regular shapes and deep overlaps, of which there are many here, need the search.
    call t%check(named > 100 .and. proven > 25, 'axes are proven')
  end subroutine test_any_feature

  !> Pairs that tumble past each other for many steps, some of which are jumps.
  subroutine test_tumbling_polyhedra()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: touch, kept_touch
    real(wp) :: frame(3, 3), spin(3), place(3), place_a(3), velocity(3), alert, clearance, path(2), pace
    integer(i4) :: kept(2)
    integer :: i, step, different, clear, touching_steps, searched
    logical :: is_proven
    type(axis_t) :: axis

    call random%seed(42)
    different = 0
    clear = 0
    searched = 0
    touching_steps = 0
    do i = 1, 400
      c = some_shape(random, i)
      a = some_shape(random, i + 1)
      frame = random_frame(random)
      call place_polyhedron(a, zero, random_frame(random))
      call place_polyhedron(c, zero, frame)
      place = random_direction(random)
      place = (-separation_along(c, a, zero, place) + 0.05_wp*c%reach)*place
      velocity = random_direction(random) - 0.5_wp*place/norm2(place)
      spin = random_direction(random)*random%uniform(0.0_wp, 2.0_wp)
      pace = 10**random%uniform(-5.0_wp, -1.5_wp)*c%reach
      alert = 0.03_wp*c%reach
      kept = 0
      clearance = -huge(clearance)
      path = 0
      do step = 1, 100
        place = place + pace*velocity
        frame = matmul(frame_of(rotation_by(pace/c%reach*spin)), frame)
        if (random%uniform() < 0.02_wp) place = place - 0.1_wp*c%reach*place/norm2(place)
        if (random%uniform() < 0.01_wp) frame = random_frame(random)
        call place_polyhedron(c, place, frame, path(1))
        place_a = -0.3_wp*pace*real(step, wp)*velocity
        call place_polyhedron(a, place_a, frame_of(rotation_by(0.2_wp*pace*real(step, wp)*spin)), path(2))
        call touch_polyhedron_polyhedron(c, a, zero, alert, touch)
        if (is_clear(clearance, sum(path), alert)) then
          clear = clear + 1
          if (touch%n > 0) different = different + 1
          cycle
        end if
        call prove_axis(c, a, zero, rounding_of(c, a, zero), kept, axis, is_proven)
        call touch_polyhedron_polyhedron(c, a, zero, alert, kept_touch, kept, clearance)
        clearance = clearance + sum(path)
        if (.not. is_same(touch, kept_touch)) different = different + 1
        if (touch%n == 0) cycle
        touching_steps = touching_steps + 1
        if (.not. is_proven) searched = searched + 1
      end do
    end do
    call t%equal(different, 0, 'contacts of tumbling polyhedra that depend on the steps before')
    call t%check(touching_steps > 5000 .and. clear > 5000, 'many steps with contacts, and many without a look')
    call t%check(touching_steps - searched > 1500, 'many steps without a search')
  end subroutine test_tumbling_polyhedra

  !> Polygons that tumble past each other.
  subroutine test_tumbling_polygons()
    type(random_t) :: random
    type(touch_t) :: touch, kept_touch
    real(wp), allocatable :: c(:, :), a(:, :), now(:, :), before(:, :)
    real(wp) :: place(2), velocity(2), spin, angle, pace, clearance, path
    real(wp), parameter :: alert = 0.03_wp
    integer(i4) :: kept
    integer :: i, step, different, clear, touching_steps

    call random%seed(43)
    different = 0
    clear = 0
    touching_steps = 0
    do i = 1, 2000
      c = some_polygon(random, i)
      a = some_polygon(random, i + 1)
      angle = random%uniform(0.0_wp, 2*pi)
      place = random%uniform(1.3_wp, 2.1_wp)*[cos(angle), sin(angle)]
      velocity = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)] - 0.3_wp*place
      spin = random%uniform(-1.0_wp, 1.0_wp)
      pace = 10**random%uniform(-5.0_wp, -1.5_wp)
      kept = 0
      clearance = -huge(clearance)
      path = 0
      before = placed(c, place, angle)
      do step = 1, 60
        place = place + pace*velocity
        angle = angle + pace*spin
        if (random%uniform() < 0.02_wp) place = 0.95_wp*place
        if (random%uniform() < 0.01_wp) angle = random%uniform(0.0_wp, 2*pi)
        now = placed(c, place, angle)
        path = longer_path(path, maxval(sum((now - before)**2, 1)))
        before = now
        touch = touching(now, a, alert)
        if (is_clear(clearance, path, alert)) then
          clear = clear + 1
          if (touch%n > 0) different = different + 1
          cycle
        end if
        kept_touch = touching(now, a, alert, kept, clearance)
        clearance = clearance + path
        if (touch%n > 0) touching_steps = touching_steps + 1
        if (touch%n /= kept_touch%n) then
          different = different + 1
        else if (touch%n > 0) then
          if (any(abs(touch%gap(:touch%n) - kept_touch%gap(:touch%n)) > 0)) different = different + 1
        end if
      end do
    end do
    call t%equal(different, 0, 'contacts of tumbling polygons that depend on the steps before')
    call t%check(touching_steps > 5000 .and. clear > 5000, 'polygons: many steps with contacts, and many without a look')
  end subroutine test_tumbling_polygons

  !> A convex polygon with its corners on the unit circle, regular or not.
  function some_polygon(random, i) result(vertex)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: i
    real(wp), allocatable :: vertex(:, :)
    real(wp) :: angle
    integer :: n, k

    n = 3 + modulo(i, 6)
    allocate (vertex(2, n))
    do k = 1, n
      angle = 2*pi*(real(k, wp) + merge(0.0_wp, random%uniform(-0.4_wp, 0.4_wp), modulo(i, 4) == 0))/real(n, wp)
      vertex(:, k) = [cos(angle), sin(angle)]
    end do
  end function some_polygon

  !> A polygon turned, then moved.
  function placed(vertex, place, angle) result(world)
    real(wp), intent(in) :: vertex(:, :), place(2), angle
    real(wp) :: world(2, size(vertex, 2))

    world(1, :) = place(1) + cos(angle)*vertex(1, :) - sin(angle)*vertex(2, :)
    world(2, :) = place(2) + sin(angle)*vertex(1, :) + cos(angle)*vertex(2, :)
  end function placed

  !> Displacements add up upwards: what is lost to rounding far along is never a displacement.
  subroutine test_path()
    real(wp) :: path, before
    integer :: i

    path = 1000
    before = path
    do i = 1, 1000
      path = longer_path(path, (1e-14_wp)**2)
    end do
    call t%check(path - before >= 1000*1e-14_wp .and. path - before < 1e-8_wp, 'tiny displacements far along')
    call t%check(longer_path(0.0_wp, 0.0_wp) >= 0 .and. longer_path(0.0_wp, 0.0_wp) < 1e-100_wp, 'no displacement')
    call t%check(.not. is_clear(-huge(1.0_wp), 0.0_wp, 0.1_wp), 'nothing is known of a new pair')
    call t%check(is_clear(1.2_wp, 1.0_wp, 0.1_wp) .and. .not. is_clear(1.2_wp, 1.15_wp, 0.1_wp), 'apart until the shapes have met')
  end subroutine test_path
end program test_touch_kept
