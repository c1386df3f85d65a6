!> Linear laws whose epsilon is given as a multiple of the mean diagonal term of W (doc/theory/laws.md).
!!
!! So interactions keep their rigidity over that of the bodies whatever masses and sizes are (doc/theory/spectral_radius.md).
module sg_relative_epsilon
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_delassus, only: set_block
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: arm_compliance_n, arm_compliance_t, arm_wnn, arm_wtt, is_in_space, solid_compliance_n, &
                        solid_compliance_t, solid_s1, solid_s2, solid_wn1, solid_wn2, solid_wnn
  use sg_scene, only: scene_t
  implicit none
  private
  public :: set_relative_epsilon

contains

  !> Set the compliance of contacts whose law has a relative epsilon: that multiple of the mean of the diagonal terms of W at these
  !! contacts, on all ranks, in the directions in which they act. Collective; scenes without such laws have nothing to do.
  subroutine set_relative_epsilon(scene, contacts, comm, problem)
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(comm_t), intent(inout) :: comm !! the ranks
    type(problem_t), intent(inout) :: problem !! problem of the step, assembled with zero in place of these compliances
    real(wp) :: sums(2)
    integer :: k, first, last

    if (.not. any(scene%laws%relative_epsilon > 0)) return
    sums = 0
    do k = 1, contacts%n
      associate (law => scene%laws(contacts%law(k)))
        if (law%relative_epsilon > 0) sums = sums + diagonal_of(problem%kind, problem%record(:, k), law%is_along_normal)
      end associate
    end do
    call comm%sum(sums)
    if (.not. sums(2) > 0) return
    first = merge(solid_compliance_n, arm_compliance_n, is_in_space(problem%kind))
    last = merge(solid_compliance_t, arm_compliance_t, is_in_space(problem%kind))
    do k = 1, contacts%n
      associate (law => scene%laws(contacts%law(k)))
        if (.not. law%relative_epsilon > 0) cycle
        problem%record(first:last, k) = law%relative_epsilon*sums(1)/sums(2)
      end associate
      call set_block(problem%kind, problem%body(:, problem%pair(1, k)), problem%body(:, problem%pair(2, k)), problem%record(:, k))
    end do
  end subroutine set_relative_epsilon

  !> Sum of the diagonal terms of W at a contact in the directions in which its linear law acts [1/kg], and their number.
  pure function diagonal_of(kind, record, is_along_normal) result(terms)
    integer, intent(in) :: kind
    real(wp), intent(in) :: record(:)
    logical, intent(in) :: is_along_normal
    real(wp) :: terms(2)

    terms = 0
    if (.not. record(merge(solid_wnn, arm_wnn, is_in_space(kind))) > 0) return
    if (is_in_space(kind)) then
      terms = [record(solid_wnn), 1.0_wp]
      ! W is S + w w^T/W_nn on the tangents.
      if (.not. is_along_normal) terms = terms + [record(solid_s1) + record(solid_s2) &
                                                  + (record(solid_wn1)**2 + record(solid_wn2)**2)/record(solid_wnn), 2.0_wp]
    else
      terms = [record(arm_wnn), 1.0_wp]
      if (.not. is_along_normal) terms = terms + [record(arm_wtt), 1.0_wp]
    end if
  end function diagonal_of
end module sg_relative_epsilon
