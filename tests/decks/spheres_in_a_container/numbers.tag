steps count 1
1.1500000000000000E+02
contacts count 1
1.6100000000000000E+02
active_contacts count 1
7.0000000000000000E+01
sweeps effort 1
4.4040000000000000E+03
kinetic_energy measure 1
4.8162781573673605E+00
potential_energy measure 1
7.3413456404678456E+01
external_work measure 1
-1.5425807976515388E-17
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.9451900228055599E-01
impact_loss measure 1
2.0885299922209293E+00
energy_closure measure 1
2.6647743242235831E-15
mean_penetration measure 1
3.1246476531918580E-12
max_penetration measure 1
4.5609276771996221E-11
volume_error measure 1
2.0937373327000032E-20
compactness measure 1
3.2201596439886110E-01
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
6.1784316263412120E-01
max_velocity measure 1
1.1281500000000004E+00
inertia_number measure 1
1.0531069593974758E+00
pressure measure 1
2.9092939333383202E+02
floor_share measure 1
8.7917838685728433E-01
rattlers count 1
8.0000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
9.2304849321785298E+01
stress_xy measure 1
-5.4837207429633949E+01
stress_xz measure 1
-1.3092199370353504E+02
stress_yx measure 1
-4.9301711378176194E+01
stress_yy measure 1
1.0907390368669802E+02
stress_yz measure 1
5.8016191462179279E+01
stress_zx measure 1
-1.6417788475017420E+02
stress_zy measure 1
6.0124658183220554E+01
stress_zz measure 1
6.7140942699301286E+02
shear_rate measure 1
7.5387844118900071E+00
momentum_x measure 1
3.0757449236874540E-01
momentum_y measure 1
2.2762234245113461E-01
momentum_z measure 1
-9.2417764990970355E+00
fabric_xx measure 1
2.5280907099330774E-01
fabric_xy measure 1
-4.2290846621008973E-02
fabric_xz measure 1
2.2539216153073230E-04
fabric_yy measure 1
2.2962646774328008E-01
fabric_yz measure 1
3.3346147619230465E-02
fabric_zz measure 1
5.1756446126341227E-01
mobilised_friction measure 1
2.3603800110980630E-01
sliding_share measure 1
4.2857142857142855E-01
grain_coordination measure 1
7.1304347826086956E-01
wall_coordination measure 1
2.5217391304347825E-01
