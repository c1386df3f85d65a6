!> The key table, third part: bodies and walls.
module sg_keys_bodies
  use sg_key_table, only: in_plane, in_space, key_table_t, value_bodies, value_choice, value_faces, value_function, value_logical, &
                          value_moment, value_pair, value_points, value_real, value_text, value_triple, value_turn, value_vector
  use sg_keys_scene, only: plane_shapes, space_shapes
  use sg_kinds, only: wp
  implicit none
  private
  public :: add_body_keys, add_clump_keys, add_common, add_entry

  !> Shapes that a body may have in space
  character(len=*), parameter :: solid_shapes = space_shapes//'|box'
  !> Shapes that a clump may have: those that fill space
  character(len=*), parameter :: plane_clump_shapes = 'disk|polygon', space_clump_shapes = 'sphere|cylinder|polyhedron|box'

contains

  !> Sections body, body.shape and wall.
  subroutine add_body_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call add_bodies(table)
    call add_walls(table)
  end subroutine add_body_keys

  !> When bodies of a block enter.
  subroutine add_entry(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call table%add('at', value_moment, 'When it enters: a time from the start of the run, or the name of '// &
                   'the stage with which it enters (guide/insertion.md); default: it is there from the start.', unit='s', &
                   least=0.0_wp)
  end subroutine add_entry

  !> Sections body and body.shape.
  subroutine add_bodies(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('body', 'One rigid body, with one shape of its own or several [[body.shape]] (a cluster). Mass, '// &
                            'inertia and centre come from density and shapes (what two shapes share counts twice); a hollow '// &
                            'disk or cylinder weighs nothing.', is_list=.true.)
    call table%add('name', value_text, 'Name by which drives call it.')
    call add_common(table, 'grain')
    call table%add('position', value_vector, 'Where the origin of the shapes lies.', unit='m', default='[0.0, 0.0]', &
                   space_default='[0.0, 0.0, 0.0]')
    call table%add('angle', value_real, 'Orientation, counter-clockwise.', unit='rad', default='0.0', dimension=in_plane, &
                   twin='rotation')
    call table%add('rotation', value_triple, 'Orientation: the rotation about this vector by its length.', unit='rad', &
                   default='[0.0, 0.0, 0.0]', dimension=in_space, twin='angle')
    call table%add('velocity', value_vector, 'Velocity of the centre of mass at the start.', unit='m/s', default='[0.0, 0.0]', &
                   space_default='[0.0, 0.0, 0.0]')
    call table%add('spin', value_turn, 'Angular velocity at the start; in space about the axes of the world.', unit='rad/s', &
                   default='0.0', space_default='[0.0, 0.0, 0.0]')
    call table%add('fixed', value_logical, 'Never moves.', default='false')
    call add_entry(table)
    call table%add('mass', value_real, 'Mass, in place of that of the shapes; in the plane per metre of depth.', unit='kg', &
                   above=0.0_wp)
    call table%add('inertia', value_turn, 'Moment of inertia about the centre, in place of that of the shapes; in space the '// &
                   'moments about the principal axes that are nearest to x, y and z of the body.', unit='kg m2', above=0.0_wp)
    call table%add('shape', value_choice, 'Its only shape, when it has one.', choices=plane_shapes, space_choices=solid_shapes)
    call add_sizes(table, 'shape')

    call table%open_section('body.shape', 'One shape of the body above it.', is_list=.true.)
    call add_shape_keys(table, plane_shapes, solid_shapes, 'Colour; default: that of the body.')
  end subroutine add_bodies

  !> Keys of one shape of several.
  subroutine add_shape_keys(table, in_the_plane, in_the_space, colour)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: in_the_plane, in_the_space, colour

    call table%add('kind', value_choice, 'Kind of shape.', is_required=.true., choices=in_the_plane, space_choices=in_the_space)
    call table%add('colour', value_text, colour)
    call add_sizes(table, 'kind')
    call table%add('centre', value_vector, 'Where the origin of the shape lies in the frame of the body.', unit='m', &
                   default='[0.0, 0.0]', space_default='[0.0, 0.0, 0.0]')
    call table%add('angle', value_real, 'Orientation of the shape in the frame of the body.', unit='rad', default='0.0', &
                   only='kind=segment|polygon', dimension=in_plane, twin='rotation')
    call table%add('rotation', value_triple, 'Orientation of the shape in the frame of the body: the rotation about this '// &
                   'vector by its length.', unit='rad', default='[0.0, 0.0, 0.0]', dimension=in_space, twin='angle', &
                   only='kind=plane|cylinder|hollow cylinder|polyhedron|box')
  end subroutine add_shape_keys

  !> Sections clump and clump.shape.
  subroutine add_clump_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call table%open_section('clump', 'A template of grains: shapes joined to one rigid body, which a [[sample]] with shape = '// &
                            '"clump" places many times, each at its size and turned at random. Lengths are those of any unit '// &
                            'where the sample gives sizes.', is_list=.true.)
    call table%add('name', value_text, 'Name by which samples call it.', is_required=.true.)
    call table%add('colour', value_text, 'Colour of its shapes; default: that of the sample.')
    call table%add('mass_of', value_choice, 'Mass, centre and moments: of the union of the shapes (what they share counts '// &
                   'once), or of their sum (it counts for each), as those of [[body]].', default='"union"', choices='union|sum')

    call table%open_section('clump.shape', 'One shape of the clump above it.', is_list=.true.)
    call add_shape_keys(table, plane_clump_shapes, space_clump_shapes, 'Colour; default: that of the clump.')
  end subroutine add_clump_keys

  !> Material and colour.
  subroutine add_common(table, colour)
    type(key_table_t), intent(inout) :: table !! table to add to
    character(len=*), intent(in) :: colour !! default of the colour

    call table%add('material', value_text, 'Name of the material; default: the only one.')
    call table%add('colour', value_text, 'Colour, by which interactions distinguish bodies.', default='"'//colour//'"')
  end subroutine add_common

  !> Sizes of a shape that another key chooses.
  subroutine add_sizes(table, selector)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: selector

    call table%add('radius', value_real, 'Radius; of a hollow disk or cylinder the inner one.', unit='m', is_required=.true., &
                   above=0.0_wp, only=selector//'=disk|hollow disk|sphere|cylinder|hollow cylinder')
    call table%add('half_length', value_real, 'Half length of the axis of a rounded segment.', unit='m', is_required=.true., &
                   above=0.0_wp, only=selector//'=segment', dimension=in_plane, twin='half_height')
    call table%add('half_thickness', value_real, 'Half thickness of a rounded segment, the radius of its caps.', unit='m', &
                   is_required=.true., above=0.0_wp, only=selector//'=segment', dimension=in_plane, twin='radius')
    call table%add('half_height', value_real, 'Half length of the axis of a cylinder, which lies along z. A cylinder ends in '// &
                   'half spheres beyond its axis (a capsule), a hollow one is open at both ends.', unit='m', is_required=.true., &
                   above=0.0_wp, only=selector//'=cylinder|hollow cylinder', dimension=in_space, twin='half_length')
    call table%add('half_axes', value_triple, 'Half lengths of the sides of a box or a plane along x, y and z. A plane is a '// &
                   'thin box that other planes and boxes pass through; its thickness lies along z.', unit='m', &
                   is_required=.true., above=0.0_wp, only=selector//'=plane|box', dimension=in_space)
    call table%add('vertices', value_points, 'Vertices of a convex polygon, counter-clockwise; in space those of a convex '// &
                   'polyhedron, in any order.', unit='m', only=selector//'=polygon|polyhedron')
    call table%add('faces', value_faces, 'Faces of the polyhedron: numbers of vertices from 1, counter-clockwise seen from '// &
                   'outside. Without faces it is the hull of the vertices.', least=1.0_wp, &
                   only=selector//'=polyhedron', dimension=in_space)
    call table%add('file', value_text, 'In place of vertices: file with the surface of the polyhedron, STL or OBJ, relative to '// &
                   'the deck.', only=selector//'=polyhedron', dimension=in_space)
    call table%add('scale', value_real, 'Length of a unit of the file; default: one metre.', unit='m', above=0.0_wp, &
                   only=selector//'=polyhedron', dimension=in_space)
    call table%add('hull', value_logical, 'Take the convex hull of the file''s vertices; default: no.', &
                   only=selector//'=polyhedron', dimension=in_space)
  end subroutine add_sizes

  !> Section wall.
  subroutine add_walls(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('wall', 'In the plane a rounded segment about the axis from one point to another, whose faces lie '// &
                            'half a thickness beside the axis; in space a plane with a rectangular face, its thickness '// &
                            'behind the face. It is fixed, or moves with a velocity, or is pressed; a [[drive]] or '// &
                            '[[pressure]] on it takes its component over.', is_list=.true.)
    call table%add('name', value_text, 'Name by which drives call it.')
    call add_common(table, 'wall')
    call table%add('from', value_pair, 'One end of the axis.', unit='m', is_required=.true., dimension=in_plane, twin='centre')
    call table%add('to', value_pair, 'Other end of the axis.', unit='m', is_required=.true., dimension=in_plane, twin='size')
    call table%add('centre', value_triple, 'Centre of the face.', unit='m', is_required=.true., dimension=in_space, twin='from')
    call table%add('normal', value_triple, 'Normal of the face, of any length, towards the grains.', default='[0.0, 0.0, 1.0]', &
                   dimension=in_space)
    call table%add('size', value_pair, 'Sides of the face: of one that is level along x and y; of others the level side, then '// &
                   'the one that rises.', unit='m', is_required=.true., above=0.0_wp, dimension=in_space, twin='to')
    call table%add('thickness', value_real, 'Thickness; in the plane twice the radius of the caps.', unit='m', &
                   is_required=.true., above=0.0_wp)
    call add_entry(table)
    call table%add('velocity', value_vector, 'Constant velocity of the wall.', unit='m/s', default='[0.0, 0.0]', &
                   space_default='[0.0, 0.0, 0.0]')
    call table%add('pressure', value_function, 'Pressure on the wall, which then moves along the direction alone; a number or '// &
                   'an expression of the time t.', unit='Pa')
    call table%add('direction', value_vector, 'Direction of the pressure: along x or along y, in space also along z.', &
                   only='pressure')
    call table%add('between', value_bodies, 'Two walls whose free distance is the pressed length; default: the length of '// &
                   'the axis.', dimension=in_plane, only='pressure')
  end subroutine add_walls
end module sg_keys_bodies
