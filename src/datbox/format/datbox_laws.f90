!> The contact laws of LMGC90 that have a twin here: name, kind, and the layout of their numbers.
!!
!! One table serves the reader and the writer of TACT_BEHAV.DAT.
module sg_datbox_laws
  use sg_laws, only: law_abp, law_bond, law_elastic, law_elastic_g0, law_expo, law_gap, law_gap_g0, law_gap_shifted, law_iqs, &
                     law_iqs_g0, law_linear, law_mac, law_mal, law_mohr, law_restitution, law_rigid_wire, law_rod, law_t, law_th, &
                     law_velocity, law_viscoelastic, law_wet, law_wire, resists_rolling
  implicit none
  private
  public :: law_forms, labels_of, form_of_name, form_of_law, why_no_form

  !> How LMGC90 writes one law
  type :: law_form_t
    !> Its name there
    character(len=24) :: name
    !> Our kind
    integer :: kind
    !> Labels of the numbers, at most two of four letters a line; blank lines are not there
    character(len=9) :: labels(3)
    !> Labels of further lines, of laws that take more
    character(len=9) :: more(3) = ''
  end type law_form_t

  !> All laws that can be read; of two forms of one kind the first is written where it can hold the law
  type(law_form_t), parameter :: law_forms(*) = [ &
    law_form_t('IQS_CLB', law_iqs, ['fric     ', '         ', '         ']), &
    law_form_t('IQS_DS_CLB', law_iqs, ['dyfr stfr', '         ', '         ']), &
    law_form_t('GAP_SGR_CLB', law_gap, ['fric     ', '         ', '         ']), &
    law_form_t('GAP_SGR_DS_CLB', law_gap, ['dyfr stfr', '         ', '         ']), &
    law_form_t('VEL_SGR_CLB', law_velocity, ['fric     ', '         ', '         ']), &
    law_form_t('VEL_SGR_DS_CLB', law_velocity, ['dyfr stfr', '         ', '         ']), &
    law_form_t('RST_CLB', law_restitution, ['rstn rstt', 'fric     ', '         ']), &
    law_form_t('RST_DS_CLB', law_restitution, ['rstn rstt', 'dyfr stfr', '         ']), &
    law_form_t('IQS_WET_DS_CLB', law_wet, ['cohn coht', 'Wthk     ', 'dyfr stfr']), &
    law_form_t('IQS_WET_DS_CLB', law_wet, ['cohn Wthk', 'dyfr stfr', '         ']), &
    law_form_t('IQS_MOHR_DS_CLB', law_mohr, ['cohn coht', 'dyfr stfr', '         ']), &
    law_form_t('ELASTIC_REPELL_CLB', law_elastic, ['F/gp     ', 'fric     ', '         ']), &
    law_form_t('IQS_CLB_g0', law_iqs_g0, ['fric     ', '         ', '         ']), &
    law_form_t('GAP_SGR_CLB_g0', law_gap_g0, ['fric     ', '         ', '         ']), &
    law_form_t('ELASTIC_REPELL_CLB_g0', law_elastic_g0, ['F/gp     ', 'fric     ', '         ']), &
    law_form_t('preGAP_SGR_CLB', law_gap_shifted, ['pgap fric', '         ', '         ']), &
    law_form_t('VISCO_ELASTIC_REPELL_CLB', law_viscoelastic, ['F/gp etan', 'fric     ', '         ']), &
    law_form_t('ELASTIC_ROD', law_rod, ['F/st prst', '         ', '         ']), &
    law_form_t('VOIGT_ROD', law_rod, ['F/st prst', 'F/sr     ', '         ']), &
    law_form_t('ELASTIC_WIRE', law_wire, ['F/st prst', '         ', '         ']), &
    law_form_t('VOIGT_WIRE', law_wire, ['F/st prst', 'F/sr     ', '         ']), &
    law_form_t('BRITTLE_ELASTIC_WIRE', law_wire, ['F/st prst', 'Snmx     ', '         ']), &
    law_form_t('RIGID_WIRE', law_rigid_wire, ['         ', '         ', '         ']), &
    law_form_t('NARD_ROD', law_bond, ['E    nu  ', 's1   s2  ', '         ']), &
    law_form_t('IQS_MAC_CZM', law_mac, ['dyfr stfr', 'cn   ct  ', 'visc dupr']), &
    law_form_t('IQS_MAL_CZM', law_mal, ['dyfr stfr', 'cn   ct  ', 's1   s2  '], ['G1   G2  ', '         ', '         ']), &
    law_form_t('IQS_TH_CZM', law_th, ['dyfr stfr', 'cn   ct  ', 's1   s2  '], ['G1   G2  ', 'dp1  dp2 ', '         ']), &
    law_form_t('IQS_ABP_CZM', law_abp, ['dyfr stfr', 'cn   ct  ', 's1   s2  '], ['G1   G2  ', 'du1  du2 ', 'phi      ']), &
    law_form_t('IQS_EXPO_CZM', law_expo, ['dyfr stfr', 'cn   ct  ', 's1   s2  '], ['G1   G2  ', 'eta      ', '         ']), &
    law_form_t('COUPLED_DOF', law_linear, ['         ', '         ', '         '])]

