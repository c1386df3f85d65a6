!> What the error measures need of contacts in space: the natural map of vectors in the world's axes (doc/theory/errors.md).
module sg_residuals_space
  use sg_compact_space, only: space_velocity
  use sg_kinds, only: wp
  use sg_problem, only: ball_frictional, ball_frictionless, problem_t, solid_frictional, solid_frictionless
  implicit none
  private
  public :: space_contact_t, look_at_contact, space_map, add_space_contacts

  !> One contact as error measures see it
  type :: space_contact_t
    !> Normal, relative velocity with bias and compliance [m/s], impulse with cohesion [N s]; where nothing rubs, normal
    !! parts on the first axis
    real(wp) :: n(3) = 0, u(3) = 0, r(3) = 0
    !> Coulomb friction, and 1/lambda_max(W_aa) [kg]: zero where the contact takes no part
    real(wp) :: friction = 0, rho = 0
    !> Does a linear law ask u = 0?
    logical :: is_linear = .false.
  end type space_contact_t

contains

  !> Look at one contact.
  pure subroutine look_at_contact(problem, k, contact)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    integer, intent(in) :: k !! contact
    type(space_contact_t), intent(out) :: contact !! what is seen

    contact%u = space_velocity(problem, k)
    associate (record => problem%record(:, k), r => problem%impulse(:, k))
      select case (problem%kind)
      case (ball_frictionless, solid_frictionless)
        contact%n = [1.0_wp, 0.0_wp, 0.0_wp]
        contact%r = [r(1), 0.0_wp, 0.0_wp]
        contact%rho = record(merge(5, 11, problem%kind == ball_frictionless))
      case (ball_frictional)
        contact%n = record(1:3)
        contact%r = r
        contact%friction = record(9)
        contact%rho = merge(min(record(7), record(8)), record(7), record(9) > 0)
      case (solid_frictional)
        contact%n = record(1:3)
        contact%r = r + record(22)*record(1:3)
        contact%friction = record(21)
        contact%rho = record(26)
        contact%is_linear = record(25) > 1.5_wp
      end select
    end associate
  end subroutine look_at_contact

  !> Natural map of one contact: zero where impulse and velocity obey the law.
  pure function space_map(contact, rho) result(f)
    type(space_contact_t), intent(in) :: contact !! the contact
    real(wp), intent(in) :: rho !! scale of velocities [kg]
    real(wp) :: f(3), t(3), u_n, x, length, normal

    associate (n => contact%n, u => contact%u, friction => contact%friction)
      if (contact%is_linear) then
        f = rho*u
        return
      end if
      u_n = n(1)*u(1) + n(2)*u(2) + n(3)*u(3)
      t = u - u_n*n
      u_n = u_n + friction*sqrt(t(1)**2 + t(2)**2 + t(3)**2)
      ! The point r - rho (u + g(u)), and its projection on Coulomb's cone.
      t = contact%r - rho*t
      x = n(1)*t(1) + n(2)*t(2) + n(3)*t(3)
      t = t - x*n
      x = x - rho*u_n
      length = sqrt(t(1)**2 + t(2)**2 + t(3)**2)
      if (length <= friction*x .and. x > 0) then
        f = contact%r - x*n - t
      else
        normal = max(0.0_wp, (x + friction*length)/(1 + friction**2))
        f = contact%r - normal*n
        if (length > 0) f = f - friction*normal/length*t
      end if
    end associate
  end function space_map

  !> Add all contacts to the sums: squares of the map with rho = 1 (where wanted), of the map with rho_a, of its velocity
  !! error, of r, and of u.
  pure subroutine add_space_contacts(problem, with_e1, sums, active)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    logical, intent(in) :: with_e1 !! is the map with rho = 1 wanted too?
    real(wp), intent(inout) :: sums(5) !! sums to add to
    integer, intent(inout) :: active !! contacts that carry an impulse
    type(space_contact_t) :: contact
    real(wp) :: square
    integer :: k

    do k = 1, problem%n_contacts
      call look_at_contact(problem, k, contact)
      if (with_e1) sums(1) = sums(1) + sum(space_map(contact, merge(1.0_wp, 0.0_wp, contact%rho > 0))**2)
      square = sum(space_map(contact, contact%rho)**2)
      sums(2) = sums(2) + square
      if (contact%rho > 0) sums(3) = sums(3) + square/contact%rho**2
      sums(4) = sums(4) + sum(contact%r**2)
      sums(5) = sums(5) + sum(contact%u**2)
      if (sum(abs(contact%r)) > 0) active = active + 1
    end do
  end subroutine add_space_contacts
end module sg_residuals_space
