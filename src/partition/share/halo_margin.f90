!> How wide the margin of a rank's copies is, and how long it lasts: copies are rebuilt only when grains have moved through
!! it, lists of neighbours more often (doc/theory/decomposition.md).
module sg_halo_margin
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_sees, only: widest_alert
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: halo_margin_t

  !> A margin lasts until two bodies have come nearer by so many skins of lists of neighbours
  real(wp), parameter :: lasting = 3

  !> A margin and where bodies were when it was chosen
  type :: halo_margin_t
    !> How near another rank's grains a body is copied there [m]
    real(wp) :: width = 0
    !> Own bodies when copies were made, shape (dimension, n_own)
    real(wp), allocatable, private :: placed(:, :)
    !> Edges of a periodic cell then [m]
    real(wp), private :: edge(4) = 0
  contains
    procedure :: choose => margin_choose
    procedure :: start => margin_start
    procedure :: holds => margin_holds
    procedure :: list_tables => margin_list_tables
  end type halo_margin_t

contains

  !> Choose the width for copies about to be made. Collective.
  subroutine margin_choose(self, scene, skin, comm)
    class(halo_margin_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! this rank's part, predicted
    real(wp), intent(in) :: skin !! of the next list of neighbours, the same on all ranks [m]
    type(comm_t), intent(inout) :: comm !! the ranks

    self%width = needed(scene, skin, comm) + lasting*skin
  end subroutine margin_choose

  !> Note where bodies are, now that copies have been made.
  subroutine margin_start(self, scene)
    class(halo_margin_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! this rank's part, with its copies

    self%placed = scene%bodies%position(:, :scene%bodies%n_own)
    self%edge = scene%cell%middle
  end subroutine margin_start

  !> Do the copies still hold all that may touch before the list after the next one? The same on all ranks. Collective.
  logical function margin_holds(self, scene, skin, comm) result(holds)
    class(halo_margin_t), intent(in) :: self
    type(scene_t), intent(in) :: scene !! this rank's part, predicted
    real(wp), intent(in) :: skin !! of the next list of neighbours, the same on all ranks [m]
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: change(4)

    ! Images of a periodic cell move with its edges, by which bodies that were folded count as moved, too.
    change = scene%cell%middle - self%edge
    ! The tilt may have been folded back since.
    if (scene%cell%is_on) change(4) = change(4) - scene%period*anint(change(4)/scene%period)
    holds = needed(scene, skin, comm, self%placed) + 3*sum(abs(change)) <= self%width
  end function margin_holds

  !> List the tables of the margin.
  subroutine margin_list_tables(self, tables)
    class(halo_margin_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('halo', per_body)
    call tables%note('placed', self%placed)
  end subroutine margin_list_tables

  !> How near another rank's grains a body must be for its contacts before the list after the next one [m]: the alert distance,
  !! the skin, and what both move from where they are, or were when copies were made, to where contacts are sought.
  real(wp) function needed(scene, skin, comm, placed)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: skin
    type(comm_t), intent(inout) :: comm
    real(wp), intent(in), optional :: placed(:, :)
    real(wp) :: moved(scene%dimension), most(2)
    integer :: b, n

    n = scene%dimension
    most = 0
    do b = 1, scene%bodies%n
      most(1) = max(most(1), sum((scene%bodies%middle(:n, b) - scene%bodies%position(:, b))**2))
    end do
    if (present(placed)) then
      do b = 1, size(placed, 2)
        moved = scene%bodies%position(:, b) - placed(:, b)
        if (scene%cell%is_on) moved(1) = moved(1) - scene%cell%middle(4)*anint(moved(2)/scene%period_y)
        if (scene%period > 0) moved(1) = moved(1) - scene%period*anint(moved(1)/scene%period)
        if (scene%period_y > 0) moved(2) = moved(2) - scene%period_y*anint(moved(2)/scene%period_y)
        if (scene%period_z > 0) moved(3) = moved(3) - scene%period_z*anint(moved(3)/scene%period_z)
        most(2) = max(most(2), sum(moved**2))
      end do
    end if
    call comm%maximum(most)
    needed = skin + 2*sum(sqrt(most))
    needed = needed + widest_alert(scene%sees, huge(1.0_wp))
  end function needed
end module sg_halo_margin
