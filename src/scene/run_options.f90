!> What to do with a scene: time, solver, what to write and when. Filled by the deck, changed by no one.
module sg_run_options
  use sg_field_options, only: field_options_t
  use sg_interface_options, only: interface_options_t
  use sg_kinds, only: wp, i4
  use sg_options, only: option_values_t
  use sg_region_options, only: region_options_t
  use sg_text, only: text_t
  use sg_walls, only: walls_t
  implicit none
  private
  public :: run_options_t, solver_options_t, partition_options_t, guard_options_t, split_names, energy_guards
  public :: criterion_e1, criterion_e2, criterion_e8, criterion_violation, criterion_quad, criterion_maxm, criterion_qm16
  public :: criterion_estimate, criterion_names

  !> Stopping criteria (doc/theory/errors.md)
  integer, parameter :: criterion_e1 = 1, criterion_e2 = 2, criterion_e8 = 3, criterion_violation = 4, &
                        criterion_quad = 5, criterion_maxm = 6, criterion_qm16 = 7, criterion_estimate = 8
  !> Words for the criteria, as decks write them
  character(len=9), parameter :: criterion_names(8) = &
    [character(len=9) :: 'e1', 'e2', 'e8', 'violation', 'quad', 'maxm', 'qm16', 'estimate']

  !> Overlap over the smaller shape from which on it is undone, of decks without another one (doc/theory/recovery.md)
  real(wp), parameter, public :: default_recovery = 1e-4_wp

  !> How grains are split over ranks
  character(len=8), parameter :: split_names(2) = [character(len=8) :: 'boxes', 'graph']

  !> What is done when the energy balance does not close
  character(len=6), parameter :: energy_guards(3) = [character(len=6) :: 'ignore', 'warn', 'stop']

  !> What a run watches itself for
  type :: guard_options_t
    !> What is done when the energy balance does not close, one of `energy_guards`
    character(len=6) :: energy = 'warn'
    !> Error of the balance over its largest term above which it counts as open
    real(wp) :: energy_tolerance = 0.05_wp
  end type guard_options_t

  !> How a scene is decomposed when there is more than one rank
  type :: partition_options_t
    !> Subdomains that the ranks share; 0 for one per rank
    integer :: parts = 0
    !> How grains are distributed, one of `split_names`, and how their parts are glued, one of `coupling_names` (sg_methods)
    character(len=16) :: split = 'boxes', gluing = 'dual'
    !> Boxes along x, y and z, as many together as ranks; 0 where the program chooses
    integer :: boxes(3) = 0
    !> Sweeps of a subdomain between two gluings: one number for all, or one for each
    integer, allocatable :: sweeps(:)
    !> Options of this gluing alone, as far as the deck was read; defaults stand in its file
    type(option_values_t) :: own
    !> Steps between splits, 0 for never; and the imbalance (largest load over the mean one) from
    !! which it is
    integer :: every = 0
    real(wp) :: imbalance = 1.2_wp
  contains
    procedure :: sweeps_of => partition_sweeps_of
    procedure :: most_sweeps => partition_most_sweeps
  end type partition_options_t

  !> How the contact problem of a step is solved
  type :: solver_options_t
    !> Method, one of `solver_names` (sg_methods)
    character(len=16) :: method = 'nesterov'
    !> Stopping criterion, one of `criterion_*`
    integer :: criterion = criterion_estimate
    !> Value of the criterion at which the solver stops
    real(wp) :: tolerance = 2e-2_wp
    !> Sweeps between two tests; 0 for tests that come where the criterion is expected to be reached
    integer :: check_every = 0
    !> Sweeps after which the solver gives up
    integer :: maximum_sweeps = 5000
    !> Share of each new impulse taken: 1 is plain Gauss-Seidel
    real(wp) :: relaxation = 1
    !> Start from the impulses of the last step
    logical :: warm_start = .true.
    !> Leave clusters of contacts that are solved, and touch no other, out of the sweeps
    logical :: leave_solved = .true.
    !> Order of the sweep: 'natural' (spatial), 'groups' (coloured groups that overlap in the processor), 'coloured' (blocks of
    !! such groups, which threads share) or 'shuffled' (random, of a seed)
    character(len=16) :: order = 'groups'
    integer :: order_seed = 1
    !> Threads that share the sweeps of a rank, in coloured order
    integer :: threads = 1
    !> End the run when a step does not converge
    logical :: stop_unconverged = .false.
  contains
    procedure :: typical_gap => solver_typical_gap
  end type solver_options_t

  !> All options of a run
  type :: run_options_t
    !> Time step [s], number of steps, and weight of the end of the step
    real(wp) :: time_step = 0
    integer :: steps = 0
    real(wp) :: theta = 0.5_wp
    !> Substeps of a step: contacts are found once per step, and solved in each substep
    integer :: substeps = 1
    !> Overlap over the smaller shape from which on bodies are pushed apart at the end of a step; 0 for never
    real(wp) :: recovery = 0
    !> Steps from one look for such overlap to the next
    integer :: recovery_every = 4
    !> The solver
    type(solver_options_t) :: solver
    !> What is watched
    type(guard_options_t) :: guard
    !> The decomposition
    type(partition_options_t) :: partition
    !> Steps between two pictures (VTKHDF), 0 for none; between two rows of the record; between two checkpoints
    integer :: output_every = 0, record_every = 10, restart_every = 0
    !> Write pictures in single precision, compressed
    logical :: output_single = .false., output_compressed = .false.
    !> Record means over the interval between two recorded steps
    logical :: record_mean = .false.
    !> Write means of each subdomain with each row of the record
    logical :: has_subdomain_means = .false.
    !> Numbers of tracked bodies, ascending, and their names; unallocated where there are none
    integer(i4), allocatable :: tracked(:)
    type(text_t), allocatable :: tracked_names(:)
    !> Numbers and names of all bodies that have one, a line `number name` each, for pictures; unallocated where there are none
    character(len=:), allocatable :: body_names
    !> Walls, and their names
    type(walls_t) :: walls
    type(text_t), allocatable :: wall_names(:)
    !> Coarse-grained fields; unallocated where there are none
    type(field_options_t), allocatable :: fields(:)
    !> Regions in which indicators are measured; unallocated where there are none
    type(region_options_t), allocatable :: regions(:)
    !> Pairs of bodies whose interfaces are measured; unallocated where there are none
    type(interface_options_t), allocatable :: interfaces
    !> Sample series at every step and write their spectra at the end
    logical :: has_spectrum = .false.
    !> Keep the history of errors within some steps: these, or some spread over the run
    logical :: has_trace = .false.
    integer, allocatable :: trace_steps(:)
    !> Write the structure of the packing: at the end, and every so many steps unless 0; of grains in a box, empty for all
    logical :: has_structure = .false.
    integer :: structure_every = 0
    real(wp), allocatable :: structure_box(:)
    !> Write a checkpoint at the end of the run
    logical :: restart_at_end = .true.
    !> Folder of the results, and the file to restart from (empty for none)
    character(len=:), allocatable :: folder, restart_file
    !> Files that the run reads, and which it must not write over
    type(text_t), allocatable :: inputs(:)
    !> Replace other results in the folder
    logical :: is_forced = .false.
    !> Title of the deck, and what it is for; empty where it gives none
    character(len=:), allocatable :: title, about
    !> Hash and text of the effective deck
    character(len=:), allocatable :: deck_hash, deck_text
    !> Steps whose contact problem is written as FCLIB files: first and last of each range, shape (2, ranges)
    integer, allocatable :: dump_steps(:, :)
    !> Wall time, as `wall_now` counts it, at which the run stops with a checkpoint [s]; 0 for never
    real(wp) :: deadline = 0
    !> Print less; no progress
    logical :: is_quiet = .false.
    !> Report at the end what the run has held in memory, and write needs.json
    logical :: reports_memory = .false.
  contains
    procedure :: substep_length => run_substep_length
  end type run_options_t

contains

  !> Length of a substep [s]: that of the step where it has one.
  pure real(wp) function run_substep_length(self) result(length)
    class(run_options_t), intent(in) :: self

    length = self%time_step/real(self%substeps, wp)
  end function run_substep_length

  !> Sweeps between two tests, typically where these come by the fall of the criterion.
  pure integer function solver_typical_gap(self) result(gap)
    class(solver_options_t), intent(in) :: self

    gap = self%check_every
    if (gap == 0) gap = 20
  end function solver_typical_gap

  !> Sweeps of a rank between two gluings.
  pure integer function partition_sweeps_of(self, rank) result(sweeps)
    class(partition_options_t), intent(in) :: self
    integer, intent(in) :: rank !! from 0

    sweeps = 1
    if (allocated(self%sweeps)) sweeps = self%sweeps(min(rank + 1, size(self%sweeps)))
  end function partition_sweeps_of

  !> The most sweeps of any rank between two gluings.
  pure integer function partition_most_sweeps(self) result(sweeps)
    class(partition_options_t), intent(in) :: self

    sweeps = 1
    if (allocated(self%sweeps)) sweeps = maxval(self%sweeps)
  end function partition_most_sweeps
end module sg_run_options
