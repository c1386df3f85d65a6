!> Loops over runs of contacts that are carried from one substep to the next, over plain arrays (doc/theory/substeps.md).
module sg_carry_loops
  use sg_follow, only: follow_in_plane
  use sg_kinds, only: wp, i1, i4
  implicit none
  private
  public :: chunk, follow_faces, measure_disks, measure_spheres, turn_by

  !> Contacts of a run at most: what several loops need of them stays in the first cache
  integer, parameter :: chunk = 128
  !> Distance of centres that gives a normal [m]
  real(wp), parameter :: least = sqrt(tiny(1.0_wp))
  !> Angle [rad] up to which few terms of the series of sine and cosine are exact to rounding
  real(wp), parameter :: small_angle = 5e-3_wp

contains

  !> Measure a run of contacts between disks again: nearly all contacts of many scenes. Where two centres coincide the normal stays.
  pure subroutine measure_disks(n, contactor, image, period, n_contactors, centre, reach, normal, point, gap)
    integer, intent(in) :: n, n_contactors !! contacts, a chunk at most, and contactors
    integer(i4), intent(in) :: contactor(2, n) !! candidates and antagonists
    integer(i1), intent(in) :: image(n) !! periods by which antagonists are moved
    real(wp), intent(in) :: period !! of the scene in x [m]
    real(wp), intent(in) :: centre(2, n_contactors), reach(n_contactors) !! places and radii [m]
    real(wp), intent(inout) :: normal(2, n), point(2, n), gap(n) !! geometry as in `contacts_t`
    real(wp) :: x(chunk), y(chunk), distance(chunk), place
    integer :: i

    ! Gathers are faster number by number.
    !GCC$ NOVECTOR
    do i = 1, n
      x(i) = centre(1, contactor(1, i)) - centre(1, contactor(2, i)) - period*real(image(i), wp)
      y(i) = centre(2, contactor(1, i)) - centre(2, contactor(2, i))
    end do
    ! Side by side, so that roots and quotients go through vector registers.
    do i = 1, n
      distance(i) = sqrt(x(i)**2 + y(i)**2)
    end do
    if (minval(distance(:n)) > least) then
      do i = 1, n
        x(i) = x(i)/distance(i)
        y(i) = y(i)/distance(i)
      end do
    else
      do i = 1, n
        x(i) = merge(x(i)/max(distance(i), least), normal(1, i), distance(i) > least)
        y(i) = merge(y(i)/max(distance(i), least), normal(2, i), distance(i) > least)
      end do
    end if
    !GCC$ NOVECTOR
    do i = 1, n
      associate (c => contactor(1, i), a => contactor(2, i))
        normal(1, i) = x(i)
        normal(2, i) = y(i)
        gap(i) = distance(i) - (reach(c) + reach(a))
        place = reach(c) + gap(i)/2
        point(1, i) = centre(1, c) - place*x(i)
        point(2, i) = centre(2, c) - place*y(i)
      end associate
    end do
  end subroutine measure_disks

  !> The same of spheres.
  pure subroutine measure_spheres(n, contactor, image, image_y, period, n_contactors, centre, reach, normal, point, gap)
    integer, intent(in) :: n, n_contactors !! contacts and contactors
    integer(i4), intent(in) :: contactor(2, n) !! candidates and antagonists
    integer(i1), intent(in) :: image(n), image_y(n) !! periods by which antagonists are moved
    real(wp), intent(in) :: period(2) !! of the scene in x and y [m]
    real(wp), intent(in) :: centre(3, n_contactors), reach(n_contactors) !! places and radii [m]
    real(wp), intent(inout) :: normal(3, n), point(3, n), gap(n) !! geometry as in `contacts_t`
    real(wp) :: x, y, z, distance, place
    integer :: i

    do i = 1, n
      associate (c => contactor(1, i), a => contactor(2, i))
        x = centre(1, c) - centre(1, a) - period(1)*real(image(i), wp)
        y = centre(2, c) - centre(2, a) - period(2)*real(image_y(i), wp)
        z = centre(3, c) - centre(3, a)
        distance = sqrt(x**2 + y**2 + z**2)
        if (distance > least) then
          normal(1, i) = x/distance
          normal(2, i) = y/distance
          normal(3, i) = z/distance
        end if
        gap(i) = distance - (reach(c) + reach(a))
        place = reach(c) + gap(i)/2
        point(1, i) = centre(1, c) - place*normal(1, i)
        point(2, i) = centre(2, c) - place*normal(2, i)
        point(3, i) = centre(3, c) - place*normal(3, i)
      end associate
    end do
  end subroutine measure_spheres

  !> Let a run of contacts of polygons follow their bodies, on plain arrays.
  pure subroutine follow_faces(n, n_middle, n_bodies, face, body, image, period, before, middle, turn, normal, point, gap)
    integer, intent(in) :: n, n_middle, n_bodies !! contacts, values of a configuration, bodies
    integer(i1), intent(in) :: face(n) !! bodies whose faces they lie on, as in `sg_follow`
    integer(i4), intent(in) :: body(2, n) !! candidates and antagonists
    integer(i1), intent(in) :: image(n) !! periods by which antagonists are moved
    real(wp), intent(in) :: period !! of the scene in x [m]
    real(wp), intent(in) :: before(n_middle, n_bodies), middle(n_middle, n_bodies) !! configurations of the last substep and now
    real(wp), intent(in) :: turn(2, n_bodies) !! cosines and sines of the angles by which bodies have turned
    real(wp), intent(inout) :: normal(2, n), point(2, n), gap(n) !! geometry as in `contacts_t`
    real(wp) :: from(2), to(2)
    integer :: i

    do i = 1, n
      associate (c => body(1, i), a => body(2, i))
        from(1) = before(1, a) + period*real(image(i), wp)
        from(2) = before(2, a)
        to(1) = middle(1, a) + period*real(image(i), wp)
        to(2) = middle(2, a)
        call follow_in_plane(face(i), before(1:2, c), from, middle(1:2, c), to, turn(:, c), turn(:, a), normal(:, i), point(:, i), &
                             gap(i))
      end associate
    end do
  end subroutine follow_faces

  !> Cosine and sine of an angle; bodies turn by little between two substeps.
  pure function turn_by(angle) result(turn)
    real(wp), intent(in) :: angle !! [rad]
    real(wp) :: turn(2), square

    square = angle**2
    if (abs(angle) < small_angle) then
      turn(1) = 1 - square/2*(1 - square/12)
      turn(2) = angle*(1 - square/6*(1 - square/20))
    else
      turn(1) = cos(angle)
      turn(2) = sin(angle)
    end if
  end function turn_by
end module sg_carry_loops
