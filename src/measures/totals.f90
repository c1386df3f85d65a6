!> What a whole run cost and how well it was solved: sums and worst values over the steps.
module sg_totals
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan, ieee_quiet_nan, ieee_value
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i8
  use sg_moments_of_run, only: moment_t, n_moment_values
  use sg_report, only: report_t, worse
  use sg_text, only: to_text
  use sg_timers, only: timer_t
  implicit none
  private
  public :: totals_t, find_moment, reduce_report, worst_contact_words, n_phases, phase_names, n_totals_values
  public :: phase_predict, phase_detect, phase_assemble, phase_solve, phase_update, phase_measure, phase_output

  !> Phases of a step
  integer, parameter :: phase_predict = 1, phase_detect = 2, phase_assemble = 3, phase_solve = 4, phase_update = 5, &
                        phase_measure = 6, phase_output = 7
  !> Number of phases
  integer, parameter :: n_phases = 7
  !> Words for the phases
  character(len=8), parameter :: phase_names(n_phases) = &
    [character(len=8) :: 'predict', 'detect', 'assemble', 'solve', 'update', 'measure', 'output']

  !> Sums and worst values that `pack` writes before the timers
  integer, parameter :: n_sums = 22 + 2*n_moment_values
  !> Numbers that `pack` writes
  integer, parameter :: n_totals_values = n_sums + 2*(n_phases + 1)

  !> Totals since the start of the run, restarts included; in a decomposed scene those of this rank, until they are reduced
  type :: totals_t
    !> Steps done, and how many of them converged or not
    integer :: steps = 0, converged_steps = 0, unconverged_steps = 0
    !> Worst errors of all steps (doc/theory/errors.md)
    real(wp) :: worst_e1 = 0, worst_e2 = 0, worst_e8 = 0, worst_violation = 0
    !> Sweeps and single contact updates
    integer(i8) :: sweeps = 0, contact_updates = 0
    !> Contacts, contacts with an impulse of the last step, and most contacts of all steps
    integer :: contacts = 0, active_contacts = 0, most_contacts = 0
    !> Deepest penetration of all steps [m]
    real(wp) :: worst_penetration = 0
    !> Steps in which a body moved farther than the smallest alert distance, so that a contact may have been missed
    integer :: fast_steps = 0
    !> Tunnelling: times that two bodies passed through each other within a step
    integer :: tunnellings = 0
    !> Steps at whose end bodies were pushed apart
    integer :: recoveries = 0
    !> Steps solved twice, since the first solution moved a body farther than contacts were sought
    integer :: repeated_steps = 0
    !> Worst step of those that did not converge, 0 for none: the two bodies of the contact that breaks its law by the largest
    !! velocity, and that velocity [m/s]
    integer :: worst_step = 0, worst_bodies(2) = 0
    real(wp) :: worst_speed = 0
    !> Where and when penetration was deepest, and the violation largest
    type(moment_t) :: penetration_at, violation_at
    !> Bytes that the contact problem of the last step holds per contact
    real(wp) :: bytes_per_contact = 0
    !> Stopwatch of each phase, indexed by `phase_*`
    type(timer_t) :: phase(n_phases)
    !> Stopwatch of the run: start it once, then `tick` to read it
    type(timer_t) :: clock
  contains
    procedure :: add => totals_add
    procedure :: note_unconverged => totals_note_unconverged
    procedure :: tick => totals_tick
    procedure :: pack => totals_pack
    procedure :: unpack => totals_unpack
    procedure, nopass :: are_sound
    procedure :: reduce => totals_reduce
    procedure :: leave_to_first => totals_leave_to_first
  end type totals_t

