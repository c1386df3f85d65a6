!> The inertia number: inertia of grains against their confinement [GDRMiDi2004].
!!
!! In the plane I = rate sqrt(m/p) [DaCruz2005], in space I = rate d sqrt(rho/p) [Jop2006].
!! The rate is sqrt(2 D':D') of the deviator D' of the strain rate of the grains, the symmetric part of the affine
!! velocity field nearest to their velocities; a simple shear u_x = g y has the rate g.
module sg_inertia_number
  use sg_bodies, only: bodies_t
  use sg_compactness, only: box_of
  use sg_grains, only: grains_of, grains_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_stress, only: mean_pressure
  use sg_symmetric, only: principal_axes
  use sg_tally, only: pass_columns, pass_sums, ratio, tally_t
  implicit none
  private
  public :: measure_inertia, measure_shear_rate, field_sums, gradient_of, n_field_sums, rate_of_sums

contains

  !> Inertia number; zero where nothing confines the grains.
  pure subroutine measure_inertia(scene, tally)
    type(scene_t), intent(in) :: scene !! scene with positions and velocities of one moment
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: pressure

    if (tally%pass == pass_sums) then
      if (tally%is_shared) then
        call tally%sums%put('field', field_sums(scene%bodies, middle_of(box_of(scene%dimension, tally))))
      else
        call tally%sums%put('field', field_sums(scene%bodies))
      end if
    else if (tally%pass == pass_columns) then
      pressure = mean_pressure(scene, tally)
      call tally%add('inertia_number', rate_of(scene%dimension, tally) &
                     *sqrt(ratio(mass_by_length(grains_of(tally), scene%dimension), pressure)))
    end if
  end subroutine measure_inertia

  !> Shear rate of the grains [1/s]: from the sums of `measure_inertia`.
  pure subroutine measure_shear_rate(dimension, tally)
    integer, intent(in) :: dimension !! of space
    type(tally_t), intent(inout) :: tally !! tally of the measure

    if (tally%pass == pass_columns) call tally%add('shear_rate', rate_of(dimension, tally))
  end subroutine measure_shear_rate

  !> Shear rate from the sums of all ranks [1/s].
  pure real(wp) function rate_of(dimension, tally) result(rate)
    integer, intent(in) :: dimension
    type(tally_t), intent(in) :: tally

    rate = rate_of_sums(tally%sums%get('field', n_field_sums(dimension)), dimension)
  end function rate_of

  !> Shear rate from the sums of `field_sums` over all ranks [1/s].
  pure real(wp) function rate_of_sums(sums, dimension) result(rate)
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: sums(n_field_sums(dimension)) !! of all ranks

    rate = shear_rate(gradient_of(sums, dimension))
  end function rate_of_sums

  !> Middle of a box [m]; the origin where it is empty.
  pure function middle_of(box) result(middle)
    real(wp), intent(in) :: box(:, :)
    real(wp) :: middle(size(box, 1))

    middle = 0
    if (all(box(:, 1) <= box(:, 2))) middle = (box(:, 1) + box(:, 2))/2
  end function middle_of

  !> Inertia of the inertia number [kg/m]: the mean mass of a grain in the plane, rho d^2 in space.
  pure real(wp) function mass_by_length(grains, dimension) result(mass)
    type(grains_t), intent(in) :: grains
    integer, intent(in) :: dimension

    if (dimension == 2) then
      mass = ratio(grains%mass, real(grains%n, wp))
    else
      mass = ratio(grains%mass, grains%area)*(2*grains%mean_radius)**2
    end if
  end function mass_by_length

  !> Numbers of `field_sums`.
  pure integer function n_field_sums(dimension)
    integer, intent(in) :: dimension !! of space

    n_field_sums = 1 + 2*dimension*(1 + dimension)
  end function n_field_sums

  !> What the velocity field of this rank's grains is made of, ready to be summed over ranks: number of grains, and sums of
  !! places x about an origin, of velocities v, of (x - centre) (x) (x - centre) and of (v - drift) (x) (x - centre).
  !!
  !! The two last are of this rank's own centre and drift, so that nothing cancels, plus what brings the centre to the origin.
  pure function field_sums(bodies, origin, is_counted) result(sums)
    type(bodies_t), intent(in) :: bodies !! bodies with positions and velocities of one moment
    real(wp), intent(in), optional :: origin(:) !! the same on all ranks and amid the grains [m]; their centre unless given
    logical, intent(in), optional :: is_counted(:) !! bodies that count; the grains unless given
    real(wp) :: sums(n_field_sums(bodies%dimension))
    real(wp), dimension(bodies%dimension, bodies%dimension) :: spread, mixed
    real(wp), dimension(bodies%dimension) :: centre, drift, x, v
    logical :: counts(bodies%n_own)
    integer :: i, j, n, d

    sums = 0
    d = bodies%dimension
    counts = bodies%is_grain(:bodies%n_own)
    if (present(is_counted)) counts = is_counted(:bodies%n_own)
    n = count(counts)
    if (n == 0) return
    centre = 0
    drift = 0
    do i = 1, bodies%n_own
      if (.not. counts(i)) cycle
      centre = centre + bodies%position(:, i)/real(n, wp)
      drift = drift + bodies%velocity(:d, i)/real(n, wp)
    end do
    spread = 0
    mixed = 0
    do i = 1, bodies%n_own
      if (.not. counts(i)) cycle
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
end module sg_inertia_number
