!> Scenes periodic in x and y: four copies in twice the periods move as the one, a shift of everything changes nothing, and what
!! flies through the borders keeps its momentum.
program test_periodic_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, run
  use scenes_space, only: begin_space_scene, put_box, put_capsule, put_plane, put_sphere
  use sg_kinds, only: wp
  use sg_random, only: random_t
  use sg_rotations, only: normalised
  use sg_simulation, only: simulation_t
  implicit none
  integer, parameter :: n = 12
  real(wp), parameter :: period(2) = [1.1_wp, 1.3_wp], h = 2e-3_wp
  type(tests_t) :: t

  call test_copies(0.0_wp)
  call test_copies(0.4_wp)
  call test_shift()
  call test_momentum()
  call t%finish()

contains

  !> Grains thrown over a floor into each other, `copies` in x and y each, everything shifted along x and y.
  subroutine make(sim, friction, copies, shift, with_floor)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: friction, shift(2)
    integer, intent(in) :: copies
    logical, intent(in) :: with_floor
    type(random_t) :: random
    real(wp) :: place(3), q(4), velocity(6)
    integer :: b, c, copy, body, total

    call random%seed(51)
    total = n*copies**2
    call begin_space_scene(sim%scene, total + merge(1, 0, with_floor), friction, 0.01_wp)
    sim%scene%period = period(1)*real(copies, wp)
    sim%scene%period_y = period(2)*real(copies, wp)
    do b = 1, n
      place = [period(1)*random%uniform(), period(2)*random%uniform(), 0.16_wp*real(b, wp)]
      place(1:2) = place(1:2) + shift
      do c = 1, 4
        q(c) = random%normal()
      end do
      do c = 1, 6
        velocity(c) = random%uniform(-2.0_wp, 2.0_wp)
      end do
      if (.not. friction > 0) velocity(4:6) = 0
      do copy = 0, copies**2 - 1
        body = b + n*copy
        associate (where => place + [period(1)*real(modulo(copy, copies), wp), period(2)*real(copy/copies, wp), 0.0_wp])
          if (modulo(b, 3) == 0 .and. friction > 0) then
            call put_capsule(sim%scene, body, 0.1_wp, 0.07_wp, where)
          else if (modulo(b, 3) == 1 .and. .not. with_floor) then
            call put_box(sim%scene, body, [0.1_wp, 0.12_wp, 0.07_wp], where)
          else
            call put_sphere(sim%scene, body, 0.12_wp, where)
          end if
        end associate
        sim%scene%bodies%orientation(:, body) = normalised(q)
        sim%scene%bodies%velocity(:, body) = velocity
      end do
    end do
    if (with_floor) then
      call put_plane(sim%scene, total + 1, [4.0_wp, 4.0_wp, 0.1_wp], [shift, -0.1_wp])
    else
      sim%scene%gravity = 0
    end if
    call begin_run(sim, h, 1e-13_wp)
  end subroutine make

  !> Where a body would be had it never come back into the period.
  function unwrapped(sim, b) result(place)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: b
    real(wp) :: place(3)

    associate (bodies => sim%scene%bodies)
      place = bodies%position(:, b) + [sim%scene%period*real(bodies%crossings(b), wp), &
                                       sim%scene%period_y*real(bodies%crossings_y(b), wp), 0.0_wp]
    end associate
  end function unwrapped

  !> Four copies in twice the periods.
  subroutine test_copies(friction)
    real(wp), intent(in) :: friction
    type(simulation_t), pointer :: one, four
    real(wp) :: worst(2)
    integer :: b, copy, contacts

    one => fresh()
    four => fresh()
    call make(one, friction, 1, [0.0_wp, 0.0_wp], .true.)
    call make(four, friction, 2, [0.0_wp, 0.0_wp], .true.)
    contacts = 0
    do while (one%step < 250)
      call run(one, 1)
      call run(four, 1)
      contacts = contacts + one%report%active_contacts
    end do
    worst = 0
    do b = 1, n
      do copy = 0, 3
        worst(1) = max(worst(1), norm2(unwrapped(four, b + n*copy) - unwrapped(one, b) &
                                       - [period(1)*real(modulo(copy, 2), wp), period(2)*real(copy/2, wp), 0.0_wp]))
        worst(2) = max(worst(2), norm2(four%scene%bodies%velocity(:, b + n*copy) - one%scene%bodies%velocity(:, b)))
      end do
    end do
    call t%check(contacts > 300, 'copies: contacts')
    call t%check(any(one%scene%bodies%crossings /= 0) .and. any(one%scene%bodies%crossings_y /= 0), 'copies: periods are crossed')
    ! Impacts multiply the solver's 10^-13 some times each.
    call t%near(worst(1), 0.0_wp, 1e-6_wp, 'copies: move as the one')
    call t%near(worst(2), 0.0_wp, 1e-3_wp, 'copies: as fast')
  end subroutine test_copies

  !> The same, shifted along x and y.
  subroutine test_shift()
    type(simulation_t), pointer :: here, there
    real(wp) :: shift(2), worst
    integer :: b

    here => fresh()
    there => fresh()
    shift = [0.613_wp, 0.377_wp]
    call make(here, 0.4_wp, 1, [0.0_wp, 0.0_wp], .true.)
    call make(there, 0.4_wp, 1, shift, .true.)
    call run(here, 250)
    call run(there, 250)
    worst = 0
    do b = 1, n
      worst = max(worst, norm2(unwrapped(there, b) - unwrapped(here, b) - [shift, 0.0_wp]))
    end do
    call t%near(worst, 0.0_wp, 1e-6_wp, 'shifted: the same motion')
  end subroutine test_shift

  !> Without gravity or floor, momentum is kept through all borders.
  subroutine test_momentum()
    type(simulation_t), pointer :: sim
    real(wp) :: before(3), contacts

    sim => fresh()
    call make(sim, 0.4_wp, 1, [0.0_wp, 0.0_wp], .false.)
    before = matmul(sim%scene%bodies%velocity(1:3, :), sim%scene%bodies%mass)
    contacts = 0
    do while (sim%step < 400)
      call run(sim, 1)
      contacts = contacts + real(count(abs(int(sim%contacts%image(:sim%contacts%n))) &
                                       + abs(int(sim%contacts%image_y(:sim%contacts%n))) > 0), wp)
    end do
    call t%check(contacts > 20, 'momentum: contacts through borders')
    call t%near(norm2(matmul(sim%scene%bodies%velocity(1:3, :), sim%scene%bodies%mass) - before), 0.0_wp, &
                1e-12_wp*sum(sim%scene%bodies%mass)*2, 'momentum: kept')
  end subroutine test_momentum
end program test_periodic_in_space
