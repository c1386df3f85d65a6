!> Decks in space: dimension, shapes, principal frames, walls, containers, masonry, drives, the effective deck.
program test_deck_space
  use harness, only: tests_t
  use sg_contactors, only: kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, kind_sphere, place_contactors
  use sg_convex_hull, only: hull_is_available
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_rotations, only: frame_of, rotation_by, turned_by
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_text, only: text_t, to_text
  use written_files, only: put_lines, read_deck_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: head = '[scene]'//nl//'dimension = 3'//nl//'[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl// &
                                        '[[material]]'//nl//'name = "stone"'//nl//'density = 2000'//nl//'[[law]]'//nl
  type(tests_t) :: t

  call test_minimal()
  call test_dimension_setting()
  call test_shapes()
  call test_polyhedra()
  call test_cluster()
  call test_mass()
  call test_walls()
  call test_pressed_wall()
  call test_containers()
  call test_brick_wall()
  call test_arch()
  call test_drives()
  call test_interactions()
  call test_mesh_file()
  call test_effective()
  call t%finish()

contains

  !> Read a deck from a text; it has no mistakes.
  subroutine read_text(text, scene, options, settings, is_warned)
    character(len=*), intent(in) :: text
    type(scene_t), intent(out) :: scene
    type(run_options_t), intent(out), optional :: options
    type(text_t), intent(in), optional :: settings(:)
    logical, intent(in), optional :: is_warned
    type(run_options_t) :: chosen
    type(diagnostics_t) :: diagnostics
    integer :: i

    call read_deck_text(text, scene, chosen, diagnostics, settings)
    do i = 1, diagnostics%count()
      call t%check(.false., 'a mistake: '//diagnostics%errors(i)%sentence())
    end do
    if (present(is_warned)) then
      call t%check(allocated(diagnostics%warnings) .eqv. is_warned, 'a warning')
    else
      call t%check(.not. allocated(diagnostics%warnings), 'no warnings')
    end if
    if (present(options)) options = chosen
  end subroutine read_text

  !> Largest difference of two vectors, against a limit: rounding of numbers of size one unless given.
  subroutine close_to(got, wanted, name, limit)
    real(wp), intent(in) :: got(:), wanted(:)
    character(len=*), intent(in) :: name
    real(wp), intent(in), optional :: limit
    real(wp) :: most

    most = 1e-14_wp
    if (present(limit)) most = limit
    call t%near(maxval(abs(got - wanted)), 0.0_wp, most, name)
  end subroutine close_to

  !> What is not said has its default.
  subroutine test_minimal()
    type(scene_t) :: scene

    call read_text(head//'[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.5'//nl, scene)
    call t%equal(scene%dimension, 3, 'in space')
    call close_to(scene%gravity, [0.0_wp, 0.0_wp, -9.81_wp], 'gravity downwards')
    call close_to(scene%bodies%position(:, 1), [0.0_wp, 0.0_wp, 0.0_wp], 'at the origin')
    call close_to(scene%bodies%orientation(:, 1), [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 'not turned')
    call t%check(all(scene%bodies%is_grain), 'a grain')
    call t%near(scene%bodies%mass(1), 2000*4*pi/3*0.125_wp, 1e-12_wp, 'its mass')
    call close_to(scene%bodies%principal(:, 1), spread(0.1_wp*scene%bodies%mass(1), 1, 3), 'its moments', 1e-12_wp)
    call close_to(scene%bodies%inverse_mass(:, 1)*[spread(scene%bodies%mass(1), 1, 3), scene%bodies%principal(:, 1)], &
                  spread(1.0_wp, 1, 6), 'and inverses')
  end subroutine test_minimal

  !> The dimension may come from a setting: all values are checked after it.
  subroutine test_dimension_setting()
    type(scene_t) :: scene
    type(text_t) :: settings(2)

    settings(1)%s = 'body.velocity=[1, 2, 3]'
    settings(2)%s = 'scene.dimension=3'
    call read_text(head(index(head, '[time]'):)//'[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.5'//nl, scene, &
                   settings=settings)
    call t%equal(scene%dimension, 3, 'a dimension that is set')
    call close_to(scene%bodies%velocity(:3, 1), [1.0_wp, 2.0_wp, 3.0_wp], 'a vector that is set')
    call close_to(scene%gravity, [0.0_wp, 0.0_wp, -9.81_wp], 'its defaults')
  end subroutine test_dimension_setting

  !> Kinds of shape, with sizes and places; boxes and hollow cylinders do not meet, which is warned of.
  subroutine test_shapes()
    type(scene_t) :: scene

    call read_text(head//'[[body]]'//nl//'shape = "plane"'//nl//'half_axes = [3, 2, 0.1]'//nl//'fixed = true'//nl// &
                   'position = [0, 0, -0.1]'//nl// &
                   '[[body]]'//nl//'shape = "cylinder"'//nl//'half_height = 0.5'//nl//'radius = 0.2'//nl// &
                   'position = [0, 0, 0.2]'//nl//'rotation = [0, '//to_text(pi/2, 16)//', 0]'//nl//'spin = [0, 0, 2]'//nl// &
                   'velocity = [1, 0, 0]'//nl// &
                   '[[body]]'//nl//'shape = "hollow cylinder"'//nl//'half_height = 5'//nl//'radius = 8'//nl//'fixed = true'//nl// &
                   '[[body]]'//nl//'shape = "box"'//nl//'half_axes = [0.3, 0.2, 0.1]'//nl//'position = [0, 1, 0.1]'//nl, scene, &
                   is_warned=.true.)
    call t%equal(scene%contactors%n, 4, 'four shapes')
    call t%check(all(scene%contactors%kind(:4) == [kind_plane, kind_cylinder, kind_hollow_cylinder, kind_polyhedron]), 'kinds')
    call t%check(all(scene%bodies%is_grain .eqv. [.false., .true., .false., .true.]), 'what is fixed is no grain')
    call t%equal(size(scene%drives), 12, 'six components each')
    scene%bodies%middle(:3, :) = scene%bodies%position
    scene%bodies%middle(4:, :) = scene%bodies%orientation
    call place_contactors(scene%contactors, scene%bodies%middle)
    associate (space => scene%contactors%space)
      call close_to(space%plane_half(:, 1), [3.0_wp, 2.0_wp, 0.1_wp], 'half axes')
      call close_to(abs(space%cylinder_world(:, 1)), [1.0_wp, 0.0_wp, 0.0_wp], 'a cylinder that lies', 1e-12_wp)
      call close_to(space%hollow_size(:, 1), [5.0_wp, 8.0_wp], 'a hollow cylinder')
      call t%equal(space%polyhedra(1)%n_vertices, 8, 'a box')
      call close_to(maxval(space%polyhedra(1)%world_vertex, 2), [0.3_wp, 1.2_wp, 0.2_wp], 'where it stands')
    end associate
    ! The spin is given in the world, and stored about principal axes.
    call close_to(turned_by(scene%bodies%orientation(:, 2), scene%bodies%velocity(4:, 2)), [0.0_wp, 0.0_wp, 2.0_wp], 'spin', &
                  1e-12_wp)
    call t%near(scene%bodies%mass(4), 2000*8*0.006_wp, 1e-12_wp, 'mass of a box')
    call close_to(scene%bodies%principal(:, 4), scene%bodies%mass(4)/3*[0.05_wp, 0.1_wp, 0.13_wp], 'moments of a box', 1e-12_wp)
  end subroutine test_shapes

  !> A tetrahedron from its faces, and from its vertices alone.
  subroutine test_polyhedra()
    character(len=*), parameter :: text = head//'[[body]]'//nl//'shape = "polyhedron"'//nl//'position = [0, 0, 5]'//nl// &
      'vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]'//nl
    type(scene_t) :: scene

    call read_text(text//'faces = [[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]'//nl, scene)
    call t%equal(scene%contactors%space%polyhedra(1)%n_faces, 4, 'faces of a tetrahedron')
    call t%near(scene%bodies%mass(1), 2000/6.0_wp, 1e-11_wp, 'its mass')
    call close_to(scene%bodies%position(:, 1), [0.25_wp, 0.25_wp, 5.25_wp], 'its centre')
    call in_principal_frame(scene, 1, 'a tetrahedron')
    if (.not. hull_is_available()) return
    call read_text(text, scene)
    call t%near(scene%bodies%mass(1), 2000/6.0_wp, 1e-11_wp, 'from its vertices')
  end subroutine test_polyhedra

  !> Are the shapes of a body of polyhedra written about its centre, along its principal axes?
  subroutine in_principal_frame(scene, body, name)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body
    character(len=*), intent(in) :: name
    real(wp) :: first(3), second(3, 3), volume, part
    integer :: c

    ! Tetrahedra between the origin and triangles: integrals of x and of x x^T.
    first = 0
    second = 0
    volume = 0
    do c = 1, scene%contactors%n
      if (scene%contactors%body(c) /= body .or. scene%contactors%kind(c) /= kind_polyhedron) cycle
      call add_moments(scene, c, volume, first, second)
    end do
    part = volume*maxval(scene%contactors%reach(:scene%contactors%n))
    call t%near(maxval(abs(first))/part, 0.0_wp, 1e-13_wp, name//': about its centre')
    part = second(1, 1) + second(2, 2) + second(3, 3)
    call t%near(max(abs(second(1, 2)), abs(second(1, 3)), abs(second(2, 3)))/part, 0.0_wp, 1e-9_wp, name//': principal axes')
    call close_to(scene%bodies%principal(:, body)/(2000*part), 1 - [second(1, 1), second(2, 2), second(3, 3)]/part, &
                  name//': principal moments', 1e-9_wp)
  end subroutine in_principal_frame

  !> Add the integrals of 1, x and x x^T over a polyhedron, in the frame of its body.
  subroutine add_moments(scene, c, volume, first, second)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: c
    real(wp), intent(inout) :: volume, first(3), second(3, 3)
    real(wp) :: a(3), b(3), d(3), s(3), determinant
    integer :: f, k, i

    associate (shape => scene%contactors%space%polyhedra(scene%contactors%row(c)), shift => scene%contactors%shift(:, c))
      do f = 1, shape%n_faces
        a = shift + shape%vertex(:, shape%face_vertex(shape%face_first(f)))
        do k = shape%face_first(f) + 1, shape%face_first(f + 1) - 2
          b = shift + shape%vertex(:, shape%face_vertex(k))
          d = shift + shape%vertex(:, shape%face_vertex(k + 1))
          determinant = a(1)*(b(2)*d(3) - b(3)*d(2)) + a(2)*(b(3)*d(1) - b(1)*d(3)) + a(3)*(b(1)*d(2) - b(2)*d(1))
          s = a + b + d
          volume = volume + determinant/6
          first = first + determinant/24*s
          do i = 1, 3
            second(:, i) = second(:, i) + determinant/120*(a*a(i) + b*b(i) + d*d(i) + s*s(i))
          end do
        end do
      end do
    end associate
  end subroutine add_moments

  !> A cluster that is turned: its shapes stand in the world where the deck puts them.
  subroutine test_cluster()
    type(scene_t) :: scene
    real(wp) :: frame(3, 3), corner(3)
    real(wp), parameter :: place(3) = [1.0_wp, 2.0_wp, 3.0_wp], turn(3) = [0.3_wp, -0.5_wp, 0.7_wp]

    call read_text(head//'[[body]]'//nl//'position = [1, 2, 3]'//nl//'rotation = [0.3, -0.5, 0.7]'//nl//'spin = [1, 2, 3]'//nl// &
                   '[[body.shape]]'//nl//'kind = "box"'//nl//'half_axes = [0.5, 0.1, 0.2]'//nl//'centre = [0.5, 0, 0]'//nl// &
                   '[[body.shape]]'//nl//'kind = "box"'//nl//'half_axes = [0.1, 0.4, 0.2]'//nl//'centre = [0, 0.6, 0.3]'//nl// &
                   'rotation = [0, 0, 0.4]'//nl//'[[body.shape]]'//nl//'kind = "sphere"'//nl//'radius = 1e-9'//nl// &
                   'centre = [1, 0.1, 0.2]'//nl, scene)
    call t%equal(scene%bodies%n, 1, 'one body')
    call t%equal(scene%contactors%n, 3, 'three shapes')
    call in_principal_frame(scene, 1, 'a cluster')
    scene%bodies%middle(:3, :) = scene%bodies%position
    scene%bodies%middle(4:, :) = scene%bodies%orientation
    call place_contactors(scene%contactors, scene%bodies%middle)
    frame = frame_of(rotation_by(turn))
    ! A corner of the first box, and the sphere at that corner.
    corner = place + matmul(frame, [1.0_wp, 0.1_wp, 0.2_wp])
    call close_to(scene%contactors%centre(:, 3), corner, 'a sphere where the deck puts it', 1e-13_wp)
    associate (box => scene%contactors%space%polyhedra(1), other => scene%contactors%space%polyhedra(2))
      call t%near(minval(norm2(box%world_vertex - spread(corner, 2, 8), 1)), 0.0_wp, 1e-13_wp, 'a corner where the deck puts it')
      corner = place + matmul(frame, [0.0_wp, 0.6_wp, 0.3_wp] + &
                              matmul(frame_of(rotation_by([0.0_wp, 0.0_wp, 0.4_wp])), [0.1_wp, -0.4_wp, 0.2_wp]))
      call t%near(minval(norm2(other%world_vertex - spread(corner, 2, 8), 1)), 0.0_wp, 1e-13_wp, 'and one of a turned shape')
    end associate
    call close_to(turned_by(scene%bodies%orientation(:, 1), scene%bodies%velocity(4:, 1)), [1.0_wp, 2.0_wp, 3.0_wp], &
                  'spin about axes of the world', 1e-13_wp)
  end subroutine test_cluster

  !> Mass and moments that are given.
  subroutine test_mass()
    character(len=*), parameter :: box = head//'[[body]]'//nl//'shape = "box"'//nl//'half_axes = [0.3, 0.2, 0.1]'//nl
    type(scene_t) :: scene

    call read_text(box//'mass = 3'//nl, scene)
    call close_to(scene%bodies%principal(:, 1), [0.05_wp, 0.1_wp, 0.13_wp], 'moments follow a mass')
    call read_text(box//'inertia = [1, 2, 2.5]'//nl, scene)
    call close_to(scene%bodies%principal(:, 1), [1.0_wp, 2.0_wp, 2.5_wp], 'moments that are given')
    call t%near(scene%bodies%inverse_mass(5, 1), 0.5_wp, 1e-15_wp, 'their inverse')
    call test_capsule()
    call read_text(head//'[[body]]'//nl//'shape = "hollow cylinder"'//nl//'radius = 1'//nl//'half_height = 1'//nl// &
                   'mass = 2'//nl// &
                   'inertia = [1, 1, 1]'//nl, scene)
    call t%near(scene%bodies%mass(1), 2.0_wp, 0.0_wp, 'a hollow cylinder that moves')
  end subroutine test_mass

  !> A capsule that is turned within its body: the same moments, about its axis the least, and in the world the same capsule.
  subroutine test_capsule()
    type(scene_t) :: scene
    real(wp) :: ball, cylinder, along, across

    call read_text(head//'[[body]]'//nl//'position = [0, 0, 2]'//nl//'[[body.shape]]'//nl//'kind = "cylinder"'//nl// &
                   'half_height = 0.5'//nl//'radius = 0.2'//nl//'rotation = [0.4, 0.9, 0]'//nl//'centre = [1, 0, 0]'//nl, scene)
    ! Two half balls whose centres lie 3/8 of the radius beyond the ends of the axis, and a cylinder.
    ball = 2000*4*pi/3*0.2_wp**3
    cylinder = 2000*pi*0.2_wp**2
    along = (ball*0.4_wp + cylinder/2)*0.2_wp**2
    across = ball*(0.4_wp*0.2_wp**2 + 0.5_wp**2 + 0.75_wp*0.5_wp*0.2_wp) + cylinder*(0.2_wp**2/4 + 0.5_wp**2/3)
    call t%near(scene%bodies%mass(1), ball + cylinder, 1e-11_wp, 'mass of a capsule')
    call t%near(minval(scene%bodies%principal(:, 1)), along, 1e-9_wp*across, 'moment along its axis')
    call t%near(maxval(scene%bodies%principal(:, 1)), across, 1e-9_wp*across, 'moment across it')
    call close_to(scene%bodies%position(:, 1), [1.0_wp, 0.0_wp, 2.0_wp], 'its centre')
    scene%bodies%middle(:3, :) = scene%bodies%position
    scene%bodies%middle(4:, :) = scene%bodies%orientation
    call place_contactors(scene%contactors, scene%bodies%middle)
    call close_to(scene%contactors%space%cylinder_world(:, 1), &
                  matmul(frame_of(rotation_by([0.4_wp, 0.9_wp, 0.0_wp])), [0.0_wp, 0.0_wp, 1.0_wp]), 'its axis in the world', &
                  1e-13_wp)
  end subroutine test_capsule

  !> Walls: their faces lie where the deck says, level sides first.
  subroutine test_walls()
    type(scene_t) :: scene
    integer :: i
    real(wp) :: world(3, 3), face(3)

    call read_text(head//'[[wall]]'//nl//'centre = [1, 2, 3]'//nl//'size = [4, 5]'//nl//'thickness = 0.2'//nl// &
                   '[[wall]]'//nl//'centre = [1, 2, 3]'//nl//'size = [4, 5]'//nl//'thickness = 0.2'//nl// &
                   'normal = [-2, 0, 0]'//nl// &
                   '[[wall]]'//nl//'centre = [1, 2, 3]'//nl//'size = [4, 5]'//nl//'thickness = 0.2'//nl// &
                   'normal = [1, 2, 2]'//nl// &
                   'velocity = [0.1, 0, 0]'//nl, scene)
    scene%bodies%middle(:3, :) = scene%bodies%position
    scene%bodies%middle(4:, :) = scene%bodies%orientation
    call place_contactors(scene%contactors, scene%bodies%middle)
    do i = 1, 3
      world = reshape(scene%contactors%space%plane_world(:, i), [3, 3])
      face = scene%contactors%centre(:, i) + 0.1_wp*world(:, 3)
      call close_to(face, [1.0_wp, 2.0_wp, 3.0_wp], 'centre of the face')
      call close_to(scene%contactors%space%plane_half(:, i), [2.0_wp, 2.5_wp, 0.1_wp], 'half axes')
      call t%near(world(3, 1), 0.0_wp, 1e-15_wp, 'the first side is level')
      if (i > 1) call t%check(world(3, 2) > 0, 'the second rises')
    end do
    call close_to(world(:, 3), [1.0_wp, 2.0_wp, 2.0_wp]/3, 'an oblique normal')
    call close_to([(scene%drives(12 + i)%value%constant, i=1, 6)], [0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
                  'a wall keeps its velocity')
    call t%check(.not. any(scene%bodies%is_grain), 'walls are no grains')
  end subroutine test_walls

  !> A wall under pressure moves along it alone.
  subroutine test_pressed_wall()
    type(scene_t) :: scene

    call read_text(head//'[[wall]]'//nl//'centre = [0, 0, 1]'//nl//'normal = [0, 0, -1]'//nl//'size = [2, 3]'//nl// &
                   'thickness = 0.1'//nl//'pressure = 7'//nl//'direction = [0, 0, -2]'//nl, scene)
    call t%equal(size(scene%pressures), 1, 'a pressure')
    call t%near(scene%pressures(1)%length, 6.0_wp, 1e-15_wp, 'its area')
    call close_to(scene%pressures(1)%direction, [0.0_wp, 0.0_wp, -1.0_wp], 'its direction')
    call t%near(scene%pressures(1)%value%constant, 7.0_wp, 0.0_wp, 'its value')
    call t%check(all(scene%drives%component /= 3) .and. size(scene%drives) == 5, 'all but z is held')
  end subroutine test_pressed_wall

  !> Containers: inner faces bound the room; no sides along periods.
  subroutine test_containers()
    type(scene_t) :: scene

    call read_text(head//'[[container]]'//nl//'corner = [1, 2, 3]'//nl//'size = [4, 5, 6]'//nl//'thickness = 0.2'//nl// &
                   'lid = true'//nl, scene)
    call t%equal(scene%bodies%n, 6, 'six planes')
    call t%near(position_of(scene, 'box.floor', 3), 2.9_wp, 1e-14_wp, 'floor')
    call t%near(position_of(scene, 'box.lid', 3), 9.1_wp, 1e-14_wp, 'lid')
    call t%near(position_of(scene, 'box.left', 1), 0.9_wp, 1e-14_wp, 'left')
    call t%near(position_of(scene, 'box.right', 1), 5.1_wp, 1e-14_wp, 'right')
    call t%near(position_of(scene, 'box.front', 2), 1.9_wp, 1e-14_wp, 'front')
    call t%near(position_of(scene, 'box.back', 2), 7.1_wp, 1e-14_wp, 'back')
    call t%equal(size(scene%drives), 36, 'all held')
    call read_text(head(:index(head, '[time]') - 1)//'period_x = 4'//nl//head(index(head, '[time]'):)//'[[container]]'//nl// &
                   'size = [4, 5, 6]'//nl//'name = "shear"'//nl//'[[pressure]]'//nl//'body = "shear.floor"'//nl// &
                   'direction = [0, 0, 1]'//nl//'area = 20'//nl//'value = 1'//nl, scene)
    call t%equal(scene%bodies%n, 3, 'a floor and two sides')
    call t%equal(size(scene%drives), 17, 'all held but what is pressed')
    call t%near(2*scene%contactors%space%plane_half(1, 1), 4.0_wp, 1e-14_wp, 'as long as the period')
    call read_text(head//'[[container]]'//nl//'size = [4, 5, 6]'//nl//'sides = false'//nl, scene)
    call t%equal(scene%bodies%n, 1, 'a floor alone')
  end subroutine test_containers

  !> A coordinate of a body by name.
  real(wp) function position_of(scene, name, axis) result(x)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: name
    integer, intent(in) :: axis
    integer :: i

    x = huge(x)
    do i = 1, scene%bodies%n
      if (scene%names(i)%s == name) x = scene%bodies%position(axis, i)
    end do
    call t%check(x < huge(x), 'there is '//name)
  end function position_of

  !> Running bond: bricks, half bricks, length, mass.
  subroutine test_brick_wall()
    type(scene_t) :: scene
    real(wp) :: low(3), high(3)
    integer :: i

    call read_text(head//'[[brick_wall]]'//nl//'rows = 4'//nl//'columns = 3'//nl//'brick = [0.2, 0.1, 0.05]'//nl// &
                   'joint = 0.01'//nl//'position = [1, 2, 3]'//nl//'angle = '//to_text(pi/2, 16)//nl, scene)
    call t%equal(scene%bodies%n, 3 + 4 + 3 + 4, 'bricks')
    low = huge(1.0_wp)
    high = -low
    scene%bodies%middle(:3, :) = scene%bodies%position
    scene%bodies%middle(4:, :) = scene%bodies%orientation
    call place_contactors(scene%contactors, scene%bodies%middle)
    do i = 1, scene%contactors%n
      low = min(low, minval(scene%contactors%space%polyhedra(i)%world_vertex, 2))
      high = max(high, maxval(scene%contactors%space%polyhedra(i)%world_vertex, 2))
    end do
    ! Along y, from its position on: three bricks and two joints.
    call close_to(low, [0.95_wp, 2.0_wp, 3.0_wp], 'where it begins')
    call close_to(high, [1.05_wp, 2.62_wp, 3.2_wp], 'where it ends')
    call t%near(position_of(scene, 'wall.1.2', 2), 2.31_wp, 1e-14_wp, 'the second brick')
    call t%near(position_of(scene, 'wall.2.4', 3), 3.075_wp, 1e-14_wp, 'the last of the second row')
    call t%near(scene%bodies%mass(4), 2000*0.095_wp*0.1_wp*0.05_wp, 1e-12_wp, 'half a brick')
  end subroutine test_brick_wall

  !> An arch: volume of all voussoirs, springers on the ground, held ends.
  subroutine test_arch()
    type(scene_t) :: scene
    real(wp) :: low, half

    call read_text(head//'[[arch]]'//nl//'voussoirs = 9'//nl//'inner_radius = 0.9'//nl//'outer_radius = 1.1'//nl// &
                   'depth = 0.3'//nl// &
                   'centre = [5, 0, 1]'//nl//'fixed_ends = true'//nl, scene)
    call t%equal(scene%bodies%n, 9, 'voussoirs')
    half = pi/18
    call t%near(sum(scene%bodies%area), 9*0.3_wp*(1.1_wp**2 - 0.9_wp**2)*sin(half)*cos(half), 1e-13_wp, 'volume of nine trapezia')
    scene%bodies%middle(:3, :) = scene%bodies%position
    scene%bodies%middle(4:, :) = scene%bodies%orientation
    call place_contactors(scene%contactors, scene%bodies%middle)
    low = minval(scene%contactors%space%polyhedra(1)%world_vertex(3, :))
    call t%near(low, 1.0_wp, 1e-13_wp, 'the springer stands at the height of the centre')
    call t%near(scene%bodies%position(1, 5), 5.0_wp, 1e-13_wp, 'the keystone stands in the middle')
    call t%check(position_of(scene, 'arch.1', 1) < position_of(scene, 'arch.9', 1), 'numbered along x')
    call t%check(count(.not. scene%bodies%is_grain) == 2 .and. size(scene%drives) == 12, 'two ends are held')
    call t%check(.not. scene%bodies%is_grain(1) .and. .not. scene%bodies%is_grain(9), 'the first and the last')
  end subroutine test_arch

  !> Drives and pressures.
  subroutine test_drives()
    type(scene_t) :: scene
    character(len=*), parameter :: ball = '[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.5'//nl//'name = "ball"'//nl

    call read_text(head//ball//'[[drive]]'//nl//'body = "ball"'//nl//'component = "rotation_y"'//nl//'value = 3'//nl// &
                   '[[drive]]'//nl//'body = "ball"'//nl//'component = "z"'//nl//'kind = "force"'//nl//'value = 4'//nl// &
                   '[[pressure]]'//nl//'body = 1'//nl//'direction = [0, 3, 4]'//nl//'area = 2'//nl//'value = 5'//nl, scene)
    call t%check(scene%drives(1)%component == 5 .and. scene%drives(1)%is_velocity, 'a spin')
    call t%check(scene%drives(2)%component == 3 .and. .not. scene%drives(2)%is_velocity, 'a force')
    call close_to(scene%pressures(1)%direction, [0.0_wp, 0.6_wp, 0.8_wp], 'direction of a pressure')
    call t%near(scene%pressures(1)%length, 2.0_wp, 0.0_wp, 'its area')
    call t%check(.not. scene%bodies%is_grain(1), 'what is driven is no grain')
  end subroutine test_drives

  !> Shapes in interactions, and the default alert distance.
  subroutine test_interactions()
    type(scene_t) :: scene

    call read_text(head//'[[interaction]]'//nl//'candidate_shape = "cylinder"'//nl//'antagonist_shape = "hollow cylinder"'//nl// &
                   '[[body]]'//nl//'shape = "cylinder"'//nl//'half_height = 0.5'//nl//'radius = 0.2'//nl//'[[body]]'//nl// &
                   'shape = "hollow cylinder"'//nl//'half_height = 5'//nl//'radius = 8'//nl//'fixed = true'//nl, scene)
    call t%check(scene%sees(1)%candidate_kind == kind_cylinder .and. scene%sees(1)%antagonist_kind == kind_hollow_cylinder, &
                 'shapes of an interaction')
    call read_text(head//'[[body]]'//nl//'shape = "sphere"'//nl//'radius = 0.5'//nl//'velocity = [0, 0, 100]'//nl, scene)
    call t%equal(int(scene%contactors%kind(1)), kind_sphere, 'a sphere')
    ! Its speed and that of a fall through a diameter, for one millisecond.
    call t%near(scene%sees(1)%alert, 1e-3_wp*(100 + sqrt(2*9.81_wp)), 1e-12_wp, 'default alert distance')
  end subroutine test_interactions

  !> A cube from an OBJ file, in millimetres.
  subroutine test_mesh_file()
    type(scene_t) :: scene

    call put_lines('cube.obj', [character(len=13) :: 'v 0 0 0', 'v 200 0 0', 'v 200 200 0', 'v 0 200 0', 'v 0 0 200', &
                                'v 200 0 200', 'v 200 200 200', 'v 0 200 200', 'f 1 4 3 2', 'f 5 6 7 8', 'f 1 2 6 5', &
                                'f 2 3 7 6', 'f 3 4 8 7', 'f 4 1 5 8'])
    call read_text(head//'[[body]]'//nl//'shape = "polyhedron"'//nl//'file = "cube.obj"'//nl//'scale = 1e-3'//nl, scene)
    call t%near(scene%bodies%mass(1), 16.0_wp, 1e-12_wp, 'mass of a cube')
    call close_to(scene%bodies%position(:, 1), [0.1_wp, 0.1_wp, 0.1_wp], 'its centre')
    if (.not. hull_is_available()) return
    call read_text(head//'[[body]]'//nl//'shape = "polyhedron"'//nl//'file = "cube.obj"'//nl//'scale = 1e-3'//nl// &
                   'hull = true'//nl, &
                   scene)
    call t%near(scene%bodies%mass(1), 16.0_wp, 1e-12_wp, 'its hull')
  end subroutine test_mesh_file

  !> The effective deck makes the same scene, and is its own effective deck.
  subroutine test_effective()
    type(scene_t) :: scene, again
    type(run_options_t) :: options, others
    character(len=:), allocatable :: text

    text = head(:index(head, '[time]') - 1)//'period_y = 9'//nl//head(index(head, '[time]'):)//'friction = 0.3'//nl// &
           '[[wall]]'//nl//'centre = [1, 2, -1]'//nl//'size = [4, 5]'//nl//'thickness = 0.2'//nl// &
           '[[container]]'//nl//'size = [9, 9, 9]'//nl//'[[brick_wall]]'//nl//'position = [1, 1, 0]'//nl//'rows = 2'//nl// &
           'columns = 2'//nl//'brick = [0.2, 0.1, 0.05]'//nl//'[[arch]]'//nl//'voussoirs = 5'//nl//'inner_radius = 0.9'//nl// &
           'outer_radius = 1.1'//nl//'depth = 0.3'//nl//'centre = [5, 4, 0]'//nl//'[[sample]]'//nl//'radius = 0.1'//nl// &
           'box = [4, 6, 2, 6, 8, 4]'//nl//'count = 20'//nl//'[[body]]'//nl//'position = [5, 5, 5]'//nl// &
                   'rotation = [1, 0, 0]'//nl// &
           '[[body.shape]]'//nl//'kind = "polyhedron"'//nl//'vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]'//nl// &
           'faces = [[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]'//nl//'[[body.shape]]'//nl//'kind = "sphere"'//nl// &
                   'radius = 0.2'//nl
    call read_text(text, scene, options)
    call read_text(options%deck_text, again, others)
    call t%check(options%deck_hash == others%deck_hash, 'the effective deck is its own')
    call t%equal(again%bodies%n, scene%bodies%n, 'as many bodies')
    call t%near(maxval(abs(again%bodies%position - scene%bodies%position)), 0.0_wp, 0.0_wp, 'at the same places')
    call t%near(maxval(abs(again%bodies%orientation - scene%bodies%orientation)), 0.0_wp, 0.0_wp, 'turned the same')
    call t%near(maxval(abs(again%bodies%principal - scene%bodies%principal)), 0.0_wp, 0.0_wp, 'with the same moments')
    call t%near(again%period_y, 9.0_wp, 0.0_wp, 'the same period')
    call t%check(index(options%deck_text, 'angle = 0.0'//nl//'rows') > 0 .or. index(options%deck_text, 'period_y = 9.0') > 0, &
                 'what it says')
    call t%equal(index(options%deck_text, 'half_thickness'), 0, 'nothing of the plane')
  end subroutine test_effective
end program test_deck_space
