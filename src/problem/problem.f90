!> The contact problem of one step as a value: compact records that a sweep reads, in spatial order.
!!
!! The kind of problem decides how long a record is (doc/theory/contact_problem.md). *Round* problems have lever arms
!! along the normals of all bodies that turn (disks): the spin is carried as radius times spin, so that the radius
!! drops out. *Arm* problems are general. Frictionless problems have one impulse component and no tangent at all.
module sg_problem
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: problem_t, reserve_problem, bytes_per_contact, problem_kind
  public :: round_frictionless, round_frictional, arm_frictionless, arm_frictional

  !> Kinds of problem
  integer, parameter :: round_frictionless = 1, round_frictional = 2, arm_frictionless = 3, arm_frictional = 4

  !> Reals of a contact's record, by kind.
  !!
  !! - round, frictionless: n_x, n_y, bias, 1/W_nn
  !! - round, frictional: n_x, n_y, bias_n, bias_t, 1/W_nn, 1/W_tt, friction
  !! - arm, frictionless: n_x, n_y, turn_c, turn_a, bias, 1/W_nn
  !! - arm, frictional: n_x, n_y, turn_nc, turn_tc, turn_na, turn_ta, bias_n, bias_t, W_nn, W_nt, W_tt, friction,
  !!   cohesion, compliance_n, compliance_t, kind of local law
  integer, parameter :: record_length(4) = [4, 7, 6, 16]
  !> Reals of a body's record: velocities, then inverse masses; round frictional ones carry R spin and R^2/I
  integer, parameter :: body_length(4) = [4, 6, 6, 6]
  !> Impulse components
  integer, parameter :: impulse_length(4) = [1, 2, 1, 2]

  !> One contact problem
  type :: problem_t
    !> Kind of problem, one of the four above; 0 before the first assembly
    integer :: kind = 0
    !> Number of contacts and of bodies (slots)
    integer :: n_contacts = 0, n_bodies = 0
    !> Slots of candidate and antagonist, shape (2, contacts)
    integer(i4), allocatable :: pair(:, :)
    !> Geometry, block and law, shape (record_length, contacts)
    real(wp), allocatable :: record(:, :)
    !> Impulses, shape (impulse_length, contacts): the guess, then the solution
    real(wp), allocatable :: impulse(:, :)
    !> Velocities and inverse masses by slot, shape (body_length, bodies): free velocities, then the solution
    real(wp), allocatable :: body(:, :)
    !> Norm of q, the relative velocities (with bias) without impulses [m/s]
    real(wp) :: free_norm = 0
    !> Velocity scale of the violation, gravity times step [m/s]; where there is no gravity, the rms of q
    real(wp) :: velocity_scale = 0
  end type problem_t

contains

  !> Kind of problem for a scene whose arms all lie along normals or not, with or without a tangent.
  pure integer function problem_kind(is_round, has_tangent)
    logical, intent(in) :: is_round !! all arms of bodies that turn lie along normals
    logical, intent(in) :: has_tangent !! there is a tangential impulse

    problem_kind = merge(merge(round_frictional, round_frictionless, has_tangent), &
                         merge(arm_frictional, arm_frictionless, has_tangent), is_round)
  end function problem_kind

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
    allocate (problem%pair(2, room(n_contacts)), source=0_i4)
    allocate (problem%record(record_length(kind), room(n_contacts)), source=0.0_wp)
    allocate (problem%impulse(impulse_length(kind), room(n_contacts)), source=0.0_wp)
    allocate (problem%body(body_length(kind), n_bodies), source=0.0_wp)
  contains
    pure integer function room(n)
      integer, intent(in) :: n

      room = n + n/8 + 16
    end function room
  end subroutine reserve_problem

  !> Bytes that a sweep needs to hold per contact, bodies included.
  pure real(wp) function bytes_per_contact(problem) result(bytes)
    type(problem_t), intent(in) :: problem !! problem to weigh

    bytes = 0
    if (problem%n_contacts == 0) return
    bytes = real(8 + 8*record_length(problem%kind) + 8*impulse_length(problem%kind), wp) &
            + 8*real(body_length(problem%kind), wp)*real(problem%n_bodies, wp)/real(problem%n_contacts, wp)
  end function bytes_per_contact
end module sg_problem
