!> Interior points on several ranks, as the guess of the dual method (doc/theory/interior_point.md, "Several ranks").
!!
!! The convex problem, without the shift of Coulomb's law, has symmetric systems, which subdomains factorise. Without friction its
!! solution is that of the step, and the rounds that follow find nothing left to do; with friction they lead on from there.
module sg_interior_point_ranks
  use sg_block_map, only: natural_map
  use sg_comm, only: comm_t, traffic_t
  use sg_dual, only: dual_t
  use sg_interior_point_step, only: point_t, start_point, take_step
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_problem, only: problem_t
  use sg_rank_system, only: rank_system_t
  use sg_report, only: report_t
  use sg_sparse, only: multiply_transposed
  use sg_subdomain, only: subdomain_t
  use sg_subdomain_matrices, only: subdomain_matrices_t
  implicit none
  private
  public :: interior_ranks_t

  !> A step of a shorter length ends the path
  real(wp), parameter :: least_length = 1e-3_wp
  !> Where a step leaves more of the complementarity, directions are to be more accurate from then on
  real(wp), parameter :: little_fall = 0.5_wp

  !> The solver
  type, extends(dual_t) :: interior_ranks_t
    !> Most steps; error of the convex problem, over the tolerance of the step and over that of Coulomb's problem, at which they end
    integer :: most_steps = 80
    real(wp) :: finer = 1e-2_wp, convex_part = 0.1_wp
    !> Least error of the convex problem that is asked for: rounding is near
    real(wp) :: least_error = 1e-12_wp
    !> Steps of this solve, and iterations of their conjugate gradients
    integer, private :: steps = 0, iterations = 0
    !> Linear systems, whose messages are kept between solves
    type(rank_system_t), private :: system
  contains
    procedure :: open => ranks_open
    procedure :: finish_round => ranks_finish_round
  end type interior_ranks_t

