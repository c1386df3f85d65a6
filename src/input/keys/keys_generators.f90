!> The key table, fourth part: what is generated; boxes, masonry and samples of grains.
module sg_keys_generators
  use sg_key_table, only: in_plane, in_space, key_table_t, value_box, value_choice, value_function, value_integer, value_logical, &
                          value_pair, value_pairs, value_range, value_real, value_sides, value_text, value_texts, &
                          value_triple, value_vector
  use sg_keys_bodies, only: add_clump_keys, add_common, add_entry
  use sg_kinds, only: wp, pi
  use sg_words, only: short_real
  implicit none
  private
  public :: add_generator_keys

contains

  !> Sections container, brick_wall, arch, chain, blocks, clump and sample.
  subroutine add_generator_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call add_containers(table)
    call add_masonry(table)
    call add_chains(table)
    call add_blocks(table)
    call add_clump_keys(table)
    call add_samples(table)
  end subroutine add_generator_keys

  !> Section container.
  subroutine add_containers(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('container', 'A box of planes about a room: bodies named floor, left and right (along x), front '// &
                            'and back (along y) and lid, with the container''s name and a dot before. Along a period there are '// &
                            'no sides. A plane stands still, but in the components that a [[drive]] or [[pressure]] takes.', &
                            is_list=.true., dimension=in_space)
    call table%add('name', value_text, 'Name, the first part of the names of the planes.', default='"box"')
    call add_common(table, 'wall')
    call table%add('corner', value_triple, 'Least corner of the room.', unit='m', default='[0.0, 0.0, 0.0]')
    call table%add('size', value_triple, 'Inner lengths of the room along x, y and z.', unit='m', is_required=.true., above=0.0_wp)
    call table%add('thickness', value_real, 'Thickness of the planes; default: a tenth of the shortest length.', unit='m', &
                   above=0.0_wp)
    call table%add('lid', value_logical, 'Close the room above.', default='false')
    call table%add('sides', value_logical, 'Close the room at its four sides.', default='true')
    call table%add('stress_xx', value_function, 'Stress along x, positive in compression: the plane right is pressed towards '// &
                   'left, which stands still, on the area that they close now; a number or an expression of the time t. A '// &
                   '[[drive]] or [[pressure]] on the plane along x takes its place.', unit='Pa')
    call table%add('stress_yy', value_function, 'The same along y: back is pressed towards front.', unit='Pa')
    call table%add('stress_zz', value_function, 'The same along z: the lid is pressed towards the floor.', unit='Pa')
  end subroutine add_containers

  !> Sections brick_wall and arch.
  subroutine add_masonry(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('brick_wall', 'A wall of bricks in running bond: every second row begins and ends with half a '// &
                            'brick. The bricks are named by row and column from 1, such as wall.2.3.', is_list=.true., &
                            dimension=in_space)
    call table%add('name', value_text, 'Name, the first part of the names of the bricks.', default='"wall"')
    call add_common(table, 'brick')
    call table%add('position', value_triple, 'Where the wall begins: the middle of its foot at the end of the first bricks.', &
                   unit='m', default='[0.0, 0.0, 0.0]')
    call table%add('angle', value_real, 'Direction of the rows, counter-clockwise from x.', unit='rad', default='0.0')
    call table%add('rows', value_integer, 'Rows, one on the other.', is_required=.true., least=1.0_wp, most=1e4_wp)
    call table%add('columns', value_integer, 'Whole bricks in the first row.', is_required=.true., least=1.0_wp, most=1e4_wp)
    call table%add('brick', value_triple, 'Length, depth and height of a brick.', unit='m', is_required=.true., above=0.0_wp)
    call table%add('joint', value_real, 'Gap between the ends of two bricks of a row; rows lie on each other.', unit='m', &
                   default='0.0', least=0.0_wp)

    call table%open_section('arch', 'A round arch of voussoirs in a vertical plane, named by their number from 1, such as '// &
                            'arch.1.', &
                            is_list=.true., dimension=in_space)
    call table%add('name', value_text, 'Name, the first part of the names of the voussoirs.', default='"arch"')
    call add_common(table, 'brick')
    call table%add('centre', value_triple, 'Centre of the circles, in the middle of the depth.', unit='m', &
                   default='[0.0, 0.0, 0.0]')
    call table%add('angle', value_real, 'Direction from springer to springer, counter-clockwise from x.', unit='rad', default='0.0')
    call table%add('voussoirs', value_integer, 'Number of voussoirs.', is_required=.true., least=2.0_wp, most=1000.0_wp)
    call table%add('inner_radius', value_real, 'Radius of the intrados.', unit='m', is_required=.true., above=0.0_wp)
    call table%add('outer_radius', value_real, 'Radius of the extrados.', unit='m', is_required=.true., above=0.0_wp)
    call table%add('depth', value_real, 'Depth across the plane of the arch.', unit='m', is_required=.true., above=0.0_wp)
    call table%add('opening', value_real, 'Angle from springer to springer: pi for half a circle.', unit='rad', &
                   default=short_real(pi), above=0.0_wp, most=pi*(1 + epsilon(pi)))
    call table%add('fixed_ends', value_logical, 'Hold the first and the last voussoir.', default='false')
  end subroutine add_masonry

  !> Section chain.
  subroutine add_chains(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('chain', 'A membrane: disks along a line, named by their number from 1, such as chain.1, and a '// &
                            'link from each centre to the next one. Disks next to each other must not touch by an '// &
                            '[[interaction]] too, if the chain is to be shortened.', is_list=.true., dimension=in_plane)
    call table%add('name', value_text, 'Name, the first part of the names of the disks.', default='"chain"')
    call add_common(table, 'chain')
    call table%add('from', value_pair, 'Centre of the first disk.', unit='m', is_required=.true.)
    call table%add('to', value_pair, 'Centre of the last disk.', unit='m', is_required=.true.)
    call table%add('count', value_integer, 'Number of disks, at even distances.', is_required=.true., least=2.0_wp, most=1e5_wp)
    call table%add('radius', value_real, 'Radius of the disks.', unit='m', is_required=.true., above=0.0_wp)
    call table%add('law', value_text, 'Name of the law of the links; default: the only one.')
  end subroutine add_chains

  !> Section blocks.
  subroutine add_blocks(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('blocks', 'Bodies from mesh files, OBJ or STL: one for each object of a file (`o name` in an OBJ), '// &
                            'named after it, or one for the file, named after that. Each must be closed and convex, or of '// &
                            'convex parts, as `splitgrain convex` writes them (guide/blocks.md). They are numbered as the last '// &
                            '[[body]].', is_list=.true., dimension=in_space)
    call table%add('files', value_texts, 'Files, or patterns with * and ?, relative to the deck.', is_required=.true.)
    call table%add('name', value_text, 'First part of the names, before a dot; default: none.')
    call add_common(table, 'grain')
    call table%add('position', value_triple, 'Where the origin of the files lies.', unit='m', default='[0.0, 0.0, 0.0]')
    call table%add('rotation', value_triple, 'Orientation: the rotation about this vector by its length.', unit='rad', &
                   default='[0.0, 0.0, 0.0]')
    call table%add('scale', value_real, 'Length of a unit of the files.', unit='m', default='1.0', above=0.0_wp)
    call table%add('hull', value_logical, 'Take the convex hull of each part.', default='false')
    call table%add('fixed', value_texts, 'Bodies that never move, by name with * and ?.')
  end subroutine add_blocks

  !> Section sample.
  subroutine add_samples(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('sample', 'Many grains in a box, without overlap: on a lattice, inserted at random, or grown.', &
                            is_list=.true.)
    call table%add('kind', value_choice, 'How grains are placed: inserted at random, on a lattice, or grown from small ones '// &
                   'at random places, which push each other apart until all have their size.', default='"random"', &
                   choices='random|lattice|grown')
    call table%add('shape', value_choice, 'Shape of the grains.', default='"disk"', choices='disk|polygon|clump', &
                   space_default='"sphere"', space_choices='sphere|polyhedron|clump')
    call table%add('clump', value_texts, 'Name of the [[clump]] that all grains are copies of, or several names, of which '// &
                   'each grain draws one.', is_required=.true., only='shape=clump')
    call table%add('files', value_texts, 'Shapes of the polyhedra: mesh files, STL or OBJ, relative to the deck, with '// &
                   'wildcards (one text or several): each grain draws one.', only='shape=polyhedron', dimension=in_space)
    call table%add('hull', value_logical, 'Take the convex hull of each file''s vertices; default: no, a shape that is not '// &
                   'convex is refused.', only='files', dimension=in_space)
    call table%add('box', value_box, 'Box that holds all grains: [x least, y least, x most, y most], in space '// &
                   '[x least, y least, z least, x most, y most, z most]. Over the whole period of a periodic scene grains go '// &
                   'through its sides.', unit='m', is_required=.true.)
    call table%add('count', value_integer, 'Number of grains; a lattice without it is filled.', least=1.0_wp, most=1e7_wp)
    call table%add('fill', value_real, 'In place of count: area of the grains'' circles over that of the box; in '// &
                   'space volumes.', above=0.0_wp, &
                   most=0.9_wp, only='kind=random|grown')
    call table%add('radius', value_range, 'Radius of the circle or sphere about a grain (of a clump or a shape from a file: '// &
                   'about its centre of mass): one number, or [least, most].', unit='m', above=0.0_wp)
    call table%add('sieve', value_pairs, 'In place of radius: a grain size curve, [[opening in m, percent of the mass that '// &
                   'passes], ...], from 0 to 100 %. A polyhedron passes an opening as wide as its middle axis; a clump or a '// &
                   'shape from a file the smallest square one, in the plane the narrowest slit, that it fits through straight.', &
                   least=0.0_wp)
    call table%add('curve', value_choice, 'In place of radius: a named grain size curve, for railway ballast the middle of the '// &
                   'limits of a category of EN 13450.', choices='ballast_a|ballast_d|ballast_e|ballast_f')
    call table%add('distribution', value_choice, 'How radii are spread: evenly by number; evenly by area or volume (as many '// &
                   'grains as make each size class weigh the same); lognormal (median in the geometric middle, ends two '// &
                   'deviations away, cut there); all the same (the least).', default='"uniform"', &
                   choices='uniform|volume|lognormal|constant', only='radius')
    call table%add('sides', value_sides, 'Number of sides of polygons: one number, or [least, most].', default='[5, 8]', &
                   least=3.0_wp, most=64.0_wp, only='shape=polygon', dimension=in_plane, twin='vertices')
    call table%add('vertices', value_sides, 'Number of vertices of polyhedra, which lie on an ellipsoid: one number, or '// &
                   '[least, most].', default='[8, 20]', least=4.0_wp, most=64.0_wp, only='shape=polyhedron', &
                   dimension=in_space, twin='sides')
    call table%add('elongation', value_range, 'Longest over shortest axis of that ellipsoid, the third between the two: one '// &
                   'number, or [least, most].', default='1.0', least=1.0_wp, most=10.0_wp, only='shape=polyhedron', &
                   dimension=in_space)
    call table%add('flatness', value_range, 'Middle over shortest axis of that ellipsoid, at most its elongation: one '// &
                   'number, or [least, most]; default: the middle axis is drawn between the two others.', least=1.0_wp, &
                   most=10.0_wp, only='shape=polyhedron', dimension=in_space)
    call table%add('seed', value_integer, 'Seed of the random numbers: the same seed gives the same grains.', default='1')
    call table%add('arrangement', value_choice, 'Lattice; fcc and hexagonal are the two densest in space.', &
                   default='"square"', choices='square|triangular', only='kind=lattice', &
                   space_default='"cubic"', space_choices='cubic|hexagonal|fcc')
    call table%add('spacing', value_real, 'Distance of lattice points over the largest diameter.', default='1.05', least=1.0_wp, &
                   only='kind=lattice')
    call table%add('jitter', value_real, 'Random shift of lattice grains, as a share of the room that is free.', default='0.0', &
                   least=0.0_wp, most=1.0_wp, only='kind=lattice')
    call table%add('clearance', value_real, 'Least distance between two grains inserted at random or grown.', unit='m', &
                   default='0.0', least=0.0_wp, only='kind=random|grown')
    call add_common(table, 'grain')
    call add_entry(table)
    call table%add('velocity', value_vector, 'Velocity at the start.', unit='m/s', default='[0.0, 0.0]', &
                   space_default='[0.0, 0.0, 0.0]')
  end subroutine add_samples
end module sg_keys_generators
