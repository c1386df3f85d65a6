steps count 1
1.0000000000000000E+02
contacts count 1
7.0000000000000000E+00
active_contacts count 1
6.0000000000000000E+00
sweeps effort 1
5.9800000000000000E+03
kinetic_energy measure 1
1.0382024330532536E+01
potential_energy measure 1
-1.8761427129634524E+03
external_work measure 1
1.7052897633778589E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3172678563422764E+00
impact_loss measure 1
1.8539525713293369E+01
energy_closure measure 1
1.6343393223285137E-04
mean_penetration measure 1
6.0737397457918823E-05
max_penetration measure 1
3.0323402733301030E-04
volume_error measure 1
2.7157449461712920E-06
compactness measure 1
6.7652328724040062E-02
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
1.0410734544508282E+00
max_velocity measure 1
1.4800600438098226E+00
inertia_number measure 1
3.3799645863842322E+01
pressure measure 1
2.2961080309784567E+01
floor_share measure 1
4.6596387398030609E-01
rattlers count 1
3.0000000000000000E+00
quadruple_contacts count 1
1.0000000000000000E+00
stress_xx measure 1
3.7470750587173036E+00
stress_xy measure 1
4.0919012891076972E-01
stress_xz measure 1
1.1112089398279064E+01
stress_yx measure 1
-3.0989018061851397E+00
stress_yy measure 1
2.5945213891504340E+00
stress_yz measure 1
2.7081736546767493E-01
stress_zx measure 1
1.7462172073070207E+01
stress_zy measure 1
1.1556999360991533E+00
stress_zz measure 1
6.2541644481485960E+01
shear_rate measure 1
2.0810594969564903E+01
momentum_x measure 1
9.0911789052651173E+00
momentum_y measure 1
9.2924905528423862E-02
momentum_z measure 1
-1.4177154503816830E+01
