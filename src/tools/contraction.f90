!> Contraction matrices of the dual and of the enriched interface, full matrices for small problems (doc/theory/spectral_radius.md).
!!
!! Both methods iterate on impulses of the interface, F -> T(F), each subdomain solved exactly. With linear interactions, or near a
!! solution whose contacts keep their statuses, T is affine, and the spectral radius of its matrix B is the rate of convergence.
module sg_contraction
  use sg_dense_factor, only: dense_factorise, dense_solve
  use sg_error, only: error_t, exit_failure, fail
  use sg_kinds, only: wp, i4
  use sg_owners, only: contact_owner
  use sg_problem, only: problem_t
  use sg_problem_records, only: body_of, body_record_t, contact_of, contact_record_t
  use sg_records, only: first_inverse, is_in_space
  implicit none
  private
  public :: contraction_t

  !> A direction counts as independent of others when so much of its length is left, in the norm of M^-1
  real(wp), parameter :: independent = 1e-8_wp

  !> Matrices of one subdomain. Its unknowns are the components of velocities in which impulses can move its copies of bodies
  type :: subdomain_matrices_t
    !> Inverse masses of copies: that of the body times its multiplicity [1/kg, 1/(kg m2)], shape (unknowns)
    real(wp), allocatable :: inverse_mass(:)
    !> A_E: differences between copies, shape (interface unknowns, unknowns)
    real(wp), allocatable :: a(:, :)
    !> H_E: impulses of all contacts in all their directions, shape (unknowns, directions)
    real(wp), allocatable :: h(:, :)
    !> The same for contacts that hold: impulses that they may have, and velocities that these keep at zero, shape (unknowns, n)
    real(wp), allocatable :: held_impulse(:, :), held_velocity(:, :)
  end type subdomain_matrices_t

  !> The interface of a problem and its subdomains
  type :: contraction_t
    !> Unknowns of the interface, bodies with several copies, contacts, and contacts that hold
    integer :: unknowns = 0, shared = 0, contacts = 0, holding = 0
    !> Mean diagonal term of W, masses whole [1/kg]
    real(wp) :: epsilon_0 = 0
    type(subdomain_matrices_t), allocatable :: subdomain(:)
    !> Owner of each contact, multiplicity of each body and first interface unknown of its copies, by slot; unknown of each
    !! component of the body in the present subdomain
    integer, allocatable, private :: owner(:), multiplicity(:), first(:), unknown(:, :)
    !> Has a subdomain contacts on a body, shape (subdomains, bodies)
    logical, allocatable, private :: touches(:, :)
    type(body_record_t), allocatable, private :: body(:)
  contains
    procedure :: build => contraction_build
    procedure :: hold => contraction_hold
    procedure :: dual => contraction_dual
    procedure :: enriched => contraction_enriched
    procedure :: dual_held => contraction_dual_held
    procedure :: enriched_held => contraction_enriched_held
  end type contraction_t

