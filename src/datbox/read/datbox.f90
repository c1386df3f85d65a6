!> Reads an LMGC90 DATBOX folder of rigid bodies, of the plane or of space, into a scene (doc/guide/datbox.md).
!!
!! All mistakes of all files are reported at once, as far as one does not follow from another. What a folder holds
!! and we do not do yet is a mistake when the scene would differ without it, and a warning when it would not.
module sg_datbox
  use sg_ascending, only: distinct
  use sg_census, only: census_t
  use sg_datbox_behaviours, only: other_law_t, read_bulk_behaviours, read_contact_laws, warn_of_unused
  use sg_datbox_bodies, only: count_bodies, find_dimension, read_bodies
  use sg_datbox_contacts, only: read_start_contacts
  use sg_datbox_drives, only: bodies_driven, bodies_held, read_drives
  use sg_datbox_links, only: read_links
  use sg_datbox_lines, only: datbox_file_t, digest_of, open_datbox_file
  use sg_datbox_postpro, only: warn_of_postpro
  use sg_datbox_sees, only: check_sees, read_sees
  use sg_datbox_state, only: read_state
  use sg_datbox_uses, only: warn_of_unused_sees
  use sg_error, only: diagnostics_t
  use sg_kinds, only: i4
  use sg_scene, only: scene_t
  use sg_share, only: share_t
  use sg_system, only: file_exists
  implicit none
  private
  public :: folder_sees_t, read_datbox, read_datbox_share, check_folder_sees

  !> See tables of a folder: their file, the line of each, and the laws of the folder
  type :: folder_sees_t
    private
    type(datbox_file_t) :: file
    integer, allocatable :: lines(:)
    logical :: has_any = .false.
    integer :: n_laws = 0
  end type folder_sees_t

  !> Files that LMGC90 reads and that hold nothing about the scene of rigid bodies
  character(len=14), parameter :: files_not_read(7) = [character(len=14) :: 'COMMAND.DAT', 'PREPRO.DAT', 'SAMPLE.DAT', &
                                                       'BEHAVIOURS.DAT', 'MODELS.DAT', 'GPV.INI', 'MP_DEM.DAT']

