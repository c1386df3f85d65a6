steps count 1
1.1500000000000000E+02
contacts count 1
1.7200000000000000E+02
active_contacts count 1
7.0000000000000000E+01
sweeps effort 1
8.0600000000000000E+03
kinetic_energy measure 1
4.8162781491867186E+00
potential_energy measure 1
7.3413456391127710E+01
external_work measure 1
-1.5070142346889247E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.9451902517010247E-01
impact_loss measure 1
2.0885299910628197E+00
energy_closure measure 1
9.1194498930869590E-15
mean_penetration measure 1
6.3945145474993603E-13
max_penetration measure 1
6.9471269015242143E-12
volume_error measure 1
5.4203109073288435E-22
compactness measure 1
3.2201596445529690E-01
coordination measure 1
9.6521739130434780E-01
coordination_without_rattlers measure 1
2.1142857142857143E+00
single_contacts count 1
7.0000000000000000E+01
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
6.1784316465364519E-01
max_velocity measure 1
1.1281500000000004E+00
inertia_number measure 1
1.0530521937143553E+00
pressure measure 1
2.9095965099047442E+02
floor_share measure 1
8.7917818097785039E-01
rattlers count 1
8.0000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
9.2350202225564800E+01
stress_xy measure 1
-5.4837213397777198E+01
stress_xz measure 1
-1.3096733428007758E+02
stress_yx measure 1
-4.9301705049002990E+01
stress_yy measure 1
1.0907396109554472E+02
stress_yz measure 1
5.8016160703484587E+01
stress_zx measure 1
-1.6422325951798729E+02
stress_zy measure 1
6.0124629770832435E+01
stress_zz measure 1
6.7145478965031373E+02
shear_rate measure 1
7.5387843647615318E+00
momentum_x measure 1
3.0757445548631657E-01
momentum_y measure 1
2.2762232282318606E-01
momentum_z measure 1
-9.2417765570729138E+00
