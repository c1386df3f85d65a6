steps count 1
1.1500000000000000E+02
contacts count 1
1.2900000000000000E+02
active_contacts count 1
7.0000000000000000E+01
sweeps effort 1
4.6190000000000000E+03
kinetic_energy measure 1
4.8162780966053989E+00
potential_energy measure 1
7.3413456405733626E+01
external_work measure 1
-1.2866236771548682E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.9451903177982868E-01
impact_loss measure 1
2.0885300224284888E+00
energy_closure measure 1
8.0535401810088658E-15
mean_penetration measure 1
2.4544919915991948E-12
max_penetration measure 1
4.3412790723396100E-11
volume_error measure 1
1.8392007553243936E-20
compactness measure 1
3.2201596440423380E-01
coordination measure 1
9.6521739130434780E-01
coordination_without_rattlers measure 1
2.1142857142857143E+00
single_contacts count 1
7.0000000000000000E+01
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
6.1784315884007546E-01
max_velocity measure 1
1.1281500000000004E+00
inertia_number measure 1
1.0531065826253698E+00
pressure measure 1
2.9092959755457377E+02
floor_share measure 1
8.7917886733642669E-01
rattlers count 1
8.0000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
9.2304871019596561E+01
stress_xy measure 1
-5.4837211946714220E+01
stress_xz measure 1
-1.3092206468734483E+02
stress_yx measure 1
-4.9301701471407100E+01
stress_yy measure 1
1.0907394730509074E+02
stress_yz measure 1
5.8016156885546103E+01
stress_zx measure 1
-1.6417799392427662E+02
stress_zy measure 1
6.0124620107872026E+01
stress_zz measure 1
6.7140997433903408E+02
shear_rate measure 1
7.5387843606850078E+00
momentum_x measure 1
3.0757447109817887E-01
momentum_y measure 1
2.2762234668599113E-01
momentum_z measure 1
-9.2417764188001890E+00
fabric_xx measure 1
2.5280907099874805E-01
fabric_xy measure 1
-4.2290846693966225E-02
fabric_xz measure 1
2.2539234268969274E-04
fabric_yy measure 1
2.2962646775981896E-01
fabric_yz measure 1
3.3346147851381604E-02
fabric_zz measure 1
5.1756446124143296E-01
mobilised_friction measure 1
2.3603807900727389E-01
sliding_share measure 1
4.2857142857142855E-01
grain_coordination measure 1
7.1304347826086956E-01
wall_coordination measure 1
2.5217391304347825E-01
