!> Matrices of contact problems: systems of many parts, W and q from M and H, and the compact records of a step as matrices.
program test_condense
  use harness, only: tests_t
  use matrices, only: full, heavy_matrix, some_list, some_matrix, solved, sparse
  use sg_compact, only: add_impulses, compact_velocity
  use sg_condense, only: condense, set_local_form, sparse_from_blocks, velocity_of
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_matrix_errors, only: errors_of, matrix_errors_t
  use sg_matrix_problem, only: matrix_problem_t
  use sg_mapping_space, only: tangent_of
  use sg_problem, only: problem_t, reserve_problem
  use sg_problem_records, only: body_of, body_record_t
  use sg_problem_matrices, only: matrices_map_t, matrices_of
  use sg_random, only: random_t
  use sg_records, only: arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, arm_frictional, arm_frictionless, &
                        arm_frictionless_inverse_wnn, arm_inverse_i, arm_law, arm_wnn, ball_friction, ball_frictional, &
                        ball_frictionless, ball_frictionless_inverse_wnn, ball_inverse_i, ball_inverse_m, ball_inverse_wnn, &
                        ball_inverse_wtt, first_inverse, normal_x, normal_y, normal_z, round_friction, round_frictional, &
                        round_frictionless, round_frictionless_inverse_wnn, round_inverse_wnn, round_inverse_wtt, solid_cohesion, &
                        solid_compliance_n, solid_compliance_t, solid_friction, solid_frictional, solid_frictionless, &
                        solid_frictionless_inverse_wnn, solid_inverse_lambda, solid_inverse_xx, solid_inverse_yz, solid_law, &
                        solid_tangent_x, solid_tangent_z
  use sg_report, only: report_t
  use sg_residuals, only: measure_errors
  use sg_sparse, only: multiply, sparse_t
  use sg_sparse_algebra, only: multiply_matrices, no_columns
  use sg_sparse_parts, only: solve_by_parts
  use sg_symmetric, only: principal_axes
  implicit none
  integer, parameter :: n_bodies = 6, n_contacts = 9, inactive = 4
  type(tests_t) :: t
  type(random_t) :: random

  call random%seed(17)
  call test_products()
  call test_parts()
  call test_blocks()
  call test_condensed()
  call test_records(round_frictionless, .false., .false.)
  call test_records(round_frictional, .false., .false.)
  call test_records(arm_frictionless, .false., .false.)
  call test_records(arm_frictional, .false., .false.)
  call test_records(arm_frictional, .true., .false.)
  call test_records(arm_frictional, .true., .true.)
  call test_records(ball_frictionless, .false., .false.)
  call test_records(ball_frictional, .false., .false.)
  call test_records(solid_frictionless, .false., .false.)
  call test_records(solid_frictional, .false., .false.)
  call test_records(solid_frictional, .true., .true.)
  call test_partly_driven()
  call test_linear()
  call test_nothing()
  call t%finish()

