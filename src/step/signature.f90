!> What tells scenes apart that have as many bodies: for restart files, which hold no shapes and no masses.
module sg_signature
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  implicit none
  private
  public :: signature_of, n_signature

  !> Numbers of a scene's signature
  integer, parameter :: n_signature = 5

contains

  !> What tells scenes apart that have as many bodies: sums over bodies and contactors, each weighted by its place.
  pure function signature_of(scene) result(signature)
    type(scene_t), intent(in) :: scene !! whole scene
    real(wp) :: signature(n_signature)
    real(wp) :: inertia(scene%bodies%n)
    integer :: i, n

    n = scene%contactors%n
    if (scene%dimension == 2) then
      inertia = scene%bodies%inertia
    else
      inertia = sum(scene%bodies%principal, 1)
    end if
    signature = [real(n, wp), sum(scene%bodies%mass*[(real(i, wp), i=1, scene%bodies%n)]), &
                 sum(inertia*[(real(i, wp), i=1, scene%bodies%n)]), &
                 sum(scene%contactors%reach(:n)*[(real(i, wp), i=1, n)]), real(size(scene%drives), wp)]
  end function signature_of
end module sg_signature
