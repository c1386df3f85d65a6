!> Writes Vloc_Rloc.INI: contacts with their mean forces, velocities, gaps and frames.
module sg_datbox_write_contacts
  use sg_contactors, only: kind_plane, kind_point, kind_polygon, kind_polyhedron
  use sg_datbox_contacts, only: components_of
  use sg_datbox_internal, only: most_numbers, n_numbers_of, numbers_of_internal
  use sg_datbox_output, only: finish_file, labelled, output_t, put, put_steps, real_word, start_file
  use sg_datbox_sees, only: datbox_kind_name
  use sg_error, only: error_t
  use sg_internal_values, only: most_internal
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: is_cohesive_zone, law_bond, law_t, status_new
  use sg_link_laws, only: pulls_only
  use sg_links, only: link_between
  use sg_scene, only: scene_t
  use sg_sees, only: see_between
  use sg_shape_pairs, only: datbox_pair_name
  use sg_vectors, only: cross
  implicit none
  private
  public :: datbox_contacts_t, contacts_at_start, write_contacts

  !> Words for our statuses, indexed from 0, and those of cohesive zones
  character(len=5), parameter :: status_words(0:5) = [character(len=5) :: 'nknow', 'noctc', 'stick', 'slide', 'Mstck', 'vnish'], &
    bonded_words(0:5) = [character(len=5) :: 'Cnnow', 'Cnctc', 'Cstck', 'Cslfw', 'Cstck', 'Cnctc']

  !> Contacts and what they carry at one instant
  type :: datbox_contacts_t
    !> Number of contacts
    integer :: n = 0
    !> Contactors, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: contactor(:, :)
    !> Point [m] and normal from antagonist to candidate, shape (dimension, n)
    real(wp), allocatable :: point(:, :), normal(:, :)
    !> Gap [m], shape (n)
    real(wp), allocatable :: gap(:)
    !> Mean force of the step on the candidate [N] and relative velocity [m/s], shape (dimension, n): normal and
    !! tangential, in space in the world's axes
    real(wp), allocatable :: force(:, :), velocity(:, :)
    !> One of `status_*`, shape (n)
    integer(i1), allocatable :: status(:)
    !> Internal values, zero beyond those of the law, shape (most_internal, n)
    real(wp), allocatable :: internal(:, :)
  end type datbox_contacts_t

