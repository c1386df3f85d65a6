steps count 1
1.2000000000000000E+02
contacts count 1
1.8300000000000000E+02
active_contacts count 1
9.7000000000000000E+01
sweeps effort 1
8.8600000000000000E+03
kinetic_energy measure 1
4.4930934796717228E+00
potential_energy measure 1
7.2970487928564694E+01
external_work measure 1
-1.2969747379531344E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
8.3123248274224015E-01
impact_loss measure 1
2.6179696655686708E+00
energy_closure measure 1
5.7032754163813774E-15
mean_penetration measure 1
1.0386688037433701E-12
max_penetration measure 1
9.2638466342442882E-12
volume_error measure 1
1.5076486978777932E-21
compactness measure 1
3.2850932886231521E-01
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
5.8677458477544064E-01
max_velocity measure 1
1.1772000000000009E+00
inertia_number measure 1
4.5245208098524647E-01
pressure measure 1
1.7380733521951879E+03
floor_share measure 1
4.0769902125167521E+00
rattlers count 1
6.5000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
5.2392434667501084E+02
stress_xy measure 1
2.2293329475304631E+01
stress_xz measure 1
-7.4115575347132093E+01
stress_yx measure 1
-2.1022010760252964E+01
stress_yy measure 1
8.5126956535009128E+02
stress_yz measure 1
5.2470928038692273E+02
stress_zx measure 1
-2.0257802703239670E+02
stress_zy measure 1
5.2100671469906115E+02
stress_zz measure 1
3.8390261445604619E+03
shear_rate measure 1
7.9166543032503069E+00
momentum_x measure 1
3.7057752980875741E-01
momentum_y measure 1
2.7469818740694479E-01
momentum_z measure 1
-8.3948057195420844E+00
