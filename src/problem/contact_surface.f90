!> Contact surface by pair of shapes: the area over which a strength or a cohesive stress acts; in the plane a length, per metre of
!! depth (doc/theory/laws.md, contact surface).
!!
!! Shapes that share a face have the shared length or area, dealt equally to the points of the contact. For others it is a
!! convention, that of LMGC90.
module sg_contact_surface
  use sg_contactors, only: contactors_t, kind_cylinder, kind_disk, kind_hollow_cylinder, kind_polyhedron, kind_segment, kind_sphere
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp, i4, pi
  use sg_vectors, only: cross
  implicit none
  private
  public :: contact_surface

  !> Share of a radius that the corner of a polygon stands for: ten degrees
  real(wp), parameter :: corner = pi/18

contains

  !> Surface of a contact [m2; m in the plane].
  pure real(wp) function contact_surface(contactors, contacts, k) result(surface)
    type(contactors_t), intent(in) :: contactors !! shapes
    type(contacts_t), intent(in) :: contacts !! contacts of the step; those of a pair stand together
    integer, intent(in) :: k !! contact
    integer :: first, last

    if (contactors%kind(contacts%contactor(1, k)) == kind_disk) then
      surface = disk_surface(contactors, contacts%contactor(:, k))
    else if (contacts%dimension == 2) then
      call find_pair(contacts, k, first, last)
      if (last > first) then
        surface = norm2(contacts%point(:, last) - contacts%point(:, first))/2
      else
        surface = corner*joint_radius(contactors, contacts%contactor(:, k))
      end if
    else if (contactors%kind(contacts%contactor(1, k)) == kind_polyhedron) then
      call find_pair(contacts, k, first, last)
      surface = patch_area(contacts%point(:, first:last), contacts%normal(:, k))/real(last - first + 1, wp)
    else
      surface = round_surface(contactors, contacts%contactor(:, k))
    end if
  end function contact_surface

  !> First and last contact of the pair of a contact.
  pure subroutine find_pair(contacts, k, first, last)
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    integer, intent(out) :: first, last

    first = k
    do while (first > 1)
      if (.not. is_same(first - 1)) exit
      first = first - 1
    end do
    last = k
    do while (last < contacts%n)
      if (.not. is_same(last + 1)) exit
      last = last + 1
    end do
  contains
    !> Is another contact one of the same two shapes, in the same period?
    pure logical function is_same(other)
      integer, intent(in) :: other

      is_same = all(contacts%contactor(:, other) == contacts%contactor(:, k)) .and. contacts%image(other) == contacts%image(k)
      if (contacts%dimension == 3) is_same = is_same .and. contacts%image_y(other) == contacts%image_y(k)
    end function is_same
  end subroutine find_pair

  !> Disks: R_c R_a/(R_c + R_a) of two, R against anything else.
  pure real(wp) function disk_surface(contactors, pair) result(surface)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: pair(2)

    surface = contactors%disk_radius(contactors%row(pair(1)))
    if (contactors%kind(pair(2)) == kind_disk) surface = joined(surface, contactors%disk_radius(contactors%row(pair(2))))
  end function disk_surface

  !> Radius that a corner between polygons has; of a segment half of that of the polygon counts.
  pure real(wp) function joint_radius(contactors, pair) result(radius)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: pair(2)

    if (any(contactors%kind(pair) == kind_segment)) then
      radius = contactors%reach(pair(1))/2
    else
      radius = joined(contactors%reach(pair(1)), contactors%reach(pair(2)))
    end if
  end function joint_radius

  !> Spheres and cylinders.
  pure real(wp) function round_surface(contactors, pair) result(surface)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: pair(2)
    real(wp) :: radius, height

    associate (row => contactors%row(pair), kind => contactors%kind(pair))
      if (kind(1) == kind_sphere) then
        radius = contactors%space%sphere_radius(row(1))
        if (kind(2) == kind_sphere) radius = joined(radius, contactors%space%sphere_radius(row(2)))
        surface = pi*radius**2
        return
      end if
      height = contactors%space%cylinder_size(1, row(1))
      radius = contactors%space%cylinder_size(2, row(1))
      if (kind(2) == kind_cylinder) then
        height = min(height, contactors%space%cylinder_size(1, row(2)))
        radius = joined(radius, contactors%space%cylinder_size(2, row(2)))
      else if (kind(2) == kind_hollow_cylinder) then
        height = min(height, contactors%space%hollow_size(1, row(2)))
      end if
      surface = height*radius
    end associate
  end function round_surface

  !> R_c R_a/(R_c + R_a).
  pure real(wp) function joined(one, other)
    real(wp), intent(in) :: one, other

    joined = one*other/(one + other)
  end function joined

  !> Area of the convex polygon of up to four points, seen along a normal; zero for a line or a spot [m2].
  pure real(wp) function patch_area(point, normal) result(area)
    real(wp), intent(in) :: point(:, :), normal(3)

    area = 0
    select case (size(point, 2))
    case (3)
      area = abs(seen(2, 1, 3, 1))/2
    case (4:)
      ! Of the three ways to pair four points off, the diagonals of the convex polygon span the largest area.
      area = max(abs(seen(2, 1, 4, 3)), abs(seen(3, 1, 4, 2)), abs(seen(4, 1, 3, 2)))/2
    end select
  contains
    !> Area that the lines from b to a and from d to c span, with its sign.
    pure real(wp) function seen(a, b, c, d)
      integer, intent(in) :: a, b, c, d

      seen = dot_product(normal, cross(point(:, a) - point(:, b), point(:, c) - point(:, d)))
    end function seen
  end function patch_area
end module sg_contact_surface
