steps count 1
1.0000000000000000E+02
contacts count 1
1.1220000000000000E+03
active_contacts count 1
5.3600000000000000E+02
sweeps effort 1
1.0811000000000000E+05
kinetic_energy measure 1
3.3323417192476229E-01
potential_energy measure 1
3.2037173009843976E+00
external_work measure 1
4.2906485536186425E+00
drive_work measure 1
1.2497172444028279E+00
friction_loss measure 1
2.4804183142406746E+00
impact_loss measure 1
4.3030671539827843E+00
energy_closure measure 1
5.5729591181739952E-15
mean_penetration measure 1
1.1777276492005070E-11
max_penetration measure 1
2.1288064540325724E-10
volume_error measure 1
2.0213305916150148E-18
compactness measure 1
5.4250376377838405E-01
coordination measure 1
3.7222222222222223E+00
coordination_without_rattlers measure 1
3.9227642276422765E+00
single_contacts count 1
5.3600000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.4053329086960248E-01
max_velocity measure 1
3.0468393758222723E-01
inertia_number measure 1
1.6026097251325467E-02
pressure measure 1
4.7342208466413949E+03
floor_share measure 1
8.7648145246320630E-01
rattlers count 1
2.4000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.3280548498376261E+03
stress_xy measure 1
2.9136060720438377E+02
stress_xz measure 1
-1.2027172095641695E+03
stress_yx measure 1
2.9221408560861556E+02
stress_yy measure 1
4.1350530999987250E+03
stress_yz measure 1
-2.5706507713791439E+02
stress_zx measure 1
-1.1962714522297158E+03
stress_zy measure 1
-2.4869788993492259E+02
stress_zz measure 1
6.7395545900878360E+03
shear_rate measure 1
6.9307724917786129E-01
momentum_x measure 1
8.7040182588169523E-01
momentum_y measure 1
-4.2073225590157512E-02
momentum_z measure 1
1.4131169969991138E-02
fabric_xx measure 1
3.1251454626096614E-01
fabric_xy measure 1
4.3508909496400936E-03
fabric_xz measure 1
-4.7502392559509020E-02
fabric_yy measure 1
3.4673471851717996E-01
fabric_yz measure 1
-8.3862586073953499E-03
fabric_zz measure 1
3.4075073522185345E-01
mobilised_friction measure 1
2.2098106938236178E-01
sliding_share measure 1
5.8208955223880599E-01
grain_coordination measure 1
3.4740740740740739E+00
wall_coordination measure 1
2.4814814814814815E-01
cell_x measure 1
2.0000000000000001E-01
cell_y measure 1
1.2000000000000000E-01
cell_z measure 1
6.4244596279830701E-02
strain_xx measure 1
0.0000000000000000E+00
strain_yy measure 1
0.0000000000000000E+00
strain_zz measure 1
4.4247257034382670E-01
void_ratio measure 1
8.4340198275738998E-01
