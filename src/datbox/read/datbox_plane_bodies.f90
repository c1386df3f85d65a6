!> Bodies of the plane (RBDY2) in a DATBOX: contactors, mass.
!!
!! LMGC90 takes mass and inertia from the radii of the bulk line, mass = density pi avrd^2 and inertia = mass gyrd^2,
!! not from the shapes; they come from the shapes only where one of the radii is zero.
module sg_datbox_plane_bodies
  use sg_contactors, only: add_disk, add_hollow, add_point, add_polygon, add_segment, contactors_t, kind_polygon
  use sg_datbox_blocks, only: block_t, complain_block, read_point, read_size, read_triple, triple
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, go_to, name_field, remark
  use sg_datbox_numbers, only: integer_field
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_moments, only: body_moments, polygon_moments
  use sg_scene, only: colour_index, scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: read_planar_contactor, complete_planar_body

contains

  !> Read one contactor with its further lines.
  subroutine read_planar_contactor(file, scene, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file at the contactor's line
    type(scene_t), intent(inout) :: scene !! gets the contactor and its colour
    type(block_t), intent(inout) :: block !! the body's block
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
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
      if (ok) call add_segment(scene%contactors, block%body, colour, size_of(1), size_of(2), shift, 0.0_wp)
    case ('POLYG')
      call read_polygon(file, scene, block%body, colour, ok, diagnostics)
    case ('PT2Dx')
      call read_triple(file, shift, ok, diagnostics)
      if (ok) call add_point(scene%contactors, block%body, colour, shift)
    case default
      call complain_once(file, name_field(file, 2), 'contactors of type '''//name_field(file, 2) &
                         //''' are not done: only DISKx, DISKb, xKSID, JONCx, POLYG and PT2Dx', 2, diagnostics)
      ok = .false.
    end select
    block%ok = block%ok .and. ok
  end subroutine read_planar_contactor

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
    if (n < 3 .or. n > file%n - line) then
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
    call go_to(file, line + fault)
    call complain(file, message, merge(triple(1), 2, fault > 0), diagnostics)
    call go_to(file, max(file%at, last))
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
  subroutine complete_planar_body(file, scene, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT
    type(scene_t), intent(inout) :: scene !! gets the body
    type(block_t), intent(in) :: block !! the body's block
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: area, centre(2), moment, place(2)
    integer :: b, c

    b = block%body
    call body_moments(scene%contactors, block%before + 1, scene%contactors%n, area, centre, moment)
    place = block%node(1:2)
    if (.not. any(abs(place) > 0)) then
      ! A node at the very origin means shapes in global coordinates: the centre is that of their area.
      place = turned(centre, block%node(3))
      do c = block%before + 1, scene%contactors%n
        scene%contactors%shift(:, c) = scene%contactors%shift(:, c) - centre
      end do
    else if (is_polygon(scene%contactors, block%before)) then
      call centre_polygon(file, block, centre, place, diagnostics)
      scene%contactors%shift(:, scene%contactors%n) = 0
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
    else if (block%is_held) then
      return
    else
      call complain_block(file, block, 'has neither avrd and gyrd nor an area: its mass is unknown, and only a body whose ' &
                          //'velocity is imposed in all components needs none', diagnostics)
      return
    end if
    if (.not. min(scene%bodies%mass(b), scene%bodies%inertia(b)) > tiny(1.0_wp)) then
      call complain_block(file, block, 'has no mass', diagnostics)
      return
    end if
    scene%bodies%inverse_mass(:, b) = 1/[scene%bodies%mass(b), scene%bodies%mass(b), scene%bodies%inertia(b)]
  end subroutine complete_planar_body

  !> Is the only contactor of the body being read a polygon?
  pure logical function is_polygon(contactors, before)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: before

    is_polygon = contactors%n == before + 1
    if (is_polygon) is_polygon = contactors%kind(contactors%n) == kind_polygon
  end function is_polygon

  !> A polygon alone lies with its centroid at the centre of its body. Where the node is elsewhere, LMGC90 moves the centre to
  !! the centroid, or the polygon by less than a millimetre to the node.
  subroutine centre_polygon(file, block, centroid, place, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(block_t), intent(in) :: block
    real(wp), intent(in) :: centroid(2)
    real(wp), intent(inout) :: place(2)
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp), parameter :: least_move = 1e-3_wp, digits = 1e-6_wp
    character(len=:), allocatable :: what
    integer :: at

    what = ' is moved to its node by '
    if (norm2(centroid) >= least_move) then
      place = place + turned(centroid, block%node(3))
      what = ' stays: the centre of its body is moved to its centroid by '
    else if (norm2(centroid) <= digits*norm2(place)) then
      return
    end if
    at = file%at
    call go_to(file, block%line)
    call remark(file, 'centroid'//what, 'the polygon of body '//to_text(block%number)//what//to_text(norm2(centroid), 3) &
                //' m, as in LMGC90', 0, diagnostics)
    call go_to(file, at)
  end subroutine centre_polygon

  !> A vector turned by an angle.
  pure function turned(vector, angle)
    real(wp), intent(in) :: vector(2), angle
    real(wp) :: turned(2)

    turned = [cos(angle)*vector(1) - sin(angle)*vector(2), sin(angle)*vector(1) + cos(angle)*vector(2)]
  end function turned
end module sg_datbox_plane_bodies
