steps count 1
1.0000000000000000E+02
contacts count 1
7.0000000000000000E+00
active_contacts count 1
6.0000000000000000E+00
sweeps effort 1
5.9800000000000000E+03
kinetic_energy measure 1
1.0382026317553143E+01
potential_energy measure 1
-1.8761427126315803E+03
external_work measure 1
2.2509056118560476E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
5.3172370837522136E+00
impact_loss measure 1
1.8539554170614576E+01
energy_closure measure 1
1.6343387683645576E-04
mean_penetration measure 1
6.0737396606375953E-05
max_penetration measure 1
3.0323403707549490E-04
volume_error measure 1
2.7157320941876829E-06
compactness measure 1
6.7652310819031364E-02
coordination measure 1
1.0000000000000000E+00
coordination_without_rattlers measure 1
1.0000000000000000E+00
single_contacts count 1
2.0000000000000000E+00
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.0410734409236420E+00
max_velocity measure 1
1.4800594726448353E+00
inertia_number measure 1
3.3799670163482453E+01
pressure measure 1
2.2961068638240942E+01
floor_share measure 1
4.6596389854286901E-01
rattlers count 1
3.0000000000000000E+00
quadruple_contacts count 1
1.0000000000000000E+00
stress_xx measure 1
3.7471133344392564E+00
stress_xy measure 1
4.0912945482406632E-01
stress_xz measure 1
1.1112058055015847E+01
stress_yx measure 1
-3.0988108155649301E+00
stress_yy measure 1
2.5944471131441573E+00
stress_yz measure 1
2.7057781588502133E-01
stress_zx measure 1
1.7462141143251728E+01
stress_zy measure 1
1.1555241770834499E+00
stress_zz measure 1
6.2541645467139411E+01
shear_rate measure 1
2.0810604641752874E+01
momentum_x measure 1
9.0911760398211499E+00
momentum_y measure 1
9.3030662189748634E-02
momentum_z measure 1
-1.4177153071145559E+01
