steps count 1
4.0000000000000000E+02
contacts count 1
6.0000000000000000E+00
active_contacts count 1
6.0000000000000000E+00
sweeps effort 1
7.2800000000000000E+03
kinetic_energy measure 1
4.3940684051710086E+01
potential_energy measure 1
-1.7881466810659006E+02
external_work measure 1
-5.4069066293328275E-25
drive_work measure 1
5.8411953612752598E+01
friction_loss measure 1
1.4471269562113191E+01
impact_loss measure 1
1.6706884789821144E-08
energy_closure measure 1
7.5983790932690041E-16
mean_penetration measure 1
1.4639731094358096E-11
max_penetration measure 1
3.3516869835856438E-11
volume_error measure 1
1.3836354546359107E-10
compactness measure 1
4.6964038388810481E-01
coordination measure 1
1.5000000000000000E+00
coordination_without_rattlers measure 1
1.5000000000000000E+00
single_contacts count 1
2.0000000000000000E+00
double_contacts count 1
2.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.1715058234606457E-02
max_velocity measure 1
1.3333333333333330E-01
inertia_number measure 1
8.5894038837859815E-02
pressure measure 1
5.6565380448309952E+02
floor_share measure 1
9.9999999895775959E-01
rattlers count 1
2.0000000000000000E+00
stress_xx measure 1
1.2054525320952992E+02
stress_xy measure 1
3.0980649871579084E+02
stress_yx measure 1
3.0047107606867826E+02
stress_yy measure 1
1.0107623557566692E+03
shear_rate measure 1
4.0023491754488394E-01
momentum_x measure 1
7.6625299140760852E+00
momentum_y measure 1
-1.5379401919373840E-08
