!> The shapes of a scene that ranks share, in pieces: each rank draws a block of all points and a block of all cells.
!!
!! Points, cells and corners are numbered as one rank would write them, contactor by contactor. Shapes never change, so
!! they come once to the ranks that draw them; at each picture only the motion of their bodies follows.
module sg_pictures_pieces
  use sg_block_distribution, only: block_distribution_t, wanted_t
  use sg_bodies, only: bodies_t, make_bodies_like
  use sg_comm, only: comm_t
  use sg_contactors, only: contactors_t
  use sg_field_visitor, only: sync_on_copy
  use sg_kinds, only: wp, i4, i8
  use sg_pictures_mesh, only: mesh_t, xdmf_topology
  use sg_scene, only: scene_t
  implicit none
  private
  public :: pieces_t

  !> What one rank draws, and whose it is
  type :: pieces_t
    !> Contactors drawn, at least in part: kind, body (among those below), colour and number; no sizes
    type(contactors_t) :: contactors
    !> Their bodies: state, material and number
    type(bodies_t) :: bodies
    !> Cells as XDMF takes them: the block of this rank
    integer(i4), allocatable :: topology(:)
    !> How the motion of these bodies is learnt
    type(wanted_t), private :: wanted
  contains
    procedure :: plan => pieces_plan
    procedure :: move => pieces_move
  end type pieces_t

  !> Rows of what is known of each contactor: points, cells and corners; number of its body, colour and kind
  integer, parameter :: n_sizes = 3, n_facts = 6

