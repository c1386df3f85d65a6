!> Mesh files: STL of bytes and of text, OBJ; what is read, and what is wrong with files.
program test_mesh_files
  use, intrinsic :: iso_fortran_env, only: int16, int32, int64, real32
  use harness, only: tests_t
  use polyhedra, only: check_whole, cube_triangles, expect_part, globe, none, rounding, unit_cube
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_mesh_files, only: mesh_t, read_mesh
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces
  use sg_polyhedron_moments, only: solid_t, surface_solid
  use sg_random, only: random_t
  use sg_system, only: remove_file
  use written_files, only: put_text
  implicit none
  type(tests_t) :: t
  character, parameter :: nl = new_line('a')
  character(len=*), parameter :: corners = 'v 0 0 0'//nl//'v 1 0 0'//nl//'v 0 1 0'//nl//'v 0 0 1'//nl

  call test_stl_of_bytes()
  call test_stl_of_text()
  call test_obj()
  call test_faults_of_bytes()
  call test_numbers()
  call test_faults_of_text()
  call test_faults_of_obj()
  call test_large()
  call t%finish()

contains

  !> A cube of bytes, also with a head that says "solid".
  subroutine test_stl_of_bytes()
    call write_bytes('cube.stl', 'made by hand', unit_cube(), cube_triangles(), 12)
    call check_cube('cube.stl', 8, 12)
    call write_bytes('CUBE.STL', 'solid as a rock', unit_cube(), cube_triangles(), 12)
    call check_cube('CUBE.STL', 8, 12)
  end subroutine test_stl_of_bytes

  subroutine test_stl_of_text()
    character(len=:), allocatable :: text
    type(mesh_t) :: mesh
    type(error_t), allocatable :: error

    text = 'solid two words'//nl//facets(unit_cube(), cube_triangles(), nl)//'endsolid two words'//nl
    call put_text('cube_of_text.stl', text)
    call check_cube('cube_of_text.stl', 8, 12)
    ! Returns at line ends, capital letters, all of a solid on a line, two solids in a file.
    text = facets(unit_cube(), cube_triangles(), ' ')
    call put_text('odd.stl', '  SOLID'//achar(13)//nl//text//nl//'EndSolid'//achar(13)//nl// &
                  'solid b'//nl//'endsolid b')
    call check_cube('odd.stl', 8, 12)
    call put_text('one.stl', 'solid'//nl//'facet normal nan nan nan'//nl//'outer loop'//nl//'vertex 1 2.5 -3e0'//nl// &
                  'vertex 1.d0 .5 +3.'//nl//'vertex 0 0 0'//nl//'endloop'//nl//'endfacet'//nl//'endsolid')
    call read_mesh('one.stl', mesh, error)
    call none(t, error, 'numbers in all forms, and a normal that is none')
    call t%check(maxval(abs(mesh%vertex(:, 1) - [1.0_wp, 2.5_wp, -3.0_wp])) < rounding, 'first vertex')
    call t%check(maxval(abs(mesh%vertex(:, 2) - [1.0_wp, 0.5_wp, 3.0_wp])) < rounding, 'second vertex')
  end subroutine test_stl_of_text

  subroutine test_obj()
    character(len=:), allocatable :: text
    type(mesh_t) :: mesh
    type(error_t), allocatable :: error
    integer :: k
    character(len=60) :: line
    real(wp) :: cube(3, 8)

    cube = unit_cube()
    text = '# a cube'//nl//'mtllib x.mtl'//nl//'o cube'//nl
    do k = 1, 8
      write (line, '(a,3f5.1)') 'v ', cube(:, k)
      text = text//trim(line)//nl
    end do
    call put_text('cube.obj', text//'vn 0 0 1'//nl//'vt 0 0'//nl//'s off'//nl// &
                  'f 1 3 4 2'//nl//'f 5/1 6/1 8/1 7/1'//nl//'f 1//1 2//1 6//1 5//1'//nl//'f 3/1/1 7/1/1 8/1/1 4/1/1'//nl// &
                  'f -8 -4 -2 -6 # the same'//nl//'f 2 4 \'//nl//' 8 6'//nl)
    call check_cube('cube.obj', 8, 6)
    ! Faces before vertices, returns at line ends, no end of the last line, repeated vertices.
    call put_text('late.obj', 'f 1 3 2'//achar(13)//nl//'f 1 2 4'//achar(13)//nl//'f 2 3 4'//nl//'f 5 4 3'//nl// &
                  corners//'v 0 0 0')
    call read_mesh('late.obj', mesh, error)
    call none(t, error, 'faces before vertices')
    call t%equal(size(mesh%vertex, 2), 4, 'a repeated vertex is one')
    call t%equal(int(mesh%face_vertex(10)), 1, 'the first')
  end subroutine test_obj

  subroutine test_faults_of_bytes()
    type(mesh_t) :: mesh
    type(error_t), allocatable :: error
    real(wp) :: cube(3, 8)

    call write_bytes('cut.stl', 'cut short', unit_cube(), cube_triangles(), 13)
    call read_mesh('cut.stl', mesh, error)
    call expect_report(error, 'cut.stl: error: this binary STL file is cut short, or none: '// &
                       '13 triangles need 734 bytes, and there are 684')
    call write_bytes('long.stl', 'too long', unit_cube(), cube_triangles(), 11)
    call read_mesh('long.stl', mesh, error)
    call expect_part(t, error, 'longer than its 11 triangles')
    call write_bytes('many.stl', 'a count below zero', unit_cube(), cube_triangles(), -1)
    call read_mesh('many.stl', mesh, error)
    call expect_part(t, error, '4294967295 triangles need 214748364834 bytes')
    call put_text('short.stl', 'not')
    call read_mesh('short.stl', mesh, error)
    call expect_part(t, error, 'this is no STL file: it neither begins with "solid" nor has the 84 bytes that head a binary one')
    call put_text('empty.stl', '')
    call read_mesh('empty.stl', mesh, error)
    call expect_report(error, 'empty.stl: error: this mesh file is empty')
    call put_text('none.stl', repeat(achar(0), 84))
    call read_mesh('none.stl', mesh, error)
    call expect_part(t, error, 'this STL file holds no triangles')
    call read_mesh('missing.stl', mesh, error)
    call expect_part(t, error, 'cannot read the file')
    call read_mesh('mesh.ply', mesh, error)
    call expect_report(error, 'mesh.ply: error: the name of a mesh file ends in .stl or .obj')
    call read_mesh('x', mesh, error)
    call expect_part(t, error, 'ends in .stl or .obj')
    cube = unit_cube()
    call write_bytes('nan.stl', 'not a number', cube, cube_triangles(), 12, broken=3)
    call read_mesh('nan.stl', mesh, error)
    call expect_report(error, 'nan.stl: error: a coordinate of triangle 3 is not finite')
  end subroutine test_faults_of_bytes

  !> An error with its place, as the user reads it.
  subroutine expect_report(error, report)
    type(error_t), allocatable, intent(in) :: error
    character(len=*), intent(in) :: report

    if (allocated(error)) then
      call t%check(error%report() == report, 'reported "'//error%report()//'" rather than "'//report//'"')
    else
      call t%check(.false., 'nothing was reported rather than "'//report//'"')
    end if
  end subroutine expect_report

  !> Numbers of all forms and lengths are what Fortran reads, to the last bit.
  subroutine test_numbers()
    type(random_t) :: random
    type(mesh_t) :: mesh
    type(error_t), allocatable :: error
    character(len=40) :: word
    character(len=:), allocatable :: content
    real(wp) :: values(3, 1000), x
    integer :: i, k

    call random%seed(31)
    content = 'f 1 2 3'//nl
    do i = 1, size(values, 2)
      content = content//'v'
      do k = 1, 3
        x = random%uniform(-1.0_wp, 1.0_wp)*10.0_wp**nint(random%uniform(-30.0_wp, 30.0_wp))
        select case (mod(i, 5))
        case (0)
          write (word, '(es25.16e3)') x
        case (1)
          write (word, '(es20.6)') x
        case (2)
          write (word, '(d14.7)') x
        case (3)
          write (word, '(f24.12)') random%uniform(-1e4_wp, 1e4_wp)
        case default
          write (word, '(es25.14)') x
        end select
        read (word, *) values(k, i)
        content = content//' '//trim(adjustl(word))
      end do
      content = content//nl
    end do
    call put_text('numbers.obj', content)
    call read_mesh('numbers.obj', mesh, error)
    call none(t, error, 'numbers of all forms')
    call t%equal(size(mesh%vertex, 2), size(values, 2), 'all vertices')
    call t%check(maxval(abs(mesh%vertex - values)) <= 0, 'are what Fortran reads')
    call remove_file('numbers.obj')
    call put_text('numbers.obj', 'f 1 2 3'//nl//'v -0 .5 5.'//nl//'v +1 1E1 -2d-1'//nl//'v 0e99 1e-400 000000000000000000001'//nl)
    call read_mesh('numbers.obj', mesh, error)
    call none(t, error, 'odd forms')
    call t%check(maxval(abs(mesh%vertex - reshape([0.0_wp, 0.5_wp, 5.0_wp, 1.0_wp, 10.0_wp, -0.2_wp, 0.0_wp, 0.0_wp, 1.0_wp], &
                                                  [3, 3]))) <= 0, 'are read')
    call fault('bad.obj', 'v 0 0 .', '"." is not a finite number', 1, 7)
    call fault('bad.obj', 'v 0 0 1e', '"1e" is not a finite number', 1, 7)
    call fault('bad.obj', 'v 0 0 1e+', '"1e+" is not a finite number', 1, 7)
    call fault('bad.obj', 'v 0 0 1-5', '"1-5" is not a finite number', 1, 7)
    call fault('bad.obj', 'v 0 0 e5', '"e5" is not a finite number', 1, 7)
    call fault('bad.obj', 'v 0 0 1e12345', '"1e12345" is too large for a coordinate', 1, 7)
  end subroutine test_numbers

  subroutine test_faults_of_text()
    character(len=*), parameter :: head = 'solid a'//nl//'facet normal 0 0 1'//nl//'outer loop'//nl, &
                                   three = 'vertex 0 0 0'//nl//'vertex 1 0 0'//nl//'vertex 0 1 0'//nl

    call fault('bad.stl', head//three, 'this STL file is cut short: it ends without "endsolid"', 0, 0)
    call fault('bad.stl', head//'vertex 0 0', 'this STL file is cut short: it ends within a vertex', 0, 0)
    call fault('bad.stl', head//'vertex 0 0 0'//nl//'vertex 0 1 0'//nl//'endloop'//nl, &
               'this facet has 2 vertices and a triangle has 3', 6, 1)
    call fault('bad.stl', head//'vertex 0 0 0'//nl//'endloop'//nl, 'this facet has 1 vertex and', 5, 1)
    call fault('bad.stl', head//three//'vertex 0 0 5'//nl//'endloop', 'this facet has more than 3 vertices', 7, 1)
    call fault('bad.stl', head//'  vertex 0 nan 0'//nl, '"nan" is not a finite number', 4, 12)
    call fault('bad.stl', head//'  vertex 0 0 1e999'//nl, '"1e999" is too large for a coordinate', 4, 14)
    call fault('bad.stl', head//'vertex 0 0 inf'//nl, '"inf" is not a finite number', 4, 12)
    call fault('bad.stl', head//'vertex 0 0 1..2'//nl, '"1..2" is not a finite number', 4, 12)
    call fault('bad.stl', head//'vertex 0 0 endloop'//nl, '"endloop" is not a finite number', 4, 12)
    call fault('bad.stl', head//'vertex 0 0 '//repeat('1', 50), repeat('1', 40)//'" is not a finite number', 4, 12)
    call fault('bad.stl', 'solid'//nl//'outer loop'//nl, '"facet" or "endsolid" should stand here, not "outer"', 2, 1)
    call fault('bad.stl', 'solid'//nl//'facet'//nl//'outer'//nl//'vertex', '"facet normal" should stand here', 3, 1)
    call fault('bad.stl', 'solid'//nl//'facet normal 0 0 1'//nl//'outer'//nl//'vertex', '"outer loop" should stand here', 4, 1)
    call fault('bad.stl', head//three//'endfacet', '"endloop" should stand here, not "endfacet"', 7, 1)
    call fault('bad.stl', 'solid'//nl//'endsolid'//nl//'body', 'only "solid" may stand between solids', 3, 1)
    call fault('bad.stl', 'solid'//nl//'endsolid', 'this STL file holds no triangles', 0, 0)
  end subroutine test_faults_of_text

  subroutine test_faults_of_obj()
    call fault('bad.obj', corners//'f 1 2'//nl, 'this face has 2 vertices; it needs 3 or more', 5, 1)
    call fault('bad.obj', corners//'f'//nl, 'this face has 0 vertices; it needs 3 or more', 5, 1)
    call fault('bad.obj', corners//'f 1 2 3'//nl//'f 1 2 5'//nl//'f 1 2 7'//nl//'f 1 2 6', &
               'there is no vertex 7: the file has 4', 7, 7)
    call fault('bad.obj', corners//'f 1 2 -5'//nl, 'there is no vertex -5: 4 come before this line', 5, 7)
    call fault('bad.obj', corners//'f 1 2 0'//nl, 'there is no vertex 0: they are numbered from 1', 5, 7)
    call fault('bad.obj', corners//'f 1 2 x'//nl, '"x" is not the number of a vertex', 5, 7)
    call fault('bad.obj', corners//'f 1 2 /3'//nl, '"/3" is not the number of a vertex', 5, 7)
    call fault('bad.obj', corners//'f 1 2 99999999999'//nl, '"99999999999" is not the number of a vertex', 5, 7)
    call fault('bad.obj', corners//'f 1 2 9999999999'//nl, '"9999999999" is not the number of a vertex', 5, 7)
    call fault('bad.obj', corners//'f 1 2 1-3'//nl, '"1-3" is not the number of a vertex', 5, 7)
    call fault('bad.obj', 'v 0 0'//nl, 'a vertex needs three coordinates', 1, 1)
    call fault('bad.obj', 'v 0 0 NaN'//nl, '"NaN" is not a finite number', 1, 7)
    call fault('bad.obj', corners//'hello world'//nl, '"hello" is no statement of an OBJ file', 5, 1)
    call fault('bad.obj', 'hello world'//nl, 'a line before its first vertex is no statement', 0, 0)
    call fault('bad.obj', corners, 'this OBJ file holds no faces', 0, 0)
    call fault('bad.obj', '# nothing'//nl, 'this OBJ file holds no vertices', 0, 0)
    call fault('bad.obj', 'v 0 0 0'//achar(0), 'this is no OBJ file: it is not text', 0, 0)
    call fault('bad.obj', corners//'f 1 2'//repeat(' ', 200), 'this face has 2 vertices; it needs 3 or more', 5, 1)
  end subroutine test_faults_of_obj

  !> A hundred thousand triangles, of bytes and of text: read whole.
  subroutine test_large()
    real(wp), allocatable :: vertices(:, :)
    integer(i4), allocatable :: list(:, :)
    integer :: unit, i, slash

    call globe(160, vertices, list)
    call write_bytes('large.stl', 'a globe', vertices, list, size(list, 2))
    call read_large('large.stl', vertices, list)
    open (newunit=unit, file='large.obj', status='replace', action='write')
    do i = 1, size(vertices, 2)
      write (unit, '(a,3(1x,f0.9))') 'v', vertices(:, i)
    end do
    do i = 1, size(list, 2)
      write (unit, '(a,3(1x,i0,a))') 'f', (list(slash, i), '/1', slash=1, 3)
    end do
    close (unit)
    call read_large('large.obj', vertices, list)
    call remove_file('large.stl')
    call remove_file('large.obj')
  end subroutine test_large

  !> Read a large file, and compare vertices and volume with what was written.
  subroutine read_large(name, vertices, list)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: vertices(:, :)
    integer(i4), intent(in) :: list(:, :)
    type(mesh_t) :: mesh
    type(error_t), allocatable :: error
    type(solid_t) :: got, expected
    integer(int64) :: begin, finish, rate
    integer :: i

    call system_clock(begin, rate)
    call read_mesh(name, mesh, error)
    call system_clock(finish)
    call none(t, error, name//' is read')
    write (*, '(3a,f0.2,a)') 'reading ', name, ' took ', real(finish - begin, wp)/real(rate, wp), ' s'
    call t%equal(size(mesh%vertex, 2), size(vertices, 2), name//': vertices')
    call t%equal(size(mesh%face_first) - 1, size(list, 2), name//': faces')
    got = surface_solid(mesh%vertex, mesh%face_first, mesh%face_vertex)
    expected = surface_solid(vertices, [(int(3*i - 2, i4), i=1, size(list, 2) + 1)], reshape(list, [size(list)]))
    ! Coordinates are kept to 3e-8 at least.
    call t%near(got%volume, expected%volume, 1e-6_wp, name//': volume')
  end subroutine read_large

  !> A cube of side one in a file.
  subroutine check_cube(name, n_vertices, n_faces)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n_vertices, n_faces
    type(mesh_t) :: mesh
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error

    call read_mesh(name, mesh, error)
    call none(t, error, name//' is read')
    if (allocated(error)) return
    call t%equal(size(mesh%vertex, 2), n_vertices, name//': vertices')
    call t%equal(size(mesh%face_first) - 1, n_faces, name//': faces')
    call t%check(maxval(abs(mesh%vertex(:, 1))) < rounding, name//': the first vertex is the first in the file')
    call polyhedron_from_faces(mesh%vertex, mesh%face_first, mesh%face_vertex, shape, error)
    call none(t, error, name//' is a polyhedron')
    call check_whole(t, shape, 8, 12, 6, name)
    call t%near(maxval(shape%vertex), 1.0_wp, rounding, name//': size')
  end subroutine check_cube

  !> A file with this content is refused with this sentence at this place; 0 where there is none.
  subroutine fault(name, content, words, line, column)
    character(len=*), intent(in) :: name, content, words
    integer, intent(in) :: line, column
    type(mesh_t) :: mesh
    type(error_t), allocatable :: error

    call put_text(name, content)
    call read_mesh(name, mesh, error)
    call expect_part(t, error, words)
    if (.not. allocated(error)) return
    call t%check(error%file == name, words//': file')
    call t%equal(error%line, line, words//': line')
    call t%equal(error%column, column, words//': column')
    call t%check(allocated(error%text) .eqv. (line > 0 .and. len(content) < 200), words//': the line is shown')
    call remove_file(name)
  end subroutine fault

  !> Facets of an STL file of text, words apart by blanks or lines.
  function facets(vertices, list, between) result(text)
    real(wp), intent(in) :: vertices(:, :)
    integer(i4), intent(in) :: list(:, :)
    character, intent(in) :: between
    character(len=:), allocatable :: text
    character(len=60) :: line
    integer :: f, k

    text = ''
    do f = 1, size(list, 2)
      text = text//'facet normal 0 0 0'//between//'outer loop'//between
      do k = 1, 3
        write (line, '(a,3es14.6)') 'vertex', vertices(:, list(k, f))
        text = text//trim(line)//between
      end do
      text = text//'endloop'//between//'endfacet'//nl
    end do
  end function facets

  !> Write an STL file of bytes that says it has `n_said` triangles; one may have a corner that is no number.
  subroutine write_bytes(name, head, vertices, list, n_said, broken)
    character(len=*), intent(in) :: name, head
    real(wp), intent(in) :: vertices(:, :)
    integer(i4), intent(in) :: list(:, :)
    integer, intent(in) :: n_said
    integer, intent(in), optional :: broken
    character(len=80) :: padded
    integer :: unit, f, k
    integer(int32) :: bits(12)

    padded = head
    open (newunit=unit, file=name, access='stream', form='unformatted', status='replace', action='write')
    write (unit) padded, int(n_said, int32)
    do f = 1, size(list, 2)
      bits(:3) = 0
      do k = 1, 3
        bits(3*k + 1:3*k + 3) = transfer(real(vertices(:, list(k, f)), real32), bits(:3))
      end do
      if (present(broken)) then
        if (f == broken) bits(8) = int(z'7FC00001', int32)
      end if
      write (unit) bits, 0_int16
    end do
    close (unit)
  end subroutine write_bytes
end program test_mesh_files
