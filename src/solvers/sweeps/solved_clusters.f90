!> Clusters of contacts that are solved while others are not: sweeps leave them alone (doc/theory/nlgs.md).
!!
!! A cluster is what bodies that move hold together: walls join nothing. W has no entry between the contacts of two clusters,
!! so that a cluster which no sweep visits keeps its error to the last bit, whatever the others do. On several ranks that holds for
!! clusters that lie within one of them.
module sg_solved_clusters
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_run_options, only: criterion_e8, criterion_estimate, solver_options_t
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: solved_clusters_t

  !> Sweeps of a solve after which clusters are looked for, and by how much they must grow before that is tried again where no
  !! cluster was solved: looking takes as long as a few sweeps
  integer, parameter :: patience = 200, patience_grows = 2
  !> A cluster is solved when the sum of its squares is below this part of its share of what is asked for of all: what it keeps is
  !! little beside what is left to the others
  real(wp), parameter :: part_of_share = 0.1_wp

  !> Room for clusters
  type :: solved_clusters_t
    !> Are clusters looked for at this test?
    logical :: are_sought = .false.
    !> Contacts left out because their clusters are solved, and sweeps at which to look again where there are none
    integer, private :: n_left_out = 0, next_look = patience
    !> Squares of the map that e8 is made of, shape (contacts)
    real(wp), allocatable :: squares(:)
    !> Body that leads to the one which stands for the cluster, by slot, 0 for one that nothing moves; contacts of the cluster, and
    !! what it has beyond its share
    integer(i4), allocatable, private :: parent(:), members(:)
    real(wp), allocatable, private :: excess(:)
  contains
    procedure :: begin => clusters_begin
    procedure :: prepare => clusters_prepare
    procedure :: leave_out => clusters_leave_out
    procedure :: list_tables => clusters_list_tables
  end type solved_clusters_t

