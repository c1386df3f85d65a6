!> Matrix M_E + H_E D H_E^T of a subdomain, its factor, and what it makes of values of shared bodies (doc/theory/enriched.md).
!!
!! Masses of shared bodies are divided among copies, so that the sum over subdomains is M + H D H^T of the whole problem. With
!! D = 1/eta it is the matrix M_eta,E of the enriched interface; with D = K^-1 that of a step of interior points. A solver that has
!! H_E and M_E as matrices calls `prepare` once per problem and `factorise` once per D. A system (sum of A_E) x = sum of b_E is then
!! solved by x_E = A_E^-1 b_E, sg_interface_cg for the interface impulses l_E that make copies agree, and x_E - A_E^-1 l_E.
!!
!! Values of shared bodies are columns in the world's axes, one per body of `interface%slot`, as all sums over copies take them.
module sg_subdomain_factor
  use sg_congruence, only: congruence_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_sparse, only: multiply, sparse_t
  use sg_sparse_algebra, only: diagonal_matrix
  use sg_sparse_factor, only: sparse_factor_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: subdomain_factor_t
  public :: by_mass, by_lump, by_schur, preconditioner_names

  !> Approximate inverses of what shared bodies feel of a subdomain: its mass; its rows of the matrix; the Schur complement
  integer, parameter :: by_mass = 1, by_lump = 2, by_schur = 3
  character(len=*), parameter :: preconditioner_names = 'mass|lumped|dirichlet'

  !> One subdomain
  type :: subdomain_factor_t
    !> Unknowns; mass of each, with divided masses of shared bodies
    integer :: n = 0
    real(wp), allocatable :: mass(:)
    !> Unknown of each component of each shared body, 0 where it is driven or has no contact here, shape (width, bodies)
    integer, allocatable :: unknown(:, :)
    !> Axes of the spins of each shared body in space, shape (3, 3, bodies); not allocated where they are the world's
    real(wp), allocatable :: axes(:, :, :)
    !> The matrix, and its factor where D is not zero; that of unknowns of other bodies alone
    type(congruence_t), private :: congruence
    type(sparse_factor_t), private :: factor, inner
    logical, allocatable, private :: is_shared(:)
    !> Has each shared body an unknown here?
    logical, allocatable :: takes_part(:)
    logical, private :: is_stiff = .false., has_inner = .false., lacks_inner = .false.
    !> Factorisations since `prepare`, and those that failed
    integer :: factorisations = 0, failures = 0
  contains
    procedure :: prepare => factor_prepare
    procedure :: factorise => factor_factorise
    procedure :: solve => factor_solve
    procedure :: apply_inverse => factor_apply_inverse
    procedure :: apply_inverse_mass => factor_apply_inverse_mass
    procedure :: precondition => factor_precondition
    procedure :: shared_blocks => factor_shared_blocks
    procedure :: spread => spread_values
    procedure :: gather => gather_values
    procedure :: free => factor_free
    procedure :: note_tables => factor_note_tables
  end type subdomain_factor_t

