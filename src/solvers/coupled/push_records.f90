!> Records of the contacts of a push, compact and in the order in which a sweep reads them (doc/theory/recovery.md).
!!
!! One record serves disks and polygons, another one balls and solids; bodies have those of frictionless problems that turn, with
!! displacements in the place of velocities, and no inverse inertia where they do not turn.
module sg_push_records
  use sg_kinds, only: wp, i4
  use sg_mapping_space, only: tangent_of
  use sg_records, only: arm_frictionless, body_length, solid_frictionless, solid_inverse_mx, solid_inverse_mz, solid_inverse_xx, &
                        solid_inverse_xy, solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, solid_inverse_zz
  use sg_vectors, only: cross
  implicit none
  private
  public :: weigh_in_plane, weigh_in_space

  !> Contact in the plane: normal, moments of n and of t = (n_y, -n_x) about both centres [m], gap and room [m], 1/W_nn and 1/W_tt
  !! [kg], W_tn [1/kg]; 1/W_tt is zero where it may slide
  integer, parameter, public :: plane_moment_nc = 3, plane_moment_na = 4, plane_moment_tc = 5, plane_moment_ta = 6, plane_gap = 7, &
                                plane_room = 8, plane_inverse_wnn = 9, plane_inverse_wtt = 10, plane_wtn = 11
  !> Contact in space: normal, arms from both centres [m], gap and room [m], 1/W_nn and one over the larger eigenvalue of W_tt [kg],
  !! and W_tn [1/kg], a vector
  integer, parameter, public :: space_arm_c = 4, space_arm_a = 7, space_gap = 10, space_room = 11, space_inverse_wnn = 12, &
                                space_inverse_wtt = 13, space_wtn = 14
  !> Reals of a record, and of that of a body: displacement and turn, inverse masses and inertia
  integer, parameter, public :: plane_record = plane_wtn, space_record = space_wtn + 2
  integer, parameter, public :: plane_body = body_length(arm_frictionless), space_body = body_length(solid_frictionless)

contains

  !> Block of W of a contact in the plane; zero where nothing can move its bodies.
  pure subroutine weigh_in_plane(body, pair, sticks, record)
    real(wp), intent(in), contiguous :: body(:, :) !! records of bodies
    integer(i4), intent(in) :: pair(2) !! slots of candidate and antagonist
    logical, intent(in) :: sticks !! may the contact not slide?
    real(wp), intent(inout) :: record(plane_record) !! normal and moments are set
    real(wp) :: w(3)
    integer :: side

    w = 0
    do side = 1, 2
      associate (m => body(4:6, pair(side)), n => record(:2), mn => record(plane_moment_nc - 1 + side), &
                 mt => record(plane_moment_tc - 1 + side))
        w = w + [m(1)*n(1)**2 + m(2)*n(2)**2 + m(3)*mn**2, m(1)*n(2)**2 + m(2)*n(1)**2 + m(3)*mt**2, &
                 (m(1) - m(2))*n(1)*n(2) + m(3)*mn*mt]
      end associate
    end do
    record(plane_inverse_wnn:) = 0
    if (w(1) > 0) record(plane_inverse_wnn) = 1/w(1)
    if (sticks .and. w(2) > 0) record(plane_inverse_wtt) = 1/w(2)
    record(plane_wtn) = w(3)
  end subroutine weigh_in_plane

  !> Block of W of a contact in space; zero where nothing can move its bodies.
  pure subroutine weigh_in_space(body, pair, sticks, record)
    real(wp), intent(in), contiguous :: body(:, :) !! records of bodies
    integer(i4), intent(in) :: pair(2) !! slots of candidate and antagonist
    logical, intent(in) :: sticks !! may the contact not slide?
    real(wp), intent(inout) :: record(space_record) !! normal and arms are set
    real(wp) :: axes(3, 3), w(3, 3), largest
    integer :: i

    associate (n => record(:3))
      axes(:, 1) = n
      axes(:, 2) = tangent_of(n)
      axes(:, 3) = cross(n, axes(:, 2))
    end associate
    do i = 1, merge(3, 1, sticks)
      w(:, i) = moved_at(record(space_arm_c:space_arm_c + 2), body(:, pair(1)), axes(:, i)) &
                + moved_at(record(space_arm_a:space_arm_a + 2), body(:, pair(2)), axes(:, i))
    end do
    record(space_inverse_wnn:) = 0
    associate (wnn => dot_product(axes(:, 1), w(:, 1)))
      if (wnn > 0) record(space_inverse_wnn) = 1/wnn
      record(space_wtn:) = w(:, 1) - wnn*axes(:, 1)
    end associate
    if (.not. sticks) return
    w(:2, 2) = [dot_product(axes(:, 2), w(:, 2)), dot_product(axes(:, 3), w(:, 2))]
    w(2, 3) = dot_product(axes(:, 3), w(:, 3))
    largest = (w(1, 2) + w(2, 3))/2 + hypot((w(1, 2) - w(2, 3))/2, w(2, 2))
    if (largest > 0) record(space_inverse_wtt) = 1/largest
  end subroutine weigh_in_space

  !> Displacement of a point of a solid by an impulse at it.
  pure function moved_at(arm, body, impulse) result(moved)
    real(wp), intent(in) :: arm(3), body(space_body), impulse(3)
    real(wp) :: moved(3), q(6)

    q = solid_moved(body, impulse, cross(arm, impulse))
    moved = q(:3) + cross(q(4:), arm)
  end function moved_at

  !> Displacement and turn of a solid by an impulse and a moment.
  pure function solid_moved(body, p, m) result(moved)
    real(wp), intent(in) :: body(space_body) !! record of the body
    real(wp), intent(in) :: p(3), m(3) !! impulse [kg m] and moment [kg m2]
    real(wp) :: moved(6)

    moved(:3) = body(solid_inverse_mx:solid_inverse_mz)*p
    moved(4) = body(solid_inverse_xx)*m(1) + body(solid_inverse_xy)*m(2) + body(solid_inverse_xz)*m(3)
    moved(5) = body(solid_inverse_xy)*m(1) + body(solid_inverse_yy)*m(2) + body(solid_inverse_yz)*m(3)
    moved(6) = body(solid_inverse_xz)*m(1) + body(solid_inverse_yz)*m(2) + body(solid_inverse_zz)*m(3)
  end function solid_moved
end module sg_push_records
