!> Interfaces of a split: what each rank sends to each neighbour in a gluing, counted on the contacts of a scene.
!!
!! Dual: a grain is shared by the parts that own contacts on it, and each two of them exchange its velocity. Primal: the
!! contacts between two parts are an edge; the part that owns them borrows the other one's grains (doc/theory/partition.md).
module sg_interfaces
  use sg_contacts, only: contacts_t
  use sg_kinds, only: i4, i8
  use sg_owners, only: contact_owner
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: interfaces_t, find_interfaces

  !> Pairs of parts, each once
  type :: pairs_t
    !> Parts from 0, the lower one first, shape (2, pairs), ordered
    integer, allocatable :: part(:, :)
    !> What each pair has in common
    integer, allocatable :: items(:)
  end type pairs_t

  !> What parts own and share
  type :: interfaces_t
    !> Contacts that each part owns, and those within each part, shape (parts)
    integer, allocatable :: owned(:), inner(:)
    !> Contacts between grains of two parts; grains of others that each part borrows for them; parts that borrow each body
    integer, allocatable :: cut(:), borrowed(:), copies(:)
    !> Grains held by more than one part, and how many of them each part holds, shape (parts)
    integer :: shared_grains = 0
    integer, allocatable :: shared(:)
    !> Dual: grains that pairs of parts share
    type(pairs_t) :: common
    !> Primal: contacts between pairs of parts; and grains that one lends the other for them, by the same pairs
    type(pairs_t) :: edge
    integer, allocatable :: lent(:)
  end type interfaces_t

