!> Contacts of one step: geometry, law, and the impulses carried from step to step.
!!
!! A contact lies between a candidate and an antagonist contactor. Its normal points from the antagonist to the
!! candidate, its tangent is t = (n_y, -n_x); a positive normal impulse pushes the two apart. Contacts stand in
!! spatial order. A pair of polygons may have two contacts, told apart by their feature key.
module sg_contacts
  use sg_kinds, only: wp, i1, i4
  use sg_lists, only: reserve
  implicit none
  private
  public :: contacts_t, reserve_contacts

  !> All contacts of one step
  type :: contacts_t
    !> Number of contacts
    integer :: n = 0
    !> Impulse components: 2 (normal, tangential), or 1 where nothing rubs
    integer :: n_components = 2
    !> Contactors, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: contactor(:, :)
    !> Bodies, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: body(:, :)
    !> Feature key of the point within its pair, shape (n)
    integer(i4), allocatable :: feature(:)
    !> Law, index into the scene's laws, shape (n)
    integer(i4), allocatable :: law(:)
    !> Normal from antagonist to candidate, shape (2, n)
    real(wp), allocatable :: normal(:, :)
    !> Point of contact [m], in the candidate's periodic image, shape (2, n)
    real(wp), allocatable :: point(:, :)
    !> Gap [m], negative where shapes overlap, shape (n)
    real(wp), allocatable :: gap(:)
    !> Periods by which the antagonist's image is moved in x, shape (n)
    integer(i1), allocatable :: image(:)
    !> Impulse over the step [N s], normal and tangential, shape (n_components, n)
    real(wp), allocatable :: impulse(:, :)
    !> What the contact did in the last step, one of `status_*`, shape (n)
    integer(i1), allocatable :: status(:)
  end type contacts_t

contains

  !> Make room for `n` contacts.
  subroutine reserve_contacts(contacts, n)
    type(contacts_t), intent(inout) :: contacts !! contacts to make room in
    integer, intent(in) :: n !! contacts wanted

    if (allocated(contacts%gap)) then
      if (size(contacts%gap) >= n) return
    end if
    call reserve(contacts%contactor, 2, n)
    call reserve(contacts%body, 2, n)
    call reserve(contacts%feature, n)
    call reserve(contacts%law, n)
    call reserve(contacts%normal, 2, n)
    call reserve(contacts%point, 2, n)
    call reserve(contacts%gap, n)
    call reserve(contacts%image, n)
    call reserve(contacts%impulse, contacts%n_components, n)
    call reserve(contacts%status, n)
  end subroutine reserve_contacts
end module sg_contacts
