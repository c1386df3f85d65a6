!> Replicated bodies that impulses can move, such as pressed plates: all ranks hold them, and their changes are summed over ranks.
module sg_replicated_bodies
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: replicated_bodies_t

  !> Replicated bodies of one solve
  type :: replicated_bodies_t
    !> Slots of those that can move, ranks that have contacts on each, and whether this one has
    integer, allocatable :: slot(:), multiplicity(:)
    logical, allocatable :: is_here(:)
    !> Velocities at the beginning of the round, shape (width, bodies)
    real(wp), allocatable :: before(:, :)
  contains
    procedure :: mark => replicated_mark
    procedure :: glue => replicated_glue
    procedure :: list_tables => replicated_list_tables
  end type replicated_bodies_t

contains

  !> Take the present velocities, the same on all ranks, for those at the beginning of a round.
  pure subroutine replicated_mark(self, problem, width)
    class(replicated_bodies_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem with its velocities
    integer, intent(in) :: width !! components of a velocity

    if (allocated(self%before)) deallocate (self%before)
    allocate (self%before(width, size(self%slot)))
    self%before(:, :) = problem%body(:width, self%slot)
  end subroutine replicated_mark

  !> Give replicated bodies one velocity: the mean of those ranks that have contacts on them, or the sum of their changes.
  subroutine replicated_glue(self, problem, is_mean, comm)
    class(replicated_bodies_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! velocities of replicated bodies are set
    logical, intent(in) :: is_mean !! their masses are divided
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: change(size(self%before))
    integer :: i, first, last, width

    if (size(change) == 0) return
    width = size(self%before, 1)
    change = 0
    do i = 1, size(self%slot)
      if (.not. self%is_here(i)) cycle
      first = (i - 1)*width + 1
      change(first:i*width) = problem%body(:width, self%slot(i)) - self%before(:, i)
    end do
    call comm%sum(change)
    do i = 1, size(self%slot)
      first = (i - 1)*width + 1
      last = i*width
      if (is_mean) change(first:last) = change(first:last)/real(max(1, self%multiplicity(i)), wp)
      self%before(:, i) = self%before(:, i) + change(first:last)
      problem%body(:width, self%slot(i)) = self%before(:, i)
    end do
  end subroutine replicated_glue

  !> List the tables.
  subroutine replicated_list_tables(self, tables)
    class(replicated_bodies_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('replicated', per_body)
    call tables%note('slot', self%slot)
    call tables%note('multiplicity', self%multiplicity)
    call tables%note('is_here', self%is_here)
    call tables%note('before', self%before)
  end subroutine replicated_list_tables
end module sg_replicated_bodies
