!> Gauss-Seidel sweeps with Anderson's acceleration [Anderson1965]: the next impulses are the combination of the last
!! sweeps whose changes nearly cancel (doc/theory/solvers_sweeps.md).
module sg_accelerated_nlgs
  use sg_block_map, only: project_all
  use sg_block_progress, only: progress_t
  use sg_block_scaling, only: scale_problem
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_matrix_sweeps, only: sweep
  use sg_report, only: report_t
  implicit none
  private
  public :: accelerated_nlgs_t, anderson_t, accelerated_state_t, sweep_accelerated

  !> Settings of the acceleration
  type :: anderson_t
    !> Sweeps that are remembered
    integer :: memory = 20
    !> Growth of the change of a sweep, over the least since the start of the memory, at which the memory is given up
    real(wp) :: most_growth = 2
    !> What is added to the diagonal of the least-squares system, over its trace
    real(wp) :: regularisation = 1e-10_wp
    !> Sweeps between two tests
    integer :: check_every = 10
  end type anderson_t

  !> Accelerated sweeps; an iteration is one sweep
  type, extends(matrix_solver_t) :: accelerated_nlgs_t
    type(anderson_t) :: anderson
  contains
    procedure :: solve => accelerated_nlgs_solve
  end type accelerated_nlgs_t

  !> The last sweeps: changes of their change and of their result, one layer each, products of the former with each other,
  !! and with the change of the last sweep
  type :: memory_t
    integer :: used = 0, newest = 0
    real(wp), allocatable :: change(:, :, :), result(:, :, :), products(:, :), right(:)
  end type memory_t

  !> Where accelerated sweeps stand between two turns
  type :: accelerated_state_t
    private
    !> Impulses to sweep from, and those of the last sweep that was kept
    real(wp), allocatable :: r(:, :), good(:, :)
    !> Result and change of the last sweep, if there is one; the least change since the start of the memory
    real(wp), allocatable :: last_swept(:, :), last_change(:, :)
    real(wp) :: least = huge(1.0_wp)
    logical :: has_last = .false.
    type(memory_t) :: memory
  end type accelerated_state_t

