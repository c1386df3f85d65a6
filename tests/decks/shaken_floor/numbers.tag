steps count 1
4.0000000000000000E+02
contacts count 1
6.0000000000000000E+00
active_contacts count 1
6.0000000000000000E+00
sweeps effort 1
1.1870000000000000E+04
kinetic_energy measure 1
4.3940684061496647E+01
potential_energy measure 1
-1.7881466808889527E+02
external_work measure 1
-4.5790680335516397E-27
drive_work measure 1
5.8411953644020635E+01
friction_loss measure 1
1.4471269582512615E+01
impact_loss measure 1
9.4251453449872738E-11
energy_closure measure 1
9.9903667305315081E-16
mean_penetration measure 1
6.7820193905261552E-14
max_penetration measure 1
1.4995782393608143E-13
volume_error measure 1
6.3677706053895193E-13
compactness measure 1
4.6964038425863536E-01
coordination measure 1
1.5000000000000000E+00
coordination_without_rattlers measure 1
1.5000000000000000E+00
single_contacts count 1
2.0000000000000000E+00
double_contacts count 1
2.0000000000000000E+00
triple_contacts count 1
0.0000000000000000E+00
mean_velocity measure 1
7.1715059371515621E-02
max_velocity measure 1
1.3333333333333350E-01
inertia_number measure 1
8.5894038238658446E-02
pressure measure 1
5.6565380590511359E+02
floor_share measure 1
9.9999999996019495E-01
rattlers count 1
2.0000000000000000E+00
stress_xx measure 1
1.2054525351946303E+02
stress_xy measure 1
3.0980649944193050E+02
stress_yx measure 1
3.0047107661202398E+02
stress_yy measure 1
1.0107623582907642E+03
shear_rate measure 1
4.0023491525590521E-01
momentum_x measure 1
7.6625300617972067E+00
momentum_y measure 1
-5.8554322674965783E-10
fabric_xx measure 1
1.0517824398900881E-24
fabric_xy measure 1
9.4431076714754242E-13
fabric_yy measure 1
1.0000000000000000E+00
mobilised_friction measure 1
3.1651210662230317E-01
sliding_share measure 1
3.3333333333333331E-01
grain_coordination measure 1
1.0000000000000000E+00
wall_coordination measure 1
5.0000000000000000E-01
coordination_disk measure 1
1.0000000000000000E+00
coordination_polygon measure 1
2.0000000000000000E+00
