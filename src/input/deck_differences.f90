!> Differences of two effective decks, key by key: what a run changes that goes on from the checkpoint of another.
module sg_deck_differences
  use sg_effective, only: fingerprint
  use sg_text, only: append_word, split_lines, text_t, to_text
  implicit none
  private
  public :: deck_differences, hash_of_deck

  !> One key of a deck: its path, such as `law[2].friction`, and its value as text
  type :: setting_t
    character(len=:), allocatable :: path, value
  end type setting_t

  !> A section of a deck, and the number of its present block within the block around; 0 where it has one block only
  type :: section_t
    character(len=:), allocatable :: name
    integer :: number = 0
  end type section_t

contains

  !> Hash of an effective deck: that of its text behind the title, as `effective_deck` gives it.
  pure function hash_of_deck(text) result(hash)
    character(len=*), intent(in) :: text !! effective deck
    character(len=16) :: hash
    integer :: first

    first = 1
    if (text(:min(1, len(text))) /= '[') first = index(text, new_line('a')//'[') + 1
    hash = fingerprint(text(first:))
  end function hash_of_deck

  !> Keys whose values differ, each in words: `law[1].friction = 0.3 (was 0.0)`. Keys that stand before the first block, such as the
  !! title, do not count.
  subroutine deck_differences(former, present_deck, words)
    character(len=*), intent(in) :: former !! effective deck of before
    character(len=*), intent(in) :: present_deck !! effective deck of now
    type(text_t), allocatable, intent(out) :: words(:) !! differences in the order of the decks
    type(setting_t), allocatable :: old(:), new(:)
    logical, allocatable :: is_left(:)
    integer :: i, k

    call list_settings(former, old)
    call list_settings(present_deck, new)
    allocate (words(0), is_left(size(old)))
    is_left = .true.
    k = 0
    do i = 1, size(new)
      k = place_of(new(i)%path, old, k + 1)
      if (k == 0) then
        call append_word(words, new(i)%path//' = '//new(i)%value//' (was not there)')
        cycle
      end if
      is_left(k) = .false.
      if (old(k)%value /= new(i)%value) &
        call append_word(words, new(i)%path//' = '//new(i)%value//' (was '//old(k)%value//')')
    end do
    do k = 1, size(old)
      if (is_left(k)) call append_word(words, old(k)%path//' is gone (was '//old(k)%value//')')
    end do
  end subroutine deck_differences

  !> Place of a path in a list; 0 where it is not there. Two decks are alike, so that it mostly stands where the search begins.
  pure integer function place_of(path, settings, from) result(place)
    character(len=*), intent(in) :: path
    type(setting_t), intent(in) :: settings(:)
    integer, intent(in) :: from
    integer :: i

    do i = 0, size(settings) - 1
      place = 1 + modulo(from - 1 + i, size(settings))
      if (settings(place)%path == path) return
    end do
    place = 0
  end function place_of

  !> Keys of an effective deck, which has one a line, below the headings of their blocks.
  pure subroutine list_settings(text, settings)
    character(len=*), intent(in) :: text
    type(setting_t), allocatable, intent(out) :: settings(:)
    type(setting_t), allocatable :: room(:)
    type(section_t), allocatable :: sections(:)
    type(text_t), allocatable :: lines(:)
    character(len=:), allocatable :: block
    integer :: i, n, equals

    call split_lines(text, lines)
    allocate (room(size(lines)), sections(0))
    block = ''
    n = 0
    do i = 1, size(lines)
      associate (line => lines(i)%s)
        equals = index(line, ' = ')
        if (line(:min(1, len(line))) == '[') then
          call begin_block(line, sections, block)
        else if (block /= '' .and. equals > 0) then
          n = n + 1
          room(n)%path = block//'.'//line(:equals - 1)
          room(n)%value = line(equals + 3:)
        end if
      end associate
    end do
    allocate (settings(n))
    do i = 1, n
      call move_alloc(room(i)%path, settings(i)%path)
      call move_alloc(room(i)%value, settings(i)%value)
    end do
  end subroutine list_settings

  !> Count the block that a heading begins, and give its path: each part of its name, with a number where there may be several.
  pure subroutine begin_block(heading, sections, path)
    character(len=*), intent(in) :: heading
    type(section_t), allocatable, intent(inout) :: sections(:)
    character(len=:), allocatable, intent(out) :: path
    character(len=:), allocatable :: name, part
    integer :: i, depth

    depth = merge(2, 1, heading(:min(2, len(heading))) == '[[')
    name = heading(depth + 1:len_trim(heading) - depth)
    call note_section(name, sections)
    path = ''
    do i = 1, size(sections)
      associate (section => sections(i))
        if (section%name == name .and. depth == 2) section%number = section%number + 1
        if (index(section%name, name//'.') == 1) section%number = 0
        if (index(name//'.', section%name//'.') /= 1) cycle
        part = section%name(index(section%name, '.', back=.true.) + 1:)
        if (path /= '') path = path//'.'
        path = path//part
        if (section%number > 0) path = path//'['//to_text(section%number)//']'
      end associate
    end do
  end subroutine begin_block

  !> Add a section to a list, unless it is there.
  pure subroutine note_section(name, sections)
    character(len=*), intent(in) :: name
    type(section_t), allocatable, intent(inout) :: sections(:)
    type(section_t), allocatable :: longer(:)
    integer :: i, n

    n = size(sections)
    do i = 1, n
      if (sections(i)%name == name) return
    end do
    allocate (longer(n + 1))
    do i = 1, n
      call move_alloc(sections(i)%name, longer(i)%name)
      longer(i)%number = sections(i)%number
    end do
    longer(n + 1)%name = name
    call move_alloc(longer, sections)
  end subroutine note_section
end module sg_deck_differences
