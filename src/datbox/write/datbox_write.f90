!> Writes a scene and its state as an LMGC90 DATBOX folder (doc/guide/datbox.md).
!!
!! The period, pressures and all parameters of a run are no part of a DATBOX: they live in LMGC90's script.
module sg_datbox_write
  use sg_datbox_output, only: short_names
  use sg_datbox_write_behaviours, only: check_laws, write_bulk, write_drives, write_laws
  use sg_datbox_write_bodies, only: check_writable, write_bodies, write_state
  use sg_datbox_write_links, only: stand_together, write_network
  use sg_datbox_write_contacts, only: contacts_at_start, datbox_contacts_t, write_contacts
  use sg_datbox_write_space, only: fit_densities, stand_upright
  use sg_error, only: error_t, exit_output, fail
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: contactors_of_bodies
  use sg_scene, only: scene_t
  use sg_system, only: make_folder
  use sg_text, only: text_t
  implicit none
  private
  public :: write_datbox, datbox_contacts_t, contacts_at_start

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
    type(scene_t), allocatable :: ready
    type(datbox_contacts_t) :: known
    integer(i4), allocatable :: first(:), list(:)
    integer :: i

    allocate (ready, source=scene)
    known = contacts
    call stand_together(ready, known)
    call contactors_of_bodies(ready%contactors, ready%bodies%n, first, list)
    if (scene%dimension == 3) call stand_upright(ready, first, list)
    call check_writable(ready, first, list, error)
    call check_laws(scene%laws, error)
    if (.not. allocated(error) .and. scene%bodies%has_presence) &
      call fail(error, 'bodies enter or leave in this scene: a DATBOX has all of them, from the start to the end')
    if (allocated(error)) return
    if (scene%dimension == 3) call fit_densities(ready, first, list)
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
    allocate (names(size(ready%materials)))
    do i = 1, size(names)
      names(i)%s = ready%materials(i)%name
    end do
    call short_names(names, materials)
    call short_names(scene%colours, colours)
    call write_laws(folder, ready, laws, colours, error)
    if (allocated(error)) return
    call write_bulk(folder, ready, materials, error)
    call write_bodies(folder, ready, first, list, materials, colours, error)
    call write_drives(folder, ready, error)
    call write_state(folder, ready, first, list, time, step_number, error)
    call write_contacts(folder, ready, first, list, known, laws, time, step_number, error)
    call write_network(folder, ready, error)
  end subroutine write_datbox
end module sg_datbox_write
