!> Contacts of disks, of balls, or with arms in the plane, with friction, side by side for vector registers: what the problem has of
!! them is put into lanes in the order of the groups that they were dealt to (sg_group_dealing), and given back.
!!
!! A list of contacts goes with the groups: those of the first group, of the second, and so on.
module sg_contact_lanes
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_problem, only: problem_t
  use sg_records, only: ball_frictional, bias_place, force_length, impulse_length, record_length, round_frictional
  use sg_sweep_arm_lanes, only: lane_length_of_arms, put_arm_lanes
  use sg_sweep_ball_lanes, only: put_ball_lanes
  use sg_sweep_round_lanes, only: lane_length_of_disks, plain_length_of_disks, put_round_lanes, shared_of
  use sg_threads, only: begin_share, n_sharing, piece_t, share_t, takes
  implicit none
  private
  public :: contact_lanes_t, fill_lanes, give_lanes, put_lane_biases, put_lane_impulses

  !> Least groups of a piece that a thread fills
  integer, parameter :: least_groups = 128

  !> Groups of contacts side by side; lanes to spare change nothing
  type :: contact_lanes_t
    !> Number of groups, and contacts of each
    integer :: n_groups = 0
    integer(i4), allocatable :: group_size(:)
    !> Slots of candidate and antagonist, shape (lanes, 2, groups)
    integer(i4), allocatable :: pair(:, :, :)
    !> Records, shape (lanes, reals of a lane, groups), and impulses, shape (lanes, components, groups) [N s]
    real(wp), allocatable :: record(:, :, :), impulse(:, :, :)
    !> What records of disks share (sg_sweep_round_lanes)
    real(wp) :: shared(2) = 0
  end type contact_lanes_t

