!> Impulses handed from points of contact that are gone to new ones of the same pair (doc/theory/detection.md).
!!
!! A feature that stays hands its impulse on by its key. But keys change: of the six corners of a prism on a plane four are chosen,
!! and a tilt of rounding size chooses others; two edges slide over the end of each other. A point without a past then goes on from
!! that point of the pair which has no present, the nearest first. Where a past point would be now follows from its key and
!! the shapes, so that nothing more is kept, sent to other ranks, or written to restart files.
module sg_hand_over
  use sg_contactors, only: contactors_t, kind_cylinder, kind_plane, kind_polygon, kind_polyhedron
  use sg_crossing_keys, only: crossing_ends
  use sg_kinds, only: wp, i4
  use sg_vectors, only: cross
  implicit none
  private
  public :: hand_over

contains

  !> Give points of contact without a past that of points without a present. Points of unknown place come last.
  pure subroutine hand_over(contactors, c, a, offset, feature, point, first, past)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(:) !! shift of the antagonist [m]
    integer(i4), intent(in) :: feature(:) !! features of the pair's contacts in the last detection
    real(wp), intent(in) :: point(:, :) !! points of contact of this detection [m], shape (dimension, points)
    integer, intent(in) :: first !! number of the first contact of the pair in the last detection
    integer, intent(inout) :: past(:) !! contact of the last detection that each point goes on from, 0 where there is none
    real(wp) :: apart(size(past), size(feature)), place(size(point, 1))
    logical :: is_known, is_free(size(past), size(feature))
    integer :: k, best(2)

    apart = huge(1.0_wp)
    do k = 1, size(feature)
      is_free(:, k) = past == 0 .and. .not. any(past == first + k - 1)
      if (.not. any(is_free(:, k))) cycle
      call find_place(contactors, c, a, offset, feature(k), place, is_known)
      if (is_known) apart(:, k) = norm2(point - spread(place, 2, size(past)), 1)
    end do
    do while (any(is_free))
      best = minloc(apart, is_free)
      past(best(1)) = first + best(2) - 1
      is_free(best(1), :) = .false.
      is_free(:, best(2)) = .false.
    end do
  end subroutine hand_over

  !> Where a feature of a pair is now.
  pure subroutine find_place(contactors, c, a, offset, feature, place, is_known)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(:) !! shift of the antagonist [m]
    integer(i4), intent(in) :: feature !! key of the point
    real(wp), intent(out) :: place(:) !! where it is [m]
    logical, intent(out) :: is_known !! does the key encode it?
    integer :: n_c

    n_c = n_vertices(contactors, c)
    place = 0
    is_known = .true.
    if (contactors%kind(c) == kind_cylinder) then
      ! 1 and 2 are the ends, 3 any point between them.
      place = contactors%centre(:, c)
      associate (row => contactors%row(c))
        if (feature < 3) place = place + real(2*feature - 3, wp)*contactors%space%cylinder_size(1, row) &
                                 *contactors%space%cylinder_world(:, row)
      end associate
    else if (feature < 1) then
      is_known = .false.
    else if (feature <= n_c) then
      place = vertex_of(contactors, c, int(feature))
    else if (feature <= n_c + n_vertices(contactors, a)) then
      place = offset + vertex_of(contactors, a, int(feature) - n_c)
    else
      call find_crossing(contactors, c, a, offset, feature, place, is_known)
    end if
  end subroutine find_place

  !> Where an edge of a polyhedron crosses one of another, on the first of the two.
  pure subroutine find_crossing(contactors, c, a, offset, feature, place, is_known)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c, a, feature
    real(wp), intent(in) :: offset(:)
    real(wp), intent(inout) :: place(:)
    logical, intent(out) :: is_known
    real(wp) :: edge_c(3), edge_a(3), between(3), normal(3), square
    integer :: ends(4)

    is_known = .false.
    if (size(place) < 3) return
    ends = crossing_ends(n_vertices(contactors, c), n_vertices(contactors, a), feature)
    if (any(ends == 0)) return
    place = vertex_of(contactors, c, ends(1))
    edge_c = vertex_of(contactors, c, ends(2)) - place
    between = vertex_of(contactors, a, ends(3)) + offset - place
    edge_a = vertex_of(contactors, a, ends(4)) + offset - place - between
    normal = cross(edge_c, edge_a)
    square = dot_product(normal, normal)
    is_known = square > tiny(square)
    if (is_known) place = place + dot_product(cross(between, edge_a), normal)/square*edge_c
  end subroutine find_crossing

  !> Number of vertices that features of a shape name.
  pure integer function n_vertices(contactors, c) result(n)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c
    integer :: row

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_polygon)
      n = contactors%polygon_first(row + 1) - contactors%polygon_first(row)
    case (kind_polyhedron)
      n = contactors%space%polyhedra(row)%n_vertices
    case (kind_plane)
      n = 8
    case default
      ! A rounded segment has the two ends of its axis.
      n = 2
    end select
  end function n_vertices

  !> A vertex of a shape in the world [m].
  pure function vertex_of(contactors, c, i) result(vertex)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c
    integer, intent(in) :: i
    real(wp) :: vertex(contactors%dimension)
    real(wp) :: side(3)
    integer :: row

    row = contactors%row(c)
    select case (contactors%kind(c))
    case (kind_polygon)
      vertex = contactors%polygon_world(:, contactors%polygon_first(row) + i - 1)
    case (kind_polyhedron)
      vertex = contactors%space%polyhedra(row)%world_vertex(:, i)
    case (kind_plane)
      side = contactors%space%plane_half(:, row)*real(2*ibits(i - 1, [0, 1, 2], 1) - 1, wp)
      vertex = contactors%centre(:, c) + matmul(reshape(contactors%space%plane_world(:, row), [3, 3]), side)
    case default
      vertex = contactors%centre(:, c)
      if (contactors%dimension == 2) &
        vertex = vertex + real(2*i - 3, wp)*contactors%segment_size(1, row)*contactors%segment_axis(:, row)
    end select
  end function vertex_of
end module sg_hand_over
