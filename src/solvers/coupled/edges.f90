!> Edges between subdomains: the contacts that lie between the grains of two ranks, and the order in which edges take
!! their turns (doc/theory/decomposition.md).
!!
!! One of the two ranks owns all contacts of an edge. In its turn the other one lends it the velocities of its grains and
!! gets them back changed. Turns are colours: no rank has two edges of one colour, so that edges of one colour are swept at
!! the same time and no grain is in two places.
module sg_edges
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_interface, only: interface_t
  use sg_kinds, only: wp, i8
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: all_edges, edges_t, colour_edges

  !> Number of the messages on all edges at once
  integer, parameter :: all_edges = 0

  !> The edges of one rank
  type :: edges_t
    !> Colours in all, and colour of the edge with each neighbour, 0 where there is none
    integer :: n_colours = 0
    integer, allocatable :: colour(:)
    !> Slots that neighbour i borrows from this rank: `lent(lent_first(i):lent_first(i + 1) - 1)`; and those of neighbour i
    !! that this rank borrows
    integer, allocatable :: lent_first(:), lent(:), borrowed_first(:), borrowed(:)
    !> Messages that lend and give back on all edges at once, and on the edges of each colour
    type(exchange_t), allocatable, private :: lend(:), give_back(:)
    integer, private :: width = 0
  contains
    procedure :: prepare => edges_prepare
    procedure :: carry => edges_carry
    procedure :: return_changes => edges_return_changes
    procedure :: list_tables => edges_list_tables
  end type edges_t

