!> Rates of a periodic cell under imposed stress as unknowns of a contact problem (doc/theory/periodic_cell.md, "Imposed stress").
!!
!! A change of the rates changes the biases of the contacts. Components are those of sg_periodic_cell.
module sg_cell_problem
  use sg_kinds, only: wp
  implicit none
  private
  public :: cell_problem_t

  !> Rates that are unknown
  type :: cell_problem_t
    !> Are there any? Which components
    logical :: is_on = .false.
    logical :: is_free(4) = .false.
    !> Rates without contacts, present ones, and those that the biases of the records hold [1/s]
    real(wp) :: free(4) = 0, rate(4) = 0, recorded(4) = 0
    !> Inertia of each free component [kg m2]
    real(wp) :: inertia(4) = 1
    !> Bound of the cell's part of the problem, over all ranks, and the share of a change of rates that a round takes
    real(wp) :: bound = 0, share = 1
    !> Branch of each contact, from the antagonist's centre to the candidate's [m], shape (3, contacts)
    real(wp), allocatable :: branch(:, :)
  end type cell_problem_t
end module sg_cell_problem
