!> Contraction matrices of the dual and of the enriched interface: a closed form, relations between them, and contacts that hold.
program test_contraction
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, hold, put_disk, run
  use scenes_space, only: begin_space_scene, put_sphere
  use sg_contraction, only: contraction_t
  use sg_eigenvalues, only: eigenvalues_are_available, find_eigenvalues
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_laws, only: law_linear
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: radius = 0.5_wp
  type(tests_t) :: t
  type(random_t) :: random
  integer :: dimension

  call random%seed(8)
  do dimension = 2, 3
    call test_chain(dimension)
    call test_relations(dimension, .true.)
    call test_relations(dimension, .false.)
    call test_holding(dimension)
  end do
  call test_fixed()
  call test_eigenvalues()
  call t%finish()

contains

  !> Begin a scene of n grains with the linear law.
  subroutine begin(sim, dimension, n, is_along_normal)
    type(simulation_t), pointer, intent(out) :: sim
    integer, intent(in) :: dimension, n
    logical, intent(in) :: is_along_normal

    sim => fresh()
    if (dimension == 2) call begin_scene(sim%scene, n, 0.0_wp, 0.3_wp*radius)
    if (dimension == 3) call begin_space_scene(sim%scene, n, 0.0_wp, 0.3_wp*radius)
    sim%scene%gravity = 0
    sim%scene%laws(1)%kind = law_linear
    sim%scene%laws(1)%epsilon = 1
    sim%scene%laws(1)%is_along_normal = is_along_normal
  end subroutine begin

  !> Put a grain.
  subroutine put(sim, dimension, b, position)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: dimension, b
    real(wp), intent(in) :: position(3)

    if (dimension == 2) call put_disk(sim%scene, b, radius, position(:2))
    if (dimension == 3) call put_sphere(sim%scene, b, radius, position)
  end subroutine put

  !> Assemble the problem, and build the matrices of grains split by their numbers.
  subroutine build(sim, n_subdomains, contraction)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n_subdomains
    type(contraction_t), intent(out) :: contraction
    integer :: n, i

    call begin_run(sim, 1e-9_wp, 1e-12_wp)
    call run(sim, 1)
    n = sim%scene%bodies%n
    associate (owner => [(int((i - 1)*n_subdomains/n, i4), i=1, n)])
      call contraction%build(sim%problem, owner(sim%pairs%body_of), n_subdomains)
    end associate
  end subroutine build

  !> Three grains in a row, the middle one shared: of its two copies of half the mass, Y = 2 (2/m)^2/(3/m + epsilon) along the row
  !! and X = 4/m, so that B has one eigenvalue 2/(3 + m epsilon).
  subroutine test_chain(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    type(contraction_t) :: contraction
    type(error_t), allocatable :: error
    real(wp), allocatable :: b(:, :)
    real(wp) :: along(3), m, trace
    integer :: i

    along = [0.6_wp, 0.8_wp, 0.0_wp]
    if (dimension == 3) along = [2.0_wp, 3.0_wp, 6.0_wp]/7
    call begin(sim, dimension, 3, .true.)
    do i = 1, 3
      call put(sim, dimension, i, 2*radius*real(i, wp)*along)
    end do
    ! Contacts between subdomains 0 and 1 belong to 0, so that grain 2, of subdomain 1, has copies in both.
    call begin_run(sim, 1e-9_wp, 1e-12_wp)
    call run(sim, 1)
    associate (owner => [0_i4, 1_i4, 1_i4])
      call contraction%build(sim%problem, owner(sim%pairs%body_of), 2)
    end associate
    m = sim%scene%bodies%mass(1)
    call t%equal(contraction%shared, 1, 'chain: shared bodies')
    call t%equal(contraction%unknowns, merge(3, 6, dimension == 2), 'chain: unknowns')
    call t%near(contraction%epsilon_0, 2/m, 1e-12_wp/m, 'chain: mean diagonal of W')
    call contraction%dual(0.3_wp/m, b, error)
    trace = sum([(b(i, i), i=1, size(b, 1))])
    call t%near(trace, 2/3.3_wp, 1e-12_wp, 'chain: eigenvalue')
    call t%near(sum(b*transpose(b)), (2/3.3_wp)**2, 1e-12_wp, 'chain: no other eigenvalue')
  end subroutine test_chain

  !> Random piles in several subdomains: nothing is left after one iteration with eta = epsilon, a large eta is the dual method, and
  !! with S_epsilon = X - Y_epsilon of all iterations 1 - B_epsilon = X^-1 S_epsilon, 1 - B_epsilon,eta = S_eta^-1 S_epsilon.
  subroutine test_relations(dimension, is_along_normal)
    integer, intent(in) :: dimension
    logical, intent(in) :: is_along_normal
    real(wp), parameter :: same = 1e-9_wp
    type(simulation_t), pointer :: sim
    type(contraction_t) :: contraction
    type(error_t), allocatable :: error
    real(wp), allocatable :: one(:, :), b(:, :), other(:, :), third(:, :)
    real(wp) :: epsilon, eta
    integer :: i

    call make_pile(sim, dimension, is_along_normal)
    call build(sim, 3, contraction)
    call t%check(contraction%unknowns > 6, 'relations: an interface')
    epsilon = 0.3_wp*contraction%epsilon_0
    eta = 2*contraction%epsilon_0
    allocate (one(contraction%unknowns, contraction%unknowns), source=0.0_wp)
    do i = 1, size(one, 1)
      one(i, i) = 1
    end do
    call contraction%enriched(epsilon, epsilon, b, error)
    call t%near(maxval(abs(b)), 0.0_wp, same, 'relations: one iteration with eta = epsilon')
    call contraction%dual(epsilon, b, error)
    call contraction%enriched(epsilon, 1e12_wp*epsilon, other, error)
    call t%near(maxval(abs(b - other)), 0.0_wp, same, 'relations: a large eta is the dual method')
    call contraction%enriched(epsilon, eta, other, error)
    call contraction%dual(eta, third, error)
    call t%near(maxval(abs(matmul(one - third, one - other) - (one - b))), 0.0_wp, same, 'relations: dual and enriched')
    call contraction%enriched(eta, epsilon, third, error)
    call t%near(maxval(abs(matmul(one - third, one - other) - one)), 0.0_wp, same, 'relations: one and its inverse')
  end subroutine test_relations

  !> Contacts that all hold are linear interactions with epsilon = 0; where none holds the dual method has nothing to do.
  subroutine test_holding(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    type(contraction_t) :: contraction
    type(error_t), allocatable :: error
    real(wp), allocatable :: b(:, :), other(:, :)
    real(wp) :: none, rigid
    logical, allocatable :: no(:)
    integer :: i

    call begin(sim, dimension, 4, .true.)
    do i = 1, 4
      call put(sim, dimension, i, radius*[2.0_wp*real(i, wp), 0.7_wp*real(mod(i, 2), wp), 0.0_wp])
    end do
    call build(sim, 2, contraction)
    allocate (no(contraction%contacts), source=.false.)
    call contraction%hold(sim%problem, .not. no, no)
    call t%equal(contraction%holding, contraction%contacts, 'holding: all')
    call contraction%dual_held(b, error)
    call contraction%dual(1e-9_wp*contraction%epsilon_0, other, error)
    call t%near(maxval(abs(b - other)), 0.0_wp, 1e-7_wp, 'holding: rigid interactions')
    rigid = 1e-3_wp*contraction%epsilon_0
    call contraction%enriched_held(rigid, b, error)
    call contraction%enriched(1e-9_wp*contraction%epsilon_0, rigid, other, error)
    call t%near(maxval(abs(b - other)), 0.0_wp, 1e-5_wp, 'holding: rigid interactions, enriched')
    call build(sim, 2, contraction)
    call contraction%hold(sim%problem, no, no)
    call contraction%dual_held(b, error)
    none = maxval(abs(b))
    call t%near(none, 0.0_wp, 0.0_wp, 'holding: none')
  end subroutine test_holding

  !> A fixed grain is no unknown, and a subdomain without contacts adds nothing.
  subroutine test_fixed()
    type(simulation_t), pointer :: sim
    type(contraction_t) :: contraction
    integer :: i

    call begin(sim, 2, 3, .true.)
    do i = 1, 3
      call put(sim, 2, i, 2*radius*[real(i, wp), 0.0_wp, 0.0_wp])
    end do
    call hold(sim%scene, 2)
    call build(sim, 3, contraction)
    call t%equal(contraction%unknowns, 0, 'fixed: no unknown')
    call t%equal(size(contraction%subdomain), 3, 'fixed: subdomains')
  end subroutine test_fixed

  !> A random pile of grains that overlap as they may.
  subroutine make_pile(sim, dimension, is_along_normal)
    type(simulation_t), pointer, intent(out) :: sim
    integer, intent(in) :: dimension
    logical, intent(in) :: is_along_normal
    integer, parameter :: n = 9
    real(wp) :: shift(3)
    integer :: b

    call begin(sim, dimension, n, is_along_normal)
    do b = 1, n
      shift = 0.1_wp*radius*[random%uniform(), random%uniform(), random%uniform()]
      call put(sim, dimension, b, 2*radius*[real(mod(b - 1, 3), wp), real((b - 1)/3, wp), 0.0_wp] + shift)
    end do
  end subroutine make_pile

  !> A turn by a right angle, scaled: two imaginary eigenvalues; and a real one next to them.
  subroutine test_eigenvalues()
    real(wp) :: matrix(3, 3)
    complex(wp) :: values(3)
    type(error_t), allocatable :: error

    matrix = 0
    matrix(1, 2) = -2
    matrix(2, 1) = 2
    matrix(3, 3) = -5
    call find_eigenvalues(matrix, values, error)
    call t%check(allocated(error) .neqv. eigenvalues_are_available(), 'eigenvalues: found, or refused in one sentence')
    if (allocated(error)) return
    call t%near(maxval(abs(values)), 5.0_wp, 1e-14_wp, 'eigenvalues: the largest')
    call t%near(maxval(aimag(values)), 2.0_wp, 1e-14_wp, 'eigenvalues: the imaginary ones')
    call t%near(real(sum(values)), -5.0_wp, 1e-14_wp, 'eigenvalues: their sum')
  end subroutine test_eigenvalues
end program test_contraction
