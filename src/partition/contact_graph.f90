!> The contact graph: grains are vertices, pairs of grains in contact are edges.
!!
!! Walls are no vertices: every part has its own copy of them. Their contacts count in the weight of the grain.
!! Weights are costs of a sweep in half contacts: a contact of two grains costs each of them one half, a contact with
!! a wall costs the grain a whole one; one half more stands for the motion of the grain itself (doc/theory/partition.md).
module sg_contact_graph
  use sg_contacts, only: contacts_t
  use sg_kinds, only: i4
  implicit none
  private
  public :: contact_graph_t, build_contact_graph

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
    !> Contacts between the two grains, for each entry of `neighbour`
    integer(i4), allocatable :: multiplicity(:)
  end type contact_graph_t

contains

  !> Build the graph in linear time.
  pure subroutine build_contact_graph(contacts, is_grain, graph)
    type(contacts_t), intent(in) :: contacts !! contacts of a step
    logical, intent(in) :: is_grain(:) !! is a body a grain?, shape (bodies)
    type(contact_graph_t), intent(out) :: graph !! their graph
    integer(i4), allocatable :: vertex(:)
    integer :: b

    graph%n = count(is_grain)
    graph%body = pack([(int(b, i4), b=1, size(is_grain))], is_grain)
    allocate (vertex(size(is_grain)), source=0_i4)
    vertex(graph%body) = [(int(b, i4), b=1, graph%n)]
    call weigh(contacts, vertex, graph)
    call fill_rows(contacts, vertex, graph)
    call merge_repeated(graph)
  end subroutine build_contact_graph

  !> Weight of each vertex, and the number of entries of each row in `first`.
  pure subroutine weigh(contacts, vertex, graph)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: vertex(:)
    type(contact_graph_t), intent(inout) :: graph
    integer :: k, side, v

    allocate (graph%weight(graph%n), source=1_i4)
    allocate (graph%first(graph%n + 1), source=0_i4)
    do k = 1, contacts%n
      associate (ends => vertex(contacts%body(:, k)))
        do side = 1, 2
          v = ends(side)
          if (v == 0) cycle
          graph%weight(v) = graph%weight(v) + merge(1_i4, 2_i4, all(ends > 0))
          if (all(ends > 0)) graph%first(v) = graph%first(v) + 1
        end do
      end associate
    end do
  end subroutine weigh

  !> Rows of the graph, one entry a contact; `first` comes with their lengths.
  pure subroutine fill_rows(contacts, vertex, graph)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: vertex(:)
    type(contact_graph_t), intent(inout) :: graph
    integer :: k, v, next, side

    next = 1
    do v = 1, graph%n
      next = next + graph%first(v)
      graph%first(v) = int(next, i4)
    end do
    graph%first(graph%n + 1) = int(next, i4)
    allocate (graph%neighbour(next - 1), graph%multiplicity(next - 1), source=1_i4)
    ! `first` stands at the ends of the rows and walks back to their beginnings.
    do k = contacts%n, 1, -1
      associate (ends => vertex(contacts%body(:, k)))
        if (any(ends == 0)) cycle
        do side = 1, 2
          v = ends(side)
          graph%first(v) = graph%first(v) - 1
          graph%neighbour(graph%first(v)) = ends(3 - side)
        end do
      end associate
    end do
  end subroutine fill_rows

  !> Make one entry of the contacts of a pair, with their number.
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
            graph%multiplicity(place(other)) = graph%multiplicity(place(other)) + 1_i4
            cycle
          end if
          kept = kept + 1
          place(other) = int(kept, i4)
          graph%neighbour(kept) = other
          graph%multiplicity(kept) = 1
        end associate
      end do
      graph%first(v) = int(begin, i4)
    end do
    graph%first(graph%n + 1) = int(kept, i4) + 1
    graph%neighbour = graph%neighbour(:kept)
    graph%multiplicity = graph%multiplicity(:kept)
  end subroutine merge_repeated
end module sg_contact_graph
