!> What a split is worth: sizes of the parts, imbalance, what is cut, and how many parts share a grain.
module sg_split_report
  use sg_contact_graph, only: contact_graph_t
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: split_report_t, report_split

  !> Figures of a split (doc/theory/partition.md)
  type :: split_report_t
    !> Method, and boxes along x and y; zero for another method than boxes
    character(len=:), allocatable :: method
    integer :: boxes(2) = 0
    !> Grains, and contacts between two of them
    integer :: grains = 0, contacts = 0
    !> Grains of each part, its weight [half contacts], and its grains on the interface, shape (parts)
    integer, allocatable :: part_grains(:), part_weight(:), part_interface(:)
    !> Largest weight of a part over the mean one
    real(wp) :: imbalance = 1
    !> Contacts between grains of different parts
    integer :: cut_contacts = 0
    !> Grains with a cut contact
    integer :: interface_grains = 0
    !> Grains by the number of parts that know them, their own and those of the grains they touch; from 1
    integer, allocatable :: multiplicity(:)
  end type split_report_t

contains

  !> Look at a split.
  pure function report_split(graph, part, parts) result(report)
    type(contact_graph_t), intent(in) :: graph !! grains and their contacts
    integer(i4), intent(in) :: part(:) !! part of each vertex, from 1
    integer, intent(in) :: parts !! number of parts
    type(split_report_t) :: report
    integer, allocatable :: seen_by(:)
    integer :: v, e, known, cut

    report%grains = graph%n
    report%contacts = sum(graph%multiplicity)/2
    allocate (report%part_grains(parts), report%part_weight(parts), report%part_interface(parts), &
              report%multiplicity(parts), seen_by(parts), source=0)
    do v = 1, graph%n
      known = 1
      seen_by(part(v)) = v
      cut = 0
      do e = graph%first(v), graph%first(v + 1) - 1
        associate (other => part(graph%neighbour(e)))
          if (other /= part(v)) cut = cut + graph%multiplicity(e)
          if (seen_by(other) == v) cycle
          seen_by(other) = v
          known = known + 1
        end associate
      end do
      report%part_grains(part(v)) = report%part_grains(part(v)) + 1
      report%part_weight(part(v)) = report%part_weight(part(v)) + graph%weight(v)
      if (known > 1) report%part_interface(part(v)) = report%part_interface(part(v)) + 1
      report%multiplicity(known) = report%multiplicity(known) + 1
      report%cut_contacts = report%cut_contacts + cut
    end do
    report%cut_contacts = report%cut_contacts/2
    report%interface_grains = sum(report%part_interface)
    known = max(1, findloc_last(report%multiplicity))
    report%multiplicity = report%multiplicity(:known)
    if (graph%n > 0) report%imbalance = real(maxval(report%part_weight), wp)*real(parts, wp)/real(sum(report%part_weight), wp)
  end function report_split

  !> Place of the last entry that is not zero; 0 when there is none.
  pure integer function findloc_last(list) result(place)
    integer, intent(in) :: list(:)

    do place = size(list), 1, -1
      if (list(place) /= 0) return
    end do
  end function findloc_last
end module sg_split_report
