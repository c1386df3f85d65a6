!> Restart files: all that a run needs to go on as if it had never stopped, bit for bit.
!!
!! Two files take turns, `restart_a.h5` and `restart_b.h5`. Each is written under another name
!! (sg_settle_file), so that at any time at least one of them is whole. doc/guide/files.md lists the datasets.
!!
!! Ranks that share a scene write one file together, in the same layout: bodies by number, contacts rank by rank. Any
!! number of ranks can go on from it. Then none reads it whole: each takes the rows of the bodies that it holds, and a piece of the
!! contacts, as many as the others, which it sends to their owners when the scene is split (sg_contact_migration).
module sg_restart
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_bodies, only: bodies_t
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_error, only: diagnostics_t, error_t, fail
  use sg_field_visitor, only: kind_byte
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i1, i4, i8
  use sg_laws, only: last_status, status_new
  use sg_picked_rows, only: picked_rows_t
  use sg_restart_datasets, only: check_shapes, dataset_paths, scene_misfit
  use sg_restart_fields, only: get_fields, keep_fields, kept_field_t, put_fields, restore_fields, values_of
  use sg_restart_files, only: find_newest, restart_names
  use sg_restart_fit, only: add_moments, bodies_of_file, fit_fields, fit_impulses, fit_moments
  use sg_scene, only: scene_t
  use sg_sealed_datasets, only: check_seals, put_sealed
  use sg_settle_file, only: part_of, settle_file
  use sg_system, only: remove_file
  use sg_text, only: to_text
  use sg_version, only: commit, version
  implicit none
  private
  public :: restart_t, keep_state, restore_state, write_restart, read_restart

  !> Attributes that mark a restart file and its layout
  character(len=*), parameter :: format_name = 'SplitGrain restart'
  integer(i8), parameter :: format_version = 3
  !> Largest error of the length of a unit quaternion
  real(wp), parameter :: largest_drift = 1e-6_wp

  !> The state of a run at the end of a step; where ranks share it, of some bodies and of some contacts
  type :: restart_t
    !> Steps done, and time [s]
    integer :: step = 0
    real(wp) :: time = 0
    !> Hash of the effective deck
    character(len=:), allocatable :: deck_hash
    !> Fields of bodies and of contacts that files hold
    type(kept_field_t), allocatable :: bodies(:), contacts(:)
    !> Configuration at the making of the list of neighbours, and the margin of each body below it [m]
    real(wp), allocatable :: built(:, :)
    !> Sums kept over the run, such as works of forces
    real(wp), allocatable :: totals(:)
    !> What tracked bodies (sg_tracks) and end conditions (sg_stop) keep; empty where there are none
    real(wp), allocatable :: tracks(:), stop(:)
    !> Where the stages of the run began and ended (sg_stages); empty where it has none
    real(wp), allocatable :: stages(:)
    !> Sums over the recorded interval (sg_means); empty where no means are asked for
    real(wp), allocatable :: means(:)
    !> Samples of fields since their last grids (sg_fields_on_grid); empty where there are none
    real(wp), allocatable :: fields(:)
    !> State of the periodic cell (sg_periodic_cell); empty where there is none
    real(wp), allocatable :: cell(:)
    !> Length of the last substep [s], over which impulses are; empty in files that have none
    real(wp), allocatable :: length(:)
    !> Measures of this step in the order of record.csv; empty where they were not taken
    real(wp), allocatable :: measures(:)
  end type restart_t

