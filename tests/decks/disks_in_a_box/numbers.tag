steps count 1
1.2000000000000000E+02
contacts count 1
4.8000000000000000E+01
active_contacts count 1
2.8000000000000000E+01
sweeps effort 1
3.1610000000000000E+03
kinetic_energy measure 1
7.4736199899145859E+01
potential_energy measure 1
4.3465630322118022E+02
external_work measure 1
-4.4783581579093054E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
4.0679153426862271E+00
impact_loss measure 1
2.7716713376717877E+01
energy_closure measure 1
2.7348878659671803E-15
mean_penetration measure 1
6.3720325312507009E-13
max_penetration measure 1
2.4296328837714043E-12
volume_error measure 1
1.5120971654719590E-17
compactness measure 1
4.7822745211532608E-01
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
7.1712505473009280E-01
max_velocity measure 1
1.1772000000000009E+00
inertia_number measure 1
2.6911132256400494E-01
pressure measure 1
1.1266013236156032E+03
floor_share measure 1
1.2326101725499341E+00
rattlers count 1
4.5000000000000000E+01
stress_xx measure 1
5.5184026826752404E+02
stress_xy measure 1
-2.2792488640246656E+01
stress_yx measure 1
2.4860000170757150E+01
stress_yy measure 1
1.7013623789636822E+03
shear_rate measure 1
5.0452476122368584E+00
momentum_x measure 1
-2.5600351364150038E+00
momentum_y measure 1
-1.2844370354402284E+02
fabric_xx measure 1
3.1581833123934955E-01
fabric_xy measure 1
-8.8915304345967450E-02
fabric_yy measure 1
6.8418166876065056E-01
mobilised_friction measure 1
1.4067411362387677E-01
sliding_share measure 1
2.8571428571428570E-01
grain_coordination measure 1
5.3333333333333333E-01
wall_coordination measure 1
2.0000000000000001E-01
