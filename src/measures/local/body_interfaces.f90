!> Interfaces: resultants of the contacts between pairs of bodies, one row per pair and recorded step (doc/guide/interfaces.md).
!!
!! With the forces f_k of a pair at its points x_k, normal parts N_k along the normals n_k, the mean normal n lies along the sum of
!! |N_k| n_k, F = sum f_k, N = F.n, the centre of pressure c = sum N_k x_k / sum N_k. About the middle m of the joint
!! (sg_facing_faces) the moment is M = sum (x_k - m) x f_k and the eccentricity e = (c - m).t in the plane, |c - m| in space. Each
!! rank sums its contacts by pairs; the sums of all ranks are put together. No value outlives the step, so that a restart needs none
!! of them.
module sg_body_interfaces
  use sg_bodies, only: bodies_t
  use sg_comm, only: comm_t
  use sg_contactors, only: kind_point
  use sg_contacts, only: contacts_t, image_of, impulse_vector, normal_impulse
  use sg_facing_faces, only: find_joint
  use sg_interface_options, only: interface_options_t
  use sg_kinds, only: wp, i4, i8
  use sg_scene, only: image_shift, scene_t
  use sg_sorting, only: sort_permutation
  use sg_vectors, only: cross
  implicit none
  private
  public :: interfaces_t, interface_columns

  !> Sums of a pair: its two bodies, sums of |N|, N and points, of N x, x, |N| n, f and x times f, area, area times middle
  integer, parameter :: n_sums = 24, at_size = 3, at_normal = 4, at_points = 5, at_moment_of_pressure = 6, at_place = 9, &
                        at_direction = 12, at_force = 15, at_torque = 18, at_area = 21, at_middle = 22
  !> Share of the sizes of normal forces below which their sum is rounding, so that it has no centre of pressure
  real(wp), parameter :: no_pressure = 1e-9_wp

  !> The interfaces of a run; unallocated options where there are none
  type :: interfaces_t
    !> What the deck asks for
    type(interface_options_t), allocatable :: options
    !> Bodies of each row of the last step by their numbers in the whole scene, shape (2, rows), the same on all ranks
    integer(i4), allocatable :: body(:, :)
    !> Their columns, shape (columns, rows)
    real(wp), allocatable :: value(:, :)
  contains
    procedure :: is_on => interfaces_is_on
    procedure :: measure => interfaces_measure
  end type interfaces_t

