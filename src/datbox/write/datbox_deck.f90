!> Writes a short deck that uses an LMGC90 DATBOX folder.
module sg_datbox_deck
  use sg_datbox_settings, only: datbox_settings_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  use sg_text_files, only: replace_file
  use sg_words, only: quoted_string, short_real
  implicit none
  private
  public :: write_datbox_deck

  character(len=*), parameter :: nl = new_line('a')
  !> Sections of the deck, in their order
  character(len=*), parameter :: sections(6) = [character(len=9) :: 'scene', 'time', 'solver', 'output', 'guard', 'restart']

contains

  !> Write a short deck that uses a DATBOX; what no DATBOX holds and no other file gave is for the user to check.
  subroutine write_datbox_deck(folder, deck, scene, found, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    character(len=*), intent(in) :: deck !! deck to write, not there yet
    type(scene_t), intent(in) :: scene !! scene read from the folder
    type(datbox_settings_t), intent(in) :: found !! keys that other files gave
    type(error_t), allocatable, intent(out) :: error !! set when the deck cannot be written
    type(datbox_settings_t) :: settings
    character(len=:), allocatable :: text
    integer :: i

    call put_defaults(settings, scene, path_from(deck, folder))
    if (allocated(found%keys)) then
      do i = 1, size(found%keys)
        call settings%put(found%keys(i)%s, found%values(i)%s, found%notes(i)%s)
      end do
    end if
    text = '# A DATBOX holds neither time step, theta, period, pressures nor the solver: check what stands here.'//nl
    do i = 1, size(sections)
      text = text//settings%section_text(trim(sections(i)))
    end do
    if (allocated(found%tracked)) then
      do i = 1, size(found%tracked)
        text = text//nl//'[[track]]'//nl//'body = '//to_text(found%tracked(i))//'  # POSTPRO.DAT'//nl
      end do
    end if
    if (allocated(found%pairs)) then
      do i = 1, size(found%pairs, 2)
        text = text//nl//'[[interface]]'//nl//'between = ['//to_text(found%pairs(1, i))//', '//to_text(found%pairs(2, i))// &
               ']  # POSTPRO.DAT'//nl
      end do
    end if
    call replace_file(deck, text, error)
  end subroutine write_datbox_deck

  !> What the deck holds where no file gives it.
  subroutine put_defaults(settings, scene, path)
    type(datbox_settings_t), intent(inout) :: settings
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: path

    call settings%put('scene.dimension', to_text(scene%dimension), '')
    call settings%put('scene.datbox', quoted_string(path), '')
    if (scene%start_step > 0 .and. scene%start_time > 0) then
      call settings%put('time.step', short_real(scene%start_time/real(scene%start_step, wp)), 'DOF.INI: time over steps')
    else
      call settings%put('time.step', '1.0e-3', 'found nowhere')
    end if
    call settings%put('time.steps', '1000', 'found nowhere')
    call settings%put('time.theta', '0.5', 'found nowhere')
  end subroutine put_defaults

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
