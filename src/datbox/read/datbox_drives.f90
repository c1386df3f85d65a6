!> DRV_DOF.DAT of a DATBOX: imposed velocities and forces, by formula or by an evolution file.
module sg_datbox_drives
  use sg_datbox_bodies, only: body_type
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, digest_of, go_to, keyword, name_field, next_data_line, &
                             next_in_block, next_line, open_datbox_file, pass_over, remark
  use sg_datbox_numbers, only: integer_field, real_field
  use sg_drives, only: drive_t, mark_walls, pressure_t
  use sg_error, only: diagnostics_t
  use sg_evolution_file, only: read_evolution_file
  use sg_kinds, only: wp, i4, i8
  use sg_lists, only: reserve
  use sg_local_numbers, only: local_body
  use sg_scene, only: scene_t
  use sg_share, only: share_t
  use sg_sorting, only: sort_permutation
  use sg_text, only: to_text
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: read_drives, bodies_driven, bodies_held, read_body_number

contains

  !> Numbers of the bodies that have drives; mistakes are reported when these are read.
  subroutine bodies_driven(folder, dimension, n_bodies, numbers)
    character(len=*), intent(in) :: folder !! DATBOX folder
    integer, intent(in) :: dimension !! 2 or 3
    integer, intent(in) :: n_bodies !! number of bodies
    integer(i4), allocatable, intent(out) :: numbers(:) !! in the order of the file, perhaps more than once
    type(datbox_file_t) :: file
    type(diagnostics_t) :: unheard
    integer :: n, number

    call open_datbox_file(file, folder, 'DRV_DOF.DAT', .false., unheard)
    n = 0
    do while (next_line(file))
      if (keyword(file) /= 'bdyty') cycle
      call read_body_number(file, dimension, n_bodies, number, unheard)
      if (number == 0) cycle
      n = n + 1
      call reserve(numbers, n)
      numbers(n) = int(number, i4)
    end do
    if (.not. allocated(numbers)) allocate (numbers(0))
    numbers = numbers(:n)
  end subroutine bodies_driven

  !> Numbers of the bodies whose velocity is imposed in all components, by the last block of each; mistakes are reported when
  !! drives are read.
  subroutine bodies_held(folder, dimension, n_bodies, numbers)
    character(len=*), intent(in) :: folder !! DATBOX folder
    integer, intent(in) :: dimension !! 2 or 3
    integer, intent(in) :: n_bodies !! number of bodies
    integer(i4), allocatable, intent(out) :: numbers(:) !! ascending
    type(datbox_file_t) :: file
    type(diagnostics_t) :: unheard
    logical :: is_held(merge(3, 6, dimension == 2)), ok
    integer(i8), allocatable :: keys(:)
    integer(i4), allocatable :: order(:)
    logical, allocatable :: is_whole(:)
    integer :: component, number, n, i

    call open_datbox_file(file, folder, 'DRV_DOF.DAT', .false., unheard)
    n = 0
    do while (next_line(file))
      if (keyword(file) == 'bdyty') n = n + 1
    end do
    allocate (keys(n), is_whole(n))
    call go_to(file, 0)
    n = 0
    do while (next_line(file))
      if (keyword(file) == 'bdyty') then
        call read_body_number(file, dimension, n_bodies, number, unheard)
        is_held = .false.
        n = n + 1
        keys(n) = int(number, i8)
        is_whole(n) = .false.
      else if (n > 0 .and. name_field(file, 2) == 'vlocy') then
        ok = .true.
        call integer_field(file, 9, 13, component, ok, unheard)
        if (component >= 1 .and. component <= size(is_held)) is_held(component) = .true.
        is_whole(n) = all(is_held) .and. keys(n) > 0
      end if
    end do
    ! Of blocks of one body, which stand in the order of the file, the last counts.
    order = sort_permutation(keys(:n))
    do i = 1, n - 1
      if (keys(order(i)) == keys(order(i + 1))) is_whole(order(i)) = .false.
    end do
    numbers = int(keys(pack(order, is_whole(order))), i4)
  end subroutine bodies_held

  !> Read all drives; driven bodies are no grains, except those that are held in a plane.
  subroutine read_drives(folder, scene, share, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! scene with its bodies, all that are driven; gets the drives
    type(share_t), intent(inout) :: share !! what this rank keeps of them
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(datbox_file_t) :: file
    ! Row 0: is there a block of this body? Else the components whose velocity it imposes.
    logical, allocatable :: is_driven(:, :)
    integer :: n

    call open_datbox_file(file, folder, 'DRV_DOF.DAT', .false., diagnostics)
    call share%census%mix(digest_of(file))
    if (file%n == 0) call diagnostics%warn('no drive: the file is missing or empty', file=file%path)
    n = 0
    do while (next_line(file))
      if (any(name_field(file, 2) == ['vlocy', 'force'])) n = n + 1
    end do
    if (allocated(scene%drives)) deallocate (scene%drives)
    allocate (scene%drives(n))
    allocate (is_driven(0:merge(3, 6, scene%dimension == 2), scene%bodies%n), source=.false.)
    call go_to(file, 0)
    n = 0
    do while (next_line(file))
      if (keyword(file) == 'bdyty') then
        call read_block(file, folder, scene, share%all, n, is_driven, diagnostics)
      else
        call pass_over(file, 'outside bodies', diagnostics)
      end if
    end do
    scene%drives = scene%drives(:n)
    call mark_walls(scene%drives, [pressure_t ::], scene%bodies)
  end subroutine read_drives

  !> Read the drives of one body, from $bdyty to $$$$$$.
  subroutine read_block(file, folder, scene, n_bodies, n, is_driven, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: folder
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n_bodies
    integer, intent(inout) :: n
    logical, intent(inout) :: is_driven(0:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(drive_t) :: drive
    character(len=5) :: section
    integer :: number
    logical :: ok

    call read_body_number(file, scene%dimension, n_bodies, number, diagnostics)
    drive%body = local_body(scene%bodies, int(number, i4))
    if (drive%body > 0) call drop_earlier(file, scene, number, drive%body, n, is_driven, diagnostics)
    section = ''
    do while (next_in_block(file, diagnostics))
      if (keyword(file) /= '') then
        section = keyword(file)
      else if (section == 'dofty') then
        call read_drive(file, folder, scene%dimension, drive, ok, diagnostics)
        if (.not. ok .or. drive%body == 0) cycle
        if (drive%is_velocity) then
          if (is_driven(drive%component, drive%body)) then
            call complain(file, 'this velocity has been imposed before', 2, diagnostics)
          end if
          is_driven(drive%component, drive%body) = .true.
        end if
        n = n + 1
        scene%drives(n) = drive
        if (.not. drive%is_velocity) scene%bodies%is_grain(drive%body) = .false.
      end if
    end do
  end subroutine read_block

  !> Drop the drives that an earlier block gave a body: the last block counts, as in LMGC90.
  subroutine drop_earlier(file, scene, number, body, n, is_driven, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: number, body
    integer, intent(inout) :: n
    logical, intent(inout) :: is_driven(0:, :)
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: i, kept

    if (.not. is_driven(0, body)) then
      is_driven(0, body) = .true.
      return
    end if
    kept = 0
    do i = 1, n
      if (scene%drives(i)%body == body) cycle
      kept = kept + 1
      scene%drives(kept) = scene%drives(i)
    end do
    n = kept
    is_driven(1:, body) = .false.
    scene%bodies%is_grain(body) = .true.
    call remark(file, 'second block', 'body '//to_text(number)//' has drives in an earlier block, which this one replaces, as in ' &
                //'LMGC90', 9, diagnostics)
  end subroutine drop_earlier

  !> Read the line with the number of the body that a block describes; 0 and a mistake when there is no such body.
  subroutine read_body_number(file, dimension, n_bodies, body, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file at $bdyty
    integer, intent(in) :: dimension !! 2 or 3
    integer, intent(in) :: n_bodies !! number of bodies
    integer, intent(out) :: body !! number of the body
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    logical :: ok

    body = 0
    if (.not. next_data_line(file, 'the number of a body', diagnostics)) return
    if (name_field(file, 2) /= body_type(dimension)) then
      call complain_once(file, name_field(file, 2), 'bodies of type '''//name_field(file, 2)//''' are not done: this DATBOX ' &
                         //'holds '//body_type(dimension)//', rigid', 2, diagnostics)
      return
    end if
    ok = .true.
    call integer_field(file, 9, 15, body, ok, diagnostics)
    if (.not. ok) return
    if (body >= 1 .and. body <= n_bodies) return
    call complain(file, 'there is no body '//to_text(body)//': BODIES.DAT holds '//to_text(n_bodies), 9, diagnostics)
    body = 0
  end subroutine read_body_number

  !> Read one imposed velocity or force.
  subroutine read_drive(file, folder, dimension, drive, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: folder
    integer, intent(in) :: dimension
    type(drive_t), intent(inout) :: drive
    logical, intent(out) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: kind

    ok = .false.
    kind = name_field(file, 2)
    if (kind /= 'vlocy' .and. kind /= 'force') then
      call complain(file, 'a drive is either ''vlocy'' or ''force'', not '''//kind//'''', 2, diagnostics)
      return
    end if
    drive%is_velocity = kind == 'vlocy'
    ok = .true.
    call integer_field(file, 9, 13, drive%component, ok, diagnostics)
    if (.not. ok) return
    if (drive%component < 1 .or. drive%component > merge(3, 6, dimension == 2)) then
      if (dimension == 2) then
        call complain(file, 'a body of the plane has components 1 (x), 2 (y) and 3 (rotation)', 9, diagnostics)
      else
        call complain(file, 'a body in space has components 1, 2, 3 (x, y, z) and 4, 5, 6 (rotation about its axes)', 9, &
                      diagnostics)
      end if
      ok = .false.
      return
    end if
    if (name_field(file, 15, 9) == 'evolution') then
      call read_evolution(file, folder, drive%value, ok, diagnostics)
    else
      call read_formula(file, drive%value, ok, diagnostics)
    end if
  end subroutine read_drive

  !> Read constant, amplitude, pulsation, phase and ramp.
  subroutine read_formula(file, value, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(time_function_t), intent(out) :: value
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics

    call real_field(file, 15, value%constant, ok, diagnostics)
    call real_field(file, 30, value%amplitude, ok, diagnostics)
    call real_field(file, 45, value%omega, ok, diagnostics)
    call real_field(file, 60, value%phase, ok, diagnostics)
    call real_field(file, 75, value%ramp_start, ok, diagnostics)
    call real_field(file, 90, value%ramp_rate, ok, diagnostics)
    if (.not. ok .or. max(abs(value%ramp_start), abs(value%ramp_rate)) > 0) return
    if (.not. max(abs(value%constant), abs(value%amplitude)) > 0) return
    call remark(file, 'no ramp', 'this drive is always zero: its ramp, the last two numbers, multiplies the rest', &
                     75, diagnostics)
  end subroutine read_formula

  !> Read the two columns, time and value, of the evolution file named in the present line.
  subroutine read_evolution(file, folder, value, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: folder
    type(time_function_t), intent(out) :: value
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: fault
    integer :: mistakes

    ok = .false.
    if (name_field(file, 25, 40) == '') then
      call complain(file, 'the name of the evolution file is missing', 25, diagnostics)
      return
    end if
    mistakes = diagnostics%count()
    call read_evolution_file(trim(folder)//'/'//name_field(file, 25, 40), .false., value, fault, diagnostics)
    if (fault /= '') call complain(file, fault, 25, diagnostics)
    value%goes_on = .true.
    ok = diagnostics%count() == mistakes
  end subroutine read_evolution
end module sg_datbox_drives
