!> Contactors as records of reals: nothing of a shape is recomputed from its record, so that all copies agree bit by bit.
!!
!! A record is its length, number in the whole scene and kind; the fields of all contactors that are sent, then those of the kind
!! (lists of fields in sg_contactors and sg_space_shapes); of a polygon its vertices, of a polyhedron its tables.
module sg_pack_shapes
  use sg_contactors, only: contactors_t, kind_polygon, kind_polyhedron, make_rows, n_kinds, table_all, table_vertices
  use sg_field_visitor, only: sync_on_copy
  use sg_kinds, only: wp, i4
  use sg_parcels, only: parcel_t
  use sg_polyhedron, only: polyhedron_t
  implicit none
  private
  public :: pack_contactors, unpack_contactors

  !> Places of values in a record, and values before the fields
  integer, parameter :: place_length = 1, place_number = 2, place_kind = 3, n_head = 3
  !> Contactors whose fields are moved in one visit: few enough to stay in the cache
  integer, parameter :: per_visit = 256

contains

  !> Append the records of some contactors.
  subroutine pack_contactors(contactors, item, parcel, start)
    type(contactors_t), intent(in) :: contactors !! all contactors of a scene
    integer(i4), intent(in) :: item(:) !! contactors to pack
    type(parcel_t), intent(inout) :: parcel !! takes the records
    integer, allocatable, intent(out) :: start(:) !! first value of each record, and the place behind the last one
    real(wp), allocatable :: fields(:, :)
    integer(i4) :: kind(size(item)), number(size(item)), row(size(item))
    integer :: i, width(n_kinds)

    kind = contactors%kind(item)
    row = contactors%row(item)
    number = item
    if (allocated(contactors%id)) number = contactors%id(item)
    width = widths(contactors)
    call pack_fields(contactors, item, kind, row, width, fields)
    allocate (start(size(item) + 1))
    do i = 1, size(item)
      start(i) = parcel%n + 1
      call parcel%put([0_i4, number(i), kind(i)]) ! the length is known at the end
      call parcel%put(fields(:width(kind(i)), i))
      if (kind(i) == kind_polygon) &
        call parcel%put(contactors%polygon_vertex(:, contactors%polygon_first(row(i)):contactors%polygon_first(row(i) + 1) - 1))
      if (kind(i) == kind_polyhedron) call pack_polyhedron(contactors%space%polyhedra(row(i)), parcel)
      parcel%value(start(i)) = real(parcel%n + 1 - start(i), wp)
    end do
    start(size(start)) = parcel%n + 1
  end subroutine pack_contactors

  !> Values of fields in the record of each kind.
  function widths(contactors) result(width)
    type(contactors_t), intent(in) :: contactors
    integer :: width(n_kinds), k

    width = contactors%width(sync_on_copy, table_all) + [(contactors%width(sync_on_copy, k), k=1, n_kinds)]
  end function widths

  !> Fields of contactors as they stand in their records, shape (largest width, contactors).
  subroutine pack_fields(contactors, item, kind, row, width, fields)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: item(:), kind(:), row(:)
    integer, intent(in) :: width(n_kinds)
    real(wp), allocatable, intent(out) :: fields(:, :)
    real(wp), allocatable :: values(:, :)
    integer, allocatable :: members(:)
    integer :: k, shared

    call contactors%pack(item, values, sync_on_copy, table=table_all)
    shared = size(values, 1)
    allocate (fields(maxval(width), size(item)))
    fields(:shared, :) = values
    do k = 1, n_kinds
      members = members_of(kind, k)
      if (width(k) == shared .or. size(members) == 0) cycle
      call contactors%pack(row(members), values, sync_on_copy, table=k)
      fields(shared + 1:width(k), members) = values
    end do
  end subroutine pack_fields

  !> Places of one kind in a list of kinds.
  pure function members_of(kind, wanted) result(members)
    integer(i4), intent(in) :: kind(:)
    integer, intent(in) :: wanted
    integer, allocatable :: members(:)
    integer :: i

    members = pack([(i, i=1, size(kind))], kind == wanted)
  end function members_of

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

  !> Read contactors, with just the room that they need.
  subroutine unpack_contactors(contactors, parcel, start, body)
    type(contactors_t), intent(inout) :: contactors !! of the dimension of the scene, with nothing allocated
    type(parcel_t), intent(inout) :: parcel !! parcel to read
    integer, intent(in) :: start(:) !! first value of each record, by ascending number
    integer(i4), intent(in) :: body(:) !! body that carries each contactor
    integer :: i, k, n, n_vertices, width(n_kinds)

    n = size(start)
    contactors%n = n
    allocate (contactors%id(0))
    call make_rows(contactors, table_all, n)
    contactors%id(:) = nint(parcel%value(start + place_number - 1), i4)
    contactors%kind(:) = nint(parcel%value(start + place_kind - 1), i4)
    contactors%body(:) = body
    width = widths(contactors)
    n_vertices = 0
    do i = 1, n
      k = contactors%kind(i)
      contactors%n_rows(k) = contactors%n_rows(k) + 1
      contactors%row(i) = int(contactors%n_rows(k), i4)
      if (k == kind_polygon) n_vertices = n_vertices + vertices_of(parcel, start(i), width(k))
    end do
    do k = 1, n_kinds
      if (contactors%n_rows(k) > 0) call make_rows(contactors, k, contactors%n_rows(k) + merge(1, 0, k == kind_polygon))
    end do
    if (n_vertices > 0) call make_rows(contactors, table_vertices, n_vertices)
    if (contactors%n_rows(kind_polyhedron) > 0) allocate (contactors%space%polyhedra(contactors%n_rows(kind_polyhedron)))
    do i = 1, n, per_visit
      call unpack_fields(contactors, i, parcel, start(i:min(i + per_visit - 1, n)), width)
    end do
    do i = 1, n
      k = contactors%kind(i)
      parcel%at = start(i) + n_head + width(k) - 1
      if (k == kind_polygon) &
        call unpack_vertices(contactors, int(contactors%row(i)), vertices_of(parcel, start(i), width(k)), parcel)
      if (k == kind_polyhedron) call unpack_polyhedron(contactors%space%polyhedra(contactors%row(i)), parcel)
    end do
  end subroutine unpack_contactors

  !> Vertices in the record of a polygon.
  pure integer function vertices_of(parcel, start, width) result(n)
    type(parcel_t), intent(in) :: parcel
    integer, intent(in) :: start, width

    n = (nint(parcel%value(start + place_length - 1)) - n_head - width)/2
  end function vertices_of

  !> Read the fields of some contactors, one behind the other in all tables.
  subroutine unpack_fields(contactors, first, parcel, start, width)
    type(contactors_t), intent(inout) :: contactors
    integer, intent(in) :: first, start(:), width(n_kinds)
    type(parcel_t), intent(in) :: parcel
    integer(i4) :: kind(size(start)), row(size(start))
    real(wp) :: fields(maxval(width), size(start))
    integer, allocatable :: members(:)
    integer :: i, k, shared

    kind = contactors%kind(first:first + size(start) - 1)
    row = contactors%row(first:first + size(start) - 1)
    do i = 1, size(start)
      fields(:width(kind(i)), i) = parcel%value(start(i) + n_head:start(i) + n_head + width(kind(i)) - 1)
    end do
    shared = contactors%width(sync_on_copy, table_all)
    call contactors%unpack([(int(i, i4), i=first, first + size(start) - 1)], fields(:shared, :), sync_on_copy, table=table_all)
    do k = 1, n_kinds
      members = members_of(kind, k)
      if (width(k) == shared .or. size(members) == 0) cycle
      call contactors%unpack(row(members), fields(shared + 1:width(k), members), sync_on_copy, table=k)
    end do
  end subroutine unpack_fields

  !> Read the vertices of a polygon; those of the polygons before it are read.
  subroutine unpack_vertices(contactors, row, n, parcel)
    type(contactors_t), intent(inout) :: contactors
    integer, intent(in) :: row, n
    type(parcel_t), intent(inout) :: parcel

    associate (first => contactors%polygon_first(row))
      contactors%polygon_first(row + 1) = int(first + n, i4)
      call parcel%take(contactors%polygon_vertex(:, first:first + n - 1))
    end associate
  end subroutine unpack_vertices

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
