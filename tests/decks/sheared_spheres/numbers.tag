steps count 1
1.0000000000000000E+02
contacts count 1
1.1210000000000000E+03
active_contacts count 1
5.3900000000000000E+02
sweeps effort 1
1.0845000000000000E+05
kinetic_energy measure 1
3.3322672097870526E-01
potential_energy measure 1
3.2037250367047267E+00
external_work measure 1
4.2906899766543978E+00
drive_work measure 1
1.2496432715839088E+00
friction_loss measure 1
2.4804367342722982E+00
impact_loss measure 1
4.3030158993937224E+00
energy_closure measure 1
4.9538004439645192E-15
mean_penetration measure 1
1.4602140529530769E-11
max_penetration measure 1
1.9625656481891962E-10
volume_error measure 1
2.1507613266904439E-18
compactness measure 1
5.4250575304242155E-01
coordination measure 1
3.7407407407407409E+00
coordination_without_rattlers measure 1
3.9274193548387095E+00
single_contacts count 1
5.3900000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.4052746508696812E-01
max_velocity measure 1
3.0607484445775224E-01
inertia_number measure 1
1.6043497279531482E-02
pressure measure 1
4.7303046639606409E+03
floor_share measure 1
8.7135742358150381E-01
rattlers count 1
2.2000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.3300496530187993E+03
stress_xy measure 1
2.6518891265298748E+02
stress_xz measure 1
-1.2015201738797937E+03
stress_yx measure 1
2.6719352475878321E+02
stress_yy measure 1
4.1402582136661258E+03
stress_yz measure 1
-2.5196772268812774E+02
stress_zx measure 1
-1.1936581801678017E+03
stress_zy measure 1
-2.4262810356448600E+02
stress_zz measure 1
6.7206061251969986E+03
shear_rate measure 1
6.9354271459731343E-01
momentum_x measure 1
8.7012706238796411E-01
momentum_y measure 1
-4.2114766553368349E-02
momentum_z measure 1
1.4234572387659704E-02
