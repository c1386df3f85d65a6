!> Global balances of the grains: the share of their weight that the walls carry, and their momentum.
module sg_balance
  use sg_bodies, only: bodies_t
  use sg_contacts, only: contacts_t, impulse_vector
  use sg_grains, only: grains_of, grains_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_tally, only: pass_columns, pass_sums, tally_t
  implicit none
  private
  public :: measure_floor_share, measure_momentum, carried_share, force_on_walls, momentum

contains

  !> Share of the weight of the grains that the walls carry.
  pure subroutine measure_floor_share(scene, contacts, tally)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    type(tally_t), intent(inout) :: tally !! tally of the measure
    type(grains_t) :: grains

    if (tally%pass == pass_sums) then
      call tally%sums%put('wall_force', force_on_walls(scene, contacts, tally%h))
    else if (tally%pass == pass_columns) then
      grains = grains_of(tally)
      call tally%add('floor_share', carried_share(tally%sums%get('wall_force', scene%dimension), scene%gravity, grains%mass))
    end if
  end subroutine measure_floor_share

  !> Momentum of the grains along each axis [kg m/s].
  pure subroutine measure_momentum(bodies, tally)
    type(bodies_t), intent(in) :: bodies !! bodies with their velocities
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: total(bodies%dimension)
    character(len=*), parameter :: axis = 'xyz'
    integer :: a

    if (tally%pass == pass_sums) call tally%sums%put('momentum', momentum(bodies))
    if (tally%pass /= pass_columns) return
    total = tally%sums%get('momentum', size(total))
    do a = 1, size(total)
      call tally%add('momentum_'//axis(a:a), total(a))
    end do
  end subroutine measure_momentum

  !> A force along gravity over the weight of a mass; zero without weight.
  pure real(wp) function carried_share(force, gravity, mass) result(share)
    real(wp), intent(in) :: force(:) !! force [N], in the dimension of the scene
    real(wp), intent(in) :: gravity(3) !! [m/s2]
    real(wp), intent(in) :: mass !! [kg]
    real(wp) :: weight

    share = 0
    weight = mass*norm2(gravity)
    if (weight > 0) share = dot_product(force, gravity(:size(force)))/(norm2(gravity)*weight)
  end function carried_share

  !> Force of this rank's contacts on all walls, mean over the step [N].
  pure function force_on_walls(scene, contacts, h) result(force)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp) :: force(scene%dimension), impulse(3)
    logical :: is_candidate, is_antagonist
    integer :: k

    force = 0
    if (.not. h > 0) return
    do k = 1, contacts%n
      is_candidate = scene%bodies%is_grain(contacts%body(1, k))
      is_antagonist = scene%bodies%is_grain(contacts%body(2, k))
      if (is_candidate .eqv. is_antagonist) cycle
      impulse = impulse_vector(contacts, k)
      if (is_candidate) force = force - impulse(:scene%dimension)/h
      if (is_antagonist) force = force + impulse(:scene%dimension)/h
    end do
  end function force_on_walls

  !> Momentum of this rank's grains [kg m/s].
  pure function momentum(bodies)
    type(bodies_t), intent(in) :: bodies !! bodies with their velocities
    real(wp) :: momentum(bodies%dimension)
    integer :: i

    momentum = 0
    do i = 1, bodies%n_own
      if (bodies%is_grain(i)) momentum = momentum + bodies%mass(i)*bodies%velocity(:bodies%dimension, i)
    end do
  end function momentum
end module sg_balance
