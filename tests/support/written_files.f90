!> Files that tests write, decks read from texts, and the folder of real data beside the sources.
module written_files
  use, intrinsic :: iso_fortran_env, only: output_unit
  use harness, only: tests_t
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_system, only: make_folder
  use sg_text, only: text_t, to_text
  implicit none
  private
  public :: put_text, put_lines, read_deck_text, read_good_deck, options_of, shared_folder, first

contains

  !> Write a file byte by byte.
  subroutine put_text(path, text)
    character(len=*), intent(in) :: path !! file
    character(len=*), intent(in) :: text !! all that it holds
    integer :: unit

    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', action='write')
    write (unit) text
    close (unit)
  end subroutine put_text

  !> Write lines, without their closing blanks, as a file.
  subroutine put_lines(path, lines)
    character(len=*), intent(in) :: path !! file
    character(len=*), intent(in) :: lines(:) !! its lines
    integer :: unit, i

    open (newunit=unit, file=path, status='replace', action='write')
    do i = 1, size(lines)
      write (unit, '(a)') trim(lines(i))
    end do
    close (unit)
  end subroutine put_lines

  !> First mistake as one text.
  function first(diagnostics) result(sentence)
    type(diagnostics_t), intent(in) :: diagnostics !! mistakes found
    character(len=:), allocatable :: sentence

    sentence = ''
    if (diagnostics%count() > 0) sentence = diagnostics%errors(1)%sentence()
  end function first

  !> Read a deck from a text, by way of a file that is deleted again.
  subroutine read_deck_text(text, scene, options, diagnostics, settings, rank)
    character(len=*), intent(in) :: text !! the deck
    type(scene_t), intent(out) :: scene !! its scene
    type(run_options_t), intent(out) :: options !! its options
    type(diagnostics_t), intent(out) :: diagnostics !! its mistakes
    type(text_t), intent(in), optional :: settings(:) !! of the command line
    integer, intent(in), optional :: rank !! number in the name of the file, where several ranks read at once
    character(len=:), allocatable :: file
    type(text_t) :: none(0)
    integer :: unit

    file = 'deck.toml'
    if (present(rank)) file = 'deck_'//to_text(rank)//'.toml'
    call put_text(file, text)
    if (present(settings)) then
      call read_deck(file, settings, scene, options, diagnostics)
    else
      call read_deck(file, none, scene, options, diagnostics)
    end if
    open (newunit=unit, file=file, status='old', action='readwrite')
    close (unit, status='delete')
  end subroutine read_deck_text

  !> Read a deck with a sample from a text; it has no mistakes.
  subroutine read_good_deck(t, text, scene)
    class(tests_t), intent(inout) :: t !! the checks
    character(len=*), intent(in) :: text !! the deck
    type(scene_t), intent(out) :: scene !! its scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    call read_deck_text(text, scene, options, diagnostics)
    call diagnostics%print(output_unit)
    call t%equal(diagnostics%count(), 0, 'a deck with a sample is read')
    call t%check(.not. allocated(diagnostics%warnings), 'without warnings')
  end subroutine read_good_deck

  !> Options of a run that writes into a folder.
  function options_of(t, folder, step) result(options)
    class(tests_t), intent(inout) :: t !! the checks
    character(len=*), intent(in) :: folder !! it is made
    real(wp), intent(in) :: step !! time step [s]
    type(run_options_t) :: options

    options%folder = folder
    options%time_step = step
    options%deck_hash = '0123456789abcdef'
    call t%check(make_folder(folder), 'the folder '//folder//' is there')
  end function options_of

  !> Folder of the real decks and problems; it may be absent.
  function shared_folder() result(folder)
    character(len=:), allocatable :: folder
    character(len=1000) :: value
    integer :: length

    call get_environment_variable('SPLITGRAIN_SHARED', value, length)
    if (length == 0) then
      call get_environment_variable('SPLITGRAIN_SOURCE', value)
      value = trim(value)//'/../shared'
    end if
    folder = trim(value)
  end function shared_folder
end module written_files
