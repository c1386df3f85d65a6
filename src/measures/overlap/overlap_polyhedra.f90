!> Volumes that convex polyhedra share with each other, with planes (boxes) and with spheres, all exact.
!!
!! Polyhedra are taken as placed in the world (`place_polyhedron`).
module sg_overlap_polyhedra
  use sg_kinds, only: wp
  use sg_overlap_ball, only: ball_in_faces
  use sg_overlap_solid, only: cut, solid_t, solid_volume
  use sg_polyhedron, only: polyhedron_t
  implicit none
  private
  public :: overlap_polyhedron_polyhedron, overlap_polyhedron_plane, overlap_sphere_polyhedron

contains

  !> Volume shared by two convex polyhedra [m3]: the candidate cut by every face of the antagonist.
  pure real(wp) function overlap_polyhedron_polyhedron(candidate, antagonist, offset) result(volume)
    type(polyhedron_t), intent(in) :: candidate !! placed polyhedron
    type(polyhedron_t), intent(in) :: antagonist !! placed polyhedron
    real(wp), intent(in) :: offset(3) !! added to the antagonist's vertices (its periodic image) [m]
    real(wp) :: height(antagonist%n_faces), shift(3)
    integer :: f

    volume = 0
    shift = antagonist%centre + offset - candidate%centre
    if (sum(shift**2) >= (candidate%reach + antagonist%reach)**2) return
    do f = 1, antagonist%n_faces
      height(f) = dot_product(antagonist%world_normal(:, f), &
                              antagonist%world_vertex(:, antagonist%face_vertex(antagonist%face_first(f))) &
                              + (offset - candidate%centre))
    end do
    volume = volume_below(candidate, antagonist%n_faces, antagonist%world_normal, height)
  end function overlap_polyhedron_polyhedron

  !> Volume shared by a convex polyhedron and a plane (PLANx), which is a box [m3].
  pure real(wp) function overlap_polyhedron_plane(candidate, centre_a, frame, half) result(volume)
    type(polyhedron_t), intent(in) :: candidate !! placed polyhedron
    real(wp), intent(in) :: centre_a(3) !! centre of the box, the antagonist [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    real(wp) :: normal(3, 6), height(6)
    integer :: i

    do i = 1, 3
      normal(:, 2*i - 1) = frame(:, i)
      normal(:, 2*i) = -frame(:, i)
      height(2*i - 1:2*i) = half(i) + [1.0_wp, -1.0_wp]*dot_product(frame(:, i), centre_a - candidate%centre)
    end do
    volume = volume_below(candidate, 6, normal, height)
  end function overlap_polyhedron_plane

  !> Volume shared by a sphere and a convex polyhedron [m3].
  pure real(wp) function overlap_sphere_polyhedron(centre_c, radius_c, antagonist, offset) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    type(polyhedron_t), intent(in) :: antagonist !! placed polyhedron
    real(wp), intent(in) :: offset(3) !! added to the polyhedron's vertices (its periodic image) [m]
    real(wp) :: vertex(3, antagonist%n_vertices)
    integer :: i

    volume = 0
    if (sum((antagonist%centre + offset - centre_c)**2) >= (radius_c + antagonist%reach)**2) return
    do i = 1, antagonist%n_vertices
      vertex(:, i) = antagonist%world_vertex(:, i) + (offset - centre_c)
    end do
    volume = ball_in_faces(radius_c, antagonist%n_faces, antagonist%world_normal, antagonist%face_first, antagonist%face_vertex, &
                           vertex)
  end function overlap_sphere_polyhedron

  !> Volume of the part of a polyhedron below planes [m3].
  pure real(wp) function volume_below(shape, n_planes, normal, height) result(volume)
    type(polyhedron_t), intent(in) :: shape !! placed polyhedron
    integer, intent(in) :: n_planes !! number of planes
    real(wp), intent(in) :: normal(:, :) !! their unit normals, to the side cut off, shape (3, n_planes)
    real(wp), intent(in) :: height(:) !! of each plane above the polyhedron's centre [m], shape (n_planes)
    type(solid_t) :: solid
    real(wp) :: lowest(n_planes), highest(n_planes), above
    integer :: f, i

    volume = 0
    call centred_solid(shape, solid)
    lowest = huge(lowest)
    highest = -huge(highest)
    do f = 1, n_planes
      do i = 1, solid%n_vertices
        above = dot_product(normal(:, f), solid%vertex(:, i)) - height(f)
        lowest(f) = min(lowest(f), above)
        highest(f) = max(highest(f), above)
      end do
      if (lowest(f) >= 0) return
    end do
    ! The plane that leaves least comes first, so that the others find little to cut.
    f = maxloc(lowest, 1)
    if (highest(f) > 0) call cut(solid, normal(:, f), height(f))
    highest(f) = 0
    do f = 1, n_planes
      if (highest(f) > 0 .and. solid%n_faces > 0) call cut(solid, normal(:, f), height(f))
    end do
    volume = solid_volume(solid)
  end function volume_below

  !> A placed polyhedron as a solid about its centre.
  pure subroutine centred_solid(shape, solid)
    type(polyhedron_t), intent(in) :: shape
    type(solid_t), intent(out) :: solid
    integer :: i

    solid%n_vertices = shape%n_vertices
    solid%n_faces = shape%n_faces
    allocate (solid%vertex(3, shape%n_vertices), solid%face_first(shape%n_faces + 1), solid%face_vertex(size(shape%face_vertex)), &
              solid%normal(3, shape%n_faces))
    solid%normal = shape%world_normal
    do i = 1, shape%n_vertices
      solid%vertex(:, i) = shape%world_vertex(:, i) - shape%centre
    end do
    solid%face_first = shape%face_first(:shape%n_faces + 1)
    solid%face_vertex = shape%face_vertex
  end subroutine centred_solid
end module sg_overlap_polyhedra
