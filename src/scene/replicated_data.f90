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
    integer :: i, n

    n = 0
    if (allocated(scene%drives)) n = size(scene%drives)
    allocate (replicated%drives(n))
    do i = 1, n
      replicated%drives(i) = scene%drives(i)
      replicated%drives(i)%body = number_of(scene, scene%drives(i)%body)
    end do
    n = 0
    if (allocated(scene%pressures)) n = size(scene%pressures)
    allocate (replicated%pressures(n))
    do i = 1, n
      replicated%pressures(i) = scene%pressures(i)
      replicated%pressures(i)%body = number_of(scene, scene%pressures(i)%body)
      replicated%pressures(i)%between(1) = number_of(scene, scene%pressures(i)%between(1))
      replicated%pressures(i)%between(2) = number_of(scene, scene%pressures(i)%between(2))
    end do
  end subroutine keep_replicated

  !> Number of a body in the whole scene; zero stays zero.
  pure integer function number_of(scene, body) result(number)
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
    integer :: i, n

    if (allocated(local%drives)) deallocate (local%drives)
    if (allocated(local%pressures)) deallocate (local%pressures)
    n = 0
    do i = 1, size(replicated%drives)
      if (local_body(local%bodies, replicated%drives(i)%body) > 0) n = n + 1
    end do
    allocate (local%drives(n))
    n = 0
    do i = 1, size(replicated%drives)
      if (local_body(local%bodies, replicated%drives(i)%body) == 0) cycle
      n = n + 1
      local%drives(n) = replicated%drives(i)
      local%drives(n)%body = local_body(local%bodies, replicated%drives(i)%body)
    end do
    n = 0
    do i = 1, size(replicated%pressures)
      if (local_body(local%bodies, replicated%pressures(i)%body) > 0) n = n + 1
    end do
    allocate (local%pressures(n))
    n = 0
    do i = 1, size(replicated%pressures)
      if (local_body(local%bodies, replicated%pressures(i)%body) == 0) cycle
      n = n + 1
      local%pressures(n) = replicated%pressures(i)
      call localise_pressure(local, local%pressures(n)%body, local%pressures(n)%between)
    end do
    if (allocated(local%names)) deallocate (local%names)
  end subroutine localise

  !> Numbers of the whole scene become local ones; zero stays zero. What bounds a pressed length is replicated, so it is here.
  pure subroutine localise_pressure(local, body, between)
    type(scene_t), intent(in) :: local
    integer, intent(inout) :: body, between(2)
    integer :: k

    body = local_body(local%bodies, body)
    do k = 1, 2
      between(k) = local_body(local%bodies, between(k))
    end do
  end subroutine localise_pressure
end module sg_replicated_data
