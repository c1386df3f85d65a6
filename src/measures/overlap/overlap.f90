!> Overlap areas of all pairs of shapes, for the volume error: pure geometry, numbers in, an area out.
module sg_overlap
  use sg_overlap_disks, only: overlap_disk_disk, overlap_disk_hollow
  use sg_overlap_polygons, only: overlap_disk_polygon, overlap_polygon_polygon
  use sg_overlap_segments, only: overlap_disk_segment, overlap_polygon_segment
  implicit none
  private
  public :: overlap_disk_disk, overlap_disk_segment, overlap_disk_hollow, overlap_disk_polygon
  public :: overlap_polygon_polygon, overlap_polygon_segment
end module sg_overlap
