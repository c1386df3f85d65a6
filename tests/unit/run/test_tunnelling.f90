!> Bodies that pass through each other within a step: how thin shapes are, who passed, who only came deep, and in whose words.
program test_tunnelling
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, drive, hold, put_disk, put_polygon, put_wall, run
  use scenes_space, only: begin_space_scene, put_box, put_capsule, put_plane, put_sphere
  use sg_advance, only: advance
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_segment, contactors_t
  use sg_error, only: error_t
  use sg_half_width, only: half_width
  use sg_history, only: resume_history
  use sg_kinds, only: wp
  use sg_laws, only: law_iqs, law_velocity
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_random, only: random_t
  use sg_rotations, only: rotation_by, turned_by
  use sg_simulation, only: simulation_t
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  use sg_swept_shapes, only: goes_through
  use sg_time_functions, only: time_function_t
  implicit none
  type(tests_t) :: t
  real(wp), parameter :: rounding = 1e-14_wp

  call test_widths()
  call test_widths_of_polygons()
  call test_widths_in_space()
  call test_balls()
  call test_wall()
  call test_first_detection()
  call test_walls_in_space()
  call test_round_walls()
  call test_images()
  call test_random_paths()
  call test_no_false_alarm()
  call test_squeezed()
  call t%finish()

