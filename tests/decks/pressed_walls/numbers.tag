steps count 1
1.0000000000000000E+02
contacts count 1
1.4300000000000000E+02
active_contacts count 1
9.5000000000000000E+01
sweeps effort 1
9.8400000000000000E+03
kinetic_energy measure 1
8.4859527405150516E+02
potential_energy measure 1
0.0000000000000000E+00
external_work measure 1
2.7096310263667215E+03
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3654747277110039E+02
impact_loss measure 1
1.3244882795441140E+03
energy_closure measure 1
6.7130520201670972E-16
mean_penetration measure 1
1.3200090711842607E-10
max_penetration measure 1
5.3584392478711607E-10
volume_error measure 1
2.3515205099596374E-14
compactness measure 1
7.2012450558392427E-01
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
7.0648816850992036E-01
max_velocity measure 1
1.3614914077365519E+00
inertia_number measure 1
3.9107941496408331E-02
pressure measure 1
1.5437321774910359E+04
floor_share measure 1
0.0000000000000000E+00
rattlers count 1
3.1000000000000000E+01
stress_xx measure 1
1.4442130766134258E+04
stress_xy measure 1
1.8391516413392978E+02
stress_yx measure 1
4.7029386689389042E+02
stress_yy measure 1
1.6432512783686459E+04
shear_rate measure 1
9.4856740359263281E-01
momentum_x measure 1
-5.6028255094183997E+01
momentum_y measure 1
-3.0040053362041991E+01
