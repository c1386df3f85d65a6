!> Bodies of space (RBDY3) in a DATBOX: contactors, mass, and the frame in which LMGC90 turns them.
!!
!! LMGC90 puts a body's centre at that of its volume, wherever the node is, and its axes along the principal ones of its
!! inertia: those of DOF.INI are these. So must ours be, and in the same order (`inertia_frame`).
module sg_datbox_space_bodies
  use sg_contactors, only: add_point, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_point
  use sg_datbox_blocks, only: block_t, complain_block, read_point, read_size, read_triple, triple
  use sg_datbox_lines, only: complain, complain_once, datbox_file_t, go_to, name_field, next_line, remark, step_back
  use sg_datbox_polyhedra, only: read_polyhedron
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, pi
  use sg_polyhedron_moments, only: composed_solid, cylinder_solid, moved_solid, solid_t, sphere_solid
  use sg_rotations, only: frame_of, nearest_rotation, no_rotation
  use sg_scene, only: colour_index, scene_t
  use sg_solid_bodies, only: move_body_frame, set_inertia, solid_of_shapes
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_sphere
  use sg_symmetric, only: principal_axes
  use sg_text, only: to_text
  use sg_vectors, only: cross
  implicit none
  private
  public :: read_solid_contactor, complete_solid_body, read_frame, solid_of_datbox

  !> Difference from a rotation that eight digits leave [1]
  real(wp), parameter :: frame_slack = 1e-5_wp

