!> The see tables of TACT_BEHAV.DAT: which contactors may meet, under which law, from which distance on.
module sg_datbox_sees
  use sg_census, only: census_t
  use sg_datbox_behaviours, only: other_law, other_law_t, skip_data
  use sg_datbox_bodies, only: body_type
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, first_letter, go_to, keyword, name_field, next_data_line, &
                             next_line, remark, step_back
  use sg_datbox_numbers, only: real_field
  use sg_datbox_refused, only: reason_of
  use sg_error, only: diagnostics_t
  use sg_laws, only: is_link_law, law_linear
  use sg_scene, only: colour_index, law_index, scene_t, see_t
  use sg_sees, only: links_points
  use sg_shape_kinds, only: kind_point, n_kinds, shape_kinds
  use sg_shape_pairs, only: is_pair
  implicit none
  private
  public :: read_sees, check_sees, datbox_kind_name

contains

  !> LMGC90's name of a kind of shape in see tables, where a shifted disk is DISKx too.
  pure function datbox_kind_name(kind, dimension) result(name)
    integer, intent(in) :: kind !! kind of shape
    integer, intent(in) :: dimension !! of space
    character(len=5) :: name

    name = shape_kinds(kind)%datbox_name
    if (kind == kind_point) name = merge('PT2Dx', 'PT3Dx', dimension == 2)
  end function datbox_kind_name

  !> Read all see tables.
  subroutine read_sees(file, scene, others, see_lines, has_see, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! TACT_BEHAV.DAT, laws read
    type(scene_t), intent(inout) :: scene !! scene with its laws; gets colours and see tables
    type(other_law_t), intent(inout) :: others(:) !! contact laws that are not done
    integer, allocatable, intent(out) :: see_lines(:) !! line of each see table of the scene
    logical, intent(out) :: has_see !! has the file a see table, taken or left out?
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    scene%sees = [see_t ::]
    if (.not. allocated(scene%colours)) allocate (scene%colours(0))
    allocate (see_lines(0))
    has_see = .false.
    call go_to(file, 0)
    do while (next_line(file))
      select case (keyword(file))
      case ('behav')
        call skip_data(file)
      case ('seety')
        has_see = .true.
        call read_see(file, scene, others, see_lines, diagnostics)
      end select
    end do
  end subroutine read_sees

  !> Read one see table: a title, a line of names and the alert distance, perhaps a halo.
  subroutine read_see(file, scene, others, see_lines, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(other_law_t), intent(inout) :: others(:)
    integer, allocatable, intent(inout) :: see_lines(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(see_t) :: see
    character(len=:), allocatable :: pair
    integer :: line
    logical :: ok

    if (.not. next_data_line(file, 'the title of a see table', diagnostics)) return
    if (.not. next_data_line(file, 'a see table', diagnostics)) return
    line = file%at
    ok = .true.
    call check_body_type(file, 2, scene%dimension, ok, diagnostics)
    call check_body_type(file, 30, scene%dimension, ok, diagnostics)
    see%candidate_kind = contactor_kind(file, 9, scene%dimension, ok, diagnostics)
    see%antagonist_kind = contactor_kind(file, 37, scene%dimension, ok, diagnostics)
    call colour_index(scene, name_field(file, 16), see%candidate_colour)
    call colour_index(scene, name_field(file, 44), see%antagonist_colour)
    if (ok) see%law = seen_law(file, scene, others, ok, diagnostics)
    call real_field(file, 55, see%alert, ok, diagnostics)
    if (see%alert < 0) then
      call complain(file, 'the alert distance must not be negative', 55, diagnostics)
      ok = .false.
    end if
    if (ok) call check_points(file, scene, see, ok, diagnostics)
    if (ok) then
      if (is_pair(see%candidate_kind, see%antagonist_kind)) then
        scene%sees = [scene%sees, see]
        see_lines = [see_lines, line]
      else
        pair = name_field(file, 9)//' never meets '//name_field(file, 37)
        call remark(file, pair, pair//' in this order: the see table is left out', 9, diagnostics)
      end if
    end if
    call read_halo(file, diagnostics)
  end subroutine read_see

  !> Laws of links hold between points, and between points nothing else does.
  subroutine check_points(file, scene, see, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene
    type(see_t), intent(in) :: see
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics

    associate (law => scene%laws(see%law))
      if (links_points(see) .and. .not. (is_link_law(law) .or. law%kind == law_linear)) then
        call complain_once(file, 'points', 'between points only rods, wires, NARD_ROD and COUPLED_DOF are done, which '''// &
                           law%name//''' is not', 23, diagnostics)
      else if (is_link_law(law) .and. .not. links_points(see)) then
        call complain_once(file, 'no points', 'the contact law '''//law%name//''' is for points alone: LMGC90 stops here too', 23, &
                           diagnostics)
      else
        return
      end if
    end associate
    ok = .false.
  end subroutine check_points

  !> Pass over the optional line of a see table that begins with `+`.
  subroutine read_halo(file, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. next_line(file)) return
    if (first_letter(file) == '+') then
      call remark(file, 'halo', 'the halo of a see table is not used', 1, diagnostics)
    else
      call step_back(file)
    end if
  end subroutine read_halo

  !> See tables are for rigid bodies of the scene's dimension alone.
  subroutine check_body_type(file, first, dimension, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: first, dimension
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name

    name = name_field(file, first)
    if (name == body_type(dimension)) return
    ok = .false.
    ! Bodies of such a type are refused in BODIES.DAT: none is here.
    call remark(file, name, 'there is no body of type '''//name//''': the see table is left out', first, diagnostics)
  end subroutine check_body_type

  !> Our kind of the contactor named at a column; 0 when it has none.
  integer function contactor_kind(file, first, dimension, ok, diagnostics) result(kind)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: first, dimension
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics

    kind = datbox_kind(name_field(file, first), dimension)
    if (kind > 0) then
      if (any(shape_kinds(kind)%dimension == [0, dimension])) return
    end if
    ok = .false.
    ! Contactors of such a type are refused in BODIES.DAT: none is here.
    call remark(file, name_field(file, first), 'there is no contactor of type '''//name_field(file, first) &
                //''': the see table is left out', first, diagnostics)
  end function contactor_kind

  !> Our kind of a contactor that see tables call by this name; 0 when there is none.
  pure integer function datbox_kind(name, dimension) result(kind)
    character(len=*), intent(in) :: name !! LMGC90's name
    integer, intent(in) :: dimension !! of space

    do kind = 1, n_kinds
      if (datbox_kind_name(kind, dimension) == name) return
    end do
    kind = 0
  end function datbox_kind

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
                         //', which is not done'//reason_of(others(other)%law), 23, diagnostics)
    else
      call complain_once(file, 'law '//name, 'no contact law is called '''//name//'''', 23, diagnostics)
    end if
  end function seen_law

  !> Warn of see tables that name a kind and colour of which there is no contactor.
  subroutine check_sees(scene, others, see_lines, file, diagnostics)
    type(scene_t), intent(in) :: scene !! scene with bodies and see tables
    type(census_t), intent(in) :: others !! bodies that other ranks keep
    integer, intent(in) :: see_lines(:) !! line of each see table, which come before those of a deck
    type(datbox_file_t), intent(inout) :: file !! TACT_BEHAV.DAT
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    logical, allocatable :: is_there(:, :)
    integer :: i, c

    allocate (is_there(n_kinds, size(scene%colours)), source=.false.)
    do c = 1, scene%contactors%n
      is_there(scene%contactors%kind(c), scene%contactors%colour(c)) = .true.
    end do
    if (allocated(others%looks)) then
      do i = 1, size(others%looks, 2)
        is_there(others%looks(1, i), others%looks(2, i)) = .true.
      end do
    end if
    do i = 1, size(see_lines)
      call go_to(file, see_lines(i))
      call check_side(scene%sees(i)%candidate_kind, scene%sees(i)%candidate_colour, 16)
      call check_side(scene%sees(i)%antagonist_kind, scene%sees(i)%antagonist_colour, 44)
    end do
  contains
    !> Warn when one side of a see table is empty.
    subroutine check_side(kind, colour, column)
      integer, intent(in) :: kind, colour, column
      character(len=:), allocatable :: what

      if (is_there(kind, colour)) return
      what = datbox_kind_name(kind, scene%dimension)//' of colour '''//scene%colours(colour)%s//''''
      call remark(file, what, 'there is no '//what//' for this see table', column, diagnostics)
    end subroutine check_side
  end subroutine check_sees
end module sg_datbox_sees
