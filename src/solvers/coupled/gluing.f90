!> Gluing: copies of shared bodies that have moved apart get one velocity again (doc/theory/decomposition.md).
!!
!! All copies start a round with one velocity v and end it with v_c each. The dual method takes their mean: with masses
!! divided by the number of copies that is the velocity under the impulses of all ranks. The method that exchanges
!! momentum adds up the changes, v + sum (v_c - v). Messages go to neighbours while contacts that touch no shared body are swept.
module sg_gluing
  use sg_comm, only: comm_t
  use sg_interface, only: interface_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: gluing_t, rehearse_gluing

  !> Shared bodies of one solve and their velocities
  type :: gluing_t
    !> The interface of the step, and the first of its bodies that is glued
    type(interface_t) :: interface
    integer, private :: first = 1
    !> Take the mean of copies, or add up their changes?
    logical :: is_mean = .true.
    !> Velocities at the beginning of the round; those at its end, then sums of changes over copies, shape (width, glued bodies)
    real(wp), allocatable :: before(:, :), change(:, :)
    !> Sum of what gluing has added to the velocity of each shared copy of this rank [m/s], shape (width, glued bodies):
    !! times its part of the mass this is F_Gamma
    real(wp), allocatable :: jump(:, :)
    integer, private :: width = 0
  contains
    procedure :: prepare => gluing_prepare
    procedure :: mark => gluing_mark
    procedure :: begin => gluing_begin
    procedure :: finish => gluing_finish
    procedure :: glue_replicated => gluing_glue_replicated
    procedure :: list_tables => gluing_list_tables
  end type gluing_t

contains

  !> Find the interface of a problem, and prepare messages where copies on neighbours are glued. Collective.
  subroutine gluing_prepare(self, problem, coupling, is_mean, only_replicated, comm)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part, with free velocities
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    logical, intent(in) :: is_mean !! take the mean of copies (masses are divided), or add up their changes
    logical, intent(in) :: only_replicated !! glue replicated bodies alone, without messages to neighbours
    type(comm_t), intent(inout) :: comm !! the ranks

    self%is_mean = is_mean
    self%width = first_inverse(problem%kind) - 1
    call self%interface%find(problem%pair(:, :problem%n_contacts), problem%body(:, :problem%n_bodies), self%width, coupling, comm)
    self%first = 1
    if (only_replicated) self%first = self%interface%n_shared + 1
    if (.not. only_replicated) call self%interface%prepare_sums(coupling, comm)
    call reserve(self, problem)
  end subroutine gluing_prepare

  !> Make room, and take the present velocities for those at the beginning of a round.
  pure subroutine reserve(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem

    if (allocated(self%before)) deallocate (self%before, self%change, self%jump)
    associate (slot => self%interface%slot, first => self%first)
      allocate (self%before(self%width, first:size(slot)), self%change(self%width, first:size(slot)), &
                self%jump(self%width, first:size(slot)), source=0.0_wp)
    end associate
    call self%mark(problem)
  end subroutine reserve

  !> Take the present velocities, the same in all copies, for those at the beginning of a round.
  pure subroutine gluing_mark(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem with its velocities

    self%before(:, :) = problem%body(:self%width, self%interface%slot(self%first:))
  end subroutine gluing_mark

  !> Send the velocities of shared copies to the neighbours.
  subroutine gluing_begin(self, problem, comm)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem after sweeps over its shared bodies
    type(comm_t), intent(inout) :: comm !! the ranks

    call take_velocities(self, problem)
    call self%interface%sums%begin(self%change, comm)
  end subroutine gluing_begin

  !> Take the velocities of this rank's copies.
  pure subroutine take_velocities(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer :: i

    do i = self%first, size(self%interface%slot)
      self%change(:, i) = problem%body(:self%width, self%interface%slot(i))
    end do
  end subroutine take_velocities

  !> Give all copies one velocity.
  subroutine gluing_finish(self, problem, comm)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! shared bodies get their new velocities
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%interface%finish_sum(self%before, self%change, comm)
    call settle(self, problem)
  end subroutine gluing_finish

  !> Give all copies of replicated bodies one velocity. Collective.
  subroutine gluing_glue_replicated(self, problem, comm)
    class(gluing_t), intent(inout) :: self !! prepared for replicated bodies alone
    type(problem_t), intent(inout) :: problem !! replicated bodies get their new velocities
    type(comm_t), intent(inout) :: comm !! the ranks

    call take_velocities(self, problem)
    call self%interface%sum_replicated(self%before, self%change, comm)
    call settle(self, problem)
  end subroutine gluing_glue_replicated

  !> Give all copies the velocity that follows from the sum of changes.
  pure subroutine settle(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    real(wp) :: new(self%width)
    integer :: i

    do i = self%first, size(self%interface%slot)
      associate (body => problem%body(:, self%interface%slot(i)), multiplicity => self%interface%multiplicity(i))
        new = self%before(:, i) + self%change(:, i)/real(merge(max(1, multiplicity), 1, self%is_mean), wp)
        self%jump(:, i) = self%jump(:, i) + new - body(:self%width)
        self%before(:, i) = new
        body(:self%width) = new
      end associate
    end do
  end subroutine settle

  !> Gluing without its messages, repeated: some bodies as if one neighbour held copies of the same velocity.
  pure subroutine rehearse_gluing(problem, slots, times)
    type(problem_t), intent(inout) :: problem !! its bodies keep their velocities up to rounding
    integer, intent(in) :: slots(:) !! bodies to glue
    integer, intent(in) :: times !! how often
    type(gluing_t) :: gluing
    integer :: i

    gluing%width = first_inverse(problem%kind) - 1
    call gluing%interface%rehearse(slots, gluing%width)
    call reserve(gluing, problem)
    do i = 1, times
      call take_velocities(gluing, problem)
      call gluing%interface%sums%rehearse_sum(gluing%before, gluing%change)
      call settle(gluing, problem)
    end do
  end subroutine rehearse_gluing

  !> List the tables of the gluing and of the interface.
  subroutine gluing_list_tables(self, tables)
    class(gluing_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%interface%list_tables(tables)
    call tables%begin('gluing', per_body)
    call tables%note('before', self%before)
    call tables%note('change', self%change)
    call tables%note('jump', self%jump)
  end subroutine gluing_list_tables
end module sg_gluing
