!> Polyhedra of a DATBOX: POLYR, vertices and triangles, and POLYF, the same in patches.
!!
!! LMGC90 joins the patches of a POLYF one behind the other and calls the whole POLYR from then on; so do we.
module sg_datbox_polyhedra
  use sg_contactors, only: contactors_t
  use sg_datbox_blocks, only: read_point, triple
  use sg_datbox_lines, only: complain, datbox_file_t, go_to, next_data_line, remark
  use sg_datbox_numbers, only: integer_field
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, i4
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_triangles
  use sg_polyhedron_checks, only: length_tolerance
  use sg_polyhedron_make, only: centre_polyhedron
  use sg_space_contactors, only: add_polyhedron
  use sg_text, only: to_text
  use sg_vectors, only: cross
  implicit none
  private
  public :: read_polyhedron

  !> Columns of the two counts of a polyhedron's line
  integer, parameter :: count_columns(2) = [40, 60]

contains

  !> Read the vertices and triangles of a polyhedron and check that it is closed and convex.
  subroutine read_polyhedron(file, contactors, body, colour, has_patches, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file at the contactor's line
    type(contactors_t), intent(inout) :: contactors !! gets the polyhedron
    integer, intent(in) :: body !! body that carries it
    integer, intent(in) :: colour !! index of its colour
    logical, intent(in) :: has_patches !! is it a POLYF?
    logical, intent(inout) :: ok !! turned false when something is wrong
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(polyhedron_t) :: shape
    real(wp), allocatable :: vertices(:, :)
    integer(i4), allocatable :: triangles(:, :)
    real(wp) :: centre(3)
    integer :: line, last, n_patches, patch

    line = file%at
    allocate (vertices(3, 0), triangles(3, 0))
    n_patches = 1
    if (has_patches) then
      call integer_field(file, count_columns(1), count_columns(1) + 7, n_patches, ok, diagnostics, may_go_on=.true.)
      if (ok .and. (n_patches < 1 .or. n_patches > file%n)) then
        call complain(file, 'a polyhedron of '//to_text(n_patches)//' patches cannot be', count_columns(1), diagnostics)
        ok = .false.
      end if
    end if
    do patch = 1, n_patches
      if (ok .and. has_patches) ok = next_data_line(file, 'the sizes of a patch', diagnostics)
      if (ok) call read_surface(file, merge(1, 4, has_patches), vertices, triangles, ok, diagnostics)
      if (.not. ok) return
    end do
    last = file%at
    call go_to(file, line)
    call make_polyhedron(file, vertices, triangles, shape, ok, diagnostics)
    call go_to(file, max(file%at, last))
    if (.not. ok) return
    call centre_polyhedron(shape, centre)
    call add_polyhedron(contactors, body, colour, shape, centre)
  end subroutine read_polyhedron

  !> Read the sizes of a surface or patch, its vertices, then its triangles, and add them to what is there.
  subroutine read_surface(file, least, vertices, triangles, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: least
    real(wp), allocatable, intent(inout) :: vertices(:, :)
    integer(i4), allocatable, intent(inout) :: triangles(:, :)
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp), allocatable :: more(:, :)
    integer(i4), allocatable :: faces(:, :)
    integer :: sizes(2), i

    do i = 1, 2
      call integer_field(file, count_columns(i), count_columns(i) + 7, sizes(i), ok, diagnostics, may_go_on=.true.)
    end do
    if (.not. ok) return
    if (minval(sizes) < least .or. maxval(sizes) > file%n - file%at) then
      call complain(file, 'a polyhedron of '//to_text(sizes(1))//' vertices and '//to_text(sizes(2))//' triangles cannot be: ' &
                    //'it needs four of each, and a line for each', count_columns(1), diagnostics)
      ok = .false.
      return
    end if
    allocate (more(3, sizes(1)), source=0.0_wp)
    do i = 1, sizes(1)
      call read_point(file, 'a vertex', more(:, i), ok, diagnostics)
      if (.not. ok) return
    end do
    call read_triangles(file, sizes, faces, ok, diagnostics)
    if (.not. ok) return
    triangles = reshape([triangles, faces + int(size(vertices, 2), i4)], [3, size(triangles, 2) + sizes(2)])
    vertices = reshape([vertices, more], [3, size(vertices, 2) + sizes(1)])
  end subroutine read_surface

  !> Read the triangles of a surface or patch.
  subroutine read_triangles(file, sizes, triangles, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: sizes(2)
    integer(i4), allocatable, intent(out) :: triangles(:, :)
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: i, k, corner

    allocate (triangles(3, sizes(2)), source=0_i4)
    do i = 1, sizes(2)
      ok = next_data_line(file, 'a triangle', diagnostics)
      do k = 1, 3
        if (ok) call integer_field(file, triple(k), triple(k) + 12, corner, ok, diagnostics, may_go_on=.true.)
        if (.not. ok) return
        if (corner < 1 .or. corner > sizes(1)) then
          call complain(file, 'there is no vertex '//to_text(corner)//': the polyhedron has '//to_text(sizes(1)), triple(k), &
                        diagnostics)
          ok = .false.
          return
        end if
        triangles(k, i) = int(corner, i4)
      end do
    end do
  end subroutine read_triangles

  !> Make the polyhedron: of triangles that look outwards from its middle, as those of a convex one do when LMGC90 has turned
  !! them, and else of those of the file, turned alike.
  subroutine make_polyhedron(file, vertices, triangles, shape, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    real(wp), intent(in) :: vertices(:, :)
    integer(i4), intent(in) :: triangles(:, :)
    type(polyhedron_t), intent(out) :: shape
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    type(error_t), allocatable :: error
    integer(i4), allocatable :: outward(:, :)
    character(len=:), allocatable :: message
    integer :: i

    allocate (outward, source=triangles)
    call turn_outwards(vertices, outward)
    call polyhedron_from_triangles(vertices, outward, shape, error)
    if (allocated(error)) then
      call polyhedron_from_triangles(vertices, triangles, shape, error, may_turn=.true.)
    else
      do i = 1, size(triangles, 2)
        if (any(outward(:, i) /= triangles(:, i))) call remark(file, 'clockwise', 'triangle '//to_text(i)//' of this ' &
          //'polyhedron runs clockwise seen from outside: such triangles are turned', 2, diagnostics)
      end do
    end if
    if (.not. allocated(error)) return
    message = error%message
    if (.not. is_convex(vertices, triangles)) message = 'the polyhedron is not convex: split it into convex parts (with CoACD, ' &
      //'V-HACD, or convex_decomposition_3 of CGAL) and give these as POLYR of one body'
    call complain(file, message, 2, diagnostics)
    ok = .false.
  end subroutine make_polyhedron

  !> Have the planes of all triangles all vertices on one side?
  pure logical function is_convex(vertices, triangles)
    real(wp), intent(in) :: vertices(:, :)
    integer(i4), intent(in) :: triangles(:, :)
    real(wp) :: normal(3), heights(2), height, tolerance
    integer :: i, v

    tolerance = length_tolerance(vertices)
    do i = 1, size(triangles, 2)
      associate (a => vertices(:, triangles(1, i)), b => vertices(:, triangles(2, i)), c => vertices(:, triangles(3, i)))
        normal = cross(b - a, c - a)
        ! The plane of a narrow triangle is lost in rounding.
        if (norm2(normal) <= tolerance*max(norm2(b - a), norm2(c - a), norm2(c - b))) cycle
        normal = normal/norm2(normal)
        heights = 0
        do v = 1, size(vertices, 2)
          height = dot_product(vertices(:, v) - a, normal)
          heights = [min(heights(1), height), max(heights(2), height)]
        end do
      end associate
      is_convex = heights(1) >= -tolerance .or. heights(2) <= tolerance
      if (.not. is_convex) return
    end do
    is_convex = .true.
  end function is_convex

  !> Turn the triangles that run clockwise seen from the middle of the vertices.
  subroutine turn_outwards(vertices, triangles)
    real(wp), intent(in) :: vertices(:, :)
    integer(i4), intent(inout) :: triangles(:, :)
    real(wp) :: middle(3), volume
    integer :: i

    middle = sum(vertices, 2)/real(size(vertices, 2), wp)
    do i = 1, size(triangles, 2)
      associate (a => vertices(:, triangles(1, i)), b => vertices(:, triangles(2, i)), c => vertices(:, triangles(3, i)))
        volume = dot_product(a - middle, cross(b - a, c - a))
      end associate
      if (volume < 0) triangles(2:3, i) = triangles([3, 2], i)
    end do
  end subroutine turn_outwards
end module sg_datbox_polyhedra
