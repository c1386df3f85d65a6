!> The enriched interface on two subdomains with full matrices, from its four relations (doc/theory/enriched.md): dynamics,
!! admissibility, continuity and search direction. What the solver uses (M + H D H^T, its factor, rows on shared bodies, the
!! update by differences) is compared with them.
program test_enriched
  use harness, only: tests_t
  use sg_congruence, only: congruence_t
  use sg_dense_factor, only: dense_factorise, dense_solve
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_random, only: random_t
  use sg_sparse, only: multiply, sparse_from_triplets, sparse_t
  use sg_sparse_algebra, only: diagonal_matrix
  use sg_subdomain_factor, only: by_lump, by_mass, by_schur, subdomain_factor_t
  implicit none

  !> Freedoms and contacts of each subdomain, impulse components of a contact; the first freedoms are shared, in this order
  integer, parameter :: n = 9, contacts = 7, d = 2, shared = 4
  !> Rounding of solutions of such systems, whose condition is below 1e4
  real(wp), parameter :: rounding = 1e-11_wp

  !> One subdomain, in full matrices
  type :: part_t
    real(wp) :: mass(n) = 0, h(n, d*contacts) = 0, stiff(d*contacts) = 0, load(n) = 0
    !> Impulses and relative velocities of step 1, interface impulses, velocities
    real(wp) :: r(d*contacts) = 0, u(d*contacts) = 0, l(n) = 0, v(n) = 0
    type(subdomain_factor_t) :: factor
  end type part_t

  type(tests_t) :: t
  type(random_t) :: random
  integer :: i

  call random%seed(16)
  do i = 1, 5
    call test_relations()
    call test_linear()
  end do
  call test_fixed_freedoms()
  call test_shared_blocks()
  call t%finish()

