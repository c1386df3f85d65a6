!> The inertia number: inertia of grains against their confinement (GDR MiDi 2004).
!!
!! In the plane I = rate sqrt(m/p) (da Cruz 2005), in space I = rate d sqrt(rho/p) (Jop, Forterre and Pouliquen 2006).
!! The rate is sqrt(2 D':D') of the deviator D' of the strain rate of the grains, the symmetric part of the affine
!! velocity field nearest to their velocities; a simple shear u_x = g y has the rate g.
module sg_inertia_number
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp
  use sg_symmetric, only: principal_axes
  implicit none
  private
  public :: field_sums, gradient_of, shear_rate, inertia_number

contains

  !> Numbers of `field_sums`.
  pure integer function n_field_sums(dimension)
    integer, intent(in) :: dimension !! of space

    n_field_sums = 1 + 2*dimension*(1 + dimension)
  end function n_field_sums

  !> What the velocity field of this rank's grains is made of, ready to be summed over ranks: number of grains, and sums of
  !! places x about an origin, of velocities v, of (x - centre) (x) (x - centre) and of (v - drift) (x) (x - centre).
  !!
  !! The two last are of this rank's own centre and drift, so that nothing cancels, plus what brings the centre to the origin.
  pure function field_sums(bodies, origin) result(sums)
    type(bodies_t), intent(in) :: bodies !! bodies with positions and velocities of one moment
    real(wp), intent(in), optional :: origin(:) !! the same on all ranks and amid the grains [m]; their centre unless given
    real(wp) :: sums(n_field_sums(bodies%dimension))
    real(wp), dimension(bodies%dimension, bodies%dimension) :: spread, mixed
    real(wp), dimension(bodies%dimension) :: centre, drift, x, v
    integer :: i, j, n, d

    sums = 0
    d = bodies%dimension
    n = count(bodies%is_grain(:bodies%n_home))
    if (n == 0) return
    centre = 0
    drift = 0
    do i = 1, bodies%n_home
      if (.not. bodies%is_grain(i)) cycle
      centre = centre + bodies%position(:, i)/real(n, wp)
      drift = drift + bodies%velocity(:d, i)/real(n, wp)
    end do
    spread = 0
    mixed = 0
    do i = 1, bodies%n_home
      if (.not. bodies%is_grain(i)) cycle
      x = bodies%position(:, i) - centre
      v = bodies%velocity(:d, i) - drift
      do j = 1, d
        spread(:, j) = spread(:, j) + x*x(j)
        mixed(:, j) = mixed(:, j) + v*x(j)
      end do
    end do
    x = 0
    if (present(origin)) x = centre - origin
    sums = [real(n, wp), real(n, wp)*x, real(n, wp)*drift, spread + real(n, wp)*spread_out(x, x), &
            mixed + real(n, wp)*spread_out(drift, x)]
  end function field_sums

  !> Gradient of the affine velocity field nearest to the velocities that were summed [1/s], in the least-squares sense.
  !!
  !! Zero where the grains are too few, on one line, or in space in one plane, so that there is no such field.
  pure function gradient_of(sums, dimension) result(gradient)
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: sums(n_field_sums(dimension)) !! of `field_sums`, over all ranks
    real(wp), dimension(dimension, dimension) :: gradient, spread, mixed
    real(wp), dimension(dimension) :: centre, drift
    integer :: d, first

    d = dimension
    gradient = 0
    if (nint(sums(1)) <= d) return
    centre = sums(2:d + 1)/sums(1)
    drift = sums(d + 2:2*d + 1)/sums(1)
    first = 2*d + 2
    spread = reshape(sums(first:first + d**2 - 1), [d, d]) - sums(1)*spread_out(centre, centre)
    mixed = reshape(sums(first + d**2:), [d, d]) - sums(1)*spread_out(drift, centre)
    if (d == 3) then
      gradient = divided_in_space(mixed, spread)
    else
      gradient = divided(mixed, spread)
    end if
  end function gradient_of

  !> mixed spread^-1; zero where the points of the spread are nearly on a line.
  pure function divided(mixed, spread) result(gradient)
    real(wp), intent(in) :: mixed(2, 2), spread(2, 2)
    real(wp) :: gradient(2, 2), determinant

    gradient = 0
    determinant = spread(1, 1)*spread(2, 2) - spread(1, 2)**2
    if (.not. determinant > sqrt(epsilon(determinant))*(spread(1, 1) + spread(2, 2))**2) return
    gradient = matmul(mixed, reshape([spread(2, 2), -spread(1, 2), -spread(1, 2), spread(1, 1)], [2, 2]))/determinant
  end function divided

  !> The same in space, through the spread along its own axes; zero where its points are nearly in a plane.
  pure function divided_in_space(mixed, spread) result(gradient)
    real(wp), intent(in) :: mixed(3, 3), spread(3, 3)
    real(wp) :: gradient(3, 3), values(3), axes(3, 3)
    integer :: i

    gradient = 0
    call principal_axes(spread, values, axes)
    if (.not. minval(values) > sqrt(epsilon(values))*sum(values)) return
    do i = 1, 3
      gradient = gradient + spread_out(matmul(mixed, axes(:, i))/values(i), axes(:, i))
    end do
  end function divided_in_space

  !> The matrix a (x) b.
  pure function spread_out(a, b) result(matrix)
    real(wp), intent(in) :: a(:), b(:)
    real(wp) :: matrix(size(a), size(b))
    integer :: j

    do j = 1, size(b)
      matrix(:, j) = a*b(j)
    end do
  end function spread_out

  !> Shear rate of a velocity gradient [1/s]: sqrt(2 D':D') of the deviator of its symmetric part.
  pure real(wp) function shear_rate(gradient)
    real(wp), intent(in) :: gradient(:, :) !! gradient(a, b) = d v_a / d x_b [1/s]
    real(wp) :: deviator(3, 3), third
    integer :: i

    if (size(gradient, 1) == 2) then
      shear_rate = hypot(gradient(1, 1) - gradient(2, 2), gradient(1, 2) + gradient(2, 1))
    else
      deviator = (gradient + transpose(gradient))/2
      third = (gradient(1, 1) + gradient(2, 2) + gradient(3, 3))/3
      do i = 1, 3
        deviator(i, i) = deviator(i, i) - third
      end do
      shear_rate = sqrt(2.0_wp)*norm2(deviator)
    end if
  end function shear_rate

  !> Inertia number; zero where nothing confines the grains.
  pure real(wp) function inertia_number(rate, mass, pressure)
    real(wp), intent(in) :: rate !! shear rate [1/s]
    real(wp), intent(in) :: mass !! mean mass of a grain per metre of depth; in space rho d^2 of grains of diameter d [kg/m]
    real(wp), intent(in) :: pressure !! mean pressure [Pa]

    inertia_number = 0
    if (pressure > 0) inertia_number = rate*sqrt(mass/pressure)
  end function inertia_number
end module sg_inertia_number
