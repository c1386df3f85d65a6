!> Moments that resist rolling and twisting, in scenes and with methods that have no place for them.
module sg_rolling_checks
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_laws, only: is_cohesive_zone, resists_rolling
  use sg_methods, only: is_swept
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  implicit none
  private
  public :: check_rolling, rolling_keys

  !> Keys of such moments
  character(len=17), parameter :: rolling_keys(4) = [character(len=17) :: 'rolling_friction', 'rolling_length', &
                                                     'twisting_friction', 'twisting_length']

contains

  !> Refuse moments next to cohesive zones, with solvers of matrices, and with the coupling that takes matrices of subdomains.
  subroutine check_rolling(deck, options, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(run_options_t), intent(in) :: options !! options read from it
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: b, i

    if (.not. any(resists_rolling(scene%laws))) return
    if (any([(is_cohesive_zone(scene%laws(i)), i=1, size(scene%laws))])) then
      do b = 1, deck%n
        if (.not. deck%is_in(b, 'law')) cycle
        do i = 1, size(rolling_keys)
          if (.not. deck%is_given(b, trim(rolling_keys(i)))) cycle
          call deck%complain(diagnostics, 'moments against rolling or twisting cannot act in a scene with cohesive zones', b, &
                             trim(rolling_keys(i)))
          return
        end do
      end do
    end if
    if (.not. is_swept(options%solver%method)) then
      call deck%complain(diagnostics, 'solver "'//trim(options%solver%method)//'" works on matrices, which have no place for '// &
                         'moments against rolling or twisting; use method = "nlgs" or "nesterov"', deck%block_of('solver'), &
                         'method')
    end if
    if (deck%ranks > 1 .and. options%partition%gluing == 'enriched') &
      call deck%complain(diagnostics, 'the coupling "enriched" takes matrices, which have no place for moments against rolling '// &
                         'or twisting; use gluing = "dual", "primal" or "momentum"', deck%block_of('partition'), 'gluing')
  end subroutine check_rolling
end module sg_rolling_checks