contains

  !> Look at a split in time and memory proportional to its contacts.
  pure subroutine find_interfaces(contacts, part, parts, owner, found)
    type(contacts_t), intent(in) :: contacts !! contacts of a step
    integer(i4), intent(in) :: part(:) !! part of each body, from 1; 0 for walls, shape (bodies)
    integer, intent(in) :: parts !! number of parts
    integer(i4), allocatable, intent(out) :: owner(:) !! part that owns each contact, from 1, shape (contacts)
    type(interfaces_t), intent(out) :: found !! what the parts own and share
    integer :: k

    allocate (owner(contacts%n), found%owned(parts), found%inner(parts), source=0)
    do k = 1, contacts%n
      associate (pair => part(contacts%body(:, k)) - 1_i4)
        owner(k) = int(contact_owner(pair), i4) + 1_i4
        found%owned(owner(k)) = found%owned(owner(k)) + 1
        if (.not. is_between(pair + 1_i4)) found%inner(owner(k)) = found%inner(owner(k)) + 1
      end associate
    end do
    found%cut = pack([(k, k=1, contacts%n)], [(is_between(part(contacts%body(:, k))), k=1, contacts%n)])
    call pair_sharers(contacts, part, owner, parts, found)
    call pair_edges(contacts, part, owner, parts, found)
  end subroutine find_interfaces

  !> Does a contact lie between grains of two parts?
  pure logical function is_between(part)
    integer(i4), intent(in) :: part(2)

    is_between = all(part > 0) .and. part(1) /= part(2)
  end function is_between

  !> Count the grains on which more than one part owns contacts, by part and by pair of parts.
  pure subroutine pair_sharers(contacts, part, owner, parts, found)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: part(:), owner(:)
    integer, intent(in) :: parts
    type(interfaces_t), intent(inout) :: found
    integer(i8), allocatable :: copies(:), pairs(:)
    integer, allocatable :: times(:), first(:)
    integer :: k, side, n, b, pass

    ! Copies of grains: body and part as one number; grains come one after the other.
    call count_runs([((int(contacts%body(side, k), i8)*int(parts, i8) + int(owner(k) - 1, i8), side=1, 2), k=1, contacts%n)], &
                    copies, times)
    copies = pack(copies, part(int(copies/int(parts, i8))) > 0)
    first = [pack([(k, k=1, size(copies))], [(k == 1 .or. copies(k)/int(parts, i8) /= copies(max(1, k - 1))/int(parts, i8), &
                                              k=1, size(copies))]), size(copies) + 1]
    allocate (found%shared(parts), source=0)
    do pass = 1, 2
      n = 0
      do b = 1, size(first) - 1
        associate (sharer => int(modulo(copies(first(b):first(b + 1) - 1), int(parts, i8))))
          if (size(sharer) > 1 .and. pass == 1) then
            found%shared_grains = found%shared_grains + 1
            found%shared(sharer + 1) = found%shared(sharer + 1) + 1
          end if
          do k = 1, size(sharer)
            if (pass == 2) pairs(n + 1:n + size(sharer) - k) = int(sharer(k), i8)*int(parts, i8) + int(sharer(k + 1:), i8)
            n = n + size(sharer) - k
          end do
        end associate
      end do
      if (pass == 1) allocate (pairs(n))
    end do
    call list_pairs(pairs, parts, found%common)
  end subroutine pair_sharers

  !> Count the contacts between pairs of parts, and the grains lent for them.
  pure subroutine pair_edges(contacts, part, owner, parts, found)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: part(:), owner(:)
    integer, intent(in) :: parts
    type(interfaces_t), intent(inout) :: found
    integer(i8), allocatable :: edges(:), loans(:), distinct(:)
    integer, allocatable :: times(:)
    type(pairs_t) :: lent
    integer :: k, n

    allocate (edges(size(found%cut)), loans(size(found%cut)))
    do n = 1, size(found%cut)
      associate (k => found%cut(n), pair => part(contacts%body(:, found%cut(n))) - 1_i4)
        edges(n) = int(minval(pair), i8)*int(parts, i8) + int(maxval(pair), i8)
        ! A grain lent to several parts is distinguished by the borrower; its owner follows from the grain.
        loans(n) = int(contacts%body(merge(2, 1, pair(1) + 1 == owner(k)), k), i8)*int(parts, i8) + int(owner(k) - 1, i8)
      end associate
    end do
    call list_pairs(edges, parts, found%edge)
    call count_runs(loans, distinct, times)
    allocate (found%borrowed(parts), found%copies(size(part)), source=0)
    do k = 1, size(distinct)
      n = int(modulo(distinct(k), int(parts, i8)))
      found%borrowed(n + 1) = found%borrowed(n + 1) + 1
      associate (copies => found%copies(int(distinct(k)/int(parts, i8))))
        copies = copies + 1
      end associate
      associate (lender => part(int(distinct(k)/int(parts, i8))) - 1)
        distinct(k) = int(min(lender, n), i8)*int(parts, i8) + int(max(lender, n), i8)
      end associate
    end do
    call list_pairs(distinct, parts, lent)
    found%lent = lent%items
  end subroutine pair_edges

  !> Pairs from keys, lower part times number of parts plus higher part.
  pure subroutine list_pairs(keys, parts, pairs)
    integer(i8), intent(in) :: keys(:)
    integer, intent(in) :: parts
    type(pairs_t), intent(inout) :: pairs
    integer(i8), allocatable :: distinct(:)
    integer :: i

    call count_runs(keys, distinct, pairs%items)
    allocate (pairs%part(2, size(distinct)))
    do i = 1, size(distinct)
      pairs%part(:, i) = [int(distinct(i)/int(parts, i8)), int(modulo(distinct(i), int(parts, i8)))]
    end do
  end subroutine list_pairs

  !> Distinct numbers of a list, ascending, and how often each comes.
  pure subroutine count_runs(list, distinct, times)
    integer(i8), intent(in) :: list(:)
    integer(i8), allocatable, intent(out) :: distinct(:)
    integer, allocatable, intent(out) :: times(:)
    integer(i8), allocatable :: sorted(:)
    integer :: i, n

    sorted = list(sort_permutation(list))
    allocate (distinct(size(list)), times(size(list)))
    n = 0
    do i = 1, size(list)
      if (i > 1) then
        if (sorted(i) == sorted(i - 1)) then
          times(n) = times(n) + 1
          cycle
        end if
      end if
      n = n + 1
      distinct(n) = sorted(i)
      times(n) = 1
    end do
    distinct = distinct(:n)
    times = times(:n)
  end subroutine count_runs
end module sg_interfaces
