!> Rank bounds: boxes about groups of a rank's grains, by which other ranks find which of their own grains come near.
module sg_rank_bounds
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_scene, only: periods_of, scene_t
  use sg_sorting, only: hilbert_order
  implicit none
  private
  public :: rank_bounds_t, body_reach

  !> Most boxes that a rank sends to its neighbours
  integer, parameter :: most_boxes = 128

  !> Boxes of this rank, and of the ranks that may come near
  type :: rank_bounds_t
    !> Boxes of rank r are `box(:, first(r):first(r + 1) - 1)`, ranks from 0: low corner, high corner [m], shape (6, boxes)
    integer, allocatable :: first(:)
    real(wp), allocatable :: box(:, :)
    !> The box about all grains of each rank, shape (6, 0:ranks-1)
    real(wp), allocatable :: outline(:, :)
    !> Periods along x, y, z [m], 0 where there is none
    real(wp) :: period(3) = 0
    !> Way along x by which a period along y moves an image, in a periodic cell that is sheared [m]
    real(wp) :: tilt = 0
  contains
    procedure :: survey => rank_bounds_survey
    procedure :: is_near => rank_bounds_is_near
  end type rank_bounds_t

contains

  !> Radius about the centre of mass that holds a body's shapes, for bodies 1 to n [m].
  pure function body_reach(scene, n) result(reach)
    type(scene_t), intent(in) :: scene !! scene of the bodies
    integer, intent(in) :: n !! number of bodies
    real(wp) :: reach(n)
    integer :: c, b

    reach = 0
    do c = 1, scene%contactors%n
      b = scene%contactors%body(c)
      if (b > n) cycle
      reach(b) = max(reach(b), norm2(scene%contactors%shift(:, c)) + scene%contactors%reach(c))
    end do
  end function body_reach

  !> Draw boxes about all grains of this rank, and receive those of ranks that may come near. Collective.
  subroutine rank_bounds_survey(self, scene, reach, margin, comm)
    class(rank_bounds_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! this rank's part
    real(wp), intent(in) :: reach(:) !! of its own bodies [m]
    real(wp), intent(in) :: margin !! how near counts [m]
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: own(:, :), outline(:, :)

    self%period = periods_of(scene)
    self%tilt = scene%cell%middle(4)
    call draw_boxes(scene, reach, margin, own)
    call comm%gather([minval(own(:3, :), 2), maxval(own(4:, :), 2)], outline)
    if (allocated(self%outline)) deallocate (self%outline)
    allocate (self%outline(6, 0:comm%size - 1))
    self%outline(:, :) = outline
    call swap_boxes(self, own, comm)
  end subroutine rank_bounds_survey

  !> Boxes about groups of grains along Hilbert's curve, widened by the margin.
  subroutine draw_boxes(scene, reach, margin, box)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: reach(:), margin
    real(wp), allocatable, intent(out) :: box(:, :)
    integer, allocatable :: grain(:)
    real(wp) :: low(scene%dimension), side, here(3)
    integer :: i, b, n, d, group

    d = scene%dimension
    grain = pack([(i, i=1, scene%bodies%n_own)], scene%bodies%owner(:scene%bodies%n_own) >= 0)
    n = size(grain)
    group = max(16, (n + most_boxes - 1)/most_boxes)
    allocate (box(6, (n + group - 1)/group))
    box(:3, :) = huge(1.0_wp)
    box(4:, :) = -huge(1.0_wp)
    if (n == 0) return
    low = minval(scene%bodies%position(:, grain), 2)
    side = max(maxval(maxval(scene%bodies%position(:, grain), 2) - low), tiny(side))
    grain = grain(hilbert_order(scene%bodies%position(:, grain), low, side))
    here = 0
    do i = 1, n
      b = grain(i)
      here(:d) = scene%bodies%position(:, b)
      associate (own => box(:, (i - 1)/group + 1))
        own(:3) = min(own(:3), here - reach(b) - margin)
        own(4:) = max(own(4:), here + reach(b) + margin)
      end associate
    end do
  end subroutine draw_boxes

  !> Send the boxes to ranks whose outline comes near, and receive theirs.
  subroutine swap_boxes(self, own, comm)
    class(rank_bounds_t), intent(inout) :: self
    real(wp), intent(in) :: own(:, :)
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable :: send(:), receive(:)
    integer, allocatable :: received(:)
    integer :: sent(0:comm%size - 1), r

    sent = 0
    allocate (send(0))
    do r = 0, comm%size - 1
      if (r == comm%rank) cycle
      if (.not. overlap(self%outline(:, comm%rank), self%outline(:, r), self%period, self%tilt)) cycle
      sent(r) = size(own)
    end do
    send = [(reshape(own, [size(own)]), r=1, count(sent > 0))]
    call comm%swap(send, sent, receive, received)
    if (allocated(self%first)) deallocate (self%first, self%box)
    allocate (self%first(0:comm%size), self%box(6, size(receive)/6))
    self%box(:, :) = reshape(receive, [6, size(receive)/6])
    self%first(0) = 1
    do r = 0, comm%size - 1
      self%first(r + 1) = self%first(r) + received(lbound(received, 1) + r)/6
    end do
  end subroutine swap_boxes

  !> Does a body come near the grains of another rank?
  pure logical function rank_bounds_is_near(self, r, centre, reach)
    class(rank_bounds_t), intent(in) :: self
    integer, intent(in) :: r !! rank
    real(wp), intent(in) :: centre(:) !! of the body [m], shape (dimension)
    real(wp), intent(in) :: reach !! radius that holds it [m]
    real(wp) :: own(6)
    integer :: i

    own = 0
    own(:size(centre)) = centre - reach
    own(4:3 + size(centre)) = centre + reach
    rank_bounds_is_near = .false.
    if (.not. overlap(own, self%outline(:, r), self%period, self%tilt)) return
    do i = self%first(r), self%first(r + 1) - 1
      rank_bounds_is_near = overlap(own, self%box(:, i), self%period, self%tilt)
      if (rank_bounds_is_near) return
    end do
  end function rank_bounds_is_near

  !> Do two boxes overlap, or an image of one with the other?
  pure logical function overlap(a, b, period, tilt)
    real(wp), intent(in) :: a(6), b(6), period(3), tilt
    real(wp) :: shift
    integer :: axis, image

    overlap = .true.
    if (abs(tilt) > 0) then
      overlap = overlap_tilted(a, b, period, tilt)
      return
    end if
    do axis = 1, 3
      if (.not. overlap) return
      overlap = .false.
      do image = -1, 1
        if (image /= 0 .and. .not. period(axis) > 0) cycle
        shift = period(axis)*real(image, wp)
        overlap = overlap .or. (a(axis) + shift <= b(axis + 3) .and. b(axis) <= a(axis + 3) + shift)
      end do
    end do
  end function overlap

  !> The same in a sheared cell: an image along y is moved along x, too, where it is looked at in two images on either side.
  pure logical function overlap_tilted(a, b, period, tilt) result(overlap)
    real(wp), intent(in) :: a(6), b(6), period(3), tilt
    real(wp) :: shift(3)
    integer :: i, j, k

    overlap = .false.
    do k = -1, 1
      do j = -1, 1
        shift = [tilt*real(j, wp), period(2)*real(j, wp), period(3)*real(k, wp)]
        ! Of the images along x those that bring the low corners nearest.
        shift(1) = shift(1) - period(1)*anint((a(1) + shift(1) - b(1))/period(1))
        do i = -2, 2
          associate (moved => shift + [period(1)*real(i, wp), 0.0_wp, 0.0_wp])
            overlap = all(a(:3) + moved <= b(4:)) .and. all(b(:3) <= a(4:) + moved)
          end associate
          if (overlap) return
        end do
      end do
    end do
  end function overlap_tilted
end module sg_rank_bounds
