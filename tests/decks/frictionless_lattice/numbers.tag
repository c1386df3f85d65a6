steps count 1
1.0000000000000000E+02
contacts count 1
1.4800000000000000E+02
active_contacts count 1
1.0200000000000000E+02
sweeps effort 1
1.2590000000000000E+04
kinetic_energy measure 1
7.6655981440719188E+01
potential_energy measure 1
8.4356212349215057E+03
external_work measure 1
4.6823504580538675E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
0.0000000000000000E+00
impact_loss measure 1
1.6913835916322600E+02
energy_closure measure 1
2.3473311062392877E-14
mean_penetration measure 1
3.9969309497925015E-11
max_penetration measure 1
1.1810810662815641E-10
volume_error measure 1
3.4044252522811704E-15
compactness measure 1
8.0549107314584245E-01
coordination measure 1
3.1833333333333331E+00
coordination_without_rattlers measure 1
3.3148148148148149E+00
single_contacts count 1
1.0200000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.3826521376180237E-01
max_velocity measure 1
6.5096317852510888E-01
inertia_number measure 1
5.0278995829365104E-02
pressure measure 1
8.1675026672116201E+03
floor_share measure 1
8.9114313555745195E-01
rattlers count 1
6.0000000000000000E+00
stress_xx measure 1
3.9037352135842566E+03
stress_xy measure 1
1.1642230465765594E+02
stress_yx measure 1
1.1642230465765623E+02
stress_yy measure 1
1.2431270120838983E+04
shear_rate measure 1
6.4505461454129320E-01
momentum_x measure 1
2.3894884572774382E+02
momentum_y measure 1
-1.8095557943881781E+02
