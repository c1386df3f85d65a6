!> Files that a run reads because its deck names them.
module sg_deck_inputs
  use sg_blocks, only: deck_t
  use sg_grain_templates, only: files_of_sample, names_files
  use sg_text, only: append_word, text_t
  use sg_time_function_from_deck, only: path_in_deck
  implicit none
  private
  public :: deck_inputs

contains

  !> The deck itself, and all files and folders that it names.
  function deck_inputs(deck) result(files)
    type(deck_t), intent(in) :: deck !! the deck
    type(text_t), allocatable :: files(:)
    type(text_t), allocatable :: shapes(:)
    integer :: b, i, v

    allocate (files(0))
    call append_word(files, deck%file)
    do b = 1, deck%n
      do v = 1, deck%blocks(b)%n
        associate (value => deck%blocks(b)%values(v))
          if (value%n_words /= 1 .or. value%key == 0) cycle
          if (all(['file  ', 'datbox'] /= deck%table%keys(value%key)%name)) cycle
          call append_word(files, path_in_deck(deck, value%words(1)%s))
        end associate
      end do
      if (.not. (names_files(deck, b) .or. deck%is_in(b, 'blocks'))) cycle
      call files_of_sample(deck, b, shapes)
      do i = 1, size(shapes)
        call append_word(files, shapes(i)%s)
      end do
    end do
  end function deck_inputs
end module sg_deck_inputs
