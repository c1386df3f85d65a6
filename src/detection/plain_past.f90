!> What loops over plain arrays put into a contact: whose it is, and what it takes over from the last detection, where that is no
!! more than impulse and status.
module sg_plain_past
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: status_new
  implicit none
  private
  public :: find_named, find_past, put_names, recall_impulse

contains

  !> Contacts of the past of a pair: the first and the last, which comes before it where there is none.
  pure subroutine find_past(p, is_matched, past, first_before, range)
    integer, intent(in) :: p !! pair
    logical, intent(in) :: is_matched !! is the past pair of each present one listed? Else both have one number
    integer(i4), intent(in) :: past(*) !! past pair of each present one, 0 for none
    integer(i4), intent(in) :: first_before(*) !! first contact of each past pair
    integer, intent(out) :: range(2)
    integer :: before

    before = p
    if (is_matched) before = past(p)
    range = [1, 0]
    if (before == 0) return
    range(1) = first_before(before)
    range(2) = first_before(before + 1) - 1
  end subroutine find_past

  !> Contact of a past pair that has a feature, 0 for none.
  pure integer function find_named(feature, range, feature_before) result(before)
    integer(i4), intent(in) :: feature !! the feature
    integer, intent(in) :: range(2) !! contacts of the past pair (`find_past`)
    integer(i4), intent(in) :: feature_before(*) !! features of past contacts
    integer :: k

    before = 0
    do k = range(1), range(2)
      if (feature_before(k) == feature) before = k
    end do
  end function find_named

  !> Name the two of a contact, contactors and bodies; the image and the law of their pair are its own.
  pure subroutine put_names(c, a, body_of, pair_image, pair_law, contactor, body, image, law)
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    integer(i4), intent(in) :: body_of(*) !! body of each contactor
    integer(i1), intent(in) :: pair_image !! periods in x by which the antagonist is moved
    integer, intent(in) :: pair_law !! law of the pair
    integer(i4), intent(inout) :: contactor(2) !! contactors of the contact
    integer(i4), intent(inout) :: body(2) !! its bodies
    integer(i1), intent(inout) :: image !! its image
    integer(i4), intent(inout) :: law !! its law

    contactor(1) = c
    contactor(2) = a
    body(1) = body_of(c)
    body(2) = body_of(a)
    image = pair_image
    law = int(pair_law, i4)
  end subroutine put_names

  !> Impulse and status of a contact from its past. Components are asked for one by one: of a number that is not known the compiler
  !! makes a loop.
  pure subroutine recall_impulse(before, n, impulse_before, status_before, impulse, status)
    integer, intent(in) :: before !! contact of the past, 0 for a new one
    integer, intent(in) :: n !! components, three at most
    real(wp), intent(in) :: impulse_before(n, *) !! impulses of past contacts [N s]
    integer(i1), intent(in) :: status_before(*) !! what they did
    real(wp), intent(inout) :: impulse(n) !! of the contact [N s]
    integer(i1), intent(inout) :: status !! what it did

    if (before == 0) then
      impulse = 0
      status = status_new
      return
    end if
    impulse(1) = impulse_before(1, before)
    if (n > 1) impulse(2) = impulse_before(2, before)
    if (n > 2) impulse(3) = impulse_before(3, before)
    status = status_before(before)
  end subroutine recall_impulse
end module sg_plain_past
