!> The contact laws of a scene, and what a law asks of one contact in one step.
!!
!! Every law becomes one local problem (doc/theory/laws.md): find the impulse r and u = W r + q with
!!
!!     u' = u + bias + compliance r,     r' = r + (cohesion, 0)
!!     0 <= r'_n  complementary to  u'_n >= 0,   |r'_t| <= friction r'_n  (Coulomb)      unilateral
!!     u' = 0                                                                            linear
!!     u'_n = 0,   r_t = 0                                                               linear along the normal
module sg_laws
  use sg_kinds, only: wp, i1
  implicit none
  private
  public :: law_t, local_law_t, local_law, set_local_law, linear_law, gap_bias, looks_at_gap
  public :: law_iqs, law_gap, law_velocity, law_restitution, law_wet, law_mohr, law_elastic, law_linear
  public :: law_rod, law_wire, law_rigid_wire, law_bond, is_link_law
  public :: law_iqs_g0, law_gap_g0, law_elastic_g0, law_gap_shifted, law_viscoelastic
  public :: law_mac, law_mal, law_th, law_abp, law_expo, is_cohesive_zone, needs_surface
  public :: status_new, status_none, status_stick, status_slide, status_bonded, status_broken, last_status
  public :: acts_in_touch, forbidden_gap, allows_pushes
  public :: is_plain, is_frictionless, resists_rolling, inverse_of, kind_of_local_law, largest_friction, why_largest_friction

  !> Kinds of law: inelastic quasi-shock, Signorini in gaps, Signorini in velocities, Newton restitution,
  !! wet (cohesion within a thickness), Mohr-Coulomb (cohesion until broken), elastic repulsion, linear; those of links
  !! (sg_link_laws): rod, wire, wire that does not stretch, bond;
  !! quasi-shock, Signorini in gaps and elastic repulsion with gaps counted from that of the first detection, Signorini in gaps
  !! shifted by a given length, viscoelastic repulsion; cohesive zones (sg_cohesive_zones): with adhesion energy, and with
  !! stresses that fall along a parabola, a trapeze, two lines, an exponential
  integer, parameter :: law_iqs = 1, law_gap = 2, law_velocity = 3, law_restitution = 4, law_wet = 5, law_mohr = 6, &
                        law_elastic = 7, law_linear = 8, law_rod = 9, law_wire = 10, law_rigid_wire = 11, law_bond = 12, &
                        law_iqs_g0 = 13, law_gap_g0 = 14, law_elastic_g0 = 15, law_gap_shifted = 16, &
                        law_viscoelastic = 17, law_mac = 18, law_mal = 19, law_th = 20, law_abp = 21, law_expo = 22

  !> Largest Coulomb coefficient that is taken, and why there is one: errors add friction times the slip to the normal velocity,
  !! of which sixteen digits leave nothing where friction is larger by far
  real(wp), parameter :: largest_friction = 1e6_wp
  character(len=*), parameter :: why_largest_friction = 'since rounding of the slip hides normal velocities above'

  !> What happened at a contact in the last step: not known yet, open, sticking, sliding, bonded, broken (a link, for good)
  integer(i1), parameter :: status_new = 0, status_none = 1, status_stick = 2, status_slide = 3, status_bonded = 4, &
                            status_broken = 5
  !> The last of them
  integer(i1), parameter :: last_status = status_broken

  !> One contact law with its parameters
  type :: law_t
    !> Name by which see tables call it
    character(len=:), allocatable :: name
    !> Kind of law, one of `law_*`
    integer :: kind = law_iqs
    !> Coulomb friction while sticking and while sliding
    real(wp) :: static_friction = 0, dynamic_friction = 0
    !> Largest moments over the normal force, of rolling and of twisting [m]: a length, and a multiple of the effective radius
    real(wp) :: rolling_length = 0, twisting_length = 0, rolling_friction = 0, twisting_friction = 0
    !> Newton restitution, normal and tangential
    real(wp) :: normal_restitution = 0, tangential_restitution = 0
    !> Cohesion force, normal and tangential [N]; a tangential one of zero is friction times the normal one
    real(wp) :: normal_cohesion = 0, tangential_cohesion = 0
    !> Gap up to which a wet contact pulls [m]
    real(wp) :: wet_thickness = 0
    !> Force per penetration of elastic laws [N/m], and per velocity [N s/m]
    real(wp) :: stiffness = 0, viscosity = 0
    !> Length added to the gap by the shifted law [m]
    real(wp) :: gap_shift = 0
    !> Velocity per impulse of the linear law r = -(1/epsilon) v [1/kg]; or what it is of the mean diagonal term of W, where
    !! that is not zero (sg_relative_epsilon); and does it act along the normal alone?
    real(wp) :: epsilon = 0, relative_epsilon = 0
    logical :: is_along_normal = .false.
    !> Does the linear law hold two points together in place too, as a joint?
    logical :: is_joint = .false.
    !> Links: force per strain of rods and wires [N], and per rate of strain [N s]; strain at rest
    real(wp) :: axial_stiffness = 0, axial_damping = 0, prestrain = 0
    !> Tension that breaks a wire [N]; none where it is zero
    real(wp) :: breaking_force = 0
    !> Bonds: Young's modulus [Pa], Poisson's ratio; of these, of Mohr-Coulomb bonds and of cohesive zones the strength, normal
    !! and tangential [Pa]
    real(wp) :: young = 0, poisson = 0, normal_strength = 0, tangential_strength = 0
    !> Cohesive zones, each normal and tangential: stress per opening [Pa/m], fracture energy [J/m2] (of the first
    !! one the adhesion energy), end of the plateau, largest opening [m]
    real(wp) :: zone_stiffness(2) = 0, zone_energy(2) = 0, zone_plateau(2) = 0, zone_opening(2) = 0
    !> Viscosity of damage [J s/m2], share of the energy before the knee, share of the strength at which bonds are cut
    real(wp) :: zone_viscosity = 0, zone_share = 0, zone_residual = 0
  end type law_t

  !> What a law asks of one contact in one step
  type :: local_law_t
    !> Can the contact carry an impulse in this step at all?
    logical :: is_active = .true.
    !> Is it linear, with its components free in sign? And has it none along tangents?
    logical :: is_linear = .false., is_along_normal = .false.
    !> Added to the relative velocity, normal and tangential (in the plane the third is zero) [m/s]
    real(wp) :: bias(3) = 0
    !> Friction coefficient of this step
    real(wp) :: friction = 0
    !> Largest moments over the normal impulse, of rolling and of twisting [m]
    real(wp) :: moment_arm(2) = 0
    !> Cohesion impulse: the normal impulse may go down to minus this [N s]
    real(wp) :: cohesion = 0
    !> Velocity per impulse, normal and tangential [1/kg]
    real(wp) :: compliance(2) = 0
    !> Stiffness of a bond times the square of the step, normal and tangential [kg], and its slip over the step [m/s]
    real(wp) :: stiffness(2) = 0, slip(3) = 0
  end type local_law_t

