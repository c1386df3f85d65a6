!> Communication of a build without MPI: there is one rank.
submodule(sg_comm) comm_without_mpi
  use sg_system, only: end_program
  implicit none

contains

  module procedure comm_start
  self%rank = 0
  self%size = 1
  end procedure comm_start

  module procedure comm_finish
  self%size = 1
  end procedure comm_finish

  module procedure comm_abort
  self%size = 1
  call end_program(code)
  end procedure comm_abort

  module procedure comm_library
  name = ''
  end procedure comm_library
end submodule comm_without_mpi
