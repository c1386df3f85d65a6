!> A contact problem given by matrices: what files of other codes hold, and what solvers with factorisations need.
!!
!! Local form: u = W r + q. Global form: M v = H r + f, u = H^T v + w; then W = H^T M^-1 H and q = w + H^T M^-1 f.
!! Components of a contact: normal first, then one tangent (2D) or two (3D). Wanted is Coulomb's law,
!! K* contains u + (friction |u_T|, 0) orthogonal to r in K (doc/theory/contact_problem.md).
module sg_matrix_problem
  use sg_kinds, only: wp
  use sg_sparse, only: blocks_t, sparse_t
  implicit none
  private
  public :: matrix_problem_t

  !> One contact problem
  type :: matrix_problem_t
    !> Components of a contact (2 or 3), and number of contacts
    integer :: d = 0, n = 0
    !> Delassus operator W; always there, not always symmetric
    type(blocks_t) :: w
    !> Is W symmetric to rounding?
    logical :: is_symmetric = .true.
    !> Relative velocity without impulses [m/s], shape (d, n)
    real(wp), allocatable :: q(:, :)
    !> Coulomb friction of each contact, shape (n)
    real(wp), allocatable :: friction(:)
    !> Impulse [N s], shape (d, n): the guess, then the solution
    real(wp), allocatable :: r(:, :)
    !> Global form, where it is known: mass matrix (dof, dof), H (dof, d n), loads f (dof), offset w of velocities (d n)
    logical :: has_global = .false.
    type(sparse_t) :: mass, h
    real(wp), allocatable :: f(:), offset(:)
  end type matrix_problem_t
end module sg_matrix_problem
