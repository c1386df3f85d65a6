!> Velocity by which one contact breaks its law, normal part and friction apart (doc/theory/errors.md).
!!
!! The natural map of the other errors adds friction times the slip to the normal velocity, so that large friction hides a
!! normal velocity in it: at zero impulse by the factor sqrt(1 + friction^2). Here each part has its own map [AlartCurnier1991].
!! Large impulses on light bodies leave a velocity of rounding, which is no violation.
module sg_law_violation
  use sg_kinds, only: wp
  use sg_natural_map, only: chunk
  implicit none
  private
  public :: largest_bound, law_violation, most_hidden, next_chunk, plane_bounds, rounding, space_bounds, take_largest

  !> Velocity that rounding leaves, over the velocity that the impulse gives the lighter body
  real(wp), parameter :: rounding = 16*epsilon(1.0_wp)
  !> What bounds are raised by, as a share of themselves, and of the squares that they are differences of: far beyond rounding
  real(wp), parameter :: margin = 1e-6_wp, least_share = 1e-21_wp

contains

  !> Velocity by which a contact breaks its law [m/s]; zero exactly where it obeys.
  pure real(wp) function law_violation(u, r, friction, rho, is_linear) result(speed)
    real(wp), intent(in) :: u(:) !! relative velocity with bias and compliance, normal first [m/s]
    real(wp), intent(in) :: r(:) !! impulse with cohesion, normal first [N s]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: rho !! 1/lambda_max(W_aa) [kg]; zero where the contact takes no part
    logical, intent(in) :: is_linear !! is u = 0 asked?
    real(wp) :: tried(size(u) - 1), radius, length

    speed = 0
    if (.not. rho > 0) return
    if (is_linear) then
      speed = norm2(u)
      return
    end if
    radius = friction*max(0.0_wp, r(1))
    tried = r(2:) - rho*u(2:)
    length = norm2(tried)
    if (length > radius) tried = tried*(radius/length)
    speed = hypot(min(u(1), r(1)/rho), norm2(r(2:) - tried)/rho)
    speed = max(0.0_wp, speed - rounding*norm2(r)/rho)
  end function law_violation

  !> Upper bounds of the squares of that velocity of a chunk of contacts in the plane: cheap, so that few contacts are looked at one
  !! by one where the largest is sought [m2/s2].
  pure subroutine plane_bounds(n, u_n, u_t, r_n, r_t, friction, rho, linear, squares)
    integer, intent(in) :: n !! contacts of the chunk
    real(wp), intent(in) :: u_n(chunk), u_t(chunk) !! relative velocities with bias and compliance [m/s]
    real(wp), intent(in) :: r_n(chunk), r_t(chunk) !! impulses, cohesion added [N s]
    real(wp), intent(in) :: friction(chunk) !! Coulomb coefficients
    real(wp), intent(in) :: rho(chunk) !! scales of velocities [kg]; zero where a contact takes no part
    real(wp), intent(in) :: linear(chunk) !! 1 where u = 0 is asked, else 0
    real(wp), intent(out) :: squares(chunk) !! bounds
    real(wp) :: per_mass, tried, broken_n, broken_t
    integer :: i

    do i = 1, n
      per_mass = merge(1.0_wp, 0.0_wp, rho(i) > 0)/merge(rho(i), 1.0_wp, rho(i) > 0)
      tried = r_t(i) - rho(i)*u_t(i)
      broken_n = min(u_n(i), r_n(i)*per_mass)
      broken_t = (r_t(i) - sign(min(abs(tried), friction(i)*max(0.0_wp, r_n(i))), tried))*per_mass
      squares(i) = raised(broken_n**2 + broken_t**2, u_n(i)**2 + u_t(i)**2, (r_n(i)**2 + r_t(i)**2)*per_mass**2, rho(i), linear(i))
    end do
  end subroutine plane_bounds

  !> The same in space.
  pure subroutine space_bounds(n, normal, u, r, friction, rho, linear, squares)
    integer, intent(in) :: n !! contacts of the chunk
    real(wp), intent(in) :: normal(chunk, 3) !! unit normals
    real(wp), intent(in) :: u(chunk, 3) !! relative velocities with bias and compliance [m/s]
    real(wp), intent(in) :: r(chunk, 3) !! impulses, cohesion added [N s]
    real(wp), intent(in) :: friction(chunk) !! Coulomb coefficients
    real(wp), intent(in) :: rho(chunk) !! scales of velocities [kg]; zero where a contact takes no part
    real(wp), intent(in) :: linear(chunk) !! 1 where u = 0 is asked, else 0
    real(wp), intent(out) :: squares(chunk) !! bounds
    real(wp) :: per_mass, u_n, r_n, tx, ty, tz, sx, sy, sz, radius, share, square
    integer :: i

    do i = 1, n
      per_mass = merge(1.0_wp, 0.0_wp, rho(i) > 0)/merge(rho(i), 1.0_wp, rho(i) > 0)
      u_n = normal(i, 1)*u(i, 1) + normal(i, 2)*u(i, 2) + normal(i, 3)*u(i, 3)
      r_n = normal(i, 1)*r(i, 1) + normal(i, 2)*r(i, 2) + normal(i, 3)*r(i, 3)
      tx = r(i, 1) - r_n*normal(i, 1)
      ty = r(i, 2) - r_n*normal(i, 2)
      tz = r(i, 3) - r_n*normal(i, 3)
      sx = tx - rho(i)*(u(i, 1) - u_n*normal(i, 1))
      sy = ty - rho(i)*(u(i, 2) - u_n*normal(i, 2))
      sz = tz - rho(i)*(u(i, 3) - u_n*normal(i, 3))
      radius = friction(i)*max(0.0_wp, r_n)
      share = radius/max(radius, sqrt(sx*sx + sy*sy + sz*sz), tiny(1.0_wp))
      square = min(u_n, r_n*per_mass)**2 + ((tx - share*sx)**2 + (ty - share*sy)**2 + (tz - share*sz)**2)*per_mass**2
      squares(i) = raised(square, u(i, 1)**2 + u(i, 2)**2 + u(i, 3)**2, &
                          (r(i, 1)**2 + r(i, 2)**2 + r(i, 3)**2)*per_mass**2, rho(i), linear(i))
    end do
  end subroutine space_bounds

  !> Largest of the bounds of a chunk; no bound where one of them is not finite.
  pure real(wp) function largest_bound(squares)
    real(wp), intent(in) :: squares(:) !! bounds

    largest_bound = huge(1.0_wp)
    if (all(squares <= huge(1.0_wp))) largest_bound = maxval(squares)
  end function largest_bound

  !> The chunk to look at in a turn of a search for the worst contact: where there are bounds, the one with the largest, until no
  !! chunk can have a worse contact than what was found.
  pure subroutine next_chunk(turn, speed, bounds, first)
    integer, intent(in) :: turn !! number of the turn
    real(wp), intent(in) :: speed !! largest velocity found so far [m/s]
    real(wp), allocatable, intent(inout) :: bounds(:) !! of the chunks not looked at, zero of the others; or not there
    integer, intent(out) :: first !! first contact of the chunk; zero for none
    integer :: next

    next = turn
    if (allocated(bounds)) call take_largest(bounds, speed, next)
    first = max(0, (next - 1)*chunk + 1)
  end subroutine next_chunk

  !> Take the largest of the bounds that are left, if it is above what was found.
  pure subroutine take_largest(bounds, speed, place)
    real(wp), intent(inout) :: bounds(:) !! bounds of squares, zero of what was taken [m2/s2]
    real(wp), intent(in) :: speed !! largest velocity found so far [m/s]
    integer, intent(out) :: place !! which one; zero for none

    place = maxloc(bounds, 1)
    if (place == 0) return
    if (bounds(place) > speed**2) then
      bounds(place) = 0
    else
      place = 0
    end if
  end subroutine take_largest

  !> Bound of a square from one computed in another order.
  pure real(wp) function raised(square, u2, r2, rho, linear)
    real(wp), intent(in) :: square !! as computed, of laws with inequalities
    real(wp), intent(in) :: u2, r2 !! squares of relative velocity and of the impulse over rho
    real(wp), intent(in) :: rho, linear

    raised = merge(u2, square, linear > 0)*(1 + margin) + least_share*(u2 + r2)
    raised = merge(raised, 0.0_wp, rho > 0)
  end function raised

  !> How many times larger than the velocity error of the natural map that velocity is at most.
  pure real(wp) function most_hidden(friction)
    real(wp), intent(in) :: friction !! largest Coulomb coefficient

    most_hidden = sqrt(2.0_wp)*hypot(1.0_wp, min(friction, 1e100_wp))
  end function most_hidden
end module sg_law_violation
