steps count 1
1.0000000000000000E+02
contacts count 1
1.1220000000000000E+03
active_contacts count 1
5.3600000000000000E+02
sweeps effort 1
1.0834000000000000E+05
kinetic_energy measure 1
3.3323817911406206E-01
potential_energy measure 1
3.2037169051951424E+00
external_work measure 1
4.2906395367890440E+00
drive_work measure 1
1.2497287232003635E+00
friction_loss measure 1
2.4804119006563488E+00
impact_loss measure 1
4.3030724181349225E+00
energy_closure measure 1
1.3209961008614773E-14
mean_penetration measure 1
1.2983476588669284E-11
max_penetration measure 1
2.1272677543093810E-10
volume_error measure 1
2.0986029475694641E-18
compactness measure 1
5.4250323532794065E-01
coordination measure 1
3.7259259259259259E+00
coordination_without_rattlers measure 1
3.9268292682926829E+00
single_contacts count 1
5.3600000000000000E+02
double_contacts count 1
0.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
1.4053734401849799E-01
max_velocity measure 1
3.0445129285749040E-01
inertia_number measure 1
1.6014566199195918E-02
pressure measure 1
4.7340069967827176E+03
floor_share measure 1
8.7791580364648369E-01
rattlers count 1
2.4000000000000000E+01
quadruple_contacts count 1
0.0000000000000000E+00
stress_xx measure 1
3.3289900216420492E+03
stress_xy measure 1
2.9430027019631649E+02
stress_xz measure 1
-1.2037897302402114E+03
stress_yx measure 1
2.9514702111523059E+02
stress_yy measure 1
4.1311844159814673E+03
stress_yz measure 1
-2.5655141111120736E+02
stress_zx measure 1
-1.1977154236747865E+03
stress_zy measure 1
-2.4839332863211629E+02
stress_zz measure 1
6.7418465527246371E+03
shear_rate measure 1
6.9256292576053391E-01
momentum_x measure 1
8.7045070700324412E-01
momentum_y measure 1
-4.2046517578748208E-02
momentum_z measure 1
1.4166719937665278E-02
