!> Communication by MPI: the only file that names it.
submodule(sg_comm) comm_with_mpi
  use mpi_f08, only: mpi_abort, mpi_comm_rank, mpi_comm_size, mpi_comm_world, mpi_finalize, mpi_get_library_version, &
                     mpi_init, mpi_initialized, mpi_max_library_version_string
  use sg_system, only: end_program
  implicit none

contains

  module procedure comm_start
  if (.not. was_launched()) return
  call mpi_init()
  call mpi_comm_rank(mpi_comm_world, self%rank)
  call mpi_comm_size(mpi_comm_world, self%size)
  end procedure comm_start

  !> Was this process started by an MPI launcher? Starting MPI costs a second that a single process need not pay.
  logical function was_launched()
    character(len=*), parameter :: marks(4) = [character(len=24) :: 'OMPI_COMM_WORLD_SIZE', 'PMI_SIZE', 'PMIX_RANK', &
                                               'MV2_COMM_WORLD_SIZE']
    integer :: i, length

    was_launched = .false.
    do i = 1, size(marks)
      call get_environment_variable(trim(marks(i)), length=length)
      was_launched = was_launched .or. length > 0
    end do
  end function was_launched

  module procedure comm_finish
  logical :: started

  call mpi_initialized(started)
  if (started) call mpi_finalize()
  self%size = 1
  end procedure comm_finish

  module procedure comm_abort
  logical :: started

  call mpi_initialized(started)
  if (started .and. self%size > 1) call mpi_abort(mpi_comm_world, code)
  call comm_finish(self)
  call end_program(code)
  end procedure comm_abort

  module procedure comm_library
  character(len=mpi_max_library_version_string) :: version
  integer :: length

  call mpi_get_library_version(version, length)
  name = version(:length)
  if (index(name, ',') > 1) name = name(:index(name, ',') - 1)
  end procedure comm_library
end submodule comm_with_mpi
