!> Scenes of space written as DATBOX folders and read again: bodies askew, shapes of every kind, drives, contacts; and what
!! the format cannot hold.
program test_datbox_space_written
  use harness, only: tests_t
  use scenes, only: place_bodies
  use sg_contactors, only: kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron
  use sg_datbox, only: read_datbox
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start
  use sg_drives, only: drive_t
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, i4
  use sg_laws, only: law_iqs, law_t, status_slide, status_stick
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_triangles
  use sg_rotations, only: frame_of, rotation_by, turned_by
  use sg_scene, only: colour_index, material_t, scene_t, see_t, start_contact_t
  use sg_solid_bodies, only: make_solid_body, set_inertia
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  use sg_time_functions, only: time_function_t
  use space_reference, only: vertex_distance
  implicit none
  real(wp), parameter :: density = 2000
  type(tests_t) :: tests

  call test_made_bodies()
  call test_what_cannot_be_written()
  call tests%finish()

contains

  !> Bodies made here, in all orientations, written and read: what stands askew is written upright, what is alone stays so.
  subroutine test_made_bodies()
    type(scene_t) :: scene
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(time_function_t) :: value
    integer, parameter :: n = 8
    real(wp), parameter :: centre(3) = 0
    real(wp), parameter :: across(3, 3) = reshape([0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], [3, 3])
    integer :: b, first

    call start_scene(scene, n)
    do b = 1, n
      scene%bodies%position(:, b) = [0.1_wp, -0.3_wp, 0.7_wp]*real(b, wp)
      scene%bodies%orientation(:, b) = rotation_by([0.7_wp, -0.2_wp, 0.35_wp]*real(b, wp))
      first = scene%contactors%n + 1
      select case (b)
      case (1)
        call add_sphere(scene%contactors, b, 1, 0.1_wp, centre)
      case (2)
        call add_plane(scene%contactors, b, 1, [1.0_wp, 0.5_wp, 0.1_wp], centre, across)
      case (3)
        call add_cylinder(scene%contactors, b, 1, 0.5_wp, 0.4_wp, centre, [0.0_wp, -1.0_wp, 0.0_wp])
      case (4)
        call add_sphere(scene%contactors, b, 1, 0.1_wp, [0.2_wp, 0.1_wp, 0.0_wp])
        call add_plane(scene%contactors, b, 1, [0.3_wp, 0.2_wp, 0.1_wp], [0.0_wp, 0.0_wp, 0.3_wp], &
                       frame_of(rotation_by([0.3_wp, 0.2_wp, 0.1_wp])))
      case (5)
        call add_hollow_cylinder(scene%contactors, b, 1, 0.5_wp, 0.4_wp, centre, [0.0_wp, -1.0_wp, 0.0_wp])
      case (6)
        call add_cylinder(scene%contactors, b, 1, 0.5_wp, 0.4_wp, [0.0_wp, 0.1_wp, 0.3_wp], [0.6_wp, 0.0_wp, 0.8_wp])
        call add_cylinder(scene%contactors, b, 1, 0.5_wp, 0.4_wp, [0.0_wp, -0.1_wp, -0.3_wp], [0.6_wp, 0.0_wp, -0.8_wp])
      case default
        call polyhedron_from_triangles(reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.3_wp*real(b, wp), 0.1_wp, 0.0_wp, 0.1_wp, &
                                                0.2_wp*real(b, wp), 0.1_wp, &
                                                0.05_wp, 0.1_wp, 0.5_wp], [3, 4]), &
                                       reshape(int([1, 3, 2, 1, 2, 4, 2, 3, 4, 1, 4, 3], i4), [3, 4]), shape, error)
        call tests%check(.not. allocated(error), 'a tetrahedron')
        call add_polyhedron(scene%contactors, b, 1, shape, centre)
      end select
      call make_solid_body(scene%bodies, scene%contactors, b, first, scene%contactors%n, density)
      if (b == 5) call set_inertia(scene%bodies, b, 10.0_wp, [1.0_wp, 2.0_wp, 1.5_wp])
      scene%bodies%velocity(:, b) = [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, 6.0_wp]/real(b, wp)
      scene%bodies%material(b) = 1
    end do
    value%constant = 2
    scene%drives = [drive_t(2, 4, .true., value), drive_t(2, 6, .true., value), drive_t(3, 5, .false., value)]
    scene%start_contacts = [start_contact_t([1, 2], [0.1_wp, 0.2_wp, 0.3_wp], [3.0_wp, -4.0_wp, 5.0_wp], status_stick, .true.), &
                            start_contact_t([9, 10], [0.1_wp, 0.2_wp, 0.3_wp], [0.0_wp, 0.0_wp, -5.0_wp], status_slide, .true.)]
    call compare_again(scene, 'bodies made here')
  end subroutine test_made_bodies

  !> A scene with a material, a law, see tables and gravity, and room for bodies.
  subroutine start_scene(scene, n)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n
    type(material_t) :: stone
    type(law_t) :: law
    integer :: colour

    scene%dimension = 3
    scene%contactors%dimension = 3
    scene%gravity = [0.1_wp, 0.2_wp, -9.81_wp]
    stone%name = 'a long name'
    stone%density = density
    scene%materials = [stone]
    law%name = 'rubbing'
    law%kind = law_iqs
    law%static_friction = 0.3_wp
    law%dynamic_friction = 0.3_wp
    scene%laws = [law]
    call colour_index(scene, 'grey', colour)
    scene%sees = [see_t(law=1, alert=1e-3_wp)]
    allocate (scene%pressures(0))
    call scene%bodies%allocate(n, 3)
  end subroutine start_scene

  !> Write a scene, read it, and compare what both have in the world: eight digits, the axes of a body perhaps in another order.
  subroutine compare_again(a, name)
    type(scene_t), intent(inout) :: a
    character(len=*), intent(in) :: name
    type(scene_t) :: b
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    integer :: i, k

    call write_datbox('datbox_solids_again', a, contacts_at_start(a), 0.5_wp, 7, error)
    call tests%check(.not. allocated(error), name//' can be written')
    if (allocated(error)) then
      write (*, '(a)') error%report()
      return
    end if
    call read_datbox('datbox_solids_again', b, diagnostics)
    call tests%equal(diagnostics%count(), 0, name//' can be read again')
    if (diagnostics%count() > 0) then
      call diagnostics%print(6)
      return
    end if
    call place_bodies(a)
    call place_bodies(b)
    associate (x => a%bodies, y => b%bodies)
      call tests%check(maxval(abs(x%position - y%position)) < 1e-6_wp, 'places of '//name)
      call tests%check(all(abs(x%mass - y%mass) < 2e-7_wp*x%mass), 'masses of '//name)
      call tests%check(all(abs(x%velocity(:3, :) - y%velocity(:3, :)) <= 1e-7_wp*abs(x%velocity(:3, :))), 'velocities of '//name)
      do i = 1, x%n
        call tests%check(maxval(abs(tensor(x%principal(:, i), x%orientation(:, i)) &
                                    - tensor(y%principal(:, i), y%orientation(:, i)))) < 3e-7_wp*maxval(x%principal(:, i)), &
                         'inertia in the world of '//name)
        call tests%check(norm2(turned_by(x%orientation(:, i), x%velocity(4:6, i)) &
                               - turned_by(y%orientation(:, i), y%velocity(4:6, i))) < 1e-6_wp*(1 + norm2(x%velocity(4:6, i))), &
                         'spins in the world of '//name)
      end do
    end associate
    call tests%check(all(a%contactors%kind(:a%contactors%n) == b%contactors%kind(:b%contactors%n)), 'kinds of '//name)
    call tests%check(all(abs(a%gravity - b%gravity) < 1e-6_wp), 'gravity of '//name)
    do i = 1, a%contactors%n
      ! Of a polyhedron any point may be called its centre: the vertices are compared below.
      if (a%contactors%kind(i) == kind_polyhedron) cycle
      call tests%check(norm2(a%contactors%centre(:, i) - b%contactors%centre(:, i)) < 1e-6_wp, 'centres of '//name)
    end do
    call compare_shapes(a, b, name)
    call tests%equal(size(b%drives), size(a%drives), 'drives of '//name)
    do i = 1, size(a%drives)
      call tests%check(norm2(driven(a, i) - driven(b, i)) < 1e-6_wp, 'drives in the world of '//name)
    end do
    call tests%equal(size(b%start_contacts), size(a%start_contacts), 'contacts of '//name)
    do k = 1, size(a%start_contacts)
      call tests%check(norm2(a%start_contacts(k)%force - b%start_contacts(k)%force) < 1e-6_wp*norm2(a%start_contacts(k)%force) &
                       .and. all(a%start_contacts(k)%contactor == b%start_contacts(k)%contactor), 'contacts of '//name)
    end do
  end subroutine compare_again

  !> Compare planes, cylinders and polyhedra in the world.
  subroutine compare_shapes(a, b, name)
    type(scene_t), intent(in) :: a, b
    character(len=*), intent(in) :: name
    integer :: row, k

    do row = 1, a%contactors%n_rows(kind_plane)
      call tests%check(norm2(a%contactors%space%plane_world(7:9, row) - b%contactors%space%plane_world(7:9, row)) < 1e-6_wp, &
                       'planes of '//name)
    end do
    do row = 1, a%contactors%n_rows(kind_cylinder)
      call tests%check(norm2(a%contactors%space%cylinder_world(:, row) - b%contactors%space%cylinder_world(:, row)) < 1e-6_wp, &
                       'cylinders of '//name)
    end do
    do row = 1, a%contactors%n_rows(kind_hollow_cylinder)
      call tests%check(norm2(a%contactors%space%hollow_world(:, row) - b%contactors%space%hollow_world(:, row)) < 1e-6_wp, &
                       'hollow cylinders of '//name)
    end do
    do row = 1, a%contactors%n_rows(kind_polyhedron)
      do k = 1, a%contactors%space%polyhedra(row)%n_vertices
        call tests%check(vertex_distance(b%contactors%space%polyhedra(row), a%contactors%space%polyhedra(row)%world_vertex(:, k)) &
                         < 2e-6_wp, 'vertices of '//name)
      end do
    end do
  end subroutine compare_shapes

  !> Inertia tensor in the world.
  pure function tensor(principal, orientation)
    real(wp), intent(in) :: principal(3), orientation(4)
    real(wp) :: tensor(3, 3), frame(3, 3)
    integer :: k

    frame = frame_of(orientation)
    do k = 1, 3
      tensor(:, k) = matmul(frame, principal*frame(k, :))
    end do
  end function tensor

  !> What a drive imposes at the start, as a vector of the world.
  pure function driven(scene, i) result(v)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: i
    real(wp) :: v(3)

    v = 0
    associate (drive => scene%drives(i))
      v(1 + mod(drive%component - 1, 3)) = drive%value%at(0.0_wp)
      if (drive%component > 3) v = turned_by(scene%bodies%orientation(:, drive%body), v)
    end associate
  end function driven

  !> What the format cannot hold is refused by name.
  subroutine test_what_cannot_be_written()
    type(scene_t) :: scene
    type(error_t), allocatable :: error

    call start_scene(scene, 1)
    allocate (scene%drives(0))
    scene%bodies%material = 1
    call write_datbox('datbox_refused', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call expect(error, 'no shape')
    call add_hollow_cylinder(scene%contactors, 1, 1, 0.5_wp, 0.4_wp, [0.1_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 1.0_wp])
    call set_inertia(scene%bodies, 1, 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp])
    call write_datbox('datbox_refused', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call expect(error, 'hollow cylinder')
    scene%contactors%shift = 0
    call add_sphere(scene%contactors, 1, 1, 0.1_wp, [1.0_wp, 0.0_wp, 0.0_wp])
    call write_datbox('datbox_refused', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call expect(error, 'its centre')
    scene%bodies%material = 0
    call write_datbox('datbox_refused', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call expect(error, 'no material')
  end subroutine test_what_cannot_be_written

  !> The error holds this fragment.
  subroutine expect(error, fragment)
    type(error_t), allocatable, intent(in) :: error
    character(len=*), intent(in) :: fragment

    call tests%check(allocated(error), 'not refused: '//fragment)
    if (.not. allocated(error)) return
    call tests%check(index(error%message, fragment) > 0, fragment//' but said: '//error%message)
  end subroutine expect
end program test_datbox_space_written
