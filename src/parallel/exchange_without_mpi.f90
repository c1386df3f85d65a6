!> Exchange of a build without MPI: there are no neighbours.
submodule(sg_exchange) exchange_without_mpi
  implicit none

contains

  module procedure exchange_prepare
  call self%release()
  allocate (self%rank(0), self%send_first(1), self%receive_first(1), source=1)
  allocate (self%send(width, 0), self%receive(width, 0))
  end procedure exchange_prepare

  module procedure exchange_begin
  end procedure exchange_begin

  module procedure exchange_finish
  end procedure exchange_finish

  module procedure exchange_release
  if (allocated(self%rank)) deallocate (self%rank, self%send_first, self%receive_first, self%send, self%receive)
  end procedure exchange_release
end submodule exchange_without_mpi
