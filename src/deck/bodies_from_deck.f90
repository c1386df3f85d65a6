!> Bodies and their contactors from the blocks body, wall, container, brick_wall, arch and sample, numbered in this order.
!!
!! Where several ranks read, each goes through all grains of all samples and keeps those of its share and those that the deck
!! calls by number; these and all other bodies every rank holds, as if they were wide (doc/theory/decomposition.md).
module sg_bodies_from_deck
  use sg_blocks, only: deck_t
  use sg_census, only: census_t
  use sg_contactors, only: add_disk, add_polygon, kind_names, n_kinds
  use sg_error, only: diagnostics_t, error_t
  use sg_drives_from_deck, only: numbers_called
  use sg_kinds, only: wp, i4
  use sg_laws_from_deck, only: material_of
  use sg_local_numbers, only: place_of
  use sg_masonry, only: add_arch, add_brick_wall, bricks_of_wall
  use sg_named_bodies, only: check_names, name_body
  use sg_pack_shapes, only: make_room_for_shapes
  use sg_polyhedra_from_deck, only: place_polyhedral_shape
  use sg_polyhedron, only: polyhedron_t
  use sg_rotations, only: frame_of, no_rotation, rotation_by, turned_back
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
    type(census_t) :: census
    integer(i4), allocatable :: called(:)
    character(len=10), parameter :: sections(5) = [character(len=10) :: 'body', 'wall', 'container', 'brick_wall', 'arch']
    integer :: b, i, n, n_fixed, before

    n_fixed = 0
    do b = 1, deck%n
      n_fixed = n_fixed + fixed_count(deck, b, scene)
    end do
    call numbers_called(deck, called)
    called = pack(called, called > n_fixed .and. deck%ranks > 1)
    allocate (samples(deck%count_of('sample')))
    i = 0
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'sample')) cycle
      i = i + 1
      call generate_sample(deck, b, [scene%period, scene%period_y], deck%ranks > 1 .and. size(called) == 0, samples(i), census, &
                           diagnostics)
    end do
    n = n_fixed + kept_grains(samples, n_fixed, called)
    if (n_fixed + sum(samples%n) == 0 .and. diagnostics%count() == 0) &
      call deck%complain(diagnostics, 'there is no body: a deck needs [[body]], [[wall]], [[sample]] or scene.datbox', &
                         deck%block_of('scene'))
    scene%contactors%dimension = scene%dimension
    call scene%bodies%allocate(n, scene%dimension)
    n = 0
    do i = 1, size(sections)
      do b = 1, deck%n
        if (deck%is_in(b, trim(sections(i)))) call add_block(deck, b, scene, n, diagnostics)
      end do
    end do
    call check_names(deck, scene, diagnostics)
    if (deck%ranks > 1) call number_fixed(scene, n_fixed)
    before = n_fixed
    do i = 1, size(samples)
      deck%blocks(samples(i)%block)%first_body = before + 1
      call add_sample(deck, samples(i), before, called, scene, n, census, diagnostics)
      deallocate (samples(i)%centre, samples(i)%radius)
      before = before + samples(i)%n
      deck%blocks(samples(i)%block)%last_body = before
    end do
    if (deck%ranks > 1) call number_contactors(scene, n_fixed)
    deck%absent = census
  end subroutine bodies_from_deck

  !> Grains of samples that this rank keeps: its shares, and those called by number.
  pure integer function kept_grains(samples, n_fixed, called) result(n)
    type(sample_t), intent(in) :: samples(:)
    integer, intent(in) :: n_fixed
    integer(i4), intent(in) :: called(:)
    integer :: i, before

    n = 0
    before = n_fixed
    do i = 1, size(samples)
      n = n + samples(i)%last - samples(i)%first + 1 + count(called > before .and. called <= before + samples(i)%n .and. &
                                     .not. (called >= before + samples(i)%first .and. called <= before + samples(i)%last))
      before = before + samples(i)%n
    end do
  end function kept_grains

  !> Number the bodies that are no grains of samples: all ranks hold them.
  subroutine number_fixed(scene, n_fixed)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n_fixed
    integer :: i

    allocate (scene%bodies%id(scene%bodies%n), scene%bodies%home(scene%bodies%n), source=-1_i4)
    scene%bodies%id(:n_fixed) = [(int(i, i4), i=1, n_fixed)]
  end subroutine number_fixed

  !> Number the contactors: grains of samples have one each, behind those of all other bodies.
  subroutine number_contactors(scene, n_fixed)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n_fixed
    integer, parameter :: none(n_kinds) = 0
    integer :: c, before

    before = 0
    if (scene%contactors%n == 0) then
      call make_room_for_shapes(scene%contactors, scene%dimension, none, 0)
      return
    end if
    allocate (scene%contactors%id(scene%contactors%n))
    do c = 1, scene%contactors%n
      associate (number => scene%bodies%id(scene%contactors%body(c)))
        if (number <= n_fixed) before = c
        scene%contactors%id(c) = int(merge(c, before + number - n_fixed, number <= n_fixed), i4)
      end associate
    end do
  end subroutine number_contactors

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

  !> The grains of a sample: those that are kept go to the scene, the others are made and noted alone.
  subroutine add_sample(deck, sample, before, called, scene, n, census, diagnostics)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    integer, intent(in) :: before
    integer(i4), intent(in) :: called(:)
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    type(census_t), intent(inout) :: census
    type(diagnostics_t), intent(inout) :: diagnostics
    type(scene_t) :: other
    type(error_t), allocatable :: error
    integer :: i, colour, material
    logical :: is_own, is_called

    material = material_of(deck, sample%block, scene, diagnostics)
    call colour_index(scene, deck%word(sample%block, 'colour'), colour)
    if (deck%ranks > 1 .and. sample%n > count(called > before .and. called <= before + sample%n)) &
      call note_look(deck, sample, colour, census)
    do i = sample%before + 1, sample%before + size(sample%radius)
      is_own = i >= sample%first .and. i <= sample%last
      is_called = place_of(called, int(before + i, i4)) > 0
      if (is_own .or. is_called) then
        n = n + 1
        call add_grain(deck, sample, i, scene, n, material, colour, error)
        if (deck%ranks > 1) then
          scene%bodies%id(n) = int(before + i, i4)
          scene%bodies%home(n) = int(merge(-1, deck%rank, is_called), i4)
        end if
      else
        call clear(scene, other)
        call add_grain(deck, sample, i, other, 1, material, colour, error)
        if (other%contactors%n > 0) call census%note(other%bodies%position(:, 1), other%contactors%reach(1))
      end if
      if (allocated(error)) then
        call deck%complain(diagnostics, error%message, sample%block, 'shape')
        return
      end if
    end do
  end subroutine add_sample

  !> Note what all grains of a sample have in common.
  subroutine note_look(deck, sample, colour, census)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(in) :: sample
    integer, intent(in) :: colour
    type(census_t), intent(inout) :: census
    real(wp) :: velocity(3)

    velocity = deck%vector(sample%block, 'velocity')
    call census%note_look(findloc(kind_names, deck%word(sample%block, 'shape'), 1), colour, &
                          sqrt(sum(velocity(:deck%dimension)**2)))
  end subroutine note_look

  !> Make room for one grain in a scene of its own.
  subroutine clear(scene, other)
    type(scene_t), intent(in) :: scene
    type(scene_t), intent(inout) :: other
    integer :: i

    if (other%bodies%n == 0) then
      other%dimension = scene%dimension
      other%contactors%dimension = scene%dimension
      other%period = scene%period
      other%period_y = scene%period_y
      allocate (other%materials(size(scene%materials)))
      do i = 1, size(scene%materials)
        other%materials(i) = scene%materials(i)
      end do
      call other%bodies%allocate(1, scene%dimension)
    end if
    other%contactors%n = 0
    other%contactors%n_rows = 0
    if (allocated(other%bodies%orientation)) other%bodies%orientation(:, 1) = no_rotation
  end subroutine clear

  !> A grain of a sample.
  subroutine add_grain(deck, sample, i, scene, n, material, colour, error)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    integer, intent(in) :: i, n, material, colour
    type(scene_t), intent(inout) :: scene
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: velocity(3)

    velocity = deck%vector(sample%block, 'velocity')
    associate (bodies => scene%bodies)
      bodies%material(n) = int(material, i4)
      bodies%velocity(:scene%dimension, n) = velocity(:scene%dimension)
      bodies%position(:, n) = sample%centre(:, i - sample%before)
      call add_grain_shape(deck, sample, i, deck%word(sample%block, 'shape'), scene, n, colour, error)
      if (allocated(error)) return
      call weigh_body(scene, n, scene%contactors%n)
      if (scene%period > 0) bodies%position(1, n) = modulo(bodies%position(1, n), scene%period)
      if (scene%period_y > 0) bodies%position(2, n) = modulo(bodies%position(2, n), scene%period_y)
    end associate
  end subroutine add_grain

  !> Shape of a grain of a sample.
  subroutine add_grain_shape(deck, sample, i, shape, scene, n, colour, error)
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
      call add_disk(scene%contactors, n, colour, sample%radius(i - sample%before), none(:2))
    case ('polygon')
      call grain_polygon(deck, sample, i, vertices, scene%bodies%position(:, n))
      call add_polygon(scene%contactors, n, colour, vertices, none(:2))
    case ('sphere')
      call add_sphere(scene%contactors, n, colour, sample%radius(i - sample%before), none)
    case ('polyhedron')
      call grain_polyhedron(deck, sample, i, polyhedron, error)
      if (.not. allocated(error)) &
        call place_polyhedral_shape(scene, n, colour, polyhedron, none, frame_of(random_rotation(sample%random)))
    end select
  end subroutine add_grain_shape
end module sg_bodies_from_deck
