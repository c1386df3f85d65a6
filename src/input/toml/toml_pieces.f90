!> Where a long deck may be cut: before `[[body]]` headers, so that it is read piece by piece. The entries of a text take many
!! times the room of the blocks made of them.
module sg_toml_pieces
  implicit none
  private
  public :: find_pieces

  !> Bytes of a piece at least
  integer, parameter :: least = 262144

contains

  !> Find where pieces begin. A text that is cut wrongly, within a string or a list of several lines, does not parse.
  pure subroutine find_pieces(content, first, line, n_headers)
    character(len=*), intent(in) :: content !! the whole text
    integer, allocatable, intent(out) :: first(:) !! first byte of each piece, and the one behind the text, shape (pieces + 1)
    integer, allocatable, intent(out) :: line(:) !! lines before each piece, shape (pieces)
    integer, intent(out) :: n_headers !! lines that may begin a block
    character(len=8) :: begin
    integer :: at, next, lines, n

    allocate (first(len(content)/least + 2), line(len(content)/least + 1))
    first(1) = 1
    line(1) = 0
    n = 1
    n_headers = 0
    at = 1
    lines = 0
    do while (at <= len(content))
      next = index(content(at:), new_line('a')) + at
      if (next == at) next = len(content) + 1
      begin = adjustl(content(at:next - 1))
      if (begin(1:1) == '[') n_headers = n_headers + 1
      if (begin == '[[body]]' .and. at - first(n) >= least) then
        n = n + 1
        first(n) = at
        line(n) = lines
      end if
      lines = lines + 1
      at = next
    end do
    first(n + 1) = len(content) + 1
    first = first(:n + 1)
    line = line(:n)
  end subroutine find_pieces
end module sg_toml_pieces
