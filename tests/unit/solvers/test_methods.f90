!> The list of methods: each name makes a solver or is refused with its reason, and each option has a key, a place in the reference
!! and a component that its value arrives at.
program test_methods
  use harness, only: tests_t
  use sg_choose_solver, only: choose_matrix_solver, choose_solver
  use sg_error, only: error_t
  use sg_key_table, only: key_table_t, value_choice, value_logical, value_real
  use sg_keys, only: all_keys
  use sg_kinds, only: wp
  use sg_matrix_solver, only: matrix_options_t, matrix_solver_t
  use sg_methods, only: find_method, list_couplings, list_solvers, method_t, robust_solver
  use sg_options, only: option_t, option_values_t, option_visitor_t
  use sg_random, only: random_t
  use sg_reference_text, only: reference_text
  use sg_run_options, only: partition_options_t, solver_options_t
  use sg_solver, only: solver_t
  use sg_sparse_factor, only: find_sparse_library
  use sg_words, only: is_choice
  implicit none

  !> A method with an option of each kind
  type :: sample_t
    integer :: count = 3
    real(wp) :: share = 0.25_wp
    logical :: is_on = .true.
    character(len=8) :: word = 'one'
  end type sample_t
  type(tests_t) :: t

  call test_names()
  call test_solvers()
  call test_couplings()
  call test_options_of_couplings()
  call test_kinds_of_options()
  call t%finish()

