!> DOF.INI (displacements, velocities) and Vloc_Rloc.INI (contacts with their forces) of a DATBOX.
module sg_datbox_state
  use sg_contactors, only: contactors_t
  use sg_datbox_drives, only: read_body_number
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, integer_field, is_block_end, keyword, line_text, &
                             name_field, next_data_line, next_line, open_datbox_file, real_field, remark_once
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: status_bonded, status_new, status_none, status_slide, status_stick
  use sg_scene, only: scene_t, start_contact_t
  use sg_text, only: to_text
  implicit none
  private
  public :: read_state, read_start_contacts

  !> Columns of up to three numbers of a line
  integer, parameter :: triple(3) = [35, 56, 77]
  !> Pairs of contactors whose contacts can be taken over
  character(len=5), parameter :: pairs(6) = [character(len=5) :: 'DKDKx', 'DKJCx', 'DKKDx', 'DKPLx', 'PLPLx', 'PLJCx']

contains

  !> Read step number, time, displacements and velocities; bodies that are not listed stay at rest.
  subroutine read_state(folder, scene, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! scene with bodies where BODIES.DAT puts them
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(datbox_file_t) :: file
    logical :: ok

    call open_datbox_file(file, folder, 'DOF.INI', .false., diagnostics)
    if (size(file%lines) == 0) then
      call diagnostics%warn('no state: the file is missing or empty, bodies start at rest', file=file%path)
    end if
    do while (next_line(file))
      select case (keyword(file))
      case ('steps')
        ok = .true.
        call integer_field(file, 9, 15, scene%start_step, ok, diagnostics)
        call real_field(file, triple(1), scene%start_time, ok, diagnostics)
      case ('bdyty')
        call read_body_state(file, scene, diagnostics)
      case default
        call complain_once(file, 'stray', 'this line belongs to no body', 1, diagnostics)
      end select
    end do
  end subroutine read_state

  !> Read the state of one body, from $bdyty to $$$$$$.
  subroutine read_body_state(file, scene, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: displacement(3), velocity(3)
    integer :: body, i
    logical :: ok

    call read_body_number(file, scene%bodies%n, body, diagnostics)
    do
      if (.not. next_line(file)) then
        call complain(file, 'the file ends within a body, before its $$$$$$', 0, diagnostics)
        return
      end if
      if (is_block_end(keyword(file))) return
      if (keyword(file) /= '') cycle
      if (name_field(file, 2) /= 'NO3xx') then
        call complain_once(file, 'node', 'the state of a body of the plane is that of its node, NO3xx', 2, diagnostics)
        cycle
      end if
      ok = .true.
      do i = 1, 3
        call real_field(file, triple(i), displacement(i), ok, diagnostics)
      end do
      if (.not. next_data_line(file, 'a velocity', diagnostics)) cycle
      do i = 1, 3
        call real_field(file, triple(i), velocity(i), ok, diagnostics)
      end do
      if (.not. ok .or. body == 0) cycle
      scene%bodies%position(:, body) = scene%bodies%position(:, body) + displacement(1:2)
      scene%bodies%angle(body) = scene%bodies%angle(body) + displacement(3)
      scene%bodies%velocity(:, body) = velocity
    end do
  end subroutine read_body_state

  !> Read the contacts known at the start, with their mean forces.
  subroutine read_start_contacts(folder, scene, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! scene with bodies and contactors
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(datbox_file_t) :: file
    integer(i4), allocatable :: first(:)
    integer :: n

    call open_datbox_file(file, folder, 'Vloc_Rloc.INI', .false., diagnostics)
    if (size(file%lines) == 0 .and. scene%start_step > 0) then
      call diagnostics%warn('no contacts: the file is missing or empty, the solver starts without impulses', file=file%path)
    end if
    n = 0
    do while (next_line(file))
      if (keyword(file) == 'icdan') n = n + 1
    end do
    if (allocated(scene%start_contacts)) deallocate (scene%start_contacts)
    allocate (scene%start_contacts(n))
    call first_contactors(scene%contactors, scene%bodies%n, first)
    file%at = 0
    n = 0
    do while (next_line(file))
      if (keyword(file) /= 'icdan') cycle
      if (any(name_field(file, 9) == pairs)) then
        call read_contact(file, first, scene%start_contacts, n, diagnostics)
      else
        call complain_once(file, name_field(file, 9), 'contacts of type '''//name_field(file, 9)//''' are not done', 9, &
                           diagnostics)
      end if
    end do
    scene%start_contacts = scene%start_contacts(:n)
  end subroutine read_start_contacts

  !> First contactor of each body: bodies have theirs one after another.
  subroutine first_contactors(contactors, n_bodies, first)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: n_bodies
    integer(i4), allocatable, intent(out) :: first(:)
    integer :: c, b

    allocate (first(n_bodies + 1), source=0_i4)
    do c = 1, contactors%n
      first(contactors%body(c) + 1) = first(contactors%body(c) + 1) + 1
    end do
    first(1) = 1
    do b = 1, n_bodies
      first(b + 1) = first(b + 1) + first(b)
    end do
  end subroutine first_contactors

  !> Read one contact: a title, who touches whom, forces, velocities, gap, normal, point.
  subroutine read_contact(file, first, contacts, n, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer(i4), intent(in) :: first(:)
    type(start_contact_t), intent(inout) :: contacts(:)
    integer, intent(inout) :: n
    type(diagnostics_t), intent(inout) :: diagnostics
    type(start_contact_t) :: contact
    integer :: i
    logical :: ok

    if (.not. next_data_line(file, 'the title of a contact', diagnostics)) return
    if (.not. next_data_line(file, 'the bodies of a contact', diagnostics)) return
    ok = .true.
    call read_identity(file, first, contact, ok, diagnostics)
    if (.not. next_data_line(file, 'the forces of a contact', diagnostics)) return
    ! In two dimensions the tangential component comes first.
    call real_field(file, triple(2), contact%force(1), ok, diagnostics)
    call real_field(file, triple(1), contact%force(2), ok, diagnostics)
    do i = 1, 3
      if (.not. next_data_line(file, 'the velocities, gap and normal of a contact', diagnostics)) return
    end do
    if (.not. next_data_line(file, 'the point of a contact', diagnostics)) return
    call real_field(file, triple(1), contact%point(1), ok, diagnostics)
    call real_field(file, triple(2), contact%point(2), ok, diagnostics)
    if (.not. ok) return
    n = n + 1
    contacts(n) = contact
  end subroutine read_contact

  !> Read who touches whom. Words are counted, not columns: these differ by pair and by size of the numbers.
  !!
  !!     RBDY2 body DISKx rank            law RBDY2 body JONCx rank            status
  !!     RBDY2 body POLYG rank CDVER n    law RBDY2 body POLYG rank ANSEG n    status
  subroutine read_identity(file, first, contact, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer(i4), intent(in) :: first(:)
    type(start_contact_t), intent(inout) :: contact
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    integer, parameter :: most_words = 16
    character(len=12) :: words(most_words)
    integer :: at(most_words), n, next

    call split(line_text(file), words, at, n)
    next = 1
    if (n >= 10) then
      call read_side(file, first, words, at, next, contact%contactor(1), ok, diagnostics)
      next = next + 1
      call read_side(file, first, words, at, next, contact%contactor(2), ok, diagnostics)
      if (next <= n) then
        contact%status = status_of(file, trim(words(next)), at(next), diagnostics)
        return
      end if
    end if
    if (ok) call complain(file, 'this line does not say who touches whom', 2, diagnostics)
    ok = .false.
  end subroutine read_identity

  !> Read one side of a contact: body and rank of its contactor, then perhaps a vertex or a segment.
  subroutine read_side(file, first, words, at, next, contactor, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer(i4), intent(in) :: first(:)
    character(len=*), intent(in) :: words(:)
    integer, intent(in) :: at(:)
    integer, intent(inout) :: next
    integer, intent(out) :: contactor
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: body, rank, status(2)

    contactor = 0
    read (words(next + 1), *, iostat=status(1)) body
    read (words(next + 3), *, iostat=status(2)) rank
    if (any(status /= 0)) then
      if (ok) call complain(file, 'a body or contactor has no readable number', at(next + 1), diagnostics)
      ok = .false.
    else if (body < 1 .or. body >= size(first)) then
      if (ok) call complain(file, 'there is no body '//to_text(body), at(next + 1), diagnostics)
      ok = .false.
    else if (rank < 1 .or. rank > first(body + 1) - first(body)) then
      if (ok) call complain(file, 'body '//to_text(body)//' has no contactor '//to_text(rank), at(next + 3), diagnostics)
      ok = .false.
    else
      contactor = first(body) + rank - 1
    end if
    next = next + 4
    if (any(words(next) == [character(len=5) :: 'CDVER', 'ANSEG'])) next = next + 2
  end subroutine read_side

  !> The words of a line and the columns at which they begin.
  pure subroutine split(line, words, at, n)
    character(len=*), intent(in) :: line
    character(len=*), intent(out) :: words(:)
    integer, intent(out) :: at(:)
    integer, intent(out) :: n
    integer :: i

    words = ''
    at = 1
    n = 0
    do i = 1, len(line)
      if (line(i:i) == ' ') cycle
      if (i > 1) then
        if (line(i - 1:i - 1) /= ' ') cycle
      end if
      if (n == size(words)) return
      n = n + 1
      at(n) = i
      words(n) = line(i:i + index(line(i:)//' ', ' ') - 2)
    end do
  end subroutine split

  !> Our status for LMGC90's; the first letter W, M or C tells of wet, Mohr and cohesive laws.
  integer(i1) function status_of(file, word, column, diagnostics) result(status)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: word
    integer, intent(in) :: column
    type(diagnostics_t), intent(inout) :: diagnostics

    select case (word)
    case ('stick', 'Wstck')
      status = status_stick
    case ('slide', 'slifw', 'slibw', 'Wslid', 'Wslfw', 'Wslbw', 'Mslid', 'Mslfw', 'Mslbw', 'Cslid', 'Cslfw', 'Cslbw')
      status = status_slide
    case ('noctc', 'vnish', 'Wnctc', 'Mnctc', 'Cnctc')
      status = status_none
    case ('Mstck', 'Cstck')
      status = status_bonded
    case default
      status = status_new
      if (any(word == [character(len=5) :: 'nknow', 'Wnnow', 'Mnnow', 'Cnnow'])) return
      call remark_once(file, 'status', 'the status '''//word//''' is not known and taken as new', column, diagnostics)
    end select
  end function status_of
end module sg_datbox_state