contains

  !> Build the matrices of a problem split into subdomains by the owners of its bodies.
  subroutine contraction_build(self, problem, body_owner, n_subdomains)
    class(contraction_t), intent(out) :: self
    type(problem_t), intent(in) :: problem !! whole problem of a step, masses whole
    integer(i4), intent(in) :: body_owner(:) !! subdomain that owns each body, from 0, by slot; -1 for replicated bodies
    integer, intent(in) :: n_subdomains !! subdomains
    integer :: k, s, e

    self%contacts = problem%n_contacts
    self%owner = [(contact_owner(body_owner(problem%pair(:, k))) + 1, k=1, problem%n_contacts)]
    self%body = [(body_of(problem, s), s=1, problem%n_bodies)]
    allocate (self%touches(n_subdomains, problem%n_bodies), source=.false.)
    do k = 1, problem%n_contacts
      self%touches(self%owner(k), problem%pair(:, k)) = .true.
    end do
    self%multiplicity = count(self%touches, 1)
    allocate (self%first(problem%n_bodies), source=0)
    do s = 1, problem%n_bodies
      if (self%multiplicity(s) < 2 .or. n_free(self%body(s)) == 0) cycle
      self%shared = self%shared + 1
      self%first(s) = self%unknowns + 1
      self%unknowns = self%unknowns + (self%multiplicity(s) - 1)*n_free(self%body(s))
    end do
    allocate (self%subdomain(n_subdomains), self%unknown(6, problem%n_bodies))
    do e = 1, n_subdomains
      call number_unknowns(self, e)
      call set_copies(self, e, self%subdomain(e))
      call set_mapping(self, problem, e, self%subdomain(e)%h)
    end do
    self%epsilon_0 = mean_diagonal(self, problem)
  end subroutine contraction_build

  !> Components of a body in which impulses can move it.
  pure integer function n_free(body)
    type(body_record_t), intent(in) :: body

    n_free = count(body%inverse_mass(:body%n) > 0)
  end function n_free

  !> Number the unknowns of a subdomain: movable components of the bodies that it has contacts on.
  pure subroutine number_unknowns(self, e)
    class(contraction_t), intent(inout) :: self
    integer, intent(in) :: e
    integer :: s, j, n

    self%unknown = 0
    n = 0
    do s = 1, size(self%body)
      if (.not. self%touches(e, s)) cycle
      do j = 1, self%body(s)%n
        if (.not. self%body(s)%inverse_mass(j) > 0) cycle
        n = n + 1
        self%unknown(j, s) = n
      end do
    end do
  end subroutine number_unknowns

  !> Masses of the copies of a subdomain, and its differences to other copies: copy 1 minus copy c, for each c from 2.
  pure subroutine set_copies(self, e, matrices)
    class(contraction_t), intent(in) :: self
    integer, intent(in) :: e
    type(subdomain_matrices_t), intent(inout) :: matrices
    integer :: s, j, n, copy, c, row

    n = maxval(self%unknown)
    allocate (matrices%inverse_mass(n), matrices%a(self%unknowns, n), source=0.0_wp)
    do s = 1, size(self%body)
      copy = count(self%touches(:e, s))
      n = 0
      do j = 1, self%body(s)%n
        associate (i => self%unknown(j, s))
          if (i == 0) cycle
          matrices%inverse_mass(i) = real(self%multiplicity(s), wp)*self%body(s)%inverse_mass(j)
          do c = 2, self%multiplicity(s)
            row = self%first(s) + (c - 2)*n_free(self%body(s)) + n
            if (copy == 1) matrices%a(row, i) = 1
            if (copy == c) matrices%a(row, i) = -1
          end do
          n = n + 1
        end associate
      end do
    end do
  end subroutine set_copies

  !> Impulses of the contacts of a subdomain on its unknowns, direction by direction.
  pure subroutine set_mapping(self, problem, e, h)
    class(contraction_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: e
    real(wp), allocatable, intent(out) :: h(:, :)
    type(contact_record_t) :: contact
    integer :: k, i, n

    allocate (h(maxval(self%unknown), 3*count(self%owner == e)), source=0.0_wp)
    n = 0
    do k = 1, problem%n_contacts
      if (self%owner(k) /= e) cycle
      contact = contact_of(problem, k)
      do i = 1, n_directions(contact, problem%kind)
        n = n + 1
        h(:, n) = column_of(self, problem, k, contact%h(i, :, :), size(h, 1))
      end do
    end do
    h = h(:, :n)
  end subroutine set_mapping

  !> Directions in which a contact can carry an impulse.
  pure integer function n_directions(contact, kind)
    type(contact_record_t), intent(in) :: contact
    integer, intent(in) :: kind

    n_directions = 0
    if (contact%is_active) n_directions = merge(merge(3, 2, is_in_space(kind)), 1, &
                                                contact%has_tangent .and. (contact%is_linear .or. contact%friction > 0))
  end function n_directions

  !> What an impulse along one direction of a contact does to the unknowns of the present subdomain.
  pure function column_of(self, problem, k, h, n) result(column)
    class(contraction_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k, n
    real(wp), intent(in) :: h(:, :) !! by component and body
    real(wp) :: column(n), along(6)
    integer :: side, j

    column = 0
    do side = 1, 2
      associate (s => problem%pair(side, k))
        along = h(:, side)
        if (self%body(s)%n == 6) along(4:6) = matmul(along(4:6), self%body(s)%axes)
        do j = 1, self%body(s)%n
          if (self%unknown(j, s) > 0) column(self%unknown(j, s)) = column(self%unknown(j, s)) + along(j)
        end do
      end associate
    end do
  end function column_of

  !> Mean diagonal term of W over the directions of all contacts, masses whole.
  pure real(wp) function mean_diagonal(self, problem) result(mean)
    class(contraction_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    type(contact_record_t) :: contact
    real(wp) :: along(6)
    integer :: k, i, side, n

    mean = 0
    n = 0
    do k = 1, problem%n_contacts
      contact = contact_of(problem, k)
      do i = 1, n_directions(contact, problem%kind)
        n = n + 1
        do side = 1, 2
          associate (body => self%body(problem%pair(side, k)))
            along = contact%h(i, :, side)
            if (body%n == 6) along(4:6) = matmul(along(4:6), body%axes)
            mean = mean + sum(body%inverse_mass(:body%n)*along(:body%n)**2)
          end associate
        end do
      end do
    end do
    mean = mean/real(max(1, n), wp)
  end function mean_diagonal

  !> Let contacts hold: in all their directions, or along the normal while they slide, their friction going with the normal impulse.
  !! Directions that follow from others are left out, which changes no velocity.
  subroutine contraction_hold(self, problem, holds, slides)
    class(contraction_t), intent(inout) :: self !! built from this problem
    type(problem_t), intent(in) :: problem !! the same, solved
    logical, intent(in) :: holds(:) !! does the contact carry an impulse?
    logical, intent(in) :: slides(:) !! and does it slide, in the plane?
    type(contact_record_t) :: contact
    real(wp) :: sense
    integer :: e, k, i

    self%holding = count(holds)
    do e = 1, size(self%subdomain)
      call number_unknowns(self, e)
      associate (matrices => self%subdomain(e))
        allocate (matrices%held_impulse(size(matrices%inverse_mass), 0), matrices%held_velocity(size(matrices%inverse_mass), 0))
        do k = 1, problem%n_contacts
          if (self%owner(k) /= e .or. .not. holds(k)) cycle
          contact = contact_of(problem, k)
          if (slides(k)) then
            sense = sign(contact%friction, contact%impulse(2))
            call add_held(matrices, column_of(self, problem, k, contact%h(1, :, :), size(matrices%h, 1)), &
                          column_of(self, problem, k, contact%h(1, :, :) + sense*contact%h(2, :, :), size(matrices%h, 1)))
            cycle
          end if
          do i = 1, n_directions(contact, problem%kind)
            associate (column => column_of(self, problem, k, contact%h(i, :, :), size(matrices%h, 1)))
              call add_held(matrices, column, column)
            end associate
          end do
        end do
      end associate
    end do
  end subroutine contraction_hold

  !> Add a direction that holds, unless it follows from those that are there.
  pure subroutine add_held(matrices, velocity, impulse)
    type(subdomain_matrices_t), intent(inout) :: matrices
    real(wp), intent(in) :: velocity(:), impulse(:)
    real(wp), allocatable :: basis(:, :)
    real(wp) :: left(size(velocity))
    integer :: i, j

    allocate (basis, source=matrices%held_velocity)
    left = velocity
    associate (m => matrices%inverse_mass)
      do i = 1, size(basis, 2)
        do j = 1, i - 1
          basis(:, i) = basis(:, i) - sum(m*basis(:, j)*basis(:, i))*basis(:, j)
        end do
        basis(:, i) = basis(:, i)/sqrt(sum(m*basis(:, i)**2))
        left = left - sum(m*basis(:, i)*left)*basis(:, i)
      end do
      if (sum(m*left**2) <= independent**2*sum(m*velocity**2)) return
    end associate
    matrices%held_velocity = reshape([matrices%held_velocity, velocity], [size(velocity), size(basis, 2) + 1])
    matrices%held_impulse = reshape([matrices%held_impulse, impulse], [size(velocity), size(basis, 2) + 1])
  end subroutine add_held

  !> B_eps = X^-1 Y_eps of the dual method with the interactions r = -v/epsilon.
  subroutine contraction_dual(self, epsilon, b, error)
    class(contraction_t), intent(in) :: self !! built
    real(wp), intent(in) :: epsilon !! velocity per impulse [1/kg]
    real(wp), allocatable, intent(out) :: b(:, :) !! the matrix
    type(error_t), allocatable, intent(out) :: error !! set where a matrix is singular
    real(wp), allocatable :: x(:, :)
    integer :: e

    allocate (b(self%unknowns, self%unknowns), source=0.0_wp)
    do e = 1, size(self%subdomain)
      associate (s => self%subdomain(e))
        call add_response(s, s%h, s%h, epsilon, b, error)
        if (allocated(error)) return
      end associate
    end do
    x = mobility(self)
    call divide(x, b, error)
  end subroutine contraction_dual

  !> B_eps,eta = X_eta^-1 Y_eps,eta of the enriched interface with the interactions r = -v/epsilon.
  subroutine contraction_enriched(self, epsilon, eta, b, error)
    class(contraction_t), intent(in) :: self !! built
    real(wp), intent(in) :: epsilon !! velocity per impulse [1/kg]
    real(wp), intent(in) :: eta !! search direction [1/kg], above zero
    real(wp), allocatable, intent(out) :: b(:, :) !! the matrix
    type(error_t), allocatable, intent(out) :: error !! set where a matrix is singular
    real(wp), allocatable :: x(:, :), impulse(:, :), stiff(:, :), left(:, :)
    integer :: e

    allocate (b(self%unknowns, self%unknowns), x(self%unknowns, self%unknowns), source=0.0_wp)
    do e = 1, size(self%subdomain)
      associate (s => self%subdomain(e))
        ! r = (W + epsilon)^-1 H^T M^-1 A^T F.
        impulse = moved(s, transpose(s%a))
        impulse = matmul(transpose(s%h), impulse)
        stiff = matmul(transpose(s%h), moved(s, s%h))
        call add_diagonal(stiff, epsilon)
        call divide(stiff, impulse, error)
        if (allocated(error)) return
        call foresee(s, eta, left, error)
        if (allocated(error)) return
        b = b + (1 - epsilon/eta)*matmul(transpose(left), matmul(s%h, impulse))
        x = x + matmul(s%a, left)
      end associate
    end do
    call divide(x, b, error)
  end subroutine contraction_enriched

  !> B = X^-1 Y of the dual method near the solution of a problem whose contacts hold, slide or are open.
  subroutine contraction_dual_held(self, b, error)
    class(contraction_t), intent(in) :: self !! built, its holding contacts chosen
    real(wp), allocatable, intent(out) :: b(:, :) !! the matrix
    type(error_t), allocatable, intent(out) :: error !! set where a matrix is singular
    real(wp), allocatable :: x(:, :)

    call response_held(self, b, error)
    if (allocated(error)) return
    x = mobility(self)
    call divide(x, b, error)
  end subroutine contraction_dual_held

  !> B_eta = 1 - X_eta^-1 (X - Y) of the enriched interface near such a solution: Y from contacts that hold, X_eta from all.
  subroutine contraction_enriched_held(self, eta, b, error)
    class(contraction_t), intent(in) :: self !! built, its holding contacts chosen
    real(wp), intent(in) :: eta !! search direction [1/kg], above zero
    real(wp), allocatable, intent(out) :: b(:, :) !! the matrix
    type(error_t), allocatable, intent(out) :: error !! set where a matrix is singular
    real(wp), allocatable :: x(:, :), left(:, :)
    integer :: e

    call response_held(self, b, error)
    if (allocated(error)) return
    b = b - mobility(self)
    allocate (x(self%unknowns, self%unknowns), source=0.0_wp)
    do e = 1, size(self%subdomain)
      associate (s => self%subdomain(e))
        call foresee(s, eta, left, error)
        if (allocated(error)) return
        x = x + matmul(s%a, left)
      end associate
    end do
    call divide(x, b, error)
    if (.not. allocated(error)) call add_diagonal(b, 1.0_wp)
  end subroutine contraction_enriched_held

  !> Y of contacts that hold.
  subroutine response_held(self, y, error)
    class(contraction_t), intent(in) :: self
    real(wp), allocatable, intent(out) :: y(:, :)
    type(error_t), allocatable, intent(out) :: error
    integer :: e

    allocate (y(self%unknowns, self%unknowns), source=0.0_wp)
    do e = 1, size(self%subdomain)
      associate (s => self%subdomain(e))
        call add_response(s, s%held_velocity, s%held_impulse, 0.0_wp, y, error)
        if (allocated(error)) return
      end associate
    end do
  end subroutine response_held

  !> Add A M^-1 H (H_v^T M^-1 H + epsilon)^-1 H_v^T M^-1 A^T of a subdomain.
  subroutine add_response(s, velocity, impulse, epsilon, y, error)
    type(subdomain_matrices_t), intent(in) :: s
    real(wp), intent(in) :: velocity(:, :), impulse(:, :), epsilon
    real(wp), intent(inout) :: y(:, :)
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: w(:, :), r(:, :)

    w = matmul(transpose(velocity), moved(s, impulse))
    call add_diagonal(w, epsilon)
    r = matmul(transpose(velocity), moved(s, transpose(s%a)))
    call divide(w, r, error)
    if (.not. allocated(error)) y = y + matmul(s%a, moved(s, matmul(impulse, r)))
  end subroutine add_response

  !> M_eta^-1 A^T of a subdomain, with M_eta = M + H H^T/eta.
  subroutine foresee(s, eta, velocities, error)
    type(subdomain_matrices_t), intent(in) :: s
    real(wp), intent(in) :: eta
    real(wp), allocatable, intent(out) :: velocities(:, :)
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: mass(:, :)
    integer :: i

    mass = matmul(s%h, transpose(s%h))/eta
    do i = 1, size(mass, 1)
      mass(i, i) = mass(i, i) + 1/s%inverse_mass(i)
    end do
    velocities = transpose(s%a)
    call divide(mass, velocities, error)
  end subroutine foresee

  !> X = sum over subdomains of A M^-1 A^T.
  pure function mobility(self) result(x)
    class(contraction_t), intent(in) :: self
    real(wp), allocatable :: x(:, :)
    integer :: e

    allocate (x(self%unknowns, self%unknowns), source=0.0_wp)
    do e = 1, size(self%subdomain)
      associate (s => self%subdomain(e))
        x = x + matmul(s%a, moved(s, transpose(s%a)))
      end associate
    end do
  end function mobility

  !> M^-1 times some columns.
  pure function moved(s, columns) result(velocities)
    type(subdomain_matrices_t), intent(in) :: s
    real(wp), intent(in) :: columns(:, :)
    real(wp) :: velocities(size(columns, 1), size(columns, 2))

    velocities = spread(s%inverse_mass, 2, size(columns, 2))*columns
  end function moved

  !> Replace columns by the solutions of a system with them.
  subroutine divide(matrix, columns, error)
    real(wp), intent(inout) :: matrix(:, :) !! destroyed
    real(wp), intent(inout) :: columns(:, :)
    type(error_t), allocatable, intent(out) :: error
    integer :: pivot(size(matrix, 1)), i
    logical :: is_singular

    if (size(matrix, 1) == 0) return
    call dense_factorise(matrix, pivot, is_singular)
    if (is_singular) then
      call fail(error, 'a matrix of the interface is singular', code=exit_failure)
      return
    end if
    do i = 1, size(columns, 2)
      call dense_solve(matrix, pivot, columns(:, i))
    end do
  end subroutine divide

  !> Add a number to the diagonal of a matrix.
  pure subroutine add_diagonal(matrix, number)
    real(wp), intent(inout) :: matrix(:, :)
    real(wp), intent(in) :: number
    integer :: i

    do i = 1, size(matrix, 1)
      matrix(i, i) = matrix(i, i) + number
    end do
  end subroutine add_diagonal
end module sg_contraction