contains

  !> Find the edges of a problem and prepare their messages: number `all_edges`, and number c for those of colour c.
  subroutine edges_prepare(self, problem, coupling, interface, comm)
    class(edges_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(interface_t), intent(in) :: interface !! on which bodies ranks have contacts
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: c

    self%width = first_inverse(problem%kind) - 1
    call list_loans(self, coupling, interface)
    call colour_all(self, coupling, comm)
    call release_all(self)
    allocate (self%lend(0:self%n_colours), self%give_back(0:self%n_colours))
    do c = 0, self%n_colours
      call prepare_turn(self, coupling, c, comm)
    end do
  end subroutine edges_prepare

  !> List what is lent and borrowed on each edge.
  subroutine list_loans(self, coupling, interface)
    class(edges_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    type(interface_t), intent(in) :: interface
    integer :: i, e

    self%lent = [integer ::]
    self%borrowed = [integer ::]
    if (allocated(self%lent_first)) deallocate (self%lent_first, self%borrowed_first)
    allocate (self%lent_first(size(coupling%neighbour) + 1), self%borrowed_first(size(coupling%neighbour) + 1), source=1)
    do i = 1, size(coupling%neighbour)
      associate (entries => [(e, e=coupling%first(i), coupling%first(i + 1) - 1)])
        self%lent = [self%lent, coupling%body(pack(entries, coupling%owner(entries) == coupling%rank .and. &
                                                      interface%is_there(entries)))]
        self%borrowed = [self%borrowed, coupling%body(pack(entries, coupling%owner(entries) == coupling%neighbour(i) .and. &
                                                            interface%is_here(entries)))]
      end associate
      self%lent_first(i + 1) = size(self%lent) + 1
      self%borrowed_first(i + 1) = size(self%borrowed) + 1
    end do
  end subroutine list_loans

  !> Colour the edges of all ranks; each rank holds the whole list of edges, but no list of grains.
  subroutine colour_all(self, coupling, comm)
    class(edges_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    type(comm_t), intent(inout) :: comm
    integer, allocatable :: all(:), first(:), edge(:, :), colour(:)
    integer :: i, r, n
    logical :: is_edge(size(coupling%neighbour))

    do i = 1, size(coupling%neighbour)
      is_edge(i) = self%lent_first(i + 1) > self%lent_first(i) .or. self%borrowed_first(i + 1) > self%borrowed_first(i)
    end do
    call comm%gather(pack(coupling%neighbour, is_edge), all, first)
    allocate (edge(2, size(all)/2))
    n = 0
    do r = 0, comm%size - 1
      do i = first(r), first(r + 1) - 1
        if (all(i) < r) cycle
        n = n + 1
        edge(:, n) = [r, all(i)]
      end do
    end do
    colour = colour_edges(edge(:, :n), comm%size)
    self%n_colours = 0
    if (n > 0) self%n_colours = maxval(colour)
    self%colour = [(0, i=1, size(coupling%neighbour))]
    do i = 1, n
      if (any(edge(:, i) == comm%rank)) then
        where (coupling%neighbour == sum(edge(:, i)) - comm%rank) self%colour = colour(i)
      end if
    end do
  end subroutine colour_all

  !> Colours of edges between ranks, from 1: no rank has two edges of one colour. Edges take the first colour that is free
  !! at both ends, which needs less than twice the number of edges of a rank.
  pure function colour_edges(edge, ranks) result(colour)
    integer, intent(in) :: edge(:, :) !! ranks from 0, shape (2, edges)
    integer, intent(in) :: ranks !! number of ranks
    integer :: colour(size(edge, 2))
    logical, allocatable :: is_taken(:, :)
    integer :: degree(0:ranks - 1), i, c

    degree = 0
    do i = 1, size(edge, 2)
      degree(edge(:, i)) = degree(edge(:, i)) + 1
    end do
    allocate (is_taken(2*maxval([degree, 1]), 0:ranks - 1), source=.false.)
    do i = 1, size(edge, 2)
      c = findloc(is_taken(:, edge(1, i)) .or. is_taken(:, edge(2, i)), .false., 1)
      colour(i) = c
      is_taken(c, edge(:, i)) = .true.
    end do
  end function colour_edges

  !> Prepare the messages of one turn.
  subroutine prepare_turn(self, coupling, c, comm)
    class(edges_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    integer, intent(in) :: c
    type(comm_t), intent(in) :: comm
    integer :: lent(size(coupling%neighbour)), borrowed(size(coupling%neighbour)), n

    n = size(coupling%neighbour)
    lent = self%lent_first(2:) - self%lent_first(:n)
    borrowed = self%borrowed_first(2:) - self%borrowed_first(:n)
    where (c > 0 .and. self%colour /= c)
      lent = 0
      borrowed = 0
    end where
    call self%lend(c)%prepare(comm, self%width, coupling%neighbour, lent, borrowed)
    call self%give_back(c)%prepare(comm, self%width, coupling%neighbour, borrowed, lent)
  end subroutine prepare_turn

  !> Give back the messages of the last problem.
  subroutine release_all(self)
    class(edges_t), intent(inout) :: self
    integer :: c

    if (.not. allocated(self%lend)) return
    do c = lbound(self%lend, 1), ubound(self%lend, 1)
      call self%lend(c)%release()
      call self%give_back(c)%release()
    end do
    deallocate (self%lend, self%give_back)
  end subroutine release_all

  !> Lend velocities to the ranks that borrow them, or give back borrowed ones: on all edges or those of one colour.
  subroutine edges_carry(self, c, is_return, problem, comm)
    class(edges_t), intent(inout) :: self
    integer, intent(in) :: c !! colour; `all_edges` for all
    logical, intent(in) :: is_return !! give back, not lend
    type(problem_t), intent(inout) :: problem !! velocities of borrowed bodies are set, of lent ones when these come back
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: first, last

    first = 1
    last = size(self%colour)
    if (c /= all_edges) then
      first = findloc(self%colour, c, 1)
      last = first
      if (first == 0) return
    end if
    associate (lent => self%lent(self%lent_first(first):self%lent_first(last + 1) - 1), &
               borrowed => self%borrowed(self%borrowed_first(first):self%borrowed_first(last + 1) - 1))
      if (is_return) then
        call carry(self%give_back(c), borrowed, lent, problem, comm)
      else
        call carry(self%lend(c), lent, borrowed, problem, comm)
      end if
    end associate
  end subroutine edges_carry

  !> Send velocities of some slots and set those of others.
  subroutine carry(messages, from, to, problem, comm)
    type(exchange_t), intent(inout) :: messages !! prepared, as wide as a velocity
    integer, intent(in) :: from(:), to(:) !! slots, neighbour by neighbour
    type(problem_t), intent(inout) :: problem !! velocities change
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: j, width

    width = size(messages%send, 1)
    do j = 1, size(from)
      messages%send(:, j) = problem%body(:width, from(j))
    end do
    call messages%begin(comm)
    call messages%finish(comm)
    do j = 1, size(to)
      problem%body(:width, to(j)) = messages%receive(:, j)
    end do
  end subroutine carry

  !> Add what all borrowers have changed to the velocities of lent bodies: what the guess on edges does to them.
  subroutine edges_return_changes(self, before, problem, comm)
    class(edges_t), intent(inout) :: self
    real(wp), intent(in) :: before(:, :) !! velocities of borrowed bodies before, shape (width, borrowed)
    type(problem_t), intent(inout) :: problem !! velocities of lent bodies change
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: j

    associate (messages => self%give_back(0))
      do j = 1, size(self%borrowed)
        messages%send(:, j) = problem%body(:self%width, self%borrowed(j)) - before(:, j)
      end do
      call messages%begin(comm)
      call messages%finish(comm)
      do j = 1, size(self%lent)
        problem%body(:self%width, self%lent(j)) = problem%body(:self%width, self%lent(j)) + messages%receive(:, j)
      end do
    end associate
  end subroutine edges_return_changes

  !> List the tables of the edges, and their messages.
  subroutine edges_list_tables(self, tables)
    class(edges_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to
    integer(i8) :: bytes
    integer :: c

    call tables%begin('edges', per_body)
    call tables%note('colour', self%colour)
    call tables%note('lent_first', self%lent_first)
    call tables%note('lent', self%lent)
    call tables%note('borrowed_first', self%borrowed_first)
    call tables%note('borrowed', self%borrowed)
    bytes = -1
    if (allocated(self%lend)) then
      bytes = 0
      do c = lbound(self%lend, 1), ubound(self%lend, 1)
        bytes = bytes + self%lend(c)%table_bytes() + self%give_back(c)%table_bytes()
      end do
    end if
    call tables%add('messages', bytes)
  end subroutine edges_list_tables
end module sg_edges
