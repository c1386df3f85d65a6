!> Cost of an iteration of a decomposed solve: a model of updates, gluing and messages over a real split
!! (doc/performance.md).
!!
!! Dual: the slowest rank sweeps its contacts, glues its shared grains and exchanges them with each neighbour, one after the
!! other. Primal: the slowest rank sweeps within its part; then edges take their turns by colours, and the slowest edge of a
!! colour holds up all that follow: grains are lent, contacts swept, grains given back. A test of convergence adds a
!! reduction, log2 of the ranks messages deep. Messages are counted as if nothing was swept while they travel. Parts of one rank
!! take turns, and need no message.
module sg_cost_model
  use sg_edges, only: colour_edges
  use sg_interfaces, only: interfaces_t
  use sg_kinds, only: wp
  use sg_message_costs, only: message_costs_t
  implicit none
  private
  public :: machine_t, iteration_t, prediction_t, dual_iteration, primal_iteration

  !> Costs of the pieces of an iteration
  type :: machine_t
    !> Seconds of a contact update, its share of tests of convergence included
    real(wp) :: update = 0
    !> Seconds of gluing one shared grain, without its messages
    real(wp) :: glue = 0
    !> Messages between two ranks
    type(message_costs_t) :: messages
    !> Bytes of a grain in a message
    real(wp) :: item_bytes = 24
    !> Iterations between two tests of convergence
    integer :: check_every = 20
  end type machine_t

  !> An iteration: one sweep of all contacts and one gluing
  type :: iteration_t
    !> Seconds of the whole, and of its pieces on the rank that needs longest (dual) or in the slowest turns (primal)
    real(wp) :: seconds = 0, sweep = 0, glue = 0, message = 0, reduction = 0
    !> Messages and bytes that all ranks together send, most neighbours of a rank, turns of the edges
    integer :: messages = 0, most_neighbours = 0, colours = 0
    real(wp) :: bytes = 0
  end type iteration_t

  !> Prediction for one number of ranks
  type :: prediction_t
    !> Ranks, contacts of all, of the rank that owns most, and grains that ranks share
    integer :: ranks = 1, contacts = 0, largest = 0, shared_grains = 0
    !> Seconds of a contact update on that rank
    real(wp) :: update = 0
    !> Both methods, and their parallel efficiency: seconds of one rank over those of all
    type(iteration_t) :: dual, primal
    real(wp) :: dual_efficiency = 1, primal_efficiency = 1
  end type prediction_t

contains

  !> An iteration of the dual method with one sweep a gluing.
  pure function dual_iteration(machine, split, rank) result(iteration)
    type(machine_t), intent(in) :: machine !! costs of the pieces
    type(interfaces_t), intent(in) :: split !! contacts and grains that subdomains own and share
    integer, intent(in) :: rank(:) !! rank of each part, from 0
    type(iteration_t) :: iteration
    real(wp) :: message(0:maxval(rank)), total(0:maxval(rank)), seconds
    integer :: neighbours(0:maxval(rank)), i, slowest

    message = 0
    neighbours = 0
    do i = 1, size(split%common%items)
      associate (ends => rank(split%common%part(:, i) + 1), items => split%common%items(i))
        if (ends(1) == ends(2)) cycle
        seconds = machine%messages%of(machine%item_bytes*real(items, wp))
        message(ends) = message(ends) + seconds
        neighbours(ends) = neighbours(ends) + 1
        iteration%messages = iteration%messages + 2
        iteration%bytes = iteration%bytes + 2*machine%item_bytes*real(items, wp)
      end associate
    end do
    total = machine%update*by_rank(split%owned, rank) + machine%glue*by_rank(split%shared, rank) + message
    slowest = maxloc(total, 1) - 1
    iteration%sweep = machine%update*real(sum(split%owned, rank == slowest), wp)
    iteration%glue = machine%glue*real(sum(split%shared, rank == slowest), wp)
    iteration%message = message(slowest)
    iteration%reduction = reduction(machine, size(total))
    iteration%seconds = total(slowest) + iteration%reduction
    iteration%most_neighbours = maxval(neighbours)
  end function dual_iteration

  !> An iteration of the primal method with one sweep within parts and one over the edges.
  pure function primal_iteration(machine, split, rank) result(iteration)
    type(machine_t), intent(in) :: machine !! costs of the pieces
    type(interfaces_t), intent(in) :: split !! contacts and grains that subdomains own and share
    integer, intent(in) :: rank(:) !! rank of each part, from 0
    type(iteration_t) :: iteration
    integer :: neighbours(0:maxval(rank)), colour(size(split%edge%items)), i
    real(wp), allocatable :: turn(:, :), message(:, :)
    real(wp) :: loan

    colour = colour_edges(split%edge%part, size(rank))
    if (size(colour) > 0) iteration%colours = maxval(colour)
    allocate (turn(0:maxval(rank), iteration%colours), message(0:maxval(rank), iteration%colours), source=0.0_wp)
    neighbours = 0
    do i = 1, size(colour)
      associate (ends => rank(split%edge%part(:, i) + 1), c => colour(i), sweep => machine%update*real(split%edge%items(i), wp))
        if (ends(1) == ends(2)) then
          turn(ends(1), c) = turn(ends(1), c) + sweep
          cycle
        end if
        loan = 2*machine%messages%of(machine%item_bytes*real(split%lent(i), wp))
        turn(ends, c) = turn(ends, c) + loan + sweep
        message(ends, c) = message(ends, c) + loan
        neighbours(ends) = neighbours(ends) + 1
        iteration%messages = iteration%messages + 2
        iteration%bytes = iteration%bytes + 2*machine%item_bytes*real(split%lent(i), wp)
      end associate
    end do
    iteration%message = sum(maxval(message, 1))
    iteration%reduction = reduction(machine, size(neighbours))
    iteration%seconds = machine%update*maxval(by_rank(split%inner, rank)) + sum(maxval(turn, 1)) + iteration%reduction
    iteration%sweep = iteration%seconds - iteration%message - iteration%reduction
    iteration%most_neighbours = maxval(neighbours)
  end function primal_iteration

  !> Numbers of parts, summed by rank.
  pure function by_rank(numbers, rank) result(sums)
    integer, intent(in) :: numbers(:), rank(:)
    real(wp) :: sums(0:maxval(rank))
    integer :: i

    sums = 0
    do i = 1, size(numbers)
      sums(rank(i)) = sums(rank(i)) + real(numbers(i), wp)
    end do
  end function by_rank

  !> Seconds of a reduction's share of an iteration.
  pure real(wp) function reduction(machine, ranks)
    type(machine_t), intent(in) :: machine
    integer, intent(in) :: ranks

    reduction = 0
    if (ranks > 1) reduction = log(real(ranks, wp))/log(2.0_wp)*machine%messages%latency()/real(machine%check_every, wp)
  end function reduction
end module sg_cost_model
