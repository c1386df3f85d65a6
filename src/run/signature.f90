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
  public :: signature_of, n_signature

  !> Numbers of a scene's signature
  integer, parameter :: n_signature = 6
  !> Prime below 2^31: products of two remainders fit into a word
  integer(i8), parameter :: modulus = 2147483647_i8

contains

  !> Signature of a scene: numbers of bodies, contactors and drives, and sums over masses, moments of inertia and reaches.
  function signature_of(scene, comm, is_common) result(signature)
    type(scene_t), intent(in) :: scene !! whole scene, or the part of a rank
    type(comm_t), intent(inout), optional :: comm !! ranks that share the scene, all of which call this
    logical, intent(in), optional :: is_common !! do only bodies count that all ranks hold? Then one rank may call it alone
    real(wp) :: signature(n_signature)
    integer(i8) :: sums(3), n(2)
    integer :: b, c
    logical :: counts(scene%bodies%n)

    sums = 0
    n = 0
    counts = [(b <= scene%bodies%n_own, b=1, scene%bodies%n)]
    if (present(is_common) .and. allocated(scene%bodies%owner)) counts = scene%bodies%owner < 0
    associate (bodies => scene%bodies, contactors => scene%contactors)
      do b = 1, bodies%n
        if (.not. counts(b)) cycle
        n(1) = n(1) + 1
        sums(1) = sums(1) + weighted(bodies%mass(b), number_of(bodies%id, b))
        if (scene%dimension == 2) then
          sums(2) = sums(2) + weighted(bodies%inertia(b), number_of(bodies%id, b))
        else
          sums(2) = sums(2) + weighted(sum(bodies%principal(:, b)), number_of(bodies%id, b))
        end if
      end do
      do c = 1, contactors%n
        if (.not. counts(contactors%body(c))) cycle
        n(2) = n(2) + 1
        sums(3) = sums(3) + weighted(contactors%reach(c), number_of(contactors%id, c))
      end do
    end associate
    sums = modulo(sums, modulus)
    if (present(comm) .and. allocated(scene%bodies%id)) then
      call comm%sum(n)
      call comm%sum(sums)
    end if
    signature = [real(n, wp), real(modulo(sums, modulus), wp), real(size(scene%drives), wp)]
  end function signature_of

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
