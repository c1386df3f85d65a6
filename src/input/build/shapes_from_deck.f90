!> One shape of a body, of the plane or of space, from the keys of [[body]] or [[body.shape]].
module sg_shapes_from_deck
  use sg_blocks, only: deck_t
  use sg_contactors, only: add_disk, add_hollow, add_point, add_polygon, add_segment
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_moments, only: polygon_moments
  use sg_polyhedra_from_deck, only: add_polyhedral_shape
  use sg_rotations, only: frame_of, no_rotation, rotation_by
  use sg_scene, only: colour_index, scene_t
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_sphere
  use sg_text, only: to_text
  use sg_values, only: value_t
  implicit none
  private
  public :: add_shape

  !> Turn of a polygon at a vertex below which it is straight there up to rounding [rad]
  real(wp), parameter :: straight = 1e-9_wp

contains

  !> Add the shape of a block to the scene's contactors, in the frame of the body as the deck gives it.
  subroutine add_shape(deck, b, body_block, scene, body, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the sizes, that of the body or one within
    integer, intent(in) :: body_block !! block of the body
    type(scene_t), intent(inout) :: scene !! scene with the contactors
    integer, intent(in) :: body !! body that carries the shape
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=:), allocatable :: kind, colour_name
    real(wp) :: centre(3), angle, frame(3, 3)
    integer :: colour

    centre = 0
    angle = 0
    frame = frame_of(no_rotation)
    colour_name = deck%word(body_block, 'colour')
    if (b == body_block) then
      kind = deck%word(b, 'shape')
    else
      kind = deck%word(b, 'kind')
      centre = deck%vector(b, 'centre')
      if (scene%dimension == 2) then
        angle = deck%number(b, 'angle')
      else
        frame = frame_of(rotation_by(deck%vector(b, 'rotation')))
      end if
      if (deck%is_given(b, 'colour')) colour_name = deck%word(b, 'colour')
    end if
    call colour_index(scene, colour_name, colour)
    associate (contactors => scene%contactors)
      select case (kind)
      case ('point')
        call add_point(contactors, body, colour, centre(:scene%dimension))
      case ('disk')
        call add_disk(contactors, body, colour, deck%number(b, 'radius'), centre(:2))
      case ('hollow disk')
        call add_hollow(contactors, body, colour, deck%number(b, 'radius'), centre(:2))
      case ('segment')
        call add_segment(contactors, body, colour, deck%number(b, 'half_length'), deck%number(b, 'half_thickness'), &
                         centre(:2), angle)
      case ('polygon')
        call add_vertices(deck, b, scene, body, colour, centre(:2), angle, diagnostics)
      case ('sphere')
        call add_sphere(contactors, body, colour, deck%number(b, 'radius'), centre)
      case ('plane')
        call add_plane(contactors, body, colour, deck%vector(b, 'half_axes'), centre, frame)
      case ('cylinder')
        call add_cylinder(contactors, body, colour, deck%number(b, 'half_height'), deck%number(b, 'radius'), centre, frame(:, 3))
      case ('hollow cylinder')
        call add_hollow_cylinder(contactors, body, colour, deck%number(b, 'half_height'), deck%number(b, 'radius'), centre, &
                                 frame(:, 3))
      case ('box', 'polyhedron')
        call add_polyhedral_shape(deck, b, kind, scene, body, colour, centre, frame, diagnostics)
      end select
    end associate
  end subroutine add_shape

  !> Add a polygon, its vertices about its own centre of area.
  subroutine add_vertices(deck, b, scene, body, colour, centre, angle, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, body, colour
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: centre(2), angle
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp), allocatable :: vertices(:, :)
    character(len=:), allocatable :: message
    type(value_t) :: value
    real(wp) :: area, offset(2), moment
    integer :: i

    if (.not. deck%is_given(b, 'vertices')) then
      call deck%complain(diagnostics, deck%heading(deck%blocks(b)%section)//' lacks the key "vertices": vertices of a convex '// &
                         'polygon, counter-clockwise', b)
      return
    end if
    value = deck%value(b, 'vertices')
    vertices = reshape(value%numbers(:value%n), [2, value%n/2])
    call check_polygon(vertices, message)
    if (allocated(message)) then
      call deck%complain(diagnostics, message, b, 'vertices')
      return
    end if
    do i = 1, size(vertices, 2)
      vertices(:, i) = [cos(angle)*vertices(1, i) - sin(angle)*vertices(2, i), &
                        sin(angle)*vertices(1, i) + cos(angle)*vertices(2, i)]
    end do
    call polygon_moments(vertices, area, offset, moment)
    call add_polygon(scene%contactors, body, colour, vertices - spread(offset, 2, size(vertices, 2)), centre + offset)
  end subroutine add_vertices

  !> Is a polygon convex and counter-clockwise, without double vertices?
  subroutine check_polygon(vertices, message)
    real(wp), intent(in) :: vertices(:, :)
    character(len=:), allocatable, intent(out) :: message
    real(wp), allocatable :: turn(:)
    real(wp) :: before(2), after(2)
    integer :: i, n

    n = size(vertices, 2)
    if (n < 3) then
      message = 'a polygon has three vertices or more, not '//to_text(n)
      return
    end if
    allocate (turn(n))
    do i = 1, n
      before = vertices(:, i) - vertices(:, modulo(i - 2, n) + 1)
      after = vertices(:, modulo(i, n) + 1) - vertices(:, i)
      if (.not. norm2(after) > 0) then
        message = 'vertices '//to_text(i)//' and '//to_text(modulo(i, n) + 1)//' are the same point'
        return
      end if
      turn(i) = atan2(before(1)*after(2) - before(2)*after(1), dot_product(before, after))
    end do
    if (all(turn <= straight)) then
      message = 'the vertices run clockwise: list them counter-clockwise'
    else if (any(turn < -straight) .or. abs(sum(turn) - 2*pi) > 1e-3_wp) then
      message = 'the polygon is not convex at vertex '//to_text(minloc(turn, 1))
    else if (any(turn > pi - straight)) then
      message = 'the polygon has no area: it folds back at vertex '//to_text(maxloc(turn, 1))
    end if
  end subroutine check_polygon
end module sg_shapes_from_deck
