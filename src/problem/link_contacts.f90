!> Contacts that are links: what they carry, how long they are, and what a step leaves of them (doc/theory/links.md).
module sg_link_contacts
  use sg_contactors, only: kind_point
  use sg_contacts, only: contacts_t, image_of, normal_impulse
  use sg_internal_values, only: n_internal_of
  use sg_kinds, only: wp
  use sg_laws, only: law_bond, local_law_t, status_broken, status_none, status_stick
  use sg_link_laws, only: link_energy, link_law, pulls_only, tears
  use sg_mapping, only: relative_velocity
  use sg_mapping_space, only: space_relative_velocity, tangent_of
  use sg_rotations, only: turned_by
  use sg_scene, only: image_shift, scene_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: is_link, law_of_link, tension, finish_links, energy_of_links

contains

  !> Is a contact a link?
  pure logical function is_link(scene, contacts, k)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact

    is_link = scene%links%n > 0
    if (is_link) is_link = scene%contactors%kind(contacts%contactor(1, k)) == kind_point
  end function is_link

  !> Impulse by which a link pulls its ends together [N s]; negative where it pushes them apart.
  pure real(wp) function tension(scene, contacts, k)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact, a link

    tension = normal_impulse(contacts, k)
    if (.not. pulls_only(scene%laws(contacts%law(k)))) tension = -tension
  end function tension

  !> What the law of a link asks in this step.
  pure function law_of_link(scene, contacts, k, time_step) result(law)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact, a link
    real(wp), intent(in) :: time_step !! time step [s]
    type(local_law_t) :: law
    real(wp) :: state(3), t(3)

    state = 0
    associate (l => contacts%feature(k), links => scene%links, own => scene%laws(contacts%law(k)))
      if (own%kind == law_bond .and. scene%dimension == 2) then
        state(:2) = contacts%internal(:2, k)
      else if (own%kind == law_bond) then
        t = tangent_of(contacts%normal(:, k))
        state(1) = contacts%internal(1, k)
        state(2:) = [dot_product(t, contacts%internal(2:4, k)), &
                     dot_product(cross(contacts%normal(:, k), t), contacts%internal(2:4, k))]
      end if
      law = link_law(own, contacts%gap(k), links%length(l), [links%area(l), links%mass(l)], state, time_step, contacts%status(k))
      if (own%is_joint) law%bias = way_between(scene, contacts, k)/time_step
    end associate
  end function law_of_link

  !> Way from the antagonist's point of a joint to the candidate's in the configuration of detection, along the normal and the
  !! tangents of the contact [m]: what rounding and the turn of a step leave of it, the next one takes away.
  pure function way_between(scene, contacts, k) result(way)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: way(3), ends(3, 2), shift(3), angle, tangent(3), normal(3)
    integer :: side, b, d

    d = scene%dimension
    ends = 0
    do side = 1, 2
      b = contacts%body(side, k)
      shift = 0
      shift(:d) = scene%contactors%shift(:, contacts%contactor(side, k))
      if (d == 3 .and. size(scene%bodies%middle, 1) == 7) then
        shift = turned_by(scene%bodies%middle(4:7, b), shift)
      else if (d == 2 .and. size(scene%bodies%middle, 1) == 3) then
        angle = scene%bodies%middle(3, b)
        shift = [cos(angle)*shift(1) - sin(angle)*shift(2), sin(angle)*shift(1) + cos(angle)*shift(2), 0.0_wp]
      end if
      ends(:d, side) = scene%bodies%middle(:d, b) + shift(:d)
    end do
    way = ends(:, 1) - ends(:, 2) - image_shift(scene, image_of(contacts, k))
    normal = 0
    normal(:d) = contacts%normal(:d, k)
    if (d == 2) then
      way = [dot_product(normal, way), normal(2)*way(1) - normal(1)*way(2), 0.0_wp]
    else
      tangent = tangent_of(normal)
      way = [dot_product(normal, way), dot_product(tangent, way), dot_product(cross(normal, tangent), way)]
    end if
  end function way_between

  !> Set what the links did in a step that is solved: nothing (a slack wire), something, or that they broke; and how far the ends of
  !! bonds moved across them.
  pure subroutine finish_links(scene, contacts, time_step)
    type(scene_t), intent(in) :: scene !! scene with its links, `free_velocity` that of the end of the step
    type(contacts_t), intent(inout) :: contacts !! contacts of the step, solved
    real(wp), intent(in) :: time_step !! time step [s]
    integer :: k

    if (scene%links%n == 0) return
    do k = 1, contacts%n
      if (.not. is_link(scene, contacts, k)) cycle
      if (contacts%status(k) == status_broken) cycle
      contacts%status(k) = status_none
      if (any(abs(contacts%impulse(:, k)) > 0)) contacts%status(k) = status_stick
      if (tears(scene%laws(contacts%law(k)), tension(scene, contacts, k)/time_step)) contacts%status(k) = status_broken
      if (scene%laws(contacts%law(k))%kind == law_bond) call move_across(scene, contacts, k, time_step)
    end do
  end subroutine finish_links

  !> Add to the displacement across a bond what its ends moved in the step.
  pure subroutine move_across(scene, contacts, k, time_step)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: time_step
    real(wp) :: u(3)

    if (scene%dimension == 2) then
      u(:2) = relative_velocity(contacts, k, scene%bodies%middle, scene%period, scene%bodies%free_velocity)
      contacts%internal(2, k) = contacts%internal(2, k) + time_step*u(2)
    else
      u = space_relative_velocity(scene, contacts, k, scene%bodies%free_velocity)
      associate (n => contacts%normal(:, k))
        contacts%internal(2:4, k) = contacts%internal(2:4, k) + time_step*(u - dot_product(u, n)*n)
      end associate
    end if
  end subroutine move_across

  !> Elastic energy of all links that hold, along them and across them [J], from where their bodies are at the end of the step.
  pure function energy_of_links(scene, contacts) result(energy)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    real(wp) :: energy(2), state(4)
    integer :: k, n

    energy = 0
    if (scene%links%n == 0) return
    do k = 1, contacts%n
      if (.not. is_link(scene, contacts, k)) cycle
      if (contacts%status(k) == status_broken) cycle
      associate (l => contacts%feature(k), links => scene%links, own => scene%laws(contacts%law(k)))
        state = 0
        n = merge(n_internal_of(own, scene%dimension), 0, own%kind == law_bond)
        state(:n) = contacts%internal(:n, k)
        energy = energy + link_energy(own, length_now(scene, contacts, k), links%length(l), [links%area(l), links%mass(l)], state)
      end associate
    end do
  end function energy_of_links

  !> Length of a link where its bodies are now, not where contacts were sought [m].
  pure real(wp) function length_now(scene, contacts, k) result(length)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: ends(scene%dimension, 2), angle
    integer :: side, b

    do side = 1, 2
      b = contacts%body(side, k)
      associate (shift => scene%contactors%shift(:, contacts%contactor(side, k)))
        ends(:, side) = scene%bodies%position(:, b)
        if (scene%dimension == 3) then
          ends(:, side) = ends(:, side) + turned_by(scene%bodies%orientation(:, b), shift)
        else
          angle = scene%bodies%angle(b)
          ends(:, side) = ends(:, side) + [cos(angle)*shift(1) - sin(angle)*shift(2), sin(angle)*shift(1) + cos(angle)*shift(2)]
        end if
      end associate
    end do
    ends(1, 2) = ends(1, 2) + scene%period*real(contacts%image(k), wp)
    if (scene%dimension == 3) ends(2, 2) = ends(2, 2) + scene%period_y*real(contacts%image_y(k), wp)
    length = norm2(ends(:, 1) - ends(:, 2))
  end function length_now
end module sg_link_contacts
