!> Drives and pressures: those of the blocks drive and pressure, and those that fixed bodies and walls imply.
!!
!! A wall holds still, or keeps the velocity of its block, in every component that no [[drive]] or [[pressure]] takes.
module sg_drives_from_deck
  use sg_blocks, only: deck_t
  use sg_called_bodies, only: count_called, find_called
  use sg_drives, only: drive_t, mark_walls, pressure_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: local_body
  use sg_pressures_from_deck, only: add_pressures, press_container, press_wall
  use sg_scene, only: scene_t
  use sg_time_function_from_deck, only: read_time_function
  use sg_words, only: choice_index
  implicit none
  private
  public :: drives_from_deck, bodies_held

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
    call make_room(scene%drives, scene%pressures, n_drives + count_called(deck, 'drive') + size(is_taken, 1)*n_held, &
                   n_pressures + count_called(deck, 'pressure') + deck%count_of('wall') + &
                   3*deck%count_of('container'))
    do b = 1, deck%n
      if (deck%is_in(b, 'drive')) call add_drives(deck, b, scene, n_drives, is_taken, diagnostics)
    end do
    do b = 1, deck%n
      if (deck%is_in(b, 'pressure')) call add_pressures(deck, b, scene, n_pressures, is_taken, diagnostics)
    end do
    do b = 1, deck%n
      if (.not. is_held(deck, b)) cycle
      if (deck%is_in(b, 'wall')) then
        if (deck%is_given(b, 'pressure')) &
          call press_wall(deck, b, local_body(scene%bodies, int(deck%blocks(b)%first_body, i4)), scene, n_pressures, is_taken, &
                          diagnostics)
      end if
      if (deck%is_in(b, 'container')) call press_container(deck, b, scene, n_pressures, is_taken, diagnostics)
      do n = deck%blocks(b)%first_body, deck%blocks(b)%last_body
        if (is_between(deck, b, n)) cycle
        call hold(scene, local_body(scene%bodies, int(n, i4)), n_drives, is_taken)
      end do
    end do
    scene%drives = scene%drives(:n_drives)
    scene%pressures = scene%pressures(:n_pressures)
    call mark_walls(scene%drives, scene%pressures, scene%bodies)
  end subroutine drives_from_deck

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

  !> The drives of a [[drive]] block: one per body that it calls.
  subroutine add_drives(deck, b, scene, n, is_taken, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    logical, intent(inout) :: is_taken(:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
    integer, allocatable :: bodies(:)
    type(drive_t) :: drive
    integer :: i

    call find_called(deck, b, scene, bodies, diagnostics)
    if (scene%dimension == 2) then
      drive%component = choice_index(deck%word(b, 'component'), 'x|y|rotation')
    else
      drive%component = choice_index(deck%word(b, 'component'), 'x|y|z|rotation_x|rotation_y|rotation_z')
    end if
    drive%is_velocity = deck%word(b, 'kind') == 'velocity'
    call read_time_function(deck, b, drive%value, diagnostics)
    do i = 1, size(bodies)
      drive%body = bodies(i)
      call add_drive(deck, b, scene, n, is_taken, drive, diagnostics)
    end do
  end subroutine add_drives

  !> The drive of one body.
  subroutine add_drive(deck, b, scene, n, is_taken, drive, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    integer, intent(inout) :: n
    logical, intent(inout) :: is_taken(:, :)
    type(drive_t), intent(inout) :: drive
    type(diagnostics_t), intent(inout) :: diagnostics

    if (drive%is_velocity .and. is_taken(drive%component, drive%body)) then
      if (is_driven_then(scene%drives(:n), drive)) &
        call deck%complain(diagnostics, 'this component of the body is driven twice at a time', b, 'component')
    end if
    drive%is_released = .true.
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
