!> Work of imposed forces over a step, and of what holds driven components (doc/theory/indicators.md, "Energy").
module sg_imposed_work
  use sg_bodies, only: bodies_t
  use sg_body_energy, only: inertia_of
  use sg_kinds, only: wp
  use sg_rotations, only: no_rotation, turned_back, turned_on
  use sg_scene, only: scene_t
  implicit none
  private
  public :: add_held_work, find_mean, has_driven, held_work, imposed_work

contains

  !> Mean velocity of a step, by components one after the other: in pieces of a body they would not fill vector registers.
  pure subroutine find_mean(n, before, after, mean)
    integer, intent(in) :: n !! components of all bodies
    real(wp), intent(in) :: before(n), after(n) !! velocities at both ends of the step
    real(wp), intent(out) :: mean(n) !! their mean

    mean = (before + after)/2
  end subroutine find_mean

  !> Does a component move whose velocity is given?
  pure logical function has_driven(n, mean, inverse_mass)
    integer, intent(in) :: n !! components of all bodies
    real(wp), intent(in) :: mean(n), inverse_mass(n) !! mean velocities and inverse masses, component by component

    has_driven = count(abs(mean) > 0 .and. .not. inverse_mass > 0) > 0
  end function has_driven

  !> Work of all forces but gravity over a step [J].
  pure real(wp) function imposed_work(scene, h, mean) result(work)
    type(scene_t), intent(in) :: scene !! scene with the forces of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: mean(:, :) !! mean velocities of the step
    integer :: i

    work = 0
    associate (bodies => scene%bodies, g => scene%gravity)
      do i = 1, bodies%n_own
        if (scene%dimension == 2 .and. size(mean, 1) == 3) then
          work = work + h*(bodies%force(1, i)*mean(1, i) + bodies%force(2, i)*mean(2, i) + bodies%force(3, i)*mean(3, i) &
                           - bodies%mass(i)*(g(1)*mean(1, i) + g(2)*mean(2, i)))
        else
          work = work + h*(dot_product(bodies%force(:, i), mean(:, i)) &
                           - bodies%mass(i)*dot_product(g(:scene%dimension), mean(:scene%dimension, i)))
        end if
      end do
    end associate
  end function imposed_work

  !> What driven components gain beyond the work of forces [J]; `driven` is their mean velocity, zero elsewhere.
  pure real(wp) function held_work(bodies, h, driven) result(work)
    type(bodies_t), intent(in) :: bodies !! bodies with velocities of both ends of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: driven(:, :) !! mean velocities where components are driven
    integer :: i

    work = 0
    do i = 1, bodies%n_own
      call add_held_work(bodies, i, h, driven(:, i), work)
    end do
  end function held_work

  !> Add what driven components of a body gain beyond the work of forces [J]; that of its contacts is to be taken away.
  pure subroutine add_held_work(bodies, body, h, driven, work)
    type(bodies_t), intent(in) :: bodies !! bodies with velocities of both ends of the step
    integer, intent(in) :: body !! one of this rank's own
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: driven(:) !! its mean velocity where it is driven, zero in other components
    real(wp), intent(inout) :: work !! sum to add to
    integer :: c

    do c = 1, bodies%n_velocity
      work = work + driven(c)*(inertia_of(bodies, c, body)*(bodies%free_velocity(c, body) - bodies%velocity(c, body)) &
                               - h*bodies%force(c, body))
    end do
    if (bodies%n_velocity < 6) return
    if (any(abs(driven(4:6)) > 0)) work = work - dot_product(driven(4:6), gyroscopic_impulse(bodies, body, h))
  end subroutine add_held_work

  !> What turning does to the spin of a body in space over a step, about its principal axes [N m s]: (R(-h w) - 1) J w0.
  pure function gyroscopic_impulse(bodies, body, h) result(impulse)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: body
    real(wp), intent(in) :: h
    real(wp) :: impulse(3), turn(4), momentum(3)

    turn = turned_on(no_rotation, h/2*(bodies%velocity(4:6, body) + bodies%free_velocity(4:6, body)))
    momentum = bodies%principal(:, body)*bodies%velocity(4:6, body)
    impulse = turned_back(turn, momentum) - momentum
  end function gyroscopic_impulse
end module sg_imposed_work
