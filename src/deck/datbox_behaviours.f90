!> BULK_BEHAV.DAT (gravity, densities) and the contact laws of TACT_BEHAV.DAT of a DATBOX.
module sg_datbox_behaviours
  use sg_datbox_laws, only: form_of_name, law_forms, set_parameter
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, go_to, keyword, name_field, next_data_line, &
                             next_line, open_datbox_file, real_field, step_back
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_laws, only: law_t, law_elastic, law_restitution
  use sg_scene, only: law_index, material_index, material_t, scene_t
  implicit none
  private
  public :: read_bulk_behaviours, read_contact_laws, skip_data, other_law_t, other_law, warn_of_unused

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

    scene%materials = [material_t ::]
    allocate (others(0))
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
        if (scene%dimension == 3) call real_field(file, 67, scene%gravity(3), ok, diagnostics)
      case ('behav')
        if (next_data_line(file, 'a bulk law', diagnostics)) call read_material(file, scene, others, diagnostics)
      case default
        call complain_once(file, 'stray', 'this line belongs neither to $gravy nor to $behav', 1, diagnostics)
      end select
    end do
    if (has_gravity .or. file%n == 0) return
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
      call add_other(others, material%name, name_field(file, 9, 30), file%at)
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

  !> Read contact laws; see tables are passed over.
  subroutine read_contact_laws(folder, scene, others, file, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! gets the laws
    type(other_law_t), allocatable, intent(out) :: others(:) !! contact laws that are not done
    type(datbox_file_t), intent(out) :: file !! TACT_BEHAV.DAT, read to its end
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    scene%laws = [law_t ::]
    allocate (others(0))
    call open_datbox_file(file, folder, 'TACT_BEHAV.DAT', .true., diagnostics)
    do while (next_line(file))
      select case (keyword(file))
      case ('behav')
        if (next_data_line(file, 'a contact law', diagnostics)) call read_law(file, scene, others, diagnostics)
      case ('seety')
        call skip_data(file)
      case default
        call complain_once(file, 'stray', 'this line belongs neither to $behav nor to $seety', 1, diagnostics)
      end select
    end do
  end subroutine read_contact_laws

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
      call add_other(others, law%name, name, first)
      call skip_data(file)
      return
    end if
    law%kind = law_forms(form)%kind
    ok = .true.
    do line = 1, size(law_forms(form)%labels)
      if (law_forms(form)%labels(line) == '') exit
      if (line > 1) then
        if (.not. next_data_line(file, 'the rest of the law '''//law%name//'''', diagnostics)) exit
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
    type(datbox_file_t), intent(inout) :: file
    integer :: at

    at = file%at
    n = 0
    if (keyword(file) == '') then
      n = 1
      do while (next_line(file))
        if (keyword(file) /= '') exit
        n = n + 1
      end do
    end if
    call go_to(file, at)
  end function count_data

  !> Pass over lines of data up to the next keyword.
  subroutine skip_data(file)
    type(datbox_file_t), intent(inout) :: file !! left before the next keyword

    do while (next_line(file))
      if (keyword(file) == '') cycle
      call step_back(file)
      return
    end do
  end subroutine skip_data

  !> Note a law that is not done.
  subroutine add_other(others, nickname, law, line)
    type(other_law_t), allocatable, intent(inout) :: others(:)
    character(len=*), intent(in) :: nickname, law
    integer, intent(in) :: line
    type(other_law_t) :: other

    other%nickname = nickname
    other%law = law
    other%line = line
    others = [others, other]
  end subroutine add_other

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

end module sg_datbox_behaviours
