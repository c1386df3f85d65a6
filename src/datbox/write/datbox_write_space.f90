!> Writes the bodies of space, their contactors and their state for BODIES.DAT and DOF.INI.
!!
!! Shapes are written in the frame of the principal axes, which DOF.INI turns into the world; the principal moments
!! next to them show it. A plane, cylinder or hollow cylinder that is alone is written upright, as LMGC90 wants it.
module sg_datbox_write_space
  use sg_contactors, only: contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_point, kind_polyhedron, kind_sphere
  use sg_datbox_output, only: as_written, labelled, output_t, put, solid_node_head
  use sg_datbox_space_bodies, only: solid_of_datbox
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_moments, only: solid_t
  use sg_rotations, only: frame_of
  use sg_scene, only: material_t, scene_t
  use sg_solid_bodies, only: move_body_frame
  use sg_text, only: to_text
  use sg_vectors, only: cross
  implicit none
  private
  public :: stand_upright, fit_densities, check_solid, put_solid, put_solid_contactor, put_solid_state

  !> Share of a size below which a shift or a tilt is none
  real(wp), parameter :: slack = 1e-6_wp

contains

  !> Give bodies of one plane, cylinder or hollow cylinder the axes of that shape: their spins and drives change with them.
  subroutine stand_upright(scene, first, list)
    type(scene_t), intent(inout) :: scene !! scene to write
    integer(i4), intent(in) :: first(:) !! first place of each body in the list
    integer(i4), intent(in) :: list(:) !! contactors grouped by body
    real(wp) :: axes(3, 3), moments(3)
    integer :: b, c, k, source(3)

    do b = 1, scene%bodies%n
      if (first(b + 1) /= first(b) + 1) cycle
      c = list(first(b))
      if (all(scene%contactors%kind(c) /= [kind_plane, kind_cylinder, kind_hollow_cylinder])) cycle
      axes = frame_of_shape(scene%contactors, c)
      source = maxloc(abs(axes), 1)
      ! Shapes of revolution and boxes lie along principal axes; only a frame of them that is whole may be taken.
      if (any([(abs(axes(source(k), k)) < 1 - slack, k=1, 3)]) .or. all(source == [1, 2, 3] .and. &
        [(axes(source(k), k) > 0, k=1, 3)])) cycle
      do k = 1, 3
        axes(:, k) = 0
        axes(source(k), k) = sign(1.0_wp, frame_entry(scene%contactors, c, source(k), k))
      end do
      call move_body_frame(scene%bodies, scene%contactors, b, c, c, [0.0_wp, 0.0_wp, 0.0_wp], axes)
      moments = scene%bodies%principal(:, b)
      scene%bodies%principal(:, b) = moments(source)
      if (scene%bodies%n_velocity == 6) scene%bodies%velocity(4:6, b) = matmul(transpose(axes), scene%bodies%velocity(4:6, b))
      call turn_drives(scene, b, axes)
    end do
  end subroutine stand_upright

  !> Frame of a plane, cylinder or hollow cylinder in its body's frame: the third axis is that of the shape.
  pure function frame_of_shape(contactors, c) result(frame)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp) :: frame(3, 3)
    integer :: row, k

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_plane)
      frame = reshape(contactors%space%plane_frame(:, row), [3, 3])
      return
    case (kind_cylinder)
      frame(:, 3) = contactors%space%cylinder_axis(:, row)
    case default
      frame(:, 3) = contactors%space%hollow_axis(:, row)
    end select
    k = maxloc(abs(frame(:, 3)), 1)
    frame(:, 2) = 0
    frame(1 + mod(k + 1, 3), 2) = 1
    if (frame(k, 3) < 0) frame(:, 2) = -frame(:, 2)
    frame(:, 1) = cross(frame(:, 2), frame(:, 3))
    frame(:, 1) = frame(:, 1)/norm2(frame(:, 1))
    frame(:, 2) = cross(frame(:, 3), frame(:, 1))
  end function frame_of_shape

  !> One entry of the frame of a shape.
  pure real(wp) function frame_entry(contactors, c, i, k)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, i, k
    real(wp) :: frame(3, 3)

    frame = frame_of_shape(contactors, c)
    frame_entry = frame(i, k)
  end function frame_entry

  !> Let the drives of a body's spins follow its new axes, which are old ones in another order or pointing the other way.
  subroutine turn_drives(scene, body, axes)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    real(wp), intent(in) :: axes(3, 3)
    integer :: i, old, new

    do i = 1, size(scene%drives)
      associate (drive => scene%drives(i))
        if (drive%body /= body .or. drive%component < 4) cycle
        old = drive%component - 3
        new = maxloc(abs(axes(old, :)), 1)
        drive%component = 3 + new
        if (axes(old, new) > 0) cycle
        drive%value%constant = -drive%value%constant
        drive%value%amplitude = -drive%value%amplitude
        if (allocated(drive%value%values)) drive%value%values = -drive%value%values
      end associate
    end do
  end subroutine turn_drives

  !> Give bodies of several shapes, which LMGC90 weighs by their volumes, materials of a density that makes their masses.
  subroutine fit_densities(scene, first, list)
    type(scene_t), intent(inout) :: scene !! scene to write, gets more materials
    integer(i4), intent(in) :: first(:) !! first place of each body in the list
    integer(i4), intent(in) :: list(:) !! contactors grouped by body
    type(solid_t) :: solid
    type(material_t) :: material
    integer :: b, m

    do b = 1, scene%bodies%n
      if (first(b + 1) - first(b) < 2) cycle
      solid = solid_of_datbox(scene, int(list(first(b))), int(list(first(b + 1) - 1)))
      if (.not. min(solid%volume, scene%bodies%mass(b)) > 0) cycle
      material = scene%materials(scene%bodies%material(b))
      if (abs(material%density*solid%volume - scene%bodies%mass(b)) <= slack*scene%bodies%mass(b)) cycle
      material%density = scene%bodies%mass(b)/solid%volume
      do m = 1, size(scene%materials)
        if (abs(scene%materials(m)%density - material%density) <= slack*material%density) exit
      end do
      if (m > size(scene%materials)) scene%materials = [scene%materials, material]
      scene%bodies%material(b) = int(m, i4)
    end do
  end subroutine fit_densities

  !> Refuse a body that the format cannot hold.
  subroutine check_solid(scene, body, list, error)
    type(scene_t), intent(in) :: scene !! scene to write
    integer, intent(in) :: body !! the body
    integer(i4), intent(in) :: list(:) !! its contactors
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    type(solid_t) :: solid
    real(wp) :: frame(3, 3), reach
    integer :: i, c

    if (size(list) == 0) then
      call fail(error, 'body '//to_text(body)//' has no shape: a DATBOX needs one')
      return
    else if (list(size(list)) - list(1) /= size(list) - 1) then
      call fail(error, 'the shapes of body '//to_text(body)//' do not stand together')
      return
    end if
    reach = 0
    do i = 1, size(list)
      c = list(i)
      reach = max(reach, scene%contactors%reach(c) + norm2(scene%contactors%shift(:, c)))
      if (scene%contactors%kind(c) /= kind_hollow_cylinder) cycle
      frame = frame_of_shape(scene%contactors, c)
      if (norm2(scene%contactors%shift(:, c)) > slack*scene%contactors%reach(c) .or. frame(3, 3) < 1 - slack) then
        call fail(error, 'body '//to_text(body)//': a DATBOX cannot hold a hollow cylinder that is off its body''s centre or '// &
                  'not along its third axis')
        return
      end if
    end do
    solid = solid_of_datbox(scene, int(list(1)), int(list(size(list))))
    if (norm2(solid%centre) > slack*reach) &
      call fail(error, 'body '//to_text(body)//': its centre is not that of the volume of its shapes, where a DATBOX puts it')
  end subroutine check_solid

  !> Write bulk and node of a body.
  subroutine put_solid(output, scene, body, material)
    type(output_t), intent(inout) :: output !! BODIES.DAT
    type(scene_t), intent(in) :: scene !! scene to write
    integer, intent(in) :: body !! the body
    character(len=5), intent(in) :: material !! name of its material
    real(wp) :: density

    density = scene%materials(scene%bodies%material(body))%density
    call put(output, labelled('avrd= gyrd= ', [(0.75_wp*scene%bodies%mass(body)/(pi*density))**(1.0_wp/3), 0.0_wp], &
                              ' PLAIN      1  behav  '//material))
    call put(output, labelled('I1  = I2  = I3  = ', scene%bodies%principal(:, body)/density))
    call put(output, '$nodty')
    call put(output, labelled('coo1= coo2= coo3= ', scene%bodies%position(:, body), solid_node_head))
    call put(output, labelled('coo4= coo5= coo6= ', [0.0_wp, 0.0_wp, 0.0_wp]))
  end subroutine put_solid

  !> Write one contactor with its further lines.
  subroutine put_solid_contactor(output, contactors, contactor, head)
    type(output_t), intent(inout) :: output !! BODIES.DAT
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: contactor !! the contactor
    character(len=27), intent(inout) :: head !! head of its line, which gets its type
    real(wp) :: shift(3)
    integer :: row

    row = contactors%row(contactor)
    shift = contactors%shift(:, contactor)
    associate (space => contactors%space)
      select case (contactors%kind(contactor))
      case (kind_sphere)
        head(2:6) = 'SPHER'
        if (any(abs(shift) > 0)) head(2:6) = 'SPHEb'
        call put(output, labelled('byrd= ', [space%sphere_radius(row)], head))
        if (any(abs(shift) > 0)) call put(output, labelled('coo1= coo2= coo3= ', shift))
      case (kind_plane)
        head(2:6) = 'PLANx'
        call put(output, labelled('axe1= axe2= axe3= ', space%plane_half(:, row), head))
        call put_local_frame(output, frame_of_shape(contactors, contactor), shift)
      case (kind_cylinder)
        head(2:6) = 'CYLND'
        call put(output, labelled('High= byrd= ', space%cylinder_size(:, row), head))
        call put_local_frame(output, frame_of_shape(contactors, contactor), shift)
      case (kind_hollow_cylinder)
        head(2:6) = 'DNLYC'
        call put(output, labelled('High= byrd= ', space%hollow_size(:, row), head))
      case (kind_point)
        head(2:6) = 'PT3Dx'
        call put(output, labelled('coo1= coo2= coo3= ', shift, head))
      case (kind_polyhedron)
        head(2:6) = 'POLYR'
        call put_polyhedron(output, space%polyhedra(row), shift, head)
      end select
    end associate
  end subroutine put_solid_contactor

  !> Write frame and shift of a contactor where they differ from the body's own.
  subroutine put_local_frame(output, frame, shift)
    type(output_t), intent(inout) :: output
    real(wp), intent(in) :: frame(3, 3), shift(3)

    if (frame(1, 1) + frame(2, 2) + frame(3, 3) > 3 - epsilon(1.0_wp) .and. .not. any(abs(shift) > 0)) return
    call put(output, repeat(' ', 29)//'localframe')
    call put(output, labelled('alp1= alp2= alp3= ', frame(:, 1)))
    call put(output, labelled('bet1= bet2= bet3= ', frame(:, 2)))
    call put(output, labelled('gam1= gam2= gam3= ', frame(:, 3)))
    call put(output, labelled('coo1= coo2= coo3= ', shift))
  end subroutine put_local_frame

  !> Write vertices and triangles of a polyhedron; a face of more corners becomes a fan.
  subroutine put_polyhedron(output, shape, shift, head)
    type(output_t), intent(inout) :: output
    type(polyhedron_t), intent(in) :: shape
    real(wp), intent(in) :: shift(3)
    character(len=27), intent(in) :: head
    character(len=90) :: line
    integer :: f, k, v

    write (line, '(a,a,i7,a,i7)') head, '  nb_vertex=', shape%n_vertices, '    nb_faces=', &
      shape%face_first(shape%n_faces + 1) - 1 - 2*shape%n_faces
    call put(output, line)
    do v = 1, shape%n_vertices
      call put(output, labelled('coo1= coo2= coo3= ', shift + shape%vertex(:, v)))
    end do
    do f = 1, shape%n_faces
      do k = shape%face_first(f) + 1, shape%face_first(f + 1) - 2
        write (line, '(29x,a,i7,9x,a,i7,9x,a,i7)') 'ver1=', shape%face_vertex(shape%face_first(f)), 'ver2=', &
          shape%face_vertex(k), 'ver3=', shape%face_vertex(k + 1)
        call put(output, line)
      end do
    end do
  end subroutine put_polyhedron

  !> Write displacement, velocity and frame of a body; the displacement holds what the node loses.
  subroutine put_solid_state(output, scene, body)
    type(output_t), intent(inout) :: output !! DOF.INI
    type(scene_t), intent(in) :: scene !! scene to write
    integer, intent(in) :: body !! the body
    real(wp) :: lost(3), spin(3), frame(3, 3)
    integer :: i

    do i = 1, 3
      lost(i) = scene%bodies%position(i, body) - as_written(scene%bodies%position(i, body))
    end do
    spin = 0
    if (scene%bodies%n_velocity == 6) spin = scene%bodies%velocity(4:6, body)
    frame = frame_of([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    if (allocated(scene%bodies%orientation)) frame = frame_of(scene%bodies%orientation(:, body))
    call put(output, '$nodty')
    call put(output, labelled('X(1)= X(2)= X(3)= ', lost, solid_node_head))
    call put(output, labelled('X(4)= X(5)= X(6)= ', [0.0_wp, 0.0_wp, 0.0_wp]))
    call put(output, labelled('V(1)= V(2)= V(3)= ', scene%bodies%velocity(1:3, body)))
    call put(output, labelled('V(4)= V(5)= V(6)= ', spin))
    call put(output, labelled('a(1)= a(2)= a(3)= ', frame(:, 1)))
    call put(output, labelled('b(1)= b(2)= b(3)= ', frame(:, 2)))
    call put(output, labelled('g(1)= g(2)= g(3)= ', frame(:, 3)))
    call put(output, '$$$$$$')
  end subroutine put_solid_state
end module sg_datbox_write_space