contains

  !> Begin as the dual method does, from impulses that interior points find.
  subroutine ranks_open(self, problem, coupling, comm)
    class(interior_ranks_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: impulse(:, :), free(:, :)
    logical :: is_found

    free = problem%body
    impulse = problem%impulse
    problem%impulse = 0
    call self%dual_t%open(problem, coupling, comm)
    call find_impulses(self, problem, coupling, free, impulse, is_found, comm)
    problem%body = free
    problem%impulse = impulse
    call open_again(self, problem, coupling, comm)
  end subroutine ranks_open

  !> Begin as the dual method does, from impulses.
  subroutine open_again(self, problem, coupling, comm)
    class(interior_ranks_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part, with whole masses
    type(subdomain_t), intent(in) :: coupling
    type(comm_t), intent(inout) :: comm

    call self%sets%begin(problem, self%options)
    call self%sets%nesterov%begin(self%has_momentum)
    call self%dual_t%open(problem, coupling, comm)
  end subroutine open_again

  !> Note the errors of the impulses of a step in the history. What is sent to open the dual method for that is not counted as sent
  !! by the solve. Collective.
  subroutine note_step(self, problem, coupling)
    class(interior_ranks_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part, with whole masses, free velocities and these impulses
    type(subdomain_t), intent(in) :: coupling
    type(comm_t) :: comm
    type(traffic_t) :: before

    comm = self%system%comm
    before = comm%traffic
    call open_again(self, problem, coupling, comm)
    call self%prepare_errors(problem, comm)
    comm%traffic = before
    call self%note(problem, comm, report_t())
    self%system%comm = comm
  end subroutine note_step

  !> Solve the convex problem. Collective.
  subroutine find_impulses(self, problem, coupling, free, impulse, is_found, comm)
    class(interior_ranks_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part, with divided masses and no impulses
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    real(wp), intent(in) :: free(:, :) !! bodies with whole masses and free velocities
    real(wp), intent(inout) :: impulse(:, :) !! guess, kept where there is nothing better, then impulses
    logical, intent(out) :: is_found !! are they?
    type(comm_t), intent(inout) :: comm
    type(subdomain_matrices_t) :: matrices
    type(matrix_problem_t) :: scaled
    type(point_t) :: point
    type(problem_t) :: traced
    real(wp), allocatable :: scale(:)
    real(wp) :: length, before

    self%steps = 0
    self%iterations = 0
    associate (interface => self%system%interface)
      call interface%find(problem%pair(:, :problem%n_contacts), problem%body(:, :problem%n_bodies), self%width, coupling, comm)
      call matrices%take(problem, interface%slot)
    end associate
    is_found = .not. comm%any(.not. is_convex(matrices)) .and. comm%any(size(matrices%contact) > 0)
    if (.not. is_found) return
    associate (system => self%system)
      call begin_system(self, coupling, matrices, comm)
      call scale_matrices(matrices, scaled, scale, system)
      system%h = matrices%h
      call matrices%prepare_factor(system%interface%slot, self%width, system%factor)
      call start_point(scaled, system, point, is_found)
      do while (is_found .and. self%steps < self%most_steps)
        if (is_solved(self, scaled, system, point)) exit
        before = point%tau
        call take_step(scaled, system, point, length, is_found)
        self%steps = self%steps + 1
        if (self%with_trace) then
          traced = problem
          traced%body = free
          call bring_back(matrices, point%r, scale, traced%impulse)
          call note_step(self, traced, coupling)
        end if
        if (length < least_length .or. system%cg%failures > 0) exit
        if (point%tau > little_fall*before) call system%tighten()
      end do
      self%iterations = system%cg%iterations
      call system%factor%free()
      comm = system%comm
    end associate
    if (is_found) call bring_back(matrices, point%r, scale, impulse)
  end subroutine find_impulses

  !> Take masses and ranks, and prepare sums over copies.
  subroutine begin_system(self, coupling, matrices, comm)
    class(interior_ranks_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    type(subdomain_matrices_t), intent(in) :: matrices
    type(comm_t), intent(in) :: comm

    associate (system => self%system)
      system%is_global = .true.
      system%width = self%width
      system%mass = matrices%mass
      call system%begin()
      call system%interface%prepare_sums(coupling, comm)
      system%comm = comm
    end associate
  end subroutine begin_system

  !> Can all laws of a subdomain be written as cones without cohesion?
  pure logical function is_convex(matrices)
    type(subdomain_matrices_t), intent(in) :: matrices
    integer :: k

    is_convex = .true.
    do k = 1, size(matrices%contacts)
      associate (contact => matrices%contacts(k))
        if (contact%is_linear .or. contact%is_bonded .or. any(contact%compliance > 0)) is_convex = .false.
        if (abs(contact%cohesion) > 0) is_convex = .false.
      end associate
    end do
  end function is_convex

  !> The problem without units, as `scale_problem` makes it, of H_E. Collective.
  subroutine scale_matrices(matrices, scaled, scale, system)
    type(subdomain_matrices_t), intent(inout) :: matrices !! columns of H_E are scaled
    type(matrix_problem_t), intent(out) :: scaled !! without W
    real(wp), allocatable, intent(out) :: scale(:) !! impulse that 1 stands for [N s]
    type(rank_system_t), intent(inout) :: system
    real(wp) :: q(size(matrices%offset)), w(size(matrices%offset)), sums(2)
    integer :: k, i, d

    d = matrices%d
    scaled%d = d
    scaled%n = size(matrices%contact)
    scaled%friction = [(matrices%contacts(k)%friction, k=1, scaled%n)]
    call multiply_transposed(matrices%h, matrices%velocity, q)
    q = q + matrices%offset
    w = 0
    do i = 1, matrices%h%n_rows
      associate (first => matrices%h%first(i), last => matrices%h%first(i + 1) - 1)
        do k = first, last
          associate (place => matrices%h%column(k))
            w(place) = w(place) + matrices%h%value(k)**2/matrices%mass(i)
          end associate
        end do
      end associate
    end do
    scale = sum(reshape(w, [d, scaled%n]), 1)/real(d, wp)
    sums = [sum(scale), real(scaled%n, wp)]
    call system%add_up(sums)
    where (.not. scale > epsilon(sums)**2*sums(1)/sums(2)) scale = max(sums(1)/sums(2), tiny(sums))
    scale = 1/sqrt(scale)
    scaled%q = reshape(q, [d, scaled%n])
    do k = 1, scaled%n
      scaled%q(:, k) = scale(k)*scaled%q(:, k)
      if (.not. matrices%contacts(k)%has_tangent) scaled%q(2:, k) = 0
    end do
    matrices%h%value = matrices%h%value*scale((matrices%h%column - 1)/d + 1)
    sums = [sum(scaled%q**2), real(scaled%n, wp)]
    call system%add_up(sums)
    sums(1) = sqrt(sums(1)/sums(2))
    if (.not. sums(1) > 0) sums(1) = 1
    scaled%q = scaled%q/sums(1)
    scale = scale*sums(1)
  end subroutine scale_matrices

  !> Is the convex problem solved as closely as the step asks for, or as is of use? Collective.
  logical function is_solved(self, scaled, system, point)
    class(interior_ranks_t), intent(in) :: self
    type(matrix_problem_t), intent(in) :: scaled
    type(rank_system_t), intent(inout) :: system
    type(point_t), intent(in) :: point
    real(wp) :: f(scaled%d, scaled%n), u(scaled%d, scaled%n), squares(3)
    integer :: a

    ! That of Coulomb adds friction |u_T| to u_N; that without takes it off before.
    call natural_map(scaled%friction, 1.0_wp, point%r, point%u, f)
    squares(2) = sum(f**2)
    u = point%u
    do a = 1, scaled%n
      u(1, a) = u(1, a) - scaled%friction(a)*norm2(u(2:, a))
    end do
    call natural_map(scaled%friction, 1.0_wp, point%r, u, f)
    squares(1) = sum(f**2)
    squares(3) = sum(point%r**2)
    call system%add_up(squares)
    is_solved = squares(1) <= max(self%least_error, self%finer*self%options%tolerance)**2*squares(3) .or. &
                squares(1) < self%convex_part**2*squares(2)
  end function is_solved

  !> Impulses of the contacts of the problem.
  pure subroutine bring_back(matrices, r, scale, impulse)
    type(subdomain_matrices_t), intent(in) :: matrices
    real(wp), intent(in) :: r(:, :), scale(:)
    real(wp), intent(inout) :: impulse(:, :)
    integer :: k

    impulse = 0
    do k = 1, size(matrices%contact)
      associate (one => impulse(:, matrices%contact(k)))
        if (size(one) == 3) then
          one = matmul(scale(k)*r(:, k), matrices%contacts(k)%h(:, 1:3, 1))
        else
          one = scale(k)*r(:size(one), k)
        end if
      end associate
    end do
  end subroutine bring_back

  !> A round of the dual method; the report counts the steps before.
  subroutine ranks_finish_round(self, problem, is_cut, comm, report)
    class(interior_ranks_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: is_cut !! only glue
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! contact updates are counted

    call self%dual_t%finish_round(problem, is_cut, comm, report)
    report%iterations = self%iterations
    report%factorisations = self%steps
    report%failed_factors = self%system%factor%failures
    report%failed_systems = self%system%cg%failures
  end subroutine ranks_finish_round
end module sg_interior_point_ranks
