!> Links between points: rods, wires and bonds that a scene holds from its start on (doc/theory/links.md).
!!
!! Links are no product of the search for neighbours: each stands between two point contactors, whatever their distance. Where
!! ranks share a scene every rank keeps the whole list, in one order; `contactor` shows which ends are here.
module sg_links
  use sg_contactors, only: contactors_t
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_local_numbers, only: local_contactor
  implicit none
  private
  public :: links_t, add_link, locate_links, link_image, link_between

  !> All links of a scene
  type :: links_t
    !> Number of links
    integer :: n = 0
    !> Point contactors, candidate and antagonist, by their numbers in the whole scene, shape (2, n)
    integer(i4), allocatable :: number(:, :)
    !> The same by their numbers here, 0 where the contactor is not here, shape (2, n); set by `locate_links`
    integer(i4), allocatable :: contactor(:, :)
    !> Law, index into the scene's laws, shape (n)
    integer(i4), allocatable :: law(:)
    !> Periods in x and y by which the antagonist is moved, counted from where both would be had they never come back into the
    !! period, shape (2, n)
    integer(i4), allocatable :: image(:, :)
    !> Length at rest [m], shape (n)
    real(wp), allocatable :: length(:)
    !> Cross section [m2] and mass [kg] of bonds; zero for other laws, shape (n)
    real(wp), allocatable :: area(:), mass(:)
  end type links_t

contains

  !> Add a link; the contactor with the higher number becomes the candidate.
  subroutine add_link(links, number, image, law, length, area, mass)
    type(links_t), intent(inout) :: links !! list to add to
    integer, intent(in) :: number(2) !! contactors, by their numbers in the whole scene
    integer, intent(in) :: image(2) !! periods in x and y by which the second is moved
    integer, intent(in) :: law !! index into the scene's laws
    real(wp), intent(in) :: length !! at rest [m]
    real(wp), intent(in) :: area !! cross section of a bond [m2]
    real(wp), intent(in) :: mass !! mass of a bond [kg]
    integer :: n

    n = links%n + 1
    links%n = n
    call reserve(links%number, 2, n)
    call reserve(links%contactor, 2, n)
    call reserve(links%image, 2, n)
    call reserve(links%law, n)
    call reserve(links%length, n)
    call reserve(links%area, n)
    call reserve(links%mass, n)
    links%number(:, n) = int(merge(number, number([2, 1]), number(1) > number(2)), i4)
    links%image(:, n) = int(merge(image, -image, number(1) > number(2)), i4)
    links%law(n) = int(law, i4)
    links%length(n) = length
    links%area(n) = area
    links%mass(n) = mass
  end subroutine add_link

  !> Find the ends of all links among the contactors that are here.
  subroutine locate_links(links, contactors)
    type(links_t), intent(inout) :: links !! links; `contactor` is set
    type(contactors_t), intent(in) :: contactors !! contactors of this rank, or of the whole scene
    integer :: l, side

    do l = 1, links%n
      do side = 1, 2
        links%contactor(side, l) = int(local_contactor(contactors, links%number(side, l)), i4)
      end do
    end do
  end subroutine locate_links

  !> Periods in x and y by which the antagonist of a link is to be moved now.
  pure function link_image(links, l, crossings) result(image)
    type(links_t), intent(in) :: links !! all links
    integer, intent(in) :: l !! the link
    integer(i4), intent(in) :: crossings(2, 2) !! periods in x and y that candidate and antagonist have crossed, shape (axis, side)
    integer(i4) :: image(2)

    image = links%image(:, l) + crossings(:, 2) - crossings(:, 1)
  end function link_image

  !> The link between two contactors, by their numbers in the whole scene; 0 where there is none.
  pure integer function link_between(links, pair) result(l)
    type(links_t), intent(in) :: links !! all links
    integer, intent(in) :: pair(2) !! two contactors, in any order

    do l = 1, links%n
      if (all(links%number(:, l) == pair) .or. all(links%number(:, l) == pair([2, 1]))) return
    end do
    l = 0
  end function link_between
end module sg_links
