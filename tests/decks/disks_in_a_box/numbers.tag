steps count 1
1.2000000000000000E+02
contacts count 1
5.0000000000000000E+01
active_contacts count 1
2.8000000000000000E+01
sweeps effort 1
3.5900000000000000E+03
kinetic_energy measure 1
7.4736199721725797E+01
potential_energy measure 1
4.3465630321747449E+02
external_work measure 1
-4.5144607761605592E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
4.0679153360515086E+00
impact_loss measure 1
2.7716713564478145E+01
energy_closure measure 1
4.0022749256663952E-16
mean_penetration measure 1
1.5367655065157138E-11
max_penetration measure 1
5.3958948420529396E-11
volume_error measure 1
1.8796799178338047E-15
compactness measure 1
4.7822745204658984E-01
coordination measure 1
7.3333333333333328E-01
coordination_without_rattlers measure 1
2.0666666666666669E+00
single_contacts count 1
2.8000000000000000E+01
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.1712505090300360E-01
max_velocity measure 1
1.1772000000000009E+00
inertia_number measure 1
2.6911127118358963E-01
pressure measure 1
1.1266017558115686E+03
floor_share measure 1
1.2326105259268862E+00
rattlers count 1
4.5000000000000000E+01
stress_xx measure 1
5.5184071134313569E+02
stress_xy measure 1
-2.2792765552542470E+01
stress_yx measure 1
2.4859709250198659E+01
stress_yy measure 1
1.7013628002800015E+03
shear_rate measure 1
5.0452476167158480E+00
momentum_x measure 1
-2.5600352408620135E+00
momentum_y measure 1
-1.2844370322551433E+02
