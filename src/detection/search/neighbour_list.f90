!> List of neighbours: pairs of contactors that may touch before they have moved by half the skin, and links behind them.
module sg_neighbour_list
  use sg_kinds, only: wp, i1, i4, i8
  use sg_lists, only: reserve, room_for
  use sg_memory, only: memory_t
  use sg_scene, only: image_shift, scene_t
  implicit none
  private
  public :: add_pair, give_back, image_of_pair, neighbours_t, offset_of

  !> All pairs that may touch soon
  type :: neighbours_t
    !> Number of pairs; those behind the first `n_near` are links
    integer :: n = 0, n_near = 0
    !> Link of each pair that is one: of pair `n_near + i` it is `link(i)`
    integer(i4), allocatable :: link(:)
    !> Times that the list was made
    integer :: builds = 0
    !> Contactors, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: contactor(:, :)
    !> Periods by which the antagonist is moved in x, and in space in y, shape (n); in a periodic cell along all axes
    integer(i1), allocatable :: image(:), image_y(:), image_z(:)
    !> Line of the scene's see tables, 0 for links, shape (n)
    integer(i4), allocatable :: see(:)
    !> Body of each slot, and slot of each body
    integer(i4), allocatable :: body_of(:), slot_of(:)
    !> Configuration at the making of the list, as `middle` of the bodies
    real(wp), allocatable :: built(:, :)
    !> What the list allows to each body: how far its shapes may move, and how far they are to be sought, together [m]
    real(wp), allocatable :: margin(:)
    !> How far shapes may move, two together, before the list is made again in any case [m]
    real(wp) :: skin = 0
    !> Skin of the next list, where all ranks of a decomposed scene must have the same; 0 where it is free to choose [m]
    real(wp) :: asked_skin = 0
    !> How much nearer two shapes may come to each other until the next detection, and for which such ways the list holds all that
    !! may be wanted, where alert distances follow the motion [m]
    real(wp) :: way = huge(1.0_wp)/4, listed_way = huge(1.0_wp)/4
    !> Alert distance of each line of the scene's see tables in the last detection [m]. Is that of a pair reduced to `least` of its
    !! line [m] until the solve shows that more is needed (sg_pair_alert), or, where that may be too short for some, by pair to what
    !! its own motion in a time step [s] asks for?
    real(wp), allocatable :: alert(:), least(:)
    logical :: is_reduced = .false., is_by_pair = .false.
    real(wp) :: time_step = 0
    !> Motion of each shape in twice the step with its free velocity (`find_motion` of sg_pair_alert)
    real(wp), allocatable :: motion(:, :)
    !> Does the solution of the step close a contact that a reduced alert distance has left out?
    logical :: is_too_short = .false.
    !> Solves of the step whose reduced distances were too short
    integer :: n_reduced = 0
    !> Substeps from one detection to the next
    integer :: substeps = 1
    !> Do corners of polygons wait in a detection until a pair needs them?
    logical :: corners_wait = .false.
    !> Are only shapes sought that touch, whatever the alert distances are?
    logical :: without_alert = .false.
    !> Rank whose contacts are sought, in a decomposed scene: each contact belongs to one rank
    integer :: rank = 0
    !> Memory that the list may grow in, and wall time at which its making ends; 0 for none [s]
    type(memory_t) :: memory
    real(wp) :: deadline = 0
    !> Did its making end early, by one of the two? The list is empty then; pairs found before
    logical :: is_cut = .false., is_late = .false.
    integer :: n_cut = 0
  end type neighbours_t

contains

  !> Append a pair.
  subroutine add_pair(pairs, dimension, has_cell, contactor, image, see)
    type(neighbours_t), intent(inout) :: pairs
    integer, intent(in) :: dimension
    logical, intent(in) :: has_cell !! are all axes periodic?
    integer(i4), intent(in) :: contactor(2) !! candidate and antagonist
    integer(i4), intent(in) :: image(3) !! periods along x, y, z by which the antagonist is moved
    integer, intent(in) :: see !! line of the see tables, 0 for a link

    call make_room(pairs, dimension, has_cell)
    if (pairs%is_cut) return
    pairs%n = pairs%n + 1
    pairs%contactor(:, pairs%n) = contactor
    pairs%image(pairs%n) = int(image(1), i1)
    if (dimension == 3 .or. has_cell) pairs%image_y(pairs%n) = int(image(2), i1)
    if (dimension == 3 .and. has_cell) pairs%image_z(pairs%n) = int(image(3), i1)
    pairs%see(pairs%n) = int(see, i4)
  end subroutine add_pair

  !> Make room for one more pair, unless memory is short.
  subroutine make_room(pairs, dimension, has_cell)
    type(neighbours_t), intent(inout) :: pairs
    integer, intent(in) :: dimension
    logical, intent(in) :: has_cell
    integer :: now

    now = 0
    if (allocated(pairs%see)) now = size(pairs%see)
    if (pairs%n < now .or. pairs%is_cut) return
    ! While a table grows there are both the old one and the new one.
    associate (bytes => 12 + dimension - merge(0, 1, has_cell), more => room_for(pairs%n + 1, now) - now)
      pairs%is_cut = pairs%n == huge(pairs%n) - 1 .or. .not. pairs%memory%fits(int(bytes, i8)*int(more, i8) + 8_i8*int(now, i8))
    end associate
    if (pairs%is_cut) return
    call reserve(pairs%contactor, 2, pairs%n + 1)
    call reserve(pairs%image, pairs%n + 1)
    if (dimension == 3 .or. has_cell) call reserve(pairs%image_y, pairs%n + 1)
    if (dimension == 3 .and. has_cell) call reserve(pairs%image_z, pairs%n + 1)
    call reserve(pairs%see, pairs%n + 1)
  end subroutine make_room

  !> Periods along x, y, z by which the antagonist of a pair is moved.
  pure function image_of_pair(pairs, p) result(image)
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    integer, intent(in) :: p !! pair
    integer :: image(3)

    image = [int(pairs%image(p)), 0, 0]
    if (allocated(pairs%image_y)) image(2) = int(pairs%image_y(p))
    if (allocated(pairs%image_z)) image(3) = int(pairs%image_z(p))
  end function image_of_pair

  !> Shift of the antagonist of a pair [m]. It is asked for at every pair, so one without a cell is found in place.
  pure function offset_of(scene, pairs, p) result(offset)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    integer, intent(in) :: p !! pair
    real(wp) :: offset(3)

    if (scene%cell%is_on) then
      offset = image_shift(scene, image_of_pair(pairs, p))
    else
      offset(1) = scene%period*real(pairs%image(p), wp)
      offset(2:3) = 0
      if (scene%dimension == 3) offset(2) = scene%period_y*real(pairs%image_y(p), wp)
    end if
  end function offset_of

  !> Empty a list that was not made to its end: what follows, and a checkpoint, need the memory.
  subroutine give_back(pairs)
    type(neighbours_t), intent(inout) :: pairs

    pairs%n_cut = pairs%n
    pairs%n = 0
    pairs%n_near = 0
    if (allocated(pairs%contactor)) deallocate (pairs%contactor, pairs%image, pairs%see)
    if (allocated(pairs%image_y)) deallocate (pairs%image_y)
    if (allocated(pairs%image_z)) deallocate (pairs%image_z)
    allocate (pairs%contactor(2, 0), pairs%image(0), pairs%see(0))
  end subroutine give_back
end module sg_neighbour_list
