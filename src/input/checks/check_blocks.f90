!> Checks of whole blocks: values that are complete, keys that apply, and those that are missing.
module sg_check_blocks
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_key_table, only: in_both, key_t
  use sg_text, only: lower, to_text
  use sg_values, only: finish_value
  use sg_words, only: is_choice
  implicit none
  private
  public :: check_blocks

contains

  !> Check all blocks.
  subroutine check_blocks(deck, diagnostics)
    type(deck_t), intent(in) :: deck !! deck of which all entries are taken
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: b

    do b = 1, deck%n
      associate (section => deck%table%sections(deck%blocks(b)%section))
        if (section%dimension /= in_both .and. section%dimension /= deck%dimension) then
          call deck%complain(diagnostics, deck%heading(deck%blocks(b)%section)//' needs scene.dimension = '// &
                             to_text(section%dimension), b)
          cycle
        end if
      end associate
      call check_values(deck, b, diagnostics)
      call check_missing(deck, b, diagnostics)
    end do
  end subroutine check_blocks

  !> Check the values that are given.
  subroutine check_values(deck, b, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: message
    integer :: i

    do i = 1, deck%blocks(b)%n
      associate (value => deck%blocks(b)%values(i), key => deck%table%keys(deck%blocks(b)%values(i)%key))
        if (value%is_bad) cycle
        call check_dimension(deck, key, message)
        if (.not. allocated(message)) call finish_value(value, key, deck%dimension, message)
        if (.not. allocated(message)) call check_use(deck, b, key, message)
        if (allocated(message)) call deck%complain(diagnostics, '"'//trim(key%name)//'" '//message, b, trim(key%name))
        if (.not. allocated(value%former)) cycle
        if (value%former == key%former_key) then
          call deck%warn(diagnostics, '"'//value%former//'" is a former key: it is "'//trim(key%section)//'.'// &
                         trim(key%name)//'" now', b, trim(key%name), kind='former key '//value%former)
        else
          call deck%warn(diagnostics, '"'//value%former//'" is a former word: it is "'//value%words(1)%s//'" now', b, &
                         trim(key%name), kind='former word')
        end if
      end associate
    end do
  end subroutine check_values

  !> Has a key a meaning in the dimension of the scene?
  pure subroutine check_dimension(deck, key, message)
    type(deck_t), intent(in) :: deck
    type(key_t), intent(in) :: key
    character(len=:), allocatable, intent(out) :: message

    if (key%dimension == in_both .or. key%dimension == deck%dimension) return
    message = 'has no meaning where scene.dimension = '//to_text(deck%dimension)
    if (key%twin /= '') message = message//'; did you mean "'//trim(key%twin)//'"?'
  end subroutine check_dimension

  !> Look for keys that must be given and are not.
  subroutine check_missing(deck, b, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: k

    associate (section => deck%table%sections(deck%blocks(b)%section))
      do k = section%first, section%last
        associate (key => deck%table%keys(k))
          if (.not. key%is_required) cycle
          if (deck%is_given(b, trim(key%name)) .or. .not. deck%applies(b, key)) cycle
          ! Stages have steps of their own.
          if (section%name == 'time' .and. key%name == 'steps' .and. deck%count_of('stage') > 0) cycle
          call deck%complain(diagnostics, deck%heading(deck%blocks(b)%section)//' lacks the key "'//trim(key%name)//'": '// &
                             first_sentence(key%sentence), b)
        end associate
      end do
    end associate
  end subroutine check_missing

  !> The first sentence of a text, to stand within another one.
  pure function first_sentence(text) result(sentence)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: sentence

    sentence = text(:index(text//' ', '. ') - 1)
    sentence(1:1) = lower(sentence(1:1))
  end function first_sentence

  !> Has a key that is given a meaning here? Not reported when the word that decides is itself wrong.
  subroutine check_use(deck, block, key, message)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    type(key_t), intent(in) :: key
    character(len=:), allocatable, intent(inout) :: message
    character(len=:), allocatable :: selector, word
    integer :: k

    if (deck%applies(block, key)) return
    selector = trim(key%selector)
    word = deck%word(block, selector)
    k = deck%table%find_key(deck%blocks(block)%section, selector)
    if (word == '') then
      message = 'has no meaning without the key "'//selector//'"'
    else if (is_choice(word, trim(deck%table%keys(k)%choices)//'|'//trim(deck%table%keys(k)%space_choices))) then
      message = 'has no meaning for '//selector//' = "'//word//'"'
    end if
  end subroutine check_use
end module sg_check_blocks
