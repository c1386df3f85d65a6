!> Scenes of every kind of shape, in states drawn at random, and the parts of them that ranks hold: for tests of what ranks
!! write together.
module rank_parts
  use sg_contactors, only: add_disk, add_hollow, add_polygon, add_segment, contactors_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: error_t
  use sg_field_visitor, only: sync_on_owner
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: law_iqs_g0
  use sg_local_numbers, only: contactors_of_bodies, local_body, local_contactor
  use sg_owners, only: contact_owner
  use sg_pack_bodies, only: order_records, pack_bodies, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_random, only: random_t
  use sg_scene, only: scene_t, see_t
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  use sg_text, only: to_text
  implicit none
  private
  public :: plane_scene, space_scene, shake, chain_of_contacts, draw_owners, take_part

  real(wp), parameter :: origin(2) = 0, origin_in_space(3) = 0

contains

  !> A scene in the plane: disks, clusters, polygons, and among them a floor and a drum.
  subroutine plane_scene(scene, n)
    type(scene_t), intent(out) :: scene !! scene made
    integer, intent(in) :: n !! number of bodies
    real(wp), parameter :: square(2, 4) = reshape([-0.5_wp, -0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp], [2, 4])
    integer :: b

    scene%dimension = 2
    scene%period = 10
    call scene%bodies%allocate(n)
    do b = 1, n
      select case (modulo(b, 11))
      case (0)
        call add_segment(scene%contactors, b, 2, 5.0_wp, 0.2_wp, origin, 0.1_wp)
      case (5)
        call add_hollow(scene%contactors, b, 2, 6.0_wp, origin)
      case (1, 4, 8)
        call add_polygon(scene%contactors, b, 1, square, origin)
      case (2)
        call add_disk(scene%contactors, b, 1, 0.4_wp, [-0.4_wp, 0.0_wp])
        call add_disk(scene%contactors, b, 3, 0.3_wp, [0.5_wp, 0.0_wp])
      case default
        call add_disk(scene%contactors, b, 1, 0.3_wp, origin)
      end select
    end do
    call finish_scene(scene)
  end subroutine plane_scene

  !> A scene in space: spheres, boxes, cylinders, and among them planes and a drum.
  subroutine space_scene(scene, n)
    type(scene_t), intent(out) :: scene !! scene made
    integer, intent(in) :: n !! number of bodies
    real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
                                                      1.0_wp], [3, 3])
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    integer :: b

    scene%dimension = 3
    scene%period = 10
    scene%period_y = 8
    scene%contactors%dimension = 3
    call scene%bodies%allocate(n, 3)
    call box_polyhedron([0.3_wp, 0.4_wp, 0.5_wp], shape, error)
    do b = 1, n
      select case (modulo(b, 11))
      case (0)
        call add_plane(scene%contactors, b, 2, [5.0_wp, 5.0_wp, 0.1_wp], origin_in_space, identity)
      case (5)
        call add_hollow_cylinder(scene%contactors, b, 2, 2.0_wp, 6.0_wp, origin_in_space, [0.0_wp, 0.0_wp, 1.0_wp])
      case (1, 4, 8)
        call add_polyhedron(scene%contactors, b, 1, shape, origin_in_space)
      case (2)
        call add_sphere(scene%contactors, b, 1, 0.4_wp, [-0.4_wp, 0.0_wp, 0.0_wp])
        call add_cylinder(scene%contactors, b, 3, 0.3_wp, 0.1_wp, [0.5_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp])
      case default
        call add_sphere(scene%contactors, b, 1, 0.3_wp, origin_in_space)
      end select
    end do
    call finish_scene(scene)
  end subroutine space_scene

  !> One law, and what each body weighs.
  subroutine finish_scene(scene)
    type(scene_t), intent(inout) :: scene
    integer :: b

    allocate (scene%laws(1), scene%sees(1), scene%drives(0), scene%pressures(0), scene%materials(3), scene%colours(3))
    scene%laws(1)%name = 'sand'
    ! A law that keeps an internal value of each contact.
    scene%laws(1)%kind = law_iqs_g0
    scene%laws(1)%static_friction = 0.5_wp
    scene%laws(1)%dynamic_friction = 0.5_wp
    scene%sees(1) = see_t(law=1, alert=0.01_wp)
    do b = 1, 3
      scene%materials(b)%name = to_text(b)
      scene%materials(b)%density = 1
      scene%colours(b)%s = to_text(b)
    end do
    do b = 1, scene%bodies%n
      scene%bodies%mass(b) = 1 + 0.1_wp*real(b, wp)
      scene%bodies%area(b) = 0.2_wp + 0.01_wp*real(b, wp)
      scene%bodies%material(b) = int(1 + modulo(b, 3), i4)
      scene%bodies%is_grain(b) = modulo(b, 11) /= 0 .and. modulo(b, 11) /= 5
    end do
  end subroutine finish_scene

  !> Give all bodies another state, drawn at random.
  subroutine shake(scene, random)
    type(scene_t), intent(inout) :: scene !! scene to shake
    type(random_t), intent(inout) :: random !! the same on all ranks
    integer :: b, c

    associate (bodies => scene%bodies)
      do b = 1, bodies%n
        bodies%position(:, b) = [(random%uniform(0.0_wp, 10.0_wp), c=1, scene%dimension)]
        bodies%velocity(:, b) = [(random%uniform(-1.0_wp, 1.0_wp), c=1, bodies%n_velocity)]
        bodies%crossings(b) = int(10*random%uniform(-1.0_wp, 1.0_wp), i4)
        if (allocated(bodies%angle)) bodies%angle(b) = random%uniform(-3.0_wp, 3.0_wp)
        if (allocated(bodies%crossings_y)) bodies%crossings_y(b) = int(10*random%uniform(-1.0_wp, 1.0_wp), i4)
        if (allocated(bodies%orientation)) then
          bodies%orientation(:, b) = [(random%uniform(-1.0_wp, 1.0_wp), c=1, 4)]
          bodies%orientation(:, b) = bodies%orientation(:, b)/norm2(bodies%orientation(:, b))
        end if
      end do
      bodies%middle(:scene%dimension, :) = bodies%position
    end associate
  end subroutine shake

  !> Contacts between each contactor and one some places on, with numbers drawn at random.
  subroutine chain_of_contacts(scene, stride, random, contacts)
    type(scene_t), intent(in) :: scene !! scene whose shapes touch
    integer, intent(in) :: stride !! places on; 0 for no contact at all
    type(random_t), intent(inout) :: random !! the same on all ranks
    type(contacts_t), intent(out) :: contacts !! contacts made
    integer :: k, c

    contacts%dimension = scene%dimension
    contacts%n_components = scene%dimension
    contacts%n_internal = 1
    if (stride == 0) return
    contacts%n = scene%contactors%n - stride
    call reserve_contacts(contacts, contacts%n)
    do k = 1, contacts%n
      contacts%contactor(:, k) = int([k, k + stride], i4)
      contacts%body(:, k) = scene%contactors%body(contacts%contactor(:, k))
      contacts%feature(k) = int(7*k, i4)
      contacts%law(k) = 1
      contacts%status(k) = int(modulo(k, 4), i1)
      contacts%image(k) = int(modulo(k, 3) - 1, i1)
      if (scene%dimension == 3) contacts%image_y(k) = int(modulo(k, 3) - 1, i1)
      contacts%gap(k) = random%uniform(-1e-3_wp, 1e-3_wp)
      contacts%normal(:, k) = [(random%uniform(-1.0_wp, 1.0_wp), c=1, scene%dimension)]
      contacts%point(:, k) = [(random%uniform(0.0_wp, 10.0_wp), c=1, scene%dimension)]
      contacts%impulse(:, k) = [(random%uniform(0.0_wp, 10.0_wp), c=1, scene%dimension)]
      contacts%internal(:, k) = random%uniform(0.0_wp, 10.0_wp)
    end do
  end subroutine chain_of_contacts

  !> Owners of all bodies, drawn at random; -1 of those that are no grains.
  subroutine draw_owners(scene, ranks, random, owner)
    type(scene_t), intent(in) :: scene !! whole scene
    integer, intent(in) :: ranks !! ranks among which grains are dealt out
    type(random_t), intent(inout) :: random !! the same on all ranks
    integer(i4), allocatable, intent(out) :: owner(:) !! rank of each body
    integer :: b

    allocate (owner(scene%bodies%n), source=-1_i4)
    do b = 1, scene%bodies%n
      if (scene%bodies%is_grain(b)) owner(b) = min(int(real(ranks, wp)*random%uniform(), i4), int(ranks, i4) - 1_i4)
    end do
  end subroutine draw_owners

  !> The part of a rank: its bodies, all that are no grains, and the bodies that its contacts touch.
  subroutine take_part(whole, all_contacts, owner, rank, ranks, scene, contacts)
    type(scene_t), intent(in) :: whole !! whole scene
    type(contacts_t), intent(in) :: all_contacts !! its contacts
    integer(i4), intent(in) :: owner(:) !! rank of each body, -1 of those that are no grains
    integer, intent(in) :: rank !! whose part
    integer, intent(in) :: ranks !! number of ranks
    type(scene_t), intent(out) :: scene !! its scene
    type(contacts_t), intent(out) :: contacts !! its contacts
    type(parcel_t) :: parcel
    integer(i4), allocatable :: first(:), list(:), held(:)
    integer, allocatable :: start(:)
    logical :: is_held(whole%bodies%n)
    integer :: b, n_own

    if (ranks == 1) then
      scene = whole
      contacts = all_contacts
      return
    end if
    is_held = owner == rank .or. owner < 0
    do b = 1, all_contacts%n
      associate (pair => all_contacts%body(:, b))
        if (contact_owner(owner(pair)) == rank) is_held(pair) = .true.
      end associate
    end do
    call contactors_of_bodies(whole%contactors, whole%bodies%n, first, list)
    held = pack([(int(b, i4), b=1, whole%bodies%n)], is_held)
    call pack_bodies(whole, held, first, list, owner(held), sync_on_owner, parcel)
    call order_records(parcel, rank, ranks, start, n_own)
    scene = whole
    call rebuild_scene(scene, parcel, start, n_own)
    allocate (scene%drives(0), scene%pressures(0))
    scene%bodies%middle(:whole%dimension, :) = scene%bodies%position
    call take_contacts(all_contacts, owner, rank, scene, contacts)
  end subroutine take_part

  !> The contacts of a rank, with the numbers that bodies and contactors have there.
  subroutine take_contacts(whole, owner, rank, scene, contacts)
    type(contacts_t), intent(in) :: whole
    integer(i4), intent(in) :: owner(:)
    integer, intent(in) :: rank
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer(i4), allocatable :: kept(:)
    integer :: k, i

    kept = pack([(int(k, i4), k=1, whole%n)], [(contact_owner(owner(whole%body(:, k))) == rank, k=1, whole%n)])
    contacts = whole
    contacts%n = size(kept)
    if (size(kept) > 0) call contacts%keep(kept)
    do k = 1, contacts%n
      do i = 1, 2
        contacts%body(i, k) = int(local_body(scene%bodies, contacts%body(i, k)), i4)
        contacts%contactor(i, k) = int(local_contactor(scene%contactors, contacts%contactor(i, k)), i4)
      end do
    end do
  end subroutine take_contacts
end module rank_parts
