!> Errors of a contact problem's solution, for any kind of problem and any solver (doc/theory/errors.md).
!!
!! All rest on the natural map F_a = r_a - P_K(r_a - rho (u_a + g(u_a))) of De Saxce's form, which vanishes exactly at
!! solutions: e1 and e2 with rho = 1, e8 and the violation with rho_a = 1/lambda_max(W_aa), free of units.
module sg_residuals
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sg_error_records, only: have_records, sum_records
  use sg_kinds, only: wp
  use sg_law_violation, only: largest_bound, law_violation, next_chunk, plane_bounds
  use sg_natural_map, only: chunk, plane_squares
  use sg_problem, only: problem_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_bonded, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, &
                        arm_frictional, arm_frictionless, arm_frictionless_bias, arm_frictionless_inverse_wnn, &
                        arm_frictionless_moment_a, arm_frictionless_moment_c, arm_law, arm_moment_na, arm_moment_nc, &
                        arm_moment_ta, arm_moment_tc, arm_slip, arm_spin, arm_stiffness_n, arm_stiffness_t, arm_wnn, arm_wnt, &
                        arm_wtt, body_length, friction_place, has_moments, is_in_space, least_active, least_linear, least_normal, &
                        normal_x, normal_y, record_length, round_bias_n, round_bias_t, round_friction, round_frictional, &
                        round_frictionless, round_frictionless_bias, round_frictionless_inverse_wnn, round_inverse_wnn, &
                        round_inverse_wtt, round_spin, velocity_x, velocity_y
  use sg_report, only: ratio, report_t
  use sg_residuals_rolling, only: add_rolling_contacts, find_worst_rolling
  use sg_residuals_space, only: add_normal_parts, add_space_contacts, find_worst_in_space, keep_bonds, n_error_sums, note_closing
  implicit none
  private
  public :: find_worst, measure_errors, sum_errors, set_errors, n_error_sums

  !> What the natural map needs of a chunk of contacts
  type :: chunk_t
    !> Number of contacts
    integer :: n = 0
    !> Relative velocity with bias and compliance [m/s]
    real(wp) :: u_n(chunk) = 0, u_t(chunk) = 0
    !> Impulse, cohesion added [N s]
    real(wp) :: r_n(chunk) = 0, r_t(chunk) = 0
    !> Coulomb friction
    real(wp) :: friction(chunk) = 0
    !> 1/lambda_max(W_aa) [kg]; zero where the contact takes no part
    real(wp) :: rho(chunk) = 0
    !> 1 where a linear law asks u = 0, else 0; of laws that are linear along the normal alone u_t is r_t/rho
    real(wp) :: linear(chunk) = 0
    !> Impulse that a bond adds [N s]
    real(wp) :: bond_n(chunk) = 0, bond_t(chunk) = 0
  end type chunk_t

  interface
    !> Data of contacts with any arms and any law, four at a time (sweep_arm_lanes.cpp).
    pure subroutine gather_arms(n, pair, record, r, body, u_n, u_t, r_n, r_t, friction, w_nn, w_nt, w_tt, law) &
      bind(c, name='sg_gather_arms')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n !! a multiple of four
      integer(c_int), intent(in) :: pair(*)
      real(c_double), intent(in) :: record(*), r(*), body(*)
      real(c_double), intent(inout) :: u_n(*), u_t(*), r_n(*), r_t(*), friction(*), w_nn(*), w_nt(*), w_tt(*), law(*)
    end subroutine gather_arms
  end interface

