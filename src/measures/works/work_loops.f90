!> Loops over contacts that add up the work of their impulses, over plain arrays, their sums in registers (doc/theory/indicators.md,
!! "Energy").
module sg_work_loops
  use sg_kinds, only: wp, i1, i4
  implicit none
  private
  public :: work_in_plane, work_in_space, work_of_balls, work_of_disks

contains

  !> Work along normals and along tangents in the plane [J]: r . `relative_velocity`.
  pure function work_in_plane(n, n_components, n_bodies, n_velocity, n_middle, body, image, normal, point, gap, impulse, period, &
                              middle, velocity) result(work)
    integer, intent(in) :: n, n_components !! contacts and components of their impulses
    integer, intent(in) :: n_bodies, n_velocity, n_middle !! bodies, components of their velocities and configurations
    integer(i4), intent(in) :: body(2, n) !! bodies of contacts
    integer(i1), intent(in) :: image(n) !! periods by which antagonists are moved
    real(wp), intent(in) :: normal(2, n), point(2, n), gap(n) !! geometry as in `contacts_t`
    real(wp), intent(in) :: impulse(n_components, n) !! impulses [N s]
    real(wp), intent(in) :: period !! of the scene in x [m]
    real(wp), intent(in) :: middle(n_middle, n_bodies) !! configuration of detection
    real(wp), intent(in) :: velocity(n_velocity, n_bodies) !! velocities [m/s, rad/s]
    real(wp) :: work(2), along_normals, along_tangents, r_n, r_t, x, y, half, ux, uy
    integer :: k

    along_normals = 0
    along_tangents = 0
    do k = 1, n
      r_n = impulse(1, k)
      r_t = 0
      if (n_components == 2) r_t = impulse(2, k)
      if (.not. abs(r_n) + abs(r_t) > 0) cycle
      associate (c => body(1, k), a => body(2, k))
        x = normal(1, k)
        y = normal(2, k)
        ux = velocity(1, c) - velocity(1, a)
        uy = velocity(2, c) - velocity(2, a)
        if (n_velocity == 3) then
          half = gap(k)/2
          ux = ux - velocity(3, c)*(point(2, k) + half*y - middle(2, c)) + velocity(3, a)*(point(2, k) - half*y - middle(2, a))
          uy = uy + velocity(3, c)*(point(1, k) + half*x - middle(1, c)) &
               - velocity(3, a)*(point(1, k) - half*x - middle(1, a) - period*real(image(k), wp))
        end if
        along_normals = along_normals + r_n*(x*ux + y*uy)
        along_tangents = along_tangents + r_t*(y*ux - x*uy)
      end associate
    end do
    work = [along_normals, along_tangents]
  end function work_in_plane

  !> The same in space, where impulses are vectors or along the normal alone.
  pure function work_in_space(n, n_components, n_bodies, n_spins, n_velocity, n_middle, body, image, image_y, normal, point, gap, &
                              impulse, period, middle, velocity, spin) result(work)
    integer, intent(in) :: n, n_components !! contacts and components of their impulses
    integer, intent(in) :: n_bodies, n_spins, n_velocity, n_middle !! bodies, spins (0 where nothing turns), components as above
    integer(i4), intent(in) :: body(2, n) !! bodies of contacts
    integer(i1), intent(in) :: image(n), image_y(n) !! periods by which antagonists are moved
    real(wp), intent(in) :: normal(3, n), point(3, n), gap(n) !! geometry as in `contacts_t`
    real(wp), intent(in) :: impulse(n_components, n) !! impulses [N s]
    real(wp), intent(in) :: period(2) !! of the scene in x and y [m]
    real(wp), intent(in) :: middle(n_middle, n_bodies) !! configuration of detection
    real(wp), intent(in) :: velocity(n_velocity, n_bodies), spin(3, n_spins) !! velocities, and spins in the world's axes
    real(wp) :: work(2), along_normals, along_tangents, of_normal, r(3), along(3), x, y, z, ux, uy, uz
    integer :: k

    along_normals = 0
    along_tangents = 0
    do k = 1, n
      if (n_components == 3) then
        r = impulse(1:3, k)
      else
        r = impulse(1, k)*normal(:, k)
      end if
      if (.not. abs(r(1)) + abs(r(2)) + abs(r(3)) > 0) cycle
      associate (c => body(1, k), a => body(2, k))
        ux = velocity(1, c) - velocity(1, a)
        uy = velocity(2, c) - velocity(2, a)
        uz = velocity(3, c) - velocity(3, a)
        along = normal(:, k)
        if (n_spins > 0) then
          x = point(1, k) + gap(k)/2*along(1) - middle(1, c)
          y = point(2, k) + gap(k)/2*along(2) - middle(2, c)
          z = point(3, k) + gap(k)/2*along(3) - middle(3, c)
          ux = ux + spin(2, c)*z - spin(3, c)*y
          uy = uy + spin(3, c)*x - spin(1, c)*z
          uz = uz + spin(1, c)*y - spin(2, c)*x
          x = point(1, k) - gap(k)/2*along(1) - middle(1, a) - period(1)*real(image(k), wp)
          y = point(2, k) - gap(k)/2*along(2) - middle(2, a) - period(2)*real(image_y(k), wp)
          z = point(3, k) - gap(k)/2*along(3) - middle(3, a)
          ux = ux - (spin(2, a)*z - spin(3, a)*y)
          uy = uy - (spin(3, a)*x - spin(1, a)*z)
          uz = uz - (spin(1, a)*y - spin(2, a)*x)
        end if
        of_normal = (along(1)*r(1) + along(2)*r(2) + along(3)*r(3))*(along(1)*ux + along(2)*uy + along(3)*uz)
        along_normals = along_normals + of_normal
        along_tangents = along_tangents + (r(1)*ux + r(2)*uy + r(3)*uz - of_normal)
      end associate
    end do
    work = [along_normals, merge(along_tangents, 0.0_wp, n_components == 3)]
  end function work_in_space

  !> Work along normals and along tangents of disks with friction, whose lever arms are their radii.
  pure function work_of_disks(n, n_bodies, body, normal, impulse, radius, velocity) result(work)
    integer, intent(in) :: n, n_bodies !! contacts and bodies
    integer(i4), intent(in) :: body(2, n) !! bodies of contacts
    real(wp), intent(in) :: normal(2, n), impulse(2, n) !! normals and impulses [N s]
    real(wp), intent(in) :: radius(n_bodies), velocity(3, n_bodies) !! signed radii [m] and velocities [m/s, rad/s]
    real(wp) :: work(2), along_normals, along_tangents, ux, uy, turning
    integer :: k

    along_normals = 0
    along_tangents = 0
    do k = 1, n
      associate (c => body(1, k), a => body(2, k), x => normal(1, k), y => normal(2, k))
        ux = velocity(1, c) - velocity(1, a)
        uy = velocity(2, c) - velocity(2, a)
        turning = radius(c)*velocity(3, c) + radius(a)*velocity(3, a)
        along_normals = along_normals + impulse(1, k)*(x*ux + y*uy)
        along_tangents = along_tangents + impulse(2, k)*(y*ux - x*uy + turning)
      end associate
    end do
    work = [along_normals, along_tangents]
  end function work_of_disks

  !> The same of balls, whose impulses are vectors.
  pure function work_of_balls(n, n_bodies, body, normal, impulse, radius, velocity, spin) result(work)
    integer, intent(in) :: n, n_bodies !! contacts and bodies
    integer(i4), intent(in) :: body(2, n) !! bodies of contacts
    real(wp), intent(in) :: normal(3, n), impulse(3, n) !! normals and impulses [N s]
    real(wp), intent(in) :: radius(n_bodies), velocity(6, n_bodies) !! radii [m] and velocities [m/s, rad/s]
    real(wp), intent(in) :: spin(3, n_bodies) !! spins in the world's axes [rad/s]
    real(wp) :: work(2), along_normals, along_tangents, of_normal, ux, uy, uz, sx, sy, sz
    integer :: k

    along_normals = 0
    along_tangents = 0
    do k = 1, n
      associate (c => body(1, k), a => body(2, k), x => normal(1, k), y => normal(2, k), z => normal(3, k), r => impulse(:, k))
        ux = velocity(1, c) - velocity(1, a)
        uy = velocity(2, c) - velocity(2, a)
        uz = velocity(3, c) - velocity(3, a)
        of_normal = (x*r(1) + y*r(2) + z*r(3))*(x*ux + y*uy + z*uz)
        sx = radius(c)*spin(1, c) + radius(a)*spin(1, a)
        sy = radius(c)*spin(2, c) + radius(a)*spin(2, a)
        sz = radius(c)*spin(3, c) + radius(a)*spin(3, a)
        ux = ux - sy*z + sz*y
        uy = uy - sz*x + sx*z
        uz = uz - sx*y + sy*x
        along_normals = along_normals + of_normal
        along_tangents = along_tangents + (r(1)*ux + r(2)*uy + r(3)*uz - of_normal)
      end associate
    end do
    work = [along_normals, along_tangents]
  end function work_of_balls
end module sg_work_loops
