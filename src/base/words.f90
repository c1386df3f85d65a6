!> Values as TOML writes them, and lists of words.
module sg_words
  use sg_kinds, only: wp
  use sg_text, only: text_t, to_text
  implicit none
  private
  public :: short_real, quoted_string, true_or_false, choices_of, is_choice, list_choices, choice_index

contains

  !> A number in the fewest digits that read back as the same double, such as `0.5` or `1e-3`.
  pure function short_real(value) result(word)
    real(wp), intent(in) :: value !! finite number
    character(len=:), allocatable :: word
    character(len=:), allocatable :: digits
    real(wp) :: back
    integer :: n, power, cut

    if (.not. abs(value) > 0) then
      word = '0.0'
      return
    end if
    do n = 2, 17
      digits = to_text(abs(value), n)
      read (digits, *) back
      if (abs(back - abs(value)) <= 0) exit
    end do
    cut = index(digits, 'E')
    read (digits(cut + 1:), *) power
    digits = without_zeros(digits(1:1)//digits(3:cut - 1))
    word = placed(digits, power)
    if (value < 0) word = '-'//word
  end function short_real

  !> Digits without the zeros at their end.
  pure function without_zeros(digits) result(kept)
    character(len=*), intent(in) :: digits
    character(len=:), allocatable :: kept

    kept = digits(:max(1, verify(digits, '0', back=.true.)))
  end function without_zeros

  !> Digits with their decimal point: d.ddd times ten to a power.
  pure function placed(digits, power) result(word)
    character(len=*), intent(in) :: digits
    integer, intent(in) :: power
    character(len=:), allocatable :: word
    character(len=7) :: padded

    if (power < -3 .or. power > 6) then
      word = digits(1:1)
      if (len(digits) > 1) word = word//'.'//digits(2:)
      word = word//'e'//to_text(power)
    else if (power < 0) then
      word = '0.000'
      word = word(:1 - power)//digits
    else if (len(digits) > power + 1) then
      word = digits(:power + 1)//'.'//digits(power + 2:)
    else
      padded = digits//'000000'
      word = padded(:power + 1)//'.0'
    end if
  end function placed

  !> A text as TOML string, with quotes and control characters escaped.
  pure function quoted_string(text) result(quoted)
    character(len=*), intent(in) :: text !! any text
    character(len=:), allocatable :: quoted
    character(len=6) :: code
    integer :: i

    quoted = '"'
    do i = 1, len(text)
      if (text(i:i) == '"' .or. text(i:i) == '\') then
        quoted = quoted//'\'//text(i:i)
      else if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) then
        write (code, '("\u",z4.4)') iachar(text(i:i))
        quoted = quoted//code
      else
        quoted = quoted//text(i:i)
      end if
    end do
    quoted = quoted//'"'
  end function quoted_string

  !> A logical as TOML writes it.
  pure function true_or_false(flag) result(word)
    logical, intent(in) :: flag !! the logical
    character(len=:), allocatable :: word

    word = trim(merge('true ', 'false', flag))
  end function true_or_false

  !> Words with a bar between two, as the key table writes choices.
  pure function choices_of(words) result(choices)
    character(len=*), intent(in) :: words(:) !! the words
    character(len=:), allocatable :: choices
    integer :: i

    choices = trim(words(1))
    do i = 2, size(words)
      choices = choices//'|'//trim(words(i))
    end do
  end function choices_of

  !> Is a word one of the choices?
  pure logical function is_choice(word, choices)
    character(len=*), intent(in) :: word !! word to look for
    character(len=*), intent(in) :: choices !! words with a bar between two

    is_choice = index('|'//trim(choices)//'|', '|'//word//'|') > 0
  end function is_choice

  !> Position of a word among the choices; 0 when it is none of them.
  pure integer function choice_index(word, choices) result(position)
    character(len=*), intent(in) :: word !! word to look for
    character(len=*), intent(in) :: choices !! words with a bar between two
    type(text_t), allocatable :: words(:)

    call list_choices(choices, words)
    do position = 1, size(words)
      if (words(position)%s == word) return
    end do
    position = 0
  end function choice_index

  !> The choices as a list.
  pure subroutine list_choices(choices, words)
    character(len=*), intent(in) :: choices !! words with a bar between two
    type(text_t), allocatable, intent(out) :: words(:) !! the words
    integer :: i, n, first

    n = 1
    do i = 1, len_trim(choices)
      if (choices(i:i) == '|') n = n + 1
    end do
    allocate (words(n))
    first = 1
    do n = 1, size(words)
      i = index(choices(first:), '|')
      if (i == 0) i = len_trim(choices) - first + 2
      words(n)%s = choices(first:first + i - 2)
      first = first + i
    end do
  end subroutine list_choices
end module sg_words
