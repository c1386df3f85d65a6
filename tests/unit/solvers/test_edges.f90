!> Edges between ranks take turns that no rank has to keep twice at a time, and contacts find their ranks.
program test_edges
  use harness, only: tests_t
  use sg_edges, only: colour_edges
  use sg_kinds, only: wp, i4
  use sg_owners, only: contact_owner
  use sg_random, only: random_t
  implicit none
  type(tests_t) :: t

  call test_by_hand()
  call test_random()
  call test_owners()
  call t%finish()

contains

  !> No edges, one edge, a chain, all pairs of four ranks.
  subroutine test_by_hand()
    integer :: none(2, 0)

    call t%equal(size(colour_edges(none, 3)), 0, 'no edges')
    call check_colours(reshape([0, 1], [2, 1]), 2, 'one edge')
    call check_colours(reshape([0, 1, 1, 2, 2, 3], [2, 3]), 4, 'a chain')
    call t%equal(maxval(colour_edges(reshape([0, 1, 1, 2, 2, 3], [2, 3]), 4)), 2, 'a chain takes turns')
    call check_colours(reshape([0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3], [2, 6]), 4, 'all pairs of four')
  end subroutine test_by_hand

  !> Edges drawn by lot among many ranks, from few to nearly all.
  subroutine test_random()
    integer, parameter :: ranks = 40
    type(random_t) :: random
    integer :: edge(2, ranks*(ranks - 1)/2), a, b, n, draw

    call random%seed(11)
    do draw = 1, 20
      n = 0
      do a = 0, ranks - 2
        do b = a + 1, ranks - 1
          if (random%uniform(0.0_wp, 20.0_wp) > real(draw, wp)) cycle
          n = n + 1
          edge(:, n) = [a, b]
        end do
      end do
      call check_colours(edge(:, :n), ranks, 'edges by lot')
    end do
  end subroutine test_random

  !> No rank has two edges of one colour; fewer colours than twice the edges of a rank.
  subroutine check_colours(edge, ranks, name)
    integer, intent(in) :: edge(:, :), ranks
    character(len=*), intent(in) :: name
    integer :: colour(size(edge, 2)), uses, degree, most, r, c

    colour = colour_edges(edge, ranks)
    uses = 0
    most = 0
    do r = 0, ranks - 1
      degree = count(edge == r)
      most = max(most, degree)
      do c = 1, maxval(colour)
        uses = max(uses, count(colour == c .and. (edge(1, :) == r .or. edge(2, :) == r)))
      end do
    end do
    call t%equal(uses, 1, name//': one edge of a rank a colour')
    call t%check(minval(colour) == 1 .and. maxval(colour) <= 2*most - 1, name//': few colours')
  end subroutine check_colours

  !> The owner of a contact does not depend on which body is named first; of all pairs of ranks each owns about half of its own.
  subroutine test_owners()
    integer, parameter :: ranks = 16
    integer :: owned(0:ranks - 1)
    integer(i4) :: a, b

    owned = 0
    do a = 0, ranks - 1
      call t%equal(contact_owner([a, a]), int(a), 'inner contacts stay with their owner')
      call t%equal(contact_owner([a, -1_i4]), int(a), 'a wall is touched by its grain')
      call t%equal(contact_owner([-1_i4, a]), int(a), 'whichever is named first')
      do b = 0, ranks - 1
        call t%equal(contact_owner([a, b]), contact_owner([b, a]), 'owners are symmetric')
        call t%check(any(contact_owner([a, b]) == [a, b]), 'one of the two owns')
        if (a < b) owned(contact_owner([a, b])) = owned(contact_owner([a, b])) + 1
      end do
    end do
    call t%equal(contact_owner([-1_i4, -1_i4]), 0, 'between walls')
    ! 15 pairs per rank, of which half are its own.
    call t%check(all(owned >= 7 .and. owned <= 8), 'owners are even')
  end subroutine test_owners
end program test_edges
