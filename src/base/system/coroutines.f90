!> Coroutines: several runs of one procedure that take turns in one thread, each on a stack of its own (coroutines.c).
!!
!! A turn ends where a coroutine yields, and the others go on in the order of their numbers: nothing runs side by side, so the order
!! of all events is the same in every run.
module sg_coroutines
  use, intrinsic :: iso_c_binding, only: c_double, c_funloc, c_funptr, c_int, c_ptr
  implicit none
  private
  public :: body_of_coroutine, run_coroutines, yield, note_progress

  abstract interface
    !> Body of a coroutine.
    subroutine body_of_coroutine(data, number) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: data !! address given to all
      integer(c_int), value :: number !! number of the coroutine, from 0
    end subroutine body_of_coroutine
  end interface

  interface
    function c_coroutines(n, body, data) bind(c, name='splitgrain_coroutines') result(status)
      import :: c_funptr, c_int, c_ptr
      integer(c_int), value :: n
      type(c_funptr), value :: body
      type(c_ptr), value :: data
      integer(c_int) :: status
    end function c_coroutines
    function c_yield() bind(c, name='splitgrain_yield') result(turns)
      import :: c_double
      real(c_double) :: turns
    end function c_yield
    !> Note an event that others may wait for.
    subroutine note_progress() bind(c, name='splitgrain_progress')
    end subroutine note_progress
  end interface

contains

  !> Run a procedure so many times, as coroutines, until all have returned.
  subroutine run_coroutines(n, body, data, has_run)
    integer, intent(in) :: n !! how many
    procedure(body_of_coroutine) :: body !! the procedure
    type(c_ptr), intent(in) :: data !! handed to all
    logical, intent(out) :: has_run !! false where there is no memory for their stacks

    has_run = c_coroutines(int(n, c_int), c_funloc(body), data) == 0
  end subroutine run_coroutines

  !> End the turn of this coroutine; it goes on after those of all others. The program ends where all wait for each other.
  subroutine yield()
    if (c_yield() > 2) error stop 'all subdomains of a process wait for each other'
  end subroutine yield
end module sg_coroutines
