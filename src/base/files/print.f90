!> Lines on standard output, written so that an output that takes none (a full disk, a closed pipe) is noticed.
!!
!! They go to the system at once: gfortran's gives no status for a write that fails when its buffer is emptied, and keeps what it
!! could not write until the buffer overflows, which ends the program.
module sg_print
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_size_t
  use, intrinsic :: iso_fortran_env, only: output_unit
  use sg_c_library, only: c_write
  implicit none
  private
  public :: has_print_failed, print_line

  !> Standard output, as the system numbers it
  integer(c_int), parameter :: descriptor = 1

  ! Standard output is one for the whole program, and so is its state.
  logical, save :: has_failed = .false.

contains

  !> Print a line, or several with line ends between them.
  subroutine print_line(text, unit, is_open)
    character(len=*), intent(in) :: text !! the line, without its end
    integer, intent(in), optional :: unit !! open unit to print on, standard output unless given
    logical, intent(in), optional :: is_open !! does what is printed next belong to the same line?
    logical :: ends

    ends = .true.
    if (present(is_open)) ends = .not. is_open
    if (present(unit)) then
      if (unit /= output_unit) then
        if (ends) write (unit, '(a)') text
        if (.not. ends) write (unit, '(a)', advance='no') text
        flush (unit)
        return
      end if
    end if
    if (ends) call write_all(text//new_line('a'))
    if (.not. ends) call write_all(text)
  end subroutine print_line

  !> Hand text to the system; nothing more once that has failed.
  subroutine write_all(text)
    character(len=*), intent(in) :: text
    integer :: done
    integer(c_intptr_t) :: written

    done = 0
    do while (done < len(text) .and. .not. has_failed)
      written = c_write(descriptor, text(done + 1:), int(len(text) - done, c_size_t))
      has_failed = written <= 0
      done = done + int(written)
    end do
  end subroutine write_all

  !> Could something not be printed?
  logical function has_print_failed()
    has_print_failed = has_failed
  end function has_print_failed
end module sg_print
