!> Lists of fields: room, order, records and the memory report hold each field of bodies and of contacts. `.ci/check_fields` checks
!! that the lists are complete.
program test_fields
  use harness, only: tests_t
  use same_bits, only: same
  use sg_bodies, only: bodies_t, drop_rotation, make_bodies_like
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_field_visitor, only: field_t, kind_byte, kind_flag, kind_integer, kind_real, sync_always, sync_never, sync_on_copy, &
                              sync_on_owner
  use sg_fields, only: fields_t
  use sg_kinds, only: wp, i1, i4, i8
  use sg_random, only: random_t
  use sg_tables, only: per_body, tables_t
  implicit none
  integer, parameter :: n_items = 23
  type(tests_t) :: t
  type(random_t) :: random

  call random%seed(29)
  call test_bodies('in the plane', 2, turns=.true.)
  call test_bodies('in the plane, nothing turns', 2, turns=.false.)
  call test_bodies('in space', 3, turns=.true.)
  call test_bodies('in space, nothing turns', 3, turns=.false.)
  call test_contacts('in the plane', 2, 2, 3)
  call test_contacts('in the plane, frictionless', 2, 1, 0)
  call test_contacts('in space', 3, 3, 1)
  call test_arrays()
  call t%finish()

contains

  !> Bodies of one kind of scene.
  subroutine test_bodies(name, dimension, turns)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension
    logical, intent(in) :: turns
    type(bodies_t) :: bodies, other, longer, cleared

    call bodies%allocate(n_items, dimension)
    if (.not. turns) call drop_rotation(bodies, keep_orientation=.false.)
    call make_bodies_like(bodies, n_items, other)
    bodies = other
    longer = other
    call longer%resize(2*n_items)
    call make_bodies_like(bodies, n_items, cleared)
    call fill(cleared)
    call cleared%clear(5)
    call test_list(bodies, other, longer, cleared, 'bodies '//name)
    call t%check(all(cleared%is_grain(5:5)) .and. cleared%material(5) == 0, 'bodies '//name//': a cleared body is a grain')
    if (dimension == 3 .and. turns) &
      call t%check(same(cleared%orientation(:, 5), [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]), 'bodies '//name//': it is not turned')
    call drop_rotation(bodies, keep_orientation=.false.)
    call t%check(all(shape(bodies%velocity) == [dimension, n_items]) .and. all(shape(bodies%middle) == [dimension, n_items]) .and. &
                 .not. (allocated(bodies%angle) .or. allocated(bodies%orientation)), 'bodies '//name//': rotation is dropped')
    call t%check(same(bodies%velocity(1, :), other%velocity(1, :)), 'bodies '//name//': translation stays')
  end subroutine test_bodies

  !> Contacts of one kind of scene.
  subroutine test_contacts(name, dimension, components, internal)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension, components, internal
    type(contacts_t) :: contacts, other, longer, cleared

    contacts%dimension = dimension
    contacts%n_components = components
    contacts%n_internal = internal
    call contacts%resize(n_items)
    other = contacts
    longer = contacts
    call reserve_contacts(longer, n_items + 1)
    call t%check(size(longer%gap) > n_items + 1, 'contacts '//name//': room grows by half')
    call longer%resize(2*n_items)
    cleared = contacts
    call fill(cleared)
    call cleared%clear(5)
    call test_list(contacts, other, longer, cleared, 'contacts '//name)
  end subroutine test_contacts

  !> Everything that works by the list. All tables have their room; `longer` twice of it, and item 5 of `cleared` is a new one.
  subroutine test_list(things, other, longer, cleared, name)
    class(fields_t), intent(inout) :: things, other, longer, cleared
    character(len=*), intent(in) :: name
    type(field_t), allocatable :: list(:)
    type(tables_t) :: tables
    real(wp), allocatable :: values(:, :), got(:, :)
    integer(i8) :: bytes
    integer :: i, least

    call fill(things)
    list = things%described()
    bytes = 0
    do i = 1, size(list)
      call t%check((list(i)%bytes >= 0) .eqv. list(i)%is_there, name//': room for '//trim(list(i)%name))
      call t%check(count(list%name == list(i)%name) == 1 .and. list(i)%place == i, name//': one '//trim(list(i)%name))
      bytes = bytes + max(0_i8, list(i)%bytes)
    end do
    call tables%begin('things', per_body)
    call things%note(tables)
    call t%check(tables%bytes_per(per_body) == bytes .and. bytes == n_items*things%bytes_per_item(), name//': memory report')
    do least = sync_never, sync_always
      call t%equal(things%width(least), sum(list%components, list%is_there .and. list%sync >= least), name//': width')
    end do
    call t%check(things%width(sync_never) > things%width(sync_on_owner) .and. things%width(sync_on_owner) > 0, name//': rules')
    ! Records sent hold what is sent, in any order of the items, and nothing else is written.
    call things%pack(shuffled(), values, sync_on_owner)
    call other%unpack(shuffled(), values, sync_on_owner)
    do i = 1, size(list)
      call things%pack(all_items(n_items), values, sync_never, list(i)%place)
      call other%pack(all_items(n_items), got, sync_never, list(i)%place)
      if (list(i)%is_there .and. size(values) > 0) &
        call t%check(same(values, got) .eqv. list(i)%sync >= sync_on_owner, name//': sent '//trim(list(i)%name))
    end do
    ! Room that grows and shrinks keeps what fits.
    call things%pack(all_items(n_items), values, sync_never)
    call longer%unpack(all_items(n_items), values, sync_never)
    call longer%resize(3*n_items)
    call longer%resize(n_items)
    call longer%pack(all_items(n_items), got, sync_never)
    call t%check(same(values, got), name//': room')
    call longer%keep(shuffled())
    call longer%pack(all_items(n_items), got, sync_never)
    call t%check(same(values(:, shuffled()), got), name//': order')
    call test_cleared(cleared, list, name)
  end subroutine test_list

  !> A cleared item is as new, and the others stay.
  subroutine test_cleared(cleared, list, name)
    class(fields_t), intent(inout) :: cleared
    type(field_t), intent(in) :: list(:)
    character(len=*), intent(in) :: name
    real(wp), allocatable :: values(:, :)
    integer :: i

    do i = 1, size(list)
      call cleared%pack([5_i4, 6_i4], values, sync_never, i)
      if (size(values) == 0) cycle
      call t%check(.not. any(abs(values(:, 1) - [list(i)%first, spread(0.0_wp, 1, list(i)%components - 1)]) > 0), &
                   name//': cleared '//trim(list(i)%name))
      if (list(i)%kind /= kind_flag) call t%check(any(abs(values(:, 2)) > 0), name//': kept '//trim(list(i)%name))
    end do
  end subroutine test_cleared

  !> Values at random in all fields that there are, of all sizes that their kinds have; none of them is zero.
  subroutine fill(things)
    class(fields_t), intent(inout) :: things
    type(field_t), allocatable :: list(:)
    real(wp), allocatable :: values(:, :)
    integer :: i, k, c

    list = things%described()
    do i = 1, size(list)
      if (.not. list(i)%is_there) cycle
      allocate (values(list(i)%components, n_items))
      do k = 1, n_items
        do c = 1, list(i)%components
          select case (list(i)%kind)
          case (kind_real)
            values(c, k) = (random%uniform() - 0.5_wp)*10.0_wp**nint(600*(random%uniform() - 0.5_wp))
          case (kind_integer)
            values(c, k) = real(huge(1_i4) - int(1e9_wp*random%uniform(), i4), wp)
          case (kind_byte)
            values(c, k) = real(1 + int(127*random%uniform()), wp)*sign(1.0_wp, random%uniform() - 0.5_wp)
          case (kind_flag)
            values(c, k) = real(nint(random%uniform()), wp)
          end select
        end do
      end do
      call things%unpack(all_items(n_items), values, sync_never, i)
      deallocate (values)
    end do
  end subroutine fill

  !> Arrays of each kind by their own names.
  subroutine test_arrays()
    type(bodies_t) :: bodies
    type(contacts_t) :: contacts
    real(wp), allocatable :: values(:, :)
    integer :: i

    call bodies%allocate(3)
    do i = 1, 3
      bodies%position(:, i) = [1.5_wp*real(i, wp), -0.0_wp]
      bodies%angle(i) = 0.1_wp*real(i, wp)
      bodies%crossings(i) = int(-i, i4)
      bodies%is_grain(i) = i /= 2
    end do
    call bodies%pack([3_i4, 2_i4], values, sync_on_copy)
    call t%check(same(values(:3, 1), [4.5_wp, -0.0_wp, bodies%angle(3)]), 'position and angle come first')
    call bodies%unpack([1_i4, 3_i4], values, sync_on_copy)
    call t%check(same(bodies%position(1, :), [4.5_wp, 3.0_wp, 3.0_wp]), 'reals are read back')
    call t%check(all(bodies%crossings == [-3, -2, -2]) .and. all(bodies%is_grain .eqv. [.true., .false., .false.]), &
                 'integers and flags are read back')
    call contacts%resize(2)
    contacts%contactor(:, 1) = [7_i4, 8_i4]
    contacts%feature(1) = huge(1_i4)
    contacts%status(1) = -127_i1
    call contacts%pack([1_i4], values, sync_on_owner)
    call contacts%unpack([2_i4], values, sync_on_owner)
    call t%check(all(contacts%contactor(:, 2) == [7, 8]) .and. contacts%feature(2) == huge(1_i4) .and. &
                 contacts%status(2) == -127_i1, &
                 'records of integers, integers and bytes are read back')
  end subroutine test_arrays

  !> Numbers of the first items.
  pure function all_items(n) result(items)
    integer, intent(in) :: n
    integer(i4) :: items(n)
    integer :: i

    items = [(int(i, i4), i=1, n)]
  end function all_items

  !> All items, in another order: 7 and 23 share no factor.
  pure function shuffled() result(items)
    integer(i4) :: items(n_items)
    integer :: i

    items = [(int(1 + modulo(7*i, n_items), i4), i=1, n_items)]
  end function shuffled
end program test_fields
