!> Writes a short deck that uses an LMGC90 DATBOX folder.
module sg_datbox_deck
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  use sg_text_files, only: replace_file
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
    character(len=*), parameter :: nl = new_line('a')
    character(len=:), allocatable :: step

    step = '1.0e-3'
    if (scene%start_step > 0 .and. scene%start_time > 0) &
      step = short_real(scene%start_time/real(scene%start_step, wp))
    call replace_file(deck, '# A DATBOX holds neither time step, theta, period, pressures nor the solver: check what stands '// &
                      'here.'//nl//'[scene]'//nl//'dimension = '//to_text(scene%dimension)//nl//'datbox = '// &
                      quoted_string(path_from(deck, folder))//nl//'# period_x = 1.0'//nl//nl//'[time]'//nl//'step = '//step//nl// &
                      'steps = 1000'//nl//'theta = 0.5'//nl//nl//'# [solver]'//nl//'# criterion = "quad"'//nl// &
                      '# tolerance = 1.0e-4'//nl, error)
  end subroutine write_datbox_deck

  !> A path as a deck must give it: relative to the deck's own folder.
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
