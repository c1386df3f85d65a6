steps count 1
2.0000000000000000E+02
contacts count 1
3.0000000000000000E+00
active_contacts count 1
3.0000000000000000E+00
sweeps effort 1
2.1500000000000000E+03
kinetic_energy measure 1
6.5433559301119093E-01
potential_energy measure 1
8.7784933158308842E-01
external_work measure 1
-3.0273835938451794E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
0.0000000000000000E+00
impact_loss measure 1
6.1351450567490864E-04
energy_closure measure 1
5.2763955299674377E-15
mean_penetration measure 1
1.6786340835868903E-15
max_penetration measure 1
2.5188184871183239E-15
volume_error measure 1
4.2541528521163841E-20
compactness measure 1
2.4932548559244228E-01
coordination measure 1
0.0000000000000000E+00
coordination_without_rattlers measure 1
0.0000000000000000E+00
single_contacts count 1
0.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
2.6892370880756838E-01
max_velocity measure 1
1.0756948352302735E+00
inertia_number measure 1
0.0000000000000000E+00
pressure measure 1
-1.2870003476647504E+01
floor_share measure 1
3.1428571428571428E-01
rattlers count 1
4.0000000000000000E+00
stress_xx measure 1
0.0000000000000000E+00
stress_xy measure 1
0.0000000000000000E+00
stress_yx measure 1
0.0000000000000000E+00
stress_yy measure 1
-2.5740006953295008E+01
shear_rate measure 1
0.0000000000000000E+00
momentum_x measure 1
0.0000000000000000E+00
momentum_y measure 1
-1.2165821970710078E+00
fabric_xx measure 1
0.0000000000000000E+00
fabric_xy measure 1
0.0000000000000000E+00
fabric_yy measure 1
0.0000000000000000E+00
mobilised_friction measure 1
0.0000000000000000E+00
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
0.0000000000000000E+00
wall_coordination measure 1
0.0000000000000000E+00
