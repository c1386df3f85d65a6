steps count 1
1.0000000000000000E+02
contacts count 1
2.5000000000000000E+01
active_contacts count 1
1.7000000000000000E+01
sweeps effort 1
1.1860000000000000E+04
kinetic_energy measure 1
4.1978732097977478E+01
potential_energy measure 1
2.2135430620050312E+02
external_work measure 1
2.3807964668372679E-04
drive_work measure 1
1.8885084142199009E-02
friction_loss measure 1
1.2622606510491043E+00
impact_loss measure 1
2.0534084339831708E+01
energy_closure measure 1
3.1366772615010272E-15
mean_penetration measure 1
1.3877787807814457E-17
max_penetration measure 1
1.3877787807814457E-17
volume_error measure 1
2.6409172640189215E-18
compactness measure 1
4.8313756966793153E-01
coordination measure 1
7.5000000000000000E-01
coordination_without_rattlers measure 1
1.2857142857142858E+00
single_contacts count 1
1.1000000000000000E+01
double_contacts count 1
3.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
5.0779734836002166E-01
max_velocity measure 1
9.8099999999999909E-01
inertia_number measure 1
3.6880177220921678E-01
pressure measure 1
1.1923083551615828E+03
floor_share measure 1
1.5210755744874946E+00
rattlers count 1
2.1000000000000000E+01
stress_xx measure 1
1.7445772361357207E+01
stress_xy measure 1
-2.0482966524273454E+02
stress_yx measure 1
-1.7812204720274696E+02
stress_yy measure 1
2.3671709379618082E+03
shear_rate measure 1
4.8247013610848573E+00
momentum_x measure 1
1.8885084142230879E-01
momentum_y measure 1
-9.0509479236792018E+01
fabric_xx measure 1
4.4279675781562132E-02
fabric_xy measure 1
-2.6868941058406279E-03
fabric_yy measure 1
9.5572032421843800E-01
mobilised_friction measure 1
1.8506656908681413E-01
sliding_share measure 1
5.8823529411764705E-02
grain_coordination measure 1
5.0000000000000000E-01
wall_coordination measure 1
2.5000000000000000E-01