contains

  !> The contacts that a scene holds at its start, and all its links, of which the file is to hold the lengths; normals, gaps and
  !! velocities are not known and zero.
  function contacts_at_start(scene) result(contacts)
    type(scene_t), intent(in) :: scene !! scene that may hold contacts
    type(datbox_contacts_t) :: contacts
    integer :: i, l, n, known

    known = 0
    if (allocated(scene%start_contacts)) known = size(scene%start_contacts)
    contacts%n = known + scene%links%n
    n = scene%dimension
    allocate (contacts%contactor(2, contacts%n), contacts%status(contacts%n))
    allocate (contacts%point(n, contacts%n), contacts%force(n, contacts%n), source=0.0_wp)
    allocate (contacts%normal(n, contacts%n), contacts%velocity(n, contacts%n), source=0.0_wp)
    allocate (contacts%gap(contacts%n), source=0.0_wp)
    allocate (contacts%internal(most_internal, contacts%n), source=0.0_wp)
    do i = 1, known
      contacts%contactor(:, i) = scene%start_contacts(i)%contactor
      contacts%point(:, i) = scene%start_contacts(i)%point(:n)
      contacts%force(:, i) = scene%start_contacts(i)%force(:n)
      contacts%status(i) = scene%start_contacts(i)%status
      contacts%internal(:, i) = scene%start_contacts(i)%internal
    end do
    contacts%n = known
    do l = 1, scene%links%n
      if (any([(all(contacts%contactor(:, i) == scene%links%number(:, l)), i=1, known)])) cycle
      contacts%n = contacts%n + 1
      contacts%contactor(:, contacts%n) = scene%links%number(:, l)
      contacts%status(contacts%n) = status_new
      ! A bond begins at its length.
      contacts%internal(1, contacts%n) = scene%links%length(l)
    end do
  end function contacts_at_start

  !> Write Vloc_Rloc.INI.
  subroutine write_contacts(folder, scene, first, list, contacts, laws, time, step_number, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(in) :: scene !! scene to write
    integer(i4), intent(in) :: first(:) !! first place of each body in the list
    integer(i4), intent(in) :: list(:) !! contactors grouped by body
    type(datbox_contacts_t), intent(in) :: contacts !! contacts to write
    character(len=5), intent(in) :: laws(:) !! names of the laws
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step_number !! number of steps made
    type(error_t), allocatable, intent(inout) :: error !! set when the file cannot be written
    type(output_t) :: output
    type(datbox_contacts_t) :: turned
    integer, allocatable :: rank(:)
    integer :: b, i
    logical :: is_large

    allocate (rank(scene%contactors%n))
    do b = 1, scene%bodies%n
      rank(list(first(b):first(b + 1) - 1)) = [(i, i=1, first(b + 1) - first(b))]
    end do
    turned = contacts
    if (scene%links%n > 0) call turn_wires(scene, turned)
    is_large = max(contacts%n, scene%bodies%n) > 99999
    call start_file(output, folder, 'Vloc_Rloc.INI')
    call put(output, '! Vloc_Rloc')
    call put_steps(output, time, step_number)
    do i = 1, contacts%n
      call put_contact(output, scene, rank, turned, i, laws, is_large)
    end do
    call finish_file(output, error)
  end subroutine write_contacts

  !> Turn the normals of wires to where LMGC90 has them: from the antagonist to the candidate, so that they pull by negative forces.
  subroutine turn_wires(scene, contacts)
    type(scene_t), intent(in) :: scene
    type(datbox_contacts_t), intent(inout) :: contacts
    integer :: k, l

    do k = 1, contacts%n
      if (scene%contactors%kind(contacts%contactor(1, k)) /= kind_point) cycle
      l = link_between(scene%links, int(contacts%contactor(:, k)))
      if (l == 0) cycle
      if (.not. pulls_only(scene%laws(scene%links%law(l)))) cycle
      contacts%normal(:, k) = -contacts%normal(:, k)
      if (scene%dimension == 3) cycle
      contacts%force(:, k) = -contacts%force(:, k)
      contacts%velocity(:, k) = -contacts%velocity(:, k)
    end do
  end subroutine turn_wires

  !> Write one contact.
  subroutine put_contact(output, scene, rank, contacts, contact, laws, is_large)
    type(output_t), intent(inout) :: output
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank(:), contact
    type(datbox_contacts_t), intent(in) :: contacts
    character(len=5), intent(in) :: laws(:)
    logical, intent(in) :: is_large
    character(len=32) :: line
    character(len=5) :: law, status
    integer :: c(2), kinds(2), see, own

    c = contacts%contactor(:, contact)
    kinds = scene%contactors%kind(c)
    own = 0
    see = see_between(scene, c(1), c(2))
    if (see > 0) own = scene%sees(see)%law
    see = 0
    if (all(kinds == kind_point)) see = link_between(scene%links, c)
    if (see > 0) own = scene%links%law(see)
    write (line, '(a,a,2x,i10)') '$icdan  ', datbox_pair_name(kinds, scene%dimension), contact
    if (.not. is_large) write (line, '(a,a,2x,i7)') '$icdan  ', datbox_pair_name(kinds, scene%dimension), contact
    call put(output, line)
    law = 'nolaw'
    status = status_words(contacts%status(contact))
    if (own > 0) then
      law = laws(own)
      if (is_cohesive_zone(scene%laws(own))) status = bonded_words(contacts%status(contact))
    end if
    if (scene%dimension == 3) then
      call put_solid_contact(output, scene, rank, contacts, contact, law, status, is_large)
      if (own > 0) call put_internal(output, scene, scene%laws(own), see, contacts, contact)
      return
    end if
    call put(output, ' cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus')
    call put(output, ' '//side(scene, rank, c(1), 'CDVER', kinds(1) == kind_polygon, is_large)//'  '//law//'  ' &
             //side(scene, rank, c(2), 'ANSEG', kinds(1) == kind_polygon, is_large)//'  '//status)
    call put(output, labelled('rlt/H rln/H rls/H ', [contacts%force(2, contact), contacts%force(1, contact), 0.0_wp]))
    call put(output, labelled('vlt = vln = vls = ', [contacts%velocity(2, contact), contacts%velocity(1, contact), 0.0_wp]))
    call put(output, labelled('gapTT ', contacts%gap(contact:contact)))
    call put(output, labelled('n(1)= n(2)= n(3)= ', [contacts%normal(:, contact), 0.0_wp]))
    call put(output, labelled('coo1= coo2= coo3= ', [contacts%point(:, contact), 0.0_wp]))
    if (own > 0) call put_internal(output, scene, scene%laws(own), see, contacts, contact)
  end subroutine put_contact

  !> Write the numbers that stand behind a contact under some laws, after a line that LMGC90 passes over.
  subroutine put_internal(output, scene, law, link, contacts, contact)
    type(output_t), intent(inout) :: output
    type(scene_t), intent(in) :: scene
    type(law_t), intent(in) :: law
    integer, intent(in) :: link !! link of the contact, 0 where it is none
    type(datbox_contacts_t), intent(in) :: contacts
    integer, intent(in) :: contact
    real(wp) :: numbers(most_numbers), frame(3, 3)
    character(len=:), allocatable :: line
    integer :: i, d

    d = size(contacts%normal, 1)
    if (n_numbers_of(law, d) == 0) return
    frame = 0
    if (d == 3) frame = contact_frame(contacts%normal(:, contact), contacts%force(:, contact), 'tsn')
    numbers = numbers_of_internal(law, d, contacts%internal(:, contact), frame(:, 1:2))
    if (link > 0) then
      if (law%kind == law_bond) numbers(4:6) = [scene%links%area(link), scene%links%length(link), scene%links%mass(link)]
      if (law%kind /= law_bond) numbers(1) = scene%links%length(link)
    end if
    line = ''
    do i = 1, n_numbers_of(law, d)
      line = line//' '//real_word(numbers(i))
    end do
    call put(output, '# internal values')
    call put(output, line)
  end subroutine put_internal

  !> Write the pair, force, velocity, gap, frame and point of a contact in space.
  subroutine put_solid_contact(output, scene, rank, contacts, contact, law, status, is_large)
    type(output_t), intent(inout) :: output
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank(:), contact
    type(datbox_contacts_t), intent(in) :: contacts
    character(len=5), intent(in) :: law, status
    logical, intent(in) :: is_large
    character(len=3) :: letters
    character(len=7) :: vertex
    real(wp) :: frame(3, 3)
    integer :: c(2), k

    c = contacts%contactor(:, contact)
    letters = components_of(datbox_pair_name(int(scene%contactors%kind(c)), 3))
    vertex = ''
    if (all(scene%contactors%kind(c) == [kind_polyhedron, kind_plane])) vertex(7:7) = '1'
    call put(output, ' cdbdy  numbr  cdtac  numbr  CDVER  behav  anbdy  numbr  antac  numbr  sttus')
    call put(output, ' '//solid_side(scene, rank, c(1), is_large)//vertex//'  '//law//'  ' &
             //solid_side(scene, rank, c(2), is_large)//'  '//status)
    frame = contact_frame(contacts%normal(:, contact), contacts%force(:, contact), letters)
    call put(output, labelled(named('rl', '/H '), matmul(contacts%force(:, contact), frame)))
    call put(output, labelled(named('vl', ' = '), matmul(contacts%velocity(:, contact), frame)))
    call put(output, labelled('gapTT ', contacts%gap(contact:contact)))
    if (scene%contactors%kind(c(1)) == kind_point) then
      call put(output, labelled('n(1)= n(2)= n(3)= ', frame(:, 2)))
      call put_point()
      return
    end if
    if (any(scene%contactors%kind(c(1)) == [kind_polyhedron])) call put_point()
    ! Polyhedra have t, n, s, the others s, t, n.
    letters = 'stn'
    if (scene%contactors%kind(c(1)) == kind_polyhedron) letters = 'tns'
    frame = contact_frame(contacts%normal(:, contact), contacts%force(:, contact), letters)
    do k = 1, 3
      call put(output, labelled(letters(k:k)//'(1)= '//letters(k:k)//'(2)= '//letters(k:k)//'(3)= ', frame(:, k)))
    end do
    if (scene%contactors%kind(c(1)) /= kind_polyhedron) call put_point()
  contains
    !> Labels of three components.
    pure function named(before, behind) result(labels)
      character(len=2), intent(in) :: before
      character(len=3), intent(in) :: behind
      character(len=18) :: labels

      labels = before//letters(1:1)//behind//before//letters(2:2)//behind//before//letters(3:3)//behind
    end function named

    !> The line of the point.
    subroutine put_point()
      call put(output, labelled('coo1= coo2= coo3= ', contacts%point(:, contact)))
    end subroutine put_point
  end subroutine put_solid_contact

  !> Frame of a contact, its axes n, t, s in the order of the letters; s = t x n. Where no normal is known, the force is taken
  !! for it.
  pure function contact_frame(normal, force, letters) result(frame)
    real(wp), intent(in) :: normal(3), force(3)
    character(len=3), intent(in) :: letters
    real(wp) :: frame(3, 3), n(3), t(3)
    integer :: least

    n = [0.0_wp, 0.0_wp, 1.0_wp]
    if (norm2(normal) > 0) then
      n = normal/norm2(normal)
    else if (norm2(force) > 0) then
      n = force/norm2(force)
    end if
    least = minloc(abs(n), 1)
    t = 0
    t(least) = 1
    t = cross(n, t)
    t = t/norm2(t)
    frame(:, index(letters, 'n')) = n
    frame(:, index(letters, 't')) = t
    frame(:, index(letters, 's')) = cross(t, n)
  end function contact_frame

  !> One side of a contact in space: body and contactor.
  function solid_side(scene, rank, contactor, is_large) result(text)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank(:), contactor
    logical, intent(in) :: is_large
    character(len=:), allocatable :: text
    character(len=60) :: buffer

    write (buffer, merge('(a,i7,2x,a,2x,i7)', '(a,i5,2x,a,2x,i5)', is_large)) 'RBDY3  ', scene%contactors%body(contactor), &
      datbox_kind_name(int(scene%contactors%kind(contactor)), 3), rank(contactor)
    text = trim(buffer)
  end function solid_side

  !> One side of a contact: body and contactor, then, in contacts of polygons, a vertex or a segment.
  function side(scene, rank, contactor, feature, has_feature, is_large) result(text)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rank(:), contactor
    character(len=5), intent(in) :: feature
    logical, intent(in) :: has_feature, is_large
    character(len=:), allocatable :: text
    character(len=60) :: buffer

    if (is_large) then
      write (buffer, '(a,i10,2x,a,2x,i5)') 'RBDY2  ', scene%contactors%body(contactor), &
        datbox_kind_name(int(scene%contactors%kind(contactor)), 2), rank(contactor)
    else
      write (buffer, '(a,i5,2x,a,2x,i5)') 'RBDY2  ', scene%contactors%body(contactor), &
        datbox_kind_name(int(scene%contactors%kind(contactor)), 2), rank(contactor)
    end if
    text = trim(buffer)
    if (.not. has_feature) return
    ! A segment keeps the columns of a polygon's edge blank.
    if (scene%contactors%kind(contactor) == kind_polygon) then
      text = text//'  '//feature//'      1'
    else
      text = text//repeat(' ', 14)
    end if
  end function side
end module sg_datbox_write_contacts
