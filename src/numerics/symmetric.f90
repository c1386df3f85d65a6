!> Principal values and axes of a symmetric 3x3 matrix, such as an inertia tensor or a stress.
!!
!! Jacobi's rotations: each makes one pair of entries off the diagonal vanish, and every axis comes out orthogonal to
!! rounding however close the values are, which closed forms by the cubic's roots do not give.
module sg_symmetric
  use sg_kinds, only: wp
  use sg_vectors, only: determinant
  implicit none
  private
  public :: largest_eigenvalue, principal_axes

  !> Sweeps through the three pairs: convergence is quadratic, six have always been enough
  integer, parameter :: most_sweeps = 30
  !> Share of the largest entry below which one off the diagonal is zero
  real(wp), parameter :: rounding = epsilon(1.0_wp)/16
  !> The two axes of each of the three rotations
  integer, parameter :: pairs(2, 3) = reshape([1, 2, 1, 3, 2, 3], [2, 3])
  !> All orders of three axes
  integer, parameter :: orders(3, 6) = reshape([1, 2, 3, 2, 1, 3, 1, 3, 2, 3, 2, 1, 2, 3, 1, 3, 1, 2], [3, 6])

contains

  !> Values and axes such that `matrix` = axes diag(values) axes^T; the axes are right-handed.
  !!
  !! Of the 24 right-handed orders and signs those are taken that turn the given axes least, so that a matrix that is
  !! diagonal, or nearly so, keeps its axes, and a small change of the matrix does not swap them. Where values are equal
  !! to `tolerance` their axes are any two: then too the given ones are kept as far as they go.
  pure subroutine principal_axes(matrix, values, axes, tolerance)
    real(wp), intent(in) :: matrix(3, 3) !! symmetric; the upper triangle is read
    real(wp), intent(out) :: values(3) !! principal values, in the unit of the matrix
    real(wp), intent(out) :: axes(3, 3) !! columns: unit axes in the frame of the matrix
    real(wp), intent(in), optional :: tolerance !! values are equal that differ by less than this share of the largest entry
    real(wp) :: a(3, 3), found(3, 3), scale, equal
    integer :: sweep, k, best
    logical :: is_done

    scale = max(maxval(abs(matrix(1, :))), maxval(abs(matrix(2, 2:))), abs(matrix(3, 3)))
    found = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    values = 0
    axes = found
    if (.not. scale > tiny(scale)) return
    equal = 0
    if (present(tolerance)) equal = tolerance/2
    a = matrix/scale
    do sweep = 1, most_sweeps
      is_done = .true.
      do k = 1, 3
        associate (p => pairs(1, k), q => pairs(2, k))
          if (abs(a(p, q)) <= rounding) cycle
          ! Half the difference of the two values.
          if (hypot(a(p, q), (a(q, q) - a(p, p))/2) <= equal) cycle
          call rotate(p, q, a, found)
          is_done = .false.
        end associate
      end do
      if (is_done) exit
    end do
    best = nearest_order(found)
    do k = 1, 3
      axes(:, k) = found(:, orders(k, best))
      values(k) = scale*a(orders(k, best), orders(k, best))
    end do
    call choose_signs(axes)
  end subroutine principal_axes

  !> Turn axes p and q of a symmetric matrix (upper triangle) so that its entry between them vanishes.
  pure subroutine rotate(p, q, a, axes)
    integer, intent(in) :: p, q
    real(wp), intent(inout) :: a(3, 3), axes(3, 3)
    real(wp) :: theta, t, c, s, x, y, column(3)
    integer :: r

    theta = (a(q, q) - a(p, p))/(2*a(p, q))
    ! The smaller of the two angles; theta may be as large as the inverse of rounding.
    t = 1/(abs(theta) + hypot(1.0_wp, theta))
    if (theta < 0) t = -t
    c = 1/sqrt(1 + t**2)
    s = t*c
    a(p, p) = a(p, p) - t*a(p, q)
    a(q, q) = a(q, q) + t*a(p, q)
    a(p, q) = 0
    r = 6 - p - q
    x = a(min(p, r), max(p, r))
    y = a(min(q, r), max(q, r))
    a(min(p, r), max(p, r)) = c*x - s*y
    a(min(q, r), max(q, r)) = s*x + c*y
    column = axes(:, p)
    axes(:, p) = c*column - s*axes(:, q)
    axes(:, q) = s*column + c*axes(:, q)
  end subroutine rotate

  !> The order in which these axes are nearest to the given ones; of orders equally near, the first.
  pure integer function nearest_order(axes) result(best)
    real(wp), intent(in) :: axes(3, 3)
    real(wp) :: near, nearest
    integer :: i, k

    best = 1
    nearest = 0
    do i = 1, size(orders, 2)
      near = sum([(abs(axes(k, orders(k, i))), k=1, 3)])
      ! A tie is broken by the order above, not by rounding.
      if (near < nearest + 1e-9_wp) cycle
      nearest = near
      best = i
    end do
  end function nearest_order

  !> Point each axis the way of the given one; where the three are left-handed then, turn the one that is least sure.
  pure subroutine choose_signs(axes)
    real(wp), intent(inout) :: axes(3, 3)
    real(wp) :: along(3)
    integer :: k

    do k = 1, 3
      if (axes(k, k) < -1e-12_wp) axes(:, k) = -axes(:, k)
      along(k) = axes(k, k)
    end do
    if (determinant(axes) > 0) return
    k = minloc(along, 1)
    axes(:, k) = -axes(:, k)
  end subroutine choose_signs

  !> Largest eigenvalue of a symmetric 3 x 3 matrix: the largest root of its characteristic polynomial.
  !!
  !! With the mean m of the eigenvalues and their spread p that root is m + p (1 + z), where z in 0..1 solves z^2 (z + 3) = 4 t^2
  !! with 2 t^2 = 1 + det((W - m I)/p)/2. At double roots (t = 0) z/t is smooth: from a fit of it to 1e-5 one step of Halley's
  !! method reaches rounding, in a third of the time of the same root by an arc cosine.
  pure real(wp) function largest_eigenvalue(w) result(largest)
    real(wp), intent(in) :: w(3, 3) !! matrix
    real(wp), parameter :: fit(5) = [1.154686_wp, -0.2214748_wp, 0.1004688_wp, -0.04453444_wp, 0.01086309_wp]
    ! Of t^2; what it adds to the result is less than rounding.
    real(wp), parameter :: least = epsilon(1.0_wp)**2/16
    real(wp) :: mean, x, y, z, xy, xz, yz, p, t, value, slope

    mean = (w(1, 1) + w(2, 2) + w(3, 3))/3
    x = w(1, 1) - mean
    y = w(2, 2) - mean
    z = w(3, 3) - mean
    p = sqrt((x**2 + y**2 + z**2 + 2*(w(1, 2)**2 + w(1, 3)**2 + w(2, 3)**2))/6)
    largest = mean
    if (.not. p > epsilon(1.0_wp)*abs(mean)) return
    t = 1/p
    x = t*x
    y = t*y
    z = t*z
    xy = t*w(1, 2)
    xz = t*w(1, 3)
    yz = t*w(2, 3)
    t = sqrt(max(least, min(1.0_wp, (2 + (x*(y*z - yz**2) - xy*(xy*z - yz*xz) + xz*(xy*yz - y*xz)))/4)))
    z = t*(fit(1) + t*(fit(2) + t*(fit(3) + t*(fit(4) + t*fit(5)))))
    value = z**2*(z + 3) - 4*t**2
    slope = 3*z*(z + 2)
    z = z - value*slope/(slope**2 - 3*(z + 1)*value)
    largest = mean + p*(1 + z)
  end function largest_eigenvalue
end module sg_symmetric
