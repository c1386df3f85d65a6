!> A build without HDF5: opening a file is one clear error, and all else does nothing.
submodule(sg_hdf5) hdf5_without_hdf5
  use sg_error, only: exit_output, fail
  implicit none

contains

  module procedure hdf5_is_available
  is_available = .false.
  end procedure hdf5_is_available

  module procedure hdf5_is_parallel
  is_parallel = .false.
  end procedure hdf5_is_parallel

  module procedure file_create
  call refuse(self, name)
  end procedure file_create

  module procedure file_open
  call refuse(self, name)
  end procedure file_open

  !> Report why there are no files of this kind.
  subroutine refuse(self, name)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name

    self%name = name
    call fail(self%error, 'this program was built without HDF5, which pictures, restart files and files of contact problems '// &
              'need', file=name, code=exit_output)
  end subroutine refuse

  module procedure file_flush
  end procedure file_flush

  module procedure file_rename
  end procedure file_rename

  module procedure file_close
  end procedure file_close

  module procedure file_group
  end procedure file_group

  module procedure file_has
  has = .false.
  end procedure file_has

  module procedure file_names
  allocate (names(0))
  end procedure file_names

  module procedure file_remove
  end procedure file_remove

  module procedure file_take
  end procedure file_take

  module procedure file_declare
  end procedure file_declare

  module procedure file_total
  total = int(rows, i8)
  end procedure file_total

  module procedure file_get_rows
  allocate (values(0, 0))
  end procedure file_get_rows

  module procedure file_rows
  rows = 0
  end procedure file_rows

  module procedure file_shape
  numbers = 0
  end procedure file_shape

  module procedure file_cut
  end procedure file_cut

  module procedure append_reals
  end procedure append_reals

  module procedure append_real_records
  end procedure append_real_records

  module procedure append_integers
  end procedure append_integers

  module procedure append_longs
  end procedure append_longs

  module procedure file_declare_grid
  end procedure file_declare_grid

  module procedure file_put_grid
  end procedure file_put_grid

  module procedure set_reals
  end procedure set_reals

  module procedure put_reals
  end procedure put_reals

  module procedure put_real_records
  end procedure put_real_records

  module procedure put_integers
  end procedure put_integers

  module procedure put_integer_records
  end procedure put_integer_records

  module procedure put_text
  end procedure put_text

  module procedure get_reals
  allocate (values(0))
  end procedure get_reals

  module procedure get_real_records
  allocate (values(0, 0))
  end procedure get_real_records

  module procedure get_integers
  allocate (values(0))
  end procedure get_integers

  module procedure get_longs
  allocate (values(0))
  end procedure get_longs

  module procedure set_long
  end procedure set_long

  module procedure set_longs
  end procedure set_longs

  module procedure set_text
  end procedure set_text

  module procedure look_long
  value = 0
  end procedure look_long

  module procedure look_text
  value = ''
  end procedure look_text
end submodule hdf5_without_hdf5
