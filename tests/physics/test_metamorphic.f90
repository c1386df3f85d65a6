!> Metamorphic tests: the same scene described otherwise moves the same way.
!!
!! Random scenes of a few bodies that fall on a floor and on each other are translated, turned, mirrored, measured in other
!! units, reordered, joined by a body that touches nothing, given friction 1e-13 in place of none, built of other shapes, taken
!! from the plane into space, and solved by each method. What the bodies do, brought back, is what they do in the first scene.
!! Nothing has to be known of the right answer. Called with a number, it makes as many rounds instead of two.
program test_metamorphic
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use recipes, only: build, end_state, in_space, map_t, mapped, random_recipe, recipe_t, shape_box, shape_capsule, shape_disk, &
                     shape_dumbbell, shape_pair, shape_polygon, shape_prism, shape_segment, shape_slab, shape_sphere, &
                     turned_at_random
  use scenes, only: run
  use sg_kinds, only: wp
  use sg_laws, only: law_iqs, law_restitution
  use sg_random, only: random_t
  use sg_methods, only: solver_names
  use sg_simulation, only: simulation_t
  implicit none
  !> Most steps of a run
  integer, parameter :: most_steps = 50
  !> Solver: e8. Of positions [m] and velocities [m/s, rad/s]: it leaves 1e-12 in each step, which impacts at arms of some
  !! decimetres multiply a few times each
  real(wp), parameter :: tolerance = 1e-12_wp, same = 1e-7_wp
  !> Solvers are compared where the e8 of each step is below this: matrix solvers go by e1, down to 1e-13, which leaves e8 of 1e-11
  real(wp), parameter :: solved = 1e-10_wp
  !> What is left to be done is up to e8 times the sweeps that a step takes (doc/theory/errors.md), some thousands, of velocities of
  !! about 1 m/s, in each of 50 steps: 1e-5
  real(wp), parameter :: same_by_matrices = 1e-5_wp
  !> Solvers; scenes in which solver i of `methods` left a step unsolved; all scenes
  character(len=16), allocatable :: methods(:)
  integer, allocatable :: n_unconverged(:)
  integer :: n_scenes
  type(tests_t) :: t
  type(random_t) :: random
  character(len=40) :: name
  integer :: round, rounds, kind, n_moved, n_steps

  rounds = rounds_asked()
  n_moved = 0
  n_scenes = 0
  methods = solver_names()
  allocate (n_unconverged(size(methods)), source=0)
  do round = 1, rounds
    call random%seed(round)
    do kind = 1, 3
      call try_scenes('disks', 2, [shape_disk], kind)
      call try_scenes('plane', 2, [shape_disk, shape_polygon, shape_pair], kind)
      call try_scenes('segments', 2, [shape_disk, shape_segment, shape_polygon], kind)
      call try_scenes('spheres', 3, [shape_sphere], kind)
      call try_scenes('space', 3, [shape_sphere, shape_box, shape_prism, shape_dumbbell], kind)
      call try_scenes('cylinders', 3, [shape_sphere, shape_capsule, shape_dumbbell], kind)
    end do
  end do
  call t%check(n_moved >= 10*rounds, 'bodies meet')
  do kind = 1, size(methods)
    call t%check(n_unconverged(kind) <= 1 + n_scenes/20, 'steps are solved by '//trim(methods(kind)))
  end do
  deallocate (methods, n_unconverged)
  call t%finish()

contains

  !> Number of rounds from the command line.
  integer function rounds_asked() result(rounds)
    character(len=20) :: word
    integer :: status

    rounds = 2
    call get_command_argument(1, word)
    if (len_trim(word) == 0) return
    read (word, *, iostat=status) rounds
    if (status /= 0) error stop 'usage: test_metamorphic [ROUNDS]'
  end function rounds_asked

  !> One scene and all that is made of it, without friction, with static and dynamic friction, and with restitution.
  subroutine try_scenes(family, dimension, shapes, kind)
    character(len=*), intent(in) :: family
    integer, intent(in) :: dimension, shapes(:), kind
    type(recipe_t) :: recipe, other
    real(wp), allocatable :: state(:, :), free(:, :)
    logical :: is_solved

    write (name, '(a,i0,a,i0)') family//', law ', kind, ', round ', round
    recipe = random_recipe(random, dimension, shapes)
    recipe%law%kind = merge(law_restitution, law_iqs, kind == 3)
    recipe%law%normal_restitution = merge(0.4_wp, 0.0_wp, kind == 3)
    recipe%law%static_friction = merge(0.0_wp, 0.3_wp, kind == 1)
    recipe%law%dynamic_friction = 0.7_wp*recipe%law%static_friction
    call count_steps(recipe)
    state = outcome(recipe, is_solved=is_solved)
    other = recipe
    other%gravity = 0
    free = outcome(other)
    if (maxval(abs(free - state)) > 0.1_wp) n_moved = n_moved + 1
    call try_maps(recipe, state)
    call try_order(recipe, state)
    call try_company(recipe, state)
    ! Segments touch no segments, and cylinders no boxes.
    if (.not. any(shapes == shape_segment .or. shapes == shape_capsule)) call try_floor(recipe, state)
    if (kind == 1) call try_friction(recipe, state)
    if (family == 'disks') call try_space(recipe, state)
    call try_solvers(recipe, state, is_solved)
  end subroutine try_scenes

  !> Steps in which the motion is determined: with friction in space, until a face rests on three points or more, whose forces and
  !! so whose friction torque have many solutions.
  subroutine count_steps(recipe)
    type(recipe_t), intent(in) :: recipe
    type(simulation_t), pointer :: sim
    integer :: k, j, points

    sim => fresh()
    n_steps = most_steps
    if (recipe%dimension == 2 .or. .not. recipe%law%static_friction > 0) return
    call build(recipe, tolerance, sim)
    do n_steps = 1, most_steps - 1
      call run(sim, 1)
      points = 0
      do k = 1, sim%contacts%n
        points = max(points, count([(all(sim%contacts%body(:, k) == sim%contacts%body(:, j)) .and. &
                                     norm2(sim%contacts%impulse(:, j)) > 0, j=1, sim%contacts%n)]))
      end do
      if (points > 2) exit
    end do
    n_steps = n_steps - 1
  end subroutine count_steps

  !> What bodies do in a scene, brought back through a map, and whether each step is solved.
  function outcome(recipe, map, place, method, is_solved) result(state)
    type(recipe_t), intent(in) :: recipe
    type(map_t), intent(in), optional :: map
    integer, intent(in), optional :: place(:)
    character(len=*), intent(in), optional :: method
    logical, intent(out), optional :: is_solved
    real(wp), allocatable :: state(:, :)
    type(simulation_t), pointer :: sim
    type(map_t) :: back
    logical :: solved_all
    integer :: i

    sim => fresh()
    if (present(map)) back = map
    if (present(method)) sim%options%solver%method = method
    call build(recipe, tolerance, sim)
    solved_all = .true.
    do i = 1, n_steps
      call run(sim, 1)
      solved_all = solved_all .and. sim%report%e8 <= solved
    end do
    if (present(is_solved)) is_solved = solved_all
    state = end_state(sim, back, place)
  end function outcome

  !> Compare two outcomes.
  subroutine compare(state, other, within, what)
    real(wp), intent(in) :: state(:, :), other(:, :), within
    character(len=*), intent(in) :: what

    call t%near(maxval(abs(state - other)), 0.0_wp, within, trim(name)//': '//what)
  end subroutine compare

  !> Moved, turned, mirrored, in other units, and all at once.
  subroutine try_maps(recipe, state)
    type(recipe_t), intent(in) :: recipe
    real(wp), intent(in) :: state(:, :)
    type(map_t) :: map
    integer :: i

    map%shift(:recipe%dimension) = [(random%uniform(-5.0_wp, 5.0_wp), i=1, recipe%dimension)]
    call compare(state, outcome(mapped(recipe, map), map), same, 'translated')
    map = turned_at_random(random, recipe%dimension)
    call compare(state, outcome(mapped(recipe, map), map), same, 'turned')
    map = map_t()
    map%turn(1, 1) = -1
    call compare(state, outcome(mapped(recipe, map), map), same, 'mirrored')
    map = map_t(length=1e-3_wp, time=7.0_wp, mass=1e-5_wp)
    call compare(state, outcome(mapped(recipe, map), map), same, 'in other units')
    map = turned_at_random(random, recipe%dimension)
    map%turn(:, 1) = -map%turn(:, 1)
    map%shift(:2) = [300.0_wp, -20.0_wp]
    map%length = 100
    map%mass = 3
    call compare(state, outcome(mapped(recipe, map), map), same, 'moved, turned, mirrored, in other units')
  end subroutine try_maps

  !> Bodies in another order.
  subroutine try_order(recipe, state)
    type(recipe_t), intent(in) :: recipe
    real(wp), intent(in) :: state(:, :)
    type(recipe_t) :: other
    integer :: order(size(recipe%bodies)), place(size(recipe%bodies)), b

    order = [(b, b=1, size(order))]
    call random%shuffle(order)
    other = recipe
    do b = 1, size(order)
      other%bodies(b) = recipe%bodies(order(b))
      place(order(b)) = b
    end do
    call compare(state, outcome(other, place=place), same, 'reordered')
  end subroutine try_order

  !> A body more that touches nothing: a fixed one, and a free one of another shape, with which the plan may leave out less.
  subroutine try_company(recipe, state)
    type(recipe_t), intent(in) :: recipe
    real(wp), intent(in) :: state(:, :)
    type(recipe_t) :: other
    integer :: n, b

    n = size(recipe%bodies)
    other = recipe
    other%bodies = [recipe%bodies, recipe%bodies(1)]
    associate (more => other%bodies(n + 1))
      more%shape = merge(shape_segment, shape_box, recipe%dimension == 2)
      more%position = more%position + [40.0_wp, 0.0_wp, 0.0_wp]
      call compare(state, outcome(other, place=[(b, b=1, n)]), same, 'with a free body more')
      more%is_fixed = .true.
      more%velocity = 0
      more%spin = 0
      call compare(state, outcome(other, place=[(b, b=1, n)]), same, 'with a fixed body more')
    end associate
  end subroutine try_company

  !> Another shape with the same upper face as the floor: a segment or a polygon, a plane or a box.
  subroutine try_floor(recipe, state)
    type(recipe_t), intent(in) :: recipe
    real(wp), intent(in) :: state(:, :)
    type(recipe_t) :: other

    other = recipe
    other%bodies(size(recipe%bodies))%shape = shape_slab
    call compare(state, outcome(other), same, 'on a floor of another shape')
  end subroutine try_floor

  !> Friction of next to nothing in place of none.
  subroutine try_friction(recipe, state)
    type(recipe_t), intent(in) :: recipe
    real(wp), intent(in) :: state(:, :)
    type(recipe_t) :: other

    other = recipe
    other%law%static_friction = 1e-13_wp
    other%law%dynamic_friction = 1e-13_wp
    call compare(state, outcome(other), same, 'friction 1e-13')
  end subroutine try_friction

  !> Disks as spheres that move in a plane.
  subroutine try_space(recipe, state)
    type(recipe_t), intent(in) :: recipe
    real(wp), intent(in) :: state(:, :)
    real(wp), allocatable :: other(:, :)

    other = outcome(in_space(recipe))
    ! The plane's y is the upright z; a turn from x to y is one from x to z, against the axis of y.
    other(8, :) = -other(8, :)
    call compare(state([1, 2, 4, 5, 9], :), other([1, 3, 4, 6, 8], :), same, 'in space')
    call compare(0.0_wp*other([2, 5, 7, 9], :), other([2, 5, 7, 9], :), same, 'in space, across')
  end subroutine try_space

  !> Each solver: those that solve all steps find the same answer.
  subroutine try_solvers(recipe, state, is_solved)
    type(recipe_t), intent(in) :: recipe
    real(wp), intent(in) :: state(:, :) !! by the default solver
    logical, intent(in) :: is_solved !! are all its steps solved?
    real(wp), allocatable :: reference(:, :), other(:, :)
    logical :: has_reference, other_is_solved
    integer :: i

    n_scenes = n_scenes + 1
    reference = state
    has_reference = is_solved
    do i = 1, size(methods)
      other = outcome(recipe, method=trim(methods(i)), is_solved=other_is_solved)
      if (.not. other_is_solved) then
        n_unconverged(i) = n_unconverged(i) + 1
      else if (has_reference) then
        call compare(reference, other, same_by_matrices, 'by '//trim(methods(i)))
      else
        reference = other
        has_reference = .true.
      end if
    end do
  end subroutine try_solvers
end program test_metamorphic
