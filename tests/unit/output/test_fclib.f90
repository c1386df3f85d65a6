!> FCLIB files: what is written is read again, all storages hold the same matrix, constraints vanish as they should, bad files
!! give one sentence each, and real files hold what their lists say.
program test_fclib
  use harness, only: tests_t
  use matrices, only: columns, exchanged, full, heavy_matrix, put_global, put_local, put_matrix, roomy, rows, solved, some_list, &
                      some_matrix, sparse, triplets
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use fclib_of_problem, only: write_fclib
  use sg_condense, only: condense, sparse_from_blocks
  use sg_error, only: error_t, exit_bad_input
  use sg_fclib_read, only: read_fclib
  use sg_fclib_write, only: write_solution
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_random, only: random_t
  use sg_sparse, only: multiply
  use sg_system, only: file_exists, make_folder
  use written_files, only: shared_folder
  implicit none
  character(len=*), parameter :: folder = 'fclib'
  type(tests_t) :: t
  type(random_t) :: random

  call random%seed(5)
  call t%check(make_folder(folder), 'the folder is there')
  if (hdf5_is_available()) then
    call test_round_trip(2)
    call test_round_trip(3)
    call test_storages()
    call test_no_contacts()
    call test_local_constraints()
    call test_global_constraints()
    call test_guess()
    call test_solution()
    call test_real_files()
  else
    call test_without_library()
  end if
  call t%finish()

