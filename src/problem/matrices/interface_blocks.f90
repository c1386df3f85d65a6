!> The Delassus matrix of some contacts of a problem as rows of blocks: W_Gamma of an interface (doc/theory/decomposition.md).
!!
!! Two contacts are coupled when they share a body that can move: W_kl = sum_b H_k^T M_b^-1 H_l over these bodies. Blocks couple the
!! chosen contacts of one rank; products with W_Gamma add what the chosen contacts of other ranks do to shared bodies.
module sg_interface_blocks
  use sg_comm, only: comm_t
  use sg_interface, only: interface_t
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_problem_records, only: body_of, body_record_t, contact_of, contact_record_t
  use sg_records, only: first_inverse, impulse_length
  use sg_sorting, only: group_items
  implicit none
  private
  public :: interface_blocks_t, block_structure_t

  !> Rows of the matrix
  type :: interface_blocks_t
    !> Components of an impulse: along the normal and the tangents of `contact_of`
    integer :: d = 1
    !> Contact of each row, slots of its two bodies, and H by direction, component of a velocity, and body
    integer, allocatable :: contact(:)
    integer(i4), allocatable :: pair(:, :)
    real(wp), allocatable :: h(:, :, :, :)
    !> Blocks of row i are `block(:, :, first(i):first(i + 1) - 1)`, in the rows `column`, the diagonal one first [1/kg]
    integer, allocatable :: first(:), column(:)
    real(wp), allocatable :: block(:, :, :)
    !> Bodies by slot; of those that the contacts touch
    type(body_record_t), allocatable :: body(:)
    !> Columns of values of the interface that belong to the bodies of each row, 0 where others do not share them, shape (2, rows)
    integer, allocatable, private :: place(:, :)
  contains
    procedure :: build => blocks_build
    procedure :: couple => blocks_couple
    procedure :: multiply => blocks_multiply
    procedure :: multiply_shared => blocks_multiply_shared
    procedure :: structure => blocks_structure
  end type interface_blocks_t

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