contains

  !> Begin a solve: nothing is left out.
  pure subroutine clusters_begin(self)
    class(solved_clusters_t), intent(inout) :: self

    self%are_sought = .false.
    self%n_left_out = 0
    self%next_look = patience
  end subroutine clusters_begin

  !> Is it time to look for clusters at this test? Then make room.
  pure subroutine clusters_prepare(self, problem, options, sweeps)
    class(solved_clusters_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem being solved
    type(solver_options_t), intent(in) :: options !! whether they are wanted; the criterion must be one of e8
    integer, intent(in) :: sweeps !! done so far

    self%are_sought = options%leave_solved .and. (self%n_left_out > 0 .or. sweeps >= self%next_look) .and. &
                      any(options%criterion == [criterion_e8, criterion_estimate])
    if (.not. self%are_sought) return
    if (allocated(self%squares)) then
      if (size(self%squares) < problem%n_contacts) deallocate (self%squares)
    end if
    if (.not. allocated(self%squares)) allocate (self%squares(problem%n_contacts + problem%n_contacts/8))
    if (allocated(self%parent)) then
      if (size(self%parent) < problem%n_bodies) deallocate (self%parent, self%members, self%excess)
    end if
    if (.not. allocated(self%parent)) then
      allocate (self%parent(problem%n_bodies), self%members(problem%n_bodies), self%excess(problem%n_bodies))
    end if
  end subroutine clusters_prepare

  !> Take the contacts of solved clusters out of those that are to be visited.
  pure subroutine clusters_leave_out(self, problem, sweeps, asked, is_wanted, shared)
    class(solved_clusters_t), intent(inout) :: self !! prepared; its squares are measured
    type(problem_t), intent(in) :: problem !! problem being solved, or a rank's part of it
    integer, intent(in) :: sweeps !! done so far
    real(wp), intent(in) :: asked !! mean over all contacts of the squares that are asked for [N2 s2]
    logical, intent(inout) :: is_wanted(:) !! contacts to visit, shape (contacts)
    integer, intent(in) :: shared(:) !! slots of bodies on which others act too: their clusters stay
    integer :: k

    call join_bodies(self, problem, is_wanted)
    call weigh(self, problem, is_wanted, part_of_share*asked)
    call keep(self, shared)
    self%n_left_out = sum(self%members(:problem%n_bodies), .not. self%excess(:problem%n_bodies) > 0)
    self%next_look = patience_grows*sweeps
    ! Few are not worth an order of their own: then nothing changes.
    if (self%n_left_out < sum(self%members(:problem%n_bodies))/8) self%n_left_out = 0
    if (self%n_left_out == 0) return
    do k = 1, problem%n_contacts
      if (is_wanted(k)) is_wanted(k) = self%excess(cluster_of(self, problem, k)) > 0
    end do
  end subroutine clusters_leave_out

  !> Link each body to the one that represents its cluster.
  pure subroutine join_bodies(self, problem, is_wanted)
    type(solved_clusters_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    logical, intent(in) :: is_wanted(:)
    integer :: b, k, inverse

    inverse = first_inverse(problem%kind)
    do b = 1, problem%n_bodies
      self%parent(b) = int(b, i4)
      if (abs(problem%body(inverse, b)) > 0) cycle
      if (.not. any(abs(problem%body(inverse:, b)) > 0)) self%parent(b) = 0
    end do
    do k = 1, problem%n_contacts
      if (.not. is_wanted(k)) cycle
      associate (c => problem%pair(1, k), a => problem%pair(2, k))
        if (min(self%parent(c), self%parent(a)) > 0) call join(self%parent, c, a)
      end associate
    end do
    ! Lower numbers stand for higher ones: one pass leads all to the end of their way.
    do b = 1, problem%n_bodies
      if (self%parent(b) > 0) self%parent(b) = self%parent(self%parent(b))
    end do
  end subroutine join_bodies

  !> Body that stands for the cluster of a contact.
  pure integer function cluster_of(self, problem, k) result(root)
    type(solved_clusters_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k

    root = max(1, self%parent(problem%pair(1, k)), self%parent(problem%pair(2, k)))
  end function cluster_of

  !> Count the contacts of clusters, and sum what their squares are beyond their share.
  pure subroutine weigh(self, problem, is_wanted, share)
    type(solved_clusters_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    logical, intent(in) :: is_wanted(:)
    real(wp), intent(in) :: share !! of a contact
    integer :: k, root

    self%excess = 0
    self%members = 0
    do k = 1, problem%n_contacts
      if (.not. is_wanted(k)) cycle
      root = cluster_of(self, problem, k)
      self%excess(root) = self%excess(root) + self%squares(k) - share
      self%members(root) = self%members(root) + 1
    end do
  end subroutine weigh

  !> Keep the clusters of some bodies, whatever their squares are.
  pure subroutine keep(self, bodies)
    type(solved_clusters_t), intent(inout) :: self
    integer, intent(in) :: bodies(:)
    integer :: i

    do i = 1, size(bodies)
      self%excess(max(1, self%parent(bodies(i)))) = huge(1.0_wp)
    end do
  end subroutine keep

  !> Join the clusters of two bodies: the lower number stands for both (Rem's algorithm [Dijkstra1976]).
  pure subroutine join(parent, one, other)
    integer(i4), intent(inout) :: parent(:)
    integer(i4), intent(in) :: one, other
    integer(i4) :: r, s, next

    r = one
    s = other
    ! Up both ways in turn: a link to the higher number is replaced by one to the lower.
    do while (parent(r) /= parent(s))
      if (parent(r) < parent(s)) then
        next = parent(s)
        parent(s) = parent(r)
        if (next == s) return
        s = next
      else
        next = parent(r)
        parent(r) = parent(s)
        if (next == r) return
        r = next
      end if
    end do
  end subroutine join

  !> List the tables.
  subroutine clusters_list_tables(self, tables)
    class(solved_clusters_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('clusters', per_contact)
    call tables%note('squares', self%squares)
    call tables%begin('clusters', per_body)
    call tables%note('parent', self%parent)
    call tables%note('members', self%members)
    call tables%note('excess', self%excess)
  end subroutine clusters_list_tables
end module sg_solved_clusters
