!> What contacts were dealt to groups by: where the next problem has the same, it has the same groups.
module sg_kept_dealing
  use sg_kinds, only: i4
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  implicit none
  private
  public :: kept_dealing_t, is_movable

  !> The last dealing of all contacts of an order at once
  type :: kept_dealing_t
    !> Contacts, none where no dealing is kept, and kind of their problem
    integer :: n = 0
    integer, private :: kind = 0
    !> Groups of balls, groups of solids and rows of solids that came of it
    integer :: groups(3) = 0
    !> Slots of each contact, negative where nothing moves the body, shape (2, contacts)
    integer(i4), allocatable :: slots(:, :)
  contains
    procedure :: reserve => kept_dealing_reserve
    procedure :: note => kept_dealing_note
    procedure :: holds => kept_dealing_holds
  end type kept_dealing_t

contains

  !> Room for the contacts of an order; nothing is kept.
  pure subroutine kept_dealing_reserve(self, contacts)
    class(kept_dealing_t), intent(inout) :: self
    integer, intent(in) :: contacts !! at most

    self%n = 0
    if (allocated(self%slots)) deallocate (self%slots)
    allocate (self%slots(2, contacts))
  end subroutine kept_dealing_reserve

  !> Note what contacts were dealt by, and to.
  pure subroutine kept_dealing_note(self, problem, chosen, groups)
    class(kept_dealing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! their problem
    integer(i4), intent(in), contiguous :: chosen(:) !! contacts in the order in which they were dealt
    integer, intent(in) :: groups(3) !! groups of balls, groups of solids and rows of solids
    integer :: i

    self%n = size(chosen)
    self%kind = problem%kind
    self%groups = groups
    do i = 1, size(chosen)
      self%slots(:, i) = marked_slots(problem, chosen(i))
    end do
  end subroutine kept_dealing_note

  !> Would the same contacts of a problem be dealt to the same groups?
  pure logical function kept_dealing_holds(self, problem, chosen) result(holds)
    class(kept_dealing_t), intent(in) :: self
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i4), intent(in), contiguous :: chosen(:) !! contacts, by number those of the last dealing
    integer :: i

    holds = problem%kind == self%kind
    do i = 1, size(chosen)
      if (.not. holds) return
      holds = all(self%slots(:, i) == marked_slots(problem, chosen(i)))
    end do
  end function kept_dealing_holds

  !> Slots of a contact, negative where nothing moves the body.
  pure function marked_slots(problem, contact) result(slots)
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in) :: contact
    integer(i4) :: slots(2)
    integer :: side

    slots = problem%pair(:, contact)
    do side = 1, 2
      if (.not. is_movable(problem, slots(side))) slots(side) = -slots(side)
    end do
  end function marked_slots

  !> Can impulses move a body? Most can move along x: the others are looked at whole.
  pure logical function is_movable(problem, slot)
    type(problem_t), intent(in) :: problem !! problem
    integer(i4), intent(in) :: slot !! of the body
    integer :: inverse

    inverse = first_inverse(problem%kind)
    is_movable = problem%body(inverse, slot) > 0
    if (.not. is_movable) is_movable = any(problem%body(inverse:, slot) > 0)
  end function is_movable
end module sg_kept_dealing
