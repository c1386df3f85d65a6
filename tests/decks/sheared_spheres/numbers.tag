steps count 1
7.0000000000000000E+01
contacts count 1
6.7400000000000000E+02
active_contacts count 1
4.9800000000000000E+02
sweeps effort 1
5.0050000000000000E+04
kinetic_energy measure 1
3.1685067234587683E-01
potential_energy measure 1
3.2020392638631083E+00
external_work measure 1
4.2812567890085802E+00
drive_work measure 1
7.4330218677267013E-01
friction_loss measure 1
2.0515691846769193E+00
impact_loss measure 1
4.2341709980065687E+00
energy_closure measure 1
2.3235229258334186E-14
mean_penetration measure 1
1.0560095917042610E-11
max_penetration measure 1
1.8530592858778672E-10
volume_error measure 1
1.7678094110899949E-18
compactness measure 1
5.4179211041077557E-01
coordination measure 1
3.4407407407407407E+00
coordination_without_rattlers measure 1
3.7191489361702126E+00
single_contacts count 1
4.9800000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.1228936113592417E-01
max_velocity measure 1
2.7439415298650677E-01
inertia_number measure 1
2.1464020638830215E-02
pressure measure 1
5.2764233859137594E+03
floor_share measure 1
1.0357655527784637E+00
rattlers count 1
3.5000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.8242625335663520E+03
stress_xy measure 1
9.7014933250778583E+01
stress_xz measure 1
-1.1668431774780781E+03
stress_yx measure 1
9.5560866093876172E+01
stress_yy measure 1
4.9200153782158104E+03
stress_yz measure 1
-9.1924670239162637E+01
stress_zx measure 1
-1.1586166760043029E+03
stress_zy measure 1
-8.1823602227712399E+01
stress_zz measure 1
7.0849922459591162E+03
shear_rate measure 1
9.7996487152285927E-01
momentum_x measure 1
6.3120065978542428E-01
momentum_y measure 1
3.7899730580301258E-02
momentum_z measure 1
4.2019897119018627E-03
fabric_xx measure 1
3.0310490713705773E-01
fabric_xy measure 1
1.4024723605783553E-02
fabric_xz measure 1
-3.8091324223074652E-02
fabric_yy measure 1
3.3566467050366594E-01
fabric_yz measure 1
-1.6085569345599706E-02
fabric_zz measure 1
3.6123042235927627E-01
mobilised_friction measure 1
2.2066756820326358E-01
sliding_share measure 1
5.9839357429718876E-01
grain_coordination measure 1
3.1925925925925926E+00
wall_coordination measure 1
2.4814814814814815E-01
cell_x measure 1
2.0000000000000001E-01
cell_y measure 1
1.2000000000000000E-01
cell_z measure 1
6.4322860091595171E-02
strain_xx measure 1
0.0000000000000000E+00
strain_yy measure 1
0.0000000000000000E+00
strain_zz measure 1
4.4125509550780684E-01
void_ratio measure 1
8.4564764502533185E-01
