steps count 1
1.2000000000000000E+02
contacts count 1
1.8300000000000000E+02
active_contacts count 1
9.7000000000000000E+01
sweeps effort 1
8.8600000000000000E+03
kinetic_energy measure 1
4.4931023855940531E+00
potential_energy measure 1
7.2970487746842082E+01
external_work measure 1
-1.4214694719713443E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
8.3123128569160531E-01
impact_loss measure 1
2.6179621384195673E+00
energy_closure measure 1
3.1871244244670274E-15
mean_penetration measure 1
1.0387104371067935E-12
max_penetration measure 1
9.2669899531827582E-12
volume_error measure 1
1.5080905617917408E-21
compactness measure 1
3.2850933071387450E-01
coordination measure 1
1.4260869565217391E+00
coordination_without_rattlers measure 1
2.2400000000000002E+00
single_contacts count 1
9.7000000000000000E+01
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
5.8677477908545195E-01
max_velocity measure 1
1.1772000000000009E+00
inertia_number measure 1
4.5245442640472799E-01
pressure measure 1
1.7380569460063050E+03
floor_share measure 1
4.0769634669496959E+00
rattlers count 1
6.5000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
5.2392977190738736E+02
stress_xy measure 1
2.2276846412736397E+01
stress_xz measure 1
-7.4152660562250645E+01
stress_yx measure 1
-2.1042253075364140E+01
stress_yy measure 1
8.5125352935758588E+02
stress_yz measure 1
5.2468552037702875E+02
stress_zx measure 1
-2.0260866023397341E+02
stress_zy measure 1
5.2098087657059068E+02
stress_zz measure 1
3.8389875367539416E+03
shear_rate measure 1
7.9166579774710071E+00
momentum_x measure 1
3.7057797311822177E-01
momentum_y measure 1
2.7469426771198246E-01
momentum_z measure 1
-8.3948155501757444E+00
