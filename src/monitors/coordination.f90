!> How many neighbours carry a grain, and by how many points pairs touch (doc/theory/indicators.md, "Coordination").
!!
!! Two bodies touch when a contact between them carries a positive normal impulse. A rattler is a grain with fewer
!! than two touching neighbours, in the plane and in space (C. Thornton, Geotechnique 50, 2000); it is taken away once,
!! not again and again, since a column under its own weight would otherwise unravel from its top.
module sg_coordination
  use sg_contacts, only: contacts_t, normal_impulse
  use sg_kinds, only: wp, i4, i8
  use sg_pair_keys, only: pair_key
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: coordination_t, coordinate

  !> Numbers of neighbours and of points
  type :: coordination_t
    !> Mean number of touching neighbours of a grain, of all grains and of those that are no rattlers
    real(wp) :: mean = 0, without_rattlers = 0
    !> Number of rattlers
    integer :: rattlers = 0
    !> Pairs of bodies that touch by one, two, three, four or more points
    integer :: single = 0, double = 0, triple = 0, quadruple = 0
  end type coordination_t

contains

  !> Count neighbours and points.
  pure function coordinate(contacts, is_grain) result(coordination)
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    logical, intent(in) :: is_grain(:) !! is a body a grain? shape (bodies)
    type(coordination_t) :: coordination
    integer(i4), allocatable :: pair(:, :)
    integer, allocatable :: points(:)
    integer :: neighbours(size(is_grain)), i
    logical :: carries(size(is_grain))

    call touching_pairs(contacts, size(is_grain), pair, points)
    coordination%single = count(points == 1)
    coordination%double = count(points == 2)
    coordination%triple = count(points == 3)
    coordination%quadruple = count(points >= 4)
    neighbours = 0
    do i = 1, size(points)
      neighbours(pair(:, i)) = neighbours(pair(:, i)) + 1
    end do
    carries = is_grain .and. neighbours >= 2
    coordination%rattlers = count(is_grain) - count(carries)
    coordination%mean = mean_of(neighbours, is_grain)
    neighbours = 0
    do i = 1, size(points)
      if (any(is_grain(pair(:, i)) .and. .not. carries(pair(:, i)))) cycle
      neighbours(pair(:, i)) = neighbours(pair(:, i)) + 1
    end do
    coordination%without_rattlers = mean_of(neighbours, carries)
  end function coordinate

  !> Mean over some items; zero without any.
  pure real(wp) function mean_of(counts, counted) result(mean)
    integer, intent(in) :: counts(:)
    logical, intent(in) :: counted(:)

    mean = 0
    if (any(counted)) mean = real(sum(counts, mask=counted), wp)/real(count(counted), wp)
  end function mean_of

  !> Pairs of bodies that touch, and by how many points.
  pure subroutine touching_pairs(contacts, n_bodies, pair, points)
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: n_bodies
    integer(i4), allocatable, intent(out) :: pair(:, :)
    integer, allocatable, intent(out) :: points(:)
    integer, allocatable :: touching(:)
    integer(i8), allocatable :: key(:)
    integer :: k, n

    touching = pack([(k, k=1, contacts%n)], [(normal_impulse(contacts, k) > 0, k=1, contacts%n)])
    key = pair_key(contacts%body(1, touching), contacts%body(2, touching), n_bodies)
    associate (order => sort_permutation(key))
      touching = touching(order)
      key = key(order)
    end associate
    allocate (pair(2, size(key)), points(size(key)), source=0)
    n = 0
    do k = 1, size(key)
      if (k == 1) then
        n = 1
      else if (key(k) /= key(k - 1)) then
        n = n + 1
      end if
      pair(:, n) = contacts%body(:, touching(k))
      points(n) = points(n) + 1
    end do
    pair = pair(:, :n)
    points = points(:n)
  end subroutine touching_pairs
end module sg_coordination
