!> Coarse graining [Goldhirsch2010]: density, velocity, stress and fabric on the cells of a grid (doc/guide/fields.md).
!!
!! Each grain and each contact is spread over the cells about it by a kernel, a product of weights along the axes. Weights are
!! scaled so that they add up to 1 over a grid without end: mass, momentum and the sum of force times branch are those of the cells
!! together, to rounding, as far as the kernel stays within the box. Each rank has its share of the sums, of its own bodies and
!! its contacts.
module sg_fields_on_grid
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, impulse_vector, normal_impulse
  use sg_field_options, only: field_options_t, kernel_box
  use sg_kinds, only: wp
  use sg_scene, only: image_shift, periods_of, scene_t
  use sg_stress, only: branch_of
  implicit none
  private
  public :: grid_field_t, n_sums, pack_fields, unpack_fields

  !> Sums of a cell: mass, momentum (3), volume of grains; force times branch (9), contacts, normal times normal (6)
  integer, parameter :: n_of_grains = 5, n_of_contacts = 16, n_sums = n_of_grains + n_of_contacts
  !> Standard deviations at which a Gaussian kernel ends
  real(wp), parameter :: reach = 3

  !> A field of a run
  type :: grid_field_t
    !> What the deck asks for, and sides of a cell [m]
    type(field_options_t) :: options
    real(wp) :: side(3) = 1
    !> Samples since the last grid, and their sums, shape (n_sums, cells); x runs first
    integer :: samples = 0
    real(wp), allocatable :: sum(:, :)
  contains
    procedure :: begin => field_begin
    procedure :: is_due => field_is_due
    procedure :: wants_sample => field_wants_sample
    procedure :: add_sample => field_add_sample
    procedure :: finish => field_finish
    procedure :: n_cells => field_n_cells
  end type grid_field_t

  !> Cells that a kernel reaches along one axis, and their weights
  type :: weights_t
    integer :: first = 1, last = 0
    real(wp), allocatable :: weight(:)
  end type weights_t