contains

  !> Products of sparse matrices are those of the full ones.
  subroutine test_products()
    real(wp) :: a(7, 5), b(5, 8)
    type(sparse_t) :: c
    type(error_t), allocatable :: error

    a = some_matrix(random, 7, 5, 0.4_wp)
    b = some_matrix(random, 5, 8, 0.4_wp)
    call multiply_matrices(sparse(a), sparse(b), c, error)
    call t%check(.not. allocated(error), 'product: no error')
    call t%near(maxval(abs(full(c) - matmul(a, b))), 0.0_wp, 1e-15_wp, 'product, to rounding')
    call t%check(size(c%column) < 56 .and. size(c%column) == c%first(8) - 1, 'product: sparse, and well counted')
  end subroutine test_products

  !> A system of three parts whose rows lie mixed.
  subroutine test_parts()
    integer, parameter :: rows(9) = [4, 1, 7, 2, 9, 3, 5, 6, 8], first(4) = [1, 4, 9, 10]
    real(wp) :: a(9, 9), c(9, 4), right(9, 4)
    type(sparse_t) :: x
    type(error_t), allocatable :: error
    integer :: part

    a = 0
    c = some_matrix(random, 9, 4, 0.5_wp)
    right = 0
    do part = 1, 3
      associate (own => rows(first(part):first(part + 1) - 1))
        a(own, own) = heavy_matrix(random, size(own))
        right(own, :) = solved(a(own, own), c(own, :))
      end associate
    end do
    call solve_by_parts(sparse(a), 'A', sparse(c), x, error)
    call t%check(.not. allocated(error), 'parts: no error')
    call t%near(maxval(abs(full(x) - right)), 0.0_wp, 1e-15_wp, 'parts: each solved, to rounding')
    ! Two equal rows that elimination leaves with a rounding error rather than a zero.
    a(9, :) = a(2, :)*0.3_wp
    call solve_by_parts(sparse(a), 'A', sparse(c), x, error)
    call t%check(allocated(error), 'parts: a singular part is noticed')
    if (allocated(error)) call t%check(index(error%message, 'A is singular (row 1 ') == 1, 'parts: which one')
    a(6, :) = 0
    a(:, 6) = 0
    call solve_by_parts(sparse(a), 'A', sparse(c), x, error)
    call t%check(allocated(error), 'parts: an empty row is noticed')
  end subroutine test_parts

  !> Blocks and single entries are one matrix; a diagonal block may be missing.
  subroutine test_blocks()
    real(wp) :: a(6, 6)
    type(matrix_problem_t) :: problem

    a = 0
    a(1, 2) = 1
    a(2, 6) = 2
    a(5, 3) = 3
    a(6, 6) = 4
    problem%d = 2
    call set_local_form(problem, sparse(a), spread(0.0_wp, 1, 6))
    call t%equal(size(problem%w%column), 4, 'blocks: as many as needed')
    call t%check(all(problem%w%column == [1, 3, 2, 3]), 'blocks: columns rise')
    call t%check(all(problem%w%diagonal == [1, 0, 4]), 'blocks: diagonal')
    call t%near(maxval(abs(full(sparse_from_blocks(problem%w)) - a)), 0.0_wp, 0.0_wp, 'blocks: the same matrix')
  end subroutine test_blocks

  !> W and q by full matrices; the singular mass that cannot be inverted is said.
  subroutine test_condensed()
    type(matrix_problem_t) :: problem
    type(error_t), allocatable :: error
    real(wp) :: m(8, 8), h(8, 6), f(8, 1), w(6)

    m = heavy_matrix(random, 8)
    m(:3, 4:) = 0
    m(4:, :3) = 0
    h = some_matrix(random, 8, 6, 0.5_wp)
    f(:, 1) = some_list(random, 8)
    w = some_list(random, 6)
    problem%d = 3
    problem%mass = sparse(m)
    problem%h = sparse(h)
    problem%f = f(:, 1)
    problem%offset = w
    call condense(problem, error)
    call t%check(.not. allocated(error), 'condensed: no error')
    call t%equal(problem%n, 2, 'condensed: contacts')
    call t%near(maxval(abs(full(sparse_from_blocks(problem%w)) - matmul(transpose(h), solved(m, h)))), 0.0_wp, 1e-15_wp, &
                'condensed: W, to rounding')
    call t%near(maxval(abs(problem%q - reshape(w + reshape(matmul(transpose(h), solved(m, f)), [6]), [3, 2]))), 0.0_wp, 1e-15_wp, &
                'condensed: q, to rounding')
    call t%check(.not. problem%is_symmetric, 'condensed: a mass that is not symmetric leaves W so')
    m(2, :) = 0
    problem%mass = sparse(m)
    call condense(problem, error)
    call t%check(allocated(error), 'condensed: singular mass')
    if (allocated(error)) call t%check(index(error%message, 'the mass matrix M is singular') == 1, 'condensed: the mass is named')
  end subroutine test_condensed

  !> A problem of random contacts between five bodies and a driven one; H and the inverse masses as full matrices.
  subroutine make_records(kind, with_cohesion, with_compliance, problem, h, inverse)
    integer, intent(in) :: kind
    logical, intent(in) :: with_cohesion, with_compliance
    type(problem_t), intent(out) :: problem
    real(wp), allocatable, intent(out) :: h(:, :), inverse(:, :)
    integer :: k, s, nv
    real(wp) :: n(3)

    call reserve_problem(problem, kind, n_bodies, n_contacts)
    nv = first_inverse(kind) - 1
    allocate (h(nv*n_bodies, 3*n_contacts), inverse(nv*n_bodies, nv*n_bodies))
    problem%body = 0
    inverse = 0
    do s = 1, n_bodies
      problem%body(:nv, s) = some_list(random, nv)
      ! The last body is driven in all its components.
      if (s < n_bodies) call give_mass(kind, nv, s, problem%body(:, s), inverse)
    end do
    do k = 1, n_contacts
      problem%pair(:, k) = [modulo(k, n_bodies) + 1, modulo(2*k + k/4 + 3, n_bodies) + 1]
      if (problem%pair(1, k) == problem%pair(2, k)) problem%pair(2, k) = modulo(k + 2, n_bodies) + 1
      problem%record(:, k) = some_list(random, size(problem%record, 1))
      problem%impulse(:, k) = some_list(random, size(problem%impulse, 1))
      n = some_list(random, 3)
      if (kind <= arm_frictional) n(3) = 0
      n = n/norm2(n)
      problem%record(normal_x:normal_y, k) = n(1:2)
      if (kind > arm_frictional) problem%record(normal_z, k) = n(3)
      if (kind == solid_frictional) problem%record(solid_tangent_x:solid_tangent_z, k) = tangent_of(n)
      if (law_at(kind) > 0) problem%record(law_at(kind):law_at(kind) + 2, k) = &
        [merge(random%uniform(), 0.0_wp, with_cohesion), merge([0.7_wp, 0.2_wp], [0.0_wp, 0.0_wp], with_compliance .and. k < 3)]
    end do
    call build_mapping(problem, nv, h)
    call finish_records(problem, matmul(transpose(h), matmul(inverse, h)))
  end subroutine make_records

  !> Where cohesion and compliance stand in records of a kind; 0 where they do not.
  pure integer function law_at(kind)
    integer, intent(in) :: kind

    law_at = 0
    if (kind == arm_frictional) law_at = arm_cohesion
    if (kind == solid_frictional) law_at = solid_cohesion
  end function law_at

  !> Give a body random inverse masses; spins of the last but one are partly driven where there are arms.
  subroutine give_mass(kind, nv, s, body, inverse)
    integer, intent(in) :: kind, nv, s
    real(wp), intent(inout) :: body(:), inverse(:, :)
    real(wp) :: turn(3, 3)
    integer :: i, first

    first = nv*(s - 1)
    body(nv + 1:) = random%uniform(0.5_wp, 2.0_wp)
    if (kind == arm_frictional .and. s == n_bodies - 1) body(arm_inverse_i) = 0
    do i = 1, nv
      if (kind == ball_frictional) then
        inverse(first + i, first + i) = body(merge(ball_inverse_m, ball_inverse_i, i <= 3))
      else if (kind < ball_frictional .or. i <= 3) then
        inverse(first + i, first + i) = body(nv + i)
      end if
    end do
    if (kind < solid_frictionless) return
    turn = some_matrix(random, 3, 3, 1.0_wp)
    if (s == n_bodies - 1) turn(:, 2:) = 0
    turn = matmul(turn, transpose(turn))
    inverse(first + 4:first + 6, first + 4:first + 6) = turn(:, :)
    body(solid_inverse_xx:solid_inverse_yz) = [turn(1, 1), turn(2, 2), turn(3, 3), turn(1, 2), turn(1, 3), turn(2, 3)]
  end subroutine give_mass

  !> H from the relative velocities that unit velocities of bodies make.
  subroutine build_mapping(problem, nv, h)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: nv
    real(wp), intent(out) :: h(:, :)
    type(problem_t) :: at_rest, moving
    integer :: k, s, c

    h = 0
    at_rest = problem
    at_rest%body(:nv, :) = 0
    do s = 1, n_bodies
      do c = 1, nv
        moving = at_rest
        moving%body(c, s) = 1
        do k = 1, n_contacts
          h(nv*(s - 1) + c, 3*k - 2:3*k) = compact_velocity(moving, k) - compact_velocity(at_rest, k)
        end do
      end do
    end do
  end subroutine build_mapping

  !> The blocks and frictions of records, and the norm of q.
  subroutine finish_records(problem, w)
    type(problem_t), intent(inout) :: problem
    real(wp), intent(in) :: w(:, :)
    type(problem_t) :: free
    real(wp) :: squares, own(3, 3), axes(3, 3), values(3)
    integer :: k, i

    squares = 0
    free = problem
    free%impulse = 0
    do k = 1, n_contacts
      own = w(3*k - 2:3*k, 3*k - 2:3*k)
      if (k /= inactive) squares = squares + sum(compact_velocity(free, k)**2)
      associate (record => problem%record(:, k))
        select case (problem%kind)
        case (round_frictionless)
          record(round_frictionless_inverse_wnn) = 1/own(1, 1)
        case (round_frictional)
          record(round_inverse_wnn:round_friction) = [1/own(1, 1), 1/own(2, 2), random%uniform()]
        case (arm_frictionless)
          record(arm_frictionless_inverse_wnn) = 1/own(1, 1)
        case (arm_frictional)
          record(arm_wnn:arm_friction) = [own(1, 1) + record(arm_compliance_n), own(1, 2), own(2, 2) + record(arm_compliance_t), &
                                          random%uniform()]
          record(arm_law) = 1
        case (ball_frictionless)
          record(ball_frictionless_inverse_wnn) = 1/own(1, 1)
        case (ball_frictional)
          record(ball_inverse_wnn:ball_friction) = [1/normal_part(own, record(normal_x:normal_z)), &
                                                    1/normal_part(own, tangent_of(record(normal_x:normal_z))), random%uniform()]
        case (solid_frictionless)
          record(solid_frictionless_inverse_wnn) = 1/own(1, 1)
        case (solid_frictional)
          record(solid_friction) = random%uniform()
          own = own + (record(solid_compliance_n) - record(solid_compliance_t)) &
                *spread(record(normal_x:normal_z), 2, 3)*spread(record(normal_x:normal_z), 1, 3)
          do i = 1, 3
            own(i, i) = own(i, i) + record(solid_compliance_t)
          end do
          call principal_axes(own, values, axes)
          record(solid_law:solid_inverse_lambda) = [1.0_wp, 1/maxval(values)]
        end select
        if (k /= inactive) cycle
        problem%impulse(:, k) = 0
        select case (problem%kind)
        case (arm_frictional)
          record([arm_cohesion, arm_law]) = 0
        case (solid_frictional)
          record([solid_cohesion, solid_law, solid_inverse_lambda]) = 0
        case (round_frictional)
          record(round_inverse_wnn:round_inverse_wtt) = 0
        case (ball_frictional)
          record(ball_inverse_wnn:ball_inverse_wtt) = 0
        case default
          record(size(record)) = 0
        end select
      end associate
    end do
    problem%free_norm = sqrt(squares)
    problem%velocity_scale = 1
  end subroutine finish_records

  !> W along a direction.
  pure real(wp) function normal_part(w, n)
    real(wp), intent(in) :: w(3, 3), n(3)

    normal_part = dot_product(n, matmul(w, n))
  end function normal_part

  !> Records as matrices: W and q by full matrices, the same errors, and the same when the bodies move already.
  subroutine test_records(kind, with_cohesion, with_compliance)
    integer, intent(in) :: kind
    logical, intent(in) :: with_cohesion, with_compliance
    type(problem_t) :: problem
    type(matrix_problem_t) :: made, moved
    type(matrices_map_t) :: map
    type(error_t), allocatable :: error
    type(report_t) :: report
    type(matrix_errors_t) :: errors
    type(body_record_t) :: body
    real(wp), allocatable :: h(:, :), inverse(:, :), v(:), l(:)
    character(len=:), allocatable :: name
    integer :: i

    name = 'records of kind '//achar(48 + kind)
    call make_records(kind, with_cohesion, with_compliance, problem, h, inverse)
    call matrices_of(problem, .false., made, map, error)
    call t%check(.not. allocated(error), name//': no error')
    if (allocated(error)) return
    call t%equal(made%n, n_contacts - 1, name//': all contacts but the one that takes no part')
    call t%check(made%has_global .neqv. with_compliance, name//': global form unless there is compliance')
    call t%check(made%is_symmetric, name//': symmetric')
    call t%equal(size(made%mass%value), made%mass%n_rows, name//': M is diagonal')
    call add_impulses(problem)
    call check_velocities(problem, made, map, name)
    call check_dense(kind, matmul(transpose(h), matmul(inverse, h)), problem, made, map, name)

    call measure_errors(problem, report, .true.)
    errors = errors_of(made, made%r)
    ! Sums of some ten numbers; the largest eigenvalue of a block comes from powers of it.
    call t%near(errors%e8/report%e8, 1.0_wp, 1e-12_wp, name//': e8')
    if (.not. with_cohesion) call t%near(errors%e1/report%e1, 1.0_wp, 1e-12_wp, name//': e1')
    call matrices_of(problem, .true., moved, map, error)
    call t%near(maxval(abs(moved%q - made%q)), 0.0_wp, 1e-13_wp, name//': q from bodies that move, to rounding')
    call t%near(maxval(abs(moved%f - made%f))/maxval(made%mass%value), 0.0_wp, 1e-13_wp, &
                name//': f from bodies that move, to rounding of M v')
    call t%near(maxval(abs(made%r - moved%r)), 0.0_wp, 0.0_wp, name//': impulses')
    call velocity_of(made, no_columns(size(made%f)), [real(wp) ::], v, l, error)
    do i = 1, size(map%slot)
      body = body_of(problem, int(map%slot(i)))
      call t%near(body%velocity(map%component(i)), v(i), 1e-12_wp, name//': velocities from M, H and f, to rounding')
    end do
  end subroutine test_records

  !> Relative velocities W r + q are those that records give: the same along normals, and as long along tangents.
  subroutine check_velocities(problem, made, map, name)
    type(problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(in) :: made
    type(matrices_map_t), intent(in) :: map
    character(len=*), intent(in) :: name
    real(wp), allocatable :: u(:, :)
    real(wp) :: other(3), normal, largest
    integer :: k

    allocate (u(made%d, made%n))
    call multiply(made%w, made%r, u)
    u = u + made%q
    largest = 0
    do k = 1, made%n
      other = compact_velocity(problem, int(map%contact(k)))
      normal = other(1)
      if (any(problem%kind == [ball_frictional, solid_frictional])) then
        normal = dot_product(problem%record(normal_x:normal_z, map%contact(k)), other)
      end if
      largest = max(largest, abs(u(1, k) - normal))
      if (size(problem%impulse, 1) > 1) largest = max(largest, abs(norm2(u(:, k)) - norm2(other)))
    end do
    call t%near(largest, 0.0_wp, 1e-13_wp, name//': velocities at contacts, to rounding')
  end subroutine check_velocities

  !> In the plane: W by full matrices, component by component.
  subroutine check_dense(kind, w, problem, made, map, name)
    integer, intent(in) :: kind
    real(wp), intent(in) :: w(:, :)
    type(problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(in) :: made
    type(matrices_map_t), intent(in) :: map
    character(len=*), intent(in) :: name
    real(wp) :: dense(2*n_contacts - 2, 2*n_contacts - 2), largest
    integer :: i, j, k, l, d

    if (kind > arm_frictional) return
    d = size(problem%impulse, 1)
    dense = full(sparse_from_blocks(made%w))
    largest = 0
    do i = 1, made%n
      do k = 1, d
        if (kind == arm_frictional) dense(2*i - 2 + k, 2*i - 2 + k) = dense(2*i - 2 + k, 2*i - 2 + k) &
                                                                      - problem%record(arm_compliance_n + k - 1, map%contact(i))
        do j = 1, made%n
          do l = 1, d
            if (j == i .and. l > k) cycle
            largest = max(largest, abs(dense(2*i - 2 + k, 2*j - 2 + l) - w(3*map%contact(i) - 3 + k, 3*map%contact(j) - 3 + l)))
          end do
        end do
      end do
    end do
    call t%near(largest, 0.0_wp, 1e-14_wp, name//': W, to rounding')
  end subroutine check_dense

  !> A ball that is driven in y alone moves in x and z, and does not turn.
  subroutine test_partly_driven()
    type(problem_t) :: problem
    type(matrix_problem_t) :: made
    type(matrices_map_t) :: map
    type(error_t), allocatable :: error
    real(wp), allocatable :: h(:, :), inverse(:, :)

    call make_records(ball_frictional, .false., .false., problem, h, inverse)
    problem%body(ball_inverse_i, 2) = -1.0_wp - 4.0_wp
    call matrices_of(problem, .false., made, map, error)
    call t%check(.not. allocated(error), 'partly driven: no error')
    call t%check(all(pack(map%component, map%slot == 2) == [1, 3]), 'partly driven: two unknowns')
    call add_impulses(problem)
    call check_velocities(problem, made, map, 'partly driven')
  end subroutine test_partly_driven

  !> A linear law is not expressed as a cone.
  subroutine test_linear()
    type(problem_t) :: problem
    type(matrix_problem_t) :: made
    type(matrices_map_t) :: map
    type(error_t), allocatable :: error
    real(wp), allocatable :: h(:, :), inverse(:, :)

    call make_records(arm_frictional, .false., .false., problem, h, inverse)
    problem%record(arm_law, 3) = 2
    call matrices_of(problem, .false., made, map, error)
    call t%check(allocated(error), 'linear: error')
    if (allocated(error)) call t%check(index(error%message, 'contact 3 has a linear law') == 1, 'linear: which contact')
  end subroutine test_linear

  !> No contacts, no unknowns.
  subroutine test_nothing()
    type(problem_t) :: problem
    type(matrix_problem_t) :: made
    type(matrices_map_t) :: map
    type(error_t), allocatable :: error

    call reserve_problem(problem, arm_frictional, 2, 0)
    call matrices_of(problem, .false., made, map, error)
    call t%check(.not. allocated(error), 'nothing: no error')
    call t%equal(made%n + size(made%f), 0, 'nothing: empty')
  end subroutine test_nothing
end program test_condense