contains

  !> Accelerated sweeps until e1 is small enough.
  subroutine accelerated_nlgs_solve(self, problem, report)
    class(accelerated_nlgs_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(matrix_problem_t) :: scaled
    type(progress_t) :: progress
    type(accelerated_state_t) :: state
    real(wp), allocatable :: scale(:)

    call progress%begin(problem, self%options)
    if (.not. progress%is_over) then
      allocate (scale(problem%n))
      call scale_problem(problem, scaled, scale)
      call sweep_accelerated(self%anderson, problem, scaled, scale, self%options%maximum_iterations, state, progress)
    end if
    call progress%finish(problem, report)
  end subroutine accelerated_nlgs_solve

  !> So many accelerated sweeps, or fewer where that ends the solve or the turn; `scaled` holds the impulses.
  subroutine sweep_accelerated(settings, problem, scaled, scale, most, state, progress)
    type(anderson_t), intent(in) :: settings !! settings of the acceleration
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    type(matrix_problem_t), intent(inout) :: scaled !! the same without units; holds the guess of a new state, gets the impulses
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    integer, intent(in) :: most !! sweeps
    type(accelerated_state_t), intent(inout) :: state !! where the sweeps stand
    type(progress_t), intent(inout) :: progress !! how far the solve has come
    real(wp), allocatable :: swept(:, :), change(:, :)
    integer :: i

    call begin_state(settings, scaled, state)
    allocate (swept, change, mold=state%r)
    associate (r => state%r, memory => state%memory)
      do i = 1, most
        if (progress%must_yield()) exit
        swept = r
        call sweep(scaled, swept)
        call progress%count_sweeps(1, others=real(6*memory%used + 10, wp)*real(size(r), wp))
        change = swept - r
        call next_guess(settings, scaled%friction, swept, change, state)
        if (modulo(i, settings%check_every) == 0 .or. i == most) call progress%look(problem, state%good, scale)
        if (progress%iterations >= progress%options%maximum_iterations) exit
      end do
    end associate
    scaled%r = state%good
  end subroutine sweep_accelerated

  !> Make room for a state that has none, at the guess.
  subroutine begin_state(settings, scaled, state)
    type(anderson_t), intent(in) :: settings
    type(matrix_problem_t), intent(in) :: scaled
    type(accelerated_state_t), intent(inout) :: state

    if (allocated(state%r)) return
    associate (d => scaled%d, n => scaled%n, most => settings%memory)
      allocate (state%memory%change(d, n, most), state%memory%result(d, n, most))
      allocate (state%memory%products(most, most), state%memory%right(most))
      allocate (state%last_swept(d, n), state%last_change(d, n))
    end associate
    state%r = scaled%r
    state%good = scaled%r
  end subroutine begin_state

  !> Impulses to sweep from next: the combination of the last sweeps, or the last one that was kept where the change has grown.
  subroutine next_guess(settings, friction, swept, change, state)
    type(anderson_t), intent(in) :: settings
    real(wp), intent(in), contiguous :: friction(:), swept(:, :), change(:, :)
    type(accelerated_state_t), intent(inout) :: state
    real(wp) :: norm

    norm = sqrt(sum(change**2))
    if (state%memory%used > 0 .and. .not. norm/settings%most_growth <= state%least) then
      state%memory%used = 0
      state%has_last = .false.
      state%least = huge(norm)
      state%r = state%good
      return
    end if
    state%least = min(state%least, norm)
    state%good = swept
    if (state%has_last) call remember(state%memory, change, state%last_change, swept, state%last_swept)
    state%has_last = .true.
    state%last_swept = swept
    state%last_change = change
    state%r = swept
    if (state%memory%used == 0) return
    call combine(state%memory, settings%regularisation, state%r)
    call project_all(friction, state%r)
  end subroutine next_guess

  !> Add one sweep to the memory, over the oldest where it is full.
  pure subroutine remember(memory, change, last_change, swept, last_swept)
    type(memory_t), intent(inout) :: memory
    real(wp), intent(in), contiguous :: change(:, :), last_change(:, :), swept(:, :), last_swept(:, :)
    integer :: j, k

    k = modulo(memory%newest, size(memory%right)) + 1
    if (memory%used == 0) k = 1
    memory%newest = k
    memory%used = min(memory%used + 1, size(memory%right))
    memory%change(:, :, k) = change - last_change
    memory%result(:, :, k) = swept - last_swept
    do j = 1, memory%used
      call two_products(size(change), memory%change(:, :, j), memory%change(:, :, k), change, memory%products(j, k), &
                        memory%right(j))
      memory%products(k, j) = memory%products(j, k)
    end do
  end subroutine remember

  !> Products of x with y and with z; four sums each, since one alone waits for itself.
  pure subroutine two_products(n, x, y, z, xy, xz)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n), y(n), z(n)
    real(wp), intent(out) :: xy, xz
    real(wp) :: a(4), b(4)
    integer :: i

    a = 0
    b = 0
    do i = 1, n - 3, 4
      a = a + x(i:i + 3)*y(i:i + 3)
      b = b + x(i:i + 3)*z(i:i + 3)
    end do
    do i = n - modulo(n, 4) + 1, n
      a(1) = a(1) + x(i)*y(i)
      b(1) = b(1) + x(i)*z(i)
    end do
    xy = sum(a)
    xz = sum(b)
  end subroutine two_products

  !> Take the least-squares combination of the memory off the result of the last sweep.
  pure subroutine combine(memory, regularisation, r)
    type(memory_t), intent(in) :: memory
    real(wp), intent(in) :: regularisation
    real(wp), intent(inout), contiguous :: r(:, :)
    real(wp) :: a(memory%used, memory%used), x(memory%used), shift
    integer :: m, i, j

    m = memory%used
    a = memory%products(:m, :m)
    x = memory%right(:m)
    shift = tiny(shift)
    do i = 1, m
      shift = shift + regularisation*a(i, i)
    end do
    ! Cholesky's factors; a pivot that rounding spoiled leaves its sweep out.
    do j = 1, m
      a(j, j) = a(j, j) + shift - sum(a(j, :j - 1)**2)
      if (.not. a(j, j) > shift/2) a(j, j) = huge(shift)
      a(j, j) = sqrt(a(j, j))
      do i = j + 1, m
        a(i, j) = (a(i, j) - dot_product(a(i, :j - 1), a(j, :j - 1)))/a(j, j)
      end do
      x(j) = (x(j) - dot_product(a(j, :j - 1), x(:j - 1)))/a(j, j)
    end do
    do j = m, 1, -1
      x(j) = (x(j) - dot_product(a(j + 1:, j), x(j + 1:)))/a(j, j)
      r = r - x(j)*memory%result(:, :, j)
    end do
  end subroutine combine
end module sg_accelerated_nlgs
