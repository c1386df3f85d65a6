!> What a body's block of BODIES.DAT holds before it is turned into the scene's terms, and the numbers such blocks hold.
module sg_datbox_blocks
  use sg_datbox_lines, only: complain, datbox_file_t, go_to, next_data_line
  use sg_datbox_numbers, only: real_field
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_text, only: to_text
  implicit none
  private
  public :: block_t, triple, read_size, read_triple, read_point, complain_block

  !> Columns of up to three numbers of a line
  integer, parameter :: triple(3) = [35, 56, 77]

  !> What a body's block holds
  type :: block_t
    !> Number in order of appearance, body of the scene that it becomes, and line on which the block begins
    integer :: number = 0, body = 0, line = 0
    !> Which sections have been seen
    logical :: has_bulk = .false., has_node = .false.
    !> Nothing in the block was wrong so far
    logical :: ok = .true.
    !> Bulk material, and the radii of mass and of gyration [m]
    integer :: material = 0
    real(wp) :: mass_radius = 0, gyration_radius = 0
    !> In space, principal moments of volume [m5]; zero where they come from the shapes
    real(wp) :: moments(3) = 0
    !> Node: x, y [m] and angle [rad]; in space x, y, z [m]
    real(wp) :: node(3) = 0
    !> In space, axes of the shape that was read last, as columns in the frame of the file
    real(wp) :: frame(3, 3) = 0
    !> Is its velocity imposed in all components, so that it needs no mass?
    logical :: is_held = .false.
    !> Contactors of the scene before those of this body
    integer :: before = 0
  end type block_t

contains

  !> Read a length: not negative, or positive.
  subroutine read_size(file, first, length, is_positive, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file at its line
    integer, intent(in) :: first !! first column of the number
    real(wp), intent(out) :: length !! [m]
    logical, intent(in) :: is_positive !! must it be positive?
    logical, intent(inout) :: ok !! turned false when the number is wrong
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    logical :: good

    good = .true.
    call real_field(file, first, length, good, diagnostics)
    if (good .and. is_positive .and. .not. length > 0) then
      call complain(file, 'a size must be positive', first, diagnostics)
      good = .false.
    else if (good .and. length < 0) then
      call complain(file, 'a size must not be negative', first, diagnostics)
      good = .false.
    end if
    ok = ok .and. good
  end subroutine read_size

  !> Read up to three numbers of the present line.
  subroutine read_triple(file, values, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file at its line
    real(wp), intent(out) :: values(:) !! the numbers, at most three
    logical, intent(inout) :: ok !! turned false when one is wrong
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: i

    do i = 1, size(values)
      call real_field(file, triple(i), values(i), ok, diagnostics)
    end do
  end subroutine read_triple

  !> Read up to three numbers of the next line.
  subroutine read_point(file, what, point, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file before its line
    character(len=*), intent(in) :: what !! what the line should hold, for the message
    real(wp), intent(out) :: point(:) !! the numbers, at most three
    logical, intent(inout) :: ok !! turned false when one is wrong or there is no line
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    point = 0
    if (next_data_line(file, what, diagnostics)) then
      call read_triple(file, point, ok, diagnostics)
    else
      ok = .false.
    end if
  end subroutine read_point

  !> Report a mistake about a body as a whole, at its first line.
  subroutine complain_block(file, block, message, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT; its place stays
    type(block_t), intent(in) :: block !! the body's block
    character(len=*), intent(in) :: message !! what is wrong with it, after "body N "
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: at

    at = file%at
    call go_to(file, block%line)
    call complain(file, 'body '//to_text(block%number)//' '//message, 0, diagnostics)
    call go_to(file, max(file%at, at))
  end subroutine complain_block
end module sg_datbox_blocks
