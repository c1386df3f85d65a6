!> Interface impulses by preconditioned conjugate gradients: those under which copies of shared bodies get one velocity, when each
!! subdomain answers by its factor (doc/theory/enriched.md).
!!
!! Unknowns are values of copies that add up to nothing over the copies of a body, l_E = A_E^T F, so that any number of subdomains
!! may share a body. With P the projection on these (`balance` of the interface) the system is P S P l = P v, where S holds the
!! inverses of the subdomains' matrices on shared bodies. It is X_eta F = sum A_E v_E, and is never formed. One iteration has two
!! sums over copies and two sums of one number over all ranks.
module sg_interface_cg
  use sg_comm, only: comm_t
  use sg_dense_factor, only: dense_cholesky, dense_cholesky_solve
  use sg_interface, only: interface_t
  use sg_kinds, only: wp
  use sg_subdomain_factor, only: by_schur, subdomain_factor_t
  implicit none
  private
  public :: interface_cg_t, project

  !> Conjugate gradients for interface impulses
  type :: interface_cg_t
    !> Preconditioner; when to stop: energy of the velocities by which copies differ, over that at the beginning, square root of
    integer :: preconditioner = by_schur
    real(wp) :: tolerance = 1e-2_wp
    integer :: most_iterations = 500
    !> Iterations so far, and solves that ended above the tolerance
    integer :: iterations = 0, failures = 0
    !> Blocks of subdomains' matrices that belong to one shared body each, and Cholesky factors of their sums over copies, shape
    !! (width, width, shared bodies); not allocated where all copies have the same weight
    real(wp), allocatable, private :: block(:, :, :), total(:, :, :)
  contains
    procedure :: solve => cg_solve
    procedure :: weigh => cg_weigh
  end type interface_cg_t

contains

  !> Find the interface impulses that take differences between velocities of copies away. Collective.
  subroutine cg_solve(self, interface, factor, velocity, impulse, comm)
    class(interface_cg_t), intent(inout) :: self
    type(interface_t), intent(inout) :: interface !! shared bodies; its sums are prepared
    type(subdomain_factor_t), intent(inout) :: factor !! of this subdomain
    real(wp), intent(inout) :: velocity(:, :) !! differences between copies, projected; then those that are left
    real(wp), intent(out) :: impulse(:, :) !! l_E: taken off, they make velocities of copies agree
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), dimension(size(velocity, 1), size(velocity, 2)) :: z, p, q
    real(wp) :: energy, first, before, step
    integer :: k

    impulse = 0
    call precondition(self, interface, factor, velocity, z, comm)
    energy = product_of(velocity, z, comm)
    first = energy
    p = z
    do k = 1, self%most_iterations
      if (energy <= self%tolerance**2*first) exit
      q = p
      call factor%apply_inverse(q)
      call project(interface, factor, q, comm)
      step = product_of(p, q, comm)
      if (.not. step > 0) exit
      step = energy/step
      impulse = impulse + step*p
      velocity = velocity - step*q
      self%iterations = self%iterations + 1
      call precondition(self, interface, factor, velocity, z, comm)
      before = energy
      energy = product_of(velocity, z, comm)
      p = z + energy/before*p
    end do
    if (.not. energy <= self%tolerance**2*first) self%failures = self%failures + 1
  end subroutine cg_solve

  !> Weigh copies by the blocks of their subdomains' matrices from here on. Collective.
  subroutine cg_weigh(self, interface, factor, width, comm)
    class(interface_cg_t), intent(inout) :: self
    type(interface_t), intent(inout) :: interface !! shared bodies; its sums are prepared
    type(subdomain_factor_t), intent(in) :: factor !! of this subdomain
    integer, intent(in) :: width !! components of a velocity
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: i, c, n, lost

    n = size(interface%slot)
    if (allocated(self%block)) deallocate (self%block, self%total)
    allocate (self%block(width, width, n), self%total(width, width, n))
    call factor%shared_blocks(self%block)
    self%total = self%block
    do c = 1, width
      call interface%sum(self%total(:, c, :), comm)
    end do
    do i = 1, n
      do c = 1, width
        if (.not. self%total(c, c, i) > 0) self%total(c, c, i) = 1
      end do
      call dense_cholesky(self%total(:, :, i), lost)
    end do
  end subroutine cg_weigh

  !> Impulses that take velocities away approximately, and add up to nothing over copies: each subdomain answers to velocities
  !! less their mean, and what it answers is dealt back to the others, both by the weights of copies.
  subroutine precondition(self, interface, factor, velocity, z, comm)
    type(interface_cg_t), intent(in) :: self
    type(interface_t), intent(inout) :: interface
    type(subdomain_factor_t), intent(inout) :: factor
    real(wp), intent(in) :: velocity(:, :)
    real(wp), intent(out) :: z(:, :)
    type(comm_t), intent(inout) :: comm
    real(wp) :: mean(size(velocity, 1), size(velocity, 2))
    integer :: i

    z = velocity
    if (allocated(self%block)) then
      do i = 1, size(z, 2)
        mean(:, i) = matmul(self%block(:, :, i), z(:, i))
      end do
      call share_out(self, interface, mean, comm)
      z = z - mean
    end if
    call factor%precondition(self%preconditioner, z)
    if (allocated(self%block)) then
      mean = z
      call share_out(self, interface, mean, comm)
      do i = 1, size(z, 2)
        z(:, i) = z(:, i) - matmul(self%block(:, :, i), mean(:, i))
      end do
    else
      call project(interface, factor, z, comm)
    end if
  end subroutine precondition

  !> Sum values over copies, and solve with the sum of their blocks. Collective.
  subroutine share_out(self, interface, values, comm)
    type(interface_cg_t), intent(in) :: self
    type(interface_t), intent(inout) :: interface
    real(wp), intent(inout) :: values(:, :)
    type(comm_t), intent(inout) :: comm
    integer :: i

    call interface%sum(values, comm)
    do i = 1, size(values, 2)
      call dense_cholesky_solve(self%total(:, :, i), values(:, i))
    end do
  end subroutine share_out

  !> Take off the mean over copies; copies without contacts, and components that nothing moves, have no share in it. Collective.
  subroutine project(interface, factor, values, comm)
    type(interface_t), intent(inout) :: interface !! shared bodies; its sums are prepared
    type(subdomain_factor_t), intent(in) :: factor !! of this subdomain
    real(wp), intent(inout) :: values(:, :) !! of this rank's copies
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: i

    do i = 1, size(values, 2)
      if (.not. factor%takes_part(i)) values(:, i) = 0
    end do
    call interface%balance(values, comm)
    do i = 1, size(values, 2)
      if (.not. factor%takes_part(i)) values(:, i) = 0
    end do
  end subroutine project

  !> Scalar product of values of all copies.
  real(wp) function product_of(a, b, comm)
    real(wp), intent(in) :: a(:, :), b(:, :)
    type(comm_t), intent(inout) :: comm

    product_of = sum(a*b)
    call comm%sum(product_of)
  end function product_of
end module sg_interface_cg
