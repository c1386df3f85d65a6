!> New owners for the grains of a decomposed scene, by boxes or by the graph of contacts.
module sg_repartition
  use sg_bodies, only: bodies_t
  use sg_boxes, only: choose_boxes, split_boxes
  use sg_clusters, only: cluster_edges, clusters_t, make_clusters, most_clusters, split_clusters
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_load, only: measured_weights
  use sg_owner_sums, only: add_grains_at_owner, copy_from_owner
  use sg_run_options, only: partition_options_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: repartition_grains

  !> Largest load of a part over the mean one that is asked of a split of the graph
  real(wp), parameter :: imbalance = 1.03_wp

contains

  !> Repartition the grains of a scene over the ranks, by their cost in the last step. Collective; nothing moves yet.
  subroutine repartition_grains(comm, options, subdomain, bodies, contacts, owner, error)
    type(comm_t), intent(inout) :: comm !! the ranks
    type(partition_options_t), intent(in) :: options !! how to split
    type(subdomain_t), intent(in) :: subdomain !! which ranks share which bodies now
    type(bodies_t), intent(in) :: bodies !! bodies of this rank's scene, with owners and numbers
    type(contacts_t), intent(in) :: contacts !! contacts that this rank owns
    integer(i4), allocatable, intent(out) :: owner(:) !! new owner of each body of this rank, -1 for replicated ones, shape (n_own)
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the split is impossible
    integer(i4), allocatable :: own(:), part(:)
    real(wp), allocatable :: load(:, :), position(:, :)
    integer :: counts(3), b

    allocate (load(1, bodies%n))
    load(1, :) = measured_weights(contacts, bodies%is_grain, bodies%n_own)
    call add_grains_at_owner(subdomain, comm, load)
    own = pack([(int(b, i4), b=1, bodies%n_own)], bodies%owner(:bodies%n_own) >= 0)
    position = bodies%position(:, own)
    if (options%split == 'graph') then
      call split_graph_of_clusters(comm, subdomain, bodies, contacts, own, load(1, own), part, error)
    else
      call choose_boxes(comm, position, comm%size, options%boxes, counts, error)
      if (.not. allocated(error)) call split_boxes(comm, position, load(1, own), bodies%id(own), counts, part)
    end if
    if (allocated(error)) return
    allocate (owner(bodies%n_own), source=-1_i4)
    owner(own) = part - 1_i4
  end subroutine repartition_grains

  !> Parts of this rank's grains by the graph of all ranks' clusters.
  subroutine split_graph_of_clusters(comm, subdomain, bodies, contacts, own, load, part, error)
    type(comm_t), intent(inout) :: comm
    type(subdomain_t), intent(in) :: subdomain
    type(bodies_t), intent(in) :: bodies
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: own(:)
    real(wp), intent(in) :: load(:)
    integer(i4), allocatable, intent(out) :: part(:)
    type(error_t), allocatable, intent(out) :: error
    type(clusters_t) :: clusters
    real(wp), allocatable :: cluster(:, :)
    integer(i4), allocatable :: edges(:, :)

    call make_clusters(comm, bodies%position(:, own), load, most_clusters(comm%size), clusters)
    allocate (cluster(1, bodies%n), source=0.0_wp)
    cluster(1, own) = real(clusters%of_grain, wp)
    call copy_from_owner(subdomain, comm, cluster)
    call cluster_edges(contacts, nint(cluster(1, :), i4), edges)
    call split_clusters(comm, clusters, edges, comm%size, imbalance, part, error)
  end subroutine split_graph_of_clusters
end module sg_repartition
