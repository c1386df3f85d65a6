!> The linear systems of interior points, whoever holds the contacts: one process, or the ranks that share a scene.
!!
!! A step needs the systems (A W + B) dr = g, products with W, and sums and minima over all contacts; nothing else of it depends on
!! where contacts are.
module sg_cone_system
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  implicit none
  private
  public :: cone_system_t

  !> Such systems
  type, abstract :: cone_system_t
    !> Are the unknowns the velocities of the bodies, rather than the impulses of the contacts? Then B^-1 is asked for
    logical :: is_global = .false.
  contains
    procedure(factorise), deferred :: factorise
    procedure(solve), deferred :: solve
    procedure(multiply), deferred :: multiply
    procedure :: add_up => keep_sums
    procedure :: find_least => keep_least
  end type cone_system_t

  abstract interface
    !> Factorise A W + B.
    subroutine factorise(self, scaled, has_identity, a, b, error)
      import :: cone_system_t, error_t, matrix_problem_t, wp
      class(cone_system_t), intent(inout) :: self
      type(matrix_problem_t), intent(in) :: scaled !! problem without units
      logical, intent(in) :: has_identity !! is A 1 at all contacts?
      real(wp), intent(in), contiguous :: a(:, :, :) !! A, shape (d, d, n)
      real(wp), intent(in), contiguous :: b(:, :, :) !! B, or B^-1 in the global form, shape (d, d, n)
      type(error_t), allocatable, intent(out) :: error !! why there are no factors
    end subroutine factorise

    !> Solve (A W + B) dr = g.
    subroutine solve(self, scaled, g, dr, du)
      import :: cone_system_t, matrix_problem_t, wp
      class(cone_system_t), intent(inout) :: self
      type(matrix_problem_t), intent(in) :: scaled !! problem without units
      real(wp), intent(in), contiguous :: g(:, :) !! right-hand side, shape (d, n)
      real(wp), intent(out), contiguous :: dr(:, :) !! solution, shape (d, n)
      real(wp), intent(out), contiguous :: du(:, :) !! W dr, shape (d, n)
    end subroutine solve

    !> Product u = W r.
    subroutine multiply(self, scaled, r, u)
      import :: cone_system_t, matrix_problem_t, wp
      class(cone_system_t), intent(inout) :: self
      type(matrix_problem_t), intent(in) :: scaled !! problem without units
      real(wp), intent(in), contiguous :: r(:, :) !! impulses, shape (d, n)
      real(wp), intent(out), contiguous :: u(:, :) !! relative velocities, shape (d, n)
    end subroutine multiply
  end interface

contains

  !> Sum values over all that hold contacts: one process holds all.
  subroutine keep_sums(self, values)
    class(cone_system_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:) !! of the contacts here, then of all
  end subroutine keep_sums

  !> Find the least value of all that hold contacts: one process holds all.
  subroutine keep_least(self, value)
    class(cone_system_t), intent(inout) :: self
    real(wp), intent(inout) :: value !! of the contacts here, then of all
  end subroutine keep_least
end module sg_cone_system
