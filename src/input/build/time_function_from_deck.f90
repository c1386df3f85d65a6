!> A function of time from the keys of a block: number, expression, formula, file of columns, beginning and end.
module sg_time_function_from_deck
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_evolution_file, only: read_evolution_file
  use sg_expression_parser, only: parse_expression
  use sg_kinds, only: wp, pi
  use sg_text, only: append_word, text_t
  use sg_time_functions, only: time_function_t
  use sg_values, only: from_setting, value_t
  use sg_words, only: short_real
  implicit none
  private
  public :: read_time_function, read_formula, path_in_deck

  !> Times at most at which an expression is looked at, and its largest size
  integer, parameter :: most_samples = 100000
  real(wp), parameter :: largest_size = 1e50_wp

contains

  !> Read the function of time of a block.
  subroutine read_time_function(deck, b, value, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the keys
    type(time_function_t), intent(out) :: value !! the function
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    if (deck%is_given(b, 'start')) value%start = deck%number(b, 'start')
    if (deck%is_given(b, 'end')) value%finish = deck%number(b, 'end')
    if (.not. value%finish > value%start) call deck%complain(diagnostics, 'the end is not after the start', b, 'end')
    call read_formula(deck, b, 'value', value, diagnostics)
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
    if (.not. deck%blocks(b)%is_of_stage) return
    value%origin = deck%stage_time
    if (deck%is_given(b, 'start')) value%start = value%start + value%origin
    if (deck%is_given(b, 'end')) value%finish = value%finish + value%origin
  end subroutine read_time_function

  !> Read a number or an expression of time.
  subroutine read_formula(deck, b, key, value, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the key
    character(len=*), intent(in) :: key !! name of the key
    type(time_function_t), intent(inout) :: value !! its constant or its expression is set
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(value_t) :: given
    type(text_t), allocatable :: time(:)
    character(len=:), allocatable :: mistake
    integer :: column

    given = deck%value(b, key)
    if (given%n_words == 0) then
      value%constant = given%numbers(1)
      return
    end if
    call append_word(time, 't')
    allocate (value%expression)
    call parse_expression(given%words(1)%s, time, value%expression, mistake, column)
    if (.not. allocated(mistake)) then
      call bound_expression(deck, b, value, mistake)
      column = 1
    end if
    if (.not. allocated(mistake)) return
    deallocate (value%expression)
    if (given%origin == from_setting) then
      call deck%complain(diagnostics, mistake, b, key)
    else
      ! Behind the quotation mark
      call deck%complain_at(diagnostics, mistake, given%word_places(1, 1), given%word_places(2, 1) + column)
    end if
  end subroutine read_formula

  !> Bound the size of an expression: its largest value at the ends of all steps in which it acts, rounded up to a quarter of a
  !! power of two, so that a run with more steps of a periodic function has the same bound.
  subroutine bound_expression(deck, b, value, mistake)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(time_function_t), intent(inout) :: value
    character(len=:), allocatable, intent(out) :: mistake !! set where it has no value
    real(wp) :: step, time, size, largest
    integer :: i, steps, every

    step = deck%number(deck%block_of('time'), 'step')
    steps = deck%integer(deck%block_of('time'), 'steps')
    if (deck%blocks(b)%is_of_stage) steps = deck%stage_steps
    every = 1 + steps/most_samples
    largest = 0
    do i = 0, steps, every
      time = step*real(i, wp)
      if (time < value%start .or. time > value%finish) cycle
      size = value%expression%at([time])
      if (ieee_is_nan(size)) then
        mistake = 'this expression has no value at t = '//short_real(time)//' s'
        return
      end if
      largest = max(largest, abs(size))
    end do
    if (largest > largest_size) mistake = 'this expression is larger than '//short_real(largest_size)
    if (largest > 0) value%expression_bound = 2.0_wp**(real(ceiling(4*log(largest)/log(2.0_wp)), wp)/4)
  end subroutine bound_expression

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

    if (deck%is_given(b, 'column')) then
      call read_evolution_file(path_in_deck(deck, deck%word(b, 'file')), .false., value, fault, diagnostics, &
                               deck%integer(b, 'column'))
    else
      call read_evolution_file(path_in_deck(deck, deck%word(b, 'file')), .true., value, fault, diagnostics)
    end if
    value%is_sum = allocated(value%expression) .or. max(abs(value%constant), abs(value%amplitude)) > 0
    if (fault /= '') call deck%complain(diagnostics, fault, b, 'file')
    if (.not. allocated(value%times)) return
    if (value%times(1) > 0) call deck%warn(diagnostics, 'the table begins at '//short_real(value%times(1))// &
                                           ' s: its first value holds from the start', b, 'file')
  end subroutine read_table
end module sg_time_function_from_deck
