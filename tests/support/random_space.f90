!> Random directions and frames of space, and counts of random points.
module random_space
  use harness, only: tests_t
  use sg_kinds, only: wp
  use sg_random, only: random_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: random_direction, random_frame, check_hits

contains

  !> A random unit vector.
  function random_direction(random) result(direction)
    type(random_t), intent(inout) :: random !! generator
    real(wp) :: direction(3)

    direction = [random%normal(), random%normal(), random%normal()]
    direction = direction/norm2(direction)
  end function random_direction

  !> A random rotation.
  function random_frame(random) result(frame)
    type(random_t), intent(inout) :: random !! generator
    real(wp) :: frame(3, 3)

    frame(:, 1) = random_direction(random)
    frame(:, 2) = random_direction(random)
    frame(:, 2) = frame(:, 2) - dot_product(frame(:, 1), frame(:, 2))*frame(:, 1)
    frame(:, 2) = frame(:, 2)/norm2(frame(:, 2))
    frame(:, 3) = cross(frame(:, 1), frame(:, 2))
  end function random_frame

  !> Check a count of random points against the share that it should have: five standard deviations.
  subroutine check_hits(t, hits, points, share, what)
    class(tests_t), intent(inout) :: t !! the checks
    integer, intent(in) :: hits !! points that met
    integer, intent(in) :: points !! points in all
    real(wp), intent(in) :: share !! of the points that should meet
    character(len=*), intent(in) :: what !! said when it is too far

    call t%near(real(hits, wp), share*real(points, wp), 5*sqrt(max(1.0_wp, share*real(points, wp))), what)
  end subroutine check_hits
end module random_space
