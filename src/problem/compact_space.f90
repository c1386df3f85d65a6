!> The mapping H on compact records in space: relative velocities at contacts, and impulses made felt by bodies.
module sg_compact_space
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: ball_frictional, ball_frictionless, free_axes, solid_bonded, solid_frictional, solid_frictionless
  use sg_vectors, only: cross
  implicit none
  private
  public :: space_velocity, add_space_impulses, push_bodies

contains

  !> Relative velocity of a contact with its bias and compliance, u' = H^T V + bias + C r [m/s]: a vector in the world's
  !! axes, or the normal one and two zeros where nothing rubs.
  pure function space_velocity(problem, k) result(u)
    type(problem_t), intent(in) :: problem !! problem
    integer, intent(in) :: k !! contact
    real(wp) :: u(3), n(3), s(3)
    integer :: c, a

    c = problem%pair(1, k)
    a = problem%pair(2, k)
    associate (body => problem%body, record => problem%record(:, k), r => problem%impulse(:, k))
      n = record(1:3)
      u = body(1:3, c) - body(1:3, a)
      select case (problem%kind)
      case (ball_frictionless)
        u = [dot_product(n, u) + record(4), 0.0_wp, 0.0_wp]
      case (ball_frictional)
        ! Written out, as what `push_balls` does: the compiler calls a procedure of another file, and this is most of the work.
        s = body(4:6, c) + body(4:6, a)
        u(1) = u(1) - s(2)*n(3) + s(3)*n(2) + record(4)
        u(2) = u(2) - s(3)*n(1) + s(1)*n(3) + record(5)
        u(3) = u(3) - s(1)*n(2) + s(2)*n(1) + record(6)
      case (solid_frictionless)
        u = [dot_product(n, u) + dot_product(record(4:6), body(4:6, c)) - dot_product(record(7:9), body(4:6, a)) + record(10), &
             0.0_wp, 0.0_wp]
      case (solid_frictional, solid_bonded)
        u = u + cross(body(4:6, c), record(7:9)) - cross(body(4:6, a), record(10:12)) + record(13:15) &
            + record(24)*r + (record(23) - record(24))*dot_product(n, r)*n
      end select
    end associate
  end function space_velocity

  !> Add M^-1 H r to the velocities of all bodies: what the guess of a warm start does.
  pure subroutine add_space_impulses(problem)
    type(problem_t), intent(inout) :: problem !! problem whose bodies still have their free velocities
    integer :: k

    do k = 1, problem%n_contacts
      if (.not. any(abs(problem%impulse(:, k)) > 0)) cycle
      if (problem%kind == ball_frictional) then
        associate (c => problem%pair(1, k), a => problem%pair(2, k))
          if (min(problem%body(8, c), problem%body(8, a)) >= 0) then
            call push_balls(problem%body(:, c), problem%body(:, a), problem%impulse(:, k), problem%record(:, k))
            cycle
          end if
        end associate
      end if
      call push_bodies(problem, k, problem%impulse(:, k))
    end do
  end subroutine add_space_impulses

  !> What an impulse does to two balls that are free in all directions or in none, the most frequent case.
  pure subroutine push_balls(c, a, p, n)
    real(wp), intent(inout) :: c(8), a(8)
    real(wp), intent(in) :: p(3), n(3)
    real(wp) :: turn(3)

    turn(1) = p(2)*n(3) - p(3)*n(2)
    turn(2) = p(3)*n(1) - p(1)*n(3)
    turn(3) = p(1)*n(2) - p(2)*n(1)
    c(1:3) = c(1:3) + c(7)*p
    a(1:3) = a(1:3) - a(7)*p
    c(4:6) = c(4:6) + c(8)*turn
    a(4:6) = a(4:6) + a(8)*turn
  end subroutine push_balls

  !> Add to the velocities of its two bodies what an impulse at one contact does.
  pure subroutine push_bodies(problem, k, r)
    type(problem_t), intent(inout) :: problem !! problem
    integer, intent(in) :: k !! contact
    real(wp), intent(in) :: r(:) !! impulse as the kind of problem has it [N s]
    real(wp) :: p(3)
    integer :: c, a

    c = problem%pair(1, k)
    a = problem%pair(2, k)
    associate (body => problem%body, record => problem%record(:, k))
      if (size(r) == 1) then
        p = r(1)*record(1:3)
      else
        p = r
      end if
      select case (problem%kind)
      case (ball_frictionless)
        body(1:3, c) = body(1:3, c) + body(4:6, c)*p
        body(1:3, a) = body(1:3, a) - body(4:6, a)*p
      case (ball_frictional)
        body(1:3, c) = body(1:3, c) + body(7, c)*free_axes(body(8, c))*p
        body(1:3, a) = body(1:3, a) - body(7, a)*free_axes(body(8, a))*p
        body(4:6, c) = body(4:6, c) + max(0.0_wp, body(8, c))*cross(p, record(1:3))
        body(4:6, a) = body(4:6, a) + max(0.0_wp, body(8, a))*cross(p, record(1:3))
      case default
        body(1:3, c) = body(1:3, c) + body(7:9, c)*p
        body(1:3, a) = body(1:3, a) - body(7:9, a)*p
        if (problem%kind == solid_frictionless) then
          body(4:6, c) = body(4:6, c) + turned_spin(body(10:15, c), r(1)*record(4:6))
          body(4:6, a) = body(4:6, a) - turned_spin(body(10:15, a), r(1)*record(7:9))
        else
          body(4:6, c) = body(4:6, c) + turned_spin(body(10:15, c), cross(record(7:9), p))
          body(4:6, a) = body(4:6, a) - turned_spin(body(10:15, a), cross(record(10:12), p))
        end if
      end select
    end associate
  end subroutine push_bodies

  !> Inverse inertia (xx, yy, zz, xy, xz, yz) times an angular impulse.
  pure function turned_spin(inverse, p) result(w)
    real(wp), intent(in) :: inverse(6), p(3)
    real(wp) :: w(3)

    w = [inverse(1)*p(1) + inverse(4)*p(2) + inverse(5)*p(3), inverse(4)*p(1) + inverse(2)*p(2) + inverse(6)*p(3), &
         inverse(5)*p(1) + inverse(6)*p(2) + inverse(3)*p(3)]
  end function turned_spin
end module sg_compact_space
