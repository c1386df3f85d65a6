!> What the error measures need of contacts in space: the natural map of vectors in the world's axes (doc/theory/errors.md).
module sg_residuals_space
  use sg_error_records, only: have_records, sum_records
  use sg_kinds, only: wp
  use sg_law_violation, only: largest_bound, law_violation, next_chunk, space_bounds
  use sg_natural_map, only: chunk, space_squares
  use sg_problem, only: problem_t
  use sg_records, only: ball_bias_x, ball_bias_y, ball_bias_z, ball_friction, ball_frictional, ball_frictionless, &
                        ball_frictionless_bias, ball_frictionless_inverse_wnn, ball_inverse_wnn, ball_inverse_wtt, ball_spin_x, &
                        ball_spin_y, ball_spin_z, body_length, friction_place, least_active, least_linear, least_normal, normal_x, &
                        normal_y, normal_z, record_length, solid_arm_ax, solid_arm_ay, solid_arm_az, solid_arm_cx, solid_arm_cy, &
                        solid_arm_cz, solid_bias_x, solid_bias_y, solid_bias_z, solid_bonded, solid_cohesion, solid_compliance_n, &
                        solid_compliance_t, solid_friction, solid_frictional, solid_frictionless, solid_frictionless_bias, &
                        solid_frictionless_inverse_wnn, solid_frictionless_moment_ax, solid_frictionless_moment_ay, &
                        solid_frictionless_moment_az, solid_frictionless_moment_cx, solid_frictionless_moment_cy, &
                        solid_frictionless_moment_cz, solid_inverse_lambda, solid_law, solid_slip_x, solid_slip_z, solid_spin_x, &
                        solid_spin_y, solid_spin_z, solid_stiffness_n, solid_stiffness_t, velocity_x, velocity_y, velocity_z
  implicit none
  private
  public :: add_normal_parts, add_space_contacts, find_worst_in_space, keep_bonds, note_closing, n_error_sums

  !> Sums that the errors of a problem are made of
  integer, parameter :: n_error_sums = 6

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
    !> 1 where a linear law asks u = 0, else 0; of laws that are linear along the normal alone u_t is r_t/rho
    real(wp) :: linear(chunk) = 0
    !> Square of the impulse that a bond adds [N2 s2]
    real(wp) :: bond(chunk) = 0
  end type chunk_t

