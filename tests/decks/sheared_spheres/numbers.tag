steps count 1
1.0000000000000000E+02
contacts count 1
6.7000000000000000E+02
active_contacts count 1
5.3100000000000000E+02
sweeps effort 1
1.2152000000000000E+05
kinetic_energy measure 1
3.3360941709223108E-01
potential_energy measure 1
3.2038457039310444E+00
external_work measure 1
4.2898423378926402E+00
drive_work measure 1
1.2504843895513378E+00
friction_loss measure 1
2.4800270418600388E+00
impact_loss measure 1
4.3029157076718860E+00
energy_closure measure 1
2.2705447376721830E-14
mean_penetration measure 1
1.1289650623738794E-11
max_penetration measure 1
1.8530592858778672E-10
volume_error measure 1
1.9058727644448145E-18
compactness measure 1
5.4245551500114719E-01
coordination measure 1
3.6777777777777776E+00
coordination_without_rattlers measure 1
3.9128630705394190E+00
single_contacts count 1
5.3100000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.4121002943008501E-01
max_velocity measure 1
3.1260161776632472E-01
inertia_number measure 1
1.6829708191051226E-02
pressure measure 1
4.8181061880060579E+03
floor_share measure 1
9.2154169835644117E-01
rattlers count 1
2.9000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.4989028736459700E+03
stress_xy measure 1
2.0198733298975077E+02
stress_xz measure 1
-1.1356493089969213E+03
stress_yx measure 1
2.0398362430848056E+02
stress_yy measure 1
4.2592353302834317E+03
stress_yz measure 1
-1.1647344904049280E+02
stress_zx measure 1
-1.1251475837127784E+03
stress_zy measure 1
-1.1210266383802809E+02
stress_zz measure 1
6.6961803600887706E+03
shear_rate measure 1
7.3425072150179116E-01
momentum_x measure 1
8.7382630616942403E-01
momentum_y measure 1
-3.5515935103911246E-02
momentum_z measure 1
1.6973793863574973E-02
fabric_xx measure 1
3.1550420800366780E-01
fabric_xy measure 1
7.1012521523002347E-03
fabric_xz measure 1
-4.9880903231709919E-02
fabric_yy measure 1
3.4415683742975822E-01
fabric_yz measure 1
-1.5738442660435573E-02
fabric_zz measure 1
3.4033895456657332E-01
mobilised_friction measure 1
2.1615915633960164E-01
sliding_share measure 1
5.7062146892655363E-01
grain_coordination measure 1
3.4222222222222221E+00
wall_coordination measure 1
2.5555555555555554E-01
cell_x measure 1
2.0000000000000001E-01
cell_y measure 1
1.2000000000000000E-01
cell_z measure 1
6.4251313850894665E-02
strain_xx measure 1
0.0000000000000000E+00
strain_yy measure 1
0.0000000000000000E+00
strain_zz measure 1
4.4236801338067910E-01
void_ratio measure 1
8.4359473334710033E-01
