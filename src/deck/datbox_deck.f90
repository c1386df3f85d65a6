!> Writes a short deck that uses an LMGC90 DATBOX folder.
module sg_datbox_deck
  use sg_error, only: error_t, exit_output, fail
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  use sg_words, only: quoted_string, short_real
  implicit none
  private
  public :: write_datbox_deck

contains

  !> Write a short deck that uses a DATBOX; what no DATBOX holds is for the user to check.
  subroutine write_datbox_deck(folder, deck, scene, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    character(len=*), intent(in) :: deck !! deck to write, not there yet
    type(scene_t), intent(in) :: scene !! scene read from the folder
    type(error_t), allocatable, intent(out) :: error !! set when the deck cannot be written
    character(len=:), allocatable :: step
    character(len=200) :: message
    integer :: unit, status

    step = '1.0e-3'
    if (scene%start_step > 0 .and. scene%start_time > 0) &
      step = short_real(scene%start_time/real(scene%start_step, wp))
    open (newunit=unit, file=deck, status='new', action='write', iostat=status, iomsg=message)
    if (status == 0) write (unit, '(a)', iostat=status, iomsg=message) &
      '# A DATBOX holds neither time step, theta, period, pressures nor the solver: check what stands here.', &
      '[scene]', 'dimension = '//to_text(scene%dimension), 'datbox = '//quoted_string(path_from(deck, folder)), &
      '# period_x = 1.0', '', '[time]', 'step = '//step, 'steps = 1000', 'theta = 0.5', '', &
      '# [solver]', '# criterion = "quad"', '# tolerance = 1.0e-4'
    if (status == 0) close (unit, iostat=status, iomsg=message)
    if (status /= 0) call fail(error, 'cannot write the deck: '//trim(message), file=deck, code=exit_output)
  end subroutine write_datbox_deck

  !> A path as a deck must say it: relative to the deck's own folder.
  function path_from(deck, path) result(seen)
    character(len=*), intent(in) :: deck, path
    character(len=:), allocatable :: seen
    character(len=1000) :: here
    integer :: n

    n = index(deck, '/', back=.true.)
    seen = path
    if (n == 0 .or. path(1:1) == '/') return
    if (index(path, deck(:n)) == 1) then
      seen = path(n + 1:)
    else
      call get_environment_variable('PWD', here)
      seen = trim(here)//'/'//path
    end if
  end function path_from
end module sg_datbox_deck
