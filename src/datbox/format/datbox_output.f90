!> Lines of fixed columns for the files of an LMGC90 DATBOX, written whole or not at all.
module sg_datbox_output
  use sg_error, only: error_t
  use sg_kinds, only: wp, i8
  use sg_text, only: text_t
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: output_t, start_file, put, put_steps, finish_file, real_word, as_written, labelled, short_names
  public :: node_head, solid_node_head

  !> Letters that a file has room for at first
  integer, parameter :: least_room = 4096
  !> Blank head, to column 27, of a line whose numbers have labels
  character(len=27), parameter :: blank_head = ''
  !> Head of the line of a node, of the plane and of space
  character(len=27), parameter :: node_head = ' NO3xx      1', solid_node_head = ' NO6xx      1'

  !> A file that is gathered as text and written when it is finished
  type :: output_t
    !> Path of the finished file
    character(len=:), allocatable :: path
    !> Its text so far, with room for more, and how long it is
    character(len=:), allocatable :: text
    integer(i8) :: n = 0
  end type output_t

contains

  !> Start a file.
  subroutine start_file(output, folder, name)
    type(output_t), intent(out) :: output !! the file
    character(len=*), intent(in) :: folder !! DATBOX folder
    character(len=*), intent(in) :: name !! name within the folder

    output%path = trim(folder)//'/'//name
    allocate (character(len=least_room) :: output%text)
  end subroutine start_file

  !> Write one line.
  subroutine put(output, line)
    type(output_t), intent(inout) :: output !! file to write to
    character(len=*), intent(in) :: line !! the line
    character(len=:), allocatable :: grown
    integer(i8) :: n

    n = len_trim(line, i8)
    if (output%n + n + 1 > len(output%text, i8)) then
      allocate (character(len=2*(output%n + n + 1)) :: grown)
      grown(:output%n) = output%text(:output%n)
      call move_alloc(grown, output%text)
    end if
    output%text(output%n + 1:output%n + n + 1) = line(:n)//new_line('a')
    output%n = output%n + n + 1
  end subroutine put

  !> Write the line of step number and time that heads a state.
  subroutine put_steps(output, time, step_number)
    type(output_t), intent(inout) :: output !! file to write to
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step_number !! number of steps made
    character(len=15) :: head

    write (head, '(a,i7)') '$steps  ', step_number
    call put(output, labelled('time= ', [time], head))
  end subroutine put_steps

  !> Put the finished file in its place.
  subroutine finish_file(output, error)
    type(output_t), intent(inout) :: output !! file to finish
    type(error_t), allocatable, intent(inout) :: error !! set when the file could not be written; after an earlier failure none is

    if (.not. allocated(error)) call replace_file(output%path, output%text(:output%n), error)
    deallocate (output%text)
  end subroutine finish_file

  !> A real number in 14 columns, eight digits.
  pure function real_word(value) result(word)
    real(wp), intent(in) :: value !! number to write
    character(len=14) :: word
    integer :: e

    write (word, '(es14.7)') value
    e = index(word, 'E')
    if (e > 0) word(e:e) = 'D'
  end function real_word

  !> The number that a reader finds where this one was written.
  pure real(wp) function as_written(value)
    real(wp), intent(in) :: value !! number written
    character(len=14) :: word

    write (word, '(es14.7)') value
    read (word, '(es14.7)') as_written
  end function as_written

  !> Line of up to three numbers with labels of five letters, from column 30 on, after a head of 27 columns.
  pure function labelled(labels, values, head) result(line)
    character(len=*), intent(in) :: labels !! six letters each
    real(wp), intent(in) :: values(:) !! as many numbers
    character(len=*), intent(in), optional :: head !! columns 1 to 27, blank when absent
    character(len=:), allocatable :: line
    character(len=27) :: begin
    integer :: i

    begin = blank_head
    if (present(head)) begin = head
    line = begin
    do i = 1, size(values)
      line = line//'  '//labels(6*i - 5:6*i - 1)//real_word(values(i))
    end do
  end function labelled

  !> Names cut to five letters, without blanks, no two alike.
  pure subroutine short_names(names, short)
    type(text_t), intent(in) :: names(:) !! names of any length
    character(len=5), allocatable, intent(out) :: short(:) !! as many names of five letters
    character(len=5) :: word, number
    integer :: i, k

    allocate (short(size(names)))
    do i = 1, size(names)
      word = without_blanks(names(i)%s)
      ! A name that needs no cut keeps its letters; one that collides gets a number at its end.
      k = 0
      do while (any(short(:i - 1) == word) .or. (word /= names(i)%s .and. is_taken(word, names)))
        k = k + 1
        write (number, '(i0)') k
        word = without_blanks(names(i)%s)
        word(6 - len_trim(number):) = number
        word = without_blanks(word)
      end do
      short(i) = word
    end do
  end subroutine short_names

  !> The first five letters of a name, blanks within it as underscores; never empty.
  pure function without_blanks(name) result(word)
    character(len=*), intent(in) :: name
    character(len=5) :: word
    integer :: i

    word = name
    if (word == '') word = 'x'
    do i = 1, len_trim(word)
      if (word(i:i) == ' ') word(i:i) = '_'
    end do
  end function without_blanks

  !> Is this word the whole name of something?
  pure logical function is_taken(word, names)
    character(len=*), intent(in) :: word
    type(text_t), intent(in) :: names(:)
    integer :: i

    is_taken = .false.
    do i = 1, size(names)
      if (names(i)%s == word) is_taken = .true.
    end do
  end function is_taken
end module sg_datbox_output
