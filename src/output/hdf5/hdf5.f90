!> HDF5 files through few operations, so that one submodule alone names the library.
!!
!! A file remembers its first failure in `error` and does nothing from then on: a writer makes all its calls
!! and looks once, at the end. Shapes are those of Fortran: `values(component, row)` is `[row][component]` in the
!! file, without a transpose. The bodies live in `hdf5_with_hdf5` or `hdf5_without_hdf5`, chosen by CMake.
!!
!! Ranks share a file that they make or open together. Then all of them make all calls, in the same order; each stores its
!! own rows, which follow those of lower ranks, or all have the same ones (`is_common`), which are stored once. A
!! failure of one is a failure of all. Where ranks are subdomains of a process, the first one of each process writes for all of
!! them, and all read through its handle: with one process the serial library is enough.
module sg_hdf5
  use sg_comm, only: comm_t, traffic_t
  use sg_error, only: error_t
  use sg_kinds, only: i1, i4, i8, wp
  use sg_text, only: text_t
  implicit none
  private
  public :: hdf5_file_t, hdf5_is_available, hdf5_is_parallel
  public :: stored_double, stored_single, stored_long, stored_integer, stored_byte

  !> How numbers of a growing dataset are stored: real of 8 and 4 bytes, integer of 8 and 4 bytes, unsigned byte
  integer, parameter :: stored_double = 1, stored_single = 2, stored_long = 3, stored_integer = 4, stored_byte = 5

  !> An open file
  type :: hdf5_file_t
    !> Path of the file
    character(len=:), allocatable :: name
    !> First failure since it was opened; unallocated while all is well
    type(error_t), allocatable :: error
    !> The ranks that share it, and their traffic by it so far; one rank where it is not shared
    type(comm_t) :: ranks
    !> Handle of the library; negative when closed
    integer(i8) :: id = -1
    !> Does each dataset that is `put` carry check sums, so that no damage to it is read as a number?
    logical, private :: is_checked = .false.
    !> Of a shared file: bytes that it may have by now, and for which the disk has promised room
    integer(i8), private :: most_bytes = 0, reserved = 0
  contains
    procedure :: share => file_share
    procedure :: create => file_create
    procedure :: open => file_open
    procedure :: flush => file_flush
    procedure :: rename => file_rename
    procedure :: close => file_close
    procedure :: group => file_group
    procedure :: has => file_has
    procedure :: names => file_names
    procedure :: remove => file_remove
    procedure :: take => file_take
    procedure :: declare => file_declare
    procedure :: declare_grid => file_declare_grid
    procedure :: put_grid => file_put_grid
    procedure :: rows => file_rows
    procedure :: shape => file_shape
    procedure :: cut => file_cut
    procedure, private :: append_reals, append_real_records, append_integers, append_longs
    procedure, private :: put_reals, put_real_records, put_integers, put_integer_records, put_text
    procedure :: total => file_total
    procedure :: get_rows => file_get_rows
    procedure, private :: get_reals, get_real_records, get_integers, get_longs
    procedure, private :: set_long, set_longs, set_reals, set_text
    procedure, private :: look_long, look_text
    !> Add rows to a growing dataset
    generic :: append => append_reals, append_real_records, append_integers, append_longs
    !> Make a dataset of fixed size and fill it
    generic :: put => put_reals, put_real_records, put_integers, put_integer_records, put_text
    !> Read a whole dataset
    generic :: get => get_reals, get_real_records, get_integers, get_longs
    !> Set an attribute, in place when it exists
    generic :: set => set_long, set_longs, set_reals, set_text
    !> Read an attribute
    generic :: look => look_long, look_text
  end type hdf5_file_t

  interface
    !> Was the program built with HDF5?
    module function hdf5_is_available() result(is_available)
      logical :: is_available
    end function hdf5_is_available

    !> Can ranks share files?
    module function hdf5_is_parallel() result(is_parallel)
      logical :: is_parallel
    end function hdf5_is_parallel

    !> Make a file; an old one of the same name is replaced.
    module subroutine file_create(self, name, is_checked, is_in_memory)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: name !! path
      logical, intent(in), optional :: is_checked !! with check sums over all that it holds, false unless given
      logical, intent(in), optional :: is_in_memory !! not shared, held in memory and written when it is closed? False unless given
    end subroutine file_create

    !> Open a file that exists.
    module subroutine file_open(self, name, is_read_only)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: name !! path
      logical, intent(in) :: is_read_only !! open for reading alone?
    end subroutine file_open

    !> Hand all that was written to the operating system.
    module subroutine file_flush(self)
      class(hdf5_file_t), intent(inout) :: self
    end subroutine file_flush

    !> Give an open file its name, when all that it is to hold by now was handed to the operating system.
    module subroutine file_rename(self, name)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: name !! path in the same folder; what stands there is replaced
    end subroutine file_rename

    !> Close the file, also after a failure.
    module subroutine file_close(self)
      class(hdf5_file_t), intent(inout) :: self
    end subroutine file_close

    !> Make a group; its parent exists.
    module subroutine file_group(self, path)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
    end subroutine file_group

    !> Does a group or dataset of this path exist? Its parent must.
    module function file_has(self, path) result(has)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      logical :: has
    end function file_has

    !> Names of all that a group holds, in the order of the alphabet.
    module subroutine file_names(self, path, names)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! group within the file
      type(text_t), allocatable, intent(out) :: names(:) !! names without the group's path; none after a failure
    end subroutine file_names

    !> Remove a group with all it holds, or a dataset.
    module subroutine file_remove(self, path)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
    end subroutine file_remove

    !> Copy all that another file holds, except one object of its root, into a new file; neither is shared by ranks.
    module subroutine file_take(self, source, except)
      class(hdf5_file_t), intent(inout) :: self !! file in memory
      class(hdf5_file_t), intent(inout) :: source !! open file
      character(len=*), intent(in) :: except !! name that is left out, without a slash; it need not be there
    end subroutine file_take

    !> Make a growing dataset without rows.
    module subroutine file_declare(self, path, storage, components, chunk, is_compressed)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer, intent(in) :: storage !! one of `stored_*`
      integer, intent(in) :: components !! numbers of a row; 0 for a plain list
      integer, intent(in) :: chunk !! rows that are stored together
      logical, intent(in) :: is_compressed !! compress chunks by gzip? Ranks that share a file do not
    end subroutine file_declare

    !> Make a dataset that grows by a grid per step, of a file that is not shared.
    module subroutine file_declare_grid(self, path, storage, extents)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer, intent(in) :: storage !! `stored_double` or `stored_single`
      integer, intent(in) :: extents(:) !! of a grid, the axis of neighbours in memory first
    end subroutine file_declare_grid

    !> Write a grid of such a dataset, which grows where it must.
    module subroutine file_put_grid(self, path, grid, values)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i8), intent(in) :: grid !! grids before it
      real(wp), intent(in), contiguous, target :: values(:) !! as many numbers as a grid has
    end subroutine file_put_grid

    !> Rows of all ranks together, from those of each; of a file that is not shared those given.
    module function file_total(self, rows) result(total)
      class(hdf5_file_t), intent(inout) :: self
      integer, intent(in) :: rows !! rows of this rank
      integer(i8) :: total
    end function file_total

    !> Read some rows of records, or of a list as records of one component; whole numbers are read as reals.
    module subroutine file_get_rows(self, path, first, rows, values)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i8), intent(in) :: first !! rows before them
      integer, intent(in) :: rows !! how many
      real(wp), allocatable, intent(out), target :: values(:, :) !! records read, shape (components, rows)
    end subroutine file_get_rows

    !> Number of rows of a dataset.
    module function file_rows(self, path) result(rows)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i8) :: rows
    end function file_rows

    !> Components and rows of a dataset; zeros after a failure, of which a missing dataset is one.
    module function file_shape(self, path) result(numbers)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i8) :: numbers(2)
    end function file_shape

    !> Drop the rows of a growing dataset beyond the first `rows`.
    module subroutine file_cut(self, path, rows)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i8), intent(in) :: rows !! rows to keep
    end subroutine file_cut

    !> Add reals to a list.
    module subroutine append_reals(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      real(wp), intent(in), contiguous, target :: values(:) !! numbers to add
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine append_reals

    !> Add records of reals.
    module subroutine append_real_records(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      real(wp), intent(in), contiguous, target :: values(:, :) !! records to add, shape (components, rows)
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine append_real_records

    !> Add integers to a list.
    module subroutine append_integers(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i4), intent(in), contiguous, target :: values(:) !! numbers to add
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine append_integers

    !> Add long integers to a list.
    module subroutine append_longs(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i8), intent(in), contiguous, target :: values(:) !! numbers to add
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine append_longs

    !> Store a list of reals.
    module subroutine put_reals(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      real(wp), intent(in), contiguous, target :: values(:) !! numbers to store
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine put_reals

    !> Store records of reals.
    module subroutine put_real_records(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      real(wp), intent(in), contiguous, target :: values(:, :) !! records to store
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine put_real_records

    !> Store a list of integers.
    module subroutine put_integers(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i4), intent(in), contiguous, target :: values(:) !! numbers to store
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine put_integers

    !> Store records of integers.
    module subroutine put_integer_records(self, path, values, is_common)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i4), intent(in), contiguous, target :: values(:, :) !! records to store
      logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?
    end subroutine put_integer_records

    !> Store a text as one item of fixed length, with the zero byte that ends texts in C.
    module subroutine put_text(self, path, text)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      character(len=*), intent(in) :: text !! text to store
    end subroutine put_text

    !> Read a list of reals; empty after a failure, as with all readers here.
    module subroutine get_reals(self, path, values)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      real(wp), allocatable, intent(out), target :: values(:) !! numbers read
    end subroutine get_reals

    !> Read records of reals.
    module subroutine get_real_records(self, path, values)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      real(wp), allocatable, intent(out), target :: values(:, :) !! records read
    end subroutine get_real_records

    !> Read a list of integers.
    module subroutine get_integers(self, path, values)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i4), allocatable, intent(out), target :: values(:) !! numbers read
    end subroutine get_integers

    !> Read a list of long integers; records of one component count as a list.
    module subroutine get_longs(self, path, values)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! path within the file
      integer(i8), allocatable, intent(out), target :: values(:) !! numbers read
    end subroutine get_longs

    !> Set an attribute to one long integer.
    module subroutine set_long(self, path, name, value)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! object that has the attribute
      character(len=*), intent(in) :: name !! of the attribute
      integer(i8), intent(in) :: value !! its new value
    end subroutine set_long

    !> Set an attribute to a list of long integers.
    module subroutine set_longs(self, path, name, value)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! object that has the attribute
      character(len=*), intent(in) :: name !! of the attribute
      integer(i8), intent(in) :: value(:) !! its new value
    end subroutine set_longs

    !> Set an attribute, one that does not exist, of a file that is not shared, to a list of reals.
    module subroutine set_reals(self, path, name, value)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! object that has the attribute
      character(len=*), intent(in) :: name !! of the attribute
      real(wp), intent(in) :: value(:) !! its value
    end subroutine set_reals

    !> Set an attribute to a text, stored with fixed length.
    module subroutine set_text(self, path, name, value)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! object that has the attribute
      character(len=*), intent(in) :: name !! of the attribute
      character(len=*), intent(in) :: value !! its new value
    end subroutine set_text

    !> Read an attribute that is one long integer; 0 after a failure.
    module subroutine look_long(self, path, name, value)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! object that has the attribute
      character(len=*), intent(in) :: name !! of the attribute
      integer(i8), intent(out) :: value !! its value
    end subroutine look_long

    !> Read an attribute that is a text of fixed length; empty after a failure.
    module subroutine look_text(self, path, name, value)
      class(hdf5_file_t), intent(inout) :: self
      character(len=*), intent(in) :: path !! object that has the attribute
      character(len=*), intent(in) :: name !! of the attribute
      character(len=:), allocatable, intent(out) :: value !! its value
    end subroutine look_text
  end interface

contains

  !> Share the file between ranks, from when it is made or opened next.
  subroutine file_share(self, comm)
    class(hdf5_file_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the ranks

    self%ranks = comm
    self%ranks%traffic = traffic_t()
  end subroutine file_share
end module sg_hdf5
