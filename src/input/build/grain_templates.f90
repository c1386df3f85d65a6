!> Templates of grains: the blocks [[clump]], and the mesh files that samples name. A grain is a copy of its template at its own
!! size, turned at random.
module sg_grain_templates
  use sg_blocks, only: deck_t
  use sg_contactors, only: contactors_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, pi
  use sg_list_files, only: list_files
  use sg_polyhedra_from_deck, only: place_polyhedral_shape, polyhedron_of_file
  use sg_polyhedron, only: polyhedron_t
  use sg_random, only: random_t
  use sg_rotations, only: frame_of, no_rotation
  use sg_rounded_points, only: farthest_point, rounded_points, sieve_opening
  use sg_scaled_shapes, only: add_scaled_shapes
  use sg_polyhedron_moments, only: principal_inertia, solid_t
  use sg_scene, only: colour_index, scene_t
  use sg_shared_moments, only: shared_moments
  use sg_shapes_from_deck, only: add_shape
  use sg_solid_bodies, only: move_body_frame, set_inertia
  use sg_space_generators, only: random_rotation
  use sg_text, only: append_word, text_t, to_text
  use sg_values, only: value_t
  use sg_weights_from_deck, only: invert_mass, weigh_body
  implicit none
  private
  public :: grain_template_t, read_templates, choose_templates, colour_template, place_grain, &
            names_files, files_of_sample

  !> One template
  type :: grain_template_t
    !> Block of the deck: a [[clump]], or the [[sample]] that names the file
    integer :: block = 0
    !> Name of a clump, empty for a file
    character(len=:), allocatable :: name
    !> Shapes in the frame of the body: about its centre of mass, in space along its principal axes
    type(contactors_t) :: shapes
    !> Colour of each shape, empty for that of the sample
    type(text_t), allocatable :: colours(:)
    !> Area [m2] or volume [m3], and moments about the centre for a density of one; in the plane the first alone
    real(wp) :: volume = 0, moments(3) = 0
    !> Radius of the circle or sphere about the centre of mass, and smallest opening of a sieve that it passes [m]
    real(wp) :: reach = 0, opening = 0
  end type grain_template_t