contains

  !> Bring all shapes to the ranks that draw them.
  subroutine pieces_plan(self, scene, is_mine, body_rows, mesh, comm)
    class(pieces_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene of this rank
    logical, intent(in) :: is_mine(:) !! is each contactor on a body of this rank?
    type(block_distribution_t), intent(in) :: body_rows !! the blocks of bodies
    type(mesh_t), intent(inout) :: mesh !! shapes of the contactors of own bodies; afterwards what this rank draws
    type(comm_t), intent(inout) :: comm !! the ranks
    type(block_distribution_t) :: rows
    type(wanted_t) :: drawn
    real(wp), allocatable :: block(:, :), starts(:, :), facts(:, :)
    integer(i4), allocatable :: mine(:), number(:)
    integer(i8) :: start(n_sizes, scene%contactors%n)
    integer :: c, n

    n = scene%contactors%n
    mine = pack([(int(c, i4), c=1, n)], is_mine)
    number = [(int(c, i4), c=1, n)]
    if (allocated(scene%contactors%id)) number = scene%contactors%id(:n)
    call rows%plan(comm, number(mine), total_of(comm, size(mine)))
    facts = facts_of(scene, mesh)
    call rows%order(comm, facts(:, mine), block)
    call rows%back(comm, starts_of(comm, block), starts)
    start = 0
    start(:, mine) = nint(starts, i8)
    call spread_mesh(comm, start, number, mesh, self%topology)
    call drawn%plan(comm, rows, [mesh%shape_of_point, mesh%shape_of_cell])
    mesh%shape_of_point = int(drawn%place(mesh%shape_of_point), i4)
    mesh%shape_of_cell = int(drawn%place(mesh%shape_of_cell), i4)
    call drawn%fetch(comm, block(n_sizes + 1:, :), facts)
    call self%wanted%plan(comm, body_rows, nint(facts(1, :), i4))
    self%contactors%n = size(drawn%number)
    self%contactors%id = drawn%number
    self%contactors%body = int(self%wanted%place(nint(facts(1, :), i4)), i4)
    self%contactors%colour = nint(facts(2, :), i4)
    self%contactors%kind = nint(facts(3, :), i4)
    call make_bodies_like(scene%bodies, size(self%wanted%number), self%bodies)
    self%bodies%id = self%wanted%number
  end subroutine pieces_plan

  !> Sum of a number over all ranks.
  integer function total_of(comm, n) result(total)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: n

    total = n
    call comm%sum(total)
  end function total_of

  !> What is known of each contactor of this rank's scene, a column a contactor.
  pure function facts_of(scene, mesh) result(facts)
    type(scene_t), intent(in) :: scene
    type(mesh_t), intent(in) :: mesh
    real(wp), allocatable :: facts(:, :)
    integer :: i, n

    n = scene%contactors%n
    allocate (facts(n_facts, n), source=0.0_wp)
    do i = 1, mesh%n_points
      associate (c => mesh%shape_of_point(i))
        facts(1, c) = facts(1, c) + 1
      end associate
    end do
    do i = 1, mesh%n_cells
      associate (c => mesh%shape_of_cell(i))
        facts(2:3, c) = facts(2:3, c) + [1.0_wp, real(mesh%size_of_cell(i), wp)]
      end associate
    end do
    facts(4, :) = real(scene%contactors%body(:n), wp)
    if (allocated(scene%bodies%id)) facts(4, :) = real(scene%bodies%id(scene%contactors%body(:n)), wp)
    facts(5, :) = real(scene%contactors%colour(:n), wp)
    facts(6, :) = real(scene%contactors%kind(:n), wp)
  end function facts_of

  !> Points, cells and corners of all ranks before those of each contactor of a block.
  function starts_of(comm, block) result(starts)
    type(comm_t), intent(inout) :: comm
    real(wp), intent(in) :: block(:, :)
    real(wp), allocatable :: starts(:, :)
    integer(i8) :: before(n_sizes), total
    integer :: c, k

    allocate (starts(n_sizes, size(block, 2)))
    do k = 1, n_sizes
      call comm%before(sum(nint(block(k, :), i8)), before(k), total)
    end do
    do c = 1, size(block, 2)
      starts(:, c) = real(before, wp)
      before = before + nint(block(:n_sizes, c), i8)
    end do
  end function starts_of

  !> Bring the shapes of this rank's own contactors to the ranks that draw them.
  subroutine spread_mesh(comm, start, number, mesh, topology)
    type(comm_t), intent(inout) :: comm
    integer(i8), intent(in) :: start(:, :) !! points, cells and corners of all ranks before those of each contactor
    integer(i4), intent(in) :: number(:) !! numbers of the contactors
    type(mesh_t), intent(inout) :: mesh
    integer(i4), allocatable, intent(out) :: topology(:)
    type(mesh_t) :: drawn
    integer(i4), allocatable :: point(:), cell(:), corner(:), entry(:)
    real(wp), allocatable :: values(:, :)

    if (mesh%n_points == 0) call make_empty(mesh)
    call number_parts(start, mesh, point, cell, corner, entry)
    ! Corners are points by their numbers over all ranks, from 0.
    mesh%corner = point(mesh%corner(:mesh%n_corners) + 1) - 1_i4
    drawn%dimension = mesh%dimension
    associate (d => mesh%dimension, n => mesh%n_points)
      call order_all(comm, point, mesh%point(:, :n), drawn%point, drawn%n_points)
      call order_list(comm, point, mesh%radius(:n), values)
      drawn%radius = values(1, :)
      call order_list(comm, point, real(number(mesh%shape_of_point(:n)), wp), values)
      drawn%shape_of_point = nint(values(1, :), i4)
    end associate
    associate (n => mesh%n_cells)
      call order_list(comm, cell, real(number(mesh%shape_of_cell(:n)), wp), values)
      drawn%n_cells = size(values, 2)
      drawn%shape_of_cell = nint(values(1, :), i4)
      call order_list(comm, cell, real(mesh%size_of_cell(:n), wp), values)
      drawn%size_of_cell = nint(values(1, :), i4)
      call order_list(comm, cell, real(mesh%type_of_cell(:n), wp), values)
      drawn%type_of_cell = nint(values(1, :), i4)
    end associate
    call order_list(comm, corner, real(mesh%corner, wp), values)
    drawn%n_corners = size(values, 2)
    drawn%corner = nint(values(1, :), i4)
    call order_list(comm, entry, real(xdmf_topology(mesh), wp), values)
    topology = nint(values(1, :), i4)
    mesh = drawn
  end subroutine spread_mesh

  !> The mesh of a rank without shapes: nothing, where there was not even a list.
  pure subroutine make_empty(mesh)
    type(mesh_t), intent(inout) :: mesh
    integer :: dimension

    dimension = mesh%dimension
    mesh = mesh_t()
    mesh%dimension = dimension
    allocate (mesh%point(dimension, 0), mesh%shape_of_point(0), mesh%shape_of_cell(0), mesh%radius(0), mesh%corner(0), &
              mesh%size_of_cell(0), mesh%type_of_cell(0))
  end subroutine make_empty

  !> Numbers over all ranks of the points, cells and corners of a mesh, and of the entries of its topology for XDMF.
  pure subroutine number_parts(start, mesh, point, cell, corner, entry)
    integer(i8), intent(in) :: start(:, :)
    type(mesh_t), intent(in) :: mesh
    integer(i4), allocatable, intent(out) :: point(:), cell(:), corner(:), entry(:)
    integer(i8) :: so_far(n_sizes, size(start, 2))
    integer :: i, k, q, t

    so_far = start
    allocate (point(mesh%n_points), cell(mesh%n_cells), corner(mesh%n_corners), entry(mesh%n_corners + 2*mesh%n_cells))
    do i = 1, mesh%n_points
      associate (n => so_far(1, mesh%shape_of_point(i)))
        n = n + 1
        point(i) = int(n, i4)
      end associate
    end do
    q = 0
    t = 0
    do i = 1, mesh%n_cells
      associate (n => so_far(:, mesh%shape_of_cell(i)))
        n(2) = n(2) + 1
        cell(i) = int(n(2), i4)
        ! Two entries stand before the corners of each cell.
        entry(t + 1:t + 2) = int(n(3) + 2*n(2), i4) - [1_i4, 0_i4]
        t = t + 2
        do k = 1, mesh%size_of_cell(i)
          n(3) = n(3) + 1
          q = q + 1
          t = t + 1
          corner(q) = int(n(3), i4)
          entry(t) = int(n(3) + 2*n(2), i4)
        end do
      end associate
    end do
  end subroutine number_parts

  !> Bring records into blocks of numbers.
  subroutine order_all(comm, number, values, block, n)
    type(comm_t), intent(inout) :: comm
    integer(i4), intent(in) :: number(:)
    real(wp), intent(in) :: values(:, :)
    real(wp), allocatable, intent(out) :: block(:, :)
    integer, intent(out) :: n
    type(block_distribution_t) :: rows

    call rows%plan(comm, number, total_of(comm, size(number)))
    call rows%order(comm, values, block)
    n = rows%n
  end subroutine order_all

  !> Bring a list into blocks of numbers, as records of one number.
  subroutine order_list(comm, number, values, block)
    type(comm_t), intent(inout) :: comm
    integer(i4), intent(in) :: number(:)
    real(wp), intent(in) :: values(:)
    real(wp), allocatable, intent(out) :: block(:, :)
    integer :: n

    call order_all(comm, number, reshape(values, [1, size(values)]), block, n)
  end subroutine order_list

  !> Move the bodies of what this rank draws to where they are now.
  subroutine pieces_move(self, bodies, comm)
    class(pieces_t), intent(inout) :: self
    type(bodies_t), intent(in) :: bodies !! the block of bodies of this rank
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: block(:, :), values(:, :)
    integer :: i

    call bodies%pack([(int(i, i4), i=1, bodies%n)], block, sync_on_copy)
    call self%wanted%fetch(comm, block, values)
    call self%bodies%unpack([(int(i, i4), i=1, self%bodies%n)], values, sync_on_copy)
  end subroutine pieces_move
end module sg_pictures_pieces
