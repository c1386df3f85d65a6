!> Solvers of matrices as the method of a run: a stack of squares that sweeps leave far from its solution, a tall packing from
!! zero impulses, and a law that has no matrices.
program test_by_matrices
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, force_on, g, hold, put_disk, put_polygon, put_wall, run
  use sg_body_energy, only: kinetic_energy
  use sg_kinds, only: wp
  use sg_laws, only: law_linear
  use sg_simulation, only: simulation_t
  implicit none
  type(tests_t) :: t

  call test_stack('interior')
  call test_stack('proximal')
  call test_stack('auto')
  call test_packing('interior')
  call test_linear('interior')
  call t%finish()

contains

  !> Eight squares with friction, one on the other, a little out of line: two contacts an interface, impulses not unique.
  subroutine test_stack(method)
    character(len=*), intent(in) :: method
    type(simulation_t), pointer :: sim
    integer, parameter :: n = 8
    real(wp) :: x, y, weight, force(2)
    integer :: b

    sim => fresh()
    call begin_scene(sim%scene, n + 1, 0.5_wp, 0.01_wp)
    do b = 1, n
      x = 0.02_wp*real(modulo(b, 3), wp)
      y = 0.2_wp*real(b - 1, wp)
      call put_polygon(sim%scene, b, reshape([x, y, x + 0.2_wp, y, x + 0.2_wp, y + 0.2_wp, x, y + 0.2_wp], [2, 4]))
    end do
    call put_wall(sim%scene, n + 1, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    sim%options%solver%method = method
    call begin_run(sim, 1e-3_wp, 1e-8_wp)
    call run(sim, 1)
    call t%check(sim%report%is_converged .and. sim%report%e8 <= 1e-8_wp, 'stack by '//method//': solved from zero impulses')
    call run(sim, 19)
    weight = sum(sim%scene%bodies%mass(:n))*g
    force = force_on(sim, n + 1)
    ! e8 is relative to all impulses, some n/2 times the weight; a stack multiplies it by at most n^2.
    call t%near(-force(2)/weight, 1.0_wp, 1e-5_wp, 'stack by '//method//': the floor carries the weight')
    call t%near(kinetic_energy(sim%scene%bodies)/weight, 0.0_wp, 1e-10_wp, 'stack by '//method//': at rest')
    call t%check(sim%totals%converged_steps == sim%totals%steps, 'stack by '//method//': every step is solved')
  end subroutine test_stack

  !> A triangular packing forty rows high, from zero impulses in one step: sweeps take thousands.
  subroutine test_packing(method)
    character(len=*), intent(in) :: method
    type(simulation_t), pointer :: sim
    integer, parameter :: columns = 5, rows = 40, n = columns*rows
    real(wp), parameter :: radius = 0.01_wp
    real(wp) :: weight, force(2)
    integer :: b, row

    sim => fresh()
    call begin_scene(sim%scene, n + 1, 0.5_wp, 1e-4_wp)
    sim%scene%period = 2*radius*columns
    do b = 1, n
      row = (b - 1)/columns
      call put_disk(sim%scene, b, radius, radius*[real(2*modulo(b - 1, columns) + modulo(row, 2), wp) + 0.5_wp, &
                                                  1 + sqrt(3.0_wp)*real(row, wp)])
    end do
    call put_wall(sim%scene, n + 1, 1.0_wp, 0.01_wp, [0.05_wp, -0.01_wp], 0.0_wp)
    sim%options%solver%method = method
    call begin_run(sim, 1e-3_wp, 1e-8_wp)
    call run(sim, 1)
    weight = sum(sim%scene%bodies%mass(:n))*g
    force = force_on(sim, n + 1)
    call t%check(sim%report%is_converged, 'packing by '//method//': solved from zero impulses')
    call t%check(sim%report%factorisations < 60, 'packing by '//method//': in few factorisations')
    ! e8 is relative to the root of the sum of squares of all impulses, some ten weights; rows multiply it by their number.
    call t%near(-force(2)/weight, 1.0_wp, 1e-5_wp, 'packing by '//method//': the floor carries the weight at once')
  end subroutine test_packing

  !> A linear law is no cone: sweeps solve it, whatever the method.
  subroutine test_linear(method)
    character(len=*), intent(in) :: method
    type(simulation_t), pointer :: sim

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.5_wp, 1e-4_wp)
    call put_disk(sim%scene, 1, 0.1_wp, [0.0_wp, 0.1_wp])
    call put_disk(sim%scene, 2, 0.1_wp, [0.0_wp, -0.1_wp])
    call hold(sim%scene, 2)
    sim%scene%laws(1)%kind = law_linear
    sim%scene%laws(1)%epsilon = 0.1_wp
    sim%options%solver%method = method
    call begin_run(sim, 1e-3_wp, 1e-8_wp)
    call run(sim, 1)
    call t%check(sim%report%is_converged .and. sim%report%sweeps > 0, 'a linear law is solved by sweeps')
    call t%check(sim%contacts%n == 1 .and. sim%contacts%impulse(1, 1) > 0, 'and carries an impulse')
  end subroutine test_linear
end program test_by_matrices
