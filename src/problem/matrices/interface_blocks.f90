!> The Delassus matrix of some contacts of a problem as blocks: how nearly is it diagonal?
!!
!! Two contacts are coupled when they share a body that can move. For the contacts between the parts of a split this is
!! W_Gamma, the matrix of the interface problem (doc/theory/partition.md).
module sg_interface_blocks
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_problem_records, only: body_of, body_record_t, contact_of, contact_record_t
  implicit none
  private
  public :: block_structure_t, block_structure

  !> Figures of such a matrix
  type :: block_structure_t
    !> Contacts, and those of them that share no body with another
    integer :: contacts = 0, alone = 0
    !> Most contacts that one is coupled to, and their mean number
    integer :: most_couplings = 0
    real(wp) :: mean_couplings = 0
    !> Groups of contacts that are coupled, directly or through others, and the contacts of the largest
    integer :: groups = 0, largest_group = 0
    !> Frobenius norm of the blocks off the diagonal over that of the diagonal ones
    real(wp) :: off_diagonal = 0
  end type block_structure_t

  !> Contacts of each body as lists
  type :: lists_t
    !> Contacts of body b are `contact(first(b):first(b + 1) - 1)`, counted among the chosen ones
    integer, allocatable :: first(:), contact(:)
  end type lists_t

