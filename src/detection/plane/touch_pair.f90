!> Narrow phase of one pair of contactors in the plane: the kernel of its two kinds.
module sg_touch_pair
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_polygon, kind_segment
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t
  use sg_touch_disk_disk, only: touch_disk_disk
  use sg_touch_disk_hollow, only: touch_disk_hollow
  use sg_touch_disk_polygon, only: touch_disk_polygon
  use sg_touch_disk_segment, only: touch_disk_segment
  use sg_touch_polygon_polygon, only: touch_polygon_polygon
  use sg_touch_polygon_segment, only: touch_polygon_segment
  implicit none
  private
  public :: touch_pair

contains

  !> Narrow phase of one pair: the kernel of its two kinds.
  pure subroutine touch_pair(contactors, c, a, shift, alert, touch, period, kept, clearance)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: shift(2) !! of the antagonist [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! points of contact
    real(wp), intent(in), optional :: period !! period in x, makes a level segment endless that spans it [m]
    integer(i4), intent(inout), optional :: kept !! face of polygons to try first, see `touch_convex`
    real(wp), intent(inout), optional :: clearance !! set for two polygons: their distance or less [m]
    integer(i4) :: face
    real(wp) :: centre(2), half_length
    integer :: row_c, row_a, first, n, first_c, n_c

    row_c = contactors%row(c)
    row_a = contactors%row(a)
    centre = contactors%centre(:, a) + shift
    if (contactors%kind(a) == kind_segment) half_length = facing_length(contactors, row_a, period)
    if (contactors%kind(a) == kind_polygon) then
      first = contactors%polygon_first(row_a)
      n = contactors%polygon_first(row_a + 1) - first
    end if
    if (contactors%kind(c) == kind_disk) then
      associate (own => contactors%centre(:, c), radius => contactors%disk_radius(row_c))
        select case (contactors%kind(a))
        case (kind_disk)
          call touch_disk_disk(own, radius, centre, contactors%disk_radius(row_a), alert, touch)
        case (kind_segment)
          call touch_disk_segment(own, radius, centre, contactors%segment_axis(:, row_a), half_length, &
                                  contactors%segment_size(2, row_a), alert, touch)
        case (kind_hollow)
          call touch_disk_hollow(own, radius, centre, contactors%hollow_radius(row_a), alert, touch)
        case (kind_polygon)
          call touch_disk_polygon(own, radius, n, contactors%polygon_world(1, first), shift, alert, touch)
        end select
      end associate
    else
      first_c = contactors%polygon_first(row_c)
      n_c = contactors%polygon_first(row_c + 1) - first_c
      face = 0
      if (present(kept)) face = kept
      associate (world => contactors%polygon_world, edge => contactors%polygon_edge, reach => contactors%reach)
        if (contactors%kind(a) == kind_polygon) then
          call touch_polygon_polygon(n_c, world(1, first_c), edge(1, first_c), n, world(1, first), edge(1, first), &
                                     2*max(reach(c), reach(a)), shift, alert, face, touch, clearance)
        else
          call touch_polygon_segment(n_c, world(1, first_c), edge(1, first_c), 2*reach(c), centre, &
                                     contactors%segment_axis(:, row_a), half_length, contactors%segment_size(2, row_a), alert, &
                                     face, touch)
        end if
      end associate
      if (present(kept)) kept = face
    end if
  end subroutine touch_pair

  !> Half length of a segment's axis as its antagonists meet it [m].
  !!
  !! A level segment that spans the period goes on in its own images: grains at its ends must not feel round caps there.
  pure real(wp) function facing_length(contactors, row, period) result(half_length)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: row
    real(wp), intent(in), optional :: period
    real(wp), parameter :: level = 1e-6_wp ! slope below which neighbouring images meet

    half_length = contactors%segment_size(1, row)
    if (.not. present(period)) return
    if (period > 0 .and. 2*half_length >= period .and. abs(contactors%segment_axis(2, row)) < level) &
      half_length = half_length + period
  end function facing_length
end module sg_touch_pair