contains

  !> A problem of some contacts on bodies of six unknowns each, in both forms.
  function some_problem(d, n, n_bodies) result(problem)
    integer, intent(in) :: d, n, n_bodies
    type(matrix_problem_t) :: problem
    type(error_t), allocatable :: error
    real(wp) :: mass(6*n_bodies, 6*n_bodies), part(6, 6), square(6, 6)
    integer :: b

    mass = 0
    do b = 1, 6*n_bodies, 6
      part = some_matrix(random, 6, 6, 1.0_wp)
      square = matmul(part, transpose(part))
      mass(b:b + 5, b:b + 5) = square
      mass(b, b) = mass(b, b) + 1
    end do
    problem%d = d
    problem%n = n
    problem%mass = sparse(mass)
    problem%h = sparse(some_matrix(random, 6*n_bodies, d*n, 0.4_wp))
    problem%f = some_list(random, 6*n_bodies)
    problem%offset = some_list(random, d*n)
    problem%friction = abs(some_list(random, n))
    problem%has_global = .true.
    allocate (problem%r(d, n), source=0.0_wp)
    problem%r = reshape(some_list(random, d*n), [d, n])
    call condense(problem, error)
    call t%check(.not. allocated(error), 'a problem can be condensed')
  end function some_problem

  !> Read a file that must be right.
  function read_right(name, with_guess, expects_guess) result(problem)
    character(len=*), intent(in) :: name
    logical, intent(in) :: with_guess, expects_guess
    type(matrix_problem_t) :: problem
    type(error_t), allocatable :: error
    logical :: has_guess

    call read_fclib(name, with_guess, problem, has_guess, error)
    if (allocated(error)) write (*, '(a)') error%report()
    call t%check(.not. allocated(error), 'read: '//name)
    call t%check(has_guess .eqv. expects_guess, 'guess: '//name)
  end function read_right

  !> Both forms are read as they were written.
  subroutine test_round_trip(d)
    integer, intent(in) :: d
    type(matrix_problem_t) :: problem, local, global
    type(error_t), allocatable :: error
    type(hdf5_file_t) :: file
    real(wp), allocatable :: guess(:, :), u(:, :)
    real(wp), allocatable :: stored(:)

    problem = some_problem(d, 7, 4)
    allocate (guess(d, 7), u(d, 7))
    guess = 2*problem%r
    call write_fclib(folder//'/some', problem, 'a test', 'random numbers', .true., error, guess)
    call t%check(.not. allocated(error), 'both forms are written')
    local = read_right(folder//'/some-local.hdf5', .true., .true.)
    call t%equal(local%d, d, 'round trip: dimension')
    call t%equal(local%n, 7, 'round trip: contacts')
    call t%check(.not. local%has_global .and. local%is_symmetric, 'round trip: local and symmetric')
    call t%near(maxval(abs(local%q - problem%q)), 0.0_wp, 0.0_wp, 'round trip: q')
    call t%near(maxval(abs(local%friction - problem%friction)), 0.0_wp, 0.0_wp, 'round trip: friction')
    call t%near(maxval(abs(local%w%block - problem%w%block)), 0.0_wp, 0.0_wp, 'round trip: W')
    call t%near(maxval(abs(local%r - guess)), 0.0_wp, 0.0_wp, 'round trip: guess')
    call t%check(all(local%w%column(local%w%diagonal) == [1, 2, 3, 4, 5, 6, 7]), 'round trip: diagonal')
    global = read_right(folder//'/some-global.hdf5', .false., .false.)
    call t%check(global%has_global, 'round trip: global')
    call t%near(maxval(abs(full(global%mass) - full(problem%mass))), 0.0_wp, 0.0_wp, 'round trip: M')
    call t%near(maxval(abs(full(global%h) - full(problem%h))), 0.0_wp, 0.0_wp, 'round trip: H')
    call t%near(maxval(abs(global%f - problem%f)), 0.0_wp, 0.0_wp, 'round trip: f')
    call t%near(maxval(abs(global%offset - problem%offset)), 0.0_wp, 0.0_wp, 'round trip: w')
    call t%near(maxval(abs(global%w%block - problem%w%block)), 0.0_wp, 0.0_wp, 'round trip: W of the global form')
    call t%near(maxval(abs(global%r)), 0.0_wp, 0.0_wp, 'round trip: no guess unless asked for')

    call file%open(folder//'/some-global.hdf5', .true.)
    call file%get('/solution/r', stored)
    call t%near(maxval(abs(stored - reshape(problem%r, [7*d]))), 0.0_wp, 0.0_wp, 'round trip: solution')
    call file%get('/solution/u', stored)
    call multiply(problem%w, problem%r, u)
    call t%near(maxval(abs(stored - reshape(u + problem%q, [7*d]))), 0.0_wp, 0.0_wp, 'round trip: velocities of the solution')
    call file%get('/solution/v', stored)
    ! M may have a condition of 10^3, so rounding leaves 10^-13 of the terms.
    call t%near(maxval(abs(matmul(full(problem%mass), stored) - problem%f &
                           - matmul(full(problem%h), reshape(problem%r, [7*d])))), 0.0_wp, 1e-11_wp, 'round trip: M v = H r + f')
    call file%close()
    call t%check(.not. allocated(file%error), 'round trip: all is there')
  end subroutine test_round_trip

  !> Largest difference between a problem's W and a full matrix, and between q and a list.
  real(wp) function distance(problem, w, q)
    type(matrix_problem_t), intent(in) :: problem
    real(wp), intent(in) :: w(:, :), q(:)

    distance = huge(distance)
    if (.not. allocated(problem%q)) return
    distance = max(maxval(abs(full(sparse_from_blocks(problem%w)) - w)), maxval(abs(reshape(problem%q, [size(q)]) - q)))
  end function distance

  !> The same matrices in every storage, an unsymmetric W among them.
  subroutine test_storages()
    integer, parameter :: storage(5) = [triplets, columns, rows, roomy, exchanged]
    type(hdf5_file_t) :: file
    type(matrix_problem_t) :: problem
    real(wp) :: w(9, 9), m(6, 6), h(6, 9), inverse(6, 6)
    integer :: i, k

    w = some_matrix(random, 9, 9, 0.4_wp)
    m = 0
    inverse = 0
    do k = 1, 6
      m(k, k) = 2.0_wp**k
      inverse(k, k) = 0.5_wp**k
    end do
    h = some_matrix(random, 6, 9, 0.5_wp)
    h(6, 9) = 1
    do i = 1, size(storage)
      call file%create(folder//'/storage.hdf5')
      ! Exchanged indices of a square matrix cannot be told from others.
      call put_local(file, 3, w, [1.0_wp, some_list(random, 8)], [0.0_wp, 0.3_wp, 7.0_wp], &
                     merge(rows, storage(i), storage(i) == exchanged))
      call file%close()
      problem = read_right(folder//'/storage.hdf5', .false., .false.)
      call t%near(maxval(abs(full(sparse_from_blocks(problem%w)) - w)), 0.0_wp, 0.0_wp, 'storage: W whole')
      call t%check(.not. problem%is_symmetric, 'storage: W is not symmetric')
      call t%near(problem%friction(3), 7.0_wp, 0.0_wp, 'storage: friction of each contact')
      call file%create(folder//'/storage.hdf5')
      call put_global(file, 3, m, h, m(:, 1), w(1, :), [0.1_wp, 0.1_wp, 0.1_wp], storage(i))
      call file%close()
      problem = read_right(folder//'/storage.hdf5', .false., .false.)
      call t%near(distance(problem, matmul(transpose(h), matmul(inverse, h)), w(1, :) + h(1, :)), 0.0_wp, 1e-14_wp, &
                  'storage: W and q condensed, to rounding')
    end do
  end subroutine test_storages

  !> A problem without contacts is a problem.
  subroutine test_no_contacts()
    type(hdf5_file_t) :: file
    type(matrix_problem_t) :: problem
    real(wp) :: none(0, 0), nothing(0)
    type(error_t), allocatable :: error

    call file%create(folder//'/none.hdf5')
    call put_local(file, 3, none, nothing, nothing, triplets)
    call file%close()
    problem = read_right(folder//'/none.hdf5', .true., .false.)
    call t%equal(problem%n, 0, 'no contacts')
    call write_fclib(folder//'/none', problem, 'none', '', .true., error)
    call t%check(.not. allocated(error), 'no contacts: written')
    problem = read_right(folder//'/none-local.hdf5', .true., .false.)
    call t%equal(problem%n, 0, 'no contacts: read again')
  end subroutine test_no_contacts

  !> V, R and s of a local form are eliminated, and the multipliers of a solution obey them.
  subroutine test_local_constraints()
    type(hdf5_file_t) :: file
    type(matrix_problem_t) :: problem
    type(error_t), allocatable :: error
    real(wp) :: w(6, 6), q(6), v(6, 2), r(2, 2), s(2), impulse(6), w_free(6, 6), q_free(6)
    real(wp), allocatable :: l(:), u(:)

    w = some_matrix(random, 6, 6, 0.6_wp)
    q = some_list(random, 6)
    v = some_matrix(random, 6, 2, 0.7_wp)
    r = heavy_matrix(random, 2)
    s = some_list(random, 2)
    call file%create(folder//'/joined.hdf5')
    call put_local(file, 2, w, q, [0.1_wp, 0.2_wp, 0.3_wp], rows)
    call put_matrix(file, '/fclib_local/V', v, columns)
    call put_matrix(file, '/fclib_local/R', r, triplets)
    call file%put('/fclib_local/vectors/s', s)
    call file%close()
    problem = read_right(folder//'/joined.hdf5', .false., .false.)
    w_free = w - matmul(v, solved(r, transpose(v)))
    q_free = q - matmul(v, reshape(solved(r, reshape(s, [2, 1])), [2]))
    call t%near(distance(problem, w_free, q_free), 0.0_wp, 1e-13_wp, 'local constraints: W and q, to rounding')
    impulse = some_list(random, 6)
    call write_solution(folder//'/joined.hdf5', reshape(impulse, [2, 3]), .false., error)
    call t%check(.not. allocated(error), 'local constraints: solution written')
    call file%open(folder//'/joined.hdf5', .true.)
    call file%get('/solution/l', l)
    call file%get('/solution/u', u)
    call t%near(maxval(abs(matmul(transpose(v), impulse) + matmul(r, l) + s)), 0.0_wp, 1e-13_wp, 'local constraints: obeyed')
    call t%near(maxval(abs(matmul(w, impulse) + q + matmul(v, l) - u)), 0.0_wp, 1e-13_wp, 'local constraints: velocities')
    call file%close()
  end subroutine test_local_constraints

  !> G and b of a global form are eliminated, and velocities and multipliers of a solution obey all equations.
  subroutine test_global_constraints()
    type(hdf5_file_t) :: file
    type(matrix_problem_t) :: problem
    type(error_t), allocatable :: error
    real(wp) :: m(8, 8), h(8, 6), g(8, 3), f(8), w(6), b(3), impulse(6)
    real(wp), allocatable :: v(:), l(:), u(:)

    m = heavy_matrix(random, 8)
    m(:4, 5:) = 0
    m(5:, :4) = 0
    h = some_matrix(random, 8, 6, 0.6_wp)
    g = some_matrix(random, 8, 3, 0.8_wp)
    f = some_list(random, 8)
    w = some_list(random, 6)
    b = some_list(random, 3)
    impulse = some_list(random, 6)
    call file%create(folder//'/joined.hdf5')
    call put_global(file, 3, m, h, f, w, [0.1_wp, 0.2_wp], triplets)
    call put_matrix(file, '/fclib_global/G', g, rows)
    call file%put('/fclib_global/vectors/b', b)
    call file%close()
    problem = read_right(folder//'/joined.hdf5', .false., .false.)
    call t%check(.not. problem%has_global, 'global constraints: W alone is left')
    call write_solution(folder//'/joined.hdf5', reshape(impulse, [3, 2]), .false., error)
    call t%check(.not. allocated(error), 'global constraints: solution written')
    call file%open(folder//'/joined.hdf5', .true.)
    call file%get('/solution/v', v)
    call file%get('/solution/l', l)
    call file%get('/solution/u', u)
    call file%close()
    ! All numbers are about one, and S = G^T M^-1 G has a condition below 10^2.
    call t%near(maxval(abs(matmul(m, v) - matmul(h, impulse) - f - matmul(g, l))), 0.0_wp, 1e-12_wp, 'global constraints: momentum')
    call t%near(maxval(abs(matmul(transpose(g), v) + b)), 0.0_wp, 1e-12_wp, 'global constraints: obeyed')
    call t%near(maxval(abs(matmul(transpose(h), v) + w - u)), 0.0_wp, 1e-12_wp, 'global constraints: velocities by W and q')
  end subroutine test_global_constraints

  !> The first guess that is finite and not zero is taken, when asked for.
  subroutine test_guess()
    type(hdf5_file_t) :: file
    type(matrix_problem_t) :: problem
    integer :: i

    call file%create(folder//'/guess.hdf5')
    call put_local(file, 2, reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2]), [1.0_wp, 2.0_wp], [0.5_wp], rows)
    call file%group('/guesses')
    call file%put('/guesses/number_of_guesses', [3_i4])
    do i = 1, 3
      call file%group('/guesses/'//achar(48 + i))
    end do
    call file%put('/guesses/1/r', [0.0_wp, 0.0_wp])
    call file%put('/guesses/2/r', [1.0_wp, ieee_value(1.0_wp, ieee_quiet_nan)])
    call file%put('/guesses/3/r', [4.0_wp, -1.0_wp])
    call file%close()
    problem = read_right(folder//'/guess.hdf5', .true., .true.)
    call t%near(maxval(abs(problem%r - reshape([4.0_wp, -1.0_wp], [2, 1]))), 0.0_wp, 0.0_wp, 'guess: the usable one')
    problem = read_right(folder//'/guess.hdf5', .false., .false.)
    call t%near(maxval(abs(problem%r)), 0.0_wp, 0.0_wp, 'guess: none unless asked for')
  end subroutine test_guess

  !> A solution is added to a file; a usable one is replaced by force alone, one of zeros in any case.
  subroutine test_solution()
    type(hdf5_file_t) :: file
    type(error_t), allocatable :: error
    type(matrix_problem_t) :: problem
    real(wp), allocatable :: stored(:)

    call file%create(folder//'/solution.hdf5')
    call put_local(file, 2, reshape([2.0_wp, 0.0_wp, 0.0_wp, 2.0_wp], [2, 2]), [-1.0_wp, 0.0_wp], [0.5_wp], rows)
    call file%group('/solution')
    call file%put('/solution/r', [0.0_wp, 0.0_wp])
    call file%close()
    call write_solution(folder//'/solution.hdf5', reshape([0.5_wp, 0.0_wp], [2, 1]), .false., error)
    call t%check(.not. allocated(error), 'solution: zeros are replaced')
    call write_solution(folder//'/solution.hdf5', reshape([9.5_wp, 0.0_wp], [2, 1]), .false., error)
    call t%check(allocated(error), 'solution: another is not replaced')
    if (allocated(error)) call t%check(index(error%message, '--force') > 0 .and. error%code == exit_bad_input, 'solution: why not')
    call file%open(folder//'/solution.hdf5', .true.)
    call file%get('/solution/r', stored)
    call t%near(stored(1), 0.5_wp, 0.0_wp, 'solution: still the first')
    call file%close()
    call write_solution(folder//'/solution.hdf5', reshape([9.5_wp, 0.0_wp], [2, 1]), .true., error)
    call t%check(.not. allocated(error), 'solution: replaced by force')
    call file%open(folder//'/solution.hdf5', .true.)
    call file%get('/solution/r', stored)
    call t%near(stored(1), 9.5_wp, 0.0_wp, 'solution: now the second')
    call file%get('/solution/u', stored)
    call t%near(stored(1), 18.0_wp, 0.0_wp, 'solution: with its velocities')
    call file%close()
    problem = read_right(folder//'/solution.hdf5', .true., .false.)
    call t%equal(problem%n, 1, 'solution: the problem is whole')
  end subroutine test_solution

  !> Real files: contacts as listed, and local and global form of one problem are the same.
  subroutine test_real_files()
    character(len=*), parameter :: names(3) = [character(len=36) :: 'Box_Stacks-i0122-82-5', 'Spheres-i099-356-679', &
                                               'spheres-in-a-box-98-i10000-256-10']
    integer, parameter :: contacts(3) = [82, 356, 256]
    type(matrix_problem_t) :: local, global
    character(len=:), allocatable :: place
    integer :: i

    place = shared_folder()//'/problems'
    if (.not. file_exists(place//'/global/Box_Stacks-i0122-82-5.hdf5')) then
      write (*, '(a)') 'no real problems here: '//place
      return
    end if
    do i = 1, size(names)
      local = read_right(place//'/'//trim(names(i))//'.hdf5', .false., .false.)
      global = read_right(place//'/global/'//trim(names(i))//'.hdf5', .false., .false.)
      call t%equal(local%n, contacts(i), 'real files: contacts of '//trim(names(i)))
      call t%equal(global%n, contacts(i), 'real files: contacts of the global form')
      call t%near(distance(global, full(sparse_from_blocks(local%w)), reshape(local%q, [size(local%q)])) &
                  /maxval(abs(local%w%block)), 0.0_wp, 1e-12_wp, 'real files: both forms are one problem')
    end do
  end subroutine test_real_files

  !> Without the library reading and writing are one clear error each.
  subroutine test_without_library()
    type(matrix_problem_t) :: problem
    type(error_t), allocatable :: error
    logical :: has_guess

    call read_fclib('CMakeCache.txt', .false., problem, has_guess, error)
    call t%check(allocated(error), 'without HDF5: error')
    problem = some_problem(2, 2, 1)
    call write_fclib(folder//'/some', problem, '', '', .false., error)
    call t%check(allocated(error), 'without HDF5: error of writing')
    if (allocated(error)) call t%check(index(error%message, 'without HDF5') > 0, 'without HDF5: why')
  end subroutine test_without_library
end program test_fclib
