!> One step of the interior point method: predictor and corrector of Mehrotra on scaled cones (doc/theory/interior_point.md).
!!
!! A contact's impulse is x = (friction r_N, r_T) and its velocity s = ((u_N + shift)/friction, u_T), both of the cone
!! x_1 >= |x_2..m|, so that Coulomb's law reads x.s = 0. Without friction m is 1, and r_T stays zero. The shift friction |u_T|
!! is left out at first: the problem is then convex. Later it is friction sqrt(|u_T|^2 + epsilon^2), and the step accounts for its
!! change; epsilon^2 falls with the complementarity.
module sg_interior_point_step
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_cone_system, only: cone_system_t
  use sg_error, only: error_t
  use sg_interior_point_cones, only: determinant, find_scaling, longest_step, metric_of, product_of, quotient_of, scaled_by
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  implicit none
  private
  public :: point_t, start_point, take_step

  !> Part of the way to the boundary that a step goes
  real(wp), parameter :: part_of_way = 0.95_wp
  !> A step shorter than this is compared with plainer ones
  real(wp), parameter :: short = 0.3_wp
  !> Least sqrt(det x det s) of a contact, over the average complementarity
  real(wp), parameter :: centrality = 1e-3_wp
  !> epsilon^2 over the average complementarity
  real(wp), parameter :: smoothing = 0.01_wp
  !> Metric of the first guess, over the mean diagonal of W
  real(wp), parameter :: first_metric = 0.01_wp

  !> A point inside the cones, and the linearisation there
  type :: point_t
    !> Is the shift of Coulomb's law there?
    logical :: has_shift = .false.
    !> Average complementarity x.s of a contact, and number of contacts
    real(wp) :: tau = 0
    real(wp), private :: contacts = 0
    !> Impulses r and velocities u of the problem without units, shape (d, n)
    real(wp), allocatable :: r(:, :), u(:, :)
    !> The same in their cones; entries beyond m are zero
    real(wp), allocatable, private :: x(:, :), s(:, :)
    !> Length of each cone's vectors, and what r_N is multiplied with
    integer, allocatable, private :: m(:)
    real(wp), allocatable, private :: lift(:)
    !> Scaling, scaled point, and by how much s misses its equation
    real(wp), allocatable, private :: w(:, :), beta(:), lambda(:, :), missing(:, :)
    !> Blocks of the system
    real(wp), allocatable, private :: a(:, :, :), b(:, :, :)
  end type point_t

