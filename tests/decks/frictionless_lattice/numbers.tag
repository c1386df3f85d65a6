steps count 1
1.0000000000000000E+02
contacts count 1
1.3100000000000000E+02
active_contacts count 1
1.0200000000000000E+02
sweeps effort 1
5.4200000000000000E+03
kinetic_energy measure 1
7.6655980593340431E+01
potential_energy measure 1
8.4356212386373736E+03
external_work measure 1
3.0745275276261958E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
0.0000000000000000E+00
impact_loss measure 1
1.6913835629473675E+02
energy_closure measure 1
2.3126415189416292E-14
mean_penetration measure 1
2.6774564708200085E-12
max_penetration measure 1
5.2370954795044611E-12
volume_error measure 1
3.8001663353395913E-17
compactness measure 1
8.0549107324538050E-01
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
1.3826519631719755E-01
max_velocity measure 1
6.5096319206163289E-01
inertia_number measure 1
5.0279041392504692E-02
pressure measure 1
8.1674855228751021E+03
floor_share measure 1
8.9114210540398697E-01
rattlers count 1
6.0000000000000000E+00
stress_xx measure 1
3.9037265225599467E+03
stress_xy measure 1
1.1641905341386563E+02
stress_yx measure 1
1.1641905341386550E+02
stress_yy measure 1
1.2431244523190258E+04
shear_rate measure 1
6.4505452207846659E-01
momentum_x measure 1
2.3894887519346409E+02
momentum_y measure 1
-1.8095557464190506E+02
fabric_xx measure 1
2.8309939361300690E-01
fabric_xy measure 1
1.2739201389487432E-02
fabric_yy measure 1
7.1690060638699327E-01
mobilised_friction measure 1
0.0000000000000000E+00
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
2.9666666666666668E+00
wall_coordination measure 1
2.1666666666666667E-01
