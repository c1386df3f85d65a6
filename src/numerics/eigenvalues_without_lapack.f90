!> A build without eigenvalues.
submodule(sg_eigenvalues) eigenvalues_without_lapack
  use sg_error, only: fail
  implicit none

contains

  module procedure eigenvalues_are_available
  are_available = .false.
  end procedure eigenvalues_are_available

  module procedure find_eigenvalues
  values = 0
  call fail(error, 'this program was built without LAPACK, which eigenvalues need')
  end procedure find_eigenvalues
end submodule eigenvalues_without_lapack
