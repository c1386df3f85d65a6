!> Internal values of contacts as Vloc_Rloc.INI holds them: how many numbers stand behind a contact, and what they mean here.
!!
!! LMGC90 writes a number for some laws that use none; it must be there for LMGC90 to read the file.
module sg_datbox_internal
  use sg_internal_values, only: most_internal
  use sg_kinds, only: wp
  use sg_laws, only: law_elastic_g0, law_gap, law_gap_g0, law_gap_shifted, law_iqs_g0, law_t, law_velocity
  implicit none
  private
  public :: most_numbers, n_numbers_of, internal_of_numbers, numbers_of_internal

  !> Numbers behind a contact at most
  integer, parameter :: most_numbers = 7

contains

  !> Numbers that stand behind a contact under a law.
  pure integer function n_numbers_of(law) result(n)
    type(law_t), intent(in) :: law !! law of the contact

    n = 0
    select case (law%kind)
    case (law_gap, law_velocity, law_gap_shifted, law_iqs_g0, law_elastic_g0)
      n = 1
    case (law_gap_g0)
      n = 2
    end select
  end function n_numbers_of

  !> Internal values that the numbers behind a contact stand for.
  pure function internal_of_numbers(law, numbers) result(values)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: numbers(most_numbers) !! as read, zero beyond those of the law
    real(wp) :: values(most_internal)

    values = 0
    select case (law%kind)
    case (law_iqs_g0, law_elastic_g0)
      values(1) = numbers(1)
    case (law_gap_g0)
      values(1) = numbers(2)
    end select
  end function internal_of_numbers

  !> Numbers to write behind a contact.
  pure function numbers_of_internal(law, values) result(numbers)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: values(most_internal) !! its internal values, zero beyond those of the law
    real(wp) :: numbers(most_numbers)

    numbers = 0
    select case (law%kind)
    case (law_iqs_g0, law_elastic_g0)
      numbers(1) = values(1)
    case (law_gap_g0)
      numbers(2) = values(1)
    end select
  end function numbers_of_internal
end module sg_datbox_internal
