!> Text files of which only a window is held: lines are those that were written, in whatever order they are asked for.
program test_text_window
  use harness, only: tests_t
  use sg_error, only: error_t
  use sg_text, only: text_t, read_lines, to_text
  use sg_text_window, only: text_window_t
  use written_files, only: put_lines, put_text
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  type(tests_t) :: t

  call test_order()
  call test_ends('', 0)
  call test_ends(nl, 1)
  call test_ends('a', 1)
  call test_ends('a'//achar(13)//nl//nl//'b', 3)
  call test_missing()
  call t%finish()

contains

  !> Lines of a file of several windows and of several blocks, forwards, backwards, and beyond its ends.
  subroutine test_order()
    integer, parameter :: n = 12289 ! three windows and a line
    character(len=100) :: padding
    character(len=:), allocatable :: line
    character(len=110), allocatable :: lines(:)
    type(text_window_t) :: window
    type(error_t), allocatable :: error
    integer :: i, wrong

    padding = repeat('x', len(padding))
    allocate (lines(n))
    do i = 1, n
      lines(i) = to_text(i)//padding
    end do
    call put_lines('long.txt', lines)
    call window%open('long.txt', error)
    call t%check(.not. allocated(error), 'a long file is opened')
    call t%equal(window%n, n, 'its lines')
    wrong = 0
    do i = 1, n
      call window%get(i, line)
      if (line /= to_text(i)//padding) wrong = wrong + 1
    end do
    do i = n, 1, -1000
      call window%get(i, line)
      if (line /= to_text(i)//padding) wrong = wrong + 1
    end do
    call t%equal(wrong, 0, 'lines are those that were written')
    call window%get(n + 1, line)
    call t%check(line == '', 'nothing stands behind the last line')
    call window%get(0, line)
    call t%check(line == '', 'nothing stands before the first line')
  end subroutine test_order

  !> Ends of lines and of the file count as where all lines are read at once.
  subroutine test_ends(content, n)
    character(len=*), intent(in) :: content
    integer, intent(in) :: n
    type(text_window_t) :: window
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    character(len=:), allocatable :: line
    integer :: i

    call put_text('short.txt', content)
    call window%open('short.txt', error)
    call t%check(.not. allocated(error), 'a short file is opened')
    call read_lines('short.txt', lines, error)
    call t%equal(window%n, n, 'lines of a short file')
    call t%equal(size(lines), n, 'lines of a short file, read at once')
    do i = 1, n
      call window%get(i, line)
      call t%check(line == lines(i)%s .and. len(line) == len(lines(i)%s), 'a line of a short file')
    end do
  end subroutine test_ends

  !> A file that is not there.
  subroutine test_missing()
    type(text_window_t) :: window
    type(error_t), allocatable :: error

    call window%open('missing.txt', error)
    call t%check(allocated(error), 'a missing file is a mistake')
  end subroutine test_missing
end program test_text_window
