!> Exchange of a build without MPI: there are no messages between processes.
submodule(sg_exchange) exchange_without_mpi
  implicit none

contains

  module procedure open_messages
  end procedure open_messages

  module procedure start_messages
  end procedure start_messages

  module procedure finish_messages
  have_come = .true.
  end procedure finish_messages

  module procedure close_messages
  end procedure close_messages
end submodule exchange_without_mpi
