!> Which command lines are for the Python package: studies, drawing, and DATBOX folders with a script.
module sg_python_tasks
  use sg_arguments, only: arguments_t
  use sg_system, only: file_exists
  implicit none
  private
  public :: is_deck, is_in_python, script_of

contains

  !> Is this command one of the Python package? Help without anything to help on is printed here.
  logical function is_in_python(arguments)
    type(arguments_t), intent(in) :: arguments !! the command line

    select case (arguments%command)
    case ('study', 'convex')
      is_in_python = arguments%task() /= '--help'
    case ('look')
      is_in_python = size(arguments%words) > 0
    case ('movie')
      is_in_python = .true.
    case ('convert')
      is_in_python = arguments%task() /= '--help' .and. len(script_of(arguments)) > 0
    case default
      is_in_python = .false.
    end select
  end function is_in_python

  !> Script of LMGC90 to read with a DATBOX that becomes a deck: that of --script, or command.py next to the folder; empty for none.
  function script_of(arguments) result(file)
    type(arguments_t), intent(in) :: arguments !! the command line
    character(len=:), allocatable :: file, folder

    file = ''
    if (size(arguments%words) /= 2) return
    if (is_deck(arguments%words(1)%s) .or. .not. is_deck(arguments%words(2)%s)) return
    folder = arguments%words(1)%s
    folder = folder(:verify(folder, '/', back=.true.))
    folder = folder(:index(folder, '/', back=.true.))
    if (file_exists(folder//'command.py')) file = folder//'command.py'
    file = arguments%get('script', file)
    if (file == 'none') file = ''
  end function script_of

  !> Is this the name of a deck?
  pure logical function is_deck(name)
    character(len=*), intent(in) :: name !! path on the command line

    is_deck = index(name, '.toml', back=.true.) == len(name) - 4 .and. len(name) > 5
  end function is_deck
end module sg_python_tasks
