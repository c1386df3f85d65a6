!> Drives and pressures: those of the blocks drive and pressure, and those that fixed bodies and walls imply.
!!
!! A wall holds still, or keeps the velocity of its block, in every component that no [[drive]] or [[pressure]] takes.
module sg_drives_from_deck
  use sg_ascending, only: distinct
  use sg_blocks, only: deck_t
  use sg_container_area, only: bound_by_container
  use sg_contactors, only: kind_segment
  use sg_drives, only: drive_t, mark_walls, pressure_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: local_body
  use sg_named_bodies, only: number_named
  use sg_scene, only: scene_t
  use sg_text, only: text_t, to_text
  use sg_time_function_from_deck, only: read_formula, read_time_function
  use sg_values, only: value_t
  use sg_words, only: choice_index
  implicit none
  private
  public :: drives_from_deck, numbers_called, bodies_held, body_of

contains

  !> Add drives and pressures to those that the scene has, and mark the bodies that are no grains.
  subroutine drives_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    logical, allocatable :: is_taken(:, :)
    integer :: n_drives, n_pressures, n_held, b, i, n

    if (.not. allocated(scene%drives)) allocate (scene%drives(0))
    if (.not. allocated(scene%pressures)) allocate (scene%pressures(0))
    n_drives = size(scene%drives)
    n_pressures = size(scene%pressures)
    n_held = 0
    do b = 1, deck%n
      if (is_held(deck, b)) n_held = n_held + deck%blocks(b)%last_body - deck%blocks(b)%first_body + 1
    end do
    allocate (is_taken(scene%bodies%n_velocity, scene%bodies%n), source=.false.)
    do i = 1, n_drives
      if (scene%drives(i)%is_velocity) is_taken(scene%drives(i)%component, scene%drives(i)%body) = .true.
    end do
    call make_room(scene%drives, scene%pressures, n_drives + deck%count_of('drive') + size(is_taken, 1)*n_held, &
                   n_pressures + deck%count_of('pressure') + deck%count_of('wall'))
    do b = 1, deck%n
      if (deck%is_in(b, 'drive')) call add_drive(deck, b, scene, n_drives, is_taken, diagnostics)
    end do
    do b = 1, deck%n
      if (deck%is_in(b, 'pressure')) call add_pressure(deck, b, scene, n_pressures, is_taken, diagnostics)
    end do
    do b = 1, deck%n
      if (.not. is_held(deck, b)) cycle
      if (deck%is_in(b, 'wall')) then
        if (deck%is_given(b, 'pressure')) &
          call press_wall(deck, b, local_body(scene%bodies, int(deck%blocks(b)%first_body, i4)), scene, n_pressures, is_taken, &
                          diagnostics)
      end if
      do n = deck%blocks(b)%first_body, deck%blocks(b)%last_body
        if (is_between(deck, b, n)) cycle
        call hold(scene, local_body(scene%bodies, int(n, i4)), n_drives, is_taken)
      end do
    end do
    scene%drives = scene%drives(:n_drives)
    scene%pressures = scene%pressures(:n_pressures)
    call mark_walls(scene%drives, scene%pressures, scene%bodies)
  end subroutine drives_from_deck

  !> Numbers of the bodies that a deck calls, by number or by name, ascending, each once.
  subroutine numbers_called(deck, called)
    type(deck_t), intent(in) :: deck !! checked deck
    integer(i4), allocatable, intent(out) :: called(:) !! numbers, positive
    integer(i4), allocatable :: found(:)
    type(value_t) :: value
    character(len=*), parameter :: keys(3) = [character(len=7) :: 'body', 'between', 'bodies']
    integer :: b, k, i, number, status

    allocate (found(0))
    do b = 1, deck%n
      do k = 1, size(keys)
        if (.not. (deck%is_in(b, 'drive') .or. deck%is_in(b, 'pressure') .or. deck%is_in(b, 'wall') .or. &
                   deck%is_in(b, 'link'))) cycle
        if (.not. deck%is_given(b, trim(keys(k)))) cycle
        value = deck%value(b, trim(keys(k)))
        do i = 1, value%n_words
          if (index(value%words(i)%s, '#') == 1) then
            read (value%words(i)%s(2:), *, iostat=status) number
            if (status /= 0) cycle
          else
            number = number_named(deck, value%words(i)%s)
          end if
          if (number > 0) found = [found, int(number, i4)]
        end do
      end do
    end do
    called = distinct(found)
  end subroutine numbers_called

  !> Numbers of the bodies that hold still where nothing drives them.
  subroutine bodies_held(deck, held)
    type(deck_t), intent(in) :: deck !! checked deck; its blocks hold their bodies
    integer(i4), allocatable, intent(out) :: held(:) !! numbers
    integer :: b, i, n, pass

    do pass = 1, 2
      n = 0
      do b = 1, deck%n
        if (.not. is_held(deck, b)) cycle
        do i = deck%blocks(b)%first_body, deck%blocks(b)%last_body
          if (is_between(deck, b, i)) cycle
          n = n + 1
          if (pass == 2) held(n) = int(i, i4)
        end do
      end do
      if (pass == 1) allocate (held(n))
    end do
  end subroutine bodies_held

  !> Is a body one of an arch's between the two ends, which alone are held?
  pure logical function is_between(deck, b, body)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, body

    is_between = deck%is_in(b, 'arch') .and. body > deck%blocks(b)%first_body .and. body < deck%blocks(b)%last_body
  end function is_between

  !> Does a block make bodies that hold still where nothing drives them?
  logical function is_held(deck, b)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b

    is_held = deck%is_in(b, 'wall') .or. deck%is_in(b, 'container')
    if (deck%is_in(b, 'body')) is_held = deck%flag(b, 'fixed')
    if (deck%is_in(b, 'arch')) is_held = deck%flag(b, 'fixed_ends')
  end function is_held

  !> Lengthen both lists, keeping what they hold.
  subroutine make_room(drives, pressures, n_drives, n_pressures)
    type(drive_t), allocatable, intent(inout) :: drives(:)
    type(pressure_t), allocatable, intent(inout) :: pressures(:)
    integer, intent(in) :: n_drives, n_pressures
    type(drive_t), allocatable :: more_drives(:)
    type(pressure_t), allocatable :: more_pressures(:)

    allocate (more_drives(n_drives), more_pressures(n_pressures))
    more_drives(:size(drives)) = drives
    more_pressures(:size(pressures)) = pressures
    call move_alloc(more_drives, drives)
    call move_alloc(more_pressures, pressures)
  end subroutine make_room

  !> The drive of a [[drive]] block.
  subroutine add_drive(deck, b, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    logical, intent(inout) :: is_taken(:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: body
    type(drive_t) :: drive

    body = deck%value(b, 'body')
    drive%body = body_of(deck, b, 'body', body%words(1)%s, scene, diagnostics)
    if (scene%dimension == 2) then
      drive%component = choice_index(deck%word(b, 'component'), 'x|y|rotation')
    else
      drive%component = choice_index(deck%word(b, 'component'), 'x|y|z|rotation_x|rotation_y|rotation_z')
    end if
    drive%is_velocity = deck%word(b, 'kind') == 'velocity'
    call read_time_function(deck, b, drive%value, diagnostics)
    if (drive%body == 0) return
    if (drive%is_velocity .and. is_taken(drive%component, drive%body)) then
      if (is_driven_then(scene%drives(:n), drive)) &
        call deck%complain(diagnostics, 'this component of the body is driven twice at a time', b, 'component')
    end if
    if (drive%value%is_timed()) call choose_rest(deck, scene, drive)
    is_taken(drive%component, drive%body) = .true.
    n = n + 1
    scene%drives(n) = drive
  end subroutine add_drive

  !> Is a component driven by other drives at a time at which this one acts?
  pure logical function is_driven_then(drives, drive)
    type(drive_t), intent(in) :: drives(:), drive
    integer :: i

    is_driven_then = .false.
    do i = 1, size(drives)
      if (.not. drives(i)%is_velocity .or. drives(i)%body /= drive%body .or. drives(i)%component /= drive%component) cycle
      is_driven_then = is_driven_then .or. (drives(i)%value%start < drive%value%finish .and. &
                                            drive%value%start < drives(i)%value%finish)
    end do
  end function is_driven_then

  !> What a component does outside the time of its drive: that of a body that is held keeps its velocity, others are free.
  subroutine choose_rest(deck, scene, drive)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(in) :: scene
    type(drive_t), intent(inout) :: drive
    integer :: b, number

    number = drive%body
    if (allocated(scene%bodies%id)) number = scene%bodies%id(drive%body)
    do b = 1, deck%n
      if (number < deck%blocks(b)%first_body .or. number > deck%blocks(b)%last_body) cycle
      if (is_held(deck, b) .and. .not. is_between(deck, b, number)) drive%is_released = .false.
    end do
    drive%rest = scene%bodies%velocity(drive%component, drive%body)
  end subroutine choose_rest

  !> Body that a deck means by a word: a name, or `#` and a number; 0 after a mistake.
  integer function body_of(deck, b, key, word, scene, diagnostics) result(body)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the word
    character(len=*), intent(in) :: key !! key of the word
    character(len=*), intent(in) :: word !! name or number
    type(scene_t), intent(in) :: scene !! scene with its bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: status

    if (word(1:min(1, len(word))) == '#') then
      read (word(2:), *, iostat=status) body
      if (status == 0) body = local_body(scene%bodies, int(body, i4))
      if (status == 0 .and. body > 0) return
      call deck%complain(diagnostics, 'there is no body '//word(2:)//': the scene has '// &
                         to_text(scene%bodies%n + deck%absent%n), b, key)
    else
      body = number_named(deck, word)
      if (body > 0) body = local_body(scene%bodies, int(body, i4))
      if (body > 0) return
      if (allocated(deck%names)) then
        call deck%complain_unknown(diagnostics, 'body', word, deck%names, b, key)
      else
        call deck%complain_unknown(diagnostics, 'body', word, [text_t ::], b, key)
      end if
    end if
    body = 0
  end function body_of

  !> The pressure of a [[pressure]] block.
  subroutine add_pressure(deck, b, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    logical, intent(inout) :: is_taken(:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: body
    type(pressure_t) :: pressure
    real(wp) :: direction(3)

    body = deck%value(b, 'body')
    pressure%body = body_of(deck, b, 'body', body%words(1)%s, scene, diagnostics)
    direction = deck%vector(b, 'direction')
    call read_time_function(deck, b, pressure%value, diagnostics)
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
    if (pressure%body == 0) return
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

  !> The pressure on a [[wall]].
  subroutine press_wall(deck, b, body, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, body
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    logical, intent(inout) :: is_taken(:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
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

  !> Keep the velocity that a body starts with in every component that nothing else takes.
  subroutine hold(scene, body, n, is_taken)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    integer, intent(inout) :: n
    logical, intent(in) :: is_taken(:, :)
    integer :: component

    do component = 1, size(is_taken, 1)
      if (is_taken(component, body)) cycle
      n = n + 1
      scene%drives(n)%body = body
      scene%drives(n)%component = component
      scene%drives(n)%is_velocity = .true.
      scene%drives(n)%value%constant = scene%bodies%velocity(component, body)
    end do
  end subroutine hold
end module sg_drives_from_deck
