!> Tracked bodies: place, velocity, contact force and torque, and works of single bodies (doc/guide/tracks.md).
!!
!! In every step the impulses of the contacts of a body are summed to one impulse P and one angular impulse L about its centre of
!! mass, in the configuration of the step's detection. Over the step h they are its contact force P/h and torque L/h; with the mean
!! velocity Vm = (V0 + V)/2 of the step their work is P . Vm + L . wm, as in the energy balance (sg_energy). Each rank has its share
!! of the sums, those of its contacts; rows are added up over the ranks.
module sg_tracks
  use sg_ascending, only: distinct
  use sg_bodies, only: angle_of, bodies_t
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, impulse_vector, moment_vector
  use sg_imposed_work, only: add_held_work
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: local_body
  use sg_mapping, only: arms_of
  use sg_mapping_space, only: space_arms
  use sg_rotations, only: no_rotation, turned_back, turned_by
  use sg_scene, only: scene_t, unwrapped
  use sg_text, only: append_word, text_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: tracks_t, track_columns, own_body, place_of

  !> Values of a body that outlive a step: number, place where its tracking began (3), both works, time since the last row, and the
  !! impulses since (6)
  integer, parameter :: n_kept = 13

  !> The tracked bodies of a run; unallocated numbers where there are none
  type :: tracks_t
    !> Numbers of the bodies in the whole scene, ascending, and their names: number where the deck gives none
    integer(i4), allocatable :: number(:)
    type(text_t), allocatable :: name(:)
    !> Does the deck ask for a body, so that it has rows in tracks.csv? Index of the wall that it is, for walls.csv; 0 for none
    logical, allocatable :: is_asked(:)
    integer, allocatable :: wall(:)
    !> Where each was when its tracking began [m], and is that known?
    real(wp), allocatable :: start(:, :)
    logical, allocatable :: has_start(:)
    !> Works since the tracking began, of contacts and of what holds driven components [J]; shares of this rank
    real(wp), allocatable :: contact_work(:), drive_work(:)
    !> Impulses of the last step, and of all steps since the last row: three forces and three torques [N s, N m s], shares of this
    !! rank, shape (6, bodies); in the plane the sixth is the torque
    real(wp), allocatable :: impulse(:, :), sum(:, :)
    !> Length of the last step, and time since the last row [s]
    real(wp) :: h = 0
    real(wp), allocatable :: span(:)
    !> Contacts that carried an impulse in the last step, shares of this rank
    integer, allocatable :: contacts(:)
    !> Columns of the last row, shape (columns, bodies), the same on all ranks
    real(wp), allocatable :: value(:, :)
  contains
    procedure :: is_on => tracks_is_on
    procedure :: track => tracks_track
    procedure :: begin => tracks_begin
    procedure :: add_step => tracks_add_step
    procedure :: measure => tracks_measure
    procedure :: pack => tracks_pack
    procedure :: unpack => tracks_unpack
    procedure :: reduce => tracks_reduce
    procedure :: leave_to_first => tracks_leave_to_first
  end type tracks_t

