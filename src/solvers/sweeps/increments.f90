!> LMGC90's stopping criteria: how much each contact still asks to change, seen at contacts that carry an impulse.
!!
!! They measure increments, not errors: a slow sweep passes them far from the solution (doc/theory/errors.md).
module sg_increments
  use sg_delassus, only: block_times
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: arm_gyration, first_inverse, force_length, has_moments, is_in_space, solid_gyration
  use sg_run_options, only: criterion_maxm, criterion_qm16
  use sg_sweep_order, only: sweep_order_t
  use sg_sweeps, only: sweep_impulses
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: increments_t, increment_value, n_increment_sums, n_increment_maxima

  !> Sums over contacts that carry or ask an impulse, and largest values among them, that the criteria are made of
  integer, parameter :: n_increment_sums = 6, n_increment_maxima = 2

  !> Room for what each contact asks, and for bodies that nothing moves
  type :: increments_t
    real(wp), allocatable, private :: asked(:, :), still(:, :)
  contains
    procedure :: measure => increments_measure
    procedure :: list_tables => increments_list_tables
  end type increments_t

contains

  !> List the tables.
  subroutine increments_list_tables(self, tables)
    class(increments_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('increments', per_contact)
    call tables%note('asked', self%asked)
    call tables%begin('increments', per_body)
    call tables%note('still', self%still)
  end subroutine increments_list_tables

  !> Sums and largest values over the contacts of an order: of dv = W_aa (r_asked - r), of W_aa r, and of their products with r.
  !!
  !! What a contact asks while all others stay comes from a sweep over bodies that nothing moves, as LMGC90 tests.
  subroutine increments_measure(self, problem, order, sums, maxima)
    class(increments_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem with the velocities that its impulses cause
    type(sweep_order_t), intent(in) :: order !! contacts to look at, with their records and impulses
    real(wp), intent(out) :: sums(n_increment_sums) !! of dv^2, (W r)^2, dv.r, (W r).r, dv^2 r^2, and of contacts
    real(wp), intent(out) :: maxima(n_increment_maxima) !! of dv^2 and dv^2 r^2
    real(wp) :: r(6), change(6), dv(6), wr(6)
    integer :: k, m

    self%asked = order%impulse
    self%still = problem%body
    self%still(first_inverse(problem%kind):, :) = 0
    call sweep_impulses(problem%kind, order, problem%n_bodies, 1.0_wp, self%asked, self%still)
    sums = 0
    maxima = 0
    r = 0
    change = 0
    m = size(self%asked, 1)
    do k = 1, order%n
      if (.not. any(abs(self%asked(:, k)) + abs(order%impulse(:, k)) > 0)) cycle
      r(:m) = order%impulse(:, k)
      change(:m) = self%asked(:, k) - r(:m)
      if (has_moments(problem%kind)) call scale_moments(problem%kind, order%record(:, k), m, r, change)
      dv = block_times(problem%kind, order%record(:, k), change)
      wr = block_times(problem%kind, order%record(:, k), r)
      associate (dv2 => dot_product(dv, dv), r2 => dot_product(r, r))
        sums = sums + [dv2, dot_product(wr, wr), dot_product(dv, r), dot_product(wr, r), dv2*r2, 1.0_wp]
        maxima = max(maxima, [dv2, dv2*r2])
      end associate
    end do
  end subroutine increments_measure

  !> Divide moments by the length of the record, so that all components have one unit.
  pure subroutine scale_moments(kind, record, last, r, change)
    integer, intent(in) :: kind, last
    real(wp), intent(in) :: record(:)
    real(wp), intent(inout) :: r(6), change(6)
    real(wp) :: length
    integer :: first

    first = force_length(kind) + 1
    length = record(merge(solid_gyration, arm_gyration, is_in_space(kind)))
    ! Contacts without a moment have no length.
    if (.not. length > 0) length = 1
    r(first:last) = r(first:last)/length
    change(first:last) = change(first:last)/length
  end subroutine scale_moments

  !> Value of a criterion, to be compared with the tolerance.
  pure real(wp) function increment_value(criterion, sums, maxima) result(value)
    integer, intent(in) :: criterion !! one of quad, maxm, qm16
    real(wp), intent(in) :: sums(n_increment_sums) !! over all contacts
    real(wp), intent(in) :: maxima(n_increment_maxima) !! over all contacts
    real(wp) :: mean_dvr, quad_dv, quad_dvr, max_dv, max_dvr

    value = 0
    associate (dv2 => sums(1), wr2 => sums(2), dvr => sums(3), wrr => sums(4), dvr2 => sums(5), n => sums(6))
      if (.not. (n > 0 .and. wr2 > 0 .and. wrr > 0)) return
      mean_dvr = abs(dvr)/wrr
      quad_dv = sqrt(dv2/wr2)
      quad_dvr = sqrt(dvr2*n)/wrr
      max_dv = sqrt(maxima(1)*n/wr2)
      max_dvr = sqrt(maxima(2))*n/wrr
    end associate
    select case (criterion)
    case (criterion_maxm)
      value = max(mean_dvr, max_dv, max_dvr)
    case (criterion_qm16)
      value = max(mean_dvr, quad_dv, quad_dvr, max_dv/16.666_wp, max_dvr/16.666_wp)
    case default
      value = max(mean_dvr, quad_dv, quad_dvr)
    end select
  end function increment_value
end module sg_increments
