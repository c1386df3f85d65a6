!> Convex polyhedra that are made rather than given: hulls, boxes and random ones.
module sg_polyhedron_make
  use sg_convex_hull, only: convex_hull, find_spanning
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, i8
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces
  use sg_polyhedron_checks, only: length_tolerance, most_faces
  use sg_polyhedron_moments, only: polyhedron_solid, solid_t
  use sg_random, only: random_t
  use sg_sorting, only: sort_permutation
  use sg_text, only: to_text
  use sg_welding, only: weld
  implicit none
  private
  public :: hull_polyhedron, box_polyhedron, random_polyhedron
  public :: move_polyhedron, centre_polyhedron, most_vertices

  !> Most vertices of a hull: n of them have at most 2 n - 4 faces
  integer, parameter :: most_vertices = most_faces/2 + 2
  !> Points tried for each vertex of a random polyhedron, of which that farthest from the others is taken
  integer, parameter :: tries_of_vertex = 4
  !> Distance from the centre to the faces of a random polyhedron in a unit ball below which it is a splinter
  real(wp), parameter :: least_depth = 0.15_wp
  integer, parameter :: most_tries = 1000
  !> Points from which on a hull is built up from within at once: of a million that are all extreme that takes a tenth of
  !> the time
  integer, parameter :: few_points = 20000

