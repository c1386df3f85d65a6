!> What a user can cause, as a value: one sentence, the place in the file, and the exit code.
!!
!! A procedure that can fail has `type(error_t), allocatable, intent(out) :: error`; unallocated means success.
!! Readers of decks gather all mistakes in a `diagnostics_t` and report them together.
module sg_error
  implicit none
  private
  public :: error_t, diagnostics_t, fail
  public :: exit_done, exit_failure, exit_bad_input, exit_not_converged, exit_broken, exit_output, exit_unbalanced, &
            exit_memory, exit_stopped

  !> The run did all its steps
  integer, parameter :: exit_done = 0
  !> Something failed that has no code of its own
  integer, parameter :: exit_failure = 1
  !> The command line, the deck or a file it names is wrong
  integer, parameter :: exit_bad_input = 2
  !> The solver did not converge and the deck asked to stop then
  integer, parameter :: exit_not_converged = 3
  !> A value that is not finite appeared: the run stopped within its step
  integer, parameter :: exit_broken = 4
  !> A result could not be written (full disk, missing permission)
  integer, parameter :: exit_output = 5
  !> The energy balance did not close and the deck asked to stop there
  integer, parameter :: exit_unbalanced = 6
  !> Memory was about to run short: the run stopped before
  integer, parameter :: exit_memory = 7
  !> Stopped early on request (signal, walltime), with a checkpoint
  integer, parameter :: exit_stopped = 75

  !> One mistake: what is wrong, where, and how the program should end
  type :: error_t
    !> One clear sentence, lower case, no full stop
    character(len=:), allocatable :: message
    !> File that holds the mistake; unallocated when there is none
    character(len=:), allocatable :: file
    !> Text of the line that holds the mistake; unallocated when there is none
    character(len=:), allocatable :: text
    !> Line and column of the mistake, from 1; 0 when unknown
    integer :: line = 0, column = 0
    !> Kind of finding, and how many findings of this kind in this file it stands for; unallocated where each stands alone
    character(len=:), allocatable :: kind
    integer :: count = 1
    !> Exit code of the program
    integer :: code = exit_bad_input
  contains
    procedure :: report => error_report
    procedure :: sentence => error_sentence
  end type error_t

  !> A growing list of mistakes and warnings, so that all of a deck's are reported at once
  type :: diagnostics_t
    !> Mistakes that stop the program
    type(error_t), allocatable :: errors(:)
    !> Harmless findings for the user
    type(error_t), allocatable :: warnings(:)
  contains
    procedure :: add => diagnostics_add
    procedure :: warn => diagnostics_warn
    procedure :: count => diagnostics_count
    procedure :: print => diagnostics_print
  end type diagnostics_t

