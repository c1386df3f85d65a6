!> BULK_BEHAV.DAT (gravity, densities) and TACT_BEHAV.DAT (contact laws, see tables) of a DATBOX.
module sg_datbox_behaviours
  use sg_contactors, only: kind_disk, kind_hollow, kind_polygon, kind_wall, n_kinds
  use sg_datbox_laws, only: form_of_name, law_forms, set_parameter
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, keyword, name_field, next_data_line, &
                             next_line, open_datbox_file, real_field, remark_once, step_back
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_laws, only: law_t, law_elastic, law_restitution
  use sg_scene, only: colour_index, law_index, material_index, material_t, scene_t, see_t
  implicit none
  private
  public :: read_bulk_behaviours, read_contact_behaviours, check_sees, other_law_t, other_law, warn_of_unused
  public :: datbox_kind, datbox_kind_names, pair_is_known

  !> How LMGC90 calls our kinds of shape in see tables; a shifted disk is DISKx there too
  character(len=5), parameter :: datbox_kind_names(n_kinds) = [character(len=5) :: 'DISKx', 'JONCx', 'xKSID', 'POLYG']

  !> Columns of the two numbers of a law's line
  integer, parameter :: law_columns(2) = [46, 67]

  !> A law that the folder lists and that is not done here: harmless as long as nothing uses it
  type :: other_law_t
    !> Name by which the folder calls it, and LMGC90's name of the law
    character(len=:), allocatable :: nickname, law
    !> Line that lists it
    integer :: line = 0
    !> Does something use it?
    logical :: is_used = .false.
  end type other_law_t

