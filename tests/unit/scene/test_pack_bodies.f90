!> Bodies as records: what is packed is built again bit by bit, whole or in part, in any order, and touches as before.
program test_pack_bodies
  use harness, only: tests_t
  use polyhedra, only: prism_polyhedron
  use same_bits, only: same, same_bodies, same_contactors, same_planar, same_spatial
  use scenes_space, only: turn_at_random
  use sg_bodies, only: bodies_t, drop_rotation
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_segment
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_error, only: error_t
  use sg_field_visitor, only: sync_on_owner
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4, pi
  use sg_local_numbers, only: contactors_of_bodies, local_body, local_contactor
  use sg_neighbour_list, only: neighbours_t
  use sg_pack_bodies, only: order_records, pack_bodies, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_polyhedron, only: polyhedron_t
  use sg_random, only: random_t
  use sg_replicated_data, only: keep_replicated, localise, replicated_data_t
  use sg_rotations, only: frame_of
  use sg_scene, only: colour_index, scene_t
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  use sg_text, only: to_text
  implicit none
  integer, parameter :: n_bodies = 600, n_wide = 6
  type(tests_t) :: t

  call test_parcel()
  call test_kind_of_scene('in the plane', 2, turns=.true., periodic=.false.)
  call test_kind_of_scene('in the plane, periodic', 2, turns=.true., periodic=.true.)
  call test_kind_of_scene('in the plane, nothing turns', 2, turns=.false., periodic=.true.)
  call test_kind_of_scene('in space', 3, turns=.true., periodic=.false.)
  call test_kind_of_scene('in space, periodic', 3, turns=.true., periodic=.true.)
  call test_kind_of_scene('in space, nothing turns', 3, turns=.false., periodic=.false.)
  call t%finish()

