!> Guard against values that are not finite: says which bodies and contacts are to blame.
module sg_guard
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t, exit_broken, fail
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: find_broken

  !> Bodies and contacts named in a message
  integer, parameter :: most_named = 5

contains

  !> Is every velocity of the end of the step finite? If not, name the bodies and their contacts, by their numbers in the whole
  !! scene; each rank looks at the bodies that it holds.
  subroutine find_broken(scene, contacts, step, error)
    type(scene_t), intent(in) :: scene !! its `free_velocity` is that of the end of the step
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: step !! number of the step
    type(error_t), allocatable, intent(out) :: error !! set when a value is not finite
    character(len=:), allocatable :: names
    logical, allocatable :: is_broken(:)
    integer :: k, b, named

    if (all(abs(scene%bodies%free_velocity) <= huge(1.0_wp))) return
    is_broken = .not. all(abs(scene%bodies%free_velocity) <= huge(1.0_wp), 1)
    names = ' of bodies'
    named = 0
    do b = 1, scene%bodies%n
      if (.not. is_broken(b) .or. named >= most_named) cycle
      named = named + 1
      names = names//' '//to_text(number_of(b))
    end do
    if (count(is_broken) > named) names = names//' and '//to_text(count(is_broken) - named)//' more'
    names = names//'; contacts there (candidate-antagonist, gap):'
    named = 0
    do k = 1, contacts%n
      if (named >= most_named) exit
      if (.not. any(is_broken(contacts%body(:, k)))) cycle
      named = named + 1
      names = names//' '//to_text(number_of(int(contacts%body(1, k))))//'-'//to_text(number_of(int(contacts%body(2, k)))) &
              //' '//to_text(contacts%gap(k), 3)
    end do
    if (named == 0) names = names//' none'
    call fail(error, 'step '//to_text(step)//': velocities are not finite'//names, code=exit_broken)
  contains
    !> Number of a body in the whole scene.
    pure integer function number_of(body)
      integer, intent(in) :: body

      number_of = body
      if (allocated(scene%bodies%id)) number_of = int(scene%bodies%id(body))
    end function number_of
  end subroutine find_broken
end module sg_guard
