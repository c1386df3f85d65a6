!> Bodies that pass through each other within a step.
!!
!! Contacts are found once a step. From one detection to the next a body moves by exactly h V, whatever theta, so a contact that
!! was seen at a gap g is g + h u_n wide at the next one, u_n being the velocity that the step ended with. Laws that act at a
!! distance (IQS, GAP_SGR) leave no g + h u_n below zero. Those that wait until shapes touch (RST, VEL_SGR) may: and where it is
!! deeper than both shapes are thick to their middles, what is found next lies beyond, and is pushed out on the wrong side, or not
!! at all.
module sg_passing
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t, fail
  use sg_guard, only: number_of
  use sg_half_width, only: half_width
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: passing_t, look_for_passing, tell_passing

  !> What is known of bodies that passed
  type :: passing_t
    !> Pairs of bodies that passed in the present step, of this rank and then of all
    integer :: n = 0
    !> The first of them, in words, and whether it has been told
    type(error_t), allocatable :: first
    logical :: is_told = .false.
  end type passing_t

contains

  !> Count the pairs of bodies that the motion since the last detection has brought through each other.
  subroutine look_for_passing(passing, scene, contacts, step, h)
    type(passing_t), intent(inout) :: passing !! its count is set
    type(scene_t), intent(in) :: scene !! velocities are those with which the last step ended
    type(contacts_t), intent(in) :: contacts !! contacts of the last detection
    integer, intent(in) :: step !! number of the step that begins
    real(wp), intent(in) :: h !! time step [s]
    real(wp) :: way, thickness
    integer :: k, last(2), numbers(2)

    passing%n = 0
    last = 0
    do k = 1, contacts%n
      associate (b => contacts%body(:, k), n => scene%dimension)
        ! Points of contact of one pair follow each other.
        if (all(b == last)) cycle
        way = -h*dot_product(contacts%normal(:, k), scene%bodies%velocity(:n, b(1)) - scene%bodies%velocity(:n, b(2)))
        if (way <= max(0.0_wp, contacts%gap(k))) cycle
        thickness = half_width(scene%contactors, int(contacts%contactor(1, k))) + &
                    half_width(scene%contactors, int(contacts%contactor(2, k)))
        if (way <= thickness .or. way - contacts%gap(k) <= thickness) cycle
        last = b
        passing%n = passing%n + 1
        if (passing%is_told .or. allocated(passing%first)) cycle
        numbers = [number_of(scene, last(1)), number_of(scene, last(2))]
        call fail(passing%first, 'step '//to_text(step)//': bodies '//to_text(minval(numbers))//' and '// &
                  to_text(maxval(numbers))//' pass through each other, at '//to_text(way/h, 3)//' m/s, '// &
                  'since contacts are found once a step; a time step below '//to_text(thickness/way*h, 2)//' s finds them')
      end associate
    end do
  end subroutine look_for_passing

  !> Warn of the first bodies that passed. Collective where ranks share the scene; all have the same count.
  subroutine tell_passing(passing, comm, unit)
    type(passing_t), intent(inout) :: passing !! of the step just done
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, intent(in) :: unit !! open unit to write on
    integer :: speaker

    if (passing%n == 0 .or. passing%is_told) return
    passing%is_told = .true.
    call comm%agree(passing%first, speaker)
    if (comm%rank == 0 .and. allocated(passing%first)) write (unit, '(a)') passing%first%report('warning')
  end subroutine tell_passing
end module sg_passing
