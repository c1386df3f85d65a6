!> Spectral radii of the dual method and of the enriched interface on the first contact problem of a deck
!! (doc/theory/spectral_radius.md).
module sg_spectral_radii
  use sg_assemble, only: assemble
  use sg_contact_status, only: rest_speed, status_of
  use sg_contraction, only: contraction_t
  use sg_detect, only: detect
  use sg_eigenvalues, only: find_eigenvalues
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4
  use sg_laws, only: status_none, status_slide
  use sg_load, only: measured_weights
  use sg_motion, only: predict
  use sg_problem_records, only: contact_of, contact_record_t
  use sg_records, only: is_in_space
  use sg_relative_epsilon, only: set_relative_epsilon
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: simulation_t
  use sg_solve_step, only: solve_step
  use sg_start_split, only: find_contacts, split_bodies
  use sg_text, only: to_text
  implicit none
  private
  public :: spectral_radii_t, first_problem, radii_of

  !> Tolerance on e8 and sweeps at most of the solve that finds which contacts hold
  real(wp), parameter :: tight = 1e-10_wp
  integer, parameter :: most_sweeps = 1000000
  !> Unknowns of the interface, and contacts, that full matrices are made for at most
  integer, parameter :: most_unknowns = 1000, most_contacts = 2000

  !> Radii for one epsilon, against eta
  type :: spectral_radii_t
    !> Velocity per impulse of linear interactions [1/kg]; not used near the solution of a problem of contact
    real(wp) :: epsilon = 0
    !> Radius of the dual method
    real(wp) :: dual = 0
    !> Search directions [1/kg] and radii of the enriched interface
    real(wp), allocatable :: eta(:), enriched(:)
  end type spectral_radii_t

