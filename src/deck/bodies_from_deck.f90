!> Bodies and their contactors from the blocks body, wall, container, brick_wall, arch and sample, numbered in this order.
module sg_bodies_from_deck
  use sg_blocks, only: deck_t
  use sg_contactors, only: add_disk, add_polygon
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, i4
  use sg_laws_from_deck, only: material_of
  use sg_masonry, only: add_arch, add_brick_wall, bricks_of_wall
  use sg_named_bodies, only: check_names, name_body
  use sg_polyhedra_from_deck, only: place_polyhedral_shape
  use sg_polyhedron, only: polyhedron_t
  use sg_rotations, only: frame_of, rotation_by, turned_back
  use sg_samples_from_deck, only: generate_sample, grain_polygon, grain_polyhedron, sample_t
  use sg_scene, only: colour_index, scene_t
  use sg_shapes_from_deck, only: add_shape
  use sg_space_contactors, only: add_sphere
  use sg_space_generators, only: random_rotation
  use sg_walls_from_deck, only: add_container, add_wall_body, planes_of_container
  use sg_weights_from_deck, only: override_mass, weigh_body
  implicit none
  private
  public :: bodies_from_deck

contains

  !> Fill the scene's bodies and contactors.
  subroutine bodies_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck; its blocks learn which bodies are theirs
    type(scene_t), intent(inout) :: scene !! scene with its dimension, periods and materials
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(sample_t), allocatable :: samples(:)
    character(len=10), parameter :: sections(5) = [character(len=10) :: 'body', 'wall', 'container', 'brick_wall', 'arch']
    integer :: b, i, n

    allocate (samples(deck%count_of('sample')))
    i = 0
    n = 0
    do b = 1, deck%n
      n = n + fixed_count(deck, b, scene)
      if (.not. deck%is_in(b, 'sample')) cycle
      i = i + 1
      call generate_sample(deck, b, [scene%period, scene%period_y], samples(i), diagnostics)
    end do
    n = n + sum(samples%n)
    if (n == 0 .and. diagnostics%count() == 0) call deck%complain(diagnostics, 'there is no body: a deck needs [[body]], '// &
                                                   '[[wall]], [[sample]] or scene.datbox', deck%block_of('scene'))
    scene%contactors%dimension = scene%dimension
    call scene%bodies%allocate(n, scene%dimension)
    n = 0
    do i = 1, size(sections)
      do b = 1, deck%n
        if (deck%is_in(b, trim(sections(i)))) call add_block(deck, b, scene, n, diagnostics)
      end do
    end do
    call check_names(deck, scene, diagnostics)
    do i = 1, size(samples)
      deck%blocks(samples(i)%block)%first_body = n + 1
      call add_sample(deck, samples(i), scene, n, diagnostics)
      deck%blocks(samples(i)%block)%last_body = n
    end do
  end subroutine bodies_from_deck

  !> Number of bodies that a block makes, but for samples.
  integer function fixed_count(deck, b, scene) result(n)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene

    n = 0
    if (deck%is_in(b, 'body') .or. deck%is_in(b, 'wall')) n = 1
    if (deck%is_in(b, 'container')) n = planes_of_container(deck, b, [scene%period, scene%period_y])
    if (deck%is_in(b, 'brick_wall')) n = bricks_of_wall(deck, b)
    if (deck%is_in(b, 'arch')) n = deck%integer(b, 'voussoirs')
  end function fixed_count

  !> Add the bodies of one block.
  subroutine add_block(deck, b, scene, n, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: first, last

    first = n + 1
    last = n + fixed_count(deck, b, scene)
    deck%blocks(b)%first_body = first
    deck%blocks(b)%last_body = last
    if (deck%is_in(b, 'body') .or. deck%is_in(b, 'wall')) call name_body(deck, b, scene, first, diagnostics)
    scene%bodies%material(first:last) = int(material_of(deck, b, scene, diagnostics), i4)
    if (deck%is_in(b, 'container')) then
      call add_container(deck, b, scene, n, diagnostics)
    else if (deck%is_in(b, 'brick_wall')) then
      call add_brick_wall(deck, b, scene, n, diagnostics)
    else if (deck%is_in(b, 'arch')) then
      call add_arch(deck, b, scene, n, diagnostics)
    else if (deck%is_in(b, 'wall')) then
      call add_wall_body(deck, b, scene, first, diagnostics)
    else
      call add_body(deck, b, scene, first, diagnostics)
    end if
    n = last
  end subroutine add_block

  !> The body of a [[body]] block.
  subroutine add_body(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: position(3), velocity(3)
    integer :: first, inner, errors

    errors = diagnostics%count()
    first = scene%contactors%n + 1
    position = deck%vector(b, 'position')
    velocity = deck%vector(b, 'velocity')
    scene%bodies%position(:, n) = position(:scene%dimension)
    scene%bodies%velocity(:scene%dimension, n) = velocity(:scene%dimension)
    if (scene%dimension == 2) then
      scene%bodies%angle(n) = deck%number(b, 'angle')
    else
      scene%bodies%orientation(:, n) = rotation_by(deck%vector(b, 'rotation'))
    end if
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
    call weigh_body(scene, n, first)
    call override_mass(deck, b, scene, n, diagnostics)
    if (scene%dimension == 2) then
      scene%bodies%velocity(3, n) = deck%number(b, 'spin')
    else
      scene%bodies%velocity(4:, n) = turned_back(scene%bodies%orientation(:, n), deck%vector(b, 'spin'))
    end if
  end subroutine add_body

  !> All grains of a sample.
  subroutine add_sample(deck, sample, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    type(diagnostics_t), intent(inout) :: diagnostics
    type(error_t), allocatable :: error
    character(len=:), allocatable :: shape
    real(wp) :: velocity(3)
    integer :: i, colour, material

    material = material_of(deck, sample%block, scene, diagnostics)
    call colour_index(scene, deck%word(sample%block, 'colour'), colour)
    shape = deck%word(sample%block, 'shape')
    velocity = deck%vector(sample%block, 'velocity')
    do i = 1, sample%n
      n = n + 1
      associate (bodies => scene%bodies)
        bodies%material(n) = int(material, i4)
        bodies%velocity(:scene%dimension, n) = velocity(:scene%dimension)
        bodies%position(:, n) = sample%centre(:, i)
        call add_grain(deck, sample, i, shape, scene, n, colour, error)
        if (allocated(error)) then
          call deck%complain(diagnostics, error%message, sample%block, 'shape')
          return
        end if
        call weigh_body(scene, n, scene%contactors%n)
        if (scene%period > 0) bodies%position(1, n) = modulo(bodies%position(1, n), scene%period)
        if (scene%period_y > 0) bodies%position(2, n) = modulo(bodies%position(2, n), scene%period_y)
      end associate
    end do
  end subroutine add_sample

  !> Shape of a grain of a sample.
  subroutine add_grain(deck, sample, i, shape, scene, n, colour, error)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    integer, intent(in) :: i, n, colour
    character(len=*), intent(in) :: shape
    type(scene_t), intent(inout) :: scene
    type(error_t), allocatable, intent(out) :: error
    type(polyhedron_t) :: polyhedron
    real(wp), allocatable :: vertices(:, :)
    real(wp), parameter :: none(3) = 0

    select case (shape)
    case ('disk')
      call add_disk(scene%contactors, n, colour, sample%radius(i), none(:2))
    case ('polygon')
      call grain_polygon(deck, sample, i, vertices, scene%bodies%position(:, n))
      call add_polygon(scene%contactors, n, colour, vertices, none(:2))
    case ('sphere')
      call add_sphere(scene%contactors, n, colour, sample%radius(i), none)
    case ('polyhedron')
      call grain_polyhedron(deck, sample, i, polyhedron, error)
      if (.not. allocated(error)) &
        call place_polyhedral_shape(scene, n, colour, polyhedron, none, frame_of(random_rotation(sample%random)))
    end select
  end subroutine add_grain
end module sg_bodies_from_deck
