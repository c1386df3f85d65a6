steps count 1
1.0000000000000000E+02
contacts count 1
7.0000000000000000E+00
active_contacts count 1
5.0000000000000000E+00
sweeps effort 1
1.1500000000000000E+03
kinetic_energy measure 1
1.0387107806996868E+01
potential_energy measure 1
-1.8761362075087557E+03
external_work measure 1
1.8796439268254427E-04
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3135933359827856E+00
impact_loss measure 1
1.8531726550785567E+01
energy_closure measure 1
1.5957884345082848E-04
mean_penetration measure 1
2.6233909052948057E-06
max_penetration measure 1
4.9387219273798463E-06
volume_error measure 1
9.9391831195066755E-06
compactness measure 1
6.7665232980204881E-02
coordination measure 1
1.0000000000000000E+00
coordination_without_rattlers measure 1
1.0000000000000000E+00
single_contacts count 1
2.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
1.0000000000000000E+00
mean_velocity measure 1
1.0412244543217297E+00
max_velocity measure 1
1.4799226595326336E+00
inertia_number measure 1
3.3729823349952632E+01
pressure measure 1
2.3006407944260292E+01
floor_share measure 1
4.6594669395110938E-01
rattlers count 1
3.0000000000000000E+00
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.7580473384126920E+00
stress_xy measure 1
4.0417775845384496E-01
stress_xz measure 1
1.1136524130477413E+01
stress_yx measure 1
-3.1642622395130773E+00
stress_yy measure 1
2.6664771701941836E+00
stress_yz measure 1
2.4757781733134518E-01
stress_zx measure 1
1.7497676930914089E+01
stress_zy measure 1
1.1431039504214284E+00
stress_zz measure 1
6.2594699324174002E+01
shear_rate measure 1
2.0788093564416815E+01
momentum_x measure 1
9.0959436506212565E+00
momentum_y measure 1
9.3462841495495538E-02
momentum_z measure 1
-1.4179505170628286E+01
fabric_xx measure 1
1.9998778751768939E-01
fabric_xy measure 1
4.7103605603228287E-06
fabric_xz measure 1
3.9999084031922705E-01
fabric_yy measure 1
1.1094425756513887E-10
fabric_yz measure 1
9.4210806675553637E-06
fabric_zz measure 1
8.0001221237136622E-01
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
