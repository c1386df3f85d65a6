!> Run-time checks: values that are not finite end a run within the step, with the names of bodies and contacts; an energy balance
!! that does not close gives a warning, or ends it.
module sg_guard
  use sg_bodies, only: bodies_t
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t, exit_broken, exit_unbalanced, fail
  use sg_kinds, only: wp
  use sg_measures, only: measures_t
  use sg_run_options, only: guard_options_t
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: find_broken, judge_energy, number_of

  !> Bodies and contacts named in a message
  integer, parameter :: most_named = 5
  !> Coordinates above this have no finite squares of distances [m]
  real(wp), parameter :: farthest = sqrt(huge(1.0_wp))/16
  !> Masses [kg] and inertias [kg m2] up to which any number of bodies has a finite energy at speeds up to [m/s, rad/s]
  real(wp), parameter :: moderate_mass = 1e80_wp, moderate_speed = 1e100_wp
  !> Measures of the energy balance
  character(len=16), parameter :: energies(6) = [character(len=16) :: 'kinetic_energy', 'potential_energy', 'external_work', &
                                                 'drive_work', 'friction_loss', 'impact_loss']

contains

  !> Is every velocity of the end of the step finite, every position that it leads to, and every impulse and gap? If not, name
  !! the bodies and their contacts, by their numbers in the whole scene; each rank checks the bodies that it holds.
  !!
  !! Values so large that energies or distances would not be finite count as not finite.
  subroutine find_broken(scene, contacts, step, h, is_solved, error)
    type(scene_t), intent(in) :: scene !! its `free_velocity` is that of the end of the step
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: h !! time step [s]
    logical, intent(in) :: is_solved !! are contacts solved? If not, velocities are those without them
    type(error_t), allocatable, intent(out) :: error !! set when a value is not finite
    character(len=:), allocatable :: what
    logical, allocatable :: is_broken(:)
    real(wp) :: limit
    integer :: b, k

    if (is_sound(scene, contacts, h)) return
    associate (bodies => scene%bodies)
      limit = largest_speed(bodies)
      what = ''
      if (.not. all(abs(bodies%free_velocity) <= limit)) then
        what = 'velocities'
        is_broken = .not. all(abs(bodies%free_velocity) <= limit, 1)
      else if (.not. all(abs(bodies%position) + h*abs(bodies%free_velocity(:bodies%dimension, :)) <= farthest)) then
        what = 'positions'
        is_broken = .not. all(abs(bodies%position) + h*abs(bodies%free_velocity(:bodies%dimension, :)) <= farthest, 1)
      else if (.not. (all(abs(contacts%impulse(:, :contacts%n)) <= huge(1.0_wp)) .and. &
                      all(abs(contacts%gap(:contacts%n)) <= huge(1.0_wp)))) then
        what = 'contacts'
        allocate (is_broken(bodies%n), source=.false.)
        do k = 1, contacts%n
          if (all(abs(contacts%impulse(:, k)) <= huge(1.0_wp)) .and. abs(contacts%gap(k)) <= huge(1.0_wp)) cycle
          do b = 1, 2
            is_broken(contacts%body(b, k)) = .true.
          end do
        end do
      end if
    end associate
    if (what == '') return
    if (.not. is_solved) what = what//' without contacts, from forces and drives,'
    call fail(error, 'step '//to_text(step)//': '//what//' are not finite'//named_bodies(scene, is_broken)// &
              named_contacts(scene, contacts, is_broken), code=exit_broken)
  end subroutine find_broken

  !> Are all values so small that none needs a closer look? One pass over each list, without a branch per value.
  pure logical function is_sound(scene, contacts, h)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: h

    associate (bodies => scene%bodies)
      is_sound = are_within(size(bodies%mass), bodies%mass, moderate_mass)
      if (bodies%dimension == 3) then
        is_sound = is_sound .and. are_within(size(bodies%principal), bodies%principal, moderate_mass)
      else
        is_sound = is_sound .and. are_within(size(bodies%inertia), bodies%inertia, moderate_mass)
      end if
      is_sound = is_sound .and. &
                 are_within(size(bodies%free_velocity), bodies%free_velocity, min(moderate_speed, farthest/2/h)) .and. &
                 are_within(size(bodies%position), bodies%position, farthest/2) .and. &
                 are_within(size(contacts%impulse, 1)*contacts%n, contacts%impulse, huge(1.0_wp)) .and. &
                 are_within(contacts%n, contacts%gap, huge(1.0_wp))
    end associate
  end function is_sound

  !> Are so many values not larger than a limit?
  pure logical function are_within(n, values, limit)
    integer, intent(in) :: n
    real(wp), intent(in) :: values(*)
    real(wp), intent(in) :: limit

    are_within = count(abs(values(:n)) <= limit) == n
  end function are_within

  !> Speed or spin up to which the kinetic energy of all bodies together is finite, whatever the component [m/s, rad/s].
  pure real(wp) function largest_speed(bodies)
    type(bodies_t), intent(in) :: bodies
    real(wp) :: heaviest

    heaviest = 1
    if (size(bodies%mass) > 0) heaviest = max(heaviest, maxval(bodies%mass))
    if (bodies%dimension == 3) then
      if (size(bodies%principal) > 0) heaviest = max(heaviest, maxval(bodies%principal))
    else
      if (size(bodies%inertia) > 0) heaviest = max(heaviest, maxval(bodies%inertia))
    end if
    largest_speed = sqrt(huge(1.0_wp))/sqrt(heaviest)/sqrt(8.0_wp*real(max(1, bodies%n), wp))
  end function largest_speed

  !> The first bodies to blame.
  function named_bodies(scene, is_broken) result(names)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: is_broken(:)
    character(len=:), allocatable :: names
    integer :: b, named

    names = ' of bodies'
    named = 0
    do b = 1, scene%bodies%n
      if (.not. is_broken(b) .or. named >= most_named) cycle
      named = named + 1
      names = names//' '//to_text(number_of(scene, b))
    end do
    if (count(is_broken) > named) names = names//' and '//to_text(count(is_broken) - named)//' more'
  end function named_bodies

  !> The first contacts of bodies to blame.
  function named_contacts(scene, contacts, is_broken) result(names)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    logical, intent(in) :: is_broken(:)
    character(len=:), allocatable :: names
    integer :: k, named

    names = '; contacts there (candidate-antagonist, gap):'
    named = 0
    do k = 1, contacts%n
      if (named >= most_named) exit
      if (.not. any(is_broken(contacts%body(:, k)))) cycle
      named = named + 1
      names = names//' '//to_text(number_of(scene, int(contacts%body(1, k))))//'-'// &
              to_text(number_of(scene, int(contacts%body(2, k))))//' '//to_text(contacts%gap(k), 3)
    end do
    if (named == 0) names = names//' none'
  end function named_contacts

  !> Number of a body in the whole scene.
  pure integer function number_of(scene, body)
    type(scene_t), intent(in) :: scene !! scene, or a rank's part of it
    integer, intent(in) :: body !! body of this rank

    number_of = body
    if (allocated(scene%bodies%id)) number_of = int(scene%bodies%id(body))
  end function number_of

  !> Are the energies finite, and does their balance close? Checked where measures are taken.
  subroutine judge_energy(measures, options, step, has_warned, warning, error)
    type(measures_t), intent(in) :: measures !! measures after the step, of the whole scene
    type(guard_options_t), intent(in) :: options !! tolerance, and whether the run ends
    integer, intent(in) :: step !! number of the step
    logical, intent(in) :: has_warned !! was a warning given before, or is none wanted?
    character(len=:), allocatable, intent(out) :: warning !! sentence to print; empty where there is none
    type(error_t), allocatable, intent(out) :: error !! set when the run must end
    character(len=:), allocatable :: sentence
    integer :: i

    warning = ''
    do i = 1, size(energies)
      if (abs(measures%get(trim(energies(i)))) <= huge(1.0_wp)) cycle
      call fail(error, 'step '//to_text(step)//': '//trim(energies(i))//' is not finite', code=exit_broken)
      return
    end do
    if (options%energy == 'ignore' .or. measures%get('energy_closure') <= options%energy_tolerance) return
    sentence = 'step '//to_text(step)//': the energy balance is open by '//to_text(measures%get('energy_closure'), 2)// &
               ' of its largest term, more than guard.energy_tolerance = '//to_text(options%energy_tolerance, 2)
    if (options%energy == 'stop') then
      call fail(error, sentence, code=exit_unbalanced)
    else if (.not. has_warned) then
      warning = sentence
    end if
  end subroutine judge_energy
end module sg_guard
