!> Links between the points of a DATBOX: those that see tables bring together, or those that a network file lists.
!!
!! A network file (PTPT2_NETWORK.DAT, PTPT3_NETWORK.DAT) has one link per line: in the plane see table, candidate, antagonist, and
!! in space candidate, antagonist, periods in x and y, and a mark; then perhaps section, length and mass, and the reference
!! distance, which is taken from the points instead. Points are numbered by rank through all bodies.
module sg_datbox_links
  use sg_datbox_lines, only: complain, datbox_file_t, go_to, keyword, line_text, next_line, open_datbox_file, remark
  use sg_datbox_numbers, only: free_numbers
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_laws, only: law_bond
  use sg_link_network, only: distance_of, line_between, link_by_distance, points_t
  use sg_links, only: add_link, locate_links
  use sg_scene, only: scene_t
  use sg_sees, only: links_points
  use sg_system, only: file_exists
  use sg_text, only: to_text
  implicit none
  private
  public :: read_links

contains

  !> Link the points of a scene.
  subroutine read_links(folder, scene, points, tact, see_lines, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(scene_t), intent(inout) :: scene !! scene with laws and see tables; gets links
    type(points_t), intent(in) :: points !! its points, in the order of the file
    type(datbox_file_t), intent(inout) :: tact !! TACT_BEHAV.DAT
    integer, intent(in) :: see_lines(:) !! line of each see table of the scene
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(datbox_file_t) :: file
    character(len=17) :: name

    name = merge('PTPT2_NETWORK.DAT', 'PTPT3_NETWORK.DAT', scene%dimension == 2)
    if (.not. file_exists(trim(folder)//'/'//name)) then
      call link_by_distance(scene, points)
    else
      call open_datbox_file(file, folder, name, .true., diagnostics)
      do while (next_line(file))
        call read_link(file, scene, points, ranks_of(tact, see_lines), diagnostics)
      end do
    end if
    call check_bonds(scene, trim(folder)//'/'//name, diagnostics)
    call locate_links(scene%links, scene%contactors)
  end subroutine read_links

  !> Ranks of the see tables of the scene among all of the file.
  function ranks_of(tact, see_lines) result(rank)
    type(datbox_file_t), intent(inout) :: tact
    integer, intent(in) :: see_lines(:)
    integer :: rank(size(see_lines)), n

    n = 0
    rank = 0
    call go_to(tact, 0)
    do while (next_line(tact))
      if (keyword(tact) == 'seety') n = n + 1
      where (see_lines == tact%at) rank = n
    end do
  end function ranks_of

  !> The link of one line.
  subroutine read_link(file, scene, points, ranks, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(points_t), intent(in) :: points
    integer, intent(in) :: ranks(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: numbers(8), bond(3)
    integer :: n, before, ends(2), image(2), see

    call count_numbers(line_text(file), numbers, n)
    before = merge(3, 5, scene%dimension == 2)
    if (n < before + 1) then
      call complain(file, 'a link of a network has '//to_text(before + 1)//' numbers or more', 1, diagnostics)
      return
    end if
    ends = nint(numbers(merge(2, 1, scene%dimension == 2) + [0, 1]))
    image = 0
    if (scene%dimension == 3) image = nint(numbers(3:4))
    if (any(ends < 1 .or. ends > points%n) .or. ends(1) == ends(2)) then
      call complain(file, 'a link needs two different points of the '//to_text(points%n)//' that there are', 1, diagnostics)
      return
    end if
    if (scene%dimension == 2) see = findloc(ranks, nint(numbers(1)), 1)
    if (scene%dimension == 3) see = line_between(scene, points, ends, anywhere=.true.)
    if (see > 0) then
      if (.not. links_points(scene%sees(see))) see = 0
    end if
    if (see == 0) then
      call complain(file, 'no see table for points brings these two together', 1, diagnostics)
      return
    end if
    bond = 0
    ! Section, length and mass; in space the length is the reference distance, before the mass.
    if (n >= before + 3) bond = numbers(before + 1:before + 3)
    call check_reference(file, scene, points, ends, bond, diagnostics)
    if (scene%laws(scene%sees(see)%law)%kind /= law_bond .or. .not. bond(2) > 0) bond(2) = distance_of(scene, points, ends)
    call add_link(scene%links, int(points%tag(1, ends)), image, scene%sees(see)%law, bond(2), bond(1), bond(3))
  end subroutine read_link

  !> The numbers at the beginning of a line, as many as there are.
  subroutine count_numbers(line, numbers, n)
    character(len=*), intent(in) :: line
    real(wp), intent(out) :: numbers(8)
    integer, intent(out) :: n
    logical :: ok

    do n = size(numbers), 1, -1
      call free_numbers(line, numbers(:n), ok)
      if (ok) return
    end do
  end subroutine count_numbers

  !> Warn of a length that is not the distance of the points.
  subroutine check_reference(file, scene, points, ends, bond, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene
    type(points_t), intent(in) :: points
    integer, intent(in) :: ends(2)
    real(wp), intent(in) :: bond(3)
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp), parameter :: slack = 1e-3_wp

    associate (distance => distance_of(scene, points, ends))
      if (.not. bond(2) > 0 .or. abs(bond(2) - distance) <= slack*distance) return
      call remark(file, 'length', 'this link is '//to_text(distance, 4)//' m long, but its line gives '//to_text(bond(2), 4)// &
                  ' m', 1, diagnostics)
    end associate
  end subroutine check_reference

  !> Bonds need a section, which only a network file gives.
  subroutine check_bonds(scene, file, diagnostics)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: file
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: l

    do l = 1, scene%links%n
      if (scene%laws(scene%links%law(l))%kind /= law_bond .or. scene%links%area(l) > 0) cycle
      call diagnostics%add('the law NARD_ROD needs the section and the mass of every link from this file', file=file)
      return
    end do
  end subroutine check_bonds
end module sg_datbox_links
