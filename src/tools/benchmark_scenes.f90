!> Lattices of grains that flow towards their centre, for benchmarks of sweeps: nearly all contacts carry impulses.
module sg_benchmark_scenes
  use sg_contactors, only: add_disk
  use sg_error, only: error_t, exit_memory, fail
  use sg_kinds, only: wp, i8, pi
  use sg_laws, only: law_t
  use sg_memory, only: gigabytes, memory_t
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_random, only: random_t
  use sg_scene, only: colour_index, material_t, scene_t, see_t
  use sg_solid_bodies, only: make_solid_body
  use sg_space_contactors, only: add_polyhedron, add_sphere
  use sg_text, only: to_text
  implicit none
  private
  public :: make_lattice, check_lattice

  !> Shapes of grains that lattices are made of
  character(len=10), parameter :: lattice_shapes(3) = [character(len=10) :: 'disk', 'sphere', 'polyhedron']
  !> Memory of a contact of a lattice with its share of everything, rounded up [bytes]
  integer(i8), parameter :: bytes_per_contact = 1000
  !> Distance of neighbours [m], and density [kg/m3]
  real(wp), parameter :: spacing = 0.02_wp, density = 2600

contains

  !> Can a lattice be made of this shape, and is there memory for about so many contacts?
  subroutine check_lattice(shape, contacts, error)
    character(len=*), intent(in) :: shape !! shape wanted
    integer, intent(in) :: contacts !! contacts wanted
    type(error_t), allocatable, intent(out) :: error !! set when it cannot
    type(memory_t) :: memory
    character(len=:), allocatable :: limit
    integer(i8) :: left

    if (all(lattice_shapes /= shape)) then
      call fail(error, 'lattices are of the shapes disk, sphere and polyhedron, not "'//shape//'"')
      return
    end if
    if (memory%fits(bytes_per_contact*int(contacts, i8))) return
    call memory%left(left, limit)
    call fail(error, to_text(contacts)//' contacts need about '//gigabytes(real(bytes_per_contact, wp)*real(contacts, wp))// &
              ', and '//limit//' leaves '//gigabytes(real(left, wp)), code=exit_memory)
  end subroutine check_lattice

  !> A lattice of about so many contacts.
  subroutine make_lattice(scene, shape, contacts, friction)
    type(scene_t), intent(out) :: scene !! the scene made
    character(len=*), intent(in) :: shape !! one of `lattice_shapes`
    integer, intent(in) :: contacts !! contacts wanted
    real(wp), intent(in) :: friction !! Coulomb coefficient

    select case (shape)
    case ('sphere')
      call make_spheres(scene, contacts/6, friction)
    case ('polyhedron')
      call make_bricks(scene, contacts/28, friction)
    case default
      call make_disks(scene, contacts/3, friction)
    end select
  end subroutine make_lattice

  !> Bodies of one material, with one law.
  subroutine begin_lattice(scene, n, dimension, friction, colour)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n, dimension
    real(wp), intent(in) :: friction
    integer, intent(out) :: colour

    scene%dimension = dimension
    scene%contactors%dimension = dimension
    call scene%bodies%allocate(n, dimension)
    call colour_index(scene, 'grain', colour)
    allocate (scene%materials(1), scene%laws(1), scene%sees(1), scene%drives(0), scene%pressures(0))
    scene%materials(1) = material_t('stone', density)
    scene%laws(1) = law_t(name='sand', static_friction=friction, dynamic_friction=friction)
    scene%sees(1) = see_t(law=1, alert=0.05_wp*spacing)
    scene%bodies%material = 1
  end subroutine begin_lattice

  !> A square of about `n` disks on a triangular lattice, flowing towards its centre.
  subroutine make_disks(scene, n, friction)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n
    real(wp), intent(in) :: friction
    type(random_t) :: random
    real(wp) :: radius, middle(2)
    integer :: side, b, colour, row, column

    side = max(2, nint(sqrt(real(n, wp))))
    call random%seed(1)
    call begin_lattice(scene, side*side, 2, friction, colour)
    middle = real(side, wp)*spacing*[0.5_wp, 0.25_wp*sqrt(3.0_wp)]
    do b = 1, side*side
      row = (b - 1)/side
      column = b - 1 - row*side
      radius = spacing/2*random%uniform(0.999_wp, 1.001_wp)
      call add_disk(scene%contactors, b, colour, radius, [0.0_wp, 0.0_wp])
      scene%bodies%position(:, b) = spacing*[real(column, wp) + 0.5_wp*real(mod(row, 2), wp), sqrt(3.0_wp)/2*real(row, wp)]
      scene%bodies%velocity(1:2, b) = middle - scene%bodies%position(:, b)
      scene%bodies%mass(b) = density*pi*radius**2
      scene%bodies%inertia(b) = scene%bodies%mass(b)*radius**2/2
      scene%bodies%inverse_mass(:, b) = 1/[scene%bodies%mass(b), scene%bodies%mass(b), scene%bodies%inertia(b)]
    end do
  end subroutine make_disks

  !> A cube of about `n` spheres, closest packed (face-centred cubic: twelve neighbours each), flowing towards its centre.
  subroutine make_spheres(scene, n, friction)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n
    real(wp), intent(in) :: friction
    type(random_t) :: random
    real(wp), parameter :: corner(3, 4) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.5_wp, 0.5_wp, 0.0_wp, 0.5_wp, 0.0_wp, 0.5_wp, &
                                                   0.0_wp, 0.5_wp, 0.5_wp], [3, 4])
    real(wp) :: radius, edge, middle(3)
    integer :: side, b, colour, cell, k

    side = max(1, nint((real(n, wp)/4)**(1/3.0_wp)))
    edge = sqrt(2.0_wp)*spacing
    call random%seed(1)
    call begin_lattice(scene, 4*side**3, 3, friction, colour)
    middle = 0.5_wp*edge*real(side, wp)
    do b = 1, 4*side**3
      cell = (b - 1)/4
      k = b - 4*cell
      radius = spacing/2*random%uniform(0.999_wp, 1.001_wp)
      call add_sphere(scene%contactors, b, colour, radius, [0.0_wp, 0.0_wp, 0.0_wp])
      scene%bodies%position(:, b) = edge*(corner(:, k) + real([mod(cell, side), mod(cell/side, side), cell/side**2], wp))
      scene%bodies%velocity(1:3, b) = middle - scene%bodies%position(:, b)
      scene%bodies%mass(b) = density*4*pi/3*radius**3
      scene%bodies%principal(:, b) = 0.4_wp*scene%bodies%mass(b)*radius**2
      scene%bodies%inverse_mass(:, b) = 1/[spread(scene%bodies%mass(b), 1, 3), scene%bodies%principal(:, b)]
    end do
  end subroutine make_spheres

  !> About `n` cubes in bond (fourteen neighbours by four points each), flowing towards their centre.
  subroutine make_bricks(scene, n, friction)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n
    real(wp), intent(in) :: friction
    type(random_t) :: random
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: middle(3), half(3)
    integer :: side, b, colour, k, place(3)

    side = max(2, nint(real(n, wp)**(1/3.0_wp)))
    call random%seed(1)
    call begin_lattice(scene, side**3, 3, friction, colour)
    middle = 0.5_wp*spacing*real(side, wp)
    do b = 1, side**3
      half = [(spacing/2*random%uniform(0.999_wp, 1.001_wp), k=1, 3)]
      call box_polyhedron(half, shape, error)
      if (allocated(error)) return
      call add_polyhedron(scene%contactors, b, colour, shape, [0.0_wp, 0.0_wp, 0.0_wp])
      place = [mod(b - 1, side), mod((b - 1)/side, side), (b - 1)/side**2]
      scene%bodies%position(:, b) = spacing*(real(place, wp) + 0.5_wp*real([mod(place(2), 2) + mod(place(3), 2), mod(place(3), 2), &
                                                                            0], wp))
      scene%bodies%velocity(1:3, b) = middle - scene%bodies%position(:, b)
      call make_solid_body(scene%bodies, scene%contactors, b, b, b, density)
      scene%bodies%inverse_mass(:, b) = 1/[spread(scene%bodies%mass(b), 1, 3), scene%bodies%principal(:, b)]
    end do
  end subroutine make_bricks
end module sg_benchmark_scenes
