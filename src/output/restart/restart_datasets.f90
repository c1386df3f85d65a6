!> Datasets of a restart file and the shapes that they have in a scene: looked at before anything is read, so that a file can
!! neither ask for more memory than it fills nor leave numbers out.
module sg_restart_datasets
  use sg_bodies, only: bodies_t
  use sg_contacts, only: contacts_t
  use sg_error, only: exit_output, fail
  use sg_field_visitor, only: field_t
  use sg_fields, only: fields_t
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: i8
  use sg_restart_fields, only: fields_in_files
  use sg_scene, only: scene_t
  use sg_text, only: append_word, text_t, to_text
  implicit none
  private
  public :: check_shapes, dataset_paths, scene_misfit

  !> Lists of any length that only some runs write
  character(len=7), parameter :: optional_lists(7) = [character(len=7) :: '/tracks', '/stop', '/stages', '/means', '/fields', &
                                                                  '/cell', '/length']

  !> A dataset, values per row, and its rows
  type :: dataset_t
    character(len=32) :: path = ''
    integer :: components = 1
    integer(i8) :: rows = 1
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
    else if (velocity(1) > int(scene%bodies%n_velocity, i8)) then
      misfit = 'it holds spins of bodies, and nothing turns in the scene'
    else if (values(1) /= int(internal, i8)) then
      misfit = 'laws keep '//to_text(values(1))//' values of its contacts, '//to_text(internal)//' of those of the scene'
    end if
  end function scene_misfit

  !> Check that all datasets have the shapes that the components ask for; the file's error is set where one has not.
  subroutine check_shapes(file, like, bodies, contacts)
    type(hdf5_file_t), intent(inout) :: file !! open restart file of this scene
    type(bodies_t), intent(in) :: like !! bodies with the components of the file
    integer, intent(in) :: bodies !! bodies of the whole scene
    type(contacts_t), intent(in) :: contacts !! contacts with the components of the file
    type(dataset_t), allocatable :: list(:)
    integer(i8) :: found(2), wanted(2), rows, bytes, most
    integer :: i

    rows = file%rows('/contacts/feature')
    most = 0
    ! Their number does not follow from the scene; each takes at least four bytes of the file.
    inquire (file=file%name, size=bytes)
    do i = 1, size(optional_lists)
      if (file%has(trim(optional_lists(i)))) most = max(most, file%rows(trim(optional_lists(i))))
    end do
    if (max(rows, most, file%rows('/totals')) > bytes/4) then
      if (.not. allocated(file%error)) call fail(file%error, 'it is cut off', file=file%name, code=exit_output)
      return
    end if
    list = datasets(file, like, contacts, int(bodies, i8), rows)
    do i = 1, size(list)
      wanted = [int(list(i)%components, i8), list(i)%rows]
      found = file%shape(trim(list(i)%path))
      if (allocated(file%error)) return
      ! An empty list of neighbours stands for one that is not kept.
      if (list(i)%path == '/built' .and. found(2) == 0) cycle
      if (all(found == wanted)) cycle
      call fail(file%error, trim(list(i)%path)//' has '//to_text(found(2))//' rows of '//to_text(found(1))//' numbers, not '// &
                to_text(wanted(2))//' of '//to_text(wanted(1)), file=file%name, code=exit_output)
      return
    end do
  end subroutine check_shapes

  !> Paths of all datasets of a file.
  function dataset_paths(file, like, contacts) result(paths)
    type(hdf5_file_t), intent(inout) :: file !! open restart file of this scene
    type(bodies_t), intent(in) :: like !! bodies with the components of the file
    type(contacts_t), intent(in) :: contacts !! contacts with the components of the file
    type(text_t), allocatable :: paths(:)
    type(dataset_t), allocatable :: list(:)
    integer :: i

    list = datasets(file, like, contacts, 0_i8, 0_i8)
    allocate (paths(0))
    do i = 1, size(list)
      call append_word(paths, trim(list(i)%path))
    end do
    call append_word(paths, '/totals')
    do i = 1, size(optional_lists)
      if (file%has(trim(optional_lists(i)))) call append_word(paths, trim(optional_lists(i)))
    end do
  end function dataset_paths

  !> The datasets whose shape follows from the components.
  function datasets(file, like, contacts, n_bodies, n_contacts) result(list)
    type(hdf5_file_t), intent(inout) :: file
    type(bodies_t), intent(in) :: like
    type(contacts_t), intent(in) :: contacts
    integer(i8), intent(in) :: n_bodies, n_contacts
    type(dataset_t), allocatable :: list(:)

    list = [dataset_t('/time'), dataset_t('/built', like%n_configuration() + 1, n_bodies), &
            datasets_of(file, '/bodies', like, n_bodies), &
            datasets_of(file, '/contacts', contacts, n_contacts)]
  end function datasets

  !> The datasets of a group, one per field that files hold.
  function datasets_of(file, group, things, rows) result(list)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: group
    class(fields_t), intent(in) :: things
    integer(i8), intent(in) :: rows
    type(dataset_t), allocatable :: list(:)
    type(field_t), allocatable :: fields(:)
    integer :: i

    fields = fields_in_files(things, group, file)
    list = [(dataset_t(group//'/'//fields(i)%name, fields(i)%components, rows), i=1, size(fields))]
  end function datasets_of
end module sg_restart_datasets
