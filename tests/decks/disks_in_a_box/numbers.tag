steps count 1
1.2000000000000000E+02
contacts count 1
3.5000000000000000E+01
active_contacts count 1
2.8000000000000000E+01
sweeps effort 1
3.2150000000000000E+03
kinetic_energy measure 1
7.4736199846471706E+01
potential_energy measure 1
4.3465630322565090E+02
external_work measure 1
-4.8181763564848453E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
4.0679153021803343E+00
impact_loss measure 1
2.7716713465427169E+01
energy_closure measure 1
2.0344897540365828E-15
mean_penetration measure 1
1.3375342500232534E-12
max_penetration measure 1
6.3675592576473150E-12
volume_error measure 1
5.4340754481829422E-17
compactness measure 1
4.7822745211548640E-01
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
7.1712505359058754E-01
max_velocity measure 1
1.1772000000000009E+00
inertia_number measure 1
2.6911129037902387E-01
pressure measure 1
1.1266015940177933E+03
floor_share measure 1
1.2326103800358015E+00
rattlers count 1
4.5000000000000000E+01
stress_xx measure 1
5.5184056435795435E+02
stress_xy measure 1
-2.2792664761164847E+01
stress_yx measure 1
2.4859795852831194E+01
stress_yy measure 1
1.7013626236776324E+03
shear_rate measure 1
5.0452476143086127E+00
momentum_x measure 1
-2.5600352178963997E+00
momentum_y measure 1
-1.2844370343815822E+02
fabric_xx measure 1
3.1581833061661496E-01
fabric_xy measure 1
-8.8915304000181786E-02
fabric_yy measure 1
6.8418166938338498E-01
mobilised_friction measure 1
1.4067415340529385E-01
sliding_share measure 1
2.8571428571428570E-01
grain_coordination measure 1
5.3333333333333333E-01
wall_coordination measure 1
2.0000000000000001E-01
