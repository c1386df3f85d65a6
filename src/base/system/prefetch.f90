!> Prefetch of numbers into the caches: passes over records wait for memory where each record is used at once.
module sg_prefetch
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  private
  public :: prefetch, run_of_records, runs_ahead

  !> Records that passes prefetch at once, and runs of them between a prefetch and its use
  integer, parameter :: run_of_records = 8, runs_ahead = 12

  interface
    !> Prefetch numbers that lie ahead of an array element (prefetch.cpp). They may lie beyond the end of the array.
    pure subroutine prefetch(first, ahead, reals) bind(c, name='sg_prefetch_ahead')
      import :: c_double, c_int
      real(c_double), intent(in) :: first(*) !! element that they are counted from
      integer(c_int), intent(in), value :: ahead !! reals between it and the first number to prefetch
      integer(c_int), intent(in), value :: reals !! reals to prefetch
    end subroutine prefetch
  end interface
end module sg_prefetch
