!> Solids cut by planes: faces of which more than one run of vertices stays, planes through vertices, and both sides of any plane
!! add up to the whole.
program test_cut_solids
  use harness, only: tests_t
  use random_space, only: random_direction, random_frame
  use sg_kinds, only: wp
  use sg_overlap_solid, only: box_solid, cut, solid_room_t, solid_t, solid_volume
  use sg_random, only: random_t
  implicit none
  !> Coordinates of a few metres are rounded to 1e-15 m, over faces of a few square metres
  real(wp), parameter :: tight = 1e-13_wp
  type(tests_t) :: t

  call test_arms()
  call test_both_sides()
  call test_through_vertices()
  call t%finish()

contains

  !> A beam 3 m long and 1 m high, with two arms 1 m high on its ends, all 1 m deep: 5 m3, turned by a frame.
  subroutine make_fork(frame, solid)
    real(wp), intent(in) :: frame(3, 3)
    type(solid_t), intent(out) :: solid
    real(wp), parameter :: x(8) = real([0, 3, 3, 2, 2, 1, 1, 0], wp), y(8) = real([0, 0, 2, 2, 1, 1, 2, 2], wp)
    integer :: i, next

    solid%n_vertices = 16
    solid%n_faces = 10
    solid%has_normals = .false.
    allocate (solid%vertex(3, 16), solid%face_first(11), solid%face_vertex(48), solid%normal(3, 10))
    do i = 1, 8
      next = mod(i, 8) + 1
      solid%vertex(:, i) = matmul(frame, [x(i), y(i), 0.0_wp])
      solid%vertex(:, i + 8) = matmul(frame, [x(i), y(i), 1.0_wp])
      solid%face_first(i) = 4*i - 3
      solid%face_vertex(4*i - 3:4*i) = [i, next, next + 8, i + 8]
      solid%face_vertex(33 - i + 8) = i
      solid%face_vertex(40 + i) = i + 8
    end do
    solid%face_first(9:) = [33, 41, 49]
  end subroutine make_fork

  !> Volume of a copy below a plane.
  real(wp) function below(solid, normal, height) result(volume)
    type(solid_t), intent(in) :: solid
    real(wp), intent(in) :: normal(3), height
    type(solid_t) :: left
    type(solid_room_t) :: room

    left = solid
    call cut(left, normal, height, room)
    volume = solid_volume(left)
  end function below

  !> Cut across both arms, and once more along them: the two long faces keep two runs of vertices each.
  subroutine test_arms()
    type(random_t) :: random
    type(solid_t) :: fork
    real(wp) :: frame(3, 3), h
    integer :: i

    call random%seed(3)
    do i = 1, 20
      frame = random_frame(random)
      h = 1 + 0.04_wp*real(i, wp)
      call make_fork(frame, fork)
      call t%near(solid_volume(fork), 5.0_wp, tight, 'fork')
      call t%near(below(fork, -frame(:, 2), -h), 2*(2 - h), tight, 'both arms')
      call t%near(below(fork, frame(:, 2), h), 3 + 2*(h - 1), tight, 'beam with stumps')
      call cut(fork, -frame(:, 2), -h)
      call t%near(below(fork, frame(:, 1), 2.5_wp), 1.5_wp*(2 - h), tight, 'an arm and a half')
      call t%near(below(fork, frame(:, 3), 0.25_wp), 0.5_wp*(2 - h), tight, 'a quarter of both arms')
      call cut(fork, frame(:, 2), 0.5_wp)
      call t%near(below(fork, frame(:, 1), 2.5_wp), 0.0_wp, 0.0_wp, 'nothing, cut again')
    end do
  end subroutine test_arms

  !> Planes of all directions through it.
  subroutine test_both_sides()
    type(random_t) :: random
    type(solid_t) :: fork
    real(wp) :: frame(3, 3), normal(3), height
    integer :: i

    call random%seed(4)
    do i = 1, 2000
      frame = random_frame(random)
      call make_fork(frame, fork)
      normal = random_direction(random)
      height = dot_product(normal, matmul(frame, [1.5_wp, 1.0_wp + 0.8_wp*sin(real(i, wp)), 0.5_wp]))
      call t%near(below(fork, normal, height) + below(fork, -normal, -height), 5.0_wp, tight, 'both sides')
    end do
  end subroutine test_both_sides

  !> A box cut again and again by planes of few directions through vertices that are left, or a rounding beside them: what rounding
  !! decides differs between vertices that should lie on one plane.
  subroutine test_through_vertices()
    type(random_t) :: random
    type(solid_t) :: solid
    real(wp) :: normal(3), height, volume, other
    integer :: i, k

    call random%seed(5)
    do i = 1, 1000
      call box_solid([1.0_wp, 1.0_wp, 0.5_wp], solid)
      solid%has_normals = .false.
      volume = 4
      do k = 1, 12
        normal = anint(4*[random%uniform(), random%uniform(), random%uniform()] - 2)
        if (all(abs(normal) < 0.5_wp)) cycle
        normal = normal/norm2(normal)
        height = dot_product(normal, solid%vertex(:, 1 + int(random%uniform()*real(solid%n_vertices, wp))))
        if (random%uniform() < 0.5_wp) height = height + 1e-15_wp*(random%uniform() - 0.5_wp)
        other = below(solid, -normal, -height)
        call t%near(below(solid, normal, height) + other, volume, tight, 'both sides, planes through vertices')
        ! The larger part is cut on.
        if (2*other > volume) then
          call cut(solid, -normal, -height)
        else
          call cut(solid, normal, height)
        end if
        volume = solid_volume(solid)
      end do
    end do
  end subroutine test_through_vertices
end program test_cut_solids