contains

  !> Read one contactor with its further lines.
  subroutine read_solid_contactor(file, scene, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file at the contactor's line
    type(scene_t), intent(inout) :: scene !! gets the contactor and its colour
    type(block_t), intent(inout) :: block !! the body's block
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=:), allocatable :: type
    real(wp) :: sizes(3), shift(3)
    integer :: colour, i, n_sizes
    logical :: ok

    call colour_index(scene, name_field(file, 23), colour)
    ok = .true.
    shift = 0
    block%frame = frame_of(no_rotation)
    type = name_field(file, 2)
    n_sizes = 0
    if (any(type == ['SPHER', 'SPHEb'])) n_sizes = 1
    if (any(type == ['CYLND', 'DNLYC'])) n_sizes = 2
    if (type == 'PLANx') n_sizes = 3
    do i = 1, n_sizes
      call read_size(file, triple(i), sizes(i), .true., ok, diagnostics)
    end do
    if (type == 'SPHEb') call read_point(file, 'the centre of a shifted sphere', shift, ok, diagnostics)
    if (any(type == ['PLANx', 'CYLND'])) call read_local_frame(file, block%frame, shift, ok, diagnostics)
    if (any(type == ['POLYR', 'POLYF'])) then
      call read_polyhedron(file, scene%contactors, block%body, colour, type == 'POLYF', ok, diagnostics)
    else if (type == 'PT3Dx') then
      call read_triple(file, shift, ok, diagnostics)
    else if (n_sizes == 0) then
      call complain_once(file, type, 'contactors of type '''//type &
                         //''' are not done: only SPHER, SPHEb, PLANx, CYLND, DNLYC, POLYR, POLYF and PT3Dx', 2, diagnostics)
      ok = .false.
    end if
    block%ok = block%ok .and. ok
    if (.not. ok) return
    select case (type)
    case ('PT3Dx')
      call add_point(scene%contactors, block%body, colour, shift)
    case ('SPHER', 'SPHEb')
      call add_sphere(scene%contactors, block%body, colour, sizes(1), shift)
    case ('PLANx')
      call add_plane(scene%contactors, block%body, colour, sizes, shift, block%frame, has_rim=.true.)
    case ('CYLND')
      call add_cylinder(scene%contactors, block%body, colour, sizes(1), sizes(2), shift, block%frame(:, 3))
    case ('DNLYC')
      call add_hollow_cylinder(scene%contactors, block%body, colour, sizes(1), sizes(2), shift, block%frame(:, 3))
    end select
  end subroutine read_solid_contactor

  !> Read the frame of a plane or cylinder and its shift, where the word `localframe` announces them.
  subroutine read_local_frame(file, frame, shift, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    real(wp), intent(inout) :: frame(3, 3), shift(3)
    logical, intent(inout) :: ok
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. next_line(file)) return
    if (name_field(file, 30, 10) /= 'localframe') then
      call step_back(file)
      return
    end if
    call read_frame(file, frame, ok, diagnostics)
    if (ok) call read_point(file, 'the centre of a contactor', shift, ok, diagnostics)
  end subroutine read_local_frame

  !> Read three lines that hold the axes of a frame, given to eight digits, and take the nearest rotation.
  subroutine read_frame(file, frame, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file before the first axis
    real(wp), intent(out) :: frame(3, 3) !! columns: the axes
    logical, intent(inout) :: ok !! turned false when they are wrong
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(error_t), allocatable :: error
    real(wp) :: axes(3, 3), distance
    integer :: i
    logical :: good

    frame = frame_of(no_rotation)
    good = .true.
    do i = 1, 3
      call read_point(file, 'an axis of a frame', axes(:, i), good, diagnostics)
      if (.not. good) exit
    end do
    ok = ok .and. good
    if (.not. good) return
    call nearest_rotation(axes, frame, distance, error)
    if (allocated(error)) then
      call complain(file, error%message, triple(1), diagnostics)
    else if (distance > frame_slack) then
      call complain(file, 'the axes of the frame are not orthonormal: they miss it by '//to_text(distance, 2), triple(1), &
                    diagnostics)
    else
      return
    end if
    ok = .false.
  end subroutine read_frame

  !> Turn a block into a body of the scene: mass, centre, frame.
  subroutine complete_solid_body(file, scene, block, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! BODIES.DAT
    type(scene_t), intent(inout) :: scene !! gets the body
    type(block_t), intent(in) :: block !! the body's block
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(solid_t) :: solid, filled
    real(wp) :: axes(3, 3), moments(3), volume
    integer :: b, first, last, k

    b = block%body
    first = block%before + 1
    last = scene%contactors%n
    solid = solid_of_datbox(scene, first, last)
    if (is_point(scene, first, last)) solid = ball_about(scene%contactors%shift(:, first), block%mass_radius)
    filled = solid_of_shapes(scene%contactors, first, last)
    call inertia_frame(scene, block, solid, axes)
    do k = 1, 3
      moments(k) = dot_product(axes(:, k), matmul(solid%inertia, axes(:, k)))
    end do
    if (block%moments(1) > 0) then
      call check_given_frame(file, block, solid, filled, diagnostics)
      moments = block%moments
    end if
    volume = solid%volume
    if (block%mass_radius > 0) call weigh_by_radius(file, block, first == last, volume, diagnostics)
    scene%bodies%position(:, b) = block%node
    call move_body_frame(scene%bodies, scene%contactors, b, first, last, solid%centre, axes)
    scene%bodies%area(b) = filled%volume
    scene%bodies%material(b) = block%material
    associate (density => scene%materials(block%material)%density)
      if (density*min(volume, minval(moments)) > tiny(1.0_wp)) then
        call set_inertia(scene%bodies, b, density*volume, density*moments)
      else if (.not. block%is_held) then
        call complain_block(file, block, 'has no mass', diagnostics)
      end if
    end associate
  end subroutine complete_solid_body

  !> Is a point all that a body has?
  pure logical function is_point(scene, first, last)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: first, last

    is_point = first == last
    if (is_point) is_point = scene%contactors%kind(first) == kind_point
  end function is_point

  !> The ball as which LMGC90 takes a body that is a point: of the radius of mass, of one metre where that is zero.
  pure type(solid_t) function ball_about(centre, radius) result(solid)
    real(wp), intent(in) :: centre(3), radius

    solid = moved_solid(sphere_solid(merge(radius, 1.0_wp, radius > 0)), centre, frame_of(no_rotation))
  end function ball_about

  !> The volume that weighs, from the radius of mass: of a body with one contactor that of the ball of this radius; of others
  !! LMGC90 does not look at it.
  subroutine weigh_by_radius(file, block, is_alone, volume, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(block_t), intent(in) :: block
    logical, intent(in) :: is_alone
    real(wp), intent(inout) :: volume
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: ball
    integer :: at

    ball = 4*pi/3*block%mass_radius**3
    if (is_alone) then
      volume = ball
    else if (abs(ball - volume) > 1e-3_wp*volume) then
      at = file%at
      call go_to(file, block%line)
      call remark(file, 'avrd', 'body '//to_text(block%number)//' has several contactors: it weighs as much as these, avrd is ' &
                  //'not looked at, as in LMGC90', 0, diagnostics)
      call go_to(file, at)
    end if
  end subroutine weigh_by_radius

  !> Volume, centre and inertia as LMGC90 takes them: a cylinder without its round caps, a hollow one filled.
  function solid_of_datbox(scene, first, last) result(whole)
    type(scene_t), intent(in) :: scene !! scene with its contactors
    integer, intent(in) :: first !! first contactor of a body
    integer, intent(in) :: last !! its last contactor
    type(solid_t) :: whole
    type(solid_t), allocatable :: solids(:)
    integer :: c, row

    allocate (solids(last - first + 1))
    do c = first, last
      row = scene%contactors%row(c)
      associate (solid => solids(c - first + 1), space => scene%contactors%space)
        select case (scene%contactors%kind(c))
        case (kind_cylinder)
          solid = about(cylinder_solid(space%cylinder_size(1, row), space%cylinder_size(2, row)), space%cylinder_axis(:, row))
        case (kind_hollow_cylinder)
          solid = about(cylinder_solid(space%hollow_size(1, row), space%hollow_size(2, row)), space%hollow_axis(:, row))
        case default
          solid = solid_of_shapes(scene%contactors, c, c)
        end select
      end associate
    end do
    whole = composed_solid(solids)
  contains
    !> A solid of revolution about z, with its axis turned and its centre at the contactor's.
    type(solid_t) function about(upright, axis) result(solid)
      type(solid_t), intent(in) :: upright
      real(wp), intent(in) :: axis(3)
      integer :: k

      solid = moved_solid(upright, scene%contactors%shift(:, c), frame_of(no_rotation))
      solid%inertia = 0
      do k = 1, 3
        solid%inertia(k, k) = upright%inertia(1, 1)
        solid%inertia(:, k) = solid%inertia(:, k) + (upright%inertia(3, 3) - upright%inertia(1, 1))*axis*axis(k)
      end do
    end function about
  end function solid_of_datbox

  !> The frame that LMGC90 gives a body before DOF.INI turns it.
  !!
  !! That of the shape where a body has one alone; else the axes of the file where its inertia is diagonal in them, or where
  !! its moments are given; else the principal ones by rising moment, whose signs are LMGC90's own secret.
  subroutine inertia_frame(scene, block, solid, axes)
    type(scene_t), intent(in) :: scene
    type(block_t), intent(in) :: block
    type(solid_t), intent(in) :: solid
    real(wp), intent(out) :: axes(3, 3)
    real(wp) :: values(3), found(3, 3)
    integer :: low, high

    axes = frame_of(no_rotation)
    if (block%moments(1) > 0) return
    if (scene%contactors%n == block%before + 1) then
      axes = block%frame
      if (any(scene%contactors%kind(block%before + 1) == [kind_plane, kind_cylinder])) return
    end if
    if (is_diagonal(solid%inertia)) return
    call principal_axes(solid%inertia, values, found)
    low = minloc(values, 1)
    high = maxloc(values, 1)
    if (low == high) return
    axes(:, 1) = found(:, low)
    axes(:, 2) = found(:, 6 - low - high)
    axes(:, 3) = cross(axes(:, 1), axes(:, 2))
  end subroutine inertia_frame

  !> Is a tensor diagonal, up to what LMGC90 takes for zero?
  pure logical function is_diagonal(inertia)
    real(wp), intent(in) :: inertia(3, 3)
    real(wp) :: slack
    integer :: i, k

    is_diagonal = .true.
    do i = 1, 3
      ! LMGC90 asks for 1e-14 of a moment; a sum made in another order differs by more.
      slack = max(1e-12_wp*abs(inertia(i, i)), merge(0.0_wp, 1e-17_wp, abs(inertia(i, i)) > 1e-10_wp))
      do k = 1, 3
        if (k /= i) is_diagonal = is_diagonal .and. abs(inertia(i, k)) < slack
      end do
    end do
  end function is_diagonal

  !> Given moments mean that the shapes are given along the principal axes: warn where they are not, with round caps or without.
  subroutine check_given_frame(file, block, solid, filled, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    type(block_t), intent(in) :: block
    type(solid_t), intent(in) :: solid, filled
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: at

    if (min(off_axes(solid%inertia), off_axes(filled%inertia)) <= 1e-4_wp) return
    at = file%at
    call go_to(file, block%line)
    call remark(file, 'given moments', 'body '//to_text(block%number)//' gives its principal moments, but its shapes are ' &
                     //'not given along their principal axes', 0, diagnostics)
    call go_to(file, at)
  contains
    !> Largest entry off the diagonal, as a share of the largest entry; zero of no body.
    pure real(wp) function off_axes(inertia)
      real(wp), intent(in) :: inertia(3, 3)

      off_axes = max(abs(inertia(1, 2)), abs(inertia(1, 3)), abs(inertia(2, 3)))/max(maxval(abs(inertia)), tiny(1.0_wp))
    end function off_axes
  end subroutine check_given_frame
end module sg_datbox_space_bodies