contains

  !> A point inside all cones, near the solution of W r + q = 0.
  subroutine start_point(scaled, system, point, is_done)
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    class(cone_system_t), intent(inout) :: system !! system, prepared
    type(point_t), intent(out) :: point !! the point
    logical, intent(out) :: is_done !! could the system be solved?
    type(error_t), allocatable :: error
    real(wp) :: sums(4), rises(2)
    integer :: a, k, d

    d = scaled%d
    allocate (point%m(scaled%n), point%lift(scaled%n), point%beta(scaled%n), point%a(d, d, scaled%n), point%b(d, d, scaled%n))
    allocate (point%x(d, scaled%n), point%s(d, scaled%n), point%w(d, scaled%n), point%lambda(d, scaled%n), &
              point%missing(d, scaled%n), point%u(d, scaled%n), point%r(d, scaled%n), source=0.0_wp)
    point%m = merge(d, 1, scaled%friction > 0)
    point%lift = merge(scaled%friction, 1.0_wp, scaled%friction > 0)
    point%missing = -scaled%q
    do a = 1, scaled%n
      call set_blocks(point, a, first_metric*identity(point%m(a)), identity(point%m(a))/first_metric, system%is_global)
      point%missing(point%m(a) + 1:, a) = 0
    end do
    call system%factorise(scaled, .true., point%a, point%b, error)
    is_done = .not. allocated(error)
    if (.not. is_done) return
    call system%solve(scaled, point%missing, point%r, point%u)
    point%u = point%u + scaled%q
    do a = 1, scaled%n
      k = point%m(a)
      point%x(:k, a) = raised(point%r(:k, a), point%lift(a))
      point%s(:k, a) = raised(point%u(:k, a), 1/point%lift(a))
    end do
    call move_inside(system, point%x, point%s, sums)
    is_done = ieee_is_finite(sums(1))
    if (.not. is_done) return
    point%contacts = sums(4)
    rises = max(sums(1)/sums(3:2:-1)/2, epsilon(sums))
    point%x(1, :) = point%x(1, :) + rises(1)
    point%s(1, :) = point%s(1, :) + rises(2)
    call set_impulses(scaled, system, point)
  end subroutine start_point

  !> Raise the first entries until all vectors are in their cones, and return how complementary they are then, the sums of first
  !! entries, and the number of contacts.
  subroutine move_inside(system, x, s, sums)
    class(cone_system_t), intent(inout) :: system
    real(wp), intent(inout) :: x(:, :), s(:, :)
    real(wp), intent(out) :: sums(4)
    real(wp) :: lowest(2)
    integer :: a, k

    lowest = 0
    do a = 1, size(x, 2)
      lowest(1) = min(lowest(1), x(1, a) - norm2(x(2:, a)))
      lowest(2) = min(lowest(2), s(1, a) - norm2(s(2:, a)))
    end do
    do k = 1, 2
      call system%find_least(lowest(k))
    end do
    x(1, :) = x(1, :) - 1.5_wp*lowest(1)
    s(1, :) = s(1, :) - 1.5_wp*lowest(2)
    do k = 1, 2
      sums = [sum(x*s), sum(x(1, :)), sum(s(1, :)), real(size(x, 2), wp)]
      call system%add_up(sums)
      if (sums(2) > 0 .and. sums(3) > 0) exit
      if (.not. sums(2) > 0) x(1, :) = 1
      if (.not. sums(3) > 0) s(1, :) = 1
    end do
  end subroutine move_inside

  !> r, u and the complementarity of a point.
  subroutine set_impulses(scaled, system, point)
    type(matrix_problem_t), intent(in) :: scaled
    class(cone_system_t), intent(inout) :: system
    type(point_t), intent(inout) :: point
    integer :: a

    do a = 1, scaled%n
      point%r(:, a) = raised(point%x(:, a), 1/point%lift(a))
    end do
    call system%multiply(scaled, point%r, point%u)
    point%u = point%u + scaled%q
    point%tau = average(system, point, point%x, point%s)
  end subroutine set_impulses

  !> Average complementarity of a contact.
  real(wp) function average(system, point, x, s)
    class(cone_system_t), intent(inout) :: system
    type(point_t), intent(in) :: point
    real(wp), intent(in) :: x(:, :), s(:, :)
    real(wp) :: sums(1)

    sums = sum(x*s)
    call system%add_up(sums)
    average = sums(1)/point%contacts
  end function average

  !> A vector with its first entry multiplied.
  pure function raised(v, lift) result(y)
    real(wp), intent(in) :: v(:), lift
    real(wp) :: y(size(v))

    y = v
    y(1) = lift*v(1)
  end function raised

  !> One step towards the solution.
  subroutine take_step(scaled, system, point, length, is_done)
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    class(cone_system_t), intent(inout) :: system !! system, prepared
    type(point_t), intent(inout) :: point !! the point
    real(wp), intent(out) :: length !! part of the step that was taken
    logical, intent(out) :: is_done !! could the system be solved?
    real(wp), parameter :: plainer(2) = [0.3_wp, 0.9_wp]
    type(error_t), allocatable :: error
    real(wp), allocatable :: dx(:, :), ds(:, :), dx_try(:, :), ds_try(:, :)
    real(wp) :: centre, tried
    integer :: i

    length = 0
    call linearise(scaled, system%is_global, point)
    call system%factorise(scaled, .not. (point%has_shift .and. any(point%m > 1)), point%a, point%b, error)
    is_done = .not. allocated(error)
    if (.not. is_done) return
    allocate (dx, ds, dx_try, ds_try, mold=point%x)
    dx_try = 0
    ds_try = 0
    call direction(scaled, system, point, 0.0_wp, dx_try, ds_try, dx, ds)
    tried = min(1.0_wp, longest(system, point, dx, ds))
    centre = average(system, point, point%x + tried*dx, point%s + tried*ds)/point%tau
    centre = min(1.0_wp, max(1e-6_wp, centre**3))
    call direction(scaled, system, point, centre, dx, ds, dx_try, ds_try)
    call move_alloc(dx_try, dx)
    call move_alloc(ds_try, ds)
    length = min(1.0_wp, part_of_way*longest(system, point, dx, ds))
    if (length < short) then
      allocate (dx_try, ds_try, mold=point%x)
      do i = 1, size(plainer)
        call direction(scaled, system, point, plainer(i), 0*dx, 0*ds, dx_try, ds_try)
        tried = min(1.0_wp, part_of_way*longest(system, point, dx_try, ds_try))
        if (.not. tried > 1.5_wp*length) cycle
        length = tried
        dx = dx_try
        ds = ds_try
      end do
    end if
    is_done = ieee_is_finite(average(system, point, dx, dx) + average(system, point, ds, ds))
    if (is_done) call move(scaled, system, point, dx, ds, length)
  end subroutine take_step

  !> Scalings, blocks and the missing part of s at a point.
  pure subroutine linearise(scaled, is_global, point)
    type(matrix_problem_t), intent(in) :: scaled
    logical, intent(in) :: is_global
    type(point_t), intent(inout) :: point
    real(wp) :: shift
    integer :: a, m

    do a = 1, scaled%n
      m = point%m(a)
      associate (x => point%x(:m, a), s => point%s(:m, a), w => point%w(:m, a), beta => point%beta(a))
        call find_scaling(x, s, w, beta)
        point%lambda(:m, a) = scaled_by(w, beta, x, .false.)
        call set_blocks(point, a, metric_of(w, beta, .false.), metric_of(w, beta, .true.), is_global)
        point%missing(:m, a) = raised(point%u(:m, a), 1/point%lift(a)) - s
      end associate
      if (.not. point%has_shift .or. m == 1) cycle
      shift = sqrt(sum(point%u(2:, a)**2) + smoothing*point%tau)
      point%missing(1, a) = point%missing(1, a) + shift
      point%a(1, 2:, a) = scaled%friction(a)*point%u(2:, a)/shift
    end do
  end subroutine linearise

  !> The blocks of a contact, from the metric of its cone and the inverse of that: A = 1, B = D K D or its inverse.
  pure subroutine set_blocks(point, a, metric, inverse, is_global)
    type(point_t), intent(inout) :: point
    integer, intent(in) :: a
    real(wp), intent(in) :: metric(:, :), inverse(:, :)
    logical, intent(in) :: is_global
    real(wp) :: lift
    integer :: m

    m = point%m(a)
    point%a(:, :, a) = 0
    point%a(:m, :m, a) = identity(m)
    point%b(:, :, a) = identity(size(point%b, 1))
    lift = point%lift(a)
    if (is_global) lift = 1/lift
    point%b(:m, :m, a) = metric
    if (is_global) point%b(:m, :m, a) = inverse
    point%b(1, :m, a) = lift*point%b(1, :m, a)
    point%b(:m, 1, a) = lift*point%b(:m, 1, a)
  end subroutine set_blocks

  !> The matrix with ones on its diagonal.
  pure function identity(m) result(one)
    integer, intent(in) :: m
    real(wp) :: one(m, m)
    integer :: i

    one = 0
    do i = 1, m
      one(i, i) = 1
    end do
  end function identity

  !> Direction towards the point whose complementarity is `centre` times the present one; `dx_second` and `ds_second` give the
  !! second-order terms.
  subroutine direction(scaled, system, point, centre, dx_second, ds_second, dx, ds)
    type(matrix_problem_t), intent(in) :: scaled
    class(cone_system_t), intent(inout) :: system
    type(point_t), intent(in) :: point
    real(wp), intent(in) :: centre
    real(wp), intent(in), contiguous :: dx_second(:, :), ds_second(:, :)
    real(wp), intent(out), contiguous :: dx(:, :), ds(:, :)
    real(wp), allocatable :: g(:, :), dr(:, :), du(:, :)
    real(wp) :: wanted(scaled%d)
    integer :: a, m

    allocate (g, dr, du, mold=point%x)
    g = 0
    do a = 1, scaled%n
      m = point%m(a)
      associate (w => point%w(:m, a), beta => point%beta(a), lambda => point%lambda(:m, a))
        wanted(:m) = -product_of(lambda, lambda) &
                     - product_of(scaled_by(w, beta, dx_second(:m, a), .false.), scaled_by(w, beta, ds_second(:m, a), .true.))
        wanted(1) = wanted(1) + centre*point%tau
        g(:m, a) = scaled_by(w, beta, quotient_of(lambda, wanted(:m)), .false.) - point%missing(:m, a)
        g(1, a) = point%lift(a)*g(1, a)
      end associate
    end do
    call system%solve(scaled, g, dr, du)
    dx = 0
    ds = 0
    do a = 1, scaled%n
      m = point%m(a)
      dx(:m, a) = raised(dr(:m, a), point%lift(a))
      ds(:m, a) = raised(matmul(point%a(:m, :m, a), du(:m, a)), 1/point%lift(a)) + point%missing(:m, a)
    end do
  end subroutine direction

  !> Longest step that keeps all cones.
  real(wp) function longest(system, point, dx, ds) result(length)
    class(cone_system_t), intent(inout) :: system
    type(point_t), intent(in) :: point
    real(wp), intent(in), contiguous :: dx(:, :), ds(:, :)
    integer :: a, m

    length = huge(length)
    do a = 1, size(dx, 2)
      m = point%m(a)
      length = min(length, longest_step(point%x(:m, a), dx(:m, a)), longest_step(point%s(:m, a), ds(:m, a)))
    end do
    call system%find_least(length)
  end function longest

  !> Go the step, or as much of it as keeps the contacts centred.
  subroutine move(scaled, system, point, dx, ds, length)
    type(matrix_problem_t), intent(in) :: scaled
    class(cone_system_t), intent(inout) :: system
    type(point_t), intent(inout) :: point
    real(wp), intent(in), contiguous :: dx(:, :), ds(:, :)
    real(wp), intent(inout) :: length
    real(wp), allocatable :: x(:, :), s(:, :)
    real(wp) :: tau, centred
    integer :: i

    do i = 1, 40
      x = point%x + length*dx
      s = point%s + length*ds
      tau = average(system, point, x, s)
      centred = merge(1.0_wp, 0.0_wp, is_centred(point%m, x, s, tau))
      call system%find_least(centred)
      if (centred > 0) exit
      length = 0.8_wp*length
    end do
    point%x = x
    point%s = s
    call set_impulses(scaled, system, point)
  end subroutine move

  !> Is every contact inside its cones, and none far ahead of the others?
  pure logical function is_centred(m, x, s, tau)
    integer, intent(in) :: m(:)
    real(wp), intent(in), contiguous :: x(:, :), s(:, :)
    real(wp), intent(in) :: tau
    real(wp) :: least, dets(2)
    integer :: a

    least = (centrality*tau)**2
    is_centred = .false.
    do a = 1, size(m)
      dets = [determinant(x(:m(a), a)), determinant(s(:m(a), a))]
      if (.not. (x(1, a) > 0 .and. s(1, a) > 0 .and. dets(1) > 0 .and. dets(2) > 0)) return
      if (dets(1)*dets(2) < least) return
    end do
    is_centred = .true.
  end function is_centred
end module sg_interior_point_step
