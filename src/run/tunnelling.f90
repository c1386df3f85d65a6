!> Tunnelling: bodies that pass through each other, within a step or squeezed.
!!
!! Contacts are found once per step, and their gaps once per substep. From one gap to the next a body moves by exactly h V, whatever
!! theta, h being the length of a substep, so a contact of gap g is g + h u_n wide at the next one, u_n being the velocity that the
!! substep ended with. Laws that act at a
!! distance (IQS, GAP_SGR) leave no g + h u_n below zero. Those that wait until shapes touch (RST, VEL_SGR) may, and so does a
!! body between a floor and a lid that come together: where the overlap exceeds what both shapes measure to their middles, what
!! is found next lies beyond, and is pushed out on the wrong side, or not at all.
!!
!! A body may also meet a wall without a contact before: in the first step, where a restart file has no gaps, or from beyond the
!! alert distance at a velocity that it has just been given. Then the path of its centre since the last detection decides.
module sg_tunnelling
  use sg_bodies, only: body_present
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t, fail
  use sg_guard, only: number_of
  use sg_half_width, only: half_width
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_plan, only: plan_t
  use sg_scene, only: scene_t
  use sg_swept_shapes, only: goes_through
  use sg_text, only: to_text
  implicit none
  private
  public :: tunnelling_t, find_crossed_contacts, find_crossed_walls, warn_of_tunnelling

  !> Tunnelling of the present step
  type :: tunnelling_t
    !> Pairs of bodies that passed in the present step, of this rank and then of all
    integer :: n = 0
    !> Numbers of the bodies of those of this rank, shape (2, n)
    integer(i4), allocatable :: pair(:, :)
    !> Deepest overlap of the last step [m]
    real(wp) :: deepest = 0
    !> May a body move farther than the alert distance in the present step? Of this rank and then of all
    logical :: exceeds_alert = .false.
    !> May one of this rank move farther than the thinnest shape?
    logical :: exceeds_thinnest = .false.
    !> Sentence about the first of them, and whether it has been printed
    type(error_t), allocatable :: first
    logical :: is_printed = .false.
  end type tunnelling_t

