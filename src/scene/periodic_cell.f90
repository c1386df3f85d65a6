!> The periodic cell: lengths that change at imposed rates or under imposed stress, and the homogeneous motion that goes with them
!! (doc/theory/periodic_cell.md).
!!
!! Its edges are the columns of A = (L_x, 0, 0), (s, L_y, 0), (0, 0, L_z), where the tilt s is what shear has moved the upper face
!! along x. Bodies move with the homogeneous velocity G x plus their own, which is the one that `bodies_t` holds, so that a body
!! keeps it when it crosses the boundary. Over a step positions move with G x_m, x_m the `middle` configuration, in which the
!! edges are those of `middle`. Where shear has brought the tilt beyond half a length along x, `fold` takes whole lengths from it:
!! the same lattice of images, of which each has other numbers then.
module sg_periodic_cell
  use sg_kinds, only: wp, i4
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: periodic_cell_t, component_xx, component_xy, n_cell_values, n_components

  !> Components of the motion: rates of the three lengths, of which the third is unused in the plane, and shear of x along y
  integer, parameter :: component_xx = 1, component_xy = 4, n_components = 4
  !> Numbers that `pack` writes
  integer, parameter :: n_cell_values = 4*3 + 1
  !> Most lengths by which a tilt is folded back at a time
  real(wp), parameter :: most_folds = 1e6_wp

  !> A periodic cell
  type :: periodic_cell_t
    !> Is there one? If not, nothing else counts
    logical :: is_on = .false.
    !> Lengths along x, y, z [m] and tilt [m] at the start, and now, where positions of bodies are those of `position`
    real(wp) :: start(4) = 0, now(4) = 0
    !> Those of the `middle` configuration of the bodies, and those at the making of the list of neighbours
    real(wp) :: middle(4) = 0, built(4) = 0
    !> Whole lengths along x by which the tilt has been folded back
    integer(i4) :: folds = 0
    !> Imposed rates of the logarithmic strains, positive in compression, and of shear [1/s]; or, where `is_stress`, stresses,
    !! positive in compression, and the shear stress that drives positive shear [Pa]
    type(time_function_t) :: imposed(n_components)
    logical :: is_stress(n_components) = .false.
    !> Inertia of components under imposed stress [kg m2]
    real(wp) :: inertia = 1
    !> Velocity gradient at the end of the step and at its beginning: lengthening per length along x, y, z, and shear [1/s].
    !! Imposed rates are the same at both; where the stress is imposed the first one is that without contacts until they are solved
    real(wp) :: rate(n_components) = 0, before(n_components) = 0
  contains
    procedure :: begin => cell_begin
    procedure :: begin_step => cell_begin_step
    procedure :: finish_step => cell_finish_step
    procedure :: velocity => cell_velocity
    procedure :: mean_velocity => cell_mean_velocity
    procedure :: to_middle => cell_to_middle
    procedure :: distortion => cell_distortion
    procedure :: carried => cell_carried
    procedure :: fold => cell_fold
    procedure :: shear => cell_shear
    procedure :: pack => cell_pack
    procedure :: unpack => cell_unpack
  end type periodic_cell_t

