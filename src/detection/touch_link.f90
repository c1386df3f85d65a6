!> Narrow phase of a link: the line between its two points, at any distance (doc/theory/links.md).
module sg_touch_link
  use sg_kinds, only: wp
  implicit none
  private
  public :: touch_link

contains

  !> Normal, point and length of the contact of a link.
  !!
  !! The normal points from the antagonist to the candidate; where the law can only pull it is turned round. A link of no length,
  !! which holds two points together, has a normal that does not turn: along y.
  pure subroutine touch_link(candidate, antagonist, rest, pulls_only, normal, point, length)
    real(wp), intent(in) :: candidate(:) !! point of the candidate [m], shape (dimension)
    real(wp), intent(in) :: antagonist(:) !! point of the antagonist [m], shape (dimension)
    real(wp), intent(in) :: rest !! length at rest [m]
    logical, intent(in) :: pulls_only !! is it a wire?
    real(wp), intent(out) :: normal(:) !! unit normal, shape (dimension)
    real(wp), intent(out) :: point(:) !! midway between the two points [m], shape (dimension)
    real(wp), intent(out) :: length !! distance of the two points [m]; zero where the link has no length at rest
    real(wp) :: between(size(candidate))

    between = candidate - antagonist
    point = antagonist + between/2
    length = norm2(between)
    normal = 0
    normal(2) = 1
    if (.not. rest > 0) then
      length = 0
    else if (length > tiny(length)) then
      normal = between/length
    end if
    if (pulls_only) normal = -normal
  end subroutine touch_link
end module sg_touch_link
