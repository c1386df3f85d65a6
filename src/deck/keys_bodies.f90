!> The key table, third part: bodies, walls and samples.
module sg_keys_bodies
  use sg_key_table, only: key_table_t, value_box, value_choice, value_integer, value_logical, value_pair, value_points, &
                          value_range, value_real, value_sides, value_text, value_bodies
  use sg_keys_scene, only: shape_choices
  use sg_kinds, only: wp
  implicit none
  private
  public :: add_body_keys

contains

  !> Sections body, body.shape, wall and sample.
  subroutine add_body_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call add_bodies(table)
    call add_walls(table)
    call add_samples(table)
  end subroutine add_body_keys

  !> Sections body and body.shape.
  subroutine add_bodies(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('body', 'One rigid body, with one shape of its own or several [[body.shape]] (a cluster). Mass, '// &
                            'inertia and centre come from density and shapes (what two shapes share counts twice); a hollow '// &
                            'disk weighs nothing.', is_list=.true.)
    call table%add('name', value_text, 'Name by which drives call it.')
    call add_common(table, 'grain')
    call table%add('position', value_pair, 'Where the origin of the shapes lies.', unit='m', default='[0.0, 0.0]')
    call table%add('angle', value_real, 'Orientation, counter-clockwise.', unit='rad', default='0.0')
    call table%add('velocity', value_pair, 'Velocity at the start.', unit='m/s', default='[0.0, 0.0]')
    call table%add('spin', value_real, 'Angular velocity at the start.', unit='rad/s', default='0.0')
    call table%add('fixed', value_logical, 'Never moves.', default='false')
    call table%add('mass', value_real, 'Mass per metre of depth, in place of that of the shapes.', unit='kg', above=0.0_wp)
    call table%add('inertia', value_real, 'Moment of inertia about the centre, in place of that of the shapes.', unit='kg m2', &
                   above=0.0_wp)
    call table%add('shape', value_choice, 'Its only shape, when it has one.', choices=shape_choices)
    call add_sizes(table, 'shape')

    call table%open_section('body.shape', 'One shape of the body above it.', is_list=.true.)
    call table%add('kind', value_choice, 'Kind of shape.', is_required=.true., choices=shape_choices)
    call table%add('colour', value_text, 'Colour; default: that of the body.')
    call add_sizes(table, 'kind')
    call table%add('centre', value_pair, 'Centre of the shape in the frame of the body.', unit='m', default='[0.0, 0.0]')
    call table%add('angle', value_real, 'Orientation of the shape in the frame of the body.', unit='rad', default='0.0', &
                   only='kind=segment|polygon')
  end subroutine add_bodies

  !> Material and colour.
  subroutine add_common(table, colour)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: colour

    call table%add('material', value_text, 'Name of the material; default: the only one.')
    call table%add('colour', value_text, 'Colour, by which interactions tell bodies apart.', default='"'//colour//'"')
  end subroutine add_common

  !> Sizes of a shape that another key chooses.
  subroutine add_sizes(table, selector)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: selector

    call table%add('radius', value_real, 'Radius; of a hollow disk the inner one.', unit='m', is_required=.true., above=0.0_wp, &
                   only=selector//'=disk|hollow disk')
    call table%add('half_length', value_real, 'Half length of the axis of a rounded segment.', unit='m', is_required=.true., &
                   above=0.0_wp, only=selector//'=segment')
    call table%add('half_thickness', value_real, 'Half thickness of a rounded segment, the radius of its caps.', unit='m', &
                   is_required=.true., above=0.0_wp, only=selector//'=segment')
    call table%add('vertices', value_points, 'Vertices of a convex polygon, counter-clockwise.', unit='m', is_required=.true., &
                   only=selector//'=polygon')
  end subroutine add_sizes

  !> Section wall.
  subroutine add_walls(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('wall', 'A rounded segment about the axis from one point to another; its faces lie half a '// &
                            'thickness beside the axis. It is fixed, or moves with a velocity, or is pressed; a [[drive]] or '// &
                            '[[pressure]] on it takes its component over.', is_list=.true.)
    call table%add('name', value_text, 'Name by which drives call it.')
    call add_common(table, 'wall')
    call table%add('from', value_pair, 'One end of the axis.', unit='m', is_required=.true.)
    call table%add('to', value_pair, 'Other end of the axis.', unit='m', is_required=.true.)
    call table%add('thickness', value_real, 'Thickness: twice the radius of the caps.', unit='m', is_required=.true., above=0.0_wp)
    call table%add('velocity', value_pair, 'Constant velocity of the wall.', unit='m/s', default='[0.0, 0.0]')
    call table%add('pressure', value_real, 'Pressure on the wall, which then moves along the direction alone.', unit='Pa')
    call table%add('direction', value_pair, 'Direction of the pressure: along x or along y.')
    call table%add('between', value_bodies, 'Two walls whose free distance is the pressed length; default: the length of the axis.')
  end subroutine add_walls

  !> Section sample.
  subroutine add_samples(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('sample', 'Many grains in a box, without overlap: on a lattice, or inserted at random.', is_list=.true.)
    call table%add('kind', value_choice, 'How grains are placed.', default='"random"', choices='random|lattice')
    call table%add('shape', value_choice, 'Shape of the grains.', default='"disk"', choices='disk|polygon')
    call table%add('box', value_box, 'Box that holds all grains: [x least, y least, x most, y most]. Over the whole period of '// &
                   'a periodic scene grains go through its sides.', unit='m', is_required=.true.)
    call table%add('count', value_integer, 'Number of grains; a lattice without it is filled.', least=1.0_wp, most=1e7_wp)
    call table%add('fill', value_real, 'In place of count: area of the grains'' circles over that of the box.', above=0.0_wp, &
                   most=0.9_wp, only='kind=random')
    call table%add('radius', value_range, 'Radius of the circle about a grain: one number, or [least, most].', unit='m', &
                   is_required=.true., above=0.0_wp)
    call table%add('distribution', value_choice, 'How radii are spread: evenly by number; evenly by area (as many grains as '// &
                   'make each size class weigh the same); lognormal (median in the geometric middle, ends two '// &
                   'deviations away, cut there); all the same (the least).', default='"uniform"', &
                   choices='uniform|volume|lognormal|constant')
    call table%add('sides', value_sides, 'Number of sides of polygons: one number, or [least, most].', default='[5, 8]', &
                   least=3.0_wp, most=64.0_wp, only='shape=polygon')
    call table%add('seed', value_integer, 'Seed of the random numbers: the same seed gives the same grains.', default='1')
    call table%add('arrangement', value_choice, 'Lattice.', default='"square"', choices='square|triangular', only='kind=lattice')
    call table%add('spacing', value_real, 'Distance of lattice points over the largest diameter.', default='1.05', least=1.0_wp, &
                   only='kind=lattice')
    call table%add('jitter', value_real, 'Random shift of lattice grains, as a share of the room that is free.', default='0.0', &
                   least=0.0_wp, most=1.0_wp, only='kind=lattice')
    call table%add('clearance', value_real, 'Least distance between two grains inserted at random.', unit='m', default='0.0', &
                   least=0.0_wp, only='kind=random')
    call add_common(table, 'grain')
    call table%add('velocity', value_pair, 'Velocity at the start.', unit='m/s', default='[0.0, 0.0]')
  end subroutine add_samples
end module sg_keys_bodies
