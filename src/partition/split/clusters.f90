!> Splitting by a graph over many ranks: grains are grouped into clusters, and only the graph of clusters is gathered.
!!
!! Each rank groups its own grains along Hilbert's curve, at least a few dozen clusters a part (`make_clusters`). A rank
!! that holds the clusters of all bodies that its contacts touch, copies of others' grains among them, finds the edges that
!! these contacts make (`cluster_edges`). The graph of clusters, small enough for every rank, is gathered and split alike on all
!! of them; then parts are given to those ranks that have most of their weight already; or, where that does as well, the present
!! split is mended (`split_clusters`).
module sg_clusters
  use sg_comm, only: comm_t
  use sg_contact_graph, only: contact_graph_t, contact_weight, graph_from_edges
  use sg_contacts, only: contacts_t
  use sg_curve_order, only: curve_order
  use sg_error, only: error_t
  use sg_graph_split, only: split_graph
  use sg_kinds, only: wp, i4, i8
  use sg_refine, only: cut_weight, largest_share, refine_split
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: clusters_t, most_clusters, make_clusters, cluster_edges, split_clusters, keep_with_owner

  !> Clusters that any machine can gather and split in no time, and clusters a part where that makes more
  integer, parameter :: always = 20000, per_part = 63
  !> Cut of a split that is kept, over that of the one that METIS would make: moving grains has a price too
  real(wp), parameter :: worth_moving = 1.1_wp

  !> This rank's clusters
  type :: clusters_t
    !> Clusters of all ranks, and of those before this one
    integer :: all = 0, before = 0
    !> Cluster of each of this rank's grains, numbered over all ranks from 1, shape (grains)
    integer(i4), allocatable :: of_grain(:)
    !> Weight of each of this rank's clusters, shape (own clusters)
    real(wp), allocatable :: weight(:)
  end type clusters_t

