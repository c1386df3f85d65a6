!> Round frictional problems in coloured groups of eight contacts, so that a sweep runs in vector registers.
!!
!! Consecutive contacts share bodies, and the chain of dependent updates limits a sweep in natural order. Inside
!! blocks of consecutive contacts, small enough to stay in cache, contacts are dealt to groups of eight (lanes) in
!! which no movable body appears twice; the order of the blocks stays spatial. Lanes left over hold an empty contact.
module sg_lanes
  use sg_kinds, only: wp, i4, i8
  implicit none
  private
  public :: lanes_t, build_lanes, load_lanes, store_lanes, sweep_lanes, width

  !> Contacts of a group
  integer, parameter :: width = 8
  !> Contacts of a block, and the most groups that it may open (bits of an integer)
  integer, parameter :: block_size = 256, most_groups = 63

  !> Contacts dealt to groups
  type :: lanes_t
    !> Number of groups
    integer :: n_groups = 0
    !> Contact in each lane, 0 where empty, shape (width, groups)
    integer(i4), allocatable :: contact(:, :)
    !> Slots of candidate and antagonist, shape (width, 2, groups)
    integer(i4), allocatable :: pair(:, :, :)
    !> Records, shape (width, 7, groups)
    real(wp), allocatable :: record(:, :, :)
    !> Impulses, shape (width, 2, groups)
    real(wp), allocatable :: impulse(:, :, :)
  end type lanes_t

