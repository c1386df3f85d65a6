!> Restart files that ranks write together: bodies stand in them as one rank writes them, bit for bit, contacts are the same
!! ones; any number of ranks reads them, each the rows of its bodies and a piece of the contacts, which go to their owners; an old
!! file stays whole when a new one cannot be written.
program test_restart
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use rank_parts, only: chain_of_contacts, draw_owners, plane_scene, shake, space_scene, take_part
  use sg_block_distribution, only: block_distribution_t, wanted_t
  use sg_bodies, only: drop_rotation
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_comm, only: comm_t
  use sg_contact_migration, only: distribute_contacts, unpack_contacts
  use sg_contacts, only: contacts_t
  use sg_error, only: diagnostics_t, error_t, exit_output
  use sg_field_visitor, only: field_t
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp, i4, i8
  use sg_owners, only: contact_owner
  use sg_parcels, only: parcel_t
  use sg_random, only: random_t
  use sg_restart_fields, only: fields_in_files
  use sg_restart_files, only: newest_restart
  use sg_scene, only: scene_t
  use sg_signature, only: n_signature, signature_of
  use sg_simulation, only: simulation_t, start_simulation
  use sg_system, only: file_exists, make_folder, remove_file
  implicit none
  type(tests_t) :: t
  type(comm_t) :: comm, alone

  call comm%start()
  call test_rows()
  if (hdf5_is_available() .and. (hdf5_is_parallel() .or. comm%size == 1)) then
    call test_scene('plane', 2, 57, .true., 1)
    call test_scene('frozen', 2, 40, .false., 3)
    call test_scene('space', 3, 45, .true., 2)
    call test_scene('few', 2, 2, .true., 1)
    call test_scene('lonely', 3, 9, .false., 0)
    ! More rows than share a check sum: ranks write pieces of each other's chunks.
    call test_scene('many', 2, 40001, .true., 5)
    call test_bad_piece()
    call test_no_folder()
  else
    if (comm%rank == 0) write (*, '(a)') 'this build cannot share files between ranks: they are not tested'
  end if
  call t%finish(comm)

