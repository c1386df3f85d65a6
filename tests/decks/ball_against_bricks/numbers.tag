steps count 1
6.0000000000000000E+01
contacts count 1
4.6000000000000000E+01
active_contacts count 1
2.1000000000000000E+01
sweeps effort 1
1.2170000000000000E+05
kinetic_energy measure 1
1.8757473827772429E+01
potential_energy measure 1
-7.6574160404326005E+02
external_work measure 1
3.5481304419152784E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
8.6714975777948382E+00
impact_loss measure 1
3.5351412238274065E+01
energy_closure measure 1
3.2847070368091953E-06
mean_penetration measure 1
4.3038857891818990E-08
max_penetration measure 1
2.4433985676973503E-07
volume_error measure 1
4.6636309078889549E-08
compactness measure 1
3.9043129789432357E-01
coordination measure 1
2.2500000000000000E+00
coordination_without_rattlers measure 1
2.6666666666666665E+00
single_contacts count 1
7.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
1.0000000000000000E+00
mean_velocity measure 1
7.9888139126001534E-01
max_velocity measure 1
2.0837961438579766E+00
inertia_number measure 1
2.2825437047360548E+00
pressure measure 1
2.0833692152821877E+02
floor_share measure 1
6.5938009728500402E-01
rattlers count 1
2.0000000000000000E+00
quadruple_contacts count 1
2.0000000000000000E+00
stress_xx measure 1
1.1633728464529221E+02
stress_xy measure 1
-8.8162849384615676E+00
stress_xz measure 1
-5.0751586442762012E+01
stress_yx measure 1
3.1720088956457001E+01
stress_yy measure 1
6.1685702006105629E+01
stress_yz measure 1
-1.8820399027113211E+02
stress_zx measure 1
-3.5894496116651588E+01
stress_zy measure 1
-1.3598469115238052E+02
stress_zz measure 1
4.4698777793325843E+02
shear_rate measure 1
5.0739761496254676E+00
momentum_x measure 1
2.0903193931164927E+00
momentum_y measure 1
2.1960594795922049E+01
momentum_z measure 1
2.5249743933828563E+00
