!> Communication of a build without MPI: there is one rank.
submodule(sg_ranks) ranks_without_mpi
  implicit none

contains

  module procedure ranks_start
  self%rank = 0
  self%size = 1
  end procedure ranks_start

  module procedure ranks_finish
  self%size = 1
  end procedure ranks_finish

  module procedure ranks_library
  name = ''
  end procedure ranks_library

  module procedure ranks_handle
  handle = 0
  end procedure ranks_handle

  module procedure ranks_no_hints
  handle = 0
  end procedure ranks_no_hints

  module procedure ranks_here
  ranks_here = 1
  end procedure ranks_here

  module procedure reduced_integers
  reduced = values
  end procedure reduced_integers

  module procedure reduced_longs
  reduced = values
  end procedure reduced_longs

  module procedure reduced_reals
  reduced = values
  end procedure reduced_reals

  module procedure bytes_of_root
  bytes = own
  end procedure bytes_of_root

  module procedure bytes_side_by_side
  bytes = own
  end procedure bytes_side_by_side

  module procedure ranks_begin_sum
  if (allocated(self%pending(which)%receiving)) deallocate (self%pending(which)%receiving)
  allocate (self%pending(which)%receiving, source=values)
  end procedure ranks_begin_sum

  module procedure ranks_finish_sum
  values = self%pending(which)%receiving
  end procedure ranks_finish_sum

  module procedure ranks_swap
  allocate (receive_count(0:0))
  receive_count = send_count(0:0)
  receive = send
  end procedure ranks_swap
end submodule ranks_without_mpi
