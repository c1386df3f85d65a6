!> THE list of methods: solvers (`solver.method`, `splitgrain solve --solver`) and couplings of ranks (`partition.gluing`), with
!! what each needs and an object of each, options at their defaults.
!!
!! Keys of decks, the deck reference, refusals, advice and `choose_solver` follow from these lines.
module sg_methods
  use sg_accelerated_nlgs, only: accelerated_nlgs_t
  use sg_block_automatic, only: block_automatic_t
  use sg_block_nesterov, only: block_nesterov_t
  use sg_block_nlgs, only: block_nlgs_t
  use sg_coupled_solver, only: coupled_solver_t
  use sg_dual, only: dual_t
  use sg_enriched, only: enriched_t
  use sg_error, only: error_t
  use sg_interior_point, only: interior_point_t
  use sg_interior_point_ranks, only: interior_ranks_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_momentum, only: momentum_t
  use sg_nlgs, only: nlgs_t
  use sg_primal, only: primal_t
  use sg_proximal_newton, only: proximal_newton_t
  use sg_sparse_factor, only: find_sparse_library
  use sg_text, only: append_word, joined, text_t
  implicit none
  private
  public :: method_t, list_solvers, list_couplings, find_method, solver_names, coupling_names, is_swept, quoted_names, robust_solver

  !> Solver that goes on where others stall: default of `splitgrain solve`, advised where steps do not converge
  character(len=*), parameter :: robust_solver = 'auto'

  !> Characters of a name
  integer, parameter :: len_of_name = 16

  !> A method, and an object of it for each kind of problem that it solves
  type :: method_t
    !> Name, as decks write it, and what it is
    character(len=len_of_name) :: name = ''
    character(len=80) :: sentence = ''
    !> Its name in older decks, still read with a note; empty for none
    character(len=len_of_name) :: former = ''
    !> Does it need a library that factorises sparse matrices?
    logical :: needs_factors = .false.
    !> Where it may fail, and what then helps; empty for methods that always converge
    character(len=120) :: caution = ''
    !> For records of contacts, which any number of ranks may share; for those that ranks share; for matrices, on one rank
    class(nlgs_t), allocatable :: sweeps
    class(coupled_solver_t), allocatable :: coupled
    class(matrix_solver_t), allocatable :: matrices
  contains
    procedure :: find_library
    procedure :: runs_alone
  end type method_t

