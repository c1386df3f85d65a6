!> Mobilised friction and share of sliding contacts, over the contacts whose law has friction.
!!
!! Mobilised friction is the sum of the tangential impulses over that of the normal ones, both of contacts with a positive normal
!! impulse: the tangent of the slope for a block at rest on it. What a contact does, sticking or sliding, is its status after the
!! solve (sg_contact_status).
module sg_mobilised_friction
  use sg_contacts, only: contacts_t, normal_impulses
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
    real(wp) :: sums(n_friction_sums), tangential
    real(wp), allocatable :: normal(:)
    logical, allocatable :: rubs(:)
    integer :: k

    sums = 0
    if (contacts%n_components == 1 .or. .not. allocated(scene%laws)) return
    rubs = max(scene%laws%static_friction, scene%laws%dynamic_friction) > 0
    call normal_impulses(contacts, normal)
    do k = 1, contacts%n
      if (.not. (normal(k) > 0 .and. rubs(contacts%law(k)))) cycle
      if (contacts%n_components == 2) then
        tangential = abs(contacts%impulse(2, k))
      else
        tangential = sqrt((contacts%impulse(1, k) - normal(k)*contacts%normal(1, k))**2 &
                          + (contacts%impulse(2, k) - normal(k)*contacts%normal(2, k))**2 &
                          + (contacts%impulse(3, k) - normal(k)*contacts%normal(3, k))**2)
      end if
      sums(1) = sums(1) + 1
      sums(2) = sums(2) + merge(1.0_wp, 0.0_wp, contacts%status(k) == status_slide)
      sums(3) = sums(3) + normal(k)
      sums(4) = sums(4) + tangential
    end do
  end function friction_sums
end module sg_mobilised_friction