contains

  !> Numbers dealt out at random come into blocks, back to their holders, and to those who want them.
  subroutine test_rows()
    type(random_t) :: random
    type(block_distribution_t) :: rows
    type(wanted_t) :: wanted
    real(wp), allocatable :: block(:, :), back(:, :), values(:, :)
    integer(i4), allocatable :: number(:), ordered(:)
    integer, parameter :: n = 101
    integer :: i

    call random%seed(3)
    allocate (number(0))
    do i = n, 1, -1
      if (int(real(comm%size, wp)*random%uniform()) == comm%rank) number = [number, int(i, i4)]
    end do
    call rows%plan(comm, number, n)
    call t%check(rows%is_complete, 'each number is held once')
    call rows%order(comm, number, ordered)
    call t%equal(size(ordered), rows%n, 'size of the block')
    call t%check(all(ordered == [(rows%first + i, i=1, rows%n)]), 'the block is in order')
    allocate (values(2, size(number)))
    values(1, :) = real(number, wp)
    values(2, :) = -0.5_wp*values(1, :)
    call rows%order(comm, values, block)
    call rows%back(comm, block, back)
    call t%check(all(shape(back) == shape(values)), 'size of what comes back')
    if (all(shape(back) == shape(values))) call t%near(sum(abs(back - values)), 0.0_wp, 0.0_wp, 'what comes back')
    call wanted%plan(comm, rows, [7_i4, 99_i4, 7_i4, int(50 + comm%rank, i4)])
    call wanted%fetch(comm, block, values)
    call t%equal(size(values, 2), 3, 'things wanted, each once')
    if (size(values, 2) == 3) call t%near(sum(abs(values(1, :) - [7.0_wp, 50.0_wp + real(comm%rank, wp), 99.0_wp])), 0.0_wp, &
                                          0.0_wp, 'what is wanted')
    call t%check(all(wanted%place([7_i4, 99_i4, 8_i4]) == [1, 3, 0]), 'places of what is wanted')
    call rows%plan(comm, [number, 5_i4], n)
    call t%check(.not. rows%is_complete, 'a number that several ranks hold is noticed')
  end subroutine test_rows

  !> A started simulation of one of the scenes.
  subroutine begin(name, dimension, n, turns, sim)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension, n
    logical, intent(in) :: turns
    type(simulation_t), pointer, intent(out) :: sim

    sim => fresh()
    if (dimension == 2) call plane_scene(sim%scene, n)
    if (dimension == 3) call space_scene(sim%scene, n)
    sim%scene%bodies%inverse_mass = 1
    sim%options%time_step = 0.01_wp
    sim%options%deck_hash = 'cafe'
    sim%options%folder = name
    call start_simulation(sim)
    if (.not. turns) call drop_rotation(sim%scene%bodies, keep_orientation=dimension == 3)
  end subroutine begin

  !> Remove what an earlier run of the tests has left: files take turns by it.
  subroutine remove_former(name)
    character(len=*), intent(in) :: name
    character(len=4), parameter :: folders(2) = ['_one', '_all']
    integer :: i

    do i = 1, size(folders)
      call remove_file(name//folders(i)//'/restart_a.h5')
      call remove_file(name//folders(i)//'/restart_b.h5')
    end do
  end subroutine remove_former

  !> Write a scene by one rank and by all, and read what all have written on each of them.
  subroutine test_scene(name, dimension, n, turns, stride)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension, n, stride
    logical, intent(in) :: turns
    type(simulation_t), pointer :: whole, part
    type(random_t) :: random
    type(error_t), allocatable :: error
    integer(i4), allocatable :: owner(:)
    real(wp) :: signature(n_signature)
    integer :: serial

    call t%check(make_folder(name//'_one'), 'a folder')
    call t%check(make_folder(name//'_all'), 'a folder')
    if (comm%rank == 0) call remove_former(name)
    if (comm%any(.false.)) return
    call begin(name//'_one', dimension, n, turns, whole)
    signature = signature_of(whole%scene, alone)
    call random%seed(21)
    call shake(whole%scene, random)
    call chain_of_contacts(whole%scene, min(stride, whole%scene%contactors%n - 1), random, whole%contacts)
    whole%step = 1234
    whole%totals%steps = 1234
    whole%energy%external_work = 5
    whole%totals%contact_updates = 1000
    if (comm%rank == 0) then
      call save_checkpoint(whole, error)
      call t%check(.not. allocated(error), 'one rank writes '//name)
    end if
    do serial = 1, 3
      part => fresh(whole)
      part%options%folder = name//'_all'
      part%comm = comm
      part%signature = signature
      call draw_owners(whole%scene, comm%size, random, owner)
      call take_part(whole%scene, whole%contacts, owner, comm%rank, comm%size, part%scene, part%contacts)
      if (comm%size > 1) then
        call part%energy%leave_to_first(comm)
        call part%totals%leave_to_first(comm)
      end if
      call save_checkpoint(part, error)
      call t%check(.not. allocated(error), 'all ranks write '//name)
      if (allocated(error)) write (*, '(a)') error%report()
    end do
    call t%check(.not. file_exists(name//'_all/restart_a.h5.part'), 'nothing unfinished is left')
    call t%check(newest_restart(name//'_all') == name//'_all/restart_a.h5', 'the third file takes the place of the first')
    if (comm%rank == 0) call compare(name//'_one/restart_a.h5', name//'_all/restart_a.h5', whole)
    call read_again(name//'_all', dimension, n, turns, whole)
    call read_again(name//'_one', dimension, n, turns, whole)
    if (comm%size > 1) call read_share(name//'_all', dimension, n, turns, whole)
    if (comm%size > 1) call read_share(name//'_one', dimension, n, turns, whole)
  end subroutine test_scene

  !> Compare what two files say of bodies bit for bit, and their contacts in the order of their impulses.
  subroutine compare(one, other, whole)
    character(len=*), intent(in) :: one, other
    type(simulation_t), intent(in) :: whole
    type(field_t), allocatable :: fields(:)
    type(hdf5_file_t) :: a, b
    integer(i4), allocatable :: order_a(:), order_b(:)
    integer(i4), allocatable :: feature(:)
    integer :: i

    call a%open(one, is_read_only=.true.)
    call b%open(other, is_read_only=.true.)
    call compare_numbers(a, b, '/time', other)
    call compare_numbers(a, b, '/totals', other)
    fields = fields_in_files(whole%scene%bodies)
    do i = 1, size(fields)
      call compare_numbers(a, b, '/bodies/'//trim(fields(i)%name), other)
    end do
    call a%get('/contacts/feature', feature)
    call order_of(feature, order_a)
    call b%get('/contacts/feature', feature)
    call order_of(feature, order_b)
    call t%equal(size(order_b), size(order_a), 'contacts of '//other)
    if (size(order_a) /= size(order_b)) return
    fields = fields_in_files(whole%contacts)
    do i = 1, size(fields)
      call compare_numbers(a, b, '/contacts/'//trim(fields(i)%name), other, order_a, order_b)
    end do
    call t%check(.not. allocated(a%error) .and. .not. allocated(b%error), other//' is read')
    call a%close()
    call b%close()
  end subroutine compare

  !> Features are 7 k for contact k here: where each contact stands.
  subroutine order_of(feature, order)
    integer(i4), intent(in) :: feature(:)
    integer(i4), allocatable, intent(out) :: order(:)
    integer :: i

    allocate (order(size(feature)), source=1_i4)
    do i = 1, size(feature)
      if (modulo(feature(i), 7) == 0 .and. feature(i)/7 <= size(order)) order(feature(i)/7) = int(i, i4)
    end do
  end subroutine order_of

  !> Compare a dataset bit for bit, rows in an order given.
  subroutine compare_numbers(a, b, path, what, order_a, order_b)
    type(hdf5_file_t), intent(inout) :: a, b
    character(len=*), intent(in) :: path, what
    integer(i4), intent(in), optional :: order_a(:), order_b(:)
    real(wp), allocatable :: one(:, :), other(:, :)
    logical :: is_same

    call a%get(path, one)
    call b%get(path, other)
    is_same = all(shape(one) == shape(other))
    if (is_same .and. present(order_a) .and. present(order_b)) then
      one = one(:, order_a)
      other = other(:, order_b)
    end if
    if (is_same) is_same = all(transfer(one, [0_i8]) == transfer(other, [0_i8]))
    call t%check(is_same, path//' of '//what)
  end subroutine compare_numbers

  !> Read a file on all ranks: each has the whole scene, and the first one the sums of the run.
  subroutine read_again(folder, dimension, n, turns, whole)
    character(len=*), intent(in) :: folder
    integer, intent(in) :: dimension, n
    logical, intent(in) :: turns
    type(simulation_t), intent(in) :: whole
    type(simulation_t), pointer :: sim
    type(diagnostics_t) :: warnings
    type(error_t), allocatable :: error
    real(wp) :: sums(3)

    call begin(folder, dimension, n, turns, sim)
    sim%comm = comm
    call load_checkpoint(sim, folder, warnings, error)
    call t%check(.not. allocated(error), folder//' is read')
    if (allocated(error)) then
      write (*, '(a)') error%report()
      return
    end if
    call t%equal(sim%step, 1234, 'step')
    call t%check(all(transfer(sim%scene%bodies%position, [0_i8]) == transfer(whole%scene%bodies%position, [0_i8])), 'positions')
    call t%check(all(transfer(sim%scene%bodies%velocity, [0_i8]) == transfer(whole%scene%bodies%velocity, [0_i8])), 'velocities')
    call t%check(all(sim%scene%bodies%crossings == whole%scene%bodies%crossings), 'periods crossed')
    sums = [sim%energy%external_work, real(sim%totals%contact_updates, wp), real(sim%contacts%n, wp)]
    call comm%sum(sums)
    call t%equal(nint(sums(3)), whole%contacts%n, 'contacts, over all ranks')
    call t%check(sim%contacts%n <= whole%contacts%n/comm%size + 1, 'no rank has more than its piece')
    call t%near(sums(1), 5.0_wp, 0.0_wp, 'work, over all ranks')
    call t%near(sums(2), 1000.0_wp, 0.0_wp, 'contact updates, over all ranks')
    ! Of another number of bodies the scene is another one, and all ranks say so.
    if (comm%rank == 0) call begin(folder, dimension, n + 1, turns, sim)
    sim%comm = comm
    call load_checkpoint(sim, folder, warnings, error)
    call t%check(allocated(error), 'a file that does not fit one rank is refused by all')
    if (allocated(error)) call t%check(index(error%message, 'does not fit') > 0, 'and it is said why')
  end subroutine read_again

  !> Read a file on ranks that hold a share each: they get the state of their bodies, and when all is split each contact comes to
  !! its owner, once.
  subroutine read_share(folder, dimension, n, turns, whole)
    character(len=*), intent(in) :: folder
    integer, intent(in) :: dimension, n
    logical, intent(in) :: turns
    type(simulation_t), intent(in) :: whole
    type(simulation_t), pointer :: sim
    type(scene_t) :: fresh
    type(contacts_t) :: none, own
    type(diagnostics_t) :: warnings
    type(error_t), allocatable :: error
    type(parcel_t) :: parcel
    type(random_t) :: random
    integer(i4), allocatable :: owner(:)
    real(wp) :: total(1)
    integer :: b, k

    call begin(folder, dimension, n, turns, sim)
    fresh = sim%scene
    none%dimension = dimension
    call random%seed(22)
    call draw_owners(fresh, comm%size, random, owner)
    call take_part(fresh, none, owner, comm%rank, comm%size, sim%scene, own)
    sim%comm = comm
    call load_checkpoint(sim, folder, warnings, error)
    call t%check(.not. allocated(error), folder//' is read by shares')
    if (allocated(error)) write (*, '(a)') error%report()
    if (allocated(error)) return
    associate (bodies => sim%scene%bodies, there => whole%scene%bodies)
      do b = 1, bodies%n
        associate (number => bodies%id(b))
          call t%check(all(transfer([bodies%position(:, b), bodies%velocity(:, b)], [0_i8]) == &
                           transfer([there%position(:, number), there%velocity(:, number)], [0_i8])), 'state of a body')
          call t%equal(int(bodies%crossings(b)), int(there%crossings(number)), 'its periods crossed')
          if (allocated(bodies%angle)) call t%near(bodies%angle(b), there%angle(number), 0.0_wp, 'its angle')
          if (allocated(bodies%orientation)) &
            call t%near(norm2(bodies%orientation(:, b) - there%orientation(:, number)), 0.0_wp, 0.0_wp, 'its orientation')
        end associate
      end do
    end associate
    call distribute_contacts(sim%contacts, sim%scene, fresh%contactors%n, comm, parcel)
    own%dimension = dimension
    own%n_components = sim%contacts%n_components
    own%n_internal = sim%contacts%n_internal
    call unpack_contacts(parcel, fresh, own)
    total = real(own%n, wp)
    call comm%sum(total)
    call t%equal(nint(total(1)), whole%contacts%n, 'each contact comes to one rank')
    do k = 1, own%n
      associate (number => own%feature(k)/7)
        call t%equal(contact_owner(owner(own%body(:, k))), comm%rank, 'which owns it')
        call t%check(all(own%contactor(:, k) == whole%contacts%contactor(:, number)), 'its contactors')
        call t%near(norm2(own%impulse(:, k) - whole%contacts%impulse(:, number)), 0.0_wp, 0.0_wp, 'its impulse')
        call t%equal(int(own%image(k)), int(whole%contacts%image(number)), 'its image')
        call t%near(abs(own%internal(1, k) - whole%contacts%internal(1, number)), 0.0_wp, 0.0_wp, 'its internal value')
        call t%equal(int(own%status(k)), int(whole%contacts%status(number)), 'its status')
        ! Files of one rank hold contacts in the order of numbers here, and pieces keep it.
        if (k > 1 .and. index(folder, '_one') > 0) call t%check(own%feature(k) > own%feature(k - 1), 'in the order of the file')
      end associate
    end do
  end subroutine read_share

  !> A contact that does not fit stands in the piece of one rank alone: all refuse the file.
  subroutine test_bad_piece()
    type(simulation_t), pointer :: whole, sim
    type(random_t) :: random
    type(diagnostics_t) :: warnings
    type(error_t), allocatable :: error

    call t%check(make_folder('bad'), 'a folder')
    call begin('bad', 2, 57, .true., whole)
    sim => fresh(whole)
    call random%seed(23)
    call chain_of_contacts(whole%scene, 1, random, whole%contacts)
    whole%contacts%law(whole%contacts%n) = 9
    if (comm%rank == 0) call save_checkpoint(whole, error)
    if (comm%any(allocated(error))) return
    sim%comm = comm
    call load_checkpoint(sim, 'bad', warnings, error)
    call t%check(allocated(error), 'a contact that does not fit is refused by all')
    if (allocated(error)) call t%check(index(error%message, 'laws that the scene does not have') > 0, error%message)
  end subroutine test_bad_piece

  !> A folder that is not there, and a disk with little room where one is named in the environment.
  subroutine test_no_folder()
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    character(len=200) :: folder
    integer :: length, i

    call begin('no/such/folder', 2, 8, .true., sim)
    call give_numbers(sim)
    sim%comm = comm
    sim%signature = signature_of(sim%scene, alone)
    call save_checkpoint(sim, error)
    call t%check(allocated(error), 'a folder must exist')
    if (allocated(error)) call t%equal(error%code, exit_output, 'exit code')
    call get_environment_variable('SPLITGRAIN_SMALL_DISK', folder, length)
    if (length == 0) return
    call begin(trim(folder), 2, 8000, .true., sim)
    call give_numbers(sim)
    call remove_file(trim(folder)//'/restart_a.h5')
    call remove_file(trim(folder)//'/restart_b.h5')
    sim%comm = comm
    sim%signature = signature_of(sim%scene, alone)
    do i = 1, 3
      call save_checkpoint(sim, error)
      if (i == 1) call t%check(.not. allocated(error), 'there is room for one file')
      if (allocated(error)) exit
    end do
    call t%check(allocated(error), 'but not for three')
    if (allocated(error)) call t%check(index(error%message, 'No space left on device') > 0, 'and it is said why: '//error%message)
    ! The second or the third one had no room.
    call t%check(newest_restart(trim(folder)) == trim(folder)//'/restart_'//merge('a', 'b', i == 2)//'.h5', 'the older file stays')
    call t%check(.not. (file_exists(trim(folder)//'/restart_a.h5.part') .or. &
                        file_exists(trim(folder)//'/restart_b.h5.part')), 'and nothing unfinished')
  end subroutine test_no_folder

  !> Deal bodies out in turns.
  subroutine give_numbers(sim)
    type(simulation_t), intent(inout) :: sim
    type(scene_t) :: whole
    type(contacts_t) :: contacts, none
    integer(i4), allocatable :: owner(:)
    integer :: b

    whole = sim%scene
    none%dimension = 2
    allocate (owner(whole%bodies%n), source=-1_i4)
    do b = 1, whole%bodies%n
      if (whole%bodies%is_grain(b)) owner(b) = int(modulo(b, comm%size), i4)
    end do
    call take_part(whole, none, owner, comm%rank, comm%size, sim%scene, contacts)
  end subroutine give_numbers
end program test_restart
