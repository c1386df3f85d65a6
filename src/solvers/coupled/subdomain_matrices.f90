!> Matrices of one subdomain: H_E and the diagonal M_E, for the velocities that its contacts can change.
!!
!! Masses are those that bodies have at present: divided ones where a coupling has divided them.
module sg_subdomain_matrices
  use sg_kinds, only: wp, i4
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
    !> Components of an impulse
    integer :: d = 0
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
  subroutine matrices_take(self, problem)
    class(subdomain_matrices_t), intent(out) :: self
    type(problem_t), intent(in) :: problem !! this rank's part
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: k

    self%d = merge(3, 2, is_in_space(problem%kind))
    self%contact = pack([(int(k, i4), k=1, problem%n_contacts)], [(is_active(problem, k), k=1, problem%n_contacts)])
    self%contacts = [(contact_of(problem, int(self%contact(k))), k=1, size(self%contact))]
    call number_unknowns(self, problem)
    call mapping_entries(problem, self%contacts, self%contact, self%bodies, self%unknown, row, column, value, self%offset)
    call sparse_from_triplets(size(self%mass), self%d*size(self%contact), row, column, value, self%h)
  end subroutine matrices_take

  !> Number the velocities that contacts can change, and list their masses.
  pure subroutine number_unknowns(self, problem)
    class(subdomain_matrices_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer :: k, side, c, n

    allocate (self%bodies(problem%n_bodies), self%mass(6*problem%n_bodies), self%velocity(6*problem%n_bodies))
    allocate (self%unknown(6, problem%n_bodies), source=0_i4)
    n = 0
    do k = 1, size(self%contact)
      do side = 1, 2
        associate (slot => problem%pair(side, self%contact(k)), bodies => self%bodies)
          if (bodies(slot)%n > 0) cycle
          bodies(slot) = body_of(problem, int(slot))
          do c = 1, bodies(slot)%n
            if (.not. bodies(slot)%inverse_mass(c) > 0) cycle
            n = n + 1
            self%unknown(c, slot) = int(n, i4)
            self%mass(n) = 1/bodies(slot)%inverse_mass(c)
            self%velocity(n) = bodies(slot)%velocity(c)
          end do
        end associate
      end do
    end do
    self%mass = self%mass(:n)
    self%velocity = self%velocity(:n)
  end subroutine number_unknowns

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