contains

  !> Deal contacts to groups.
  pure subroutine build_lanes(lanes, n, pair, body)
    type(lanes_t), intent(inout) :: lanes !! groups to build
    integer, intent(in) :: n !! contacts
    integer(i4), intent(in), contiguous :: pair(:, :) !! slots, shape (2, n)
    real(wp), intent(in), contiguous :: body(:, :) !! bodies' records; those that nothing moves may appear twice
    integer(i8), allocatable :: groups_of(:)
    integer :: first

    allocate (groups_of(size(body, 2)), source=0_i8)
    call make_room(lanes, n)
    lanes%n_groups = 0
    do first = 1, n, block_size
      call deal_block(lanes, first, min(n, first + block_size - 1), pair, body, groups_of)
    end do
  end subroutine build_lanes

  !> Room for a first guess of the number of groups.
  pure subroutine make_room(lanes, n)
    type(lanes_t), intent(inout) :: lanes
    integer, intent(in) :: n
    integer :: groups

    groups = n/width + n/(4*width) + most_groups
    if (allocated(lanes%contact)) then
      if (size(lanes%contact, 2) >= groups) return
      deallocate (lanes%contact, lanes%pair, lanes%record, lanes%impulse)
    end if
    allocate (lanes%contact(width, groups), lanes%pair(width, 2, groups), source=0_i4)
    allocate (lanes%record(width, 7, groups), lanes%impulse(width, 2, groups), source=0.0_wp)
  end subroutine make_room

  !> Deal one block: each contact goes to the first group that has a free lane and neither of its bodies.
  pure subroutine deal_block(lanes, first, last, pair, body, groups_of)
    type(lanes_t), intent(inout) :: lanes
    integer, intent(in) :: first, last
    integer(i4), intent(in), contiguous :: pair(:, :)
    real(wp), intent(in), contiguous :: body(:, :)
    integer(i8), intent(inout) :: groups_of(:)
    integer(i8) :: full
    integer :: filled(0:most_groups), k, g, side, used

    full = 0
    filled = 0
    used = -1
    do k = first, last
      g = trailz(not(ior(full, ior(groups_of(pair(1, k)), groups_of(pair(2, k))))))
      if (g >= most_groups) g = used + 1
      if (g > used) call open_group(lanes, used)
      filled(g) = filled(g) + 1
      lanes%contact(filled(g), lanes%n_groups - used + g) = int(k, i4)
      if (filled(g) == width) full = ibset(full, min(g, most_groups - 1))
      do side = 1, 2
        if (any(body(4:6, pair(side, k)) > 0)) groups_of(pair(side, k)) = ibset(groups_of(pair(side, k)), min(g, most_groups - 1))
      end do
    end do
    do k = first, last
      groups_of(pair(:, k)) = 0
    end do
  end subroutine deal_block

  !> Open the next group of a block.
  pure subroutine open_group(lanes, used)
    type(lanes_t), intent(inout) :: lanes
    integer, intent(inout) :: used

    used = used + 1
    lanes%n_groups = lanes%n_groups + 1
    lanes%contact(:, lanes%n_groups) = 0
  end subroutine open_group

  !> Copy pairs, records and impulses into the lanes.
  pure subroutine load_lanes(lanes, pair, record, impulse)
    type(lanes_t), intent(inout) :: lanes !! groups to fill
    integer(i4), intent(in), contiguous :: pair(:, :) !! slots, shape (2, contacts)
    real(wp), intent(in), contiguous :: record(:, :) !! records, shape (7, contacts)
    real(wp), intent(in), contiguous :: impulse(:, :) !! impulses, shape (2, contacts)
    integer :: g, l, k

    do g = 1, lanes%n_groups
      do l = 1, width
        k = lanes%contact(l, g)
        if (k > 0) then
          lanes%pair(l, :, g) = pair(:, k)
          lanes%record(l, :, g) = record(:, k)
          lanes%impulse(l, :, g) = impulse(:, k)
        else
          lanes%pair(l, :, g) = 0
          lanes%record(l, :, g) = 0
          lanes%impulse(l, :, g) = 0
        end if
      end do
    end do
  end subroutine load_lanes

  !> Copy the impulses back to the order of contacts.
  pure subroutine store_lanes(lanes, impulse)
    type(lanes_t), intent(in) :: lanes !! swept groups
    real(wp), intent(inout), contiguous :: impulse(:, :) !! impulses, shape (2, contacts)
    integer :: g, l, k

    do g = 1, lanes%n_groups
      do l = 1, width
        k = lanes%contact(l, g)
        if (k > 0) impulse(:, k) = lanes%impulse(l, :, g)
      end do
    end do
  end subroutine store_lanes

  !> One sweep with Coulomb friction over all groups; slot 0 is a body of empty lanes, at rest.
  !!
  !! No movable body appears twice in a group, so the lanes may be swept at once, as the directive says.
  pure subroutine sweep_lanes(n_groups, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n_groups !! groups
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(width, 2, n_groups) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(width, 7, n_groups) !! n_x, n_y, bias_n, bias_t, 1/W_nn, 1/W_tt, friction
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(width, 2, n_groups) !! impulses [N s]
    real(wp), intent(inout) :: body(6, 0:n_bodies) !! v_x, v_y, R spin, inverse masses, R^2/I
    real(wp) :: x, y, dx, dy, u_n, u_t, r_n, r_t, limit, p_x, p_y
    integer :: g, l
    integer(i4) :: c, a

    do g = 1, n_groups
!GCC$ ivdep
      do l = 1, width
        c = pair(l, 1, g)
        a = pair(l, 2, g)
        x = record(l, 1, g)
        y = record(l, 2, g)
        dx = body(1, c) - body(1, a)
        dy = body(2, c) - body(2, a)
        u_n = x*dx + y*dy + record(l, 3, g)
        u_t = y*dx - x*dy + body(3, c) + body(3, a) + record(l, 4, g)
        r_n = max(0.0_wp, impulse(l, 1, g) - u_n*record(l, 5, g))
        limit = record(l, 7, g)*r_n
        r_t = max(-limit, min(limit, impulse(l, 2, g) - u_t*record(l, 6, g)))
        r_n = relaxation*(r_n - impulse(l, 1, g))
        r_t = relaxation*(r_t - impulse(l, 2, g))
        impulse(l, 1, g) = impulse(l, 1, g) + r_n
        impulse(l, 2, g) = impulse(l, 2, g) + r_t
        p_x = x*r_n + y*r_t
        p_y = y*r_n - x*r_t
        body(1, c) = body(1, c) + body(4, c)*p_x
        body(2, c) = body(2, c) + body(5, c)*p_y
        body(3, c) = body(3, c) + body(6, c)*r_t
        body(1, a) = body(1, a) - body(4, a)*p_x
        body(2, a) = body(2, a) - body(5, a)*p_y
        body(3, a) = body(3, a) + body(6, a)*r_t
      end do
    end do
  end subroutine sweep_lanes
end module sg_lanes
