!> What a rank knows of the grains that it does not keep while a deck is read: each rank goes through all of them, so that all
!! come to the same defaults and the same warnings without a message.
module sg_census
  use sg_kinds, only: wp
  implicit none
  private
  public :: census_t

  !> Grains of samples that other ranks keep
  type :: census_t
    !> How many
    integer :: n = 0
    !> Smallest radius of a circle or sphere about one [m]
    real(wp) :: smallest = huge(1.0_wp)
    !> Least and largest coordinates of their centres [m]
    real(wp) :: low(3) = huge(1.0_wp), high(3) = -huge(1.0_wp)
    !> Largest speed at the start [m/s]
    real(wp) :: speed = 0
    !> Kinds of shape and colours that they have, shape (2, any)
    integer, allocatable :: looks(:, :)
  contains
    procedure :: note => census_note
    procedure :: note_look => census_note_look
  end type census_t

contains

  !> Note a grain.
  pure subroutine census_note(self, centre, reach)
    class(census_t), intent(inout) :: self
    real(wp), intent(in) :: centre(:) !! [m], shape (dimension)
    real(wp), intent(in) :: reach !! radius of the circle or sphere about it [m]

    self%n = self%n + 1
    self%smallest = min(self%smallest, reach)
    self%low(:size(centre)) = min(self%low(:size(centre)), centre)
    self%high(:size(centre)) = max(self%high(:size(centre)), centre)
  end subroutine census_note

  !> Note what grains of one sample have in common.
  pure subroutine census_note_look(self, kind, colour, speed)
    class(census_t), intent(inout) :: self
    integer, intent(in) :: kind !! kind of shape
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: speed !! at the start [m/s]
    integer, allocatable :: more(:, :)
    integer :: n

    n = 0
    if (allocated(self%looks)) n = size(self%looks, 2)
    allocate (more(2, n + 1))
    if (n > 0) more(:, :n) = self%looks
    more(:, n + 1) = [kind, colour]
    call move_alloc(more, self%looks)
    self%speed = max(self%speed, speed)
  end subroutine census_note_look
end module sg_census
