!> Centres of grains as points, from which the structure of a packing is measured (doc/theory/indicators.md, "Structure").
module sg_centres
  use sg_comm, only: comm_t
  use sg_grains, only: count_grains, grains_t
  use sg_kinds, only: wp
  use sg_scene, only: periods_of, scene_t
  implicit none
  private
  public :: centres_t, take_centres

  !> Points of this rank, and the box that holds those of all ranks
  type :: centres_t
    !> Dimension of space
    integer :: dimension = 2
    !> Centres [m], shape (3, n); in the plane the third coordinate is zero
    real(wp), allocatable :: point(:, :)
    !> Corners of the box [m]: where the scene is periodic one period
    real(wp) :: low(3) = 0, high(3) = 0
    logical :: is_periodic(3) = .false.
    !> Mean over the grains of all ranks of the diameter of the disk of the same area, in space of the sphere of the same volume [m]
    real(wp) :: diameter = 0
  end type centres_t

contains

  !> Take the centres of all grains that lie in a box. Collective.
  subroutine take_centres(scene, box, comm, centres)
    type(scene_t), intent(in) :: scene !! scene of the step
    real(wp), intent(in) :: box(:) !! least, then largest coordinates [m], shape (2*dimension); empty for all there are
    type(comm_t), intent(inout) :: comm !! the ranks
    type(centres_t), intent(out) :: centres !! their centres
    type(grains_t) :: grains
    integer :: d

    d = scene%dimension
    centres%dimension = d
    centres%is_periodic = periods_of(scene) > 0
    call count_grains(scene%bodies, grains, comm)
    if (grains%n == 0) then
      allocate (centres%point(3, 0))
      return
    end if
    centres%diameter = 2*grains%mean_radius
    call copy_points(scene, centres)
    call find_box(scene, centres, comm)
    if (size(box) == 0) return
    ! A box narrower than the period makes a window of it.
    where (centres%is_periodic(:d)) centres%is_periodic(:d) = box(:d) <= 0 .and. box(d + 1:) >= centres%high(:d)
    where (.not. centres%is_periodic(:d))
      centres%low(:d) = box(:d)
      centres%high(:d) = box(d + 1:)
    end where
    call keep_within(centres)
  end subroutine take_centres

  !> Copy the centres of this rank's grains, within the period.
  subroutine copy_points(scene, centres)
    type(scene_t), intent(in) :: scene
    type(centres_t), intent(inout) :: centres
    integer :: i, n

    associate (bodies => scene%bodies)
      allocate (centres%point(3, count(bodies%is_grain(:bodies%n_own))), source=0.0_wp)
      n = 0
      do i = 1, bodies%n_own
        if (.not. bodies%is_grain(i)) cycle
        n = n + 1
        centres%point(:bodies%dimension, n) = bodies%position(:, i)
      end do
    end associate
    if (centres%is_periodic(1)) centres%point(1, :) = modulo(centres%point(1, :), scene%period)
    if (centres%is_periodic(2)) centres%point(2, :) = modulo(centres%point(2, :), scene%period_y)
    if (centres%is_periodic(3)) centres%point(3, :) = modulo(centres%point(3, :), scene%period_z)
  end subroutine copy_points

  !> The box about the points of all ranks.
  subroutine find_box(scene, centres, comm)
    type(scene_t), intent(in) :: scene
    type(centres_t), intent(inout) :: centres
    type(comm_t), intent(inout) :: comm

    centres%low = minval(centres%point, 2)
    centres%high = maxval(centres%point, 2)
    call comm%minimum(centres%low)
    call comm%maximum(centres%high)
    where (centres%is_periodic)
      centres%low = 0
      centres%high = periods_of(scene)
    end where
  end subroutine find_box

  !> Leave out the points outside the box.
  subroutine keep_within(centres)
    type(centres_t), intent(inout) :: centres
    real(wp), allocatable :: kept(:, :)
    logical :: is_in(size(centres%point, 2))
    integer :: i

    is_in = [(all(centres%point(:centres%dimension, i) >= centres%low(:centres%dimension) .and. &
                  centres%point(:centres%dimension, i) <= centres%high(:centres%dimension)), i=1, size(is_in))]
    allocate (kept(3, count(is_in)))
    kept = reshape(pack(centres%point, spread(is_in, 1, 3)), shape(kept))
    call move_alloc(kept, centres%point)
  end subroutine keep_within
end module sg_centres
