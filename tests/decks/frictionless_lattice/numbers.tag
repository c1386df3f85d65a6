steps count 1
1.0000000000000000E+02
contacts count 1
1.4800000000000000E+02
active_contacts count 1
1.0200000000000000E+02
sweeps effort 1
5.4930000000000000E+03
kinetic_energy measure 1
7.6655980569019789E+01
potential_energy measure 1
8.4356212387240157E+03
external_work measure 1
4.4100565134720786E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
0.0000000000000000E+00
impact_loss measure 1
1.6913835623241252E+02
energy_closure measure 1
1.1910103826747683E-14
mean_penetration measure 1
1.6055729276962280E-12
max_penetration measure 1
4.2274100886530164E-12
volume_error measure 1
2.5655145234513685E-17
compactness measure 1
8.0549107324680991E-01
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
1.3826519606027360E-01
max_velocity measure 1
6.5096319206613129E-01
inertia_number measure 1
5.0279041299842446E-02
pressure measure 1
8.1674854618992049E+03
floor_share measure 1
8.9114210136293059E-01
rattlers count 1
6.0000000000000000E+00
stress_xx measure 1
3.9037264952317669E+03
stress_xy measure 1
1.1641904851275264E+02
stress_yx measure 1
1.1641904851275248E+02
stress_yy measure 1
1.2431244428566642E+04
shear_rate measure 1
6.4505451848176931E-01
momentum_x measure 1
2.3894887583906072E+02
momentum_y measure 1
-1.8095557413447645E+02
fabric_xx measure 1
2.8309939358231262E-01
fabric_xy measure 1
1.2739201405911667E-02
fabric_yy measure 1
7.1690060641768716E-01
mobilised_friction measure 1
0.0000000000000000E+00
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
2.9666666666666668E+00
wall_coordination measure 1
2.1666666666666667E-01
