!> STL files, of bytes or of text: loose triangles, whose normals are not looked at.
!!
!! A file of bytes holds 80 that mean nothing, the number of triangles, and 50 bytes a triangle: twelve reals of 32 bits
!! (normal and corners) and two bytes of colour, little end first. A file of text:
!!
!!     solid name
!!       facet normal 0 0 1
!!         outer loop
!!           vertex 0 0 0
!!           vertex 1 0 0
!!           vertex 0 1 0
!!         endloop
!!       endfacet
!!     endsolid name
module sg_mesh_files_stl
  use, intrinsic :: iso_fortran_env, only: int32, real32
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, i8
  use sg_lists, only: reserve
  use sg_mesh_files_text, only: fail_at, mesh_t, mesh_text_t, next_word, present_word, read_number, skip_line
  use sg_text, only: lower, to_text
  implicit none
  private
  public :: read_stl

  !> Bytes before the first triangle, and bytes of a triangle
  integer, parameter :: header = 84, record = 50
  !> The words of a facet in their order; `normal` and `loop` belong to those before them
  character(len=8), parameter :: words(7) = [character(len=8) :: 'facet', 'outer', 'vertex', 'vertex', 'vertex', 'endloop', &
                                            'endfacet']

contains

  !> Read an STL file, of bytes or of text, whichever it is.
  subroutine read_stl(text, mesh, error)
    type(mesh_text_t), intent(inout) :: text !! file, not empty
    type(mesh_t), intent(out) :: mesh !! its triangles, no vertex shared
    type(error_t), allocatable, intent(out) :: error !! set when this is no STL file
    integer(i8) :: n, length
    logical :: has_words

    length = int(len(text%content), i8)
    n = -1
    if (length >= header) n = unsigned(text%content(header - 3:header))
    call next_word(text, has_words)
    if (has_words) has_words = lower(present_word(text, 6)) == 'solid'
    text%at = 1
    ! Some files of bytes begin with "solid" too: the length decides.
    if (n >= 0 .and. length == header + record*n) then
      call read_bytes(text, int(n), mesh, error)
    else if (has_words) then
      call read_words(text, mesh, error)
    else if (n < 0) then
      call fail(error, 'this is no STL file: it neither begins with "solid" nor has the '//to_text(header)// &
                ' bytes that head a binary one', file=text%path)
    else if (length < header + record*n) then
      call fail(error, 'this binary STL file is cut short, or none: '//to_text(n)//' triangles need '// &
                to_text(header + record*n)//' bytes, and there are '//to_text(length), file=text%path)
    else
      call fail(error, 'this binary STL file is longer than its '//to_text(n)//' triangles, or is none: they need '// &
                to_text(header + record*n)//' bytes, and there are '//to_text(length), file=text%path)
    end if
    if (allocated(error)) return
    if (size(mesh%face_vertex) == 0) call fail(error, 'this STL file holds no triangles', file=text%path)
  end subroutine read_stl

  !> Four bytes as a whole number without a sign, the little end first.
  pure integer(i8) function unsigned(bytes)
    character(len=4), intent(in) :: bytes
    integer :: k

    unsigned = 0
    do k = 4, 1, -1
      unsigned = 256*unsigned + int(ichar(bytes(k:k)), i8)
    end do
  end function unsigned

  !> Read the triangles of a file of bytes.
  subroutine read_bytes(text, n, mesh, error)
    type(mesh_text_t), intent(in) :: text
    integer, intent(in) :: n
    type(mesh_t), intent(out) :: mesh
    type(error_t), allocatable, intent(out) :: error
    integer :: f, k, c, at
    integer(i8) :: bits

    allocate (mesh%vertex(3, 3*n), mesh%face_first(n + 1), mesh%face_vertex(3*n))
    mesh%face_first = [(int(3*f - 2, i4), f=1, n + 1)]
    mesh%face_vertex = [(int(k, i4), k=1, 3*n)]
    do f = 1, n
      do k = 1, 3
        do c = 1, 3
          at = header + record*(f - 1) + 12*k + 4*c - 3
          bits = unsigned(text%content(at:at + 3))
          ! All bits of the exponent set: looked at before it is made a real, which a debug build would not survive.
          if (ibits(bits, 23, 8) == 255) then
            call fail(error, 'a coordinate of triangle '//to_text(f)//' is not finite', file=text%path)
            return
          end if
          if (btest(bits, 31)) bits = bits - 2_i8**32
          mesh%vertex(c, 3*f - 3 + k) = real(transfer(int(bits, int32), 0.0_real32), wp)
        end do
      end do
    end do
  end subroutine read_bytes

  !> Read the triangles of a file of text.
  subroutine read_words(text, mesh, error)
    type(mesh_text_t), intent(inout) :: text
    type(mesh_t), intent(out) :: mesh
    type(error_t), allocatable, intent(out) :: error
    integer :: state, n, f
    logical :: is_open

    n = 0
    state = 1
    call open_solid(text, is_open)
    do while (is_open)
      call read_facet_word(text, state, n, mesh, is_open, error)
      if (allocated(error)) return
      ! Another solid may follow.
      if (.not. is_open) call open_solid(text, is_open)
    end do
    if (text%at <= len(text%content)) then
      call fail_at(text, 'only "solid" may stand between solids', error)
      return
    end if
    if (n == 0) allocate (mesh%vertex(3, 0))
    mesh%vertex = mesh%vertex(:, :n)
    mesh%face_first = [(int(3*f - 2, i4), f=1, n/3 + 1)]
    mesh%face_vertex = [(int(f, i4), f=1, n)]
  end subroutine read_words

  !> Read the head of a solid; false at the end of the file or where something else stands.
  subroutine open_solid(text, is_open)
    type(mesh_text_t), intent(inout) :: text
    logical, intent(out) :: is_open

    call next_word(text, is_open)
    if (.not. is_open) return
    is_open = lower(present_word(text, 20)) == 'solid'
    if (is_open) then
      call skip_line(text)
    else
      text%at = text%first
    end if
  end subroutine open_solid

  !> Read one word of a facet and what belongs to it, or the end of the solid.
  subroutine read_facet_word(text, state, n, mesh, is_open, error)
    type(mesh_text_t), intent(inout) :: text
    integer, intent(inout) :: state, n
    type(mesh_t), intent(inout) :: mesh
    logical, intent(inout) :: is_open
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: word
    logical :: found

    call next_word(text, found)
    if (.not. found) then
      call fail(error, 'this STL file is cut short: it ends without "endsolid"', file=text%path)
      return
    end if
    word = lower(present_word(text, 20))
    if (state == 1 .and. word == 'endsolid') then
      call skip_line(text)
      is_open = .false.
    else if (word == words(state)) then
      call read_rest(text, word, n, mesh, error)
      state = 1 + mod(state, size(words))
    else if (word == 'endloop' .and. words(state) == 'vertex') then
      call fail_at(text, 'this facet has '//to_text(state - 3)//trim(merge(' vertex  ', ' vertices', state == 4))// &
                   ' and a triangle has 3', error)
    else if (word == 'vertex' .and. words(state) == 'endloop') then
      call fail_at(text, 'this facet has more than 3 vertices', error)
    else if (state == 1) then
      call fail_at(text, '"facet" or "endsolid" should stand here, not "'//word//'"', error)
    else
      call fail_at(text, '"'//trim(words(state))//'" should stand here, not "'//word//'"', error)
    end if
  end subroutine read_facet_word

  !> Read what belongs to a word: the normal, which is left alone; the word `loop`; or the coordinates of a vertex.
  subroutine read_rest(text, word, n, mesh, error)
    type(mesh_text_t), intent(inout) :: text
    character(len=*), intent(in) :: word
    integer, intent(inout) :: n
    type(mesh_t), intent(inout) :: mesh
    type(error_t), allocatable, intent(out) :: error
    integer :: k
    logical :: found

    select case (word)
    case ('facet')
      call next_word(text, found)
      if (found) found = lower(present_word(text, 20)) == 'normal'
      if (.not. found) call fail_at(text, '"facet normal" should stand here', error)
      ! Triangles without area have normals that are not numbers.
      do k = 1, 3
        call next_word(text, found)
      end do
    case ('outer')
      call next_word(text, found)
      if (found) found = lower(present_word(text, 20)) == 'loop'
      if (.not. found) call fail_at(text, '"outer loop" should stand here', error)
    case ('vertex')
      call reserve(mesh%vertex, 3, n + 1)
      n = n + 1
      do k = 1, 3
        call next_word(text, found)
        if (found) call read_number(text, mesh%vertex(k, n), error)
        if (.not. found) call fail(error, 'this STL file is cut short: it ends within a vertex', file=text%path)
        if (allocated(error)) return
      end do
    end select
  end subroutine read_rest
end module sg_mesh_files_stl
