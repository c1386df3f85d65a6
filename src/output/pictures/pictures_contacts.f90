!> Picture of the contacts: one line a contact from body to body, which carries the forces of the step.
!!
!! A line goes from the candidate's centre to the antagonist's, in the periodic image of the candidate; at a wall,
!! whose centre means nothing, it ends at the point of contact instead. The line of a link goes from point to point.
!! Where ranks share a scene each draws its own
!! contacts; those of lower ranks come first.
module sg_pictures_contacts
  use sg_bodies, only: bodies_t
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, has_bonds, image_of, impulse_vector, moment_vector, normal_impulse
  use sg_internal_values, only: bond_integrity
  use sg_kinds, only: wp, i4, i8
  use sg_laws, only: is_cohesive_zone
  use sg_link_contacts, only: is_link, tension
  use sg_link_laws, only: pulls_only
  use sg_pictures_grid, only: grid_file_t, on_cells, on_field, vtk_empty, vtk_line
  use sg_run_options, only: run_options_t
  use sg_scene, only: image_shift, scene_t
  use sg_xdmf, only: xdmf_t
  implicit none
  private
  public :: contacts_picture_t

  !> The file `contacts.vtkhdf` and its sidecar
  type :: contacts_picture_t
    !> The file
    type(grid_file_t) :: grid
    !> Its sidecar `contacts.xmf`
    type(xdmf_t) :: xdmf
    !> Time step, by which impulses become forces [s]
    real(wp) :: time_step = 1
  contains
    procedure :: open => contacts_open
    procedure :: write => contacts_write
  end type contacts_picture_t

