!> What all methods share that sweep a problem of several ranks: options of the decomposition, and masses divided among copies
!! (doc/theory/decomposition.md). The loop is that of one rank (sg_nlgs).
module sg_coupled_solver
  use sg_delassus, only: share_mass
  use sg_kinds, only: wp
  use sg_nlgs, only: nlgs_t
  use sg_options, only: option_visitor_t
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_run_options, only: partition_options_t
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: coupled_solver_t

  !> A solver of problems that ranks share
  type, abstract, extends(nlgs_t) :: coupled_solver_t
    !> Options of the deck
    type(partition_options_t) :: partition
    !> Components of a velocity
    integer :: width = 0
    !> Slots of bodies with masses divided among copies, and their inverse masses when whole
    integer, allocatable, private :: divided(:)
    real(wp), allocatable, private :: whole(:, :)
  contains
    procedure :: visit_options => coupled_visit_options
    procedure :: begin_coupled => coupled_begin
    procedure :: divide_masses => coupled_divide_masses
    procedure :: make_masses_whole => coupled_make_masses_whole
    procedure :: list_masses => coupled_list_masses
  end type coupled_solver_t

contains

  !> Options that the method alone has: none.
  subroutine coupled_visit_options(self, visitor)
    class(coupled_solver_t), intent(inout) :: self
    class(option_visitor_t), intent(inout) :: visitor !! key table, or values of a deck
  end subroutine coupled_visit_options

  !> Begin a solve: how rounds are counted, and how long a velocity is.
  subroutine coupled_begin(self, problem)
    class(coupled_solver_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part

    self%is_coupled = .true.
    self%sweeps_per_round = self%partition%most_sweeps()
    self%most_updates = self%sweeps_per_round
    self%width = first_inverse(problem%kind) - 1
  end subroutine coupled_begin

  !> Take one of equal parts of the masses of shared bodies until the end of the solve.
  pure subroutine coupled_divide_masses(self, problem, slot, multiplicity)
    class(coupled_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! inverse masses of these bodies grow
    integer, intent(in) :: slot(:) !! the bodies
    integer, intent(in) :: multiplicity(:) !! copies of each; 0 and 1 leave it whole
    integer :: i

    self%divided = slot
    self%whole = problem%body(self%width + 1:, slot)
    do i = 1, size(slot)
      call share_mass(problem%kind, max(1, multiplicity(i)), problem%body(:, slot(i)))
    end do
  end subroutine coupled_divide_masses

  !> Give shared bodies their whole masses back.
  pure subroutine coupled_make_masses_whole(self, problem)
    class(coupled_solver_t), intent(in) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part

    problem%body(self%width + 1:, self%divided) = self%whole
  end subroutine coupled_make_masses_whole

  !> List the tables of contacts in sets, and of divided masses.
  subroutine coupled_list_masses(self, tables)
    class(coupled_solver_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%sets%list_split_tables(tables)
    call tables%begin('masses', per_body)
    call tables%note('divided', self%divided)
    call tables%note('whole', self%whole)
  end subroutine coupled_list_masses
end module sg_coupled_solver
