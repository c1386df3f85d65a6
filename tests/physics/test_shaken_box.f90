!> A box of disks shaken at 20 Hz shows 20 Hz in the spectrum of the force on its walls, and when they bounce its harmonics.
!!
!! The floor's acceleration stays below gravity, so that the grains ride on it: the vertical force on the floor is
!! m (g + a(t)), a sine of amplitude m A omega.
program test_shaken_box
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, drive, g, put_disk, put_wall, run
  use sg_fourier, only: fourier_is_available
  use sg_grains, only: count_grains, grains_t
  use sg_kinds, only: wp, pi
  use sg_samples, only: samples_t
  use sg_simulation, only: simulation_t
  use sg_spectrum, only: power_spectrum
  use sg_time_functions, only: time_function_t
  implicit none
  integer, parameter :: columns = 3, rows = 4, grains = columns*rows, steps = 1000
  real(wp), parameter :: h = 1e-3_wp, radius = 0.01_wp, omega = 2*pi*20
  !> Amplitude of the floor's velocity [m/s]: its acceleration is 0.38 g
  real(wp), parameter :: amplitude = 0.03_wp
  type(tests_t) :: t

  call test_shaking()
  if (fourier_is_available()) call test_bouncing()
  call t%finish()

contains

  !> One second in steps of 1 ms, after a tenth in which the grains settle: a bin is 1 Hz.
  subroutine test_shaking()
    type(simulation_t), pointer :: sim
    type(samples_t) :: samples
    type(grains_t) :: all_grains
    real(wp), allocatable :: power(:)
    real(wp) :: expected
    integer :: step

    sim => fresh()
    call make_box(sim, amplitude)
    call begin_run(sim, h, 1e-8_wp)
    call run(sim, 100)
    call t%check(.not. allocated(samples%value), 'nothing is kept before the first sample')
    do step = 1, steps
      call run(sim, 1)
      call samples%add(sim%scene, sim%contacts, h)
    end do
    call count_grains(sim%scene%bodies, all_grains)
    call t%near(sum(samples%value(3, :steps))/steps, -all_grains%mass*g, 1e-2_wp*all_grains%mass*g, 'walls carry the weight')
    if (.not. fourier_is_available()) return
    power = power_spectrum(samples%value(3, :steps))
    call t%equal(maxloc(power, 1), 1 + 20, 'the peak of the vertical force is at 20 Hz')
    expected = (all_grains%mass*amplitude*omega)**2/2
    call t%near(sum(power(20:22)), expected, 0.05_wp*expected, 'its power is that of m A omega')
    ! The kinetic energy of a sine goes with its square, on top of nothing else: twice the frequency.
    power = power_spectrum(samples%value(1, :steps))
    call t%equal(maxloc(power, 1), 1 + 40, 'the peak of the kinetic energy is at 40 Hz')
  end subroutine test_shaking

  !> Twice gravity: a block that does not bounce back leaves the floor and lands again in every period, as long as the
  !! acceleration is below 3.3 times gravity (it would miss a period). So the force repeats itself at 20 Hz, with a blow a period
  !! in it: it has harmonics, and nothing between them. Disks are no block, and blows differ: a tenth of the power may lie
  !! elsewhere.
  subroutine test_bouncing()
    integer, parameter :: harmonics(4) = [20, 40, 60, 80]
    type(simulation_t), pointer :: sim
    type(samples_t) :: samples
    real(wp), allocatable :: power(:)
    real(wp) :: among
    integer :: step, k

    sim => fresh()
    call make_box(sim, 2*g/omega)
    ! Blows of many grains at once take many sweeps: to 1e-4 of their size is enough here.
    call begin_run(sim, h, 1e-4_wp)
    call run(sim, 500)
    do step = 1, steps
      call run(sim, 1)
      call samples%add(sim%scene, sim%contacts, h)
    end do
    power = power_spectrum(samples%value(3, :steps))
    among = sum([(sum(power(20*k:20*k + 2)), k=1, 24)])
    call t%check(among > 0.9_wp*sum(power), 'the force repeats itself at 20 Hz')
    do k = 1, size(harmonics)
      associate (f => harmonics(k))
        call t%check(power(f + 1) > 10*maxval([power(f - 9:f - 4), power(f + 6:f + 11)]), 'a harmonic stands out')
      end associate
    end do
    power = power_spectrum(samples%value(5, :steps))
    call t%equal(maxloc(power(2:), 1), 20, 'the peak of the vertical momentum is at 20 Hz')
  end subroutine test_bouncing

  !> A square lattice of disks between two walls on a floor, all three shaken together.
  subroutine make_box(sim, speed)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: speed !! amplitude of the velocity [m/s]
    real(wp), parameter :: width = 2*radius*columns, thickness = 0.005_wp
    type(time_function_t) :: velocity
    integer :: b

    call begin_scene(sim%scene, grains + 3, friction=0.3_wp, alert=0.1_wp*radius)
    do b = 1, grains
      call put_disk(sim%scene, b, radius, radius*[real(2*modulo(b - 1, columns) + 1, wp), real(2*((b - 1)/columns) + 1, wp)])
    end do
    call put_wall(sim%scene, grains + 1, width, thickness, [width/2, -thickness], 0.0_wp)
    call put_wall(sim%scene, grains + 2, width, thickness, [-thickness, width/2], pi/2)
    call put_wall(sim%scene, grains + 3, width, thickness, [width + thickness, width/2], pi/2)
    velocity%amplitude = speed
    velocity%omega = omega
    do b = grains + 1, grains + 3
      call drive(sim%scene, b, 2, velocity)
    end do
  end subroutine make_box
end program test_shaken_box
