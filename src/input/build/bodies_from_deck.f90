!> Bodies and their contactors from the blocks body, wall, container, brick_wall, arch, chain and sample, numbered in this order,
!! behind those of a DATBOX where there is one.
!!
!! Where several ranks read, each goes through all bodies and all grains of all samples, and keeps those of its share. Bodies that
!! the deck calls by number or by name, and those that it holds, every rank keeps (doc/theory/decomposition.md).
module sg_bodies_from_deck
  use sg_ascending, only: distinct, place_in
  use sg_blocks, only: deck_t
  use sg_called_bodies, only: numbers_called
  use sg_census, only: census_t
  use sg_contactors, only: add_disk, add_polygon, kind_names
  use sg_drives_from_deck, only: bodies_held
  use sg_error, only: diagnostics_t, error_t
  use sg_grain_shapes, only: grain_polygon, grain_polyhedron
  use sg_grain_templates, only: colour_template, grain_template_t, place_grain, read_templates
  use sg_kinds, only: wp, i4, i8
  use sg_laws_from_deck, only: material_of
  use sg_lists, only: reserve
  use sg_masonry, only: add_arch, add_brick_wall, bricks_of_wall
  use sg_named_bodies, only: check_names, give_names, list_names
  use sg_polyhedra_from_deck, only: place_polyhedral_shape
  use sg_polyhedron, only: polyhedron_t
  use sg_rotations, only: frame_of, no_rotation, rotation_by, turned_back
  use sg_samples_from_deck, only: generate_samples, sample_t
  use sg_scene, only: colour_index, periods_of, scene_t
  use sg_shapes_from_deck, only: add_shape
  use sg_share, only: share_t
  use sg_space_contactors, only: add_sphere
  use sg_space_generators, only: random_rotation
  use sg_walls_from_deck, only: add_container, add_wall_body, planes_of_container
  use sg_weights_from_deck, only: override_mass, weigh_body
  use sg_words, only: choice_index, choices_of
  implicit none
  private
  public :: bodies_from_deck

  !> Sections of bodies, in the order in which these are numbered; samples come last
  character(len=10), parameter :: sections(6) = [character(len=10) :: 'body', 'wall', 'container', 'brick_wall', 'arch', 'chain']

