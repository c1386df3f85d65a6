steps count 1
1.0000000000000000E+02
contacts count 1
9.0000000000000000E+02
active_contacts count 1
5.2800000000000000E+02
sweeps effort 1
1.0863000000000000E+05
kinetic_energy measure 1
3.3318136051373670E-01
potential_energy measure 1
3.2037132911880319E+00
external_work measure 1
4.2906514726104081E+00
drive_work measure 1
1.2500214494695938E+00
friction_loss measure 1
2.4807762601344852E+00
impact_loss measure 1
4.3030731533548874E+00
energy_closure measure 1
3.3024896878925989E-15
mean_penetration measure 1
1.4291171653198209E-11
max_penetration measure 1
1.9043806288865373E-10
volume_error measure 1
1.9237268614807277E-18
compactness measure 1
5.4250562598254659E-01
coordination measure 1
3.6629629629629630E+00
coordination_without_rattlers measure 1
3.8536585365853657E+00
single_contacts count 1
5.2800000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.4053636335025482E-01
max_velocity measure 1
3.0519149520601468E-01
inertia_number measure 1
1.5987504315314517E-02
pressure measure 1
4.7501107540395833E+03
floor_share measure 1
8.6627407470881523E-01
rattlers count 1
2.4000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.3475348023331376E+03
stress_xy measure 1
2.3510624878404460E+02
stress_xz measure 1
-1.2164226527006808E+03
stress_yx measure 1
2.3595285750423193E+02
stress_yy measure 1
4.1667549863754575E+03
stress_yz measure 1
-2.2658723770588378E+02
stress_zx measure 1
-1.2084630472308713E+03
stress_zy measure 1
-2.1740135837489782E+02
stress_zz measure 1
6.7360424734101571E+03
shear_rate measure 1
6.9256757561178850E-01
momentum_x measure 1
8.7062233382811638E-01
momentum_y measure 1
-4.2040368542528239E-02
momentum_z measure 1
1.4640191384622138E-02
fabric_xx measure 1
3.1155947622132441E-01
fabric_xy measure 1
7.7739376582526792E-04
fabric_xz measure 1
-4.9892509603621460E-02
fabric_yy measure 1
3.4576951505888115E-01
fabric_yz measure 1
-7.9260870436048663E-03
fabric_zz measure 1
3.4267100871979450E-01
mobilised_friction measure 1
2.2160844422476103E-01
sliding_share measure 1
5.7765151515151514E-01
grain_coordination measure 1
3.4148148148148150E+00
wall_coordination measure 1
2.4814814814814815E-01
cell_x measure 1
2.0000000000000001E-01
cell_y measure 1
1.2000000000000000E-01
cell_z measure 1
6.4244571061579991E-02
strain_xx measure 1
0.0000000000000000E+00
strain_yy measure 1
0.0000000000000000E+00
strain_zz measure 1
4.4247296287887439E-01
void_ratio measure 1
8.4340125915764697E-01
