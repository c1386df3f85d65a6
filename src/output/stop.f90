!> End conditions of a run: expressions of recorded columns and of tracked bodies, tested in each recorded step.
module sg_stop
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use sg_comm, only: comm_t
  use sg_error, only: error_t, fail
  use sg_expression_parser, only: parse_expression
  use sg_expressions, only: do_variable, expression_t
  use sg_kinds, only: wp
  use sg_tally, only: column_t
  use sg_text, only: text_t, to_text
  use sg_tracks, only: track_columns
  implicit none
  private
  public :: stop_t, stop_variables

  !> The end conditions of a run; without texts there are none
  type :: stop_t
    !> Conditions as the deck writes them
    type(text_t), allocatable :: texts(:)
    !> Recorded steps in a row in which one must hold, and time before which none is tested [s]
    integer :: needed = 1
    real(wp) :: after = 0
    !> The conditions, and in how many recorded steps in a row each has held
    type(expression_t), allocatable, private :: condition(:)
    integer, allocatable, private :: held(:)
    !> Of each condition the first variable, by its place and by its name; 0 and no name where it has none
    integer, allocatable, private :: first(:)
    type(text_t), allocatable, private :: names(:)
    !> The condition that ended the run, 0 for none; when, and the value of its first variable
    integer :: met = 0
    real(wp) :: time = 0, value = 0
  contains
    procedure :: is_on => stop_is_on
    procedure :: begin => stop_begin
    procedure :: test => stop_test
    procedure :: reason => stop_reason
    procedure :: pack => stop_pack
    procedure :: unpack => stop_unpack
  end type stop_t

contains

  !> Names that conditions may use: columns of the record, and `column(body)` of each tracked body.
  pure function stop_variables(columns, dimension, bodies) result(names)
    type(column_t), intent(in) :: columns(:) !! of the record
    integer, intent(in) :: dimension !! of space
    type(text_t), intent(in) :: bodies(:) !! names of the tracked bodies
    type(text_t), allocatable :: names(:)
    character(len=16), allocatable :: tracked(:)
    integer :: i, b, n

    tracked = track_columns(dimension)
    n = size(columns)
    allocate (names(n + size(tracked)*size(bodies)))
    do i = 1, n
      names(i)%s = trim(columns(i)%name)
    end do
    do b = 1, size(bodies)
      do i = 1, size(tracked)
        n = n + 1
        names(n)%s = trim(tracked(i))//'('//bodies(b)%s//')'
      end do
    end do
  end function stop_variables

  !> Are there conditions?
  pure logical function stop_is_on(self)
    class(stop_t), intent(in) :: self

    stop_is_on = allocated(self%texts)
  end function stop_is_on

  !> Translate the conditions.
  subroutine stop_begin(self, variables, error)
    class(stop_t), intent(inout) :: self
    type(text_t), intent(in) :: variables(:) !! of `stop_variables`
    type(error_t), allocatable, intent(out) :: error !! set where one names a column that the run does not record
    character(len=:), allocatable :: mistake
    integer :: i, column

    if (.not. self%is_on()) return
    allocate (self%condition(size(self%texts)))
    if (.not. allocated(self%held)) allocate (self%held(size(self%texts)), source=0)
    allocate (self%first(size(self%texts)), self%names(size(self%texts)))
    do i = 1, size(self%texts)
      call parse_expression(self%texts(i)%s, variables, self%condition(i), mistake, column)
      if (allocated(mistake)) then
        call fail(error, 'stop.when "'//self%texts(i)%s//'": '//mistake)
        return
      end if
      associate (condition => self%condition(i))
        self%first(i) = findloc(condition%instruction, do_variable, 1)
        if (self%first(i) > 0) self%first(i) = nint(condition%operand(self%first(i)))
      end associate
      if (self%first(i) > 0) self%names(i)%s = variables(self%first(i))%s
    end do
  end subroutine stop_begin

  !> Test the conditions in a recorded step; `met` is set where one has held long enough. The root rank decides. Collective.
  subroutine stop_test(self, time, values, comm)
    class(stop_t), intent(inout) :: self
    real(wp), intent(in) :: time !! end of the step [s]
    real(wp), intent(in) :: values(:) !! of the variables
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: truth
    integer :: i

    do i = 1, size(self%condition)
      truth = self%condition(i)%at(values)
      if (ieee_is_nan(truth) .or. time < self%after) truth = 0
      self%held(i) = merge(self%held(i) + 1, 0, truth > 0)
    end do
    call comm%broadcast(self%held, 0)
    self%met = findloc(self%held >= self%needed, .true., 1)
    if (self%met == 0) return
    self%time = time
    if (self%first(self%met) == 0) return
    self%value = values(self%first(self%met))
    call comm%broadcast(self%value, 0)
  end subroutine stop_test

  !> Why the run ended, in one sentence.
  pure function stop_reason(self) result(reason)
    class(stop_t), intent(in) :: self
    character(len=:), allocatable :: reason

    reason = 'end condition "'//self%texts(self%met)%s//'" at '//to_text(self%time, 4)//' s'
    if (self%needed > 1) reason = reason//' for '//to_text(self%needed)//' recorded steps'
    if (self%first(self%met) > 0) reason = reason//': '//self%names(self%met)%s//' is '//to_text(self%value, 4)
  end function stop_reason

  !> How long conditions have held, for restart files: a mark of each and its count; of a run that one has ended, its value.
  pure function stop_pack(self) result(values)
    class(stop_t), intent(in) :: self
    real(wp), allocatable :: values(:)
    integer :: i

    allocate (values(0))
    if (.not. allocated(self%held)) return
    do i = 1, size(self%held)
      values = [values, mark_of(self%texts(i)%s), real(self%held(i), wp)]
    end do
    if (self%met > 0) values = [values, self%value]
  end function stop_pack

  !> The counts back, of the conditions that are the same; one that has held long enough has ended the run.
  pure subroutine stop_unpack(self, values, time)
    class(stop_t), intent(inout) :: self
    real(wp), intent(in) :: values(:) !! what `pack` gave
    real(wp), intent(in) :: time !! of the state [s]
    integer :: i, k

    if (.not. self%is_on()) return
    if (.not. allocated(self%held)) allocate (self%held(size(self%texts)), source=0)
    do i = 1, size(self%texts)
      do k = 1, size(values) - 1, 2
        if (abs(values(k) - mark_of(self%texts(i)%s)) > 0 .or. .not. abs(values(k + 1)) < 1e9_wp) cycle
        self%held(i) = nint(values(k + 1))
      end do
    end do
    self%met = findloc(self%held >= self%needed, .true., 1)
    if (self%met == 0) return
    self%time = time
    if (mod(size(values), 2) == 1) self%value = values(size(values))
  end subroutine stop_unpack

  !> A number by which texts are distinguished.
  pure real(wp) function mark_of(text) result(mark)
    character(len=*), intent(in) :: text
    integer :: i

    mark = 0
    do i = 1, len(text)
      mark = modulo(mark*257 + real(iachar(text(i:i)), wp), 1e12_wp + 39)
    end do
  end function mark_of
end module sg_stop
