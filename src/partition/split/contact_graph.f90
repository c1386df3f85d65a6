!> The contact graph: grains are vertices, pairs of grains in contact are edges, as heavy as they have contacts.
!!
!! Walls are no vertices: every part has its own copy of them. Their contacts count in the weight of the grain (sg_load).
module sg_contact_graph
  use sg_contacts, only: contacts_t
  use sg_kinds, only: i4
  use sg_load, only: measured_weights
  implicit none
  private
  public :: contact_graph_t, build_contact_graph, graph_from_edges, contact_weight

  !> Weight of a contact in that of an edge; two neighbours along a curve through the grains, which may touch later, weigh 1
  integer(i4), parameter :: contact_weight = 8

  !> Grains and the pairs of them in contact, as compressed rows
  type :: contact_graph_t
    !> Number of vertices
    integer :: n = 0
    !> Body of each vertex, shape (n), ascending
    integer(i4), allocatable :: body(:)
    !> Weight of each vertex [half contacts], shape (n)
    integer(i4), allocatable :: weight(:)
    !> Neighbours of vertex v are `neighbour(first(v):first(v + 1) - 1)`; each edge stands in two rows
    integer(i4), allocatable :: first(:), neighbour(:)
    !> Weight of the edge, for each entry of `neighbour`
    integer(i4), allocatable :: edge_weight(:)
  end type contact_graph_t

contains

  !> Build the graph in linear time.
  pure subroutine build_contact_graph(contacts, is_grain, order, graph)
    type(contacts_t), intent(in) :: contacts !! contacts of a step
    logical, intent(in) :: is_grain(:) !! is a body a grain?, shape (bodies)
    integer(i4), intent(in) :: order(:) !! vertices along a curve through the grains: neighbours on it are joined; may be empty
    type(contact_graph_t), intent(out) :: graph !! their graph
    integer(i4), allocatable :: vertex(:), edges(:, :)
    integer :: b, k, n

    n = count(is_grain)
    graph%weight = pack(nint(measured_weights(contacts, is_grain, size(is_grain)), i4), is_grain)
    graph%body = pack([(int(b, i4), b=1, size(is_grain))], is_grain)
    allocate (vertex(size(is_grain)), source=0_i4)
    vertex(graph%body) = [(int(b, i4), b=1, n)]
    allocate (edges(3, contacts%n + size(order)), source=contact_weight)
    n = 0
    do k = 1, contacts%n
      associate (ends => vertex(contacts%body(:, k)))
        ! A grain may touch its own periodic image.
        if (any(ends == 0) .or. ends(1) == ends(2)) cycle
        n = n + 1
        edges(:2, n) = ends
      end associate
    end do
    do k = 2, size(order)
      n = n + 1
      edges(:, n) = [order(k - 1), order(k), 1_i4]
    end do
    call graph_from_edges(size(graph%body), edges(:, :n), graph)
  end subroutine build_contact_graph

  !> Set the rows of a graph from a list of edges, in which a pair may come several times.
  pure subroutine graph_from_edges(n, edges, graph)
    integer, intent(in) :: n !! number of vertices
    integer(i4), intent(in) :: edges(:, :) !! two vertices and the weight of their edge, shape (3, edges)
    type(contact_graph_t), intent(inout) :: graph !! its rows are set
    integer :: e, v, next, side

    graph%n = n
    allocate (graph%first(n + 1), source=0_i4)
    do e = 1, size(edges, 2)
      graph%first(edges(1, e)) = graph%first(edges(1, e)) + 1_i4
      graph%first(edges(2, e)) = graph%first(edges(2, e)) + 1_i4
    end do
    next = 1
    do v = 1, n
      next = next + graph%first(v)
      graph%first(v) = int(next, i4)
    end do
    graph%first(n + 1) = int(next, i4)
    allocate (graph%neighbour(next - 1), graph%edge_weight(next - 1))
    ! `first` stands at the ends of the rows and walks back to their beginnings.
    do e = size(edges, 2), 1, -1
      do side = 1, 2
        v = edges(side, e)
        graph%first(v) = graph%first(v) - 1
        graph%neighbour(graph%first(v)) = edges(3 - side, e)
        graph%edge_weight(graph%first(v)) = edges(3, e)
      end do
    end do
    call merge_repeated(graph)
  end subroutine graph_from_edges

  !> Make one entry of all edges of a pair, with their weight.
  pure subroutine merge_repeated(graph)
    type(contact_graph_t), intent(inout) :: graph
    integer(i4), allocatable :: place(:)
    integer :: v, e, begin, kept

    allocate (place(graph%n), source=0_i4)
    kept = 0
    do v = 1, graph%n
      begin = kept + 1
      do e = graph%first(v), graph%first(v + 1) - 1
        associate (other => graph%neighbour(e))
          if (place(other) >= begin) then
            graph%edge_weight(place(other)) = graph%edge_weight(place(other)) + graph%edge_weight(e)
            cycle
          end if
          kept = kept + 1
          place(other) = int(kept, i4)
          graph%neighbour(kept) = other
          graph%edge_weight(kept) = graph%edge_weight(e)
        end associate
      end do
      graph%first(v) = int(begin, i4)
    end do
    graph%first(graph%n + 1) = int(kept, i4) + 1
    graph%neighbour = graph%neighbour(:kept)
    graph%edge_weight = graph%edge_weight(:kept)
  end subroutine merge_repeated
end module sg_contact_graph
