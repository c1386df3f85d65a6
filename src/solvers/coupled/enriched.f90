!> The enriched interface (doc/theory/enriched.md): the dual method with interface impulses that foresee what contacts answer.
!!
!! Step 1 sweeps each subdomain with given interface impulses, as the dual method does. Step 2 lets impulses of contacts that carry
!! follow relative velocities, r~ - r = -(v~ - v)/eta, so that the interface feels subdomains stiffened by their contacts,
!! M_eta,E = M_E + H_E H_E^T/eta, and X_eta dF = sum A_E V_E is solved by conjugate gradients. Copies of a body then have velocities
!! of their own, V_E = M_E^-1 (R_E^d + H_E r_E - A_E^T F). Tests and results take their mean, which is the velocity of the whole
!! body under all impulses, since masses of copies are equal and A_E^T F add up to nothing.
module sg_enriched
  use sg_comm, only: comm_t
  use sg_contact_sets, only: inner_set
  use sg_dual, only: dual_t
  use sg_error, only: error_t
  use sg_interface_cg, only: interface_cg_t, project
  use sg_kinds, only: wp, i4
  use sg_options, only: option_t, option_visitor_t
  use sg_problem, only: problem_t
  use sg_problem_records, only: contact_of, contact_record_t
  use sg_records, only: is_in_space
  use sg_report, only: report_t
  use sg_sparse, only: multiply_transposed, sparse_t
  use sg_subdomain, only: subdomain_t
  use sg_subdomain_factor, only: preconditioner_names, subdomain_factor_t
  use sg_subdomain_matrices, only: subdomain_matrices_t
  use sg_tables, only: per_body, per_contact, tables_t
  use sg_words, only: choice_index
  implicit none
  private
  public :: enriched_t

  !> What a contact does: nothing, sticks, slides
  integer, parameter :: is_open = 0, sticks = 1, slides = 2
  !> Shares of differences between copies that interface impulses take in so many rounds: automatic eta doubles above the first and
  !! halves below the second
  real(wp), parameter :: most_taken = 1.2_wp, least_taken = 0.3_wp
  integer, parameter :: rounds_observed = 10
  !> Damping below which the rest of a step is left to the dual method: errors did not fall four times
  real(wp), parameter :: least_damping = 0.1_wp
  !> Growth of their energy at which rounds diverge, also where impulses overshoot so much; bounds of the change of eta
  real(wp), parameter :: most_growth = 100, little_growth = 4, overshooting = 1.9_wp, most_change = 1e6_wp, least_change = 1e-2_wp
  !> A tangential impulse above this share of the friction limit slides
  real(wp), parameter :: at_limit = 1 - 1e-6_wp

  !> The enriched interface
  type, extends(dual_t) :: enriched_t
    !> Search direction of contacts that carry, and what it is relative to: each contact, their mean, or nothing
    real(wp) :: eta = 1
    character(len=16) :: scale = 'contact'
    !> Let eta follow what interface impulses have done to differences between copies?
    logical :: is_automatic = .false.
    !> Options of the interface system
    character(len=16) :: preconditioner = 'dirichlet'
    real(wp) :: tolerance = 1e-2_wp
    integer :: most_iterations = 500
    !> Share of contacts of a subdomain that may open, close, stick or slide before it is factorised again
    real(wp) :: changes = 0.1_wp
    type(subdomain_factor_t), private :: factor
    type(interface_cg_t), private :: cg
    !> Contacts with impulses, unit of eta at each [1/kg], and what each did when the factor was made
    integer(i4), allocatable, private :: contact(:)
    real(wp), allocatable, private :: unit(:)
    integer, allocatable, private :: state(:)
    !> Eta over that of the options, and least of that, which divergence raises for the rest of the step
    real(wp), private :: factor_of_eta = 1, least_factor = least_change
    !> Products of interface impulses with differences between copies, in the last rounds: with what they took away, and with all.
    !! Least of the latter in a round [N m]
    real(wp), private :: taken = 0, meant = 0, least = huge(1.0_wp)
    integer, private :: rounds = 0
    real(wp), allocatable, private :: last_impulse(:, :), last_difference(:, :)
    !> Eta of the factor; velocities of this rank's copies, kept while the problem holds their mean
    real(wp), private :: eta_of_factor = 0
    logical, private :: is_collected = .false.
    real(wp), allocatable, private :: own(:, :)
  contains
    procedure :: visit_options => enriched_visit_options
    procedure :: open => enriched_open
    procedure :: begin_round => enriched_begin_round
    procedure :: finish_round => enriched_finish_round
    procedure :: collect => enriched_collect
    procedure :: close => enriched_close
    procedure :: list_shared => enriched_list_shared
  end type enriched_t

