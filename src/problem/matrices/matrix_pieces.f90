!> A contact problem in matrices as files take it: one rank's share of entries and rows, with the numbers of the whole problem.
!!
!! Rows of vectors follow those of lower ranks; entries of matrices may stand in any order. Where one rank holds the problem, its
!! share is all of it.
module sg_matrix_pieces
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: triplets_t, matrix_state_t, matrix_pieces_t

  !> Entries of a sparse matrix
  type :: triplets_t
    !> Row and column of each entry, from 1 in the whole problem, and its value
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
  end type triplets_t

  !> Impulses and what they cause
  type :: matrix_state_t
    !> Impulses [N s] and relative velocities [m/s] of this rank's contacts, shape (d n)
    real(wp), allocatable :: r(:), u(:)
    !> Velocities of this rank's unknowns
    real(wp), allocatable :: v(:)
    !> Multipliers of constraints; of problems of files alone
    real(wp), allocatable :: l(:)
  end type matrix_state_t

  !> One rank's share of a problem
  type :: matrix_pieces_t
    !> Components of a contact; contacts and unknown velocities of all ranks
    integer :: d = 0, all_contacts = 0, all_unknowns = 0
    !> W, entries of rows of this rank's contacts
    type(triplets_t) :: w
    !> q [m/s] of this rank's contacts, shape (d n), and their friction, shape (n)
    real(wp), allocatable :: q(:), friction(:)
    !> Is there a global form?
    logical :: has_global = .false.
    !> Entries of M and of H, loads f of this rank's unknowns, and offset w of its contacts, shape (d n)
    type(triplets_t) :: mass, h
    real(wp), allocatable :: f(:), offset(:)
    !> Impulses to start from, and those of the solution, where they are known
    logical :: has_guess = .false., has_solution = .false.
    type(matrix_state_t) :: guess, solution
  end type matrix_pieces_t
end module sg_matrix_pieces
