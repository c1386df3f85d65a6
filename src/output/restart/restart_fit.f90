!> Components of a restart file next to those of a scene: a stage without friction, in which nothing turns, holds fewer than one
!! with friction.
!!
!! Bodies that did not turn have the orientations of the start and no spin. Of impulses the normal part is common to both in the
!! plane; in space, where frictional impulses are vectors and files hold no normals, the next solve starts from zero impulses.
!! Moments against rolling that a stage adds start from zero.
module sg_restart_fit
  use sg_bodies, only: bodies_t, no_bodies_like
  use sg_contacts, only: contacts_t
  use sg_field_visitor, only: field_t
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i8
  use sg_restart_fields, only: fields_in_files, kept_field_t, values_of
  implicit none
  private
  public :: add_moments, bodies_of_file, fit_fields, fit_impulses, fit_moments, holds, holds_spins

contains

  !> No bodies, with the components that a file holds of bodies; those of the scene where the file holds as many, or wrong ones.
  function bodies_of_file(file, bodies) result(like)
    type(hdf5_file_t), intent(inout) :: file !! open restart file
    type(bodies_t), intent(in) :: bodies !! bodies of the scene
    type(bodies_t) :: like
    integer(i8) :: velocity(2)

    like = no_bodies_like(bodies)
    velocity = file%shape('/bodies/velocity')
    if (bodies%n_velocity == bodies%dimension .or. velocity(1) /= int(bodies%dimension, i8)) return
    like%n_velocity = bodies%dimension
    like%n_carried = 0
    like%has_orientation = file%has('/bodies/'//trim(merge('angle      ', 'orientation', bodies%dimension == 2)))
  end function bodies_of_file

  !> Give contacts the components that a file holds of impulses, where they are those of a scene with or without friction.
  subroutine fit_impulses(file, contacts)
    type(hdf5_file_t), intent(inout) :: file !! open restart file
    type(contacts_t), intent(inout) :: contacts !! none, with the components of the scene
    integer(i8) :: impulse(2)

    impulse = file%shape('/contacts/impulse')
    if (impulse(1) == int(contacts%n_components, i8)) return
    if (.not. any(impulse(1) == [1_i8, int(contacts%dimension, i8)])) return
    contacts%n_components = int(impulse(1))
    contacts%n_carried = 0
  end subroutine fit_impulses

  !> Give a field that a file holds the components of the scene: further ones are zero.
  pure subroutine fit_fields(kept, name, components, common)
    type(kept_field_t), intent(inout) :: kept(:) !! fields read
    character(len=*), intent(in) :: name !! name of the field
    integer, intent(in) :: components !! components in the scene
    integer, intent(in) :: common !! first components, which both have
    real(wp), allocatable :: values(:, :)
    integer :: i

    do i = 1, size(kept)
      if (kept(i)%field%name /= name .or. size(kept(i)%values, 1) == components) cycle
      allocate (values(components, size(kept(i)%values, 2)), source=0.0_wp)
      values(:common, :) = kept(i)%values(:common, :)
      call move_alloc(values, kept(i)%values)
      kept(i)%field%components = components
    end do
  end subroutine fit_fields

  !> Give contacts the internal values that a file holds of them, where it is of a scene without moments against rolling.
  subroutine fit_moments(file, contacts)
    type(hdf5_file_t), intent(inout) :: file !! open restart file
    type(contacts_t), intent(inout) :: contacts !! none, with the values of the scene
    integer(i8) :: values(2)

    if (contacts%n_moments == 0) return
    values = 0
    if (file%has('/contacts/internal')) values = file%shape('/contacts/internal')
    if (values(1) == int(contacts%n_internal - contacts%n_moments, i8)) contacts%n_internal = int(values(1))
  end subroutine fit_moments

  !> Give contacts of a file without moments those of the scene, which are zero before its first step: the last internal values.
  subroutine add_moments(kept, contacts, internal)
    type(kept_field_t), allocatable, intent(inout) :: kept(:) !! fields of contacts that were read
    type(contacts_t), intent(inout) :: contacts !! none, with the values of the file
    integer, intent(in) :: internal !! internal values of a contact of the scene
    type(field_t), allocatable :: list(:)
    type(kept_field_t), allocatable :: longer(:)
    integer :: i, items

    if (contacts%n_internal == internal) return
    items = size(values_of(kept, 'feature'), 2)
    if (contacts%n_internal > 0) then
      call fit_fields(kept, 'internal', internal, contacts%n_internal)
      return
    end if
    contacts%n_internal = internal
    list = fields_in_files(contacts)
    allocate (longer(size(kept) + 1))
    longer(:size(kept)) = kept
    do i = 1, size(list)
      if (list(i)%name == 'internal') longer(size(longer))%field = list(i)
    end do
    allocate (longer(size(longer))%values(internal, items), source=0.0_wp)
    call move_alloc(longer, kept)
  end subroutine add_moments

  !> Does a restart file hold a dataset? False where it cannot be read.
  logical function holds(name, path)
    character(len=*), intent(in) :: name !! path of the file
    character(len=*), intent(in) :: path !! path of the dataset in it
    type(hdf5_file_t) :: file

    call file%open(name, is_read_only=.true.)
    holds = file%has(path)
    call file%close()
    holds = holds .and. .not. allocated(file%error)
  end function holds

  !> Does a restart file hold spins of bodies? False where it cannot be read.
  logical function holds_spins(name, dimension)
    character(len=*), intent(in) :: name !! path of the file
    integer, intent(in) :: dimension !! of space
    type(hdf5_file_t) :: file
    integer(i8) :: velocity(2)

    call file%open(name, is_read_only=.true.)
    velocity = file%shape('/bodies/velocity')
    call file%close()
    holds_spins = .not. allocated(file%error) .and. velocity(1) > int(dimension, i8)
  end function holds_spins
end module sg_restart_fit
