!> Planar bodies and their contactors from the blocks body, wall and sample, numbered in this order.
module sg_bodies_from_deck
  use sg_blocks, only: deck_t
  use sg_bodies, only: bodies_t
  use sg_contactors, only: add_disk, add_polygon, add_wall
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_laws_from_deck, only: material_of
  use sg_moments, only: body_moments
  use sg_named_bodies, only: check_names, name_body
  use sg_samples_from_deck, only: generate_sample, grain_polygon, sample_t
  use sg_scene, only: colour_index, scene_t
  use sg_shapes_from_deck, only: add_shape
  implicit none
  private
  public :: bodies_from_deck

contains

  !> Fill the scene's bodies and contactors.
  subroutine bodies_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck; its blocks learn which bodies are theirs
    type(scene_t), intent(inout) :: scene !! scene with its materials
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(sample_t), allocatable :: samples(:)
    integer :: b, i, n

    allocate (samples(deck%count_of('sample')))
    n = 0
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'sample')) cycle
      n = n + 1
      call generate_sample(deck, b, scene%period, samples(n), diagnostics)
    end do
    n = deck%count_of('body') + deck%count_of('wall') + sum(samples%n)
    if (n == 0 .and. diagnostics%count() == 0) call deck%complain(diagnostics, 'there is no body: a deck needs [[body]], '// &
                                                   '[[wall]], [[sample]] or scene.datbox', deck%block_of('scene'))
    call scene%bodies%allocate(n)
    n = 0
    call add_bodies(deck, 'body', scene, n, diagnostics)
    call add_bodies(deck, 'wall', scene, n, diagnostics)
    call check_names(deck, scene, diagnostics)
    do i = 1, size(samples)
      deck%blocks(samples(i)%block)%first_body = n + 1
      call add_sample(deck, samples(i), scene, n, diagnostics)
      deck%blocks(samples(i)%block)%last_body = n
    end do
  end subroutine bodies_from_deck

  !> Add all bodies of the blocks of one section.
  subroutine add_bodies(deck, section, scene, n, diagnostics)
    type(deck_t), intent(inout) :: deck
    character(len=*), intent(in) :: section
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: b

    do b = 1, deck%n
      if (.not. deck%is_in(b, section)) cycle
      n = n + 1
      deck%blocks(b)%first_body = n
      deck%blocks(b)%last_body = n
      call name_body(deck, b, scene, n, diagnostics)
      scene%bodies%material(n) = int(material_of(deck, b, scene, diagnostics), i4)
      if (section == 'wall') then
        call add_wall_body(deck, b, scene, n, diagnostics)
      else
        call add_body(deck, b, scene, n, diagnostics)
      end if
    end do
  end subroutine add_bodies

  !> One body of a [[body]] block.
  subroutine add_body(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: first, inner, errors

    errors = diagnostics%count()
    first = scene%contactors%n + 1
    scene%bodies%position(:, n) = deck%pair(b, 'position')
    scene%bodies%angle(n) = deck%number(b, 'angle')
    scene%bodies%velocity(:, n) = [deck%pair(b, 'velocity'), deck%number(b, 'spin')]
    if (deck%is_given(b, 'shape')) call add_shape(deck, b, b, scene, n, diagnostics)
    do inner = b + 1, deck%n
      if (deck%blocks(inner)%parent /= b) exit
      call add_shape(deck, inner, b, scene, n, diagnostics)
    end do
    if (diagnostics%count() > errors) return
    if (scene%contactors%n < first) then
      call deck%complain(diagnostics, 'this body has no shape: it needs the key "shape" or [[body.shape]]', b)
      return
    end if
    call weigh(scene, n, first)
    call override_mass(deck, b, scene%bodies, n, diagnostics)
  end subroutine add_body

  !> Mass, inertia, area and centre of a body from its contactors `first` to the last; shifts become relative to the centre.
  subroutine weigh(scene, n, first)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n, first
    real(wp) :: area, centre(2), moment, density, cosine, sine
    integer :: c

    call body_moments(scene%contactors, first, scene%contactors%n, area, centre, moment)
    do c = first, scene%contactors%n
      scene%contactors%shift(:, c) = scene%contactors%shift(:, c) - centre
    end do
    associate (bodies => scene%bodies)
      cosine = cos(bodies%angle(n))
      sine = sin(bodies%angle(n))
      bodies%position(:, n) = bodies%position(:, n) + [cosine*centre(1) - sine*centre(2), sine*centre(1) + cosine*centre(2)]
      density = 0
      if (bodies%material(n) > 0) density = scene%materials(bodies%material(n))%density
      bodies%area(n) = area
      bodies%mass(n) = density*area
      bodies%inertia(n) = density*moment
    end associate
    call invert_mass(scene%bodies, n)
  end subroutine weigh

  !> Inverse inertia of a free body; zero where it weighs nothing.
  pure subroutine invert_mass(bodies, n)
    type(bodies_t), intent(inout) :: bodies
    integer, intent(in) :: n

    bodies%inverse_mass(:, n) = 0
    if (bodies%mass(n) > 0) bodies%inverse_mass(1:2, n) = 1/bodies%mass(n)
    if (bodies%inertia(n) > 0) bodies%inverse_mass(3, n) = 1/bodies%inertia(n)
  end subroutine invert_mass

  !> Mass and inertia that the deck gives; inertia follows a mass that is given alone.
  subroutine override_mass(deck, b, bodies, n, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(bodies_t), intent(inout) :: bodies
    type(diagnostics_t), intent(inout) :: diagnostics

    if (deck%is_given(b, 'mass')) then
      if (bodies%mass(n) > 0) bodies%inertia(n) = bodies%inertia(n)*deck%number(b, 'mass')/bodies%mass(n)
      bodies%mass(n) = deck%number(b, 'mass')
    end if
    if (deck%is_given(b, 'inertia')) bodies%inertia(n) = deck%number(b, 'inertia')
    if (.not. min(bodies%mass(n), bodies%inertia(n)) > 0 .and. .not. deck%flag(b, 'fixed') .and. bodies%material(n) > 0) &
      call deck%complain(diagnostics, 'this body weighs nothing: it needs "mass" and "inertia", or fixed = true', b)
    call invert_mass(bodies, n)
  end subroutine override_mass

  !> The body of a [[wall]] block.
  subroutine add_wall_body(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: from(2), to(2), length
    integer :: colour

    from = deck%pair(b, 'from')
    to = deck%pair(b, 'to')
    length = norm2(to - from)
    if (.not. length > 0) then
      call deck%complain(diagnostics, 'the wall has no length: "from" and "to" are the same point', b, 'to')
      return
    end if
    scene%bodies%position(:, n) = (from + to)/2
    scene%bodies%angle(n) = atan2(to(2) - from(2), to(1) - from(1))
    scene%bodies%velocity(1:2, n) = deck%pair(b, 'velocity')
    call colour_index(scene, deck%word(b, 'colour'), colour)
    call add_wall(scene%contactors, n, colour, length/2, deck%number(b, 'thickness')/2, [0.0_wp, 0.0_wp], 0.0_wp)
    call weigh(scene, n, scene%contactors%n)
  end subroutine add_wall_body

  !> All grains of a sample.
  subroutine add_sample(deck, sample, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp), allocatable :: vertices(:, :)
    integer :: i, colour, material
    logical :: is_disk

    material = material_of(deck, sample%block, scene, diagnostics)
    call colour_index(scene, deck%word(sample%block, 'colour'), colour)
    is_disk = deck%word(sample%block, 'shape') == 'disk'
    do i = 1, sample%n
      n = n + 1
      scene%bodies%material(n) = int(material, i4)
      scene%bodies%velocity(1:2, n) = deck%pair(sample%block, 'velocity')
      scene%bodies%position(:, n) = sample%centre(:, i)
      if (is_disk) then
        call add_disk(scene%contactors, n, colour, sample%radius(i), [0.0_wp, 0.0_wp])
      else
        call grain_polygon(deck, sample, i, vertices, scene%bodies%position(:, n))
        call add_polygon(scene%contactors, n, colour, vertices, [0.0_wp, 0.0_wp])
      end if
      call weigh(scene, n, scene%contactors%n)
      if (scene%period > 0) scene%bodies%position(1, n) = modulo(scene%bodies%position(1, n), scene%period)
    end do
  end subroutine add_sample
end module sg_bodies_from_deck
