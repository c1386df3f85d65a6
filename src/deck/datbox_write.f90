!> Writes a scene and its state as an LMGC90 DATBOX folder (doc/guide/datbox.md).
!!
!! The period, pressures and all parameters of a run are no part of a DATBOX: they live in LMGC90's script.
module sg_datbox_write
  use sg_contactors, only: kind_polygon
  use sg_datbox_output, only: finish_file, labelled, output_t, put, put_steps, short_names, start_file
  use sg_datbox_sees, only: datbox_kind_names
  use sg_datbox_write_behaviours, only: write_bulk, write_drives, write_laws
  use sg_datbox_write_bodies, only: check_writable, contactors_of_bodies, write_bodies, write_state
  use sg_error, only: error_t, exit_output, fail
  use sg_kinds, only: wp, i1, i4
  use sg_scene, only: scene_t
  use sg_sees, only: see_between
  use sg_system, only: make_folder
  use sg_text, only: text_t
  implicit none
  private
  public :: write_datbox, datbox_contacts_t, contacts_at_start

  !> Words for our statuses, indexed from 0
  character(len=5), parameter :: status_words(0:4) = [character(len=5) :: 'nknow', 'noctc', 'stick', 'slide', 'Mstck']

  !> Contacts and what they carry at one instant
  type :: datbox_contacts_t
    !> Number of contacts
    integer :: n = 0
    !> Contactors, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: contactor(:, :)
    !> Point [m] and normal from antagonist to candidate, shape (2, n)
    real(wp), allocatable :: point(:, :), normal(:, :)
    !> Gap [m], shape (n)
    real(wp), allocatable :: gap(:)
    !> Mean force of the step [N] and relative velocity [m/s], normal and tangential, shape (2, n)
    real(wp), allocatable :: force(:, :), velocity(:, :)
    !> One of `status_*`, shape (n)
    integer(i1), allocatable :: status(:)
  end type datbox_contacts_t

