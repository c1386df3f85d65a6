!> The default solver of contact problems given by matrices keeps up with plain sweeps on columns, which these solve slowly.
program test_method_turns
  use harness, only: tests_t
  use sg_block_automatic, only: block_automatic_t
  use sg_block_nlgs, only: block_nlgs_t
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_report, only: report_t
  use sg_text, only: to_text
  implicit none
  type(tests_t) :: tests
  integer :: d

  do d = 2, 3
    call default_keeps_up(d, 5)
    call default_keeps_up(d, 50)
    call default_keeps_up(d, 500)
  end do
  call tests%finish()

contains

  !> Plain sweeps have at least 0.4 of the operations of the default solver, and no iteration of another method takes fewer than one
  !! of theirs: with four times the iterations its answer is no worse, but for the places where e1 is measured.
  subroutine default_keeps_up(d, bodies)
    integer, intent(in) :: d, bodies
    integer, parameter :: sweeps(4) = [30, 100, 300, 1000]
    type(block_nlgs_t) :: nlgs
    type(block_automatic_t) :: automatic
    type(matrix_problem_t) :: problem, answer
    type(report_t) :: plain, default
    integer :: i

    call make_column(d, bodies, problem)
    do i = 1, size(sweeps)
      nlgs%options%tolerance = 1e-12_wp
      nlgs%options%maximum_iterations = sweeps(i)
      automatic%options%tolerance = 1e-12_wp
      automatic%options%maximum_iterations = 4*sweeps(i)
      answer = problem
      call nlgs%solve(answer, plain)
      answer = problem
      call automatic%solve(answer, default)
      call tests%check(default%e1 <= max(1.2_wp*plain%e1, 1e-12_wp), 'the default solver keeps up with '// &
                       to_text(sweeps(i))//' sweeps on '//to_text(bodies)//' bodies, d = '//to_text(d))
    end do
  end subroutine default_keeps_up

  !> A column of bodies of mass 1 without rotation that falls on a floor and slides: contact k is below body k.
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
end program test_method_turns
