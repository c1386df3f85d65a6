!> Writes the links of a scene into a DATBOX: see tables for their points, and a network file that lists them.
!!
!! By its see tables alone LMGC90 links all points that are near. The network file lists those that are meant; the script has to
!! call PTPT2_LoadNetwork or PTPT3_LoadNetwork, and PTPT2_LoadParams or PTPT3_LoadParams where there are NARD rods.
module sg_datbox_write_links
  use sg_contactors, only: kind_point
  use sg_datbox_bodies, only: body_type
  use sg_datbox_output, only: finish_file, output_t, put, real_word, start_file
  use sg_datbox_sees, only: datbox_kind_name
  use sg_datbox_write_contacts, only: datbox_contacts_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_laws, only: law_bond
  use sg_lists, only: reserve
  use sg_local_numbers, only: contactors_of_bodies
  use sg_scene, only: scene_t
  use sg_text, only: to_text
  implicit none
  private
  public :: stand_together, put_link_sees, write_network

contains

  !> Renumber contactors so that those of each body stand together, as the format has them; contacts and links follow.
  subroutine stand_together(scene, contacts)
    type(scene_t), intent(inout) :: scene !! scene to write
    type(datbox_contacts_t), intent(inout) :: contacts !! its contacts
    integer(i4), allocatable :: first(:), list(:), place(:)
    integer :: c, l

    if (scene%links%n == 0) return
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    allocate (place(size(list)))
    do c = 1, size(list)
      place(list(c)) = int(c, i4)
    end do
    associate (own => scene%contactors, n => scene%contactors%n)
      own%kind(:n) = own%kind(list)
      own%body(:n) = own%body(list)
      own%row(:n) = own%row(list)
      own%colour(:n) = own%colour(list)
      own%shift(:, :n) = own%shift(:, list)
      own%reach(:n) = own%reach(list)
      own%centre(:, :n) = own%centre(:, list)
    end associate
    do l = 1, scene%links%n
      scene%links%number(:, l) = place(scene%links%number(:, l))
    end do
    do c = 1, contacts%n
      contacts%contactor(:, c) = place(contacts%contactor(:, c))
    end do
    scene%links%contactor = scene%links%number
  end subroutine stand_together

  !> Laws and colours of points that links bring together, each once, with the longest link: law, two colours, shape (3, lines).
  subroutine link_lines(scene, line, longest, of_link)
    type(scene_t), intent(in) :: scene
    integer(i4), allocatable, intent(out) :: line(:, :)
    real(wp), allocatable, intent(out) :: longest(:)
    integer, allocatable, intent(out) :: of_link(:) !! line of each link
    integer(i4) :: wanted(3)
    integer :: l, i, n

    allocate (of_link(scene%links%n), line(3, 0), longest(0))
    n = 0
    do l = 1, scene%links%n
      wanted = [scene%links%law(l), scene%contactors%colour(scene%links%number(:, l))]
      do i = 1, n
        if (all(line(:, i) == wanted) .or. all(line(:, i) == wanted([1, 3, 2]))) exit
      end do
      if (i > n) then
        n = i
        call reserve(line, 3, n)
        call reserve(longest, n)
        line(:, n) = wanted
        longest(n) = 0
      end if
      of_link(l) = i
      longest(i) = max(longest(i), scene%links%length(l))
    end do
    line = line(:, :n)
    longest = longest(:n)
  end subroutine link_lines

  !> Write the see tables of links.
  subroutine put_link_sees(output, scene, laws, colours)
    type(output_t), intent(inout) :: output !! TACT_BEHAV.DAT
    type(scene_t), intent(in) :: scene !! scene to write
    character(len=5), intent(in) :: laws(:) !! names of the laws
    character(len=5), intent(in) :: colours(:) !! names of the colours
    integer(i4), allocatable :: line(:, :)
    real(wp), allocatable :: longest(:)
    integer, allocatable :: of_link(:)
    character(len=:), allocatable :: point
    integer :: i

    call link_lines(scene, line, longest, of_link)
    do i = 1, size(longest)
      point = ' '//body_type(scene%dimension)//'  '//datbox_kind_name(kind_point, scene%dimension)//'  '
      call put(output, '$seety')
      call put(output, ' cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert')
      ! Lengths are written to eight digits: the longest link must not fall out.
      call put(output, point//colours(line(2, i))//'  '//laws(line(1, i))//' '//point//colours(line(3, i))//'      '// &
               real_word((1 + 1e-6_wp)*longest(i)))
    end do
  end subroutine put_link_sees

  !> Write the network file.
  subroutine write_network(folder, scene, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(in) :: scene !! scene to write, its contactors standing by body
    type(error_t), allocatable, intent(inout) :: error !! set when the file cannot be written
    type(output_t) :: output
    integer(i4), allocatable :: line(:, :)
    real(wp), allocatable :: longest(:)
    integer, allocatable :: of_link(:)
    integer :: rank(scene%contactors%n), points, c, l
    logical :: has_bonds
    character(len=:), allocatable :: text

    if (scene%links%n == 0) return
    points = 0
    do c = 1, scene%contactors%n
      if (scene%contactors%kind(c) == kind_point) points = points + 1
      rank(c) = points
    end do
    call link_lines(scene, line, longest, of_link)
    call start_file(output, folder, merge('PTPT2_NETWORK.DAT', 'PTPT3_NETWORK.DAT', scene%dimension == 2))
    associate (links => scene%links)
      has_bonds = any(scene%laws(links%law(:links%n))%kind == law_bond)
      do l = 1, links%n
        text = to_text(rank(links%number(1, l)))//' '//to_text(rank(links%number(2, l)))
        if (scene%dimension == 2) then
          text = to_text(of_link(l))//' '//text
        else
          text = text//' '//to_text(int(links%image(1, l)))//' '//to_text(int(links%image(2, l)))//' 0'
        end if
        ! Reference distance; with parameters section, length and mass too, in space the distance being the length.
        if (has_bonds) text = text//' '//real_word(links%area(l))
        text = text//' '//real_word(links%length(l))
        if (has_bonds) text = text//' '//real_word(links%mass(l))
        if (has_bonds .and. scene%dimension == 2) text = text//' '//real_word(links%length(l))
        call put(output, text)
      end do
    end associate
    call finish_file(output, error)
  end subroutine write_network
end module sg_datbox_write_links
