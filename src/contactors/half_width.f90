!> How thin a shape is: how deep it may be entered before the nearer way out is the other side.
module sg_half_width
  use sg_contactors, only: contactors_t, kind_cylinder, kind_disk, kind_plane, kind_polygon, kind_polyhedron, kind_segment, &
                           kind_sphere
  use sg_kinds, only: wp
  implicit none
  private
  public :: half_width

contains

  !> Half of the least width of a shape, across one of its faces where it has any [m]. Hollow shapes have no other side.
  pure real(wp) function half_width(contactors, c)
    type(contactors_t), intent(in) :: contactors !! contactors of the scene
    integer, intent(in) :: c !! contactor
    integer :: row

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_disk)
      half_width = contactors%disk_radius(row)
    case (kind_segment)
      half_width = contactors%segment_size(2, row)
    case (kind_polygon)
      associate (first => contactors%polygon_first(row), last => contactors%polygon_first(row + 1) - 1)
        half_width = polygon_half_width(contactors%polygon_vertex(:, first:last))
      end associate
    case (kind_sphere)
      half_width = contactors%space%sphere_radius(row)
    case (kind_plane)
      half_width = minval(contactors%space%plane_half(:, row))
    case (kind_cylinder)
      half_width = contactors%space%cylinder_size(2, row)
    case (kind_polyhedron)
      associate (solid => contactors%space%polyhedra(row))
        half_width = least_half_width(solid%vertex(:, :solid%n_vertices), solid%normal(:, :solid%n_faces))
      end associate
    case default
      half_width = huge(half_width)
    end select
  end function half_width

  !> The same of a convex polygon, from its vertices, counter-clockwise [m]. The vertex farthest from an edge goes round with the
  !! edge: all edges together take two turns.
  pure real(wp) function polygon_half_width(vertex)
    real(wp), intent(in) :: vertex(:, :)
    real(wp) :: normal(2), edge(2), flat
    integer :: n, v, far, next, turns

    n = size(vertex, 2)
    ! Vertices after an edge may stand on its line, up to rounding: what is no lower is not the far side.
    flat = 1e-12_wp*maxval(abs(vertex))
    polygon_half_width = huge(1.0_wp)
    far = 2
    turns = 0
    do v = 1, n
      edge = vertex(:, 1 + mod(v, n)) - vertex(:, v)
      normal = [edge(2), -edge(1)]/max(norm2(edge), tiny(1.0_wp))
      do while (turns < 2*n + v)
        next = 1 + mod(far, n)
        if (dot_product(normal, vertex(:, next) - vertex(:, far)) > 0 .and. &
            dot_product(normal, vertex(:, v) - vertex(:, far)) > flat) exit
        far = next
        turns = turns + 1
      end do
      polygon_half_width = min(polygon_half_width, dot_product(normal, vertex(:, v) - vertex(:, far))/2)
    end do
  end function polygon_half_width

  !> Half of the least distance of the two ends of a set of points along some unit vectors [m].
  pure real(wp) function least_half_width(vertex, normal)
    real(wp), intent(in) :: vertex(:, :), normal(:, :)
    real(wp) :: height(size(vertex, 2))
    integer :: i

    least_half_width = huge(1.0_wp)
    do i = 1, size(normal, 2)
      height = matmul(normal(:, i), vertex)
      least_half_width = min(least_half_width, (maxval(height) - minval(height))/2)
    end do
  end function least_half_width
end module sg_half_width
