!> Whether this program was built with OpenMP, by which threads share the work of a process. Files with OpenMP's directives are
!! named in cmake/libraries.cmake; without it the directives are comments.
module sg_threads
  implicit none
  private
  public :: threads_are_available

contains

  !> Can this program use more than one thread?
  pure logical function threads_are_available() result(is_available)
    is_available = .false.
    !$ is_available = .true.
  end function threads_are_available
end module sg_threads
