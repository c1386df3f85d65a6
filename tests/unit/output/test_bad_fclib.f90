!> Bad FCLIB files: each gives one clear sentence that names the file and what is wrong in it.
program test_bad_fclib
  use harness, only: tests_t
  use, intrinsic :: ieee_arithmetic, only: ieee_negative_inf, ieee_positive_inf, ieee_quiet_nan, ieee_value
  use matrices, only: columns, put_global, put_local, put_matrix, rows, triplets
  use sg_error, only: error_t, exit_bad_input
  use sg_fclib_read, only: read_fclib
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_system, only: make_folder, remove_file
  implicit none
  character(len=*), parameter :: name = 'bad/bad.hdf5'
  type(tests_t) :: t
  real(wp) :: bad

  call t%check(make_folder('bad'), 'the folder is there')
  if (hdf5_is_available()) then
    call test_files()
    call test_groups()
    call test_local()
    call test_numbers()
    call test_storages()
    call test_global()
    call test_guess()
  else
    write (*, '(a)') 'built without HDF5: the files themselves are not tested'
  end if
  call t%finish()

contains

  !> The file must be refused in words that hold this.
  subroutine expect(said)
    character(len=*), intent(in) :: said

    call expect_with(said, .false.)
  end subroutine expect

  !> The file, read with its guess or without, must be refused in words that hold this.
  subroutine expect_with(said, with_guess)
    character(len=*), intent(in) :: said
    logical, intent(in) :: with_guess
    type(matrix_problem_t) :: problem
    type(error_t), allocatable :: error
    logical :: has_guess

    call read_fclib(name, with_guess, problem, has_guess, error)
    call t%check(allocated(error), 'refused: '//said)
    if (.not. allocated(error)) return
    call t%check(index(error%message, said) > 0, 'said "'//error%message//'", expected "'//said//'"')
    call t%check(error%code == exit_bad_input .and. error%file == name, 'bad input, and the file is named: '//said)
    call t%check(index(error%message, new_line('a')) == 0, 'one line: '//said)
  end subroutine expect_with

  !> Begin a file with a good local problem of one contact in the plane.
  subroutine begin_local(file)
    type(hdf5_file_t), intent(inout) :: file

    call file%create(name)
    call put_local(file, 2, reshape([2.0_wp, 1.0_wp, 1.0_wp, 2.0_wp], [2, 2]), [-1.0_wp, 0.5_wp], [0.3_wp], triplets)
  end subroutine begin_local

  !> Replace reals of a good local problem.
  subroutine spoil_reals(path, values, said)
    character(len=*), intent(in) :: path, said
    real(wp), intent(in) :: values(:)
    type(hdf5_file_t) :: file

    call begin_local(file)
    call file%remove(path)
    call file%put(path, values)
    call file%close()
    call t%check(.not. allocated(file%error), 'the file could be made: '//said)
    call expect(said)
  end subroutine spoil_reals

  !> Replace whole numbers of a good local problem.
  subroutine spoil_integers(path, values, said)
    character(len=*), intent(in) :: path, said
    integer, intent(in) :: values(:)
    type(hdf5_file_t) :: file

    call begin_local(file)
    call file%remove(path)
    call file%put(path, int(values, i4))
    call file%close()
    call t%check(.not. allocated(file%error), 'the file could be made: '//said)
    call expect(said)
  end subroutine spoil_integers

  !> Remove something of a good local problem.
  subroutine spoil_by_removing(path, said)
    character(len=*), intent(in) :: path, said
    type(hdf5_file_t) :: file

    call begin_local(file)
    call file%remove(path)
    call file%close()
    call expect(said)
  end subroutine spoil_by_removing

  !> No file, no HDF5, half a file.
  subroutine test_files()
    type(hdf5_file_t) :: file
    integer :: unit, length
    character(len=:), allocatable :: bytes

    call remove_file(name)
    call expect('there is no such file')
    open (newunit=unit, file=name, action='write')
    write (unit, '(a)') 'dim = 3'
    close (unit)
    call expect('this is no HDF5 file')
    open (newunit=unit, file=name, action='write', status='replace')
    close (unit)
    call expect('this is no HDF5 file')
    call begin_local(file)
    call file%put('/more', spread(1.0_wp, 1, 500))
    call file%close()
    open (newunit=unit, file=name, action='read', access='stream', form='unformatted')
    inquire (unit, size=length)
    allocate (character(len=length/2) :: bytes)
    read (unit) bytes
    close (unit)
    open (newunit=unit, file=name, action='write', access='stream', form='unformatted', status='replace')
    write (unit) bytes
    close (unit)
    call expect('the file is truncated')
  end subroutine test_files

  !> No problem, two problems, problems of another kind.
  subroutine test_groups()
    type(hdf5_file_t) :: file

    call file%create(name)
    call file%close()
    call expect('holds nothing')
    call file%create(name)
    call file%group('/solution')
    call file%close()
    call expect('no contact problem, neither /fclib_local nor /fclib_global, but solution')
    call begin_local(file)
    call file%group('/fclib_global')
    call file%close()
    call expect('two problems')
    call file%create(name)
    call file%group('/fclib_global_rolling')
    call file%close()
    call expect('/fclib_global_rolling is of a kind (rolling friction)')
    call file%create(name)
    call file%put('/fclib_local', [1.0_wp])
    call file%close()
    call expect('/fclib_local/spacedim is missing')
  end subroutine test_groups

  !> What a local problem must have, and of which size.
  subroutine test_local()
    type(hdf5_file_t) :: file

    call spoil_by_removing('/fclib_local/spacedim', '/fclib_local/spacedim is missing')
    call spoil_by_removing('/fclib_local/vectors', '/fclib_local/vectors/q is missing')
    call spoil_by_removing('/fclib_local/vectors/q', '/fclib_local/vectors/q is missing')
    call spoil_by_removing('/fclib_local/vectors/mu', '/fclib_local/vectors/mu is missing')
    call spoil_by_removing('/fclib_local/W', '/fclib_local/W is missing')
    call spoil_by_removing('/fclib_local/W/m', '/fclib_local/W/m is missing')
    call spoil_by_removing('/fclib_local/W/nz', '/fclib_local/W/nz is missing')
    call spoil_by_removing('/fclib_local/W/i', '/fclib_local/W/i is missing')
    call spoil_by_removing('/fclib_local/W/p', '/fclib_local/W/p is missing')
    call spoil_by_removing('/fclib_local/W/x', '/fclib_local/W/x')
    call spoil_integers('/fclib_local/spacedim', [4], '/fclib_local/spacedim is 4, not 2 or 3')
    call spoil_integers('/fclib_local/spacedim', [-2], '/fclib_local/spacedim is -2, not 2 or 3')
    call spoil_integers('/fclib_local/spacedim', [2, 2], '/fclib_local/spacedim has 2 entries, not one')
    call spoil_integers('/fclib_local/spacedim', [3], '/fclib_local/vectors/q has 2 entries, not a multiple of spacedim, 3')
    call spoil_reals('/fclib_local/vectors/q', [1.0_wp], '/fclib_local/vectors/q has 1 entries, not a multiple of spacedim, 2')
    call spoil_reals('/fclib_local/vectors/q', [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp], '/fclib_local/vectors/mu has 1 entries, not 2')
    call spoil_reals('/fclib_local/vectors/mu', [1.0_wp, 2.0_wp], '/fclib_local/vectors/mu has 2 entries, not 1')
    call spoil_integers('/fclib_local/W/m', [3], '/fclib_local/W is 3 by 2, where the rest of the file needs 2 rows and 2 columns')
    call spoil_integers('/fclib_local/W/n', [-1], '/fclib_local/W is 2 by -1')
    call begin_local(file)
    call file%remove('/fclib_local/vectors/q')
    call file%put('/fclib_local/vectors/q', 'a text')
    call file%close()
    call expect('/fclib_local/vectors/q')
    call begin_local(file)
    call put_matrix(file, '/fclib_local/R', reshape([1.0_wp], [1, 1]), triplets)
    call file%close()
    call expect('one of V and R without the other')
    call begin_local(file)
    call put_matrix(file, '/fclib_local/V', reshape([1.0_wp, 0.0_wp], [2, 1]), triplets)
    call put_matrix(file, '/fclib_local/R', reshape([0.0_wp], [1, 1]), triplets)
    call file%close()
    call expect('/fclib_local/vectors/s is missing')
    call file%open(name, .false.)
    call file%put('/fclib_local/vectors/s', [1.0_wp])
    call file%close()
    call expect('the matrix R of the constraints is singular')
  end subroutine test_local

  !> Numbers that are no numbers.
  subroutine test_numbers()
    integer :: i

    do i = 1, 3
      bad = ieee_value(1.0_wp, ieee_quiet_nan)
      if (i == 2) bad = ieee_value(1.0_wp, ieee_positive_inf)
      if (i == 3) bad = ieee_value(1.0_wp, ieee_negative_inf)
      call spoil_reals('/fclib_local/vectors/q', [1.0_wp, bad], '/fclib_local/vectors/q is not finite: its entry 1')
      call spoil_reals('/fclib_local/vectors/mu', [bad], '/fclib_local/vectors/mu is not finite: its entry 0')
      call spoil_reals('/fclib_local/W/x', [1.0_wp, 1.0_wp, bad, 1.0_wp], '/fclib_local/W/x is not finite: its entry 2')
    end do
    call spoil_reals('/fclib_local/vectors/mu', [-0.1_wp], '/fclib_local/vectors/mu is negative at contact 0')
    call spoil_reals('/fclib_local/vectors/mu', [2e6_wp], 'since rounding of the slip hides normal velocities')
  end subroutine test_numbers

  !> Matrices whose lists do not fit together.
  subroutine test_storages()
    type(hdf5_file_t) :: file

    call spoil_integers('/fclib_local/W/nz', [-7], '/fclib_local/W/nz is -7')
    call spoil_integers('/fclib_local/W/nz', [9], '/fclib_local/W/i has 4 entries, fewer than the 9 needed')
    call spoil_integers('/fclib_local/W/i', [0, 1, 0, 2], '/fclib_local/W/i holds the index 2, out of the range 0 to 1')
    call spoil_integers('/fclib_local/W/i', [0, -1, 0, 1], '/fclib_local/W/i holds the index -1, out of the range 0 to 1')
    call spoil_integers('/fclib_local/W/p', [0, 0, 1, 70], '/fclib_local/W/p holds the index 70, out of the range 0 to 1')
    call spoil_reals('/fclib_local/W/x', [1.0_wp], '/fclib_local/W/x has 1 entries, fewer than the 4 needed')
    call begin_local(file)
    call file%remove('/fclib_local/W')
    call put_matrix(file, '/fclib_local/W', reshape([2.0_wp, 1.0_wp, 1.0_wp, 2.0_wp], [2, 2]), rows)
    call spoil_pointers(file, [0, 2, 1], '/fclib_local/W/p does not rise from 0')
    call spoil_pointers(file, [1, 2, 4], '/fclib_local/W/p does not rise from 0')
    call spoil_pointers(file, [0, 2, 5], '/fclib_local/W/i has 4 entries, fewer than the 5 needed')
    call spoil_pointers(file, [0, 4], '/fclib_local/W/p has 2 entries, not 3')
    call file%close()
    call begin_local(file)
    call file%remove('/fclib_local/W')
    call put_matrix(file, '/fclib_local/W', reshape([2.0_wp, 1.0_wp, 1.0_wp, 2.0_wp], [2, 2]), columns)
    call file%remove('/fclib_local/W/i')
    call file%put('/fclib_local/W/i', [0_i4, 1_i4, 0_i4, 5_i4])
    call file%close()
    call expect('/fclib_local/W/i holds the index 5, out of the range 0 to 1')
  end subroutine test_storages

  !> Replace the pointers of a matrix, and leave the file open for the next.
  subroutine spoil_pointers(file, pointers, said)
    type(hdf5_file_t), intent(inout) :: file
    integer, intent(in) :: pointers(:)
    character(len=*), intent(in) :: said

    call file%remove('/fclib_local/W/p')
    call file%put('/fclib_local/W/p', int(pointers, i4))
    call file%close()
    call expect(said)
    call file%open(name, .false.)
  end subroutine spoil_pointers

  !> Global problems whose mass or constraints cannot be eliminated.
  subroutine test_global()
    real(wp) :: mass(2, 2), h(2, 2)
    type(hdf5_file_t) :: file

    h = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
    mass = 1
    call file%create(name)
    call put_global(file, 2, mass, h, [0.0_wp, 0.0_wp], [-1.0_wp, 0.0_wp], [0.5_wp], triplets)
    call file%close()
    call expect('the mass matrix M is singular')
    mass = reshape([1e-300_wp, 0.0_wp, 0.0_wp, 1e-300_wp], [2, 2])
    call file%create(name)
    call put_global(file, 2, mass, h, [0.0_wp, 0.0_wp], [-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [0.5_wp, 0.5_wp], rows)
    call file%close()
    call expect('/fclib_global/H is 2 by 2, where the rest of the file needs 2 rows and 4 columns')
    mass = h
    call file%create(name)
    call put_global(file, 2, mass, h, [0.0_wp, 0.0_wp, 1.0_wp], [-1.0_wp, 0.0_wp], [0.5_wp], columns)
    call file%close()
    call expect('/fclib_global/M is 2 by 2, where the rest of the file needs 3 rows and 3 columns')
    call file%create(name)
    call put_global(file, 2, mass, h, [0.0_wp, 0.0_wp], [-1.0_wp, 0.0_wp], [0.5_wp], columns)
    call put_matrix(file, '/fclib_global/G', reshape([1.0_wp, 1.0_wp, 2.0_wp, 2.0_wp], [2, 2]), rows)
    call file%close()
    call expect('/fclib_global/vectors/b is missing')
    call file%open(name, .false.)
    call file%put('/fclib_global/vectors/b', [1.0_wp, 2.0_wp])
    call file%close()
    call expect('G^T M^-1 G of the constraints is singular')
  end subroutine test_global

  !> A guess of the wrong size, when guesses are asked for.
  subroutine test_guess()
    type(hdf5_file_t) :: file

    call begin_local(file)
    call file%group('/guesses')
    call file%put('/guesses/number_of_guesses', [1_i4])
    call file%group('/guesses/1')
    call file%put('/guesses/1/r', [1.0_wp, 2.0_wp, 3.0_wp])
    call file%close()
    call expect_with('/guesses/1/r has 3 entries, not 2', .true.)
  end subroutine test_guess
end program test_bad_fclib
