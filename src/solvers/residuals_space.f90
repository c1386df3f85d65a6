!> What the error measures need of contacts in space: the natural map of vectors in the world's axes (doc/theory/errors.md).
module sg_residuals_space
  use sg_compact_space, only: space_velocity
  use sg_kinds, only: wp
  use sg_problem, only: ball_frictional, ball_frictionless, problem_t, solid_frictional, solid_frictionless
  implicit none
  private
  public :: add_normal_parts, add_space_contacts, note_space_contacts, note, chunk

  !> Contacts gathered at a time: their data stay in the first cache, and the map runs over them in vector registers
  integer, parameter :: chunk = 128

  !> A chunk of contacts; where nothing rubs, normal parts stand on the first axis
  type :: chunk_t
    !> Number of contacts
    integer :: n = 0
    !> Normal
    real(wp) :: normal(chunk, 3) = 0
    !> Relative velocity with bias and compliance [m/s], impulse with cohesion [N s]
    real(wp) :: u(chunk, 3) = 0, r(chunk, 3) = 0
    !> Coulomb friction, and 1/lambda_max(W_aa) [kg]: zero where the contact takes no part
    real(wp) :: friction(chunk) = 0, rho(chunk) = 0
    !> 1 where a linear law asks u = 0, else 0
    real(wp) :: linear(chunk) = 0
  end type chunk_t

