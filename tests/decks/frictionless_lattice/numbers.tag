steps count 1
1.0000000000000000E+02
contacts count 1
1.4800000000000000E+02
active_contacts count 1
1.0200000000000000E+02
sweeps effort 1
1.5640000000000000E+04
kinetic_energy measure 1
7.6655980692594198E+01
potential_energy measure 1
8.4356212382980266E+03
external_work measure 1
2.2312567800918322E-16
drive_work measure 1
0.0000000000000000E+00
friction_loss measure 1
0.0000000000000000E+00
impact_loss measure 1
1.6913835653482812E+02
energy_closure measure 1
1.5494698155516722E-14
mean_penetration measure 1
3.5054120100457770E-12
max_penetration measure 1
1.4009203519460556E-11
volume_error measure 1
9.4871060956544737E-17
compactness measure 1
8.0549107323427382E-01
coordination measure 1
3.1833333333333331E+00
coordination_without_rattlers measure 1
3.3148148148148149E+00
single_contacts count 1
1.0200000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.3826519808521701E-01
max_velocity measure 1
6.5096319086030274E-01
inertia_number measure 1
5.0279037846954297E-02
pressure measure 1
8.1674869935996485E+03
floor_share measure 1
8.9114219408094808E-01
rattlers count 1
6.0000000000000000E+00
stress_xx measure 1
3.9037272653532109E+03
stress_xy measure 1
1.1641884107377196E+02
stress_yx measure 1
1.1641884107377251E+02
stress_yy measure 1
1.2431246721846086E+04
shear_rate measure 1
6.4505453466855034E-01
momentum_x measure 1
2.3894887172283114E+02
momentum_y measure 1
-1.8095557514396273E+02
