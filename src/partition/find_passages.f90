!> Bodies that enter or leave between two steps: which ones, the same on all ranks that hold them.
module sg_find_passages
  use sg_bodies, only: bodies_t, body_present, body_removed, body_waiting
  use sg_comm, only: comm_t
  use sg_free_places, only: let_in_where_free
  use sg_kinds, only: wp, i4, i8
  use sg_owner_sums, only: copy_from_owner
  use sg_passages, only: due_time
  use sg_scene, only: scene_t
  use sg_sorting, only: sort_permutation
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: find_passages

contains

  !> Find the presence of all bodies from the next step on. Collective.
  subroutine find_passages(scene, subdomain, comm, step, time, next, has_changed)
    type(scene_t), intent(in) :: scene !! scene between two steps, with bodies that may enter or leave
    type(subdomain_t), intent(in) :: subdomain !! which ranks hold which bodies
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, intent(in) :: step !! steps done
    real(wp), intent(in) :: time !! time reached [s], with some room for rounding
    integer(i4), allocatable, intent(out) :: next(:) !! one of `body_*` per body
    logical, intent(out) :: has_changed !! does any body of any rank enter or leave?

    next = scene%bodies%presence
    if (allocated(scene%exits)) call mark_leaving(scene, step, time, next)
    if (allocated(scene%entries)) then
      call mark_entering(scene, time, next)
      call let_in_where_free(scene, comm, step, time, next)
    end if
    has_changed = comm%any(any(next(:scene%bodies%n_own) /= scene%bodies%presence(:scene%bodies%n_own)))
    if (has_changed .and. comm%size > 1) call share(scene%bodies, subdomain, comm, next)
  end subroutine find_passages

  !> Mark the bodies that leave.
  pure subroutine mark_leaving(scene, step, time, next)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: step
    real(wp), intent(in) :: time
    integer(i4), intent(inout) :: next(:)
    integer :: e, b

    do e = 1, size(scene%exits)
      associate (exit => scene%exits(e), bodies => scene%bodies)
        if (time < exit%start .or. modulo(step, exit%every) /= 0) cycle
        do b = 1, bodies%n_own
          if (bodies%presence(b) /= body_present) cycle
          if (exit%takes(number_of(bodies, b), bodies%is_grain(b), bodies%position(:, b))) next(b) = body_removed
        end do
      end associate
    end do
  end subroutine mark_leaving

  !> Mark the bodies whose time has come, of those that wait for nothing else.
  pure subroutine mark_entering(scene, time, next)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: time
    integer(i4), intent(inout) :: next(:)
    integer :: e, b

    do b = 1, scene%bodies%n_own
      if (abs(scene%bodies%presence(b)) /= body_waiting) cycle
      do e = 1, size(scene%entries)
        if (scene%entries(e)%waits) cycle
        if (due_time(scene%entries(e), number_of(scene%bodies, b)) <= time) next(b) = body_present
      end do
    end do
  end subroutine mark_entering

  !> Number of a body in the whole scene.
  pure integer function number_of(bodies, body)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: body

    number_of = body
    if (allocated(bodies%id)) number_of = bodies%id(body)
  end function number_of

  !> Give copies and replicated bodies what the rank has found that counts them.
  subroutine share(bodies, subdomain, comm, next)
    type(bodies_t), intent(in) :: bodies
    type(subdomain_t), intent(in) :: subdomain
    type(comm_t), intent(inout) :: comm
    integer(i4), intent(inout) :: next(:)
    real(wp) :: values(1, size(next))
    real(wp), allocatable :: sums(:)
    integer(i4), allocatable :: replicated(:)
    integer :: b

    values(1, :) = real(next, wp)
    ! Before the first step there are no copies.
    if (allocated(subdomain%neighbour)) call copy_from_owner(subdomain, comm, values)
    replicated = pack([(int(b, i4), b=1, bodies%n)], bodies%owner < 0)
    replicated = replicated(sort_permutation(int(bodies%id(replicated), i8)))
    sums = merge(values(1, replicated), 0.0_wp, replicated <= bodies%n_own)
    call comm%sum(sums)
    values(1, replicated) = sums
    next = nint(values(1, :), i4)
  end subroutine share
end module sg_find_passages
