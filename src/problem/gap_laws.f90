!> Scenes whose contact laws look at gaps alone, which assembly and updates of a problem serve in one pass over the contacts.
module sg_gap_laws
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp, i4
  use sg_laws, only: looks_at_gap
  use sg_plan, only: plan_t
  use sg_records, only: arm_frictional, ball_frictional, is_compact, round_frictional, solid_frictional
  use sg_scene, only: scene_t
  implicit none
  private
  public :: has_driven_spin, have_gap_laws, laws_look_at_gaps

contains

  !> Do all contacts of a scene with friction have laws that look at the gap alone, with no driven spin and no motion of a periodic
  !! cell that enter as a bias?
  pure logical function have_gap_laws(scene, plan, drives_spin)
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(plan_t), intent(in) :: plan !! kind of problem
    logical, intent(in) :: drives_spin !! has a body a driven spin (`has_driven_spin` with its free velocities)?

    have_gap_laws = any(plan%kind == [round_frictional, arm_frictional, ball_frictional, solid_frictional]) .and. &
                    laws_look_at_gaps(scene) .and. .not. scene%cell%is_on
    if (is_compact(plan%kind)) have_gap_laws = have_gap_laws .and. .not. drives_spin
  end function have_gap_laws

  !> Do all laws of a scene look at the gap alone, and at nothing that a solve before has left? There are no links then.
  pure logical function laws_look_at_gaps(scene)
    type(scene_t), intent(in) :: scene !! scene with its laws

    laws_look_at_gaps = scene%links%n == 0 .and. all(looks_at_gap(scene%laws))
  end function laws_look_at_gaps

  !> Is a component of the spin of a body driven, and the spin not zero? Records of round shapes do not carry it.
  pure logical function has_driven_spin(bodies, velocity, among) result(is_driven)
    type(bodies_t), intent(in) :: bodies !! bodies with their inverse masses
    real(wp), intent(in), contiguous :: velocity(:, :) !! of each body, components as in `bodies_t`
    integer(i4), intent(in), contiguous, optional :: among(:) !! bodies to look at; all when absent
    integer :: i, b, n

    is_driven = .false.
    if (bodies%n_velocity == bodies%dimension) return
    n = bodies%n
    if (present(among)) n = size(among)
    do i = 1, n
      b = i
      if (present(among)) b = among(i)
      if (bodies%dimension == 2) then
        is_driven = .not. bodies%inverse_mass(3, b) > 0 .and. abs(velocity(3, b)) > 0
      else
        if (min(bodies%inverse_mass(4, b), bodies%inverse_mass(5, b), bodies%inverse_mass(6, b)) > 0) cycle
        is_driven = max(abs(velocity(4, b)), abs(velocity(5, b)), abs(velocity(6, b))) > 0
      end if
      if (is_driven) return
    end do
  end function has_driven_spin
end module sg_gap_laws