contains

  !> Clusters of all ranks together for a number of parts.
  pure integer function most_clusters(parts)
    integer, intent(in) :: parts !! number of parts

    most_clusters = max(always, per_part*parts)
  end function most_clusters

  !> Group this rank's grains into clusters of equal numbers of them, single grains where there are no more. Collective.
  subroutine make_clusters(comm, position, weight, most, clusters)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: position(:, :) !! centres of this rank's grains [m], shape (dimension, n)
    real(wp), intent(in) :: weight(:) !! cost of each, a whole number, shape (n)
    integer, intent(in) :: most !! clusters of all ranks together at most, and one a rank that rounding up may add
    type(clusters_t), intent(out) :: clusters !! this rank's clusters
    integer(i4), allocatable :: order(:)
    integer(i8) :: before, all
    integer :: n, own, i, c, grains

    n = size(weight)
    call comm%before(int(n, i8), before, all)
    grains = max(1, int((all + int(most, i8) - 1)/int(most, i8)))
    own = 0
    if (n > 0) own = (n + grains - 1)/grains
    call comm%before(int(own, i8), before, all)
    clusters%all = int(all)
    clusters%before = int(before)
    allocate (clusters%of_grain(n), source=0_i4)
    allocate (clusters%weight(own), source=0.0_wp)
    order = curve_order(comm, position)
    do i = 1, n
      c = 1 + int(int(i - 1, i8)*int(own, i8)/int(n, i8))
      clusters%of_grain(order(i)) = int(clusters%before + c, i4)
      clusters%weight(c) = clusters%weight(c) + weight(order(i))
    end do
  end subroutine make_clusters

  !> Edges between clusters that a rank's contacts make, the lower cluster first.
  pure subroutine cluster_edges(contacts, cluster, edges)
    type(contacts_t), intent(in) :: contacts !! contacts that this rank owns
    integer(i4), intent(in) :: cluster(:) !! cluster of each local body, 0 for walls, shape (bodies)
    integer(i4), allocatable, intent(out) :: edges(:, :) !! two clusters and the contacts between them, shape (3, edges)
    integer(i8), allocatable :: key(:)
    integer(i4), allocatable :: order(:)
    integer :: k, n, i

    allocate (key(contacts%n))
    n = 0
    do k = 1, contacts%n
      associate (ends => cluster(contacts%body(:, k)))
        if (any(ends == 0) .or. ends(1) == ends(2)) cycle
        n = n + 1
        key(n) = ior(shiftl(int(minval(ends), i8), 31), int(maxval(ends), i8))
      end associate
    end do
    order = sort_permutation(key(:n))
    key(:n) = key(order)
    allocate (edges(3, n))
    k = 0
    do i = 1, n
      if (i > 1) then
        if (key(i) == key(i - 1)) then
          edges(3, k) = edges(3, k) + 1_i4
          cycle
        end if
      end if
      k = k + 1
      edges(:, k) = [int(shiftr(key(i), 31), i4), int(ibits(key(i), 0, 31), i4), 1_i4]
    end do
    edges = edges(:, :k)
  end subroutine cluster_edges

  !> Split the clusters of all ranks: the part of each of this rank's grains, from 1. Part p is meant for rank p - 1. Collective.
  subroutine split_clusters(comm, clusters, edges, parts, imbalance, part, error)
    type(comm_t), intent(inout) :: comm !! the ranks
    type(clusters_t), intent(in) :: clusters !! this rank's clusters
    integer(i4), intent(in) :: edges(:, :) !! edges that its contacts make, shape (3, edges)
    integer, intent(in) :: parts !! number of parts
    real(wp), intent(in) :: imbalance !! largest weight of a part over the mean one, above 1
    integer(i4), allocatable, intent(out) :: part(:) !! part of each grain, shape (grains)
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the graph cannot be split
    type(contact_graph_t) :: graph
    integer(i4), allocatable :: rank(:), cluster_part(:), kept(:)

    call gather_graph(comm, clusters, edges, graph, rank)
    call split_graph(graph, parts, imbalance, cluster_part, error)
    call comm%agree(error)
    if (allocated(error)) return
    if (comm%size > 1) then
      call keep_with_owner(rank, real(graph%weight, wp), parts, cluster_part)
      kept = min(rank, int(parts, i4) - 1_i4) + 1_i4
      call refine_split(graph, parts, imbalance, kept)
      if (is_good(kept)) cluster_part = kept
    end if
    allocate (part(size(clusters%of_grain)))
    part = cluster_part(clusters%of_grain)
  contains
    !> Is the split that came from the present one about as good as the new one?
    logical function is_good(other)
      integer(i4), intent(in) :: other(:)

      is_good = real(cut_weight(graph, other), wp) <= worth_moving*real(cut_weight(graph, cluster_part), wp) .and. &
                largest_share(graph, parts, other) <= max(imbalance, largest_share(graph, parts, cluster_part))
    end function is_good
  end subroutine split_clusters

  !> The graph of all clusters, and the rank of each.
  subroutine gather_graph(comm, clusters, edges, graph, rank)
    type(comm_t), intent(inout) :: comm
    type(clusters_t), intent(in) :: clusters
    integer(i4), intent(in) :: edges(:, :)
    type(contact_graph_t), intent(out) :: graph
    integer(i4), allocatable, intent(out) :: rank(:)
    integer(i4), allocatable :: ends(:), all_edges(:, :)
    integer, allocatable :: first(:)
    integer :: r, i, m

    call comm%gather(nint(clusters%weight), graph%weight, first)
    allocate (rank(clusters%all))
    do r = 0, comm%size - 1
      rank(first(r):first(r + 1) - 1) = int(r, i4)
    end do
    call comm%gather(reshape(edges, [size(edges)]), ends, first)
    m = size(ends)/3
    allocate (all_edges(3, m + max(0, clusters%all - 1)))
    all_edges(:, :m) = reshape(ends, [3, m])
    all_edges(3, :m) = contact_weight*all_edges(3, :m)
    ! Neighbours along the curve hold together what has no contacts.
    do i = 1, clusters%all - 1
      all_edges(:, m + i) = [int(i, i4), int(i + 1, i4), 1_i4]
    end do
    call graph_from_edges(clusters%all, all_edges, graph)
  end subroutine gather_graph

  !> Rename parts so that little weight moves: the largest weight that a rank has of a part is settled first.
  pure subroutine keep_with_owner(rank, weight, parts, part)
    integer(i4), intent(in) :: rank(:) !! rank that each item is at, from 0; beyond the parts, it is not counted
    real(wp), intent(in) :: weight(:) !! weight of each item, a whole number
    integer, intent(in) :: parts !! number of parts
    integer(i4), intent(inout) :: part(:) !! part of each item, from 1
    integer(i8), allocatable :: key(:)
    integer(i4), allocatable :: order(:)
    real(wp), allocatable :: shared(:)
    integer :: new_name(parts), i, k, p, r
    logical :: is_taken(parts)

    ! Weight that a rank and a part have in common: items sorted by both make runs.
    allocate (key(size(part)), shared(size(part)))
    key = int(rank, i8)*int(parts, i8) + int(part, i8) - 1
    order = sort_permutation(key)
    key = key(order)
    k = 0
    do i = 1, size(key)
      if (k > 0) then
        if (key(i) == key(k)) then
          shared(k) = shared(k) + weight(order(i))
          cycle
        end if
      end if
      k = k + 1
      key(k) = key(i)
      shared(k) = weight(order(i))
    end do
    new_name = 0
    is_taken = .false.
    order = sort_permutation(int(shared(:k), i8))
    do i = k, 1, -1
      p = int(modulo(key(order(i)), int(parts, i8))) + 1
      r = int(key(order(i))/int(parts, i8)) + 1
      if (r > parts .or. new_name(p) > 0) cycle
      if (is_taken(r)) cycle
      new_name(p) = r
      is_taken(r) = .true.
    end do
    r = 1
    do p = 1, parts
      if (new_name(p) > 0) cycle
      do while (is_taken(r))
        r = r + 1
      end do
      new_name(p) = r
      is_taken(r) = .true.
    end do
    part = int(new_name(part), i4)
  end subroutine keep_with_owner
end module sg_clusters
