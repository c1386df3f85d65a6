!> From the global form of a contact problem to its local form: W = H^T M^-1 H and q = w + H^T M^-1 f, equality
!! constraints eliminated (doc/theory/contact_problem.md).
!!
!! M is inverted by its connected parts, which are the bodies. Constraints G^T v + b = 0, with multipliers G l added to the
!! momentum, take S^-1, S = G^T M^-1 G; constraints of the local form, V^T r + R l + s = 0 with V l added to u, take R^-1.
module sg_condense
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: blocks_t, multiply, multiply_transposed, sparse_from_triplets, sparse_t, transposed
  use sg_sparse_algebra, only: beside, columns_of, dense_column, multiply_matrices, no_columns, rows_of, sum_of, with_column
  use sg_sparse_parts, only: solve_by_parts
  implicit none
  private
  public :: condense, condense_constrained, eliminate_local, set_local_form, sparse_from_blocks
  public :: velocity_of, multipliers_of

  !> Relative difference between W and its transpose that rounding explains
  real(wp), parameter :: symmetric_to = 1e-12_wp

contains

  !> Set W and q of a problem from its global form.
  subroutine condense(problem, error)
    type(matrix_problem_t), intent(inout) :: problem !! problem with `mass`, `h`, `f`, `offset`; W and q are set
    type(error_t), allocatable, intent(out) :: error !! set when M cannot be inverted

    call condense_constrained(problem, no_columns(problem%mass%n_rows), [real(wp) ::], error)
  end subroutine condense

  !> Set W and q of a problem from its global form with equality constraints.
  subroutine condense_constrained(problem, g, b, error)
    type(matrix_problem_t), intent(inout) :: problem !! problem with `mass`, `h`, `f`, `offset`; W and q are set
    type(sparse_t), intent(in) :: g !! directions of the constraints G, shape (dof, p)
    real(wp), intent(in) :: b(:) !! their offsets b, shape (p)
    type(error_t), allocatable, intent(out) :: error !! set when M or G^T M^-1 G cannot be inverted
    type(sparse_t) :: moved, w, felt, s, reduced, correction
    integer :: m, p

    m = problem%h%n_columns
    p = size(b)
    call solve_by_parts(problem%mass, 'the mass matrix M', beside(with_column(problem%h, problem%f), g), moved, error)
    if (allocated(error)) return
    call multiply_matrices(transposed(problem%h), moved, w, error)
    if (allocated(error)) return
    if (p > 0) then
      ! l = -S^-1 (G^T M^-1 (H r + f) + b)
      call multiply_matrices(transposed(g), moved, felt, error)
      if (allocated(error)) return
      s = columns_of(felt, m + 2, m + 1 + p)
      felt = with_column(columns_of(felt, 1, m), dense_column(felt, m + 1) + b)
      call solve_by_parts(s, 'G^T M^-1 G of the constraints', felt, reduced, error)
      if (allocated(error)) return
      call multiply_matrices(columns_of(w, m + 2, m + 1 + p), reduced, correction, error)
      if (allocated(error)) return
      w = sum_of(columns_of(w, 1, m + 1), -1.0_wp, correction)
    end if
    call set_local_form(problem, columns_of(w, 1, m), problem%offset + dense_column(w, m + 1))
  end subroutine condense_constrained

  !> Eliminate the constraints of a local form: W - V R^-1 V^T and q - V R^-1 s.
  subroutine eliminate_local(w, q, v, r, s, error)
    type(sparse_t), intent(inout) :: w !! W, shape (m, m)
    real(wp), intent(inout) :: q(:) !! q [m/s], shape (m)
    type(sparse_t), intent(in) :: v !! V, shape (m, p)
    type(sparse_t), intent(in) :: r !! R, shape (p, p)
    real(wp), intent(in) :: s(:) !! s, shape (p)
    type(error_t), allocatable, intent(out) :: error !! set when R cannot be inverted
    type(sparse_t) :: reduced, correction

    call solve_by_parts(r, 'the matrix R of the constraints', with_column(transposed(v), s), reduced, error)
    if (allocated(error)) return
    call multiply_matrices(v, reduced, correction, error)
    if (allocated(error)) return
    q = q - dense_column(correction, size(q) + 1)
    w = sum_of(w, -1.0_wp, columns_of(correction, 1, size(q)))
  end subroutine eliminate_local

  !> Velocity of the bodies and multipliers of the constraints that the impulses of a problem in global form cause.
  subroutine velocity_of(problem, g, b, v, l, error)
    type(matrix_problem_t), intent(in) :: problem !! problem with `mass`, `h`, `f` and impulses `r`
    type(sparse_t), intent(in) :: g !! directions of the constraints G, shape (dof, p)
    real(wp), intent(in) :: b(:) !! their offsets b, shape (p)
    real(wp), allocatable, intent(out) :: v(:) !! velocity of the bodies, shape (dof)
    real(wp), allocatable, intent(out) :: l(:) !! multipliers, shape (p)
    type(error_t), allocatable, intent(out) :: error !! set when M or G^T M^-1 G cannot be inverted
    type(sparse_t) :: moved, felt, reduced
    real(wp), allocatable :: momentum(:), pushed(:)
    integer :: p

    p = size(b)
    allocate (momentum(problem%h%n_rows), pushed(problem%h%n_rows), l(p), v(problem%h%n_rows))
    call multiply(problem%h, reshape(problem%r, [size(problem%r)]), momentum)
    call solve_by_parts(problem%mass, 'the mass matrix M', with_column(g, momentum + problem%f), moved, error)
    if (allocated(error)) return
    v = dense_column(moved, p + 1)
    if (p == 0) return
    call multiply_matrices(transposed(g), moved, felt, error)
    if (allocated(error)) return
    felt = with_column(columns_of(felt, 1, p), dense_column(felt, p + 1) + b)
    call solve_by_parts(columns_of(felt, 1, p), 'G^T M^-1 G of the constraints', columns_of(felt, p + 1, p + 1), reduced, error)
    if (allocated(error)) return
    l = -dense_column(reduced, 1)
    call multiply(columns_of(moved, 1, p), l, pushed)
    v = v + pushed
  end subroutine velocity_of

  !> Multipliers of the constraints of a local form, l = -R^-1 (V^T r + s).
  subroutine multipliers_of(v, r, s, impulse, l, error)
    type(sparse_t), intent(in) :: v !! V, shape (m, p)
    type(sparse_t), intent(in) :: r !! R, shape (p, p)
    real(wp), intent(in) :: s(:) !! s, shape (p)
    real(wp), intent(in) :: impulse(:) !! impulses of the contacts [N s], shape (m)
    real(wp), allocatable, intent(out) :: l(:) !! multipliers, shape (p)
    type(error_t), allocatable, intent(out) :: error !! set when R cannot be inverted
    type(sparse_t) :: reduced

    allocate (l(size(s)))
    call multiply_transposed(v, impulse, l)
    call solve_by_parts(r, 'the matrix R of the constraints', with_column(no_columns(size(s)), l + s), reduced, error)
    if (.not. allocated(error)) l = -dense_column(reduced, 1)
  end subroutine multipliers_of

  !> Give a problem its local form.
  subroutine set_local_form(problem, w, q)
    type(matrix_problem_t), intent(inout) :: problem !! problem whose `d` is set
    type(sparse_t), intent(in) :: w !! W, shape (m, m)
    real(wp), intent(in) :: q(:) !! q [m/s], shape (m)

    problem%n = size(q)/problem%d
    if (allocated(problem%q)) deallocate (problem%q)
    allocate (problem%q(problem%d, problem%n))
    problem%q = reshape(q, [problem%d, problem%n])
    call blocks_from_sparse(w, problem%d, problem%w)
    problem%is_symmetric = is_symmetric(w)
  end subroutine set_local_form

  !> A matrix of d by d blocks from one of single entries; places without an entry hold zero.
  pure subroutine blocks_from_sparse(matrix, d, blocks)
    type(sparse_t), intent(in) :: matrix !! square matrix, its side a multiple of d
    integer, intent(in) :: d !! side of a block
    type(blocks_t), intent(out) :: blocks !! the same matrix
    type(sparse_t) :: pattern
    integer(i4), allocatable :: place(:)
    integer :: i, k, e, n, column

    blocks%d = d
    blocks%n = matrix%n_rows/d
    call sparse_from_triplets(blocks%n, blocks%n, (rows_of(matrix) - 1_i4)/int(d, i4) + 1_i4, &
                              (matrix%column - 1_i4)/int(d, i4) + 1_i4, matrix%value, pattern)
    call move_alloc(pattern%first, blocks%first)
    call move_alloc(pattern%column, blocks%column)
    allocate (blocks%diagonal(blocks%n), place(blocks%n), source=0_i4)
    allocate (blocks%block(d, d, size(blocks%column)), source=0.0_wp)
    do i = 1, blocks%n
      do n = blocks%first(i), blocks%first(i + 1) - 1
        place(blocks%column(n)) = int(n, i4)
        if (blocks%column(n) == i) blocks%diagonal(i) = int(n, i4)
      end do
      do k = 1, d
        do e = matrix%first(d*(i - 1) + k), matrix%first(d*(i - 1) + k + 1) - 1
          column = matrix%column(e) - 1
          blocks%block(k, mod(column, d) + 1, place(column/d + 1)) = matrix%value(e)
        end do
      end do
    end do
  end subroutine blocks_from_sparse

  !> The single entries of a matrix of blocks; zeros within blocks are left out.
  pure function sparse_from_blocks(a) result(matrix)
    type(blocks_t), intent(in) :: a !! matrix of blocks
    type(sparse_t) :: matrix
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: i, e, k, l, n

    n = count(abs(a%block) > 0)
    allocate (row(n), column(n), value(n))
    n = 0
    do i = 1, a%n
      do e = a%first(i), a%first(i + 1) - 1
        do l = 1, a%d
          do k = 1, a%d
            if (.not. abs(a%block(k, l, e)) > 0) cycle
            n = n + 1
            row(n) = int(a%d*(i - 1) + k, i4)
            column(n) = int(a%d*(a%column(e) - 1) + l, i4)
            value(n) = a%block(k, l, e)
          end do
        end do
      end do
    end do
    call sparse_from_triplets(a%d*a%n, a%d*a%n, row, column, value, matrix)
  end function sparse_from_blocks

  !> Is a matrix symmetric to rounding?
  pure logical function is_symmetric(a)
    type(sparse_t), intent(in) :: a !! square matrix
    type(sparse_t) :: difference

    is_symmetric = .true.
    if (size(a%value) == 0) return
    difference = sum_of(a, -1.0_wp, transposed(a))
    is_symmetric = maxval(abs(difference%value)) <= symmetric_to*maxval(abs(a%value))
  end function is_symmetric
end module sg_condense
