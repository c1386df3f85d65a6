!> Fabric tensor of the contacts between grains [Satake1982], which carry a positive normal impulse.
!!
!! F = (1/N) sum over these contacts of n (x) n, n the normal: of trace 1, and 1/2 (in space 1/3) of the identity where normals have
!! no preferred direction. Contacts with walls, which have the directions of the walls, are left out.
module sg_fabric
  use sg_contacts, only: contacts_t, normal_impulses
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_tally, only: pass_columns, pass_sums, ratio, tally_t
  implicit none
  private
  public :: measure_fabric, add_fabric, fabric_sums, n_fabric_sums

  !> Numbers of `fabric_sums`
  integer, parameter :: n_fabric_sums = 7

contains

  !> Components of the fabric tensor, each pair of axes once.
  pure subroutine measure_fabric(scene, contacts, tally)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    type(tally_t), intent(inout) :: tally !! tally of the measure

    if (tally%pass == pass_sums) call tally%sums%put('fabric', fabric_sums(scene, contacts))
    if (tally%pass == pass_columns) call add_fabric(tally%sums%get('fabric', n_fabric_sums), scene%dimension, 'fabric_', tally)
  end subroutine measure_fabric

  !> Add the columns that follow from sums.
  pure subroutine add_fabric(sums, dimension, prefix, tally)
    real(wp), intent(in) :: sums(n_fabric_sums) !! of `fabric_sums`, of all ranks
    integer, intent(in) :: dimension !! of space
    character(len=*), intent(in) :: prefix !! of the names
    type(tally_t), intent(inout) :: tally !! tally of the measure
    integer :: a, b, place
    character(len=*), parameter :: axis = 'xyz'

    place = 1
    do a = 1, 3
      do b = a, 3
        place = place + 1
        if (max(a, b) <= dimension) call tally%add(prefix//axis(a:a)//axis(b:b), ratio(sums(place), sums(1)))
      end do
    end do
  end subroutine add_fabric

  !> What this rank adds: number of contacts, and n (x) n in the order xx, xy, xz, yy, yz, zz.
  pure function fabric_sums(scene, contacts) result(sums)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp) :: sums(n_fabric_sums), x, y, z
    real(wp), allocatable :: normal(:)
    integer :: k

    sums = 0
    z = 0
    call normal_impulses(contacts, normal)
    do k = 1, contacts%n
      if (.not. normal(k) > 0) cycle
      if (.not. (scene%bodies%is_grain(contacts%body(1, k)) .and. scene%bodies%is_grain(contacts%body(2, k)))) cycle
      x = contacts%normal(1, k)
      y = contacts%normal(2, k)
      if (contacts%dimension == 3) z = contacts%normal(3, k)
      sums(1) = sums(1) + 1
      sums(2) = sums(2) + x*x
      sums(3) = sums(3) + x*y
      sums(4) = sums(4) + x*z
      sums(5) = sums(5) + y*y
      sums(6) = sums(6) + y*z
      sums(7) = sums(7) + z*z
    end do
  end function fabric_sums
end module sg_fabric