contains

  !> Read all clumps, and the files of all samples.
  subroutine read_templates(deck, templates, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(grain_template_t), allocatable, intent(out) :: templates(:) !! clumps and files in the order of the deck
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(text_t), allocatable :: files(:)
    integer :: b, i, n

    n = deck%count_of('clump')
    do b = 1, deck%n
      if (.not. names_files(deck, b)) cycle
      call check_file_keys(deck, b, diagnostics)
      call files_of_sample(deck, b, files, diagnostics)
      n = n + size(files)
    end do
    allocate (templates(n))
    n = 0
    do b = 1, deck%n
      if (deck%is_in(b, 'clump')) then
        n = n + 1
        call read_clump(deck, b, templates(n), diagnostics)
      else if (names_files(deck, b)) then
        call files_of_sample(deck, b, files)
        ! Files that appear or vanish meanwhile are left alone.
        do i = 1, min(size(files), size(templates) - n)
          n = n + 1
          call read_file(deck, b, files(i)%s, templates(n), diagnostics)
        end do
      end if
    end do
    call check_clumps(deck, diagnostics)
  end subroutine read_templates

  !> Does a block make grains of the shapes of files?
  pure logical function names_files(deck, b)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block

    names_files = .false.
    if (deck%is_in(b, 'sample')) names_files = deck%is_given(b, 'files')
  end function names_files

  !> Refuse keys of random polyhedra next to files.
  subroutine check_file_keys(deck, b, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=10), parameter :: of_random(3) = ['vertices  ', 'elongation', 'flatness  ']
    integer :: i

    do i = 1, size(of_random)
      if (deck%is_given(b, trim(of_random(i)))) &
        call deck%complain(diagnostics, '"'//trim(of_random(i))//'" is refused next to "files", which hold the shapes', b, &
                           trim(of_random(i)))
    end do
  end subroutine check_file_keys

  !> Files that a sample names.
  subroutine files_of_sample(deck, b, files, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the sample
    type(text_t), allocatable, intent(out) :: files(:) !! paths
    type(diagnostics_t), intent(inout), optional :: diagnostics !! patterns that no file matches
    type(text_t), allocatable :: found(:)
    type(value_t) :: value
    integer :: i, k

    value = deck%value(b, 'files')
    allocate (files(0))
    do i = 1, value%n_words
      if (index(value%words(i)%s, '/') == 1) then
        call list_files('', value%words(i)%s, found)
      else
        call list_files(deck%folder, value%words(i)%s, found)
      end if
      if (size(found) == 0 .and. present(diagnostics)) &
        call deck%complain(diagnostics, 'no file matches "'//value%words(i)%s//'"', b, 'files')
      do k = 1, size(found)
        call append_word(files, found(k)%s)
      end do
    end do
  end subroutine files_of_sample

  !> A clump.
  subroutine read_clump(deck, b, template, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(grain_template_t), intent(inout) :: template
    type(diagnostics_t), intent(inout) :: diagnostics
    type(scene_t) :: scene
    integer :: inner, errors

    errors = diagnostics%count()
    template%block = b
    template%name = deck%word(b, 'name')
    call begin_body(deck, scene)
    do inner = b + 1, deck%n
      if (deck%blocks(inner)%parent /= b) exit
      call add_shape(deck, inner, b, scene, 1, diagnostics)
    end do
    if (diagnostics%count() > errors) return
    if (scene%contactors%n == 0) then
      call deck%complain(diagnostics, 'this clump has no shape: it needs [[clump.shape]]', b)
      return
    end if
    call weigh_body(scene, 1, 1)
    if (deck%word(b, 'mass_of') == 'union') call take_off_shared(scene)
    call measure(scene, template)
  end subroutine read_clump

  !> The polyhedron of a file.
  subroutine read_file(deck, b, file, template, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: file
    type(grain_template_t), intent(inout) :: template
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: message, warning
    type(polyhedron_t) :: shape
    type(scene_t) :: scene
    integer :: colour
    logical :: is_hull

    template%block = b
    template%name = ''
    is_hull = .false.
    if (deck%is_given(b, 'hull')) is_hull = deck%flag(b, 'hull')
    call polyhedron_of_file(file, 1.0_wp, is_hull, shape, message, warning)
    if (allocated(warning)) call deck%warn(diagnostics, file//': '//warning, b, 'files')
    if (allocated(message)) then
      call deck%complain(diagnostics, file//': '//message, b, 'files')
      return
    end if
    call begin_body(deck, scene)
    call colour_index(scene, '', colour)
    call place_polyhedral_shape(scene, 1, colour, shape, [0.0_wp, 0.0_wp, 0.0_wp], frame_of(no_rotation))
    call weigh_body(scene, 1, 1)
    call measure(scene, template)
  end subroutine read_file

  !> A scene of one body at the origin whose density is one.
  subroutine begin_body(deck, scene)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(inout) :: scene

    scene%dimension = deck%dimension
    scene%contactors%dimension = deck%dimension
    allocate (scene%materials(1))
    scene%materials(1)%name = ''
    scene%materials(1)%density = 1
    call scene%bodies%allocate(1, deck%dimension)
    scene%bodies%material(1) = 1
    if (allocated(scene%bodies%orientation)) scene%bodies%orientation(:, 1) = no_rotation
  end subroutine begin_body

  !> Make mass, centre and moments of a body those of the union of its shapes, from those of their sum.
  subroutine take_off_shared(scene)
    type(scene_t), intent(inout) :: scene
    real(wp) :: volume, moment(3), second(3, 3), centre(3), moments(3), axes(3, 3)
    type(solid_t) :: solid
    integer :: k

    call shared_moments(scene%contactors, 1, scene%contactors%n, volume, moment, second)
    if (.not. volume > 0) return
    associate (bodies => scene%bodies, contactors => scene%contactors)
      volume = bodies%mass(1) - volume
      centre = -moment/volume
      bodies%mass(1) = volume
      if (scene%dimension == 2) then
        bodies%inertia(1) = bodies%inertia(1) - second(1, 1) - second(2, 2) - volume*sum(centre**2)
        contactors%shift(:, :contactors%n) = contactors%shift(:, :contactors%n) - spread(centre(:2), 2, contactors%n)
        return
      end if
      solid%volume = volume
      solid%inertia = second + volume*spread(centre, 1, 3)*spread(centre, 2, 3)
      do k = 1, 3
        solid%inertia(k, k) = solid%inertia(k, k) + bodies%principal(k, 1) - second(1, 1) - second(2, 2) - second(3, 3) &
                              - volume*sum(centre**2)
      end do
      call principal_inertia(solid, moments, axes)
      call move_body_frame(bodies, contactors, 1, 1, contactors%n, centre, axes)
      bodies%principal(:, 1) = moments
    end associate
  end subroutine take_off_shared

  !> Measure a body that is weighed, and keep its shapes.
  subroutine measure(scene, template)
    type(scene_t), intent(inout) :: scene
    type(grain_template_t), intent(inout) :: template
    real(wp), allocatable :: point(:, :), radius(:)
    integer :: c

    template%volume = scene%bodies%mass(1)
    if (scene%dimension == 2) then
      template%moments(1) = scene%bodies%inertia(1)
    else
      template%moments = scene%bodies%principal(:, 1)
    end if
    call rounded_points(scene%contactors, 1, scene%contactors%n, point, radius)
    template%reach = farthest_point(point, radius)
    template%opening = sieve_opening(point, radius)
    allocate (template%colours(0))
    do c = 1, scene%contactors%n
      call append_word(template%colours, scene%colours(scene%contactors%colour(c))%s)
    end do
    template%shapes = scene%contactors
  end subroutine measure

  !> Refuse two clumps of one name, and warn of clumps that no sample uses.
  subroutine check_clumps(deck, diagnostics)
    type(deck_t), intent(in) :: deck
    type(diagnostics_t), intent(inout) :: diagnostics
    type(text_t), allocatable :: names(:), used(:)
    character(len=:), allocatable :: name
    type(value_t) :: value
    integer :: b, i

    allocate (names(0), used(0))
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'sample')) cycle
      if (deck%word(b, 'shape') /= 'clump') cycle
      value = deck%value(b, 'clump')
      do i = 1, value%n_words
        call append_word(used, value%words(i)%s)
      end do
    end do
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'clump')) cycle
      name = deck%word(b, 'name')
      if (place_of(name, names) > 0) call deck%complain(diagnostics, 'there are two clumps named "'//name//'"', b, 'name')
      if (place_of(name, used) == 0) call deck%warn(diagnostics, 'no [[sample]] uses the clump "'//name//'"', b, 'name')
      call append_word(names, name)
    end do
  end subroutine check_clumps

  !> Place of a name in a list; 0 where it is not there.
  pure integer function place_of(name, names) result(place)
    character(len=*), intent(in) :: name
    type(text_t), intent(in) :: names(:)

    do place = 1, size(names)
      if (names(place)%s == name) return
    end do
    place = 0
  end function place_of

  !> Templates that the grains of a sample draw from: none where their shapes are made.
  subroutine choose_templates(deck, b, templates, chosen, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the sample
    type(grain_template_t), intent(in) :: templates(:) !! all templates
    integer, allocatable, intent(out) :: chosen(:) !! numbers of templates
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(text_t), allocatable :: names(:)
    type(value_t) :: value
    integer :: i, k

    allocate (names(0))
    chosen = pack([(i, i=1, size(templates))], templates%block == b)
    if (deck%word(b, 'shape') /= 'clump') return
    do i = 1, size(templates)
      call append_word(names, templates(i)%name)
    end do
    value = deck%value(b, 'clump')
    do i = 1, value%n_words
      k = place_of(value%words(i)%s, names)
      if (k == 0) then
        call deck%complain_unknown(diagnostics, 'clump', value%words(i)%s, names, b, 'clump')
      else
        chosen = [chosen, k]
      end if
    end do
  end subroutine choose_templates

  !> Give the shapes of a template the colours that they have in a scene.
  subroutine colour_template(template, colour_of_sample, scene)
    type(grain_template_t), intent(inout) :: template !! template to colour
    character(len=*), intent(in) :: colour_of_sample !! colour of shapes that have none of their own
    type(scene_t), intent(inout) :: scene !! scene that lists the colours
    integer :: c, colour

    do c = 1, template%shapes%n
      if (template%colours(c)%s == '') then
        call colour_index(scene, colour_of_sample, colour)
      else
        call colour_index(scene, template%colours(c)%s, colour)
      end if
      template%shapes%colour(c) = colour
    end do
  end subroutine colour_template

  !> Make a body of known place and material a copy of a template, turned at random.
  subroutine place_grain(scene, n, template, radius, random)
    type(scene_t), intent(inout) :: scene !! scene with the body, which gets orientation, shapes and mass
    integer, intent(in) :: n !! number of the body
    type(grain_template_t), intent(in) :: template !! template of the grain
    real(wp), intent(in) :: radius !! of the circle or sphere about the grain [m]
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp) :: factor, density

    factor = radius/template%reach
    density = 0
    if (scene%bodies%material(n) > 0) density = scene%materials(scene%bodies%material(n))%density
    call add_scaled_shapes(scene%contactors, n, template%shapes, factor)
    associate (bodies => scene%bodies)
      if (scene%dimension == 2) then
        bodies%angle(n) = random%uniform(0.0_wp, 2*pi)
        bodies%area(n) = template%volume*factor**2
        bodies%mass(n) = density*bodies%area(n)
        bodies%inertia(n) = density*template%moments(1)*factor**4
        call invert_mass(bodies, n)
      else
        bodies%orientation(:, n) = random_rotation(random)
        bodies%area(n) = template%volume*factor**3
        call set_inertia(bodies, n, density*bodies%area(n), density*template%moments*factor**5)
      end if
    end associate
  end subroutine place_grain
end module sg_grain_templates
