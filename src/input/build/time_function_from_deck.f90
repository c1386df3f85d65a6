!> A function of time from the keys of a block: formula, or file of two columns.
module sg_time_function_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_evolution_file, only: read_evolution_file
  use sg_kinds, only: wp, pi
  use sg_time_functions, only: time_function_t
  use sg_words, only: short_real
  implicit none
  private
  public :: read_time_function, path_in_deck

contains

  !> Read the function of time of a block.
  subroutine read_time_function(deck, b, value, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the keys
    type(time_function_t), intent(out) :: value !! the function
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    value%constant = deck%number(b, 'value')
    value%amplitude = deck%number(b, 'amplitude')
    value%omega = 2*pi*deck%number(b, 'frequency')
    value%phase = deck%number(b, 'phase')
    value%ramp_start = deck%number(b, 'ramp_start')
    value%ramp_rate = deck%number(b, 'ramp_rate')
    if (deck%is_given(b, 'omega')) then
      value%omega = deck%number(b, 'omega')
      if (deck%is_given(b, 'frequency')) &
        call deck%complain(diagnostics, 'give either "frequency" or "omega", not both', b, 'omega')
    end if
    if (deck%is_given(b, 'file')) call read_table(deck, b, value, diagnostics)
  end subroutine read_time_function

  !> A path of the deck, relative to the folder of the deck unless it begins with a slash.
  pure function path_in_deck(deck, path) result(full)
    type(deck_t), intent(in) :: deck !! the deck
    character(len=*), intent(in) :: path !! as the deck writes it
    character(len=:), allocatable :: full

    full = deck%folder//path
    if (path(1:min(1, len(path))) == '/') full = path
  end function path_in_deck

  !> Read the table of the file that a block names.
  subroutine read_table(deck, b, value, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(time_function_t), intent(inout) :: value
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: fault

    call read_evolution_file(path_in_deck(deck, deck%word(b, 'file')), .true., value, fault, diagnostics)
    if (fault /= '') call deck%complain(diagnostics, fault, b, 'file')
    if (.not. allocated(value%times)) return
    if (value%times(1) > 0) call deck%warn(diagnostics, 'the table begins at '//short_real(value%times(1))// &
                                           ' s: its first value holds from the start', b, 'file')
  end subroutine read_table
end module sg_time_function_from_deck