contains

  !> Take the matrices of a problem; D is zero until `factorise`.
  subroutine factor_prepare(self, mass, h, d, unknown, axes)
    class(subdomain_factor_t), intent(inout) :: self
    real(wp), intent(in) :: mass(:) !! diagonal of M_E, shape (n)
    type(sparse_t), intent(in) :: h !! H_E, n rows, d columns per contact
    integer, intent(in) :: d !! components of an impulse
    integer, intent(in) :: unknown(:, :) !! unknown of each component of each shared body, 0 where there is none
    real(wp), intent(in), optional :: axes(:, :, :) !! axes of spins of shared bodies in space, where they are not the world's
    integer :: i

    self%factor%is_definite = .true.
    self%inner%is_definite = .true.
    self%n = size(mass)
    self%mass = mass
    self%unknown = unknown
    if (allocated(self%axes)) deallocate (self%axes)
    if (present(axes)) self%axes = axes
    self%takes_part = [(any(unknown(:, i) > 0), i=1, size(unknown, 2))]
    call self%congruence%prepare(diagonal_matrix(mass), h, d)
    self%is_shared = [(.false., i=1, self%n)]
    do i = 1, size(unknown, 2)
      self%is_shared(pack(unknown(:, i), unknown(:, i) > 0)) = .true.
    end do
    self%is_stiff = .false.
    self%has_inner = .false.
    self%factorisations = 0
    self%failures = 0
  end subroutine factor_prepare

  !> Factorise the matrix of some D; where that fails D is zero.
  subroutine factor_factorise(self, blocks, error, must_hold_masses)
    class(subdomain_factor_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: blocks(:, :, :) !! D, shape (d, d, contacts) [kg, kg m, kg m^2]
    type(error_t), allocatable, intent(out) :: error !! why there is no factor
    logical, intent(in), optional :: must_hold_masses !! is there none where masses are lost in the rounding of H D H^T?

    self%has_inner = .false.
    self%lacks_inner = .false.
    call self%congruence%fill(blocks)
    self%is_stiff = any(abs(blocks) > 0)
    if (.not. self%is_stiff) return
    if (present(must_hold_masses)) then
      if (must_hold_masses .and. .not. holds_masses(self)) call fail(error, 'masses are lost in a matrix of stiff contacts')
    end if
    if (.not. allocated(error)) call self%factor%factorise(self%congruence%matrix, error)
    self%factorisations = self%factorisations + 1
    if (.not. allocated(error)) return
    self%failures = self%failures + 1
    self%is_stiff = .false.
    call self%congruence%fill(0*blocks)
  end subroutine factor_factorise

  !> Are masses more than the rounding of the diagonal?
  pure logical function holds_masses(self)
    class(subdomain_factor_t), intent(in) :: self
    integer :: i, e

    holds_masses = .true.
    associate (matrix => self%congruence%matrix)
      do i = 1, self%n
        do e = matrix%first(i), matrix%first(i + 1) - 1
          if (matrix%column(e) == i .and. epsilon(1.0_wp)*matrix%value(e) > self%mass(i)) holds_masses = .false.
        end do
      end do
    end associate
  end function holds_masses

  !> Solve with the matrix.
  subroutine factor_solve(self, b, x)
    class(subdomain_factor_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: b(:) !! right-hand side, shape (n)
    real(wp), intent(out), contiguous :: x(:) !! solution, shape (n)

    if (self%is_stiff) then
      call self%factor%solve(b, x)
    else
      x = b/self%mass
    end if
  end subroutine factor_solve

  !> Velocities of shared bodies that impulses on them cause: the rows and columns of the inverse that belong to these.
  subroutine factor_apply_inverse(self, values)
    class(subdomain_factor_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:, :) !! impulses, then velocities
    real(wp) :: b(self%n), x(self%n)

    call spread_values(self, values, b)
    call self%solve(b, x)
    call gather_values(self, x, values)
  end subroutine factor_apply_inverse

  !> The same by the mass alone.
  pure subroutine factor_apply_inverse_mass(self, values)
    class(subdomain_factor_t), intent(in) :: self
    real(wp), intent(inout) :: values(:, :) !! impulses, then velocities
    real(wp) :: x(self%n)

    call spread_values(self, values, x)
    x = x/self%mass
    call gather_values(self, x, values)
  end subroutine factor_apply_inverse_mass

  !> Impulses that change velocities of shared bodies, approximately or, by the Schur complement, exactly.
  subroutine factor_precondition(self, kind, values)
    class(subdomain_factor_t), intent(inout) :: self
    integer, intent(in) :: kind !! `by_mass`, `by_lump` or `by_schur`
    real(wp), intent(inout) :: values(:, :) !! velocities, then impulses
    real(wp) :: x(self%n), b(self%n)

    call spread_values(self, values, x)
    if (kind == by_mass .or. .not. self%is_stiff) then
      b = self%mass*x
    else
      if (kind == by_schur) call move_inner(self, x)
      call multiply(self%congruence%matrix, x, b)
    end if
    call gather_values(self, b, values)
  end subroutine factor_precondition

  !> Blocks of the matrix that belong to one shared body each, in the world's axes; zero where there is no unknown.
  pure subroutine factor_shared_blocks(self, blocks)
    class(subdomain_factor_t), intent(in) :: self !! factorised
    real(wp), intent(out), contiguous :: blocks(:, :, :) !! shape (width, width, shared bodies)
    integer :: i, c, e

    blocks = 0
    associate (matrix => self%congruence%matrix)
      do i = 1, size(self%unknown, 2)
        do c = 1, size(self%unknown, 1)
          if (self%unknown(c, i) == 0) cycle
          do e = matrix%first(self%unknown(c, i)), matrix%first(self%unknown(c, i) + 1) - 1
            where (self%unknown(:, i) == matrix%column(e)) blocks(:, c, i) = matrix%value(e)
          end do
        end do
        if (.not. allocated(self%axes)) cycle
        blocks(:, 4:6, i) = matmul(blocks(:, 4:6, i), transpose(self%axes(:, :, i)))
        blocks(4:6, :, i) = matmul(self%axes(:, :, i), blocks(4:6, :, i))
      end do
    end associate
  end subroutine factor_shared_blocks

  !> Let other bodies follow the shared ones without impulses on them; where their matrix has no factor they stay.
  subroutine move_inner(self, x)
    type(subdomain_factor_t), intent(inout) :: self
    real(wp), intent(inout) :: x(:) !! velocities of shared bodies; those of others are set
    real(wp) :: b(self%n), y(self%n)

    if (.not. (self%has_inner .or. self%lacks_inner)) call factorise_inner(self)
    if (self%lacks_inner) return
    call multiply(self%congruence%matrix, x, b)
    where (self%is_shared) b = 0
    call self%inner%solve(b, y)
    where (.not. self%is_shared) x = -y
  end subroutine move_inner

  !> Factorise the matrix of unknowns of bodies that are not shared; the others have a diagonal of ones.
  subroutine factorise_inner(self)
    type(subdomain_factor_t), intent(inout) :: self
    type(error_t), allocatable :: error
    type(sparse_t) :: matrix
    integer :: i, e

    matrix = self%congruence%matrix
    do i = 1, self%n
      do e = matrix%first(i), matrix%first(i + 1) - 1
        if (self%is_shared(i) .or. self%is_shared(matrix%column(e))) &
          matrix%value(e) = merge(1.0_wp, 0.0_wp, matrix%column(e) == i)
      end do
    end do
    call self%inner%factorise(matrix, error)
    self%factorisations = self%factorisations + 1
    self%has_inner = .not. allocated(error)
    self%lacks_inner = allocated(error)
    if (self%lacks_inner) self%failures = self%failures + 1
  end subroutine factorise_inner

  !> Values of shared bodies as a vector of all unknowns.
  pure subroutine spread_values(self, values, vector)
    class(subdomain_factor_t), intent(in) :: self
    real(wp), intent(in) :: values(:, :) !! of shared bodies
    real(wp), intent(out) :: vector(:) !! of all unknowns; zero for other bodies
    real(wp) :: column(size(values, 1))
    integer :: i, c

    vector = 0
    do i = 1, size(self%unknown, 2)
      column = values(:, i)
      if (allocated(self%axes)) column(4:6) = matmul(column(4:6), self%axes(:, :, i))
      do c = 1, size(column)
        if (self%unknown(c, i) > 0) vector(self%unknown(c, i)) = column(c)
      end do
    end do
  end subroutine spread_values

  !> Values of shared bodies from a vector of all unknowns; zero where there is no unknown.
  pure subroutine gather_values(self, vector, values)
    class(subdomain_factor_t), intent(in) :: self
    real(wp), intent(in) :: vector(:) !! of all unknowns
    real(wp), intent(out) :: values(:, :) !! of shared bodies
    integer :: i, c

    values = 0
    do i = 1, size(self%unknown, 2)
      do c = 1, size(values, 1)
        if (self%unknown(c, i) > 0) values(c, i) = vector(self%unknown(c, i))
      end do
      if (allocated(self%axes)) values(4:6, i) = matmul(self%axes(:, :, i), values(4:6, i))
    end do
  end subroutine gather_values

  !> Give the factors back.
  subroutine factor_free(self)
    class(subdomain_factor_t), intent(inout) :: self

    call self%factor%free()
    call self%inner%free()
    self%is_stiff = .false.
    self%has_inner = .false.
  end subroutine factor_free

  !> Add these tables to those of the owner that has begun; factors are given back with each step.
  subroutine factor_note_tables(self, tables)
    class(subdomain_factor_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%note('mass', self%mass)
    call tables%note('unknown', self%unknown)
    call tables%note('axes', self%axes)
    call tables%note('is_shared', self%is_shared)
    call tables%note('takes_part', self%takes_part)
    call self%congruence%note_tables(tables)
  end subroutine factor_note_tables
end module sg_subdomain_factor
