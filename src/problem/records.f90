!> Layout of the compact records of contacts and bodies, by kind of problem (doc/theory/contact_problem.md).
!!
!! The kind of problem decides how long a record is and what stands where. *Round* problems have lever arms along the normals of
!! all bodies that turn (disks): the spin is carried as radius times spin, so that the radius drops out. *Arm* problems are
!! general. Frictionless problems have one impulse component and no tangent at all. *Ball* and *solid* problems are the same two
!! in space; their frictional impulses are vectors in the world's axes.
!!
!! The names below are positions, constants that the compiler folds: `record(arm_bias_n, k)` costs what `record(7, k)` does. Names
!! of frictionless kinds have that word; those without belong to the frictional kind. Positions of vectors are consecutive.
module sg_records
  use sg_kinds, only: wp
  use sg_plan, only: arm_bonded, arm_frictional, arm_frictionless, arm_rolling, ball_frictional, ball_frictionless, &
                     round_frictional, round_frictionless, solid_bonded, solid_frictional, solid_frictionless, solid_rolling, &
                     arm_mixed, solid_mixed
  implicit none
  private
  public :: round_frictionless, round_frictional, arm_frictionless, arm_frictional, arm_bonded
  public :: ball_frictionless, ball_frictional, solid_frictionless, solid_frictional, solid_bonded, arm_rolling, solid_rolling
  public :: arm_mixed, solid_mixed, bears_bonds, bond_shift
  public :: plain_kind, is_compact, is_in_space, has_moments, free_axes, force_length
  public :: record_length, body_length, impulse_length, first_inverse, active_place, bias_place, friction_place
  public :: normal_x, normal_y, normal_z, velocity_x, velocity_y, velocity_z
  public :: round_frictionless_bias, round_frictionless_inverse_wnn
  public :: round_bias_n, round_bias_t, round_inverse_wnn, round_inverse_wtt, round_friction
  public :: arm_frictionless_moment_c, arm_frictionless_moment_a, arm_frictionless_bias, arm_frictionless_inverse_wnn
  public :: arm_moment_nc, arm_moment_tc, arm_moment_na, arm_moment_ta, arm_bias_n, arm_bias_t, arm_wnn, arm_wnt, arm_wtt
  public :: arm_friction, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_law, least_active, least_linear, least_normal
  public :: arm_stiffness_n, arm_stiffness_t, arm_slip, arm_relief_nn, arm_relief_tn, arm_relief_nt, arm_relief_tt
  public :: arm_rolling_length, arm_wnm, arm_wtm, arm_wmm, arm_gyration, arm_inverse_norm
  public :: ball_frictionless_bias, ball_frictionless_inverse_wnn
  public :: ball_bias_x, ball_bias_y, ball_bias_z, ball_inverse_wnn, ball_inverse_wtt, ball_friction
  public :: solid_frictionless_moment_cx, solid_frictionless_moment_cy, solid_frictionless_moment_cz
  public :: solid_frictionless_moment_ax, solid_frictionless_moment_ay, solid_frictionless_moment_az
  public :: solid_frictionless_bias, solid_frictionless_inverse_wnn
  public :: solid_tangent_x, solid_tangent_y, solid_tangent_z, solid_arm_cx, solid_arm_cy, solid_arm_cz
  public :: solid_arm_ax, solid_arm_ay, solid_arm_az, solid_bias_x, solid_bias_y, solid_bias_z
  public :: solid_wnn, solid_wn1, solid_wn2, solid_s1, solid_s2, solid_friction, solid_cohesion
  public :: solid_compliance_n, solid_compliance_t, solid_law, solid_inverse_lambda
  public :: solid_stiffness_n, solid_stiffness_t, solid_slip_x, solid_slip_y, solid_slip_z
  public :: solid_relief_nn, solid_relief_1n, solid_relief_2n, solid_relief_n1, solid_relief_11, solid_relief_21, solid_relief_n2, &
            solid_relief_12, solid_relief_22
  public :: solid_rolling_length, solid_twisting_length, solid_gyration, solid_inverse_norm
  public :: solid_c11, solid_c21, solid_c31, solid_c12, solid_c22, solid_c32, solid_c13, solid_c23, solid_c33
  public :: solid_m11, solid_m21, solid_m31, solid_m22, solid_m32, solid_m33
  public :: round_frictionless_inverse_mx, round_frictionless_inverse_my
  public :: round_spin, round_inverse_mx, round_inverse_my, round_inverse_i
  public :: arm_spin, arm_inverse_mx, arm_inverse_my, arm_inverse_i
  public :: ball_frictionless_inverse_mx, ball_frictionless_inverse_my, ball_frictionless_inverse_mz
  public :: ball_spin_x, ball_spin_y, ball_spin_z, ball_inverse_m, ball_inverse_i
  public :: solid_spin_x, solid_spin_y, solid_spin_z, solid_inverse_mx, solid_inverse_my, solid_inverse_mz
  public :: solid_inverse_xx, solid_inverse_yy, solid_inverse_zz, solid_inverse_xy, solid_inverse_xz, solid_inverse_yz

  !> The kind without bonds and moments whose records those of a kind begin with, so that what both have is written once
  integer, parameter :: plain_kind(14) = [round_frictionless, round_frictional, arm_frictionless, arm_frictional, &
                                          ball_frictionless, ball_frictional, solid_frictionless, solid_frictional, &
                                          arm_frictional, solid_frictional, arm_frictional, solid_frictional, arm_frictional, &
                                          solid_frictional]

  !> Contacts of all kinds: unit normal, from antagonist to candidate; in the plane x and y alone
  integer, parameter :: normal_x = 1, normal_y = 2, normal_z = 3

  !> Contact, round without friction: bias [m/s], 1/W_nn [kg], zero where the contact takes no part
  integer, parameter :: round_frictionless_bias = 3, round_frictionless_inverse_wnn = 4

  !> Contact, round with friction: bias on n and t [m/s], 1/W_nn and 1/W_tt [kg], zero where the contact takes no part, and
  !! Coulomb's coefficient
  integer, parameter :: round_bias_n = 3, round_bias_t = 4, round_inverse_wnn = 5, round_inverse_wtt = 6, round_friction = 7

  !> Contact with any arms, without friction: moments of the unit normal about the centres of candidate and antagonist,
  !! arm x n [m]; bias, 1/W_nn as above
  integer, parameter :: arm_frictionless_moment_c = 3, arm_frictionless_moment_a = 4, arm_frictionless_bias = 5, &
                        arm_frictionless_inverse_wnn = 6

  !> Contact with any arms and any law: moments of n and t about both centres [m], bias [m/s], block of W [1/kg]
  integer, parameter :: arm_moment_nc = 3, arm_moment_tc = 4, arm_moment_na = 5, arm_moment_ta = 6, arm_bias_n = 7, &
                        arm_bias_t = 8, arm_wnn = 9, arm_wnt = 10, arm_wtt = 11

  !> The same contact: Coulomb's coefficient, cohesion [N s], compliance [1/kg] and kind of local law. That kind is 0 where the
  !! contact takes no part, 1 for a unilateral law, 2 for a linear one, 3 for one that is linear along the normal and carries
  !! nothing along tangents
  integer, parameter :: arm_friction = 12, arm_cohesion = 13, arm_compliance_n = 14, arm_compliance_t = 15, arm_law = 16
  !> Least kinds, halfway between two, of local laws that take part; that are linear; that are linear along the normal alone
  real(wp), parameter :: least_active = 0.5_wp, least_linear = 1.5_wp, least_normal = 2.5_wp

  !> The same contact with bonds: stiffness of the bond times the square of the step [kg], and its slip over the step [m/s]; the
  !! block is (W^-1 + K)^-1, with K those stiffnesses, and the relief (I + K W)^-1 is what the bond leaves of an impulse
  integer, parameter :: arm_stiffness_n = 17, arm_stiffness_t = 18, arm_slip = 19, arm_relief_nn = 20, arm_relief_tn = 21, &
                        arm_relief_nt = 22, arm_relief_tt = 23

  !> The same contact with a moment: largest moment over the normal impulse [m], what the moment adds to the block of W, length by
  !! which moments and spins are brought to the units of impulses and velocities [m], and 1/|W_aa| in those units [kg]; the
  !! lengths are zero where the contact resists no rolling
  integer, parameter :: arm_rolling_length = 17, arm_wnm = 18, arm_wtm = 19, arm_wmm = 20, arm_gyration = 21, arm_inverse_norm = 22

  !> Contact of balls without friction: as round
  integer, parameter :: ball_frictionless_bias = 4, ball_frictionless_inverse_wnn = 5

  !> Contact of balls with friction: as round, the bias in the world's axes
  integer, parameter :: ball_bias_x = 4, ball_bias_y = 5, ball_bias_z = 6, ball_inverse_wnn = 7, ball_inverse_wtt = 8, &
                        ball_friction = 9

  !> Contact of solids without friction: moments of the unit normal about both centres, arm x n [m]; bias, 1/W_nn
  integer, parameter :: solid_frictionless_moment_cx = 4, solid_frictionless_moment_cy = 5, solid_frictionless_moment_cz = 6, &
                        solid_frictionless_moment_ax = 7, solid_frictionless_moment_ay = 8, solid_frictionless_moment_az = 9, &
                        solid_frictionless_bias = 10, solid_frictionless_inverse_wnn = 11

  !> Contact of solids with any law: first tangent t (the second is n x t; zero for a law along the normal, so that kernels find
  !! no tangents), arms to candidate and antagonist [m], bias in the world's axes [m/s]
  integer, parameter :: solid_tangent_x = 4, solid_tangent_y = 5, solid_tangent_z = 6, solid_arm_cx = 7, solid_arm_cy = 8, &
                        solid_arm_cz = 9, solid_arm_ax = 10, solid_arm_ay = 11, solid_arm_az = 12, solid_bias_x = 13, &
                        solid_bias_y = 14, solid_bias_z = 15

  !> The same contact: W_nn, W_n1, W_n2, and the Schur complement of W_nn in W, diagonal on these tangents [1/kg]; friction,
  !! cohesion, compliance and kind of local law as above; 1/lambda_max(W) [kg]
  integer, parameter :: solid_wnn = 16, solid_wn1 = 17, solid_wn2 = 18, solid_s1 = 19, solid_s2 = 20, solid_friction = 21, &
                        solid_cohesion = 22, solid_compliance_n = 23, solid_compliance_t = 24, solid_law = 25, &
                        solid_inverse_lambda = 26

  !> The same contact with bonds: as in the plane, the slip a vector in the world's axes
  integer, parameter :: solid_stiffness_n = 27, solid_stiffness_t = 28, solid_slip_x = 29, solid_slip_y = 30, solid_slip_z = 31, &
                        solid_relief_nn = 32, solid_relief_1n = 33, solid_relief_2n = 34, solid_relief_n1 = 35, &
                        solid_relief_11 = 36, solid_relief_21 = 37, solid_relief_n2 = 38, solid_relief_12 = 39, solid_relief_22 = 40

  !> The same contact with a moment: largest moments over the normal impulse, of rolling and of twisting [m], then as in the plane
  integer, parameter :: solid_rolling_length = 27, solid_twisting_length = 28, solid_gyration = 29, solid_inverse_norm = 30
  !> The same contact: blocks of W that moments add, rows of the first those of impulses along n, t, n x t; columns, and rows of the
  !! second, moments about t, n x t, n
  integer, parameter :: solid_c11 = 31, solid_c21 = 32, solid_c31 = 33, solid_c12 = 34, solid_c22 = 35, solid_c32 = 36, &
                        solid_c13 = 37, solid_c23 = 38, solid_c33 = 39, solid_m11 = 40, solid_m21 = 41, solid_m31 = 42, &
                        solid_m22 = 43, solid_m32 = 44, solid_m33 = 45

  !> Bodies of all kinds: velocity of the centre [m/s]; in the plane x and y alone
  integer, parameter :: velocity_x = 1, velocity_y = 2, velocity_z = 3

  !> Body, round without friction: inverse masses along x and y [1/kg], zero where driven
  integer, parameter :: round_frictionless_inverse_mx = 3, round_frictionless_inverse_my = 4

  !> Body, round with friction: R spin [m/s], inverse masses, R^2/I [1/kg]
  integer, parameter :: round_spin = 3, round_inverse_mx = 4, round_inverse_my = 5, round_inverse_i = 6

  !> Body with any arms: spin [rad/s], inverse masses, 1/I [1/(kg m^2)]
  integer, parameter :: arm_spin = 3, arm_inverse_mx = 4, arm_inverse_my = 5, arm_inverse_i = 6

  !> Ball without friction: inverse masses along x, y and z
  integer, parameter :: ball_frictionless_inverse_mx = 4, ball_frictionless_inverse_my = 5, ball_frictionless_inverse_mz = 6

  !> Ball with friction: R spin in the world's axes, one inverse mass for all directions, so that the record fills a cache line,
  !! and R^2/I. Of a body that does not turn and is driven in some directions only, -1, -2 and -4 in place of R^2/I mark x, y and
  !! z as free
  integer, parameter :: ball_spin_x = 4, ball_spin_y = 5, ball_spin_z = 6, ball_inverse_m = 7, ball_inverse_i = 8

  !> Solid: spin in the world's axes, inverse masses, inverse inertia in the world's axes; one real more fills two cache lines
  integer, parameter :: solid_spin_x = 4, solid_spin_y = 5, solid_spin_z = 6, solid_inverse_mx = 7, solid_inverse_my = 8, &
                        solid_inverse_mz = 9, solid_inverse_xx = 10, solid_inverse_yy = 11, solid_inverse_zz = 12, &
                        solid_inverse_xy = 13, solid_inverse_xz = 14, solid_inverse_yz = 15

  !> Reals of a contact's record, by kind
  integer, parameter :: record_length(14) = [round_frictionless_inverse_wnn, round_friction, arm_frictionless_inverse_wnn, &
                                             arm_law, ball_frictionless_inverse_wnn, ball_friction, &
                                             solid_frictionless_inverse_wnn, solid_inverse_lambda, arm_relief_tt, solid_relief_22, &
                                             arm_inverse_norm, solid_m33, arm_relief_tt + 6, solid_relief_22 + 19]

  !> Reals of a body's record, by kind: velocities, then inverse masses
  integer, parameter :: body_length(14) = [round_frictionless_inverse_my, round_inverse_i, arm_inverse_i, arm_inverse_i, &
                                           ball_frictionless_inverse_mz, ball_inverse_i, solid_inverse_yz + 1, &
                                           solid_inverse_yz + 1, arm_inverse_i, solid_inverse_yz + 1, arm_inverse_i, &
                                           solid_inverse_yz + 1, arm_inverse_i, solid_inverse_yz + 1]

  !> Impulse components, by kind, moments behind forces; and those of forces alone
  integer, parameter :: impulse_length(14) = [1, 2, 1, 2, 1, 3, 1, 3, 2, 3, 3, 6, 3, 6], &
                        force_length(14) = [1, 2, 1, 2, 1, 3, 1, 3, 2, 3, 2, 3, 2, 3]

  !> Where the inverse masses begin in a body's record, by kind
  integer, parameter :: first_inverse(14) = [round_frictionless_inverse_mx, round_inverse_mx, arm_inverse_mx, arm_inverse_mx, &
                                             ball_frictionless_inverse_mx, ball_inverse_m, solid_inverse_mx, solid_inverse_mx, &
                                             arm_inverse_mx, solid_inverse_mx, arm_inverse_mx, solid_inverse_mx, &
                                             arm_inverse_mx, solid_inverse_mx]

  !> Where a value stands that is positive if and only if the contact takes part, by kind
  integer, parameter :: active_place(14) = [round_frictionless_inverse_wnn, round_inverse_wnn, arm_frictionless_inverse_wnn, &
                                            arm_law, ball_frictionless_inverse_wnn, ball_inverse_wnn, &
                                            solid_frictionless_inverse_wnn, solid_law, arm_law, solid_law, arm_law, &
                                            solid_law, arm_law, solid_law]

  !> Where the bias begins, by kind: as many reals as the force has, in the same axes
  integer, parameter :: bias_place(14) = [round_frictionless_bias, round_bias_n, arm_frictionless_bias, arm_bias_n, &
                                          ball_frictionless_bias, ball_bias_x, solid_frictionless_bias, solid_bias_x, &
                                          arm_bias_n, solid_bias_x, arm_bias_n, solid_bias_x, arm_bias_n, solid_bias_x]

  !> Where Coulomb's coefficient stands, by kind; 0 where there is none
  integer, parameter :: friction_place(14) = [0, round_friction, 0, arm_friction, 0, ball_friction, 0, solid_friction, &
                                              arm_friction, solid_friction, arm_friction, solid_friction, arm_friction, &
                                              solid_friction]

  !> By how much the values of bonds stand behind the places named above, by kind: where contacts bear moments too, those come first
  integer, parameter :: bond_shift(14) = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, arm_inverse_norm - arm_law, &
                                          solid_m33 - solid_inverse_lambda]

