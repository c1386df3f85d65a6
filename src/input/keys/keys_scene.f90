!> The key table, second part: scene, materials, laws, interactions, and what is imposed.
module sg_keys_scene
  use sg_key_table, only: in_plane, in_space, key_table_t, value_bodies, value_body, value_choice, value_function, value_integer, &
                          value_real, value_text, value_triple, value_vector
  use sg_kinds, only: wp
  use sg_laws, only: largest_friction, why_largest_friction
  use sg_words, only: choices_of
  implicit none
  private
  public :: add_scene_keys, add_cell_keys, add_law_keys, add_drive_keys, law_kinds, plane_shapes, space_shapes

  !> Words for the kinds of law, those of LMGC90, in the order of the numbers `law_*`
  character(len=24), parameter :: law_kinds(22) = [character(len=24) :: 'IQS_CLB', 'GAP_SGR_CLB', 'VEL_SGR_CLB', 'RST_CLB', &
    'IQS_WET_DS_CLB', 'IQS_MOHR_DS_CLB', 'ELASTIC_REPELL_CLB', 'LINEAR', 'ROD', 'WIRE', 'RIGID_WIRE', 'NARD_ROD', 'IQS_CLB_g0', &
    'GAP_SGR_CLB_g0', 'ELASTIC_REPELL_CLB_g0', 'preGAP_SGR_CLB', 'VISCO_ELASTIC_REPELL_CLB', &
    'IQS_MAC_CZM', 'IQS_MAL_CZM', 'IQS_TH_CZM', 'IQS_ABP_CZM', 'IQS_EXPO_CZM']
  !> Words for the shapes of the plane and of space; those that stand at one place correspond
  character(len=*), parameter :: plane_shapes = 'disk|segment|hollow disk|polygon|point'
  character(len=*), parameter :: space_shapes = 'sphere|cylinder|hollow cylinder|polyhedron|point|plane'

