!> Entries and exits: when bodies come into a scene, and which ones leave it. Both go by the numbers of bodies in the whole scene,
!! so that all ranks of a decomposed scene hold the same lists.
module sg_passages
  use sg_ascending, only: place_in
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: entry_t, exit_t, due_time, time_slack

  !> Share of a time step by which rounding may make a time late
  real(wp), parameter :: time_slack = 1e-6_wp

  !> Bodies that come after the start: all at one time, or one after the other
  type :: entry_t
    !> Numbers of the first and the last of them
    integer :: first = 0, last = -1
    !> When the first one is due, and the time from one to the next [s]
    real(wp) :: start = 0, interval = 0
    !> Does each wait until no other grain is in its place?
    logical :: waits = .false.
    !> Steps from one look at those that wait to the next
    integer :: every = 1
  end type entry_t

  !> Bodies that leave
  type :: exit_t
    !> Numbers of the bodies concerned, ascending; unallocated for all grains
    integer(i4), allocatable :: bodies(:)
    !> Least and largest coordinates of a box [m], and does it concern centres within it? Else those outside of it
    real(wp) :: low(3) = -huge(1.0_wp), high(3) = huge(1.0_wp)
    logical :: is_inside = .true.
    !> Time from which on they leave [s]
    real(wp) :: start = -huge(1.0_wp)
    !> Steps from one look at them to the next
    integer :: every = 1
  contains
    procedure :: takes => exit_takes
  end type exit_t

contains

  !> When a body of an entry is due [s]; huge for other bodies.
  elemental real(wp) function due_time(entry, number) result(time)
    type(entry_t), intent(in) :: entry !! bodies that come
    integer, intent(in) :: number !! number of a body

    time = huge(time)
    if (number < entry%first .or. number > entry%last) return
    time = entry%start
    if (entry%interval > 0) time = time + entry%interval*real(number - entry%first, wp)
  end function due_time

  !> Does an exit concern a body by its number and the place of its centre?
  pure logical function exit_takes(self, number, is_grain, position)
    class(exit_t), intent(in) :: self
    integer, intent(in) :: number !! of the body in the whole scene
    logical, intent(in) :: is_grain !! is it a grain?
    real(wp), intent(in) :: position(:) !! of its centre [m], shape (dimension)
    integer :: d

    exit_takes = is_grain
    if (allocated(self%bodies)) exit_takes = place_in(self%bodies, int(number, i4)) > 0
    if (.not. exit_takes) return
    d = size(position)
    exit_takes = (all(position >= self%low(:d)) .and. all(position <= self%high(:d))) .eqv. self%is_inside
  end function exit_takes
end module sg_passages
