!> Tagged numbers: what is written compares equal, and what differs is found.
program test_tagged
  use harness, only: tests_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_tagged, only: compare_tagged, tagged_text, tolerance_t
  implicit none
  type(tests_t) :: t
  type(tolerance_t) :: tolerances(1)

  tolerances(1)%kind = 'energy'
  tolerances(1)%relative = 1e-3_wp
  call write_one('tagged_a.txt', 2.0_wp, 3.0_wp, 2)
  call write_one('tagged_same.txt', 2.0_wp, 3.0_wp, 2)
  call write_one('tagged_near.txt', 2.0019_wp, 3.0_wp, 2)
  call write_one('tagged_far.txt', 2.0021_wp, 3.0_wp, 2)
  call write_one('tagged_other.txt', 2.0_wp, 3.0_wp + epsilon(3.0_wp)*4, 2)
  call write_one('tagged_short.txt', 2.0_wp, 3.0_wp, 1)
  call expect('tagged_same.txt', 0, '')
  call expect('tagged_near.txt', 0, '')
  call expect('tagged_far.txt', 1, 'kinetic: number 2 is')
  call expect('tagged_other.txt', 1, 'steps: number 1 is')
  call expect('tagged_short.txt', 1, 'steps has 1 numbers instead of 2')
  call write_text('tagged_missing.txt', 'kinetic energy 2', '0.33333333333333331', '2.0')
  call expect('tagged_missing.txt', 1, 'steps is missing')
  call write_text('tagged_cut.txt', 'kinetic energy 3', '1.0', '2.0')
  call expect('tagged_cut.txt', 1, 'this is no quantity')
  call write_text('tagged_word.txt', 'kinetic energy 2', '1.0', 'two')
  call expect('tagged_word.txt', 1, 'this is no quantity')
  call write_text('tagged_nan.txt', 'kinetic energy 2', 'NaN', '2.0')
  call expect('tagged_nan.txt', 2, 'not finite')
  call expect('tagged_absent.txt', 1, 'cannot read the file')
  call t%finish()

contains

  !> A file with an energy and a list of counts.
  subroutine write_one(file, energy, count, n)
    character(len=*), intent(in) :: file
    real(wp), intent(in) :: energy, count
    integer, intent(in) :: n
    integer :: unit

    open (newunit=unit, file=file, status='replace', access='stream', form='unformatted')
    write (unit) tagged_text('kinetic', 'energy', [1/3.0_wp, energy]), tagged_text('steps', 'count', spread(count, 1, n))
    close (unit)
  end subroutine write_one

  !> A file of three lines.
  subroutine write_text(file, first, second, third)
    character(len=*), intent(in) :: file, first, second, third
    integer :: unit

    open (newunit=unit, file=file, status='replace')
    write (unit, '(a)') first, second, third
    close (unit)
  end subroutine write_text

  !> So many differences from the first file are expected, of which the first says something.
  subroutine expect(file, n, words)
    character(len=*), intent(in) :: file, words
    integer, intent(in) :: n
    type(diagnostics_t) :: differences

    call compare_tagged('tagged_a.txt', file, tolerances, differences)
    call t%equal(differences%count(), n, 'differences of '//file)
    if (differences%count() == 0) return
    call t%check(index(differences%errors(1)%message, words) > 0, words//' is said, not: '//differences%errors(1)%message)
  end subroutine expect
end program test_tagged
