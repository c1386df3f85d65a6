!> Values that a solver's method carries of the copies of a rank, while these copies are replaced (doc/theory/decomposition.md).
!!
!! They belong to a copy, such as its part of F_Gamma, and differ between the copies of a body. A rank that held the body before
!! goes on with its own values; a new owner without them has those of the former owner, sent with the body; other new copies start
!! at zero.
module sg_carried_copies
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: local_body
  implicit none
  private
  public :: carried_copies_t

  !> Values of the bodies that a rank held
  type :: carried_copies_t
    !> Numbers of the bodies in the whole scene, and values, shape (n_carried, bodies)
    integer(i4), allocatable, private :: id(:)
    real(wp), allocatable, private :: value(:, :)
  contains
    procedure :: take => carried_take
    procedure :: give => carried_give
  end type carried_copies_t

contains

  !> Keep the values of all bodies of this rank; nothing where no method carries any.
  pure subroutine carried_take(self, bodies)
    class(carried_copies_t), intent(inout) :: self
    type(bodies_t), intent(in) :: bodies !! own bodies and copies

    if (bodies%n_carried == 0) return
    self%id = bodies%id
    self%value = bodies%carried
  end subroutine carried_take

  !> Put them back where the rank still holds the body.
  pure subroutine carried_give(self, bodies)
    class(carried_copies_t), intent(in) :: self
    type(bodies_t), intent(inout) :: bodies !! own bodies and copies, rebuilt
    integer :: i, b

    if (bodies%n_carried == 0) return
    do i = 1, size(self%id)
      b = local_body(bodies, self%id(i))
      if (b > 0) bodies%carried(:, b) = self%value(:, i)
    end do
  end subroutine carried_give
end module sg_carried_copies
