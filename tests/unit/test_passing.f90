!> Bodies that pass through each other within a step: how thin shapes are, who passed, who only came deep, and in whose words.
program test_passing
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, put_disk, put_wall
  use sg_advance, only: advance
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_wall, contactors_t
  use sg_error, only: error_t
  use sg_half_width, only: half_width
  use sg_kinds, only: wp
  use sg_laws, only: law_iqs, law_velocity
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  implicit none
  type(tests_t) :: t
  real(wp), parameter :: rounding = 1e-14_wp

  call test_widths()
  call test_widths_of_polygons()
  call test_widths_in_space()
  call test_balls()
  call test_wall()
  call t%finish()

contains

  !> In the plane: an oblong, a triangle (the least of its heights), a disk, a rounded segment; a hollow disk has no other side.
  subroutine test_widths()
    type(contactors_t) :: shapes

    call add_disk(shapes, 1, 1, 0.3_wp, [0.0_wp, 0.0_wp])
    call add_wall(shapes, 2, 1, 5.0_wp, 0.2_wp, [0.0_wp, 0.0_wp], 0.1_wp)
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
    type(simulation_t) :: sim

    call fly(sim, law_velocity, 0.72_wp, 1)
    call t%equal(sim%totals%passings, 1, 'a ball has passed another one')
    call t%check(allocated(sim%passing%first), 'which is told')
    if (allocated(sim%passing%first)) then
      call t%check(index(sim%passing%first%message, 'step 2: bodies 1 and 2 pass through each other, at 5.00E+02 m/s') == 1, &
                   'step, bodies, speed: '//sim%passing%first%message)
      ! Both radii over the speed.
      call t%check(index(sim%passing%first%message, 'a time step below 4.0E-04 s finds them') > 0, &
                   'the step that would do: '//sim%passing%first%message)
    end if
    call t%near(sim%scene%bodies%velocity(1, 1), 500.0_wp, 0.0_wp, 'it flies on')
    call fly(sim, law_velocity, 0.78_wp, 1)
    call t%equal(sim%totals%passings, 0, 'one that is found deep has not passed')
    call t%check(sim%totals%worst_penetration > 0.1_wp, 'deep it is')
    call t%near(sim%scene%bodies%velocity(1, 1), 250.0_wp, 1e-6_wp, 'it has hit')
    call fly(sim, law_iqs, 0.72_wp, 1)
    call t%equal(sim%totals%passings, 0, 'a law that sees gaps lets nothing pass')
    call fly(sim, law_velocity, 0.72_wp, 5)
    call t%equal(sim%totals%passings, 0, 'nor do shorter steps')
  end subroutine test_balls

  !> A ball and a wall: the sum of radius and half thickness, 0.15, is what counts.
  subroutine test_wall()
    type(simulation_t) :: sim

    call fly(sim, law_velocity, 0.72_wp, 1, 0.05_wp)
    call t%equal(sim%totals%passings, 1, 'a ball has passed a wall')
    call fly(sim, law_velocity, 0.78_wp, 1, 0.05_wp)
    call t%equal(sim%totals%passings, 0, 'and has not')
  end subroutine test_wall

  !> Make a disk fly at another one, or at a wall, for three milliseconds.
  subroutine fly(sim, law, distance, cut, half_thickness)
    type(simulation_t), intent(out) :: sim
    integer, intent(in) :: law, cut
    real(wp), intent(in) :: distance
    real(wp), intent(in), optional :: half_thickness
    type(error_t), allocatable :: error
    integer :: i

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
end program test_passing