contains

  !> Work out the blocks, one row after the other.
  function block_structure(problem, chosen) result(structure)
    type(problem_t), intent(in) :: problem !! problem of a step
    integer, intent(in) :: chosen(:) !! contacts of it to look at
    type(block_structure_t) :: structure
    type(contact_record_t), allocatable :: contacts(:)
    type(body_record_t), allocatable :: bodies(:)
    type(lists_t) :: lists
    integer, allocatable :: root(:)
    real(wp) :: squares(2), row(2)
    integer :: i, n, couplings

    structure%contacts = size(chosen)
    if (size(chosen) == 0) return
    call take_records(problem, chosen, contacts, bodies)
    lists = lists_of(problem%pair(:, chosen), problem%n_bodies)
    root = [(i, i=1, size(chosen))]
    squares = 0
    couplings = 0
    do i = 1, size(chosen)
      call add_row(i, problem%pair(:, chosen), contacts, bodies, lists, n, row, root)
      squares = squares + row
      couplings = couplings + n
      if (n == 0) structure%alone = structure%alone + 1
      structure%most_couplings = max(structure%most_couplings, n)
    end do
    structure%mean_couplings = real(couplings, wp)/real(size(chosen), wp)
    if (squares(1) > 0) structure%off_diagonal = sqrt(squares(2)/squares(1))
    call count_groups(root, structure)
  end function block_structure

  !> Take the chosen contacts and their bodies from their records; contacts without a tangent have one row.
  subroutine take_records(problem, chosen, contacts, bodies)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: chosen(:)
    type(contact_record_t), allocatable, intent(out) :: contacts(:)
    type(body_record_t), allocatable, intent(out) :: bodies(:)
    integer :: i, side

    allocate (contacts(size(chosen)), bodies(problem%n_bodies))
    do i = 1, size(chosen)
      contacts(i) = contact_of(problem, chosen(i))
      if (.not. contacts(i)%has_tangent) contacts(i)%h(2:, :, :) = 0
      do side = 1, 2
        associate (slot => problem%pair(side, chosen(i)))
          if (bodies(slot)%n == 0) bodies(slot) = body_of(problem, int(slot))
          ! Spins about the axes in which the inertia is diagonal; in the plane there is one spin, the third component.
          if (bodies(slot)%n == 6) contacts(i)%h(:, 4:6, side) = matmul(contacts(i)%h(:, 4:6, side), bodies(slot)%axes)
        end associate
      end do
    end do
  end subroutine take_records

  !> Contacts of each body.
  pure function lists_of(pair, n_bodies) result(lists)
    integer(i4), intent(in) :: pair(:, :)
    integer, intent(in) :: n_bodies
    type(lists_t) :: lists
    integer :: i, side, b

    allocate (lists%first(n_bodies + 1), lists%contact(2*size(pair, 2)), source=0)
    do i = 1, size(pair, 2)
      do side = 1, 2
        lists%first(pair(side, i)) = lists%first(pair(side, i)) + 1
      end do
    end do
    lists%first(1) = lists%first(1) + 1
    do b = 2, n_bodies + 1
      lists%first(b) = lists%first(b) + lists%first(b - 1)
    end do
    ! `first` stands behind the lists and walks back to their beginnings.
    do i = size(pair, 2), 1, -1
      do side = 1, 2
        b = pair(side, i)
        lists%first(b) = lists%first(b) - 1
        lists%contact(lists%first(b)) = i
      end do
    end do
  end function lists_of

  !> One row of blocks: the number of other contacts, the squares of the diagonal block and of the others, and joined contacts.
  pure subroutine add_row(i, pair, contacts, bodies, lists, n, squares, root)
    integer, intent(in) :: i
    integer(i4), intent(in) :: pair(:, :)
    type(contact_record_t), intent(in) :: contacts(:)
    type(body_record_t), intent(in) :: bodies(:)
    type(lists_t), intent(in) :: lists
    integer, intent(out) :: n
    real(wp), intent(out) :: squares(2)
    integer, intent(inout) :: root(:)
    real(wp), allocatable :: block(:, :, :)
    integer, allocatable :: other(:)
    integer :: side, far, e, k, b

    n = 0
    do side = 1, 2
      b = pair(side, i)
      n = n + lists%first(b + 1) - lists%first(b)
    end do
    allocate (other(n), source=0)
    allocate (block(3, 3, n), source=0.0_wp)
    ! The first block is the diagonal one.
    other(1) = i
    n = 1
    do side = 1, 2
      b = pair(side, i)
      if (.not. any(bodies(b)%inverse_mass > 0)) cycle
      do e = lists%first(b), lists%first(b + 1) - 1
        far = merge(1, 2, pair(1, lists%contact(e)) == b)
        k = findloc(other(:n), lists%contact(e), 1)
        if (k == 0) then
          n = n + 1
          k = n
          other(k) = lists%contact(e)
          call join(i, other(k), root)
        end if
        block(:, :, k) = block(:, :, k) + product_of(contacts(i)%h(:, :, side), bodies(b)%inverse_mass, &
                                                     contacts(other(k))%h(:, :, far))
      end do
    end do
    squares = [sum(block(:, :, 1)**2), sum(block(:, :, 2:n)**2)]
    n = n - 1
  end subroutine add_row

  !> Block H M^-1 H^T that a body makes.
  pure function product_of(left, inverse_mass, right) result(block)
    real(wp), intent(in) :: left(:, :), inverse_mass(:), right(:, :)
    real(wp) :: block(3, 3)

    block = matmul(left*spread(inverse_mass, 1, 3), transpose(right))
  end function product_of

  !> Make two contacts of one group.
  pure subroutine join(i, j, root)
    integer, intent(in) :: i, j
    integer, intent(inout) :: root(:)
    integer :: a, b

    a = i
    do while (root(a) /= a)
      root(a) = root(root(a))
      a = root(a)
    end do
    b = j
    do while (root(b) /= b)
      root(b) = root(root(b))
      b = root(b)
    end do
    root(max(a, b)) = min(a, b)
  end subroutine join

  !> Count the groups, and the contacts of the largest; the root of a contact comes before it.
  pure subroutine count_groups(root, structure)
    integer, intent(inout) :: root(:)
    type(block_structure_t), intent(inout) :: structure
    integer :: members(size(root)), i

    members = 0
    do i = 1, size(root)
      root(i) = root(root(i))
      members(root(i)) = members(root(i)) + 1
    end do
    structure%groups = count(members > 0)
    structure%largest_group = maxval(members)
  end subroutine count_groups
end module sg_interface_blocks
