!> `splitgrain study`, `look`, `movie`, `convex`, and `convert` of a DATBOX with a script: the Python package, which draws results,
!! runs studies through this program, divides meshes and reads scripts.
module sg_python_command
  use sg_arguments, only: arguments_t
  use sg_error, only: error_t, exit_failure, fail
  use sg_python_tasks, only: script_of
  use sg_system, only: become
  use sg_version, only: source_folder
  implicit none
  private
  public :: python_command

  !> How Python finds the package: beside the installed program, beside the source, or where it looks by itself
  character(len=*), parameter :: look_for_package = &
    'import os, sys; from importlib.util import find_spec as find; program, source = sys.argv[1:3]; '// &
    'above = os.path.dirname(os.path.dirname(os.path.realpath(program))); '// &
    'places = [os.path.join(above, "share", "splitgrain", "postpro"), os.path.join(source, "postpro")]; '// &
    'sys.path[:0] = [p for p in places if os.path.isfile(os.path.join(p, "splitgrain_postpro", "cli.py"))][:1]; '
  !> Python ends well when it is new enough and finds the package and what that needs
  character(len=*), parameter :: is_fit = &
    'sys.exit(sys.version_info < (3, 11) or not all(map(find, ("splitgrain_postpro", "h5py", "matplotlib", "numpy")'// &
    '[:1 if sys.argv[3] == "convert" else 4])))'
  character(len=*), parameter :: go_on = 'from splitgrain_postpro.cli import main; sys.exit(main(sys.argv[3:]))'

  !> The shell finds a fit Python and becomes it; $0 is this program. Python (3.11 or later) must not import what lies in the
  !! current folder: -P.
  character(len=*), parameter :: script = &
    'source=$1; shift; program=$(command -v -- "$0"); for python in python3 /usr/bin/python3; do '// &
    '"$python" -P -c '''//look_for_package//is_fit//''' "$program" "$source" "$1" 2>/dev/null || continue; '// &
    'export SPLITGRAIN_PROGRAM="${SPLITGRAIN_PROGRAM:-$program}"; '// &
    'exec "$python" -P -c '''//look_for_package//go_on//''' "$program" "$source" "$@"; done; '// &
    'echo "error: this command needs Python 3.11 or later with h5py, matplotlib, numpy and splitgrain_postpro (the folder '// &
    'postpro of the source), and none was found" >&2; '// &
    '[ "$1" != convert ] || echo "--script none converts the folder without its script" >&2; exit 1'

contains

  !> Go on as the Python package, with the words of the command line; it comes back only when no shell can be started.
  subroutine python_command(arguments, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(error_t), allocatable, intent(out) :: error !! set when no shell can be started
    character(len=:), allocatable :: words(:), found
    integer :: i, first, length, longest, more

    ! The commands of `look` are those of the package; a script that was found is one that was given.
    first = merge(2, 1, arguments%command == 'look')
    found = ''
    if (arguments%command == 'convert' .and. .not. arguments%has('script')) found = '--script='//script_of(arguments)
    more = merge(1, 0, len(found) > 0)
    longest = max(len(script), len(source_folder), len(found))
    do i = 0, command_argument_count()
      call get_command_argument(i, length=length)
      longest = max(longest, length)
    end do
    allocate (character(len=longest) :: words(command_argument_count() + 6 - first + more))
    words(1) = '/bin/sh'
    words(2) = '-c'
    words(3) = script
    call get_command_argument(0, words(4))
    words(5) = source_folder
    do i = first, command_argument_count()
      call get_command_argument(i, words(6 - first + i))
    end do
    if (more > 0) words(size(words)) = found
    call become(words)
    call fail(error, 'no shell, /bin/sh, can be started, which this command needs', code=exit_failure)
  end subroutine python_command
end module sg_python_command
