!> The mean stress of the grains from contact forces and branch vectors [Weber1966].
!!
!! sigma = (1/A) sum over contacts of f (x) l: f is the mean force over the step on the candidate, l leads from the
!! antagonist's centre to the candidate's; towards a wall it ends at the point of contact. Compression is positive.
module sg_stress
  use sg_compactness, only: area_of_box
  use sg_contacts, only: contacts_t, image_of
  use sg_kinds, only: wp
  use sg_mapping, only: arms_of
  use sg_scene, only: image_shift, scene_t
  use sg_tally, only: pass_columns, pass_sums, tally_t
  implicit none
  private
  public :: measure_pressure, measure_stress, mean_pressure, branch_of, stress_sums

contains

  !> Mean of the normal stresses [Pa], and the sums of `measure_stress`.
  pure subroutine measure_pressure(scene, contacts, tally)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    type(tally_t), intent(inout) :: tally !! tally of the measure

    if (tally%pass == pass_sums) call tally%sums%put('stress', reshape(stress_sums(scene, contacts), [scene%dimension**2]))
    if (tally%pass == pass_columns) call tally%add('pressure', mean_pressure(scene, tally))
  end subroutine measure_pressure

  !> All components of the mean stress [Pa]: the first axis is that of the force, the second that of the branch.
  pure subroutine measure_stress(scene, tally)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: stress(scene%dimension, scene%dimension)
    character(len=*), parameter :: axis = 'xyz'
    integer :: a, b

    if (tally%pass /= pass_columns) return
    stress = mean_stress(scene, tally)
    do a = 1, scene%dimension
      do b = 1, scene%dimension
        call tally%add('stress_'//axis(a:a)//axis(b:b), stress(a, b))
      end do
    end do
  end subroutine measure_stress

  !> Mean stress of the grains over their box [Pa]; zero without a box.
  pure function mean_stress(scene, tally) result(stress)
    type(scene_t), intent(in) :: scene
    type(tally_t), intent(in) :: tally
    real(wp) :: stress(scene%dimension, scene%dimension), box

    stress = 0
    box = area_of_box(scene, tally)
    if (box*tally%h > 0) stress = reshape(tally%sums%get('stress', size(stress)), shape(stress))/(box*tally%h)
  end function mean_stress

  !> Mean of the normal stresses [Pa].
  pure real(wp) function mean_pressure(scene, tally) result(pressure)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(tally_t), intent(in) :: tally !! tally of the measure, combined
    real(wp) :: stress(scene%dimension, scene%dimension)
    integer :: a

    stress = mean_stress(scene, tally)
    pressure = sum([(stress(a, a), a=1, scene%dimension)])/real(scene%dimension, wp)
  end function mean_pressure

  !> Sum over this rank's contacts of impulse (x) branch [N s m]. The list is allocatable since an absent one of assumed shape,
  !! handed on, has the compiler compute with unset strides.
  pure function stress_sums(scene, contacts, is_counted) result(sums)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    logical, allocatable, intent(in), optional :: is_counted(:) !! contacts that count; all unless given
    real(wp) :: sums(scene%dimension, scene%dimension), all_sums(3, 3)

    all_sums = 0
    if (scene%dimension == 2) then
      call add_in_plane(scene, contacts, all_sums, is_counted)
    else
      call add_in_space(scene, contacts, all_sums, is_counted)
    end if
    sums = all_sums(:scene%dimension, :scene%dimension)
  end function stress_sums

  !> Add impulse (x) branch of contacts in the plane: the terms of `impulse_vector` and `branch_of` in one pass.
  pure subroutine add_in_plane(scene, contacts, sums, is_counted)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(inout) :: sums(3, 3)
    logical, allocatable, intent(in), optional :: is_counted(:)
    real(wp) :: normal, tangential, x, y, impulse_x, impulse_y, branch_x, branch_y
    integer :: k, c, a

    do k = 1, contacts%n
      if (present(is_counted)) then
        if (.not. is_counted(k)) cycle
      end if
      normal = contacts%impulse(1, k)
      tangential = 0
      if (contacts%n_components == 2) tangential = contacts%impulse(2, k)
      if (.not. abs(normal) + abs(tangential) > 0) cycle
      associate (n => contacts%normal(:, k), middle => scene%bodies%middle, is_grain => scene%bodies%is_grain)
        impulse_x = normal*n(1) + tangential*n(2)
        impulse_y = normal*n(2) - tangential*n(1)
        c = contacts%body(1, k)
        a = contacts%body(2, k)
        branch_x = 0
        branch_y = 0
        if (is_grain(c)) then
          branch_x = middle(1, c) - contacts%point(1, k)
          branch_y = middle(2, c) - contacts%point(2, k)
        end if
        if (is_grain(a)) then
          x = middle(1, a) + scene%period*real(contacts%image(k), wp)
          y = middle(2, a)
          if (contacts%has_cell) then
            x = x + contacts%upwards(1)*real(contacts%image_y(k), wp)
            y = y + contacts%upwards(2)*real(contacts%image_y(k), wp)
          end if
          branch_x = branch_x + (contacts%point(1, k) - x)
          branch_y = branch_y + (contacts%point(2, k) - y)
        end if
      end associate
      sums(1, 1) = sums(1, 1) + impulse_x*branch_x
      sums(2, 1) = sums(2, 1) + impulse_y*branch_x
      sums(1, 2) = sums(1, 2) + impulse_x*branch_y
      sums(2, 2) = sums(2, 2) + impulse_y*branch_y
    end do
  end subroutine add_in_plane

  !> The same of contacts in space.
  pure subroutine add_in_space(scene, contacts, sums, is_counted)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(inout) :: sums(3, 3)
    logical, allocatable, intent(in), optional :: is_counted(:)
    real(wp) :: impulse(3), branch(3)
    integer :: k

    do k = 1, contacts%n
      if (present(is_counted)) then
        if (.not. is_counted(k)) cycle
      end if
      impulse = contacts%impulse(1, k)*contacts%normal(1:3, k)
      if (contacts%n_components == 3) impulse = contacts%impulse(1:3, k)
      if (.not. abs(impulse(1)) + abs(impulse(2)) + abs(impulse(3)) > 0) cycle
      branch = space_branch(scene, contacts, k)
      sums(:, 1) = sums(:, 1) + impulse*branch(1)
      sums(:, 2) = sums(:, 2) + impulse*branch(2)
      sums(:, 3) = sums(:, 3) + impulse*branch(3)
    end do
  end subroutine add_in_space

  !> From the antagonist's centre, or from the point of contact on a wall, to the candidate's [m]. Arrays of three: of the dimension
  !! of the scene they would be asked of the system for each contact.
  pure function branch_of(scene, contacts, k) result(branch)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp) :: branch(3), arms(2, 2), half_gap(2)

    if (scene%dimension == 3) then
      branch = space_branch(scene, contacts, k)
      return
    end if
    arms = arms_of(contacts, k, scene%bodies%middle, scene%period)
    half_gap = contacts%gap(k)/2*contacts%normal(1:2, k)
    branch = 0
    if (scene%bodies%is_grain(contacts%body(1, k))) branch(:2) = branch(:2) - arms(:, 1) + half_gap
    if (scene%bodies%is_grain(contacts%body(2, k))) branch(:2) = branch(:2) + arms(:, 2) + half_gap
  end function branch_of

  !> The same in space, without the gap, which would enter twice and cancel.
  pure function space_branch(scene, contacts, k) result(branch)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: branch(3), shift(3)

    branch = 0
    associate (c => contacts%body(1, k), a => contacts%body(2, k), middle => scene%bodies%middle)
      if (scene%bodies%is_grain(c)) branch = middle(1:3, c) - contacts%point(1:3, k)
      if (.not. scene%bodies%is_grain(a)) return
      if (scene%cell%is_on) then
        shift = image_shift(scene, image_of(contacts, k))
      else
        shift = [scene%period*real(contacts%image(k), wp), scene%period_y*real(contacts%image_y(k), wp), 0.0_wp]
      end if
      branch = branch + (contacts%point(1:3, k) - (middle(1:3, a) + shift))
    end associate
  end function space_branch
end module sg_stress
