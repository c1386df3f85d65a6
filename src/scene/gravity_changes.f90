!> Gravity that changes with time, component by component, such as that of a table which tilts.
module sg_gravity_changes
  use sg_kinds, only: wp
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: gravity_change_t, gravity_of_step, largest_component

  !> One component of gravity while a function of time gives it
  type :: gravity_change_t
    !> Component: 1 x, 2 y, 3 z
    integer :: component = 0
    !> The component [m/s2]
    type(time_function_t) :: value
  end type gravity_change_t

contains

  !> Gravity of a step that begins at `time` [m/s2]: (1 - theta) g(t) + theta g(t + h) where a change acts, as of imposed forces.
  pure function gravity_of_step(steady, changes, time, h, theta) result(gravity)
    real(wp), intent(in) :: steady(3) !! gravity of components that no change gives [m/s2]
    type(gravity_change_t), intent(in) :: changes(:) !! all changes of the scene
    real(wp), intent(in) :: time !! beginning of the step [s]
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    real(wp) :: gravity(3)
    integer :: i

    gravity = steady
    do i = 1, size(changes)
      associate (value => changes(i)%value)
        if (value%acts(time + h/2)) &
          gravity(changes(i)%component) = (1 - theta)*value%at(time) + theta*value%at(time + h)
      end associate
    end do
  end function gravity_of_step

  !> A bound of the size of a component at all times [m/s2].
  pure real(wp) function largest_component(steady, changes, component) result(largest)
    real(wp), intent(in) :: steady(3) !! gravity of components that no change gives [m/s2]
    type(gravity_change_t), intent(in) :: changes(:) !! all changes of the scene
    integer, intent(in) :: component !! 1 x, 2 y, 3 z
    integer :: i
    logical :: is_steady

    largest = 0
    is_steady = .true.
    do i = 1, size(changes)
      if (changes(i)%component /= component) cycle
      largest = max(largest, changes(i)%value%largest())
      if (.not. changes(i)%value%is_timed()) is_steady = .false.
    end do
    if (is_steady) largest = max(largest, abs(steady(component)))
  end function largest_component
end module sg_gravity_changes
