!> The smallest displacements that open gaps, found by a few sweeps with momentum over the contacts of all ranks
!! (doc/theory/recovery.md).
!!
!! Nothing is tested, so that ranks sum nothing: momentum follows the sequence without restarts [Nesterov1983], and what so many
!! sweeps leave is for the next push. Copies of a body have divided masses and take their mean, as by the dual method.
module sg_pusher
  use sg_comm, only: comm_t
  use sg_gluing, only: gluing_t
  use sg_kinds, only: wp, i4
  use sg_nesterov_rule, only: nesterov_rule_t
  use sg_push_problem, only: push_problem_t
  use sg_push_records, only: plane_body, plane_gap, plane_inverse_wnn, plane_inverse_wtt, plane_moment_na, plane_moment_nc, &
                             plane_moment_ta, plane_moment_tc, plane_record, plane_room, plane_wtn, space_body, space_gap, &
                             space_inverse_wnn, space_inverse_wtt, space_record, space_room, space_wtn
  use sg_records, only: is_in_space, solid_inverse_mx, solid_inverse_my, solid_inverse_mz, solid_inverse_xx, solid_inverse_xy, &
                        solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, solid_inverse_zz
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: pusher_t

  !> Places at which a sweep goes on in turns: updates that follow each other share no body, so that none waits for another one
  integer, parameter :: n_fronts = 8

  !> Solver of pushes, with its room from one to the next
  type :: pusher_t
    !> The problem of the push
    type(push_problem_t) :: push
    !> Copies of bodies on other ranks
    type(gluing_t), private :: gluing
    !> Impulses, and displacements of bodies, of the sweep before
    real(wp), allocatable, private :: impulse(:), body(:, :)
  contains
    procedure :: solve => pusher_solve
    procedure :: list_tables => pusher_list_tables
  end type pusher_t

