!> Contacts of polygons and polyhedra that are kept from step to step while their pair has hardly moved (doc/theory/detection.md,
!! "Contacts that are kept").
!!
!! What a detection finds is stored in the frame of the antagonist, next to the pose of the candidate in that frame at that time.
!! While the pose has changed by less than a share of the smaller shape, the points follow the two bodies and no narrow phase is
!! due. The change counts from the detection, not from the last step, so that it does not add up. Each column of
!! `contacts%kept` holds
!!
!!     body of the face (1 + face_of_*) | pose of the candidate | normal | point | gap | reach
!!                                                         place, turn
!!
!! where a turn is a cosine and a sine in the plane and a quaternion in space, and the reach is the alert distance up to which all
!! points of the pair are kept. Columns go with their contacts into checkpoints and messages, so that a run that goes on from there
!! keeps what the other would have kept.
module sg_kept_contacts
  use sg_contactors, only: contactors_t, kind_polygon, kind_segment
  use sg_follow, only: follow_in_plane, follow_in_space
  use sg_kinds, only: wp, i1, i4
  use sg_rotations, only: no_rotation, quaternion_product, turned_back, turned_by
  implicit none
  private
  public :: keep_in_plane, keep_in_space, move_from, move_in_plane, move_in_space, pose_between, pose_in_plane, pose_in_space
  public :: has_moved_in_plane, has_moved_in_space, n_kept_in_plane, n_kept_in_space, n_pose_in_plane, n_pose_in_space
  public :: shorter_reach, way_between

  !> Values of a pose, and of a contact that is kept
  integer, parameter :: n_pose_in_plane = 4, n_pose_in_space = 7, n_kept_in_plane = 11, n_kept_in_space = 16

