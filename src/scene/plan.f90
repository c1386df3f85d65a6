!> Plan of a scene: parts that it needs and parts left out, decided once, before the first step.
!!
!! A scene of frictionless disks among walls that do not turn has no tangent, no spin and no angle; round scenes
!! carry radius times spin; only the rest pays for lever arms. The plan is printed at the start of a run.
module sg_plan
  use sg_bodies, only: are_turned, drop_rotation
  use sg_body_kinds, only: body_kinds, n_body_kinds
  use sg_comm, only: comm_t
  use sg_contactors, only: kind_disk, kind_hollow, kind_names, kind_polygon, kind_polyhedron, kind_sphere, n_kinds
  use sg_half_width, only: half_width
  use sg_internal_values, only: n_internal_of
  use sg_kinds, only: wp
  use sg_laws, only: allows_pushes, is_cohesive_zone, is_frictionless, is_plain, resists_rolling
  use sg_scene, only: scene_t
  use sg_sees, only: see_of
  use sg_shape_kinds, only: is_round
  use sg_text, only: counted, to_text
  implicit none
  private
  public :: omissions_t, plan_t, make_plan, set_radii, describe_plan
  public :: round_frictionless, round_frictional, arm_frictionless, arm_frictional, arm_bonded
  public :: ball_frictionless, ball_frictional, solid_frictionless, solid_frictional, solid_bonded, arm_rolling, solid_rolling
  public :: arm_mixed, solid_mixed

  !> Kinds of contact problem
  integer, parameter :: round_frictionless = 1, round_frictional = 2, arm_frictionless = 3, arm_frictional = 4, &
                        ball_frictionless = 5, ball_frictional = 6, solid_frictionless = 7, solid_frictional = 8

  !> Kinds with cohesive zones: records of the frictional kind, followed by values of bonds
  integer, parameter :: arm_bonded = 9, solid_bonded = 10

  !> Kinds with moments at contacts: records of the frictional kind, followed by bounds and blocks of the moments
  integer, parameter :: arm_rolling = 11, solid_rolling = 12

  !> Kinds with both: records of the kind with moments, followed by values of bonds
  integer, parameter :: arm_mixed = 13, solid_mixed = 14

  !> Plan of a scene
  type :: plan_t
    !> Do all arms of bodies that turn lie along the normals of their contacts?
    logical :: is_round = .false.
    !> Is there a tangential impulse?
    logical :: has_tangent = .true.
    !> Does anything turn?
    logical :: has_rotation = .true.
    !> Are there cohesive zones?
    logical :: has_bonds = .false.
    !> Do laws in use resist rolling or twisting? And components of a contact's moment, 0 where none does
    logical :: has_rolling = .false.
    integer :: n_moments = 0
    !> Does detection keep contacts from step to step?
    logical :: keeps_contacts = .false.
    !> Kind of the contact problem
    integer :: kind = 0
    !> Internal values that laws in use keep of a contact; its moment is the last of them
    integer :: n_internal = 0
    !> Laws that some pair of contactors uses, and pairs of kinds that see each other
    logical, allocatable :: uses_law(:)
    logical :: sees(n_kinds, n_kinds) = .false.
    !> Smallest alert distance in use [m]
    real(wp) :: alert = huge(1.0_wp)
    !> Smallest one that follows the motion of a step, where there is such a one [m]
    real(wp) :: least_alert = huge(1.0_wp)
    !> Half width of the thinnest shape [m]
    real(wp) :: thinnest = huge(1.0_wp)
    !> Signed radius of round bodies [m], zero for those that do not turn, negative where hollow; empty for other scenes
    real(wp), allocatable :: radius(:)
    !> Bodies, grains among them, contactors and those of each kind; where ranks share the scene, of all of them
    integer :: bodies = 0, grains = 0, contactors = 0, shapes(n_kinds) = 0
    !> Which kinds of bodies there are, of all ranks, whether driven or free
    logical :: body_kinds(n_body_kinds) = .false.
    !> Links, of all ranks
    integer :: links = 0
  end type plan_t

  !> Parts that a plan may leave out where a scene does not need them; tests compare runs with and without
  type :: omissions_t
    !> Tangential impulses, lever arms, rotation (which only goes together with both)
    logical :: friction = .true., arms = .true., rotation = .true.
  end type omissions_t