contains

  !> Labels of the numbers of a law, line by line; blank lines at the end are not there.
  pure function labels_of(form) result(labels)
    integer, intent(in) :: form !! index into `law_forms`
    character(len=9) :: labels(6)

    labels = [law_forms(form)%labels, law_forms(form)%more]
  end function labels_of

  !> Form of a law called by name, among several the longest that these lines fill; 0 when there is none.
  pure integer function form_of_name(name, n_lines) result(form)
    character(len=*), intent(in) :: name !! LMGC90's name
    integer, intent(in) :: n_lines !! lines of numbers found
    integer :: i, most, n

    form = 0
    most = 0
    do i = 1, size(law_forms)
      if (law_forms(i)%name /= name) cycle
      n = max(1, count(labels_of(i) /= ''))
      if (form > 0 .and. (n > n_lines .or. n <= most)) cycle
      form = i
      if (n <= n_lines) most = n
    end do
  end function form_of_name

  !> Form that can hold a law; 0 when there is none.
  pure integer function form_of_law(law) result(form)
    type(law_t), intent(in) :: law !! law to write
    logical :: has_one_friction

    has_one_friction = .not. abs(law%static_friction - law%dynamic_friction) > 0
    do form = 1, size(law_forms)
      if (law_forms(form)%kind /= law%kind .or. resists_rolling(law)) cycle
      ! COUPLED_DOF is the linear law whose compliance vanishes.
      if (law%kind == law_linear .and. (max(law%epsilon, law%relative_epsilon) > 0 .or. law%is_along_normal)) cycle
      if (law%axial_damping > 0 .and. .not. any(law_forms(form)%labels == 'F/sr')) cycle
      if (law%breaking_force > 0 .and. .not. any(law_forms(form)%labels == 'Snmx')) cycle
      ! There the cohesions of a bond are stresses.
      if (law%kind == law_mohr .and. max(law%normal_cohesion, law%tangential_cohesion) > 0) cycle
      if (has_one_friction .or. .not. any(index(law_forms(form)%labels, 'fric') > 0)) return
    end do
    form = 0
  end function form_of_law

  !> Why a law has no form, as the end of a sentence; empty where LMGC90 has no such kind.
  pure function why_no_form(law) result(reason)
    type(law_t), intent(in) :: law !! law without a form
    character(len=:), allocatable :: reason

    reason = ''
    if (resists_rolling(law)) then
      reason = ': none resists rolling or twisting there'
    else if (law%kind == law_linear) then
      reason = ': of linear laws only those with epsilon = 0 have one, COUPLED_DOF'
    else if (law%kind == law_mohr .and. max(law%normal_cohesion, law%tangential_cohesion) > 0) then
      reason = ': there its cohesions are stresses, here normal_bond_stress and tangential_bond_stress'
    else if (law%axial_damping > 0 .and. law%breaking_force > 0) then
      reason = ': no wire has both damping and a breaking force there'
    else if (abs(law%static_friction - law%dynamic_friction) > 0) then
      reason = ': it has one coefficient of friction there'
    end if
  end function why_no_form
end module sg_datbox_laws
