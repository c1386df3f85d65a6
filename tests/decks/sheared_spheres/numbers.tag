steps count 1
7.0000000000000000E+01
contacts count 1
6.7400000000000000E+02
active_contacts count 1
4.9900000000000000E+02
sweeps effort 1
8.0540000000000000E+04
kinetic_energy measure 1
3.1684814174688775E-01
potential_energy measure 1
3.2020411644657298E+00
external_work measure 1
4.2812523877914881E+00
drive_work measure 1
7.4330380291835119E-01
friction_loss measure 1
2.0515609744253362E+00
impact_loss measure 1
4.2341770531830436E+00
energy_closure measure 1
7.8833894597873300E-15
mean_penetration measure 1
1.1214308467351632E-14
max_penetration measure 1
1.8759820086255985E-13
volume_error measure 1
1.7752798680001280E-24
compactness measure 1
5.4179188988766946E-01
coordination measure 1
3.4481481481481482E+00
coordination_without_rattlers measure 1
3.7276595744680852E+00
single_contacts count 1
4.9900000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.1228904080029607E-01
max_velocity measure 1
2.7436485668643978E-01
inertia_number measure 1
2.1456775891451101E-02
pressure measure 1
5.2778241685189505E+03
floor_share measure 1
1.0356301716775655E+00
rattlers count 1
3.5000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.8257310944200067E+03
stress_xy measure 1
9.7627934573200932E+01
stress_xz measure 1
-1.1677390842333386E+03
stress_yx measure 1
9.6203090292988733E+01
stress_yy measure 1
4.9219710822829684E+03
stress_yz measure 1
-9.2111017328645332E+01
stress_zx measure 1
-1.1596183779662688E+03
stress_zy measure 1
-8.1979025589872379E+01
stress_zz measure 1
7.0857703288538760E+03
shear_rate measure 1
9.7976413193030210E-01
momentum_x measure 1
6.3118114062337172E-01
momentum_y measure 1
3.7885989817758384E-02
momentum_z measure 1
4.2600799967298644E-03
fabric_xx measure 1
3.0363632916047933E-01
fabric_xy measure 1
1.3054222661269375E-02
fabric_xz measure 1
-3.7329410346197377E-02
fabric_yy measure 1
3.3560151326885984E-01
fabric_yz measure 1
-1.6560695058760070E-02
fabric_zz measure 1
3.6076215757066082E-01
mobilised_friction measure 1
2.2071936464365047E-01
sliding_share measure 1
6.0120240480961928E-01
grain_coordination measure 1
3.2000000000000002E+00
wall_coordination measure 1
2.4814814814814815E-01
cell_x measure 1
2.0000000000000001E-01
cell_y measure 1
1.2000000000000000E-01
cell_z measure 1
6.4322896768404275E-02
strain_xx measure 1
0.0000000000000000E+00
strain_yy measure 1
0.0000000000000000E+00
strain_zz measure 1
4.4125452530930209E-01
void_ratio measure 1
8.4564869741115944E-01
