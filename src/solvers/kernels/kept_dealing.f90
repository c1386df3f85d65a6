!> What contacts were dealt to groups by: where the next problem has the same, it has the same groups.
!!
!! Lists are compared whole, without a branch per contact: pairs of all contacts, marks of those chosen, and of bodies that move.
module sg_kept_dealing
  use sg_kinds, only: wp, i4
  use sg_lists, only: copy_flags, copy_integers
  use sg_problem, only: problem_t
  use sg_problem_bodies, only: find_movable
  use sg_records, only: body_length, first_inverse
  implicit none
  private
  public :: kept_dealing_t

  !> The last dealing of all contacts of an order at once
  type :: kept_dealing_t
    !> Contacts dealt, none where no dealing is kept, and kind of their problem
    integer :: n = 0
    integer, private :: kind = 0
    !> Contacts and bodies of that problem
    integer, private :: n_contacts = 0, n_bodies = 0
    !> Groups in vector registers, groups of solids and rows of solids that came of it
    integer :: groups(3) = 0
    !> Slots of each contact, shape (2, contacts); was it dealt? shape (contacts)
    integer(i4), allocatable :: slots(:, :)
    logical, allocatable :: is_dealt(:)
    !> Can impulses move a body? shape (bodies)
    logical, allocatable :: moves(:)
  contains
    procedure :: note => kept_dealing_note
    procedure :: holds => kept_dealing_holds
  end type kept_dealing_t

contains

  !> Note what contacts were dealt by, and to.
  pure subroutine kept_dealing_note(self, problem, is_dealt, groups)
    class(kept_dealing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! their problem
    logical, intent(in), contiguous :: is_dealt(:) !! which of its contacts were dealt, shape (contacts)
    integer, intent(in) :: groups(3) !! groups in vector registers, groups of solids and rows of solids

    call make_room(self, problem%n_contacts, problem%n_bodies)
    associate (n => problem%n_contacts, m => problem%n_bodies)
      self%n = count(is_dealt(:n))
      self%kind = problem%kind
      self%n_contacts = n
      self%n_bodies = m
      self%groups = groups
      call copy_flags(n, is_dealt, self%is_dealt)
      call copy_integers(2*n, problem%pair, self%slots)
      if (allocated(problem%moves)) then
        call copy_flags(m, problem%moves, self%moves)
      else
        call find_movable(m, body_length(problem%kind), first_inverse(problem%kind), problem%body, self%moves)
      end if
    end associate
  end subroutine kept_dealing_note

  !> Room for the contacts and bodies of a problem.
  pure subroutine make_room(self, contacts, bodies)
    class(kept_dealing_t), intent(inout) :: self
    integer, intent(in) :: contacts, bodies

    if (allocated(self%slots)) then
      if (size(self%is_dealt) < contacts .or. size(self%moves) < bodies) deallocate (self%slots, self%is_dealt, self%moves)
    end if
    if (allocated(self%slots)) return
    allocate (self%slots(2, contacts + contacts/8), self%is_dealt(contacts + contacts/8), self%moves(bodies))
  end subroutine make_room

  !> Would the same contacts of a problem be dealt to the same groups?
  pure logical function kept_dealing_holds(self, problem, is_wanted) result(holds)
    class(kept_dealing_t), intent(in) :: self
    type(problem_t), intent(in) :: problem !! problem to sweep
    logical, intent(in), contiguous :: is_wanted(:) !! which of its contacts are to be dealt, shape (contacts)

    holds = self%n > 0 .and. problem%kind == self%kind .and. problem%n_contacts == self%n_contacts &
            .and. problem%n_bodies == self%n_bodies
    if (holds) holds = are_same_marks(self%n_contacts, self%is_dealt, is_wanted)
    if (holds) holds = are_same_slots(2*self%n_contacts, self%slots, problem%pair)
    if (holds) holds = do_same_move(self, problem)
  end function kept_dealing_holds

  !> Can impulses move the same bodies?
  pure logical function do_same_move(self, problem)
    class(kept_dealing_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    logical, allocatable :: moves(:)

    if (allocated(problem%moves)) then
      do_same_move = are_same_marks(self%n_bodies, self%moves, problem%moves)
    else
      allocate (moves(self%n_bodies))
      call find_movable(self%n_bodies, body_length(self%kind), first_inverse(self%kind), problem%body, moves)
      do_same_move = are_same_marks(self%n_bodies, self%moves, moves)
    end if
  end function do_same_move

  !> Do two lists mark the same?
  pure logical function are_same_marks(n, one, other)
    integer, intent(in) :: n
    logical, intent(in) :: one(n), other(n)

    are_same_marks = count(one .neqv. other) == 0
  end function are_same_marks

  !> Are two lists of slots the same?
  pure logical function are_same_slots(n, one, other)
    integer, intent(in) :: n
    integer(i4), intent(in) :: one(n), other(n)
    integer(i4) :: differences
    integer :: i

    differences = 0
    do i = 1, n
      differences = ior(differences, ieor(one(i), other(i)))
    end do
    are_same_slots = differences == 0
  end function are_same_slots
end module sg_kept_dealing
