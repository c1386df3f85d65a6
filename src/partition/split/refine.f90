!> Improve a split of a graph that is there already: single vertices move to a neighbouring part, few in all.
!!
!! A vertex moves where that cuts less weight and the other part has room for it, or away from a part that has too much to
!! one that has less. The loads' squares fall with the latter moves and the cut with the former (after
!! [FiducciaMattheyses1982], without moves uphill).
module sg_refine
  use sg_contact_graph, only: contact_graph_t
  use sg_kinds, only: wp, i4, i8
  implicit none
  private
  public :: refine_split, cut_weight, largest_share

  !> Passes over all vertices at most; each passes load on from part to part
  integer, parameter :: most_passes = 100

contains

  !> Move vertices until no move helps.
  pure subroutine refine_split(graph, parts, imbalance, part)
    type(contact_graph_t), intent(in) :: graph !! vertices and edges
    integer, intent(in) :: parts !! number of parts
    real(wp), intent(in) :: imbalance !! largest weight of a part over the mean one that is aimed at
    integer(i4), intent(inout) :: part(:) !! part of each vertex, from 1
    real(wp) :: load(parts), limit
    integer :: v, to, pass, moved

    load = loads_of(graph, parts, part)
    limit = imbalance*sum(load)/real(parts, wp)
    do pass = 1, most_passes
      moved = 0
      do v = 1, graph%n
        to = better_part(graph, load, limit, part, v)
        if (to == part(v)) cycle
        load(part(v)) = load(part(v)) - real(graph%weight(v), wp)
        load(to) = load(to) + real(graph%weight(v), wp)
        part(v) = int(to, i4)
        moved = moved + 1
      end do
      if (moved == 0) return
    end do
  end subroutine refine_split

  !> The best part for a vertex: one of those of its neighbours, or its own.
  pure integer function better_part(graph, load, limit, part, v) result(best)
    type(contact_graph_t), intent(in) :: graph
    real(wp), intent(in) :: load(:), limit
    integer(i4), intent(in) :: part(:)
    integer, intent(in) :: v
    integer(i8) :: gain, best_gain
    integer :: e, to

    best = part(v)
    best_gain = -huge(best_gain)
    do e = graph%first(v), graph%first(v + 1) - 1
      to = part(graph%neighbour(e))
      if (to == part(v)) cycle
      associate (heavier => load(to) + real(graph%weight(v), wp))
        gain = weight_to(graph, part, v, to) - weight_to(graph, part, v, int(part(v)))
        if (gain <= best_gain) cycle
        if (gain > 0 .and. heavier <= limit .or. load(part(v)) > limit .and. heavier < load(part(v))) then
          best = to
          best_gain = gain
        end if
      end associate
    end do
  end function better_part

  !> Weight of the edges from a vertex to a part.
  pure integer(i8) function weight_to(graph, part, v, to) result(weight)
    type(contact_graph_t), intent(in) :: graph
    integer(i4), intent(in) :: part(:)
    integer, intent(in) :: v, to
    integer :: e

    weight = 0
    do e = graph%first(v), graph%first(v + 1) - 1
      if (part(graph%neighbour(e)) == to) weight = weight + int(graph%edge_weight(e), i8)
    end do
  end function weight_to

  !> Weight of all edges between different parts.
  pure integer(i8) function cut_weight(graph, part) result(weight)
    type(contact_graph_t), intent(in) :: graph !! vertices and edges
    integer(i4), intent(in) :: part(:) !! part of each vertex
    integer :: v, e

    weight = 0
    do v = 1, graph%n
      do e = graph%first(v), graph%first(v + 1) - 1
        if (part(graph%neighbour(e)) > part(v)) weight = weight + int(graph%edge_weight(e), i8)
      end do
    end do
  end function cut_weight

  !> Largest weight of a part over the mean one.
  pure real(wp) function largest_share(graph, parts, part) result(share)
    type(contact_graph_t), intent(in) :: graph !! vertices and edges
    integer, intent(in) :: parts !! number of parts
    integer(i4), intent(in) :: part(:) !! part of each vertex, from 1
    real(wp) :: load(parts)

    load = loads_of(graph, parts, part)
    share = 1
    if (sum(load) > 0) share = maxval(load)*real(parts, wp)/sum(load)
  end function largest_share

  !> Weight of each part.
  pure function loads_of(graph, parts, part) result(load)
    type(contact_graph_t), intent(in) :: graph
    integer, intent(in) :: parts
    integer(i4), intent(in) :: part(:)
    real(wp) :: load(parts)
    integer :: v

    load = 0
    do v = 1, graph%n
      load(part(v)) = load(part(v)) + real(graph%weight(v), wp)
    end do
  end function loads_of
end module sg_refine
