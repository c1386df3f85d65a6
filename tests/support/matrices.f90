!> Matrices of tests: random ones, full and sparse, and FCLIB files written by hand in any storage.
module matrices
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i4
  use sg_random, only: random_t
  use sg_sparse, only: sparse_from_triplets, sparse_t
  implicit none
  private
  public :: some_matrix, heavy_matrix, some_list, sparse, full, solved, put_matrix, put_local, put_global
  public :: triplets, columns, rows, roomy, exchanged

  !> Storages: triplets, columns or rows compressed, triplets with room to spare, triplets with rows and columns exchanged
  integer, parameter :: triplets = 0, columns = -1, rows = -2, roomy = 1, exchanged = 2

contains

  !> A random matrix with an entry in some places.
  function some_matrix(random, m, n, share) result(a)
    type(random_t), intent(inout) :: random !! stream of random numbers
    integer, intent(in) :: m, n
    real(wp), intent(in) :: share
    real(wp) :: a(m, n)
    integer :: i, j

    a = 0
    do j = 1, n
      do i = 1, m
        if (random%uniform() < share) a(i, j) = random%uniform(-1.0_wp, 1.0_wp)
      end do
    end do
  end function some_matrix

  !> A random list.
  function some_list(random, n) result(x)
    type(random_t), intent(inout) :: random !! stream of random numbers
    integer, intent(in) :: n
    real(wp) :: x(n)
    integer :: i

    do i = 1, n
      x(i) = random%uniform(-1.0_wp, 1.0_wp)
    end do
  end function some_list

  !> The sparse matrix of a full one.
  function sparse(a) result(matrix)
    real(wp), intent(in) :: a(:, :)
    type(sparse_t) :: matrix
    integer :: i, j
    integer(i4), allocatable :: row(:), column(:)

    row = [((int(i, i4), i=1, size(a, 1)), j=1, size(a, 2))]
    column = [((int(j, i4), i=1, size(a, 1)), j=1, size(a, 2))]
    call sparse_from_triplets(size(a, 1), size(a, 2), pack(row, reshape(abs(a) > 0, [size(a)])), &
                              pack(column, reshape(abs(a) > 0, [size(a)])), pack(a, abs(a) > 0), matrix)
  end function sparse

  !> The full matrix of a sparse one.
  function full(matrix) result(a)
    type(sparse_t), intent(in) :: matrix
    real(wp) :: a(matrix%n_rows, matrix%n_columns)
    integer :: i, e

    a = 0
    do i = 1, matrix%n_rows
      do e = matrix%first(i), matrix%first(i + 1) - 1
        a(i, matrix%column(e)) = matrix%value(e)
      end do
    end do
  end function full

  !> The solution of a small full system, by elimination without exchange of a matrix whose diagonal is heavy.
  function solved(a, b) result(x)
    real(wp), intent(in) :: a(:, :), b(:, :)
    real(wp) :: x(size(b, 1), size(b, 2)), rest(size(a, 1), size(a, 2))
    integer :: i, k

    rest = a
    x = b
    do k = 1, size(a, 1)
      x(k, :) = x(k, :)/rest(k, k)
      rest(k, :) = rest(k, :)/rest(k, k)
      do i = 1, size(a, 1)
        if (i == k) cycle
        x(i, :) = x(i, :) - rest(i, k)*x(k, :)
        rest(i, :) = rest(i, :) - rest(i, k)*rest(k, :)
      end do
    end do
  end function solved

  !> A random matrix that `solved` takes.
  function heavy_matrix(random, n) result(a)
    type(random_t), intent(inout) :: random !! stream of random numbers
    integer, intent(in) :: n
    real(wp) :: a(n, n)
    integer :: i

    a = some_matrix(random, n, n, 1.0_wp)
    do i = 1, n
      a(i, i) = real(n, wp) + random%uniform()
    end do
  end function heavy_matrix

  !> Write a matrix in some storage.
  subroutine put_matrix(file, path, a, storage)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(in) :: a(:, :)
    integer, intent(in) :: storage
    integer(i4), allocatable :: i(:), p(:)
    real(wp), allocatable :: x(:)
    integer :: k, l, n

    ! Zeros of the first column are stored too.
    n = count(abs(a) > 0) + count(.not. abs(a(:, :min(1, size(a, 2)))) > 0)
    allocate (i(0), p(0), x(0))
    if (storage == rows .or. storage == columns) p = [0_i4]
    if (storage == rows) then
      do k = 1, size(a, 1)
        do l = size(a, 2), 1, -1
          if (abs(a(k, l)) > 0 .or. l == 1) i = [i, int(l - 1, i4)]
          if (abs(a(k, l)) > 0 .or. l == 1) x = [x, a(k, l)]
        end do
        p = [p, size(i, kind=i4)]
      end do
    else
      do l = 1, size(a, 2)
        do k = 1, size(a, 1)
          if (.not. (abs(a(k, l)) > 0 .or. l == 1)) cycle
          i = [i, int(k - 1, i4)]
          x = [x, a(k, l)]
          if (storage /= columns) p = [p, int(l - 1, i4)]
        end do
        if (storage == columns) p = [p, size(i, kind=i4)]
      end do
    end if
    if (storage == roomy) then
      i = [i, 77_i4]
      p = [p, -3_i4]
      x = [x, 9.0_wp]
    end if
    call file%group(path)
    call file%put(path//'/nzmax', [int(n + merge(1, 0, storage == roomy), i4)])
    call file%put(path//'/m', [size(a, 1, kind=i4)])
    call file%put(path//'/n', [size(a, 2, kind=i4)])
    call file%put(path//'/nz', [int(merge(storage, n, storage < 0), i4)])
    call file%put(path//merge('/p', '/i', storage == exchanged), i)
    call file%put(path//merge('/i', '/p', storage == exchanged), p)
    call file%put(path//'/x', x)
  end subroutine put_matrix

  !> Write the local form of a problem by hand.
  subroutine put_local(file, d, w, q, mu, storage)
    type(hdf5_file_t), intent(inout) :: file
    integer, intent(in) :: d, storage
    real(wp), intent(in) :: w(:, :), q(:), mu(:)

    call file%group('/fclib_local')
    call file%put('/fclib_local/spacedim', [int(d, i4)])
    call put_matrix(file, '/fclib_local/W', w, storage)
    call file%group('/fclib_local/vectors')
    call file%put('/fclib_local/vectors/q', q)
    call file%put('/fclib_local/vectors/mu', mu)
  end subroutine put_local

  !> Write the global form of a problem by hand.
  subroutine put_global(file, d, m, h, f, w, mu, storage)
    type(hdf5_file_t), intent(inout) :: file
    integer, intent(in) :: d, storage
    real(wp), intent(in) :: m(:, :), h(:, :), f(:), w(:), mu(:)

    call file%group('/fclib_global')
    call file%put('/fclib_global/spacedim', [int(d, i4)])
    call put_matrix(file, '/fclib_global/M', m, merge(triplets, storage, storage == exchanged))
    call put_matrix(file, '/fclib_global/H', h, storage)
    call file%group('/fclib_global/vectors')
    call file%put('/fclib_global/vectors/f', f)
    call file%put('/fclib_global/vectors/w', w)
    call file%put('/fclib_global/vectors/mu', mu)
  end subroutine put_global
end module matrices
