steps count 1
6.0000000000000000E+00
contacts count 1
0.0000000000000000E+00
active_contacts count 1
0.0000000000000000E+00
sweeps effort 1
0.0000000000000000E+00
kinetic_energy measure 1
6.1125870096252255E-01
potential_energy measure 1
-1.4511121556070822E+02
external_work measure 1
-3.6193047964272858E-19
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
0.0000000000000000E+00
impact_loss measure 1
0.0000000000000000E+00
energy_closure measure 1
2.6226208833983270E-14
mean_penetration measure 1
0.0000000000000000E+00
max_penetration measure 1
0.0000000000000000E+00
volume_error measure 1
0.0000000000000000E+00
compactness measure 1
1.9623096022170261E-01
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
2.8022910158833342E-01
max_velocity measure 1
1.5774513878206140E+00
inertia_number measure 1
0.0000000000000000E+00
pressure measure 1
0.0000000000000000E+00
floor_share measure 1
0.0000000000000000E+00
bond_energy measure 1
0.0000000000000000E+00
bond_loss measure 1
0.0000000000000000E+00
bonds count 1
0.0000000000000000E+00
damaged_bonds count 1
0.0000000000000000E+00
rattlers count 1
6.0000000000000000E+00
stress_xx measure 1
0.0000000000000000E+00
stress_xy measure 1
0.0000000000000000E+00
stress_yx measure 1
0.0000000000000000E+00
stress_yy measure 1
0.0000000000000000E+00
shear_rate measure 1
7.1981244343998316E+00
momentum_x measure 1
-4.7701173783014711E-01
momentum_y measure 1
1.6031792972268591E-01
