!> Splitting of the contact graph, without naming a library.
!!
!! The bodies live in `graph_split_with_metis` or `graph_split_without_metis`, chosen by CMake.
module sg_graph_split
  use sg_contact_graph, only: contact_graph_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: graph_splits, split_graph

  interface
    !> Was the program built with a library that splits graphs?
    module function graph_splits() result(is_available)
      logical :: is_available
    end function graph_splits

    !> Split the graph so that few contacts join different parts.
    module subroutine split_graph(graph, parts, imbalance, part, error)
      type(contact_graph_t), intent(in) :: graph !! grains and their contacts
      integer, intent(in) :: parts !! number of parts
      real(wp), intent(in) :: imbalance !! largest weight of a part over the mean one, above 1
      integer(i4), allocatable, intent(out) :: part(:) !! part of each vertex, from 1
      type(error_t), allocatable, intent(out) :: error !! set when it cannot be split
    end subroutine split_graph
  end interface
end module sg_graph_split
