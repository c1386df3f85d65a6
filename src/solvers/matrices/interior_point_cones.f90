!> Algebra of second-order cones x_1 >= |x_2..m|, one cone at a time (doc/theory/interior_point.md).
!!
!! Vectors have the length of their cone: 1 (a number that is not negative), 2 or 3. Scalings are those of [NesterovTodd1997],
!! in the form of [Vandenberghe2010].
module sg_interior_point_cones
  use sg_kinds, only: wp
  implicit none
  private
  public :: determinant, product_of, quotient_of, longest_step
  public :: find_scaling, scaled_by, metric_of

contains

  !> x_1^2 - |x_2..m|^2: positive inside the cone, zero on its boundary.
  pure real(wp) function determinant(x)
    real(wp), intent(in) :: x(:) !! vector of the cone
    real(wp) :: tail

    tail = norm2(x(2:))
    determinant = (x(1) - tail)*(x(1) + tail)
  end function determinant

  !> Product of Jordan's algebra: (a.b, a_1 b_tail + b_1 a_tail).
  pure function product_of(a, b) result(c)
    real(wp), intent(in) :: a(:), b(:) !! factors
    real(wp) :: c(size(a))

    c(1) = dot_product(a, b)
    c(2:) = a(1)*b(2:) + b(1)*a(2:)
  end function product_of

  !> The c for which l times c is b, where l is inside the cone.
  pure function quotient_of(l, b) result(c)
    real(wp), intent(in) :: l(:) !! divisor
    real(wp), intent(in) :: b(:) !! dividend
    real(wp) :: c(size(b)), tails

    tails = dot_product(l(2:), b(2:))
    c(1) = (l(1)*b(1) - tails)/determinant(l)
    c(2:) = (b(2:) - c(1)*l(2:))/l(1)
  end function quotient_of

  !> Longest step t for which x + t dx stays in the cone; `huge` when there is no limit.
  pure real(wp) function longest_step(x, dx) result(t)
    real(wp), intent(in) :: x(:) !! vector inside the cone
    real(wp), intent(in) :: dx(:) !! direction
    real(wp) :: size_x, head, tail(size(x) - 1), along, fall

    size_x = sqrt(determinant(x))
    along = (x(1)*dx(1) - dot_product(x(2:), dx(2:)))/size_x
    head = x(1)/size_x
    tail = dx(2:) - (along + dx(1))/(head + 1)*x(2:)/size_x
    fall = (norm2(tail) - along)/size_x
    t = huge(t)
    if (fall > 1/t) t = 1/fall
  end function longest_step

  !> Scaling of x and s inside the cone: the point w of determinant 1 and the factor beta for which W = beta (2 v v^T - J),
  !! v = (w + e)/sqrt(2 (w_1 + 1)), makes W x = W^-1 s.
  pure subroutine find_scaling(x, s, w, beta)
    real(wp), intent(in) :: x(:), s(:) !! the two vectors
    real(wp), intent(out) :: w(:) !! scaling point
    real(wp), intent(out) :: beta !! factor
    real(wp) :: size_x, size_s

    size_x = sqrt(determinant(x))
    size_s = sqrt(determinant(s))
    w = -x/size_x
    w(1) = -w(1)
    w = (s/size_s + w)/sqrt(2*(1 + dot_product(x/size_x, s/size_s)))
    beta = sqrt(size_s/size_x)
  end subroutine find_scaling

  !> W x, or W^-1 x.
  pure function scaled_by(w, beta, x, inverse) result(y)
    real(wp), intent(in) :: w(:) !! scaling point
    real(wp), intent(in) :: beta !! factor
    real(wp), intent(in) :: x(:) !! vector
    logical, intent(in) :: inverse !! by W^-1?
    real(wp) :: y(size(x)), tails, factor, tail(size(x) - 1)

    tail = merge(-1.0_wp, 1.0_wp, inverse)*w(2:)
    factor = beta
    if (inverse) factor = 1/beta
    tails = dot_product(tail, x(2:))
    y(1) = factor*(w(1)*x(1) + tails)
    y(2:) = factor*(x(2:) + (x(1) + tails/(1 + w(1)))*tail)
  end function scaled_by

  !> W^2 = beta^2 (2 w w^T - J), or its inverse.
  pure function metric_of(w, beta, inverse) result(k)
    real(wp), intent(in) :: w(:) !! scaling point
    real(wp), intent(in) :: beta !! factor
    logical, intent(in) :: inverse !! W^-2?
    real(wp) :: k(size(w), size(w)), v(size(w)), factor
    integer :: i

    v = w
    factor = beta**2
    if (inverse) then
      v(2:) = -w(2:)
      factor = 1/beta**2
    end if
    do i = 1, size(w)
      k(:, i) = 2*factor*v*v(i)
      k(i, i) = k(i, i) + merge(-factor, factor, i == 1)
    end do
  end function metric_of
end module sg_interior_point_cones