contains

  !> Find displacements, from none. Collective.
  subroutine pusher_solve(self, sweeps, coupling, comm)
    class(pusher_t), intent(inout) :: self !! its problem is finished
    integer, intent(in) :: sweeps !! over all contacts
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), parameter :: no_sums(2) = 0
    type(nesterov_rule_t) :: rule
    real(wp) :: share
    integer :: i

    if (comm%size > 1) call open_copies(self, coupling, comm)
    self%body = self%push%bodies%body(:self%push%width, :)
    self%impulse = self%push%impulse(:self%push%n)
    call rule%begin(0)
    do i = 1, sweeps
      if (i > 1) then
        call rule%next(no_sums, .false., share)
        call go_on(self, share)
        if (comm%size > 1) call self%gluing%mark(self%push%bodies)
      end if
      call sweep(self%push)
      if (comm%size == 1) cycle
      call self%gluing%begin(self%push%bodies, comm)
      call self%gluing%finish(self%push%bodies, comm)
    end do
    if (comm%size > 1) call self%gluing%interface%update_idle(self%push%bodies%body, coupling, comm)
  end subroutine pusher_solve

  !> Divide masses among copies. Collective.
  subroutine open_copies(self, coupling, comm)
    type(pusher_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    type(comm_t), intent(inout) :: comm
    integer, allocatable :: copies(:)

    call self%gluing%prepare(self%push%bodies, coupling, .true., .false., comm)
    allocate (copies(self%push%bodies%n_bodies), source=1)
    associate (interface => self%gluing%interface)
      copies(interface%slot) = max(1, interface%multiplicity)
    end associate
    call self%push%divide(copies)
  end subroutine open_copies

  !> Let impulses and displacements go on by a share of their last change.
  pure subroutine go_on(self, share)
    type(pusher_t), intent(inout) :: self
    real(wp), intent(in) :: share

    call step(size(self%body, 1), size(self%body, 2), size(self%push%bodies%body, 1), share, self%push%bodies%body, self%body)
    call step(1, self%push%n, 1, share, self%push%impulse, self%impulse)
  end subroutine go_on

  !> x and its predecessor become x + share (x - predecessor) and x, in the first components of each record.
  pure subroutine step(width, n, length, share, x, before)
    integer, intent(in) :: width, n, length
    real(wp), intent(in) :: share
    real(wp), intent(inout) :: x(length, n), before(width, n)
    real(wp) :: now
    integer :: i, k

    do k = 1, n
      do i = 1, width
        now = x(i, k)
        x(i, k) = now + share*(now - before(i, k))
        before(i, k) = now
      end do
    end do
  end subroutine step

  !> Sweep once over all contacts.
  pure subroutine sweep(push)
    type(push_problem_t), intent(inout) :: push

    associate (bodies => push%bodies)
      if (is_in_space(bodies%kind)) then
        call sweep_in_space(push%n, bodies%n_bodies, bodies%pair, push%record, push%impulse, bodies%body)
      else
        call sweep_in_plane(push%n, bodies%n_bodies, bodies%pair, push%record, push%impulse, bodies%body)
      end if
    end associate
  end subroutine sweep

  !> Sweep once over contacts in the plane: along the normal, then along the tangent of those that stick.
  pure subroutine sweep_in_plane(n, n_bodies, pair, record, impulse, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(plane_record, n)
    real(wp), intent(inout) :: impulse(n), body(plane_body, n_bodies)
    real(wp) :: gap, slip, change, t, ux, uy, px, py
    integer :: i, k, c, a, stretch

    stretch = (n + n_fronts - 1)/n_fronts
    do i = 1, stretch
      do k = i, n, stretch
        c = pair(1, k)
        a = pair(2, k)
        associate (r => record(:, k), b => body(:, c), d => body(:, a))
          ux = b(1) - d(1)
          uy = b(2) - d(2)
          gap = r(plane_gap) + r(1)*ux + r(2)*uy + (r(plane_moment_nc)*b(3) - r(plane_moment_na)*d(3))
          slip = r(2)*ux - r(1)*uy + (r(plane_moment_tc)*b(3) - r(plane_moment_ta)*d(3))
          change = change_of(impulse(k), gap*r(plane_inverse_wnn), r(plane_room)*r(plane_inverse_wnn))
          t = -(slip + r(plane_wtn)*change)*r(plane_inverse_wtt)
          ! Whether anything changes is anyone's guess, so no branch depends on it.
          impulse(k) = impulse(k) + change
          px = r(1)*change + r(2)*t
          py = r(2)*change - r(1)*t
          b(1) = b(1) + b(4)*px
          b(2) = b(2) + b(5)*py
          b(3) = b(3) + b(6)*(r(plane_moment_nc)*change + r(plane_moment_tc)*t)
          d(1) = d(1) - d(4)*px
          d(2) = d(2) - d(5)*py
          d(3) = d(3) - d(6)*(r(plane_moment_na)*change + r(plane_moment_ta)*t)
        end associate
      end do
    end do
  end subroutine sweep_in_plane

  !> The same in space, component by component, so that nothing is called.
  pure subroutine sweep_in_space(n, n_bodies, pair, record, impulse, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(space_record, n)
    real(wp), intent(inout) :: impulse(n), body(space_body, n_bodies)
    real(wp) :: ux, uy, uz, along, change, t, px, py, pz
    integer :: i, k, c, a, stretch

    stretch = (n + n_fronts - 1)/n_fronts
    do i = 1, stretch
      do k = i, n, stretch
        c = pair(1, k)
        a = pair(2, k)
        associate (r => record(:, k), b => body(:, c), d => body(:, a))
          ux = (b(1) + b(5)*r(6) - b(6)*r(5)) - (d(1) + d(5)*r(9) - d(6)*r(8))
          uy = (b(2) + b(6)*r(4) - b(4)*r(6)) - (d(2) + d(6)*r(7) - d(4)*r(9))
          uz = (b(3) + b(4)*r(5) - b(5)*r(4)) - (d(3) + d(4)*r(8) - d(5)*r(7))
          along = r(1)*ux + r(2)*uy + r(3)*uz
          change = change_of(impulse(k), (r(space_gap) + along)*r(space_inverse_wnn), r(space_room)*r(space_inverse_wnn))
          t = r(space_inverse_wtt)
          px = r(1)*change - (ux - along*r(1) + r(space_wtn)*change)*t
          py = r(2)*change - (uy - along*r(2) + r(space_wtn + 1)*change)*t
          pz = r(3)*change - (uz - along*r(3) + r(space_wtn + 2)*change)*t
          if (.not. abs(px) + abs(py) + abs(pz) > 0) cycle
          impulse(k) = impulse(k) + change
          call push_solid(px, py, pz, r(4), r(5), r(6), b)
          call push_solid(-px, -py, -pz, r(7), r(8), r(9), d)
        end associate
      end do
    end do
  end subroutine sweep_in_space

  !> Displace a solid by an impulse at an arm.
  pure subroutine push_solid(px, py, pz, ax, ay, az, body)
    real(wp), intent(in) :: px, py, pz, ax, ay, az
    real(wp), intent(inout) :: body(space_body)
    real(wp) :: mx, my, mz

    mx = ay*pz - az*py
    my = az*px - ax*pz
    mz = ax*py - ay*px
    body(1) = body(1) + body(solid_inverse_mx)*px
    body(2) = body(2) + body(solid_inverse_my)*py
    body(3) = body(3) + body(solid_inverse_mz)*pz
    body(4) = body(4) + (body(solid_inverse_xx)*mx + body(solid_inverse_xy)*my + body(solid_inverse_xz)*mz)
    body(5) = body(5) + (body(solid_inverse_xy)*mx + body(solid_inverse_yy)*my + body(solid_inverse_yz)*mz)
    body(6) = body(6) + (body(solid_inverse_xz)*mx + body(solid_inverse_yz)*my + body(solid_inverse_zz)*mz)
  end subroutine push_solid

  !> Change of the impulse of a contact along its normal [kg m].
  pure real(wp) function change_of(impulse, gap, room) result(change)
    real(wp), intent(in) :: impulse, gap, room !! gap and room over W_nn
    real(wp) :: lower

    lower = impulse - gap
    change = max(lower, min(0.0_wp, lower + room)) - impulse
  end function change_of

  !> List the tables of pushes.
  subroutine pusher_list_tables(self, tables)
    class(pusher_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%push%list_tables(tables)
    call tables%begin('push', per_contact)
    call tables%note('before', self%impulse)
    call tables%begin('push', per_body)
    call tables%note('past', self%body)
    call self%gluing%list_tables(tables)
  end subroutine pusher_list_tables
end module sg_pusher
