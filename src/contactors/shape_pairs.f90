!> The table of pairs: which kinds of shape meet, and in which order.
!!
!! A pair that touches has a kernel `touch_<candidate>_<antagonist>`, called by `touch_pair` or `touch_space_pair`, and
!! where the volume error counts it an `overlap_<candidate>_<antagonist>` (tests/unit/detection/test_pair_gap.f90).
module sg_shape_pairs
  use sg_shape_kinds, only: kind_cylinder, kind_disk, kind_hollow, kind_hollow_cylinder, kind_plane, kind_point, kind_polygon, &
                            kind_polyhedron, kind_segment, kind_sphere, shape_kinds
  implicit none
  private
  public :: is_pair, can_touch, datbox_pair_name, is_datbox_pair

  !> A candidate and an antagonist, in the order in which contacts have them, as in LMGC90
  type :: shape_pair_t
    integer :: candidate
    integer :: antagonist
    !> Do they touch? Points are the ends of links alone
    logical :: touches = .true.
  end type shape_pair_t

  !> All pairs
  type(shape_pair_t), parameter :: shape_pairs(17) = [ &
    shape_pair_t(kind_disk, kind_disk), &
    shape_pair_t(kind_disk, kind_segment), &
    shape_pair_t(kind_disk, kind_hollow), &
    shape_pair_t(kind_disk, kind_polygon), &
    shape_pair_t(kind_polygon, kind_polygon), &
    shape_pair_t(kind_polygon, kind_segment), &
    shape_pair_t(kind_sphere, kind_sphere), &
    shape_pair_t(kind_sphere, kind_plane), &
    shape_pair_t(kind_sphere, kind_cylinder), &
    shape_pair_t(kind_sphere, kind_hollow_cylinder), &
    shape_pair_t(kind_sphere, kind_polyhedron), &
    shape_pair_t(kind_cylinder, kind_cylinder), &
    shape_pair_t(kind_cylinder, kind_plane), &
    shape_pair_t(kind_cylinder, kind_hollow_cylinder), &
    shape_pair_t(kind_polyhedron, kind_polyhedron), &
    shape_pair_t(kind_polyhedron, kind_plane), &
    shape_pair_t(kind_point, kind_point, touches=.false.)]

contains

  !> Are two kinds a candidate and an antagonist, in this order?
  pure logical function is_pair(candidate, antagonist)
    integer, intent(in) :: candidate !! kind of shape
    integer, intent(in) :: antagonist !! kind of shape

    is_pair = any(shape_pairs%candidate == candidate .and. shape_pairs%antagonist == antagonist)
  end function is_pair

  !> Can shapes of two kinds touch each other, in either order?
  pure logical function can_touch(kind, other)
    integer, intent(in) :: kind !! one kind
    integer, intent(in) :: other !! the other

    can_touch = any(shape_pairs%touches .and. (shape_pairs%candidate == kind .and. shape_pairs%antagonist == other .or. &
                                               shape_pairs%candidate == other .and. shape_pairs%antagonist == kind))
  end function can_touch

  !> LMGC90's name of a pair of kinds.
  pure function datbox_pair_name(kinds, dimension) result(name)
    integer, intent(in) :: kinds(2) !! candidate and antagonist
    integer, intent(in) :: dimension !! of space
    character(len=5) :: name

    name = shape_kinds(kinds(1))%datbox_letters//shape_kinds(kinds(2))%datbox_letters//'x'
    if (kinds(1) == kind_point) name(5:5) = merge('2', '3', dimension == 2)
  end function datbox_pair_name

  !> Is there a pair of this name in a space of some dimension?
  pure logical function is_datbox_pair(name, dimension)
    character(len=*), intent(in) :: name !! LMGC90's name
    integer, intent(in) :: dimension !! of space
    integer :: kinds(2), i

    is_datbox_pair = .false.
    do i = 1, size(shape_pairs)
      kinds = [shape_pairs(i)%candidate, shape_pairs(i)%antagonist]
      if (any(shape_kinds(kinds(1))%dimension == [0, dimension])) &
        is_datbox_pair = is_datbox_pair .or. name == datbox_pair_name(kinds, dimension)
    end do
  end function is_datbox_pair
end module sg_shape_pairs