contains

  !> Put slots, records and impulses side by side, group by group, from a first group on.
  subroutine fill_lanes(self, problem, contact, first_group, first, is_done)
    type(contact_lanes_t), intent(inout) :: self !! groups whose contacts are counted
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i4), intent(in), contiguous :: contact(:) !! contacts of all groups
    integer, intent(in) :: first_group !! first group to fill
    integer, intent(in) :: first !! its first contact
    logical, intent(out) :: is_done !! false where the law of a contact has no place in lanes

    if (first_group > 1) then
      ! Reals of a lane stay: a law that they have no place for is for an order that is set again.
      call reserve(self%pair, self%n_groups)
      call reserve(self%record, self%n_groups)
      call reserve(self%impulse, self%n_groups)
      call share_lanes(self, problem, contact, first_group, first, is_done)
      return
    end if
    call make_lanes(self, problem, contact, .true.)
    call share_lanes(self, problem, contact, 1, 1, is_done)
    if (is_done .or. problem%kind /= round_frictional) return
    call make_lanes(self, problem, contact, .false.)
    call share_lanes(self, problem, contact, 1, 1, is_done)
  end subroutine fill_lanes

  !> Room for all groups, and what plain records of disks share.
  pure subroutine make_lanes(self, problem, contact, may_be_plain)
    type(contact_lanes_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in), contiguous :: contact(:)
    logical, intent(in) :: may_be_plain !! may records of disks be plain?
    integer :: length, n

    select case (problem%kind)
    case (round_frictional)
      self%shared = shared_of(size(contact), contact, problem%record)
      ! Rates of a cell change biases, along tangents too.
      length = merge(plain_length_of_disks, lane_length_of_disks, may_be_plain .and. .not. problem%cell%is_on)
    case (ball_frictional)
      length = record_length(ball_frictional)
    case default
      length = lane_length_of_arms
    end select
    if (allocated(self%pair)) then
      if (size(self%pair, 3) >= self%n_groups .and. size(self%record, 2) == length) return
      deallocate (self%pair, self%record, self%impulse)
    end if
    n = self%n_groups + self%n_groups/8
    allocate (self%pair(lanes, 2, n), self%record(lanes, length, n), self%impulse(lanes, impulse_length(problem%kind), n))
  end subroutine make_lanes

  !> Fill groups, from one to the last, in room that is there; threads share them.
  subroutine share_lanes(self, problem, contact, first_group, first, is_done)
    type(contact_lanes_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in), contiguous :: contact(:)
    integer, intent(in) :: first_group, first
    logical, intent(out) :: is_done
    type(share_t) :: share
    type(piece_t) :: piece
    logical, allocatable :: are_done(:)
    integer :: t, before

    call begin_share(share, self%n_groups - first_group + 1, least_groups)
    allocate (are_done(share%pieces), source=.true.)
    !$omp taskloop default(shared) private(t, before, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        before = sum(self%group_size(first_group:first_group + piece%first - 2))
        call put_lanes(self, problem, contact, first_group + piece%first - 1, first_group + piece%last - 1, first + before, &
                       are_done(piece%number))
      end do
    end do
    is_done = all(are_done)
  end subroutine share_lanes

  !> Fill some of them.
  pure subroutine put_lanes(self, problem, contact, first_group, last_group, first, is_done)
    type(contact_lanes_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in), contiguous :: contact(:)
    integer, intent(in) :: first_group, last_group, first
    logical, intent(out) :: is_done

    associate (sizes => self%group_size, pair => problem%pair, record => problem%record, r => problem%impulse)
      select case (problem%kind)
      case (round_frictional)
        call put_round_lanes(first_group, last_group, first, size(self%record, 2), self%shared, sizes, contact, pair, record, r, &
                             self%pair, self%record, self%impulse, is_done)
        is_done = is_done .or. size(self%record, 2) == lane_length_of_disks
      case (ball_frictional)
        is_done = .true.
        call put_ball_lanes(first_group, last_group, first, sizes, contact, pair, record, r, self%pair, self%record, self%impulse)
      case default
        call put_arm_lanes(first_group, last_group, first, sizes, contact, pair, record, r, self%pair, self%record, self%impulse, &
                           is_done)
      end select
    end associate
  end subroutine put_lanes

  !> Copy impulses from the lanes back to the problem.
  pure subroutine give_lanes(self, contact, problem)
    type(contact_lanes_t), intent(in) :: self !! groups swept
    integer(i4), intent(in), contiguous :: contact(:) !! their contacts
    type(problem_t), intent(inout) :: problem !! its impulses are set

    call give(self%n_groups, size(problem%impulse, 1), self%group_size, contact, self%impulse, problem%impulse)
  end subroutine give_lanes

  !> The same on plain arrays.
  pure subroutine give(n_groups, components, group_size, contact, own, impulse)
    integer, intent(in) :: n_groups, components
    integer(i4), intent(in) :: group_size(*), contact(*)
    real(wp), intent(in) :: own(lanes, components, *)
    real(wp), intent(inout) :: impulse(components, *)
    integer :: g, i, e

    e = 0
    do g = 1, n_groups
      do i = 1, group_size(g)
        e = e + 1
        impulse(1, contact(e)) = own(i, 1, g)
        impulse(2, contact(e)) = own(i, 2, g)
        if (components > 2) impulse(3, contact(e)) = own(i, 3, g)
      end do
    end do
  end subroutine give

  !> Copy impulses from the problem to the lanes, which hold its contacts already.
  pure subroutine put_lane_impulses(problem, contact, self)
    type(problem_t), intent(in) :: problem !! problem being swept
    integer(i4), intent(in), contiguous :: contact(:) !! contacts of the groups
    type(contact_lanes_t), intent(inout) :: self !! its impulses are set

    call put(self%n_groups, self%group_size, contact, 1, size(problem%impulse, 1), problem%impulse, self%impulse)
  end subroutine put_lane_impulses

  !> Copy biases from the problem to the lanes, which hold its contacts already.
  pure subroutine put_lane_biases(problem, contact, self)
    type(problem_t), intent(in) :: problem !! problem being swept
    integer(i4), intent(in), contiguous :: contact(:) !! contacts of the groups
    type(contact_lanes_t), intent(inout) :: self !! its records change
    integer :: first, last

    first = bias_place(problem%kind)
    last = first + force_length(problem%kind) - 1
    ! Plain disks have none along tangents.
    if (problem%kind == round_frictional .and. size(self%record, 2) == plain_length_of_disks) last = first
    call put(self%n_groups, self%group_size, contact, first, last, problem%record, self%record)
  end subroutine put_lane_biases

  !> Copy some values of each contact into its lane.
  pure subroutine put(n_groups, group_size, contact, first, last, values, own)
    integer, intent(in) :: n_groups, first, last
    integer(i4), intent(in), contiguous :: group_size(:), contact(:)
    real(wp), intent(in), contiguous :: values(:, :)
    real(wp), intent(inout), contiguous :: own(:, :, :)
    integer :: i, g, e

    e = 0
    do g = 1, n_groups
      do i = 1, group_size(g)
        e = e + 1
        own(i, first:last, g) = values(first:last, contact(e))
      end do
    end do
  end subroutine put
end module sg_contact_lanes
