steps count 1
1.2000000000000000E+02
contacts count 1
5.0000000000000000E+01
active_contacts count 1
2.8000000000000000E+01
sweeps effort 1
3.1400000000000000E+03
kinetic_energy measure 1
7.4736197122469818E+01
potential_energy measure 1
4.3465630334370115E+02
external_work measure 1
-4.7036392480192432E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
4.0679152955735374E+00
impact_loss measure 1
2.7716716077985513E+01
energy_closure measure 1
1.2006824791227216E-15
mean_penetration measure 1
1.2091173201556060E-10
max_penetration measure 1
5.3931666771367404E-10
volume_error measure 1
4.9194630869608445E-14
compactness measure 1
4.7822745170450226E-01
coordination measure 1
7.3333333333333328E-01
coordination_without_rattlers measure 1
2.0666666666666669E+00
single_contacts count 1
2.8000000000000000E+01
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.1712499954810272E-01
max_velocity measure 1
1.1772000000000009E+00
inertia_number measure 1
2.6911051875942860E-01
pressure measure 1
1.1266081673674250E+03
floor_share measure 1
1.2326168583522681E+00
rattlers count 1
4.5000000000000000E+01
stress_xx measure 1
5.5184628518705824E+02
stress_xy measure 1
-2.2795600550120202E+01
stress_yx measure 1
2.4856698523221226E+01
stress_yy measure 1
1.7013700495477917E+03
shear_rate measure 1
5.0452478667465241E+00
momentum_x measure 1
-2.5600368040539667E+00
momentum_y measure 1
-1.2844369475847108E+02
