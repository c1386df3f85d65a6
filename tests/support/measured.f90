!> Measures of a scene put together by hand, and what follows from them: mean stress tensor, box of the grains.
module measured
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_energy, only: energy_t
  use sg_kinds, only: wp
  use sg_measures, only: measure, measures_t
  use sg_scene, only: scene_t
  implicit none
  private
  public :: measures_of, measures_without_contacts, mean_stress, box_of_scene, overlap_of_scene

contains

  !> Measures of a scene that is not decomposed, its energies not followed.
  function measures_of(scene, contacts, h) result(measures)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(measures_t) :: measures
    type(energy_t) :: energy

    call measure(scene, contacts, h, energy, measures)
  end function measures_of

  !> Measures of a scene in which no bodies touch.
  function measures_without_contacts(scene) result(measures)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    type(measures_t) :: measures
    type(contacts_t) :: contacts

    call reserve_contacts(contacts, 1)
    measures = measures_of(scene, contacts, 1.0_wp)
  end function measures_without_contacts

  !> Mean stress of the grains over their box [Pa]: component (a, b) is force along a, branch along b.
  function mean_stress(scene, contacts, h) result(stress)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp) :: stress(scene%dimension, scene%dimension)
    type(measures_t) :: measures
    character(len=*), parameter :: axis = 'xyz'
    integer :: a, b

    measures = measures_of(scene, contacts, h)
    do b = 1, scene%dimension
      do a = 1, scene%dimension
        stress(a, b) = measures%get('stress_'//axis(a:a)//axis(b:b))
      end do
    end do
  end function mean_stress

  !> Area of the box of the grains [m2], in space its volume [m3]: their own over the compactness.
  real(wp) function box_of_scene(scene) result(box)
    type(scene_t), intent(in) :: scene !! scene with at least one grain, its contactors placed
    type(measures_t) :: measures

    measures = measures_without_contacts(scene)
    box = sum(scene%bodies%area, mask=scene%bodies%is_grain)/measures%get('compactness')
  end function box_of_scene

  !> Area of all overlaps of shapes [m2], in space their volume [m3]: the volume error times that of the grains.
  real(wp) function overlap_of_scene(scene, contacts) result(overlap)
    type(scene_t), intent(in) :: scene !! scene with at least one grain, its contactors placed
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(measures_t) :: measures

    measures = measures_of(scene, contacts, 1.0_wp)
    overlap = measures%get('volume_error')*sum(scene%bodies%area, mask=scene%bodies%is_grain)
  end function overlap_of_scene
end module measured
