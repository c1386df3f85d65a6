!> Errors of a contact problem's solution, for any kind of problem and any solver (doc/theory/errors.md).
!!
!! All rest on the natural map F_a = r_a - P_K(r_a - rho (u_a + g(u_a))) of De Saxce's form, which vanishes exactly at
!! solutions: e1 and e2 with rho = 1, e8 and the violation with rho_a = 1/lambda_max(W_aa), free of units.
module sg_residuals
  use sg_compact, only: compact_velocity
  use sg_kinds, only: wp
  use sg_local_step, only: cone_projection
  use sg_problem, only: arm_frictional, arm_frictionless, problem_t, round_frictional, round_frictionless
  use sg_report, only: report_t
  implicit none
  private
  public :: measure_errors, natural_map

contains

  !> Fill the errors of a report from the impulses and velocities of a problem.
  pure subroutine measure_errors(problem, report)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    type(report_t), intent(inout) :: report !! errors and active contacts are set
    real(wp) :: f1, f8, speed, r2, u2, rho, friction, shift
    real(wp) :: u(2), r(2), f(2)
    integer :: k, active
    logical :: is_linear

    f1 = 0
    f8 = 0
    speed = 0
    r2 = 0
    u2 = 0
    active = 0
    do k = 1, problem%n_contacts
      call local_data(problem, k, rho, friction, shift, is_linear)
      if (.not. rho > 0) cycle
      u = compact_velocity(problem, k)
      r = 0
      r(:size(problem%impulse, 1)) = problem%impulse(:, k)
      r(1) = r(1) + shift
      if (any(abs(r) > 0)) active = active + 1
      r2 = r2 + r(1)**2 + r(2)**2
      u2 = u2 + u(1)**2 + u(2)**2
      f = natural_map(r, u, friction, 1.0_wp, is_linear)
      f1 = f1 + f(1)**2 + f(2)**2
      f = natural_map(r, u, friction, rho, is_linear)
      f8 = f8 + f(1)**2 + f(2)**2
      speed = speed + (f(1)**2 + f(2)**2)/rho**2
    end do
    report%active_contacts = active
    report%e1 = ratio(sqrt(f1), problem%free_norm)
    report%e2 = ratio(sqrt(f1), max(problem%free_norm, sqrt(r2), sqrt(u2)))
    report%e8 = ratio(sqrt(f8), sqrt(r2))
    report%violation = ratio(sqrt(speed/real(max(1, problem%n_contacts), wp)), problem%velocity_scale)
  end subroutine measure_errors

  !> Natural map of one contact: zero where impulse and velocity obey the law.
  pure function natural_map(r, u, friction, rho, is_linear) result(f)
    real(wp), intent(in) :: r(2) !! impulse, normal and tangential, cohesion added [N s]
    real(wp), intent(in) :: u(2) !! relative velocity with bias [m/s]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: rho !! scale of velocities [kg]
    logical, intent(in) :: is_linear !! no inequality: u = 0 is asked
    real(wp) :: f(2)

    if (is_linear) then
      f = rho*u
    else
      f = r - cone_projection(r - rho*[u(1) + friction*abs(u(2)), u(2)], friction)
    end if
  end function natural_map

  !> What the natural map needs of a contact; rho = 1/lambda_max(W_aa), zero where the contact takes no part.
  pure subroutine local_data(problem, k, rho, friction, shift, is_linear)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    real(wp), intent(out) :: rho, friction, shift
    logical, intent(out) :: is_linear
    real(wp) :: middle

    friction = 0
    shift = 0
    is_linear = .false.
    associate (record => problem%record)
      select case (problem%kind)
      case (round_frictionless)
        rho = record(4, k)
      case (round_frictional)
        friction = record(7, k)
        rho = record(5, k)
        if (friction > 0) rho = min(rho, record(6, k))
      case (arm_frictionless)
        rho = record(6, k)
      case (arm_frictional)
        friction = record(12, k)
        shift = record(13, k)
        is_linear = record(16, k) > 1.5_wp
        rho = 0
        if (record(16, k) < 0.5_wp) return
        middle = (record(9, k) + record(11, k))/2
        rho = 1/(middle + hypot((record(9, k) - record(11, k))/2, record(10, k)))
      case default
        rho = 0
      end select
    end associate
  end subroutine local_data

  !> A ratio of norms; 0 where both vanish, 1 where only the scale does.
  pure real(wp) function ratio(norm, scale)
    real(wp), intent(in) :: norm, scale

    if (scale > 0) then
      ratio = norm/scale
    else
      ratio = merge(1.0_wp, 0.0_wp, norm > 0)
    end if
  end function ratio
end module sg_residuals
