!> Gluing: copies of shared bodies that have moved apart get one velocity again (doc/theory/decomposition.md).
!!
!! All copies start a round with one velocity v and end it with v_c each. The dual method takes their mean: with masses
!! divided by the number of copies that is the velocity under the impulses of all ranks. The method that exchanges
!! momentum adds up the changes, v + sum (v_c - v). Sums are taken in the order of ranks, so that all copies get the very
!! same numbers. Messages go to neighbours while contacts that touch no shared body are swept.
module sg_gluing
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_shared_bodies, only: shared_bodies_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: gluing_t, rehearse_gluing

  !> Shared bodies of one solve and the messages about them
  type :: gluing_t
    !> Shared bodies and their multiplicity
    type(shared_bodies_t) :: shared
    !> Take the mean of copies, or add up their changes?
    logical :: is_mean = .true.
    !> Velocities at the beginning of the round, and changes since then summed over copies, shape (width, shared)
    real(wp), allocatable :: before(:, :), change(:, :)
    !> Sum of what gluing has added to the velocity of each shared copy of this rank [m/s], shape (width, shared): times
    !! its part of the mass this is F_Gamma
    real(wp), allocatable :: jump(:, :)
    type(exchange_t), private :: messages
    integer, private :: rank = 0, width = 0
  contains
    procedure :: prepare => gluing_prepare
    procedure :: begin => gluing_begin
    procedure :: finish => gluing_finish
    procedure :: list_tables => gluing_list_tables
  end type gluing_t

contains

  !> Find the shared bodies of a problem and prepare their messages. Collective.
  subroutine gluing_prepare(self, problem, coupling, is_mean, comm)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part, with free velocities
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    logical, intent(in) :: is_mean !! take the mean of copies (masses are divided), or add up their changes
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: n, i

    self%is_mean = is_mean
    self%rank = comm%rank
    self%width = first_inverse(problem%kind) - 1
    call self%shared%find(problem, coupling, comm)
    associate (counts => self%shared%first(2:) - self%shared%first(:size(coupling%neighbour)))
      call self%messages%prepare(comm, self%width, coupling%neighbour, counts, counts)
    end associate
    n = size(self%shared%slot)
    if (allocated(self%before)) deallocate (self%before, self%change, self%jump)
    allocate (self%before(self%width, n), self%change(self%width, n), self%jump(self%width, n), source=0.0_wp)
    do i = 1, n
      self%before(:, i) = problem%body(:self%width, self%shared%slot(i))
    end do
  end subroutine gluing_prepare

  !> Send the velocities of shared copies to the neighbours.
  subroutine gluing_begin(self, problem, comm)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem after sweeps over its shared bodies
    type(comm_t), intent(inout) :: comm !! the ranks

    call fill_messages(self, problem)
    call self%messages%begin(comm)
  end subroutine gluing_begin

  !> Write down the velocities that neighbours get.
  pure subroutine fill_messages(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer :: j

    do j = 1, size(self%shared%item)
      self%messages%send(:, j) = problem%body(:self%width, self%shared%slot(self%shared%item(j)))
    end do
  end subroutine fill_messages

  !> Give all copies one velocity.
  subroutine gluing_finish(self, problem, comm)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! shared bodies get their new velocities
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%messages%finish(comm)
    call settle(self, problem)
    call self%shared%replicated%glue(problem, self%is_mean, comm)
  end subroutine gluing_finish

  !> Give all copies the velocity that follows from those received.
  pure subroutine settle(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    real(wp) :: new(self%width)
    integer :: i

    call add_up(self, problem)
    do i = 1, size(self%shared%slot)
      associate (body => problem%body(:, self%shared%slot(i)), multiplicity => self%shared%multiplicity(i))
        new = self%before(:, i) + self%change(:, i)/real(merge(multiplicity, 1, self%is_mean), wp)
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
    allocate (gluing%shared%slot(size(slots)), gluing%shared%multiplicity(size(slots)), gluing%shared%item(size(slots)))
    gluing%shared%slot = slots
    gluing%shared%multiplicity = 2
    gluing%shared%item = [(i, i=1, size(slots))]
    gluing%shared%first = [1, size(slots) + 1]
    gluing%messages%rank = [1]
    allocate (gluing%before(gluing%width, size(slots)), gluing%change(gluing%width, size(slots)), &
              gluing%jump(gluing%width, size(slots)), gluing%messages%send(gluing%width, size(slots)), &
              gluing%messages%receive(gluing%width, size(slots)), source=0.0_wp)
    gluing%before(:, :) = problem%body(:gluing%width, slots)
    do i = 1, times
      call fill_messages(gluing, problem)
      gluing%messages%receive(:, :) = gluing%messages%send
      call settle(gluing, problem)
    end do
  end subroutine rehearse_gluing

  !> Sum the changes of all copies in the order of ranks. Bodies that no rank changes keep their velocity bit for bit.
  pure subroutine add_up(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer :: i, j
    logical :: is_own_added

    self%change = 0
    is_own_added = .false.
    do i = 1, size(self%messages%rank)
      if (.not. is_own_added .and. self%messages%rank(i) > self%rank) then
        call add_own(self, problem)
        is_own_added = .true.
      end if
      do j = self%shared%first(i), self%shared%first(i + 1) - 1
        associate (k => self%shared%item(j))
          self%change(:, k) = self%change(:, k) + self%messages%receive(:, j) - self%before(:, k)
        end associate
      end do
    end do
    if (.not. is_own_added) call add_own(self, problem)
  end subroutine add_up

  !> Add the changes of this rank's own copies.
  pure subroutine add_own(self, problem)
    class(gluing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer :: k

    do k = 1, size(self%shared%slot)
      self%change(:, k) = self%change(:, k) + problem%body(:self%width, self%shared%slot(k)) - self%before(:, k)
    end do
  end subroutine add_own

  !> List the tables of the gluing and of shared bodies.
  subroutine gluing_list_tables(self, tables)
    class(gluing_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%shared%list_tables(tables)
    call tables%begin('gluing', per_body)
    call tables%note('before', self%before)
    call tables%note('change', self%change)
    call tables%note('jump', self%jump)
    call tables%add('messages', self%messages%table_bytes())
  end subroutine gluing_list_tables
end module sg_gluing
