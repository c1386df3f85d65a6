!> Centres of grains as points, from which the structure of a packing is measured (doc/theory/indicators.md, "Structure").
module sg_centres
  use sg_comm, only: comm_t
  use sg_grains, only: count_grains, grains_t
  use sg_kinds, only: wp
  use sg_scene, only: periods_of, scene_t
  implicit none
  private
  public :: centres_t, take_centres, upright

  !> Points of this rank, and the box that holds those of all ranks
  type :: centres_t
    !> Dimension of space
    integer :: dimension = 2
    !> Centres [m], shape (3, n); in the plane the third coordinate is zero
    real(wp), allocatable :: point(:, :)
    !> Corners of the box [m]: where the scene is periodic one period
    real(wp) :: low(3) = 0, high(3) = 0
    logical :: is_periodic(3) = .false.
    !> Way along x by which a period along y moves an image, in a sheared periodic cell [m]
    real(wp) :: tilt = 0
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
    ! Images along y of a sheared cell are beside the window.
    if (abs(centres%tilt) > 0) centres%is_periodic(2) = all(centres%is_periodic(:2))
    if (.not. centres%is_periodic(2)) centres%tilt = 0
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
    real(wp) :: period(3)
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
    period = present_periods(scene)
    if (scene%cell%is_on) then
      centres%tilt = scene%cell%now(4)
      centres%point(1, :) = centres%point(1, :) - centres%tilt*real(floor(centres%point(2, :)/period(2)), wp)
    end if
    do i = 1, 3
      if (centres%is_periodic(i)) centres%point(i, :) = modulo(centres%point(i, :), period(i))
    end do
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
      centres%high = present_periods(scene)
    end where
  end subroutine find_box

  !> Periods of the scene where bodies are now [m].
  pure function present_periods(scene) result(period)
    type(scene_t), intent(in) :: scene
    real(wp) :: period(3)

    period = periods_of(scene)
    if (scene%cell%is_on) period(:scene%dimension) = scene%cell%now(:scene%dimension)
  end function present_periods

  !> Points sheared back by the tilt [m], in the box: what stands upright is a box.
  pure function upright(centres, point) result(places)
    type(centres_t), intent(in) :: centres !! the grains of a rank
    real(wp), intent(in) :: point(:, :) !! their centres, or those of another rank [m], shape (3, n)
    real(wp) :: places(3, size(point, 2))

    places = point
    if (.not. abs(centres%tilt) > 0) return
    associate (length => centres%high - centres%low)
      places(1, :) = modulo(point(1, :) - centres%tilt/length(2)*(point(2, :) - centres%low(2)), length(1))
    end associate
  end function upright

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
