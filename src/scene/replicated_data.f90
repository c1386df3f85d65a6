!> Replicated data: drives and pressures, which every rank of a decomposed scene keeps with the numbers of the whole scene.
module sg_replicated_data
  use sg_drives, only: drive_t, pressure_t
  use sg_local_numbers, only: local_body
  use sg_scene, only: scene_t
  implicit none
  private
  public :: replicated_data_t, keep_replicated, localise

  !> Few things, however many bodies there are
  type :: replicated_data_t
    !> Imposed velocities and forces
    type(drive_t), allocatable :: drives(:)
    !> Pressed walls
    type(pressure_t), allocatable :: pressures(:)
  end type replicated_data_t

contains

  !> Keep the data of a scene that all ranks need.
  subroutine keep_replicated(scene, replicated)
    type(scene_t), intent(in) :: scene !! the whole scene, or a part with all bodies that are driven or pressed
    type(replicated_data_t), intent(out) :: replicated !! what is kept
    integer :: k, i

    allocate (replicated%drives(0), replicated%pressures(0))
    if (allocated(scene%drives)) replicated%drives = scene%drives
    if (allocated(scene%pressures)) replicated%pressures = scene%pressures
    replicated%drives%body = number_of(scene, replicated%drives%body)
    replicated%pressures%body = number_of(scene, replicated%pressures%body)
    do k = 1, 2
      replicated%pressures%between(k) = number_of(scene, replicated%pressures%between(k))
      replicated%pressures%chain(k) = number_of(scene, replicated%pressures%chain(k))
    end do
    do i = 1, size(replicated%pressures)
      replicated%pressures(i)%sides = number_of(scene, replicated%pressures(i)%sides)
    end do
  end subroutine keep_replicated

  !> Number of a body in the whole scene; zero stays zero.
  elemental integer function number_of(scene, body) result(number)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body

    number = body
    if (body > 0 .and. allocated(scene%bodies%id)) number = scene%bodies%id(body)
  end function number_of

  !> Give the scene of a rank its drives and pressures: those of bodies that are here, in the order of the whole. Names are of use
  !! while a deck is read alone, and dropped.
  subroutine localise(replicated, local)
    type(replicated_data_t), intent(in) :: replicated !! drives and pressures of the whole scene
    type(scene_t), intent(inout) :: local !! scene of the rank; its drives and pressures are set
    integer :: k, i

    local%drives = pack(replicated%drives, place_of(local, replicated%drives%body) > 0)
    local%drives%body = place_of(local, local%drives%body)
    local%pressures = pack(replicated%pressures, place_of(local, replicated%pressures%body) > 0)
    local%pressures%body = place_of(local, local%pressures%body)
    do k = 1, 2
      ! What bounds a pressed length is replicated, so it is here.
      local%pressures%between(k) = place_of(local, local%pressures%between(k))
      local%pressures%chain(k) = place_of(local, local%pressures%chain(k))
    end do
    do i = 1, size(local%pressures)
      local%pressures(i)%sides = place_of(local, local%pressures(i)%sides)
    end do
    if (allocated(local%names)) deallocate (local%names)
  end subroutine localise

  !> Place here of a body of the whole scene; zero where there is none.
  elemental integer function place_of(local, number)
    type(scene_t), intent(in) :: local
    integer, intent(in) :: number

    place_of = local_body(local%bodies, number)
  end function place_of
end module sg_replicated_data
