!> Natural map of De Saxce's form [DeSaxceFeng1998], r - P_K(r - rho (u + g(u))), and the projection on Coulomb's cone
!! that it rests upon (doc/theory/errors.md).
!!
!! The projection stands in the file of both loops that use it for every contact, since the compiler does not compile procedures
!! of other files into a loop: called from another file on chunks of contacts, it made a test of errors 8 % slower for disks and
!! 4.5 % for spheres (`splitgrain bench --friction 0.3 --contacts 40000 --check-every 1`). `matrix_errors` has a projection of its
!! own on purpose: it judges answers independently of what found them.
module sg_natural_map
  use sg_kinds, only: wp
  implicit none
  private
  public :: natural_map, plane_squares, project, space_squares, chunk

  !> Contacts gathered at a time: their data stay in the first cache, and the map runs over them in vector registers
  integer, parameter :: chunk = 128

contains

  !> Squares of the natural map of a chunk of contacts in the plane.
  pure subroutine plane_squares(n, r_n, r_t, u_n, u_t, friction, rho, linear, squares)
    integer, intent(in) :: n !! contacts of the chunk
    real(wp), intent(in) :: r_n(chunk), r_t(chunk) !! impulses, cohesion added [N s]
    real(wp), intent(in) :: u_n(chunk), u_t(chunk) !! relative velocities with bias and compliance [m/s]
    real(wp), intent(in) :: friction(chunk) !! Coulomb coefficients
    real(wp), intent(in) :: rho(chunk) !! scales of velocities [kg]
    real(wp), intent(in) :: linear(chunk) !! 1 where no inequality but u = 0 is asked, else 0
    real(wp), intent(out) :: squares(chunk) !! squares of the map
    real(wp) :: f_n, f_t
    integer :: i

    do i = 1, n
      call project(r_n(i) - rho(i)*(u_n(i) + friction(i)*abs(u_t(i))), r_t(i) - rho(i)*u_t(i), friction(i), f_n, f_t)
      squares(i) = (r_n(i) - f_n)**2 + (r_t(i) - f_t)**2
    end do
    if (any(linear(:n) > 0)) then
      where (linear(:n) > 0) squares(:n) = rho(:n)**2*(u_n(:n)**2 + u_t(:n)**2)
    end if
  end subroutine plane_squares

  !> Squares of the natural map of a chunk of contacts in space: zero where impulse and velocity obey the law.
  pure subroutine space_squares(n, normal, u, r, friction, rho, linear, squares)
    integer, intent(in) :: n !! contacts of the chunk
    real(wp), intent(in) :: normal(chunk, 3) !! unit normals
    real(wp), intent(in) :: u(chunk, 3) !! relative velocities with bias and compliance [m/s]
    real(wp), intent(in) :: r(chunk, 3) !! impulses, cohesion added [N s]
    real(wp), intent(in) :: friction(chunk) !! Coulomb coefficients
    real(wp), intent(in) :: rho(chunk) !! scales of velocities [kg]
    real(wp), intent(in) :: linear(chunk) !! 1 where no inequality but u = 0 is asked, else 0
    real(wp), intent(out) :: squares(chunk) !! squares of the map
    real(wp) :: u_n, r_n, x, tx, ty, tz, sx, sy, sz, slip, length, height, share
    integer :: i

    do i = 1, n
      u_n = normal(i, 1)*u(i, 1) + normal(i, 2)*u(i, 2) + normal(i, 3)*u(i, 3)
      r_n = normal(i, 1)*r(i, 1) + normal(i, 2)*r(i, 2) + normal(i, 3)*r(i, 3)
      tx = u(i, 1) - u_n*normal(i, 1)
      ty = u(i, 2) - u_n*normal(i, 2)
      tz = u(i, 3) - u_n*normal(i, 3)
      slip = sqrt(tx*tx + ty*ty + tz*tz)
      ! The point r - rho (u + g(u)): x along the normal, (sx, sy, sz) across.
      x = r_n - rho(i)*(u_n + friction(i)*slip)
      sx = r(i, 1) - r_n*normal(i, 1) - rho(i)*tx
      sy = r(i, 2) - r_n*normal(i, 2) - rho(i)*ty
      sz = r(i, 3) - r_n*normal(i, 3) - rho(i)*tz
      length = sqrt(sx*sx + sy*sy + sz*sz)
      call project(x, length, friction(i), height, share)
      ! Of what is across, the nearest point has this share.
      share = share/max(length, tiny(1.0_wp))
      tx = r_n - height
      sx = r(i, 1) - r_n*normal(i, 1) - share*sx
      sy = r(i, 2) - r_n*normal(i, 2) - share*sy
      sz = r(i, 3) - r_n*normal(i, 3) - share*sz
      squares(i) = tx*tx + sx*sx + sy*sy + sz*sz
    end do
    if (any(linear(:n) > 0)) then
      where (linear(:n) > 0) squares(:n) = rho(:n)**2*(u(:n, 1)**2 + u(:n, 2)**2 + u(:n, 3)**2)
    end if
  end subroutine space_squares

  !> Natural map of one contact: zero where impulse and velocity obey the law.
  pure function natural_map(r, u, friction, rho, linear) result(f)
    real(wp), intent(in) :: r(2) !! impulse, normal and tangential, cohesion added [N s]
    real(wp), intent(in) :: u(2) !! relative velocity with bias and compliance [m/s]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: rho !! scale of velocities [kg]
    real(wp), intent(in) :: linear !! 1 where no inequality but u = 0 is asked, else 0
    real(wp) :: f(2), projected(2)

    call project(r(1) - rho*(u(1) + friction*abs(u(2))), r(2) - rho*u(2), friction, projected(1), projected(2))
    f = merge(rho*u, r - projected, linear > 0)
  end function natural_map

  !> Nearest point of Coulomb's cone |x_T| <= friction x_N: on its surface (or the tip), unless the point lies inside. Without
  !! friction the cone is a ray, and behind its tip the point is not inside. No branch, so that a loop goes through vector
  !! registers.
  pure elemental subroutine project(x, t, friction, normal, tangential)
    real(wp), intent(in) :: x !! normal part of the point
    real(wp), intent(in) :: t !! its tangential part in the plane; in space the length of that
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(out) :: normal !! normal part of the nearest point
    real(wp), intent(out) :: tangential !! its tangential part, or the length of that; the direction stays
    real(wp) :: height, inside

    inside = merge(1.0_wp, 0.0_wp, x > 0 .and. abs(t) <= friction*x)
    height = max(0.0_wp, (x + friction*abs(t))/(1 + friction*friction))
    normal = height + inside*(x - height)
    ! Inside the cone this is t.
    tangential = sign(min(friction*height, abs(t)), t)
  end subroutine project
end module sg_natural_map