contains

  !> Decide which parts a scene needs, and drop the others from it.
  subroutine make_plan(scene, plan, comm, omissions)
    type(scene_t), intent(inout) :: scene !! scene; parts that it does not need are dropped
    type(plan_t), intent(out) :: plan !! the plan
    type(comm_t), intent(inout) :: comm !! the ranks; where each has a part of the scene, all call this
    type(omissions_t), intent(in), optional :: omissions !! parts that may be left out; all unless given
    type(omissions_t) :: may
    type(comm_t) :: alone

    if (present(omissions)) may = omissions
    if (allocated(scene%bodies%id)) then
      call plan_scene(scene, plan, comm, may)
    else
      ! A scene that is whole on every rank needs no other rank.
      call plan_scene(scene, plan, alone, may)
    end if
  end subroutine make_plan

  !> Plan the scene of some ranks.
  subroutine plan_scene(scene, plan, ranks, may)
    type(scene_t), intent(inout) :: scene
    type(plan_t), intent(inout) :: plan
    type(comm_t), intent(inout) :: ranks
    type(omissions_t), intent(in) :: may
    logical, allocatable :: turns(:), rests(:), is_partly_driven(:)
    logical :: are_round, all_rest
    integer :: i

    call count_all(scene, plan, ranks)
    call list_uses(scene, plan, ranks)
    if (scene%links%n > 0) plan%uses_law(scene%links%law(:scene%links%n)) = .true.
    plan%links = scene%links%n
    plan%thinnest = thinnest_of(scene, ranks)
    call find_turning(scene, turns, rests, is_partly_driven)
    are_round = ranks%all(all_round(scene, turns) .and. .not. any(is_partly_driven))
    all_rest = ranks%all(all(rests))
    plan%has_tangent = .not. may%friction
    do i = 1, size(scene%laws)
      if (plan%uses_law(i)) plan%has_tangent = plan%has_tangent .or. .not. (is_frictionless(scene%laws(i)) .and. &
                                                                           is_plain(scene%laws(i)))
    end do
    ! Stages of one run have one kind of problem, and the same columns, where some of them have moments.
    plan%has_rolling = scene%bears_moments
    plan%has_tangent = plan%has_tangent .or. plan%has_rolling
    plan%is_round = are_round .and. may%arms .and. .not. plan%has_rolling
    do i = 1, size(scene%laws)
      if (.not. plan%uses_law(i)) cycle
      plan%is_round = plan%is_round .and. is_plain(scene%laws(i)) .and. .not. resists_rolling(scene%laws(i))
      plan%has_rolling = plan%has_rolling .or. resists_rolling(scene%laws(i))
      plan%has_bonds = plan%has_bonds .or. is_cohesive_zone(scene%laws(i))
      plan%n_internal = max(plan%n_internal, n_internal_of(scene%laws(i), scene%dimension))
    end do
    if (plan%has_rolling) plan%n_moments = merge(1, 3, scene%dimension == 2)
    plan%n_internal = plan%n_internal + plan%n_moments
    ! What damages a bond is smaller than the error of a kept gap.
    plan%keeps_contacts = scene%kept_motion > 0 .and. any(plan%shapes([kind_polygon, kind_polyhedron]) > 0) .and. &
                          .not. plan%has_bonds
    plan%kind = problem_kind(scene%dimension, plan)
    plan%has_rotation = .not. (plan%is_round .and. .not. plan%has_tangent .and. all_rest .and. may%rotation)
    allocate (plan%radius(0))
    if (plan%is_round .and. plan%has_tangent) plan%radius = signed_radii(scene, turns)
    if (plan%has_rotation) return
    call drop_rotation(scene%bodies, keep_orientation=ranks%any(are_turned(scene%bodies)))
  end subroutine plan_scene

  !> Kind of problem of a scene.
  pure integer function problem_kind(dimension, plan)
    integer, intent(in) :: dimension
    type(plan_t), intent(in) :: plan

    problem_kind = merge(merge(round_frictional, round_frictionless, plan%has_tangent), &
                         merge(arm_frictional, arm_frictionless, plan%has_tangent), plan%is_round)
    if (dimension == 3) problem_kind = problem_kind + ball_frictionless - round_frictionless
    if (plan%has_rolling) problem_kind = merge(arm_rolling, solid_rolling, dimension == 2)
    if (.not. plan%has_bonds) return
    if (plan%has_rolling) then
      problem_kind = merge(arm_mixed, solid_mixed, dimension == 2)
    else
      problem_kind = merge(arm_bonded, solid_bonded, dimension == 2)
    end if
  end function problem_kind

  !> Set the radii of round bodies after a rank's part of the scene has changed.
  pure subroutine set_radii(scene, plan)
    type(scene_t), intent(in) :: scene !! this rank's part
    type(plan_t), intent(inout) :: plan !! plan of the whole scene
    logical, allocatable :: turns(:), rests(:), is_partly_driven(:)

    if (.not. (plan%is_round .and. plan%has_tangent)) return
    call find_turning(scene, turns, rests, is_partly_driven)
    plan%radius = signed_radii(scene, turns)
  end subroutine set_radii

  !> Count bodies, grains, contactors and their kinds. Each rank counts the bodies that it counts as its own.
  subroutine count_all(scene, plan, ranks)
    type(scene_t), intent(in) :: scene
    type(plan_t), intent(inout) :: plan
    type(comm_t), intent(inout) :: ranks
    integer :: counts(2 + n_kinds)
    integer :: c, k

    counts = 0
    counts(1) = scene%bodies%n_own
    counts(2) = count(scene%bodies%is_grain(:scene%bodies%n_own))
    do c = 1, scene%contactors%n
      if (scene%contactors%body(c) > scene%bodies%n_own) cycle
      associate (same => counts(2 + scene%contactors%kind(c)))
        same = same + 1
      end associate
    end do
    call ranks%sum(counts)
    plan%bodies = counts(1)
    plan%grains = counts(2)
    plan%shapes = counts(3:)
    plan%contactors = sum(plan%shapes)
    associate (kinds => body_kinds(scene%contactors, scene%bodies%n))
      plan%body_kinds = ranks%any([(any(kinds == k), k=1, n_body_kinds)])
    end associate
  end subroutine count_all

  !> Laws and pairs of kinds in use, from the kinds and colours that there are.
  subroutine list_uses(scene, plan, ranks)
    type(scene_t), intent(in) :: scene
    type(plan_t), intent(inout) :: plan
    type(comm_t), intent(inout) :: ranks
    logical, allocatable :: is_there(:)
    integer :: c, i, j, see, kind(2), colour(2)

    allocate (plan%uses_law(size(scene%laws)), source=.false.)
    allocate (is_there(n_kinds*size(scene%colours)), source=.false.)
    do c = 1, scene%contactors%n
      is_there(scene%contactors%kind(c) + n_kinds*(scene%contactors%colour(c) - 1)) = .true.
    end do
    is_there = ranks%any(is_there)
    do i = 1, size(is_there)
      do j = 1, i
        if (.not. (is_there(i) .and. is_there(j))) cycle
        kind = 1 + mod([i, j] - 1, n_kinds)
        colour = 1 + ([i, j] - 1)/n_kinds
        see = see_of(scene%sees, kind, colour)
        if (see == 0) cycle
        plan%uses_law(scene%sees(see)%law) = .true.
        plan%alert = min(plan%alert, scene%sees(see)%alert)
        plan%least_alert = min(plan%least_alert, scene%sees(see)%least_alert)
        plan%sees(kind(1), kind(2)) = .true.
        plan%sees(kind(2), kind(1)) = .true.
      end do
    end do
    do see = 1, size(scene%sees)
      if (scene%sees(see)%group == 0) cycle
      plan%uses_law(scene%sees(see)%law) = .true.
      plan%alert = min(plan%alert, scene%sees(see)%alert)
      plan%least_alert = min(plan%least_alert, scene%sees(see)%least_alert)
    end do
  end subroutine list_uses

  !> Half width of the thinnest shape of all ranks [m].
  real(wp) function thinnest_of(scene, ranks) result(thinnest)
    type(scene_t), intent(in) :: scene
    type(comm_t), intent(inout) :: ranks
    integer :: c

    thinnest = huge(1.0_wp)
    do c = 1, scene%contactors%n
      thinnest = min(thinnest, half_width(scene%contactors, c))
    end do
    call ranks%minimum(thinnest)
  end function thinnest_of

  !> Which bodies can turn, which neither turn now nor ever are made to, and which of those in space that turn are driven
  !! in some components only.
  pure subroutine find_turning(scene, turns, rests, is_partly_driven)
    type(scene_t), intent(in) :: scene
    logical, allocatable, intent(out) :: turns(:), rests(:), is_partly_driven(:)
    logical, allocatable :: is_free(:, :), is_released(:)
    integer :: i, n

    n = scene%dimension
    allocate (is_free(scene%bodies%n_velocity, scene%bodies%n), source=.true.)
    allocate (is_released(scene%bodies%n), source=.false.)
    rests = .not. any(abs(scene%bodies%velocity(n + 1:, :)) > 0, 1)
    do i = 1, size(scene%drives)
      ! A component that is driven for a time is free in other steps.
      if (scene%drives(i)%releases()) is_released(scene%drives(i)%body) = .true.
      if (scene%drives(i)%is_velocity .and. .not. scene%drives(i)%releases()) &
        is_free(scene%drives(i)%component, scene%drives(i)%body) = .false.
      if (scene%drives(i)%component <= n) cycle
      if (.not. scene%drives(i)%value%is_zero()) rests(scene%drives(i)%body) = .false.
    end do
    turns = any(is_free(n + 1:, :), 1)
    ! Records of balls have one inverse mass and one inverse inertia for all directions.
    is_partly_driven = n == 3 .and. turns .and. any(is_free, 1) .and. (is_released .or. .not. all(is_free, 1))
  end subroutine find_turning

  !> Does every body that turns touch the others with centred disks of one radius only?
  pure logical function all_round(scene, turns)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: turns(:)
    integer :: c, b
    logical :: seen(size(turns))

    all_round = .true.
    seen = .false.
    do c = 1, scene%contactors%n
      b = scene%contactors%body(c)
      if (.not. turns(b)) cycle
      all_round = all_round .and. is_round(scene%contactors%kind(c)) .and. .not. seen(b) &
                  .and. .not. any(abs(scene%contactors%shift(:, c)) > 0)
      if (scene%dimension == 3) all_round = all_round .and. is_isotropic(scene%bodies%principal(:, b))
      seen(b) = .true.
    end do
  end function all_round

  !> Are the principal moments of a body the same to rounding?
  pure logical function is_isotropic(principal)
    real(wp), intent(in) :: principal(3)

    is_isotropic = maxval(principal) - minval(principal) <= 16*epsilon(1.0_wp)*maxval(principal)
  end function is_isotropic

  !> Signed radius by body.
  pure function signed_radii(scene, turns) result(radius)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: turns(:)
    real(wp), allocatable :: radius(:)
    integer :: c, b

    allocate (radius(scene%bodies%n), source=0.0_wp)
    do c = 1, scene%contactors%n
      b = scene%contactors%body(c)
      if (.not. turns(b)) cycle
      if (scene%contactors%kind(c) == kind_disk) radius(b) = scene%contactors%disk_radius(scene%contactors%row(c))
      if (scene%contactors%kind(c) == kind_sphere) radius(b) = scene%contactors%space%sphere_radius(scene%contactors%row(c))
      if (scene%contactors%kind(c) == kind_hollow) radius(b) = -scene%contactors%hollow_radius(scene%contactors%row(c))
    end do
  end function signed_radii

  !> The plan in a few lines: parts used, parts left out.
  function describe_plan(plan, scene, ranks, recovery) result(text)
    type(plan_t), intent(in) :: plan !! plan of the scene
    type(scene_t), intent(in) :: scene !! scene after planning
    integer, intent(in) :: ranks !! ranks that share it
    real(wp), intent(in) :: recovery !! overlap over the smaller shape from which on it is undone; 0 for never
    character(len=:), allocatable :: text
    character(len=*), parameter :: nl = new_line('a')
    integer :: i, j

    text = 'scene      '//to_text(plan%bodies)//' bodies ('//counted(plan%grains, 'grain')//'), ' &
           //counted(plan%contactors, 'contactor')//nl//'shapes    '
    do i = 1, n_kinds
      if (plan%shapes(i) > 0) text = text//' '//to_text(plan%shapes(i))//' '//trim(kind_names(i))
    end do
    text = text//nl//'pairs     '
    do i = 1, n_kinds
      do j = i, n_kinds
        if (plan%sees(i, j)) text = text//' '//trim(kind_names(i))//'-'//trim(kind_names(j))
      end do
    end do
    if (plan%links > 0) text = text//' '//counted(plan%links, 'link')
    text = text//nl//'laws      '
    do i = 1, size(scene%laws)
      if (plan%uses_law(i)) text = text//' '//scene%laws(i)%name
    end do
    text = text//nl//'used       '//merge('2D', '3D', scene%dimension == 2)//used(plan%has_tangent, 'friction') &
           //used(plan%has_rotation, 'rotation')//used(plan%has_rolling, 'rolling resistance') &
           //used(.not. plan%is_round, 'lever arms')//used(scene%period > 0, 'period in x') &
           //used(scene%period_y > 0, 'period in y')//used(scene%period_z > 0, 'period in z') &
           //used(scene%cell%is_on, 'periodic cell') &
           //used(size(scene%drives) > 0, 'drives')//used(size(scene%pressures) > 0, 'pressures') &
           //used(scene%bodies%has_presence, 'entries and removals') &
           //used(ranks > 1, 'decomposition') &
           //used(recovery > 0, 'recovery of overlap above '//to_text(recovery, 3)//' of the smaller shape')
    text = text//nl//'left out   '//merge('3D', '2D', scene%dimension == 2)//used(ranks == 1, 'decomposition') &
           //used(.not. plan%has_tangent, 'friction') &
           //used(.not. plan%has_rotation, 'rotation')//used(plan%is_round, 'lever arms') &
           //used(.not. max(scene%period, scene%period_y) > 0, 'period')//used(size(scene%drives) == 0, 'drives') &
           //used(size(scene%pressures) == 0, 'pressures') &
           //used(.not. recovery > 0, 'recovery of overlap'//reason_without_recovery(scene))
    if (plan%keeps_contacts) &
      text = text//nl//'kept       contacts of polygons and polyhedra while these move against each other by less than ' &
             //to_text(scene%kept_motion, 3)//' of the smaller radius; gaps are off by '//to_text(2*scene%kept_motion, 3) &
             //' of it at most'
  contains
    pure function used(is_used, word)
      logical, intent(in) :: is_used
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: used

      used = ''
      if (is_used) used = ', '//word
    end function used
  end function describe_plan

  !> Why overlap is not undone, in brackets: the first law that needs it; empty where no law does.
  function reason_without_recovery(scene) result(text)
    type(scene_t), intent(in) :: scene
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(scene%laws)
      if (allows_pushes(scene%laws(i))) cycle
      text = ' (law "'//scene%laws(i)%name//'" needs it)'
      return
    end do
  end function reason_without_recovery
end module sg_plan
