!> Tagged numbers: names, kinds, sizes, and numbers that lose nothing.
program test_tagged
  use harness, only: tests_t
  use sg_kinds, only: wp
  use sg_tagged, only: tagged_text
  use sg_text, only: read_lines, text_t
  use sg_error, only: error_t
  use written_files, only: put_text
  implicit none
  type(tests_t) :: t

  call test_text()
  call t%finish()

contains

  !> Write two quantities, and read them back.
  subroutine test_text()
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    real(wp), parameter :: values(4) = [1/3.0_wp, -1e-300_wp, 0.0_wp, 123456789.0_wp]
    real(wp) :: value
    integer :: i

    call put_text('tagged.txt', tagged_text('kinetic_energy', 'measure', values)//tagged_text('steps', 'count', [7.0_wp]))
    call read_lines('tagged.txt', lines, error)
    call t%check(.not. allocated(error), 'the file is read')
    call t%equal(size(lines), 7, 'a line a quantity and a line a number')
    call t%check(lines(1)%s == 'kinetic_energy measure 4', 'name, kind, size: '//lines(1)%s)
    call t%check(lines(6)%s == 'steps count 1', 'of each quantity: '//lines(6)%s)
    do i = 1, size(values)
      read (lines(1 + i)%s, *) value
      call t%near(value, values(i), 0.0_wp, 'to the last bit')
    end do
  end subroutine test_text
end program test_tagged
