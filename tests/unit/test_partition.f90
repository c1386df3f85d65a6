!> Splits: the contact graph by hand, boxes by hand, METIS on lattices, and the figures of a split.
program test_partition
  use harness, only: tests_t
  use sg_boxes, only: fitting_boxes, split_boxes
  use sg_contact_graph, only: build_contact_graph, contact_graph_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: error_t
  use sg_graph_split, only: graph_splits, split_graph
  use sg_kinds, only: wp, i4
  use sg_random, only: random_t
  use sg_split_report, only: report_split, split_report_t
  implicit none
  integer, parameter :: side = 40
  real(wp), parameter :: imbalance = 1.05_wp
  type(tests_t) :: t

  call test_graph()
  call test_boxes()
  call test_boxes_on_lattice()
  call test_report()
  call test_no_contacts()
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
  subroutine make_five(graph)
    type(contact_graph_t), intent(out) :: graph
    type(contacts_t) :: contacts

    call make_contacts(contacts, reshape([1, 3, 2, 1, 3, 1, 4, 3, 3, 2, 4, 5], [2, 6]))
    call build_contact_graph(contacts, [.true., .false., .true., .true., .true.], graph)
  end subroutine make_five

  subroutine test_graph()
    type(contact_graph_t) :: graph

    call make_five(graph)
    call t%equal(graph%n, 4, 'grains are vertices, walls are not')
    call t%check(all(graph%body == [1, 3, 4, 5]), 'bodies of the vertices')
    call t%check(all(graph%weight == 1 + [2 + 2, 3 + 2, 2, 1]), 'a contact of grains is one half for each, of a wall a whole one')
    call t%check(all(graph%first == [1, 2, 4, 6, 7]), 'rows')
    call t%check(all(graph%neighbour == [2, 1, 3, 2, 4, 3]), 'neighbours in the order of contacts')
    call t%check(all(graph%multiplicity == [2, 2, 1, 1, 1, 1]), 'two points make one edge')
  end subroutine test_graph

  subroutine test_boxes()
    real(wp), parameter :: line(2, 6) = reshape([5.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 4.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, &
                                                 3.0_wp, 1.0_wp], [2, 6])

    call t%check(all(split_boxes(line, spread(1_i4, 1, 6), [3, 1]) == [3, 1, 1, 3, 2, 2]), 'three slabs of two')
    call t%check(all(split_boxes(line, [1_i4, 3_i4, 1_i4, 1_i4, 1_i4, 1_i4], [2, 1]) == [2, 1, 1, 2, 2, 2]), &
                 'by weight, not number')
    call t%check(all(split_boxes(line, spread(1_i4, 1, 6), [1, 2]) == [1, 1, 2, 2, 1, 2]), 'two slabs across y')
    call t%check(all(split_boxes(line(:, :4), spread(1_i4, 1, 4), [2, 2]) == [3, 1, 2, 4]), 'two by two')
    call t%check(all(fitting_boxes(6, [3.0_wp, 2.0_wp]) == [3, 2]), 'six boxes in a rectangle of 3 by 2')
    call t%check(all(fitting_boxes(4, [1.0_wp, 9.0_wp]) == [1, 4]), 'four in a tower')
    call t%check(all(fitting_boxes(7, [2.0_wp, 1.0_wp]) == [7, 1]), 'seven in a row')
  end subroutine test_boxes

  !> Weights of one to nine: every box has its share up to the weights at its cuts.
  subroutine test_boxes_on_lattice()
    type(random_t) :: random
    real(wp) :: position(2, side**2)
    integer(i4) :: weight(side**2)
    integer(i4), allocatable :: part(:)
    real(wp) :: share
    integer :: i, p

    call random%seed(1)
    do i = 1, side**2
      position(:, i) = [random%uniform(0.0_wp, 3.0_wp), random%uniform(0.0_wp, 2.0_wp)]
      weight(i) = int(random%uniform(1.0_wp, 10.0_wp), i4)
    end do
    part = split_boxes(position, weight, [3, 4])
    share = real(sum(weight), wp)/12
    do p = 1, 12
      ! A cut is at most half a grain off; a box has two across y and a quarter of two across x.
      call t%near(real(sum(weight, mask=part == p), wp), share, 2*4.5_wp + 2*4.5_wp/4, 'weight of a box')
    end do
    call t%check(maxval(position(1, :), mask=part <= 4) < minval(position(1, :), mask=part > 4), 'slabs lie side by side')
    call t%check(maxval(position(2, :), mask=part == 1) < minval(position(2, :), mask=part == 2), 'boxes lie one on another')
  end subroutine test_boxes_on_lattice

  subroutine test_report()
    type(contact_graph_t) :: graph
    type(split_report_t) :: report

    call make_five(graph)
    report = report_split(graph, [1_i4, 2_i4, 3_i4, 3_i4], 3)
    call t%equal(report%contacts, 4, 'contacts between grains')
    call t%equal(report%cut_contacts, 3, 'two points and one are cut')
    call t%equal(report%interface_grains, 3, 'the last grain touches its own part alone')
    call t%check(all(report%part_grains == [1, 1, 2]) .and. all(report%part_weight == [5, 6, 5]), 'sizes')
    call t%check(all(report%part_interface == [1, 1, 1]), 'interface of each part')
    call t%check(all(report%multiplicity == [1, 2, 1]), 'one grain is known to three parts')
    call t%near(report%imbalance, 6*3/16.0_wp, 1e-15_wp, 'imbalance')
    report = report_split(graph, [1_i4, 1_i4, 1_i4, 1_i4], 1)
    call t%check(report%cut_contacts == 0 .and. all(report%multiplicity == [4]), 'one part cuts nothing')
  end subroutine test_report

  subroutine test_no_contacts()
    type(contact_graph_t) :: graph
    type(contacts_t) :: contacts
    type(split_report_t) :: report

    call make_contacts(contacts, reshape([integer ::], [2, 0]))
    call build_contact_graph(contacts, [.true., .true.], graph)
    report = report_split(graph, [1_i4, 2_i4], 2)
    call t%check(report%cut_contacts == 0 .and. report%interface_grains == 0, 'no contact, nothing cut')
    call t%near(report%imbalance, 1.0_wp, 1e-15_wp, 'two equal grains')
  end subroutine test_no_contacts

  !> A square lattice of disks.
  subroutine make_lattice(graph, n)
    type(contact_graph_t), intent(out) :: graph
    integer, intent(in) :: n
    type(contacts_t) :: contacts
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
    call build_contact_graph(contacts, spread(.true., 1, n**2), graph)
  end subroutine make_lattice

  !> A lattice into four: as even as asked, far better than by chance, near the best.
  subroutine test_lattice()
    type(contact_graph_t) :: graph
    type(split_report_t) :: report, by_chance
    type(random_t) :: random
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:), again(:)
    integer :: i

    call make_lattice(graph, side)
    call split_graph(graph, 4, imbalance, part, error)
    call t%check(.not. allocated(error), 'METIS splits a lattice')
    call t%equal(size(part), side**2, 'every grain has a part')
    call t%check(minval(part) == 1 .and. maxval(part) == 4, 'parts are those asked for')
    report = report_split(graph, part, 4)
    call t%equal(sum(report%part_grains), side**2, 'every grain is in one part')
    call t%check(report%imbalance <= imbalance, 'imbalance is within the asked one')
    call random%seed(5)
    by_chance = report_split(graph, [(int(random%uniform(1.0_wp, 5.0_wp), i4), i=1, side**2)], 4)
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
    type(error_t), allocatable :: error
    integer(i4), allocatable :: part(:)
    integer :: parts

    call make_lattice(graph, 3)
    do parts = 1, 9
      call split_graph(graph, parts, imbalance, part, error)
      call t%check(.not. allocated(error), 'a small lattice is split')
      call t%check(all(part >= 1 .and. part <= parts), 'within the parts asked for')
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
