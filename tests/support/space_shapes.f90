!> Convex polyhedra for tests, made by trying all planes through three points: slow, and simple enough to be trusted.
module space_shapes
  use random_space, only: random_direction
  use sg_kinds, only: wp, i4, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_random, only: random_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: hull_shape, box_shape, prism_shape, random_shape, scaled_shape

contains

  !> The convex hull of points all of which are corners, coplanar triangles being one face.
  function hull_shape(point) result(shape)
    real(wp), intent(in) :: point(:, :) !! corners [m], shape (3, corner)
    type(polyhedron_t) :: shape
    real(wp) :: normal(3), size2, height(size(point, 2)), flat
    logical :: is_on(size(point, 2), 200)
    integer(i4) :: loop(1000)
    integer :: first(200), n_faces, i, j, k, n, sides

    n = size(point, 2)
    flat = 1e-12_wp
    n_faces = 0
    first(1) = 1
    do i = 1, n
      do j = 1, n
        if (j == i) cycle
        do k = i + 1, n
          if (k == j .or. j < i) cycle
          do sides = -1, 1, 2
            normal = real(sides, wp)*cross(point(:, j) - point(:, i), point(:, k) - point(:, i))
            size2 = sqrt(dot_product(normal, normal))
            if (size2 < flat) cycle
            normal = normal/size2
            height = matmul(normal, point) - dot_product(normal, point(:, i))
            if (maxval(height) > flat) cycle
            if (n_faces > 0) then
              if (any(is_on(i, :n_faces) .and. is_on(j, :n_faces) .and. is_on(k, :n_faces))) cycle
            end if
            n_faces = n_faces + 1
            is_on(:, n_faces) = abs(height) <= flat
            call add_loop(point, normal, is_on(:, n_faces), first(n_faces), loop, first(n_faces + 1))
          end do
        end do
      end do
    end do
    shape%n_vertices = n
    shape%n_faces = n_faces
    allocate (shape%vertex(3, n), shape%face_first(n_faces + 1), shape%face_vertex(first(n_faces + 1) - 1), &
              shape%normal(3, n_faces))
    shape%vertex = point
    shape%face_first = int(first(:n_faces + 1), i4)
    shape%face_vertex = loop(:first(n_faces + 1) - 1)
    call finish_shape(shape)
  end function hull_shape

  !> Add the corners of a face in counter-clockwise order.
  subroutine add_loop(point, normal, is_on, first, loop, next)
    real(wp), intent(in) :: point(:, :), normal(3) !! corners and normal of the face
    logical, intent(in) :: is_on(:) !! is the corner on the face?
    integer, intent(in) :: first !! place of the face in the loop
    integer(i4), intent(inout) :: loop(:) !! corners of the faces
    integer, intent(out) :: next !! place after the face
    real(wp) :: centre(3), u(3), v(3), angle(size(is_on)), way(3)
    integer :: i, k

    do i = 1, 3
      centre(i) = sum(point(i, :), mask=is_on)/real(count(is_on), wp)
    end do
    u = 0
    angle = huge(1.0_wp)
    do i = 1, size(is_on)
      if (.not. is_on(i)) cycle
      way = point(:, i) - centre
      if (all(abs(u) <= 0)) u = way
      v = cross(normal, u)
      angle(i) = atan2(dot_product(way, v), dot_product(way, u))
    end do
    next = first
    do k = 1, count(is_on)
      i = minloc(angle, 1)
      loop(next) = int(i, i4)
      angle(i) = huge(1.0_wp)
      next = next + 1
    end do
  end subroutine add_loop

  !> Edges, normals and reach from vertices and faces.
  subroutine finish_shape(shape)
    type(polyhedron_t), intent(inout) :: shape !! polyhedron with vertices and faces
    integer(i4) :: edge(4, size(shape%face_vertex))
    integer :: f, k, n, p, q, next, last

    n = 0
    do f = 1, shape%n_faces
      last = shape%face_first(f + 1) - 1
      shape%normal(:, f) = 0
      do k = shape%face_first(f), last
        next = merge(int(shape%face_first(f)), k + 1, k == last)
        p = shape%face_vertex(k)
        q = shape%face_vertex(next)
        shape%normal(:, f) = shape%normal(:, f) + cross(shape%vertex(:, p) - shape%vertex(:, shape%face_vertex(last)), &
                                                        shape%vertex(:, q) - shape%vertex(:, shape%face_vertex(last)))
        if (p < q) then
          n = n + 1
          edge(:, n) = [int(p, i4), int(q, i4), int(f, i4), int(other_face(shape, q, p), i4)]
        end if
      end do
      shape%normal(:, f) = shape%normal(:, f)/norm2(shape%normal(:, f))
    end do
    shape%n_edges = n
    if (allocated(shape%edge)) deallocate (shape%edge)
    allocate (shape%edge(4, n))
    shape%edge = edge(:, :n)
    shape%reach = maxval(norm2(shape%vertex, 1))
  end subroutine finish_shape

  !> The face that runs from one vertex to another.
  integer function other_face(shape, p, q) result(f)
    type(polyhedron_t), intent(in) :: shape !! polyhedron
    integer, intent(in) :: p, q !! vertices
    integer :: k, last

    do f = 1, shape%n_faces
      last = shape%face_first(f + 1) - 1
      do k = shape%face_first(f), last
        if (shape%face_vertex(k) == p .and. shape%face_vertex(merge(int(shape%face_first(f)), k + 1, k == last)) == q) return
      end do
    end do
    error stop 'no closed hull'
  end function other_face

  !> A box with its centre at the origin.
  function box_shape(half) result(shape)
    real(wp), intent(in) :: half(3) !! half axes [m]
    type(polyhedron_t) :: shape
    real(wp) :: point(3, 8)
    integer :: i

    do i = 1, 8
      point(:, i) = half*real([2*modulo(i, 2) - 1, 2*modulo(i/2, 2) - 1, 2*modulo(i/4, 2) - 1], wp)
    end do
    shape = hull_shape(point)
  end function box_shape

  !> A prism of height 2 about the z axis, its corners at distance 1 from it.
  function prism_shape(n) result(shape)
    integer, intent(in) :: n !! sides
    type(polyhedron_t) :: shape
    real(wp) :: angle
    integer :: i

    shape%n_vertices = 2*n
    shape%n_faces = n + 2
    allocate (shape%vertex(3, 2*n), shape%normal(3, n + 2), shape%face_first(n + 3), shape%face_vertex(6*n))
    shape%face_first(1) = 1
    do i = 1, n
      angle = 2*pi*real(i, wp)/real(n, wp)
      shape%vertex(:, i) = [cos(angle), sin(angle), -1.0_wp]
      shape%vertex(:, n + i) = [cos(angle), sin(angle), 1.0_wp]
      shape%face_vertex(4*i - 3:4*i) = int([i, modulo(i, n) + 1, n + modulo(i, n) + 1, n + i], i4)
      shape%face_first(i + 1) = int(4*i + 1, i4)
      shape%face_vertex(4*n + i) = int(n + 1 - i, i4)
      shape%face_vertex(5*n + i) = int(n + i, i4)
    end do
    shape%face_first(n + 2) = int(5*n + 1, i4)
    shape%face_first(n + 3) = int(6*n + 1, i4)
    call finish_shape(shape)
  end function prism_shape

  !> A shape stretched along its axes.
  function scaled_shape(shape, factor) result(scaled)
    type(polyhedron_t), intent(in) :: shape !! polyhedron
    real(wp), intent(in) :: factor(3) !! positive
    type(polyhedron_t) :: scaled
    integer :: i

    scaled = shape
    do i = 1, 3
      scaled%vertex(i, :) = factor(i)*shape%vertex(i, :)
    end do
    call finish_shape(scaled)
  end function scaled_shape

  !> A box, tetrahedron, prism or random hull of size about 1, perhaps as flat as a sheet or as thin as a needle.
  function random_shape(random) result(shape)
    type(random_t), intent(inout) :: random !! generator
    type(polyhedron_t) :: shape
    real(wp) :: point(3, 24), stretch(3)
    integer :: i, n, kind

    kind = int(random%uniform(0.0_wp, 5.0_wp))
    select case (kind)
    case (0)
      shape = box_shape([1.0_wp, 1.0_wp, 1.0_wp])
    case (1)
      shape = prism_shape(3 + int(random%uniform(0.0_wp, 5.0_wp)))
    case default
      n = merge(4, 4 + int(random%uniform(0.0_wp, 15.0_wp)), kind == 2)
      do i = 1, n
        point(:, i) = random_direction(random)
      end do
      shape = hull_shape(point(:, :n))
    end select
    stretch = 1
    do i = 1, 3
      if (random%uniform() < 0.3_wp) stretch(i) = 10**random%uniform(-3.0_wp, 0.0_wp)
    end do
    shape = scaled_shape(shape, stretch)
  end function random_shape
end module space_shapes