contains

  !> Section scene.
  subroutine add_scene_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call table%open_section('scene', 'What holds for the whole scene.')
    call table%add('dimension', value_integer, '2 for a scene in the plane (x, y), 3 for one in space (x, y, z); with a DATBOX '// &
                   'the default is its own.', default='2', least=2.0_wp, most=3.0_wp)
    call table%add('datbox', value_text, 'LMGC90 DATBOX folder that holds bodies, materials, laws and initial state, relative '// &
                   'to the deck, which adds to them: its bodies are numbered behind those of the folder, its [[interaction]] '// &
                   'come behind the see tables, and materials, laws and colours are those of both.')
    call table%add('gravity', value_vector, 'Acceleration of gravity; with a DATBOX the default is that of its '// &
                   'BULK_BEHAV.DAT.', unit='m/s2', default='[0.0, -9.81]', space_default='[0.0, 0.0, -9.81]')
    call table%add('period_x', value_real, 'Length of the period in x; 0 for none. Grains lie between 0 and the period.', &
                   unit='m', default='0.0', least=0.0_wp)
    call table%add('period_y', value_real, 'Length of the period in y; 0 for none.', unit='m', default='0.0', least=0.0_wp, &
                   dimension=in_space)
    call table%add('shrink_faces', value_real, 'Share by which the contact points of a face on a face are moved to '// &
                   'their middle, between polygons and between polyhedra.', default='0.0', least=0.0_wp, most=1.0_wp)
    call table%add('kept_motion', value_real, 'Contacts of two polygons or polyhedra, or of one and a wall, are kept and '// &
                   'follow their bodies while these have moved by less than this against each other since the contacts '// &
                   'were found, over the radius of the smaller one; 0 for never. Not in '// &
                   'scenes with cohesive zones.', default='1e-3', least=0.0_wp, most=0.1_wp)
  end subroutine add_scene_keys

  !> Section cell.
  subroutine add_cell_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to
    character(len=*), parameter :: sign = ', positive in compression: a number, or an expression of the time t.'

    call table%open_section('repeat', 'A unit of the scene, repeated: bodies, samples and regions are copied, containers '// &
                            'lengthened. Copy 2 of what is named "x" is "x.2"; copies of samples draw other grains.')
    call table%add('count', value_integer, 'How many times the unit stands there. Default: no repetition.', least=1.0_wp, &
                   most=1e4_wp)
    call table%add('shift', value_vector, 'From one unit to the next.', unit='m')
    call table%open_section('cell', 'A periodic cell: all axes are periodic, and the lengths change at imposed '// &
                            'rates or under imposed stress, component by component. Its grains move with '// &
                            'it, beyond their own velocities; there are no walls and no gravity.')
    call table%add('size', value_vector, 'Lengths of the cell at the start; grains lie between 0 and these. Default: no cell.', &
                   unit='m')
    call table%add('strain_rate_xx', value_function, 'Rate of the logarithmic strain along x'//sign, unit='1/s', default='0.0')
    call table%add('strain_rate_yy', value_function, 'Rate of the logarithmic strain along y.', unit='1/s', default='0.0')
    call table%add('strain_rate_zz', value_function, 'Rate of the logarithmic strain along z.', unit='1/s', default='0.0', &
                   dimension=in_space)
    call table%add('shear_rate', value_function, 'Rate at which the velocity along x grows with y.', unit='1/s', default='0.0')
    call table%add('stress_xx', value_function, 'In place of the strain rate: imposed normal stress along x'//sign, unit='Pa')
    call table%add('stress_yy', value_function, 'The same along y.', unit='Pa')
    call table%add('stress_zz', value_function, 'The same along z.', unit='Pa', dimension=in_space)
    call table%add('shear_stress', value_function, 'In place of the shear rate: imposed shear stress, which drives positive '// &
                   'shear.', unit='Pa')
    call table%add('inertia', value_real, 'Inertia of each component under imposed stress, over the sum of mass times '// &
                   'square of the width of all grains.', default='2.0', above=0.0_wp)
  end subroutine add_cell_keys

  !> Sections material, law and interaction.
  subroutine add_law_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to
    character(len=*), parameter :: no_angle = 'it is no angle: the coefficient of 30 degrees is 0.577'
    real(wp), parameter :: usual_friction = 10.0_wp
    character(len=*), parameter :: cohesive = 'kind=IQS_WET_DS_CLB|IQS_MOHR_DS_CLB'
    character(len=*), parameter :: softening = 'IQS_MAL_CZM|IQS_TH_CZM|IQS_ABP_CZM|IQS_EXPO_CZM', zones = 'IQS_MAC_CZM|'//softening
    character(len=*), parameter :: rubbing = &
      'kind=IQS_CLB|GAP_SGR_CLB|VEL_SGR_CLB|RST_CLB|IQS_WET_DS_CLB|IQS_MOHR_DS_CLB|IQS_CLB_g0|GAP_SGR_CLB_g0|'// &
      'preGAP_SGR_CLB'
    character(len=*), parameter :: elastic = 'ELASTIC_REPELL_CLB|ELASTIC_REPELL_CLB_g0|VISCO_ELASTIC_REPELL_CLB'

    call table%open_section('material', 'A bulk material.', is_list=.true.)
    call table%add('name', value_text, 'Name by which bodies call it.', is_required=.true.)
    call table%add('density', value_real, 'Mass per volume; in the plane per area and metre of depth.', unit='kg/m3', &
                   is_required=.true., above=0.0_wp)

    call table%open_section('law', 'A contact law. The only law of a deck without [[interaction]] holds between all pairs.', &
                            is_list=.true.)
    call table%add('name', value_text, 'Name by which interactions call it.', default='"contact"')
    call table%add('kind', value_choice, 'Kind of law, by LMGC90''s name; LINEAR is r = -(1/epsilon) v; ROD, WIRE, RIGID_WIRE '// &
                   'and NARD_ROD hold between points. In those that end in _g0 gaps count from that of the first step '// &
                   'with contacts for contacts within the alert distance then.', &
                   default='"IQS_CLB"', choices=choices_of(law_kinds))
    call table%add('friction', value_real, 'Coulomb friction coefficient.', default='0.0', least=0.0_wp, &
                   only=rubbing//'|'//zones//'|'//elastic, usual=usual_friction, hint=no_angle, &
                   most=largest_friction, why_most=why_largest_friction)
    call table%add('static_friction', value_real, 'Friction coefficient while sticking; default: friction.', &
                   least=0.0_wp, only=rubbing//'|'//zones, usual=usual_friction, hint=no_angle, &
                   most=largest_friction, why_most=why_largest_friction)
    call table%add('dynamic_friction', value_real, 'Friction coefficient while sliding; default: friction.', &
                   least=0.0_wp, only=rubbing//'|'//zones, usual=usual_friction, hint=no_angle, &
                   most=largest_friction, why_most=why_largest_friction)
    call add_rolling_keys(table, rubbing//'|'//elastic)
    call table%add('normal_restitution', value_real, 'Newton restitution along the normal.', default='0.0', &
                   least=0.0_wp, most=1.0_wp, only='kind=RST_CLB')
    call table%add('tangential_restitution', value_real, 'Newton restitution along the tangent.', default='0.0', least=0.0_wp, &
                   most=1.0_wp, only='kind=RST_CLB')
    call table%add('normal_cohesion', value_real, 'Largest pull along the normal.', unit='N', default='0.0', &
                   least=0.0_wp, only=cohesive)
    call table%add('tangential_cohesion', value_real, 'Largest shear without normal force; default: static friction times '// &
                   'normal_cohesion.', unit='N', above=0.0_wp, only='kind=IQS_MOHR_DS_CLB')
    call table%add('normal_bond_stress', value_real, 'Largest pull per contact surface, in place of normal_cohesion.', &
                   unit='Pa', least=0.0_wp, only='kind=IQS_MOHR_DS_CLB')
    call table%add('tangential_bond_stress', value_real, 'Largest shear without normal force per contact surface, in place '// &
                   'of tangential_cohesion.', unit='Pa', least=0.0_wp, only='kind=IQS_MOHR_DS_CLB')
    call table%add('wet_thickness', value_real, 'Gap up to which a wet contact pulls.', unit='m', is_required=.true., &
                   least=0.0_wp, only='kind=IQS_WET_DS_CLB')
    call table%add('stiffness', value_real, 'Force per penetration.', unit='N/m', is_required=.true., above=0.0_wp, &
                   only='kind='//elastic)
    call table%add('viscosity', value_real, 'Force per velocity while shapes overlap.', unit='N s/m', default='0.0', &
                   least=0.0_wp, only='kind=VISCO_ELASTIC_REPELL_CLB')
    call table%add('gap_shift', value_real, 'Length added to the gap.', unit='m', default='0.0', only='kind=preGAP_SGR_CLB')
    call table%add('epsilon', value_real, 'Velocity per impulse.', unit='1/kg', above=0.0_wp, only='kind=LINEAR')
    call table%add('relative_epsilon', value_real, 'In place of epsilon: velocity per impulse over the mean diagonal term of '// &
                   'the matrix W of contacts with such laws.', above=0.0_wp, only='kind=LINEAR')
    call table%add('directions', value_choice, 'Directions in which it acts: all, or the normal alone.', default='"all"', &
                   choices='all|normal', only='kind=LINEAR')

    call add_link_law_keys(table, softening)
    call add_zone_keys(table, zones, softening)

    call table%open_section('interaction', 'Pairs that may touch, and their law; the first that fits a pair counts, in either '// &
                            'order of the two.', is_list=.true.)
    call table%add('candidate', value_text, 'Colour of the one; any for all colours.', default='"any"')
    call table%add('antagonist', value_text, 'Colour of the other; any for all colours.', default='"any"')
    call table%add('candidate_shape', value_choice, 'Shape of the one.', default='"any"', choices='any|'//plane_shapes, &
                   space_choices='any|'//space_shapes)
    call table%add('antagonist_shape', value_choice, 'Shape of the other.', default='"any"', choices='any|'//plane_shapes, &
                   space_choices='any|'//space_shapes)
    call table%add('law', value_text, 'Name of the law; default: the only one.')
    call table%add('alert', value_real, 'Contacts exist where the gap is below this; two points are linked that are no farther '// &
                   'apart at the start. Default: what shapes may come nearer in the step, at least a fiftieth of the radius '// &
                   'of the smallest grain, at most a tenth of it or what the fastest grain may travel in a step if that is '// &
                   'more; for laws that act on open contacts always the most.', unit='m', least=0.0_wp)

    call add_bond_keys(table)
    call add_link_keys(table)
  end subroutine add_law_keys

  !> Keys of moments that resist rolling and twisting.
  subroutine add_rolling_keys(table, resisting)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: resisting !! kinds of law that take them
    character(len=*), parameter :: radius = ' times the effective radius R1 R2/(R1 + R2), which is that of a grain on a flat wall.'
    real(wp), parameter :: usual = 1.0_wp
    character(len=*), parameter :: hint = 'on a slope a grain rolls from the angle on whose tangent is the coefficient'

    call table%add('rolling_friction', value_real, 'Largest moment against rolling over the normal force is this'//radius, &
                   default='0.0', least=0.0_wp, only=resisting, usual=usual, hint=hint)
    call table%add('rolling_length', value_real, 'Length added to it: largest moment against rolling over the normal force.', &
                   unit='m', default='0.0', least=0.0_wp, only=resisting)
    call table%add('twisting_friction', value_real, 'Largest moment about the normal over the normal force is this'//radius, &
                   default='0.0', least=0.0_wp, only=resisting, dimension=in_space)
    call table%add('twisting_length', value_real, 'Length added to it: largest moment about the normal over the normal force.', &
                   unit='m', default='0.0', least=0.0_wp, only=resisting, dimension=in_space)
  end subroutine add_rolling_keys

  !> Keys of laws that hold between points.
  subroutine add_link_law_keys(table, softening)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: softening !! kinds of law that have strengths too
    character(len=*), parameter :: elastic = 'kind=ROD|WIRE', bond = 'kind=NARD_ROD'

    call table%add('axial_stiffness', value_real, 'Force per strain, E A.', unit='N', is_required=.true., above=0.0_wp, &
                   only=elastic)
    call table%add('axial_damping', value_real, 'Force per rate of strain.', unit='N s', default='0.0', least=0.0_wp, only=elastic)
    call table%add('prestrain', value_real, 'Strain without force: negative for a link that is stretched at its length.', &
                   default='0.0', above=-1.0_wp, only=elastic)
    call table%add('breaking_force', value_real, 'Tension at which the wire breaks for good; 0 for never.', unit='N', &
                   default='0.0', least=0.0_wp, only='kind=WIRE')
    call table%add('young', value_real, 'Young''s modulus.', unit='Pa', is_required=.true., above=0.0_wp, only=bond)
    call table%add('poisson', value_real, 'Poisson''s ratio.', default='0.0', above=-1.0_wp, most=0.5_wp, only=bond)
    call table%add('normal_strength', value_real, 'Tensile stress that breaks the bond, or from which on a cohesive zone is '// &
                   'damaged.', unit='Pa', is_required=.true., above=0.0_wp, only=bond//'|'//softening)
    call table%add('tangential_strength', value_real, 'Shear stress that does.', unit='Pa', is_required=.true., &
                   above=0.0_wp, only=bond//'|'//softening)
  end subroutine add_link_law_keys

  !> Keys of cohesive zones.
  subroutine add_zone_keys(table, zones, softening)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: zones, softening !! kinds of law, without and with a strength
    character(len=*), parameter :: mac = 'kind=IQS_MAC_CZM', th = 'kind=IQS_TH_CZM', abp = 'kind=IQS_ABP_CZM'

    call table%add('normal_stiffness', value_real, 'Stress of a whole bond per opening.', unit='Pa/m', is_required=.true., &
                   above=0.0_wp, only='kind='//zones)
    call table%add('tangential_stiffness', value_real, 'Stress of a whole bond per slip.', unit='Pa/m', is_required=.true., &
                   above=0.0_wp, only='kind='//zones)
    call table%add('adhesion_energy', value_real, 'Energy per surface above which a bond is damaged (Dupre).', unit='J/m2', &
                   is_required=.true., above=0.0_wp, only=mac)
    call table%add('damage_viscosity', value_real, 'Energy per surface and rate of damage.', unit='J s/m2', default='0.0', &
                   least=0.0_wp, only=mac)
    call table%add('normal_energy', value_real, 'Energy per surface that opening a bond takes.', unit='J/m2', is_required=.true., &
                   above=0.0_wp, only='kind='//softening)
    call table%add('tangential_energy', value_real, 'Energy per surface that shearing a bond takes.', unit='J/m2', &
                   is_required=.true., above=0.0_wp, only='kind='//softening)
    call table%add('normal_plateau', value_real, 'Opening to which the strength is kept.', unit='m', is_required=.true., &
                   above=0.0_wp, only=th)
    call table%add('tangential_plateau', value_real, 'Slip to which the strength is kept.', unit='m', is_required=.true., &
                   above=0.0_wp, only=th)
    call table%add('normal_opening', value_real, 'Opening at which a bond is broken.', unit='m', is_required=.true., &
                   above=0.0_wp, only=abp)
    call table%add('tangential_opening', value_real, 'Slip at which a bond is broken.', unit='m', is_required=.true., &
                   above=0.0_wp, only=abp)
    call table%add('knee_share', value_real, 'Share of the energy taken before the steeper of two falls ends.', &
                   is_required=.true., above=0.0_wp, most=0.999_wp, only=abp)
    call table%add('cut_off', value_real, 'Share of the strength at which a bond is cut.', default='0.001', above=0.0_wp, &
                   most=0.5_wp, only='kind=IQS_EXPO_CZM')
  end subroutine add_zone_keys

  !> Section bond.
  subroutine add_bond_keys(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('bond', 'Bonds between bodies that touch at the start, by a cohesive zone or a Mohr-Coulomb law. '// &
                            'They take the place of what [[interaction]] gives to these pairs; give bodies or a colour.', &
                            is_list=.true.)
    call table%add('bodies', value_bodies, 'Two bodies, by name or by number, or two patterns of names: each body of the one '// &
                   'is bonded to each of the other that it touches.')
    call table%add('colour', value_text, 'Colour whose shapes are bonded to each other; any for all shapes.')
    call table%add('law', value_text, 'Name of the law: an IQS_*_CZM or IQS_MOHR_DS_CLB.', is_required=.true.)
    call table%add('alert', value_real, 'Gap up to which bodies are bonded at the start, and at which a bond that has opened '// &
                   'is lost; default: as for [[interaction]].', unit='m', least=0.0_wp)
  end subroutine add_bond_keys

  !> Section link.
  subroutine add_link_keys(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('link', 'A rod, a wire or a bond between two points of two bodies, there at any distance. Points '// &
                            'that the deck gives as shapes are linked by [[interaction]] instead.', is_list=.true.)
    call table%add('bodies', value_bodies, 'The two bodies, by name or by number.', is_required=.true.)
    call table%add('law', value_text, 'Name of the law; default: the only one.')
    call table%add('first_point', value_vector, 'Where the link holds the first body, at the start, in the world; default: at '// &
                   'its centre of mass.', unit='m')
    call table%add('second_point', value_vector, 'Where it holds the second body; default: at its centre of mass.', unit='m')
    call table%add('length', value_real, 'Length at rest; default: the distance of the two points at the start.', unit='m', &
                   least=0.0_wp)
    call table%add('area', value_real, 'Cross section of a NARD_ROD.', unit='m2', above=0.0_wp)
    call table%add('mass', value_real, 'Mass of a NARD_ROD, from which its damping follows.', unit='kg', least=0.0_wp)

    call table%open_section('joint', 'A point of two bodies that stays together, so that they may turn about it; in space '// &
                            'with an axis a hinge. [[interaction]] decides whether the two bodies also touch.', is_list=.true.)
    call table%add('bodies', value_bodies, 'The two bodies, by name or by number.', is_required=.true.)
    call table%add('point', value_vector, 'The point at the start, in the world.', unit='m', is_required=.true.)
    call table%add('axis', value_triple, 'Axis of a hinge at the start, of any length but zero.', dimension=in_space)
    call table%add('width', value_real, 'Distance of the two points on the axis that hold a hinge.', unit='m', above=0.0_wp, &
                   dimension=in_space)
  end subroutine add_link_keys

  !> Sections drive, pressure and gravity.
  subroutine add_drive_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call table%open_section('drive', 'One imposed component of one body, or of each of several: (value + amplitude cos(omega t '// &
                            '+ phase)) min(1, ramp_start + ramp_rate t), or a table, or both. In space a rotation is the spin '// &
                            'or the torque about that principal axis of the body which is nearest to its own x, y or z, '// &
                            'and turns with it.', is_list=.true.)
    call table%add('body', value_body, 'Body by name, or several by a name in which * stands for any letters and ? for one; or '// &
                   'body by number (in the order body, wall, container, brick_wall, arch, chain, sample, from 1).', &
                   is_required=.true.)
    call table%add('component', value_choice, 'Component.', is_required=.true., choices='x|y|rotation', &
                   space_choices='x|y|z|rotation_x|rotation_y|rotation_z')
    call table%add('kind', value_choice, 'What is imposed.', default='"velocity"', choices='velocity|force')
    call add_time_function(table, 'm/s, rad/s, N, Nm')

    call table%open_section('pressure', 'A pressure that pushes a body: (value + amplitude cos(omega t + phase)) '// &
                            'min(1, ramp_start + ramp_rate t), or a table, or both, times the pressed length; in space, area.', &
                            is_list=.true.)
    call table%add('body', value_body, 'Body by name, or several by a name in which * stands for any letters and ? for one; or '// &
                   'body by number.', is_required=.true.)
    call table%add('direction', value_vector, 'Direction of the push, of any length but zero. Required without `chain`.')
    call table%add('length', value_real, 'Pressed length.', unit='m', above=0.0_wp, dimension=in_plane, twin='area')
    call table%add('between', value_bodies, 'In place of length: two bodies whose free distance is the pressed length.', &
                   dimension=in_plane, twin='area')
    call table%add('area', value_real, 'Pressed area; default, for a plane of a [[container]] alone: the area that it closes '// &
                   'now, between the planes next to it, wherever they are.', unit='m2', above=0.0_wp, dimension=in_space, &
                   twin='length')
    call table%add('chain', value_choice, 'In place of direction and length: the bodies, in the order of their numbers, are '// &
                   'the corners of a polygon, open or closed, and the pressure follows it. It pushes to the left of the way '// &
                   'from body to body, into a closed chain that runs counter-clockwise; a negative value pushes to the right. '// &
                   'Not in periodic scenes.', choices='open|closed', dimension=in_plane)
    call add_time_function(table, 'Pa')

    call table%open_section('gravity', 'One component of gravity that changes with time, in place of that of scene.gravity: '// &
                            '(value + amplitude cos(omega t + phase)) min(1, ramp_start + ramp_rate t), or a table, or both. '// &
                            'A table that tilts, or a push that grows with the weight.', is_list=.true.)
    call table%add('component', value_choice, 'Component.', is_required=.true., choices='x|y', space_choices='x|y|z')
    call add_time_function(table, 'm/s2')
  end subroutine add_drive_keys

  !> Keys of a function of time.
  subroutine add_time_function(table, unit)
    type(key_table_t), intent(inout) :: table
    character(len=*), intent(in) :: unit

    call table%add('value', value_function, 'Constant part, or an expression of the time t: "4e-3*2*pi*35*cos(2*pi*35*t) - 0.1".', &
                   unit=unit, default='0.0')
    call table%add('amplitude', value_real, 'Amplitude of the cosine.', unit=unit, default='0.0')
    call table%add('frequency', value_real, 'Frequency of the cosine.', unit='Hz', default='0.0', least=0.0_wp)
    call table%add('omega', value_real, 'Pulsation of the cosine, in place of frequency.', unit='rad/s')
    call table%add('phase', value_real, 'Phase of the cosine.', unit='rad', default='0.0')
    call table%add('ramp_start', value_real, 'Ramp at time zero; 1 for no ramp.', default='1.0')
    call table%add('ramp_rate', value_real, 'Growth of the ramp.', unit='1/s', default='0.0')
    call table%add('file', value_text, 'File of times and values, relative to the deck, linear between its points. Its table '// &
                   'adds to value and amplitude, where these are given.')
    call table%add('column', value_integer, 'Column of the file that holds the values, where it has more than two; the first '// &
                   'holds the times.', default='2', least=2.0_wp, most=1000.0_wp, only='file')
    call table%add('start', value_real, 'When it begins to act, on the nearest step.', unit='s')
    call table%add('end', value_real, 'When it ceases to act, on the nearest step.', unit='s')
  end subroutine add_time_function
end module sg_keys_scene
