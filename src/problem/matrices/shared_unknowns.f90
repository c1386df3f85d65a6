!> The unknown velocities of a contact problem that several ranks hold: those of bodies that any rank's contacts push, where they
!! are not driven, numbered through all ranks.
!!
!! A body's unknowns belong to its owner, those of replicated bodies to rank 0. Numbers, masses and the axes in which masses are
!! diagonal come from there: those that ranks find for themselves may differ in the last digits, and axes by much more.
module sg_shared_unknowns
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4, i8
  use sg_owner_sums, only: add_at_owner, copy_from_owner
  use sg_problem, only: problem_t
  use sg_problem_records, only: body_of, body_record_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: shared_unknowns_t, number_unknowns

  !> Values that owner ranks send of a body: numbers of its unknowns, axes, inverse masses
  integer, parameter :: n_sent = 6 + 9 + 6

  !> Unknowns that this rank has to do with: its own, then others' of bodies that its contacts push
  type :: shared_unknowns_t
    !> How many, how many of them are its own, those of lower ranks, and of all ranks
    integer :: n = 0, n_own = 0
    integer(i8) :: before = 0, all = 0
    !> Number of each in the whole problem; slot of its body, and component of its velocity
    integer(i4), allocatable :: number(:), slot(:), component(:)
    !> Place of each component of the velocity of a slot's body among them, 0 where there is none, shape (6, slots)
    integer(i4), allocatable :: of_slot(:, :)
    !> Bodies by slot, in their owners' axes; of those that have unknowns
    type(body_record_t), allocatable :: body(:)
  end type shared_unknowns_t

contains

  !> Number the unknowns of a problem. Collective.
  subroutine number_unknowns(problem, is_pushed, subdomain, slot_of, comm, unknowns)
    type(problem_t), intent(in) :: problem !! this rank's contacts, and the bodies that it holds
    logical, intent(in) :: is_pushed(:) !! do contacts of this rank push the body, by slot?
    type(subdomain_t), intent(in) :: subdomain !! which ranks share which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    type(shared_unknowns_t), intent(out) :: unknowns !! its unknowns
    real(wp) :: pushes(1, size(slot_of)), sent(n_sent, size(slot_of))
    logical :: is_own(size(slot_of))
    integer :: b

    allocate (unknowns%body(problem%n_bodies))
    is_own = are_own(subdomain, comm, size(slot_of))
    pushes(1, :) = merge(1.0_wp, 0.0_wp, is_pushed(slot_of))
    call add_at_owner(subdomain, comm, pushes)
    is_own = is_own .and. pushes(1, :) > 0.5_wp
    do b = 1, size(slot_of)
      if (is_own(b) .or. is_pushed(slot_of(b))) unknowns%body(slot_of(b)) = body_of(problem, int(slot_of(b)))
    end do
    call fill_sent(unknowns, is_own, slot_of, comm, sent)
    call copy_from_owner(subdomain, comm, sent)
    call copy_replicated(subdomain, comm, sent)
    call place_unknowns(unknowns, is_own, is_pushed, slot_of, sent)
  end subroutine number_unknowns

  !> Which bodies are owned by this rank; replicated ones are on rank 0.
  pure function are_own(subdomain, comm, n) result(is_own)
    type(subdomain_t), intent(in) :: subdomain
    type(comm_t), intent(in) :: comm
    integer, intent(in) :: n
    logical :: is_own(n)
    integer :: i

    is_own = .true.
    if (comm%size == 1) return
    do i = 1, size(subdomain%body)
      if (subdomain%owner(i) /= comm%rank) is_own(subdomain%body(i)) = .false.
    end do
    if (comm%rank > 0) is_own(subdomain%replicated) = .false.
  end function are_own

  !> Number the unknowns of a rank's own bodies, and fill what other ranks receive of these.
  subroutine fill_sent(unknowns, is_own, slot_of, comm, sent)
    type(shared_unknowns_t), intent(inout) :: unknowns
    logical, intent(in) :: is_own(:)
    integer(i4), intent(in) :: slot_of(:)
    type(comm_t), intent(inout) :: comm
    real(wp), intent(out) :: sent(:, :)
    integer :: b, c

    sent = 0
    do b = 1, size(slot_of)
      if (.not. is_own(b)) cycle
      associate (body => unknowns%body(slot_of(b)))
        do c = 1, body%n
          if (.not. body%inverse_mass(c) > 0) cycle
          unknowns%n_own = unknowns%n_own + 1
          sent(c, b) = real(unknowns%n_own, wp)
        end do
        sent(7:15, b) = reshape(body%axes, [9])
        sent(16:, b) = body%inverse_mass
      end associate
    end do
    call comm%before(int(unknowns%n_own, i8), unknowns%before, unknowns%all)
    where (sent(:6, :) > 0) sent(:6, :) = sent(:6, :) + real(unknowns%before, wp)
  end subroutine fill_sent

  !> Give all ranks what rank 0 has of replicated bodies.
  subroutine copy_replicated(subdomain, comm, sent)
    type(subdomain_t), intent(in) :: subdomain
    type(comm_t), intent(inout) :: comm
    real(wp), intent(inout) :: sent(:, :)
    real(wp), allocatable :: replicated(:)

    if (comm%size == 1) return
    if (size(subdomain%replicated) == 0) return
    replicated = reshape(sent(:, subdomain%replicated), [n_sent*size(subdomain%replicated)])
    call comm%broadcast(replicated, 0)
    sent(:, subdomain%replicated) = reshape(replicated, [n_sent, size(subdomain%replicated)])
  end subroutine copy_replicated

  !> List the unknowns: own ones by their numbers, then those of others' bodies that contacts push here.
  pure subroutine place_unknowns(unknowns, is_own, is_pushed, slot_of, sent)
    type(shared_unknowns_t), intent(inout) :: unknowns
    logical, intent(in) :: is_own(:), is_pushed(:)
    integer(i4), intent(in) :: slot_of(:)
    real(wp), intent(in) :: sent(:, :)
    integer :: b, c, place

    allocate (unknowns%of_slot(6, size(unknowns%body)), source=0_i4)
    unknowns%n = unknowns%n_own
    place = count(sent(:6, :) > 0)
    allocate (unknowns%number(place), unknowns%slot(place), unknowns%component(place))
    do b = 1, size(slot_of)
      associate (slot => slot_of(b), body => unknowns%body(slot_of(b)))
        if (.not. (is_own(b) .or. is_pushed(slot))) cycle
        if (.not. is_own(b)) call turn_axes(reshape(sent(7:15, b), [3, 3]), sent(16:, b), body)
        do c = 1, body%n
          if (.not. sent(c, b) > 0) cycle
          if (is_own(b)) then
            place = int(nint(sent(c, b), i8) - unknowns%before)
          else
            unknowns%n = unknowns%n + 1
            place = unknowns%n
          end if
          unknowns%number(place) = nint(sent(c, b), i4)
          unknowns%slot(place) = slot
          unknowns%component(place) = int(c, i4)
          unknowns%of_slot(c, slot) = int(place, i4)
        end do
      end associate
    end do
  end subroutine place_unknowns

  !> Take the axes and inverse masses of a body's owner.
  pure subroutine turn_axes(axes, inverse_mass, body)
    real(wp), intent(in) :: axes(3, 3), inverse_mass(6)
    type(body_record_t), intent(inout) :: body

    if (body%n == 6) body%velocity(4:6) = matmul(matmul(body%axes, body%velocity(4:6)), axes)
    body%axes = axes
    body%inverse_mass = inverse_mass
  end subroutine turn_axes
end module sg_shared_unknowns
