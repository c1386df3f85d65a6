!> BODIES.DAT of a DATBOX: rigid bodies of the plane, their bulk, node and contactors.
!!
!! LMGC90 takes mass and inertia from the radii of the bulk line, mass = density pi avrd^2 and inertia = mass gyrd^2,
!! not from the shapes; they come from the shapes only where one of the radii is zero.
module sg_datbox_bodies
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_wall
  use sg_datbox_behaviours, only: other_law, other_law_t
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, integer_field, is_block_end, keyword, name_field, &
                             next_data_line, next_line, real_field, step_back
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_moments, only: body_moments, polygon_moments
  use sg_scene, only: colour_index, material_index, scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: read_bodies, find_three_dimensional

  !> Columns of up to three numbers of a line
  integer, parameter :: triple(3) = [35, 56, 77]

  !> What a body's block says before it is turned into the scene's terms
  type :: block_t
    !> Number in order of appearance, and line on which the block begins
    integer :: body = 0, line = 0
    !> Which sections have been seen
    logical :: has_bulk = .false., has_node = .false.
    !> Nothing in the block was wrong so far
    logical :: ok = .true.
    !> Bulk material, and the radii of mass and of gyration [m]
    integer :: material = 0
    real(wp) :: mass_radius = 0, gyration_radius = 0
    !> Node: x, y [m] and angle [rad]
    real(wp) :: node(3) = 0
    !> Contactors of the scene before those of this body
    integer :: before = 0
  end type block_t

