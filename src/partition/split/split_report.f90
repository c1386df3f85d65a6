!> What a split is worth: sizes of the parts, imbalance, what a primal split cuts and what a dual split shares.
!!
!! Primal: contacts between grains of two parts are the interface, a subdomain of their own. Dual: each contact belongs to one
!! part (`contact_owner`), which holds copies of grains whose owner is another one (doc/theory/partition.md).
module sg_split_report
  use sg_ascending, only: distinct
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp, i4, i8
  use sg_owners, only: contact_owner
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
    allocate (report%part_grains(parts), report%part_inner(parts), report%part_owned(parts), report%part_held(parts), &
              report%part_neighbours(parts), source=0)
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

  !> Count contacts, the copies that they ask for, and the neighbours that they make.
  pure subroutine look_at_contacts(contacts, part, parts, report)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: part(:)
    integer, intent(in) :: parts
    type(split_report_t), intent(inout) :: report
    integer(i8), allocatable :: copies(:), joined(:)
    logical :: is_cut(size(part))
    integer :: k, side, owner, n

    allocate (copies(contacts%n), joined(2*contacts%n))
    is_cut = .false.
    n = 0
    do k = 1, contacts%n
      associate (body => contacts%body(:, k), body_owner => part(contacts%body(:, k)) - 1)
        owner = contact_owner(body_owner) + 1
        report%part_owned(owner) = report%part_owned(owner) + 1
        if (any(body_owner < 0)) then
          report%wall_contacts = report%wall_contacts + 1
        else
          report%contacts = report%contacts + 1
        end if
        if (any(body_owner < 0) .or. body_owner(1) == body_owner(2)) then
          report%part_inner(owner) = report%part_inner(owner) + 1
          cycle
        end if
        is_cut(body) = .true.
        n = n + 1
        side = merge(2, 1, body_owner(1) + 1 == owner)
        copies(n) = int(body(side), i8)*int(parts, i8) + int(owner - 1, i8)
        joined(2*n - 1:2*n) = int(body_owner, i8)*int(parts, i8) + int(body_owner([2, 1]), i8)
      end associate
    end do
    report%cut_contacts = n
    report%interface_grains = count(is_cut)
    call count_copies(distinct(copies(:n)), parts, report)
    joined = distinct(joined(:2*n))
    do k = 1, size(joined)
      n = int(joined(k)/int(parts, i8)) + 1
      report%part_neighbours(n) = report%part_neighbours(n) + 1
    end do
  end subroutine look_at_contacts

  !> Grains that parts hold, and by how many parts grains are held; `copies` are body and part as one number, ascending.
  pure subroutine count_copies(copies, parts, report)
    integer(i8), intent(in) :: copies(:)
    integer, intent(in) :: parts
    type(split_report_t), intent(inout) :: report
    integer, allocatable :: held_by(:)
    integer(i8) :: body
    integer :: i, m, p

    allocate (held_by(parts), source=0)
    report%part_held = report%part_grains
    held_by(1) = report%grains
    body = 0
    m = 1
    do i = 1, size(copies)
      p = int(modulo(copies(i), int(parts, i8))) + 1
      report%part_held(p) = report%part_held(p) + 1
      if (copies(i)/int(parts, i8) /= body) m = 1
      body = copies(i)/int(parts, i8)
      held_by(m) = held_by(m) - 1
      m = m + 1
      held_by(m) = held_by(m) + 1
    end do
    do m = parts, 2, -1
      if (held_by(m) > 0) exit
    end do
    report%multiplicity = held_by(:max(1, m))
  end subroutine count_copies

  !> Largest of some loads over their mean; 1 where there are none.
  pure real(wp) function over_mean(loads) result(ratio)
    real(wp), intent(in) :: loads(:)

    ratio = 1
    if (sum(loads) > 0) ratio = maxval(loads)*real(size(loads), wp)/sum(loads)
  end function over_mean
end module sg_split_report
