!> Moments that resist rolling and twisting: in which stages of a run, and with methods that have no place for them.
module sg_rolling_checks
  use sg_blocks, only: block_t, deck_t
  use sg_error, only: diagnostics_t
  use sg_laws, only: resists_rolling
  use sg_methods, only: is_swept
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  implicit none
  private
  public :: check_rolling, rolling_keys, stages_bear_moments

  !> Keys of such moments
  character(len=17), parameter :: rolling_keys(4) = [character(len=17) :: 'rolling_friction', 'rolling_length', &
                                                     'twisting_friction', 'twisting_length']

contains

  !> Does any stage of a deck give its laws moments? One of them makes all stages have moments: they share a record and checkpoints.
  pure logical function stages_bear_moments(deck) result(bear)
    type(deck_t), intent(in) :: deck !! checked deck with its stages
    integer :: b

    bear = .false.
    do b = 1, deck%n
      if (deck%is_in(b, 'law')) bear = bear .or. gives_moments(deck, deck%blocks(b))
    end do
    do b = 1, size(deck%changes)
      bear = bear .or. gives_moments(deck, deck%changes(b))
    end do
  end function stages_bear_moments

  !> Does a block have a coefficient or a length of moments that is not zero?
  pure logical function gives_moments(deck, block)
    type(deck_t), intent(in) :: deck
    type(block_t), intent(in) :: block
    integer :: i

    gives_moments = .false.
    do i = 1, block%n
      if (.not. any(rolling_keys == deck%table%keys(block%values(i)%key)%name)) cycle
      gives_moments = gives_moments .or. maxval(block%values(i)%numbers) > 0
    end do
  end function gives_moments

  !> Report that solvers of matrices leave moments to sweeps; refuse moments with them on several ranks, and with the coupling that
  !! takes matrices of subdomains.
  subroutine check_rolling(deck, options, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(run_options_t), intent(in) :: options !! options read from it
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=:), allocatable :: sentence

    if (.not. (any(resists_rolling(scene%laws)) .or. scene%bears_moments)) return
    if (.not. is_swept(options%solver%method)) then
      sentence = 'solver "'//trim(options%solver%method)//'" works on matrices, which have no place for moments against '// &
                 'rolling or twisting'
      if (deck%ranks > 1) then
        call deck%complain(diagnostics, sentence//'; use method = "nlgs" or "nesterov"', deck%block_of('solver'), 'method')
      else
        call deck%warn(diagnostics, sentence//': steps with such contacts are solved by sweeps, as with method = "nlgs"', &
                       deck%block_of('solver'), 'method', kind='matrices without moments')
      end if
    end if
    if (deck%ranks > 1 .and. options%partition%gluing == 'enriched') &
      call deck%complain(diagnostics, 'the coupling "enriched" takes matrices, which have no place for moments against rolling '// &
                         'or twisting; use gluing = "dual", "primal" or "momentum"', deck%block_of('partition'), 'gluing')
  end subroutine check_rolling
end module sg_rolling_checks
