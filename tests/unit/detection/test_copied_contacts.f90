!> Contacts that several threads find are put behind each other (copy_run): every field that the list of fields has goes along.
program test_copied_contacts
  use harness, only: tests_t
  use sg_contacts, only: begin_like, contacts_t, copy_run
  use sg_field_visitor, only: sync_never
  use sg_kinds, only: i4, wp
  implicit none
  type(tests_t) :: t

  call test_all_fields(2, .false.)
  call test_all_fields(3, .true.)
  call t%finish()

contains

  !> Contacts with all fields that a dimension has, each with numbers of its own, behind two others.
  subroutine test_all_fields(dimension, has_cell)
    integer, intent(in) :: dimension
    logical, intent(in) :: has_cell
    integer, parameter :: before = 2, n = 3
    type(contacts_t) :: from, to
    real(wp), allocatable :: values(:, :), others(:, :), found(:, :)
    integer(i4) :: i

    to%dimension = dimension
    to%n_components = dimension
    to%n_internal = 2
    to%n_carried = 4
    to%n_kept = 5
    to%has_cell = has_cell
    call begin_like(from, to)
    call from%resize(n)
    call to%resize(before + n + 1)
    from%n = n
    call numbers(from%width(sync_never), n, 1, values)
    call from%unpack([(i, i=1, n)], values, sync_never)
    call numbers(to%width(sync_never), before + n + 1, 50, others)
    call to%unpack([(i, i=1, before + n + 1)], others, sync_never)
    call copy_run(from, before, to)
    call to%pack([(i, i=1, before + n + 1)], found, sync_never)
    call t%near(maxval(abs(found(:, before + 1:before + n) - values)), 0.0_wp, 0.0_wp, 'every field is copied')
    call t%near(maxval(abs(found(:, :before) - others(:, :before))), 0.0_wp, 0.0_wp, 'what stands before stays')
    call t%near(maxval(abs(found(:, before + n + 1) - others(:, before + n + 1))), 0.0_wp, 0.0_wp, 'what stands behind stays')
  end subroutine test_all_fields

  !> Whole numbers that fit a byte, other ones in each row of a contact.
  pure subroutine numbers(width, n, first, values)
    integer, intent(in) :: width, n, first
    real(wp), allocatable, intent(out) :: values(:, :)
    integer :: i, j

    allocate (values(width, n))
    do j = 1, n
      do i = 1, width
        values(i, j) = real(first + modulo(7*i + j, 50), wp)
      end do
    end do
  end subroutine numbers
end program test_copied_contacts
