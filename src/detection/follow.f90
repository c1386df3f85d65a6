!> Contacts that follow their bodies: the normal turns with the body whose face it is, the point moves with the other one.
!!
!! Used from substep to substep (sg_carry) and for the contacts of pairs that are kept from step to step (sg_kept_contacts). The gap
!! is the height of the point over the face at any turn (doc/theory/substeps.md, "Contacts that are carried").
module sg_follow
  use sg_contactors, only: contactors_t, kind_plane, kind_polygon, kind_polyhedron, kind_segment
  use sg_kinds, only: wp, i1, i4
  use sg_rotations, only: turned_by
  use sg_touch_space_pair, only: plane_axes
  implicit none
  private
  public :: face_of, face_of_antagonist, face_of_candidate, follow_in_plane, follow_in_space, follows

  !> Bodies whose face may be the one that a contact lies on: the antagonist or the candidate
  integer(i1), parameter :: face_of_antagonist = 0, face_of_candidate = 1
  !> Cosine by which a face of the candidate must be squarer to the normal than all of the antagonist, as in the narrow phase
  real(wp), parameter :: squarer = 1e-10_wp

contains

  !> Do the points of contact of a candidate of this kind follow their bodies?
  pure logical function follows(kind)
    integer, intent(in) :: kind !! kind of shape

    follows = kind == kind_polygon .or. kind == kind_polyhedron
  end function follows

  !> Body whose face a contact lies on: the one with the face most square to the normal, of faces as square the antagonist.
  pure integer(i1) function face_of(contactors, c, a, normal) result(face)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: normal(:) !! unit normal of the contact
    real(wp) :: cosine

    face = face_of_antagonist
    cosine = squareness(contactors, int(a), normal)
    ! No face of the candidate is squarer by enough than one that is square to rounding.
    if (cosine > 1 - squarer/2) return
    if (squareness(contactors, int(c), -normal) > cosine + squarer) face = face_of_candidate
  end function face_of

  !> Cosine between a direction and the outward normal of the face of a shape that is most square to it; -1 without faces.
  pure real(wp) function squareness(contactors, c, direction) result(cosine)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: direction(:)
    real(wp) :: frame(3, 3)
    integer :: i

    cosine = -1
    associate (row => contactors%row(c))
      select case (contactors%kind(c))
      case (kind_polygon)
        do i = contactors%polygon_first(row), contactors%polygon_first(row + 1) - 1
          cosine = max(cosine, dot_product(direction, contactors%polygon_edge(1:2, i)))
        end do
      case (kind_segment)
        cosine = abs(direction(2)*contactors%segment_axis(1, row) - direction(1)*contactors%segment_axis(2, row))
      case (kind_polyhedron)
        associate (normals => contactors%space%polyhedra(row)%world_normal)
          do i = 1, size(normals, 2)
            cosine = max(cosine, dot_product(direction, normals(:, i)))
          end do
        end associate
      case (kind_plane)
        frame = plane_axes(contactors, row)
        do i = 1, 3
          cosine = max(cosine, abs(dot_product(direction, frame(:, i))))
        end do
      end select
    end associate
  end function squareness

  !> Let a contact of the plane follow from one configuration of its bodies to another.
  pure subroutine follow_in_plane(face, before_c, before_a, now_c, now_a, turn_c, turn_a, normal, point, gap)
    integer(i1), intent(in) :: face !! body whose face it lies on, one of `face_of_*`
    real(wp), intent(in) :: before_c(2) !! centre of the candidate's body in the first configuration [m]
    real(wp), intent(in) :: before_a(2) !! of the antagonist's, in the contact's periodic image [m]
    real(wp), intent(in) :: now_c(2) !! centre of the candidate's body in the second configuration [m]
    real(wp), intent(in) :: now_a(2) !! of the antagonist's [m]
    real(wp), intent(in) :: turn_c(2) !! cosine and sine of the angle by which the candidate has turned
    real(wp), intent(in) :: turn_a(2) !! and the antagonist
    real(wp), intent(inout) :: normal(2) !! unit normal
    real(wp), intent(inout) :: point(2) !! point of contact [m]
    real(wp), intent(inout) :: gap !! gap [m]
    real(wp) :: way(2), arm_c(2), arm_a(2), turn(2)

    ! Written out: it is done for every contact that is kept, and vectors as results go through memory.
    way(1) = point(1) + gap/2*normal(1) - before_c(1)
    way(2) = point(2) + gap/2*normal(2) - before_c(2)
    arm_c(1) = turn_c(1)*way(1) - turn_c(2)*way(2)
    arm_c(2) = turn_c(2)*way(1) + turn_c(1)*way(2)
    way(1) = point(1) - gap/2*normal(1) - before_a(1)
    way(2) = point(2) - gap/2*normal(2) - before_a(2)
    arm_a(1) = turn_a(1)*way(1) - turn_a(2)*way(2)
    arm_a(2) = turn_a(2)*way(1) + turn_a(1)*way(2)
    turn = turn_a
    if (face == face_of_candidate) turn = turn_c
    way = normal
    normal(1) = turn(1)*way(1) - turn(2)*way(2)
    normal(2) = turn(2)*way(1) + turn(1)*way(2)
    gap = normal(1)*(now_c(1) - now_a(1) + (arm_c(1) - arm_a(1))) + normal(2)*(now_c(2) - now_a(2) + (arm_c(2) - arm_a(2)))
    if (face == face_of_candidate) then
      point(1) = now_a(1) + arm_a(1) + gap/2*normal(1)
      point(2) = now_a(2) + arm_a(2) + gap/2*normal(2)
    else
      point(1) = now_c(1) + arm_c(1) - gap/2*normal(1)
      point(2) = now_c(2) + arm_c(2) - gap/2*normal(2)
    end if
  end subroutine follow_in_plane

  !> The same in space; turns are quaternions.
  pure subroutine follow_in_space(face, before_c, before_a, now_c, now_a, turn_c, turn_a, normal, point, gap)
    integer(i1), intent(in) :: face !! body whose face it lies on, one of `face_of_*`
    real(wp), intent(in) :: before_c(3) !! centre of the candidate's body in the first configuration [m]
    real(wp), intent(in) :: before_a(3) !! of the antagonist's, in the contact's periodic image [m]
    real(wp), intent(in) :: now_c(3) !! centre of the candidate's body in the second configuration [m]
    real(wp), intent(in) :: now_a(3) !! of the antagonist's [m]
    real(wp), intent(in) :: turn_c(4) !! rotation of the candidate from the first to the second
    real(wp), intent(in) :: turn_a(4) !! and of the antagonist
    real(wp), intent(inout) :: normal(3) !! unit normal
    real(wp), intent(inout) :: point(3) !! point of contact [m]
    real(wp), intent(inout) :: gap !! gap [m]
    real(wp) :: half(3), arm_c(3), arm_a(3)

    half = gap/2*normal
    arm_c = turned_by(turn_c, point + half - before_c)
    arm_a = turned_by(turn_a, point - half - before_a)
    normal = turned_by(merge(turn_c, turn_a, face == face_of_candidate), normal)
    gap = dot_product(normal, now_c - now_a + (arm_c - arm_a))
    if (face == face_of_candidate) then
      point = now_a + arm_a + gap/2*normal
    else
      point = now_c + arm_c - gap/2*normal
    end if
  end subroutine follow_in_space
end module sg_follow
