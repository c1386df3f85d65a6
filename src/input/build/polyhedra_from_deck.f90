!> Polyhedra from the keys of [[body]] or [[body.shape]].
module sg_polyhedra_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, i4
  use sg_mesh_files, only: mesh_t, read_mesh
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces
  use sg_polyhedron_make, only: box_polyhedron, centre_polyhedron, hull_polyhedron, most_vertices, move_polyhedron
  use sg_scene, only: scene_t
  use sg_space_contactors, only: add_polyhedron
  use sg_text, only: to_text
  use sg_time_function_from_deck, only: path_in_deck
  use sg_values, only: value_t
  implicit none
  private
  public :: add_polyhedral_shape, place_polyhedral_shape, polyhedron_of_file

contains

  !> Add the box or the polyhedron of a block to the scene's contactors.
  subroutine add_polyhedral_shape(deck, b, kind, scene, body, colour, centre, frame, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the sizes
    character(len=*), intent(in) :: kind !! box or polyhedron
    type(scene_t), intent(inout) :: scene !! scene with the contactors
    integer, intent(in) :: body !! body that carries the shape
    integer, intent(in) :: colour !! index of the colour
    real(wp), intent(in) :: centre(3) !! origin of the shape's frame in that of the body [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the shape's frame in that of the body
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(polyhedron_t) :: shape
    integer :: errors

    errors = diagnostics%count()
    if (kind == 'box') then
      call read_box(deck, b, shape, diagnostics)
    else
      call read_polyhedron(deck, b, shape, diagnostics)
    end if
    if (diagnostics%count() == errors) call place_polyhedral_shape(scene, body, colour, shape, centre, frame)
  end subroutine add_polyhedral_shape

  !> Add a polyhedron, its vertices about its own centre of mass.
  subroutine place_polyhedral_shape(scene, body, colour, shape, centre, frame)
    type(scene_t), intent(inout) :: scene !! scene with the contactors
    integer, intent(in) :: body !! body that carries the shape
    integer, intent(in) :: colour !! index of the colour
    type(polyhedron_t), intent(inout) :: shape !! in its own frame; afterwards about its centre, in the frame of the body
    real(wp), intent(in) :: centre(3) !! origin of its frame in that of the body [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of its frame in that of the body
    real(wp) :: offset(3)

    call centre_polyhedron(shape, offset)
    call move_polyhedron(shape, [0.0_wp, 0.0_wp, 0.0_wp], transpose(frame))
    call add_polyhedron(scene%contactors, body, colour, shape, centre + matmul(frame, offset))
  end subroutine place_polyhedral_shape

  !> A box.
  subroutine read_box(deck, b, shape, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(polyhedron_t), intent(out) :: shape
    type(diagnostics_t), intent(inout) :: diagnostics
    type(error_t), allocatable :: error

    call box_polyhedron(deck%vector(b, 'half_axes'), shape, error)
    if (allocated(error)) call deck%complain(diagnostics, error%message, b, 'half_axes')
  end subroutine read_box

  !> A polyhedron from vertices, with faces or without, or from a file.
  subroutine read_polyhedron(deck, b, shape, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(polyhedron_t), intent(out) :: shape
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=5), parameter :: of_files(2) = ['scale', 'hull ']
    integer :: i

    if (deck%is_given(b, 'vertices') .eqv. deck%is_given(b, 'file')) then
      call deck%complain(diagnostics, 'a polyhedron needs either "vertices" or "file"', b, 'file')
    else if (deck%is_given(b, 'file')) then
      if (deck%is_given(b, 'faces')) &
        call deck%complain(diagnostics, '"faces" is refused next to "file", which holds its own', b, 'faces')
      call read_mesh_file(deck, b, shape, diagnostics)
    else
      do i = 1, size(of_files)
        if (deck%is_given(b, trim(of_files(i)))) &
          call deck%complain(diagnostics, '"'//trim(of_files(i))//'" has no meaning without "file"', b, trim(of_files(i)))
      end do
      call read_vertices(deck, b, shape, diagnostics)
    end if
  end subroutine read_polyhedron

  !> A polyhedron from the lists of the deck.
  subroutine read_vertices(deck, b, shape, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(polyhedron_t), intent(out) :: shape
    type(diagnostics_t), intent(inout) :: diagnostics
    type(error_t), allocatable :: error
    real(wp), allocatable :: vertices(:, :)
    type(value_t) :: value

    value = deck%value(b, 'vertices')
    vertices = reshape(value%numbers(:value%n), [3, value%n/3])
    if (deck%is_given(b, 'faces')) then
      value = deck%value(b, 'faces')
      call polyhedron_from_faces(vertices, [value%before(:value%n_lists) + 1_i4, int(value%n + 1, i4)], &
                                 nint(value%numbers(:value%n), i4), shape, error)
      if (allocated(error)) call deck%complain(diagnostics, error%message, b, 'faces')
    else if (size(vertices, 2) > most_vertices) then
      call deck%complain(diagnostics, 'the polyhedron has '//to_text(size(vertices, 2))//' vertices, more than the '// &
                         to_text(most_vertices)//' of a contact shape; a mesh "file" with hull = true keeps within', b, 'vertices')
    else
      call hull_polyhedron(vertices, shape, error)
      if (allocated(error)) then
        call deck%complain(diagnostics, error%message, b, 'vertices')
      else if (shape%n_vertices < size(vertices, 2)) then
        call deck%complain(diagnostics, 'the polyhedron is not convex: its hull has '//to_text(shape%n_vertices)//' of the '// &
                           to_text(size(vertices, 2))//' vertices', b, 'vertices')
      end if
    end if
  end subroutine read_vertices

  !> A polyhedron from a file. A mistake in the file is reported with its line there, at the key of the deck.
  subroutine read_mesh_file(deck, b, shape, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(polyhedron_t), intent(out) :: shape
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: message, warning
    real(wp) :: scale
    logical :: is_hull

    scale = 1
    if (deck%is_given(b, 'scale')) scale = deck%number(b, 'scale')
    is_hull = .false.
    if (deck%is_given(b, 'hull')) is_hull = deck%flag(b, 'hull')
    call polyhedron_of_file(path_in_deck(deck, deck%word(b, 'file')), scale, is_hull, shape, message, warning)
    if (allocated(warning)) call deck%warn(diagnostics, warning, b, 'file')
    if (allocated(message)) call deck%complain(diagnostics, message, b, 'file')
  end subroutine read_mesh_file

  !> A polyhedron from a mesh file.
  subroutine polyhedron_of_file(path, scale, is_hull, shape, message, warning)
    character(len=*), intent(in) :: path !! file, STL or OBJ
    real(wp), intent(in) :: scale !! length of a unit of the file [m]
    logical, intent(in) :: is_hull !! take the hull of the vertices?
    type(polyhedron_t), intent(out) :: shape !! in the frame of the file
    character(len=:), allocatable, intent(out) :: message !! why there is none, with its line; else unallocated
    character(len=:), allocatable, intent(out) :: warning !! how far the shape is from the hull of all vertices, where that is much
    type(error_t), allocatable :: error
    type(mesh_t) :: mesh
    real(wp) :: deviation

    call read_mesh(path, mesh, error)
    if (.not. allocated(error)) then
      if (is_hull) then
        call hull_polyhedron(scale*mesh%vertex, shape, error, deviation=deviation)
        if (deviation > 1e-3_wp*scale*maxval(maxval(mesh%vertex, 2) - minval(mesh%vertex, 2))) &
          warning = 'the hull of this file has too many vertices: '//to_text(shape%n_vertices)// &
                    ' of them are kept, and others stand out by up to '//to_text(deviation, 3)//' m'
      else
        call polyhedron_from_faces(scale*mesh%vertex, mesh%face_first, mesh%face_vertex, shape, error)
      end if
    end if
    if (.not. allocated(error)) return
    message = error%message
    if (error%line > 0) message = 'line '//to_text(error%line)//' of the file: '//message
  end subroutine polyhedron_of_file
end module sg_polyhedra_from_deck
