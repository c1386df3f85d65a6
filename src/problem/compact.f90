!> The mapping H on compact records: relative velocities at contacts, and impulses made felt by bodies.
module sg_compact
  use sg_compact_space, only: add_space_impulses, space_velocity
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: arm_bonded, arm_frictional, arm_frictionless, first_inverse, is_in_space, round_frictional, &
                        round_frictionless
  implicit none
  private
  public :: compact_velocity, add_impulses

contains

  !> Relative velocity of a contact with its bias and compliance, u' = H^T V + bias + C r [m/s]: normal, tangential and zero;
  !! in space a vector in the world's axes, or the normal one alone where nothing rubs.
  pure function compact_velocity(problem, k) result(u)
    type(problem_t), intent(in) :: problem !! problem
    integer, intent(in) :: k !! contact
    real(wp) :: u(3), x, y
    integer :: c, a

    if (is_in_space(problem%kind)) then
      u = space_velocity(problem, k)
      return
    end if

    c = problem%pair(1, k)
    a = problem%pair(2, k)
    associate (body => problem%body, record => problem%record, r => problem%impulse)
      x = body(1, c) - body(1, a)
      y = body(2, c) - body(2, a)
      u = [record(1, k)*x + record(2, k)*y, record(2, k)*x - record(1, k)*y, 0.0_wp]
      select case (problem%kind)
      case (round_frictionless)
        u = [u(1) + record(3, k), 0.0_wp, 0.0_wp]
      case (round_frictional)
        u(:2) = u(:2) + [record(3, k), record(4, k) + body(3, c) + body(3, a)]
      case (arm_frictionless)
        u = [u(1) + record(3, k)*body(3, c) - record(4, k)*body(3, a) + record(5, k), 0.0_wp, 0.0_wp]
      case (arm_frictional, arm_bonded)
        u(:2) = u(:2) + record(3:4, k)*body(3, c) - record(5:6, k)*body(3, a) + record(7:8, k) + record(14:15, k)*r(:, k)
      end select
    end associate
  end function compact_velocity

  !> Add M^-1 H r to the velocities of all bodies: what the guess of a warm start does.
  pure subroutine add_impulses(problem)
    type(problem_t), intent(inout) :: problem !! problem whose bodies still have their free velocities
    real(wp) :: p(2)
    integer :: k, c, a, inverse

    if (is_in_space(problem%kind)) then
      call add_space_impulses(problem)
      return
    end if
    inverse = first_inverse(problem%kind)
    associate (body => problem%body, record => problem%record, r => problem%impulse)
      do k = 1, problem%n_contacts
        c = problem%pair(1, k)
        a = problem%pair(2, k)
        p = r(1, k)*record(1:2, k)
        if (size(r, 1) == 2) p = p + r(2, k)*[record(2, k), -record(1, k)]
        body(1:2, c) = body(1:2, c) + body(inverse:inverse + 1, c)*p
        body(1:2, a) = body(1:2, a) - body(inverse:inverse + 1, a)*p
        select case (problem%kind)
        case (round_frictional)
          body(3, c) = body(3, c) + body(6, c)*r(2, k)
          body(3, a) = body(3, a) + body(6, a)*r(2, k)
        case (arm_frictionless)
          body(3, c) = body(3, c) + body(6, c)*record(3, k)*r(1, k)
          body(3, a) = body(3, a) - body(6, a)*record(4, k)*r(1, k)
        case (arm_frictional, arm_bonded)
          body(3, c) = body(3, c) + body(6, c)*(record(3, k)*r(1, k) + record(4, k)*r(2, k))
          body(3, a) = body(3, a) - body(6, a)*(record(5, k)*r(1, k) + record(6, k)*r(2, k))
        end select
      end do
    end associate
  end subroutine add_impulses
end module sg_compact
