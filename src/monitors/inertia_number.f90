!> The inertia number I = rate sqrt(m/p): inertia of grains against their confinement (GDR MiDi 2004, da Cruz 2005).
!!
!! The rate is sqrt(2 D':D') of the deviator D' of the strain rate of the grains, the symmetric part of the affine
!! velocity field nearest to their velocities; a simple shear u_x = g y has the rate g.
module sg_inertia_number
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: velocity_gradient, shear_rate, inertia_number

contains

  !> Gradient of the affine velocity field nearest to the grains' velocities [1/s], in the least-squares sense.
  !!
  !! Zero where the grains are too few, or on one line, so that there is no such field.
  pure function velocity_gradient(bodies) result(gradient)
    type(bodies_t), intent(in) :: bodies !! bodies with positions and velocities of one moment
    real(wp) :: gradient(2, 2), spread(2, 2), mixed(2, 2), centre(2), drift(2), x(2), v(2), determinant
    integer :: i, j, n

    gradient = 0
    n = count(bodies%is_grain)
    if (n < 3) return
    centre = 0
    drift = 0
    do i = 1, bodies%n
      if (.not. bodies%is_grain(i)) cycle
      centre = centre + bodies%position(:, i)/real(n, wp)
      drift = drift + bodies%velocity(1:2, i)/real(n, wp)
    end do
    spread = 0
    mixed = 0
    do i = 1, bodies%n
      if (.not. bodies%is_grain(i)) cycle
      x = bodies%position(:, i) - centre
      v = bodies%velocity(1:2, i) - drift
      do j = 1, 2
        spread(:, j) = spread(:, j) + x*x(j)
        mixed(:, j) = mixed(:, j) + v*x(j)
      end do
    end do
    determinant = spread(1, 1)*spread(2, 2) - spread(1, 2)**2
    if (.not. determinant > sqrt(epsilon(determinant))*(spread(1, 1) + spread(2, 2))**2) return
    gradient = matmul(mixed, reshape([spread(2, 2), -spread(1, 2), -spread(1, 2), spread(1, 1)], [2, 2]))/determinant
  end function velocity_gradient

  !> Shear rate of a velocity gradient [1/s]: sqrt(2 D':D') of the deviator of its symmetric part.
  pure real(wp) function shear_rate(gradient)
    real(wp), intent(in) :: gradient(2, 2) !! gradient(a, b) = d v_a / d x_b [1/s]

    shear_rate = hypot(gradient(1, 1) - gradient(2, 2), gradient(1, 2) + gradient(2, 1))
  end function shear_rate

  !> Inertia number of plane grains; zero where nothing confines them.
  pure real(wp) function inertia_number(rate, mass, pressure)
    real(wp), intent(in) :: rate !! shear rate [1/s]
    real(wp), intent(in) :: mass !! mean mass of a grain, per metre of depth [kg/m]
    real(wp), intent(in) :: pressure !! mean pressure [Pa]

    inertia_number = 0
    if (pressure > 0) inertia_number = rate*sqrt(mass/pressure)
  end function inertia_number
end module sg_inertia_number
