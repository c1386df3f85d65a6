steps count 1
1.0000000000000000E+02
contacts count 1
7.0000000000000000E+00
active_contacts count 1
6.0000000000000000E+00
sweeps effort 1
5.9800000000000000E+03
kinetic_energy measure 1
1.0382025389945552E+01
potential_energy measure 1
-1.8761427126046312E+03
external_work measure 1
1.6550479012592528E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3172366415748558E+00
impact_loss measure 1
1.8539555512647841E+01
energy_closure measure 1
1.6343382171059482E-04
mean_penetration measure 1
6.0737403104641319E-05
max_penetration measure 1
3.0323406835041505E-04
volume_error measure 1
2.7157336966747743E-06
compactness measure 1
6.7652308987641005E-02
coordination measure 1
1.0000000000000000E+00
coordination_without_rattlers measure 1
1.0000000000000000E+00
single_contacts count 1
2.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.0410732813377477E+00
max_velocity measure 1
1.4800586348302125E+00
inertia_number measure 1
3.3799644659676716E+01
pressure measure 1
2.2961083909357509E+01
floor_share measure 1
4.6596390068520305E-01
rattlers count 1
3.0000000000000000E+00
quadruple_contacts count 1
1.0000000000000000E+00
stress_xx measure 1
3.7471084870757800E+00
stress_xy measure 1
4.0913051017379981E-01
stress_xz measure 1
1.1112052486037854E+01
stress_yx measure 1
-3.0987958904962167E+00
stress_yy measure 1
2.5944949810719047E+00
stress_yz measure 1
2.7061588187868063E-01
stress_zx measure 1
1.7462139324555164E+01
stress_zy measure 1
1.1555478524061549E+00
stress_zz measure 1
6.2541648259924841E+01
shear_rate measure 1
2.0810595859376914E+01
momentum_x measure 1
9.0911758336742459E+00
momentum_y measure 1
9.3031517242922954E-02
momentum_z measure 1
-1.4177152968070137E+01