contains

  !> Begin with edges along the axes.
  pure subroutine cell_begin(self, length)
    class(periodic_cell_t), intent(inout) :: self
    real(wp), intent(in) :: length(3) !! lengths along x, y, z [m]; in the plane the third one counts for nothing

    self%is_on = .true.
    self%start = [length, 0.0_wp]
    self%now = self%start
    self%middle = self%start
    self%built = self%start
  end subroutine cell_begin

  !> Rates of a step, and edges of its `middle` configuration.
  pure subroutine cell_begin_step(self, time, h, theta)
    class(periodic_cell_t), intent(inout) :: self
    real(wp), intent(in) :: time !! beginning of the step [s]
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    real(wp) :: volume
    integer :: i

    ! The step may be predicted twice: where the stress is imposed `before` was set when the last one was finished.
    do i = 1, n_components
      if (self%is_stress(i)) cycle
      self%rate(i) = self%imposed(i)%at(time + h/2)
      ! Strains are positive in compression.
      if (i < component_xy) self%rate(i) = -self%rate(i)
      self%before(i) = self%rate(i)
    end do
    self%middle(:3) = self%now(:3)/(1 - (1 - theta)*h*self%before(:3))
    volume = product(self%middle(:3), self%middle(:3) > 0)
    do i = 1, n_components
      if (.not. self%is_stress(i)) cycle
      self%rate(i) = self%before(i) + merge(h, -h, i == component_xy)*volume*self%imposed(i)%at(time + h/2)/self%inertia
    end do
    associate (upper => self%to_middle([self%now(4), self%now(2), 0.0_wp], (1 - theta)*h))
      self%middle(4) = upper(1)
    end associate
  end subroutine cell_begin_step

  !> Edges at the end of a step.
  pure subroutine cell_finish_step(self, h, theta)
    class(periodic_cell_t), intent(inout) :: self
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step

    associate (g => (1 - theta)*self%before + theta*self%rate, m => self%middle)
      self%now(:3) = self%now(:3) + h*g(:3)*m(:3)
      self%now(4) = self%now(4) + h*(g(1)*m(4) + g(4)*m(2))
    end associate
    self%before = self%rate
  end subroutine cell_finish_step

  !> Homogeneous velocity at the end of the step at a place, or between two places [m/s]: G x.
  pure function cell_velocity(self, place) result(velocity)
    class(periodic_cell_t), intent(in) :: self
    real(wp), intent(in) :: place(3) !! [m]
    real(wp) :: velocity(3)

    velocity = self%rate(:3)*place
    velocity(1) = velocity(1) + self%rate(4)*place(2)
  end function cell_velocity

  !> The same with a mean of both ends of the step.
  pure function cell_mean_velocity(self, place, theta) result(velocity)
    class(periodic_cell_t), intent(in) :: self
    real(wp), intent(in) :: place(3) !! [m], or a velocity [m/s], for its change per second
    real(wp), intent(in) :: theta !! weight of the end
    real(wp) :: velocity(3), rate(n_components)

    rate = (1 - theta)*self%before + theta*self%rate
    velocity = rate(:3)*place
    velocity(1) = velocity(1) + rate(4)*place(2)
  end function cell_mean_velocity

  !> Where a point is after a time at the homogeneous velocity, of the beginning of the step, of the place that it reaches [m]:
  !! x_m = x + t G x_m.
  pure function cell_to_middle(self, place, duration) result(middle)
    class(periodic_cell_t), intent(in) :: self
    real(wp), intent(in) :: place(3) !! [m]
    real(wp), intent(in) :: duration !! [s]
    real(wp) :: middle(3)

    middle = place
    if (abs(self%before(4)) > 0) middle(1) = middle(1) + duration*self%before(4)*place(2)/(1 - duration*self%before(2))
    middle = middle/(1 - duration*self%before(:3))
  end function cell_to_middle

  !> Where the motion of the cell has brought a point since the list of neighbours was made [m]: A A_built^-1 x.
  pure function cell_carried(self, place) result(now)
    class(periodic_cell_t), intent(in) :: self
    real(wp), intent(in) :: place(3) !! then [m]
    real(wp) :: now(3)

    now = place
    where (self%built(:3) > 0) now = place*self%middle(:3)/self%built(:3)
    now(1) = now(1) + (self%middle(4) - self%middle(1)/self%built(1)*self%built(4))*place(2)/self%built(2)
  end function cell_carried

  !> Largest share by which distances have changed with the edges since the list of neighbours was made, at least: the norm of
  !! A A_built^-1 - 1.
  pure real(wp) function cell_distortion(self) result(distortion)
    class(periodic_cell_t), intent(in) :: self
    real(wp) :: change(4)

    change = 0
    where (self%built(:3) > 0) change(:3) = self%middle(:3)/self%built(:3) - 1
    change(4) = (self%middle(4) - self%middle(1)/self%built(1)*self%built(4))/self%built(2)
    distortion = norm2(change)
  end function cell_distortion

  !> Fold the tilt back by whole lengths along x where it is more than half of one. An image m periods along y is then as many
  !! periods further along x as `folds` times m.
  pure subroutine cell_fold(self, folds)
    class(periodic_cell_t), intent(inout) :: self
    integer(i4), intent(out) :: folds !! whole lengths taken from the tilt

    folds = 0
    ! A tilt of more lengths than numbers of images can count is that of a broken run, which its guards end.
    if (abs(self%middle(4)) > self%middle(1)/2 .and. abs(self%middle(4)) < most_folds*self%middle(1)) &
      folds = nint(self%middle(4)/self%middle(1), i4)
    self%middle(4) = self%middle(4) - real(folds, wp)*self%middle(1)
    self%now(4) = self%now(4) - real(folds, wp)*self%now(1)
    self%folds = self%folds + folds
  end subroutine cell_fold

  !> Shear strain from the start: way of the upper face along x over the length along y, folds counted.
  pure real(wp) function cell_shear(self) result(strain)
    class(periodic_cell_t), intent(in) :: self

    strain = (self%now(4) + real(self%folds, wp)*self%now(1))/self%now(2)
  end function cell_shear

  !> The state as a list of reals, for restart files; none without a cell.
  pure function cell_pack(self) result(values)
    class(periodic_cell_t), intent(in) :: self
    real(wp), allocatable :: values(:)

    allocate (values(merge(n_cell_values, 0, self%is_on)))
    if (self%is_on) values = [self%now, self%built, self%rate, real(self%folds, wp)]
  end function cell_pack

  !> The state back from a list of reals.
  pure subroutine cell_unpack(self, values)
    class(periodic_cell_t), intent(inout) :: self
    real(wp), intent(in) :: values(:) !! what `pack` gave

    self%now = values(1:4)
    self%built = values(5:8)
    self%rate = values(9:12)
    self%folds = nint(values(13), i4)
    self%before = self%rate
    self%middle = self%now
  end subroutine cell_unpack
end module sg_periodic_cell