contains

  !> Read a DATBOX folder; without mistakes the scene lacks only period and pressures, which no DATBOX holds.
  subroutine read_datbox(folder, scene, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! empty scene to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(share_t) :: all
    type(folder_sees_t) :: sees
    integer :: before, i

    before = diagnostics%count()
    call read_datbox_share(folder, scene, all, sees, diagnostics)
    if (diagnostics%count() > before) return
    call check_folder_sees(scene, all%census, sees, [(.false., i=1, size(scene%laws))], diagnostics)
  end subroutine read_datbox

  !> The same where several ranks read: each keeps its share. All find the same mistakes. Whether see tables are of use is to be
  !! checked when a deck has added its bodies.
  subroutine read_datbox_share(folder, scene, share, sees, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! empty scene to fill
    type(share_t), intent(inout) :: share !! the ranks, and the bodies that all keep besides those that the folder drives
    type(folder_sees_t), intent(out) :: sees !! its see tables, for the check to come
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(datbox_file_t) :: bodies, bulk
    type(other_law_t), allocatable :: other_bulk(:), other_laws(:)
    integer(i4), allocatable :: held(:)
    integer :: before, n
    logical :: ok

    before = diagnostics%count()
    if (.not. is_folder(folder, diagnostics)) return
    call open_datbox_file(bodies, folder, 'BODIES.DAT', .true., diagnostics)
    call find_dimension(bodies, scene%dimension, ok, diagnostics)
    if (.not. ok) return
    scene%contactors%dimension = scene%dimension
    call read_bulk_behaviours(folder, scene, other_bulk, bulk, diagnostics)
    call read_contact_laws(folder, scene, other_laws, sees%file, diagnostics)
    call read_sees(sees%file, scene, other_laws, sees%lines, sees%has_any, diagnostics)
    sees%n_laws = size(scene%laws)
    call count_bodies(bodies, n)
    call keep_driven(folder, scene%dimension, n, share)
    call share%begin(scene, n, 0)
    call share%census%mix(digest_of(bodies))
    call share%census%mix(digest_of(bulk))
    call share%census%mix(digest_of(sees%file))
    call bodies_held(folder, scene%dimension, n, held)
    call read_bodies(bodies, scene, share, held, other_bulk, diagnostics)
    call warn_of_unused(other_bulk, bulk, diagnostics)
    call warn_of_unused(other_laws, sees%file, diagnostics)
    if (share%all > 0) call read_drives(folder, scene, share, diagnostics)
    call warn_of_files(folder, diagnostics)
    call warn_of_postpro(folder, diagnostics)
    if (.not. allocated(scene%pressures)) allocate (scene%pressures(0))
    ! Contacts and states name bodies: where bodies are wrong, what follows would be noise.
    if (diagnostics%count() > before) return
    call read_links(folder, scene, share%points, sees%file, sees%lines, diagnostics)
    if (diagnostics%count() > before) return
    call read_state(folder, scene, share, diagnostics)
    call read_start_contacts(folder, scene, share, diagnostics)
  end subroutine read_datbox_share

  !> Warn of see tables without use, of laws that none names, and of shapes that no see table and no interaction brings
  !! together with others.
  subroutine check_folder_sees(scene, others, sees, is_named, diagnostics)
    type(scene_t), intent(in) :: scene !! scene with all bodies and see tables, those of the folder first
    type(census_t), intent(in) :: others !! bodies that other ranks keep
    type(folder_sees_t), intent(inout) :: sees !! see tables of the folder
    logical, intent(in) :: is_named(:) !! laws that links and bonds of a deck name, shape (laws)
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered

    if (sees%file%n > 0 .and. .not. sees%has_any .and. size(scene%sees) == 0) &
      call diagnostics%warn('no see table: nothing touches anything', file=sees%file%path)
    call check_sees(scene, others, sees%lines, sees%file, diagnostics)
    call warn_of_unused_sees(scene, others, sees%lines, is_named(:sees%n_laws), sees%file, diagnostics)
  end subroutine check_folder_sees

  !> All of several ranks keep the bodies that are driven.
  subroutine keep_driven(folder, dimension, n, share)
    character(len=*), intent(in) :: folder
    integer, intent(in) :: dimension, n
    type(share_t), intent(inout) :: share
    integer(i4), allocatable :: driven(:)

    if (share%ranks == 1) return
    call bodies_driven(folder, dimension, n, driven)
    if (allocated(share%common)) driven = [share%common, driven]
    share%common = distinct(driven)
  end subroutine keep_driven

  !> Is there such a folder? If not, report it, with a hint when its DATBOX may be meant.
  logical function is_folder(folder, diagnostics)
    character(len=*), intent(in) :: folder
    type(diagnostics_t), intent(inout) :: diagnostics

    logical :: has_bodies, has_bodies_below

    is_folder = file_exists(trim(folder)//'/.')
    has_bodies = file_exists(trim(folder)//'/BODIES.DAT')
    has_bodies_below = file_exists(trim(folder)//'/DATBOX/BODIES.DAT')
    if (.not. is_folder) then
      call diagnostics%add('there is no such DATBOX folder', file=trim(folder))
    else if (has_bodies_below .and. .not. has_bodies) then
      call diagnostics%add('this folder is no DATBOX; did you mean '//trim(folder)//'/DATBOX?', file=trim(folder))
      is_folder = .false.
    end if
  end function is_folder

  !> One warning for all files that are there and not read.
  subroutine warn_of_files(folder, diagnostics)
    character(len=*), intent(in) :: folder
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: list
    integer :: i

    list = ''
    do i = 1, size(files_not_read)
      if (file_exists(trim(folder)//'/'//trim(files_not_read(i)))) list = list//', '//trim(files_not_read(i))
    end do
    if (list /= '') call diagnostics%warn('not read by runs: '//list(3:), file=trim(folder))
  end subroutine warn_of_files
end module sg_datbox
