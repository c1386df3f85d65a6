!> What grains cost, in half contacts, and how evenly ranks share it.
!!
!! A contact of two grains costs each of them one half, a contact with a wall costs the grain a whole one; one half more
!! stands for the motion of the grain itself (doc/theory/partition.md).
module sg_load
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: imbalance, measured_weights, own_load

contains

  !> Cost of each body from the contacts of a step [half contacts], whole numbers, zero for walls.
  !!
  !! In a decomposed scene each rank has the contacts that it owns: what they cost copies of others' grains is to be added
  !! on their owner ranks.
  pure function measured_weights(contacts, is_grain, n_own) result(weight)
    type(contacts_t), intent(in) :: contacts !! contacts of a step
    logical, intent(in) :: is_grain(:) !! is a body a grain?, shape (bodies)
    integer, intent(in) :: n_own !! bodies that this rank counts as its own: the first ones
    real(wp), allocatable :: weight(:)
    integer :: k

    allocate (weight(size(is_grain)), source=0.0_wp)
    where (is_grain(:n_own)) weight(:n_own) = 1
    do k = 1, contacts%n
      associate (a => contacts%body(1, k), b => contacts%body(2, k))
        if (is_grain(a) .and. is_grain(b)) then
          weight(a) = weight(a) + 1
          weight(b) = weight(b) + 1
        else if (is_grain(a)) then
          weight(a) = weight(a) + 2
        else if (is_grain(b)) then
          weight(b) = weight(b) + 2
        end if
      end associate
    end do
  end function measured_weights

  !> Load of a rank [half contacts]: the sum of `measured_weights` of its contacts.
  pure real(wp) function own_load(contacts, is_grain, n_own) result(load)
    type(contacts_t), intent(in) :: contacts !! its contacts of a step
    logical, intent(in) :: is_grain(:) !! is a body a grain?, shape (bodies)
    integer, intent(in) :: n_own !! bodies that this rank counts as its own: the first ones

    load = sum(measured_weights(contacts, is_grain, n_own))
  end function own_load

  !> Largest load of a rank over the mean one; 1 where there is nothing to do. Collective.
  real(wp) function imbalance(comm, load)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: load !! of this rank, in any unit
    real(wp) :: total, largest

    total = load
    largest = load
    call comm%sum(total)
    call comm%maximum(largest)
    imbalance = 1
    if (total > 0) imbalance = largest*real(comm%size, wp)/total
  end function imbalance
end module sg_load
