!> DOF.INI of a DATBOX: step number, time, displacements and velocities; in space the frames of the bodies too.
module sg_datbox_state
  use sg_contactors, only: kind_cylinder, kind_plane
  use sg_datbox_blocks, only: read_point, read_triple, triple
  use sg_datbox_drives, only: read_body_number
  use sg_datbox_lines, only: complain_once, datbox_file_t, digest_of, keyword, name_field, next_in_block, next_line, &
                             open_datbox_file, pass_over
  use sg_datbox_numbers, only: integer_field, real_field
  use sg_datbox_space_bodies, only: read_frame
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: contactors_of_bodies, local_body
  use sg_rotations, only: frame_of, quaternion_of
  use sg_scene, only: scene_t
  use sg_share, only: share_t
  use sg_solid_bodies, only: move_body_frame
  implicit none
  private
  public :: read_state

contains

  !> Read step number, time, displacements and velocities; bodies that are not listed stay at rest. Of two states of one body the
  !! last counts, as in LMGC90.
  subroutine read_state(folder, scene, share, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! scene with bodies where BODIES.DAT puts them
    type(share_t), intent(inout) :: share !! what this rank keeps of them
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(datbox_file_t) :: file
    integer(i4), allocatable :: first(:), list(:)
    real(wp), allocatable :: moved(:, :)
    logical :: ok

    call open_datbox_file(file, folder, 'DOF.INI', .false., diagnostics)
    call share%census%mix(digest_of(file))
    if (file%n == 0) then
      call diagnostics%warn('no state: the file is missing or empty, bodies start at rest', file=file%path)
    end if
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    allocate (moved(3, scene%bodies%n), source=0.0_wp)
    do while (next_line(file))
      select case (keyword(file))
      case ('steps')
        ok = .true.
        call integer_field(file, 9, 15, scene%start_step, ok, diagnostics)
        call real_field(file, triple(1), scene%start_time, ok, diagnostics)
      case ('bdyty')
        call read_body_state(file, first, scene, moved, share, diagnostics)
      case default
        call pass_over(file, 'outside bodies', diagnostics)
      end select
    end do
    call share%states_are_read()
  end subroutine read_state

  !> Read the state of one body, from $bdyty to $$$$$$, and note it or drop it where another rank keeps the body.
  subroutine read_body_state(file, first, scene, moved, share, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer(i4), intent(in) :: first(:)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(inout) :: moved(:, :)
    type(share_t), intent(inout) :: share
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: displacement(3), speed
    integer :: number, body
    logical :: in_nodes, ok

    call read_body_number(file, scene%dimension, share%all, number, diagnostics)
    body = local_body(scene%bodies, int(number, i4))
    in_nodes = .false.
    do while (next_in_block(file, diagnostics))
      if (keyword(file) == 'nodty') in_nodes = .true.
      if (keyword(file) /= '') cycle
      if (.not. in_nodes .or. name_field(file, 2) == '') then
        call pass_over(file, 'without a node within a body', diagnostics)
      else if (scene%dimension == 3 .and. name_field(file, 2) == 'NO6xx') then
        call read_solid_state(file, first, body, scene, moved, displacement, speed, ok, diagnostics)
        if (ok .and. number > 0 .and. body == 0) call share%note_state(number, displacement, speed)
      else if (scene%dimension == 3) then
        call complain_once(file, 'node', 'the state of a body in space is that of its node, NO6xx', 2, diagnostics)
      else if (name_field(file, 2) == 'NO3xx') then
        call read_planar_state(file, body, scene, moved, displacement, speed, ok, diagnostics)
        if (ok .and. number > 0 .and. body == 0) call share%note_state(number, displacement(:2), speed)
      else
        call complain_once(file, 'node', 'the state of a body of the plane is that of its node, NO3xx', 2, diagnostics)
      end if
    end do
  end subroutine read_body_state

  !> Read displacement and velocity of a body of the plane.
  subroutine read_planar_state(file, body, scene, moved, displacement, speed, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: body
    type(scene_t), intent(inout) :: scene
    real(wp), intent(inout) :: moved(:, :)
    real(wp), intent(out) :: displacement(3), speed
    logical, intent(out) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: velocity(3)

    ok = .true.
    call read_triple(file, displacement, ok, diagnostics)
    call read_point(file, 'a velocity', velocity, ok, diagnostics)
    speed = norm2(velocity(:2))
    if (.not. ok .or. body == 0) return
    scene%bodies%position(:, body) = scene%bodies%position(:, body) + (displacement(1:2) - moved(1:2, body))
    scene%bodies%angle(body) = scene%bodies%angle(body) + (displacement(3) - moved(3, body))
    scene%bodies%velocity(:, body) = velocity
    moved(:, body) = displacement
  end subroutine read_planar_state

  !> Read displacement, velocity and frame of a body in space: its spin is about the axes of the frame.
  subroutine read_solid_state(file, first, body, scene, moved, displacement, speed, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer(i4), intent(in) :: first(:)
    integer, intent(in) :: body
    type(scene_t), intent(inout) :: scene
    real(wp), intent(inout) :: moved(:, :)
    real(wp), intent(out) :: displacement(3), speed
    logical, intent(out) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: rotation(3), velocity(6), frame(3, 3)

    ok = .true.
    velocity = 0
    call read_triple(file, displacement, ok, diagnostics)
    ! The rotations are summed up there and hold nothing that the frame does not hold better.
    if (ok) call read_point(file, 'a rotation', rotation, ok, diagnostics)
    if (ok) call read_point(file, 'a velocity', velocity(1:3), ok, diagnostics)
    if (ok) call read_point(file, 'a spin', velocity(4:6), ok, diagnostics)
    if (ok) call read_frame(file, frame, ok, diagnostics)
    speed = norm2(velocity(:3))
    if (.not. ok .or. body == 0) return
    scene%bodies%position(:, body) = scene%bodies%position(:, body) + (displacement - moved(:, body))
    moved(:, body) = displacement
    call turn_to(scene, body, first(body), first(body + 1) - 1, frame)
    scene%bodies%velocity(:, body) = velocity
  end subroutine read_solid_state

  !> Turn a body so that its principal axes are those of a frame.
  !!
  !! Which way LMGC90 points principal axes that are not those of the file, LAPACK decides: of the four ways that keep them
  !! right-handed the one is taken by which the body has turned least since BODIES.DAT.
  subroutine turn_to(scene, body, first, last, frame)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    integer(i4), intent(in) :: first, last
    real(wp), intent(in) :: frame(3, 3)
    real(wp), parameter :: signs(3, 4) = reshape([1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, &
                                                 -1.0_wp, -1.0_wp, 1.0_wp], [3, 4])
    real(wp) :: own(3, 3), flip(3, 3), along(3)
    integer :: k, way
    logical :: is_sure

    associate (orientation => scene%bodies%orientation(:, body))
      is_sure = .not. any(abs(orientation(2:4)) > 0)
      if (first == last) is_sure = is_sure .or. any(scene%contactors%kind(first) == [kind_plane, kind_cylinder])
      if (.not. is_sure) then
        own = frame_of(orientation)
        along = [(dot_product(own(:, k), frame(:, k)), k=1, 3)]
        way = maxloc(matmul(along, signs), 1)
        flip = 0
        do k = 1, 3
          flip(k, k) = signs(k, way)
        end do
        if (way > 1) call move_body_frame(scene%bodies, scene%contactors, body, int(first), int(last), &
                                          [0.0_wp, 0.0_wp, 0.0_wp], flip)
      end if
      orientation = quaternion_of(frame)
    end associate
  end subroutine turn_to
end module sg_datbox_state
