!> Files whose names match a pattern with wildcards.
module sg_list_files
  use, intrinsic :: iso_c_binding, only: c_char, c_long, c_null_char
  use sg_text, only: append_word, text_t
  implicit none
  private
  public :: list_files

  interface
    function c_list_files(pattern, length, names) bind(c, name='splitgrain_list_files') result(needed)
      import :: c_char, c_long
      character(kind=c_char), intent(in) :: pattern(*)
      integer(c_long), value :: length
      character(kind=c_char), intent(inout) :: names(*)
      integer(c_long) :: needed
    end function c_list_files
  end interface

contains

  !> Files that match a pattern of the shell, in ascending order of their names: the same on all machines.
  subroutine list_files(folder, pattern, files)
    character(len=*), intent(in) :: folder !! ends with a slash, or empty; its letters stand for themselves
    character(len=*), intent(in) :: pattern !! path in the folder, with `*`, `?` and `[...]`
    type(text_t), allocatable, intent(out) :: files(:) !! paths with the folder
    character(kind=c_char), allocatable :: names(:)
    character(len=:), allocatable :: full
    integer(c_long) :: needed
    integer :: i, first

    full = plain(folder)//pattern//c_null_char
    allocate (names(0), files(0))
    needed = c_list_files(full, 0_c_long, names)
    deallocate (names)
    allocate (names(needed))
    ! Files may have come in between: those are left out with all others, and the list is empty.
    if (c_list_files(full, needed, names) /= needed) return
    first = 1
    do i = 1, int(needed)
      if (names(i) /= c_null_char) cycle
      call append_word(files, joined(names(first:i - 1)))
      first = i + 1
    end do
  end subroutine list_files

  !> A path in which a pattern's letters stand for themselves.
  pure function plain(path)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: plain
    integer :: i

    plain = ''
    do i = 1, len(path)
      if (scan(path(i:i), '*?[\') > 0) plain = plain//'\'
      plain = plain//path(i:i)
    end do
  end function plain

  !> Letters as one text.
  pure function joined(letters)
    character(kind=c_char), intent(in) :: letters(:)
    character(len=size(letters)) :: joined
    integer :: i

    do i = 1, size(letters)
      joined(i:i) = letters(i)
    end do
  end function joined
end module sg_list_files