contains

  !> Make an error.
  subroutine fail(error, message, file, line, column, text, code)
    type(error_t), allocatable, intent(out) :: error !! the error made
    character(len=*), intent(in) :: message !! one sentence
    character(len=*), intent(in), optional :: file !! file at fault
    integer, intent(in), optional :: line !! line at fault, from 1
    integer, intent(in), optional :: column !! column at fault, from 1
    character(len=*), intent(in), optional :: text !! the line itself, shown above a caret
    integer, intent(in), optional :: code !! exit code, default `exit_bad_input`

    allocate (error)
    error = made(message, file, line, column, text)
    if (present(code)) error%code = code
  end subroutine fail

  !> An error built from its parts.
  pure function made(message, file, line, column, text) result(error)
    character(len=*), intent(in) :: message
    character(len=*), intent(in), optional :: file, text
    integer, intent(in), optional :: line, column
    type(error_t) :: error

    error%message = message
    if (present(file)) error%file = file
    if (present(line)) error%line = line
    if (present(column)) error%column = column
    if (present(text)) error%text = text
  end function made

  !> `file:line:column: kind: message`, then the line and a caret where they are known.
  function error_report(self, kind) result(report)
    class(error_t), intent(in) :: self
    character(len=*), intent(in), optional :: kind !! `error` (default) or `warning`
    character(len=:), allocatable :: report

    report = 'error: '
    if (present(kind)) report = kind//': '
    report = place(self)//report//self%message//times(self)
    if (.not. allocated(self%text)) return
    report = report//new_line('a')//'  '//self%text
    if (self%column < 1) return
    report = report//new_line('a')//'  '//blanks_before(self%text, self%column)//'^'
  end function error_report

  !> The message with its place, on one line: for summaries and `run.json`.
  function error_sentence(self) result(sentence)
    class(error_t), intent(in) :: self
    character(len=:), allocatable :: sentence

    sentence = place(self)//self%message//times(self)
  end function error_sentence

  !> ` (12 times)`; empty for a finding that stands alone.
  pure function times(error)
    class(error_t), intent(in) :: error
    character(len=:), allocatable :: times
    character(len=12) :: number

    times = ''
    if (error%count == 1) return
    write (number, '(i0)') error%count
    times = ' ('//trim(number)//' times)'
  end function times

  !> `file:line:column: ` as far as known.
  pure function place(error)
    class(error_t), intent(in) :: error
    character(len=:), allocatable :: place
    character(len=12) :: number

    place = ''
    if (.not. allocated(error%file)) return
    place = error%file//':'
    if (error%line > 0) then
      write (number, '(i0)') error%line
      place = place//trim(number)//':'
      if (error%column > 0) then
        write (number, '(i0)') error%column
        place = place//trim(number)//':'
      end if
    end if
    place = place//' '
  end function place

  !> What must stand before the caret: blanks, and tabs where the line has tabs.
  pure function blanks_before(text, column) result(blanks)
    character(len=*), intent(in) :: text
    integer, intent(in) :: column
    character(len=:), allocatable :: blanks
    integer :: i

    allocate (character(len=column - 1) :: blanks)
    do i = 1, column - 1
      blanks(i:i) = ' '
      if (i <= len(text)) then
        if (text(i:i) == achar(9)) blanks(i:i) = achar(9)
      end if
    end do
  end function blanks_before

  !> Add a mistake.
  subroutine diagnostics_add(self, message, file, line, column, text)
    class(diagnostics_t), intent(inout) :: self
    character(len=*), intent(in) :: message !! one sentence
    character(len=*), intent(in), optional :: file !! file at fault
    integer, intent(in), optional :: line !! line at fault, from 1
    integer, intent(in), optional :: column !! column at fault, from 1
    character(len=*), intent(in), optional :: text !! the line itself

    call append(self%errors, made(message, file, line, column, text))
  end subroutine diagnostics_add

  !> Add a warning; of those of one kind in one file the first stands for all, with their count.
  subroutine diagnostics_warn(self, message, file, line, column, text, kind)
    class(diagnostics_t), intent(inout) :: self
    character(len=*), intent(in) :: message !! one sentence
    character(len=*), intent(in), optional :: file !! file concerned
    integer, intent(in), optional :: line !! line concerned, from 1
    integer, intent(in), optional :: column !! column concerned, from 1
    character(len=*), intent(in), optional :: text !! the line itself
    character(len=*), intent(in), optional :: kind !! kind of finding, where many of it are expected
    type(error_t) :: warning
    integer :: i

    warning = made(message, file, line, column, text)
    if (present(kind)) then
      warning%kind = kind
      do i = 1, size_of(self%warnings)
        if (.not. same_kind(self%warnings(i), warning)) cycle
        self%warnings(i)%count = self%warnings(i)%count + 1
        return
      end do
    end if
    call append(self%warnings, warning)
  end subroutine diagnostics_warn

  !> Are both of one kind, in one file?
  pure logical function same_kind(one, other)
    type(error_t), intent(in) :: one, other

    same_kind = allocated(one%kind) .and. (allocated(one%file) .eqv. allocated(other%file))
    if (same_kind) same_kind = one%kind == other%kind
    if (same_kind .and. allocated(one%file)) same_kind = one%file == other%file
  end function same_kind

  !> Number of items of a list.
  pure integer function size_of(list)
    type(error_t), allocatable, intent(in) :: list(:)

    size_of = 0
    if (allocated(list)) size_of = size(list)
  end function size_of

  !> Append to a list, item by item: gfortran 12 leaks the texts of items in an array constructor.
  pure subroutine append(list, item)
    type(error_t), allocatable, intent(inout) :: list(:)
    type(error_t), intent(in) :: item
    type(error_t), allocatable :: grown(:)
    integer :: i, n

    n = size_of(list)
    allocate (grown(n + 1))
    do i = 1, n
      grown(i) = list(i)
    end do
    grown(n + 1) = item
    call move_alloc(grown, list)
  end subroutine append

  !> Number of mistakes (warnings not counted).
  pure integer function diagnostics_count(self) result(count)
    class(diagnostics_t), intent(in) :: self

    count = size_of(self%errors)
  end function diagnostics_count

  !> Print all warnings, then all mistakes.
  subroutine diagnostics_print(self, unit)
    class(diagnostics_t), intent(in) :: self
    integer, intent(in) :: unit !! open unit, usually the error unit
    integer :: i

    if (allocated(self%warnings)) then
      do i = 1, size(self%warnings)
        write (unit, '(a)') self%warnings(i)%report('warning')
      end do
    end if
    do i = 1, self%count()
      write (unit, '(a)') self%errors(i)%report()
    end do
  end subroutine diagnostics_print
end module sg_error
