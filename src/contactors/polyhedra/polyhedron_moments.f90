!> Volume, centre and inertia of every shape in space, exact, and of bodies made of several.
!!
!! All is for a density of one: mass and inertia are these times the density. What shapes of a body share counts twice,
!! as it does in the plane.
module sg_polyhedron_moments
  use sg_kinds, only: wp, i4, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_symmetric, only: principal_axes
  implicit none
  private
  public :: solid_t, sphere_solid, capsule_solid, cylinder_solid, box_solid, polyhedron_solid, surface_solid
  public :: moved_solid, composed_solid, principal_inertia

  !> Moments of inertia that differ by less than this share are taken for equal, and the axes given are kept: of cubes and
  !> other bodies with equal moments rounding would make any axes. It changes moments by that share at most.
  real(wp), parameter :: equal_moments = 1e-10_wp

  !> What a rigid body is made of, for a density of one
  type :: solid_t
    !> [m3]
    real(wp) :: volume = 0
    !> Centre of mass [m]
    real(wp) :: centre(3) = 0
    !> Inertia tensor about the centre of mass [m5]
    real(wp) :: inertia(3, 3) = 0
  end type solid_t

contains

  !> A ball about the origin.
  pure type(solid_t) function sphere_solid(radius) result(solid)
    real(wp), intent(in) :: radius !! [m]

    solid%volume = 4*pi/3*radius**3
    solid%inertia = diagonal([1.0_wp, 1.0_wp, 1.0_wp]*(solid%volume*0.4_wp*radius**2))
  end function sphere_solid

  !> A capsule about the origin, its axis along z: a cylinder with half a ball at both ends.
  pure type(solid_t) function capsule_solid(half_height, radius) result(solid)
    real(wp), intent(in) :: half_height !! of the axis, from the origin to the centre of a half ball [m]
    real(wp), intent(in) :: radius !! [m]
    type(solid_t) :: cylinder
    real(wp) :: ball, across

    cylinder = cylinder_solid(half_height, radius)
    ball = 4*pi/3*radius**3
    ! A half ball about its flat side has half the inertia of the ball; its centre is 3/8 r off that side.
    across = ball*(0.4_wp*radius**2 + half_height**2 + 0.75_wp*half_height*radius)
    solid%volume = cylinder%volume + ball
    solid%inertia = cylinder%inertia + diagonal([across, across, ball*0.4_wp*radius**2])
  end function capsule_solid

  !> A cylinder about the origin, its axis along z.
  pure type(solid_t) function cylinder_solid(half_height, radius) result(solid)
    real(wp), intent(in) :: half_height !! [m]
    real(wp), intent(in) :: radius !! [m]
    real(wp) :: across

    solid%volume = 2*pi*radius**2*half_height
    across = solid%volume*(radius**2/4 + half_height**2/3)
    solid%inertia = diagonal([across, across, solid%volume*radius**2/2])
  end function cylinder_solid

  !> A box about the origin, its sides along the axes.
  pure type(solid_t) function box_solid(half_sizes) result(solid)
    real(wp), intent(in) :: half_sizes(3) !! half lengths of the sides [m]

    solid%volume = 8*product(half_sizes)
    solid%inertia = diagonal(solid%volume/3*(sum(half_sizes**2) - half_sizes**2))
  end function box_solid

  !> A convex polyhedron, in the frame of its vertices.
  pure type(solid_t) function polyhedron_solid(shape) result(solid)
    type(polyhedron_t), intent(in) :: shape !! closed

    solid = surface_solid(shape%vertex(:, :shape%n_vertices), shape%face_first, shape%face_vertex)
  end function polyhedron_solid

  !> What a closed surface of flat faces bounds, convex or not; volume and inertia are negative where it is inside out.
  !!
  !! The sum over the tetrahedra between a point and the triangles of the faces: over one with the corners 0, a, b, c the
  !! integral of x x^T is det(a, b, c)/120 (a a^T + b b^T + c c^T + s s^T), where s = a + b + c.
  pure type(solid_t) function surface_solid(vertices, face_first, face_vertex) result(solid)
    real(wp), intent(in) :: vertices(:, :) !! [m], shape (3, vertices)
    integer(i4), intent(in) :: face_first(:) !! corners of face f: face_first(f) to face_first(f + 1) - 1
    integer(i4), intent(in) :: face_vertex(:) !! corners of all faces, counter-clockwise seen from outside
    real(wp) :: origin(3), a(3), b(3), c(3), s(3), determinant, first(3), second(3, 3)
    integer :: f, k, i

    if (size(face_first) < 2 .or. size(vertices, 2) == 0) return
    ! About the middle of the vertices: no digits are lost on a surface far away.
    origin = sum(vertices, 2)/real(size(vertices, 2), wp)
    first = 0
    second = 0
    do f = 1, size(face_first) - 1
      a = vertices(:, face_vertex(face_first(f))) - origin
      do k = face_first(f) + 1, face_first(f + 1) - 2
        b = vertices(:, face_vertex(k)) - origin
        c = vertices(:, face_vertex(k + 1)) - origin
        determinant = a(1)*(b(2)*c(3) - b(3)*c(2)) + a(2)*(b(3)*c(1) - b(1)*c(3)) + a(3)*(b(1)*c(2) - b(2)*c(1))
        s = a + b + c
        solid%volume = solid%volume + determinant/6
        first = first + determinant/24*s
        do i = 1, 3
          second(:, i) = second(:, i) + determinant/120*(a*a(i) + b*b(i) + c*c(i) + s*s(i))
        end do
      end do
    end do
    if (.not. abs(solid%volume) > 0) return
    first = first/solid%volume
    do i = 1, 3
      second(:, i) = second(:, i) - solid%volume*first*first(i)
    end do
    solid%centre = origin + first
    solid%inertia = diagonal([1.0_wp, 1.0_wp, 1.0_wp]*(second(1, 1) + second(2, 2) + second(3, 3))) - second
  end function surface_solid

  !> A solid turned, then shifted.
  pure type(solid_t) function moved_solid(solid, shift, frame) result(moved)
    type(solid_t), intent(in) :: solid !! in its own frame
    real(wp), intent(in) :: shift(3) !! where the frame's origin goes [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: where the frame's axes go

    moved%volume = solid%volume
    moved%centre = shift + matmul(frame, solid%centre)
    moved%inertia = matmul(frame, matmul(solid%inertia, transpose(frame)))
  end function moved_solid

  !> Several solids as one; with no volume at all the centre is the origin.
  pure type(solid_t) function composed_solid(solids) result(whole)
    type(solid_t), intent(in) :: solids(:) !! all in one frame
    real(wp) :: arm(3)
    integer :: i, k

    do i = 1, size(solids)
      whole%volume = whole%volume + solids(i)%volume
    end do
    if (.not. abs(whole%volume) > 0) return
    do i = 1, size(solids)
      whole%centre = whole%centre + solids(i)%volume/whole%volume*solids(i)%centre
    end do
    do i = 1, size(solids)
      arm = solids(i)%centre - whole%centre
      whole%inertia = whole%inertia + solids(i)%inertia + diagonal([1.0_wp, 1.0_wp, 1.0_wp]*(solids(i)%volume*sum(arm**2)))
      do k = 1, 3
        whole%inertia(:, k) = whole%inertia(:, k) - solids(i)%volume*arm*arm(k)
      end do
    end do
  end function composed_solid

  !> Principal moments and axes of a solid, the axes right-handed and as near to the given ones as they can be.
  pure subroutine principal_inertia(solid, moments, axes)
    type(solid_t), intent(in) :: solid !! solid
    real(wp), intent(out) :: moments(3) !! about the axes [m5]
    real(wp), intent(out) :: axes(3, 3) !! columns: principal axes in the solid's frame

    call principal_axes(solid%inertia, moments, axes, tolerance=equal_moments)
  end subroutine principal_inertia

  !> A diagonal matrix.
  pure function diagonal(values) result(matrix)
    real(wp), intent(in) :: values(3)
    real(wp) :: matrix(3, 3)
    integer :: i

    matrix = 0
    do i = 1, 3
      matrix(i, i) = values(i)
    end do
  end function diagonal
end module sg_polyhedron_moments
