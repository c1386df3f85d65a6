!> Runs of one program for each subdomain: on the ranks there are, or as coroutines where a process has several subdomains.
module sg_subdomain_runs
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_loc, c_ptr
  use sg_board, only: board_t
  use sg_comm, only: comm_t
  use sg_coroutines, only: run_coroutines
  use sg_process_swap, only: first_subdomain
  implicit none
  private
  public :: subdomain_program_t, run_subdomains

  !> A program that all subdomains run, each with its own data: only its results are common to those of a process
  type, abstract :: subdomain_program_t
  contains
    procedure(run_subdomain), deferred :: run
  end type subdomain_program_t

  abstract interface
    !> Run as one of several subdomains.
    subroutine run_subdomain(self, comm)
      import :: comm_t, subdomain_program_t
      class(subdomain_program_t), intent(inout) :: self
      type(comm_t), intent(in) :: comm !! the subdomains, as ranks
    end subroutine run_subdomain
  end interface

  !> What the coroutines of a process need to begin
  type :: start_t
    class(subdomain_program_t), pointer :: program => null()
    type(board_t) :: board
    type(comm_t) :: processes
    integer :: n = 0
  end type start_t

contains

  !> Run a program for so many subdomains, at least one for each process. Collective.
  subroutine run_subdomains(program, n, processes)
    class(subdomain_program_t), intent(inout), target :: program !! what each of them does
    integer, intent(in) :: n !! subdomains of all processes
    type(comm_t), intent(in) :: processes !! the processes
    type(start_t), target :: start
    integer :: here
    logical :: has_run

    here = first_subdomain(processes%rank + 1, processes%size, n) - first_subdomain(processes%rank, processes%size, n)
    start%program => program
    start%processes = processes
    start%n = n
    call start%board%open(here)
    if (here == 1) then
      call enter(c_loc(start), 0_c_int)
    else
      call run_coroutines(here, enter, c_loc(start), has_run)
      if (.not. has_run) error stop 'no memory for the stacks of so many subdomains'
    end if
  end subroutine run_subdomains

  !> Body of the coroutines.
  subroutine enter(data, number) bind(c)
    type(c_ptr), value :: data
    integer(c_int), value :: number
    type(start_t), pointer :: start
    type(comm_t) :: comm

    call c_f_pointer(data, start)
    call comm%join(start%board, int(number), start%processes, start%n)
    call start%program%run(comm)
  end subroutine enter
end module sg_subdomain_runs
