!> Driven degrees of freedom, imposed forces and pressed walls.
module sg_drives
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: drive_t, pressure_t, mark_walls, fix_driven, free_inverse, hold_driven, drive_forces, drive_velocities

  !> One imposed component of one body
  type :: drive_t
    !> Body and component (1 x, 2 y, 3 rotation; in space 1 to 3 x, y, z and 4 to 6 spin about principal axes)
    integer :: body = 0, component = 0
    !> A velocity is imposed; otherwise a force is
    logical :: is_velocity = .true.
    !> The imposed velocity [m/s, rad/s] or force [N, N m]
    type(time_function_t) :: value
    !> Where its time has a beginning or an end: is the component free outside of it? Else it has the velocity `rest` there
    logical :: is_released = .true.
    real(wp) :: rest = 0
  contains
    procedure :: releases => drive_releases
  end type drive_t

  !> A pressure that pushes a wall
  type :: pressure_t
    !> Body that is pushed
    integer :: body = 0
    !> Direction of the push, unit vector
    real(wp) :: direction(3) = 0
    !> Pressed length [m], in space area [m2]; where zero, in the plane, the free distance between the two bodies of `between`
    real(wp) :: length = 0
    !> Bodies whose facing sides bound the pressed length, and the sum of their half thicknesses [m]
    integer :: between(2) = 0
    real(wp) :: thickness = 0
    !> In space, where `length` is zero: for each axis across the push two bodies whose facing sides bound the pressed area, 0 where
    !! none do, and what is added to the distance of their centres [m]: the negative sum of half thicknesses, or without bodies
    !! the length itself
    integer :: sides(2, 3) = 0
    real(wp) :: side_length(3) = 0
    !> In the plane, for a body of a chain: the bodies before and after it, itself at an end of the chain; 0 for other bodies. The
    !! pressure acts to the left of the way along the chain, on half of the segments to both
    integer :: chain(2) = 0
    !> The pressure [Pa]
    type(time_function_t) :: value
  end type pressure_t

