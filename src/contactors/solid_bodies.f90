!> From the shapes of a body in space to the body: mass, centre and principal frame, and the shapes in that frame.
!!
!! Decks and DATBOX folders both take this way. Add the shapes of the body as they are given, in any frame, and put the
!! place of that frame in the world into `bodies%position` and `bodies%orientation`; then `make_solid_body` weighs them,
!! moves the body's frame to its centre and principal axes, and writes the shapes in it: nothing moves in the world. Where a
!! file gives mass, moments or axes of its own, use the parts: `solid_of_shapes`, `move_body_frame`, `set_inertia`. The spin
!! is about principal axes: set it last, by `turned_back(orientation, spin in the world)`.
module sg_solid_bodies
  use sg_bodies, only: bodies_t
  use sg_contactors, only: contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron, kind_sphere
  use sg_kinds, only: wp
  use sg_polyhedron_moments, only: box_solid, capsule_solid, composed_solid, moved_solid, polyhedron_solid, principal_inertia, &
                                   solid_t, sphere_solid
  use sg_rotations, only: frame_of, no_rotation, normalised, quaternion_of, quaternion_product, turned_by
  implicit none
  private
  public :: make_solid_body, solid_of_shapes, move_body_frame, set_inertia

contains

  !> Weigh a body and put its frame at its centre and along its principal axes.
  subroutine make_solid_body(bodies, contactors, body, first, last, density)
    type(bodies_t), intent(inout) :: bodies !! position and orientation: of the frame of the shapes, then of the body
    type(contactors_t), intent(inout) :: contactors !! its contactors, in the frame given, then in that of the body
    integer, intent(in) :: body !! index of the body
    integer, intent(in) :: first !! its first contactor
    integer, intent(in) :: last !! its last contactor
    real(wp), intent(in) :: density !! [kg/m3]
    type(solid_t) :: solid
    real(wp) :: moments(3), axes(3, 3)

    solid = solid_of_shapes(contactors, first, last)
    call principal_inertia(solid, moments, axes)
    call move_body_frame(bodies, contactors, body, first, last, solid%centre, axes)
    bodies%area(body) = solid%volume
    call set_inertia(bodies, body, density*solid%volume, density*moments)
  end subroutine make_solid_body

  !> Volume, centre and inertia of some contactors of a body, in its frame, for a density of one; what shapes share counts
  !! twice, and a hollow cylinder weighs nothing.
  pure function solid_of_shapes(contactors, first, last) result(whole)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: first !! first contactor
    integer, intent(in) :: last !! last contactor
    type(solid_t) :: whole
    type(solid_t) :: solids(max(0, last - first + 1)), own
    real(wp) :: frame(3, 3)
    integer :: c, row

    do c = first, last
      row = contactors%row(c)
      frame = frame_of(no_rotation)
      own = solid_t()
      select case (contactors%kind(c))
      case (kind_sphere)
        own = sphere_solid(contactors%space%sphere_radius(row))
      case (kind_plane)
        own = box_solid(contactors%space%plane_half(:, row))
        frame = reshape(contactors%space%plane_frame(:, row), [3, 3])
      case (kind_cylinder)
        own = capsule_solid(contactors%space%cylinder_size(1, row), contactors%space%cylinder_size(2, row))
        frame = frame_about(contactors%space%cylinder_axis(:, row))
      case (kind_polyhedron)
        own = polyhedron_solid(contactors%space%polyhedra(row))
      end select
      solids(c - first + 1) = moved_solid(own, contactors%shift(:, c), frame)
    end do
    whole = composed_solid(solids)
  end function solid_of_shapes

  !> A right-handed frame whose third axis is given.
  pure function frame_about(axis) result(frame)
    real(wp), intent(in) :: axis(3)
    real(wp) :: frame(3, 3)
    integer :: least, next, last

    least = minloc(abs(axis), 1)
    next = 1 + mod(least, 3)
    last = 1 + mod(next, 3)
    frame(:, 3) = axis/norm2(axis)
    frame(least, 1) = 0
    frame(next, 1) = -frame(last, 3)
    frame(last, 1) = frame(next, 3)
    frame(:, 1) = frame(:, 1)/norm2(frame(:, 1))
    frame(1, 2) = frame(2, 3)*frame(3, 1) - frame(3, 3)*frame(2, 1)
    frame(2, 2) = frame(3, 3)*frame(1, 1) - frame(1, 3)*frame(3, 1)
    frame(3, 2) = frame(1, 3)*frame(2, 1) - frame(2, 3)*frame(1, 1)
  end function frame_about

  !> Move the frame of a body and write its shapes in the new one; in the world they stay where they are.
  pure subroutine move_body_frame(bodies, contactors, body, first, last, origin, axes)
    type(bodies_t), intent(inout) :: bodies !! position and orientation of the body change
    type(contactors_t), intent(inout) :: contactors !! its contactors change
    integer, intent(in) :: body !! index of the body
    integer, intent(in) :: first !! its first contactor
    integer, intent(in) :: last !! its last contactor
    real(wp), intent(in) :: origin(3) !! origin of the new frame in the old one [m]
    real(wp), intent(in) :: axes(3, 3) !! columns: axes of the new frame in the old one, orthonormal and right-handed
    real(wp) :: back(3, 3)
    integer :: c

    associate (position => bodies%position(:, body), orientation => bodies%orientation(:, body))
      position = position + turned_by(orientation, origin)
      orientation = normalised(quaternion_product(orientation, quaternion_of(axes)))
    end associate
    back = transpose(axes)
    do c = first, last
      contactors%shift(:, c) = matmul(back, contactors%shift(:, c) - origin)
      call turn_shape(contactors, c, back)
    end do
  end subroutine move_body_frame

  !> Turn one shape about its centre.
  pure subroutine turn_shape(contactors, c, rotation)
    type(contactors_t), intent(inout) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: rotation(3, 3)
    integer :: row

    row = contactors%row(c)
    associate (space => contactors%space)
      select case (contactors%kind(c))
      case (kind_plane)
        space%plane_frame(:, row) = reshape(matmul(rotation, reshape(space%plane_frame(:, row), [3, 3])), [9])
      case (kind_cylinder)
        space%cylinder_axis(:, row) = matmul(rotation, space%cylinder_axis(:, row))
      case (kind_hollow_cylinder)
        space%hollow_axis(:, row) = matmul(rotation, space%hollow_axis(:, row))
      case (kind_polyhedron)
        space%polyhedra(row)%vertex = matmul(rotation, space%polyhedra(row)%vertex)
        space%polyhedra(row)%normal = matmul(rotation, space%polyhedra(row)%normal)
      end select
    end associate
  end subroutine turn_shape

  !> Mass and principal moments of a body, and their inverses; zero inverse where there is nothing.
  pure subroutine set_inertia(bodies, body, mass, principal)
    type(bodies_t), intent(inout) :: bodies !! bodies to change
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: mass !! [kg]
    real(wp), intent(in) :: principal(3) !! moments about its principal axes [kg m2]
    integer :: k

    bodies%mass(body) = mass
    bodies%principal(:, body) = principal
    bodies%inverse_mass(:, body) = 0
    if (mass > 0) bodies%inverse_mass(:3, body) = 1/mass
    do k = 1, 3
      if (principal(k) > 0) bodies%inverse_mass(3 + k, body) = 1/principal(k)
    end do
  end subroutine set_inertia
end module sg_solid_bodies
