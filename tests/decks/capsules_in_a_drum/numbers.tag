steps count 1
1.6000000000000000E+02
contacts count 1
6.0000000000000000E+00
active_contacts count 1
4.0000000000000000E+00
sweeps effort 1
1.2390000000000000E+03
kinetic_energy measure 1
1.2955378937543918E+00
potential_energy measure 1
-4.6268236798902498E+00
external_work measure 1
2.5628133126115210E-05
drive_work measure 1
1.1460984040104758E+00
friction_loss measure 1
1.6857707930295951E+00
impact_loss measure 1
2.1542519702191045E+00
energy_closure measure 1
6.3248546149214898E-05
mean_penetration measure 1
5.4387991524999331E-06
max_penetration measure 1
6.1365618062303451E-06
volume_error measure 1
8.8960928949155279E-10
compactness measure 1
8.5417293814451553E-02
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
7.2117929625400368E-01
max_velocity measure 1
1.5696000000000048E+00
inertia_number measure 1
5.3675314816864441E+00
pressure measure 1
1.9153261089551929E+01
floor_share measure 1
5.7605958790451939E-01
rattlers count 1
2.0000000000000000E+00
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.3100349698666647E+00
stress_xy measure 1
-5.4503440001090082E+00
stress_xz measure 1
4.2721950933142008E+00
stress_yx measure 1
-6.9515266926641939E+00
stress_yy measure 1
3.0832222826490749E+01
stress_yz measure 1
5.7270215372298656E+00
stress_zx measure 1
4.6205903989154224E+00
stress_zy measure 1
7.8400517155223666E+00
stress_zz measure 1
2.3317525472298367E+01
shear_rate measure 1
7.2222284560440695E+00
momentum_x measure 1
5.7876878762954977E-02
momentum_y measure 1
8.4329515364377017E-01
momentum_z measure 1
-1.1772361042000996E+00
fabric_xx measure 1
5.4638519294225620E-02
fabric_xy measure 1
-7.0211765724807224E-02
fabric_xz measure 1
-1.1111347331312407E-01
fabric_yy measure 1
6.8674828369537000E-01
fabric_yz measure 1
3.2215260224540358E-03
fabric_zz measure 1
2.5861319701040453E-01
mobilised_friction measure 1
4.8977561405550268E-01
sliding_share measure 1
5.0000000000000000E-01
grain_coordination measure 1
1.0000000000000000E+00
wall_coordination measure 1
5.0000000000000000E-01
coordination_cylinder measure 1
2.0000000000000000E+00
coordination_clump measure 1
0.0000000000000000E+00
