!> Contactors as records of reals: nothing of a shape is recomputed from its record, so that all copies agree bit by bit.
!!
!! A record is its length, then number in the whole scene, kind, colour, shift, reach, and the sizes of the shape in the
!! body's frame. What detection places in the world is no part of it.
module sg_pack_shapes
  use sg_contactors, only: contactors_t, kind_cylinder, kind_disk, kind_hollow, kind_hollow_cylinder, kind_plane, kind_polygon, &
                           kind_polyhedron, kind_segment, kind_sphere, n_kinds
  use sg_kinds, only: wp, i4
  use sg_parcels, only: parcel_t
  use sg_polyhedron, only: polyhedron_t
  use sg_space_shapes, only: space_shapes_t
  implicit none
  private
  public :: pack_contactor, unpack_contactor, unpack_size, make_room_for_shapes

contains

  !> Append the record of a contactor.
  subroutine pack_contactor(contactors, c, parcel)
    type(contactors_t), intent(in) :: contactors !! all contactors of a scene
    integer, intent(in) :: c !! contactor to pack
    type(parcel_t), intent(inout) :: parcel !! takes the record
    integer :: start, number

    number = c
    if (allocated(contactors%id)) number = contactors%id(c)
    start = parcel%n + 1
    call parcel%put(0) ! the length, known at the end
    call parcel%put(number)
    call parcel%put(contactors%kind(c))
    call parcel%put(contactors%colour(c))
    call parcel%put(contactors%shift(:, c))
    call parcel%put(contactors%reach(c))
    if (contactors%dimension == 2) then
      call pack_planar(contactors, contactors%kind(c), contactors%row(c), parcel)
    else
      call pack_spatial(contactors%space, contactors%kind(c), contactors%row(c), parcel)
    end if
    parcel%value(start) = real(parcel%n - start + 1, wp)
  end subroutine pack_contactor

  !> Sizes of a shape in the plane.
  subroutine pack_planar(contactors, kind, row, parcel)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: kind, row
    type(parcel_t), intent(inout) :: parcel

    select case (kind)
    case (kind_disk)
      call parcel%put(contactors%disk_radius(row))
    case (kind_segment)
      call parcel%put(contactors%segment_size(:, row))
    case (kind_hollow)
      call parcel%put(contactors%hollow_radius(row))
    case (kind_polygon)
      associate (first => contactors%polygon_first(row), last => contactors%polygon_first(row + 1) - 1)
        call parcel%put(last - first + 1)
        call parcel%put(contactors%polygon_vertex(:, first:last))
      end associate
    end select
  end subroutine pack_planar

  !> Sizes of a shape in space.
  subroutine pack_spatial(space, kind, row, parcel)
    type(space_shapes_t), intent(in) :: space
    integer(i4), intent(in) :: kind, row
    type(parcel_t), intent(inout) :: parcel

    select case (kind)
    case (kind_sphere)
      call parcel%put(space%sphere_radius(row))
    case (kind_plane)
      call parcel%put(space%plane_half(:, row))
      call parcel%put(space%plane_rim(row))
      call parcel%put(space%plane_frame(:, row))
    case (kind_cylinder)
      call parcel%put(space%cylinder_size(:, row))
      call parcel%put(space%cylinder_axis(:, row))
    case (kind_hollow_cylinder)
      call parcel%put(space%hollow_size(:, row))
      call parcel%put(space%hollow_axis(:, row))
    case (kind_polyhedron)
      call pack_polyhedron(space%polyhedra(row), parcel)
    end select
  end subroutine pack_spatial

  !> A polyhedron with all its tables.
  subroutine pack_polyhedron(shape, parcel)
    type(polyhedron_t), intent(in) :: shape
    type(parcel_t), intent(inout) :: parcel

    call parcel%put([shape%n_vertices, shape%n_faces, shape%n_edges, size(shape%face_vertex)])
    call parcel%put(shape%reach)
    call parcel%put(shape%vertex)
    call parcel%put(shape%face_first)
    call parcel%put(shape%face_vertex)
    call parcel%put(shape%normal)
    call parcel%put(shape%edge)
  end subroutine pack_polyhedron

  !> Number, kind and vertices of the contactor whose record stands next; the parcel is left behind that record.
  pure subroutine unpack_size(parcel, dimension, number, kind, n_vertices)
    type(parcel_t), intent(inout) :: parcel !! parcel to read
    integer, intent(in) :: dimension !! of space
    integer(i4), intent(out) :: number !! in the whole scene
    integer(i4), intent(out) :: kind !! kind of shape
    integer(i4), intent(out) :: n_vertices !! vertices of a polygon, 0 for other kinds
    integer(i4) :: length
    integer :: start

    start = parcel%at
    call parcel%take(length)
    call parcel%take(number)
    call parcel%take(kind)
    n_vertices = 0
    if (kind == kind_polygon) then
      parcel%at = start + 5 + dimension
      call parcel%take(n_vertices)
    end if
    parcel%at = start + length
  end subroutine unpack_size

  !> Make room for just so many contactors, with no row in any table yet.
  subroutine make_room_for_shapes(contactors, dimension, n_rows, n_vertices)
    type(contactors_t), intent(inout) :: contactors !! contactors with nothing allocated
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: n_rows(n_kinds) !! contactors of each kind
    integer, intent(in) :: n_vertices !! vertices of all polygons
    integer :: n

    n = sum(n_rows)
    contactors%dimension = dimension
    contactors%n = n
    contactors%n_rows = 0
    allocate (contactors%kind(n), contactors%body(n), contactors%row(n), contactors%colour(n), contactors%id(n), source=0_i4)
    allocate (contactors%shift(dimension, n), contactors%centre(dimension, n), source=0.0_wp)
    allocate (contactors%reach(n), source=0.0_wp)
    call allocate_list(n_rows(kind_disk), contactors%disk_radius)
    call allocate_table(3, n_rows(kind_segment), contactors%segment_size)
    call allocate_table(2, n_rows(kind_segment), contactors%segment_axis)
    call allocate_list(n_rows(kind_hollow), contactors%hollow_radius)
    if (n_rows(kind_polygon) > 0) then
      allocate (contactors%polygon_first(n_rows(kind_polygon) + 1), source=1_i4)
      call allocate_table(2, n_vertices, contactors%polygon_vertex)
      call allocate_table(2, n_vertices, contactors%polygon_world)
    end if
    call make_room_in_space(contactors%space, n_rows)
  end subroutine make_room_for_shapes

  !> The same for the tables in space.
  subroutine make_room_in_space(space, n_rows)
    type(space_shapes_t), intent(inout) :: space
    integer, intent(in) :: n_rows(n_kinds)

    call allocate_list(n_rows(kind_sphere), space%sphere_radius)
    call allocate_table(3, n_rows(kind_plane), space%plane_half)
    call allocate_list(n_rows(kind_plane), space%plane_rim)
    call allocate_table(9, n_rows(kind_plane), space%plane_frame)
    call allocate_table(9, n_rows(kind_plane), space%plane_world)
    call allocate_table(2, n_rows(kind_cylinder), space%cylinder_size)
    call allocate_table(3, n_rows(kind_cylinder), space%cylinder_axis)
    call allocate_table(3, n_rows(kind_cylinder), space%cylinder_world)
    call allocate_table(2, n_rows(kind_hollow_cylinder), space%hollow_size)
    call allocate_table(3, n_rows(kind_hollow_cylinder), space%hollow_axis)
    call allocate_table(3, n_rows(kind_hollow_cylinder), space%hollow_world)
    if (n_rows(kind_polyhedron) > 0) allocate (space%polyhedra(n_rows(kind_polyhedron)))
  end subroutine make_room_in_space

  !> A list of zeros, where there is something to list.
  subroutine allocate_list(n, list)
    integer, intent(in) :: n
    real(wp), allocatable, intent(inout) :: list(:)

    if (n > 0) allocate (list(n), source=0.0_wp)
  end subroutine allocate_list

  !> A table of zeros, where there is something to tabulate.
  subroutine allocate_table(components, n, table)
    integer, intent(in) :: components, n
    real(wp), allocatable, intent(inout) :: table(:, :)

    if (n > 0) allocate (table(components, n), source=0.0_wp)
  end subroutine allocate_table

  !> Read a contactor into its place; its row is the next one of its kind. Room must have been made.
  subroutine unpack_contactor(contactors, c, body, parcel)
    type(contactors_t), intent(inout) :: contactors !! contactors with room
    integer, intent(in) :: c !! place of the contactor
    integer(i4), intent(in) :: body !! body that carries it
    type(parcel_t), intent(inout) :: parcel !! parcel to read
    integer(i4) :: length, kind
    integer :: row

    call parcel%take(length)
    call parcel%take(contactors%id(c))
    call parcel%take(kind)
    call parcel%take(contactors%colour(c))
    call parcel%take(contactors%shift(:, c))
    call parcel%take(contactors%reach(c))
    row = contactors%n_rows(kind) + 1
    contactors%n_rows(kind) = row
    contactors%kind(c) = kind
    contactors%body(c) = body
    contactors%row(c) = row
    if (contactors%dimension == 2) then
      call unpack_planar(contactors, kind, row, parcel)
    else
      call unpack_spatial(contactors%space, kind, row, parcel)
    end if
  end subroutine unpack_contactor

  !> Read the sizes of a shape in the plane.
  subroutine unpack_planar(contactors, kind, row, parcel)
    type(contactors_t), intent(inout) :: contactors
    integer(i4), intent(in) :: kind
    integer, intent(in) :: row
    type(parcel_t), intent(inout) :: parcel
    integer(i4) :: first, n

    select case (kind)
    case (kind_disk)
      call parcel%take(contactors%disk_radius(row))
    case (kind_segment)
      call parcel%take(contactors%segment_size(:, row))
    case (kind_hollow)
      call parcel%take(contactors%hollow_radius(row))
    case (kind_polygon)
      call parcel%take(n)
      first = contactors%polygon_first(row)
      contactors%polygon_first(row + 1) = first + n
      call parcel%take(contactors%polygon_vertex(:, first:first + n - 1))
    end select
  end subroutine unpack_planar

  !> Read the sizes of a shape in space.
  subroutine unpack_spatial(space, kind, row, parcel)
    type(space_shapes_t), intent(inout) :: space
    integer(i4), intent(in) :: kind
    integer, intent(in) :: row
    type(parcel_t), intent(inout) :: parcel

    select case (kind)
    case (kind_sphere)
      call parcel%take(space%sphere_radius(row))
    case (kind_plane)
      call parcel%take(space%plane_half(:, row))
      call parcel%take(space%plane_rim(row))
      call parcel%take(space%plane_frame(:, row))
    case (kind_cylinder)
      call parcel%take(space%cylinder_size(:, row))
      call parcel%take(space%cylinder_axis(:, row))
    case (kind_hollow_cylinder)
      call parcel%take(space%hollow_size(:, row))
      call parcel%take(space%hollow_axis(:, row))
    case (kind_polyhedron)
      call unpack_polyhedron(space%polyhedra(row), parcel)
    end select
  end subroutine unpack_spatial

  !> Read a polyhedron.
  subroutine unpack_polyhedron(shape, parcel)
    type(polyhedron_t), intent(inout) :: shape
    type(parcel_t), intent(inout) :: parcel
    integer(i4) :: sizes(4)

    call parcel%take(sizes)
    shape%n_vertices = sizes(1)
    shape%n_faces = sizes(2)
    shape%n_edges = sizes(3)
    allocate (shape%vertex(3, sizes(1)), shape%normal(3, sizes(2)))
    allocate (shape%face_first(sizes(2) + 1), shape%face_vertex(sizes(4)), shape%edge(4, sizes(3)))
    call parcel%take(shape%reach)
    call parcel%take(shape%vertex)
    call parcel%take(shape%face_first)
    call parcel%take(shape%face_vertex)
    call parcel%take(shape%normal)
    call parcel%take(shape%edge)
  end subroutine unpack_polyhedron
end module sg_pack_shapes
