!> Blocks of the Delassus matrix of some contacts, worked out by hand.
program test_interface_blocks
  use harness, only: tests_t
  use sg_interface_blocks, only: block_structure_t, interface_blocks_t
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t, reserve_problem
  use sg_records, only: arm_frictionless, ball_frictional, ball_inverse_wnn, normal_x, normal_z, round_frictionless
  use sg_vectors, only: cross
  implicit none
  type(tests_t) :: t

  call test_chain()
  call test_two_points()
  call test_balls()
  call t%finish()

contains

  !> Five disks of mass 2 in a row: W is tridiagonal, 1 on the diagonal and -1/2 beside it.
  subroutine test_chain()
    type(problem_t) :: problem
    type(block_structure_t) :: blocks
    integer :: i

    call reserve_problem(problem, round_frictionless, 5, 4)
    do i = 1, 5
      problem%body(:, i) = [0.0_wp, 0.0_wp, 0.5_wp, 0.5_wp]
    end do
    do i = 1, 4
      problem%pair(:, i) = int([i, i + 1], i4)
      problem%record(:, i) = [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]
    end do
    blocks = structure_of(problem, [1, 2, 3, 4])
    call t%check(blocks%contacts == 4 .and. blocks%alone == 0, 'every contact shares a disk')
    call t%near(blocks%mean_couplings, 1.5_wp, 1e-15_wp, 'one neighbour at the ends, two within')
    call t%check(blocks%groups == 1 .and. blocks%largest_group == 4 .and. blocks%most_couplings == 2, 'one chain')
    call t%near(blocks%off_diagonal, sqrt(6*0.25_wp/4), 1e-15_wp, 'six blocks of one half, four of one')
    blocks = structure_of(problem, [4, 1, 2])
    call t%check(blocks%alone == 1 .and. blocks%groups == 2 .and. blocks%largest_group == 2, 'a contact left out cuts the chain')
    call t%near(blocks%off_diagonal, sqrt(2*0.25_wp/3), 1e-15_wp, 'whose rows are gone')
    problem%body(:, 2) = 0
    blocks = structure_of(problem, [1, 2])
    call t%check(blocks%alone == 2 .and. blocks%groups == 2, 'a body that cannot move couples nothing')
    blocks = structure_of(problem, [integer ::])
    call t%check(blocks%contacts == 0 .and. blocks%groups == 0, 'no contacts')
  end subroutine test_chain

  !> Two points of one pair share both bodies. The arms of an antagonist count with the other sign, and the second point is told
  !! from the other side, so that W_kl = 1/m1 + 1/m2 - a_k a_l/I1 - b_k b_l/I2.
  subroutine test_two_points()
    type(problem_t) :: problem
    type(block_structure_t) :: blocks
    real(wp) :: w(2, 2)

    call reserve_problem(problem, arm_frictionless, 2, 2)
    problem%body(:, 1) = [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 2.0_wp]
    problem%body(:, 2) = [0.0_wp, 0.0_wp, 0.0_wp, 0.5_wp, 0.5_wp, 3.0_wp]
    problem%pair = 0
    problem%pair(:, 1) = [1_i4, 2_i4]
    problem%pair(:, 2) = [2_i4, 1_i4]
    problem%record(:, 1) = [0.0_wp, 1.0_wp, 0.3_wp, 0.2_wp, 0.0_wp, 1.0_wp]
    problem%record(:, 2) = [0.0_wp, -1.0_wp, 0.1_wp, 0.4_wp, 0.0_wp, 1.0_wp]
    w(1, 1) = 1.5_wp + 2*0.09_wp + 3*0.04_wp
    w(2, 2) = 1.5_wp + 2*0.16_wp + 3*0.01_wp
    w(1, 2) = 1.5_wp - 2*0.3_wp*0.4_wp - 3*0.2_wp*0.1_wp
    blocks = structure_of(problem, [1, 2])
    call t%check(blocks%groups == 1 .and. blocks%most_couplings == 1, 'one other contact, though two bodies are shared')
    call t%near(blocks%off_diagonal, sqrt(2*w(1, 2)**2/(w(1, 1)**2 + w(2, 2)**2)), 1e-14_wp, 'sum over both bodies')
  end subroutine test_two_points

  !> Three balls, two contacts at right angles through the middle one: only friction couples them.
  subroutine test_balls()
    type(problem_t) :: problem
    type(block_structure_t) :: blocks
    integer :: i

    call reserve_problem(problem, ball_frictional, 3, 2)
    do i = 1, 3
      ! m = 1, R^2/I = 5/2
      problem%body(:, i) = [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 2.5_wp]
    end do
    problem%pair(:, 1) = [1_i4, 2_i4]
    problem%pair(:, 2) = [3_i4, 2_i4]
    problem%record(:, :2) = 0
    problem%record(normal_x:normal_z, 1) = [1.0_wp, 0.0_wp, 0.0_wp]
    problem%record(normal_x:normal_z, 2) = [0.0_wp, 1.0_wp, 0.0_wp]
    problem%record(ball_inverse_wnn, :2) = 1
    blocks = structure_of(problem, [1, 2])
    ! Diagonal: 2 along the normal, 2 + 2 (5/2) = 7 along each tangent.
    call t%near(blocks%off_diagonal, sqrt(2*off_squares()/(2*(4 + 2*49.0_wp))), 1e-14_wp, 'W of two balls on a third')
  end subroutine test_balls

  !> Squares of the block off the diagonal, by the velocity of points of the middle ball, I = 2/5 m R^2.
  real(wp) function off_squares()
    real(wp) :: force(3), n(3, 2), velocity(3)
    integer :: axis

    n = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [3, 2])
    off_squares = 0
    do axis = 1, 3
      force = 0
      force(axis) = 1
      ! v + spin x r, spin = (5/2) r' x force, both arms of length one; the same in all axes.
      velocity = force + 2.5_wp*cross(cross(n(:, 2), force), n(:, 1))
      off_squares = off_squares + sum(velocity**2)
    end do
  end function off_squares

  !> Figures of the blocks of some contacts.
  type(block_structure_t) function structure_of(problem, chosen) result(structure)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: chosen(:)
    type(interface_blocks_t) :: blocks

    call blocks%build(problem, chosen)
    structure = blocks%structure()
  end function structure_of
end program test_interface_blocks