contains

  !> Count the pairs of bodies in contact that the motion since the last substep has brought through each other.
  subroutine find_crossed_contacts(tunnelling, scene, contacts, plan, way, is_loaded, step, h, substep, substeps)
    type(tunnelling_t), intent(inout) :: tunnelling !! its count is set
    type(scene_t), intent(in) :: scene !! velocities are those with which the last step ended
    type(contacts_t), intent(in) :: contacts !! contacts of the last substep
    type(plan_t), intent(in) :: plan !! alert distances and thinnest shape
    real(wp), intent(in) :: way !! by which shapes were taken to come nearer to each other in the last step [m]
    logical, intent(in) :: is_loaded !! are contacts those of a checkpoint or a deck, which have no gaps?
    integer, intent(in) :: step !! number of the step that begins
    real(wp), intent(in) :: h !! length of a substep [s]
    integer, intent(in) :: substep !! number of the one that begins
    integer, intent(in) :: substeps !! substeps of a step
    real(wp) :: displacement, thickness, alert
    integer :: k

    tunnelling%n = 0
    displacement = h*largest_speed(scene%bodies%velocity(:scene%dimension, :))
    ! The contacts found by the first substep are those of all.
    alert = min(plan%alert, max(plan%least_alert, way))
    tunnelling%exceeds_alert = real(substeps, wp)*displacement > alert .or. (tunnelling%exceeds_alert .and. substep > 1)
    tunnelling%exceeds_thinnest = displacement > plan%thinnest
    if (is_loaded .or. .not. displacement + tunnelling%deepest > plan%thinnest) return
    do k = 1, contacts%n
      associate (b => contacts%body(:, k), gap => contacts%gap(k), n => scene%dimension)
        displacement = -h*dot_product(contacts%normal(:, k), scene%bodies%velocity(:n, b(1)) - scene%bodies%velocity(:n, b(2)))
        ! The half width of a polyhedron takes all its faces: no pair is thinner than two of the thinnest shape.
        if (displacement <= 0 .or. displacement - gap <= 2*plan%thinnest) cycle
        thickness = half_width(scene%contactors, int(contacts%contactor(1, k))) + &
                    half_width(scene%contactors, int(contacts%contactor(2, k)))
        ! Beyond the middles after the step, and not before.
        if (displacement - gap <= thickness .or. -gap > thickness) cycle
        call count_pair(tunnelling, scene, int(b), step, h, displacement, thickness)
      end associate
    end do
  end subroutine find_crossed_contacts

  !> Largest speed of all bodies [m/s]; where squares have no room, the largest component.
  pure real(wp) function largest_speed(velocity)
    real(wp), intent(in) :: velocity(:, :)
    real(wp) :: square
    integer :: b

    largest_speed = 0
    do b = 1, size(velocity, 2)
      square = velocity(1, b)**2 + velocity(2, b)**2
      if (size(velocity, 1) == 3) square = square + velocity(3, b)**2
      largest_speed = max(largest_speed, square)
    end do
    if (largest_speed <= huge(1.0_wp)) then
      largest_speed = sqrt(largest_speed)
    else
      largest_speed = maxval(abs(velocity))
    end if
  end function largest_speed

  !> Count the grains whose centres have gone through a wall since the last detection, where a body may have moved by more than the
  !! thinnest shape.
  subroutine find_crossed_walls(tunnelling, scene, step, h, share, thinnest)
    type(tunnelling_t), intent(inout) :: tunnelling !! its count grows
    type(scene_t), intent(in) :: scene !! contactors are placed for the step, velocities are those with which the last one ended
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: h !! length of a substep [s]
    real(wp), intent(in) :: share !! share of the substep since shapes were placed last, or since the start
    real(wp), intent(in) :: thinnest !! half width of the thinnest shape [m]
    integer, allocatable :: walls(:)
    logical, allocatable :: is_wall(:)
    real(wp) :: displacement(scene%dimension)
    integer :: c, i, n

    if (.not. tunnelling%exceeds_thinnest) return
    n = scene%dimension
    associate (bodies => scene%bodies, contactors => scene%contactors)
      is_wall = .not. bodies%is_grain
      if (allocated(bodies%presence)) is_wall = is_wall .and. bodies%presence == body_present
      walls = pack([(c, c=1, contactors%n)], is_wall(contactors%body(:contactors%n)))
      do c = 1, contactors%n
        ! Each rank checks its own grains, not copies.
        if (.not. bodies%is_grain(contactors%body(c)) .or. contactors%body(c) > bodies%n_own) cycle
        do i = 1, size(walls)
          associate (b => [int(contactors%body(c)), int(contactors%body(walls(i)))])
            displacement = share*h*(bodies%velocity(:n, b(1)) - bodies%velocity(:n, b(2)))
            if (sum(displacement**2) <= thinnest**2) cycle
            if (.not. meets_wall(scene, walls(i), contactors%centre(:, c) - displacement, contactors%centre(:, c))) cycle
            call count_pair(tunnelling, scene, b, step, share*h, norm2(displacement), &
                            half_width(contactors, c) + half_width(contactors, walls(i)))
          end associate
        end do
      end do
    end associate
  end subroutine find_crossed_walls

  !> Does the path of a point lead through a wall or one of its periodic images?
  pure logical function meets_wall(scene, wall, from, to) result(meets)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: wall
    real(wp), intent(in) :: from(scene%dimension), to(scene%dimension)
    ! A path over more periods is cut: such a velocity gives another warning.
    real(wp), parameter :: most = 100
    real(wp) :: period(2), offset(scene%dimension)
    integer :: first(2), last(2), axis, i, j

    period = [scene%period, scene%period_y]
    first = 0
    last = 0
    do axis = 1, 2
      if (.not. period(axis) > 0) cycle
      associate (centre => scene%contactors%centre(axis, wall), reach => scene%contactors%reach(wall))
        first(axis) = ceiling(max(-most, (min(from(axis), to(axis)) - centre - reach)/period(axis)))
        last(axis) = floor(min(most, (max(from(axis), to(axis)) - centre + reach)/period(axis)))
      end associate
    end do
    meets = .false.
    offset = 0
    do j = first(2), last(2)
      do i = first(1), last(1)
        offset(1) = real(i, wp)*period(1)
        if (scene%dimension == 3) offset(2) = real(j, wp)*period(2)
        meets = goes_through(scene%contactors, wall, from - offset, to - offset)
        if (meets) return
      end do
    end do
  end function meets_wall

  !> Count a pair once per step, and keep a sentence about the first of all.
  subroutine count_pair(tunnelling, scene, body, step, h, displacement, thickness)
    type(tunnelling_t), intent(inout) :: tunnelling
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body(2), step
    real(wp), intent(in) :: h, displacement, thickness
    character(len=:), allocatable :: bodies
    integer :: numbers(2), i

    numbers = [number_of(scene, minval(body)), number_of(scene, maxval(body))]
    do i = 1, tunnelling%n
      if (all(tunnelling%pair(:, i) == numbers)) return
    end do
    tunnelling%n = tunnelling%n + 1
    call reserve(tunnelling%pair, 2, tunnelling%n)
    tunnelling%pair(:, tunnelling%n) = int(numbers, i4)
    if (tunnelling%is_printed .or. allocated(tunnelling%first)) return
    bodies = 'step '//to_text(step)//': bodies '//to_text(minval(numbers))//' and '//to_text(maxval(numbers))
    if (displacement > thickness) then
      call fail(tunnelling%first, bodies//' pass through each other, at '//to_text(displacement/h, 3)//' m/s, '// &
                'since contacts are found once per step; a time step below '//to_text(thickness/displacement*h, 2)//' s finds them')
    else
      call fail(tunnelling%first, bodies//' are pressed through each other: they overlap by more than half of their thickness')
    end if
  end subroutine count_pair

  !> Warn of the first bodies that passed. Collective where ranks share the scene; all have the same count.
  subroutine warn_of_tunnelling(tunnelling, comm, unit)
    type(tunnelling_t), intent(inout) :: tunnelling !! of the step just done
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, intent(in) :: unit !! open unit to write on

    if (tunnelling%n == 0 .or. tunnelling%is_printed) return
    tunnelling%is_printed = .true.
    call comm%agree(tunnelling%first)
    if (comm%rank == 0 .and. allocated(tunnelling%first)) write (unit, '(a)') tunnelling%first%report('warning')
  end subroutine warn_of_tunnelling
end module sg_tunnelling
