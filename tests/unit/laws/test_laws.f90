!> What each law asks of one contact, by hand; the exact solution of one-contact problems for any friction.
program test_laws
  use harness, only: tests_t
  use sg_compact, only: compact_velocity
  use sg_datbox_laws, only: labels_of, law_forms
  use sg_internal_values, only: first_internal, n_internal_of
  use sg_key_table, only: key_table_t, value_real
  use sg_keys, only: all_keys
  use sg_kinds, only: wp, i1
  use sg_law_parameters, only: get_parameter, set_parameter
  use sg_laws, only: law_elastic, law_gap, law_iqs, law_linear, law_mohr, law_restitution, law_t, law_velocity, law_wet
  use sg_laws, only: law_bond, law_elastic_g0, law_gap_g0, law_gap_shifted, law_iqs_g0, law_viscoelastic
  use sg_laws, only: is_frictionless, is_plain, local_law, local_law_t
  use sg_laws, only: status_bonded, status_new, status_none, status_slide, status_stick
  use sg_matrix_errors, only: project_on_cone
  use sg_natural_map, only: natural_map, project
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, arm_frictional, &
                        arm_law, arm_moment_tc, arm_wnn, arm_wtt, normal_x, record_length, round_frictional
  use sg_report, only: report_t
  implicit none
  real(wp), parameter :: h = 0.01_wp, still(3) = 0
  ! Numbers of order one through fewer than ten operations.
  real(wp), parameter :: rounding = 1e-15_wp
  type(tests_t) :: t

  call test_unilateral()
  call test_restitution()
  call test_cohesion()
  call test_compliant()
  call test_friction()
  call test_shifted_gaps()
  call test_kinds()
  call test_names()
  call test_one_contact()
  call test_one_round_contact()
  call test_natural_map()
  call test_cone()
  call t%finish()

