!> BODIES.DAT of a DATBOX: rigid bodies of the plane or of space, block by block.
!!
!! What the two kinds of body share is here: blocks and their sections, bulk lines, nodes. Contactors and masses are read in
!! `datbox_plane_bodies` and `datbox_space_bodies`.
module sg_datbox_bodies
  use sg_ascending, only: place_in
  use sg_datbox_behaviours, only: other_law, other_law_t
  use sg_datbox_blocks, only: block_t, complain_block, read_point, read_size, read_triple, triple
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, end_with_file, go_to, is_block_end, keyword, name_field, &
                             next_data_line, next_line, pass_over, remark, step_back
  use sg_datbox_plane_bodies, only: complete_planar_body, read_planar_contactor
  use sg_datbox_space_bodies, only: complete_solid_body, read_solid_contactor
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_scene, only: material_index, scene_t
  use sg_share, only: share_t
  use sg_text, only: to_text
  implicit none
  private
  public :: read_bodies, count_bodies, find_dimension, body_type

  !> LMGC90's types of rigid body: of the plane, of space
  character(len=5), parameter :: body_types(2:3) = [character(len=5) :: 'RBDY2', 'RBDY3']

contains

  !> LMGC90's type of the rigid bodies of a scene of this dimension.
  pure function body_type(dimension)
    integer, intent(in) :: dimension !! 2 or 3
    character(len=5) :: body_type

    body_type = body_types(dimension)
  end function body_type

  !> Dimension of space, from the type of the bodies; bodies of both types are a mistake.
  subroutine find_dimension(file, dimension, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT, left at its beginning
    integer, intent(out) :: dimension !! 2 or 3
    logical, intent(out) :: ok !! is there one dimension?
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: found, i

    dimension = 0
    ok = .true.
    do while (next_line(file))
      if (keyword(file) /= 'bdyty') cycle
      if (.not. next_line(file)) exit
      found = 0
      do i = 2, 3
        if (name_field(file, 2) == body_types(i)) found = i
      end do
      if (dimension == 0) dimension = found
      if (found == 0 .or. found == dimension) cycle
      call complain(file, 'bodies of the plane (RBDY2) and of space (RBDY3) cannot stand in one DATBOX', 2, diagnostics)
      ok = .false.
      return
    end do
    if (dimension == 0) dimension = 2
    call go_to(file, 0)
  end subroutine find_dimension

  !> Number of bodies.
  subroutine count_bodies(file, n)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT, left at its beginning
    integer, intent(out) :: n !! how many

    n = 0
    do while (next_line(file))
      if (keyword(file) == 'bdyty') n = n + 1
    end do
    call go_to(file, 0)
  end subroutine count_bodies

  !> Read all bodies; they are numbered by order of appearance, whatever number the file writes.
  subroutine read_bodies(file, scene, share, held, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT at its beginning
    type(scene_t), intent(inout) :: scene !! scene with its dimension; gets bodies, contactors and colours
    type(share_t), intent(inout) :: share !! what this rank keeps of them, begun
    integer(i4), intent(in) :: held(:) !! numbers of the bodies whose velocity is imposed in all components, ascending
    type(other_law_t), intent(inout) :: others(:) !! bulk laws that are not done
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: n

    n = 0
    do while (next_line(file))
      if (keyword(file) == 'bdyty') then
        call read_block(file, scene, share%made + 1, n + 1, held, others, diagnostics)
        call share%settle(scene, n)
      else if (.not. is_block_end(keyword(file))) then
        call pass_over(file, 'outside bodies', diagnostics)
      end if
    end do
    call share%finish(scene, n)
    if (share%made == 0 .and. file%n_errors == 0) call complain(file, 'there is no body', 0, diagnostics)
  end subroutine read_bodies

  !> Read one body's block, from $bdyty to $$$$$$.
  subroutine read_block(file, scene, number, body, held, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: number, body
    integer(i4), intent(in) :: held(:)
    type(other_law_t), intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(block_t) :: block
    character(len=5) :: section, word

    block%number = number
    block%body = body
    block%is_held = place_in(held, int(number, i4)) > 0
    block%before = scene%contactors%n
    block%line = file%at
    if (.not. next_data_line(file, 'the type of a body', diagnostics)) return
    if (name_field(file, 2) /= body_type(scene%dimension)) then
      call complain_once(file, name_field(file, 2), 'bodies of type '''//name_field(file, 2) &
                         //''' are not done: only RBDY2 and RBDY3, rigid in the plane or in space', 2, diagnostics)
      block%ok = .false.
    end if
    section = ''
    do
      if (.not. next_line(file)) then
        call end_with_file(file, diagnostics)
        exit
      end if
      word = keyword(file)
      if (word /= '') then
        if (is_block_end(word)) exit
        if (word == 'bdyty') then
          call complain(file, 'a body begins here, but body '//to_text(number)//' has not been ended by $$$$$$', 1, diagnostics)
          call step_back(file)
          return
        end if
        if (all(word /= ['blmty', 'nodty', 'tacty'])) then
          if (section == '') call pass_over(file, 'before the sections of a body', diagnostics)
          if (section /= '') call complain_once(file, word, 'the keyword '''//word//''' has no place in a rigid body', 1, &
                                                diagnostics)
          cycle
        end if
        section = word
      else if (section == '') then
        call pass_over(file, 'before the sections of a body', diagnostics)
      else if (block%ok) then
        call read_section_line(file, scene, block, section, others, diagnostics)
      end if
    end do
    if (block%ok) call complete_body(file, scene, block, diagnostics)
  end subroutine read_block

  !> Read one line of data within a body's block.
  subroutine read_section_line(file, scene, block, section, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(block_t), intent(inout) :: block
    character(len=*), intent(in) :: section
    type(other_law_t), intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics

    if (scan(adjustl(name_field(file, 1, 6)), '!#') == 1) then
      call complain(file, 'within a section of a body a comment must begin in column 1: LMGC90 stops at this line', 2, diagnostics)
      block%ok = .false.
      return
    else if (name_field(file, 2) == '' .and. .not. (section == 'blmty' .and. is_moments(file, scene%dimension, block))) then
      call pass_over(file, 'without a type within a body', diagnostics)
      return
    end if
    select case (section)
    case ('blmty')
      call read_bulk(file, scene, block, others, diagnostics)
    case ('nodty')
      call read_node(file, scene%dimension, block, diagnostics)
    case ('tacty')
      if (scene%dimension == 2) then
        call read_planar_contactor(file, scene, block, diagnostics)
      else
        call read_solid_contactor(file, scene, block, diagnostics)
      end if
    end select
  end subroutine read_section_line

  !> Is the present line that of the principal moments, behind the bulk line?
  pure logical function is_moments(file, dimension, block)
    type(datbox_file_t), intent(in) :: file
    integer, intent(in) :: dimension
    type(block_t), intent(in) :: block

    is_moments = dimension == 3 .and. block%has_bulk .and. name_field(file, 30, 2) == 'I1'
  end function is_moments

  !> Read the bulk line: material, radius of mass, radius of gyration.
  subroutine read_bulk(file, scene, block, others, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene
    type(block_t), intent(inout) :: block
    type(other_law_t), intent(inout) :: others(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name
    integer :: other

    if (is_moments(file, scene%dimension, block)) then
      call read_moments(file, block, diagnostics)
      return
    else if (name_field(file, 2) /= 'PLAIN' .or. block%has_bulk) then
      call complain(file, 'a rigid body has one bulk element, PLAIN', 2, diagnostics)
      block%ok = .false.
      return
    end if
    block%has_bulk = .true.
    name = name_field(file, 23)
    block%material = material_index(scene, name)
    if (block%material == 0) then
      block%ok = .false.
      other = other_law(others, name)
      if (other > 0) then
        call complain_once(file, 'bulk '//name, 'the bulk law '''//name//''' is '//others(other)%law//', which is not done', &
                           23, diagnostics)
      else
        call complain_once(file, 'bulk '//name, 'no bulk law is called '''//name//'''', 23, diagnostics)
      end if
    end if
    call read_size(file, triple(1), block%mass_radius, .false., block%ok, diagnostics)
    ! In space the inertia comes from shapes or from a line of its own.
    if (scene%dimension == 2) call read_size(file, triple(2), block%gyration_radius, .false., block%ok, diagnostics)
  end subroutine read_bulk

  !> Read the line of principal moments: those of the volume, three times zero where they come from the shapes.
  subroutine read_moments(file, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(block_t), intent(inout) :: block
    type(diagnostics_t), intent(inout) :: diagnostics

    call read_triple(file, block%moments, block%ok, diagnostics)
    if (.not. any(abs(block%moments) > 0)) return
    if (minval(block%moments) > 0) then
      ! Of no body is one principal moment larger than the two others together.
      if (2*maxval(block%moments) <= (1 + 1e-6_wp)*sum(block%moments)) return
    end if
    call complain(file, 'no body has these principal moments: each must be positive and no larger than the others together', &
                  triple(1), diagnostics)
    block%ok = .false.
  end subroutine read_moments

  !> Read the node: place and angle; in space place, and on a second line rotations that are not used.
  subroutine read_node(file, dimension, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: dimension
    type(block_t), intent(inout) :: block
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=*), parameter :: nodes(2:3) = ['NO3xx', 'NO6xx'], where(2:3) = ['of the plane', 'in space    ']
    real(wp) :: rotations(3)

    if (name_field(file, 2) /= nodes(dimension) .or. block%has_node) then
      call complain(file, 'a rigid body '//trim(where(dimension))//' has one node, '//nodes(dimension), 2, diagnostics)
      block%ok = .false.
      return
    end if
    block%has_node = .true.
    call read_triple(file, block%node, block%ok, diagnostics)
    if (dimension == 2) return
    call read_point(file, 'the rotations of a node', rotations, block%ok, diagnostics)
    if (any(abs(rotations) > 0)) call remark(file, 'rotations', 'the rotations of a node are not used: an orientation ' &
                                                  //'stands in DOF.INI', triple(1), diagnostics)
  end subroutine read_node

  !> Turn a block into a body of the scene.
  subroutine complete_body(file, scene, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(block_t), intent(in) :: block
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. block%has_bulk) call complain_block(file, block, 'has no bulk element ($blmty)', diagnostics)
    if (.not. block%has_node) call complain_block(file, block, 'has no node ($nodty)', diagnostics)
    if (scene%contactors%n == block%before) call complain_block(file, block, 'has no contactor ($tacty)', diagnostics)
    if (.not. block%has_bulk .or. .not. block%has_node .or. scene%contactors%n == block%before) return
    if (scene%dimension == 2) then
      call complete_planar_body(file, scene, block, diagnostics)
    else
      call complete_solid_body(file, scene, block, diagnostics)
    end if
  end subroutine complete_body
end module sg_datbox_bodies
