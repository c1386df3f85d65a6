steps count 1
1.0000000000000000E+02
contacts count 1
1.4300000000000000E+02
active_contacts count 1
9.5000000000000000E+01
sweeps effort 1
1.1800000000000000E+04
kinetic_energy measure 1
8.4859449100844745E+02
potential_energy measure 1
0.0000000000000000E+00
external_work measure 1
2.7096310176062998E+03
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3654744669248612E+02
impact_loss measure 1
1.3244890799053587E+03
energy_closure measure 1
2.7691339672717263E-15
mean_penetration measure 1
1.4913413868031553E-11
max_penetration measure 1
6.4544147804213026E-11
volume_error measure 1
9.2527972051075861E-16
compactness measure 1
7.2012450310342246E-01
coordination measure 1
1.9666666666666666E+00
coordination_without_rattlers measure 1
2.4915254237288136E+00
single_contacts count 1
9.5000000000000000E+01
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.0648819455204903E-01
max_velocity measure 1
1.3614903896359440E+00
inertia_number measure 1
3.9107519129703977E-02
pressure measure 1
1.5437788503330081E+04
floor_share measure 1
0.0000000000000000E+00
rattlers count 1
3.1000000000000000E+01
stress_xx measure 1
1.4442690334592084E+04
stress_xy measure 1
1.8394411526576567E+02
stress_yx measure 1
4.7036672485711733E+02
stress_yy measure 1
1.6432886672068078E+04
shear_rate measure 1
9.4857149816257624E-01
momentum_x measure 1
-5.6028043987489589E+01
momentum_y measure 1
-3.0040290817290625E+01
