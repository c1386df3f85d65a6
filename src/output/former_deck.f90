!> Warning for a run that goes on from the checkpoint of another deck: the keys that differ.
module sg_former_deck
  use sg_deck_differences, only: deck_differences, hash_of_deck
  use sg_error, only: diagnostics_t
  use sg_former_results, only: content_of
  use sg_run_options, only: run_options_t
  use sg_text, only: joined, text_t, to_text
  implicit none
  private
  public :: warn_of_differences

  !> Differences that a warning names
  integer, parameter :: most_named = 8

contains

  !> Warn where a restart file was written with another deck. The keys are named where that deck stands next to the file, as runs
  !! leave it.
  subroutine warn_of_differences(file, hash, options, warnings)
    character(len=*), intent(in) :: file !! path of the restart file
    character(len=*), intent(in) :: hash !! hash of the deck that it was written with
    type(run_options_t), intent(in) :: options !! options of the present deck
    type(diagnostics_t), intent(inout) :: warnings !! gets the warning
    character(len=:), allocatable :: former, words
    type(text_t), allocatable :: list(:)

    if (.not. allocated(options%deck_hash)) return
    if (hash == options%deck_hash) return
    words = 'this restart file was written with another deck'
    former = content_of(file(:index(file, '/', back=.true.))//'effective.toml')
    if (hash_of_deck(former) == hash) then
      call deck_differences(former, options%deck_text, list)
      words = words//': '//joined(list(:min(most_named, size(list))), ', ')
      if (size(list) > most_named) words = words//' and '//to_text(size(list) - most_named)//' keys more'
    end if
    call warnings%warn(words, file=file)
  end subroutine warn_of_differences
end module sg_former_deck