contains

  !> Add bodies and contactors to those that the scene has.
  subroutine bodies_from_deck(deck, scene, share, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck; its blocks learn which bodies are theirs
    type(scene_t), intent(inout) :: scene !! scene with its dimension, periods and materials, perhaps with the bodies of a DATBOX
    type(share_t), intent(inout) :: share !! the ranks, and what this one keeps of the bodies of a DATBOX
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(sample_t), allocatable :: samples(:)
    type(grain_template_t), allocatable :: templates(:)
    integer(i4), allocatable :: called(:), held(:)
    integer :: b, i, n, n_fixed, before, section, contactors

    deck%folder_bodies = share%made
    deck%absent = share%census
    deck%contactors = share%contactors
    if (share%made > 0 .and. .not. has_bodies(deck)) return
    n_fixed = share%made
    call number_blocks(deck, scene, n_fixed)
    call list_names(deck, [scene%period, scene%period_y], diagnostics)
    call check_names(deck, diagnostics)
    call numbers_called(deck, called)
    call bodies_held(deck, held)
    share%common = distinct([called, held])
    called = pack(called, called > n_fixed .and. deck%ranks > 1)
    call read_templates(deck, templates, diagnostics)
    if (diagnostics%count() > 0) return
    do i = 1, size(templates)
      call share%census%mix(transfer(templates(i)%volume, 1_i8))
    end do
    call generate_samples(deck, templates, periods_of(scene), deck%ranks > 1 .and. size(called) == 0, samples, &
                          share%census, diagnostics)
    if (n_fixed + sum(samples%n) == 0 .and. diagnostics%count() == 0) &
      call deck%complain(diagnostics, 'there is no body: a deck needs [[body]], [[wall]], [[sample]] or scene.datbox', &
                         deck%block_of('scene'))
    scene%contactors%dimension = scene%dimension
    n = scene%bodies%n
    call share%begin(scene, n_fixed - share%made, kept_grains(samples, n_fixed, called))
    do section = 1, size(sections)
      do b = 1, deck%n
        if (deck%is_in(b, trim(sections(section)))) call add_block(deck, b, scene, share, n, diagnostics)
      end do
    end do
    before = n_fixed
    contactors = share%contactors
    do i = 1, size(samples)
      deck%blocks(samples(i)%block)%first_body = before + 1
      call add_sample(deck, templates, samples(i), before, called, scene, share, n, contactors, diagnostics)
      deallocate (samples(i)%centre, samples(i)%radius)
      before = before + samples(i)%n
      deck%blocks(samples(i)%block)%last_body = before
    end do
    call share%finish(scene, n)
    call give_names(deck, scene)
    deck%absent = share%census
    deck%contactors = contactors
  end subroutine bodies_from_deck

  !> Has a deck blocks of bodies?
  pure logical function has_bodies(deck)
    type(deck_t), intent(in) :: deck
    integer :: i

    has_bodies = deck%count_of('sample') + deck%count_of('rain') > 0
    do i = 1, size(sections)
      has_bodies = has_bodies .or. deck%count_of(trim(sections(i))) > 0
    end do
  end function has_bodies

  !> Set the range of bodies of each block except samples.
  subroutine number_blocks(deck, scene, n)
    type(deck_t), intent(inout) :: deck
    type(scene_t), intent(in) :: scene
    integer, intent(inout) :: n !! bodies before; afterwards all but those of samples
    integer :: section, b

    do section = 1, size(sections)
      do b = 1, deck%n
        if (.not. deck%is_in(b, trim(sections(section)))) cycle
        deck%blocks(b)%first_body = n + 1
        n = n + fixed_count(deck, b, scene)
        deck%blocks(b)%last_body = n
      end do
    end do
  end subroutine number_blocks

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

  !> Number of bodies that a block makes; samples are not counted.
  integer function fixed_count(deck, b, scene) result(n)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene

    n = 0
    if (deck%is_in(b, 'body') .or. deck%is_in(b, 'wall')) n = 1
    if (deck%is_in(b, 'container')) n = planes_of_container(deck, b, [scene%period, scene%period_y])
    if (deck%is_in(b, 'brick_wall')) n = bricks_of_wall(deck, b)
    if (deck%is_in(b, 'arch')) n = deck%integer(b, 'voussoirs')
    if (deck%is_in(b, 'chain')) n = deck%integer(b, 'count')
  end function fixed_count

  !> Add the bodies of one block.
  subroutine add_block(deck, b, scene, share, n, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    type(share_t), intent(inout) :: share
    integer, intent(inout) :: n
    type(diagnostics_t), intent(inout) :: diagnostics
    integer(i4) :: material

    material = int(material_of(deck, b, scene, diagnostics), i4)
    if (deck%is_in(b, 'container')) then
      call add_container(deck, b, material, scene, share, n, diagnostics)
    else if (deck%is_in(b, 'brick_wall')) then
      call add_brick_wall(deck, b, material, scene, share, n, diagnostics)
    else if (deck%is_in(b, 'arch')) then
      call add_arch(deck, b, material, scene, share, n, diagnostics)
    else if (deck%is_in(b, 'chain')) then
      call add_chain(deck, b, material, scene, share, n)
    else
      scene%bodies%material(n + 1) = material
      if (deck%is_in(b, 'wall')) call add_wall_body(deck, b, scene, n + 1, diagnostics)
      if (deck%is_in(b, 'body')) call add_body(deck, b, scene, n + 1, diagnostics)
      call share%settle(scene, n)
    end if
  end subroutine add_block

  !> The disks of a [[chain]] block.
  subroutine add_chain(deck, b, material, scene, share, n)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    integer(i4), intent(in) :: material
    type(scene_t), intent(inout) :: scene
    type(share_t), intent(inout) :: share
    integer, intent(inout) :: n
    real(wp), parameter :: centre(2) = 0
    integer :: i, last, colour

    call colour_index(scene, deck%word(b, 'colour'), colour)
    last = deck%integer(b, 'count')
    do i = 1, last
      scene%bodies%material(n + 1) = material
      scene%bodies%position(:, n + 1) = deck%pair(b, 'from') + (deck%pair(b, 'to') - deck%pair(b, 'from')) &
                                        *(real(i - 1, wp)/real(last - 1, wp))
      call add_disk(scene%contactors, n + 1, colour, deck%number(b, 'radius'), centre)
      call weigh_body(scene, n + 1, scene%contactors%n)
      call share%settle(scene, n)
    end do
  end subroutine add_chain

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
  subroutine add_sample(deck, templates, sample, before, called, scene, share, n, contactors, diagnostics)
    type(deck_t), intent(in) :: deck
    type(grain_template_t), intent(inout) :: templates(:)
    type(sample_t), intent(inout) :: sample
    integer, intent(in) :: before
    integer(i4), intent(in) :: called(:)
    type(scene_t), intent(inout) :: scene
    type(share_t), intent(inout) :: share
    integer, intent(inout) :: n, contactors
    type(diagnostics_t), intent(inout) :: diagnostics
    type(scene_t) :: other
    type(error_t), allocatable :: error
    integer :: i, c, colour, material, first
    logical :: is_own, is_called

    material = material_of(deck, sample%block, scene, diagnostics)
    call colour_index(scene, deck%word(sample%block, 'colour'), colour)
    do i = 1, size(sample%templates)
      call colour_template(templates(sample%templates(i)), deck%word(sample%block, 'colour'), scene)
    end do
    if (deck%ranks > 1 .and. sample%n > count(called > before .and. called <= before + sample%n)) &
      call note_look(deck, templates, sample, before, colour, share%census)
    contactors = contactors + sample%before
    do i = sample%before + 1, sample%before + size(sample%radius)
      is_own = i >= sample%first .and. i <= sample%last
      is_called = place_in(called, int(before + i, i4)) > 0
      if (is_own .or. is_called) then
        n = n + 1
        first = scene%contactors%n + 1
        call add_grain(deck, templates, sample, i, scene, n, material, colour, error)
        if (deck%ranks > 1) then
          scene%bodies%id(n) = int(before + i, i4)
          scene%bodies%owner(n) = int(merge(-1, deck%rank, is_called), i4)
          call reserve(scene%contactors%id, scene%contactors%n)
          scene%contactors%id(first:scene%contactors%n) = [(int(contactors + c, i4), c=1, scene%contactors%n - first + 1)]
        end if
      else
        call clear(scene, other)
        call add_grain(deck, templates, sample, i, other, 1, material, colour, error)
        if (other%contactors%n > 0) call share%census%note(other%bodies%position(:, 1), &
                                                           minval(other%contactors%reach(:other%contactors%n)))
      end if
      contactors = contactors + shapes_of(templates, sample, i)
      if (allocated(error)) then
        call deck%complain(diagnostics, error%message, sample%block, 'shape')
        return
      end if
    end do
    contactors = contactors + sample%n - sample%before - size(sample%radius)
  end subroutine add_sample

  !> Number of shapes of a grain.
  pure integer function shapes_of(templates, sample, i) result(n)
    type(grain_template_t), intent(in) :: templates(:)
    type(sample_t), intent(in) :: sample
    integer, intent(in) :: i

    n = 1
    if (allocated(sample%template)) n = templates(sample%template(i))%shapes%n
  end function shapes_of

  !> Note what all grains of a sample have in common, or all of a template.
  subroutine note_look(deck, templates, sample, before, colour, census)
    type(deck_t), intent(in) :: deck
    type(grain_template_t), intent(in) :: templates(:)
    type(sample_t), intent(in) :: sample
    integer, intent(in) :: before, colour
    type(census_t), intent(inout) :: census
    real(wp) :: velocity(3)
    integer :: c, i, t

    velocity = deck%vector(sample%block, 'velocity')
    do i = 1, size(sample%templates)
      t = sample%templates(i)
      if (all(sample%template /= t)) cycle
      do c = 1, templates(t)%shapes%n
        call census%note_look(int(templates(t)%shapes%kind(c)), int(templates(t)%shapes%colour(c)), &
                              before + [findloc(sample%template, t, 1), findloc(sample%template, t, 1, back=.true.)], &
                              norm2(velocity(:deck%dimension)))
      end do
    end do
    if (size(sample%templates) > 0) return
    ! Not findloc: gfortran's finds no word that is shorter than those of the list.
    call census%note_look(choice_index(deck%word(sample%block, 'shape'), choices_of(kind_names)), colour, before + [1, sample%n], &
                          norm2(velocity(:deck%dimension)))
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
      other%period_z = scene%period_z
      other%bodies%has_cell = scene%bodies%has_cell
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
  subroutine add_grain(deck, templates, sample, i, scene, n, material, colour, error)
    type(deck_t), intent(in) :: deck
    type(grain_template_t), intent(in) :: templates(:)
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
      if (allocated(sample%template)) then
        call place_grain(scene, n, templates(sample%template(i)), sample%radius(i), sample%random)
      else
        call add_grain_shape(deck, sample, i, deck%word(sample%block, 'shape'), scene, n, colour, error)
        if (allocated(error)) return
        call weigh_body(scene, n, scene%contactors%n)
      end if
      if (scene%period > 0) bodies%position(1, n) = modulo(bodies%position(1, n), scene%period)
      if (scene%period_y > 0) bodies%position(2, n) = modulo(bodies%position(2, n), scene%period_y)
      if (scene%period_z > 0) bodies%position(3, n) = modulo(bodies%position(3, n), scene%period_z)
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
