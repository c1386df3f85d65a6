!> Values of bodies that several ranks hold: added up on the owner rank of the body, or copied from there.
!!
!! Two ranks that share bodies name the same ones in the same order, so a message holds those values alone whose owner is
!! the receiver, or the sender. Replicated bodies are owned by all ranks: their values are summed over all ranks.
module sg_owner_sums
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: add_at_owner, add_grains_at_owner, copy_from_owner

contains

  !> Add the values of a body on all ranks; the total stands on its owner rank, that of a replicated body on all ranks.
  subroutine add_at_owner(subdomain, comm, values)
    type(subdomain_t), intent(in) :: subdomain !! ranks that share each body
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(inout) :: values(:, :) !! of this rank, shape (any, bodies); then totals on the owner's rank
    real(wp), allocatable :: replicated(:)

    if (comm%size == 1) return
    call add_grains_at_owner(subdomain, comm, values)
    if (size(subdomain%replicated) == 0) return
    replicated = reshape(values(:, subdomain%replicated), [size(values, 1)*size(subdomain%replicated)])
    call comm%sum(replicated)
    values(:, subdomain%replicated) = reshape(replicated, [size(values, 1), size(subdomain%replicated)])
  end subroutine add_at_owner

  !> The same for grains alone, between neighbours alone: values of replicated bodies stay those of this rank.
  subroutine add_grains_at_owner(subdomain, comm, values)
    type(subdomain_t), intent(in) :: subdomain !! ranks that share each body
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(inout) :: values(:, :) !! of this rank, shape (any, bodies); then totals on the owner's rank
    type(exchange_t), target :: plan
    integer, allocatable :: own(:), theirs(:)
    integer :: i

    if (comm%size == 1) return
    call prepare(subdomain, comm, size(values, 1), .true., plan, own, theirs)
    plan%send(:, :) = values(:, theirs)
    call plan%begin(comm)
    call plan%finish(comm)
    do i = 1, size(own)
      values(:, own(i)) = values(:, own(i)) + plan%receive(:, i)
    end do
    call plan%release()
  end subroutine add_grains_at_owner

  !> Give all copies of a grain the values that stand on its owner rank; those of replicated bodies stay as they are.
  subroutine copy_from_owner(subdomain, comm, values)
    type(subdomain_t), intent(in) :: subdomain !! ranks that share each body
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(inout) :: values(:, :) !! right for bodies owned here, shape (any, bodies); then for all
    type(exchange_t), target :: plan
    integer, allocatable :: own(:), theirs(:)

    if (comm%size == 1) return
    call prepare(subdomain, comm, size(values, 1), .false., plan, own, theirs)
    plan%send(:, :) = values(:, own)
    call plan%begin(comm)
    call plan%finish(comm)
    values(:, theirs) = plan%receive
    call plan%release()
  end subroutine copy_from_owner

  !> Plan of an exchange between owners and copies: bodies owned here that neighbours hold, once per neighbour, and copies of
  !! bodies owned there.
  subroutine prepare(subdomain, comm, width, is_to_owner, plan, own, theirs)
    type(subdomain_t), intent(in) :: subdomain
    type(comm_t), intent(in) :: comm
    integer, intent(in) :: width
    logical, intent(in) :: is_to_owner
    type(exchange_t), intent(inout), target :: plan
    integer, allocatable, intent(out) :: own(:), theirs(:)
    integer, dimension(size(subdomain%neighbour)) :: n_own, n_theirs
    integer :: shared_with(size(subdomain%body)), i

    do i = 1, size(subdomain%neighbour)
      associate (first => subdomain%first(i), last => subdomain%first(i + 1) - 1)
        shared_with(first:last) = subdomain%neighbour(i)
        n_own(i) = count(subdomain%owner(first:last) == comm%rank)
        n_theirs(i) = count(subdomain%owner(first:last) == subdomain%neighbour(i))
      end associate
    end do
    own = pack(subdomain%body, subdomain%owner == comm%rank)
    theirs = pack(subdomain%body, subdomain%owner == shared_with)
    if (is_to_owner) then
      call plan%prepare(comm, width, subdomain%neighbour, n_theirs, n_own)
    else
      call plan%prepare(comm, width, subdomain%neighbour, n_own, n_theirs)
    end if
  end subroutine prepare
end module sg_owner_sums
