!> Stages of a run: which one is due, where each began and ended, and why. Checkpoints hold it as numbers.
module sg_stages
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_kinds, only: wp
  use sg_text, only: text_t, to_text
  implicit none
  private
  public :: stage_t, stages_t

  !> Numbers that a checkpoint holds per stage
  integer, parameter :: n_values = 9

  !> One stage
  type :: stage_t
    !> Its name; empty where the deck gives none
    character(len=:), allocatable :: name
    !> Its end conditions, as the deck writes them
    type(text_t), allocatable :: conditions(:)
    !> Steps at most
    integer :: most_steps = 0
    !> Steps of the run done before it, and when it began [s]; the origin that steps are counted from [s]
    integer :: first_step = 0
    real(wp) :: start_time = 0, origin = 0
    !> Steps of the run done at its end, or so far, and the time then [s]
    integer :: last_step = 0
    real(wp) :: end_time = 0
    !> Steps of the run without convergence: before it, and until its end or so far
    integer :: unconverged_before = 0, unconverged = 0
    !> The condition that ended it, 0 for none, and the value of the condition's first variable
    integer :: met = 0
    real(wp) :: value = 0
  contains
    procedure :: words => stage_words
    procedure :: reason => stage_reason
  end type stage_t

  !> The stages of a run
  type :: stages_t
    !> All stages of the deck; none where it has no stages
    type(stage_t), allocatable :: list(:)
    !> Number of the present one, 0 where there are none; those before it have ended
    integer :: number = 0
    !> Steps done when the present deck was read, and the time then [s]
    integer :: step = 0
    real(wp) :: time = 0
    !> Steps of all stages together at most
    integer :: most_steps = huge(0)
    !> Does the present stage begin, so that conditions are counted from zero? Have all ended?
    logical :: begins = .false., are_over = .false.
    !> Are all stages of the deck checked?
    logical :: are_checked = .false.
    !> Numbers of a checkpoint, until the deck is read
    real(wp), allocatable :: loaded(:)
  contains
    procedure :: place => stages_place
    procedure :: last_step => stages_last_step
    procedure :: all_steps => stages_all_steps
    procedure :: go_on => stages_go_on
    procedure :: note => stages_note
    procedure :: pack => stages_pack
  end type stages_t

