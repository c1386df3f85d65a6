!> Pictures that ranks write together: bodies and shapes stand in them as one rank writes them, bit for bit, and contacts
!! are the same ones; a run is taken up by other numbers of ranks; a full disk is one error on all ranks.
program test_output
  use harness, only: tests_t
  use rank_parts, only: chain_of_contacts, draw_owners, plane_scene, shake, space_scene, take_part
  use sg_bodies, only: drop_rotation
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t, exit_output
  use sg_hdf5, only: hdf5_file_t, hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp, i4, i8
  use sg_pictures, only: pictures_t
  use sg_random, only: random_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_system, only: make_folder
  use sg_text, only: read_lines, text_t, to_text
  implicit none
  !> Steps that are drawn, from 0; contacts of one of them are missing
  integer, parameter :: last_step = 3, empty_step = 2
  type(tests_t) :: t
  type(comm_t) :: comm, alone
  type(random_t) :: random

  call comm%start()
  if (hdf5_is_available() .and. (hdf5_is_parallel() .or. comm%size == 1)) then
    call test_files()
    call test_scene('plane', 2, 60, turns=.true., is_compressed=.false.)
    call test_scene('space', 3, 50, turns=.true., is_compressed=.true.)
    ! Fewer grains than ranks, which do not turn.
    call test_scene('few', 2, 2, turns=.false., is_compressed=.false.)
    call test_scene('few_in_space', 3, 3, turns=.false., is_compressed=.false.)
    call test_full_disk()
  else
    call test_without_sharing()
  end if
  call t%finish(comm)