contains

  !> Make the file, or go on with it.
  subroutine contacts_open(self, options, resumed_step, comm)
    class(contacts_picture_t), intent(inout) :: self
    type(run_options_t), intent(in) :: options !! folder, precision and time step
    integer, intent(in) :: resumed_step !! step of the checkpoint; negative for a new run
    type(comm_t), intent(inout) :: comm !! ranks that share the scene

    self%time_step = options%substep_length()
    call self%grid%open(options%folder//'/contacts.vtkhdf', options, resumed_step, comm)
    if (allocated(self%grid%file%error)) return
    call self%xdmf%open(options%folder//'/contacts.xmf', 'contacts.vtkhdf', 'Polyline', self%grid%n_steps, comm%rank == 0)
  end subroutine contacts_open

  !> Add a step.
  subroutine contacts_write(self, scene, contacts, time, step)
    class(contacts_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! bodies that touch
    type(contacts_t), intent(in) :: contacts !! contacts of the step just done
    real(wp), intent(in) :: time !! [s]
    integer, intent(in) :: step !! number of the step
    integer :: i, n
    integer(i8) :: before, total, no_ids(0)
    real(wp), allocatable :: points(:, :)

    n = contacts%n
    call self%grid%file%ranks%before(int(n, i8), before, total)
    call self%grid%put(on_field, 'ncontacts', [int(total, i4)])
    allocate (points(3, 2*n), source=0.0_wp)
    if (total > 0) then
      call self%grid%part(2*n, [(2*before + int(i, i8), i=0, 2*n - 1)], spread(2_i4, 1, n), spread(vtk_line, 1, n))
      do i = 1, n
        points(1:scene%dimension, 2*i - 1:2*i) = ends(scene, contacts, i)
      end do
      call self%grid%place(points)
      if (n > 0) call write_arrays(self, scene, contacts)
      if (n == 0) call write_zeros(self, scene, 0, contacts)
    else
      ! VTK 9.5 and 9.6 misread a step without cells: one cell of type "empty" draws nothing.
      i = merge(1, 0, self%grid%file%ranks%rank == 0)
      call self%grid%part(0, no_ids, spread(0_i4, 1, i), spread(vtk_empty, 1, i))
      call self%grid%place(points)
      call write_zeros(self, scene, i, contacts)
    end if
    call self%grid%finish(time, step)
    call self%xdmf%add(self%grid, time)
  end subroutine contacts_write

  !> Numbers of all contacts.
  subroutine write_arrays(self, scene, contacts)
    type(contacts_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp) :: vectors(3, contacts%n)
    integer :: i, n, d

    n = contacts%n
    d = scene%dimension
    call write_forces(self, contacts, d)
    if (contacts%n_moments > 0) call write_moments(self, contacts)
    if (scene%links%n > 0) then
      call self%grid%put(on_cells, 'tension', tensions(scene, contacts, self%time_step))
      call self%grid%put(on_cells, 'link', links_of(scene, contacts))
    end if
    call self%grid%put(on_cells, 'gap', contacts%gap(:n))
    vectors = 0
    vectors(1:d, :) = contacts%normal(:, :n)
    call self%grid%put(on_cells, 'normal', vectors)
    do i = 1, n
      vectors(1:d, i) = contacts%point(:, i) + jump(scene, contacts%body(1, i))
    end do
    call self%grid%put(on_cells, 'point', vectors)
    call self%grid%put(on_cells, 'status', int(contacts%status(:n), i4))
    call self%grid%put(on_cells, 'law', contacts%law(:n))
    if (has_bonds(contacts)) call self%grid%put(on_cells, 'damage', damage_of(scene, contacts))
    call self%grid%put(on_cells, 'candidate', numbers_of(scene%bodies, contacts%body(1, :n)))
    call self%grid%put(on_cells, 'antagonist', numbers_of(scene%bodies, contacts%body(2, :n)))
  end subroutine write_arrays

  !> Damage of all contacts: 0 where the bond of a cohesive zone is whole, 1 where it is broken or was never there, -1 under other
  !! laws.
  pure function damage_of(scene, contacts) result(damage)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp) :: damage(contacts%n)
    integer :: k

    damage = -1
    do k = 1, contacts%n
      if (is_cohesive_zone(scene%laws(contacts%law(k)))) damage(k) = 1 - contacts%internal(bond_integrity, k)
    end do
  end function damage_of

  !> Forces of all contacts; in space the tangential one has no sign, but there is the whole vector.
  subroutine write_forces(self, contacts, dimension)
    type(contacts_picture_t), intent(inout) :: self
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: dimension
    real(wp) :: normal(contacts%n), tangential(contacts%n), vectors(3, contacts%n)
    integer :: i, n

    n = contacts%n
    tangential = 0
    do i = 1, n
      normal(i) = normal_impulse(contacts, i)/self%time_step
      if (dimension == 2) cycle
      vectors(:, i) = impulse_vector(contacts, i)/self%time_step
      if (contacts%n_components == 3) tangential(i) = norm2(vectors(:, i) - normal(i)*contacts%normal(:, i))
    end do
    if (contacts%n_components == 2) tangential = contacts%impulse(2, :n)/self%time_step
    call self%grid%put(on_cells, 'force_normal', normal)
    call self%grid%put(on_cells, 'force_tangential', tangential)
    if (dimension == 3) call self%grid%put(on_cells, 'force', vectors)
  end subroutine write_forces

  !> Moments of all contacts [N m]: of rolling, in space without a sign, and of twisting about the normal.
  subroutine write_moments(self, contacts)
    type(contacts_picture_t), intent(inout) :: self
    type(contacts_t), intent(in) :: contacts
    real(wp) :: rolling(contacts%n), twisting(contacts%n), moment(3)
    integer :: k

    do k = 1, contacts%n
      moment = moment_vector(contacts, k)/self%time_step
      rolling(k) = moment(3)
      if (contacts%n_moments == 1) cycle
      twisting(k) = dot_product(moment, contacts%normal(:, k))
      rolling(k) = norm2(moment - twisting(k)*contacts%normal(:, k))
    end do
    call self%grid%put(on_cells, 'rolling_moment', rolling)
    if (contacts%n_moments == 3) call self%grid%put(on_cells, 'twisting_moment', twisting)
  end subroutine write_moments

  !> Number of the link that each contact is, 0 for contacts between shapes.
  pure function links_of(scene, contacts) result(link)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer(i4) :: link(contacts%n)
    integer :: k

    link = 0
    do k = 1, contacts%n
      if (is_link(scene, contacts, k)) link(k) = contacts%feature(k)
    end do
  end function links_of

  !> Tensions of all links [N], zero for contacts between shapes.
  pure function tensions(scene, contacts, time_step)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: time_step
    real(wp) :: tensions(contacts%n)
    integer :: k

    tensions = 0
    do k = 1, contacts%n
      if (is_link(scene, contacts, k)) tensions(k) = tension(scene, contacts, k)/time_step
    end do
  end function tensions

  !> Numbers of the cell that stands for no contact, or nothing of a rank without contacts where others have some.
  subroutine write_zeros(self, scene, rows, contacts)
    type(contacts_picture_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: rows
    type(contacts_t), intent(in) :: contacts
    real(wp) :: vector(3, rows)
    integer(i4) :: zero(rows)

    vector = 0
    zero = 0
    call self%grid%put(on_cells, 'force_normal', vector(1, :))
    call self%grid%put(on_cells, 'force_tangential', vector(1, :))
    if (scene%dimension == 3) call self%grid%put(on_cells, 'force', vector)
    if (contacts%n_moments > 0) call self%grid%put(on_cells, 'rolling_moment', vector(1, :))
    if (contacts%n_moments == 3) call self%grid%put(on_cells, 'twisting_moment', vector(1, :))
    if (scene%links%n > 0) then
      call self%grid%put(on_cells, 'tension', vector(1, :))
      call self%grid%put(on_cells, 'link', zero)
    end if
    call self%grid%put(on_cells, 'gap', vector(1, :))
    call self%grid%put(on_cells, 'normal', vector)
    call self%grid%put(on_cells, 'point', vector)
    call self%grid%put(on_cells, 'status', zero)
    call self%grid%put(on_cells, 'law', zero)
    if (has_bonds(contacts)) call self%grid%put(on_cells, 'damage', vector(1, :))
    call self%grid%put(on_cells, 'candidate', zero)
    call self%grid%put(on_cells, 'antagonist', zero)
  end subroutine write_zeros

  !> Numbers of bodies in the whole scene.
  pure function numbers_of(bodies, body) result(number)
    type(bodies_t), intent(in) :: bodies
    integer(i4), intent(in) :: body(:)
    integer(i4), allocatable :: number(:)

    number = body
    if (allocated(bodies%id)) number = bodies%id(body)
  end function numbers_of

  !> The two ends of a contact's line [m]: at the candidate and at the antagonist, shape (dimension, 2).
  pure function ends(scene, contacts, i)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: i
    real(wp) :: ends(scene%dimension, 2), here(scene%dimension), image(scene%dimension), half(scene%dimension), shift(3)
    integer :: candidate, antagonist

    candidate = contacts%body(1, i)
    antagonist = contacts%body(2, i)
    here = jump(scene, candidate)
    image = 0
    image(1) = real(contacts%image(i), wp)*scene%period
    if (scene%dimension == 3) image(2) = real(contacts%image_y(i), wp)*scene%period_y
    if (scene%cell%is_on) then
      shift = image_shift(scene, image_of(contacts, i))
      image = shift(:scene%dimension)
    end if
    ends(:, 1) = scene%bodies%position(:, candidate)
    ends(:, 2) = scene%bodies%position(:, antagonist) + (image + here - jump(scene, antagonist))
    if (is_link(scene, contacts, i)) then
      half = contacts%gap(i)/2*contacts%normal(:, i)
      if (pulls_only(scene%laws(contacts%law(i)))) half = -half
      ends(:, 1) = contacts%point(:, i) + here + half
      ends(:, 2) = contacts%point(:, i) + here - half
    else if (.not. scene%bodies%is_grain(antagonist)) then
      ends(:, 2) = contacts%point(:, i) + here
    else if (.not. scene%bodies%is_grain(candidate)) then
      ends(:, 1) = contacts%point(:, i) + here
    end if
  end function ends

  !> Way by which periods moved a body's stored position between the detection of contacts and the end of the step [m].
  pure function jump(scene, body)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body
    real(wp) :: jump(scene%dimension)

    jump = 0
    if (scene%cell%is_on) return
    associate (way => scene%bodies%position(:, body) - scene%bodies%middle(:scene%dimension, body))
      if (scene%period > 0) jump(1) = real(nint(way(1)/scene%period), wp)*scene%period
      if (scene%period_y > 0) jump(2) = real(nint(way(2)/scene%period_y), wp)*scene%period_y
    end associate
  end function jump
end module sg_pictures_contacts