contains

  !> The local problem of one contact in one step.
  pure function local_law(law, gap, time_step, before, status, internal, surface) result(local)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: gap !! at the detection configuration [m]
    real(wp), intent(in) :: time_step !! time step h [s]
    real(wp), intent(in) :: before(3) !! relative velocity at the beginning of the step, normal and tangential [m/s]
    integer(i1), intent(in) :: status !! what the contact did in the last step
    real(wp), intent(in), optional :: internal(:) !! internal values of the contact, for laws that keep some
    real(wp), intent(in), optional :: surface !! of the contact, for laws that need it [m2; m in the plane]
    type(local_law_t) :: local

    call set_local_law(law, gap, time_step, before, status, local, internal, surface)
  end function local_law

  !> The same in place: assembly would copy the result several times per contact.
  pure subroutine set_local_law(law, gap, time_step, before, status, local, internal, surface)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: gap !! at the detection configuration [m]
    real(wp), intent(in) :: time_step !! time step h [s]
    real(wp), intent(in) :: before(3) !! relative velocity at the beginning of the step, normal and tangential [m/s]
    integer(i1), intent(in) :: status !! what the contact did in the last step
    type(local_law_t), intent(out) :: local !! what the law asks
    real(wp), intent(in), optional :: internal(:) !! internal values of the contact, for laws that keep some
    real(wp), intent(in), optional :: surface !! of the contact, for laws that need it [m2; m in the plane]
    real(wp) :: reference

    reference = 0
    if (present(internal)) then
      if (size(internal) > 0) reference = internal(1)
    end if

    local%friction = merge(law%static_friction, law%dynamic_friction, status == status_stick .or. status == status_bonded)
    select case (law%kind)
    case (law_iqs, law_gap, law_iqs_g0, law_gap_g0, law_gap_shifted)
      local%bias(1) = gap_bias(law, gap, time_step, reference)
    case (law_velocity)
      local%is_active = gap <= 0
    case (law_restitution)
      local%is_active = gap <= 0
      local%bias = before*[law%normal_restitution, law%tangential_restitution, law%tangential_restitution]
    case (law_wet)
      local%bias(1) = max(0.0_wp, gap/time_step)
      if (gap <= law%wet_thickness) local%cohesion = law%normal_cohesion*time_step
    case (law_mohr)
      local%bias(1) = max(0.0_wp, gap/time_step)
      if (status /= status_bonded) return
      local%cohesion = law%normal_cohesion*time_step
      ! A bond slides where its tangential cohesion is passed.
      if (law%tangential_cohesion > 0) local%friction = law%tangential_cohesion/law%normal_cohesion
      if (.not. present(surface) .or. .not. needs_surface(law)) return
      local%cohesion = surface*law%normal_strength*time_step
      if (law%normal_strength > 0) local%friction = law%tangential_strength/law%normal_strength
    case (law_elastic)
      local%bias(1) = gap/time_step
      local%compliance(1) = 1/(law%stiffness*time_step**2)
    case (law_elastic_g0)
      local%bias(1) = (gap - reference)/time_step
      local%compliance(1) = 1/(law%stiffness*time_step**2)
    case (law_viscoelastic)
      local%is_active = gap <= 0
      local%bias(1) = law%stiffness*gap/(law%stiffness*time_step + law%viscosity)
      local%compliance(1) = 1/(law%stiffness*time_step**2 + law%viscosity*time_step)
    case (law_linear)
      local = linear_law(law)
    end select
  end subroutine set_local_law

  !> Normal bias of the laws that ask for nothing but a gap [m/s].
  pure real(wp) function gap_bias(law, gap, time_step, reference) result(bias)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: gap !! at the detection configuration [m]
    real(wp), intent(in) :: time_step !! time step h [s]
    real(wp), intent(in) :: reference !! gap that counts as none, for laws that keep it [m]

    select case (law%kind)
    case (law_iqs)
      bias = max(0.0_wp, gap/time_step)
    case (law_iqs_g0)
      bias = max(0.0_wp, (gap - reference)/time_step)
    case (law_gap_g0)
      bias = (gap - reference)/time_step
    case (law_gap_shifted)
      bias = (gap + law%gap_shift)/time_step
    case default
      bias = gap/time_step
    end select
  end function gap_bias

  !> Does a law ask for nothing but a gap: no status, no velocity of before, nothing elastic or cohesive?
  elemental logical function looks_at_gap(law)
    type(law_t), intent(in) :: law !! law to look at

    looks_at_gap = any(law%kind == [law_iqs, law_gap, law_iqs_g0, law_gap_g0, law_gap_shifted]) .and. &
                   .not. (abs(law%static_friction - law%dynamic_friction) > 0 .or. resists_rolling(law))
  end function looks_at_gap

  !> Does a law act only on shapes that touch by the end of a step, and keep nothing of a contact that is open?
  elemental logical function acts_in_touch(law)
    type(law_t), intent(in) :: law !! law to look at

    acts_in_touch = any(law%kind == [law_iqs, law_gap, law_velocity, law_restitution, law_elastic, law_viscoelastic])
  end function acts_in_touch

  !> Are shapes under the law rigid, so that overlap is an error of the scheme? It is a load of elastic laws, and bonds keep theirs.
  pure logical function forbids_overlap(law)
    type(law_t), intent(in) :: law !! law to look at

    forbids_overlap = is_plain(law) .or. law%kind == law_wet
  end function forbids_overlap

  !> Does nothing but the motion of bodies hang on the overlap of contacts under a law? A push keeps the lengths of links.
  pure logical function allows_pushes(law)
    type(law_t), intent(in) :: law !! law to look at

    allows_pushes = forbids_overlap(law) .or. any(law%kind == [law_rod, law_wire, law_rigid_wire])
  end function allows_pushes

  !> Gap that a law forbids to be negative [m], of those that forbid overlap.
  pure real(wp) function forbidden_gap(law, gap, internal) result(own)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: gap !! between the shapes [m]
    real(wp), intent(in) :: internal(:) !! internal values of the contact

    own = gap
    if (law%kind == law_gap_shifted) own = gap + law%gap_shift
    if (any(law%kind == [law_iqs_g0, law_gap_g0])) own = gap - internal(1)
  end function forbidden_gap

  !> The linear law, r = -(1/epsilon) v in all directions or along the normal, of contacts and links. A relative epsilon is set
  !! when the problem is assembled.
  pure function linear_law(law) result(local)
    type(law_t), intent(in) :: law !! the law
    type(local_law_t) :: local

    local%is_linear = .true.
    local%is_along_normal = law%is_along_normal
    local%compliance = law%epsilon
  end function linear_law

  !> Kind of a local law, as records of contacts hold it: 0 where it takes no part, 1 unilateral, 2 linear, 3 linear along the
  !! normal.
  pure real(wp) function kind_of_local_law(local) result(kind)
    type(local_law_t), intent(in) :: local !! what the law asks

    kind = 0
    if (.not. local%is_active) return
    kind = 1
    if (local%is_linear) kind = merge(3.0_wp, 2.0_wp, local%is_along_normal)
  end function kind_of_local_law

  !> Inverse of a diagonal term of W; zero where the contact can change nothing.
  pure real(wp) function inverse_of(w, is_active)
    real(wp), intent(in) :: w !! diagonal term [1/kg]
    logical, intent(in) :: is_active !! can the contact carry an impulse?

    inverse_of = 0
    if (is_active .and. w > tiny(1.0_wp)) inverse_of = 1/w
  end function inverse_of

  !> Is the law unilateral contact with Coulomb friction and nothing else, so that compact kernels serve it?
  pure logical function is_plain(law)
    type(law_t), intent(in) :: law !! law to look at

    is_plain = law%kind <= law_restitution .or. any(law%kind == [law_iqs_g0, law_gap_g0, law_gap_shifted])
  end function is_plain

  !> Does the law hold between the two points of a link, and nowhere else?
  pure logical function is_link_law(law)
    type(law_t), intent(in) :: law !! law to look at

    is_link_law = law%is_joint .or. any(law%kind == [law_rod, law_wire, law_rigid_wire, law_bond])
  end function is_link_law

  !> Is the law a cohesive zone?
  pure logical function is_cohesive_zone(law)
    type(law_t), intent(in) :: law !! law to look at

    is_cohesive_zone = law%kind >= law_mac .and. law%kind <= law_expo
  end function is_cohesive_zone

  !> Does the law take the surface of a contact?
  pure logical function needs_surface(law)
    type(law_t), intent(in) :: law !! law to look at

    needs_surface = is_cohesive_zone(law) .or. (law%kind == law_mohr .and. max(law%normal_strength, law%tangential_strength) > 0)
  end function needs_surface

  !> Has the law no tangential impulse at all?
  pure logical function is_frictionless(law)
    type(law_t), intent(in) :: law !! law to look at

    is_frictionless = .not. max(law%static_friction, law%dynamic_friction) > 0 .and. law%kind /= law_bond .and. &
                      (law%kind /= law_linear .or. law%is_along_normal) .and. .not. is_cohesive_zone(law) .and. &
                      .not. resists_rolling(law)
  end function is_frictionless

  !> Does the law bear moments that resist rolling or twisting?
  elemental logical function resists_rolling(law)
    type(law_t), intent(in) :: law !! law to look at

    resists_rolling = max(law%rolling_length, law%twisting_length, law%rolling_friction, law%twisting_friction) > 0
  end function resists_rolling
end module sg_laws
