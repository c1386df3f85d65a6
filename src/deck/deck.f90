!> Reading a deck: text, checked blocks, scene and options. All mistakes are gathered and reported together.
module sg_deck
  use sg_blocks, only: deck_t
  use sg_check_blocks, only: check_blocks
  use sg_collect, only: collect, open_deck
  use sg_comm, only: comm_t
  use sg_dimension_from_deck, only: dimension_from_deck
  use sg_effective, only: effective_deck, fingerprint
  use sg_error, only: diagnostics_t, error_t
  use sg_keys, only: all_keys
  use sg_options_from_deck, only: options_from_deck
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_scene_from_deck, only: scene_from_deck
  use sg_settings, only: apply_settings
  use sg_text, only: text_t
  use sg_toml, only: document_t, parse_toml, read_content, toml_table
  implicit none
  private
  public :: read_deck, read_share

contains

  !> Read a deck. Scene and options are complete when `diagnostics` holds no error.
  subroutine read_deck(file, settings, scene, options, diagnostics)
    character(len=*), intent(in) :: file !! path of the deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it, each `section.key=value`
    type(scene_t), intent(out) :: scene !! what exists
    type(run_options_t), intent(out) :: options !! what to do with it
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(deck_t) :: deck
    type(comm_t) :: alone

    call read_share(file, settings, alone, scene, options, deck, diagnostics)
  end subroutine read_deck

  !> Read a deck as one of several ranks that are to share its scene.
  !!
  !! The rank keeps a part of it, as `sg_bodies_from_deck` says; that no grains overlap is then to be checked by all ranks together
  !! (`sg_shared_start`). No message is sent here: the ranks may not read the same deck.
  subroutine read_share(file, settings, comm, scene, options, deck, diagnostics)
    character(len=*), intent(in) :: file !! path of the deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it, each `section.key=value`
    type(comm_t), intent(in) :: comm !! the ranks
    type(scene_t), intent(out) :: scene !! what exists, as far as this rank keeps it
    type(run_options_t), intent(out) :: options !! what to do with it
    type(deck_t), intent(out) :: deck !! the deck itself, for checks to come
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found

    call read_blocks(file, settings, deck, diagnostics)
    if (diagnostics%count() > 0) return
    deck%rank = comm%rank
    deck%ranks = comm%size
    call options_from_deck(deck, options, diagnostics)
    call scene_from_deck(deck, options, scene, diagnostics)
    if (diagnostics%count() > 0) return
    call effective_deck(deck, options%deck_text)
    options%deck_hash = fingerprint(options%deck_text)
  end subroutine read_share

  !> Read a deck as blocks of checked values.
  subroutine read_blocks(file, settings, deck, diagnostics)
    character(len=*), intent(in) :: file !! path of the deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it
    type(deck_t), intent(out) :: deck !! its blocks
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(document_t) :: document
    type(error_t), allocatable :: error

    deck%file = file
    deck%folder = file(:index(file, '/', back=.true.))
    call read_content(file, deck%content, error)
    if (.not. allocated(error)) call parse_toml(deck%content, document, error, file)
    if (allocated(error)) then
      call diagnostics%add(error%message, error%file, error%line, error%column, error%text)
      return
    end if
    if (size(document%entries) == 0) then
      call diagnostics%add('the deck is empty', file=file)
      return
    end if
    call open_deck(deck, all_keys(), count(document%entries%kind == toml_table))
    call collect(document, deck, diagnostics)
    call apply_settings(settings, deck, diagnostics)
    call dimension_from_deck(deck)
    call check_blocks(deck, diagnostics)
    if (diagnostics%count() > 1) call sort_by_line(diagnostics%errors)
  end subroutine read_blocks

  !> Mistakes in the order of the text; those without a line come first.
  pure subroutine sort_by_line(errors)
    type(error_t), intent(inout) :: errors(:)
    type(error_t) :: moved
    integer :: i, k

    do i = 2, size(errors)
      moved = errors(i)
      do k = i - 1, 1, -1
        if (errors(k)%line <= moved%line) exit
        errors(k + 1) = errors(k)
      end do
      errors(k + 1) = moved
    end do
  end subroutine sort_by_line
end module sg_deck
