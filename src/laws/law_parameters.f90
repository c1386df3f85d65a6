!> Parameters of contact laws by name: the keys of decks, and the labels of LMGC90's files.
!!
!! Both names of each parameter stand in one list, `visit_all`; readers and writers follow from it.
module sg_law_parameters
  use sg_kinds, only: wp
  use sg_laws, only: law_mohr, law_t
  implicit none
  private
  public :: set_parameter, get_parameter

  !> A parameter that is looked for: by its key or its label, which never coincide
  type :: wanted_t
    character(len=24) :: name = ''
    !> Its value, and whether this replaces that of the law
    real(wp) :: value = 0
    logical :: is_set = .false.
  end type wanted_t

contains

  !> Set the parameter of a law that has this key or label; none where no parameter has.
  pure subroutine set_parameter(law, name, value)
    type(law_t), intent(inout) :: law !! law to complete, of a known kind
    character(len=*), intent(in) :: name !! key of decks, or label of LMGC90
    real(wp), intent(in) :: value !! its value, SI unit
    type(wanted_t) :: wanted

    wanted = wanted_t(name, value, is_set=.true.)
    call visit_all(law, wanted)
  end subroutine set_parameter

  !> The parameter of a law that has this key or label; zero where no parameter has.
  pure real(wp) function get_parameter(law, name) result(value)
    type(law_t), intent(in) :: law !! law to look into
    character(len=*), intent(in) :: name !! key of decks, or label of LMGC90
    type(law_t) :: copy
    type(wanted_t) :: wanted

    copy = law
    wanted = wanted_t(name)
    call visit_all(copy, wanted)
    value = wanted%value
  end function get_parameter

  !> THE list: key, label and component of each parameter. A name may stand for two components; reading takes the last one.
  pure subroutine visit_all(law, wanted)
    type(law_t), intent(inout) :: law
    type(wanted_t), intent(inout) :: wanted

    call visit(wanted, 'friction', 'fric', law%dynamic_friction)
    call visit(wanted, 'friction', 'fric', law%static_friction)
    call visit(wanted, 'dynamic_friction', 'dyfr', law%dynamic_friction)
    call visit(wanted, 'static_friction', 'stfr', law%static_friction)
    call visit(wanted, 'rolling_friction', '-', law%rolling_friction)
    call visit(wanted, 'rolling_length', '-', law%rolling_length)
    call visit(wanted, 'twisting_friction', '-', law%twisting_friction)
    call visit(wanted, 'twisting_length', '-', law%twisting_length)
    call visit(wanted, 'normal_restitution', 'rstn', law%normal_restitution)
    call visit(wanted, 'tangential_restitution', 'rstt', law%tangential_restitution)
    ! LMGC90's cohesions of Mohr-Coulomb bonds are stresses.
    call visit(wanted, 'normal_cohesion', merge('-   ', 'cohn', law%kind == law_mohr), law%normal_cohesion)
    call visit(wanted, 'tangential_cohesion', merge('-   ', 'coht', law%kind == law_mohr), law%tangential_cohesion)
    call visit(wanted, 'normal_bond_stress', merge('cohn', '-   ', law%kind == law_mohr), law%normal_strength)
    call visit(wanted, 'tangential_bond_stress', merge('coht', '-   ', law%kind == law_mohr), law%tangential_strength)
    call visit(wanted, 'wet_thickness', 'Wthk', law%wet_thickness)
    call visit(wanted, 'stiffness', 'F/gp', law%stiffness)
    call visit(wanted, 'viscosity', 'etan', law%viscosity)
    call visit(wanted, 'gap_shift', 'pgap', law%gap_shift)
    call visit(wanted, 'epsilon', '-', law%epsilon)
    call visit(wanted, 'relative_epsilon', '-', law%relative_epsilon)
    call visit(wanted, 'axial_stiffness', 'F/st', law%axial_stiffness)
    call visit(wanted, 'axial_damping', 'F/sr', law%axial_damping)
    call visit(wanted, 'prestrain', 'prst', law%prestrain)
    call visit(wanted, 'breaking_force', 'Snmx', law%breaking_force)
    call visit(wanted, 'young', 'E', law%young)
    call visit(wanted, 'poisson', 'nu', law%poisson)
    call visit(wanted, 'normal_strength', 's1', law%normal_strength)
    call visit(wanted, 'tangential_strength', 's2', law%tangential_strength)
    call visit(wanted, 'normal_stiffness', 'cn', law%zone_stiffness(1))
    call visit(wanted, 'tangential_stiffness', 'ct', law%zone_stiffness(2))
    call visit(wanted, 'adhesion_energy', 'dupr', law%zone_energy(1))
    call visit(wanted, 'damage_viscosity', 'visc', law%zone_viscosity)
    call visit(wanted, 'normal_energy', 'G1', law%zone_energy(1))
    call visit(wanted, 'tangential_energy', 'G2', law%zone_energy(2))
    call visit(wanted, 'normal_plateau', 'dp1', law%zone_plateau(1))
    call visit(wanted, 'tangential_plateau', 'dp2', law%zone_plateau(2))
    call visit(wanted, 'normal_opening', 'du1', law%zone_opening(1))
    call visit(wanted, 'tangential_opening', 'du2', law%zone_opening(2))
    call visit(wanted, 'knee_share', 'phi', law%zone_share)
    call visit(wanted, 'cut_off', 'eta', law%zone_residual)
  end subroutine visit_all

  !> Set or get one parameter, where it is the one that is looked for.
  pure subroutine visit(wanted, key, label, component)
    type(wanted_t), intent(inout) :: wanted
    character(len=*), intent(in) :: key, label !! its names; a dash where it has no label
    real(wp), intent(inout) :: component !! of the law

    if (wanted%name /= key .and. wanted%name /= label) return
    if (wanted%is_set) component = wanted%value
    wanted%value = component
  end subroutine visit
end module sg_law_parameters
