!> Splits over ranks: boxes are those of one rank whatever rank the grains are on, clusters cover the grains and make few and
!! even parts, most of which stay where they are. Run on any number of subdomains.
program test_split
  use cut_by_hand, only: cut_scene
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use sg_boxes, only: choose_boxes, split_boxes
  use sg_clusters, only: cluster_edges, clusters_t, make_clusters, split_clusters
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_detect, only: detect
  use sg_error, only: error_t
  use sg_graph_split, only: graph_splits
  use sg_kinds, only: wp, i4
  use sg_load, only: imbalance, measured_weights
  use sg_motion, only: predict
  use sg_owners, only: contact_owner
  use sg_random, only: random_t
  use sg_repartition, only: repartition_grains
  use sg_run_options, only: partition_options_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t, start_simulation
  use sg_subdomain, only: subdomain_t
  use scenes, only: begin_scene, put_disk, put_wall
  use subdomain_tests, only: on_subdomains
  implicit none
  integer, parameter :: side = 48
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call test_boxes(comm, 2, is_lattice=.false.)
    call test_boxes(comm, 2, is_lattice=.true.)
    call test_boxes(comm, 3, is_lattice=.false.)
    call test_boxes(comm, 3, is_lattice=.true.)
    call test_extremes(comm)
    call test_imbalance(comm)
    call test_clusters(comm)
    if (comm%size > 1) call test_deal(comm)
  end subroutine run_tests

  !> Rank of a grain: dealt in turns, in blocks, or all to the last rank.
  pure integer function rank_of(comm, i, n, way)
    type(comm_t), intent(in) :: comm
    integer, intent(in) :: i, n, way

    select case (way)
    case (1)
      rank_of = modulo(i, comm%size)
    case (2)
      rank_of = (i - 1)*comm%size/n
    case default
      rank_of = comm%size - 1
    end select
  end function rank_of

  !> All ways of dealing grains give the boxes of one rank that has them all.
  subroutine test_boxes(comm, dimension, is_lattice)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension
    logical, intent(in) :: is_lattice
    integer, parameter :: n = 1728
    real(wp) :: position(dimension, n), weight(n)
    type(comm_t) :: alone
    type(error_t), allocatable :: error
    integer(i4), allocatable :: whole(:), part(:), own(:)
    integer :: counts(3), way, parts

    call make_grains(dimension, is_lattice, position, weight)
    do parts = 2, 12, 2
      call choose_boxes(alone, position, parts, [0, 0, 0], counts, error)
      call t%check(.not. allocated(error) .and. product(counts) == parts, 'boxes are chosen')
      call split_boxes(alone, position, weight, numbers(n), counts, whole)
      call check_shares(whole, weight, counts)
      do way = 1, 3
        own = owned(comm, n, way)
        call split_boxes(comm, position(:, own), weight(own), own, counts, part)
        call t%check(all(part == whole(own)), 'boxes do not depend on who has the grains')
      end do
    end do
  end subroutine test_boxes

  !> Grains of this rank.
  function owned(comm, n, way) result(own)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: n, way
    integer(i4), allocatable :: own(:)
    integer :: i

    own = pack(numbers(n), [(rank_of(comm, i, n, way) == comm%rank, i=1, n)])
  end function owned

  !> The numbers up to n.
  function numbers(n)
    integer, intent(in) :: n
    integer(i4) :: numbers(n)
    integer :: i

    numbers = [(int(i, i4), i=1, n)]
  end function numbers

  !> Every box has its share up to the grains at its cuts.
  subroutine check_shares(part, weight, counts)
    integer(i4), intent(in) :: part(:)
    real(wp), intent(in) :: weight(:)
    integer, intent(in) :: counts(3)
    real(wp) :: share
    integer :: p

    share = sum(weight)/real(product(counts), wp)
    do p = 1, product(counts)
      ! A cut is at most half a grain, of weight 9, off; a box has two across its last axis, and its share of those before.
      call t%near(sum(weight, mask=part == p), share, 3*9.0_wp, 'weight of a box')
    end do
  end subroutine check_shares

  !> Grains in a box of 3 by 2 (by 1), by chance or on a lattice with many equal coordinates.
  subroutine make_grains(dimension, is_lattice, position, weight)
    integer, intent(in) :: dimension
    logical, intent(in) :: is_lattice
    real(wp), intent(out) :: position(:, :), weight(:)
    type(random_t) :: random
    integer :: i, axis, row

    call random%seed(3)
    row = merge(48, 12, dimension == 2)
    do i = 1, size(weight)
      do axis = 1, dimension
        position(axis, i) = random%uniform(-1.0_wp, 3.0_wp - real(axis, wp))
        if (is_lattice) position(axis, i) = real(modulo((i - 1)/row**(axis - 1), row), wp)
      end do
      weight(i) = merge(2.0_wp, real(int(random%uniform(1.0_wp, 10.0_wp)), wp), is_lattice)
    end do
  end subroutine make_grains

  !> No grains at all, fewer grains than boxes, all at one place, and boxes that cannot be made.
  subroutine test_extremes(comm)
    type(comm_t), intent(inout) :: comm
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:), own(:)
    real(wp) :: position(2, 12), found(12)
    integer :: counts(3), p

    call split_boxes(comm, position(:, 1:0), [real(wp) ::], [integer(i4) ::], [2, 2, 1], part)
    call t%equal(size(part), 0, 'no grains')
    position = 0.5_wp
    own = owned(comm, 12, 1)
    call split_boxes(comm, position(:, own), spread(1.0_wp, 1, size(own)), own, [2, 2, 1], part)
    found = 0
    found(own) = real(part, wp)
    call comm%sum(found)
    call t%check(all([(count(nint(found) == p) == 3, p=1, 4)]), 'grains at one place are dealt by number')
    own = owned(comm, 3, 2)
    call split_boxes(comm, position(:, own), spread(1.0_wp, 1, size(own)), own, [5, 1, 1], part)
    found = 0
    found(own) = real(part, wp)
    call comm%sum(found)
    call t%check(all([(count(nint(found) == p) <= 1, p=1, 5)]), 'fewer grains than boxes leave some empty')
    call choose_boxes(comm, position(:, own), 6, [4, 0, 0], counts, error)
    call t%check(allocated(error), 'six boxes are not four times any number')
    if (allocated(error)) call t%check(index(error%message, '4 x 0') > 0, 'which is said')
    call choose_boxes(comm, position(:, own), 6, [2, 0, 0], counts, error)
    call t%check(.not. allocated(error) .and. all(counts == [2, 3, 1]), 'what is asked for is kept')
  end subroutine test_extremes

  subroutine test_imbalance(comm)
    type(comm_t), intent(inout) :: comm
    real(wp) :: n, ratio

    n = real(comm%size, wp)
    ratio = imbalance(comm, real(comm%rank + 1, wp))
    ! Loads 1 to n: mean (n + 1)/2.
    call t%near(ratio, 2*n/(n + 1), 1e-14_wp, 'imbalance of loads 1, 2, 3, ...')
    ratio = imbalance(comm, 0.0_wp)
    call t%near(ratio, 1.0_wp, 0.0_wp, 'nothing is shared evenly')
  end subroutine test_imbalance

  !> A square lattice, dealt in blocks of rows: clusters, their edges, their split.
  subroutine test_clusters(comm)
    type(comm_t), intent(inout) :: comm
    integer, parameter :: n = side**2
    type(clusters_t) :: clusters
    type(contacts_t) :: contacts
    integer(i4), allocatable :: own(:), edges(:, :)
    integer(i4) :: cluster(n + 1)
    real(wp) :: position(2, n), all_clusters(n), sums(2)
    integer :: i, parts

    do i = 1, n
      position(:, i) = real([modulo(i - 1, side), (i - 1)/side], wp)
    end do
    own = owned(comm, n, 2)
    do parts = max(2, comm%size), 8, 3
      call make_clusters(comm, position(:, own), spread(2.0_wp, 1, size(own)), 63*parts, clusters)
      call t%check(clusters%all <= 63*parts + comm%size, 'few clusters')
      call t%check(clusters%all >= 16*parts, 'but enough')
      sums = [sum(clusters%weight), real(size(clusters%weight), wp)]
      call comm%sum(sums)
      call t%near(sums(1), 2.0_wp*n, 0.0_wp, 'clusters weigh what their grains do')
      call t%equal(nint(sums(2)), clusters%all, 'they are counted')
      all_clusters = 0
      all_clusters(own) = real(clusters%of_grain, wp)
      call comm%sum(all_clusters)
      cluster = [nint(all_clusters, i4), 0_i4]
      call t%check(all(cluster(:n) >= 1) .and. maxval(cluster) == clusters%all, 'every grain has one')
      call make_contacts(comm, contacts)
      call cluster_edges(contacts, cluster, edges)
      call t%equal(sum(edges(3, :)), joining(contacts, cluster), 'edges count contacts between clusters')
      call t%check(all(edges(1, :) < edges(2, :)), 'edges are written once')
      if (graph_splits()) call split_lattice(comm, clusters, edges, own, parts)
    end do
  end subroutine test_clusters

  !> Contacts that join two clusters.
  pure integer function joining(contacts, cluster)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: cluster(:)
    integer :: k

    joining = 0
    do k = 1, contacts%n
      associate (ends => cluster(contacts%body(:, k)))
        if (all(ends > 0) .and. ends(1) /= ends(2)) joining = joining + 1
      end associate
    end do
  end function joining

  !> Contacts of the lattice that this rank owns; body side**2 + 1 is the floor.
  subroutine make_contacts(comm, contacts)
    type(comm_t), intent(inout) :: comm
    type(contacts_t), intent(out) :: contacts
    integer :: i

    call reserve_contacts(contacts, 3*side**2)
    do i = 1, side**2
      if (modulo(i, side) /= 0) call add_contact(comm, contacts, i, i + 1)
      if (i + side <= side**2) call add_contact(comm, contacts, i, i + side)
      if (i <= side) call add_contact(comm, contacts, i, side**2 + 1)
    end do
  end subroutine make_contacts

  !> Add a contact, if this rank owns it.
  subroutine add_contact(comm, contacts, a, b)
    type(comm_t), intent(inout) :: comm
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: a, b
    integer :: home_b

    home_b = -1
    if (b <= side**2) home_b = rank_of(comm, b, side**2, 2)
    if (contact_owner(int([rank_of(comm, a, side**2, 2), home_b], i4)) /= comm%rank) return
    contacts%n = contacts%n + 1
    contacts%body(:, contacts%n) = int([a, b], i4)
  end subroutine add_contact

  !> Parts are even, cut few contacts, and stay on the owner's rank where they can.
  subroutine split_lattice(comm, clusters, edges, own, parts)
    type(comm_t), intent(inout) :: comm
    type(clusters_t), intent(in) :: clusters
    integer(i4), intent(in) :: edges(:, :), own(:)
    integer, intent(in) :: parts
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:)
    real(wp) :: found(side**2), sums(2)
    integer :: i, p, cut

    call split_clusters(comm, clusters, edges, parts, 1.05_wp, part, error)
    call t%check(.not. allocated(error), 'clusters are split')
    if (allocated(error)) return
    found = 0
    found(own) = real(part, wp)
    call comm%sum(found)
    cut = 0
    do i = 1, side**2
      if (modulo(i, side) /= 0) cut = cut + merge(1, 0, nint(found(i)) /= nint(found(min(i + 1, side**2))))
      if (i + side <= side**2) cut = cut + merge(1, 0, nint(found(i)) /= nint(found(min(i + side, side**2))))
    end do
    do p = 1, parts
      ! METIS may pass the bound by a cluster or two of the 16 and more of a part.
      call t%near(real(count(nint(found) == p), wp), real(side**2, wp)/real(parts, wp), 0.15_wp*side**2/real(parts, wp), &
                  'size of a part')
    end do
    ! Square parts would have 2 sqrt(parts) sides of the lattice as borders; clusters of grains make rougher ones.
    call t%check(real(cut, wp) <= 2*side*(sqrt(real(parts, wp)) - 1) + 1.5_wp*side, 'few contacts are cut')
    sums = [real(count(part == comm%rank + 1), wp), 1.0_wp]
    call comm%sum(sums)
    ! A part's best rank has at least 1/ranks of it; the greedy choice keeps more in all than chance.
    call t%check(sums(1) >= real(side**2, wp)/real(parts*comm%size, wp), 'weight stays with its owner')
  end subroutine split_lattice

  !> Rows of disks on a floor in parts that make no sense: new owners are those that one rank would choose.
  subroutine test_deal(comm)
    type(comm_t), intent(inout) :: comm
    integer, parameter :: columns = 24, n = columns*10
    type(simulation_t), pointer :: sim
    type(scene_t) :: local
    type(contacts_t) :: contacts
    type(subdomain_t) :: subdomain
    type(partition_options_t) :: options
    type(error_t), allocatable :: error
    type(comm_t) :: alone
    integer(i4), allocatable :: owner(:), part(:)
    real(wp), allocatable :: load(:), position(:, :)
    integer :: i, counts(3)

    sim => fresh()
    call begin_scene(sim%scene, n + 1, 0.3_wp, 0.05_wp)
    call put_wall(sim%scene, 1, 30.0_wp, 0.5_wp, [12.0_wp, -1.0_wp], 0.0_wp)
    do i = 1, n
      call put_disk(sim%scene, i + 1, 0.5_wp, real([modulo(i, columns), (i - 1)/columns], wp))
    end do
    sim%options%time_step = 1e-3_wp
    call start_simulation(sim)
    call predict(sim%scene, 0.0_wp, 0.0_wp, 0.5_wp)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call t%equal(sim%contacts%n, (columns - 1)*10 + columns*9 + columns, 'contacts of the lattice')
    part = [(int(modulo(i*i, comm%size), i4), i=1, n + 1)]
    call cut_scene(sim%scene, sim%contacts, part, comm%rank, comm%size, local, contacts, subdomain)

    load = measured_weights(sim%contacts, sim%scene%bodies%is_grain, n + 1)
    position = sim%scene%bodies%position(:, 2:)
    call choose_boxes(alone, position, comm%size, [0, 0, 0], counts, error)
    call split_boxes(alone, position, load(2:), numbers(n) + 1_i4, counts, part)
    part = [0_i4, part]
    call repartition_grains(comm, options, subdomain, local%bodies, contacts, owner, error)
    call t%check(.not. allocated(error), 'grains are dealt to boxes')
    associate (id => local%bodies%id(:local%bodies%n_own))
      call t%check(all(owner == part(id) - 1), 'as one rank would')
      options%split = 'graph'
      call repartition_grains(comm, options, subdomain, local%bodies, contacts, owner, error)
      call t%check(allocated(error) .neqv. graph_splits(), 'grains are dealt by the graph where there is METIS')
      if (.not. allocated(error)) call check_homes(comm, owner, id, load, sim%contacts)
    end associate
  end subroutine test_deal

  !> New owners by the graph: every grain has one, loads are even, and few contacts are cut.
  subroutine check_homes(comm, owner, id, load, contacts)
    type(comm_t), intent(inout) :: comm
    integer(i4), intent(in) :: owner(:), id(:)
    real(wp), intent(in) :: load(:)
    type(contacts_t), intent(in) :: contacts
    real(wp) :: owners(size(load)), shares(comm%size)
    integer :: k, cut, r

    owners = 0
    owners(id) = real(owner, wp)
    call comm%sum(owners)
    call t%check(nint(owners(1)) == -1 .and. all(owners(2:) >= 0), 'every grain has an owner, the wall has none')
    shares = [(sum(load, mask=nint(owners) == r), r=0, comm%size - 1)]
    ! METIS may pass the bound of 1.03 by some of the 60 clusters of a part.
    call t%check(maxval(shares) <= 1.1_wp*sum(shares)/real(comm%size, wp), 'loads are even')
    cut = 0
    do k = 1, contacts%n
      associate (ends => nint(owners(contacts%body(:, k))))
        if (all(ends >= 0) .and. ends(1) /= ends(2)) cut = cut + 1
      end associate
    end do
    ! Straight cuts through ten rows cut ten contacts each.
    call t%check(cut <= 20*(comm%size - 1), 'few contacts are cut')
  end subroutine check_homes
end program test_split