contains

  !> Assemble the first contact problem of a scene, and build its contraction matrices; where interactions are not linear it is
  !! solved, so that contacts hold, slide or are open.
  subroutine first_problem(sim, n_subdomains, contraction, is_linear, epsilon, error)
    type(simulation_t), intent(inout) :: sim !! its scene and options are set
    integer, intent(in) :: n_subdomains !! subdomains
    type(contraction_t), intent(out) :: contraction !! the matrices
    logical, intent(out) :: is_linear !! are all interactions linear?
    real(wp), intent(out) :: epsilon !! of linear interactions, velocity per impulse [1/kg]
    type(error_t), allocatable, intent(out) :: error !! set when they cannot be made
    integer(i4), allocatable :: part(:)
    real(wp), allocatable :: load(:)
    integer :: boxes(3)

    is_linear = .false.
    epsilon = 0
    associate (solver => sim%options%solver)
      solver%criterion = criterion_e8
      solver%tolerance = tight
      solver%maximum_sweeps = most_sweeps
      solver%warm_start = .false.
    end associate
    call find_contacts(sim, error)
    if (allocated(error)) return
    associate (bodies => sim%scene%bodies)
      load = measured_weights(sim%contacts, bodies%is_grain, bodies%n_own)
    end associate
    call split_bodies(sim, load, n_subdomains, boxes, part, error)
    if (allocated(error)) return
    call predict(sim%scene, sim%time(), sim%options%substep_length(), sim%options%theta)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, sim%options%substep_length(), sim%problem)
    call set_relative_epsilon(sim%scene, sim%contacts, sim%comm, sim%problem)
    call check_problem(sim, is_linear, epsilon, error)
    if (allocated(error)) return
    call contraction%build(sim%problem, part(sim%pairs%body_of) - 1_i4, n_subdomains)
    if (contraction%unknowns == 0) then
      call fail(error, 'the subdomains share no body: there is no interface')
    else if (contraction%unknowns > most_unknowns) then
      call fail(error, 'the interface has '//to_text(contraction%unknowns)//' unknowns; full matrices are made for at most '// &
                to_text(most_unknowns))
    else if (.not. is_linear) then
      call find_holding(sim, contraction, error)
    end if
  end subroutine first_problem

  !> Which interactions are there: all linear with one epsilon, or unilateral contact with Coulomb friction alone.
  subroutine check_problem(sim, is_linear, epsilon, error)
    type(simulation_t), intent(in) :: sim
    logical, intent(out) :: is_linear
    real(wp), intent(out) :: epsilon
    type(error_t), allocatable, intent(out) :: error
    type(contact_record_t) :: contact
    integer :: k, n_linear
    logical :: is_uniform, is_plain

    epsilon = 0
    n_linear = 0
    is_uniform = .true.
    is_plain = .true.
    do k = 1, sim%contacts%n
      contact = contact_of(sim%problem, k)
      if (contact%is_linear) then
        n_linear = n_linear + 1
        if (n_linear == 1) epsilon = contact%compliance(1)
        is_uniform = is_uniform .and. .not. abs(contact%compliance(1) - epsilon) > 0
      else
        is_plain = is_plain .and. .not. (contact%is_bonded .or. contact%has_moment .or. contact%cohesion > 0 .or. &
                                          maxval(contact%compliance) > 0)
      end if
    end do
    is_linear = n_linear > 0
    if (sim%contacts%n == 0) then
      call fail(error, 'the scene has no contacts at its start')
    else if (sim%contacts%n > most_contacts) then
      call fail(error, 'the scene has '//to_text(sim%contacts%n)//' contacts; full matrices are made for at most '// &
                to_text(most_contacts))
    else if (is_linear .and. .not. (n_linear == sim%contacts%n .and. is_uniform)) then
      call fail(error, 'some interactions are linear and others are not, or differ in epsilon: there is no one epsilon')
    else if (.not. is_plain) then
      call fail(error, 'spectral radii are found for linear interactions, or for unilateral contact with Coulomb friction')
    end if
  end subroutine check_problem

  !> Solve the problem, and let contacts hold, slide or be open as they do.
  subroutine find_holding(sim, contraction, error)
    type(simulation_t), intent(inout) :: sim
    type(contraction_t), intent(inout) :: contraction
    type(error_t), allocatable, intent(out) :: error
    logical, allocatable :: holds(:), slides(:)
    real(wp) :: rest
    integer :: k

    call solve_step(sim)
    if (.not. sim%report%is_converged) then
      call fail(error, 'the first contact problem is not solved within '//to_text(most_sweeps)//' sweeps')
      return
    end if
    rest = rest_speed(sim%problem, sim%report%violation)
    allocate (holds(sim%contacts%n), slides(sim%contacts%n))
    do k = 1, sim%contacts%n
      associate (status => status_of(sim%problem, k, .false., 0.0_wp, rest), contact => contact_of(sim%problem, k))
        holds(k) = status /= status_none
        slides(k) = status == status_slide .and. contact%friction > 0
      end associate
    end do
    if (any(slides) .and. is_in_space(sim%problem%kind)) then
      call fail(error, 'contacts slide, whose direction may turn in space: spectral radii are found in the plane there')
    else
      call contraction%hold(sim%problem, holds, slides)
    end if
  end subroutine find_holding

  !> Radii for one epsilon, or near the solution of a problem of contact.
  subroutine radii_of(contraction, is_linear, epsilon, eta, radii, error)
    type(contraction_t), intent(in) :: contraction !! matrices
    logical, intent(in) :: is_linear !! are the interactions linear?
    real(wp), intent(in) :: epsilon !! velocity per impulse of linear ones [1/kg]
    real(wp), intent(in) :: eta(:) !! search directions [1/kg]
    type(spectral_radii_t), intent(out) :: radii !! the radii
    type(error_t), allocatable, intent(out) :: error !! set where a matrix is singular, or LAPACK is missing
    real(wp), allocatable :: b(:, :)
    integer :: i

    radii%epsilon = epsilon
    radii%eta = eta
    allocate (radii%enriched(size(eta)), source=0.0_wp)
    if (is_linear) then
      call contraction%dual(epsilon, b, error)
    else
      call contraction%dual_held(b, error)
    end if
    if (.not. allocated(error)) call find_radius(b, radii%dual, error)
    do i = 1, size(eta)
      if (allocated(error)) return
      if (is_linear) then
        call contraction%enriched(epsilon, eta(i), b, error)
      else
        call contraction%enriched_held(eta(i), b, error)
      end if
      if (.not. allocated(error)) call find_radius(b, radii%enriched(i), error)
    end do
  end subroutine radii_of

  !> Spectral radius of a matrix.
  subroutine find_radius(matrix, radius, error)
    real(wp), intent(in) :: matrix(:, :)
    real(wp), intent(out) :: radius
    type(error_t), allocatable, intent(out) :: error
    complex(wp) :: values(size(matrix, 1))

    call find_eigenvalues(matrix, values, error)
    radius = maxval(abs(values))
  end subroutine find_radius
end module sg_spectral_radii
