!> Contactors: the shapes through which bodies touch, with one table of sizes per kind of shape.
!!
!! A body may carry several contactors (a cluster). A contactor has a kind, a body, a row in the table of its
!! kind, a colour, and a centre in the body's frame. A kind that a scene does not hold has no table.
module sg_contactors
  use sg_field_visitor, only: field_t, field_visitor_t, sync_never, sync_on_copy
  use sg_fields, only: fields_t
  use sg_kinds, only: wp, i1, i4
  use sg_lists, only: room_for
  use sg_shape_kinds, only: is_round, kind_cylinder, kind_disk, kind_hollow, kind_hollow_cylinder, kind_names, kind_plane, &
                            kind_point, kind_polygon, kind_polyhedron, kind_segment, kind_sphere, n_kinds
  use sg_space_shapes, only: place_in_space, space_shapes_t
  use sg_path_bound, only: longer_path
  implicit none
  private
  public :: contactors_t, kind_disk, kind_segment, kind_hollow, kind_polygon, kind_point, kind_names, n_kinds
  public :: kind_sphere, kind_plane, kind_cylinder, kind_hollow_cylinder, kind_polyhedron
  public :: add_disk, add_segment, add_hollow, add_polygon, add_point, add_contactor, drop_contactors, place_contactors
  public :: are_placed, edges_of, make_rows, place_all_corners, place_corners, place_polygon, place_run, table_all, table_vertices

  !> Tables of fields: of all contactors; of each kind of shape, by its number; of the vertices of all polygons
  integer, parameter :: table_all = 0, table_vertices = n_kinds + 1

  !> State of the vertices and edges of a polygon
  integer(i1), parameter :: wait = 0_i1, are_placed = 1_i1

  !> All contactors of a scene
  type, extends(fields_t) :: contactors_t
    !> Dimension of space
    integer :: dimension = 2
    !> Number of contactors
    integer :: n = 0
    !> Kind of shape, shape (n)
    integer(i4), allocatable :: kind(:)
    !> Body that carries it, shape (n)
    integer(i4), allocatable :: body(:)
    !> Row in the table of its kind, shape (n)
    integer(i4), allocatable :: row(:)
    !> Colour, index into the scene's colours, shape (n)
    integer(i4), allocatable :: colour(:)
    !> Centre in the body's frame [m], shape (dimension, n)
    real(wp), allocatable :: shift(:, :)
    !> Radius of the circle or sphere about the centre that holds the shape [m], shape (n)
    real(wp), allocatable :: reach(:)
    !> Centre in the detection configuration [m], shape (dimension, n); set by `place_contactors`
    real(wp), allocatable :: centre(:, :)
    !> In a decomposed scene: number of the contactor in the whole scene, shape (n); unallocated elsewhere
    integer(i4), allocatable :: id(:)

    !> Number of rows of each table
    integer :: n_rows(n_kinds) = 0
    !> Items that each table has room for
    integer :: room(table_all:table_vertices) = 0
    !> Disks: radius [m]
    real(wp), allocatable :: disk_radius(:)
    !> Rounded segments: half length of the axis, half thickness (radius of the caps) [m], angle in the body's frame [rad]
    real(wp), allocatable :: segment_size(:, :)
    !> Rounded segments: unit vector of the axis in the detection configuration, shape (2, row)
    real(wp), allocatable :: segment_axis(:, :)
    !> Hollow disks: inner radius [m]
    real(wp), allocatable :: hollow_radius(:)
    !> Polygons: vertices of row p are `polygon_first(p)` to `polygon_first(p + 1) - 1`
    integer(i4), allocatable :: polygon_first(:)
    !> Polygons: vertices about the contactor's centre in the body's frame [m], counter-clockwise, shape (2, vertex)
    real(wp), allocatable :: polygon_vertex(:, :)
    !> Polygons: the same vertices in the detection configuration [m], shape (2, vertex)
    real(wp), allocatable :: polygon_world(:, :)
    !> Polygons: outward unit normal and length [m] of the edge from each vertex to the next, there too, shape (3, vertex)
    real(wp), allocatable :: polygon_edge(:, :)
    !> Polygons: cosine and sine of their turn there, shape (2, row)
    real(wp), allocatable :: polygon_turn(:, :)
    !> Polygons: path length so far (sg_path_bound) [m], shape (row)
    real(wp), allocatable :: polygon_path(:)
    !> Polygons: are vertices and edges those of the detection configuration, or do they `wait` for `place_corners`? Shape (row)
    integer(i1), allocatable :: polygon_placed(:)
    !> Shapes in space; nothing of it is allocated in the plane
    type(space_shapes_t) :: space
  contains
    procedure :: visit => contactors_visit
  end type contactors_t