contains

  !> Pose of the candidate of a pair in the frame of the antagonist, in the plane.
  pure function pose_in_plane(contactors, c, a, offset) result(pose)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(2) !! shift of the antagonist [m]
    real(wp) :: pose(n_pose_in_plane)
    real(wp) :: x, y

    x = contactors%centre(1, c) - contactors%centre(1, a) - offset(1)
    y = contactors%centre(2, c) - contactors%centre(2, a) - offset(2)
    call pose_between(turn_of(contactors, c), turn_of(contactors, a), x, y, pose)
  end function pose_in_plane

  !> The same from the turns of both and the way from the antagonist to the candidate.
  pure subroutine pose_between(own, other, x, y, pose)
    real(wp), intent(in) :: own(2) !! cosine and sine of the turn of the candidate
    real(wp), intent(in) :: other(2) !! of the antagonist
    real(wp), intent(in) :: x !! way along x [m]
    real(wp), intent(in) :: y !! way along y [m]
    real(wp), intent(out) :: pose(n_pose_in_plane) !! pose of the candidate

    pose(1) = other(1)*x + other(2)*y
    pose(2) = other(1)*y - other(2)*x
    pose(3) = other(1)*own(1) + other(2)*own(2)
    pose(4) = other(1)*own(2) - other(2)*own(1)
  end subroutine pose_between

  !> Pose of the candidate of a pair in the frame of the antagonist, in space.
  pure function pose_in_space(contactors, turn_c, turn_a, c, a, offset) result(pose)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    real(wp), intent(in) :: turn_c(4) !! orientation of the candidate's body
    real(wp), intent(in) :: turn_a(4) !! orientation of the antagonist's body
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(3) !! shift of the antagonist [m]
    real(wp) :: pose(n_pose_in_space), way(3)

    way(1) = contactors%centre(1, c) - contactors%centre(1, a) - offset(1)
    way(2) = contactors%centre(2, c) - contactors%centre(2, a) - offset(2)
    way(3) = contactors%centre(3, c) - contactors%centre(3, a) - offset(3)
    pose(1:3) = turned_back(turn_a, way)
    pose(4:7) = quaternion_product([turn_a(1), -turn_a(2:4)], turn_c)
  end function pose_in_space

  !> Cosine and sine of the turn of a polygon, or of the axis of a segment.
  pure function turn_of(contactors, c) result(turn)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c
    real(wp) :: turn(2)

    turn = [1.0_wp, 0.0_wp]
    if (contactors%kind(c) == kind_polygon) turn = contactors%polygon_turn(:, contactors%row(c))
    if (contactors%kind(c) == kind_segment) turn = contactors%segment_axis(:, contactors%row(c))
  end function turn_of

  !> Can a point of the candidate have moved by more than a length against the antagonist since its contacts were found?
  pure logical function has_moved_in_plane(kept, pose, reach, length) result(has_moved)
    real(wp), intent(in) :: kept(n_kept_in_plane) !! first contact of the pair
    real(wp), intent(in) :: pose(n_pose_in_plane) !! pose now
    real(wp), intent(in) :: reach !! radius of the candidate about its centre [m]
    real(wp), intent(in) :: length !! [m]

    has_moved = exceed((pose(1) - kept(2))**2 + (pose(2) - kept(3))**2, &
                       reach**2*((pose(3) - kept(4))**2 + (pose(4) - kept(5))**2), length)
  end function has_moved_in_plane

  !> The same in space. A point at the distance R moves by 2 R sin(w/2) in a turn by w, and quaternions differ by 2 sin(w/4).
  pure logical function has_moved_in_space(kept, pose, reach, length) result(has_moved)
    real(wp), intent(in) :: kept(n_kept_in_space) !! first contact of the pair
    real(wp), intent(in) :: pose(n_pose_in_space) !! pose now
    real(wp), intent(in) :: reach !! radius of the candidate about its centre [m]
    real(wp), intent(in) :: length !! [m]

    ! q and -q are one orientation.
    has_moved = exceed(sum((pose(1:3) - kept(2:4))**2), &
                       4*reach**2*min(sum((pose(4:7) - kept(5:8))**2), sum((pose(4:7) + kept(5:8))**2)), length)
  end function has_moved_in_space

  !> Do two lengths given by their squares exceed a third one together?
  pure logical function exceed(square, other, length)
    real(wp), intent(in) :: square, other, length
    real(wp) :: left

    ! sqrt(a) + sqrt(b) <= l where 2 sqrt(a b) <= l^2 - a - b; values that are not numbers exceed.
    left = length**2 - square - other
    exceed = .not. (left >= 0 .and. left**2 >= 4*square*other)
  end function exceed

  !> Reach of the points of a pair that need be kept [m]: those within twice the alert distance, where more are.
  pure real(wp) function shorter_reach(reach, alert, longest)
    real(wp), intent(in) :: reach !! of the points that are kept [m]
    real(wp), intent(in) :: alert !! alert distance of the step [m]
    real(wp), intent(in) :: longest !! longest one of the pair [m]

    ! Twice, so that a step which looks a little farther need not detect all pairs again.
    shorter_reach = merge(min(2*alert, longest), reach, reach > 2*alert)
  end function shorter_reach

  !> Way of two bodies against each other from one detection to the next [m], as they move now.
  pure real(wp) function way_between(dimension, n, position, middle, c, a, substeps) result(way)
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: n !! components of a configuration
    real(wp), intent(in) :: position(dimension, *) !! of all bodies, before the substep [m]
    real(wp), intent(in) :: middle(n, *) !! configuration in the middle of the substep
    integer(i4), intent(in) :: c !! one body
    integer(i4), intent(in) :: a !! the other
    integer, intent(in) :: substeps !! from one detection to the next
    real(wp) :: x, y, z

    x = (middle(1, c) - position(1, c)) - (middle(1, a) - position(1, a))
    y = (middle(2, c) - position(2, c)) - (middle(2, a) - position(2, a))
    z = 0
    if (dimension == 3) z = (middle(3, c) - position(3, c)) - (middle(3, a) - position(3, a))
    ! From the position to the middle is half a substep.
    way = 2*real(substeps, wp)*sqrt(x**2 + y**2 + z**2)
  end function way_between

  !> Store a contact that a detection has found, in the plane.
  pure subroutine keep_in_plane(contactors, a, offset, face, pose, normal, point, gap, alert, kept)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(2) !! shift of the antagonist [m]
    integer(i1), intent(in) :: face !! body whose face it lies on, one of `face_of_*`
    real(wp), intent(in) :: pose(n_pose_in_plane) !! pose of the candidate
    real(wp), intent(in) :: normal(2) !! unit normal
    real(wp), intent(in) :: point(2) !! point of contact [m]
    real(wp), intent(in) :: gap !! gap [m]
    real(wp), intent(in) :: alert !! alert distance up to which points of the pair were sought [m]
    real(wp), intent(out) :: kept(n_kept_in_plane) !! what is kept of it
    real(wp) :: turn(2), way(2)

    turn = turn_of(contactors, a)
    way = point - contactors%centre(:, a)
    way = way - offset
    kept(1) = real(1_i1 + face, wp)
    kept(2:5) = pose
    kept(6:7) = [turn(1)*normal(1) + turn(2)*normal(2), turn(1)*normal(2) - turn(2)*normal(1)]
    kept(8:9) = [turn(1)*way(1) + turn(2)*way(2), turn(1)*way(2) - turn(2)*way(1)]
    kept(10) = gap
    kept(11) = alert
  end subroutine keep_in_plane

  !> The same in space.
  pure subroutine keep_in_space(contactors, a, offset, turn, face, pose, normal, point, gap, alert, kept)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(3) !! shift of the antagonist [m]
    real(wp), intent(in) :: turn(4) !! orientation of the antagonist's body
    integer(i1), intent(in) :: face !! body whose face it lies on, one of `face_of_*`
    real(wp), intent(in) :: pose(n_pose_in_space) !! pose of the candidate
    real(wp), intent(in) :: normal(3) !! unit normal
    real(wp), intent(in) :: point(3) !! point of contact [m]
    real(wp), intent(in) :: gap !! gap [m]
    real(wp), intent(in) :: alert !! alert distance up to which points of the pair were sought [m]
    real(wp), intent(out) :: kept(n_kept_in_space) !! what is kept of it

    kept(1) = real(1_i1 + face, wp)
    kept(2:8) = pose
    kept(9:11) = turned_back(turn, normal)
    kept(12:14) = turned_back(turn, point - contactors%centre(:, a) - offset)
    kept(15) = gap
    kept(16) = alert
  end subroutine keep_in_space

  !> Bring a contact that is kept to where its bodies are now, in the plane.
  pure subroutine move_in_plane(contactors, a, offset, kept, pose, normal, point, gap)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(2) !! shift of the antagonist [m]
    real(wp), intent(in) :: kept(n_kept_in_plane) !! the contact as it was found
    real(wp), intent(in) :: pose(n_pose_in_plane) !! pose of the candidate now
    real(wp), intent(out) :: normal(2) !! unit normal
    real(wp), intent(out) :: point(2) !! point of contact [m]
    real(wp), intent(out) :: gap !! gap [m]

    call move_from(turn_of(contactors, a), contactors%centre(:, a), offset, kept, pose, normal, point, gap)
  end subroutine move_in_plane

  !> The same from turn and centre of the antagonist.
  pure subroutine move_from(turn_a, centre, offset, kept, pose, normal, point, gap)
    real(wp), intent(in) :: turn_a(2) !! cosine and sine of the turn of the antagonist
    real(wp), intent(in) :: centre(2) !! its centre [m]
    real(wp), intent(in) :: offset(2) !! shift of the antagonist [m]
    real(wp), intent(in) :: kept(n_kept_in_plane) !! the contact as it was found
    real(wp), intent(in) :: pose(n_pose_in_plane) !! pose of the candidate now
    real(wp), intent(out) :: normal(2) !! unit normal
    real(wp), intent(out) :: point(2) !! point of contact [m]
    real(wp), intent(out) :: gap !! gap [m]
    real(wp) :: turn(2), x, y
    real(wp), parameter :: here(2) = 0, unturned(2) = [1.0_wp, 0.0_wp]

    ! How far the candidate has turned since, as the antagonist sees it.
    turn(1) = pose(3)*kept(4) + pose(4)*kept(5)
    turn(2) = pose(4)*kept(4) - pose(3)*kept(5)
    normal = kept(6:7)
    point = kept(8:9)
    gap = kept(10)
    call follow_in_plane(int(kept(1), i1) - 1_i1, kept(2:3), here, pose(1:2), here, turn, unturned, normal, point, gap)
    x = normal(1)
    y = normal(2)
    normal(1) = turn_a(1)*x - turn_a(2)*y
    normal(2) = turn_a(2)*x + turn_a(1)*y
    x = point(1)
    y = point(2)
    point(1) = turn_a(1)*x - turn_a(2)*y + centre(1) + offset(1)
    point(2) = turn_a(2)*x + turn_a(1)*y + centre(2) + offset(2)
  end subroutine move_from

  !> The same in space.
  pure subroutine move_in_space(contactors, a, offset, turn_a, kept, pose, normal, point, gap)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset(3) !! shift of the antagonist [m]
    real(wp), intent(in) :: turn_a(4) !! orientation of the antagonist's body
    real(wp), intent(in) :: kept(n_kept_in_space) !! the contact as it was found
    real(wp), intent(in) :: pose(n_pose_in_space) !! pose of the candidate now
    real(wp), intent(out) :: normal(3) !! unit normal
    real(wp), intent(out) :: point(3) !! point of contact [m]
    real(wp), intent(out) :: gap !! gap [m]
    real(wp) :: turn(4)
    real(wp), parameter :: here(3) = 0

    turn = quaternion_product(pose(4:7), [kept(5), -kept(6:8)])
    normal = kept(9:11)
    point = kept(12:14)
    gap = kept(15)
    call follow_in_space(int(kept(1), i1) - 1_i1, kept(2:4), here, pose(1:3), here, turn, no_rotation, normal, point, gap)
    normal = turned_by(turn_a, normal)
    point = turned_by(turn_a, point)
    point(1) = point(1) + contactors%centre(1, a) + offset(1)
    point(2) = point(2) + contactors%centre(2, a) + offset(2)
    point(3) = point(3) + contactors%centre(3, a) + offset(3)
  end subroutine move_in_space
end module sg_kept_contacts
