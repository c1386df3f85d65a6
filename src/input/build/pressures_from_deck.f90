!> Pressures from the blocks of a deck: `[[pressure]]`, the key of a `[[wall]]`, and the stresses of a `[[container]]`.
module sg_pressures_from_deck
  use sg_blocks, only: deck_t
  use sg_called_bodies, only: body_of, find_called
  use sg_contactors, only: kind_segment
  use sg_drives, only: drive_t, pressure_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: local_body
  use sg_scene, only: scene_t
  use sg_time_function_from_deck, only: read_formula, read_time_function
  use sg_values, only: value_t
  use sg_walls_from_deck, only: planes, thickness_of_container
  implicit none
  private
  public :: add_pressures, press_container, press_wall

contains

  !> Add the pressures of a [[pressure]] block: one per body that it calls.
  subroutine add_pressures(deck, b, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block
    type(scene_t), intent(inout) :: scene !! scene with its bodies and drives, and room for the pressures
    integer, intent(inout) :: n !! pressures so far
    logical, intent(inout) :: is_taken(:, :) !! components that drives and pressures take, shape (components, bodies)
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    integer, allocatable :: bodies(:)
    type(pressure_t) :: pressure
    real(wp) :: direction(3)
    integer :: i

    call find_called(deck, b, scene, bodies, diagnostics)
    call read_time_function(deck, b, pressure%value, diagnostics)
    if (deck%is_given(b, 'chain')) then
      call press_chain(deck, b, bodies, pressure, scene, n, is_taken, diagnostics)
      return
    else if (.not. deck%is_given(b, 'direction')) then
      call deck%complain(diagnostics, 'a pressure needs the key "direction", or "chain"', b)
      return
    end if
    direction = deck%vector(b, 'direction')
    if (scene%dimension == 3) then
      if (deck%is_given(b, 'area')) pressure%length = deck%number(b, 'area')
    else if (deck%is_given(b, 'length') .eqv. deck%is_given(b, 'between')) then
      call deck%complain(diagnostics, 'a pressure needs either "length" or "between"', b)
    end if
    if (deck%is_given(b, 'length')) pressure%length = deck%number(b, 'length')
    if (deck%is_given(b, 'between')) call read_between(deck, b, scene, pressure, diagnostics)
    if (.not. norm2(direction) > 0) then
      call deck%complain(diagnostics, 'the direction has no length', b, 'direction')
      return
    end if
    pressure%direction = direction/norm2(direction)
    do i = 1, size(bodies)
      call add_pressure(deck, b, bodies(i), direction, pressure, scene, n, is_taken, diagnostics)
    end do
  end subroutine add_pressures

  !> Press the bodies of a chain, which are the corners of a polygon.
  subroutine press_chain(deck, b, bodies, common, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, bodies(:)
    type(pressure_t), intent(in) :: common !! what the pressures of a block have in common
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    logical, intent(inout) :: is_taken(:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=*), parameter :: replaced(3) = [character(len=9) :: 'direction', 'length', 'between']
    logical :: is_closed
    integer :: i, k, last

    is_closed = deck%word(b, 'chain') == 'closed'
    last = size(bodies)
    do k = 1, size(replaced)
      if (deck%is_given(b, trim(replaced(k)))) &
        call deck%complain(diagnostics, 'a pressure on a chain has no "'//trim(replaced(k))//'"', b, trim(replaced(k)))
    end do
    if (any([scene%period, scene%period_y] > 0)) then
      call deck%complain(diagnostics, 'a pressure on a chain does not work in periodic scenes', b, 'chain')
    else if (last < merge(3, 2, is_closed)) then
      call deck%complain(diagnostics, trim(merge('a closed chain needs three bodies or more', &
                                                 'an open chain needs two bodies or more   ', is_closed)), b, 'body')
    else
      do i = 1, last
        n = n + 1
        scene%pressures(n) = common
        scene%pressures(n)%body = bodies(i)
        scene%pressures(n)%chain = bodies([max(i - 1, 1), min(i + 1, last)])
        if (is_closed) scene%pressures(n)%chain = bodies([modulo(i - 2, last) + 1, modulo(i, last) + 1])
      end do
      is_taken(:2, bodies) = .true.
    end if
  end subroutine press_chain

  !> The pressure on one body.
  subroutine add_pressure(deck, b, body, direction, common, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, body
    real(wp), intent(in) :: direction(3)
    type(pressure_t), intent(in) :: common !! what the pressures of a block have in common
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    logical, intent(inout) :: is_taken(:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(pressure_t) :: pressure

    pressure = common
    pressure%body = body
    if (scene%dimension == 3 .and. .not. deck%is_given(b, 'area')) &
      call bound_by_container(deck, b, scene, direction, pressure, diagnostics)
    call warn_of_no_effect(deck, b, pressure, scene%drives, diagnostics)
    where (abs(direction(:scene%dimension)) > 0) is_taken(:scene%dimension, pressure%body) = .true.
    n = n + 1
    scene%pressures(n) = pressure
  end subroutine add_pressure

  !> The two bodies between which a pressure acts.
  subroutine read_between(deck, b, scene, pressure, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene
    type(pressure_t), intent(inout) :: pressure
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: bodies
    integer :: i, c

    bodies = deck%value(b, 'between')
    do i = 1, 2
      pressure%between(i) = body_of(deck, b, 'between', bodies%words(i)%s, scene, diagnostics)
    end do
    if (any(pressure%between == 0)) return
    if (pressure%between(1) == pressure%between(2)) &
      call deck%complain(diagnostics, '"between" needs two different bodies', b, 'between')
    do i = 1, 2
      c = findloc(scene%contactors%body(:scene%contactors%n), pressure%between(i), 1)
      if (scene%contactors%kind(c) == kind_segment) then
        pressure%thickness = pressure%thickness + scene%contactors%segment_size(2, scene%contactors%row(c))
      else
        call deck%complain(diagnostics, '"between" needs walls or segments', b, 'between')
      end if
    end do
  end subroutine read_between

  !> Add the pressure on a [[wall]].
  subroutine press_wall(deck, b, body, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block
    integer, intent(in) :: body !! its body
    type(scene_t), intent(inout) :: scene !! scene with its bodies and drives, and room for the pressure
    integer, intent(inout) :: n !! pressures so far
    logical, intent(inout) :: is_taken(:, :) !! components that drives and pressures take, shape (components, bodies)
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(pressure_t) :: pressure
    real(wp) :: direction(3)

    if (.not. deck%is_given(b, 'direction')) then
      call deck%complain(diagnostics, 'a pressed wall needs the key "direction"', b, 'pressure')
      return
    end if
    direction = deck%vector(b, 'direction')
    if (count(abs(direction) > 0) /= 1) then
      if (scene%dimension == 2) then
        call deck%complain(diagnostics, 'a wall is pressed along x or along y: one number of the direction is 0, the other not', &
                           b, 'direction')
      else
        call deck%complain(diagnostics, 'a wall is pressed along x, y or z: one number of the direction is not 0, the others are', &
                           b, 'direction')
      end if
      return
    end if
    pressure%body = body
    pressure%direction = sign(merge(1.0_wp, 0.0_wp, abs(direction) > 0), direction)
    call read_formula(deck, b, 'pressure', pressure%value, diagnostics)
    if (deck%is_given(b, 'between')) then
      call read_between(deck, b, scene, pressure, diagnostics)
    else if (scene%dimension == 2) then
      pressure%length = norm2(deck%pair(b, 'to') - deck%pair(b, 'from'))
    else
      pressure%length = product(deck%pair(b, 'size'))
    end if
    call warn_of_no_effect(deck, b, pressure, scene%drives, diagnostics)
    where (abs(direction(:scene%dimension)) > 0) is_taken(:scene%dimension, body) = .true.
    n = n + 1
    scene%pressures(n) = pressure
  end subroutine press_wall

  !> Warn of a pressure that pushes along a component whose velocity is imposed.
  subroutine warn_of_no_effect(deck, b, pressure, drives, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(pressure_t), intent(in) :: pressure
    type(drive_t), intent(in) :: drives(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=*), parameter :: letters = 'xyz'
    integer :: i

    do i = 1, size(drives)
      if (.not. drives(i)%is_velocity .or. drives(i)%body /= pressure%body .or. &
          drives(i)%component > len(letters)) cycle
      if (.not. abs(pressure%direction(drives(i)%component)) > 0) cycle
      call deck%warn(diagnostics, 'the velocity of this body along '//letters(drives(i)%component:drives(i)%component)// &
                     ' is imposed: the pressure has no effect there', b, 'direction')
    end do
  end subroutine warn_of_no_effect

  !> Let a pressure act on the present area of a plane of a container. Along an axis with two planes that is the distance of their
  !! faces, along others the length of the room: the period, or that of the deck where a side is open.
  subroutine bound_by_container(deck, b, scene, direction, pressure, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck; its blocks hold their bodies
    integer, intent(in) :: b !! block of the pressure
    type(scene_t), intent(in) :: scene !! scene with its bodies
    real(wp), intent(in) :: direction(3) !! of the push
    type(pressure_t), intent(inout) :: pressure !! pressure with its body; gets what bounds its area
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=*), parameter :: letters = 'xyz'
    integer, allocatable :: list(:, :)
    integer :: number, container, axis, i

    number = pressure%body
    if (allocated(scene%bodies%id)) number = scene%bodies%id(number)
    container = deck%block_of_body(number)
    ! Bodies of a DATBOX come from no block.
    if (container > 0) then
      if (.not. deck%is_in(container, 'container')) container = 0
    end if
    if (container == 0) then
      call deck%complain(diagnostics, 'this pressure needs the key "area": its body is no plane of a [[container]]', b)
      return
    end if
    list = planes(deck, container, [scene%period, scene%period_y])
    axis = list(1, number - deck%blocks(container)%first_body + 1)
    if (any(abs(direction) > 0 .neqv. [(i == axis, i=1, 3)])) then
      call deck%complain(diagnostics, 'a plane of a [[container]] is pressed along its normal, '//letters(axis:axis)// &
                         ': another direction needs the key "area"', b, 'direction')
      return
    end if
    call bound_by_planes(deck, container, scene, list, pressure)
  end subroutine bound_by_container

  !> Let a pressure act on the area between the planes of a container.
  subroutine bound_by_planes(deck, container, scene, list, pressure)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: container, list(:, :)
    type(scene_t), intent(in) :: scene
    type(pressure_t), intent(inout) :: pressure
    integer :: axis, plane, i

    pressure%side_length = deck%vector(container, 'size')
    do axis = 1, 3
      associate (pair => pack([(plane, plane=1, size(list, 2))], list(1, :) == axis))
        if (size(pair) < 2) cycle
        pressure%sides(:, axis) = [(local_body(scene%bodies, int(deck%blocks(container)%first_body + pair(i) - 1, i4)), i=1, 2)]
        pressure%side_length(axis) = -thickness_of_container(deck, container)
      end associate
    end do
  end subroutine bound_by_planes

  !> Press the upper planes of a container by the stresses that its block asks for, unless something else moves them along the axis.
  subroutine press_container(deck, container, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck; its blocks hold their bodies
    integer, intent(in) :: container !! block of the container
    type(scene_t), intent(inout) :: scene !! scene with its bodies and room for pressures
    integer, intent(inout) :: n !! pressures so far
    logical, intent(inout) :: is_taken(:, :) !! components of bodies that drives and pressures take
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=*), parameter :: keys(3) = ['stress_xx', 'stress_yy', 'stress_zz']
    character(len=*), parameter :: needs(3) = [character(len=62) :: &
      'planes at both sides: sides = true, and no period along x', 'planes at both sides: sides = true, and no period along y', &
      'a lid: lid = true']
    type(pressure_t) :: pressure
    integer, allocatable :: list(:, :)
    integer :: axis, plane

    if (.not. any([(deck%is_given(container, keys(axis)), axis=1, 3)])) return
    list = planes(deck, container, [scene%period, scene%period_y])
    do axis = 1, 3
      if (.not. deck%is_given(container, keys(axis))) cycle
      plane = findloc(list(1, :) == axis .and. list(2, :) == 2, .true., 1)
      if (plane == 0) then
        call deck%complain(diagnostics, keys(axis)//' needs '//trim(needs(axis)), container, keys(axis))
        cycle
      end if
      pressure = pressure_t()
      pressure%body = local_body(scene%bodies, int(deck%blocks(container)%first_body + plane - 1, i4))
      pressure%direction(axis) = -1
      call read_formula(deck, container, keys(axis), pressure%value, diagnostics)
      if (is_taken(axis, pressure%body)) cycle
      call bound_by_planes(deck, container, scene, list, pressure)
      is_taken(axis, pressure%body) = .true.
      n = n + 1
      scene%pressures(n) = pressure
    end do
  end subroutine press_container
end module sg_pressures_from_deck
