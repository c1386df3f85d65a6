!> BULK_BEHAV.DAT (gravity, densities) and the contact laws of TACT_BEHAV.DAT of a DATBOX.
module sg_datbox_behaviours
  use sg_cohesive_zones, only: zone_fault
  use sg_datbox_laws, only: form_of_name, labels_of, law_forms
  use sg_datbox_lines, only: complain, datbox_file_t, first_letter, go_to, keyword, name_field, next_data_line, next_line, &
                             open_datbox_file, pass_over, remark, step_back
  use sg_datbox_numbers, only: is_real, real_field
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_law_parameters, only: set_parameter
  use sg_laws, only: is_cohesive_zone, largest_friction, law_t, law_restitution, why_largest_friction
  use sg_scene, only: law_index, material_index, material_t, scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: read_bulk_behaviours, read_contact_laws, skip_data, other_law_t, other_law, warn_of_unused

  !> Columns of the two numbers of a law's line
  integer, parameter :: law_columns(2) = [46, 67]

  !> Numbers of cohesive zones that must be positive, and those that are shares
  character(len=4), parameter :: must_be_positive(11) = [character(len=4) :: 'cn', 'ct', 's1', 's2', 'G1', 'G2', 'dp1', 'dp2', &
                                                        'du1', 'du2', 'eta'], shares(2) = [character(len=4) :: 'phi', 'eta']

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
    logical :: has_gravity

    scene%materials = [material_t ::]
    allocate (others(0))
    call open_datbox_file(file, folder, 'BULK_BEHAV.DAT', .true., diagnostics)
    has_gravity = .false.
    do while (next_line(file))
      select case (keyword(file))
      case ('gravy')
        if (.not. next_data_line(file, 'the gravity', diagnostics)) cycle
        if (has_gravity) call remark(file, 'gravity', 'gravity stands here again; the first counts, as in LMGC90', 1, diagnostics)
        if (.not. has_gravity) call read_gravity(file, scene, diagnostics)
        has_gravity = .true.
      case ('behav')
        if (next_data_line(file, 'a bulk law', diagnostics)) call read_material(file, scene, others, diagnostics)
      case default
        call pass_over(file, 'outside $gravy and $behav', diagnostics)
      end select
    end do
    if (has_gravity .or. file%n == 0) return
    call diagnostics%warn('no $gravy: there is no gravity', file=file%path)
  end subroutine read_bulk_behaviours

  !> Read the gravity.
  subroutine read_gravity(file, scene, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    logical :: ok

    ok = .true.
    call real_field(file, 25, scene%gravity(1), ok, diagnostics)
    call real_field(file, 46, scene%gravity(2), ok, diagnostics)
    if (scene%dimension == 3) call real_field(file, 67, scene%gravity(3), ok, diagnostics)
  end subroutine read_gravity

  !> Read one bulk law: rigid ones are done, of coupled ones the density.
  subroutine read_material(file, scene, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(other_law_t), allocatable, intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(material_t) :: material
    character(len=:), allocatable :: law
    logical :: ok

    material%name = name_field(file, 2)
    law = name_field(file, 9, 30)
    if (law /= 'RIGID' .and. left_out(law) == '') then
      call add_other(others, material%name, law, file%at)
      call skip_data(file)
      return
    end if
    ok = name_field(file, law_columns(1)) /= 'field'
    if (.not. ok) call complain(file, 'the density of '''//material%name//''' is a field, which is not done: give a number', &
                                law_columns(1), diagnostics)
    if (ok) call real_field(file, law_columns(1), material%density, ok, diagnostics)
    if (.not. ok) return
    if (.not. material%density > 0) then
      call complain(file, 'the density of '''//material%name//''' must be positive', law_columns(1), diagnostics)
    else if (material_index(scene, material%name) > 0) then
      call complain(file, 'the bulk law '''//material%name//''' is listed twice', 2, diagnostics)
    end if
    scene%materials = [scene%materials, material]
    if (law == 'RIGID') return
    call remark(file, law, 'the bulk law '//law//' is read as RIGID: '//left_out(law)//' are left out', 9, diagnostics)
    call skip_data(file)
  end subroutine read_material

  !> What a bulk law of rigid bodies has besides its density, which moves nothing; empty for laws that are not such.
  pure function left_out(law)
    character(len=*), intent(in) :: law
    character(len=:), allocatable :: left_out

    select case (law)
    case ('THERMO_RIGID')
      left_out = 'conductivity, heat capacity and contact conductance'
    case ('ELECTRO_RIGID')
      left_out = 'electrical conductivity and contact conductance'
    case ('CHEMICAL_RIGID')
      left_out = 'surface energies and their evolution'
    case ('THERMO_CHEMICAL', 'THERMO_CHEMICAL_RIGID')
      left_out = 'heat and surface energies'
    case ('THERMO_ELECTRO', 'THERMO_ELECTRO_RIGID')
      left_out = 'heat, electricity and surface energies'
    case ('MATERIAL_POINT')
      left_out = 'numbers of material points other than the density'
    case default
      left_out = ''
    end select
  end function left_out

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
        call skip_see(file)
      case default
        call pass_over(file, 'outside $behav and $seety', diagnostics)
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
    character(len=9) :: labels(6)
    integer :: form, line, first
    logical :: ok

    law%name = name_field(file, 2)
    name = name_field(file, 9, 30)
    if (law_index(scene, law%name) > 0) then
      call complain(file, 'the contact law '''//law%name//''' is listed twice', 2, diagnostics)
    end if
    first = file%at
    form = form_of_name(name, count_numbers(file))
    if (form == 0) then
      call add_other(others, law%name, name, first)
      call skip_data(file)
      return
    end if
    law%kind = law_forms(form)%kind
    ok = .true.
    labels = labels_of(form)
    do line = 1, size(labels)
      if (labels(line) == '') exit
      if (line > 1) then
        if (.not. next_data_line(file, 'the rest of the law '''//law%name//'''', diagnostics)) exit
      end if
      call read_parameters(file, labels(line), law, ok, diagnostics)
    end do
    if (ok .and. is_cohesive_zone(law)) then
      if (len(zone_fault(law)) > 0) &
        call complain(file, 'the law '''//law%name//''' fits no bond: '//zone_fault(law), 2, diagnostics)
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
      if (value < 0 .and. label /= 'pgap' .and. label /= 'prst') &
        call complain(file, 'the number '''//label//''' must not be negative', law_columns(i), diagnostics)
      if (any(label == must_be_positive) .and. .not. value > 0) then
        call complain(file, 'the number '''//trim(label)//''' must be positive', law_columns(i), diagnostics)
      else if (any(label == shares) .and. .not. value < 1) then
        call complain(file, 'the number '''//trim(label)//''' must be below 1', law_columns(i), diagnostics)
      else if (any(label == ['F/gp', 'F/st']) .and. .not. value > 0) then
        call complain(file, 'the stiffness must be positive', law_columns(i), diagnostics)
      else if (law%kind == law_restitution .and. label(:3) == 'rst' .and. value > 1) then
        call complain(file, 'a restitution must not pass 1', law_columns(i), diagnostics)
      else if (any(label == ['fric', 'stfr', 'dyfr']) .and. value > largest_friction) then
        call complain(file, 'friction must be at most '//to_text(largest_friction, 1)//', '//why_largest_friction, law_columns(i), &
                      diagnostics)
      end if
      call set_parameter(law, label, value)
    end do
  end subroutine read_parameters

  !> Lines of numbers: the present one, and those behind it that hold one in the first column of numbers.
  integer function count_numbers(file) result(n)
    type(datbox_file_t), intent(inout) :: file
    integer :: at

    at = file%at
    n = 1
    do while (next_line(file))
      if (keyword(file) /= '' .or. .not. is_real(file, law_columns(1))) exit
      n = n + 1
    end do
    call go_to(file, at)
  end function count_numbers

  !> Pass over a see table: its title, the table, perhaps its halo.
  subroutine skip_see(file)
    type(datbox_file_t), intent(inout) :: file
    integer :: i

    do i = 1, 3
      if (.not. next_line(file)) return
      if (keyword(file) == '' .and. (i < 3 .or. first_letter(file) == '+')) cycle
      call step_back(file)
      return
    end do
  end subroutine skip_see

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

  !> Warn of laws that are not done, all at once; those in use are reported as mistakes before.
  subroutine warn_of_unused(others, file, diagnostics)
    type(other_law_t), intent(in) :: others(:) !! laws that are not done
    type(datbox_file_t), intent(in) :: file !! file that lists them
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    character(len=:), allocatable :: list
    integer :: i, first

    list = ''
    first = 0
    do i = size(others), 1, -1
      if (others(i)%is_used) cycle
      list = ', '''//others(i)%nickname//''' ('//others(i)%law//')'//list
      first = i
    end do
    if (first > 0) call diagnostics%warn('laws that are not done, and that nothing uses: '//list(3:), file=file%path, &
                                         line=others(first)%line)
  end subroutine warn_of_unused

end module sg_datbox_behaviours
