!> Reading a deck: text, checked blocks, scene and options. All mistakes are gathered and reported together.
module sg_deck
  use sg_blocks, only: deck_t
  use sg_check_blocks, only: check_blocks
  use sg_collect, only: collect, open_deck
  use sg_comm, only: comm_t
  use sg_constants, only: check_constant_settings, constants_t, put_constants, take_constant_settings
  use sg_dimension_from_deck, only: dimension_from_deck
  use sg_effective, only: effective_deck
  use sg_error, only: diagnostics_t, error_t, fail
  use sg_fields_from_deck, only: fields_from_deck, regions_from_deck
  use sg_interfaces_from_deck, only: interfaces_from_deck
  use sg_keys, only: all_keys
  use sg_mesh_bodies, only: bodies_of_meshes
  use sg_options_from_deck, only: options_from_deck
  use sg_recovery_checks, only: check_recovery
  use sg_repeat_blocks, only: repeat_blocks
  use sg_rolling_checks, only: stages_bear_moments
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_scene_from_deck, only: scene_from_deck
  use sg_sense_checks, only: check_sense
  use sg_stage_deck, only: deck_of_stage, list_stages, split_changes
  use sg_stages, only: stages_t
  use sg_settings, only: apply_settings
  use sg_text, only: text_t
  use sg_toml, only: document_t, parse_toml, read_content, toml_table
  use sg_toml_pieces, only: find_pieces
  use sg_tracks_from_deck, only: list_body_names, name_walls, tracks_from_deck
  use sg_wall_list_from_deck, only: wall_list_from_deck
  implicit none
  private
  public :: read_deck, read_share, parts_of_deck

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
  !! The rank keeps a part of it (`sg_bodies_from_deck`); that no grains overlap is then to be checked by all ranks together
  !! (`sg_shared_start`). No message is sent here: the ranks may not read the same deck. Of a deck with stages the scene is that of
  !! the stage that is due, the first one unless `stages` has others behind it; the other stages are checked by rank 0.
  subroutine read_share(file, settings, comm, scene, options, deck, diagnostics, stages)
    character(len=*), intent(in) :: file !! path of the deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it, each `section.key=value`
    type(comm_t), intent(in) :: comm !! the ranks
    type(scene_t), intent(out) :: scene !! what exists, as far as this rank keeps it
    type(run_options_t), intent(out) :: options !! what to do with it
    type(deck_t), intent(out) :: deck !! the deck itself, or that of the stage, for checks to come
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(stages_t), intent(inout), optional :: stages !! stages of the run so far; set to those of the deck
    type(stages_t) :: run
    type(deck_t) :: whole

    call read_blocks(file, settings, deck, diagnostics)
    if (diagnostics%count() > 0) return
    deck%rank = comm%rank
    deck%ranks = comm%size
    if (deck%count_of('stage') == 0) then
      if (deck%is_given(deck%block_of('repeat'), 'count')) whole = deck
      call read_things(deck, scene, options, diagnostics)
      if (diagnostics%count() > 0) return
      if (allocated(whole%blocks)) then
        call effective_deck(whole, options%deck_text, options%deck_hash)
      else
        call effective_deck(deck, options%deck_text, options%deck_hash)
      end if
      return
    end if
    if (present(stages)) run = stages
    call list_stages(deck, run, diagnostics)
    if (diagnostics%count() > 0) return
    call run%place()
    deck%bears_moments = stages_bear_moments(deck)
    whole = deck
    call read_stage(whole, run, run%number, deck, scene, options, diagnostics)
    ! One rank is enough: a stage that is due is read by all.
    if (.not. run%are_checked .and. comm%rank == 0 .and. diagnostics%count() == 0) call check_stages(whole, run, diagnostics)
    run%are_checked = .true.
    if (present(stages)) stages = run
    if (diagnostics%count() > 0) return
    if (.not. run%begins) scene%start_time = run%list(run%number)%origin
    call effective_deck(whole, options%deck_text, options%deck_hash)
  end subroutine read_share

  !> Scene and options of a stage.
  subroutine read_stage(whole, run, number, deck, scene, options, diagnostics)
    type(deck_t), intent(in) :: whole
    type(stages_t), intent(in) :: run
    integer, intent(in) :: number
    type(deck_t), intent(out) :: deck
    type(scene_t), intent(out) :: scene
    type(run_options_t), intent(out) :: options
    type(diagnostics_t), intent(inout) :: diagnostics

    call deck_of_stage(whole, run, number, deck, diagnostics)
    if (diagnostics%count() == 0) call check_blocks(deck, diagnostics)
    if (diagnostics%count() == 0) call check_sense(deck, diagnostics)
    if (diagnostics%count() == 0) call read_things(deck, scene, options, diagnostics)
  end subroutine read_stage

  !> Check the stages that are not due. Of their findings only mistakes are kept: warnings are those of the deck.
  subroutine check_stages(whole, run, diagnostics)
    type(deck_t), intent(in) :: whole
    type(stages_t), intent(in) :: run
    type(diagnostics_t), intent(inout) :: diagnostics
    type(diagnostics_t) :: found
    type(deck_t) :: deck
    type(scene_t) :: scene
    type(run_options_t) :: options
    integer :: s, i

    do s = 1, size(run%list)
      if (s == run%number) cycle
      call read_stage(whole, run, s, deck, scene, options, found)
    end do
    do i = 1, found%count()
      associate (mistake => found%errors(i))
        call diagnostics%add(mistake%message, mistake%file, mistake%line, mistake%column, mistake%text)
      end associate
    end do
  end subroutine check_stages

  !> Scene and options of a deck without stages, or of the deck of one.
  subroutine read_things(deck, scene, options, diagnostics)
    type(deck_t), intent(inout) :: deck
    type(scene_t), intent(inout) :: scene
    type(run_options_t), intent(inout) :: options
    type(diagnostics_t), intent(inout) :: diagnostics

    call bodies_of_meshes(deck, diagnostics)
    if (diagnostics%count() > 0) return
    call repeat_blocks(deck, diagnostics)
    if (diagnostics%count() > 0) return
    call options_from_deck(deck, options, diagnostics)
    call scene_from_deck(deck, options, scene, diagnostics)
    if (diagnostics%count() > 0) return
    call check_recovery(deck, scene, options, diagnostics)
    call tracks_from_deck(deck, scene%bodies%n + deck%absent%n, options, diagnostics)
    call fields_from_deck(deck, scene%dimension, options, diagnostics)
    call regions_from_deck(deck, scene%dimension, options, diagnostics)
    call interfaces_from_deck(deck, scene, options, diagnostics)
    call wall_list_from_deck(deck, scene, options%walls)
    call name_walls(deck, options)
    call list_body_names(deck, options)
  end subroutine read_things

  !> Subdomains that a deck asks for; 0 for one per rank, and where the deck has mistakes, which are reported when it is read as a
  !! whole. A deck without the word is not taken apart.
  integer function parts_of_deck(file, settings) result(parts)
    character(len=*), intent(in) :: file !! path of the deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it
    character(len=*), parameter :: word = 'parts'
    type(deck_t) :: deck
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    character(len=:), allocatable :: content
    integer :: i

    parts = 0
    call read_content(file, content, error)
    if (allocated(error)) return
    if (index(content, word) == 0 .and. .not. any([(index(settings(i)%s, word) > 0, i=1, size(settings))])) return
    call read_blocks(file, settings, deck, diagnostics)
    if (diagnostics%count() == 0) parts = deck%integer(deck%block_of('partition'), word)
  end function parts_of_deck

  !> Read a deck as blocks of checked values.
  subroutine read_blocks(file, settings, deck, diagnostics)
    character(len=*), intent(in) :: file !! path of the deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it
    type(deck_t), intent(out) :: deck !! its blocks
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(error_t), allocatable :: error
    type(constants_t) :: constants
    type(text_t), allocatable :: others(:)
    logical :: is_read

    deck%file = file
    deck%folder = file(:index(file, '/', back=.true.))
    call read_content(file, deck%content, error)
    call take_constant_settings(settings, constants, others)
    is_read = .false.
    if (.not. allocated(error)) call read_pieces(deck, diagnostics, is_read)
    if (.not. allocated(error) .and. .not. is_read) call read_whole(deck, constants, diagnostics, error)
    if (allocated(error)) then
      call diagnostics%add(error%message, error%file, error%line, error%column, error%text)
      return
    end if
    if (constants%are_bad) return
    call split_changes(deck)
    call check_constant_settings(constants, diagnostics)
    call apply_settings(others, deck, diagnostics)
    call dimension_from_deck(deck)
    call check_blocks(deck, diagnostics)
    if (diagnostics%count() == 0) call check_sense(deck, diagnostics)
    if (diagnostics%count() > 1) call sort_by_line(diagnostics%errors)
  end subroutine read_blocks

  !> Take the blocks of a deck from its whole text.
  subroutine read_whole(deck, constants, diagnostics, error)
    type(deck_t), intent(inout) :: deck
    type(constants_t), intent(inout) :: constants
    type(diagnostics_t), intent(inout) :: diagnostics
    type(error_t), allocatable, intent(out) :: error
    type(document_t) :: document
    logical :: is_again

    call parse_toml(deck%content, document, error, deck%file)
    if (allocated(error)) return
    if (size(document%entries) == 0) then
      call fail(error, 'the deck is empty', file=deck%file)
      return
    end if
    call open_deck(deck, all_keys(), count(document%entries%kind == toml_table))
    call put_constants(document, constants, deck, diagnostics)
    if (constants%are_bad) return
    call collect(document, deck, diagnostics, is_again)
  end subroutine read_whole

  !> Read the blocks of a long deck without constants piece by piece. Where that fails, the whole text is read to report why.
  subroutine read_pieces(deck, diagnostics, is_read)
    type(deck_t), intent(inout) :: deck
    type(diagnostics_t), intent(inout) :: diagnostics
    logical, intent(out) :: is_read
    type(document_t) :: document
    type(error_t), allocatable :: error
    type(deck_t) :: no_deck
    type(diagnostics_t) :: none
    character(len=:), allocatable :: piece
    integer, allocatable :: first(:), line(:)
    integer :: i, n_headers
    logical :: is_again

    is_read = .false.
    call find_pieces(deck%content, first, line, n_headers)
    if (size(line) == 1 .or. index(deck%content, 'constants') > 0) return
    call open_deck(deck, all_keys(), n_headers)
    is_again = .false.
    do i = 1, size(line)
      piece = part_of(deck%content, first(i), first(i + 1) - 1)
      call parse_toml(piece, document, error, lines_before=line(i))
      if (.not. allocated(error)) call collect(document, deck, diagnostics, is_again)
      if (.not. (allocated(error) .or. is_again)) cycle
      diagnostics = none
      no_deck%file = deck%file
      no_deck%folder = deck%folder
      call move_alloc(deck%content, no_deck%content)
      deck = no_deck
      return
    end do
    is_read = .true.
  contains
    !> Some bytes of a text.
    pure function part_of(text, from, to) result(part)
      character(len=*), intent(in) :: text
      integer, intent(in) :: from, to
      character(len=to - from + 1) :: part

      part = text(from:to)
    end function part_of
  end subroutine read_pieces

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