contains

  !> Add all contacts to the sums: squares of the map with rho = 1 (where wanted), of the map with rho_a, of its velocity
  !! error, of r, and of u.
  pure subroutine add_space_contacts(problem, with_e1, sums, active, all_squares)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    logical, intent(in) :: with_e1 !! is the map with rho = 1 wanted too?
    real(wp), intent(inout) :: sums(5) !! sums to add to
    integer, intent(inout) :: active !! contacts that carry an impulse
    real(wp), intent(inout), optional :: all_squares(:) !! squares of the map with rho_a, shape (contacts)
    type(chunk_t) :: a
    real(wp) :: squares(chunk), inverse(chunk)
    integer :: first, n
    logical :: has_tangent

    has_tangent = any(problem%kind == [ball_frictional, solid_frictional])
    do first = 1, problem%n_contacts, chunk
      call gather(problem, first, a)
      n = a%n
      if (.not. has_tangent) then
        call add_normal_parts(n, a%u(:, 1), a%r(:, 1), a%rho, with_e1, sums, active, squares)
        if (present(all_squares)) all_squares(first:first + n - 1) = squares(:n)
        cycle
      end if
      if (with_e1) then
        inverse = merge(1.0_wp, 0.0_wp, a%rho > 0)
        call map_squares(n, a%normal, a%u, a%r, a%friction, inverse, a%linear, squares)
        sums(1) = sums(1) + sum(squares(:n))
      end if
      call map_squares(n, a%normal, a%u, a%r, a%friction, a%rho, a%linear, squares)
      sums(2) = sums(2) + sum(squares(:n))
      if (present(all_squares)) all_squares(first:first + n - 1) = squares(:n)
      inverse = merge(1.0_wp, 0.0_wp, a%rho > 0)/max(a%rho, tiny(1.0_wp)**0.25_wp)
      sums(3) = sums(3) + sum(squares(:n)*inverse(:n)**2)
      sums(4) = sums(4) + sum(a%r(:n, :)**2)
      sums(5) = sums(5) + sum(a%u(:n, :)**2)
      active = active + count(abs(a%r(:n, 1)) + abs(a%r(:n, 2)) + abs(a%r(:n, 3)) > 0)
    end do
  end subroutine add_space_contacts

  !> The same for a chunk of contacts that have a normal part alone, in the plane or in space: the map is r - max(0, r - rho u).
  pure subroutine add_normal_parts(n, u, r, rho, with_e1, sums, active, squares)
    integer, intent(in) :: n !! contacts of the chunk
    real(wp), intent(in) :: u(chunk) !! normal velocity with bias [m/s]
    real(wp), intent(in) :: r(chunk) !! normal impulse [N s]
    real(wp), intent(in) :: rho(chunk) !! 1/W_nn [kg]; zero where the contact takes no part
    logical, intent(in) :: with_e1 !! is the map with rho = 1 wanted too?
    real(wp), intent(inout) :: sums(5) !! sums to add to
    integer, intent(inout) :: active !! contacts that carry an impulse
    real(wp), intent(out) :: squares(chunk) !! of the map with rho
    real(wp) :: over(chunk)
    integer :: i

    if (with_e1) then
      do i = 1, n
        squares(i) = (r(i) - max(0.0_wp, r(i) - merge(1.0_wp, 0.0_wp, rho(i) > 0)*u(i)))**2
      end do
      sums(1) = sums(1) + sum(squares(:n))
    end if
    do i = 1, n
      squares(i) = (r(i) - max(0.0_wp, r(i) - rho(i)*u(i)))**2
      over(i) = merge(squares(i), 0.0_wp, rho(i) > 0)/merge(rho(i), 1.0_wp, rho(i) > 0)**2
    end do
    sums(2) = sums(2) + sum(squares(:n))
    sums(3) = sums(3) + sum(over(:n))
    sums(4) = sums(4) + sum(r(:n)**2)
    sums(5) = sums(5) + sum(u(:n)**2)
    active = active + count(abs(r(:n)) > 0)
  end subroutine add_normal_parts

  !> Squares of the natural map of a chunk: zero where impulse and velocity obey the law.
  pure subroutine map_squares(n, normal, u, r, friction, rho, linear, squares)
    integer, intent(in) :: n
    real(wp), intent(in) :: normal(chunk, 3), u(chunk, 3), r(chunk, 3), friction(chunk), rho(chunk), linear(chunk)
    real(wp), intent(out) :: squares(chunk)
    real(wp) :: u_n, r_n, x, tx, ty, tz, sx, sy, sz, slip, length, height, share, inside
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
      ! Its projection on Coulomb's cone: height along the normal, share of what is across.
      inside = merge(1.0_wp, 0.0_wp, x > 0 .and. length <= friction(i)*x)
      height = max(0.0_wp, (x + friction(i)*length)/(1 + friction(i)*friction(i)))
      ! Inside the cone this is 1, outside less.
      share = min(friction(i)*height, length)/max(length, tiny(1.0_wp))
      height = height + inside*(x - height)
      tx = r_n - height
      sx = r(i, 1) - r_n*normal(i, 1) - share*sx
      sy = r(i, 2) - r_n*normal(i, 2) - share*sy
      sz = r(i, 3) - r_n*normal(i, 3) - share*sz
      squares(i) = tx*tx + sx*sx + sy*sy + sz*sz
    end do
    if (any(linear(:n) > 0)) then
      where (linear(:n) > 0) squares(:n) = rho(:n)**2*(u(:n, 1)**2 + u(:n, 2)**2 + u(:n, 3)**2)
    end if
  end subroutine map_squares

  !> Note of all contacts whether they are to be visited: those that carry an impulse, and those that close, or part slower
  !! than a limit.
  pure subroutine note_space_contacts(problem, limit, is_wanted, visited, missed)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    real(wp), intent(in) :: limit !! normal velocity [m/s]
    logical, intent(inout) :: is_wanted(:) !! contacts visited so far, then those to visit, shape (contacts)
    integer, intent(inout) :: visited !! number of contacts to visit
    integer, intent(inout) :: missed !! how many of them were not visited so far
    type(chunk_t) :: a
    integer :: first, i
    logical :: is_slow

    do first = 1, problem%n_contacts, chunk
      call gather(problem, first, a)
      do i = 1, a%n
        is_slow = a%rho(i) > 0 .and. (abs(a%r(i, 1)) + abs(a%r(i, 2)) + abs(a%r(i, 3)) > 0 &
                  .or. a%normal(i, 1)*a%u(i, 1) + a%normal(i, 2)*a%u(i, 2) + a%normal(i, 3)*a%u(i, 3) <= limit)
        call note(is_slow, is_wanted(first + i - 1), visited, missed)
      end do
    end do
  end subroutine note_space_contacts

  !> Note whether a contact is to be visited, and whether it was not so far.
  pure subroutine note(is_slow, is_wanted, visited, missed)
    logical, intent(in) :: is_slow !! does it carry an impulse, close, or part slowly?
    logical, intent(inout) :: is_wanted !! was it visited so far; then whether it is to be
    integer, intent(inout) :: visited !! number of contacts to visit
    integer, intent(inout) :: missed !! how many of them were not visited so far

    if (is_slow) visited = visited + 1
    if (is_slow .and. .not. is_wanted) missed = missed + 1
    is_wanted = is_slow
  end subroutine note

  !> 1/lambda_max(W_aa) of a contact [kg].
  pure real(wp) function scale_of(kind, record) result(rho)
    integer, intent(in) :: kind
    real(wp), intent(in) :: record(:)

    select case (kind)
    case (ball_frictionless)
      rho = record(5)
    case (ball_frictional)
      rho = merge(min(record(7), record(8)), record(7), record(9) > 0)
    case (solid_frictionless)
      rho = record(11)
    case default
      rho = record(26)
    end select
  end function scale_of

  !> Gather a chunk of contacts.
  pure subroutine gather(problem, first, a)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: first
    type(chunk_t), intent(inout) :: a
    integer :: i, k

    a%n = min(chunk, problem%n_contacts - first + 1)
    if (problem%kind == ball_frictional) then
      associate (last => first + a%n - 1)
        call gather_balls(a%n, problem%pair(:, first:last), problem%record(:, first:last), problem%impulse(:, first:last), &
                          problem%n_bodies, problem%body, a)
      end associate
      return
    end if
    if (problem%kind == ball_frictionless) then
      associate (last => first + a%n - 1)
        call gather_slippery_balls(a%n, problem%pair(:, first:last), problem%record(:, first:last), &
                                   problem%impulse(:, first:last), problem%n_bodies, problem%body, a)
      end associate
      return
    end if
    do i = 1, a%n
      k = first + i - 1
      a%u(i, :) = space_velocity(problem, k)
      associate (record => problem%record(:, k), r => problem%impulse(:, k))
        a%rho(i) = scale_of(problem%kind, record)
        if (problem%kind == solid_frictional) then
          a%normal(i, :) = record(1:3)
          a%r(i, :) = r + merge(record(22), 0.0_wp, record(25) > 0.5_wp)*record(1:3)
          a%friction(i) = record(21)
          a%linear(i) = merge(1.0_wp, 0.0_wp, record(25) > 1.5_wp)
        else
          a%normal(i, :) = [1.0_wp, 0.0_wp, 0.0_wp]
          a%r(i, :) = [r(1), 0.0_wp, 0.0_wp]
        end if
      end associate
    end do
  end subroutine gather

  !> The same for balls without friction.
  pure subroutine gather_slippery_balls(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(5, n), r(1, n), body(6, n_bodies)
    type(chunk_t), intent(inout) :: a
    integer :: i

    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        a%u(i, 1) = record(1, i)*(body(1, c) - body(1, d)) + record(2, i)*(body(2, c) - body(2, d)) &
                    + record(3, i)*(body(3, c) - body(3, d)) + record(4, i)
      end associate
      a%r(i, 1) = r(1, i)
      a%rho(i) = record(5, i)
      a%normal(i, 1) = 1
    end do
  end subroutine gather_slippery_balls

  !> The same for balls with friction.
  pure subroutine gather_balls(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(9, n), r(3, n), body(8, n_bodies)
    type(chunk_t), intent(inout) :: a
    real(wp) :: sx, sy, sz
    integer :: i

    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        sx = body(4, c) + body(4, d)
        sy = body(5, c) + body(5, d)
        sz = body(6, c) + body(6, d)
        a%u(i, 1) = body(1, c) - body(1, d) + record(4, i) - sy*record(3, i) + sz*record(2, i)
        a%u(i, 2) = body(2, c) - body(2, d) + record(5, i) - sz*record(1, i) + sx*record(3, i)
        a%u(i, 3) = body(3, c) - body(3, d) + record(6, i) - sx*record(2, i) + sy*record(1, i)
      end associate
      a%normal(i, 1) = record(1, i)
      a%normal(i, 2) = record(2, i)
      a%normal(i, 3) = record(3, i)
      a%r(i, 1) = r(1, i)
      a%r(i, 2) = r(2, i)
      a%r(i, 3) = r(3, i)
      a%friction(i) = record(9, i)
      a%rho(i) = merge(min(record(7, i), record(8, i)), record(7, i), record(9, i) > 0)
    end do
  end subroutine gather_balls
end module sg_residuals_space
