!> Vloc_Rloc.INI of a DATBOX: the contacts known at the start, with their mean forces.
module sg_datbox_contacts
  use sg_datbox_blocks, only: read_point
  use sg_datbox_internal, only: internal_of_numbers, most_numbers, n_numbers_of
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, digest_of, go_to, keyword, line_text, name_field, &
                             next_data_line, next_line, open_datbox_file, remark, step_back
  use sg_datbox_numbers, only: is_real, real_field
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i1
  use sg_laws, only: law_bond, law_linear, law_t, status_bonded, status_broken, status_new, status_none, status_slide, status_stick
  use sg_link_laws, only: pulls_only
  use sg_links, only: link_between
  use sg_scene, only: law_index, scene_t, start_contact_t
  use sg_shape_pairs, only: is_datbox_pair
  use sg_share, only: piece_of, share_t
  use sg_text, only: to_text
  implicit none
  private
  public :: read_start_contacts, components_of

contains

  !> Read the contacts known at the start, with their mean forces; of several ranks each keeps a piece of them.
  subroutine read_start_contacts(folder, scene, share, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! gets the contacts, with the numbers of the whole scene
    type(share_t), intent(inout) :: share !! holds the contactors of all bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(datbox_file_t) :: file
    type(start_contact_t) :: contact
    integer :: k, n, piece(2)
    logical :: ok

    call open_datbox_file(file, folder, 'Vloc_Rloc.INI', .false., diagnostics)
    call share%census%mix(digest_of(file))
    if (file%n == 0 .and. scene%start_step > 0) then
      call diagnostics%warn('no contacts: the file is missing or empty, the solver starts without impulses', file=file%path)
    end if
    n = 0
    do while (next_line(file))
      if (keyword(file) == 'icdan') n = n + 1
    end do
    if (allocated(scene%start_contacts)) deallocate (scene%start_contacts)
    piece = piece_of(n, share%rank, share%ranks)
    allocate (scene%start_contacts(piece(2) - piece(1) + 1))
    call go_to(file, 0)
    n = 0
    k = 0
    do while (next_line(file))
      if (keyword(file) /= 'icdan') cycle
      k = k + 1
      ok = .false.
      if (is_datbox_pair(name_field(file, 9), scene%dimension)) then
        call read_contact(file, scene, share, contact, ok, diagnostics)
      else
        call complain_once(file, name_field(file, 9), 'contacts of type '''//name_field(file, 9)//''' are not done', 9, &
                           diagnostics)
      end if
      if (ok) call take_length(scene, contact)
      if (.not. ok .or. k < piece(1) .or. k > piece(2)) cycle
      n = n + 1
      scene%start_contacts(n) = contact
    end do
    scene%start_contacts = scene%start_contacts(:n)
  end subroutine read_start_contacts

  !> Read one contact: a title, the pair of contactors, then forces, velocities, gap, frame, point, and internal values of its law.
  subroutine read_contact(file, scene, share, contact, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene
    type(share_t), intent(in) :: share
    type(start_contact_t), intent(out) :: contact
    logical, intent(out) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: pair
    real(wp) :: tangents(3, 2)
    integer :: law

    ok = .false.
    pair = name_field(file, 9)
    if (.not. next_data_line(file, 'the title of a contact', diagnostics)) return
    if (.not. next_data_line(file, 'the bodies of a contact', diagnostics)) return
    ok = .true.
    call read_identity(file, share, scene, contact, law, ok, diagnostics)
    tangents = 0
    if (scene%dimension == 2) then
      call read_planar_force(file, contact, ok, diagnostics)
    else
      call read_solid_force(file, pair, contact, tangents, ok, diagnostics)
    end if
    if (ok .and. law > 0) call read_internal(file, scene%laws(law), scene%dimension, tangents, contact, ok, diagnostics)
    if (ok .and. law > 0 .and. pair(:4) == 'PTPT') call make_link(scene%laws(law), contact)
  end subroutine read_contact

  !> The length at rest of a rod or wire is that which stands behind its contact, as in LMGC90, if one does.
  subroutine take_length(scene, contact)
    type(scene_t), intent(inout) :: scene
    type(start_contact_t), intent(inout) :: contact
    integer :: l

    if (scene%links%n == 0 .or. .not. contact%has_internal) return
    l = link_between(scene%links, contact%contactor)
    if (l == 0) return
    if (any(scene%laws(scene%links%law(l))%kind == [law_linear, law_bond])) return
    if (contact%internal(1) > 0) scene%links%length(l) = contact%internal(1)
    contact%internal = 0
    contact%has_internal = .false.
  end subroutine take_length

  !> A contact of two points as ours: the normal of a wire is turned round, and what has broken stays so.
  pure subroutine make_link(law, contact)
    type(law_t), intent(in) :: law
    type(start_contact_t), intent(inout) :: contact

    if (pulls_only(law) .and. .not. contact%is_vector) contact%force = -contact%force
    if (law%kind == law_bond .and. contact%status == status_none) contact%status = status_broken
    if (law%breaking_force > 0 .and. contact%status == status_none) contact%status = status_broken
    ! In space the file does not hold the tangents along which the bond was sheared.
    if (law%kind == law_bond .and. contact%is_vector) contact%internal(2:) = 0
  end subroutine make_link

  !> Read the numbers that some laws have LMGC90 write behind a contact, where they are there.
  subroutine read_internal(file, law, dimension, tangents, contact, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(law_t), intent(in) :: law
    integer, intent(in) :: dimension
    real(wp), intent(in) :: tangents(3, 2)
    type(start_contact_t), intent(inout) :: contact
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: numbers(most_numbers)
    integer :: i

    if (n_numbers_of(law, dimension) == 0) return
    if (.not. next_line(file)) return
    if (keyword(file) /= '' .or. .not. is_real(file, 2)) then
      call step_back(file)
      return
    end if
    numbers = 0
    do i = 1, n_numbers_of(law, dimension)
      call real_field(file, 15*i - 13, numbers(i), ok, diagnostics)
    end do
    contact%internal = internal_of_numbers(law, dimension, numbers, tangents)
    contact%has_internal = ok
  end subroutine read_internal

  !> Read force and point of a contact in the plane; the tangential component comes first there.
  subroutine read_planar_force(file, contact, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(start_contact_t), intent(inout) :: contact
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: force(2)
    integer :: i

    call read_point(file, 'the forces of a contact', force, ok, diagnostics)
    contact%force(:2) = force([2, 1])
    do i = 1, 3
      if (ok) ok = next_data_line(file, 'the velocities, gap and normal of a contact', diagnostics)
    end do
    if (ok) call read_point(file, 'the point of a contact', contact%point(:2), ok, diagnostics)
  end subroutine read_planar_force

  !> Read force, frame and point of a contact in space; the force becomes a vector of the world.
  !!
  !! The order of the components depends on the pair; the lines behind the gap differ by their first letter.
  subroutine read_solid_force(file, pair, contact, tangents, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: pair
    type(start_contact_t), intent(inout) :: contact
    real(wp), intent(out) :: tangents(3, 2) !! axes t and s
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: force(3), axes(3, 3), values(3)
    character(len=3) :: letters
    character(len=1) :: letter
    integer :: i, axis
    logical :: seen(4)

    tangents = 0
    letters = components_of(pair)
    call read_point(file, 'the forces of a contact', force, ok, diagnostics)
    do i = 1, 2
      if (ok) ok = next_data_line(file, 'the velocities and gap of a contact', diagnostics)
    end do
    axes = 0
    seen = .false.
    ! Between points there are no lines of tangents.
    if (pair == 'PTPT3') seen([1, 3]) = .true.
    do i = 1, count(.not. seen)
      if (ok) call read_point(file, 'the frame and point of a contact', values, ok, diagnostics)
      if (.not. ok) return
      letter = name_field(file, 30)
      axis = index(letters//'c', letter)
      if (axis == 0) then
        call complain(file, 'an axis s, t or n of the frame, or the point coo, should stand here', 30, diagnostics)
        ok = .false.
        return
      end if
      seen(axis) = .true.
      if (axis == 4) contact%point = values
      if (axis < 4) axes(:, axis) = values
    end do
    if (.not. all(seen)) then
      call complain(file, 'the frame or the point of this contact is not complete', 30, diagnostics)
      ok = .false.
    end if
    contact%is_vector = .true.
    contact%force = matmul(axes, force)
    tangents = axes(:, [index(letters, 't'), index(letters, 's')])
  end subroutine read_solid_force

  !> Order in which LMGC90 writes the components of a pair of space.
  pure function components_of(pair) result(letters)
    character(len=*), intent(in) :: pair !! LMGC90's name of the pair
    character(len=3) :: letters

    letters = 'stn'
    if (any(pair == [character(len=5) :: 'PRPRx', 'PTPT3'])) letters = 'tns'
  end function components_of

  !> Read the two contactors. Words are counted, not columns: these differ by pair and by size of the numbers.
  !!
  !!     RBDY2 body DISKx rank            law RBDY2 body JONCx rank            status
  !!     RBDY2 body POLYG rank CDVER n    law RBDY2 body POLYG rank ANSEG n    status
  !!     RBDY3 body POLYR rank n          law RBDY3 body PLANx rank            status
  subroutine read_identity(file, share, scene, contact, law, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(share_t), intent(in) :: share
    type(scene_t), intent(in) :: scene
    type(start_contact_t), intent(inout) :: contact
    integer, intent(out) :: law !! its law; 0 where the scene has none of its name
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    integer, parameter :: most_words = 16
    character(len=12) :: words(most_words)
    integer :: at(most_words), n, next

    call split(line_text(file), words, at, n)
    next = 1
    law = 0
    if (n >= 10) then
      call read_side(file, share, scene%dimension, words, at, next, contact%contactor(1), ok, diagnostics)
      law = law_index(scene, trim(words(next)))
      next = next + 1
      call read_side(file, share, scene%dimension, words, at, next, contact%contactor(2), ok, diagnostics)
      if (next <= n) then
        contact%status = status_of(file, trim(words(next)), at(next), diagnostics)
        return
      end if
    end if
    if (ok) call complain(file, 'this line does not name the two contactors', 2, diagnostics)
    ok = .false.
  end subroutine read_identity

  !> Read one side of a contact: body and rank of its contactor, then perhaps a vertex or a segment.
  subroutine read_side(file, share, dimension, words, at, next, contactor, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(share_t), intent(in) :: share
    integer, intent(in) :: dimension
    character(len=*), intent(in) :: words(:)
    integer, intent(in) :: at(:)
    integer, intent(inout) :: next
    integer, intent(out) :: contactor
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: body, rank, status(2), ends(2)

    contactor = 0
    read (words(next + 1), *, iostat=status(1)) body
    read (words(next + 3), *, iostat=status(2)) rank
    if (any(status /= 0)) then
      if (ok) call complain(file, 'a body or contactor has no readable number', at(next + 1), diagnostics)
      ok = .false.
    else if (body < 1 .or. body > share%made) then
      if (ok) call complain(file, 'there is no body '//to_text(body), at(next + 1), diagnostics)
      ok = .false.
    else
      ends = share%contactors_of(body)
      if (dimension == 3 .and. rank > 1 .and. ends(1) == ends(2)) then
        ! Some versions of LMGC90 number contactors through all bodies.
        call remark(file, 'rank', 'body '//to_text(body)//' has one contactor, which is meant by number '//to_text(rank), &
                         at(next + 3), diagnostics)
        rank = 1
      end if
      if (rank < 1 .or. rank > ends(2) - ends(1) + 1) then
        if (ok) call complain(file, 'body '//to_text(body)//' has no contactor '//to_text(rank), at(next + 3), diagnostics)
        ok = .false.
      else
        contactor = ends(1) + rank - 1
      end if
    end if
    next = next + 4
    if (any(words(next) == [character(len=5) :: 'CDVER', 'ANSEG'])) then
      next = next + 2
    else if (dimension == 3 .and. verify(trim(words(next)), '0123456789') == 0) then
      next = next + 1
    end if
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

  !> Our status for LMGC90's; the first letter W, M or C stands for wet, Mohr and cohesive laws.
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
      call remark(file, 'status', 'the status '''//word//''' is not known and taken as new', column, diagnostics)
    end select
  end function status_of
end module sg_datbox_contacts
