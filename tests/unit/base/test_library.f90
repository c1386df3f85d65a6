!> Libraries opened on demand: found by place, else by name; what lacks is told in one sentence.
program test_library
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_procpointer, c_funptr
  use harness, only: tests_t
  use sg_error, only: error_t, exit_failure
  use sg_kinds, only: wp
  use sg_library, only: find_procedures, is_there
  implicit none

  abstract interface
    function of_one(x) bind(c) result(y)
      import :: c_double
      real(c_double), value :: x
      real(c_double) :: y
    end function of_one
  end interface

  !> A library of every Linux, at a place where it is not; one that does not exist
  character(len=*), parameter :: elsewhere = '/no such folder/libm.so.6', nowhere = '/no such folder/libnothing.so.99'
  type(tests_t) :: t

  call test_found_by_name()
  call test_missing_library()
  call test_missing_procedure()
  call test_within_the_program()
  call t%finish()

contains

  !> The cube root of 27 by the C library's own procedure.
  subroutine test_found_by_name()
    procedure(of_one), pointer :: cube_root
    type(c_funptr) :: address(2)
    type(error_t), allocatable :: error

    call find_procedures('mathematics', elsewhere, ['cbrt', 'sqrt'], address, error)
    call t%check(.not. allocated(error), 'a library that is not at its place is found by its name')
    if (allocated(error)) return
    call c_f_procpointer(address(1), cube_root)
    ! Rounded at most twice.
    call t%near(cube_root(27.0_wp), 3.0_wp, 2*epsilon(3.0_wp)*3, 'its procedures can be called')
    call is_there('mathematics', elsewhere, error)
    call t%check(.not. allocated(error), 'and it is there')
  end subroutine test_found_by_name

  subroutine test_missing_library()
    type(c_funptr) :: address(1)
    type(error_t), allocatable :: error

    call find_procedures('Nothing, which none needs,', nowhere, ['nil'], address, error)
    call t%check(allocated(error), 'a library that is nowhere is an error')
    if (.not. allocated(error)) return
    call t%equal(error%code, exit_failure, 'which is no mistake of the deck')
    call t%check(index(error%message, 'Nothing, which none needs, cannot be loaded: libnothing.so.99: ') == 1, &
                 'that says which library, for what, and the file: '//error%message)
    call t%check(.not. c_associated(address(1)), 'and no address is given')
    call is_there('Nothing', nowhere, error)
    call t%check(allocated(error), 'nor is it there')
  end subroutine test_missing_library

  subroutine test_missing_procedure()
    type(c_funptr) :: address(2)
    type(error_t), allocatable :: error

    call find_procedures('mathematics', elsewhere, [character(len=21) :: 'cbrt', 'splitgrain_no_such_fn'], address, error)
    call t%check(allocated(error), 'a procedure that a library lacks is an error')
    if (allocated(error)) call t%check(index(error%message, 'splitgrain_no_such_fn') > 0, 'that names it: '//error%message)
  end subroutine test_missing_procedure

  !> An empty name stands for the program itself, into which static libraries are linked, and for the libraries that it has.
  subroutine test_within_the_program()
    type(c_funptr) :: address(1)
    type(error_t), allocatable :: error

    call find_procedures('C', '', ['malloc'], address, error)
    call t%check(.not. allocated(error), 'what is a part of the program is found there')
    call is_there('C', '', error)
    call t%check(.not. allocated(error), 'and is there')
  end subroutine test_within_the_program
end program test_library
