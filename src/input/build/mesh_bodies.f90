!> Bodies from mesh files: each `[[blocks]]` becomes one `[[body]]` per object of its files, with one polyhedron per convex part.
!!
!! The deck that a run reports is the one that was written. Shapes are checked here, so that a mistake names file and object.
module sg_mesh_bodies
  use sg_blocks, only: block_t, deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_grain_templates, only: files_of_sample
  use sg_kinds, only: wp, i4
  use sg_mesh_files, only: mesh_t, read_mesh
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces
  use sg_polyhedron_make, only: hull_polyhedron
  use sg_text, only: text_t, to_text
  use sg_values, only: from_deck, value_t
  use sg_wildcards, only: matches
  use sg_words, only: quoted_string
  implicit none
  private
  public :: bodies_of_meshes

  !> Keys that bodies take over as they are
  character(len=8), parameter :: common(4) = [character(len=8) :: 'material', 'colour', 'position', 'rotation']

contains

  !> Add the bodies of all blocks to a checked deck.
  subroutine bodies_of_meshes(deck, diagnostics)
    type(deck_t), intent(inout) :: deck !! deck, or that of a stage
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(text_t), allocatable :: files(:)
    type(mesh_t) :: mesh
    type(error_t), allocatable :: error
    integer :: b, i

    do b = 1, deck%n
      if (.not. deck%is_in(b, 'blocks')) cycle
      call files_of_sample(deck, b, files, diagnostics)
      do i = 1, size(files)
        call read_mesh(files(i)%s, mesh, error)
        if (allocated(error)) then
          if (error%line > 0) error%message = 'line '//to_text(error%line)//': '//error%message
          call deck%complain(diagnostics, files(i)%s//': '//error%message, b, 'files')
        else
          call add_objects(deck, b, files(i)%s, mesh, diagnostics)
        end if
      end do
    end do
  end subroutine bodies_of_meshes

  !> Add a body for each object of a mesh.
  subroutine add_objects(deck, b, path, mesh, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: path
    type(mesh_t), intent(inout) :: mesh
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name
    integer :: first, last

    if (.not. allocated(mesh%part_first)) then
      mesh%part_first = [1_i4, int(size(mesh%face_first), i4)]
      mesh%part_object = [1_i4]
      allocate (mesh%object_name(1))
      mesh%object_name(1)%s = ''
    end if
    last = 0
    do while (last < size(mesh%part_object))
      first = last + 1
      last = findloc(mesh%part_object, mesh%part_object(first), 1, back=.true.)
      name = mesh%object_name(mesh%part_object(first))%s
      if (name == '') name = stem(path)
      call add_body(deck, b, path, name, mesh, first, last, diagnostics)
    end do
  end subroutine add_objects

  !> Name of a file without its folder and its ending.
  pure function stem(path)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: stem

    stem = path(index(path, '/', back=.true.) + 1:)
    stem = stem(:index(stem, '.', back=.true.) - 1)
  end function stem

  !> Add the body of an object: a block of its own, with one of a shape for each of several parts.
  subroutine add_body(deck, b, path, object, mesh, first, last, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b, first, last
    character(len=*), intent(in) :: path, object
    type(mesh_t), intent(in) :: mesh
    type(diagnostics_t), intent(inout) :: diagnostics
    type(polyhedron_t) :: shape
    type(value_t) :: value
    character(len=:), allocatable :: name, fault
    integer :: body, place, i

    name = object
    if (deck%is_given(b, 'name')) name = deck%word(b, 'name')//'.'//object
    call deck%add_block(empty_block(deck, b, 'body', 0))
    body = deck%n
    call give_word(deck, body, 'name', name)
    do i = 1, size(common)
      if (.not. deck%is_given(b, trim(common(i)))) cycle
      value = deck%value(b, trim(common(i)))
      value%key = deck%table%find_key(deck%blocks(body)%section, trim(common(i)))
      call deck%put(body, value)
    end do
    value = deck%value(b, 'fixed')
    if (any([(matches(name, value%words(i)%s), i=1, value%n_words)])) call deck%give_numbers(body, 'fixed', [1.0_wp])
    place = body
    do i = first, last
      call read_part(deck, b, mesh, i, shape, fault)
      if (allocated(fault)) then
        if (index(fault, 'not convex') > 0) fault = fault//'; "splitgrain convex '//path//'" divides it into convex parts'
        call deck%complain(diagnostics, path//', '//quoted_string(object)//': '//fault, b, 'files')
        return
      end if
      if (last > first) then
        call deck%add_block(empty_block(deck, b, 'body.shape', body))
        place = deck%n
      end if
      call give_word(deck, place, merge('kind ', 'shape', last > first), 'polyhedron')
      call give_shape(deck, place, shape)
    end do
  end subroutine add_body

  !> A block without values, where messages about another one point to.
  function empty_block(deck, b, section, parent) result(block)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, parent
    character(len=*), intent(in) :: section
    type(block_t) :: block

    block%section = deck%table%find_section(section)
    block%parent = parent
    block%line = deck%blocks(b)%line
    block%column = deck%blocks(b)%column
    allocate (block%values(8))
  end function empty_block

  !> Give a word to a block.
  subroutine give_word(deck, b, key, word)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: key, word
    type(value_t) :: value

    value%key = deck%table%find_key(deck%blocks(b)%section, trim(key))
    value%origin = from_deck
    value%line = deck%blocks(b)%line
    value%column = deck%blocks(b)%column
    value%n_words = 1
    allocate (value%words(1), value%word_places(2, 1))
    value%words(1)%s = word
    value%word_places(:, 1) = [value%line, value%column]
    call deck%put(b, value)
  end subroutine give_word

  !> Give vertices and faces to a block.
  subroutine give_shape(deck, b, shape)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    type(polyhedron_t), intent(in) :: shape
    type(value_t) :: value

    call deck%give_numbers(b, 'vertices', reshape(shape%vertex, [size(shape%vertex)]))
    value%key = deck%table%find_key(deck%blocks(b)%section, 'faces')
    value%origin = from_deck
    value%is_list = .true.
    value%numbers = real(shape%face_vertex, wp)
    value%n = size(shape%face_vertex)
    value%before = shape%face_first(:shape%n_faces) - 1_i4
    value%n_lists = shape%n_faces
    call deck%put(b, value)
  end subroutine give_shape

  !> Polyhedron of a part, in the frame of its file.
  subroutine read_part(deck, b, mesh, part, shape, fault)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, part
    type(mesh_t), intent(in) :: mesh
    type(polyhedron_t), intent(out) :: shape
    character(len=:), allocatable, intent(out) :: fault
    type(error_t), allocatable :: error
    integer(i4), allocatable :: used(:), place(:), face_first(:), face_vertex(:)
    integer :: first, last, i

    first = mesh%part_first(part)
    last = mesh%part_first(part + 1) - 1
    face_vertex = mesh%face_vertex(mesh%face_first(first):mesh%face_first(last + 1) - 1)
    face_first = mesh%face_first(first:last + 1) - mesh%face_first(first) + 1_i4
    allocate (place(size(mesh%vertex, 2)), source=0_i4)
    place(face_vertex) = 1
    used = pack([(int(i, i4), i=1, size(place))], place > 0)
    place(used) = [(int(i, i4), i=1, size(used))]
    if (deck%flag(b, 'hull')) then
      call hull_polyhedron(deck%number(b, 'scale')*mesh%vertex(:, used), shape, error)
    else
      call polyhedron_from_faces(deck%number(b, 'scale')*mesh%vertex(:, used), face_first, place(face_vertex), shape, error, &
                                 may_turn=.true.)
    end if
    if (allocated(error)) fault = error%message
  end subroutine read_part
end module sg_mesh_bodies
