!> The contact problem of one step as a value: compact records that a sweep reads, in spatial order.
!!
!! The kind of problem decides how long a record is (doc/theory/contact_problem.md). *Round* problems have lever arms
!! along the normals of all bodies that turn (disks): the spin is carried as radius times spin, so that the radius
!! drops out. *Arm* problems are general. Frictionless problems have one impulse component and no tangent at all.
!! *Ball* and *solid* problems are the same two in space; their frictional impulses are vectors in the world's axes.
module sg_problem
  use sg_kinds, only: wp, i4, i8
  implicit none
  private
  public :: problem_t, reserve_problem, bytes_per_contact, growth_of_problem, problem_kind
  public :: round_frictionless, round_frictional, arm_frictionless, arm_frictional
  public :: ball_frictionless, ball_frictional, solid_frictionless, solid_frictional
  public :: first_inverse, free_axes, is_compact, is_in_space
  public :: arm_bonded, solid_bonded, plain_kind

  !> Kinds of problem
  integer, parameter :: round_frictionless = 1, round_frictional = 2, arm_frictionless = 3, arm_frictional = 4, &
                        ball_frictionless = 5, ball_frictional = 6, solid_frictionless = 7, solid_frictional = 8

  !> Kinds of problem with cohesive zones: records of the frictional kind, followed by what bonds add
  integer, parameter :: arm_bonded = 9, solid_bonded = 10

  !> Reals of a contact's record, by kind.
  !!
  !! - round, frictionless: n_x, n_y, bias, 1/W_nn
  !! - round, frictional: n_x, n_y, bias_n, bias_t, 1/W_nn, 1/W_tt, friction
  !! - arm, frictionless: n_x, n_y, turn_c, turn_a, bias, 1/W_nn
  !! - arm, frictional: n_x, n_y, turn_nc, turn_tc, turn_na, turn_ta, bias_n, bias_t, W_nn, W_nt, W_tt, friction,
  !!   cohesion, compliance_n, compliance_t, kind of local law
  !! - ball, frictionless: n (3), bias, 1/W_nn
  !! - ball, frictional: n (3), bias (3), 1/W_nn, 1/W_tt, friction
  !! - solid, frictionless: n (3), arm_c x n (3), arm_a x n (3), bias, 1/W_nn
  !! - solid, frictional: n (3), t (3), arm_c (3), arm_a (3), bias (3), W_nn, W_n1, W_n2, S_1, S_2, friction, cohesion,
  !!   compliance_n, compliance_t, kind of local law, 1/lambda_max(W); t is the first tangent, the second is n x t, and in
  !!   both S, the Schur complement of W_nn in W, is diagonal
  !!
  !! The kind of local law is 0 where the contact takes no part, 1 for a unilateral one, 2 for a linear one, 3 for one that is
  !! linear along the normal and carries nothing along tangents: in space its t is zero, so that kernels find no tangents.
  !! - bonded: the frictional record of the same dimension, then stiffness_n and stiffness_t of the bond times the square of the
  !!   step, and its slip over the step, in space a vector; its block is (W^-1 + K)^-1, with K those stiffnesses
  integer, parameter :: record_length(10) = [4, 7, 6, 16, 5, 9, 11, 26, 19, 31]
  !> Reals of a body's record: velocities, then inverse masses. Round and ball frictional ones carry R spin and R^2/I, solid
  !! ones spin and inverse inertia (xx, yy, zz, xy, xz, yz) in the world's axes.
  !!
  !! A ball frictional one has one inverse mass for all directions, so that it fills a cache line. Of a body that does not
  !! turn and is driven in some directions only, -1, -2 and -4 in place of R^2/I mark x, y and z as free.
  integer, parameter :: body_length(10) = [4, 6, 6, 6, 6, 8, 16, 16, 6, 16]
  !> Impulse components
  integer, parameter :: impulse_length(10) = [1, 2, 1, 2, 1, 3, 1, 3, 2, 3]
  !> Where the inverse masses begin in a body's record
  integer, parameter :: first_inverse(10) = [3, 4, 4, 4, 4, 7, 7, 7, 4, 7]

  !> One contact problem
  type :: problem_t
    !> Kind of problem, one of those above; 0 before the first assembly
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
    !> Gravity times step [m/s]
    real(wp) :: fall_speed = 0
    !> Velocity scale of the violation [m/s]: that speed; where there is no gravity, the rms of q
    real(wp) :: velocity_scale = 0
    !> Largest relative velocity without impulses among contacts that close, stick together or are linear [m/s]
    real(wp) :: closing_speed = 0
    !> Largest friction of the contacts; unknown unless the problem is assembled
    real(wp) :: most_friction = huge(1.0_wp)
  end type problem_t

contains

  !> Kind of problem for a scene whose arms all lie along normals or not, with or without a tangent.
  pure integer function problem_kind(dimension, is_round, has_tangent, has_bonds)
    integer, intent(in) :: dimension !! of space
    logical, intent(in) :: is_round !! all arms of bodies that turn lie along normals
    logical, intent(in) :: has_tangent !! there is a tangential impulse
    logical, intent(in), optional :: has_bonds !! there are cohesive zones

    problem_kind = merge(merge(round_frictional, round_frictionless, has_tangent), &
                         merge(arm_frictional, arm_frictionless, has_tangent), is_round)
    if (dimension == 3) problem_kind = problem_kind + ball_frictionless - round_frictionless
    if (.not. present(has_bonds)) return
    if (has_bonds) problem_kind = merge(arm_bonded, solid_bonded, dimension == 2)
  end function problem_kind

  !> Does a kind of problem carry no lever arms?
  pure logical function is_compact(kind)
    integer, intent(in) :: kind !! kind of problem

    is_compact = any(kind == [round_frictionless, round_frictional, ball_frictionless, ball_frictional])
  end function is_compact

  !> Which directions of a ball's body impulses can move it in: 1 for free, 0 for driven.
  pure function free_axes(mark) result(axes)
    real(wp), intent(in) :: mark !! last real of its record: R^2/I, or marks of free directions
    real(wp) :: axes(3)
    integer :: bits

    axes = 1
    if (mark >= 0) return
    bits = -nint(mark)
    axes = real(ibits(bits, [0, 1, 2], 1), wp)
  end function free_axes

  !> Is a kind of problem one in space?
  pure logical function is_in_space(kind)
    integer, intent(in) :: kind !! kind of problem

    is_in_space = kind >= ball_frictionless .and. kind /= arm_bonded
  end function is_in_space

  !> The kind without bonds whose record a kind of problem begins with.
  pure integer function plain_kind(kind)
    integer, intent(in) :: kind !! kind of problem

    plain_kind = kind
    if (kind == arm_bonded) plain_kind = arm_frictional
    if (kind == solid_bonded) plain_kind = solid_frictional
  end function plain_kind

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
    if (now < n_contacts) bytes = int(8 + 8*(record_length(kind) + impulse_length(kind)), i8)*int(room(n_contacts) - now, i8)
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
