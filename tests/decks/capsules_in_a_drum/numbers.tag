steps count 1
1.6000000000000000E+02
contacts count 1
6.0000000000000000E+00
active_contacts count 1
4.0000000000000000E+00
sweeps effort 1
2.4500000000000000E+03
kinetic_energy measure 1
1.2954409763000603E+00
potential_energy measure 1
-4.6268897227669665E+00
external_work measure 1
-1.3263335547391123E-16
drive_work measure 1
1.1460127354818492E+00
friction_loss measure 1
1.6857379744241086E+00
impact_loss measure 1
2.1543365977588693E+00
energy_closure measure 1
6.3288785666523682E-05
mean_penetration measure 1
7.9248452843951513E-06
max_penetration measure 1
1.2284550066410382E-05
volume_error measure 1
8.9874848448449122E-10
compactness measure 1
8.5418205480882067E-02
coordination measure 1
1.5000000000000000E+00
coordination_without_rattlers measure 1
2.0000000000000000E+00
single_contacts count 1
4.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.2114370713092368E-01
max_velocity measure 1
1.5696000000000048E+00
inertia_number measure 1
5.3834182499376944E+00
pressure measure 1
1.9039843432075415E+01
floor_share measure 1
5.7744586243426665E-01
rattlers count 1
2.0000000000000000E+00
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.1678554207725722E+00
stress_xy measure 1
-5.2836453374687489E+00
stress_xz measure 1
4.1643581745893847E+00
stress_yx measure 1
-6.7835919674579470E+00
stress_yy measure 1
3.0517289729193266E+01
stress_yz measure 1
6.1426816153425410E+00
stress_zx measure 1
4.5021662660064736E+00
stress_zy measure 1
8.2357015053296259E+00
stress_zz measure 1
2.3434385146260404E+01
shear_rate measure 1
7.2221260850700677E+00
momentum_x measure 1
5.7869151668127027E-02
momentum_y measure 1
8.4321825711824983E-01
momentum_z measure 1
-1.1772731379995280E+00