contains

  !> Do contacts of a kind of problem hold bonds?
  pure logical function bears_bonds(kind)
    integer, intent(in) :: kind !! kind of problem

    bears_bonds = any(kind == [arm_bonded, solid_bonded, arm_mixed, solid_mixed])
  end function bears_bonds

  !> Does a kind of problem carry no lever arms?
  pure logical function is_compact(kind)
    integer, intent(in) :: kind !! kind of problem

    is_compact = any(kind == [round_frictionless, round_frictional, ball_frictionless, ball_frictional])
  end function is_compact

  !> Is a kind of problem one in space?
  pure logical function is_in_space(kind)
    integer, intent(in) :: kind !! kind of problem

    is_in_space = kind >= ball_frictionless .and. .not. any(kind == [arm_bonded, arm_rolling, arm_mixed])
  end function is_in_space

  !> Do contacts of a kind of problem bear moments?
  pure logical function has_moments(kind)
    integer, intent(in) :: kind !! kind of problem

    has_moments = any(kind == [arm_rolling, solid_rolling, arm_mixed, solid_mixed])
  end function has_moments

  !> Directions in which impulses can move a body of a ball problem: 1 for free, 0 for driven.
  pure function free_axes(mark) result(axes)
    real(wp), intent(in) :: mark !! last real of its record: R^2/I, or marks of free directions
    real(wp) :: axes(3)
    integer :: bits

    axes = 1
    if (mark >= 0) return
    bits = -nint(mark)
    axes = real(ibits(bits, [0, 1, 2], 1), wp)
  end function free_axes
end module sg_records