contains

  !> Read gravity and densities.
  subroutine read_bulk_behaviours(folder, scene, others, file, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! gets gravity and materials
    type(other_law_t), allocatable, intent(out) :: others(:) !! bulk laws that are not done
    type(datbox_file_t), intent(out) :: file !! the file, read to its end
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    logical :: has_gravity, ok

    allocate (scene%materials(0), others(0))
    call open_datbox_file(file, folder, 'BULK_BEHAV.DAT', .true., diagnostics)
    has_gravity = .false.
    do while (next_line(file))
      select case (keyword(file))
      case ('gravy')
        has_gravity = .true.
        if (.not. next_data_line(file, 'the gravity', diagnostics)) cycle
        ok = .true.
        call real_field(file, 25, scene%gravity(1), ok, diagnostics)
        call real_field(file, 46, scene%gravity(2), ok, diagnostics)
      case ('behav')
        if (next_data_line(file, 'a bulk law', diagnostics)) call read_material(file, scene, others, diagnostics)
      case default
        call complain_once(file, 'stray', 'this line belongs neither to $gravy nor to $behav', 1, diagnostics)
      end select
    end do
    if (has_gravity .or. size(file%lines) == 0) return
    call diagnostics%warn('no $gravy: there is no gravity', file=file%path)
  end subroutine read_bulk_behaviours

  !> Read one bulk law: only rigid ones are done.
  subroutine read_material(file, scene, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(other_law_t), allocatable, intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(material_t) :: material
    logical :: ok

    material%name = name_field(file, 2)
    if (name_field(file, 9, 30) /= 'RIGID') then
      others = [others, other_law_t(material%name, name_field(file, 9, 30), file%at)]
      call skip_data(file)
      return
    end if
    ok = .true.
    call real_field(file, law_columns(1), material%density, ok, diagnostics)
    if (.not. ok) return
    if (.not. material%density > 0) then
      call complain(file, 'the density of '''//material%name//''' must be positive', law_columns(1), diagnostics)
    else if (material_index(scene, material%name) > 0) then
      call complain(file, 'the bulk law '''//material%name//''' is listed twice', 2, diagnostics)
    end if
    scene%materials = [scene%materials, material]
  end subroutine read_material

  !> Read contact laws and see tables.
  subroutine read_contact_behaviours(folder, scene, others, see_lines, file, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! gets laws, colours and see tables
    type(other_law_t), allocatable, intent(out) :: others(:) !! contact laws that are not done
    integer, allocatable, intent(out) :: see_lines(:) !! line of each see table of the scene
    type(datbox_file_t), intent(out) :: file !! the file, read to its end
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    allocate (scene%laws(0), scene%sees(0), others(0), see_lines(0))
    if (.not. allocated(scene%colours)) allocate (scene%colours(0))
    call open_datbox_file(file, folder, 'TACT_BEHAV.DAT', .true., diagnostics)
    ! Laws first: a see table may stand before the law it names.
    do while (next_line(file))
      if (keyword(file) /= 'behav') cycle
      if (next_data_line(file, 'a contact law', diagnostics)) call read_law(file, scene, others, diagnostics)
    end do
    if (file%n_errors > 0) return
    file%at = 0
    do while (next_line(file))
      select case (keyword(file))
      case ('behav')
        call skip_data(file)
      case ('seety')
        call read_see(file, scene, others, see_lines, diagnostics)
      case default
        call complain_once(file, 'stray', 'this line belongs neither to $behav nor to $seety', 1, diagnostics)
      end select
    end do
    if (size(file%lines) > 0 .and. size(scene%sees) == 0 .and. file%n_errors == 0) then
      call diagnostics%warn('no see table: nothing touches anything', file=file%path)
    end if
  end subroutine read_contact_behaviours

  !> Read one contact law, on as many lines as its numbers take.
  subroutine read_law(file, scene, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(other_law_t), allocatable, intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(law_t) :: law
    character(len=:), allocatable :: name
    integer :: form, line, first, n_lines
    logical :: ok

    law%name = name_field(file, 2)
    name = name_field(file, 9, 30)
    if (law_index(scene, law%name) > 0) then
      call complain(file, 'the contact law '''//law%name//''' is listed twice', 2, diagnostics)
    end if
    first = file%at
    n_lines = count_data(file)
    form = form_of_name(name, n_lines)
    if (form == 0) then
      others = [others, other_law_t(law%name, name, first)]
      call skip_data(file)
      return
    end if
    law%kind = law_forms(form)%kind
    ok = .true.
    do line = 1, size(law_forms(form)%labels)
      if (law_forms(form)%labels(line) == '') exit
      if (line > 1) then
        if (.not. next_data_line(file, 'the rest of the law '''//law%name//'''', diagnostics)) return
      end if
      call read_parameters(file, law_forms(form)%labels(line), law, ok, diagnostics)
    end do
    if (n_lines > max(1, count(law_forms(form)%labels /= ''))) then
      if (next_line(file)) call complain(file, 'this line has no place in the law '''//law%name//''', a '//name, 1, diagnostics)
      call skip_data(file)
    end if
    scene%laws = [scene%laws, law]
  end subroutine read_law

  !> Read the one or two numbers of a law's line.
  subroutine read_parameters(file, labels, law, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: labels
    type(law_t), intent(inout) :: law
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=4) :: label
    real(wp) :: value
    integer :: i

    do i = 1, 2
      label = labels(5*i - 4:5*i - 1)
      if (label == '') exit
      call real_field(file, law_columns(i), value, ok, diagnostics)
      if (.not. ok) return
      if (value < 0) call complain(file, 'the number '''//label//''' must not be negative', law_columns(i), diagnostics)
      if (law%kind == law_elastic .and. label == 'F/gp' .and. .not. value > 0) then
        call complain(file, 'the stiffness must be positive', law_columns(i), diagnostics)
      else if (law%kind == law_restitution .and. label(:3) == 'rst' .and. value > 1) then
        call complain(file, 'a restitution must not pass 1', law_columns(i), diagnostics)
      end if
      call set_parameter(law, label, value)
    end do
  end subroutine read_parameters

  !> Lines of data from the present one to the next keyword.
  integer function count_data(file) result(n)
    type(datbox_file_t), intent(in) :: file
    type(datbox_file_t) :: ahead

    ahead%lines = file%lines(file%at:min(file%at + 9, size(file%lines)))
    ahead%at = 0
    n = 0
    do while (next_line(ahead))
      if (keyword(ahead) /= '') exit
      n = n + 1
    end do
  end function count_data

  !> Pass over lines of data up to the next keyword.
  subroutine skip_data(file)
    type(datbox_file_t), intent(inout) :: file

    do while (next_line(file))
      if (keyword(file) == '') cycle
      call step_back(file)
      return
    end do
  end subroutine skip_data

  !> Read one see table: a title, a line of names and the alert distance, perhaps a halo.
  subroutine read_see(file, scene, others, see_lines, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(other_law_t), intent(inout) :: others(:)
    integer, allocatable, intent(inout) :: see_lines(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(see_t) :: see
    integer :: line
    logical :: ok

    if (.not. next_data_line(file, 'the title of a see table', diagnostics)) return
    if (.not. next_data_line(file, 'a see table', diagnostics)) return
    line = file%at
    ok = .true.
    call check_body_type(file, 2, ok, diagnostics)
    call check_body_type(file, 30, ok, diagnostics)
    see%candidate_kind = contactor_kind(file, 9, ok, diagnostics)
    see%antagonist_kind = contactor_kind(file, 37, ok, diagnostics)
    call colour_index(scene, name_field(file, 16), see%candidate_colour)
    call colour_index(scene, name_field(file, 44), see%antagonist_colour)
    see%law = seen_law(file, scene, others, ok, diagnostics)
    call real_field(file, 55, see%alert, ok, diagnostics)
    if (see%alert < 0) then
      call complain(file, 'the alert distance must not be negative', 55, diagnostics)
      ok = .false.
    end if
    if (ok) then
      if (pair_is_known(see%candidate_kind, see%antagonist_kind)) then
        scene%sees = [scene%sees, see]
        see_lines = [see_lines, line]
      else
        call remark_once(file, 'pair', name_field(file, 9)//' never meets '//name_field(file, 37) &
                         //' in this order: the see table is left out', 9, diagnostics)
      end if
    end if
    call read_halo(file, diagnostics)
  end subroutine read_see

  !> Pass over the optional line of a see table that begins with `+`.
  subroutine read_halo(file, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. next_line(file)) return
    if (file%lines(file%at)%s(1:1) == '+') then
      call remark_once(file, 'halo', 'the halo of a see table is not used', 1, diagnostics)
    else
      call step_back(file)
    end if
  end subroutine read_halo

  !> See tables may speak of rigid bodies in the plane alone.
  subroutine check_body_type(file, first, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: first
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics

    if (name_field(file, first) == 'RBDY2') return
    ok = .false.
    call complain_once(file, name_field(file, first), 'bodies of type '''//name_field(file, first) &
                       //''' are not done: only RBDY2, rigid in the plane', first, diagnostics)
  end subroutine check_body_type

  !> Our kind of the contactor named at a column; 0 when it has none.
  integer function contactor_kind(file, first, ok, diagnostics) result(kind)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: first
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics

    kind = datbox_kind(name_field(file, first))
    if (kind > 0) return
    ok = .false.
    call complain_once(file, name_field(file, first), 'contactors of type '''//name_field(file, first) &
                       //''' are not done in see tables: only DISKx (also for DISKb), JONCx, xKSID and POLYG', first, diagnostics)
  end function contactor_kind

  !> Our kind of a contactor that see tables know by this name; 0 when there is none.
  pure integer function datbox_kind(name) result(kind)
    character(len=*), intent(in) :: name !! LMGC90's name

    do kind = 1, n_kinds
      if (datbox_kind_names(kind) == name) return
    end do
    kind = 0
  end function datbox_kind

  !> Does LMGC90 detect contacts between a candidate and an antagonist of these kinds, in this order?
  pure logical function pair_is_known(candidate, antagonist) result(known)
    integer, intent(in) :: candidate !! kind of shape
    integer, intent(in) :: antagonist !! kind of shape

    known = candidate == kind_disk .and. any(antagonist == [kind_disk, kind_wall, kind_hollow, kind_polygon]) &
            .or. candidate == kind_polygon .and. any(antagonist == [kind_polygon, kind_wall])
  end function pair_is_known

  !> The law that a see table names; 0 and a mistake when it is not listed or not done.
  integer function seen_law(file, scene, others, ok, diagnostics) result(law)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene
    type(other_law_t), intent(inout) :: others(:)
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name
    integer :: other

    name = name_field(file, 23)
    law = law_index(scene, name)
    if (law > 0) return
    ok = .false.
    other = other_law(others, name)
    if (other > 0) then
      call complain_once(file, 'law '//name, 'the contact law '''//name//''' is '//others(other)%law &
                         //', which is not done', 23, diagnostics)
    else
      call complain_once(file, 'law '//name, 'no contact law is called '''//name//'''', 23, diagnostics)
    end if
  end function seen_law

  !> Index of a law that is not done, which is used from now on; 0 when there is none of this name.
  integer function other_law(others, nickname) result(other)
    type(other_law_t), intent(inout) :: others(:) !! laws that are not done
    character(len=*), intent(in) :: nickname !! name to look for

    do other = 1, size(others)
      if (others(other)%nickname /= nickname) cycle
      others(other)%is_used = .true.
      return
    end do
    other = 0
  end function other_law

  !> Warn of laws that are not done, once each; those that something uses are mistakes told already.
  subroutine warn_of_unused(others, file, diagnostics)
    type(other_law_t), intent(in) :: others(:) !! laws that are not done
    type(datbox_file_t), intent(in) :: file !! file that lists them
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    integer :: i

    do i = 1, size(others)
      if (others(i)%is_used) cycle
      call diagnostics%warn('the law '''//others(i)%nickname//''' is '//others(i)%law//', which is not done; nothing uses it', &
                            file=file%path, line=others(i)%line)
    end do
  end subroutine warn_of_unused

  !> Warn of see tables that name a kind and colour of which there is no contactor.
  subroutine check_sees(scene, see_lines, file, diagnostics)
    type(scene_t), intent(in) :: scene !! scene with bodies and see tables
    integer, intent(in) :: see_lines(:) !! line of each see table
    type(datbox_file_t), intent(inout) :: file !! TACT_BEHAV.DAT
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    logical, allocatable :: is_there(:, :)
    integer :: i, c

    allocate (is_there(n_kinds, size(scene%colours)), source=.false.)
    do c = 1, scene%contactors%n
      is_there(scene%contactors%kind(c), scene%contactors%colour(c)) = .true.
    end do
    do i = 1, size(scene%sees)
      file%at = see_lines(i)
      call check_side(scene%sees(i)%candidate_kind, scene%sees(i)%candidate_colour, 16)
      call check_side(scene%sees(i)%antagonist_kind, scene%sees(i)%antagonist_colour, 44)
    end do
  contains
    !> Warn when one side of a see table is empty.
    subroutine check_side(kind, colour, column)
      integer, intent(in) :: kind, colour, column
      character(len=:), allocatable :: what

      if (is_there(kind, colour)) return
      what = datbox_kind_names(kind)//' of colour '''//scene%colours(colour)%s//''''
      call remark_once(file, what, 'there is no '//what//' for this see table', column, diagnostics)
    end subroutine check_side
  end subroutine check_sees
end module sg_datbox_behaviours
