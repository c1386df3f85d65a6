!> OBJ files (Wavefront): vertices `v x y z` and faces `f 1 2 3 4`, the rest is passed over.
!!
!! Corners of a face are numbers of vertices from 1, or from the last one backwards when negative; those of textures and
!! normals may follow them, as in `f 1/1 2/2 3/3`, `f 1//1 2//2 3//3` and `f 1/1/1 2/2/2 3/3/3`. `o name` begins an object; within
!! one, groups whose names begin with "convex", as `splitgrain convex` writes them, are parts of it.
module sg_mesh_files_obj
  use sg_error, only: error_t, fail
  use sg_kinds, only: i4
  use sg_lists, only: reserve
  use sg_mesh_files_text, only: fail_at, mesh_t, mesh_text_t, present_word, read_number, skip_line, word_on_line
  use sg_text, only: append_word, to_text
  implicit none
  private
  public :: read_obj

  !> Begin of the names of groups that are parts of an object
  character(len=*), parameter :: part_name = 'convex'
  !> Longest name of an object
  integer, parameter :: longest_name = 200
  !> Statements that are passed over
  character(len=10), parameter :: others(19) = [character(len=10) :: 'vn', 'vt', 'vp', 's', 'l', 'p', 'mg', 'lod', &
                                               'usemtl', 'mtllib', 'usemap', 'maplib', 'bevel', 'c_interp', 'd_interp', &
                                               'shadow_obj', 'trace_obj', 'call', 'csh']

  !> What has been read so far
  type :: state_t
    integer :: n_vertices = 0, n_faces = 0, n_corners = 0
    !> Largest number of a vertex that was not there yet, and where it stands
    integer :: ahead = 0, ahead_at = 0
    !> Parts so far, also those without faces, and objects
    integer :: n_parts = 0, n_objects = 0
  end type state_t

