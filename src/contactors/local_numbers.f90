!> Numbers in the whole scene and in the part of one rank: bodies and contactors, in logarithmic time.
!!
!! In a scene that is not decomposed both numbers are the same.
module sg_local_numbers
  use sg_ascending, only: place_in
  use sg_bodies, only: bodies_t
  use sg_contactors, only: contactors_t
  use sg_kinds, only: i4
  use sg_sorting, only: group_items
  implicit none
  private
  public :: local_body, local_contactor, contactors_of_bodies

contains

  !> Body here that has a number in the whole scene; 0 when it is not here.
  pure integer function local_body(bodies, number) result(body)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank
    integer(i4), intent(in) :: number !! in the whole scene

    if (.not. allocated(bodies%id)) then
      body = merge(number, 0, number >= 1 .and. number <= bodies%n)
      return
    end if
    body = place_in(bodies%id(:bodies%n_own), number)
    if (body > 0) return
    body = place_in(bodies%id(bodies%n_own + 1:bodies%n), number)
    if (body > 0) body = bodies%n_own + body
  end function local_body

  !> Contactor here that has a number in the whole scene; 0 when it is not here.
  pure integer function local_contactor(contactors, number) result(contactor)
    type(contactors_t), intent(in) :: contactors !! contactors of this rank
    integer(i4), intent(in) :: number !! in the whole scene

    if (allocated(contactors%id)) then
      contactor = place_in(contactors%id(:contactors%n), number)
    else
      contactor = merge(number, 0, number >= 1 .and. number <= contactors%n)
    end if
  end function local_contactor

  !> Contactors grouped by body: those of body b are `list(first(b):first(b + 1) - 1)`, in their own order.
  pure subroutine contactors_of_bodies(contactors, n_bodies, first, list)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: n_bodies !! number of bodies
    integer(i4), allocatable, intent(out) :: first(:) !! shape (n_bodies + 1)
    integer(i4), allocatable, intent(out) :: list(:) !! shape (contactors)
    integer :: c

    call group_items([(contactors%body(c), c=1, contactors%n)], n_bodies, first, list)
  end subroutine contactors_of_bodies
end module sg_local_numbers