contains

  !> Find the bodies that are no grains: those with an imposed velocity or a pressure. A body in space that is held along one of
  !! x, y, z, and free along both others and to turn about an axis, moves as in a plane: it stays a grain.
  pure subroutine mark_walls(drives, pressures, bodies)
    type(drive_t), intent(in) :: drives(:) !! all drives of the scene
    type(pressure_t), intent(in) :: pressures(:) !! all pressures of the scene
    type(bodies_t), intent(inout) :: bodies !! grains, where nothing else is known of them
    logical, allocatable :: is_held(:, :)
    integer :: i, n

    n = bodies%dimension
    allocate (is_held(bodies%n_velocity, bodies%n), source=.false.)
    do i = 1, size(drives)
      if (.not. drives(i)%is_velocity) cycle
      if (drives(i)%value%is_zero()) then
        is_held(drives(i)%component, drives(i)%body) = .true.
      else
        bodies%is_grain(drives(i)%body) = .false.
      end if
    end do
    do i = 1, bodies%n
      if (.not. any(is_held(:, i))) cycle
      if (n == 3 .and. count(is_held(:n, i)) == 1 .and. .not. all(is_held(n + 1:, i))) cycle
      bodies%is_grain(i) = .false.
    end do
    do i = 1, size(pressures)
      bodies%is_grain(pressures(i)%body) = .false.
    end do
  end subroutine mark_walls

  !> Take away the inverse mass of every component whose velocity is imposed.
  pure subroutine fix_driven(drives, bodies)
    type(drive_t), intent(in) :: drives(:) !! all drives of the scene
    type(bodies_t), intent(inout) :: bodies !! inverse masses set for free bodies
    integer :: i

    do i = 1, size(drives)
      if (.not. drives(i)%is_velocity .or. drives(i)%component > bodies%n_velocity) cycle
      bodies%inverse_mass(drives(i)%component, drives(i)%body) = 0
    end do
  end subroutine fix_driven

  !> Is the component of a drive free before it begins or after it ends?
  pure logical function drive_releases(self)
    class(drive_t), intent(in) :: self

    drive_releases = self%is_velocity .and. self%is_released .and. self%value%is_timed()
  end function drive_releases

  !> Give free components their inverse mass, and take it away from those that are driven in a step, of drives that begin or end.
  pure subroutine hold_driven(drives, bodies, middle)
    type(drive_t), intent(in) :: drives(:) !! all drives of the scene
    type(bodies_t), intent(inout) :: bodies !! inverse masses to set
    real(wp), intent(in) :: middle !! of the step [s]
    integer :: i, pass

    do pass = 1, 2
      do i = 1, size(drives)
        associate (c => drives(i)%component, b => drives(i)%body)
          if (.not. drives(i)%releases() .or. c > bodies%n_velocity) cycle
          ! Several drives may take turns: those that act come last.
          if (pass == 1) bodies%inverse_mass(c, b) = free_inverse(bodies, c, b)
          if (pass == 2 .and. drives(i)%value%acts(middle)) bodies%inverse_mass(c, b) = 0
        end associate
      end do
    end do
  end subroutine hold_driven

  !> Inverse mass of a free component; zero for a body without mass.
  pure real(wp) function free_inverse(bodies, component, body) result(inverse)
    type(bodies_t), intent(in) :: bodies !! bodies with their masses
    integer, intent(in) :: component !! as in `drive_t`
    integer, intent(in) :: body !! index of the body
    real(wp) :: mass

    if (component <= bodies%dimension) then
      mass = bodies%mass(body)
    else if (bodies%dimension == 2) then
      mass = bodies%inertia(body)
    else
      mass = bodies%principal(component - 3, body)
    end if
    inverse = 0
    if (mass > 0) inverse = 1/mass
  end function free_inverse

  !> Add imposed forces and pressures of a step that begins at `time`: (1 - theta) f(t) + theta f(t + h).
  pure subroutine drive_forces(drives, pressures, bodies, time, time_step, theta)
    type(drive_t), intent(in) :: drives(:) !! all drives of the scene
    type(pressure_t), intent(in) :: pressures(:) !! all pressures of the scene
    type(bodies_t), intent(inout) :: bodies !! forces to add to
    real(wp), intent(in) :: time !! beginning of the step [s]
    real(wp), intent(in) :: time_step !! length of the step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    integer :: i, n
    real(wp) :: mean

    do i = 1, size(drives)
      if (drives(i)%is_velocity .or. drives(i)%component > bodies%n_velocity) cycle
      if (.not. drives(i)%value%acts(time + time_step/2)) cycle
      mean = (1 - theta)*drives(i)%value%at(time) + theta*drives(i)%value%at(time + time_step)
      associate (force => bodies%force(drives(i)%component, drives(i)%body))
        force = force + mean
      end associate
    end do
    do i = 1, size(pressures)
      if (.not. pressures(i)%value%acts(time + time_step/2)) cycle
      mean = (1 - theta)*pressures(i)%value%at(time) + theta*pressures(i)%value%at(time + time_step)
      n = bodies%dimension
      associate (force => bodies%force(:n, pressures(i)%body))
        if (all(pressures(i)%chain > 0)) then
          force(:2) = force(:2) + mean*half_segments(pressures(i)%chain, bodies)
        else
          force = force + mean*pressed_length(pressures(i), bodies)*pressures(i)%direction(:n)
        end if
      end associate
    end do
  end subroutine drive_forces

  !> Force of a unit pressure on a body of a chain [m]: half of the way from the body before it to the one after it, turned left.
  !! Summed up over a chain it is that of the pressure on the whole polygon.
  pure function half_segments(chain, bodies) result(force)
    integer, intent(in) :: chain(2)
    type(bodies_t), intent(in) :: bodies
    real(wp) :: force(2), way(2)

    way = (bodies%position(:2, chain(2)) - bodies%position(:2, chain(1)))/2
    force = [-way(2), way(1)]
  end function half_segments

  !> Length on which a pressure acts [m], in space area [m2].
  pure real(wp) function pressed_length(pressure, bodies) result(length)
    type(pressure_t), intent(in) :: pressure
    type(bodies_t), intent(in) :: bodies
    real(wp) :: across(2)

    length = pressure%length
    if (bodies%dimension == 3 .and. .not. length > 0) length = area_between(pressure, bodies)
    if (any(pressure%between == 0)) return
    across = [-pressure%direction(2), pressure%direction(1)]
    length = abs(dot_product(bodies%position(:, pressure%between(2)) - bodies%position(:, pressure%between(1)), across)) &
             - pressure%thickness
  end function pressed_length

  !> Area between the bodies that bound it, across a push along an axis [m2].
  pure real(wp) function area_between(pressure, bodies) result(area)
    type(pressure_t), intent(in) :: pressure
    type(bodies_t), intent(in) :: bodies
    real(wp) :: length
    integer :: axis

    area = 1
    do axis = 1, 3
      if (abs(pressure%direction(axis)) > 0) cycle
      length = pressure%side_length(axis)
      associate (side => pressure%sides(:, axis))
        if (all(side > 0)) length = length + abs(bodies%position(axis, side(2)) - bodies%position(axis, side(1)))
      end associate
      area = area*max(0.0_wp, length)
    end do
  end function area_between

  !> Set the imposed velocities of the end of a step.
  pure subroutine drive_velocities(drives, bodies, time, time_step)
    type(drive_t), intent(in) :: drives(:) !! all drives of the scene
    type(bodies_t), intent(inout) :: bodies !! free velocities to set
    real(wp), intent(in) :: time !! end of the step [s]
    real(wp), intent(in) :: time_step !! length of the step [s]
    integer :: i, pass

    ! Several drives may take turns on one component: those that act come last.
    do pass = 1, 2
      do i = 1, size(drives)
        if (.not. drives(i)%is_velocity .or. drives(i)%component > bodies%n_velocity) cycle
        associate (velocity => bodies%free_velocity(drives(i)%component, drives(i)%body))
          if (drives(i)%value%acts(time - time_step/2)) then
            if (pass == 2) velocity = drives(i)%value%at(time)
          else if (pass == 1 .and. .not. drives(i)%is_released) then
            velocity = drives(i)%rest
          end if
        end associate
      end do
    end do
  end subroutine drive_velocities
end module sg_drives
