!> Reads what the COMMAND.DAT of a DATBOX holds in clear: time step, theta, number of steps, period, criterion and tolerance.
!!
!! The file is the script of older versions of LMGC90: commands in columns 1 to 30, values in the lines behind them.
module sg_datbox_command
  use sg_datbox_lines, only: columns, datbox_file_t, go_to, next_line, open_datbox_file
  use sg_datbox_settings, only: datbox_settings_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_numerals, only: read_integer, read_real
  use sg_text, only: to_text
  use sg_words, only: short_real
  implicit none
  private
  public :: read_command_file

  !> Columns of a command
  integer, parameter :: width = 30

contains

  !> Take keys of a deck from COMMAND.DAT; without the file there are none.
  subroutine read_command_file(folder, settings, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(datbox_settings_t), intent(inout) :: settings !! keys found, added to those that are there
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    type(datbox_file_t) :: file

    call open_datbox_file(file, folder, 'COMMAND.DAT', .false., diagnostics)
    do while (next_line(file))
      select case (command(file))
      case ('TIME STEP')
        call take_real(file, 'time.step', settings)
      case ('THETA')
        call take_real(file, 'time.theta', settings)
      case ('PERIODIC CONDITION')
        call take_real(file, 'scene.period_x', settings)
      case ('NLGS CHECK TYPE')
        call take_criterion(file, settings)
      end select
    end do
    call take_steps(file, settings)
  end subroutine read_command_file

  !> Command of the present line, or whatever stands in its place.
  function command(file)
    type(datbox_file_t), intent(in) :: file
    character(len=:), allocatable :: command

    command = trim(adjustl(columns(file, 1, width)))
  end function command

  !> Where the present line stands, for the deck.
  function place(file)
    type(datbox_file_t), intent(in) :: file
    character(len=:), allocatable :: place

    place = 'COMMAND.DAT:'//to_text(file%at)
  end function place

  !> Take a number from the next line.
  subroutine take_real(file, key, settings)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: key
    type(datbox_settings_t), intent(inout) :: settings
    real(wp) :: value
    logical :: is_number

    if (.not. next_line(file)) return
    call read_real(command(file), value, is_number)
    if (is_number) call settings%put(key, short_real(value), place(file))
  end subroutine take_real

  !> Take criterion and tolerance, which share a line, and relaxation from the next one. The sweeps stand in loops and labels, which
  !! are not followed.
  subroutine take_criterion(file, settings)
    type(datbox_file_t), intent(inout) :: file
    type(datbox_settings_t), intent(inout) :: settings
    character(len=:), allocatable :: line, criterion
    real(wp) :: tolerance
    logical :: is_number

    if (.not. next_line(file)) return
    line = command(file)
    select case (line(:min(5, len(line))))
    case ('Quad')
      criterion = 'quad'
    case ('Maxm')
      criterion = 'maxm'
    case ('QM/16')
      criterion = 'qm16'
    case default
      return
    end select
    call read_real(trim(adjustl(line(min(6, len(line) + 1):))), tolerance, is_number)
    if (.not. is_number) return
    call settings%put('solver.method', '"nlgs"', place(file))
    call settings%put('solver.criterion', '"'//criterion//'"', place(file))
    call settings%put('solver.tolerance', short_real(tolerance), place(file))
    call take_real(file, 'solver.relaxation', settings)
  end subroutine take_criterion

  !> Take the number of steps from the loop around INCREMENT STEP, `REPETE n FOIS`, `DEPUIS label`: what stands between the label
  !! and the loop is done once, and then n times more.
  subroutine take_steps(file, settings)
    type(datbox_file_t), intent(inout) :: file
    type(datbox_settings_t), intent(inout) :: settings
    character(len=:), allocatable :: line
    integer :: increment, found, repeats
    logical :: is_number

    call go_to(file, 0)
    if (.not. finds(file, 'INCREMENT STEP')) return
    increment = file%at
    do while (next_line(file))
      line = command(file)
      if (index(line, 'REPETE ') /= 1 .or. index(line, ' FOIS') < 8) cycle
      call read_integer(trim(adjustl(line(8:index(line, ' FOIS') - 1))), repeats, is_number)
      found = file%at
      if (.not. is_number .or. .not. next_line(file)) cycle
      line = command(file)
      if (index(line, 'DEPUIS ') /= 1) cycle
      call go_to(file, 0)
      if (finds(file, trim(adjustl(line(8:)))) .and. file%at < increment) then
        call settings%put('time.steps', to_text(repeats + 1), 'COMMAND.DAT:'//to_text(found))
        return
      end if
      call go_to(file, found)
    end do
  end subroutine take_steps

  !> Go to the next line that is this command or label; false at the end of the file.
  logical function finds(file, wanted)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: wanted

    finds = .true.
    do while (next_line(file))
      if (command(file) == wanted) return
    end do
    finds = .false.
  end function finds
end module sg_datbox_command
