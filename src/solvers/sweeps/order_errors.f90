!> Errors of contacts that an order of sweeps holds side by side, from the records of its lanes, which the caches have; and of all
!! others from those of the problem (doc/theory/errors.md).
!!
!! Sums are those of `sum_errors` in another order. Others are copied to a problem of their own, which borrows the bodies.
module sg_order_errors
  use, intrinsic :: iso_c_binding, only: c_int
  use sg_error_lanes, only: groups_of_bound, lanes_of_arms, lanes_of_balls, lanes_of_disks, lanes_of_plain_disks, measure_lanes
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_law_violation, only: take_largest
  use sg_natural_map, only: chunk
  use sg_problem, only: problem_t
  use sg_records, only: ball_frictional, impulse_length, record_length, round_frictional
  use sg_residuals, only: find_worst, n_error_sums, sum_errors
  use sg_sweep_order, only: sweep_order_t
  use sg_sweep_round_lanes, only: plain_length_of_disks
  use sg_tables, only: per_contact, tables_t
  use sg_threads, only: begin_share, n_sharing, piece_t, share_t, takes
  implicit none
  private
  public :: order_errors_t

  !> Least share of the contacts that an order has to hold: the others are copied
  real(wp), parameter :: least_share = 0.75_wp
  !> Groups of a part of the sums: so many runs of those that share a bound
  integer, parameter :: groups_of_part = 8*groups_of_bound
  !> Least parts that a thread takes at once
  integer, parameter :: least_parts = 2

  !> The last test of an order
  type :: order_errors_t
    !> Was the last test of all one of these?
    logical :: is_set = .false.
    !> Contacts that the order does not hold
    integer, private :: n_others = 0
    integer(i4), allocatable, private :: other(:)
    !> Some contacts of the problem; the state of the order if they are these, else -1
    type(problem_t), private :: part
    integer, private :: serial = -1
    !> What determines the active set (sg_active_set), shape (lanes, groups), and of the others
    real(wp), allocatable, private :: closing(:, :), closing_of_others(:)
    !> Bounds of runs of groups, and of chunks of the others [m2/s2]
    real(wp), allocatable, private :: bounds(:), bounds_of_others(:)
  contains
    procedure :: begin => order_errors_begin
    procedure :: measure => order_errors_measure
    procedure :: choose => order_errors_choose
    procedure :: find_worst => order_errors_find_worst
    procedure :: list_tables => order_errors_list_tables
  end type order_errors_t

