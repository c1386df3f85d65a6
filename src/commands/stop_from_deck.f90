!> End conditions from the section `[stop]` of a deck and from its stages, and their mistakes, with a caret under the word.
module sg_stop_from_deck
  use sg_blocks, only: deck_t
  use sg_body_kinds, only: n_body_kinds
  use sg_cell, only: cell_columns, cell_t
  use sg_error, only: diagnostics_t
  use sg_expression_parser, only: parse_expression
  use sg_expressions, only: expression_t
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, resists_rolling
  use sg_measures, only: measures_t, unmeasured
  use sg_record, only: record_columns
  use sg_report, only: report_t
  use sg_passage_counts, only: n_passage_sums, passage_columns
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_stop, only: stop_t, stop_variables
  use sg_text, only: text_t
  use sg_totals, only: totals_t
  use sg_values, only: from_setting, value_t
  implicit none
  private
  public :: stop_from_deck

contains

  !> Read the conditions.
  subroutine stop_from_deck(deck, scene, options, stops, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene read from it
    type(run_options_t), intent(in) :: options !! options read from it
    type(stop_t), intent(out) :: stops !! the conditions
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(value_t) :: value
    type(text_t), allocatable :: variables(:)
    integer :: b

    b = deck%block_of('stop')
    if (.not. deck%is_given(b, 'when') .and. deck%count_of('stage') == 0) return
    variables = names_of(scene, options)
    ! The deck of a stage holds the conditions of that stage once more, those of all others in their blocks alone.
    do b = 1, deck%n
      if (deck%is_in(b, 'stage')) call check_conditions(deck, b, 'until', options, variables, diagnostics)
      if (deck%is_in(b, 'stop') .and. deck%count_of('stage') == 0) &
        call check_conditions(deck, b, 'when', options, variables, diagnostics)
    end do
    b = deck%block_of('stop')
    if (.not. deck%is_given(b, 'when')) return
    value = deck%value(b, 'when')
    stops%texts = value%words(:value%n_words)
    stops%needed = deck%integer(b, 'for')
    stops%after = deck%number(b, 'after') + deck%stage_time
  end subroutine stop_from_deck

  !> Check the conditions of a block.
  subroutine check_conditions(deck, b, key, options, variables, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: key
    type(run_options_t), intent(in) :: options
    type(text_t), intent(in) :: variables(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value
    integer :: i

    if (.not. deck%is_given(b, key)) return
    if (options%record_every == 0) then
      call deck%complain(diagnostics, 'conditions are tested in recorded steps, but output.record_every is 0', b, key)
      return
    end if
    value = deck%value(b, key)
    do i = 1, value%n_words
      call check_condition(deck, b, key, value, i, variables, diagnostics)
    end do
  end subroutine check_conditions

  !> Names that conditions may use.
  function names_of(scene, options) result(names)
    type(scene_t), intent(in) :: scene
    type(run_options_t), intent(in) :: options
    type(text_t), allocatable :: names(:)
    type(report_t) :: report
    type(totals_t) :: totals
    type(measures_t) :: measures
    type(cell_t) :: cell
    logical :: has_bonds, has_rolling
    integer :: i

    has_bonds = any([(is_cohesive_zone(scene%laws(i)), i=1, size(scene%laws))])
    has_rolling = any(resists_rolling(scene%laws)) .or. scene%bears_moments
    ! A rank alone may hold one kind of bodies of several: a column that the run lacks is reported before its first step.
    measures = unmeasured(scene%dimension, has_bonds, options%record_mean, [(.true., i=1, n_body_kinds)], &
                          has_rolling)
    call cell%begin(options%walls)
    measures%column = [measures%column, cell_columns(cell, scene%dimension)]
    if (scene%bodies%has_presence) measures%column = [measures%column, passage_columns(spread(0.0_wp, 1, n_passage_sums))]
    associate (columns => record_columns(0, 0.0_wp, 0, report, totals, measures))
      if (allocated(options%tracked_names)) then
        names = stop_variables(columns, scene%dimension, options%tracked_names)
      else
        names = stop_variables(columns, scene%dimension, [text_t ::])
      end if
    end associate
  end function names_of

  !> Report what is wrong with a condition, at its place in the deck.
  subroutine check_condition(deck, b, key, value, i, variables, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, i
    character(len=*), intent(in) :: key
    type(value_t), intent(in) :: value
    type(text_t), intent(in) :: variables(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(expression_t) :: expression
    character(len=:), allocatable :: mistake
    integer :: column

    call parse_expression(value%words(i)%s, variables, expression, mistake, column)
    if (.not. allocated(mistake) .and. .not. expression%is_condition) then
      mistake = 'this is no condition: compare it, as in "max_velocity < 1e-4"'
      column = 1
    end if
    if (.not. allocated(mistake)) return
    if (index(mistake, 'there is no "') == 1 .and. index(mistake, '(') > 0 .and. index(mistake, 'did you mean') == 0) &
      mistake = mistake//'; a body is named here where [[track]] follows it'
    if (value%origin == from_setting) then
      call deck%complain(diagnostics, mistake, b, key)
    else
      ! Behind the quotation mark
      call deck%complain_at(diagnostics, mistake, value%word_places(1, i), value%word_places(2, i) + column)
    end if
  end subroutine check_condition
end module sg_stop_from_deck