contains

  !> Names of the columns that follow step, time and body in tracks.csv.
  pure function track_columns(dimension) result(names)
    integer, intent(in) :: dimension !! of space
    character(len=16), allocatable :: names(:)

    if (dimension == 2) then
      names = [character(len=16) :: 'x', 'y', 'angle', 'velocity_x', 'velocity_y', 'spin', 'force_x', 'force_y', 'torque', &
               'mean_force_x', 'mean_force_y', 'mean_torque', 'contact_work', 'drive_work', 'displacement', 'contacts']
    else
      names = [character(len=16) :: 'x', 'y', 'z', 'orientation_w', 'orientation_x', 'orientation_y', 'orientation_z', &
               'velocity_x', 'velocity_y', 'velocity_z', 'spin_x', 'spin_y', 'spin_z', 'force_x', 'force_y', 'force_z', &
               'torque_x', 'torque_y', 'torque_z', 'mean_force_x', 'mean_force_y', 'mean_force_z', 'mean_torque_x', &
               'mean_torque_y', 'mean_torque_z', 'contact_work', 'drive_work', 'displacement', 'contacts']
    end if
  end function track_columns

  !> Are any bodies tracked?
  pure logical function tracks_is_on(self)
    class(tracks_t), intent(in) :: self

    tracks_is_on = .false.
    if (allocated(self%number)) tracks_is_on = size(self%number) > 0
  end function tracks_is_on

  !> Track some bodies, and walls, from now on.
  subroutine tracks_track(self, number, name, wall_number, wall_name)
    class(tracks_t), intent(out) :: self
    integer(i4), intent(in) :: number(:) !! of the bodies that the deck asks for, in the whole scene, ascending
    type(text_t), intent(in) :: name(:) !! of the same bodies
    integer(i4), intent(in) :: wall_number(:) !! of the walls, ascending
    type(text_t), intent(in) :: wall_name(:) !! of the walls
    integer :: i, n, place

    self%number = distinct([number, wall_number])
    n = size(self%number)
    allocate (self%is_asked(n), self%wall(n))
    do i = 1, n
      place = findloc(number, self%number(i), 1)
      self%is_asked(i) = place > 0
      self%wall(i) = findloc(wall_number, self%number(i), 1)
      if (place > 0) then
        call append_word(self%name, name(place)%s)
      else
        call append_word(self%name, wall_name(self%wall(i))%s)
      end if
    end do
    allocate (self%contact_work(n), self%drive_work(n), self%start(3, n), self%impulse(6, n), self%sum(6, n), self%span(n), &
              source=0.0_wp)
    allocate (self%has_start(n), source=.false.)
    allocate (self%contacts(n), source=0)
  end subroutine tracks_track

  !> Note where bodies are whose tracking begins. Collective.
  subroutine tracks_begin(self, scene, comm)
    class(tracks_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene before the first step of the run, split over the ranks
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: place(:)
    integer :: t, b

    if (.not. self%is_on()) return
    allocate (place(3*size(self%number)), source=0.0_wp)
    do t = 1, size(self%number)
      b = own_body(scene%bodies, self%number(t))
      if (b > 0) place(3*t - 2:3*t) = place_of(scene, b)
    end do
    if (comm%size > 1) call comm%sum(place)
    do t = 1, size(self%number)
      if (.not. self%has_start(t)) self%start(:, t) = place(3*t - 2:3*t)
    end do
    self%has_start = .true.
  end subroutine tracks_begin

  !> Add the impulses and works of a step that is solved but not updated: `velocity` is that of its beginning, `free_velocity` of
  !! its end.
  pure subroutine tracks_add_step(self, scene, contacts, h)
    class(tracks_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the solve, before the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), allocatable :: mean(:), driven(:), impulse(:)
    integer :: t, b

    if (.not. self%is_on()) return
    call sum_impulses(self, scene, contacts)
    self%sum = self%sum + self%impulse
    self%h = h
    self%span = self%span + h
    associate (bodies => scene%bodies)
      do t = 1, size(self%number)
        b = local_body(bodies, self%number(t))
        if (b == 0) cycle
        mean = (bodies%velocity(:, b) + bodies%free_velocity(:, b))/2
        impulse = along_components(bodies, b, self%impulse(:, t))
        driven = merge(0.0_wp, mean, bodies%inverse_mass(:, b) > 0)
        self%contact_work(t) = self%contact_work(t) + dot_product(impulse, mean)
        self%drive_work(t) = self%drive_work(t) - dot_product(impulse, driven)
        if (b <= bodies%n_own) call add_held_work(bodies, b, h, driven, self%drive_work(t))
      end do
    end associate
  end subroutine tracks_add_step

  !> Impulses on the tracked bodies, of this rank's contacts.
  pure subroutine sum_impulses(self, scene, contacts)
    class(tracks_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer :: track_of(scene%bodies%n), t, b, k, side
    real(wp) :: impulse(3), arms(3, 2)

    track_of = 0
    do t = 1, size(self%number)
      b = local_body(scene%bodies, self%number(t))
      if (b > 0) track_of(b) = t
    end do
    self%impulse = 0
    self%contacts = 0
    do k = 1, contacts%n
      if (track_of(contacts%body(1, k)) + track_of(contacts%body(2, k)) == 0) cycle
      impulse = impulse_vector(contacts, k)
      if (.not. any(abs(impulse) > 0)) cycle
      arms = 0
      if (scene%dimension == 2) arms(1:2, :) = arms_of(contacts, k, scene%bodies%middle, scene%period)
      if (scene%dimension == 3) arms = space_arms(scene, contacts, k)
      do side = 1, 2
        t = track_of(contacts%body(side, k))
        if (t == 0) cycle
        self%impulse(:, t) = self%impulse(:, t) + merge(1.0_wp, -1.0_wp, side == 1) &
                             *[impulse, cross(arms(:, side), impulse) + moment_vector(contacts, k)]
        self%contacts(t) = self%contacts(t) + 1
      end do
    end do
  end subroutine sum_impulses

  !> An impulse along the velocity components of a body: in space the angular part about its principal axes.
  pure function along_components(bodies, body, impulse) result(along)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: body
    real(wp), intent(in) :: impulse(6)
    real(wp), allocatable :: along(:)

    along = impulse(:bodies%dimension)
    if (bodies%n_velocity == 3 .and. bodies%dimension == 2) along = [along, impulse(6)]
    if (bodies%n_velocity == 6) along = [along, turned_back(bodies%middle(4:7, body), impulse(4:6))]
  end function along_components

  !> Measure the columns at the end of a step; the sums of mean forces begin again. Collective: all ranks get the same values.
  subroutine tracks_measure(self, scene, comm)
    class(tracks_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the update
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: flat(:)
    integer :: t, n, m

    n = size(track_columns(scene%dimension))
    m = size(self%number)
    allocate (flat(n*m), source=0.0_wp)
    do t = 1, m
      flat((t - 1)*n + 1:t*n) = columns_of(self, scene, t, n)
    end do
    if (comm%size > 1) call comm%sum(flat)
    self%value = reshape(flat, [n, m])
    self%sum = 0
    self%span = 0
  end subroutine tracks_measure

  !> This rank's share of the columns of a body: what it is from its owner, forces and works from all ranks.
  pure function columns_of(self, scene, track, n) result(values)
    class(tracks_t), intent(in) :: self
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: track, n
    real(wp) :: values(n), forces(12), displacement
    integer :: b, i, n_state
    integer, parameter :: in_plane(6) = [1, 2, 6, 7, 8, 12]

    forces = 0
    if (self%h > 0) forces(1:6) = self%impulse(:, track)/self%h
    if (self%span(track) > 0) forces(7:12) = self%sum(:, track)/self%span(track)
    n_state = merge(6, 13, scene%dimension == 2)
    values = 0
    b = own_body(scene%bodies, self%number(track))
    displacement = 0
    if (b > 0) values(:n_state) = state_of(scene, b, n_state)
    if (b > 0) displacement = norm2(place_of(scene, b) - self%start(:, track))
    values(n_state + 1:) = [pack(forces, [(scene%dimension == 3 .or. any(in_plane == i), i=1, 12)]), self%contact_work(track), &
                            self%drive_work(track), displacement, real(self%contacts(track), wp)]
  end function columns_of

  !> Place, orientation, velocity and spin of a body, in the order of the columns.
  pure function state_of(scene, body, n) result(state)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body, n
    real(wp) :: state(n), place(3), turn(4), spin(3)

    place = place_of(scene, body)
    associate (bodies => scene%bodies)
      if (scene%dimension == 2) then
        spin = 0
        if (bodies%n_velocity == 3) spin(3) = bodies%velocity(3, body)
        state = [place(1:2), angle_of(bodies, body), bodies%velocity(1:2, body), spin(3)]
      else
        turn = no_rotation
        if (allocated(bodies%orientation)) turn = bodies%orientation(:, body)
        spin = 0
        if (bodies%n_velocity == 6) spin = turned_by(turn, bodies%velocity(4:6, body))
        state = [place, turn, bodies%velocity(1:3, body), spin]
      end if
    end associate
  end function state_of

  !> Place of a body [m], not folded into the period; in the plane the third component is zero.
  pure function place_of(scene, body) result(place)
    type(scene_t), intent(in) :: scene !! scene with the body
    integer, intent(in) :: body !! index of the body
    real(wp) :: place(3)

    place = unwrapped(scene, scene%bodies, body)
  end function place_of

  !> Index of a body that this rank owns; 0 where another one does.
  pure integer function own_body(bodies, number) result(body)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank
    integer(i4), intent(in) :: number !! number of the body in the whole scene

    body = local_body(bodies, number)
    if (body > bodies%n_own) body = 0
  end function own_body

  !> From the shares of each rank to the sums of the whole scene, for restart files. Collective.
  subroutine tracks_reduce(self, comm)
    class(tracks_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: flat(:)
    integer :: n

    if (comm%size == 1 .or. .not. self%is_on()) return
    n = size(self%number)
    flat = [self%contact_work, self%drive_work, reshape(self%sum, [6*n])]
    call comm%sum(flat)
    self%contact_work = flat(:n)
    self%drive_work = flat(n + 1:2*n)
    self%sum = reshape(flat(2*n + 1:), [6, n])
  end subroutine tracks_reduce

  !> The other way round: the first rank keeps the sums of the whole scene, and the others begin at zero.
  pure subroutine tracks_leave_to_first(self, comm)
    class(tracks_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the ranks

    if (comm%rank == 0 .or. .not. self%is_on()) return
    self%contact_work = 0
    self%drive_work = 0
    self%sum = 0
  end subroutine tracks_leave_to_first

  !> All that outlives a step as a list of reals, for restart files: a block per body.
  pure function tracks_pack(self) result(values)
    class(tracks_t), intent(in) :: self
    real(wp), allocatable :: values(:)
    integer :: t

    allocate (values(0))
    if (.not. self%is_on()) return
    values = [(real(self%number(t), wp), self%start(:, t), self%contact_work(t), self%drive_work(t), self%span(t), &
               self%sum(:, t), t=1, size(self%number))]
  end function tracks_pack

  !> What `pack` gave, for the bodies that are tracked now; those that were not tracked begin.
  pure subroutine tracks_unpack(self, values)
    class(tracks_t), intent(inout) :: self
    real(wp), intent(in) :: values(:) !! of a restart file
    integer :: first, t

    if (.not. self%is_on()) return
    do first = 0, size(values) - n_kept, n_kept
      associate (block => values(first + 1:first + n_kept))
        t = findloc(abs(real(self%number, wp) - block(1)) < 0.5_wp, .true., 1)
        if (t == 0) cycle
        self%start(:, t) = block(2:4)
        self%has_start(t) = .true.
        self%contact_work(t) = block(5)
        self%drive_work(t) = block(6)
        self%span(t) = block(7)
        self%sum(:, t) = block(8:13)
      end associate
    end do
  end subroutine tracks_unpack
end module sg_tracks
