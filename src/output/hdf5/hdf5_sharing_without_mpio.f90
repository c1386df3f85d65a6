!> An HDF5 that was not made for MPI: ranks share no files.
submodule(sg_hdf5:hdf5_with_hdf5) hdf5_sharing_without_mpio
  implicit none

contains

  module procedure is_shareable
  is_so = .false.
  end procedure is_shareable

  module procedure share_access
  call note(self, 'this program was built with an HDF5 that was not made for MPI: several ranks cannot write one file')
  end procedure share_access

  module procedure share_transfer
  end procedure share_transfer

  module procedure reserve_room
  end procedure reserve_room

  module procedure release_room
  end procedure release_room
end submodule hdf5_sharing_without_mpio
