!> Absent bodies: those that have not entered yet, or have left. They keep their numbers and their places, and do nothing.
module sg_presence
  use sg_bodies, only: bodies_t, body_present
  use sg_drives, only: free_inverse
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: hide_absent, hold_absent, let_body_in, let_body_out

contains

  !> Take velocity, inverse mass and the name of a grain from all bodies that are absent.
  pure subroutine hide_absent(bodies)
    type(bodies_t), intent(inout) :: bodies !! bodies whose presence is known
    integer :: b

    do b = 1, bodies%n
      if (bodies%presence(b) == body_present) cycle
      ! What a checkpoint holds as a wall has left as one.
      if (bodies%presence(b) < 0) bodies%is_grain(b) = .false.
      call let_body_out(bodies, b, abs(bodies%presence(b)))
    end do
  end subroutine hide_absent

  !> Keep absent bodies where they are, whatever drives and loads ask for.
  pure subroutine hold_absent(bodies)
    type(bodies_t), intent(inout) :: bodies !! bodies with the forces and free velocities of a step
    integer :: b

    do b = 1, bodies%n
      if (bodies%presence(b) == body_present) cycle
      bodies%force(:, b) = 0
      bodies%free_velocity(:, b) = 0
      bodies%inverse_mass(:, b) = 0
    end do
  end subroutine hold_absent

  !> Let a body in, with the velocity of its entry, as a free grain: what is driven is to be held afterwards.
  pure subroutine let_body_in(bodies, body)
    type(bodies_t), intent(inout) :: bodies !! the bodies
    integer, intent(in) :: body !! index of the body
    integer :: c

    bodies%presence(body) = body_present
    bodies%velocity(:, body) = bodies%entry_velocity(:, body)
    bodies%is_grain(body) = .true.
    do c = 1, bodies%n_velocity
      bodies%inverse_mass(c, body) = free_inverse(bodies, c, body)
    end do
  end subroutine let_body_in

  !> Make a body absent.
  pure subroutine let_body_out(bodies, body, presence)
    type(bodies_t), intent(inout) :: bodies !! the bodies
    integer, intent(in) :: body !! index of the body
    integer(i4), intent(in) :: presence !! what it is from now on: `body_waiting` or `body_removed`

    bodies%presence(body) = merge(presence, -presence, bodies%is_grain(body))
    bodies%velocity(:, body) = 0.0_wp
    bodies%is_grain(body) = .false.
    bodies%inverse_mass(:, body) = 0.0_wp
  end subroutine let_body_out
end module sg_presence
