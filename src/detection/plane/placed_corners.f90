!> Corners of polygons placed by the first thread that needs them.
module sg_placed_corners
  use sg_contactors, only: are_placed, contactors_t, place_polygon
  use sg_kinds, only: i1, i4
  implicit none
  private
  public :: place_corners_once

contains

  !> Put the vertices and edges of a polygon where its body is, unless they are there. One thread at a time places corners, and
  !! others read them when it has noted that they are placed.
  subroutine place_corners_once(contactors, c)
    type(contactors_t), intent(inout) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! contactor, a polygon
    integer(i1) :: placed
    integer :: row

    row = contactors%row(c)
    !$omp atomic read seq_cst
    placed = contactors%polygon_placed(row)
    if (placed == are_placed) return
    !$omp critical (corners)
    if (contactors%polygon_placed(row) /= are_placed) then
      call place_polygon(contactors, contactors%row(c), contactors%centre(:, c))
      !$omp atomic write seq_cst
      contactors%polygon_placed(row) = are_placed
    end if
    !$omp end critical (corners)
  end subroutine place_corners_once
end module sg_placed_corners
