!> Datasets of a restart file and the shapes that they have in a scene: looked at before anything is read, so that a file can
!! neither ask for more memory than it fills nor leave numbers out.
module sg_restart_datasets
  use sg_error, only: exit_output, fail
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: i8
  use sg_scene, only: scene_t
  use sg_text, only: append_word, text_t, to_text
  implicit none
  private
  public :: check_shapes, dataset_paths, scene_misfit

  !> What a dataset has rows for
  integer, parameter :: per_file = 0, per_body = 1, per_turning_body = 2, per_contact = 3

  !> A dataset, and numbers of its rows
  type :: dataset_t
    character(len=22) :: path = ''
    integer :: components = 1, rows_for = per_file
  end type dataset_t

contains

  !> Why a file is of another scene; empty when it is of this one, or cannot be read at all.
  function scene_misfit(file, scene, bodies, internal) result(misfit)
    type(hdf5_file_t), intent(inout) :: file !! open restart file
    type(scene_t), intent(in) :: scene !! scene that it must fit, or the part of a rank
    integer, intent(in) :: bodies !! bodies of the whole scene
    integer, intent(in) :: internal !! internal values of a contact
    character(len=:), allocatable :: misfit
    integer(i8) :: position(2), velocity(2), values(2)

    misfit = ''
    position = file%shape('/bodies/position')
    velocity = file%shape('/bodies/velocity')
    values = 0
    if (file%has('/contacts/internal')) values = file%shape('/contacts/internal')
    if (allocated(file%error)) return
    if (position(2) /= int(bodies, i8)) then
      misfit = 'it holds '//to_text(position(2))//' bodies, the scene '//to_text(bodies)
    else if (position(1) /= int(scene%dimension, i8)) then
      misfit = 'it holds a scene of dimension '//to_text(position(1))
    else if (velocity(1) /= int(scene%bodies%n_velocity, i8)) then
      misfit = 'only one of them has bodies that turn'
    else if (values(1) /= int(internal, i8)) then
      misfit = 'laws keep '//to_text(values(1))//' values of its contacts, '//to_text(internal)//' of those of the scene'
    end if
  end function scene_misfit

  !> Check that all datasets have the shapes that the scene asks for; the file's error is set where one has not.
  subroutine check_shapes(file, scene, bodies, components, internal)
    type(hdf5_file_t), intent(inout) :: file !! open restart file of this scene
    type(scene_t), intent(in) :: scene !! the scene, or the part of a rank
    integer, intent(in) :: bodies !! bodies of the whole scene
    integer, intent(in) :: components !! of an impulse
    integer, intent(in) :: internal !! internal values of a contact
    type(dataset_t), allocatable :: list(:)
    integer(i8) :: found(2), wanted(2), contacts, bytes
    integer :: i

    list = datasets(scene%dimension, size(scene%bodies%middle, 1), scene%bodies%n_velocity, components, internal)
    contacts = file%rows('/contacts/feature')
    ! Of these the scene does not say how many there are; each takes at least four bytes of the file.
    inquire (file=file%name, size=bytes)
    if (max(contacts, file%rows('/totals')) > bytes/4) then
      if (.not. allocated(file%error)) call fail(file%error, 'it is cut off', file=file%name, code=exit_output)
      return
    end if
    do i = 1, size(list)
      wanted = [int(list(i)%components, i8), rows_of(list(i)%rows_for)]
      found = file%shape(trim(list(i)%path))
      if (allocated(file%error)) return
      ! An empty list of neighbours stands for one that is not kept.
      if (list(i)%path == '/built' .and. found(2) == 0) cycle
      if (any(found /= wanted)) call misshaped(trim(list(i)%path))
    end do
  contains
    !> Rows of a dataset.
    integer(i8) function rows_of(rows_for)
      integer, intent(in) :: rows_for

      select case (rows_for)
      case (per_body)
        rows_of = int(bodies, i8)
      case (per_turning_body)
        rows_of = merge(int(bodies, i8), 0_i8, allocated(scene%bodies%angle) .or. allocated(scene%bodies%orientation))
      case (per_contact)
        rows_of = contacts
      case default
        rows_of = 1
      end select
    end function rows_of

    !> Note that a dataset has another shape.
    subroutine misshaped(path)
      character(len=*), intent(in) :: path

      if (allocated(file%error)) return
      call fail(file%error, path//' has '//to_text(found(2))//' rows of '//to_text(found(1))//' numbers, not '// &
                to_text(wanted(2))//' of '//to_text(wanted(1)), file=file%name, code=exit_output)
    end subroutine misshaped
  end subroutine check_shapes

  !> Paths of all datasets of a file.
  function dataset_paths(dimension, internal) result(paths)
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: internal !! internal values of a contact
    type(text_t), allocatable :: paths(:)
    type(dataset_t), allocatable :: list(:)
    integer :: i

    list = datasets(dimension, 0, 0, 0, internal)
    allocate (paths(0))
    do i = 1, size(list)
      call append_word(paths, trim(list(i)%path))
    end do
    call append_word(paths, '/totals')
  end function dataset_paths

  !> The datasets whose shape follows from the scene: its dimension, and components of configurations, velocities,
  !! impulses and internal values of contacts.
  pure function datasets(dimension, n_configuration, n_velocity, n_impulse, n_internal) result(list)
    integer, intent(in) :: dimension, n_configuration, n_velocity, n_impulse, n_internal
    type(dataset_t), allocatable :: list(:)

    list = [dataset_t('/time'), dataset_t('/built', n_configuration, per_body), &
            dataset_t('/bodies/position', dimension, per_body), &
            dataset_t('/bodies/velocity', n_velocity, per_body), dataset_t('/bodies/crossings', 1, per_body), &
            dataset_t('/contacts/contactor', 2, per_contact), dataset_t('/contacts/feature', 1, per_contact), &
            dataset_t('/contacts/image', 1, per_contact), dataset_t('/contacts/law', 1, per_contact), &
            dataset_t('/contacts/status', 1, per_contact), dataset_t('/contacts/impulse', n_impulse, per_contact)]
    if (n_internal > 0) list = [list, dataset_t('/contacts/internal', n_internal, per_contact)]
    if (dimension == 2) then
      list = [list, dataset_t('/bodies/angle', 1, per_turning_body)]
    else
      list = [list, dataset_t('/bodies/orientation', 4, per_turning_body), dataset_t('/bodies/crossings_y', 1, per_body), &
              dataset_t('/contacts/image_y', 1, per_contact)]
    end if
  end function datasets
end module sg_restart_datasets