contains

  !> Stop at a body of space: one clear mistake says what is three-dimensional.
  subroutine find_three_dimensional(file, found, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT, left at its beginning
    logical, intent(out) :: found !! is there such a body?
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    found = .true.
    do while (next_line(file))
      if (name_field(file, 2) /= 'RBDY3') cycle
      call complain(file, 'RBDY3 is a body in space: only two-dimensional DATBOX folders are read', 2, diagnostics)
      return
    end do
    file%at = 0
    found = .false.
  end subroutine find_three_dimensional

  !> Read all bodies; they are numbered by order of appearance, whatever number the file writes.
  subroutine read_bodies(file, scene, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT at its beginning
    type(scene_t), intent(inout) :: scene !! gets bodies, contactors and colours
    type(other_law_t), intent(inout) :: others(:) !! bulk laws that are not done
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: n

    n = 0
    do while (next_line(file))
      if (keyword(file) == 'bdyty') n = n + 1
    end do
    call scene%bodies%allocate(n)
    file%at = 0
    n = 0
    do while (next_line(file))
      if (keyword(file) == 'bdyty') then
        n = n + 1
        call read_block(file, scene, n, others, diagnostics)
      else
        call complain_once(file, 'stray', 'this line belongs to no body', 1, diagnostics)
      end if
    end do
    if (n == 0 .and. file%n_errors == 0) call complain(file, 'there is no body', 0, diagnostics)
  end subroutine read_bodies

  !> Read one body's block, from $bdyty to $$$$$$.
  subroutine read_block(file, scene, body, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    type(other_law_t), intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(block_t) :: block
    character(len=5) :: section, word

    block%body = body
    block%before = scene%contactors%n
    block%line = file%at
    if (.not. next_data_line(file, 'the type of a body', diagnostics)) return
    if (name_field(file, 2) /= 'RBDY2') then
      call complain_once(file, name_field(file, 2), 'bodies of type '''//name_field(file, 2) &
                         //''' are not done: only RBDY2, rigid in the plane', 2, diagnostics)
      block%ok = .false.
    end if
    section = ''
    do
      if (.not. next_line(file)) then
        call complain(file, 'the file ends within body '//to_text(body)//', before its $$$$$$', 0, diagnostics)
        return
      end if
      word = keyword(file)
      if (word /= '') then
        if (is_block_end(word)) exit
        if (word == 'bdyty') then
          call complain(file, 'a body begins here, but body '//to_text(body)//' has not been ended by $$$$$$', 1, diagnostics)
          call step_back(file)
          return
        end if
        section = word
        if (all(section /= ['blmty', 'nodty', 'tacty'])) call complain_once(file, section, &
          'the keyword '''//section//''' has no place in a rigid body', 1, diagnostics)
      else if (block%ok) then
        call read_section_line(file, scene, block, section, others, diagnostics)
      end if
    end do
    if (block%ok) call complete_body(file, scene, block, diagnostics)
  end subroutine read_block

  !> Read one line of data within a body's block.
  subroutine read_section_line(file, scene, block, section, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(block_t), intent(inout) :: block
    character(len=*), intent(in) :: section
    type(other_law_t), intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics

    select case (section)
    case ('blmty')
      call read_bulk(file, scene, block, others, diagnostics)
    case ('nodty')
      call read_node(file, block, diagnostics)
    case ('tacty')
      call read_contactor(file, scene, block, diagnostics)
    case default
      call complain_once(file, 'out of place', 'this line belongs to no section of the body', 1, diagnostics)
    end select
  end subroutine read_section_line

  !> Read the bulk line: material, radius of mass, radius of gyration.
  subroutine read_bulk(file, scene, block, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene
    type(block_t), intent(inout) :: block
    type(other_law_t), intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name
    integer :: other

    if (name_field(file, 2) /= 'PLAIN' .or. block%has_bulk) then
      call complain(file, 'a rigid body has one bulk element, PLAIN', 2, diagnostics)
      block%ok = .false.
      return
    end if
    block%has_bulk = .true.
    name = name_field(file, 23)
    block%material = material_index(scene, name)
    if (block%material == 0) then
      block%ok = .false.
      other = other_law(others, name)
      if (other > 0) then
        call complain_once(file, 'bulk '//name, 'the bulk law '''//name//''' is '//others(other)%law//', which is not done', &
                           23, diagnostics)
      else
        call complain_once(file, 'bulk '//name, 'no bulk law is called '''//name//'''', 23, diagnostics)
      end if
    end if
    call read_size(file, triple(1), block%mass_radius, .false., block%ok, diagnostics)
    call read_size(file, triple(2), block%gyration_radius, .false., block%ok, diagnostics)
  end subroutine read_bulk

  !> Read the node: place and angle.
  subroutine read_node(file, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(block_t), intent(inout) :: block
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: i

    if (name_field(file, 2) /= 'NO3xx' .or. block%has_node) then
      call complain(file, 'a rigid body of the plane has one node, NO3xx', 2, diagnostics)
      block%ok = .false.
      return
    end if
    block%has_node = .true.
    do i = 1, 3
      call real_field(file, triple(i), block%node(i), block%ok, diagnostics)
    end do
  end subroutine read_node

  !> Read one contactor with its further lines.
  subroutine read_contactor(file, scene, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(block_t), intent(inout) :: block
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: colour
    real(wp) :: size_of(2), shift(2)
    logical :: ok

    call colour_index(scene, name_field(file, 23), colour)
    ok = .true.
    shift = 0
    select case (name_field(file, 2))
    case ('DISKx', 'DISKb')
      call read_size(file, triple(1), size_of(1), .true., ok, diagnostics)
      if (name_field(file, 2) == 'DISKb') call read_point(file, 'the centre of a shifted disk', shift, ok, diagnostics)
      if (ok) call add_disk(scene%contactors, block%body, colour, size_of(1), shift)
    case ('xKSID')
      call read_size(file, triple(1), size_of(1), .true., ok, diagnostics)
      if (ok) call add_hollow(scene%contactors, block%body, colour, size_of(1), shift)
    case ('JONCx')
      call read_size(file, triple(1), size_of(1), .true., ok, diagnostics)
      call read_size(file, triple(2), size_of(2), .true., ok, diagnostics)
      if (ok) call add_wall(scene%contactors, block%body, colour, size_of(1), size_of(2), shift, 0.0_wp)
    case ('POLYG')
      call read_polygon(file, scene, block%body, colour, ok, diagnostics)
    case default
      call complain_once(file, name_field(file, 2), 'contactors of type '''//name_field(file, 2) &
                         //''' are not done: only DISKx, DISKb, xKSID, JONCx and POLYG', 2, diagnostics)
      ok = .false.
    end select
    block%ok = block%ok .and. ok
  end subroutine read_contactor

  !> Read a length: not negative, or positive.
  subroutine read_size(file, first, length, is_positive, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: first
    real(wp), intent(out) :: length
    logical, intent(in) :: is_positive
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    logical :: good

    good = .true.
    call real_field(file, first, length, good, diagnostics)
    if (good .and. is_positive .and. .not. length > 0) then
      call complain(file, 'a size must be positive', first, diagnostics)
      good = .false.
    else if (good .and. length < 0) then
      call complain(file, 'a size must not be negative', first, diagnostics)
      good = .false.
    end if
    ok = ok .and. good
  end subroutine read_size

  !> Read a line that holds a point relative to the node.
  subroutine read_point(file, what, point, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: what
    real(wp), intent(out) :: point(2)
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: i

    point = 0
    if (.not. next_data_line(file, what, diagnostics)) then
      ok = .false.
      return
    end if
    do i = 1, 2
      call real_field(file, triple(i), point(i), ok, diagnostics)
    end do
  end subroutine read_point

  !> Read the vertices of a polygon and check that they go counter-clockwise around a convex one.
  subroutine read_polygon(file, scene, body, colour, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body, colour
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp), allocatable :: vertices(:, :)
    real(wp) :: area, centre(2), moment
    integer :: n, v, line

    call integer_field(file, 40, 46, n, ok, diagnostics)
    if (.not. ok) return
    line = file%at
    if (n < 3 .or. n > size(file%lines) - line) then
      call complain(file, 'a polygon of '//to_text(n)//' vertices cannot be: it needs three, and a line for each', 40, diagnostics)
      ok = .false.
      return
    end if
    allocate (vertices(2, n))
    do v = 1, n
      call read_point(file, 'a vertex', vertices(:, v), ok, diagnostics)
      if (.not. ok) return
    end do
    call polygon_moments(vertices, area, centre, moment)
    call check_polygon(file, vertices, area, line, ok, diagnostics)
    if (.not. ok) return
    do v = 1, n
      vertices(:, v) = vertices(:, v) - centre
    end do
    call add_polygon(scene%contactors, body, colour, vertices, centre)
  end subroutine read_polygon

  !> Refuse polygons that are clockwise, flat or not convex, at the line at fault.
  subroutine check_polygon(file, vertices, area, line, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    real(wp), intent(in) :: vertices(:, :), area
    integer, intent(in) :: line
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: fault, last
    character(len=:), allocatable :: message

    fault = 0
    if (area < 0) then
      message = 'the vertices of the polygon go clockwise; they must go counter-clockwise'
    else
      fault = reentrant_vertex(vertices)
      if (fault == 0) return
      message = 'the polygon is not convex at this vertex, or has no area there'
    end if
    ok = .false.
    last = file%at
    file%at = line + fault
    call complain(file, message, merge(triple(1), 2, fault > 0), diagnostics)
    file%at = max(file%at, last)
  end subroutine check_polygon

  !> First vertex at which a polygon turns right, or that lies on top of its neighbour; 0 when there is none.
  pure integer function reentrant_vertex(vertices) result(fault)
    real(wp), intent(in) :: vertices(:, :)
    ! Decks have seven digits: vertices in line may stand out by as much.
    real(wp), parameter :: slack = 1e-6_wp
    real(wp) :: edge(2), next(2), arm(2), scale
    integer :: i, j, n

    n = size(vertices, 2)
    scale = maxval(abs(maxval(vertices, 2) - minval(vertices, 2)))
    do i = 1, n
      fault = modulo(i, n) + 1
      edge = vertices(:, fault) - vertices(:, i)
      next = vertices(:, modulo(i + 1, n) + 1) - vertices(:, fault)
      if (norm2(edge) <= slack*scale .or. cross(edge, next) < -slack*scale*norm2(edge)) return
    end do
    ! Left turns alone may still go around twice, as a five-pointed star does.
    do i = 1, n
      edge = vertices(:, modulo(i, n) + 1) - vertices(:, i)
      do j = 1, n
        arm = vertices(:, j) - vertices(:, i)
        fault = j
        if (cross(edge, arm) < -slack*scale*norm2(edge)) return
      end do
    end do
    fault = 0
  end function reentrant_vertex

  !> Cross product of two vectors of the plane.
  pure real(wp) function cross(a, b)
    real(wp), intent(in) :: a(2), b(2)

    cross = a(1)*b(2) - a(2)*b(1)
  end function cross

  !> Turn a block into a body of the scene.
  subroutine complete_body(file, scene, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(block_t), intent(in) :: block
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: area, centre(2), moment, place(2)
    integer :: b, c

    b = block%body
    if (.not. block%has_bulk) call complain_body('has no bulk element ($blmty)')
    if (.not. block%has_node) call complain_body('has no node ($nodty)')
    if (scene%contactors%n == block%before) call complain_body('has no contactor ($tacty)')
    if (.not. block%has_bulk .or. .not. block%has_node .or. scene%contactors%n == block%before) return
    call body_moments(scene%contactors, block%before + 1, scene%contactors%n, area, centre, moment)
    place = block%node(1:2)
    if (.not. any(abs(place) > 0)) then
      ! A node at the very origin means shapes in global coordinates: the centre is that of their area.
      place = turned(centre, block%node(3))
      do c = block%before + 1, scene%contactors%n
        scene%contactors%shift(:, c) = scene%contactors%shift(:, c) - centre
      end do
    else
      moment = moment + area*sum(centre**2)
    end if
    scene%bodies%position(:, b) = place
    scene%bodies%angle(b) = block%node(3)
    scene%bodies%area(b) = area
    scene%bodies%material(b) = block%material
    if (block%mass_radius > 0 .and. block%gyration_radius > 0) then
      scene%bodies%mass(b) = scene%materials(block%material)%density*pi*block%mass_radius**2
      scene%bodies%inertia(b) = scene%bodies%mass(b)*block%gyration_radius**2
    else if (area > 0) then
      scene%bodies%mass(b) = scene%materials(block%material)%density*area
      scene%bodies%inertia(b) = scene%materials(block%material)%density*moment
    else
      call complain_body('has neither avrd and gyrd nor an area: its mass is unknown')
      return
    end if
    if (.not. min(scene%bodies%mass(b), scene%bodies%inertia(b)) > tiny(1.0_wp)) then
      call complain_body('has no mass')
      return
    end if
    scene%bodies%inverse_mass(:, b) = 1/[scene%bodies%mass(b), scene%bodies%mass(b), scene%bodies%inertia(b)]
  contains
    !> Tell a mistake about the body as a whole, at its first line.
    subroutine complain_body(message)
      character(len=*), intent(in) :: message
      integer :: at

      at = file%at
      file%at = block%line
      call complain(file, 'body '//to_text(b)//' '//message, 0, diagnostics)
      file%at = max(file%at, at)
    end subroutine complain_body
  end subroutine complete_body

  !> A vector turned by an angle.
  pure function turned(vector, angle)
    real(wp), intent(in) :: vector(2), angle
    real(wp) :: turned(2)

    turned = [cos(angle)*vector(1) - sin(angle)*vector(2), sin(angle)*vector(1) + cos(angle)*vector(2)]
  end function turned
end module sg_datbox_bodies
