!> Writes BULK_BEHAV.DAT, TACT_BEHAV.DAT and DRV_DOF.DAT: materials, laws, interactions, and what is imposed.
module sg_datbox_write_behaviours
  use sg_contactors, only: n_kinds
  use sg_datbox_bodies, only: body_type
  use sg_datbox_laws, only: form_of_law, labels_of, law_forms, why_no_form
  use sg_datbox_output, only: finish_file, node_head, output_t, put, real_word, solid_node_head, start_file
  use sg_datbox_sees, only: datbox_kind_name
  use sg_datbox_write_links, only: put_link_sees
  use sg_drives, only: drive_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4
  use sg_law_parameters, only: get_parameter
  use sg_laws, only: law_t
  use sg_scene, only: scene_t, see_t
  use sg_sees, only: see_between
  use sg_shape_pairs, only: is_pair
  use sg_sorting, only: group_items
  use sg_text, only: to_text
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: check_laws, write_bulk, write_laws, write_drives

contains

  !> Write BULK_BEHAV.DAT.
  subroutine write_bulk(folder, scene, materials, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(in) :: scene !! scene to write
    character(len=5), intent(in) :: materials(:) !! names of the materials
    type(error_t), allocatable, intent(inout) :: error !! set when the file cannot be written
    type(output_t) :: output
    integer :: i

    if (allocated(scene%gravity_changes)) then
      call fail(error, 'a DATBOX holds no gravity that changes with time')
      return
    end if
    call start_file(output, folder, 'BULK_BEHAV.DAT')
    call put(output, '$gravy')
    call put(output, repeat(' ', 19)//'grv1='//real_word(scene%gravity(1))//'  grv2='//real_word(scene%gravity(2)) &
             //'  grv3='//real_word(scene%gravity(3)))
    do i = 1, size(materials)
      call put(output, '$behav  lawty')
      call put(output, ' '//materials(i)//'  RIGID'//repeat(' ', 27)//'Umas='//real_word(scene%materials(i)%density))
    end do
    call finish_file(output, error)
  end subroutine write_bulk

  !> Refuse laws that have no form.
  subroutine check_laws(laws, error)
    type(law_t), intent(in) :: laws(:) !! laws to write
    type(error_t), allocatable, intent(inout) :: error !! set when one has no form
    integer :: i

    do i = 1, size(laws)
      if (form_of_law(laws(i)) > 0 .or. allocated(error)) cycle
      call fail(error, 'the law '''//laws(i)%name//''' has no form that a DATBOX can hold'//why_no_form(laws(i)))
    end do
  end subroutine check_laws

  !> Write TACT_BEHAV.DAT, of laws that have forms.
  subroutine write_laws(folder, scene, laws, colours, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(in) :: scene !! scene to write
    character(len=5), intent(in) :: laws(:) !! names of the laws
    character(len=5), intent(in) :: colours(:) !! names of the colours
    type(error_t), allocatable, intent(inout) :: error !! set when the file cannot be written
    type(output_t) :: output
    integer :: i

    if (allocated(scene%groups)) then
      call fail(error, 'a DATBOX holds no bonds between named bodies')
      return
    end if
    call start_file(output, folder, 'TACT_BEHAV.DAT')
    do i = 1, size(laws)
      call put(output, '$behav  lawty')
      call put_law(output, scene%laws(i), laws(i))
    end do
    ! Links come first: the network file names their see tables by rank.
    call put_link_sees(output, scene, laws, colours)
    call put_sees(output, scene, laws, colours)
    call finish_file(output, error)
  end subroutine write_laws

  !> Write one law, on as many lines as its form takes.
  subroutine put_law(output, law, name)
    type(output_t), intent(inout) :: output
    type(law_t), intent(in) :: law
    character(len=5), intent(in) :: name
    character(len=40) :: head
    character(len=:), allocatable :: text
    character(len=9) :: labels(6)
    integer :: line, i

    labels = labels_of(form_of_law(law))
    associate (form => law_forms(form_of_law(law)))
      head = ' '//name//'  '//form%name
      do line = 1, max(1, count(labels /= ''))
        text = head
        do i = 1, 6, 5
          if (labels(line) (i:i) == ' ') exit
          text = text//labels(line) (i:i + 3)//'='//real_word(get_parameter(law, labels(line) (i:i + 3)))//'  '
        end do
        call put(output, text)
        head = ''
      end do
    end associate
  end subroutine put_law

  !> Write the see tables, line by line of the scene's, once for each two classes (kind and colour) that a line serves.
  subroutine put_sees(output, scene, laws, colours)
    type(output_t), intent(inout) :: output
    type(scene_t), intent(in) :: scene
    character(len=5), intent(in) :: laws(:), colours(:)
    integer, allocatable :: example(:)
    logical, allocatable :: is_written(:, :)
    integer :: s, i, j, c, turn

    allocate (example(n_kinds*size(colours)), source=0)
    allocate (is_written(size(example), size(example)), source=.false.)
    do c = scene%contactors%n, 1, -1
      example((scene%contactors%colour(c) - 1)*n_kinds + scene%contactors%kind(c)) = c
    end do
    do s = 1, size(scene%sees)
      ! The second turn serves lines that name the two sides in the order that LMGC90 does not use.
      do turn = 1, 2
        do i = 1, size(example)
          do j = 1, size(example)
            if (min(example(i), example(j)) == 0) cycle
            if (is_written(i, j) .or. .not. is_pair(kind_of(i), kind_of(j))) cycle
            if (see_between(scene, example(i), example(j)) /= s) cycle
            if (turn == 1 .and. .not. is_candidate(scene%sees(s), kind_of(i), colour_of(i))) cycle
            is_written(i, j) = .true.
            is_written(j, i) = .true.
            call put(output, '$seety')
            call put(output, ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert')
            call put(output, ' '//body_type(scene%dimension)//'  '//kind_name(i)//'  '//colours(colour_of(i)) &
                     //'  '//laws(scene%sees(s)%law)//'  '//body_type(scene%dimension)//'  '//kind_name(j) &
                     //'  '//colours(colour_of(j))//'      '//real_word(scene%sees(s)%alert))
          end do
        end do
      end do
    end do
  contains
    !> Name of the kind of a class.
    pure function kind_name(class)
      integer, intent(in) :: class
      character(len=5) :: kind_name

      kind_name = datbox_kind_name(kind_of(class), scene%dimension)
    end function kind_name

    !> Kind of a class.
    pure integer function kind_of(class)
      integer, intent(in) :: class

      kind_of = modulo(class - 1, n_kinds) + 1
    end function kind_of

    !> Colour of a class.
    pure integer function colour_of(class)
      integer, intent(in) :: class

      colour_of = (class - 1)/n_kinds + 1
    end function colour_of
  end subroutine put_sees

  !> May this class be the candidate of a see table?
  pure logical function is_candidate(see, kind, colour)
    type(see_t), intent(in) :: see
    integer, intent(in) :: kind, colour

    is_candidate = any(see%candidate_kind == [0, kind]) .and. any(see%candidate_colour == [0, colour])
  end function is_candidate

  !> Write DRV_DOF.DAT and its evolution files.
  subroutine write_drives(folder, scene, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(in) :: scene !! scene to write
    type(error_t), allocatable, intent(inout) :: error !! set when a file cannot be written
    type(output_t) :: output
    integer, allocatable :: first(:), order(:)
    integer :: i, body

    call start_file(output, folder, 'DRV_DOF.DAT')
    call put(output, '! DOF')
    if (size(scene%pressures) > 0) call put(output, '! Pressures are no part of a DATBOX: the scene has ' &
                                            //to_text(size(scene%pressures)))
    allocate (order(0))
    if (allocated(scene%drives)) call group_items(int(scene%drives%body, i4), scene%bodies%n, first, order)
    body = 0
    do i = 1, size(order)
      associate (drive => scene%drives(order(i)))
        if (drive%body /= body) then
          if (body > 0) call put(output, '$$$$$$')
          body = drive%body
          call put_driven_body(output, scene%dimension, body)
        end if
        call put_drive(output, folder, drive, order(i), error)
      end associate
    end do
    if (body > 0) call put(output, '$$$$$$')
    call finish_file(output, error)
  end subroutine write_drives

  !> Begin the drives of a body.
  subroutine put_driven_body(output, dimension, body)
    type(output_t), intent(inout) :: output
    integer, intent(in) :: dimension, body
    character(len=15) :: line

    call put(output, '$bdyty')
    write (line, '(a,a,2x,i7)') ' ', body_type(dimension), body
    call put(output, line)
    call put(output, '$nodty')
    call put(output, merge(node_head, solid_node_head, dimension == 2))
    call put(output, '$dofty  numbr [CT......+......AMP..*..cos.(..OMEGA.*.time.+.PHI..)]...*...[RAMPI.....+.....RAMP.*.time]')
  end subroutine put_driven_body

  !> Write one drive; a table of times goes to a file of its own.
  subroutine put_drive(output, folder, drive, number, error)
    type(output_t), intent(inout) :: output
    character(len=*), intent(in) :: folder
    type(drive_t), intent(in) :: drive
    integer, intent(in) :: number
    type(error_t), allocatable, intent(inout) :: error
    character(len=:), allocatable :: head

    if (allocated(drive%value%expression) .or. drive%value%is_sum .or. drive%value%is_timed()) then
      call fail(error, 'DATBOX files hold no expression, sum, start or end of a drive: write its values into a file of times '// &
                'and values')
      return
    end if
    head = ' force      '//to_text(drive%component)//' '
    if (drive%is_velocity) head = ' vlocy      '//to_text(drive%component)//' '
    if (allocated(drive%value%times)) then
      call put(output, head//'evolution drive_'//to_text(number)//'.dat')
      call write_evolution(folder, 'drive_'//to_text(number)//'.dat', drive%value, error)
    else
      associate (value => drive%value)
        call put(output, head//real_word(value%constant)//' '//real_word(value%amplitude)//' '//real_word(value%omega)//' ' &
                 //real_word(value%phase)//' '//real_word(value%ramp_start)//' '//real_word(value%ramp_rate))
      end associate
    end if
  end subroutine put_drive

  !> Write an evolution file: time and value, all digits. LMGC90 goes on linearly beyond its ends: a table that holds its end
  !! values gets one more point on each side.
  subroutine write_evolution(folder, name, value, error)
    character(len=*), intent(in) :: folder, name
    type(time_function_t), intent(in) :: value
    type(error_t), allocatable, intent(inout) :: error
    type(output_t) :: output
    real(wp) :: width
    integer :: i, n

    n = size(value%times)
    width = value%times(n) - value%times(1)
    call start_file(output, folder, name)
    if (.not. value%goes_on) call put(output, to_text(value%times(1) - width)//' '//to_text(value%values(1)))
    do i = 1, n
      call put(output, to_text(value%times(i))//' '//to_text(value%values(i)))
    end do
    if (.not. value%goes_on) call put(output, to_text(value%times(n) + width)//' '//to_text(value%values(n)))
    call finish_file(output, error)
  end subroutine write_evolution
end module sg_datbox_write_behaviours
