steps count 1
3.0000000000000000E+02
contacts count 1
5.0000000000000000E+00
active_contacts count 1
1.0000000000000000E+00
sweeps effort 1
4.1000000000000000E+02
kinetic_energy measure 1
3.2834842745141557E+01
potential_energy measure 1
-1.7002107170011942E+02
external_work measure 1
1.4981948759302964E-02
drive_work measure 1
1.4637597942917880E+01
friction_loss measure 1
1.3501516935135630E+01
impact_loss measure 1
1.1794699775730953E+02
energy_closure measure 1
1.0454974126875400E-15
mean_penetration measure 1
5.7386652963509199E-06
max_penetration measure 1
5.7386652963509199E-06
volume_error measure 1
9.5331850458210475E-08
compactness measure 1
5.6157255799855521E-01
coordination measure 1
2.0000000000000001E-01
coordination_without_rattlers measure 1
0.0000000000000000E+00
single_contacts count 1
1.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
9.8396603096296642E-01
max_velocity measure 1
1.1632907003115527E+00
inertia_number measure 1
1.8331585868413858E+00
pressure measure 1
2.3092098779627335E+01
floor_share measure 1
1.9526693744799373E-01
rattlers count 1
5.0000000000000000E+00
stress_xx measure 1
3.0537056788485164E+00
stress_xy measure 1
9.7935412174251564E+00
stress_yx measure 1
1.3448437604202345E+01
stress_yy measure 1
4.3130491880406154E+01
shear_rate measure 1
2.7940782651421698E+00
momentum_x measure 1
3.1815099413264168E+01
momentum_y measure 1
-1.9545543549426490E+01
fabric_xx measure 1
0.0000000000000000E+00
fabric_xy measure 1
0.0000000000000000E+00
fabric_yy measure 1
0.0000000000000000E+00
mobilised_friction measure 1
7.9137379881677739E-02
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
0.0000000000000000E+00
wall_coordination measure 1
2.0000000000000001E-01
coordination_disk measure 1
3.3333333333333331E-01
coordination_clump measure 1
0.0000000000000000E+00
