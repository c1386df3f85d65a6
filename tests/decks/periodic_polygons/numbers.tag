steps count 1
1.0000000000000000E+02
contacts count 1
2.5000000000000000E+01
active_contacts count 1
1.7000000000000000E+01
sweeps effort 1
1.1860000000000000E+04
kinetic_energy measure 1
4.1978520094456833E+01
potential_energy measure 1
2.2135317287053752E+02
external_work measure 1
3.2864034385015244E-16
drive_work measure 1
1.8406723391590260E-02
friction_loss measure 1
1.2615944956731313E+00
impact_loss measure 1
2.0535379388296594E+01
energy_closure measure 1
2.5765102846464756E-15
mean_penetration measure 1
4.6887409346077963E-06
max_penetration measure 1
9.3774818692017147E-06
volume_error measure 1
1.8086087494118765E-09
compactness measure 1
4.8313756966793153E-01
coordination measure 1
7.5000000000000000E-01
coordination_without_rattlers measure 1
1.2857142857142858E+00
single_contacts count 1
1.1000000000000000E+01
double_contacts count 1
3.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
5.0778244832664199E-01
max_velocity measure 1
9.8099999999999909E-01
inertia_number measure 1
3.6878917390129740E-01
pressure measure 1
1.1923095580596639E+03
floor_share measure 1
1.5210632050067123E+00
rattlers count 1
2.1000000000000000E+01
stress_xx measure 1
1.7446633933063687E+01
stress_xy measure 1
-2.0482847344946001E+02
stress_yx measure 1
-1.7812316884999689E+02
stress_yy measure 1
2.3671724821862640E+03
shear_rate measure 1
4.8245389824638849E+00
momentum_x measure 1
1.8406723391625993E-01
momentum_y measure 1
-9.0499339805935477E+01
fabric_xx measure 1
4.4276832081545786E-02
fabric_xy measure 1
-2.7169566731476474E-03
fabric_yy measure 1
9.5572316791845424E-01
mobilised_friction measure 1
1.8507127700098172E-01
sliding_share measure 1
5.8823529411764705E-02
grain_coordination measure 1
5.0000000000000000E-01
wall_coordination measure 1
2.5000000000000000E-01
