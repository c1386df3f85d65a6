steps count 1
1.0000000000000000E+02
contacts count 1
1.2400000000000000E+02
active_contacts count 1
9.5000000000000000E+01
sweeps effort 1
5.7670000000000000E+03
kinetic_energy measure 1
8.4859433710806275E+02
potential_energy measure 1
0.0000000000000000E+00
external_work measure 1
2.7096310077600106E+03
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3654745488214076E+02
impact_loss measure 1
1.3244892157698062E+03
energy_closure measure 1
3.3565260331324101E-16
mean_penetration measure 1
4.6861072121472270E-12
max_penetration measure 1
1.2109813152250126E-11
volume_error measure 1
1.1704455198768172E-16
compactness measure 1
7.2012450202397515E-01
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
7.0648820051578476E-01
max_velocity measure 1
1.3614902429662319E+00
inertia_number measure 1
3.9107499496988440E-02
pressure measure 1
1.5437829143390458E+04
floor_share measure 1
0.0000000000000000E+00
rattlers count 1
3.1000000000000000E+01
stress_xx measure 1
1.4442730370388803E+04
stress_xy measure 1
1.8392990777180466E+02
stress_yx measure 1
4.7035892635568644E+02
stress_yy measure 1
1.6432927916392113E+04
shear_rate measure 1
9.4857227052002213E-01
momentum_x measure 1
-5.6027968277065099E+01
momentum_y measure 1
-3.0040336942042838E+01
fabric_xx measure 1
5.1401872303066032E-01
fabric_xy measure 1
3.4454480097647032E-02
fabric_yy measure 1
4.8598127696933963E-01
mobilised_friction measure 1
2.1512678475691266E-01
sliding_share measure 1
5.7894736842105265E-01
grain_coordination measure 1
1.8222222222222222E+00
wall_coordination measure 1
1.4444444444444443E-01
cell_x measure 1
8.3567284836264122E-01
cell_y measure 1
5.0244469557565641E-01
strain_xx measure 1
1.7951807219664742E-01
strain_yy measure 1
1.7744407989571037E-01
void_ratio measure 1
3.8679150771669701E-01