contains

  !> Laws with a gap: what they add to the velocity, and when they act.
  subroutine test_unilateral()
    type(local_law_t) :: open, touching, through

    open = local_law(law_t(kind=law_iqs), 0.02_wp, h, still, status_new)
    through = local_law(law_t(kind=law_iqs), -0.02_wp, h, still, status_new)
    call t%near(open%bias(1), 2.0_wp, rounding, 'quasi-shock: an open gap may be closed in the step')
    call t%near(through%bias(1), 0.0_wp, 0.0_wp, 'quasi-shock: a penetration is kept')
    call t%check(open%is_active .and. through%is_active .and. .not. open%is_linear, 'quasi-shock: always active')
    open = local_law(law_t(kind=law_gap), 0.02_wp, h, still, status_new)
    through = local_law(law_t(kind=law_gap), -0.02_wp, h, still, status_new)
    call t%near(open%bias(1), 2.0_wp, rounding, 'gaps: an open gap may be closed in the step')
    call t%near(through%bias(1), -2.0_wp, rounding, 'gaps: a penetration is undone in the step')
    open = local_law(law_t(kind=law_velocity), 0.02_wp, h, still, status_new)
    touching = local_law(law_t(kind=law_velocity), 0.0_wp, h, still, status_new)
    through = local_law(law_t(kind=law_velocity), -0.02_wp, h, still, status_new)
    call t%check(.not. open%is_active .and. touching%is_active .and. through%is_active, 'velocities: active once touching')
    call t%near(maxval(abs([open%bias, touching%bias, through%bias])), 0.0_wp, 0.0_wp, 'velocities: no bias')
    call t%near(open%bias(2), 0.0_wp, 0.0_wp, 'no tangential bias')
  end subroutine test_unilateral

  !> Newton restitution: u' = u + e u_before.
  subroutine test_restitution()
    type(law_t) :: law
    type(local_law_t) :: local

    law = law_t(kind=law_restitution, normal_restitution=0.5_wp, tangential_restitution=0.25_wp)
    local = local_law(law, -1e-9_wp, h, [-2.0_wp, 4.0_wp, 0.0_wp], status_new)
    call t%near(local%bias(1), -1.0_wp, rounding, 'restitution: normal')
    call t%near(local%bias(2), 1.0_wp, rounding, 'restitution: tangential')
    call t%check(local%is_active, 'restitution: active once touching')
    local = local_law(law, 1e-9_wp, h, [-2.0_wp, 4.0_wp, 0.0_wp], status_new)
    call t%check(.not. local%is_active, 'restitution: waits for the gap to close')
  end subroutine test_restitution

  !> Cohesion: within a thickness where wet, until broken for Mohr-Coulomb.
  subroutine test_cohesion()
    type(law_t) :: wet, mohr
    type(local_law_t) :: local

    wet = law_t(kind=law_wet, normal_cohesion=30.0_wp, wet_thickness=0.01_wp)
    local = local_law(wet, 0.009_wp, h, still, status_new)
    call t%near(local%cohesion, 0.3_wp, rounding, 'wet: pulls within its thickness, force times step')
    call t%near(local%bias(1), 0.9_wp, rounding, 'wet: an open gap may be closed')
    local = local_law(wet, 0.011_wp, h, still, status_stick)
    call t%near(local%cohesion, 0.0_wp, 0.0_wp, 'wet: does not pull beyond')
    local = local_law(wet, -0.5_wp, h, still, status_slide)
    call t%near(local%cohesion, 0.3_wp, rounding, 'wet: pulls while touching, sliding or not')
    mohr = law_t(kind=law_mohr, normal_cohesion=30.0_wp)
    local = local_law(mohr, 0.001_wp, h, still, status_bonded)
    call t%near(local%cohesion, 0.3_wp, rounding, 'Mohr: pulls while bonded')
    local = local_law(mohr, 0.0_wp, h, still, status_stick)
    call t%near(local%cohesion, 0.0_wp, 0.0_wp, 'Mohr: a broken bond never pulls again')
  end subroutine test_cohesion

  !> Each number of a law can be set and read by its key in decks, and by its label in LMGC90's files; no other name can.
  subroutine test_names()
    type(key_table_t) :: table
    integer :: section, k, form, at
    character(len=9) :: labels(6)

    table = all_keys()
    section = table%find_section('law')
    do k = table%sections(section)%first, table%sections(section)%last
      if (table%keys(k)%kind == value_real) call t%check(is_parameter(law_iqs, trim(table%keys(k)%name)), &
                                                         'names: the law has '//trim(table%keys(k)%name))
    end do
    do form = 1, size(law_forms)
      labels = labels_of(form)
      do k = 1, size(labels)
        do at = 1, 6, 5
          if (labels(k) (at:at + 3) == '') cycle
          call t%check(is_parameter(law_forms(form)%kind, labels(k) (at:at + 3)), &
                       'names: '//trim(law_forms(form)%name)//' has '//labels(k) (at:at + 3))
        end do
      end do
    end do
    call t%check(.not. is_parameter(law_iqs, 'frictoin'), 'names: another name is none of a parameter')
  end subroutine test_names

  !> Can a parameter be set and read by this name?
  logical function is_parameter(kind, name)
    integer, intent(in) :: kind
    character(len=*), intent(in) :: name
    type(law_t) :: law

    law%kind = kind
    call set_parameter(law, name, 0.125_wp)
    is_parameter = .not. abs(get_parameter(law, name) - 0.125_wp) > 0
  end function is_parameter

  !> Elastic repulsion r_n = h k penetration at the end of the step, and the linear law.
  subroutine test_compliant()
    type(local_law_t) :: local

    local = local_law(law_t(kind=law_elastic, stiffness=1e4_wp), -0.02_wp, h, still, status_new)
    ! u' = u + gap/h + r/(k h^2) = 0 says r = -h k (gap + h u).
    call t%near(local%bias(1), -2.0_wp, rounding, 'elastic: bias')
    call t%near(local%compliance(1), 1.0_wp, rounding, 'elastic: compliance')
    call t%near(local%compliance(2), 0.0_wp, 0.0_wp, 'elastic: tangents are rigid')
    local = local_law(law_t(kind=law_linear, epsilon=0.5_wp), 0.02_wp, h, still, status_new)
    call t%check(local%is_linear, 'linear: no inequality')
    call t%near(maxval(abs(local%compliance - 0.5_wp)), 0.0_wp, 0.0_wp, 'linear: compliance in both directions')
    call t%near(maxval(abs(local%bias)), 0.0_wp, 0.0_wp, 'linear: the gap does not matter')
  end subroutine test_compliant

  !> Static friction while a contact sticks or is bonded, dynamic friction else.
  subroutine test_friction()
    integer(i1), parameter :: statuses(5) = [status_new, status_none, status_stick, status_slide, status_bonded]
    real(wp), parameter :: expected(5) = [0.3_wp, 0.3_wp, 0.6_wp, 0.3_wp, 0.6_wp]
    type(local_law_t) :: local
    integer :: i, kind

    do kind = law_iqs, law_elastic
      do i = 1, 5
        local = local_law(law_t(kind=kind, static_friction=0.6_wp, dynamic_friction=0.3_wp, stiffness=1.0_wp), 0.0_wp, h, &
                          still, statuses(i))
        call t%near(local%friction, expected(i), 0.0_wp, 'static and dynamic friction')
      end do
    end do
  end subroutine test_friction

  !> Laws whose gaps count from a reference, and the one with a dashpot, as solutions: r = -h (k (gap + h u) + eta u).
  subroutine test_shifted_gaps()
    real(wp), parameter :: stiffness = 3e4_wp, viscosity = 70.0_wp, speed = 0.4_wp
    integer, parameter :: counted(3) = [law_iqs_g0, law_gap_g0, law_elastic_g0], plain(3) = [law_iqs, law_gap, law_elastic]
    type(local_law_t) :: local, same
    real(wp) :: impulse
    integer :: i

    do i = 1, 3
      local = local_law(law_t(kind=counted(i), stiffness=stiffness), 0.03_wp, h, still, status_new, [0.02_wp])
      same = local_law(law_t(kind=plain(i), stiffness=stiffness), 0.01_wp, h, still, status_new)
      ! The gap of 0.01 is a difference of two.
      call t%near(local%bias(1), same%bias(1), 4*rounding, 'a gap counted from its first value')
      call t%near(local%compliance(1), same%compliance(1), 0.0_wp, 'compliance does not know of that value')
      call t%check(local%is_active .and. n_internal_of(law_t(kind=counted(i)), 2) == 1, 'active, with one value to keep')
      call t%equal(n_internal_of(law_t(kind=plain(i)), 2), 0, 'nothing to keep')
    end do
    local = local_law(law_t(kind=law_iqs_g0), 0.01_wp, h, still, status_new, [0.02_wp])
    call t%near(local%bias(1), 0.0_wp, 0.0_wp, 'quasi-shock: a gap below its first value is kept')
    local = local_law(law_t(kind=law_gap_shifted, gap_shift=0.005_wp), -0.02_wp, h, still, status_new)
    call t%near(local%bias(1), -1.5_wp, rounding, 'a shifted gap')
    local = local_law(law_t(kind=law_viscoelastic, stiffness=stiffness, viscosity=viscosity), 1e-9_wp, h, still, status_new)
    call t%check(.not. local%is_active, 'viscoelastic: waits for the gap to close')
    local = local_law(law_t(kind=law_viscoelastic, stiffness=stiffness, viscosity=viscosity), -0.02_wp, h, still, status_new)
    impulse = -h*(stiffness*(-0.02_wp + h*speed) + viscosity*speed)
    call t%near(speed + local%bias(1) + local%compliance(1)*impulse, 0.0_wp, 4*rounding, 'viscoelastic: spring and dashpot')
    call t%near(maxval(abs(first_internal(law_t(kind=law_iqs_g0), -0.1_wp, 2, 2) - 0)), 0.0_wp, 0.0_wp, 'first gap, overlap')
    call t%near(maxval(abs(first_internal(law_t(kind=law_gap_g0), -0.1_wp, 2, 2) - [-0.1_wp, 0.0_wp])), 0.0_wp, 0.0_wp, &
                'first gap with its sign')
  end subroutine test_shifted_gaps

  !> Which laws compact kernels serve, and which need no tangent.
  subroutine test_kinds()
    integer :: kind

    do kind = law_iqs, law_viscoelastic
      call t%check(is_plain(law_t(kind=kind)) .eqv. (kind <= law_restitution .or. &
                   any(kind == [law_iqs_g0, law_gap_g0, law_gap_shifted])), 'plain laws')
      call t%check(is_frictionless(law_t(kind=kind)) .eqv. all(kind /= [law_linear, law_bond]), 'laws without a tangent')
      call t%check(.not. is_frictionless(law_t(kind=kind, static_friction=0.1_wp)), 'static friction is friction')
      call t%check(.not. is_frictionless(law_t(kind=kind, dynamic_friction=0.1_wp)), 'dynamic friction is friction')
    end do
  end subroutine test_kinds

  !> One contact of a body with arms against a fixed one: one sweep solves it, for any coupling and friction.
  subroutine test_one_contact()
    real(wp), parameter :: frictions(7) = [0.0_wp, 0.1_wp, 0.5_wp, 1.0_wp, 2.0_wp, 10.0_wp, 100.0_wp]
    type(problem_t) :: problem
    type(random_t) :: random
    real(wp) :: worst, angle, arm(2)
    integer :: i, j, kind
    integer :: states(3)

    call random%seed(3)
    call reserve_problem(problem, arm_frictional, 2, 1)
    problem%pair(:, 1) = [1, 2]
    worst = 0
    states = 0
    do kind = 1, 2
      do i = 1, size(frictions)
        do j = 1, 300
          angle = random%uniform(0.0_wp, 6.3_wp)
          arm = [random%uniform(-2.0_wp, 2.0_wp), random%uniform(-2.0_wp, 2.0_wp)]
          problem%body(:, 1) = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), &
                                1.0_wp, 1.0_wp, 3.0_wp]
          problem%body(:, 2) = 0
          call set_record(problem%record(:, 1), problem%body(4:6, 1), angle, arm, frictions(i), real(kind, wp))
          problem%impulse(:, 1) = [random%uniform(0.0_wp, 1.0_wp), 0.0_wp]
          call solve_one(problem, frictions(i), real(kind - 1, wp), worst, states)
        end do
      end do
    end do
    ! Impulses of order one, friction up to 100 enters the natural map as a factor.
    call t%near(worst, 0.0_wp, 1e-11_wp, 'one contact: the natural map vanishes')
    call t%check(all(states > 200), 'one contact: open, sticking and sliding ones were all tried')
  end subroutine test_one_contact

  !> Record of a contact with a fixed body, seen from the free body's centre at an arm.
  pure subroutine set_record(record, inverse_mass, angle, arm, friction, law_kind)
    real(wp), intent(out) :: record(record_length(arm_frictional))
    real(wp), intent(in) :: inverse_mass(3), angle, arm(2), friction, law_kind
    real(wp) :: n(2), turn_n, turn_t

    n = [cos(angle), sin(angle)]
    turn_n = arm(1)*n(2) - arm(2)*n(1)
    turn_t = -arm(1)*n(1) - arm(2)*n(2)
    record = 0
    record(normal_x:arm_moment_tc) = [n, turn_n, turn_t]
    record(arm_bias_n:arm_bias_t) = [0.1_wp, -0.2_wp]
    record(arm_wnn:arm_wtt) = [inverse_mass(1) + turn_n**2*inverse_mass(3), turn_n*turn_t*inverse_mass(3), &
                    inverse_mass(1) + turn_t**2*inverse_mass(3)]
    record(arm_friction) = friction
    record(arm_cohesion:arm_compliance_t) = [0.05_wp, 0.3_wp, 0.4_wp]
    record([arm_wnn, arm_wtt]) = record([arm_wnn, arm_wtt]) + record(arm_compliance_n:arm_compliance_t)
    record(arm_law) = law_kind
  end subroutine set_record

  !> Solve by one sweep; note the natural map and what the contact does.
  subroutine solve_one(problem, friction, linear, worst, states)
    type(problem_t), intent(inout) :: problem
    real(wp), intent(in) :: friction, linear
    real(wp), intent(inout) :: worst
    integer, intent(inout) :: states(3)
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp) :: r(2)
    integer :: state

    solver%options%maximum_sweeps = 1
    solver%options%check_every = 1
    call solver%solve(problem, report)
    r = problem%impulse(:, 1)
    if (problem%kind == arm_frictional) r(1) = r(1) + problem%record(arm_cohesion, 1)
    worst = max(worst, maxval(abs(natural_map(r, compact_velocity(problem, 1), friction, 1.0_wp, linear)))/(1 + friction))
    state = 1
    if (r(1) > 0) state = merge(2, 3, abs(r(2)) < friction*r(1))
    states(state) = states(state) + 1
  end subroutine solve_one

  !> The same for a round contact, whose block is diagonal.
  subroutine test_one_round_contact()
    real(wp), parameter :: frictions(4) = [0.0_wp, 0.3_wp, 1.0_wp, 100.0_wp]
    type(problem_t) :: problem
    type(random_t) :: random
    real(wp) :: worst, angle
    integer :: i, j
    integer :: states(3)

    call random%seed(4)
    call reserve_problem(problem, round_frictional, 2, 1)
    problem%pair(:, 1) = [1, 2]
    worst = 0
    states = 0
    do i = 1, size(frictions)
      do j = 1, 300
        angle = random%uniform(0.0_wp, 6.3_wp)
        problem%body(:, 1) = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), &
                              1.0_wp, 1.0_wp, 2.0_wp]
        problem%body(:, 2) = [0.0_wp, 0.0_wp, 0.3_wp, 0.5_wp, 0.5_wp, 1.0_wp]
        problem%record(:, 1) = [cos(angle), sin(angle), 0.1_wp, -0.2_wp, 1/1.5_wp, 1/4.5_wp, frictions(i)]
        problem%impulse(:, 1) = 0
        call solve_one(problem, frictions(i), 0.0_wp, worst, states)
      end do
    end do
    call t%near(worst, 0.0_wp, 1e-14_wp, 'one round contact: the natural map vanishes')
    call t%check(all(states > 100), 'one round contact: open, sticking and sliding ones were all tried')
  end subroutine test_one_round_contact

  !> The natural map itself, by hand: zero at a solution, the distance to one elsewhere.
  subroutine test_natural_map()
    real(wp) :: f(2)

    f = natural_map([0.0_wp, 0.0_wp], [1.0_wp, 5.0_wp], 0.5_wp, 1.0_wp, 0.0_wp)
    call t%near(maxval(abs(f)), 0.0_wp, 0.0_wp, 'natural map: an open contact')
    f = natural_map([1.0_wp, 0.4_wp], [0.0_wp, 0.0_wp], 0.5_wp, 1.0_wp, 0.0_wp)
    call t%near(maxval(abs(f)), 0.0_wp, 0.0_wp, 'natural map: sticking')
    f = natural_map([2.0_wp, -1.0_wp], [0.0_wp, 3.0_wp], 0.5_wp, 1.0_wp, 0.0_wp)
    call t%near(maxval(abs(f)), 0.0_wp, rounding, 'natural map: sliding, against the motion')
    f = natural_map([2.0_wp, 1.0_wp], [0.0_wp, 3.0_wp], 0.5_wp, 1.0_wp, 0.0_wp)
    call t%check(maxval(abs(f)) > 0.1_wp, 'natural map: sliding, pushed along by friction, is no solution')
    f = natural_map([1.0_wp, 0.0_wp], [0.25_wp, 0.0_wp], 0.5_wp, 2.0_wp, 0.0_wp)
    call t%near(f(1), 0.5_wp, rounding, 'natural map: a contact that parts and pushes')
    f = natural_map([0.0_wp, 0.0_wp], [-0.25_wp, 0.0_wp], 0.0_wp, 2.0_wp, 0.0_wp)
    call t%near(f(1), -0.5_wp, rounding, 'natural map: a penetration velocity')
    f = natural_map([-3.0_wp, 7.0_wp], [0.25_wp, -0.5_wp], 0.0_wp, 2.0_wp, 1.0_wp)
    call t%near(maxval(abs(f - [0.5_wp, -1.0_wp])), 0.0_wp, rounding, 'natural map: linear laws ask u = 0')
  end subroutine test_natural_map

  !> The projection on Coulomb's cone against the one of the errors of matrices, which is written apart.
  subroutine test_cone()
    type(random_t) :: random
    real(wp) :: x, s, friction, normal, tangential, direction(2), nearest(2), worst
    integer :: i, places(3)

    call random%seed(7)
    worst = 0
    places = 0
    do i = 1, 3000
      x = merge(0.0_wp, random%normal(), modulo(i, 13) == 0)
      s = merge(0.0_wp, random%normal(), modulo(i, 11) == 0)
      friction = merge(0.0_wp, 3*random%uniform()**2, modulo(i, 10) == 0)
      direction = [cos(real(i, wp)), sin(real(i, wp))]
      nearest = project_on_cone([x, s], friction)
      call project(x, s, friction, normal, tangential)
      worst = max(worst, maxval(abs(nearest - [normal, tangential])))
      call project(x, abs(s), friction, normal, tangential)
      worst = max(worst, maxval(abs(project_on_cone([x, s*direction], friction) - [normal, sign(tangential, s)*direction])))
      if (maxval(abs(nearest)) <= 0) then
        places(1) = places(1) + 1
      else if (abs(s) <= friction*x) then
        places(2) = places(2) + 1
      else
        places(3) = places(3) + 1
      end if
    end do
    call t%near(worst, 0.0_wp, 4*rounding, 'projection on the cone: two ways')
    call t%check(all(places > 300), 'projection on the cone: tip, inside and surface were all tried')
  end subroutine test_cone
end program test_laws
