!> Grains that wait for their places: each enters when its time has come and no other grain is where it is to be.
!!
!! Circles or spheres about bodies decide, so that grains which do not touch each other by their shapes may wait for each other.
!! Walls are not looked at.
module sg_free_places
  use sg_bodies, only: bodies_t, body_present, body_waiting
  use sg_comm, only: comm_t
  use sg_contactors, only: kind_point
  use sg_kinds, only: wp, i4, i8
  use sg_passages, only: due_time
  use sg_rank_bounds, only: body_reach
  use sg_scene, only: scene_t
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: let_in_where_free

  !> Grains that are looked at in one step: of those that wait, the ones of the least numbers
  integer, parameter :: most_waiting = 256
  !> Numbers per grain that waits: its number, the radius about it [m], its place [m]
  integer, parameter :: n_values = 5

contains

  !> Mark the grains whose time has come and whose places are free. Collective.
  subroutine let_in_where_free(scene, comm, step, time, next)
    type(scene_t), intent(in) :: scene !! scene between two steps
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, intent(in) :: step !! steps done
    real(wp), intent(in) :: time !! time reached [s]
    integer(i4), intent(inout) :: next(:) !! presence of bodies from the next step on
    real(wp), allocatable :: waiting(:, :), reach(:)
    integer, allocatable :: blocked(:)
    logical, allocatable :: enters(:)
    integer(i4), allocatable :: own(:)
    integer :: i

    if (.not. any(scene%entries%waits .and. modulo(step, scene%entries%every) == 0)) return
    own = list_waiting(scene, step, time)
    if (comm%size == 1 .and. size(own) == 0) return
    reach = body_reach(scene, scene%bodies%n)
    call gather_waiting(scene, own, reach, comm, waiting)
    if (size(waiting, 2) == 0) return
    blocked = blocked_places(scene, reach, waiting, next)
    call comm%sum(blocked)
    enters = blocked == 0
    do i = 1, size(enters)
      if (enters(i)) enters(i) = .not. any(enters(:i - 1) .and. overlap(scene, waiting(:, i), waiting(:, :i - 1)))
    end do
    do i = 1, size(own)
      if (any(enters .and. nint(waiting(1, :)) == number_of(scene%bodies, own(i)))) next(own(i)) = body_present
    end do
  end subroutine let_in_where_free

  !> Grains of this rank that wait and are due, by ascending numbers.
  pure function list_waiting(scene, step, time) result(list)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: step
    real(wp), intent(in) :: time
    integer(i4), allocatable :: list(:)
    logical :: is_due(scene%bodies%n_own)
    integer :: e, b

    is_due = .false.
    do e = 1, size(scene%entries)
      associate (entry => scene%entries(e))
        if (.not. entry%waits .or. modulo(step, entry%every) /= 0 .or. time < entry%start) cycle
        do b = 1, size(is_due)
          if (abs(scene%bodies%presence(b)) /= body_waiting) cycle
          is_due(b) = is_due(b) .or. due_time(entry, number_of(scene%bodies, int(b, i4))) <= time
        end do
      end associate
    end do
    ! Own bodies stand by ascending numbers.
    list = pack([(int(b, i4), b=1, size(is_due))], is_due)
    list = list(:min(most_waiting, size(list)))
  end function list_waiting

  !> Number of a body in the whole scene.
  pure elemental integer function number_of(bodies, body)
    type(bodies_t), intent(in) :: bodies
    integer(i4), intent(in) :: body

    number_of = body
    if (allocated(bodies%id)) number_of = bodies%id(body)
  end function number_of

  !> The grains of all ranks that wait, by ascending numbers.
  subroutine gather_waiting(scene, own, reach, comm, waiting)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: own(:)
    real(wp), intent(in) :: reach(:)
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable, intent(out) :: waiting(:, :)
    real(wp) :: values(n_values, size(own))
    integer, allocatable :: received(:)
    real(wp), allocatable :: all_values(:)
    integer :: sent(0:comm%size - 1), r

    values = 0
    values(1, :) = real(number_of(scene%bodies, own), wp)
    values(2, :) = reach(own)
    values(3:2 + scene%dimension, :) = scene%bodies%position(:, own)
    waiting = values
    if (comm%size == 1) return
    sent = size(values)
    call comm%swap([(reshape(values, [size(values)]), r=1, comm%size)], sent, all_values, received)
    waiting = reshape(all_values, [n_values, size(all_values)/n_values])
    waiting = waiting(:, sort_permutation(nint(waiting(1, :), i8)))
    waiting = waiting(:, :min(most_waiting, size(waiting, 2)))
  end subroutine gather_waiting

  !> How many shapes of this rank's grains are in each place.
  pure function blocked_places(scene, reach, waiting, next) result(blocked)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: reach(:), waiting(:, :)
    integer(i4), intent(in) :: next(:)
    integer, allocatable :: blocked(:)
    real(wp) :: low(3), high(3), body(n_values, 1)
    integer :: b, i, d

    allocate (blocked(size(waiting, 2)), source=0)
    d = scene%dimension
    low = minval(waiting(3:, :) - spread(waiting(2, :), 1, 3), 2)
    high = maxval(waiting(3:, :) + spread(waiting(2, :), 1, 3), 2)
    body = 0
    do b = 1, scene%bodies%n_own
      if (next(b) /= body_present .or. .not. scene%bodies%is_grain(b)) cycle
      body(2:2 + d, 1) = [reach(b), scene%bodies%position(:, b)]
      ! Most are far from all places. Of a periodic scene images count too.
      if (.not. max(scene%period, scene%period_y) > 0) then
        if (any(body(3:, 1) + reach(b) < low .or. body(3:, 1) - reach(b) > high)) cycle
      end if
      do i = 1, size(blocked)
        if (any(overlap(scene, waiting(:, i), body))) blocked(i) = blocked(i) + 1
      end do
    end do
  end function blocked_places

  !> Do circles or spheres overlap one of them, or its images?
  pure function overlap(scene, one, others)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: one(n_values), others(:, :)
    logical :: overlap(size(others, 2))
    real(wp) :: apart(3), period(3)
    integer :: i

    period = [scene%period, scene%period_y, 0.0_wp]
    do i = 1, size(overlap)
      apart = others(3:, i) - one(3:)
      where (period > 0) apart = apart - period*anint(apart/merge(period, 1.0_wp, period > 0))
      overlap(i) = norm2(apart) < one(2) + others(2, i)
    end do
  end function overlap
end module sg_free_places
