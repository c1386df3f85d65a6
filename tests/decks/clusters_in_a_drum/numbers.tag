steps count 1
3.0000000000000000E+02
contacts count 1
6.0000000000000000E+00
active_contacts count 1
1.0000000000000000E+00
sweeps effort 1
3.9000000000000000E+02
kinetic_energy measure 1
3.2856118454024312E+01
potential_energy measure 1
-1.7002276691653788E+02
external_work measure 1
4.5689140855380185E-15
drive_work measure 1
1.4643386558226176E+01
friction_loss measure 1
1.3518998002020204E+01
impact_loss measure 1
1.1790074286450967E+02
energy_closure measure 1
1.0454855590057057E-15
mean_penetration measure 1
2.7046633818250676E-05
max_penetration measure 1
2.7046633818250676E-05
volume_error measure 1
9.7535269187898412E-07
compactness measure 1
5.6170824061705138E-01
coordination measure 1
2.0000000000000001E-01
coordination_without_rattlers measure 1
0.0000000000000000E+00
single_contacts count 1
1.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
9.8450414660393160E-01
max_velocity measure 1
1.1633554329482692E+00
inertia_number measure 1
1.8129274931050161E+00
pressure measure 1
2.3094142018286615E+01
floor_share measure 1
1.9526938696555865E-01
rattlers count 1
5.0000000000000000E+00
stress_xx measure 1
3.0555083561927256E+00
stress_xy measure 1
9.7967150841633082E+00
stress_yx measure 1
1.3452729347027324E+01
stress_yy measure 1
4.3132775680380504E+01
shear_rate measure 1
2.7633645215608316E+00
momentum_x measure 1
3.1765360647281558E+01
momentum_y measure 1
-1.9712272474960468E+01
fabric_xx measure 1
0.0000000000000000E+00
fabric_xy measure 1
0.0000000000000000E+00
fabric_yy measure 1
0.0000000000000000E+00
mobilised_friction measure 1
7.9154580844974468E-02
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
0.0000000000000000E+00
wall_coordination measure 1
2.0000000000000001E-01
coordination_disk measure 1
3.3333333333333331E-01
coordination_clump measure 1
0.0000000000000000E+00