contains

  !> In the plane: an oblong, a triangle (the least of its heights), a disk, a rounded segment; a hollow disk has no other side.
  subroutine test_widths()
    type(contactors_t) :: shapes

    call add_disk(shapes, 1, 1, 0.3_wp, [0.0_wp, 0.0_wp])
    call add_segment(shapes, 2, 1, 5.0_wp, 0.2_wp, [0.0_wp, 0.0_wp], 0.1_wp)
    call add_hollow(shapes, 3, 1, 2.0_wp, [0.0_wp, 0.0_wp])
    call add_polygon(shapes, 4, 1, reshape([1.0_wp, 1.0_wp, 5.0_wp, 1.0_wp, 5.0_wp, 2.0_wp, 1.0_wp, 2.0_wp], [2, 4]), &
                     [0.0_wp, 0.0_wp])
    call add_polygon(shapes, 5, 1, reshape([0.0_wp, 0.0_wp, 3.0_wp, 0.0_wp, 0.0_wp, 4.0_wp], [2, 3]), [0.0_wp, 0.0_wp])
    call t%near(half_width(shapes, 1), 0.3_wp, 0.0_wp, 'half width of a disk')
    call t%near(half_width(shapes, 2), 0.2_wp, 0.0_wp, 'of a rounded segment')
    call t%check(half_width(shapes, 3) > 1e300_wp, 'of a hollow disk')
    call t%near(half_width(shapes, 4), 0.5_wp, rounding, 'of an oblong')
    call t%near(half_width(shapes, 5), 1.2_wp, rounding, 'of a triangle')
    call add_polygon(shapes, 6, 1, reshape(0.1_wp*real([0, 0, 1, 1, 2, 2, 3, 3, 2, 4, 1, 3, 0, 2, -1, 1], wp), &
                                                         [2, 8]), [0.0_wp, 0.0_wp])
    call t%near(half_width(shapes, 6), 0.1_wp*sqrt(0.5_wp), rounding, 'of an oblong with vertices along its sides')
  end subroutine test_widths

  !> Polygons at random, of points on ellipses at any angle, against the heights of all vertices above all edges.
  subroutine test_widths_of_polygons()
    type(contactors_t) :: shapes
    type(random_t) :: random
    real(wp), allocatable :: vertex(:, :)
    real(wp) :: edge(2), axes(2), angle, width
    integer :: polygon, i, n

    call random%seed(3)
    do polygon = 1, 40
      n = 3 + polygon/2
      allocate (vertex(2, n))
      axes = [1.0_wp, random%uniform(0.001_wp, 1.0_wp)]
      angle = random%uniform(0.0_wp, 7.0_wp)
      do i = 1, n
        associate (turn => (real(i, wp) + random%uniform(0.0_wp, 0.9_wp))*2*acos(-1.0_wp)/real(n, wp))
          edge = axes*[cos(turn), sin(turn)]
        end associate
        vertex(:, i) = [cos(angle)*edge(1) - sin(angle)*edge(2), sin(angle)*edge(1) + cos(angle)*edge(2)]
      end do
      width = huge(width)
      do i = 1, n
        edge = vertex(:, 1 + mod(i, n)) - vertex(:, i)
        edge = [edge(2), -edge(1)]/norm2(edge)
        width = min(width, maxval(matmul(edge, vertex)) - minval(matmul(edge, vertex)))
      end do
      call add_polygon(shapes, polygon, 1, vertex, [0.0_wp, 0.0_wp])
      call t%near(half_width(shapes, polygon), width/2, rounding, 'half width of a polygon at random')
      deallocate (vertex)
    end do
  end subroutine test_widths_of_polygons

  !> In space.
  subroutine test_widths_in_space()
    type(contactors_t) :: shapes
    type(polyhedron_t) :: box
    type(error_t), allocatable :: error
    real(wp), parameter :: none(3) = 0, up(3) = [0.0_wp, 0.0_wp, 1.0_wp], &
                           frame(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

    shapes%dimension = 3
    call box_polyhedron([1.0_wp, 0.4_wp, 2.0_wp], box, error)
    call t%check(.not. allocated(error), 'a box')
    call add_sphere(shapes, 1, 1, 0.3_wp, none)
    call add_plane(shapes, 2, 1, [4.0_wp, 3.0_wp, 0.1_wp], none, frame)
    call add_cylinder(shapes, 3, 1, 2.0_wp, 0.25_wp, none, up)
    call add_hollow_cylinder(shapes, 4, 1, 2.0_wp, 0.25_wp, none, up)
    call add_polyhedron(shapes, 5, 1, box, none)
    call t%near(half_width(shapes, 1), 0.3_wp, 0.0_wp, 'half width of a sphere')
    call t%near(half_width(shapes, 2), 0.1_wp, 0.0_wp, 'of a plane')
    call t%near(half_width(shapes, 3), 0.25_wp, 0.0_wp, 'of a cylinder')
    call t%check(half_width(shapes, 4) > 1e300_wp, 'of a hollow cylinder')
    call t%near(half_width(shapes, 5), 0.4_wp, rounding, 'of a box')
  end subroutine test_widths_in_space

  !> A disk of radius 0.1 flies half a metre a step at one that rests; their law waits until they touch. Found at -0.25 and 0.25,
  !! 0.75, it has passed one at 0.72, and is stopped a little before the centre of one at 0.78.
  subroutine test_balls()
    type(simulation_t), pointer :: sim

    call fly(sim, law_velocity, 0.72_wp, 1)
    call t%equal(sim%totals%tunnellings, 1, 'a ball has passed another one')
    call t%check(allocated(sim%tunnelling%first), 'with a message')
    if (allocated(sim%tunnelling%first)) then
      call t%check(index(sim%tunnelling%first%message, 'step 2: bodies 1 and 2 pass through each other, at 5.00E+02 m/s') == 1, &
                   'step, bodies, speed: '//sim%tunnelling%first%message)
      ! Both radii over the speed.
      call t%check(index(sim%tunnelling%first%message, 'a time step below 4.0E-04 s finds them') > 0, &
                   'the step that would do: '//sim%tunnelling%first%message)
    end if
    call t%near(sim%scene%bodies%velocity(1, 1), 500.0_wp, 0.0_wp, 'it flies on')
    call fly(sim, law_velocity, 0.78_wp, 1)
    call t%equal(sim%totals%tunnellings, 0, 'one that is found deep has not passed')
    call t%check(sim%totals%worst_penetration > 0.1_wp, 'deep it is')
    call t%near(sim%scene%bodies%velocity(1, 1), 250.0_wp, 1e-6_wp, 'it has hit')
    call fly(sim, law_iqs, 0.72_wp, 1)
    call t%equal(sim%totals%tunnellings, 0, 'a law that sees gaps lets nothing pass')
    call fly(sim, law_velocity, 0.72_wp, 5)
    call t%equal(sim%totals%tunnellings, 0, 'nor do shorter steps')
  end subroutine test_balls

  !> A ball and a wall: the sum of radius and half thickness, 0.15, is what counts.
  subroutine test_wall()
    type(simulation_t), pointer :: sim

    call fly(sim, law_velocity, 0.72_wp, 1, 0.05_wp)
    call t%equal(sim%totals%tunnellings, 1, 'a ball has passed a wall')
    call fly(sim, law_velocity, 0.78_wp, 1, 0.05_wp)
    call t%equal(sim%totals%tunnellings, 0, 'and has not')
  end subroutine test_wall

  !> Make a disk fly at another one, or at a wall, for three milliseconds.
  subroutine fly(sim, law, distance, cut, half_thickness)
    type(simulation_t), pointer, intent(out) :: sim
    integer, intent(in) :: law, cut
    real(wp), intent(in) :: distance
    real(wp), intent(in), optional :: half_thickness
    type(error_t), allocatable :: error
    integer :: i

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.0_wp, 1.0_wp)
    sim%scene%laws(1)%kind = law
    sim%scene%gravity = 0
    call put_disk(sim%scene, 1, 0.1_wp, [0.0_wp, 0.0_wp])
    if (present(half_thickness)) then
      call put_wall(sim%scene, 2, 5.0_wp, half_thickness, [distance, 0.0_wp], 2*atan(1.0_wp))
    else
      call put_disk(sim%scene, 2, 0.1_wp, [distance, 0.0_wp])
    end if
    sim%scene%bodies%velocity(1, 1) = 500
    call begin_run(sim, 1e-3_wp/real(cut, wp), 1e-12_wp)
    do i = 1, 3*cut
      call advance(sim, error)
      if (allocated(error)) exit
    end do
    call t%check(.not. allocated(error), 'all steps are made')
  end subroutine fly
  !> Beyond a wall at its first detection: in the first step, from beyond the alert distance, after a restart, and through a
  !! polygon; in any direction. Detections are at 0.25, 0.75, 1.25 m.
  subroutine test_first_detection()
    real(wp), parameter :: places(3) = [0.12_wp, 0.5_wp, 1.0_wp]
    type(simulation_t), pointer :: sim
    integer :: i, j
    real(wp) :: angle, along(2)

    do i = 1, size(places)
      do j = 0, 3
        angle = real(j, wp)
        along = [cos(angle), sin(angle)]
        sim => fresh()
        call begin_scene(sim%scene, 2, 0.0_wp, 1e-3_wp)
        sim%scene%gravity = 0
        call put_disk(sim%scene, 1, 0.01_wp, [3.0_wp, -2.0_wp])
        if (j < 2) call put_wall(sim%scene, 2, 5.0_wp, 0.01_wp, [3.0_wp, -2.0_wp] + places(i)*along, angle + 2*atan(1.0_wp))
        if (j >= 2) call put_slab(sim, [3.0_wp, -2.0_wp] + places(i)*along, along)
        sim%scene%bodies%velocity(1:2, 1) = 500*along
        call begin_run(sim, 1e-3_wp, 1e-12_wp)
        call run(sim, i - 1)
        ! A restart file holds no gaps of contacts.
        if (j == 1 .and. i > 1) call resume_history(sim%history, sim%contacts)
        call t%equal(sim%totals%tunnellings, 0, 'not yet')
        call run(sim, 4 - i)
        call t%equal(sim%totals%tunnellings, 1, 'beyond a wall at its first detection')
        call t%check(allocated(sim%tunnelling%first), 'with a message')
        if (.not. allocated(sim%tunnelling%first)) cycle
        associate (message => sim%tunnelling%first%message)
          call t%check(index(message, 'step '//achar(48 + i)//': bodies 1 and 2') == 1, message)
        end associate
      end do
    end do
  end subroutine test_first_detection

  !> A fixed polygon, 2 cm thick across a direction.
  subroutine put_slab(sim, place, along)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: place(2), along(2)
    real(wp) :: across(2)

    across = [-along(2), along(1)]
    call put_polygon(sim%scene, 2, reshape([place - 0.01_wp*along - across, place + 0.01_wp*along - across, &
                                            place + 0.01_wp*along + across, place - 0.01_wp*along + across], [2, 4]))
    call hold(sim%scene, 2)
  end subroutine put_slab

  !> The same in space, through planes and boxes; a wall may be what moves.
  subroutine test_walls_in_space()
    real(wp), parameter :: up(3) = [0.0_wp, 0.0_wp, 1.0_wp], start(3) = [1.0_wp, 2.0_wp, 3.0_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: q(4), along(3)
    integer :: i, c

    do i = 1, 4
      q = rotation_by(0.4_wp*[real(i, wp), -1.0_wp, 0.5_wp])
      along = turned_by(q, up)
      sim => fresh()
      call begin_space_scene(sim%scene, 2, 0.3_wp, 1e-3_wp)
      sim%scene%gravity = 0
      call put_sphere(sim%scene, 1, 0.01_wp, start)
      if (modulo(i, 2) == 0) call put_plane(sim%scene, 2, [1.0_wp, 1.0_wp, 0.02_wp], start - 0.5_wp*along, q)
      if (modulo(i, 2) == 1) call put_box(sim%scene, 2, [1.0_wp, 1.0_wp, 0.02_wp], start - 0.5_wp*along, q)
      if (i < 3) then
        sim%scene%bodies%velocity(1:3, 1) = -500*along
        if (i == 1) call hold(sim%scene, 2)
      else
        if (i == 4) sim%scene%drives = sim%scene%drives(:0)
        do c = 1, 3
          call drive(sim%scene, 2, c, time_function_t(constant=500*along(c)))
          call drive(sim%scene, 2, c + 3, time_function_t())
        end do
      end if
      call begin_run(sim, 1e-3_wp, 1e-12_wp)
      call run(sim, 4)
      call t%equal(sim%totals%tunnellings, 1, 'through a wall in space')
    end do
  end subroutine test_walls_in_space

  !> Through walls that are round: a fixed disk, a sphere, a capsule at its side and at its end; a hollow cylinder, out of which a
  !! sphere flies through the wall or through an open end.
  subroutine test_round_walls()
    real(wp), parameter :: upright(4) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    type(simulation_t), pointer :: sim
    integer :: i

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.0_wp, 1e-3_wp)
    sim%scene%gravity = 0
    call put_disk(sim%scene, 1, 0.01_wp, [0.0_wp, 0.0_wp])
    call put_disk(sim%scene, 2, 0.05_wp, [0.5_wp, 0.04_wp])
    call hold(sim%scene, 2)
    call fly_on(sim, [500.0_wp, 0.0_wp], 'a fixed disk', 1)
    do i = 1, 6
      sim => fresh()
      call begin_space_scene(sim%scene, 2, 0.0_wp, 1e-3_wp)
      sim%scene%gravity = 0
      call put_sphere(sim%scene, 1, 0.01_wp, [0.0_wp, 0.0_wp, 0.0_wp])
      if (i == 1) call put_sphere(sim%scene, 2, 0.05_wp, [0.5_wp, 0.03_wp, 0.0_wp])
      if (i == 2) call put_capsule(sim%scene, 2, 0.2_wp, 0.05_wp, [0.5_wp, 0.03_wp, 0.1_wp])
      if (i == 3) call put_capsule(sim%scene, 2, 0.2_wp, 0.05_wp, [0.5_wp, 0.0_wp, 0.23_wp])
      if (i == 4) call put_capsule(sim%scene, 2, 0.2_wp, 0.05_wp, [0.5_wp, 0.04_wp, 0.24_wp])
      if (i > 4) then
        call add_hollow_cylinder(sim%scene%contactors, 2, 1, 0.3_wp, 0.2_wp, [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 1.0_wp])
        sim%scene%bodies%position(:, 2) = 0
        sim%scene%bodies%orientation(:, 2) = upright
      end if
      call hold_in_space(sim)
      if (i < 5) call fly_on(sim, [500.0_wp, 0.0_wp, 0.0_wp], 'round walls in space', merge(0, 1, i == 4))
      if (i == 5) call fly_on(sim, [500.0_wp, 0.0_wp, 700.0_wp], 'out of a drum through its wall', 1)
      if (i == 6) call fly_on(sim, [200.0_wp, 0.0_wp, 700.0_wp], 'out of a drum through its end', 0)
    end do
  end subroutine test_round_walls

  !> Make the first body fly, and count what it passes.
  subroutine fly_on(sim, velocity, name, passings)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: velocity(:)
    character(len=*), intent(in) :: name
    integer, intent(in) :: passings

    sim%scene%bodies%velocity(:size(velocity), 1) = velocity
    call begin_run(sim, 1e-3_wp, 1e-12_wp)
    call run(sim, 4)
    call t%equal(sim%totals%tunnellings, passings, name)
  end subroutine fly_on

  !> Hold the second body in space.
  subroutine hold_in_space(sim)
    type(simulation_t), intent(inout) :: sim
    integer :: c

    do c = 1, 6
      call drive(sim%scene, 2, c, time_function_t())
    end do
  end subroutine hold_in_space

  !> Over the border of a period and through the image of a wall beyond it, in the plane along x and in space along x and y, in
  !! both directions; a wall beside the path stays whole.
  subroutine test_images()
    type(simulation_t), pointer :: sim
    real(wp) :: along(3)
    integer :: axis, side, beside

    do axis = 1, 3
      do side = -1, 1, 2
        do beside = 0, 1
          sim => fresh()
          along = 0
          along(min(axis, 2)) = real(side, wp)
          if (axis == 3) along = [real(side, wp), 0.0_wp, 0.0_wp]
          if (axis == 1) then
            call begin_scene(sim%scene, 2, 0.0_wp, 1e-3_wp)
            along = [real(side, wp), 0.0_wp, 0.0_wp]
            call put_disk(sim%scene, 1, 0.01_wp, [1.0_wp, 0.0_wp] + 0.9_wp*along(:2))
            call put_wall(sim%scene, 2, 0.3_wp, 0.01_wp, [1.0_wp, real(beside, wp)] - 0.7_wp*along(:2), 2*atan(1.0_wp))
          else
            call begin_space_scene(sim%scene, 2, 0.0_wp, 1e-3_wp)
            sim%scene%period_y = 2
            call put_sphere(sim%scene, 1, 0.01_wp, [1.0_wp, 1.0_wp, 0.0_wp] + 0.9_wp*along)
            call put_box(sim%scene, 2, merge(0.01_wp, 0.3_wp, abs(along) > 0), [1.0_wp, 1.0_wp, real(beside, wp)] - 0.7_wp*along)
            call hold_in_space(sim)
          end if
          sim%scene%period = 2
          sim%scene%gravity = 0
          sim%scene%bodies%velocity(:sim%scene%dimension, 1) = 500*along(:sim%scene%dimension)
          call begin_run(sim, 1e-3_wp, 1e-12_wp)
          call run(sim, 3)
          call t%equal(sim%totals%tunnellings, 1 - beside, 'through the image of a wall')
        end do
      end do
    end do
  end subroutine test_images

  !> Paths at random against capsules at random, with many points of each path looked at one by one.
  subroutine test_random_paths()
    integer, parameter :: points = 400
    type(contactors_t) :: shapes
    type(random_t) :: random
    real(wp) :: from(3), to(3), place(3), middle(3), axis(3), least, half, distance
    integer :: i, k, hits, wrong

    call random%seed(31)
    hits = 0
    wrong = 0
    do i = 1, 400
      shapes = contactors_t(dimension=3)
      axis = around(random)
      axis = axis/norm2(axis)
      middle = 0.3_wp*around(random)
      half = random%uniform(0.1_wp, 1.0_wp)
      call add_cylinder(shapes, 1, 1, half, 0.3_wp, middle, axis)
      shapes%centre = reshape(middle, [3, 1])
      shapes%space%cylinder_world = reshape(axis, [3, 1])
      from = 3*around(random)
      to = -from + around(random)
      ! Beginning and end lie outside: what counts is whether a point between lies inside.
      least = huge(least)
      do k = 0, points
        place = from + real(k, wp)/real(points, wp)*(to - from) - middle
        distance = norm2(place - max(-half, min(half, dot_product(place, axis)))*axis) - 0.3_wp
        if ((k == 0 .or. k == points) .and. distance < 0) least = 0
        least = min(least, distance)
        if (abs(least) <= 0) exit
      end do
      ! Those that graze, or begin or end inside, are left out.
      if (abs(least) < 0.01_wp) cycle
      if (least < 0) hits = hits + 1
      if (goes_through(shapes, 1, from, to) .neqv. least < 0) wrong = wrong + 1
    end do
    call t%equal(wrong, 0, 'paths through capsules')
    call t%check(hits > 40 .and. hits < 360, 'some go through, some past')
  end subroutine test_random_paths

  !> A vector in a box.
  function around(random) result(v)
    type(random_t), intent(inout) :: random
    real(wp) :: v(3)

    v = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
  end function around

  !> Fast along a wall, fast past its end, or stopped by it: nothing passes.
  subroutine test_no_false_alarm()
    type(simulation_t), pointer :: sim
    integer :: i

    do i = 1, 3
      sim => fresh()
      call begin_scene(sim%scene, 2, 0.0_wp, 1.0_wp)
      call put_disk(sim%scene, 1, 0.1_wp, [0.0_wp, 0.1_wp])
      call put_wall(sim%scene, 2, 5.0_wp, 0.05_wp, merge([0.0_wp, -0.05_wp], [0.0_wp, 6.0_wp], i == 1), &
                    merge(0.0_wp, 2*atan(1.0_wp), i == 1))
      if (i == 1) sim%scene%bodies%velocity(1, 1) = 500
      if (i == 2) sim%scene%bodies%velocity(2, 1) = -100
      if (i == 3) then
        sim%scene%bodies%position(:, 1) = [-1.0_wp, 3.0_wp]
        sim%scene%bodies%velocity(1, 1) = 500
      end if
      call begin_run(sim, 1e-3_wp, 1e-12_wp)
      call run(sim, 5)
      call t%equal(sim%totals%tunnellings, 0, 'nothing has passed')
    end do
    call t%check(sim%scene%bodies%position(1, 1) < 0, 'the last one was stopped')
  end subroutine test_no_false_alarm

  !> A lid comes down on a disk that lies on a floor: it can go nowhere, and comes out through one of them.
  subroutine test_squeezed()
    type(simulation_t), pointer :: sim

    sim => fresh()
    call begin_scene(sim%scene, 3, 0.3_wp, 0.05_wp)
    call put_disk(sim%scene, 1, 0.1_wp, [0.0_wp, 0.1_wp])
    call put_wall(sim%scene, 2, 5.0_wp, 0.02_wp, [0.0_wp, -0.02_wp], 0.0_wp)
    call put_wall(sim%scene, 3, 5.0_wp, 0.02_wp, [0.0_wp, 0.22_wp], 0.0_wp)
    sim%scene%drives(5)%value = time_function_t(constant=-40.0_wp)
    ! Once the gap is narrower than the disk there is no solution: steps end with their sweeps.
    call begin_run(sim, 2e-4_wp, 1e-12_wp, maximum_sweeps=5000)
    call run(sim, 10)
    call t%equal(sim%totals%tunnellings, 0, 'squeezed, not yet beyond the middle')
    call run(sim, 20)
    call t%check(sim%totals%tunnellings > 0, 'squeezed out')
    if (allocated(sim%tunnelling%first)) call t%check(index(sim%tunnelling%first%message, 'are pressed through each other') > 0, &
                                                   sim%tunnelling%first%message)
  end subroutine test_squeezed
end program test_tunnelling
