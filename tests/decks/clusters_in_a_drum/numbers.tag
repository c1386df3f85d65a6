steps count 1
3.0000000000000000E+02
contacts count 1
5.0000000000000000E+00
active_contacts count 1
1.0000000000000000E+00
sweeps effort 1
3.9000000000000000E+02
kinetic_energy measure 1
3.2856120812597744E+01
potential_energy measure 1
-1.7002276678352189E+02
external_work measure 1
4.3205678012721734E-15
drive_work measure 1
1.4643388444738486E+01
friction_loss measure 1
1.3518996375339110E+01
impact_loss measure 1
1.1790074388611360E+02
energy_closure measure 1
7.6035313449876365E-16
mean_penetration measure 1
2.7046633818250676E-05
max_penetration measure 1
2.7046633818250676E-05
volume_error measure 1
9.7535269187898412E-07
compactness measure 1
5.6170823819600957E-01
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
9.8450419336346240E-01
max_velocity measure 1
1.1633556298559053E+00
inertia_number measure 1
1.8129271745510065E+00
pressure measure 1
2.3094141918746956E+01
floor_share measure 1
1.9526938696555321E-01
rattlers count 1
5.0000000000000000E+00
stress_xx measure 1
3.0555083430229644E+00
stress_xy measure 1
9.7967150419377909E+00
stress_yx measure 1
1.3452729289043797E+01
stress_yy measure 1
4.3132775494470948E+01
shear_rate measure 1
2.7633640300478786E+00
momentum_x measure 1
3.1765363251332396E+01
momentum_y measure 1
-1.9712271231014391E+01
fabric_xx measure 1
0.0000000000000000E+00
fabric_xy measure 1
0.0000000000000000E+00
fabric_yy measure 1
0.0000000000000000E+00
mobilised_friction measure 1
7.9154580844984307E-02
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
