!> Overlap areas of all pairs of shapes against closed forms, series for tiny penetrations, and integration by strips.
program test_overlap
  use harness, only: tests_t
  use sg_kinds, only: wp, pi
  use sg_overlap, only: overlap_disk_disk, overlap_disk_hollow, overlap_disk_polygon, overlap_disk_segment, &
                        overlap_polygon_polygon, overlap_polygon_segment
  use sg_random, only: random_t
  implicit none
  !> Some tens of roundings of areas of order 1
  real(wp), parameter :: tight = 1e-13_wp
  real(wp), parameter :: zero(2) = [0.0_wp, 0.0_wp], x_axis(2) = [1.0_wp, 0.0_wp]
  type(tests_t) :: t

  call test_disks()
  call test_tiny_penetrations()
  call test_lenses()
  call test_disk_polygon()
  call test_polygons()
  call test_walls()
  call test_against_strips()
  call test_awkward_places()
  call t%finish()

contains

  subroutine test_disks()
    ! Unit disks a radius apart share 2 pi/3 - sqrt(3)/2.
    call t%near(overlap_disk_disk([1.0_wp, 0.0_wp], 1.0_wp, zero, 1.0_wp), 2*pi/3 - sqrt(3.0_wp)/2, tight, 'lens')
    call t%near(overlap_disk_disk([0.5_wp, 0.3_wp], 0.2_wp, zero, 1.0_wp), pi*0.04_wp, tight, 'disk in a disk')
    call t%near(overlap_disk_disk([0.5_wp, 0.3_wp], 2.0_wp, zero, 1.0_wp), pi, tight, 'disk about a disk')
    call t%near(overlap_disk_disk([2.1_wp, 0.0_wp], 1.0_wp, zero, 1.0_wp), 0.0_wp, 0.0_wp, 'disks apart')
    call t%near(overlap_disk_hollow([1.0_wp, 0.0_wp], 1.0_wp, zero, 1.0_wp), pi/3 + sqrt(3.0_wp)/2, tight, 'crescent')
    call t%near(overlap_disk_hollow([0.5_wp, 0.0_wp], 0.4_wp, zero, 1.0_wp), 0.0_wp, 0.0_wp, 'disk held')
    call t%near(overlap_disk_hollow([3.0_wp, 0.0_wp], 0.5_wp, zero, 1.0_wp), pi/4, tight, 'disk outside')
    call t%near(overlap_disk_hollow([0.1_wp, 0.0_wp], 2.0_wp, zero, 1.0_wp), 3*pi, tight, 'disk about the hollow disk')
  end subroutine test_disks

  !> A penetration d of two disks, of which the radii r and s make m = r s/(r + s): the area tends to
  !! (4/3) sqrt(2 m) d**(3/2), with a relative error of order d. Powers of two keep d exact.
  subroutine test_tiny_penetrations()
    real(wp), parameter :: r = 1.0_wp, s = 0.5_wp
    real(wp) :: d, box(2, 4), lens, half_plane
    integer :: i

    box = reshape([-3.0_wp, -2.0_wp, 3.0_wp, -2.0_wp, 3.0_wp, 0.0_wp, -3.0_wp, 0.0_wp], [2, 4])
    do i = 6, 11
      d = 2.0_wp**(-3*i)
      lens = 4*sqrt(2*r*s/(r + s))*d*sqrt(d)/3
      half_plane = 4*sqrt(2*r)*d*sqrt(d)/3
      call t%near(overlap_disk_disk([r + s - d, 0.0_wp], r, zero, s)/lens, 1.0_wp, 3*d + 1e-12_wp, 'thin lens')
      call t%near(overlap_disk_hollow([0.0_wp, r - s + d], s, zero, r)/(4*sqrt(2*r*s/(r - s))*d*sqrt(d)/3), 1.0_wp, &
                  3*d + 1e-12_wp, 'thin crescent')
      ! Points of the outline are rounded to 1e-16 over a width of sqrt(8 d): relative error 1e-16/d.
      call t%near(overlap_disk_polygon([0.2_wp, r - d], r, 4, box, zero)/half_plane, 1.0_wp, 3*d + 3e-16_wp/d, &
                  'thin segment below an edge')
      call t%near(overlap_disk_segment([0.2_wp, r + 0.5_wp - d], r, zero, x_axis, 2.0_wp, 0.5_wp)/half_plane, 1.0_wp, &
                  3*d + 3e-16_wp/d, 'thin segment below a flat side')
      call t%near(overlap_disk_segment([2 + r + s - d, 0.0_wp], r, zero, x_axis, 2.0_wp, s)/lens, 1.0_wp, 3*d + 3e-16_wp/d, &
                  'thin lens at a cap')
      call t%near(overlap_polygon_segment(4, box, [0.0_wp, 0.5_wp - d], x_axis, 1.0_wp, 0.5_wp)/(2*d), 1.0_wp, &
                  2*sqrt(d), 'thin strip below a flat side')
      call t%near(overlap_polygon_polygon(4, box, 4, box, [0.0_wp, 2 - d])/(6*d), 1.0_wp, 3e-16_wp/d, 'thin strip of boxes')
    end do
  end subroutine test_tiny_penetrations

  !> Lenses of penetrations about the one from which they are computed by angles instead of a series, by the usual arc cosines.
  subroutine test_lenses()
    real(wp), parameter :: r = 1.0_wp, s = 0.5_wp
    real(wp) :: distance, x, y, lens
    integer :: i

    do i = 1, 60
      distance = r + s - 0.001_wp*real(i, wp)
      x = (distance**2 + r**2 - s**2)/(2*distance)
      y = (distance**2 + s**2 - r**2)/(2*distance)
      lens = r**2*acos(x/r) + s**2*acos(y/s) - distance*sqrt(r**2 - x**2)
      call t%near(overlap_disk_disk([0.6_wp*distance, 0.8_wp*distance], r, zero, s), lens, tight, 'lens by arc cosines')
    end do
  end subroutine test_lenses

  subroutine test_disk_polygon()
    real(wp) :: box(2, 4)

    box = reshape([0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 4.0_wp, 4.0_wp, 0.0_wp, 4.0_wp], [2, 4])
    call t%near(overlap_disk_polygon([2.0_wp, 2.0_wp], 1.0_wp, 4, box, zero), pi, tight, 'disk in a box')
    call t%near(overlap_disk_polygon([2.0_wp, 2.0_wp], 3.0_wp, 4, box, zero), 16.0_wp, tight, 'box in a disk')
    call t%near(overlap_disk_polygon(zero, 1.0_wp, 4, box, zero), pi/4, tight, 'disk on a corner')
    call t%near(overlap_disk_polygon([10.0_wp, 0.0_wp], 1.0_wp, 4, box, [10.0_wp, 0.0_wp]), pi/4, tight, 'on an image')
    call t%near(overlap_disk_polygon([2.0_wp, 0.0_wp], 1.0_wp, 4, box, zero), pi/2, tight, 'disk on an edge')
    call t%near(overlap_disk_polygon([-0.8_wp, -0.8_wp], 1.0_wp, 4, box, zero), 0.0_wp, 0.0_wp, 'disk off a corner')
    call t%near(overlap_disk_polygon([2.0_wp, 2.0_wp], sqrt(5.0_wp), 4, box, zero), &
                5*pi - 4*5*(atan(0.5_wp) - 0.4_wp), 10*tight, 'disk over all four edges')
  end subroutine test_disk_polygon

  subroutine test_polygons()
    integer, parameter :: n = 40
    real(wp) :: box(2, 4), triangle(2, 3), half_plane(2, 4), round(2, n), turned(2, n), step, inner
    integer :: i

    box = reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
    triangle = reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 2.0_wp], [2, 3])
    call t%near(overlap_polygon_polygon(4, box, 4, box, zero), 2.0_wp, tight, 'coincident boxes')
    call t%near(overlap_polygon_polygon(4, box, 4, box, [0.5_wp, 0.25_wp]), 1.125_wp, tight, 'shifted boxes')
    call t%near(overlap_polygon_polygon(4, box, 4, box, [2.0_wp, 0.0_wp]), 0.0_wp, 0.0_wp, 'boxes side by side')
    call t%near(overlap_polygon_polygon(4, box, 4, box, [5.0_wp, 0.0_wp]), 0.0_wp, 0.0_wp, 'boxes apart')
    call t%near(overlap_polygon_polygon(4, box, 3, triangle, zero), 1.5_wp, tight, 'box and triangle')
    call t%near(overlap_polygon_polygon(3, triangle, 4, box, zero), 1.5_wp, tight, 'triangle and box')

    ! Many vertices: a regular polygon with itself, cut in half, and with itself turned by half an edge, which leaves a regular
    ! polygon of twice as many edges at the same distance from the centre.
    step = 2*pi/real(n, wp)
    round = reshape([(cos(step*real(i, wp)), sin(step*real(i, wp)), i=1, n)], [2, n])
    turned = reshape([(cos(step*(real(i, wp) + 0.5_wp)), sin(step*(real(i, wp) + 0.5_wp)), i=1, n)], [2, n])
    half_plane = reshape([0.0_wp, -9.0_wp, 9.0_wp, -9.0_wp, 9.0_wp, 9.0_wp, 0.0_wp, 9.0_wp], [2, 4])
    inner = cos(step/2)
    call t%near(overlap_polygon_polygon(n, round, n, round, zero), real(n, wp)/2*sin(step), 10*tight, 'coincident polygons')
    call t%near(overlap_polygon_polygon(n, round, 4, half_plane, zero), real(n, wp)/4*sin(step), 10*tight, 'half a polygon')
    call t%near(overlap_polygon_polygon(n, round, n, turned, zero), 2*real(n, wp)*inner**2*tan(step/4), 10*tight, 'turned polygons')
  end subroutine test_polygons

  subroutine test_walls()
    real(wp) :: box(2, 4)

    call t%near(overlap_disk_segment(zero, 5.0_wp, zero, x_axis, 1.0_wp, 0.5_wp), 2 + pi/4, 10*tight, 'wall in a disk')
    call t%near(overlap_disk_segment([0.3_wp, 0.1_wp], 0.2_wp, zero, x_axis, 1.0_wp, 0.5_wp), pi*0.04_wp, tight, 'disk in a wall')
    call t%near(overlap_disk_segment([1.6_wp, 1.0_wp], 0.5_wp, zero, x_axis, 1.0_wp, 0.5_wp), 0.0_wp, 0.0_wp, 'disk off a cap')
    call t%near(overlap_disk_segment([1.0_wp, 0.0_wp], 0.5_wp, zero, x_axis, 1.0_wp, 0.5_wp), pi/4, tight, 'disk on a cap')
    call t%near(overlap_disk_segment([1.0_wp, 0.0_wp], 1.0_wp, zero, x_axis, 0.0_wp, 1.0_wp), &
                2*pi/3 - sqrt(3.0_wp)/2, 10*tight, 'wall of no length is a disk')
    box = reshape([-9.0_wp, -9.0_wp, 9.0_wp, -9.0_wp, 9.0_wp, 9.0_wp, -9.0_wp, 9.0_wp], [2, 4])
    call t%near(overlap_polygon_segment(4, box, [1.0_wp, 2.0_wp], [0.6_wp, 0.8_wp], 1.0_wp, 0.5_wp), 2 + pi/4, 10*tight, &
                'wall in a box')
    call t%near(overlap_polygon_segment(4, box, [9.0_wp, 2.0_wp], x_axis, 0.0_wp, 0.5_wp), pi/8, 10*tight, &
                'half a wall of no length')
  end subroutine test_walls

  !> Random pairs of all kinds against the lengths that 20000 horizontal lines have in both shapes. Where an outline
  !! ends within a strip, 4e-4 high, the rule of midpoints errs by up to half its width there: at round ends
  !! step**1.5 = 8e-6, twice, and seldom more at edges that are nearly level.
  subroutine test_against_strips()
    real(wp), parameter :: near = 3e-5_wp
    type(random_t) :: random
    real(wp) :: a(2, 5), c(2, 6), p(2), q(2), r, s, axis(2), angle
    integer :: i

    call random%seed(8)
    do i = 1, 100
      p = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
      q = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
      r = random%uniform(0.1_wp, 1.5_wp)
      s = random%uniform(0.1_wp, 1.5_wp)
      angle = random%uniform(0.0_wp, 2*pi)
      axis = [cos(angle), sin(angle)]
      call random_polygon(random, a)
      call random_polygon(random, c)
      c = c + spread(p, 2, size(c, 2))
      call t%near(overlap_disk_disk(p, r, q, s), strips(disk=[p, r], other=[q, s]), near, 'disks by strips')
      call t%near(overlap_disk_polygon(p, r, 5, a, q), strips(disk=[p, r], polygon=a + spread(q, 2, 5)), near, &
                  'disk and polygon by strips')
      call t%near(overlap_polygon_polygon(6, c, 5, a, q), strips(polygon=a + spread(q, 2, 5), other_polygon=c), near, &
                  'polygons by strips')
      call t%near(overlap_disk_segment(p, r, q, axis, 0.6_wp, 0.3_wp), strips(disk=[p, r], wall=[q, 0.6_wp*axis, 0.3_wp]), near, &
                  'disk and wall by strips')
      call t%near(overlap_polygon_segment(6, c, q, axis, 0.6_wp, 0.3_wp), &
                  strips(polygon=c, wall=[q, 0.6_wp*axis, 0.3_wp]), near, 'polygon and wall by strips')
    end do
  end subroutine test_against_strips

  !> Circles through corners, centres on corners and edges, tangent lines: areas between nothing and the smaller shape,
  !! and the parts of a disk cut by a lattice add up.
  subroutine test_awkward_places()
    real(wp), parameter :: sizes(5) = [0.5_wp, 1.0_wp, sqrt(2.0_wp), 1.5_wp, 2.0_wp]
    real(wp) :: box(2, 4), centre(2), sum_of_parts
    integer :: i, j, k, m

    box = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
    do i = 0, 4
      do j = 0, 4
        do k = 1, size(sizes)
          centre = 0.25_wp*real([i, j], wp)
          sum_of_parts = 0
          do m = 0, 35
            sum_of_parts = sum_of_parts + overlap_disk_polygon(centre, sizes(k), 4, box, real([modulo(m, 6), m/6] - 3, wp) + 0.5_wp)
          end do
          ! The 36 boxes cover -2.5 to 3.5, more than the largest disk.
          call t%near(sum_of_parts, pi*sizes(k)**2, 10*tight, 'a disk cut by a lattice')
          call check_bounded(overlap_disk_segment(centre, sizes(k), zero, x_axis, 1.0_wp, 0.5_wp), &
                             min(pi*sizes(k)**2, 2 + pi/4), 'disk and wall')
          call check_bounded(overlap_disk_segment(centre, sizes(k), zero, x_axis, 1.0_wp, 0.0_wp), 0.0_wp, 'wall of no thickness')
          call check_bounded(overlap_polygon_segment(4, box, centre, x_axis, sizes(k), 0.25_wp), 1.0_wp, 'box and wall')
          call check_bounded(overlap_disk_hollow(centre, sizes(k), zero, sizes(k)), pi*sizes(k)**2, 'disk and hollow disk')
        end do
      end do
    end do
  end subroutine test_awkward_places

  !> Check that an area is between nothing and a bound.
  subroutine check_bounded(area, bound, what)
    real(wp), intent(in) :: area, bound
    character(len=*), intent(in) :: what

    call t%check(area >= 0 .and. area <= bound + 10*tight, what//': area within bounds')
  end subroutine check_bounded

  !> Area shared by the shapes given, as the sum over horizontal lines of the length that lies in all of them.
  real(wp) function strips(disk, other, polygon, other_polygon, wall) result(area)
    real(wp), intent(in), optional :: disk(3), other(3) !! centre and radius
    real(wp), intent(in), optional :: polygon(:, :), other_polygon(:, :) !! vertices
    real(wp), intent(in), optional :: wall(5) !! centre, half axis, half thickness
    integer, parameter :: n = 20000
    real(wp), parameter :: top = 4
    real(wp) :: range(2), y, ends(2, 2), flat(2, 4)
    integer :: i

    area = 0
    do i = 1, n
      y = top*(2*real(i, wp) - 1 - n)/n
      range = [-huge(y), huge(y)]
      if (present(disk)) range = common(range, of_disk(disk, y))
      if (present(other)) range = common(range, of_disk(other, y))
      if (present(polygon)) range = common(range, of_polygon(polygon, y))
      if (present(other_polygon)) range = common(range, of_polygon(other_polygon, y))
      if (present(wall)) then
        ends(:, 1) = wall(1:2) - wall(3:4)
        ends(:, 2) = wall(1:2) + wall(3:4)
        associate (up => wall(5)/norm2(wall(3:4))*[-wall(4), wall(3)])
          flat = reshape([ends(:, 1) - up, ends(:, 2) - up, ends(:, 2) + up, ends(:, 1) + up], [2, 4])
        end associate
        range = common(range, hull(of_polygon(flat, y), hull(of_disk([ends(:, 1), wall(5)], y), &
                                                             of_disk([ends(:, 2), wall(5)], y))))
      end if
      area = area + max(0.0_wp, range(2) - range(1))*2*top/n
    end do
  end function strips

  !> Part of a horizontal line inside a disk; empty where the second number is not above the first.
  pure function of_disk(disk, y) result(range)
    real(wp), intent(in) :: disk(3), y
    real(wp) :: range(2), half

    half = disk(3)**2 - (y - disk(2))**2
    range = [9.0_wp, -9.0_wp]
    if (half > 0) range = disk(1) + [-sqrt(half), sqrt(half)]
  end function of_disk

  !> Part of a horizontal line inside a convex polygon.
  pure function of_polygon(polygon, y) result(range)
    real(wp), intent(in) :: polygon(:, :), y
    real(wp) :: range(2), x, a(2), b(2)
    integer :: i

    range = [9.0_wp, -9.0_wp]
    do i = 1, size(polygon, 2)
      a = polygon(:, i)
      b = polygon(:, modulo(i, size(polygon, 2)) + 1)
      if ((a(2) > y) .eqv. (b(2) > y)) cycle
      x = a(1) + (y - a(2))/(b(2) - a(2))*(b(1) - a(1))
      range = [min(range(1), x), max(range(2), x)]
    end do
  end function of_polygon

  !> What two ranges share.
  pure function common(a, b)
    real(wp), intent(in) :: a(2), b(2)
    real(wp) :: common(2)

    common = [max(a(1), b(1)), min(a(2), b(2))]
  end function common

  !> The range over two ranges that meet.
  pure function hull(a, b)
    real(wp), intent(in) :: a(2), b(2)
    real(wp) :: hull(2)

    hull = [min(a(1), b(1)), max(a(2), b(2))]
  end function hull

  !> A random convex polygon: vertices on a circle at angles that grow by random steps.
  subroutine random_polygon(random, vertices)
    type(random_t), intent(inout) :: random
    real(wp), intent(out) :: vertices(:, :)
    real(wp) :: angle
    integer :: i, n

    n = size(vertices, 2)
    do i = 1, n
      angle = 2*pi*(real(i, wp) + random%uniform(-0.4_wp, 0.4_wp))/real(n, wp)
      vertices(:, i) = [cos(angle), sin(angle)]
    end do
  end subroutine random_polygon
end program test_overlap
