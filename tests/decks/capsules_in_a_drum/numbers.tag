steps count 1
1.6000000000000000E+02
contacts count 1
6.0000000000000000E+00
active_contacts count 1
4.0000000000000000E+00
sweeps effort 1
2.0300000000000000E+03
kinetic_energy measure 1
1.2954409711144736E+00
potential_energy measure 1
-4.6268897232846715E+00
external_work measure 1
-1.4699172504567555E-16
drive_work measure 1
1.1460127330664425E+00
friction_loss measure 1
1.6857379736537261E+00
impact_loss measure 1
2.1543366018259325E+00
energy_closure measure 1
6.3288788166024506E-05
mean_penetration measure 1
7.9248466480034505E-06
max_penetration measure 1
1.2284543774665480E-05
volume_error measure 1
8.9875167883183989E-10
compactness measure 1
8.5418205456405868E-02
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
7.2114370536061589E-01
max_velocity measure 1
1.5696000000000048E+00
inertia_number measure 1
5.3834171593452105E+00
pressure measure 1
1.9039851187207223E+01
floor_share measure 1
5.7744611986072125E-01
rattlers count 1
2.0000000000000000E+00
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.1678460270022417E+00
stress_xy measure 1
-5.2836422114111068E+00
stress_xz measure 1
4.1643540019341252E+00
stress_yx measure 1
-6.7835941919526972E+00
stress_yy measure 1
3.0517307902886085E+01
stress_yz measure 1
6.1426882515218049E+00
stress_zx measure 1
4.5021615380219826E+00
stress_zy measure 1
8.2357112687165710E+00
stress_zz measure 1
2.3434399631733339E+01
shear_rate measure 1
7.2221260928095905E+00
momentum_x measure 1
5.7869146945733661E-02
momentum_y measure 1
8.4321825736234168E-01
momentum_z measure 1
-1.1772731367768328E+00
