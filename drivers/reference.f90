!> `splitgrain reference`: the keys of decks as pages, as completion of words and in the manual page.
module sg_reference
  use sg_arguments, only: arguments_t
  use sg_error, only: error_t
  use sg_print, only: print_line
  use sg_reference_text, only: reference_text
  use sg_shell_texts, only: completion_text, manual_text
  implicit none
  private
  public :: reference_command

contains

  !> Print the deck reference, or what is generated from the same table.
  subroutine reference_command(arguments, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(error_t), allocatable, intent(out) :: error !! set when an option is unknown

    call arguments%expect('completion manual', 0, 0, 'reference [--completion|--manual]', error)
    if (allocated(error)) return
    if (arguments%has('completion')) then
      call print_line(completion_text(), is_open=.true.)
    else if (arguments%has('manual')) then
      call print_line(manual_text(), is_open=.true.)
    else
      call print_line(reference_text(), is_open=.true.)
    end if
  end subroutine reference_command
end module sg_reference
