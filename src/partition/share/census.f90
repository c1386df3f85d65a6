!> Census of bodies that a rank does not keep while a deck is read: each rank goes through all of them, so that all
!! come to the same defaults and the same warnings without a message.
module sg_census
  use sg_contactors, only: contactors_t
  use sg_kinds, only: wp, i8
  implicit none
  private
  public :: census_t

  !> Bodies that other ranks keep
  type :: census_t
    !> How many
    integer :: n = 0
    !> Smallest radius of a circle or sphere about a shape [m]
    real(wp) :: smallest = huge(1.0_wp)
    !> Least and largest coordinates of their centres [m]
    real(wp) :: low(3) = huge(1.0_wp), high(3) = -huge(1.0_wp)
    !> Largest speed at the start [m/s]
    real(wp) :: speed = 0
    !> Kinds of shape and colours that they have, and the first and last body of each, shape (4, any)
    integer, allocatable :: looks(:, :)
    !> Hash of the files that a deck names, and of bodies made of them: a mix of all, the same on all ranks
    integer(i8) :: digest = 0
  contains
    procedure :: note => census_note
    procedure :: note_body => census_note_body
    procedure :: note_look => census_note_look
    procedure :: mix => census_mix
  end type census_t

contains

  !> Note a grain.
  pure subroutine census_note(self, centre, reach)
    class(census_t), intent(inout) :: self
    real(wp), intent(in) :: centre(:) !! [m], shape (dimension)
    real(wp), intent(in) :: reach !! radius of the circle or sphere about it [m]

    self%n = self%n + 1
    ! Points have no extent.
    if (reach > 0) self%smallest = min(self%smallest, reach)
    self%low(:size(centre)) = min(self%low(:size(centre)), centre)
    self%high(:size(centre)) = max(self%high(:size(centre)), centre)
  end subroutine census_note

  !> Note a body with its shapes.
  pure subroutine census_note_body(self, number, centre, speed, contactors, first)
    class(census_t), intent(inout) :: self
    integer, intent(in) :: number !! of the body
    real(wp), intent(in) :: centre(:) !! [m], shape (dimension)
    real(wp), intent(in) :: speed !! at the start [m/s]
    type(contactors_t), intent(in) :: contactors !! its shapes are the last ones
    integer, intent(in) :: first !! the first of its shapes
    integer :: c

    call self%note(centre, minval(contactors%reach(first:contactors%n)))
    do c = first, contactors%n
      call self%note_look(contactors%kind(c), contactors%colour(c), [number, number], speed)
    end do
  end subroutine census_note_body

  !> Note what one body or several have in common.
  pure subroutine census_note_look(self, kind, colour, numbers, speed)
    class(census_t), intent(inout) :: self
    integer, intent(in) :: kind !! kind of shape
    integer, intent(in) :: colour !! index of the colour
    integer, intent(in) :: numbers(2) !! of the first and the last body
    real(wp), intent(in) :: speed !! at the start [m/s]
    integer, allocatable :: more(:, :)
    integer :: i

    self%speed = max(self%speed, speed)
    if (.not. allocated(self%looks)) allocate (self%looks(4, 0))
    do i = 1, size(self%looks, 2)
      if (any(self%looks(:2, i) /= [kind, colour])) cycle
      self%looks(3, i) = min(self%looks(3, i), numbers(1))
      self%looks(4, i) = max(self%looks(4, i), numbers(2))
      return
    end do
    allocate (more(4, i))
    more(:, :i - 1) = self%looks
    more(:, i) = [kind, colour, numbers]
    call move_alloc(more, self%looks)
  end subroutine census_note_look

  !> Mix a word into the hash of files.
  pure subroutine census_mix(self, word)
    class(census_t), intent(inout) :: self
    integer(i8), intent(in) :: word !! any bits

    self%digest = ieor(ishftc(self%digest, 5), word)
  end subroutine census_mix
end module sg_census
