steps count 1
1.0000000000000000E+02
contacts count 1
1.0500000000000000E+02
active_contacts count 1
1.0200000000000000E+02
sweeps effort 1
5.5180000000000000E+03
kinetic_energy measure 1
7.6655980460351117E+01
potential_energy measure 1
8.4356212389915945E+03
external_work measure 1
8.9311476068860966E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
0.0000000000000000E+00
impact_loss measure 1
1.6913835607350208E+02
energy_closure measure 1
1.0638151002462422E-14
mean_penetration measure 1
2.4562366029989846E-12
max_penetration measure 1
5.3659160448304988E-12
volume_error measure 1
3.4035589279529606E-17
compactness measure 1
8.0549107324328451E-01
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
1.3826519512012309E-01
max_velocity measure 1
6.5096319212859710E-01
inertia_number measure 1
5.0279039869421387E-02
pressure measure 1
8.1674855475937147E+03
floor_share measure 1
8.9114210681230932E-01
rattlers count 1
6.0000000000000000E+00
stress_xx measure 1
3.9037265341840525E+03
stress_xy measure 1
1.1641901042943643E+02
stress_yx measure 1
1.1641901042943648E+02
stress_yy measure 1
1.2431244561003377E+04
shear_rate measure 1
6.4505450351420024E-01
momentum_x measure 1
2.3894887824553612E+02
momentum_y measure 1
-1.8095557177176735E+02
fabric_xx measure 1
2.8309939346629953E-01
fabric_xy measure 1
1.2739201466579687E-02
fabric_yy measure 1
7.1690060653370058E-01
mobilised_friction measure 1
0.0000000000000000E+00
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
2.9666666666666668E+00
wall_coordination measure 1
2.1666666666666667E-01