contains

  !> Read an OBJ file.
  subroutine read_obj(text, mesh, error)
    type(mesh_text_t), intent(inout) :: text !! file, not empty
    type(mesh_t), intent(out) :: mesh !! its vertices and faces
    type(error_t), allocatable, intent(out) :: error !! set when this is no OBJ file
    type(state_t) :: state
    logical :: found

    if (index(text%content, achar(0)) > 0) then
      call fail(error, 'this is no OBJ file: it is not text', file=text%path)
      return
    end if
    allocate (mesh%vertex(3, 0), mesh%face_first(0), mesh%face_vertex(0), mesh%part_first(0), mesh%part_object(0))
    call begin_part(state, mesh, is_object=.true.)
    call append_word(mesh%object_name, '')
    do while (text%at <= len(text%content))
      call word_on_line(text, found)
      if (found) call read_statement(text, state, mesh, error)
      if (allocated(error)) return
      call skip_line(text)
    end do
    if (state%ahead > state%n_vertices) then
      call fail_at(text, 'there is no vertex '//to_text(state%ahead)//': the file has '//to_text(state%n_vertices), error, &
                   at=state%ahead_at)
    else if (state%n_vertices == 0) then
      call fail(error, 'this OBJ file holds no vertices', file=text%path)
    else if (state%n_faces == 0) then
      call fail(error, 'this OBJ file holds no faces', file=text%path)
    end if
    if (allocated(error)) return
    call reserve(mesh%face_first, state%n_faces + 1)
    mesh%face_first(state%n_faces + 1) = int(state%n_corners + 1, i4)
    mesh%vertex = mesh%vertex(:, :state%n_vertices)
    mesh%face_first = mesh%face_first(:state%n_faces + 1)
    mesh%face_vertex = mesh%face_vertex(:state%n_corners)
    call drop_empty_parts(state, mesh)
  end subroutine read_obj

  !> Begin a part with the next face, of a new object or of the present one.
  subroutine begin_part(state, mesh, is_object)
    type(state_t), intent(inout) :: state
    type(mesh_t), intent(inout) :: mesh
    logical, intent(in) :: is_object

    if (is_object) state%n_objects = state%n_objects + 1
    state%n_parts = state%n_parts + 1
    call reserve(mesh%part_first, state%n_parts)
    call reserve(mesh%part_object, state%n_parts)
    mesh%part_first(state%n_parts) = int(state%n_faces + 1, i4)
    mesh%part_object(state%n_parts) = int(state%n_objects, i4)
  end subroutine begin_part

  !> Keep the parts that have faces.
  subroutine drop_empty_parts(state, mesh)
    type(state_t), intent(in) :: state
    type(mesh_t), intent(inout) :: mesh
    integer(i4) :: ends(state%n_parts + 1)
    logical :: has_faces(state%n_parts)

    ends = [mesh%part_first(:state%n_parts), int(state%n_faces + 1, i4)]
    has_faces = ends(2:) > ends(:state%n_parts)
    mesh%part_first = [pack(ends(:state%n_parts), has_faces), ends(state%n_parts + 1)]
    mesh%part_object = pack(mesh%part_object(:state%n_parts), has_faces)
  end subroutine drop_empty_parts

  !> Read the name of an object: the rest of its line.
  subroutine read_object(text, state, mesh)
    type(mesh_text_t), intent(inout) :: text
    type(state_t), intent(inout) :: state
    type(mesh_t), intent(inout) :: mesh
    character(len=:), allocatable :: name
    logical :: found

    name = ''
    do
      call word_on_line(text, found)
      if (.not. found) exit
      if (name /= '') name = name//' '
      name = name//present_word(text, longest_name)
    end do
    call begin_part(state, mesh, is_object=.true.)
    call append_word(mesh%object_name, name)
  end subroutine read_object

  !> Read the name of a group: that of a part of an object, or another one.
  subroutine read_group(text, state, mesh)
    type(mesh_text_t), intent(inout) :: text
    type(state_t), intent(inout) :: state
    type(mesh_t), intent(inout) :: mesh
    logical :: found

    call word_on_line(text, found)
    if (.not. found) return
    if (present_word(text, len(part_name)) == part_name) call begin_part(state, mesh, is_object=.false.)
  end subroutine read_group

  !> Read one line, whose first word has been read.
  subroutine read_statement(text, state, mesh, error)
    type(mesh_text_t), intent(inout) :: text
    type(state_t), intent(inout) :: state
    type(mesh_t), intent(inout) :: mesh
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: word
    integer :: at

    at = text%first
    word = present_word(text, 20)
    if (word(1:1) == '#' .or. any(others == word)) return
    select case (word)
    case ('v')
      call read_vertex(text, state, mesh, at, error)
    case ('f')
      call read_face(text, state, mesh, at, error)
    case ('o')
      call read_object(text, state, mesh)
    case ('g')
      call read_group(text, state, mesh)
    case default
      ! What begins without a vertex is some other file, whose content must not get into logs.
      if (state%n_vertices == 0) then
        call fail(error, 'this is no OBJ file: a line before its first vertex is no statement of one', file=text%path)
      else
        call fail_at(text, '"'//word//'" is no statement of an OBJ file', error)
      end if
    end select
  end subroutine read_statement

  !> Read a vertex: three coordinates; a weight or colours may follow.
  subroutine read_vertex(text, state, mesh, at, error)
    type(mesh_text_t), intent(inout) :: text
    type(state_t), intent(inout) :: state
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: at
    type(error_t), allocatable, intent(out) :: error
    integer :: k
    logical :: found

    state%n_vertices = state%n_vertices + 1
    call reserve(mesh%vertex, 3, state%n_vertices)
    do k = 1, 3
      call word_on_line(text, found)
      if (found) then
        call read_number(text, mesh%vertex(k, state%n_vertices), error)
      else
        call fail_at(text, 'a vertex needs three coordinates', error, at=at)
      end if
      if (allocated(error)) return
    end do
  end subroutine read_vertex

  !> Read a face: three corners or more.
  subroutine read_face(text, state, mesh, at, error)
    type(mesh_text_t), intent(inout) :: text
    type(state_t), intent(inout) :: state
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: at
    type(error_t), allocatable, intent(out) :: error
    integer :: n, corner
    logical :: found

    state%n_faces = state%n_faces + 1
    call reserve(mesh%face_first, state%n_faces)
    mesh%face_first(state%n_faces) = int(state%n_corners + 1, i4)
    n = 0
    do
      call word_on_line(text, found)
      if (.not. found) exit
      if (text%content(text%first:text%first) == '#') exit
      call read_corner(text, state, corner, error)
      if (allocated(error)) return
      n = n + 1
      state%n_corners = state%n_corners + 1
      call reserve(mesh%face_vertex, state%n_corners)
      mesh%face_vertex(state%n_corners) = int(corner, i4)
    end do
    if (n < 3) call fail_at(text, 'this face has '//to_text(n)//trim(merge(' vertex;  ', ' vertices;', n == 1))// &
                            ' it needs 3 or more', error, at=at)
  end subroutine read_face

  !> Read a corner of a face: the number of a vertex, before the first slash.
  subroutine read_corner(text, state, corner, error)
    type(mesh_text_t), intent(in) :: text
    type(state_t), intent(inout) :: state
    integer, intent(out) :: corner
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: word
    logical :: is_number

    word = present_word(text, 40)
    call parse_corner(word, corner, is_number)
    if (.not. is_number) then
      call fail_at(text, '"'//word//'" is not the number of a vertex', error)
    else if (corner == 0) then
      call fail_at(text, 'there is no vertex 0: they are numbered from 1', error)
    else if (corner < -state%n_vertices) then
      call fail_at(text, 'there is no vertex '//to_text(corner)//': '//to_text(state%n_vertices)//' come before this line', error)
    else if (corner < 0) then
      corner = state%n_vertices + 1 + corner
    else if (corner > state%n_vertices .and. corner > state%ahead) then
      ! It may be given further on.
      state%ahead = corner
      state%ahead_at = text%first
    end if
  end subroutine read_corner

  !> The whole number before the first slash of a word, of nine digits at most.
  pure subroutine parse_corner(word, corner, is_number)
    character(len=*), intent(in) :: word
    integer, intent(out) :: corner
    logical, intent(out) :: is_number
    integer :: i, first, last, digit

    corner = 0
    last = scan(word, '/') - 1
    if (last < 0) last = len(word)
    first = 1
    if (word(1:1) == '-') first = 2
    is_number = last >= first .and. last - first < 9 .and. verify(word(last + 1:), '0123456789/-') == 0
    do i = first, last
      digit = iachar(word(i:i)) - iachar('0')
      if (digit < 0 .or. digit > 9) is_number = .false.
      if (.not. is_number) return
      corner = 10*corner + digit
    end do
    if (first == 2) corner = -corner
  end subroutine parse_corner
end module sg_mesh_files_obj
