!> Parser of expressions: a text and the names of its variables become instructions (sg_expressions), or a mistake with its place.
!!
!! From the loosest to the tightest: `or`, `and`, `not`, comparisons, sums, products, signs, powers (`^` or `**`, from the right).
!! A name is a variable, `pi`, or a function; `name(argument)` is a variable too where the list of variables has that very word.
module sg_expression_parser
  use sg_expressions, only: do_add, do_and, do_at_least, do_at_most, do_divide, do_function, do_greater, do_less, do_multiply, &
                            do_negate, do_not, do_number, do_or, do_power, do_subtract, do_variable, expression_t, functions
  use sg_kinds, only: wp, pi
  use sg_text, only: nearest_word, append_word, text_t, to_text
  implicit none
  private
  public :: parse_expression

  !> Levels of binary operations, the loosest first; `not` stands between the second and the third, signs after the fifth
  integer, parameter :: or_level = 1, and_level = 2, comparison_level = 3, sum_level = 4, product_level = 5
  !> Brackets and signs within each other at most, and letters of a text
  integer, parameter :: most_nested = 50, most_letters = 2000

  !> A binary operation: how it is written, its level, its instruction
  type :: operation_t
    character(len=3) :: word
    integer :: level, instruction
  end type operation_t

  !> All of them; a word that begins with another comes before it
  type(operation_t), parameter :: operations(10) = [operation_t('or ', or_level, do_or), operation_t('and', and_level, do_and), &
    operation_t('<= ', comparison_level, do_at_most), operation_t('<  ', comparison_level, do_less), &
    operation_t('>= ', comparison_level, do_at_least), operation_t('>  ', comparison_level, do_greater), &
    operation_t('+  ', sum_level, do_add), operation_t('-  ', sum_level, do_subtract), &
    operation_t('*  ', product_level, do_multiply), operation_t('/  ', product_level, do_divide)]

  !> A text that is being parsed
  type :: parser_t
    character(len=:), allocatable :: text
    type(text_t), allocatable :: variables(:)
    !> Next letter, numbers on the stack, brackets around it
    integer :: place = 1, on_stack = 0, nested = 0
    type(expression_t) :: expression
    !> The first mistake and its place; unallocated where there is none
    character(len=:), allocatable :: mistake
    integer :: column = 0
  end type parser_t

