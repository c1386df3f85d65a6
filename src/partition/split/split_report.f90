!> What a split is worth: sizes of the parts, imbalance, what a primal split cuts and what a dual split shares.
!!
!! Primal: contacts between grains of two parts are the interface, a subdomain of their own. Dual: each contact belongs to one
!! part (`contact_owner`), which holds copies of grains whose owner is another one (doc/theory/partition.md).
module sg_split_report
  use sg_contacts, only: contacts_t
  use sg_interfaces, only: find_interfaces, interfaces_t
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: split_report_t, report_split

  !> Figures of a split
  type :: split_report_t
    !> Method, and boxes along x, y and z; zero for another method than boxes
    character(len=:), allocatable :: method
    integer :: boxes(3) = 0
    !> Grains, contacts between two of them, and contacts with walls
    integer :: grains = 0, contacts = 0, wall_contacts = 0
    !> Grains of each part, and what they cost [half contacts], shape (parts)
    integer, allocatable :: part_grains(:)
    real(wp), allocatable :: part_load(:)
    !> Primal: contacts within each part, those with walls among them, shape (parts)
    integer, allocatable :: part_inner(:)
    !> Dual: contacts that each part owns, and grains that it holds, its own and copies, shape (parts)
    integer, allocatable :: part_owned(:), part_held(:)
    !> Parts that each part has contacts with, shape (parts)
    integer, allocatable :: part_neighbours(:)
    !> Largest load of a part over the mean one; and the same of contacts owned
    real(wp) :: imbalance = 1, contact_imbalance = 1
    !> Primal: contacts between grains of different parts, and grains with such a contact
    integer :: cut_contacts = 0, interface_grains = 0
    !> Dual: grains by the number of parts that hold them, from 1
    integer, allocatable :: multiplicity(:)
    !> What the parts own and share
    type(interfaces_t) :: interfaces
  end type split_report_t

contains

  !> Look at a split.
  pure function report_split(contacts, part, load, parts) result(report)
    type(contacts_t), intent(in) :: contacts !! contacts of a step
    integer(i4), intent(in) :: part(:) !! part of each body, from 1; 0 for walls, shape (bodies)
    real(wp), intent(in) :: load(:) !! what each body costs [half contacts], shape (bodies)
    integer, intent(in) :: parts !! number of parts
    type(split_report_t) :: report
    integer :: b

    report%grains = count(part > 0)
    allocate (report%part_grains(parts), report%part_neighbours(parts), source=0)
    allocate (report%part_load(parts), source=0.0_wp)
    do b = 1, size(part)
      if (part(b) == 0) cycle
      report%part_grains(part(b)) = report%part_grains(part(b)) + 1
      report%part_load(part(b)) = report%part_load(part(b)) + load(b)
    end do
    call look_at_contacts(contacts, part, parts, report)
    report%imbalance = over_mean(report%part_load)
    report%contact_imbalance = over_mean(real(report%part_owned, wp))
  end function report_split

  !> Count contacts, the copies that they need, and neighbours.
  pure subroutine look_at_contacts(contacts, part, parts, report)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: part(:)
    integer, intent(in) :: parts
    type(split_report_t), intent(inout) :: report
    integer(i4), allocatable :: owner(:)
    logical :: is_cut(size(part))
    integer :: k, m

    call find_interfaces(contacts, part, parts, owner, report%interfaces)
    associate (found => report%interfaces)
      report%part_owned = found%owned
      report%part_inner = found%inner
      report%part_held = report%part_grains + found%borrowed
      report%cut_contacts = size(found%cut)
      report%wall_contacts = count([(any(part(contacts%body(:, k)) == 0), k=1, contacts%n)])
      report%contacts = contacts%n - report%wall_contacts
      is_cut = .false.
      do k = 1, size(found%cut)
        is_cut(contacts%body(:, found%cut(k))) = .true.
      end do
      report%interface_grains = count(is_cut)
      do k = 1, size(found%edge%items)
        associate (ends => found%edge%part(:, k) + 1)
          report%part_neighbours(ends) = report%part_neighbours(ends) + 1
        end associate
      end do
      report%multiplicity = [(count(part > 0 .and. found%copies == m - 1), m=1, 1 + maxval([0, pack(found%copies, part > 0)]))]
    end associate
  end subroutine look_at_contacts

  !> Largest of some loads over their mean; 1 where there are none.
  pure real(wp) function over_mean(loads) result(ratio)
    real(wp), intent(in) :: loads(:)

    ratio = 1
    if (sum(loads) > 0) ratio = maxval(loads)*real(size(loads), wp)/sum(loads)
  end function over_mean
end module sg_split_report
