!> What every rank of a decomposed scene keeps of the whole: drives, pressures and names, with the numbers of the whole scene.
module sg_whole
  use sg_drives, only: drive_t, pressure_t
  use sg_kinds, only: i4
  use sg_local_numbers, only: local_body
  use sg_scene, only: scene_t
  use sg_text, only: text_t
  implicit none
  private
  public :: whole_t, keep_whole, localise

  !> Few things, however many bodies there are
  type :: whole_t
    !> Imposed velocities and forces
    type(drive_t), allocatable :: drives(:)
    !> Pressed walls
    type(pressure_t), allocatable :: pressures(:)
    !> Bodies that have a name, and their names; unallocated where the scene has none
    integer(i4), allocatable :: named(:)
    type(text_t), allocatable :: names(:)
  end type whole_t

contains

  !> Keep what a rank needs of the whole scene.
  subroutine keep_whole(scene, whole)
    type(scene_t), intent(in) :: scene !! the whole scene, or a part with all bodies that are driven, pressed or named
    type(whole_t), intent(out) :: whole !! what is kept
    integer :: i, n

    n = 0
    if (allocated(scene%drives)) n = size(scene%drives)
    allocate (whole%drives(n))
    do i = 1, n
      whole%drives(i) = scene%drives(i)
      whole%drives(i)%body = number_of(scene, scene%drives(i)%body)
    end do
    n = 0
    if (allocated(scene%pressures)) n = size(scene%pressures)
    allocate (whole%pressures(n))
    do i = 1, n
      whole%pressures(i) = scene%pressures(i)
      whole%pressures(i)%body = number_of(scene, scene%pressures(i)%body)
      whole%pressures(i)%between(1) = number_of(scene, scene%pressures(i)%between(1))
      whole%pressures(i)%between(2) = number_of(scene, scene%pressures(i)%between(2))
    end do
    if (allocated(scene%names)) call keep_names(scene, scene%names, whole)
  end subroutine keep_whole

  !> Number of a body in the whole scene; zero stays zero.
  pure integer function number_of(scene, body) result(number)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body

    number = body
    if (body > 0 .and. allocated(scene%bodies%id)) number = scene%bodies%id(body)
  end function number_of

  !> Keep the names that are not empty.
  subroutine keep_names(scene, names, whole)
    type(scene_t), intent(in) :: scene
    type(text_t), intent(in) :: names(:)
    type(whole_t), intent(inout) :: whole
    integer :: b, n

    n = 0
    do b = 1, size(names)
      if (len(names(b)%s) > 0) n = n + 1
    end do
    allocate (whole%named(n), whole%names(n))
    n = 0
    do b = 1, size(names)
      if (len(names(b)%s) == 0) cycle
      n = n + 1
      whole%named(n) = int(number_of(scene, b), i4)
      whole%names(n)%s = names(b)%s
    end do
  end subroutine keep_names

  !> Give the scene of a rank its drives, pressures and names: those of bodies that are here, in the order of the whole.
  subroutine localise(whole, local)
    type(whole_t), intent(in) :: whole !! what was kept of the whole scene
    type(scene_t), intent(inout) :: local !! scene of the rank; its drives, pressures and names are set
    integer :: i, n

    if (allocated(local%drives)) deallocate (local%drives)
    if (allocated(local%pressures)) deallocate (local%pressures)
    n = 0
    do i = 1, size(whole%drives)
      if (local_body(local%bodies, whole%drives(i)%body) > 0) n = n + 1
    end do
    allocate (local%drives(n))
    n = 0
    do i = 1, size(whole%drives)
      if (local_body(local%bodies, whole%drives(i)%body) == 0) cycle
      n = n + 1
      local%drives(n) = whole%drives(i)
      local%drives(n)%body = local_body(local%bodies, whole%drives(i)%body)
    end do
    n = 0
    do i = 1, size(whole%pressures)
      if (local_body(local%bodies, whole%pressures(i)%body) > 0) n = n + 1
    end do
    allocate (local%pressures(n))
    n = 0
    do i = 1, size(whole%pressures)
      if (local_body(local%bodies, whole%pressures(i)%body) == 0) cycle
      n = n + 1
      local%pressures(n) = whole%pressures(i)
      call localise_pressure(local, local%pressures(n)%body, local%pressures(n)%between)
    end do
    call localise_names(whole, local)
  end subroutine localise

  !> Numbers of the whole scene become local ones; zero stays zero. What bounds a pressed length is wide, so it is here.
  pure subroutine localise_pressure(local, body, between)
    type(scene_t), intent(in) :: local
    integer, intent(inout) :: body, between(2)
    integer :: k

    body = local_body(local%bodies, body)
    do k = 1, 2
      between(k) = local_body(local%bodies, between(k))
    end do
  end subroutine localise_pressure

  !> Names of the bodies that are here, empty for those that have none.
  subroutine localise_names(whole, local)
    type(whole_t), intent(in) :: whole
    type(scene_t), intent(inout) :: local
    integer :: b, i

    if (allocated(local%names)) deallocate (local%names)
    if (.not. allocated(whole%named)) return
    allocate (local%names(local%bodies%n))
    do b = 1, local%bodies%n
      local%names(b)%s = ''
    end do
    do i = 1, size(whole%named)
      b = local_body(local%bodies, whole%named(i))
      if (b > 0) local%names(b)%s = whole%names(i)%s
    end do
  end subroutine localise_names
end module sg_whole
