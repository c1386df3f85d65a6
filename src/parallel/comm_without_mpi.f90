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

  module procedure comm_handle
  handle = 0
  end procedure comm_handle

  module procedure comm_no_hints
  handle = 0
  end procedure comm_no_hints

  module procedure comm_sum
  end procedure comm_sum

  module procedure comm_maximum
  end procedure comm_maximum

  module procedure comm_minimum
  end procedure comm_minimum

  module procedure comm_ranks_here
  comm_ranks_here = 1
  end procedure comm_ranks_here

  module procedure comm_any
  comm_any = is_so
  end procedure comm_any

  module procedure comm_agree
  speaker = merge(0, -1, allocated(error))
  end procedure comm_agree

  module procedure comm_begin_sum
  if (allocated(self%receiving)) deallocate (self%receiving)
  self%receiving = values
  end procedure comm_begin_sum

  module procedure comm_finish_sum
  values = self%receiving
  end procedure comm_finish_sum

  module procedure comm_gather
  allocate (all(size(own), 1))
  all(:, 1) = own
  end procedure comm_gather

  module procedure comm_before
  before = 0
  total = own
  end procedure comm_before

  module procedure comm_swap
  allocate (receive_count(0:0))
  receive_count = send_count(0:0)
  receive = send
  end procedure comm_swap
end submodule comm_without_mpi
