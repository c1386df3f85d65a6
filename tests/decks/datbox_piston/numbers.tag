steps count 1
2.5000000000000000E+02
contacts count 1
5.0000000000000000E+00
active_contacts count 1
5.0000000000000000E+00
sweeps effort 1
2.5300000000000000E+03
kinetic_energy measure 1
2.0511389141711391E+00
potential_energy measure 1
2.5281527184847096E+02
external_work measure 1
-7.0453425956951932E-17
drive_work measure 1
1.4415763331470159E+00
friction_loss measure 1
-5.3205433883817571E-02
impact_loss measure 1
3.3564101111454656E+00
energy_closure measure 1
1.3370495360124468E-14
mean_penetration measure 1
4.2327252813834093E-15
max_penetration measure 1
8.4585116688629114E-15
volume_error measure 1
1.3543904259631249E-14
compactness measure 1
5.1847289985143152E-01
coordination measure 1
8.0000000000000004E-01
coordination_without_rattlers measure 1
0.0000000000000000E+00
single_contacts count 1
3.0000000000000000E+00
double_contacts count 1
1.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
4.7973512086583639E-02
max_velocity measure 1
2.3986756043291821E-01
inertia_number measure 1
8.8842324362163916E-01
pressure measure 1
7.7052578199248501E+02
floor_share measure 1
9.1956952972944772E-01
rattlers count 1
5.0000000000000000E+00
stress_xx measure 1
-1.1764357192906469E+02
stress_xy measure 1
-4.9613494614810893E-12
stress_yx measure 1
-9.9765390244622264E-12
stress_yy measure 1
1.6586951359140346E+03
shear_rate measure 1
3.5321698455821169E+00
momentum_x measure 1
4.7011057718702132E+00
momentum_y measure 1
-1.0385488945297221E-01
fabric_xx measure 1
0.0000000000000000E+00
fabric_xy measure 1
0.0000000000000000E+00
fabric_yy measure 1
0.0000000000000000E+00
mobilised_friction measure 1
6.4494689599778318E-02
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
0.0000000000000000E+00
wall_coordination measure 1
8.0000000000000004E-01
coordination_disk measure 1
1.0000000000000000E+00
coordination_polygon measure 1
1.0000000000000000E+00
coordination_clump measure 1
0.0000000000000000E+00
