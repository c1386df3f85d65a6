steps count 1
2.5000000000000000E+02
contacts count 1
1.5000000000000000E+01
active_contacts count 1
1.2000000000000000E+01
sweeps effort 1
2.8800000000000000E+03
kinetic_energy measure 1
8.0093800260047317E+01
potential_energy measure 1
4.5984802005254796E+03
external_work measure 1
1.5626862773042452E-16
drive_work measure 1
8.0000000000000014E+01
friction_loss measure 1
1.8779186822732846E-01
impact_loss measure 1
9.5164478072990342E+00
energy_closure measure 1
2.8255353174005857E-14
mean_penetration measure 1
1.5511001283342241E-07
max_penetration measure 1
7.7523437495841119E-07
volume_error measure 1
6.3590869973947922E-12
compactness measure 1
1.3588248611572598E-01
coordination measure 1
8.3333333333333337E-01
coordination_without_rattlers measure 1
1.0000000000000000E+00
single_contacts count 1
0.0000000000000000E+00
double_contacts count 1
2.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
2.4189532444311879E-02
max_velocity measure 1
7.4542752637856688E-02
inertia_number measure 1
3.8692005053647083E-01
pressure measure 1
9.0289166350932291E+01
floor_share measure 1
8.6797936228271755E-01
rattlers count 1
5.0000000000000000E+00
quadruple_contacts count 1
2.0000000000000000E+00
stress_xx measure 1
-3.5082863568289262E+01
stress_xy measure 1
-3.1288447419723177E+01
stress_xz measure 1
2.5141698185048943E-08
stress_yx measure 1
-3.1288447419723223E+01
stress_yy measure 1
-2.3705685090703927E+01
stress_yz measure 1
1.2421301722361945E-12
stress_zx measure 1
5.0307821719005183E-08
stress_zy measure 1
1.1256947194760727E-11
stress_zz measure 1
3.2965604771179005E+02
shear_rate measure 1
2.9949754622112895E-01
momentum_x measure 1
4.4652655132194607E-01
momentum_y measure 1
-1.0703033281490146E+00
momentum_z measure 1
-4.8778089409009857E-02
fabric_xx measure 1
4.9892389848414629E-34
fabric_xy measure 1
3.9985975353857476E-30
fabric_xz measure 1
2.2336604452873903E-17
fabric_yy measure 1
3.2046535150091695E-26
fabric_yz measure 1
1.7901546064541937E-13
fabric_zz measure 1
1.0000000000000000E+00
mobilised_friction measure 1
2.7448912428655026E-01
sliding_share measure 1
0.0000000000000000E+00
grain_coordination measure 1
3.3333333333333331E-01
wall_coordination measure 1
5.0000000000000000E-01
coordination_sphere measure 1
0.0000000000000000E+00
coordination_cylinder measure 1
1.0000000000000000E+00
coordination_polyhedron measure 1
1.5000000000000000E+00
coordination_clump measure 1
1.0000000000000000E+00
