!> Overlaps at the start against brute force over all pairs and images: random states of every kind of shape, clusters, floors,
!! drums, periods, and pairs dealt out to ranks.
program test_start_overlaps
  use harness, only: tests_t
  use rank_parts, only: draw_owners, plane_scene, shake, space_scene
  use sg_blocks, only: deck_t
  use sg_contactors, only: place_contactors
  use sg_kinds, only: wp, i4
  use sg_near, only: candidate_first, has_one_image
  use sg_pair_gap, only: pair_gap
  use sg_random, only: random_t
  use sg_scene, only: scene_t
  use sg_sees, only: see_between
  use sg_start_overlaps, only: find_overlaps, overlaps_t
  implicit none
  type(tests_t) :: t
  type(random_t) :: random
  integer :: round

  call random%seed(1500)
  do round = 1, 6
    call test_state(2, is_periodic=modulo(round, 2) == 0, name='plane')
    call test_state(3, is_periodic=modulo(round, 2) == 0, name='space')
  end do
  call t%finish()

contains

  !> One random state.
  subroutine test_state(dimension, is_periodic, name)
    integer, intent(in) :: dimension
    logical, intent(in) :: is_periodic
    character(len=*), intent(in) :: name
    integer, parameter :: ranks = 3, n = 99
    type(scene_t) :: scene
    type(overlaps_t) :: found, of_rank
    type(deck_t) :: deck
    integer :: r, total
    real(wp), allocatable :: before(:, :)

    if (dimension == 2) call plane_scene(scene, n)
    if (dimension == 3) call space_scene(scene, n)
    if (.not. is_periodic) scene%period = 0
    if (.not. is_periodic) scene%period_y = 0
    call shake(scene, random)
    ! What is no grain may lie outside of the period.
    where (.not. scene%bodies%is_grain) scene%bodies%position(1, :) = scene%bodies%position(1, :) - 13
    before = scene%bodies%position
    call find_overlaps(scene, 0, deck, found)
    call t%check(all(abs(scene%bodies%position - before) <= 0), name//': no body moves')
    call t%check(found%n > 20, name//': there are overlaps')
    call compare(scene, found, name)
    call draw_owners(scene, ranks, random, scene%bodies%owner)
    total = 0
    do r = 0, ranks - 1
      of_rank = overlaps_t()
      call find_overlaps(scene, r, deck, of_rank)
      total = total + of_rank%n
    end do
    call t%equal(total, found%n, name//': each overlap belongs to one rank')
  end subroutine test_state

  !> As many as over all pairs and images, and the deepest is the deepest.
  subroutine compare(scene, found, name)
    type(scene_t), intent(inout) :: scene
    type(overlaps_t), intent(in) :: found
    character(len=*), intent(in) :: name
    integer :: i, j, x, y, n, most(2)
    real(wp) :: share, deepest

    call place_contactors(scene%contactors, scene%bodies%middle)
    most = merge(4, 0, [scene%period, scene%period_y] > 0)
    n = 0
    deepest = 0
    do i = 2, scene%contactors%n
      do j = 1, i - 1
        do x = -most(1), most(1)
          do y = -most(2), most(2)
            share = share_of(scene, merge([i, j], [j, i], candidate_first(scene%contactors, i, j)), int([x, y], i4))
            if (share <= 1e-4_wp) cycle
            n = n + 1
            deepest = max(deepest, share)
          end do
        end do
      end do
    end do
    call t%equal(found%n, n, name//': as many overlaps as over all pairs')
    call t%near(found%share(1), deepest, 1e-12_wp*deepest, name//': the deepest is the first')
    call t%check(all(found%share(2:) <= found%share(:size(found%share) - 1)), name//': they are sorted')
  end subroutine compare

  !> Depth of a pair over the smaller radius of its grains; 0 where the pair does not count.
  real(wp) function share_of(scene, pair, image) result(share)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: pair(2)
    integer(i4), intent(in) :: image(2)
    real(wp) :: period(2), apart, gap
    integer :: b(2), axis
    logical :: is_single(2)

    share = 0
    b = scene%contactors%body(pair)
    if (b(1) == b(2) .or. .not. any(scene%bodies%is_grain(b)) .or. see_between(scene, pair(1), pair(2)) == 0) return
    period = [scene%period, scene%period_y]
    is_single = has_one_image(scene%contactors, pair(2), period)
    do axis = 1, 2
      if (.not. is_single(axis)) cycle
      apart = scene%contactors%centre(axis, pair(1)) - scene%contactors%centre(axis, pair(2))
      if (image(axis) /= nint(apart/period(axis))) return
    end do
    gap = pair_gap(scene, int(pair, i4), image)
    share = -min(gap, 0.0_wp)/minval(scene%contactors%reach(pair), scene%bodies%is_grain(b))
  end function share_of
end program test_start_overlaps
