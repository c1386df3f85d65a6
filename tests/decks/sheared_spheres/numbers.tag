steps count 1
1.0000000000000000E+02
contacts count 1
1.1220000000000000E+03
active_contacts count 1
5.3600000000000000E+02
sweeps effort 1
1.0811000000000000E+05
kinetic_energy measure 1
3.3323414528933698E-01
potential_energy measure 1
3.2037173534790462E+00
external_work measure 1
4.2906486740695788E+00
drive_work measure 1
1.2497168675628079E+00
friction_loss measure 1
2.4804182747807855E+00
impact_loss measure 1
4.3030669111943052E+00
energy_closure measure 1
8.6690480062862356E-15
mean_penetration measure 1
1.1776962837479437E-11
max_penetration measure 1
2.1288059683099991E-10
volume_error measure 1
2.0212131775647269E-18
compactness measure 1
5.4250376784209520E-01
coordination measure 1
3.7222222222222223E+00
coordination_without_rattlers measure 1
3.9227642276422765E+00
single_contacts count 1
5.3600000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.4053307814197130E-01
max_velocity measure 1
3.0468840984419027E-01
inertia_number measure 1
1.6026069954918083E-02
pressure measure 1
4.7342555088072077E+03
floor_share measure 1
8.7652309154661057E-01
rattlers count 1
2.4000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.3280833067164358E+03
stress_xy measure 1
2.9131420824433411E+02
stress_xz measure 1
-1.2027368850989228E+03
stress_yx measure 1
2.9217104344467748E+02
stress_yy measure 1
4.1350843100956881E+03
stress_yz measure 1
-2.5707154460633598E+02
stress_zx measure 1
-1.1962897869948570E+03
stress_zy measure 1
-2.4870164349921447E+02
stress_zz measure 1
6.7395989096094982E+03
shear_rate measure 1
6.9307860591102866E-01
momentum_x measure 1
8.7039998978217648E-01
momentum_y measure 1
-4.2072498434574467E-02
momentum_z measure 1
1.4132942382494976E-02