contains

  !> Begin a solve.
  pure subroutine order_errors_begin(self)
    class(order_errors_t), intent(inout) :: self

    self%is_set = .false.
    self%serial = -1
  end subroutine order_errors_begin

  !> Sum the errors of a problem whose impulses are those of the order, as `sum_errors` does.
  subroutine order_errors_measure(self, problem, order, is_ordered, with_e1, sums)
    class(order_errors_t), intent(inout) :: self !! is set, unless the order has no contacts side by side, or too few
    type(problem_t), intent(inout) :: problem !! comes back as it was
    type(sweep_order_t), intent(in) :: order !! contacts of a sweep
    logical, intent(in), contiguous :: is_ordered(:) !! which contacts of the problem it holds
    logical, intent(in) :: with_e1 !! measure e1, and set bounds, too?
    real(wp), intent(out) :: sums(n_error_sums) !! the sums, where it is set
    real(wp) :: sums_of_others(n_error_sums)

    self%is_set = order%lanes%n_groups > 0 .and. real(order%n, wp) >= least_share*real(problem%n_contacts, wp)
    if (.not. self%is_set) return
    call make_room(self, order%lanes%n_groups, problem%n_contacts)
    call measure_groups(self, problem, order, with_e1, sums)
    if (.not. self%is_set) return
    ! Neither their records nor their impulses change in a solve, except by rates of a cell.
    if (self%serial /= order%serial .or. problem%cell%is_on) then
      self%n_others = 0
      if (order%n < problem%n_contacts) call list_others(is_ordered(:problem%n_contacts), self%n_others, self%other)
      call copy_others(self, problem, order%serial)
    end if
    if (self%n_others == 0) return
    call move_alloc(problem%body, self%part%body)
    call sum_errors(self%part, with_e1, sums_of_others, closing=self%closing_of_others, bounds=self%bounds_of_others)
    call move_alloc(self%part%body, problem%body)
    sums = sums + sums_of_others
  end subroutine order_errors_measure

  !> Room for groups and contacts.
  pure subroutine make_room(self, groups, contacts)
    type(order_errors_t), intent(inout) :: self
    integer, intent(in) :: groups, contacts

    if (allocated(self%closing)) then
      if (size(self%closing, 2) < groups) deallocate (self%closing, self%bounds)
    end if
    if (.not. allocated(self%closing)) &
      allocate (self%closing(lanes, groups + groups/8), self%bounds((groups + groups/8)/groups_of_bound + 1))
    if (allocated(self%other)) then
      if (size(self%other) <= contacts) deallocate (self%other)
    end if
    if (.not. allocated(self%other)) allocate (self%other(contacts + contacts/8 + 1))
  end subroutine make_room

  !> Sums over the groups; not set where a record is not there.
  subroutine measure_groups(self, problem, order, with_e1, sums)
    type(order_errors_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(sweep_order_t), intent(in) :: order
    logical, intent(in) :: with_e1
    real(wp), intent(out) :: sums(n_error_sums)
    real(wp) :: part(n_error_sums, (order%lanes%n_groups + groups_of_part - 1)/groups_of_part)
    logical :: is_there(size(part, 2))
    type(share_t) :: share
    type(piece_t) :: piece
    integer(c_int) :: kind, length
    integer :: t, p

    kind = lanes_of_arms
    if (problem%kind == round_frictional) kind = lanes_of_disks
    if (problem%kind == ball_frictional) kind = lanes_of_balls
    length = size(order%lanes%record, 2, c_int)
    if (kind == lanes_of_disks .and. length == plain_length_of_disks) kind = lanes_of_plain_disks
    call begin_share(share, size(part, 2), least_parts)
    !$omp taskloop default(shared) private(t, p, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        do p = piece%first, piece%last
          associate (own => order%lanes, g => (p - 1)*groups_of_part + 1)
            is_there(p) = measure_lanes(kind, int(min(groups_of_part, own%n_groups - g + 1), c_int), length, own%group_size(g), &
                                        own%pair(1, 1, g), own%record(1, 1, g), own%shared, own%impulse(1, 1, g), problem%body, &
                                        merge(1_c_int, 0_c_int, with_e1), part(:, p), self%closing(1, g), &
                                        self%bounds((g - 1)/groups_of_bound + 1)) > 0
          end associate
        end do
      end do
    end do
    ! In the order of the parts, whichever thread had them.
    sums = sum(part, 2)
    self%is_set = all(is_there)
  end subroutine measure_groups

  !> List the contacts that an order does not hold: without branches.
  pure subroutine list_others(is_ordered, n, other)
    logical, intent(in), contiguous :: is_ordered(:)
    integer, intent(out) :: n
    integer(i4), intent(inout), contiguous :: other(:)
    integer :: k

    n = 0
    do k = 1, size(is_ordered)
      other(n + 1) = int(k, i4)
      n = n + merge(0, 1, is_ordered(k))
    end do
  end subroutine list_others

  !> Copy the contacts that an order does not hold.
  subroutine copy_others(self, problem, serial)
    type(order_errors_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: serial !! state of the order

    call copy_part(problem, self%other(:self%n_others), self%part)
    self%serial = serial
    if (allocated(self%closing_of_others)) then
      if (size(self%closing_of_others) < self%n_others) deallocate (self%closing_of_others)
    end if
    if (.not. allocated(self%closing_of_others)) allocate (self%closing_of_others(self%n_others + self%n_others/8))
  end subroutine copy_others

  !> Copy some contacts of a problem, without its bodies.
  subroutine copy_part(problem, contact, part)
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in), contiguous :: contact(:)
    type(problem_t), intent(inout) :: part
    integer :: room

    if (allocated(part%record)) then
      if (part%kind /= problem%kind .or. size(part%record, 2) < size(contact)) deallocate (part%pair, part%record, part%impulse)
    end if
    if (.not. allocated(part%record)) then
      room = size(contact) + size(contact)/8
      allocate (part%pair(2, room), part%record(record_length(problem%kind), room))
      allocate (part%impulse(impulse_length(problem%kind), room))
    end if
    part%kind = problem%kind
    part%n_bodies = problem%n_bodies
    part%n_contacts = size(contact)
    call copy_contacts(size(contact), record_length(problem%kind), impulse_length(problem%kind), contact, problem%pair, &
                       problem%record, problem%impulse, part%pair, part%record, part%impulse)
  end subroutine copy_part

  !> The same, in room that is there.
  pure subroutine copy_contacts(n, length, components, contact, pair, record, impulse, own_pair, own_record, own_impulse)
    integer, intent(in) :: n, length, components
    integer(i4), intent(in) :: contact(n), pair(2, *)
    real(wp), intent(in) :: record(length, *), impulse(components, *)
    integer(i4), intent(inout) :: own_pair(2, *)
    real(wp), intent(inout) :: own_record(length, *), own_impulse(components, *)
    integer :: i

    do i = 1, n
      own_pair(:, i) = pair(:, contact(i))
      own_record(:, i) = record(:, contact(i))
      own_impulse(:, i) = impulse(:, contact(i))
    end do
  end subroutine copy_contacts

  !> Mark the contacts that part no faster than a limit, and those that carry.
  pure subroutine order_errors_choose(self, order, is_ordered, limit, is_wanted)
    class(order_errors_t), intent(in) :: self !! set
    type(sweep_order_t), intent(in) :: order !! the same as when it was set
    logical, intent(in), contiguous :: is_ordered(:) !! which contacts of the problem it holds
    real(wp), intent(in) :: limit !! the limit [m/s]
    logical, intent(inout), contiguous :: is_wanted(:) !! the marks
    integer :: i, g, e

    is_wanted = is_ordered(:size(is_wanted))
    do i = 1, self%n_others
      is_wanted(self%other(i)) = self%closing_of_others(i) <= limit
    end do
    if (count(self%closing(:, :order%lanes%n_groups) <= limit) == lanes*order%lanes%n_groups) return
    e = 0
    do g = 1, order%lanes%n_groups
      do i = 1, order%lanes%group_size(g)
        e = e + 1
        is_wanted(order%contact(e)) = self%closing(i, g) <= limit
      end do
    end do
  end subroutine order_errors_choose

  !> Find the contact that breaks its law by the largest velocity, right after a test with bounds: runs of groups with the largest
  !! bounds first, until none of the others can have it.
  subroutine order_errors_find_worst(self, problem, order, contact, speed)
    class(order_errors_t), intent(inout) :: self !! set
    type(problem_t), intent(inout) :: problem !! comes back as it was
    type(sweep_order_t), intent(in) :: order !! the same as when it was set
    integer, intent(out) :: contact !! number of that contact; zero where all obey
    real(wp), intent(out) :: speed !! its velocity [m/s]
    integer :: run, first, last, found
    real(wp) :: bounds((order%lanes%n_groups + groups_of_bound - 1)/groups_of_bound)

    contact = 0
    speed = 0
    bounds = self%bounds(:size(bounds))
    do
      call take_largest(bounds, speed, run)
      if (run == 0) exit
      first = sum(order%lanes%group_size(:(run - 1)*groups_of_bound)) + 1
      last = first - 1 + sum(order%lanes%group_size((run - 1)*groups_of_bound + 1:min(order%lanes%n_groups, run*groups_of_bound)))
      call copy_part(problem, order%contact(first:last), self%part)
      self%serial = -1
      call look_closer(self%part, problem%body, found, speed)
      if (found > 0) contact = order%contact(first - 1 + found)
    end do
    if (self%n_others == 0) return
    if (.not. any(self%bounds_of_others(:(self%n_others + chunk - 1)/chunk) > speed**2)) return
    if (self%serial /= order%serial) call copy_others(self, problem, order%serial)
    call look_closer(self%part, problem%body, found, speed, self%bounds_of_others)
    if (found > 0) contact = self%other(found)
  end subroutine order_errors_find_worst

  !> The contact of a part that breaks its law by more than a velocity; zero where there is none.
  subroutine look_closer(part, body, contact, speed, bounds)
    type(problem_t), intent(inout) :: part
    real(wp), allocatable, intent(inout) :: body(:, :) !! lent to the part
    integer, intent(out) :: contact
    real(wp), intent(inout) :: speed !! that velocity, then the one that was found [m/s]
    real(wp), allocatable, intent(in), optional :: bounds(:)
    real(wp) :: above

    above = speed
    call move_alloc(body, part%body)
    call find_worst(part, contact, speed, bounds, above)
    call move_alloc(part%body, body)
  end subroutine look_closer

  !> List the tables.
  subroutine order_errors_list_tables(self, tables)
    class(order_errors_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('order_errors', per_contact)
    call tables%note('other', self%other)
    call tables%note('closing', self%closing)
    call tables%note('closing_of_others', self%closing_of_others)
    call tables%note('bounds', self%bounds)
    call tables%note('bounds_of_others', self%bounds_of_others)
    call tables%note('pair', self%part%pair)
    call tables%note('record', self%part%record)
    call tables%note('impulse', self%part%impulse)
  end subroutine order_errors_list_tables
end module sg_order_errors