contains

  !> Values come out as they went in, and a received list is taken over.
  subroutine test_parcel()
    type(parcel_t) :: parcel
    real(wp), allocatable :: received(:)
    real(wp) :: value, values(3), records(2, 2)
    integer(i4) :: number, numbers(2), number_records(2, 2)

    call parcel%put(0.1_wp)
    call parcel%put(huge(number))
    call parcel%put([1.0_wp/3, -0.0_wp, tiny(1.0_wp)])
    call parcel%put(reshape([0.2_wp, 0.3_wp, 0.4_wp, 0.5_wp], [2, 2]))
    call parcel%put([-7_i4, 8_i4])
    call parcel%put(reshape([1_i4, 2_i4, 3_i4, 4_i4], [2, 2]))
    call t%equal(parcel%n, 15, 'values of a parcel')
    allocate (received(parcel%n))
    received(:) = parcel%value(:parcel%n)
    parcel%at = 5
    call parcel%adopt(received)
    call t%check(.not. allocated(received), 'a received list is taken over')
    call parcel%take(value)
    call parcel%take(number)
    call parcel%take(values)
    call parcel%take(records)
    call parcel%take(numbers)
    call parcel%take(number_records)
    call t%check(same([value, values], [0.1_wp, 1.0_wp/3, -0.0_wp, tiny(1.0_wp)]), 'reals')
    call t%check(same(records, reshape([0.2_wp, 0.3_wp, 0.4_wp, 0.5_wp], [2, 2])), 'records')
    call t%check(same([number, numbers], [huge(number), -7_i4, 8_i4]), 'whole numbers')
    call t%check(same(number_records, reshape([1_i4, 2_i4, 3_i4, 4_i4], [2, 2])), 'records of whole numbers')
    call t%equal(parcel%at, parcel%n, 'all is read')
  end subroutine test_parcel

  subroutine test_kind_of_scene(name, dimension, turns, periodic)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension
    logical, intent(in) :: turns, periodic
    type(scene_t) :: scene

    call make_scene(scene, dimension, turns, periodic)
    call test_whole(scene, name)
    call test_parts(scene, name)
    call test_empty(scene, name)
  end subroutine test_kind_of_scene

  !> A scene of every kind of shape of its dimension, all values at random; the last contactor is the first body's.
  subroutine make_scene(scene, dimension, turns, periodic)
    type(scene_t), intent(out) :: scene
    integer, intent(in) :: dimension
    logical, intent(in) :: turns, periodic
    type(random_t) :: random
    integer :: b, colour, rank

    call random%seed(11)
    scene%dimension = dimension
    scene%contactors%dimension = dimension
    call scene%bodies%allocate(n_bodies, dimension)
    call colour_index(scene, 'any', colour)
    call colour_index(scene, 'other', colour)
    allocate (scene%laws(1), scene%sees(1), scene%materials(2))
    scene%laws(1)%name = 'law'
    scene%materials(1)%name = 'stone'
    scene%materials(2)%name = 'a longer name'
    scene%materials%density = [2650.0_wp, 1e-3_wp]
    scene%sees(1)%law = 1
    scene%sees(1)%alert = 0.1_wp
    scene%gravity = [0.1_wp, -9.81_wp, 0.3_wp]
    scene%start_time = 1.5_wp
    scene%start_step = 7
    if (periodic) scene%period = 10
    if (periodic .and. dimension == 3) scene%period_y = 9
    call fill_bodies(scene%bodies, random)
    do b = 1, n_bodies
      rank = modulo(b, 6)
      if (dimension == 2) call add_planar(scene, b, rank, random)
      if (dimension == 3) call add_spatial(scene, b, rank, random)
    end do
    if (dimension == 2) call add_disk(scene%contactors, 1, 2, 0.7_wp, [0.1_wp, 0.2_wp])
    if (dimension == 3) call add_sphere(scene%contactors, 1, 2, 0.7_wp, [0.1_wp, 0.2_wp, 0.3_wp])
    if (.not. turns) call drop_rotation(scene%bodies, keep_orientation=dimension == 2)
    call add_drives(scene)
    allocate (scene%names(n_bodies))
    do b = 1, n_bodies
      scene%names(b)%s = ''
      if (modulo(b, 7) == 3) scene%names(b)%s = 'body '//to_text(b)
    end do
  end subroutine make_scene

  !> Values at random; the first bodies are walls.
  subroutine fill_bodies(bodies, random)
    type(bodies_t), intent(inout) :: bodies
    type(random_t), intent(inout) :: random
    integer :: b, i

    do b = 1, n_bodies
      bodies%position(:2, b) = [10*random%uniform(), 9*random%uniform()]
      if (bodies%dimension == 3) bodies%position(3, b) = 3*random%uniform()
      do i = 1, bodies%n_velocity
        bodies%velocity(i, b) = random%normal()
        bodies%inverse_mass(i, b) = random%uniform()
      end do
      bodies%mass(b) = random%uniform()
      bodies%area(b) = random%uniform()
      bodies%crossings(b) = int(modulo(b, 5) - 2, i4)
      bodies%material(b) = 1 + int(modulo(b, 2), i4)
      if (bodies%dimension == 2) then
        bodies%angle(b) = 2*pi*random%uniform()
        bodies%inertia(b) = random%uniform()
      else
        bodies%orientation(:, b) = [0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp]
        bodies%principal(:, b) = [random%uniform(), random%uniform(), random%uniform()]
        bodies%crossings_y(b) = int(modulo(b, 3) - 1, i4)
      end if
    end do
    bodies%is_grain(:n_wide) = .false.
  end subroutine fill_bodies

  !> Give a body a shape in the plane.
  subroutine add_planar(scene, b, choice, random)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: b, choice
    type(random_t), intent(inout) :: random
    real(wp) :: r, vertices(2, 3 + modulo(b, 4))
    integer :: i

    r = 0.3_wp + 0.4_wp*random%uniform()
    select case (choice)
    case (0)
      call add_disk(scene%contactors, b, 1, r/2, [r/2, 0.0_wp])
      call add_disk(scene%contactors, b, 2, r/3, [-r/2, r/4])
    case (1)
      call add_segment(scene%contactors, b, 1, r, r/5, [0.1_wp*r, 0.0_wp], random%uniform())
    case (2)
      call add_hollow(scene%contactors, b, 1, 5*r, [0.0_wp, 0.0_wp])
    case (3:4)
      do i = 1, size(vertices, 2)
        vertices(:, i) = r*[cos(2*pi*real(i, wp)/real(size(vertices, 2), wp)), sin(2*pi*real(i, wp)/real(size(vertices, 2), wp))]
      end do
      call add_polygon(scene%contactors, b, 1, vertices, [0.0_wp, 0.1_wp])
    case default
      call add_disk(scene%contactors, b, 1, r, [0.0_wp, 0.0_wp])
    end select
  end subroutine add_planar

  !> Give a body a shape in space.
  subroutine add_spatial(scene, b, choice, random)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: b, choice
    type(random_t), intent(inout) :: random
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: r, axis(3), frame(3, 3)

    r = 0.4_wp + 0.5_wp*random%uniform()
    call turn_at_random(scene, b, random)
    frame = frame_of(scene%bodies%orientation(:, b))
    axis = frame(:, 1)
    select case (choice)
    case (0)
      call add_sphere(scene%contactors, b, 1, r/2, [r/2, 0.0_wp, 0.0_wp])
      call add_sphere(scene%contactors, b, 2, r/3, [-r/2, r/4, 0.0_wp])
    case (1)
      call add_plane(scene%contactors, b, 1, [r, r, r/5], [0.1_wp*r, 0.0_wp, 0.0_wp], frame, has_rim=mod(b, 2) == 0)
    case (2)
      call add_hollow_cylinder(scene%contactors, b, 1, 4*r, 3*r, [0.0_wp, 0.0_wp, 0.0_wp], axis)
    case (3)
      call prism_polyhedron(3 + modulo(b, 4), r, r/2, shape, error)
      if (allocated(error)) error stop 'a prism that is none'
      call add_polyhedron(scene%contactors, b, 1, shape, [0.0_wp, 0.1_wp, 0.0_wp])
    case (4)
      call add_cylinder(scene%contactors, b, 1, r, r/3, [0.0_wp, 0.0_wp, 0.0_wp], axis)
    case default
      call add_sphere(scene%contactors, b, 1, r, [0.0_wp, 0.0_wp, 0.0_wp])
    end select
  end subroutine add_spatial

  !> Velocities of two walls, a force on a grain from a table, and two pressures.
  subroutine add_drives(scene)
    type(scene_t), intent(inout) :: scene
    integer :: i

    allocate (scene%drives(4), scene%pressures(2))
    do i = 1, 4
      scene%drives(i)%component = 1 + modulo(i, 2)
      scene%drives(i)%value%constant = real(i, wp)/3
    end do
    scene%drives%body = [2, 5, 77, 15]
    scene%drives(3)%is_velocity = .false.
    allocate (scene%drives(3)%value%times(2), scene%drives(3)%value%values(2))
    scene%drives(3)%value%times = [0.0_wp, 1.0_wp]
    scene%drives(3)%value%values = [0.3_wp, 0.7_wp]
    scene%pressures(1)%body = 4
    scene%pressures(1)%direction = [0.6_wp, 0.8_wp, 0.0_wp]
    scene%pressures(1)%between = [3, 1]
    scene%pressures(1)%thickness = 0.01_wp
    scene%pressures(2)%body = 6
    scene%pressures(2)%length = 2.5_wp
  end subroutine add_drives

  !> The owner of a body when three ranks share the scene.
  pure integer function owner_of_body(scene, b)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b

    owner_of_body = -1
    if (scene%bodies%is_grain(b)) owner_of_body = modulo(b/4, 3)
  end function owner_of_body

  !> All bodies on one rank: the scene as it was.
  subroutine test_whole(scene, name)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: name
    type(scene_t) :: local
    type(parcel_t) :: parcel
    type(replicated_data_t) :: replicated
    integer(i4), allocatable :: first(:), list(:), backwards(:)
    integer, allocatable :: start(:)
    integer :: b, n_own

    call contactors_of_bodies(scene%contactors, n_bodies, first, list)
    backwards = [(int(b, i4), b=n_bodies, 1, -1)]
    call pack_bodies(scene, backwards, first, list, merge(0_i4, -1_i4, scene%bodies%is_grain(backwards)), sync_on_owner, parcel)
    call order_records(parcel, 0, 1, start, n_own)
    call t%equal(n_own, n_bodies, name//', whole: all are owned')
    local = scene
    call rebuild_scene(local, parcel, start, n_own)
    call keep_replicated(scene, replicated)
    call localise(replicated, local)
    call t%check(same_bodies(local%bodies, scene%bodies), name//', whole: bodies')
    call t%check(all(local%bodies%id == [(b, b=1, n_bodies)]), name//', whole: numbers of bodies')
    call t%check(all(local%bodies%owner == merge(0, -1, scene%bodies%is_grain)), name//', whole: owners')
    call t%check(all(local%contactors%id == [(b, b=1, scene%contactors%n)]), name//', whole: numbers of contactors')
    call t%check(same_contactors(local%contactors, scene%contactors), name//', whole: contactors')
    if (scene%dimension == 2) call t%check(same_planar(local%contactors, scene%contactors), name//', whole: shapes')
    if (scene%dimension == 3) call t%check(same_spatial(local%contactors, scene%contactors), name//', whole: shapes')
    call check_frame(scene, local, name)
    call t%check(all(local%drives%body == scene%drives%body) .and. all(local%drives%component == scene%drives%component) .and. &
                 all(local%drives%is_velocity .eqv. scene%drives%is_velocity), name//', whole: drives')
    call t%check(same(local%drives(3)%value%values, scene%drives(3)%value%values), name//', whole: table of a drive')
    call t%check(.not. allocated(local%names), name//', whole: no names')
    call compare_contacts(scene, local, name)
  end subroutine test_whole

  !> What does not depend on bodies.
  subroutine check_frame(scene, local, name)
    type(scene_t), intent(in) :: scene, local
    character(len=*), intent(in) :: name

    call t%check(local%dimension == scene%dimension .and. local%contactors%dimension == scene%dimension .and. &
                 local%bodies%dimension == scene%dimension, name//': dimension')
    call t%check(same([local%gravity, local%period, local%period_y, local%start_time], &
                      [scene%gravity, scene%period, scene%period_y, scene%start_time]), name//': gravity, periods, time')
    call t%equal(int(local%start_step), int(scene%start_step), name//': step')
    call t%check(local%laws(1)%name == 'law' .and. size(local%laws) == 1, name//': laws')
    call t%check(local%materials(2)%name == 'a longer name' .and. same(local%materials%density, scene%materials%density), &
                 name//': materials')
    call t%check(local%colours(2)%s == 'other' .and. size(local%colours) == 2, name//': colours')
    call t%check(local%sees(1)%law == 1 .and. same([local%sees%alert], [scene%sees%alert]), name//': sees')
    call t%check(.not. allocated(local%start_contacts), name//': no contacts at the start')
  end subroutine check_frame

  !> The same contacts, in the same order, bit by bit.
  subroutine compare_contacts(scene, local, name)
    type(scene_t), intent(in) :: scene, local
    character(len=*), intent(in) :: name
    type(contacts_t) :: expected, got

    call find_contacts(scene, expected)
    call find_contacts(local, got)
    call t%check(expected%n > 50, name//': there are contacts')
    call t%equal(got%n, expected%n, name//': number of contacts')
    if (got%n /= expected%n) return
    associate (n => got%n)
      call t%check(same(got%contactor(:, :n), expected%contactor(:, :n)), name//': contactors of contacts')
      call t%check(same(got%body(:, :n), expected%body(:, :n)), name//': bodies of contacts')
      call t%check(all(got%feature(:n) == expected%feature(:n)), name//': features of contacts')
      call t%check(all(got%image(:n) == expected%image(:n)), name//': images of contacts')
      call t%check(same(got%normal(:, :n), expected%normal(:, :n)), name//': normals of contacts')
      call t%check(same(got%point(:, :n), expected%point(:, :n)), name//': points of contacts')
      call t%check(same(got%gap(:n), expected%gap(:n)), name//': gaps of contacts')
    end associate
  end subroutine compare_contacts

  !> Contacts where the bodies are.
  subroutine find_contacts(scene, contacts)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(out) :: contacts
    type(scene_t) :: placed
    type(neighbours_t) :: pairs
    type(history_t) :: history

    placed = scene
    placed%bodies%middle(:scene%dimension, :) = scene%bodies%position
    if (allocated(scene%bodies%angle)) placed%bodies%middle(3, :) = scene%bodies%angle
    if (allocated(scene%bodies%orientation)) placed%bodies%middle(4:, :) = scene%bodies%orientation
    contacts%dimension = scene%dimension
    contacts%n_components = scene%dimension
    call detect(placed, pairs, history, contacts)
  end subroutine find_contacts

  !> Three ranks with copies of some bodies, packed in an order of their own; then once more from the parts.
  subroutine test_parts(scene, name)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: name
    type(scene_t) :: local, again
    type(parcel_t) :: parcel, next
    type(replicated_data_t) :: replicated
    integer(i4), allocatable :: first(:), list(:), backwards(:)
    integer, allocatable :: start(:)
    integer :: rank, i, b, n_own, n, total

    call keep_replicated(scene, replicated)
    total = 0
    do rank = 0, 2
      call contactors_of_bodies(scene%contactors, n_bodies, first, list)
      parcel%n = 0
      n = 0
      do i = 1, n_bodies
        b = modulo(i*78, n_bodies + 1) ! each body once: 601 is a prime
        if (owner_of_body(scene, b) == modulo(rank + 1, 3) .and. modulo(b, 3) > 0) cycle
        if (owner_of_body(scene, b) == modulo(rank + 2, 3)) cycle
        call pack_bodies(scene, [int(b, i4)], first, list, [int(owner_of_body(scene, b), i4)], sync_on_owner, parcel)
        n = n + 1
      end do
      call order_records(parcel, rank, 3, start, n_own)
      call t%equal(size(start), n, name//', parts: bodies')
      local = scene
      call rebuild_scene(local, parcel, start, n_own)
      call localise(replicated, local)
      total = total + n_own
      call check_numbers(scene, local, rank, name)
      call check_records(scene, local, name)
      call check_localised(scene, local, name)
      next%n = 0
      call contactors_of_bodies(local%contactors, local%bodies%n, first, list)
      backwards = [(int(b, i4), b=local%bodies%n, 1, -1)]
      call pack_bodies(local, backwards, first, list, local%bodies%owner(backwards), sync_on_owner, next)
      call order_records(next, rank, 3, start, n_own)
      again = local
      call rebuild_scene(again, next, start, n_own)
      call t%check(same_bodies(again%bodies, local%bodies) .and. same_contactors(again%contactors, local%contactors), &
                   name//', parts: the same from a part')
    end do
    call t%equal(total, n_bodies, name//', parts: each body is counted once')
  end subroutine test_parts

  !> Own bodies first, both parts ascending; numbers lead to places and back.
  subroutine check_numbers(scene, local, rank, name)
    type(scene_t), intent(in) :: scene, local
    integer, intent(in) :: rank
    character(len=*), intent(in) :: name
    integer :: b, wrong
    logical :: is_own

    wrong = 0
    associate (bodies => local%bodies, contactors => local%contactors)
      do b = 1, bodies%n
        is_own = bodies%owner(b) == rank .or. (bodies%owner(b) < 0 .and. modulo(bodies%id(b), 3_i4) == rank)
        if (is_own .neqv. b <= bodies%n_own) wrong = wrong + 1
        if (b == 1 .or. b == bodies%n_own + 1) cycle
        if (bodies%id(b) <= bodies%id(b - 1)) wrong = wrong + 1
      end do
      call t%equal(wrong, 0, name//', parts: order of bodies')
      call t%check(all(contactors%id(2:) > contactors%id(:contactors%n - 1)), name//', parts: order of contactors')
      wrong = 0
      do b = 0, n_bodies + 1
        if (local_body(bodies, int(b, i4)) /= findloc(bodies%id, b, 1)) wrong = wrong + 1
      end do
      call t%equal(wrong, 0, name//', parts: bodies by number')
      do b = 0, scene%contactors%n + 1
        if (local_contactor(contactors, int(b, i4)) /= findloc(contactors%id, b, 1)) wrong = wrong + 1
      end do
      call t%equal(wrong, 0, name//', parts: contactors by number')
      do b = 1, contactors%n
        if (bodies%id(contactors%body(b)) /= scene%contactors%body(contactors%id(b))) wrong = wrong + 1
      end do
      call t%equal(wrong, 0, name//', parts: bodies of contactors')
    end associate
    call t%equal(local_body(scene%bodies, 5_i4) + local_contactor(scene%contactors, 6_i4), 11, name//', whole: own numbers')
    call t%equal(local_body(scene%bodies, int(n_bodies + 1, i4)) + local_contactor(scene%contactors, 0_i4), 0, &
                 name//', whole: no such number')
  end subroutine check_numbers

  !> A body of a part and the same body of the whole have one record.
  subroutine check_records(scene, local, name)
    type(scene_t), intent(in) :: scene, local
    character(len=*), intent(in) :: name
    type(parcel_t) :: got, expected
    integer(i4), allocatable :: first(:), list(:)
    integer :: b

    call contactors_of_bodies(local%contactors, local%bodies%n, first, list)
    do b = 1, local%bodies%n
      call pack_bodies(local, [int(b, i4)], first, list, [5_i4], sync_on_owner, got)
    end do
    call contactors_of_bodies(scene%contactors, n_bodies, first, list)
    call pack_bodies(scene, local%bodies%id, first, list, spread(5_i4, 1, local%bodies%n), sync_on_owner, expected)
    call t%check(same(got%value(:got%n), expected%value(:expected%n)), name//', parts: records')
    call t%check(same(local%bodies%position, scene%bodies%position(:, local%bodies%id)), name//', parts: positions')
  end subroutine check_records

  !> Drives and pressures follow their bodies.
  subroutine check_localised(scene, local, name)
    type(scene_t), intent(in) :: scene, local
    character(len=*), intent(in) :: name
    integer :: i, n

    n = 0
    do i = 1, size(scene%drives)
      if (all(local%bodies%id /= scene%drives(i)%body)) cycle
      n = n + 1
      if (n > size(local%drives)) exit
      call t%equal(int(local%bodies%id(local%drives(n)%body)), scene%drives(i)%body, name//', parts: body of a drive')
      call t%check(same([local%drives(n)%value%constant], [scene%drives(i)%value%constant]), name//', parts: value of a drive')
    end do
    call t%equal(size(local%drives), n, name//', parts: drives')
    call t%equal(size(local%pressures), 2, name//', parts: pressures')
    call t%check(all(local%bodies%id(local%pressures%body) == scene%pressures%body), name//', parts: pressed bodies')
    call t%check(all(local%bodies%id(local%pressures(1)%between) == scene%pressures(1)%between), name//', parts: between')
    call t%check(all(local%pressures(2)%between == 0), name//', parts: between nothing')
  end subroutine check_localised

  !> A rank without bodies; it can receive some later.
  subroutine test_empty(scene, name)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: name
    type(scene_t) :: empty, local
    type(parcel_t) :: parcel
    type(replicated_data_t) :: replicated
    integer(i4), allocatable :: first(:), list(:)
    integer, allocatable :: start(:)
    integer :: n_own

    call order_records(parcel, 1, 2, start, n_own)
    empty = scene
    call rebuild_scene(empty, parcel, start, n_own)
    call keep_replicated(scene, replicated)
    call localise(replicated, empty)
    call t%equal(empty%bodies%n + empty%contactors%n + empty%bodies%n_own + size(empty%drives), 0, name//', empty: nothing')
    call contactors_of_bodies(scene%contactors, n_bodies, first, list)
    call pack_bodies(scene, [9_i4], first, list, [1_i4], sync_on_owner, parcel)
    call order_records(parcel, 1, 2, start, n_own)
    local = empty
    call rebuild_scene(local, parcel, start, n_own)
    call t%check(local%bodies%n == 1 .and. n_own == 1 .and. same(local%bodies%velocity(:, 1), scene%bodies%velocity(:, 9)), &
                 name//', empty: one body comes')
    call t%check(allocated(local%bodies%angle) .eqv. allocated(scene%bodies%angle), name//', empty: angles')
    call t%check(allocated(local%bodies%orientation) .eqv. allocated(scene%bodies%orientation), name//', empty: orientations')
  end subroutine test_empty
end program test_pack_bodies
