!> Text of `--version`: commit, compiler, flags and libraries of this build.
module sg_print_version
  use, intrinsic :: iso_fortran_env, only: compiler_version
  use sg_comm, only: comm_t
  use sg_convex_hull, only: hull_is_available
  use sg_eigenvalues, only: eigenvalues_are_available
  use sg_fourier, only: fourier_is_available
  use sg_graph_split, only: graph_splits
  use sg_hdf5, only: hdf5_is_available
  use sg_print, only: print_line
  use sg_sparse_factor, only: has_sparse_library
  use sg_version, only: commit, compiler_flags, version
  implicit none
  private
  public :: print_version

contains

  !> Print version, commit, compiler, flags and libraries.
  subroutine print_version()
    character(len=*), parameter :: nl = new_line('a')
    type(comm_t) :: comm
    character(len=:), allocatable :: library

    library = comm%library()
    if (len(library) == 0) library = 'off'
    call print_line('splitgrain '//version//nl//'commit    '//commit//nl//'compiler  '//compiler_version()//nl// &
      'flags     '//compiler_flags//nl//'MPI       '//library//nl//'HDF5      '//on_or_off(hdf5_is_available())//nl// &
      'METIS     '//on_or_off(graph_splits())//nl//'FFTW      '//on_or_off(fourier_is_available())//nl// &
      'UMFPACK   '//on_or_off(has_sparse_library())//nl//'Qhull     '//on_or_off(hull_is_available())//nl// &
      'LAPACK    '//on_or_off(eigenvalues_are_available()))
  end subroutine print_version

  !> Is a library in?
  pure function on_or_off(is_on) result(word)
    logical, intent(in) :: is_on
    character(len=:), allocatable :: word

    word = trim(merge('on ', 'off', is_on))
  end function on_or_off
end module sg_print_version