contains

  !> Names of the columns that follow step, time, first and second in interfaces.csv; the last one is a count.
  pure function interface_columns(dimension) result(names)
    integer, intent(in) :: dimension !! of space
    character(len=16), allocatable :: names(:)

    if (dimension == 2) then
      names = [character(len=16) :: 'x', 'y', 'middle_x', 'middle_y', 'normal_x', 'normal_y', 'force_x', 'force_y', &
               'normal_force', 'tangential_force', 'moment', 'eccentricity', 'area', 'contacts']
    else
      names = [character(len=16) :: 'x', 'y', 'z', 'middle_x', 'middle_y', 'middle_z', 'normal_x', 'normal_y', 'normal_z', &
               'force_x', 'force_y', 'force_z', 'normal_force', 'tangential_force', 'moment_x', 'moment_y', 'moment_z', &
               'eccentricity', 'area', 'contacts']
    end if
  end function interface_columns

  !> Are there any interfaces to measure?
  pure logical function interfaces_is_on(self)
    class(interfaces_t), intent(in) :: self

    interfaces_is_on = allocated(self%options)
  end function interfaces_is_on

  !> Measure all pairs that press or pull, in the order of their numbers. Collective: all ranks get the same rows.
  subroutine interfaces_measure(self, scene, contacts, h, comm)
    class(interfaces_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: sums(:, :)
    integer :: i

    call sum_pairs(self%options, scene, contacts, sums)
    if (comm%size > 1) call join_ranks(comm, sums)
    if (allocated(self%value)) deallocate (self%value, self%body)
    allocate (self%value(size(interface_columns(scene%dimension)), size(sums, 2)), self%body(2, size(sums, 2)))
    do i = 1, size(sums, 2)
      self%body(:, i) = nint(sums(1:2, i), i4)
      self%value(:, i) = columns_of(sums(:, i), scene%dimension, h)
    end do
  end subroutine interfaces_measure

  !> This rank's sums of all pairs whose contacts carry an impulse, in the order of their bodies, shape (n_sums, pairs).
  pure subroutine sum_pairs(options, scene, contacts, sums)
    type(interface_options_t), intent(in) :: options
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), allocatable, intent(out) :: sums(:, :)
    integer(i4) :: number(2, contacts%n), found(contacts%n), side(contacts%n)
    integer(i4), allocatable :: order(:)
    integer :: k, n, pairs, begin

    n = 0
    do k = 1, contacts%n
      if (.not. any(abs(contacts%impulse(:, k)) > 0)) cycle
      associate (contactor => contacts%contactor(:, k))
        if (scene%contactors%kind(contactor(1)) == kind_point) cycle
        number(:, n + 1) = numbers_of(scene%bodies, contacts%body(:, k))
        side(n + 1) = int(options%first_side(number(:, n + 1), scene%contactors%colour(contactor)), i4)
      end associate
      if (side(n + 1) == 0) cycle
      n = n + 1
      found(n) = int(k, i4)
      if (side(n) == 2) number(:, n) = number([2, 1], n)
    end do
    order = order_of(number(:, :n))
    allocate (sums(n_sums, n), source=0.0_wp)
    pairs = 0
    begin = 1
    do k = 1, n
      if (k > 1) then
        if (any(number(:, order(k)) /= number(:, order(k - 1)))) begin = k
      end if
      if (begin == k) pairs = pairs + 1
      sums(1:2, pairs) = real(number(:, order(k)), wp)
      call add_contact(scene, contacts, found(order(k)), side(order(k)), found(order(begin:k - 1)), sums(:, pairs))
    end do
    sums = sums(:, :pairs)
  end subroutine sum_pairs

  !> Numbers of two bodies in the whole scene.
  pure function numbers_of(bodies, body) result(number)
    type(bodies_t), intent(in) :: bodies
    integer(i4), intent(in) :: body(2)
    integer(i4) :: number(2)

    number = body
    if (allocated(bodies%id)) number = bodies%id(body)
  end function numbers_of

  !> Order of pairs of numbers, by the first, then by the second; equal ones keep theirs.
  pure function order_of(number) result(order)
    integer(i4), intent(in) :: number(:, :)
    integer(i4), allocatable :: order(:), first(:)

    order = sort_permutation(int(number(2, :), i8))
    first = sort_permutation(int(number(1, order), i8))
    order = order(first)
  end function order_of

  !> Add a contact to the sums of its pair; with the first one of two shapes comes their joint.
  pure subroutine add_contact(scene, contacts, k, side, before, sums)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: k, side, before(:)
    real(wp), intent(inout) :: sums(:)
    real(wp) :: impulse(3), point(3), normal(3), shift(3), pressing, middle(3), area
    integer :: i, d

    d = scene%dimension
    point = 0
    normal = 0
    point(:d) = contacts%point(:d, k)
    normal(:d) = contacts%normal(:d, k)
    pressing = normal_impulse(contacts, int(k))
    impulse = merge(1.0_wp, -1.0_wp, side == 1)*impulse_vector(contacts, int(k))
    call add(sums, at_size, [abs(pressing)])
    call add(sums, at_normal, [pressing])
    call add(sums, at_points, [1.0_wp])
    call add(sums, at_moment_of_pressure, pressing*point)
    call add(sums, at_place, point)
    call add(sums, at_direction, merge(1.0_wp, -1.0_wp, side == 1)*abs(pressing)*normal)
    call add(sums, at_force, impulse)
    call add(sums, at_torque, cross(point, impulse))
    do i = 1, size(before)
      if (all(contacts%contactor(:, before(i)) == contacts%contactor(:, k))) return
    end do
    shift = image_shift(scene, image_of(contacts, int(k)))
    call find_joint(scene%contactors, int(contacts%contactor(:, k)), normal, point, shift, area, middle)
    call add(sums, at_area, [area])
    call add(sums, at_middle, area*middle)
  end subroutine add_contact

  !> Add values to the sums from a place on.
  pure subroutine add(sums, at, values)
    real(wp), intent(inout) :: sums(:)
    integer, intent(in) :: at
    real(wp), intent(in) :: values(:)

    sums(at:at + size(values) - 1) = sums(at:at + size(values) - 1) + values
  end subroutine add

  !> Put the sums of all ranks together, those of one pair added in the order of the ranks. Collective.
  subroutine join_ranks(comm, sums)
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable, intent(inout) :: sums(:, :)
    real(wp), allocatable :: own(:), gathered(:, :), rows(:, :)
    integer(i4), allocatable :: order(:)
    integer :: most, i, n

    most = size(sums, 2)
    call comm%maximum(most)
    allocate (own(n_sums*most), source=0.0_wp)
    own(:size(sums)) = reshape(sums, [size(sums)])
    call comm%gather(own, gathered)
    rows = reshape(gathered, [n_sums, most*comm%size])
    ! Rows that fill up a rank's list have no body.
    order = pack([(int(i, i4), i=1, size(rows, 2))], rows(1, :) > 0.5_wp)
    rows = rows(:, order)
    order = order_of(nint(rows(1:2, :), i4))
    deallocate (sums)
    allocate (sums(n_sums, size(rows, 2)), source=0.0_wp)
    n = 0
    do i = 1, size(rows, 2)
      associate (row => rows(:, order(i)))
        if (n > 0) then
          if (all(nint(sums(1:2, n)) == nint(row(1:2)))) then
            sums(3:, n) = sums(3:, n) + row(3:)
            cycle
          end if
        end if
        n = n + 1
        sums(:, n) = row
      end associate
    end do
    sums = sums(:, :n)
  end subroutine join_ranks

  !> Columns of a pair from the sums of all ranks.
  pure function columns_of(sums, dimension, h) result(values)
    real(wp), intent(in) :: sums(:), h
    integer, intent(in) :: dimension
    real(wp), allocatable :: values(:)
    real(wp) :: force(3), normal(3), middle(3), centre(3), moment(3), tangent(3)

    force = sums(at_force:at_force + 2)/h
    normal = unit(sums(at_direction:at_direction + 2), force)
    middle = sums(at_place:at_place + 2)/sums(at_points)
    if (sums(at_area) > 0) middle = sums(at_middle:at_middle + 2)/sums(at_area)
    centre = middle
    if (abs(sums(at_normal)) > no_pressure*sums(at_size)) &
      centre = sums(at_moment_of_pressure:at_moment_of_pressure + 2)/sums(at_normal)
    if (.not. sums(at_area) > 0) middle = centre
    moment = sums(at_torque:at_torque + 2)/h - cross(middle, force)
    if (dimension == 2) then
      tangent = [normal(2), -normal(1), 0.0_wp]
      values = [centre(1:2), middle(1:2), normal(1:2), force(1:2), dot_product(force, normal), dot_product(force, tangent), &
                moment(3), dot_product(centre - middle, tangent), sums(at_area), sums(at_points)]
    else
      values = [centre, middle, normal, force, dot_product(force, normal), norm2(force - dot_product(force, normal)*normal), &
                moment, norm2(centre - middle), sums(at_area), sums(at_points)]
    end if
  end function columns_of

  !> Direction of a vector, or of a second one where the first has none.
  pure function unit(vector, other) result(direction)
    real(wp), intent(in) :: vector(3), other(3)
    real(wp) :: direction(3)

    direction = 0
    if (norm2(vector) > 0) then
      direction = vector/norm2(vector)
    else if (norm2(other) > 0) then
      direction = other/norm2(other)
    end if
  end function unit
end module sg_body_interfaces