contains

  !> Copy the state of bodies and contacts; the caller sets the other components.
  subroutine keep_state(bodies, contacts, state, number)
    type(bodies_t), intent(in) :: bodies !! bodies at the end of the step; where ranks share them, a block of them by number
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(restart_t), intent(inout) :: state !! state to set
    integer(i4), intent(in), optional :: number(:) !! numbers of the contactors in the whole scene, where they differ
    integer :: i, k

    call keep_fields(bodies, bodies%n, state%bodies)
    call keep_fields(contacts, contacts%n, state%contacts)
    call forget(state%contacts)
    if (.not. present(number)) return
    do i = 1, size(state%contacts)
      if (state%contacts(i)%field%name /= 'contactor') cycle
      do k = 1, contacts%n
        state%contacts(i)%values(:, k) = real(number(contacts%contactor(:, k)), wp)
      end do
    end do
  end subroutine keep_state

  !> Forget what stands where nothing is kept of a contact, so that equal states have equal files.
  pure subroutine forget(fields)
    type(kept_field_t), intent(inout) :: fields(:)
    real(wp), allocatable :: is_kept(:, :)
    integer :: i

    is_kept = values_of(fields, 'is_kept')
    if (size(is_kept) == 0) return
    do i = 1, size(fields)
      if (fields(i)%field%name == 'kept') &
        fields(i)%values = merge(fields(i)%values, 0.0_wp, spread(is_kept(1, :) > 0, 1, size(fields(i)%values, 1)))
    end do
  end subroutine forget

  !> Put bodies and contacts into a state; of contacts only what recovery by pair needs is set. Where ranks share the scene
  !! contacts keep the numbers that contactors have in it.
  subroutine restore_state(state, scene, contacts)
    type(restart_t), intent(in) :: state !! state to restore
    type(scene_t), intent(inout) :: scene !! bodies to set
    type(contacts_t), intent(inout) :: contacts !! contacts to set
    integer :: i

    call restore_fields(state%bodies, scene%bodies)
    contacts%n = size(values_of(state%contacts, 'feature'), 2)
    contacts%dimension = scene%dimension
    contacts%n_components = size(values_of(state%contacts, 'impulse'), 1)
    contacts%n_internal = size(values_of(state%contacts, 'internal'), 1)
    call reserve_contacts(contacts, contacts%n)
    call restore_fields(state%contacts, contacts)
    if (allocated(scene%contactors%id)) return
    do i = 1, contacts%n
      contacts%body(:, i) = scene%contactors%body(contacts%contactor(:, i))
    end do
  end subroutine restore_state

  !> Write the state in place of the older of the two files.
  subroutine write_restart(folder, state, comm, error)
    character(len=*), intent(in) :: folder !! folder of the results
    type(restart_t), intent(in) :: state !! state to write, all components set; totals, step and time are the same on all ranks
    type(comm_t), intent(inout) :: comm !! ranks that share the scene
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written; older files stay
    character(len=:), allocatable :: name, part
    integer :: newest
    integer(i8) :: serial

    newest = 0
    serial = 0
    if (comm%rank == 0) call find_newest(folder, newest, serial)
    call comm%broadcast(newest, 0)
    call comm%broadcast(serial, 0)
    name = folder//'/'//restart_names(merge(2, 1, newest == 1))
    part = part_of(name)
    if (comm%rank == 0) call remove_file(part)
    call write_file(part, state, serial + 1, comm, error)
    ! All ranks have written their part: one of them gives the file its name.
    if (comm%rank == 0) call settle_file(part, name, error)
    call comm%agree(error)
  end subroutine write_restart

  !> Write all datasets.
  subroutine write_file(name, state, serial, ranks, error)
    character(len=*), intent(in) :: name
    type(restart_t), intent(in) :: state
    integer(i8), intent(in) :: serial
    type(comm_t), intent(inout) :: ranks
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file

    call file%share(ranks)
    call file%create(name, is_checked=.true.)
    call file%set('/', 'format', format_name)
    call file%set('/', 'format_version', format_version)
    call file%set('/', 'program', 'SplitGrain '//version//' ('//commit//')')
    call file%set('/', 'deck_hash', state%deck_hash)
    call file%set('/', 'serial', serial)
    call file%set('/', 'step', int(state%step, i8))
    call put_sealed(file, '/time', [state%time], is_common=.true.)
    call put_sealed(file, '/totals', state%totals, is_common=.true.)
    call put_optional(file, '/tracks', state%tracks)
    call put_optional(file, '/stop', state%stop)
    call put_optional(file, '/stages', state%stages)
    call put_optional(file, '/means', state%means)
    call put_optional(file, '/fields', state%fields)
    call put_optional(file, '/cell', state%cell)
    call put_optional(file, '/length', state%length)
    call put_optional(file, '/measures', state%measures)
    call put_sealed(file, '/built', state%built)
    call put_fields(file, '/bodies', state%bodies)
    call put_fields(file, '/contacts', state%contacts)
    ! Other ranks may sit on other machines, whose part is brought to the disk from there.
    if (ranks%size > 1) call file%flush()
    call file%close()
    call ranks%collect(file%ranks)
    if (allocated(file%error)) call move_alloc(file%error, error)
  end subroutine write_file

  !> Read a state and see whether it fits the scene, which may be one with or without friction.
  subroutine read_restart(name, scene, comm, state, diagnostics, bodies, contactors, components, internal, is_damaged, carried, &
                          kept, moments)
    character(len=*), intent(in) :: name !! path of the file
    type(scene_t), intent(in) :: scene !! scene that it must fit, or the part of a rank
    type(comm_t), intent(inout) :: comm !! ranks that read the file, each its piece of the contacts
    type(restart_t), intent(out) :: state !! state read: of the bodies of `scene`
    type(diagnostics_t), intent(inout) :: diagnostics !! takes what is wrong
    integer, intent(in), optional :: bodies !! bodies of the whole scene, where ranks share it
    integer, intent(in), optional :: contactors !! contactors of the whole scene
    integer, intent(in), optional :: components !! of an impulse, as many as dimensions unless given
    integer, intent(in), optional :: internal !! internal values of a contact, none unless given
    logical, intent(out), optional :: is_damaged !! is the file itself at fault, and not of another scene?
    integer, intent(in), optional :: carried !! values of a contact that the solver's method carries, none unless given
    integer, intent(in), optional :: kept !! values of a contact that detection keeps, none unless given
    integer, intent(in), optional :: moments !! components of a contact's moment, the last internal values; none unless given
    type(hdf5_file_t) :: file
    character(len=:), allocatable :: misfit
    type(bodies_t) :: like
    type(contacts_t) :: contacts
    integer :: whole(2), wanted, wanted_internal

    whole = [scene%bodies%n, scene%contactors%n]
    if (present(bodies)) whole(1) = bodies
    if (present(contactors)) whole(2) = contactors
    contacts%dimension = scene%dimension
    contacts%has_cell = scene%cell%is_on
    contacts%n_components = scene%dimension
    if (present(components)) contacts%n_components = components
    if (present(internal)) contacts%n_internal = internal
    if (present(carried)) contacts%n_carried = carried
    if (present(kept)) contacts%n_kept = kept
    if (present(moments)) contacts%n_moments = moments
    wanted_internal = contacts%n_internal
    wanted = contacts%n_components
    call file%open(name, is_read_only=.true.)
    call check_format(file)
    call fit_moments(file, contacts)
    misfit = scene_misfit(file, scene, whole(1), contacts%n_internal)
    like = bodies_of_file(file, scene%bodies)
    call fit_impulses(file, contacts)
    if (len(misfit) == 0) call check_shapes(file, like, whole(1), contacts)
    call check_seals(file, dataset_paths(file, like, contacts), comm)
    if (len(misfit) == 0 .and. .not. allocated(file%error)) call read_file(file, scene, like, contacts, comm, state)
    call file%close()
    if (present(is_damaged)) is_damaged = allocated(file%error)
    if (allocated(file%error)) then
      call diagnostics%add(file%error%message, file=name)
      return
    end if
    if (len(misfit) == 0) misfit = misfit_of(state, whole(2), number_of_laws(scene))
    if (len(misfit) > 0) then
      call diagnostics%add('this restart file does not fit the scene: '//misfit, file=name)
    else if (len(fault_of(state)) > 0) then
      if (present(is_damaged)) is_damaged = .true.
      call diagnostics%add('this restart file is damaged: '//fault_of(state), file=name)
    else
      call fit_state(state, scene, wanted)
      call add_moments(state%contacts, contacts, wanted_internal)
    end if
  end subroutine read_restart

  !> Give a state the components of the scene. A list of neighbours of other components is dropped, and so made again.
  pure subroutine fit_state(state, scene, components)
    type(restart_t), intent(inout) :: state
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: components !! of an impulse in the scene

    call fit_fields(state%bodies, 'velocity', scene%bodies%n_velocity, scene%dimension)
    call fit_fields(state%contacts, 'impulse', components, merge(1, 0, scene%dimension == 2))
    if (size(state%built, 1) == scene%bodies%n_configuration() + 1) return
    deallocate (state%built)
    allocate (state%built(scene%bodies%n_configuration() + 1, 0))
  end subroutine fit_state

  !> Read all datasets of an open file; of several ranks each its rows.
  subroutine read_file(file, scene, bodies, contacts, ranks, state)
    type(hdf5_file_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene
    type(bodies_t), intent(in) :: bodies !! bodies with the components of the file
    type(contacts_t), intent(in) :: contacts !! contacts with the components of the file
    type(comm_t), intent(in) :: ranks
    type(restart_t), intent(out) :: state
    type(picked_rows_t) :: rows, pieces
    integer(i8) :: number
    real(wp), allocatable :: time(:)

    call file%look('/', 'deck_hash', state%deck_hash)
    call file%look('/', 'step', number)
    if (number < 0 .or. number > int(huge(state%step), i8)) then
      if (.not. allocated(file%error)) call fail(file%error, 'its step is '//to_text(number), file=file%name)
      return
    end if
    state%step = int(number)
    call file%get('/time', time)
    if (size(time) == 1) state%time = time(1)
    call file%get('/totals', state%totals)
    call get_optional(file, '/tracks', state%tracks)
    call get_optional(file, '/stop', state%stop)
    call get_optional(file, '/stages', state%stages)
    call get_optional(file, '/means', state%means)
    call get_optional(file, '/fields', state%fields)
    call get_optional(file, '/cell', state%cell)
    call get_optional(file, '/length', state%length)
    call get_optional(file, '/measures', state%measures)
    ! One rank alone takes up its list of neighbours.
    if (ranks%size == 1) call file%get('/built', state%built)
    if (.not. allocated(state%built)) allocate (state%built(0, 0))
    if (allocated(scene%bodies%id)) call rows%pick(scene%bodies%id)
    if (ranks%size > 1) call pieces%pick_piece(file, '/contacts/feature', ranks%rank, ranks%size)
    call get_fields(file, '/bodies', rows, bodies, state%bodies)
    call get_fields(file, '/contacts', pieces, contacts, state%contacts)
  end subroutine read_file

  !> Write a list that is the same on all ranks, unless it is empty.
  subroutine put_optional(file, path, values)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), allocatable, intent(in) :: values(:)

    if (.not. allocated(values)) return
    if (size(values) > 0) call put_sealed(file, path, values, is_common=.true.)
  end subroutine put_optional

  !> Read a list that may not be there: then it is empty.
  subroutine get_optional(file, path, values)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), allocatable, intent(out) :: values(:)

    if (file%has(path)) call file%get(path, values)
    if (.not. allocated(values)) allocate (values(0))
  end subroutine get_optional

  !> Is an open file a restart file, in a layout that can be read?
  subroutine check_format(file)
    type(hdf5_file_t), intent(inout) :: file
    character(len=:), allocatable :: word
    integer(i8) :: number
    logical :: was_opened

    was_opened = .not. allocated(file%error)
    call file%look('/', 'format', word)
    if (was_opened .and. word /= format_name) then
      call fail(file%error, 'this is no restart file of SplitGrain', file=file%name)
      return
    end if
    call file%look('/', 'format_version', number)
    if (.not. allocated(file%error) .and. number /= format_version) &
      call fail(file%error, 'this restart file has the layout '//to_text(number)//', but this program reads layout '// &
                to_text(format_version), file=file%name)
  end subroutine check_format

  !> Why a state does not fit a scene; empty when it does.
  pure function misfit_of(state, contactors, laws) result(misfit)
    type(restart_t), intent(in) :: state
    integer, intent(in) :: contactors, laws
    character(len=:), allocatable :: misfit

    misfit = ''
    associate (contactor => values_of(state%contacts, 'contactor'), law => values_of(state%contacts, 'law'))
      if (any(contactor < 1) .or. any(contactor > real(contactors, wp))) then
        misfit = 'it holds contacts of shapes that the scene does not have'
      else if (any(law < 1) .or. any(law > real(laws, wp))) then
        misfit = 'it holds contacts under laws that the scene does not have'
      end if
    end associate
  end function misfit_of

  !> Values that no run can have written; empty when all is well. Parts of `totals` are checked by the modules that own them.
  pure function fault_of(state) result(fault)
    type(restart_t), intent(in) :: state
    character(len=:), allocatable :: fault
    integer :: i

    fault = ''
    associate (status => values_of(state%contacts, 'status'), orientation => values_of(state%bodies, 'orientation'))
      if (.not. (ieee_is_finite(state%time) .and. all(ieee_is_finite(state%built)) .and. are_finite(state%bodies) .and. &
                 are_finite(state%contacts))) then
        fault = 'it holds numbers that are not finite'
      else if (any(abs(norm2(orientation, 1) - 1) > largest_drift)) then
        fault = 'it holds orientations that are no rotations'
      else if (any(status < status_new) .or. any(status > last_status)) then
        fault = 'it holds contacts in a state that there is none'
      end if
    end associate
    do i = 1, size(state%contacts)
      associate (one => state%contacts(i))
        if (len(fault) == 0 .and. one%field%kind == kind_byte .and. any(abs(one%values) > huge(1_i1))) &
          fault = 'it holds contacts with a value of '//trim(one%field%name)//' out of range'
      end associate
    end do
  end function fault_of

  !> Are all values of some fields finite?
  pure logical function are_finite(kept)
    type(kept_field_t), intent(in) :: kept(:)
    integer :: i

    are_finite = all([(all(ieee_is_finite(kept(i)%values)), i=1, size(kept))])
  end function are_finite

  !> Number of contact laws of a scene.
  pure integer function number_of_laws(scene) result(n)
    type(scene_t), intent(in) :: scene

    n = 0
    if (allocated(scene%laws)) n = size(scene%laws)
  end function number_of_laws
end module sg_restart