contains

  !> All solvers, in the order in which `splitgrain solve --solver all` runs them.
  subroutine list_solvers(list)
    type(method_t), allocatable, intent(out) :: list(:) !! the solvers
    type(block_automatic_t) :: automatic
    type(nlgs_t) :: nlgs, nesterov
    type(block_nlgs_t) :: block_nlgs
    type(block_nesterov_t) :: block_nesterov
    type(accelerated_nlgs_t) :: accelerated
    type(proximal_newton_t) :: proximal
    type(interior_point_t) :: interior
    type(interior_ranks_t) :: interior_ranks

    allocate (list(0))
    call add(list, method_t('nlgs', 'nonlinear Gauss-Seidel sweeps'), sweeps=nlgs, matrices=block_nlgs)
    nesterov%has_momentum = .true.
    call add(list, method_t('nesterov', 'sweeps with momentum'), sweeps=nesterov, matrices=block_nesterov)
    call add(list, method_t('interior', 'interior points', needs_factors=.true.), matrices=interior, coupled=interior_ranks)
    call add(list, method_t('proximal', 'proximal points', needs_factors=.true.), matrices=proximal)
    call add(list, method_t('accelerated', 'accelerated sweeps'), matrices=accelerated)
    call add(list, method_t('auto', 'all others in turns', needs_factors=.true.), matrices=automatic)
  end subroutine list_solvers

  !> All couplings.
  subroutine list_couplings(list)
    type(method_t), allocatable, intent(out) :: list(:) !! the couplings
    type(dual_t) :: dual
    type(primal_t) :: primal
    type(momentum_t) :: momentum
    type(enriched_t) :: enriched

    allocate (list(0))
    call add(list, method_t('dual', 'shared grains brought to one velocity'), coupled=dual)
    call add(list, method_t('primal', 'contacts between parts solved as a part of their own'), coupled=primal)
    call add(list, method_t('momentum', 'contacts dealt to ranks that exchange the momentum of shared grains', &
                            former='contacts', caution='may stall where bodies hold each other in many ways; a smaller '// &
                            'partition.momentum.relaxation may help'), coupled=momentum)
    call add(list, method_t('enriched', 'as dual, with interface impulses that foresee what contacts answer', &
                            needs_factors=.true.), coupled=enriched)
  end subroutine list_couplings

  !> Add a method to a list.
  subroutine add(list, method, sweeps, coupled, matrices)
    type(method_t), allocatable, intent(inout) :: list(:)
    type(method_t), intent(in) :: method !! its name and facts; its objects follow
    class(nlgs_t), intent(in), optional :: sweeps
    class(coupled_solver_t), intent(in), optional :: coupled
    class(matrix_solver_t), intent(in), optional :: matrices
    type(method_t), allocatable :: grown(:)
    integer :: i, n

    n = size(list)
    allocate (grown(n + 1))
    do i = 1, n
      grown(i) = list(i)
    end do
    grown(n + 1) = method
    if (present(sweeps)) allocate (grown(n + 1)%sweeps, source=sweeps)
    if (present(coupled)) allocate (grown(n + 1)%coupled, source=coupled)
    if (present(matrices)) allocate (grown(n + 1)%matrices, source=matrices)
    call move_alloc(grown, list)
  end subroutine add

  !> Position of a method in a list; 0 when there is none of this name.
  pure integer function find_method(list, name) result(found)
    type(method_t), intent(in) :: list(:) !! solvers, or couplings
    character(len=*), intent(in) :: name !! name to look for

    found = findloc(list%name == name, .true., 1)
  end function find_method

  !> Names of all solvers, in order.
  function solver_names() result(names)
    character(len=len_of_name), allocatable :: names(:)
    type(method_t), allocatable :: list(:)

    call list_solvers(list)
    names = list%name
  end function solver_names

  !> Names of all couplings, in order.
  function coupling_names() result(names)
    character(len=len_of_name), allocatable :: names(:)
    type(method_t), allocatable :: list(:)

    call list_couplings(list)
    names = list%name
  end function coupling_names

  !> Does a method run on one rank alone?
  pure logical function runs_alone(self)
    class(method_t), intent(in) :: self

    runs_alone = .not. (allocated(self%sweeps) .or. allocated(self%coupled))
  end function runs_alone

  !> Does a solver sweep records of contacts, rather than solve their matrices?
  logical function is_swept(solver)
    character(len=*), intent(in) :: solver !! its name
    type(method_t), allocatable :: list(:)
    integer :: i

    call list_solvers(list)
    i = find_method(list, solver)
    is_swept = .false.
    if (i > 0) is_swept = allocated(list(i)%sweeps)
  end function is_swept

  !> Names of some methods as a message lists them: `"dual" or "primal"`.
  function quoted_names(list, is_listed) result(words)
    type(method_t), intent(in) :: list(:) !! solvers, or couplings
    logical, intent(in) :: is_listed(:) !! is each one of those listed?
    character(len=:), allocatable :: words
    type(text_t), allocatable :: names(:)
    integer :: i

    do i = 1, size(list)
      if (is_listed(i)) call append_word(names, '"'//trim(list(i)%name)//'"')
    end do
    words = joined(names, ' or ')
  end function quoted_names

  !> Look for the library that a method needs.
  subroutine find_library(self, error)
    class(method_t), intent(in) :: self
    type(error_t), allocatable, intent(out) :: error !! set when there is none

    if (self%needs_factors) call find_sparse_library(error)
  end subroutine find_library
end module sg_methods
