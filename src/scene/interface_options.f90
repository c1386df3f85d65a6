!> Interfaces as a deck asks for them: the pairs of bodies that have rows in interfaces.csv (doc/guide/interfaces.md).
module sg_interface_options
  use sg_ascending, only: place_in
  use sg_kinds, only: i4
  use sg_text, only: text_t, to_text
  implicit none
  private
  public :: interface_options_t, interface_pairs_t

  !> The pairs of one block
  type :: interface_pairs_t
    !> Numbers of the bodies on either side, ascending; unallocated where the block names none
    integer(i4), allocatable :: first(:), second(:)
    !> Colours of the shapes on either side; 0 for any
    integer :: colour(2) = 0
  contains
    procedure :: first_side => pairs_first_side
  end type interface_pairs_t

  !> All blocks of a deck
  type :: interface_options_t
    type(interface_pairs_t), allocatable :: blocks(:)
    !> Numbers of the bodies that have a name, ascending, and their names
    integer(i4), allocatable :: number(:)
    type(text_t), allocatable :: name(:)
  contains
    procedure :: first_side => options_first_side
    procedure :: name_of => options_name_of
  end type interface_options_t

contains

  !> Which side of a contact is the first body of its pair: 1 the candidate, 2 the antagonist, 0 where no block asks for the pair.
  pure integer function options_first_side(self, number, colour) result(side)
    class(interface_options_t), intent(in) :: self
    integer(i4), intent(in) :: number(2) !! bodies in the whole scene, candidate and antagonist
    integer(i4), intent(in) :: colour(2) !! colours of their shapes
    integer :: i

    side = 0
    do i = 1, size(self%blocks)
      if (side == 0) side = self%blocks(i)%first_side(number, colour)
    end do
  end function options_first_side

  !> The same of one block; where both sides may be the first one, the body with the lower number is.
  pure integer function pairs_first_side(self, number, colour) result(side)
    class(interface_pairs_t), intent(in) :: self
    integer(i4), intent(in) :: number(2) !! bodies in the whole scene, candidate and antagonist
    integer(i4), intent(in) :: colour(2) !! colours of their shapes
    logical :: may_begin(2)

    if (allocated(self%first)) then
      may_begin(1) = place_in(self%first, number(1)) > 0
      if (may_begin(1)) may_begin(1) = place_in(self%second, number(2)) > 0
      may_begin(2) = place_in(self%first, number(2)) > 0
      if (may_begin(2)) may_begin(2) = place_in(self%second, number(1)) > 0
    else
      may_begin(1) = all(self%colour == 0 .or. self%colour == colour)
      may_begin(2) = all(self%colour == 0 .or. self%colour == colour([2, 1]))
    end if
    side = 0
    if (may_begin(1)) side = 1
    if (may_begin(2)) side = 2
    if (all(may_begin)) side = merge(1, 2, number(1) < number(2))
  end function pairs_first_side

  !> Name of a body, or its number where it has none.
  pure function options_name_of(self, number) result(name)
    class(interface_options_t), intent(in) :: self
    integer(i4), intent(in) :: number !! in the whole scene
    character(len=:), allocatable :: name
    integer :: place

    place = place_in(self%number, number)
    if (place > 0) then
      name = self%name(place)%s
    else
      name = to_text(int(number))
    end if
  end function options_name_of
end module sg_interface_options