contains

  !> Add the solve of one step.
  pure subroutine totals_add(self, report, contacts, penetration, all_contacts)
    class(totals_t), intent(inout) :: self
    type(report_t), intent(in) :: report !! report of the solver: updates and active contacts of this rank, errors of the whole
    integer, intent(in) :: contacts !! number of contacts of the step on this rank
    real(wp), intent(in), optional :: penetration !! deepest penetration of the step, none unless given [m]
    integer, intent(in), optional :: all_contacts !! contacts of the step on all ranks, those of this rank unless given

    self%steps = self%steps + 1
    if (report%is_converged) then
      self%converged_steps = self%converged_steps + 1
    else
      self%unconverged_steps = self%unconverged_steps + 1
    end if
    self%worst_e1 = worse(self%worst_e1, report%e1)
    self%worst_e2 = worse(self%worst_e2, report%e2)
    self%worst_e8 = worse(self%worst_e8, report%e8)
    self%worst_violation = worse(self%worst_violation, report%violation)
    self%sweeps = self%sweeps + int(report%sweeps, i8)
    self%contact_updates = self%contact_updates + report%contact_updates
    self%contacts = contacts
    self%active_contacts = report%active_contacts
    if (present(all_contacts)) then
      self%most_contacts = max(self%most_contacts, all_contacts)
    else
      self%most_contacts = max(self%most_contacts, contacts)
    end if
    self%bytes_per_contact = report%bytes_per_contact
    if (present(penetration)) self%worst_penetration = worse(self%worst_penetration, penetration)
  end subroutine totals_add

  !> Keep a step that did not converge where it is the worst so far.
  pure subroutine totals_note_unconverged(self, step, bodies, speed)
    class(totals_t), intent(inout) :: self
    integer, intent(in) :: step !! number of the step
    integer, intent(in) :: bodies(2) !! bodies of its worst contact
    real(wp), intent(in) :: speed !! velocity by which that breaks its law [m/s]

    if (self%worst_step > 0 .and. .not. speed > self%worst_speed) return
    self%worst_step = step
    self%worst_bodies = bodies
    self%worst_speed = speed
  end subroutine totals_note_unconverged

  !> The worst contact of the steps that did not converge, in words.
  pure function worst_contact_words(totals, fall_speed) result(words)
    type(totals_t), intent(in) :: totals !! totals of a run with such a step
    real(wp), intent(in) :: fall_speed !! what a step of free fall brings [m/s]; 0 without gravity
    character(len=:), allocatable :: words

    if (.not. totals%worst_speed > 0) then
      words = 'every contact obeys its law by itself, and only the criterion is above the tolerance'
      return
    end if
    words = 'the contact of bodies '//to_text(totals%worst_bodies(1))//' and '//to_text(totals%worst_bodies(2))// &
            ' breaks its law by '//to_text(totals%worst_speed, 2)//' m/s'
    if (fall_speed > 0) words = words//', '//to_text(totals%worst_speed/fall_speed, 2)//' g h'
  end function worst_contact_words

  !> Bring the stopwatch of the run up to now.
  subroutine totals_tick(self)
    class(totals_t), intent(inout) :: self

    call self%clock%stop()
    call self%clock%start()
  end subroutine totals_tick

  !> From the totals of each rank to those of the run: contacts, updates and CPU seconds are summed; of sweeps, worst errors,
  !! most contacts, fast steps, tunnellings and wall seconds the largest counts.
  subroutine totals_reduce(self, comm)
    class(totals_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    integer(i8) :: counts(3), most(4)
    real(wp) :: sums(n_phases + 2), largest(n_phases + 1), worst(5)

    if (comm%size == 1) return
    counts = [int(self%contacts, i8), int(self%active_contacts, i8), self%contact_updates]
    call comm%sum(counts)
    sums = [self%bytes_per_contact*real(self%contacts, wp), self%phase%cpu, self%clock%cpu]
    call comm%sum(sums)
    most = [self%sweeps, int([self%fast_steps, self%most_contacts, self%tunnellings], i8)]
    call comm%maximum(most)
    largest = [self%phase%wall, self%clock%wall]
    worst = [self%worst_e1, self%worst_e2, self%worst_e8, self%worst_violation, self%worst_penetration]
    call find_moment(comm, self%worst_penetration, self%penetration_at)
    call find_largest(comm, largest, worst)
    self%contacts = int(counts(1))
    self%active_contacts = int(counts(2))
    self%contact_updates = counts(3)
    if (self%contacts > 0) self%bytes_per_contact = sums(1)/real(self%contacts, wp)
    self%phase%cpu = sums(2:n_phases + 1)
    self%clock%cpu = sums(n_phases + 2)
    self%sweeps = most(1)
    self%fast_steps = int(most(2))
    self%most_contacts = max(int(most(3)), self%contacts)
    self%tunnellings = int(most(4))
    self%phase%wall = largest(:n_phases)
    self%clock%wall = largest(n_phases + 1)
    self%worst_e1 = worst(1)
    self%worst_e2 = worst(2)
    self%worst_e8 = worst(3)
    self%worst_violation = worst(4)
    self%worst_penetration = worst(5)
  end subroutine totals_reduce

  !> The moment of the rank that has the largest value, on all ranks: of several the first. Collective.
  subroutine find_moment(comm, value, moment)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: value !! of this rank
    type(moment_t), intent(inout) :: moment !! of this rank, then of that one
    real(wp) :: largest, values(n_moment_values)
    integer :: first

    if (comm%size == 1) return
    largest = value
    call comm%maximum(largest)
    first = merge(comm%size - comm%rank, 0, value >= largest)
    call comm%maximum(first)
    values = merge(1.0_wp, 0.0_wp, first == comm%size - comm%rank)*moment%pack()
    call comm%sum(values)
    call moment%unpack(values)
  end subroutine find_moment

  !> The largest of the ranks' values, and of their errors, of which one that is not a number is the worst.
  subroutine find_largest(comm, values, errors)
    type(comm_t), intent(inout) :: comm
    real(wp), intent(inout) :: values(:), errors(:)
    real(wp) :: all(size(values) + 2*size(errors))
    integer :: n, m

    n = size(values)
    m = size(errors)
    all = [values, merge(1.0_wp, 0.0_wp, ieee_is_nan(errors)), merge(-huge(errors), errors, ieee_is_nan(errors))]
    call comm%maximum(all)
    values = all(:n)
    errors = all(n + m + 1:)
    where (all(n + 1:n + m) > 0) errors = ieee_value(errors, ieee_quiet_nan)
  end subroutine find_largest

  !> The other way round, for a restart: the first rank keeps what is summed over the ranks, the others begin at zero.
  pure subroutine totals_leave_to_first(self, comm)
    class(totals_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the ranks

    if (comm%rank == 0) return
    self%contacts = 0
    self%active_contacts = 0
    self%contact_updates = 0
    self%phase%cpu = 0
    self%clock%cpu = 0
  end subroutine totals_leave_to_first

  !> From the report on each rank's contacts to that on all: updates, active contacts and the CPU seconds of a
  !! history are summed, of sweeps the largest counts; errors are of the whole scene already.
  subroutine reduce_report(report, comm)
    type(report_t), intent(inout) :: report !! of this rank, then of all
    type(comm_t), intent(inout) :: comm !! the ranks

    if (comm%size == 1) return
    call comm%sum(report%contact_updates)
    call comm%sum(report%active_contacts)
    call comm%maximum(report%sweeps)
    if (.not. allocated(report%trace)) return
    ! All ranks have its points at the same iterations.
    call comm%sum(report%trace%contact_updates)
    call comm%sum(report%trace%cpu_seconds)
    call comm%sum(report%trace%messages)
    call comm%sum(report%trace%bytes)
    ! Collective operations are those of all ranks: each counts once.
    call comm%maximum(report%trace%collectives)
  end subroutine reduce_report

  !> The totals as a list of reals, for restart files; counters are exact up to 2^53.
  pure function totals_pack(self) result(values)
    class(totals_t), intent(in) :: self
    real(wp) :: values(n_totals_values)

    values(:n_sums) = [real(self%steps, wp), real(self%converged_steps, wp), real(self%unconverged_steps, wp), &
                       self%worst_e1, self%worst_e2, self%worst_e8, self%worst_violation, &
                       real(self%sweeps, wp), real(self%contact_updates, wp), real(self%contacts, wp), &
                       real(self%active_contacts, wp), real(self%most_contacts, wp), self%bytes_per_contact, &
                       real(self%fast_steps, wp), self%worst_penetration, real(self%tunnellings, wp), &
                       real(self%worst_step, wp), real(self%worst_bodies, wp), self%worst_speed, real(self%recoveries, wp), &
                       real(self%repeated_steps, wp), self%penetration_at%pack(), self%violation_at%pack()]
    values(n_sums + 1:) = [self%phase%cpu, self%phase%wall, self%clock%cpu, self%clock%wall]
  end function totals_pack

  !> Can a list of reals be unpacked? Counts are no less than zero and can be counted, seconds are finite.
  pure logical function are_sound(values)
    real(wp), intent(in) :: values(n_totals_values) !! what `pack` may have given
    integer, parameter :: counts(12) = [1, 2, 3, 10, 11, 12, 14, 16, 21, 22, 23, 23 + n_moment_values], long_counts(2) = [8, 9]

    are_sound = all(ieee_is_finite(values([counts, long_counts]))) .and. all(ieee_is_finite(values(n_sums + 1:)))
    if (.not. are_sound) return
    are_sound = all(values([counts, long_counts]) >= 0) .and. all(values(counts) <= real(huge(1), wp)) .and. &
                all(values(long_counts) < real(huge(1_i8), wp))
  end function are_sound

  !> The totals back from a list of reals.
  pure subroutine totals_unpack(self, values)
    class(totals_t), intent(inout) :: self
    real(wp), intent(in) :: values(n_totals_values) !! what `pack` gave

    self%steps = nint(values(1))
    self%converged_steps = nint(values(2))
    self%unconverged_steps = nint(values(3))
    self%worst_e1 = values(4)
    self%worst_e2 = values(5)
    self%worst_e8 = values(6)
    self%worst_violation = values(7)
    self%sweeps = nint(values(8), i8)
    self%contact_updates = nint(values(9), i8)
    self%contacts = nint(values(10))
    self%active_contacts = nint(values(11))
    self%most_contacts = nint(values(12))
    self%bytes_per_contact = values(13)
    self%fast_steps = nint(values(14))
    self%worst_penetration = values(15)
    self%tunnellings = nint(values(16))
    self%worst_step = nint(values(17))
    self%worst_bodies = nint(values(18:19))
    self%worst_speed = values(20)
    self%recoveries = nint(values(21))
    self%repeated_steps = nint(values(22))
    call self%penetration_at%unpack(values(23:22 + n_moment_values))
    call self%violation_at%unpack(values(23 + n_moment_values:n_sums))
    self%phase%cpu = values(n_sums + 1:n_sums + n_phases)
    self%phase%wall = values(n_sums + n_phases + 1:n_sums + 2*n_phases)
    self%clock%cpu = values(n_totals_values - 1)
    self%clock%wall = values(n_totals_values)
  end subroutine totals_unpack
end module sg_totals