contains

  !> The list of fields, table by table. A field of a contactor is a line here, and its declaration above; tables of shapes in space
  !! are listed in sg_space_shapes.
  subroutine contactors_visit(self, visitor)
    class(contactors_t) :: self
    type(field_visitor_t), intent(inout) :: visitor !! what the visit does

    select case (visitor%table)
    case (table_all)
      ! Messages hold kind and number before the fields; the body that carries a contactor and its row are the receiver's.
      call visitor%visit(field_t('kind', sync_never), self%kind)
      call visitor%visit(field_t('id', sync_never, is_there=allocated(self%id)), self%id)
      call visitor%visit(field_t('body', sync_never), self%body)
      call visitor%visit(field_t('row', sync_never), self%row)
      call visitor%visit(field_t('colour', sync_on_copy), self%colour)
      call visitor%visit(field_t('shift', sync_on_copy, self%dimension), self%shift)
      call visitor%visit(field_t('reach', sync_on_copy), self%reach)
      call visitor%visit(field_t('centre', sync_never, self%dimension), self%centre)
    case (kind_disk)
      call visitor%visit(field_t('disk_radius', sync_on_copy), self%disk_radius)
    case (kind_segment)
      call visitor%visit(field_t('segment_size', sync_on_copy, 3), self%segment_size)
      call visitor%visit(field_t('segment_axis', sync_never, 2), self%segment_axis)
    case (kind_hollow)
      call visitor%visit(field_t('hollow_radius', sync_on_copy), self%hollow_radius)
    case (kind_polygon)
      call visitor%visit(field_t('polygon_first', sync_never, first=1.0_wp), self%polygon_first)
      call visitor%visit(field_t('polygon_turn', sync_never, 2), self%polygon_turn)
      call visitor%visit(field_t('polygon_path', sync_never), self%polygon_path)
      call visitor%visit(field_t('polygon_placed', sync_never), self%polygon_placed)
    case (table_vertices)
      call visitor%visit(field_t('polygon_vertex', sync_on_copy, 2), self%polygon_vertex)
      call visitor%visit(field_t('polygon_world', sync_never, 2), self%polygon_world)
      call visitor%visit(field_t('polygon_edge', sync_never, 3), self%polygon_edge)
    case default
      call self%space%visit(visitor)
    end select
  end subroutine contactors_visit

  !> Make room for exactly `n` items of a table.
  subroutine make_rows(contactors, table, n)
    type(contactors_t), intent(inout) :: contactors !! contactors to make room in
    integer, intent(in) :: table !! the table
    integer, intent(in) :: n !! items

    contactors%room(table) = n
    call contactors%resize(n, table)
  end subroutine make_rows

  !> Make room for at least `n` items of a table.
  subroutine reserve_rows(contactors, table, n)
    type(contactors_t), intent(inout) :: contactors !! contactors to make room in
    integer, intent(in) :: table !! the table
    integer, intent(in) :: n !! items wanted

    if (n > contactors%room(table)) call make_rows(contactors, table, room_for(n, contactors%room(table)))
  end subroutine reserve_rows

  !> Add a disk; with a shift from the body's centre it is a shifted disk (DISKb).
  subroutine add_disk(contactors, body, colour, radius, shift)
    type(contactors_t), intent(inout) :: contactors !! list to add to
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: radius !! [m]
    real(wp), intent(in) :: shift(2) !! centre in the body's frame [m]
    integer :: row

    call add_contactor(contactors, kind_disk, body, colour, shift, radius, row)
    contactors%disk_radius(row) = radius
  end subroutine add_disk

  !> Add a rounded segment: the points within `half_thickness` of an axis of length 2 `half_length`.
  subroutine add_segment(contactors, body, colour, half_length, half_thickness, shift, angle)
    type(contactors_t), intent(inout) :: contactors !! list to add to
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: half_length !! half length of the axis [m]
    real(wp), intent(in) :: half_thickness !! radius of the caps [m]
    real(wp), intent(in) :: shift(2) !! centre in the body's frame [m]
    real(wp), intent(in) :: angle !! of the axis in the body's frame [rad]
    integer :: row

    call add_contactor(contactors, kind_segment, body, colour, shift, half_length + half_thickness, row)
    contactors%segment_size(:, row) = [half_length, half_thickness, angle]
  end subroutine add_segment

  !> Add a hollow disk: grains touch it from inside.
  subroutine add_hollow(contactors, body, colour, radius, shift)
    type(contactors_t), intent(inout) :: contactors !! list to add to
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: radius !! inner radius [m]
    real(wp), intent(in) :: shift(2) !! centre in the body's frame [m]
    integer :: row

    call add_contactor(contactors, kind_hollow, body, colour, shift, radius, row)
    contactors%hollow_radius(row) = radius
  end subroutine add_hollow

  !> Add a convex polygon with counter-clockwise vertices.
  subroutine add_polygon(contactors, body, colour, vertices, shift)
    type(contactors_t), intent(inout) :: contactors !! list to add to
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: vertices(:, :) !! about the contactor's centre [m], shape (2, vertices)
    real(wp), intent(in) :: shift(2) !! contactor's centre in the body's frame [m]
    integer :: row, first, n

    n = size(vertices, 2)
    call add_contactor(contactors, kind_polygon, body, colour, shift, sqrt(maxval(sum(vertices**2, 1))), row)
    call reserve_rows(contactors, kind_polygon, row + 1)
    first = contactors%polygon_first(row)
    contactors%polygon_first(row + 1) = first + n
    call reserve_rows(contactors, table_vertices, first + n - 1)
    contactors%polygon_vertex(:, first:first + n - 1) = vertices
  end subroutine add_polygon

  !> Add a point, of the plane or of space.
  subroutine add_point(contactors, body, colour, shift)
    type(contactors_t), intent(inout) :: contactors !! list to add to
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: shift(:) !! the point in the body's frame [m], shape (dimension)
    integer :: row

    call add_contactor(contactors, kind_point, body, colour, shift, 0.0_wp, row)
  end subroutine add_point

  !> Add a contactor: what all kinds share.
  subroutine add_contactor(contactors, kind, body, colour, shift, reach, row)
    type(contactors_t), intent(inout) :: contactors !! list to add to
    integer, intent(in) :: kind !! kind of shape
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: shift(:) !! centre in the body's frame [m], shape (dimension)
    real(wp), intent(in) :: reach !! radius of the circle or sphere about the centre that holds the shape [m]
    integer, intent(out) :: row !! row in the table of its kind
    integer :: n

    n = contactors%n + 1
    contactors%n = n
    row = contactors%n_rows(kind) + 1
    contactors%n_rows(kind) = row
    call reserve_rows(contactors, table_all, n)
    call reserve_rows(contactors, kind, row)
    contactors%kind(n) = kind
    contactors%body(n) = body
    contactors%row(n) = row
    contactors%colour(n) = colour
    contactors%shift(:, n) = shift
    contactors%reach(n) = reach
  end subroutine add_contactor

  !> Drop all contactors but the first ones.
  pure subroutine drop_contactors(contactors, n)
    type(contactors_t), intent(inout) :: contactors !! list to shorten
    integer, intent(in) :: n !! how many stay
    integer :: c

    do c = n + 1, contactors%n
      associate (rows => contactors%n_rows(contactors%kind(c)))
        rows = rows - 1
      end associate
    end do
    contactors%n = n
  end subroutine drop_contactors

  !> Put all contactors where their bodies are.
  pure subroutine place_contactors(contactors, middle, corners_wait)
    type(contactors_t), intent(inout) :: contactors !! contactors to place
    real(wp), intent(in), contiguous :: middle(:, :) !! bodies' configuration, see `bodies_t`
    logical, intent(in), optional :: corners_wait !! do vertices and edges of polygons wait for `place_corners`? By default not
    logical :: is_late

    call place_run(contactors, middle, 1, contactors%n)
    is_late = .false.
    if (present(corners_wait)) is_late = corners_wait
    if (.not. is_late) call place_all_corners(contactors)
  end subroutine place_contactors

  !> The same for a run of contactors, without vertices and edges of polygons. What is set of each contactor belongs to it alone.
  pure subroutine place_run(contactors, middle, first, last)
    type(contactors_t), intent(inout) :: contactors !! contactors to place
    real(wp), intent(in), contiguous :: middle(:, :) !! bodies' configuration, see `bodies_t`
    integer, intent(in) :: first !! first contactor of the run
    integer, intent(in) :: last !! its last contactor

    if (contactors%dimension == 3) then
      call place_in_space(first, last, contactors%kind, contactors%body, contactors%row, contactors%shift, middle, &
                          contactors%centre, contactors%space)
    else
      call place_in_plane(contactors, middle, first, last)
    end if
  end subroutine place_run

  !> The same in the plane.
  pure subroutine place_in_plane(contactors, middle, first, last)
    type(contactors_t), intent(inout) :: contactors
    real(wp), intent(in), contiguous :: middle(:, :)
    integer, intent(in) :: first, last
    integer :: c, b, row
    real(wp) :: cosine, sine, angle, before(2)

    do c = first, last
      b = contactors%body(c)
      before = contactors%centre(:, c)
      contactors%centre(:, c) = middle(1:2, b)
      if (is_round(contactors%kind(c)) .and. .not. any(abs(contactors%shift(:, c)) > 0)) cycle
      angle = 0
      if (size(middle, 1) == 3) angle = middle(3, b)
      cosine = cos(angle)
      sine = sin(angle)
      contactors%centre(:, c) = middle(1:2, b) + turned(contactors%shift(:, c), cosine, sine)
      row = contactors%row(c)
      select case (contactors%kind(c))
      case (kind_segment)
        associate (turn => angle + contactors%segment_size(3, row))
          contactors%segment_axis(:, row) = [cos(turn), sin(turn)]
        end associate
      case (kind_polygon)
        call move_polygon(contactors, c, row, before, cosine, sine)
      end select
    end do
  end subroutine place_in_plane

  !> Turn of a polygon whose centre is placed, and its path: no point moves farther than the centre and the turn of the reach.
  pure subroutine move_polygon(contactors, c, row, before, cosine, sine)
    type(contactors_t), intent(inout) :: contactors
    integer, intent(in) :: c, row
    real(wp), intent(in) :: before(2), cosine, sine
    real(wp) :: way, chord

    associate (centre => contactors%centre(:, c), turn => contactors%polygon_turn(:, row))
      way = sqrt((centre(1) - before(1))**2 + (centre(2) - before(2))**2)
      chord = sqrt((cosine - turn(1))**2 + (sine - turn(2))**2)
      contactors%polygon_path(row) = longer_path(contactors%polygon_path(row), (way + contactors%reach(c)*chord)**2)
      turn(1) = cosine
      turn(2) = sine
    end associate
    contactors%polygon_placed(row) = wait
  end subroutine move_polygon

  !> Put vertices and edges of all polygons where their bodies are, those that wait for it; of all contactors, or of a run.
  pure subroutine place_all_corners(contactors, first, last)
    type(contactors_t), intent(inout) :: contactors !! placed contactors
    integer, intent(in), optional :: first, last !! first and last contactor of the run
    integer :: c, range(2)

    if (contactors%n_rows(kind_polygon) == 0) return
    range = [1, contactors%n]
    if (present(first)) range = [first, last]
    do c = range(1), range(2)
      call place_corners(contactors, c)
    end do
  end subroutine place_all_corners

  !> The same for one contactor, if it is a polygon.
  pure subroutine place_corners(contactors, c)
    type(contactors_t), intent(inout) :: contactors !! placed contactors
    integer, intent(in) :: c !! contactor

    if (contactors%kind(c) /= kind_polygon) return
    associate (row => contactors%row(c))
      if (contactors%polygon_placed(row) == are_placed) return
      call place_polygon(contactors, row, contactors%centre(:, c))
      contactors%polygon_placed(row) = are_placed
    end associate
  end subroutine place_corners

  !> Put the vertices and edges of one polygon where its body is; that they are placed is for the caller to note.
  pure subroutine place_polygon(contactors, row, centre)
    type(contactors_t), intent(inout) :: contactors !! placed contactors
    integer(i4), intent(in) :: row !! row of the polygon
    real(wp), intent(in) :: centre(2) !! its centre [m]
    real(wp) :: cosine, sine
    integer :: v, first, last

    first = contactors%polygon_first(row)
    last = contactors%polygon_first(row + 1) - 1
    cosine = contactors%polygon_turn(1, row)
    sine = contactors%polygon_turn(2, row)
    ! Component by component: vectors of two go through memory that loads then wait for.
    do v = first, last
      associate (corner => contactors%polygon_vertex(:, v))
        contactors%polygon_world(1, v) = centre(1) + (cosine*corner(1) - sine*corner(2))
        contactors%polygon_world(2, v) = centre(2) + (sine*corner(1) + cosine*corner(2))
      end associate
    end do
    call edges_of(last - first + 1, contactors%polygon_world(:, first:last), contactors%polygon_edge(:, first:last))
  end subroutine place_polygon

  !> Outward unit normals and lengths of the edges of a polygon; an edge without length has no normal.
  pure subroutine edges_of(n, vertex, edge)
    integer, intent(in) :: n !! vertices
    real(wp), intent(in) :: vertex(2, n) !! counter-clockwise [m]
    real(wp), intent(out) :: edge(3, n) !! normal and length [m] of the edge from each vertex to the next
    real(wp) :: x, y, length
    integer :: i, j

    do i = 1, n
      j = merge(1, i + 1, i == n)
      x = vertex(1, j) - vertex(1, i)
      y = vertex(2, j) - vertex(2, i)
      length = sqrt(x**2 + y**2)
      edge(:, i) = 0
      if (length > tiny(length)) then
        edge(1, i) = y/length
        edge(2, i) = -x/length
      end if
      edge(3, i) = length
    end do
  end subroutine edges_of

  !> A vector turned by an angle.
  pure function turned(vector, cosine, sine)
    real(wp), intent(in) :: vector(2), cosine, sine
    real(wp) :: turned(2)

    turned = [cosine*vector(1) - sine*vector(2), sine*vector(1) + cosine*vector(2)]
  end function turned
end module sg_contactors