contains

  !> Fill the errors of a report from the impulses and velocities of a problem. Optional lists are allocatable since absent ones of
  !! assumed shape, handed on, have the compiler compute with unset strides.
  pure subroutine measure_errors(problem, report, with_e1, closing)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    type(report_t), intent(inout) :: report !! errors and active contacts are set
    logical, intent(in) :: with_e1 !! measure e1 and e2 too, which take a map of their own
    real(wp), allocatable, intent(inout), optional :: closing(:) !! what determines the active set (sg_active_set), shape (contacts)
    real(wp) :: sums(n_error_sums)

    call sum_errors(problem, with_e1, sums, closing=closing)
    call set_errors(sums, problem%n_contacts, problem%free_norm, problem%velocity_scale, with_e1, report)
  end subroutine measure_errors

  !> Sums over the contacts of a problem that make its errors: squares of the map with rho = 1 (where wanted), of the map
  !! with rho_a, of its velocity error, of r with what bonds add, and of u; and the number of contacts that carry an impulse.
  pure subroutine sum_errors(problem, with_e1, sums, squares, closing, bounds)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    logical, intent(in) :: with_e1 !! sum the first one too, which takes a map of its own
    real(wp), intent(out) :: sums(n_error_sums) !! the sums
    real(wp), allocatable, intent(inout), optional :: squares(:) !! squares of the map with rho_a one by one, shape (contacts)
    real(wp), allocatable, intent(inout), optional :: closing(:) !! what determines the active set (sg_active_set), shape (contacts)
    real(wp), allocatable, intent(inout), optional :: bounds(:) !! bounds of chunks, for `find_worst`; set where e1 is
    type(chunk_t) :: a
    real(wp) :: lane(chunk, n_error_sums), f8(chunk), carried(chunk)
    integer :: first, i
    logical :: has_tangent, has_bounds, has_records, is_done

    lane = 0
    has_bounds = with_e1 .and. present(bounds)
    if (has_bounds) call fit_bounds(bounds, problem%n_contacts)
    if (has_moments(problem%kind)) then
      if (has_bounds) bounds = huge(1.0_wp)
      sums = 0
      call add_rolling_contacts(problem, with_e1, sums, squares, closing)
      return
    end if
    has_records = have_records(problem%kind) .and. .not. present(squares)
    if (is_in_space(problem%kind)) call add_space_contacts(problem, with_e1, lane, squares, closing, bounds)
    has_tangent = friction_place(problem%kind) > 0
    do first = 1, merge(0, problem%n_contacts, is_in_space(problem%kind)), chunk
      if (has_records) then
        call sum_records(problem, first, with_e1, lane, is_done, closing, bounds)
        if (is_done) cycle
      end if
      call gather(problem, first, a)
      if (has_tangent) then
        call add_chunk(a%n, a%u_n, a%u_t, a%r_n, a%r_t, a%friction, a%rho, a%linear, with_e1, lane, f8)
      else
        call add_normal_parts(a%n, a%u_n, a%r_n, a%rho, with_e1, lane, f8)
      end if
      ! What a bond between bodies that nothing moves carries, however much, is no measure of the others.
      if (problem%kind == arm_bonded) &
        lane(:a%n, 4) = lane(:a%n, 4) + merge(a%bond_n(:a%n)**2 + a%bond_t(:a%n)**2, 0.0_wp, a%rho(:a%n) > 0)
      if (present(squares)) squares(first:first + a%n - 1) = f8(:a%n)
      if (has_bounds) then
        call plane_bounds(a%n, a%u_n, a%u_t, a%r_n, a%r_t, a%friction, a%rho, a%linear, f8)
        bounds((first + chunk - 1)/chunk) = largest_bound(f8(:a%n))
      end if
      ! Linear laws have no open state: their contacts count as carrying even where they carry nothing.
      if (.not. present(closing)) cycle
      carried = abs(a%r_n) + abs(a%r_t) + a%linear
      call note_closing(a%n, a%u_n, carried, a%rho, closing(first:first + a%n - 1))
      if (problem%kind == arm_bonded) &
        call keep_bonds(a%n, problem%record(arm_stiffness_n:arm_stiffness_t, first:first + a%n - 1), carried, &
                        closing(first:first + a%n - 1))
    end do
    do i = 1, n_error_sums
      sums(i) = sum(sum(reshape(lane(:, i), [8, chunk/8]), 2))
    end do
  end subroutine sum_errors

  !> Errors from their sums, over one problem or over all parts of a decomposed one.
  pure subroutine set_errors(sums, contacts, free_norm, velocity_scale, with_e1, report)
    real(wp), intent(in) :: sums(n_error_sums) !! what `sum_errors` gave
    integer, intent(in) :: contacts !! number of contacts
    real(wp), intent(in) :: free_norm !! norm of q [m/s]
    real(wp), intent(in) :: velocity_scale !! of the violation [m/s]
    logical, intent(in) :: with_e1 !! set e1 and e2 too
    type(report_t), intent(inout) :: report !! errors and active contacts are set

    report%active_contacts = nint(sums(6))
    if (with_e1) report%e1 = ratio(sqrt(sums(1)), free_norm)
    if (with_e1) report%e2 = ratio(sqrt(sums(1)), max(free_norm, sqrt(sums(4)), sqrt(sums(5))))
    report%e8 = ratio(sqrt(sums(2)), sqrt(sums(4)))
    report%violation = ratio(sqrt(sums(3)/real(max(1, contacts), wp)), velocity_scale)
    report%velocity_scale = velocity_scale
  end subroutine set_errors

  !> Room for one bound per chunk of contacts.
  pure subroutine fit_bounds(bounds, n_contacts)
    real(wp), allocatable, intent(inout) :: bounds(:)
    integer, intent(in) :: n_contacts

    if (allocated(bounds)) then
      if (size(bounds)*chunk < n_contacts) deallocate (bounds)
    end if
    if (.not. allocated(bounds)) allocate (bounds((n_contacts + n_contacts/8)/chunk + 1))
  end subroutine fit_bounds

  !> The contact that breaks its law by the largest velocity; contact 0 where all obey.
  pure subroutine find_worst(problem, contact, speed, chunk_bounds, above)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    integer, intent(out) :: contact !! number of that contact
    real(wp), intent(out) :: speed !! its velocity [m/s]
    real(wp), allocatable, intent(in), optional :: chunk_bounds(:) !! of `sum_errors`, where nothing has changed since
    real(wp), intent(in), optional :: above !! velocity that only a larger one counts against [m/s]; the result where there is none
    type(chunk_t) :: a
    real(wp), allocatable :: left(:)
    real(wp) :: broken, bounds(chunk)
    integer :: turn, n_chunks, first, i

    contact = 0
    speed = 0
    if (present(above)) speed = above
    if (has_moments(problem%kind)) then
      call find_worst_rolling(problem, contact, speed)
      return
    end if
    if (is_in_space(problem%kind)) then
      call find_worst_in_space(problem, contact, speed, chunk_bounds)
      return
    end if
    n_chunks = (problem%n_contacts + chunk - 1)/chunk
    if (present(chunk_bounds)) left = chunk_bounds(:n_chunks)
    do turn = 1, n_chunks
      call next_chunk(turn, speed, left, first)
      if (first == 0) exit
      call gather(problem, first, a)
      call plane_bounds(a%n, a%u_n, a%u_t, a%r_n, a%r_t, a%friction, a%rho, a%linear, bounds)
      do i = 1, a%n
        if (bounds(i) <= speed**2) cycle
        broken = law_violation([a%u_n(i), a%u_t(i)], [a%r_n(i), a%r_t(i)], a%friction(i), a%rho(i), a%linear(i) > 0)
        if (.not. broken > speed) cycle
        contact = first + i - 1
        speed = broken
      end do
    end do
  end subroutine find_worst

  !> Add a chunk to sums of which each place has its own, so that no sum waits for the last one: squares of the map with rho = 1
  !! (where wanted), of the map with rho_a, of its velocity error, of r, and of u; and the contacts that carry an impulse.
  pure subroutine add_chunk(n, u_n, u_t, r_n, r_t, friction, rho, linear, with_e1, lane, f8)
    integer, intent(in) :: n
    real(wp), intent(in) :: u_n(chunk), u_t(chunk), r_n(chunk), r_t(chunk), friction(chunk), rho(chunk), linear(chunk)
    logical, intent(in) :: with_e1
    real(wp), intent(inout) :: lane(chunk, n_error_sums)
    real(wp), intent(out) :: f8(chunk)
    integer :: i

    if (with_e1) then
      call plane_squares(n, r_n, r_t, u_n, u_t, friction, merge(1.0_wp, 0.0_wp, rho > 0), linear, f8)
      lane(:n, 1) = lane(:n, 1) + f8(:n)
    end if
    call plane_squares(n, r_n, r_t, u_n, u_t, friction, rho, linear, f8)
    do i = 1, n
      lane(i, 2) = lane(i, 2) + f8(i)
      lane(i, 3) = lane(i, 3) + merge(f8(i), 0.0_wp, rho(i) > 0)/merge(rho(i), 1.0_wp, rho(i) > 0)**2
      lane(i, 4) = lane(i, 4) + r_n(i)**2 + r_t(i)**2
      lane(i, 5) = lane(i, 5) + u_n(i)**2 + u_t(i)**2
      lane(i, 6) = lane(i, 6) + merge(1.0_wp, 0.0_wp, abs(r_n(i)) + abs(r_t(i)) > 0)
    end do
  end subroutine add_chunk

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
      case (round_frictionless)
        call gather_round_frictionless(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (round_frictional)
        call gather_round_frictional(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (arm_frictionless)
        call gather_arm_frictionless(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (arm_frictional)
        call gather_arm_frictional(n, pair, record, r, problem%n_bodies, problem%body, a)
      case (arm_bonded)
        call gather_arm_frictional(n, pair, record(:record_length(arm_frictional), :), r, problem%n_bodies, problem%body, a)
        ! Bodies that nothing moves may come closer: their bond does not push.
        a%bond_n(:n) = record(arm_stiffness_n, :)*merge(a%u_n(:n), max(0.0_wp, a%u_n(:n)), a%rho(:n) > 0)
        a%bond_t(:n) = record(arm_stiffness_t, :)*(a%u_t(:n) + record(arm_slip, :))
        a%r_n(:n) = a%r_n(:n) + a%bond_n(:n)
        a%r_t(:n) = a%r_t(:n) + a%bond_t(:n)
      end select
    end associate
  end subroutine gather

  !> Data of round contacts without friction.
  pure subroutine gather_round_frictionless(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(round_frictionless), n), r(1, n), body(body_length(round_frictionless), n_bodies)
    type(chunk_t), intent(inout) :: a
    integer :: i

    ! Loads one by one are faster than the processor's gathers.
    !GCC$ novector
    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        a%u_n(i) = record(normal_x, i)*(body(velocity_x, c) - body(velocity_x, d)) &
                   + record(normal_y, i)*(body(velocity_y, c) - body(velocity_y, d)) + record(round_frictionless_bias, i)
      end associate
      a%r_n(i) = r(1, i)
      a%rho(i) = record(round_frictionless_inverse_wnn, i)
    end do
  end subroutine gather_round_frictionless

  !> Data of round contacts with friction.
  pure subroutine gather_round_frictional(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(round_frictional), n), r(2, n), body(body_length(round_frictional), n_bodies)
    type(chunk_t), intent(inout) :: a
    real(wp) :: x, y
    integer :: i

    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        x = body(velocity_x, c) - body(velocity_x, d)
        y = body(velocity_y, c) - body(velocity_y, d)
        a%u_n(i) = record(normal_x, i)*x + record(normal_y, i)*y + record(round_bias_n, i)
        a%u_t(i) = record(normal_y, i)*x - record(normal_x, i)*y + body(round_spin, c) + body(round_spin, d) &
                   + record(round_bias_t, i)
      end associate
      a%r_n(i) = r(1, i)
      a%r_t(i) = r(2, i)
      a%friction(i) = record(round_friction, i)
      a%rho(i) = merge(min(record(round_inverse_wnn, i), record(round_inverse_wtt, i)), record(round_inverse_wnn, i), &
                 record(round_friction, i) > 0)
    end do
  end subroutine gather_round_frictional

  !> Data of contacts with any arms, without friction.
  pure subroutine gather_arm_frictionless(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(arm_frictionless), n), r(1, n), body(body_length(arm_frictionless), n_bodies)
    type(chunk_t), intent(inout) :: a
    integer :: i

    ! Loads one by one are faster than the processor's gathers.
    !GCC$ novector
    do i = 1, n
      associate (c => pair(1, i), d => pair(2, i))
        a%u_n(i) = record(normal_x, i)*(body(velocity_x, c) - body(velocity_x, d)) &
                   + record(normal_y, i)*(body(velocity_y, c) - body(velocity_y, d)) &
                   + record(arm_frictionless_moment_c, i)*body(arm_spin, c) &
                   - record(arm_frictionless_moment_a, i)*body(arm_spin, d) + record(arm_frictionless_bias, i)
      end associate
      a%r_n(i) = r(1, i)
      a%rho(i) = record(arm_frictionless_inverse_wnn, i)
    end do
  end subroutine gather_arm_frictionless

  !> Data of contacts with any arms and any law.
  pure subroutine gather_arm_frictional(n, pair, record, r, n_bodies, body, a)
    integer, intent(in) :: n, pair(2, n), n_bodies
    real(wp), intent(in) :: record(record_length(arm_frictional), n), r(2, n), body(body_length(arm_frictional), n_bodies)
    type(chunk_t), intent(inout) :: a
    real(wp) :: x, y, w_nn(chunk), w_nt(chunk), w_tt(chunk), law(chunk)
    integer :: i, n_fours

    n_fours = n - modulo(n, 4)
    call gather_arms(n_fours, pair, record, r, body, a%u_n, a%u_t, a%r_n, a%r_t, a%friction, w_nn, w_nt, w_tt, law)
    do i = n_fours + 1, n
      associate (c => pair(1, i), d => pair(2, i))
        x = body(velocity_x, c) - body(velocity_x, d)
        y = body(velocity_y, c) - body(velocity_y, d)
        a%u_n(i) = record(normal_x, i)*x + record(normal_y, i)*y + record(arm_moment_nc, i)*body(arm_spin, c) &
                   - record(arm_moment_na, i)*body(arm_spin, d) + record(arm_bias_n, i) + record(arm_compliance_n, i)*r(1, i)
        a%u_t(i) = record(normal_y, i)*x - record(normal_x, i)*y + record(arm_moment_tc, i)*body(arm_spin, c) &
                   - record(arm_moment_ta, i)*body(arm_spin, d) + record(arm_bias_t, i) + record(arm_compliance_t, i)*r(2, i)
      end associate
      a%r_n(i) = r(1, i) + merge(record(arm_cohesion, i), 0.0_wp, record(arm_law, i) > least_active)
      a%r_t(i) = r(2, i)
      a%friction(i) = record(arm_friction, i)
      w_nn(i) = record(arm_wnn, i)
      w_nt(i) = record(arm_wnt, i)
      w_tt(i) = record(arm_wtt, i)
      law(i) = record(arm_law, i)
    end do
    ! Side by side, so that roots and inverses go through vector registers.
    do i = 1, n
      a%rho(i) = (w_nn(i) + w_tt(i))/2 + sqrt((w_nn(i) - w_tt(i))**2/4 + w_nt(i)**2)
      a%rho(i) = merge(1.0_wp, 0.0_wp, law(i) > least_active)/max(a%rho(i), tiny(1.0_wp))
      a%linear(i) = merge(1.0_wp, 0.0_wp, law(i) > least_linear)
    end do
    do i = 1, n
      if (law(i) > least_normal) a%u_t(i) = a%r_t(i)/a%rho(i)
    end do
  end subroutine gather_arm_frictional
end module sg_residuals