contains

  !> Add all contacts to sums of which each place of a chunk has its own: squares of the map with rho = 1 (where wanted), of the map
  !! with rho_a, of its velocity error, of r, and of u; and the contacts that carry an impulse.
  pure subroutine add_space_contacts(problem, with_e1, lane, all_squares, closing, bounds)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    logical, intent(in) :: with_e1 !! is the map with rho = 1 wanted too?
    real(wp), intent(inout) :: lane(chunk, n_error_sums) !! sums to add to
    real(wp), allocatable, intent(inout), optional :: all_squares(:) !! squares of the map with rho_a, shape (contacts)
    real(wp), allocatable, intent(inout), optional :: closing(:) !! what determines the active set (sg_active_set), shape (contacts)
    real(wp), allocatable, intent(inout), optional :: bounds(:) !! bound of each chunk, for `find_worst_in_space`; set where e1 is
    type(chunk_t) :: a
    real(wp) :: squares(chunk), inverse(chunk), carried(chunk)
    integer :: first, n, i
    logical :: has_tangent, has_bounds, has_records, is_done

    has_tangent = friction_place(problem%kind) > 0
    has_bounds = with_e1 .and. present(bounds)
    has_records = have_records(problem%kind) .and. .not. present(all_squares)
    do first = 1, problem%n_contacts, chunk
      if (has_records) then
        call sum_records(problem, first, with_e1, lane, is_done, closing, bounds)
        if (is_done) cycle
      end if
      call gather(problem, first, a)
      n = a%n
      if (present(closing)) then
        carried = abs(a%r(:, 1)) + abs(a%r(:, 2)) + abs(a%r(:, 3)) + a%linear
        call note_closing(n, a%normal(:, 1)*a%u(:, 1) + a%normal(:, 2)*a%u(:, 2) + a%normal(:, 3)*a%u(:, 3), carried, a%rho, &
                          closing(first:first + n - 1))
        if (problem%kind == solid_bonded) &
          call keep_bonds(n, problem%record(solid_stiffness_n:solid_stiffness_t, first:first + n - 1), carried, &
                          closing(first:first + n - 1))
      end if
      if (has_bounds) then
        call space_bounds(n, a%normal, a%u, a%r, a%friction, a%rho, a%linear, squares)
        bounds((first + chunk - 1)/chunk) = largest_bound(squares(:n))
      end if
      if (.not. has_tangent) then
        call add_normal_parts(n, a%u(:, 1), a%r(:, 1), a%rho, with_e1, lane, squares)
        if (present(all_squares)) all_squares(first:first + n - 1) = squares(:n)
        cycle
      end if
      if (with_e1) then
        inverse = merge(1.0_wp, 0.0_wp, a%rho > 0)
        call space_squares(n, a%normal, a%u, a%r, a%friction, inverse, a%linear, squares)
        lane(:n, 1) = lane(:n, 1) + squares(:n)
      end if
      call space_squares(n, a%normal, a%u, a%r, a%friction, a%rho, a%linear, squares)
      if (present(all_squares)) all_squares(first:first + n - 1) = squares(:n)
      inverse = merge(1.0_wp, 0.0_wp, a%rho > 0)/max(a%rho, tiny(1.0_wp)**0.25_wp)
      do i = 1, n
        lane(i, 2) = lane(i, 2) + squares(i)
        lane(i, 3) = lane(i, 3) + squares(i)*inverse(i)**2
        lane(i, 4) = lane(i, 4) + a%r(i, 1)**2 + a%r(i, 2)**2 + a%r(i, 3)**2
        lane(i, 5) = lane(i, 5) + a%u(i, 1)**2 + a%u(i, 2)**2 + a%u(i, 3)**2
        lane(i, 6) = lane(i, 6) + merge(1.0_wp, 0.0_wp, abs(a%r(i, 1)) + abs(a%r(i, 2)) + abs(a%r(i, 3)) > 0)
      end do
      if (problem%kind == solid_bonded) lane(:n, 4) = lane(:n, 4) + a%bond(:n)
    end do
  end subroutine add_space_contacts

  !> The contact that breaks its law by the largest velocity.
  pure subroutine find_worst_in_space(problem, contact, speed, chunk_bounds)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    integer, intent(inout) :: contact !! number of that contact; stays where all obey
    real(wp), intent(inout) :: speed !! its velocity [m/s]
    real(wp), allocatable, intent(in), optional :: chunk_bounds(:) !! of `add_space_contacts`, where nothing has changed since
    type(chunk_t) :: a
    real(wp), allocatable :: left(:)
    real(wp) :: broken, bounds(chunk)
    integer :: turn, n_chunks, first, i
    logical :: has_tangent

    has_tangent = friction_place(problem%kind) > 0
    n_chunks = (problem%n_contacts + chunk - 1)/chunk
    if (present(chunk_bounds)) left = chunk_bounds(:n_chunks)
    do turn = 1, n_chunks
      call next_chunk(turn, speed, left, first)
      if (first == 0) exit
      call gather(problem, first, a)
      call space_bounds(a%n, a%normal, a%u, a%r, a%friction, a%rho, a%linear, bounds)
      do i = 1, a%n
        if (bounds(i) <= speed**2) cycle
        if (has_tangent) then
          broken = law_violation(split(a%normal(i, :), a%u(i, :)), split(a%normal(i, :), a%r(i, :)), a%friction(i), a%rho(i), &
                                 a%linear(i) > 0)
        else
          broken = law_violation(a%u(i, :1), a%r(i, :1), 0.0_wp, a%rho(i), .false.)
        end if
        if (.not. broken > speed) cycle
        contact = first + i - 1
        speed = broken
      end do
    end do
  end subroutine find_worst_in_space

  !> Normal component of a vector of the world, and what is across the normal.
  pure function split(normal, x) result(parts)
    real(wp), intent(in) :: normal(3), x(3)
    real(wp) :: parts(4)

    parts(1) = dot_product(normal, x)
    parts(2:) = x - parts(1)*normal
  end function split

  !> The same for a chunk of contacts that have a normal part alone, in the plane or in space: the map is r - max(0, r - rho u).
  pure subroutine add_normal_parts(n, u, r, rho, with_e1, lane, squares)
    integer, intent(in) :: n !! contacts of the chunk
    real(wp), intent(in) :: u(chunk) !! normal velocity with bias [m/s]
    real(wp), intent(in) :: r(chunk) !! normal impulse [N s]
    real(wp), intent(in) :: rho(chunk) !! 1/W_nn [kg]; zero where the contact takes no part
    logical, intent(in) :: with_e1 !! is the map with rho = 1 wanted too?
    real(wp), intent(inout) :: lane(chunk, n_error_sums) !! sums to add to
    real(wp), intent(out) :: squares(chunk) !! of the map with rho
    integer :: i

    if (with_e1) then
      do i = 1, n
        lane(i, 1) = lane(i, 1) + (r(i) - max(0.0_wp, r(i) - merge(1.0_wp, 0.0_wp, rho(i) > 0)*u(i)))**2
      end do
    end if
    do i = 1, n
      squares(i) = (r(i) - max(0.0_wp, r(i) - rho(i)*u(i)))**2
      lane(i, 2) = lane(i, 2) + squares(i)
      lane(i, 3) = lane(i, 3) + merge(squares(i), 0.0_wp, rho(i) > 0)/merge(rho(i), 1.0_wp, rho(i) > 0)**2
      lane(i, 4) = lane(i, 4) + r(i)**2
      lane(i, 5) = lane(i, 5) + u(i)**2
      lane(i, 6) = lane(i, 6) + merge(1.0_wp, 0.0_wp, abs(r(i)) > 0)
    end do
  end subroutine add_normal_parts

  !> Note what determines the active set among the contacts of a chunk: how fast each parts, the lowest number where it carries an
  !! impulse, the highest where it takes no part.
  pure subroutine note_closing(n, u_n, carried, rho, closing)
    integer, intent(in) :: n !! contacts
    real(wp), intent(in) :: u_n(chunk) !! normal velocity [m/s]
    real(wp), intent(in) :: carried(chunk) !! size of the impulse [N s]
    real(wp), intent(in) :: rho(chunk) !! zero where the contact takes no part
    real(wp), intent(inout) :: closing(n) !! what is noted
    integer :: i

    do i = 1, n
      closing(i) = merge(merge(-huge(1.0_wp), u_n(i), carried(i) > 0), huge(1.0_wp), rho(i) > 0)
    end do
  end subroutine note_closing

  !> Note that sweeps are to visit all contacts with a bond, which pulls on open ones too and between bodies that nothing moves;
  !! there also those that carry what a bond left that has broken since.
  pure subroutine keep_bonds(n, stiffness, carried, closing)
    integer, intent(in) :: n !! contacts of the chunk
    real(wp), intent(in) :: stiffness(2, n) !! of the bonds [kg]
    real(wp), intent(in) :: carried(chunk) !! size of the impulse without that of the bond [N s]
    real(wp), intent(inout) :: closing(n) !! what `note_closing` noted

    where (maxval(stiffness, 1) > 0 .or. carried(:n) > 0) closing = -huge(1.0_wp)
  end subroutine keep_bonds

  !> Gather a chunk of contacts, by the kernel of the problem's kind.
  pure subroutine gather(problem, first, a)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: first
    type(chunk_t), intent(inout) :: a
    integer :: last

    a%n = min(chunk, problem%n_contacts - first + 1)
    last = first + a%n - 1
    associate (n => a%n, pair => problem%pair(:, first:last), record => problem%record(:, first:last), &
               r => problem%impulse(:, first:last))
      select case (problem%kind)
      case (ball_frictionless)
        call gather_slippery_balls(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (ball_frictional)
        call gather_balls(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (solid_frictionless)
        call gather_slippery_solids(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (solid_frictional)
        call gather_solids(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (solid_bonded)
        call gather_solids(n, pair, record(:record_length(solid_frictional), :), r, problem%n_bodies, problem%body, a)
        call add_bonds(n, record, a)
      end select
    end associate
  end subroutine gather

  !> Data of balls without friction.
  pure subroutine gather_slippery_balls(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(ball_frictionless), n), r(1, n), body(body_length(ball_frictionless), n_bodies)
    type(chunk_t), intent(inout) :: a
    integer :: i

    ! Loads one by one are faster than the processor's gathers.
    !GCC$ novector
    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        a%u(i, 1) = record(normal_x, i)*(body(velocity_x, c) - body(velocity_x, d)) &
                    + record(normal_y, i)*(body(velocity_y, c) - body(velocity_y, d)) &
                    + record(normal_z, i)*(body(velocity_z, c) - body(velocity_z, d)) + record(ball_frictionless_bias, i)
      end associate
      a%r(i, 1) = r(1, i)
      a%rho(i) = record(ball_frictionless_inverse_wnn, i)
      a%normal(i, 1) = 1
    end do
  end subroutine gather_slippery_balls

  !> Data of balls with friction.
  pure subroutine gather_balls(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(ball_frictional), n), r(3, n), body(body_length(ball_frictional), n_bodies)
    type(chunk_t), intent(inout) :: a
    real(wp) :: sx, sy, sz
    integer :: i

    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        sx = body(ball_spin_x, c) + body(ball_spin_x, d)
        sy = body(ball_spin_y, c) + body(ball_spin_y, d)
        sz = body(ball_spin_z, c) + body(ball_spin_z, d)
        a%u(i, 1) = body(velocity_x, c) - body(velocity_x, d) + record(ball_bias_x, i) - sy*record(normal_z, i) &
                    + sz*record(normal_y, i)
        a%u(i, 2) = body(velocity_y, c) - body(velocity_y, d) + record(ball_bias_y, i) - sz*record(normal_x, i) &
                    + sx*record(normal_z, i)
        a%u(i, 3) = body(velocity_z, c) - body(velocity_z, d) + record(ball_bias_z, i) - sx*record(normal_y, i) &
                    + sy*record(normal_x, i)
      end associate
      a%normal(i, 1) = record(normal_x, i)
      a%normal(i, 2) = record(normal_y, i)
      a%normal(i, 3) = record(normal_z, i)
      a%r(i, 1) = r(1, i)
      a%r(i, 2) = r(2, i)
      a%r(i, 3) = r(3, i)
      a%friction(i) = record(ball_friction, i)
      a%rho(i) = merge(min(record(ball_inverse_wnn, i), record(ball_inverse_wtt, i)), record(ball_inverse_wnn, i), &
                 record(ball_friction, i) > 0)
    end do
  end subroutine gather_balls

  !> Data of solids without friction.
  pure subroutine gather_slippery_solids(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(solid_frictionless), n), r(1, n), body(body_length(solid_frictionless), n_bodies)
    type(chunk_t), intent(inout) :: a
    integer :: i

    ! Loads one by one are faster than the processor's gathers.
    !GCC$ novector
    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        a%u(i, 1) = record(normal_x, i)*(body(velocity_x, c) - body(velocity_x, d)) &
                    + record(normal_y, i)*(body(velocity_y, c) - body(velocity_y, d)) &
                    + record(normal_z, i)*(body(velocity_z, c) - body(velocity_z, d)) &
                    + record(solid_frictionless_moment_cx, i)*body(solid_spin_x, c) &
                    + record(solid_frictionless_moment_cy, i)*body(solid_spin_y, c) &
                    + record(solid_frictionless_moment_cz, i)*body(solid_spin_z, c) &
                    - record(solid_frictionless_moment_ax, i)*body(solid_spin_x, d) &
                    - record(solid_frictionless_moment_ay, i)*body(solid_spin_y, d) &
                    - record(solid_frictionless_moment_az, i)*body(solid_spin_z, d) + record(solid_frictionless_bias, i)
      end associate
      a%r(i, 1) = r(1, i)
      a%rho(i) = record(solid_frictionless_inverse_wnn, i)
      a%normal(i, 1) = 1
    end do
  end subroutine gather_slippery_solids

  !> Take the impulses of cohesive zones out of those of contacts.
  pure subroutine add_bonds(n, record, a)
    integer, intent(in) :: n
    real(wp), intent(in) :: record(record_length(solid_bonded), n)
    type(chunk_t), intent(inout) :: a
    real(wp) :: u_n, bond(3)
    integer :: i

    do i = 1, n
      a%bond(i) = 0
      if (.not. max(record(solid_stiffness_n, i), record(solid_stiffness_t, i)) > 0) cycle
      u_n = dot_product(a%normal(i, :), a%u(i, :))
      bond = record(solid_stiffness_t, i)*(a%u(i, :) - u_n*a%normal(i, :) + record(solid_slip_x:solid_slip_z, i))
      ! Bodies that nothing moves may come closer: their bond does not push.
      if (.not. a%rho(i) > 0) u_n = max(0.0_wp, u_n)
      bond = bond + record(solid_stiffness_n, i)*u_n*a%normal(i, :)
      a%r(i, :) = a%r(i, :) + bond
      ! What a bond between bodies that nothing moves carries, however much, is no measure of the others.
      if (a%rho(i) > 0) a%bond(i) = sum(bond**2)
    end do
  end subroutine add_bonds

  !> Data of solids with friction and any law.
  pure subroutine gather_solids(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(solid_frictional), n), r(3, n), body(body_length(solid_frictional), n_bodies)
    type(chunk_t), intent(inout) :: a
    real(wp) :: yielding, cohesion
    integer :: i

    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        yielding = (record(solid_compliance_n, i) - record(solid_compliance_t, i))*(record(normal_x, i)*r(1, i) &
                   + record(normal_y, i)*r(2, i) + record(normal_z, i)*r(3, i))
        a%u(i, 1) = body(velocity_x, c) - body(velocity_x, d) + body(solid_spin_y, c)*record(solid_arm_cz, i) &
                    - body(solid_spin_z, c)*record(solid_arm_cy, i) - body(solid_spin_y, d)*record(solid_arm_az, i) &
                    + body(solid_spin_z, d)*record(solid_arm_ay, i) + record(solid_bias_x, i) &
                    + record(solid_compliance_t, i)*r(1, i) + yielding*record(normal_x, i)
        a%u(i, 2) = body(velocity_y, c) - body(velocity_y, d) + body(solid_spin_z, c)*record(solid_arm_cx, i) &
                    - body(solid_spin_x, c)*record(solid_arm_cz, i) - body(solid_spin_z, d)*record(solid_arm_ax, i) &
                    + body(solid_spin_x, d)*record(solid_arm_az, i) + record(solid_bias_y, i) &
                    + record(solid_compliance_t, i)*r(2, i) + yielding*record(normal_y, i)
        a%u(i, 3) = body(velocity_z, c) - body(velocity_z, d) + body(solid_spin_x, c)*record(solid_arm_cy, i) &
                    - body(solid_spin_y, c)*record(solid_arm_cx, i) - body(solid_spin_x, d)*record(solid_arm_ay, i) &
                    + body(solid_spin_y, d)*record(solid_arm_ax, i) + record(solid_bias_z, i) &
                    + record(solid_compliance_t, i)*r(3, i) + yielding*record(normal_z, i)
      end associate
      cohesion = merge(record(solid_cohesion, i), 0.0_wp, record(solid_law, i) > least_active)
      a%normal(i, 1) = record(normal_x, i)
      a%normal(i, 2) = record(normal_y, i)
      a%normal(i, 3) = record(normal_z, i)
      a%r(i, 1) = r(1, i) + cohesion*record(normal_x, i)
      a%r(i, 2) = r(2, i) + cohesion*record(normal_y, i)
      a%r(i, 3) = r(3, i) + cohesion*record(normal_z, i)
      a%friction(i) = record(solid_friction, i)
      a%rho(i) = record(solid_inverse_lambda, i)
      a%linear(i) = merge(1.0_wp, 0.0_wp, record(solid_law, i) > least_linear)
    end do
    do i = 1, n
      if (.not. record(solid_law, i) > least_normal) cycle
      call take_impulse_across(record(normal_x:normal_z, i), r(:, i), record(solid_inverse_lambda, i), a%u(i, :))
    end do
  end subroutine gather_solids

  !> Put what an impulse has across the normal, over rho, in place of what the velocity has there.
  pure subroutine take_impulse_across(normal, impulse, rho, u)
    real(wp), intent(in) :: normal(3), impulse(3), rho
    real(wp), intent(inout) :: u(3)

    if (.not. rho > 0) return
    u = dot_product(u, normal)*normal + (impulse - dot_product(impulse, normal)*normal)/rho
  end subroutine take_impulse_across
end module sg_residuals_space