contains

  !> Build the rows of some contacts.
  subroutine blocks_build(self, problem, chosen)
    class(interface_blocks_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem of a step, masses whole
    integer, intent(in) :: chosen(:) !! contacts of it
    type(contact_record_t) :: contact
    integer :: i, side, width

    self%d = impulse_length(problem%kind)
    width = first_inverse(problem%kind) - 1
    self%contact = chosen
    self%pair = problem%pair(:, chosen)
    if (allocated(self%h)) deallocate (self%h, self%body)
    allocate (self%body(problem%n_bodies), self%h(self%d, width, 2, size(chosen)))
    do i = 1, size(chosen)
      contact = contact_of(problem, chosen(i))
      self%h(:, :, :, i) = contact%h(:self%d, :width, :)
      do side = 1, 2
        associate (slot => self%pair(side, i))
          if (self%body(slot)%n == 0) self%body(slot) = body_of(problem, int(slot))
        end associate
      end do
    end do
    call set_blocks(self)
  end subroutine blocks_build

  !> Set the blocks, row after row: columns first, then values.
  subroutine set_blocks(self)
    class(interface_blocks_t), intent(inout) :: self
    integer, allocatable :: first(:), item(:), at(:)
    integer :: pass, i, n

    ! Item 2 j - 1 is the candidate of row j, item 2 j its antagonist.
    call group_items(reshape(self%pair, [size(self%pair)]), size(self%body), first, item)
    if (allocated(self%first)) deallocate (self%first, self%column, self%block)
    allocate (self%first(size(self%contact) + 1), source=1)
    do pass = 1, 2
      n = 0
      at = [(0, i=1, size(self%contact))]
      do i = 1, size(self%contact)
        self%first(i) = n + 1
        call add_row(self, i, first, item, at, n)
      end do
      self%first(size(self%contact) + 1) = n + 1
      if (pass == 2) exit
      allocate (self%column(n), source=0)
      allocate (self%block(self%d, self%d, n), source=0.0_wp)
    end do
  end subroutine set_blocks

  !> Add a row: contacts that share a movable body with its own, and the sum over these bodies.
  subroutine add_row(self, i, first, item, at, n)
    class(interface_blocks_t), intent(inout) :: self
    integer, intent(in) :: i
    integer, intent(in) :: first(:), item(:) !! ends of contacts on each body
    integer, intent(inout) :: at(:) !! block of each column in this row; before `first(i)` where there is none yet
    integer, intent(inout) :: n !! blocks so far
    integer :: side, e, j

    call add_block(i)
    do side = 1, 2
      associate (b => self%pair(side, i))
        if (.not. any(self%body(b)%inverse_mass > 0)) cycle
        do e = first(b), first(b + 1) - 1
          j = (item(e) + 1)/2
          if (at(j) < self%first(i)) call add_block(j)
          if (.not. allocated(self%block)) cycle
          self%block(:, :, at(j)) = self%block(:, :, at(j)) + product_of(self%h(:, :, side, i), self%body(b), &
                                                                       self%h(:, :, item(e) - 2*(j - 1), j))
        end do
      end associate
    end do
  contains
    !> The next block belongs to a column.
    subroutine add_block(column)
      integer, intent(in) :: column

      n = n + 1
      at(column) = n
      if (allocated(self%column)) self%column(n) = column
    end subroutine add_block
  end subroutine add_row

  !> Block H^T M^-1 H that a body makes [1/kg].
  pure function product_of(left, body, right) result(block)
    real(wp), intent(in) :: left(:, :), right(:, :)
    type(body_record_t), intent(in) :: body
    real(wp) :: block(size(left, 1), size(right, 1))
    integer :: i

    do i = 1, size(right, 1)
      block(:, i) = matmul(left, moved(body, right(i, :)))
    end do
  end function product_of

  !> Change of velocity of a body under an impulse in the axes of the world.
  pure function moved(body, impulse) result(velocity)
    type(body_record_t), intent(in) :: body
    real(wp), intent(in) :: impulse(:)
    real(wp) :: velocity(size(impulse))

    velocity = body%inverse_mass(:size(impulse))*impulse
    if (size(impulse) < 6) return
    velocity(4:6) = matmul(body%axes, body%inverse_mass(4:6)*matmul(impulse(4:6), body%axes))
  end function moved

  !> Product with the blocks of this rank alone [m/s].
  pure subroutine blocks_multiply(self, r, v)
    class(interface_blocks_t), intent(in) :: self
    real(wp), intent(in) :: r(:, :) !! impulses by row along normal and tangents [N s], shape (d, rows)
    real(wp), intent(out) :: v(:, :) !! the product
    integer :: i, e

    do i = 1, size(self%contact)
      v(:, i) = 0
      do e = self%first(i), self%first(i + 1) - 1
        v(:, i) = v(:, i) + matmul(self%block(:, :, e), r(:, self%column(e)))
      end do
    end do
  end subroutine blocks_multiply

  !> Find the bodies of the rows among those that ranks share.
  pure subroutine blocks_couple(self, interface)
    class(interface_blocks_t), intent(inout) :: self
    type(interface_t), intent(in) :: interface !! of the same problem
    integer :: place(size(self%body)), i

    place = 0
    place(interface%slot) = [(i, i=1, size(interface%slot))]
    if (allocated(self%place)) deallocate (self%place)
    allocate (self%place(2, size(self%contact)))
    do i = 1, size(self%contact)
      self%place(:, i) = place(self%pair(:, i))
    end do
  end subroutine blocks_couple

  !> Product with W_Gamma of the rows of all ranks: impulses of other ranks act through sums over copies of shared bodies.
  !! Collective.
  subroutine blocks_multiply_shared(self, interface, r, v, comm)
    class(interface_blocks_t), intent(in) :: self
    type(interface_t), intent(inout) :: interface !! coupled, its sums prepared
    real(wp), intent(in) :: r(:, :) !! impulses by row along normal and tangents [N s], shape (d, rows)
    real(wp), intent(out) :: v(:, :) !! the product [m/s]
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: own(size(self%h, 2), size(interface%slot)), all(size(self%h, 2), size(interface%slot))
    integer :: i, side

    own = 0
    do i = 1, size(self%contact)
      do side = 1, 2
        associate (p => self%place(side, i))
          if (p > 0) own(:, p) = own(:, p) + matmul(r(:, i), self%h(:, :, side, i))
        end associate
      end do
    end do
    all = own
    call interface%sum(all, comm)
    call self%multiply(r, v)
    do i = 1, size(self%contact)
      do side = 1, 2
        associate (p => self%place(side, i), body => self%body(self%pair(side, i)))
          if (p > 0) v(:, i) = v(:, i) + matmul(self%h(:, :, side, i), moved(body, all(:, p) - own(:, p)))
        end associate
      end do
    end do
  end subroutine blocks_multiply_shared

  !> Figures of the blocks: is the matrix nearly diagonal?
  pure function blocks_structure(self) result(structure)
    class(interface_blocks_t), intent(in) :: self
    type(block_structure_t) :: structure
    integer :: root(size(self%contact)), i, e, couplings
    real(wp) :: squares(2)

    structure%contacts = size(self%contact)
    if (structure%contacts == 0) return
    root = [(i, i=1, size(root))]
    squares = 0
    do i = 1, size(root)
      couplings = self%first(i + 1) - self%first(i) - 1
      if (couplings == 0) structure%alone = structure%alone + 1
      structure%most_couplings = max(structure%most_couplings, couplings)
      squares = squares + [sum(self%block(:, :, self%first(i))**2), &
                           sum(self%block(:, :, self%first(i) + 1:self%first(i + 1) - 1)**2)]
      do e = self%first(i) + 1, self%first(i + 1) - 1
        call join(i, self%column(e), root)
      end do
    end do
    structure%mean_couplings = real(size(self%column) - size(root), wp)/real(size(root), wp)
    if (squares(1) > 0) structure%off_diagonal = sqrt(squares(2)/squares(1))
    call count_groups(root, structure)
  end function blocks_structure

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
