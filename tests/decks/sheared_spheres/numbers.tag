steps count 1
1.0000000000000000E+02
contacts count 1
1.1180000000000000E+03
active_contacts count 1
5.2300000000000000E+02
sweeps effort 1
1.0787000000000000E+05
kinetic_energy measure 1
3.3644301696456969E-01
potential_energy measure 1
3.2031258121721486E+00
external_work measure 1
4.2917687729870133E+00
drive_work measure 1
1.2487616124992320E+00
friction_loss measure 1
2.4771280866234111E+00
impact_loss measure 1
4.3039046128372318E+00
energy_closure measure 1
1.8572915750638721E-15
mean_penetration measure 1
1.0442329568278589E-11
max_penetration measure 1
1.9570037430860499E-10
volume_error measure 1
2.1682871874709075E-18
compactness measure 1
5.4257980405830752E-01
coordination measure 1
3.6259259259259258E+00
coordination_without_rattlers measure 1
3.8408163265306121E+00
single_contacts count 1
5.2300000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.4226934694199692E-01
max_velocity measure 1
3.3745923855057042E-01
inertia_number measure 1
1.7707509475482306E-02
pressure measure 1
4.6312783790497115E+03
floor_share measure 1
8.5203573048148529E-01
rattlers count 1
2.5000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.2161388249780962E+03
stress_xy measure 1
1.8359969199028714E+02
stress_xz measure 1
-1.1621719477946533E+03
stress_yx measure 1
1.8079993891468939E+02
stress_yy measure 1
3.9281487664430711E+03
stress_yz measure 1
-2.2821849103832713E+02
stress_zx measure 1
-1.1622597759260450E+03
stress_zy measure 1
-2.2830777807919216E+02
stress_zz measure 1
6.7495475457279681E+03
shear_rate measure 1
7.5742134273983941E-01
momentum_x measure 1
8.7807152496753194E-01
momentum_y measure 1
-3.9597717448255375E-02
momentum_z measure 1
7.1050512097080786E-04
