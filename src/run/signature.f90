!> Signature of a scene: numbers that differ between scenes, for restart files, which hold no shapes and no masses.
!!
!! A value is taken as the whole number that its bits are, modulo a prime, and weighted by the number of its body: such sums do
!! not depend on the order in which they are taken, so that any number of ranks comes to the very same.
module sg_signature
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4, i8
  use sg_scene, only: scene_t
  implicit none
  private
  public :: signature_of, signature_of_replicated, n_signature, n_of_bodies

  !> Numbers of a scene's signature
  integer, parameter :: n_signature = 6
  !> Those of them that are sums over the bodies; the last one is the number of drives
  integer, parameter :: n_of_bodies = 5
  !> Prime below 2^31: products of two remainders fit into a word
  integer(i8), parameter :: modulus = 2147483647_i8

contains

  !> Signature of a scene: numbers of bodies, contactors and drives, and sums over masses, moments of inertia and reaches.
  !! Collective where ranks share the scene.
  function signature_of(scene, comm) result(signature)
    type(scene_t), intent(in) :: scene !! whole scene, or part of this rank
    type(comm_t), intent(inout) :: comm !! ranks that share the scene
    real(wp) :: signature(n_signature)
    integer(i8) :: sums(n_of_bodies)
    integer :: b

    call add_up(scene, [(b <= scene%bodies%n_own, b=1, scene%bodies%n)], sums)
    if (allocated(scene%bodies%id)) call comm%sum(sums)
    signature = joined(scene, sums)
  end function signature_of

  !> Signature of the bodies that all ranks hold; of all own ones where a scene is not shared.
  function signature_of_replicated(scene) result(signature)
    type(scene_t), intent(in) :: scene !! whole scene, or the part of a rank
    real(wp) :: signature(n_signature)
    integer(i8) :: sums(n_of_bodies)
    logical :: counts(scene%bodies%n)
    integer :: b

    counts = [(b <= scene%bodies%n_own, b=1, scene%bodies%n)]
    if (allocated(scene%bodies%owner)) counts = scene%bodies%owner < 0
    call add_up(scene, counts, sums)
    signature = joined(scene, sums)
  end function signature_of_replicated

  !> Numbers of bodies and contactors, and sums over masses, moments of inertia and reaches, as remainders.
  subroutine add_up(scene, counts, sums)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: counts(:) !! which bodies, with their contactors
    integer(i8), intent(out) :: sums(n_of_bodies)
    integer :: b, c

    sums = 0
    associate (bodies => scene%bodies, contactors => scene%contactors)
      do b = 1, bodies%n
        if (.not. counts(b)) cycle
        sums(1) = sums(1) + 1
        sums(3) = sums(3) + weighted(bodies%mass(b), number_of(bodies%id, b))
        if (scene%dimension == 2) then
          sums(4) = sums(4) + weighted(bodies%inertia(b), number_of(bodies%id, b))
        else
          sums(4) = sums(4) + weighted(sum(bodies%principal(:, b)), number_of(bodies%id, b))
        end if
      end do
      do c = 1, contactors%n
        if (.not. counts(contactors%body(c))) cycle
        sums(2) = sums(2) + 1
        sums(5) = sums(5) + weighted(contactors%reach(c), number_of(contactors%id, c))
      end do
    end associate
    sums(3:) = modulo(sums(3:), modulus)
  end subroutine add_up

  !> Signature from sums over all ranks.
  pure function joined(scene, sums) result(signature)
    type(scene_t), intent(in) :: scene
    integer(i8), intent(in) :: sums(n_of_bodies)
    real(wp) :: signature(n_signature)

    signature = [real(sums(:2), wp), real(modulo(sums(3:), modulus), wp), real(size(scene%drives), wp)]
  end function joined

  !> A value as a remainder, weighted.
  pure integer(i8) function weighted(value, weight)
    real(wp), intent(in) :: value
    integer(i8), intent(in) :: weight

    weighted = modulo(modulo(transfer(value, weight), modulus)*weight, modulus)
  end function weighted

  !> Number in the whole scene of a body or a contactor.
  pure integer(i8) function number_of(id, item) result(number)
    integer(i4), allocatable, intent(in) :: id(:)
    integer, intent(in) :: item

    number = int(item, i8)
    if (allocated(id)) number = int(id(item), i8)
  end function number_of
end module sg_signature
