!> Swap of lists between the subdomains of several processes: one message from process to process.
module sg_process_swap
  use sg_board, only: brought_t, slot_t
  use sg_kinds, only: i8, wp
  use sg_ranks, only: ranks_t
  implicit none
  private
  public :: swap_processes, first_subdomain

contains

  !> First of `n` subdomains that a process has.
  pure integer function first_subdomain(process, processes, n) result(first)
    integer, intent(in) :: process !! the process, from 0
    integer, intent(in) :: processes !! how many there are
    integer, intent(in) :: n !! subdomains of all processes

    first = int(int(process, i8)*int(n, i8)/int(processes, i8))
  end function first_subdomain

  !> Swap what the subdomains of all processes have brought. Lists go from process to process in the order of their receivers, and
  !! for each receiver in that of their senders.
  subroutine swap_processes(brought, slot, processes, n)
    type(brought_t), intent(in) :: brought(0:) !! lists of the subdomains of this process
    type(slot_t), intent(inout) :: slot !! slot of the round, in which all that came is stored
    class(ranks_t), intent(inout) :: processes !! the processes
    integer, intent(in) :: n !! subdomains of all processes
    integer, allocatable :: counts(:, :), came_count(:)
    real(wp), allocatable :: came(:)
    integer :: first(0:processes%size), share(0:processes%size - 1), p, r, k, before

    first = [(first_subdomain(p, processes%size, n), p=0, processes%size)]
    share = first(1:) - first(:processes%size - 1)
    associate (here => size(brought))
      allocate (counts(0:here - 1, 0:n - 1))
      do k = 0, here - 1
        counts(k, :) = brought(k)%counts
      end do
      call processes%swap(real(reshape(counts, [size(counts)]), wp), here*share, came, came_count)
      if (allocated(slot%counts)) deallocate (slot%counts, slot%first)
      allocate (slot%counts(0:n - 1, 0:here - 1), slot%first(0:n - 1, 0:here - 1))
      before = 0
      do p = 0, processes%size - 1
        do k = 0, here - 1
          slot%counts(first(p):first(p + 1) - 1, k) = nint(came(before + 1:before + share(p)))
          before = before + share(p)
        end do
      end do
      call processes%swap(by_receiver(brought, counts), &
                          [(sum(counts(:, first(p):first(p + 1) - 1)), p=0, processes%size - 1)], slot%values, came_count)
      before = 0
      do p = 0, processes%size - 1
        do k = 0, here - 1
          do r = first(p), first(p + 1) - 1
            slot%first(r, k) = before
            before = before + slot%counts(r, k)
          end do
        end do
      end do
    end associate
  end subroutine swap_processes

  !> Lists of all senders of a process in the order of their receivers.
  pure function by_receiver(brought, counts) result(values)
    type(brought_t), intent(in) :: brought(0:)
    integer, intent(in) :: counts(0:, 0:) !! reals from each sender here to each receiver
    real(wp) :: values(sum(counts))
    integer :: first(0:size(counts, 1) - 1), k, r, n

    first = 0
    n = 0
    do r = 0, size(counts, 2) - 1
      do k = 0, size(counts, 1) - 1
        values(n + 1:n + counts(k, r)) = brought(k)%values(first(k) + 1:first(k) + counts(k, r))
        first(k) = first(k) + counts(k, r)
        n = n + counts(k, r)
      end do
    end do
  end function by_receiver
end module sg_process_swap