contains

  !> Options of the enriched interface.
  subroutine enriched_visit_options(self, visitor)
    class(enriched_t), intent(inout) :: self
    class(option_visitor_t), intent(inout) :: visitor !! key table, or values of a deck

    call visitor%option(option_t('eta', 'Search direction: a change of relative velocity du changes impulses of contacts that '// &
                                 'carry by -du/eta. Small numbers expect stiff contacts.', above=0.0_wp), self%eta)
    call visitor%option(option_t('scale', 'Unit of eta: the mean of the diagonal of W at each contact, or over all contacts, '// &
                                 'to which compliance of the law is added; or 1/kg.', choices='contact|mean|absolute'), &
                        self%scale)
    call visitor%option(option_t('automatic', 'Eta doubles where interface impulses overshoot, and halves where they '// &
                                 'take less than 0.3 of the differences between copies.'), self%is_automatic)
    call visitor%option(option_t('preconditioner', 'Preconditioner of the interface: masses of shared bodies, with '// &
                                 'contacts on them, or with all that they move.', &
                                 choices=preconditioner_names), self%preconditioner)
    call visitor%option(option_t('tolerance', 'Differences between copies that conjugate gradients leave of those after a '// &
                                 'round.', above=0.0_wp, most=1.0_wp), self%tolerance)
    call visitor%option(option_t('most_iterations', 'Iterations within which they must get there; where they do not the '// &
                                 'rest of the step is left to the dual method.', least=1.0_wp), self%most_iterations)
    call visitor%option(option_t('changes', 'Share of the contacts of a subdomain that may open, close, stick or slide '// &
                                 'before its matrix is factorised again.', least=0.0_wp), self%changes)
  end subroutine enriched_visit_options

  !> Begin as the dual method does, and take the matrices of this subdomain.
  subroutine enriched_open(self, problem, coupling, comm)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%dual_t%open(problem, coupling, comm)
    call self%sets%nesterov%begin(.false.)
    self%cg%preconditioner = choice_index(trim(self%preconditioner), preconditioner_names)
    self%cg%tolerance = self%tolerance
    self%cg%most_iterations = self%most_iterations
    self%cg%iterations = 0
    self%cg%failures = 0
    call take_matrices(self, problem, comm)
    self%is_collected = .false.
    self%eta_of_factor = 0
    self%factor_of_eta = 1
    self%least_factor = least_change
    self%rounds = 0
    self%taken = 0
    self%meant = 0
    self%least = huge(1.0_wp)
    if (allocated(self%last_impulse)) deallocate (self%last_impulse, self%last_difference)
    if (allocated(self%own)) deallocate (self%own)
    allocate (self%own(self%width, size(self%gluing%interface%slot)), source=0.0_wp)
    call update_factor(self, problem)
  end subroutine enriched_open

  !> Take H_E and M_E with divided masses, and set the units of eta. Collective.
  subroutine take_matrices(self, problem, comm)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(comm_t), intent(inout) :: comm
    type(subdomain_matrices_t) :: matrices

    call matrices%take(problem, self%gluing%interface%slot)
    call matrices%prepare_factor(self%gluing%interface%slot, self%width, self%factor)
    self%contact = matrices%contact
    call set_units(self, matrices%contacts, matrices%mass, matrices%h, comm)
    self%state = 0*self%contact - 1
  end subroutine take_matrices

  !> Set the unit of eta at each contact. Collective.
  subroutine set_units(self, contacts, mass, h, comm)
    class(enriched_t), intent(inout) :: self
    type(contact_record_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: mass(:)
    type(sparse_t), intent(in) :: h
    type(comm_t), intent(inout) :: comm
    type(sparse_t) :: squares
    real(wp) :: w(h%n_columns), sums(2)
    integer :: k, d

    self%unit = [(1.0_wp, k=1, size(contacts))]
    if (self%scale == 'absolute') return
    squares = h
    squares%value = h%value**2
    call multiply_transposed(squares, 1/mass, w)
    sums = 0
    do k = 1, size(contacts)
      d = h%n_columns/size(contacts)
      associate (first => d*(k - 1) + 1, last => d*(k - 1) + merge(d, 1, contacts(k)%has_tangent))
        self%unit(k) = sum(w(first:last))/real(last - first + 1, wp)
        sums = sums + [sum(w(first:last)), real(last - first + 1, wp)]
      end associate
    end do
    if (self%scale == 'contact') return
    call comm%sum(sums)
    self%unit = sums(1)/max(1.0_wp, sums(2))
  end subroutine set_units

  !> Factorise again where contacts have changed what they do, or eta has changed.
  subroutine update_factor(self, problem)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! its impulses are those of the last test
    type(contact_record_t) :: contact
    type(error_t), allocatable :: error
    real(wp), allocatable :: blocks(:, :, :)
    integer :: state(size(self%contact)), k, i, d
    real(wp) :: eta
    logical :: is_enriched

    ! Where errors did not fall again and again, or an interface system did not converge, the rest of the step is left to the dual
    ! method, which always converges.
    is_enriched = self%damping >= least_damping .and. self%cg%failures == 0
    eta = huge(1.0_wp)
    if (is_enriched) eta = self%eta*self%factor_of_eta
    d = merge(3, 2, is_in_space(problem%kind))
    allocate (blocks(d, d, size(self%contact)), source=0.0_wp)
    do k = 1, size(self%contact)
      contact = contact_of(problem, int(self%contact(k)))
      state(k) = state_of(contact)
      if (.not. is_enriched .or. state(k) == is_open .or. .not. self%unit(k) > 0) cycle
      do i = 1, merge(d, 1, contact%has_tangent .and. state(k) == sticks)
        blocks(i, i, k) = 1/(eta*self%unit(k) + merge(0.0_wp, contact%compliance(i), self%scale == 'absolute'))
      end do
    end do
    if (.not. abs(eta - self%eta_of_factor) > 0 .and. &
        real(count(state /= self%state), wp) <= self%changes*real(max(1, size(state)), wp)) return
    self%state = state
    self%eta_of_factor = eta
    call self%factor%factorise(blocks, error, must_hold_masses=.true.)
  end subroutine update_factor

  !> What a contact does under its impulse.
  pure integer function state_of(contact) result(state)
    type(contact_record_t), intent(in) :: contact

    associate (r => contact%impulse)
      if (contact%is_linear) then
        ! Some are linear along the normal alone.
        state = merge(slides, sticks, abs(r(1)) > 0 .and. .not. any(abs(r(2:)) > 0) .and. .not. any(contact%compliance(2:) > 0))
      else if (.not. any(abs(r) > 0)) then
        state = is_open
      else if (norm2(r(2:)) < at_limit*contact%friction*(r(1) + contact%cohesion)) then
        state = sticks
      else
        state = slides
      end if
    end associate
  end function state_of

  !> Give copies their own velocities back, and sweep contacts of shared bodies.
  subroutine enriched_begin_round(self, problem, report)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(report_t), intent(inout) :: report !! contact updates are counted

    integer :: i

    if (self%is_collected) then
      do i = 1, size(self%own, 2)
        if (self%factor%takes_part(i)) problem%body(:self%width, self%gluing%interface%slot(i)) = self%own(:, i)
      end do
      self%is_collected = .false.
      if (self%is_automatic) call adapt_eta(self)
      call update_factor(self, problem)
    end if
    call self%dual_t%begin_round(problem, report)
  end subroutine enriched_begin_round

  !> Sweep the others, as often as the options ask, and update the interface impulses.
  subroutine enriched_finish_round(self, problem, is_cut, comm, report)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: is_cut !! leave the round as it is
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! contact updates are counted
    integer :: i

    if (is_cut) return
    do i = 1, self%partition%sweeps_of(comm%rank)
      if (i > 1) call self%dual_t%begin_round(problem, report)
      call self%sets%sweep(inner_set, problem, self%options%relaxation, report)
    end do
    call update_impulses(self, problem, comm)
    report%iterations = self%cg%iterations
    report%factorisations = self%factor%factorisations
    report%failed_factors = self%factor%failures
    report%failed_systems = self%cg%failures
  end subroutine enriched_finish_round

  !> Let eta follow the Rayleigh quotient of the pencil (X, X_eta) at the interface impulses of some rounds: the share of the
  !! differences between copies that they have taken away, 1 where the contacts answered as foreseen.
  pure subroutine adapt_eta(self)
    class(enriched_t), intent(inout) :: self

    if (self%rounds < rounds_observed) return
    if (self%taken > most_taken*self%meant) self%factor_of_eta = min(most_change, 2*self%factor_of_eta)
    if (self%taken < least_taken*self%meant) self%factor_of_eta = max(self%least_factor, self%factor_of_eta/2)
    self%rounds = 0
    self%taken = 0
    self%meant = 0
  end subroutine adapt_eta

  !> Step 2: interface impulses that would make velocities of copies agree if contacts followed the search direction.
  subroutine update_impulses(self, problem, comm)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! velocities of copies change
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable :: velocity(:, :), impulse(:, :)

    associate (interface => self%gluing%interface)
      velocity = problem%body(:self%width, interface%slot) - self%gluing%before
      call project(interface, self%factor, velocity, comm)
      call observe(self, problem, velocity, comm)
      allocate (impulse, mold=velocity)
      call self%cg%solve(interface, self%factor, velocity, impulse, comm)
      self%last_impulse = impulse
      if (self%cg%failures > 0) call update_factor(self, problem)
      call self%factor%apply_inverse_mass(impulse)
      problem%body(:self%width, interface%slot) = problem%body(:self%width, interface%slot) - impulse
    end associate
  end subroutine update_impulses

  !> Observe what the last interface impulses have done to differences between copies; where rounds diverge eta grows at once.
  subroutine observe(self, problem, difference, comm)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    real(wp), intent(in) :: difference(:, :)
    type(comm_t), intent(inout) :: comm
    real(wp) :: products(2)

    if (allocated(self%last_impulse)) then
      products = [sum(self%last_impulse*(self%last_difference - difference)), sum(self%last_impulse*self%last_difference)]
      call comm%sum(products)
      self%rounds = self%rounds + 1
      self%taken = self%taken + products(1)
      self%meant = self%meant + products(2)
      self%least = min(self%least, products(2))
      if (products(2) > most_growth*self%least .or. &
          (products(2) > little_growth*self%least .and. products(1) > overshooting*products(2))) then
        self%factor_of_eta = min(most_change, 4*self%factor_of_eta)
        self%least_factor = self%factor_of_eta
        self%rounds = 0
        self%taken = 0
        self%meant = 0
        self%least = huge(1.0_wp)
        call update_factor(self, problem)
      end if
    end if
    self%last_difference = difference
  end subroutine observe

  !> Collect the impulses in the problem, and give all copies of a body their mean velocity; own ones come back with the next round.
  subroutine enriched_collect(self, problem, comm)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%sets%give_impulses(problem)
    if (self%is_collected) return
    associate (gluing => self%gluing)
      self%own(:, :) = problem%body(:self%width, gluing%interface%slot)
      call gluing%begin(problem, comm)
      call gluing%finish(problem, comm)
    end associate
    self%is_collected = .true.
  end subroutine enriched_collect

  !> Give the factors back, make masses whole, and give the velocities found to the copies that took no part.
  subroutine enriched_close(self, problem, coupling, comm)
    class(enriched_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part, collected
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%factor%free()
    call self%dual_t%close(problem, coupling, comm)
  end subroutine enriched_close

  !> List the tables of the gluing, of copies, and of the matrix of this subdomain.
  subroutine enriched_list_shared(self, tables)
    class(enriched_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%dual_t%list_shared(tables)
    call tables%begin('enriched', per_body)
    call tables%note('own', self%own)
    call tables%note('last_impulse', self%last_impulse)
    call tables%note('last_difference', self%last_difference)
    call tables%begin('enriched', per_contact)
    call tables%note('contact', self%contact)
    call tables%note('unit', self%unit)
    call tables%note('state', self%state)
    call tables%begin('subdomain factor', per_contact)
    call self%factor%note_tables(tables)
  end subroutine enriched_list_shared
end module sg_enriched
