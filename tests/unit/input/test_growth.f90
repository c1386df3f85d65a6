!> Samples that grow to a dense fill: no overlap in boxes, through periods and next to other grains; seeds; boxes that are too full.
program test_growth
  use harness, only: tests_t
  use sg_growth, only: grow_in_box
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  implicit none
  type(tests_t) :: t

  call test_plane()
  call test_space()
  call test_next_to_others()
  call test_too_full()
  call t%finish()

contains

  !> Disks in a box and in a period, at a fill that random insertion cannot reach.
  subroutine test_plane()
    real(wp), parameter :: box(4) = [-1.0_wp, 2.0_wp, 0.0_wp, 3.0_wp], none(2, 0) = 0, no_radii(0) = 0
    real(wp), allocatable :: radii(:), points(:, :), again(:, :), other(:, :)
    integer :: n

    call spread_radii(radii, 0.8_wp, 2)
    call grow(2, radii, box, 0.0_wp, [.false.], none, no_radii, 3, points, n)
    call t%equal(n, size(radii), 'all disks have their size')
    call t%check(least_gap(points, radii, [0.0_wp, 0.0_wp]) >= 0, 'no overlap')
    call t%check(all(points(1, :) - radii >= box(1)) .and. all(points(1, :) + radii <= box(3)), 'within the sides')
    call t%check(all(points(2, :) - radii >= box(2)) .and. all(points(2, :) + radii <= box(4)), 'above the bottom, below the top')
    call grow(2, radii, box, 0.0_wp, [.false.], none, no_radii, 3, again, n)
    call t%near(maxval(abs(points - again)), 0.0_wp, 0.0_wp, 'the same seed, the same places')
    call grow(2, radii, box, 0.0_wp, [.false.], none, no_radii, 4, other, n)
    call t%check(maxval(abs(points - other)) > 0.1_wp, 'another seed, other places')
    call spread_radii(radii, 0.7_wp, 2)
    call grow(2, radii, box, 0.002_wp, [.true.], none, no_radii, 5, points, n)
    call t%equal(n, size(radii), 'with a period and a clearance')
    call t%check(least_gap(points, radii, [1.0_wp, 0.0_wp]) >= 0.002_wp*(1 - 1e-12_wp), 'clear of each other through the period')
    call t%check(any(points(1, :) < box(1) + radii .or. points(1, :) > box(3) - radii), 'some go through the sides')
  end subroutine test_plane

  !> Spheres, twice periodic.
  subroutine test_space()
    real(wp), parameter :: box(6) = [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp], none(3, 0) = 0, no_radii(0) = 0
    real(wp), allocatable :: radii(:), points(:, :)
    integer :: n

    call spread_radii(radii, 0.57_wp, 3)
    call grow(3, radii, box, 0.0_wp, [.true., .true.], none, no_radii, 6, points, n)
    call t%equal(n, size(radii), 'all spheres have their size')
    call t%check(least_gap(points, radii, [1.0_wp, 1.0_wp]) >= 0, 'no overlap of spheres')
    call t%check(all(points(3, :) - radii >= 0) .and. all(points(3, :) + radii <= 1), 'between bottom and top')
  end subroutine test_space

  !> Small disks around large ones that stay, one of them behind a side of the box.
  subroutine test_next_to_others()
    real(wp), parameter :: box(4) = [0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
    real(wp), parameter :: there(2, 2) = reshape([0.5_wp, 0.5_wp, -0.1_wp, 0.2_wp], [2, 2]), their_radii(2) = [0.3_wp, 0.2_wp]
    real(wp), allocatable :: radii(:), points(:, :), all_points(:, :)
    integer :: n

    call spread_radii(radii, 0.5_wp, 2)
    call grow(2, radii, box, 0.0_wp, [.false.], there, their_radii, 7, points, n)
    call t%equal(n, size(radii), 'grown next to others')
    allocate (all_points(2, size(radii) + 2))
    all_points(:, :n) = points
    all_points(:, n + 1:) = there
    call t%check(least_gap(all_points, [radii, their_radii], [0.0_wp, 0.0_wp]) >= 0, 'no overlap with others')
  end subroutine test_next_to_others

  !> More than fits, and a grain larger than the box.
  subroutine test_too_full()
    real(wp), parameter :: box(4) = [0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp], none(2, 0) = 0, no_radii(0) = 0
    real(wp), allocatable :: radii(:), points(:, :)
    integer :: n

    call spread_radii(radii, 0.93_wp, 2)
    call grow(2, radii, box, 0.0_wp, [.false.], none, no_radii, 8, points, n)
    call t%equal(n, 0, 'more than fits')
    call grow(2, [0.6_wp], box, 0.0_wp, [.false.], none, no_radii, 8, points, n)
    call t%equal(n, 0, 'a grain larger than the box')
  end subroutine test_too_full

  !> Grow with a seed.
  subroutine grow(d, radii, box, clearance, is_periodic, there, their_radii, seed, points, n)
    integer, intent(in) :: d, seed
    real(wp), intent(in) :: radii(:), box(:), clearance, there(:, :), their_radii(:)
    logical, intent(in) :: is_periodic(:)
    real(wp), allocatable, intent(out) :: points(:, :)
    integer, intent(out) :: n
    type(random_t) :: random

    call random%seed(seed)
    call grow_in_box(random, radii, box, clearance, is_periodic, there, their_radii, points, n)
    call t%equal(size(points, 1), d, 'dimension of points')
  end subroutine grow

  !> Radii from one to two that fill a share of the unit square or cube; in no order.
  subroutine spread_radii(radii, fill, d)
    real(wp), allocatable, intent(out) :: radii(:)
    real(wp), intent(in) :: fill
    integer, intent(in) :: d
    integer, parameter :: n = 300
    integer :: i

    radii = [(1 + modulo(0.618_wp*real(i, wp), 1.0_wp), i=1, n)]
    if (d == 2) then
      radii = radii*sqrt(fill/(pi*sum(radii**2)))
    else
      radii = radii*(fill/(4*pi/3*sum(radii**3)))**(1/3.0_wp)
    end if
  end subroutine spread_radii

  !> Least gap of two circles or spheres, with periods where these are not zero, by all pairs.
  pure real(wp) function least_gap(points, radii, period) result(gap)
    real(wp), intent(in) :: points(:, :), radii(:), period(2)
    real(wp) :: way(size(points, 1))
    integer :: i, j, k

    gap = huge(gap)
    do i = 1, size(radii)
      do j = 1, i - 1
        way = points(:, i) - points(:, j)
        do k = 1, 2
          if (period(k) > 0) way(k) = way(k) - period(k)*anint(way(k)/period(k))
        end do
        gap = min(gap, norm2(way) - radii(i) - radii(j))
      end do
    end do
  end function least_gap
end program test_growth
