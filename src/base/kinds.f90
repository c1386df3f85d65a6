!> Number kinds used everywhere: one place to name precision and integer sizes.
module sg_kinds
  use, intrinsic :: iso_fortran_env, only: int8, int32, int64, real64
  implicit none
  private
  public :: wp, i1, i4, i8, pi

  !> Working precision: double, for state, geometry and solvers
  integer, parameter :: wp = real64
  !> One byte: statuses and images of contacts
  integer, parameter :: i1 = int8
  !> Four bytes: indices of bodies and contacts
  integer, parameter :: i4 = int32
  !> Eight bytes: counters that may pass 2^31 (contact updates, file offsets)
  integer, parameter :: i8 = int64
  !> Ratio of a circle's circumference to its diameter
  real(wp), parameter :: pi = acos(-1.0_wp)
end module sg_kinds
