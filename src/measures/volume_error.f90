!> The area by which shapes that touch overlap: over the area of the grains it is the volume error.
module sg_volume_error
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_polygon, kind_segment
  use sg_contacts, only: contacts_t
  use sg_grains, only: grains_of, grains_t
  use sg_kinds, only: wp, i4
  use sg_overlap, only: overlap_disk_disk, overlap_disk_hollow, overlap_disk_polygon, overlap_disk_segment, &
                        overlap_polygon_polygon, overlap_polygon_segment
  use sg_scene, only: scene_t
  use sg_tally, only: pass_columns, pass_sums, ratio, tally_t
  use sg_volume_error_space, only: overlap_volume
  implicit none
  private
  public :: measure_volume_error, overlap_of

contains

  !> Area of all overlaps over that of the grains; in space volumes.
  pure subroutine measure_volume_error(scene, contacts, tally)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(tally_t), intent(inout) :: tally !! tally of the measure
    type(grains_t) :: grains
    real(wp) :: overlap(1)

    if (tally%pass == pass_sums) then
      overlap = overlap_of(scene, contacts)
      call tally%sums%put('overlap', overlap)
    else if (tally%pass == pass_columns) then
      grains = grains_of(tally)
      overlap = tally%sums%get('overlap', 1)
      call tally%add('volume_error', ratio(overlap(1), grains%area))
    end if
  end subroutine measure_volume_error

  !> Area of all overlaps [m2], in space volume [m3], or of those of pairs whose first point with a negative gap counts.
  pure real(wp) function overlap_of(scene, contacts, is_counted) result(overlap)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    logical, allocatable, intent(in), optional :: is_counted(:) !! contacts that count; all unless given

    if (scene%dimension == 2) then
      overlap = overlap_area(scene%contactors, contacts, scene%period, is_counted)
    else
      overlap = overlap_volume(scene%contactors, contacts, scene, is_counted)
    end if
  end function overlap_of

  !> Sum of the overlaps of all pairs of shapes with a negative gap [m2], each pair once: its points follow one another.
  pure real(wp) function overlap_area(contactors, contacts, period, is_counted) result(area)
    type(contactors_t), intent(in) :: contactors
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: period
    logical, allocatable, intent(in), optional :: is_counted(:)
    integer :: k, last(4), this(4)
    real(wp) :: offset(2)
    logical :: are_disks

    area = 0
    last = 0
    do k = 1, contacts%n
      if (.not. contacts%gap(k) < 0) cycle
      are_disks = contactors%kind(contacts%contactor(1, k)) == kind_disk &
                  .and. contactors%kind(contacts%contactor(2, k)) == kind_disk .and. .not. contacts%has_cell
      if (.not. are_disks) then
        this = [contacts%contactor(:, k), int(contacts%image(k), i4), 0]
        offset = [period*real(this(3), wp), 0.0_wp]
        if (contacts%has_cell) then
          this(4) = int(contacts%image_y(k))
          offset = offset + contacts%upwards*real(this(4), wp)
        end if
        if (all(this == last)) cycle
        last = this
      end if
      if (present(is_counted)) then
        if (.not. is_counted(k)) cycle
      end if
      if (are_disks) then
        area = area + disks_overlap(contactors, contacts%contactor(1, k), contacts%contactor(2, k), &
                                    period*real(contacts%image(k), wp))
      else
        area = area + pair_overlap(contactors, this(1), this(2), offset)
      end if
    end do
  end function overlap_area

  !> Overlap of two disks [m2], the second one shifted along x: nearly all contacts of many scenes, each of a pair of its own.
  pure real(wp) function disks_overlap(contactors, c, a, shift) result(area)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, a
    real(wp), intent(in) :: shift

    associate (centre => contactors%centre)
      area = overlap_disk_disk([centre(1, c), centre(2, c)], contactors%disk_radius(contactors%row(c)), &
                               [centre(1, a) + shift, centre(2, a)], contactors%disk_radius(contactors%row(a)))
    end associate
  end function disks_overlap

  !> Overlap of one pair of shapes [m2]: the kernel of its two kinds.
  pure real(wp) function pair_overlap(contactors, c, a, offset) result(area)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, a
    real(wp), intent(in) :: offset(2)

    area = 0
    if (contactors%kind(c) == kind_disk) then
      area = disk_overlap(contactors, c, a, offset)
    else if (contactors%kind(c) == kind_polygon) then
      area = polygon_overlap(contactors, c, a, offset)
    end if
  end function pair_overlap

  !> Overlap of a disk with its antagonist [m2].
  pure real(wp) function disk_overlap(contactors, c, a, offset) result(area)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, a
    real(wp), intent(in) :: offset(2)
    integer :: row, first, last

    row = contactors%row(a)
    area = 0
    associate (centre => contactors%centre, radius => contactors%disk_radius(contactors%row(c)))
      select case (contactors%kind(a))
      case (kind_disk)
        area = overlap_disk_disk(centre(:, c), radius, centre(:, a) + offset, contactors%disk_radius(row))
      case (kind_segment)
        area = overlap_disk_segment(centre(:, c), radius, centre(:, a) + offset, contactors%segment_axis(:, row), &
                                    contactors%segment_size(1, row), contactors%segment_size(2, row))
      case (kind_hollow)
        area = overlap_disk_hollow(centre(:, c), radius, centre(:, a) + offset, contactors%hollow_radius(row))
      case (kind_polygon)
        first = contactors%polygon_first(row)
        last = contactors%polygon_first(row + 1) - 1
        area = overlap_disk_polygon(centre(:, c), radius, last - first + 1, contactors%polygon_world(:, first:last), offset)
      end select
    end associate
  end function disk_overlap

  !> Overlap of a polygon with its antagonist [m2].
  pure real(wp) function polygon_overlap(contactors, c, a, offset) result(area)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c, a
    real(wp), intent(in) :: offset(2)
    integer :: row, first, last, own_first, own_last

    row = contactors%row(c)
    own_first = contactors%polygon_first(row)
    own_last = contactors%polygon_first(row + 1) - 1
    row = contactors%row(a)
    area = 0
    select case (contactors%kind(a))
    case (kind_polygon)
      first = contactors%polygon_first(row)
      last = contactors%polygon_first(row + 1) - 1
      area = overlap_polygon_polygon(own_last - own_first + 1, contactors%polygon_world(:, own_first:own_last), &
                                     last - first + 1, contactors%polygon_world(:, first:last), offset)
    case (kind_segment)
      area = overlap_polygon_segment(own_last - own_first + 1, contactors%polygon_world(:, own_first:own_last), &
                                     contactors%centre(:, a) + offset, contactors%segment_axis(:, row), &
                                     contactors%segment_size(1, row), contactors%segment_size(2, row))
    end select
  end function polygon_overlap
end module sg_volume_error
