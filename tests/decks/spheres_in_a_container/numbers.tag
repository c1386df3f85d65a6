steps count 1
1.1500000000000000E+02
contacts count 1
1.7200000000000000E+02
active_contacts count 1
7.0000000000000000E+01
sweeps effort 1
4.4330000000000000E+03
kinetic_energy measure 1
4.8162781476281342E+00
potential_energy measure 1
7.3413456404242908E+01
external_work measure 1
-1.2963003057157149E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.9451900711956196E-01
impact_loss measure 1
2.0885299975567140E+00
energy_closure measure 1
4.7373765761223419E-15
mean_penetration measure 1
8.6800027392969715E-13
max_penetration measure 1
9.0163744526083889E-12
volume_error measure 1
1.1140516800460980E-21
compactness measure 1
3.2201596444979536E-01
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
6.1784316198762057E-01
max_velocity measure 1
1.1281500000000004E+00
inertia_number measure 1
1.0531069330424525E+00
pressure measure 1
2.9092940683268694E+02
floor_share measure 1
8.7917844558338665E-01
rattlers count 1
8.0000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
9.2304830234127976E+01
stress_xy measure 1
-5.4837207371644709E+01
stress_xz measure 1
-1.3092199110203109E+02
stress_yx measure 1
-4.9301709390311011E+01
stress_yy measure 1
1.0907389886717678E+02
stress_yz measure 1
5.8016175683451358E+01
stress_zx measure 1
-1.6417788400738777E+02
stress_zy measure 1
6.0124641288663646E+01
stress_zz measure 1
6.7140949139675604E+02
shear_rate measure 1
7.5387843981209208E+00
momentum_x measure 1
3.0757448837543883E-01
momentum_y measure 1
2.2762234149772156E-01
momentum_z measure 1
-9.2417764883615394E+00
fabric_xx measure 1
2.5280907112405504E-01
fabric_xy measure 1
-4.2290846747159300E-02
fabric_xz measure 1
2.2539227639913569E-04
fabric_yy measure 1
2.2962646772981371E-01
fabric_yz measure 1
3.3346147730204327E-02
fabric_zz measure 1
5.1756446114613097E-01
mobilised_friction measure 1
2.3603802087039893E-01
sliding_share measure 1
4.2857142857142855E-01
grain_coordination measure 1
7.1304347826086956E-01
wall_coordination measure 1
2.5217391304347825E-01
