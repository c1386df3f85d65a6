!> Values that are right one by one and make no sense: unusual sizes, keys that are ignored, keys that contradict each other.
!!
!! What cannot be meant is a mistake; what is unusual, or has no effect, is a warning.
module sg_sense_checks
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_key_table, only: key_t, value_logical
  use sg_kinds, only: wp
  use sg_text, only: to_text
  use sg_values, only: value_t
  use sg_words, only: is_choice, short_real, true_or_false
  implicit none
  private
  public :: check_sense, is_default

contains

  !> Check all blocks of a deck.
  subroutine check_sense(deck, diagnostics)
    type(deck_t), intent(in) :: deck !! deck whose values are right one by one
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    integer :: b, i

    do b = 1, deck%n
      do i = 1, deck%blocks(b)%n
        associate (value => deck%blocks(b)%values(i), key => deck%table%keys(deck%blocks(b)%values(i)%key))
          if (key%usual < huge(1.0_wp)) call check_size(deck, b, value, key, diagnostics)
          if (key%switch /= '' .and. .not. is_default(deck, value)) call check_switch(deck, b, key, diagnostics)
        end associate
      end do
      if (deck%is_in(b, 'body')) call check_fixed(deck, b, diagnostics)
      if (deck%is_in(b, 'law')) call check_frictions(deck, b, diagnostics)
    end do
    call check_tests(deck, deck%block_of('solver'), diagnostics)
    call check_trace(deck, deck%block_of('report'), diagnostics)
  end subroutine check_sense

  !> Does a value equal its default, as in effective decks?
  pure logical function is_default(deck, value)
    type(deck_t), intent(in) :: deck !! deck with the defaults of its keys
    type(value_t), intent(in) :: value !! value of a key

    associate (default => deck%defaults(value%key))
      is_default = default%n == value%n .and. default%n_words == value%n_words
      if (is_default .and. value%n > 0) is_default = .not. any(abs(default%numbers(:value%n) - value%numbers(:value%n)) > 0)
      if (is_default .and. value%n_words > 0) is_default = default%words(1)%s == value%words(1)%s
    end associate
  end function is_default

  !> Warn of a number beyond its usual size.
  subroutine check_size(deck, b, value, key, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(value_t), intent(in) :: value
    type(key_t), intent(in) :: key
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: largest

    largest = value%numbers(maxloc(abs(value%numbers(:value%n)), 1))
    if (abs(largest) <= key%usual) return
    call deck%warn(diagnostics, '"'//trim(key%name)//'" is '//trim(short_real(largest)//' '//key%unit)//'; '//trim(key%hint), b, &
                   trim(key%name), kind='unusual '//trim(key%name))
  end subroutine check_size

  !> Warn of a key that is ignored because of another key.
  subroutine check_switch(deck, b, key, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(key_t), intent(in) :: key
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: word, shown
    integer :: k, block

    ! The key that decides stands in the same block or in the one around it.
    block = b
    k = deck%table%find_key(deck%blocks(b)%section, trim(key%switch))
    if (k == 0) then
      block = deck%blocks(b)%parent
      k = deck%table%find_key(deck%blocks(block)%section, trim(key%switch))
    end if
    associate (switch => deck%table%keys(k))
      if (switch%kind == value_logical) then
        word = true_or_false(deck%flag(block, trim(switch%name)))
        shown = word
      else
        word = deck%word(block, trim(switch%name))
        shown = '"'//word//'"'
      end if
    end associate
    if (is_choice(word, trim(key%used_for))) return
    call deck%warn(diagnostics, '"'//trim(key%name)//'" is ignored with '//trim(key%switch)//' = '//shown, b, trim(key%name))
  end subroutine check_switch

  !> A fixed body has no velocity.
  subroutine check_fixed(deck, b, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=*), parameter :: keys(2) = [character(len=8) :: 'velocity', 'spin']
    integer :: i

    if (.not. deck%flag(b, 'fixed')) return
    do i = 1, size(keys)
      if (.not. any(abs(deck%vector(b, trim(keys(i)))) > 0)) cycle
      call deck%complain(diagnostics, 'a fixed body has no '//trim(keys(i))//'; a body is moved by a [[drive]]', b, trim(keys(i)))
    end do
  end subroutine check_fixed

  !> Static friction is no smaller than dynamic friction.
  subroutine check_frictions(deck, b, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: friction(2)
    character(len=*), parameter :: keys(2) = [character(len=16) :: 'static_friction', 'dynamic_friction']
    integer :: i

    if (.not. deck%applies(b, deck%table%keys(deck%table%find_key(deck%blocks(b)%section, trim(keys(1)))))) return
    do i = 1, 2
      friction(i) = deck%number(b, 'friction')
      if (deck%is_given(b, trim(keys(i)))) friction(i) = deck%number(b, trim(keys(i)))
    end do
    if (friction(1) >= friction(2)) return
    call deck%complain(diagnostics, 'the static friction, '//short_real(friction(1))//', is below the dynamic friction, '// &
                       short_real(friction(2)), b, trim(merge(keys(1), keys(2), deck%is_given(b, trim(keys(1))))))
  end subroutine check_frictions

  !> Warn of tests of the criterion that a step ends before.
  subroutine check_tests(deck, b, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. deck%is_given(b, 'check_every')) return
    if (is_default(deck, deck%value(b, 'check_every'))) return
    if (deck%integer(b, 'check_every') <= deck%integer(b, 'maximum_sweeps')) return
    call deck%warn(diagnostics, '"check_every" is larger than maximum_sweeps = '//to_text(deck%integer(b, 'maximum_sweeps'))// &
                   ': all steps take that many sweeps, and the criterion is tested after the last', b, 'check_every')
  end subroutine check_tests

  !> Warn of steps to trace that the run has not.
  subroutine check_trace(deck, b, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: steps
    integer :: last, n_beyond

    if (.not. (deck%is_given(b, 'trace_steps') .and. deck%flag(b, 'trace'))) return
    ! Not given in decks with stages, which refuse traces.
    if (.not. deck%is_given(deck%block_of('time'), 'steps')) return
    steps = deck%value(b, 'trace_steps')
    last = deck%integer(deck%block_of('time'), 'steps')
    n_beyond = count(nint(steps%numbers(:steps%n)) > last)
    if (n_beyond == 0) return
    call deck%warn(diagnostics, to_text(n_beyond)//' of '//to_text(steps%n)//' steps to trace lie beyond the last step, '// &
                   to_text(last), b, 'trace_steps')
  end subroutine check_trace
end module sg_sense_checks