contains

  !> Two subdomains drawn by lot: shared freedoms have one mass in both, loads are divided in proportion.
  subroutine draw(part)
    type(part_t), intent(out) :: part(2)
    type(error_t), allocatable :: error
    real(wp) :: blocks(d, d, contacts)
    integer :: e, k, i

    do e = 1, 2
      do k = 1, d*contacts
        ! A contact touches two bodies of two freedoms each, and one of the first contacts a shared one.
        do i = 1, 4
          part(e)%h(1 + int(random%uniform(0.0_wp, real(n, wp) - 1e-9_wp)), k) = random%uniform(-1.0_wp, 1.0_wp)
        end do
        part(e)%stiff(k) = random%uniform(0.1_wp, 5.0_wp)
      end do
      do i = 1, n
        part(e)%mass(i) = random%uniform(0.5_wp, 2.0_wp)
        part(e)%load(i) = random%uniform(-1.0_wp, 1.0_wp)
      end do
      do k = 1, d*contacts
        part(e)%r(k) = random%uniform(-1.0_wp, 1.0_wp)
      end do
    end do
    part(2)%mass(:shared) = part(1)%mass(:shared)
    part(2)%load(:shared) = part(1)%load(:shared)
    ! Interface impulses add up to nothing.
    do i = 1, shared
      part(1)%l(i) = random%uniform(-1.0_wp, 1.0_wp)
      part(2)%l(i) = -part(1)%l(i)
    end do
    do e = 1, 2
      part(e)%v = (part(e)%load + matmul(part(e)%h, part(e)%r) - part(e)%l)/part(e)%mass
      part(e)%u = matmul(part(e)%v, part(e)%h)
      call part(e)%factor%prepare(part(e)%mass, sparse_of(part(e)%h), d, &
                                  reshape([(merge(i, 0, i <= shared), i=1, shared)], [1, shared]))
      blocks = 0
      do k = 1, contacts
        do i = 1, d
          blocks(i, i, k) = part(e)%stiff(d*(k - 1) + i)
        end do
      end do
      call part(e)%factor%factorise(blocks, error)
      call t%check(.not. allocated(error), 'a factor')
    end do
  end subroutine draw

  !> Give the factors back.
  subroutine free(part)
    type(part_t), intent(inout) :: part(:)
    integer :: e

    do e = 1, size(part)
      call part(e)%factor%free()
    end do
  end subroutine free

  !> A full matrix with the entries that are not zero.
  function sparse_of(full) result(matrix)
    real(wp), intent(in) :: full(:, :)
    type(sparse_t) :: matrix
    integer :: i, j

    call sparse_from_triplets(size(full, 1), size(full, 2), [((int(i, i4), i=1, size(full, 1)), j=1, size(full, 2))], &
                              [((int(j, i4), i=1, size(full, 1)), j=1, size(full, 2))], reshape(full, [size(full)]), matrix)
  end function sparse_of

  !> M + H D H^T in full, D diagonal.
  pure function stiffened(part, stiff) result(matrix)
    type(part_t), intent(in) :: part
    real(wp), intent(in) :: stiff(:)
    real(wp) :: matrix(n, n)
    integer :: i, k

    matrix = 0
    do k = 1, size(stiff)
      do i = 1, n
        matrix(:, i) = matrix(:, i) + part%h(:, k)*stiff(k)*part%h(i, k)
      end do
    end do
    do i = 1, n
      matrix(i, i) = matrix(i, i) + part%mass(i)
    end do
  end function stiffened

  !> Solution of a full system.
  function solved(matrix, b) result(x)
    real(wp), intent(in) :: matrix(:, :), b(:)
    real(wp) :: x(size(b)), a(size(b), size(b))
    integer :: pivot(size(b))
    logical :: is_singular

    a = matrix
    x = b
    call dense_factorise(a, pivot, is_singular)
    call dense_solve(a, pivot, x)
  end function solved

  !> All unknowns of the four relations at once, V~, r~ and F, from one full system without any elimination; then by
  !! X_eta F = sum A_E M_eta,E^-1 (R_E^d + H_E (r_E + u_E/eta)), and by the update of the solver.
  subroutine test_relations()
    integer, parameter :: m = d*contacts, all = 2*(n + m) + shared
    type(part_t) :: part(2)
    real(wp) :: whole(all, all), b(all), x(all), x_eta(shared, shared), right(shared), force(shared), column(n), sign(2)
    real(wp) :: rows(1, shared), jump(shared), change(shared), by_solver(shared, shared)
    integer :: e, i, o

    call draw(part)
    sign = [1.0_wp, -1.0_wp]
    whole = 0
    b = 0
    do e = 1, 2
      o = (e - 1)*(n + m)
      ! Dyn and Adm: M V~ - H r~ + A^T F = R^d. Dir: r~ + D H^T V~ = r + D u. Int: sum A V~ = 0.
      do i = 1, n
        whole(o + i, o + i) = part(e)%mass(i)
      end do
      do i = 1, shared
        whole(o + i, 2*(n + m) + i) = sign(e)
        whole(2*(n + m) + i, o + i) = sign(e)
      end do
      whole(o + 1:o + n, o + n + 1:o + n + m) = -part(e)%h
      b(o + 1:o + n) = part(e)%load
      do i = 1, m
        whole(o + n + i, o + n + i) = 1
        whole(o + n + i, o + 1:o + n) = part(e)%stiff(i)*part(e)%h(:, i)
      end do
      b(o + n + 1:o + n + m) = part(e)%r + part(e)%stiff*part(e)%u
    end do
    x = solved(whole, b)

    x_eta = 0
    right = 0
    by_solver = 0
    do e = 1, 2
      do i = 1, shared
        column = 0
        column(i) = 1
        column = solved(stiffened(part(e), part(e)%stiff), column)
        x_eta(:, i) = x_eta(:, i) + column(:shared)
        rows = 0
        rows(1, i) = 1
        call part(e)%factor%apply_inverse(rows)
        by_solver(:, i) = by_solver(:, i) + rows(1, :)
      end do
      column = solved(stiffened(part(e), part(e)%stiff), part(e)%load + matmul(part(e)%h, part(e)%r + part(e)%stiff*part(e)%u))
      right = right + sign(e)*column(:shared)
    end do
    force = solved(x_eta, right)
    call near(force, x(2*(n + m) + 1:), 'X_eta F and the four relations')
    call near(reshape(by_solver, [shared**2]), reshape(x_eta, [shared**2]), 'rows of the inverse on shared bodies')

    ! With M V = R^d + H r - l the same follows from the difference between copies alone: X_eta dF = sum A V.
    jump = part(1)%v(:shared) - part(2)%v(:shared)
    change = solved(by_solver, jump)
    call near(part(1)%l(:shared) + change, force, 'the update by differences')
    call check_preconditioners(part(1))
    call free(part)
  end subroutine test_relations

  !> The Schur complement undoes the inverse on shared bodies; the lump is the matrix there, and the mass that without contacts.
  subroutine check_preconditioners(part)
    type(part_t), intent(inout) :: part
    real(wp) :: rows(1, shared), x(n), matrix(n, n)
    integer :: i

    do i = 1, shared
      rows(1, i) = random%uniform(-1.0_wp, 1.0_wp)
    end do
    x = 0
    x(:shared) = rows(1, :)
    call part%factor%apply_inverse(rows)
    call part%factor%precondition(by_schur, rows)
    call near(rows(1, :), x(:shared), 'the Schur complement')
    matrix = stiffened(part, part%stiff)
    call part%factor%precondition(by_lump, rows)
    call near(rows(1, :), matmul(matrix(:shared, :), x), 'the lump')
    rows(1, :) = x(:shared)
    call part%factor%precondition(by_mass, rows)
    call near(rows(1, :), part%mass(:shared)*x(:shared), 'the mass')
    call part%factor%apply_inverse_mass(rows)
    call near(rows(1, :), x(:shared), 'the inverse mass')
  end subroutine check_preconditioners

  !> With linear interactions r = -D u and search directions of the same stiffness, one update gives the solution of the whole
  !! problem from any interface impulses.
  subroutine test_linear()
    type(part_t) :: part(2)
    real(wp) :: x_eta(shared, shared), rows(1, shared), force(shared), whole(2*n - shared, 2*n - shared), b(2*n - shared)
    integer :: e, i, j, place(n, 2)

    call draw(part)
    ! Step 1, solved: (M + H D H^T) V = R^d - l.
    do e = 1, 2
      call part(e)%factor%solve(part(e)%load - part(e)%l, part(e)%v)
    end do
    x_eta = 0
    do i = 1, shared
      do e = 1, 2
        rows = 0
        rows(1, i) = 1
        call part(e)%factor%apply_inverse(rows)
        x_eta(:, i) = x_eta(:, i) + rows(1, :)
      end do
    end do
    force = part(1)%l(:shared) + solved(x_eta, part(1)%v(:shared) - part(2)%v(:shared))
    ! The whole problem, with shared freedoms once.
    place(:, 1) = [(i, i=1, n)]
    place(:, 2) = [(merge(i, n - shared + i, i <= shared), i=1, n)]
    whole = 0
    b = 0
    do e = 1, 2
      associate (matrix => stiffened(part(e), part(e)%stiff))
        do j = 1, n
          b(place(j, e)) = b(place(j, e)) + part(e)%load(j)
          do i = 1, n
            whole(place(i, e), place(j, e)) = whole(place(i, e), place(j, e)) + matrix(i, j)
          end do
        end do
      end associate
    end do
    b = solved(whole, b)
    do e = 1, 2
      part(e)%l(:shared) = merge(1.0_wp, -1.0_wp, e == 1)*force
      call part(e)%factor%solve(part(e)%load - part(e)%l, part(e)%v)
      call near(part(e)%v, b(place(:, e)), 'one update of a linear problem')
    end do
    call free(part)
  end subroutine test_linear

  !> Driven freedoms have no unknown, and a body without contacts takes no part; without stiffness the matrix is the mass.
  subroutine test_fixed_freedoms()
    type(subdomain_factor_t) :: factor
    type(congruence_t) :: congruence
    type(sparse_t) :: h
    real(wp) :: values(2, 2), y(2)

    h = sparse_of(reshape([1.0_wp, 2.0_wp], [2, 1]))
    call congruence%prepare(diagonal_matrix([3.0_wp, 4.0_wp]), h, 1)
    call congruence%fill(reshape([0.5_wp], [1, 1, 1]))
    call multiply(congruence%matrix, [1.0_wp, 1.0_wp], y)
    call near(y, [4.5_wp, 7.0_wp], 'two freedoms by hand')
    call factor%prepare([3.0_wp, 4.0_wp], h, 1, reshape([0, 2, 0, 0], [2, 2]))
    call t%check(factor%takes_part(1) .and. .not. factor%takes_part(2), 'bodies that take part')
    values = 8
    call factor%apply_inverse(values)
    call near(reshape(values, [4]), [0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp], 'driven freedoms')
  end subroutine test_fixed_freedoms

  !> The block of a shared body in space, whose spins have axes of their own, is what the matrix makes of velocities of this body
  !! alone; a driven component has none.
  subroutine test_shared_blocks()
    integer, parameter :: bodies = 2, impulses = 9
    type(subdomain_factor_t) :: factor
    type(error_t), allocatable :: error
    real(wp) :: h(6*bodies, impulses), mass(6*bodies), axes(3, 3, bodies), d(3, 3, impulses/3), v(3), values(6, bodies), &
                expected(6), blocks(6, 6, bodies)
    integer :: unknown(6, bodies), i, j, k

    h = reshape([(random%uniform(-1.0_wp, 1.0_wp), k=1, size(h))], shape(h))
    mass = [(random%uniform(1.0_wp, 2.0_wp), k=1, size(mass))]
    unknown = reshape([(k, k=1, 6*bodies)], shape(unknown))
    unknown(2, 1) = 0
    d = 0
    do k = 1, size(d, 3)
      do i = 1, 3
        d(i, i, k) = 10.0_wp**k
      end do
    end do
    do k = 1, bodies
      v = [(random%uniform(0.5_wp, 1.0_wp), i=1, 3)]
      do j = 1, 3
        do i = 1, 3
          axes(i, j, k) = merge(1.0_wp, 0.0_wp, i == j) - 2*v(i)*v(j)/sum(v**2)
        end do
      end do
      axes(:, :, k) = axes(:, [2, 3, 1], k)
    end do
    call factor%prepare(mass, sparse_of(h), 3, unknown, axes)
    call factor%factorise(d, error)
    call t%check(.not. allocated(error), 'a factor in space')
    if (allocated(error)) return
    call factor%shared_blocks(blocks)
    do k = 1, bodies
      values = 0
      values(:, k) = [(random%uniform(-1.0_wp, 1.0_wp), i=1, 6)]
      expected = matmul(blocks(:, :, k), values(:, k))
      call factor%precondition(by_lump, values)
      call t%check(maxval(abs(values(:, k) - expected)) <= 1e-12_wp*maxval(abs(expected)), 'the block of a shared body')
    end do
    call factor%free()
  end subroutine test_shared_blocks

  !> Vectors agree up to rounding of the largest entry.
  subroutine near(a, b, name)
    real(wp), intent(in) :: a(:), b(:)
    character(len=*), intent(in) :: name

    call t%check(maxval(abs(a - b)) <= rounding*max(1.0_wp, maxval(abs(b))), name)
  end subroutine near
end program test_enriched