contains

  !> Rows of all ranks, common rows, ranks without rows, and growth.
  subroutine test_files()
    type(hdf5_file_t) :: file, again
    real(wp), allocatable :: list(:), table(:, :), part(:, :)
    integer(i8), allocatable :: longs(:)
    real(wp), allocatable :: own(:)
    integer(i8) :: before
    integer :: i, r, n

    r = comm%rank
    ! Rank r has r numbers: rank 0 none.
    own = [(real(100*r + i, wp), i=1, r)]
    n = comm%size*(comm%size - 1)/2
    call file%share(comm)
    call file%create('shared.h5')
    call file%group('/a')
    call file%put('/a/list', own)
    call file%put('/a/table', reshape([own, own], [2, r]))
    call file%put('/a/common', [3.0_wp, 4.0_wp], is_common=.true.)
    call file%put('/a/text', 'some words')
    call file%set('/a', 'number', 17_i8)
    call file%declare('/a/grown', 1, 2, 4, .true.)
    call file%append('/a/grown', reshape([own, own], [2, r]))
    call file%append('/a/grown', reshape([5.0_wp, 6.0_wp], [2, 1]), is_common=.true.)
    call file%append('/a/grown', reshape([own, own], [2, r]))
    call file%declare('/a/steps', 3, 0, 64, .false.)
    call file%append('/a/steps', [7_i8], is_common=.true.)
    call t%equal(int(file%total(r)), n, 'rows of all ranks')
    call file%close()
    call t%check(.not. allocated(file%error), 'ranks write a file together')
    before = comm%traffic%collectives
    call comm%collect(file%ranks)
    ! All ranks settle after each of the 13 calls that write.
    if (comm%size > 1) call t%check(comm%traffic%collectives - before >= 13, 'the traffic of a file is counted')
    if (comm%size == 1) call t%equal(int(comm%traffic%collectives - before), 0, 'one rank has no traffic')
    if (allocated(file%error)) then
      write (*, '(a)') file%error%report()
      return
    end if
    call again%open('shared.h5', is_read_only=.true.)
    call again%get('/a/list', list)
    call t%equal(size(list), n, 'length of a list')
    own = [((real(100*r + i, wp), i=1, r), r=0, comm%size - 1)]
    if (size(list) == n) call t%check(.not. any(abs(list - own) > 0), 'the rows follow one another')
    call again%get('/a/common', list)
    call t%equal(size(list), 2, 'common rows stand once')
    call again%get('/a/grown', table)
    call t%equal(size(table, 2), 2*n + 1, 'rows of a dataset that grew')
    if (size(table, 2) == 2*n + 1) call t%near(sum(abs(table(:, n + 1) - [5.0_wp, 6.0_wp])), 0.0_wp, 0.0_wp, 'a common row')
    call again%get_rows('/a/grown', int(n, i8), 1, part)
    call t%near(sum(part), 11.0_wp, 0.0_wp, 'some rows are read')
    call again%get('/a/steps', longs)
    call t%equal(int(longs(1)), 7, 'a long integer')
    call again%close()
    call t%check(.not. allocated(again%error), 'and it is read')
    call file%share(comm)
    call file%create('no/such/folder/shared.h5')
    call t%check(allocated(file%error), 'a folder must exist')
    if (allocated(file%error)) call t%check(index(file%error%message, 'No such file or directory') > 0, 'and that is said')
    call file%put('/list', own)
    call file%close()
  end subroutine test_files

  !> Draw a scene on one rank and on all of them, and compare the files.
  subroutine test_scene(name, dimension, n, turns, is_compressed)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension, n
    logical, intent(in) :: turns, is_compressed
    type(run_options_t) :: options
    type(scene_t) :: whole

    if (dimension == 2) call plane_scene(whole, n)
    if (dimension == 3) call space_scene(whole, n)
    if (.not. turns) call drop_rotation(whole%bodies, keep_orientation=dimension == 3)
    options%time_step = 0.01_wp
    options%deck_hash = 'cafe'
    options%output_compressed = is_compressed
    options%folder = name//'_one'
    call t%check(make_folder(options%folder), 'a folder')
    if (comm%rank == 0) call draw(whole, options, 0, last_step, alone, 1)
    options%folder = name//'_all'
    call t%check(make_folder(options%folder), 'a folder')
    call draw(whole, options, 0, last_step, comm, 1)
    call compare(name, name//'_all')
    ! All grains on the last rank, and a run that is taken up after step 1 by all ranks; of few grains some ranks have none anyway.
    if (n > 3) then
      options%folder = name//'_last'
      call t%check(make_folder(options%folder), 'a folder')
      call draw(whole, options, 0, 2, comm, 2)
      call draw(whole, options, 2, last_step, comm, 1)
      call compare(name, name//'_last')
    end if
    ! Begun by one rank, gone on with by all after step 0, ended by one.
    options%folder = name//'_mixed'
    call t%check(make_folder(options%folder), 'a folder')
    if (comm%rank == 0) call draw(whole, options, 0, 1, alone, 1)
    if (comm%any(.false.)) return
    if (is_compressed .and. comm%size > 1) then
      call check_refused(whole, options)
      return
    end if
    call draw(whole, options, 1, 2, comm, 1)
    if (comm%rank == 0) call draw(whole, options, 3, last_step, alone, 1)
    call compare(name, name//'_mixed')
  end subroutine test_scene

  !> Several ranks cannot go on with a compressed file, and say so.
  subroutine check_refused(whole, options)
    type(scene_t), intent(in) :: whole
    type(run_options_t), intent(in) :: options
    type(pictures_t) :: pictures
    type(scene_t) :: scene
    type(contacts_t) :: contacts, none
    type(error_t), allocatable :: error
    integer(i4), allocatable :: owner(:)

    none%dimension = whole%dimension
    none%n_components = whole%dimension
    call random%seed(9)
    call draw_owners(whole, comm%size, random, owner)
    call take_part(whole, none, owner, comm%rank, comm%size, scene, contacts)
    call pictures%open(scene, options, 1, error, comm)
    if (.not. allocated(error)) call pictures%write(scene, contacts, 2*options%time_step, 2, comm, error)
    call t%check(allocated(error), 'ranks do not go on with a compressed file')
    if (allocated(error)) call t%check(index(error%message, 'is compressed') > 0, 'and say why: '//error%message)
    call pictures%close(comm, error)
  end subroutine check_refused

  !> Draw some steps; a first step beyond 0 goes on with what is there.
  subroutine draw(whole, options, first, last, ranks, way)
    type(scene_t), intent(in) :: whole
    type(run_options_t), intent(in) :: options
    integer, intent(in) :: first, last, way
    type(comm_t), intent(inout) :: ranks
    type(pictures_t) :: pictures
    type(scene_t) :: now, scene
    type(contacts_t) :: all_contacts, contacts
    type(error_t), allocatable :: error
    integer(i4), allocatable :: owner(:)
    integer(i8) :: before
    integer :: step

    now = whole
    do step = 0, last
      call random%seed(100 + step)
      call shake(now, random)
      call chain_of_contacts(now, merge(0, min(1 + step, now%contactors%n - 1), step == empty_step), random, all_contacts)
      if (step < first - 1) cycle
      ! Bodies move between ranks from step to step.
      call draw_owners(now, ranks%size, random, owner)
      if (way == 2) owner = merge(-1, ranks%size - 1, owner < 0)
      call take_part(now, all_contacts, owner, ranks%rank, ranks%size, scene, contacts)
      if (step == max(0, first - 1)) then
        call pictures%open(scene, options, first - 1, error, ranks)
        call t%check(.not. allocated(error), 'files of '//options%folder//' are opened')
        if (allocated(error)) write (*, '(a)') error%report()
      end if
      if (step < first) cycle
      before = ranks%traffic%collectives
      call pictures%write(scene, contacts, real(step, wp)*options%time_step, step, ranks, error)
      ! Three files with more than twenty datasets, after each of which the ranks settle.
      if (ranks%size > 1) call t%check(ranks%traffic%collectives - before >= 20, 'the traffic of pictures is counted')
      call t%check(.not. allocated(error), 'step '//to_text(step)//' of '//options%folder//' is written')
      if (allocated(error)) write (*, '(a)') error%report()
    end do
    call pictures%close(ranks, error)
    call t%check(.not. allocated(error), 'files of '//options%folder//' are closed')
  end subroutine draw

  !> Compare the files of all ranks with those of one; rank 0 does it when all have finished.
  subroutine compare(name, folder)
    character(len=*), intent(in) :: name, folder
    logical :: waited

    waited = comm%any(.true.)
    if (comm%rank > 0) return
    call compare_file(name//'_one/bodies.vtkhdf', folder//'/bodies.vtkhdf', .true.)
    call compare_file(name//'_one/shapes.vtkhdf', folder//'/shapes.vtkhdf', .true.)
    call compare_file(name//'_one/contacts.vtkhdf', folder//'/contacts.vtkhdf', .false.)
    call compare_lines(name//'_one/bodies.xmf', folder//'/bodies.xmf')
    call compare_lines(name//'_one/shapes.xmf', folder//'/shapes.xmf')
    call compare_lines(name//'_one/contacts.xmf', folder//'/contacts.xmf')
    call compare_contacts(name//'_one/contacts.vtkhdf', folder//'/contacts.vtkhdf')
  end subroutine compare

  !> Compare all datasets of two files; of contacts, which stand in another order, those that do not depend on it.
  subroutine compare_file(one, other, is_ordered)
    character(len=*), intent(in) :: one, other
    logical, intent(in) :: is_ordered
    type(hdf5_file_t) :: a, b
    character(len=26), parameter :: groups(9) = [character(len=26) :: '', 'Steps', 'PointData', 'CellData', 'FieldData', &
      'Steps/PointDataOffsets', 'Steps/CellDataOffsets', 'Steps/FieldDataOffsets', 'Steps/FieldDataSizes']
    type(text_t), allocatable :: names(:), others(:)
    character(len=:), allocatable :: path
    integer :: g, i

    call a%open(one, is_read_only=.true.)
    call b%open(other, is_read_only=.true.)
    do g = 1, size(groups)
      if (.not. is_ordered .and. groups(g) == 'CellData') cycle
      path = '/VTKHDF/'//trim(groups(g))
      call a%names(path, names)
      call b%names(path, others)
      call t%equal(size(others), size(names), 'names in '//path//' of '//other)
      do i = 1, size(names)
        select case (names(i)%s)
        case ('Steps', 'PointData', 'CellData', 'FieldData', 'PointDataOffsets', 'CellDataOffsets', 'FieldDataOffsets', &
              'FieldDataSizes', 'rank')
          cycle
        case ('Points')
          if (.not. is_ordered) cycle
        end select
        call compare_numbers(a, b, path//'/'//names(i)%s, other)
      end do
    end do
    if (b%has('/XDMF')) call compare_numbers(a, b, '/XDMF/topology', other)
    call t%check(.not. allocated(a%error) .and. .not. allocated(b%error), other//' is read')
    call a%close()
    call b%close()
  end subroutine compare_file

  !> Compare one dataset bit for bit.
  subroutine compare_numbers(a, b, path, what)
    type(hdf5_file_t), intent(inout) :: a, b
    character(len=*), intent(in) :: path, what
    real(wp), allocatable :: one(:, :), other(:, :)
    logical :: is_same

    call a%get(path, one)
    call b%get(path, other)
    is_same = all(shape(one) == shape(other))
    if (is_same) is_same = all(transfer(one, [0_i8]) == transfer(other, [0_i8]))
    call t%check(is_same, path//' of '//what)
  end subroutine compare_numbers

  !> Compare the numbers of contacts, step by step in the order of their bodies.
  subroutine compare_contacts(one, other)
    character(len=*), intent(in) :: one, other
    character(len=16), parameter :: names(7) = [character(len=16) :: 'force_normal', 'force_tangential', 'gap', 'normal', &
                                                'point', 'status', 'antagonist']
    type(hdf5_file_t) :: a, b
    real(wp), allocatable :: from_a(:, :), from_b(:, :)
    integer(i4), allocatable :: order_a(:), order_b(:)
    integer :: i

    call a%open(one, is_read_only=.true.)
    call b%open(other, is_read_only=.true.)
    call find_order(a, order_a)
    call find_order(b, order_b)
    call t%equal(size(order_b), size(order_a), 'contacts of '//other)
    if (size(order_b) /= size(order_a)) return
    do i = 1, size(names)
      call a%get('/VTKHDF/CellData/'//trim(names(i)), from_a)
      call b%get('/VTKHDF/CellData/'//trim(names(i)), from_b)
      call t%check(all(transfer(from_a(:, order_a), [0_i8]) == transfer(from_b(:, order_b), [0_i8])), &
                   trim(names(i))//' of '//other)
    end do
    call a%get('/VTKHDF/Points', from_a)
    call b%get('/VTKHDF/Points', from_b)
    call t%near(sum(from_b), sum(from_a), 1e-9_wp*sum(abs(from_a)), 'ends of the lines of '//other)
    call a%close()
    call b%close()
  end subroutine compare_contacts

  !> Rows of contacts in the order of steps and within them of gaps, which all differ.
  subroutine find_order(file, order)
    type(hdf5_file_t), intent(inout) :: file
    integer(i4), allocatable, intent(out) :: order(:)
    integer(i8), allocatable :: first(:)
    real(wp), allocatable :: gap(:)
    integer :: s, i, k, last
    integer(i4) :: row

    call file%get('/VTKHDF/Steps/CellOffsets', first)
    call file%get('/VTKHDF/CellData/gap', gap)
    order = [(int(i, i4), i=1, size(gap))]
    do s = 1, size(first)
      last = size(gap)
      if (s < size(first)) last = int(first(s + 1))
      do i = int(first(s)) + 2, last
        row = order(i)
        k = i - 1
        do while (k > int(first(s)))
          if (gap(order(k)) <= gap(row)) exit
          order(k + 1) = order(k)
          k = k - 1
        end do
        order(k + 1) = row
      end do
    end do
  end subroutine find_order

  !> Compare two texts.
  subroutine compare_lines(one, other)
    character(len=*), intent(in) :: one, other
    type(text_t), allocatable :: a(:), b(:)
    type(error_t), allocatable :: error
    integer :: i

    call read_lines(one, a, error)
    if (.not. allocated(error)) call read_lines(other, b, error)
    call t%check(.not. allocated(error), other//' is there')
    if (allocated(error)) return
    call t%equal(size(b), size(a), 'lines of '//other)
    if (size(a) == size(b)) call t%check(all([(a(i)%s == b(i)%s, i=1, size(a))]), other//' says the same')
  end subroutine compare_lines

  !> A disk with little room, where a folder of one is named in the environment: one error on all ranks, and no hang.
  subroutine test_full_disk()
    type(hdf5_file_t) :: file
    character(len=200) :: folder
    real(wp), allocatable :: rows(:, :)
    integer :: length, i

    call get_environment_variable('SPLITGRAIN_SMALL_DISK', folder, length)
    if (length == 0) return
    allocate (rows(2, 10000), source=0.0_wp)
    call file%share(comm)
    call file%create(trim(folder)//'/full.h5')
    call t%check(.not. allocated(file%error), 'a file is begun on a small disk')
    call file%group('/a')
    call file%declare('/a/rows', 1, 2, 1000, .false.)
    do i = 1, 100000
      call file%append('/a/rows', rows)
      call file%flush()
      if (allocated(file%error)) exit
    end do
    call t%check(allocated(file%error), 'a full disk is noticed on all ranks')
    if (allocated(file%error)) then
      call t%check(index(file%error%message, 'No space left on device') > 0, 'and said: '//file%error%message)
      call t%equal(file%error%code, exit_output, 'with its exit code')
    end if
    call file%close()
    call file%share(comm)
    call file%create(trim(folder)//'/more.h5')
    call t%check(allocated(file%error), 'then no other file can be begun')
  end subroutine test_full_disk

  !> An HDF5 that knows no MPI says so.
  subroutine test_without_sharing()
    type(hdf5_file_t) :: file

    if (comm%rank == 0) write (*, '(a)') 'this build cannot share files between ranks: they are not tested'
    call file%share(comm)
    call file%create('shared.h5')
    call t%check(allocated(file%error), 'a file cannot be shared')
  end subroutine test_without_sharing
end program test_output
