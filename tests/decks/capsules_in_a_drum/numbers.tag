steps count 1
1.2000000000000000E+02
contacts count 1
4.0000000000000000E+00
active_contacts count 1
3.0000000000000000E+00
sweeps effort 1
1.1000000000000000E+03
kinetic_energy measure 1
1.8510588047502168E+00
potential_energy measure 1
-3.9559794213045660E+00
external_work measure 1
-9.3276811623975170E-17
drive_work measure 1
5.2907799647814602E-01
friction_loss measure 1
8.5426797706417434E-01
impact_loss measure 1
1.1423015471645062E+00
energy_closure measure 1
6.3388267585707536E-05
mean_penetration measure 1
4.6832801058604989E-06
max_penetration measure 1
9.0541209759598118E-06
volume_error measure 1
0.0000000000000000E+00
compactness measure 1
8.1200465406608510E-02
coordination measure 1
2.5000000000000000E-01
coordination_without_rattlers measure 1
0.0000000000000000E+00
single_contacts count 1
0.0000000000000000E+00
double_contacts count 1
1.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
9.4851348067556440E-01
max_velocity measure 1
1.4311335117539676E+00
inertia_number measure 1
2.2343887665695657E+01
pressure measure 1
3.6907280990724218E+00
floor_share measure 1
2.7938254185649603E-01
rattlers count 1
4.0000000000000000E+00
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
5.0583108023391041E+00
stress_xy measure 1
-7.4600075091705298E-01
stress_xz measure 1
-2.3615892842180994E-01
stress_yx measure 1
1.8249694518247663E+00
stress_yy measure 1
-1.8808650974621274E-01
stress_yz measure 1
-1.0039251969812084E+00
stress_zx measure 1
4.8443560080719389E-05
stress_zy measure 1
-5.4721643872734793E-01
stress_zz measure 1
6.2019600046243735E+00
shear_rate measure 1
1.3197449906725314E+01
momentum_x measure 1
-3.5770527317080680E-01
momentum_y measure 1
4.1230874488360159E-01
momentum_z measure 1
-2.3037492247296791E+00
