!> What a process may still take of memory: the limits of this machine, and how tables ask for room.
program test_memory
  use harness, only: tests_t
  use sg_contacts, only: contacts_t, drop_contacts, grow_contacts
  use sg_kinds, only: wp, i8
  use sg_memory, only: gigabytes, memory_t
  implicit none
  type(tests_t) :: t

  call test_limits()
  call test_growth()
  call test_sizes()
  call t%finish()

contains

  !> What is left is a positive number with a name, several processes share it, and what is larger does not fit.
  subroutine test_limits()
    type(memory_t) :: alone, shared
    character(len=:), allocatable :: limit
    integer(i8) :: left, share

    call alone%left(left, limit)
    call t%check(left > 0, 'memory is left')
    call t%check(len(limit) > 0, 'whose limit it is')
    call t%check(alone%fits(1000_i8), 'little always fits')
    call t%check(.not. alone%fits(huge(left)), 'all addresses do not fit')
    shared%sharers = 1000
    call shared%left(share, limit)
    ! Other processes take and give back meanwhile.
    if (limit /= '"ulimit -v"' .and. limit /= '"ulimit -d"' .and. left < huge(left)) &
      call t%check(share < left/100, 'a thousand processes share what is left')
  end subroutine test_limits

  !> Contacts grow where there is memory, are cut where there is none, and can be dropped then.
  subroutine test_growth()
    type(contacts_t) :: contacts

    contacts%dimension = 3
    contacts%n_components = 3
    call grow_contacts(contacts, 100)
    call t%check(.not. contacts%is_cut .and. size(contacts%gap) >= 100, 'room for contacts')
    contacts%n = 100
    contacts%memory%sharers = huge(contacts%memory%sharers)
    call grow_contacts(contacts, 100000000)
    call t%check(contacts%is_cut, 'no room for a share of a byte')
    call t%check(size(contacts%gap) < 1000, 'nothing was taken')
    call drop_contacts(contacts)
    call t%equal(contacts%n, 0, 'no contact is left')
    call t%equal(contacts%n_cut, 100, 'contacts found before')
    call t%equal(contacts%n_components, 3, 'what contacts are like is kept')
  end subroutine test_growth

  subroutine test_sizes()
    call t%check(gigabytes(2.5e6_wp) == '3 MB' .or. gigabytes(2.5e6_wp) == '2 MB', 'megabytes')
    call t%check(gigabytes(1.25e9_wp) == '1.3 GB' .or. gigabytes(1.25e9_wp) == '1.2 GB', 'gigabytes')
    call t%check(gigabytes(2.345e12_wp) == '2345.0 GB', 'thousands of gigabytes')
  end subroutine test_sizes
end program test_memory
