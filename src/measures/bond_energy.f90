!> Bonds of cohesive zones: how many hold, and the energy that they store and have lost (doc/theory/indicators.md, "Energy").
module sg_bond_energy
  use sg_bonds, only: bond_sums
  use sg_contacts, only: contacts_t
  use sg_energy, only: bond_work_of
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_tally, only: pass_columns, pass_sums, tally_t
  implicit none
  private
  public :: measure_bonds

contains

  !> Energy in bonds [J], energy that they have lost [J], bonds that hold, and those of them that are damaged.
  pure subroutine measure_bonds(scene, contacts, tally)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with their internal values
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: sums(3)

    if (.not. tally%has_bonds) return
    if (tally%pass == pass_sums) call tally%sums%put('bonds', bond_sums(scene, contacts))
    if (tally%pass /= pass_columns) return
    sums = tally%sums%get('bonds', size(sums))
    call tally%add('bond_energy', sums(1))
    call tally%add('bond_loss', bond_work_of(tally) - sums(1))
    call tally%add('bonds', sums(2), is_count=.true.)
    call tally%add('damaged_bonds', sums(3), is_count=.true.)
  end subroutine measure_bonds
end module sg_bond_energy
