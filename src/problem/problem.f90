!> The contact problem of one step as a value: compact records that a sweep reads, in spatial order.
module sg_problem
  use sg_cell_problem, only: cell_problem_t
  use sg_kinds, only: wp, i4, i8
  use sg_records, only: active_place, body_length, friction_place, impulse_length, record_length
  implicit none
  private
  public :: problem_t, reserve_problem, bytes_per_contact, growth_of_problem, is_active, friction_of

  !> One contact problem
  type :: problem_t
    !> Kind of problem, one of those of sg_records; 0 before the first assembly
    integer :: kind = 0
    !> Number of contacts and of bodies (slots)
    integer :: n_contacts = 0, n_bodies = 0
    !> Slots of candidate and antagonist, shape (2, contacts)
    integer(i4), allocatable :: pair(:, :)
    !> Geometry, block and law, shape (record_length, contacts)
    real(wp), allocatable :: record(:, :)
    !> Impulses, shape (impulse_length, contacts): the guess, then the solution
    real(wp), allocatable :: impulse(:, :)
    !> Normal relative velocities without impulses, with bias [m/s], shape (contacts): highest where a contact takes no part, lowest
    !! where it has more than unilateral contact and friction, or where nothing is known
    real(wp), allocatable :: opening(:)
    !> Velocities and inverse masses by slot, shape (body_length, bodies): free velocities, then the solution
    real(wp), allocatable :: body(:, :)
    !> Can impulses move each of the bodies? There only where these have been loaded from those of a scene
    logical, allocatable :: moves(:)
    !> Largest component of their free velocities [m/s], where they have
    real(wp) :: fastest = 0
    !> Has a body a driven spin, which records of round shapes do not carry? Unknown unless the problem is assembled
    logical :: drives_spin = .false.
    !> Norm of q, the relative velocities (with bias) without impulses [m/s]
    real(wp) :: free_norm = 0
    !> Gravity times step [m/s]
    real(wp) :: fall_speed = 0
    !> Velocity scale of the violation [m/s]: that speed; where there is no gravity, the rms of q
    real(wp) :: velocity_scale = 0
    !> Largest relative velocity without impulses among contacts that close, stick together or are linear [m/s]
    real(wp) :: closing_speed = 0
    !> Largest friction of the contacts; unknown unless the problem is assembled
    real(wp) :: most_friction = huge(1.0_wp)
    !> Are contacts, bodies and slots those of the problem that was solved before, as in a later substep? Then orders of sweeps stay
    logical :: is_continued = .false.
    !> Unknown rates of a periodic cell, where its stress is imposed
    type(cell_problem_t) :: cell
  end type problem_t

contains

  !> Can a contact carry an impulse?
  pure logical function is_active(problem, k)
    type(problem_t), intent(in) :: problem !! problem
    integer, intent(in) :: k !! contact

    is_active = problem%record(active_place(problem%kind), k) > 0
  end function is_active

  !> Coulomb's coefficient of a contact; zero where nothing rubs.
  pure real(wp) function friction_of(problem, k)
    type(problem_t), intent(in) :: problem !! problem
    integer, intent(in) :: k !! contact

    friction_of = 0
    if (friction_place(problem%kind) > 0) friction_of = problem%record(friction_place(problem%kind), k)
  end function friction_of

  !> Make room for a problem.
  subroutine reserve_problem(problem, kind, n_bodies, n_contacts)
    type(problem_t), intent(inout) :: problem !! problem to make room in
    integer, intent(in) :: kind !! kind of problem
    integer, intent(in) :: n_bodies !! bodies
    integer, intent(in) :: n_contacts !! contacts
    logical :: fits

    fits = allocated(problem%record) .and. problem%kind == kind .and. problem%n_bodies == n_bodies
    if (fits) fits = size(problem%record, 2) >= n_contacts
    problem%kind = kind
    problem%n_bodies = n_bodies
    problem%n_contacts = n_contacts
    if (fits) return
    if (allocated(problem%record)) deallocate (problem%record, problem%impulse, problem%pair, problem%body)
    if (allocated(problem%opening)) deallocate (problem%opening)
    if (allocated(problem%moves)) deallocate (problem%moves)
    allocate (problem%pair(2, room(n_contacts)), source=0_i4)
    allocate (problem%record(record_length(kind), room(n_contacts)), source=0.0_wp)
    allocate (problem%impulse(impulse_length(kind), room(n_contacts)), source=0.0_wp)
    allocate (problem%opening(room(n_contacts)), source=-huge(1.0_wp))
    allocate (problem%body(body_length(kind), n_bodies), source=0.0_wp)
  end subroutine reserve_problem

  !> Contacts that a problem has room for when it is made for `n`.
  pure integer function room(n)
    integer, intent(in) :: n

    room = n + n/8 + 16
  end function room

  !> What making room for contacts takes [bytes].
  pure integer(i8) function growth_of_problem(problem, kind, n_contacts) result(bytes)
    type(problem_t), intent(in) :: problem !! problem to make room in
    integer, intent(in) :: kind !! kind of problem
    integer, intent(in) :: n_contacts !! contacts
    integer :: now

    now = 0
    if (allocated(problem%record)) now = size(problem%record, 2)
    bytes = 0
    if (now < n_contacts) bytes = int(16 + 8*(record_length(kind) + impulse_length(kind)), i8)*int(room(n_contacts) - now, i8)
  end function growth_of_problem

  !> Bytes that a sweep needs to hold per contact, bodies included.
  pure real(wp) function bytes_per_contact(problem) result(bytes)
    type(problem_t), intent(in) :: problem !! problem to weigh

    bytes = 0
    if (problem%n_contacts == 0) return
    bytes = real(8 + 8*record_length(problem%kind) + 8*impulse_length(problem%kind), wp) &
            + 8*real(body_length(problem%kind), wp)*real(problem%n_bodies, wp)/real(problem%n_contacts, wp)
  end function bytes_per_contact
end module sg_problem