contains

  !> Decide which stage is due after the steps done: the last one that has begun, unless it is over.
  pure subroutine stages_place(self)
    class(stages_t), intent(inout) :: self !! its stages are those of the deck
    integer :: begun, i

    begun = self%number
    if (allocated(self%loaded)) call unpack_values(self, begun)
    self%begins = .false.
    self%are_over = .false.
    if (begun > 0) then
      associate (last => self%list(begun))
        if (last%met == 0 .and. self%step - last%first_step < last%most_steps) then
          self%number = begun
          return
        end if
      end associate
    end if
    self%number = min(begun + 1, size(self%list))
    self%are_over = begun == size(self%list)
    if (self%are_over) return
    self%begins = .true.
    associate (now => self%list(self%number))
      now%first_step = self%step
      now%start_time = self%time
      now%last_step = self%step
      now%end_time = self%time
      now%met = 0
      do i = 1, begun
        now%unconverged_before = self%list(i)%unconverged_before + self%list(i)%unconverged
      end do
    end associate
  end subroutine stages_place

  !> Step at which the present stage ends at the latest.
  pure integer function stages_last_step(self) result(step)
    class(stages_t), intent(in) :: self

    step = self%step
    if (self%are_over) return
    associate (now => self%list(self%number))
      step = self%most_steps
      if (now%most_steps < self%most_steps - now%first_step) step = now%first_step + now%most_steps
    end associate
    step = max(step, self%step)
  end function stages_last_step

  !> Steps of all stages together, if none ends early.
  pure integer function stages_all_steps(self) result(steps)
    class(stages_t), intent(in) :: self
    integer :: i

    steps = 0
    do i = 1, size(self%list)
      steps = min(self%most_steps, steps + min(self%list(i)%most_steps, huge(0) - steps))
    end do
  end function stages_all_steps

  !> Is there a stage after the present one, which is done?
  pure logical function stages_go_on(self) result(go_on)
    class(stages_t), intent(in) :: self

    go_on = .false.
    if (self%number == 0) return
    go_on = self%number < size(self%list) .and. self%list(self%number)%last_step < self%most_steps
  end function stages_go_on

  !> Note how far the present stage is.
  pure subroutine stages_note(self, step, time, unconverged, met, value)
    class(stages_t), intent(inout) :: self
    integer, intent(in) :: step !! steps of the run that are done
    real(wp), intent(in) :: time !! time reached [s]
    integer, intent(in) :: unconverged !! steps of the run without convergence
    integer, intent(in) :: met !! condition that ends the stage, 0 for none
    real(wp), intent(in) :: value !! of its first variable

    if (self%number == 0 .or. self%are_over) return
    associate (now => self%list(self%number))
      ! A stage that could not begin is where it was.
      if (step < now%first_step) return
      now%last_step = step
      now%end_time = time
      now%unconverged = unconverged - now%unconverged_before
      now%met = met
      now%value = value
    end associate
  end subroutine stages_note

  !> Numbers for a checkpoint: of each stage that has begun.
  pure function stages_pack(self) result(values)
    class(stages_t), intent(in) :: self
    real(wp), allocatable :: values(:)
    integer :: i

    allocate (values(n_values*self%number))
    do i = 1, self%number
      associate (stage => self%list(i))
        values(n_values*(i - 1) + 1:n_values*i) = &
          [real(stage%first_step, wp), stage%start_time, stage%origin, real(stage%last_step, wp), stage%end_time, &
           real(stage%unconverged_before, wp), real(stage%unconverged, wp), real(stage%met, wp), stage%value]
      end associate
    end do
  end function stages_pack

  !> Take the numbers of a checkpoint: of as many stages as the deck has. Numbers that no run can have written count as none.
  pure subroutine unpack_values(self, begun)
    class(stages_t), intent(inout) :: self
    integer, intent(out) :: begun !! stages that have begun
    real(wp) :: values(n_values)
    integer :: i

    begun = 0
    do i = 1, min(size(self%list), size(self%loaded)/n_values)
      values = self%loaded(n_values*(i - 1) + 1:n_values*i)
      if (.not. all(ieee_is_finite(values)) .or. any(abs(values([1, 4, 6, 7, 8])) > real(huge(0), wp))) exit
      associate (stage => self%list(i))
        stage%first_step = nint(values(1))
        stage%start_time = values(2)
        stage%origin = values(3)
        stage%last_step = nint(values(4))
        stage%end_time = values(5)
        stage%unconverged_before = nint(values(6))
        stage%unconverged = nint(values(7))
        stage%met = nint(values(8))
        stage%value = values(9)
      end associate
      begun = i
    end do
    deallocate (self%loaded)
  end subroutine unpack_values

  !> Name of a stage in a log: its number, and its name where it has one.
  pure function stage_words(self, number) result(words)
    class(stage_t), intent(in) :: self
    integer, intent(in) :: number !! from 1
    character(len=:), allocatable :: words

    words = to_text(number)
    if (len(self%name) > 0) words = words//' "'//self%name//'"'
  end function stage_words

  !> Why a stage ended, in a few words.
  pure function stage_reason(self) result(reason)
    class(stage_t), intent(in) :: self
    character(len=:), allocatable :: reason

    reason = 'all steps done'
    if (self%last_step - self%first_step < self%most_steps) reason = 'not at its end'
    if (self%met == 0) return
    reason = 'end condition'
    if (self%met <= size(self%conditions)) reason = reason//' "'//self%conditions(self%met)%s//'"'
    reason = reason//' at '//to_text(self%end_time, 4)//' s: '//to_text(self%value, 4)
  end function stage_reason
end module sg_stages
