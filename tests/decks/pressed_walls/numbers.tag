steps count 1
1.0000000000000000E+02
contacts count 1
1.4300000000000000E+02
active_contacts count 1
9.5000000000000000E+01
sweeps effort 1
5.1630000000000000E+03
kinetic_energy measure 1
8.4859428538611053E+02
potential_energy measure 1
0.0000000000000000E+00
external_work measure 1
2.7096310024312265E+03
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3654746378544530E+02
impact_loss measure 1
1.3244892532596709E+03
energy_closure measure 1
1.6782630198666916E-16
mean_penetration measure 1
4.3345402498765990E-12
max_penetration measure 1
2.4917512497779626E-11
volume_error measure 1
1.6978795821365455E-16
compactness measure 1
7.2012450180007992E-01
coordination measure 1
1.9666666666666666E+00
coordination_without_rattlers measure 1
2.4915254237288136E+00
single_contacts count 1
9.5000000000000000E+01
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.0648820409087110E-01
max_velocity measure 1
1.3614902735412941E+00
inertia_number measure 1
3.9107544221568168E-02
pressure measure 1
1.5437805210465678E+04
floor_share measure 1
0.0000000000000000E+00
rattlers count 1
3.1000000000000000E+01
stress_xx measure 1
1.4442714845596995E+04
stress_xy measure 1
1.8392257065447239E+02
stress_yx measure 1
4.7035135261112953E+02
stress_yy measure 1
1.6432895575334362E+04
shear_rate measure 1
9.4857262006100540E-01
momentum_x measure 1
-5.6027939561519560E+01
momentum_y measure 1
-3.0040361601399606E+01
fabric_xx measure 1
5.1401872335813448E-01
fabric_xy measure 1
3.4454481163865756E-02
fabric_yy measure 1
4.8598127664186580E-01
mobilised_friction measure 1
2.1512708653828277E-01
sliding_share measure 1
5.7894736842105265E-01
grain_coordination measure 1
1.8222222222222222E+00
wall_coordination measure 1
1.4444444444444443E-01
cell_x measure 1
8.3567284896429328E-01
cell_y measure 1
5.0244469547021575E-01
strain_xx measure 1
1.7951807147668614E-01
strain_yy measure 1
1.7744408010556570E-01
void_ratio measure 1
3.8679150842410781E-01
