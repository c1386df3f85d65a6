!> Mobilised friction and share of sliding contacts, over the contacts whose law has friction.
!!
!! Mobilised friction is the sum of the tangential impulses over that of the normal ones, both of contacts with a positive normal
!! impulse: the tangent of the slope for a block at rest on it. What a contact does, sticking or sliding, is its status after the
!! solve (sg_contact_status).
module sg_mobilised_friction
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  use sg_laws, only: status_slide
  use sg_scene, only: scene_t
  use sg_tally, only: pass_columns, pass_sums, ratio, tally_t
  implicit none
  private
  public :: measure_friction, add_friction, friction_sums, n_friction_sums

  !> Numbers of `friction_sums`
  integer, parameter :: n_friction_sums = 4

contains

  !> Mobilised friction, and share of sliding contacts.
  pure subroutine measure_friction(scene, contacts, tally)
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    type(tally_t), intent(inout) :: tally !! tally of the measure

    if (tally%pass == pass_sums) call tally%sums%put('friction', friction_sums(scene, contacts))
    if (tally%pass == pass_columns) call add_friction(tally%sums%get('friction', n_friction_sums), '', tally)
  end subroutine measure_friction

  !> Add the columns that follow from sums.
  pure subroutine add_friction(sums, prefix, tally)
    real(wp), intent(in) :: sums(n_friction_sums) !! of `friction_sums`, of all ranks
    character(len=*), intent(in) :: prefix !! of the names
    type(tally_t), intent(inout) :: tally !! tally of the measure

    call tally%add(prefix//'mobilised_friction', ratio(sums(4), sums(3)))
    call tally%add(prefix//'sliding_share', ratio(sums(2), sums(1)))
  end subroutine add_friction

  !> What this rank adds: contacts, those that slide, their normal and their tangential impulses [N s].
  pure function friction_sums(scene, contacts) result(sums)
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp) :: sums(n_friction_sums), r(3), normal, tangential, x, y, z
    logical, allocatable :: rubs(:)
    integer :: k

    sums = 0
    if (contacts%n_components == 1 .or. .not. allocated(scene%laws)) return
    rubs = max(scene%laws%static_friction, scene%laws%dynamic_friction) > 0
    do k = 1, contacts%n
      if (.not. rubs(contacts%law(k))) cycle
      if (contacts%n_components == 2) then
        normal = contacts%impulse(1, k)
        tangential = abs(contacts%impulse(2, k))
      else
        r = contacts%impulse(1:3, k)
        x = contacts%normal(1, k)
        y = contacts%normal(2, k)
        z = contacts%normal(3, k)
        normal = r(1)*x + r(2)*y + r(3)*z
        tangential = sqrt((r(1) - normal*x)**2 + (r(2) - normal*y)**2 + (r(3) - normal*z)**2)
      end if
      if (.not. normal > 0) cycle
      sums(1) = sums(1) + 1
      sums(2) = sums(2) + merge(1.0_wp, 0.0_wp, contacts%status(k) == status_slide)
      sums(3) = sums(3) + normal
      sums(4) = sums(4) + tangential
    end do
  end function friction_sums
end module sg_mobilised_friction
