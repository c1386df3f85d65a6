!> The key table, fifth part: bodies that come after the start, and bodies that leave.
module sg_keys_passages
  use sg_key_table, only: in_plane, in_space, key_table_t, value_body, value_box, value_choice, value_integer, value_moment, &
                          value_pairs, value_range, value_real, value_sides, value_vector
  use sg_keys_bodies, only: add_common
  use sg_kinds, only: wp
  use sg_passages, only: exit_t
  use sg_text, only: to_text
  implicit none
  private
  public :: add_passage_keys

contains

  !> Sections rain and remove.
  subroutine add_passage_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call add_rain(table)
    call add_removal(table)
  end subroutine add_passage_keys

  !> Section rain.
  subroutine add_rain(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('rain', 'Grains that enter one after the other, at a rate, at random places of a box '// &
                            '(guide/insertion.md). Each waits until no other grain is in its place.', is_list=.true.)
    call table%add('shape', value_choice, 'Shape of the grains.', default='"disk"', choices='disk|polygon', &
                   space_default='"sphere"', space_choices='sphere|polyhedron')
    call table%add('box', value_box, 'Window: the box in which grains enter, whole: [x least, y least, x most, y most], in '// &
                   'space [x least, y least, z least, x most, y most, z most]. No wall may stand in it.', unit='m', &
                   is_required=.true.)
    call table%add('count', value_integer, 'Number of grains.', is_required=.true., least=1.0_wp, most=1e7_wp)
    call table%add('rate', value_real, 'Grains per time.', unit='1/s', is_required=.true., above=0.0_wp)
    call table%add('at', value_moment, 'When the first grain is due: a time from the start of the run, or the name of a stage.', &
                   unit='s', default='0.0', least=0.0_wp)
    call table%add('every', value_integer, 'Steps from one look at the grains that are due to the next.', default='10', &
                   least=1.0_wp)
    call table%add('radius', value_range, 'Radius of the circle or sphere about a grain: one number, or [least, most].', unit='m', &
                   above=0.0_wp)
    call table%add('sieve', value_pairs, 'In place of radius: a grain size curve, as in [[sample]].', least=0.0_wp)
    call table%add('curve', value_choice, 'In place of radius: a named grain size curve, as in [[sample]].', &
                   choices='ballast_a|ballast_d|ballast_e|ballast_f')
    call table%add('distribution', value_choice, 'How radii are spread, as in [[sample]].', default='"uniform"', &
                   choices='uniform|volume|lognormal|constant', only='radius')
    call table%add('sides', value_sides, 'Number of sides of polygons: one number, or [least, most].', default='[5, 8]', &
                   least=3.0_wp, most=64.0_wp, only='shape=polygon', dimension=in_plane, twin='vertices')
    call table%add('vertices', value_sides, 'Number of vertices of polyhedra, as in [[sample]].', default='[8, 20]', &
                   least=4.0_wp, most=64.0_wp, only='shape=polyhedron', dimension=in_space, twin='sides')
    call table%add('elongation', value_range, 'Longest over shortest axis of polyhedra, as in [[sample]].', default='1.0', &
                   least=1.0_wp, most=10.0_wp, only='shape=polyhedron', dimension=in_space)
    call table%add('flatness', value_range, 'Middle over shortest axis of polyhedra, as in [[sample]].', least=1.0_wp, &
                   most=10.0_wp, only='shape=polyhedron', dimension=in_space)
    call table%add('seed', value_integer, 'Seed of the random numbers: the same seed gives the same grains.', default='1')
    call add_common(table, 'grain')
    call table%add('velocity', value_vector, 'Velocity with which grains enter.', unit='m/s', default='[0.0, 0.0]', &
                   space_default='[0.0, 0.0, 0.0]')
  end subroutine add_rain

  !> Section remove.
  subroutine add_removal(table)
    type(key_table_t), intent(inout) :: table
    type(exit_t) :: default

    call table%open_section('remove', 'Bodies that leave the scene for good, between two steps: those whose centres are in a '// &
                            'box or out of it, or at a time (guide/insertion.md). Their numbers stay.', is_list=.true.)
    call table%add('box', value_box, 'The box: [x least, y least, x most, y most], in space [x least, y least, z least, '// &
                   'x most, y most, z most]; default: everywhere.', unit='m')
    call table%add('where', value_choice, 'Which bodies leave: those within the box, or those outside of it.', &
                   default='"outside"', choices='inside|outside', only='box')
    call table%add('body', value_body, 'Bodies concerned, walls too, by name, in which * stands for any letters and ? for one, '// &
                   'or by number; default: all grains.')
    call table%add('at', value_moment, 'From when on bodies leave: a time from the start of the run, or the name of a stage; '// &
                   'default: from the start.', unit='s', least=0.0_wp)
    call table%add('every', value_integer, 'Steps from one look at the bodies to the next.', default=to_text(default%every), &
                   least=1.0_wp)
  end subroutine add_removal
end module sg_keys_passages
