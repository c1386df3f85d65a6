!> What the law of a contact asks in a step: the local law of a pair of shapes, of a link, or of a cohesive zone.
module sg_contact_laws
  use sg_assemble_space, only: velocity_before
  use sg_cell_motion, only: cell_bias
  use sg_cohesive_zones, only: zone_law
  use sg_contact_surface, only: contact_surface
  use sg_contacts, only: contacts_t
  use sg_effective_radius, only: effective_radius
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, local_law_t, needs_surface, resists_rolling, set_local_law
  use sg_link_contacts, only: is_link, law_of_link
  use sg_mapping, only: relative_velocity
  use sg_scene, only: scene_t
  implicit none
  private
  public :: law_of_contact

contains

  !> What the law of a contact asks in this step.
  pure subroutine law_of_contact(scene, contacts, k, time_step, law)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(in) :: time_step !! time step [s]
    type(local_law_t), intent(out) :: law !! what it asks
    real(wp) :: before(3), surface

    if (is_link(scene, contacts, k)) then
      law = law_of_link(scene, contacts, k, time_step)
      return
    end if
    before = 0
    surface = 0
    associate (own => scene%laws(contacts%law(k)))
      if (needs_surface(own)) surface = contact_surface(scene%contactors, contacts, k)
      if (is_cohesive_zone(own)) then
        law = zone_law(own, contacts%gap(k), time_step, contacts%status(k), surface, contacts%internal(:, k))
        return
      end if
      if (max(abs(own%normal_restitution), abs(own%tangential_restitution)) > 0) then
        if (scene%dimension == 2) then
          before(:2) = relative_velocity(contacts, k, scene%bodies%middle, scene%period, scene%bodies%velocity)
        else
          before = velocity_before(scene, contacts, k)
        end if
        if (scene%cell%is_on) before = before + cell_bias(scene, contacts, k, 0.0_wp)
      end if
      call set_local_law(own, contacts%gap(k), time_step, before, contacts%status(k), law, contacts%internal(:, k), surface)
      if (resists_rolling(own)) law%moment_arm = [own%rolling_length, own%twisting_length] + [own%rolling_friction, &
                                  own%twisting_friction]*effective_radius(scene%contactors, int(contacts%contactor(:, k)))
      if (scene%cell%is_on) law%bias = law%bias + cell_bias(scene, contacts, k)
    end associate
  end subroutine law_of_contact
end module sg_contact_laws
