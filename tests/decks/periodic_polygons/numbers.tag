steps count 1
1.0000000000000000E+02
contacts count 1
2.7000000000000000E+01
active_contacts count 1
1.7000000000000000E+01
sweeps effort 1
1.7400000000000000E+03
kinetic_energy measure 1
4.1978516993534640E+01
potential_energy measure 1
2.2135317635866562E+02
external_work measure 1
3.2057993044649501E-16
drive_work measure 1
1.8407316753639380E-02
friction_loss measure 1
1.2615943212119227E+00
impact_loss measure 1
2.0535379768913835E+01
energy_closure measure 1
8.9617753959517902E-16
mean_penetration measure 1
3.1259254896912090E-06
max_penetration measure 1
9.3774895497138282E-06
volume_error measure 1
1.9251540016178798E-09
compactness measure 1
4.8313756913233918E-01
coordination measure 1
7.5000000000000000E-01
coordination_without_rattlers measure 1
1.2857142857142858E+00
single_contacts count 1
1.1000000000000000E+01
double_contacts count 1
3.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
5.0778241236218935E-01
max_velocity measure 1
9.8099999999999909E-01
inertia_number measure 1
3.6878959206998785E-01
pressure measure 1
1.1923066712536317E+03
floor_share measure 1
1.5210593761196407E+00
rattlers count 1
2.1000000000000000E+01
stress_xx measure 1
1.7446550025528783E+01
stress_xy measure 1
-2.0482761088870532E+02
stress_yx measure 1
-1.7812250767757527E+02
stress_yy measure 1
2.3671667924817348E+03
shear_rate measure 1
4.8245386124219376E+00
momentum_x measure 1
1.8407316753637151E-01
momentum_y measure 1
-9.0499334383382561E+01