contains

  !> Parse an expression.
  subroutine parse_expression(text, variables, expression, mistake, column)
    character(len=*), intent(in) :: text !! as it was written
    type(text_t), intent(in) :: variables(:) !! names that it may use
    type(expression_t), intent(out) :: expression !! complete where there is no mistake
    character(len=:), allocatable, intent(out) :: mistake !! what is wrong; unallocated where nothing is
    integer, intent(out) :: column !! place of the mistake in the text, from 1
    type(parser_t) :: parser

    parser%text = text
    parser%variables = variables
    parser%expression%text = text
    allocate (parser%expression%instruction(0), parser%expression%operand(0))
    if (len(text) > most_letters) then
      call stumble(parser, 'an expression has at most '//to_text(most_letters)//' letters', 1)
    else
      call read_level(parser, or_level)
    end if
    call skip_blanks(parser)
    if (.not. allocated(parser%mistake) .and. parser%place <= len(text)) &
      call stumble(parser, 'an operation should stand here', parser%place)
    column = parser%column
    if (allocated(parser%mistake)) then
      call move_alloc(parser%mistake, mistake)
      return
    end if
    expression = parser%expression
    associate (last => expression%instruction(size(expression%instruction)))
      expression%is_condition = any(last == [do_not, do_and, do_or, do_less, do_at_most, do_greater, do_at_least])
    end associate
  end subroutine parse_expression

  !> Read operations of a level and of all tighter ones.
  recursive subroutine read_level(parser, level)
    type(parser_t), intent(inout) :: parser
    integer, intent(in) :: level
    integer :: found

    if (allocated(parser%mistake)) return
    if (level > product_level) then
      call read_signed(parser)
      return
    end if
    if (level == comparison_level) then
      if (take_word(parser, 'not')) then
        call enter(parser)
        call read_level(parser, comparison_level)
        call emit(parser, do_not, 1)
        parser%nested = parser%nested - 1
        return
      end if
    end if
    call read_level(parser, level + 1)
    do while (.not. allocated(parser%mistake))
      found = operation_here(parser, level)
      if (found == 0) return
      call read_level(parser, level + 1)
      call emit(parser, operations(found)%instruction, 2)
      ! a < b < c would compare a truth with c.
      if (level == comparison_level) then
        if (operation_here(parser, level) > 0) call stumble(parser, 'a second comparison: join two by "and"', parser%place - 1)
        return
      end if
    end do
  end subroutine read_level

  !> Take an operation of a level, where one stands here; 0 where none does.
  integer function operation_here(parser, level) result(found)
    type(parser_t), intent(inout) :: parser
    integer, intent(in) :: level
    character(len=3) :: word

    call skip_blanks(parser)
    do found = 1, size(operations)
      if (operations(found)%level /= level) cycle
      word = operations(found)%word
      if (is_letter(word(1:1))) then
        if (take_word(parser, trim(word))) return
      else
        ! Two stars are a power, which binds tighter.
        if (is_next(parser, '**') .or. .not. is_next(parser, trim(word))) cycle
        parser%place = parser%place + len_trim(word)
        return
      end if
    end do
    found = 0
  end function operation_here

  !> Read signs, then a power.
  recursive subroutine read_signed(parser)
    type(parser_t), intent(inout) :: parser
    logical :: is_minus

    if (allocated(parser%mistake)) return
    call skip_blanks(parser)
    is_minus = is_next(parser, '-')
    if (is_minus .or. is_next(parser, '+')) then
      parser%place = parser%place + 1
      call enter(parser)
      call read_signed(parser)
      if (is_minus) call emit(parser, do_negate, 1)
      parser%nested = parser%nested - 1
      return
    end if
    call read_primary(parser)
    call skip_blanks(parser)
    if (allocated(parser%mistake) .or. .not. (is_next(parser, '^') .or. is_next(parser, '**'))) return
    parser%place = parser%place + merge(1, 2, is_next(parser, '^'))
    call enter(parser)
    call read_signed(parser)
    call emit(parser, do_power, 2)
    parser%nested = parser%nested - 1
  end subroutine read_signed

  !> Read a number, a name, a function, or brackets.
  recursive subroutine read_primary(parser)
    type(parser_t), intent(inout) :: parser
    character :: letter

    if (allocated(parser%mistake)) return
    if (parser%place > len(parser%text)) then
      call stumble(parser, 'the expression ends where a number or a name should stand', len(parser%text))
      return
    end if
    letter = parser%text(parser%place:parser%place)
    if (letter == '(') then
      parser%place = parser%place + 1
      call enter(parser)
      call read_level(parser, or_level)
      call close_bracket(parser)
      parser%nested = parser%nested - 1
    else if (scan(letter, '0123456789.') > 0) then
      call read_number(parser)
    else if (is_letter(letter)) then
      call read_name(parser)
    else
      call stumble(parser, 'a number or a name should stand here', parser%place)
    end if
  end subroutine read_primary

  !> Read a number: digits with or without a point, and an exponent.
  subroutine read_number(parser)
    type(parser_t), intent(inout) :: parser
    integer :: last, status, digits
    real(wp) :: number

    associate (text => parser%text, first => parser%place)
      last = first + span_of(text(first:), '0123456789.') - 1
      digits = last
      if (last < len(text)) then
        if (scan(text(last + 1:last + 1), 'eE') > 0) then
          last = last + 1
          if (last < len(text)) last = last + merge(1, 0, scan(text(last + 1:last + 1), '+-') > 0)
          last = last + span_of(text(last + 1:), '0123456789')
        end if
      end if
      status = 1
      if (scan(text(first:digits), '0123456789') > 0 .and. scan(text(last:last), '0123456789.') > 0 .and. last - first < 60) &
        read (text(first:last), *, iostat=status) number
      if (status == 0) status = merge(0, 1, abs(number) < 1e50_wp)
      if (status /= 0) then
        call stumble(parser, '"'//text(first:last)//'" is no number', first)
        return
      end if
      call emit(parser, do_number, 0, number)
      first = last + 1
    end associate
  end subroutine read_number

  !> Read a variable, a constant, or a function with its numbers.
  recursive subroutine read_name(parser)
    type(parser_t), intent(inout) :: parser
    character(len=:), allocatable :: name
    integer :: first, i, bracket

    first = parser%place
    name = word_at(parser%text, first)
    parser%place = first + len(name)
    do i = 1, size(functions)
      if (functions(i)%name /= name) cycle
      call read_arguments(parser, i)
      return
    end do
    if (parser%place <= len(parser%text)) then
      bracket = index(parser%text(parser%place:), ')')
      if (parser%text(parser%place:parser%place) == '(' .and. bracket > 0) then
        parser%place = parser%place + bracket
        name = part_of(parser%text, first, parser%place - 1)
      end if
    end if
    do i = 1, size(parser%variables)
      if (parser%variables(i)%s /= name) cycle
      call emit(parser, do_variable, 0, real(i, wp))
      return
    end do
    if (name == 'pi') then
      call emit(parser, do_number, 0, pi)
    else
      call stumble(parser, 'there is no "'//name//'" here'//hint(parser, name), first)
    end if
  end subroutine read_name

  !> The question that ends a message, where a name is near.
  function hint(parser, name) result(question)
    type(parser_t), intent(in) :: parser
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: question
    type(text_t), allocatable :: known(:)
    integer :: i

    known = parser%variables
    do i = 1, size(functions)
      call append_word(known, trim(functions(i)%name))
    end do
    call append_word(known, 'pi')
    question = nearest_word(name, known)
    if (question /= '') question = '; did you mean "'//question//'"?'
  end function hint

  !> Read the numbers of a function in their brackets.
  recursive subroutine read_arguments(parser, place)
    type(parser_t), intent(inout) :: parser
    integer, intent(in) :: place
    integer :: i

    call skip_blanks(parser)
    if (.not. is_next(parser, '(')) then
      call stumble(parser, 'the function '//trim(functions(place)%name)//' needs brackets', parser%place)
      return
    end if
    call enter(parser)
    do i = 1, functions(place)%arguments
      parser%place = parser%place + 1
      call read_level(parser, or_level)
      call skip_blanks(parser)
      if (i == functions(place)%arguments .or. allocated(parser%mistake)) exit
      if (is_next(parser, ',')) cycle
      call stumble(parser, 'the function '//trim(functions(place)%name)//' takes '//to_text(functions(place)%arguments)// &
                   ' numbers with commas between', parser%place)
    end do
    call close_bracket(parser)
    call emit(parser, do_function + place, functions(place)%arguments)
    parser%nested = parser%nested - 1
  end subroutine read_arguments

  !> Read a closing bracket.
  subroutine close_bracket(parser)
    type(parser_t), intent(inout) :: parser

    call skip_blanks(parser)
    if (.not. is_next(parser, ')')) call stumble(parser, 'a closing bracket should stand here', parser%place)
    parser%place = parser%place + 1
  end subroutine close_bracket

  !> Add an instruction that takes some numbers from the stack and puts one on it.
  subroutine emit(parser, instruction, taken, operand)
    type(parser_t), intent(inout) :: parser
    integer, intent(in) :: instruction, taken
    real(wp), intent(in), optional :: operand

    if (allocated(parser%mistake)) return
    associate (e => parser%expression)
      e%instruction = [e%instruction, instruction]
      e%operand = [e%operand, 0.0_wp]
      if (present(operand)) e%operand(size(e%operand)) = operand
      parser%on_stack = parser%on_stack + 1 - taken
      e%depth = max(e%depth, parser%on_stack)
    end associate
  end subroutine emit

  !> Note that one more bracket or sign is open.
  subroutine enter(parser)
    type(parser_t), intent(inout) :: parser

    parser%nested = parser%nested + 1
    if (parser%nested > most_nested) call stumble(parser, 'more than '//to_text(most_nested)//' brackets within each other', &
                                                  parser%place)
  end subroutine enter

  !> Note a mistake, if it is the first.
  subroutine stumble(parser, mistake, column)
    type(parser_t), intent(inout) :: parser
    character(len=*), intent(in) :: mistake
    integer, intent(in) :: column

    if (allocated(parser%mistake)) return
    parser%mistake = mistake
    parser%column = max(1, min(column, len(parser%text)))
  end subroutine stumble

  !> Take a word made of letters where it stands here as a whole.
  logical function take_word(parser, word)
    type(parser_t), intent(inout) :: parser
    character(len=*), intent(in) :: word

    call skip_blanks(parser)
    take_word = word_at(parser%text, parser%place) == word
    if (take_word) parser%place = parser%place + len(word)
  end function take_word

  !> The name that begins at a place: letters, digits, underscores; empty where none does.
  pure function word_at(text, place) result(word)
    character(len=*), intent(in) :: text
    integer, intent(in) :: place
    character(len=:), allocatable :: word
    integer :: last

    last = place - 1
    do while (last < len(text))
      last = last + 1
      if (is_letter(text(last:last))) cycle
      if (last > place .and. scan(text(last:last), '0123456789') > 0) cycle
      last = last - 1
      exit
    end do
    word = text(place:last)
  end function word_at

  !> Letters at the beginning of a text that all stand in a set.
  pure integer function span_of(text, set) result(n)
    character(len=*), intent(in) :: text, set

    n = verify(text, set) - 1
    if (n < 0) n = len(text)
  end function span_of

  !> Does a word stand here?
  pure logical function is_next(parser, word)
    type(parser_t), intent(in) :: parser
    character(len=*), intent(in) :: word

    is_next = .false.
    if (parser%place + len(word) - 1 <= len(parser%text)) &
      is_next = part_of(parser%text, parser%place, parser%place + len(word) - 1) == word
  end function is_next

  !> Some letters of a text.
  pure function part_of(text, first, last) result(part)
    character(len=*), intent(in) :: text
    integer, intent(in) :: first, last
    character(len=last - first + 1) :: part

    part = text(first:last)
  end function part_of

  !> Go on to the next letter that is no blank.
  subroutine skip_blanks(parser)
    type(parser_t), intent(inout) :: parser

    do while (is_next(parser, ' ') .or. is_next(parser, achar(9)))
      parser%place = parser%place + 1
    end do
  end subroutine skip_blanks

  !> May a name begin with this letter?
  pure logical function is_letter(letter)
    character, intent(in) :: letter

    is_letter = (letter >= 'a' .and. letter <= 'z') .or. (letter >= 'A' .and. letter <= 'Z') .or. letter == '_'
  end function is_letter
end module sg_expression_parser
