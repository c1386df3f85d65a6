steps count 1
1.0000000000000000E+02
contacts count 1
7.0000000000000000E+00
active_contacts count 1
6.0000000000000000E+00
sweeps effort 1
5.9800000000000000E+03
kinetic_energy measure 1
1.0382036615775455E+01
potential_energy measure 1
-1.8761427107217878E+03
external_work measure 1
1.9408878721318000E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3170629503633116E+00
impact_loss measure 1
1.8539716115553087E+01
energy_closure measure 1
1.6343350450471447E-04
mean_penetration measure 1
6.0737398377855408E-05
max_penetration measure 1
3.0323412331410837E-04
volume_error measure 1
2.7156615491564451E-06
compactness measure 1
6.7652208551708781E-02
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
1.0410732034617181E+00
max_velocity measure 1
1.4800554121448364E+00
inertia_number measure 1
3.3799781464114808E+01
pressure measure 1
2.2961018652815614E+01
floor_share measure 1
4.6596403805427949E-01
rattlers count 1
3.0000000000000000E+00
quadruple_contacts count 1
1.0000000000000000E+00
stress_xx measure 1
3.7473246345416458E+00
stress_xy measure 1
4.0878815889181563E-01
stress_xz measure 1
1.1111875975760283E+01
stress_yx measure 1
-3.0982846018153052E+00
stress_yy measure 1
2.5940772169417761E+00
stress_yz measure 1
2.6926508528225379E-01
stress_zx measure 1
1.7461965162921199E+01
stress_zy measure 1
1.1545561637989350E+00
stress_zz measure 1
6.2541654106963428E+01
shear_rate measure 1
2.0810650517980680E+01
momentum_x measure 1
9.0911595914031587E+00
momentum_y measure 1
9.3628412736143266E-02
momentum_z measure 1
-1.4177144847219170E+01
fabric_xx measure 1
1.9999920134544327E-01
fabric_xy measure 1
7.1729233528129812E-08
fabric_xz measure 1
3.9999940100783021E-01
fabric_yy measure 1
2.5725517441673553E-14
fabric_yz measure 1
1.4345882510023533E-07
fabric_zz measure 1
8.0000079865453089E-01
mobilised_friction measure 1
3.0000000000000010E-01
sliding_share measure 1
1.0000000000000000E+00
grain_coordination measure 1
5.0000000000000000E-01
wall_coordination measure 1
5.0000000000000000E-01
coordination_sphere measure 1
1.0000000000000000E+00
coordination_polyhedron measure 1
1.5000000000000000E+00
coordination_clump measure 1
0.0000000000000000E+00
