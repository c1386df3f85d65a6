!> A column of bodies that falls on a bottom, as a contact problem given by matrices: sweeps solve it as slowly as it is high.
module falling_column
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  implicit none
  private
  public :: make_column

contains

  !> A column of bodies of mass 1 without rotation that falls on a bottom and slides: contact k is below body k.
  subroutine make_column(d, bodies, problem)
    integer, intent(in) :: d, bodies
    type(matrix_problem_t), intent(out) :: problem
    integer :: a, b, e, k

    problem%d = d
    problem%n = bodies
    allocate (problem%friction(bodies), source=0.3_wp)
    allocate (problem%q(d, bodies), problem%r(d, bodies), source=0.0_wp)
    problem%q(:2, 1) = [-1.0_wp, 0.1_wp]
    associate (w => problem%w)
      w%d = d
      w%n = bodies
      allocate (w%first(bodies + 1), w%diagonal(bodies), w%column(3*bodies - 2))
      allocate (w%block(d, d, 3*bodies - 2), source=0.0_wp)
      e = 0
      w%first(1) = 1
      do a = 1, bodies
        do b = max(1, a - 1), min(bodies, a + 1)
          e = e + 1
          w%column(e) = int(b, i4)
          if (a == b) w%diagonal(a) = int(e, i4)
          do k = 1, d
            w%block(k, k, e) = merge(merge(1.0_wp, 2.0_wp, a == 1), -1.0_wp, a == b)
          end do
        end do
        w%first(a + 1) = int(e + 1, i4)
      end do
    end associate
  end subroutine make_column
end module falling_column
