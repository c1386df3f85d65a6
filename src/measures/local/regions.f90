!> Regions: the indicators of a run in boxes that the deck gives, one row per region and recorded step (doc/guide/regions.md).
!!
!! A grain belongs to a region by its centre at the end of the step, a contact by its point; shapes are cut by the box. Each rank
!! has its share of the sums. No value outlives the step, so that a restart needs none of them.
module sg_regions
  use sg_bodies, only: is_absent
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_coordination, only: neighbours_of, touching_pairs, touching_t
  use sg_inertia_number, only: field_sums, n_field_sums, rate_of_sums
  use sg_kinds, only: wp, pi
  use sg_overlap_polyhedra, only: overlap_room_t
  use sg_owner_sums, only: add_grains_at_owner
  use sg_region_options, only: region_options_t
  use sg_scene, only: image_shift, periods_of, scene_t
  use sg_share_in_box, only: share_in_box
  use sg_stress, only: stress_sums
  use sg_subdomain, only: subdomain_t
  use sg_tally, only: ratio
  use sg_volume_error, only: overlap_of
  implicit none
  private
  public :: regions_t, region_columns, n_region_counts

  !> Sums of a region before those of stress and velocity field: grains, mass, volume, radii and speeds of grains, their neighbours,
  !! pairs by one to four points, overlap, and volumes of grains and of other bodies within the box
  integer, parameter :: n_plain_sums = 13

  !> The regions of a run; unallocated options where there are none
  type :: regions_t
    !> What the deck asks for
    type(region_options_t), allocatable :: options(:)
    !> Columns of the last row, shape (columns, regions), the same on all ranks
    real(wp), allocatable :: value(:, :)
  contains
    procedure :: is_on => regions_is_on
    procedure :: measure => regions_measure
  end type regions_t

