!> Masonry: walls of bricks in running bond and arches of voussoirs, as convex polyhedra.
module sg_masonry
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, i4
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces
  use sg_polyhedron_make, only: box_polyhedron, centre_polyhedron
  use sg_rotations, only: frame_of, rotation_by
  use sg_scene, only: colour_index, scene_t
  use sg_share, only: share_t
  use sg_space_contactors, only: add_polyhedron
  use sg_text, only: to_text
  use sg_weights_from_deck, only: weigh_body
  implicit none
  private
  public :: bricks_of_wall, name_of_brick, add_brick_wall, add_arch

  !> Faces of a box whose vertices are numbered along x, then y, then z
  integer(i4), parameter :: face_first(7) = [1_i4, 5_i4, 9_i4, 13_i4, 17_i4, 21_i4, 25_i4]
  integer(i4), parameter :: face_vertex(24) = [1_i4, 3_i4, 4_i4, 2_i4, 5_i4, 6_i4, 8_i4, 7_i4, 1_i4, 2_i4, 6_i4, 5_i4, &
                                               3_i4, 7_i4, 8_i4, 4_i4, 1_i4, 5_i4, 7_i4, 3_i4, 2_i4, 4_i4, 8_i4, 6_i4]

contains

  !> Number of bricks of a wall: every second row has one more.
  integer function bricks_of_wall(deck, b) result(n)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the wall
    integer :: rows

    rows = deck%integer(b, 'rows')
    n = rows*deck%integer(b, 'columns') + rows/2
  end function bricks_of_wall

  !> What a brick of a wall is called, by row and column.
  function name_of_brick(deck, b, brick) result(name)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the wall
    integer, intent(in) :: brick !! brick of the wall, in the order in which they are made
    character(len=:), allocatable :: name
    integer :: columns, row, column

    columns = deck%integer(b, 'columns')
    ! Two rows have twice the columns and one more.
    row = 2*((brick - 1)/(2*columns + 1)) + 1
    column = modulo(brick - 1, 2*columns + 1) + 1
    if (column > columns) then
      row = row + 1
      column = column - columns
    end if
    name = deck%word(b, 'name')//'.'//to_text(row)//'.'//to_text(column)
  end function name_of_brick

  !> The bricks of a [[brick_wall]] block.
  subroutine add_brick_wall(deck, b, material, scene, share, n, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the wall
    integer(i4), intent(in) :: material !! of the bricks
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    type(share_t), intent(inout) :: share !! what this rank keeps of them
    integer, intent(inout) :: n !! bodies kept so far
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(polyhedron_t) :: whole, half
    type(error_t), allocatable :: error
    real(wp) :: size_of(3), joint, begin, length, centre(3)
    integer :: row, column, columns
    logical :: is_half

    size_of = deck%vector(b, 'brick')
    joint = deck%number(b, 'joint')
    if (2*joint >= size_of(1)) then
      call deck%complain(diagnostics, 'the joint leaves nothing of half a brick', b, 'joint')
      return
    end if
    call box_polyhedron(size_of/2, whole, error)
    if (.not. allocated(error)) call box_polyhedron([(size_of(1) - joint)/4, size_of(2:)/2], half, error)
    if (allocated(error)) then
      call deck%complain(diagnostics, error%message, b, 'brick')
      return
    end if
    do row = 1, deck%integer(b, 'rows')
      columns = deck%integer(b, 'columns') + merge(1, 0, mod(row, 2) == 0)
      begin = 0
      do column = 1, columns
        is_half = mod(row, 2) == 0 .and. (column == 1 .or. column == columns)
        length = merge((size_of(1) - joint)/2, size_of(1), is_half)
        centre = [begin + length/2, 0.0_wp, (real(row, wp) - 0.5_wp)*size_of(3)]
        scene%bodies%material(n + 1) = material
        if (is_half) then
          call add_stone(deck, b, scene, n + 1, half, centre, 'position')
        else
          call add_stone(deck, b, scene, n + 1, whole, centre, 'position')
        end if
        call share%settle(scene, n)
        begin = begin + length + joint
      end do
    end do
  end subroutine add_brick_wall

  !> Add a body of one polyhedron, given about its centre of mass; what the block draws along x lies along its angle.
  subroutine add_stone(deck, b, scene, n, shape, centre, origin)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(scene_t), intent(inout) :: scene
    type(polyhedron_t), intent(in) :: shape
    real(wp), intent(in) :: centre(3)
    character(len=*), intent(in) :: origin
    real(wp) :: q(4)
    integer :: colour

    call colour_index(scene, deck%word(b, 'colour'), colour)
    q = rotation_by([0.0_wp, 0.0_wp, deck%number(b, 'angle')])
    scene%bodies%position(:, n) = deck%vector(b, origin) + matmul(frame_of(q), centre)
    scene%bodies%orientation(:, n) = q
    call add_polyhedron(scene%contactors, n, colour, shape, [0.0_wp, 0.0_wp, 0.0_wp])
    call weigh_body(scene, n, scene%contactors%n)
  end subroutine add_stone

  !> The voussoirs of an [[arch]] block.
  subroutine add_arch(deck, b, material, scene, share, n, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the arch
    integer(i4), intent(in) :: material !! of the voussoirs
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    type(share_t), intent(inout) :: share !! what this rank keeps of them
    integer, intent(inout) :: n !! bodies kept so far
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: radii(2), half, opening, from, to, centre(3), vertices(3, 8)
    integer :: i, k, count

    radii = [deck%number(b, 'inner_radius'), deck%number(b, 'outer_radius')]
    if (radii(2) <= radii(1)) then
      call deck%complain(diagnostics, 'the outer radius must be larger than the inner one', b, 'outer_radius')
      return
    end if
    half = deck%number(b, 'depth')/2
    opening = deck%number(b, 'opening')
    count = deck%integer(b, 'voussoirs')
    do i = 1, count
      ! Angles from the springing line on the side where the arch begins, up and over.
      from = opening*(0.5_wp - real(i - 1, wp)/real(count, wp))
      to = opening*(0.5_wp - real(i, wp)/real(count, wp))
      do k = 1, 2
        vertices(:, 2*k - 1) = [-radii(k)*sin(from), -half, radii(k)*cos(from)]
        vertices(:, 2*k) = [-radii(k)*sin(to), -half, radii(k)*cos(to)]
      end do
      vertices(:, 5:8) = vertices(:, 1:4)
      vertices(2, 5:8) = half
      call polyhedron_from_faces(vertices, face_first, face_vertex, shape, error, may_turn=.true.)
      if (allocated(error)) then
        call deck%complain(diagnostics, error%message, b)
        return
      end if
      call centre_polyhedron(shape, centre)
      scene%bodies%material(n + 1) = material
      call add_stone(deck, b, scene, n + 1, shape, centre, 'centre')
      call share%settle(scene, n)
    end do
  end subroutine add_arch
end module sg_masonry
