!> Linear systems of interior points on several ranks: Cholesky factors of subdomains, and conjugate gradients for what their shared
!! bodies exchange (doc/theory/interior_point.md, "Several ranks").
!!
!! (M + H D H^T) dv = H D g with D = B^-1 is the sum over subdomains of the same with divided masses. Relative velocities follow
!! from impulses by velocities that are the mean over copies, so that a step has no other error than that of its direction.
module sg_rank_system
  use sg_comm, only: comm_t
  use sg_cone_system, only: cone_system_t
  use sg_error, only: error_t, exit_failure, fail
  use sg_interface, only: interface_t
  use sg_interface_cg, only: interface_cg_t, project
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: multiply, multiply_transposed, sparse_t
  use sg_subdomain_factor, only: subdomain_factor_t
  implicit none
  private
  public :: rank_system_t

  !> Differences between copies that conjugate gradients leave of those of the subdomains' own answers: at first, and at least
  real(wp), parameter :: first_tolerance = 1e-3_wp, least_tolerance = 1e-8_wp

  !> The systems of one rank
  type, extends(cone_system_t) :: rank_system_t
    !> H_E of the problem without units, masses, the factor, shared bodies with messages of their own, and the ranks
    type(sparse_t) :: h
    real(wp), allocatable :: mass(:)
    type(subdomain_factor_t) :: factor
    type(interface_t) :: interface
    type(comm_t) :: comm
    !> Components of a velocity
    integer :: width = 0
    !> Conjugate gradients, and D
    type(interface_cg_t) :: cg
    real(wp), allocatable, private :: blocks(:, :, :)
  contains
    procedure :: begin => rank_begin
    procedure :: tighten => rank_tighten
    procedure :: factorise => rank_factorise
    procedure :: solve => rank_solve
    procedure :: multiply => rank_multiply
    procedure :: add_up => rank_add_up
    procedure :: find_least => rank_find_least
  end type rank_system_t

contains

  !> Begin a solve: no iterations yet, of a loose tolerance.
  pure subroutine rank_begin(self)
    class(rank_system_t), intent(inout) :: self

    self%cg%tolerance = first_tolerance
    self%cg%iterations = 0
    self%cg%failures = 0
  end subroutine rank_begin

  !> Ask for more accurate directions.
  pure subroutine rank_tighten(self)
    class(rank_system_t), intent(inout) :: self

    self%cg%tolerance = max(least_tolerance, self%cg%tolerance/10)
  end subroutine rank_tighten

  !> Factorise the matrix of this subdomain. Collective; all ranks fail where one does.
  subroutine rank_factorise(self, scaled, has_identity, a, b, error)
    class(rank_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    logical, intent(in) :: has_identity !! must be true: the matrix of a shift is not symmetric
    real(wp), intent(in), contiguous :: a(:, :, :) !! A, shape (d, d, n)
    real(wp), intent(in), contiguous :: b(:, :, :) !! B^-1, shape (d, d, n)
    type(error_t), allocatable, intent(out) :: error !! why there are no factors
    type(error_t), allocatable :: own
    integer :: k

    if (allocated(self%blocks)) deallocate (self%blocks)
    allocate (self%blocks, mold=b)
    do k = 1, scaled%n
      self%blocks(:, :, k) = matmul(b(:, :, k), a(:, :, k))
    end do
    if (has_identity) call self%factor%factorise(self%blocks, own)
    if (self%comm%any(allocated(own) .or. .not. has_identity)) &
      call fail(error, 'a subdomain has no Cholesky factor', code=exit_failure)
    if (allocated(error)) return
    call self%cg%weigh(self%interface, self%factor, self%width, self%comm)
  end subroutine rank_factorise

  !> Solve (A W + B) dr = g. Collective.
  subroutine rank_solve(self, scaled, g, dr, du)
    class(rank_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    real(wp), intent(in), contiguous :: g(:, :) !! right-hand side, shape (d, n)
    real(wp), intent(out), contiguous :: dr(:, :) !! solution, shape (d, n)
    real(wp), intent(out), contiguous :: du(:, :) !! W dr, shape (d, n)
    real(wp), dimension(size(self%mass)) :: right, v, correction
    real(wp), dimension(self%width, size(self%interface%slot)) :: values, impulse
    real(wp) :: relative(size(g))
    integer :: k

    do k = 1, scaled%n
      dr(:, k) = matmul(self%blocks(:, :, k), g(:, k))
    end do
    call multiply(self%h, reshape(dr, [size(dr)]), right)
    call self%factor%solve(right, v)
    call self%factor%gather(v, values)
    call project(self%interface, self%factor, values, self%comm)
    call self%cg%solve(self%interface, self%factor, values, impulse, self%comm)
    call self%factor%spread(impulse, right)
    call self%factor%solve(right, correction)
    v = v - correction
    call multiply_transposed(self%h, v, relative)
    du = g - reshape(relative, shape(g))
    do k = 1, scaled%n
      dr(:, k) = matmul(self%blocks(:, :, k), du(:, k))
    end do
    call self%multiply(scaled, dr, du)
  end subroutine rank_solve

  !> Product u = W r. Collective.
  subroutine rank_multiply(self, scaled, r, u)
    class(rank_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    real(wp), intent(in), contiguous :: r(:, :) !! impulses, shape (d, n)
    real(wp), intent(out), contiguous :: u(:, :) !! relative velocities, shape (d, n)
    real(wp), dimension(size(self%mass)) :: v, change
    real(wp), dimension(self%width, size(self%interface%slot)) :: values
    real(wp) :: relative(size(r))

    call multiply(self%h, reshape(r, [size(r)]), v)
    v = v/self%mass
    ! Less what copies have above their mean.
    call self%factor%gather(v, values)
    call self%interface%balance(values, self%comm)
    call self%factor%spread(values, change)
    v = v - change
    call multiply_transposed(self%h, v, relative)
    u = reshape(relative, shape(u))
  end subroutine rank_multiply

  !> Sum values over all ranks.
  subroutine rank_add_up(self, values)
    class(rank_system_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:) !! of the contacts here, then of all

    call self%comm%sum(values)
  end subroutine rank_add_up

  !> Find the least value of all ranks.
  subroutine rank_find_least(self, value)
    class(rank_system_t), intent(inout) :: self
    real(wp), intent(inout) :: value !! of the contacts here, then of all

    call self%comm%minimum(value)
  end subroutine rank_find_least
end module sg_rank_system