contains

  !> Names of the columns that follow step, time and region in regions.csv. The first ones are counts (`n_region_counts`).
  pure function region_columns(dimension) result(names)
    integer, intent(in) :: dimension !! of space
    character(len=18), allocatable :: names(:)

    names = [character(len=18) :: 'grains', 'single_contacts', 'double_contacts', 'triple_contacts']
    if (dimension == 3) names = [character(len=18) :: names, 'quadruple_contacts']
    names = [character(len=18) :: names, 'volume_error', 'compactness', 'coordination', 'mean_velocity', 'max_velocity', &
             'shear_rate', 'pressure', 'inertia_number']
  end function region_columns

  !> Columns that hold whole numbers: grains, and pairs by points.
  pure integer function n_region_counts(dimension) result(n)
    integer, intent(in) :: dimension !! of space

    n = dimension + 2
  end function n_region_counts

  !> Are there any regions?
  pure logical function regions_is_on(self)
    class(regions_t), intent(in) :: self

    regions_is_on = allocated(self%options)
  end function regions_is_on

  !> Measure all regions after the update of a step. Collective: all ranks get the same values.
  subroutine regions_measure(self, scene, contacts, h, subdomain, comm)
    class(regions_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(subdomain_t), intent(in) :: subdomain !! which ranks hold which bodies
    type(comm_t), intent(inout) :: comm !! the ranks
    type(touching_t) :: touching
    real(wp) :: neighbours(1, scene%bodies%n), fastest(size(self%options))
    real(wp), allocatable :: sums(:)
    integer :: i, n

    touching = touching_pairs(contacts, scene%bodies%n)
    neighbours(1, :) = neighbours_of(touching, scene%bodies%n)
    if (comm%size > 1) call add_grains_at_owner(subdomain, comm, neighbours)
    n = n_plain_sums + scene%dimension**2 + n_field_sums(scene%dimension)
    allocate (sums(n*size(self%options)))
    do i = 1, size(self%options)
      call sum_region(self%options(i), scene, contacts, touching, neighbours(1, :), sums((i - 1)*n + 1:i*n), fastest(i))
    end do
    if (comm%size > 1) then
      call comm%sum(sums)
      call comm%maximum(fastest)
    end if
    if (.not. allocated(self%value)) &
      allocate (self%value(size(region_columns(scene%dimension)), size(self%options)))
    do i = 1, size(self%options)
      self%value(:, i) = columns_of(self%options(i), scene%dimension, h, sums((i - 1)*n + 1:i*n), fastest(i))
    end do
  end subroutine regions_measure

  !> This rank's sums of a region, and the largest speed of its grains there.
  pure subroutine sum_region(region, scene, contacts, touching, neighbours, sums, fastest)
    type(region_options_t), intent(in) :: region
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    type(touching_t), intent(in) :: touching
    real(wp), intent(in) :: neighbours(:)
    real(wp), intent(out) :: sums(:), fastest
    logical :: is_in(scene%bodies%n)
    logical, allocatable :: is_point(:)
    integer :: b, d

    d = scene%dimension
    do b = 1, scene%bodies%n
      is_in(b) = scene%bodies%is_grain(b)
      if (is_in(b)) is_in(b) = holds(region, scene, scene%bodies%position(:, b))
    end do
    allocate (is_point(contacts%n))
    do b = 1, contacts%n
      is_point(b) = holds(region, scene, contacts%point(:d, b))
    end do
    sums = 0
    call sum_grains(scene, is_in, neighbours, sums(1:6), fastest)
    call sum_pairs(touching, is_in, sums(7:10))
    sums(11) = overlap_of(scene, contacts, is_point)
    call sum_volumes(region, scene, sums(12:13))
    sums(n_plain_sums + 1:n_plain_sums + d**2) = reshape(stress_sums(scene, contacts, is_point), [d**2])
    sums(n_plain_sums + d**2 + 1:) = field_sums(scene%bodies, (region%lower(:d) + region%upper(:d))/2, is_in)
  end subroutine sum_region

  !> Is a place, or a periodic image of it, in a region?
  pure logical function holds(region, scene, place)
    type(region_options_t), intent(in) :: region
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: place(:)
    real(wp) :: image(3)
    integer :: i, j, k, images(3), d

    d = size(place)
    images = merge(1, 0, periods_of(scene) > 0)
    holds = .false.
    do k = -images(3), images(3)
      do j = -images(2), images(2)
        do i = -images(1), images(1)
          image = image_shift(scene, [i, j, k])
          image(:d) = image(:d) + place
          holds = holds .or. all(image(:d) >= region%lower(:d) .and. image(:d) < region%upper(:d))
        end do
      end do
    end do
  end function holds

  !> Number, mass, volume, radii and speeds of the grains in a region, and their neighbours.
  pure subroutine sum_grains(scene, is_in, neighbours, sums, fastest)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: is_in(:)
    real(wp), intent(in) :: neighbours(:)
    real(wp), intent(out) :: sums(6), fastest
    real(wp) :: speed, radius
    integer :: b

    sums = 0
    fastest = 0
    associate (bodies => scene%bodies)
      do b = 1, bodies%n_own
        if (.not. is_in(b)) cycle
        speed = norm2(bodies%velocity(:bodies%dimension, b))
        if (bodies%dimension == 2) then
          radius = sqrt(bodies%area(b)/pi)
        else
          radius = (3*bodies%area(b)/(4*pi))**(1/3.0_wp)
        end if
        sums = sums + [1.0_wp, bodies%mass(b), bodies%area(b), radius, speed, neighbours(b)]
        fastest = max(fastest, speed)
      end do
    end associate
  end subroutine sum_grains

  !> Pairs that touch and have a grain in the region, by their points: one, two, three, four or more.
  pure subroutine sum_pairs(touching, is_in, sums)
    type(touching_t), intent(in) :: touching
    logical, intent(in) :: is_in(:)
    real(wp), intent(out) :: sums(4)
    integer :: i, points

    sums = 0
    do i = 1, size(touching%points)
      if (.not. any(is_in(touching%body(:, i)))) cycle
      points = min(4, touching%points(i))
      sums(points) = sums(points) + 1
    end do
  end subroutine sum_pairs

  !> Volumes within the box of the grains, and of all other solid bodies.
  pure subroutine sum_volumes(region, scene, sums)
    type(region_options_t), intent(in) :: region
    type(scene_t), intent(in) :: scene
    real(wp), intent(out) :: sums(2)
    type(overlap_room_t) :: room
    real(wp) :: share, shift(3)
    integer :: c, b, i, j, k, images(3), d

    d = scene%dimension
    images = merge(1, 0, periods_of(scene) > 0)
    sums = 0
    do c = 1, scene%contactors%n
      b = scene%contactors%body(c)
      if (b > scene%bodies%n_own) cycle
      if (is_absent(scene%bodies, b)) cycle
      do k = -images(3), images(3)
        do j = -images(2), images(2)
          do i = -images(1), images(1)
            shift = image_shift(scene, [i, j, k])
            call share_in_box(scene%contactors, c, region%lower(:d) - shift(:d), region%upper(:d) - shift(:d), room, share)
            if (scene%bodies%is_grain(b)) then
              sums(1) = sums(1) + share
            else
              sums(2) = sums(2) + share
            end if
          end do
        end do
      end do
    end do
  end subroutine sum_volumes

  !> Columns of a region from the sums of all ranks.
  pure function columns_of(region, d, h, sums, fastest) result(values)
    type(region_options_t), intent(in) :: region
    integer, intent(in) :: d
    real(wp), intent(in) :: h, sums(:), fastest
    real(wp), allocatable :: values(:)
    real(wp) :: space, rate, pressure, stress(d, d), mass, pairs(d)
    integer :: a

    space = product(region%upper(:d) - region%lower(:d)) - sums(13)
    stress = reshape(sums(n_plain_sums + 1:n_plain_sums + d**2), [d, d])
    pressure = ratio(sum([(stress(a, a), a=1, d)])/real(d, wp), space*h)
    rate = rate_of_sums(sums(n_plain_sums + d**2 + 1:), d)
    if (d == 2) then
      pairs = [sums(7), sums(8)]
      mass = ratio(sums(2), sums(1))
    else
      pairs = sums(7:9)
      mass = ratio(sums(2), sums(3))*(2*ratio(sums(4), sums(1)))**2
    end if
    values = [sums(1), pairs, sum(sums(7 + d:10)), ratio(sums(11), sums(12)), ratio(sums(12), space), ratio(sums(6), sums(1)), &
              ratio(sums(5), sums(1)), fastest, rate, pressure, rate*sqrt(ratio(mass, pressure))]
  end function columns_of
end module sg_regions
