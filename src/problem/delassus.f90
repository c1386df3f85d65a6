!> The block of W at a contact, as its record holds it, from the geometry in the record and the masses of its two bodies.
!!
!! Decomposed solvers sweep shared grains with a part of their mass: they set the blocks of contacts anew for it.
module sg_delassus
  use sg_assemble_space, only: set_solid_block
  use sg_kinds, only: wp
  use sg_laws, only: inverse_of
  use sg_problem, only: arm_frictional, arm_frictionless, ball_frictional, ball_frictionless, first_inverse, &
                        round_frictional, round_frictionless, solid_frictional, solid_frictionless
  implicit none
  private
  public :: set_block, share_mass

contains

  !> Take one of `parts` equal parts of a body's mass and inertia.
  pure subroutine share_mass(kind, parts, body)
    integer, intent(in) :: kind !! kind of problem
    integer, intent(in) :: parts !! copies of the body
    real(wp), intent(inout) :: body(:) !! its record; inverse masses grow
    real(wp) :: mark

    mark = body(size(body))
    associate (inverse => body(first_inverse(kind):))
      inverse = inverse*real(parts, wp)
    end associate
    ! Marks of free directions are no inverse inertia.
    if (kind == ball_frictional .and. mark < 0) body(8) = mark
  end subroutine share_mass

  !> Set the block of a record that is complete but for the masses of its bodies. Contacts that take no part stay so.
  pure subroutine set_block(kind, candidate, antagonist, record)
    integer, intent(in) :: kind !! kind of problem
    real(wp), intent(in) :: candidate(:), antagonist(:) !! records of the two bodies
    real(wp), intent(inout) :: record(:) !! record of the contact
    real(wp) :: mass(3), w, w_t, w_nt

    associate (c => candidate, a => antagonist, n => record(1:2))
      select case (kind)
      case (round_frictionless, round_frictional)
        mass(1:2) = c(first_inverse(kind):first_inverse(kind) + 1) + a(first_inverse(kind):first_inverse(kind) + 1)
        w = n(1)**2*mass(1) + n(2)**2*mass(2)
        if (kind == round_frictionless) then
          record(4) = inverse_of(w, record(4) > 0)
          return
        end if
        w_nt = abs(n(1)*n(2)*(mass(1) - mass(2)))
        w_t = n(2)**2*mass(1) + n(1)**2*mass(2) + c(6) + a(6)
        record(5:6) = [inverse_of(w + w_nt, record(5) > 0), inverse_of(w_t + w_nt, record(6) > 0)]
      case (arm_frictionless)
        w = n(1)**2*(c(4) + a(4)) + n(2)**2*(c(5) + a(5)) + record(3)**2*c(6) + record(4)**2*a(6)
        record(6) = inverse_of(w, record(6) > 0)
      case (arm_frictional)
        record(9) = n(1)**2*(c(4) + a(4)) + n(2)**2*(c(5) + a(5)) + record(3)**2*c(6) + record(5)**2*a(6) + record(14)
        record(10) = n(1)*n(2)*(c(4) + a(4) - c(5) - a(5)) + record(3)*record(4)*c(6) + record(5)*record(6)*a(6)
        record(11) = n(2)**2*(c(4) + a(4)) + n(1)**2*(c(5) + a(5)) + record(4)**2*c(6) + record(6)**2*a(6) + record(15)
      case (ball_frictionless)
        record(5) = inverse_of(dot_product(c(4:6) + a(4:6), record(1:3)**2), record(5) > 0)
      case (ball_frictional)
        w = c(7) + a(7)
        record(7:8) = [inverse_of(w, record(7) > 0), inverse_of(w + max(0.0_wp, c(8)) + max(0.0_wp, a(8)), record(8) > 0)]
      case (solid_frictionless)
        w = dot_product(c(7:9) + a(7:9), record(1:3)**2) + turned(c, record(4:6)) + turned(a, record(7:9))
        record(11) = inverse_of(w, record(11) > 0)
      case (solid_frictional)
        if (record(25) > 0.5_wp) call set_solid_block(c, a, record)
      end select
    end associate
  contains
    !> x . I^-1 x
    pure real(wp) function turned(body, x)
      real(wp), intent(in) :: body(:), x(3)

      turned = body(10)*x(1)**2 + body(11)*x(2)**2 + body(12)*x(3)**2 &
               + 2*(body(13)*x(1)*x(2) + body(14)*x(1)*x(3) + body(15)*x(2)*x(3))
    end function turned
  end subroutine set_block
end module sg_delassus
