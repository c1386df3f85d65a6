!> Contact laws of LMGC90 that are refused, each with its reason.
module sg_datbox_refused
  use sg_datbox_laws, only: law_forms
  implicit none
  private
  public :: reason_of

  !> Cohesive zones that only pairs of deformable bodies have, up to `_CZM`
  character(len=4), parameter :: deformable(*) = [character(len=4) :: 'MAC', 'MSMP', 'MP', 'MP3', 'TH', 'MAL', 'ABP', 'EXPO', &
                                                  'GTN', 'GTN2', 'TOSI']

contains

  !> Why a law is refused, and what to use in its place, as the end of a sentence; empty where there is no reason to give.
  pure function reason_of(law) result(reason)
    character(len=*), intent(in) :: law !! LMGC90's name
    character(len=:), allocatable :: reason

    reason = ''
    if (index(law, '_CZM') > 0) then
      reason = reason_of_zone(law)
      return
    end if
    select case (law)
    case ('MD_JKRs')
      reason = ': it is for smooth integrators, and the NLGS of LMGC90 itself takes its friction alone and stops bodies at the '// &
               'alert distance; use IQS_CLB, or ELASTIC_REPELL_CLB with the stiffness'
    case ('ELASTIC_REPELL_CLB_adapt')
      reason = ': it needs a stiffness per contact that a script of LMGC90 changes during the run, and a folder holds no '// &
               'script; use ELASTIC_REPELL_CLB, which is the same where the stiffness stays'
    case ('ELASTIC_REPELL_WET_CLB', 'VISCO_ELASTIC_REPELL_WET')
      reason = ': no law here has both a compliance in compression and an attraction at a distance; use '// &
               law(:index(law, '_WET'))//'CLB without the attraction, or IQS_WET_DS_CLB without the compliance'
    end select
  end function reason_of

  !> Why a cohesive zone is refused.
  pure function reason_of_zone(law) result(reason)
    character(len=*), intent(in) :: law
    character(len=:), allocatable :: reason

    reason = ''
    if (any(deformable == law(:index(law, '_CZM') - 1))) then
      reason = ': zones without IQS_ are for pairs of deformable bodies, and LMGC90 stops where rigid bodies meet by one'
      if (any(law_forms%name == 'IQS_'//law)) reason = reason//'; use IQS_'//law
    else if (index(law, '_SPRING') > 0) then
      reason = ': its springs in series with the zone yield to compression without bound, which is for pairs of deformable '// &
               'bodies: rigid ones would pass into each other; use IQS_EXPO_CZM'
    end if
  end function reason_of_zone
end module sg_datbox_refused
