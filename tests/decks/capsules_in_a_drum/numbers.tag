steps count 1
1.6000000000000000E+02
contacts count 1
6.0000000000000000E+00
active_contacts count 1
4.0000000000000000E+00
sweeps effort 1
1.2400000000000000E+03
kinetic_energy measure 1
1.2954409754689475E+00
potential_energy measure 1
-4.6268897223609162E+00
external_work measure 1
-1.4334425669172382E-16
drive_work measure 1
1.1460127371827216E+00
friction_loss measure 1
1.6857379719038261E+00
impact_loss measure 1
2.1543366024030282E+00
energy_closure measure 1
6.3288785087045661E-05
mean_penetration measure 1
7.9248370310804530E-06
max_penetration measure 1
1.2284527935058076E-05
volume_error measure 1
8.9874834691103278E-10
compactness measure 1
8.5418205474742936E-02
coordination measure 1
1.5000000000000000E+00
coordination_without_rattlers measure 1
2.0000000000000000E+00
single_contacts count 1
4.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.2114370712861542E-01
max_velocity measure 1
1.5696000000000048E+00
inertia_number measure 1
5.3834157046885451E+00
pressure measure 1
1.9039861468583652E+01
floor_share measure 1
5.7744631101186084E-01
rattlers count 1
2.0000000000000000E+00
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.1678541148834247E+00
stress_xy measure 1
-5.2836473027985456E+00
stress_xz measure 1
4.1643594852796495E+00
stress_yx measure 1
-6.7835956231010517E+00
stress_yy measure 1
3.0517323432423279E+01
stress_yz measure 1
6.1426852881054899E+00
stress_zx measure 1
4.5021650884559161E+00
stress_zy measure 1
8.2357083701381644E+00
stress_zz measure 1
2.3434406858444255E+01
shear_rate measure 1
7.2221260912602778E+00
momentum_x measure 1
5.7869150351224280E-02
momentum_y measure 1
8.4321826021442015E-01
momentum_z measure 1
-1.1772731351203398E+00
fabric_xx measure 1
5.4640910181205565E-02
fabric_xy measure 1
-7.0200110139353900E-02
fabric_xz measure 1
-1.1112922880154273E-01
fabric_yy measure 1
6.8669031237783029E-01
fabric_yz measure 1
3.2116747149319126E-03
fabric_zz measure 1
2.5866877744096417E-01
mobilised_friction measure 1
4.9643581431722295E-01
sliding_share measure 1
7.5000000000000000E-01
grain_coordination measure 1
1.0000000000000000E+00
wall_coordination measure 1
5.0000000000000000E-01
coordination_cylinder measure 1
2.0000000000000000E+00
coordination_clump measure 1
0.0000000000000000E+00
