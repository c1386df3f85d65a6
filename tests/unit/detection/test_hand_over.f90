!> Impulses handed to new points of a pair: the nearest free one, by where keys say that the past points would be now.
program test_hand_over
  use harness, only: tests_t
  use scenes, only: begin_scene, place_bodies, put_polygon, put_wall
  use scenes_space, only: begin_space_scene, put_box, put_capsule, put_plane, turn_at_random
  use sg_crossing_keys, only: crossing_ends, crossing_key
  use sg_hand_over, only: hand_over
  use sg_kinds, only: wp, i4
  use sg_random, only: random_t
  use sg_rotations, only: frame_of
  use sg_scene, only: scene_t
  implicit none
  type(tests_t) :: t
  type(random_t) :: random

  call random%seed(3)
  call test_keys()
  call test_plane_shapes()
  call test_space_shapes()
  call test_crossing()
  call t%finish()

contains

  !> Keys of crossings encode their edges, unless polyhedra have too many vertices.
  subroutine test_keys()
    integer :: i, n(2), ends(4), k
    integer(i4) :: key

    do i = 1, 300
      n = [4 + int(random%uniform(0.0_wp, 60.0_wp)), 4 + int(random%uniform(0.0_wp, 60.0_wp))]
      ends = [(1 + int(random%uniform(0.0_wp, 1.0_wp)*real(n(merge(1, 2, k < 3)), wp)), k=1, 4)]
      key = crossing_key(n(1), n(2), int(ends(1:2), i4), int(ends(3:4), i4))
      call t%check(key > sum(n), 'keys of crossings are above those of vertices')
      if (product(real(n + 1, wp)**2) < real(huge(key), wp)/2) then
        call t%check(all(crossing_ends(n(1), n(2), key) == ends), 'a key encodes its edges')
      end if
    end do
    call t%check(all(crossing_ends(300, 300, 90000_i4) == 0), 'a key of large polyhedra encodes none')
    call t%check(all(crossing_ends(8, 8, 12_i4) == 0), 'a key of a vertex is none of a crossing')
  end subroutine test_keys

  !> A square on a segment: points near its corners and the segment's ends go on from those; each past is used once.
  subroutine test_plane_shapes()
    type(scene_t) :: scene
    real(wp) :: point(2, 2)
    integer :: past(2)

    call begin_scene(scene, 2, 0.3_wp, 0.1_wp)
    call put_polygon(scene, 1, reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4]))
    call put_wall(scene, 2, 0.6_wp, 0.1_wp, [0.5_wp, -0.1_wp], 0.0_wp)
    call place_bodies(scene)
    point = reshape([0.9_wp, 0.0_wp, 0.1_wp, 0.0_wp], [2, 2])
    past = 0
    call hand_over(scene%contactors, 1, 2, [0.0_wp, 0.0_wp], [1_i4, 2_i4], point, 11, past)
    call t%check(all(past == [12, 11]), 'the nearest corners')
    past = [12, 0]
    call hand_over(scene%contactors, 1, 2, [0.0_wp, 0.0_wp], [1_i4, 2_i4], point, 11, past)
    call t%check(all(past == [12, 11]), 'what is left')
    past = 0
    call hand_over(scene%contactors, 1, 2, [0.0_wp, 0.0_wp], [5_i4, 6_i4], point, 1, past)
    call t%check(all(past == [2, 1]), 'the ends of the segment')
    ! The image of the segment lies one length on.
    past = 0
    call hand_over(scene%contactors, 1, 2, [1.2_wp, 0.0_wp], [5_i4, 1_i4], point, 1, past)
    call t%check(all(past == [1, 2]), 'the periodic image of the segment')
    past = 0
    call hand_over(scene%contactors, 1, 2, [0.0_wp, 0.0_wp], [3_i4], point, 7, past)
    call t%check(all(past == [7, 0]), 'one past goes to one point')
  end subroutine test_plane_shapes

  !> A box over a plane's box, both turned, and a capsule: each past corner goes to the point beside it.
  subroutine test_space_shapes()
    type(scene_t) :: scene
    real(wp) :: point(3, 4), frame(3, 3)
    integer :: past(4), i

    call begin_space_scene(scene, 3, 0.3_wp, 0.1_wp)
    call put_box(scene, 1, [0.3_wp, 0.4_wp, 0.5_wp], [0.0_wp, 0.0_wp, 1.0_wp])
    call put_plane(scene, 2, [2.0_wp, 1.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, 0.0_wp])
    call put_capsule(scene, 3, 0.5_wp, 0.1_wp, [3.0_wp, 0.0_wp, 0.0_wp])
    do i = 1, 3
      call turn_at_random(scene, i, random)
    end do
    call place_bodies(scene)
    do i = 1, 4
      point(:, i) = scene%contactors%space%polyhedra(1)%world_vertex(:, 5 - i) + 0.01_wp*random%uniform()
    end do
    past = 0
    call hand_over(scene%contactors, 1, 2, [0.0_wp, 0.0_wp, 0.0_wp], [1_i4, 2_i4, 3_i4, 4_i4], point, 1, past)
    call t%check(all(past == [4, 3, 2, 1]), 'corners of a polyhedron')
    frame = frame_of(scene%bodies%orientation(:, 2))
    do i = 1, 4
      point(:, i) = matmul(frame, [2.0_wp, 1.0_wp, 0.1_wp]*real(2*ibits(i + 3, [0, 1, 2], 1) - 1, wp)) + [1.0_wp, 2.0_wp, 0.0_wp]
    end do
    past = 0
    call hand_over(scene%contactors, 1, 2, [1.0_wp, 2.0_wp, 0.0_wp], [16_i4, 14_i4, 13_i4, 15_i4], point, 1, past)
    call t%check(all(past == [3, 2, 4, 1]), 'corners of a plane')
    frame = frame_of(scene%bodies%orientation(:, 3))
    associate (axis => scene%contactors%space%cylinder_world(:, 1))
      point(:, 1) = [3.0_wp, 0.0_wp, 0.0_wp] + 0.45_wp*axis
      point(:, 2) = [3.0_wp, 0.0_wp, 0.0_wp] - 0.4_wp*axis
    end associate
    past = 0
    call hand_over(scene%contactors, 3, 2, [0.0_wp, 0.0_wp, 0.0_wp], [1_i4, 2_i4], point(:, :2), 1, past(:2))
    call t%check(all(past(:2) == [2, 1]), 'ends of a capsule')
  end subroutine test_space_shapes

  !> Two boxes crossed: the past is where their edges cross.
  subroutine test_crossing()
    type(scene_t) :: scene
    real(wp) :: point(3, 2)
    integer :: past(2), i, ends(4)
    integer(i4) :: features(2)

    call begin_space_scene(scene, 2, 0.3_wp, 0.1_wp)
    call put_box(scene, 1, [2.0_wp, 0.5_wp, 0.5_wp], [0.0_wp, 0.0_wp, 1.0_wp])
    call put_box(scene, 2, [0.5_wp, 2.0_wp, 0.5_wp], [0.0_wp, 0.0_wp, 0.0_wp])
    call place_bodies(scene)
    associate (one => scene%contactors%space%polyhedra(1), other => scene%contactors%space%polyhedra(2))
      do i = 1, 2
        ! Lower edge of the upper box at y = 0.5 with upper edges of the lower box at x = -0.5 and 0.5
        ends(1) = corner_at(one%world_vertex, [-2.0_wp, 0.5_wp, 0.5_wp])
        ends(2) = corner_at(one%world_vertex, [2.0_wp, 0.5_wp, 0.5_wp])
        ends(3) = corner_at(other%world_vertex, [real(i, wp) - 1.5_wp, -2.0_wp, 0.5_wp])
        ends(4) = corner_at(other%world_vertex, [real(i, wp) - 1.5_wp, 2.0_wp, 0.5_wp])
        features(i) = crossing_key(8, 8, int(ends(1:2), i4), int(ends(3:4), i4))
        point(:, i) = [0.4_wp - real(i - 1, wp), 0.45_wp, 0.5_wp]
      end do
    end associate
    past = 0
    call hand_over(scene%contactors, 1, 2, [0.0_wp, 0.0_wp, 0.0_wp], features, point, 1, past)
    call t%check(all(past == [2, 1]), 'crossings of edges')
    ! Points whose key encodes no place come last.
    past = 0
    call hand_over(scene%contactors, 1, 2, [0.0_wp, 0.0_wp, 0.0_wp], [huge(1_i4), features(1)], point, 1, past)
    call t%check(all(past == [1, 2]), 'unknown places come last')
  end subroutine test_crossing

  !> Number of the vertex at a place.
  pure integer function corner_at(vertex, place) result(i)
    real(wp), intent(in) :: vertex(:, :), place(3)

    i = minloc(norm2(vertex - spread(place, 2, size(vertex, 2)), 1), 1)
  end function corner_at
end program test_hand_over
