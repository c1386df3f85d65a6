!> Bodies in space and their contactors from the blocks body, wall, container, brick_wall, arch and sample, numbered in this
!! order.
module sg_solids_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, i4
  use sg_laws_from_deck, only: material_of
  use sg_masonry, only: add_arch, add_brick_wall, bricks_of_wall
  use sg_named_bodies, only: check_names, name_body
  use sg_planes_from_deck, only: add_container, add_wall_plane, planes_of_container
  use sg_polyhedron, only: polyhedron_t
  use sg_rotations, only: frame_of, rotation_by, turned_back
  use sg_scene, only: colour_index, scene_t
  use sg_solid_bodies, only: make_solid_body, set_inertia
  use sg_solid_samples_from_deck, only: generate_solid_sample, grain_polyhedron, solid_sample_t
  use sg_solid_shapes_from_deck, only: add_solid_shape, place_polyhedral_shape
  use sg_space_contactors, only: add_sphere
  use sg_space_generators, only: random_rotation
  implicit none
  private
  public :: solids_from_deck

contains

  !> Fill the scene's bodies and contactors.
  subroutine solids_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck; its blocks learn which bodies are theirs
    type(scene_t), intent(inout) :: scene !! scene with its materials
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(solid_sample_t), allocatable :: samples(:)
    character(len=10), parameter :: sections(5) = [character(len=10) :: 'body', 'wall', 'container', 'brick_wall', 'arch']
    integer :: b, i, n

    allocate (samples(deck%count_of('sample')))
    i = 0
    n = 0
    do b = 1, deck%n
      n = n + fixed_count(deck, b, [scene%period, scene%period_y])
      if (.not. deck%is_in(b, 'sample')) cycle
      i = i + 1
      call generate_solid_sample(deck, b, [scene%period, scene%period_y], samples(i), diagnostics)
    end do
    n = n + sum(samples%n)
    if (n == 0 .and. diagnostics%count() == 0) call deck%complain(diagnostics, 'there is no body: a deck needs [[body]], '// &
                                                   '[[wall]], [[sample]] or scene.datbox', deck%block_of('scene'))
    scene%contactors%dimension = 3
    call scene%bodies%allocate(n, 3)
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
  end subroutine solids_from_deck

  !> Number of bodies that a block makes, but for samples.
  integer function fixed_count(deck, b, period) result(n)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    real(wp), intent(in) :: period(2)

    n = 0
    if (deck%is_in(b, 'body') .or. deck%is_in(b, 'wall')) n = 1
    if (deck%is_in(b, 'container')) n = planes_of_container(deck, b, period)
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
    real(wp) :: density
    integer :: material, first

    first = n + 1
    deck%blocks(b)%first_body = first
    deck%blocks(b)%last_body = n + fixed_count(deck, b, [scene%period, scene%period_y])
    material = material_of(deck, b, scene, diagnostics)
    scene%bodies%material(first) = int(material, i4)
    density = 0
    if (material > 0) density = scene%materials(material)%density
    if (deck%is_in(b, 'container')) then
      call add_container(deck, b, scene, n, density, diagnostics)
    else if (deck%is_in(b, 'brick_wall')) then
      call add_brick_wall(deck, b, scene, n, density, diagnostics)
    else if (deck%is_in(b, 'arch')) then
      call add_arch(deck, b, scene, n, density, diagnostics)
    else
      call name_body(deck, b, scene, first, diagnostics)
      if (deck%is_in(b, 'wall')) then
        call add_wall_plane(deck, b, scene, first, density, diagnostics)
      else
        call add_body(deck, b, scene, first, density, diagnostics)
      end if
    end if
    n = deck%blocks(b)%last_body
  end subroutine add_block

  !> The body of a [[body]] block.
  subroutine add_body(deck, b, scene, n, density, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: density
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: first, inner, errors

    errors = diagnostics%count()
    first = scene%contactors%n + 1
    scene%bodies%position(:, n) = deck%vector(b, 'position')
    scene%bodies%orientation(:, n) = rotation_by(deck%vector(b, 'rotation'))
    if (deck%is_given(b, 'shape')) call add_solid_shape(deck, b, b, scene, n, diagnostics)
    do inner = b + 1, deck%n
      if (deck%blocks(inner)%parent /= b) exit
      call add_solid_shape(deck, inner, b, scene, n, diagnostics)
    end do
    if (diagnostics%count() > errors) return
    if (scene%contactors%n < first) then
      call deck%complain(diagnostics, 'this body has no shape: it needs the key "shape" or [[body.shape]]', b)
      return
    end if
    call make_solid_body(scene%bodies, scene%contactors, n, first, scene%contactors%n, density)
    call override_mass(deck, b, scene, n, diagnostics)
    scene%bodies%velocity(:3, n) = deck%vector(b, 'velocity')
    scene%bodies%velocity(4:, n) = turned_back(scene%bodies%orientation(:, n), deck%vector(b, 'spin'))
  end subroutine add_body

  !> Mass and moments that the deck gives; moments follow a mass that is given alone.
  subroutine override_mass(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: mass, principal(3)

    mass = scene%bodies%mass(n)
    principal = scene%bodies%principal(:, n)
    if (deck%is_given(b, 'mass')) then
      if (mass > 0) principal = principal*(deck%number(b, 'mass')/mass)
      mass = deck%number(b, 'mass')
    end if
    if (deck%is_given(b, 'inertia')) then
      principal = deck%vector(b, 'inertia')
      if (2*maxval(principal) > sum(principal)*(1 + 1e-9_wp)) &
        call deck%complain(diagnostics, 'no body has such moments: none is larger than the sum of the other two', b, 'inertia')
    end if
    if (.not. min(mass, minval(principal)) > 0 .and. .not. deck%flag(b, 'fixed') .and. scene%bodies%material(n) > 0) &
      call deck%complain(diagnostics, 'this body weighs nothing: it needs "mass" and "inertia", or fixed = true', b)
    call set_inertia(scene%bodies, n, mass, principal)
  end subroutine override_mass

  !> All grains of a sample.
  subroutine add_sample(deck, sample, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck
    type(solid_sample_t), intent(inout) :: sample
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    type(diagnostics_t), intent(inout) :: diagnostics
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: density, velocity(3)
    integer :: i, colour, material
    logical :: is_sphere

    material = material_of(deck, sample%block, scene, diagnostics)
    density = 0
    if (material > 0) density = scene%materials(material)%density
    call colour_index(scene, deck%word(sample%block, 'colour'), colour)
    is_sphere = deck%word(sample%block, 'shape') == 'sphere'
    velocity = deck%vector(sample%block, 'velocity')
    do i = 1, sample%n
      n = n + 1
      associate (bodies => scene%bodies)
        bodies%material(n) = int(material, i4)
        bodies%velocity(:3, n) = velocity
        bodies%position(:, n) = sample%centre(:, i)
        if (is_sphere) then
          call add_sphere(scene%contactors, n, colour, sample%radius(i), [0.0_wp, 0.0_wp, 0.0_wp])
        else
          call grain_polyhedron(deck, sample, i, shape, error)
          if (allocated(error)) then
            call deck%complain(diagnostics, error%message, sample%block, 'shape')
            return
          end if
          call place_polyhedral_shape(scene, n, colour, shape, [0.0_wp, 0.0_wp, 0.0_wp], &
                                      frame_of(random_rotation(sample%random)))
        end if
        call make_solid_body(bodies, scene%contactors, n, scene%contactors%n, scene%contactors%n, density)
        if (scene%period > 0) bodies%position(1, n) = modulo(bodies%position(1, n), scene%period)
        if (scene%period_y > 0) bodies%position(2, n) = modulo(bodies%position(2, n), scene%period_y)
      end associate
    end do
  end subroutine add_sample
end module sg_solids_from_deck