contains

  !> Write all six files of a DATBOX folder.
  subroutine write_datbox(folder, scene, contacts, time, step_number, error)
    character(len=*), intent(in) :: folder !! folder to make or to fill
    type(scene_t), intent(in) :: scene !! scene in the state to write
    type(datbox_contacts_t), intent(in) :: contacts !! its contacts
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step_number !! number of steps made
    type(error_t), allocatable, intent(out) :: error !! set when something cannot be written
    character(len=5), allocatable :: colours(:), laws(:), materials(:)
    type(text_t), allocatable :: names(:)
    integer(i4), allocatable :: first(:), list(:)
    integer :: i

    if (scene%dimension == 3) then
      call fail(error, 'scenes in space are not written as DATBOX folders yet')
      return
    end if
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    call check_writable(scene, first, list, error)
    if (allocated(error)) return
    if (.not. make_folder(folder)) then
      call fail(error, 'cannot make the folder', file=folder, code=exit_output)
      return
    end if
    allocate (names(size(scene%laws)))
    do i = 1, size(names)
      names(i)%s = scene%laws(i)%name
    end do
    call short_names(names, laws)
    deallocate (names)
    allocate (names(size(scene%materials)))
    do i = 1, size(names)
      names(i)%s = scene%materials(i)%name
    end do
    call short_names(names, materials)
    call short_names(scene%colours, colours)
    call write_laws(folder, scene, laws, colours, error)
    if (allocated(error)) return
    call write_bulk(folder, scene, materials, error)
    call write_bodies(folder, scene, first, list, materials, colours, error)
    call write_drives(folder, scene, error)
    call write_state(folder, scene, first, list, time, step_number, error)
    call write_contacts(folder, scene, first, list, contacts, laws, time, step_number, error)
  end subroutine write_datbox

  !> The contacts that a scene knows at its start; their normals, gaps and velocities are not known and zero.
  pure function contacts_at_start(scene) result(contacts)
    type(scene_t), intent(in) :: scene !! scene that may know contacts
    type(datbox_contacts_t) :: contacts
    integer :: i

    if (allocated(scene%start_contacts)) contacts%n = size(scene%start_contacts)
    allocate (contacts%contactor(2, contacts%n), contacts%status(contacts%n))
    allocate (contacts%point(2, contacts%n), contacts%force(2, contacts%n))
    allocate (contacts%normal(2, contacts%n), contacts%velocity(2, contacts%n), source=0.0_wp)
    allocate (contacts%gap(contacts%n), source=0.0_wp)
    do i = 1, contacts%n
      contacts%contactor(:, i) = scene%start_contacts(i)%contactor
      contacts%point(:, i) = scene%start_contacts(i)%point
      contacts%force(:, i) = scene%start_contacts(i)%force
      contacts%status(i) = scene%start_contacts(i)%status
    end do
  end function contacts_at_start

  !> Write Vloc_Rloc.INI.
  subroutine write_contacts(folder, scene, first, list, contacts, laws, time, step_number, error)
    character(len=*), intent(in) :: folder
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: first(:), list(:)
    type(datbox_contacts_t), intent(in) :: contacts
    character(len=5), intent(in) :: laws(:)
    real(wp), intent(in) :: time
    integer, intent(in) :: step_number
    type(error_t), allocatable, intent(inout) :: error
    type(output_t) :: output
    integer, allocatable :: rank(:)
    integer :: b, i
    logical :: is_large

    allocate (rank(scene%contactors%n))
    do b = 1, scene%bodies%n
      rank(list(first(b):first(b + 1) - 1)) = [(i, i=1, first(b + 1) - first(b))]
    end do
    is_large = max(contacts%n, scene%bodies%n) > 99999
    call start_file(output, folder, 'Vloc_Rloc.INI')
    call put(output, '! Vloc_Rloc')
    call put_steps(output, time, step_number)
    do i = 1, contacts%n
      call put_contact(output, scene, rank, contacts, i, laws, is_large)
    end do
    call finish_file(output, error)
  end subroutine write_contacts

  !> Write one contact.
  subroutine put_contact(output, scene, rank, contacts, contact, laws, is_large)
    type(output_t), intent(inout) :: output
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank(:), contact
    type(datbox_contacts_t), intent(in) :: contacts
    character(len=5), intent(in) :: laws(:)
    logical, intent(in) :: is_large
    character(len=32) :: line
    character(len=5) :: law
    integer :: c(2), kinds(2), see

    c = contacts%contactor(:, contact)
    kinds = scene%contactors%kind(c)
    see = see_between(scene, c(1), c(2))
    write (line, '(a,a,2x,i10)') '$icdan  ', pair_name(kinds), contact
    if (.not. is_large) write (line, '(a,a,2x,i7)') '$icdan  ', pair_name(kinds), contact
    call put(output, line)
    call put(output, ' cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus')
    law = 'nolaw'
    if (see > 0) law = laws(scene%sees(see)%law)
    call put(output, ' '//side(scene, rank, c(1), 'CDVER', kinds(1) == kind_polygon, is_large)//'  '//law//'  ' &
             //side(scene, rank, c(2), 'ANSEG', kinds(1) == kind_polygon, is_large)//'  '//status_words(contacts%status(contact)))
    call put(output, labelled('rlt/H rln/H rls/H ', [contacts%force(2, contact), contacts%force(1, contact), 0.0_wp]))
    call put(output, labelled('vlt = vln = vls = ', [contacts%velocity(2, contact), contacts%velocity(1, contact), 0.0_wp]))
    call put(output, labelled('gapTT ', contacts%gap(contact:contact)))
    call put(output, labelled('n(1)= n(2)= n(3)= ', [contacts%normal(:, contact), 0.0_wp]))
    call put(output, labelled('coo1= coo2= coo3= ', [contacts%point(:, contact), 0.0_wp]))
  end subroutine put_contact

  !> One side of a contact: body and contactor, then, in contacts of polygons, a vertex or a segment.
  function side(scene, rank, contactor, feature, has_feature, is_large) result(text)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank(:), contactor
    character(len=5), intent(in) :: feature
    logical, intent(in) :: has_feature, is_large
    character(len=:), allocatable :: text
    character(len=60) :: buffer

    if (is_large) then
      write (buffer, '(a,i10,2x,a,2x,i5)') 'RBDY2  ', scene%contactors%body(contactor), &
        datbox_kind_names(scene%contactors%kind(contactor)), rank(contactor)
    else
      write (buffer, '(a,i5,2x,a,2x,i5)') 'RBDY2  ', scene%contactors%body(contactor), &
        datbox_kind_names(scene%contactors%kind(contactor)), rank(contactor)
    end if
    text = trim(buffer)
    if (.not. has_feature) return
    ! A segment keeps the columns of a polygon's edge blank.
    if (scene%contactors%kind(contactor) == kind_polygon) then
      text = text//'  '//feature//'      1'
    else
      text = text//repeat(' ', 14)
    end if
  end function side

  !> LMGC90's name of a pair of kinds.
  pure function pair_name(kinds) result(name)
    integer, intent(in) :: kinds(2)
    character(len=5) :: name
    character(len=2), parameter :: letters(4) = [character(len=2) :: 'DK', 'JC', 'KD', 'PL']

    name = letters(kinds(1))//letters(kinds(2))//'x'
  end function pair_name
end module sg_datbox_write
