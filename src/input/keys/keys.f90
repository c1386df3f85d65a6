!> THE key table: all that a deck may hold, in the order in which the effective deck is written.
module sg_keys
  use sg_key_table, only: key_table_t, value_text
  use sg_keys_bodies, only: add_body_keys
  use sg_keys_generators, only: add_generator_keys
  use sg_keys_passages, only: add_passage_keys
  use sg_keys_run, only: add_run_keys
  use sg_keys_scene, only: add_cell_keys, add_drive_keys, add_law_keys, add_scene_keys
  implicit none
  private
  public :: all_keys

contains

  !> The whole table.
  function all_keys() result(table)
    type(key_table_t) :: table

    call table%open_section('', 'Keys that stand before all sections. They change no answer and are no part of the hash of the '// &
                            'deck.')
    call table%add('title', value_text, 'Title, shown in the log, in run.json and on pages of studies.')
    call table%add('about', value_text, 'What the deck is for, in sentences; shown in run.json and on pages of studies.')
    call table%open_section('constants', 'Numbers with names, each a number or an expression of those above it. In any string '// &
                            'of the deck an expression in braces stands for its number: "{2*width}", "-{speed}*min(1, t/0.1)" '// &
                            '(guide/decks.md). `--set constants.width=2.0` sets one. The effective deck has the numbers alone.')
    call add_scene_keys(table)
    call add_cell_keys(table)
    call add_run_keys(table)
    call add_law_keys(table)
    call add_body_keys(table)
    call add_generator_keys(table)
    call add_passage_keys(table)
    call add_drive_keys(table)
    call table%finish()
  end function all_keys
end module sg_keys
