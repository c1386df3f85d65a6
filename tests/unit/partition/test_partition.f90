!> Splits: loads, the contact graph and boxes by hand, METIS on lattices, the figures of a split, parts kept by their owners.
program test_partition
  use harness, only: tests_t
  use sg_boxes, only: choose_boxes, split_boxes
  use sg_clusters, only: keep_with_owner
  use sg_comm, only: comm_t
  use sg_contact_graph, only: build_contact_graph, contact_graph_t, contact_weight
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: error_t
  use sg_graph_split, only: graph_splits, split_graph
  use sg_kinds, only: wp, i4
  use sg_load, only: measured_weights
  use sg_random, only: random_t
  use sg_refine, only: cut_weight, largest_share, refine_split
  use sg_split_report, only: report_split, split_report_t
  implicit none
  integer, parameter :: side = 40
  real(wp), parameter :: imbalance = 1.05_wp
  type(tests_t) :: t

  call test_loads()
  call test_graph()
  call test_boxes()
  call test_boxes_on_lattice()
  call test_report()
  call test_image()
  call test_no_contacts()
  call test_home()
  call test_refine()
  if (graph_splits()) then
    call test_lattice()
    call test_small()
  else
    call test_without()
  end if
  call t%finish()

contains

  !> Contacts between bodies, two for each.
  subroutine make_contacts(contacts, pairs)
    type(contacts_t), intent(out) :: contacts
    integer, intent(in) :: pairs(:, :)

    contacts%n = size(pairs, 2)
    call reserve_contacts(contacts, contacts%n)
    contacts%body(:, :contacts%n) = int(pairs, i4)
  end subroutine make_contacts

  !> Bodies 1, 3, 4, 5 are grains, 2 is a wall; 1 and 3 touch by two points.
  subroutine contacts_of_five(contacts, is_grain)
    type(contacts_t), intent(out) :: contacts
    logical, intent(out) :: is_grain(5)

    call make_contacts(contacts, reshape([1, 3, 2, 1, 3, 1, 4, 3, 3, 2, 4, 5], [2, 6]))
    is_grain = [.true., .false., .true., .true., .true.]
  end subroutine contacts_of_five

  !> Their graph.
  subroutine make_five(graph)
    type(contact_graph_t), intent(out) :: graph
    type(contacts_t) :: contacts
    logical :: is_grain(5)

    call contacts_of_five(contacts, is_grain)
    call build_contact_graph(contacts, is_grain, [integer(i4) ::], graph)
  end subroutine make_five

  subroutine test_graph()
    type(contact_graph_t) :: graph

    call make_five(graph)
    call t%equal(graph%n, 4, 'grains are vertices, walls are not')
    call t%check(all(graph%body == [1, 3, 4, 5]), 'bodies of the vertices')
    call t%check(all(graph%weight == 1 + [2 + 2, 3 + 2, 2, 1]), 'a contact of grains is one half for each, of a wall a whole one')
    call t%check(all(graph%first == [1, 2, 4, 6, 7]), 'rows')
    call t%check(all(graph%neighbour == [2, 1, 3, 2, 4, 3]), 'neighbours in the order of contacts')
    call t%check(all(graph%edge_weight == contact_weight*[2, 2, 1, 1, 1, 1]), 'two points make one edge, twice as heavy')
  end subroutine test_graph

  !> Boxes of grains numbered as they stand, on one rank.
  function boxes_of(position, weight, counts) result(part)
    real(wp), intent(in) :: position(:, :)
    integer, intent(in) :: weight(:), counts(:)
    integer(i4), allocatable :: part(:)
    type(comm_t) :: alone
    integer :: i

    call split_boxes(alone, position, real(weight, wp), [(int(i, i4), i=1, size(weight))], counts, part)
  end function boxes_of

  subroutine test_boxes()
    real(wp), parameter :: line(2, 6) = reshape([5.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 4.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, &
                                                 3.0_wp, 1.0_wp], [2, 6])
    real(wp) :: cube(3, 8)
    integer :: i

    call t%check(all(boxes_of(line, spread(1, 1, 6), [3, 1, 1]) == [3, 1, 1, 3, 2, 2]), 'three slabs of two')
    call t%check(all(boxes_of(line, [1, 3, 1, 1, 1, 1], [2, 1, 1]) == [2, 1, 1, 2, 2, 2]), 'by weight, not number')
    call t%check(all(boxes_of(line, spread(1, 1, 6), [1, 2, 1]) == [1, 1, 2, 2, 1, 2]), 'two slabs across y')
    call t%check(all(boxes_of(line(:, :4), spread(1, 1, 4), [2, 2, 1]) == [3, 1, 2, 4]), 'two by two')
    do i = 0, 7
      cube(:, i + 1) = real(ibits(i, [2, 1, 0], 1), wp)
    end do
    call t%check(all(boxes_of(cube, spread(1, 1, 8), [2, 2, 2]) == [(i, i=1, 8)]), 'the corners of a cube, z fastest')
    call t%check(all(chosen_boxes(6, [3.0_wp, 2.0_wp], [0, 0, 0]) == [3, 2, 1]), 'six boxes in a rectangle of 3 by 2')
    call t%check(all(chosen_boxes(4, [1.0_wp, 9.0_wp], [0, 0, 0]) == [1, 4, 1]), 'four in a tower')
    call t%check(all(chosen_boxes(7, [2.0_wp, 1.0_wp], [0, 0, 0]) == [7, 1, 1]), 'seven in a row')
    call t%check(all(chosen_boxes(8, [1.0_wp, 1.0_wp, 1.0_wp], [0, 0, 0]) == 2), 'eight in a cube')
    call t%check(all(chosen_boxes(12, [1.0_wp, 4.0_wp, 6.0_wp], [0, 0, 0]) == [1, 3, 4]), 'twelve in a slab')
    call t%check(all(chosen_boxes(12, [1.0_wp, 4.0_wp, 6.0_wp], [2, 0, 0]) == [2, 2, 3]), 'twelve, two of them across')
    call t%check(all(chosen_boxes(12, [1.0_wp, 4.0_wp], [5, 0, 0]) == 0), 'five rows of any number are not twelve')
    call t%check(all(chosen_boxes(12, [1.0_wp, 4.0_wp], [3, 2, 2]) == 0), 'the plane has no boxes along z')
  end subroutine test_boxes

  !> Boxes of a scene whose grains stretch so far; zeros where none fit, which is an error.
  function chosen_boxes(parts, extent, wanted) result(counts)
    integer, intent(in) :: parts, wanted(3)
    real(wp), intent(in) :: extent(:)
    integer :: counts(3)
    type(comm_t) :: alone
    type(error_t), allocatable :: error

    call choose_boxes(alone, reshape([0*extent, extent], [size(extent), 2]), parts, wanted, counts, error)
    call t%check(allocated(error) .eqv. all(counts == 0), 'an error where no boxes fit')
  end function chosen_boxes

  !> Weights of one to nine: every box has its share up to the weights at its cuts.
  subroutine test_boxes_on_lattice()
    type(random_t) :: random
    real(wp) :: position(2, side**2)
    integer :: weight(side**2)
    integer(i4), allocatable :: part(:)
    real(wp) :: share
    integer :: i, p

    call random%seed(1)
    do i = 1, side**2
      position(:, i) = [random%uniform(0.0_wp, 3.0_wp), random%uniform(0.0_wp, 2.0_wp)]
      weight(i) = int(random%uniform(1.0_wp, 10.0_wp))
    end do
    part = boxes_of(position, weight, [3, 4, 1])
    share = real(sum(weight), wp)/12
    do p = 1, 12
      ! A cut is at most half a grain off; a box has two across y and a quarter of two across x.
      call t%near(real(sum(weight, mask=part == p), wp), share, 2*4.5_wp + 2*4.5_wp/4, 'weight of a box')
    end do
    call t%check(maxval(position(1, :), mask=part <= 4) < minval(position(1, :), mask=part > 4), 'slabs lie side by side')
    call t%check(maxval(position(2, :), mask=part == 1) < minval(position(2, :), mask=part == 2), 'boxes lie one on another')
  end subroutine test_boxes_on_lattice

  !> The five bodies of `make_five`: parts of the grains 1, 3, 4, 5.
  subroutine test_report()
    type(contacts_t) :: contacts
    type(split_report_t) :: report
    logical :: is_grain(5)

    call contacts_of_five(contacts, is_grain)
    report = report_split(contacts, [1_i4, 0_i4, 2_i4, 3_i4, 3_i4], measured_weights(contacts, is_grain, 5), 3)
    call t%equal(report%contacts, 4, 'contacts between grains')
    call t%equal(report%wall_contacts, 2, 'contacts with walls')
    call t%equal(report%cut_contacts, 3, 'two points and one are cut')
    call t%equal(report%interface_grains, 3, 'the last grain touches its own part alone')
    call t%check(all(report%part_grains == [1, 1, 2]) .and. all(nint(report%part_load) == [5, 6, 5]), 'sizes')
    call t%near(report%imbalance, 6*3/16.0_wp, 1e-15_wp, 'imbalance')
    call t%check(all(report%part_inner == [1, 1, 1]), 'contacts with walls and within parts')
    ! Of ranks 0 and 1 (an odd sum) the lower owns, of 1 and 2 the lower too.
    call t%check(all(report%part_owned == [3, 2, 1]), 'contacts owned')
    call t%near(report%contact_imbalance, 3*3/6.0_wp, 1e-15_wp, 'imbalance of contacts owned')
    call t%check(all(report%part_held == [2, 2, 2]), 'grain 3 is copied to part 1, grain 4 to part 2')
    call t%check(all(report%multiplicity == [2, 2]), 'two grains have a copy')
    call t%check(all(report%part_neighbours == [1, 2, 1]), 'part 2 lies between the others')
    report = report_split(contacts, [1_i4, 0_i4, 1_i4, 1_i4, 1_i4], measured_weights(contacts, is_grain, 5), 1)
    call t%check(report%cut_contacts == 0 .and. all(report%multiplicity == [4]), 'one part cuts nothing')
    ! Grain 3 is owned by part 1; parts 2 and 3 own its contacts with grains 1 and 4.
    report = report_split(contacts, [3_i4, 0_i4, 1_i4, 2_i4, 2_i4], measured_weights(contacts, is_grain, 5), 3)
    call t%check(all(report%part_owned == [2, 1, 3]), 'of ranks 0 and 2 the higher one owns, of 0 and 1 the lower')
    call t%check(all(report%multiplicity == [2, 2]), 'grain 3 in part 3, grain 4 in part 1')
  end subroutine test_report

  subroutine test_loads()
    type(contacts_t) :: contacts
    logical :: is_grain(5)

    call contacts_of_five(contacts, is_grain)
    call t%check(all(nint(measured_weights(contacts, is_grain, 5)) == [5, 0, 6, 3, 2]), 'half contacts, and the grain itself')
    call t%check(all(nint(measured_weights(contacts, is_grain, 3)) == [5, 0, 6, 2, 1]), 'copies bring their contacts alone')
  end subroutine test_loads

  !> A grain that touches its own periodic image makes no edge.
  subroutine test_image()
    type(contact_graph_t) :: graph
    type(contacts_t) :: contacts

    call make_contacts(contacts, reshape([1, 1, 1, 2], [2, 2]))
    call build_contact_graph(contacts, [.true., .true.], [integer(i4) ::], graph)
    call t%check(all(graph%neighbour == [2, 1]), 'no edge from a grain to itself')
    call t%check(all(graph%weight == [4, 2]), 'but a cost')
  end subroutine test_image

  !> Parts are renamed after the ranks that have most of them.
  subroutine test_home()
    integer(i4) :: part(6)

    part = [2_i4, 2_i4, 3_i4, 3_i4, 1_i4, 1_i4]
    call keep_with_owner([0_i4, 0_i4, 1_i4, 1_i4, 2_i4, 2_i4], spread(1.0_wp, 1, 6), 3, part)
    call t%check(all(part == [1, 1, 2, 2, 3, 3]), 'what did not move has its old name')
    part = [2_i4, 2_i4, 2_i4, 1_i4, 1_i4, 1_i4]
    call keep_with_owner([0_i4, 0_i4, 1_i4, 1_i4, 1_i4, 0_i4], [1.0_wp, 1.0_wp, 9.0_wp, 1.0_wp, 1.0_wp, 1.0_wp], 2, part)
    call t%check(all(part == [2, 2, 2, 1, 1, 1]), 'the heaviest share decides')
    part = [3_i4, 1_i4, 2_i4, 2_i4, 1_i4, 3_i4]
    call keep_with_owner(spread(0_i4, 1, 6), spread(1.0_wp, 1, 6), 3, part)
    call t%check(all(part(:3) == part([6, 5, 4])) .and. sum(part(:3)) == 6, 'parts stay parts, each with a name of its own')
  end subroutine test_home

  !> A lattice in two halves, one with six columns too many: they move, and nothing else.
  subroutine test_refine()
    type(contact_graph_t) :: graph
    type(contacts_t) :: contacts
    integer(i4) :: part(side**2), before(side**2)
    integer :: i

    call make_lattice(graph, side, contacts)
    part = [(merge(1_i4, 2_i4, modulo(i - 1, side) < side/2), i=1, side**2)]
    before = part
    call refine_split(graph, 2, imbalance, part)
    call t%check(all(part == before), 'what is best stays')
    associate (straight => int(contact_weight)*side)
      call t%equal(int(cut_weight(graph, part)), straight, 'a straight cut')
      part = [(merge(1_i4, 2_i4, modulo(i - 1, side) < side/2 + 6), i=1, side**2)]
      before = part
      call t%check(largest_share(graph, 2, part) > 1.25_wp, 'one half has too much')
      call refine_split(graph, 2, imbalance, part)
      call t%check(largest_share(graph, 2, part) <= imbalance, 'then no longer')
      call t%check(all(part == before .or. before == 1), 'what moves leaves the heavy half')
      call t%check(count(part /= before) <= 6*side, 'and is no more than needed')
      call t%check(int(cut_weight(graph, part)) <= 3*straight/2, 'the border stays short')
    end associate
  end subroutine test_refine

  subroutine test_no_contacts()
    type(contact_graph_t) :: graph
    type(contacts_t) :: contacts
    type(split_report_t) :: report
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:)

    call make_contacts(contacts, reshape([integer ::], [2, 0]))
    call build_contact_graph(contacts, spread(.true., 1, 8), [1_i4, 3_i4, 5_i4, 7_i4, 8_i4, 6_i4, 4_i4, 2_i4], graph)
    report = report_split(contacts, [1_i4, 2_i4], [1.0_wp, 1.0_wp], 2)
    call t%check(report%cut_contacts == 0 .and. report%interface_grains == 0, 'no contact, nothing cut')
    call t%near(report%imbalance, 1.0_wp, 1e-15_wp, 'two equal grains')
    if (.not. graph_splits()) return
    call split_graph(graph, 2, imbalance, part, error)
    call t%check(count(part == 1) == 4 .and. count(part == 2) == 4, 'grains without contacts are shared evenly')
    call t%check(all(part([1, 3, 5, 7]) == part(1)), 'and stay together along the curve')
  end subroutine test_no_contacts

  !> A square lattice of disks.
  subroutine make_lattice(graph, n, contacts)
    type(contact_graph_t), intent(out) :: graph
    integer, intent(in) :: n
    type(contacts_t), intent(out) :: contacts
    integer, allocatable :: pairs(:, :)
    integer :: i, j, k

    allocate (pairs(2, 2*n*(n - 1)))
    k = 0
    do j = 1, n
      do i = 1, n
        if (i < n) pairs(:, k + 1) = [n*(j - 1) + i, n*(j - 1) + i + 1]
        k = k + merge(1, 0, i < n)
        if (j < n) pairs(:, k + 1) = [n*(j - 1) + i, n*j + i]
        k = k + merge(1, 0, j < n)
      end do
    end do
    call make_contacts(contacts, pairs)
    call build_contact_graph(contacts, spread(.true., 1, n**2), [integer(i4) ::], graph)
  end subroutine make_lattice

  !> A lattice into four: as even as asked, far better than by chance, near the best.
  subroutine test_lattice()
    type(contact_graph_t) :: graph
    type(contacts_t) :: contacts
    type(split_report_t) :: report, by_chance
    type(random_t) :: random
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:), again(:)
    integer :: i

    call make_lattice(graph, side, contacts)
    call split_graph(graph, 4, imbalance, part, error)
    call t%check(.not. allocated(error), 'METIS splits a lattice')
    call t%equal(size(part), side**2, 'every grain has a part')
    call t%check(minval(part) == 1 .and. maxval(part) == 4, 'parts are those asked for')
    report = report_split(contacts, part, real(graph%weight, wp), 4)
    call t%equal(sum(report%part_grains), side**2, 'every grain is in one part')
    call t%check(report%imbalance <= imbalance, 'imbalance is within the asked one')
    call random%seed(5)
    by_chance = report_split(contacts, [(int(random%uniform(1.0_wp, 5.0_wp), i4), i=1, side**2)], &
                             real(graph%weight, wp), 4)
    call t%check(by_chance%cut_contacts > 2*side*(side - 1)/2, 'chance cuts three quarters')
    ! Two straight cuts are best and cut 2 side contacts; METIS is allowed half as many again.
    call t%check(report%cut_contacts >= 2*(side - 4) .and. report%cut_contacts <= 3*side, 'METIS cuts few')
    call split_graph(graph, 4, imbalance, again, error)
    call t%check(all(part == again), 'the same graph has the same split')
    call split_graph(graph, 1, imbalance, part, error)
    call t%check(all(part == 1), 'one part')
  end subroutine test_lattice

  !> As many parts as grains and fewer: METIS stays within its bounds.
  subroutine test_small()
    type(contact_graph_t) :: graph
    type(contacts_t) :: contacts
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:)
    integer :: parts, i

    call make_lattice(graph, 3, contacts)
    do parts = 1, 12
      call split_graph(graph, parts, imbalance, part, error)
      call t%check(.not. allocated(error), 'a small lattice is split')
      call t%check(all(part >= 1 .and. part <= parts), 'within the parts asked for')
      if (parts >= 9) call t%check(all(part == [(int(i, i4), i=1, 9)]), 'a part for every grain')
    end do
  end subroutine test_small

  subroutine test_without()
    type(contact_graph_t) :: graph
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:)

    call make_five(graph)
    call split_graph(graph, 2, imbalance, part, error)
    call t%check(allocated(error), 'without METIS the method graph is an error')
    if (allocated(error)) call t%check(index(error%message, 'METIS') > 0, 'which says so')
  end subroutine test_without
end program test_partition
