!> Internal values of contacts as Vloc_Rloc.INI holds them: how many numbers stand behind a contact, and what they mean here.
!!
!! LMGC90 writes a number for some laws that use none; it must be there for LMGC90 to read the file. Of cohesive zones it writes
!! surface, slip along t, opening (in space slip along s), integrity, and the time at which that first fell (not of IQS_MAL_CZM in
!! the plane); of IQS_EXPO_CZM in space also a reference gap, which is zero here.
module sg_datbox_internal
  use sg_internal_values, only: bond_integrity, bond_onset, bond_opening, bond_slip, bond_surface, most_internal, never
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, law_bond, law_elastic_g0, law_expo, law_gap, law_gap_g0, law_gap_shifted, law_iqs_g0, &
                     law_mal, law_rigid_wire, law_rod, law_t, law_velocity, law_wire
  implicit none
  private
  public :: most_numbers, n_numbers_of, internal_of_numbers, numbers_of_internal

  !> Numbers behind a contact at most
  integer, parameter :: most_numbers = 7

contains

  !> Numbers that stand behind a contact under a law.
  pure integer function n_numbers_of(law, dimension) result(n)
    type(law_t), intent(in) :: law !! law of the contact
    integer, intent(in) :: dimension !! of space

    n = 0
    if (is_cohesive_zone(law)) then
      n = merge(5, 6, dimension == 2)
      if (dimension == 2 .and. law%kind == law_mal) n = 4
      if (dimension == 3 .and. law%kind == law_expo) n = 7
      return
    end if
    select case (law%kind)
    case (law_gap, law_velocity, law_gap_shifted, law_iqs_g0, law_elastic_g0)
      n = 1
    case (law_gap_g0)
      n = 2
    case (law_rod, law_wire, law_rigid_wire)
      n = 1
    case (law_bond)
      n = 6
    end select
  end function n_numbers_of

  !> Internal values that the numbers behind a contact stand for.
  pure function internal_of_numbers(law, dimension, numbers, tangents) result(values)
    type(law_t), intent(in) :: law !! law of the contact
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: numbers(most_numbers) !! as read, zero beyond those of the law
    real(wp), intent(in) :: tangents(3, 2) !! axes t and s of the contact in space
    real(wp) :: values(most_internal)

    values = 0
    if (is_cohesive_zone(law)) then
      values([bond_surface, bond_opening]) = numbers([1, 3])
      values(bond_integrity) = min(1.0_wp, max(0.0_wp, numbers(merge(4, 5, dimension == 2))))
      values(bond_onset) = never
      if (n_numbers_of(law, dimension) > 4) values(bond_onset) = numbers(merge(5, 6, dimension == 2))
      if (dimension == 2) values(bond_slip) = numbers(2)
      if (dimension == 3) values(bond_slip:bond_slip + 2) = numbers(2)*tangents(:, 1) + numbers(4)*tangents(:, 2)
      return
    end if
    select case (law%kind)
    case (law_iqs_g0, law_elastic_g0)
      values(1) = numbers(1)
    case (law_gap_g0)
      values(1) = numbers(2)
    case (law_rod, law_wire, law_rigid_wire)
      values(1) = numbers(1)
    case (law_bond)
      values(:2) = numbers(:2)
    end select
  end function internal_of_numbers

  !> Numbers to write behind a contact.
  pure function numbers_of_internal(law, dimension, values, tangents) result(numbers)
    type(law_t), intent(in) :: law !! law of the contact
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: values(most_internal) !! its internal values, zero beyond those of the law
    real(wp), intent(in) :: tangents(3, 2) !! axes t and s of the contact in space
    real(wp) :: numbers(most_numbers)

    numbers = 0
    if (is_cohesive_zone(law)) then
      numbers([1, 3]) = values([bond_surface, bond_opening])
      numbers(2) = values(bond_slip)
      numbers(4:5) = values([bond_integrity, bond_onset])
      if (dimension == 2) return
      numbers([2, 4]) = matmul(values(bond_slip:bond_slip + 2), tangents)
      numbers(5:6) = values([bond_integrity, bond_onset])
      return
    end if
    select case (law%kind)
    case (law_iqs_g0, law_elastic_g0)
      numbers(1) = values(1)
    case (law_gap_g0)
      numbers(2) = values(1)
    case (law_bond)
      numbers(:2) = values(:2)
      if (dimension == 3) numbers(2:3) = matmul(values(2:4), tangents)
    end select
  end function numbers_of_internal
end module sg_datbox_internal
