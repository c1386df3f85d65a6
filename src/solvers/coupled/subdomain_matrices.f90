!> Matrices of one subdomain: H_E and the diagonal M_E, for the velocities that its contacts can change.
!!
!! Masses are those that bodies have at present: divided ones where a coupling has divided them.
module sg_subdomain_matrices
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_problem, only: is_active, problem_t
  use sg_problem_matrices, only: mapping_entries
  use sg_problem_records, only: body_of, body_record_t, contact_of, contact_record_t
  use sg_records, only: is_in_space
  use sg_sparse, only: sparse_from_triplets, sparse_t
  use sg_subdomain_factor, only: subdomain_factor_t
  implicit none
  private
  public :: subdomain_matrices_t

  !> The matrices
  type :: subdomain_matrices_t
    !> Components of an impulse; unknowns
    integer :: d = 0, n = 0
    !> Contacts that can carry impulses, by number in the problem, and their records
    integer(i4), allocatable :: contact(:)
    type(contact_record_t), allocatable :: contacts(:)
    !> Diagonal of M_E, velocities at present, and relative velocities of biases and driven bodies
    real(wp), allocatable :: mass(:), velocity(:), offset(:)
    !> H_E, d columns per contact
    type(sparse_t) :: h
    !> Number of each unknown velocity or 0, shape (6, slots), and bodies by slot, of those with contacts
    integer(i4), allocatable, private :: unknown(:, :)
    type(body_record_t), allocatable, private :: bodies(:)
  contains
    procedure :: take => matrices_take
    procedure :: prepare_factor => matrices_prepare_factor
  end type subdomain_matrices_t

contains

  !> Take the matrices of a problem.
  subroutine matrices_take(self, problem, shared)
    class(subdomain_matrices_t), intent(out) :: self
    type(problem_t), intent(in) :: problem !! this rank's part
    integer, intent(in) :: shared(:) !! slots of the shared bodies
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: k

    self%d = merge(3, 2, is_in_space(problem%kind))
    self%contact = pack([(int(k, i4), k=1, problem%n_contacts)], [(is_active(problem, k), k=1, problem%n_contacts)])
    self%contacts = [(contact_of(problem, int(self%contact(k))), k=1, size(self%contact))]
    call number_unknowns(self, problem, shared)
    call mapping_entries(problem, self%contacts, self%contact, self%bodies, self%unknown, row, column, value, self%offset)
    call sparse_from_triplets(size(self%mass), self%d*size(self%contact), row, column, value, self%h)
  end subroutine matrices_take

  !> Number the velocities that contacts can change, here or, of shared bodies, elsewhere, and list their masses. A copy with a
  !! contact has its part of the mass even where the contact cannot carry an impulse.
  subroutine number_unknowns(self, problem, shared)
    class(subdomain_matrices_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: shared(:)
    logical :: is_shared(problem%n_bodies)
    integer :: k, side

    allocate (self%bodies(problem%n_bodies), self%mass(0), self%velocity(0))
    allocate (self%unknown(6, problem%n_bodies), source=0_i4)
    is_shared = .false.
    is_shared(shared) = .true.
    do k = 1, size(self%contact)
      do side = 1, 2
        call number_body(self, problem, int(problem%pair(side, self%contact(k))))
      end do
    end do
    do k = 1, problem%n_contacts
      do side = 1, 2
        if (is_shared(problem%pair(side, k))) call number_body(self, problem, int(problem%pair(side, k)))
      end do
    end do
    self%mass = self%mass(:self%n)
    self%velocity = self%velocity(:self%n)
  end subroutine number_unknowns

  !> Number the velocities of a body, unless they are.
  subroutine number_body(self, problem, slot)
    class(subdomain_matrices_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: slot
    integer :: c

    if (self%bodies(slot)%n > 0) return
    self%bodies(slot) = body_of(problem, slot)
    call reserve(self%mass, self%n + 6)
    call reserve(self%velocity, self%n + 6)
    associate (body => self%bodies(slot))
      do c = 1, body%n
        if (.not. body%inverse_mass(c) > 0) cycle
        self%n = self%n + 1
        self%unknown(c, slot) = int(self%n, i4)
        self%mass(self%n) = 1/body%inverse_mass(c)
        self%velocity(self%n) = body%velocity(c)
      end do
    end associate
  end subroutine number_body

  !> Give a factor these matrices, with the bodies that ranks share.
  subroutine matrices_prepare_factor(self, slot, width, factor)
    class(subdomain_matrices_t), intent(in) :: self
    integer, intent(in) :: slot(:) !! of the shared bodies
    integer, intent(in) :: width !! components of a velocity
    type(subdomain_factor_t), intent(inout) :: factor !! gets them
    real(wp) :: axes(3, 3, size(slot))
    integer :: i

    if (width == 6) then
      do i = 1, size(slot)
        axes(:, :, i) = self%bodies(slot(i))%axes
      end do
      call factor%prepare(self%mass, self%h, self%d, int(self%unknown(:width, slot)), axes)
    else
      call factor%prepare(self%mass, self%h, self%d, int(self%unknown(:width, slot)))
    end if
  end subroutine matrices_prepare_factor
end module sg_subdomain_matrices