contains

  !> Begin a field.
  pure subroutine field_begin(self, options)
    class(grid_field_t), intent(inout) :: self
    type(field_options_t), intent(in) :: options !! what the deck asks for

    self%options = options
    self%side = (options%upper - options%lower)/real(options%cells, wp)
    allocate (self%sum(n_sums, product(options%cells)), source=0.0_wp)
  end subroutine field_begin

  !> Number of cells.
  pure integer function field_n_cells(self)
    class(grid_field_t), intent(in) :: self

    field_n_cells = product(self%options%cells)
  end function field_n_cells

  !> Is a grid due after a step?
  pure logical function field_is_due(self, step)
    class(grid_field_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step

    field_is_due = mod(step, self%options%every) == 0
  end function field_is_due

  !> Is a sample due after a step?
  pure logical function field_wants_sample(self, step)
    class(grid_field_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step

    field_wants_sample = self%is_due(step)
    if (self%options%sample_every > 0) field_wants_sample = field_wants_sample .or. mod(step, self%options%sample_every) == 0
  end function field_wants_sample

  !> Add a sample after a step: places and velocities of its end, contacts with their mean force over it.
  subroutine field_add_sample(self, scene, contacts, h)
    class(grid_field_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp) :: values(n_sums), place(3), force(3), branch(3), n(3)
    integer :: b, k, a

    self%samples = self%samples + 1
    associate (bodies => scene%bodies, d => scene%dimension)
      do b = 1, bodies%n_own
        if (.not. bodies%is_grain(b)) cycle
        values = 0
        values(1) = bodies%mass(b)
        values(2:1 + d) = bodies%mass(b)*bodies%velocity(:d, b)
        values(5) = bodies%area(b)
        place = 0
        place(:d) = bodies%position(:, b)
        call spread_images(self, scene, place, 1, n_of_grains, values(:n_of_grains))
      end do
      do k = 1, contacts%n
        force = impulse_vector(contacts, k)/h
        if (.not. any(abs(force) > 0)) cycle
        branch = branch_of(scene, contacts, k)
        if (.not. any(abs(branch) > 0)) cycle
        do a = 1, 3
          values(3*a - 2:3*a) = force(a)*branch
        end do
        values(10:16) = 0
        if (normal_impulse(contacts, k) > 0 .and. bodies%is_grain(contacts%body(1, k)) .and. &
            bodies%is_grain(contacts%body(2, k))) then
          n = 0
          n(:d) = contacts%normal(1:d, k)
          values(10:16) = [1.0_wp, n(1)*n, n(2)*n(2:3), n(3)*n(3)]
        end if
        place = 0
        place(:d) = contacts%point(1:d, k)
        call spread_images(self, scene, place, n_of_grains + 1, n_sums, values(:n_of_contacts))
      end do
    end associate
  end subroutine field_add_sample

  !> Spread values over the cells about a place, and about its images in a periodic scene.
  subroutine spread_images(self, scene, place, first, last, values)
    class(grid_field_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: place(3), values(:)
    integer, intent(in) :: first, last
    real(wp) :: image(3)
    integer :: i, j, k, images(3)

    images = merge(1, 0, periods_of(scene) > 0)
    do k = -images(3), images(3)
      do j = -images(2), images(2)
        do i = -images(1), images(1)
          image = place + image_shift(scene, [i, j, k])
          call spread_values(self, scene%dimension, image, first, last, values)
        end do
      end do
    end do
  end subroutine spread_images

  !> Spread values over the cells about one place.
  subroutine spread_values(self, dimension, place, first, last, values)
    class(grid_field_t), intent(inout) :: self
    integer, intent(in) :: dimension, first, last
    real(wp), intent(in) :: place(3), values(:)
    type(weights_t) :: along(3)
    real(wp) :: weight
    integer :: i, j, k, row, a

    do a = 1, dimension
      along(a) = weights_of(self, a, place(a))
      if (along(a)%first > along(a)%last) return
    end do
    if (dimension == 2) then
      along(3)%first = 1
      along(3)%last = 1
      along(3)%weight = [1.0_wp]
    end if
    associate (x => along(1), y => along(2), z => along(3), cells => self%options%cells)
      do k = z%first, z%last
        do j = y%first, y%last
          weight = z%weight(k - z%first + 1)*y%weight(j - y%first + 1)
          row = ((k - 1)*cells(2) + j - 1)*cells(1)
          do i = x%first, x%last
            self%sum(first:last, row + i) = self%sum(first:last, row + i) + weight*x%weight(i - x%first + 1)*values
          end do
        end do
      end do
    end associate
  end subroutine spread_values

  !> Cells of the box along an axis that the kernel about a coordinate reaches, with weights that add up to 1 over all cells, those
  !! beyond the box included.
  pure function weights_of(self, axis, x) result(weights)
    class(grid_field_t), intent(in) :: self
    integer, intent(in) :: axis
    real(wp), intent(in) :: x
    type(weights_t) :: weights
    real(wp), allocatable :: all(:)
    real(wp) :: place, half, least
    integer :: first, last, i

    ! In units of a cell: cell i reaches from i - 1 to i.
    place = (x - self%options%lower(axis))/self%side(axis)
    half = self%options%width/self%side(axis)
    if (self%options%kernel /= kernel_box) half = reach*half
    if (place + half < -1 .or. place - half > real(self%options%cells(axis) + 1, wp)) return
    if (self%options%kernel == kernel_box) then
      first = floor(place - half) + 1
      last = ceiling(place + half)
      all = [(max(0.0_wp, min(real(i, wp), place + half) - max(real(i - 1, wp), place - half)), i=first, last)]
    else
      ! Cells whose centres are within reach, the nearest one at least.
      first = min(ceiling(place - half + 0.5_wp), floor(place) + 1)
      last = max(floor(place + half + 0.5_wp), floor(place) + 1)
      least = abs(real(floor(place), wp) + 0.5_wp - place)
      all = [(exp(-(reach/half)**2*((real(i, wp) - 0.5_wp - place)**2 - least**2)/2), i=first, last)]
    end if
    all = all/sum(all)
    weights%first = max(1, first)
    weights%last = min(self%options%cells(axis), last)
    if (weights%first <= weights%last) weights%weight = all(weights%first - first + 1:weights%last - first + 1)
  end function weights_of

  !> Means over the samples per volume, the same on all ranks; the samples begin again. Collective.
  subroutine field_finish(self, comm, values)
    class(grid_field_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable, intent(out) :: values(:, :) !! sums per sample and volume of a cell, shape (n_sums, cells)
    real(wp), allocatable :: flat(:)

    flat = reshape(self%sum, [size(self%sum)])
    if (comm%size > 1) call comm%sum(flat)
    values = reshape(flat/(real(max(1, self%samples), wp)*product(self%side)), shape(self%sum))
    self%sum = 0
    self%samples = 0
  end subroutine field_finish

  !> Samples of fields since their last grids as a list of reals, for restart files; empty where there are none. Collective.
  subroutine pack_fields(fields, comm, values)
    type(grid_field_t), allocatable, intent(in) :: fields(:) !! fields of the run
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable, intent(out) :: values(:) !! of all ranks
    real(wp), allocatable :: sums(:)
    integer :: i

    allocate (values(0))
    if (.not. allocated(fields)) return
    if (all(fields%samples == 0)) return
    do i = 1, size(fields)
      sums = reshape(fields(i)%sum, [size(fields(i)%sum)])
      if (comm%size > 1) call comm%sum(sums)
      values = [values, real(fields(i)%samples, wp), sums]
    end do
  end subroutine pack_fields

  !> What `pack_fields` gave, on the first rank; where the grids are others, samples begin again.
  pure subroutine unpack_fields(fields, values, comm)
    type(grid_field_t), allocatable, intent(inout) :: fields(:) !! fields of the run
    real(wp), intent(in) :: values(:) !! of a restart file
    type(comm_t), intent(in) :: comm !! the ranks
    integer :: i, first

    if (.not. allocated(fields)) return
    if (size(values) /= sum([(size(fields(i)%sum) + 1, i=1, size(fields))])) return
    first = 1
    do i = 1, size(fields)
      fields(i)%samples = nint(values(first))
      if (comm%rank == 0) fields(i)%sum = reshape(values(first + 1:first + size(fields(i)%sum)), shape(fields(i)%sum))
      first = first + 1 + size(fields(i)%sum)
    end do
  end subroutine unpack_fields
end module sg_fields_on_grid