contains

  !> Defaults are in the lists, and decks take each name.
  subroutine test_names()
    type(method_t), allocatable :: solvers(:), couplings(:)
    type(solver_options_t) :: solver
    type(partition_options_t) :: partition

    call list_solvers(solvers)
    call list_couplings(couplings)
    call t%check(find_method(solvers, solver%method) > 0, 'the default of solver.method is a solver')
    call t%check(find_method(solvers, robust_solver) > 0, 'the default of `solve` is a solver')
    call t%check(find_method(couplings, partition%gluing) > 0, 'the default of partition.gluing is a coupling')
    call t%equal(find_method(solvers, 'nlsg'), 0, 'a name that is none')
    call check_choices('solver', 'method', solvers)
    call check_choices('partition', 'gluing', couplings)
  end subroutine test_names

  !> Each name is a choice of its key, which says what it is.
  subroutine check_choices(section, key, methods)
    character(len=*), intent(in) :: section, key
    type(method_t), intent(in) :: methods(:)
    type(key_table_t) :: table
    integer :: i, k

    table = all_keys()
    k = table%find_key(table%find_section(section), key)
    do i = 1, size(methods)
      call t%check(is_choice(trim(methods(i)%name), trim(table%keys(k)%choices)), key//': '//trim(methods(i)%name))
      call t%check(index(table%keys(k)%sentence, trim(methods(i)%sentence)) > 0, key//': what it is, '//trim(methods(i)%name))
    end do
  end subroutine check_choices

  !> Each solver on one rank, on two, and for matrices.
  subroutine test_solvers()
    type(method_t), allocatable :: methods(:)
    type(solver_options_t) :: options
    type(partition_options_t) :: partition
    class(solver_t), allocatable :: solver
    class(matrix_solver_t), allocatable :: matrices
    type(error_t), allocatable :: error, missing
    character(len=:), allocatable :: name
    integer :: i

    call find_sparse_library(missing)
    call list_solvers(methods)
    do i = 1, size(methods)
      name = trim(methods(i)%name)
      options%method = name
      call choose_solver(options, partition, 1, solver, error)
      call check_made(name//' on one rank', allocated(solver), error, methods(i)%needs_factors .and. allocated(missing))
      call choose_solver(options, partition, 2, solver, error)
      if (methods(i)%runs_alone()) then
        call t%check(allocated(error) .and. .not. allocated(solver), name//' does not run on two ranks')
        if (allocated(error)) call t%check(error%message == 'solver "'//name//'" does not run on several ranks; use method = '// &
                                           '"nlgs" or "nesterov" or "interior"', name//': '//error%message)
      else
        call check_made(name//' on two ranks', allocated(solver), error, methods(i)%needs_factors .and. allocated(missing))
      end if
      call choose_matrix_solver(name, matrix_options_t(), matrices, error)
      call check_made(name//' for matrices', allocated(matrices), error, methods(i)%needs_factors .and. allocated(missing))
    end do
    call choose_matrix_solver('nlsg', matrix_options_t(), matrices, error)
    call t%check(allocated(error), 'a name that is none')
    if (allocated(error)) call t%check(index(error%message, 'did you mean "nlgs"?') > 0, error%message)
  end subroutine test_solvers

  !> A solver is made, or refused where its library is missing.
  subroutine check_made(name, is_made, error, must_fail)
    character(len=*), intent(in) :: name
    logical, intent(in) :: is_made, must_fail
    type(error_t), allocatable, intent(in) :: error

    if (must_fail) then
      call t%check(allocated(error), name//' is refused without its library')
    else
      call t%check(is_made .and. .not. allocated(error), name//' is made')
    end if
  end subroutine check_made

  !> Each coupling makes a solver of several ranks.
  subroutine test_couplings()
    type(method_t), allocatable :: couplings(:)
    type(partition_options_t) :: partition
    class(solver_t), allocatable :: solver
    type(error_t), allocatable :: error
    integer :: i

    call list_couplings(couplings)
    do i = 1, size(couplings)
      partition%gluing = couplings(i)%name
      call choose_solver(solver_options_t(), partition, 2, solver, error)
      call check_made(trim(couplings(i)%name), allocated(solver), error, .false.)
    end do
  end subroutine test_couplings

  !> Keys of all couplings: a section of the table and of the reference; a value drawn at random arrives at its component alone.
  subroutine test_options_of_couplings()
    type(method_t), allocatable :: couplings(:)
    type(key_table_t) :: all, own
    character(len=:), allocatable :: reference, section
    integer :: i, k, n

    all = all_keys()
    reference = reference_text()
    call list_couplings(couplings)
    n = 0
    do i = 1, size(couplings)
      section = 'partition.'//trim(couplings(i)%name)
      call own%open_section(section, '')
      call couplings(i)%coupled%visit_options(own)
      call own%finish()
      do k = 1, size(own%keys)
        call t%check(all%find_key(all%find_section(section), trim(own%keys(k)%name)) > 0, section//' has '//own%keys(k)%name)
        call t%check(index(reference(index(reference, '`['//section//']`'):), '| `'//trim(own%keys(k)%name)//'` |') > 0, &
                     'the reference has '//section//'.'//own%keys(k)%name)
        call test_arrival(couplings(i), own, k)
      end do
      n = n + size(own%keys)
      own = key_table_t()
    end do
    call t%check(n >= 2, 'couplings have options')
  end subroutine test_options_of_couplings

  !> A value put in by name is the one that the method then has, and the others keep theirs.
  subroutine test_arrival(coupling, before, k)
    type(method_t), intent(in) :: coupling
    type(key_table_t), intent(in) :: before
    integer, intent(in) :: k
    type(method_t) :: filled
    type(key_table_t) :: after
    type(option_values_t) :: values
    type(random_t) :: random
    real(wp) :: low, high
    character(len=24) :: name
    integer :: i

    if (before%keys(k)%kind == value_choice .or. before%keys(k)%kind == value_logical) return
    call random%seed(k)
    low = max(before%keys(k)%lowest, -1e3_wp)
    high = min(before%keys(k)%highest, low + 1e3_wp)
    name = before%keys(k)%name
    call values%put(trim(name), low + 0.75_wp*(high - low), '')
    filled = coupling
    call filled%coupled%visit_options(values)
    call after%open_section('after', '')
    call filled%coupled%visit_options(after)
    call after%finish()
    do i = 1, size(after%keys)
      call t%check((after%keys(i)%default /= before%keys(i)%default) .eqv. i == k, trim(name)//' at '//after%keys(i)%name)
    end do
  end subroutine test_arrival

  !> An option of each kind as key, and its value as read.
  subroutine test_kinds_of_options()
    type(sample_t) :: sample
    type(key_table_t) :: table
    type(option_values_t) :: values

    call table%open_section('sample', 'A sample.')
    call visit(sample, table)
    call table%finish()
    call t%check(all(table%keys%default == [character(len=8) :: '3', '0.25', 'true', '"one"']), 'defaults')
    call t%check(table%keys(1)%lowest >= 1 .and. table%keys(1)%highest <= 9 .and. .not. table%keys(1)%is_open, 'a closed range')
    call t%check(table%keys(2)%kind == value_real .and. table%keys(2)%is_open .and. abs(table%keys(2)%lowest) <= 0, 'an open range')
    call t%check(table%keys(2)%unit == 'm' .and. table%keys(4)%choices == 'one|two', 'unit and choices')
    call t%equal(table%find_former('old.count'), 1, 'a former key')
    call t%equal(table%find_former('old.share'), 0, 'none')
    call values%put('word', 0.0_wp, 'two')
    call values%put('count', 7.0_wp, '')
    call values%put('is_on', 0.0_wp, '')
    call visit(sample, values)
    call t%check(sample%count == 7 .and. .not. sample%is_on .and. sample%word == 'two', 'values that are given')
    call t%near(sample%share, 0.25_wp, 0.0_wp, 'one that is not')
  end subroutine test_kinds_of_options

  !> The options of the sample.
  subroutine visit(sample, visitor)
    type(sample_t), intent(inout) :: sample
    class(option_visitor_t), intent(inout) :: visitor

    call visitor%option(option_t('count', 'A count.', least=1.0_wp, most=9.0_wp, former='old.count'), sample%count)
    call visitor%option(option_t('share', 'A share.', unit='m', above=0.0_wp), sample%share)
    call visitor%option(option_t('is_on', 'A switch.'), sample%is_on)
    call visitor%option(option_t('word', 'A word.', choices='one|two'), sample%word)
  end subroutine visit
end program test_methods