contains

  !> The convex hull of points, with fewer vertices where it has too many.
  !!
  !! Then, and where the points are very many, the hull is built up from within: from a tetrahedron on, the points that
  !! stand out farthest of the faces so far are added, until none does by more than the tolerance of lengths, or the
  !! vertices are used up.
  subroutine hull_polyhedron(points, shape, error, at_most, deviation)
    real(wp), intent(in) :: points(:, :) !! [m], shape (3, points)
    type(polyhedron_t), intent(out) :: shape !! hull in the frame of the points
    type(error_t), allocatable, intent(out) :: error !! set when there is no hull with a volume
    integer, intent(in), optional :: at_most !! most vertices, `most_vertices` when absent or larger
    real(wp), intent(out), optional :: deviation !! how far points stand out of the shape at most [m]
    real(wp), allocatable :: corners(:, :), distinct_points(:, :)
    integer(i4), allocatable :: first(:), corner(:), kept(:), same(:)
    real(wp) :: out
    integer :: most, spanning(4), i

    if (present(deviation)) deviation = 0
    most = most_vertices
    if (present(at_most)) most = min(most, at_most)
    if (most < 4) then
      call fail(error, 'a polyhedron needs 4 vertices or more, and '//to_text(most)//' are allowed')
      return
    end if
    call find_spanning(points, spanning, error)
    if (allocated(error)) return
    ! Points all but equal are made one first: between them a hull has faces that would come to nothing later.
    call weld(points, length_tolerance(points), same)
    distinct_points = points(:, pack([(int(i, i4), i=1, size(same))], same == [(int(i, i4), i=1, size(same))]))
    if (size(distinct_points, 2) <= few_points) then
      call convex_hull(distinct_points, first, corner, error)
      if (allocated(error)) return
      if (size(distinct(corner, size(distinct_points, 2))) <= most) then
        call polyhedron_from_faces(distinct_points, first, corner, shape, error)
        return
      end if
    end if
    call choose_vertices(distinct_points, most, kept, out, error)
    if (allocated(error)) return
    if (present(deviation)) deviation = out
    corners = distinct_points(:, kept)
    call convex_hull(corners, first, corner, error)
    if (.not. allocated(error)) call polyhedron_from_faces(corners, first, corner, shape, error)
  end subroutine hull_polyhedron

  !> The numbers that occur in a list, each once, growing.
  pure function distinct(list, largest) result(numbers)
    integer(i4), intent(in) :: list(:)
    integer, intent(in) :: largest
    integer(i4), allocatable :: numbers(:)
    logical, allocatable :: occurs(:)
    integer :: i

    allocate (occurs(largest))
    occurs = .false.
    occurs(list) = .true.
    numbers = pack([(int(i, i4), i=1, largest)], occurs)
  end function distinct

  !> Choose the points whose hull comes nearest to that of all.
  subroutine choose_vertices(points, most, chosen, out, error)
    real(wp), intent(in) :: points(:, :)
    integer, intent(in) :: most
    integer(i4), allocatable, intent(out) :: chosen(:)
    real(wp), intent(out) :: out
    type(error_t), allocatable, intent(out) :: error
    integer(i4), allocatable :: first(:), corner(:), order(:), far(:)
    integer(i8), allocatable :: keys(:)
    real(wp), allocatable :: height(:)
    real(wp) :: tolerance
    integer :: n_more, spanning(4)

    call find_spanning(points, spanning, error)
    if (allocated(error)) return
    tolerance = length_tolerance(points)
    chosen = int(spanning, i4)
    do
      call convex_hull(points(:, chosen), first, corner, error)
      if (allocated(error)) return
      corner = chosen(corner)
      call farthest_out(points, first, corner, far, height)
      out = max(0.0_wp, maxval(height))
      if (out <= tolerance .or. size(chosen) >= most) exit
      where (height <= tolerance) height = 0
      allocate (keys(size(height)))
      ! The bits of a positive real grow with it; sorting takes 55 of them.
      keys = shiftr(huge(keys) - transfer(height, 0_i8, size(height)), 10)
      order = sort_permutation(keys)
      deallocate (keys)
      ! At most as many as there are: those that stand out farthest, before the new faces change the order.
      n_more = min(most - size(chosen), size(chosen), count(height > 0))
      chosen = distinct([chosen, far(order(:n_more))], size(points, 2))
    end do
  end subroutine choose_vertices

  !> Of each face of a hull the point that stands out farthest, each point once, and how far [m].
  subroutine farthest_out(points, first, corner, far, height)
    real(wp), intent(in) :: points(:, :)
    integer(i4), intent(in) :: first(:), corner(:)
    integer(i4), allocatable, intent(out) :: far(:)
    real(wp), allocatable, intent(out) :: height(:)
    real(wp), allocatable :: highest(:)
    real(wp) :: a(3), b(3), normal(3), h, top
    integer :: f, i, k, best

    allocate (highest(size(points, 2)))
    highest = 0
    do f = 1, size(first) - 1
      normal = 0
      do k = first(f) + 1, first(f + 1) - 2
        a = points(:, corner(k)) - points(:, corner(first(f)))
        b = points(:, corner(k + 1)) - points(:, corner(first(f)))
        normal = normal + [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
      end do
      if (.not. norm2(normal) > tiny(h)) cycle
      normal = normal/norm2(normal)
      a = points(:, corner(first(f)))
      top = 0
      best = corner(first(f))
      do i = 1, size(points, 2)
        h = (points(1, i) - a(1))*normal(1) + (points(2, i) - a(2))*normal(2) + (points(3, i) - a(3))*normal(3)
        if (h <= top) cycle
        top = h
        best = i
      end do
      highest(best) = max(highest(best), top)
    end do
    ! The corners of the hull themselves stand out of nothing.
    highest(corner) = 0
    far = pack([(int(i, i4), i=1, size(points, 2))], highest > 0)
    height = highest(far)
    if (size(far) > 0) return
    far = corner(1:1)
    height = [0.0_wp]
  end subroutine farthest_out

  !> A box about the origin, its sides along the axes.
  subroutine box_polyhedron(half_sizes, shape, error)
    real(wp), intent(in) :: half_sizes(3) !! half lengths of the sides [m]
    type(polyhedron_t), intent(out) :: shape !! box
    type(error_t), allocatable, intent(out) :: error !! set when a half length is not positive, or far smaller than another
    integer(i4), parameter :: corners(24) = int([1, 3, 4, 2, 5, 6, 8, 7, 1, 2, 6, 5, 3, 7, 8, 4, 1, 5, 7, 3, 2, 4, 8, 6], i4)
    real(wp) :: vertices(3, 8)
    integer :: i

    if (.not. all(half_sizes > 0)) then
      call fail(error, 'the half sizes of a box must be positive')
      return
    end if
    do i = 0, 7
      vertices(:, i + 1) = half_sizes*real([2*mod(i, 2) - 1, 2*mod(i/2, 2) - 1, 2*(i/4) - 1], wp)
    end do
    call polyhedron_from_faces(vertices, [(int(4*i + 1, i4), i=0, 6)], corners, shape, error)
  end subroutine box_polyhedron

  !> A random convex polyhedron, such as a grain of ballast: its vertices lie on an ellipsoid about the origin.
  !!
  !! They are drawn on the unit sphere, each as far from the others as the best of a few tries, so that none is lost when
  !! they are made into a hull and edges are not much shorter than others; splinters are drawn again.
  subroutine random_polyhedron(n_vertices, half_axes, random, shape, error)
    integer, intent(in) :: n_vertices !! 4 to `most_vertices`
    real(wp), intent(in) :: half_axes(3) !! of the ellipsoid: size and elongation [m]
    type(random_t), intent(inout) :: random !! stream of random numbers
    type(polyhedron_t), intent(out) :: shape !! polyhedron
    type(error_t), allocatable, intent(out) :: error !! set when the numbers make none, or there are no hulls in this build
    real(wp), allocatable :: points(:, :)
    integer(i4), allocatable :: first(:), corner(:)
    integer :: try, i

    if (n_vertices < 4 .or. n_vertices > most_vertices) then
      call fail(error, 'a random polyhedron has 4 to '//to_text(most_vertices)//' vertices, not '//to_text(n_vertices))
      return
    else if (.not. all(half_axes > 0)) then
      call fail(error, 'the half axes of a random polyhedron must be positive')
      return
    end if
    allocate (points(3, n_vertices))
    do try = 1, most_tries
      call spread_points(points, random)
      call convex_hull(points, first, corner, error)
      if (allocated(error)) return
      if (least_distance(points, first, corner) >= least_depth) exit
    end do
    ! What is convex stays so when it is stretched.
    do i = 1, n_vertices
      points(:, i) = half_axes*points(:, i)
    end do
    call polyhedron_from_faces(points, first, corner, shape, error)
  end subroutine random_polyhedron

  !> Random points of the unit sphere, not too near to each other.
  subroutine spread_points(points, random)
    real(wp), intent(out) :: points(:, :)
    type(random_t), intent(inout) :: random
    real(wp) :: point(3), distance, best
    integer :: i, k, try

    do i = 1, size(points, 2)
      best = -1
      do try = 1, tries_of_vertex
        do k = 1, 3
          point(k) = random%normal()
        end do
        if (.not. norm2(point) > 0) cycle
        point = point/norm2(point)
        distance = 4
        do k = 1, i - 1
          distance = min(distance, sum((points(:, k) - point)**2))
        end do
        if (distance <= best) cycle
        best = distance
        points(:, i) = point
      end do
    end do
  end subroutine spread_points

  !> Least distance from the origin to the planes of faces, negative when it is outside [m].
  pure real(wp) function least_distance(points, first, corner) result(least)
    real(wp), intent(in) :: points(:, :)
    integer(i4), intent(in) :: first(:), corner(:)
    real(wp) :: a(3), b(3), normal(3)
    integer :: f

    least = huge(least)
    do f = 1, size(first) - 1
      a = points(:, corner(first(f) + 1)) - points(:, corner(first(f)))
      b = points(:, corner(first(f) + 2)) - points(:, corner(first(f)))
      normal = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
      least = min(least, dot_product(normal, points(:, corner(first(f))))/max(norm2(normal), tiny(least)))
    end do
  end function least_distance

  !> Describe a polyhedron in another frame.
  pure subroutine move_polyhedron(shape, origin, frame)
    type(polyhedron_t), intent(inout) :: shape !! polyhedron; its vertices, normals and radius change
    real(wp), intent(in) :: origin(3) !! of the new frame, in the present one [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: the new axes in the present frame
    integer :: i

    do i = 1, shape%n_vertices
      shape%vertex(:, i) = matmul(shape%vertex(:, i) - origin, frame)
    end do
    do i = 1, shape%n_faces
      shape%normal(:, i) = matmul(shape%normal(:, i), frame)
    end do
    shape%reach = maxval(norm2(shape%vertex, 1))
  end subroutine move_polyhedron

  !> Put the origin of a polyhedron's frame at its centre of mass.
  pure subroutine centre_polyhedron(shape, centre)
    type(polyhedron_t), intent(inout) :: shape !! polyhedron
    real(wp), intent(out) :: centre(3) !! where the centre of mass was [m]
    type(solid_t) :: solid
    real(wp), parameter :: same(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

    solid = polyhedron_solid(shape)
    centre = solid%centre
    call move_polyhedron(shape, centre, same)
  end subroutine centre_polyhedron
end module sg_polyhedron_make
